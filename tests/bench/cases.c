/* tests/bench/cases.c - the list of cases. */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "cases.h"

int case_make(int at, int quick, bench_case *c) {
    static const int stages[] = {5, 20, 50}, chain[] = {16, 64, 320, 1000, 10000}, cells[] = {4, 10, 20, 40};
    static const char *const through[] = {"lc_bridge",   "buck_sync",    "buck_dcm",
                                          "six_pulse",   "multiplier5",  "multiplier20",
                                          "multilevel4", "multilevel10", "chopper"};
    const double leg = quick ? 4e-3 : 40e-3; /* s */
    memset(c, 0, sizeof *c);
    c->accumulates = NAN;
    if (at == 0)
        case_lc_bridge(c);
    else if (at == 1)
        case_literature(c);
    else if (at < 5)
        case_buck(c, at > 2, at == 4 ? 200 : 5);
    else if (at == 5)
        case_six_pulse(c);
    else if (at < 9)
        case_multiplier(c, stages[at - 6]);
    else if (at < 14)
        case_ladder(c, chain[at - 9]);
    else if (at < 18)
        case_multilevel(c, cells[at - 14], leg);
    else if (at == 18)
        case_chopper(c);
    else if (at == 19)
        case_bouncing(c);
    else
        return case_netlist(c, at - 20);
    for (size_t k = 0; k < sizeof through / sizeof *through; k++)
        c->through = c->through || strcmp(c->name, through[k]) == 0;
    return 1;
}

void case_free(bench_case *c) {
    deck_free(c->net);
    ns_system_free(c->system);
    memset(c, 0, sizeof *c);
}

void case_prepare(bench_case *c) {
    static real fine[CASE_VALUES], finer[CASE_VALUES];
    c->exact(c, 1, fine);
    c->exact(c, 0.6L, finer);
    for (int i = 0; i < c->times * c->unknowns; i++) {
        if (!isfinite((double)fine[i]) || !isfinite((double)finer[i])) /* fmax() would pass over it */
            must(NS_E_NUMBER);
        c->right[i] = (double)finer[i];
        c->scale[i % c->unknowns] = fmax(c->scale[i % c->unknowns], fabs(c->right[i]));
    }
    for (int i = 0; i < c->unknowns; i++)
        if (!(c->scale[i] > 0))
            c->scale[i] = 1;
    for (int i = 0; i < c->times * c->unknowns; i++)
        c->right_error = fmax(c->right_error, (double)fabsl(fine[i] - finer[i]) / c->scale[i % c->unknowns]);
    c->right_error = fmax(c->right_error, 1e-16); /* what a double holds */
}

double case_error(const bench_case *c, const double *values) {
    double worst = 0;
    for (int i = 0; i < c->times * c->unknowns; i++) {
        const double error = fabs(values[i] - c->right[i]) / c->scale[i % c->unknowns];
        worst = error <= worst ? worst : isfinite(error) ? error : 1e300;
    }
    return worst;
}

void case_times(bench_case *c, double end, int count) {
    c->end = end;
    c->times = count;
    for (int k = 0; k < count; k++)
        c->time[k] = end * (k + 1) / count;
}

void case_voltage(bench_case *c, int node) {
    c->unknown[c->unknowns].of = node;
    snprintf(c->unknown[c->unknowns++].vector, sizeof c->unknown->vector, "v(%d)", node);
}

void case_current(bench_case *c, int part) {
    char name[12];
    deck_name(c->net, part, name, sizeof name);
    c->unknown[c->unknowns].is_current = 1;
    c->unknown[c->unknowns].of = part;
    snprintf(c->unknown[c->unknowns++].vector, sizeof c->unknown->vector, "i(%s)", name);
}
