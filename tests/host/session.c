/* tests/host/session.c - a session of a program that uses libngspice: runs, stops, alters, resumes, resets,
 * twice.
 *
 *     session NONSMOOTH.cm
 *
 * A buck converter with a duty cycle of 0.4: v(out) is 0.4 times the input, whatever the load (theory of the
 * converter; ripple and the rest of the start are below 1 % at the end).  A run in the background is halted,
 * its input doubled, and goes on to its end; after `reset` it is what it was.  All of that twice, the second
 * time with another circuit.  Prints `ok NAME` or `FAIL NAME reason` for each step; exit status 1 if one
 * failed. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "callbacks.h"

static int failed;
static char said[1000]; /* by the models */

static int send_char(char *text, int id, void *user) {
    (void)id, (void)user;
    const char *ours = strstr(text, "Instance: nonsmooth   Message: ");
    if (ours && !strstr(ours, "simulates this circuit"))
        snprintf(said, sizeof said, "%s", ours);
    return 0;
}

static int controlled_exit(int status, NG_BOOL now, NG_BOOL by_quit, int id, void *user) {
    (void)now, (void)by_quit, (void)id, (void)user;
    printf("FAIL host_session ngspice wants to end with %d\n", status);
    failed = 1;
    return 0;
}

static int command(const char *text) {
    char line[1000];
    snprintf(line, sizeof line, "%s", text);
    return ngSpice_Command(line);
}

static void wait_for_end(void) {
    pause_ms(100); /* until the thread has begun */
    for (int k = 0; k < 6000 && ngSpice_running(); k++)
        pause_ms(10);
}

/* The last value of a vector, NAN if there is none. */
static double last(const char *vector) {
    char name[100];
    snprintf(name, sizeof name, "%s", vector);
    const struct vector_info *v = ngGet_Vec_Info(name);
    return v && v->v_realdata && v->v_length > 0 ? v->v_realdata[v->v_length - 1] : NAN;
}

static void verdict(const char *step, const char *circuit, double got, double low, double high) {
    const int good = got >= low && got <= high && !said[0];
    printf("%s host_session %s, %s V", good ? "ok" : "FAIL", step, circuit);
    if (!good)
        printf(": %g, expected %g to %g; %s", got, low, high, said[0] ? said : "no message");
    putchar('\n');
    fflush(stdout);
    failed |= !good;
}

static int give_circuit(const char *volts) {
    char input[40];
    char *lines[] = {"* buck converter",
                     input,
                     "VG gate 0 pulse(0 1 0 1n 1n 3.999u 10u)",
                     "AS1 in x gate 0 sw",
                     "AD1 0 x d",
                     "L1 x out 100u",
                     "C1 out 0 10u",
                     "R1 out 0 5",
                     "AOPT 0 opts",
                     ".model sw ideal_switch",
                     ".model d ideal_diode",
                     ".model opts nonsmooth(points=\"grid\" corners=0)",
                     ".tran 0.5u 100m 0 0.5u",
                     ".end",
                     NULL};
    snprintf(input, sizeof input, "V1 in 0 %s", volts);
    return ngSpice_Circ(lines);
}

static void session(const char *volts, double input) {
    const double end = 0.1, expected = 0.4 * input;
    verdict("circuit", volts, give_circuit(volts), 0, 0);
    command("bg_run");
    pause_ms(60);
    command("bg_halt");
    verdict("halted on the way", volts, last("time"), 1e-6, 0.99 * end);
    char alter[60];
    snprintf(alter, sizeof alter, "alter v1 = %g", 2 * input);
    command(alter);
    command("bg_resume");
    wait_for_end();
    verdict("goes on to its end", volts, last("time"), 0.9999 * end, 1.0001 * end);
    verdict("altered", volts, last("out"), 2 * 0.99 * expected, 2 * 1.01 * expected);
    command("reset");
    command("run");
    verdict("reset, and run again", volts, last("out"), 0.99 * expected, 1.01 * expected);
}

int main(int argc, char **argv) {
    char load[1000];
    if (argc != 2)
        return 2;
    ngSpice_Init(send_char, send_stat, controlled_exit, send_data, send_init_data, thread_runs, NULL);
    snprintf(load, sizeof load, "codemodel '%s'", argv[1]);
    command(load);
    session("12", 12);
    session("6", 6);
    return failed;
}
