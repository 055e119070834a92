/* bridge/analog.c - XSPICE's analog code models that are piecewise linear: parameters in the order of their
 * ifspec.ifs. */
#include "analog.h"

#include <math.h>
#include <string.h>

#include "analog_ports.h"
#include "analog_waves.h"
#include "climits.h"

typedef ns_piecewise_value value;

static double number(const ns_analog *a, int parameter) {
    return ns_bridge_analog_number(a, parameter);
}

static value *constant(ns_analog *a, double x) {
    return ns_bridge_piecewise_constant(&a->p, x);
}

/* A limit that was given, else NULL: there is none. */
static value *limit_of(ns_analog *a, int parameter) {
    return ns_bridge_analog_given(a, parameter) ? constant(a, number(a, parameter)) : NULL;
}

static int refuse(ns_analog *a, const char *why) {
    if (a->p.status == NS_OK) {
        a->p.status = NS_E_RANGE;
        a->p.why = why;
    }
    return a->p.status;
}

/* --- without memory --- */

static int read_gain(ns_analog *a) {
    enum { IN_OFFSET, GAIN, OUT_OFFSET };
    value *v =
        ns_bridge_analog_scaled(a, number(a, GAIN), ns_bridge_analog_input(a, 0, 0), number(a, IN_OFFSET));
    return ns_bridge_analog_output(a, 1, ns_bridge_analog_scaled(a, 1.0, v, number(a, OUT_OFFSET)));
}

static int read_summer(ns_analog *a) {
    enum { IN_OFFSET, IN_GAIN, OUT_GAIN, OUT_OFFSET };
    value *sum = constant(a, 0.0);
    for (int k = 0; k < a->inst->conn[0]->size; k++) {
        const double offset =
            k < ns_bridge_analog_size(a, IN_OFFSET) ? ns_bridge_analog_element(a, IN_OFFSET, k) : 0.0;
        const double gain =
            k < ns_bridge_analog_size(a, IN_GAIN) ? ns_bridge_analog_element(a, IN_GAIN, k) : 1.0;
        sum = ns_bridge_piecewise_sum(
            &a->p, 1.0, sum, 1.0, ns_bridge_analog_scaled(a, gain, ns_bridge_analog_input(a, 0, k), offset));
    }
    value *v = ns_bridge_piecewise_sum(&a->p, number(a, OUT_GAIN), sum, 0.0, sum);
    return ns_bridge_analog_output(a, 1, ns_bridge_analog_scaled(a, 1.0, v, number(a, OUT_OFFSET)));
}

static int read_limit(ns_analog *a) {
    enum { IN_OFFSET, GAIN, LOWER, UPPER };
    value *v =
        ns_bridge_analog_scaled(a, number(a, GAIN), ns_bridge_analog_input(a, 0, 0), number(a, IN_OFFSET));
    return ns_bridge_analog_output(a, 1,
                                   ns_bridge_analog_limited(a, v, limit_of(a, LOWER), limit_of(a, UPPER)));
}

static int read_climit(ns_analog *a) {
    value *v = ns_bridge_analog_scaled(a, number(a, CLIMIT_GAIN), ns_bridge_analog_input(a, CLIMIT_IN, 0),
                                       number(a, CLIMIT_IN_OFFSET));
    value *high = ns_bridge_analog_scaled(a, 1.0, ns_bridge_analog_input(a, CLIMIT_UPPER, 0),
                                          -number(a, CLIMIT_UPPER_DELTA));
    value *low = ns_bridge_analog_scaled(a, 1.0, ns_bridge_analog_input(a, CLIMIT_LOWER, 0),
                                         number(a, CLIMIT_LOWER_DELTA));
    const int status = a->p.status ? a->p.status : ns_bridge_climits_keep(a->w->ex, a->inst);
    return status ? status
                  : ns_bridge_analog_output(a, CLIMIT_OUT, ns_bridge_analog_limited(a, v, low, high));
}

