/* src/system/each_entry.h - the entries of a system that are not zero, dense or large, one by one. */
#ifndef NS_SYSTEM_EACH_ENTRY_H
#define NS_SYSTEM_EACH_ENTRY_H

#include <stddef.h>

#include "nonsmooth/system.h"

#define NS_CSC_OF(s, which) ((s)->large ? &(s)->large->which : NULL)

/* Entries that are not zero, of an array or a sparse matrix (either may be NULL); of all controls' gx. */
typedef void ns_visit(void *context, int row, int column, double value);
void ns_system_each_entry(const double *dense, const ns_csc *sparse, int rows, int columns, ns_visit *visit,
                          void *context);
void ns_system_each_control(const ns_system *s, ns_visit *visit, void *context);

#endif
