/* tests/unit/waveform/rows_rig.h - rows whose values are given. */
#ifndef ROWS_RIG_H
#define ROWS_RIG_H

#include <string.h>

#include "points_rig.h"
#include "waveform/waveform_internal.h"

/* A source of 0 V over three resistors in series: every x is 0, and looked at. */
static inline rig prepared(const ns_waveform_options *o) {
    const ns_signal none = dc(0);
    ns_waveform_point p;
    rig r = rig_begin();
    assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &none, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r.c, "r1", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r.c, "r2", 2, 3, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r.c, "r3", 3, 0, 1, NULL), NS_OK);
    assert_int_equal(rig_prepare(&r, NS_EXACT, 1e-3, o), NS_OK);
    assert_int_equal(ns_waveform_start(r.w, &p), NS_OK);
    assert_true(r.w->looked >= 2);
    return r;
}

/* A row in which signal 0 and 1 have these values, all others 0. */
static inline double *row_of(ns_waveform *w, double first, double second) {
    double *row = ns_waveform_take_row(w);
    memset(row, 0, sizeof *row * w->count);
    row[w->signal[0]] = first;
    row[w->signal[1]] = second;
    ns_waveform_note_row(w, row);
    return row;
}

static inline void has_been(ns_waveform *w, double first, double second) {
    double *row = row_of(w, first, second);
    ns_waveform_note_size(w, row);
    ns_waveform_return_row(w, row);
}

#endif
