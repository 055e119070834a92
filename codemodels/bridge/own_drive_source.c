/* bridge/own_drive_source.c - the ranges of V and B sources and of outputs of digital parts. */
#include "own_drive.h"

#include <math.h>
#include <string.h>

#include "foreign.h"
#include "ngspice/inpptree.h"

#include "spicelib/devices/asrc/asrcdefs.h"

enum { DEPTH_MAX = 200 };
enum { DAC_LOW, DAC_HIGH };

typedef struct range_reader {
    const CKTcircuit *ckt;
    const ASRCinstance *b;
    ns_own_range_at *at;
    int depth;
} range_reader;

static const ns_own_range any = {-INFINITY, INFINITY, 0, 0};

static ns_own_range range_of(range_reader *r, const INPparseNode *node);

static ns_own_range steps(double low, double high) {
    return (ns_own_range){low, high, 1, 1};
}

static int is_finite(const ns_own_range *a) {
    return isfinite(a->low) && isfinite(a->high);
}

/* What was infinite and is cut off steps: a comparator of large gain. */
static ns_own_range cut(ns_own_range r, const ns_own_range *a, const ns_own_range *b) {
    r.switches = a->switches || b->switches || (is_finite(&r) && !(is_finite(a) && is_finite(b)));
    r.sources = 1;
    return r;
}

