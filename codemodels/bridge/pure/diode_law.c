/* bridge/pure/diode_law.c - the current of ngspice's D, and the voltage at which it flows. */
#include "diode_law.h"

#include <float.h>
#include <math.h>

static double exponential(const ns_diode_exponential *e, double v) {
    return e->volts > 0.0 ? e->amperes * expm1(v / e->volts) : 0.0;
}

double ns_bridge_diode_law_current(const ns_diode_law *law, double v) {
    double i = exponential(&law->bottom, v) + exponential(&law->side, v);
    if (law->recombination.volts > 0.0) {
        const double part = 1.0 - v / law->vj;
        i += exponential(&law->recombination, v) * pow(part * part + 0.005, 0.5 * law->m);
    }
    return law->knee > 0.0 && i > 0.0 ? i / (1.0 + sqrt(i / law->knee)) : i;
}

double ns_bridge_diode_law_voltage(const ns_diode_law *law, double amperes) {
    enum { HALVINGS = 200 }; /* far more than the digits of a number */
    double low = 0.0, high = 0.01;
    while (high < 100.0 && ns_bridge_diode_law_current(law, high) < amperes)
        high *= 2.0;
    if (!(ns_bridge_diode_law_current(law, high) >= amperes))
        return NAN;
    for (int k = 0; k < HALVINGS && high - low > 1e-15 * high; k++) {
        const double middle = 0.5 * (low + high);
        if (ns_bridge_diode_law_current(law, middle) < amperes)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

double ns_bridge_diode_law_slope(const ns_diode_law *law, double amperes) {
    static const double part = 1e-3; /* of the current */
    return (ns_bridge_diode_law_voltage(law, (1.0 + part) * amperes) -
            ns_bridge_diode_law_voltage(law, (1.0 - part) * amperes)) /
           (2.0 * part * amperes);
}

/* Of a line from a voltage at a current to `end`, where it is `above` that, at most. */
static double flatter(double slope, double v, double end, double above, double amperes, double most) {
    if (!(most > amperes) || isnan(end))
        return slope;
    return fmin(slope, (end + above - v) / (most - amperes));
}

double ns_bridge_line_slope(double slope, double at, double most, double rush, double amperes,
                            const ns_line_ends *ends) {
    static const double part = 0.05, part_of_blocked = 0.02;
    slope = flatter(slope, at, most, part * fabs(most), amperes, ends->most);
    return flatter(slope, at, rush, fmax(part * fabs(rush), part_of_blocked * ends->blocks), amperes,
                   ends->rush);
}

double ns_bridge_diode_law_line(const ns_diode_law *law, double amperes, const ns_line_ends *ends) {
    return ns_bridge_line_slope(ns_bridge_diode_law_slope(law, amperes),
                                ns_bridge_diode_law_voltage(law, amperes),
                                ns_bridge_diode_law_voltage(law, ends->most),
                                ns_bridge_diode_law_voltage(law, ends->rush), amperes, ends);
}

/* At 2.5 times the current the tangent is above the curve of one exponential by 0.58 of n vt; a second line
 * from there to 40 times the current is below it by 0.49 of that at most. */
static const double bends = 2.5;

ns_diode_lines ns_bridge_diode_law_lines(const ns_diode_law *law, double amperes, const ns_line_ends *ends) {
    const ns_line_ends without = {ends->most, 0.0, 0.0};
    const double one = ns_bridge_diode_law_line(law, amperes, ends);
    const double first = ns_bridge_diode_law_line(law, amperes, &without);
    const double knee = fmax(ends->most, bends * amperes);
    const double at_knee = ns_bridge_diode_law_voltage(law, amperes) + first * (knee - amperes);
    const double rise = ns_bridge_diode_law_voltage(law, ends->rush) - at_knee;
    if (!(one < (1.0 - 1e-6) * first && rise > 0.0))
        return (ns_diode_lines){.slope = one};
    return (ns_diode_lines){first, knee, rise / (ends->rush - knee)};
}

double ns_bridge_breakdown_law_voltage(const ns_breakdown_law *law, double amperes) {
    return law->at + law->volts * log(amperes / law->amperes);
}

double ns_bridge_breakdown_law_line(const ns_breakdown_law *law, double amperes, const ns_line_ends *ends) {
    return ns_bridge_line_slope(law->volts / amperes, ns_bridge_breakdown_law_voltage(law, amperes),
                                ns_bridge_breakdown_law_voltage(law, ends->most),
                                ns_bridge_breakdown_law_voltage(law, ends->rush), amperes, ends);
}

void ns_bridge_log_mean_add(ns_log_mean *mean, double amperes, double seconds, double least) {
    if (!(amperes > least) || !(seconds > 0.0) || !isfinite(amperes))
        return;
    mean->coulombs += amperes * seconds;
    mean->sum += log(amperes) * amperes * seconds;
    mean->most = fmax(mean->most, amperes);
}

double ns_bridge_log_mean_read(const ns_log_mean *mean) {
    return mean->coulombs > 0.0 ? exp(mean->sum / mean->coulombs) : 0.0;
}

void ns_bridge_pulse_mean_end(ns_pulse_mean *mean, double t) {
    const double amperes = mean->is_over && mean->on > 0.0 ? mean->pulse.coulombs / mean->on
                                                           : ns_bridge_log_mean_read(&mean->pulse);
    const double weight = sqrt((t - mean->began) * mean->on) * (amperes < NS_LEAK ? DBL_EPSILON : 1.0);
    if (amperes > 0.0) {
        mean->weight += weight;
        mean->sum += weight * log(amperes);
    }
    mean->pulse = (ns_log_mean){0};
    mean->began = t;
    mean->on = 0.0;
}

void ns_bridge_pulse_mean_add(ns_pulse_mean *mean, int is_on, double amperes, double from, double to) {
    const int flows = is_on && amperes > 0.0;
    if (flows && (mean->is_over || !(mean->pulse.coulombs > 0.0)))
        ns_bridge_pulse_mean_end(mean, from);
    mean->is_over = !flows;
    if (!flows)
        return;
    ns_bridge_log_mean_add(&mean->pulse, amperes, to - from, 0.0);
    mean->on += to - from;
    mean->most = fmax(mean->most, mean->pulse.most);
}

double ns_bridge_pulse_mean_read(const ns_pulse_mean *mean) {
    return mean->weight > 0.0 ? exp(mean->sum / mean->weight) : 0.0;
}
