/* src/system/partition_build.c - the system of each island.
 *
 * Rows of an island are its own, the laws of the known unknowns that it sees, and its part of their balances:
 * the entries of its own unknowns and pairs, and its part of the shared unknown.  What else is in a balance
 * (a resistor from the supply to ground) counts in one island, its home: the first that sees it.
 */
#include <stdlib.h>

#include "linalg/sparse.h"
#include "partition_internal.h"

/* Islands that are not larger get arrays, which dense engines take as they are. */
enum { DENSE_MOST = 64 };

typedef struct builder {
    const ns_plan *plan;
    const ns_system *s;
    int count, c;            /* islands; the one that is builder */
    unsigned char *sees;     /* count*n: island c sees the group of top i */
    int *home;               /* n: of a top */
    int *row, *pair, *input; /* n, m, nz: indices in the island, -1: not there */
    ns_system *to;
    double *dense; /* where entries go: here, */
    int rows;
    ns_entries entries; /* or here */
} builder;

/* --- which islands see which known and shared unknowns --- */

static void mark_seen(const builder *k, int island, int shared) {
    k->sees[(size_t)island * (size_t)k->s->n + (size_t)ns_system_plan_group(k->plan, shared)] = 1;
}

static int is_own(const builder *k, int i) {
    return k->plan->role[i] == NS_OWN;
}

static void see_entry(void *context, int row, int column, double value) {
    const builder *k = context;
    (void)value;
    if (is_own(k, row) && !is_own(k, column))
        mark_seen(k, ns_system_plan_island(k->plan, row), column);
    if (!is_own(k, row) && is_own(k, column))
        mark_seen(k, ns_system_plan_island(k->plan, column), row);
}

static void see_pair(void *context, int unknown, int pair, double value) {
    const builder *k = context;
    (void)value;
    if (!is_own(k, unknown))
        mark_seen(k, ns_system_plan_island(k->plan, k->s->n + pair), unknown);
}

static void see_guard(void *context, int pair, int unknown, double value) {
    see_pair(context, unknown, pair, value);
}

static void see_control(void *context, int unknown, int command, double value) {
    const builder *k = context;
    see_pair(context, unknown, k->s->command[command].pair, value);
}

static void find_seen(builder *k) {
    const ns_system *s = k->s;
    ns_system_each_entry(s->A, NS_CSC_OF(s, A), s->n, s->n, see_entry, k);
    ns_system_each_entry(s->M, NS_CSC_OF(s, M), s->n, s->n, see_entry, k);
    ns_system_each_entry(s->B, NS_CSC_OF(s, B), s->n, s->m, see_pair, k);
    ns_system_each_entry(s->C, NS_CSC_OF(s, C), s->m, s->n, see_guard, k);
    ns_system_each_control(s, see_control, k);
    for (int i = 0; i < s->n; i++) {
        k->home[i] = 0;
        while (k->home[i] < k->count - 1 && !k->sees[k->home[i] * s->n + i])
            k->home[i]++;
        if (!k->sees[k->home[i] * s->n + i]) /* nobody does */
            k->home[i] = 0;
        k->sees[k->home[i] * s->n + i] = 1;
    }
}

/* --- what belongs to the island --- */

static int is_in(const builder *k, int i) {
    return is_own(k, i) ? ns_system_plan_island(k->plan, i) == k->c
                        : k->sees[k->c * k->s->n + ns_system_plan_group(k->plan, i)];
}

static int is_law(const builder *k, int row) {
    return k->plan->role[row] == NS_SHARED || k->plan->law[row] == row;
}

static int is_home(const builder *k, int i) {
    return k->home[ns_system_plan_group(k->plan, i)] == k->c;
}

/* Whether inputs and constants of a row count in this island. */
static int acts_on(const builder *k, int row) {
    return is_own(k, row) || is_law(k, row) ? is_in(k, row) : is_home(k, row);
}

static int has_entry(const builder *k, int row, int column) {
    if (is_own(k, row) || is_law(k, row))
        return is_in(k, row);
    return k->plan->role[column] == NS_KNOWN ? is_home(k, row) : is_in(k, row) && is_in(k, column);
}

/* --- entries --- */

static void add_entry(builder *k, int row, int column, double value) {
    if (k->dense)
        k->dense[(size_t)row + (size_t)column * (size_t)k->rows] += value;
    else
        ns_linalg_entries_add(&k->entries, row, column, value);
}

static void put_unknown(void *context, int row, int column, double value) {
    builder *k = context;
    if (has_entry(k, row, column))
        add_entry(k, k->row[row], k->row[column], value);
}

static void put_force(void *context, int row, int pair, double value) {
    builder *k = context;
    if (k->pair[pair] >= 0)
        add_entry(k, k->row[row], k->pair[pair], value);
}

static void put_guard(void *context, int pair, int column, double value) {
    builder *k = context;
    if (k->pair[pair] >= 0)
        add_entry(k, k->pair[pair], k->row[column], value);
}

static void put_pairs(void *context, int pair, int other, double value) {
    builder *k = context;
    if (k->pair[pair] >= 0)
        add_entry(k, k->pair[pair], k->pair[other], value);
}

