/* src/circuit/switch_commands.c - the commands of switches, and which controls are functions of time alone.
 *
 * Nodes joined by voltage sources whose value is known at any time (independent ones, R = 0, and controlled
 * ones whose control is itself known) form groups; inside a group every difference of potentials is
 *     a sum over few inputs, and a constant.
 */
#include <math.h>
#include <stdlib.h>

#include "circuit_internal.h"

/* The potential of a node: by how many volts each input counts in it, by ascending input; nz stands for the
 * constant 1. */
typedef struct potential {
    int count;
    int *of;
    double *volts;
} potential;

typedef struct potentials {
    const ns_circuit *c;
    int count;                /* used nodes, then ground */
    int nz;                   /* inputs */
    int *group;               /* count */
    int *next;                /* count: the next node of the same group, in a ring */
    int *size;                /* count: of the group of this number */
    potential *volts;         /* count: against the group's own zero */
    double *gap;              /* nz+1: v_p - v_n of a source, */
    int *in_gap;              /* nz+1: the inputs it is made of, */
    char *has;                /* nz+1: these, marked */
    const ns_signal **signal; /* nz+1: of each input */
    int in_gap_count;
    double largest; /* V: of all sources; 0: not known yet */
    int failed;     /* memory ran out */
} potentials;

static int node_place(const potentials *p, int number) {
    return number == 0 ? p->count - 1 : ns_circuit_node_unknown(p->c, number);
}

