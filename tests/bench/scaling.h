/* tests/bench/scaling.h - how the cost of a step grows with the number of devices, over the ladders. */
#ifndef NONSMOOTH_TESTS_SCALING_H
#define NONSMOOTH_TESTS_SCALING_H

#include "report.h"

typedef struct scaling {
    int count;
    struct {
        char series[40];
        int rival, devices;
        double step, bytes; /* s of CPU a step, without creation; NAN bytes: not known */
    } point[256];
} scaling;

/* Of each series the run with the most steps. */
void scaling_add(scaling *s, const bench_case *c, int count, const row *rows);

/* Prints the table, writes folder/scaling.csv, .dat and .gp. */
void scaling_report(const scaling *s, const char *folder);

#endif
