/* src/modes/mode.c - the mode of a system, and the bounds that follow from it. */
#include "mode.h"

#include <math.h>
#include <string.h>

void ns_modes_set(const ns_system *s, const ns_shared_branch *shared, int count, const ns_mode *to,
                  ns_mode *mode, double *l, double *u) {
    if (to != mode)
        memcpy(mode, to, (size_t)s->m);
    for (int c = 0; c < s->nc; c++) {
        const int j = s->command[c].pair, closed = mode[j] == NS_INSIDE;
        l[j] = closed ? -INFINITY : 0;
        u[j] = closed ? INFINITY : 0;
    }
    for (int i = 0; i < count; i++) {
        const int j = shared[i].pair, idle = mode[shared[i].of] == NS_INSIDE;
        l[j] = idle ? 0 : s->l[j];
        u[j] = idle ? 0 : s->u[j];
    }
    ns_modes_shared_rest(shared, count, mode);
}
