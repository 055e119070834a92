/* src/linalg/equilibrate.c - powers of two that bring the entries of a matrix close to 1.
 *
 * Sweeps of geometric means (each row, then each column, is scaled by the mean exponent of its largest and
 * smallest entry; Curtis and Reid's aim by Fulkerson and Wolfe's rule) and a last sweep by largest entries.
 * Entries that span 24 decades would otherwise leave rows whose largest entry comes from a column that is
 * merely measured in small units.
 */
#include "equilibrate.h"

#include <limits.h>
#include <stdint.h>
#include <string.h>

enum { SWEEPS = 2, NONE = SHRT_MIN, SPREAD = 12 };

/* The binary exponent of a finite number, NONE for 0. */
static short exponent(double a) {
    uint64_t bits;
    memcpy(&bits, &a, sizeof bits);
    if ((bits << 1) == 0)
        return NONE;
    return (short)((int)(bits >> 52 & 0x7ff) - 1022);
}

/* What scales exponents lo..hi: to the middle, or (last sweep) the largest to 0. */
static int centre(int lo, int hi, int last) {
    if (hi == INT_MIN)
        return 0;
    return last ? -hi : -(lo + hi) / 2;
}

static void sweep_columns(int n, const short *e, const int *r, int *c, int last) {
    for (int j = 0; j < n; j++) {
        const short *col = e + (size_t)j * (size_t)n;
        int lo = INT_MAX, hi = INT_MIN;
        for (int i = 0; i < n; i++) {
            int v = col[i] + r[i];
            if (col[i] == NONE)
                continue;
            lo = v < lo ? v : lo;
            hi = v > hi ? v : hi;
        }
        c[j] = centre(lo, hi, last);
    }
}

static void sweep_rows(int n, const short *e, int *r, const int *c, int last) {
    for (int i = 0; i < n; i++) {
        int lo = INT_MAX, hi = INT_MIN;
        for (int j = 0; j < n; j++) {
            short x = e[(size_t)i + (size_t)j * (size_t)n];
            int v = x + c[j];
            if (x == NONE)
                continue;
            lo = v < lo ? v : lo;
            hi = v > hi ? v : hi;
        }
        r[i] = centre(lo, hi, last);
    }
}

void ns_linalg_equilibrate(int n, const double *a, int ld, int *r, int *c, short *e) {
    int lo = INT_MAX, hi = INT_MIN;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            short x = exponent(a[(size_t)i + (size_t)j * (size_t)ld]);
            e[(size_t)i + (size_t)j * (size_t)n] = x;
            if (x == NONE)
                continue;
            lo = x < lo ? x : lo;
            hi = x > hi ? x : hi;
        }
    memset(r, 0, (size_t)n * sizeof *r);
    memset(c, 0, (size_t)n * sizeof *c);
    if (hi == INT_MIN)
        return;
    if (hi - lo <= SPREAD) { /* close already: one common factor */
        for (int i = 0; i < n; i++)
            r[i] = -hi;
        return;
    }
    for (int k = 0; k < SWEEPS; k++) {
        sweep_rows(n, e, r, c, 0);
        sweep_columns(n, e, r, c, 0);
    }
    sweep_rows(n, e, r, c, 1);
    sweep_columns(n, e, r, c, 1);
}
