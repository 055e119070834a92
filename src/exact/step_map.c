/* src/exact/step_map.c - steps inside one mode, as matrices: made of its stage, kept while they recur. */
#include "exact_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static ns_step_map *create(const ns_mode_kernel *k, double h, int samples) {
    const size_t q = (size_t)k->q, nv = (size_t)k->nv, r = (size_t)k->r;
    const size_t count = r * q + nv * nv;
    const size_t bytes = sizeof(ns_step_map) + count * sizeof(double);
    ns_step_map *leg = calloc(1, bytes);
    if (!leg)
        return NULL;
    leg->h = h;
    leg->samples = samples;
    leg->P = (double *)(void *)(leg + 1);
    leg->advance = leg->P + r * q;
    leg->bytes = bytes;
    return leg;
}

void ns_exact_step_free(ns_step_map *leg) {
    if (leg)
        free(leg->sample);
    free(leg);
}

/* So many that guards are smooth from one to the next: four stages apart at most, two pieces at least. */
static int samples_for(const ns_mode_kernel *k, double h) {
    return k->rows == 0 ? 0 : (int)fmin(NS_SAMPLES, fmax(2, ceil(h / (4 * k->h) - 1e-9)));
}

/* P (r*q) of any length, from rungs and the rest; advance, room: nv*nv, r*q. */
static int matrix_of(ns_exact *f, ns_time_scale *level, double h, double *P, double *advance, double *room) {
    const ns_mode_kernel *k = level->stage;
    const size_t bytes = sizeof(double) * (size_t)k->r * (size_t)k->q;
    double count = floor(h / k->h), done = h - count * k->h;
    if (done >= k->h || done < 0)
        done = 0;
    if (done > 0 || count < 1)
        ns_exact_kernel_step(k, done, P);
    for (int i = 0; count > 0 && i <= NS_UNGUARDED; i++, count = floor(count / 2)) {
        ns_step_map *rung;
        if (fmod(count, 2) == 0)
            continue;
        const int status = ns_exact_step_of_length(f, level, i, &rung);
        if (status != NS_OK)
            return status;
        if (done > 0) {
            ns_exact_input_matrix(f->exo, done, advance);
            ns_exact_kernel_compose(k, rung->P, P, advance, room);
        }
        memcpy(P, done > 0 ? room : rung->P, bytes);
        done += rung->h;
    }
    ns_exact_input_matrix(f->exo, h, advance);
    return NS_OK;
}

/* The guards every h/samples: S_0 = value, S_(i+1) = S_i after the step of that length; S, next: rows*q. */
static void fill_samples(const ns_mode_kernel *k, const double *P, const double *advance, double *S,
                         double *next, const ns_step_map *leg) {
    const size_t rows = (size_t)k->rows, all = ((size_t)leg->samples + 1) * rows, r = (size_t)k->r;
    for (int j = 0; j < k->q; j++)
        for (int g = 0; g < k->rows; g++)
            S[g + j * k->rows] = k->value[j + g * k->q];
    for (int i = 0; i <= leg->samples; i++) {
        for (size_t j = 0; j < (size_t)k->q; j++) {
            memcpy(leg->sample + (size_t)i * rows + j * all, S + j * rows, sizeof *S * rows);
            if (i == leg->samples)
                continue;
            ns_linalg_matvec(k->rows, k->r, S, P + j * r, next + j * rows);
            if (j >= r)
                ns_linalg_matvec_add(k->rows, k->nv, S + r * rows, advance + (j - r) * (size_t)k->nv,
                                     next + j * rows);
        }
        double *swap = S;
        S = next;
        next = swap;
    }
}

int ns_exact_step_sample(ns_exact *f, ns_time_scale *level, ns_step_map *leg) {
    const ns_mode_kernel *k = level->stage;
    const size_t size = (size_t)k->r * (size_t)k->q, nv = (size_t)k->nv, row = (size_t)k->rows * (size_t)k->q;
    const size_t bytes = sizeof(double) * ((size_t)leg->samples + 1) * row;
    if (leg->sample || leg->samples == 0)
        return NS_OK;
    double *P = malloc(sizeof *P * (2 * size + nv * nv + 2 * row + 1));
    leg->sample = malloc(bytes);
    int status = P && leg->sample ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK)
        status = matrix_of(f, level, leg->h / leg->samples, P, P + 2 * size, P + size);
    if (status == NS_OK) {
        double *S = P + 2 * size + nv * nv;
        fill_samples(k, P, P + 2 * size, S, S + row, leg);
        leg->bytes += bytes;
        f->bytes += bytes;
    } else {
        free(leg->sample);
        leg->sample = NULL;
    }
    free(P);
    return status;
}

/* Counts a leg that is made, or frees it. */
static int finish(ns_exact *f, ns_step_map *leg, int status, ns_step_map **out) {
    if (status != NS_OK) {
        ns_exact_step_free(leg);
        return status;
    }
    f->bytes += leg->bytes;
    f->s->counts.maps++;
    *out = leg;
    return NS_OK;
}

