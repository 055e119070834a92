/* bridge/own_current_alike.c - currents that a first pass found: in round numbers, alike for D that are;
 * those of D in parallel. */
#include <math.h>

#include "own_current.h"
#include "own_structs.h"

/* 1, 1.5, 2, 3, 5 or 7 times a power of ten. */
static double round_current(double amperes) {
    static const double digit[] = {1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0};
    const double power = pow(10.0, floor(log10(amperes)));
    double best = power;
    for (size_t k = 0; k < sizeof digit / sizeof digit[0]; k++)
        if (fabs(log(digit[k] * power / amperes)) < fabs(log(best / amperes)))
            best = digit[k] * power;
    return best;
}

/* The smallest current of those that are in no group; NULL: there is none. */
static const ns_own_current *find_smallest(const ns_own_found *currents, const unsigned char *grouped) {
    const ns_own_current *smallest = NULL;
    for (int k = 0; k < currents->count; k++)
        if (!grouped[k] && (!smallest || currents->of[k].id < smallest->id))
            smallest = &currents->of[k];
    return smallest;
}

void ns_bridge_own_round_in_groups(ns_own_found *currents, unsigned char *grouped) {
    static const double nearly = 1.25;
    for (const ns_own_current *of; (of = find_smallest(currents, grouped)) != NULL;) {
        const ns_own_current first = *of;
        ns_log_mean mean = {0};
        double rush = 0.0, blocks = 0.0;
        for (int k = 0; k < currents->count; k++) {
            const ns_own_current *c = &currents->of[k];
            if (grouped[k] || c->inst->GENmodPtr != first.inst->GENmodPtr || c->faint != first.faint ||
                c->path != first.path || c->id > nearly * first.id)
                continue;
            grouped[k] = 2;
            mean.coulombs += 1.0;
            mean.sum += log(c->id);
            mean.most = fmax(mean.most, c->most);
            rush = fmax(rush, c->rush);
            blocks = fmax(blocks, c->blocks);
        }
        for (int k = 0; k < currents->count; k++) {
            ns_own_current *c = &currents->of[k];
            if (grouped[k] != 2)
                continue;
            grouped[k] = 1;
            c->id = c->faint ? c->id : round_current(ns_bridge_log_mean_read(&mean));
            c->most = round_current(mean.most);
            c->rush = round_current(rush);
            c->blocks = blocks;
        }
    }
}

enum { JUNCTIONS = 2 };

/* The nodes between which an instance has junctions; how many. */
static int find_junctions(const GENinstance *inst, int anode[JUNCTIONS], int cathode[JUNCTIONS]) {
    if (ns_bridge_own_kind(inst) != OWN_MOSFET) {
        ns_own_diode d;
        ns_bridge_own_read_diode(inst, &d);
        anode[0] = d.anode;
        cathode[0] = d.cathode;
        return 1;
    }
    ns_own_mosfet m;
    ns_bridge_own_read_mosfet(inst, &m);
    anode[0] = m.body.anode;
    cathode[0] = m.body.cathode;
    anode[1] = m.at_source.anode;
    cathode[1] = m.at_source.cathode;
    return anode[1] != cathode[1] ? JUNCTIONS : 1;
}

static int are_parallel(const GENinstance *inst, const GENinstance *other) {
    int anode[2][JUNCTIONS], cathode[2][JUNCTIONS], parallel = 0;
    const int count = find_junctions(inst, anode[0], cathode[0]),
              others = find_junctions(other, anode[1], cathode[1]);
    for (int i = 0; i < count; i++)
        for (int k = 0; k < others; k++)
            parallel |= anode[0][i] == anode[1][k] && cathode[0][i] == cathode[1][k];
    return parallel;
}

double ns_bridge_own_parallel_current(const ns_own_found *currents, const GENinstance *inst) {
    double most = 0.0;
    for (int k = 0; currents && k < currents->count; k++) {
        const ns_own_current *c = &currents->of[k];
        if (c->inst != inst && c->path == OWN_FORWARDS && !c->faint && c->id > most &&
            are_parallel(inst, c->inst))
            most = c->id;
    }
    return most;
}
