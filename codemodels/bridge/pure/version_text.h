/* bridge/pure/version_text.h - the version of ngspice, as its memory shows it. */
#ifndef BRIDGE_VERSION_TEXT_H
#define BRIDGE_VERSION_TEXT_H

#include <stddef.h>

enum { VERSION_TEXT = 16 }; /* room for a version */

/* Finds the version, "44.2", in ngspice's initialised data: its conf.c has it beside the text that asks for
 * reports of bugs.  1 if it is there, and the only one. */
int ns_bridge_version_text(const char *data, size_t size, char version[VERSION_TEXT]);

/* The number before the dot; a tree between releases, "46+", counts as the next one. */
int ns_bridge_version_major(const char *version);

#endif
