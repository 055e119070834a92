/* bridge/dump.c - a step that failed, in a file that nsc-mlcp reads: a user's report.
 *
 * The problem is unreduced: the unknowns' equations, then the pairs, then, for an operating point under .ic,
 * the nodes held.  Comments say what each index stands for; rows of unknowns come as ns_system_split() sorts
 * and sums them. */
#include "dump.h"

#include <errno.h>
#include <string.h>

#include "nonsmooth/text.h"

#ifndef NONSMOOTH_VERSION
#define NONSMOOTH_VERSION of unknown version
#endif
#define QUOTE(text) #text
#define QUOTE_VALUE(macro) QUOTE(macro)

static void write_head(FILE *file, const ns_analysis *a, const ns_mlcp *p, double h) {
    char line[320];
    ns_circuit_explain(a->ex.circuit, ns_march_fault(a->march), line, sizeof line);
    fprintf(file,
            "# nonsmooth " QUOTE_VALUE(NONSMOOTH_VERSION) ": a problem that failed, for nsc-mlcp\n# %s\n",
            line);
    if (h > 0.0)
        fprintf(file, "# a step of %.17g s\n", h);
    else
        fputs("# an operating point\n", file);
    fprintf(file, "# lambda: %d unknowns, %d pairs, currents that hold %d nodes\n", a->system->n,
            a->system->m, p->m - a->system->n - a->system->m);
    fputs("# row of an unknown: KCL of its node or the law of its branch; else the unknowns whose rows it "
          "sums\n",
          file);
}

/* Whose rows of the system row k is made of, if not of unknown k's alone. */
static void write_rows(FILE *file, const ns_analysis *a, const double *T, int k) {
    const int n = a->system->n;
    const char *before = "; row of ";
    char name[160];
    int others = 0;
    for (int i = 0; i < n; i++)
        others += i != k && T[k + i * n] != 0.0;
    for (int i = 0; i < n && others > 0; i++) {
        if (T[k + i * n] != 0.0) {
            ns_circuit_name_unknown(a->ex.circuit, i, name, sizeof name);
            fprintf(file, "%s%s", before, name);
            before = " + ";
        }
    }
}

/* One line for each index, from 1 as in the messages of nsc-mlcp. */
static void write_names(FILE *file, const ns_analysis *a, const ns_mlcp *p, const double *T) {
    const int n = a->system->n;
    const int m = a->system->m;
    char name[160];
    for (int i = 0; i < p->m; i++) {
        const char *what = i < n + m ? "" : "current that holds the ";
        if (i >= n && i < n + m)
            ns_circuit_name_pair(a->ex.circuit, i - n, name, sizeof name);
        else
            ns_circuit_name_unknown(a->ex.circuit, i < n ? i : a->held.unknown[i - n - m], name, sizeof name);
        fprintf(file, "# %d: %s%s", i + 1, what, name);
        if (i < n)
            write_rows(file, a, T, i);
        fputc('\n', file);
    }
}

/* The problem as text, or NULL; the caller frees it. */
static char *text_of(const ns_mlcp *p, size_t *length) {
    char *text = NULL;
    if (!ns_mlcp_write(p, NULL, 0, length))
        text = malloc(*length + 1);
    if (text && ns_mlcp_write(p, text, *length + 1, length)) {
        free(text);
        text = NULL;
    }
    return text;
}

/* T of the rows, or NULL; the caller frees it. */
static double *rows_split(const ns_analysis *a) {
    const size_t n = (size_t)a->system->n;
    double *T = calloc(n * n + 1, sizeof *T);
    int rank = 0;
    if (T && ns_system_split(a->system, T, &rank)) {
        free(T);
        T = NULL;
    }
    return T;
}

/* 0, or the errno of what went wrong. */
static int write_file(const char *name, const ns_analysis *a, const ns_mlcp *p, double h) {
    size_t length = 0;
    char *text = text_of(p, &length);
    double *T = rows_split(a);
    FILE *file = NULL;
    int error = text && T ? 0 : ENOMEM;
    if (!error) {
        errno = 0;
        file = fopen(name, "w");
        error = file ? 0 : errno;
    }
    if (file) {
        write_head(file, a, p, h);
        write_names(file, a, p, T);
        fwrite(text, 1, length, file);
        const int bad = ferror(file) != 0; /* no space left, say */
        error = fclose(file) != 0 || bad ? (errno ? errno : EIO) : 0;
    }
    free(text);
    free(T);
    return error;
}

void ns_bridge_dump_failed_step(const ns_analysis *a, char *more, size_t size) {
    const MIFinstance *inst = a->ex.options_inst;
    const char *name = inst ? ns_bridge_models_text(inst, OPTION_DUMP) : NULL; /* as it is now */
    double h = 0.0;
    ns_mlcp p;
    *more = '\0';
    if (!name || !*name)
        return;
    if (!a->march || ns_march_problem(a->march, &p, &h)) {
        snprintf(more, size, "; option dump writes no file: no problem (P1) failed");
        return;
    }
    const int error = write_file(name, a, &p, h);
    if (error)
        snprintf(more, size, "; cannot write the problem to %.200s: %s", name, strerror(error));
    else
        snprintf(more, size, "; the problem that failed is in %.200s", name);
}
