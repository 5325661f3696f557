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
    uint32_t guard_bad_y1;              /* 1, 0 .. 5: bad samples in a row */
    uint32_t guard_bad_y2;              /* 1, 0 .. 5: bad samples in a row */
    uint32_t guard_bad_y3;              /* 1, 0 .. 5: bad samples in a row */
    uint32_t guard_bad_y4;              /* 1, 0 .. 5: bad samples in a row */
    uint32_t guard_bad_x;               /* 1, 0 .. 5: bad samples in a row */
    uint32_t guard_bad_z;               /* 1, 0 .. 5: bad samples in a row */
    uint32_t guard_latched;             /* 1, 0 .. 1: safe output until init */
    uint32_t guard_ready;               /* 1, 0 .. 1: every measurement was good at once */
    float filter_y_q_prev;              /* m, -0.0165 .. 0.0165: signal one sample ago */
    float filter_y_lag;                 /* m, -0.033 .. 0.033: signal less filtered signal */
    float filter_y_v;                   /* m/s, -30 .. 30: filtered rate */
    float regulator_y_xi1;              /* m s^3, -0.002 .. 0.002: internal model */
    float regulator_y_xi2;              /* m s^2, -0.02 .. 0.02: internal model */
    float regulator_y_xi3;              /* m s^1, -0.2 .. 0.2: internal model */
    float filter_x_q_prev;              /* m, -0.15 .. 0.15: signal one sample ago */
    float filter_x_lag;                 /* m, -0.3 .. 0.3: signal less filtered signal */
    float filter_x_v;                   /* m/s, -30 .. 30: filtered rate */
    float regulator_x_xi1;              /* m s^3, -0.005 .. 0.005: internal model */
    float regulator_x_xi2;              /* m s^2, -0.05 .. 0.05: internal model */
    float regulator_x_xi3;              /* m s^1, -0.5 .. 0.5: internal model */
    float filter_z_q_prev;              /* m, -0.15 .. 0.15: signal one sample ago */
    float filter_z_lag;                 /* m, -0.3 .. 0.3: signal less filtered signal */
    float filter_z_v;                   /* m/s, -30 .. 30: filtered rate */
    float regulator_z_xi1;              /* m s^3, -0.005 .. 0.005: internal model */
    float regulator_z_xi2;              /* m s^2, -0.05 .. 0.05: internal model */
    float regulator_z_xi3;              /* m s^1, -0.5 .. 0.5: internal model */
    float filter_phi_q_prev;            /* rad, -0.023 .. 0.023: signal one sample ago */
    float filter_phi_lag;               /* rad, -0.046 .. 0.046: signal less filtered signal */
    float filter_phi_v;                 /* rad/s, -60 .. 60: filtered rate */
    float regulator_phi_xi1;            /* rad s^3, -0.002 .. 0.002: internal model */
    float regulator_phi_xi2;            /* rad s^2, -0.02 .. 0.02: internal model */
    float regulator_phi_xi3;            /* rad s^1, -0.2 .. 0.2: internal model */
    float filter_theta_q_prev;          /* rad, -0.045 .. 0.045: signal one sample ago */
    float filter_theta_lag;             /* rad, -0.09 .. 0.09: signal less filtered signal */
    float filter_theta_v;               /* rad/s, -60 .. 60: filtered rate */
    float regulator_theta_xi1;          /* rad s^3, -0.002 .. 0.002: internal model */
    float regulator_theta_xi2;          /* rad s^2, -0.02 .. 0.02: internal model */
    float regulator_theta_xi3;          /* rad s^1, -0.2 .. 0.2: internal model */
    float safe_output_last_i_d1;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d2;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d3;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_d4;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_q1;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_q2;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_q3;        /* A, -4.94975 .. 4.94975: last output */
    float safe_output_last_i_q4;        /* A, -4.94975 .. 4.94975: last output */
} maglev_5dof_state_t;

/* The layout is the same on every target. */
typedef char maglev_5dof_input_size_is_44[(sizeof(maglev_5dof_input_t) == 44u) ? 1 : -1];
typedef char maglev_5dof_output_size_is_32[(sizeof(maglev_5dof_output_t) == 32u) ? 1 : -1];
typedef char maglev_5dof_state_size_is_228[(sizeof(maglev_5dof_state_t) == 228u) ? 1 : -1];

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
