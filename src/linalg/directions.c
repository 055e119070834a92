/* src/linalg/directions.c - directions at right angles to each other.
 *
 * To turn them the images are written as V R first (Gram and Schmidt, each column exact but for its own
 * rounding): rotations by Jacobi, of two columns of R at a time, then are of count numbers, not of size.
 */
#include "directions.h"

#include "dense.h"
#include "simd.h"

#include <math.h>
#include <string.h>

enum { SWEEPS = 16 };
/* Two images are at right angles if their product is below this fraction of that of their lengths. */
static const double right_angle = 1e-12;

static double *column(double *of, int c, int size) {
    return of + (size_t)c * (size_t)size;
}

static double product(int size, const double *a, const double *b) {
    ns_simd sum = {0}, other = {0};
    double rest = 0;
    int i = 0;
    for (; i + 2 * NS_LANES <= size; i += 2 * NS_LANES) {
        sum += *(const ns_simd *)(a + i) * *(const ns_simd *)(b + i);
        other += *(const ns_simd *)(a + i + NS_LANES) * *(const ns_simd *)(b + i + NS_LANES);
    }
    for (; i < size; i++)
        rest += a[i] * b[i];
    sum += other;
    for (int k = 0; k < NS_LANES; k++)
        rest += ((const double *)&sum)[k];
    return rest;
}

void ns_linalg_leave(int size, int count, const double *Q, double *x, double *along) {
    if (count == 0)
        return;
    for (int c = 0; c < count; c++)
        along[c] = -product(size, Q + (size_t)c * (size_t)size, x);
    ns_linalg_matvec_add(size, count, Q, along, x);
}

double ns_linalg_straighten(int size, int count, const double *Q, double *x, double *along) {
    ns_linalg_leave(size, count, Q, x, along);
    ns_linalg_leave(size, count, Q, x, along);
    const double length = sqrt(product(size, x, x));
    for (int i = 0; i < size; i++)
        x[i] /= length;
    return length;
}

size_t ns_linalg_turn_room(int size, int count) {
    return (size_t)count * ((size_t)size + 2 * (size_t)count);
}

/* R (count*count) of the images, V: room for as many vectors. */
static void find_factor(int size, int count, const double *image, double *V, double *R) {
    memset(R, 0, sizeof *R * (size_t)count * (size_t)count);
    for (int c = 0; c < count; c++) {
        double *v = column(V, c, size), *r = column(R, c, count);
        memcpy(v, image + (size_t)c * (size_t)size, sizeof *v * (size_t)size);
        for (int k = 0; k < c; k++) { /* one after the other: all at once would round otherwise */
            const double *along = column(V, k, size);
            r[k] = product(size, along, v);
            for (int i = 0; i < size; i++)
                v[i] -= r[k] * along[i];
        }
        r[c] = sqrt(product(size, v, v));
        for (int i = 0; i < size && r[c] > 0; i++)
            v[i] /= r[c];
    }
}

static void rotate_two(int count, double c, double s, double *a, double *b) {
    for (int i = 0; i < count; i++) {
        const double x = a[i];
        a[i] = c * x - s * b[i];
        b[i] = s * x + c * b[i];
    }
}

/* One rotation of columns a, b of `by` and of R, after which the latter are at right angles.  0: they were.
 */
static int rotate(int count, int a, int b, double *by, double *R) {
    double *Ra = column(R, a, count), *Rb = column(R, b, count);
    const double aa = product(count, Ra, Ra), bb = product(count, Rb, Rb), ab = product(count, Ra, Rb);
    if (!(fabs(ab) > right_angle * sqrt(aa * bb)))
        return 0;
    const double zeta = (bb - aa) / (2 * ab), t = (zeta >= 0 ? 1 : -1) / (fabs(zeta) + sqrt(1 + zeta * zeta)),
                 c = 1 / sqrt(1 + t * t);
    rotate_two(count, c, c * t, Ra, Rb);
    rotate_two(count, c, c * t, column(by, a, count), column(by, b, count));
    return 1;
}

/* Q = Q by, through `to`, room for as many. */
static void multiply(int size, int count, double *Q, const double *by, double *to) {
    for (int c = 0; c < count; c++)
        ns_linalg_matvec(size, count, Q, by + (size_t)c * (size_t)count, column(to, c, size));
    memcpy(Q, to, sizeof *Q * (size_t)count * (size_t)size);
}

void ns_linalg_turn(int size, int count, double *Q, const double *image, double *length, double *room) {
    double *R = room + (size_t)count * (size_t)size, *by = R + (size_t)count * (size_t)count;
    int any = 1;
    find_factor(size, count, image, room, R);
    memset(by, 0, sizeof *by * (size_t)count * (size_t)count);
    for (int c = 0; c < count; c++)
        *column(by, c, count + 1) = 1;
    for (int sweep = 0; sweep < SWEEPS && any; sweep++) {
        any = 0;
        for (int a = 0; a < count; a++)
            for (int b = a + 1; b < count; b++)
                any |= rotate(count, a, b, by, R);
    }
    for (int c = 0; c < count; c++)
        length[c] = sqrt(product(count, column(R, c, count), column(R, c, count)));
    multiply(size, count, Q, by, room);
}
