/* tests/fault/retry.h - calls that are made again where an allocation failed in them. */
#ifndef RETRY_H
#define RETRY_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "wrap_alloc.h"

/* One call under test.  A call that fails is made again, with nothing failing any more. */
static int fails; /* seen in this run */
static inline int again(int status) {
    if (status == NS_OK)
        return 0;
    assert_int_equal(status, NS_E_MEMORY);
    fail_alloc_off();
    return fails++ == 0;
}
#define TRY(call)                                                                                            \
    do {                                                                                                     \
        while (again(call)) {                                                                                \
        }                                                                                                    \
    } while (0)

#endif
