/* hall_position_three: one step every 0.00125 s, float. Generated: do not edit. What may fail and what follows:
 * hall_position_three.md.
 *
 * Call hall_position_three_init once, then hall_position_three_step once every 0.00125 s with the inputs of that
 * sample, and use its outputs at once. Nothing else may change the state.
 *
 * The three pointers must not be null and must point to objects that do not overlap. One state serves one machine;
 * steps on different states may run at the same time.
 *
 * When a measurement is refused in 5 samples in a row, the last of them sets the latch bit until init. An estimator
 * moves nothing: once latched it continues, and the fault word shows the latch.
 *
 * At init the body is within half a pitch of the counted origin along X and Y, and within 9 degrees of yaw 0. It rests
 * until the first valid sample: at least 80 % of such starts are valid within 0.15 s. A lost track needs init, and so
 * does a body that has left 8 pitches to either side of the origin along X or Y. After a fault of one sensor, a gain,
 * an offset, a drift, a stuck, lost or noisy voltage, at most 0.05 % of the samples are valid with an error above a
 * protection level, for voltages within 5 mV rms of the model; nothing is valid while a sensor is excluded. Three
 * sensors need a calibration of the unit to that, gains that stay within 0.3 % of it, and a map of its field. Without
 * it at most 20 % of the samples are valid, and their errors may exceed the levels. If a sensor fails before the first
 * valid sample, at most 5 % of the starts are valid, and those may be wrong.
 *
 * The gains and numbers in hall_position_three.c hold for one plant and one period: for other masses, geometry or
 * magnets, or another period, generate the files again. gains.json says where each gain comes from.
 *
 * With HALL_POSITION_THREE_DIAGNOSTICS defined, for the .c as well, hall_position_three_step_diagnosed also says which
 * signals it computed and why it latched. Without the macro the diagnostics cost nothing.
 *
 * Compile with -std=c99 -O2 -ffp-contract=off -fno-math-errno. With -ffp-contract=fast results differ by rounding.
 * -ffast-math, -ffinite-math-only and floating-point arithmetic in a wider type are refused by #error. The source
 * cannot see options that assume that no value is NaN or infinite, or that reorder sums, by other names, such as
 * -fno-honor-nans or -funsafe-math-optimizations, nor -ffast-math of the linker: do not use them.
 */
#ifndef HALL_POSITION_THREE_H
#define HALL_POSITION_THREE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hall_position_three_state hall_position_three_state_t;

typedef struct {
    float V_ax;                         /* V, -5 .. 5: Hall sensor a, axis x */
    float V_ay;                         /* V, -5 .. 5: Hall sensor a, axis y */
    float V_bx;                         /* V, -5 .. 5: Hall sensor b, axis x */
    float V_by;                         /* V, -5 .. 5: Hall sensor b, axis y */
    float V_cx;                         /* V, -5 .. 5: Hall sensor c, axis x */
    float V_cy;                         /* V, -5 .. 5: Hall sensor c, axis y */
} hall_position_three_input_t;

typedef struct {
    float X;                            /* m, -0.508 .. 0.508: position of the body's origin along X */
    float Y;                            /* m, -0.508 .. 0.508: position of the body's origin along Y */
    float deviation_X;                  /* m, 0 .. 0.000161702: standard deviation of X, limited */
    float deviation_Y;                  /* m, 0 .. 0.000161702: standard deviation of Y, limited */
    /* m, 0 .. 0.15: protection level of X: with errors of the covariance R, a fault in one group of channels moves it
     * by more only with the declared risk */
    float protection_X;
    /* m, 0 .. 0.15: protection level of Y: with errors of the covariance R, a fault in one group of channels moves it
     * by more only with the declared risk */
    float protection_Y;
    float yaw;                          /* rad, -0.20944 .. 0.20944 */
    float amplitude;                    /* 1, 0.75 .. 1.25: field over that of the model */
    float deviation_yaw;                /* rad, 0 .. 0.008: standard deviation of yaw, limited */
    float deviation_amplitude;          /* 1, 0 .. 0.02: standard deviation of amplitude, limited */
    /* rad, 0 .. 6.6: protection level of yaw: with errors of the covariance R, a fault in one group of channels moves
     * it by more only with the declared risk */
    float protection_yaw;
    float chi_square;                   /* 1, 0 .. 1e+09: weighted sum of squared residuals, and of the priors */
    float converged;                    /* 1, 0 .. 1: the last correction is small */
    /* 1, 0 .. 1: the channels do not determine every unknown to its largest deviation */
    float weak;
    float excluded;                     /* 1, 0 .. 3: number of the group of channels excluded as faulty, 0 for none */
    float doubted;                      /* 1, 0 .. 1: another group than the excluded one may be at fault */
    /* 1, 0 .. 1: a sweep of start points has found a single solution, which is followed */
    float tracking;
    float lost;                         /* 1, 0 .. 1: the track is lost: nothing is valid until init */
    /* 1, 0 .. 1: converged, tracked, passes its test, within its protection levels and pitches */
    float valid;
} hall_position_three_output_t;

