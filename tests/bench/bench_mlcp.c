/* tests/bench/bench_mlcp.c - every method alone on every class of random problems, and the order that
 * follows.
 *
 * A cell of the table: how many of the problems of a class and size the method solves alone, its median time
 * and its median number of pivots over those it solves.  Each solve is cold:
 * no mode is known (all pairs at their lower bounds) and W is new to the solver, whose memory is there
 * already. Solved: NS_OK and ns_mlcp_residual() <= 1e-10.  "lemke, V A" is Lemke's method with the units as
 * given.
 *
 * Below it, the order: of the methods that are left, the one that costs least time for each problem solved,
 * of those that the ones before it have left unsolved.  NS_MLCP_AUTO (src/mlcp/solve.c) takes the first two,
 * and enumerates.
 */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "generators.h"

enum { SIZES = 4, MOST = 48, METHODS = 4, AUTO = METHODS };
static const int sizes[SIZES] = {5, 20, 60, 200}, counts[SIZES] = {MOST, 32, 16, 6};
static const double accept = 1e-10;

static const struct {
    const char *name;
    ns_mlcp_method method;
    int alike;
} methods[METHODS + 1] = {{"pivot", NS_MLCP_PIVOT, 0},
                          {"lemke", NS_MLCP_LEMKE, 0},
                          {"lemke, V A", NS_MLCP_LEMKE, 1},
                          {"enumerate", NS_MLCP_ENUMERATE, 0},
                          {"auto", NS_MLCP_AUTO, 0}};

typedef struct outcome {
    double time; /* s */
    long pivots;
    int solved;
} outcome;

static outcome results[CLASSES][SIZES][METHODS + 1][MOST];

typedef struct rig {
    ns_mlcp_solver *s;
    ns_mode *mode;
    double *lambda, *y;
} rig;

/* Makes the solver forget the problem before. */
static void forget(rig *r) {
    static const double W[] = {1}, q[] = {1}, l[] = {0}, u[] = {1};
    const ns_mlcp p = {.m = 1, .W = W, .q = q, .l = l, .u = u};
    must(ns_mlcp_use(r->s, NS_MLCP_PIVOT));
    must(ns_mlcp_solve(r->s, &p, r->mode, r->lambda, r->y, NULL));
}

static outcome solve(rig *r, const ns_mlcp *p, int k) {
    ns_mlcp_info info;
    forget(r);
    must(ns_mlcp_use(r->s, methods[k].method));
    must(ns_mlcp_alike(r->s, methods[k].alike));
    memset(r->mode, NS_LOWER, (size_t)p->m);
    const double start = now();
    const int status = ns_mlcp_solve(r->s, p, r->mode, r->lambda, r->y, &info);
    return (outcome){.time = now() - start,
                     .pivots = info.pivots,
                     .solved = status == NS_OK && ns_mlcp_residual(p, r->lambda, NULL) <= accept};
}

/* Problems of a class whose size is between half of m and m. */
static void run_class(rig *r, sample *s, int class, int size) {
    int n = 0;
    for (unsigned long long number = 0; n < counts[size]; number++) {
        generate(s, class, number, sizes[size]);
        if (2 * s->m < sizes[size])
            continue;
        const ns_mlcp p = sample_problem(s);
        for (int k = 0; k <= METHODS; k++)
            results[class][size][k][n] = solve(r, &p, k);
        n++;
    }
}

/* --- the table --- */

static void show_cell(int class, int size, int k) {
    const outcome *all = results[class][size][k];
    double times[MOST], pivots[MOST];
    int solved = 0;
    for (int i = 0; i < counts[size]; i++)
        if (all[i].solved) {
            times[solved] = all[i].time;
            pivots[solved++] = (double)all[i].pivots;
        }
    if (solved == 0) {
        printf(" |  %5s %9s %6s", "0%", "-", "-");
        return;
    }
    printf(" |  %4.0f%% %9.3g %6.0f", 100.0 * solved / counts[size], 1e6 * median(solved, times),
           median(solved, pivots));
}

static void show_table(void) {
    printf("%-11s %-10s", "class", "method");
    for (int size = 0; size < SIZES; size++)
        printf(" |  m %3d..%-3d us pivots", (sizes[size] + 1) / 2, sizes[size]);
    printf("\n");
    for (int class = 0; class < CLASSES; class ++)
        for (int k = 0; k <= METHODS; k++) {
            printf("%-11s %-10s", k ? "" : generator_name(class), methods[k].name);
            for (int size = 0; size < SIZES; size++)
                show_cell(class, size, k);
            printf("\n");
        }
}