static int read_pwl(ns_analog *a) {
    enum { X, Y, DOMAIN, FRACTION, LIMIT };
    const int n = ns_bridge_analog_size(a, X);
    double *line = calloc(2 * (size_t)n + 1, sizeof *line);
    int ascending = n >= 2 && ns_bridge_analog_size(a, Y) == n;
    if (!line)
        return NS_E_MEMORY;
    for (int k = 0; k < n && ascending; k++) {
        line[2 * k] = ns_bridge_analog_element(a, X, k);
        line[2 * k + 1] = ns_bridge_analog_element(a, Y, k);
        ascending = k == 0 || line[2 * k] > line[2 * k - 2];
    }
    const int level = a->inst->param[LIMIT]->element[0].bvalue == MIF_TRUE;
    const int status =
        ascending
            ? ns_bridge_analog_output(
                  a, 1, ns_bridge_piecewise_line(&a->p, ns_bridge_analog_input(a, 0, 0), n, line, level))
            : refuse(a, "x_array and y_array need two points at least, by ascending x");
    free(line);
    return status;
}

/* POLY: constant, then one factor each input; the rest has to be zero. */
static int read_poly(ns_analog *a) {
    const int n = a->inst->conn[0]->size, count = ns_bridge_analog_size(a, 0);
    value *v = constant(a, count > 0 ? ns_bridge_analog_element(a, 0, 0) : 0.0);
    for (int k = n + 1; k < count; k++)
        if (ns_bridge_analog_element(a, 0, k) != 0.0)
            return refuse(a, "POLY of degree two or more: use E or B with pwl(x, x1, y1, ...)");
    for (int k = 0; k < n; k++) {
        value *in = ns_bridge_analog_input(a, 0, k);
        v = ns_bridge_piecewise_sum(&a->p, 1.0, v,
                                    k + 1 < count ? ns_bridge_analog_element(a, 0, k + 1) : 0.0, in);
    }
    return ns_bridge_analog_output(a, 1, v);
}

/* --- with memory --- */

/* Limits of an integrator hold its state: ideal diodes to sources. */
static int hold_state(ns_analog *a, int node, int parameter, int is_upper) {
    const ns_diode ideal = {0.0, 0.0, INFINITY, INFINITY, 0.0};
    ns_signal dc = {.kind = NS_DC};
    char name[EXTRACT_NAME];
    if (!ns_bridge_analog_given(a, parameter) || a->w->dc)
        return NS_OK;
    const int at = ns_bridge_analog_node(a);
    dc.u.dc = number(a, parameter);
    snprintf(name, sizeof name, "%.100s: limit %d", a->name, at);
    int status = ns_circuit_source(a->w->ex->circuit, name, NS_VOLTAGE, at, 0, &dc, NULL);
    snprintf(name, sizeof name, "%.100s: at limit %d", a->name, at);
    return status ? status
                  : ns_circuit_diode(a->w->ex->circuit, name, is_upper ? node : at, is_upper ? at : node,
                                     &ideal, NULL);
}

static int read_int(ns_analog *a) {
    enum { IN_OFFSET, GAIN, LOWER, UPPER, RANGE, IC };
    const int node = ns_bridge_analog_node(a);
    value *rate =
        ns_bridge_analog_scaled(a, number(a, GAIN), ns_bridge_analog_input(a, 0, 0), number(a, IN_OFFSET));
    int status = a->p.status ? a->p.status : ns_bridge_analog_state(a, node, number(a, IC), rate);
    status = status ? status : hold_state(a, node, LOWER, 0);
    status = status ? status : hold_state(a, node, UPPER, 1);
    return status ? status : ns_bridge_analog_output(a, 1, ns_bridge_analog_voltage(a, node));
}

