/* src/circuit/elements.c - elements are checked and added; after a refusal the circuit is unchanged. */
#include <math.h>
#include <string.h>

#include "circuit_internal.h"

static const char must_finite[] = "must be a finite number", must_number[] = "must be a number";
static const char must_positive[] = "must be positive", must_0[] = "must be at least 0";

static int check_name(ns_circuit *c, const char *name) {
    if (!name) {
        return ns_circuit_complain(c, NS_E_NULL, "element %d: its name is missing", c->nelements);
    }
    if (!*name) {
        return ns_circuit_complain(c, NS_E_NAME, "element %d: its name is empty", c->nelements);
    }
    return ns_circuit_find_name(c, name) < 0
               ? NS_OK
               : ns_circuit_complain(c, NS_E_NAME, "%.80s: this name is given twice", name);
}

static int check_nodes(ns_circuit *c, const element *e) {
    for (int i = 0; i < e->nnodes; i++) {
        if (e->node[i] < 0) {
            return ns_circuit_complain(c, NS_E_SIZE, "%.80s: number of node = %d must be at least 0", e->name,
                                       e->node[i]);
        }
    }
    return NS_OK;
}

/* A blank element of this kind; its name and its nodes (p n cp cn) are checked. */
int ns_circuit_start_element(ns_circuit *c, element *e, element_kind kind, const char *name, int nnodes,
                             const int *nodes) {
    int status;
    memset(e, 0, sizeof *e);
    e->kind = kind;
    e->name = (char *)name; /* copied by ns_circuit_add_element() */
    e->nnodes = nnodes;
    memcpy(e->node, nodes, (size_t)nnodes * sizeof *nodes);
    e->ic = NAN;
    e->by[0] = e->by[1] = -1;
    if (!c) {
        return NS_E_NULL;
    }
    status = check_name(c, name);
    return status ? status : check_nodes(c, e);
}

static int refuse_element(ns_circuit *c, const char *name, int status, const ns_refusal *why) {
    if (isnan(why->than)) {
        return ns_circuit_complain(c, status, "%.80s: %s = %g %s", name, why->parameter, why->value,
                                   why->must);
    }
    return ns_circuit_complain(c, status, "%.80s: %s = %g %s = %g", name, why->parameter, why->value,
                               why->must, why->than);
}

int ns_circuit_check_finite(ns_circuit *c, const char *name, const char *parameter, double value) {
    return isfinite(value) ? NS_OK
                           : ns_circuit_complain(c, NS_E_NUMBER, "%.80s: %s = %g %s", name, parameter, value,
                                                 must_finite);
}

/* A size of a resistor, capacitor or inductor, and its initial condition. */
static int check_size(ns_circuit *c, const element *e, const char *parameter, int negative_too) {
    int status = ns_circuit_check_finite(c, e->name, parameter, e->value);
    if (status) {
        return status;
    }
    if (e->value < 0 && !negative_too) {
        return ns_circuit_complain(c, NS_E_RANGE, "%.80s: %s = %g %s", e->name, parameter, e->value, must_0);
    }
    return isnan(e->ic) ? NS_OK : ns_circuit_check_finite(c, e->name, "ic", e->ic);
}

int ns_circuit_resistor(ns_circuit *c, const char *name, int p, int n, double ohms, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, RESISTOR, name, 2, (int[]){p, n});
    e.value = ohms;
    if (status || (status = check_size(c, &e, "resistance", 1))) {
        return status;
    }
    if (ohms != 0 && !isfinite(1 / ohms)) {
        return ns_circuit_complain(
            c, NS_E_RANGE, "%.80s: resistance = %g is too small to invert (0 is allowed)", name, ohms);
    }
    return ns_circuit_add_element(c, &e, (needs){.currents = ohms == 0}, id);
}

int ns_circuit_capacitor(ns_circuit *c, const char *name, int p, int n, double farads, double ic, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, CAPACITOR, name, 2, (int[]){p, n});
    e.value = farads;
    e.ic = ic;
    if (status || (status = check_size(c, &e, "capacitance", 0))) {
        return status;
    }
    return ns_circuit_add_element(c, &e, (needs){0}, id);
}

