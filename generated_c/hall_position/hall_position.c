/* hall_position. Generated: do not edit. */
#include "hall_position.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float hall_position_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline uint32_t hall_position_flag(bool holds)
{
    uint32_t value = 0u;
    if (holds) {
        value = 1u;
    }
    return value;
}

#if defined(__GNUC__)
#define HALL_POSITION_INLINE static inline __attribute__((always_inline))
#else
#define HALL_POSITION_INLINE static inline
#endif
/* Return a value in -high .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
HALL_POSITION_INLINE float hall_position_hold_within(float value, float high, float *last, uint32_t bit,
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

/* f1_polynomial / x; x = estimator_yaw + estimator_motion_yaw in -3.2425952 .. 3.2425952, t = x^2; relative error at
 * most 1.2e-07. */
static inline float f1_polynomial(float t)
{
    return 0.25f + (t * (-0.0026041644f + (t * (8.136728e-06f + (t * -1.1898613e-08f)))));
}

/* yaw_fraction_cosine; x = estimator_yaw + estimator_motion_yaw in -3.2425952 .. 3.2425952, t = x^2; relative error at
 * most 1.4e-07. */
static inline float yaw_fraction_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.031249868f + (t * (0.00016270365f + (t * -3.3090393e-07f)))));
}

/* f3_polynomial / x; x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * clamp((clamp((4 * (...)), -2, 2) *
 * (1 - (0.125 * (...)))), -1, 1)) - (2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2)))))) in
 * -8.35398197 .. 8.35398293, t = x^2; relative error at most 1.5e-07. */
/* f5_polynomial / x; x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) *
 * clamp((...), -2, 2))))) - (2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -8.35398293 .. 8.35398197, t = x^2; relative error at most 1.5e-07. */
static inline float f3_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551866f + (t * (2.5417654e-07f + (t * -9.166732e-11f)))));
}

/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * clamp((clamp((4 * (...)), -2, 2)
 * * (1 - (0.125 * (...)))), -1, 1)) - (2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2)))))) in
 * -8.35398197 .. 8.35398293, t = x^2; relative error at most 1.7e-07. */
/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * (1 - (0.5 * (clamp((...), -2, 2)
 * * clamp((...), -2, 2))))) - (2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -8.35398293 .. 8.35398197, t = x^2; relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.0078124995f + (t * (1.0172464e-05f + (t * (-5.295563e-09f + (t * 1.434358e-12f)))))));
}

/* yaw_change_sine / x; x = clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (2.75466335 +
 * (((...) * (...)) + ((...) * (...))))), -0.101002539, 0.101002539) in -0.101002537 .. 0.101002537, t = x^2; relative
 * error at most 2.1e-07. */
static inline float yaw_change_sine_polynomial(float t)
{
    return 0.9999999f + (t * -0.16658026f);
}

/* half_yaw_change_sine / x; x = clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) /
 * (2.75466335 + (((...) * (...)) + ((...) * (...))))), -0.101002539, 0.101002539) in -0.101002537 .. 0.101002537, t =
 * x^2; relative error at most 1.1e-07. */
static inline float half_yaw_change_sine_polynomial(float t)
{
    return 0.70710677f + (t * -0.029459648f);
}

/* f9_polynomial; x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...)
 * - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.999171257 ..
 * 0.999171257, t = x^2; relative error at most 1.4e-07. */
static inline float f9_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666426f + (t * (-0.0013882433f + (t * 2.409394e-05f)))))));
}

/* f10_polynomial / x; x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) -
 * ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in
 * -0.999171257 .. 0.999171257, t = x^2; relative error at most 1.2e-07. */
static inline float f10_polynomial(float t)
{
    return 1.0f + (t * (-0.16666614f + (t * (0.008330209f + (t * -0.00019311193f)))));
}

typedef struct {
    float sine_2;
    float sine_squared;
    float by_axis_g;
    float terms;
} hall_position_terms_t;

/* terms: 16 calls in the step */
HALL_POSITION_INLINE hall_position_terms_t hall_position_terms(float cosine, float angle, float sine)
{
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_0 = 2.24906f;
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_2 = 10.81368f;
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_4 = -14.41824f;

    const float f9_argument = angle * angle;
    const float by_cosine = f9_polynomial(f9_argument);
    const float by_sine = angle * f10_polynomial(f9_argument);
    const float sine_2 = (sine * by_cosine) + (cosine * by_sine);
    const float sine_2_squared = sine_2 * sine_2;
    const float by_axis_g = ((cosine * by_cosine) - (sine * by_sine)) * (estimator_slope_0 + (sine_2_squared *
        (estimator_slope_2 + (sine_2_squared * estimator_slope_4))));
    return (hall_position_terms_t){.sine_2 = sine_2, .sine_squared = sine_2_squared, .by_axis_g = by_axis_g, .terms =
        by_axis_g * by_axis_g};
}

typedef struct {
    float by_axis_1_e;
    float by_axis_2_e;
    float coupling;
    float across;
    float gain;
} hall_position_gain_t;

/* gain: 8 calls in the step */
HALL_POSITION_INLINE hall_position_gain_t hall_position_gain(float by_axis_1_h, float volts, float B, float by_axis_2_h,
    float volts_2, float B_2, float value, float by_axis_1_g, float by_axis_2_g)
{
    static const float damping = 0.00992376f;                   /* V^2; 0.001 alpha^2: weight of the prior */

    const float by_axis_1_e = volts - B;
    const float by_axis_2_e = volts_2 - B_2;
    const float coupling = (by_axis_1_g * by_axis_1_h) + (by_axis_2_g * by_axis_2_h);
    const float across = (by_axis_1_g * by_axis_2_h) - (by_axis_2_g * by_axis_1_h);
    return (hall_position_gain_t){.by_axis_1_e = by_axis_1_e, .by_axis_2_e = by_axis_2_e, .coupling = coupling, .across
        = across, .gain = (damping * ((by_axis_1_h * by_axis_1_e) + (by_axis_2_h * by_axis_2_e) + (value * coupling))) +
        (across * ((by_axis_1_g * by_axis_2_e) - (by_axis_2_g * by_axis_1_e)))};
}

typedef struct {
    float cosine;
    float sine;
    float sine_squared;
    float by_axis_g;
    float terms;
} hall_position_terms_2_t;

/* terms_2: 4 calls in the step */
HALL_POSITION_INLINE hall_position_terms_2_t hall_position_terms_2(float prediction_phase, float value)
{
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_0 = 2.24906f;
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_2 = 10.81368f;
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_4 = -14.41824f;

    const float at = prediction_phase + value;
    const float f3_argument = at * at;
    const float f3 = at * f3_polynomial(f3_argument);
    const float phase_fraction_sine = 8.0f * f3;
    const float phase_fraction_cosine = phase_fraction_cosine_polynomial(f3_argument);
    const float cosine_part = f3 * phase_fraction_cosine;
    const float cosine_part_2 = hall_position_limit(8.0f * (cosine_part * (1.0f - (0.03125f * (phase_fraction_sine *
        phase_fraction_sine)))), 2.0f);
    const float cosine = 1.0f - (0.5f * (cosine_part_2 * cosine_part_2));
    const float sine_part = 8.0f * cosine_part;
    const float sine = hall_position_limit(cosine_part_2 * (1.0f - (0.125f * (sine_part * sine_part))), 1.0f);
    const float sine_squared = sine * sine;
    const float by_axis_g = cosine * (estimator_slope_0 + (sine_squared * (estimator_slope_2 + (sine_squared *
        estimator_slope_4))));
    return (hall_position_terms_2_t){.cosine = cosine, .sine = sine, .sine_squared = sine_squared, .by_axis_g =
        by_axis_g, .terms = by_axis_g * by_axis_g};
}