static void put_source(void *context, int row, int input, double value) {
    builder *k = context;
    if (acts_on(k, row))
        add_entry(k, k->row[row], k->input[input], value);
}

static void put_source_of_pair(void *context, int pair, int input, double value) {
    builder *k = context;
    if (k->pair[pair] >= 0)
        add_entry(k, k->pair[pair], k->input[input], value);
}

/* One matrix: into the island's array, or its sparse matrix. */
static int copy_matrix(builder *k, const double *from, const ns_csc *sparse, int rows, int columns,
                       ns_visit *visit, double *dense, ns_csc *large, int to_rows, int to_columns) {
    k->dense = dense;
    k->rows = to_rows;
    k->entries = (ns_entries){0};
    ns_system_each_entry(from, sparse, rows, columns, visit, k);
    int status = k->entries.failed ? NS_E_MEMORY : NS_OK;
    if (status == NS_OK && large)
        status = ns_linalg_csc_of_entries(to_rows, to_columns, &k->entries, large);
    ns_linalg_entries_free(&k->entries);
    return status;
}

#define COPY(which, rows, columns, visit)                                                                    \
    copy_matrix(k, s->which, NS_CSC_OF(s, which), s->rows, s->columns, visit, to->which,                     \
                to->large ? &to->large->which : NULL, to->rows, to->columns)

static int copy_matrices(builder *k) {
    const ns_system *s = k->s;
    ns_system *to = k->to;
    int status = COPY(M, n, n, put_unknown);
    status = status ? status : COPY(A, n, n, put_unknown);
    status = status ? status : COPY(B, n, m, put_force);
    status = status ? status : COPY(C, m, n, put_guard);
    status = status ? status : COPY(D, m, m, put_pairs);
    status = status ? status : COPY(E, n, nz, put_source);
    return status ? status : COPY(F, m, nz, put_source_of_pair);
}

static void copy_vectors(const builder *k) {
    const ns_system *s = k->s;
    for (int i = 0; i < s->n; i++) {
        if (k->row[i] >= 0)
            k->to->balance[k->row[i]] = s->balance[i];
        if (k->row[i] >= 0 && is_own(k, i)) /* all balances that it enters are here */
            k->to->ground[k->row[i]] = s->ground[i];
        if (k->row[i] >= 0 && acts_on(k, i))
            k->to->b[k->row[i]] = s->b[i];
    }
    for (int i = 0; i < s->m; i++)
        if (k->pair[i] >= 0) {
            k->to->e[k->pair[i]] = s->e[i];
            k->to->l[k->pair[i]] = s->l[i];
            k->to->u[k->pair[i]] = s->u[i];
        }
}

/* --- commands --- */

/* Entries of one control, as places in the island; an array of `size`, NULL where there are none. */
static int copy_control(const double *dense, const ns_csc *sparse, int c, int rows, const int *place,
                        int size, double **out) {
    int any = 0;
    double *to = calloc((size_t)size + 1, sizeof *to);
    if (!to)
        return NS_E_MEMORY;
    for (int i = 0; dense && i < rows; i++)
        if (dense[i] != 0) {
            to[place[i]] = dense[i];
            any = 1;
        }
    for (int q = sparse ? sparse->start[c] : 0; sparse && q < sparse->start[c + 1]; q++) {
        to[place[sparse->row[q]]] = sparse->value[q];
        any = 1;
    }
    if (!any) {
        free(to);
        to = NULL;
    }
    *out = to;
    return NS_OK;
}

static void add_control(ns_entries *to, const double *dense, int rows, int column) {
    for (int i = 0; dense && i < rows; i++)
        if (dense[i] != 0)
            ns_linalg_entries_add(to, i, column, dense[i]);
}

static int copy_command(builder *k, int c, ns_command *into) {
    const ns_system *s = k->s;
    const ns_command *from = &s->command[c];
    *into = *from;
    into->gx = into->gz = NULL;
    into->pair = k->pair[from->pair];
    const int status = copy_control(from->gx, NS_CSC_OF(s, gx), c, s->n, k->row, k->to->n, &into->gx);
    return status ? status
                  : copy_control(from->gz, NS_CSC_OF(s, gz), c, s->nz, k->input, k->to->nz, &into->gz);
}

/* Controls as columns of sparse matrices, in place of arrays. */
static int pack_commands(ns_system *to) {
    ns_entries gx = {0}, gz = {0};
    for (int c = 0; c < to->nc; c++) {
        ns_command *into = &to->command[c];
        add_control(&gx, into->gx, to->n, c);
        add_control(&gz, into->gz, to->nz, c);
        free(into->gx);
        free(into->gz);
        into->gx = into->gz = NULL;
    }
    int status = gx.failed || gz.failed ? NS_E_MEMORY : NS_OK;
    status = status ? status : ns_linalg_csc_of_entries(to->n, to->nc, &gx, &to->large->gx);
    status = status ? status : ns_linalg_csc_of_entries(to->nz, to->nc, &gz, &to->large->gz);
    ns_linalg_entries_free(&gx);
    ns_linalg_entries_free(&gz);
    return status;
}

