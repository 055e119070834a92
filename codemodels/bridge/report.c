/* bridge/report.c - what the bridge says on ngspice's console: one line a message. */
#include "report.h"

#include <stdarg.h>

#include "ngspice.h"
#include "ngspice/cmproto.h"
#include "nonsmooth/status.h"

static void say(FILE *stream, FILE *instead, const char *format, va_list values) REPORT_PRINTF(3, 0);

/* stream is NULL while ngspice has no console of its own yet. */
static void say(FILE *stream, FILE *instead, const char *format, va_list values) {
    stream = stream ? stream : instead;
    fputs("nonsmooth: ", stream);
    vfprintf(stream, format, values);
    fputc('\n', stream);
    fflush(stream);
}

void ns_bridge_report_error(const char *format, ...) {
    va_list values;
    va_start(values, format);
    say(cm_stream_err(), stderr, format, values);
    va_end(values);
}

void ns_bridge_report_note(const char *format, ...) {
    va_list values;
    va_start(values, format);
    say(cm_stream_out(), stdout, format, values);
    va_end(values);
}

int ns_bridge_report_code(int status) {
    switch (status) {
    case NS_OK:
        return OK;
    case NS_E_MEMORY:
        return E_NOMEM;
    case NS_E_NUMBER:
    case NS_E_RANGE:
    case NS_E_BOUNDS:
    case NS_E_SIZE:
    case NS_E_NAME:
        return E_PARMVAL;
    case NS_E_LIMIT:
        return E_ITERLIM;
    case NS_E_OVERFLOW:
        return E_MAGEXCEEDED;
    case NS_E_SINGULAR:
    case NS_E_INFEASIBLE:
    case NS_E_RESIDUAL:
        return E_SINGULAR;
    default:
        return E_UNSUPP;
    }
}
