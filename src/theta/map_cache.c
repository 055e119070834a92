/* src/theta/map_cache.c - kept maps: a hash table by (h, kind, mode) with a bound on memory.
 * The least recently used map is dropped first. */
#include "theta_internal.h"

#include <stdint.h>
#include <string.h>

static unsigned bucket_of(double h, int implicit, const ns_mode *mode, int m) {
    uint64_t bits, hash;
    memcpy(&bits, &h, sizeof bits);
    hash = (bits ^ (uint64_t)implicit) * 0x9E3779B97F4A7C15u;
    for (int j = 0; j < m; j++)
        hash = (hash ^ (uint64_t)(mode[j] + 1)) * 0x100000001B3u; /* FNV-1a's multiplier */
    return (unsigned)((hash ^ (hash >> 32)) % NS_BUCKETS);
}

static void unlink_age(ns_cache *c, ns_map *map) {
    *(map->older ? &map->older->newer : &c->oldest) = map->newer;
    *(map->newer ? &map->newer->older : &c->newest) = map->older;
    map->older = map->newer = NULL;
}

static void link_newest(ns_cache *c, ns_map *map) {
    map->older = c->newest;
    *(c->newest ? &c->newest->newer : &c->oldest) = map;
    c->newest = map;
}

ns_map *ns_theta_cache_find(ns_cache *c, double h, int implicit, const ns_mode *mode, int m) {
    ns_map *map = c->bucket[bucket_of(h, implicit, mode, m)];
    while (map && !(map->h == h && map->implicit == implicit && memcmp(map->mode, mode, (size_t)m) == 0))
        map = map->chain;
    if (map) {
        unlink_age(c, map);
        link_newest(c, map);
    }
    return map;
}

void ns_theta_cache_insert(ns_cache *c, ns_map *map, int m) {
    ns_map **head = &c->bucket[bucket_of(map->h, map->implicit, map->mode, m)];
    map->chain = *head;
    *head = map;
    link_newest(c, map);
    c->bytes += map->bytes;
}

static void drop_map(ns_cache *c, ns_map *map, int m) {
    ns_map **at = &c->bucket[bucket_of(map->h, map->implicit, map->mode, m)];
    while (*at != map)
        at = &(*at)->chain;
    *at = map->chain;
    unlink_age(c, map);
    c->bytes -= map->bytes;
    ns_theta_map_free(map);
}

long ns_theta_cache_trim(ns_cache *c, int m, const ns_map *keep) {
    long dropped = 0;
    ns_map *map = c->oldest;
    while (map && c->bytes > c->limit) {
        ns_map *next = map->newer;
        if (map != keep) {
            drop_map(c, map, m);
            dropped++;
        }
        map = next;
    }
    return dropped;
}

void ns_theta_cache_clear(ns_cache *c) {
    for (ns_map *map = c->oldest, *next; map; map = next) {
        next = map->newer;
        ns_theta_map_free(map);
    }
    if (c->oldest)
        memset(c->bucket, 0, sizeof c->bucket);
    c->newest = c->oldest = NULL;
    c->bytes = 0;
}
