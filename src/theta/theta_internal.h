/* src/theta/theta_internal.h - the theta stepper from inside. */
#ifndef NS_THETA_INTERNAL_H
#define NS_THETA_INTERNAL_H

#include "linalg/dense.h"
#include "modes/mode.h"
#include "modes/mode_table.h"
#include "nonsmooth/impulse.h"

/* The step of one mode and one length as a matrix.  It acts on the q inputs
 *   in = (eta (r), z (nz), 1),   eta = w + h d
 * where w (r) are the rows of M x that differ from zero (charges, fluxes) and
 *   d = (1-theta) (A x + b + E z) + (1-gamma) B lambda
 * on the same rows at t_k.  See (T6): eta and z hold all that x_free needs. */
typedef struct ns_map {
    /* what it is the map of */
    ns_mode_entry entry; /* its place in the table, by mode and h; by -h if implicit */
    double h;            /* length of the step, s */
    int implicit;        /* 1: theta = gamma = 1 */

    /* the matrices, column by column */
    int p;        /* rows of step: w (r), d (r if carried), controls (nc), guards; zeros to a multiple of 4 */
    int guards;   /* number of guards: rows of step that are >= 0 while the mode holds */
    int guard;    /* row of the first guard in step */
    double *step; /* p*q */
    double *full; /* (n+m)*q: x, lambda */
    double *rounding;   /* guards*q: the rounding of each guard, by input, in units of eps */
    double *d_rounding; /* r*q if d is carried: the same of d */
} ns_map;

enum { NS_RECENT = 64 };

/* The accepted point: what is saved and restored together.  Written by state.c alone. */
typedef struct ns_past {
    double *w;           /* r: charges and fluxes, M x */
    double *d;           /* r: slope of w as (T6) takes it along; zero if it is not carried */
    double *d_rounding;  /* r: rounding of d, in units of eps */
    double *x_lambda;    /* n+m: x, lambda on the right side of a jump; follows w, d, d_rounding in memory */
    double *in;          /* q: inputs that the accepted step acted on; after a jump w and z */
    double d_rounding_h; /* length of the step that d_rounding comes from, s */
    double h;            /* length of the accepted step, s; 0: none since the start */
    int implicit;        /* 1: that step had theta = gamma = 1 */
    int jumped;          /* 1: the point is the right side of a jump, not the end of a step */
    ns_mode *mode;       /* m */
} ns_past;

/* The step tried last. */
typedef struct ns_trial {
    int has;       /* 1: it may be accepted */
    int implicit;  /* 1: theta = gamma = 1 */
    int same_mode; /* 1: it is in the accepted mode, not in that below */
    double h;      /* its length, s */
    ns_mode *mode; /* m */
    double *in;    /* q: inputs of its map */
    double *out;   /* p of its map: w, d if carried, controls, guards */
    ns_map *map;   /* its map */
} ns_trial;

/* An entry of M: what a charge or flux takes from an unknown. */
typedef struct ns_stored {
    int charge, unknown;
    double value;
} ns_stored;

struct ns_theta {
    /* the system, rows combined: 0..r-1 differential, r..n-1 algebraic */
    const ns_system *s;  /* as it was given */
    double theta, gamma; /* of the scheme */
    int carry;           /* 1: theta or gamma is below 1, and d is part of the past */
    int r;               /* differential rows */
    int q;               /* inputs of a map: r + nz + 1 */
    double *T;           /* n*n: combines rows, ns_system_split() */
    double *M, *A, *B;   /* n*n, n*n, n*m: T times those of the system */
    double *b, *E;       /* n, n*nz: T times those of the system */
    double *unit;        /* r: of a charge or flux, the square root of an energy: sqrt(max_k |M_ik|) */
    ns_stored *stored;   /* stores: entries of M that are not zero, column by column */
    int stores;
    double *l, *u;            /* m: bounds of lambda, of commanded pairs those of their state */
    ns_shared_branch *shared; /* shared_count: pairs across commanded ones */
    int shared_count;

    /* the steps */
    ns_past past;   /* the accepted point */
    ns_trial trial; /* the step tried last */
    /* of the step that is tried next: nz: inputs at its begin less those at its end, between which they are
     * straight, so that charges and fluxes get their exact integral; NULL: they get what the scheme makes of
     * them.  Whoever sets it keeps it until that step. */
    const double *fall;
    struct {
        int size; /* K, rhs, bl, bu hold the problem, of this size, of the call that failed last; 0: none */
        double h; /* length of its step, s; 0: an operating point */
    } failure;
    ns_counts counts; /* what it cost so far */
    ns_fault fault;   /* of the last call that failed */

