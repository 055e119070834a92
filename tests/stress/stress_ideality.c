/* tests/stress/stress_ideality.c - the sweep of ideality: every circuit with devices from ideal to poor, what
 * each costs beside the ideal one, and how far its waveforms are from it.
 *
 *     stress_ideality [NETLIST...]
 *
 * Circuits: these netlists; Cockcroft-Walton multipliers of 5 to 50 stages; Dickson pumps of 4 to 16; twenty
 * classes of stress_circuits, by STRESS_SEED (else from the clock).  Every diode and switch gets each ron and
 * roff of the lists below; a run is "auto" by default options.  STRESS_CLASS: a part of the circuits' names.
 * Writes ideality.dat and .gp, for gnuplot, into STRESS_FOLDER (build/stress).
 */
#define _DEFAULT_SOURCE
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "maker.h"
#include "run.h"

static const double rons[] = {0, 1e-9, 1e-6, 1e-3, 0.1, 1}, roffs[] = {INFINITY, 1e15, 1e12, 1e9, 1e6, 1e3};
enum { RONS = sizeof rons / sizeof *rons, ROFFS = sizeof roffs / sizeof *roffs, CELLS = RONS * ROFFS };
enum { CIRCUITS = 100 };

static const double goal = 3;          /* CPU of a cell over that of the ideal circuit, at most */
static const double enough = 0.05;     /* s: shorter runs are repeated; clocks of CPU may tick in 4 ms */
static const double least_time = 5e-5; /* s: what the ideal circuit counts as, at least */
static const double most = 30; /* a cell that takes longer, relative to the goal's measure, is ended */

typedef struct sweep {
    char name[64];
    double seconds[CELLS], error[CELLS]; /* NAN: refused, or ended */
    run_end end[CELLS];
    char said[RUN_LINE + 40]; /* of the first cell that failed: which, and why */
    int fastest; /* the cell that others are compared with: the ideal circuit, if it has a solution */
} sweep;

static sweep all[CIRCUITS];
static int nall;

/* --- circuits --- */

static void put_models(netlist *n) {
    netlist_put(n, ".model md ideal_diode()");
}

static void make_multiplier(int stages, netlist *n) {
    netlist_put(n, "* multiplier of %d stages", stages);
    netlist_put(n, "V1 a0 0 SIN(0 100 10000)");
    for (int k = 1; k <= stages; k++) {
        char below[24];
        snprintf(below, sizeof below, k == 1 ? "0" : "s%d", k - 1);
        netlist_put(n, "CA%d a%d a%d 100n ic=0", k, k - 1, k);
        netlist_put(n, "CS%d %s s%d 100n ic=0", k, below, k);
        netlist_put(n, "AD%d %s a%d md", k, below, k);
        netlist_put(n, "AE%d a%d s%d md", k, k, k);
    }
    netlist_put(n, "R1 s%d 0 10meg", stages);
    put_models(n);
    netlist_put(n, ".tran 1u 1m uic");
}

static void make_dickson(int stages, netlist *n) {
    netlist_put(n, "* Dickson pump of %d stages", stages);
    netlist_put(n, "V1 n0 0 5");
    netlist_put(n, "VA ca 0 PULSE(0 5 0 10n 10n 490n 1u)");
    netlist_put(n, "VB cb 0 PULSE(5 0 0 10n 10n 490n 1u)");
    for (int k = 1; k <= stages; k++) {
        netlist_put(n, "AD%d n%d n%d md", k, k - 1, k);
        netlist_put(n, "C%d %s n%d 1n ic=0", k, k % 2 ? "ca" : "cb", k);
    }
    netlist_put(n, "ADO n%d out md", stages);
    netlist_put(n, "CO out 0 10n ic=0");
    netlist_put(n, "RO out 0 100k");
    put_models(n);
    netlist_put(n, ".tran 10n 100u uic");
}

static void set_devices(plan *p, double ron, double roff) {
    for (int at = 0; at < p->parts; at++) {
        plan_part *e = &p->part[at];
        if (e->kind == 'd') {
            e->diode.ron = ron;
            e->diode.roff = roff;
        } else if (e->kind == 's') {
            e->contact.ron = ron;
            e->contact.roff = roff;
        }
    }
}

