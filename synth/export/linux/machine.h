/* The state machine around the emitted step: what the header of the step asks of its caller, sample by sample. */
#ifndef MACHINE_H
#define MACHINE_H

#include <stdint.h>

#include "motion.h"
#include "rest.h"
#include "stage.h"

/* waiting -> enabling -> starting -> running -> latched, or braking and stopping -> disabled -> waiting, by `start`. */
typedef enum { WAITING, ENABLING, STARTING, RUNNING, BRAKING, LATCHED_PHASE, STOPPING, DISABLED } phase_t;
extern const char *const PHASES[];

typedef enum { COMMAND_MOTION, COMMAND_HOLD, COMMAND_START, COMMAND_STOP } order_t;

typedef struct {
    order_t order;
    motion_t motion;
    const char *reason; /* of a stop: a text that lasts */
    int at_once;        /* a stop that must not wait for a motion to come to rest */
} command_t;

typedef struct {
    stage_t stage;
    phase_t phase;
    const char *reason; /* of the last stop */
    uint32_t faults, latch_cause;
    uint64_t commands;             /* of clients, so far */
    uint64_t since, still;         /* samples in a row: in this phase, with these outputs */
    rest_t rest;
    motion_t motion;
    double t, rate; /* time of the motion, and how fast it passes: 1, or on the way to 0 in a hold */
    int holding, enabled, prompt; /* prompt: no waiting, for a simulation in lock step */
    double sensors[N_SENSORS], set_points[SET_POINTS_SIZE], outputs[N_OUTPUTS];
} machine_t;

void machine_init(machine_t *machine, int prompt);

/* One sample. `missed` counts the calls that were missed since the last one. */
void machine_sample(machine_t *machine, const double sensors[], double missed);

/* Obey a command between two samples; one that does not fit the phase changes nothing. */
void machine_command(machine_t *machine, const command_t *command);

/* Move the outputs one sample towards the safe ones; 1 once they are there. Also for the watchdog. */
int machine_make_safe(machine_t *machine);

/* 1 while a motion is under way. */
int machine_is_moving(const machine_t *machine);

/* 1 where a start would be obeyed. */
int machine_may_start(const machine_t *machine);

/* 1 once the process may end: the amplifiers are off, or have had the safe output for a while and keep it. */
int machine_may_end(const machine_t *machine);

#endif
