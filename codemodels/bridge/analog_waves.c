/* bridge/analog_waves.c - XSPICE's sine, triangle and square with a constant control: waves of time. */
#include "analog_waves.h"

#include <math.h>

#include "expression.h"

enum { CONTROLS, FREQUENCIES, LOW, HIGH, DUTY, RISE, FALL }; /* as in their ifspec.ifs */

static int refuse(ns_analog *a, const char *why) {
    if (a->p.status == NS_OK) {
        a->p.status = NS_E_RANGE;
        a->p.why = why;
    }
    return a->p.status;
}

/* 1 if V of DC alone set the voltage of a node. */
static int is_known(const ns_analog *a, int node, double *volts) {
    *volts = 0.0;
    return node == 0 || ns_bridge_expression_supply(a->w, node, volts);
}

static int control_of(const ns_analog *a, double *volts) {
    const Mif_Port_Data_t *port = a->inst->conn[0]->port[0];
    double minus = 0.0;
    if ((port->type != MIF_VOLTAGE && port->type != MIF_DIFF_VOLTAGE) ||
        !is_known(a, port->smp_data.pos_node, volts) ||
        (port->type == MIF_DIFF_VOLTAGE && !is_known(a, port->smp_data.neg_node, &minus)))
        return 0;
    *volts -= minus;
    return 1;
}

/* On the line of the piece that x lies in; the first and the last one go on for ever. */
static double frequency_at(const ns_analog *a, int n, double x) {
    int k = 0;
    while (k + 2 < n && x >= ns_bridge_analog_element(a, CONTROLS, k + 1))
        k++;
    const double x0 = ns_bridge_analog_element(a, CONTROLS, k),
                 x1 = ns_bridge_analog_element(a, CONTROLS, k + 1);
    const double y0 = ns_bridge_analog_element(a, FREQUENCIES, k),
                 y1 = ns_bridge_analog_element(a, FREQUENCIES, k + 1);
    return y0 + (y1 - y0) * ((x - x0) / (x1 - x0));
}

static int is_ascending(const ns_analog *a, int n) {
    for (int k = 1; k < n; k++)
        if (!(ns_bridge_analog_element(a, CONTROLS, k) > ns_bridge_analog_element(a, CONTROLS, k - 1)))
            return 0;
    return 1;
}

static int find_frequency(ns_analog *a, double *hertz) {
    const int n = ns_bridge_analog_size(a, CONTROLS);
    double volts;
    if (n < 2 || ns_bridge_analog_size(a, FREQUENCIES) != n || !is_ascending(a, n))
        return refuse(a, "cntl_array and freq_array need two values each at least, by ascending control");
    if (!control_of(a, &volts))
        return refuse(
            a, "of square, triangle and sine the control has to be constant, the voltage of a V of DC "
               "to ground: write a V of PULSE or SIN in its place, or, where the frequency varies, d_osc "
               "with a dac_bridge");
    *hertz = frequency_at(a, n, volts);
    return *hertz > 0.0 && isfinite(*hertz) ? NS_OK : refuse(a, "its frequency has to be above 0 Hz");
}

static int put_out(ns_analog *a, const char *kind, const ns_signal *z) {
    int node = 0;
    const int status = ns_bridge_expression_wave(a->w, kind, z, &node);
    return status ? status : ns_bridge_analog_output(a, 1, ns_bridge_analog_voltage(a, node));
}

int ns_bridge_analog_sine(ns_analog *a) {
    const double low = ns_bridge_analog_number(a, LOW), high = ns_bridge_analog_number(a, HIGH);
    ns_signal z = {.kind = NS_SIN};
    const int status = find_frequency(a, &z.u.sin.freq);
    if (status)
        return status;
    z.u.sin.vo = 0.5 * (high + low);
    z.u.sin.va = 0.5 * (high - low);
    return put_out(a, "sine", &z);
}

/* Between its two levels, with its period; without edges. */
static int begin_pulse(ns_analog *a, ns_signal *z) {
    double hertz;
    const int status = find_frequency(a, &hertz);
    *z = (ns_signal){.kind = NS_PULSE};
    if (status)
        return status;
    z->u.pulse.v1 = ns_bridge_analog_number(a, LOW);
    z->u.pulse.v2 = ns_bridge_analog_number(a, HIGH);
    z->u.pulse.per = 1.0 / hertz;
    return NS_OK;
}

/* Up for the part `duty` of a period, down for the rest. */
int ns_bridge_analog_triangle(ns_analog *a) {
    const double duty = ns_bridge_analog_number(a, DUTY);
    ns_signal z;
    const int status = begin_pulse(a, &z);
    if (status)
        return status;
    z.u.pulse.tr = duty * z.u.pulse.per;
    z.u.pulse.tf = z.u.pulse.per - z.u.pulse.tr;
    return put_out(a, "triangle", &z);
}

/* A period begins low; its last part `duty`, the rise included, is high, and the fall is in the next one. */
int ns_bridge_analog_square(ns_analog *a) {
    const double duty = ns_bridge_analog_number(a, DUTY);
    ns_signal z;
    const int status = begin_pulse(a, &z);
    if (status)
        return status;
    z.u.pulse.td = (1.0 - duty) * z.u.pulse.per;
    z.u.pulse.tr = ns_bridge_analog_number(a, RISE);
    z.u.pulse.tf = ns_bridge_analog_number(a, FALL);
    z.u.pulse.pw = duty * z.u.pulse.per - z.u.pulse.tr;
    if (!(z.u.pulse.tr >= 0.0 && z.u.pulse.pw >= 0.0 && z.u.pulse.tf >= 0.0 && z.u.pulse.tf <= z.u.pulse.td))
        return refuse(a,
                      "rise_time has to be within the high part of a period, fall_time within the low one");
    return put_out(a, "square", &z);
}
