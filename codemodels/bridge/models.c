/* bridge/models.c - our code models as ngspice's structs show them. */
#include "models.h"

#include <math.h>
#include <string.h>

static int type_of[KINDS] = {-1, -1, -1}; /* device types of ngspice */

void ns_bridge_models_set_type(model_kind kind, int type) {
    type_of[kind] = type;
}

int ns_bridge_models_type(model_kind kind) {
    return type_of[kind];
}

int ns_bridge_models_any(const char **name) {
    static const char *const names[KINDS] = {"ideal_diode", "ideal_switch", "nonsmooth"};
    int k = 0;
    while (k + 1 < KINDS && type_of[k] < 0)
        k++;
    if (name)
        *name = names[k];
    return type_of[k];
}

model_kind ns_bridge_models_kind(const GENinstance *inst) {
    for (int k = 0; k < KINDS; k++)
        if (inst->GENmodPtr->GENmodType == type_of[k])
            return (model_kind)k;
    return KIND_FOREIGN;
}

char ns_bridge_models_letter(const GENinstance *inst) {
    const char *model = inst->GENmodPtr->GENmodName; /* all V sources have this one; users' are lower case */
    return model && strcmp(model, "V") == 0 ? 'v' : inst->GENname[0];
}

int ns_bridge_models_node(const MIFinstance *inst, int terminal) {
    return inst->conn[terminal]->port[0]->smp_data.pos_node;
}

int ns_bridge_models_branch(const MIFinstance *inst) {
    return inst->conn[WITH_CURRENT]->port[0]->smp_data.branch;
}

double ns_bridge_models_real(const MIFinstance *inst, int parameter) {
    return inst->param[parameter]->element[0].rvalue;
}

double ns_bridge_models_ohms(const MIFinstance *inst, int parameter) {
    const double ohms = ns_bridge_models_real(inst, parameter);
    return ohms >= 1e30 ? INFINITY : ohms;
}

double ns_bridge_models_given(const MIFinstance *inst, int parameter) {
    return inst->param[parameter]->is_null ? NAN : ns_bridge_models_real(inst, parameter);
}

const char *ns_bridge_models_text(const MIFinstance *inst, int parameter) {
    return inst->param[parameter]->is_null ? NULL : inst->param[parameter]->element[0].svalue;
}

void ns_bridge_models_own_name(const MIFinstance *inst, char *name, size_t size) {
    const char *made = inst->MIFname, *dot = strrchr(made, '.');
    const char *own = dot ? dot + 1 : made;
    if (own[0] == 'a' && own[1] && strchr("dsw", own[1]))
        snprintf(name, size, "%.*s%.*s%s", dot != NULL, own + 1, dot ? (int)(own - made) - 1 : 0, made + 1,
                 own + 1);
    else
        snprintf(name, size, "%s", made);
}
