/* bridge/expression_steps.c - a factor that V alone make, each of which goes from one of two values to the
 * other one in no time that counts, or B that are choices between numbers: it is a comparison then, and may
 * be multiplied with a signal. */
#include "expression_reader.h"

#include <math.h>
#include <stdlib.h>

#include "models.h"
#include "sources.h"

#include "spicelib/devices/vsrc/vsrcdefs.h"

/* Of its period, or of the run: what it may take on its way between them. */
static const double short_way = 2e-3;

/* The two values; both NAN: none was seen, the same: one. */
typedef struct two_levels {
    double low, high;           /* V */
    const ASRCinstance *chosen; /* NULL: a V holds the node, else this B */
    double sign;                /* of its expression in the voltage of the node */
} two_levels;

/* One value more; 0: it is a third one. */
static int add_level(two_levels *l, double v) {
    const double near = 1e-9 * fmax(fabs(v), fmax(fabs(l->low), fabs(l->high)));
    if (isnan(l->low))
        l->low = l->high = v;
    else if (l->low == l->high)
        *l = (two_levels){.low = fmin(l->low, v), .high = fmax(l->low, v)};
    return fabs(v - l->low) <= near || fabs(v - l->high) <= near;
}

static int levels_of_pulse(const ns_signal *z, double stop, two_levels *l) {
    const double way = z->u.pulse.tr + z->u.pulse.tf;
    return add_level(l, z->u.pulse.v1) && add_level(l, z->u.pulse.v2) &&
           (isinf(stop) ||
            (way + z->u.pulse.pw <= z->u.pulse.per && way <= short_way * fmin(z->u.pulse.per, stop)));
}

static int levels_of_pwl(const ns_signal *z, double stop, two_levels *l) {
    const double *t = z->u.pwl.t, *v = z->u.pwl.v;
    const int n = z->u.pwl.n;
    double way = 0.0, all = stop;
    if (!isnan(z->u.pwl.repeat))
        all = fmin(stop, t[n - 1] - z->u.pwl.repeat);
    for (int k = 0; k < n; k++) {
        if (!add_level(l, v[k]))
            return 0;
        way += k > 0 && v[k] != v[k - 1] ? t[k] - t[k - 1] : 0.0;
    }
    return way <= short_way * all;
}

/* 1 if a V holds the node at one of two values. */
static int find_levels(const ns_extract_walk *w, int node, two_levels *l) {
    const double stop =
        w->ckt->CKTfinalTime > 0.0 ? w->ckt->CKTfinalTime : INFINITY; /* before .tran is read */
    ns_signal z;
    double *points = NULL;
    int sign, found = 0;
    const GENinstance *inst = w->dc ? NULL : ns_bridge_expression_holder(w, node, 0, &sign);
    *l = (two_levels){.low = NAN, .high = NAN};
    if (inst && !ns_bridge_sources_signal(w->ckt, inst, 0, &z, &points))
        found = (z.kind == NS_PULSE && levels_of_pulse(&z, stop, l)) ||
                (z.kind == NS_PWL && levels_of_pwl(&z, stop, l));
    free(points);
    if (found && sign < 0)
        *l = (two_levels){.low = -l->high, .high = -l->low};
    return found;
}

int ns_bridge_expression_is_step(const INPparseNode *node) {
    switch (node->funcnum) {
    case PTF_USTEP:
    case PTF_SGN:
    case PTF_EQ0:
    case PTF_NE0:
    case PTF_GT0:
    case PTF_LT0:
    case PTF_GE0:
    case PTF_LE0:
        return 1;
    default:
        return 0;
    }
}

/* 1 if all that may come out are numbers, which conditions choose. */
static int is_choice(const INPparseNode *node, int depth) {
    if (!node || depth > 100)
        return 0;
    switch (node->type) {
    case PT_CONSTANT:
        return 1;
    case PT_TERN:
        return is_choice(node->right->left, depth + 1) && is_choice(node->right->right, depth + 1);
    case PT_PLUS:
    case PT_MINUS:
    case PT_TIMES:
        return is_choice(node->left, depth + 1) && is_choice(node->right, depth + 1);
    case PT_FUNCTION:
        return ns_bridge_expression_is_step(node) ||
               (node->funcnum == PTF_UMINUS && is_choice(node->left, depth + 1));
    default:
        return 0;
    }
}

