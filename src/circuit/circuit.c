/* src/circuit/circuit.c - the circuit object: nodes, names, messages; elements.c fills it. */
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "circuit_internal.h"

int ns_circuit_create(ns_circuit **out) {
    if (!out) {
        return NS_E_NULL;
    }
    *out = calloc(1, sizeof **out);
    return *out ? NS_OK : NS_E_MEMORY;
}

static void free_element(element *e) {
    free(e->name);
    free(e->terms);
    ns_system_signal_release(&e->signal);
}

void ns_circuit_free(ns_circuit *c) {
    if (!c) {
        return;
    }
    for (int i = 0; i < c->nelements; i++) {
        free_element(&c->element[i]);
    }
    for (int i = 0; i < c->nnodes; i++) {
        free(c->node[i].name);
    }
    free(c->element);
    free(c->names.slot);
    free(c->node);
    free(c);
}

const char *ns_circuit_message(const ns_circuit *c) {
    return c ? c->message : "";
}

int ns_circuit_complain(ns_circuit *c, int status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(c->message, sizeof c->message, format, arguments); /* callers cut names to 80 letters */
    va_end(arguments);
    for (char *p = c->message; *p; p++) {
        if ((unsigned char)*p < ' ') {
            *p = '?'; /* one line, whatever a name holds */
        }
    }
    return status;
}

/* Room for `more` entries of `size` bytes behind `count`; NULL where there is none, then items stands. */
static void *reserve(void *items, int count, int more, size_t size, size_t *room) {
    size_t want = (size_t)count + (size_t)more, enough = *room;
    void *grown;
    if (want <= *room && items) {
        return items;
    }
    while (enough < want) {
        enough = 2 * enough + 8;
    }
    if (want > INT_MAX / 4 || enough > SIZE_MAX / size) {
        return NULL;
    }
    grown = realloc(items, enough * size);
    if (grown) {
        *room = enough;
    }
    return grown;
}

static int reserve_nodes(ns_circuit *c, int more) {
    node_info *grown = reserve(c->node, c->nnodes, more, sizeof *grown, &c->node_room);
    c->node = grown ? grown : c->node;
    return grown != NULL;
}

static int reserve_element(ns_circuit *c) {
    element *grown = reserve(c->element, c->nelements, 1, sizeof *grown, &c->element_room);
    c->element = grown ? grown : c->element;
    return grown != NULL;
}

static char *copy_text(const char *text) {
    size_t bytes = strlen(text) + 1;
    char *copy = malloc(bytes);
    return copy ? memcpy(copy, text, bytes) : NULL;
}

int ns_circuit_find_node(const ns_circuit *c, int number, int *found) {
    int low = 0, high = c->nnodes;
    /* where it is if no number is left out */
    const int place = high > 0 && number > 0 ? number - c->node[0].number : -1;
    if (place >= 0 && place < high && c->node[place].number == number) {
        *found = 1;
        return place;
    }
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (c->node[middle].number < number) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    *found = low < c->nnodes && c->node[low].number == number;
    return low;
}

/* The node, made if there is none yet; room must have been reserved. */
static node_info *have_node(ns_circuit *c, int number) {
    int found, i = ns_circuit_find_node(c, number, &found);
    if (!found) {
        memmove(&c->node[i + 1], &c->node[i], (size_t)(c->nnodes - i) * sizeof *c->node);
        c->node[i] =
            (node_info){number, 0, i > 0 ? c->node[i - 1].unknown + c->node[i - 1].used : 0, NULL, NAN};
        c->nnodes++;
    }
    return &c->node[i];
}

int ns_circuit_name_node(ns_circuit *c, int node, const char *name) {
    char *copy;
    node_info *which;
    if (!c) {
        return NS_E_NULL;
    }
    if (!name) {
        return ns_circuit_complain(c, NS_E_NULL, "node %d: its name is missing", node);
    }
    if (node < 0) {
        return ns_circuit_complain(c, NS_E_SIZE, "%.80s: number of node = %d must be at least 0", name, node);
    }
    if (node == 0) {
        return NS_OK; /* ground appears in no message */
    }
    copy = copy_text(name);
    if (!copy || !reserve_nodes(c, 1)) {
        free(copy);
        return ns_circuit_complain(c, NS_E_MEMORY, "node %d: out of memory", node);
    }
    which = have_node(c, node);
    free(which->name);
    which->name = copy;
    return NS_OK;
}

