/* tests/bench/rival.c - ngspice in batch: netlist written, process run under a limit, raw file read. */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rival.h"

static const char *folder = ".", *cm = "nonsmooth.cm";

void rival_home(const char *in, const char *models) {
    folder = in;
    cm = models;
}

static FILE *open_in(const char *name, const char *mode) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return fopen(path, mode);
}

static FILE *write_in(const char *name) {
    FILE *f = open_in(name, "w");
    if (!f) {
        perror(name);
        exit(1);
    }
    return f;
}

/* A source with a corner at each time that is compared, so that ngspice has a point there. */
static void write_marks(const bench_case *c, FILE *f) {
    fprintf(f, "vmark mark 0 pwl(0 0");
    for (int k = 0; k < c->times; k++)
        fprintf(f, " %.17g %d", c->time[k], (k + 1) % 2);
    fprintf(f, ")\n");
}

static void write_netlist(const bench_case *c, const rival_setting *s, int runs, FILE *f) {
    const double step = s->step * c->unit;
    fprintf(f, "* %s\n", c->name);
    if (c->net)
        deck_netlist(c->net, &s->models, f);
    else if (c->file)
        case_netlist_lines(c, &s->models, f);
    else
        c->netlist(&s->models, f);
    if (s->options)
        fprintf(f, "aopt 0 nsopt\n.model nsopt nonsmooth(%s)\n", s->options);
    if (!s->unmarked)
        write_marks(c, f);
    if (s->models.diode == DECK_SIDIODE)
        fprintf(f, ".options convstep=1e9 convabsstep=1e9 abstol=1e-6 vntol=1e-3 chgtol=1e-9\n");
    fprintf(f, ".options reltol=%g method=%s\n.save", s->reltol, s->gear ? "gear" : "trap");
    for (int i = 0; i < c->unknowns; i++)
        fprintf(f, " %s", c->unknown[i].vector);
    fprintf(f, "\n.tran %.17g %.17g 0 %.17g%s\n.control\n", step, c->end, step, c->from_dc ? "" : " uic");
    for (int k = 0; k < runs; k++) /* the more plots there are, the longer ngspice takes for a point */
        fprintf(f, k > 0 ? "destroy all\nrun\n" : "run\n");
    fprintf(f, "%squit 0\n.endc\n.end\n",
            runs == 0 ? "" : "rusage rejected\nset filetype=binary\nwrite out.raw\n");
}

static void write_inputs(const bench_case *c, const rival_setting *s, int runs) {
    FILE *f = write_in("case.cir"), *init = write_in(".spiceinit");
    write_netlist(c, s, runs, f);
    fprintf(init,
            "set norefvalue\n"); /* else ngspice asks for its CPU time at each point, a fifth of its cost */
    if (s->models.diode == DECK_IDEAL)
        fprintf(init, "codemodel '%s'\n", cm);
    else
        fprintf(init, "set xtrtol=7\n");
    fclose(f);
    fclose(init);
    fclose(write_in("out.raw")); /* nothing of a run before */
}

