/* maglev_5dof_precise: one step every 0.001 s, float. Generated: do not edit.
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
 * What this does to the machine:
 *   - a gap encoder that is refused or excluded is replaced
 *   - without x, without z or without two gap encoders the platen lands, latches on the stop and rests there without
 *     current, while its gap is above 30.5 mm
 *   - without three gap encoders, or without x and z, it latches in flight, with the safe output
 *   - zero current pulls the platen up from a gap below 28.7 mm
 *   - in flight the safe output, 2.5 A rms, lowers it from every gap between its stops, 18 mm to 31 mm, also with all
 *     parameters at their tolerances, and is no soft landing: from 18 mm the platen meets its lower stop at up to 0.57
 *     m/s
 *   - largest speeds and impacts after the latch, measured on 17 plants with each sensor lost in turn: at rest the
 *     machine reaches 0.00021 m/s (z) and 0.028 rad/s (phi) and hits a stop at 0.0055 m/s (y)
 *   - in motion the machine reaches 0.001 m/s (x) and 0.44 rad/s (theta) and hits a stop at 0.016 m/s (y)
 *   - at rest, tilted at 18.5 mm the machine reaches 0.00042 m/s (x) and 0.45 rad/s (phi) and hits a stop at 0.0055 m/s
 *     (y) and 0.25 rad/s (phi)
 *
 * Keep calling the step while it is latched, because the outputs move in its calls only. Call init again only with the
 * machine at rest: the outputs of the first step after it are not slewed.
 *
 * A refused input is replaced by its last good value, and before its first good value by 0.03098 m (y_ref), 0 m (x_ref,
 * z_ref), 0 rad (phi_ref, theta_ref); a refused measurement is replaced by what the others or a prediction say, from
 * the first sample on.
 *
 * While calls are missing, the last outputs act. Count them by a timer or an overrun flag, and give their number as
 * missed_calls in the next call. A number above 40 sets bit 18 of this sample and neither brakes nor latches: the
 * caller must then stop the motion, by set-points that no longer move or by the safe output and init at rest.
 *
 * What may fail, and what follows:
 * what fails           | noticed by, and when              | used instead       | what follows
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * y1, y2, y3, y4, x or | bits 0 to 5; in that sample       | what the others or | the law goes on; 5 samples in a row,
 * z not finite or      |                                   | a prediction say   | or more than 1 in 5 for long, of any
 * outside its range,   |                                   |                    | of them: latches
 * before all were good |                                   |                    |
 * in one sample        |                                   |                    |
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * y_ref, x_ref, z_ref, | bits 6 to 10; in that sample      | its last good      | the law goes on; never latches; all
 * phi_ref or theta_ref |                                   | value              | axes go on to it
 * not finite or        |                                   |                    |
 * outside its range    |                                   |                    |
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * one of y1, y2, y3    | bits 0 to 3; in that sample       | what the others    | meanwhile no relation is left:
 * and y4 not finite or |                                   | say, by the parity | another wrong one is not noticed; all
 * outside its range    |                                   | relation           | axes go on
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * one of y1, y2, y3    | bits 11 to 14; |residual| above   | what the others    | from then on no relation is left:
 * and y4 frozen,       | 4.8e-05 m in 3 samples in a row,  | say, by the parity | another wrong one is not noticed; all
 * offset, drifting or  | and one has by far the largest    | relation           | axes go on
 * jumping              | innovation or alone a code that   |                    |
 *                      | stands still (3 or 8 samples):    |                    |
 *                      | excluded until init               |                    |
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * the same, but which  | bits 11 to 14; the same in 10     | nothing: those in  | lands, y, phi and theta by the
 * one is not clear:    | samples in a row, or an excluded  | use stay in use,   | readings as they are; then all
 * all of y1, y2, y3    | one moves again after it stood    | another excluded   | currents fade to 0 A, while the gap
 * and y4 are suspects  | still: it is used again           | one stays replaced | is above 30.5 mm, where the magnets
 *                      |                                   |                    | carry less than the weight
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * two of y1, y2, y3    | bits 0 to 3, 11 to 14; in that    | the prediction of  | lands; what the remaining gaps leave
 * and y4 refused or    | sample                            | its observer       | open of y, phi, theta is predicted; x
 * excluded             |                                   |                    | and z go on measured; then all
 *                      |                                   |                    | currents fade to 0 A, while the gap
 *                      |                                   |                    | is above 30.5 mm, where the magnets
 *                      |                                   |                    | carry less than the weight
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * more than 2 of y1,   | bits 0 to 3, 11 to 14; in that    | the prediction of  | the 5th sample in a row latches in
 * y2, y3 and y4        | sample                            | its observer       | flight, without a landing: i_d 2.5 A,
 * refused or excluded  |                                   |                    | i_q 0 A, at measured angles
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * x or z not finite or | bits 4, 5; in that sample         | the prediction of  | lands; without x, motors 2 and 4 hand
 * outside its range    |                                   | its observer       | i_d over to 1 and 3 in 25 samples and
 *                      |                                   |                    | keep i_q, and vice versa without z;
 *                      |                                   |                    | commutated at the prediction; then
 *                      |                                   |                    | all currents fade to 0 A, while the
 *                      |                                   |                    | gap is above 30.5 mm, where the
 *                      |                                   |                    | magnets carry less than the weight,
 *                      |                                   |                    | and the lost position is 0.2 m, which
 *                      |                                   |                    | the phase step refuses
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * x or z frozen        | bits 15, 16; its code stands      | the prediction of  | as the row above; bit and exclusion
 *                      | still for 3 samples or more while | its observer       | stay
 *                      | its prediction, which agreed with |                    |
 *                      | its last 10 changes, moves by     |                    |
 *                      | more than 4e-05 m; or no answer   |                    |
 *                      | to the probe; only inside -0.0499 |                    |
 *                      | .. 0.0499 m; excluded until init  |                    |
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * x or z jumping       | bits 15, 16; further than 0.00015 | the prediction of  | as the rows above; a single such
 * inside its range     | m from its prediction, which      | its observer, at   | sample sets the bit, and all axes go
 *                      | agreed with its last 10 changes;  | once               | on
 *                      | only inside -0.0499 .. 0.0499 m;  |                    |
 *                      | excluded until init after 3       |                    |
 *                      | samples in a row. Not after       |                    |
 *                      | missed calls, until the           |                    |
 *                      | prediction agrees again: count    |                    |
 *                      | them, else they look like a jump. |                    |
 *                      | A smaller offset, a drift and     |                    |
 *                      | noise are not noticed             |                    |
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * x and z refused or   | bits 4, 5, 15, 16; in that sample | the prediction of  | the 5th sample in a row latches in
 * excluded             |                                   | its observer       | flight, without a landing: i_d 2.5 A,
 *                      |                                   |                    | i_q 0 A, 0.2 m for both: the phase
 *                      |                                   |                    | step keeps the angles for 80 samples,
 *                      |                                   |                    | then fades all currents out in 25
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * a coordinate that is | status bit 30; in 5 samples in a  | estimates of the   | y sinks to 0.031 m with at most 0.08
 * not measured, in all | row, or more than 1 in 5 for long | observers          | m/s and 2 m/s^2, 0.005 m/s at the
 * rows above that say  |                                   |                    | stop; brakes x at 4 m/s^2 and z at 4
 * `lands`              |                                   |                    | m/s^2; levels theta with the motors
 *                      |                                   |                    | that are left; leaves phi to its
 *                      |                                   |                    | guide spring; over, and latches, when
 *                      |                                   |                    | the ramp of y, not the body, is at
 *                      |                                   |                    | 0.0314 m; rests on the stop while y
 *                      |                                   |                    | is beyond 0.0305 m; good readings do
 *                      |                                   |                    | not end it; without sufficient ones
 *                      |                                   |                    | it latches in flight
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * x frozen at rest     | bit 15; 12 samples without a      | its prediction     | as frozen in motion
 *                      | change of its code, then 8 pairs  |                    |
 *                      | of pushes without an answer:      |                    |
 *                      | after 77 samples; only while all  |                    |
 *                      | is measured and the body is free  |                    |
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * z frozen at rest     | bit 16; 12 samples without a      | its prediction     | as frozen in motion
 *                      | change of its code, then 8 pairs  |                    |
 *                      | of pushes without an answer:      |                    |
 *                      | after 77 samples; only while all  |                    |
 *                      | is measured and the body is free  |                    |
 * ---------------------+-----------------------------------+--------------------+--------------------------------------
 * more than 40 calls   | bit 18; at the next call, where   | the last outputs   | nothing: the caller must stop the
 * missed, or a count   | the caller counts them            | act until then     | motion
 * that is negative or  |                                   |                    |
 * NaN                  |                                   |                    |
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
 * stop at 31 mm.
 *
 * A set-point nearer to a stop than 20 um at a motor is out of range. On the stop the error of an encoder's zero would
 * not vanish, and the internal model would push the platen into the stop until the currents are at their limit.
 *
 * A frozen or jumping reading of x or z is noticed only inside +-49.9 mm: farther out, where a stop may hold the
 * platen, these tests are off. After missed calls, and while the platen accelerates otherwise than predicted, until the
 * prediction agrees with ten changes of the code, they notice only a distance between both growing by more than 0.2 mm
 * (frozen) or 0.5 mm (a jump). A platen that rests is pushed there and back by the probe after each 40 samples without
 * a change of the code of x or z.
 *
 * F(n) and (n) are equation (n) of C. Fulford, M. Maggiore, J. Apkarian, "Control of a 5DOF Magnetically Levitated
 * Positioning Stage", IEEE Transactions on Control Systems Technology, 2009.
 *
 * Named constants that follow from parameters of the plant, by parameter: G: G; M_x: M_x, inverse_M_x; M_z: M_z,
 * inverse_M_z; k_s_phi: compensated_k_s_phi, spring_phi; k_s_theta: compensated_k_s_theta; mu_rec: gap_offset; h_m:
 * gap_offset, half_c_over_h2, slot_pull; b0, t1: gap_offset, slot_pull; I_x, I_z: half_I_over_r; r: half_I_over_r, r;
 * M_y: half_M_y; H_c, L_A, W, mu0, p, p_m, tau, tau_p, w_c, z1: half_c_over_h2, slot_pull. Gains, polynomials and
 * bounds may follow from them too.
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
    float r;                            /* rad, -0.00884887 .. 0.00884887: set-point one sample ago */
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
    float last_y_ref;                   /* m, 0.01802 .. 0.03098: last good value */
    float last_x_ref;                   /* m, -0.04998 .. 0.04998: last good value */
    float last_z_ref;                   /* m, -0.04998 .. 0.04998: last good value */
    float last_phi_ref;                 /* rad, -0.00294962 .. 0.00294962: last good value */
    float last_theta_ref;               /* rad, -0.0139496 .. 0.0139496: last good value */
    /* 1, 1 .. 20: samples with a bad measurement until it latches, in 1/4 of a sample */
    uint32_t left;
    uint32_t latched;                   /* 1, 0 .. 1: latched until init */
    uint32_t ready;                     /* 1, 0 .. 1: every measurement was good at once */
} maglev_5dof_precise_guard_state_t;

