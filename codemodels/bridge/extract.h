/* bridge/extract.h - ngspice's circuit read into a circuit of the library.
 *
 * Nodes keep ngspice's equation numbers, elements their flattened names.  What cannot be taken ends the
 * reading with one line that names it. */
#ifndef BRIDGE_EXTRACT_H
#define BRIDGE_EXTRACT_H

#include "digital.h"
#include "models.h"
#include "nonsmooth/circuit.h"
#include "own_mosfet.h"
#include "pure/options.h"

typedef struct ns_extract_device {
    MIFinstance *inst;
    int id; /* the element in the circuit */
} ns_extract_device;

/* A code model climit. */
typedef struct ns_extract_climit {
    const MIFinstance *inst;
} ns_extract_climit;

/* A B, E or G that acts on nothing (display.h). */
typedef struct ns_extract_display {
    const GENinstance *inst;
    int node, branch; /* equations: what it drives; its current, 0: it has none */
    double gain;      /* of its value: the voltage of the node */
    double siemens;   /* of the voltage of the node: its current */
    double gmin;      /* S, of ngspice */
    double most;      /* V: the largest shown so far */
    char name[80];
} ns_extract_display;

/* An I of ngspice that is not DC. */
typedef struct ns_extract_wave {
    GENinstance *inst;
    int input; /* of the system */
} ns_extract_wave;

/* What of a device a current is. */
typedef enum ns_own_path {
    OWN_FORWARDS,  /* through a D, or the body diode of an M */
    OWN_BACKWARDS, /* that in breakdown */
    OWN_CHANNEL,   /* of an M that follows its gate, while it does */
    OWN_PATHS
} ns_own_path;

/* The current, A, at which the curve of each D is read where option id is not given. */
typedef struct ns_own_current {
    const GENinstance *inst; /* a D, or an M with its body diode */
    double id;
    double most;   /* A: the largest in the part of the pass that counts, */
    double rush;   /* in all of it; */
    double blocks; /* V: across it while it is off */
    int faint;     /* what it carried in the pass was a leak, and is not id */
    ns_own_path path;
} ns_own_current;

/* An S or W of vh = 0 whose control is at its threshold from the start on: ngspice has it closed, or not. */
typedef struct ns_own_start {
    const GENinstance *inst;
    int closed;
    double size;     /* V or A: of what its control is the difference of */
    int falls;       /* it leaves downwards: it comes back from below, then */
    double until[2]; /* s: it stays so up to the first; control alone decides from the second on */
} ns_own_start;

/* What earlier passes over the same .tran found. */
typedef struct ns_own_found {
    int count;
    ns_own_current *of; /* count */
    double otherwise;   /* of all others */
    int is_first;       /* the analysis that is made is of a first pass */
    double seconds;     /* of the pass that found them, from 0 on; 0: there was none */
    int whole;          /* that was all of .tran */
    int fails;          /* it could not go on */
    int nstarts;
    ns_own_start *start; /* nstarts (own_rest.c) */
} ns_own_found;

#define NS_OWN_CURRENT 0.1 /* where nothing is known */

/* A line for the square law of a follower (own_follower.c): the tangent at a current, or a flatter one. */
typedef struct ns_own_line {
    double at; /* A */
    double volts, ohm;
} ns_own_line;

