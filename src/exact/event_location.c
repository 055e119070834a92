/* src/exact/event_location.c - where a guard first breaks, and that none is overlooked.
 *
 * Guards are smooth at the distance of samples (a fifth of what the mode's fastest rate turns round in):
 * between two of them a guard lies within an eighth of its second difference of their chord.  Twice that is
 * asked for. What is nearer is looked at by (E1), a polynomial in time.
 */
#include "mode_selection.h"

#include "linalg/simd.h"

#include <float.h>
#include <math.h>

/* 1 if as many guards as a register holds do not break all through a leg, by their samples; nothing else is
 * asked of most. */
ALWAYS_INLINE int calm_beside(const double *s, int ld, int samples) {
    ns_simd_wide a = *(const ns_simd_wide *)s, b = *(const ns_simd_wide *)(s + ld);
    ns_simd_wide least = NS_WIDE_LOWER(a, b), bend = {0};
    for (int i = 2; i <= samples; i++) {
        const ns_simd_wide c = *(const ns_simd_wide *)(s + i * ld), by = a - 2 * b + c,
                           size = NS_WIDE_SIZE(by);
        bend = NS_WIDE_HIGHER(bend, size);
        least = NS_WIDE_LOWER(least, c);
        a = b;
        b = c;
    }
    return NS_WIDE_ABOVE(least, bend / 4);
}

NS_WIDE_TARGET static int calm_wide(const double *s, int ld, int samples) {
    return calm_beside(s, ld, samples);
}

static int calm_narrow(const double *s, int ld, int samples) {
    return calm_beside(s, ld, samples);
}

/* Guards from g on, of rows; or the last so many. */
static int calm(const double *s, int g, int rows, int samples) {
    const double *from = s + (rows - g < NS_WIDE ? rows - NS_WIDE : g);
    return ns_simd_is_wide() ? calm_wide(from, rows, samples) : calm_narrow(from, rows, samples);
}

/* The same of one guard, whose largest second difference is *bend. */
ALWAYS_INLINE int is_clear(const double *s, int ld, int samples, double *bend) {
    double least = s[0];
    *bend = 0;
    for (int i = 1; i < samples; i++) {
        *bend = ns_higher(*bend, fabs(s[(i - 1) * ld] - 2 * s[i * ld] + s[(i + 1) * ld]));
        least = ns_lower(least, s[i * ld]);
    }
    return ns_lower(least, s[samples * ld]) > *bend / 4;
}

int ns_exact_watch_clear(const double *s, int rows, int samples) {
    double bend;
    for (int g = 0; g < rows && rows >= NS_WIDE; g += NS_WIDE)
        if (!calm(s, g, rows, samples))
            return 0;
    for (int g = 0; g < rows && rows < NS_WIDE; g++)
        if (!is_clear(s + g, rows, samples, &bend))
            return 0;
    return 1;
}

/* The same, of a guard that fell below it before while the mode that was found was the one it was in: what
 * is that close to zero is one or the other by rounding, and time passes in either. */
static double noise_in_doubt(const ns_exact *f, const ns_mode_kernel *k, int g) {
    enum { DOUBT = 64 };
    const int doubted = f->doubted_at == f->at && f->doubted == g;
    return (doubted ? DOUBT : 1) * ns_exact_guard_rounding(f, k, g);
}

/* The first interval in which the guard of these samples may break, and the part of it in which it does not.
 */
static int doubt_in(const ns_exact *f, const ns_mode_kernel *k, int g, const double *s, int samples,
                    double *clear) {
    const int ld = k->rows;
    double bend, tol = -1;
    if (is_clear(s, ld, samples, &bend))
        return -1;
    for (int i = 0; i < samples; i++) {
        const double a = s[i * ld], b = s[(i + 1) * ld], low = ns_lower(a, b);
        if (low > bend / 4)
            continue;
        if (tol < 0)
            tol = noise_in_doubt(f, k, g);
        const int straight = fabs(b - a) > bend || bend / 4 <= tol;
        const int sinks = b < 0 && (b - a) * (1 << NS_SOON_RUNGS) < -4 * tol;
        if (!(straight && low >= -tol) || sinks) {
            *clear = a > bend / 4 && b < a ? (a - bend / 4) / (a - b) : 0;
            return i;
        }
    }
    return -1;
}

