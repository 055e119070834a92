/* src/engine/open.h - guards of which only sums are determined. */
#ifndef NS_OPEN_H
#define NS_OPEN_H

/* Whether some amount of what is open makes all guards hold:  guard + N alpha >= 0.  N: guards*m, column by
 * column; rows of zeros are passed over; size (guards): by how much each may be rounding.
 * OK, GUARD (there is none), MEMORY. */
int ns_open_settle(int guards, int m, const double *N, const double *guard, const double *size);

#endif
