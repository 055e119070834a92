/* src/circuit/potentials.c - differences of potentials that are known at any time.
 *
 * Nodes joined by voltage sources whose value is known at any time (independent ones, R = 0, and controlled
 * ones whose control is itself known) form groups; inside a group every difference of potentials is
 *     a sum over few inputs, and a constant.
 */
#include "potentials.h"

#include <stdlib.h>

int ns_circuit_potentials_place(const ns_potentials *p, int number) {
    return number == 0 ? p->count - 1 : ns_circuit_node_unknown(p->c, number);
}

/* By how much input k counts. */
static double volts_of(const ns_potential *s, int k) {
    int low = 0, high = s->count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (s->of[middle] < k) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < s->count && s->of[low] == k ? s->volts[low] : 0;
}

void ns_circuit_potentials_clear_gap(ns_potentials *p) {
    for (int i = 0; i < p->in_gap_count; i++) {
        p->gap[p->in_gap[i]] = 0;
        p->has[p->in_gap[i]] = 0;
    }
    p->in_gap_count = 0;
}

void ns_circuit_potentials_add_gap(ns_potentials *p, int k, double volts) {
    if (!p->has[k]) {
        p->has[k] = 1;
        p->in_gap[p->in_gap_count++] = k;
    }
    p->gap[k] += volts;
}

/* gap += gain (v_p - v_n); 0 if they are of different groups. */
int ns_circuit_potentials_add_difference(ns_potentials *p, double gain, int at_p, int at_n) {
    const ns_potential *a = &p->volts[at_p], *b = &p->volts[at_n];
    if (p->group[at_p] != p->group[at_n]) {
        return 0;
    }
    for (int i = 0; i < a->count; i++) {
        ns_circuit_potentials_add_gap(p, a->of[i], gain * (a->volts[i] - volts_of(b, a->of[i])));
    }
    for (int i = 0; i < b->count; i++) {
        if (volts_of(a, b->of[i]) == 0) {
            ns_circuit_potentials_add_gap(p, b->of[i], gain * -b->volts[i]);
        }
    }
    return 1;
}

/* The first terms of an element: each node must be known against ground. */
int ns_circuit_potentials_add_terms(ns_potentials *p, const element *e, int count) {
    int known = 1;
    for (int i = 0; i < count && known; i++) {
        known = !e->terms[i].is_current &&
                ns_circuit_potentials_add_difference(p, e->terms[i].gain,
                                                     ns_circuit_potentials_place(p, e->terms[i].of),
                                                     ns_circuit_potentials_place(p, 0));
    }
    return known;
}

/* gap = v_p - v_n of an element; 0 if it does not fix that as a function of time. */
static int known_gap(ns_potentials *p, const element *e) {
    ns_circuit_potentials_clear_gap(p);
    if (e->current < 0) {
        return 0;
    }
    switch (e->kind) {
    case RESISTOR: /* others have a current too (tiny_resistor.c) */
        return e->value == 0;
    case SOURCE:
        ns_circuit_potentials_add_gap(p, e->input >= 0 ? e->input : p->nz,
                                      e->input >= 0 ? 1 : e->signal.u.dc);
        return 1;
    case VCONTROLLED:
        return ns_circuit_potentials_add_difference(p, e->value, ns_circuit_potentials_place(p, e->node[2]),
                                                    ns_circuit_potentials_place(p, e->node[3]));
    case LINEAR:
        ns_circuit_potentials_add_gap(p, p->nz, e->value);
        return ns_circuit_potentials_add_terms(p, e, e->nterms);
    default:
        return 0;
    }
}

static int by_number(const void *a, const void *b) {
    return *(const int *)a - *(const int *)b;
}

