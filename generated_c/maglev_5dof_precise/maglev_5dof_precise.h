/* maglev_5dof_precise: one step every 0.001 s, float. Generated: do not edit. What may fail and what follows:
 * maglev_5dof_precise.md.
 *
 * Call maglev_5dof_precise_init once, then maglev_5dof_precise_step once every 0.001 s with the inputs of that sample.
 * Nothing else may change the state.
 *
 * Apply the outputs 1 sample, 0.001 s, after the inputs of their sample were measured, neither sooner nor later, and
 * hold them until the next outputs are due. Margins and simulations assume this delay.
 *
 * The three pointers must not be null and must point to objects that do not overlap. One state serves one machine;
 * steps on different states may run at the same time.
 *
 * The step latches until init when the readings do not suffice in 5 samples in a row, or more than 1 in 5 for long, or
 * when a landing is over, and the outputs move to the safe output: i_d1, i_d2, i_d3, i_d4 to 2.5 A at 100 A/s; i_q1,
 * i_q2, i_q3, i_q4 to 0 A at 100 A/s. While the machine rests on the stop on which it has landed, they move to others,
 * as fast: i_d1, i_d2, i_d3, i_d4, i_q1, i_q2, i_q3, i_q4 to 0 A.
 *
 * Keep calling the step while it is latched, because the outputs move in its calls only. Call init again only with the
 * machine at rest: the outputs of the first step after it are not slewed.
 *
 * While calls are missing, the last outputs act. Count them by a timer or an overrun flag, and give their number as
 * missed_calls in the next call. A number above 40 sets bit 18 of this sample and neither brakes nor latches: the
 * caller must then stop the motion, by set-points that no longer move or by the safe output and init at rest.
 *
 * In each sample, call maglev_5dof_precise_step and then maglev_5dof_precise_phase_step: a step takes outputs of the
 * steps before it, and the outputs of the last one go to the hardware.
 *
 * At init the machine is at rest under the safe output, which acts until the first outputs of the step do.
 *
 * Signs of what a positive value accelerates, from the plant: i_d1 +y -phi; i_d2 +y +theta; i_d3 +y +phi; i_d4 +y
 * -theta; u_x -x; u_z -z.
 *
 * y counts positive downwards, away from the motors. u_x is i_q of motors 2 and 4, along X; u_z is i_q of motors 1 and
 * 3, along Z.
 *
 * The pose at init is that of the first sample in which all sensors are good, and the platen rests in it, as on its
 * stop at 31 mm. Check scale and direction of the encoders of x and z before the first flight: one that counts too
 * little or backwards may not be noticed before the platen is at a stop.
 *
 * The gains and numbers in maglev_5dof_precise.c hold for one plant and one period: for other masses, geometry or
 * magnets, or another period, generate the files again. gains.json says where each gain comes from.
 *
 * With MAGLEV_5DOF_PRECISE_DIAGNOSTICS defined, for the .c as well, maglev_5dof_precise_step_diagnosed also says which
 * signals it computed, what is saturated and why it latched. Without the macro the diagnostics cost nothing.
 *
 * Compile with -std=c99 -O2 -ffp-contract=off -fno-math-errno. With -ffp-contract=fast results differ by rounding.
 * -ffast-math, -ffinite-math-only and floating-point arithmetic in a wider type are refused by #error. The source
 * cannot see options that assume that no value is NaN or infinite, or that reorder sums, by other names, such as
 * -fno-honor-nans or -funsafe-math-optimizations, nor -ffast-math of the linker: do not use them.
 */
#ifndef MAGLEV_5DOF_PRECISE_H
#define MAGLEV_5DOF_PRECISE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct maglev_5dof_precise_state maglev_5dof_precise_state_t;

