/* bridge/digital_control.c - the control of d_osc and d_pwm between ngspice's points. */
#include "digital_control.h"

#include <math.h>
#include <string.h>

#include "foreign.h"
#include "ngspice/mifparse.h"
#include "pure/control_law.h"
#include "pure/timepoints.h"
#include "report.h"

enum { RISE = 1, FALL = 2 }; /* tags of the model's states: when it rises, or falls, s */

static const double no_matter = 1e-4; /* of a period: what an edge may be off by */

typedef struct control_point {
    double t, v;  /* s, V or A */
    double given; /* the control that the model was called with */
} control_point;

struct ns_digital_control {
    ns_digital_control *next; /* of all that are there */
    const MIFinstance *inst;
    const Mif_Port_Data_t *port;
    int p, n;      /* equations whose difference it is; 0: none */
    int is_summed; /* of d_osc; else of d_pwm, which compares it at its edge */
    ns_control_law law;
    double frequency;      /* Hz, of d_pwm */
    const CKTcircuit *ckt; /* NULL: not begun, or the model is called as it is */
    control_point now;     /* ngspice's present point */
    control_point at;      /* the last one that it accepted; there: */
    double slope;          /* of the control on the way there */
    double owed;           /* periods that the model has fallen behind by, so far */
    double edge;           /* the next one, s; INFINITY: none */
    int rises;             /* it rises */
    double last;           /* the last one, s */
    int rose;              /* it did; -1: there was none */
    double length[2];      /* s: of the last two times between edges, the older one first */
    int moves;             /* the control is not that of the beginning */
    int doubtful;          /* where it goes from here is not known well enough for the next edge */
    int noted;             /* that an edge was off was written */
};

static ns_digital_control *all;

/* --- calls --- */

static const char *const models[] = {"d_pwm", "d_osc"}; /* by is_summed */
static void (*original[2])(Mif_Private_t *);

/* The next edge was there, or is, at t. */
static int has_come(const ns_digital_control *c, double t) {
    return t >= c->edge || (isfinite(c->edge) && ns_bridge_timepoints_same(t, c->edge));
}

/* When the edge after t will come, s, as far as it is known. */
static double expected_edge(const ns_digital_control *c, double t) {
    return has_come(c, t) || isinf(c->edge) ? t + c->length[0] : c->edge;
}

/* The slope of the control from now on: none behind a corner, which is told from a bend by the slope before.
 */
static double slope_ahead(const ns_digital_control *c, double slope) {
    if (slope * c->slope <= 0.0)
        return 0.0;
    return fabs(slope) < fabs(c->slope) ? slope : c->slope;
}

/* The slope on the way to the present point; of too short a way it is rounding, or that of a jump. */
static double slope_now(const ns_digital_control *c) {
    static const double too_short = 1e-3;
    const double dt = c->now.t - c->at.t, length = c->length[0] > 0.0 ? c->length[0] : c->edge - c->last;
    return dt > too_short * length ? (c->now.v - c->at.v) / dt : c->slope;
}

/* How far the control goes on with that slope, s: less than until the next edge, if the slope changes. */
static double straight_way(const ns_digital_control *c, double slope, double way) {
    const double change = fabs(slope - c->slope), dt = c->now.t - c->at.t;
    return change * way > fabs(slope) * dt ? fabs(slope) * dt / change : way;
}

/* What the model is to be called with at the present point: from the last one until the next edge d_osc then
 * goes through as many periods as it should, and d_pwm compares with the control at that edge. */
static double choose_control(const ns_digital_control *c) {
    const double dt = c->now.t - c->at.t, v = c->now.v, slope = slope_now(c);
    const double way = expected_edge(c, c->now.t) - c->now.t, straight = straight_way(c, slope, way);
    const double then = v + slope_ahead(c, slope) * straight;
    if (!c->is_summed)
        return then;
    const double periods = c->owed + ns_bridge_control_law_integral(&c->law, c->at.v, v, dt) +
                           ns_bridge_control_law_integral(&c->law, v, then, straight) +
                           ns_bridge_control_law_value(&c->law, then) * (way - straight);
    return ns_bridge_control_law_control(&c->law, periods / (dt + way), v);
}

/* ngspice calls the model twice a point, first with the values of the one before.  At an edge this first call
 * tells d_osc that it is over: its phase is to be beyond. */
static double first_control(const ns_digital_control *c, double t) {
    static const double beyond = 1e-6;
    const double y = ns_bridge_control_law_value(&c->law, c->at.given);
    return c->is_summed && has_come(c, t)
               ? ns_bridge_control_law_control(&c->law, (1.0 + beyond) * y, c->at.given)
               : c->at.given;
}

/* An edge that has not come must stay ahead: the model would leave it out.  What is chosen, but no more than
 * brings the edge to where ngspice can step to. */
