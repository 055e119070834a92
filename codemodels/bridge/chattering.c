/* bridge/chattering.c - one line about a comparator in a loop without hysteresis, which no engine but the
 * scheme passes: there it changes some four times a step, and the run takes long.
 *
 * A switch that does so slides or is refused by the engines; a choice of two values is not seen to. */
#include "chattering.h"

#include <string.h>

#include "pure/timepoints.h"
#include "report.h"

enum { ENOUGH = 4000 }; /* changes; in less time than so many steps */

static int begin(ns_analysis *a, const ns_mode *mode) {
    const size_t m = (size_t)a->system->m + 1;
    if (!a->chatter.mode)
        a->chatter.mode = malloc(m * sizeof *a->chatter.mode);
    if (!a->chatter.changes)
        a->chatter.changes = calloc(m, sizeof *a->chatter.changes);
    if (!a->chatter.mode || !a->chatter.changes)
        return 0;
    memcpy(a->chatter.mode, mode, (m - 1) * sizeof *mode);
    return 1;
}

/* The pair that changed most often. */
static int busiest(const ns_analysis *a) {
    int most = 0;
    for (int k = 1; k < a->system->m; k++)
        most = a->chatter.changes[k] > a->chatter.changes[most] ? k : most;
    return most;
}

static void say(ns_analysis *a, double seconds) {
    char name[200];
    const int k = busiest(a);
    ns_circuit_name_pair(a->ex.circuit, k, name, sizeof name);
    ns_bridge_report_note(
        "%s changes some %.0e times a second, as often as the steps allow: a comparator in a loop "
        "without hysteresis, which takes long; give it some: v(a) > v(b) - 10m*v(out), v(out) "
        "its own output",
        name, (double)a->chatter.changes[k] / seconds);
    a->chatter.said = 1;
}

void ns_bridge_chattering_count(ns_analysis *a, const ns_waveform_point *p, double stop) {
    if (a->chatter.said || ns_march_engine(a->march) != NS_THETA || a->ex.options.method == NS_THETA)
        return;
    if (!a->chatter.mode && !begin(a, p->mode))
        return;
    for (int k = 0; k < a->system->m; k++) {
        const int changed = a->chatter.mode[k] != p->mode[k];
        a->chatter.changes[k] += changed;
        a->chatter.all += changed;
        a->chatter.mode[k] = p->mode[k];
    }
    if (a->chatter.all < ENOUGH)
        return;
    const double seconds = p->t - a->chatter.since;
    if (seconds < ENOUGH * ns_bridge_timepoints_longest_step(a->system, stop))
        say(a, seconds);
    memset(a->chatter.changes, 0, (size_t)a->system->m * sizeof *a->chatter.changes);
    a->chatter.all = 0;
    a->chatter.since = p->t;
}

void ns_bridge_chattering_clear(ns_analysis *a) {
    free(a->chatter.mode);
    free(a->chatter.changes);
}
