/* What the loop and the other threads exchange without a lock: commands to the loop, its status, and records of samples.
 *
 * Each has one writer and one reader. The atomic accesses are those of gcc and clang, which C99 has no name for. */
#ifndef EXCHANGE_H
#define EXCHANGE_H

#include <stdint.h>

#include "machine.h"

enum { BINS = 16 }; /* of lateness: below 1 us, 2 us, 4 us ..., and all above */

typedef struct {
    uint64_t missed, bins[BINS];
    int64_t worst_ns;
} lateness_t;

typedef struct {
    phase_t phase;
    const char *reason;
    uint32_t faults, latch_cause;
    int moving, may_start;
    uint64_t calls, commands;
    double sensors[N_SENSORS], set_points[SET_POINTS_SIZE], outputs[N_OUTPUTS];
    lateness_t late;
} status_t;

/* A slot for one command: full is 1 from the writer's last touch to the reader's. */
typedef struct {
    int full;
    command_t command;
} mailbox_t;

static inline int mailbox_put(mailbox_t *box, const command_t *command)
{
    if (__atomic_load_n(&box->full, __ATOMIC_ACQUIRE)) return -1;
    box->command = *command;
    __atomic_store_n(&box->full, 1, __ATOMIC_RELEASE);
    return 0;
}

static inline int mailbox_take(mailbox_t *box, command_t *command)
{
    if (!__atomic_load_n(&box->full, __ATOMIC_ACQUIRE)) return 0;
    *command = box->command;
    __atomic_store_n(&box->full, 0, __ATOMIC_RELEASE);
    return 1;
}

/* The changes of the phase, for the log: the loop writes `head`, the server `tail`. Changes beyond the size are lost. */
enum { EVENTS = 64 };
typedef struct {
    phase_t phase;
    const char *reason;
} event_t;
typedef struct {
    event_t events[EVENTS];
    unsigned head, tail;
} events_t;

static inline void events_put(events_t *log, phase_t phase, const char *reason)
{
    const unsigned head = __atomic_load_n(&log->head, __ATOMIC_RELAXED);
    if (head - __atomic_load_n(&log->tail, __ATOMIC_ACQUIRE) == EVENTS) return;
    log->events[head % EVENTS] = (event_t){phase, reason};
    __atomic_store_n(&log->head, head + 1u, __ATOMIC_RELEASE);
}

static inline int events_take(events_t *log, event_t *event)
{
    const unsigned tail = __atomic_load_n(&log->tail, __ATOMIC_RELAXED);
    if (tail == __atomic_load_n(&log->head, __ATOMIC_ACQUIRE)) return 0;
    *event = log->events[tail % EVENTS];
    __atomic_store_n(&log->tail, tail + 1u, __ATOMIC_RELEASE);
    return 1;
}

/* Three copies: one is written, one is read, and the third waits; bit 2 of `middle` says that it is new. */
typedef struct {
    status_t copies[3];
    int back, front, middle; /* start as 0, 1, 2 */
} board_t;

/* All that the server shares with the loop. */
typedef struct {
    mailbox_t box;
    events_t events;
    board_t board;
} exchange_t;

static inline status_t *board_back(board_t *board)
{
    return &board->copies[board->back];
}

static inline void board_publish(board_t *board)
{
    board->back = __atomic_exchange_n(&board->middle, board->back | 4, __ATOMIC_ACQ_REL) & 3;
}

static inline const status_t *board_latest(board_t *board)
{
    if (__atomic_load_n(&board->middle, __ATOMIC_ACQUIRE) & 4) {
        board->front = __atomic_exchange_n(&board->middle, board->front, __ATOMIC_ACQ_REL) & 3;
    }
    return &board->copies[board->front];
}

#endif
