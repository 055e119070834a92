/* bridge/report.h - messages on ngspice's console, one line each. */
#ifndef BRIDGE_REPORT_H
#define BRIDGE_REPORT_H

#if defined(__GNUC__)
#define REPORT_PRINTF(format, first)                                                                         \
    __attribute__((__format__(__printf__, format, first), __nonnull__(format)))
#else
#define REPORT_PRINTF(format, first)
#endif

/* "nonsmooth: ...", on the error stream and on the output stream. */
void ns_bridge_report_error(const char *format, ...) REPORT_PRINTF(1, 2);
void ns_bridge_report_note(const char *format, ...) REPORT_PRINTF(1, 2);

/* The code of ngspice that comes nearest to a status of the library. */
int ns_bridge_report_code(int status);

#endif
