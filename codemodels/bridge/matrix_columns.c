/* bridge/matrix_columns.c - the elements of ngspice's matrix by columns, whichever solver holds them. */
#include "matrix_columns.h"

#include <string.h>

#include "versions.h"

static int allocate(ns_matrix_columns *c, int n, int elements) {
    c->n = n;
    c->begin = calloc((size_t)n + 1, sizeof *c->begin);
    c->row_number = calloc((size_t)n + 1, sizeof *c->row_number);
    c->column_number = calloc((size_t)n + 1, sizeof *c->column_number);
    c->element = calloc((size_t)elements + 1, sizeof *c->element);
    return c->begin && c->row_number && c->column_number && c->element ? OK : E_NOMEM;
}

static int count_sparse(const struct MatrixFrame *m) {
    int count = 0;
    for (int k = 1; k <= m->Size; k++)
        for (ElementPtr e = m->FirstInCol[k]; e; e = e->NextInCol)
            count++;
    return count;
}

static int read_sparse(ns_matrix_columns *c, const struct MatrixFrame *m) {
    const int error = allocate(c, m->Size, count_sparse(m));
    int count = 0;
    for (int k = 1; k <= m->Size && !error; k++) {
        for (ElementPtr e = m->FirstInCol[k]; e; e = e->NextInCol)
            c->element[count++] = (ns_matrix_element){&e->Real, e->Row - 1};
        c->begin[k] = count;
        c->row_number[k - 1] = m->IntToExtRowMap[k];
        c->column_number[k - 1] = m->IntToExtColMap[k];
    }
    return error;
}

static int read_klu(ns_matrix_columns *c, const ns_versions_klu *m) {
    /* KLU sets nothing of a matrix of size 0 */
    const int error = allocate(c, m->n, m->n > 0 ? m->column[m->n] : 0);
    for (int k = 0; k < m->n && !error; k++) {
        c->begin[k + 1] = m->column[k + 1];
        c->row_number[k] = c->column_number[k] = (int)m->number[k + 1];
        for (int i = m->column[k]; i < m->column[k + 1]; i++)
            c->element[i] = (ns_matrix_element){&m->element[i], m->row[i]};
    }
    return error;
}

int ns_bridge_matrix_columns_read(ns_matrix_columns *c, const SMPmatrix *matrix) {
    ns_versions_klu klu;
    memset(c, 0, sizeof *c);
    return ns_bridge_versions_klu(matrix, &klu) ? read_klu(c, &klu)
                                                : read_sparse(c, ns_bridge_versions_sparse(matrix));
}

void ns_bridge_matrix_columns_clear(ns_matrix_columns *c) {
    free(c->begin);
    free(c->row_number);
    free(c->column_number);
    free(c->element);
    memset(c, 0, sizeof *c);
}
