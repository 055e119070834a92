/* tests/rig/generators.h - random problems of every class, each made backwards from an answer. */
#ifndef NONSMOOTH_TESTS_GENERATORS_H
#define NONSMOOTH_TESTS_GENERATORS_H

#include "sample.h"

typedef enum generator_class {
    CLASS_P,              /* P-matrices, also neither symmetric nor monotone; one answer */
    CLASS_PASSIVE,        /* networks of R, L, C, ideal diodes, switches, transformers: reduced and not */
    CLASS_COPOSITIVE,     /* copositive-plus */
    CLASS_M,              /* M-matrices, Stieltjes and weakly dominant ones among them */
    CLASS_DEGENERATE,     /* ties: lambda_i = y_i = 0, short numbers, equal rows, linear programs */
    CLASS_BOXES,          /* bounds of every sort */
    CLASS_EQUALITIES,     /* mixed with complementarity, redundant ones among them */
    CLASS_MIXED,          /* any of these matrices under all laws at once */
    CLASSES,              /* so far: each has an answer that is known */
    CLASS_NEAR = CLASSES, /* with or without a solution, by a little: s->none */
    CLASS_INFEASIBLE,     /* without, and proved so */
    ALL_CLASSES
} generator_class;

const char *generator_name(int class);
int generator_of(const char *name); /* -1: no such class */

/* Makes problem `number` of a class with at most max <= s->cap pairs; the same on every machine. */
void generate(sample *s, int class, unsigned long long number, int max);

/* networks.c.  Steps of passive networks with m devices, W = D + h C W^-1 B (benchmarks: m up to 1024), and
 * whole networks whose nodes are equalities (at most max of all). */
void generate_reduced(sample *s, int m);
void generate_whole(sample *s, int max);

#endif