    /* maps */
    ns_mode_table maps;        /* all that are kept */
    ns_map *recent[NS_RECENT]; /* maps of the accepted mode by the exponent of h */
    ns_map *last;              /* map used last in the accepted mode; NULL: none */

    /* work: contents are nobody's between two calls */
    double *block;                /* all arrays of numbers but K */
    int capacity;                 /* of K, lu and mlcp: n+m and the largest number of unknowns ever held */
    double *K;                    /* capacity^2: matrix of (P2) or of (P1) unreduced */
    ns_lu *lu;                    /* factors of K */
    ns_mlcp_solver *mlcp;         /* (P1) */
    double searched, search_left; /* instructions of its branch and bound: so far, and allowed */
    long passing_factors;         /* of counts.factors: those that (P1) made, which are not kept */
    double expanded;              /* instructions of expansions in powers of h, about */
    double *X, *R;                /* (n+m)*q, and twice that and q: solutions of (P2), residuals */
    double *Z;                    /* (n+m)*2m: guards as functions of (x, lambda) */
    double *leak;                 /* m: conductances and resistances of leaks */
    double *sum;                  /* n */
    double *rate[2];              /* n: slopes of two probes */
    double *rhs;                  /* 2n+m: q of (P1) unreduced */
    double *sol;                  /* 2n+m: x, lambda */
    double *resid;                /* 2n+m: y of (P1) */
    double *bl, *bu;              /* 2n+m: bounds of (P1) unreduced */
    ns_mode *lcp_mode;            /* 2n+m: mode of (P1) unreduced */
    int *inside;                  /* m: pairs inside in K */
    int *list;                    /* 2n+m: places of what is not zero */
};

/* --- step_map.c --- */

/* Builds the map of a mode; *out is not in the cache yet.  fraction: of the largest unknown, in the units of
 * the factors; eps of that is rounding in what is zero too.  Errors: SINGULAR, MEMORY, NUMBER. */
int ns_theta_map_build(ns_theta *s, double h, int implicit, const ns_mode *mode, double fraction,
                       ns_map **out);
void ns_theta_map_free(ns_map *map);

/* K of (P2) in s->K, the pairs inside in s->inside; their number. */
int ns_theta_map_matrix(ns_theta *s, double h, int implicit, const ns_mode *mode);

/* --- refine.c: K of (P2) in s->K, its factors, right-hand sides in s->R, solutions in s->X --- */

/* Two steps of refinement: errors of X become small against the terms of each row rather than against the
 * largest number about, so that a voltage of zero beside one of 1 V comes out as zero.  Where the first one
 * shows that digits are lost (*exactly), steps as below.  Returns what the last step still moved, relative to
 * X: rounding if K is regular, everything if a pivot was only rounding. */
double ns_theta_refine(ns_theta *s, int size, int *exactly);

/* Steps with exact residuals, one, and more while they converge: errors become rounding of each unknown, so
 * that a capacitor of 1 pF in series with 100 uF has the voltage of its own charge. */
double ns_theta_refine_exactly(ns_theta *s, int size);

/* The places of what is not zero, every `step` numbers, into list; how many. */
int ns_theta_refine_nonzeros(int count, const double *from, int step, int *list);

/* residual ((n+nj)*q): right-hand sides, which become rhs - K X; summed up in long double, or (exactly) with
 * twice the digits of a double.  Uses s->list. */
void ns_theta_refine_residual(ns_theta *s, int size, int exactly, double *residual);

/* --- guards.c --- */

/* How many guards pair j has in a mode; how many the mode has. */
int ns_theta_guards_of(const ns_theta *s, const ns_mode *mode, int j);
int ns_theta_guard_count(const ns_theta *s, const ns_mode *mode);

/* The guards' entries in column k of a map whose `full` is known.  Overwrites s->Z. */
void ns_theta_guard_fill(const ns_theta *s, ns_map *map, int k);

/* The size of the terms of input k of the trial. */
double ns_theta_input_size(const ns_theta *s, const ns_map *map, int k);

/* 1 if all guards in s->trial.out hold, up to tol times their rounding in units of eps. */
int ns_theta_guards_hold(const ns_theta *s, const ns_map *map, double tol);

