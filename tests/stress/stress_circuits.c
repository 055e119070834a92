/* tests/stress/stress_circuits.c - random circuits of every class, judged by several methods; what is wrong
 * is saved and made small.
 *
 *     stress_circuits                 circuits of each class, as the environment says
 *     stress_circuits FILE...         judges these netlists and says what each run did
 *     stress_circuits shrink FILE     makes a netlist small, and writes it
 *     stress_circuits print CLASS N   writes a netlist of a class
 *     stress_circuits vary FILE...    other circuits of the kind of each of these
 *     stress_circuits varied FILE N   writes one of them
 *
 * STRESS_SEED (else from the clock), STRESS_COUNT circuits of each class (20), STRESS_SECONDS for all (none),
 * STRESS_CLASS (a part of the names), STRESS_LIMIT s of CPU for a run (5), STRESS_SHRINK s for making a find
 * small (30), STRESS_JOBS processes (1), STRESS_THETA part of the circuits that the theta scheme judges too
 * (0.5), STRESS_RUNS methods to be judged, as "exact sparse" (all), STRESS_FOLDER where finds go
 * (build/stress).
 */
#define _DEFAULT_SOURCE
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "programs.h"
#include "shown.h"
#include "shrink.h"
#include "vary.h"

enum { FAMILIES = 160, KINDS = 60, SMALL_OF_A_KIND = 2 };

/* Shared by all processes. */
typedef struct tally {
    long run[FAMILIES], of[FAMILIES][JUDGE_VERDICTS];
    char kind[KINDS][64], sample[KINDS][96];
    long kinds[KINDS];
    double slowest[FAMILIES];
} tally;

static family families[FAMILIES];
static int nfamilies;
static tally *all;
static unsigned long long seed;
static const char *folder;
static judge_options options;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void collect(void) {
    const char *part = getenv("STRESS_CLASS");
    for (int i = 0; families_all[i]; i++)
        for (const family *f = families_all[i]; f->name; f++)
            if (!part || strstr(f->name, part))
                families[nfamilies++] = *f;
}

/* --- finds --- */

static int kind_of(const char *kind) {
    for (int i = 0; i < KINDS; i++) {
        if (all->kind[i][0] == 0)
            snprintf(all->kind[i], sizeof all->kind[i], "%s", kind);
        if (strcmp(all->kind[i], kind) == 0)
            return i;
    }
    return KINDS - 1;
}

static void save(const char *path, const netlist *n, const judge_finding *f) {
    FILE *file = fopen(path, "w");
    if (!file) {
        perror(path);
        return;
    }
    fprintf(file, "%s: %s\n* %s\n", n->line[0], f->kind, f->line);
    for (int i = 1; i < n->count; i++)
        fprintf(file, "%s\n", n->line[i]);
    fprintf(file, ".end\n");
    fclose(file);
}

static void note(const char *name, unsigned long long number, netlist *n, judge_finding *f) {
    char path[256], at[96];
    const int kind = kind_of(f->kind);
    const long before = __atomic_fetch_add(&all->kinds[kind], 1, __ATOMIC_RELAXED);
    snprintf(at, sizeof at, "%.40s-%llu", name, number);
    if (before == 0)
        snprintf(all->sample[kind], sizeof all->sample[kind], "%s", at);
    snprintf(path, sizeof path, "%s/%s.cir", folder, at);
    save(path, n, f);
    printf("%-14s %-28s %s\n    %s\n", judge_name(f->verdict), at, f->kind, f->line);
    if (before < SMALL_OF_A_KIND && f->verdict != JUDGE_UNDECIDED && f->verdict != JUDGE_SLOW &&
        number_of("STRESS_SHRINK", 30) > 0) {
        shrink(n, f, &options, number_of("STRESS_SHRINK", 30));
        snprintf(path, sizeof path, "%s/%s.small.cir", folder, at);
        save(path, n, f);
        printf("    small: %d lines, %s\n", n->count, f->line);
    }
    fflush(stdout);
}

/* A circuit of a class, or of the kind of a file. */
static netlist kinds[FAMILIES];

static void one(int at, unsigned long long k) {
    const unsigned long long number = seed * 1000000 + k;
    netlist n = {0};
    if (kinds[at].count > 0)
        vary(&kinds[at], number, &n);
    else
        family_circuit(&families[at], number, &n);
    judge_options o = options;
    o.theta = (double)((number * 2654435761u) % 1000) < 1000 * number_of("STRESS_THETA", 0.5);
    judge_finding f = judge(&n, &o);
    if (kinds[at].count > 0 && f.verdict == JUDGE_RIGHT && o.spice.models)
        f = shown(&n, &o);
    __atomic_fetch_add(&all->run[at], 1, __ATOMIC_RELAXED);
    __atomic_fetch_add(&all->of[at][f.verdict], 1, __ATOMIC_RELAXED);
    if (f.seconds > all->slowest[at])
        all->slowest[at] = f.seconds;
    if (f.verdict != JUDGE_RIGHT)
        note(families[at].name, number, &n, &f);
    netlist_free(&n);
}

