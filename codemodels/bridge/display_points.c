/* bridge/display_points.c - points between those of the waveform, where what B, E and G show that act on
 * nothing bends. */
#include <math.h>

#include "display.h"
#include "show.h"

/* By how much, of half of what the option lines allows, as lines below what bends one way all along add up,
 * they are off the straight line in the middle of two points. */
static double deviation(ns_analysis *a, const double *from, const double *middle, const double *to) {
    double worst = 0.0;
    for (int k = 0; k < a->ex.ndisplays; k++) {
        ns_extract_display *d = &a->ex.display[k];
        const double v0 = from[d->node], v1 = to[d->node];
        d->most = fmax(d->most, fmax(fabs(v0), fabs(v1)));
        if (d->most > 0.0)
            worst =
                fmax(worst, fabs(middle[d->node] - 0.5 * (v0 + v1)) / (0.5 * a->ex.options.lines * d->most));
    }
    return worst;
}

double ns_bridge_display_until(ns_analysis *a, CKTcircuit *ckt, double from, const ns_waveform_point *p) {
    static const double most_parts = 1000.0, shortest = 0.01; /* of a line: what jumps does not get nearer */
    const size_t n = (size_t)a->ex.neq;
    double *value = a->ex.ndisplays > 0 && p->t > from ? calloc(3 * n, sizeof *value) : NULL;
    ns_analysis at_p = *a;
    if (p->t != a->display.until) {
        a->display.until = p->t;
        a->display.length = p->t - from;
    }
    if (!value || p->t - from < shortest * a->display.length) {
        free(value);
        return p->t;
    }
    double *middle = value + n, *to = middle + n;
    at_p.x = (double *)p->x;
    at_p.lambda = (double *)p->lambda;
    at_p.mode = (ns_mode *)p->mode;
    ns_bridge_show_values(a, value);
    const double now = ckt->CKTtime;
    ckt->CKTtime = p->t;
    ns_bridge_show_values(&at_p, to);
    for (size_t k = 0; k < n; k++)
        middle[k] = 0.5 * (value[k] + to[k]);
    ckt->CKTtime = 0.5 * (from + p->t);
    ns_bridge_display_values(&a->ex, middle);
    ckt->CKTtime = now;
    const double parts = fmin(ceil(sqrt(deviation(a, value, middle, to))), most_parts);
    free(value);
    return parts > 1.0 ? from + (p->t - from) / parts : p->t;
}