/* --- one circuit --- */

static void run_cell(const plan *ideal, int cell, double limit, run_result *r) {
    static plan p;
    const run_setting s = {.name = "auto", .method = NS_AUTO, .limit = limit, .at_least = enough};
    p = *ideal;
    for (int at = 0; at < p.parts; at++) /* the corners of a PWL are in the part */
        if (p.part[at].signal.kind == NS_PWL) {
            p.part[at].signal.u.pwl.t = p.part[at].corner_t;
            p.part[at].signal.u.pwl.v = p.part[at].corner_v;
        }
    set_devices(&p, rons[cell % RONS], roffs[cell / RONS]);
    run(&p, &s, r);
}

/* The largest value of probe i; of all of its kind, voltages or currents. */
static double size_of(const plan *p, const run_result *r, int i) {
    double size = 0;
    for (int k = 0; k < RUN_TIMES * RUN_BAND; k++)
        size = fmax(size, fabs(r->value[k * p->probes + i]));
    return size;
}

static double size_of_kind(const plan *p, const run_result *r, int i) {
    double size = 0;
    for (int j = 0; j < p->probes; j++)
        if ((p->probe[j].part < 0) == (p->probe[i].part < 0))
            size = fmax(size, size_of(p, r, j));
    return size;
}

/* The largest difference of a signal at the middle of each band, relative to its largest value or to 1e-5 of
 * the largest of all, as judge.c has it. */
static double difference(const plan *p, const run_result *a, const run_result *b) {
    double worst = 0;
    for (int i = 0; i < p->probes; i++) {
        const double size = fmax(size_of(p, b, i), 1e-5 * size_of_kind(p, b, i));
        for (int k = 0; k < RUN_TIMES && size > 0; k++) {
            const int at = (k * RUN_BAND + 1) * p->probes + i;
            worst = fmax(worst, fabs(a->value[at] - b->value[at]) / size);
        }
    }
    return worst;
}

static double ratio(const sweep *s, int cell) {
    return fmax(s->seconds[cell], least_time) / fmax(s->seconds[s->fastest], least_time);
}

static int is_counted(const sweep *s, int cell) {
    return s->end[s->fastest] == RUN_DONE && cell != s->fastest;
}

static void print_sweep(const sweep *s) {
    int worst = s->fastest, above = 0, failed = 0;
    for (int c = 0; c < CELLS; c++) {
        failed += s->end[c] != RUN_DONE && s->end[c] != RUN_SLOW;
        above += ratio(s, c) > goal;
        worst = ratio(s, c) > ratio(s, worst) ? c : worst;
    }
    printf("%-34s %9.2f ms %s worst %6.2f at ron=%-6g roff=%-6g above %2d failed %2d  off %.1e %.1e\n",
           s->name, 1e3 * s->seconds[s->fastest], s->fastest == 0 ? "     " : "(not)", ratio(s, worst),
           rons[worst % RONS], roffs[worst / RONS], above, failed, s->error[1], s->error[RONS]);
    if (failed > 0)
        printf("    %s\n", s->said);
    fflush(stdout);
}

static void sweep_plan(const char *name, const plan *p) {
    static run_result *ideal, *r;
    sweep *s = &all[nall];
    if (nall == CIRCUITS)
        return;
    if (!ideal) {
        ideal = run_room();
        r = run_room();
    }
    nall++;
    snprintf(s->name, sizeof s->name, "%.60s", name);
    for (int c = 0; c < CELLS; c++) {
        run_result *to = c == 0 ? ideal : r;
        const double base = s->seconds[s->fastest];
        run_cell(p, c, c == 0 ? 20 : fmax(1, most * base), to);
        s->seconds[c] = to->seconds;
        s->end[c] = to->end;
        s->error[c] = to->end == RUN_DONE && ideal->end == RUN_DONE ? difference(p, to, ideal) : NAN;
        if (to->end != RUN_DONE && to->end != RUN_SLOW && !s->said[0])
            snprintf(s->said, sizeof s->said, "ron=%g roff=%g: %s", rons[c % RONS], roffs[c / RONS],
                     to->line);
        if (s->end[0] != RUN_DONE && to->end == RUN_DONE &&
            (s->end[s->fastest] != RUN_DONE || to->seconds < s->seconds[s->fastest]))
            s->fastest = c;
    }
    print_sweep(s);
}

