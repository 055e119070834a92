/* bridge/own_kept.c - ngspice's own devices: what was taken is kept, what is not taken is refused by name. */
#include <ctype.h>

#include "own_elements.h"

int ns_bridge_own_refuse_untaken(ns_extract_walk *w, const GENinstance *inst, const char *group) {
    char what[200];
    snprintf(what, sizeof what,
             "%c elements are taken as ideal ones only with take=\"all\" or \"%s\" in a model nonsmooth, as "
             ".include nonsmooth.inc sets it",
             toupper((unsigned char)inst->GENname[0]), group);
    return ns_bridge_extract_refuse(w, inst, what);
}

int ns_bridge_own_refuse_value(ns_extract_walk *w, const GENinstance *inst, const char *name, double value,
                               const char *why) {
    char what[400];
    snprintf(what, sizeof what, "%s = %g %s", name, value, why);
    return ns_bridge_extract_refuse(w, inst, what);
}

int ns_bridge_own_keep(ns_extract_walk *w, const ns_own_taken *taken) {
    ns_own_taken *more = realloc(w->ex->own, (size_t)(w->ex->nowns + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    w->ex->own = more;
    w->ex->own[w->ex->nowns++] = *taken;
    return NS_OK;
}
