/* tests/bench/deck.c - circuits as lists of parts. */
#include "timing.h"

#include <math.h>

#include "deck.h"

typedef struct part {
    char kind;   /* SPICE's letter */
    int number;  /* among those of its kind, from 1 */
    int node[4]; /* p, n, and those of the control; [2] of f: the part that controls it */
    double value, ic;
    ns_signal signal;
} part;

struct deck {
    int count, room;
    part *part;
};

deck *deck_create(void) {
    return room(sizeof(deck));
}

void deck_free(deck *d) {
    if (d)
        free(d->part);
    free(d);
}

static int add(deck *d, part p) {
    if (d->count == d->room) {
        d->room = 2 * d->room + 16;
        d->part = realloc(d->part, (size_t)d->room * sizeof *d->part);
        if (!d->part)
            must(NS_E_MEMORY);
    }
    p.number = 1;
    for (int i = d->count - 1; i >= 0 && p.number == 1; i--)
        if (d->part[i].kind == p.kind)
            p.number = d->part[i].number + 1;
    d->part[d->count] = p;
    return d->count++;
}

int deck_r(deck *d, int p, int n, double ohms) {
    return add(d, (part){.kind = 'r', .node = {p, n}, .value = ohms});
}

int deck_c(deck *d, int p, int n, double farads, double ic) {
    return add(d, (part){.kind = 'c', .node = {p, n}, .value = farads, .ic = ic});
}

int deck_l(deck *d, int p, int n, double henries, double ic) {
    return add(d, (part){.kind = 'l', .node = {p, n}, .value = henries, .ic = ic});
}

int deck_v(deck *d, int p, int n, ns_signal s) {
    return add(d, (part){.kind = 'v', .node = {p, n}, .signal = s});
}

int deck_i(deck *d, int p, int n, ns_signal s) {
    return add(d, (part){.kind = 'i', .node = {p, n}, .signal = s});
}

int deck_d(deck *d, int anode, int cathode) {
    return add(d, (part){.kind = 'd', .node = {anode, cathode}});
}

int deck_s(deck *d, int p, int n, int cp, int cn, double vt) {
    return add(d, (part){.kind = 's', .node = {p, n, cp, cn}, .value = vt});
}

int deck_e(deck *d, int p, int n, int cp, int cn, double gain) {
    return add(d, (part){.kind = 'e', .node = {p, n, cp, cn}, .value = gain});
}

int deck_g(deck *d, int p, int n, int cp, int cn, double gain) {
    return add(d, (part){.kind = 'g', .node = {p, n, cp, cn}, .value = gain});
}

int deck_f(deck *d, int p, int n, int by, double gain) {
    return add(d, (part){.kind = 'f', .node = {p, n, by}, .value = gain});
}

ns_signal deck_dc(double value) {
    return (ns_signal){.kind = NS_DC, .u.dc = value};
}

ns_signal deck_pulse(double v2, double td, double edge, double pw, double per) {
    return (ns_signal){.kind = NS_PULSE, .u.pulse = {0, v2, td, edge, edge, pw, per, 0}};
}

ns_signal deck_sine(double vo, double va, double freq, double phase) {
    return (ns_signal){.kind = NS_SIN, .u.sin = {vo, va, freq, 0, 0, phase}};
}

int deck_devices(const deck *d) {
    int count = 0;
    for (int i = 0; i < d->count; i++)
        count += d->part[i].kind == 'd' || d->part[i].kind == 's';
    return count;
}

void deck_name(const deck *d, int at, char *name, size_t size) {
    snprintf(name, size, "%c%d", d->part[at].kind, d->part[at].number);
}

/* --- the library's --- */

static int put(ns_circuit *c, const char *name, const part *p) {
    static const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    const ns_switch contact = {p->value, 0, 0, INFINITY};
    const int a = p->node[0], b = p->node[1], cp = p->node[2], cn = p->node[3];
    switch (p->kind) {
    case 'r':
        return ns_circuit_resistor(c, name, a, b, p->value, NULL);
    case 'c':
        return ns_circuit_capacitor(c, name, a, b, p->value, p->ic, NULL);
    case 'l':
        return ns_circuit_inductor(c, name, a, b, p->value, p->ic, NULL);
    case 'v':
        return ns_circuit_source(c, name, NS_VOLTAGE, a, b, &p->signal, NULL);
    case 'i':
        return ns_circuit_source(c, name, NS_CURRENT, a, b, &p->signal, NULL);
    case 'd':
        return ns_circuit_diode(c, name, a, b, &ideal, NULL);
    case 's':
        return ns_circuit_switch(c, name, a, b, cp, cn, &contact, NULL);
    case 'e':
        return ns_circuit_vcontrolled(c, name, NS_VOLTAGE, a, b, cp, cn, p->value, NULL);
    case 'g':
        return ns_circuit_vcontrolled(c, name, NS_CURRENT, a, b, cp, cn, p->value, NULL);
    default:
        return ns_circuit_icontrolled(c, name, NS_CURRENT, a, b, cp, p->value, NULL);
    }
}

