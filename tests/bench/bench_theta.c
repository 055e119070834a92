/* tests/bench/bench_theta.c - what a step of the theta scheme costs, with its counts and its error.
 *
 * The LC bridge of the literature (2 states, 4 pairs), fixed h = 1 us, 5 ms, theta = 1 and theta = gamma =
 * 1/2:
 *
 *     floor     the bare matrix-vector product of the map, nothing else
 *     cached    the whole 5 ms in plain C: a map for either polarity, computed before, its six rows and the
 *               signs of the four guards; no library
 *     step      ns_theta_try + ns_theta_accept while the mode stands
 *     capture   the whole 5 ms, events captured at step ends
 *     march     the whole 5 ms, events located
 *
 * Repetitions in turn, a twentieth of a second apart, CPU time of this thread, one thread: their lower
 * quartile is what counts, the median beside it.  Where cores are shared with what else runs, as two threads
 * of one core or two guests of one machine are, all of a while takes up to twice as long as the same a second
 * later; the fastest quarter is of whiles that were the program's own.
 */
#include "timing.h"

#include <math.h>
#include <time.h>

#include "facts.h"
#include "linalg/dense.h"
#include "systems.h"

enum { REPEATS = 31, STEPS = 5000, FLOOR = 0, STEP = 2, RUNS = 5 };
static const double h = 1e-6, end = 5e-3;
static const double w0[2] = {1e-6 * 10, 0};

typedef struct result {
    double time; /* s */
    double steps;
    double v;
    ns_counts counts;
} result;

static volatile double sink;

/* out = step * in, in changing, p = 2 + 4 (w, guards), q = 3. */
static result run_floor(const ns_system *s, double theta) {
    (void)s;
    double a[6 * 3], in[3] = {1e-5, 1e-9, 1}, out[8] = {0};
    for (int i = 0; i < 18; i++)
        a[i] = 1.0 / (i + 1);
    const int p = theta < 1 ? 8 : 6;
    double big[8 * 3];
    for (int i = 0; i < 24; i++)
        big[i] = a[i % 18];
    const double start = now();
    for (int k = 0; k < STEPS; k++) {
        ns_linalg_matvec(p, 3, big, in, out);
        in[0] = 1e-5 + 1e-9 * out[0];
    }
    sink = out[1];
    return (result){.time = now() - start, .steps = STEPS};
}

/* theta = gamma = 1, or 1/2.  Rows: v, i, then the currents and reverse voltages of the pairs that polarity
 * `sign` has: all of the sign of v. */
static void cached_map(double theta, double sign, double *map) {
    const double C = 1e-6, L = 1e-2, R = 1e3; /* system_lc_bridge() */
    const double a[2][2] = {{-1 / (R * C), -1 / C}, {1 / L, 0}};
    const double e[2][2] = {{1 - theta * h * a[0][0], -theta * h * a[0][1]},
                            {-theta * h * a[1][0], 1 - theta * h * a[1][1]}};
    const double rest = (1 - theta) * h, det = e[0][0] * e[1][1] - e[0][1] * e[1][0];
    for (int j = 0; j < 2; j++) {
        const double b0 = (j == 0) + rest * a[0][j], b1 = (j == 1) + rest * a[1][j];
        map[j] = (e[1][1] * b0 - e[0][1] * b1) / det;
        map[2 + j] = (e[0][0] * b1 - e[1][0] * b0) / det;
        for (int k = 2; k < 6; k++)
            map[2 * k + j] = sign * map[j] / (k < 4 ? R : 1);
    }
}

static void cached_step(const double *map, const double *x, double *out) {
    for (int i = 0; i < 6; i++)
        out[i] = map[2 * i] * x[0] + map[2 * i + 1] * x[1];
}

static result run_cached(const ns_system *s, double theta) {
    double maps[2][12], x[2] = {10, 0}, out[6];
    (void)s;
    for (int k = 0; k < 2; k++)
        cached_map(theta, k ? -1 : 1, maps[k]);
    int mode = 0, events = 0;
    const double start = now();
    for (int k = 0; k < STEPS; k++) {
        cached_step(maps[mode], x, out);
        if (out[2] < 0 || out[3] < 0 || out[4] < 0 || out[5] < 0) {
            mode = !mode;
            events++;
            cached_step(maps[mode], x, out);
        }
        x[0] = out[0];
        x[1] = out[1];
    }
    result r = {.time = now() - start, .steps = STEPS, .v = x[0]};
    r.counts.events = events;
    return r;
}

static ns_theta *start_theta(const ns_system *s, double theta) {
    const ns_theta_options o = {theta, theta, 0};
    ns_theta *t;
    must(ns_theta_create(s, &o, &t, NULL));
    must(ns_theta_start(t, w0, NULL));
    must(ns_theta_try(t, 1e-14, NULL, 1, NS_RESOLVE));
    must(ns_theta_accept(t));
    must(ns_theta_try(t, h, NULL, 0, NS_HOLD)); /* the map is made here, not in the timed part */
    return t;
}

