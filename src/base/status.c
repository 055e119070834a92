/* src/base/status.c - texts and names of the status codes, from the one table in status.h. */
#include "nonsmooth/status.h"

const char *ns_status_text(int status) {
    switch (status) {
#define CASE(name, value, text)                                                                              \
    case value:                                                                                              \
        return text;
        NS_STATUS_TABLE(CASE)
#undef CASE
    default:
        return "unknown status";
    }
}

const char *ns_status_name(int status) {
    switch (status) {
#define CASE(name, value, text)                                                                              \
    case value:                                                                                              \
        return #name;
        NS_STATUS_TABLE(CASE)
#undef CASE
    default:
        return "?";
    }
}
