/* tests/bench/siconos_run.h - one run of a case by Siconos, where its program (siconos.cpp) was built. */
#ifndef NONSMOOTH_TESTS_SICONOS_RUN_H
#define NONSMOOTH_TESTS_SICONOS_RUN_H

#include "cases.h"

typedef struct siconos_setting {
    const char *name; /* of the solver */
    int solver;       /* its number in lcp_cst.h; 0: no run of Siconos */
    double theta, h;  /* h divides the times of the case */
} siconos_setting;

typedef struct siconos_result {
    int done, timeout;
    double create, run; /* s of CPU */
    long steps;
    double values[CASE_VALUES];
} siconos_result;

int siconos_has(const bench_case *c, const char *program); /* it is there, and takes the case */
void siconos_run(const bench_case *c, const siconos_setting *s, const char *program, double limit,
                 siconos_result *r);

#endif
