/* tests/stress/netlist.c - lines of text. */
#define _POSIX_C_SOURCE 200809L
#include "netlist.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static void *must(void *p) {
    if (!p)
        abort();
    return p;
}

static void append(netlist *n, char *line) {
    if (n->count == n->room) {
        n->room = 2 * n->room + 32;
        n->line = must(realloc(n->line, (size_t)n->room * sizeof *n->line));
    }
    n->line[n->count++] = line;
}

void netlist_put(netlist *n, const char *format, ...) {
    char line[1024];
    va_list list;
    va_start(list, format);
    vsnprintf(line, sizeof line, format, list);
    va_end(list);
    append(n, must(strdup(line)));
}

void netlist_drop(netlist *n, int at) {
    free(n->line[at]);
    memmove(n->line + at, n->line + at + 1, (size_t)(n->count - at - 1) * sizeof *n->line);
    n->count--;
}

void netlist_set(netlist *n, int at, const char *line) {
    char *copy = must(strdup(line));
    free(n->line[at]);
    n->line[at] = copy;
}

netlist netlist_copy(const netlist *n) {
    netlist copy = {0};
    for (int i = 0; i < n->count; i++)
        append(&copy, must(strdup(n->line[i])));
    return copy;
}

void netlist_free(netlist *n) {
    for (int i = 0; i < n->count; i++)
        free(n->line[i]);
    free(n->line);
    *n = (netlist){0};
}

int netlist_read(netlist *n, FILE *file) {
    char line[1024];
    const int before = n->count;
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "\r\n")] = 0;
        netlist_put(n, "%s", line);
    }
    return n->count == before;
}

void netlist_write(const netlist *n, FILE *file) {
    for (int i = 0; i < n->count; i++)
        fprintf(file, "%s\n", n->line[i]);
}
