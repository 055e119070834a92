/* tests/bench/report.c - what the runs of a case gave, as text, CSV and pictures. */
#include "timing.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "facts.h"
#include "picture.h"
#include "report.h"

static double median_of(const row *r, const double *of) {
    double sorted[ROUNDS];
    memcpy(sorted, of, sizeof sorted);
    return median(r->rounds, sorted);
}

double row_time(const row *r) {
    return median_of(r, r->time);
}

double row_other(const row *r) {
    return median_of(r, r->other);
}

static const char *end_name(row_end e) {
    static const char *const names[] = {"", "aborted", "over its time", "not tried:"};
    return names[e];
}

/* --- the table --- */

static void print_library(const row *r) {
    if (r->end == ROW_DONE)
        printf("  %-10s %-14s %9.2e %10.4f %9.4f %8ld %8.3f %7ld %8ld %7ld %7ld %6ld %8.0f", r->series,
               r->setting, r->error, row_time(r) * 1e3, row_other(r) * 1e3, r->steps,
               (row_time(r) - row_other(r)) * 1e6 / (double)r->steps, r->counts.events, r->counts.problems,
               r->counts.pivots, r->counts.factors, r->counts.maps, (double)r->bytes / 1024);
    else
        printf("  %-10s %-14s %s %s", r->series, r->setting, end_name(r->end), r->why);
    if (r->end == ROW_DONE)
        printf("  %s", r->why);
    if (r->end == ROW_DONE && !isnan(r->accumulation))
        printf("  accumulates %.1e s off", r->accumulation);
    putchar('\n');
}

static void print_ngspice(const row *r) {
    if (r->end == ROW_DONE)
        printf("  %-26s %-24s %9.2e %10.1f %9.1f %8ld %8ld\n", r->series, r->setting, r->error,
               row_time(r) * 1e3, row_other(r) * 1e3, r->steps, r->rejected);
    else
        printf("  %-26s %-24s %s %s\n", r->series, r->setting, end_name(r->end), r->why);
}

void report_table(const bench_case *c, int count, const row *rows) {
    int tried = 0, ends[4] = {0};
    printf("\n== %s: %s, %g ms", c->name, c->title, c->end * 1e3);
    if (c->net)
        printf(", %d devices", deck_devices(c->net));
    printf("; unit of steps %.3g us\n   reference: %s; its own error %.1e\n", c->unit * 1e6, c->origin,
           c->right_error);
    printf("  %-10s %-14s %9s %10s %9s %8s %8s %7s %8s %7s %7s %6s %8s\n", "library", "h or reltol", "error",
           "ms in all", "creation", "steps", "us/step", "events", "problems", "pivots", "factors", "maps",
           "kB");
    for (int i = 0; i < count; i++)
        if (rows[i].kind == ROW_LIBRARY)
            print_library(&rows[i]);
    printf("  %-26s %-24s %9s %10s %9s %8s %8s\n", "elsewhere", "setting", "error", "ms run", "process",
           "points", "rejected");
    for (int i = 0; i < count; i++)
        if (rows[i].kind != ROW_LIBRARY) {
            print_ngspice(&rows[i]);
            tried += rows[i].kind == ROW_RIVAL;
            ends[rows[i].end] += rows[i].kind == ROW_RIVAL;
        }
    printf("  other programs: %d settings, %d done, %d aborted, %d over their time, %d not tried\n", tried,
           ends[ROW_DONE], ends[ROW_ABORTED], ends[ROW_TIMEOUT], ends[ROW_SKIPPED]);
}

/* --- the duel --- */

/* The fastest of a kind with an error of at most `level`; NULL: none. */
static const row *fastest(int count, const row *rows, row_kind kind, double level) {
    const row *best = NULL;
    for (int i = 0; i < count; i++)
        if (rows[i].end == ROW_DONE && rows[i].kind == kind && rows[i].error <= level &&
            (!best || row_time(&rows[i]) < row_time(best)))
            best = &rows[i];
    return best;
}

static const row *most_accurate(int count, const row *rows, row_kind kind) {
    const row *best = NULL;
    for (int i = 0; i < count; i++)
        if (rows[i].end == ROW_DONE && rows[i].kind == kind && (!best || rows[i].error < best->error))
            best = &rows[i];
    return best;
}

