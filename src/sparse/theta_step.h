/* src/sparse/theta_step.h - steps of the scheme for large circuits: what they keep. */
#ifndef NS_SPARSE_THETA_STEP_H
#define NS_SPARSE_THETA_STEP_H

#include "packed_laws.h"

typedef struct ns_sparse_theta {
    double g;       /* theta h */
    double t;       /* to where steps have come, */
    double corner;  /* up to when inputs go on as they do */
    int running;    /* w and mode of the marcher are those at t */
    int known;      /* base and laws are those of the mode and of inputs at base_z */
    int whole_pass; /* no command looks at the state, no law has inputs */
    double moves;   /* what the last step moves, a square root of an energy */
    double *base;   /* size: the right-hand side of (P2) without w */
    double *base_z; /* nz */
    double *z;      /* nz: at t + g */
    int smooth;     /* nothing leapt in the last step, */
    double *by;     /* n: which moved w by this in g */
    double *units;  /* n: 1 over square roots of M; 0 of algebraic rows */
    ns_packed_laws laws;
} ns_sparse_theta;

#endif