typedef struct {
    float y1;                           /* m, 0.0168 .. 0.0322: gap of motor 1 */
    float y2;                           /* m, 0.0124 .. 0.0366: gap of motor 2 */
    float y3;                           /* m, 0.0168 .. 0.0322: gap of motor 3 */
    float y4;                           /* m, 0.0124 .. 0.0366: gap of motor 4 */
    float x;                            /* m, -0.1 .. 0.1: platen along X */
    float z;                            /* m, -0.1 .. 0.1: platen along Z */
    float y_ref;                        /* m, 0.01805 .. 0.03095: set-point of the gap */
    float x_ref;                        /* m, -0.04995 .. 0.04995: set-point along X */
    float z_ref;                        /* m, -0.04995 .. 0.04995: set-point along Z */
    float phi_ref;                      /* rad, -0.00287406 .. 0.00287406: set-point of the rotation about X */
    float theta_ref;                    /* rad, -0.0138741 .. 0.0138741: set-point of the rotation about Z */
    float missed_calls;                 /* 1, 0 .. 40: calls missed since the last one, 0 if none */
} maglev_5dof_precise_input_t;

typedef struct {
    float i_d1;                         /* A, -4.94975 .. 4.94975: direct current of motor 1, rms */
    float i_d2;                         /* A, -4.94975 .. 4.94975: direct current of motor 2, rms */
    float i_d3;                         /* A, -4.94975 .. 4.94975: direct current of motor 3, rms */
    float i_d4;                         /* A, -4.94975 .. 4.94975: direct current of motor 4, rms */
    float i_q1;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 1, rms */
    float i_q2;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 2, rms */
    float i_q3;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 3, rms */
    float i_q4;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 4, rms */
    float x_commutation;                /* m, -0.1 .. 0.2: x for the commutation, 0.2 if lost */
    float z_commutation;                /* m, -0.1 .. 0.2: z for the commutation, 0.2 if lost */
} maglev_5dof_precise_output_t;

/* Put the state to its initial values. The caller owns it. */
void maglev_5dof_precise_init(maglev_5dof_precise_state_t *state);

/* Compute one sample: read `in`, write `out`, advance `state`.
 * It returns the fault bits:
 *   bit  0  y1: not finite or outside its range
 *   bit  1  y2: not finite or outside its range
 *   bit  2  y3: not finite or outside its range
 *   bit  3  y4: not finite or outside its range
 *   bit  4  x: not finite or outside its range
 *   bit  5  z: not finite or outside its range
 *   bit  6  y_ref: not finite or outside its range
 *   bit  7  x_ref: not finite or outside its range
 *   bit  8  z_ref: not finite or outside its range
 *   bit  9  phi_ref: not finite or outside its range
 *   bit 10  theta_ref: not finite or outside its range
 *   bit 11  y1: contradicts other measurements or its prediction
 *   bit 12  y2: contradicts other measurements or its prediction
 *   bit 13  y3: contradicts other measurements or its prediction
 *   bit 14  y4: contradicts other measurements or its prediction
 *   bit 15  x: contradicts other measurements or its prediction
 *   bit 16  z: contradicts other measurements or its prediction
 *   bit 17  a reading is refused, replaced or contradicted, or a sensor was a suspect since init
 *   bit 18  missed_calls: more than 40 calls missed, or a count that is negative or NaN
 *   bit 30  status, no fault: lands until it latches
 *   bit 31  latched until init
 * The bits of a status, 0x40000000, are no faults: mask them before you compare the word with 0.
 */
uint32_t maglev_5dof_precise_step(maglev_5dof_precise_state_t *state, const maglev_5dof_precise_input_t *in,
    maglev_5dof_precise_output_t *out);

/* What follows is for init and step alone: the state, by Block. */
typedef struct {
    uint32_t sample;                    /* 1, 0 .. 7: sample of the pair, 0 for none */
    uint32_t attempt;                   /* 1, 0 .. 8: pairs without an answer */
    float towards;                      /* m/s^2, -4.4 .. 4.4: acceleration of the first pair, to the set-point */
} maglev_5dof_precise_probe_state_t;

typedef struct {
    uint32_t left;                      /* 1, 1 .. 20: samples until it lands, in 1/4 of a sample */
    uint32_t landing;                   /* 1, 0 .. 1: lands until init */
    float r_y;                          /* m, -0.5 .. 0.0326: set-point of the landing */
    float dr_y;                         /* m/s, -10 .. 10: its rate */
    float r_x;                          /* m, -0.5 .. 0.5: set-point of the landing */
    float dr_x;                         /* m/s, -10 .. 10: its rate */
    float r_z;                          /* m, -0.5 .. 0.5: set-point of the landing */
    float dr_z;                         /* m/s, -10 .. 10: its rate */
} maglev_5dof_precise_landing_state_t;

