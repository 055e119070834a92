/* bridge/own_current.c - the first pass: the current that each D of ngspice carries.
 *
 * vf goes with the logarithm of the current, so it is the mean of that over the time in which the D conducts:
 * then vf is the mean of its voltage.  The pass takes every D for its curve at 1 mA, and its points are few.
 */
#include "own_current.h"

#include <math.h>
#include <stdlib.h>

enum { LEAST_STEPS = 200, MOST_WORK = 30000 }; /* steps; steps times unknowns and devices */

/* A step is read in the middle of these parts of it: what is fast is fast at its begin. */
static const double border[] = {0.0, 1.0 / 64, 1.0 / 16, 0.25, 0.5, 0.75, 1.0};
enum { PARTS = sizeof border / sizeof border[0] - 1 };

int ns_bridge_own_diode_element(const ns_own_taken *o) {
    return o->kind == OWN_DIODE ? o->id : o->kind == OWN_MOSFET ? o->body : -1;
}

int ns_bridge_own_wants_currents(const ns_analysis *a) {
    if (!isnan(a->ex.options.id) || a->ex.options.zero_diodes || ns_bridge_digital_is(&a->ex.digital))
        return 0; /* what digital parts do is known to ngspice's event queue alone */
    for (int k = 0; k < a->ex.nowns; k++)
        if (ns_bridge_own_diode_element(&a->ex.own[k]) >= 0)
            return 1;
    return 0;
}

/* The march was sampled in the middle of some seconds. */
static void add_part(const ns_analysis *a, double seconds, ns_log_mean *mean) {
    const ns_mode *mode = ns_march_mode(a->march);
    for (int k = 0; k < a->ex.nowns; k++) {
        const int element = ns_bridge_own_diode_element(&a->ex.own[k]);
        double i;
        int on;
        if (element >= 0 &&
            ns_circuit_device(a->ex.circuit, element, a->x, a->lambda, mode, &i, NULL, &on) == NS_OK &&
            on > 0)
            ns_bridge_log_mean_add(&mean[k], i, seconds);
    }
}

/* The trial from the accepted time `from` to its end. */
static int add_step(ns_analysis *a, double from, double end, ns_log_mean *mean) {
    int status = NS_OK;
    for (int k = 0; k < PARTS && status == NS_OK; k++) {
        const double middle = 0.5 * (border[k] + border[k + 1]);
        status = ns_march_sample(a->march, from + middle * (end - from), a->x, a->lambda);
        if (status == NS_OK)
            add_part(a, (border[k + 1] - border[k]) * (end - from), mean);
    }
    return status;
}

static void pass(ns_analysis *a, double stop, ns_log_mean *mean) {
    const int work = (int)(MOST_WORK / (a->count + 1));
    double t, end;
    int status = ns_march_read(a->march, &t, NULL, NULL, NULL);
    for (int k = 0; k < (work > LEAST_STEPS ? work : LEAST_STEPS) && status == NS_OK && t < stop; k++) {
        status = ns_march_try(a->march, stop, NS_TO_STEP, &end);
        if (status == NS_OK && end > t)
            status = add_step(a, t, end, mean);
        if (status == NS_OK)
            status = ns_march_accept(a->march);
        t = end;
    }
}

/* 1, 1.5, 2, 3, 5 or 7 times a power of ten: D that carry nearly the same are taken alike. */
static double round_current(double amperes) {
    static const double digit[] = {1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0};
    const double power = pow(10.0, floor(log10(amperes)));
    double best = power;
    for (size_t k = 0; k < sizeof digit / sizeof digit[0]; k++)
        if (fabs(log(digit[k] * power / amperes)) < fabs(log(best / amperes)))
            best = digit[k] * power;
    return best;
}

int ns_bridge_own_find_currents(ns_analysis *a, double stop, ns_own_currents *currents) {
    ns_log_mean *mean = calloc((size_t)a->ex.nowns + 1, sizeof *mean);
    currents->of = calloc((size_t)a->ex.nowns + 1, sizeof *currents->of);
    if (!mean || !currents->of) {
        free(mean);
        return NS_E_MEMORY;
    }
    pass(a, stop, mean);
    for (int k = 0; k < a->ex.nowns; k++)
        if (mean[k].seconds > 0.0)
            currents->of[currents->count++] =
                (ns_own_current){a->ex.own[k].inst, round_current(ns_bridge_log_mean_read(&mean[k]))};
    free(mean);
    return NS_OK;
}

void ns_bridge_own_forget_currents(ns_own_currents *currents) {
    free(currents->of);
    *currents = (ns_own_currents){0, NULL, NS_OWN_CURRENT};
}
