/* src/sparse/theta_step.h - steps of the theta scheme for large circuits: what they keep. */
#ifndef NS_SPARSE_THETA_STEP_H
#define NS_SPARSE_THETA_STEP_H

#include "packed_laws.h"

typedef struct ns_sparse_theta {
    /* of the circuit */
    double g;                 /* length of its Euler steps, theta h, s */
    int no_commands_by_state; /* 1: no command depends on the state */
    double *units;            /* n: 1 over square roots of M; 0 of algebraic rows */
    /* where steps are */
    int running;   /* w and mode of the engine are those at t: */
    double t;      /* end of the last step, s */
    double corner; /* up to when inputs have no corner, s */
    /* the last step */
    double moves; /* how far it moved w, in units */
    int smooth;   /* no law broke in it, nothing jumped, */
    double *by;   /* n: and in g it moved w by this */
    /* right-hand side and laws */
    int known;           /* those of the mode and of inputs base_z: */
    double *base;        /* n+m: the right-hand side of (P2) without w */
    double *base_z;      /* nz */
    double *z;           /* nz: inputs at t + g */
    ns_packed_laws laws; /* of the mode */
} ns_sparse_theta;

#endif