/* B: 16 calls in the step */
HALL_POSITION_INLINE float hall_position_B(float sine, float sine_squared)
{
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_1 = 2.24906f;
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_3 = 3.60456f;
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_5 = -2.883648f;

    return sine * (estimator_field_1 + (sine_squared * (estimator_field_3 + (sine_squared * estimator_field_5))));
}

void hall_position_init(hall_position_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (hall_position_state_t){
        .guard_left = 5u,
        .estimator_searching = 1u,
    };
}

uint32_t hall_position_step(hall_position_state_t *state, const hall_position_input_t *in, hall_position_output_t *out)
{
    /* rad; w times the place of sensor a from the centre, along x, also arm_ax, also arm_ay, also arm_bx, also arm_by
     * */
    static const float arm = -2.3561945f;
    static const float damping = 0.00992376f;                   /* V^2; 0.001 alpha^2: weight of the prior */
    static const float yaw_damping = 2.7546635f;                /* V^2; damping (5 radius)^2 */
    static const float max_yaw_step = 0.10100254f;              /* rad; moves no sensor by more than 0.5 rad of phase */
    static const float squared_yaw_arm = 277.5826f;             /* 1; (5 radius)^2 */
    static const float cost_factor = 1.000002f;                 /* 1; rise of the cost that rounding may cause */
    static const float cost_slack = 1e-08f; /* V^2; rise of the cost that rounding may cause, also converged_decrease */
    static const float squared_residual_limit = 0.01f;          /* V^2; above: a residual fault */
    static const float squared_radius = 11.103305f;             /* 1; radius^2 */
    static const float squared_gate = 0.0009069143f;            /* rad^2; innovation_gate^2 */
    /* rad; of a pose that is not yet unambiguous, also yaw_window */
    static const float ambiguous_yaw_limit = 0.08726646f;
    static const float pi = 3.1415927f;                         /* 1; pi */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    static const float metre_per_rad = 0.008085071f;            /* m/rad; 1 / w */
    static const float pitch = 0.0508f;                         /* m; pitch of the magnet matrix */
    static const float undamped_yaw = 0.11018653f;              /* V^2; damping radius^2 */
    static const float deviation_over_w = 8.085071e-06f;        /* V m/rad; deviation / w */
    static const float deviation = 0.001f;                      /* V; standard deviation of a voltage */
    static const float least_square = 1e-30f;                   /* V^2; keeps the argument of a root positive */
    static const float damped_weight = 15.115238f;              /* 1/V^2; above: the pose is damped */
    static const float unambiguous_weight = 0.403073f;          /* 1/V^2; at most: the pose is unambiguous */
    static const float yaw_limit = 0.04363323f;                 /* rad; largest yaw that is valid */
    static const float start_step_x = 1.5401491f;               /* rad; from one start of the search to the next */
    static const float start_step_y = 2.702773f;                /* rad; from one start of the search to the next */
    static const float yaw_gain = 0.1f;                         /* 1; of a correction, in the motion */
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_1 = 2.24906f;
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_3 = 3.60456f;
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_5 = -2.883648f;

    /* guard: range acceptance, hold, latch */
    uint32_t faults = 0u;
    const float V_ax_held = hall_position_hold_within(in->V_ax, 5.0f, &state->guard_last_V_ax, 0x00000001u, &faults);
    const float V_ay_held = hall_position_hold_within(in->V_ay, 5.0f, &state->guard_last_V_ay, 0x00000002u, &faults);
    const float V_bx_held = hall_position_hold_within(in->V_bx, 5.0f, &state->guard_last_V_bx, 0x00000004u, &faults);
    const float V_by_held = hall_position_hold_within(in->V_by, 5.0f, &state->guard_last_V_by, 0x00000008u, &faults);
    const bool complete = (faults & 0x0000000fu) == 0u;
    const uint32_t guard_latched = state->guard_latched;
    uint32_t latched = guard_latched;
    if (complete) {
        state->guard_left = 5u;
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
     *     yaw_fraction_sine = 4 * sin(0.25 * (yaw + motion_yaw))
     *     yaw_fraction_cosine = cos(0.25 * (yaw + motion_yaw))
     *     phase_fraction_cosine = cos(0.125 * (phase_y + motion_y + -arm * limit(limit(4 * (sin(0.25 * (yaw +
     *         motion_yaw)) * yaw_fraction_cosine), 2) * (1 - 0.125 * yaw_fraction_sine^2), 1) + -arm * (1 -
     *         0.5 * limit(4 * (sin(0.25 * (yaw + motion_yaw)) * yaw_fraction_cosine), 2)^2))) */
    const float estimator_motion_yaw = state->estimator_motion_yaw;
    const float prediction_yaw = state->estimator_yaw + estimator_motion_yaw;
    const float f1_argument = prediction_yaw * prediction_yaw;
    const float f1 = prediction_yaw * f1_polynomial(f1_argument);
    const float yaw_fraction_sine = 4.0f * f1;
    const float yaw_fraction_cosine = yaw_fraction_cosine_polynomial(f1_argument);
    const float cost_0_part = hall_position_limit(4.0f * (f1 * yaw_fraction_cosine), 2.0f);
    const float heading_cosine = 1.0f - (0.5f * (cost_0_part * cost_0_part));
    const float heading_sine = hall_position_limit(cost_0_part * (1.0f - (0.125f * (yaw_fraction_sine *
        yaw_fraction_sine))), 1.0f);
    const float volts_cosine_cost_0 = (heading_cosine * V_ax_held) - (heading_sine * V_ay_held);
    const float estimator_motion_x = state->estimator_motion_x;
    const float prediction_phase_x = state->estimator_phase_x + estimator_motion_x;
    const float arm_times_heading_sine = -arm * heading_sine;
    const float arm_times_heading_cosine = -arm * heading_cosine;
    const float x_cost_0 = arm_times_heading_sine - arm_times_heading_cosine;
    const hall_position_terms_2_t terms_1_2 = hall_position_terms_2(prediction_phase_x, x_cost_0);
    const float cost_0_part_2 = estimator_field_1 + (terms_1_2.sine_squared * (estimator_field_3 +
        (terms_1_2.sine_squared * estimator_field_5)));
    const float B_1_cost_0 = terms_1_2.sine * cost_0_part_2;
    const float by_axis_1_1_e_cost_0 = volts_cosine_cost_0 - B_1_cost_0;
    const float volts_cosine_cost_0_2 = (heading_cosine * V_bx_held) - (heading_sine * V_by_held);
    const float x_cost_0_2 = arm_times_heading_cosine - arm_times_heading_sine;
    const hall_position_terms_2_t terms_2_2 = hall_position_terms_2(prediction_phase_x, x_cost_0_2);
    const float cost_0_part_3 = estimator_field_1 + (terms_2_2.sine_squared * (estimator_field_3 +
        (terms_2_2.sine_squared * estimator_field_5)));
    const float B_1_cost_0_2 = terms_2_2.sine * cost_0_part_3;
    const float by_axis_1_2_e_cost_0 = volts_cosine_cost_0_2 - B_1_cost_0_2;
    const float volts_sine_cost_0 = (heading_sine * V_ax_held) + (heading_cosine * V_ay_held);
    const float estimator_motion_y = state->estimator_motion_y;
    const float prediction_phase_y = state->estimator_phase_y + estimator_motion_y;
    const float y_cost_0 = (arm * heading_sine) - arm_times_heading_cosine;
    const hall_position_terms_2_t terms_3_2 = hall_position_terms_2(prediction_phase_y, y_cost_0);
    const float cost_0_part_4 = estimator_field_1 + (terms_3_2.sine_squared * (estimator_field_3 +
        (terms_3_2.sine_squared * estimator_field_5)));
    const float B_2_cost_0 = terms_3_2.sine * cost_0_part_4;
    const float by_axis_2_1_e_cost_0 = volts_sine_cost_0 - B_2_cost_0;
    const float volts_sine_cost_0_2 = (heading_sine * V_bx_held) + (heading_cosine * V_by_held);
    const float y_cost_0_2 = arm_times_heading_sine + arm_times_heading_cosine;
    const hall_position_terms_2_t terms_4_2 = hall_position_terms_2(prediction_phase_y, y_cost_0_2);
    const float cost_0_part_5 = estimator_field_1 + (terms_4_2.sine_squared * (estimator_field_3 +
        (terms_4_2.sine_squared * estimator_field_5)));
    const float B_2_cost_0_2 = terms_4_2.sine * cost_0_part_5;
    const float by_axis_2_2_e_cost_0 = volts_sine_cost_0_2 - B_2_cost_0_2;
    const float cost_0 = (by_axis_1_1_e_cost_0 * by_axis_1_1_e_cost_0) + (by_axis_1_2_e_cost_0 * by_axis_1_2_e_cost_0) +
        (by_axis_2_1_e_cost_0 * by_axis_2_1_e_cost_0) + (by_axis_2_2_e_cost_0 * by_axis_2_2_e_cost_0);
    const float yaw_change_sine_part = B_2_cost_0 - (terms_1_2.by_axis_g * y_cost_0);
    const float yaw_change_sine_part_2 = B_2_cost_0_2 - (terms_2_2.by_axis_g * y_cost_0_2);
    const float across_yaw_change_sine = (terms_1_2.by_axis_g * yaw_change_sine_part_2) - (terms_2_2.by_axis_g *
        yaw_change_sine_part);
    const float yaw_change_sine_part_3 = 1.0f / (damping + (terms_1_2.terms + terms_2_2.terms));
    const float terms_1_yaw_change_sine = ((damping * ((yaw_change_sine_part * by_axis_1_1_e_cost_0) +
        (yaw_change_sine_part_2 * by_axis_1_2_e_cost_0))) + (across_yaw_change_sine * ((terms_1_2.by_axis_g *
        by_axis_1_2_e_cost_0) - (terms_2_2.by_axis_g * by_axis_1_1_e_cost_0)))) * yaw_change_sine_part_3;
    const float yaw_change_sine_part_4 = (terms_3_2.by_axis_g * x_cost_0) - B_1_cost_0;
    const float yaw_change_sine_part_5 = (terms_4_2.by_axis_g * x_cost_0_2) - B_1_cost_0_2;
    const float across_yaw_change_sine_2 = (terms_3_2.by_axis_g * yaw_change_sine_part_5) - (terms_4_2.by_axis_g *
        yaw_change_sine_part_4);
    const float yaw_change_sine_part_6 = 1.0f / (damping + (terms_3_2.terms + terms_4_2.terms));
    const float terms_2_yaw_change_sine = ((damping * ((yaw_change_sine_part_4 * by_axis_2_1_e_cost_0) +
        (yaw_change_sine_part_5 * by_axis_2_2_e_cost_0))) + (across_yaw_change_sine_2 * ((terms_3_2.by_axis_g *
        by_axis_2_2_e_cost_0) - (terms_4_2.by_axis_g * by_axis_2_1_e_cost_0)))) * yaw_change_sine_part_6;
    const float data_yaw_change_sine = (((damping * ((yaw_change_sine_part * yaw_change_sine_part) +
        (yaw_change_sine_part_2 * yaw_change_sine_part_2))) + (across_yaw_change_sine * across_yaw_change_sine)) *
        yaw_change_sine_part_3) + (((damping * ((yaw_change_sine_part_4 * yaw_change_sine_part_4) +
        (yaw_change_sine_part_5 * yaw_change_sine_part_5))) + (across_yaw_change_sine_2 * across_yaw_change_sine_2)) *
        yaw_change_sine_part_6);
    const float then_3_yaw_change_sine = hall_position_limit((terms_1_yaw_change_sine + terms_2_yaw_change_sine) /
        (yaw_damping + data_yaw_change_sine), max_yaw_step);
    const float yaw_change_sine_part_7 = then_3_yaw_change_sine * then_3_yaw_change_sine;
    const float yaw_change_sine = then_3_yaw_change_sine * yaw_change_sine_polynomial(yaw_change_sine_part_7);
    const float half_yaw_change_sine = then_3_yaw_change_sine * half_yaw_change_sine_polynomial(yaw_change_sine_part_7);
    const float cost_1_part = (terms_3_2.by_axis_g * by_axis_2_1_e_cost_0) + (terms_4_2.by_axis_g *
        by_axis_2_2_e_cost_0) - (((terms_3_2.by_axis_g * yaw_change_sine_part_4) + (terms_4_2.by_axis_g *
        yaw_change_sine_part_5)) * then_3_yaw_change_sine);
    const float then_2_cost_1 = hall_position_limit(cost_1_part * yaw_change_sine_part_6, 0.5f);
    const float versine_cost_1 = half_yaw_change_sine * half_yaw_change_sine;
    const float dy_cost_1 = (x_cost_0 * yaw_change_sine) - (y_cost_0 * versine_cost_1);
    const hall_position_terms_t terms_3 = hall_position_terms(terms_3_2.cosine, then_2_cost_1 + dy_cost_1,
        terms_3_2.sine);
    const float B_2 = hall_position_B(terms_3.sine_2, terms_3.sine_squared);
    const float cost_1_part_2 = (terms_1_2.by_axis_g * by_axis_1_1_e_cost_0) + (terms_2_2.by_axis_g *
        by_axis_1_2_e_cost_0) - (((terms_1_2.by_axis_g * yaw_change_sine_part) + (terms_2_2.by_axis_g *
        yaw_change_sine_part_2)) * then_3_yaw_change_sine);
    const float then_1_cost_1 = hall_position_limit(cost_1_part_2 * yaw_change_sine_part_3, 0.5f);
    const float cost_1_part_3 = (x_cost_0 * versine_cost_1) + (y_cost_0 * yaw_change_sine);
    const hall_position_terms_t terms_1 = hall_position_terms(terms_1_2.cosine, then_1_cost_1 - cost_1_part_3,
        terms_1_2.sine);
    const float by_axis_1_1_h_cost_1 = B_2 - (terms_1.by_axis_g * (y_cost_0 + dy_cost_1));
    const float rotation_cosine_cost_1 = 1.0f - versine_cost_1;
    const float B_1 = hall_position_B(terms_1.sine_2, terms_1.sine_squared);
    const float dy_cost_1_2 = (x_cost_0_2 * yaw_change_sine) - (y_cost_0_2 * versine_cost_1);
    const hall_position_terms_t terms_4 = hall_position_terms(terms_4_2.cosine, then_2_cost_1 + dy_cost_1_2,
        terms_4_2.sine);
    const float B_2_2 = hall_position_B(terms_4.sine_2, terms_4.sine_squared);
    const float cost_1_part_4 = (x_cost_0_2 * versine_cost_1) + (y_cost_0_2 * yaw_change_sine);
    const hall_position_terms_t terms_2 = hall_position_terms(terms_2_2.cosine, then_1_cost_1 - cost_1_part_4,
        terms_2_2.sine);
    const float by_axis_1_2_h_cost_1 = B_2_2 - (terms_2.by_axis_g * (y_cost_0_2 + dy_cost_1_2));
    const float B_1_2 = hall_position_B(terms_2.sine_2, terms_2.sine_squared);
    const hall_position_gain_t gain_1 = hall_position_gain(by_axis_1_1_h_cost_1, (volts_cosine_cost_0 *
        rotation_cosine_cost_1) - (volts_sine_cost_0 * yaw_change_sine), B_1, by_axis_1_2_h_cost_1,
        (volts_cosine_cost_0_2 * rotation_cosine_cost_1) - (volts_sine_cost_0_2 * yaw_change_sine), B_1_2,
        then_1_cost_1, terms_1.by_axis_g, terms_2.by_axis_g);
    const float by_axis_2_1_h_cost_1 = (terms_3.by_axis_g * (x_cost_0 - cost_1_part_3)) - B_1;
    const float by_axis_2_2_h_cost_1 = (terms_4.by_axis_g * (x_cost_0_2 - cost_1_part_4)) - B_1_2;
    const hall_position_gain_t gain_2 = hall_position_gain(by_axis_2_1_h_cost_1, (volts_sine_cost_0 *
        rotation_cosine_cost_1) + (volts_cosine_cost_0 * yaw_change_sine), B_2, by_axis_2_2_h_cost_1,
        (volts_sine_cost_0_2 * rotation_cosine_cost_1) + (volts_cosine_cost_0_2 * yaw_change_sine), B_2_2,
        then_2_cost_1, terms_3.by_axis_g, terms_4.by_axis_g);
    const float cost_1_part_5 = (gain_1.by_axis_1_e * gain_1.by_axis_1_e) + (gain_1.by_axis_2_e * gain_1.by_axis_2_e) +
        (gain_2.by_axis_1_e * gain_2.by_axis_1_e);
    const float cost_1 = cost_1_part_5 + (gain_2.by_axis_2_e * gain_2.by_axis_2_e) + (damping * ((then_1_cost_1 *
        then_1_cost_1) + (then_2_cost_1 * then_2_cost_1) + (squared_yaw_arm * yaw_change_sine_part_7)));
    const bool better_yaw_change_sine = cost_1 <= ((cost_factor * cost_0) + cost_slack);
    const float yaw_change_sine_part_8 = 1.0f / (damping + (terms_1.terms + terms_2.terms));
    const float yaw_change_sine_part_9 = 1.0f / (damping + (terms_3.terms + terms_4.terms));
    const float data_yaw_change_sine_2 = (((damping * ((by_axis_1_1_h_cost_1 * by_axis_1_1_h_cost_1) +
        (by_axis_1_2_h_cost_1 * by_axis_1_2_h_cost_1))) + (gain_1.across * gain_1.across)) * yaw_change_sine_part_8) +
        (((damping * ((by_axis_2_1_h_cost_1 * by_axis_2_1_h_cost_1) + (by_axis_2_2_h_cost_1 * by_axis_2_2_h_cost_1))) +
        (gain_2.across * gain_2.across)) * yaw_change_sine_part_9);
    float other_3_yaw_change_sine = then_3_yaw_change_sine;
    float other_1_cost_2 = then_1_cost_1;
    float other_2_cost_2 = then_2_cost_1;
    float yaw_change_sine_part_10 = cost_1;
    if (!better_yaw_change_sine) {
        other_3_yaw_change_sine = 0.0f;
        other_1_cost_2 = 0.0f;
        other_2_cost_2 = 0.0f;
        yaw_change_sine_part_10 = cost_0;
    }
    const float yaw_change_sine_part_11 = (better_yaw_change_sine) ? (then_3_yaw_change_sine + (((gain_1.gain *
        yaw_change_sine_part_8) + (gain_2.gain * yaw_change_sine_part_9) - (yaw_damping * then_3_yaw_change_sine)) /
        (yaw_damping + data_yaw_change_sine_2))) : (0.5f * (then_3_yaw_change_sine + other_3_yaw_change_sine));
    const float then_3_yaw_change_sine_2 = hall_position_limit(yaw_change_sine_part_11, max_yaw_step);
    const float yaw_change_sine_part_12 = then_3_yaw_change_sine_2 * then_3_yaw_change_sine_2;
    const float yaw_change_sine_2 = then_3_yaw_change_sine_2 * yaw_change_sine_polynomial(yaw_change_sine_part_12);
    const float half_yaw_change_sine_2 = then_3_yaw_change_sine_2 *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_12);
    const float yaw_change_cost_2 = then_3_yaw_change_sine_2 - then_3_yaw_change_sine;
    const float cost_2_part = (terms_3.by_axis_g * gain_2.by_axis_1_e) + (terms_4.by_axis_g * gain_2.by_axis_2_e) -
        (damping * then_2_cost_1) - (gain_2.coupling * yaw_change_cost_2);
    const float then_2_cost_2 = hall_position_limit((better_yaw_change_sine) ? (then_2_cost_1 + (cost_2_part *
        yaw_change_sine_part_9)) : (0.5f * (then_2_cost_1 + other_2_cost_2)), 0.5f);
    const float versine_cost_2 = half_yaw_change_sine_2 * half_yaw_change_sine_2;
    const float dy_cost_2 = (x_cost_0 * yaw_change_sine_2) - (y_cost_0 * versine_cost_2);
    const hall_position_terms_t terms_7 = hall_position_terms(terms_3_2.cosine, then_2_cost_2 + dy_cost_2,
        terms_3_2.sine);
    const float B_2_3 = hall_position_B(terms_7.sine_2, terms_7.sine_squared);
    const float cost_2_part_2 = (terms_1.by_axis_g * gain_1.by_axis_1_e) + (terms_2.by_axis_g * gain_1.by_axis_2_e) -
        (damping * then_1_cost_1) - (gain_1.coupling * yaw_change_cost_2);
    const float then_1_cost_2 = hall_position_limit((better_yaw_change_sine) ? (then_1_cost_1 + (cost_2_part_2 *
        yaw_change_sine_part_8)) : (0.5f * (then_1_cost_1 + other_1_cost_2)), 0.5f);
    const float cost_2_part_3 = (x_cost_0 * versine_cost_2) + (y_cost_0 * yaw_change_sine_2);
    const hall_position_terms_t terms_5 = hall_position_terms(terms_1_2.cosine, then_1_cost_2 - cost_2_part_3,
        terms_1_2.sine);
    const float by_axis_1_1_h_cost_2 = B_2_3 - (terms_5.by_axis_g * (y_cost_0 + dy_cost_2));
    const float rotation_cosine_cost_2 = 1.0f - versine_cost_2;
    const float B_1_3 = hall_position_B(terms_5.sine_2, terms_5.sine_squared);
    const float dy_cost_2_2 = (x_cost_0_2 * yaw_change_sine_2) - (y_cost_0_2 * versine_cost_2);
    const hall_position_terms_t terms_8 = hall_position_terms(terms_4_2.cosine, then_2_cost_2 + dy_cost_2_2,
        terms_4_2.sine);
    const float B_2_4 = hall_position_B(terms_8.sine_2, terms_8.sine_squared);
    const float cost_2_part_4 = (x_cost_0_2 * versine_cost_2) + (y_cost_0_2 * yaw_change_sine_2);
    const hall_position_terms_t terms_6 = hall_position_terms(terms_2_2.cosine, then_1_cost_2 - cost_2_part_4,
        terms_2_2.sine);
    const float by_axis_1_2_h_cost_2 = B_2_4 - (terms_6.by_axis_g * (y_cost_0_2 + dy_cost_2_2));
    const float B_1_4 = hall_position_B(terms_6.sine_2, terms_6.sine_squared);
    const hall_position_gain_t gain_3 = hall_position_gain(by_axis_1_1_h_cost_2, (volts_cosine_cost_0 *
        rotation_cosine_cost_2) - (volts_sine_cost_0 * yaw_change_sine_2), B_1_3, by_axis_1_2_h_cost_2,
        (volts_cosine_cost_0_2 * rotation_cosine_cost_2) - (volts_sine_cost_0_2 * yaw_change_sine_2), B_1_4,
        then_1_cost_2, terms_5.by_axis_g, terms_6.by_axis_g);
    const float by_axis_2_1_h_cost_2 = (terms_7.by_axis_g * (x_cost_0 - cost_2_part_3)) - B_1_3;
    const float by_axis_2_2_h_cost_2 = (terms_8.by_axis_g * (x_cost_0_2 - cost_2_part_4)) - B_1_4;
    const hall_position_gain_t gain_4 = hall_position_gain(by_axis_2_1_h_cost_2, (volts_sine_cost_0 *
        rotation_cosine_cost_2) + (volts_cosine_cost_0 * yaw_change_sine_2), B_2_3, by_axis_2_2_h_cost_2,
        (volts_sine_cost_0_2 * rotation_cosine_cost_2) + (volts_cosine_cost_0_2 * yaw_change_sine_2), B_2_4,
        then_2_cost_2, terms_7.by_axis_g, terms_8.by_axis_g);
    const float cost_2_part_5 = (gain_3.by_axis_1_e * gain_3.by_axis_1_e) + (gain_3.by_axis_2_e * gain_3.by_axis_2_e) +
        (gain_4.by_axis_1_e * gain_4.by_axis_1_e);
    const float cost_2 = cost_2_part_5 + (gain_4.by_axis_2_e * gain_4.by_axis_2_e) + (damping * ((then_1_cost_2 *
        then_1_cost_2) + (then_2_cost_2 * then_2_cost_2) + (squared_yaw_arm * yaw_change_sine_part_12)));
    const bool better_yaw_change_sine_2 = cost_2 <= ((cost_factor * yaw_change_sine_part_10) + cost_slack);
    const float yaw_change_sine_part_13 = 1.0f / (damping + (terms_5.terms + terms_6.terms));
    const float yaw_change_sine_part_14 = 1.0f / (damping + (terms_7.terms + terms_8.terms));
    const float data_yaw_change_sine_3 = (((damping * ((by_axis_1_1_h_cost_2 * by_axis_1_1_h_cost_2) +
        (by_axis_1_2_h_cost_2 * by_axis_1_2_h_cost_2))) + (gain_3.across * gain_3.across)) * yaw_change_sine_part_13) +
        (((damping * ((by_axis_2_1_h_cost_2 * by_axis_2_1_h_cost_2) + (by_axis_2_2_h_cost_2 * by_axis_2_2_h_cost_2))) +
        (gain_4.across * gain_4.across)) * yaw_change_sine_part_14);
    float other_3_yaw_change_sine_2 = then_3_yaw_change_sine_2;
    float other_1_cost_3 = then_1_cost_2;
    float other_2_cost_3 = then_2_cost_2;
    float yaw_change_sine_part_15 = cost_2;
    if (!better_yaw_change_sine_2) {
        other_3_yaw_change_sine_2 = other_3_yaw_change_sine;
        other_1_cost_3 = other_1_cost_2;
        other_2_cost_3 = other_2_cost_2;
        yaw_change_sine_part_15 = yaw_change_sine_part_10;
    }
    const float yaw_change_sine_part_16 = (better_yaw_change_sine_2) ? (then_3_yaw_change_sine_2 + (((gain_3.gain *
        yaw_change_sine_part_13) + (gain_4.gain * yaw_change_sine_part_14) - (yaw_damping * then_3_yaw_change_sine_2)) /
        (yaw_damping + data_yaw_change_sine_3))) : (0.5f * (then_3_yaw_change_sine_2 + other_3_yaw_change_sine_2));
    const float then_3_yaw_change_sine_3 = hall_position_limit(yaw_change_sine_part_16, max_yaw_step);
    const float yaw_change_sine_part_17 = then_3_yaw_change_sine_3 * then_3_yaw_change_sine_3;
    const float yaw_change_sine_3 = then_3_yaw_change_sine_3 * yaw_change_sine_polynomial(yaw_change_sine_part_17);
    const float half_yaw_change_sine_3 = then_3_yaw_change_sine_3 *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_17);
    const float yaw_change_cost_3 = then_3_yaw_change_sine_3 - then_3_yaw_change_sine_2;
    const float cost_3_part = (terms_7.by_axis_g * gain_4.by_axis_1_e) + (terms_8.by_axis_g * gain_4.by_axis_2_e) -
        (damping * then_2_cost_2) - (gain_4.coupling * yaw_change_cost_3);
    const float then_2_cost_3 = hall_position_limit((better_yaw_change_sine_2) ? (then_2_cost_2 + (cost_3_part *
        yaw_change_sine_part_14)) : (0.5f * (then_2_cost_2 + other_2_cost_3)), 0.5f);
    const float versine_cost_3 = half_yaw_change_sine_3 * half_yaw_change_sine_3;
    const float dy_cost_3 = (x_cost_0 * yaw_change_sine_3) - (y_cost_0 * versine_cost_3);
    const hall_position_terms_t terms_11 = hall_position_terms(terms_3_2.cosine, then_2_cost_3 + dy_cost_3,
        terms_3_2.sine);
    const float B_2_5 = hall_position_B(terms_11.sine_2, terms_11.sine_squared);
    const float cost_3_part_2 = (terms_5.by_axis_g * gain_3.by_axis_1_e) + (terms_6.by_axis_g * gain_3.by_axis_2_e) -
        (damping * then_1_cost_2) - (gain_3.coupling * yaw_change_cost_3);
    const float then_1_cost_3 = hall_position_limit((better_yaw_change_sine_2) ? (then_1_cost_2 + (cost_3_part_2 *
        yaw_change_sine_part_13)) : (0.5f * (then_1_cost_2 + other_1_cost_3)), 0.5f);
    const float cost_3_part_3 = (x_cost_0 * versine_cost_3) + (y_cost_0 * yaw_change_sine_3);
    const hall_position_terms_t terms_9 = hall_position_terms(terms_1_2.cosine, then_1_cost_3 - cost_3_part_3,
        terms_1_2.sine);
    const float by_axis_1_1_h_cost_3 = B_2_5 - (terms_9.by_axis_g * (y_cost_0 + dy_cost_3));
    const float rotation_cosine_cost_3 = 1.0f - versine_cost_3;
    const float B_1_5 = hall_position_B(terms_9.sine_2, terms_9.sine_squared);
    const float dy_cost_3_2 = (x_cost_0_2 * yaw_change_sine_3) - (y_cost_0_2 * versine_cost_3);
    const hall_position_terms_t terms_12 = hall_position_terms(terms_4_2.cosine, then_2_cost_3 + dy_cost_3_2,
        terms_4_2.sine);
    const float B_2_6 = hall_position_B(terms_12.sine_2, terms_12.sine_squared);
    const float cost_3_part_4 = (x_cost_0_2 * versine_cost_3) + (y_cost_0_2 * yaw_change_sine_3);
    const hall_position_terms_t terms_10 = hall_position_terms(terms_2_2.cosine, then_1_cost_3 - cost_3_part_4,
        terms_2_2.sine);
    const float by_axis_1_2_h_cost_3 = B_2_6 - (terms_10.by_axis_g * (y_cost_0_2 + dy_cost_3_2));
    const float B_1_6 = hall_position_B(terms_10.sine_2, terms_10.sine_squared);
    const hall_position_gain_t gain_5 = hall_position_gain(by_axis_1_1_h_cost_3, (volts_cosine_cost_0 *
        rotation_cosine_cost_3) - (volts_sine_cost_0 * yaw_change_sine_3), B_1_5, by_axis_1_2_h_cost_3,
        (volts_cosine_cost_0_2 * rotation_cosine_cost_3) - (volts_sine_cost_0_2 * yaw_change_sine_3), B_1_6,
        then_1_cost_3, terms_9.by_axis_g, terms_10.by_axis_g);
    const float by_axis_2_1_h_cost_3 = (terms_11.by_axis_g * (x_cost_0 - cost_3_part_3)) - B_1_5;
    const float by_axis_2_2_h_cost_3 = (terms_12.by_axis_g * (x_cost_0_2 - cost_3_part_4)) - B_1_6;
    const hall_position_gain_t gain_6 = hall_position_gain(by_axis_2_1_h_cost_3, (volts_sine_cost_0 *
        rotation_cosine_cost_3) + (volts_cosine_cost_0 * yaw_change_sine_3), B_2_5, by_axis_2_2_h_cost_3,
        (volts_sine_cost_0_2 * rotation_cosine_cost_3) + (volts_cosine_cost_0_2 * yaw_change_sine_3), B_2_6,
        then_2_cost_3, terms_11.by_axis_g, terms_12.by_axis_g);
    const float cost_3_part_5 = (gain_5.by_axis_1_e * gain_5.by_axis_1_e) + (gain_5.by_axis_2_e * gain_5.by_axis_2_e) +
        (gain_6.by_axis_1_e * gain_6.by_axis_1_e);
    const float cost_3 = cost_3_part_5 + (gain_6.by_axis_2_e * gain_6.by_axis_2_e) + (damping * ((then_1_cost_3 *
        then_1_cost_3) + (then_2_cost_3 * then_2_cost_3) + (squared_yaw_arm * yaw_change_sine_part_17)));
    const bool better_yaw_change_sine_3 = cost_3 <= ((cost_factor * yaw_change_sine_part_15) + cost_slack);
    const float yaw_change_sine_part_18 = 1.0f / (damping + (terms_9.terms + terms_10.terms));
    const float yaw_change_sine_part_19 = 1.0f / (damping + (terms_11.terms + terms_12.terms));
    const float data_yaw_change_sine_4 = (((damping * ((by_axis_1_1_h_cost_3 * by_axis_1_1_h_cost_3) +
        (by_axis_1_2_h_cost_3 * by_axis_1_2_h_cost_3))) + (gain_5.across * gain_5.across)) * yaw_change_sine_part_18) +
        (((damping * ((by_axis_2_1_h_cost_3 * by_axis_2_1_h_cost_3) + (by_axis_2_2_h_cost_3 * by_axis_2_2_h_cost_3))) +
        (gain_6.across * gain_6.across)) * yaw_change_sine_part_19);
    float other_3_yaw_change_sine_3 = then_3_yaw_change_sine_3;
    float other_1_cost_4 = then_1_cost_3;
    float other_2_cost_4 = then_2_cost_3;
    float converged_part = cost_3;
    if (!better_yaw_change_sine_3) {
        other_3_yaw_change_sine_3 = other_3_yaw_change_sine_2;
        other_1_cost_4 = other_1_cost_3;
        other_2_cost_4 = other_2_cost_3;
        converged_part = yaw_change_sine_part_15;
    }
    const float yaw_change_sine_part_20 = (better_yaw_change_sine_3) ? (then_3_yaw_change_sine_3 + (((gain_5.gain *
        yaw_change_sine_part_18) + (gain_6.gain * yaw_change_sine_part_19) - (yaw_damping * then_3_yaw_change_sine_3)) /
        (yaw_damping + data_yaw_change_sine_4))) : (0.5f * (then_3_yaw_change_sine_3 + other_3_yaw_change_sine_3));
    const float at_3_yaw_change_sine = hall_position_limit(yaw_change_sine_part_20, max_yaw_step);
    const float at_3_yaw_change_sine_squared = at_3_yaw_change_sine * at_3_yaw_change_sine;
    const float yaw_change_sine_4 = at_3_yaw_change_sine * yaw_change_sine_polynomial(at_3_yaw_change_sine_squared);
    const float half_yaw_change_sine_4 = at_3_yaw_change_sine *
        half_yaw_change_sine_polynomial(at_3_yaw_change_sine_squared);
    const float yaw_change_cost_4 = at_3_yaw_change_sine - then_3_yaw_change_sine_3;
    const float cost_4_part = (terms_11.by_axis_g * gain_6.by_axis_1_e) + (terms_12.by_axis_g * gain_6.by_axis_2_e) -
        (damping * then_2_cost_3) - (gain_6.coupling * yaw_change_cost_4);
    const float at_2_cost_4 = hall_position_limit((better_yaw_change_sine_3) ? (then_2_cost_3 + (cost_4_part *
        yaw_change_sine_part_19)) : (0.5f * (then_2_cost_3 + other_2_cost_4)), 0.5f);
    const float versine_cost_4 = half_yaw_change_sine_4 * half_yaw_change_sine_4;
    const float dy_cost_4 = (x_cost_0 * yaw_change_sine_4) - (y_cost_0 * versine_cost_4);
    const hall_position_terms_t terms_15 = hall_position_terms(terms_3_2.cosine, at_2_cost_4 + dy_cost_4,
        terms_3_2.sine);
    const float B_2_7 = hall_position_B(terms_15.sine_2, terms_15.sine_squared);
    const float cost_4_part_2 = (terms_9.by_axis_g * gain_5.by_axis_1_e) + (terms_10.by_axis_g * gain_5.by_axis_2_e) -
        (damping * then_1_cost_3) - (gain_5.coupling * yaw_change_cost_4);
    const float at_1_cost_4 = hall_position_limit((better_yaw_change_sine_3) ? (then_1_cost_3 + (cost_4_part_2 *
        yaw_change_sine_part_18)) : (0.5f * (then_1_cost_3 + other_1_cost_4)), 0.5f);
    const float cost_4_part_3 = (x_cost_0 * versine_cost_4) + (y_cost_0 * yaw_change_sine_4);
    const hall_position_terms_t terms_13 = hall_position_terms(terms_1_2.cosine, at_1_cost_4 - cost_4_part_3,
        terms_1_2.sine);
    const float by_axis_1_1_h_cost_4 = B_2_7 - (terms_13.by_axis_g * (y_cost_0 + dy_cost_4));
    const float rotation_cosine_cost_4 = 1.0f - versine_cost_4;
    const float B_1_7 = hall_position_B(terms_13.sine_2, terms_13.sine_squared);
    const float dy_cost_4_2 = (x_cost_0_2 * yaw_change_sine_4) - (y_cost_0_2 * versine_cost_4);
    const hall_position_terms_t terms_16 = hall_position_terms(terms_4_2.cosine, at_2_cost_4 + dy_cost_4_2,
        terms_4_2.sine);
    const float B_2_8 = hall_position_B(terms_16.sine_2, terms_16.sine_squared);
    const float cost_4_part_4 = (x_cost_0_2 * versine_cost_4) + (y_cost_0_2 * yaw_change_sine_4);
    const hall_position_terms_t terms_14 = hall_position_terms(terms_2_2.cosine, at_1_cost_4 - cost_4_part_4,
        terms_2_2.sine);
    const float by_axis_1_2_h_cost_4 = B_2_8 - (terms_14.by_axis_g * (y_cost_0_2 + dy_cost_4_2));
    const float B_1_8 = hall_position_B(terms_14.sine_2, terms_14.sine_squared);
    const hall_position_gain_t gain_7 = hall_position_gain(by_axis_1_1_h_cost_4, (volts_cosine_cost_0 *
        rotation_cosine_cost_4) - (volts_sine_cost_0 * yaw_change_sine_4), B_1_7, by_axis_1_2_h_cost_4,
        (volts_cosine_cost_0_2 * rotation_cosine_cost_4) - (volts_sine_cost_0_2 * yaw_change_sine_4), B_1_8,
        at_1_cost_4, terms_13.by_axis_g, terms_14.by_axis_g);
    const float by_axis_2_1_h_cost_4 = (terms_15.by_axis_g * (x_cost_0 - cost_4_part_3)) - B_1_7;
    const float by_axis_2_2_h_cost_4 = (terms_16.by_axis_g * (x_cost_0_2 - cost_4_part_4)) - B_1_8;
    const hall_position_gain_t gain_8 = hall_position_gain(by_axis_2_1_h_cost_4, (volts_sine_cost_0 *
        rotation_cosine_cost_4) + (volts_cosine_cost_0 * yaw_change_sine_4), B_2_7, by_axis_2_2_h_cost_4,
        (volts_sine_cost_0_2 * rotation_cosine_cost_4) + (volts_cosine_cost_0_2 * yaw_change_sine_4), B_2_8,
        at_2_cost_4, terms_15.by_axis_g, terms_16.by_axis_g);
    const float cost_4_part_5 = (gain_7.by_axis_1_e * gain_7.by_axis_1_e) + (gain_7.by_axis_2_e * gain_7.by_axis_2_e) +
        (gain_8.by_axis_1_e * gain_8.by_axis_1_e);
    const float squares_cost_4 = cost_4_part_5 + (gain_8.by_axis_2_e * gain_8.by_axis_2_e);
    const float cost_4_part_6 = (at_1_cost_4 * at_1_cost_4) + (at_2_cost_4 * at_2_cost_4);
    const float cost_4 = squares_cost_4 + (damping * (cost_4_part_6 + (squared_yaw_arm *
        at_3_yaw_change_sine_squared)));
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const bool gate_exceeded = squared_gate < (cost_4_part_6 + (squared_radius * at_3_yaw_change_sine_squared));
    const uint32_t estimator_searching = state->estimator_searching;
    const bool better_converged = cost_4 <= ((cost_factor * converged_part) + cost_slack);
    const float axes_1_inverse = 1.0f / (damping + (terms_13.terms + terms_14.terms));
    const float n_inverse = 1.0f / (damping + (terms_15.terms + terms_16.terms));
    const float right_converged = (gain_7.gain * axes_1_inverse) + (gain_8.gain * n_inverse) - (yaw_damping *
        at_3_yaw_change_sine);
    const float data_converged = (((damping * ((by_axis_1_1_h_cost_4 * by_axis_1_1_h_cost_4) + (by_axis_1_2_h_cost_4 *
        by_axis_1_2_h_cost_4))) + (gain_7.across * gain_7.across)) * axes_1_inverse) + (((damping *
        ((by_axis_2_1_h_cost_4 * by_axis_2_1_h_cost_4) + (by_axis_2_2_h_cost_4 * by_axis_2_2_h_cost_4))) +
        (gain_8.across * gain_8.across)) * n_inverse);
    const float converged_part_2 = 1.0f / (yaw_damping + data_converged);
    const float axes_1_slope_converged = (terms_13.by_axis_g * gain_7.by_axis_1_e) + (terms_14.by_axis_g *
        gain_7.by_axis_2_e) - (damping * at_1_cost_4);
    const float n_slope = (terms_15.by_axis_g * gain_8.by_axis_1_e) + (terms_16.by_axis_g * gain_8.by_axis_2_e) -
        (damping * at_2_cost_4);
    const bool converged = better_converged && (((right_converged * right_converged * converged_part_2) +
        (axes_1_slope_converged * axes_1_slope_converged * axes_1_inverse) + (n_slope * n_slope * n_inverse)) <=
        cost_slack);
    float at_3_X;
    float at_1_X;
    float at_2_Y;
    if (converged) {
        const float untried_3 = hall_position_limit(at_3_yaw_change_sine + (right_converged * converged_part_2),
            max_yaw_step);
        at_3_X = untried_3;
        const float yaw_change_X = untried_3 - at_3_yaw_change_sine;
        at_1_X = hall_position_limit(at_1_cost_4 + ((axes_1_slope_converged - (gain_7.coupling * yaw_change_X)) *
            axes_1_inverse), 0.5f);
        at_2_Y = hall_position_limit(at_2_cost_4 + ((n_slope - (gain_8.coupling * yaw_change_X)) * n_inverse), 0.5f);
    } else {
        if (better_converged) {
            at_3_X = at_3_yaw_change_sine;
            at_1_X = at_1_cost_4;
            at_2_Y = at_2_cost_4;
        } else {
            at_3_X = other_3_yaw_change_sine_3;
            at_1_X = other_1_cost_4;
            at_2_Y = other_2_cost_4;
        }
    }
    const float estimator_yaw_last_good = state->estimator_yaw_last_good;
    const bool in_window = fabsf(prediction_yaw + at_3_X - estimator_yaw_last_good) <= ambiguous_yaw_limit;
    const bool integrity_residual_fault = (squared_residual_limit < squares_cost_4) || ((estimator_ambiguity_resolved !=
        0u) ? gate_exceeded : ((estimator_searching != 0u) && !in_window));
    const bool tracking = estimator_searching == 0u;
    float by_phase_x = 0.0f;
    float by_phase_y = 0.0f;
    float yaw_2 = 0.0f;
    float estimator_motion_x_part = 0.0f;
    float estimator_motion_y_part = 0.0f;
    float estimator_motion_yaw_part = 0.0f;
    if (!(integrity_residual_fault && tracking)) {
        by_phase_x = at_1_X;
        by_phase_y = at_2_Y;
        yaw_2 = at_3_X;
        estimator_motion_x_part = 0.5f * at_1_X;
        estimator_motion_y_part = 0.5f * at_2_Y;
        estimator_motion_yaw_part = yaw_gain * at_3_X;
    }
    const float X_part = prediction_phase_x + by_phase_x;
    const bool turns_X = pi < X_part;
    float angle_X = X_part;
    if (turns_X) {
        angle_X = X_part - two_pi;
    }
    float pose_phase_x = angle_X;
    float turns_x = -1.0f;
    if (angle_X < -pi) {
        pose_phase_x = angle_X + two_pi;
    } else {
        turns_x = turns_X ? 1.0f : 0.0f;
    }
    const float pose_pitch_x = state->estimator_pitch_x + turns_x;
    const float X = (metre_per_rad * pose_phase_x) + (pitch * pose_pitch_x);
    const float Y_part = prediction_phase_y + by_phase_y;
    const bool turns_Y = pi < Y_part;
    float angle_Y = Y_part;
    if (turns_Y) {
        angle_Y = Y_part - two_pi;
    }
    float pose_phase_y = angle_Y;
    float turns_y = -1.0f;
    if (angle_Y < -pi) {
        pose_phase_y = angle_Y + two_pi;
    } else {
        turns_y = turns_Y ? 1.0f : 0.0f;
    }
    const float pose_pitch_y = state->estimator_pitch_y + turns_y;
    const float Y = (metre_per_rad * pose_phase_y) + (pitch * pose_pitch_y);
    const float prediction_yaw_plus_yaw_2 = prediction_yaw + yaw_2;
    float angle_yaw = prediction_yaw_plus_yaw_2;
    if (pi < prediction_yaw_plus_yaw_2) {
        angle_yaw = prediction_yaw_plus_yaw_2 - two_pi;
    }
    float yaw = angle_yaw;
    if (angle_yaw < -pi) {
        yaw = angle_yaw + two_pi;
    }
    const float by_yaw_X = gain_7.coupling * axes_1_inverse;
    const float by_yaw_X_squared = by_yaw_X * by_yaw_X;
    const float yaw_deviation_X = 1.0f / (data_converged + undamped_yaw);
    const float deviation_X = deviation_over_w * sqrtf(axes_1_inverse + (by_yaw_X_squared * yaw_deviation_X));
    out->deviation_X = deviation_X;
    const float by_yaw_Y = gain_8.coupling * n_inverse;
    const float by_yaw_Y_squared = by_yaw_Y * by_yaw_Y;
    const float deviation_Y = deviation_over_w * sqrtf(n_inverse + (by_yaw_Y_squared * yaw_deviation_X));
    out->deviation_Y = deviation_Y;
    const float deviation_yaw = deviation * sqrtf(yaw_deviation_X);
    out->deviation_yaw = deviation_yaw;
    const float residual = sqrtf(least_square + squares_cost_4);
    out->residual = residual;
    out->X = X;
    out->Y = Y;
    out->yaw = yaw;
    out->converged = converged ? 1.0f : 0.0f;
    const float weight = ((squared_radius + by_yaw_X_squared + by_yaw_Y_squared) * yaw_deviation_X) + (axes_1_inverse +
        n_inverse);
    const bool damped = damped_weight < weight;
    out->damped = damped ? 1.0f : 0.0f;
    const bool integrity_good = converged && !(damped || integrity_residual_fault || gate_exceeded);
    const bool counted = (fabsf(pose_pitch_x) <= 8.0f) && (fabsf(pose_pitch_y) <= 8.0f);
    const float size = fabsf(yaw);
    const bool inside = counted && (size <= yaw_limit);
    const bool resolved = (integrity_good && in_window && tracking && (weight <= unambiguous_weight) && complete &&
        inside) || ((estimator_ambiguity_resolved != 0u) && !damped);
    const uint32_t estimator_lock_lost = state->estimator_lock_lost;
    const bool valid = integrity_good && resolved && (estimator_lock_lost == 0u) && inside && complete;
    const uint32_t estimator_residual_faults = state->estimator_residual_faults;
    const bool exhausted = 4u <= estimator_residual_faults;
    const bool restart = integrity_residual_fault && exhausted;
    const bool estimator_yaw_last_good_test = !integrity_residual_fault;
    if (restart) {
        const float start_x = state->estimator_start_x + -start_step_x;
        if (start_x < -pi) {
            state->estimator_phase_x = start_x + two_pi;
            state->estimator_start_x = state->estimator_phase_x;
        } else {
            state->estimator_phase_x = start_x;
            state->estimator_start_x = start_x;
        }
        const float start_y = state->estimator_start_y + -start_step_y;
        if (start_y < -pi) {
            state->estimator_phase_y = start_y + two_pi;
            state->estimator_start_y = state->estimator_phase_y;
        } else {
            state->estimator_phase_y = start_y;
            state->estimator_start_y = start_y;
        }
        state->estimator_yaw = estimator_yaw_last_good;
        state->estimator_searching = 1u;
        state->estimator_ambiguity_resolved = 0u;
    } else {
        state->estimator_phase_x = pose_phase_x;
        state->estimator_phase_y = pose_phase_y;
        state->estimator_yaw = yaw;
        if (converged && estimator_yaw_last_good_test) {
            state->estimator_searching = 0u;
        }
        state->estimator_ambiguity_resolved = hall_position_flag(resolved);
    }
    if (resolved && estimator_yaw_last_good_test) {
        state->estimator_yaw_last_good = yaw;
    }
    state->estimator_pitch_x = hall_position_limit(pose_pitch_x, 8.0f);
    state->estimator_pitch_y = hall_position_limit(pose_pitch_y, 8.0f);
    float estimator_motion_x_part_2 = 0.0f;
    float estimator_motion_y_part_2 = 0.0f;
    float estimator_motion_yaw_part_2 = 0.0f;
    if (estimator_searching == 0u) {
        estimator_motion_x_part_2 = estimator_motion_x + estimator_motion_x_part;
        estimator_motion_y_part_2 = estimator_motion_y + estimator_motion_y_part;
        estimator_motion_yaw_part_2 = estimator_motion_yaw + estimator_motion_yaw_part;
    }
    state->estimator_motion_x = hall_position_limit(estimator_motion_x_part_2, 0.5f);
    state->estimator_motion_y = hall_position_limit(estimator_motion_y_part_2, 0.5f);
    state->estimator_motion_yaw = hall_position_limit(estimator_motion_yaw_part_2, max_yaw_step);
    state->estimator_residual_faults = (integrity_residual_fault) ? ((exhausted) ? 0u : (estimator_residual_faults +
        1u)) : 0u;
    const uint32_t estimator_acquired = state->estimator_acquired;
    state->estimator_acquired = hall_position_flag(resolved || (estimator_acquired != 0u));
    state->estimator_lock_lost = hall_position_flag((estimator_lock_lost != 0u) || ((estimator_acquired != 0u) &&
        (restart || !counted || (((resolved) ? yaw_limit : ambiguous_yaw_limit) < size))));
    out->valid = valid ? 1.0f : 0.0f;
    out->lock_lost = (float)estimator_lock_lost;

    return faults;
}
