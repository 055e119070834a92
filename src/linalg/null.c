/* src/linalg/null.c - what a singular matrix leaves open: by the singular value decomposition, of LAPACK. */
#include "null.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

#include "nonsmooth/status.h"

static const double rounding = 1e-12; /* singular values below, relative to the largest */

/* The right singular vectors of the scaled matrix, V transposed, and its singular values, largest first. */
static int decompose(int n, const double *a, const double *rows, const double *units, double *scaled,
                     double *value, double *vt) {
    const size_t m = (size_t)n;
    double none = 0, *superb = malloc(m * sizeof *superb);
    if (!superb)
        return NS_E_MEMORY;
    for (size_t j = 0; j < m; j++)
        for (size_t i = 0; i < m; i++)
            scaled[i + j * m] = a[i + j * m] * rows[i] * units[j];
    const lapack_int info =
        LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'N', 'A', n, n, scaled, n, value, &none, 1, vt, n, superb);
    free(superb);
    return info == 0 ? NS_OK : info > 0 ? NS_E_NUMBER : NS_E_MEMORY;
}

int ns_linalg_null_weights(int n, const double *a, const double *rows, const double *units, double *weight) {
    const size_t m = (size_t)n;
    for (size_t j = 0; j < m; j++)
        weight[j] = 0;
    if (n == 0)
        return NS_OK;
    double *scaled = malloc((2 * m * m + m) * sizeof *scaled);
    if (!scaled)
        return NS_E_MEMORY;
    double *vt = scaled + m * m, *value = vt + m * m;
    const int status = decompose(n, a, rows, units, scaled, value, vt);
    for (size_t k = 0; status == NS_OK && k < m; k++)
        for (size_t j = 0; j < m && !(value[k] > rounding * value[0]); j++)
            weight[j] = hypot(weight[j], vt[k + j * m]);
    free(scaled);
    return status;
}
