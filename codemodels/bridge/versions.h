/* bridge/versions.h - what differs between ngspice 39 and 47, one feature after another.
 *
 * NGSPICE_MAJOR is of the headers: the Makefile reads it from their config.h.  The other files of the bridge
 * ask for a feature and name no version. */
#ifndef BRIDGE_VERSIONS_H
#define BRIDGE_VERSIONS_H

#include "ngspice.h"

#include "ngspice/hash.h"
#include "ngspice/spmatrix.h"
#include "pure/source_signal.h"

#include "maths/sparse/spdefs.h"
#include "spicelib/devices/isrc/isrcdefs.h"
#include "spicelib/devices/vsrc/vsrcdefs.h"

#ifndef NGSPICE_MAJOR
#error "NGSPICE_MAJOR is not defined: the Makefile reads it from ngspice's config.h"
#endif
#if !defined TYPE_CSW || !defined TYPE_DIO || !defined TYPE_MOS1 || !defined TYPE_MOS3 ||                    \
    !defined TYPE_SW || !defined TYPE_VDMOS || !defined TYPE_VSRC
#error "TYPE_DIO and others are not defined: the Makefile reads them from ngspice's dev.c"
#endif

/* --- with CIDER: a call after each point that is shown; without, the accept before it is the last one --- */

static inline void ns_bridge_versions_hook_shown(SPICEdev *type, void (*shown)(GENmodel *, CKTcircuit *)) {
#ifdef CIDER
    type->DEVdump = shown;
#else
    (void)type;
    (void)shown;
#endif
}

static inline int ns_bridge_versions_hooks_shown(void) {
#ifdef CIDER
    return 1;
#else
    return 0;
#endif
}

/* --- 42: SMPmatrix is a struct with the matrix of Sparse and, where KLU was configured, that of KLU --- */

static inline const struct MatrixFrame *ns_bridge_versions_sparse(const SMPmatrix *matrix) {
#if NGSPICE_MAJOR >= 42
    return matrix->SPmatrix;
#else
    return matrix;
#endif
}

/* 1 if that many functions in ngspice's table for code models, beyond those of the headers, are what KLU adds
 * to it, which the headers do not have. */
static inline int ns_bridge_versions_more_of_klu(int more) {
#ifdef KLU
    (void)more;
    return 0;
#else
    enum { OF_KLU = 3 };
    return NGSPICE_MAJOR >= 42 && more == OF_KLU;
#endif
}

/* KLU's matrix by columns; indices from 0, all arrays are ngspice's. */
typedef struct ns_versions_klu {
    int n;
    const int *column;      /* n + 1: where a column begins in row and element */
    const int *row;         /* of an element */
    double *element;        /* its value */
    const unsigned *number; /* n + 1: ngspice's equation of an index, which is that of the next element */
} ns_versions_klu;

/* 1 if KLU solves, and *klu is its matrix. */
static inline int ns_bridge_versions_klu(const SMPmatrix *matrix, ns_versions_klu *klu) {
#ifdef KLU
    const KLUmatrix *m = matrix->SMPkluMatrix;
    if (!matrix->CKTkluMODE)
        return 0;
    *klu = (ns_versions_klu){(int)m->KLUmatrixN, m->KLUmatrixAp, m->KLUmatrixAi, m->KLUmatrixAx,
                             m->KLUmatrixNodeCollapsingNewToOld};
    return 1;
#else
    (void)matrix;
    (void)klu;
    return 0;
#endif
}

/* --- with RFSPICE: V may be a port --- */

static inline int ns_bridge_versions_is_port(const VSRCinstance *v) {
#ifdef RFSPICE
    return v->VSRCisPort;
#else
    (void)v;
    return 0;
#endif
}

/* --- 43: devices are looked up by the text of their names; before, by its address --- */

static inline nghash_compare_func_t *ns_bridge_versions_compare_names(void) {
    return NGSPICE_MAJOR >= 43 ? NGHASH_DEF_CMP(NGHASH_FUNC_STR) : NGHASH_DEF_CMP(NGHASH_FUNC_PTR);
}

/* 0 if they are the same. */
static inline int ns_bridge_versions_names_differ(const void *name, const void *wanted) {
    return NGSPICE_MAJOR >= 43 ? strcmp(name, wanted) != 0 : name != wanted;
}

/* --- 46: .options newtrunc estimates errors from voltages, and does not ask DEVtrunc --- */

static inline void ns_bridge_versions_no_newtrunc(CKTcircuit *ckt) {
#if NGSPICE_MAJOR >= 46
    ckt->CKTnewtrunc = 0;
#else
    (void)ckt;
#endif
}

/* --- 46, 47: what PULSE takes for parameters that are missing, zero or negative --- */

#ifndef PULSE_OF
#define PULSE_OF NGSPICE_MAJOR /* a test builds with another one: the difference must be seen */
#endif

static inline ns_source_pulse ns_bridge_versions_pulse(int is_current) {
    return PULSE_OF >= 47 ? PULSE_OF_47 : PULSE_OF == 46 && !is_current ? PULSE_OF_46 : PULSE_OF_39;
}

/* --- 47: I has r= and td= of PWL --- */

static inline void ns_bridge_versions_pwl_of_current(const ISRCinstance *i, ns_source *s) {
#if NGSPICE_MAJOR >= 47
    s->repeats = i->ISRCrGiven;
    s->repeat_index = i->ISRCrBreakpt;
    s->delay = i->ISRCrdelay;
#else
    (void)i;
    (void)s;
#endif
}

#endif