/* The current of 1 F (scaled) at the input. */
static int read_d_dt(ns_analog *a) {
    enum { OUT_OFFSET, GAIN, LOWER, UPPER };
    static const double farads = 1e-6;
    const ns_signal zero = {.kind = NS_DC};
    ns_circuit *c = a->w->ex->circuit;
    const int at = ns_bridge_analog_node(a), end = ns_bridge_analog_node(a);
    char name[EXTRACT_NAME];
    ns_affine u;
    int id = -1;
    if (!ns_bridge_piecewise_affine(&a->p, ns_bridge_analog_input(a, 0, 0), &u))
        return a->p.status;
    snprintf(name, sizeof name, "%.100s: input %d", a->name, at);
    int status = ns_circuit_linear(c, name, NS_VOLTAGE, at, 0, u.constant, u.nterms, u.terms, NULL);
    snprintf(name, sizeof name, "%.100s: rate %d", a->name, at);
    status = status ? status : ns_circuit_capacitor(c, name, at, end, farads, NAN, NULL);
    snprintf(name, sizeof name, "%.100s: current %d", a->name, at);
    status = status ? status : ns_circuit_source(c, name, NS_VOLTAGE, end, 0, &zero, &id);
    if (status)
        return status;
    value *v = ns_bridge_piecewise_term(&a->p, (ns_term){1, id, number(a, GAIN) / farads});
    v = ns_bridge_analog_scaled(a, 1.0, v, number(a, OUT_OFFSET));
    return ns_bridge_analog_output(a, 1,
                                   ns_bridge_analog_limited(a, v, limit_of(a, LOWER), limit_of(a, UPPER)));
}

/* The rate of the output lies between two bounds: as far up as allowed while it is below the input, as far
 * down while it is above.  A start without uic begins at the input. */
static int read_slew(ns_analog *a) {
    enum { RISE, FALL };
    static const double farads = 1e-6;
    ns_circuit *c = a->w->ex->circuit;
    const int node = ns_bridge_analog_node(a);
    const double rise = number(a, RISE), fall = number(a, FALL);
    char name[EXTRACT_NAME];
    ns_affine y;
    int id = -1;
    value *in = ns_bridge_analog_input(a, 0, 0), *out = ns_bridge_analog_voltage(a, node);
    if (!(rise > 0.0 && fall > 0.0))
        return refuse(a, "rise_slope and fall_slope have to be above 0 (V/s)");
    if (a->w->dc)
        return a->p.status ? a->p.status : ns_bridge_analog_output(a, 1, in);
    if (!ns_bridge_piecewise_affine(&a->p, ns_bridge_piecewise_sum(&a->p, 1.0, out, -1.0, in), &y))
        return a->p.status;
    snprintf(name, sizeof name, "%.100s: slope %d", a->name, node);
    int status = ns_circuit_box(c, name, -fall * farads, rise * farads, &y, &id);
    snprintf(name, sizeof name, "%.100s: state %d", a->name, node);
    status = status ? status : ns_circuit_capacitor(c, name, node, 0, farads, NAN, NULL);
    snprintf(name, sizeof name, "%.100s: rate %d", a->name, node);
    status = status ? status
                    : ns_circuit_linear(c, name, NS_CURRENT, 0, node, 0.0, 1, &(ns_term){2, id, 1.0}, NULL);
    return status ? status : ns_bridge_analog_output(a, 1, out);
}

/* --- s_xfer: sum b_i s^i / sum a_i s^i by states x_i, the i-th derivative of the lowest one --- */

enum { ORDER_MAX = 20 };
enum { X_OFFSET, X_GAIN, X_NUM, X_DEN, X_IC, X_FREQUENCY };

typedef struct transfer {
    int order, size; /* of the denominator; of the numerator */
    double a[ORDER_MAX + 1], b[ORDER_MAX + 1];
    double omega; /* 1/s: states are x_i omega^(order-i), so that all are of one size */
    int node[ORDER_MAX];
} transfer;

