/* src/system/signal_check.c - which parameters of a signal are refused, and why. */
#include <math.h>
#include <stddef.h>

#include "signal_internal.h"

static const char must_finite[] = "must be a finite number";

int ns_system_signal_refuse(ns_refusal *why, int status, const char *parameter, double value,
                            const char *must, double than) {
    *why = (ns_refusal){parameter, value, must, than};
    return status;
}

/* n named numbers, all finite. */
static int finite_all(int n, const char *const *name, const double *value, ns_refusal *why) {
    for (int i = 0; i < n; i++) {
        if (!isfinite(value[i])) {
            return ns_system_signal_refuse(why, NS_E_NUMBER, name[i], value[i], must_finite, NAN);
        }
    }
    return NS_OK;
}

static int check_pulse(const ns_signal *s, ns_refusal *why) {
    static const char *const name[] = {"v1", "v2", "td", "tr", "tf"};
    static const char not_nan[] = "must be a number", positive[] = "must be at least 0";
    double tr = s->u.pulse.tr, tf = s->u.pulse.tf, pw = s->u.pulse.pw, per = s->u.pulse.per;
    double value[] = {s->u.pulse.v1, s->u.pulse.v2, s->u.pulse.td, tr, tf};
    int status = finite_all(5, name, value, why);
    if (status) {
        return status;
    }
    if (isnan(pw)) {
        return ns_system_signal_refuse(why, NS_E_NUMBER, "pw", pw, not_nan, NAN);
    }
    if (isnan(per)) {
        return ns_system_signal_refuse(why, NS_E_NUMBER, "per", per, not_nan, NAN);
    }
    if (tr < 0 || tf < 0) {
        return ns_system_signal_refuse(why, NS_E_RANGE, tr < 0 ? "tr" : "tf", tr < 0 ? tr : tf, positive,
                                       NAN);
    }
    if (pw < 0) {
        return ns_system_signal_refuse(why, NS_E_RANGE, "pw", pw, positive, NAN);
    }
    if (!(per > 0)) {
        return ns_system_signal_refuse(why, NS_E_RANGE, "per", per, "must be positive", NAN);
    }
    if (s->u.pulse.cycles < 0) {
        return ns_system_signal_refuse(why, NS_E_RANGE, "cycles", s->u.pulse.cycles, positive, NAN);
    }
    return NS_OK;
}

static int check_sin(const ns_signal *s, ns_refusal *why) {
    static const char *const name[] = {"vo", "va", "freq", "td", "theta", "phase"};
    double value[] = {s->u.sin.vo, s->u.sin.va, s->u.sin.freq, s->u.sin.td, s->u.sin.theta, s->u.sin.phase};
    return finite_all(6, name, value, why);
}

static int check_exp(const ns_signal *s, ns_refusal *why) {
    static const char *const name[] = {"v1", "v2", "td1", "tau1", "td2", "tau2"};
    double value[] = {s->u.exp.v1, s->u.exp.v2, s->u.exp.td1, s->u.exp.tau1, s->u.exp.td2, s->u.exp.tau2};
    int status = finite_all(6, name, value, why);
    for (int i = 3; i < 6 && !status; i += 2) {
        if (!(value[i] > 0)) {
            status = ns_system_signal_refuse(why, NS_E_RANGE, name[i], value[i], "must be positive", NAN);
        }
    }
    return status;
}

static int check_pwl_points(int n, const double *t, const double *v, ns_refusal *why) {
    for (int i = 0; i < n; i++) {
        if (!isfinite(t[i])) {
            return ns_system_signal_refuse(why, NS_E_NUMBER, "time of a point", t[i], must_finite, NAN);
        }
        if (!isfinite(v[i])) {
            return ns_system_signal_refuse(why, NS_E_NUMBER, "value of a point", v[i], must_finite, NAN);
        }
        if (i > 0 && t[i] < t[i - 1]) {
            return ns_system_signal_refuse(why, NS_E_RANGE, "time of a point", t[i],
                                           "lies before the point ahead of it", t[i - 1]);
        }
    }
    return NS_OK;
}

static int check_pwl(const ns_signal *s, ns_refusal *why) {
    int n = s->u.pwl.n, status, found = 0;
    const double *t = s->u.pwl.t;
    double repeat = s->u.pwl.repeat;
    if (n < 1) {
        return ns_system_signal_refuse(why, NS_E_SIZE, "number of points", n, "must be at least 1", NAN);
    }
    if (!t || !s->u.pwl.v) {
        return ns_system_signal_refuse(why, NS_E_NULL, "number of points", n, "but there are none", NAN);
    }
    status = check_pwl_points(n, t, s->u.pwl.v, why);
    if (status || !isfinite(s->u.pwl.td)) {
        return status ? status
                      : ns_system_signal_refuse(why, NS_E_NUMBER, "td", s->u.pwl.td, must_finite, NAN);
    }
    if (isnan(repeat)) {
        return NS_OK;
    }
    for (int i = 0; i < n; i++) {
        found |= t[i] == repeat;
    }
    if (!found || repeat >= t[n - 1]) {
        return ns_system_signal_refuse(why, NS_E_RANGE, "r", repeat,
                                       "must be the time of a point before the last", t[n - 1]);
    }
    return NS_OK;
}

int ns_system_signal_check_why(const ns_signal *s, ns_refusal *why) {
    static const char *const dc[] = {"dc"};
    switch ((int)s->kind) {
    case NS_DC:
        return finite_all(1, dc, &s->u.dc, why);
    case NS_PULSE:
        return check_pulse(s, why);
    case NS_SIN:
        return check_sin(s, why);
    case NS_EXP:
        return check_exp(s, why);
    case NS_PWL:
        return check_pwl(s, why);
    default:
        return ns_system_signal_refuse(why, NS_E_RANGE, "kind of signal", (int)s->kind, "is unknown", NAN);
    }
}

int ns_signal_check(const ns_signal *s) {
    ns_refusal why;
    return s ? ns_system_signal_check_why(s, &why) : NS_E_NULL;
}
