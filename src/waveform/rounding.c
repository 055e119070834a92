/* src/waveform/rounding.c - what rounding makes of a signal, measured. */
#include "waveform_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { COUNT = 9 };

/* The k-th largest fourth difference of signal i, k from 0.  The largest is of rounding by +-r up to 16 r, of
 * anything that lasts three times as long as the samples 2e-6 of its size.  The one in the middle is of what
 * decays, however fast, at most (1/3)^2 (2/3)^4 = 0.02 of its size. */
static double fourth_difference(const ns_waveform *w, double *const *row, int i, int k) {
    enum { DIFFERENCES = COUNT - 4 };
    const int at = w->signal[i];
    double sorted[DIFFERENCES];
    for (int j = 0; j < DIFFERENCES; j++) {
        const double d =
            fabs(row[j][at] - 4 * row[j + 1][at] + 6 * row[j + 2][at] - 4 * row[j + 3][at] + row[j + 4][at]);
        int place = j;
        for (; place > 0 && sorted[place - 1] < d; place--)
            sorted[place] = sorted[place - 1];
        sorted[place] = d;
    }
    return sorted[k];
}

/* Is it more than a small part of the distance that is allowed, or, of the signal that was furthest off, more
 * than its integral was allowed to be off by over the length of a line? */
static int matters_for(const ns_waveform *w, int i) {
    static const double small = 0.1;
    const double given = fmax(w->noise * w->kind_largest[w->kind[i]], w->floor[w->kind[i]]);
    return w->rounding[i] * w->per_tolerance[i] > small || (i == w->worst && w->rounding[i] > given);
}

int ns_waveform_measure_rounding(ns_waveform *w, double t, double most, int *matters) {
    double *row[COUNT];
    const double wanted = fmin(most, 0.3 * ns_march_shortest(w->march, t, NULL));
    const double length = fmax(wanted, 4 * COUNT * DBL_EPSILON * fabs(t));
    const int kth = length > wanted ? (COUNT - 4) / 2 : 0; /* faster than time can tell */
    int taken = 0, status = NS_OK;
    w->rounding_known = 1;
    *matters = 0;
    for (; taken < COUNT; taken++) {
        status = ns_waveform_sample(w, fmin(t + taken * (length / (COUNT - 1)), w->end), &row[taken]);
        if (status != NS_OK)
            break;
    }
    for (int i = 0; i < w->looked && status == NS_OK; i++) {
        w->rounding[i] = fourth_difference(w, row, i, kth);
        *matters |= matters_for(w, i);
    }
    while (taken > 0)
        ns_waveform_return_row(w, row[--taken]);
    w->stale = 1;
    return status;
}

void ns_waveform_forget_rounding(ns_waveform *w) {
    if (!w->rounding_known)
        return;
    memset(w->rounding, 0, sizeof *w->rounding * (size_t)w->looked);
    w->rounding_known = 0;
    w->stale = 1;
}