/* A node's potential += the gap. */
static void shift_potential(ns_potentials *p, ns_potential *s) {
    const size_t room = (size_t)(s->count + p->in_gap_count) + 1;
    int *of = malloc(room * sizeof *of), count = 0, i = 0;
    double *volts = malloc(room * sizeof *volts);
    if (!of || !volts) {
        free(of);
        free(volts);
        p->failed = 1;
        return;
    }
    for (int k = 0; k < p->in_gap_count || i < s->count;) {
        const int mine = i < s->count ? s->of[i] : p->nz + 1;
        const int its = k < p->in_gap_count ? p->in_gap[k] : p->nz + 1;
        of[count] = mine < its ? mine : its;
        volts[count] = (mine <= its ? s->volts[i++] : 0) + (its <= mine ? p->gap[p->in_gap[k++]] : 0);
        count += volts[count] != 0;
    }
    free(s->of);
    free(s->volts);
    *s = (ns_potential){count, of, volts};
}

/* Shifts the smaller of the two groups so that v_a - v_b = gap, and makes it the other's. */
static void join_groups(ns_potentials *p, int a, int b) {
    const int flip = p->size[p->group[a]] < p->size[p->group[b]];
    const int kept = flip ? b : a, moved = flip ? a : b, to = p->group[kept], from = p->group[moved];
    const ns_potential *base = &p->volts[kept], *own = &p->volts[moved];
    for (int i = 0; i < p->in_gap_count && !flip; i++) {
        p->gap[p->in_gap[i]] = -p->gap[p->in_gap[i]];
    }
    for (int i = 0; i < base->count; i++) {
        ns_circuit_potentials_add_gap(p, base->of[i], base->volts[i]);
    }
    for (int i = 0; i < own->count; i++) {
        ns_circuit_potentials_add_gap(p, own->of[i], -own->volts[i]);
    }
    qsort(p->in_gap, (size_t)p->in_gap_count, sizeof(int), by_number);
    int i = moved;
    do {
        shift_potential(p, &p->volts[i]);
        p->group[i] = to;
        i = p->next[i];
    } while (i != moved);
    p->size[to] += p->size[from];
    i = p->next[kept];
    p->next[kept] = p->next[moved];
    p->next[moved] = i;
}

/* One pass over the elements; returns how many groups it joined. */
static int join_known(ns_potentials *p) {
    int joined = 0;
    for (int i = 0; i < p->c->nelements && !p->failed; i++) {
        const element *e = &p->c->element[i];
        if (known_gap(p, e)) {
            int a = ns_circuit_potentials_place(p, e->node[0]),
                b = ns_circuit_potentials_place(p, e->node[1]);
            if (p->group[a] != p->group[b]) {
                join_groups(p, a, b);
                joined++;
            }
        }
    }
    return joined;
}

int ns_circuit_potentials_find(ns_potentials *p, const ns_circuit *c) {
    size_t count = (size_t)c->nused + 1, width = (size_t)c->ninputs + 1;
    *p = (ns_potentials){.c = c, .count = c->nused + 1, .nz = c->ninputs};
    p->group = calloc(3 * count, sizeof *p->group);
    p->volts = calloc(count, sizeof *p->volts);
    p->gap = calloc(width, sizeof *p->gap);
    p->in_gap = calloc(width, sizeof *p->in_gap);
    p->has = calloc(width, 1);
    /* NOLINTNEXTLINE(bugprone-sizeof-expression): an array of pointers */
    p->signal = calloc(width, sizeof *p->signal);
    if (!p->group || !p->volts || !p->gap || !p->in_gap || !p->has || !p->signal) {
        return 0;
    }
    for (int i = 0; i < c->nelements; i++) {
        if (c->element[i].input >= 0) {
            p->signal[c->element[i].input] = &c->element[i].signal;
        }
    }
    p->next = p->group + count;
    p->size = p->next + count;
    for (int i = 0; i < p->count; i++) {
        p->group[i] = p->next[i] = i;
        p->size[i] = 1;
    }
    while (join_known(p) > 0 && !p->failed) { /* at most count passes: each joins groups */
    }
    return !p->failed;
}

void ns_circuit_potentials_free(ns_potentials *p) {
    for (int i = 0; p->volts && i < p->count; i++) {
        free(p->volts[i].of);
        free(p->volts[i].volts);
    }
    free(p->group);
    free(p->volts);
    free(p->gap);
    free(p->in_gap);
    free(p->has);
    free(p->signal);
}
