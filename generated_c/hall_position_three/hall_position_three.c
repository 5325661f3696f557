/* hall_position_three. Generated: do not edit. */
/* A comment with `admit` states a bound that the generator has certified, for Frama-C. */
#include "hall_position_three.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float hall_position_three_min(float a, float b)
{
    return (a < b) ? a : b;
}

static inline float hall_position_three_max(float a, float b)
{
    return (a > b) ? a : b;
}

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float hall_position_three_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline uint32_t hall_position_three_flag(bool holds)
{
    uint32_t value = 0u;
    if (holds) {
        value = 1u;
    }
    return value;
}

#if defined(__GNUC__)
#define HALL_POSITION_THREE_INLINE static inline __attribute__((always_inline))
#else
#define HALL_POSITION_THREE_INLINE static inline
#endif
/* Return a value in -high .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
HALL_POSITION_THREE_INLINE float hall_position_three_hold_within(float value, float high, float *last, uint32_t bit,
    uint32_t *faults)
{
    float held = value;
    if (fabsf(value) <= high) {
        *last = value;
    } else {
        held = *last;
        *faults |= bit;
    }
    return held;
}

/* f1_polynomial / x; x = estimator_yaw + estimator_motion_yaw in -3.28181362 .. 3.28181362, t = x^2; relative error at
 * most 1.2e-07. */
static inline float f1_polynomial(float t)
{
    return 0.25f + (t * (-0.0026041642f + (t * (8.136648e-06f + (t * -1.18924985e-08f)))));
}

/* yaw_part_cosine; x = estimator_yaw + estimator_motion_yaw in -3.28181362 .. 3.28181362, t = x^2; relative error at
 * most 1.4e-07. */
static inline float yaw_part_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.031249862f + (t * (0.00016270163f + (t * -3.3074548e-07f)))));
}

/* f3_polynomial / x; x = clamp((((estimator_phase_x + estimator_motion_x) - (1.5812683 * (1 - (...)))) - (1.5833627 *
 * clamp(((...) * (...)), -1, 1))), -5.87932518, 5.87932518) in -5.87932539 .. 5.87932539, t = x^2; relative error at
 * most 1.2e-07. */
static inline float f3_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552067f + (t * (2.5428514e-07f + (t * -9.3237806e-11f)))));
}

/* ax_part_cosine; x = clamp((((estimator_phase_x + estimator_motion_x) - (1.5812683 * (1 - (...)))) - (1.5833627 *
 * clamp(((...) * (...)), -1, 1))), -5.87932518, 5.87932518) in -5.87932539 .. 5.87932539, t = x^2; relative error at
 * most 1.1e-07. */
static inline float ax_part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.007812488f + (t * (1.0170485e-05f + (t * -5.1988818e-09f)))));
}

/* f5_polynomial / x; x = clamp((((estimator_phase_x + estimator_motion_x) - (0.0858701992 * (1 - (...)))) -
 * (0.081681409 * clamp(((...) * (...)), -1, 1))), -3.76010655, 3.76010655) in -3.76010656 .. 3.76010656, t = x^2;
 * relative error at most 1.2e-07. */
static inline float f5_polynomial(float t)
{
    return 0.25f + (t * (-0.002604161f + (t * (8.135633e-06f + (t * -1.1823737e-08f)))));
}

/* bx_part_cosine; x = clamp((((estimator_phase_x + estimator_motion_x) - (0.0858701992 * (1 - (...)))) - (0.081681409 *
 * clamp(((...) * (...)), -1, 1))), -3.76010655, 3.76010655) in -3.76010656 .. 3.76010656, t = x^2; relative error at
 * most 1.3e-07. */
static inline float bx_part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.03125f + (t * (0.00016276016f + (t * (-3.390026e-07f + (t * 3.7027664e-10f)))))));
}

/* f7_polynomial / x; x = clamp((((estimator_phase_x + estimator_motion_x) + (1.6671385 * (1 - (...)))) + (1.66504411 *
 * clamp(((...) * (...)), -1, 1))), -5.99780204, 5.99780204) in -5.99780226 .. 5.99780226, t = x^2; relative error at
 * most 1.2e-07. */
static inline float f7_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552064f + (t * (2.5428218e-07f + (t * -9.317061e-11f)))));
}

/* cx_part_cosine; x = clamp((((estimator_phase_x + estimator_motion_x) + (1.6671385 * (1 - (...)))) + (1.66504411 *
 * clamp(((...) * (...)), -1, 1))), -5.99780204, 5.99780204) in -5.99780226 .. 5.99780226, t = x^2; relative error at
 * most 1.2e-07. */
static inline float cx_part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.007812486f + (t * (1.0170291e-05f + (t * -5.1943916e-09f)))));
}

/* f9_polynomial / x; x = clamp(((((...) - (...)) - ((...) * (...))) / max(((...) + (...)), 0.874383744)), -0.140220856,
 * 0.140220856) in -0.140220851 .. 0.140220851, t = x^2; relative error at most 1.2e-07. */
static inline float f9_polynomial(float t)
{
    return 1.0f + (t * (-0.16666663f + (t * 0.008327514f)));
}

/* f10_polynomial / x; x = clamp(((((...) - (...)) - ((...) * (...))) / max(((...) + (...)), 0.874383744)),
 * -0.140220856, 0.140220856) in -0.140220851 .. 0.140220851, t = x^2; relative error at most 1.2e-07. */
static inline float f10_polynomial(float t)
{
    return 0.5f + (t * (0.041666593f + (t * 0.004178401f)));
}

/* f11_polynomial; x = clamp(((clamp((...), -0.5, 0.5) - (1.5812683 * (...))) - (1.5833627 * clamp((...), -0.140220856,
 * 0.140220856))), -0.943747269, 0.943747269) in -0.943747282 .. 0.943747282, t = x^2; relative error at most
 * 1.3e-07. */
static inline float f11_polynomial(float t)
{
    return 1.0f + (t * (-0.5f + (t * (0.0416666f + (t * (-0.0013885538f + (t * 2.4265188e-05f)))))));
}

/* f12_polynomial / x; x = clamp(((clamp((...), -0.5, 0.5) - (1.5812683 * (...))) - (1.5833627 * clamp((...),
 * -0.140220856, 0.140220856))), -0.943747269, 0.943747269) in -0.943747282 .. 0.943747282, t = x^2; relative error at
 * most 1.2e-07. */
static inline float f12_polynomial(float t)
{
    return 1.0f + (t * (-0.1666663f + (t * (0.008330877f + (t * -0.00019370353f)))));
}

/* f13_polynomial; x = clamp(((clamp((...), -0.5, 0.5) - (0.0858701992 * (...))) - (0.081681409 * clamp((...),
 * -0.140220856, 0.140220856))), -0.52349423, 0.52349423) in -0.523494244 .. 0.523494244, t = x^2; relative error at
 * most 6e-08. */
static inline float f13_polynomial(float t)
{
    return 1.0f + (t * (-0.4999999f + (t * (0.041664638f + (t * -0.0013759605f)))));
}

/* f14_polynomial / x; x = clamp(((clamp((...), -0.5, 0.5) - (0.0858701992 * (...))) - (0.081681409 * clamp((...),
 * -0.140220856, 0.140220856))), -0.52349423, 0.52349423) in -0.523494244 .. 0.523494244, t = x^2; relative error at
 * most 1.2e-07. */
static inline float f14_polynomial(float t)
{
    return 1.0f + (t * (-0.16666666f + (t * (0.008333108f + (t * -0.00019697788f)))));
}

/* f15_polynomial; x = clamp(((clamp((...), -0.5, 0.5) + (1.6671385 * (...))) + (1.66504411 * clamp((...), -0.140220856,
 * 0.140220856))), -0.967241498, 0.967241498) in -0.967241466 .. 0.967241466, t = x^2; relative error at most
 * 1.3e-07. */
static inline float f15_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666433f + (t * (-0.0013882659f + (t * 2.4110182e-05f)))))));
}

/* f16_polynomial / x; x = clamp(((clamp((...), -0.5, 0.5) + (1.6671385 * (...))) + (1.66504411 * clamp((...),
 * -0.140220856, 0.140220856))), -0.967241498, 0.967241498) in -0.967241466 .. 0.967241466, t = x^2; relative error at
 * most 1.2e-07. */
static inline float f16_polynomial(float t)
{
    return 1.0f + (t * (-0.16666624f + (t * (0.00833062f + (t * -0.00019346498f)))));
}

/* f17_polynomial; x = clamp(((clamp((...), -0.5, 0.5) + (1.6671385 * (...))) + (1.66504411 * clamp((...), -0.140220856,
 * 0.140220856))), -0.967241498, 0.967241498) in -0.967241526 .. 0.967241526, t = x^2; relative error at most
 * 1.3e-07. */
static inline float f17_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666433f + (t * (-0.0013882659f + (t * 2.4110182e-05f)))))));
}

/* f18_polynomial / x; x = clamp(((clamp((...), -0.5, 0.5) + (1.6671385 * (...))) + (1.66504411 * clamp((...),
 * -0.140220856, 0.140220856))), -0.967241498, 0.967241498) in -0.967241526 .. 0.967241526, t = x^2; relative error at
 * most 1.2e-07. */
static inline float f18_polynomial(float t)
{
    return 1.0f + (t * (-0.16666624f + (t * (0.00833062f + (t * -0.00019346498f)))));
}

/* f19_polynomial; x = ((((...) || (...)) && (!estimator_searching)) ? 0 : (converged ? clamp((...), -0.140220856,
 * 0.140220856) : ((...) ? (...) : (...)))) in -0.140220851 .. 0.140220851, t = x^2; relative error at most 6e-08. */
static inline float f19_polynomial(float t)
{
    return 1.0f + (t * (-0.49999976f + (t * 0.041628234f)));
}

void hall_position_three_init(hall_position_three_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (hall_position_three_state_t){
        .guard_left = 5u,
        .estimator_searching = 1u,
    };
}

