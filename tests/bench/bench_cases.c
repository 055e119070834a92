/* tests/bench/bench_cases.c - work against precision: circuits run by the library's engines, by ngspice with
 * its own models at many settings, by ngspice with ours, and by Siconos where it was built.
 *
 *     bench_cases [NAME...]       cases by part of their name; none: all
 *
 * Environment: BENCH=quick for fewer settings and no large circuit, BENCH=library for nothing but the
 * library, BENCH=netlists for nothing but the twenty netlists through ngspice; NONSMOOTH_CM
 * (build/bench/nonsmooth.cm); NGSPICE.  Tables go to stdout; CSV and gnuplot scripts to build/bench/, the
 * last netlist to build/bench/run.
 *
 * All runs of a case take turns, round by round; times are medians of CPU time, on one thread.  Of the
 * library and of Siconos from a circuit whose elements were read to the last value (creation of matrices and
 * engine, which is in it, said apart); of ngspice that of its process less the median of some that read the
 * same netlist and end (the whole process said apart), where its set-up of matrices is in it too.  Short runs
 * are repeated: the library's (the median counts), and ngspice's within one process, up to 30 ms in all, as
 * its start, of some 10 ms, scatters by more than such runs take.  What fails, or takes longer than it may,
 * is counted. */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <string.h>
#include <sys/stat.h>

#include "precision.h"
#include "rival.h"
#include "scaling.h"
#include "sweep.h"

enum { MOST_CASES = 48 };
static const char *const folder = "build/bench", *const runs = "build/bench/run";

static void run_case(bench_case *c, const plan *p, duel *d, scaling *s) {
    int count;
    case_prepare(c);
    row *rows = sweep_run(c, p, &count);
    report_table(c, count, rows);
    report_duel(c, count, rows, d);
    report_files(c, folder, count, rows);
    if (strncmp(c->name, "ladder", 6) == 0)
        scaling_add(s, c, count, rows);
    fflush(stdout);
    free(rows);
}

/* --- all --- */

static int asked(const bench_case *c, const plan *p, int count, char **names) {
    for (int i = 0; i < count; i++)
        if (strstr(c->name, names[i]))
            return 1;
    return count == 0 && !(p->quick && c->slow) && !(p->library && c->file) && !(p->netlists && !c->through);
}

int main(int argc, char **argv) {
    const char *bench = getenv("BENCH"), *models = getenv("NONSMOOTH_CM");
    plan p = {.quick = bench && strcmp(bench, "quick") == 0,
              .library = bench && strcmp(bench, "library") == 0,
              .netlists = bench && strcmp(bench, "netlists") == 0};
    bench_case c;
    duel duels[MOST_CASES];
    static scaling ladders;
    char cm[4096];
    int count = 0;
    p.rounds = p.quick || p.library ? 1 : 3;
    p.limit = p.quick ? 1 : 5;
    p.budget = p.quick ? 2 : p.library ? 20 : p.netlists ? 8 : 4;
    if (!realpath(models ? models : "build/bench/nonsmooth.cm", cm)) {
        perror("nonsmooth.cm");
        return 1;
    }
    (void)mkdir(runs, 0777);
    rival_home(runs, cm);
    printf(
        "errors: the largest over some instants and unknowns, relative to the largest right value of each\n");
    for (int i = 0; case_make(i, p.quick, &c); i++) {
        if (asked(&c, &p, argc - 1, argv + 1))
            run_case(&c, &p, &duels[count++], &ladders);
        case_free(&c);
    }
    if (ladders.count > 0)
        scaling_report(&ladders, folder);
    report_summary(count, duels, p.netlists);
    if (!p.netlists)
        precision_picture(folder);
    return 0;
}
