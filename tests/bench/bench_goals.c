/* tests/bench/bench_goals.c - the last table: what was to be shown, and what was measured, in this run.
 *
 * Reads build/bench/CASE.csv and facts.csv, which the other programs have just written; nothing is measured
 * here.  Figures of Pulsim 1.8, which is not run here, are quoted and say so.
 *
 * ours      the fastest run of any engine that reaches the error of the goal, else the most accurate one,
 * with its engine; and what `auto` does, the default, at the tolerance that is fastest for that error others
 * the fastest run of another program with an error below 1 %, else its most accurate */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "facts.h"
#include "results.h"

enum { TEXT = 160 };
static const double useful = 1e-2;

static FILE *csv;
static int rows, reached_rows;

static void line(const char *what, const char *ours, const char *by_auto, const char *others,
                 const char *goal, int reached) {
    printf("%-30s | %-40s | %-20s | %-58s | %-22s | %s\n", what, ours, by_auto, others, goal,
           reached ? "yes" : "no");
    fprintf(csv, "%s;%s;%s;%s;%s;%s\n", what, ours, by_auto, others, goal, reached ? "yes" : "no");
    rows++;
    reached_rows += reached;
}

/* --- cases --- */

static const result_row *pick(const results *r, row_kind kind, const char *series, double level) {
    const result_row *fast = results_fastest(r, kind, series, level);
    return fast ? fast : results_best(r, kind, series);
}

static void describe(const result_row *r, int named, char *text) {
    if (!r)
        snprintf(text, TEXT, "none");
    else if (!named)
        snprintf(text, TEXT, "%.3g ms %.1e", r->seconds * 1e3, r->error);
    else if (r->kind == ROW_LIBRARY)
        snprintf(text, TEXT, "%.3g ms %.1e %s %s", r->seconds * 1e3, r->error, r->series, r->setting);
    else
        snprintf(text, TEXT, "%s%s %s: %.3g ms %.1e", strncmp(r->series, "Siconos", 7) == 0 ? "" : "ngspice ",
                 r->series, r->setting, r->seconds * 1e3, r->error);
}

typedef struct target {
    const char *what, *name; /* of the row, of the case */
    double time, error;      /* s */
    const char *quoted;      /* elsewhere */
    int only_auto;
} target;

static void add_quoted(char *others, const char *quoted) {
    if (quoted)
        snprintf(others + strlen(others), 2 * TEXT - strlen(others), "; quoted: %s", quoted);
}

static void case_row(const target *t) {
    static results r;
    char ours[TEXT], by_auto[TEXT], others[2 * TEXT], goal[TEXT];
    results_read(t->name, &r);
    const result_row *best = pick(&r, ROW_LIBRARY, t->only_auto ? "auto" : NULL, t->error);
    describe(best, 1, ours);
    describe(pick(&r, ROW_LIBRARY, "auto", t->error), 0, by_auto);
    describe(pick(&r, ROW_RIVAL, NULL, useful), 1, others);
    add_quoted(others, t->quoted);
    snprintf(goal, sizeof goal, "%.3g ms at %.0e", t->time * 1e3, t->error);
    line(t->what, ours, by_auto, others, goal, best && best->seconds <= t->time && best->error <= t->error);
}

/* ngspice as it comes: D with n = 1, trap, reltol 1e-3, at the longest steps. */
static void untuned(const results *r, char *text) {
    for (int i = 0; i < r->count; i++)
        if (strcmp(r->row[i].series, "D n=1 trap") == 0) {
            if (r->row[i].done)
                snprintf(text, TEXT, "untuned %.3g ms %.1e", r->row[i].seconds * 1e3, r->row[i].error);
            else
                snprintf(text, TEXT, "untuned %s", r->row[i].end);
            return;
        }
    snprintf(text, TEXT, "untuned not run");
}