int ns_circuit_inductor(ns_circuit *c, const char *name, int p, int n, double henries, double ic, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, INDUCTOR, name, 2, (int[]){p, n});
    e.value = henries;
    e.ic = ic;
    if (status || (status = check_size(c, &e, "inductance", 0))) {
        return status;
    }
    return ns_circuit_add_element(c, &e, (needs){.currents = 1}, id);
}

static int check_element(ns_circuit *c, const char *name, int of) {
    return of >= 0 && of < c->nelements
               ? NS_OK
               : ns_circuit_complain(c, NS_E_SIZE, "%.80s: there is no element %d to refer to", name, of);
}

static int check_inductor(ns_circuit *c, const char *name, int of) {
    int status = check_element(c, name, of);
    if (!status && c->element[of].kind != INDUCTOR) {
        status =
            ns_circuit_complain(c, NS_E_SIZE, "%.80s: %.80s is not an inductor", name, c->element[of].name);
    }
    return status;
}

static int check_current(ns_circuit *c, const char *name, int of) {
    int status = check_element(c, name, of);
    if (!status && c->element[of].current < 0) {
        status = ns_circuit_complain(c, NS_E_SIZE,
                                     "%.80s: the current of %.80s is not an unknown that can control", name,
                                     c->element[of].name);
    }
    return status;
}

int ns_circuit_coupling(ns_circuit *c, const char *name, int l1, int l2, double k, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, COUPLING, name, 0, (int[]){0});
    e.value = k;
    e.by[0] = l1;
    e.by[1] = l2;
    if (status || (status = check_inductor(c, name, l1)) || (status = check_inductor(c, name, l2)) ||
        (status = ns_circuit_check_finite(c, name, "coupling", k))) {
        return status;
    }
    if (l1 == l2) {
        return ns_circuit_complain(c, NS_E_SIZE, "%.80s: couples %.80s with itself", name,
                                   c->element[l1].name);
    }
    if (fabs(k) > 1) {
        return ns_circuit_complain(c, NS_E_RANGE, "%.80s: coupling = %g must lie between -1 and 1", name, k);
    }
    return ns_circuit_add_element(c, &e, (needs){0}, id);
}

static int check_output(ns_circuit *c, const char *name, ns_output kind) {
    return kind == NS_VOLTAGE || kind == NS_CURRENT
               ? NS_OK
               : ns_circuit_complain(c, NS_E_RANGE, "%.80s: kind of output = %d is unknown", name, (int)kind);
}

int ns_circuit_source(ns_circuit *c, const char *name, ns_output kind, int p, int n, const ns_signal *s,
                      int *id) {
    element e;
    ns_refusal why;
    int status = ns_circuit_start_element(c, &e, SOURCE, name, 2, (int[]){p, n});
    if (status || (status = check_output(c, name, kind))) {
        return status;
    }
    if (!s) {
        return ns_circuit_complain(c, NS_E_NULL, "%.80s: its signal is missing", name);
    }
    if ((status = ns_system_signal_check_why(s, &why))) {
        return refuse_element(c, name, status, &why);
    }
    e.output = kind;
    e.signal = *s;
    return ns_circuit_add_element(c, &e, (needs){.currents = kind == NS_VOLTAGE, .inputs = s->kind != NS_DC},
                                  id);
}

int ns_circuit_vcontrolled(ns_circuit *c, const char *name, ns_output kind, int p, int n, int cp, int cn,
                           double gain, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, VCONTROLLED, name, 4, (int[]){p, n, cp, cn});
    if (status || (status = check_output(c, name, kind)) ||
        (status = ns_circuit_check_finite(c, name, "gain", gain))) {
        return status;
    }
    e.output = kind;
    e.value = gain;
    return ns_circuit_add_element(c, &e, (needs){.currents = kind == NS_VOLTAGE}, id);
}