/* --- the order --- */

enum { RANKED = METHODS - 1, AUTOS = 2 }; /* all but enumeration */

typedef struct order {
    int method[RANKED];
    double cost; /* s a problem */
} order;

static double charge[CLASSES][SIZES][METHODS]; /* s a try */

static void make_charges(void) {
    for (int class = 0; class < CLASSES; class ++)
        for (int size = 0; size < SIZES; size++)
            for (int k = 0; k < METHODS; k++) {
                double sum[2] = {0}; /* failed, solved */
                int n[2] = {0};
                for (int i = 0; i < counts[size]; i++) {
                    const outcome *o = &results[class][size][k][i];
                    sum[o->solved] += o->time;
                    n[o->solved]++;
                }
                const int of = n[1] > 0;
                charge[class][size][k] = sum[of] / n[of];
            }
}

/* Of `of` methods tried in turn, a problem. */
static double cost(const int *method, int of, int size) {
    double sum = 0;
    for (int class = 0; class < CLASSES; class ++)
        for (int i = 0; i < counts[size]; i++)
            for (int k = 0, solved = 0; k < of && !solved; k++) {
                sum += charge[class][size][method[k]];
                solved = results[class][size][method[k]][i].solved;
            }
    return sum / (CLASSES * counts[size]);
}

static void try_orders(order *o, int from, int size, order *least, order *most) {
    if (from == RANKED) {
        o->cost = cost(o->method, RANKED, size);
        *least = o->cost < least->cost ? *o : *least;
        *most = o->cost > most->cost ? *o : *most;
        return;
    }
    for (int k = from; k < RANKED; k++) {
        order next = *o;
        next.method[from] = o->method[k];
        next.method[k] = o->method[from];
        try_orders(&next, from + 1, size, least, most);
    }
}

static void show(const char *name, const order *o, int of) {
    printf("  %-8s %9.3g us a problem:", name, 1e6 * o->cost);
    for (int k = 0; k < of; k++)
        printf("%s %s", k ? "," : "", methods[o->method[k]].name);
    printf("\n");
}

static void show_order(int size) {
    order first = {.method = {0, 1, 2}}, least = {.cost = INFINITY}, most = {.cost = 0};
    order is = {.method = {0, 1}}; /* as solve.c has it, which enumerates then */
    try_orders(&first, 0, size, &least, &most);
    is.cost = cost(is.method, AUTOS, size);
    printf("m %d..%d\n", (sizes[size] + 1) / 2, sizes[size]);
    show("cheapest", &least, RANKED);
    show("AUTO", &is, AUTOS);
    show("dearest", &most, RANKED);
    for (int k = 0, left[AUTOS + 1] = {0}; k <= AUTOS; k++) {
        for (int class = 0; class < CLASSES; class ++)
            for (int i = 0; i < counts[size]; i++) {
                int solved = 0;
                for (int b = 0; b < k; b++)
                    solved |= results[class][size][is.method[b]][i].solved;
                left[k] += !solved;
            }
        if (k > 0 && left[k - 1] > 0)
            printf("  %s solves %d of the %d before it\n", methods[is.method[k - 1]].name,
                   left[k - 1] - left[k], left[k - 1]);
    }
}

int main(void) {
    const int most = sizes[SIZES - 1];
    sample s;
    rig r = {.mode = room((size_t)most),
             .lambda = room(sizeof(double) * (size_t)most),
             .y = room(sizeof(double) * (size_t)most)};
    must(sample_create(most, &s) == 0 ? ns_mlcp_create(most, &r.s) : NS_E_MEMORY);
    for (int class = 0; class < CLASSES; class ++)
        for (int size = 0; size < SIZES; size++)
            run_class(&r, &s, class, size);
    show_table();
    printf("\nMethods tried in turn until one solves the problem, in all orders:\n");
    make_charges();
    for (int size = 0; size < SIZES; size++)
        show_order(size);
    sample_free(&s);
    ns_mlcp_free(r.s);
    free(r.mode);
    free(r.lambda);
    free(r.y);
    return 0;
}
