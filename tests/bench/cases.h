/* tests/bench/cases.h - the circuits that the benchmark runs, what is measured of each, and the right answer.
 */
#ifndef NONSMOOTH_TESTS_CASES_H
#define NONSMOOTH_TESTS_CASES_H

#include "deck.h"
#include "oracle.h"

enum { CASE_UNKNOWNS = 6, CASE_TIMES = 10, CASE_VALUES = CASE_UNKNOWNS * CASE_TIMES };

typedef struct bench_case bench_case;
struct bench_case {
    const char *name, *title;
    const char *origin;                                     /* of the reference */
    deck *net;                                              /* the circuit, or NULL: */
    ns_system *system;                                      /* written by hand, starts at w = 0 */
    void (*netlist)(const deck_models *models, FILE *file); /* its lines, of hand-written ones */
    const char *file;                                       /* netlists/FILE.cir: only through ngspice */
    double end;                                             /* s */
    double unit; /* the time in which things happen (a period, a time constant): steps are fractions of it */
    int times;
    double time[CASE_TIMES]; /* at which all is compared; the last is `end` */
    int unknowns;
    struct {
        int is_current, of; /* a node's voltage or a part's current; of hand-written ones: index in x */
        char vector[16];    /* for ngspice */
    } unknown[CASE_UNKNOWNS];
    double accumulates; /* the instant at which events accumulate, NAN: they do not */
    int size, extra;    /* as the maker of the case reads them: stages, switches, ... */
    int large;          /* beyond what dense engines can do */
    int slow;           /* left out of the quick benchmark */
    int through;        /* one of the twenty netlists that are compared through ngspice */
    int from_dc;        /* of those with a file: starts at the operating point */
    int feeds_back;     /* its switches' controls depend on them: ngspice also gets hysteresis */
    /* Writes the right values, time by time, `unknowns` each.  fineness: 1, or smaller for shorter steps. */
    void (*exact)(const bench_case *c, real fineness, real *values);

    /* made by case_prepare() */
    double right[CASE_VALUES], scale[CASE_UNKNOWNS]; /* scale: the largest right value */
    double right_error; /* of the reference, relative to scale: how far it moves with its own step */
};

/* Case number `at` of all, from 0; 0 if there are no more.  quick: shorter runs of the longest.  The caller
 * frees it with case_free(). */
int case_make(int at, int quick, bench_case *c);
void case_prepare(bench_case *c); /* the right values */
void case_free(bench_case *c);

/* What is compared. */
void case_voltage(bench_case *c, int node);
void case_current(bench_case *c, int part);
/* `count` times, equally far apart up to end. */
void case_times(bench_case *c, double end, int count);

/* The largest error of values (as of exact) relative to scale; NAN values count as 1e300. */
double case_error(const bench_case *c, const double *values);

/* The makers, by file. */
void case_lc_bridge(bench_case *c);
void case_six_pulse(bench_case *c);
void case_buck(bench_case *c, int diode, double load); /* diode: in place of the lower switch */
void case_literature(bench_case *c);
void case_multiplier(bench_case *c, int stages);
void case_ladder(bench_case *c, int switches);
void case_multilevel(bench_case *c, int cells, double end); /* cells an arm */
void case_chopper(bench_case *c);
void case_bouncing(bench_case *c);
int case_netlist(bench_case *c, int at); /* 0: there are no more */

/* The elements of a case with a file. */
void case_netlist_lines(const bench_case *c, const deck_models *models, FILE *file);

#endif