static double times(double a, double b) {
    return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

static ns_own_range product(const ns_own_range *a, const ns_own_range *b) {
    const double p = times(a->low, b->low), q = times(a->low, b->high), s = times(a->high, b->low),
                 t = times(a->high, b->high);
    return (ns_own_range){fmin(fmin(p, q), fmin(s, t)), fmax(fmax(p, q), fmax(s, t)),
                          a->switches || b->switches, 1};
}

static ns_own_range operation(range_reader *r, const INPparseNode *node) {
    const ns_own_range a = range_of(r, node->left), b = range_of(r, node->right);
    const int both = a.switches || b.switches;
    switch (node->type) {
    case PT_PLUS:
        return (ns_own_range){a.low + b.low, a.high + b.high, both, 1};
    case PT_MINUS:
        return (ns_own_range){a.low - b.high, a.high - b.low, both, 1};
    case PT_TIMES:
        return product(&a, &b);
    case PT_DIVIDE:
        return b.low == b.high && b.low != 0.0 ? product(&a, &(ns_own_range){1.0 / b.low, 1.0 / b.low, 0, 1})
                                               : any;
    default:
        return any;
    }
}

static ns_own_range line(const INPparseNode *node) {
    const struct {
        int n;
        double *vals;
    } *points = node->data;
    ns_own_range r = steps(INFINITY, -INFINITY);
    for (int k = 1; k < points->n; k += 2) {
        r.low = fmin(r.low, points->vals[k]);
        r.high = fmax(r.high, points->vals[k]);
    }
    return r;
}

static ns_own_range smaller(const ns_own_range *a, const ns_own_range *b) {
    return cut((ns_own_range){.low = fmin(a->low, b->low), .high = fmin(a->high, b->high)}, a, b);
}

static ns_own_range larger(const ns_own_range *a, const ns_own_range *b) {
    return cut((ns_own_range){.low = fmax(a->low, b->low), .high = fmax(a->high, b->high)}, a, b);
}

static ns_own_range negative(const ns_own_range *a) {
    return (ns_own_range){-a->high, -a->low, a->switches, 1};
}

static ns_own_range function(range_reader *r, const INPparseNode *node) {
    if (node->funcnum == PTF_MIN || node->funcnum == PTF_MAX) {
        const ns_own_range a = range_of(r, node->left->left), b = range_of(r, node->left->right);
        return node->funcnum == PTF_MIN ? smaller(&a, &b) : larger(&a, &b);
    }
    if (node->funcnum == PTF_POW || node->funcnum == PTF_PWR)
        return any;
    const ns_own_range a = range_of(r, node->left), minus = negative(&a), none = {0.0, 0.0, 0, 1};
    switch (node->funcnum) {
    case PTF_UMINUS:
        return minus;
    case PTF_URAMP:
        return larger(&a, &none);
    case PTF_ABS:
        return larger(&a, &minus);
    case PTF_PWL:
        return line(node);
    case PTF_SGN:
        return steps(-1.0, 1.0);
    case PTF_SIN:
    case PTF_COS:
        return (ns_own_range){-1.0, 1.0, 0, 1};
    case PTF_USTEP:
    case PTF_USTEP2:
    case PTF_EQ0:
    case PTF_NE0:
    case PTF_GT0:
    case PTF_LT0:
    case PTF_GE0:
    case PTF_LE0:
        return steps(0.0, 1.0);
    default:
        return any;
    }
}

static ns_own_range variable(const range_reader *r, int index) {
    ns_own_range a;
    if (r->b->ASRCtree->varTypes[index] != IF_NODE || !r->at(r->ckt, r->b->ASRCvars[index], &a))
        return any;
    return a;
}

/* One of two. */
static ns_own_range choice(range_reader *r, const INPparseNode *node) {
    const ns_own_range a = range_of(r, node->right->left), b = range_of(r, node->right->right);
    return steps(fmin(a.low, b.low), fmax(a.high, b.high));
}

static ns_own_range range_of(range_reader *r, const INPparseNode *node) {
    ns_own_range found = any;
    if (!node || r->depth >= DEPTH_MAX)
        return any;
    r->depth++;
    if (node->type == PT_CONSTANT)
        found = (ns_own_range){node->constant, node->constant, 0, 1};
    else if (node->type == PT_VAR)
        found = variable(r, node->valueIndex);
    else if (node->type == PT_FUNCTION)
        found = function(r, node);
    else if (node->type == PT_TERN)
        found = choice(r, node);
    else if (node->type != PT_TIME && node->type != PT_TEMPERATURE && node->type != PT_FREQUENCY)
        found = operation(r, node);
    r->depth--;
    return isnan(found.low) || isnan(found.high) ? any : found;
}

int ns_bridge_own_range_of_b(const CKTcircuit *ckt, const GENinstance *inst, ns_own_range_at *at,
                             ns_own_range *r) {
    const ASRCinstance *b = (const ASRCinstance *)inst;
    range_reader reads = {.ckt = ckt, .b = b, .at = at};
    if (b->ASRCtype != ASRC_VOLTAGE)
        return 0;
    *r = range_of(&reads, ((const INPparseTree *)b->ASRCtree)->tree);
    return is_finite(r);
}

int ns_bridge_own_range_of_bridge(const GENinstance *inst, int here, int *p, int *n, ns_own_range *r) {
    const MIFinstance *mif = (const MIFinstance *)inst;
    const char *model = ns_bridge_models_kind(inst) == KIND_FOREIGN ? ns_bridge_foreign_model(mif) : NULL;
    if (!model || strcmp(model, "dac_bridge") != 0)
        return 0;
    const double low = ns_bridge_models_real(mif, DAC_LOW), high = ns_bridge_models_real(mif, DAC_HIGH);
    *r = steps(fmin(low, high), fmax(low, high));
    for (int k = 0; k < mif->conn[1]->size; k++) {
        const Mif_Port_Data_t *out = mif->conn[1]->port[k];
        *p = out->smp_data.pos_node;
        *n = out->type == MIF_DIFF_VOLTAGE ? out->smp_data.neg_node : 0;
        if ((out->type == MIF_VOLTAGE || out->type == MIF_DIFF_VOLTAGE) && (*p == here || *n == here))
            return 1;
    }
    return 0;
}

void ns_bridge_own_extend(ns_own_range *r, double value) {
    r->low = fmin(r->low, value);
    r->high = fmax(r->high, value);
}

ns_own_range ns_bridge_own_range_of_v(const VSRCinstance *v) {
    const double *c = v->VSRCcoeffs;
    ns_own_range r = {v->VSRCdcValue, v->VSRCdcValue, 0, 1};
    if (!v->VSRCcoeffsGiven || v->VSRCfunctionOrder < 2)
        return r;
    switch (v->VSRCfunctionType) {
    case PULSE:
    case EXP:
        return (ns_own_range){fmin(c[0], c[1]), fmax(c[0], c[1]), v->VSRCfunctionType == PULSE, 1};
    case SINE:
        return (ns_own_range){c[0] - fabs(c[1]), c[0] + fabs(c[1]), 0, 1};
    case PWL:
        r = (ns_own_range){c[1], c[1], 1, 1};
        for (int k = 3; k < v->VSRCfunctionOrder; k += 2)
            ns_bridge_own_extend(&r, c[k]);
        return r;
    default:
        return r;
    }
}
