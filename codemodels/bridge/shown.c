/* bridge/shown.c - the plot that ngspice began for this run, read. */
#include "shown.h"

#include <stdlib.h>
#include <string.h>

#include "ngspice/grid.h"
#include "ngspice/trandefs.h"

#include "frontend/outitf.h"
#include "models.h"

#include "spicelib/devices/vsrc/vsrcdefs.h"

/* NULL unless what is there is the plot of this run. */
static const runDesc *plot_of(const CKTcircuit *ckt) {
    const TRANan *job = (const TRANan *)ckt->CKTcurJob;
    const runDesc *run = job ? job->TRANplot : NULL;
    return run && run->circuit == ckt && run->analysis == (const void *)job && run->data &&
                   run->numData > 0 && run->numData <= run->maxData
               ? run
               : NULL;
}

/* Marks the equation of one vector; 0: it is not one of them.  names (count): the nodes in ngspice's order.
 */
static int mark(const dataDesc *d, const CKTnode *const *names, int count, unsigned char *shown) {
    if (!d->regular || d->outIndex >= count)
        return 0;
    if (d->outIndex < 0) /* time */
        return 1;
    const CKTnode *node = names[d->outIndex];
    if (!d->name || !node->name || strcmp(d->name, node->name) != 0)
        return 0;
    shown[node->number] = 1;
    return 1;
}

int ns_bridge_shown_read(const CKTcircuit *ckt, int neq, unsigned char *shown) {
    const runDesc *run = plot_of(ckt);
    const CKTnode **names = run ? calloc((size_t)neq + 1, sizeof(CKTnode *)) : NULL;
    int count = 0, known = names != NULL;
    for (const CKTnode *node = ckt->CKTnodes->next; known && node && count < neq; node = node->next)
        names[count++] = node;
    for (int i = 0; known && i < run->numData; i++)
        known = mark(&run->data[i], names, count, shown);
    free(names);
    return known;
}

int ns_bridge_shown_no_parameters(const CKTcircuit *ckt) {
    const runDesc *run = plot_of(ckt);
    int none = run != NULL;
    for (int i = 0; none && i < run->numData; i++)
        none = run->data[i].regular;
    return none;
}

int ns_bridge_shown_edges(const CKTcircuit *ckt, const unsigned char *shown) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const VSRCinstance *v = ns_bridge_models_letter(box->data) == 'v' ? box->data : NULL;
        if (v && v->VSRCfunctionType == PULSE && !shown[v->VSRCposNode] && !shown[v->VSRCnegNode])
            return 0;
    }
    return 1;
}

double ns_bridge_shown_tmax(const CKTcircuit *ckt) {
    const TRANan *job = (const TRANan *)ckt->CKTcurJob;
    return job ? job->TRANmaxStep : 0.0;
}

int ns_bridge_shown_interpolated(const CKTcircuit *ckt, int given) {
    const runDesc *run = plot_of(ckt);
    return run && run->pointCount < given;
}
