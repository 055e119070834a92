/* tests/stress/effort.h - what a program did, as one number that a busy machine does not change. */
#ifndef NONSMOOTH_TESTS_EFFORT_H
#define NONSMOOTH_TESTS_EFFORT_H

/* Instructions that this process (not those that it forked) executed outside of the kernel since it first
 * asked; 0 where the kernel does not count them. */
double effort_so_far(void);

#endif
