/* The clock of the loop: a real-time priority where that is allowed, absolute times, and how late each wake-up was. */
#ifndef REALTIME_H
#define REALTIME_H

#include <stdint.h>
#include <time.h>

#include "exchange.h"

#define REALTIME_PRIORITY 80 /* below the kernel's own threads at 99; the watchdog has one more */

/* Ask for SCHED_FIFO, locked memory and a processor (-1: any). What is refused is said, and the loop goes on. */
void realtime_become(int cpu);

int64_t realtime_now(void); /* ns of the monotonic clock, which no setting of the date moves */

/* Sleep until the next sample, and count how late it begins. Return how many periods were missed altogether; they are
 * skipped, and `next` is the sample after. */
uint64_t realtime_wait(int64_t *next, lateness_t *late);

#endif
