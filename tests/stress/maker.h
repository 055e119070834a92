/* tests/stress/maker.h - what the classes of circuits are written with: parts with random values and
 * parasitics.
 *
 * A maker draws the style of one circuit (how ideal its devices are, how its gates are driven, which
 * parasitics it has), a class adds parts between named nodes, and the end adds the models and the .tran line.
 */
#ifndef NONSMOOTH_TESTS_MAKER_H
#define NONSMOOTH_TESTS_MAKER_H

#include "dice.h"
#include "netlist.h"

typedef struct maker {
    netlist *n;
    dice d;
    int ids;                                 /* of parts and nodes so far */
    double T, stop;                          /* s: the period of switching, the end of the run */
    double vf, ron_d, roff_d, ron_s, roff_s; /* of diodes and switches; roff 0: infinite */
    int gate_rc;      /* gates are 15 V through a resistor and a capacitor, else 1 V without */
    double gate_tau;  /* s, of these */
    double coss;      /* F beside a switch; 0: none */
    double parasites; /* probability of ESR, ESL, leakage at a part */
    double snubbers;  /* probability of a snubber at a device */
    double edge;      /* s, of gate pulses */
} maker;

/* One class. */
typedef struct family {
    const char *name;
    void (*make)(maker *m);
} family;

/* fs: the frequency of switching, Hz, by which times and parasitics are drawn; periods: length of the run. */
void maker_begin(maker *m, netlist *n, const char *title, unsigned long long number);
void maker_times(maker *m, double fs, double periods);
void maker_ideality(maker *m); /* any ron, roff, vf instead of plausible ones */
void maker_end(maker *m);

/* Draws. */
double draw(maker *m, double lo, double hi); /* logarithms evenly spread, four digits */
double draw_even(maker *m, double lo, double hi);
int draw_one(maker *m, int n); /* 0 .. n-1 */
int chance(maker *m, double p);

/* A new node "stem12"; one of 256 in turn, so copy what is to last. */
const char *node(maker *m, const char *stem);
const char *indexed(const char *stem, int i); /* "stem3"; likewise */

/* Parts; the last three return the name of the part. */
void resistor(maker *m, const char *p, const char *n, double ohms);
void capacitor(maker *m, const char *p, const char *n, double farads, double ic); /* with ESR, ESL, leakage */
void plain_c(maker *m, const char *p, const char *n, double farads, double ic);
void inductor(maker *m, const char *p, const char *n, double henries, double ic); /* with DCR, winding C */
const char *winding(maker *m, const char *p, const char *n, double henries);
void couple(maker *m, const char *l1, const char *l2, double k);
void diode(maker *m, const char *a, const char *k); /* with a snubber, a junction's C */
void contact(maker *m, const char *p, const char *n, const char *gate, const char *ref); /* a switch alone */
void mosfet(maker *m, const char *d, const char *s,
            const char *gate);                                       /* switch, body diode, Coss; gate to 0 */
void igbt(maker *m, const char *c, const char *e, const char *gate); /* switch in series with a diode */
void supply(maker *m, const char *p, const char *n, double volts);   /* with a source impedance, a filter */
void load(maker *m, const char *p, const char *n, double ohms);      /* resistor, with L, a step, a current */
void bleeder(maker *m, const char *p, const char *n);                /* 10 kohm to 100 Mohm, or none */

/* A gate: node `name` is driven against 0, on for `on` of a period T from `from` (in T) on. */
void gate(maker *m, const char *name, double from, double on);
void gate_at(maker *m, const char *name, double from, double on, double period);
/* A gate driven by a comparator: on when v(p,n) rises above vt+vh, off when it falls below vt-vh.  With a vt
 * above 0 a gate from (p,n) and one from (n,p) are never on together. */
void gate_compare(maker *m, const char *name, const char *p, const char *n, double vt, double vh);
void sine(maker *m, const char *p, const char *n, double volts, double hertz, double degrees);

/* Values that fit: an inductance in which V makes a ripple of the current I, a capacitance likewise. */
double fit_l(maker *m, double volts, double amperes);
double fit_c(maker *m, double volts, double amperes);

/* The lists of classes, each ended by a NULL name. */
extern const family families_dcdc[], families_isolated[], families_rectifiers[], families_inverters[],
    families_pumps[], families_control[], families_random[], families_ties[];

#endif
