/* src/exact/event_location.c - where a guard first breaks, and that none is overlooked.
 *
 * Guards are smooth at the distance of samples (a fifth of a radian of the mode's fastest rate): between two
 * samples a guard differs from their chord by at most an eighth of its second difference.  A guard farther
 * above zero than twice that holds.  Others are searched by (E1), a polynomial in time.
 */
#include "mode_selection.h"

#include "guards.h"
#include "linalg/simd.h"

#include <float.h>
#include <math.h>

/* 1 if as many guards as a register holds surely hold all through a step, by their samples. */
ALWAYS_INLINE int simd_clear(const double *s, int ld, int samples) {
    ns_simd_wide a = *(const ns_simd_wide *)s, b = *(const ns_simd_wide *)(s + ld);
    ns_simd_wide least = NS_WIDE_LOWER(a, b), curvature = {0};
    for (int i = 2; i <= samples; i++) {
        const ns_simd_wide c = *(const ns_simd_wide *)(s + i * ld), by = a - 2 * b + c,
                           size = NS_WIDE_SIZE(by);
        curvature = NS_WIDE_HIGHER(curvature, size);
        least = NS_WIDE_LOWER(least, c);
        a = b;
        b = c;
    }
    return NS_WIDE_ABOVE(least, curvature / 4);
}

NS_WIDE_TARGET static int clear_wide(const double *s, int ld, int samples) {
    return simd_clear(s, ld, samples);
}

static int clear_narrow(const double *s, int ld, int samples) {
    return simd_clear(s, ld, samples);
}

/* Guards from g on, of rows; or the last so many. */
static int clear_from(const double *s, int g, int rows, int samples) {
    const double *from = s + (rows - g < NS_WIDE ? rows - NS_WIDE : g);
    return ns_simd_is_wide() ? clear_wide(from, rows, samples) : clear_narrow(from, rows, samples);
}

/* The same of one guard, whose largest second difference is *curvature. */
ALWAYS_INLINE int is_clear(const double *s, int ld, int samples, double *curvature) {
    double least = s[0];
    *curvature = 0;
    for (int i = 1; i < samples; i++) {
        *curvature = ns_higher(*curvature, fabs(s[(i - 1) * ld] - 2 * s[i * ld] + s[(i + 1) * ld]));
        least = ns_lower(least, s[i * ld]);
    }
    return ns_lower(least, s[samples * ld]) > *curvature / 4;
}

int ns_exact_event_samples_hold(const double *s, int rows, int samples) {
    double curvature;
    for (int g = 0; g < rows && rows >= NS_WIDE; g += NS_WIDE)
        if (!clear_from(s, g, rows, samples))
            return 0;
    for (int g = 0; g < rows && rows < NS_WIDE; g++)
        if (!is_clear(s + g, rows, samples, &curvature))
            return 0;
    return 1;
}

int ns_exact_event_samples_above(const ns_mode_kernel *k, const double *s, int samples, const double *bound) {
    for (int g = 0; g < k->rows; g++) {
        double curvature, least = s[g + samples * k->rows];
        (void)is_clear(s + g, k->rows, samples, &curvature);
        for (int i = 0; i < samples; i++)
            least = ns_lower(least, s[g + i * k->rows]);
        if (!k->always_zero[g] && !(least - bound[g] > curvature / 4))
            return 0;
    }
    return 1;
}

/* What guard g may be off by; MANY times that if it broke in this mode and the same mode was selected again:
 * only rounding decides between the two modes then, and either is right.  So it does if the pair breaks back,
 * and both times was below zero from the first look at it on.  MANY times MANY if it breaks again, up to
 * MOST.
 */
enum { MANY = 64, MOST = MANY * MANY * MANY };

static int pair_of(const ns_exact_mode *mode, int guard) {
    return mode->scale[0].kernel->row[guard].pair;
}

static int is_unmended(const ns_exact *f, int g) {
    return f->unmended.mode == f->state.mode && f->unmended.guard == g;
}

