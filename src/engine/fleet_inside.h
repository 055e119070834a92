/* src/engine/fleet_inside.h - shared by fleet.c and fleet_way.c. */
#ifndef NS_FLEET_INSIDE_H
#define NS_FLEET_INSIDE_H

#include "../system/islands.h"
#include "fleet.h"
#include "marcher.h"

typedef struct ship {
    ns_march *march;
    const ns_island *island;
    double kept, live; /* of the accepted point; of the last trial */
    int at_event;      /* the accepted point is the left side of one */
    int tried, passes; /* an event where it stands */
    double seen;       /* up to here it was looked ahead: */
    int event;         /* there is one right there, or none so far */
} ship;

struct ns_fleet {
    const ns_system *s;
    ns_islands islands;
    ship *ship;
    double *numbers, *x, *lambda, *y; /* n, m, m: of one island */
    ns_mode *mode;                    /* m */
    unsigned char *seen;              /* n */
    double kept, live;
    int started, has_trial, at_event;
    int failed; /* the ship that did, -1: none */
    double asked;
    ns_until until;
    ns_counts counts;
    ns_fault fault;
};

/* A failure of a ship, or of none: keeps what it says, in indices of the whole; returns the status. */
int ns_fleet_fail(ns_fleet *f, int ship, int status);
int ns_fleet_fail_here(ns_fleet *f, int status);

#endif
