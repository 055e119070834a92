/* bridge/many_points.c - one line about a run whose waveforms need millions of timepoints.
 *
 * The number of points is looked at seldom.  If there will be too many, the signal that asked for most of
 * them is followed over two of its periods, and what makes these is said. */
#include "many_points.h"

#include <math.h>
#include <string.h>

#include "report.h"

static const double too_many = 1e6;

enum {
    FIRST_LOOK = 50000,   /* points; a judgement from twice as many on */
    MOST_FOLLOWED = 20000 /* points, if no period is found */
};

/* As a user writes it: v(out), i(l1). */
static void name_signal(const ns_analysis *a, int signal, char *name, size_t size) {
    char line[200];
    if (signal < a->system->n)
        ns_circuit_name_unknown(a->ex.circuit, signal, line, sizeof line);
    else
        ns_circuit_name_pair(a->ex.circuit, signal - a->system->n, line, sizeof line);
    const char *last = strrchr(line, ' ');
    snprintf(name, size, "%c(%s)", strncmp(line, "voltage", 7) == 0 ? 'v' : 'i', last ? last + 1 : line);
}

/* "which rings at 1e+06 Hz (l1, c1)", and what to do about that. */
static void describe(const ns_analysis *a, char *line, size_t size, const char **remedy) {
    const ns_ring *ring = a->many.ring;
    const double period = ring ? ns_bridge_ring_period(ring) : 0.0;
    char elements[200] = "";
    *line = '\0';
    *remedy = "";
    if (!(period > 0.0))
        return;
    if (ns_bridge_ring_elements(ring, a->ex.circuit, elements, sizeof elements) || !*elements) {
        snprintf(line, size, ", which swings at %.4g Hz", 1.0 / period);
        return;
    }
    snprintf(line, size, ", which rings at %.4g Hz (%s)", 1.0 / period, elements);
    *remedy = "a resistor that damps it, ";
}

/* 1 if most of the points were asked for by option squares. */
static int of_squares(const ns_analysis *a) {
    const ns_waveform_counts c = ns_waveform_read_counts(a->waveform);
    return 2 * c.by_squares > c.points;
}

/* Where they crowd at an instant nobody knows how many: "more than 1000". */
static void count_expected(const ns_analysis *a, char *text, size_t size) {
    static const double most = 1e9;
    if (a->many.expected <= most)
        snprintf(text, size, "some %.0f", 1e-6 * a->many.expected);
    else
        snprintf(text, size, "more than %.0f", 1e-6 * most);
}

/* "lines=0.001 or ", unless it is at its largest. */
static void name_option(const ns_analysis *a, int squares, char *text, size_t size) {
    static const double most = 0.1;
    const double value = squares ? a->ex.options.squares : a->ex.options.lines;
    *text = '\0';
    if (value < most)
        snprintf(text, size, "%s=%g or ", squares ? "squares" : "lines", fmin(10.0 * value, most));
}

static void say(ns_analysis *a) {
    char signal[220], what[300], expected[40], option[40];
    const char *remedy;
    const int squares = of_squares(a);

    name_signal(a, a->many.signal, signal, sizeof signal);
    describe(a, what, sizeof what, &remedy);
    count_expected(a, expected, sizeof expected);
    name_option(a, squares, option, sizeof option);
    ns_bridge_report_note("%s million timepoints are to be expected, most of them for %s%s%s; "
                          "%s%spoints=\"grid\" makes them fewer",
                          expected, squares ? "the square of " : "", signal, what, remedy, option);
    ns_bridge_ring_free(a->many.ring);
    a->many.ring = NULL;
    a->many.said = 1;
}

/* Most of them are those that .tran itself asks for. */
static int are_of_tmax(const ns_analysis *a, double left) {
    return a->many.tmax > 0.0 && left / a->many.tmax > 0.5 * (a->many.expected - (double)a->many.points);
}

static void say_tmax(ns_analysis *a) {
    char expected[40];
    count_expected(a, expected, sizeof expected);
    ns_bridge_report_note(
        "%s million timepoints are to be expected: .tran has tmax = %.4g s; without it they "
        "stand where the waveform needs them",
        expected, a->many.tmax);
    a->many.said = 1;
}

/* How many there will be if they go on as since the last look. */
static void look(ns_analysis *a, double t, double stop) {
    const double since = (double)(a->many.points - a->many.looked);
    const ns_waveform_counts c = ns_waveform_read_counts(a->waveform);
    a->many.expected = (double)a->many.points +
                       (t > a->many.looked_t ? since * (stop - t) / (t - a->many.looked_t) : INFINITY);
    const int judges = a->many.looked > 0 && a->many.expected > too_many;
    a->many.looked = a->many.points;
    a->many.looked_t = t;
    if (judges && are_of_tmax(a, stop - t))
        say_tmax(a);
    else if (judges && c.busiest >= 0 && !ns_bridge_ring_create(a->system->n, &a->many.ring))
        a->many.signal = c.busiest;
}

static void follow(ns_analysis *a, const ns_waveform_point *p) {
    const int n = a->system->n, k = a->many.signal;
    ns_bridge_ring_add(a->many.ring, p->t, k < n ? p->x[k] : p->lambda[k - n], p->x);
    if (ns_bridge_ring_period(a->many.ring) > 0.0 || a->many.points - a->many.looked >= MOST_FOLLOWED)
        say(a);
}

void ns_bridge_many_points_count(ns_analysis *a, const ns_waveform_point *p, double stop) {
    a->many.points++;
    if (a->many.ring)
        follow(a, p);
    else if (!a->many.said && a->many.points >= (a->many.looked > 0 ? 2 * a->many.looked : FIRST_LOOK))
        look(a, p->t, stop);
}

void ns_bridge_many_points_continue(ns_analysis *a, const ns_analysis *from) {
    a->many = from->many;
    a->many.ring = NULL;
}

void ns_bridge_many_points_clear(ns_analysis *a) {
    ns_bridge_ring_free(a->many.ring);
}