typedef struct {
    float q;                            /* m, -0.1 .. 0.1: prediction */
    float v;                            /* m/s, -2 .. 2: predicted rate */
    float d;                            /* m/s^2, -20 .. 20: disturbance */
    float gained;                       /* m/s^2, -20684.8 .. 20684.8: sum of what d gained since the code changed */
    float d_at_change;                  /* m/s^2, -20 .. 20: d as its code changed */
    float g;                            /* 1, 0.8 .. 1.2: learnt gain */
} maglev_5dof_precise_observer_2_state_t;

typedef struct {
    /* 1, -1 .. 1: part of their currents that motors hand over: > 0 along X, < 0 along Z */
    float transfer;
} maglev_5dof_precise_handover_state_t;

typedef struct {
    float sum;                          /* rad, -4.00004 .. 4.00004: internal model */
    float p1;                           /* rad, -4.00004 .. 4.00004: internal model */
    float q1;                           /* rad, -4.00004 .. 4.00004: internal model */
    float r;                            /* rad, -0.00862217 .. 0.00862217: set-point one sample ago */
} maglev_5dof_precise_servo_phi_fast_state_t;

typedef struct {
    float sum;                          /* m or rad: internal model */
    float p1;                           /* m or rad: internal model */
    float q1;                           /* m or rad: internal model */
    float p2;                           /* m or rad: internal model */
    float q2;                           /* m or rad: internal model */
    float p3;                           /* m or rad: internal model */
    float q3;                           /* m or rad: internal model */
    float r;                            /* m or rad: set-point one sample ago */
} maglev_5dof_precise_servo_fast_state_t;

typedef struct {
    float q;                            /* m or rad: prediction */
    float v;                            /* m/s or rad/s: predicted rate */
    float d;                            /* m/s^2 or rad/s^2: disturbance */
} maglev_5dof_precise_observer_state_t;

typedef struct {
    float code_y1;                      /* m, 0.0168 .. 0.0322: accepted reading one sample ago */
    uint32_t still_y1;                  /* 1, 0 .. 8: samples without a change */
    uint32_t excluded_y1;               /* 1, 0 .. 1: wrong until init */
    float code_y2;                      /* m, 0.0124 .. 0.0366: accepted reading one sample ago */
    uint32_t still_y2;                  /* 1, 0 .. 8: samples without a change */
    uint32_t excluded_y2;               /* 1, 0 .. 1: wrong until init */
    float code_y3;                      /* m, 0.0168 .. 0.0322: accepted reading one sample ago */
    uint32_t still_y3;                  /* 1, 0 .. 8: samples without a change */
    uint32_t excluded_y3;               /* 1, 0 .. 1: wrong until init */
    float code_y4;                      /* m, 0.0124 .. 0.0366: accepted reading one sample ago */
    uint32_t still_y4;                  /* 1, 0 .. 8: samples without a change */
    uint32_t excluded_y4;               /* 1, 0 .. 1: wrong until init */
    float last_residual_0;              /* m, -0.039996 .. 0.039996: of the parity relation one sample ago */
    float bound_0;                      /* m^2, 2.3017e-09 .. 2.68474e-08: largest residual without a fault, squared */
    uint32_t contradictions_0;          /* 1, 0 .. 10: samples in a row */
    uint32_t stuck_0;                   /* 1, 0 .. 1: the excluded sensor stood still */
    uint32_t undecided_0;               /* 1, 0 .. 1: which sensor is wrong is not known */
    uint32_t degraded;                  /* 1, 0 .. 1: a sensor was a suspect or is excluded, until init */
} maglev_5dof_precise_redundancy_state_t;

typedef struct {
    float code;                         /* m, -0.1 .. 0.1: accepted reading one sample ago */
    uint32_t still;                     /* 1, 0 .. 40: samples without a change */
    uint32_t excluded;                  /* 1, 0 .. 1: wrong until init */
    uint32_t doubts;                    /* 1, 0 .. 10: changes until its prediction is believed */
    float before;                       /* m, -0.1 .. 0.1: prediction at the last change */
    uint32_t jumps;                     /* 1, 0 .. 2: samples in a row far from its prediction */
} maglev_5dof_precise_monitor_state_t;

