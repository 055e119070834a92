/* bridge/extract_walk.c - what every reader of an element does to the circuit being read. */
#include "extract_walk.h"

#include <string.h>

void ns_bridge_extract_line(ns_extract *ex, int error, const char *name, const char *what) {
    ex->error = error;
    snprintf(ex->line, sizeof ex->line, "%s%s%s", name, *name ? ": " : "", what);
}

static int has_node(const CKTcircuit *ckt, const char *beginning) {
    for (const CKTnode *node = ckt->CKTnodes; node; node = node->next)
        if (strncmp(node->name, beginning, strlen(beginning)) == 0)
            return 1;
    return 0;
}

void ns_bridge_extract_users_name(const ns_extract_walk *w, const GENinstance *inst, char *name,
                                  size_t size) {
    const char *made = inst->GENname;
    const char *dot = strrchr(made, '.');
    const char *own = dot ? dot + 1 : made;     /* b.x1.be1: be1 */
    const char *path = dot ? made + 1 : made;   /* .x1. */
    const char *inside = dot ? made + 2 : made; /* x1. */
    char node[EXTRACT_NAME];
    snprintf(name, size, "%s", made);
    if (strncmp(made, "a$poly$", 7) == 0) {
        snprintf(name, size, "%s", made + 7);
    } else if ((own[0] == 'a' || own[0] == 'b') && own[1]) {
        snprintf(node, sizeof node, "%.*s%s_int", (int)(own - inside), inside, own + 1);
        if (has_node(w->ckt, node))
            snprintf(name, size, "%.*s%.*s%s", dot != NULL, own + 1, (int)(own - path), path, own + 1);
    }
}

int ns_bridge_extract_refuse(ns_extract_walk *w, const GENinstance *inst, const char *what) {
    char name[EXTRACT_NAME];
    ns_bridge_extract_users_name(w, inst, name, sizeof name);
    ns_bridge_extract_line(w->ex, E_UNSUPP, name, what);
    return EXTRACT_REFUSED;
}

int ns_bridge_extract_element(const ns_extract_walk *w, int eq) {
    return eq > 0 && eq < w->ex->neq ? w->ex->element[eq] : -1;
}

void ns_bridge_extract_current(ns_extract_walk *w, int eq, int id) {
    if (eq > 0 && eq < w->ex->neq)
        w->ex->element[eq] = id;
}

int ns_bridge_extract_new_node(ns_extract_walk *w) {
    if (w->next_node <= w->ex->neq)
        w->next_node = w->ex->neq + 1;
    return w->next_node++;
}

void ns_bridge_extract_mix(ns_extract_walk *w, const void *bytes, size_t size) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++) /* FNV-1a */
        w->ex->hash = (w->ex->hash ^ b[i]) * 1099511628211ULL;
}
