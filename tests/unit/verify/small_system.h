/* tests/unit/verify/small_system.h - what tests of systems of one or two rows share. */
#ifndef SMALL_SYSTEM_H
#define SMALL_SYSTEM_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"
#include "verify/verify_internal.h"

static const ns_verify_options options = {.reltol = 1e-9, .instant = 1e-11};

/* A command of pair 0 by x_0 (by_state) or z_0. */
static inline void command(ns_system *s, int by_state, double on, double off) {
    double *gain = calloc(by_state ? (size_t)s->n : (size_t)s->nz, sizeof *gain);
    assert_non_null(gain);
    gain[0] = 1;
    s->l[0] = -INFINITY;
    s->u[0] = INFINITY;
    s->command[0] = (ns_command){.pair = 0, .on = on, .off = off};
    *(by_state ? &s->command[0].gx : &s->command[0].gz) = gain;
}

#endif
