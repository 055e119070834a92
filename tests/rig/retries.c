/* tests/rig/retries.c - an answer that was found wrong, and computed again by another engine, is right in the
 * end: no test would notice that an engine was wrong.  So the end of a march fails where that happened, in
 * every test that does not expect it.  Test programs are linked with -Wl,--wrap=ns_march_free. */
#include "retries.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* The linker makes these names: __real_f is the library's f, and every call of f in a test one of __wrap_f.
 */
void __real_ns_march_free(ns_march *m);
void __wrap_ns_march_free(ns_march *m);

static long allowed;

void allow_retries(long marches) {
    allowed = marches;
}

void __wrap_ns_march_free(ns_march *m) {
    const long retries = m ? ns_march_counts(m)->retries : 0;
    __real_ns_march_free(m);
    if (retries > 0 && allowed-- <= 0)
        fail_msg("%ld results were wrong, and computed again by another engine", retries);
}
