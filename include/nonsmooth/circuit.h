/* nonsmooth/circuit.h - netlist elements -> (S1)-(S4) by modified nodal analysis.
 *
 * Nodes are integers >= 0, 0 is ground; any node named by an element exists.  Elements are numbered from 0 in
 * the order they are added; *id (may be NULL) gets the number.  Names are copied, must be unique, and are
 * used in messages.  SI units; currents flow from the first node through the element to the second.
 *
 * Unknowns x: voltages of the nodes that are used, ascending, then currents of the elements that need
 * one (L, V, E, H, R = 0, behavioural V) in the order they were added.
 */
#ifndef NONSMOOTH_CIRCUIT_H
#define NONSMOOTH_CIRCUIT_H

#include <stddef.h>

#include "nonsmooth/signal.h"
#include "nonsmooth/system.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ns_circuit ns_circuit;

/* The ideal diode.  Blocking: i = v/roff.  Conducting: v = vf + ron i.  In breakdown:
 * v = -vz + rz i.  It changes state where two of these lines meet. */
typedef struct ns_diode {
    double vf;   /* V, finite, may be 0 */
    double ron;  /* ohm, >= 0 */
    double roff; /* ohm, > ron, INFINITY allowed */
    double vz;   /* V, > 0 (and -vz < vf), INFINITY: none */
    double rz;   /* ohm, >= 0, < roff */
} ns_diode;

/* The ideal switch: v = ron i closed, i = v/roff open; closes above vt+vh, opens below vt-vh. */
typedef struct ns_switch {
    double vt;   /* V */
    double vh;   /* V, >= 0 */
    double ron;  /* ohm, >= 0 */
    double roff; /* ohm, > ron, INFINITY allowed */
} ns_switch;

/* One term of an affine expression: of a linear behavioural source, a kink or a choice. */
typedef struct ns_term {
    int is_current; /* 0: voltage of node `of`; 1: current of element `of` (one that has a current unknown);
                       2: value of element `of` (a kink or a choice) */
    int of;
    double gain;
} ns_term;

typedef enum ns_output { NS_VOLTAGE, NS_CURRENT } ns_output; /* what a source puts out */

int ns_circuit_create(ns_circuit **out);
void ns_circuit_free(ns_circuit *c); /* NULL is allowed */

/* Names a node for messages.  Errors: NULL, SIZE, MEMORY. */
int ns_circuit_name_node(ns_circuit *c, int node, const char *name);

/* Elements.  ic: initial v or i, NAN if not given.  Errors of all: NULL, SIZE (node < 0, or reference to no
 * such element), NUMBER, RANGE, NAME (given twice), MEMORY; on error the circuit is as before.
 * Coupling factors of which each is in range but which no windings can have together (0.99, 0.99 and 0 among
 * three) are refused by ns_circuit_system(). */
int ns_circuit_resistor(ns_circuit *c, const char *name, int p, int n, double ohms,
                        int *id); /* 0 and < 0 allowed */
int ns_circuit_capacitor(ns_circuit *c, const char *name, int p, int n, double farads, double ic, int *id);
int ns_circuit_inductor(ns_circuit *c, const char *name, int p, int n, double henries, double ic, int *id);
int ns_circuit_coupling(ns_circuit *c, const char *name, int l1, int l2, double k, int *id); /* |k| <= 1 */
int ns_circuit_source(ns_circuit *c, const char *name, ns_output kind, int p, int n, const ns_signal *s,
                      int *id);
/* E (control voltage), G: controlled by v(cp)-v(cn).  H, F: by the current of element `by`. */
int ns_circuit_vcontrolled(ns_circuit *c, const char *name, ns_output kind, int p, int n, int cp, int cn,
                           double gain, int *id);
int ns_circuit_icontrolled(ns_circuit *c, const char *name, ns_output kind, int p, int n, int by, double gain,
                           int *id);
/* constant + sum of terms (B sources that are linear). */
int ns_circuit_linear(ns_circuit *c, const char *name, ns_output kind, int p, int n, double constant,
                      int nterms, const ns_term *terms, int *id);
