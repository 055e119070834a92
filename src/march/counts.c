/* src/march/counts.c - what several engines cost, added up. */
#include "march_internal.h"

void ns_march_add_counts(ns_counts *sum, const ns_counts *counts) {
    const long *from = (const long *)(const void *)counts;
    long *to = (long *)(void *)sum;
    for (size_t i = 0; i < sizeof *counts / sizeof *from; i++)
        to[i] += from[i];
}
