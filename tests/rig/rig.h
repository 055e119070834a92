/* tests/rig/rig.h - a circuit with its marcher, from rest on: for tests of the sparse one. */
#ifndef RIG_H
#define RIG_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"

typedef struct rig {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double *x; /* of the system, where it went to */
} rig;

static inline rig begin(void) {
    rig k = {0};
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    return k;
}

/* By these options; by others before, if it was made already. */
static inline void make_by(rig *k, const ns_march_options *o) {
    if (!k->s)
        assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    if (!k->x)
        k->x = calloc((size_t)k->s->n + 1, sizeof(double));
    assert_non_null(k->x);
    ns_march_free(k->m);
    assert_int_equal(ns_march_create(k->s, o, &k->m, NULL), NS_OK);
}

static inline void start_at_rest(rig *k) {
    assert_int_equal(ns_circuit_rest(k->c, k->x), NS_OK);
    assert_int_equal(ns_march_start(k->m, 0, k->x), NS_OK);
}

static inline void end(rig *k) {
    ns_march_free(k->m);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
    free(k->x);
}

static inline void go(rig *k, double t) {
    double reached;
    assert_int_equal(ns_march_try(k->m, t, NS_TO_TIME, &reached), NS_OK);
    assert_true(reached == t);
    assert_int_equal(ns_march_accept(k->m), NS_OK);
    assert_int_equal(ns_march_read(k->m, NULL, k->x, NULL, NULL), NS_OK);
}

/* go(), where events may crowd and a call ends before t, or it is refused: its status. */
static inline int go_on(rig *k, double t) {
    double reached = -INFINITY;
    while (reached < t) {
        const int status = ns_march_try(k->m, t, NS_TO_TIME, &reached);
        if (status != NS_OK)
            return status;
        assert_int_equal(ns_march_accept(k->m), NS_OK);
    }
    return ns_march_read(k->m, NULL, k->x, NULL, NULL);
}

/* The largest difference of a and b (count), of what there was so far in b, 1 at least. */
static inline double apart(int count, const double *a, const double *b) {
    double most = 1, worst = 0;
    for (int i = 0; i < count; i++) {
        most = fmax(most, fabs(b[i]));
        worst = fmax(worst, fabs(a[i] - b[i]) / most);
    }
    return worst;
}

static inline double current(const rig *k, int id) {
    return k->x[ns_circuit_current_unknown(k->c, id)];
}

#endif
