/* src/modes/shared_branch.c - pairs across a switch: found in the matrices. */
#include "shared_branch.h"

#include <math.h>
#include <stdlib.h>

/* +1 or -1 if column (or row) a is that times b, else 0; both count numbers, `step` apart. */
static int parallel(int count, int step, const double *a, const double *b) {
    int sign = 0;
    for (int i = 0; i < count; i++) {
        const double x = a[(size_t)i * (size_t)step], y = b[(size_t)i * (size_t)step];
        if (x == 0 && y == 0)
            continue;
        const int here = x == y ? 1 : x == -y ? -1 : 0;
        if (here == 0 || (sign != 0 && here != sign))
            return 0;
        sign = here;
    }
    return sign;
}

/* Nothing but its own branch: row and column j of D, but for D_jj, row j of F, and e_j are zero. */
static int is_alone(const ns_system *s, int j) {
    const int m = s->m;
    int alone = s->e[j] == 0;
    for (int k = 0; k < m && alone; k++)
        alone = k == j || (s->D[j + k * m] == 0 && s->D[k + j * m] == 0);
    for (int k = 0; k < s->nz && alone; k++)
        alone = s->F[j + k * m] == 0;
    return alone;
}

static int are_twins(const ns_system *s, int j, int of) {
    const int n = s->n, m = s->m;
    return n > 0 && parallel(n, 1, s->B + (size_t)j * (size_t)n, s->B + (size_t)of * (size_t)n) &&
           parallel(n, m, s->C + j, s->C + of) && is_alone(s, j);
}

static int is_commanded(const ns_system *s, int j) {
    for (int c = 0; c < s->nc; c++)
        if (s->command[c].pair == j)
            return 1;
    return 0;
}

int ns_modes_shared_find(const ns_system *s, ns_shared_branch **out, int *count) {
    *count = 0;
    *out = NULL;
    if (s->m == 0 || s->nc == 0)
        return NS_OK;
    ns_shared_branch *list = calloc((size_t)s->m, sizeof *list);
    if (!list)
        return NS_E_MEMORY;
    for (int j = 0; j < s->m; j++)
        for (int c = 0; c < s->nc && !is_commanded(s, j) && (s->l[j] == 0 || s->u[j] == 0); c++) {
            const int of = s->command[c].pair;
            if (s->D[of + of * s->m] != 0 || !is_alone(s, of) || !are_twins(s, j, of))
                continue;
            list[(*count)++] = (ns_shared_branch){j, of, s->l[j] == 0 ? NS_LOWER : NS_UPPER};
            break;
        }
    *out = list;
    return NS_OK;
}