int ns_circuit_icontrolled(ns_circuit *c, const char *name, ns_output kind, int p, int n, int by, double gain,
                           int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, ICONTROLLED, name, 2, (int[]){p, n});
    if (status || (status = check_output(c, name, kind)) || (status = check_current(c, name, by)) ||
        (status = ns_circuit_check_finite(c, name, "gain", gain))) {
        return status;
    }
    e.output = kind;
    e.value = gain;
    e.by[0] = by;
    return ns_circuit_add_element(c, &e, (needs){.currents = kind == NS_VOLTAGE}, id);
}

int ns_circuit_check_term(ns_circuit *c, const char *name, const ns_term *t) {
    int status = ns_circuit_check_finite(c, name, "gain", t->gain);
    if (status) {
        return status;
    }
    if (t->is_current == 1) {
        return check_current(c, name, t->of);
    }
    if (t->is_current == 2) {
        status = check_element(c, name, t->of);
        return status || c->element[t->of].kind >= KINK
                   ? status
                   : ns_circuit_complain(c, NS_E_SIZE, "%.80s: %.80s is no kink and no choice", name,
                                         c->element[t->of].name);
    }
    if (t->is_current) {
        return ns_circuit_complain(c, NS_E_RANGE, "%.80s: kind of term = %d is unknown", name, t->is_current);
    }
    return t->of >= 0
               ? NS_OK
               : ns_circuit_complain(c, NS_E_SIZE, "%.80s: number of node = %d %s", name, t->of, must_0);
}

int ns_circuit_linear(ns_circuit *c, const char *name, ns_output kind, int p, int n, double constant,
                      int nterms, const ns_term *terms, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, LINEAR, name, 2, (int[]){p, n});
    if (status || (status = check_output(c, name, kind)) ||
        (status = ns_circuit_check_finite(c, name, "constant", constant))) {
        return status;
    }
    if (nterms < 0 || (nterms > 0 && !terms)) {
        return ns_circuit_complain(c, nterms < 0 ? NS_E_SIZE : NS_E_NULL, "%.80s: its %d terms are missing",
                                   name, nterms);
    }
    for (int i = 0; i < nterms; i++) {
        if ((status = ns_circuit_check_term(c, name, &terms[i]))) {
            return status;
        }
    }
    e.output = kind;
    e.value = constant;
    e.nterms = nterms;
    e.terms = (ns_term *)terms; /* copied */
    return ns_circuit_add_element(c, &e, (needs){.currents = kind == NS_VOLTAGE}, id);
}

double ns_circuit_kink_factor(double r, double roff) {
    return isinf(roff) ? 1 : roff / (roff - r);
}

int ns_circuit_pairs_of(const element *e) {
    return e->kind == DIODE && !isinf(e->diode.vz) ? 2 : 1;
}

/* 0 <= r < roff, called r_name; 1/roff finite. */
static int check_resistances(const char *r_name, double r, double roff, ns_refusal *why) {
    const char *larger = strcmp(r_name, "ron") ? "must be larger than rz" : "must be larger than ron";
    const ns_rule rule[] = {{!isfinite(r), NS_E_NUMBER, {r_name, r, must_finite, NAN}},
                            {isnan(roff), NS_E_NUMBER, {"roff", roff, must_number, NAN}},
                            {r < 0, NS_E_RANGE, {r_name, r, must_0, NAN}},
                            {!(roff > r), NS_E_RANGE, {"roff", roff, larger, r}},
                            {!isfinite(1 / roff), NS_E_RANGE, {"roff", roff, "is too small to invert", NAN}}};
    return ns_system_signal_check_rules(5, rule, why);
}

static int check_breakdown(const ns_diode *d, ns_refusal *why) {
    const ns_rule rule[] = {{isnan(d->vz), NS_E_NUMBER, {"vz", d->vz, must_number, NAN}},
                            {!(d->vz > 0), NS_E_RANGE, {"vz", d->vz, must_positive, NAN}}};
    int status = ns_system_signal_check_rules(2, rule, why);
    if (status || isinf(d->vz)) { /* then rz has no meaning */
        return status;
    }
    const double breaks = -d->vz * ns_circuit_kink_factor(d->rz, d->roff),
                 conducts = d->vf * ns_circuit_kink_factor(d->ron, d->roff);
    const ns_rule apart = {
        breaks >= conducts, NS_E_RANGE, {"vz", d->vz, "must keep breakdown below conduction at vf", d->vf}};
    status = check_resistances("rz", d->rz, d->roff, why);
    return status ? status : ns_system_signal_check_rules(1, &apart, why);
}

