/* tests/bench/picture.c - data and scripts for gnuplot. */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "picture.h"

static const double least_error = 1e-16, least_time = 1e-6; /* what is drawn at the edge */

FILE *picture_create(const char *folder, const char *name, const char *end) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s.%s", folder, name, end);
    FILE *f = fopen(path, "w");
    if (!f) {
        perror(path);
        exit(1);
    }
    return f;
}

const char *picture_style(const char *series) {
    static const struct {
        const char *begin, *style;
    } styles[] = {{"auto", "lc rgb '#00a000' pt 13 ps 2.2 lw 3"},
                  {"exact", "lc rgb '#0b7a75' pt 9 ps 1.8 lw 2"},
                  {"sparse", "lc rgb '#7a1fa2' pt 11 ps 1.6 lw 2"},
                  {"capture 1/2", "lc rgb '#35b5c8' pt 7 ps 1.4 lw 2"},
                  {"capture", "lc rgb '#147a94' pt 5 ps 1.4 lw 2"},
                  {"theta 1/2", "lc rgb '#3f8fd8' pt 7 ps 1.4 lw 2"},
                  {"theta", "lc rgb '#1f4e9c' pt 5 ps 1.4 lw 2"},
                  {"nonsmooth.cm grid", "lc rgb '#000000' pt 6 ps 1.8 lw 2"},
                  {"nonsmooth.cm", "lc rgb '#000000' pt 4 ps 1.6 lw 2"},
                  {"sidiode 1m trap", "lc rgb '#d00000' pt 1 ps 1.3 lw 2"},
                  {"sidiode 1m gear", "lc rgb '#d00000' pt 2 ps 1.3 lw 2"},
                  {"sidiode 1u trap", "lc rgb '#ff9f8a' pt 1 ps 1.3 lw 2"},
                  {"sidiode 1u gear", "lc rgb '#ff9f8a' pt 2 ps 1.3 lw 2"},
                  {"D n=0.01 trap", "lc rgb '#e08a00' pt 1 ps 1.3 lw 2"},
                  {"D n=0.01 gear", "lc rgb '#e08a00' pt 2 ps 1.3 lw 2"},
                  {"D n=1 trap", "lc rgb '#8c564b' pt 1 ps 1.3 lw 2"},
                  {"D n=1 gear", "lc rgb '#8c564b' pt 2 ps 1.3 lw 2"},
                  {"Siconos Lemke", "lc rgb '#505050' pt 3 ps 1.3 lw 2"},
                  {"Siconos", "lc rgb '#909090' pt 3 ps 1.3 lw 2"}};
    for (size_t i = 0; i < sizeof styles / sizeof *styles; i++)
        if (strncmp(series, styles[i].begin, strlen(styles[i].begin)) == 0)
            return styles[i].style;
    return "lc rgb '#c0c0c0' pt 3 ps 1 lw 1";
}

void picture_head(FILE *gp, const char *folder, const char *name) {
    fprintf(gp,
            "set terminal pngcairo size 1200,760 font 'sans,13' enhanced\nset output '%s/%s.png'\n"
            "set logscale xy\nset format '10^{%%T}'\nset grid lc rgb '#dddddd' lt 1\nset border 3\n"
            "set tics nomirror\nset key outside right top Left reverse noenhanced spacing 1.25\n",
            folder, name);
}

static int shown(const row *r) {
    return r->end == ROW_DONE && r->error < 10;
}

/* The series in the order in which they come, one block each. */
static int series_of(int count, const row *rows, int *first) {
    int found = 0;
    for (int i = 0; i < count; i++) {
        int known = !shown(&rows[i]);
        for (int k = 0; k < found && !known; k++)
            known = strcmp(rows[first[k]].series, rows[i].series) == 0;
        if (!known)
            first[found++] = i;
    }
    return found;
}

static double error_of(const row *r) {
    return fmax(r->error, least_error);
}

/* ms */
static double time_of(const row *r) {
    return fmax(row_time(r), least_time) * 1e3;
}

