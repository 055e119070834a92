/* bridge/behavioural.c - B sources of ngspice whose expression is linear in node voltages and currents.
 *
 * The parse tree decides: sums, multiples and quotients by constants of variables are linear; time,
 * temperature and functions of a variable are not.  Numbers come from evaluating the expression at zero and
 * are checked at two other points. */
#include "display.h"
#include "elements.h"
#include "expression.h"

#include <math.h>
#include <string.h>

#include "pure/affine.h"

#include "ngspice/inpptree.h"
#include "spicelib/devices/asrc/asrcdefs.h"

enum { DEPTH_MAX = 1000 }; /* of an expression */

static ns_degree degree_of(const INPparseNode *node, int depth);

static ns_degree degree_of_function(const INPparseNode *node, int depth) {
    const ns_degree argument = degree_of(node->left, depth);
    if (node->funcnum == PTF_UMINUS)
        return argument;
    return argument == DEGREE_CONSTANT && node->funcnum != PTF_DDT ? DEGREE_CONSTANT : DEGREE_OTHER;
}

static ns_degree degree_of_operation(const INPparseNode *node, ns_operation operation, int depth) {
    return ns_bridge_affine_degree(operation, degree_of(node->left, depth), degree_of(node->right, depth));
}

/* How node depends on the variables. */
static ns_degree degree_of(const INPparseNode *node, int depth) {
    if (!node || depth++ > DEPTH_MAX)
        return DEGREE_OTHER;
    switch (node->type) {
    case PT_CONSTANT:
        return DEGREE_CONSTANT;
    case PT_VAR:
        return DEGREE_LINEAR;
    case PT_FUNCTION:
        return degree_of_function(node, depth);
    case PT_PLUS:
    case PT_MINUS:
        return degree_of_operation(node, OPERATION_SUM, depth);
    case PT_TIMES:
        return degree_of_operation(node, OPERATION_PRODUCT, depth);
    case PT_DIVIDE:
        return degree_of_operation(node, OPERATION_QUOTIENT, depth);
    case PT_POWER:
    case PT_COMMA:
    case PT_TERN:
        return degree_of_operation(node, OPERATION_OTHER, depth);
    default: /* time, temperature, frequency */
        return DEGREE_OTHER;
    }
}

/* What ngspice evaluates. */
typedef struct parsed {
    IFparseTree *tree;
    double gmin;
} parsed;

static double evaluate(void *context, const double *values, double *slopes) {
    const parsed *p = context;
    double result = NAN;
    return p->tree->IFeval(p->tree, p->gmin, &result, (double *)values, slopes) == OK ? result : NAN;
}

/* constant and slopes (n) of a linear expression; 0: it is none.  work: 2n. */
static int read_linear(const ns_extract_walk *w, IFparseTree *tree, double *constant, double *slopes,
                       double *work) {
    parsed p = {tree, w->ckt->CKTgmin};
    const ns_expression e = {tree->numVars, evaluate, &p};
    return degree_of(((const INPparseTree *)tree)->tree, 0) != DEGREE_OTHER &&
           ns_bridge_affine_fit(&e, constant, slopes, work);
}

/* The terms (n); EXTRACT_LATER if one refers to an element that was not read yet. */
static int make_terms(const ns_extract_walk *w, const ASRCinstance *b, const double *slopes, double factor,
                      ns_term *terms) {
    for (int i = 0; i < b->ASRCtree->numVars; i++) {
        const int eq = b->ASRCvars[i];
        const int is_current = b->ASRCtree->varTypes[i] == IF_INSTANCE;
        const int of = is_current && eq > 0 && eq < w->ex->neq ? w->ex->element[eq] : -1;
        if (is_current && of < 0)
            return EXTRACT_LATER;
        terms[i] =
            (ns_term){.is_current = is_current, .of = is_current ? of : eq, .gain = factor * slopes[i]};
    }
    return NS_OK;
}

/* ngspice makes B sources of its own, where a user wrote none; NULL: it is none of these. */
static const char *why_not(const char *name) {
    if (strncmp(name, "bpa_", 4) == 0) {
        return "made by par() of .meas, .print or .plot, it depends on what was before and is not "
               "supported: use let and meas after the run instead";
    }
    return NULL;
}

static int add_linear(ns_extract_walk *w, GENinstance *inst, double *slopes, double *work, ns_term *terms) {
    const ASRCinstance *b = (const ASRCinstance *)inst;
    const double factor = ns_bridge_expression_factor(inst);
    const ns_output kind = b->ASRCtype == ASRC_VOLTAGE ? NS_VOLTAGE : NS_CURRENT;
    double constant;
    int id = -1;
    int status;
    if (!read_linear(w, b->ASRCtree, &constant, slopes, work))
        return why_not(inst->GENname) ? ns_bridge_extract_refuse(w, inst, why_not(inst->GENname))
                                      : ns_bridge_expression_add(w, inst, factor);
    status = make_terms(w, b, slopes, factor, terms);
    if (status)
        return status;
    constant *= factor;
    for (int i = 0; i < b->ASRCtree->numVars; i++)
        ns_bridge_extract_mix(w, &terms[i].gain, sizeof terms[i].gain);
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
    int status = numbers && terms ? add_linear(w, inst, numbers, numbers + n, terms) : NS_E_MEMORY;
    free(numbers);
    free(terms);
    w->again = status == EXTRACT_REFUSED && ns_bridge_display_may(w->ckt, inst, w->displays);
    return status;
}
