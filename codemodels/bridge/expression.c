/* bridge/expression.c - the parse tree of a B source read as a piecewise linear expression. */
#include "expression_reader.h"

#include <math.h>
#include <string.h>

#include "ngspice/inpptree.h"

enum { DEPTH_MAX = 1000 };

static const double two_pi = 6.283185307179586476925286766559;

static ns_piecewise_value *read_node(expression_reader *r, const INPparseNode *node);

/* --- leaves --- */

static ns_piecewise_value *constant(expression_reader *r, double value) {
    return ns_bridge_piecewise_constant(&r->p, value);
}

static ns_piecewise_value *read_variable(expression_reader *r, int index) {
    const int eq = r->b->ASRCvars[index];
    const int is_current = r->b->ASRCtree->varTypes[index] == IF_INSTANCE;
    double volts = 0.0;
    if (!is_current && (eq == 0 || ns_bridge_expression_supply(r->w, eq, &volts)))
        return constant(r, volts);
    return ns_bridge_piecewise_term(&r->p,
                                    (ns_term){is_current, is_current ? r->w->ex->element[eq] : eq, 1.0});
}

static ns_piecewise_value *read_source(expression_reader *r, int status, int node) {
    if (status == NS_OK)
        return ns_bridge_piecewise_term(&r->p, (ns_term){0, node, 1.0});
    r->p.status = r->p.status ? r->p.status : status;
    return NULL;
}

static ns_piecewise_value *read_time(expression_reader *r) {
    int node = 0;
    const int status = ns_bridge_expression_time(r->w, &node);
    r->p.time_node = node;
    return read_source(r, status, node);
}

static ns_piecewise_value *refuse(expression_reader *r, const char *why, const char *instead) {
    if (r->p.status == NS_OK) {
        r->p.status = NS_E_RANGE;
        r->p.why = why;
        r->p.instead = instead;
    }
    return NULL;
}

/* --- functions --- */

/* a = slope time + constant, and nothing else. */
static int is_of_time(const expression_reader *r, const ns_piecewise_value *a, double *slope,
                      double *offset) {
    ns_affine u;
    if (ns_bridge_piecewise_is_discrete(a) || !ns_bridge_piecewise_affine((ns_piecewise *)&r->p, a, &u))
        return 0;
    *offset = u.constant;
    *slope = u.nterms == 1 ? u.terms[0].gain : 0.0;
    return u.nterms == 1 && u.terms[0].is_current == 0 && r->p.time_node > 0 &&
           u.terms[0].of == r->p.time_node;
}

/* sin(slope time + offset), or its cosine. */
static ns_piecewise_value *read_sine(expression_reader *r, const INPparseNode *node,
                                     const ns_piecewise_value *a) {
    double slope, offset;
    int at;
    if (ns_bridge_piecewise_is_discrete(a))
        return ns_bridge_piecewise_map(&r->p, PTunary(node->function), a);
    if (!is_of_time(r, a, &slope, &offset))
        return refuse(r, "a sine of a signal", "sines of k*time+phi are known, with numbers k and phi");
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.va = slope < 0.0 && node->funcnum == PTF_SIN ? -1.0 : 1.0; /* sin(-x) = -sin x, cos(-x) = cos x */
    s.u.sin.freq = fabs(slope) / two_pi;
    s.u.sin.phase =
        360.0 * (slope < 0.0 ? -offset : offset) / two_pi + (node->funcnum == PTF_COS ? 90.0 : 0.0);
    const int status = ns_bridge_expression_wave(r->w, "sine", &s, &at);
    return read_source(r, status, at);
}

/* 1 if a step at t = 0 is one just after it: floor and ceil are there what u is, nint what is even. */
static int steps_after_start(const INPparseNode *node, double slope, double offset) {
    const int is_odd = fmod(offset, 2.0) != 0.0;
    return offset == floor(offset) && (node->funcnum == PTF_NINT ? (slope > 0.0) == is_odd : slope < 0.0);
}

/* floor(u) = u - frac(u), ceil(u) = u + frac(-u), nint(u) = floor(u + 1/2), u = slope time + offset: frac is
 * a sawtooth. */
