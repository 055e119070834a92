/* tests/bench/oracle.c - power series through modes. */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "oracle.h"

enum { T = ORACLE_TERMS, LOOKS = 16, STUCK = 1000 };
static const real pi = 3.14159265358979323846264338327950288L;

typedef struct series {
    real *x, *u, *g; /* T*n, T*nu, T*ng */
    real *dx;        /* n */
} series;

void oracle_sine(real vo, real va, real freq, real degrees, real t0, int stride, real *u) {
    const real w = 2 * pi * freq, at = w * t0 + degrees * pi / 180;
    const real turn[4] = {sinl(at), cosl(at), -sinl(at), -cosl(at)};
    real scale = va;
    for (int k = 0; k < T; k++) {
        u[k * stride] = scale * turn[k % 4] + (k == 0 ? vo : 0);
        scale *= w / (real)(k + 1);
    }
}

static void expand(const oracle *o, const real *x, real t, series *s) {
    const size_t n = (size_t)o->n, nu = (size_t)o->nu, ng = (size_t)o->ng;
    if (o->inputs)
        o->inputs(o->data, t, s->u);
    memcpy(s->x, x, n * sizeof *x);
    for (size_t k = 0; k < T; k++) {
        o->rates(o->data, s->x + k * n, s->u + k * nu, s->dx);
        if (o->guards)
            o->guards(o->data, s->x + k * n, s->dx, s->u + k * nu, s->g + k * ng);
        for (size_t i = 0; i < n && k + 1 < T; i++)
            s->x[(k + 1) * n + i] = s->dx[i] / (real)(k + 1);
    }
}

static real value(const real *series, int stride, int i, real t) {
    real sum = 0;
    for (int k = T - 1; k >= 0; k--)
        sum = sum * t + series[k * stride + i];
    return sum;
}

/* The first look at which a guard is negative, and in `which` one that is; LOOKS+1 if none is. */
static int first_broken(const oracle *o, const series *s, real h, int *which) {
    for (int look = 1; o->guards && look <= LOOKS; look++)
        for (int i = 0; i < o->ng; i++)
            if (value(s->g, o->ng, i, h * (real)look / LOOKS) < 0) {
                *which = i;
                return look;
            }
    return LOOKS + 1;
}

/* The first root between two looks, of all guards. */
static real first_root(const oracle *o, const series *s, real lo, real hi, int *which) {
    for (int k = 0; k < 80; k++) {
        const real mid = (lo + hi) / 2;
        int broken = 0;
        for (int i = 0; i < o->ng && !broken; i++)
            if (value(s->g, o->ng, i, mid) < 0) {
                broken = 1;
                *which = i;
            }
        if (broken)
            hi = mid;
        else
            lo = mid;
    }
    return hi;
}

/* One step of at most h; the length taken is returned, which is -1 where no guard broke. */
static real step(const oracle *o, real t, real h, real *x, series *s, int *which) {
    *which = -1;
    expand(o, x, t, s);
    const int look = first_broken(o, s, h, which);
    const real length =
        look > LOOKS ? h : first_root(o, s, h * (real)(look - 1) / LOOKS, h * (real)look / LOOKS, which);
    for (int i = 0; i < o->n; i++)
        x[i] = value(s->x, o->n, i, length);
    return length;
}

static long run(const oracle *o, real *x, int count, const double *times, real *out, series *s) {
    long modes = 0;
    int stuck = 0;
    real t = 0, corner = o->corner ? o->corner(o->data, 0) : INFINITY;
    for (int k = 0; k < count; k++) {
        while (t < times[k]) {
            int which;
            const real limit = fminl(fminl(t + o->h, corner), times[k]);
            const real length = step(o, t, limit - t, x, s, &which);
            stuck = length > 0 ? 0 : stuck + 1;
            if (stuck > STUCK)
                return -1;
            t = which < 0 ? limit : t + length;
            if (which >= 0 || t == corner) {
                o->enter(o->data, t, which, x);
                modes++;
            }
            if (t == corner)
                corner = o->corner(o->data, t);
        }
        memcpy(out + (size_t)k * (size_t)o->n, x, (size_t)o->n * sizeof *x);
    }
    return modes;
}

long oracle_run(const oracle *o, real *x, int count, const double *times, real *out) {
    series s = {room(sizeof(real) * T * (size_t)o->n), room(sizeof(real) * T * (size_t)(o->nu + 1)),
                room(sizeof(real) * T * (size_t)(o->ng + 1)), room(sizeof(real) * (size_t)o->n)};
    const long modes = run(o, x, count, times, out, &s);
    free(s.x);
    free(s.u);
    free(s.g);
    free(s.dx);
    return modes;
}
