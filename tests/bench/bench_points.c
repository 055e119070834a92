/* tests/bench/bench_points.c - the choice of time points: the twenty netlists through ngspice with
 * points="auto" and with points="grid", beside ngspice's own models at the setting that bench_cases found
 * best.
 *
 *     bench_points [NAME...]       cases by part of their name; none: all
 *
 * Of every run: rows, CPU time of the process (the median of some), and how far off .meas is: the means,
 * relative to the mean of the absolute value, and the extremes, relative to the largest absolute value; the
 * worst unknown. Reference: lines=1e-8, cross-checked by a grid of unit/2000 (`apart`: what both differ by,
 * and its own error). Environment: NONSMOOTH_CM (build/bench/nonsmooth.cm), NGSPICE.  Reads
 * build/bench/NAME.csv of bench_cases. */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "ways.h"

enum { WAYS = 6 };
static const char *const runs = "build/bench/run";

static void print_way(const bench_case *c, const way *w, const rival_result *right) {
    if (w->result.end != RIVAL_DONE) {
        printf("  %-44s %s\n", w->name, w->result.end == RIVAL_TIMEOUT ? "over its time" : "aborted");
        return;
    }
    const way_errors e = way_errors_of(c, &w->result, right);
    printf("  %-44s %9ld %9.1f %10.2e %10.2e\n", w->name, w->result.points, w->seconds * 1e3, e.mean,
           e.extreme);
}

/* Returns the reference: by lines, if that came to its end, else by the grid. */
static const rival_result *print_reference(const bench_case *c, const way *lines, const way *grid) {
    if (lines->result.end != RIVAL_DONE || grid->result.end != RIVAL_DONE) {
        printf("  %-44s not compared: lines=1e-8 %s\n", "reference",
               lines->result.end == RIVAL_DONE ? "alone came to its end"
                                               : "took too long, a fine grid instead");
        return lines->result.end == RIVAL_DONE ? &lines->result : &grid->result;
    }
    const way_errors e = way_errors_of(c, &grid->result, &lines->result);
    printf("  %-44s %9ld rows, a grid of %ld apart: mean %.2e, extremes %.2e\n", "reference",
           lines->result.points, grid->result.points, e.mean, e.extreme);
    return &lines->result;
}

/* Returns how many times less CPU time auto takes than the grid of unit/20; 0: one of them failed. */
static double run_case(const bench_case *c) {
    way lines = way_ours("", 1, "lines=1e-8"), fine = way_ours("", 1 / 2000.0, "points=\"grid\"");
    way all[WAYS] = {way_ours("points=\"auto\" .tran unit", 1, "points=\"auto\""),
                     way_ours("points=\"auto\" .tran unit/20", 1 / 20.0, "points=\"auto\""),
                     way_ours("points=\"grid\" .tran unit", 1, "points=\"grid\""),
                     way_ours("points=\"grid\" .tran unit/20", 1 / 20.0, "points=\"grid\""),
                     way_ours("points=\"grid\" .tran unit/200", 1 / 200.0, "points=\"grid\"")};
    const int count = way_theirs(c, 1e-2, &all[WAYS - 1]) ? WAYS : WAYS - 1;
    printf("\n== %s: %s (%g s, unit %g s)\n", c->name, c->title, c->end, c->unit);
    printf("  %-44s %9s %9s %10s %10s\n", "", "rows", "ms CPU", "mean", "extremes");
    way_run(c, 60, 1, &lines);
    way_run(c, 60, 1, &fine);
    const rival_result *right = print_reference(c, &lines, &fine);
    for (int k = 0; k < count; k++) {
        way_run(c, 20, WAY_RUNS, &all[k]);
        print_way(c, &all[k], right);
    }
    fflush(stdout);
    return all[1].result.end == RIVAL_DONE && all[3].result.end == RIVAL_DONE
               ? all[3].seconds / all[1].seconds
               : 0;
}

/* --- a converter of 20 kHz, with steps of 1 ns for 10 ms --- */

static void fine_netlist(const deck_models *m, FILE *f) {
    (void)m;
    fprintf(f, "v1 in 0 48\nvg g 0 pulse(0 1 0 1n 1n 20u 50u)\nas1 in x g 0 s\nad1 0 x d\nl1 x out 100u\n"
               "c1 out 0 100u\nr1 out 0 5\n.model s ideal_switch\n.model d ideal_diode\n");
}

static int run_fine(void) {
    bench_case c = {.name = "fine", .end = 10e-3, .unit = 1e-9, .times = 1, .unknowns = 2};
    way w = way_ours("20 kHz converter, .tran 1n 10m", 1, NULL);
    c.netlist = fine_netlist;
    c.time[0] = c.end;
    snprintf(c.unknown[0].vector, sizeof c.unknown->vector, "v(out)");
    snprintf(c.unknown[1].vector, sizeof c.unknown->vector, "i(l1)");
    way_run(&c, 20, 1, &w);
    const int good = w.result.end == RIVAL_DONE && w.seconds < 1;
    printf("\n%s: %ld rows, %.3f s of CPU, goal 1 s: %s\n", w.name, w.result.points, w.seconds,
           good ? "reached" : "not reached");
    return good;
}

static int asked(const bench_case *c, int count, char **names) {
    for (int i = 0; i < count; i++)
        if (strstr(c->name, names[i]))
            return 1;
    return count == 0 && c->through;
}

int main(int argc, char **argv) {
    const char *models = getenv("NONSMOOTH_CM");
    double product = 0;
    int count = 0;
    bench_case c;
    char cm[4096];
    if (!realpath(models ? models : "build/bench/nonsmooth.cm", cm)) {
        perror("nonsmooth.cm");
        return 1;
    }
    (void)mkdir(runs, 0777);
    rival_home(runs, cm);
    for (int i = 0; case_make(i, 0, &c); i++) {
        const double ratio = asked(&c, argc - 1, argv + 1) ? run_case(&c) : 0;
        product += ratio > 0 ? log(ratio) : 0;
        count += ratio > 0;
        case_free(&c);
    }
    if (count > 0)
        printf("\nCPU of the grid of unit/20 over that of points=\"auto\" on the same line, geometric mean "
               "of %d: "
               "%.3g\n",
               count, exp(product / count));
    return argc > 1 || run_fine() ? 0 : 1;
}
