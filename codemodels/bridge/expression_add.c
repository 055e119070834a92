/* bridge/expression_add.c - a B source whose expression was read as a piecewise linear one. */
#include "expression_reader.h"

#include <stdio.h>
#include <stdlib.h>

enum { TEXT = 100 };

/* Of the run, s. */
static double stop_of(const ns_extract_walk *w) {
    return w->ckt->CKTfinalTime > 0.0 ? w->ckt->CKTfinalTime : 1.0;
}

static int refuse_node(expression_reader *r, GENinstance *inst) {
    char text[TEXT], what[360];
    if (!r->p.why)
        return r->p.status;
    ns_bridge_expression_text(r->b->ASRCtree, r->at, text, sizeof text);
    snprintf(what, sizeof what, "%s is not supported: %s: %s", text, r->p.why,
             r->p.instead
                 ? r->p.instead
                 : "one factor has to be a number, a {parameter}, a comparison (also in a B of its own) "
                   "or the voltage of a V that jumps between two values; pwl(x, x1, y1, ...) approximates a "
                   "curve");
    return ns_bridge_extract_refuse(r->w, inst, what);
}

static int add_source(expression_reader *r, GENinstance *inst, const ns_affine *u, double factor) {
    const ASRCinstance *b = r->b;
    const ns_output kind = b->ASRCtype == ASRC_VOLTAGE ? NS_VOLTAGE : NS_CURRENT;
    ns_term *terms = calloc((size_t)u->nterms + 1, sizeof *terms);
    int id = -1, status = terms ? NS_OK : NS_E_MEMORY;
    for (int i = 0; terms && i < u->nterms; i++)
        terms[i] = (ns_term){u->terms[i].is_current, u->terms[i].of, factor * u->terms[i].gain};
    status = status ? status
                    : ns_circuit_linear(r->w->ex->circuit, inst->GENname, kind, b->ASRCposNode,
                                        b->ASRCnegNode, factor * u->constant, u->nterms, terms, &id);
    ns_bridge_extract_current(r->w, kind == NS_VOLTAGE ? b->ASRCbranch : 0, id);
    free(terms);
    return status;
}

/* 1 if all currents in it are known. */
static int is_ready(const ns_extract_walk *w, const ASRCinstance *b) {
    for (int i = 0; i < b->ASRCtree->numVars; i++)
        if (b->ASRCtree->varTypes[i] == IF_INSTANCE &&
            !(b->ASRCvars[i] > 0 && b->ASRCvars[i] < w->ex->neq && w->ex->element[b->ASRCvars[i]] >= 0))
            return 0;
    return 1;
}

int ns_bridge_expression_add(ns_extract_walk *w, GENinstance *inst, double factor) {
    char name[EXTRACT_NAME];
    const ASRCinstance *b = (const ASRCinstance *)inst;
    const INPparseNode *root = ((const INPparseTree *)b->ASRCtree)->tree;
    ns_affine u;
    if (!is_ready(w, b) || ns_bridge_expression_steps_wait(w, b))
        return EXTRACT_LATER;
    if (w->next_node <= w->ex->neq)
        w->next_node = w->ex->neq + 1;
    ns_bridge_extract_users_name(w, inst, name, sizeof name);
    expression_reader r = {.read = ns_bridge_expression_read,
                           .w = w,
                           .b = b,
                           .root = root,
                           .p = {.circuit = w->ex->circuit,
                                 .name = name,
                                 .next_node = &w->next_node,
                                 .time_node = w->time_node,
                                 .time_scale = stop_of(w)}};
    const ns_piecewise_value *v = ns_bridge_expression_read(&r, root);
    int status = v && ns_bridge_piecewise_affine(&r.p, v, &u) ? add_source(&r, inst, &u, factor)
                                                              : refuse_node(&r, inst);
    ns_bridge_expression_mix(w, root, 0);
    ns_bridge_extract_mix(w, &factor, sizeof factor);
    ns_bridge_piecewise_free(&r.p);
    return status;
}
