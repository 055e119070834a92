/* bridge/taken.c - charge and energy that our devices took in since the first point that is shown.
 *
 * What is saved is not known before the run.  So they are integrated up to the first point that ngspice shows
 * and until it has shown the next one; if nobody asked by then, no more.
 */
#include "taken.h"

#include <math.h>
#include <stdlib.h>

static int begin(void *data, ns_march *m, int starts) {
    return starts ? ns_energy_start(data, m) : ns_energy_begin_at(data, m);
}

static int take(void *data, ns_march *m, double t) {
    return ns_energy_take(data, m, t);
}

/* Charge and energy in turns. */
static void read_sums(void *data, double *sums) {
    for (int k = 0; k < ns_energy_count(data); k++)
        ns_energy_read(data, k, NULL, &sums[2 * k], &sums[2 * k + 1]);
}

int ns_bridge_taken_make(ns_analysis *a, ns_waveform_integrals *out) {
    int *id = calloc((size_t)a->ex.ndevices + 1, sizeof *id);
    a->taken.sums = calloc(2 * (size_t)a->ex.ndevices + 1, sizeof *a->taken.sums);
    for (int k = 0; id && k < a->ex.ndevices; k++)
        id[k] = a->ex.device[k].id;
    const int status = id && a->taken.sums
                           ? ns_energy_create(a->ex.circuit, a->ex.ndevices, id, &a->taken.energy)
                           : NS_E_MEMORY;
    free(id);
    *out = (ns_waveform_integrals){2 * a->ex.ndevices, a->taken.energy, begin, take, read_sums};
    return status;
}

void ns_bridge_taken_clear(ns_analysis *a) {
    ns_energy_free(a->taken.energy);
    free(a->taken.sums);
}

/* Nobody asked. */
static void stop(ns_analysis *a) {
    ns_waveform_drop_integrals(a->waveform);
    ns_bridge_taken_clear(a);
    a->taken.energy = NULL;
    a->taken.sums = NULL;
}

void ns_bridge_taken_accept(ns_analysis *a, int is_shown) {
    if (a->taken.energy && a->taken.shown && !a->taken.asked)
        stop(a);
    a->taken.shown |= is_shown;
}

void ns_bridge_taken_at(ns_analysis *a, const double *sums, double part) {
    for (int k = 0; a->taken.sums && sums && k < 2 * a->ex.ndevices; k++)
        a->taken.sums[k] += part < 1.0 ? part * (sums[k] - a->taken.sums[k]) : sums[k] - a->taken.sums[k];
}

void ns_bridge_taken_show(const ns_analysis *a, int k, double *q, double *joule) {
    *q = a->taken.sums ? a->taken.sums[2 * k] : NAN;
    *joule = a->taken.sums ? a->taken.sums[2 * k + 1] : NAN;
}
