/* src/exact/fast_parts.h - what rings much faster than the rest of its mode, as parts of X.
 *
 * With the eigenvectors v (right) and u (left, u v = 1) of the rates above a sixteenth of the time scale's
 * own, X = sum v (u X) + the rest, and these parts add |c v| |u X| to guard c at most from now on, as no rate
 * grows.  Where slower ones ring too, each within a sixteenth of the next faster one, there are wider parts,
 * with these: their rest is slower still, and they reach farther.
 */
#ifndef NS_EXACT_FAST_PARTS_H
#define NS_EXACT_FAST_PARTS_H

#include <stddef.h>

typedef struct ns_exact ns_exact;
typedef struct ns_mode_kernel ns_mode_kernel;
typedef struct ns_step_map ns_step_map;
typedef struct ns_time_scale ns_time_scale;

enum { NS_LONG_STEPS = 41 };

typedef struct ns_fast_parts {
    int count;               /* parts: one a real rate, two a pair of complex ones; 0: not worth it */
    double slow_h;           /* s: the kernel's step for the rest */
    double *left;            /* count*q: what there is of each part in X, */
    double *left_size;       /* count*q: absolute values */
    double *right;           /* r*count: what each part is in w */
    double *guard;           /* rows*count: what it adds to each guard, a pair in its first part */
    unsigned char *is_first; /* count: 1: the first part of a pair */
    double *amplitude, *noise, *rest, *bound; /* count, count, q, rows: work */
    ns_step_map *step[NS_LONG_STEPS];         /* of h 2^k, with samples for the rest */
    size_t bytes;                             /* without its steps */
    struct ns_fast_parts *wider;              /* NULL: there are none */
} ns_fast_parts;

/* scale->fast; its count is 0 where no step would be longer, or the parts cannot be told apart.  Errors:
 * MEMORY. */
int ns_exact_fast_build(ns_exact *f, ns_time_scale *scale);

/* p->rest: X without the fast parts; p->bound: what these add to each guard at most, rounding included. */
void ns_exact_fast_split(const ns_exact *f, const ns_mode_kernel *k, ns_fast_parts *p);

size_t ns_exact_fast_bytes(const ns_fast_parts *p); /* of all of it, wider ones too; NULL is allowed */
void ns_exact_fast_free(ns_fast_parts *p);          /* NULL is allowed */

#endif
