/* tests/fuzz/fuzz_text.c - any bytes as the text of a problem: read, written, read again, solved.
 *
 * An answer must satisfy the problem, a certificate must prove, and reading what was written must give the
 * very problem that was read.  The method beside "auto" is chosen by the length of the text.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "nonsmooth/text.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { PAIRS_MAX = 12 };
static const double residual_bound = 1e-10; /* what the library promises of every answer */

static void demand(int holds, const char *what, double value) {
    if (!holds) {
        fprintf(stderr, "fuzz_text: %s (%.17g)\n", what, value);
        abort();
    }
}

static int same_numbers(size_t n, const double *a, const double *b) {
    return n == 0 || memcmp(a, b, n * sizeof *a) == 0;
}

static void check_round_trip(const ns_mlcp *p) {
    const size_t m = (size_t)p->m;
    size_t length = 0, again = 0;
    ns_mlcp *copy = NULL;
    demand(ns_mlcp_write(p, NULL, 0, &length) == NS_OK, "a problem that was read is not written", p->m);
    char *text = malloc(length + 1);
    demand(text != NULL, "no memory", 0);
    demand(ns_mlcp_write(p, text, length + 1, &again) == NS_OK && again == length, "lengths differ", 0);
    demand(ns_mlcp_read(text, length, &copy, NULL) == NS_OK, "what was written is not read", p->m);
    demand(copy->m == p->m && same_numbers(m * m, p->W, copy->W) && same_numbers(m, p->q, copy->q) &&
               same_numbers(m, p->l, copy->l) && same_numbers(m, p->u, copy->u),
           "what was read differs from what was written", p->m);
    ns_mlcp_discard(copy);
    free(text);
}

static void check_refusal(int status, const ns_text_fault *fault) {
    const size_t n = strlen(fault->cause);
    demand(n > 0 && n < sizeof fault->cause, "a refusal without a cause", status);
    demand(fault->line > 0 || status == NS_E_MEMORY, "a refusal without a line", status);
    for (size_t i = 0; i < n; i++)
        demand(fault->cause[i] >= ' ' && fault->cause[i] <= '~', "a cause that is not printable",
               fault->cause[i]);
}

static void check_answer(const ns_mlcp *p, const double *lambda, const double *y) {
    for (int i = 0; i < p->m; i++) {
        demand(isfinite(lambda[i]) && isfinite(y[i]), "an answer that is not finite", i);
        demand(p->l[i] <= lambda[i] && lambda[i] <= p->u[i], "lambda outside its bounds", lambda[i]);
    }
    const double residual = ns_mlcp_residual(p, lambda, NULL);
    demand(residual <= residual_bound, "residual of an answer", residual);
}

static void solve(const ns_mlcp *p, ns_mlcp_method method) {
    double lambda[PAIRS_MAX], y[PAIRS_MAX];
    ns_mode mode[PAIRS_MAX];
    ns_mlcp_solver *s = NULL;
    ns_mlcp_info info;
    memset(mode, NS_LOWER, sizeof mode);
    demand(ns_mlcp_create(p->m, &s) == NS_OK && ns_mlcp_use(s, method) == NS_OK, "no solver", method);
    const int status = ns_mlcp_solve(s, p, mode, lambda, y, &info);
    if (status == NS_OK) {
        check_answer(p, lambda, y);
    } else if (status == NS_E_INFEASIBLE && info.certified) {
        const double *v = ns_mlcp_certificate(s);
        demand(v && ns_mlcp_certify(p, v) > 0, "a certificate that proves nothing", method);
    }
    ns_mlcp_free(s);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    ns_mlcp *p = NULL;
    ns_text_fault fault;
    const int status = ns_mlcp_read((const char *)data, size, &p, &fault);
    if (status != NS_OK) {
        demand(p == NULL, "a problem in spite of a refusal", status);
        check_refusal(status, &fault);
        return 0;
    }
    check_round_trip(p);
    if (p->m <= PAIRS_MAX) {
        solve(p, NS_MLCP_AUTO);
        solve(p, (ns_mlcp_method)(size % NS_MLCP_METHODS));
    }
    ns_mlcp_discard(p);
    return 0;
}
