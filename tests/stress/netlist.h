/* tests/stress/netlist.h - a netlist as lines of text: the one description that library and ngspice share. */
#ifndef NONSMOOTH_TESTS_NETLIST_H
#define NONSMOOTH_TESTS_NETLIST_H

#include <stdio.h>

typedef struct netlist {
    int count, room;
    char **line; /* count; without newline; the first is the title */
} netlist;

/* Appends a line. */
void netlist_put(netlist *n, const char *format, ...) __attribute__((format(printf, 2, 3)));
void netlist_drop(netlist *n, int at);                  /* takes a line out */
void netlist_set(netlist *n, int at, const char *line); /* puts another line in its place */
netlist netlist_copy(const netlist *n);
void netlist_free(netlist *n);
int netlist_read(netlist *n, FILE *file); /* appends all lines; 0: there were some */
void netlist_write(const netlist *n, FILE *file);

#endif
