/* tests/rig/callbacks.c - functions of a model with one x and one pair that several tests want. */
#include "callbacks.h"

#include <math.h>

const double all_0[4] = {0}, all_infinite[4] = {INFINITY, INFINITY, INFINITY, INFINITY};

int give_0(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = 0;
    return 0;
}

int give_1(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = 1;
    return 0;
}

int give_minus_1(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = -1;
    return 0;
}

int give_minus_lambda(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = -at->lambda[0];
    return 0;
}
