/* tests/stress/vary.c - values, size, order and names of a netlist. */
#define _POSIX_C_SOURCE 200809L
#include "vary.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dice.h"

enum { WORDS = 64, SIZE = 1024, NAMES = 400, LINES = 600, STREAM = 4001 };
static const double LEAST = 0.3, MOST = 3;

/* A line as words and what stands between them: between[i] before word[i], the last one behind all. */
typedef struct line_words {
    int count;
    char word[WORDS][48], between[WORDS + 1][16];
} line_words;

typedef struct variation {
    unsigned long long number;
    dice d;
    int alike; /* equal values of equal parameters: one factor */
    int copies;
    int nodes, parts;
    char node[NAMES][48], part[NAMES][48];
    int node_as[NAMES], part_as[NAMES];
    netlist *to;
} variation;

/* --- words --- */

static int is_between(char c) {
    return c && strchr(" \t(),=", c) != NULL;
}

static void cut(const char *s, line_words *w) {
    memset(w, 0, sizeof *w);
    while (w->count < WORDS) {
        int k = 0;
        for (; is_between(*s); s++)
            if (k < 15)
                w->between[w->count][k++] = *s;
        if (!*s)
            return;
        for (k = 0; *s && !is_between(*s); s++)
            if (k < 47)
                w->word[w->count][k++] = (char)tolower((unsigned char)*s);
        w->count++;
    }
}

static void put(netlist *n, const line_words *w) {
    char line[SIZE];
    int at = 0;
    for (int i = 0; i < w->count && at < SIZE - 70; i++)
        at += snprintf(line + at, sizeof line - (size_t)at, "%s%s", w->between[i], w->word[i]);
    snprintf(line + at, sizeof line - (size_t)at, "%s", w->between[w->count]);
    netlist_put(n, "%s", line);
}

/* --- values --- */

static double value_of(const char *s, int *is_number) {
    static const char letters[] = "tgkmunpf";
    static const double factors[] = {1e12, 1e9, 1e3, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15};
    char *end;
    const double v = strtod(s, &end);
    *is_number = end != s;
    if (strncmp(end, "meg", 3) == 0)
        return v * 1e6;
    const char *at = *end ? strchr(letters, *end) : NULL;
    return at ? v * factors[at - letters] : v;
}

