/* bridge/module_memory.h - the memory of the program or library that holds an address. */
#ifndef BRIDGE_MODULE_MEMORY_H
#define BRIDGE_MODULE_MEMORY_H

#include <stddef.h>

/* A part of it. */
typedef struct ns_module_memory {
    const char *data;
    size_t size;
} ns_module_memory;

/* Its code, or its initialised data.  0 if that is not known. */
int ns_bridge_module_code(const void *address, ns_module_memory *code);
int ns_bridge_module_data(const void *address, ns_module_memory *data);

#endif
