/* src/modes/mode_table.h - what was made for a mode and a length of step, found again by a hash; beyond a
 * bound on memory what was asked for least recently is dropped. */
#ifndef NS_MODES_MODE_TABLE_H
#define NS_MODES_MODE_TABLE_H

#include <stddef.h>

#include "mode.h"

/* The first member of what is kept. */
typedef struct ns_mode_entry ns_mode_entry;
struct ns_mode_entry {
    double h;               /* length of the step, s */
    ns_mode *mode;          /* m */
    unsigned long long key; /* of both */
    size_t bytes;           /* of all that is kept */
    ns_mode_entry *chain;   /* the next one of the same bucket */
    ns_mode_entry *older, *newer;
};

enum { NS_MODE_BUCKETS = 256 };

typedef struct ns_mode_table {
    int m;
    size_t limit;                                      /* bound on bytes */
    size_t bytes;                                      /* of all entries */
    void (*free_entry)(void *owner, ns_mode_entry *e); /* frees an entry and all it owns */
    void *owner;                                       /* passed to it */
    ns_mode_entry *bucket[NS_MODE_BUCKETS], *oldest, *newest;
} ns_mode_table;

/* A hash of both, never 0. */
unsigned long long ns_modes_table_key(int m, double h, const ns_mode *mode);

/* The entry of both, from now on the newest; NULL: there is none. */
ns_mode_entry *ns_modes_table_find(ns_mode_table *t, unsigned long long key, double h, const ns_mode *mode);
void ns_modes_table_insert(ns_mode_table *t, ns_mode_entry *e); /* as the newest */

/* Drops the oldest entries but `keep` until the bytes are within the limit; how many. */
long ns_modes_table_trim(ns_mode_table *t, const ns_mode_entry *keep);
void ns_modes_table_clear(ns_mode_table *t);

#endif
