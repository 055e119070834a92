/* tests/stress/stress_engines.c - what "auto" costs beside the better of the two engines that it chooses
 * from.
 *
 *     stress_engines [FILE...]    circuits of the benchmark, these netlists, and random circuits
 *
 * STRESS_SEED (1), STRESS_COUNT random circuits of each class (1), STRESS_CLASS (a part of the names),
 * STRESS_SECONDS for all (none), STRESS_LIMIT s of CPU for one engine (5; auto gets four times that).
 * Compared are instructions, or CPU time where the kernel does not count them.  An engine counts if it is
 * done and right: its results are those of auto, or, where auto is not done, of the other one.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cases.h"
#include "judge.h"
#include "programs.h"

enum { MOST = 10000, SHOWN = 10, NAME = 64 };
/* Runs of less are over before anybody chooses: instructions, s. */
static const double least_effort = 2e7, least_seconds = 5e-3;

typedef struct row {
    char name[NAME];
    int is_done; /* auto is */
    double ratio, cost, best;
    const char *by;
} row;

static row rows[MOST];
static int count, unread, without;
static double limit;
static time_t until; /* no circuit is begun after it */

/* CPU times beside other work differ by half; below this ratio that does not matter. */
static const double dear = 1.2;

static double cost_of(const judge_cost *c) {
    return c->effort > 0 ? c->effort / least_effort : c->seconds / least_seconds;
}

static const judge_cost *better(const judge_cost *c) {
    const judge_cost *best = NULL;
    for (int i = 1; i < JUDGE_ENGINES; i++)
        if (c[i].agrees && (!best || cost_of(&c[i]) < cost_of(best)))
            best = &c[i];
    return best;
}

/* Of CPU times each engine's least of three. */
static void measure_again(const netlist *n, judge_cost *c) {
    judge_cost again[JUDGE_ENGINES];
    for (int k = 0; k < 2 && judge_engines(n, limit, again); k++)
        for (int i = 0; i < JUDGE_ENGINES; i++)
            if (again[i].end == c[i].end)
                c[i].seconds = fmin(c[i].seconds, again[i].seconds);
}

static void measure(const char *name, const netlist *n) {
    judge_cost c[JUDGE_ENGINES];
    if (time(NULL) >= until)
        return;
    if (!judge_engines(n, limit, c)) {
        unread++;
        return;
    }
    const judge_cost *best = better(c);
    if (best && !(c->effort > 0) && cost_of(c) > dear * cost_of(best)) {
        measure_again(n, c);
        best = better(c);
    }
    if (!best || count == MOST) {
        without++;
        return;
    }
    row *r = &rows[count++];
    snprintf(r->name, sizeof r->name, "%s", name);
    r->is_done = c[0].end == RUN_DONE;
    r->by = best->name;
    r->cost = cost_of(&c[0]);
    r->best = cost_of(best);
    if (c[0].end == RUN_SLOW) /* as far as it came */
        r->cost = r->best * c[0].seconds / best->seconds;
    r->ratio = fmax(1, r->cost) / fmax(1, r->best);
}

/* --- circuits --- */

static void measure_file(const char *path) {
    netlist n = {0};
    FILE *file = fopen(path, "r");
    const char *slash = strrchr(path, '/');
    if (file && netlist_read(&n, file) == 0)
        measure(slash ? slash + 1 : path, &n);
    else
        unread++;
    if (file)
        fclose(file);
    netlist_free(&n);
}

/* A case of the benchmark, from rest. */
static void measure_case(const bench_case *c) {
    const deck_models ideal = {.diode = DECK_IDEAL};
    netlist n = {0};
    FILE *file = tmpfile();
    if (!file)
        return;
    fprintf(file, "%s\n", c->name);
    deck_netlist(c->net, &ideal, file);
    fprintf(file, ".tran %.17g %.17g 0 %.17g uic\n", c->unit / 16, c->end, c->unit / 16);
    rewind(file);
    if (netlist_read(&n, file) == 0)
        measure(c->name, &n);
    fclose(file);
    netlist_free(&n);
}

static void measure_benchmark(void) {
    bench_case c;
    for (int at = 0; memset(&c, 0, sizeof c), case_make(at, 1, &c); at++) {
        if (c.net)
            measure_case(&c);
        case_free(&c);
    }
}

static void measure_random(const family *f, unsigned long long number) {
    netlist n = {0};
    char name[NAME];
    snprintf(name, sizeof name, "%.40s-%llu", f->name, number);
    family_circuit(f, number, &n);
    measure(name, &n);
    netlist_free(&n);
}

static void measure_stress(void) {
    const unsigned long long seed = (unsigned long long)number_of("STRESS_SEED", 1);
    const int each = (int)number_of("STRESS_COUNT", 1);
    const char *part = getenv("STRESS_CLASS");
    for (int k = 0; k < each; k++)
        for (int i = 0; families_all[i]; i++)
            for (const family *f = families_all[i]; f->name; f++)
                if (!part || strstr(f->name, part))
                    measure_random(f, seed * 1000000 + (unsigned long long)k);
}

/* --- the table --- */

static int by_ratio(const void *a, const void *b) {
    const double x = ((const row *)a)->ratio, y = ((const row *)b)->ratio;
    return (x < y) - (x > y);
}

static int print_table(void) {
    if (count == 0)
        return 2;
    qsort(rows, (size_t)count, sizeof *rows, by_ratio);
    printf("%d circuits (%d not read, %d that neither engine does); auto beside the better engine:\n", count,
           unread, without);
    printf("median %.3f, 90 %% %.3f, most %.3f\n", rows[count / 2].ratio, rows[count / 10].ratio,
           rows[0].ratio);
    printf("%-32s %8s %12s %12s  %s\n", "circuit", "ratio", "auto", "better",
           "of 20 million instructions, or 5 ms");
    for (int i = 0; i < SHOWN && i < count; i++)
        printf("%-32s %8.2f %12.3f %12.3f  %s%s\n", rows[i].name, rows[i].ratio, rows[i].cost, rows[i].best,
               rows[i].by, rows[i].is_done ? "" : ", auto is not done");
    return rows[0].ratio > 2 || rows[count / 2].ratio > 1.05;
}

int main(int argc, char **argv) {
    limit = number_of("STRESS_LIMIT", 5);
    until = time(NULL) + (time_t)number_of("STRESS_SECONDS", 1e9);
    for (int i = 1; i < argc; i++)
        measure_file(argv[i]);
    if (!getenv("STRESS_CLASS"))
        measure_benchmark();
    measure_stress();
    return print_table();
}
