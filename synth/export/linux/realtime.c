#include "realtime.h"

#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#define SECOND 1000000000L

void realtime_become(int cpu)
{
    const struct sched_param wish = {.sched_priority = REALTIME_PRIORITY};
    cpu_set_t one;
    CPU_ZERO(&one);
    if (cpu >= 0) CPU_SET((size_t)cpu, &one);
    if (cpu >= 0 && sched_setaffinity(0, sizeof one, &one) != 0) {
        (void)fprintf(stderr, "real time: processor %d: %s: the loop runs on any\n", cpu, strerror(errno));
    }
    if (sched_setscheduler(0, SCHED_FIFO, &wish) != 0) {
        (void)fprintf(stderr, "real time: SCHED_FIFO: %s: the loop may be late by milliseconds; run it as root, or "
            "with CAP_SYS_NICE or an rtprio limit\n", strerror(errno));
    }
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        (void)fprintf(stderr, "real time: mlockall: %s: a page may be read from disk within a sample; raise the "
            "memlock limit\n", strerror(errno));
    }
    (void)prctl(PR_SET_TIMERSLACK, 1uL); /* ns; without real time a sleep is else 50 us longer */
    /* Touch the stack that the loop will use. */
    volatile char stack[1 << 16];
    for (size_t i = 0; i < sizeof stack; i += 4096u) stack[i] = 0;
    (void)stack[0];
}

int64_t realtime_now(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * SECOND + now.tv_nsec;
}

uint64_t realtime_wait(int64_t *next, lateness_t *late)
{
    const struct timespec due = {.tv_sec = (time_t)(*next / SECOND), .tv_nsec = (long)(*next % SECOND)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL) == EINTR) continue;
    const int64_t lateness = realtime_now() - *next;
    const uint64_t missed = lateness > 0 ? (uint64_t)(lateness / STAGE_PERIOD_NS) : 0u;
    int bin = 0;
    while (bin < BINS - 1 && (lateness >> bin) >= 1000) bin++;
    late->bins[bin] += 1u;
    late->missed += missed;
    if (lateness > late->worst_ns) late->worst_ns = lateness;
    *next += (int64_t)(missed + 1u) * STAGE_PERIOD_NS;
    return missed;
}
