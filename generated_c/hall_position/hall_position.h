/* hall_position: two sensors have no fault protection. A failed sensor may leave no residual, and an estimate may be
 * valid and wrong. The deviations hold for the field of the model only, two waves along each axis whose voltages are
 * right to the noise of 1 mV rms. In the field of the fabricated matrix or of a finite one, with an amplitude 2 % low,
 * or with gains that differ by 1 %, they are 20 to 1,800 times too small.
 *
 * hall_position: one step every 0.00125 s, float. Generated: do not edit. What may fail and what follows:
 * hall_position.md.
 *
 * Call hall_position_init once, then hall_position_step once every 0.00125 s with the inputs of that sample, and use
 * its outputs at once. Nothing else may change the state.
 *
 * The three pointers must not be null and must point to objects that do not overlap. One state serves one machine;
 * steps on different states may run at the same time.
 *
 * When a measurement is refused in 5 samples in a row, the last of them sets the latch bit until init. An estimator
 * moves nothing: once latched it continues, and the fault word shows the latch.
 *
 * At init the body is within 2.4 degrees of yaw 0. Until the first valid sample it moves on a circle with a radius of 6
 * mm at 50 to 200 mm/s, in either sense and from any point of it, and remains within half a pitch of the counted origin
 * along X and Y. At least 95 % of starts are valid within one revolution, which takes 0.75 s at most; of bodies that
 * rest, at most 30 % ever are. The other starts need init elsewhere. A lost position lock needs init.
 *
 * (n) is equation (n) of Y. Kawato, W.-J. Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis
 * Hall-Effect Sensors".
 *
 * The gains and numbers in hall_position.c hold for one plant and one period: for other masses, geometry or magnets, or
 * another period, generate the files again. gains.json says where each gain comes from.
 *
 * Compile with -std=c99 -O2 -ffp-contract=off -fno-math-errno. With -ffp-contract=fast results differ by rounding.
 * -ffast-math, -ffinite-math-only and floating-point arithmetic in a wider type are refused by #error. The source
 * cannot see options that assume that no value is NaN or infinite, or that reorder sums, by other names, such as
 * -fno-honor-nans or -funsafe-math-optimizations, nor -ffast-math of the linker: do not use them.
 */
#ifndef HALL_POSITION_H
#define HALL_POSITION_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hall_position_state hall_position_state_t;

typedef struct {
    float V_ax;                         /* V, -5 .. 5: Hall sensor a, axis x */
    float V_ay;                         /* V, -5 .. 5: Hall sensor a, axis y */
    float V_bx;                         /* V, -5 .. 5: Hall sensor b, axis x */
    float V_by;                         /* V, -5 .. 5: Hall sensor b, axis y */
} hall_position_input_t;

typedef struct {
    /* m, -0.508 .. 0.508: position of the body's origin along X of the magnet matrix */
    float X;
    /* m, -0.508 .. 0.508: position of the body's origin along Y of the magnet matrix */
    float Y;
    float yaw;                          /* rad, -3.14159 .. 3.14159: yaw of the body relative to the magnet matrix */
    float deviation_X;                  /* m, 0 .. 10000: standard deviation of X from the voltages' noise */
    float deviation_Y;                  /* m, 0 .. 10000: standard deviation of Y from the voltages' noise */
    float deviation_yaw;                /* rad, 0 .. 1: standard deviation of yaw from the voltages' noise */
    float residual;                     /* V, 0 .. 1000: rms of the voltage residuals, by degrees of freedom */
    float converged;                    /* 1, 0 .. 1: the last correction is small, and no correction raised the cost */
    /* 1, 0 .. 1: the voltages alone do not determine the pose: the prior decides a part of it */
    float damped;
    /* 1, 0 .. 1: converged, unambiguous, position lock held, not damped, no residual fault, innovation within its gate,
     * inputs accepted */
    float valid;
    /* 1, 0 .. 1: position lock lost, or pitches or yaw out of range: nothing is valid until init */
    float lock_lost;
} hall_position_output_t;

