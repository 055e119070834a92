/* tests/stress/shrink.c - smaller and smaller netlists. */
#define _POSIX_C_SOURCE 200809L
#include "shrink.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

enum { WORDS = 48 };

typedef struct search {
    netlist *n; /* the smallest so far */
    judge_finding *f;
    judge_options o;
    double until;
    int gained; /* in this round */
} search;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Keeps a candidate, which it takes over, if it shows the same. */
static int keep(search *s, netlist *candidate) {
    if (now() < s->until) {
        const judge_finding f = judge(candidate, &s->o);
        if (f.verdict == s->f->verdict && strcmp(f.kind, s->f->kind) == 0) {
            netlist_free(s->n);
            *s->n = *candidate;
            *s->f = f;
            s->gained = 1;
            return 1;
        }
    }
    netlist_free(candidate);
    return 0;
}

static int is_part(const char *line) {
    return isalpha((unsigned char)line[0]) && strncmp(line, "AOPT", 4) != 0;
}

/* Lines [at, at+count) that are parts go. */
static int without(search *s, int at, int count) {
    netlist c = netlist_copy(s->n);
    int gone = 0;
    for (int i = at + count - 1; i >= at; i--)
        if (i < c.count && i > 0 && (is_part(c.line[i]) || strncmp(c.line[i], ".model", 6) == 0)) {
            netlist_drop(&c, i);
            gone++;
        }
    if (gone == 0) {
        netlist_free(&c);
        return 0;
    }
    return keep(s, &c);
}

static void drop_parts(search *s) {
    for (int count = s->n->count / 2; count >= 1; count /= 2)
        for (int at = 1; at < s->n->count;)
            if (!without(s, at, count))
                at += count;
}

/* --- words of a line --- */

static int cut(char *text, char **word) {
    int count = 0;
    char *rest = NULL;
    for (char *t = strtok_r(text, " ", &rest); t && count < WORDS; t = strtok_r(NULL, " ", &rest))
        word[count++] = t;
    return count;
}

static void set_words(netlist *n, int at, char **word, int count) {
    char line[1024];
    size_t length = 0;
    for (int i = 0; i < count && length < sizeof line; i++)
        length += (size_t)snprintf(line + length, sizeof line - length, i ? " %s" : "%s", word[i]);
    netlist_set(n, at, line);
}

static int nodes_of(const char *line) {
    return strchr("RLCVIDrlcvid", line[0])                          ? 2
           : strchr("EGeg", line[0]) || strncmp(line, "AS", 2) == 0 ? 4
           : strchr("HFhf", line[0]) || strncmp(line, "AD", 2) == 0 ? 2
                                                                    : 0;
}

/* Node `from` becomes node `to` in all lines. */
static void join(netlist *n, const char *from, const char *to) {
    for (int i = 1; i < n->count; i++) {
        char text[1024], *word[WORDS];
        snprintf(text, sizeof text, "%s", n->line[i]);
        const int nodes = is_part(text) ? nodes_of(text) : 0, count = cut(text, word);
        int changed = 0;
        for (int k = 1; k <= nodes && k < count; k++)
            if (strcasecmp(word[k], from) == 0) {
                word[k] = (char *)to;
                changed = 1;
            }
        if (changed)
            set_words(n, i, word, count);
    }
}

/* Parts become short circuits. */
static void short_parts(search *s) {
    for (int at = 1; at < s->n->count; at++) {
        char text[1024], *word[WORDS];
        snprintf(text, sizeof text, "%s", s->n->line[at]);
        if (!is_part(text) || nodes_of(text) == 0 || cut(text, word) < 3)
            continue;
        const int second = strcmp(word[2], "0") == 0; /* ground stays */
        netlist c = netlist_copy(s->n);
        netlist_drop(&c, at);
        join(&c, word[second ? 1 : 2], word[second ? 2 : 1]);
        if (keep(s, &c))
            at--;
    }
}

