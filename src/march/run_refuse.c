/* src/march/run_refuse.c - what was found wrong, and is so by every engine: allowed or refused. */
#include "run_internal.h"

int ns_march_run_allows(ns_run *r, const ns_verify_finding *f) {
    if (f->error > ns_verify_wrong * ns_verify_wrong)
        return 0;
    ns_verify_allow(r->check.verify, f);
    return 1;
}

int ns_march_run_refuse(ns_run *r, const ns_verify_finding *f) {
    if (f->cause == NS_VERIFY_CHATTER)
        return ns_march_sliding_refuse(r, f);
    r->fault = (ns_fault){.status = NS_E_RESIDUAL, .t = f->t, .why = ns_verify_text(f->cause)};
    if (f->pair >= 0)
        r->fault.pair[r->fault.npairs++] = f->pair;
    if (f->unknown >= 0)
        r->fault.unknown[r->fault.nunknowns++] = f->unknown;
    r->refused = 1;
    return NS_E_RESIDUAL;
}
