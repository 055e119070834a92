/* src/exact/create.c - the exact engine's state, made and freed. */
#include "exact_internal.h"

#include "guards.h"
#include "system/active_inputs.h"

#include <stdlib.h>

/* A block of numbers that is cut into arrays. */
typedef struct ns_array_block {
    double *start; /* NULL: only counted so far */
    size_t used;
} ns_array_block;

static double *next_array(ns_array_block *b, size_t count) {
    double *array = b->start ? b->start + b->used : NULL;
    b->used += count;
    return array;
}

/* Gives each array its place in the block from `start` on; how many numbers they need. */
static size_t place_arrays(ns_exact *f, double *start) {
    ns_array_block at = {0};
    const ns_system *y = f->system;
    const size_t n = (size_t)y->n, m = (size_t)y->m, nz = (size_t)y->nz, r = (size_t)f->s->r;
    const size_t rows = 2 * m + (size_t)y->nc;
    const size_t q = r + (size_t)f->inputs->nv + (size_t)f->inputs->output_only_inputs;
    at.start = start;
    f->X = next_array(&at, q);
    f->X_next = next_array(&at, q);
    f->X_before = next_array(&at, q);
    f->order.X = next_array(&at, q);
    f->order.instant = next_array(&at, n + m);
    f->way.X_from = next_array(&at, q);
    f->way.X_base = next_array(&at, q);
    f->way.X_prefix = next_array(&at, NS_PREFIXES * q);
    f->way.X = next_array(&at, q);
    f->way.powers = next_array(&at, NS_ORDER * r);
    for (int k = 0; k < 2; k++)
        f->way.x_lambda[k] = next_array(&at, n + m);
    f->max_abs = next_array(&at, r);
    f->ohm = next_array(&at, m);
    f->work.x_lambda = next_array(&at, n + m);
    f->work.z = next_array(&at, nz);
    f->work.slope = next_array(&at, nz);
    f->work.powers = next_array(&at, NS_ORDER * r);
    f->work.sum = next_array(&at, r);
    f->work.flows = next_array(&at, (NS_ORDER + 1) * (n + m + nz + 1));
    f->work.coef = next_array(&at, NS_ORDER * rows);
    f->work.guards = next_array(&at, (NS_SAMPLES + 1) * rows);
    f->work.max_abs = next_array(&at, q);
    f->work.X_ahead = next_array(&at, q);
    f->work.values = next_array(&at, 3 * rows);
    f->work.jump_powers = next_array(&at, NS_ORDER * r);
    f->work.by = next_array(&at, r);
    f->work.gone = next_array(&at, r);
    f->work.impulse = next_array(&at, rows);
    f->work.jump_x_lambda = next_array(&at, n + m);
    f->work.z_after = next_array(&at, nz);
    f->work.slope_after = next_array(&at, nz);
    f->impulse.x = next_array(&at, n);
    f->impulse.lambda = next_array(&at, m);
    f->impulse.X = next_array(&at, n);
    f->impulse.Lambda = next_array(&at, m);
    return at.used;
}

/* 1 if lambda of pair j is a current between the nodes whose voltage its law reads. */
static int is_branch(const ns_system *s, size_t j) {
    const size_t n = (size_t)s->n, m = (size_t)s->m;
    int same = 1;
    for (size_t i = 0; i < n && same; i++)
        same = (s->B[i + j * n] != 0) == (s->C[j + i * m] != 0);
    return same;
}

static void find_resistances(ns_exact *f) {
    const size_t m = (size_t)f->system->m;
    for (size_t j = 0; j < m; j++)
        f->ohm[j] = is_branch(f->system, j) ? f->system->D[j + j * m] : 0;
}

static int allocate_arrays(ns_exact *f) {
    const size_t m = (size_t)f->system->m, nc = (size_t)f->system->nc;
    const size_t count = place_arrays(f, NULL);
    f->work.block = calloc(count + 1, sizeof(double));
    f->wanted = calloc(3 * m + 1, sizeof *f->wanted);
    f->work.closed = calloc(7 * nc + 1, 1);
    f->command_target = calloc(3 * nc + 1, sizeof *f->command_target);
    if (!f->work.block || !f->wanted || !f->work.closed || !f->command_target)
        return NS_E_MEMORY;
    (void)place_arrays(f, f->work.block);
    find_resistances(f);
    f->impulse.mode = f->wanted + m;
    f->work.mode = f->impulse.mode + m;
    f->work.flip = f->work.closed + nc;
    f->flips = f->work.flip + nc;
    f->order.first = f->flips + nc;
    f->order.first_flips = f->order.first + nc;
    f->order.due = f->order.first_flips + nc;
    f->order.changed = f->order.due + nc;
    f->order.first_target = f->command_target + nc;
    f->order.target = f->order.first_target + nc;
    return NS_OK;
}

static int all_timed(const ns_system *s) {
    for (int c = 0; c < s->nc; c++)
        if (s->command[c].gx)
            return 0;
    return 1;
}

static double shortest_of_output_only(const ns_exact *f) {
    double most = 0;
    for (int i = 0; i < f->inputs->output_only_inputs; i++)
        most = fmax(most, ns_inputs_wave_rate(&f->system->z[f->inputs->output_only_input[i]]));
    return NS_REACH / most;
}

int ns_exact_create(ns_theta *step, ns_dense_point *point, double h, ns_exact **out) {
    ns_exact *f = calloc(1, sizeof *f);
    *out = NULL;
    if (!f)
        return NS_E_MEMORY;
    f->system = step->s;
    f->s = step;
    f->point = point;
    f->h = h;
    f->cache.limit = step->maps.limit;
    f->timed = all_timed(f->system);
    ns_exact_event_intervals(NS_POLE, f->work.interval);
    f->acting = calloc((size_t)f->system->nz + 1, 1);
    int status = f->acting ? ns_system_active_inputs(f->system, f->acting) : NS_E_MEMORY;
    if (status == NS_OK)
        status = ns_inputs_events_create(f->system, f->acting, &f->events);
    if (status == NS_OK)
        status = ns_inputs_states_create(f->system, f->events, &f->inputs);
    if (status == NS_OK)
        status = allocate_arrays(f);
    if (status != NS_OK) {
        ns_exact_free(f);
        return status;
    }
    f->output_only_shortest = shortest_of_output_only(f);
    f->counts.input_states = f->inputs->nv;
    *out = f;
    return NS_OK;
}

void ns_exact_free(ns_exact *f) {
    if (!f)
        return;
    ns_exact_period_drop(f);
    ns_exact_mode_forget_all(f);
    ns_inputs_states_free(f->inputs);
    ns_inputs_events_free(f->events);
    free(f->record.v);
    free(f->work.block);
    free(f->work.closed);
    free(f->command_target);
    free(f->acting);
    free(f->wanted);
    free(f);
}

/* --- an input is replaced --- */

int ns_exact_input_matters(const ns_exact *f, int input) {
    return ns_inputs_states_has(f->inputs, input);
}

int ns_exact_set_input(ns_exact *f, int input) {
    int status = ns_inputs_states_can_be(f->inputs, input) ? NS_OK : NS_E_RANGE;
    if (status == NS_OK)
        status = ns_inputs_events_renew(f->acting, input, &f->events);
    f->events_to = -INFINITY; /* seek_events() has to seek */
    ns_exact_period_drop(f);
    return status;
}

int ns_exact_timed(const ns_exact *f) {
    return f->timed;
}

long ns_exact_replayed(const ns_exact *f) {
    return f->replayed;
}

const ns_counts *ns_exact_counts(const ns_exact *f) {
    return &f->counts;
}
