/* src/inputs/time_events_internal.h - time events from inside: time_events_create.c makes them,
 * time_events.c goes from one to the next. */
#ifndef NS_INPUTS_TIME_EVENTS_INTERNAL_H
#define NS_INPUTS_TIME_EVENTS_INTERNAL_H

#include "switch_times.h"
#include "time_events.h"

/* Of the heap: when entry id has its next event. */
typedef struct ns_entry {
    double t;
    int id; /* lines, then terms, then commands */
} ns_entry;

struct ns_time_events {
    const ns_system *s;
    /* inputs that enter: first the broken lines, then the curves (SIN, EXP) */
    int lines, entering;    /* how many are lines; how many there are */
    int *input;             /* entering: their indices in the system */
    ns_broken_line *line;   /* nz: those of the system that are lines, whether they enter or not */
    ns_line_cursor *cursor; /* lines: where each is now */
    double *base;           /* entering: of the curves, what no term adds */
    int terms, waves;       /* how many the curves have together */
    ns_wave_term *term;     /* terms */
    ns_wave *wave;          /* waves: each once */
    unsigned char *begun;   /* terms: 1 from term.from on */
    /* commands that depend on time only */
    int commands;             /* how many */
    ns_switch_times *command; /* commands */
    int *command_index;       /* commands: their indices in the system */
    unsigned char *closed;    /* nc: the states of all switches, 0 of the other commands */
    /* order */
    int count;      /* entries of the heap */
    ns_entry *heap; /* count: the earliest first */
    double now;     /* s: everything up to here has been passed */
    /* the event passed last */
    ns_time_event instant;
    int *changed, *flip; /* its lists */
    int *flips;          /* commands: how often each flips in it */
    int *touched;        /* commands: those that do */
};

#endif
