/* tests/bench/precision.h - the picture of README: run time against error, four circuits. */
#ifndef NONSMOOTH_TESTS_PRECISION_H
#define NONSMOOTH_TESTS_PRECISION_H

/* Writes folder/precision.dat and .gp, which draws folder/precision.svg, from the CSV files of the cases;
 * those that were not run are left out.  Writes nothing if none was. */
void precision_picture(const char *folder);

#endif
