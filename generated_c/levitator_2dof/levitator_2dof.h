/* levitator_2dof: one step every 0.0005 s, float. Generated: do not edit. What may fail and what follows:
 * levitator_2dof.md.
 *
 * Call levitator_2dof_init once, then levitator_2dof_step once every 0.0005 s with the inputs of that sample. Nothing
 * but levitator_2dof_tune may change the state.
 *
 * Apply the outputs 1 sample, 0.0005 s, after the inputs of their sample were measured, neither sooner nor later, and
 * hold them until the next outputs are due. Margins and simulations assume this delay.
 *
 * The three pointers must not be null and must point to objects that do not overlap. One state serves one machine;
 * steps on different states may run at the same time.
 *
 * When a measurement is refused in 4 samples in a row, the step latches in the last of them until init, and the outputs
 * move to the safe output: i1, i2 to 0 A at 100 A/s.
 *
 * Keep calling the step while it is latched, because the outputs move in its calls only. Call init again only with the
 * machine at rest: the outputs of the first step after it are not slewed.
 *
 * At init the machine is at rest under the safe output, which acts until the first outputs of the step do.
 *
 * Signs of what a positive value accelerates, from the plant: i1 +z; i2 +x.
 *
 * levitator_2dof_tune changes 12 constants of the law between two steps, within the ranges of
 * levitator_2dof_parameters_t: over all of them the step keeps what is said here.
 *
 * The gains and numbers in levitator_2dof.c hold for one plant and one period: for other masses, geometry or magnets,
 * or another period, generate the files again. gains.json says where each gain comes from.
 *
 * With LEVITATOR_2DOF_DIAGNOSTICS defined, for the .c as well, levitator_2dof_step_diagnosed also says which signals it
 * computed, what is saturated and why it latched. Without the macro the diagnostics cost nothing.
 *
 * Compile with -std=c99 -O2 -ffp-contract=off -fno-math-errno. With -ffp-contract=fast results differ by rounding.
 * -ffast-math, -ffinite-math-only and floating-point arithmetic in a wider type are refused by #error. The source
 * cannot see options that assume that no value is NaN or infinite, or that reorder sums, by other names, such as
 * -fno-honor-nans or -funsafe-math-optimizations, nor -ffast-math of the linker: do not use them.
 */
#ifndef LEVITATOR_2DOF_H
#define LEVITATOR_2DOF_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct levitator_2dof_state levitator_2dof_state_t;

typedef struct {
    float z;                            /* m, -0.0007 .. 0.0007: position along z */
    float x;                            /* m, -0.0011 .. 0.0011: position along x */
    float z_ref;                        /* m, -0.0005 .. 0.0005: set-point of z */
    float x_ref;                        /* m, -0.0008 .. 0.0008: set-point of x */
} levitator_2dof_input_t;

typedef struct {
    float i1;                           /* A, -3 .. 3: coil of the magnet */
    float i2;                           /* A, -2 .. 2: voice coil */
} levitator_2dof_output_t;

typedef struct {
    /* m/m s^2, -1.69431169e-05 .. -1.65692109e-05: servo of z: next_sum from w_z_excess */
    float servo_z_next_sum_from_w_z_excess;
    /* m/m s^2, 3.2759425e-07 .. 3.60101126e-07: servo of z: next_p1 from w_z_excess */
    float servo_z_next_p1_from_w_z_excess;
    /* m/m s^2, -1.63066197e-05 .. -1.61424578e-05: servo of z: next_q1 from w_z_excess */
    float servo_z_next_q1_from_w_z_excess;
    float servo_z_w_z_command_from_sum; /* m/s^2/m, -1086.94946 .. -1062.96228: servo of z: w_z_command from sum */
    float servo_z_w_z_command_from_p1;  /* m/s^2/m, -4997.17334 .. -2227.75586: servo of z: w_z_command from p1 */
    float servo_z_w_z_command_from_q1;  /* m/s^2/m, -1734.28955 .. -1700.21033: servo of z: w_z_command from q1 */
    /* m/s^2/m, 367649.531 .. 419054.75: servo of z: w_z_command from z_predicted */
    float servo_z_w_z_command_from_z_predicted;
    /* m/s^2/m s, -651.933167 .. -578.204407: servo of z: w_z_command from vz_predicted */
    float servo_z_w_z_command_from_vz_predicted;
    /* m/s^2/m s^2, -0.311149955 .. -0.274490237: servo of z: w_z_command from w_z_late1_predicted */
    float servo_z_w_z_command_from_w_z_late1_predicted;
    /* m/s^2/m, -540348.812 .. -487361.594: servo of z: w_z_command from z_held */
    float servo_z_w_z_command_from_z_held;
    /* m/s^2/m, 71827.25 .. 72776.4219: servo of z: w_z_command from z_ref_held */
    float servo_z_w_z_command_from_z_ref_held;
    float servo_z_start_sum_from_z_held; /* m/m, -45.6422234 .. -44.0528107: servo of z: start_sum from z_held */
    uint32_t check;                     /* 1, 0 .. 4.2949673e+09: of the bits of the others */
} levitator_2dof_parameters_t;

