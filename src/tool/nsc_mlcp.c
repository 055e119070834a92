/* src/tool/nsc_mlcp.c - the program nsc-mlcp: solves one problem (P1) that stands in a file. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "nonsmooth/mlcp.h"
#include "nonsmooth/text.h"

enum { SOLVED = 0, NO_SOLUTION = 1, GAVE_UP = 2, BAD_INPUT = 3 };

static const size_t FILE_MAX = (size_t)1 << 30; /* bytes: an endless stream must end */

static const char *const usage =
    "usage: nsc-mlcp [--solver NAME] [--] FILE\n"
    "\n"
    "Solves a mixed linear complementarity problem: finds lambda with l <= lambda <= u and, for y = W lambda "
    "+ q,\n"
    "    y(i) >= 0 where lambda(i) = l(i),  y(i) = 0 between,  y(i) <= 0 where lambda(i) = u(i).\n"
    "\n"
    "FILE (-: standard input) holds the number m, then W row by row (m*m numbers), then q, l and u (m "
    "each),\n"
    "separated by white space.  l may have -inf, u inf; # starts a comment, to the end of its line.\n"
    "\n"
    "--solver NAME   one of:";
static const char *const usage_end =
    "\n\n"
    "Prints lines of one word and its values, numbers with all their digits:\n"
    "    status       solved, no-solution or gave-up\n"
    "    residual     scaled natural residual of lambda, computed from the problem alone (solved)\n"
    "    lambda, y    m numbers each (solved)\n"
    "    solver       the method that found the answer or the proof\n"
    "    certified    yes: a certificate follows; no: every mode was tried (no-solution)\n"
    "    margin       how far from a solution the certificate is, in (0,1] (certified)\n"
    "    certificate  m numbers v: no y, lambda in their bounds have v'(y - q) = (W'v)'lambda (certified)\n"
    "    why          in words (gave-up)\n"
    "Exit status: 0 solved, 1 no solution exists, 2 gave up, 3 bad input.\n";

static int bad(const char *format, ...) {
    va_list values;
    va_start(values, format);
    fputs("nsc-mlcp: ", stderr);
    vfprintf(stderr, format, values);
    fputc('\n', stderr);
    va_end(values);
    return BAD_INPUT;
}

static int help(FILE *to) {
    fputs(usage, to);
    for (int k = 0; k < NS_MLCP_METHODS; k++)
        fprintf(to, " %s", ns_mlcp_method_name(k));
    fputs(usage_end, to);
    return SOLVED;
}

/* --- reading --- */

/* The rest of stream; *text is the caller's to free, after an error too.  NULL, or what went wrong. */
static const char *read_stream(FILE *stream, char **text, size_t *length) {
    size_t room = 0;
    for (;;) {
        if (*length == room) {
            room = room ? 2 * room : (size_t)1 << 16;
            char *more = room <= FILE_MAX ? realloc(*text, room) : NULL;
            if (!more)
                return room <= FILE_MAX ? "out of memory" : "too long";
            *text = more;
        }
        errno = 0;
        const size_t got = fread(*text + *length, 1, room - *length, stream);
        *length += got;
        if (ferror(stream))
            return strerror(errno);
        if (got == 0)
            return NULL;
    }
}

static int load(const char *file, ns_mlcp **p) {
    const int standard = strcmp(file, "-") == 0;
    const char *name = standard ? "standard input" : file;
    ns_text_fault fault;
    char *text = NULL;
    size_t length = 0;
    FILE *stream = standard ? stdin : fopen(file, "rb");
    *p = NULL;
    if (!stream)
        return bad("%s: %s", name, strerror(errno));
    const char *wrong = read_stream(stream, &text, &length);
    if (!standard)
        fclose(stream);
    int status = NS_OK;
    if (wrong)
        bad("%s: %s", name, wrong);
    else if ((status = ns_mlcp_read(text, length, p, &fault)) != NS_OK && fault.line > 0)
        bad("%s:%ld: %s", name, fault.line, fault.cause);
    else if (status != NS_OK)
        bad("%s: %s", name, fault.cause);
    free(text);
    return wrong || status != NS_OK ? BAD_INPUT : SOLVED;
}

/* --- answering --- */

static void print_numbers(const char *word, int n, const double *v) {
    fputs(word, stdout);
    for (int i = 0; i < n; i++)
        printf(" %.17g", v[i]);
    putchar('\n');
}

