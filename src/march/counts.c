/* src/march/counts.c - what several engines cost, added up. */
#include "march_internal.h"
#include "run_internal.h"

void ns_march_add_counts(ns_counts *sum, const ns_counts *counts) {
    const long *from = (const long *)(const void *)counts;
    long *to = (long *)(void *)sum;
    for (size_t i = 0; i < sizeof *counts / sizeof *from; i++)
        to[i] += from[i];
}

static void add_work(ns_work *sum, ns_engine *e) {
    if (!e)
        return;
    const ns_work work = ns_engine_work(e);
    sum->all += work.all;
    sum->once += work.once;
    sum->events += work.events;
}

ns_work ns_march_run_work(ns_run *r) {
    ns_work sum = r->work_before;
    add_work(&sum, r->at_work);
    add_work(&sum, r->aside);
    sum.modes = (double)r->check.modes;
    return sum;
}
