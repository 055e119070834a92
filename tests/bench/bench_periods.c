/* tests/bench/bench_periods.c - the twenty netlists through ngspice over a thousand periods each: CPU time
 * without ngspice's start, nonsmooth.cm beside ngspice's own models at the settings that bench_cases found
 * best.
 *
 *     bench_periods [NAME...]      cases by part of their name; none: all
 *
 * A case is run by ngspice's fastest setting whose error was at most 1e-2, and 1e-3, and by nonsmooth.cm with
 * lines=0.1 to 1e-5, three in each decade: by two, rows would differ by 1.8 from one to the next.  Errors are
 * those of .meas: of means and of extremes (ways.h); the reference has lines=1e-6. A setting of ngspice is
 * compared with the fastest of ours that is at most as far off in both. "floor" is what that ratio would be
 * if ours took nothing for its points but what ngspice itself takes for a point of a plain RC circuit.
 * Environment: NONSMOOTH_CM (build/bench/nonsmooth.cm), NGSPICE.  Reads build/bench/NAME.csv of bench_cases.
 */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "ways.h"

enum { PERIODS = 1000, LINES = 11, THEIRS = 2 };

static const char *const runs = "build/bench/run";
static const char *const lines[LINES] = {"lines=0.1",  "lines=0.05", "lines=0.02", "lines=1e-2",
                                         "lines=5e-3", "lines=2e-3", "lines=1e-3", "lines=5e-4",
                                         "lines=2e-4", "lines=1e-4", "lines=1e-5"};
static const double level[THEIRS] = {1e-2, 1e-3};

static double row_seconds; /* of ngspice alone, for one point of a plain RC circuit */

static void plain_lines(const deck_models *models, FILE *f) {
    (void)models;
    fprintf(f, "v1 1 0 1\nr1 1 2 1k\nc1 2 0 1u\n");
}

/* 200,000 points of equal length. */
static void measure_row(void) {
    const bench_case c = {.name = "plain",
                          .netlist = plain_lines,
                          .end = 0.2,
                          .unit = 1e-6,
                          .times = 1,
                          .time = {0.2},
                          .unknowns = 2,
                          .unknown = {{.vector = "v(2)"}, {.vector = "i(v1)"}}};
    way w = {
        .setting = {.unmarked = 1, .name = "plain", .models = {.diode = DECK_D}, .reltol = 1e-3, .step = 1}};
    way_run(&c, 120, WAY_RUNS, &w);
    row_seconds = (w.seconds - way_start(&c, &w)) / (double)w.result.points;
    printf("ngspice takes %.2f us for a point of a plain RC circuit (%ld points)\n", row_seconds * 1e6,
           w.result.points);
}

typedef struct outcome { /* of one way, without ngspice's start */
    double seconds;
    long points;
    way_errors off;
} outcome;

/* Runs it and prints it; 0: it did not come to its end. */
static int run_way(const bench_case *c, way *w, const rival_result *right, outcome *o) {
    way_run(c, 120, WAY_RUNS, w);
    if (w->result.end != RIVAL_DONE) {
        printf("  %-44s %s\n", w->name, w->result.end == RIVAL_TIMEOUT ? "over its time" : "aborted");
        return 0;
    }
    *o = (outcome){fmax(w->seconds - way_start(c, w), 1e-4), w->result.points,
                   way_errors_of(c, &w->result, right)};
    printf("  %-44s %9ld %9.1f %10.2e %10.2e\n", w->name, w->result.points, o->seconds * 1e3, o->off.mean,
           o->off.extreme);
    return 1;
}

/* How many times less CPU the fastest of ours takes that is at most as far off; 0: there is none.  *floor: if
 * it took nothing but ngspice's own time for its points. */
static double ratio_to(const outcome *theirs, const outcome *ours, const int *done, double *floor) {
    int best = -1;
    for (int k = 0; k < LINES; k++)
        if (done[k] && ours[k].off.mean <= theirs->off.mean && ours[k].off.extreme <= theirs->off.extreme &&
            (best < 0 || ours[k].seconds < ours[best].seconds))
            best = k;
    *floor = best < 0 ? 0 : theirs->seconds / (row_seconds * (double)ours[best].points);
    return best < 0 ? 0 : theirs->seconds / ours[best].seconds;
}

/* ratio, floor (THEIRS): 0 where there is nothing to compare. */
static void run_case(bench_case *c, double *ratio, double *floor) {
    way reference = way_ours("", 1, "lines=1e-6");
    outcome ours[LINES];
    int done[LINES];
    c->end = PERIODS * c->unit;
    c->times = 1;
    c->time[0] = c->end;
    printf("\n== %s: %s (%g s)\n", c->name, c->title, c->end);
    printf("  %-44s %9s %9s %10s %10s\n", "", "rows", "ms CPU", "mean", "extremes");
    way_run(c, 120, 1, &reference);
    if (reference.result.end != RIVAL_DONE) {
        printf("  no reference\n");
        return;
    }
    for (int k = 0; k < LINES; k++) {
        way w = way_ours(lines[k], 1, lines[k]);
        done[k] = run_way(c, &w, &reference.result, &ours[k]);
    }
    for (int k = 0; k < THEIRS; k++) {
        way w;
        outcome theirs;
        if (!way_theirs(c, level[k], &w) || !run_way(c, &w, &reference.result, &theirs))
            continue;
        ratio[k] = ratio_to(&theirs, ours, done, &floor[k]);
        printf("  %-44s times the CPU of ours at its error: %.3g (floor %.3g)\n", "", ratio[k], floor[k]);
    }
    fflush(stdout);
}

static int asked(const bench_case *c, int count, char **names) {
    for (int i = 0; i < count; i++)
        if (strstr(c->name, names[i]))
            return 1;
    return count == 0 && c->through;
}

int main(int argc, char **argv) {
    const char *models = getenv("NONSMOOTH_CM");
    double product[THEIRS] = {0}, of_floor[THEIRS] = {0};
    int count[THEIRS] = {0};
    bench_case c;
    char cm[4096];
    if (!realpath(models ? models : "build/bench/nonsmooth.cm", cm)) {
        perror("nonsmooth.cm");
        return 1;
    }
    (void)mkdir(runs, 0777);
    rival_home(runs, cm);
    measure_row();
    for (int i = 0; case_make(i, 0, &c); i++) {
        double ratio[THEIRS] = {0}, floor[THEIRS] = {0};
        if (asked(&c, argc - 1, argv + 1))
            run_case(&c, ratio, floor);
        for (int k = 0; k < THEIRS; k++) {
            product[k] += ratio[k] > 0 ? log(ratio[k]) : 0;
            of_floor[k] += ratio[k] > 0 ? log(floor[k]) : 0;
            count[k] += ratio[k] > 0;
        }
        case_free(&c);
    }
    for (int k = 0; k < THEIRS && count[k] > 0; k++)
        printf(
            "\nCPU of ngspice's fastest setting with an error of at most %g over ours, geometric mean of %d: "
            "%.3g (goal 15; floor %.3g)\n",
            level[k], count[k], exp(product[k] / count[k]), exp(of_floor[k] / count[k]));
    return 0;
}
