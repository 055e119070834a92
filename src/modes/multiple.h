/* src/modes/multiple.h - guards that are one but for a factor: both break in one instant, wherever they do.
 */
#ifndef NS_MODES_MULTIPLE_H
#define NS_MODES_MULTIPLE_H

#include <math.h>

/* 1 if a (count) is b times a positive factor, but for rounding; size (count): how much each number weighs,
 * NULL: all alike. */
static inline int ns_modes_is_multiple(int count, const double *a, const double *b, const double *size) {
    static const double alike = 1e-9;
    double largest = 0, factor = 0, off = 0;
    for (int k = 0; k < count; k++) {
        const double weighed = fabs(b[k]) * (size ? size[k] : 1);
        if (weighed > largest) {
            largest = weighed;
            factor = a[k] / b[k];
        }
    }
    for (int k = 0; k < count; k++)
        off = fmax(off, fabs(a[k] - factor * b[k]) * (size ? size[k] : 1));
    return factor > 0 && off <= alike * factor * largest;
}

#endif
