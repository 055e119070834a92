/* src/mlcp/method.c - the methods and their names. */
#include "mlcp_internal.h"

#include <string.h>

static const char *const names[NS_MLCP_METHODS] = {
    [NS_MLCP_AUTO] = "auto",
    [NS_MLCP_PIVOT] = "pivot",
    [NS_MLCP_LEMKE] = "lemke",
    [NS_MLCP_ENUMERATE] = "enumerate",
};

const char *ns_mlcp_method_name(int method) {
    return method >= 0 && method < NS_MLCP_METHODS ? names[method] : "?";
}

int ns_mlcp_method_of(const char *name) {
    for (int k = 0; name && k < NS_MLCP_METHODS; k++)
        if (strcmp(name, names[k]) == 0)
            return k;
    return -1;
}

int ns_mlcp_use(ns_mlcp_solver *s, ns_mlcp_method method) {
    if (!s)
        return NS_E_NULL;
    if ((int)method < 0 || method >= NS_MLCP_METHODS)
        return NS_E_RANGE;
    s->use = method;
    return NS_OK;
}

int ns_mlcp_same(ns_mlcp_solver *s, int same) {
    if (!s)
        return NS_E_NULL;
    s->same = same != 0;
    return NS_OK;
}

int ns_mlcp_limit(ns_mlcp_solver *s, double most) {
    if (!s)
        return NS_E_NULL;
    if (isnan(most))
        return NS_E_RANGE;
    s->most = most;
    return NS_OK;
}

int ns_mlcp_alike(ns_mlcp_solver *s, int alike) {
    if (!s)
        return NS_E_NULL;
    if (s->alike != (alike != 0))
        s->units.valid = 0;
    s->alike = alike != 0;
    return NS_OK;
}