/* Put the state to its initial values. The caller owns it. */
void levitator_2dof_init(levitator_2dof_state_t *state);

/* Compute one sample: read `in`, write `out`, advance `state`.
 * It returns the fault bits:
 *   bit  0  z: not finite or outside its range
 *   bit  1  x: not finite or outside its range
 *   bit  2  z_ref: not finite or outside its range
 *   bit  3  x_ref: not finite or outside its range
 *   bit 31  latched until init
 */
uint32_t levitator_2dof_step(levitator_2dof_state_t *state, const levitator_2dof_input_t *in,
    levitator_2dof_output_t *out);

/* The declared design, from which init starts. */
extern const levitator_2dof_parameters_t levitator_2dof_parameters_default;

/* The check that belongs to the values of `parameters`: set it last. */
uint32_t levitator_2dof_parameters_check(const levitator_2dof_parameters_t *parameters);

/* Move the constants of the law to `parameters`, which do not change during the call: one call between two
 * steps, `left` = 200, 199, .. 1. With 1 they are reached. It returns 0, or why nothing is changed:
 *   bit 0  the check does not fit the values: half of a change, or parameters of other C
 *   bit 1  a value is not finite, or outside its range
 *   bit 2  no call is left
 */
uint32_t levitator_2dof_tune(levitator_2dof_state_t *state, const levitator_2dof_parameters_t *parameters,
    uint32_t left);

/* What follows is for init and step alone: the state, by Block. */
typedef struct {
    float sum;                          /* m, -0.51 .. 0.51: sum of the errors */
    float p1;                           /* m, -0.014 .. 0.014: internal model of 62.83 rad/s */
    float q1;                           /* m, -0.41 .. 0.41: internal model of 62.83 rad/s */
    float p2;                           /* m, -0.073 .. 0.073: internal model of 314.2 rad/s */
    float q2;                           /* m, -0.48 .. 0.48: internal model of 314.2 rad/s */
    float x_predicted;                  /* m, -0.0024 .. 0.0024: estimate of the next sample */
    float vx_predicted;                 /* m/s, -2.8 .. 2.8: estimate of the next sample */
    float i2_late1_predicted;           /* A, -2.3 .. 2.3: limited command that acts next */
    uint32_t started;                   /* 1, 0 .. 1: the first sample is over */
} levitator_2dof_servo_x_state_t;

typedef struct {
    float sum;                          /* m, -0.34 .. 0.34: sum of the errors */
    float p1;                           /* m, -0.0096 .. 0.0096: internal model of 62.83 rad/s */
    float q1;                           /* m, -0.26 .. 0.26: internal model of 62.83 rad/s */
    float z_predicted;                  /* m, -0.0014 .. 0.0014: estimate of the next sample */
    float vz_predicted;                 /* m/s, -1.3 .. 1.3: estimate of the next sample */
    float w_z_late1_predicted;          /* m/s^2, -57 .. 57: limited command that acts next */
    uint32_t started;                   /* 1, 0 .. 1: the first sample is over */
    /* m/m s^2, -1.69431e-05 .. -1.65692e-05: servo of z: next_sum from w_z_excess */
    float next_sum_from_w_z_excess;
    float next_p1_from_w_z_excess;      /* m/m s^2, 3.27594e-07 .. 3.60101e-07: servo of z: next_p1 from w_z_excess */
    float next_q1_from_w_z_excess;      /* m/m s^2, -1.63066e-05 .. -1.61425e-05: servo of z: next_q1 from w_z_excess */
    float w_z_command_from_sum;         /* m/s^2/m, -1086.95 .. -1062.96: servo of z: w_z_command from sum */
    float w_z_command_from_p1;          /* m/s^2/m, -4997.17 .. -2227.76: servo of z: w_z_command from p1 */
    float w_z_command_from_q1;          /* m/s^2/m, -1734.29 .. -1700.21: servo of z: w_z_command from q1 */
    float w_z_command_from_z_predicted; /* m/s^2/m, 367650 .. 419055: servo of z: w_z_command from z_predicted */
    /* m/s^2/m s, -651.933 .. -578.204: servo of z: w_z_command from vz_predicted */
    float w_z_command_from_vz_predicted;
    /* m/s^2/m s^2, -0.31115 .. -0.27449: servo of z: w_z_command from w_z_late1_predicted */
    float w_z_command_from_w_z_late1_predicted;
    float w_z_command_from_z_held;      /* m/s^2/m, -540349 .. -487362: servo of z: w_z_command from z_held */
    float w_z_command_from_z_ref_held;  /* m/s^2/m, 71827.2 .. 72776.4: servo of z: w_z_command from z_ref_held */
    float start_sum_from_z_held;        /* m/m, -45.6422 .. -44.0528: servo of z: start_sum from z_held */
} levitator_2dof_servo_z_state_t;

