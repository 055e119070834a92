/* bridge/display_find.c - which B, E and G act on nothing. */
#include <string.h>

#include "display.h"
#include "expression.h"
#include "ngspice/inpptree.h"
#include "own_touch.h"

#include "spicelib/devices/asrc/asrcdefs.h"
#include "spicelib/devices/cccs/cccsdefs.h"
#include "spicelib/devices/ccvs/ccvsdefs.h"
#include "spicelib/devices/csw/cswdefs.h"
#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vcvs/vcvsdefs.h"

enum { MOST_READERS = 200, MOST_DEEP = 16 };

/* --- which they are --- */

/* The two nodes that inst, a B, E or G, drives; *gives_volts: by a voltage.  0: it is none. */
static int read_output(const GENinstance *inst, int *p, int *n, int *gives_volts) {
    const char letter = ns_bridge_models_letter(inst);
    const int *at = (const int *)(const void *)(inst + 1); /* as GENnode() has it */
    *gives_volts = letter == 'e' || (letter == 'b' && ((const ASRCinstance *)inst)->ASRCtype == ASRC_VOLTAGE);
    *p = at[0];
    *n = at[1];
    return letter == 'b' || letter == 'e' || letter == 'g';
}

/* The equation of its current; 0: it has none. */
static int branch_of(const GENinstance *inst) {
    switch (ns_bridge_models_letter(inst)) {
    case 'b':
        return ((const ASRCinstance *)inst)->ASRCtype == ASRC_VOLTAGE
                   ? ((const ASRCinstance *)inst)->ASRCbranch
                   : 0;
    case 'e':
        return ((const VCVSinstance *)inst)->VCVSbranch;
    default:
        return 0;
    }
}

/* 1 if it is among the variables of a B, as a node or a current. */
static int is_variable(const GENinstance *inst, int type, int eq) {
    const ASRCinstance *b = (const ASRCinstance *)inst;
    for (int i = 0; ns_bridge_models_letter(inst) == 'b' && i < b->ASRCtree->numVars; i++)
        if (b->ASRCtree->varTypes[i] == type && b->ASRCvars[i] == eq)
            return 1;
    return 0;
}

/* 1 if a B, E or G reads this node and does not end at it. */
static int reads(const GENinstance *inst, int node) {
    const int *at = (const int *)(const void *)(inst + 1);
    const char letter = ns_bridge_models_letter(inst);
    if (letter == 'b')
        return is_variable(inst, IF_NODE, node);
    return (letter == 'e' || letter == 'g') && (at[2] == node || at[3] == node);
}

/* 1 if the current of this equation controls inst. */
static int reads_current(const GENinstance *inst, int branch) {
    switch (ns_bridge_models_letter(inst)) {
    case 'f':
        return ((const CCCSinstance *)inst)->CCCScontBranch == branch;
    case 'h':
        return ((const CCVSinstance *)inst)->CCVScontBranch == branch;
    case 'w':
        return ((const CSWinstance *)inst)->CSWcontBranch == branch;
    default:
        return is_variable(inst, IF_INSTANCE, branch);
    }
}

/* 1 if this node is one of its terminals, those of controls included. */
static int has_terminal(const GENinstance *inst, int node) {
    const char letter = ns_bridge_models_letter(inst);
    const int *at = (const int *)(const void *)(inst + 1);
    const int terminals = letter == 'a' || letter == 'k' ? 0 : strchr("bcdfhilrvw", letter) ? 2 : 4;
    for (int k = 0; k < terminals; k++)
        if (at[k] == node)
            return 1;
    return ns_bridge_own_touches(inst, node);
}

static int is_resistor_to_ground(const GENinstance *inst) {
    const RESinstance *r = (const RESinstance *)inst;
    return ns_bridge_models_letter(inst) == 'r' && (r->RESposNode == 0 || r->RESnegNode == 0);
}

/* 1 if its value depends on what was there before. */
static int has_memory(const INPparseNode *node, int depth) {
    if (!node || node->type == PT_CONSTANT || node->type == PT_VAR)
        return 0;
    if (depth > 1000 || (node->type == PT_FUNCTION && node->funcnum == PTF_DDT))
        return 1;
    return has_memory(node->left, depth + 1) ||
           (node->type != PT_FUNCTION && has_memory(node->right, depth + 1));
}

static int has(const ns_display_list *list, const GENinstance *inst) {
    for (int k = 0; k < list->count; k++)
        if (list->inst[k] == inst)
            return 1;
    return 0;
}

