/* src/exact/step_map.c - steps inside one mode, as matrices: made from its kernel, kept while they recur. */
#include "exact_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static ns_step_map *allocate_map(const ns_mode_kernel *k, double h, int samples) {
    const size_t q = (size_t)k->q, nv = (size_t)k->nv, r = (size_t)k->r;
    const size_t flows = k->flow_powers ? (size_t)k->flows : 0, count = (r + flows) * q + nv * nv;
    const size_t bytes = sizeof(ns_step_map) + count * sizeof(double);
    ns_step_map *map = calloc(1, bytes);
    if (!map)
        return NULL;
    map->h = h;
    map->samples = samples;
    map->P = (double *)(void *)(map + 1);
    map->J = flows > 0 ? map->P + r * q : NULL;
    map->advance = map->P + (r + flows) * q;
    map->bytes = bytes;
    return map;
}

void ns_exact_step_free(ns_step_map *map) {
    if (map)
        free(map->sample);
    free(map);
}

/* So many that guards are smooth from one to the next: four steps of a kernel apart at most, two intervals
 * at least. */
static int samples_for(const ns_mode_kernel *k, double step, double h) {
    return k->rows == 0 ? 0 : (int)fmin(NS_SAMPLES, fmax(2, ceil(h / (4 * step) - 1e-9)));
}

/* count: a whole number >= 0.  fmod() takes as long as a step. */
static int is_odd(double count) {
    return count - 2 * floor(0.5 * count) != 0;
}

/* How many numbers P is, with the flows behind it. */
static size_t size_of(const ns_mode_kernel *k) {
    return ((size_t)k->r + (k->flow_powers ? (size_t)k->flows : 0)) * (size_t)k->q;
}

static void fill_short(const ns_mode_kernel *k, double tau, double *P) {
    if (k->flow_powers)
        ns_exact_kernel_flows_step(k, tau, P);
    else
        ns_exact_kernel_step(k, tau, P);
}

static void compose(const ns_mode_kernel *k, const double *P2, const double *P1, const double *advance,
                    double *P) {
    if (k->flow_powers)
        ns_exact_kernel_flows_compose(k, P2, P1, advance, P);
    else
        ns_exact_kernel_compose(k, P2, P1, advance, P);
}

/* P of less than a step of the kernel, and nothing else: (E2) multiplies what is infinitely fast by
 * L_8(tau/g), 0.65 at most below `stable`, but up to 1.28 beyond: a longer one is made of two halves, or
 * where the length recurs rounding would grow without end.  (A whole step of the kernel leaves nothing of
 * it.) */
static void fill_alone(ns_exact *f, const ns_mode_kernel *k, double tau, double *P, double *advance,
                       double *room) {
    static const double stable = 2.7;
    if (!(tau > stable * k->g)) {
        fill_short(k, tau, P);
        return;
    }
    fill_short(k, tau / 2, room);
    ns_exact_input_matrix(f->inputs, tau / 2, advance);
    compose(k, room, room, advance, P);
}

/* P of any length h, from steps of the kernel's h 2^k and the rest; advance, room: nv*nv, as P. */
static int fill_matrix(ns_exact *f, ns_time_scale *scale, double h, double *P, double *advance,
                       double *room) {
    const ns_mode_kernel *k = scale->kernel;
    const size_t bytes = size_of(k) * sizeof *P;
    double count = floor(h / k->h), done = h - count * k->h;
    if (done >= k->h || done < 0)
        done = 0;
    if (count < 1)
        fill_alone(f, k, done, P, advance, room);
    else if (done > 0)
        fill_short(k, done, P);
    for (int i = 0; count > 0 && i <= NS_MAX_EXPONENT; i++, count = floor(count / 2)) {
        ns_step_map *doubled;
        if (!is_odd(count))
            continue;
        const int status = ns_exact_step_of_length(f, scale, i, &doubled);
        if (status != NS_OK)
            return status;
        if (done > 0) {
            ns_exact_input_matrix(f->inputs, done, advance);
            compose(k, doubled->P, P, advance, room);
        }
        memcpy(P, done > 0 ? room : doubled->P, bytes);
        done += doubled->h;
    }
    ns_exact_input_matrix(f->inputs, h, advance);
    return NS_OK;
}

