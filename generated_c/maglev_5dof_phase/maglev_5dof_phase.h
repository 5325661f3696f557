/* maglev_5dof_phase: one step every 0.001 s, float. Generated: do not edit. What may fail and what follows:
 * maglev_5dof_phase.md.
 *
 * Call maglev_5dof_phase_init once, then maglev_5dof_phase_step once every 0.001 s with the inputs of that sample.
 * Nothing else may change the state.
 *
 * Apply the outputs 1 sample, 0.001 s, after the inputs of their sample were measured, neither sooner nor later, and
 * hold them until the next outputs are due. Margins and simulations assume this delay.
 *
 * The three pointers must not be null and must point to objects that do not overlap. One state serves one machine;
 * steps on different states may run at the same time.
 *
 * In each sample, call maglev_5dof_step and then maglev_5dof_phase_step: a step takes outputs of the steps before it,
 * and the outputs of the last one go to the hardware.
 *
 * A position is lost in the 5th sample in a row in which it is refused, and before its first good one; the next good
 * one ends that. While both positions are lost, the motors that carry keep their angles for 80 samples, in which the
 * safe output of the controller lowers the platen to its stop, and then all currents fade to 0 A in 25 samples; once a
 * position is known again they fade in as slowly.
 *
 * F(n) and (n) are equation (n) of C. Fulford, M. Maggiore, J. Apkarian, "Control of a 5DOF Magnetically Levitated
 * Positioning Stage", IEEE Transactions on Control Systems Technology, 2009.
 *
 * The gains and numbers in maglev_5dof_phase.c hold for one plant and one period: for other masses, geometry or
 * magnets, or another period, generate the files again. gains.json says where each gain comes from.
 *
 * With MAGLEV_5DOF_PHASE_DIAGNOSTICS defined, for the .c as well, maglev_5dof_phase_step_diagnosed also says which
 * signals it computed. Without the macro the diagnostics cost nothing.
 *
 * Compile with -std=c99 -O2 -ffp-contract=off -fno-math-errno. With -ffp-contract=fast results differ by rounding.
 * -ffast-math, -ffinite-math-only and floating-point arithmetic in a wider type are refused by #error. The source
 * cannot see options that assume that no value is NaN or infinite, or that reorder sums, by other names, such as
 * -fno-honor-nans or -funsafe-math-optimizations, nor -ffast-math of the linker: do not use them.
 */
#ifndef MAGLEV_5DOF_PHASE_H
#define MAGLEV_5DOF_PHASE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct maglev_5dof_phase_state maglev_5dof_phase_state_t;

typedef struct {
    float i_d1;                         /* A, -4.94975 .. 4.94975: direct current of motor 1, rms */
    float i_d2;                         /* A, -4.94975 .. 4.94975: direct current of motor 2, rms */
    float i_d3;                         /* A, -4.94975 .. 4.94975: direct current of motor 3, rms */
    float i_d4;                         /* A, -4.94975 .. 4.94975: direct current of motor 4, rms */
    float i_q1;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 1, rms */
    float i_q2;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 2, rms */
    float i_q3;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 3, rms */
    float i_q4;                         /* A, -4.94975 .. 4.94975: quadrature current of motor 4, rms */
    float x_commutation;                /* m, -0.1 .. 0.1: platen along X, of the sample of the currents */
    float z_commutation;                /* m, -0.1 .. 0.1: platen along Z, of the sample of the currents */
} maglev_5dof_phase_input_t;

typedef struct {
    float i_a1;                         /* A, -9.90049 .. 9.90049: phase a of motor 1, instantaneous */
    float i_b1;                         /* A, -9.90049 .. 9.90049: phase b of motor 1, instantaneous */
    float i_c1;                         /* A, -9.90049 .. 9.90049: phase c of motor 1, instantaneous */
    float i_a2;                         /* A, -9.90049 .. 9.90049: phase a of motor 2, instantaneous */
    float i_b2;                         /* A, -9.90049 .. 9.90049: phase b of motor 2, instantaneous */
    float i_c2;                         /* A, -9.90049 .. 9.90049: phase c of motor 2, instantaneous */
    float i_a3;                         /* A, -9.90049 .. 9.90049: phase a of motor 3, instantaneous */
    float i_b3;                         /* A, -9.90049 .. 9.90049: phase b of motor 3, instantaneous */
    float i_c3;                         /* A, -9.90049 .. 9.90049: phase c of motor 3, instantaneous */
    float i_a4;                         /* A, -9.90049 .. 9.90049: phase a of motor 4, instantaneous */
    float i_b4;                         /* A, -9.90049 .. 9.90049: phase b of motor 4, instantaneous */
    float i_c4;                         /* A, -9.90049 .. 9.90049: phase c of motor 4, instantaneous */
} maglev_5dof_phase_output_t;