static int check_diode(const ns_diode *d, ns_refusal *why) {
    const ns_rule finite = {!isfinite(d->vf), NS_E_NUMBER, {"vf", d->vf, must_finite, NAN}};
    int status = ns_system_signal_check_rules(1, &finite, why);
    if (!status) {
        status = check_resistances("ron", d->ron, d->roff, why);
    }
    return status ? status : check_breakdown(d, why);
}

int ns_circuit_diode(ns_circuit *c, const char *name, int anode, int cathode, const ns_diode *d, int *id) {
    element e;
    ns_refusal why;
    int status = ns_circuit_start_element(c, &e, DIODE, name, 2, (int[]){anode, cathode});
    if (status) {
        return status;
    }
    if (!d) {
        return ns_circuit_complain(c, NS_E_NULL, "%.80s: its parameters are missing", name);
    }
    if ((status = check_diode(d, &why))) {
        return refuse_element(c, name, status, &why);
    }
    e.diode = *d;
    return ns_circuit_add_element(c, &e, (needs){.pairs = ns_circuit_pairs_of(&e)}, id);
}

static int check_switch(const ns_switch *s, ns_refusal *why) {
    const ns_rule rule[] = {{!isfinite(s->vt), NS_E_NUMBER, {"vt", s->vt, must_finite, NAN}},
                            {!isfinite(s->vh), NS_E_NUMBER, {"vh", s->vh, must_finite, NAN}},
                            {s->vh < 0, NS_E_RANGE, {"vh", s->vh, must_0, NAN}}};
    const int status = ns_system_signal_check_rules(3, rule, why);
    return status ? status : check_resistances("ron", s->ron, s->roff, why);
}

/* A switch whose element is begun. */
static int add_switch(ns_circuit *c, element *e, const ns_switch *s, int *id) {
    ns_refusal why;
    int status;
    if (!s) {
        return ns_circuit_complain(c, NS_E_NULL, "%.80s: its parameters are missing", e->name);
    }
    if ((status = check_switch(s, &why))) {
        return refuse_element(c, e->name, status, &why);
    }
    e->sw = *s;
    return ns_circuit_add_element(c, e, (needs){.pairs = 1, .commands = 1}, id);
}

int ns_circuit_switch(ns_circuit *c, const char *name, int p, int n, int cp, int cn, const ns_switch *s,
                      int *id) {
    element e;
    const int status = ns_circuit_start_element(c, &e, SWITCH, name, 4, (int[]){p, n, cp, cn});
    return status ? status : add_switch(c, &e, s, id);
}

int ns_circuit_switch_by_current(ns_circuit *c, const char *name, int p, int n, int by, double gain,
                                 const ns_switch *s, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, SWITCH, name, 2, (int[]){p, n});
    if (status || (status = check_current(c, name, by)) ||
        (status = ns_circuit_check_finite(c, name, "gain", gain))) {
        return status;
    }
    e.by[0] = by;
    e.value = gain;
    return add_switch(c, &e, s, id);
}

int ns_circuit_check_is(ns_circuit *c, int id, element_kind kind, const char *what) {
    if (!c) {
        return NS_E_NULL;
    }
    if (id < 0 || id >= c->nelements || c->element[id].kind != kind) {
        return ns_circuit_complain(c, NS_E_SIZE, "there is no %s %d", what, id);
    }
    return NS_OK;
}

int ns_circuit_switch_initially(ns_circuit *c, int id, int closed) {
    const int status = ns_circuit_check_is(c, id, SWITCH, "switch");
    if (status == NS_OK) {
        c->element[id].closed = closed != 0;
    }
    return status;
}
