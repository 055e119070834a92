/* tests/rig/retries.h - marches whose results were found wrong on the way. */
#ifndef RETRIES_H
#define RETRIES_H

#include "nonsmooth.h"

enum { ANY_RETRIES = 1000000 };

/* So many marches that end from now on may have such results; without it none. */
void allow_retries(long marches);

#endif
