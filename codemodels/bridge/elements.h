/* bridge/elements.h - the readers of single elements, one a SPICE letter. */
#ifndef BRIDGE_ELEMENTS_H
#define BRIDGE_ELEMENTS_H

#include "extract.h"

enum { EXTRACT_LATER = 1000, EXTRACT_REFUSED = 1001 }; /* besides the statuses of the library */

/* What a reader of one element sees. */
typedef struct extract_walk {
    CKTcircuit *ckt;
    extract *ex;
    int dc;                     /* sources stand for their DC values */
    double tstep, tstop;        /* .tran's, for the defaults of sources */
    const MIFinstance *options; /* of model nonsmooth, once one was read */
} extract_walk;

/* Reads one instance: NS_OK, EXTRACT_LATER (an element it refers to was not read yet), EXTRACT_REFUSED
 * (the line is written), or a status of the library. */
typedef int extract_reader(extract_walk *w, GENinstance *inst);

extract_reader extract_resistor, extract_capacitor, extract_inductor, extract_coupling; /* elements.c */
extract_reader extract_vcvs, extract_vccs, extract_cccs, extract_ccvs;                  /* elements.c */
extract_reader extract_vsource, extract_isource;                                        /* sources.c */
extract_reader extract_behavioural;                                                     /* behavioural.c */

/* Refuses inst: writes "<name>: <what>". */
int extract_refuse(extract_walk *w, const GENinstance *inst, const char *what);

/* Says that equation eq (0: none) stands for the current of element id. */
void extract_current(extract_walk *w, int eq, int id);

/* Mixes bytes into the hash. */
void extract_mix(extract_walk *w, const void *bytes, size_t size);

#endif
