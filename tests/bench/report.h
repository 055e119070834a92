/* tests/bench/report.h - tables, CSV and pictures of the runs of a case. */
#ifndef NONSMOOTH_TESTS_REPORT_H
#define NONSMOOTH_TESTS_REPORT_H

#include "adapter.h"

enum { ROUNDS = 9 };

typedef enum row_kind { ROW_LIBRARY, ROW_OURS, ROW_RIVAL } row_kind; /* OURS: the library through ngspice */
typedef enum row_end { ROW_DONE, ROW_ABORTED, ROW_TIMEOUT, ROW_SKIPPED } row_end;

/* One way to run a case: all its rounds. */
typedef struct row {
    row_kind kind;
    char series[40], setting[40]; /* engine or models; what is swept */
    row_end end;
    char why[80];         /* it ended, or the engine that auto took */
    int rounds, direct;   /* direct: times[] are measured in the program itself, as the library's */
    double time[ROUNDS];  /* s of CPU: creation and run of the library; ngspice's without start and reading */
    double other[ROUNDS]; /* of that, creation; ngspice's whole process */
    double whole[ROUNDS]; /* of a process that runs it so often: */
    int runs[ROUNDS];
    double error;
    long steps, rejected, grid; /* grid: points that .tran alone asks ngspice for */
    ns_counts counts;           /* the library's */
    size_t bytes;
    double accumulation; /* error of the last event's instant, s; NAN: of no interest */
} row;

double row_time(const row *r);  /* the median */
double row_other(const row *r); /* the median */

/* Prints the table of a case. */
void report_table(const bench_case *c, int count, const row *rows);

/* Writes folder/NAME.csv, and NAME.dat and NAME.gp for gnuplot. */
void report_files(const bench_case *c, const char *folder, int count, const row *rows);

/* What the runs of a case come to. */
typedef struct duel {
    double lead; /* the least, over ngspice's runs, of its time over the library's at that error or less; 0:
                    it has none */
    double best_error, best_time;  /* ngspice's most accurate run */
    double cpu_ratio, error_ratio; /* through ngspice; 0 where one is missing, */
    double run_ratio;              /* of the times without start-up, */
    double start_ratio;            /* and if ours took no more than the start */
    row our_row, rival_row;        /* of those */
    int tried, done;               /* settings of ngspice's own models */
    int unbeaten;                  /* of those, that no run of the library beats in both time and error */
    int through;                   /* one of the netlists compared through ngspice */
    int failed, ours_failed;       /* settings that aborted or were stopped */
    char name[24];
} duel;

/* Prints, for each level of error, the best of ngspice's own settings and the best of ours, and fills d. */
void report_duel(const bench_case *c, int count, const row *rows, duel *d);

/* All cases in one table, with geometric means, and those through ngspice; netlists: only these. */
void report_summary(int count, const duel *d, int netlists);

#endif
