/* bridge/models.h - our code models as ngspice's structs show them: order of terminals, parameters and
 * static variables as in the ifspec.ifs files. */
#ifndef BRIDGE_MODELS_H
#define BRIDGE_MODELS_H

#include "ngspice.h"

typedef enum model_kind { KIND_FOREIGN = -1, KIND_DIODE, KIND_SWITCH, KIND_OPTIONS, KINDS } model_kind;

enum { DIODE_ANODE, DIODE_CATHODE };
enum { SWITCH_P, SWITCH_N, SWITCH_CP, SWITCH_CN };
enum {
    WITH_CURRENT = DIODE_CATHODE
}; /* the terminal whose port type, h, makes ngspice add a branch current */

enum { DIODE_VF, DIODE_RON, DIODE_ROFF, DIODE_VZ, DIODE_RZ };
enum { SWITCH_VT, SWITCH_VH, SWITCH_RON, SWITCH_ROFF };
enum {
    OPTION_METHOD,
    OPTION_H,
    OPTION_THETA,
    OPTION_GAMMA,
    OPTION_RELTOL,
    OPTION_VERBOSE,
    OPTION_DUMP,
    OPTION_CORNERS,
    OPTION_LINES,
    OPTION_POINTS,
    OPTION_SQUARES,
    OPTION_TAKE,
    OPTION_DIODE,
    OPTION_ID,
    OPTION_CJO,
    OPTION_MOSFET,
    OPTION_VGS
};

enum { SHOW_I, SHOW_V, SHOW_ON, SHOW_P, SHOW_Q, SHOW_E }; /* of the diode and the switch */

/* Keeps the number that ngspice gave to one of our device types. */
void ns_bridge_models_set_type(model_kind kind, int type);

/* That number, or -1: it was not set. */
int ns_bridge_models_type(model_kind kind);

/* The number of one of our types that was set, and (unless NULL) its name; -1: none was. */
int ns_bridge_models_any(const char **name);

/* Which of our models an instance is of; KIND_FOREIGN: none. */
model_kind ns_bridge_models_kind(const GENinstance *inst);

/* The SPICE letter of an instance: the first of its name, which survives the flattening of subcircuits, but
 * .probe names its voltage sources as what they measure. */
char ns_bridge_models_letter(const GENinstance *inst);

/* The equation of a terminal's node. */
int ns_bridge_models_node(const MIFinstance *inst, int terminal);

/* The equation of a diode's or switch's branch current. */
int ns_bridge_models_branch(const MIFinstance *inst);

/* A parameter's value; infinite from 1e30 on; NAN if it was not given; its text, NULL if it was not given. */
double ns_bridge_models_real(const MIFinstance *inst, int parameter);
double ns_bridge_models_ohms(const MIFinstance *inst, int parameter);
double ns_bridge_models_given(const MIFinstance *inst, int parameter);
const char *ns_bridge_models_text(const MIFinstance *inst, int parameter);

/* The name that the user wrote of what ngspice made a code model of: as1 was s1, a.x1.as1 was s.x1.s1. */
void ns_bridge_models_own_name(const MIFinstance *inst, char *name, size_t size);

#endif
