/* src/newton/step_setup.c - a step to be solved: its factors of h, its inputs, what the accepted point gives
 * to it. */
#include "linalg/row_split.h"
#include "newton_internal.h"

void ns_newton_set(ns_newton *s, double h, double t1, const ns_newton_options *o, ns_side side) {
    const int inside = o->relation == NS_RELATION_GAMMA && o->gamma < 1;
    const double carried = inside ? 0 : h * (1 - o->gamma);
    s->from = s->guess = s->xk;
    s->t1 = t1;
    s->tr = inside ? s->t + o->gamma * (t1 - s->t) : t1;
    s->ht = h * o->theta;
    s->hk = h * o->gamma;
    s->hg = inside ? h : h * o->gamma; /* (T8), or (T3) */
    s->cx = inside ? o->gamma : 1;
    for (int i = 0; i < s->model->nz; i++) {
        s->z1[i] = ns_signal_value(&s->model->z[i], t1, side);
        s->zr[i] = ns_signal_value(&s->model->z[i], s->tr, side);
    }
    ns_linalg_row_split_apply(s->n, 1, s->T, s->rk, s->work);
    for (int i = 0; i < s->rank; i++) {
        s->past[i] = carried > 0 ? carried * s->work[i] : 0;
        if (o->theta < 1)
            s->past[i] += h * (1 - o->theta) * s->fk[i];
    }
}