/* The guards every h/samples: S_0 = value, S_(i+1) = S_i after the step of that length; S, next: rows*q. */
static void fill_samples(const ns_mode_kernel *k, const double *P, const double *advance, double *S,
                         double *next, const ns_step_map *map) {
    const size_t rows = (size_t)k->rows, all = ((size_t)map->samples + 1) * rows, r = (size_t)k->r;
    for (int j = 0; j < k->q; j++)
        for (int g = 0; g < k->rows; g++)
            S[g + j * k->rows] = k->value[j + g * k->q];
    for (int i = 0; i <= map->samples; i++) {
        for (size_t j = 0; j < (size_t)k->q; j++) {
            memcpy(map->sample + (size_t)i * rows + j * all, S + j * rows, sizeof *S * rows);
            if (i == map->samples)
                continue;
            ns_linalg_matvec(k->rows, k->r, S, P + j * r, next + j * rows);
            for (size_t g = 0; g < rows && k->flow_powers && j < r; g++)
                next[g + j * rows] += S[g + j * rows]; /* P is what is added */
            if (j >= r)
                ns_linalg_matvec_add(k->rows, k->nv, S + r * rows, advance + (j - r) * (size_t)k->nv,
                                     next + j * rows);
        }
        double *swap = S;
        S = next;
        next = swap;
    }
}

int ns_exact_step_sample(ns_exact *f, ns_time_scale *scale, ns_step_map *map) {
    const ns_mode_kernel *k = scale->kernel;
    const size_t size = size_of(k), nv = (size_t)k->nv, row = (size_t)k->rows * (size_t)k->q;
    const size_t bytes = sizeof(double) * ((size_t)map->samples + 1) * row;
    if (map->sample || map->samples == 0)
        return NS_OK;
    double *P = malloc(sizeof *P * (2 * size + nv * nv + 2 * row + 1));
    map->sample = malloc(bytes);
    int status = P && map->sample ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK)
        status = fill_matrix(f, scale, map->h / map->samples, P, P + 2 * size, P + size);
    if (status == NS_OK) {
        double *S = P + 2 * size + nv * nv;
        fill_samples(k, P, P + 2 * size, S, S + row, map);
        map->bytes += bytes;
        f->cache.bytes += bytes;
    } else {
        free(map->sample);
        map->sample = NULL;
    }
    free(P);
    return status;
}

/* Counts a map that is made, or frees it. */
static int count_or_free(ns_exact *f, ns_step_map *map, int status, ns_step_map **out) {
    if (status != NS_OK) {
        ns_exact_step_free(map);
        return status;
    }
    f->cache.bytes += map->bytes;
    f->counts.maps++;
    *out = map;
    return NS_OK;
}

static int build_map(ns_exact *f, ns_time_scale *scale, double h, ns_step_map **out) {
    const ns_mode_kernel *k = scale->kernel;
    ns_step_map *map =
        allocate_map(k, h, h <= ldexp(k->h, NS_MAX_GUARDED_EXPONENT) * 1.01 ? samples_for(k, k->h, h) : 0);
    double *room = malloc(sizeof *room * (size_of(k) + 1));
    int status = map && room ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK)
        status = fill_matrix(f, scale, h, map->P, map->advance, room);
    free(room);
    return count_or_free(f, map, status, out);
}

/* The step of h 2^k as that of h 2^(k-1), twice; k = 0: the kernel's own. */
static int build_doubled(ns_exact *f, ns_time_scale *scale, int k, ns_step_map **out) {
    const ns_mode_kernel *kernel = scale->kernel;
    const double h = ldexp(kernel->h, k);
    ns_step_map *below = NULL,
                *map = allocate_map(kernel, h,
                                    k <= NS_MAX_GUARDED_EXPONENT ? samples_for(kernel, kernel->h, h) : 0);
    int status = map ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK && k > 0)
        status = ns_exact_step_of_length(f, scale, k - 1, &below);
    if (status == NS_OK && below)
        compose(kernel, below->P, below->P, below->advance, map->P);
    else if (status == NS_OK && map->J)
        ns_exact_kernel_flows_step(kernel, h, map->P);
    else if (status == NS_OK)
        memcpy(map->P, kernel->step, sizeof(double) * (size_t)kernel->r * (size_t)kernel->q);
    if (status == NS_OK)
        ns_exact_input_matrix(f->inputs, h, map->advance);
    return count_or_free(f, map, status, out);
}

int ns_exact_step_spaced(ns_exact *f, ns_time_scale *scale, int k, double spacing, ns_step_map **out) {
    const ns_mode_kernel *kernel = scale->kernel;
    const double h = ldexp(kernel->h, k);
    ns_step_map *same;
    const int status = ns_exact_step_of_length(f, scale, k, &same);
    ns_step_map *map = status == NS_OK ? allocate_map(kernel, h, samples_for(kernel, spacing, h)) : NULL;
    if (!map)
        return status == NS_OK ? NS_E_MEMORY : status;
    memcpy(map->P, same->P, sizeof(double) * size_of(kernel));
    memcpy(map->advance, same->advance, sizeof(double) * (size_t)kernel->nv * (size_t)kernel->nv);
    return count_or_free(f, map, status, out);
}

int ns_exact_step_of_length(ns_exact *f, ns_time_scale *scale, int k, ns_step_map **out) {
    const int status = scale->doubled[k] ? NS_OK : build_doubled(f, scale, k, &scale->doubled[k]);
    *out = scale->doubled[k];
    return status;
}

