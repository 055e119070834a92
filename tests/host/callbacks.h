/* tests/host/callbacks.h - what ngspice tells a program that these programs do not look at. */
#ifndef HOST_CALLBACKS_H
#define HOST_CALLBACKS_H

#include <stdbool.h> /* before the last, which needs it */
#include <time.h>

#include <ngspice/sharedspice.h>

/* NOLINTNEXTLINE(readability-non-const-parameter): the type is that of ngSpice_Init() */
static int send_stat(char *text, int id, void *user) {
    (void)text, (void)id, (void)user;
    return 0;
}

static int send_data(pvecvaluesall values, int count, int id, void *user) {
    (void)values, (void)count, (void)id, (void)user;
    return 0;
}

static int send_init_data(pvecinfoall info, int id, void *user) {
    (void)info, (void)id, (void)user;
    return 0;
}

static int thread_runs(NG_BOOL not_running, int id, void *user) {
    (void)not_running, (void)id, (void)user;
    return 0;
}

static void pause_ms(long ms) {
    nanosleep(&(struct timespec){.tv_nsec = ms * 1000000}, NULL);
}

#endif
