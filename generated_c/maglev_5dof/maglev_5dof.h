/* maglev_5dof: one step every 0.001 s, float. Generated: do not edit. */
#ifndef MAGLEV_5DOF_H
#define MAGLEV_5DOF_H

#include <stdint.h>

typedef struct {
    float y1;                           /* m, 0.0168 .. 0.0322: gap of motor 1 */
    float y2;                           /* m, 0.0124 .. 0.0366: gap of motor 2 */
    float y3;                           /* m, 0.0168 .. 0.0322: gap of motor 3 */
    float y4;                           /* m, 0.0124 .. 0.0366: gap of motor 4 */
    float x;                            /* m, -0.1 .. 0.1: platen along X */
    float z;                            /* m, -0.1 .. 0.1: platen along Z */
    float y_ref;                        /* m, 0.018 .. 0.031: set-point of the gap */
    float x_ref;                        /* m, -0.05 .. 0.05: set-point along X */
    float z_ref;                        /* m, -0.05 .. 0.05: set-point along Z */
    float phi_ref;                      /* rad, -0.003 .. 0.003: set-point of the rotation about X */
    float theta_ref;                    /* rad, -0.014 .. 0.014: set-point of the rotation about Z */
} maglev_5dof_input_t;

typedef struct {
    float i_d1;                         /* A, -4.94975 .. 4.94975: direct current of motor 1, rms */
    float i_d2;                         /* A, -4.94975 .. 4.94975: direct current of motor 2, rms */
    float i_d3;                         /* A, -4.94975 .. 4.94975: direct current of motor 3, rms */
    float i_d4;                         /* A, -4.94975 .. 4.94975: direct current of motor 4, rms */
    float i_q1;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 1, rms */
    float i_q2;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 2, rms */
    float i_q3;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 3, rms */
    float i_q4;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 4, rms */
} maglev_5dof_output_t;

typedef struct {
    float guard_last_y1;                /* m, 0.0168 .. 0.0322: last good value */
    float guard_last_y2;                /* m, 0.0124 .. 0.0366: last good value */
    float guard_last_y3;                /* m, 0.0168 .. 0.0322: last good value */
    float guard_last_y4;                /* m, 0.0124 .. 0.0366: last good value */
    float guard_last_x;                 /* m, -0.1 .. 0.1: last good value */
    float guard_last_z;                 /* m, -0.1 .. 0.1: last good value */
    float guard_last_y_ref;             /* m, 0.018 .. 0.031: last good value */
    float guard_last_x_ref;             /* m, -0.05 .. 0.05: last good value */
    float guard_last_z_ref;             /* m, -0.05 .. 0.05: last good value */
    float guard_last_phi_ref;           /* rad, -0.003 .. 0.003: last good value */
    float guard_last_theta_ref;         /* rad, -0.014 .. 0.014: last good value */
    uint32_t guard_left;                /* 1, 1 .. 5: samples with a bad measurement until it latches */
    uint32_t guard_latched;             /* 1, 0 .. 1: safe output until init */
    uint32_t guard_ready;               /* 1, 0 .. 1: every measurement was good at once */
    float filter_y_q_prev;              /* m, -0.0165 .. 0.0165: signal one sample ago */
    float filter_y_s;                   /* m, -0.0522105 .. 0.0522105: fading sum of the differences */
    float filter_y_r;                   /* m, -0.124911 .. 0.124911: filtered rate over h */
    float regulator_y_sum;              /* m, -600 .. 600: internal model */
    float regulator_y_p1;               /* m, -3 .. 3: internal model */
    float regulator_y_q1;               /* m, -600 .. 600: internal model */
    float filter_x_q_prev;              /* m, -0.15 .. 0.15: signal one sample ago */
    float filter_x_s;                   /* m, -0.47464 .. 0.47464: fading sum of the differences */
    float filter_x_r;                   /* m, -1.13555 .. 1.13555: filtered rate over h */
    float regulator_x_sum;              /* m, -600 .. 600: internal model */
    float regulator_x_p1;               /* m, -3 .. 3: internal model */
    float regulator_x_q1;               /* m, -600 .. 600: internal model */
    float filter_z_q_prev;              /* m, -0.15 .. 0.15: signal one sample ago */
    float filter_z_s;                   /* m, -0.47464 .. 0.47464: fading sum of the differences */
    float filter_z_r;                   /* m, -1.13555 .. 1.13555: filtered rate over h */
    float regulator_z_sum;              /* m, -600 .. 600: internal model */
    float regulator_z_p1;               /* m, -3 .. 3: internal model */
    float regulator_z_q1;               /* m, -600 .. 600: internal model */
    float filter_phi_q_prev;            /* rad, -0.023 .. 0.023: signal one sample ago */
    float filter_phi_s;                 /* rad, -0.0727782 .. 0.0727782: fading sum of the differences */
    float filter_phi_r;                 /* rad, -0.174118 .. 0.174118: filtered rate over h */
    float regulator_phi_sum;            /* rad, -600 .. 600: internal model */
    float regulator_phi_p1;             /* rad, -3 .. 3: internal model */
    float regulator_phi_q1;             /* rad, -600 .. 600: internal model */
    float filter_theta_q_prev;          /* rad, -0.045 .. 0.045: signal one sample ago */
    float filter_theta_s;               /* rad, -0.142392 .. 0.142392: fading sum of the differences */
    float filter_theta_r;               /* rad, -0.340666 .. 0.340666: filtered rate over h */
    float regulator_theta_sum;          /* rad, -600 .. 600: internal model */
    float regulator_theta_p1;           /* rad, -3 .. 3: internal model */
    float regulator_theta_q1;           /* rad, -600 .. 600: internal model */
    float safe_output_last_i_d1;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d2;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d3;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d4;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_u_x;         /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_u_z;         /* A, -4.94975 .. 4.94975: last output */
} maglev_5dof_state_t;

/* The layout is the same on every target. */
extern char maglev_5dof_input_size_is_44[(sizeof(maglev_5dof_input_t) == 44u) ? 1 : -1];
extern char maglev_5dof_output_size_is_32[(sizeof(maglev_5dof_output_t) == 32u) ? 1 : -1];
extern char maglev_5dof_state_size_is_200[(sizeof(maglev_5dof_state_t) == 200u) ? 1 : -1];

/* Put the state to its initial values. The caller owns it. */
void maglev_5dof_init(maglev_5dof_state_t *state);

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
 *   bit 31  latched: safe output until init
 */
uint32_t maglev_5dof_step(maglev_5dof_state_t *state, const maglev_5dof_input_t *in, maglev_5dof_output_t *out);

#endif