static void become_ngspice(double limit) {
    const struct rlimit cpu = {(rlim_t)ceil(limit), (rlim_t)ceil(limit) + 1};
    const char *program = getenv("NGSPICE");
    setrlimit(RLIMIT_CPU, &cpu);
    if (chdir(folder) != 0)
        _exit(127);
    const int null = open("/dev/null", O_RDONLY), out = open("out", O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(null, 0);
    dup2(out, 1);
    dup2(out, 2);
    setenv("HOME", ".", 1);
    execlp(program ? program : "ngspice", "ngspice", "-b", "case.cir", (char *)NULL);
    _exit(127);
}

static void run(double limit, rival_result *r) {
    struct rusage used;
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0)
        become_ngspice(limit);
    if (child < 0 || wait4(child, &status, 0, &used) < 0)
        must(NS_E_MEMORY);
    r->process = (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                 1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
    const int killed = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
    r->end = killed                                          ? RIVAL_TIMEOUT
             : WIFEXITED(status) && WEXITSTATUS(status) == 0 ? RIVAL_DONE
                                                             : RIVAL_ABORTED;
}

static void read_said(rival_result *r) {
    char line[256];
    FILE *f = open_in("out", "r");
    while (f && fgets(line, sizeof line, f)) {
        (void)sscanf(line, "Rejected timepoints = %ld", &r->rejected);
        if (strstr(line, "imestep too small") || strstr(line, "run simulation(s) aborted"))
            r->end = RIVAL_ABORTED;
    }
    if (f)
        fclose(f);
}

/* --- the raw file --- */

/* Reads the head; column[i] gets the place of unknown i. */
static int read_head(const bench_case *c, FILE *f, long *points, int *columns, int *column) {
    char line[512], name[64];
    int at;
    *points = *columns = 0;
    for (int i = 0; i < c->unknowns; i++)
        column[i] = -1;
    while (fgets(line, sizeof line, f) && strncmp(line, "Binary:", 7) != 0) {
        (void)sscanf(line, "No. Variables: %d", columns);
        (void)sscanf(line, "No. Points: %ld", points);
        if (sscanf(line, " %d %63s", &at, name) == 2)
            for (int i = 0; i < c->unknowns; i++)
                if (strcmp(name, c->unknown[i].vector) == 0)
                    column[i] = at;
    }
    for (int i = 0; i < c->unknowns; i++)
        if (column[i] < 0)
            return 0;
    return *points > 1;
}

/* The values at time k on the straight line between two points. */
static void add_values(const bench_case *c, int k, const double *last, const double *row, const int *column,
                       rival_result *r) {
    const double share = fmin(1, (c->time[k] - last[0]) / (row[0] - last[0]));
    for (int i = 0; i < c->unknowns; i++)
        r->values[k * c->unknowns + i] = last[column[i]] + share * (row[column[i]] - last[column[i]]);
}

static void add_line(const bench_case *c, const double *last, const double *row, const int *column,
                     rival_result *r) {
    for (int i = 0; i < c->unknowns; i++) {
        rival_shape *s = &r->shape[i];
        const double x = last[column[i]], y = row[column[i]], part = (row[0] - last[0]) / c->end;
        s->mean += part * (x + y) / 2;
        s->size += part * (fabs(x) + fabs(y)) / 2;
        s->most = fmax(s->most, y);
        s->least = fmin(s->least, y);
    }
}

static int read_points(const bench_case *c, FILE *f, int columns, const int *column, rival_result *r) {
    double *row = room(2 * (size_t)columns * sizeof *row), *last = row + columns;
    int k = 0;
    for (long p = 0; p < r->points; p++) {
        memcpy(last, row, (size_t)columns * sizeof *row);
        if (fread(row, sizeof *row, (size_t)columns, f) != (size_t)columns)
            break;
        for (int i = 0; i < c->unknowns && p == 0; i++)
            r->shape[i].most = r->shape[i].least = row[column[i]];
        if (p > 0)
            add_line(c, last, row, column, r);
        for (; k < c->times && p > 0 && row[0] >= c->time[k] * (1 - 1e-12); k++)
            add_values(c, k, last, row, column, r);
    }
    free(row);
    return k == c->times;
}

static int read_raw(const bench_case *c, rival_result *r) {
    int columns, column[CASE_UNKNOWNS], got = 0;
    FILE *f = open_in("out.raw", "r");
    if (!f)
        return 0;
    if (read_head(c, f, &r->points, &columns, column))
        got = read_points(c, f, columns, column, r);
    fclose(f);
    return got;
}

void rival_run(const bench_case *c, const rival_setting *s, int runs, double limit, rival_result *r) {
    memset(r, 0, sizeof *r);
    for (int i = 0; i < CASE_VALUES; i++)
        r->values[i] = NAN;
    write_inputs(c, s, runs);
    run(limit, r);
    read_said(r);
    if (r->end == RIVAL_DONE && runs > 0 && !read_raw(c, r))
        r->end = RIVAL_ABORTED;
}