static int read_coefficients(ns_analog *a, transfer *t) {
    const double scale = ns_bridge_analog_given(a, X_FREQUENCY) ? number(a, X_FREQUENCY) : 1.0;
    t->order = ns_bridge_analog_size(a, X_DEN) - 1;
    t->size = ns_bridge_analog_size(a, X_NUM);
    if (t->order < 0 || t->order > ORDER_MAX || t->size < 1 || t->size > t->order + 1)
        return refuse(
            a, "num_coeff has to have one coefficient at least, and no more than den_coeff (21 at most)");
    for (int i = 0; i <= t->order; i++)
        t->a[i] = ns_bridge_analog_element(a, X_DEN, t->order - i) / pow(scale, i);
    for (int i = 0; i < t->size; i++)
        t->b[i] = ns_bridge_analog_element(a, X_NUM, t->size - 1 - i) / pow(scale, i);
    const double highest = t->a[t->order];
    if (highest == 0.0 || !isfinite(highest))
        return refuse(a, "the first of den_coeff has to be a number other than 0");
    t->omega = 0.0;
    for (int i = 0; i <= t->order; i++) {
        t->a[i] /= highest;
        t->b[i] /= highest;
        if (i < t->order && t->a[i] != 0.0)
            t->omega = fmax(t->omega, pow(fabs(t->a[i]), 1.0 / (t->order - i)));
    }
    t->omega = t->omega > 0.0 ? t->omega : 1.0;
    return NS_OK;
}

/* x_i, but for the factor of its size. */
static double size_of(const transfer *t, int i) {
    return pow(t->omega, i - t->order);
}

static int read_s_xfer(ns_analog *a) {
    transfer t = {0};
    ns_piecewise *p = &a->p;
    int status = read_coefficients(a, &t);
    if (status)
        return status;
    value *in =
        ns_bridge_analog_scaled(a, number(a, X_GAIN), ns_bridge_analog_input(a, 0, 0), number(a, X_OFFSET));
    value *highest = in, *out = constant(a, 0.0); /* the derivative that is no state */
    for (int i = 0; i < t.order; i++) {
        t.node[i] = ns_bridge_analog_node(a);
        value *x = ns_bridge_analog_voltage(a, t.node[i]);
        highest = ns_bridge_piecewise_sum(p, 1.0, highest, -t.a[i] * size_of(&t, i), x);
        if (i < t.size)
            out = ns_bridge_piecewise_sum(p, 1.0, out, t.b[i] * size_of(&t, i), x);
    }
    if (t.size > t.order)
        out = ns_bridge_piecewise_sum(p, 1.0, out, t.b[t.order], highest);
    for (int i = 0; i < t.order && !status && !p->status; i++) {
        const int at = t.order - 1 - i; /* of int_ic, whose first is that of the highest state */
        const double ic = at < ns_bridge_analog_size(a, X_IC) ? ns_bridge_analog_element(a, X_IC, at) : 0.0;
        value *rate = i + 1 < t.order ? ns_bridge_analog_voltage(a, t.node[i + 1]) : highest;
        const double scale = i + 1 < t.order ? t.omega : 1.0 / size_of(&t, i);
        status = ns_bridge_analog_state(a, t.node[i], ic / size_of(&t, i),
                                        ns_bridge_piecewise_sum(p, scale, rate, 0.0, rate));
    }
    return status || p->status ? (status ? status : p->status) : ns_bridge_analog_output(a, 1, out);
}

/* --- hyst: two limited lines; a switch with hysteresis says which --- */

static int add_memory(ns_analog *a, const value *in, double on, double off, int *node) {
    ns_circuit *c = a->w->ex->circuit;
    const ns_signal one = {.kind = NS_DC, .u.dc = 1.0};
    const ns_switch sw = {0.5 * (on + off), 0.5 * (on - off), 0.0, INFINITY};
    const int at = ns_bridge_analog_node(a), from = ns_bridge_analog_node(a);
    char name[EXTRACT_NAME];
    ns_affine u;
    *node = ns_bridge_analog_node(a);
    if (!in || !ns_bridge_piecewise_affine(&a->p, in, &u))
        return a->p.status;
    snprintf(name, sizeof name, "%.100s: input %d", a->name, at);
    int status = ns_circuit_linear(c, name, NS_VOLTAGE, at, 0, u.constant, u.nterms, u.terms, NULL);
    snprintf(name, sizeof name, "%.100s: high %d", a->name, at);
    status = status ? status : ns_circuit_source(c, name, NS_VOLTAGE, from, 0, &one, NULL);
    snprintf(name, sizeof name, "%.100s: state %d", a->name, at);
    status = status ? status : ns_circuit_switch(c, name, from, *node, at, 0, &sw, NULL);
    snprintf(name, sizeof name, "%.100s: load %d", a->name, at);
    return status ? status : ns_circuit_resistor(c, name, *node, 0, 1e3, NULL);
}

