/* tests/bench/results.h - the CSV files of the cases, read again. */
#ifndef NONSMOOTH_TESTS_RESULTS_H
#define NONSMOOTH_TESTS_RESULTS_H

#include "report.h"

typedef struct result_row {
    row_kind kind;
    int done;
    char series[40], setting[40], end[24];
    double error, seconds, process; /* process: with ngspice's start */
    double accumulation;
    long steps;
} result_row;

typedef struct results {
    int count;
    result_row row[512];
} results;

/* build/bench/NAME.csv; no rows if it is not there. */
void results_read(const char *name, results *r);

/* Of one kind, and one series unless that is NULL: the fastest with an error of at most `level`; the most
 * accurate; NULL: none. */
const result_row *results_fastest(const results *r, row_kind kind, const char *series, double level);
const result_row *results_best(const results *r, row_kind kind, const char *series);

#endif
