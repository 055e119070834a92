/* tests/stress/spice.c - netlist written, process run, raw file read. */
#define _DEFAULT_SOURCE
#include "spice.h"

#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

enum { COLUMNS = 2 * PLAN_PROBES + 1 };

static FILE *open_in(const spice_home *home, const char *name, const char *mode) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", home->folder, name);
    return fopen(path, mode);
}

/* --- what it gets --- */

static void write_saves(const plan *p, FILE *file) {
    fprintf(file, ".save");
    for (int i = 0; i < p->probes; i++)
        if (p->probe[i].part >= 0)
            fprintf(file, " i(%s)", p->part[p->probe[i].part].name);
        else
            for (int k = 0; k < 2; k++)
                if (p->probe[i].node[k])
                    fprintf(file, " v(%s)", p->node[p->probe[i].node[k]]);
    fprintf(file, "\n");
}

static int write_inputs(const netlist *n, const plan *p, const spice_home *home, int runs) {
    char path[512];
    (void)mkdir(home->folder, 0777); /* or it is there */
    FILE *file = open_in(home, "case.cir", "w"), *init = open_in(home, ".spiceinit", "w");
    snprintf(path, sizeof path, "%s/out.raw", home->folder);
    unlink(path);
    if (file && init) {
        for (int i = 0; i < n->count; i++)
            if (strncasecmp(n->line[i], ".save", 5) != 0 && strcasecmp(n->line[i], ".end") != 0)
                fprintf(file, "%s\n", n->line[i]);
        write_saves(p, file);
        fprintf(file, ".control\n%squit 0\n.endc\n.end\n",
                runs ? "run\nset filetype=binary\nwrite out.raw\n" : "");
        if (home->models)
            fprintf(init, "codemodel '%s'\n", home->models);
        else
            fprintf(init, "set xtrtol=7\n"); /* else ngspice takes 1 because of sidiode */
        fprintf(init, "set norefvalue\n");   /* else ngspice asks for its CPU time at each point */
    }
    const int bad = !file || !init;
    if (file)
        fclose(file);
    if (init)
        fclose(init);
    return bad;
}

