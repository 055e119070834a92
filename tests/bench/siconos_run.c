/* tests/bench/siconos_run.c - Siconos in a process of its own, under a limit. */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "siconos_run.h"

int siconos_has(const bench_case *c, const char *program) {
    return (c->system || strcmp(c->name, "lc_bridge") == 0) && access(program, X_OK) == 0;
}

static void become(const bench_case *c, const siconos_setting *s, const char *program, double limit,
                   int out) {
    const struct rlimit cpu = {(rlim_t)ceil(limit), (rlim_t)ceil(limit) + 1};
    char solver[16], theta[32], h[32];
    setrlimit(RLIMIT_CPU, &cpu);
    dup2(out, 1);
    snprintf(solver, sizeof solver, "%d", s->solver);
    snprintf(theta, sizeof theta, "%.17g", s->theta);
    snprintf(h, sizeof h, "%.17g", s->h);
    execl(program, "siconos", c->name, solver, theta, h, (char *)NULL);
    _exit(127);
}

static void read_line(const bench_case *c, FILE *f, siconos_result *r) {
    char line[4096];
    while (fgets(line, sizeof line, f)) {
        int at = 0, more;
        if (sscanf(line, "done %lf %lf %ld%n", &r->create, &r->run, &r->steps, &at) != 3)
            continue;
        int k = 0;
        while (k < c->times * c->unknowns && sscanf(line + at, "%lf%n", &r->values[k], &more) == 1) {
            at += more;
            k++;
        }
        r->done = k == c->times * c->unknowns;
    }
}

void siconos_run(const bench_case *c, const siconos_setting *s, const char *program, double limit,
                 siconos_result *r) {
    int ends[2], status = 0;
    memset(r, 0, sizeof *r);
    fflush(NULL);
    if (pipe(ends) != 0)
        must(NS_E_MEMORY);
    const pid_t child = fork();
    if (child == 0)
        become(c, s, program, limit, ends[1]);
    close(ends[1]);
    FILE *f = fdopen(ends[0], "r");
    if (child < 0 || !f) {
        perror(program);
        exit(1);
    }
    read_line(c, f, r);
    fclose(f);
    (void)waitpid(child, &status, 0);
    r->done = r->done && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    r->timeout = WIFSIGNALED(status);
}
