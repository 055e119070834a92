/* src/system/system_check.c - refuses systems that cannot be integrated, and where the fault is. */
#include <math.h>
#include <stddef.h>

#include "check.h"
#include "nonsmooth/system.h"

int ns_system_blame(ns_fault *fault, int status, ns_owner who, int index) {
    ns_fault where = {0};
    where.status = (ns_status)status;
    where.t = NAN;
    if (who == NS_PAIR) {
        where.npairs = 1;
        where.pair[0] = index;
    } else if (who == NS_UNKNOWN) {
        where.nunknowns = 1;
        where.unknown[0] = index;
    }
    if (fault) {
        *fault = where;
    }
    return status;
}

int ns_system_check_array(const double *a, int p, int q, ns_owner row, ns_owner column, ns_fault *fault) {
    if (p > 0 && q > 0 && !a) {
        return ns_system_blame(fault, NS_E_NULL, NS_NOTHING, 0);
    }
    for (int j = 0; j < q; j++) {
        for (int i = 0; i < p; i++) {
            if (!isfinite(a[(size_t)i + (size_t)j * (size_t)p])) {
                return ns_system_blame(fault, NS_E_NUMBER, column != NS_NOTHING ? column : row,
                                       column != NS_NOTHING ? j : i);
            }
        }
    }
    return NS_OK;
}

/* A matrix of a large system: its sizes, its rows, finite numbers. */
static int check_csc(const ns_csc *a, int rows, int columns, ns_fault *fault) {
    if (!a->start || !a->row || !a->value) {
        return ns_system_blame(fault, NS_E_NULL, NS_NOTHING, 0);
    }
    if (a->rows != rows || a->columns != columns || a->start[0] != 0) {
        return ns_system_blame(fault, NS_E_SIZE, NS_NOTHING, 0);
    }
    for (int j = 0; j < columns; j++) {
        for (int k = a->start[j]; k < a->start[j + 1]; k++) {
            if (a->row[k] < 0 || a->row[k] >= rows || (k > a->start[j] && a->row[k] <= a->row[k - 1])) {
                return ns_system_blame(fault, NS_E_SIZE, NS_NOTHING, 0);
            }
            if (!isfinite(a->value[k])) {
                return ns_system_blame(fault, NS_E_NUMBER, NS_NOTHING, 0);
            }
        }
    }
    return NS_OK;
}

static int check_large(const ns_system *s, ns_fault *fault) {
    const ns_large *a = s->large;
    int n = s->n, m = s->m, nz = s->nz, nc = s->nc, status;
    (void)((status = check_csc(&a->M, n, n, fault)) || (status = check_csc(&a->A, n, n, fault)) ||
           (status = check_csc(&a->B, n, m, fault)) || (status = check_csc(&a->C, m, n, fault)) ||
           (status = check_csc(&a->D, m, m, fault)) || (status = check_csc(&a->E, n, nz, fault)) ||
           (status = check_csc(&a->F, m, nz, fault)) || (status = check_csc(&a->gx, n, nc, fault)) ||
           (status = check_csc(&a->gz, nz, nc, fault)) ||
           (status = ns_system_check_array(s->b, n, 1, NS_UNKNOWN, NS_NOTHING, fault)) ||
           (status = ns_system_check_array(s->e, m, 1, NS_PAIR, NS_NOTHING, fault)));
    return status;
}

static int check_arrays(const ns_system *s, ns_fault *fault) {
    int n = s->n, m = s->m, nz = s->nz, status;
    if (s->large) {
        return check_large(s, fault);
    }
    (void)((status = ns_system_check_array(s->M, n, n, NS_UNKNOWN, NS_UNKNOWN, fault)) ||
           (status = ns_system_check_array(s->A, n, n, NS_UNKNOWN, NS_UNKNOWN, fault)) ||
           (status = ns_system_check_array(s->B, n, m, NS_UNKNOWN, NS_PAIR, fault)) ||
           (status = ns_system_check_array(s->C, m, n, NS_PAIR, NS_UNKNOWN, fault)) ||
           (status = ns_system_check_array(s->D, m, m, NS_PAIR, NS_PAIR, fault)) ||
           (status = ns_system_check_array(s->b, n, 1, NS_UNKNOWN, NS_NOTHING, fault)) ||
           (status = ns_system_check_array(s->E, n, nz, NS_UNKNOWN, NS_NOTHING, fault)) ||
           (status = ns_system_check_array(s->e, m, 1, NS_PAIR, NS_NOTHING, fault)) ||
           (status = ns_system_check_array(s->F, m, nz, NS_PAIR, NS_NOTHING, fault)));
    return status;
}

static int check_command(const ns_system *s, const ns_command *c, ns_fault *fault) {
    if (c->pair < 0 || c->pair >= s->m) {
        return ns_system_blame(fault, NS_E_SIZE, NS_NOTHING, 0);
    }
    if (isnan(c->on) || isnan(c->off) || !isfinite(c->g0) ||
        (c->gx && ns_system_check_array(c->gx, s->n, 1, NS_NOTHING, NS_NOTHING, NULL)) ||
        (c->gz && ns_system_check_array(c->gz, s->nz, 1, NS_NOTHING, NS_NOTHING, NULL))) {
        return ns_system_blame(fault, NS_E_NUMBER, NS_PAIR, c->pair);
    }
    for (const ns_command *other = s->command; other < c; other++) {
        if (other->pair == c->pair) {
            return ns_system_blame(fault, NS_E_RANGE, NS_PAIR, c->pair);
        }
    }
    return c->off > c->on ? ns_system_blame(fault, NS_E_RANGE, NS_PAIR, c->pair) : NS_OK;
}

static int is_commanded(const ns_system *s, int pair) {
    for (int i = 0; i < s->nc; i++) {
        if (s->command[i].pair == pair) {
            return 1;
        }
    }
    return 0;
}

static int check_bounds(const ns_system *s, int i, ns_fault *fault) {
    double l = s->l[i], u = s->u[i];
    if (isnan(l) || isnan(u) || l == INFINITY || u == -INFINITY) {
        return is_commanded(s, i) ? NS_OK : ns_system_blame(fault, NS_E_NUMBER, NS_PAIR, i);
    }
    return l <= u || is_commanded(s, i) ? NS_OK : ns_system_blame(fault, NS_E_BOUNDS, NS_PAIR, i);
}

int ns_system_check(const ns_system *s, ns_fault *fault) {
    int status;
    if (!s) {
        return ns_system_blame(fault, NS_E_NULL, NS_NOTHING, 0);
    }
    if (s->n < 0 || s->m < 0 || s->nz < 0 || s->nc < 0) {
        return ns_system_blame(fault, NS_E_SIZE, NS_NOTHING, 0);
    }
    if ((s->n > 0 && (!s->balance || !s->ground)) || (s->m > 0 && (!s->l || !s->u)) || (s->nz > 0 && !s->z) ||
        (s->nc > 0 && !s->command)) {
        return ns_system_blame(fault, NS_E_NULL, NS_NOTHING, 0);
    }
    status = check_arrays(s, fault);
    for (int i = 0; i < s->nz && !status; i++) {
        if ((status = ns_signal_check(&s->z[i]))) {
            ns_system_blame(fault, status, NS_NOTHING, 0);
        }
    }
    for (int i = 0; i < s->nc && !status; i++) {
        status = check_command(s, &s->command[i], fault);
    }
    for (int i = 0; i < s->m && !status; i++) {
        status = check_bounds(s, i, fault);
    }
    return status;
}
