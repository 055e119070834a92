/* bridge/pure/control_law.c - what d_osc and d_pwm make of their control. */
#include "control_law.h"

#include <math.h>

/* The line that v is on, by its left point. */
static int line_of(const ns_control_law *law, double v) {
    int k = 0;
    while (k < law->n - 2 && v >= law->x[k + 1])
        k++;
    return k;
}

static double slope_of(const ns_control_law *law, int k) {
    return (law->y[k + 1] - law->y[k]) / (law->x[k + 1] - law->x[k]);
}

double ns_bridge_control_law_slope(const ns_control_law *law, double v) {
    return slope_of(law, line_of(law, v));
}

double ns_bridge_control_law_value(const ns_control_law *law, double v) {
    const int k = line_of(law, v);
    return fmax(0.0, law->y[k] + (v - law->x[k]) * slope_of(law, k));
}

double ns_bridge_control_law_integral(const ns_control_law *law, double v0, double v1, double dt) {
    enum { PARTS = 8 }; /* exact but where a part has a corner */
    double sum = 0.0;
    for (int k = 0; k < PARTS; k++)
        sum += ns_bridge_control_law_value(law, v0 + (k + 0.5) / PARTS * (v1 - v0));
    return sum / PARTS * dt;
}

/* 1 if line k has the value y, at *v. */
static int has_value(const ns_control_law *law, int k, double y, double *v) {
    const double slope = slope_of(law, k);
    *v = law->x[k] + (y - law->y[k]) / slope;
    return slope != 0.0 && isfinite(*v) && (k == 0 || *v >= law->x[k]) &&
           (k == law->n - 2 || *v <= law->x[k + 1]);
}

double ns_bridge_control_law_control(const ns_control_law *law, double y, double v) {
    double nearest = INFINITY, at;
    if (ns_bridge_control_law_value(law, v) == y)
        return v;
    for (int k = 0; k < law->n - 1; k++)
        if (has_value(law, k, y, &at) && fabs(at - v) < fabs(nearest - v))
            nearest = at;
    return isinf(nearest) ? v : nearest;
}
