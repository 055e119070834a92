/* tests/rig/net.h - a circuit, element by element, and the jump that its initial state makes. */
#ifndef NONSMOOTH_TESTS_NET_H
#define NONSMOOTH_TESTS_NET_H

#include "nonsmooth.h"

enum { NET_MOST = 40 }; /* unknowns, devices, inputs */

typedef struct net {
    ns_circuit *c;
    ns_system *s;
    ns_theta *step;
    unsigned char closed[NET_MOST]; /* of each switch */
    int switches;
    double w0[NET_MOST], z[NET_MOST]; /* M x at rest, inputs just after 0 */
    /* the jump: an ns_impulse */
    double x[NET_MOST], lambda[NET_MOST], y[NET_MOST], X[NET_MOST], Lambda[NET_MOST], Y[NET_MOST];
    double w[NET_MOST], h;
    ns_mode mode[NET_MOST];
} net;

net net_begin(void);
void net_end(net *k);

/* Elements between nodes p and n; the number of each is returned.  Devices are ideal. */
int net_capacitor(net *k, const char *name, int p, int n, double c, double v);
int net_inductor(net *k, const char *name, int p, int n, double l, double i);
int net_resistor(net *k, const char *name, int p, int n, double r);
int net_diode(net *k, const char *name, int p, int n);
int net_voltage(net *k, const char *name, int p, int n, double v);
int net_contact(net *k, const char *name, int p, int n, int closed); /* a switch with a gate of its own */

/* The system, and a stepper at rest; then the jump (slope: of the inputs, or NULL); both, without slopes. */
void net_prepare(net *k);
int net_jump(net *k, const double *slope);
void net_jumps(net *k);

/* Voltage of a node, current of an inductor or a source, current of a device: in x and lambda, or as impulses
 * in X and Lambda. */
double net_voltage_of(const net *k, const double *x, int node);
double net_current_of(const net *k, const double *x, int id);
double net_device_of(const net *k, const double *x, const double *lambda, int id);

#endif