/* The text of a parameter, behind "name=" of a line .param; NULL: of none. */
static const char *text_of_parameter(const netlist *n, const char *name, size_t length) {
    for (int i = 1; i < n->count; i++) {
        const char *at = strncmp(n->line[i], ".param ", 7) == 0 ? n->line[i] + 6 : NULL;
        for (; at; at = strchr(at + 1, ' '))
            if (strncmp(at + 1, name, length) == 0 && at[1 + length] == '=')
                return at + 1 + length + 1;
    }
    return NULL;
}

/* The texts of parameters for their names in braces. */
static void put_parameters(netlist *n) {
    for (int i = 1; i < n->count; i++)
        for (char *open = strchr(n->line[i], '{'); open; open = strchr(n->line[i], '{')) {
            char line[1024];
            const size_t length = strcspn(open + 1, "}");
            const char *text = text_of_parameter(n, open + 1, length);
            if (!text || !open[1 + length])
                break;
            snprintf(line, sizeof line, "%.*s%.*s%s", (int)(open - n->line[i]), n->line[i],
                     (int)strcspn(text, " "), text, open + length + 2);
            netlist_set(n, i, line);
        }
}

/* A line that the reader does not know: NULL, or what it says. */
static const char *unknown_line(netlist *n, plan *p) {
    put_parameters(n);
    for (int i = 1; i < n->count; i++)
        if (n->line[i][0] != '*' && strchr(n->line[i], '{'))
            return n->line[i];
    return plan_read(n, p);
}

static void sweep_netlist(const char *name, netlist *n) {
    static plan p;
    const char *part = getenv("STRESS_CLASS");
    const char *line = part && !strstr(name, part) ? "" : unknown_line(n, &p);
    if (!line)
        sweep_plan(name, &p);
    else if (*line)
        printf("%-34s not read: %s\n", name, line);
    netlist_free(n);
}

/* --- all --- */

/* Without the commands between .control and .endc. */
static void drop_commands(netlist *n) {
    int inside = 0;
    for (int i = 0; i < n->count;) {
        const int begins = strncmp(n->line[i], ".control", 8) == 0,
                  ends = strncmp(n->line[i], ".endc", 5) == 0;
        inside |= begins;
        if (inside)
            netlist_drop(n, i);
        else
            i++;
        inside &= !ends;
    }
}

static void sweep_files(int count, char **path) {
    for (int i = 0; i < count; i++) {
        netlist n = {0};
        FILE *file = fopen(path[i], "r");
        const char *base = strrchr(path[i], '/');
        if (!file || netlist_read(&n, file))
            printf("%s: cannot be read\n", path[i]);
        else {
            drop_commands(&n);
            sweep_netlist(base ? base + 1 : path[i], &n);
        }
        if (file)
            fclose(file);
    }
}

static void sweep_generated(void) {
    static const int stages[] = {5, 10, 20, 50}, pumps[] = {4, 8, 16};
    char name[64];
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        netlist n = {0};
        make_multiplier(stages[i], &n);
        snprintf(name, sizeof name, "multiplier %d", stages[i]);
        sweep_netlist(name, &n);
    }
    for (size_t i = 0; i < sizeof pumps / sizeof *pumps; i++) {
        netlist n = {0};
        make_dickson(pumps[i], &n);
        snprintf(name, sizeof name, "dickson %d", pumps[i]);
        sweep_netlist(name, &n);
    }
}

/* Twenty classes, evenly spread. */
static void sweep_classes(unsigned long long seed) {
    const family *const lists[] = {families_dcdc,      families_isolated, families_rectifiers,
                                   families_inverters, families_pumps,    NULL};
    enum { WANTED = 20 };
    int count = 0, at = 0;
    for (int i = 0; lists[i]; i++)
        for (const family *f = lists[i]; f->name; f++)
            count++;
    for (int i = 0; lists[i]; i++)
        for (const family *f = lists[i]; f->name; f++, at++) {
            netlist n = {0};
            maker m;
            char name[64];
            if (at * WANTED / count == (at + 1) * WANTED / count)
                continue;
            maker_begin(&m, &n, f->name, seed * 1000000);
            f->make(&m);
            maker_end(&m);
            snprintf(name, sizeof name, "%.40s-%llu", f->name, seed * 1000000);
            sweep_netlist(name, &n);
        }
}