void ns_exact_event_note_mended(ns_exact *f, const ns_exact_mode *was, int guard) {
    const int at_once = guard >= 0 && f->broken.at_once && f->broken.guard == guard,
              same = guard >= 0 && f->state.mode == was,
              broke_back = at_once && !same && f->left.mode == f->state.mode &&
                           pair_of(f->left.mode, f->left.guard) == pair_of(was, guard);
    const double times = same && is_unmended(f, guard) ? fmin(MOST, MANY * f->unmended.times) : MANY;
    f->unmended.mode = broke_back || same ? f->state.mode : NULL;
    f->unmended.guard = broke_back ? f->left.guard : guard;
    f->unmended.times = times;
    f->left.mode = at_once ? was : NULL;
    f->left.guard = guard;
}

/* What guard g may be off by here.  In steps as short as the rounding of the time that rounding does not
 * count: how long after the event they are is exact. */
static double break_tolerance(const ns_exact *f, const ns_mode_kernel *k, int g) {
    const int is_brief = k->h < 16 * ns_exact_rounding_of_time(f);
    const double rate = is_brief ? 0 : ns_exact_guard_of(k, k->rate, g, f->X);
    return (is_unmended(f, g) ? f->unmended.times : 1) * ns_exact_guard_rounding_at(f, k, g, f->X, rate);
}

/* 1 if guard g is below zero, though not by more than tol, what it may be off by on the scale at work: a
 * longer scale knows it better, and both values agree, so that what is faster has died out or is smaller.  Of
 * what is faster the longer scale sees the part that it carries in charge. */
static int is_past(ns_exact *f, const ns_time_scale *at, int g, double tol) {
    ns_exact_mode *mode = f->state.mode;
    const ns_mode_kernel *k = at->kernel;
    const double value = ns_exact_guard_of(k, k->value, g, f->X),
                 rate = ns_exact_guard_of(k, k->rate, g, f->X);
    if (!(value >= -tol && value < 0) || !(rate * k->g <= 8 * tol) || is_unmended(f, g))
        return 0;
    for (int i = (int)(at - mode->scale) + 1; i < mode->scales && ns_exact_mode_reach(f, mode, i); i++) {
        const ns_mode_kernel *longer = mode->scale[i].kernel;
        const double known = ns_exact_guard_of(longer, longer->value, g, f->X);
        if (!(fabs(known - value) <= fabs(known) / 2))
            return 0;
        if (fabs(known) > MANY * ns_exact_guard_rounding(f, longer, g) + tol * k->h / longer->h)
            return known < 0;
    }
    return 0;
}

/* 1 if guard g was looked at ahead of here already, and stays near zero. */
static int is_quiet(const ns_exact *f, int g) {
    const ns_exact_quiet *q = &f->past.quiet;
    const double t = f->state.now.t;
    return q->mode == f->state.mode && q->event_t == f->state.last_event_t && t >= q->from && t < q->until &&
           (q->guards & ns_exact_bit_of(g)) != 0;
}

static void note_quiet(ns_exact *f, const ns_mode_kernel *k, int g) {
    ns_exact_quiet *q = &f->past.quiet;
    const double t = f->state.now.t;
    if (!(q->mode == f->state.mode && q->event_t == f->state.last_event_t && t >= q->from && t < q->until))
        *q = (ns_exact_quiet){f->state.mode, f->state.last_event_t, t, t + ldexp(k->h, NS_SOON_EXPONENT), 0};
    q->guards |= ns_exact_bit_of(g);
}

void ns_exact_event_quiet(ns_exact *f) {
    const double t = f->state.now.t, h = f->state.mode->scale[0].kernel->h;
    f->past.quiet = (ns_exact_quiet){f->state.mode, t, t, t + ldexp(h, NS_SOON_EXPONENT), f->overruled};
}

/* The first interval in which the guard of these samples may break, and the part of it in which it does not.
 */
static int may_break_in(ns_exact *f, const ns_time_scale *at, int g, const double *s, int samples,
                        double *clear) {
    const int ld = at->kernel->rows;
    double curvature, tol = -1;
    if (is_clear(s, ld, samples, &curvature))
        return -1;
    for (int i = 0; i < samples; i++) {
        const double a = s[i * ld], b = s[(i + 1) * ld], low = ns_lower(a, b);
        if (low > curvature / 4)
            continue;
        if (tol < 0)
            tol = break_tolerance(f, at->kernel, g);
        if (i == 0 && a < 0 && is_past(f, at, g, tol)) {
            *clear = 0;
            return 0;
        }
        const int straight = fabs(b - a) > curvature || curvature / 4 <= tol;
        const int sinks = b < 0 && (b - a) * (1 << NS_SOON_EXPONENT) < -4 * tol && !is_quiet(f, g);
        if (!(straight && low >= -tol) || sinks) {
            *clear = a > curvature / 4 && b < a ? (a - curvature / 4) / (a - b) : 0;
            return i;
        }
    }
    return -1;
}

