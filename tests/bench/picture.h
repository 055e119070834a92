/* tests/bench/picture.h - data and scripts for gnuplot. */
#ifndef NONSMOOTH_TESTS_PICTURE_H
#define NONSMOOTH_TESTS_PICTURE_H

#include "report.h"

/* Writes folder/NAME.dat and .gp: time against error. */
void picture_case(const bench_case *c, const char *folder, int count, const row *rows);

/* folder/NAME.END for writing; ends the program if it cannot be. */
FILE *picture_create(const char *folder, const char *name, const char *end);

/* How a series is drawn, always alike: colour and symbol as gnuplot has them. */
const char *picture_style(const char *series);

/* The head of a script: terminal, output folder/NAME.png, grid, a key beside the drawing. */
void picture_head(FILE *gp, const char *folder, const char *name);

#endif
