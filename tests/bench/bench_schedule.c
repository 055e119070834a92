/* tests/bench/bench_schedule.c - what an instant known ahead of time costs: ns_inputs_events_next,
 * ns_inputs_events_pass and ns_inputs_events_values, by what makes it.
 *
 *   gate        one switch and one pulse that enters: four corners and two flips a period
 *   level       a pulse as the only control of a switch: two flips a period, from a table
 *   sum         the same of two pulses
 *   sine        a sine over a triangle, its own complement beside it
 *   many        2000 switches, each with a triangle of its own, evenly spread
 *
 * Median of interleaved repetitions, CPU time of this thread.
 */
#include "timing.h"

#include <math.h>

#include "inputs/time_events.h"
#include "system/active_inputs.h"

enum { KINDS = 5, REPEATS = 15, INSTANTS = 100000, MANY = 2000 };
static const char *const names[KINDS] = {"gate", "level", "sum", "sine", "many"};

static ns_system *bare(int nz, int nc) {
    ns_system *s;
    must(ns_system_create(1, nc, nz, nc, &s));
    s->M[0] = 1;
    for (int c = 0; c < nc; c++) {
        s->command[c].pair = c;
        s->command[c].on = s->command[c].off = 0.5;
        s->command[c].gz = room(sizeof(double) * (size_t)nz);
    }
    return s;
}

static void pulse(ns_system *s, int i, double td, double tr, double pw) {
    const ns_signal z = {.kind = NS_PULSE, .u.pulse = {0, 1, td, tr, tr, pw, 1e-4, 0}};
    must(ns_system_set_input(s, i, &z));
}

static ns_system *sine_over_triangle(void) {
    const ns_signal z = {.kind = NS_SIN, .u.sin = {1, 0.4, 50, 0, 0, 0}};
    ns_system *s = bare(2, 2);
    pulse(s, 0, 0, 5e-5, 0);
    must(ns_system_set_input(s, 1, &z));
    s->command[0].gz[0] = -1;
    s->command[0].gz[1] = 1;
    s->command[1].gz[0] = 1;
    s->command[1].gz[1] = -1;
    s->command[1].g0 = 1;
    return s;
}

static ns_system *system_of(int kind) {
    if (kind == 3)
        return sine_over_triangle();
    const int n = kind == 4 ? MANY : 1;
    ns_system *s = bare(kind == 2 ? 2 : n, n);
    for (int i = 0; i < n; i++) {
        pulse(s, i, i * 1e-4 / n, kind == 4 ? 5e-5 : 1e-6, kind == 4 ? 0 : 4e-5);
        s->command[i].gz[i] = 1;
    }
    if (kind == 2) {
        pulse(s, 1, 5e-5, 1e-6, 4e-5);
        s->command[0].gz[1] = 1;
    }
    if (kind == 0)
        s->E[0] = 1;
    return s;
}

static double run(ns_time_events *s, int nz) {
    static double z[MANY], dz[MANY];
    const int enters = nz == 1;
    ns_inputs_events_seek(s, 1e-3, NS_RIGHT, NULL);
    const double start = now();
    for (int k = 0; k < INSTANTS; k++) {
        if (isinf(ns_inputs_events_next(s, 1e9)))
            must(NS_E_LIMIT);
        const ns_time_event *what = ns_inputs_events_pass(s);
        if (enters)
            ns_inputs_events_values(s, what->t, z, dz);
    }
    return (now() - start) / INSTANTS;
}

int main(void) {
    ns_system *system[KINDS];
    ns_time_events *s[KINDS];
    double times[KINDS][REPEATS];
    for (int i = 0; i < KINDS; i++) {
        system[i] = system_of(i);
        unsigned char *acting = room((size_t)system[i]->nz);
        must(ns_system_active_inputs(system[i], acting));
        must(ns_inputs_events_create(system[i], acting, &s[i]));
        free(acting);
    }
    for (int k = 0; k < REPEATS; k++)
        for (int i = 0; i < KINDS; i++)
            times[i][k] = run(s[i], system[i]->nz);
    printf("%-8s %8s %12s\n", "instants", "switches", "ns/instant");
    for (int i = 0; i < KINDS; i++) {
        printf("%-8s %8d %12.1f\n", names[i], system[i]->nc, 1e9 * median(REPEATS, times[i]));
        ns_inputs_events_free(s[i]);
        ns_system_free(system[i]);
    }
    return 0;
}
