/* tests/compare/unchecked.c - linked with --wrap of these four, a library that judges nothing (cost.sh). */
#include "march/run_internal.h"

/* NOLINTBEGIN(bugprone-reserved-identifier): the linker's names */
int __real_ns_march_check_create(ns_run *r);
int __wrap_ns_march_check_create(ns_run *r);
void __wrap_ns_march_check_attach(ns_run *r);
double __wrap_ns_march_check_begin(ns_run *r, double t, ns_until until);
int __wrap_ns_march_check_end(ns_run *r, double t, ns_until until, double reached);

int __wrap_ns_march_check_create(ns_run *r) {
    const int status = __real_ns_march_check_create(r);
    ns_engine_watch(r->at_work, NULL);
    return status;
}

void __wrap_ns_march_check_attach(ns_run *r) {
    (void)r;
}

double __wrap_ns_march_check_begin(ns_run *r, double t, ns_until until) {
    (void)r;
    (void)until;
    return t;
}

int __wrap_ns_march_check_end(ns_run *r, double t, ns_until until, double reached) {
    (void)r;
    (void)t;
    (void)until;
    (void)reached;
    return 1;
}
/* NOLINTEND(bugprone-reserved-identifier) */
