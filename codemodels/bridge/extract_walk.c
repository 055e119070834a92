/* bridge/extract_walk.c - what every reader of an element does to the circuit being read. */
#include "extract_walk.h"

void ns_bridge_extract_line(ns_extract *ex, int error, const char *name, const char *what) {
    ex->error = error;
    snprintf(ex->line, sizeof ex->line, "%s%s%s", name, *name ? ": " : "", what);
}

int ns_bridge_extract_refuse(ns_extract_walk *w, const GENinstance *inst, const char *what) {
    ns_bridge_extract_line(w->ex, E_UNSUPP, inst->GENname, what);
    return EXTRACT_REFUSED;
}

void ns_bridge_extract_current(ns_extract_walk *w, int eq, int id) {
    if (eq > 0 && eq < w->ex->neq)
        w->ex->element[eq] = id;
}

void ns_bridge_extract_mix(ns_extract_walk *w, const void *bytes, size_t size) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++) /* FNV-1a */
        w->ex->hash = (w->ex->hash ^ b[i]) * 1099511628211ULL;
}