int deck_circuit(const deck *d, ns_circuit **out) {
    ns_circuit *c;
    int status = ns_circuit_create(&c);
    for (int i = 0; i < d->count && status == NS_OK; i++) {
        char name[16];
        deck_name(d, i, name, sizeof name);
        status = put(c, name, &d->part[i]);
    }
    *out = c;
    return status;
}

/* --- ngspice's --- */

static void write_signal(const ns_signal *s, FILE *file) {
    if (s->kind == NS_DC)
        fprintf(file, " dc %.17g", s->u.dc);
    else if (s->kind == NS_SIN)
        fprintf(file, " sin(%.17g %.17g %.17g 0 0 %.17g)", s->u.sin.vo, s->u.sin.va, s->u.sin.freq,
                s->u.sin.phase);
    else
        fprintf(file, " pulse(%.17g %.17g %.17g %.17g %.17g %.17g %.17g)", s->u.pulse.v1, s->u.pulse.v2,
                s->u.pulse.td, s->u.pulse.tr, s->u.pulse.tf, s->u.pulse.pw, s->u.pulse.per);
}

static void write_device(const part *p, const char *name, const deck_models *m, FILE *file) {
    const int a = p->node[0], b = p->node[1];
    if (p->kind == 'd') {
        if (m->diode == DECK_D)
            fprintf(file, "%s %d %d dm\n", name, a, b);
        else
            fprintf(file, m->diode == DECK_IDEAL ? "a%s %d %d dm\n" : "a%s %%gd(%d %d) dm\n", name, a, b);
        return;
    }
    if (m->diode == DECK_IDEAL)
        fprintf(file, "a%s %d %d %d %d m%s\n.model m%s ideal_switch(vt=%.17g)\n", name, a, b, p->node[2],
                p->node[3], name, name, p->value);
    else
        fprintf(file, "%s %d %d %d %d m%s\n.model m%s sw(vt=%.17g vh=%g ron=%.17g roff=%.17g)\n", name, a, b,
                p->node[2], p->node[3], name, name, p->value, m->vh, m->ron, m->roff);
}

static void write_part(const deck *d, const part *p, const char *name, FILE *file) {
    char by[16];
    fprintf(file, "%s %d %d", name, p->node[0], p->node[1]);
    switch (p->kind) {
    case 'r':
        fprintf(file, " %.17g", p->value);
        break;
    case 'c':
    case 'l':
        fprintf(file, " %.17g ic=%.17g", p->value, p->ic);
        break;
    case 'v':
    case 'i':
        write_signal(&p->signal, file);
        break;
    case 'f':
        deck_name(d, p->node[2], by, sizeof by);
        fprintf(file, " %s %.17g", by, p->value);
        break;
    default:
        fprintf(file, " %d %d %.17g", p->node[2], p->node[3], p->value);
    }
    fputc('\n', file);
}

void deck_netlist(const deck *d, const deck_models *m, FILE *file) {
    int diodes = 0;
    for (int i = 0; i < d->count; i++) {
        const part *p = &d->part[i];
        char name[16];
        deck_name(d, i, name, sizeof name);
        if (p->kind == 'd' || p->kind == 's')
            write_device(p, name, m, file);
        else
            write_part(d, p, name, file);
        diodes += p->kind == 'd';
    }
    if (diodes > 0 && m->diode == DECK_D)
        fprintf(file, ".model dm d(is=1e-14 n=%g)\n", m->n);
    else if (diodes > 0 && m->diode == DECK_SIDIODE)
        fprintf(file, ".model dm sidiode(ron=%g roff=%g vfwd=0 epsilon=0)\n", m->ron, m->roff);
    else if (diodes > 0)
        fprintf(file, ".model dm ideal_diode\n");
}
