/* src/modes/shared_branch.c - pairs across a switch: found in the matrices. */
#include "shared_branch.h"

#include <stdlib.h>

#include "linalg/sparse.h"
#include "system/each_entry.h"

/* What a pair's law has beside its branch: D_jj; entries of other pairs, inputs or constants that force it; a
 * command. */
enum { RESISTANCE = 1, JOINED = 2, COMMANDED = 4 };

static void see_law(void *context, int pair, int other, double value) {
    unsigned char *has = context;
    (void)value;
    has[pair] |= pair == other ? RESISTANCE : JOINED;
    has[other] |= pair == other ? RESISTANCE : JOINED;
}

static void see_input(void *context, int pair, int input, double value) {
    (void)input;
    (void)value;
    ((unsigned char *)context)[pair] |= JOINED;
}

/* Which bound of pair j is zero: there lambda is, while y = 0 by the switch. */
static ns_mode idle_of(const ns_system *s, int j) {
    return s->l[j] == 0 ? NS_LOWER : NS_UPPER;
}

/* 1 if a constant keeps the law of pair j from holding idle at a branch of 0 V: a forward drop does not. */
static int is_forced(const ns_system *s, int j) {
    return idle_of(s, j) == NS_LOWER ? s->e[j] < 0 : s->e[j] > 0;
}

static void see_laws(unsigned char *has, const ns_system *s) {
    ns_system_each_entry(s->D, NS_CSC_OF(s, D), s->m, s->m, see_law, has);
    ns_system_each_entry(s->F, NS_CSC_OF(s, F), s->m, s->nz, see_input, has);
    for (int j = 0; j < s->m; j++)
        has[j] |= is_forced(s, j) ? JOINED : 0;
    for (int c = 0; c < s->nc; c++) {
        const int j = s->command[c].pair;
        has[j] |= s->e[j] != 0 ? COMMANDED | JOINED : COMMANDED;
    }
}

/* Whether column i of a is column j, or that with its sign turned, and not empty. */
static int parallel(const ns_csc *a, int i, int j) {
    const int count = a->start[i + 1] - a->start[i], k = a->start[i], l = a->start[j];
    if (count == 0 || count != a->start[j + 1] - l)
        return 0;
    const double sign = a->value[k] == a->value[l] ? 1 : -1;
    for (int e = 0; e < count; e++)
        if (a->row[k + e] != a->row[l + e] || a->value[k + e] != sign * a->value[l + e])
            return 0;
    return 1;
}

/* The same of arrays of `count` numbers, `step` apart. */
static int parallel_arrays(int count, int step, const double *a, const double *b) {
    double sign = 0;
    for (int k = 0; k < count; k++, a += step, b += step) {
        if (sign == 0 && (*a != 0 || *b != 0))
            sign = *a == *b ? 1 : -1;
        if (*a != sign * *b)
            return 0;
    }
    return sign != 0;
}

/* Pair i has the branch of pair j; voltage: C of a large system, row by row. */
static int is_across(const ns_system *s, const ns_csc *voltage, int i, int j) {
    const size_t n = (size_t)s->n;
    return s->large ? parallel(voltage, i, j) && parallel(&s->large->B, i, j)
                    : parallel_arrays(s->n, s->m, s->C + i, s->C + j) &&
                          parallel_arrays(s->n, 1, s->B + (size_t)i * n, s->B + (size_t)j * n);
}

static int find(const ns_system *s, const unsigned char *has, const ns_csc *voltage, ns_shared_branch *list) {
    int count = 0;
    for (int j = 0; j < s->m; j++) {
        if (has[j] > RESISTANCE || (s->l[j] != 0 && s->u[j] != 0))
            continue;
        for (int c = 0; c < s->nc; c++) {
            const int of = s->command[c].pair;
            if (has[of] != COMMANDED || !is_across(s, voltage, j, of))
                continue;
            list[count++] = (ns_shared_branch){j, of, idle_of(s, j)};
            break;
        }
    }
    return count;
}

int ns_modes_shared_find(const ns_system *s, ns_shared_branch **out, int *count) {
    ns_csc voltage = {0};
    *count = 0;
    *out = NULL;
    if (s->n == 0 || s->m == 0 || s->nc == 0)
        return NS_OK;
    ns_shared_branch *list = calloc((size_t)s->m, sizeof *list);
    unsigned char *has = calloc((size_t)s->m, 1);
    int status = list && has ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK && s->large)
        status = ns_linalg_csc_transpose(&s->large->C, &voltage);
    if (status == NS_OK) {
        see_laws(has, s);
        *count = find(s, has, &voltage, list);
        *out = list;
    } else {
        free(list);
    }
    ns_linalg_csc_free(&voltage);
    free(has);
    return status;
}