int ns_exact_watch_step(ns_exact *f, const ns_time_scale *level, const ns_step_map *leg, double *clear) {
    const ns_mode_kernel *k = level->stage;
    int first = -1;
    if (k->rows == 0)
        return -1;
    ns_linalg_matvec((leg->samples + 1) * k->rows, k->q, leg->sample, f->X, f->guards);
    for (int g = 0; g < k->rows; g++) {
        double part = 1;
        if (g % NS_WIDE == 0 && k->rows >= NS_WIDE && calm(f->guards, g, k->rows, leg->samples)) {
            g += NS_WIDE - 1;
            continue;
        }
        const int at = doubt_in(f, k, g, f->guards + g, leg->samples, &part);
        if (at < 0 || (first >= 0 && at > first))
            continue;
        *clear = at == first ? ns_lower(*clear, part) : part;
        first = at;
    }
    return first;
}

/* One guard over a stage, by (E1). */
typedef struct course {
    double g, c[NS_ORDER];
} course;

static course course_of(const ns_exact *f, const ns_mode_kernel *k, int g) {
    course w = {.g = k->g};
    for (int i = 0; i < NS_ORDER; i++)
        w.c[i] = f->coef[i * k->rows + g];
    return w;
}

static double sum_of(const course *w, const double *c) {
    double sum = 0;
    for (int i = NS_ORDER - 1; i >= 0; i--)
        sum += c[i] * w->c[i];
    return sum;
}

/* The guard and its rate at tau: L'_i = L'_(i-1) - L_(i-1). */
static double guard_at(const course *w, double tau, double *rate) {
    double c[NS_ORDER], slope[NS_ORDER] = {0};
    ns_modes_laguerre(tau / w->g, c);
    for (int i = 1; i < NS_ORDER; i++)
        slope[i] = c[i - 1] - slope[i - 1];
    *rate = sum_of(w, slope) / w->g;
    return sum_of(w, c);
}

/* Where the guard passes from at >= 0 at a to below at b: Newton, kept inside by halving.  |L''_i| is 21 at
 * most, and so a step of less than sqrt(eps/10) g leaves no more than the rounding of the terms. */
static double root(const course *w, double a, double b, double at, double below) {
    const double last = 4e-9 * w->g;
    double tau = a + (b - a) * (at / (at - below));
    for (int i = 0; i < 100 && b - a > DBL_EPSILON * b; i++) {
        double rate;
        const double value = guard_at(w, tau, &rate);
        if (value >= 0)
            a = tau;
        else
            b = tau;
        const double step = -value / rate, newton = tau + step;
        const int inside = newton >= a && newton <= b;
        tau = inside ? newton : a + (b - a) / 2;
        if (inside && fabs(step) <= last)
            break;
    }
    return tau;
}

/* The lowest point between a and b, where the rate passes from `from` < 0 to `to` >= 0, and the guard there,
 * which half the digits of the point are enough for: by chords of the rate, of which the end that stays where
 * it is counts half (Illinois). */
static double lowest(const course *w, double a, double b, double from, double to, double *value) {
    double rate, best = b;
    *value = INFINITY;
    for (int i = 0; i < 40 && b - a > 1e-9 * b && to > from; i++) {
        const double mid = a + (b - a) * (from / (from - to)), at = guard_at(w, mid, &rate);
        if (at < *value) {
            *value = at;
            best = mid;
        }
        if (rate < 0) {
            a = mid;
            from = rate;
            to /= 2;
        } else {
            b = mid;
            to = rate;
            from /= 2;
        }
        if (rate == 0)
            break;
    }
    return best;
}

/* The same where it falls from a value at a to one below zero at b; one that an event has just set off upward
 * from zero comes back to it later. */
static double fall(const course *w, double a, double b, double at, double below, double tol) {
    double rate, top = b, from = a;
    if (at > tol)
        return root(w, a, b, at, below);
    (void)guard_at(w, a, &rate);
    if (!(rate > 0))
        return at >= 0 ? root(w, a, b, at, below) : a;
    for (int i = 0; i < 50; i++) {
        const double mid = from + (top - from) / 2;
        (void)guard_at(w, mid, &rate);
        *(rate > 0 ? &from : &top) = mid;
    }
    at = guard_at(w, from, &rate);
    return at >= 0 ? root(w, from, b, at, below) : a;
}

