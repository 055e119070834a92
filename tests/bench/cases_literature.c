/* tests/bench/cases_literature.c - the buck converter of the literature (two hinges a transistor
 * characteristic, 12 pairs), 200 us from rest.
 *
 * The library runs the system written by hand (tests/unit/literature.h).  The netlist says the same with B
 * sources for the transistors and the comparator; body diodes are D or sidiode behind 0.8 V.  Reference: the
 * explicit Runge-Kutta pair of tests/unit/lit_buck_exact.h, which knows nothing of complementarity. */
#include "cases.h"
#include "lit_buck_exact.h"

static void exact(const bench_case *c, real fineness, real *values) {
    double X[CASE_TIMES * LIT_BUCK_N];
    lit_buck_exact(2, LIT_STANDARD, 15, fineness < 1 ? 1e-11 : 1e-10, c->time[0], c->times, X);
    for (int k = 0; k < c->times; k++)
        for (int i = 0; i < c->unknowns; i++)
            values[k * c->unknowns + i] = (real)X[k * LIT_BUCK_N + c->unknown[i].of];
}

static void netlist(const deck_models *m, FILE *file) {
    fprintf(file, "vi vin 0 3\n"
                  "vramp ramp 0 pulse(0 2.25 0 1.655u 10n 1n 1.6667u)\n"
                  "vref ref 0 pwl(0 0 100u 1.8)\n"
                  "bmp vin d i=5*(0.41421356*(uramp(v(vin,g)-2)-uramp(v(d,g)-2))"
                  "+1.17157288*(uramp(v(vin,g)-2.5)-uramp(v(d,g)-2.5)))\n"
                  "bmn d 0 i=5*(0.41421356*(uramp(v(g)-2)-uramp(v(g,d)-2))"
                  "+1.17157288*(uramp(v(g)-2.5)-uramp(v(g,d)-2.5)))\n"
                  "vdp dp vin 0.8\nvdn 0 dn 0.8\n");
    if (m->diode == DECK_D)
        fprintf(file, "ddp d dp dm\nddn dn d dm\n.model dm d(is=1e-14 n=%g)\n", m->n);
    else
        fprintf(file,
                "adp %%gd(d dp) dm\nadn %%gd(dn d) dm\n.model dm sidiode(ron=%g roff=%g vfwd=0 epsilon=0)\n",
                m->ron, m->roff);
    fprintf(file,
            "l1 d out 10u ic=0\ncout out 0 22u ic=0\nrload out 0 10\n"
            "r12 out m 227.8k\nc11 out a 20p ic=0\nr11 a m 15.58k\nr21 m b 5.613meg\nc21 b err 1.9p ic=0\n"
            "eamp e0 0 ref m 1e4\nrt e0 e1 1\nct e1 0 5.305164769729845n ic=0\neerr err 0 e1 0 1\n"
            "bcomp g 0 v=min(max(15*(v(ramp)-v(err)+0.1),0),3)\n");
}

static void watch(bench_case *c, int index, const char *vector) {
    c->unknown[c->unknowns].of = index;
    snprintf(c->unknown[c->unknowns++].vector, sizeof c->unknown->vector, "%s", vector);
}

void case_literature(bench_case *c) {
    c->name = "literature";
    c->title = "buck converter of the literature, closed loop";
    c->origin = "explicit Runge-Kutta (5,4) at 1e-10 and 1e-11";
    c->exact = exact;
    c->netlist = netlist;
    c->unit = 1.6667e-6;
    c->system = lit_buck(2, LIT_STANDARD, LIT_GAIN_15);
    watch(c, LIT_BUCK_IL, "i(l1)");
    watch(c, LIT_BUCK_VOUT, "v(out)");
    case_times(c, 200e-6, 10);
}
