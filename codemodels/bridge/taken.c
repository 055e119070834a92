/* bridge/taken.c - charge and energy that our devices took in since the first point that is shown.
 *
 * What is saved is not known before the run.  So they are integrated up to the first point that ngspice shows
 * and until it has shown the next one; if nobody asked by then, no more.  The points of a grid are trials
 * through all events, on whose way nothing can be integrated: there they have a marcher of their own.
 */
#include "taken.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

struct ns_taken {
    ns_energy *energy;
    int size;                 /* 2 a device: charge and energy in turns, C, J: */
    double *sums;             /* at the point that is shown */
    double *before;           /* when the circuit was altered last */
    const double *x, *lambda; /* the point there; NULL: the run starts */
    int shown, asked;         /* a point was shown; somebody asked */
    ns_march *march;          /* of their own, or NULL */
    int begun;                /* it was started */
};

static void free_taken(ns_taken *k) {
    if (!k)
        return;
    ns_energy_free(k->energy);
    ns_march_free(k->march);
    free(k->sums);
    free(k->before);
    free(k);
}

/* --- as the waveform calls it --- */

/* A start without points, up to tstart, begins anew. */
static int begin(void *data, ns_march *m, int starts) {
    ns_taken *k = data;
    const double *x = k->x;
    k->x = NULL;
    if (!starts)
        memset(k->before, 0, sizeof *k->before * (size_t)k->size);
    if (starts && x)
        return ns_energy_start_from(k->energy, m, x, k->lambda);
    return starts ? ns_energy_start(k->energy, m) : ns_energy_begin_at(k->energy, m);
}

static int take(void *data, ns_march *m, double t) {
    return ns_energy_take(((ns_taken *)data)->energy, m, t);
}

static void read_sums(void *data, double *sums) {
    const ns_taken *k = data;
    for (int i = 0; i < k->size; i += 2) {
        ns_energy_read(k->energy, i / 2, NULL, &sums[i], &sums[i + 1]);
        sums[i] += k->before[i];
        sums[i + 1] += k->before[i + 1];
    }
}

/* --- made --- */

static int make(const ns_analysis *a, ns_taken *k) {
    int *id = calloc((size_t)a->ex.ndevices + 1, sizeof *id);
    k->size = 2 * a->ex.ndevices;
    k->sums = calloc((size_t)k->size + 1, sizeof *k->sums);
    k->before = calloc((size_t)k->size + 1, sizeof *k->before);
    for (int d = 0; id && d < a->ex.ndevices; d++)
        id[d] = a->ex.device[d].id;
    const int status = id && k->sums && k->before
                           ? ns_energy_create(a->ex.circuit, a->ex.ndevices, id, &k->energy)
                           : NS_E_MEMORY;
    free(id);
    return status;
}

int ns_bridge_taken_make(ns_analysis *a, ns_march *march, ns_waveform_integrals *out) {
    ns_taken *k = a->taken = calloc(1, sizeof *k);
    if (!k) {
        ns_march_free(march);
        return NS_E_MEMORY;
    }
    k->march = march;
    const int status = make(a, k);
    if (!status && out)
        *out = (ns_waveform_integrals){k->size, k, begin, take, read_sums};
    return status;
}

void ns_bridge_taken_clear(ns_analysis *a) {
    free_taken(a->taken);
    a->taken = NULL;
}

/* Nobody asked, or they are not known any more. */
static void stop(ns_analysis *a) {
    ns_waveform_drop_integrals(a->waveform);
    ns_bridge_taken_clear(a);
}

void ns_bridge_taken_continue(ns_analysis *a, const ns_analysis *from) {
    ns_taken *k = a->taken;
    if (!from->taken || !k || k->size != from->taken->size) {
        stop(a);
        return;
    }
    k->shown = from->taken->shown;
    k->asked = from->taken->asked;
    if (!k->shown)
        return;
    memcpy(k->before, from->taken->sums, sizeof *k->before * (size_t)k->size);
    memcpy(k->sums, k->before, sizeof *k->sums * (size_t)k->size);
    if (a->system->n == from->system->n && a->system->m == from->system->m) {
        k->x = from->x;
        k->lambda = from->lambda;
    }
}

/* --- a marcher of their own --- */

ns_march *ns_bridge_taken_march(const ns_analysis *a) {
    return a->taken ? a->taken->march : NULL;
}

int ns_bridge_taken_begin(ns_analysis *a) {
    a->taken->begun = 1;
    return begin(a->taken, a->taken->march, 1);
}

/* The first point that is shown, at tstart. */
static int begin_late(ns_analysis *a, double t) {
    double *w = calloc((size_t)a->system->n + 1, sizeof *w);
    if (!w)
        return NS_E_MEMORY;
    ns_system_charges(a->system, a->x, w);
    const int status = ns_march_start_as(a->taken->march, t, w, a->mode);
    free(w);
    return status ? status : ns_bridge_taken_begin(a);
}

static void follow(ns_analysis *a, double t) {
    ns_taken *k = a->taken;
    const int status = k->begun ? ns_energy_march(k->energy, k->march, t) : begin_late(a, t);
    if (!status) {
        read_sums(k, k->sums);
        return;
    }
    if (k->asked)
        ns_bridge_report_note("q and e of devices are nan from %.6g s on: %s", t, ns_status_text(status));
    stop(a);
}

/* --- points --- */

void ns_bridge_taken_accept(ns_analysis *a, double t, int is_shown) {
    if (a->taken && a->taken->shown && !a->taken->asked)
        stop(a);
    if (!a->taken)
        return;
    if (a->taken->march && is_shown)
        follow(a, t);
    if (a->taken)
        a->taken->shown |= is_shown;
}

void ns_bridge_taken_at(ns_analysis *a, const double *sums, double part) {
    ns_taken *k = a->taken;
    for (int i = 0; k && sums && i < k->size; i++)
        k->sums[i] += part < 1.0 ? part * (sums[i] - k->sums[i]) : sums[i] - k->sums[i];
}

void ns_bridge_taken_ask(ns_analysis *a) {
    if (a->taken)
        a->taken->asked = 1;
}

void ns_bridge_taken_show(const ns_analysis *a, int k, double *q, double *joule) {
    *q = a->taken ? a->taken->sums[2 * k] : NAN;
    *joule = a->taken ? a->taken->sums[2 * k + 1] : NAN;
}
