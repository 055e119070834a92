/* src/engine/doubt.h - guards that only the bound on their rounding excuses, looked at together. */
#ifndef NS_DOUBT_H
#define NS_DOUBT_H

/* What is kept of the equations of a map for that. */
typedef struct ns_doubt {
    int size, guards, q;
    double *Z;     /* size*guards: K^-T c_g, c_g guard g as a function of (x, lambda_J) */
    double *terms; /* size*q: |K| |X|, the terms of each row of (P2) */
    double *own;   /* guards*q: the noise of the guards without what Z makes of those terms */
} ns_doubt;

/* Room for them, freed by free(); NULL: no memory. */
ns_doubt *ns_doubt_create(int size, int guards, int q);

/* Whether the guards (as read: guards), each of which is above -tol noise, hold together, for inputs in (q).
 * NS_OK, NS_GUARD, NS_E_MEMORY. */
int ns_doubt_settle(const ns_doubt *d, const double *guard, const double *in, double tol);

#endif
