/* bridge/report.c - messages on ngspice's console, one line each. */
#include "report.h"

#include <stdarg.h>

#include "ngspice.h"
#include "ngspice/cmproto.h"
#include "nonsmooth/status.h"

static void write_line(FILE *stream, FILE *instead, const char *format, va_list values) REPORT_PRINTF(3, 0);

/* stream is NULL while ngspice has no console of its own yet. */
static void write_line(FILE *stream, FILE *instead, const char *format, va_list values) {
    stream = stream ? stream : instead;
    fputs("nonsmooth: ", stream);
    vfprintf(stream, format, values);
    fputc('\n', stream);
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
    static const int codes[][2] = {{NS_OK, OK},
                                   {NS_E_MEMORY, E_NOMEM},
                                   {NS_E_NUMBER, E_PARMVAL},
                                   {NS_E_RANGE, E_PARMVAL},
                                   {NS_E_BOUNDS, E_PARMVAL},
                                   {NS_E_SIZE, E_PARMVAL},
                                   {NS_E_NAME, E_PARMVAL},
                                   {NS_E_LIMIT, E_ITERLIM},
                                   {NS_E_OVERFLOW, E_MAGEXCEEDED},
                                   {NS_E_SINGULAR, E_SINGULAR},
                                   {NS_E_INFEASIBLE, E_SINGULAR},
                                   {NS_E_RESIDUAL, E_SINGULAR}};
    for (size_t k = 0; k < sizeof codes / sizeof codes[0]; k++)
        if (codes[k][0] == status)
            return codes[k][1];
    return E_UNSUPP;
}
