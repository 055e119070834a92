/* tests/mutants/record.c - which functions of the library a program calls: their offsets in the shared
 * object, one a line, into the file that the environment names in CALLS.  Linked with objects made by gcc
 * -finstrument-functions. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROOM = 1 << 14 };
static void *called[ROOM];

void __cyg_profile_func_enter(void *function, void *site) {
    size_t at = ((uintptr_t)function >> 4) * 2654435761u % ROOM;
    (void)site;
    while (called[at] && called[at] != function)
        at = (at + 1) % ROOM;
    called[at] = function;
}

void __cyg_profile_func_exit(void *function, void *site) {
    (void)function;
    (void)site;
}

__attribute__((destructor)) static void write_calls(void) {
    const char *name = getenv("CALLS");
    FILE *file = name ? fopen(name, "w") : NULL;
    Dl_info own;
    for (int i = 0; i < ROOM && file; i++)
        if (called[i] && dladdr(called[i], &own))
            fprintf(file, "0x%tx\n", (char *)called[i] - (char *)own.dli_fbase);
    if (file)
        (void)fclose(file);
}
