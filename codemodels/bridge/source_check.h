/* bridge/source_check.h - are ngspice's sources what they were read as? */
#ifndef BRIDGE_SOURCE_CHECK_H
#define BRIDGE_SOURCE_CHECK_H

#include "ngspice.h"
#include "pure/source_compare.h"

typedef struct ns_checked_source ns_checked_source;

/* All 0: no comparison is going on. */
typedef struct ns_source_check {
    int pending; /* a transient analysis began, or went on: its sources are to be compared.  session.c */
    int n;       /* of: */
    ns_checked_source *source;
    ns_signal *signal; /* n: what they were read as */
    int instants, at;  /* in all; the one of the present load */
    double instant[SOURCE_INSTANTS];
    double time; /* ngspice's own, given back at the end */
    long mode;
} ns_source_check;

/* Functions that return int return OK, or a code of ngspice after one line that names a source, unless their
 * comment says otherwise. */

/* In a DC load, before the right side is overwritten. */
int ns_bridge_source_check_dc(CKTcircuit *ckt);

/* At the end of the first load of .tran: has ngspice load again, at the first instant. */
int ns_bridge_source_check_begin(ns_source_check *check, CKTcircuit *ckt);

/* 1 if the present load is for the comparison. */
int ns_bridge_source_check_is_on(const ns_source_check *check);

/* In such a load, before the right side is overwritten: compares, and has ngspice load at the next instant,
 * or once more at its own time. */
int ns_bridge_source_check_load(ns_source_check *check, CKTcircuit *ckt);

void ns_bridge_source_check_clear(ns_source_check *check);

#endif