/* The mode (m) with the pairs changed whose guards do not hold; 0 if there is none. */
int ns_theta_guards_flip(const ns_theta *s, const ns_map *map, double tol, ns_mode *mode);

/* --- guard_rounding.c --- */

/* What d may be off by after the step of this map, in units of eps: r numbers. */
void ns_theta_rate_rounding(const ns_theta *s, const ns_map *map, double *rounding);

/* --- create.c --- */

/* Capacity for problems of n+m+holds unknowns.  Errors: MEMORY (it is as before). */
int ns_theta_reserve(ns_theta *s, int holds);

/* --- step.c --- */

/* The map of (h, implicit, mode) from the cache, or built and kept.  Errors: ns_theta_map_build(). */
int ns_theta_find_map(ns_theta *s, double h, int implicit, const ns_mode *mode, ns_map **out);

/* Forgets recent maps: the accepted mode changed, or maps were dropped. */
void ns_theta_forget_recent(ns_theta *s);

/* d after an implicit step of length h from here, or (second) of twice that length; it is not accepted.
 * Errors: those of ns_theta_try(), GUARD if the mode breaks. */
int ns_theta_probe(ns_theta *s, double h, const double *z, int second);

/* --- state.c --- */

/* d at the accepted point, extrapolated from the two probes. */
void ns_theta_take_rates(ns_theta *s);

/* Bounds of commanded pairs by their mode. */
void ns_theta_set_bounds(ns_theta *s);

/* The accepted mode (m) becomes this one, or the charges and fluxes w (r); nothing else does. */
void ns_theta_set_mode(ns_theta *s, const ns_mode *mode);
void ns_theta_set_charges(ns_theta *s, const double *w);

/* The accepted point becomes the right side of a jump from it, at inputs z (nz).  Of jump: x, lambda, X,
 * Lambda, mode. */
void ns_theta_jump(ns_theta *s, const ns_impulse *jump, const double *z);

/* w there, row i; s has it before the jump. */
double ns_theta_jump_w(const ns_theta *s, int i, const double *x, const double *X, const double *Lambda);

/* The accepted point becomes that of another engine: w (r), x and lambda one after the other (n+m), inputs
 * (nz). */
void ns_theta_put(ns_theta *s, const double *w, const double *x_lambda, const ns_mode *mode, const double *z);

/* What ns_theta_controls() gives from now on is gx x. */
void ns_theta_set_controls(ns_theta *s, const double *x);

/* --- step_lcp.c --- */

/* (P1) of a step, unreduced (x as equality rows), from s->trial.in and the mode s->trial.mode, which gets the
 * answer's.  fraction > 0: with leaks of that fraction.  Errors: those of ns_mlcp_solve(). */
int ns_theta_lcp_solve(ns_theta *s, double h, int implicit, double fraction);

/* The same of an implicit step from w (r) with inputs z + h slope (nz; slope NULL: z), from the mode (m),
 * which gets the answer's.  Overwrites the trial. */
int ns_theta_lcp_propose(ns_theta *s, double h, double fraction, const double *w, const double *z,
                         const double *slope, ns_mode *mode);

/* Leaves the problem of the step, without leaks, for ns_theta_problem(): the step failed. */
void ns_theta_lcp_keep(ns_theta *s, double h, int implicit);

/* The same for M x' = 0, with nhold unknowns held at hold_x; fills x (n).  mode: m. */
int ns_theta_lcp_dc(ns_theta *s, const double *z, int nhold, const int *hold, const double *hold_x,
                    ns_mode *mode, double *x);

/* --- undetermined.c --- */

/* Names in the fault what the mode tried last does not determine: unknowns, and lambda of pairs.  Overwrites
 * s->K. */
void ns_theta_name_undetermined(ns_theta *s, double h, int implicit);

/* --- small things --- */

/* Keeps the status in the fault and returns it. */
static inline int ns_theta_fail(ns_theta *s, int status) {
    s->fault.status = (ns_status)status;
    return status;
}

/* The problem that failed last is gone: its arrays get used, or nobody asks for it any more. */
static inline void ns_theta_forget_failure(ns_theta *s) {
    s->failure.size = 0;
}

/* So is the trial. */
static inline void ns_theta_discard(ns_theta *s) {
    s->trial.has = 0;
    ns_theta_forget_failure(s);
}

#endif
