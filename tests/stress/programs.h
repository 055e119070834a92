/* tests/stress/programs.h - what the stress programs share. */
#ifndef NONSMOOTH_TESTS_PROGRAMS_H
#define NONSMOOTH_TESTS_PROGRAMS_H

#include "maker.h"

/* The lists of all classes; NULL after the last one. */
extern const family *const families_all[];

/* Circuit `number` of a class.  One in five is as ideal as dice will have it. */
void family_circuit(const family *f, unsigned long long number, netlist *n);

/* A number of the environment, else `without`. */
double number_of(const char *name, double without);

#endif
