/* src/circuit/values.c - kinks and choices: elements that are a value, checked and added. */
#include <stdlib.h>

#include "circuit_internal.h"

static int check_affine(ns_circuit *c, const char *name, const ns_affine *u) {
    int status;
    if (!u || u->nterms < 0 || (u->nterms > 0 && !u->terms)) {
        return ns_circuit_complain(c, u && u->nterms < 0 ? NS_E_SIZE : NS_E_NULL,
                                   "%.80s: its terms are missing", name);
    }
    if ((status = ns_circuit_check_finite(c, name, "constant", u->constant))) {
        return status;
    }
    for (int i = 0; i < u->nterms; i++) {
        if ((status = ns_circuit_check_term(c, name, &u->terms[i]))) {
            return status;
        }
    }
    return NS_OK;
}

int ns_circuit_kink(ns_circuit *c, const char *name, const ns_affine *u, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, KINK, name, 0, (int[]){0});
    if (status || (status = check_affine(c, name, u))) {
        return status;
    }
    e.value = u->constant;
    e.nterms = u->nterms;
    e.terms = (ns_term *)u->terms; /* copied */
    return ns_circuit_add_element(c, &e, (needs){.pairs = 1}, id);
}

int ns_circuit_box(ns_circuit *c, const char *name, double low, double high, const ns_affine *y, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, BOX, name, 0, (int[]){0});
    if (status || (status = check_affine(c, name, y)) ||
        (status = ns_circuit_check_finite(c, name, "low", low)) ||
        (status = ns_circuit_check_finite(c, name, "high", high))) {
        return status;
    }
    if (!(low < high)) {
        return ns_circuit_complain(c, NS_E_RANGE, "%.80s: low = %g must be below high = %g", name, low, high);
    }
    e.low = low;
    e.high = high;
    e.value = y->constant;
    e.nterms = y->nterms;
    e.terms = (ns_term *)y->terms; /* copied */
    return ns_circuit_add_element(c, &e, (needs){.pairs = 1}, id);
}

/* The terms of both, those of the control first. */
static int join_terms(ns_circuit *c, element *e, const ns_affine *control, const ns_affine *u) {
    e->ncontrol = control->nterms;
    e->nterms = control->nterms + u->nterms;
    e->terms = calloc((size_t)e->nterms + 1, sizeof *e->terms);
    if (!e->terms) {
        return ns_circuit_complain(c, NS_E_MEMORY, "%.80s: out of memory", e->name);
    }
    for (int i = 0; i < e->nterms; i++) {
        e->terms[i] = i < e->ncontrol ? control->terms[i] : u->terms[i - e->ncontrol];
    }
    return NS_OK;
}

int ns_circuit_choice(ns_circuit *c, const char *name, const ns_affine *control, double threshold,
                      const ns_affine *u, int *id) {
    element e;
    int status = ns_circuit_start_element(c, &e, CHOICE, name, 0, (int[]){0});
    if (status || (status = check_affine(c, name, control)) || (status = check_affine(c, name, u)) ||
        (status = ns_circuit_check_finite(c, name, "threshold", threshold))) {
        return status;
    }
    for (int i = 0; i < control->nterms; i++) {
        if (control->terms[i].is_current == 2) {
            return ns_circuit_complain(c, NS_E_RANGE,
                                       "%.80s: its control has the value of a kink or a choice", name);
        }
    }
    if ((status = join_terms(c, &e, control, u))) {
        return status;
    }
    e.value = u->constant;
    e.control = control->constant;
    e.sw.vt = threshold;
    status = ns_circuit_add_element(c, &e, (needs){.pairs = 1, .commands = 1}, id);
    free(e.terms);
    return status;
}