static void become_ngspice(const spice_home *home, double limit) {
    const struct rlimit cpu = {(rlim_t)ceil(limit), (rlim_t)ceil(limit) + 1};
    const double whole = floor(limit);
    const struct itimerval timer = {
        .it_value = {(time_t)whole, 1 + (suseconds_t)(1e6 * (limit - whole))}}; /* SIGPROF; exec keeps it */
    const char *program = getenv("NGSPICE");
    setrlimit(RLIMIT_CPU, &cpu);
    setitimer(ITIMER_PROF, &timer, NULL);
    if (chdir(home->folder) != 0)
        _exit(127);
    const int null = open("/dev/null", O_RDONLY), out = open("out", O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(null, 0);
    dup2(out, 1);
    dup2(out, 2);
    setenv("HOME", ".", 1);
    execlp(program ? program : "ngspice", "ngspice", "-b", "case.cir", (char *)NULL);
    _exit(127);
}

/* --- what it says --- */

typedef struct raw {
    FILE *file;
    int columns;
    long points;
    int plus[PLAN_PROBES], minus[PLAN_PROBES]; /* columns; -1: ground */
} raw;

static int is_probe(const plan *p, int i, int k, const char *name) {
    char wanted[64];
    const plan_probe *q = &p->probe[i];
    if (q->part >= 0)
        snprintf(wanted, sizeof wanted, "i(%s)", p->part[q->part].name);
    else
        snprintf(wanted, sizeof wanted, "v(%s)", p->node[q->node[k]]);
    return (k == 0 || q->part < 0) && strcasecmp(wanted, name) == 0;
}

static int read_head(const plan *p, raw *w) {
    char line[512], name[64];
    int at;
    for (int i = 0; i < p->probes; i++)
        w->plus[i] = w->minus[i] = -1;
    while (fgets(line, sizeof line, w->file) && strncmp(line, "Binary:", 7) != 0) {
        (void)sscanf(line, "No. Variables: %d", &w->columns);
        (void)sscanf(line, "No. Points: %ld", &w->points);
        if (sscanf(line, " %d %63s", &at, name) == 2)
            for (int i = 0; i < p->probes; i++) {
                w->plus[i] = is_probe(p, i, 0, name) ? at : w->plus[i];
                w->minus[i] = is_probe(p, i, 1, name) ? at : w->minus[i];
            }
    }
    for (int i = 0; i < p->probes; i++)
        if ((p->probe[i].part >= 0 || p->probe[i].node[0]) && w->plus[i] < 0)
            return 0;
    return w->columns > 0 && w->columns < 4 * COLUMNS && w->points > 1;
}

static double on_line(const double *last, const double *row, int column, double t) {
    const double part = row[0] > last[0] ? (t - last[0]) / (row[0] - last[0]) : 1;
    return column < 0 ? 0 : last[column] + part * (row[column] - last[column]);
}

/* The largest size of both columns over the two rows, added. */
static double size_of_nodes(const raw *w, int i, const double *last, const double *row) {
    const int column[2] = {w->plus[i], w->minus[i]};
    double sum = 0;
    for (int k = 0; k < 2; k++)
        sum += column[k] < 0 ? 0 : fmax(fabs(last[column[k]]), fabs(row[column[k]]));
    return sum;
}

static void note_shown(const plan *p, const raw *w, const double *last, const double *row, run_result *r) {
    for (int i = 0; i < p->probes; i++) {
        run_shown *s = &r->shown[i];
        const double a = on_line(last, row, w->plus[i], last[0]) - on_line(last, row, w->minus[i], last[0]),
                     b = on_line(last, row, w->plus[i], row[0]) - on_line(last, row, w->minus[i], row[0]);
        if (r->counts.steps == 0)
            *s = (run_shown){0, 0, a, a, a, a, 0, 0};
        s->integral += 0.5 * (a + b) * (row[0] - last[0]);
        s->of_abs += 0.5 * (fabs(a) + fabs(b)) * (row[0] - last[0]);
        s->jumped += row[0] - last[0] < 1e-12 * row[0] ? b - a : 0;
        s->low = fmin(s->low, b);
        s->high = fmax(s->high, b);
        s->nodes = fmax(s->nodes, p->probe[i].part < 0 ? size_of_nodes(w, i, last, row) : 0);
        s->last = b;
    }
    r->counts.steps++;
}

static int read_points(const plan *p, const raw *w, run_result *r) {
    double rows[2][4 * COLUMNS] = {{0}};
    int at = 0;
    for (long k = 0; k < w->points; k++) {
        double *row = rows[k % 2];
        const double *last = rows[(k + 1) % 2];
        if (fread(row, sizeof *row, (size_t)w->columns, w->file) != (size_t)w->columns)
            break;
        for (; k > 0 && at < RUN_TIMES * RUN_BAND && run_band_time(p, at) <= row[0]; at++)
            for (int i = 0; i < p->probes; i++)
                r->value[at * p->probes + i] = on_line(last, row, w->plus[i], run_band_time(p, at)) -
                                               on_line(last, row, w->minus[i], run_band_time(p, at));
        if (k > 0)
            note_shown(p, w, last, row, r);
        r->t = row[0];
    }
    return at == RUN_TIMES * RUN_BAND;
}

static int read_raw(const plan *p, const spice_home *home, run_result *r) {
    raw w = {.file = open_in(home, "out.raw", "rb")};
    if (!w.file)
        return 0;
    const int got = read_head(p, &w) && read_points(p, &w, r);
    fclose(w.file);
    return got;
}

/* Our line, or ngspice's error. */
static void read_said(const spice_home *home, run_result *r) {
    char line[512];
    FILE *file = open_in(home, "out", "r");
    while (file && fgets(line, sizeof line, file))
        if ((strncmp(line, "nonsmooth:", 10) == 0 && !strstr(line, "simulates")) || strstr(line, "Error")) {
            line[strcspn(line, "\n")] = 0;
            snprintf(r->line, RUN_LINE, "%.*s", RUN_LINE - 1, line);
            if (line[0] == 'n')
                break;
        }
    if (file)
        fclose(file);
}

/* A process to its end; its CPU time is used. */
static int go(const spice_home *home, double limit, struct rusage *used) {
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0)
        become_ngspice(home, limit);
    if (child < 0 || wait4(child, &status, 0, used) < 0)
        abort();
    return status;
}

static double seconds_of(const struct rusage *used) {
    return (double)used->ru_utime.tv_sec + 1e-6 * (double)used->ru_utime.tv_usec;
}

double spice_start(const netlist *n, const plan *p, const spice_home *home, double limit) {
    struct rusage used;
    if (write_inputs(n, p, home, 0))
        return 0;
    (void)go(home, limit, &used);
    return seconds_of(&used);
}

void spice_run(const netlist *n, const plan *p, const spice_home *home, double limit, run_result *r) {
    struct rusage used;
    memset(r, 0, sizeof *r);
    r->end = RUN_CRASHED;
    if (write_inputs(n, p, home, 1))
        return;
    const int status = go(home, limit, &used);
    r->seconds = seconds_of(&used);
    const int killed = WIFSIGNALED(status) && (WTERMSIG(status) == SIGPROF || WTERMSIG(status) == SIGXCPU ||
                                               WTERMSIG(status) == SIGKILL);
    if (killed)
        snprintf(r->line, RUN_LINE, "still running after %g s", limit);
    else if (WIFSIGNALED(status))
        snprintf(r->line, RUN_LINE, "ended by signal %d", WTERMSIG(status));
    else
        read_said(home, r);
    r->status = NS_E_STATE;
    r->end = killed                 ? RUN_SLOW
             : WIFSIGNALED(status)  ? RUN_CRASHED
             : read_raw(p, home, r) ? RUN_DONE
                                    : RUN_REFUSED;
}