static void leg_row(int cells) {
    static results r;
    char what[TEXT], name[24], ours[TEXT], by_auto[TEXT], others[2 * TEXT], plain[TEXT];
    snprintf(what, sizeof what, "multilevel leg, N = %d", cells);
    snprintf(name, sizeof name, "multilevel%d", cells);
    results_read(name, &r);
    const result_row *rival = pick(&r, ROW_RIVAL, NULL, useful);
    const double level = rival ? rival->error : useful;
    const result_row *best = pick(&r, ROW_LIBRARY, NULL, level);
    describe(best, 1, ours);
    describe(pick(&r, ROW_LIBRARY, "auto", level), 0, by_auto);
    describe(rival, 1, others);
    untuned(&r, plain);
    snprintf(others + strlen(others), sizeof others - strlen(others), "; %s", plain);
    line(what, ours, by_auto, others, "10 x faster, untuned",
         best && best->error <= level && (!rival || rival->seconds >= 10 * best->seconds));
}

/* --- single figures --- */

/* Of the others' run of a case with the most points: the time of one. */
static void time_of_point(const char *name, char *text) {
    static results r;
    const result_row *best = NULL;
    results_read(name, &r);
    for (int i = 0; i < r.count; i++)
        if (r.row[i].kind == ROW_RIVAL && r.row[i].done && (!best || r.row[i].steps > best->steps))
            best = &r.row[i];
    if (best)
        snprintf(text, TEXT, "%s %s: %.3g us a point", best->series, best->setting,
                 best->seconds * 1e6 / (double)best->steps);
    else
        snprintf(text, TEXT, "none measured");
}

static void step_row(const char *what, const char *fact, double goal, const char *others) {
    char ours[TEXT], aim[TEXT];
    const double time = fact_get(fact);
    snprintf(ours, sizeof ours, "%.3g us", time * 1e6);
    snprintf(aim, sizeof aim, "%.3g us", goal * 1e6);
    line(what, ours, "", others, aim, time <= goal);
}

static void lc_step(void) {
    char others[2 * TEXT], siconos[TEXT];
    time_of_point("lc_bridge", siconos);
    snprintf(others, sizeof others, "bare C loop of cached maps %.3g us; %s",
             fact_get("theta 1 cached") * 1e6, siconos);
    step_row("theta step, LC bridge", "theta 1 capture", 0.04e-6, others);
}

static void number_row(const char *what, const char *fact, const char *others, double most,
                       const char *largest) {
    char ours[TEXT], goal[TEXT];
    const double value = fact_get(fact);
    snprintf(ours, sizeof ours, "%.3g", value);
    if (largest)
        snprintf(ours + strlen(ours), sizeof ours - strlen(ours), " (up to N = %.0f)", fact_get(largest));
    snprintf(goal, sizeof goal, largest ? "1 (<= %.3g, N = 10000)" : "%.3g", most);
    line(what, ours, "", others, goal, value <= most && (!largest || fact_get(largest) >= 10000));
}

static void growth_rows(void) {
    number_row("ladders: exponent of time", "ladders auto time", "quoted: Pulsim 1.8 exception at 65", 1.15,
               "ladders auto largest");
    number_row("ladders: exponent of memory", "ladders auto memory", "quoted: Pulsim 1.8 2^N", 1.15,
               "ladders auto largest");
    number_row("chains: exponent of time", "chains time", "", 1.15, "chains largest");
    number_row("chains: exponent of memory", "chains memory", "", 1.15, "chains largest");
}

static void through_row(void) {
    char what[TEXT], ours[TEXT], others[TEXT];
    const double cpu = fact_get("through cpu"), error = fact_get("through error");
    const double all = fact_get("through netlists"), failed = fact_get("through ours failed");
    snprintf(what, sizeof what, "through ngspice, %.0f netlists", all);
    const double compared = fact_get("through compared");
    snprintf(ours, sizeof ours,
             "CPU / %.3g (without start-up %.3g; start-up alone: %.3g), error / %.3g, of %.0f, %.0f failed",
             cpu, fact_get("through run"), fact_get("through start"), error, compared, failed);
    snprintf(others, sizeof others, "ngspice's best of each; %.0f settings failed",
             fact_get("through others failed"));
    line(what, ours, "", others, "CPU / 10, error / 100",
         cpu >= 10 && error >= 100 && failed <= 0 && all >= 20 && compared >= all);
}