static double keep_edge(const ns_digital_control *c, double chosen) {
    const double soon = c->now.t + ns_bridge_timepoints_closest(c->ckt->CKTfinalTime);
    const double given = ns_bridge_control_law_value(&c->law, c->at.given);
    if (has_come(c, c->now.t) || isinf(c->edge) || (!c->is_summed && !c->rises))
        return chosen;
    const double most = c->is_summed ? given * (c->edge - c->at.t) / (soon - c->at.t)
                                     : given + (c->edge - soon) * c->frequency;
    return ns_bridge_control_law_value(&c->law, chosen) > most
               ? ns_bridge_control_law_control(&c->law, most, chosen)
               : chosen;
}

static double control_now(ns_digital_control *c, double t) {
    const double *x = c->ckt->CKTrhsOld;
    if (c->ckt->CKTmode & (MODEINITPRED | MODEINITTRAN))
        return first_control(c, t);
    c->now.t = t;
    c->now.v = (c->p > 0 ? x[c->p] : 0.0) - (c->n > 0 ? x[c->n] : 0.0);
    c->now.given = t > c->at.t ? keep_edge(c, choose_control(c)) : c->at.given;
    return c->now.given;
}

static void call(int is_summed, Mif_Private_t *data) {
    ns_digital_control *c = all;
    Mif_Port_Data_t *port = data->conn[0]->port[0];
    while (c && (c->port != port || !c->ckt))
        c = c->next;
    if (c && data->circuit.call_type == MIF_ANALOG && data->circuit.anal_type == MIF_TRAN &&
        data->circuit.time > 0.0)
        port->input.rvalue = control_now(c, data->circuit.time);
    original[is_summed](data);
}

static void call_pwm(Mif_Private_t *data) {
    call(0, data);
}

static void call_osc(Mif_Private_t *data) {
    call(1, data);
}

/* --- making --- */

static const Mif_Param_Data_t *find_parameter(const MIFinstance *inst, const IFdevice *type,
                                              const char *name) {
    for (int i = 0; i < inst->num_param; i++)
        if (strcmp(type->param[i].name, name) == 0)
            return inst->param[i];
    return NULL;
}

static int read_law(const MIFinstance *inst, const IFdevice *type, int is_summed, ns_control_law *law) {
    const Mif_Param_Data_t *x = find_parameter(inst, type, "cntl_array");
    const Mif_Param_Data_t *y = find_parameter(inst, type, is_summed ? "freq_array" : "dc_array");
    if (!x || !y || x->size != y->size || x->size < 2)
        return NS_OK; /* the model says so itself, or is another one */
    law->x = malloc(2 * (size_t)x->size * sizeof *law->x);
    if (!law->x)
        return NS_E_MEMORY;
    law->n = x->size;
    law->y = law->x + law->n;
    for (int k = 0; k < law->n; k++) {
        law->x[k] = x->element[k].rvalue;
        law->y[k] = y->element[k].rvalue;
    }
    return NS_OK;
}

int ns_bridge_digital_control_make(ns_digital_input *in, const char *model) {
    static void (*const ours[])(Mif_Private_t *) = {call_pwm, call_osc};
    const int is_summed = strcmp(model, models[1]) == 0;
    IFdevice *type = ns_bridge_foreign_type(in->inst);
    ns_control_law law = {0};
    if ((!is_summed && strcmp(model, models[0]) != 0) || !type || in->port != in->inst->conn[0]->port[0])
        return NS_OK;
    const int status = read_law(in->inst, type, is_summed, &law);
    ns_digital_control *c = law.n > 0 ? calloc(1, sizeof *c) : NULL;
    if (!c) {
        free(law.x);
        return status || law.n == 0 ? status : NS_E_MEMORY;
    }
    *c = (ns_digital_control){.next = all,
                              .inst = in->inst,
                              .port = in->port,
                              .p = in->p,
                              .n = in->n,
                              .is_summed = is_summed,
                              .law = law};
    const Mif_Param_Data_t *frequency = find_parameter(in->inst, type, "frequency");
    c->frequency = frequency && frequency->size > 0 ? frequency->element[0].rvalue : 0.0;
    all = in->control = c;
    if (type->cm_func != ours[is_summed])
        original[is_summed] = type->cm_func;
    type->cm_func = ours[is_summed];
    return NS_OK;
}

void ns_bridge_digital_control_free(ns_digital_control *c) {
    ns_digital_control **link = &all;
    if (!c)
        return;
    while (*link != c)
        link = &(*link)->next;
    *link = c->next;
    free(c->law.x);
    free(c);
}

/* 1 if the model has such a state: as it was before ngspice 41 (d_pwm: 42).  Later ones decide on an edge
 * some time before it, and count on from that. */
static int has_state(const ns_digital_control *c, int tag) {
    for (int k = 0; k < c->inst->num_state; k++)
        if (c->inst->state[k].tag == tag && c->inst->state[k].bytes == (int)sizeof(double))
            return 1;
    return 0;
}