/* One of ngspice's own devices, taken as ideal. */
typedef struct ns_own_taken {
    GENinstance *inst;
    ns_own_kind kind;
    int id;       /* the element in the circuit; -1: a mere resistor */
    int inverted; /* the element is closed where the device is off */
    struct {
        int low, from_below; /* the other elements of an S or W of a negative vh */
    } early;
    struct {      /* of S and W of vh = 0, the control: */
        int side; /* 1 above its threshold when it last was not there, -1 below, 0 it was nowhere else */
        double differs; /* s: at its threshold, and ngspice has the other state, since then; NAN: not so */
    } rest;
    /* of D, and the body diode of M: */
    ns_diode diode;     /* what it was taken for */
    ns_diode beyond;    /* of a D: another one in parallel, which carries more of an inrush; */
    int beyond_id;      /* its element; 0: there is none, as it is not the first one */
    double at;          /* A: vf is that of its curve there */
    struct {            /* the pass that found this current: */
        double seconds; /* 0: there was none */
        int whole;      /* it was all of .tran */
        int idle;       /* the D did not conduct in it */
        int tangent;    /* vf and ron are those of its curve there, rs added; */
        double to;      /* A: or of a flatter line up to that current; 0: not */
        int faint;      /* it carried no more than a leak */
        double broken;  /* A: the current in breakdown of which vz and rz are; 0: it had none */
    } pass;
    int anode;    /* equation */
    int inside;   /* equation of its node behind rs; 0: there is none */
    double rs;    /* ohm */
    double tt;    /* s: transit time, which is left out */
    int smoothed; /* it had an epsilon, which was left out */
    struct {      /* in the points of .tran so far: */
        ns_pulse_mean current;
        double t, i;   /* s, A: the point before */
        double most_v; /* V: the largest voltage across it, of either sign */
        /* of D, until it conducts first: the voltage forwards (V) at the point before and the largest one;
         * for how long (s), what its own model would have carried meanwhile, and the largest current beside
         * it, C */
        double forwards, most_forwards, seconds, missed, beside;
        double carried, stored; /* of D: what it carried forwards, and what tt held at each end, C */
        double held, through;   /* likewise: what tt holds; the current forwards at the point before, A */
        double spent, supplied; /* J: what flows back by the voltage that it meets; what V supply meanwhile */
        double flows;           /* C: by the largest current of a source or inductor */
        /* of M: v(gate,source) beyond vto; what its own channel does not do, and of what that is a part: at
         * the point before, and integrals */
        double above, off, of, all_off, all_of;
        double closed, openings; /* of M: how long, s, and how often it opened */
        int overlaps;            /* of M: 1 + the index of another one that was closed too; 0: none was */
        double v;                /* V: across it, of M its channel */
    } seen;
    struct {              /* own_moved.c, of D: */
        double v, turned; /* V: at the point before; C: of its junction where that turned last */
        int way;          /* 1: v rises; -1: it falls; 0: it did not change yet */
        double charge, carried, beside; /* C: of the junction, to and fro; forwards; by the largest current */
    } moved;
    struct {                      /* own_ring.c, of D: the present pulse of its current, or the last one */
        int is_on;                /* it did not end yet */
        double began, half, most; /* s; s: when it last was above its half; A */
        double at_half;           /* A, then */
        double v, mark;           /* V: across it (of M, S too) at the point before; before the last end */
        double rings, peaks;      /* A: sums of what would ring, and of all pulses */
        double charge, t;         /* C, of all; s, the point before */
        double farads;            /* that rings, as seen by this D, at most */
    } ring;
    struct {                   /* own_overlap.c, of M: */
        double opened, closed; /* s, last */
        double seconds, count; /* for how long both would be closed, and how often */
        double charge;         /* C, that would flow through both */
        int with;              /* 1 + the index of the other one */
    } overlap;
    struct {                     /* own_supply.c, of M: */
        const GENinstance *inst; /* the V that feeds its gate; NULL: none */
        int branch;              /* its equation */
        double amperes;          /* that it carries at the point before, of either sign */
        double shown, seconds;   /* C, in so many s */
    } supply;
    struct {                             /* own_closed.c, of a follower, forwards and backwards: */
        int held;                        /* V hold the end that its current flows to */
        double off, of, all_off, all_of; /* as those of seen, in A or V */
    } closed_way[2];
    struct {                   /* own_weak.c, of M: */
        double rate, most;     /* V/s at which its gate came to vto; A, the largest since it closed */
        int opened;            /* at the point before: how fast its gate goes on is not known yet */
        double seconds, all;   /* for how long its own model alone would carry a current, and in all */
        double longest;        /* s of these, at once; of that: */
        double volts, amperes; /* from how many V below vto on, and which current, A */
    } weak;
    double vt;                 /* of a switch with VON, VOFF; */
    struct {                   /* own_between.c, of it: */
        int pos, neg;          /* equations: its control is the difference */
        double off_at, on_at;  /* V or A: its own model is neither open nor closed between these, */
        double off, on;        /* ohm: but a resistor between these; */
        int by_logarithm;      /* the logarithm of that goes with the control, not the resistance */
        double control;        /* at the point before */
        int counts;            /* likewise: that resistor does something else than the switch */
        double most_i, most_v; /* A, V: the largest through it, across it */
        double seconds, all;   /* for how long it was there and that counts, and in all */
    } between;
    ns_own_switch sw;    /* of S, W */
    const char *open[2]; /* nodes of its control that nothing else is connected to (own_open.c), or NULL */
    /* of M: */
    ns_own_mosfet mosfet;
    ns_own_drive driven;   /* as the netlist says */
    int gate_is_shown;     /* it is in the plot, and asks for points */
    int follows;           /* its channel is a diode behind a source follower, not a switch */
    int body;              /* the element of its body diode */
    int bulk;              /* of its diode between bulk and source; -1: there is none */
    int back;              /* the element that carries what a follower lets pass backwards; -1: it is none */
    ns_own_line overdrive; /* what the gate of a follower needs beyond vth; at 0: it is not known, left out */
    ns_own_line closed;    /* its channel while it is closed; at 0: ron is at a guess, or at no current */
    double drive;          /* V, that ron belongs to */
    double ron;            /* ohm, with that of `closed` */
} ns_own_taken;