/* By how much input k counts. */
static double volts_of(const potential *s, int k) {
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

static void clear_gap(potentials *p) {
    for (int i = 0; i < p->in_gap_count; i++) {
        p->gap[p->in_gap[i]] = 0;
        p->has[p->in_gap[i]] = 0;
    }
    p->in_gap_count = 0;
}

static void add_gap(potentials *p, int k, double volts) {
    if (!p->has[k]) {
        p->has[k] = 1;
        p->in_gap[p->in_gap_count++] = k;
    }
    p->gap[k] += volts;
}

/* gap += gain (v_p - v_n); 0 if they are of different groups. */
static int add_difference(potentials *p, double gain, int at_p, int at_n) {
    const potential *a = &p->volts[at_p], *b = &p->volts[at_n];
    if (p->group[at_p] != p->group[at_n]) {
        return 0;
    }
    for (int i = 0; i < a->count; i++) {
        add_gap(p, a->of[i], gain * (a->volts[i] - volts_of(b, a->of[i])));
    }
    for (int i = 0; i < b->count; i++) {
        if (volts_of(a, b->of[i]) == 0) {
            add_gap(p, b->of[i], gain * -b->volts[i]);
        }
    }
    return 1;
}

/* The first terms of an element: each node must be known against ground. */
static int add_terms(potentials *p, const element *e, int count) {
    int known = 1;
    for (int i = 0; i < count && known; i++) {
        known = !e->terms[i].is_current &&
                add_difference(p, e->terms[i].gain, node_place(p, e->terms[i].of), node_place(p, 0));
    }
    return known;
}

/* gap = v_p - v_n of an element; 0 if it does not fix that as a function of time. */
static int known_gap(potentials *p, const element *e) {
    clear_gap(p);
    if (e->current < 0) {
        return 0;
    }
    switch (e->kind) {
    case RESISTOR: /* others have a current too (tiny_resistor.c) */
        return e->value == 0;
    case SOURCE:
        add_gap(p, e->input >= 0 ? e->input : p->nz, e->input >= 0 ? 1 : e->signal.u.dc);
        return 1;
    case VCONTROLLED:
        return add_difference(p, e->value, node_place(p, e->node[2]), node_place(p, e->node[3]));
    case LINEAR:
        add_gap(p, p->nz, e->value);
        return add_terms(p, e, e->nterms);
    default:
        return 0;
    }
}

static int by_number(const void *a, const void *b) {
    return *(const int *)a - *(const int *)b;
}

/* A node's potential += the gap. */
static void shift_potential(potentials *p, potential *s) {
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
    *s = (potential){count, of, volts};
}

/* Shifts the smaller of the two groups so that v_a - v_b = gap, and makes it the other's. */
static void join_groups(potentials *p, int a, int b) {
    const int flip = p->size[p->group[a]] < p->size[p->group[b]];
    const int kept = flip ? b : a, moved = flip ? a : b, to = p->group[kept], from = p->group[moved];
    const potential *base = &p->volts[kept], *own = &p->volts[moved];
    for (int i = 0; i < p->in_gap_count && !flip; i++) {
        p->gap[p->in_gap[i]] = -p->gap[p->in_gap[i]];
    }
    for (int i = 0; i < base->count; i++) {
        add_gap(p, base->of[i], base->volts[i]);
    }
    for (int i = 0; i < own->count; i++) {
        add_gap(p, own->of[i], -own->volts[i]);
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
static int join_known(potentials *p) {
    int joined = 0;
    for (int i = 0; i < p->c->nelements && !p->failed; i++) {
        const element *e = &p->c->element[i];
        if (known_gap(p, e)) {
            int a = node_place(p, e->node[0]), b = node_place(p, e->node[1]);
            if (p->group[a] != p->group[b]) {
                join_groups(p, a, b);
                joined++;
            }
        }
    }
    return joined;
}

static int find_potentials(potentials *p, const ns_circuit *c) {
    size_t count = (size_t)c->nused + 1, width = (size_t)c->ninputs + 1;
    *p = (potentials){.c = c, .count = c->nused + 1, .nz = c->ninputs};
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

static void free_potentials(potentials *p) {
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

/* Room for the control's entries, unless they go to lists. */
static int allocate_control(const stamp *to, double **room, int count) {
    if (to->entries) {
        return NS_OK;
    }
    *room = calloc((size_t)count, sizeof(double));
    return *room ? NS_OK : NS_E_MEMORY;
}

/* g = the known difference. */
static int stamp_time_control(const stamp *to, const potentials *p, int command) {
    int any = 0, status;
    for (int i = 0; i < p->in_gap_count; i++) {
        any |= p->in_gap[i] < p->nz && p->gap[p->in_gap[i]] != 0;
    }
    to->s->command[command].g0 = p->gap[p->nz];
    if (!any || (status = allocate_control(to, &to->s->command[command].gz, p->nz))) {
        return any ? status : NS_OK;
    }
    for (int i = 0; i < p->in_gap_count; i++) {
        if (p->in_gap[i] < p->nz) {
            ns_circuit_stamp_add(to, IN_GZ, p->in_gap[i], command, p->gap[p->in_gap[i]]);
        }
    }
    return NS_OK;
}

static void shift_command(const stamp *to, const element *e, double shift) {
    to->s->command[e->command].on += shift;
    to->s->command[e->command].off += shift;
}

/* The known difference as a sum of inputs; NULL: no memory. */
static ns_input_gain *terms_of_gap(const potentials *p, int *count) {
    ns_input_gain *term = calloc((size_t)p->in_gap_count + 1, sizeof *term);
    *count = 0;
    for (int i = 0; term && i < p->in_gap_count; i++) {
        const int input = p->in_gap[i];
        if (input < p->nz && p->gap[input] != 0) {
            term[(*count)++] = (ns_input_gain){p->signal[input], p->gap[input]};
        }
    }
    return term;
}

/* Its threshold, of a known difference, is where at_rest wants it. */
static int shift_threshold(const stamp *to, const potentials *p, const element *e) {
    double shift = 0;
    int count, both_ways = 0;
    ns_input_gain *term = terms_of_gap(p, &count);
    int status =
        term ? ns_circuit_shift_known(e, p->gap[p->nz], term, count, &shift, &both_ways) : NS_E_MEMORY;
    if (status == NS_OK && both_ways) {
        status = ns_circuit_complain(to->c, NS_E_RANGE,
                                     "%.80s: its control rests at its threshold, %g V, coming from above and "
                                     "from below: one that opens there and closes there is not supported; "
                                     "shift vt by a little, or use one PWL source",
                                     e->name, e->sw.vt);
    }
    shift_command(to, e, shift);
    free(term);
    return status;
}

static int largest_gap(const potentials *p, double *volts) {
    int count;
    ns_input_gain *term = terms_of_gap(p, &count);
    const int status = term ? ns_circuit_largest_sum(p->gap[p->nz], term, count, volts) : NS_E_MEMORY;
    free(term);
    return status;
}

/* g = v_cp - v_cn, or the current of an element. */
static int stamp_state_control(const stamp *to, const element *e) {
    int status = allocate_control(to, &to->s->command[e->command].gx, to->s->n);
    if (status) {
        return status;
    }
    if (e->by[0] >= 0) {
        ns_circuit_stamp_add(to, IN_GX, ns_circuit_current_unknown(to->c, e->by[0]), e->command, e->value);
        return NS_OK;
    }
    ns_circuit_stamp_add(to, IN_GX, ns_circuit_node_unknown(to->c, e->node[2]), e->command, 1);
    ns_circuit_stamp_add(to, IN_GX, ns_circuit_node_unknown(to->c, e->node[3]), e->command, -1);
    return NS_OK;
}

/* How large the control of a choice can be: terms that are not known are as large as the largest source, or
 * 1 A. */
static int size_of_control(potentials *p, const element *e, double *size) {
    int status = p->largest > 0 ? NS_OK : ns_circuit_largest_source(p->c, &p->largest);
    *size = fabs(e->control);
    for (int i = 0; i < e->ncontrol && status == NS_OK; i++) {
        const ns_term *t = &e->terms[i];
        double own = t->is_current ? 1 : p->largest;
        clear_gap(p);
        if (!t->is_current && add_difference(p, 1, node_place(p, t->of), node_place(p, 0)))
            status = largest_gap(p, &own);
        *size += fabs(t->gain) * own;
    }
    return status;
}

/* Of a choice. */
static int stamp_affine_control(const stamp *to, const element *e) {
    const int status = allocate_control(to, &to->s->command[e->command].gx, to->s->n);
    to->s->command[e->command].g0 = e->control;
    for (int i = 0; i < e->ncontrol && status == NS_OK; i++) {
        ns_circuit_stamp_add(to, IN_GX, ns_circuit_term_unknown(to->c, &e->terms[i]), e->command,
                             e->terms[i].gain);
    }
    return status;
}

static int stamp_control_of_choice(const stamp *to, potentials *p, const element *e) {
    double size = 0;
    int status;
    add_gap(p, p->nz, e->control);
    if (add_terms(p, e, e->ncontrol)) {
        status = e->at_rest ? shift_threshold(to, p, e) : NS_OK;
        return status ? status : stamp_time_control(to, p, e->command);
    }
    status = e->at_rest ? size_of_control(p, e, &size) : NS_OK;
    shift_command(to, e, ns_circuit_choice_shift_unknown(p->c, e, size));
    return status ? status : stamp_affine_control(to, e);
}

static int stamp_command(const stamp *to, potentials *p, const element *e) {
    ns_command *command = &to->s->command[e->command];
    command->pair = e->pair;
    command->on = e->sw.vt + e->sw.vh;
    command->off = e->sw.vt - e->sw.vh;
    command->closed = e->closed;
    clear_gap(p);
    if (e->kind == CHOICE) {
        return stamp_control_of_choice(to, p, e);
    }
    if (e->by[0] < 0 && add_difference(p, 1, node_place(p, e->node[2]), node_place(p, e->node[3]))) {
        const int status = e->at_rest ? shift_threshold(to, p, e) : NS_OK;
        return status ? status : stamp_time_control(to, p, e->command);
    }
    shift_command(to, e, ns_circuit_shift_unknown(to->c, e));
    return stamp_state_control(to, e);
}

int ns_circuit_stamp_commands(const stamp *to) {
    const ns_circuit *c = to->c;
    potentials p;
    int status = NS_OK;
    if (c->ncommands == 0) {
        return NS_OK;
    }
    if (!find_potentials(&p, c)) {
        status = NS_E_MEMORY;
    }
    for (int i = 0; i < c->nelements && !status; i++) {
        if (c->element[i].command >= 0) {
            status = stamp_command(to, &p, &c->element[i]);
        }
    }
    free_potentials(&p);
    return status;
}
