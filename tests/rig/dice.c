/* tests/rig/dice.c - Steele, Lea and Flood's splitmix64, and what is drawn with it. */
#include "dice.h"

#include <math.h>

static unsigned long long next(dice *d) {
    unsigned long long z = (d->state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

dice dice_make(unsigned stream, unsigned long long number) {
    dice d = {.state = ((unsigned long long)stream << 48) ^ number};
    d.state = next(&d); /* neighbouring numbers would otherwise share a sequence, shifted */
    return d;
}

double dice_uniform(dice *d) {
    return (double)(next(d) >> 11) / 9007199254740992.0; /* 2^53 */
}

double dice_either(dice *d) {
    return 2.0 * dice_uniform(d) - 1.0;
}

int dice_below(dice *d, int n) {
    return (int)(dice_uniform(d) * n);
}

int dice_chance(dice *d, double p) {
    return dice_uniform(d) < p;
}

double dice_decades(dice *d, double lo, double hi) {
    return pow(10.0, lo + (hi - lo) * dice_uniform(d));
}

int dice_size(dice *d, int lo, int hi) {
    int n = (int)(lo * pow((hi + 1.0) / lo, dice_uniform(d)));
    return n < lo ? lo : n > hi ? hi : n;
}

double dice_eighths(dice *d, int most) {
    return (dice_below(d, 16 * most + 1) - 8 * most) / 8.0;
}

double dice_integer(dice *d, int most) {
    return dice_below(d, 2 * most + 1) - most;
}