/* A parameter of a model, or an initial condition, goes. */
static void drop_parameters(search *s) {
    for (int at = 1; at < s->n->count; at++)
        for (int k = 1; k < WORDS; k++) {
            char text[1024], *word[WORDS];
            snprintf(text, sizeof text, "%s", s->n->line[at]);
            const int model = strncmp(text, ".model", 6) == 0, count = cut(text, word);
            if (k >= count)
                break;
            char *equal = strchr(word[k], '='), *bracket = strchr(word[k], ')'), *open = strchr(word[k], '(');
            if (!equal || (!model && strncmp(word[k], "ic=", 3) != 0))
                continue;
            if (model && open)
                open[1] = 0;
            else
                word[k][0] = 0;
            char kept[1024];
            snprintf(kept, sizeof kept, "%s%s", word[k], model && bracket ? ")" : "");
            word[k] = kept;
            netlist c = netlist_copy(s->n);
            set_words(&c, at, word, count);
            keep(s, &c);
        }
}

static void shorten(search *s) {
    static const double factors[] = {0.1, 0.5, 0.75};
    for (int k = 0; k < 3;) {
        netlist c = netlist_copy(s->n);
        int changed = 0;
        for (int i = 1; i < c.count; i++) {
            char text[1024], *word[WORDS], stop[32];
            snprintf(text, sizeof text, "%s", c.line[i]);
            const int count = cut(text, word);
            if (count < 3 || strcmp(word[0], ".tran") != 0 ||
                strtod(word[2], NULL) < 4 * strtod(word[1], NULL))
                continue;
            snprintf(stop, sizeof stop, "%.4g", factors[k] * strtod(word[2], NULL));
            word[2] = stop;
            set_words(&c, i, word, count);
            changed = 1;
        }
        if (!changed)
            netlist_free(&c);
        if (!changed || !keep(s, &c))
            k++;
    }
}

/* Numbers of a part with fewer digits. */
static void round_numbers(search *s, const char *format) {
    for (int at = 1; at < s->n->count; at++) {
        char text[1024], *word[WORDS], number[WORDS][32];
        snprintf(text, sizeof text, "%s", s->n->line[at]);
        const int first = is_part(text) ? nodes_of(text) + 1 : WORDS, count = cut(text, word);
        int changed = 0;
        for (int k = first; k < count && first > 1; k++) {
            char *end;
            const double value = strtod(word[k], &end);
            if (end == word[k] || *end)
                continue;
            snprintf(number[k], 32, format, value);
            changed |= strcmp(number[k], word[k]) != 0;
            word[k] = number[k];
        }
        netlist c = netlist_copy(s->n);
        if (changed)
            set_words(&c, at, word, count);
        if (changed)
            keep(s, &c);
        else
            netlist_free(&c);
    }
}

/* Only the runs that show it. */
static void choose_runs(judge_options *o, const judge_finding *f) {
    const int alone = f->culprit >= 0 && (strstr(f->kind, "(S4)") || strstr(f->kind, "NS_E_") ||
                                          f->verdict == JUDGE_CRASHED || f->verdict == JUDGE_SLOW);
    o->verbose = 0;
    o->theta = strstr(f->kind, "theta") != NULL;
    if (alone)
        o->runs = 1u << f->culprit;
    else if (f->culprit >= 0)
        o->runs = 1u << f->culprit | 1u << J_EXACT | 1u << J_SPARSE;
}

void shrink(netlist *n, judge_finding *f, const judge_options *o, double seconds) {
    search s = {n, f, *o, now() + seconds, f->verdict != JUDGE_RIGHT};
    choose_runs(&s.o, f);
    while (s.gained && now() < s.until) {
        s.gained = 0;
        shorten(&s);
        drop_parts(&s);
        short_parts(&s);
        drop_parameters(&s);
    }
    round_numbers(&s, "%.1g");
    round_numbers(&s, "%.2g");
}
