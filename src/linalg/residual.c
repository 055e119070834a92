/* src/linalg/residual.c - a sum of products, and of the rounding of each product and of each sum (Ogita, Rump
 * and Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005): Dot2).
 */
#include "residual.h"

#include <math.h>

double ns_linalg_residual(double b, int count, const int *list, const double *row, size_t stride,
                          const double *x) {
    double sum = b, lost = 0;
    for (int k = 0; k < count; k++) {
        const double a = -row[(size_t)list[k] * stride], v = x[list[k]], product = a * v,
                     next = sum + product;
        const double of_product = fma(a, v, -product), back = next - sum;
        lost += of_product + ((sum - (next - back)) + (product - back));
        sum = next;
    }
    return sum + lost;
}
