/* src/engine/schedule_inside.h - a schedule from inside: schedule_make.c makes it, schedule.c walks it. */
#ifndef NS_SCHEDULE_INSIDE_H
#define NS_SCHEDULE_INSIDE_H

#include "schedule.h"
#include "timed.h"

/* Of the heap. */
typedef struct ns_entry {
    double t;
    int id; /* lines, then terms, then commands */
} ns_entry;

struct ns_schedule {
    const ns_system *s;
    ns_pieces *pieces; /* nz; of lines */
    int lines;
    ns_run *run; /* lines that enter, */
    int *input;  /* whose they are; after them the curves that enter */
    int entering;
    double *base; /* entering; of the curves */
    int terms, waves;
    ns_wave_term *term;
    unsigned char *begun; /* terms */
    ns_wave *wave;
    int commands;
    ns_timed *command;
    int *command_index; /* which of the system's */
    int *flipped;       /* commands: how often in this instant */
    int *touched;       /* commands: some of them are in this instant */
    int count;
    ns_entry *heap;
    double now;
    unsigned char *closed; /* nc */
    ns_instant instant;
    int *changed, *flip; /* the lists of the instant */
};

#endif
