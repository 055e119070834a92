/* src/system/dense_copy.h - a large system as one with arrays, for engines that need them. */
#ifndef NS_SYSTEM_DENSE_COPY_H
#define NS_SYSTEM_DENSE_COPY_H

#include "nonsmooth/system.h"

/* The caller frees *out.  Errors: MEMORY, those of ns_system_create(). */
int ns_system_dense_copy(const ns_system *s, ns_system **out);

#endif
