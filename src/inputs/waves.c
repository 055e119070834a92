/* src/inputs/waves.c - sines and exponentials as multiples of waves. */
#include "waves.h"

#include <float.h>
#include <math.h>

static const double pi = 3.14159265358979323846;

static int sine_terms(const ns_signal *s, ns_wave_term *term, ns_wave *wave, double *base) {
    const double phase = 2 * pi * remainder(s->u.sin.phase / 360, 1), va = s->u.sin.va;
    *base = s->u.sin.vo;
    if (va == 0 || (s->u.sin.freq == 0 && s->u.sin.theta == 0)) {
        *base += va * sin(phase);
        return 0;
    }
    wave[0] = (ns_wave){s->u.sin.freq, s->u.sin.theta, s->u.sin.td};
    term[0] = (ns_wave_term){.from = s->u.sin.td, .before = va * sin(phase), .cc = va * sin(phase)};
    term[0].cs = wave[0].freq != 0 ? va * cos(phase) : 0;
    return 1;
}

/* As SPICE: nothing before td1, even where td2 < td1 (then a jump at td1). */
static int exp_terms(const ns_signal *s, ns_wave_term *term, ns_wave *wave, double *base) {
    const double td1 = s->u.exp.td1, td2 = s->u.exp.td2, rise = s->u.exp.v2 - s->u.exp.v1;
    *base = s->u.exp.v1;
    if (rise == 0)
        return 0;
    wave[0] = (ns_wave){0, fmin(1 / s->u.exp.tau1, DBL_MAX), td1};
    wave[1] = (ns_wave){0, fmin(1 / s->u.exp.tau2, DBL_MAX), td2};
    term[0] = (ns_wave_term){.from = td1, .after = rise, .cc = -rise};
    term[1] = (ns_wave_term){.from = fmax(td1, td2), .after = -rise, .cc = rise, .jump = td2 < td1};
    return 2;
}

int ns_inputs_wave_terms(const ns_signal *s, ns_wave_term *term, ns_wave *wave, double *base) {
    *base = 0;
    if (s->kind == NS_SIN)
        return sine_terms(s, term, wave, base);
    return s->kind == NS_EXP ? exp_terms(s, term, wave, base) : 0;
}

double ns_inputs_wave_rate(const ns_signal *s) {
    ns_wave_term term[NS_TERMS];
    ns_wave wave[NS_TERMS];
    double base, most = 0;
    const int terms = ns_inputs_wave_terms(s, term, wave, &base);
    for (int k = 0; k < terms; k++)
        most = fmax(most, hypot(wave[k].theta, 2 * pi * wave[k].freq));
    return most;
}

void ns_inputs_wave_at(const ns_wave *w, double t, double *c, double *s) {
    const double since = t - w->td, size = w->theta != 0 ? exp(-w->theta * since) : 1;
    *c = size;
    *s = 0;
    if (w->freq != 0) {
        const double turns = w->freq * since, angle = 2 * pi * (turns - floor(turns));
        *c = size * cos(angle);
        *s = size * sin(angle);
    }
}
