/* src/system/active_inputs.c - which inputs anything that happens, or that is looked at, depends on.
 *
 * Rows and unknowns that an entry of the system joins belong to one island (union-find).  An island in which
 * nothing is a state, a law, or a command by the state only follows its inputs.
 */
#include "active_inputs.h"

#include <stdlib.h>
#include <string.h>

#include "each_entry.h"
#include "union_find.h"

/* Elements of the union-find: n rows of (S1), m rows of (S3), n + m unknowns. */
typedef struct islands {
    const ns_system *s;
    int *of;              /* 2 (n+m) */
    unsigned char *alive; /* 2 (n+m): of the first element of each island */
    int row, column;      /* where the entries begin that are visited now */
} islands;

static void join_entry(void *context, int row, int column, double value) {
    const islands *a = context;
    (void)value;
    ns_system_union_join(a->of, a->row + row, a->s->n + a->s->m + a->column + column);
}

static void join_all(islands *a) {
    const ns_system *s = a->s;
    const int n = s->n, m = s->m;
    ns_system_union_begin(a->of, 2 * (n + m));
    a->row = a->column = 0;
    ns_system_each_entry(s->M, NS_CSC_OF(s, M), n, n, join_entry, a);
    ns_system_each_entry(s->A, NS_CSC_OF(s, A), n, n, join_entry, a);
    a->column = n;
    ns_system_each_entry(s->B, NS_CSC_OF(s, B), n, m, join_entry, a);
    a->row = n;
    ns_system_each_entry(s->D, NS_CSC_OF(s, D), m, m, join_entry, a);
    a->column = 0;
    ns_system_each_entry(s->C, NS_CSC_OF(s, C), m, n, join_entry, a);
    for (int c = 0; c < s->nc; c++) /* y and lambda of a switch belong together; other pairs are laws */
        ns_system_union_join(a->of, n + s->command[c].pair, n + m + n + s->command[c].pair);
}

static void mark_alive(const islands *a, int element) {
    a->alive[ns_system_union_top(a->of, element)] = 1;
}

static void mark_state(void *context, int row, int column, double value) {
    (void)column;
    (void)value;
    mark_alive(context, row);
}

static void mark_control(void *context, int unknown, int command, double value) {
    const islands *a = context;
    (void)command;
    (void)value;
    mark_alive(a, a->s->n + a->s->m + unknown);
}

/* States; pairs but those of commands by time; and what commands by the state look at.  commanded: m. */
static void mark_active(islands *a, unsigned char *commanded) {
    const ns_system *s = a->s;
    ns_system_each_entry(s->M, NS_CSC_OF(s, M), s->n, s->n, mark_state, a);
    ns_system_each_control(s, mark_control, a);
    for (int c = 0; c < s->nc; c++)
        commanded[s->command[c].pair] = 1;
    for (int j = 0; j < s->m; j++)
        if (!commanded[j])
            mark_alive(a, s->n + j);
}

/* looked (n+m): x and lambda; NULL: none. */
static void mark_looked(islands *a, const unsigned char *looked) {
    for (int k = 0; looked && k < a->s->n + a->s->m; k++)
        if (looked[k])
            mark_alive(a, a->s->n + a->s->m + k);
}

/* Inputs of the islands that are alive.  list: nz. */
typedef struct listing {
    const islands *a;
    unsigned char *list;
} listing;

static void list_entry(void *context, int row, int input, double value) {
    const listing *l = context;
    (void)value;
    l->list[input] |= l->a->alive[ns_system_union_top(l->a->of, l->a->row + row)];
}

static void list_inputs(islands *a, unsigned char *list) {
    const ns_system *s = a->s;
    listing l = {a, list};
    memset(list, 0, (size_t)s->nz);
    a->row = 0;
    ns_system_each_entry(s->E, NS_CSC_OF(s, E), s->n, s->nz, list_entry, &l);
    a->row = s->n;
    ns_system_each_entry(s->F, NS_CSC_OF(s, F), s->m, s->nz, list_entry, &l);
}

/* 1 if command c looks at the state too. */
static int looks_at_state(const ns_system *s, int c) {
    return s->large ? s->large->gx.start[c + 1] > s->large->gx.start[c] : s->command[c].gx != NULL;
}

static void list_control(void *context, int input, int command, double value) {
    const listing *l = context;
    (void)value;
    if (looks_at_state(l->a->s, command))
        l->list[input] = 1;
}

static void list_commands(islands *a, unsigned char *list) {
    const ns_system *s = a->s;
    listing l = {.a = a};
    l.list = list;
    for (int c = 0; c < s->nc && !s->large; c++)
        for (int k = 0; s->command[c].gz && k < s->nz; k++)
            if (s->command[c].gz[k] != 0)
                list_control(&l, k, c, s->command[c].gz[k]);
    if (s->large)
        ns_system_each_entry(NULL, &s->large->gz, s->nz, s->nc, list_control, &l);
}

static int begin(const ns_system *s, islands *a) {
    const size_t count = 2 * ((size_t)s->n + (size_t)s->m) + 1;
    *a = (islands){.s = s, .of = calloc(count, sizeof *a->of), .alive = calloc(count, 1)};
    if (!a->of || !a->alive)
        return NS_E_MEMORY;
    join_all(a);
    return NS_OK;
}

static void end(islands *a) {
    free(a->of);
    free(a->alive);
}

static int list(const ns_system *s, const unsigned char *looked, unsigned char *inputs) {
    islands a;
    unsigned char *commanded = calloc((size_t)s->m + 1, 1);
    const int status = begin(s, &a) == NS_OK && commanded ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        mark_active(&a, commanded);
        mark_looked(&a, looked);
        list_inputs(&a, inputs);
        list_commands(&a, inputs);
    }
    free(commanded);
    end(&a);
    return status;
}

int ns_system_active_inputs(const ns_system *s, unsigned char *active) {
    return list(s, NULL, active);
}

int ns_system_followed_inputs(const ns_system *s, const unsigned char *looked, unsigned char *followed) {
    return list(s, looked, followed);
}
