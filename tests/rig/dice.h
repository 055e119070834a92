/* tests/rig/dice.h - random numbers that any machine draws alike: a problem is its seed. */
#ifndef NONSMOOTH_TESTS_DICE_H
#define NONSMOOTH_TESTS_DICE_H

typedef struct dice {
    unsigned long long state;
} dice;

dice dice_make(unsigned stream, unsigned long long number); /* far from those of other numbers */
double dice_uniform(dice *d);                               /* in [0,1) */
double dice_either(dice *d);                                /* in [-1,1) */
int dice_below(dice *d, int n);                             /* 0 .. n-1 */
int dice_chance(dice *d, double p);                         /* 1 with probability p */
double dice_decades(dice *d, double lo, double hi);         /* 10^lo .. 10^hi, logarithms evenly spread */
int dice_size(dice *d, int lo, int hi);                     /* lo .. hi, logarithms evenly spread */
double dice_eighths(dice *d, int most); /* k/8, |k| <= 8 most: sums of products are exact */
double dice_integer(dice *d, int most); /* |k| <= most */

#endif