uint32_t hall_position_three_step(hall_position_three_state_t *state, const hall_position_three_input_t *in,
    hall_position_three_output_t *out)
{
    /* guard: range acceptance, hold, latch
     *     left_next = latch_samples if complete is set, else (left if left <= 1, else left - 1) */
    static const uint32_t latch_samples = 5u;                   /* 1; bad samples in a row until it latches */
    uint32_t faults = 0u;
    const float V_ax_held = hall_position_three_hold_within(in->V_ax, 5.0f, &state->guard_last_V_ax, 0x00000001u,
        &faults);
    const float V_ay_held = hall_position_three_hold_within(in->V_ay, 5.0f, &state->guard_last_V_ay, 0x00000002u,
        &faults);
    const float V_bx_held = hall_position_three_hold_within(in->V_bx, 5.0f, &state->guard_last_V_bx, 0x00000004u,
        &faults);
    const float V_by_held = hall_position_three_hold_within(in->V_by, 5.0f, &state->guard_last_V_by, 0x00000008u,
        &faults);
    const float V_cx_held = hall_position_three_hold_within(in->V_cx, 5.0f, &state->guard_last_V_cx, 0x00000010u,
        &faults);
    const float V_cy_held = hall_position_three_hold_within(in->V_cy, 5.0f, &state->guard_last_V_cy, 0x00000020u,
        &faults);
    const bool fault_V_ax = !((faults & 0x00000001u) == 0u);
    const bool fault_V_ay = !((faults & 0x00000002u) == 0u);
    const bool fault_V_bx = !((faults & 0x00000004u) == 0u);
    const bool fault_V_by = !((faults & 0x00000008u) == 0u);
    const bool fault_V_cx = !((faults & 0x00000010u) == 0u);
    const bool fault_V_cy = !((faults & 0x00000020u) == 0u);
    const bool complete = (faults & 0x0000003fu) == 0u;
    const uint32_t guard_latched = state->guard_latched;
    uint32_t latched = guard_latched;
    if (complete) {
        state->guard_left = latch_samples;
        state->guard_ready = 1u;
    } else {
        const uint32_t guard_left = state->guard_left;
        if (guard_left <= 1u) {
            latched = 1u;
        } else {
            state->guard_left = guard_left - 1u;
        }
    }
    if (latched != 0u) {
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    }

    /* estimator: GLSDC, Fig. 9
     *     yaw_part_sine = 4 * sin(0.25 * (yaw + motion_yaw))
     *     yaw_part_cosine = cos(0.25 * (yaw + motion_yaw))
     *     ax_part_sine = 8 * sin(0.125 * limited_ax); likewise ay_part_sine, cx_part_sine, cy_part_sine
     *     ax_part_cosine = cos(0.125 * limited_ax); likewise ay_part_cosine, cx_part_cosine, cy_part_cosine
     *     ax_part_doubled = limit(8 * (sin(0.125 * limited_ax) * ax_part_cosine * (1 - 0.03125 *
     *         ax_part_sine^2)), 2.002); likewise ay_part_doubled, cx_part_doubled, cy_part_doubled
     *     ax_part_full = limit(ax_part_doubled * (1 - 0.125 * sines_2_ax^2), 1.001); likewise ay_part_full,
     *         bx_part_full, by_part_full, cx_part_full, cy_part_full
     *     bx_part_sine = 4 * sin(0.25 * limited_bx); likewise by_part_sine
     *     bx_part_cosine = cos(0.25 * limited_bx); likewise by_part_cosine
     *     bx_part_doubled = limit(4 * (sin(0.25 * limited_bx) * bx_part_cosine), 2.002); likewise
     *         by_part_doubled
     *     X = 0.00808507 * pose_phase_x + 0.0508 * pose_pitch_x - lever_cosine; likewise Y
     *     deviation_X = 8.08507e-06 * sqrt(inverse_1 + by_yaw_X^2 * yaw_variance); likewise deviation_Y
     *     phase_x_next = (start_x + -1.54015 + two_pi if start_x + -1.54015 < -pi, else start_x + -1.54015) if
     *         restart, else pose_phase_x
     *     phase_y_next = (start_y + -2.70277 + two_pi if start_y + -2.70277 < -pi, else start_y + -2.70277) if
     *         restart, else pose_phase_y
     *     start_x_next = (start_x + -1.54015 + two_pi if start_x + -1.54015 < -pi, else start_x + -1.54015) if
     *         restart, else start_x
     *     start_y_next = (start_y + -2.70277 + two_pi if start_y + -2.70277 < -pi, else start_y + -2.70277) if
     *         restart, else start_y */
    static const float pi = 3.1415927f;                         /* 1; pi */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_1 = 2.24906f;
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_3 = 3.60456f;
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_5 = -2.883648f;
    const float estimator_motion_yaw = state->estimator_motion_yaw;
    const float prediction_yaw = state->estimator_yaw + estimator_motion_yaw;
    const float yaw_part_cosine_argument = prediction_yaw * prediction_yaw;
    const float f1 = prediction_yaw * f1_polynomial(yaw_part_cosine_argument);
    const float yaw_part_sine = 4.0f * f1;
    const float yaw_part_cosine = yaw_part_cosine_polynomial(yaw_part_cosine_argument);
    const float estimator_motion_x = state->estimator_motion_x;
    const float prediction_phase_x = state->estimator_phase_x + estimator_motion_x;
    const float s_yaw = hall_position_three_limit(4.0f * (f1 * yaw_part_cosine), 2.0f);
    const float heading_cosine = 1.0f - (0.5f * (s_yaw * s_yaw));
    const float heading_sine = hall_position_three_limit(s_yaw * (1.0f - (0.125f * (yaw_part_sine * yaw_part_sine))),
        1.0f);
    const float heading_sine_scaled = 1.5833627f * heading_sine;
    const float limited_ax = hall_position_three_limit(prediction_phase_x - (1.5812683f * heading_cosine) -
        heading_sine_scaled, 5.8793254f);
    const float ax_part_cosine_argument = limited_ax * limited_ax;
    const float f3 = limited_ax * f3_polynomial(ax_part_cosine_argument);
    const float ax_part_sine = 8.0f * f3;
    const float ax_part_cosine = ax_part_cosine_polynomial(ax_part_cosine_argument);
    const float f3_times_ax_part_cosine = f3 * ax_part_cosine;
    const float ax_part_doubled = 8.0f *
        (f3_times_ax_part_cosine * (1.0f - (0.03125f * (ax_part_sine * ax_part_sine))));
    /*@ admit -2.002f <= ax_part_doubled <= 2.002f; */
    const float sines_2_ax = 8.0f * f3_times_ax_part_cosine;
    const float ax_part_full = ax_part_doubled * (1.0f - (0.125f * (sines_2_ax * sines_2_ax)));
    /*@ admit -1.001f <= ax_part_full <= 1.001f; */
    const float estimator_motion_y = state->estimator_motion_y;
    const float prediction_phase_y = state->estimator_phase_y + estimator_motion_y;
    const float heading_cosine_scaled = 1.5833627f * heading_cosine;
    const float heading_sine_scaled_2 = 1.5812683f * heading_sine;
    const float limited_ay = hall_position_three_limit(prediction_phase_y + heading_cosine_scaled -
        heading_sine_scaled_2, 5.8793254f);
    const float ay_part_cosine_argument = limited_ay * limited_ay;
    const float f3_2 = limited_ay * f3_polynomial(ay_part_cosine_argument);
    const float ay_part_sine = 8.0f * f3_2;
    const float ay_part_cosine = ax_part_cosine_polynomial(ay_part_cosine_argument);
    const float f3_2_times_ay_part_cosine = f3_2 * ay_part_cosine;
    const float ay_part_doubled = 8.0f *
        (f3_2_times_ay_part_cosine * (1.0f - (0.03125f * (ay_part_sine * ay_part_sine))));
    /*@ admit -2.002f <= ay_part_doubled <= 2.002f; */
    const float sines_2_ay = 8.0f * f3_2_times_ay_part_cosine;
    const float ay_part_full = ay_part_doubled * (1.0f - (0.125f * (sines_2_ay * sines_2_ay)));
    /*@ admit -1.001f <= ay_part_full <= 1.001f; */
    const float heading_sine_scaled_3 = 0.08168141f * heading_sine;
    const float limited_bx = hall_position_three_limit(prediction_phase_x - (0.0858702f * heading_cosine) -
        heading_sine_scaled_3, 3.7601066f);
    const float bx_part_cosine_argument = limited_bx * limited_bx;
    const float f5 = limited_bx * f5_polynomial(bx_part_cosine_argument);
    const float bx_part_sine = 4.0f * f5;
    const float bx_part_cosine = bx_part_cosine_polynomial(bx_part_cosine_argument);
    const float bx_part_doubled = 4.0f * (f5 * bx_part_cosine);
    /*@ admit -2.002f <= bx_part_doubled <= 2.002f; */
    const float bx_part_full = bx_part_doubled * (1.0f - (0.125f * (bx_part_sine * bx_part_sine)));
    /*@ admit -1.001f <= bx_part_full <= 1.001f; */
    const float heading_cosine_scaled_2 = 0.08168141f * heading_cosine;
    const float heading_sine_scaled_4 = 0.0858702f * heading_sine;
    const float limited_by = hall_position_three_limit(prediction_phase_y + heading_cosine_scaled_2 -
        heading_sine_scaled_4, 3.7601066f);
    const float by_part_cosine_argument = limited_by * limited_by;
    const float f5_2 = limited_by * f5_polynomial(by_part_cosine_argument);
    const float by_part_sine = 4.0f * f5_2;
    const float by_part_cosine = bx_part_cosine_polynomial(by_part_cosine_argument);
    const float by_part_doubled = 4.0f * (f5_2 * by_part_cosine);
    /*@ admit -2.002f <= by_part_doubled <= 2.002f; */
    const float by_part_full = by_part_doubled * (1.0f - (0.125f * (by_part_sine * by_part_sine)));
    /*@ admit -1.001f <= by_part_full <= 1.001f; */
    const float heading_cosine_scaled_3 = 1.6671385f * heading_cosine;
    const float heading_sine_scaled_5 = 1.6650441f * heading_sine;
    const float limited_cx = hall_position_three_limit(prediction_phase_x + heading_cosine_scaled_3 +
        heading_sine_scaled_5, 5.9978023f);
    const float cx_part_cosine_argument = limited_cx * limited_cx;
    const float f7 = limited_cx * f7_polynomial(cx_part_cosine_argument);
    const float cx_part_sine = 8.0f * f7;
    const float cx_part_cosine = cx_part_cosine_polynomial(cx_part_cosine_argument);
    const float f7_times_cx_part_cosine = f7 * cx_part_cosine;
    const float cx_part_doubled = 8.0f *
        (f7_times_cx_part_cosine * (1.0f - (0.03125f * (cx_part_sine * cx_part_sine))));
    /*@ admit -2.002f <= cx_part_doubled <= 2.002f; */
    const float sines_2_cx = 8.0f * f7_times_cx_part_cosine;
    const float cx_part_full = cx_part_doubled * (1.0f - (0.125f * (sines_2_cx * sines_2_cx)));
    /*@ admit -1.001f <= cx_part_full <= 1.001f; */
    const float heading_cosine_scaled_4 = 1.6650441f * heading_cosine;
    const float heading_sine_scaled_6 = 1.6671385f * heading_sine;
    const float limited_cy = hall_position_three_limit(prediction_phase_y - heading_cosine_scaled_4 +
        heading_sine_scaled_6, 5.9978023f);
    const float cy_part_cosine_argument = limited_cy * limited_cy;
    const float f7_2 = limited_cy * f7_polynomial(cy_part_cosine_argument);
    const float cy_part_sine = 8.0f * f7_2;
    const float cy_part_cosine = cx_part_cosine_polynomial(cy_part_cosine_argument);
    const float f7_2_times_cy_part_cosine = f7_2 * cy_part_cosine;
    const float cy_part_doubled = 8.0f *
        (f7_2_times_cy_part_cosine * (1.0f - (0.03125f * (cy_part_sine * cy_part_sine))));
    /*@ admit -2.002f <= cy_part_doubled <= 2.002f; */
    const float sines_2_cy = 8.0f * f7_2_times_cy_part_cosine;
    const float cy_part_full = cy_part_doubled * (1.0f - (0.125f * (sines_2_cy * sines_2_cy)));
    /*@ admit -1.001f <= cy_part_full <= 1.001f; */
    const uint32_t estimator_excluded_sensor = state->estimator_excluded_sensor;
    const bool excluded_1 = fault_V_ax || fault_V_ay || (estimator_excluded_sensor == 1u);
    const bool excluded_2 = fault_V_bx || fault_V_by || (estimator_excluded_sensor == 2u);
    const bool excluded_3 = fault_V_cx || fault_V_cy || (estimator_excluded_sensor == 3u);
    const float freedom = (excluded_1 || excluded_2 || excluded_3) ? 1.0f : 3.0f;
    const float start_cosine_ax = 1.0f - (0.5f * (ax_part_doubled * ax_part_doubled));
    const float used_1 = 1.0f - (excluded_1 ? 1.0f : 0.0f);
    const float converged_part = used_1 * estimator_field_1;
    const float ax_part_full_squared = ax_part_full * ax_part_full;
    const float converged_part_2 = used_1 * estimator_field_3;
    const float converged_part_2_scaled = 3.0f * converged_part_2;
    const float converged_part_3 = used_1 * estimator_field_5;
    const float converged_part_4 = ax_part_full_squared * converged_part_3;
    const float rows_1_1_converged = start_cosine_ax * (converged_part +
        (ax_part_full_squared * (converged_part_2_scaled + (5.0f * converged_part_4))));
    const float ay_part_full_squared = ay_part_full * ay_part_full;
    const float converged_part_5 = ay_part_full_squared * converged_part_3;
    const float converged_part_6 = ay_part_full * (converged_part +
        (ay_part_full_squared * (converged_part_2 + converged_part_5)));
    const float rows_1_3_converged = (rows_1_1_converged * (heading_sine_scaled_2 - heading_cosine_scaled)) +
        converged_part_6;
    const float measured_1 = used_1 * V_ax_held;
    const float measured_2 = used_1 * V_ay_held;
    const float converged_part_7 = ax_part_full * (converged_part +
        (ax_part_full_squared * (converged_part_2 + converged_part_4)));
    const float residuals_1_converged = (heading_cosine * measured_1) - (heading_sine * measured_2) - converged_part_7;
    const float start_cosine_ay = 1.0f - (0.5f * (ay_part_doubled * ay_part_doubled));
    const float rows_2_2_converged = start_cosine_ay * (converged_part +
        (ay_part_full_squared * (converged_part_2_scaled + (5.0f * converged_part_5))));
    const float converged_part_8 = converged_part_7 -
        (rows_2_2_converged * ((-1.5812683f * heading_cosine) - heading_sine_scaled));
    const float residuals_2_converged = (heading_cosine * measured_2) + (heading_sine * measured_1) - converged_part_6;
    const float start_cosine_bx = 1.0f - (0.5f * (bx_part_doubled * bx_part_doubled));
    const float used_2 = 1.0f - (excluded_2 ? 1.0f : 0.0f);
    const float converged_part_9 = used_2 * estimator_field_1;
    const float bx_part_full_squared = bx_part_full * bx_part_full;
    const float converged_part_10 = used_2 * estimator_field_3;
    const float converged_part_10_scaled = 3.0f * converged_part_10;
    const float converged_part_11 = used_2 * estimator_field_5;
    const float converged_part_12 = bx_part_full_squared * converged_part_11;
    const float rows_3_1_converged = start_cosine_bx * (converged_part_9 +
        (bx_part_full_squared * (converged_part_10_scaled + (5.0f * converged_part_12))));
    const float by_part_full_squared = by_part_full * by_part_full;
    const float converged_part_13 = by_part_full_squared * converged_part_11;
    const float converged_part_14 = by_part_full * (converged_part_9 +
        (by_part_full_squared * (converged_part_10 + converged_part_13)));
    const float rows_3_3_converged = (rows_3_1_converged * (heading_sine_scaled_4 - heading_cosine_scaled_2)) +
        converged_part_14;
    const float measured_3 = used_2 * V_bx_held;
    const float measured_4 = used_2 * V_by_held;
    const float converged_part_15 = bx_part_full * (converged_part_9 +
        (bx_part_full_squared * (converged_part_10 + converged_part_12)));
    const float residuals_3_converged = (heading_cosine * measured_3) - (heading_sine * measured_4) - converged_part_15;
    const float start_cosine_by = 1.0f - (0.5f * (by_part_doubled * by_part_doubled));
    const float rows_4_2_converged = start_cosine_by * (converged_part_9 +
        (by_part_full_squared * (converged_part_10_scaled + (5.0f * converged_part_13))));
    const float converged_part_16 = converged_part_15 -
        (rows_4_2_converged * ((-0.0858702f * heading_cosine) - heading_sine_scaled_3));
    const float residuals_4_converged = (heading_cosine * measured_4) + (heading_sine * measured_3) - converged_part_14;
    const float start_cosine_cx = 1.0f - (0.5f * (cx_part_doubled * cx_part_doubled));
    const float used_3 = 1.0f - (excluded_3 ? 1.0f : 0.0f);
    const float converged_part_17 = used_3 * estimator_field_1;
    const float cx_part_full_squared = cx_part_full * cx_part_full;
    const float converged_part_18 = used_3 * estimator_field_3;
    const float converged_part_18_scaled = 3.0f * converged_part_18;
    const float converged_part_19 = used_3 * estimator_field_5;
    const float converged_part_20 = cx_part_full_squared * converged_part_19;
    const float rows_5_1_converged = start_cosine_cx * (converged_part_17 +
        (cx_part_full_squared * (converged_part_18_scaled + (5.0f * converged_part_20))));
    const float cy_part_full_squared = cy_part_full * cy_part_full;
    const float converged_part_21 = cy_part_full_squared * converged_part_19;
    const float converged_part_22 = cy_part_full * (converged_part_17 +
        (cy_part_full_squared * (converged_part_18 + converged_part_21)));
    const float rows_5_3_converged = (rows_5_1_converged * (heading_cosine_scaled_4 - heading_sine_scaled_6)) +
        converged_part_22;
    const float measured_5 = used_3 * V_cx_held;
    const float measured_6 = used_3 * V_cy_held;
    const float converged_part_23 = cx_part_full * (converged_part_17 +
        (cx_part_full_squared * (converged_part_18 + converged_part_20)));
    const float residuals_5_converged = (heading_cosine * measured_5) - (heading_sine * measured_6) - converged_part_23;
    const float start_cosine_cy = 1.0f - (0.5f * (cy_part_doubled * cy_part_doubled));
    const float rows_6_2_converged = start_cosine_cy * (converged_part_17 +
        (cy_part_full_squared * (converged_part_18_scaled + (5.0f * converged_part_21))));
    const float converged_part_24 = converged_part_23 -
        (rows_6_2_converged * (heading_cosine_scaled_3 + heading_sine_scaled_5));
    const float residuals_6_converged = (heading_cosine * measured_6) + (heading_sine * measured_5) - converged_part_22;
    const float left_3_1_converged = (rows_1_3_converged * rows_1_1_converged) +
        (rows_3_3_converged * rows_3_1_converged) + (rows_5_3_converged * rows_5_1_converged);
    const float converged_part_25 = 1.0f / ((rows_1_1_converged * rows_1_1_converged) +
        (rows_3_1_converged * rows_3_1_converged) + (rows_5_1_converged * rows_5_1_converged) + 0.00992376f);
    const float row_1_converged = hall_position_three_limit(left_3_1_converged * converged_part_25, 4693.3496f);
    const float gradient_1_converged = (rows_1_1_converged * residuals_1_converged) +
        (rows_3_1_converged * residuals_3_converged) + (rows_5_1_converged * residuals_5_converged);
    const float converged_part_26 = (converged_part_8 * rows_2_2_converged) + (converged_part_16 * rows_4_2_converged) +
        (converged_part_24 * rows_6_2_converged);
    const float converged_part_27 = 1.0f / ((rows_2_2_converged * rows_2_2_converged) +
        (rows_4_2_converged * rows_4_2_converged) + (rows_6_2_converged * rows_6_2_converged) + 0.00992376f);
    const float row_2_converged = hall_position_three_limit(-(converged_part_26 * converged_part_27), 4693.3496f);
    const float gradient_2_converged = (rows_2_2_converged * residuals_2_converged) +
        (rows_4_2_converged * residuals_4_converged) + (rows_6_2_converged * residuals_6_converged);
    const float converged_part_28 = hall_position_three_max((rows_1_3_converged * rows_1_3_converged) +
        (converged_part_8 * converged_part_8) + (rows_3_3_converged * rows_3_3_converged) + (converged_part_16 *
        converged_part_16) + (rows_5_3_converged * rows_5_3_converged) + (converged_part_24 * converged_part_24) +
        0.87438375f - (row_1_converged * left_3_1_converged) + (row_2_converged * converged_part_26), 0.87438375f);
    const float then_3_converged = hall_position_three_limit(((rows_1_3_converged * residuals_1_converged) -
        (converged_part_8 * residuals_2_converged) + (rows_3_3_converged * residuals_3_converged) -
        (converged_part_16 * residuals_4_converged) + (rows_5_3_converged * residuals_5_converged) -
        (converged_part_24 * residuals_6_converged) - (row_1_converged * gradient_1_converged) -
        (row_2_converged * gradient_2_converged)) / converged_part_28, 0.14022085f);
    const float then_3_converged_squared = then_3_converged * then_3_converged;
    const float sine_converged = then_3_converged * f9_polynomial(then_3_converged_squared);
    const float half_converged = then_3_converged * f10_polynomial(then_3_converged_squared);
    const float fall_converged = sine_converged * ((half_converged * heading_cosine) + heading_sine);
    const float turns_3_cosine_converged = heading_cosine - fall_converged;
    const float chords_3_sine_converged = sine_converged * (heading_cosine - (half_converged * heading_sine));
    const float turns_3_sine_converged = heading_sine + chords_3_sine_converged;
    const float then_1_converged = hall_position_three_limit((gradient_1_converged * converged_part_25) -
        (row_1_converged * then_3_converged), 0.5f);
    const float limited_3_cosine_converged = hall_position_three_limit(-fall_converged, 0.14022085f);
    const float limited_3_sine_converged = hall_position_three_limit(chords_3_sine_converged, 0.14022085f);
    const float by_ax_converged = then_1_converged - (1.5812683f * limited_3_cosine_converged) -
        (1.5833627f * limited_3_sine_converged);
    const float f11_argument = by_ax_converged * by_ax_converged;
    const float by_cosine_ax_converged = f11_polynomial(f11_argument);
    const float by_sine_ax_converged = by_ax_converged * f12_polynomial(f11_argument);
    const float phasors_1_sine_converged = (ax_part_full * by_cosine_ax_converged) +
        (start_cosine_ax * by_sine_ax_converged);
    const float converged_part_29 = phasors_1_sine_converged * phasors_1_sine_converged;
    const float converged_part_30 = converged_part_29 * converged_part_3;
    const float converged_part_31 = phasors_1_sine_converged * (converged_part +
        (converged_part_29 * (converged_part_2 + converged_part_30)));
    const float residuals_1_converged_2 = (turns_3_cosine_converged * measured_1) -
        (turns_3_sine_converged * measured_2) - converged_part_31;
    const float then_2_converged = hall_position_three_limit((gradient_2_converged * converged_part_27) -
        (row_2_converged * then_3_converged), 0.5f);
    const float by_ay_converged = then_2_converged + (1.5833627f * limited_3_cosine_converged) -
        (1.5812683f * limited_3_sine_converged);
    const float f11_argument_2 = by_ay_converged * by_ay_converged;
    const float by_cosine_ay_converged = f11_polynomial(f11_argument_2);
    const float by_sine_ay_converged = by_ay_converged * f12_polynomial(f11_argument_2);
    const float phasors_2_sine_converged = (ay_part_full * by_cosine_ay_converged) +
        (start_cosine_ay * by_sine_ay_converged);
    const float converged_part_32 = phasors_2_sine_converged * phasors_2_sine_converged;
    const float converged_part_33 = converged_part_32 * converged_part_3;
    const float converged_part_34 = phasors_2_sine_converged * (converged_part +
        (converged_part_32 * (converged_part_2 + converged_part_33)));
    const float residuals_2_converged_2 = (turns_3_cosine_converged * measured_2) +
        (turns_3_sine_converged * measured_1) - converged_part_34;
    const float by_bx_converged = then_1_converged - (0.0858702f * limited_3_cosine_converged) -
        (0.08168141f * limited_3_sine_converged);
    const float f13_argument = by_bx_converged * by_bx_converged;
    const float by_cosine_bx_converged = f13_polynomial(f13_argument);
    const float by_sine_bx_converged = by_bx_converged * f14_polynomial(f13_argument);
    const float phasors_3_sine_converged = (bx_part_full * by_cosine_bx_converged) +
        (start_cosine_bx * by_sine_bx_converged);
    const float converged_part_35 = phasors_3_sine_converged * phasors_3_sine_converged;
    const float converged_part_36 = converged_part_35 * converged_part_11;
    const float converged_part_37 = phasors_3_sine_converged * (converged_part_9 +
        (converged_part_35 * (converged_part_10 + converged_part_36)));
    const float residuals_3_converged_2 = (turns_3_cosine_converged * measured_3) -
        (turns_3_sine_converged * measured_4) - converged_part_37;
    const float by_converged = then_2_converged + (0.08168141f * limited_3_cosine_converged) -
        (0.0858702f * limited_3_sine_converged);
    const float f13_argument_2 = by_converged * by_converged;
    const float by_cosine_converged = f13_polynomial(f13_argument_2);
    const float by_sine_converged = by_converged * f14_polynomial(f13_argument_2);
    const float phasors_4_sine_converged = (by_part_full * by_cosine_converged) + (start_cosine_by * by_sine_converged);
    const float converged_part_38 = phasors_4_sine_converged * phasors_4_sine_converged;
    const float converged_part_39 = converged_part_38 * converged_part_11;
    const float converged_part_40 = phasors_4_sine_converged * (converged_part_9 +
        (converged_part_38 * (converged_part_10 + converged_part_39)));
    const float residuals_4_converged_2 = (turns_3_cosine_converged * measured_4) +
        (turns_3_sine_converged * measured_3) - converged_part_40;
    const float by_cx_converged = then_1_converged + (1.6671385f * limited_3_cosine_converged) +
        (1.6650441f * limited_3_sine_converged);
    const float f15_argument = by_cx_converged * by_cx_converged;
    const float by_cosine_cx_converged = f15_polynomial(f15_argument);
    const float by_sine_cx_converged = by_cx_converged * f16_polynomial(f15_argument);
    const float phasors_5_sine_converged = (cx_part_full * by_cosine_cx_converged) +
        (start_cosine_cx * by_sine_cx_converged);
    const float converged_part_41 = phasors_5_sine_converged * phasors_5_sine_converged;
    const float converged_part_42 = converged_part_41 * converged_part_19;
    const float converged_part_43 = phasors_5_sine_converged * (converged_part_17 +
        (converged_part_41 * (converged_part_18 + converged_part_42)));
    const float residuals_5_converged_2 = (turns_3_cosine_converged * measured_5) -
        (turns_3_sine_converged * measured_6) - converged_part_43;
    const float by_cy_converged = then_2_converged - (1.6650441f * limited_3_cosine_converged) +
        (1.6671385f * limited_3_sine_converged);
    const float f15_argument_2 = by_cy_converged * by_cy_converged;
    const float by_cosine_cy_converged = f15_polynomial(f15_argument_2);
    const float by_sine_cy_converged = by_cy_converged * f16_polynomial(f15_argument_2);
    const float phasors_6_sine_converged = (cy_part_full * by_cosine_cy_converged) +
        (start_cosine_cy * by_sine_cy_converged);
    const float converged_part_44 = phasors_6_sine_converged * phasors_6_sine_converged;
    const float converged_part_45 = converged_part_44 * converged_part_19;
    const float converged_part_46 = phasors_6_sine_converged * (converged_part_17 +
        (converged_part_44 * (converged_part_18 + converged_part_45)));
    const float residuals_6_converged_2 = (turns_3_cosine_converged * measured_6) +
        (turns_3_sine_converged * measured_5) - converged_part_46;
    const float cost_converged = (residuals_1_converged_2 * residuals_1_converged_2) +
        (residuals_2_converged_2 * residuals_2_converged_2) + (residuals_3_converged_2 * residuals_3_converged_2) +
        (residuals_4_converged_2 * residuals_4_converged_2) + (residuals_5_converged_2 * residuals_5_converged_2) +
        (residuals_6_converged_2 * residuals_6_converged_2) + ((0.00992376f * (then_1_converged * then_1_converged)) +
        (0.00992376f * (then_2_converged * then_2_converged)) + (0.87438375f * then_3_converged_squared));
    const float squares_1 = (residuals_1_converged * residuals_1_converged) +
        (residuals_2_converged * residuals_2_converged);
    const float terms_3_converged = residuals_3_converged * residuals_3_converged;
    const float terms_4_converged = residuals_4_converged * residuals_4_converged;
    const float terms_5_converged = residuals_5_converged * residuals_5_converged;
    const float terms_6_converged = residuals_6_converged * residuals_6_converged;
    const float squares_converged = squares_1 + terms_3_converged + terms_4_converged + terms_5_converged +
        terms_6_converged;
    const bool better_converged = cost_converged <= ((1.000002f * squares_converged) + 1e-08f);
    const float rows_1_1_converged_2 = ((start_cosine_ax * by_cosine_ax_converged) -
        (ax_part_full * by_sine_ax_converged)) * (converged_part +
        (converged_part_29 * (converged_part_2_scaled + (5.0f * converged_part_30))));
    const float rows_1_3_converged_2 = (rows_1_1_converged_2 * ((1.5812683f * turns_3_sine_converged) -
        (1.5833627f * turns_3_cosine_converged))) + converged_part_34;
    const float rows_2_2_converged_2 = ((start_cosine_ay * by_cosine_ay_converged) -
        (ay_part_full * by_sine_ay_converged)) * (converged_part +
        (converged_part_32 * (converged_part_2_scaled + (5.0f * converged_part_33))));
    const float converged_part_47 = converged_part_31 -
        (rows_2_2_converged_2 * ((-1.5812683f * turns_3_cosine_converged) - (1.5833627f * turns_3_sine_converged)));
    const float rows_3_1_converged_2 = ((start_cosine_bx * by_cosine_bx_converged) -
        (bx_part_full * by_sine_bx_converged)) * (converged_part_9 +
        (converged_part_35 * (converged_part_10_scaled + (5.0f * converged_part_36))));
    const float rows_3_3_converged_2 = (rows_3_1_converged_2 * ((0.0858702f * turns_3_sine_converged) -
        (0.08168141f * turns_3_cosine_converged))) + converged_part_40;
    const float rows_4_2_converged_2 = ((start_cosine_by * by_cosine_converged) - (by_part_full * by_sine_converged)) *
        (converged_part_9 + (converged_part_38 * (converged_part_10_scaled + (5.0f * converged_part_39))));
    const float converged_part_48 = converged_part_37 -
        (rows_4_2_converged_2 * ((-0.0858702f * turns_3_cosine_converged) - (0.08168141f * turns_3_sine_converged)));
    const float rows_5_1_converged_2 = ((start_cosine_cx * by_cosine_cx_converged) -
        (cx_part_full * by_sine_cx_converged)) * (converged_part_17 +
        (converged_part_41 * (converged_part_18_scaled + (5.0f * converged_part_42))));
    const float rows_5_3_converged_2 = (rows_5_1_converged_2 * ((1.6650441f * turns_3_cosine_converged) -
        (1.6671385f * turns_3_sine_converged))) + converged_part_46;
    const float rows_6_2_converged_2 = ((start_cosine_cy * by_cosine_cy_converged) -
        (cy_part_full * by_sine_cy_converged)) * (converged_part_17 +
        (converged_part_44 * (converged_part_18_scaled + (5.0f * converged_part_45))));
    const float converged_part_49 = converged_part_43 -
        (rows_6_2_converged_2 * ((1.6671385f * turns_3_cosine_converged) + (1.6650441f * turns_3_sine_converged)));
    const float left_3_1_converged_2 = (rows_1_3_converged_2 * rows_1_1_converged_2) +
        (rows_3_3_converged_2 * rows_3_1_converged_2) + (rows_5_3_converged_2 * rows_5_1_converged_2);
    const float converged_part_50 = 1.0f / ((rows_1_1_converged_2 * rows_1_1_converged_2) +
        (rows_3_1_converged_2 * rows_3_1_converged_2) + (rows_5_1_converged_2 * rows_5_1_converged_2) + 0.00992376f);
    const float row_1_converged_2 = hall_position_three_limit(left_3_1_converged_2 * converged_part_50, 4693.3496f);
    const float gradient_1_converged_2 = (rows_1_1_converged_2 * residuals_1_converged_2) + (rows_3_1_converged_2 *
        residuals_3_converged_2) + (rows_5_1_converged_2 * residuals_5_converged_2) - (0.00992376f * then_1_converged);
    const float converged_part_51 = (converged_part_47 * rows_2_2_converged_2) +
        (converged_part_48 * rows_4_2_converged_2) + (converged_part_49 * rows_6_2_converged_2);
    const float converged_part_52 = 1.0f / ((rows_2_2_converged_2 * rows_2_2_converged_2) +
        (rows_4_2_converged_2 * rows_4_2_converged_2) + (rows_6_2_converged_2 * rows_6_2_converged_2) + 0.00992376f);
    const float row_2_converged_2 = hall_position_three_limit(-(converged_part_51 * converged_part_52), 4693.3496f);
    const float gradient_2_converged_2 = (rows_2_2_converged_2 * residuals_2_converged_2) + (rows_4_2_converged_2 *
        residuals_4_converged_2) + (rows_6_2_converged_2 * residuals_6_converged_2) - (0.00992376f * then_2_converged);
    const float forward_3_converged = (rows_1_3_converged_2 * residuals_1_converged_2) -
        (converged_part_47 * residuals_2_converged_2) + (rows_3_3_converged_2 * residuals_3_converged_2) -
        (converged_part_48 * residuals_4_converged_2) + (rows_5_3_converged_2 * residuals_5_converged_2) -
        (converged_part_49 * residuals_6_converged_2) - (0.87438375f * then_3_converged) -
        (row_1_converged_2 * gradient_1_converged_2) - (row_2_converged_2 * gradient_2_converged_2);
    const float converged_part_53 = hall_position_three_max((rows_1_3_converged_2 * rows_1_3_converged_2) +
        (converged_part_47 * converged_part_47) + (rows_3_3_converged_2 * rows_3_3_converged_2) +
        (converged_part_48 * converged_part_48) + (rows_5_3_converged_2 * rows_5_3_converged_2) +
        (converged_part_49 * converged_part_49) + 0.87438375f - (row_1_converged_2 * left_3_1_converged_2) +
        (row_2_converged_2 * converged_part_51), 0.87438375f);
    float other_3_converged = then_3_converged;
    float other_1_converged = then_1_converged;
    float other_2_converged = then_2_converged;
    float converged_part_54 = cost_converged;
    if (!better_converged) {
        other_3_converged = 0.0f;
        other_1_converged = 0.0f;
        other_2_converged = 0.0f;
        converged_part_54 = squares_converged;
    }
    const float then_3_converged_2 = hall_position_three_limit((better_converged) ? (then_3_converged +
        (forward_3_converged / converged_part_53)) : (0.5f * (then_3_converged + other_3_converged)), 0.14022085f);
    const float then_3_converged_2_squared = then_3_converged_2 * then_3_converged_2;
    const float sine_converged_2 = then_3_converged_2 * f9_polynomial(then_3_converged_2_squared);
    const float half_converged_2 = then_3_converged_2 * f10_polynomial(then_3_converged_2_squared);
    const float fall_converged_2 = sine_converged_2 * ((half_converged_2 * heading_cosine) + heading_sine);
    const float turns_3_cosine_converged_2 = heading_cosine - fall_converged_2;
    const float chords_3_sine_converged_2 = sine_converged_2 * (heading_cosine - (half_converged_2 * heading_sine));
    const float turns_3_sine_converged_2 = heading_sine + chords_3_sine_converged_2;
    const float moves_3_converged = then_3_converged_2 - then_3_converged;
    const float then_1_converged_2 = hall_position_three_limit((better_converged) ?
        (then_1_converged + ((gradient_1_converged_2 * converged_part_50) - (row_1_converged_2 * moves_3_converged))) :
        (0.5f * (then_1_converged + other_1_converged)), 0.5f);
    const float limited_3_cosine_converged_2 = hall_position_three_limit(-fall_converged_2, 0.14022085f);
    const float limited_3_sine_converged_2 = hall_position_three_limit(chords_3_sine_converged_2, 0.14022085f);
    const float by_ax_converged_2 = hall_position_three_limit(then_1_converged_2 -
        (1.5812683f * limited_3_cosine_converged_2) - (1.5833627f * limited_3_sine_converged_2), 0.9437473f);
    const float f11_argument_3 = by_ax_converged_2 * by_ax_converged_2;
    const float by_cosine_ax_converged_2 = f11_polynomial(f11_argument_3);
    const float by_sine_ax_converged_2 = by_ax_converged_2 * f12_polynomial(f11_argument_3);
    const float phasors_1_sine_converged_2 = (ax_part_full * by_cosine_ax_converged_2) +
        (start_cosine_ax * by_sine_ax_converged_2);
    const float converged_part_55 = phasors_1_sine_converged_2 * phasors_1_sine_converged_2;
    const float converged_part_56 = converged_part_55 * converged_part_3;
    const float converged_part_57 = phasors_1_sine_converged_2 * (converged_part +
        (converged_part_55 * (converged_part_2 + converged_part_56)));
    const float residuals_1_converged_3 = (turns_3_cosine_converged_2 * measured_1) -
        (turns_3_sine_converged_2 * measured_2) - converged_part_57;
    const float then_2_converged_2 = hall_position_three_limit((better_converged) ?
        (then_2_converged + ((gradient_2_converged_2 * converged_part_52) - (row_2_converged_2 * moves_3_converged))) :
        (0.5f * (then_2_converged + other_2_converged)), 0.5f);
    const float by_ay_converged_2 = then_2_converged_2 + (1.5833627f * limited_3_cosine_converged_2) -
        (1.5812683f * limited_3_sine_converged_2);
    const float f11_argument_4 = by_ay_converged_2 * by_ay_converged_2;
    const float by_cosine_ay_converged_2 = f11_polynomial(f11_argument_4);
    const float by_sine_ay_converged_2 = by_ay_converged_2 * f12_polynomial(f11_argument_4);
    const float phasors_2_sine_converged_2 = (ay_part_full * by_cosine_ay_converged_2) +
        (start_cosine_ay * by_sine_ay_converged_2);
    const float converged_part_58 = phasors_2_sine_converged_2 * phasors_2_sine_converged_2;
    const float converged_part_59 = converged_part_58 * converged_part_3;
    const float converged_part_60 = phasors_2_sine_converged_2 * (converged_part +
        (converged_part_58 * (converged_part_2 + converged_part_59)));
    const float residuals_2_converged_3 = (turns_3_cosine_converged_2 * measured_2) +
        (turns_3_sine_converged_2 * measured_1) - converged_part_60;
    const float by_bx_converged_2 = hall_position_three_limit(then_1_converged_2 -
        (0.0858702f * limited_3_cosine_converged_2) - (0.08168141f * limited_3_sine_converged_2), 0.52349424f);
    const float f13_argument_3 = by_bx_converged_2 * by_bx_converged_2;
    const float by_cosine_bx_converged_2 = f13_polynomial(f13_argument_3);
    const float by_sine_bx_converged_2 = by_bx_converged_2 * f14_polynomial(f13_argument_3);
    const float phasors_3_sine_converged_2 = (bx_part_full * by_cosine_bx_converged_2) +
        (start_cosine_bx * by_sine_bx_converged_2);
    const float converged_part_61 = phasors_3_sine_converged_2 * phasors_3_sine_converged_2;
    const float converged_part_62 = converged_part_61 * converged_part_11;
    const float converged_part_63 = phasors_3_sine_converged_2 * (converged_part_9 +
        (converged_part_61 * (converged_part_10 + converged_part_62)));
    const float residuals_3_converged_3 = (turns_3_cosine_converged_2 * measured_3) -
        (turns_3_sine_converged_2 * measured_4) - converged_part_63;
    const float by_converged_2 = hall_position_three_limit(then_2_converged_2 +
        (0.08168141f * limited_3_cosine_converged_2) - (0.0858702f * limited_3_sine_converged_2), 0.52349424f);
    const float f13_argument_4 = by_converged_2 * by_converged_2;
    const float by_cosine_converged_2 = f13_polynomial(f13_argument_4);
    const float by_sine_converged_2 = by_converged_2 * f14_polynomial(f13_argument_4);
    const float phasors_4_sine_converged_2 = (by_part_full * by_cosine_converged_2) +
        (start_cosine_by * by_sine_converged_2);
    const float converged_part_64 = phasors_4_sine_converged_2 * phasors_4_sine_converged_2;
    const float converged_part_65 = converged_part_64 * converged_part_11;
    const float converged_part_66 = phasors_4_sine_converged_2 * (converged_part_9 +
        (converged_part_64 * (converged_part_10 + converged_part_65)));
    const float residuals_4_converged_3 = (turns_3_cosine_converged_2 * measured_4) +
        (turns_3_sine_converged_2 * measured_3) - converged_part_66;
    const float by_cx_converged_2 = then_1_converged_2 + (1.6671385f * limited_3_cosine_converged_2) +
        (1.6650441f * limited_3_sine_converged_2);
    const float f17_argument = by_cx_converged_2 * by_cx_converged_2;
    const float by_cosine_cx_converged_2 = f17_polynomial(f17_argument);
    const float by_sine_cx_converged_2 = by_cx_converged_2 * f18_polynomial(f17_argument);
    const float phasors_5_sine_converged_2 = (cx_part_full * by_cosine_cx_converged_2) +
        (start_cosine_cx * by_sine_cx_converged_2);
    const float converged_part_67 = phasors_5_sine_converged_2 * phasors_5_sine_converged_2;
    const float converged_part_68 = converged_part_67 * converged_part_19;
    const float converged_part_69 = phasors_5_sine_converged_2 * (converged_part_17 +
        (converged_part_67 * (converged_part_18 + converged_part_68)));
    const float residuals_5_converged_3 = (turns_3_cosine_converged_2 * measured_5) -
        (turns_3_sine_converged_2 * measured_6) - converged_part_69;
    const float by_cy_converged_2 = then_2_converged_2 - (1.6650441f * limited_3_cosine_converged_2) +
        (1.6671385f * limited_3_sine_converged_2);
    const float f17_argument_2 = by_cy_converged_2 * by_cy_converged_2;
    const float by_cosine_cy_converged_2 = f17_polynomial(f17_argument_2);
    const float by_sine_cy_converged_2 = by_cy_converged_2 * f18_polynomial(f17_argument_2);
    const float phasors_6_sine_converged_2 = (cy_part_full * by_cosine_cy_converged_2) +
        (start_cosine_cy * by_sine_cy_converged_2);
    const float converged_part_70 = phasors_6_sine_converged_2 * phasors_6_sine_converged_2;
    const float converged_part_71 = converged_part_70 * converged_part_19;
    const float converged_part_72 = phasors_6_sine_converged_2 * (converged_part_17 +
        (converged_part_70 * (converged_part_18 + converged_part_71)));
    const float residuals_6_converged_3 = (turns_3_cosine_converged_2 * measured_6) +
        (turns_3_sine_converged_2 * measured_5) - converged_part_72;
    const float cost_converged_2 = (residuals_1_converged_3 * residuals_1_converged_3) + (residuals_2_converged_3 *
        residuals_2_converged_3) + (residuals_3_converged_3 * residuals_3_converged_3) + (residuals_4_converged_3 *
        residuals_4_converged_3) + (residuals_5_converged_3 * residuals_5_converged_3) + (residuals_6_converged_3 *
        residuals_6_converged_3) + ((0.00992376f * (then_1_converged_2 * then_1_converged_2)) +
        (0.00992376f * (then_2_converged_2 * then_2_converged_2)) + (0.87438375f * then_3_converged_2_squared));
    const bool better_converged_2 = cost_converged_2 <= ((1.000002f * converged_part_54) + 1e-08f);
    const float rows_1_1_converged_3 = ((start_cosine_ax * by_cosine_ax_converged_2) -
        (ax_part_full * by_sine_ax_converged_2)) * (converged_part +
        (converged_part_55 * (converged_part_2_scaled + (5.0f * converged_part_56))));
    const float rows_1_3_converged_3 = (rows_1_1_converged_3 * ((1.5812683f * turns_3_sine_converged_2) -
        (1.5833627f * turns_3_cosine_converged_2))) + converged_part_60;
    const float rows_2_2_converged_3 = ((start_cosine_ay * by_cosine_ay_converged_2) -
        (ay_part_full * by_sine_ay_converged_2)) * (converged_part +
        (converged_part_58 * (converged_part_2_scaled + (5.0f * converged_part_59))));
    const float converged_part_73 = converged_part_57 -
        (rows_2_2_converged_3 * ((-1.5812683f * turns_3_cosine_converged_2) - (1.5833627f * turns_3_sine_converged_2)));
    const float rows_3_1_converged_3 = ((start_cosine_bx * by_cosine_bx_converged_2) -
        (bx_part_full * by_sine_bx_converged_2)) * (converged_part_9 +
        (converged_part_61 * (converged_part_10_scaled + (5.0f * converged_part_62))));
    const float rows_3_3_converged_3 = (rows_3_1_converged_3 * ((0.0858702f * turns_3_sine_converged_2) -
        (0.08168141f * turns_3_cosine_converged_2))) + converged_part_66;
    const float rows_4_2_converged_3 = ((start_cosine_by * by_cosine_converged_2) -
        (by_part_full * by_sine_converged_2)) * (converged_part_9 +
        (converged_part_64 * (converged_part_10_scaled + (5.0f * converged_part_65))));
    const float converged_part_74 = converged_part_63 - (rows_4_2_converged_3 *
        ((-0.0858702f * turns_3_cosine_converged_2) - (0.08168141f * turns_3_sine_converged_2)));
    const float rows_5_1_converged_3 = ((start_cosine_cx * by_cosine_cx_converged_2) -
        (cx_part_full * by_sine_cx_converged_2)) * (converged_part_17 +
        (converged_part_67 * (converged_part_18_scaled + (5.0f * converged_part_68))));
    const float rows_5_3_converged_3 = (rows_5_1_converged_3 * ((1.6650441f * turns_3_cosine_converged_2) -
        (1.6671385f * turns_3_sine_converged_2))) + converged_part_72;
    const float rows_6_2_converged_3 = ((start_cosine_cy * by_cosine_cy_converged_2) -
        (cy_part_full * by_sine_cy_converged_2)) * (converged_part_17 +
        (converged_part_70 * (converged_part_18_scaled + (5.0f * converged_part_71))));
    const float converged_part_75 = converged_part_69 -
        (rows_6_2_converged_3 * ((1.6671385f * turns_3_cosine_converged_2) + (1.6650441f * turns_3_sine_converged_2)));
    const float left_3_1_converged_3 = (rows_1_3_converged_3 * rows_1_1_converged_3) +
        (rows_3_3_converged_3 * rows_3_1_converged_3) + (rows_5_3_converged_3 * rows_5_1_converged_3);
    const float converged_part_76 = 1.0f / ((rows_1_1_converged_3 * rows_1_1_converged_3) +
        (rows_3_1_converged_3 * rows_3_1_converged_3) + (rows_5_1_converged_3 * rows_5_1_converged_3) + 0.00992376f);
    const float row_1_converged_3 = hall_position_three_limit(left_3_1_converged_3 * converged_part_76, 4693.3496f);
    const float gradient_1_converged_3 = (rows_1_1_converged_3 * residuals_1_converged_3) +
        (rows_3_1_converged_3 * residuals_3_converged_3) + (rows_5_1_converged_3 * residuals_5_converged_3) -
        (0.00992376f * then_1_converged_2);
    const float converged_part_77 = (converged_part_73 * rows_2_2_converged_3) +
        (converged_part_74 * rows_4_2_converged_3) + (converged_part_75 * rows_6_2_converged_3);
    const float converged_part_78 = 1.0f / ((rows_2_2_converged_3 * rows_2_2_converged_3) +
        (rows_4_2_converged_3 * rows_4_2_converged_3) + (rows_6_2_converged_3 * rows_6_2_converged_3) + 0.00992376f);
    const float row_2_converged_3 = hall_position_three_limit(-(converged_part_77 * converged_part_78), 4693.3496f);
    const float gradient_2_converged_3 = (rows_2_2_converged_3 * residuals_2_converged_3) +
        (rows_4_2_converged_3 * residuals_4_converged_3) + (rows_6_2_converged_3 * residuals_6_converged_3) -
        (0.00992376f * then_2_converged_2);
    const float forward_3_converged_2 = (rows_1_3_converged_3 * residuals_1_converged_3) -
        (converged_part_73 * residuals_2_converged_3) + (rows_3_3_converged_3 * residuals_3_converged_3) -
        (converged_part_74 * residuals_4_converged_3) + (rows_5_3_converged_3 * residuals_5_converged_3) -
        (converged_part_75 * residuals_6_converged_3) - (0.87438375f * then_3_converged_2) -
        (row_1_converged_3 * gradient_1_converged_3) - (row_2_converged_3 * gradient_2_converged_3);
    const float converged_part_79 = hall_position_three_max((rows_1_3_converged_3 * rows_1_3_converged_3) +
        (converged_part_73 * converged_part_73) + (rows_3_3_converged_3 * rows_3_3_converged_3) +
        (converged_part_74 * converged_part_74) + (rows_5_3_converged_3 * rows_5_3_converged_3) +
        (converged_part_75 * converged_part_75) + 0.87438375f - (row_1_converged_3 * left_3_1_converged_3) +
        (row_2_converged_3 * converged_part_77), 0.87438375f);
    float other_3_converged_2 = then_3_converged_2;
    float other_1_converged_2 = then_1_converged_2;
    float other_2_converged_2 = then_2_converged_2;
    float converged_part_80 = cost_converged_2;
    if (!better_converged_2) {
        other_3_converged_2 = other_3_converged;
        other_1_converged_2 = other_1_converged;
        other_2_converged_2 = other_2_converged;
        converged_part_80 = converged_part_54;
    }
    const float then_3_converged_3 = hall_position_three_limit((better_converged_2) ?
        (then_3_converged_2 + (forward_3_converged_2 / converged_part_79)) :
        (0.5f * (then_3_converged_2 + other_3_converged_2)), 0.14022085f);
    const float then_3_converged_3_squared = then_3_converged_3 * then_3_converged_3;
    const float sine_converged_3 = then_3_converged_3 * f9_polynomial(then_3_converged_3_squared);
    const float half_converged_3 = then_3_converged_3 * f10_polynomial(then_3_converged_3_squared);
    const float fall_converged_3 = sine_converged_3 * ((half_converged_3 * heading_cosine) + heading_sine);
    const float turns_3_cosine_converged_3 = heading_cosine - fall_converged_3;
    const float chords_3_sine_converged_3 = sine_converged_3 * (heading_cosine - (half_converged_3 * heading_sine));
    const float turns_3_sine_converged_3 = heading_sine + chords_3_sine_converged_3;
    const float moves_3_converged_2 = then_3_converged_3 - then_3_converged_2;
    const float then_1_converged_3 = hall_position_three_limit((better_converged_2) ? (then_1_converged_2 +
        ((gradient_1_converged_3 * converged_part_76) - (row_1_converged_3 * moves_3_converged_2))) :
        (0.5f * (then_1_converged_2 + other_1_converged_2)), 0.5f);
    const float limited_3_cosine_converged_3 = hall_position_three_limit(-fall_converged_3, 0.14022085f);
    const float limited_3_sine_converged_3 = hall_position_three_limit(chords_3_sine_converged_3, 0.14022085f);
    const float by_ax_converged_3 = hall_position_three_limit(then_1_converged_3 -
        (1.5812683f * limited_3_cosine_converged_3) - (1.5833627f * limited_3_sine_converged_3), 0.9437473f);
    const float f11_argument_5 = by_ax_converged_3 * by_ax_converged_3;
    const float by_cosine_ax_converged_3 = f11_polynomial(f11_argument_5);
    const float by_sine_ax_converged_3 = by_ax_converged_3 * f12_polynomial(f11_argument_5);
    const float phasors_1_sine_converged_3 = (ax_part_full * by_cosine_ax_converged_3) +
        (start_cosine_ax * by_sine_ax_converged_3);
    const float converged_part_81 = phasors_1_sine_converged_3 * phasors_1_sine_converged_3;
    const float converged_part_82 = converged_part_81 * converged_part_3;
    const float converged_part_83 = phasors_1_sine_converged_3 * (converged_part +
        (converged_part_81 * (converged_part_2 + converged_part_82)));
    const float residuals_1_converged_4 = (turns_3_cosine_converged_3 * measured_1) -
        (turns_3_sine_converged_3 * measured_2) - converged_part_83;
    const float then_2_converged_3 = hall_position_three_limit((better_converged_2) ? (then_2_converged_2 +
        ((gradient_2_converged_3 * converged_part_78) - (row_2_converged_3 * moves_3_converged_2))) :
        (0.5f * (then_2_converged_2 + other_2_converged_2)), 0.5f);
    const float by_ay_converged_3 = then_2_converged_3 + (1.5833627f * limited_3_cosine_converged_3) -
        (1.5812683f * limited_3_sine_converged_3);
    const float f11_argument_6 = by_ay_converged_3 * by_ay_converged_3;
    const float by_cosine_ay_converged_3 = f11_polynomial(f11_argument_6);
    const float by_sine_ay_converged_3 = by_ay_converged_3 * f12_polynomial(f11_argument_6);
    const float phasors_2_sine_converged_3 = (ay_part_full * by_cosine_ay_converged_3) +
        (start_cosine_ay * by_sine_ay_converged_3);
    const float converged_part_84 = phasors_2_sine_converged_3 * phasors_2_sine_converged_3;
    const float converged_part_85 = converged_part_84 * converged_part_3;
    const float converged_part_86 = phasors_2_sine_converged_3 * (converged_part +
        (converged_part_84 * (converged_part_2 + converged_part_85)));
    const float residuals_2_converged_4 = (turns_3_cosine_converged_3 * measured_2) +
        (turns_3_sine_converged_3 * measured_1) - converged_part_86;
    const float by_bx_converged_3 = hall_position_three_limit(then_1_converged_3 -
        (0.0858702f * limited_3_cosine_converged_3) - (0.08168141f * limited_3_sine_converged_3), 0.52349424f);
    const float f13_argument_5 = by_bx_converged_3 * by_bx_converged_3;
    const float by_cosine_bx_converged_3 = f13_polynomial(f13_argument_5);
    const float by_sine_bx_converged_3 = by_bx_converged_3 * f14_polynomial(f13_argument_5);
    const float phasors_3_sine_converged_3 = (bx_part_full * by_cosine_bx_converged_3) +
        (start_cosine_bx * by_sine_bx_converged_3);
    const float converged_part_87 = phasors_3_sine_converged_3 * phasors_3_sine_converged_3;
    const float converged_part_88 = converged_part_87 * converged_part_11;
    const float converged_part_89 = phasors_3_sine_converged_3 * (converged_part_9 +
        (converged_part_87 * (converged_part_10 + converged_part_88)));
    const float residuals_3_converged_4 = (turns_3_cosine_converged_3 * measured_3) -
        (turns_3_sine_converged_3 * measured_4) - converged_part_89;
    const float by_converged_3 = hall_position_three_limit(then_2_converged_3 +
        (0.08168141f * limited_3_cosine_converged_3) - (0.0858702f * limited_3_sine_converged_3), 0.52349424f);
    const float f13_argument_6 = by_converged_3 * by_converged_3;
    const float by_cosine_converged_3 = f13_polynomial(f13_argument_6);
    const float by_sine_converged_3 = by_converged_3 * f14_polynomial(f13_argument_6);
    const float phasors_4_sine_converged_3 = (by_part_full * by_cosine_converged_3) +
        (start_cosine_by * by_sine_converged_3);
    const float converged_part_90 = phasors_4_sine_converged_3 * phasors_4_sine_converged_3;
    const float converged_part_91 = converged_part_90 * converged_part_11;
    const float converged_part_92 = phasors_4_sine_converged_3 * (converged_part_9 +
        (converged_part_90 * (converged_part_10 + converged_part_91)));
    const float residuals_4_converged_4 = (turns_3_cosine_converged_3 * measured_4) +
        (turns_3_sine_converged_3 * measured_3) - converged_part_92;
    const float by_cx_converged_3 = then_1_converged_3 + (1.6671385f * limited_3_cosine_converged_3) +
        (1.6650441f * limited_3_sine_converged_3);
    const float f17_argument_3 = by_cx_converged_3 * by_cx_converged_3;
    const float by_cosine_cx_converged_3 = f17_polynomial(f17_argument_3);
    const float by_sine_cx_converged_3 = by_cx_converged_3 * f18_polynomial(f17_argument_3);
    const float phasors_5_sine_converged_3 = (cx_part_full * by_cosine_cx_converged_3) +
        (start_cosine_cx * by_sine_cx_converged_3);
    const float converged_part_93 = phasors_5_sine_converged_3 * phasors_5_sine_converged_3;
    const float converged_part_94 = converged_part_93 * converged_part_19;
    const float converged_part_95 = phasors_5_sine_converged_3 * (converged_part_17 +
        (converged_part_93 * (converged_part_18 + converged_part_94)));
    const float residuals_5_converged_4 = (turns_3_cosine_converged_3 * measured_5) -
        (turns_3_sine_converged_3 * measured_6) - converged_part_95;
    const float by_cy_converged_3 = then_2_converged_3 - (1.6650441f * limited_3_cosine_converged_3) +
        (1.6671385f * limited_3_sine_converged_3);
    const float f17_argument_4 = by_cy_converged_3 * by_cy_converged_3;
    const float by_cosine_cy_converged_3 = f17_polynomial(f17_argument_4);
    const float by_sine_cy_converged_3 = by_cy_converged_3 * f18_polynomial(f17_argument_4);
    const float phasors_6_sine_converged_3 = (cy_part_full * by_cosine_cy_converged_3) +
        (start_cosine_cy * by_sine_cy_converged_3);
    const float converged_part_96 = phasors_6_sine_converged_3 * phasors_6_sine_converged_3;
    const float converged_part_97 = converged_part_96 * converged_part_19;
    const float converged_part_98 = phasors_6_sine_converged_3 * (converged_part_17 +
        (converged_part_96 * (converged_part_18 + converged_part_97)));
    const float residuals_6_converged_4 = (turns_3_cosine_converged_3 * measured_6) +
        (turns_3_sine_converged_3 * measured_5) - converged_part_98;
    const float cost_converged_3 = (residuals_1_converged_4 * residuals_1_converged_4) + (residuals_2_converged_4 *
        residuals_2_converged_4) + (residuals_3_converged_4 * residuals_3_converged_4) + (residuals_4_converged_4 *
        residuals_4_converged_4) + (residuals_5_converged_4 * residuals_5_converged_4) + (residuals_6_converged_4 *
        residuals_6_converged_4) + ((0.00992376f * (then_1_converged_3 * then_1_converged_3)) +
        (0.00992376f * (then_2_converged_3 * then_2_converged_3)) + (0.87438375f * then_3_converged_3_squared));
    const bool better_converged_3 = cost_converged_3 <= ((1.000002f * converged_part_80) + 1e-08f);
    const float rows_1_1_converged_4 = ((start_cosine_ax * by_cosine_ax_converged_3) -
        (ax_part_full * by_sine_ax_converged_3)) * (converged_part +
        (converged_part_81 * (converged_part_2_scaled + (5.0f * converged_part_82))));
    const float rows_1_3_converged_4 = (rows_1_1_converged_4 * ((1.5812683f * turns_3_sine_converged_3) -
        (1.5833627f * turns_3_cosine_converged_3))) + converged_part_86;
    const float rows_2_2_converged_4 = ((start_cosine_ay * by_cosine_ay_converged_3) -
        (ay_part_full * by_sine_ay_converged_3)) * (converged_part +
        (converged_part_84 * (converged_part_2_scaled + (5.0f * converged_part_85))));
    const float converged_part_99 = converged_part_83 -
        (rows_2_2_converged_4 * ((-1.5812683f * turns_3_cosine_converged_3) - (1.5833627f * turns_3_sine_converged_3)));
    const float rows_3_1_converged_4 = ((start_cosine_bx * by_cosine_bx_converged_3) -
        (bx_part_full * by_sine_bx_converged_3)) * (converged_part_9 +
        (converged_part_87 * (converged_part_10_scaled + (5.0f * converged_part_88))));
    const float rows_3_3_converged_4 = (rows_3_1_converged_4 * ((0.0858702f * turns_3_sine_converged_3) -
        (0.08168141f * turns_3_cosine_converged_3))) + converged_part_92;
    const float rows_4_2_converged_4 = ((start_cosine_by * by_cosine_converged_3) -
        (by_part_full * by_sine_converged_3)) * (converged_part_9 +
        (converged_part_90 * (converged_part_10_scaled + (5.0f * converged_part_91))));
    const float converged_part_100 = converged_part_89 - (rows_4_2_converged_4 *
        ((-0.0858702f * turns_3_cosine_converged_3) - (0.08168141f * turns_3_sine_converged_3)));
    const float rows_5_1_converged_4 = ((start_cosine_cx * by_cosine_cx_converged_3) -
        (cx_part_full * by_sine_cx_converged_3)) * (converged_part_17 +
        (converged_part_93 * (converged_part_18_scaled + (5.0f * converged_part_94))));
    const float rows_5_3_converged_4 = (rows_5_1_converged_4 * ((1.6650441f * turns_3_cosine_converged_3) -
        (1.6671385f * turns_3_sine_converged_3))) + converged_part_98;
    const float rows_6_2_converged_4 = ((start_cosine_cy * by_cosine_cy_converged_3) -
        (cy_part_full * by_sine_cy_converged_3)) * (converged_part_17 +
        (converged_part_96 * (converged_part_18_scaled + (5.0f * converged_part_97))));
    const float converged_part_101 = converged_part_95 -
        (rows_6_2_converged_4 * ((1.6671385f * turns_3_cosine_converged_3) + (1.6650441f * turns_3_sine_converged_3)));
    const float left_3_1_converged_4 = (rows_1_3_converged_4 * rows_1_1_converged_4) +
        (rows_3_3_converged_4 * rows_3_1_converged_4) + (rows_5_3_converged_4 * rows_5_1_converged_4);
    const float converged_part_102 = 1.0f / ((rows_1_1_converged_4 * rows_1_1_converged_4) +
        (rows_3_1_converged_4 * rows_3_1_converged_4) + (rows_5_1_converged_4 * rows_5_1_converged_4) + 0.00992376f);
    const float row_1_converged_4 = hall_position_three_limit(left_3_1_converged_4 * converged_part_102, 4693.3496f);
    const float gradient_1_converged_4 = (rows_1_1_converged_4 * residuals_1_converged_4) +
        (rows_3_1_converged_4 * residuals_3_converged_4) + (rows_5_1_converged_4 * residuals_5_converged_4) -
        (0.00992376f * then_1_converged_3);
    const float converged_part_103 = (converged_part_99 * rows_2_2_converged_4) +
        (converged_part_100 * rows_4_2_converged_4) + (converged_part_101 * rows_6_2_converged_4);
    const float converged_part_104 = 1.0f / ((rows_2_2_converged_4 * rows_2_2_converged_4) +
        (rows_4_2_converged_4 * rows_4_2_converged_4) + (rows_6_2_converged_4 * rows_6_2_converged_4) + 0.00992376f);
    const float row_2_converged_4 = hall_position_three_limit(-(converged_part_103 * converged_part_104), 4693.3496f);
    const float gradient_2_converged_4 = (rows_2_2_converged_4 * residuals_2_converged_4) +
        (rows_4_2_converged_4 * residuals_4_converged_4) + (rows_6_2_converged_4 * residuals_6_converged_4) -
        (0.00992376f * then_2_converged_3);
    const float forward_3_converged_3 = (rows_1_3_converged_4 * residuals_1_converged_4) -
        (converged_part_99 * residuals_2_converged_4) + (rows_3_3_converged_4 * residuals_3_converged_4) -
        (converged_part_100 * residuals_4_converged_4) + (rows_5_3_converged_4 * residuals_5_converged_4) -
        (converged_part_101 * residuals_6_converged_4) - (0.87438375f * then_3_converged_3) -
        (row_1_converged_4 * gradient_1_converged_4) - (row_2_converged_4 * gradient_2_converged_4);
    const float converged_part_105 = hall_position_three_max((rows_1_3_converged_4 * rows_1_3_converged_4) +
        (converged_part_99 * converged_part_99) + (rows_3_3_converged_4 * rows_3_3_converged_4) +
        (converged_part_100 * converged_part_100) + (rows_5_3_converged_4 * rows_5_3_converged_4) +
        (converged_part_101 * converged_part_101) + 0.87438375f - (row_1_converged_4 * left_3_1_converged_4) +
        (row_2_converged_4 * converged_part_103), 0.87438375f);
    float other_3_converged_3 = then_3_converged_3;
    float other_1_converged_3 = then_1_converged_3;
    float other_2_converged_3 = then_2_converged_3;
    float converged_part_106 = cost_converged_3;
    if (!better_converged_3) {
        other_3_converged_3 = other_3_converged_2;
        other_1_converged_3 = other_1_converged_2;
        other_2_converged_3 = other_2_converged_2;
        converged_part_106 = converged_part_80;
    }
    const float then_3_converged_4 = hall_position_three_limit((better_converged_3) ?
        (then_3_converged_3 + (forward_3_converged_3 / converged_part_105)) :
        (0.5f * (then_3_converged_3 + other_3_converged_3)), 0.14022085f);
    const float then_3_converged_4_squared = then_3_converged_4 * then_3_converged_4;
    const float sine_converged_4 = then_3_converged_4 * f9_polynomial(then_3_converged_4_squared);
    const float half_converged_4 = then_3_converged_4 * f10_polynomial(then_3_converged_4_squared);
    const float fall_converged_4 = sine_converged_4 * ((half_converged_4 * heading_cosine) + heading_sine);
    const float turns_3_cosine_converged_4 = heading_cosine - fall_converged_4;
    const float chords_3_sine_converged_4 = sine_converged_4 * (heading_cosine - (half_converged_4 * heading_sine));
    const float turns_3_sine_converged_4 = heading_sine + chords_3_sine_converged_4;
    const float moves_3_converged_3 = then_3_converged_4 - then_3_converged_3;
    const float then_1_converged_4 = hall_position_three_limit((better_converged_3) ? (then_1_converged_3 +
        ((gradient_1_converged_4 * converged_part_102) - (row_1_converged_4 * moves_3_converged_3))) :
        (0.5f * (then_1_converged_3 + other_1_converged_3)), 0.5f);
    const float limited_3_cosine_converged_4 = hall_position_three_limit(-fall_converged_4, 0.14022085f);
    const float limited_3_sine_converged_4 = hall_position_three_limit(chords_3_sine_converged_4, 0.14022085f);
    const float by_ax_converged_4 = hall_position_three_limit(then_1_converged_4 -
        (1.5812683f * limited_3_cosine_converged_4) - (1.5833627f * limited_3_sine_converged_4), 0.9437473f);
    const float f11_argument_7 = by_ax_converged_4 * by_ax_converged_4;
    const float by_cosine_ax_converged_4 = f11_polynomial(f11_argument_7);
    const float by_sine_ax_converged_4 = by_ax_converged_4 * f12_polynomial(f11_argument_7);
    const float phasors_1_sine_converged_4 = (ax_part_full * by_cosine_ax_converged_4) +
        (start_cosine_ax * by_sine_ax_converged_4);
    const float converged_part_107 = phasors_1_sine_converged_4 * phasors_1_sine_converged_4;
    const float converged_part_108 = converged_part_107 * converged_part_3;
    const float converged_part_109 = phasors_1_sine_converged_4 * (converged_part +
        (converged_part_107 * (converged_part_2 + converged_part_108)));
    const float residuals_1_converged_5 = (turns_3_cosine_converged_4 * measured_1) -
        (turns_3_sine_converged_4 * measured_2) - converged_part_109;
    const float then_2_converged_4 = hall_position_three_limit((better_converged_3) ? (then_2_converged_3 +
        ((gradient_2_converged_4 * converged_part_104) - (row_2_converged_4 * moves_3_converged_3))) :
        (0.5f * (then_2_converged_3 + other_2_converged_3)), 0.5f);
    const float by_ay_converged_4 = then_2_converged_4 + (1.5833627f * limited_3_cosine_converged_4) -
        (1.5812683f * limited_3_sine_converged_4);
    const float f11_argument_8 = by_ay_converged_4 * by_ay_converged_4;
    const float by_cosine_ay_converged_4 = f11_polynomial(f11_argument_8);
    const float by_sine_ay_converged_4 = by_ay_converged_4 * f12_polynomial(f11_argument_8);
    const float phasors_2_sine_converged_4 = (ay_part_full * by_cosine_ay_converged_4) +
        (start_cosine_ay * by_sine_ay_converged_4);
    const float converged_part_110 = phasors_2_sine_converged_4 * phasors_2_sine_converged_4;
    const float converged_part_111 = converged_part_110 * converged_part_3;
    const float converged_part_112 = phasors_2_sine_converged_4 * (converged_part +
        (converged_part_110 * (converged_part_2 + converged_part_111)));
    const float residuals_2_converged_5 = (turns_3_cosine_converged_4 * measured_2) +
        (turns_3_sine_converged_4 * measured_1) - converged_part_112;
    const float by_bx_converged_4 = hall_position_three_limit(then_1_converged_4 -
        (0.0858702f * limited_3_cosine_converged_4) - (0.08168141f * limited_3_sine_converged_4), 0.52349424f);
    const float f13_argument_7 = by_bx_converged_4 * by_bx_converged_4;
    const float by_cosine_bx_converged_4 = f13_polynomial(f13_argument_7);
    const float by_sine_bx_converged_4 = by_bx_converged_4 * f14_polynomial(f13_argument_7);
    const float phasors_3_sine_converged_4 = (bx_part_full * by_cosine_bx_converged_4) +
        (start_cosine_bx * by_sine_bx_converged_4);
    const float converged_part_113 = phasors_3_sine_converged_4 * phasors_3_sine_converged_4;
    const float converged_part_114 = converged_part_113 * converged_part_11;
    const float converged_part_115 = phasors_3_sine_converged_4 * (converged_part_9 +
        (converged_part_113 * (converged_part_10 + converged_part_114)));
    const float residuals_3_converged_5 = (turns_3_cosine_converged_4 * measured_3) -
        (turns_3_sine_converged_4 * measured_4) - converged_part_115;
    const float by_converged_4 = hall_position_three_limit(then_2_converged_4 +
        (0.08168141f * limited_3_cosine_converged_4) - (0.0858702f * limited_3_sine_converged_4), 0.52349424f);
    const float f13_argument_8 = by_converged_4 * by_converged_4;
    const float by_cosine_converged_4 = f13_polynomial(f13_argument_8);
    const float by_sine_converged_4 = by_converged_4 * f14_polynomial(f13_argument_8);
    const float phasors_4_sine_converged_4 = (by_part_full * by_cosine_converged_4) +
        (start_cosine_by * by_sine_converged_4);
    const float converged_part_116 = phasors_4_sine_converged_4 * phasors_4_sine_converged_4;
    const float converged_part_117 = converged_part_116 * converged_part_11;
    const float converged_part_118 = phasors_4_sine_converged_4 * (converged_part_9 +
        (converged_part_116 * (converged_part_10 + converged_part_117)));
    const float residuals_4_converged_5 = (turns_3_cosine_converged_4 * measured_4) +
        (turns_3_sine_converged_4 * measured_3) - converged_part_118;
    const float by_cx_converged_4 = then_1_converged_4 + (1.6671385f * limited_3_cosine_converged_4) +
        (1.6650441f * limited_3_sine_converged_4);
    const float f17_argument_5 = by_cx_converged_4 * by_cx_converged_4;
    const float by_cosine_cx_converged_4 = f17_polynomial(f17_argument_5);
    const float by_sine_cx_converged_4 = by_cx_converged_4 * f18_polynomial(f17_argument_5);
    const float phasors_5_sine_converged_4 = (cx_part_full * by_cosine_cx_converged_4) +
        (start_cosine_cx * by_sine_cx_converged_4);
    const float converged_part_119 = phasors_5_sine_converged_4 * phasors_5_sine_converged_4;
    const float converged_part_120 = converged_part_119 * converged_part_19;
    const float converged_part_121 = phasors_5_sine_converged_4 * (converged_part_17 +
        (converged_part_119 * (converged_part_18 + converged_part_120)));
    const float residuals_5_converged_5 = (turns_3_cosine_converged_4 * measured_5) -
        (turns_3_sine_converged_4 * measured_6) - converged_part_121;
    const float by_cy_converged_4 = then_2_converged_4 - (1.6650441f * limited_3_cosine_converged_4) +
        (1.6671385f * limited_3_sine_converged_4);
    const float f17_argument_6 = by_cy_converged_4 * by_cy_converged_4;
    const float by_cosine_cy_converged_4 = f17_polynomial(f17_argument_6);
    const float by_sine_cy_converged_4 = by_cy_converged_4 * f18_polynomial(f17_argument_6);
    const float phasors_6_sine_converged_4 = (cy_part_full * by_cosine_cy_converged_4) +
        (start_cosine_cy * by_sine_cy_converged_4);
    const float converged_part_122 = phasors_6_sine_converged_4 * phasors_6_sine_converged_4;
    const float converged_part_123 = converged_part_122 * converged_part_19;
    const float converged_part_124 = phasors_6_sine_converged_4 * (converged_part_17 +
        (converged_part_122 * (converged_part_18 + converged_part_123)));
    const float residuals_6_converged_5 = (turns_3_cosine_converged_4 * measured_6) +
        (turns_3_sine_converged_4 * measured_5) - converged_part_124;
    const float squares_converged_2 = (residuals_1_converged_5 * residuals_1_converged_5) +
        (residuals_2_converged_5 * residuals_2_converged_5) + (residuals_3_converged_5 * residuals_3_converged_5) +
        (residuals_4_converged_5 * residuals_4_converged_5) + (residuals_5_converged_5 * residuals_5_converged_5) +
        (residuals_6_converged_5 * residuals_6_converged_5);
    const uint32_t estimator_residual_faults = state->estimator_residual_faults;
    const float growing_gate = 0.030115018f + (0.030115018f * (float)estimator_residual_faults);
    const float then_1_converged_4_squared = then_1_converged_4 * then_1_converged_4;
    const float then_2_converged_4_squared = then_2_converged_4 * then_2_converged_4;
    const bool gate_exceeded = (growing_gate * growing_gate) <
        (then_1_converged_4_squared + then_2_converged_4_squared + (3.524405f * then_3_converged_4_squared));
    const bool better_converged_4 = (squares_converged_2 + ((0.00992376f * then_1_converged_4_squared) +
        (0.00992376f * then_2_converged_4_squared) + (0.87438375f * then_3_converged_4_squared))) <=
        ((1.000002f * converged_part_106) + 1e-08f);
    const float rows_1_1_converged_5 = ((start_cosine_ax * by_cosine_ax_converged_4) -
        (ax_part_full * by_sine_ax_converged_4)) * (converged_part +
        (converged_part_107 * (converged_part_2_scaled + (5.0f * converged_part_108))));
    const float rows_3_1_converged_5 = ((start_cosine_bx * by_cosine_bx_converged_4) -
        (bx_part_full * by_sine_bx_converged_4)) * (converged_part_9 +
        (converged_part_113 * (converged_part_10_scaled + (5.0f * converged_part_114))));
    const float rows_5_1_converged_5 = ((start_cosine_cx * by_cosine_cx_converged_4) -
        (cx_part_full * by_sine_cx_converged_4)) * (converged_part_17 +
        (converged_part_119 * (converged_part_18_scaled + (5.0f * converged_part_120))));
    const float gradient_1_converged_5 = (rows_1_1_converged_5 * residuals_1_converged_5) +
        (rows_3_1_converged_5 * residuals_3_converged_5) + (rows_5_1_converged_5 * residuals_5_converged_5) -
        (0.00992376f * then_1_converged_4);
    const float inverse_1 = 1.0f / ((rows_1_1_converged_5 * rows_1_1_converged_5) +
        (rows_3_1_converged_5 * rows_3_1_converged_5) + (rows_5_1_converged_5 * rows_5_1_converged_5) + 0.00992376f);
    const float converged_part_125 = gradient_1_converged_5 * inverse_1;
    const float rows_2_2_converged_5 = ((start_cosine_ay * by_cosine_ay_converged_4) -
        (ay_part_full * by_sine_ay_converged_4)) * (converged_part +
        (converged_part_110 * (converged_part_2_scaled + (5.0f * converged_part_111))));
    const float rows_4_2_converged_5 = ((start_cosine_by * by_cosine_converged_4) -
        (by_part_full * by_sine_converged_4)) * (converged_part_9 +
        (converged_part_116 * (converged_part_10_scaled + (5.0f * converged_part_117))));
    const float rows_6_2_converged_5 = ((start_cosine_cy * by_cosine_cy_converged_4) -
        (cy_part_full * by_sine_cy_converged_4)) * (converged_part_17 +
        (converged_part_122 * (converged_part_18_scaled + (5.0f * converged_part_123))));
    const float gradient_2_converged_5 = (rows_2_2_converged_5 * residuals_2_converged_5) +
        (rows_4_2_converged_5 * residuals_4_converged_5) + (rows_6_2_converged_5 * residuals_6_converged_5) -
        (0.00992376f * then_2_converged_4);
    const float inverse_2 = 1.0f / ((rows_2_2_converged_5 * rows_2_2_converged_5) +
        (rows_4_2_converged_5 * rows_4_2_converged_5) + (rows_6_2_converged_5 * rows_6_2_converged_5) + 0.00992376f);
    const float converged_part_126 = gradient_2_converged_5 * inverse_2;
    const float rows_1_3_converged_5 = (rows_1_1_converged_5 * ((1.5812683f * turns_3_sine_converged_4) -
        (1.5833627f * turns_3_cosine_converged_4))) + converged_part_112;
    const float converged_part_127 = converged_part_109 -
        (rows_2_2_converged_5 * ((-1.5812683f * turns_3_cosine_converged_4) - (1.5833627f * turns_3_sine_converged_4)));
    const float rows_3_3_converged_5 = (rows_3_1_converged_5 * ((0.0858702f * turns_3_sine_converged_4) -
        (0.08168141f * turns_3_cosine_converged_4))) + converged_part_118;
    const float converged_part_128 = converged_part_115 - (rows_4_2_converged_5 *
        ((-0.0858702f * turns_3_cosine_converged_4) - (0.08168141f * turns_3_sine_converged_4)));
    const float rows_5_3_converged_5 = (rows_5_1_converged_5 * ((1.6650441f * turns_3_cosine_converged_4) -
        (1.6671385f * turns_3_sine_converged_4))) + converged_part_124;
    const float converged_part_129 = converged_part_121 -
        (rows_6_2_converged_5 * ((1.6671385f * turns_3_cosine_converged_4) + (1.6650441f * turns_3_sine_converged_4)));
    const float left_3_1_converged_5 = (rows_1_3_converged_5 * rows_1_1_converged_5) +
        (rows_3_3_converged_5 * rows_3_1_converged_5) + (rows_5_3_converged_5 * rows_5_1_converged_5);
    const float x_converged = hall_position_three_limit(left_3_1_converged_5 * inverse_1, 4693.3496f);
    const float converged_part_130 = (converged_part_127 * rows_2_2_converged_5) +
        (converged_part_128 * rows_4_2_converged_5) + (converged_part_129 * rows_6_2_converged_5);
    const float y_converged = hall_position_three_limit(-(converged_part_130 * inverse_2), 4693.3496f);
    const float forward_3_converged_4 = (rows_1_3_converged_5 * residuals_1_converged_5) -
        (converged_part_127 * residuals_2_converged_5) + (rows_3_3_converged_5 * residuals_3_converged_5) -
        (converged_part_128 * residuals_4_converged_5) + (rows_5_3_converged_5 * residuals_5_converged_5) -
        (converged_part_129 * residuals_6_converged_5) - (0.87438375f * then_3_converged_4) -
        (x_converged * gradient_1_converged_5) - (y_converged * gradient_2_converged_5);
    const float pivot = hall_position_three_max((rows_1_3_converged_5 * rows_1_3_converged_5) + (converged_part_127 *
        converged_part_127) + (rows_3_3_converged_5 * rows_3_3_converged_5) + (converged_part_128 * converged_part_128)
        + (rows_5_3_converged_5 * rows_5_3_converged_5) + (converged_part_129 * converged_part_129) + 0.87438375f -
        (x_converged * left_3_1_converged_5) + (y_converged * converged_part_130), 0.87438375f);
    const float step_converged = forward_3_converged_4 / pivot;
    const bool converged = better_converged_4 && (((gradient_1_converged_5 * converged_part_125) +
        (gradient_2_converged_5 * converged_part_126) + (forward_3_converged_4 * step_converged)) <= 1e-08f);
    float at_3;
    float at_1;
    float at_2;
    if (converged) {
        const float untried_3 = hall_position_three_limit(then_3_converged_4 + step_converged, 0.14022085f);
        at_3 = untried_3;
        const float moves_3_X = untried_3 - then_3_converged_4;
        at_1 = hall_position_three_limit(then_1_converged_4 + (converged_part_125 - (x_converged * moves_3_X)), 0.5f);
        at_2 = hall_position_three_limit(then_2_converged_4 + (converged_part_126 - (y_converged * moves_3_X)), 0.5f);
    } else {
        if (better_converged_4) {
            at_3 = then_3_converged_4;
            at_1 = then_1_converged_4;
            at_2 = then_2_converged_4;
        } else {
            at_3 = other_3_converged_3;
            at_1 = other_1_converged_3;
            at_2 = other_2_converged_3;
        }
    }
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const float estimator_yaw_last_good = state->estimator_yaw_last_good;
    const uint32_t estimator_searching = state->estimator_searching;
    bool lost_X = gate_exceeded;
    if (estimator_ambiguity_resolved == 0u) {
        lost_X = (estimator_searching != 0u) &&
            !(fabsf(prediction_yaw + at_3 - estimator_yaw_last_good) <= 0.08726646f);
    }
    const bool integrity_residual_fault = ((0.01f * freedom) < squares_converged_2) || lost_X;
    const bool tracking = estimator_searching == 0u;
    float by_phase_x = 0.0f;
    float yaw_X = 0.0f;
    float by_phase_y = 0.0f;
    float estimator_motion_x_part = 0.0f;
    float estimator_motion_y_part = 0.0f;
    float estimator_motion_yaw_part = 0.0f;
    if (!(integrity_residual_fault && tracking)) {
        by_phase_x = at_1;
        yaw_X = at_3;
        by_phase_y = at_2;
        estimator_motion_x_part = 0.5f * at_1;
        estimator_motion_y_part = 0.5f * at_2;
        estimator_motion_yaw_part = 0.1f * at_3;
    }
    const float moved_x = prediction_phase_x + by_phase_x;
    const bool turns_x_X = pi < moved_x;
    float angle_x = moved_x;
    if (turns_x_X) {
        angle_x = moved_x - two_pi;
    }
    float pose_phase_x = angle_x;
    float turns_x_X_2 = -1.0f;
    if (angle_x < -pi) {
        pose_phase_x = angle_x + two_pi;
    } else {
        turns_x_X_2 = turns_x_X ? 1.0f : 0.0f;
    }
    const float pose_pitch_x = state->estimator_pitch_x + turns_x_X_2;
    const float f19_argument = yaw_X * yaw_X;
    const float by_cosine_X = f19_polynomial(f19_argument);
    const float by_sine_X = yaw_X * f9_polynomial(f19_argument);
    const float cosine = (heading_cosine * by_cosine_X) - (heading_sine * by_sine_X);
    const float sine_X = (heading_sine * by_cosine_X) + (heading_cosine * by_sine_X);
    const float lever_cosine = (0.0060790665f * cosine) + (0.0040132f * sine_X);
    const float X = (0.008085071f * pose_phase_x) + (0.0508f * pose_pitch_x) - lever_cosine;
    const float moved_y = prediction_phase_y + by_phase_y;
    const bool turns_y_Y = pi < moved_y;
    float angle_y = moved_y;
    if (turns_y_Y) {
        angle_y = moved_y - two_pi;
    }
    float pose_phase_y = angle_y;
    float turns_y_Y_2 = -1.0f;
    if (angle_y < -pi) {
        pose_phase_y = angle_y + two_pi;
    } else {
        turns_y_Y_2 = turns_y_Y ? 1.0f : 0.0f;
    }
    const float pose_pitch_y = state->estimator_pitch_y + turns_y_Y_2;
    const float lever_sine = (0.0060790665f * sine_X) - (0.0040132f * cosine);
    const float Y = (0.008085071f * pose_phase_y) + (0.0508f * pose_pitch_y) - lever_sine;
    const float prediction_yaw_plus_yaw_X = prediction_yaw + yaw_X;
    float angle = prediction_yaw_plus_yaw_X;
    if (pi < prediction_yaw_plus_yaw_X) {
        angle = prediction_yaw_plus_yaw_X - two_pi;
    }
    float yaw = angle;
    if (angle < -pi) {
        yaw = angle + two_pi;
    }
    const float by_yaw_X = x_converged - (123.68475f * lever_sine);
    const float yaw_variance = 1.0f / (pivot + -0.8394084f);
    const float deviation_X = 8.085071e-06f * sqrtf(inverse_1 + (by_yaw_X * by_yaw_X * yaw_variance));
    const float by_yaw_Y = y_converged + (123.68475f * lever_cosine);
    const float deviation_Y = 8.085071e-06f * sqrtf(inverse_2 + (by_yaw_Y * by_yaw_Y * yaw_variance));
    const float deviation_yaw = 0.001f * sqrtf(yaw_variance);
    const float residual = sqrtf(1e-30f + (squares_converged_2 / freedom));
    const float weight = ((3.524405f + (x_converged * x_converged) + (y_converged * y_converged)) * yaw_variance) +
        inverse_1 + inverse_2;
    const bool damped = 15.115238f < weight;
    const bool integrity_good = converged && !(damped || integrity_residual_fault || gate_exceeded);
    const bool counted = (fabsf(pose_pitch_x) <= 8.0f) && (fabsf(pose_pitch_y) <= 8.0f);
    const float size = fabsf(yaw);
    const bool accepted = counted && (size <= 0.17453292f);
    const bool resolved_valid = (integrity_good && ((hall_position_three_flag(excluded_1) +
        hall_position_three_flag(excluded_2) + hall_position_three_flag(excluded_3)) < 1u) && (weight <= 1.612292f) &&
        tracking && accepted) || ((estimator_ambiguity_resolved != 0u) && !damped);
    const uint32_t estimator_lock_lost = state->estimator_lock_lost;
    const bool valid = integrity_good && resolved_valid && (estimator_lock_lost == 0u) && accepted;
    out->lock_lost = (float)estimator_lock_lost;
    const bool exhausted = 4u <= estimator_residual_faults;
    const bool restart = integrity_residual_fault && exhausted;
    const bool faultless = !integrity_residual_fault;
    if (restart) {
        state->estimator_yaw = estimator_yaw_last_good;
        state->estimator_searching = 1u;
        state->estimator_ambiguity_resolved = 0u;
        state->estimator_excluded_sensor = 0u;
        const float start_x = state->estimator_start_x + -1.5401491f;
        if (start_x < -pi) {
            state->estimator_phase_x = start_x + two_pi;
            state->estimator_start_x = state->estimator_phase_x;
        } else {
            state->estimator_phase_x = start_x;
            state->estimator_start_x = start_x;
        }
        const float start_y = state->estimator_start_y + -2.702773f;
        if (start_y < -pi) {
            state->estimator_phase_y = start_y + two_pi;
            state->estimator_start_y = state->estimator_phase_y;
        } else {
            state->estimator_phase_y = start_y;
            state->estimator_start_y = start_y;
        }
    } else {
        state->estimator_phase_x = pose_phase_x;
        state->estimator_phase_y = pose_phase_y;
        state->estimator_yaw = yaw;
        state->estimator_ambiguity_resolved = hall_position_three_flag(resolved_valid);
        if (converged && faultless) {
            state->estimator_searching = 0u;
        }
        const float squares_2 = terms_3_converged + terms_4_converged;
        const float square = terms_5_converged + terms_6_converged;
        const float squares_2_max_squares_1 = hall_position_three_max(squares_2, squares_1);
        const float others = hall_position_three_min(squares_2, squares_1) +
            hall_position_three_min(square, squares_2_max_squares_1);
        if (integrity_residual_fault && ((1.6e-05f * freedom) < squares_converged_2) &&
                (estimator_ambiguity_resolved != 0u) && (1u <= estimator_residual_faults) && (others <= 0.076f) &&
                ((25.0f * others) <= hall_position_three_max(square, squares_2_max_squares_1))) {
            state->estimator_excluded_sensor = (uint32_t)((squares_2_max_squares_1 < square) ? 3.0f :
                ((squares_1 < squares_2) ? 2.0f : 1.0f));
        }
    }
    if (resolved_valid && faultless) {
        state->estimator_yaw_last_good = yaw;
    }
    state->estimator_pitch_x = hall_position_three_limit(pose_pitch_x, 8.0f);
    state->estimator_pitch_y = hall_position_three_limit(pose_pitch_y, 8.0f);
    float continued_motion_x = 0.0f;
    float continued_motion_y = 0.0f;
    float continued_motion_yaw = 0.0f;
    if (estimator_searching == 0u) {
        continued_motion_x = estimator_motion_x + estimator_motion_x_part;
        continued_motion_y = estimator_motion_y + estimator_motion_y_part;
        continued_motion_yaw = estimator_motion_yaw + estimator_motion_yaw_part;
    }
    state->estimator_motion_x = hall_position_three_limit(continued_motion_x, 0.5f);
    state->estimator_motion_y = hall_position_three_limit(continued_motion_y, 0.5f);
    state->estimator_motion_yaw = hall_position_three_limit(continued_motion_yaw, 0.14022085f);
    state->estimator_residual_faults = (integrity_residual_fault) ?
        ((exhausted) ? 0u : (estimator_residual_faults + 1u)) : 0u;
    const uint32_t estimator_acquired = state->estimator_acquired;
    state->estimator_acquired = hall_position_three_flag(resolved_valid || (estimator_acquired != 0u));
    state->estimator_lock_lost = hall_position_three_flag((estimator_lock_lost != 0u) || ((estimator_acquired != 0u) &&
        (restart || !counted || (((resolved_valid) ? 0.17453292f : 0.34906584f) < size))));
    out->X = X;
    out->Y = Y;
    out->yaw = yaw;
    out->deviation_X = deviation_X;
    out->deviation_Y = deviation_Y;
    out->deviation_yaw = deviation_yaw;
    out->residual = residual;
    out->converged = converged ? 1.0f : 0.0f;
    out->damped = damped ? 1.0f : 0.0f;
    out->valid = valid ? 1.0f : 0.0f;
    out->excluded_sensor = (float)estimator_excluded_sensor;

    return faults;
}
