/* bridge/host.c - the program that ngspice runs in. */
#define _GNU_SOURCE /* dladdr() */
#include "host.h"

#include "ngspice.h"
#include "ngspice/dllitf.h"

#ifdef __linux__
#include <dlfcn.h>
#include <stdint.h>
#include <sys/auxv.h>

extern struct coreInfo_t *coreitf; /* dlmain.c: functions of ngspice */

int ns_bridge_host_is_ngspice(void) {
    Dl_info ngspice;
    Dl_info program;
    /* NOLINTNEXTLINE(performance-no-int-to-ptr): addresses of code */
    const void *known = (const void *)(uintptr_t)coreitf->dllitf_cm_message_send;
    /* NOLINTNEXTLINE(performance-no-int-to-ptr) */
    const void *entry = (const void *)(uintptr_t)getauxval(AT_ENTRY);
    return dladdr(known, &ngspice) != 0 && dladdr(entry, &program) != 0 &&
           ngspice.dli_fbase == program.dli_fbase;
}

#else

int ns_bridge_host_is_ngspice(void) {
    return 0;
}

#endif