double ns_exact_step_length_error(const ns_exact *f, double h) {
    return 4 * DBL_EPSILON * fabs(f->state.now.t) + 1e-15 * h;
}

/* The place of a length; *known: it was asked for before.  If not it takes the place of the least recently
 * used one. */
static ns_cached_step *find_place(ns_exact *f, ns_time_scale *scale, double h, int *known) {
    const double slack = ns_exact_step_length_error(f, h);
    ns_cached_step *oldest = scale->cached, *found = &scale->cached[scale->recent];
    *known = fabs(found->h - h) <= slack;
    for (int i = 0; i < NS_CACHED_STEPS && !*known; i++) {
        found = &scale->cached[i];
        *known = fabs(found->h - h) <= slack;
        if (found->last_used < oldest->last_used)
            oldest = found;
    }
    scale->recent = (int)((*known ? found : oldest) - scale->cached);
    if (*known)
        return found;
    if (oldest->map) {
        f->cache.bytes -= oldest->map->bytes;
        f->cache.steps_dropped++;
    }
    ns_exact_step_free(oldest->map);
    oldest->map = NULL;
    oldest->h = h;
    return oldest;
}

int ns_exact_step_recurring(ns_exact *f, ns_time_scale *scale, double h, ns_step_map **out) {
    int known, status = NS_OK;
    *out = NULL;
    if (h <= ns_exact_step_length_error(f, h)) /* as good as zero, which is the length of an unused place */
        return NS_OK;
    ns_cached_step *at = find_place(f, scale, h, &known);
    at->last_used = ++f->cache.clock;
    if (known && !at->map)
        status = build_map(f, scale, at->h, &at->map);
    *out = at->map;
    return status;
}

void ns_exact_step_apply(ns_exact *f, const ns_mode_kernel *k, const ns_step_map *map, const double *X,
                         double *then) {
    if (map->J) {
        double *flows = f->work.flows;
        ns_linalg_matvec(k->flows, k->q, map->J, X, flows);
        ns_linalg_matvec(k->r, k->flows, k->flow_into, flows, then);
        for (int i = 0; i < k->r; i++)
            then[i] += X[i];
    } else {
        ns_linalg_matvec(k->r, k->q, map->P, X, then);
    }
    ns_linalg_matvec(k->nv, k->nv, map->advance, X + k->r, then + k->r);
}

void ns_exact_step_commit(ns_exact *f, const ns_time_scale *scale, const ns_step_map *map) {
    ns_exact_step_apply(f, scale->kernel, map, f->X, f->X_next);
    ns_exact_take_next(f);
    f->counts.steps++;
}

/* X moves on by tau <= h (E2), summed from flows. */
static void add_flows(ns_exact *f, const ns_mode_kernel *k, double tau) {
    const int count = k->flows;
    double b[NS_ORDER + 1], *powers = f->work.flows, *sum = powers + NS_ORDER * count;
    ns_linalg_matvec(NS_ORDER * count, k->q, k->flow_powers, f->X, powers);
    ns_modes_laguerre_steps(tau / k->g, b);
    ns_linalg_matvec(count, NS_ORDER, powers, b + 1, sum);
    ns_linalg_matvec_add(k->r, count, k->flow_into, sum, f->X);
}

/* The same, by D^i. */
static void add_powers(ns_exact *f, const ns_mode_kernel *k, double tau) {
    double b[NS_ORDER + 1], *last = f->work.sum;
    ns_linalg_matvec(NS_ORDER * k->r, k->q, k->laguerre_powers, f->X, f->work.powers);
    ns_modes_laguerre_steps(tau / k->g, b);
    ns_linalg_matvec(k->r, NS_ORDER - 1, f->work.powers + k->r, b + 2, last); /* small terms first */
    for (int i = 0; i < k->r; i++)
        f->X[i] += last[i] + b[1] * f->work.powers[i]; /* (E2) */
}

int ns_exact_step_advance(ns_exact *f, ns_time_scale *scale, double tau) {
    const ns_mode_kernel *k = scale->kernel;
    double count = floor(tau / k->h);
    const double rest = tau - count * k->h;
    int i = 0;
    while (count > 0) {
        ns_step_map *doubled;
        const int odd = is_odd(count), at = i++;
        count = floor(count / 2);
        if (!odd)
            continue;
        const int status =
            ns_exact_step_of_length(f, scale, at < NS_MAX_EXPONENT ? at : NS_MAX_EXPONENT, &doubled);
        if (status != NS_OK)
            return status;
        ns_exact_step_commit(f, scale, doubled);
    }
    if (rest > 0) {
        (k->flow_powers ? add_flows : add_powers)(f, k, rest);
        ns_inputs_states_advance(f->inputs, rest, f->X + k->r);
        f->counts.steps++;
    }
    return NS_OK;
}
