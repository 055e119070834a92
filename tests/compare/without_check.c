/* tests/compare/without_check.c - linked with --wrap of these (without_check.options), a library that makes
 * no check of its results, as before there was src/verify (run.sh, CHECK=off). */
#include "march/run_internal.h"

/* NOLINTBEGIN(bugprone-reserved-identifier): the linker's names */
int __wrap_ns_march_check_create(ns_run *r);
void __wrap_ns_march_check_attach(ns_run *r);
void __wrap_ns_march_check_scale(ns_run *r);
void __wrap_ns_march_check_scale_start(ns_run *r);
void __wrap_ns_march_check_reset(ns_run *r);
void __wrap_ns_march_check_renew(ns_run *r);
int __wrap_ns_march_check_start(ns_run *r, const ns_run_start *s);
double __wrap_ns_march_check_begin(ns_run *r, double t, ns_until until);
int __wrap_ns_march_check_end(ns_run *r, double t, ns_until until, double reached);

int __wrap_ns_march_check_create(ns_run *r) {
    (void)r;
    return NS_OK;
}

void __wrap_ns_march_check_attach(ns_run *r) {
    (void)r;
}

void __wrap_ns_march_check_scale(ns_run *r) {
    (void)r;
}

void __wrap_ns_march_check_scale_start(ns_run *r) {
    (void)r;
}

void __wrap_ns_march_check_reset(ns_run *r) {
    (void)r;
}

void __wrap_ns_march_check_renew(ns_run *r) {
    (void)r;
}

int __wrap_ns_march_check_start(ns_run *r, const ns_run_start *s) {
    (void)r;
    (void)s;
    return 1;
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