static void print_cells(FILE *to, int as_data) {
    for (int b = 0; b < ROFFS; b++) {
        for (int a = 0; a < RONS; a++) {
            double sum = 0, worst = 0;
            int n = 0;
            for (int i = 0; i < nall; i++)
                if (is_counted(&all[i], b * RONS + a) && all[i].end[b * RONS + a] == RUN_DONE) {
                    sum += log(ratio(&all[i], b * RONS + a));
                    worst = fmax(worst, ratio(&all[i], b * RONS + a));
                    n++;
                }
            const double mean = n > 0 ? exp(sum / n) : NAN;
            if (as_data)
                fprintf(to, "%d %d %.3f %.3f\n", a, b, mean, worst);
            else
                fprintf(to, "  %5.2f /%6.1f", mean, worst);
        }
        fprintf(to, as_data ? "\n" : "   roff=%g\n", roffs[b]);
    }
}

static void draw_cells(const char *folder) {
    char path[300];
    snprintf(path, sizeof path, "%s/ideality.dat", folder);
    FILE *dat = fopen(path, "w");
    snprintf(path, sizeof path, "%s/ideality.gp", folder);
    FILE *gp = fopen(path, "w");
    if (dat)
        print_cells(dat, 1);
    if (gp) {
        fprintf(gp, "set terminal pngcairo size 900,700\nset output '%s/ideality.png'\n", folder);
        fprintf(gp, "set title 'CPU over that of the ideal circuit: geometric mean / worst of %d circuits'\n",
                nall);
        fprintf(gp, "set xlabel 'ron (ohm)'\nset ylabel 'roff (ohm)'\nset xtics (");
        for (int a = 0; a < RONS; a++)
            fprintf(gp, "%s'%g' %d", a ? ", " : "", rons[a], a);
        fprintf(gp, ")\nset ytics (");
        for (int b = 0; b < ROFFS; b++)
            fprintf(gp, "%s'%g' %d", b ? ", " : "", roffs[b], b);
        fprintf(gp, ")\nset logscale cb\nset cbrange [0.5:30]\nset palette defined (0 'white', 1 "
                    "'red')\nunset key\n");
        fprintf(gp, "plot '%s/ideality.dat' using 1:2:4 with image, ", folder);
        fprintf(gp, "'' using 1:2:(sprintf('%%.1f / %%.1f', $3, $4)) with labels\n");
    }
    if (dat)
        fclose(dat);
    if (gp)
        fclose(gp);
}

int main(int argc, char **argv) {
    const char *named = getenv("STRESS_FOLDER"), *folder = named ? named : "build/stress";
    const char *given = getenv("STRESS_SEED");
    const unsigned long long seed =
        given ? strtoull(given, NULL, 10) : (unsigned long long)time(NULL) % 1000000;
    long cells = 0, above = 0, failed = 0;
    mkdir(folder, 0777);
    printf("STRESS_SEED=%llu; CPU of the ideal circuit, (not): of the fastest, as that has no solution; off: "
           "how far "
           "ron=1e-9, roff=1e15 are from it\n",
           seed);
    sweep_files(argc - 1, argv + 1);
    sweep_generated();
    sweep_classes(seed);
    for (int i = 0; i < nall; i++)
        for (int c = 0; c < CELLS; c++) {
            cells += is_counted(&all[i], c);
            above += is_counted(&all[i], c) && ratio(&all[i], c) > goal;
            failed += is_counted(&all[i], c) && all[i].end[c] != RUN_DONE && all[i].end[c] != RUN_SLOW;
        }
    printf("\nCPU over that of the ideal circuit, geometric mean / worst, by ron = 0, 1n, 1u, 1m, 0.1, 1:\n");
    print_cells(stdout, 0);
    printf("%ld cells of %d circuits, %ld above %g times the ideal circuit, %ld failed\n", cells, nall, above,
           goal, failed);
    draw_cells(folder);
    return above + failed > 0;
}
