/* bridge/start_check.c - is the operating point one?  Where switches and comparators contradict each other in
 * each state that they may have there is none, and the march leaves the last one that was tried in no time.
 * And where a latch may be in either of its states, the equations have a solution between them as well.
 */
#include "session.h"

#include "own_current.h"
#include "report.h"

#include <math.h>
#include <string.h>

/* A difference that counts: of the largest voltage, and V: more than leaks make where sources begin at 0. */
static const double much = 1e-3, least = 1e-6;

/* Unknowns and pairs: in larger circuits one more operating point costs too much. */
enum { MOST_FIXED = 200 };

/* The node whose voltages in x and y differ most, by more than that: its unknown; -1: none does. */
static int find_jump(const ns_analysis *a, const double *x, const double *y) {
    double largest = 0.0, most = 0.0;
    int found = -1;
    for (int eq = 0; eq < a->ex.neq; eq++) {
        const int at = a->unknown[eq];
        if (at < 0 || a->ex.element[eq] >= 0)
            continue;
        largest = fmax(largest, fmax(fabs(x[at]), fabs(y[at])));
        if (fabs(x[at] - y[at]) > most) {
            most = fabs(x[at] - y[at]);
            found = at;
        }
    }
    return most > fmax(much * largest, least) ? found : -1;
}

/* 1 if the circuit has commands that follow from its state. */
static int has_commands(const ns_system *s) {
    for (int c = 0; c < s->nc; c++)
        if (s->command[c].gx)
            return 1;
    return 0;
}

/* The pair of a command that is not as its control in x says; -1: there is none. */
static int find_contradicted(const ns_system *s, const ns_mode *mode, const double *x) {
    for (int c = 0; c < s->nc; c++) {
        const ns_command *k = &s->command[c];
        const int closed = mode[k->pair] != NS_LOWER;
        const double at = closed ? k->off : k->on;
        double g = k->g0;
        for (int j = 0; k->gx && j < s->n; j++)
            g += k->gx[j] * x[j];
        for (int j = 0; k->gz && j < s->nz; j++)
            g += k->gz[j] * ns_signal_value(&s->z[j], 0.0, NS_RIGHT);
        if ((closed ? at - g : g - at) > fmax(much * fmax(fabs(g), fabs(at)), least))
            return k->pair;
    }
    return -1;
}

/* y: the operating point with all switches as .tran starts with them, whatever their controls say.  Where
 * the charges of a start hide that these contradict each other, they do so there. */
static int find_hidden(const ns_analysis *a, double *y) {
    const ns_march_options o = {.theta = 1.0, .gamma = 1.0, .h = 1e-6, .method = NS_AUTO};
    const ns_mode *mode = ns_march_mode(a->march);
    ns_system fixed = *a->system;
    ns_march *march = NULL;
    int found = -1;
    if (fixed.n + fixed.m > MOST_FIXED || !(fixed.command = calloc((size_t)fixed.nc, sizeof *fixed.command)))
        return -1;
    for (int c = 0; c < fixed.nc; c++) {
        fixed.command[c] = a->system->command[c];
        fixed.command[c].on = fixed.command[c].off = mode[fixed.command[c].pair] == NS_LOWER ? 1e300 : -1e300;
    }
    if (ns_march_create(&fixed, &o, &march, NULL) == NS_OK &&
        ns_march_start_dc(march, 0.0, 0, NULL, NULL, y) == NS_OK && find_jump(a, a->x, y) >= 0)
        found = find_contradicted(a->system, mode, y);
    ns_march_free(march);
    free(fixed.command);
    return found;
}

void ns_bridge_start_check(const ns_session *s, int may_rest_between) {
    const ns_analysis *a = &s->analysis;
    double *y = a->held.n > 0 || !has_commands(a->system) ? NULL : calloc(a->count + 1, sizeof *y);
    char name[200];
    if (!y)
        return;
    /* A node between open devices may have another voltage where .tran starts: that contradicts nothing. */
    const int reads = ns_march_read(a->march, NULL, y, NULL, NULL) == NS_OK &&
                      find_contradicted(a->system, ns_march_mode(a->march), a->x) >= 0;
    const int at = reads ? find_jump(a, a->x, y) : -1;
    const int pair = at < 0 && !may_rest_between ? find_hidden(a, y) : -1;
    if (at >= 0 && ns_circuit_name_unknown(a->ex.circuit, at, name, sizeof name) > 0)
        ns_bridge_report_note("no operating point was found, switches or comparators contradict each other: "
                              "the %s is %.4g V in "
                              "the point that is shown, and becomes %.4g V where .tran starts; to start from "
                              "another point, give "
                              "uic and .ic",
                              name, a->x[at], y[at]);
    if (pair >= 0 && ns_circuit_name_pair(a->ex.circuit, pair, name, sizeof name) > 0)
        ns_bridge_report_note(
            "no operating point was found: open or closed, %s makes its own control say the opposite; .tran "
            "starts from the point that is shown; to start from another point, give uic and .ic",
            name);
    free(y);
}

/* 1 if a choice is between its two values: it has lambda = 0 in one of them, y = 0 in the other one. */
static int is_between(double lambda, double y) {
    static const double part = 1e-6;
    return fmin(fabs(lambda), fabs(y)) > part * fmax(fabs(lambda), fabs(y));
}

int ns_bridge_start_check_latches(const ns_session *s) {
    const ns_analysis *a = &s->analysis;
    const int m = a->system->m;
    double *lambda = a->system->nc > 0 ? calloc(2 * (size_t)m + 1, sizeof *lambda) : NULL;
    char name[200];
    int found = 0;
    if (!lambda)
        return 0;
    const int read = ns_march_read(a->march, NULL, NULL, lambda, lambda + m) == NS_OK;
    for (int c = 0; c < a->system->nc && read && !found; c++) {
        const int pair = a->system->command[c].pair;
        ns_circuit_name_pair(a->ex.circuit, pair, name, sizeof name);
        found = strncmp(name, "choice", 6) == 0 && is_between(lambda[pair], lambda[m + pair]);
    }
    if (found)
        ns_bridge_report_note(
            "%s begins at its threshold, between its two values: a latch can hold either of them; "
            "give .ic and uic",
            name);
    free(lambda);
    return found;
}

int ns_bridge_start_check_uic(const ns_analysis *a) {
    const double run = 1.0; /* s: nothing is marched */
    ns_march *march = NULL;
    double *w0 = calloc((size_t)a->system->n + 1, sizeof *w0);
    const int starts = w0 && ns_circuit_rest(a->ex.circuit, w0) == NS_OK &&
                       ns_bridge_own_pass_march(a, run, &march) == NS_OK &&
                       ns_march_start(march, 0.0, w0) == NS_OK;
    ns_march_free(march);
    free(w0);
    return starts;
}
