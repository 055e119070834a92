/* src/engine/fleet.h - marchers side by side: each island of a system on its own way.
 *
 * An island is asked for its next event once, and then flies over the events of others: these cost it no more
 * than its values there.  What has no event in common never waits for each other.
 */
#ifndef NS_FLEET_H
#define NS_FLEET_H

#include "nonsmooth/march.h"

typedef struct ns_fleet ns_fleet;

/* NULL in *out where the system is one island.  Otherwise as ns_march_create(), and so are the rest. */
int ns_fleet_create(const ns_system *s, const ns_march_options *o, ns_fleet **out, ns_fault *fault);
void ns_fleet_free(ns_fleet *f);
int ns_fleet_start(ns_fleet *f, double t0, const double *w0);
int ns_fleet_start_dc(ns_fleet *f, double t0, int nhold, const int *hold, const double *hold_x, double *x);
int ns_fleet_try(ns_fleet *f, double t, ns_until until, double *reached);
void ns_fleet_drop(ns_fleet *f); /* the trial */
int ns_fleet_accept(ns_fleet *f);
int ns_fleet_read(ns_fleet *f, double *t, double *x, double *lambda, double *y);
const ns_mode *ns_fleet_mode(ns_fleet *f);
int ns_fleet_at_event(const ns_fleet *f);
ns_method ns_fleet_engine(const ns_fleet *f);  /* the one furthest from exact that is at work in any */
const ns_counts *ns_fleet_counts(ns_fleet *f); /* sums */
const ns_fault *ns_fleet_fault(const ns_fleet *f);
int ns_fleet_problem(const ns_fleet *f, ns_mlcp *p, double *h); /* of the island that failed */

#endif