typedef struct ns_extract {
    ns_circuit *circuit;
    int neq;      /* equations of ngspice, with ground */
    int *element; /* neq: the element whose current the equation stands for, -1: none, a node */
    int capacitors, inductors, couplings; /* their types in ngspice, -1: there are none */
    int ndevices;
    ns_extract_device *device; /* ndevices: our diodes and switches */
    int nowns;
    ns_own_taken *own; /* nowns: D, S, W of ngspice that were taken */
    int nwaves;
    ns_extract_wave *wave; /* nwaves: I of ngspice that are not DC (single_load.c) */
    int ndisplays;
    ns_extract_display *display; /* ndisplays: each after those that it reads */
    int nclimits;
    ns_extract_climit *climit; /* nclimits: code models whose limits are to be watched (climits.c) */
    ns_digital digital;   /* XSPICE's digital parts (digital_read.c; digital.c while the analysis runs) */
    struct {              /* the first code model whose corners are sharp here: */
        char name[80];    /* empty: there is none */
        const char *what; /* the parameter that smooths them */
    } sharp;
    char curved[80];  /* the first B whose tanh, atan or 1/(1+exp(u)) became straight lines; "": none */
    char stepped[80]; /* likewise one in whose products the voltage of a V became a comparison */
    ns_bridge_options options;
    const MIFinstance *options_inst; /* the instance of model nonsmooth; NULL: there is none */
    unsigned long long hash; /* of all that was read: of two readings: equal if nothing was altered between */
    int error;               /* a code of ngspice; OK if all was taken */
    char line[400];          /* why not, for a person */
} ns_extract;

/* What sources stand for. */
typedef enum ns_extract_sources { SOURCES_TRAN, SOURCES_DC } ns_extract_sources;

/* Reads ckt; found: by earlier passes (NULL: nothing).  Returns ex->error; ns_bridge_extract_clear() frees
 * what was read, after an error too. */
int ns_bridge_extract_read(CKTcircuit *ckt, ns_extract_sources sources, const ns_own_found *found,
                           ns_extract *ex);
void ns_bridge_extract_clear(ns_extract *ex);

#endif
