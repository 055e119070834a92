/* tests/compare/main.c - the program of `make compare`, linked with the library of either commit.
 *
 *     compare list                     the runs: circuit and engine, one a line
 *     compare CIRCUIT ENGINE [FILE]    one of them, its results into FILE
 *     compare table                    what tests/reference/test_effort.c holds of all of them */
#include "timing.h"

#include <string.h>

#include "circuits.h"

static void print_row(int at, const char *name, const char *engine) {
    ns_counts c;
    const double sum = circuits_run(at, NULL, &c);
    const long counts[] = {c.steps, c.trials,  c.events, c.problems, c.pivots,       c.factors, c.maps,
                           c.jumps, c.islands, c.modes,  c.searches, c.input_states, c.periods, c.predicted};
    printf("{\"%s\", \"%s\", %.12g, {", name, engine, sum);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        printf("%s%ld", i > 0 ? ", " : "", counts[i]);
    printf("}},\n");
}

static void run(int at, const char *path) {
    ns_counts counts;
    FILE *file = fopen(path, "w");
    if (!file) {
        perror(path);
        exit(1);
    }
    (void)circuits_run(at, file, &counts);
    if (fclose(file) != 0)
        exit(1);
}

int main(int argc, char **argv) {
    const char *engine, *name;
    for (int at = 0; (name = circuits_name(at, &engine)); at++)
        if (argc == 2 && strcmp(argv[1], "list") == 0)
            printf("%s %s\n", name, engine);
        else if (argc == 2)
            print_row(at, name, engine);
        else if (argc >= 3 && strcmp(argv[1], name) == 0 && strcmp(argv[2], engine) == 0)
            run(at, argc > 3 ? argv[3] : "/dev/null");
    return 0;
}
