/* src/linalg/simd.h - two numbers in one register, where the compiler knows vectors; one where it does not.
 * Four where the machine can (AVX2), in functions of NS_WIDE_TARGET that are called if ns_simd_is_wide().
 */
#ifndef NS_LINALG_SIMD_H
#define NS_LINALG_SIMD_H

#include <math.h>

#if defined(__GNUC__)
typedef double ns_simd __attribute__((vector_size(16), aligned(8), may_alias));
typedef long long ns_simd_flags __attribute__((vector_size(16)));
typedef double ns_simd_wide __attribute__((vector_size(32), aligned(8), may_alias));
typedef long long ns_simd_wide_flags __attribute__((vector_size(32)));
#define ALWAYS_INLINE static inline __attribute__((always_inline))
static inline int ns_simd_all(ns_simd_flags f) {
    return (f[0] & f[1]) != 0;
}
/* The lower and the higher one of two, |a|, whether a > b or a <= b everywhere; no functions, as some have no
 * such registers to pass. */
#define NS_WIDE_IF(c, a, b)                                                                                  \
    ((ns_simd_wide)(((ns_simd_wide_flags)(a) & (c)) | ((ns_simd_wide_flags)(b) & ~(c))))
#define NS_WIDE_LOWER(a, b) NS_WIDE_IF((a) < (b), a, b)
#define NS_WIDE_HIGHER(a, b) NS_WIDE_IF((a) > (b), a, b)
#define NS_WIDE_SIZE(a)                                                                                      \
    ((ns_simd_wide)((ns_simd_wide_flags)(a) & ~(ns_simd_wide_flags)(ns_simd_wide){-0.0, -0.0, -0.0, -0.0}))
#define NS_WIDE_OF(number) ((number) + (ns_simd_wide){0})
#define NS_WIDE_ABOVE(a, b) ns_simd_wide_all((ns_simd_wide_flags[1]){(a) > (b)})
#define NS_WIDE_BELOW_OR_AT(a, b) ns_simd_wide_all((ns_simd_wide_flags[1]){(a) <= (b)})
static inline int ns_simd_wide_all(const ns_simd_wide_flags *f) {
    return (f[0][0] & f[0][1] & f[0][2] & f[0][3]) != 0;
}
#else
#define NS_WIDE_LOWER(a, b) ((a) < (b) ? (a) : (b))
#define NS_WIDE_HIGHER(a, b) ((a) > (b) ? (a) : (b))
#define NS_WIDE_SIZE(a) ((a) < 0 ? -(a) : (a))
#define NS_WIDE_OF(number) (number)
#define NS_WIDE_ABOVE(a, b) ((a) > (b))
#define NS_WIDE_BELOW_OR_AT(a, b) ((a) <= (b))
typedef double ns_simd, ns_simd_wide;
#define ALWAYS_INLINE static inline
typedef int ns_simd_flags;
static inline int ns_simd_all(ns_simd_flags f) {
    return f;
}
#endif
enum { NS_LANES = sizeof(ns_simd) / sizeof(double), NS_WIDE = sizeof(ns_simd_wide) / sizeof(double) };

/* Before a loop of a few rounds, of a number known here. */
#if defined(__clang__)
#define NS_UNROLL _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define NS_UNROLL _Pragma("GCC unroll 8")
#else
#define NS_UNROLL
#endif

#if defined(__GNUC__) && defined(__x86_64__)
#define NS_WIDE_TARGET __attribute__((target("avx2")))
static inline int ns_simd_is_wide(void) {
    return __builtin_cpu_supports("avx2");
}
#else
#define NS_WIDE_TARGET
static inline int ns_simd_is_wide(void) {
    return 0;
}
#endif

/* As fmin() and fmax(), but for NaN: the second where one of them is no number.  One instruction each. */
static inline double ns_lower(double a, double b) {
    return a < b ? a : b;
}

static inline double ns_higher(double a, double b) {
    return a > b ? a : b;
}

static inline double ns_dot(int n, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* max_i |a_i| weight_i, 0 or more */
static inline double ns_weighted_max(int n, const double *a, const double *weight) {
    double top = 0.0;
    for (int i = 0; i < n; i++)
        top = ns_higher(fabs(a[i]) * weight[i], top);
    return top;
}

/* 1 if all of x (n) are 0 or more, 0 if one is not, or is no number. */
static inline int ns_none_negative(int n, const double *x) {
    const ns_simd none = {0};
    ns_simd_flags all = none >= none;
    int i = 0;
    for (; i + NS_LANES <= n; i += NS_LANES)
        all &= *(const ns_simd *)(x + i) >= none;
    return ns_simd_all(all) && !(i < n && !(x[i] >= 0));
}

/* y = x, of a few (n). */
static inline void ns_copy_few(int n, const double *x, double *y) {
    int i = 0;
    for (; i + NS_LANES <= n; i += NS_LANES)
        *(ns_simd *)(y + i) = *(const ns_simd *)(x + i);
    if (i < n)
        y[i] = x[i];
}

/* 1 if sums of x (n) are finite, and so all of x. */
static inline int ns_sums_finite(int n, const double *x) {
    const ns_simd none = {0};
    ns_simd sum = none;
    int i = 0;
    for (; i + NS_LANES <= n; i += NS_LANES)
        sum += *(const ns_simd *)(x + i);
    if (i < n)
        sum += x[i];
    return ns_simd_all(sum - sum == none); /* NaN where it is not */
}

#endif