int ns_circuit_node_ic(ns_circuit *c, int node, double volts) {
    if (!c) {
        return NS_E_NULL;
    }
    if (node <= 0) {
        return ns_circuit_complain(c, NS_E_SIZE, "node %d: only nodes above 0 take an initial voltage", node);
    }
    if (!isfinite(volts)) {
        return ns_circuit_complain(c, NS_E_NUMBER, "node %d: ic = %g must be a finite number", node, volts);
    }
    if (!reserve_nodes(c, 1)) {
        return ns_circuit_complain(c, NS_E_MEMORY, "node %d: out of memory", node);
    }
    have_node(c, node)->ic = volts;
    return NS_OK;
}

/* *copy becomes e with name, terms and arrays of its own; on failure nothing is left behind. */
static int copy_element(const element *e, element *copy) {
    size_t bytes = (size_t)e->nterms * sizeof *e->terms;
    *copy = *e;
    copy->name = copy_text(e->name);
    copy->terms = bytes > 0 ? malloc(bytes) : NULL;
    if (!copy->name || (bytes > 0 && !copy->terms) || ns_system_signal_copy(&e->signal, &copy->signal)) {
        free(copy->name);
        free(copy->terms);
        return NS_E_MEMORY;
    }
    if (bytes > 0) {
        memcpy(copy->terms, e->terms, bytes);
    }
    return NS_OK;
}

static void use_node(ns_circuit *c, int number) {
    if (number > 0) {
        node_info *which = have_node(c, number);
        if (!which->used) {
            which->used = 1;
            c->nused++;
            while (++which < c->node + c->nnodes) {
                which->unknown++;
            }
        }
    }
}

/* The next `wanted` numbers of a counter: the first of them, -1 if none are wanted. */
static int take(int *counter, int wanted) {
    int first = *counter;
    *counter += wanted;
    return wanted > 0 ? first : -1;
}

/* Puts e, whose arrays become the circuit's, at the end; room must have been reserved. */
static void commit(ns_circuit *c, element *e, needs wants) {
    e->current = take(&c->ncurrents, wants.currents);
    e->pair = take(&c->npairs, wants.pairs);
    e->input = take(&c->ninputs, wants.inputs);
    e->command = take(&c->ncommands, wants.commands);
    for (int i = 0; i < e->nnodes; i++) {
        use_node(c, e->node[i]);
    }
    for (int i = 0; i < e->nterms; i++) {
        if (!e->terms[i].is_current) {
            use_node(c, e->terms[i].of);
        }
    }
    c->element[c->nelements++] = *e;
    ns_circuit_enter_name(c);
}

int ns_circuit_add_element(ns_circuit *c, const element *e, needs wants, int *id) {
    element copy;
    if (!reserve_element(c) || !reserve_nodes(c, e->nnodes + e->nterms) || ns_circuit_reserve_name(c) ||
        copy_element(e, &copy)) {
        return ns_circuit_complain(c, NS_E_MEMORY, "%.80s: out of memory", e->name);
    }
    commit(c, &copy, wants);
    if (id) {
        *id = c->nelements - 1;
    }
    return NS_OK;
}

int ns_circuit_node_unknown(const ns_circuit *c, int node) {
    int found, place;
    if (!c) {
        return -1;
    }
    place = ns_circuit_find_node(c, node, &found);
    return found && c->node[place].used ? c->node[place].unknown : -1;
}

int ns_circuit_input(const ns_circuit *c, int id) {
    return c && id >= 0 && id < c->nelements ? c->element[id].input : -1;
}

int ns_circuit_pair(const ns_circuit *c, int id) {
    return c && id >= 0 && id < c->nelements ? c->element[id].pair : -1;
}

int ns_circuit_current_unknown(const ns_circuit *c, int id) {
    if (!c || id < 0 || id >= c->nelements || c->element[id].current < 0) {
        return -1;
    }
    return c->nused + c->element[id].current;
}