/* Put the state to its initial values. The caller owns it. */
void hall_position_three_init(hall_position_three_state_t *state);

/* Compute one sample: read `in`, write `out`, advance `state`.
 * It returns the fault bits:
 *   bit  0  V_ax: not finite or outside its range
 *   bit  1  V_ay: not finite or outside its range
 *   bit  2  V_bx: not finite or outside its range
 *   bit  3  V_by: not finite or outside its range
 *   bit  4  V_cx: not finite or outside its range
 *   bit  5  V_cy: not finite or outside its range
 *   bit 31  latched until init
 */
uint32_t hall_position_three_step(hall_position_three_state_t *state, const hall_position_three_input_t *in,
    hall_position_three_output_t *out);

/* What follows is for init and step alone: the state, by Block. */
typedef struct {
    float last_x;                       /* rad, -3.14159 .. 3.14159: phase of the last sample */
    float last_y;                       /* rad, -3.14159 .. 3.14159: phase of the last sample */
    float pitch_x;                      /* 1, -9 .. 9: pitches along x */
    float pitch_y;                      /* 1, -9 .. 9: pitches along y */
    uint32_t counting;                  /* 1, 0 .. 1: the last sample was tracked */
} hall_position_three_metres_state_t;

typedef struct {
    float phase_x;                      /* rad, -3.14159 .. 3.14159 */
    float phase_y;                      /* rad, -3.14159 .. 3.14159 */
    float yaw;                          /* rad, -0.20944 .. 0.20944 */
    float amplitude;                    /* 1, 0.75 .. 1.25: field over that of the model */
    float motion_phase_x;               /* rad, -0.5 .. 0.5: predicted change of phase_x a sample */
    float motion_phase_y;               /* rad, -0.5 .. 0.5: predicted change of phase_y a sample */
    float motion_yaw;                   /* rad, -0.1 .. 0.1: predicted change of yaw a sample */
    uint32_t excluded;                  /* 1, 0 .. 3: number of the group of channels excluded as faulty, 0 for none */
    /* 1, 0 .. 1: hypothesis 1 has passed since a group is excluded, and its own solution has not failed */
    uint32_t plausible_1;
    /* 1, 0 .. 1: hypothesis 2 has passed since a group is excluded, and its own solution has not failed */
    uint32_t plausible_2;
    /* 1, 0 .. 1: hypothesis 3 has passed since a group is excluded, and its own solution has not failed */
    uint32_t plausible_3;
    uint32_t competing;                 /* 1, 0 .. 3: number of the group whose hypothesis is tested next, 0 for none */
    uint32_t start_number;              /* 1, 0 .. 24: starts of this sweep so far, all of them while tracking */
    uint32_t candidates;                /* 1, 0 .. 2: solutions in this sweep so far, 2 for more than one */
    uint32_t missed;                    /* 1, 0 .. 8: samples in a row without an accepted solution; the last: lost */
    uint32_t age;                       /* 1, 0 .. 3: samples since this start */
    float candidate_phase_x;            /* rad, -3.14159 .. 3.14159: phase_x of the first solution of this sweep */
    float candidate_phase_y;            /* rad, -3.14159 .. 3.14159: phase_y of the first solution of this sweep */
    float candidate_yaw;                /* rad, -0.20944 .. 0.20944: yaw of the first solution of this sweep */
    float candidate_amplitude;          /* 1, 0.75 .. 1.25: amplitude of the first solution of this sweep */
    float begin_phase_x;                /* rad, -3.14159 .. 3.14159: phase_x of this start */
    float begin_phase_y;                /* rad, -3.14159 .. 3.14159: phase_y of this start */
    float begin_yaw;                    /* rad, -0.20944 .. 0.20944: yaw of this start */
} hall_position_three_estimator_state_t;

