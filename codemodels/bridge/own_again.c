/* bridge/own_again.c - a further .tran of the same circuit, after alter for example: D whose curves are read
 * at currents far from those that were written. */
#include <math.h>
#include <stdlib.h>

#include "report.h"
#include "session.h"

static const double far = 3.0;

static int is_far(const ns_own_taken *o, double before) {
    return o->kind == OWN_DIODE && o->pass.tangent && before > 0.0 && fabs(log(o->at / before)) > log(far);
}

/* The farthest of them; NULL: none is far.  *others: how many more. */
static const ns_own_taken *find_farthest(const ns_session *s, int *others) {
    const ns_extract *ex = &s->analysis.ex;
    const ns_own_taken *worst = NULL;
    double by = 0.0;
    *others = -1;
    for (int k = 0; k < ex->nowns; k++) {
        const ns_own_taken *o = &ex->own[k];
        if (!is_far(o, s->again.at[k]))
            continue;
        ++*others;
        if (fabs(log(o->at / s->again.at[k])) > by)
            worst = o;
        by = fmax(by, fabs(log(o->at / s->again.at[k])));
    }
    return worst;
}

/* announced: all were written now.  Of each those count that were written last. */
static void keep(ns_session *s, int announced) {
    const ns_extract *ex = &s->analysis.ex;
    for (int k = 0; k < ex->nowns; k++)
        if (announced || is_far(&ex->own[k], s->again.at[k]))
            s->again.at[k] = ex->own[k].at;
}

int ns_bridge_own_again(ns_session *s, int announced) {
    const size_t count = (size_t)s->analysis.ex.nowns;
    int others;
    if (count == 0 || !(s->found.seconds > 0.0))
        return OK;
    if (s->again.count != count) {
        ns_bridge_own_again_clear(s);
        s->again.at = calloc(count, sizeof *s->again.at);
        s->again.count = s->again.at ? count : 0;
    }
    if (!s->again.at)
        return E_NOMEM;
    const ns_own_taken *o = announced ? NULL : find_farthest(s, &others);
    if (o)
        ns_bridge_report_note("%s: vf = %.4g V, ron = %.4g ohm now (of its model at %.4g A, not %.4g A)%s",
                              o->inst->GENname, o->diode.vf, o->diode.ron, o->at,
                              s->again.at[o - s->analysis.ex.own],
                              others > 0 ? "; other D have changed, too" : "");
    keep(s, announced);
    return OK;
}

void ns_bridge_own_again_clear(ns_session *s) {
    free(s->again.at);
    s->again.at = NULL;
    s->again.count = 0;
}
