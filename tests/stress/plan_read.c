/* tests/stress/plan_read.c - netlist lines -> parts. */
#define _POSIX_C_SOURCE 200809L
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "plan.h"

enum { WORDS = 64 };

/* A line cut at blanks, brackets, commas and equal signs. */
typedef struct words {
    int count;
    char text[1024], *word[WORDS];
} words;

static void cut(const char *line, words *w) {
    snprintf(w->text, sizeof w->text, "%s", line);
    for (char *c = w->text; *c; c++)
        *c = (char)tolower((unsigned char)*c);
    w->count = 0;
    char *rest = NULL;
    for (char *t = strtok_r(w->text, " \t(),=", &rest); t && w->count < WORDS;
         t = strtok_r(NULL, " \t(),=", &rest))
        w->word[w->count++] = t;
}

static double number(const char *s) {
    static const char letters[] = "tgkmunpf";
    static const double factors[] = {1e12, 1e9, 1e3, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15};
    char *end;
    const double value = strtod(s, &end);
    if (end == s)
        return NAN;
    if (strncmp(end, "meg", 3) == 0)
        return value * 1e6;
    const char *at = *end ? strchr(letters, *end) : NULL;
    return at ? value * factors[at - letters] : value;
}

static int node_of(plan *p, const char *name) {
    if (strcmp(name, "0") == 0 || strcmp(name, "gnd") == 0)
        return 0;
    for (int i = 1; i < p->nodes; i++)
        if (strcmp(p->node[i], name) == 0)
            return i;
    if (p->nodes == PLAN_NODES)
        return -1;
    snprintf(p->node[p->nodes], PLAN_NAME, "%.23s", name);
    return p->nodes++;
}

static int part_of(const plan *p, const char *name) {
    for (int i = 0; i < p->parts; i++)
        if (strcmp(p->part[i].name, name) == 0)
            return i;
    return -1;
}

/* The value behind a word, or what there is without it. */
static double option(const words *w, int from, const char *name, double without) {
    for (int i = from; i + 1 < w->count; i++)
        if (strcmp(w->word[i], name) == 0)
            return number(w->word[i + 1]);
    return without;
}

static double given(const words *w, int at, double without) {
    return at < w->count ? number(w->word[at]) : without;
}

static void read_pwl(const words *w, int at, plan_part *e) {
    int n = 0;
    for (; n < PLAN_CORNERS && at + 1 < w->count && !isnan(number(w->word[at])); n++, at += 2) {
        e->corner_t[n] = number(w->word[at]);
        e->corner_v[n] = number(w->word[at + 1]);
    }
    e->signal = (ns_signal){.kind = NS_PWL, .u.pwl = {n, e->corner_t, e->corner_v, NAN, 0}};
}

static void read_signal(const plan *p, const words *w, int at, plan_part *e) {
    const char *kind = at < w->count ? w->word[at] : "0";
    const int k = at + 1;
    ns_signal *s = &e->signal;
    if (strcmp(kind, "pulse") == 0)
        *s = (ns_signal){.kind = NS_PULSE,
                         .u.pulse = {given(w, k, 0), given(w, k + 1, 0), given(w, k + 2, 0),
                                     given(w, k + 3, p->step), given(w, k + 4, p->step),
                                     given(w, k + 5, INFINITY), given(w, k + 6, INFINITY), 0}};
    else if (strcmp(kind, "sin") == 0)
        *s = (ns_signal){.kind = NS_SIN,
                         .u.sin = {given(w, k, 0), given(w, k + 1, 0), given(w, k + 2, 0), given(w, k + 3, 0),
                                   given(w, k + 4, 0), given(w, k + 5, 0)}};
    else if (strcmp(kind, "exp") == 0)
        *s = (ns_signal){.kind = NS_EXP,
                         .u.exp = {given(w, k, 0), given(w, k + 1, 0), given(w, k + 2, 0),
                                   given(w, k + 3, p->step), given(w, k + 4, 0), given(w, k + 5, p->step)}};
    else if (strcmp(kind, "pwl") == 0)
        read_pwl(w, k, e);
    else
        *s = (ns_signal){.kind = NS_DC, .u.dc = strcmp(kind, "dc") == 0 ? given(w, k, 0) : number(kind)};
}

static double huge(double v) {
    return v >= 1e30 ? INFINITY : v;
}

/* The .model line of this name. */
static int find_model(const netlist *n, const char *name, words *w) {
    for (int i = 1; i < n->count; i++)
        if (strncasecmp(n->line[i], ".model", 6) == 0) {
            cut(n->line[i], w);
            if (w->count > 2 && strcmp(w->word[1], name) == 0)
                return 1;
        }
    return 0;
}

static int read_device(const netlist *n, plan *p, const words *w, plan_part *e) {
    words m = {0};
    if (!find_model(n, w->word[w->count - 1], &m))
        return 0;
    if (strcmp(m.word[2], "ideal_diode") == 0 && w->count == 4) {
        e->kind = 'd';
        e->diode =
            (ns_diode){option(&m, 3, "vf", 0), option(&m, 3, "ron", 0), huge(option(&m, 3, "roff", INFINITY)),
                       huge(option(&m, 3, "vz", INFINITY)), option(&m, 3, "rz", 0)};
        return 1;
    }
    if (strcmp(m.word[2], "ideal_switch") != 0 || w->count != 6)
        return 0;
    e->kind = 's';
    e->node[2] = node_of(p, w->word[3]);
    e->node[3] = node_of(p, w->word[4]);
    e->contact = (ns_switch){option(&m, 3, "vt", 0.5), option(&m, 3, "vh", 0), option(&m, 3, "ron", 0),
                             huge(option(&m, 3, "roff", INFINITY))};
    return 1;
}