typedef struct {
    float last_z;                       /* m, -0.0007 .. 0.0007: last good value */
    float last_x;                       /* m, -0.0011 .. 0.0011: last good value */
    float last_z_ref;                   /* m, -0.0005 .. 0.0005: last good value */
    float last_x_ref;                   /* m, -0.0008 .. 0.0008: last good value */
    uint32_t left;                      /* 1, 1 .. 4: samples with a bad measurement until it latches */
    uint32_t latched;                   /* 1, 0 .. 1: latched until init */
    uint32_t ready;                     /* 1, 0 .. 1: every measurement was good at once */
} levitator_2dof_guard_state_t;

struct levitator_2dof_state {
    levitator_2dof_guard_state_t guard;
    levitator_2dof_servo_z_state_t servo_z;
    levitator_2dof_servo_x_state_t servo_x;
    float safe_output_last_i1;          /* A, -3 .. 3: last output */
    float safe_output_last_i2;          /* A, -2 .. 2: last output */
};

/* The layout is the same on every target. */
#if defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
_Static_assert(sizeof(levitator_2dof_input_t) == 16u, "size of levitator_2dof_input_t");
_Static_assert(sizeof(levitator_2dof_output_t) == 8u, "size of levitator_2dof_output_t");
_Static_assert(sizeof(levitator_2dof_state_t) == 148u, "size of levitator_2dof_state_t");
_Static_assert(sizeof(levitator_2dof_parameters_t) == 52u, "size of levitator_2dof_parameters_t");
#else
extern char levitator_2dof_input_size_is_16[(sizeof(levitator_2dof_input_t) == 16u) ? 1 : -1];
extern char levitator_2dof_output_size_is_8[(sizeof(levitator_2dof_output_t) == 8u) ? 1 : -1];
extern char levitator_2dof_state_size_is_148[(sizeof(levitator_2dof_state_t) == 148u) ? 1 : -1];
extern char levitator_2dof_parameters_size_is_52[(sizeof(levitator_2dof_parameters_t) == 52u) ? 1 : -1];
#endif

/* Signals and what happened: each signal from the last step that computed it, since a latch or another branch skips
 * some. Set the struct to zero when you call init. Bits of `saturated`: 0 i1_computed, 1 i2_computed. */
typedef struct {
    float z_error;                      /* m: z_ref less z */
    float x_error;                      /* m: x_ref less x */
    float w_z_command;                  /* m/s^2: before the limits */
    float z_predicted;                  /* m: position along z */
    float i1_demand;                    /* A: coil of the magnet */
    float i1_excess;                    /* A: coil of the magnet */
    float w_z_limited;                  /* m/s^2: what the actuators make of the demand */
    float i2_demand;                    /* A: before the limits */
    float i2_excess;                    /* A: voice coil */
    uint32_t samples;                   /* steps that had this struct */
    uint32_t faults;                    /* fault word of the last step */
    uint32_t latch_cause;               /* fault word of the step that latched, 0 before */
    uint32_t saturated;                 /* signals at their limits in the last step */
} levitator_2dof_diagnostics_t;

#if defined(LEVITATOR_2DOF_DIAGNOSTICS)
/* The step; `diagnostics` may be null. */
uint32_t levitator_2dof_step_diagnosed(levitator_2dof_state_t *state, const levitator_2dof_input_t *in,
    levitator_2dof_output_t *out, levitator_2dof_diagnostics_t *diagnostics);
#endif

#ifdef __cplusplus
}
#endif

#endif
