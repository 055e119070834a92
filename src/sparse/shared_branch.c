/* src/sparse/shared_branch.c - pairs across a switch (shared_branch.h), found in sparse matrices. */
#include "sparse_internal.h"

#include <stdlib.h>

/* The sign by which entries a and b agree, 0: they do not. */
static int sign_of(double a, double b) {
    return a == b ? 1 : a == -b ? -1 : 0;
}

/* +1 or -1 if the entries of column i of a, in rows below `rows`, are those of column j times that, else 0.
 */
static int parallel(const ns_csc *a, const double *value, int rows, int i, int j) {
    int sign = 0, k = a->start[i], l = a->start[j];
    for (;; k++, l++) {
        while (k < a->start[i + 1] && (a->row[k] >= rows || value[k] == 0))
            k++;
        while (l < a->start[j + 1] && (a->row[l] >= rows || value[l] == 0))
            l++;
        if (k == a->start[i + 1] || l == a->start[j + 1])
            return k == a->start[i + 1] && l == a->start[j + 1] ? sign : 0;
        const int here = a->row[k] == a->row[l] ? sign_of(value[k], value[l]) : 0;
        if (here == 0 || (sign != 0 && here != sign))
            return 0;
        sign = here;
    }
}

/* Its voltage depends on x alone, and, but with itself, no lambda of others on its own (D, F, e); itself:
 * D_jj may be there. */
static int is_alone(const ns_form *f, int j, int itself) {
    for (int k = f->Ct.start[j]; k < f->Ct.start[j + 1]; k++)
        if (f->Ct.row[k] >= f->n && f->Ct.value[k] != 0 && !(itself && f->Ct.row[k] == f->n + j))
            return 0;
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++)
        if (f->K.row[k] >= f->n && f->K.row[k] != f->n + j && f->KA[k] != 0)
            return 0;
    for (int k = f->Ft.start[j]; k < f->Ft.start[j + 1]; k++)
        if (f->Ft.value[k] != 0)
            return 0;
    return f->e[j] == 0;
}

/* The first unknown that y_j depends on, n: none. */
static int first_of(const ns_form *f, int j) {
    for (int k = f->Ct.start[j]; k < f->Ct.start[j + 1]; k++)
        if (f->Ct.row[k] < f->n && f->Ct.value[k] != 0)
            return f->Ct.row[k];
    return f->n;
}

/* Switches without resistance by the first unknown of their y: head (n+1) and next (nc), -1: no more. */
static void list_switches(const ns_system *s, const ns_form *f, int *head, int *next,
                          unsigned char *commanded) {
    for (int i = 0; i <= f->n; i++)
        head[i] = -1;
    for (int c = 0; c < s->nc; c++) {
        const int j = s->command[c].pair, at = first_of(f, j);
        commanded[j] = 1;
        next[c] = -1;
        if (!is_alone(f, j, 0))
            continue;
        next[c] = head[at];
        head[at] = c;
    }
}

static int find(const ns_system *s, const ns_form *f, const int *head, const int *next,
                const unsigned char *commanded, ns_shared_branch *list) {
    int count = 0;
    for (int j = 0; j < f->m; j++) {
        if (commanded[j] || (s->l[j] != 0 && s->u[j] != 0) || !is_alone(f, j, 1))
            continue;
        for (int c = head[first_of(f, j)]; c >= 0; c = next[c]) {
            const int of = s->command[c].pair;
            if (!parallel(&f->Ct, f->Ct.value, f->n, j, of) ||
                !parallel(&f->K, f->KA, f->n, f->n + j, f->n + of))
                continue;
            list[count++] = (ns_shared_branch){j, of, s->l[j] == 0 ? NS_LOWER : NS_UPPER};
            break;
        }
    }
    return count;
}

int ns_sparse_shared_find(const ns_system *s, const ns_form *f, ns_shared_branch **out, int *count) {
    const size_t n = (size_t)f->n, m = (size_t)f->m, nc = (size_t)s->nc;
    *count = 0;
    *out = NULL;
    if (m == 0 || nc == 0)
        return NS_OK;
    int *head = calloc(n + 1 + nc, sizeof *head);
    unsigned char *commanded = calloc(m, 1);
    ns_shared_branch *list = calloc(m, sizeof *list);
    if (head && commanded && list) {
        list_switches(s, f, head, head + n + 1, commanded);
        *count = find(s, f, head, head + n + 1, commanded, list);
        *out = list;
    } else {
        free(list);
    }
    free(head);
    free(commanded);
    return *out ? NS_OK : NS_E_MEMORY;
}
