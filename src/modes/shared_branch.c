/* src/modes/shared_branch.c - pairs across a switch: found in the matrices. */
#include "shared_branch.h"

#include <stdlib.h>

#include "linalg/sparse.h"
#include "system/each_entry.h"

/* What a pair's law has beside its branch: D_jj; entries of other pairs, inputs or constants; a command. */
enum { RESISTANCE = 1, JOINED = 2, COMMANDED = 4 };

typedef struct branches {
    ns_entries flow, voltage; /* columns of B, rows of C: pair by pair */
    unsigned char *has;       /* m */
} branches;

static void see_flow(void *context, int unknown, int pair, double value) {
    ns_linalg_entries_add(&((branches *)context)->flow, unknown, pair, value);
}

static void see_voltage(void *context, int pair, int unknown, double value) {
    ns_linalg_entries_add(&((branches *)context)->voltage, unknown, pair, value);
}

static void see_law(void *context, int pair, int other, double value) {
    branches *k = context;
    (void)value;
    k->has[pair] |= pair == other ? RESISTANCE : JOINED;
    k->has[other] |= pair == other ? RESISTANCE : JOINED;
}

static void see_input(void *context, int pair, int input, double value) {
    (void)input;
    (void)value;
    ((branches *)context)->has[pair] |= JOINED;
}

static void see_all(branches *k, const ns_system *s) {
    ns_system_each_entry(s->B, NS_CSC_OF(s, B), s->n, s->m, see_flow, k);
    ns_system_each_entry(s->C, NS_CSC_OF(s, C), s->m, s->n, see_voltage, k);
    ns_system_each_entry(s->D, NS_CSC_OF(s, D), s->m, s->m, see_law, k);
    ns_system_each_entry(s->F, NS_CSC_OF(s, F), s->m, s->nz, see_input, k);
    for (int j = 0; j < s->m; j++)
        k->has[j] |= s->e[j] != 0 ? JOINED : 0;
    for (int c = 0; c < s->nc; c++)
        k->has[s->command[c].pair] |= COMMANDED;
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

static int find(const ns_system *s, const unsigned char *has, const ns_csc *flow, const ns_csc *voltage,
                ns_shared_branch *list) {
    int count = 0;
    for (int j = 0; j < s->m; j++) {
        if (has[j] > RESISTANCE || (s->l[j] != 0 && s->u[j] != 0))
            continue;
        for (int c = 0; c < s->nc; c++) {
            const int of = s->command[c].pair;
            if (has[of] != COMMANDED || !parallel(voltage, j, of) || !parallel(flow, j, of))
                continue;
            list[count++] = (ns_shared_branch){j, of, s->l[j] == 0 ? NS_LOWER : NS_UPPER};
            break;
        }
    }
    return count;
}

int ns_modes_shared_find(const ns_system *s, ns_shared_branch **out, int *count) {
    branches k = {0};
    ns_csc flow = {0}, voltage = {0};
    *count = 0;
    *out = NULL;
    if (s->m == 0 || s->nc == 0)
        return NS_OK;
    ns_shared_branch *list = calloc((size_t)s->m, sizeof *list);
    k.has = calloc((size_t)s->m, 1);
    int status = list && k.has ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        see_all(&k, s);
        status = ns_linalg_csc_of_entries(s->n, s->m, &k.flow, &flow);
    }
    if (status == NS_OK)
        status = ns_linalg_csc_of_entries(s->n, s->m, &k.voltage, &voltage);
    if (status == NS_OK) {
        *count = find(s, k.has, &flow, &voltage, list);
        *out = list;
    } else {
        free(list);
    }
    ns_linalg_csc_free(&flow);
    ns_linalg_csc_free(&voltage);
    ns_linalg_entries_free(&k.flow);
    ns_linalg_entries_free(&k.voltage);
    free(k.has);
    return status;
}
