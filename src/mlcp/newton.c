/* src/mlcp/newton.c - placeholder. */
#include "mlcp_internal.h"

int ns_mlcp_newton(ns_mlcp_solver *s, double accept) {
    (void)s;
    (void)accept;
    return NS_E_LIMIT;
}
