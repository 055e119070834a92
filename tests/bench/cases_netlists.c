/* tests/bench/cases_netlists.c - netlists/X.cir through ngspice, with ngspice's models or with ours, at some
 * instants.
 *
 * The file's own elements are taken, its A lines written anew for the models asked for, its options and
 * commands left out.  Runs are longer than the file's, some hundred periods, so that not only the start of
 * ngspice is compared.  Reference: our exact engine; its own error: how far off the scheme
 * is at theta = gamma = 1/2 and two lengths of step, extrapolated. */
#include "timing.h"

#include <string.h>

#include "cases.h"
#include "rival.h"

enum { LINE = 256, MODELS = 8 };

typedef struct entry {
    const char *name, *file, *title;
    double end, unit; /* s; unit: a period */
    const char *vector[CASE_UNKNOWNS];
    double scheme; /* units a step of the scheme has in the reference's error */
    int from_dc;   /* starts at the operating point */
} entry;

static const entry entries[] = {
    {"n_bridge_ls", "bridge_ls", "bridge behind an inductance (overlap)", 1, 20e-3, {"i(l1)"}, 1 / 512.0, 1},
    {"n_buck_boost", "buck_boost", "buck-boost converter", 10e-3, 10e-6, {"i(l1)", "v(out)"}, 1 / 128.0, 0},
    {"n_buck_ccm", "buck_ccm", "buck converter, CCM", 10e-3, 10e-6, {"i(l1)", "v(out)"}, 1 / 128.0, 1},
    /* compared at eight different parts of its period: where the switch closes the current is zero */
    {"n_buck_dcm", "buck_dcm", "buck converter, DCM", 9.992e-3, 10e-6, {"i(l1)", "v(out)"}, 1 / 128.0, 0},
    {"n_doubler", "doubler", "voltage doubler", 1, 20e-3, {"v(x)", "v(out)"}, 1 / 512.0, 1},
    {"n_flyback", "flyback_leak", "flyback with leakage", 10e-3, 10e-6, {"i(l2)", "v(out)"}, 1 / 128.0, 0},
    {"n_halfwave_rc", "halfwave_rc", "half-wave rectifier, RC", 1, 20e-3, {"v(out)"}, 1 / 512.0, 1},
    {"n_halfwave_rl", "halfwave_rl", "freewheeling rectifier, RL", 1, 20e-3, {"i(l1)"}, 1 / 512.0, 1},
    {"n_resonant",
     "resonant",
     "resonant converter",
     10e-3,
     18.18181818e-6,
     {"i(l1)", "i(l2)", "v(out)"},
     1 / 128.0,
     0},
    {"n_rlcd", "rlcd", "LC tank and a diode", 2.5e-3, 0.628e-3, {"v(1)", "i(l1)"}, 1 / 1024.0, 0},
    {"n_six_pulse",
     "six_pulse",
     "six-pulse bridge, constant load",
     1,
     20e-3,
     {"i(la)", "i(lb)"},
     1 / 512.0,
     1}};

/* --- the file --- */

typedef struct device_models { /* the .model lines of a file */
    int count;
    char name[MODELS][24];
    int diode[MODELS];
} device_models;

static FILE *open_netlist(const bench_case *c) {
    char path[256];
    snprintf(path, sizeof path, "netlists/%s.cir", c->file);
    FILE *f = fopen(path, "r");
    if (!f) {
        perror(path);
        exit(1);
    }
    return f;
}

static void read_models(const bench_case *c, device_models *m) {
    char line[LINE], kind[32];
    FILE *f = open_netlist(c);
    m->count = 0;
    while (fgets(line, sizeof line, f) && m->count < MODELS)
        if (sscanf(line, ".model %23s %31[a-z_]", m->name[m->count], kind) == 2 &&
            strncmp(kind, "ideal", 5) == 0)
            m->diode[m->count++] = strcmp(kind, "ideal_diode") == 0;
    fclose(f);
}

static int find_model(const device_models *m, const char *name) {
    for (int i = 0; i < m->count; i++)
        if (strcmp(m->name[i], name) == 0)
            return i;
    must(NS_E_RANGE);
    return 0;
}

/* An A line with ngspice's own models. */
static void write_device(const device_models *all, const deck_models *m, const char *line, FILE *file) {
    char name[24], word[5][24];
    const int words =
        sscanf(line, "%23s %23s %23s %23s %23s %23s", name, word[0], word[1], word[2], word[3], word[4]);
    if (words == 6 && !all->diode[find_model(all, word[4])])
        fprintf(file, "s%s %s %s %s %s %s\n", name, word[0], word[1], word[2], word[3], word[4]);
    else if (m->diode == DECK_D)
        fprintf(file, "d%s %s %s %s\n", name, word[0], word[1], word[2]);
    else
        fprintf(file, "%s %%gd(%s %s) %s\n", name, word[0], word[1], word[2]);
}

