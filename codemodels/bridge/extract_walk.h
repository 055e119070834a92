/* bridge/extract_walk.h - the walk over ngspice's elements, as the reader of one element sees it. */
#ifndef BRIDGE_EXTRACT_WALK_H
#define BRIDGE_EXTRACT_WALK_H

#include "extract.h"

enum { EXTRACT_LATER = 1000, EXTRACT_REFUSED = 1001 }; /* besides the statuses of the library */

/* Sources that act on nothing, and whose expression was refused. */
typedef struct ns_display_list {
    int count;
    const GENinstance **inst; /* count */
} ns_display_list;

typedef struct ns_extract_walk {
    CKTcircuit *ckt;
    ns_extract *ex;
    const ns_own_found *found; /* NULL: nothing is known */
    int dc;                    /* sources stand for their DC values */
    int next_node; /* from neq + 1 on: the first number for a node that ngspice has not; 0: neq + 1 */
    ns_display_list *displays; /* as earlier readings found them */
    int again;                 /* there is one more of them: the circuit is to be read anew */
    int time_node;             /* whose voltage is the time (expression.c); 0: there is none */
} ns_extract_walk;

/* Reads one instance: NS_OK, EXTRACT_LATER (an element it refers to was not read yet), EXTRACT_REFUSED
 * (the line is written), or a status of the library. */
typedef int ns_extract_reader(ns_extract_walk *w, GENinstance *inst);

/* Keeps error and the line "<name>: <what>"; an empty name: "<what>". */
void ns_bridge_extract_line(ns_extract *ex, int error, const char *name, const char *what);

enum { EXTRACT_NAME = 160 }; /* room for the name of an element */

/* The name of the element that the user wrote, where ngspice made inst of it: of E, F, G, H with POLY a code
 * model a$poly$e1, of C, E, G, L with an expression or a table be1 or ae1, and nodes e1_int1, ... */
void ns_bridge_extract_users_name(const ns_extract_walk *w, const GENinstance *inst, char *name, size_t size);

/* Refuses inst: keeps the line "<name>: <what>".  EXTRACT_REFUSED. */
int ns_bridge_extract_refuse(ns_extract_walk *w, const GENinstance *inst, const char *what);

/* The element whose current equation eq stands for, -1: none, or it was not read yet. */
int ns_bridge_extract_element(const ns_extract_walk *w, int eq);

/* Notes that equation eq (0: none) stands for the current of element id. */
void ns_bridge_extract_current(ns_extract_walk *w, int eq, int id);

/* The number of a node that ngspice has not. */
int ns_bridge_extract_new_node(ns_extract_walk *w);

/* Mixes bytes into the hash. */
void ns_bridge_extract_mix(ns_extract_walk *w, const void *bytes, size_t size);

#endif