static void unbeaten_row(void) {
    char ours[TEXT];
    snprintf(ours, sizeof ours, "%.0f runs of others not beaten", fact_get("unbeaten"));
    line("work against precision", ours, "", "all settings of all cases", "0", fact_get("unbeaten") <= 0);
}

static void special_rows(void) {
    static results r;
    char ours[TEXT], others[TEXT];
    results_read("chopper", &r);
    const result_row *best = results_best(&r, ROW_LIBRARY, NULL);
    describe(best, 1, ours);
    describe(pick(&r, ROW_RIVAL, NULL, useful), 1, others);
    line("sliding chopper", ours, "", others, "1e-9 V: 1e-10", best && best->error <= 1e-10);
    results_read("bouncing", &r);
    best = NULL;
    for (int i = 0; i < r.count; i++)
        if (r.row[i].done && r.row[i].kind == ROW_LIBRARY &&
            !(best && best->accumulation <= r.row[i].accumulation))
            best = &r.row[i];
    if (best)
        snprintf(ours, sizeof ours, "accumulates %.1e s off, %s", best->accumulation, best->series);
    line("bouncing (Zeno)", best ? ours : "none", "", "", "1e-9 s", best && best->accumulation <= 1e-9);
}

int main(void) {
    static const target cases[] = {
        {"buck of the literature, 200 us", "literature", 30e-3, 1e-6, NULL, 1},
        {"synchronous buck, 5 ms", "buck_sync", 0.15e-3, 1e-10, "Pulsim 1.8 0.33 ms 1e-10", 0},
        {"buck with a diode, CCM", "buck_ccm", 0.3e-3, 1e-9, "Pulsim 1.8 8.5 ms 6e-3", 0},
        {"buck with a diode, DCM", "buck_dcm", 0.3e-3, 1e-9, "Pulsim 1.8 8.5 ms 6e-3", 0},
        {"six-pulse, 1 mH, 100 ms", "six_pulse", 0.6e-3, 1e-8, "Pulsim 1.8 36 ms 1.4e-3", 0},
        {"LC bridge, 5 ms", "lc_bridge", 0.05e-3, 1e-9, "Pulsim 1.8 7.7 ms 5e-4", 0},
        {"Cockcroft-Walton 5", "multiplier5", 5e-3, 1e-6, "Pulsim 1.8 39 ms", 0},
        {"Cockcroft-Walton 20", "multiplier20", 80e-3, 1e-6, "Pulsim 1.8 0.9 s", 0},
        {"Cockcroft-Walton 50", "multiplier50", 400e-3, 1e-6, "Pulsim 1.8 exception", 0}};
    static const int cells[] = {4, 10, 20, 40};
    static const char *const product = "the bare matrix-vector product";
    char others[TEXT];
    csv = fopen("build/bench/goals.csv", "w");
    if (!csv) {
        perror("build/bench/goals.csv");
        return 1;
    }
    fprintf(csv, "case;ours;auto;others;goal;reached\n");
    printf("\nwhat was to be shown, and what this run measured (CPU time; errors relative; NaN: not measured "
           "in it)\n");
    printf("%-30s | %-40s | %-20s | %-58s | %-22s | %s\n", "case", "ours, any engine", "auto",
           "best other measured here", "goal", "reached");
    lc_step();
    time_of_point("literature", others);
    step_row("theta step, literature buck", "buck of the literature step", 0.15e-6, others);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        case_row(&cases[i]);
    growth_rows();
    time_of_point("ladder320", others);
    step_row("theta step, 320 devices", "theta step at 320 devices", 5e-6, others);
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++)
        leg_row(cells[i]);
    through_row();
    number_row("step / product, LC bridge", "theta 1 step over product", product, 2, NULL);
    number_row("step / product, buck", "buck of the literature step over product", product, 2, NULL);
    unbeaten_row();
    special_rows();
    printf("%d of %d reached\n", reached_rows, rows);
    fclose(csv);
    return 0;
}
