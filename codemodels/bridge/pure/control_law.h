/* bridge/pure/control_law.h - what d_osc and d_pwm make of their control: a frequency or a duty cycle. */
#ifndef BRIDGE_CONTROL_LAW_H
#define BRIDGE_CONTROL_LAW_H

/* Straight lines between n points, two or more, x rising; the outer lines go on beyond them. */
typedef struct ns_control_law {
    int n;
    double *x; /* V or A */
    double *y; /* Hz, or a part of a period */
} ns_control_law;

/* The value at v, at least 0. */
double ns_bridge_control_law_value(const ns_control_law *law, double v);

/* Its slope there. */
double ns_bridge_control_law_slope(const ns_control_law *law, double v);

/* Its integral while the control goes from v0 to v1 in dt, s, along a straight line. */
double ns_bridge_control_law_integral(const ns_control_law *law, double v0, double v1, double dt);

/* The control nearest to v whose value is y; v, if there is none. */
double ns_bridge_control_law_control(const ns_control_law *law, double y, double v);

#endif