/* Steps of 10 ns, so that the mode stands for all of them (50 us). */
static result run_step(const ns_system *s, double theta) {
    ns_theta *t = start_theta(s, theta);
    must(ns_theta_try(t, h / 100, NULL, 0, NS_HOLD));
    const ns_counts before = *ns_theta_counts(t);
    const double start = now();
    for (int k = 0; k < STEPS; k++) {
        must(ns_theta_try(t, h / 100, NULL, 0, NS_HOLD));
        must(ns_theta_accept(t));
    }
    result r = {.time = now() - start, .steps = STEPS, .counts = *ns_theta_counts(t)};
    r.counts.factors -= before.factors;
    r.counts.pivots -= before.pivots;
    r.counts.maps -= before.maps;
    r.counts.problems -= before.problems;
    ns_theta_free(t);
    return r;
}

static result run_capture(const ns_system *s, double theta) {
    ns_theta *t = start_theta(s, theta);
    const double start = now();
    for (int k = 0; k < STEPS; k++) {
        must(ns_theta_try(t, h, NULL, 0, NS_RESOLVE));
        must(ns_theta_accept(t));
    }
    result r = {.time = now() - start, .steps = STEPS, .counts = *ns_theta_counts(t)};
    double x[2];
    must(ns_theta_read(t, x, NULL, NULL));
    r.v = x[0];
    ns_theta_free(t);
    return r;
}

static result run_march(const ns_system *s, double theta) {
    const ns_march_options o = {.theta = theta, .gamma = theta, .h = h};
    ns_march *m;
    double reached, x[2];
    const double start = now();
    must(ns_march_create(s, &o, &m, NULL));
    must(ns_march_start(m, 0, w0));
    must(ns_march_try(m, end, NS_TO_TIME, &reached));
    result r = {.time = now() - start, .counts = *ns_march_counts(m)};
    r.steps = (double)r.counts.steps;
    must(ns_march_read(m, NULL, x, NULL, NULL));
    r.v = x[0];
    ns_march_free(m);
    return r;
}

int main(void) {
    static const struct {
        const char *name;
        result (*run)(const ns_system *, double);
        int whole; /* has an answer at 5 ms */
    } runs[RUNS] = {{"floor", run_floor, 0},
                    {"cached", run_cached, 1},
                    {"step", run_step, 0},
                    {"capture", run_capture, 1},
                    {"march", run_march, 1}};
    ns_system *s = system_lc_bridge();
    const double exact = lc_bridge_v(10, end);
    printf("LC bridge, 2 states, 4 pairs, h = 1 us; v(5 ms) = %.9f V in closed form\n", exact);
    printf("%-8s %6s %9s %9s %9s %10s %8s %8s %8s %8s %8s\n", "run", "theta", "us/step", "median", "us total",
           "error V", "events", "problems", "pivots", "factors", "maps");
    for (int half = 0; half < 2; half++) {
        const double theta = half ? 0.5 : 1;
        double times[RUNS][REPEATS], ratio[REPEATS];
        result r[RUNS];
        for (int k = 0; k < REPEATS; k++) {
            nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
            (void)run_capture(s, theta); /* awake again */
            for (int i = 0; i < RUNS; i++) {
                r[i] = runs[i].run(s, theta);
                times[i][k] = r[i].time;
            }
            ratio[k] = times[STEP][k] / times[FLOOR][k] * (r[FLOOR].steps / r[STEP].steps);
        }
        for (int i = 0; i < RUNS; i++) {
            qsort(times[i], REPEATS, sizeof(double), by_value);
            const double t = times[i][REPEATS / 4] * 1e6, middle = times[i][REPEATS / 2] * 1e6;
            const ns_counts *c = &r[i].counts;
            char error[16] = "-", what[32];
            snprintf(what, sizeof what, "theta %s %s", half ? "1/2" : "1", runs[i].name);
            fact_put(what, t * 1e-6 / r[i].steps);
            if (runs[i].whole)
                snprintf(error, sizeof error, "%.2e", fabs(r[i].v - exact));
            printf("%-8s %6.2f %9.4f %9.4f %9.1f %10s %8ld %8ld %8ld %8ld %8ld\n", runs[i].name, theta,
                   t / r[i].steps, middle / r[i].steps, t, error, c->events, c->problems, c->pivots,
                   c->factors, c->maps);
        }
        const double over = median(REPEATS, ratio);
        printf("step / product %.2f\n", over);
        fact_put(half ? "theta 1/2 step over product" : "theta 1 step over product", over);
    }
    ns_system_free(s);
    return 0;
}
