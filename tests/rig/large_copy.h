/* tests/rig/large_copy.h - a system with arrays as one with sparse matrices. */
#ifndef NONSMOOTH_TESTS_LARGE_COPY_H
#define NONSMOOTH_TESTS_LARGE_COPY_H

#include "nonsmooth/system.h"

ns_system *large_copy(const ns_system *s);

#endif