static ns_piecewise_value *read_floor(expression_reader *r, const INPparseNode *node,
                                      const ns_piecewise_value *a) {
    double slope, offset;
    int at;
    if (!is_of_time(r, a, &slope, &offset))
        return refuse(r, "steps of a signal", "those of k*time+c are known, with numbers k and c");
    const double up = node->funcnum == PTF_CEIL ? -1.0 : 1.0;
    offset += node->funcnum == PTF_NINT ? 0.5 : 0.0;
    const int status = ns_bridge_expression_sawtooth(r->w, up * slope, up * offset,
                                                     steps_after_start(node, up * slope, up * offset), &at);
    const ns_piecewise_value *u =
        node->funcnum == PTF_NINT ? ns_bridge_piecewise_sum(&r->p, 1.0, a, 0.5, constant(r, 1.0)) : a;
    return ns_bridge_piecewise_sum(&r->p, 1.0, u, -up, read_source(r, status, at));
}

static ns_piecewise_value *difference(expression_reader *r, const ns_piecewise_value *a,
                                      const ns_piecewise_value *b) {
    return ns_bridge_piecewise_sum(&r->p, 1.0, a, -1.0, b);
}

static ns_piecewise_value *negative(expression_reader *r, const ns_piecewise_value *a) {
    return ns_bridge_piecewise_sum(&r->p, -1.0, a, 0.0, a);
}

static ns_piecewise_value *absolute(expression_reader *r, const ns_piecewise_value *a) {
    return ns_bridge_piecewise_sum(&r->p, 2.0, ns_bridge_piecewise_positive(&r->p, a), -1.0, a);
}

/* 1 where a < 0. */
static ns_piecewise_value *below(expression_reader *r, const ns_piecewise_value *a) {
    return ns_bridge_piecewise_above(&r->p, negative(r, a));
}

static ns_piecewise_value *one_minus(expression_reader *r, const ns_piecewise_value *a) {
    return difference(r, constant(r, 1.0), a);
}

/* The broken line of pwl(): of the time a source, exact however steep it is. */
static ns_piecewise_value *read_line(expression_reader *r, const INPparseNode *node,
                                     const ns_piecewise_value *a) {
    const struct pwldata {
        int n;
        double *vals;
    } *line = node->data;
    double slope, offset;
    int at, ascending = line->n >= 4;
    for (int k = 2; k + 1 < line->n; k += 2)
        ascending &= line->vals[k] > line->vals[k - 2];
    if (!ascending)
        return refuse(r, "the x of pwl() do not ascend", "give at least two points, by ascending x");
    if (is_of_time(r, a, &slope, &offset)) {
        const int status = ns_bridge_expression_line(r->w, slope, offset, line->n / 2, line->vals, &at);
        return read_source(r, status, at);
    }
    return ns_bridge_piecewise_line(&r->p, a, line->n / 2, line->vals, 0);
}

/* Functions with corners or jumps. */
static ns_piecewise_value *read_cornered(expression_reader *r, const INPparseNode *node,
                                         const ns_piecewise_value *a) {
    ns_piecewise *p = &r->p;
    switch (node->funcnum) {
    case PTF_UMINUS:
        return negative(r, a);
    case PTF_ABS:
        return absolute(r, a);
    case PTF_URAMP:
        return ns_bridge_piecewise_positive(p, a);
    case PTF_USTEP2: /* between 0 and 1 */
        return difference(r, ns_bridge_piecewise_positive(p, a),
                          ns_bridge_piecewise_positive(p, difference(r, a, constant(r, 1.0))));
    case PTF_SGN:
        return difference(r, ns_bridge_piecewise_above(p, a), below(r, a));
    case PTF_USTEP:
    case PTF_GT0:
        return ns_bridge_piecewise_above(p, a);
    case PTF_LT0:
        return below(r, a);
    case PTF_GE0:
        return one_minus(r, below(r, a));
    case PTF_LE0:
        return one_minus(r, ns_bridge_piecewise_above(p, a));
    case PTF_NE0:
        return ns_bridge_piecewise_sum(p, 1.0, ns_bridge_piecewise_above(p, a), 1.0, below(r, a));
    case PTF_EQ0:
        return one_minus(r,
                         ns_bridge_piecewise_sum(p, 1.0, ns_bridge_piecewise_above(p, a), 1.0, below(r, a)));
    default:
        return NULL;
    }
}

static int is_binary(const INPparseNode *node) {
    return node->funcnum == PTF_POW || node->funcnum == PTF_PWR || node->funcnum == PTF_MIN ||
           node->funcnum == PTF_MAX;
}