static int build(ns_exact *f, ns_time_scale *level, double h, ns_step_map **out) {
    const ns_mode_kernel *k = level->stage;
    const size_t size = (size_t)k->r * (size_t)k->q;
    ns_step_map *leg = create(k, h, h <= ldexp(k->h, NS_GUARDED) * 1.01 ? samples_for(k, h) : 0);
    double *room = malloc(sizeof *room * (size + 1));
    int status = leg && room ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK)
        status = matrix_of(f, level, h, leg->P, leg->advance, room);
    free(room);
    return finish(f, leg, status, out);
}

/* The rung's P by the one below, twice; the lowest is the stage's own. */
static int build_rung(ns_exact *f, ns_time_scale *level, int k, ns_step_map **out) {
    const ns_mode_kernel *stage = level->stage;
    const double h = ldexp(stage->h, k);
    ns_step_map *below = NULL, *leg = create(stage, h, k <= NS_GUARDED ? samples_for(stage, h) : 0);
    int status = leg ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK && k > 0)
        status = ns_exact_step_of_length(f, level, k - 1, &below);
    if (status == NS_OK && below)
        ns_exact_kernel_compose(stage, below->P, below->P, below->advance, leg->P);
    else if (status == NS_OK)
        memcpy(leg->P, stage->step, sizeof(double) * (size_t)stage->r * (size_t)stage->q);
    if (status == NS_OK)
        ns_exact_input_matrix(f->exo, h, leg->advance);
    return finish(f, leg, status, out);
}

int ns_exact_step_of_length(ns_exact *f, ns_time_scale *level, int k, ns_step_map **out) {
    const int status = level->rung[k] ? NS_OK : build_rung(f, level, k, &level->rung[k]);
    *out = level->rung[k];
    return status;
}

double ns_exact_step_slack(const ns_exact *f, double h) {
    return 4 * DBL_EPSILON * fabs(f->t) + 1e-15 * h;
}

/* The place of a length; *known: it was asked for before.  If not it takes the place of the one that was not
 * asked for for longest. */
static ns_cached_step *place_of(ns_exact *f, ns_time_scale *level, double h, int *known) {
    const double slack = ns_exact_step_slack(f, h);
    ns_cached_step *oldest = level->kept, *found = &level->kept[level->recent];
    *known = fabs(found->h - h) <= slack;
    for (int i = 0; i < NS_KEPT && !*known; i++) {
        found = &level->kept[i];
        *known = fabs(found->h - h) <= slack;
        if (found->used < oldest->used)
            oldest = found;
    }
    level->recent = (int)((*known ? found : oldest) - level->kept);
    if (*known)
        return found;
    if (oldest->leg) {
        f->bytes -= oldest->leg->bytes;
        f->steps_dropped++;
    }
    ns_exact_step_free(oldest->leg);
    oldest->leg = NULL;
    oldest->h = h;
    return oldest;
}

int ns_exact_step_recurring(ns_exact *f, ns_time_scale *level, double h, ns_step_map **out) {
    int known, status = NS_OK;
    ns_cached_step *at = place_of(f, level, h, &known);
    at->used = ++f->clock;
    if (known && !at->leg)
        status = build(f, level, at->h, &at->leg);
    *out = at->leg;
    return status;
}

void ns_exact_step_apply(const ns_mode_kernel *k, const ns_step_map *leg, const double *X, double *then) {
    ns_linalg_matvec(k->r, k->q, leg->P, X, then);
    ns_linalg_matvec(k->nv, k->nv, leg->advance, X + k->r, then + k->r);
}

void ns_exact_step_commit(ns_exact *f, const ns_time_scale *level, const ns_step_map *leg) {
    double *X = f->X;
    ns_exact_step_apply(level->stage, leg, X, f->next);
    f->X = f->next;
    f->next = X;
    f->s->counts.steps++;
}

/* tau <= h, by the series. */
static void creep(ns_exact *f, const ns_mode_kernel *k, double tau) {
    double b[NS_ORDER + 1], *last = f->gone;
    ns_linalg_matvec(NS_ORDER * k->r, k->q, k->series, f->X, f->series);
    ns_modes_laguerre_steps(tau / k->g, b);
    ns_linalg_matvec(k->r, NS_ORDER - 1, f->series + k->r, b + 2, last); /* what is small first */
    for (int i = 0; i < k->r; i++)
        f->X[i] += last[i] + b[1] * f->series[i]; /* (E2) */
    ns_inputs_states_advance(f->exo, tau, f->X + k->r);
    f->s->counts.steps++;
}

int ns_exact_step_advance(ns_exact *f, ns_time_scale *level, double tau) {
    const ns_mode_kernel *k = level->stage;
    double count = floor(tau / k->h);
    const double rest = tau - count * k->h;
    int i = 0;
    while (count > 0) {
        ns_step_map *rung;
        const int odd = fmod(count, 2) != 0, at = i++;
        count = floor(count / 2);
        if (!odd)
            continue;
        const int status = ns_exact_step_of_length(f, level, at < NS_UNGUARDED ? at : NS_UNGUARDED, &rung);
        if (status != NS_OK)
            return status;
        ns_exact_step_commit(f, level, rung);
    }
    if (rest > 0)
        creep(f, k, rest);
    return NS_OK;
}
