/* tests/host/host.c - a program that uses libngspice, as KiCad and PySpice do: writes what it is told.
 *
 *     host NONSMOOTH.cm NETLIST run|bg_run OUT
 *
 * Loads the code models and the netlist, whose .control section ngspice runs; without one, runs the analyses
 * of the netlist, in the background (bg_run) or not.  OUT gets each string that ngspice gives to the callback
 * SendChar, one a line, in brackets.  Exit status 0, or 1 after a line on stderr. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "callbacks.h"

enum { LINES_MAX = 1000, LINE_SIZE = 10000 };

static FILE *out;

static int send_char(char *text, int id, void *user) {
    (void)id, (void)user;
    fprintf(out, "[%s]\n", text);
    fflush(out);
    return 0;
}

/* Of `quit`: ngspice asks to be left. */
static int controlled_exit(int status, NG_BOOL now, NG_BOOL by_quit, int id, void *user) {
    (void)status, (void)now, (void)by_quit, (void)id, (void)user;
    return 0;
}

static void command(const char *word, const char *rest) {
    char line[LINE_SIZE];
    snprintf(line, sizeof line, "%s%s", word, rest);
    ngSpice_Command(line);
}

/* Gives ngspice the lines of a netlist but for its .control section. */
static int give_circuit(const char *netlist) {
    static char text[LINES_MAX][LINE_SIZE];
    char *lines[LINES_MAX + 1] = {NULL};
    int n = 0;
    int inside = 0;
    FILE *file = fopen(netlist, "r");
    while (file && n < LINES_MAX && fgets(text[n], LINE_SIZE, file)) {
        text[n][strcspn(text[n], "\n")] = '\0';
        inside = inside ? strncmp(text[n], ".endc", 5) != 0 : strncmp(text[n], ".control", 8) == 0;
        if (!inside && strncmp(text[n], ".endc", 5) != 0) {
            lines[n] = text[n];
            n++;
        }
    }
    if (file)
        fclose(file);
    return n > 0 ? ngSpice_Circ(lines) : 1;
}

int main(int argc, char **argv) {
    if (argc != 5 || !(out = fopen(argv[4], "w"))) {
        fputs("host: NONSMOOTH.cm NETLIST source|run|bg_run OUT\n", stderr);
        return 1;
    }
    ngSpice_Init(send_char, send_stat, controlled_exit, send_data, send_init_data, thread_runs, NULL);
    command("codemodel ", argv[1]);
    if (strcmp(argv[3], "source") == 0)
        command("source ", argv[2]);
    else if (give_circuit(argv[2]) == 0)
        command(argv[3], "");
    pause_ms(100); /* until a thread in the background has begun */
    for (int k = 0; k < 1000 && ngSpice_running(); k++)
        pause_ms(10);
    fclose(out);
    return 0;
}
