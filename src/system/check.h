/* src/system/check.h - what the checks of systems and of models share. */
#ifndef NS_SYSTEM_CHECK_H
#define NS_SYSTEM_CHECK_H

#include "nonsmooth/status.h"

/* What a row or a column of an array belongs to. */
typedef enum ns_owner { NS_NOTHING, NS_UNKNOWN, NS_PAIR } ns_owner;

/* Fills fault (may be NULL) with the status and one index, and returns the status. */
int ns_system_blame(ns_fault *fault, int status, ns_owner who, int index);

/* A p*q array, all finite; a bad entry is blamed on its row or its column.  Errors: NULL, NUMBER. */
int ns_system_check_array(const double *a, int p, int q, ns_owner row, ns_owner column, ns_fault *fault);

#endif
