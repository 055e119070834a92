/* tests/bench/ways.c - ways to run a case through ngspice. */
#define _DEFAULT_SOURCE
#include "ways.h"

#include <math.h>
#include <string.h>

#include "timing.h"

void way_run(const bench_case *c, double limit, int count, way *w) {
    double seconds[WAY_RUNS];
    for (int k = 0; k < count; k++) {
        rival_run(c, &w->setting, 1, limit, &w->result);
        seconds[k] = w->result.process;
    }
    w->seconds = median(count, seconds);
}

double way_start(const bench_case *c, const way *w) {
    double seconds[WAY_RUNS];
    rival_result r;
    for (int k = 0; k < WAY_RUNS; k++) {
        rival_run(c, &w->setting, 0, 20, &r);
        seconds[k] = r.process;
    }
    return median(WAY_RUNS, seconds);
}

way way_ours(const char *name, double step, const char *options) {
    way w = {.setting = {.unmarked = 1,
                         .name = "nonsmooth.cm",
                         .models = {.diode = DECK_IDEAL},
                         .reltol = 1e-3,
                         .step = step,
                         .options = options}};
    snprintf(w.name, sizeof w.name, "%s", name);
    return w;
}

int way_theirs(const bench_case *c, double error, way *w) {
    static results all;
    static const rival_setting kinds[] = {{.name = "sidiode 1m", .models = {DECK_SIDIODE, 0, 1e-3, 1e6, 0}},
                                          {.name = "sidiode 1u", .models = {DECK_SIDIODE, 0, 1e-6, 1e9, 0}},
                                          {.name = "D n=0.01", .models = {DECK_D, 0.01, 1e-3, 1e6, 0}},
                                          {.name = "D n=1", .models = {DECK_D, 1, 1e-3, 1e6, 0}}};
    results_read(c->name, &all);
    const result_row *r = results_fastest(&all, ROW_RIVAL, NULL, error);
    r = r ? r : results_best(&all, ROW_RIVAL, NULL);
    for (size_t k = 0; r && k < sizeof kinds / sizeof *kinds; k++)
        if (strncmp(r->series, kinds[k].name, strlen(kinds[k].name)) == 0) {
            const char *vh = strstr(r->series, "vh=");
            double parts = 0;
            w->setting = kinds[k];
            w->setting.unmarked = 1;
            w->setting.gear = strstr(r->series, "gear") != NULL;
            w->setting.models.vh = vh ? strtod(vh + 3, NULL) : 0;
            if (sscanf(r->setting, "reltol %lf unit/%lf", &w->setting.reltol, &parts) != 2)
                return 0;
            w->setting.step = 1 / parts;
            snprintf(w->name, sizeof w->name, "%.39s %.39s", r->series, r->setting);
            return 1;
        }
    return 0;
}

way_errors way_errors_of(const bench_case *c, const rival_result *got, const rival_result *right) {
    way_errors e = {0, 0};
    for (int i = 0; i < c->unknowns; i++) {
        const rival_shape *a = &got->shape[i], *b = &right->shape[i];
        const double largest = fmax(fabs(b->most), fabs(b->least));
        e.mean = fmax(e.mean, fabs(a->mean - b->mean) / b->size);
        e.extreme = fmax(e.extreme, fmax(fabs(a->most - b->most), fabs(a->least - b->least)) / largest);
    }
    return e;
}
