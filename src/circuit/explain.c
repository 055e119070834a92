/* src/circuit/explain.c - a fault of a system in the names of the circuit, as one line. */
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "circuit_internal.h"

/* A line being written; len counts what there would be with enough room. */
typedef struct line_writer {
    char *line;
    size_t size, len;
} line_writer;

static void write_text(line_writer *w, const char *format, ...) {
    va_list arguments;
    int wanted;
    size_t used = w->len < w->size ? w->len : w->size;
    va_start(arguments, format);
    wanted = vsnprintf(w->size > used ? w->line + used : NULL, w->size - used, format, arguments);
    va_end(arguments);
    w->len += wanted > 0 ? (size_t)wanted : 0;
}

/* Ends the line: "..." where it was cut, nothing that breaks a line. */
static int end_line(line_writer *w) {
    if (w->len >= w->size && w->size >= 4) {
        memcpy(w->line + w->size - 4, "...", 4);
    }
    for (size_t i = 0; i + 1 < w->size && w->line[i]; i++) {
        if ((unsigned char)w->line[i] < ' ') {
            w->line[i] = '?';
        }
    }
    return w->len > INT_MAX ? INT_MAX : (int)w->len;
}

static const element *element_of_pair(const ns_circuit *c, int pair) {
    for (int i = 0; c && pair >= 0 && i < c->nelements; i++) {
        const element *e = &c->element[i];
        if (e->pair >= 0 && pair >= e->pair && pair < e->pair + ns_circuit_pairs_of(e)) {
            return e;
        }
    }
    return NULL;
}

static const element *element_of_current(const ns_circuit *c, int unknown) {
    for (int i = 0; c && unknown >= c->nused && i < c->nelements; i++) {
        if (c->element[i].current == unknown - c->nused) {
            return &c->element[i];
        }
    }
    return NULL;
}

static const node_info *node_of_unknown(const ns_circuit *c, int unknown) {
    for (int i = 0; c && i < c->nnodes; i++) {
        if (c->node[i].used && c->node[i].unknown == unknown) {
            return &c->node[i];
        }
    }
    return NULL;
}

static void write_node(line_writer *w, const node_info *which) {
    if (which->name) {
        write_text(w, "node %s", which->name);
    } else {
        write_text(w, "node %d", which->number);
    }
}

static int count_of(int claimed) {
    return claimed < 0 ? 0 : claimed > NS_FAULT_MAX ? NS_FAULT_MAX : claimed;
}

/* 1 if an earlier pair of the fault belongs to the same element. */
static int named_before(const ns_circuit *c, const ns_fault *f, int i) {
    for (int k = 0; k < i; k++) {
        if (element_of_pair(c, f->pair[k]) == element_of_pair(c, f->pair[i])) {
            return element_of_pair(c, f->pair[i]) != NULL;
        }
    }
    return 0;
}

static void write_pair(line_writer *w, const ns_circuit *c, int pair, int with_kind) {
    const element *e = element_of_pair(c, pair);
    if (e) {
        write_text(w, "%s%s",
                   !with_kind          ? ""
                   : e->kind == DIODE  ? "ideal diode "
                   : e->kind == SWITCH ? "ideal switch "
                   : e->kind == KINK   ? "corner of "
                   : e->kind == BOX    ? "limits of "
                                       : "choice of ",
                   e->name);
    } else {
        write_text(w, "pair %d", pair);
    }
}

static void write_unknown(line_writer *w, const ns_circuit *c, int unknown, int with_kind) {
    const element *e = element_of_current(c, unknown);
    const node_info *which = node_of_unknown(c, unknown);
    if (e) {
        write_text(w, "%s%s", with_kind ? "current of " : "", e->name);
    } else if (which) {
        write_text(w, "%s", with_kind ? "voltage of " : "");
        write_node(w, which);
    } else {
        write_text(w, "unknown %d", unknown);
    }
}

/* The names of the pairs' elements, with commas between; with_kind: "ideal diode d1". */
static int write_pairs(line_writer *w, const ns_circuit *c, const ns_fault *f, int with_kind) {
    int written = 0;
    for (int i = 0; i < count_of(f->npairs); i++) {
        if (!named_before(c, f, i)) {
            write_text(w, "%s", written++ ? ", " : "");
            write_pair(w, c, f->pair[i], with_kind);
        }
    }
    return written;
}

static int is_current_source(const element *e) {
    return e->output == NS_CURRENT &&
           (e->kind == SOURCE || e->kind == VCONTROLLED || e->kind == ICONTROLLED || e->kind == LINEAR);
}

static int is_device(const element *e) {
    return e->kind == DIODE || e->kind == SWITCH;
}

/* The next element from i on, of this sort, that ends at a node; -1: none. */
static int next_at(const ns_circuit *c, const node_info *at, int (*sort)(const element *e), int i) {
    for (; c && at && i < c->nelements; i++) {
        if (sort(&c->element[i]) &&
            (c->element[i].node[0] == at->number || c->element[i].node[1] == at->number)) {
            return i;
        }
    }
    return -1;
}

/* At a node whose voltage has no solution: the sources whose currents have no path, and the devices that
 * could carry them. */
