/* src/engine/sparse_stand_in.h - modes that are one but for who carries a current.
 *
 * A switch that is open while a pair across it (twins.h), which has no resistance, conducts: (P2) is that of
 * the closed switch, whose lambda is the pair's, but for signs.  So factors of the one serve the other, and
 * where a diode takes over from its switch nothing is factored.
 */
#ifndef NS_SPARSE_STAND_IN_H
#define NS_SPARSE_STAND_IN_H

#include "sparse_form.h"
#include "twins.h"

typedef struct ns_stand_in {
    int pair, of;     /* of: the switch */
    ns_mode idle;     /* of the pair */
    double y, lambda; /* signs: those of the switch are so many times the pair's */
} ns_stand_in;

typedef struct ns_stand_ins {
    int m, n, count;
    ns_stand_in *all; /* count */
    int *now, nows;   /* those that take part in the mode asked for last */
    ns_mode *mode;    /* m */
    double *r;        /* n + m */
} ns_stand_ins;

/* Of these twins.  Errors: MEMORY. */
int ns_stand_ins_create(const ns_form *f, const ns_twin *twin, int count, ns_stand_ins *s);
void ns_stand_ins_free(ns_stand_ins *s);

/* The mode (m) whose factors serve this one: itself, or one that stays valid until the next call. */
const ns_mode *ns_stand_ins_mode(ns_stand_ins *s, const ns_mode *mode);

/* Right-hand sides of (P2) for that mode, itself or one that stays until the next call; its solution for the
 * mode asked for. */
const double *ns_stand_ins_right(ns_stand_ins *s, const double *r);
void ns_stand_ins_back(const ns_stand_ins *s, double *v);

#endif
