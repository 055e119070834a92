/* src/system/signal_check.c - which parameters of a signal are refused, and why. */
#include <math.h>
#include <stddef.h>

#include "signal_internal.h"

static const char must_finite[] = "must be a finite number", must_number[] = "must be a number";
static const char must_positive[] = "must be positive", must_0[] = "must be at least 0";

int ns_system_signal_check_rules(int count, const ns_rule *rule, ns_refusal *why) {
    for (int i = 0; i < count; i++) {
        if (rule[i].broken) {
            *why = rule[i].why;
            return rule[i].status;
        }
    }
    return NS_OK;
}

/* n named numbers, all finite. */
static int finite_all(int n, const char *const *name, const double *value, ns_refusal *why) {
    int status = NS_OK;
    for (int i = 0; i < n && !status; i++) {
        const ns_rule finite = {!isfinite(value[i]), NS_E_NUMBER, {name[i], value[i], must_finite, NAN}};
        status = ns_system_signal_check_rules(1, &finite, why);
    }
    return status;
}

static int check_pulse(const ns_signal *s, ns_refusal *why) {
    static const char *const name[] = {"v1", "v2", "td", "tr", "tf"};
    const double tr = s->u.pulse.tr, tf = s->u.pulse.tf, pw = s->u.pulse.pw, per = s->u.pulse.per;
    const double value[] = {s->u.pulse.v1, s->u.pulse.v2, s->u.pulse.td, tr, tf};
    const ns_rule rule[] = {{isnan(pw), NS_E_NUMBER, {"pw", pw, must_number, NAN}},
                            {isnan(per), NS_E_NUMBER, {"per", per, must_number, NAN}},
                            {tr < 0, NS_E_RANGE, {"tr", tr, must_0, NAN}},
                            {tf < 0, NS_E_RANGE, {"tf", tf, must_0, NAN}},
                            {pw < 0, NS_E_RANGE, {"pw", pw, must_0, NAN}},
                            {!(per > 0), NS_E_RANGE, {"per", per, must_positive, NAN}},
                            {s->u.pulse.cycles < 0, NS_E_RANGE, {"cycles", s->u.pulse.cycles, must_0, NAN}}};
    const int status = finite_all(5, name, value, why);
    return status ? status : ns_system_signal_check_rules(7, rule, why);
}

static int check_sin(const ns_signal *s, ns_refusal *why) {
    static const char *const name[] = {"vo", "va", "freq", "td", "theta", "phase"};
    double value[] = {s->u.sin.vo, s->u.sin.va, s->u.sin.freq, s->u.sin.td, s->u.sin.theta, s->u.sin.phase};
    return finite_all(6, name, value, why);
}

static int check_exp(const ns_signal *s, ns_refusal *why) {
    static const char *const name[] = {"v1", "v2", "td1", "tau1", "td2", "tau2"};
    const double tau1 = s->u.exp.tau1, tau2 = s->u.exp.tau2;
    const double value[] = {s->u.exp.v1, s->u.exp.v2, s->u.exp.td1, tau1, s->u.exp.td2, tau2};
    const ns_rule rule[] = {{!(tau1 > 0), NS_E_RANGE, {"tau1", tau1, must_positive, NAN}},
                            {!(tau2 > 0), NS_E_RANGE, {"tau2", tau2, must_positive, NAN}}};
    const int status = finite_all(6, name, value, why);
    return status ? status : ns_system_signal_check_rules(2, rule, why);
}

static int check_pwl_points(int n, const double *t, const double *v, ns_refusal *why) {
    int status = NS_OK;
    for (int i = 0; i < n && !status; i++) {
        const double before = i > 0 ? t[i - 1] : t[i];
        const ns_rule rule[] = {{!isfinite(t[i]), NS_E_NUMBER, {"time of a point", t[i], must_finite, NAN}},
                                {!isfinite(v[i]), NS_E_NUMBER, {"value of a point", v[i], must_finite, NAN}},
                                {t[i] < before,
                                 NS_E_RANGE,
                                 {"time of a point", t[i], "lies before the point ahead of it", before}}};
        status = ns_system_signal_check_rules(3, rule, why);
    }
    return status;
}

static int has_point_at(const ns_signal *s, double t) {
    for (int i = 0; i < s->u.pwl.n; i++) {
        if (s->u.pwl.t[i] == t) {
            return 1;
        }
    }
    return 0;
}

static int check_pwl(const ns_signal *s, ns_refusal *why) {
    const int n = s->u.pwl.n, missing = !s->u.pwl.t || !s->u.pwl.v;
    const double repeat = s->u.pwl.repeat, td = s->u.pwl.td;
    const ns_rule points[] = {{n < 1, NS_E_SIZE, {"number of points", n, "must be at least 1", NAN}},
                              {missing, NS_E_NULL, {"number of points", n, "but there are none", NAN}}};
    int status = ns_system_signal_check_rules(2, points, why);
    if (status || (status = check_pwl_points(n, s->u.pwl.t, s->u.pwl.v, why))) {
        return status;
    }
    const double last = s->u.pwl.t[n - 1];
    const int wrong = !isnan(repeat) && (!has_point_at(s, repeat) || repeat >= last);
    const ns_rule rule[] = {
        {!isfinite(td), NS_E_NUMBER, {"td", td, must_finite, NAN}},
        {wrong, NS_E_RANGE, {"r", repeat, "must be the time of a point before the last", last}}};
    return ns_system_signal_check_rules(2, rule, why);
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
        *why = (ns_refusal){"kind of signal", (int)s->kind, "is unknown", NAN};
        return NS_E_RANGE;
    }
}

int ns_signal_check(const ns_signal *s) {
    ns_refusal why;
    return s ? ns_system_signal_check_why(s, &why) : NS_E_NULL;
}
