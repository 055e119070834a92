/* tests/rig/wrap_alloc.c - malloc, calloc and realloc with a countdown to failure (linker option --wrap). */
#include "wrap_alloc.h"

#include <stdlib.h>

#include <suitesparse/SuiteSparse_config.h>

/* The linker makes these names: __real_f is libc's f, and every call of f becomes one of __wrap_f. */
void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t size);

static int counting;
static long fail_at;
static long made;

void fail_alloc_at(long k) {
    counting = 1;
    fail_at = k;
    made = 0;
}

long allocs_made(void) {
    return made;
}

void fail_alloc_off(void) {
    counting = 0;
}

static int must_fail(void) {
    if (!counting)
        return 0;
    ++made;
    return made == fail_at;
}

void *__wrap_malloc(size_t size) {
    return must_fail() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size) {
    return must_fail() ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *p, size_t size) {
    return must_fail() ? NULL : __real_realloc(p, size);
}

void fail_alloc_in_suitesparse(int yes) {
    void *(*const function)(size_t) = yes ? __wrap_malloc : __real_malloc;
#if SUITESPARSE_MAIN_VERSION >= 7
    SuiteSparse_config_malloc_func_set(function);
#else
    SuiteSparse_config.malloc_func = function;
#endif
}