typedef struct {
    float y1;                           /* m, 0.0168 .. 0.0322: gap of motor 1 */
    float y2;                           /* m, 0.0124 .. 0.0366: gap of motor 2 */
    float y3;                           /* m, 0.0168 .. 0.0322: gap of motor 3 */
    float y4;                           /* m, 0.0124 .. 0.0366: gap of motor 4 */
    float x;                            /* m, -0.1 .. 0.1: platen along X */
    float z;                            /* m, -0.1 .. 0.1: platen along Z */
    float y_ref;                        /* m, 0.01802 .. 0.03098: set-point of the gap */
    float x_ref;                        /* m, -0.04998 .. 0.04998: set-point along X */
    float z_ref;                        /* m, -0.04998 .. 0.04998: set-point along Z */
    float phi_ref;                      /* rad, -0.00294962 .. 0.00294962: set-point of the rotation about X */
    float theta_ref;                    /* rad, -0.0139496 .. 0.0139496: set-point of the rotation about Z */
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

typedef struct {
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
} maglev_5dof_precise_state_t;

/* The layout is the same on every target. */
#if defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
_Static_assert(sizeof(maglev_5dof_precise_input_t) == 48u, "size of maglev_5dof_precise_input_t");
_Static_assert(sizeof(maglev_5dof_precise_output_t) == 40u, "size of maglev_5dof_precise_output_t");
_Static_assert(sizeof(maglev_5dof_precise_state_t) == 560u, "size of maglev_5dof_precise_state_t");
#else
extern char maglev_5dof_precise_input_size_is_48[(sizeof(maglev_5dof_precise_input_t) == 48u) ? 1 : -1];
extern char maglev_5dof_precise_output_size_is_40[(sizeof(maglev_5dof_precise_output_t) == 40u) ? 1 : -1];
extern char maglev_5dof_precise_state_size_is_560[(sizeof(maglev_5dof_precise_state_t) == 560u) ? 1 : -1];
#endif

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
