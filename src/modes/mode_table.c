/* src/modes/mode_table.c - a hash table by mode and length of step, with the order in which entries were
 * asked for. */
#include "mode_table.h"

#include <string.h>

unsigned long long ns_modes_table_key(int m, double h, const ns_mode *mode) {
    unsigned long long key = 14695981039346656037U, bits; /* FNV-1a */
    memcpy(&bits, &h, sizeof bits);
    key = (key ^ bits) * 1099511628211U;
    for (int j = 0; j < m; j++)
        key = (key ^ (unsigned char)mode[j]) * 1099511628211U;
    key = (key ^ (key >> 32)) * 11400714819323198485U; /* lengths h 2^-k differ in high bits alone */
    key ^= key >> 32;
    return key ? key : 1;
}

static ns_mode_entry **bucket_of(ns_mode_table *t, unsigned long long key) {
    return &t->bucket[key % NS_MODE_BUCKETS];
}

static void unlink_age(ns_mode_table *t, ns_mode_entry *e) {
    *(e->older ? &e->older->newer : &t->oldest) = e->newer;
    *(e->newer ? &e->newer->older : &t->newest) = e->older;
}

static void link_newest(ns_mode_table *t, ns_mode_entry *e) {
    e->older = t->newest;
    e->newer = NULL;
    *(t->newest ? &t->newest->newer : &t->oldest) = e;
    t->newest = e;
}

ns_mode_entry *ns_modes_table_find(ns_mode_table *t, unsigned long long key, double h, const ns_mode *mode) {
    ns_mode_entry *e = *bucket_of(t, key);
    while (e && !(e->key == key && e->h == h && memcmp(e->mode, mode, (size_t)t->m) == 0))
        e = e->chain;
    if (e && e != t->newest) {
        unlink_age(t, e);
        link_newest(t, e);
    }
    return e;
}

void ns_modes_table_insert(ns_mode_table *t, ns_mode_entry *e) {
    ns_mode_entry **bucket = bucket_of(t, e->key);
    e->chain = *bucket;
    *bucket = e;
    link_newest(t, e);
    t->bytes += e->bytes;
}

static void drop_entry(ns_mode_table *t, ns_mode_entry *e) {
    ns_mode_entry **at = bucket_of(t, e->key);
    while (*at != e)
        at = &(*at)->chain;
    *at = e->chain;
    unlink_age(t, e);
    t->bytes -= e->bytes;
    t->free_entry(t->owner, e);
}

long ns_modes_table_trim(ns_mode_table *t, const ns_mode_entry *keep) {
    long dropped = 0;
    for (ns_mode_entry *e = t->oldest, *next; e && t->bytes > t->limit; e = next) {
        next = e->newer;
        if (e == keep)
            continue;
        drop_entry(t, e);
        dropped++;
    }
    return dropped;
}

void ns_modes_table_clear(ns_mode_table *t) {
    while (t->oldest)
        drop_entry(t, t->oldest);
}