/* Put the state to its initial values. The caller owns it. */
void hall_position_init(hall_position_state_t *state);

/* Compute one sample: read `in`, write `out`, advance `state`.
 * It returns the fault bits:
 *   bit  0  V_ax: not finite or outside its range
 *   bit  1  V_ay: not finite or outside its range
 *   bit  2  V_bx: not finite or outside its range
 *   bit  3  V_by: not finite or outside its range
 *   bit 31  latched until init
 */
uint32_t hall_position_step(hall_position_state_t *state, const hall_position_input_t *in, hall_position_output_t *out);

/* What follows is for init and step alone: the state, by Block. */
typedef struct {
    /* rad, -3.14159 .. 3.14159: phase of the sensors' centre along x, within its pitch */
    float phase_x;
    /* rad, -3.14159 .. 3.14159: phase of the sensors' centre along y, within its pitch */
    float phase_y;
    float yaw;                          /* rad, -3.14159 .. 3.14159: yaw of the last sample */
    /* rad, -3.14159 .. 3.14159: yaw of the last sample with the ambiguity resolved */
    float yaw_last_good;
    float start_x;                      /* rad, -3.14159 .. 3.14159: phase along x at which the last search started */
    float start_y;                      /* rad, -3.14159 .. 3.14159: phase along y at which the last search started */
    float pitch_x;                      /* 1, -8 .. 8: number of whole pitches along x, from the middle one */
    float pitch_y;                      /* 1, -8 .. 8: number of whole pitches along y, from the middle one */
    float motion_x;                     /* rad, -0.5 .. 0.5: predicted change of phase per sample */
    float motion_y;                     /* rad, -0.5 .. 0.5: predicted change of phase per sample */
    float motion_yaw;                   /* rad, -0.101003 .. 0.101003: predicted change of yaw per sample */
    uint32_t residual_faults;           /* 1, 0 .. 5: consecutive samples with a residual fault */
    uint32_t searching;                 /* 1, 0 .. 1: position lock is being searched */
    uint32_t ambiguity_resolved;        /* 1, 0 .. 1: no other position has the same voltages */
    uint32_t acquired;                  /* 1, 0 .. 1: position lock has been acquired since init */
    uint32_t lock_lost;                 /* 1, 0 .. 1: position lock has been lost since it was acquired */
} hall_position_estimator_state_t;

typedef struct {
    float last_V_ax;                    /* V, -5 .. 5: last good value */
    float last_V_ay;                    /* V, -5 .. 5: last good value */
    float last_V_bx;                    /* V, -5 .. 5: last good value */
    float last_V_by;                    /* V, -5 .. 5: last good value */
    uint32_t left;                      /* 1, 1 .. 5: samples with a bad measurement until it latches */
    uint32_t latched;                   /* 1, 0 .. 1: latched until init */
    uint32_t ready;                     /* 1, 0 .. 1: every measurement was good at once */
} hall_position_guard_state_t;

struct hall_position_state {
    hall_position_guard_state_t guard;
    hall_position_estimator_state_t estimator;
};

/* The layout is the same on every target. */
#if defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
_Static_assert(sizeof(hall_position_input_t) == 16u, "size of hall_position_input_t");
_Static_assert(sizeof(hall_position_output_t) == 44u, "size of hall_position_output_t");
_Static_assert(sizeof(hall_position_state_t) == 92u, "size of hall_position_state_t");
#else
extern char hall_position_input_size_is_16[(sizeof(hall_position_input_t) == 16u) ? 1 : -1];
extern char hall_position_output_size_is_44[(sizeof(hall_position_output_t) == 44u) ? 1 : -1];
extern char hall_position_state_size_is_92[(sizeof(hall_position_state_t) == 92u) ? 1 : -1];
#endif

#ifdef __cplusplus
}
#endif

#endif
