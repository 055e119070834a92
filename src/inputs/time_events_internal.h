/* src/inputs/time_events_internal.h - a schedule from inside: time_events_create.c makes it, time_events.c
 * walks it. */
#ifndef NS_INPUTS_TIME_EVENTS_INTERNAL_H
#define NS_INPUTS_TIME_EVENTS_INTERNAL_H

#include "switch_times.h"
#include "time_events.h"

/* Of the heap. */
typedef struct ns_entry {
    double t;
    int id; /* lines, then terms, then commands */
} ns_entry;

struct ns_time_events {
    const ns_system *s;
    ns_broken_line *pieces; /* nz; of lines */
    int lines;
    ns_line_cursor *run; /* lines that enter, */
    int *input;          /* whose they are; after them the curves that enter */
    int entering;
    double *base; /* entering; of the curves */
    int terms, waves;
    ns_wave_term *term;
    unsigned char *begun; /* terms */
    ns_wave *wave;
    int commands;
    ns_switch_times *command;
    int *command_index; /* which of the system's */
    int *flipped;       /* commands: how often in this instant */
    int *touched;       /* commands: some of them are in this instant */
    int count;
    ns_entry *heap;
    double now;
    unsigned char *closed; /* nc */
    ns_time_event instant;
    int *changed, *flip; /* the lists of the instant */
};

#endif
