/* tests/bench/precision.c - the picture of README: run time against error, four circuits. */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "picture.h"
#include "precision.h"
#include "results.h"

static const struct {
    const char *name, *title;
} panels[] = {{"buck_ccm", "Buck converter, 2 devices"},
              {"six_pulse", "Six-pulse rectifier, 6 devices"},
              {"multiplier20", "Cockcroft-Walton multiplier, 40 devices"},
              {"multilevel20", "Multilevel converter leg, 160 devices"}};
enum { PANELS = sizeof panels / sizeof *panels };

/* Of the library all runs; of ngspice those that no other one of its series beats in both. */
static const struct {
    row_kind kind;
    const char *series, *title, *style; /* series: of the library its name, of ngspice how it ends */
} curves[] = {{ROW_LIBRARY, "theta", "theta, order 1", "linespoints lc rgb '#6f94c8' pt 5 ps 0.5 lw 1.5"},
              {ROW_LIBRARY, "theta 1/2", "theta, order 2", "linespoints lc rgb '#1f4e9c' pt 7 ps 0.6 lw 1.5"},
              {ROW_LIBRARY, "sparse", "sparse", "linespoints lc rgb '#7a1fa2' pt 11 ps 0.8 lw 1.5"},
              {ROW_LIBRARY, "exact", "exact", "linespoints lc rgb '#0b7a75' pt 9 ps 1 lw 1.5"},
              {ROW_LIBRARY, "auto", "auto (default)", "points lc rgb '#000000' pt 6 ps 1.3 lw 1.5"},
              {ROW_RIVAL, " trap", "ngspice trap, tuned", "linespoints lc rgb '#d00000' pt 2 ps 0.7 lw 1.5"},
              {ROW_RIVAL, " gear", "ngspice gear, tuned", "linespoints lc rgb '#e08a00' pt 1 ps 0.7 lw 1.5"}};
enum { CURVES = sizeof curves / sizeof *curves };

static int is_shown(const result_row *r, int curve) {
    const char *series = curves[curve].series;
    const size_t length = strlen(r->series), end = strlen(series);
    if (!r->done || !(r->error < 1) || r->kind != curves[curve].kind)
        return 0;
    return r->kind == ROW_LIBRARY ? strcmp(r->series, series) == 0
                                  : length > end && strcmp(r->series + length - end, series) == 0;
}

static int is_beaten(const results *all, const result_row *r, int curve) {
    for (int i = 0; i < all->count && r->kind == ROW_RIVAL; i++) {
        const result_row *o = &all->row[i];
        if (is_shown(o, curve) && o->error <= r->error && o->seconds < r->seconds)
            return 1;
    }
    return 0;
}

static const double least_error = 2e-15; /* what is smaller is drawn there */

typedef struct range { /* ms */
    double least, most;
} range;

/* One block of data, by ascending error; where it has none, one line that gnuplot passes over. */
static void write_block(FILE *f, const results *all, int curve, range *of) {
    double last = -1;
    fprintf(f, "# %s\nNaN NaN\n", curves[curve].title);
    for (const result_row *next;; last = next->error) {
        next = NULL;
        for (int i = 0; i < all->count; i++) {
            const result_row *r = &all->row[i];
            if (is_shown(r, curve) && r->error > last && (!next || r->error < next->error) &&
                !is_beaten(all, r, curve))
                next = r;
        }
        if (!next)
            break;
        const double error = fmax(next->error, least_error), ms = next->seconds * 1e3;
        fprintf(f, "%.4e %.4e\n", error, ms);
        of->least = fmin(of->least, ms);
        of->most = fmax(of->most, ms);
    }
    fprintf(f, "\n\n");
}

static void write_head(FILE *gp, const char *folder) {
    fprintf(gp,
            "set terminal svg size 900,800 font 'sans,13' background '#ffffff' enhanced\n"
            "set output '%s/precision.svg'\n"
            "set multiplot layout 2,2 rowsfirst margins 0.085,0.98,0.19,0.95 spacing 0.09,0.125\n"
            "set logscale xy\nset format x '10^{%%T}'\nset format y '%%g'\nset grid lc rgb '#e4e4e4' lt 1\n"
            "set border 3 lc rgb '#606060'\nset tics nomirror scale 0.6\nset xtics 1e-15,1e3\nset ytics 10\n"
            "set xrange [1e-15:1]\nset xlabel 'largest relative error' offset 0,0.4\n"
            "set ylabel 'CPU time, ms' offset 0.8,0\nset key off\n",
            folder);
}

/* The axis of time ends at powers of ten. */
static void write_panel(FILE *gp, const char *folder, int panel, int block, const range *of) {
    fprintf(gp, "set title '%s' offset 0,-0.6\nset yrange [%g:%g]\nplot \\\n", panels[panel].title,
            pow(10, floor(log10(of->least))), pow(10, ceil(log10(of->most))));
    for (int k = 0; k < CURVES; k++)
        fprintf(gp, "%s'%s/precision.dat' index %d with %s", k ? ", \\\n" : "", folder, block + k,
                curves[k].style);
    fprintf(gp, "\n");
}

/* The key, in a plot of its own below the others. */
static void write_key(FILE *gp) {
    fprintf(gp, "unset border\nunset tics\nunset xlabel\nunset ylabel\n"
                "set title 'each point is one run with one setting; left and down is better; missing runs "
                "did not finish in time'\n"
                "set lmargin at screen 0.02\nset rmargin at screen 0.98\nset bmargin at screen 0.0\n"
                "set tmargin at screen 0.09\n"
                "set key center top horizontal maxrows 2 Left reverse samplen 1.5 width -1\nplot \\\n");
    for (int k = 0; k < CURVES; k++)
        fprintf(gp, "NaN with %s title '%s', \\\n", curves[k].style, curves[k].title);
    fprintf(gp, "NaN notitle\nunset multiplot\n");
}

void precision_picture(const char *folder) {
    static results all[PANELS];
    FILE *data = NULL, *gp = NULL;
    for (int p = 0, blocks = 0; p < PANELS; p++) {
        range of = {INFINITY, 0};
        results_read(panels[p].name, &all[p]);
        if (all[p].count == 0)
            continue;
        if (!data) {
            data = picture_create(folder, "precision", "dat");
            gp = picture_create(folder, "precision", "gp");
            write_head(gp, folder);
        }
        for (int k = 0; k < CURVES; k++)
            write_block(data, &all[p], k, &of);
        write_panel(gp, folder, p, blocks, &of);
        blocks += CURVES;
    }
    if (data) {
        write_key(gp);
        fclose(gp);
        fclose(data);
    }
}