/* The B between this node and ground whose expression is a choice between numbers; NULL: there is none. */
static const ASRCinstance *find_chosen(const ns_extract_walk *w, int node, double *sign) {
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const ASRCinstance *b = box->data;
        if (ns_bridge_models_letter(box->data) != 'b' || b->ASRCtype != ASRC_VOLTAGE)
            continue;
        *sign = b->ASRCposNode == node ? 1.0 : -1.0;
        if (((b->ASRCposNode == node && b->ASRCnegNode == 0) ||
             (b->ASRCnegNode == node && b->ASRCposNode == 0)) &&
            is_choice(((const INPparseTree *)b->ASRCtree)->tree, 0))
            return b;
    }
    return NULL;
}

/* The voltage of that node, by its own expression; NULL: that cannot be read. */
static ns_piecewise_value *choice_of(expression_reader *r, const two_levels *l) {
    const expression_reader outer = *r;
    const GENinstance *inst = (const GENinstance *)l->chosen;
    r->b = l->chosen;
    r->root = ((const INPparseTree *)l->chosen->ASRCtree)->tree;
    r->branch = NULL;
    r->is_inside = 1;
    const ns_piecewise_value *v = r->read(r, r->root);
    r->b = outer.b;
    r->root = outer.root;
    r->at = outer.at; /* the text is that of the expression which reads the node */
    r->branch = outer.branch;
    r->is_inside = 0;
    return ns_bridge_piecewise_sum(&r->p, l->sign * ns_bridge_expression_factor(inst), v, 0.0, v);
}

/* The voltage of the node as a comparison. */
static ns_piecewise_value *step_of(expression_reader *r, int node, const two_levels *l) {
    ns_piecewise *p = &r->p;
    if (l->chosen)
        return choice_of(r, l);
    const ns_piecewise_value *one = ns_bridge_piecewise_constant(p, 1.0);
    const ns_piecewise_value *beyond = ns_bridge_piecewise_sum(
        p, 1.0, ns_bridge_piecewise_term(p, (ns_term){0, node, 1.0}), -0.5 * (l->low + l->high), one);
    return ns_bridge_piecewise_sum(p, l->low, one, l->high - l->low, ns_bridge_piecewise_above(p, beyond));
}

/* Of each term of u; 0: a term is something else. */
static int find_all_levels(const expression_reader *r, const ns_affine *u, two_levels *l) {
    int all = u->nterms > 0 && u->nterms <= PIECEWISE_CONDITIONS;
    for (int k = 0; k < u->nterms && all; k++) {
        all = u->terms[k].is_current == 0;
        if (all && !find_levels(r->w, u->terms[k].of, &l[k]))
            all = !r->is_inside && (l[k].chosen = find_chosen(r->w, u->terms[k].of, &l[k].sign)) != NULL;
    }
    return all;
}

const ns_piecewise_value *ns_bridge_expression_steps(expression_reader *r, const ns_piecewise_value *a) {
    ns_affine u;
    two_levels l[PIECEWISE_CONDITIONS];
    if (!a || ns_bridge_piecewise_is_discrete(a) || !ns_bridge_piecewise_affine(&r->p, a, &u) ||
        !find_all_levels(r, &u, l))
        return a;
    const ns_piecewise_value *one = ns_bridge_piecewise_constant(&r->p, 1.0);
    const ns_piecewise_value *sum = ns_bridge_piecewise_sum(&r->p, u.constant, one, 0.0, one);
    for (int k = 0; k < u.nterms; k++)
        sum = ns_bridge_piecewise_sum(&r->p, 1.0, sum, u.terms[k].gain, step_of(r, u.terms[k].of, &l[k]));
    for (int k = 0; k < u.nterms && !*r->w->ex->stepped; k++)
        if (!l[k].chosen)
            snprintf(r->w->ex->stepped, sizeof r->w->ex->stepped, "%.79s", r->p.name);
    return sum;
}

/* 1 if this is the equation of the current of a V, which waits for nothing. */
static int is_of_v(const CKTcircuit *ckt, int branch) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next)
        if (ns_bridge_models_letter(box->data) == 'v' &&
            ((const VSRCinstance *)box->data)->VSRCbranch == branch)
            return 1;
    return 0;
}

int ns_bridge_expression_steps_wait(const ns_extract_walk *w, const ASRCinstance *b) {
    for (int i = 0; i < b->ASRCtree->numVars; i++) {
        double sign;
        const ASRCinstance *of =
            b->ASRCtree->varTypes[i] == IF_NODE ? find_chosen(w, b->ASRCvars[i], &sign) : NULL;
        for (int k = 0; of && k < of->ASRCtree->numVars; k++)
            if (of != b && of->ASRCtree->varTypes[k] == IF_INSTANCE &&
                ns_bridge_extract_element(w, of->ASRCvars[k]) < 0 && is_of_v(w->ckt, of->ASRCvars[k]))
                return 1;
    }
    return 0;
}