/* 1 if inst acts on nothing: it and all that read its node, so often one after the other, are in *found. */
static int collect(const CKTcircuit *ckt, const GENinstance *inst, int deep, ns_display_list *found) {
    int p, n, gives_volts, resistors = 0;
    if (has(found, inst))
        return 1;
    if (deep == 0 || found->count == MOST_READERS || !read_output(inst, &p, &n, &gives_volts) ||
        (p != 0) == (n != 0) ||
        (ns_bridge_models_letter(inst) == 'b' &&
         has_memory(((const INPparseTree *)((const ASRCinstance *)inst)->ASRCtree)->tree, 0)))
        return 0;
    const int node = p != 0 ? p : n, branch = branch_of(inst);
    if (reads(inst, node))
        return 0;
    found->inst[found->count++] = inst;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *other = box->data;
        if (other == inst)
            continue;
        resistors += has_terminal(other, node) && is_resistor_to_ground(other);
        if ((branch && reads_current(other, branch)) ||
            (reads(other, node) && !collect(ckt, other, deep - 1, found)) ||
            (has_terminal(other, node) && !is_resistor_to_ground(other) && !reads(other, node)))
            return 0;
    }
    return gives_volts || resistors > 0;
}

int ns_bridge_display_may(const CKTcircuit *ckt, const GENinstance *inst, ns_display_list *list) {
    const GENinstance *room[MOST_READERS];
    ns_display_list found = {0, room};
    if (!list || has(list, inst) || !collect(ckt, inst, MOST_DEEP, &found))
        return 0;
    const GENinstance **more =
        realloc(list->inst, (size_t)(list->count + found.count) * sizeof(const GENinstance *));
    if (!more)
        return 0;
    list->inst = more;
    for (int k = 0; k < found.count; k++)
        if (!has(list, found.inst[k]))
            list->inst[list->count++] = found.inst[k];
    return 1;
}

/* --- kept --- */

/* S from this node to ground. */
static double siemens_at(const CKTcircuit *ckt, int node) {
    double sum = 0.0;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next)
        if (is_resistor_to_ground(box->data) && has_terminal(box->data, node))
            sum += ((const RESinstance *)box->data)->RESconduct;
    return sum;
}

static int is_kept(const ns_extract *ex, const GENinstance *inst) {
    for (int k = 0; k < ex->ndisplays; k++)
        if (ex->display[k].inst == inst)
            return 1;
    return 0;
}

/* 1 if it reads a node of another one that is not kept yet. */
static int waits(const ns_extract_walk *w, const GENinstance *inst) {
    int p, n, gives_volts;
    for (int k = 0; k < w->displays->count; k++) {
        const GENinstance *other = w->displays->inst[k];
        if (other != inst && read_output(other, &p, &n, &gives_volts) && reads(inst, p != 0 ? p : n) &&
            !is_kept(w->ex, other))
            return 1;
    }
    return 0;
}

static int keep(ns_extract_walk *w, const GENinstance *inst) {
    int p, n, gives_volts;
    ns_extract *ex = w->ex;
    if (waits(w, inst))
        return EXTRACT_LATER;
    ns_extract_display *more = realloc(ex->display, (size_t)(ex->ndisplays + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    ex->display = more;
    read_output(inst, &p, &n, &gives_volts);
    const int node = p != 0 ? p : n;
    const double siemens = siemens_at(w->ckt, node), sign = p != 0 ? 1.0 : -1.0;
    const double factor = ns_bridge_models_letter(inst) == 'b' ? ns_bridge_expression_factor(inst) : 1.0;
    ns_extract_display *d = &ex->display[ex->ndisplays++];
    *d = (ns_extract_display){.inst = inst,
                              .node = node,
                              .branch = branch_of(inst),
                              .gmin = w->ckt->CKTgmin,
                              .gain = factor * (gives_volts ? sign : -sign / siemens),
                              .siemens = -sign * siemens};
    ns_bridge_extract_mix(w, &d->gain, sizeof d->gain);
    ns_bridge_extract_users_name(w, inst, d->name, sizeof d->name);
    return NS_OK;
}

int ns_bridge_display_takes(ns_extract_walk *w, const GENinstance *inst, int *status) {
    if (!w->displays || !has(w->displays, inst))
        return 0;
    *status = keep(w, inst);
    return 1;
}