static int read_hyst(ns_analog *a) {
    enum { IN_LOW, IN_HIGH, HYST, LOWER, UPPER };
    const double low = number(a, IN_LOW), high = number(a, IN_HIGH), hyst = number(a, HYST);
    const double bottom = number(a, LOWER), top = number(a, UPPER);
    const double rising[] = {low + hyst, bottom, high + hyst, top},
                 falling[] = {low - hyst, bottom, high - hyst, top};
    int node;
    if (!(high > low) || !(high + hyst >= low - hyst))
        return refuse(a, "in_high has to be above in_low, and hyst at least half of (in_low - in_high)");
    value *in = ns_bridge_analog_input(a, 0, 0);
    const int status = add_memory(a, in, rising[2], falling[0], &node);
    if (status)
        return status;
    value *state = ns_bridge_analog_scaled(a, 1.0, ns_bridge_analog_voltage(a, node), -0.5);
    value *of_rising = ns_bridge_piecewise_line(&a->p, in, 2, rising, 1);
    value *of_falling = ns_bridge_piecewise_line(&a->p, in, 2, falling, 1);
    return ns_bridge_analog_output(
        a, 1,
        ns_bridge_piecewise_choose(&a->p, ns_bridge_piecewise_above(&a->p, state), of_falling, of_rising));
}

/* --- all of them --- */

static const struct model {
    const char *name;
    int (*read)(ns_analog *a);
    const char *left_out; /* what smooths its corners; NULL: nothing does */
} models[] = {{"gain", read_gain, NULL},
              {"summer", read_summer, NULL},
              {"limit", read_limit, "limit_range"},
              {"climit", read_climit, "limit_range"},
              {"pwl", read_pwl, "input_domain"},
              {"spice2poly", read_poly, NULL},
              {"int", read_int, "limit_range"},
              {"d_dt", read_d_dt, "limit_range"},
              {"slew", read_slew, NULL},
              {"s_xfer", read_s_xfer, NULL},
              {"hyst", read_hyst, "input_domain"},
              {"sine", ns_bridge_analog_sine, NULL},
              {"triangle", ns_bridge_analog_triangle, NULL},
              {"square", ns_bridge_analog_square, NULL}};

static int read_as(ns_extract_walk *w, MIFinstance *inst, const struct model *m) {
    ns_analog a = {.w = w, .inst = inst, .model = m->name};
    ns_bridge_extract_users_name(w, &inst->gen, a.name, sizeof a.name);
    if (w->next_node <= w->ex->neq)
        w->next_node = w->ex->neq + 1;
    a.p = (ns_piecewise){.circuit = w->ex->circuit, .name = a.name, .next_node = &w->next_node};
    int status = m->read(&a);
    if (status && a.p.why)
        status = ns_bridge_extract_refuse(w, &inst->gen, a.p.why);
    if (m->left_out && !*w->ex->sharp.name) {
        snprintf(w->ex->sharp.name, sizeof w->ex->sharp.name, "%.79s", a.name);
        w->ex->sharp.what = m->left_out;
    }
    ns_bridge_piecewise_free(&a.p);
    return status;
}

int ns_bridge_analog_read(ns_extract_walk *w, MIFinstance *inst, const char *model) {
    char what[240];
    if (!ns_bridge_analog_is_ready(w, inst))
        return EXTRACT_LATER;
    for (size_t k = 0; k < sizeof models / sizeof models[0]; k++)
        if (strcmp(models[k].name, model) == 0)
            return read_as(w, inst, &models[k]);
    snprintf(what, sizeof what, "code model %.40s is not supported: of the analog ones, %s are", model,
             "gain, summer, limit, climit, pwl, int, d_dt, slew, s_xfer, hyst, sine, triangle, square and "
             "POLY of degree one");
    return ns_bridge_extract_refuse(w, &inst->gen, what);
}