int ns_circuit_diode(ns_circuit *c, const char *name, int anode, int cathode, const ns_diode *d, int *id);
int ns_circuit_switch(ns_circuit *c, const char *name, int p, int n, int cp, int cn, const ns_switch *s,
                      int *id);
/* Its control is gain times the current (A) of element `by`, which has a current unknown; vt and vh of *s are
 * in A. */
int ns_circuit_switch_by_current(ns_circuit *c, const char *name, int p, int n, int by, double gain,
                                 const ns_switch *s, int *id);
/* At a start, a switch whose control is between vt-vh and vt+vh is closed (1) or open (0, the default).
 * Errors: NULL, SIZE (id is no switch). */
int ns_circuit_switch_initially(ns_circuit *c, int id, int closed);
/* A switch of vh = 0 whose control comes back to vt and rests there stays as it is (closed < 0, the default),
 * or is closed (1) or open (0).  Errors: NULL, SIZE (id is no switch). */
int ns_circuit_switch_at_rest(ns_circuit *c, int id, int closed);
/* A switch of vh = 0 whose control, a sum of sources, comes to vt and rests there: closed, if it comes
 * from below, open, if from above (where it does both ns_circuit_system() fails: RANGE); where it never
 * leaves vt, closed (1) or open (0); with any other control, as by at_rest(id, other).  Errors: NULL, SIZE
 * (id is no switch). */
int ns_circuit_switch_as_it_came(ns_circuit *c, int id, int closed, int other);
/* The control of this switch may rest at vt though vt is not 0.  Without this call a control that is no sum
 * of sources counts as resting only where vt is 0.  Errors: NULL, SIZE (id is no switch). */
int ns_circuit_switch_rests(ns_circuit *c, int id);
/* By how much (V or A) the threshold vt is shifted for either; size: of the terms whose sum is at vt. */
double ns_circuit_switch_shift(double vt, double size);

/* An affine expression: constant + sum gain * what each term stands for, V or A. */
typedef struct ns_affine {
    double constant;
    int nterms;
    const ns_term *terms; /* nterms; copied */
} ns_affine;

/* Elements without nodes and without unknowns: values that terms of other elements may stand for.  Each is
 * one pair in the rows of (S3), and lambda is the value.  Errors: as of all elements.
 *
 * kink: max(u, 0).  y = lambda - u, 0 <= y _|_ lambda >= 0. */
int ns_circuit_kink(ns_circuit *c, const char *name, const ns_affine *u, int *id);
/* choice: u where the control rises above `threshold`, 0 where it falls below it; the pair of a command, with
 * y = lambda - u: closed y = 0, open lambda = 0.  Terms of the control are voltages and currents. */
int ns_circuit_choice(ns_circuit *c, const char *name, const ns_affine *control, double threshold,
                      const ns_affine *u, int *id);
/* The value of a choice while its control rests at `threshold`: u (holds: 1) or 0 (0).  Without this call it
 * stays as it was.  So it does where a choice of another group has the opposite control, unless the control
 * is a sum of sources: both then change in one instant.  Errors: NULL, SIZE (id is no choice). */
int ns_circuit_choice_at_rest(ns_circuit *c, int id, int holds, int group);
/* box: high where y < 0, low where y > 0, between them where y = 0: -y in N_[low,high](lambda).  RANGE: low
 * is not below high. */
int ns_circuit_box(ns_circuit *c, const char *name, double low, double high, const ns_affine *y, int *id);

/* SPICE's .ic v(node)=volts.  Errors: NULL, SIZE, NUMBER, MEMORY. */
int ns_circuit_node_ic(ns_circuit *c, int node, double volts);

/* The error of the last call on c that failed, in one line with element, cause and value; owned by c.
 * Empty if none failed. */
const char *ns_circuit_message(const ns_circuit *c);

/* Makes (S1)-(S4) of the circuit as it is now; the caller frees it with ns_system_free().  A switch whose
 * control nodes are joined by independent voltage sources gets a command with gx NULL (a function of time
 * only). In a part of the circuit that no element connects with ground, one node is put at 0 V (by 1 S to
 * ground, which carries no current): a node with an .ic if there is one.  A resistor below 1e-6 of another
 * one or of a ron at its nodes, or below 1e-12 of a roff, gets its current as an unknown, after the others;
 * and so does every other resistor that is at most a thousand times as large. Errors: NULL, RANGE (coupling
 * factors that let the stored energy be negative), MEMORY, those of ns_system_check(). */
