/* tests/stress/stock.h - a netlist with ngspice's own models in place of the ideal devices. */
#ifndef NONSMOOTH_TESTS_STOCK_H
#define NONSMOOTH_TESTS_STOCK_H

#include "plan.h"

/* A setting of ngspice.  Diodes are its sidiode, or D with an emission coefficient; switches are S. */
typedef struct stock_setting {
    double n;       /* of D; 0: sidiode */
    double reltol;  /* of the options */
    double longest; /* step, in those of .tran */
    int gear;
} stock_setting;

enum { STOCK_SETTINGS = 36 };
stock_setting stock_setting_of(int number); /* 0 ... STOCK_SETTINGS - 1 */
void stock_name(const stock_setting *s, char *name, size_t size);

/* vf, ron, roff, vt and vh are those of the ideal devices; a ron of 0 is 1 mohm, an infinite roff 1 Gohm. */
netlist stock_netlist(const netlist *n, const plan *p, const stock_setting *s);

#endif