/* a to the power of 1: ngspice's powers are of |a|, or keep its sign, by their names and by ngbehavior. */
static ns_piecewise_value *read_power(expression_reader *r, const INPparseNode *node,
                                      const ns_piecewise_value *a, const ns_piecewise_value *b) {
    double n;
    if (!ns_bridge_piecewise_is_constant(b, &n) || n != 1.0)
        return refuse(r, "a power of a signal", "use pwl(x, x1, y1, x2, y2, ...)");
    return PTbinary(node->function)(-1.0, 1.0) < 0.0 ? (ns_piecewise_value *)a : absolute(r, a);
}

/* max(a,b) = b + max(a-b, 0), min(a,b) = a - max(a-b, 0); powers of what is discrete, and first powers. */
static ns_piecewise_value *read_binary(expression_reader *r, const INPparseNode *node,
                                       const ns_piecewise_value *a, const ns_piecewise_value *b) {
    if (!a || !b)
        return NULL;
    if (ns_bridge_piecewise_is_discrete(a) && ns_bridge_piecewise_is_discrete(b))
        return ns_bridge_piecewise_map2(&r->p, PTbinary(node->function), a, b);
    if (node->type == PT_POWER || node->funcnum == PTF_POW || node->funcnum == PTF_PWR)
        return read_power(r, node, a, b);
    ns_piecewise_value *more = ns_bridge_piecewise_positive(&r->p, difference(r, a, b));
    return node->funcnum == PTF_MAX ? ns_bridge_piecewise_sum(&r->p, 1.0, b, 1.0, more)
                                    : difference(r, a, more);
}

/* 1 if a is so far below 0 in all branches that it is in that exp(a) is nothing. */
static int vanishes(expression_reader *r, const ns_piecewise_value *a) {
    const double most = ns_bridge_expression_no_exp - ns_bridge_expression_log_gain(r->root, 0);
    ns_affine u, with;
    int below = 0;
    if (!ns_bridge_piecewise_affine(&r->p, a, &u))
        return 0;
    for (const expression_branch *at = r->branch; at && !below; at = at->outer) {
        const ns_piecewise_value *compared = read_node(r, at->compared);
        if (!compared || ns_bridge_piecewise_is_discrete(compared) ||
            !ns_bridge_piecewise_affine(&r->p, compared, &with))
            return 0;
        below = ns_bridge_expression_most(&u, &with, at->side) < most;
    }
    return below;
}

static int is_stepped(const INPparseNode *node) {
    return node->funcnum == PTF_FLOOR || node->funcnum == PTF_CEIL || node->funcnum == PTF_NINT;
}

static ns_piecewise_value *read_function(expression_reader *r, const INPparseNode *node) {
    double slope, offset;
    if (is_binary(node))
        return read_binary(r, node, read_node(r, node->left->left), read_node(r, node->left->right));
    const ns_piecewise_value *a = read_node(r, node->left);
    if (!a)
        return NULL;
    if (node->funcnum == PTF_SIN || node->funcnum == PTF_COS)
        return read_sine(r, node, a);
    if (node->funcnum == PTF_PWL)
        return read_line(r, node, a);
    if (node->funcnum == PTF_DDT)
        return refuse(r, "a rate", "use a capacitor and the current of a source of 0 V in series");
    if (ns_bridge_piecewise_is_discrete(a) && !node->data) /* with ngspice's values at a jump, too */
        return ns_bridge_piecewise_map(&r->p, PTunary(node->function), a);
    ns_piecewise_value *v = read_cornered(r, node, a);
    if (v || r->p.status)
        return v;
    if (is_stepped(node))
        return read_floor(r, node, a);
    if (is_of_time(r, a, &slope, &offset))
        return refuse(r, "a function of time that is not piecewise linear",
                      "use a V element with PULSE, PWL, SIN or EXP");
    if (node->funcnum == PTF_EXP && vanishes(r, a))
        return constant(r, 0.0);
    if (node->funcnum == PTF_TANH || node->funcnum == PTF_ATAN)
        return ns_bridge_expression_curve(r->w, &r->p, node->funcnum == PTF_TANH ? tanh : atan, a);
    return refuse(r, "a function of a signal that is not piecewise linear",
                  "use pwl(x, x1, y1, x2, y2, ...)");
}

/* --- operations --- */

