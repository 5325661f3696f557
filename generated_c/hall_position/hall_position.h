/* hall_position: one step every 0.00125 s, float. Generated: do not edit. */
#ifndef HALL_POSITION_H
#define HALL_POSITION_H

#include <stdint.h>

typedef struct {
    float V_ax;                         /* V, -5 .. 5: Hall sensor and axis */
    float V_ay;                         /* V, -5 .. 5: Hall sensor and axis */
    float V_bx;                         /* V, -5 .. 5: Hall sensor and axis */
    float V_by;                         /* V, -5 .. 5: Hall sensor and axis */
} hall_position_input_t;

typedef struct {
    float X;                            /* m, -0.508 .. 0.508: of the body's origin over the matrix */
    float Y;                            /* m, -0.508 .. 0.508: of the body's origin over the matrix */
    float yaw;                          /* rad, -3.14159 .. 3.14159: of the body over the matrix */
    float deviation_X;                  /* m, 0 .. 10000: standard deviation by the noise of the voltages */
    float deviation_Y;                  /* m, 0 .. 10000: standard deviation by the noise of the voltages */
    float deviation_yaw;                /* rad, 0 .. 1: standard deviation by the noise of the voltages */
    float residual;                     /* V, 0 .. 1000: root mean square by degrees of freedom */
    float converged;                    /* 1, 0 .. 1: the last correction is small, and none has raised the cost */
    float damped;                       /* 1, 0 .. 1: the voltages do not tell all of the position */
    float valid;                        /* 1, 0 .. 1: converged, place certain and never lost, not damped, astray or sudden, inputs accepted */
    float restarted;                    /* 1, 0 .. 1: its place has been lost, or left what is declared: pitches are not known, and nothing is valid until init */
} hall_position_output_t;

typedef struct {
    float guard_last_V_ax;              /* V, -5 .. 5: last good value */
    float guard_last_V_ay;              /* V, -5 .. 5: last good value */
    float guard_last_V_bx;              /* V, -5 .. 5: last good value */
    float guard_last_V_by;              /* V, -5 .. 5: last good value */
    uint32_t guard_left;                /* 1, 1 .. 5: samples with a bad measurement until it latches */
    uint32_t guard_latched;             /* 1, 0 .. 1: safe output until init */
    uint32_t guard_ready;               /* 1, 0 .. 1: every measurement was good at once */
    float estimator_phase_x;            /* rad, -3.14159 .. 3.14159: of the sensors' centre in its pitch */
    float estimator_phase_y;            /* rad, -3.14159 .. 3.14159: of the sensors' centre in its pitch */
    float estimator_yaw;                /* rad, -3.14159 .. 3.14159: of the last sample */
    float estimator_yaw_known;          /* rad, -3.14159 .. 3.14159: of the last sample whose place was certain */
    float estimator_start_x;            /* rad, -3.14159 .. 3.14159: phase with which the last search began */
    float estimator_start_y;            /* rad, -3.14159 .. 3.14159: phase with which the last search began */
    float estimator_pitch_x;            /* 1, -8 .. 8: whole pitches to the one of the sensors' centre */
    float estimator_pitch_y;            /* 1, -8 .. 8: whole pitches to the one of the sensors' centre */
    float estimator_motion_x;           /* rad, -0.5 .. 0.5: of the phase, expected in a sample */
    float estimator_motion_y;           /* rad, -0.5 .. 0.5: of the phase, expected in a sample */
    float estimator_motion_yaw;         /* rad, -0.101003 .. 0.101003: expected in a sample */
    uint32_t estimator_astray;          /* 1, 0 .. 5: samples in a row with large residuals */
    uint32_t estimator_searching;       /* 1, 0 .. 1: its place is not known */
    uint32_t estimator_certain;         /* 1, 0 .. 1: no other place has the same voltages */
    uint32_t estimator_placed;          /* 1, 0 .. 1: its place has been certain */
    uint32_t estimator_restarted;       /* 1, 0 .. 1: it has looked for its place again */
} hall_position_state_t;

/* The layout is the same on every target. */
extern char hall_position_input_size_is_16[(sizeof(hall_position_input_t) == 16u) ? 1 : -1];
extern char hall_position_output_size_is_44[(sizeof(hall_position_output_t) == 44u) ? 1 : -1];
extern char hall_position_state_size_is_92[(sizeof(hall_position_state_t) == 92u) ? 1 : -1];

/* Put the state to its initial values. The caller owns it. */
void hall_position_init(hall_position_state_t *state);

/* Compute one sample: read `in`, write `out`, advance `state`.
 * It returns the fault bits:
 *   bit  0  V_ax: not finite or outside its range
 *   bit  1  V_ay: not finite or outside its range
 *   bit  2  V_bx: not finite or outside its range
 *   bit  3  V_by: not finite or outside its range
 *   bit 31  latched: safe output until init
 */
uint32_t hall_position_step(hall_position_state_t *state, const hall_position_input_t *in, hall_position_output_t *out);

#endif
