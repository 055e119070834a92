/* src/sparse/event.h - what the files of an event have in common. */
#ifndef NS_SPARSE_EVENT_H
#define NS_SPARSE_EVENT_H

#include "sparse_internal.h"

/* event.c: m->mode and m->w made consistent with one another by steps of length g; commands stay. */
int ns_sparse_event_find(ns_sparse *m, double t, double g, ns_jump_kind *jump);
/* Switches whose control m->v contradicts change, or slide; how many. */
int ns_sparse_event_change_commands(ns_sparse *m, const ns_dense_step *step);
/* A switch begins to slide on its threshold: w, which is off it by the error of a step, is moved there.  If
 * it is farther away the switch does not slide but changes as its control asks. */
int ns_sparse_event_to_thresholds(ns_sparse *m, double t, double g, double *by);

#endif