/* c/(one + more exp(u)) = c/one (1 - tanh((u + log(more/one))/2))/2. */
static ns_piecewise_value *read_sigmoid(expression_reader *r, const ns_piecewise_value *c,
                                        const ns_expression_sigmoid *of) {
    const ns_piecewise_value *u = c ? read_node(r, of->exponent) : NULL;
    const ns_piecewise_value *half =
        ns_bridge_piecewise_sum(&r->p, 0.5, u, 0.5 * log(of->more / of->one), u ? constant(r, 1.0) : NULL);
    const ns_piecewise_value *curve = half && ns_bridge_piecewise_is_discrete(half)
                                          ? ns_bridge_piecewise_map(&r->p, tanh, half)
                                          : ns_bridge_expression_curve(r->w, &r->p, tanh, half);
    return ns_bridge_piecewise_product(
        &r->p, c, ns_bridge_piecewise_sum(&r->p, -0.5 / of->one, curve, 0.5 / of->one, constant(r, 1.0)));
}

/* Of two signals, one has to be made of steps. */
static ns_piecewise_value *product(expression_reader *r, const ns_piecewise_value *a,
                                   const ns_piecewise_value *b) {
    const int both = a && b && !ns_bridge_piecewise_is_discrete(a) && !ns_bridge_piecewise_is_discrete(b);
    const ns_piecewise_value *steps = both ? ns_bridge_expression_steps(r, a) : a;
    return ns_bridge_piecewise_product(&r->p, steps,
                                       both && steps == a ? ns_bridge_expression_steps(r, b) : b);
}

static ns_piecewise_value *read_operation(expression_reader *r, const INPparseNode *node) {
    ns_expression_sigmoid sigmoid;
    const ns_piecewise_value *a = read_node(r, node->left);
    if (node->type == PT_DIVIDE && ns_bridge_expression_is_sigmoid(node->right, &sigmoid))
        return read_sigmoid(r, a, &sigmoid);
    const ns_piecewise_value *b = a ? read_node(r, node->right) : NULL;
    switch (node->type) {
    case PT_PLUS:
        return ns_bridge_piecewise_sum(&r->p, 1.0, a, 1.0, b);
    case PT_MINUS:
        return difference(r, a, b);
    case PT_TIMES:
        return product(r, a, b);
    case PT_DIVIDE:
        return ns_bridge_piecewise_quotient(&r->p, a, ns_bridge_expression_steps(r, b));
    default:
        return read_binary(r, node, a, b);
    }
}

/* A branch: what its condition compares with 0 is on that side wherever it counts. */
static ns_piecewise_value *read_branch(expression_reader *r, const INPparseNode *node,
                                       const INPparseNode *compared, int side) {
    const expression_branch here = {compared, side, r->branch};
    r->branch = side != 0 ? &here : here.outer;
    ns_piecewise_value *v = read_node(r, node);
    r->branch = here.outer;
    return v;
}

static ns_piecewise_value *read_choice(expression_reader *r, const INPparseNode *node) {
    const INPparseNode *compared = node->left->left;
    const int side = ns_bridge_expression_side(node->left);
    const ns_piecewise_value *condition = read_node(r, node->left);
    const ns_piecewise_value *a = condition ? read_branch(r, node->right->left, compared, side) : NULL;
    const ns_piecewise_value *b = a ? read_branch(r, node->right->right, compared, -side) : NULL;
    return ns_bridge_piecewise_choose(&r->p, condition, a, b);
}

static ns_piecewise_value *read_kind(expression_reader *r, const INPparseNode *node) {
    switch (node->type) {
    case PT_CONSTANT:
        return constant(r, node->constant);
    case PT_VAR:
        return read_variable(r, node->valueIndex);
    case PT_TIME:
        return read_time(r);
    case PT_TEMPERATURE: /* in degrees Celsius */
        return constant(r, r->w->ckt->CKTtemp - 273.15);
    case PT_FUNCTION:
        return read_function(r, node);
    case PT_TERN:
        return read_choice(r, node);
    case PT_PLUS:
    case PT_MINUS:
    case PT_TIMES:
    case PT_DIVIDE:
    case PT_POWER:
        return read_operation(r, node);
    default:
        return refuse(r, "hertz", "it has no meaning in .tran");
    }
}

static ns_piecewise_value *read_node(expression_reader *r, const INPparseNode *node) {
    ns_piecewise_value *v = NULL;
    if (!node || r->depth >= DEPTH_MAX)
        return refuse(r, "it is nested too deeply", "split it");
    r->depth++;
    v = read_kind(r, node);
    r->depth--;
    if (!v && !r->at)
        r->at = node;
    return v;
}

ns_piecewise_value *ns_bridge_expression_read(expression_reader *r, const INPparseNode *root) {
    return read_node(r, root);
}
