/* The parent of the loop: hardware holds its last output when a process dies, so another one must drive it safe. */
#ifndef WATCHDOG_H
#define WATCHDOG_H

#include <sys/types.h>

#include "io.h"
#include "machine.h"

typedef struct {
    machine_t machine;
    uint64_t beat; /* counts the samples */
} shared_t;

/* Watch the loop until it ends; where it dies, or stands still for `stall_s`, kill it and drive the outputs safe.
 * Return the exit status of the program. */
int watchdog_run(shared_t *shared, const io_t *io, pid_t loop, double stall_s);

#endif
