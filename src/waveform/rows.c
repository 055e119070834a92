/* src/waveform/rows.c - values at one instant: taken, filled from the marcher, given back. */
#include "linalg/simd.h"
#include "waveform_internal.h"

#include <math.h>
#include <string.h>

double *ns_waveform_take_row(ns_waveform *w) {
    return w->unused[--w->unused_count];
}

void ns_waveform_return_row(ns_waveform *w, double *row) {
    w->unused[w->unused_count++] = row;
}

ns_mode *ns_waveform_mode_of(const ns_waveform *w, const double *row) {
    return w->modes + (size_t)(row - w->rows) / w->row_size * (size_t)w->s->m;
}

void ns_waveform_return_all_rows(ns_waveform *w) {
    w->unused_count = 0;
    w->amid.v = NULL;
    for (size_t i = NS_ROWS; i > 0; i--)
        ns_waveform_return_row(w, w->rows + (i - 1) * w->row_size);
}

static int is_finite(const ns_waveform *w, const double *v) {
    if (ns_sums_finite((int)w->count, v))
        return 1;
    for (size_t k = 0; k < w->count; k++)
        if (!isfinite(v[k]))
            return 0;
    return 1;
}

int ns_waveform_sample(ns_waveform *w, double t, double **row) {
    double *v = *row = ns_waveform_take_row(w);
    int status = ns_march_sample(w->march, t, v, v + w->s->n);
    if (status == NS_OK && !is_finite(w, v))
        status = NS_E_OVERFLOW;
    if (status != NS_OK) {
        ns_waveform_return_row(w, v);
        return status;
    }
    w->samples++;
    ns_waveform_note_row(w, v);
    memcpy(ns_waveform_mode_of(w, v), w->mode, sizeof(ns_mode) * (size_t)w->s->m);
    ns_waveform_note_size(w, v);
    return NS_OK;
}

void ns_waveform_drop_amid(ns_waveform *w) {
    if (w->amid.v)
        ns_waveform_return_row(w, w->amid.v);
    w->amid.v = NULL;
}

int ns_waveform_sample_end(ns_waveform *w, double **row) {
    double *v = *row = ns_waveform_take_row(w);
    memcpy(v, w->at_end, sizeof *v * w->count);
    ns_waveform_note_row(w, v);
    memcpy(ns_waveform_mode_of(w, v), w->mode, sizeof(ns_mode) * (size_t)w->s->m);
    return NS_OK;
}

int ns_waveform_take_integrals(ns_waveform *w, double t) {
    return w->taken.size > 0 ? w->taken.take(w->taken.data, w->march, t) : NS_OK;
}

void ns_waveform_put_integrals(ns_waveform *w, double *row) {
    if (w->taken.size > 0)
        w->taken.read(w->taken.data, row + w->count + 1);
}
