/* tests/rig/matrices.c - random P-, M-, semidefinite and copositive-plus matrices. */
#include "matrices.h"

#include <math.h>

#include <lapacke.h>

static double *W(sample *s, int i, int j) {
    return sample_entry(s, i, j);
}

void matrix_dominant(sample *s, double least, double density) {
    for (int i = 0; i < s->m; i++) {
        double sum = 0;
        for (int j = 0; j < s->m; j++)
            if (j != i && dice_chance(&s->dice, density))
                sum += fabs(*W(s, i, j) = sample_value(s));
        *W(s, i, i) = sum + least;
    }
}

/* s->work = V, m*rank; W += V V' scale */
static void add_square(sample *s, int first, int n, int rank, double scale) {
    for (int k = 0; k < n * rank; k++)
        s->work[k] = sample_value(s);
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double sum = 0;
            for (int k = 0; k < rank; k++)
                sum += s->work[i + k * n] * s->work[j + k * n];
            *W(s, first + i, first + j) += scale * sum;
            if (i != j)
                *W(s, first + j, first + i) += scale * sum;
        }
}

static void add_skew(sample *s, double size) {
    for (int i = 0; i < s->m; i++)
        for (int j = 0; j < i; j++) {
            double v = size * sample_value(s);
            *W(s, i, j) += v;
            *W(s, j, i) -= v;
        }
}

void matrix_add_skew(sample *s) {
    add_skew(s, 1);
}

void matrix_definite(sample *s, double ridge, double skew) {
    add_square(s, 0, s->m, s->m, s->exact ? 1 : 1.0 / s->m);
    for (int i = 0; i < s->m; i++)
        *W(s, i, i) += ridge;
    if (skew > 0)
        add_skew(s, skew);
}

void matrix_semidefinite(sample *s, int rank, int skew) {
    add_square(s, 0, s->m, rank, 1);
    if (skew)
        add_skew(s, 1);
}

/* Unit diagonal, the rest of a size with which inverses of m = 200 stay below some 1e6. */
void matrix_triangular(sample *s) {
    int m = s->m;
    double size = 2 / sqrt(m);
    for (int i = 0; i < m; i++)
        s->work[i] = i;
    for (int i = m - 1; i > 0; i--) {
        int k = dice_below(&s->dice, i + 1);
        double t = s->work[i];
        s->work[i] = s->work[k];
        s->work[k] = t;
    }
    for (int a = 0; a < m; a++)
        for (int b = 0; b <= a; b++)
            *W(s, (int)s->work[b], (int)s->work[a]) =
                a == b ? 0.5 + dice_uniform(&s->dice) : size * dice_either(&s->dice);
}

static double binomial(int n, int k) {
    double c = 1;
    for (int i = 1; i <= k; i++)
        c = c * (n - k + i) / i;
    return c;
}

void matrix_totally_positive(sample *s, int which) {
    for (int i = 0; i < s->m; i++)
        for (int j = 0; j < s->m; j++)
            *W(s, i, j) = which == 0   ? 1 / (1 + i + 1.5 * j)
                          : which == 1 ? fmin(i, j) + 1
                                       : round(binomial(i + j, i));
}

void matrix_inverse_dominant(sample *s) {
    int m = s->m, pivot[1024];
    matrix_dominant(s, 0.2, 0.5);
    LAPACKE_dgetrf(LAPACK_COL_MAJOR, m, m, s->W, m, pivot);
    LAPACKE_dgetri(LAPACK_COL_MAJOR, m, s->W, m, pivot);
}

void matrix_scale(sample *s, double decades) {
    for (int i = 0; i < s->m; i++) {
        double r = dice_decades(&s->dice, -decades, decades), c = dice_decades(&s->dice, -decades, decades);
        for (int k = 0; k < s->m; k++) {
            *W(s, i, k) *= r;
            *W(s, k, i) *= c;
        }
    }
}

void matrix_m_dominant(sample *s, double least, double density) {
    matrix_dominant(s, least, density);
    for (int i = 0; i < s->m; i++)
        for (int j = 0; j < s->m; j++)
            if (i != j)
                *W(s, i, j) = -fabs(*W(s, i, j));
}

static void conductance(sample *s, int a, int b, double g) {
    *W(s, a, a) += g;
    *W(s, b, b) += g;
    *W(s, a, b) -= g;
    *W(s, b, a) -= g;
}

/* A tree, so that it hangs together, and as many branches again. */
void matrix_laplacian(sample *s, double lo, double hi, int grounded) {
    for (int k = 1; k < 2 * s->m; k++) {
        int a = k < s->m ? k : dice_below(&s->dice, s->m), b = dice_below(&s->dice, k < s->m ? k : s->m);
        if (a != b)
            conductance(s, a, b, s->exact ? 1 + dice_below(&s->dice, 4) : dice_decades(&s->dice, lo, hi));
    }
    for (int k = 0; k < grounded; k++) {
        int a = dice_below(&s->dice, s->m);
        *W(s, a, a) += s->exact ? 1 : dice_decades(&s->dice, lo, hi);
    }
}

void matrix_grid(sample *s, double ground) {
    int wide = (int)ceil(sqrt(s->m));
    for (int i = 0; i < s->m; i++) {
        *W(s, i, i) = 4 + ground;
        for (int k = 0; k < 2; k++) {
            int j = k ? i + wide : i + 1;
            if (j < s->m && (k || j % wide != 0))
                *W(s, i, j) = *W(s, j, i) = -1;
        }
    }
}

void matrix_leontief(sample *s) {
    for (int i = 0; i < s->m; i++) {
        double sum = 0, keep = 0.999 * dice_uniform(&s->dice);
        for (int j = 0; j < s->m; j++)
            sum += *W(s, i, j) = dice_uniform(&s->dice) * dice_chance(&s->dice, 0.4);
        for (int j = 0; j < s->m; j++)
            *W(s, i, j) = (i == j) - (sum > 0 ? *W(s, i, j) * keep / sum : 0);
    }
}

/* n*n at the corner: x >= 0, x'Nx = 0 only for x = 0. */
static void add_nonnegative(sample *s, int n) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            *W(s, i, j) += i == j ? fabs(sample_value(s)) + (s->exact ? 1 : 0.1) : fabs(sample_value(s));
}

void matrix_strictly_copositive(sample *s, int rank) {
    add_square(s, 0, s->m, rank, 1);
    add_nonnegative(s, s->m);
}

void matrix_program(sample *s, int n, int copositive) {
    int m = s->m;
    if (copositive)
        add_nonnegative(s, n);
    else
        add_square(s, 0, n, dice_below(&s->dice, n + 1), 1);
    for (int i = n; i < m; i++)
        for (int j = 0; j < n; j++) {
            double a = sample_value(s);
            *W(s, i, j) = a;
            *W(s, j, i) = -a;
        }
}

/* The sum of copositive-plus matrices is one: x'(A+B)x = 0 makes both 0. */
void matrix_blocks(sample *s, int n) {
    int rest = s->m - n;
    add_nonnegative(s, n);
    if (rest > 0)
        add_square(s, n, rest, dice_below(&s->dice, rest + 1), 1);
    add_skew(s, 1);
}
