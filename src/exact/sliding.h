/* src/exact/sliding.h - modes in which a switch slides. */
#ifndef NS_EXACT_SLIDING_H
#define NS_EXACT_SLIDING_H

#include "mode_kernel.h"

int ns_exact_sliding_count(const ns_mode *mode, int m);

/* As ns_theta_map_build(), implicit; pairs may slide. */
int ns_exact_sliding_map(ns_theta *s, double g, const ns_mode *mode, ns_map **out);

/* Two guards of each sliding pair, by input of its map: sign lambda, which else opens the switch, and -sign
 * y, which else closes it; row, noise: the first of them, `rows` apart. */
void ns_exact_sliding_fill(const ns_theta *s, const ns_map *map, const ns_mode *mode, int rows, double *row,
                           double *noise);

#endif
