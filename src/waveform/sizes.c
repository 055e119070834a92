/* src/waveform/sizes.c - the values of a row that are looked at, and the largest that each signal and each
 * kind has had so far. */
#include "linalg/simd.h"
#include "waveform_internal.h"

#include <math.h>

void ns_waveform_note_row(ns_waveform *w, double *row) {
    double *seen = row + w->seen_at;
    for (int i = 0; i < w->looked; i++)
        seen[i] = row[w->signal[i]];
    w->integrated = 0;
}

static void note_largest(ns_waveform *w, int i, double size) {
    if (size <= w->largest[i])
        return;
    w->largest[i] = size;
    w->stale = 1;
}

/* The largest |v| of those from first to last - 1. */
ALWAYS_INLINE double largest_of(const double *v, int first, int last) {
    ns_simd_wide wide = {0};
    int i = first;
    for (; i + NS_WIDE <= last; i += NS_WIDE) {
        const ns_simd_wide size = NS_WIDE_SIZE(CONST_WIDE(v, i));
        wide = NS_WIDE_HIGHER(size, wide);
    }
    double part[NS_WIDE], most = 0;
    WIDE(part, 0) = wide;
    for (int k = 0; k < NS_WIDE; k++)
        most = ns_higher(part[k], most);
    for (; i < last; i++)
        most = ns_higher(fabs(v[i]), most);
    return most;
}

/* kind_largest: what coils have for an instant as a large resistance cuts them off, 1e13 V, is far above all
 * that is there before and after: rounding is not a part of that for long. */
ALWAYS_INLINE void note_kinds(ns_waveform *w, const double *seen) {
    static const double far_below = 1e-3, fades = 1.0 / 16;
    for (int k = 0, first = 0; k < NS_WAVEFORM_KINDS; first = w->kind_end[k++]) {
        const double before = w->kind_largest[k], now = largest_of(seen, first, w->kind_end[k]);
        w->kind_largest[k] = now < far_below * before ? fades * before : ns_higher(before, now);
        w->stale |= w->kind_largest[k] != before;
    }
}

ALWAYS_INLINE void note_sizes(ns_waveform *w, const double *seen) {
    note_kinds(w, seen);
    for (int i = 0; i < w->looked; i += NS_WIDE) {
        const ns_simd_wide size = NS_WIDE_SIZE(CONST_WIDE(seen, i));
        if (NS_WIDE_BELOW_OR_AT(size, CONST_WIDE(w->largest, i)))
            continue;
        for (int k = i; k < i + NS_WIDE && k < w->looked; k++)
            note_largest(w, k, fabs(seen[k]));
    }
}

static void note_sizes_narrow(ns_waveform *w, const double *seen) {
    note_sizes(w, seen);
}

NS_WIDE_TARGET static void note_sizes_wide(ns_waveform *w, const double *seen) {
    note_sizes(w, seen);
}

void ns_waveform_note_size(ns_waveform *w, const double *row) {
    (ns_simd_is_wide() ? note_sizes_wide : note_sizes_narrow)(w, ns_waveform_seen(w, row));
}
