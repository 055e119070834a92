/* tests/rig/arrays.h - arrays against what they should be. */
#ifndef ARRAYS_H
#define ARRAYS_H

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* A p*q array against values written row by row. */
static inline void assert_array(const double *got, int p, int q, const double *rows) {
    for (int i = 0; i < p; i++) {
        for (int j = 0; j < q; j++) {
            double want = rows[i * q + j], is = got[i + j * p];
            if (!(fabs(is - want) <= 4 * DBL_EPSILON * fabs(want))) {
                fail_msg("entry %d, %d is %.17g, expected %.17g", i, j, is, want);
            }
        }
    }
}
#define ASSERT_ARRAY(got, p, q, ...) assert_array(got, p, q, (const double[]){__VA_ARGS__})

#endif