static void print_duel(double level, const row *ours, const row *rival) {
    printf("   error <= %.0e: ", level);
    if (rival)
        printf("elsewhere %.2f ms at %.1e (%s, %s)", row_time(rival) * 1e3, rival->error, rival->series,
               rival->setting);
    else
        printf("elsewhere none");
    if (ours)
        printf("; library %.3f ms at %.1e (%s, %s)", row_time(ours) * 1e3, ours->error, ours->series,
               ours->setting);
    else
        printf("; library none");
    if (ours && rival)
        printf(": ratio %.3g", row_time(rival) / row_time(ours));
    putchar('\n');
}

/* Who stands against the others: the library, or ours through ngspice where it did not run. */
static row_kind ours_of(int count, const row *rows) {
    for (int i = 0; i < count; i++)
        if (rows[i].kind == ROW_LIBRARY)
            return ROW_LIBRARY;
    return ROW_OURS;
}

static void print_levels(int count, const row *rows) {
    const row *last_ours = NULL, *last_rival = NULL;
    for (int digits = 1; digits <= 12; digits++) {
        const double level = pow(10, -digits);
        const row *ours = fastest(count, rows, ours_of(count, rows), level),
                  *rival = fastest(count, rows, ROW_RIVAL, level);
        if ((ours || rival) && (ours != last_ours || rival != last_rival))
            print_duel(level, ours, rival);
        last_ours = ours;
        last_rival = rival;
    }
}

/* The lead of ours at the error of one of ngspice's runs. */
static double lead_over(const row *rival, int count, const row *rows) {
    const row *ours = fastest(count, rows, ours_of(count, rows), rival->error);
    return ours ? row_time(rival) / row_time(ours) : 0;
}

/* At the other's error or less; where ours does not get there, its most accurate run.  Ours has no smaller
 * error than the reference. */
static void look_through_ngspice(int count, const row *rows, double right_error, duel *d) {
    const row *rival = fastest(count, rows, ROW_RIVAL, 1e-2);
    if (!rival)
        rival = most_accurate(count, rows, ROW_RIVAL);
    const row *ours = rival ? fastest(count, rows, ROW_OURS, rival->error) : NULL;
    if (!ours)
        ours = most_accurate(count, rows, ROW_OURS);
    for (int i = 0; i < count; i++)
        if (rows[i].end != ROW_DONE && rows[i].end != ROW_SKIPPED) {
            d->ours_failed += rows[i].kind == ROW_OURS;
            d->failed += rows[i].kind == ROW_RIVAL;
        }
    if (ours && rival) {
        d->cpu_ratio = row_other(rival) / row_other(ours);
        d->run_ratio = row_time(rival) / row_time(ours);
        d->start_ratio = row_other(rival) / (row_other(ours) - row_time(ours));
        d->error_ratio = rival->error / fmax(ours->error, fmax(right_error, 1e-14));
    }
    if (ours)
        d->our_row = *ours;
    if (rival)
        d->rival_row = *rival;
}

void report_duel(const bench_case *c, int count, const row *rows, duel *d) {
    const row *best = most_accurate(count, rows, ROW_RIVAL);
    memset(d, 0, sizeof *d);
    snprintf(d->name, sizeof d->name, "%s", c->name);
    d->through = c->through;
    print_levels(count, rows);
    d->lead = INFINITY;
    for (int i = 0; i < count; i++) {
        if (rows[i].kind != ROW_RIVAL)
            continue;
        d->tried++;
        if (rows[i].end != ROW_DONE)
            continue;
        const double lead = lead_over(&rows[i], count, rows);
        d->done++;
        d->unbeaten += lead < 1;
        d->lead = fmin(d->lead, lead);
    }
    d->best_error = best ? best->error : NAN;
    d->best_time = best ? row_time(best) : NAN;
    look_through_ngspice(count, rows, c->right_error, d);
}

/* The geometric mean over `of` cases; NAN: none. */
static double mean(int count, const duel *d, size_t offset, int through, int *of) {
    double sum = 0;
    *of = 0;
    for (int i = 0; i < count; i++) {
        const double value = *(const double *)(const void *)((const char *)&d[i] + offset);
        if (value > 0 && isfinite(value) && (!through || d[i].through)) {
            sum += log(value);
            ++*of;
        }
    }
    return *of ? exp(sum / *of) : NAN;
}

static void print_side(const row *r, const char *none) {
    if (r->rounds == 0)
        printf("  %-40s", none);
    else
        printf("%9.1f %8.1f %7ld %6ld %8.1e", 1e3 * row_other(r), 1e3 * row_time(r), r->steps, r->grid,
               r->error);
}

