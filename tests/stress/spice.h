/* tests/stress/spice.h - one run of a netlist through ngspice in batch. */
#ifndef NONSMOOTH_TESTS_SPICE_H
#define NONSMOOTH_TESTS_SPICE_H

#include "run.h"

/* How ngspice is asked: its program (NGSPICE, else from the path), our code models (NULL: none, its own
 * models, as stock.h writes them), a folder to work in. */
typedef struct spice_home {
    const char *models, *folder;
} spice_home;

/* The values lie on straight lines between ngspice's time points.  limit: s of CPU. */
void spice_run(const netlist *n, const plan *p, const spice_home *home, double limit, run_result *r);
/* s of CPU that ngspice takes to start and to read it. */
double spice_start(const netlist *n, const plan *p, const spice_home *home, double limit);

#endif
