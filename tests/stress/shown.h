/* tests/stress/shown.h - what ngspice shows of a netlist, judged by laws that averages and peaks obey.
 *
 * The average of an inductor's voltage is what its current gained.  Peaks and valleys of every node and every
 * inductor are those of a run with 64 times shorter steps of .tran and lines=1e-5.  "sparse" needs no more
 * than 4 times the points of "exact".
 */
#ifndef NONSMOOTH_TESTS_SHOWN_H
#define NONSMOOTH_TESTS_SHOWN_H

#include "judge.h"

judge_finding shown(const netlist *n, const judge_options *o);

#endif
