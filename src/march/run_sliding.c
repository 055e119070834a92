/* src/march/run_sliding.c - whether a switch that slides does what infinitely fast switching would do.
 *
 * A switch without hysteresis whose control is held at the threshold opens and closes infinitely fast.  The
 * circuit is then a mean of what it is with the switch open and what it is with the switch closed, weighted
 * so that the control stays (Filippov).  If every other device is the same in both, all is linear between
 * them, and the mean is a current of the switch between nothing and that of the closed one, as the engines
 * have it.  If another device changes with each switching, it is not: rates of the mean are products of the
 * weight and of charges, which no linear mode has, and the engines' switch would take power that none takes.
 *
 * Whether another device changes: the circuit is looked at right after the switch is opened, and closed, with
 * the charges and fluxes of the point.  A guard that breaks in one of them, and not while the switch slides,
 * belongs to such a device.  What a capacitor holds for some time is the same in
 * both.
 */
#include "run_internal.h"

#include "modes/mode.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What happens right after takes h 2^-this; soon, for controls that are on their threshold: h 2^-this.
 */
enum { AT_ONCE_EXPONENT = 14, SOON_EXPONENT = 4 };
/* A control that is that of the switch, but for a factor, stands on its threshold too, to this fraction of
 * what may be an error. */
static const double of_control = 1e-3;

void ns_march_sliding_free(ns_run_check *k) {
    if (k->ends)
        k->ends->table->free(k->ends);
    free(k->end_guards);
    free(k->end_broken);
    free(k->end_w);
    free(k->sliding_mode);
    k->ends = NULL;
    k->end_guards = NULL;
    k->end_broken = NULL;
    k->end_w = NULL;
    k->sliding_mode = NULL;
}

static int allocate_all(ns_run *r) {
    ns_run_check *k = &r->check;
    const size_t n = (size_t)r->s->n, m = (size_t)r->s->m, guards = 2 * m + (size_t)r->s->nc;
    ns_sparse_options o = ns_march_sparse_options(&r->options);
    k->end_guards = calloc(guards + 1, sizeof *k->end_guards);
    k->end_broken = calloc(guards + 1, 1);
    k->end_w = calloc(n + 1, sizeof *k->end_w);
    k->sliding_mode = calloc(2 * m + 1, sizeof *k->sliding_mode);
    if (!k->end_guards || !k->end_broken || !k->end_w || !k->sliding_mode)
        return NS_E_MEMORY;
    k->end_mode = k->sliding_mode + m;
    o.h = ldexp(r->options.h, -AT_ONCE_EXPONENT);
    o.finer = 0;
    return ns_sparse_kernel_create(r->s, &o, &k->ends);
}

static int allocate(ns_run *r) {
    const int status = r->check.ends ? NS_OK : allocate_all(r);
    if (status != NS_OK)
        ns_march_sliding_free(&r->check);
    return status;
}

/* Marks guards that are negative by more than what may be an error, those of controls soon. */
static void mark_broken(ns_run_check *k, const ns_system *s, const ns_mode *mode, double soon) {
    for (int g = 0; g < 2 * s->m + s->nc; g++) {
        const int j = g < 2 * s->m ? g / 2 : s->command[g - 2 * s->m].pair;
        const ns_guard *of = &k->end_guards[g];
        const double value = g < 2 * s->m ? of->value : of->value + soon * of->rate;
        if (!(value < 0))
            continue;
        const double off = g >= 2 * s->m          ? of_control * ns_verify_off_control(k->verify, j)
                           : mode[j] == NS_INSIDE ? ns_verify_wrong * ns_verify_off_lambda(k->verify, j)
                                                  : ns_verify_wrong * ns_verify_off_y(k->verify, j);
        k->end_broken[g] |= value < -(off + of->rounding);
    }
}

/* k->end_broken: guards that are broken in a mode with these charges and fluxes.  Errors: the kernel's. */
static int look_at(ns_run *r, double t, const double *w, const ns_mode *mode) {
    ns_run_check *k = &r->check;
    const ns_kernel_table *of = k->ends->table;
    double ahead;
    int status = of->place(k->ends, t, w, mode);
    memset(k->end_broken, 0, 2 * (size_t)r->s->m + (size_t)r->s->nc);
    if (status == NS_OK)
        status = of->prepare(k->ends, ldexp(r->options.h, -AT_ONCE_EXPONENT), &ahead);
    if (status == NS_OK)
        status = of->guards(k->ends, 0, k->end_guards);
    if (status == NS_OK)
        mark_broken(k, r->s, mode, ldexp(r->options.h, -SOON_EXPONENT));
    return status;
}

/* The pair, other than pair j, of the first guard that is broken; -1: none is. */
static int broken_pair(const ns_run *r, int j) {
    for (int g = 0; g < 2 * r->s->m + r->s->nc; g++) {
        const int of = g < 2 * r->s->m ? g / 2 : r->s->command[g - 2 * r->s->m].pair;
        if (r->check.end_broken[g] && of != j)
            return of;
    }
    return -1;
}

/* The mode of the point, with switches that slide as such. */
static void read_mode(ns_run *r, const ns_verify_state *at) {
    ns_run_check *k = &r->check;
    memcpy(k->sliding_mode, k->shown_mode ? k->shown_mode : ns_engine_mode(r->at_work), (size_t)r->s->m);
    for (int j = 0; j < r->s->m; j++)
        if (ns_verify_slides(k->verify, j))
            k->sliding_mode[j] = at->lambda[j] > 0 ? NS_SLIDES_UP : NS_SLIDES_DOWN;
}

/* The pair that changes while switch j is open, or closed; -1: none does, or it cannot be told. */
static int changes_with(ns_run *r, double t, const double *w, int j) {
    static const ns_mode ends[] = {NS_LOWER, NS_INSIDE};
    ns_run_check *k = &r->check;
    int pair = -1;
    for (int i = 0; i < 2 && pair < 0; i++) {
        memcpy(k->end_mode, k->sliding_mode, (size_t)r->s->m);
        k->end_mode[j] = ends[i];
        if (look_at(r, t, w, k->end_mode) == NS_OK)
            pair = broken_pair(r, j);
    }
    if (pair < 0 || look_at(r, t, w, k->sliding_mode) != NS_OK)
        return -1;
    return broken_pair(r, -1) < 0 ? pair : -1;
}

int ns_march_sliding_is_limit(ns_run *r, const ns_verify_state *at) {
    ns_run_check *k = &r->check;
    const int has_others = r->s->m > 1; /* devices that may change with it */
    if (ns_verify_slidings(k->verify) == 0 || !has_others || allocate(r) != NS_OK)
        return 1;
    double *w = k->end_w;
    ns_system_charges(r->s, at->x, w);
    read_mode(r, at);
    for (int j = 0; j < r->s->m; j++) {
        if (!ns_verify_slides(k->verify, j))
            continue;
        k->changes_too = changes_with(r, at->t, w, j);
        if (k->changes_too < 0)
            continue;
        k->finding = (ns_verify_finding){NS_VERIFY_CHATTER, j, -1, at->t, INFINITY};
        return 0;
    }
    return 1;
}

int ns_march_sliding_refuse(ns_run *r, const ns_verify_finding *f) {
    ns_engine_drop(r->at_work);
    r->fault =
        (ns_fault){.status = NS_E_CHATTER, .t = f->t, .npairs = 2, .pair = {f->pair, r->check.changes_too}};
    r->refused = 1;
    r->check.found = 0;
    return NS_E_CHATTER;
}
