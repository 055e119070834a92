/* bridge/report.c - messages for the user, one line each.
 *
 * A host of libngspice sees what ngspice prints, not what a code model does.  cm_message_send() prints a line
 * for a code model, with the name of the instance that ngspice's MIFload() calls; that is replaced by our
 * load.  So MIFload() is given an instance of ours, without ports, that is in no circuit. */
#include "report.h"

#include <stdarg.h>
#include <time.h>

#include "host.h"
#include "ngspice/cmproto.h"
#include "nonsmooth/status.h"

enum { LINE_SIZE = 1000 };

static CKTcircuit *about;
static int sender_type;
static char *sent; /* NULL: no message is being sent */

void ns_bridge_report_about(CKTcircuit *ckt, int type) {
    about = ckt;
    sender_type = type;
}

void ns_bridge_report_cm_func(Mif_Private_t *unused) {
    (void)unused;
    if (sent)
        cm_message_send(sent);
}

static void send_to_host(char *line) {
    static char name[] = "nonsmooth";
    static MIFinstance instance = {.MIFname = name, .initialized = MIF_TRUE, .analog = MIF_TRUE};
    static MIFmodel model = {.gen.GENinstances = &instance.gen, .analog = MIF_TRUE};
    model.MIFmodType = sender_type;
    sent = line;
    MIFload(&model.gen, about);
    sent = NULL;
}

/* ngspice writes its progress each quarter of a second of CPU time, and leaves the line open. */
static int may_be_in_a_line(void) {
    return clock() >= CLOCKS_PER_SEC / 4;
}

static void write_line(FILE *stream, FILE *instead, const char *format, va_list values) REPORT_PRINTF(3, 0);

/* stream is NULL while ngspice has no console of its own yet. */
static void write_line(FILE *stream, FILE *instead, const char *format, va_list values) {
    char line[LINE_SIZE];
    vsnprintf(line, sizeof line, format, values);
    if (!ns_bridge_host_is_ngspice()) {
        send_to_host(line);
        return;
    }
    stream = stream ? stream : instead;
    fflush(stdout);
    fprintf(stream, "%snonsmooth: %s\n", may_be_in_a_line() ? "\n" : "", line);
    fflush(stream);
}

void ns_bridge_report_error(const char *format, ...) {
    va_list values;
    va_start(values, format);
    write_line(cm_stream_err(), stderr, format, values);
    va_end(values);
}

void ns_bridge_report_note(const char *format, ...) {
    va_list values;
    va_start(values, format);
    write_line(cm_stream_out(), stdout, format, values);
    va_end(values);
}

int ns_bridge_report_code(int status) {
    static const int codes[][2] = {
        {NS_OK, OK},
        {NS_E_MEMORY, E_NOMEM},
        {NS_E_NUMBER, E_PARMVAL},
        {NS_E_RANGE, E_PARMVAL},
        {NS_E_BOUNDS, E_PARMVAL},
        {NS_E_SIZE, E_PARMVAL},
        {NS_E_NAME, E_PARMVAL},
        {NS_E_LIMIT, E_ITERLIM},
        {NS_E_OVERFLOW, E_MAGEXCEEDED},
        {NS_E_SINGULAR, E_NOTFOUND}, /* not E_SINGULAR: ngspice would blame its matrix */
        {NS_E_INFEASIBLE, E_NOTFOUND},
        {NS_E_RESIDUAL, E_NOTFOUND},
        {NS_E_CHATTER, E_NOTFOUND}};
    for (size_t k = 0; k < sizeof codes / sizeof codes[0]; k++)
        if (codes[k][0] == status)
            return codes[k][1];
    return E_UNSUPP;
}
