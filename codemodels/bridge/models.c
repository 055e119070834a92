/* bridge/models.c - our code models as ngspice's structs show them. */
#include "models.h"

#include <math.h>
#include <string.h>

char models_letter(const GENinstance *inst) {
    const char *model = inst->GENmodPtr->GENmodName; /* all V sources have this one; users' are lower case */
    return model && strcmp(model, "V") == 0 ? 'v' : inst->GENname[0];
}

int models_node(const MIFinstance *inst, int terminal) {
    return inst->conn[terminal]->port[0]->smp_data.pos_node;
}

double models_real(const MIFinstance *inst, int parameter) {
    return inst->param[parameter]->element[0].rvalue;
}

double models_ohms(const MIFinstance *inst, int parameter) {
    const double ohms = models_real(inst, parameter);
    return ohms >= 1e30 ? INFINITY : ohms;
}
