/* src/inputs/time_events_create.c - time events made for a system: inputs that enter, commands of time. */
#include "time_events_internal.h"

#include <stdlib.h>

static int shared_wave(ns_time_events *s, const ns_wave *w) {
    int k = 0;
    while (k < s->waves &&
           !(s->wave[k].freq == w->freq && s->wave[k].theta == w->theta && s->wave[k].td == w->td))
        k++;
    if (k == s->waves)
        s->wave[s->waves++] = *w;
    return k;
}

static void add_curve(ns_time_events *s, int input) {
    ns_wave wave[NS_TERMS];
    const int count = ns_inputs_wave_terms(&s->s->z[input], s->term + s->terms, wave, &s->base[s->entering]);
    s->input[s->entering++] = input;
    for (int k = 0; k < count; k++) {
        ns_wave_term *x = &s->term[s->terms++];
        x->input = input;
        x->wave = shared_wave(s, &wave[k]);
    }
}

static void add_inputs(ns_time_events *s, const unsigned char *active) {
    for (int i = 0; i < s->s->nz; i++)
        if (ns_signal_is_linear(&s->s->z[i]) && active && active[i]) {
            s->cursor[s->lines++].line = &s->line[i];
            s->input[s->entering++] = i;
        }
    for (int i = 0; i < s->s->nz; i++)
        if (!ns_signal_is_linear(&s->s->z[i]) && active && active[i])
            add_curve(s, i);
}

static int create_lines(ns_time_events *s) {
    int status = NS_OK;
    for (int i = 0; i < s->s->nz && status == NS_OK; i++)
        if (ns_signal_is_linear(&s->s->z[i]))
            status = ns_system_line_create(&s->s->z[i], &s->line[i]);
    return status;
}

static int add_commands(ns_time_events *s) {
    int status = NS_OK;
    for (int c = 0; c < s->s->nc && status == NS_OK; c++) {
        if (!ns_inputs_is_time_only(s->s, c))
            continue;
        s->command_index[s->commands] = c;
        status = ns_inputs_switch_create(s->s, c, s->line, &s->command[s->commands++]);
    }
    return status;
}

static int allocate_arrays(ns_time_events *s) {
    const size_t nz = (size_t)s->s->nz + 1, nc = (size_t)s->s->nc + 1, terms = NS_TERMS * nz;
    s->line = calloc(nz, sizeof *s->line);
    s->cursor = calloc(nz, sizeof *s->cursor);
    s->base = calloc(nz, sizeof *s->base);
    s->term = calloc(terms, sizeof *s->term);
    s->wave = calloc(terms, sizeof *s->wave);
    s->command = calloc(nc, sizeof *s->command);
    s->heap = calloc(nz + terms + nc, sizeof *s->heap);
    s->input = calloc(2 * nz + terms + 4 * nc, sizeof *s->input);
    s->begun = calloc(terms + nc, 1);
    if (!s->line || !s->cursor || !s->base || !s->term || !s->wave || !s->command || !s->heap || !s->input ||
        !s->begun)
        return NS_E_MEMORY;
    s->changed = s->input + nz;
    s->command_index = s->changed + nz + terms;
    s->flips = s->command_index + nc;
    s->touched = s->flips + nc;
    s->flip = s->touched + nc;
    s->closed = s->begun + terms;
    return NS_OK;
}

int ns_inputs_events_create(const ns_system *system, const unsigned char *active, ns_time_events **out) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!system)
        return NS_E_NULL;
    ns_time_events *s = calloc(1, sizeof *s);
    if (!s)
        return NS_E_MEMORY;
    s->s = system;
    int status = allocate_arrays(s);
    if (status == NS_OK)
        status = create_lines(s);
    if (status == NS_OK)
        status = add_commands(s);
    if (status != NS_OK) {
        ns_inputs_events_free(s);
        return status;
    }
    add_inputs(s, active);
    s->count = s->lines + s->terms + s->commands;
    ns_inputs_events_seek(s, 0, NS_RIGHT, NULL);
    *out = s;
    return NS_OK;
}

/* --- an input that is replaced --- */

static void swap_lines(ns_broken_line *a, ns_broken_line *b) {
    const ns_broken_line kept = *a;
    *a = *b;
    *b = kept;
}

/* 1 if an input acts on command c of the system. */
static int acts_on(const ns_system *s, int input, int c) {
    int acts = 0, at;
    for (int q = 0; q < ns_inputs_gains(s, c); q++)
        acts |= ns_inputs_gain(s, c, q, &at) != 0 && at == input;
    return acts;
}

/* The commands on which the input acts, made anew: in made (commands), others stay zero. */
static int create_commands(const ns_time_events *s, int input, ns_switch_times *made) {
    int status = NS_OK;
    for (int k = 0; k < s->commands && status == NS_OK; k++)
        if (acts_on(s->s, input, s->command_index[k]))
            status = ns_inputs_switch_create(s->s, s->command_index[k], s->line, &made[k]);
    return status;
}

static void swap_commands(ns_time_events *s, ns_switch_times *made) {
    for (int k = 0; k < s->commands; k++) {
        const ns_switch_times old = s->command[k];
        if (!made[k].line)
            continue;
        s->command[k] = made[k];
        made[k] = old;
    }
}

/* A broken line in place of another one: what does not depend on it stays. */
static int renew_line(ns_time_events *s, int input) {
    ns_switch_times *made = calloc((size_t)s->commands + 1, sizeof *made);
    ns_broken_line old = s->line[input];
    int status = made ? ns_system_line_create(&s->s->z[input], &s->line[input]) : NS_E_MEMORY;
    if (status == NS_OK) {
        status = create_commands(s, input, made);
        if (status == NS_OK)
            swap_commands(s, made);
        else
            swap_lines(&s->line[input], &old);
        ns_system_line_free(&old);
    } else {
        s->line[input] = old;
    }
    for (int k = 0; made && k < s->commands; k++)
        ns_inputs_switch_free(&made[k]);
    free(made);
    if (status == NS_OK)
        ns_inputs_events_seek(s, 0, NS_RIGHT, NULL);
    return status;
}

int ns_inputs_events_renew(const unsigned char *active, int input, ns_time_events **s) {
    ns_time_events *now;
    if ((*s)->line[input].piece && ns_signal_is_linear(&(*s)->s->z[input]))
        return renew_line(*s, input);
    const int status = ns_inputs_events_create((*s)->s, active, &now);
    if (status != NS_OK)
        return status;
    ns_inputs_events_free(*s);
    *s = now;
    return NS_OK;
}

void ns_inputs_events_free(ns_time_events *s) {
    if (!s)
        return;
    for (int i = 0; s->line && i < s->s->nz; i++)
        ns_system_line_free(&s->line[i]);
    for (int c = 0; s->command && c < s->commands; c++)
        ns_inputs_switch_free(&s->command[c]);
    free(s->line);
    free(s->cursor);
    free(s->input);
    free(s->base);
    free(s->term);
    free(s->begun);
    free(s->wave);
    free(s->command);
    free(s->heap);
    free(s);
}
