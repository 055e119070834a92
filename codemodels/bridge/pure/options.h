/* bridge/pure/options.h - the options of a run. */
#ifndef BRIDGE_OPTIONS_H
#define BRIDGE_OPTIONS_H

#include "nonsmooth/march.h"

/* Which M are taken, as switches. */
typedef enum ns_mosfets {
    NS_MOSFETS_NONE,
    NS_MOSFETS_DRIVEN, /* that sources switch on and off */
    NS_MOSFETS_ALL
} ns_mosfets;

typedef struct ns_bridge_options {
    ns_method method;
    double h; /* s, 0: chosen by the sources and the run */
    double theta, gamma;
    double reltol; /* 0: not given */
    int verbose;
    int grid;                       /* timepoints are those of .tran; else where the waveform needs them: */
    double lines;                   /* how far it may be from straight lines, of its largest value */
    double squares;                 /* the same of integrals of squares; 0: no matter */
    int corners;                    /* of a grid: events and corners of sources get timepoints too */
    int take_switches, take_diodes; /* ngspice's own S and W, D, as ideal ones */
    int zero_diodes;                /* D without vf and ron; else its own: */
    double id;                      /* A: where its vf is read; NAN: not given */
    ns_mosfets mosfets;             /* M too, as switches */
    double vgs;                     /* V, of their drive; NAN: as the netlist drives them */
    int cjo;                        /* junction capacitances of D are taken */
} ns_bridge_options;

extern const ns_bridge_options ns_bridge_options_default;

/* The parameters of an instance of model nonsmooth. */
typedef struct ns_options_given {
    const char *name;                  /* the instance's */
    const char *method;                /* NULL: not given */
    const char *points;                /* NULL: not given */
    const char *take, *diode, *mosfet; /* NULL: not given */
    double lines, squares;
    double id, vgs;   /* NAN: not given */
    double h, reltol; /* NAN: not given */
    double theta, gamma;
    int verbose, corners, cjo;
} ns_options_given;

/* OK, or NS_E_RANGE and in line (size bytes) which parameter is wrong. */
int ns_bridge_options_check(const ns_options_given *given, ns_bridge_options *o, char *line, size_t size);

/* As a netlist names it. */
const char *ns_bridge_options_method(ns_method method);

#endif