int ns_exact_event_in_step(ns_exact *f, const ns_time_scale *scale, const ns_step_map *map, double *clear) {
    const ns_mode_kernel *k = scale->kernel;
    int first = -1;
    if (k->rows == 0)
        return -1;
    ns_linalg_matvec((map->samples + 1) * k->rows, k->q, map->sample, f->X, f->work.guards);
    for (int g = 0; g < k->rows; g++) {
        double part = 1;
        if (g % NS_WIDE == 0 && k->rows >= NS_WIDE && clear_from(f->work.guards, g, k->rows, map->samples)) {
            g += NS_WIDE - 1;
            continue;
        }
        const int at = may_break_in(f, scale, g, f->work.guards + g, map->samples, &part);
        if (at < 0 || (first >= 0 && at > first))
            continue;
        *clear = at == first ? ns_lower(*clear, part) : part;
        first = at;
    }
    return first;
}

/* One guard over a short step, by (E1). */
typedef struct ns_guard_series {
    double g, c[NS_ORDER];
} ns_guard_series;

static ns_guard_series series_of(const ns_exact *f, const ns_mode_kernel *k, int g) {
    ns_guard_series w = {.g = k->g};
    for (int i = 0; i < NS_ORDER; i++)
        w.c[i] = f->work.coef[i * k->rows + g];
    return w;
}

static double sum_of(const ns_guard_series *w, const double *c) {
    double sum = 0;
    for (int i = NS_ORDER - 1; i >= 0; i--)
        sum += c[i] * w->c[i];
    return sum;
}

/* The guard and its rate at tau: L'_i = L'_(i-1) - L_(i-1). */
static double guard_at(const ns_guard_series *w, double tau, double *rate) {
    double c[NS_ORDER], slope[NS_ORDER] = {0};
    ns_modes_laguerre(tau / w->g, NS_ORDER, c);
    for (int i = 1; i < NS_ORDER; i++)
        slope[i] = c[i - 1] - slope[i - 1];
    *rate = sum_of(w, slope) / w->g;
    return sum_of(w, c);
}

/* Where the guard passes from at >= 0 at a to below at b: Newton, kept inside by halving.  |L''_i| is 21 at
 * most, and so a step of less than sqrt(eps/10) g leaves no more than the rounding of the terms. */
