/* bridge/pure/diode_law.h - the current of ngspice's D, and the voltage at which it flows. */
#ifndef BRIDGE_DIODE_LAW_H
#define BRIDGE_DIODE_LAW_H

/* One exponential: amperes (exp(v/volts) - 1).  volts 0: there is none. */
typedef struct ns_diode_exponential {
    double amperes, volts;
} ns_diode_exponential;

/* The junction of a diode, after area, multiplier and temperature. */
typedef struct ns_diode_law {
    ns_diode_exponential bottom, side, recombination;
    double vj, m; /* of the factor on the recombination current */
    double knee;  /* A, of high injection; 0: none */
} ns_diode_law;

/* The current (A) at v >= 0 (V), as ngspice's load of D computes it, without gmin and tunnelling. */
double ns_bridge_diode_law_current(const ns_diode_law *law, double v);

/* The voltage (V) at which the current is `amperes` > 0; NAN: the law has no such voltage below 100 V. */
double ns_bridge_diode_law_voltage(const ns_diode_law *law, double amperes);

/* The slope of the voltage there, ohm; NAN: likewise. */
double ns_bridge_diode_law_slope(const ns_diode_law *law, double amperes);

/* Currents, A, up to which a line stands for a curve: the largest of those that count; the largest of all,
 * an inrush for example.  The voltage, V, that it blocks at other times: of that is known how much matters.
 */
typedef struct ns_line_ends {
    double most, rush, blocks;
} ns_line_ends;

/* V/A: the slope of a line for its curve through its point at a current: of the tangent there, or of a
 * flatter one that is at `most` no more than a twentieth above the curve, and at `rush` than that or a
 * fiftieth of `blocks`. */
double ns_bridge_diode_law_line(const ns_diode_law *law, double amperes, const ns_line_ends *ends);

/* Likewise, of any curve of that kind: its slope and its voltages at the current, at `most` and at `rush`. */
double ns_bridge_line_slope(double slope, double at, double most, double rush, double amperes,
                            const ns_line_ends *ends);

/* Two lines for its curve, where an inrush is so far from the current that the line for both would be much
 * flatter than the tangent.  A D on such a line leaves a capacitor on a voltage that is not its own. */
typedef struct ns_diode_lines {
    double slope;  /* V/A: of the line through its point at the current */
    double knee;   /* A: another line begins there, and ends on the curve at `rush`; 0: there is none */
    double beyond; /* V/A: the slope of that */
} ns_diode_lines;

ns_diode_lines ns_bridge_diode_law_lines(const ns_diode_law *law, double amperes, const ns_line_ends *ends);

/* In breakdown: amperes exp((v - at)/volts), v backwards.  volts 0: there is none. */
typedef struct ns_breakdown_law {
    double at, amperes, volts;
} ns_breakdown_law;

/* The voltage (V, backwards) at which a current flows, A. */
double ns_bridge_breakdown_law_voltage(const ns_breakdown_law *law, double amperes);

/* V/A: the slope of a line for its curve, likewise. */
double ns_bridge_breakdown_law_line(const ns_breakdown_law *law, double amperes, const ns_line_ends *ends);

/* The mean of the logarithm of a current, over the charge: where the voltage goes with the logarithm,
 * the mean current's voltage times the charge is the energy lost. */
typedef struct ns_log_mean {
    double coulombs, sum;
    double most; /* A: the largest */
} ns_log_mean;

/* A: what a D that is off may leak, at most. */
#define NS_LEAK 1e-9

/* Currents up to `least` (A) do not count. */
void ns_bridge_log_mean_add(ns_log_mean *mean, double amperes, double seconds, double least);

/* A; 0: nothing flowed. */
double ns_bridge_log_mean_read(const ns_log_mean *mean);

/* The mean logarithm of a current that flows in pulses.  Over all charge an inrush would decide it.  What a
 * pulse leaves, on a capacitor above all, stays until the next one begins; but a spike before a long pause is
 * not worth all of that.  So a pulse counts by the root of that time and of the time for which it flows.  One
 * that came to its end counts with its mean current: it leaves the voltage of its end, and a curve spreads
 * the charge over all its time. */
typedef struct ns_pulse_mean {
    ns_log_mean pulse; /* the last one */
    double began, on;  /* s; for how long it flowed */
    int is_over;
    double weight, sum; /* of those before it */
    double most;        /* A: the largest current */
} ns_pulse_mean;

/* From one time to another, s, it was `amperes`; not on: 0, which ends a pulse. */
void ns_bridge_pulse_mean_add(ns_pulse_mean *mean, int is_on, double amperes, double from, double to);

/* The last pulse counts until t, s; the next one begins then at the earliest. */
void ns_bridge_pulse_mean_end(ns_pulse_mean *mean, double t);

/* A, of pulses that are ended; 0: nothing flowed.  Those of a leak count where there is nothing else. */
double ns_bridge_pulse_mean_read(const ns_pulse_mean *mean);

#endif