static void print_through(const duel *d) {
    printf("  %-14s", d->name);
    print_side(&d->our_row, "none came to its end");
    printf(" |");
    print_side(&d->rival_row, "no setting came to its end");
    if (d->cpu_ratio > 0)
        printf(" | %6.3g %6.3g   %s %s (ours: %s)", d->cpu_ratio, d->run_ratio, d->rival_row.series,
               d->rival_row.setting, d->our_row.setting);
    putchar('\n');
}

static void summarize_through(int count, const duel *d) {
    int of, failed = 0, ours = 0, all = 0;
    printf(
        "\n== through ngspice: its fastest setting below 1 %% (else its most accurate) against nonsmooth.cm "
        "as it is, at\n   that error or less if it gets there; ms of CPU: whole processes, and what is above "
        "one that only starts and reads;\n   points, and how many of them .tran alone asks for\n"
        "  %-14s%9s %8s %7s %6s %8s |%9s %8s %7s %6s %8s | %6s %6s   %s\n",
        "netlist", "ours: ms", "run", "points", ".tran", "error", "best: ms", "run", "points", ".tran",
        "error", "ratio", "run's", "ngspice's best");
    for (int i = 0; i < count; i++)
        if (d[i].through) {
            print_through(&d[i]);
            failed += d[i].failed;
            ours += d[i].ours_failed;
            all++;
        }
    const double cpu = mean(count, d, offsetof(duel, cpu_ratio), 1, &of);
    const double run = mean(count, d, offsetof(duel, run_ratio), 1, &of);
    const double error = mean(count, d, offsetof(duel, error_ratio), 1, &of);
    const double start = mean(count, d, offsetof(duel, start_ratio), 1, &of);
    printf("  geometric means of %d of %d: CPU %.3g (without start-up %.3g; %.3g if ours took nothing but "
           "start-up), error %.3g; failed: ours %d, ngspice's settings %d\n",
           of, all, cpu, run, start, error, ours, failed);
    fact_put("through netlists", all);
    fact_put("through compared", of);
    fact_put("through cpu", cpu);
    fact_put("through run", run);
    fact_put("through start", start);
    fact_put("through error", error);
    fact_put("through ours failed", ours);
    fact_put("through others failed", failed);
}

static void summarize_all(int count, const duel *d) {
    int of, unbeaten = 0;
    printf("\n== all: other programs (ngspice with its own models, Siconos) against the library\n"
           "  %-14s %9s %9s %13s %13s %9s\n",
           "case", "settings", "finished", "its least err", "least lead", "unbeaten");
    for (int i = 0; i < count; i++) {
        printf("  %-14s %9d %9d %13.1e %13.3g %9d\n", d[i].name, d[i].tried, d[i].done, d[i].best_error,
               d[i].lead, d[i].unbeaten);
        unbeaten += d[i].unbeaten;
    }
    printf("  least lead: its time over ours at the same error or less, the least over its runs (0: ours did "
           "not get there,\n  inf: it has none); unbeaten: its runs that ours does not beat in both\n");
    const double lead = mean(count, d, offsetof(duel, lead), 0, &of);
    printf("  geometric mean of the leads of %d cases: %.3g\n", of, lead);
    fact_put("unbeaten", unbeaten);
}

void report_summary(int count, const duel *d, int netlists) {
    if (!netlists)
        summarize_all(count, d);
    summarize_through(count, d);
}

/* --- files --- */

static void write_csv(const bench_case *c, const char *folder, int count, const row *rows) {
    static const char *const kinds[] = {"library", "ngspice with nonsmooth.cm", "elsewhere"};
    FILE *f = picture_create(folder, c->name, "csv");
    fprintf(f, "case,program,series,setting,end,error,seconds,creation_or_process_seconds,steps,events,"
               "problems,pivots,"
               "factors,maps,rejected,bytes,accumulation_error,reference_error\n");
    for (int i = 0; i < count; i++) {
        const row *r = &rows[i];
        fprintf(f, "%s,%s,%s,%s,%s,%.6e,%.6e,%.6e,%ld,%ld,%ld,%ld,%ld,%ld,%ld,%zu,%.3e,%.1e\n", c->name,
                kinds[r->kind], r->series, r->setting, r->end == ROW_DONE ? "done" : end_name(r->end),
                r->error, row_time(r), row_other(r), r->steps, r->counts.events, r->counts.problems,
                r->counts.pivots, r->counts.factors, r->counts.maps, r->rejected, r->bytes, r->accumulation,
                c->right_error);
    }
    fclose(f);
}

void report_files(const bench_case *c, const char *folder, int count, const row *rows) {
    write_csv(c, folder, count, rows);
    picture_case(c, folder, count, rows);
}