static double find_root(const ns_guard_series *w, double a, double b, double at, double below) {
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

/* The lowest point between a and b, where the rate passes from `from` < 0 to `to` >= 0, and the guard there.
 * Half the digits of the point are enough.  By regula falsi on the rate; the value at the end that did not
 * move is halved (Illinois). */
static double find_minimum(const ns_guard_series *w, double a, double b, double from, double to,
                           double *value) {
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

/* The root where the guard falls from `at` at a to `below` at b.  Of one that starts at zero and
 * rises, as right after an event, the root wanted is the later one, through which it falls. */
static double find_fall(const ns_guard_series *w, double a, double b, double at, double below, double tol) {
    double rate, top = b, from = a;
    if (at > tol)
        return find_root(w, a, b, at, below);
    (void)guard_at(w, a, &rate);
    if (!(rate > 0))
        return at >= 0 ? find_root(w, a, b, at, below) : a;
    for (int i = 0; i < 50; i++) {
        const double mid = from + (top - from) / 2;
        (void)guard_at(w, mid, &rate);
        *(rate > 0 ? &from : &top) = mid;
    }
    at = guard_at(w, from, &rate);
    return at >= 0 ? find_root(w, from, b, at, below) : a;
}

void ns_exact_event_intervals(double s, double (*c)[NS_ORDER]) {
    for (int i = 0; i <= NS_INTERVALS; i++)
        ns_modes_laguerre(s * i / NS_INTERVALS, NS_ORDER, c[i]);
}

/* A guard below zero by less than its rounding breaks here, and not where it is below by more, if it keeps
 * falling: else the next diode would start with a current of the wrong sign. */
static int keeps_falling(ns_exact *f, const ns_mode_kernel *k, int g, double rate, double tol) {
    if (!(rate * k->h * (1 << NS_SOON_EXPONENT) < -4 * tol))
        return 0;
    if (ns_exact_guard_of(k, k->value, g, f->X) > tol)
        return 1;
    if (is_quiet(f, g))
        return 0;
    const ns_guard_sign sign = ns_exact_guard_sign(f, f->state.mode, g, f->X);
    if (sign == NS_UNDECIDED)
        note_quiet(f, k, g);
    return sign >= NS_SIGN_SEEMS_TO_BREAK;
}

/* When guard g breaks, INFINITY: it does not. */
static double find_break(ns_exact *f, const ns_time_scale *at, int g, double tau, double (*c)[NS_ORDER]) {
    const ns_mode_kernel *k = at->kernel;
    const ns_guard_series w = series_of(f, k, g);
    double s[NS_INTERVALS + 1], curvature = 0, least = INFINITY;
    for (int i = 0; i <= NS_INTERVALS; i++) {
        s[i] = sum_of(&w, c[i]);
        least = ns_lower(least, s[i]);
        if (i > 1)
            curvature = ns_higher(curvature, fabs(s[i - 2] - 2 * s[i - 1] + s[i]));
    }
    if (least > curvature / 4)
        return INFINITY;
    const double tol = break_tolerance(f, k, g);
    if (s[0] < -tol) { /* unless an event has just set it off upward */
        double rate;
        (void)guard_at(&w, 0, &rate);
        if (!(rate > 0 && f->state.now.t == f->state.last_event_t &&
              s[0] >= -8 * tol - rate * ns_exact_time_error_of(f, k, g)))
            return 0;
    } else if (s[0] < 0 && is_past(f, at, g, tol)) {
        return 0;
    } else if (s[NS_INTERVALS] < 0 && s[NS_INTERVALS] >= -tol) {
        double rate;
        (void)guard_at(&w, tau, &rate);
        if (keeps_falling(f, k, g, rate, tol))
            return s[0] > 0 ? find_root(&w, 0, tau, s[0], s[NS_INTERVALS]) : 0;
    }
    for (int i = 0; i < NS_INTERVALS; i++) {
        const double a = tau * i / NS_INTERVALS, b = tau * (i + 1) / NS_INTERVALS;
        double end = b, value = s[i + 1], from, to;
        if (value >= -tol && ns_lower(s[i], value) <= curvature / 4 && curvature / 4 > tol) {
            (void)guard_at(&w, a, &from);
            (void)guard_at(&w, b, &to);
            if (from < 0 && to > 0)
                end = find_minimum(&w, a, b, from, to, &value);
        }
        if (value < -tol)
            return find_fall(&w, a, end, s[i], value, tol);
    }
    return INFINITY;
}

/* above (rows): a lower bound of each guard all through a short step; 1 if all are above zero. */
static int all_surely_hold(const ns_mode_kernel *k, const double *coef, double *above) {
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

int ns_exact_event_within(ns_exact *f, const ns_time_scale *scale, double tau, double *when) {
    const ns_mode_kernel *k = scale->kernel;
    int first = NS_GUARD_NONE;
    *when = INFINITY;
    if (k->rows == 0)
        return first;
    double c[NS_INTERVALS + 1][NS_ORDER], (*at)[NS_ORDER] = f->work.interval, *above = f->work.guards;
    ns_linalg_matvec(NS_ORDER * k->rows, k->q, k->guard_powers, f->X, f->work.coef);
    if (all_surely_hold(k, f->work.coef, above))
        return first;
    f->counts.searches++;
    if (tau != k->h) /* shorter than the whole step */
        ns_exact_event_intervals(tau / k->g, at = c);
    for (int g = 0; g < k->rows; g++) {
        const double t = above[g] > 0 ? INFINITY : find_break(f, scale, g, tau, at);
        if (t < *when)
            first = g;
        *when = ns_lower(*when, t);
    }
    return first;
}
