/* src/theta/theta_internal.h - the theta stepper from inside: shared by theta/create.c, theta/step_map.c,
 * map_cache.c, problem.c. */
#ifndef NS_THETA_INTERNAL_H
#define NS_THETA_INTERNAL_H

#include "linalg/dense.h"
#include "modes/shared_branch.h"
#include "nonsmooth/impulse.h"

/* The step of one mode and one length as a matrix.  It acts on the q inputs
 *   in = (eta (r), z (nz), 1),   eta = w + h d
 * where w (r) are the rows of M x that differ from zero (charges, fluxes) and
 *   d = (1-theta) (A x + b + E z) + (1-gamma) B lambda
 * on the same rows at t_k.  See (T6): eta and z hold all that x_free needs. */
typedef struct ns_map ns_map;
struct ns_map {
    double h;
    int implicit; /* 1: theta = gamma = 1 in this map */
    int p; /* rows of step: w (r), d (r if carried), controls (nc), guards; a multiple of 4, the last may be 0
            */
    int guards;         /* how many guards, each must be >= 0, */
    int guard;          /* and the row of the first */
    double *step;       /* p*q */
    double *full;       /* (n+m)*q: x, lambda */
    double *noise;      /* guards*q: the rounding of each guard, by input, in units of eps */
    double *rate_noise; /* r*q if d is carried: the same of d */
    ns_mode *mode;      /* m */
    size_t bytes;
    ns_map *chain;         /* next in its bucket */
    ns_map *older, *newer; /* by last use */
};

enum { NS_BUCKETS = 1024, NS_RECENT = 64 };

/* Maps by (h, implicit, mode), the least recently used dropped when they need more than limit bytes. */
typedef struct ns_cache {
    ns_map *bucket[NS_BUCKETS];
    ns_map *newest, *oldest;
    size_t bytes, limit;
} ns_cache;

struct ns_theta {
    const ns_system *s;
    double *block; /* all arrays of numbers but K */
    double theta, gamma;
    int carry; /* theta or gamma below 1: d is part of the past */
    int r;     /* differential rows */
    int q;     /* inputs of a map: r + nz + 1 */
    /* the system after ns_system_split(): rows 0..r-1 differential, r..n-1 algebraic */
    double *M, *A, *B, *b, *E;
    double *T;     /* n*n */
    double *l, *u; /* m, with the bounds of commanded pairs as commanded */
    /* the past: accepted point */
    double *w, *d;   /* r */
    double *d_noise; /* r: of d, in units of eps, */
    double noisy_h;  /* which comes from a step of this length */
    ns_mode *mode;   /* m */
    double *in;      /* q: what the accepted step acted on, */
    double h;        /* its length, 0 if none was accepted since the start, */
    int implicit;    /* and kind */
    int jumped;      /* it is no step but the right side of a jump: */
    double *at;      /* n+m: x, lambda there */
    /* the trial */
    int has_trial;
    double trial_h;
    int trial_implicit;
    int trial_stands;    /* its mode is that of the accepted point; else */
    ns_mode *trial_mode; /* m */
    double *trial_in;    /* q */
    double *out;         /* p at most: r + r + nc + 2m */
    ns_map *trial_map;
    /* maps */
    ns_cache cache;
    ns_map *recent[NS_RECENT]; /* maps of `mode`, found by the exponent of h, */
    ns_map *last;              /* the one taken last; NULL: none */
    /* work */
    ns_lu *lu;
    ns_mlcp_solver *mlcp;
    int room;                      /* n+m, and as many holds as there ever were: what lu and mlcp are for */
    double *K;                     /* room^2 */
    double *X, *R;                 /* (n+m)*q, and twice that */
    double *Z;                     /* (n+m)*2m */
    double *leak;                  /* m */
    double *sum, *rate[2];         /* n */
    double *rhs;                   /* n+m */
    double *sol, *resid, *bl, *bu; /* n+m */
    ns_mode *work_mode;            /* n+m */
    int *inside;                   /* m */
    int *list;                     /* n+m: work */
    ns_shared_branch *twin;        /* pairs across switches, */
    int twins;                     /* so many */
    int failed; /* K, rhs, bl, bu hold the problem, of this size, of the call that failed last; 0: none */
    double failed_h; /* length of its step, 0: an operating point */
    ns_counts counts;
    ns_fault fault;
};

/* theta/step_map.c: builds the map of a mode; *out is not in the cache yet.  share: of the largest unknown,
 * in the units of the factors, that eps of is rounding in what is zero too.  Errors: SINGULAR, MEMORY,
 * NUMBER. */
int ns_theta_map_build(ns_theta *s, double h, int implicit, const ns_mode *mode, double share, ns_map **out);
void ns_theta_map_free(ns_map *map);

/* theta/step_map.c: K of (P2) in s->K, the pairs inside in s->inside; their number. */
int ns_theta_map_matrix(ns_theta *s, double h, int implicit, const ns_mode *mode);

/* undetermined.c: names in the fault what the mode last tried leaves open: unknowns, and lambda of pairs.
 * Uses K. */
void ns_theta_name_undetermined(ns_theta *s, double h, int implicit);

