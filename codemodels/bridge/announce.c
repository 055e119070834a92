/* bridge/announce.c - what is said once of the circuit that is simulated. */
#include "announce.h"

#include "display.h"
#include "own_current.h"
#include "own_show.h"
#include "report.h"

/* What of its sources and code models is not as ngspice has it. */
static void announce_readings(ns_session *s) {
    const ns_analysis *a = &s->analysis;
    if (!s->once.circuit_announced && *a->ex.sharp.name)
        ns_bridge_report_note("%s: its corners are sharp: %s, by which ngspice rounds them, is left out, "
                              "as in the other code models",
                              a->ex.sharp.name, a->ex.sharp.what);
    if (!s->once.circuit_announced && *a->ex.curved)
        ns_bridge_report_note(
            "%s: straight lines stand for tanh, atan and 1/(1+exp(u)) of signals, within 0.25 %% "
            "of the way between their ends; so in other B",
            a->ex.curved);
    if (!s->once.steps_noted && *a->ex.stepped)
        ns_bridge_report_note(
            "%s: where it multiplies or divides by a V that ramps between two values, the ramp is a jump at "
            "its middle; so in other B",
            a->ex.stepped);
    s->once.steps_noted |= *a->ex.stepped != 0;
    if (!s->once.circuit_announced)
        ns_bridge_display_announce(&a->ex);
}

int ns_bridge_announce(ns_session *s) {
    const ns_analysis *a = &s->analysis;
    const int sweeps = (s->ckt->CKTmode & MODEDCTRANCURVE) != 0; /* models, too */
    const unsigned long long models = sweeps ? s->once.models : ns_bridge_own_hash(a);
    const int anew = !s->once.circuit_announced || (s->found.seconds > 0.0 && !s->once.currents_announced) ||
                     models != s->once.models;
    if (anew)
        ns_bridge_own_announce(a);
    s->once.models = models;
    s->once.currents_announced |= s->found.seconds > 0.0;
    if (!s->once.circuit_announced) {
        const int devices = a->ex.ndevices + a->ex.nowns;
        ns_bridge_report_note("simulates this circuit: %d unknown%s, %d ideal device%s", a->system->n,
                              a->system->n == 1 ? "" : "s", devices, devices == 1 ? "" : "s");
    }
    announce_readings(s);
    s->once.circuit_announced = 1;
    if (a->ex.options.reltol > 0.0 && a->ex.options.method == NS_THETA && !s->once.reltol_noted) {
        ns_bridge_report_note("reltol = %g has no effect: method \"theta\" uses steps of the fixed length h",
                              a->ex.options.reltol);
        s->once.reltol_noted = 1;
    }
    return ns_bridge_own_again(s, anew);
}
