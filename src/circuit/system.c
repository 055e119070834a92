/* src/circuit/system.c - ns_circuit_system(): the system (S1)-(S4) of a circuit, dense or large. */
#include "circuit_internal.h"

/* Unknowns and pairs from which on a system is made large: dense arrays would be slow and big. */
enum { LARGE = 400 };

typedef struct inductances {
    ns_inductor_cuts cuts;
    ns_entries henries; /* by elements */
} inductances;

static void add_inductance(void *data, int row, int column, double henries) {
    inductances *to = data;
    const ns_inductor_cuts *cuts = &to->cuts;
    const int first = cuts->first[column], count = cuts->count[column];
    if (count == 0)
        ns_linalg_entries_add(&to->henries, row, column, henries);
    for (int k = first; k < first + count; k++)
        ns_linalg_entries_add(&to->henries, row, cuts->of[k], cuts->sign[k] * henries);
}

static void stamp_inductances(const stamp *to, const ns_csc *henries) {
    const ns_circuit *c = to->c;
    for (int j = 0; j < henries->columns; j++)
        for (int k = henries->start[j]; k < henries->start[j + 1]; k++)
            ns_circuit_stamp_add(to, IN_M, ns_circuit_current_unknown(c, henries->row[k]),
                                 ns_circuit_current_unknown(c, j), henries->value[k]);
}

/* What cancels to rounding is left out: two windings that k = 1 couples, and that carry one current forth and
 * back, have no inductance, not 1e-21 H. */
static int add_inductances(const stamp *to) {
    const int elements = to->c->nelements;
    inductances of = {0};
    ns_csc henries = {0};
    int status = ns_circuit_find_cuts(to->c, &of.cuts);
    if (status == NS_OK)
        ns_circuit_each_inductance(to->c, add_inductance, &of);
    if (status == NS_OK)
        status = ns_linalg_csc_of_terms(elements, elements, &of.henries, &henries);
    if (status == NS_OK)
        stamp_inductances(to, &henries);
    ns_linalg_csc_free(&henries);
    ns_linalg_entries_free(&of.henries);
    ns_circuit_free_cuts(&of.cuts);
    return status;
}

static int stamp_all(const stamp *to) {
    const ns_circuit *c = to->c;
    for (int i = 0; i < c->nused; i++)
        to->s->balance[i] = 1;
    for (int j = 0; j < to->s->n; j++)
        to->s->ground[j] = 0;
    for (int i = 0; i < c->nelements; i++) {
        const element *e = &c->element[i];
        int status = NS_OK;
        ns_circuit_stamp_element(to, e);
        if (e->input >= 0 && (status = ns_system_set_input(to->s, e->input, &e->signal))) {
            return status;
        }
    }
    int status = add_inductances(to);
    status = status != NS_OK ? status : ns_circuit_ground_reference(to);
    return status != NS_OK ? status : ns_circuit_stamp_commands(to);
}

/* The lists become the matrices of a large system. */
static int sum_entries(ns_system *s, const ns_entries *from) {
    ns_large *a = s->large;
    const struct {
        ns_csc *to;
        int rows, columns;
    } of[] = {{&a->M, s->n, s->n}, {&a->A, s->n, s->n},  {&a->B, s->n, s->m},   {&a->C, s->m, s->n},
              {&a->D, s->m, s->m}, {&a->E, s->n, s->nz}, {&a->gx, s->n, s->nc}, {&a->gz, s->nz, s->nc}};
    static const ns_entries none = {0};
    int status = ns_linalg_csc_of_entries(s->m, s->nz, &none, &a->F);
    for (int k = 0; k < MATRICES && !status; k++) {
        status = ns_linalg_csc_of_entries(of[k].rows, of[k].columns, &from[k], of[k].to);
    }
    return status;
}

static int create_large(ns_circuit *c, ns_system **s) {
    ns_entries entries[MATRICES] = {{0}};
    int status = ns_system_create_large(c->nused + c->ncurrents, c->npairs, c->ninputs, c->ncommands, s);
    if (!status) {
        status = stamp_all(&(stamp){c, *s, entries});
    }
    if (!status) {
        status = sum_entries(*s, entries);
    }
    for (int k = 0; k < MATRICES; k++) {
        ns_linalg_entries_free(&entries[k]);
    }
    return status;
}

static int create(ns_circuit *c, ns_system **s) {
    if (c->nused + c->ncurrents + c->npairs > LARGE) {
        return create_large(c, s);
    }
    int status = ns_system_create(c->nused + c->ncurrents, c->npairs, c->ninputs, c->ncommands, s);
    return status ? status : stamp_all(&(stamp){c, *s, NULL});
}

/* Where the nodes of each element are, so that devices are read without a search (device.c). */
static void note_places(ns_circuit *c) {
    for (int i = 0; i < c->nelements; i++) {
        element *e = &c->element[i];
        for (int end = 0; end < 2 && end < e->nnodes; end++) {
            int found;
            e->place[end] = ns_circuit_find_node(c, e->node[end], &found);
        }
    }
}

int ns_circuit_system(ns_circuit *c, ns_system **out) {
    ns_system *s = NULL;
    int status;
    ns_fault fault = {0};
    if (!out) {
        return NS_E_NULL;
    }
    *out = NULL;
    if (!c) {
        return NS_E_NULL;
    }
    if ((status = ns_circuit_check_inductances(c))) {
        return status;
    }
    if ((status = ns_circuit_tiny_resistors(c))) {
        return ns_circuit_complain(c, status, "%s", ns_status_text(status));
    }
    note_places(c);
    *c->message = '\0';
    if ((status = create(c, &s)) || (status = ns_system_check(s, &fault))) {
        char where[160] = "";
        if (fault.status) {
            (void)ns_circuit_explain(c, &fault, where, sizeof where);
        }
        ns_system_free(s);
        if (*c->message) {
            return status;
        }
        return ns_circuit_complain(c, status, "%s", *where ? where : ns_status_text(status));
    }
    *out = s;
    return NS_OK;
}
