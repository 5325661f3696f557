/* The command line. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "io.h"

enum { MOTIONS = 16 };
typedef enum { LATE_COUNT, LATE_HOLD, LATE_SAFE } late_t;

typedef struct {
    const io_t *io;
    io_options_t back_end;
    const char *run, *record, *replay, *motions[MOTIONS];
    int motion_count;
    late_t late;
    double late_limit; /* missed periods in a row */
    double lockstep;   /* samples without real time */
    int live;          /* 1: in real time, not in lock step */
    double seconds;    /* of the run; 0 for no end */
    double stall_ms;   /* after which the watchdog kills the loop */
    double cpu;        /* -1 for any */
} options_t;

/* Read the command line. Return 0, or -1 after a message. */
int options_read(int count, char *words[], options_t *options);

#endif
