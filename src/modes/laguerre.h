/* src/modes/laguerre.h - exact steps out of implicit Euler ones (E1), (E2).
 *
 * Inside a mode w' = G w, and E = (1 - g G)^-1 is one implicit Euler step of length g, D = E - 1.  Then
 *
 *     (E1)  exp(tau G) = sum_i (-1)^i L_i(tau/g) D^i E          L_i: Laguerre polynomials
 *     (E2)  exp(tau G) = sum_i b_i(tau/g) D^i,   b_0 = 1,  b_i = (-1)^i (L_i - L_{i-1})
 *
 * Cut off after NS_ORDER terms, with L_8(1/gamma) = 0, a step h = g/gamma is L-stable, of order 8, with
 * the error 2.7e-6 (h |G|)^9 (Norsett's restricted Pade approximation).  What E solves for, x and lambda,
 * comes along by (E1).
 */
#ifndef NS_MODES_LAGUERRE_H
#define NS_MODES_LAGUERRE_H

enum { NS_ORDER = 8 };

/* The fourth root of L_8 is 1/gamma.  Steps of h |G| up to NS_REACH are good to rounding. */
#define NS_POLE 4.26670017028765879364942182690 /* 1/gamma */
#define NS_REACH 0.05

/* What |L_i| is below from 0 to 1/gamma. */
extern const double ns_modes_laguerre_max[NS_ORDER];

/* c_i = (-1)^i L_i(s), i < count, which is NS_ORDER or one more; s >= 0. */
void ns_modes_laguerre(double s, int count, double *c);

/* b_i(s), i <= NS_ORDER. */
void ns_modes_laguerre_steps(double s, double *b);

#endif
