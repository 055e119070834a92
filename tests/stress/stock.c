/* tests/stress/stock.c - a netlist with ngspice's own models in place of the ideal devices. */
#include "stock.h"

#include <math.h>
#include <strings.h>

static const double least_ron = 1e-3, most_roff = 1e9; /* ohm */

stock_setting stock_setting_of(int number) {
    static const double n[] = {0, 0.01, 1}, reltol[] = {1e-3, 1e-4}, longest[] = {10, 1, 0.1};
    return (stock_setting){.longest = longest[number % 3],
                           .reltol = reltol[number / 3 % 2],
                           .gear = number / 6 % 2,
                           .n = n[number / 12 % 3]};
}

void stock_name(const stock_setting *s, char *name, size_t size) {
    char diode[24] = "sidiode";
    if (s->n > 0)
        snprintf(diode, sizeof diode, "D n=%g", s->n);
    snprintf(name, size, "%s %s reltol=%g, steps of %g tstep", diode, s->gear ? "gear" : "trap", s->reltol,
             s->longest);
}

static double ron_of(double ron) {
    return fmax(ron, least_ron);
}

static double roff_of(double roff) {
    return fmin(roff, most_roff);
}

/* D has no vf: a source in series. */
static void put_d(netlist *to, const plan *p, const plan_part *d, double n) {
    const char *anode = p->node[d->node[0]], *cathode = p->node[d->node[1]];
    netlist_put(to, "d_%s %s_d %s m_%s", d->name, d->name, cathode, d->name);
    netlist_put(to, "v_%s %s %s_d dc %.12g", d->name, anode, d->name, d->diode.vf);
    netlist_put(to, "r_%s %s %s %.12g", d->name, anode, cathode, roff_of(d->diode.roff));
    netlist_put(to, ".model m_%s d(is=1e-14 n=%g rs=%.12g)", d->name, n, ron_of(d->diode.ron));
}

static void put_sidiode(netlist *to, const plan *p, const plan_part *d) {
    netlist_put(to, "a_%s %%gd(%s %s) m_%s", d->name, p->node[d->node[0]], p->node[d->node[1]], d->name);
    netlist_put(to, ".model m_%s sidiode(ron=%.12g roff=%.12g vfwd=%.12g epsilon=0)", d->name,
                ron_of(d->diode.ron), roff_of(d->diode.roff), d->diode.vf);
}

static void put_switch(netlist *to, const plan *p, const plan_part *s) {
    netlist_put(to, "s_%s %s %s %s %s m_%s", s->name, p->node[s->node[0]], p->node[s->node[1]],
                p->node[s->node[2]], p->node[s->node[3]], s->name);
    netlist_put(to, ".model m_%s sw(vt=%.12g vh=%.12g ron=%.12g roff=%.12g)", s->name, s->contact.vt,
                s->contact.vh, ron_of(s->contact.ron), roff_of(s->contact.roff));
}

static int is_ours(const char *line) {
    return strncasecmp(line, "a", 1) == 0 || strncasecmp(line, ".model", 6) == 0 ||
           strncasecmp(line, ".tran", 5) == 0;
}

netlist stock_netlist(const netlist *n, const plan *p, const stock_setting *s) {
    netlist to = {0};
    for (int i = 0; i < n->count; i++)
        if (i == 0 || !is_ours(n->line[i]))
            netlist_put(&to, "%s", n->line[i]);
    for (int i = 0; i < p->parts; i++)
        if (p->part[i].kind == 's')
            put_switch(&to, p, &p->part[i]);
        else if (p->part[i].kind == 'd' && s->n > 0)
            put_d(&to, p, &p->part[i], s->n);
        else if (p->part[i].kind == 'd')
            put_sidiode(&to, p, &p->part[i]);
    if (!(s->n > 0)) /* its own limit of steps asks for the smoothing that is left out */
        netlist_put(&to, ".options convstep=1e9 convabsstep=1e9 abstol=1e-6 vntol=1e-3 chgtol=1e-9");
    netlist_put(&to, ".options reltol=%g method=%s", s->reltol, s->gear ? "gear" : "trap");
    netlist_put(&to, ".tran %.12g %.12g 0 %.12g%s", p->step, p->stop, s->longest * p->step,
                p->uic ? " uic" : "");
    return to;
}