void ns_bridge_digital_control_begin(ns_digital_control *c, const CKTcircuit *ckt, double t, double v) {
    c->ckt = has_state(c, RISE) && has_state(c, FALL) ? ckt : NULL;
    c->now = c->at = (control_point){t, v, v};
    c->slope = c->owed = 0.0;
    c->edge = INFINITY;
    c->last = t;
    c->rose = -1;
    c->length[0] = c->length[1] = 0.0;
    c->moves = c->doubtful = 0;
}

/* --- accepts --- */

/* A state of the model: when it rises, or falls, s. */
static double state_of(const ns_digital_control *c, int tag) {
    for (int k = 0; k < c->inst->num_state; k++)
        if (c->inst->state[k].tag == tag)
            return c->ckt->CKTstate0[c->inst->state[k].index];
    return INFINITY;
}

static void read_edge(ns_digital_control *c, double t) {
    const double rise = state_of(c, RISE), fall = state_of(c, FALL);
    c->edge = fmin(rise > t ? rise : INFINITY, fall > t ? fall : INFINITY);
    c->rises = c->edge == rise;
}

/* By how much of a period the edge that has come is early. */
static double error_of_edge(const ns_digital_control *c) {
    const double dt = c->now.t - c->at.t;
    if (c->is_summed)
        return ns_bridge_control_law_value(&c->law, c->at.given) * dt - c->owed -
               ns_bridge_control_law_integral(&c->law, c->at.v, c->now.v, dt);
    if (!c->rises) /* the end of a period */
        return 0.0;
    const double most = dt * c->frequency; /* a control that jumps at the edge makes it */
    const double off =
        ns_bridge_control_law_value(&c->law, c->at.given) - ns_bridge_control_law_value(&c->law, c->now.v);
    return fmax(off, -most);
}

static void note_error(ns_digital_control *c) {
    static const double too_much = 1e-3;
    const double off = error_of_edge(c);
    if (c->noted || !(fabs(off) > too_much))
        return;
    c->noted = 1;
    ns_bridge_report_note("at t = %g s: an edge of %s (%s) is %.2g of a period too %s, as its control bends "
                          "between two timepoints: a tmax of %.2g s brings it nearer",
                          c->now.t, c->inst->gen.GENname, models[c->is_summed], fabs(off),
                          off > 0.0 ? "early" : "late", 0.1 * (c->now.t - c->last));
}

/* Edges rise and fall in turn; where the phase is a rounding behind, d_osc asks for the same one again. */
static void pass_edge(ns_digital_control *c) {
    if (c->rises == c->rose)
        return;
    note_error(c);
    c->length[0] = c->length[1];
    c->length[1] = c->now.t - c->last;
    c->last = c->now.t;
    c->rose = c->rises;
}

/* By how much of a period the next edge moves if the slope of the control goes on changing as it did. */
static double doubt(const ns_digital_control *c, double slope, double before) {
    const double way = expected_edge(c, c->now.t) - c->now.t;
    const double off = fabs(ns_bridge_control_law_slope(&c->law, c->now.v) * (slope - before)) * way;
    return c->is_summed ? 0.5 * way * off : off;
}

void ns_bridge_digital_control_accept(ns_digital_control *c, double t) {
    const double dt = c->now.t - c->at.t;
    if (!c->ckt || c->now.t != t || !(dt > 0.0))
        return;
    const double slope = slope_now(c), before = c->slope;
    if (has_come(c, t))
        pass_edge(c);
    c->owed += ns_bridge_control_law_integral(&c->law, c->at.v, c->now.v, dt) -
               ns_bridge_control_law_value(&c->law, c->now.given) * dt;
    c->moves |= c->now.v != c->at.v;
    c->slope = slope;
    c->at = c->now;
    read_edge(c, t);
    c->doubtful = doubt(c, slope, before) > no_matter;
}

double ns_bridge_digital_control_edge(const ns_digital_control *c, double queued) {
    return c->ckt ? c->edge : queued;
}

double ns_bridge_digital_control_last(const ns_digital_control *c, const char **name, const char **model) {
    *name = c->inst->gen.GENname;
    *model = models[c->is_summed];
    return c->last;
}

double ns_bridge_digital_control_until(const ns_digital_control *c, double t, int at_corner) {
    static const double early = 0.125, late = 1e-3; /* of the time between two edges */
    const double way = c->edge - t, length = c->edge - c->last;
    const int is_early = t - c->last < early * length;
    const int asks = c->doubtful || (is_early ? c->moves : at_corner);
    return asks && isfinite(way) && way > late * length ? t + 0.5 * way : INFINITY;
}

int ns_bridge_digital_control_rests(const ns_digital_control *c) {
    return c->ckt && !c->moves;
}
