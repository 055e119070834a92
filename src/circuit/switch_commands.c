/* src/circuit/switch_commands.c - the commands of switches: of controls that are functions of time alone
 * (potentials.c), and of others.
 */
#include <math.h>
#include <stdlib.h>

#include "potentials.h"

/* Room for the control's entries, unless they go to lists. */
static int allocate_control(const stamp *to, double **room, int count) {
    if (to->entries) {
        return NS_OK;
    }
    *room = calloc((size_t)count, sizeof(double));
    return *room ? NS_OK : NS_E_MEMORY;
}

/* g = the known difference. */
static int stamp_time_control(const stamp *to, const ns_potentials *p, int command) {
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
static ns_input_gain *terms_of_gap(const ns_potentials *p, int *count) {
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
static int shift_threshold(const stamp *to, const ns_potentials *p, const element *e) {
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

static int largest_gap(const ns_potentials *p, double *volts) {
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
static int size_of_control(ns_potentials *p, const element *e, double *size) {
    int status = p->largest > 0 ? NS_OK : ns_circuit_largest_source(p->c, &p->largest);
    *size = fabs(e->control);
    for (int i = 0; i < e->ncontrol && status == NS_OK; i++) {
        const ns_term *t = &e->terms[i];
        double own = t->is_current ? 1 : p->largest;
        ns_circuit_potentials_clear_gap(p);
        if (!t->is_current &&
            ns_circuit_potentials_add_difference(p, 1, ns_circuit_potentials_place(p, t->of),
                                                 ns_circuit_potentials_place(p, 0)))
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

static int stamp_control_of_choice(const stamp *to, ns_potentials *p, const element *e) {
    double size = 0;
    int status;
    ns_circuit_potentials_add_gap(p, p->nz, e->control);
    if (ns_circuit_potentials_add_terms(p, e, e->ncontrol)) {
        status = e->at_rest ? shift_threshold(to, p, e) : NS_OK;
        return status ? status : stamp_time_control(to, p, e->command);
    }
    status = e->at_rest ? size_of_control(p, e, &size) : NS_OK;
    shift_command(to, e, ns_circuit_choice_shift_unknown(p->c, e, size));
    return status ? status : stamp_affine_control(to, e);
}

static int stamp_command(const stamp *to, ns_potentials *p, const element *e) {
    ns_command *command = &to->s->command[e->command];
    command->pair = e->pair;
    command->on = e->sw.vt + e->sw.vh;
    command->off = e->sw.vt - e->sw.vh;
    command->closed = e->closed;
    ns_circuit_potentials_clear_gap(p);
    if (e->kind == CHOICE) {
        return stamp_control_of_choice(to, p, e);
    }
    if (e->by[0] < 0 && ns_circuit_potentials_add_difference(p, 1, ns_circuit_potentials_place(p, e->node[2]),
                                                             ns_circuit_potentials_place(p, e->node[3]))) {
        const int status = e->at_rest ? shift_threshold(to, p, e) : NS_OK;
        return status ? status : stamp_time_control(to, p, e->command);
    }
    shift_command(to, e, ns_circuit_shift_unknown(to->c, e));
    return stamp_state_control(to, e);
}

int ns_circuit_stamp_commands(const stamp *to) {
    const ns_circuit *c = to->c;
    ns_potentials p;
    int status = NS_OK;
    if (c->ncommands == 0) {
        return NS_OK;
    }
    if (!ns_circuit_potentials_find(&p, c)) {
        status = NS_E_MEMORY;
    }
    for (int i = 0; i < c->nelements && !status; i++) {
        if (c->element[i].command >= 0) {
            status = stamp_command(to, &p, &c->element[i]);
        }
    }
    ns_circuit_potentials_free(&p);
    return status;
}
