/* tests/bench/scaling.c - cost of a step and memory against the number of devices. */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "facts.h"
#include "picture.h"
#include "scaling.h"

enum { MOST = 256 };

static double step_of(const row *r) {
    const double creation = r->kind == ROW_LIBRARY ? row_other(r) : 0;
    return (row_time(r) - creation) / (double)r->steps;
}

/* The run of the series of rows[first] with the most steps; NULL if another that was done came before. */
static const row *longest(int count, const row *rows, int first) {
    const row *best = NULL;
    for (int i = 0; i < count; i++) {
        if (strcmp(rows[i].series, rows[first].series) != 0 || rows[i].end != ROW_DONE || rows[i].steps < 1)
            continue;
        if (i < first)
            return NULL;
        if (!best || rows[i].steps > best->steps)
            best = &rows[i];
    }
    return best;
}

void scaling_add(scaling *s, const bench_case *c, int count, const row *rows) {
    for (int i = 0; i < count && s->count < MOST; i++) {
        const row *r = longest(count, rows, i);
        if (!r || rows[i].end != ROW_DONE)
            continue;
        snprintf(s->point[s->count].series, sizeof s->point->series, "%s", r->series);
        s->point[s->count].rival = r->kind == ROW_RIVAL;
        s->point[s->count].devices = deck_devices(c->net);
        s->point[s->count].step = step_of(r);
        s->point[s->count++].bytes = r->kind == ROW_LIBRARY ? (double)r->bytes : NAN;
    }
}

static int is_first(const scaling *s, int at) {
    for (int i = 0; i < at; i++)
        if (strcmp(s->point[i].series, s->point[at].series) == 0)
            return 0;
    return 1;
}

static void write_pictures(const scaling *s, const char *folder) {
    FILE *dat = picture_create(folder, "scaling", "dat"), *gp = picture_create(folder, "scaling", "gp");
    picture_head(gp, folder, "scaling");
    fprintf(gp,
            "set title 'ladders of switches: cost of a step, of the run with the most steps'\n"
            "set xlabel 'switches N'\nset ylabel 'CPU time a step, us'\nset xrange [10:15000]\nplot \\\n");
    for (int i = 0, block = 0; i < s->count; i++) {
        if (!is_first(s, i))
            continue;
        for (int k = i; k < s->count; k++)
            if (strcmp(s->point[k].series, s->point[i].series) == 0)
                fprintf(dat, "%d %.6e\n", s->point[k].devices, s->point[k].step * 1e6);
        fprintf(dat, "\n\n");
        fprintf(gp, "'%s/scaling.dat' index %d with linespoints %s title '%s%s', \\\n", folder, block++,
                picture_style(s->point[i].series), s->point[i].rival ? "ngspice, " : "", s->point[i].series);
    }
    fprintf(gp, "x/10 with lines lc rgb '#b0b0b0' dt 2 title '0.1 us a switch'\n");
    fclose(dat);
    fclose(gp);
}

/* How a series grows. */
static void fit(const scaling *s, const char *series) {
    double n[MOST], step[MOST], bytes[MOST];
    int count = 0;
    char what[64];
    for (int i = 0; i < s->count; i++)
        if (strcmp(s->point[i].series, series) == 0) {
            n[count] = s->point[i].devices;
            step[count] = s->point[i].step;
            bytes[count++] = s->point[i].bytes;
        }
    if (count < 3 || isnan(bytes[0]))
        return;
    printf("  %-26s of %d: time a step grows as N^%.2f, memory as N^%.2f\n", series, count,
           growth(count, n, step), growth(count, n, bytes));
    snprintf(what, sizeof what, "ladders %s time", series);
    fact_put(what, growth(count, n, step));
    snprintf(what, sizeof what, "ladders %s memory", series);
    fact_put(what, growth(count, n, bytes));
    snprintf(what, sizeof what, "ladders %s largest", series);
    fact_put(what, n[count - 1]);
}

void scaling_report(const scaling *s, const char *folder) {
    FILE *csv = picture_create(folder, "scaling", "csv");
    fprintf(csv, "series,devices,seconds_a_step,bytes\n");
    printf("\n== ladders: the run of each with the most steps\n  %-26s %8s %12s %12s\n", "", "switches",
           "us a step", "kB a switch");
    for (int i = 0; i < s->count; i++) {
        fprintf(csv, "%s,%d,%.6e,%.0f\n", s->point[i].series, s->point[i].devices, s->point[i].step,
                s->point[i].bytes);
        printf("  %-26s %8d %12.3f %12.2f\n", s->point[i].series, s->point[i].devices, s->point[i].step * 1e6,
               s->point[i].bytes / 1024 / s->point[i].devices);
    }
    for (int i = 0; i < s->count; i++)
        if (is_first(s, i))
            fit(s, s->point[i].series);
    fclose(csv);
    write_pictures(s, folder);
}
