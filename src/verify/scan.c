/* src/verify/scan.c - (S4) of a point in a hurry: what passes is right; what does not may be.
 *
 * Nothing is learnt of sizes here, no input and no control is evaluated, and what values may be off by is
 * that of the last point that was judged in full.
 */
#include "verify_internal.h"

#include <math.h>

static void prepare(ns_verify *v) {
    v->scan_is_old = 0;
    for (int j = 0; j < v->s->m; j++) {
        v->scan[j].y_off = ns_verify_sizes_y_off(v, j);
        v->scan[j].lambda_off = ns_verify_sizes_lambda_off(v, j);
    }
}

/* y of pair j. */
static double y_of(const ns_verify *v, int j, const double *x, const double *lambda) {
    const ns_verify_rows *r = &v->output;
    const int n = v->s->n, m = v->s->m;
    double y = 0;
    for (int k = r->start[j]; k < r->start[j + 1]; k++) {
        const int column = r->column[k];
        y += r->value[k] * (column < n ? x[column] : column < n + m ? lambda[column - n] : 1);
    }
    return y;
}

static int holds(const ns_verify *v, int j, double lambda, double y) {
    const ns_verify_scan_off *off = &v->scan[j];
    const int shut = fabs(y) <= off->y_off;
    if (v->command[j] >= 0)
        return shut || fabs(lambda) <= off->lambda_off;
    const double above = lambda - v->s->l[j], below = v->s->u[j] - lambda;
    return above >= -off->lambda_off && below >= -off->lambda_off &&
           (shut || (y > 0 ? above : below) <= off->lambda_off);
}

int ns_verify_scan(ns_verify *v, const double *x, const double *lambda) {
    if (v->scan_is_old)
        prepare(v);
    for (int j = 0; j < v->s->m; j++)
        if (!v->scan_known || !holds(v, j, lambda[j], y_of(v, j, x, lambda)))
            return 0;
    return 1;
}