typedef struct {
    float last_V_ax;                    /* V, -5 .. 5: of the last sample */
    float last_V_ay;                    /* V, -5 .. 5: of the last sample */
    float last_V_bx;                    /* V, -5 .. 5: of the last sample */
    float last_V_by;                    /* V, -5 .. 5: of the last sample */
    float last_V_cx;                    /* V, -5 .. 5: of the last sample */
    float last_V_cy;                    /* V, -5 .. 5: of the last sample */
    /* 1, 0 .. 6: samples in a row in which a channel of group 1 has the same code */
    uint32_t repeats_1;
    /* 1, 0 .. 6: samples in a row in which a channel of group 2 has the same code */
    uint32_t repeats_2;
    /* 1, 0 .. 6: samples in a row in which a channel of group 3 has the same code */
    uint32_t repeats_3;
} hall_position_three_screen_state_t;

typedef struct {
    float last_V_ax;                    /* V, -5 .. 5: last good value */
    float last_V_ay;                    /* V, -5 .. 5: last good value */
    float last_V_bx;                    /* V, -5 .. 5: last good value */
    float last_V_by;                    /* V, -5 .. 5: last good value */
    float last_V_cx;                    /* V, -5 .. 5: last good value */
    float last_V_cy;                    /* V, -5 .. 5: last good value */
    uint32_t left;                      /* 1, 1 .. 5: samples with a bad measurement until it latches */
    uint32_t latched;                   /* 1, 0 .. 1: latched until init */
    uint32_t ready;                     /* 1, 0 .. 1: every measurement was good at once */
} hall_position_three_guard_state_t;

struct hall_position_three_state {
    hall_position_three_guard_state_t guard;
    hall_position_three_screen_state_t screen;
    hall_position_three_estimator_state_t estimator;
    hall_position_three_metres_state_t metres;
};

/* The layout is the same on every target. */
#if defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
_Static_assert(sizeof(hall_position_three_input_t) == 24u, "size of hall_position_three_input_t");
_Static_assert(sizeof(hall_position_three_output_t) == 76u, "size of hall_position_three_output_t");
_Static_assert(sizeof(hall_position_three_state_t) == 184u, "size of hall_position_three_state_t");
#else
extern char hall_position_three_input_size_is_24[(sizeof(hall_position_three_input_t) == 24u) ? 1 : -1];
extern char hall_position_three_output_size_is_76[(sizeof(hall_position_three_output_t) == 76u) ? 1 : -1];
extern char hall_position_three_state_size_is_184[(sizeof(hall_position_three_state_t) == 184u) ? 1 : -1];
#endif

/* Signals and what happened: each signal from the last step that computed it, since a latch or another branch skips
 * some. Set the struct to zero when you call init. */
typedef struct {
    float rejected;                     /* 1: number of the group of channels that is refused or frozen */
    float screened;                     /* 1: no group of channels is faulty, or a single one, which is rejected */
    float phase_x;                      /* rad */
    float phase_y;                      /* rad */
    float deviation_phase_x;            /* rad: standard deviation of phase_x, limited */
    float deviation_phase_y;            /* rad: standard deviation of phase_y, limited */
    /* 1: converged, complete, not weak, and passes the integrity monitor if there is one */
    float phases_valid;
    /* rad: protection level of phase_x: with errors of the covariance R, a fault in one group of channels moves it by
     * more only with the declared risk */
    float protection_phase_x;
    /* rad: protection level of phase_y: with errors of the covariance R, a fault in one group of channels moves it by
     * more only with the declared risk */
    float protection_phase_y;
    uint32_t samples;                   /* steps that had this struct */
    uint32_t faults;                    /* fault word of the last step */
    uint32_t latch_cause;               /* fault word of the step that latched, 0 before */
} hall_position_three_diagnostics_t;

#if defined(HALL_POSITION_THREE_DIAGNOSTICS)
/* The step; `diagnostics` may be null. */
uint32_t hall_position_three_step_diagnosed(hall_position_three_state_t *state, const hall_position_three_input_t *in,
    hall_position_three_output_t *out, hall_position_three_diagnostics_t *diagnostics);
#endif

#ifdef __cplusplus
}
#endif

#endif
