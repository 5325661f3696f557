/* What the loop and the other threads exchange without a lock: commands, events and status. Each has one
 * writer and one reader. */
#ifndef EXCHANGE_H
#define EXCHANGE_H

#include <stdint.h>

#include "machine.h"
#include "ring.h"

enum { BINS = 16 }; /* of lateness: below 1 us, 2 us, 4 us ..., and all above */

typedef struct {
    uint64_t missed, bins[BINS];
    int64_t worst_ns;
} lateness_t;

typedef struct {
    phase_t phase;
    const char *reason;
    uint32_t faults, latch_cause, drive_faults;
    int moving, may_start;
    uint64_t calls, commands;
    double sensors[N_SENSORS], set_points[SET_POINTS_SIZE], outputs[N_OUTPUTS];
    lateness_t late;
} status_t;

/* A change of the phase, for the log. */
typedef struct {
    phase_t phase;
    const char *reason;
} event_t;

/* Three copies: one is written, one is read, and the third waits; bit 2 of `middle` says that it is new. */
typedef struct {
    status_t copies[3];
    int back, front, middle; /* start as 0, 1, 2 */
} board_t;

/* Commands to the loop, its events, and its status. */
enum { COMMANDS = 4, EVENTS = 64 };
typedef struct {
    command_t commands[COMMANDS];
    event_t events[EVENTS];
    ring_t command_ring, event_ring;
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
