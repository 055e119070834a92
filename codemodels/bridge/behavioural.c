/* bridge/behavioural.c - B sources of ngspice whose expression is linear in node voltages and currents.
 *
 * The parse tree decides: sums, multiples and quotients by constants of variables are linear; time,
 * temperature and functions of a variable are not.  Numbers come from evaluating the expression at zero and
 * are checked at two other points. */
#include "elements.h"

#include <math.h>
#include <string.h>

#include "ngspice/inpptree.h"
#include "spicelib/devices/asrc/asrcdefs.h"

typedef enum degree { FIXED, LINE, CURVE } degree;

enum { DEPTH_MAX = 1000 }; /* of an expression */

static degree larger(degree a, degree b) {
    return a > b ? a : b;
}

static degree degree_of(const INPparseNode *node, int depth);

static degree of_function(const INPparseNode *node, int depth) {
    const degree argument = degree_of(node->left, depth);
    if (node->funcnum == PTF_UMINUS) {
        return argument;
    }
    return argument == FIXED && node->funcnum != PTF_DDT ? FIXED : CURVE;
}

/* How node depends on the variables: not, linearly, otherwise. */
static degree degree_of(const INPparseNode *node, int depth) {
    degree left, right;
    if (!node || depth > DEPTH_MAX) {
        return CURVE;
    }
    switch (node->type) {
    case PT_CONSTANT:
        return FIXED;
    case PT_VAR:
        return LINE;
    case PT_FUNCTION:
        return of_function(node, depth + 1);
    case PT_PLUS:
    case PT_MINUS:
    case PT_TIMES:
    case PT_DIVIDE:
    case PT_POWER:
    case PT_COMMA:
    case PT_TERN:
        break;
    default: /* time, temperature, frequency */
        return CURVE;
    }
    left = degree_of(node->left, depth + 1);
    right = degree_of(node->right, depth + 1);
    if (left == FIXED && right == FIXED) {
        return FIXED;
    }
    if (node->type == PT_PLUS || node->type == PT_MINUS) {
        return larger(left, right);
    }
    if (node->type == PT_TIMES && (left == FIXED || right == FIXED)) {
        return larger(left, right);
    }
    return node->type == PT_DIVIDE && right == FIXED ? left : CURVE;
}

/* The factor of ngspice on the expression: temperature and multiplicity. */
static double factor_of(const ASRCinstance *b) {
    const double difference = b->ASRCtemp + b->ASRCdtemp - 300.15;
    double factor = 1.0 + b->ASRCtc1 * difference + b->ASRCtc2 * difference * difference;
    factor = b->ASRCreciproctc == 1 ? 1.0 / factor : factor;
    return b->ASRCreciprocm == 1 ? factor / b->ASRCm : factor * b->ASRCm;
}

/* Evaluates at values (n); returns the expression, derivatives in slopes (n); NAN if it cannot. */
static double evaluate(const ns_extract_walk *w, IFparseTree *tree, double *values, double *slopes) {
    double result = NAN;
    return tree->IFeval(tree, w->ckt->CKTgmin, &result, values, slopes) == OK ? result : NAN;
}

/* Is constant + sum slopes*v what the expression gives at a point?  scratch: 2n. */
static int agrees(const ns_extract_walk *w, IFparseTree *tree, double constant, const double *slopes,
                  double first, double ratio, double *scratch) {
    const int n = tree->numVars;
    double expected = constant;
    double size = fabs(constant);
    double v = first;
    double found;
    for (int i = 0; i < n; i++, v *= ratio) {
        scratch[i] = v;
        expected += slopes[i] * v;
        size += fabs(slopes[i] * v);
    }
    found = evaluate(w, tree, scratch, scratch + n);
    return fabs(found - expected) <= 1e-9 * size; /* rounding of some 1e6 operations */
}

/* constant and slopes (n) of a linear expression.  scratch: 2n. */
static int linear(const ns_extract_walk *w, IFparseTree *tree, double *constant, double *slopes,
                  double *scratch) {
    const INPparseTree *whole = (const INPparseTree *)tree;
    if (degree_of(whole->tree, 0) == CURVE) {
        return 0;
    }
    for (int i = 0; i < tree->numVars; i++) {
        scratch[i] = 0.0;
    }
    *constant = evaluate(w, tree, scratch, slopes);
    return isfinite(*constant) && agrees(w, tree, *constant, slopes, 1.0, -1.7, scratch) &&
           agrees(w, tree, *constant, slopes, -3.1e3, 0.61, scratch);
}

/* The terms (n); EXTRACT_LATER if one refers to an element that was not read yet. */
static int make_terms(const ns_extract_walk *w, const ASRCinstance *b, const double *slopes, double factor,
                      ns_term *terms) {
    for (int i = 0; i < b->ASRCtree->numVars; i++) {
        const int eq = b->ASRCvars[i];
        const int is_current = b->ASRCtree->varTypes[i] == IF_INSTANCE;
        const int of = is_current && eq > 0 && eq < w->ex->neq ? w->ex->element[eq] : -1;
        if (is_current && of < 0) {
            return EXTRACT_LATER;
        }
        terms[i] =
            (ns_term){.is_current = is_current, .of = is_current ? of : eq, .gain = factor * slopes[i]};
    }
    return NS_OK;
}

/* ngspice makes B sources of its own, where a user wrote none. */
static const char *why_not(const char *name) {
    if (strncmp(name, "bpa_", 4) == 0) {
        return "made by par() of .meas, .print or .plot, not linear in voltages and currents, and cannot be "
               "taken yet: use let and meas after the run instead";
    }
    if (strncmp(name, "bprobe_int_", 11) == 0) {
        return "made by .probe p(), not linear in voltages and currents, and cannot be taken yet: use let "
               "after the run instead";
    }
    return "a B source that is not linear in voltages and currents cannot be taken yet";
}

static int add(ns_extract_walk *w, GENinstance *inst, double *slopes, double *scratch, ns_term *terms) {
    const ASRCinstance *b = (const ASRCinstance *)inst;
    const double factor = factor_of(b);
    const ns_output kind = b->ASRCtype == ASRC_VOLTAGE ? NS_VOLTAGE : NS_CURRENT;
    double constant;
    int id = -1;
    int status;
    if (!linear(w, b->ASRCtree, &constant, slopes, scratch)) {
        return ns_bridge_extract_refuse(w, inst, why_not(inst->GENname));
    }
    status = make_terms(w, b, slopes, factor, terms);
    if (status) {
        return status;
    }
    constant *= factor;
    for (int i = 0; i < b->ASRCtree->numVars; i++) {
        ns_bridge_extract_mix(w, &terms[i].gain, sizeof terms[i].gain);
    }
    ns_bridge_extract_mix(w, &constant, sizeof constant);
    status = ns_circuit_linear(w->ex->circuit, inst->GENname, kind, b->ASRCposNode, b->ASRCnegNode, constant,
                               b->ASRCtree->numVars, terms, &id);
    ns_bridge_extract_current(w, kind == NS_VOLTAGE ? b->ASRCbranch : 0, id);
    return status;
}

int ns_bridge_behavioural(ns_extract_walk *w, GENinstance *inst) {
    const ASRCinstance *b = (const ASRCinstance *)inst;
    const size_t n = (size_t)b->ASRCtree->numVars + 1;
    double *numbers = calloc(3 * n, sizeof *numbers);
    ns_term *terms = calloc(n, sizeof *terms);
    int status = numbers && terms ? add(w, inst, numbers, numbers + n, terms) : NS_E_MEMORY;
    free(numbers);
    free(terms);
    return status;
}
