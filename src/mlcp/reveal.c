/* src/mlcp/reveal.c - a nonsingular basis where the starting mode has none. */
#include "mlcp_internal.h"
#include "nonsmooth/status.h"
int ns_reveal(ns_mlcp_solver *s) {
    (void)s;
    return NS_E_SINGULAR;
}