static int read_part(const netlist *n, plan *p, const words *w) {
    if (p->parts == PLAN_PARTS || w->count < 4)
        return 0;
    plan_part *e = &p->part[p->parts];
    *e = (plan_part){.kind = w->word[0][0], .by = {-1, -1}, .ic = option(w, 3, "ic", NAN)};
    snprintf(e->name, PLAN_NAME, "%.23s", w->word[0]);
    e->value = number(w->word[3]);
    if (e->kind != 'k') {
        e->node[0] = node_of(p, w->word[1]);
        e->node[1] = node_of(p, w->word[2]);
    }
    if (strchr("eg", e->kind) && w->count == 6) {
        e->node[2] = node_of(p, w->word[3]);
        e->node[3] = node_of(p, w->word[4]);
        e->value = number(w->word[5]);
    } else if (strchr("fh", e->kind) && w->count == 5) {
        e->by[0] = part_of(p, w->word[3]);
        e->value = number(w->word[4]);
    } else if (e->kind == 'k') {
        e->by[0] = part_of(p, w->word[1]);
        e->by[1] = part_of(p, w->word[2]);
    } else if (strchr("vi", e->kind)) {
        read_signal(p, w, 3, e);
        e->value = 0;
    } else if (e->kind == 'a') {
        if (!read_device(n, p, w, e))
            return 0;
        e->value = 0;
    } else if (!strchr("rlc", e->kind))
        return 0;
    p->parts++;
    return !isnan(e->value) && e->node[0] >= 0 && e->node[1] >= 0 && e->node[2] >= 0 && e->node[3] >= 0;
}

/* --- what is compared --- */

static void add_probe(plan *p, int part, int a, int b) {
    if (p->probes < PLAN_PROBES)
        p->probe[p->probes++] = (plan_probe){part, {a, b}};
}

static void read_save(plan *p, const char *line) {
    char text[1024], *rest = NULL;
    snprintf(text, sizeof text, "%s", line);
    for (char *t = strtok_r(text, " \t", &rest); t; t = strtok_r(NULL, " \t", &rest)) {
        words w = {0};
        cut(t, &w);
        if (w.count < 2)
            continue;
        const int part = part_of(p, w.word[1]);
        if (strcmp(w.word[0], "v") == 0)
            add_probe(p, -1, node_of(p, w.word[1]), w.count > 2 ? node_of(p, w.word[2]) : 0);
        else if (part >= 0 && strchr("lve", p->part[part].kind))
            add_probe(p, part, 0, 0);
    }
}

static int perfectly_coupled(const plan *p, int part) {
    for (int i = 0; i < p->parts; i++)
        if (p->part[i].kind == 'k' && fabs(p->part[i].value) >= 1 &&
            (p->part[i].by[0] == part || p->part[i].by[1] == part))
            return 1;
    return 0;
}

static void probe_states(plan *p) {
    for (int i = 0; i < p->parts; i++)
        if (p->part[i].kind == 'c')
            add_probe(p, -1, p->part[i].node[0], p->part[i].node[1]);
        else if (p->part[i].kind == 'l' && !perfectly_coupled(p, i))
            add_probe(p, i, 0, 0);
}

/* A network of resistors: its nodes. */
static void probe_nodes(plan *p) {
    for (int i = 1; i < p->nodes; i++)
        add_probe(p, -1, i, 0);
}

static void read_tran(plan *p, const words *w) {
    p->step = given(w, 1, 0);
    p->stop = given(w, 2, 0);
    p->uic = strcmp(w->word[w->count - 1], "uic") == 0;
}

const char *plan_read(const netlist *n, plan *p) {
    words w = {0};
    *p = (plan){.nodes = 1};
    snprintf(p->node[0], PLAN_NAME, "0");
    for (int pass = 0; pass < 4; pass++) /* .tran; what is named; what names; .save */
        for (int i = 1; i < n->count; i++) {
            const char *line = n->line[i];
            const char first = (char)tolower((unsigned char)line[0]);
            const int naming = first && strchr("kfh", first);
            cut(line, &w);
            if (w.count == 0)
                continue;
            if (pass == 0 && strcmp(w.word[0], ".tran") == 0)
                read_tran(p, &w);
            else if (pass == 3 && strcmp(w.word[0], ".save") == 0)
                read_save(p, line);
            else if (strncmp(w.word[0], "aopt", 4) != 0 && first && strchr("rlckviegfha", first) &&
                     pass == 1 + (naming != 0) && !read_part(n, p, &w))
                return line;
        }
    if (p->probes == 0)
        probe_states(p);
    if (p->probes == 0)
        probe_nodes(p);
    return p->stop > 0 && p->step > 0 && p->probes > 0 ? NULL : n->line[0];
}

void plan_probe_name(const plan *p, int probe, char *name, size_t size) {
    const plan_probe *q = &p->probe[probe];
    if (q->part >= 0)
        snprintf(name, size, "i(%s)", p->part[q->part].name);
    else if (q->node[1])
        snprintf(name, size, "v(%s,%s)", p->node[q->node[0]], p->node[q->node[1]]);
    else
        snprintf(name, size, "v(%s)", p->node[q->node[0]]);
}
