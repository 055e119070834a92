/* tests/bench/facts.c - single figures, in build/bench/facts.csv. */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "facts.h"

static const char *const path = "build/bench/facts.csv";

void fact_put(const char *what, double value) {
    FILE *f = fopen(path, "a");
    if (!f)
        return; /* run by hand, elsewhere */
    fprintf(f, "%s,%.9g\n", what, value);
    fclose(f);
}

double fact_get(const char *what) {
    char line[256];
    double value = NAN;
    const size_t length = strlen(what);
    FILE *f = fopen(path, "r");
    while (f && fgets(line, sizeof line, f))
        if (strncmp(line, what, length) == 0 && line[length] == ',')
            value = strtod(line + length + 1, NULL);
    if (f)
        fclose(f);
    return value;
}

double growth(int count, const double *size, const double *value) {
    double x = 0, y = 0, xx = 0, xy = 0;
    if (count < 2)
        return NAN;
    for (int i = 0; i < count; i++) {
        const double lx = log(size[i]), ly = log(value[i]);
        x += lx / count;
        y += ly / count;
        xx += lx * lx / count;
        xy += lx * ly / count;
    }
    return (xy - x * y) / (xx - x * x);
}
