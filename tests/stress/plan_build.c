/* tests/stress/plan_build.c - parts -> a circuit of the library. */
#include <math.h>
#include <string.h>

#include "dice.h"
#include "plan.h"

enum { STREAM = 9001 };

static void permute(dice *d, int *at, int first, int count) {
    for (int i = count - 1; i > first; i--) {
        const int j = first + dice_below(d, i - first + 1), kept = at[i];
        at[i] = at[j];
        at[j] = kept;
    }
}

static int names_others(const plan_part *e) {
    return strchr("kfh", e->kind) != NULL;
}

static int put(const plan_part *e, const char *name, double value, plan_built *b, int at) {
    ns_circuit *c = b->circuit;
    const int p = b->node[e->node[0]], n = b->node[e->node[1]], cp = b->node[e->node[2]],
              cn = b->node[e->node[3]];
    const int by = e->by[0] >= 0 ? b->id[e->by[0]] : -1, other = e->by[1] >= 0 ? b->id[e->by[1]] : -1;
    int *id = &b->id[at];
    switch (e->kind) {
    case 'r':
        return ns_circuit_resistor(c, name, p, n, value, id);
    case 'c':
        return ns_circuit_capacitor(c, name, p, n, value, e->ic, id);
    case 'l':
        return ns_circuit_inductor(c, name, p, n, value, e->ic, id);
    case 'k':
        return ns_circuit_coupling(c, name, by, other, value, id);
    case 'v':
        return ns_circuit_source(c, name, NS_VOLTAGE, p, n, &e->signal, id);
    case 'i':
        return ns_circuit_source(c, name, NS_CURRENT, p, n, &e->signal, id);
    case 'e':
        return ns_circuit_vcontrolled(c, name, NS_VOLTAGE, p, n, cp, cn, value, id);
    case 'g':
        return ns_circuit_vcontrolled(c, name, NS_CURRENT, p, n, cp, cn, value, id);
    case 'h':
        return ns_circuit_icontrolled(c, name, NS_VOLTAGE, p, n, by, value, id);
    case 'f':
        return ns_circuit_icontrolled(c, name, NS_CURRENT, p, n, by, value, id);
    case 'd':
        return ns_circuit_diode(c, name, p, n, &e->diode, id);
    default:
        return ns_circuit_switch(c, name, p, n, cp, cn, &e->contact, id);
    }
}

int plan_build(const plan *p, unsigned long long shuffle, double vary, plan_built *b) {
    static int order[PLAN_PARTS];
    dice d = dice_make(STREAM, shuffle);
    for (int i = 0; i < p->parts; i++)
        order[i] = i;
    for (int i = 0; i < p->nodes; i++)
        b->node[i] = i;
    if (shuffle) {
        permute(&d, order, 0, p->parts);
        permute(&d, b->node, 1, p->nodes);
    }
    int status = ns_circuit_create(&b->circuit);
    for (int pass = 0; pass < 2; pass++) /* what is named stands before what names it */
        for (int k = 0; k < p->parts && status == NS_OK; k++) {
            const plan_part *e = &p->part[order[k]];
            const double by = strchr("rlc", e->kind) ? 1 + vary * dice_either(&d) : 1;
            char name[PLAN_NAME];
            snprintf(name, sizeof name, "%.1s%x", e->name, 7919u * (unsigned)order[k] % 65521u);
            if (names_others(e) == pass)
                status = put(e, shuffle ? name : e->name, e->value * by, b, order[k]);
        }
    for (int i = 1; i < p->nodes && status == NS_OK && !shuffle; i++)
        status = ns_circuit_name_node(b->circuit, i, p->node[i]);
    return status;
}
