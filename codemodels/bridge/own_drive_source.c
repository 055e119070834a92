/* bridge/own_drive_source.c - the ranges of V and B sources and of outputs of digital parts. */
#include "own_drive.h"

#include <math.h>
#include <string.h>

#include "expression.h"
#include "foreign.h"
#include "ngspice/inpptree.h"
#include "own_touch.h"

#include "spicelib/devices/asrc/asrcdefs.h"

enum { DEPTH_MAX = 200 };
enum { DAC_LOW, DAC_HIGH };           /* parameters */
enum { WAVE_LOW = 2, WAVE_HIGH = 3 }; /* of square, triangle and sine */

typedef struct range_reader {
    const CKTcircuit *ckt;
    const ASRCinstance *b;
    ns_own_range_at *at;
    int inside;
    int goal;
    int depth;
} range_reader;

/* From this slope on, of a voltage by another, a level goes to the next one in a step: a comparator.  Below
 * it is an amplifier, whose gate may rest between them. */
static const double steep = 1e3;

static const ns_own_range any = {-INFINITY, INFINITY, 0, 0, 1.0, 0, 0};

static ns_own_range range_of(range_reader *r, const INPparseNode *node);

/* Where it is no sum: what is above the goal is as unknown as that. */
static ns_own_range plain_range_of(range_reader *r, const INPparseNode *node) {
    const ns_own_range a = range_of(r, node);
    return a.of_goal ? any : a;
}

/* Of what does not switch. */
static ns_own_range between(double low, double high) {
    return (ns_own_range){low, high, 0, 1, 0.0, 0, 0};
}

static ns_own_range steps(double low, double high) {
    ns_own_range r = between(low, high);
    r.switches = 1;
    return r;
}

static int is_finite(const ns_own_range *a) {
    return isfinite(a->low) && isfinite(a->high);
}

/* Of a and b, cut off or added. */
static ns_own_range joined(double low, double high, const ns_own_range *a, const ns_own_range *b) {
    return (ns_own_range){low, high, a->switches || b->switches, 1, fmax(a->slope, b->slope), 0, 0};
}

