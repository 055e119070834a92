/* tests/stress/maker.c - style, draws, times, models. */
#include "maker.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double draw(maker *m, double lo, double hi) {
    char text[32];
    snprintf(text, sizeof text, "%.4g", dice_decades(&m->d, log10(lo), log10(hi)));
    return strtod(text, NULL);
}

double draw_even(maker *m, double lo, double hi) {
    char text[32];
    snprintf(text, sizeof text, "%.4g", lo + (hi - lo) * dice_uniform(&m->d));
    return strtod(text, NULL);
}

int draw_one(maker *m, int n) {
    return dice_below(&m->d, n);
}

int chance(maker *m, double p) {
    return dice_chance(&m->d, p);
}

static char *name_room(void) {
    static char room[256][24];
    static int at;
    at = (at + 1) % 256;
    return room[at];
}

const char *node(maker *m, const char *stem) {
    char *name = name_room();
    snprintf(name, 24, "%.10s%d", stem, ++m->ids);
    return name;
}

const char *indexed(const char *stem, int i) {
    char *name = name_room();
    snprintf(name, 24, "%.10s_%d", stem, i);
    return name;
}

static unsigned stream_of(const char *title) {
    unsigned hash = 2166136261u;
    for (const char *c = title; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 16777619u;
    return hash & 0xffff;
}

void maker_begin(maker *m, netlist *n, const char *title, unsigned long long number) {
    *m = (maker){.n = n, .d = dice_make(stream_of(title), number)};
    netlist_put(n, "* %s %llu", title, number);
    m->vf = chance(m, 0.5) ? 0 : draw_even(m, 0.2, 1.5);
    m->ron_d = chance(m, 0.5) ? 0 : draw(m, 1e-4, 0.1);
    m->ron_s = chance(m, 0.4) ? 0 : draw(m, 1e-4, 0.3);
    m->roff_d = chance(m, 0.7) ? 0 : draw(m, 1e5, 1e9);
    m->roff_s = chance(m, 0.7) ? 0 : draw(m, 1e5, 1e9);
    m->gate_rc = chance(m, 0.35);
    m->parasites = chance(m, 0.4) ? 0 : draw_even(m, 0.1, 0.9);
    m->snubbers = chance(m, 0.6) ? 0 : draw_even(m, 0.2, 1);
    maker_times(m, 1e5, 50);
}

void maker_times(maker *m, double fs, double periods) {
    m->T = 1 / fs;
    m->stop = periods * m->T;
    m->gate_tau = m->T * draw(m, 1e-3, 0.03);
    m->coss = chance(m, 0.6) ? 0 : draw(m, 3e-11, 3e-9) * fmin(1, 1e5 / fs);
    m->edge = chance(m, 0.5) ? 1e-9 : m->T * draw(m, 1e-4, 1e-2);
}

void maker_ideality(maker *m) {
    m->vf = chance(m, 0.5) ? 0 : draw(m, 1e-9, 5);
    m->ron_d = chance(m, 0.3) ? 0 : draw(m, 1e-12, 1);
    m->ron_s = chance(m, 0.3) ? 0 : draw(m, 1e-12, 1);
    m->roff_d = chance(m, 0.3) ? 0 : draw(m, 1e3, 1e18);
    m->roff_s = chance(m, 0.3) ? 0 : draw(m, 1e3, 1e18);
}

static void put_model(maker *m, const char *start, double vf, double ron, double roff) {
    char line[200];
    int at = snprintf(line, sizeof line, "%s", start);
    if (vf != 0)
        at += snprintf(line + at, sizeof line - (size_t)at, " vf=%g", vf);
    if (ron > 0)
        at += snprintf(line + at, sizeof line - (size_t)at, " ron=%g", ron);
    if (roff > 0)
        snprintf(line + at, sizeof line - (size_t)at, " roff=%g", roff);
    netlist_put(m->n, "%s)", line);
}

void maker_end(maker *m) {
    put_model(m, ".model md ideal_diode(", m->vf, m->ron_d, m->roff_d);
    put_model(m, ".model ms ideal_switch(vt=0.5", 0, m->ron_s, m->roff_s);
    put_model(m, ".model mg ideal_switch(vt=8", 0, m->ron_s, m->roff_s);
    netlist_put(m->n, ".tran %.4g %.6g 0 %.4g uic", m->T / 50, m->stop, m->T / 50);
}

double fit_l(maker *m, double volts, double amperes) {
    return fabs(volts) * m->T / (4 * fabs(amperes) * draw(m, 0.05, 2.5));
}

double fit_c(maker *m, double volts, double amperes) {
    return fabs(amperes) * m->T / (8 * fabs(volts) * draw(m, 1e-3, 0.1));
}
