/* tests/bench/facts.h - single figures that one program measures and the last table (bench_goals.c) shows. */
#ifndef NONSMOOTH_TESTS_FACTS_H
#define NONSMOOTH_TESTS_FACTS_H

/* Appends a line to build/bench/facts.csv: what was measured (no comma in it), its number. */
void fact_put(const char *what, double value);

/* The last one of this name, NAN: there is none. */
double fact_get(const char *what);

/* Of times (or bytes) that grow as size^e: the exponent e of the best fit on logarithmic axes; NAN below two
 * points. */
double growth(int count, const double *size, const double *value);

#endif
