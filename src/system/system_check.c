/* src/system/system_check.c - refuses systems that cannot be integrated, and says where. */
#include <math.h>
#include <stddef.h>

#include "nonsmooth/system.h"

/* What a row or a column of an array belongs to. */
typedef enum owner { NOBODY, UNKNOWN, PAIR } owner;

static int blame(ns_fault *fault, int status, owner who, int index) {
    ns_fault where = {0};
    where.status = (ns_status)status;
    where.t = NAN;
    if (who == PAIR) {
        where.npairs = 1;
        where.pair[0] = index;
    } else if (who == UNKNOWN) {
        where.nunknowns = 1;
        where.unknown[0] = index;
    }
    if (fault) {
        *fault = where;
    }
    return status;
}

/* A p*q array, all finite; a bad entry is blamed on its row or its column. */
static int finite_array(const double *a, int p, int q, owner row, owner column, ns_fault *fault) {
    if (p > 0 && q > 0 && !a) {
        return blame(fault, NS_E_NULL, NOBODY, 0);
    }
    for (int j = 0; j < q; j++) {
        for (int i = 0; i < p; i++) {
            if (!isfinite(a[(size_t)i + (size_t)j * (size_t)p])) {
                return blame(fault, NS_E_NUMBER, column != NOBODY ? column : row, column != NOBODY ? j : i);
            }
        }
    }
    return NS_OK;
}

static int check_arrays(const ns_system *s, ns_fault *fault) {
    int n = s->n, m = s->m, nz = s->nz, status;
    (void)((status = finite_array(s->M, n, n, UNKNOWN, UNKNOWN, fault)) ||
           (status = finite_array(s->A, n, n, UNKNOWN, UNKNOWN, fault)) ||
           (status = finite_array(s->B, n, m, UNKNOWN, PAIR, fault)) ||
           (status = finite_array(s->C, m, n, PAIR, UNKNOWN, fault)) ||
           (status = finite_array(s->D, m, m, PAIR, PAIR, fault)) ||
           (status = finite_array(s->b, n, 1, UNKNOWN, NOBODY, fault)) ||
           (status = finite_array(s->E, n, nz, UNKNOWN, NOBODY, fault)) ||
           (status = finite_array(s->e, m, 1, PAIR, NOBODY, fault)) ||
           (status = finite_array(s->F, m, nz, PAIR, NOBODY, fault)));
    return status;
}

static int check_command(const ns_system *s, const ns_command *c, ns_fault *fault) {
    if (c->pair < 0 || c->pair >= s->m) {
        return blame(fault, NS_E_SIZE, NOBODY, 0);
    }
    if (isnan(c->on) || isnan(c->off) || !isfinite(c->g0) ||
        (c->gx && finite_array(c->gx, s->n, 1, NOBODY, NOBODY, NULL)) ||
        (c->gz && finite_array(c->gz, s->nz, 1, NOBODY, NOBODY, NULL))) {
        return blame(fault, NS_E_NUMBER, PAIR, c->pair);
    }
    for (const ns_command *other = s->command; other < c; other++) {
        if (other->pair == c->pair) {
            return blame(fault, NS_E_RANGE, PAIR, c->pair);
        }
    }
    return c->off > c->on ? blame(fault, NS_E_RANGE, PAIR, c->pair) : NS_OK;
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
        return is_commanded(s, i) ? NS_OK : blame(fault, NS_E_NUMBER, PAIR, i);
    }
    return l <= u || is_commanded(s, i) ? NS_OK : blame(fault, NS_E_BOUNDS, PAIR, i);
}

int ns_system_check(const ns_system *s, ns_fault *fault) {
    int status;
    if (!s) {
        return blame(fault, NS_E_NULL, NOBODY, 0);
    }
    if (s->n < 0 || s->m < 0 || s->nz < 0 || s->nc < 0) {
        return blame(fault, NS_E_SIZE, NOBODY, 0);
    }
    if ((s->m > 0 && (!s->l || !s->u)) || (s->nz > 0 && !s->z) || (s->nc > 0 && !s->command)) {
        return blame(fault, NS_E_NULL, NOBODY, 0);
    }
    status = check_arrays(s, fault);
    for (int i = 0; i < s->nz && !status; i++) {
        if ((status = ns_signal_check(&s->z[i]))) {
            blame(fault, status, NOBODY, 0);
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