void ns_exact_watch_pieces(double s, double (*c)[NS_ORDER]) {
    for (int i = 0; i <= NS_PIECES; i++)
        ns_modes_laguerre(s * i / NS_PIECES, c[i]);
}

/* What passes below zero by less than rounding may be breaks here, and not where it is below by more, if it
 * is about to be and goes on: currents of the wrong sign would be handed on from diode to diode. */
static int goes_on(ns_exact *f, const ns_mode_kernel *k, int g, double rate, double tol) {
    if (!(rate * k->h * (1 << NS_SOON_RUNGS) < -4 * tol))
        return 0;
    return ns_exact_guard_of(k, k->value, g, f->X) > tol ||
           ns_exact_guard_sign(f, f->at, g, f->X) >= NS_SIGN_SEEMS_TO_BREAK;
}

/* When guard g breaks, INFINITY: it does not. */
static double break_of(ns_exact *f, const ns_mode_kernel *k, int g, double tau, double (*c)[NS_ORDER]) {
    const course w = course_of(f, k, g);
    double s[NS_PIECES + 1], bend = 0, least = INFINITY;
    for (int i = 0; i <= NS_PIECES; i++) {
        s[i] = sum_of(&w, c[i]);
        least = ns_lower(least, s[i]);
        if (i > 1)
            bend = ns_higher(bend, fabs(s[i - 2] - 2 * s[i - 1] + s[i]));
    }
    if (least > bend / 4)
        return INFINITY;
    const double tol = noise_in_doubt(f, k, g);
    if (s[0] < -tol) { /* unless an event has just set it off upward */
        double rate;
        (void)guard_at(&w, 0, &rate);
        if (!(rate > 0 && f->t == f->since && s[0] >= -8 * tol - rate * f->slack))
            return 0;
    } else if (s[NS_PIECES] < 0 && s[NS_PIECES] >= -tol) {
        double rate;
        (void)guard_at(&w, tau, &rate);
        if (goes_on(f, k, g, rate, tol))
            return s[0] > 0 ? root(&w, 0, tau, s[0], s[NS_PIECES]) : 0;
    }
    for (int i = 0; i < NS_PIECES; i++) {
        const double a = tau * i / NS_PIECES, b = tau * (i + 1) / NS_PIECES;
        double end = b, value = s[i + 1], from, to;
        if (value >= -tol && ns_lower(s[i], value) <= bend / 4 && bend / 4 > tol) {
            (void)guard_at(&w, a, &from);
            (void)guard_at(&w, b, &to);
            if (from < 0 && to > 0)
                end = lowest(&w, a, b, from, to, &value);
        }
        if (value < -tol)
            return fall(&w, a, end, s[i], value, tol);
    }
    return INFINITY;
}

/* What guards (rows) surely are above all through a stage; 1 if that is zero at least for all of them. */
static int none_near(const ns_mode_kernel *k, const double *coef, double *above) {
    const int rows = k->rows;
    int all = 1;
    for (int g = 0; g < rows; g++) {
        double least = coef[g];
        for (int i = 1; i < NS_ORDER; i++)
            least -= ns_modes_laguerre_max[i] * fabs(coef[i * rows + g]);
        above[g] = least;
        all &= least > 0;
    }
    return all;
}

int ns_exact_watch_near(ns_exact *f, const ns_time_scale *level, double tau, double *when) {
    const ns_mode_kernel *k = level->stage;
    *when = INFINITY;
    if (k->rows == 0)
        return 0;
    double c[NS_PIECES + 1][NS_ORDER], (*at)[NS_ORDER] = f->pieces, *above = f->guards;
    ns_linalg_matvec(NS_ORDER * k->rows, k->q, k->coef, f->X, f->coef);
    if (none_near(k, f->coef, above))
        return 0;
    f->s->counts.searches++;
    if (tau != k->h) /* not of the whole stage */
        ns_exact_watch_pieces(tau / k->g, at = c);
    for (int g = 0; g < k->rows; g++) {
        const double t = above[g] > 0 ? INFINITY : break_of(f, k, g, tau, at);
        if (t < *when)
            f->broken = g;
        *when = ns_lower(*when, t);
    }
    return *when < INFINITY;
}