/* A factor that what, as it stands in the text, has in the whole circuit, or in this line alone. */
static double factor(variation *v, const char *parameter, const char *what) {
    unsigned hash = 2166136261u;
    if (!v->alike)
        return dice_decades(&v->d, log10(LEAST), log10(MOST));
    for (const char *c = parameter; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 16777619u;
    for (const char *c = what; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 16777619u;
    dice own = dice_make(hash & 0xffff, v->number);
    return dice_decades(&own, log10(LEAST), log10(MOST));
}

static void multiply(line_words *w, int at, double by) {
    int is_number;
    const double value = at < w->count ? value_of(w->word[at], &is_number) : 0;
    if (at < w->count && is_number)
        snprintf(w->word[at], sizeof w->word[at], "%.6g", value * by);
}

static void vary_word(variation *v, line_words *w, int at, const char *parameter) {
    if (at < w->count)
        multiply(w, at, factor(v, parameter, w->word[at]));
}

static void multiply_all(line_words *w, int from, int to, double by) {
    for (int i = from; i <= to; i++)
        multiply(w, i, by);
}

/* PULSE(v1 v2 td tr tf pw per): amplitude; all times together, edges as well and never past the period. */
static void vary_source(variation *v, line_words *w) {
    const char *kind = w->count > 4 ? w->word[3] : "";
    const double amplitude = factor(v, "amplitude", w->count > 5 ? w->word[5] : w->word[3]);
    const double time = factor(v, "time", w->count > 10 ? w->word[10] : w->word[w->count - 1]);
    if (strcmp(kind, "pulse") == 0) {
        multiply_all(w, 4, 5, amplitude);
        multiply_all(w, 6, w->count - 1, time);
    } else if (strcmp(kind, "sin") == 0) {
        multiply_all(w, 4, 5, amplitude);
        multiply(w, 6, time);
    } else if (strcmp(kind, "pwl") == 0) {
        for (int i = 4; i + 1 < w->count; i += 2) {
            multiply(w, i, time);
            multiply(w, i + 1, amplitude);
        }
    } else
        vary_word(v, w, w->count - 1, "level");
}

static void vary_model(variation *v, line_words *w) {
    for (int i = 3; i + 1 < w->count; i += 2)
        vary_word(v, w, i + 1, w->word[i]);
}

/* tstep tstop tstart tmax: steps by one factor; a run is not made longer than some 1e5 of its steps. */
static void vary_tran(variation *v, line_words *w) {
    const double step = factor(v, "step", w->word[1]), stop = fmin(1, factor(v, "stop", w->word[2]));
    multiply(w, 1, step);
    multiply(w, 2, stop);
    if (w->count > 4)
        multiply(w, 4, step);
}

static int nodes_of(const line_words *w) {
    const char c = w->word[0][0];
    return strchr("rlcvidhf", c) ? 2 : strchr("eg", c) ? 4 : c == 'a' ? w->count - 2 : 0;
}

static void vary_part(variation *v, line_words *w) {
    const char c[2] = {w->word[0][0], 0};
    if (strchr("rlc", c[0]))
        vary_word(v, w, 3, c);
    else if (strchr("eg", c[0]))
        vary_word(v, w, 5, c);
    else if (strchr("hf", c[0]))
        vary_word(v, w, 4, c);
    else if (strchr("vi", c[0]))
        vary_source(v, w);
}

/* --- names --- */

static int place(char (*names)[48], int *count, const char *name) {
    for (int i = 0; i < *count; i++)
        if (strcmp(names[i], name) == 0)
            return i;
    if (*count == NAMES)
        abort();
    snprintf(names[*count], 48, "%s", name);
    return (*count)++;
}

static void name_node(variation *v, char *word, int copy) {
    if (strcmp(word, "0") != 0)
        snprintf(word, 48, "n%dx%d", v->node_as[place(v->node, &v->nodes, word)], copy);
}

static void name_part(variation *v, char *word, int copy) {
    const char letter = word[0];
    snprintf(word, 48, "%c%dx%d", letter, v->part_as[place(v->part, &v->parts, word)], copy);
}

/* A model's name is one of its copy. */
static void name_model(char *word, int copy) {
    const size_t length = strlen(word);
    snprintf(word + length, 48 - length, "x%d", copy);
}

static void name_line(variation *v, line_words *w, int copy) {
    const int nodes = nodes_of(w), names = strchr("hf", w->word[0][0]) ? 1 : w->word[0][0] == 'k' ? 2 : 0;
    for (int i = 1; i <= nodes && i < w->count; i++)
        name_node(v, w->word[i], copy);
    for (int i = 0; i < names; i++)
        name_part(v, w->word[(names == 1 ? 3 : 1) + i], copy);
    if (w->word[0][0] == 'a')
        name_model(w->word[w->count - 1], copy);
    name_part(v, w->word[0], copy);
}

static void permute(dice *d, int *as) {
    for (int i = 0; i < NAMES; i++)
        as[i] = i + 1;
    for (int i = NAMES - 1; i > 0; i--) {
        const int j = dice_below(d, i + 1), kept = as[i];
        as[i] = as[j];
        as[j] = kept;
    }
}

/* --- lines --- */

static int is_part(const char *line) {
    return isalpha((unsigned char)line[0]) && strncasecmp(line, "aopt", 4) != 0;
}

static void copy_parts(variation *v, const netlist *from, int copy) {
    line_words w;
    for (int i = 1; i < from->count; i++) {
        const int model = strncasecmp(from->line[i], ".model", 6) == 0;
        if (!model && !is_part(from->line[i]))
            continue;
        cut(from->line[i], &w);
        if (model) {
            name_model(w.word[1], copy);
            vary_model(v, &w);
        } else {
            vary_part(v, &w);
            name_line(v, &w, copy);
        }
        put(v->to, &w);
    }
}

/* A node of the copy, and that of the first one. */
static void join(variation *v, int copy) {
    const int at = v->node_as[dice_below(&v->d, v->nodes)];
    netlist_put(v->to, "rjoin%d n%dx0 n%dx%d %.3g", copy, at, at, copy, dice_decades(&v->d, 0, 6));
}

static void shuffle_lines(variation *v) {
    netlist *n = v->to;
    for (int i = n->count - 1; i > 1; i--) {
        const int j = 1 + dice_below(&v->d, i);
        char *kept = n->line[i];
        n->line[i] = n->line[j];
        n->line[j] = kept;
    }
}

/* What is compared: only what `from` names, in the first copy, or all. */
static void put_save(variation *v, const char *line) {
    line_words w;
    cut(line, &w);
    for (int i = 1; i < w.count; i++) {
        const int current = w.word[i][0] == 'i', voltage = w.word[i][0] == 'v' && !w.word[i][1];
        if ((current || voltage) && !w.word[i][1] && i + 1 < w.count) {
            for (i++; i < w.count && !strchr(w.between[i], ' '); i++) {
                if (current)
                    name_part(v, w.word[i], 0);
                else
                    name_node(v, w.word[i], 0);
            }
            i--;
        }
    }
    put(v->to, &w);
}

void vary(const netlist *from, unsigned long long number, netlist *to) {
    variation *v = calloc(1, sizeof *v);
    line_words w;
    if (!v)
        abort();
    v->number = number;
    v->d = dice_make(STREAM, number);
    v->to = to;
    v->alike = dice_chance(&v->d, 0.5);
    v->copies = dice_chance(&v->d, 0.33) ? 2 : 1;
    permute(&v->d, v->node_as);
    permute(&v->d, v->part_as);
    netlist_put(to, "%s, varied %llu", from->line[0], number);
    for (int copy = 0; copy < v->copies; copy++) {
        copy_parts(v, from, copy);
        if (copy > 0)
            join(v, copy);
    }
    shuffle_lines(v);
    for (int i = 1; i < from->count; i++)
        if (strncasecmp(from->line[i], ".tran", 5) == 0) {
            cut(from->line[i], &w);
            vary_tran(v, &w);
            put(to, &w);
        } else if (strncasecmp(from->line[i], ".save", 5) == 0 && v->copies == 1)
            put_save(v, from->line[i]);
    free(v);
}