/* Put the state to its initial values. The caller owns it. */
void maglev_5dof_phase_init(maglev_5dof_phase_state_t *state);

/* Compute one sample: read `in`, write `out`, advance `state`.
 * It returns the fault bits:
 *   bit  0  i_d1: not finite or outside its range
 *   bit  1  i_d2: not finite or outside its range
 *   bit  2  i_d3: not finite or outside its range
 *   bit  3  i_d4: not finite or outside its range
 *   bit  4  i_q1: not finite or outside its range
 *   bit  5  i_q2: not finite or outside its range
 *   bit  6  i_q3: not finite or outside its range
 *   bit  7  i_q4: not finite or outside its range
 *   bit  8  x_commutation: not finite or outside its range
 *   bit  9  z_commutation: not finite or outside its range
 *   bit 10  x: lost; motors 2 and 4 hand their direct currents over and fade out
 *   bit 11  z: lost; motors 1 and 3 hand their direct currents over and fade out
 */
uint32_t maglev_5dof_phase_step(maglev_5dof_phase_state_t *state, const maglev_5dof_phase_input_t *in,
    maglev_5dof_phase_output_t *out);

/* What follows is for init and step alone: the state, by Block. */
typedef struct {
    /* 1, -1 .. 1: part of their currents that motors hand over: > 0 along X, < 0 along Z */
    float transfer;
    uint32_t unknown;                   /* 1, 0 .. 105: samples with both positions lost, less those with one */
} maglev_5dof_phase_commutation_state_t;

typedef struct {
    float last_x;                       /* m, -0.1 .. 0.1: one sample ago */
    float last_z;                       /* m, -0.1 .. 0.1: one sample ago */
    /* 1, 0 .. 5: samples with a bad measurement until the position is lost; 0: lost */
    uint32_t left_x;
    /* 1, 0 .. 5: samples with a bad measurement until the position is lost; 0: lost */
    uint32_t left_z;
} maglev_5dof_phase_advance_state_t;

struct maglev_5dof_phase_state {
    maglev_5dof_phase_advance_state_t advance;
    maglev_5dof_phase_commutation_state_t commutation;
    float guard_last_i_d1;              /* A, -4.94975 .. 4.94975: last good value */
    float guard_last_i_d2;              /* A, -4.94975 .. 4.94975: last good value */
    float guard_last_i_d3;              /* A, -4.94975 .. 4.94975: last good value */
    float guard_last_i_d4;              /* A, -4.94975 .. 4.94975: last good value */
    float guard_last_i_q1;              /* A, -4.94975 .. 4.94975: last good value */
    float guard_last_i_q2;              /* A, -4.94975 .. 4.94975: last good value */
    float guard_last_i_q3;              /* A, -4.94975 .. 4.94975: last good value */
    float guard_last_i_q4;              /* A, -4.94975 .. 4.94975: last good value */
    float guard_last_x;                 /* m, -0.1 .. 0.1: last good value */
    float guard_last_z;                 /* m, -0.1 .. 0.1: last good value */
};

/* The layout is the same on every target. */
#if defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
_Static_assert(sizeof(maglev_5dof_phase_input_t) == 40u, "size of maglev_5dof_phase_input_t");
_Static_assert(sizeof(maglev_5dof_phase_output_t) == 48u, "size of maglev_5dof_phase_output_t");
_Static_assert(sizeof(maglev_5dof_phase_state_t) == 64u, "size of maglev_5dof_phase_state_t");
#else
extern char maglev_5dof_phase_input_size_is_40[(sizeof(maglev_5dof_phase_input_t) == 40u) ? 1 : -1];
extern char maglev_5dof_phase_output_size_is_48[(sizeof(maglev_5dof_phase_output_t) == 48u) ? 1 : -1];
extern char maglev_5dof_phase_state_size_is_64[(sizeof(maglev_5dof_phase_state_t) == 64u) ? 1 : -1];
#endif

/* Signals and what happened: each signal from the last step that computed it, since a latch or another branch skips
 * some. Set the struct to zero when you call init. */
typedef struct {
    float x_acting;                     /* m: x when the current acts */
    float lost_x;                       /* 1: x is unknown */
    float z_acting;                     /* m: z when the current acts */
    float lost_z;                       /* 1: z is unknown */
    uint32_t samples;                   /* steps that had this struct */
    uint32_t faults;                    /* fault word of the last step */
} maglev_5dof_phase_diagnostics_t;

#if defined(MAGLEV_5DOF_PHASE_DIAGNOSTICS)
/* The step; `diagnostics` may be null. */
uint32_t maglev_5dof_phase_step_diagnosed(maglev_5dof_phase_state_t *state, const maglev_5dof_phase_input_t *in,
    maglev_5dof_phase_output_t *out, maglev_5dof_phase_diagnostics_t *diagnostics);
#endif

#ifdef __cplusplus
}
#endif

#endif