/* Every jobs-th circuit from `mine` on, class by class in turn. */
static void work(long mine, long jobs, long count, double until) {
    long at = 0;
    static char home[256];
    snprintf(home, sizeof home, "%s/ngspice.%ld", folder, mine);
    options.spice.folder = home;
    for (long k = 0; k < count; k++)
        for (int i = 0; i < nfamilies; i++, at++)
            if (at % jobs == mine && now() < until)
                one(i, (unsigned long long)k);
}

/* --- the table --- */

static long print_table(void) {
    long sum[JUDGE_VERDICTS] = {0}, run = 0;
    printf("\n%-22s %6s", "class", "run");
    for (int v = 0; v < JUDGE_VERDICTS; v++)
        printf(" %*s", v > 1 && v < 5 ? 14 : 9, judge_name((judge_verdict)v));
    printf(" %9s\n", "slowest s");
    for (int i = 0; i <= nfamilies; i++) {
        const long *of = i < nfamilies ? all->of[i] : sum;
        printf("%-22s %6ld", i < nfamilies ? families[i].name : "all", i < nfamilies ? all->run[i] : run);
        for (int v = 0; v < JUDGE_VERDICTS; v++)
            printf(" %*ld", v > 1 && v < 5 ? 14 : 9, of[v]);
        printf(" %9.2f\n", i < nfamilies ? all->slowest[i] : 0);
        run += i < nfamilies ? all->run[i] : 0;
        for (int v = 0; v < JUDGE_VERDICTS && i < nfamilies; v++)
            sum[v] += of[v];
    }
    for (int i = 0; i < KINDS && all->kind[i][0]; i++)
        printf("%6ld x %-34s first %s/%s.cir\n", all->kinds[i], all->kind[i], folder, all->sample[i]);
    return sum[JUDGE_WRONG_AUTO] + sum[JUDGE_REFUSED] + sum[JUDGE_CRASHED];
}

static int stress(void) {
    const long jobs = (long)number_of("STRESS_JOBS", 1), count = (long)number_of("STRESS_COUNT", 20);
    const double until = now() + number_of("STRESS_SECONDS", 1e9);
    all = mmap(NULL, sizeof *all, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED || nfamilies == 0)
        return 2;
    seed = (unsigned long long)number_of("STRESS_SEED", (double)(time(NULL) % 1000000));
    mkdir(folder, 0777);
    printf("STRESS_SEED=%llu, %d classes\n", seed, nfamilies);
    fflush(stdout);
    for (long k = 0; k < jobs; k++)
        if (fork() == 0) {
            work(k, jobs, count, until);
            _exit(0);
        }
    while (wait(NULL) > 0)
        ;
    return print_table() > 0;
}

static int judge_file(const char *path, int small) {
    netlist n = {0};
    FILE *file = fopen(path, "r");
    if (!file || netlist_read(&n, file))
        return fprintf(stderr, "%s: cannot be read\n", path), 2;
    fclose(file);
    if (!small)
        printf("%s\n", path);
    options.verbose = !small;
    options.theta = 1;
    judge_finding f = judge(&n, &options);
    if (small) {
        shrink(&n, &f, &options, number_of("STRESS_SHRINK", 120));
        printf("* %s: %s\n", f.kind, f.line);
        netlist_write(&n, stdout);
    } else
        printf("  %s %s\n    %s\n", judge_name(f.verdict), f.kind, f.line);
    netlist_free(&n);
    return f.verdict != JUDGE_RIGHT;
}

/* Files, as classes. */
static int collect_files(int count, char **path) {
    nfamilies = 0;
    for (int i = 0; i < count && i < FAMILIES; i++) {
        const char *name = strrchr(path[i], '/');
        FILE *file = fopen(path[i], "r");
        if (!file || netlist_read(&kinds[i], file))
            return fprintf(stderr, "%s: cannot be read\n", path[i]), 0;
        fclose(file);
        families[nfamilies++].name = name ? name + 1 : path[i];
    }
    return 1;
}

int main(int argc, char **argv) {
    int bad = 0;
    folder = getenv("STRESS_FOLDER") ? getenv("STRESS_FOLDER") : "build/stress";
    options = (judge_options){.limit = number_of("STRESS_LIMIT", 5),
                              .runs = judge_runs(getenv("STRESS_RUNS")),
                              .spice = {getenv("STRESS_NGSPICE"), "/tmp"}};
    collect();
    if (argc == 4 && strcmp(argv[1], "print") == 0) {
        netlist n = {0};
        for (int i = 0; i < nfamilies; i++)
            if (strcmp(families[i].name, argv[2]) == 0) {
                family_circuit(&families[i], strtoull(argv[3], NULL, 10), &n);
                netlist_write(&n, stdout);
            }
        return n.count == 0;
    }
    if (argc == 4 && strcmp(argv[1], "varied") == 0 && collect_files(1, argv + 2)) {
        netlist n = {0};
        vary(&kinds[0], strtoull(argv[3], NULL, 10), &n);
        netlist_write(&n, stdout);
        return 0;
    }
    if (argc > 2 && strcmp(argv[1], "vary") == 0)
        return collect_files(argc - 2, argv + 2) ? stress() : 2;
    if (argc == 3 && strcmp(argv[1], "shrink") == 0)
        return judge_file(argv[2], 1);
    for (int i = 1; i < argc; i++)
        bad |= judge_file(argv[i], 0);
    return argc > 1 ? bad : stress();
}