static int copy_commands(builder *k) {
    int status = NS_OK;
    for (int c = 0, at = 0; c < k->s->nc && status == NS_OK; c++)
        if (k->pair[k->s->command[c].pair] >= 0)
            status = copy_command(k, c, &k->to->command[at++]);
    return status || !k->to->large ? status : pack_commands(k->to);
}

/* --- sizes --- */

static void mark_input(void *context, int row, int input, double value) {
    const builder *k = context;
    (void)value;
    if (acts_on(k, row))
        k->input[input] = 0;
}

static void mark_input_of_pair(void *context, int pair, int input, double value) {
    const builder *k = context;
    (void)value;
    if (k->pair[pair] >= 0)
        k->input[input] = 0;
}

static void mark_inputs(builder *k) {
    const ns_system *s = k->s;
    for (int i = 0; i < s->nz; i++)
        k->input[i] = -1;
    ns_system_each_entry(s->E, NS_CSC_OF(s, E), s->n, s->nz, mark_input, k);
    ns_system_each_entry(s->F, NS_CSC_OF(s, F), s->m, s->nz, mark_input_of_pair, k);
    for (int c = 0; c < s->nc; c++) {
        if (k->pair[s->command[c].pair] < 0)
            continue;
        for (int i = 0; s->command[c].gz && i < s->nz; i++)
            if (s->command[c].gz[i] != 0)
                k->input[i] = 0;
        for (int q = s->large ? s->large->gz.start[c] : 0; s->large && q < s->large->gz.start[c + 1]; q++)
            k->input[s->large->gz.row[q]] = 0;
    }
}

static int number_marked(int count, int *places) {
    int n = 0;
    for (int i = 0; i < count; i++)
        places[i] = places[i] < 0 ? -1 : n++;
    return n;
}

static int copy_inputs(const builder *k) {
    int status = NS_OK;
    for (int i = 0; i < k->s->nz && status == NS_OK; i++)
        if (k->input[i] >= 0)
            status = ns_system_set_input(k->to, k->input[i], &k->s->z[i]);
    return status;
}

static int list_marked(int count, const int *places, int size, int **out) {
    *out = calloc((size_t)size + 1, sizeof **out);
    for (int i = 0; *out && i < count; i++)
        if (places[i] >= 0)
            (*out)[places[i]] = i;
    return *out ? NS_OK : NS_E_MEMORY;
}

static int build_island(builder *k, ns_island *out) {
    const ns_system *s = k->s;
    int nc = 0;
    for (int i = 0; i < s->n; i++)
        k->row[i] = is_in(k, i) ? 0 : -1;
    for (int i = 0; i < s->m; i++)
        k->pair[i] = ns_system_plan_island(k->plan, s->n + i) == k->c ? 0 : -1;
    for (int c = 0; c < s->nc; c++)
        nc += k->pair[s->command[c].pair] >= 0;
    mark_inputs(k);
    const int n = number_marked(s->n, k->row), m = number_marked(s->m, k->pair),
              nz = number_marked(s->nz, k->input);
    int status = s->large && n + m > DENSE_MOST ? ns_system_create_large(n, m, nz, nc, &out->s)
                                                : ns_system_create(n, m, nz, nc, &out->s);
    k->to = out->s;
    status = status ? status : list_marked(s->n, k->row, n, &out->unknown);
    status = status ? status : list_marked(s->m, k->pair, m, &out->pair);
    status = status ? status : list_marked(s->nz, k->input, nz, &out->input);
    status = status ? status : copy_matrices(k);
    if (status == NS_OK)
        copy_vectors(k);
    status = status ? status : copy_inputs(k);
    return status ? status : copy_commands(k);
}

static int allocate_work(builder *k) {
    const size_t n = (size_t)k->s->n;
    k->sees = calloc((size_t)k->count * n + 1, 1);
    k->home = calloc(n + 1, sizeof *k->home);
    k->row = calloc(n + (size_t)k->s->m + (size_t)k->s->nz + 1, sizeof *k->row);
    if (!k->sees || !k->home || !k->row)
        return NS_E_MEMORY;
    k->pair = k->row + k->s->n;
    k->input = k->pair + k->s->m;
    return NS_OK;
}

int ns_system_partition_build(const ns_plan *p, int count, ns_islands *out) {
    const size_t n = (size_t)p->s->n;
    builder k = {.plan = p, .s = p->s, .count = count};
    out->count = count;
    out->island = calloc((size_t)count, sizeof *out->island);
    out->shared = calloc(n + 1, 1);
    int status = out->island && out->shared ? allocate_work(&k) : NS_E_MEMORY;
    if (status == NS_OK)
        find_seen(&k);
    for (size_t i = 0; status == NS_OK && i < n; i++)
        out->shared[i] = p->role[i] == NS_SHARED;
    for (k.c = 0; k.c < count && status == NS_OK; k.c++)
        status = build_island(&k, &out->island[k.c]);
    free(k.sees);
    free(k.home);
    free(k.row);
    return status;
}