/* What elsewhere no run is both faster and more accurate than, from the most accurate on. */
static void write_front(FILE *f, int count, const row *rows) {
    double error = 0, time = INFINITY;
    for (;;) {
        const row *next = NULL;
        for (int i = 0; i < count; i++) {
            const row *r = &rows[i];
            if (r->kind == ROW_RIVAL && shown(r) && r->error > error && row_time(r) < time &&
                (!next || r->error < next->error ||
                 (r->error <= next->error && row_time(r) < row_time(next))))
                next = r;
        }
        if (!next)
            return;
        error = next->error;
        time = row_time(next);
        fprintf(f, "%.6e %.6e\n", error_of(next), time_of(next));
    }
}

static void write_data(const bench_case *c, const char *folder, int count, const row *rows, int series,
                       const int *first) {
    FILE *f = picture_create(folder, c->name, "dat");
    for (int k = 0; k < series; k++) {
        fprintf(f, "# %s\n", rows[first[k]].series);
        for (int i = 0; i < count; i++)
            if (shown(&rows[i]) && strcmp(rows[i].series, rows[first[k]].series) == 0)
                fprintf(f, "%.6e %.6e\n", error_of(&rows[i]), time_of(&rows[i]));
        fprintf(f, "\n\n");
    }
    fprintf(f, "# best elsewhere\n");
    write_front(f, count, rows);
    fclose(f);
}

/* Marks at 1, 2, 5 times powers of ten where they have room. */
static void write_marks(FILE *f, double lo, double hi) {
    static const int digits[] = {1, 2, 5};
    const int fine = hi < 500 * lo;
    int count = 0;
    fprintf(f, "set format y '%%g'\nset ytics (");
    for (int d = (int)floor(log10(lo)); d <= (int)ceil(log10(hi)); d++)
        for (int k = 0; k < (fine ? 3 : 1); k++)
            fprintf(f, "%s%g", count++ > 0 ? ", " : "", digits[k] * pow(10, d));
    fprintf(f, ")\n");
}

/* Room around all points, for on logarithmic axes gnuplot leaves none or a whole decade. */
static void write_ranges(FILE *f, int count, const row *rows) {
    double e0 = INFINITY, e1 = 0, t0 = INFINITY, t1 = 0;
    for (int i = 0; i < count; i++)
        if (shown(&rows[i])) {
            e0 = fmin(e0, error_of(&rows[i]));
            e1 = fmax(e1, error_of(&rows[i]));
            t0 = fmin(t0, time_of(&rows[i]));
            t1 = fmax(t1, time_of(&rows[i]));
        }
    if (!(t1 > 0)) /* nothing to be seen */
        return;
    fprintf(f, "set xrange [%.3e:%.3e]\nset yrange [%.3e:%.3e]\n", e0 / 4, e1 * 4, t0 / 2, t1 * 2);
    write_marks(f, t0 / 2, t1 * 2);
}

static void write_script(const bench_case *c, const char *folder, int count, const row *rows, int series,
                         const int *first) {
    FILE *f = picture_create(folder, c->name, "gp");
    picture_head(f, folder, c->name);
    write_ranges(f, count, rows);
    fprintf(f,
            "set title \"%s: %s, %g ms\" noenhanced\n"
            "set xlabel 'largest relative error (the reference has %.0e)'\n"
            "set ylabel 'CPU time, ms (ngspice without its start; left and down is better)'\nplot \\\n",
            c->name, c->title, c->end * 1e3, c->right_error);
    for (int k = 0; k < series; k++) {
        const row *r = &rows[first[k]];
        const int rival = r->kind == ROW_RIVAL;
        fprintf(f, "'%s/%s.dat' index %d with %s %s title '%s%s%s', \\\n", folder, c->name, k,
                rival ? "points" : "linespoints", picture_style(r->series),
                rival && !r->direct ? "ngspice, " : "", r->series, r->kind == ROW_OURS ? " in ngspice" : "");
    }
    fprintf(f, "'%s/%s.dat' index %d with lines lc rgb '#b0b0b0' dt 2 lw 2 title 'best elsewhere'\n", folder,
            c->name, series);
    fclose(f);
}

void picture_case(const bench_case *c, const char *folder, int count, const row *rows) {
    int *first = room(sizeof *first * (size_t)(count + 1));
    const int series = series_of(count, rows, first);
    write_data(c, folder, count, rows, series, first);
    if (series > 0)
        write_script(c, folder, count, rows, series, first);
    free(first);
}
