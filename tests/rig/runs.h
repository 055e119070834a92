/* tests/rig/runs.h - how many random cases a test runs. */
#ifndef RUNS_H
#define RUNS_H

/* The address sanitizer takes ten times as long: an eighth of the cases goes there, all of them in the plain
 * build. */
#ifdef __SANITIZE_ADDRESS__
#define FEWER_IF_SANITIZED(N) ((N) / 8)
#else
#define FEWER_IF_SANITIZED(N) (N)
#endif

#endif