static int write_interrupted(line_writer *w, const ns_circuit *c, const ns_fault *f, int unknown, int written,
                             int with_kind) {
    const node_info *at = node_of_unknown(c, unknown);
    int named = 0, i;
    if (f->status != NS_E_INFEASIBLE || f->npairs > 0 || next_at(c, at, is_current_source, 0) < 0) {
        return written;
    }
    for (i = -1; (i = next_at(c, at, is_current_source, i + 1)) >= 0 && named++ < NS_FAULT_MAX;) {
        write_text(w, "%s%s%s", written++ ? ", " : "", with_kind ? "current of " : "", c->element[i].name);
    }
    for (i = -1; (i = next_at(c, at, is_device, i + 1)) >= 0 && named++ < NS_FAULT_MAX;) {
        write_text(w, "%s", written++ ? ", " : "");
        write_pair(w, c, c->element[i].pair, with_kind);
    }
    return written;
}

static int write_unknowns(line_writer *w, const ns_circuit *c, const ns_fault *f, int written,
                          int with_kind) {
    for (int i = 0; i < count_of(f->nunknowns); i++) {
        written = write_interrupted(w, c, f, f->unknown[i], written, with_kind);
        write_text(w, "%s", written++ ? ", " : "");
        write_unknown(w, c, f->unknown[i], with_kind);
    }
    return written;
}

/* The first pair given up at is a switch with hysteresis: what it does, and what helps. */
static void write_contradiction(line_writer *w, const ns_circuit *c, const ns_fault *f) {
    const element *e = count_of(f->npairs) > 0 ? element_of_pair(c, f->pair[0]) : NULL;
    if (e && e->kind == SWITCH && e->sw.vh > 0) {
        write_text(w,
                   " (ideal switch %s: if it moves its own control past both thresholds at once, it can be "
                   "neither open nor closed; give it a larger vh, or delay its control by R and C)",
                   e->name);
    }
}

/* The first pair opens and closes infinitely fast, and the second one changes each time: what helps. */
static void write_chatter(line_writer *w, const ns_circuit *c, const ns_fault *f) {
    const element *e = count_of(f->npairs) > 1 ? element_of_pair(c, f->pair[0]) : NULL;
    if (!e) {
        return;
    }
    write_text(w, " (");
    write_pair(w, c, f->pair[1], 1);
    write_text(w, " changes with each switching of ");
    write_pair(w, c, f->pair[0], 1);
    write_text(w, e->kind == SWITCH
                      ? "; give its model a vh above 0; the gate of an M: drive it against its source)"
                      : "; let a switch with a vh above 0 make this comparison)");
}

/* The usual cause. */
static void write_cause(line_writer *w, const ns_circuit *c, const ns_fault *f) {
    int written;
    if (f->status == NS_E_LIMIT) {
        write_contradiction(w, c, f);
    }
    if (f->status == NS_E_CHATTER) {
        write_chatter(w, c, f);
    }
    if (f->status != NS_E_INFEASIBLE && f->status != NS_E_SINGULAR) {
        return;
    }
    write_text(w, " (");
    written = write_pairs(w, c, f, 1);
    written = write_unknowns(w, c, f, written, 1);
    write_text(
        w, "%s%s)", written ? ": " : "",
        f->status == NS_E_INFEASIBLE
            ? "conflict with sources or an .ic; look for a loop without resistance or a current without a "
              "closed path"
            : "not determined; look for a node without a path to ground or a loop without resistance");
}

static line_writer begin_line(char *line, size_t size) {
    line_writer w = {line, line ? size : 0, 0};
    if (w.size > 0) {
        *line = '\0';
    }
    return w;
}

int ns_circuit_count(const ns_circuit *c) {
    return c ? c->nelements : 0;
}

int ns_circuit_name_element(const ns_circuit *c, int id, char *line, size_t size) {
    line_writer w = begin_line(line, size);
    if (id >= 0 && id < ns_circuit_count(c)) {
        write_text(&w, "%s", c->element[id].name);
    } else {
        write_text(&w, "element %d", id);
    }
    return end_line(&w);
}

int ns_circuit_name_unknown(const ns_circuit *c, int unknown, char *line, size_t size) {
    line_writer w = begin_line(line, size);
    write_unknown(&w, c, unknown, 1);
    return end_line(&w);
}

int ns_circuit_name_pair(const ns_circuit *c, int pair, char *line, size_t size) {
    const element *e = element_of_pair(c, pair);
    line_writer w = begin_line(line, size);
    write_text(&w, "%s", e && pair > e->pair ? "breakdown of " : "");
    write_pair(&w, c, pair, 1);
    return end_line(&w);
}

int ns_circuit_explain(const ns_circuit *c, const ns_fault *f, char *line, size_t size) {
    line_writer w = begin_line(line, size);
    int written;
    if (!f) {
        return 0;
    }
    written = write_pairs(&w, c, f, 0);
    written = write_unknowns(&w, c, f, written, 0);
    write_text(&w, "%s", written ? ": " : "");
    if (!isnan(f->t)) {
        write_text(&w, "at t = %g s: ", f->t);
    }
    write_text(&w, "%s", ns_status_text(f->status));
    if (f->why)
        write_text(&w, " (%s)", f->why);
    write_cause(&w, c, f);
    return end_line(&w);
}
