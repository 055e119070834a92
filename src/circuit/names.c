/* src/circuit/names.c - elements found by their names, by a hash table. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "circuit_internal.h"

/* FNV-1a */
static size_t hash(const char *name) {
    uint64_t h = 14695981039346656037U;
    for (; *name; name++) {
        h = (h ^ (unsigned char)*name) * 1099511628211U;
    }
    return (size_t)(h ^ (h >> 32));
}

/* Where the name is, or the empty slot where it would go.  There is one: the table is at most half full. */
static size_t slot_of(const ns_circuit *c, const char *name) {
    size_t at = hash(name) & (c->names.size - 1);
    while (c->names.slot[at] && strcmp(c->element[c->names.slot[at] - 1].name, name) != 0) {
        at = (at + 1) & (c->names.size - 1);
    }
    return at;
}

int ns_circuit_find_name(const ns_circuit *c, const char *name) {
    return c->names.size > 0 ? c->names.slot[slot_of(c, name)] - 1 : -1;
}

int ns_circuit_reserve_name(ns_circuit *c) {
    const size_t want = 2 * ((size_t)c->nelements + 1);
    size_t size = c->names.size > 0 ? c->names.size : 16;
    if (want <= c->names.size) {
        return NS_OK;
    }
    while (size < want) {
        size *= 2;
    }
    int *slot = calloc(size, sizeof *slot);
    if (!slot) {
        return NS_E_MEMORY;
    }
    free(c->names.slot);
    c->names = (name_table){slot, size};
    for (int i = 0; i < c->nelements; i++) {
        slot[slot_of(c, c->element[i].name)] = i + 1;
    }
    return NS_OK;
}

void ns_circuit_enter_name(ns_circuit *c) {
    c->names.slot[slot_of(c, c->element[c->nelements - 1].name)] = c->nelements;
}
