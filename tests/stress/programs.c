/* tests/stress/programs.c - what the stress programs share. */
#include "programs.h"

#include <stdlib.h>

const family *const families_all[] = {families_dcdc,      families_isolated, families_rectifiers,
                                      families_inverters, families_pumps,    families_control,
                                      families_random,    families_ties,     NULL};

void family_circuit(const family *f, unsigned long long number, netlist *n) {
    maker m;
    maker_begin(&m, n, f->name, number);
    if (number % 5 == 4)
        maker_ideality(&m);
    f->make(&m);
    maker_end(&m);
}

double number_of(const char *name, double without) {
    const char *s = getenv(name);
    return s && *s ? strtod(s, NULL) : without;
}