/* theta/guards.c: how many guards pair j has in a mode, and how many the mode; their entries in column k of a
 * map whose `full` is known; the size of the terms of input k of the trial; whether all of s->out hold, up to
 * tol noise: 1 or 0. */
int ns_theta_guards_of(const ns_theta *s, const ns_mode *mode, int j);
int ns_theta_guard_count(const ns_theta *s, const ns_mode *mode);
void ns_theta_guard_fill(const ns_theta *s, ns_map *map, int k);
double ns_theta_input_size(const ns_theta *s, const ns_map *map, int k);
int ns_theta_guards_hold(const ns_theta *s, const ns_map *map, double tol);

/* theta/guards.c: the mode (m) with the pairs changed whose guards broke; 0 if there is none. */
int ns_theta_guards_flip(const ns_theta *s, const ns_map *map, double tol, ns_mode *mode);

/* guard_rounding.c: what d may be off by after the step of this map, before it is accepted: r. */
void ns_theta_rate_rounding(const ns_theta *s, const ns_map *map, double *rounding);

/* map_cache.c */
ns_map *ns_theta_cache_find(ns_cache *c, double h, int implicit, const ns_mode *mode, int m);
void ns_theta_cache_insert(ns_cache *c, ns_map *map, int m);
/* Drops old maps until the limit holds; never `keep`.  Returns how many were dropped. */
long ns_theta_cache_trim(ns_cache *c, int m, const ns_map *keep);
void ns_theta_cache_clear(ns_cache *c);

/* theta/create.c: room for problems of n+m+holds unknowns.  Errors: MEMORY (it is as before). */
int ns_theta_room(ns_theta *s, int holds);

/* step.c: forgets the maps of the mode that was. */
void ns_theta_forget_recent(ns_theta *s);

/* state.c: gives commanded pairs the bounds of their state, which their mode tells. */
void ns_theta_set_bounds(ns_theta *s);

/* Keeps the status in the fault and returns it. */
static inline int ns_theta_fail(ns_theta *s, int status) {
    s->fault.status = (ns_status)status;
    return status;
}

/* theta/step.c: the map of (h, implicit, mode) from the cache, or built and kept.  Errors:
 * ns_theta_map_build(). */
int ns_theta_find_map(ns_theta *s, double h, int implicit, const ns_mode *mode, ns_map **out);

/* theta/step.c: d after an implicit step of length h from here, or (second) of twice that length, which is
 * not taken: errors of ns_theta_try(), GUARD if the mode breaks; and d here from the two, extrapolated. */
int ns_theta_probe(ns_theta *s, double h, const double *z, int second);
void ns_theta_take_rates(ns_theta *s);

/* state.c: the accepted point becomes the right side of a jump from it, at inputs z (nz).  Of jump: x,
 * lambda, X, Lambda, mode. */
void ns_theta_jump(ns_theta *s, const ns_impulse *jump, const double *z);
/* To where another engine came: w, x and lambda one after the other, inputs. */
void ns_theta_put(ns_theta *s, const double *w, const double *at, const ns_mode *mode, const double *z);
/* state.c: what ns_theta_controls() gives from now on is gx x. */
void ns_theta_set_controls(ns_theta *s, const double *x);
/* state.c: w there, row i; s has it before the jump. */
double ns_theta_jump_w(const ns_theta *s, int i, const double *x, const double *X, const double *Lambda);

/* The problem that failed last is gone: its arrays get used, or nobody asks for it any more. */
static inline void ns_theta_forget_failure(ns_theta *s) {
    s->failed = 0;
}

/* So is the trial. */
static inline void ns_theta_discard(ns_theta *s) {
    s->has_trial = 0;
    ns_theta_forget_failure(s);
}

/* impulse.c: ns_theta_impulse(), but what the laws leave open of values is as near to `near` (n+m: x, lambda)
 * as it can be (NULL: to zero).  *jumps: there are impulses. */
int ns_reinit_impulse_solve(ns_theta *s, const double *z, const double *slope, const double *near,
                            const ns_impulse *out, int *jumps);

/* step_lcp.c: (P1) of a step, unreduced (x as equality rows), from s->trial_in and the mode s->trial_mode,
 * which gets the answer's.  fraction > 0: with leaks of that fraction.  Errors: those of ns_mlcp_solve(). */
int ns_theta_lcp_solve(ns_theta *s, double h, int implicit, double fraction);

/* step_lcp.c: the same of an implicit step from w (r) with inputs z + h slope (nz; slope NULL: z), from the
 * mode (m), which gets the answer's.  Overwrites the trial. */
int ns_theta_lcp_propose(ns_theta *s, double h, double fraction, const double *w, const double *z,
                         const double *slope, ns_mode *mode);

/* problem.c: leaves that problem, without leaks, for ns_theta_problem(): the step failed. */
void ns_theta_lcp_keep(ns_theta *s, double h, int implicit);

/* problem.c: the same for M x' = 0, with nhold unknowns held at hold_x; fills x (n).  mode: m. */
int ns_theta_lcp_dc(ns_theta *s, const double *z, int nhold, const int *hold, const double *hold_x,
                    ns_mode *mode, double *x);

#endif
