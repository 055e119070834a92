/* tests/rig/callbacks.h - functions of a model with one x and one pair that several tests want: constants,
 * -lambda. */
#ifndef NONSMOOTH_TESTS_CALLBACKS_H
#define NONSMOOTH_TESTS_CALLBACKS_H

#include "nonsmooth/model.h"

int give_0(const ns_point *at, void *data, double *out);
int give_1(const ns_point *at, void *data, double *out);
int give_minus_1(const ns_point *at, void *data, double *out);
int give_minus_lambda(const ns_point *at, void *data, double *out);

/* M, l, u of up to four pairs. */
extern const double all_0[4], all_infinite[4];

#endif
