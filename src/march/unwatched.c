/* src/march/unwatched.c - a trial, whatever thresholds are watched: steps end at corners of inputs. */
#include "march_internal.h"

#include <float.h>
#include <math.h>

/* Of the inputs that what is looked at follows; a threshold may look at any. */
static double corner_of(const ns_march *m, int k) {
    return m->followed[k] || m->watched ? ns_signal_next_corner(&m->s->z[k], m->accepted) : INFINITY;
}

/* Where thresholds are watched, those that rounding alone tells apart from the first are passed with it: the
 * last of them. */
static double last_at(const ns_march *m, double first) {
    const double end = first + NS_MARCH_TOGETHER * fabs(first);
    double last = first;
    for (int k = 0; m->watched && k < m->s->nz; k++)
        last = m->corner[k] <= end ? fmax(last, m->corner[k]) : last;
    return last;
}

/* The first of these after the accepted point. */
static double find_corner(ns_march *m) {
    if (m->accepted >= m->corners_from && m->accepted < m->first_corner)
        return m->first_corner;
    const int anew = !(m->accepted >= m->corners_from);
    m->first_corner = INFINITY;
    for (int k = 0; k < m->s->nz; k++) {
        if (anew || m->corner[k] <= m->accepted)
            m->corner[k] = corner_of(m, k);
        m->first_corner = fmin(m->first_corner, m->corner[k]);
    }
    m->first_corner = last_at(m, m->first_corner);
    m->corners_from = m->accepted;
    return m->first_corner;
}

/* A start may end some steps of h/2^20 after t0, beyond a corner: that one does not count then. */
static int try_step(ns_march *m, double t, double *reached) {
    enum { MOST = 4 };
    int status = NS_E_RANGE;
    for (int k = 0; k < MOST && status == NS_E_RANGE; k++) {
        const double corner = find_corner(m);
        status = m->engine->table->try_to(m->engine, fmin(t, corner), NS_TO_STEP, reached);
        if (!(corner < t))
            break;
        if (status == NS_E_RANGE)
            m->accepted = corner;
    }
    return status;
}

int ns_march_try_unwatched(ns_march *m, double t, ns_until until, double *reached) {
    const int status = until == NS_TO_STEP && t > m->accepted
                           ? try_step(m, t, reached)
                           : m->engine->table->try_to(m->engine, t, until, reached);
    if (status == NS_OK)
        m->reached = *reached;
    return status;
}
