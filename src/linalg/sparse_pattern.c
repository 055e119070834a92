/* src/linalg/sparse_pattern.c - patterns of sparse matrices, found again or made. */
#include "sparse_pattern.h"

#include <stdlib.h>

/* 1 if the entries that are not zero are at the places of p. */
static int is_of(const ns_pattern *p, int n, const int *start, const double *value) {
    const int count = p->n == n ? p->start[n] : 0;
    int at = 0;
    for (int k = 0; k < start[n]; k++)
        if (value[k] != 0 && (at == count || p->from[at++] != k))
            return 0;
    return p->n == n && at == count;
}

static ns_pattern *find(const ns_patterns *all, int n, const int *start, const double *value) {
    for (int i = 0; i < NS_PATTERNS; i++)
        if (all->kept[i] && is_of(all->kept[i], n, start, value))
            return all->kept[i];
    return NULL;
}

static void fill(ns_pattern *p, const int *start, const int *row, const double *value) {
    int at = 0;
    p->start[0] = 0;
    for (int j = 0; j < p->n; j++) {
        for (int k = start[j]; k < start[j + 1]; k++)
            if (value[k] != 0) {
                p->row[at] = row[k];
                p->from[at++] = k;
            }
        p->start[j + 1] = at;
    }
}

/* NULL: no memory. */
static ns_pattern *make(int n, const int *start, const int *row, const double *value) {
    size_t count = 0;
    for (int k = 0; k < start[n]; k++)
        count += value[k] != 0;
    ns_pattern *p = calloc(1, sizeof *p);
    int *places = malloc(((size_t)n + 1 + 2 * count) * sizeof(int));
    if (!p || !places) {
        free(p);
        free(places);
        return NULL;
    }
    *p = (ns_pattern){.uses = 1, .n = n, .start = places, .row = places + n + 1};
    p->from = p->row + count;
    fill(p, start, row, value);
    return p;
}

static void keep(ns_patterns *all, ns_pattern *p, klu_common *c) {
    ns_linalg_pattern_free(all->kept[all->next], c);
    all->kept[all->next] = p;
    all->next = (all->next + 1) % NS_PATTERNS;
    p->uses++;
}

ns_pattern *ns_linalg_pattern_of(ns_patterns *all, int n, const int *start, const int *row,
                                 const double *value, klu_common *c) {
    ns_pattern *p = find(all, n, start, value);
    if (p) {
        p->uses++;
        return p;
    }
    c->status = KLU_OUT_OF_MEMORY;
    p = make(n, start, row, value);
    if (!p)
        return NULL;
    p->symbolic = klu_analyze(n, p->start, p->row, c);
    if (p->symbolic && p->symbolic->structural_rank == n) {
        keep(all, p, c);
        return p;
    }
    ns_linalg_pattern_free(p, c);
    return NULL;
}

void ns_linalg_pattern_free(ns_pattern *p, klu_common *c) {
    if (!p || --p->uses > 0)
        return;
    if (p->symbolic)
        (void)klu_free_symbolic(&p->symbolic, c);
    free(p->start);
    free(p);
}

void ns_linalg_patterns_free(ns_patterns *all, klu_common *c) {
    for (int i = 0; i < NS_PATTERNS; i++)
        ns_linalg_pattern_free(all->kept[i], c);
}