typedef struct {
    float last_y1;                      /* m, 0.0168 .. 0.0322: last good value */
    float last_y2;                      /* m, 0.0124 .. 0.0366: last good value */
    float last_y3;                      /* m, 0.0168 .. 0.0322: last good value */
    float last_y4;                      /* m, 0.0124 .. 0.0366: last good value */
    float last_x;                       /* m, -0.1 .. 0.1: last good value */
    float last_z;                       /* m, -0.1 .. 0.1: last good value */
    float last_y_ref;                   /* m, 0.01805 .. 0.03095: last good value */
    float last_x_ref;                   /* m, -0.04995 .. 0.04995: last good value */
    float last_z_ref;                   /* m, -0.04995 .. 0.04995: last good value */
    float last_phi_ref;                 /* rad, -0.00287406 .. 0.00287406: last good value */
    float last_theta_ref;               /* rad, -0.0138741 .. 0.0138741: last good value */
    /* 1, 1 .. 20: samples with a bad measurement until it latches, in 1/4 of a sample */
    uint32_t left;
    uint32_t latched;                   /* 1, 0 .. 1: latched until init */
    uint32_t ready;                     /* 1, 0 .. 1: every measurement was good at once */
} maglev_5dof_precise_guard_state_t;

struct maglev_5dof_precise_state {
    maglev_5dof_precise_guard_state_t guard;
    maglev_5dof_precise_monitor_state_t x_monitor;
    maglev_5dof_precise_monitor_state_t z_monitor;
    maglev_5dof_precise_redundancy_state_t redundancy;
    maglev_5dof_precise_observer_state_t observer_y_fast;
    maglev_5dof_precise_servo_fast_state_t servo_y_fast;
    maglev_5dof_precise_observer_state_t observer_x_fast;
    maglev_5dof_precise_servo_fast_state_t servo_x_fast;
    maglev_5dof_precise_observer_state_t observer_z_fast;
    maglev_5dof_precise_servo_fast_state_t servo_z_fast;
    maglev_5dof_precise_observer_state_t observer_phi_fast;
    maglev_5dof_precise_servo_phi_fast_state_t servo_phi_fast;
    maglev_5dof_precise_observer_state_t observer_theta_fast;
    maglev_5dof_precise_servo_fast_state_t servo_theta_fast;
    maglev_5dof_precise_handover_state_t handover;
    maglev_5dof_precise_observer_state_t observer_y;
    maglev_5dof_precise_observer_2_state_t observer_x;
    maglev_5dof_precise_observer_2_state_t observer_z;
    maglev_5dof_precise_observer_state_t observer_phi;
    maglev_5dof_precise_observer_state_t observer_theta;
    maglev_5dof_precise_landing_state_t landing;
    maglev_5dof_precise_probe_state_t probe_x;
    maglev_5dof_precise_probe_state_t probe_z;
    float delay_w_y_last;               /* m/s^2, -1e+06 .. 1e+06: w_y one sample ago */
    float delay_a_x_last;               /* m/s^2, -1e+06 .. 1e+06: a_x one sample ago */
    float delay_a_z_last;               /* m/s^2, -1e+06 .. 1e+06: a_z one sample ago */
    float delay_w_phi_last;             /* rad/s^2, -1e+06 .. 1e+06: w_phi one sample ago */
    float delay_w_theta_last;           /* rad/s^2, -1e+06 .. 1e+06: w_theta one sample ago */
    float safe_output_last_i_d1;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d2;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d3;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d4;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_u_x;         /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_u_z;         /* A, -4.94975 .. 4.94975: last output */
};

/* The layout is the same on every target. */
#if defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
_Static_assert(sizeof(maglev_5dof_precise_input_t) == 48u, "size of maglev_5dof_precise_input_t");
_Static_assert(sizeof(maglev_5dof_precise_output_t) == 40u, "size of maglev_5dof_precise_output_t");
_Static_assert(sizeof(maglev_5dof_precise_state_t) == 568u, "size of maglev_5dof_precise_state_t");
#else
extern char maglev_5dof_precise_input_size_is_48[(sizeof(maglev_5dof_precise_input_t) == 48u) ? 1 : -1];
extern char maglev_5dof_precise_output_size_is_40[(sizeof(maglev_5dof_precise_output_t) == 40u) ? 1 : -1];
extern char maglev_5dof_precise_state_size_is_568[(sizeof(maglev_5dof_precise_state_t) == 568u) ? 1 : -1];
#endif