static double times(double a, double b) {
    return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

/* As a factor of the other's slope; of what is not known, 1. */
static double size_of(const ns_own_range *a) {
    return is_finite(a) ? fmax(fabs(a->low), fabs(a->high)) : 1.0;
}

static ns_own_range product(const ns_own_range *a, const ns_own_range *b) {
    const double p = times(a->low, b->low), q = times(a->low, b->high), s = times(a->high, b->low),
                 t = times(a->high, b->high);
    ns_own_range r = joined(fmin(fmin(p, q), fmin(s, t)), fmax(fmax(p, q), fmax(s, t)), a, b);
    r.slope = a->slope * size_of(b) + b->slope * size_of(a);
    return r;
}

/* --- one signal in both operands: its range is not that of two signals --- */

/* Signals of an expression, as bits; also those that are only compared. */
static unsigned long long signals_of(const INPparseNode *node, int compared, int depth) {
    if (!node || node->type == PT_CONSTANT)
        return 0;
    if (depth > DEPTH_MAX || (node->type == PT_VAR && node->valueIndex >= 64))
        return ~0ULL;
    if (node->type == PT_VAR)
        return 1ULL << node->valueIndex;
    if (node->type == PT_FUNCTION && ns_bridge_expression_is_step(node) && !compared)
        return 0;
    if (node->type == PT_TERN)
        return (compared ? signals_of(node->left, 1, depth + 1) : 0) |
               signals_of(node->right->left, compared, depth + 1) |
               signals_of(node->right->right, compared, depth + 1);
    return signals_of(node->left, compared, depth + 1) | signals_of(node->right, compared, depth + 1);
}

static int share_a_signal(const INPparseNode *a, const INPparseNode *b, int compared) {
    return (signals_of(a, compared, 0) & signals_of(b, compared, 0)) != 0;
}

/* v(a,b), of two nodes that are not known one by one: 0: it is not that, or not known either. */
static int read_difference(const range_reader *r, const INPparseNode *node, ns_own_range *found) {
    const INPparseNode *ends[2] = {node->left, node->right};
    int eq[2];
    for (int k = 0; k < 2; k++) {
        if (node->type != PT_MINUS || !ends[k] || ends[k]->type != PT_VAR ||
            r->b->ASRCtree->varTypes[ends[k]->valueIndex] != IF_NODE)
            return 0;
        eq[k] = r->b->ASRCvars[ends[k]->valueIndex];
    }
    return eq[1] != 0 && r->at(r->ckt, r->inside + 1, eq[0], eq[1], found);
}

static ns_own_range operation(range_reader *r, const INPparseNode *node) {
    const int adds = node->type == PT_PLUS || node->type == PT_MINUS;
    const ns_own_range a = adds ? range_of(r, node->left) : plain_range_of(r, node->left),
                       b = adds ? range_of(r, node->right) : plain_range_of(r, node->right);
    const ns_own_range inverse = {fmin(1.0 / b.low, 1.0 / b.high),
                                  fmax(1.0 / b.low, 1.0 / b.high),
                                  b.switches,
                                  1,
                                  b.slope / (b.low * b.low),
                                  0,
                                  0};
    ns_own_range found = any;
    if ((!is_finite(&a) || !is_finite(&b)) && read_difference(r, node, &found))
        return found;
    switch (node->type) {
    case PT_PLUS:
        found = joined(a.low + b.low, a.high + b.high, &a, &b);
        break;
    case PT_MINUS:
        found = joined(a.low - b.high, a.high - b.low, &a, &b);
        break;
    case PT_TIMES:
        found = product(&a, &b);
        break;
    case PT_DIVIDE:
        if (b.low > 0.0 || (b.low == b.high && b.low != 0.0))
            found = product(&a, &inverse);
        break;
    default:
        break;
    }
    found.slope = adds ? a.slope + b.slope : found.slope;
    found.of_goal = node->type == PT_MINUS ? a.of_goal - b.of_goal : a.of_goal + b.of_goal;
    if (a.low != a.high && b.low != b.high && share_a_signal(node->left, node->right, adds)) {
        found.low = -INFINITY;
        found.high = INFINITY;
    }
    return found;
}

/* Of pwl(), whose first and last pieces go on for ever, as ngspice has them. */
static ns_own_range line(const INPparseNode *node, const ns_own_range *a) {
    const struct {
        int n;
        double *vals;
    } *points = node->data;
    const double *v = points->vals;
    ns_own_range r = between(INFINITY, -INFINITY);
    double most = 0.0;
    for (int k = 0; k + 3 < points->n; k += 2) {
        const double slope = (v[k + 3] - v[k + 1]) / (v[k + 2] - v[k]);
        const double from = k == 0 ? a->low : fmax(a->low, v[k]);
        const double to = k + 5 >= points->n ? a->high : fmin(a->high, v[k + 2]);
        if (!(from <= to))
            continue;
        ns_bridge_own_extend(&r, v[k + 1] + times(slope, from - v[k]));
        ns_bridge_own_extend(&r, v[k + 1] + times(slope, to - v[k]));
        most = fmax(most, fabs(slope));
    }
    r.slope = times(most, a->slope);
    r.switches = a->switches;
    return r;
}

static ns_own_range smaller(const ns_own_range *a, const ns_own_range *b) {
    return joined(fmin(a->low, b->low), fmin(a->high, b->high), a, b);
}

static ns_own_range larger(const ns_own_range *a, const ns_own_range *b) {
    return joined(fmax(a->low, b->low), fmax(a->high, b->high), a, b);
}

static ns_own_range negative(const ns_own_range *a) {
    return (ns_own_range){-a->high, -a->low, a->switches, 1, a->slope, 0, 0};
}

/* Of a curve that rises, and is no steeper than its argument. */
static ns_own_range bent(double (*f)(double), const ns_own_range *a) {
    return (ns_own_range){f(a->low), f(a->high), a->switches, 1, a->slope, 0, 0};
}

static ns_own_range function(range_reader *r, const INPparseNode *node) {
    if (node->funcnum == PTF_MIN || node->funcnum == PTF_MAX) {
        const ns_own_range a = plain_range_of(r, node->left->left), b = plain_range_of(r, node->left->right);
        if (share_a_signal(node->left->left, node->left->right, 0))
            return any;
        return node->funcnum == PTF_MIN ? smaller(&a, &b) : larger(&a, &b);
    }
    if (node->funcnum == PTF_POW || node->funcnum == PTF_PWR)
        return any;
    if (ns_bridge_expression_is_step(node))
        return node->funcnum == PTF_SGN ? steps(-1.0, 1.0) : steps(0.0, 1.0);
    const ns_own_range a = plain_range_of(r, node->left), minus = negative(&a), none = between(0.0, 0.0),
                       one = between(1.0, 1.0), above = larger(&a, &none);
    switch (node->funcnum) {
    case PTF_UMINUS:
        return minus;
    case PTF_URAMP:
        return above;
    case PTF_ABS:
        return larger(&a, &minus);
    case PTF_PWL:
        return line(node, &a);
    case PTF_USTEP2:
        return smaller(&above, &one);
    case PTF_TANH:
        return bent(tanh, &a);
    case PTF_ATAN:
        return bent(atan, &a);
    case PTF_EXP: /* in 1/(1 + exp(u)), which is no steeper than its u */
        return bent(exp, &a);
    case PTF_SIN:
    case PTF_COS:
        return (ns_own_range){-1.0, 1.0, 0, 1, a.slope, 0, 0};
    default:
        return any;
    }
}

/* The voltage of a node: above the goal, if it is that or stands on it, else above ground. */
static ns_own_range variable(const range_reader *r, int index) {
    const int eq = r->b->ASRCvars[index];
    ns_own_range a;
    if (r->b->ASRCtree->varTypes[index] != IF_NODE)
        return any;
    if (r->goal > 0 && eq == r->goal)
        return (ns_own_range){0.0, 0.0, 0, 1, 0.0, 0, 1};
    if (r->at(r->ckt, r->inside + 1, eq, 0, &a))
        return a;
    if (!(r->goal > 0 && r->at(r->ckt, r->inside + 1, eq, r->goal, &a)))
        return any;
    a.of_goal = 1;
    return a;
}

/* 1 if it is the voltage of the source itself, or what one R gives of that: a latch that keeps its value. */
static int is_itself(const range_reader *r, const INPparseNode *node) {
    if (node->type != PT_VAR || r->b->ASRCtree->varTypes[node->valueIndex] != IF_NODE)
        return 0;
    const int eq = r->b->ASRCvars[node->valueIndex], own = r->b->ASRCposNode;
    return eq == own || ns_bridge_own_joined_by_r(r->ckt, eq, own);
}

/* One of two. */
static ns_own_range choice(range_reader *r, const INPparseNode *node) {
    const INPparseNode *first = node->right->left, *second = node->right->right;
    const ns_own_range a = range_of(r, is_itself(r, first) ? second : first),
                       b = range_of(r, is_itself(r, second) ? first : second);
    ns_own_range found = joined(fmin(a.low, b.low), fmax(a.high, b.high), &a, &b);
    found.switches = 1;
    found.of_goal = a.of_goal;
    return a.of_goal == b.of_goal ? found : any;
}

static ns_own_range range_of(range_reader *r, const INPparseNode *node) {
    ns_own_range found = any;
    if (!node || r->depth >= DEPTH_MAX)
        return any;
    r->depth++;
    if (node->type == PT_CONSTANT)
        found = between(node->constant, node->constant);
    else if (node->type == PT_VAR)
        found = variable(r, node->valueIndex);
    else if (node->type == PT_FUNCTION)
        found = function(r, node);
    else if (node->type == PT_TERN)
        found = choice(r, node);
    else if (node->type == PT_TIME)
        found = steps(0.0, r->ckt->CKTfinalTime);
    else if (node->type != PT_TEMPERATURE && node->type != PT_FREQUENCY)
        found = operation(r, node);
    r->depth--;
    return isnan(found.low) || isnan(found.high) ? any : found;
}

static void judge_slope(ns_own_range *r) {
    r->amplifies = r->slope > 0.0 && r->slope < steep;
    r->switches |= r->slope >= steep;
}

int ns_bridge_own_range_of_b(const CKTcircuit *ckt, const GENinstance *inst, ns_own_range_at *at, int inside,
                             int goal, ns_own_range *r) {
    const ASRCinstance *b = (const ASRCinstance *)inst;
    range_reader reads = {.ckt = ckt, .b = b, .at = at, .inside = inside, .goal = goal};
    *r = range_of(&reads, ((const INPparseTree *)b->ASRCtree)->tree);
    judge_slope(r);
    return is_finite(r) && (r->of_goal == 0 || r->of_goal == 1);
}

/* 1 if it is an instance of that code model of another library. */
static int is_of(const GENinstance *inst, const char *name) {
    const char *model = ns_bridge_models_kind(inst) == KIND_FOREIGN
                            ? ns_bridge_foreign_model((const MIFinstance *)inst)
                            : NULL;
    return model && strcmp(model, name) == 0;
}

int ns_bridge_own_range_of_bridge(const GENinstance *inst, int here, int *p, int *n, ns_own_range *r) {
    const MIFinstance *mif = (const MIFinstance *)inst;
    const int is_sine = is_of(inst, "sine"),
              is_wave = is_sine || is_of(inst, "square") || is_of(inst, "triangle");
    if (!is_wave && !is_of(inst, "dac_bridge"))
        return 0;
    const double low = ns_bridge_models_real(mif, is_wave ? WAVE_LOW : DAC_LOW),
                 high = ns_bridge_models_real(mif, is_wave ? WAVE_HIGH : DAC_HIGH);
    *r = is_sine ? between(fmin(low, high), fmax(low, high)) : steps(fmin(low, high), fmax(low, high));
    for (int k = 0; k < mif->conn[1]->size; k++) {
        const Mif_Port_Data_t *out = mif->conn[1]->port[k];
        *p = out->smp_data.pos_node;
        *n = out->type == MIF_DIFF_VOLTAGE ? out->smp_data.neg_node : 0;
        if ((out->type == MIF_VOLTAGE || out->type == MIF_DIFF_VOLTAGE) && (*p == here || *n == here))
            return 1;
    }
    return 0;
}

int ns_bridge_own_range_of_table(const GENinstance *inst, int here, int *p, int *in, ns_own_range *r) {
    enum { X, Y, DOMAIN, FRACTION, LIMIT };
    const MIFinstance *mif = (const MIFinstance *)inst;
    if (!is_of(inst, "pwl") || mif->param[LIMIT]->element[0].bvalue != MIF_TRUE)
        return 0;
    const Mif_Port_Data_t *from = mif->conn[0]->port[0], *to = mif->conn[1]->port[0];
    const Mif_Value_t *x = mif->param[X]->element, *y = mif->param[Y]->element;
    if (from->type != MIF_VOLTAGE || to->type != MIF_VOLTAGE || to->smp_data.pos_node != here)
        return 0;
    *p = here;
    *in = from->smp_data.pos_node;
    *r = between(INFINITY, -INFINITY);
    for (int k = 0; k < mif->param[Y]->size && k < mif->param[X]->size; k++) {
        ns_bridge_own_extend(r, y[k].rvalue);
        if (k > 0)
            r->slope =
                fmax(r->slope, fabs((y[k].rvalue - y[k - 1].rvalue) / (x[k].rvalue - x[k - 1].rvalue)));
    }
    return is_finite(r);
}

void ns_bridge_own_follow(ns_own_range *r, const ns_own_range *in) {
    r->slope = times(r->slope, in->slope);
    r->switches = in->switches;
    judge_slope(r);
}

void ns_bridge_own_extend(ns_own_range *r, double value) {
    r->low = fmin(r->low, value);
    r->high = fmax(r->high, value);
}

ns_own_range ns_bridge_own_range_of_wave(double dc, int function, int order, const double *c) {
    ns_own_range r = between(dc, dc);
    if (!c || order < 2)
        return r;
    switch (function) {
    case PULSE:
    case EXP:
        return (ns_own_range){fmin(c[0], c[1]), fmax(c[0], c[1]), function == PULSE, 1, 0.0, 0, 0};
    case SINE:
        return between(c[0] - fabs(c[1]), c[0] + fabs(c[1]));
    case PWL:
        r = steps(c[1], c[1]);
        for (int k = 3; k < order; k += 2)
            ns_bridge_own_extend(&r, c[k]);
        return r;
    default:
        return r;
    }
}