int ns_circuit_system(ns_circuit *c, ns_system **out);

/* The index in x of a node's voltage, of an element's current; -1 if it has none. */
int ns_circuit_node_unknown(const ns_circuit *c, int node);
int ns_circuit_current_unknown(const ns_circuit *c, int id);

/* The index in z of an element's input: of a source that is not DC; -1 if it has none. */
int ns_circuit_input(const ns_circuit *c, int id);

/* The index in lambda of a device's first pair; -1 if it has none. */
int ns_circuit_pair(const ns_circuit *c, int id);

/* Writes w0 = M x(0-) (n of the system) from initial conditions: of each capacitor its ic, else the
 * difference of its nodes' .ic, else 0; of each inductor its ic, else 0 (SPICE's uic).  Errors: NULL. */
int ns_circuit_rest(const ns_circuit *c, double *w0);

/* The .ic of nodes in the form of ns_march_start_dc(): fills hold (indices in x) and hold_x (V), each with
 * room for ns_circuit_node_ic_count() entries, and returns how many were written; -1: no memory.  Left out: a
 * node that voltage sources hold against ground, or against one that is there. */
int ns_circuit_node_ic_count(const ns_circuit *c);
int ns_circuit_hold(const ns_circuit *c, int *hold, double *hold_x);

/* A diode's or switch's current (A), voltage (V) and state (1 conducts, 0 not; -1 breakdown) at a point;
 * i, v, on may be NULL.  Errors: NULL, SIZE (id is neither). */
int ns_circuit_device(const ns_circuit *c, int id, const double *x, const double *lambda, const ns_mode *mode,
                      double *i, double *v, int *on);

/* A point of a solution: what ns_march_read() gives, and for the currents of capacitors the rates of x. */
typedef struct ns_solution {
    double t;             /* s */
    ns_side side;         /* of t, where a source of current jumps */
    const double *x;      /* n */
    const double *lambda; /* m */
    const double *rates;  /* n: dx/dt, 1/s of x; NULL: not known */
} ns_solution;

/* Voltage (V, of the first node against the second), current (A, from the first node through the element to
 * the second) and power (W, taken in: v*i) of any element; v, i, p may be NULL.  A coupling has none: all are
 * 0, its energy is in the inductors.  A capacitor's current without rates: NAN.  Errors: NULL, SIZE (id). */
int ns_circuit_power(const ns_circuit *c, int id, const ns_solution *at, double *v, double *i, double *p);

/* The energy (J) in each element (one each; NULL: not wanted) and in all (NULL: likewise): C v^2/2, L i^2/2;
 * of a coupling half in either inductor, where it may be negative.  Others store none.  Errors: NULL. */
int ns_circuit_stored(const ns_circuit *c, const double *x, double *each, double *all);

/* The number of elements that were added: one more than the last of them; 0 if c is NULL. */
int ns_circuit_count(const ns_circuit *c);

/* The name of an element: "l1"; "element 9" if c has none such.  As ns_circuit_name_unknown(). */
int ns_circuit_name_element(const ns_circuit *c, int id, char *line, size_t size);

/* What an unknown or a pair stands for: "voltage of node out", "current of l1", "ideal diode ad1" (its second
 * pair: "breakdown of ideal diode ad1"), "ideal switch as1"; "unknown 9", "pair 9" if c has none such.
 * Written into line (size bytes, always terminated).  Returns the length it wanted, like snprintf. */
int ns_circuit_name_unknown(const ns_circuit *c, int unknown, char *line, size_t size);
int ns_circuit_name_pair(const ns_circuit *c, int pair, char *line, size_t size);

/* One line for a person: devices, time, cause ("d1, vin: at t = 1.25e-03 s: no solution exists").
 * Written into line (size bytes, always terminated).  Returns the length it wanted, like snprintf. */
int ns_circuit_explain(const ns_circuit *c, const ns_fault *f, char *line, size_t size);

#ifdef __cplusplus
}
#endif
#endif
