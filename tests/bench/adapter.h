/* tests/bench/adapter.h - one run of a case by the library: the only place that knows how an engine is asked
 * for. */
#ifndef NONSMOOTH_TESTS_ADAPTER_H
#define NONSMOOTH_TESTS_ADAPTER_H

#include "cases.h"

typedef enum bench_engine {
    BENCH_THETA,
    BENCH_HALF,
    BENCH_EXACT,
    BENCH_SPARSE,
    BENCH_AUTO,
    BENCH_CAPTURE_HALF, /* as theta 1/2 and theta, no event located; large circuits have no others */
    BENCH_CAPTURE,
    BENCH_ENGINES
} bench_engine;

typedef struct bench_result {
    int status;         /* NS_OK, or why it ended */
    double create, run; /* s of CPU: system and marcher, from a circuit's elements; start to end */
    double values[CASE_VALUES];
    double last_event; /* s; of cases whose events accumulate */
    size_t bytes;      /* that the circuit, system and marcher hold at the end */
    ns_method engine;  /* that was at work in the end */
    ns_counts counts;
} bench_result;

const char *bench_engine_name(bench_engine e);
int bench_has(bench_engine e, const bench_case *c); /* it is there, and takes cases of this size */

int bench_captures(bench_engine e);
int bench_steps(bench_engine e); /* its setting is a step of the scheme, else reltol */

/* How many settings are tried, and number k of them. */
int bench_settings(bench_engine e, int large, int quick);
double bench_setting(bench_engine e, int k);

/* setting: of the theta schemes (and of exact, where they step in) the step, in units of the case; of the
 * others reltol. */
void bench_run(const bench_case *c, bench_engine e, double setting, bench_result *r);

#endif