/* Signals and what happened: each signal from the last step that computed it, since a latch or another branch skips
 * some. Set the struct to zero when you call init. Bits of `saturated`: 0 y_fast_rate_ahead, 1 x_fast_ahead, 2
 * x_fast_rate_ahead, 3 z_fast_ahead, 4 z_fast_rate_ahead, 5 phi_fast_ahead, 6 phi_fast_rate_ahead, 7 theta_fast_ahead,
 * 8 theta_fast_rate_ahead, 9 i_d1_balanced, 10 i_d2_balanced, 11 i_d3_balanced, 12 i_d4_balanced, 13 u_x_computed, 14
 * u_z_computed. */
typedef struct {
    float sound;                        /* 1: all readings are good, and no sensor was ever a suspect */
    float x_unanswered;                 /* 1: no pair of the probe was answered */
    float x_usual;                      /* 1: sound, and nothing is wrong with this one */
    float y1_expected;                  /* m: gap of motor 1 */
    float y2_expected;                  /* m: gap of motor 2 */
    float y3_expected;                  /* m: gap of motor 3 */
    float y4_expected;                  /* m: gap of motor 4 */
    float z_unanswered;                 /* 1: no pair of the probe was answered */
    float z_usual;                      /* 1: sound, and nothing is wrong with this one */
    float suspect_y1;                   /* 1: wrong, or may be: contradicts the others or is frozen */
    float suspect_y2;                   /* 1: wrong, or may be: contradicts the others or is frozen */
    float suspect_y3;                   /* 1: wrong, or may be: contradicts the others or is frozen */
    float suspect_y4;                   /* 1: wrong, or may be: contradicts the others or is frozen */
    float x_suspect;                    /* 1: wrong, or may be: is frozen or jumps */
    float z_suspect;                    /* 1: wrong, or may be: is frozen or jumps */
    float landed;                       /* 1: the ramp is at its end, wherever the body is */
    float gaps_sufficient;              /* 1: the machine can be controlled */
    float x_trusted;                    /* 1: measured, not predicted */
    float z_trusted;                    /* 1: measured, not predicted */
    float sufficient;                   /* 1: it can be controlled */
    float x_frozen;                     /* 1: its code stands still although it ought to move, or it is excluded */
    float x_unchanged;                  /* 1: samples without a change of the code */
    float z_frozen;                     /* 1: its code stands still although it ought to move, or it is excluded */
    float z_unchanged;                  /* 1: samples without a change of the code */
    float y1_held;                      /* m: gap of motor 1 */
    float y2_held;                      /* m: gap of motor 2 */
    float y3_held;                      /* m: gap of motor 3 */
    float y4_held;                      /* m: gap of motor 4 */
    float regular;                      /* 1: every coordinate is measured */
    float theta_measured;               /* 1: every coordinate of the groups is measured */
    float free;                         /* 1: no stop holds it */
    float y;                            /* m: gap at the centre */
    float phi;                          /* rad: rotation about X */
    float theta;                        /* rad: rotation about Z */
    float e_y;                          /* m: tracking error */
    float e_x;                          /* m: tracking error */
    float e_z;                          /* m: tracking error */
    float e_phi;                        /* rad: tracking error */
    float e_theta;                      /* rad: tracking error */
    float y_fast_estimate;              /* m: y_fast after the correction */
    float y_fast_rate;                  /* m/s: rate of y_fast after the correction */
    float y_fast_disturbance;           /* m/s^2: acceleration that the demand lacks */
    float y_fast_ahead;                 /* m: y_fast one sample later */
    float y_fast_rate_ahead;            /* m/s: rate of y_fast one sample later */
    float w_y_tracking;                 /* m/s^2: demanded acceleration */
    float x_fast_estimate;              /* m: x_fast after the correction */
    float x_fast_rate;                  /* m/s: rate of x_fast after the correction */
    float x_fast_disturbance;           /* m/s^2: acceleration that the demand lacks */
    float x_fast_ahead;                 /* m: x_fast one sample later */
    float x_fast_rate_ahead;            /* m/s: rate of x_fast one sample later */
    float w_x_tracking;                 /* m/s^2: demanded acceleration */
    float z_fast_estimate;              /* m: z_fast after the correction */
    float z_fast_rate;                  /* m/s: rate of z_fast after the correction */
    float z_fast_disturbance;           /* m/s^2: acceleration that the demand lacks */
    float z_fast_ahead;                 /* m: z_fast one sample later */
    float z_fast_rate_ahead;            /* m/s: rate of z_fast one sample later */
    float w_z_tracking;                 /* m/s^2: demanded acceleration */
    float phi_fast_estimate;            /* rad: phi_fast after the correction */
    float phi_fast_rate;                /* rad/s: rate of phi_fast after the correction */
    float phi_fast_disturbance;         /* rad/s^2: acceleration that the demand lacks */
    float phi_fast_ahead;               /* rad: phi_fast one sample later */
    float phi_fast_rate_ahead;          /* rad/s: rate of phi_fast one sample later */
    float w_phi_tracking;               /* rad/s^2: demanded acceleration */
    float theta_fast_estimate;          /* rad: theta_fast after the correction */
    float theta_fast_rate;              /* rad/s: rate of theta_fast after the correction */
    float theta_fast_disturbance;       /* rad/s^2: acceleration that the demand lacks */
    float theta_fast_ahead;             /* rad: theta_fast one sample later */
    float theta_fast_rate_ahead;        /* rad/s: rate of theta_fast one sample later */
    float w_theta_tracking;             /* rad/s^2: demanded acceleration */
    float w_phi;                        /* rad/s^2: demanded acceleration */
    float theta_disturbance;            /* rad/s^2: acceleration that the demand lacks */
    float theta_estimate;               /* rad: theta after the correction */
    float theta_rate;                   /* rad/s: rate of theta after the correction */
    float w_theta;                      /* rad/s^2: demanded acceleration */
    float x_disturbance;                /* m/s^2: acceleration that the demand lacks */
    float x_estimate;                   /* m: x after the correction */
    float x_rate;                       /* m/s: rate of x after the correction */
    float w_x_unprobed;                 /* m/s^2: demanded acceleration */
    float w_x;                          /* m/s^2: demanded acceleration */
    float y_disturbance;                /* m/s^2: acceleration that the demand lacks */
    float y_estimate;                   /* m: y after the correction */
    float y_rate;                       /* m/s: rate of y after the correction */
    float w_y;                          /* m/s^2: demanded acceleration */
    float z_disturbance;                /* m/s^2: acceleration that the demand lacks */
    float z_estimate;                   /* m: z after the correction */
    float z_rate;                       /* m/s: rate of z after the correction */
    float w_z_unprobed;                 /* m/s^2: demanded acceleration */
    float w_z;                          /* m/s^2: demanded acceleration */
    float i_d1_balanced;                /* A: direct current of motor 1, rms */
    float i_d2_balanced;                /* A: direct current of motor 2, rms */
    float i_d3_balanced;                /* A: direct current of motor 3, rms */
    float i_d4_balanced;                /* A: direct current of motor 4, rms */
    float a_x;                          /* m/s^2: acceleration by u_x */
    float a_z;                          /* m/s^2: acceleration by u_z */
    float phi_estimate;                 /* rad: phi after the correction */
    float phi_rate;                     /* rad/s: rate of phi after the correction */
    float phi_disturbance;              /* rad/s^2: acceleration that the demand lacks */
    float rests;                        /* 1: has landed, and lies on its stop */
    uint32_t samples;                   /* steps that had this struct */
    uint32_t faults;                    /* fault word of the last step */
    uint32_t latch_cause;               /* fault word of the step that latched, 0 before */
    uint32_t saturated;                 /* signals at their limits in the last step */
} maglev_5dof_precise_diagnostics_t;

#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
/* The step; `diagnostics` may be null. */
uint32_t maglev_5dof_precise_step_diagnosed(maglev_5dof_precise_state_t *state, const maglev_5dof_precise_input_t *in,
    maglev_5dof_precise_output_t *out, maglev_5dof_precise_diagnostics_t *diagnostics);
#endif

#ifdef __cplusplus
}
#endif

#endif
