/* Records of samples: a lock-free ring from the loop to a thread that writes them as CSV with names and units. */
#ifndef RECORDER_H
#define RECORDER_H

#include <stdint.h>

#include "stage.h"

typedef struct {
    double t, missed;
    double sensors[N_SENSORS], set_points[SET_POINTS_SIZE], outputs[N_OUTPUTS];
    uint32_t faults, phase;
} record_t;

/* Start the thread. Return 0, or -1 after a message. */
int recorder_start(void);

/* Begin a file, which must not be there yet. Return 0, or an errno. */
int recorder_open(const char *path);

/* End the file; the thread writes what is in the ring first. Return 0 once it is closed, -1 after 0.5 s. */
int recorder_stop(void);

/* Stop, and wait until everything is written, but no longer than for 2 s. */
void recorder_finish(void);

/* Called by the loop: keep a record, or count it as dropped where the ring is full. Never waits, unless `wait`. */
void recorder_push(const record_t *record, int wait);

int recorder_is_open(void);
int recorder_error(void);         /* the errno of a write that failed, 0 if none has */
uint64_t recorder_dropped(void);  /* records that are in no file: of a full ring, and of a disk that fails or stops */

#endif
