/* bridge/interrupt.c - Ctrl-C while no point of ngspice's is at hand: its own flag is not exported. */
#define _GNU_SOURCE /* sigaction() */
#include "interrupt.h"

#ifdef __linux__
#include <signal.h>

static struct {
    volatile sig_atomic_t came;
    int watches;
    struct sigaction before;
} state;

/* Once: that of before is there again before it is called, as ngspice's sets itself anew. */
static void note(int number, siginfo_t *info, void *context) {
    state.came = 1;
    sigaction(number, &state.before, NULL);
    if (state.before.sa_flags & SA_SIGINFO)
        state.before.sa_sigaction(number, info, context);
    else
        state.before.sa_handler(number);
}

void ns_bridge_interrupt_watch(void) {
    struct sigaction now = {.sa_sigaction = note, .sa_flags = SA_SIGINFO | SA_RESTART};
    state.came = 0;
    state.watches = sigaction(SIGINT, NULL, &state.before) == 0 &&
                    (state.before.sa_flags & SA_SIGINFO ||
                     (state.before.sa_handler != SIG_DFL && state.before.sa_handler != SIG_IGN));
    sigemptyset(&now.sa_mask);
    state.watches = state.watches && sigaction(SIGINT, &now, NULL) == 0;
}

int ns_bridge_interrupt_came(void) {
    return state.watches && state.came;
}

void ns_bridge_interrupt_leave(void) {
    if (state.watches && !state.came)
        sigaction(SIGINT, &state.before, NULL);
    state.watches = 0;
}

#else

void ns_bridge_interrupt_watch(void) {
}

int ns_bridge_interrupt_came(void) {
    return 0;
}

void ns_bridge_interrupt_leave(void) {
}

#endif
