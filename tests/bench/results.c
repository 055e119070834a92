/* tests/bench/results.c - the CSV files of the cases, read again. */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "results.h"

enum { LINE = 512, FIELDS = 18 };

static int split(char *line, char **field) {
    int count = 0;
    for (char *at = line, *comma; count < FIELDS; at = comma + 1) {
        field[count++] = at;
        comma = strchr(at, ',');
        if (!comma)
            break;
        *comma = 0;
    }
    return count;
}

static void read_row(char *const *field, result_row *r) {
    r->kind = strcmp(field[1], "library") == 0     ? ROW_LIBRARY
              : strcmp(field[1], "elsewhere") == 0 ? ROW_RIVAL
                                                   : ROW_OURS;
    snprintf(r->series, sizeof r->series, "%s", field[2]);
    snprintf(r->setting, sizeof r->setting, "%s", field[3]);
    snprintf(r->end, sizeof r->end, "%s", field[4]);
    r->done = strcmp(r->end, "done") == 0;
    r->error = strtod(field[5], NULL);
    r->seconds = strtod(field[6], NULL);
    r->process = strtod(field[7], NULL);
    r->steps = strtol(field[8], NULL, 10);
    r->accumulation = strtod(field[16], NULL);
}

void results_read(const char *name, results *r) {
    char path[128], line[LINE], *field[FIELDS];
    snprintf(path, sizeof path, "build/bench/%s.csv", name);
    FILE *f = fopen(path, "r");
    r->count = 0;
    while (f && fgets(line, sizeof line, f))
        if (split(line, field) == FIELDS && strcmp(field[0], name) == 0 &&
            r->count < (int)(sizeof r->row / sizeof *r->row))
            read_row(field, &r->row[r->count++]);
    if (f)
        fclose(f);
}

static int fits(const result_row *r, row_kind kind, const char *series) {
    return r->done && r->kind == kind && (!series || strcmp(r->series, series) == 0);
}

const result_row *results_fastest(const results *r, row_kind kind, const char *series, double level) {
    const result_row *best = NULL;
    for (int i = 0; i < r->count; i++)
        if (fits(&r->row[i], kind, series) && r->row[i].error <= level &&
            (!best || r->row[i].seconds < best->seconds))
            best = &r->row[i];
    return best;
}

const result_row *results_best(const results *r, row_kind kind, const char *series) {
    const result_row *best = NULL;
    for (int i = 0; i < r->count; i++)
        if (fits(&r->row[i], kind, series) && (!best || r->row[i].error < best->error))
            best = &r->row[i];
    return best;
}