static int print_solved(const ns_mlcp *p, const double *lambda, const double *y, int method) {
    printf("status solved\nresidual %.17g\n", ns_mlcp_residual(p, lambda, NULL));
    print_numbers("lambda", p->m, lambda);
    print_numbers("y", p->m, y);
    printf("solver %s\n", ns_mlcp_method_name(method));
    return SOLVED;
}

static int print_no_solution(const ns_mlcp *p, const double *certificate, int method) {
    printf("status no-solution\nsolver %s\n", ns_mlcp_method_name(method));
    if (certificate) {
        printf("certified yes\nmargin %.17g\n", ns_mlcp_certify(p, certificate));
        print_numbers("certificate", p->m, certificate);
    } else {
        puts("certified no");
    }
    return NO_SOLUTION;
}

static const char *why(int status) {
    static const char already[] = "gave up: "; /* what `status gave-up` says */
    const char *text = ns_status_text(status);
    return strncmp(text, already, strlen(already)) == 0 ? text + strlen(already) : text;
}

static int print_gave_up(int status, int method) {
    printf("status gave-up\nsolver %s\nwhy %s\n", ns_mlcp_method_name(method), why(status));
    return GAVE_UP;
}

static int solve(const ns_mlcp *p, ns_mlcp_method method) {
    const size_t m = (size_t)p->m;
    ns_mlcp_solver *s = NULL;
    ns_mlcp_info info = {.method = (int)method};
    double *lambda = calloc(m + 1, sizeof *lambda), *y = calloc(m + 1, sizeof *y);
    ns_mode *mode = calloc(m + 1, sizeof *mode);
    int status = lambda && y && mode ? ns_mlcp_create(p->m, &s) : NS_E_MEMORY;
    for (size_t i = 0; mode && i < m; i++)
        mode[i] = NS_LOWER;
    status = status ? status : ns_mlcp_use(s, method);
    status = status ? status : ns_mlcp_solve(s, p, mode, lambda, y, &info);
    int answer;
    if (status == NS_OK)
        answer = print_solved(p, lambda, y, info.method);
    else if (status == NS_E_INFEASIBLE)
        answer = print_no_solution(p, info.certified ? ns_mlcp_certificate(s) : NULL, info.method);
    else
        answer = print_gave_up(status, info.method);
    ns_mlcp_free(s);
    free(lambda);
    free(y);
    free(mode);
    return answer;
}

/* --- the command line --- */

typedef struct arguments {
    const char *file;
    const char *solver;
    int help;
} arguments;

/* SOLVED, or BAD_INPUT after one line. */
static int read_arguments(int argc, char **argv, arguments *a) {
    static const char solver_is[] = "--solver=";
    int names_only = 0;
    for (int k = 1; k < argc; k++) {
        const char *word = argv[k];
        if (names_only || word[0] != '-' || word[1] == '\0') {
            if (a->file)
                return bad("one FILE, please: '%s' is the second", word);
            a->file = word;
        } else if (strcmp(word, "--") == 0) {
            names_only = 1;
        } else if (strcmp(word, "--help") == 0) {
            a->help = 1;
        } else if (strncmp(word, solver_is, strlen(solver_is)) == 0) {
            a->solver = word + strlen(solver_is);
        } else if (strcmp(word, "--solver") == 0) {
            if (++k == argc)
                return bad("--solver needs the name of one");
            a->solver = argv[k];
        } else {
            return bad("unknown option '%s'; --help tells", word);
        }
    }
    return SOLVED;
}

int main(int argc, char **argv) {
    arguments a = {NULL, "auto", 0};
    ns_mlcp *p = NULL;
    if (read_arguments(argc, argv, &a) != SOLVED)
        return BAD_INPUT;
    int answer = SOLVED;
    if (a.help) {
        help(stdout);
    } else if (!a.file) {
        return bad("no FILE; --help tells");
    } else {
        const int method = ns_mlcp_method_of(a.solver);
        if (method < 0)
            return bad("no solver is named '%s'; --help tells", a.solver);
        if (load(a.file, &p) != SOLVED || !p)
            return BAD_INPUT;
        answer = solve(p, (ns_mlcp_method)method);
        ns_mlcp_discard(p);
    }
    if (fflush(stdout) != 0 || ferror(stdout))
        return bad("standard output: %s", strerror(errno));
    return answer;
}
