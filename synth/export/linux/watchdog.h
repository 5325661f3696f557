/* The parent of the loop: hardware holds its last output when a process dies, so another one must drive it safe. */
#ifndef WATCHDOG_H
#define WATCHDOG_H

#include <sys/types.h>

#include "io.h"
#include "machine.h"

typedef struct {
    machine_t machine;
    uint64_t beat; /* counts the samples; 0 before the run and after its end in order */
} shared_t;

/* Have a handler for every signal that a terminal, a shell or a service manager sends to end or to stop a process: a
 * stopped one would leave the outputs where they are. */
void watchdog_signals(void (*handler)(int));

/* Watch the loop until it ends in order; where it ends in the middle of its run, dies, or stands still for `stall_s`,
 * kill it and drive the outputs safe. Return the exit status of the program. */
int watchdog_run(shared_t *shared, const io_t *io, pid_t loop, double stall_s);

#endif
