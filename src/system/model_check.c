/* src/system/model_check.c - refuses models that cannot be integrated, and says where. */
#include <math.h>

#include "check.h"
#include "nonsmooth/model.h"

static int required(const ns_model *p) {
    const int states = p->n == 0 || (p->M && p->f && p->A);
    const int pairs = p->m == 0 || (p->l && p->u && p->g && p->B && p->h && p->C);
    return states && pairs && (p->nz == 0 || p->z);
}

static int check_bounds(double l, double u, int pair, ns_fault *fault) {
    if (isnan(l) || isnan(u) || l == INFINITY || u == -INFINITY)
        return ns_system_blame(fault, NS_E_NUMBER, NS_PAIR, pair);
    return l <= u ? NS_OK : ns_system_blame(fault, NS_E_BOUNDS, NS_PAIR, pair);
}

int ns_model_check(const ns_model *model, ns_fault *fault) {
    if (!model)
        return ns_system_blame(fault, NS_E_NULL, NS_NOTHING, 0);
    if (model->n < 0 || model->m < 0 || model->nz < 0)
        return ns_system_blame(fault, NS_E_SIZE, NS_NOTHING, 0);
    if (!required(model))
        return ns_system_blame(fault, NS_E_NULL, NS_NOTHING, 0);
    int status = ns_system_check_array(model->M, model->n, model->n, NS_UNKNOWN, NS_UNKNOWN, fault);
    for (int i = 0; i < model->nz && status == NS_OK; i++)
        if ((status = ns_signal_check(&model->z[i])) != NS_OK)
            ns_system_blame(fault, status, NS_NOTHING, 0);
    for (int i = 0; i < model->m && status == NS_OK; i++)
        status = check_bounds(model->l[i], model->u[i], i, fault);
    return status;
}