static void write_model(const device_models *all, const deck_models *m, const char *line, FILE *file) {
    char name[24];
    if (sscanf(line, ".model %23s", name) != 1 || strcmp(name, "nsopt") == 0)
        return;
    if (!all->diode[find_model(all, name)])
        fprintf(file, ".model %s sw(vt=0.5 vh=%g ron=%.17g roff=%.17g)\n", name, m->vh, m->ron, m->roff);
    else if (m->diode == DECK_D)
        fprintf(file, ".model %s d(is=1e-14 n=%g)\n", name, m->n);
    else
        fprintf(file, ".model %s sidiode(ron=%g roff=%g vfwd=0 epsilon=0)\n", name, m->ron, m->roff);
}

void case_netlist_lines(const bench_case *c, const deck_models *m, FILE *file) {
    device_models all;
    char line[LINE];
    read_models(c, &all);
    FILE *f = open_netlist(c);
    while (fgets(line, sizeof line, f) && strncmp(line, ".control", 8) != 0) {
        const int ours = strncmp(line, "AOPT", 4) == 0 || strncmp(line, ".model nsopt", 12) == 0;
        if (line[0] == '*' || ours || strncmp(line, ".tran", 5) == 0)
            continue;
        if (m->diode == DECK_IDEAL || (line[0] != 'A' && strncmp(line, ".model", 6) != 0))
            fputs(line, file);
        else if (line[0] == 'A')
            write_device(&all, m, line, file);
        else
            write_model(&all, m, line, file);
    }
    fclose(f);
}

/* --- the reference --- */

static int by_ours(const bench_case *c, const char *method, double step, double *values) {
    char options[96];
    rival_result got;
    rival_setting s = {
        .name = "", .models = {.diode = DECK_IDEAL}, .reltol = 1e-9, .step = 0.25, .options = options};
    snprintf(options, sizeof options,
             step > 0 ? "method=\"%s\" theta=0.5 gamma=0.5 h=%.17g" : "method=\"%s\"", method,
             step * c->unit);
    rival_run(c, &s, 1, 60, &got);
    memcpy(values, got.values, sizeof got.values);
    return got.end == RIVAL_DONE;
}

/* The scheme of second order at two steps, extrapolated. */
static void by_scheme(const bench_case *c, real *values) {
    const double step = entries[c->extra].scheme;
    double fine[CASE_VALUES] = {0}, finer[CASE_VALUES] = {0};
    if (!by_ours(c, "theta", step, fine) || !by_ours(c, "theta", step / 2, finer))
        fprintf(stderr, "%s: no reference\n", c->name);
    for (int i = 0; i < c->times * c->unknowns; i++)
        values[i] = ((real)finer[i] * 4 - (real)fine[i]) / 3;
}

/* fineness 1: by the scheme; less: by exact, sparse where that fails.  (Which of both is closer to the
 * scheme tells nothing: extrapolated it is good to 1e-10 or worse, sparse to its reltol, 1e-9.) */
static void exact(const bench_case *c, real fineness, real *values) {
    double got[CASE_VALUES] = {0};
    if (fineness >= 1) {
        by_scheme(c, values);
        return;
    }
    if (!by_ours(c, "exact", 0, got))
        (void)by_ours(c, "sparse", 0, got);
    for (int i = 0; i < c->times * c->unknowns; i++)
        values[i] = (real)got[i];
}

int case_netlist(bench_case *c, int at) {
    if (at < 0 || at >= (int)(sizeof entries / sizeof *entries))
        return 0;
    const entry *e = &entries[at];
    c->name = e->name;
    c->title = e->title;
    c->origin = "ours, exact between events, against the scheme extrapolated";
    c->file = e->file;
    c->extra = at;
    c->unit = e->unit;
    c->exact = exact;
    c->through = 1;
    c->from_dc = e->from_dc;
    case_times(c, e->end, 8);
    for (int k = 0; k < 7; k++)
        c->time[k] -= 0.2 * e->unit;
    for (int i = 0; i < CASE_UNKNOWNS && e->vector[i]; i++)
        snprintf(c->unknown[c->unknowns++].vector, sizeof c->unknown->vector, "%s", e->vector[i]);
    return 1;
}
