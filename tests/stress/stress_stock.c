/* tests/stress/stress_stock.c - random circuits in ngspice by ideal devices, and by ngspice's own models at
 * several settings: is any of these right within 1 %, and takes less CPU time?
 *
 * STRESS_SEED (from the clock, printed), STRESS_COUNT circuits of random classes (200), STRESS_CLASS (a part
 * of the names), STRESS_SECONDS for all (none), STRESS_LIMIT s of CPU for one run (20), STRESS_NGSPICE the
 * path of nonsmooth.cm, STRESS_FOLDER (build/stress).
 * CPU times are of the process, less that of ngspice reading the same netlist.  Another setting gets as much
 * time as we took.  Right is what differs little from `auto` in the library, with which our run has to agree.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "judge_internal.h"
#include "programs.h"
#include "stock.h"

enum { NAME = 64 };
/* Right is what differs by no more than this, of a signal's largest value. */
static const double right_within = 1e-2;
/* CPU times that differ by less are the same, and none is shorter than that, s. */
static const double least = 5e-3, shortest = 1e-4;

static spice_home ours, own;
static double limit;
static int circuits, without, slower, slower_as_coarse, unlike;

/* CPU time of a start, s: the least of three. */
static double start_of(const netlist *n, const spice_home *home) {
    double seconds = INFINITY;
    for (int i = 0; i < 3; i++)
        seconds = fmin(seconds, spice_start(n, &judge_of.p, home, limit));
    return seconds;
}

/* CPU time of a run that is right within 1 %, less that of its start; INFINITY: it is not, or takes more. */
static double time_right(const netlist *n, const spice_home *home, double most) {
    const double start = start_of(n, home);
    spice_run(n, &judge_of.p, home, 1.2 * start + most + 0.01, judge_of.result[J_VARIED]);
    const run_result *r = judge_of.result[J_VARIED];
    if (r->end != RUN_DONE || r->t < judge_of.p.stop * (1 - 1e-6) ||
        judge_between(J_VARIED, J_AUTO).most > right_within ||
        judge_between(J_AUTO, J_VARIED).most > right_within)
        return INFINITY;
    return fmax(r->seconds - start, shortest);
}

static double time_of_setting(const netlist *n, int number, double most) {
    const stock_setting s = stock_setting_of(number);
    netlist stock = stock_netlist(n, &judge_of.p, &s);
    const double t = time_right(&stock, &own, most);
    netlist_free(&stock);
    return t;
}

/* The fastest setting that is right, and its time; no more than `most`. */
static double fastest(const netlist *n, double most, int *setting) {
    *setting = -1;
    for (int i = 0; i < STOCK_SETTINGS; i++) {
        const double t = time_of_setting(n, i, most);
        if (t < most) {
            *setting = i;
            most = t;
        }
    }
    return most;
}

/* Ours, with waveforms shown within the 1 % that ngspice's own are held to. */
static double time_as_coarse(const netlist *n, double most) {
    netlist c = netlist_copy(n);
    netlist_put(&c, "AOPT 0 nsopt\n.model nsopt nonsmooth(lines=%g)", right_within);
    const double t = time_right(&c, &ours, most);
    netlist_free(&c);
    return t;
}

static void show(const char *name, double us, double coarse, double them, int setting) {
    char by[80];
    const stock_setting s = stock_setting_of(setting);
    stock_name(&s, by, sizeof by);
    printf("%-36s %8.1f ms %8.1f ms %8.1f ms %6.2f %6.2f  %s\n", name, 1e3 * us, 1e3 * coarse, 1e3 * them,
           us / them, coarse / them, by);
    fflush(stdout);
}

static void measure(const char *name, const netlist *n) {
    int setting;
    const judge_options o = {.limit = limit, .spice = ours};
    if (judge_begin(n))
        return;
    judge_start_run(J_AUTO, &o);
    judge_start_run(J_SPICE, &o);
    judge_find_scales();
    if (!judge_agree(J_SPICE, J_AUTO)) {
        unlike++;
        return;
    }
    const double us = fmax(judge_of.result[J_SPICE]->seconds - start_of(n, &ours), shortest);
    const double them = fastest(n, fmax(us, least), &setting);
    circuits++;
    without += setting < 0;
    if (setting < 0 || them > us - least)
        return;
    const double coarse = time_as_coarse(n, limit);
    slower++;
    slower_as_coarse += them <= coarse - least;
    show(name, us, coarse, them, setting);
}

static const family *any_family(dice *d) {
    const char *part = getenv("STRESS_CLASS");
    const family *found = NULL;
    int count = 0;
    for (int i = 0; families_all[i]; i++)
        for (const family *f = families_all[i]; f->name; f++)
            if ((!part || strstr(f->name, part)) && dice_below(d, ++count) == 0)
                found = f;
    return found;
}

static void measure_random(const family *f, unsigned long long number) {
    netlist n = {0};
    char name[NAME];
    snprintf(name, sizeof name, "%.40s-%llu", f->name, number);
    family_circuit(f, number, &n);
    measure(name, &n);
    netlist_free(&n);
}

int main(void) {
    const unsigned long long seed =
        (unsigned long long)number_of("STRESS_SEED", (double)(time(NULL) % 100000));
    const int count = (int)number_of("STRESS_COUNT", 200);
    const time_t until = time(NULL) + (time_t)number_of("STRESS_SECONDS", 1e9);
    const char *folder = getenv("STRESS_FOLDER");
    dice d = dice_make(1, seed);
    limit = number_of("STRESS_LIMIT", 20);
    ours = own = (spice_home){getenv("STRESS_NGSPICE"), folder ? folder : "build/stress"};
    own.models = NULL;
    printf(
        "STRESS_SEED=%llu; circuits that ngspice's own models simulate right within 1 %% in less CPU time\n"
        "%-36s %11s %11s %11s %6s %6s  %s\n",
        seed, "circuit", "default", "lines=1e-2", "ngspice", "ratio", "ratio", "its setting");
    for (int k = 0; k < count && time(NULL) < until; k++) {
        const family *f = any_family(&d);
        if (f)
            measure_random(f, seed * 1000000 + (unsigned long long)k);
    }
    printf(
        "%d circuits: ngspice's fastest setting of %d that is right within 1 %% takes less CPU time than %d "
        "at default options, than %d with lines=1e-2 (waveforms within the same 1 %%); for %d none is right "
        "within our time; %d did not end, or not alike\n",
        circuits, STOCK_SETTINGS, slower, slower_as_coarse, without, unlike);
    return circuits == 0 ? 2 : slower_as_coarse > 0;
}
