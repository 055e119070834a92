/* src/system/system.c - complementarity systems (S1)-(S4): made, freed, filled, checked. */
#include "nonsmooth/system.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/dense.h"
#include "linalg/row_split.h"
#include "linalg/sparse.h"
#include "signal_internal.h"

/* A zeroed p*q array, NULL for none; *ok becomes 0 where memory ran out. */
static void *allocate_array(int p, int q, size_t size, int *ok) {
    size_t count = (size_t)p * (size_t)q;
    void *made = NULL;
    if (count > 0 && *ok) {
        *ok = count / (size_t)q == (size_t)p && count <= SIZE_MAX / size && (made = calloc(count, size));
    }
    return made;
}

static void allocate_matrices(ns_system *s, int n, int m, int nz, int *ok) {
    s->M = allocate_array(n, n, sizeof(double), ok);
    s->A = allocate_array(n, n, sizeof(double), ok);
    s->B = allocate_array(n, m, sizeof(double), ok);
    s->C = allocate_array(m, n, sizeof(double), ok);
    s->D = allocate_array(m, m, sizeof(double), ok);
    s->E = allocate_array(n, nz, sizeof(double), ok);
    s->F = allocate_array(m, nz, sizeof(double), ok);
}

static int allocate_arrays(ns_system *s, int n, int m, int nz, int nc, int large) {
    int ok = 1;
    if (large) {
        s->large = allocate_array(1, 1, sizeof *s->large, &ok);
    } else {
        allocate_matrices(s, n, m, nz, &ok);
    }
    s->balance = allocate_array(n, 1, 1, &ok);
    s->ground = allocate_array(n, 1, sizeof(double), &ok);
    s->b = allocate_array(n, 1, sizeof(double), &ok);
    s->e = allocate_array(m, 1, sizeof(double), &ok);
    s->l = allocate_array(m, 1, sizeof(double), &ok);
    s->u = allocate_array(m, 1, sizeof(double), &ok);
    s->z = allocate_array(nz, 1, sizeof(ns_signal), &ok);
    s->command = allocate_array(nc, 1, sizeof(ns_command), &ok);
    return ok;
}

static int create_system(int n, int m, int nz, int nc, int large, ns_system **out) {
    ns_system *s;
    if (!out) {
        return NS_E_NULL;
    }
    *out = NULL;
    if (n < 0 || m < 0 || nz < 0 || nc < 0) {
        return NS_E_SIZE;
    }
    s = calloc(1, sizeof *s);
    if (!s || !allocate_arrays(s, n, m, nz, nc, large)) {
        ns_system_free(s);
        return NS_E_MEMORY;
    }
    s->n = n;
    s->m = m;
    s->nz = nz;
    s->nc = nc;
    for (int i = 0; i < n; i++) {
        s->ground[i] = NAN;
    }
    for (int i = 0; i < m; i++) {
        s->u[i] = INFINITY;
    }
    *out = s;
    return NS_OK;
}

int ns_system_create(int n, int m, int nz, int nc, ns_system **out) {
    return create_system(n, m, nz, nc, 0, out);
}

int ns_system_create_large(int n, int m, int nz, int nc, ns_system **out) {
    return create_system(n, m, nz, nc, 1, out);
}

static void free_large(ns_large *a) {
    enum { ALL = 9 };
    ns_csc *const all[ALL] = {&a->M, &a->A, &a->B, &a->C, &a->D, &a->E, &a->F, &a->gx, &a->gz};
    for (size_t i = 0; i < ALL; i++) {
        ns_linalg_csc_free(all[i]);
    }
    free(a);
}

void ns_system_free(ns_system *s) {
    if (!s) {
        return;
    }
    if (s->large) {
        free_large(s->large);
    }
    for (int i = 0; s->z && i < s->nz; i++) {
        ns_system_signal_release(&s->z[i]);
    }
    for (int i = 0; s->command && i < s->nc; i++) {
        free(s->command[i].gx);
        free(s->command[i].gz);
    }
    free(s->M);
    free(s->A);
    free(s->B);
    free(s->C);
    free(s->D);
    free(s->b);
    free(s->E);
    free(s->e);
    free(s->F);
    free(s->l);
    free(s->u);
    free(s->z);
    free(s->command);
    free(s->balance);
    free(s->ground);
    free(s);
}

int ns_system_set_input(ns_system *s, int i, const ns_signal *signal) {
    ns_signal copy;
    int status;
    if (!s || !signal) {
        return NS_E_NULL;
    }
    if (i < 0 || i >= s->nz) {
        return NS_E_SIZE;
    }
    if ((status = ns_signal_check(signal)) || (status = ns_system_signal_copy(signal, &copy))) {
        return status;
    }
    ns_system_signal_release(&s->z[i]);
    s->z[i] = copy;
    return NS_OK;
}

void ns_system_inputs(const ns_system *s, double t, ns_side side, double *z) {
    for (int i = 0; s && z && i < s->nz; i++) {
        z[i] = ns_signal_value(&s->z[i], t, side);
    }
}

void ns_system_charges(const ns_system *s, const double *x, double *w) {
    if (!s || !x || !w) {
        return;
    }
    if (!s->large) {
        ns_linalg_matvec(s->n, s->n, s->M, x, w);
        return;
    }
    memset(w, 0, (size_t)s->n * sizeof *w);
    ns_linalg_csc_times_add(&s->large->M, x, w);
}

/* flow[i] += what is in row i of a (n*columns). */
static void add_flows(int n, int columns, const double *a, double *flow) {
    for (int j = 0; j < columns; j++)
        for (int i = 0; i < n; i++)
            flow[i] += fabs(a[(size_t)i + (size_t)j * (size_t)n]);
}

int ns_system_split(const ns_system *s, double *T, int *rank) {
    if (!s || s->large)
        return NS_E_NULL;
    double *flow = calloc((size_t)s->n + 1, sizeof *flow);
    if (!flow)
        return NS_E_MEMORY;
    add_flows(s->n, s->n, s->A, flow);
    add_flows(s->n, s->m, s->B, flow);
    const int status = ns_linalg_row_split_quiet(s->n, s->M, flow, T, rank);
    free(flow);
    return status;
}
