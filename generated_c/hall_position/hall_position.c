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
static inline float f3_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551866f + (t * (2.5417654e-07f + (t * -9.166732e-11f)))));
}

/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * clamp((clamp((4 * (...)), -2, 2)
 * * (1 - (0.125 * (...)))), -1, 1)) - (2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2)))))) in
 * -8.35398197 .. 8.35398293, t = x^2; relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.0078124995f + (t * (1.0172464e-05f + (t * (-5.295563e-09f + (t * 1.434358e-12f)))))));
}

/* f5_polynomial / x; x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) *
 * clamp((...), -2, 2))))) - (2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -8.35398293 .. 8.35398197, t = x^2; relative error at most 1.5e-07. */
static inline float f5_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551866f + (t * (2.5417654e-07f + (t * -9.166732e-11f)))));
}

/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * (1 - (0.5 * (clamp((...), -2, 2)
 * * clamp((...), -2, 2))))) - (2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -8.35398293 .. 8.35398197, t = x^2; relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_2_polynomial(float t)
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
    /* rad; w times the place of sensor a from the centre, along x, also arm_ax, also arm_ay, also arm_bx, also
     * arm_by */
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
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_0 = 2.24906f;
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_2 = 10.81368f;
    /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_4 = -14.41824f;

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
    const float estimator_motion_x = state->estimator_motion_x;
    const float prediction_phase_x = state->estimator_phase_x + estimator_motion_x;
    const float s_phase_fraction_sine = hall_position_limit(4.0f * (f1 * yaw_fraction_cosine), 2.0f);
    const float heading_sine = hall_position_limit(s_phase_fraction_sine * (1.0f -
        (0.125f * (yaw_fraction_sine * yaw_fraction_sine))), 1.0f);
    const float arm_times_heading_sine = -arm * heading_sine;
    const float heading_cosine = 1.0f - (0.5f * (s_phase_fraction_sine * s_phase_fraction_sine));
    const float arm_times_heading_cosine = -arm * heading_cosine;
    const float x_phase_fraction_sine = arm_times_heading_sine - arm_times_heading_cosine;
    const float at_1_phase_fraction_sine = prediction_phase_x + x_phase_fraction_sine;
    const float f3_argument = at_1_phase_fraction_sine * at_1_phase_fraction_sine;
    const float f3 = at_1_phase_fraction_sine * f3_polynomial(f3_argument);
    const float phase_fraction_sine = 8.0f * f3;
    const float phase_fraction_cosine = phase_fraction_cosine_polynomial(f3_argument);
    const float estimator_motion_y = state->estimator_motion_y;
    const float prediction_phase_y = state->estimator_phase_y + estimator_motion_y;
    const float y_phase_fraction_sine = (arm * heading_sine) - arm_times_heading_cosine;
    const float at_2_phase_fraction_sine = prediction_phase_y + y_phase_fraction_sine;
    const float f3_argument_2 = at_2_phase_fraction_sine * at_2_phase_fraction_sine;
    const float f3_2 = at_2_phase_fraction_sine * f3_polynomial(f3_argument_2);
    const float phase_fraction_sine_2 = 8.0f * f3_2;
    const float phase_fraction_cosine_2 = phase_fraction_cosine_polynomial(f3_argument_2);
    const float x_phase_fraction_sine_2 = arm_times_heading_cosine - arm_times_heading_sine;
    const float at_1_phase_fraction_sine_2 = prediction_phase_x + x_phase_fraction_sine_2;
    const float f5_argument = at_1_phase_fraction_sine_2 * at_1_phase_fraction_sine_2;
    const float f5 = at_1_phase_fraction_sine_2 * f5_polynomial(f5_argument);
    const float phase_fraction_sine_3 = 8.0f * f5;
    const float phase_fraction_cosine_3 = phase_fraction_cosine_2_polynomial(f5_argument);
    const float y_phase_fraction_sine_2 = arm_times_heading_sine + arm_times_heading_cosine;
    const float at_2_phase_fraction_sine_2 = prediction_phase_y + y_phase_fraction_sine_2;
    const float f5_argument_2 = at_2_phase_fraction_sine_2 * at_2_phase_fraction_sine_2;
    const float f5_2 = at_2_phase_fraction_sine_2 * f5_polynomial(f5_argument_2);
    const float phase_fraction_sine_4 = 8.0f * f5_2;
    const float phase_fraction_cosine_4 = phase_fraction_cosine_2_polynomial(f5_argument_2);
    const float volts_cosine_cost_0 = (heading_cosine * V_ax_held) - (heading_sine * V_ay_held);
    const float cost_0_part = f3 * phase_fraction_cosine;
    const float s_cost_0 = hall_position_limit(8.0f *
        (cost_0_part * (1.0f - (0.03125f * (phase_fraction_sine * phase_fraction_sine)))), 2.0f);
    const float sines_2_cost_0 = 8.0f * cost_0_part;
    const float x_sine_cost_0 = hall_position_limit(s_cost_0 * (1.0f - (0.125f * (sines_2_cost_0 * sines_2_cost_0))),
        1.0f);
    const float x_sine_cost_0_squared = x_sine_cost_0 * x_sine_cost_0;
    const float B_1_cost_0 = x_sine_cost_0 * (estimator_field_1 +
        (x_sine_cost_0_squared * (estimator_field_3 + (x_sine_cost_0_squared * estimator_field_5))));
    const float by_axis_1_1_e_cost_0 = volts_cosine_cost_0 - B_1_cost_0;
    const float volts_cosine_cost_0_2 = (heading_cosine * V_bx_held) - (heading_sine * V_by_held);
    const float cost_0_part_2 = f5 * phase_fraction_cosine_3;
    const float s_cost_0_2 = hall_position_limit(8.0f *
        (cost_0_part_2 * (1.0f - (0.03125f * (phase_fraction_sine_3 * phase_fraction_sine_3)))), 2.0f);
    const float sines_2_cost_0_2 = 8.0f * cost_0_part_2;
    const float x_sine_cost_0_2 = hall_position_limit(s_cost_0_2 * (1.0f -
        (0.125f * (sines_2_cost_0_2 * sines_2_cost_0_2))), 1.0f);
    const float x_sine_cost_0_2_squared = x_sine_cost_0_2 * x_sine_cost_0_2;
    const float B_1_cost_0_2 = x_sine_cost_0_2 * (estimator_field_1 +
        (x_sine_cost_0_2_squared * (estimator_field_3 + (x_sine_cost_0_2_squared * estimator_field_5))));
    const float by_axis_1_2_e_cost_0 = volts_cosine_cost_0_2 - B_1_cost_0_2;
    const float volts_sine_cost_0 = (heading_sine * V_ax_held) + (heading_cosine * V_ay_held);
    const float cost_0_part_3 = f3_2 * phase_fraction_cosine_2;
    const float s_cost_0_3 = hall_position_limit(8.0f *
        (cost_0_part_3 * (1.0f - (0.03125f * (phase_fraction_sine_2 * phase_fraction_sine_2)))), 2.0f);
    const float sines_2_cost_0_3 = 8.0f * cost_0_part_3;
    const float p_sine_cost_0 = hall_position_limit(s_cost_0_3 * (1.0f -
        (0.125f * (sines_2_cost_0_3 * sines_2_cost_0_3))), 1.0f);
    const float q_cost_0 = p_sine_cost_0 * p_sine_cost_0;
    const float B_2_cost_0 = p_sine_cost_0 * (estimator_field_1 +
        (q_cost_0 * (estimator_field_3 + (q_cost_0 * estimator_field_5))));
    const float by_axis_2_1_e_cost_0 = volts_sine_cost_0 - B_2_cost_0;
    const float volts_sine_cost_0_2 = (heading_sine * V_bx_held) + (heading_cosine * V_by_held);
    const float cost_0_part_4 = f5_2 * phase_fraction_cosine_4;
    const float s_cost_0_4 = hall_position_limit(8.0f *
        (cost_0_part_4 * (1.0f - (0.03125f * (phase_fraction_sine_4 * phase_fraction_sine_4)))), 2.0f);
    const float sines_2_cost_0_4 = 8.0f * cost_0_part_4;
    const float p_sine_cost_0_2 = hall_position_limit(s_cost_0_4 * (1.0f -
        (0.125f * (sines_2_cost_0_4 * sines_2_cost_0_4))), 1.0f);
    const float q_cost_0_2 = p_sine_cost_0_2 * p_sine_cost_0_2;
    const float B_2_cost_0_2 = p_sine_cost_0_2 * (estimator_field_1 +
        (q_cost_0_2 * (estimator_field_3 + (q_cost_0_2 * estimator_field_5))));
    const float by_axis_2_2_e_cost_0 = volts_sine_cost_0_2 - B_2_cost_0_2;
    const float cost_0 = (by_axis_1_1_e_cost_0 * by_axis_1_1_e_cost_0) + (by_axis_1_2_e_cost_0 * by_axis_1_2_e_cost_0) +
        (by_axis_2_1_e_cost_0 * by_axis_2_1_e_cost_0) + (by_axis_2_2_e_cost_0 * by_axis_2_2_e_cost_0);
    const float x_cosine_yaw_change_sine = 1.0f - (0.5f * (s_cost_0 * s_cost_0));
    const float yaw_change_sine_part = x_cosine_yaw_change_sine * (estimator_slope_0 +
        (x_sine_cost_0_squared * (estimator_slope_2 + (x_sine_cost_0_squared * estimator_slope_4))));
    const float yaw_change_sine_part_2 = B_2_cost_0 - (yaw_change_sine_part * y_phase_fraction_sine);
    const float x_cosine_yaw_change_sine_2 = 1.0f - (0.5f * (s_cost_0_2 * s_cost_0_2));
    const float yaw_change_sine_part_3 = x_cosine_yaw_change_sine_2 * (estimator_slope_0 +
        (x_sine_cost_0_2_squared * (estimator_slope_2 + (x_sine_cost_0_2_squared * estimator_slope_4))));
    const float yaw_change_sine_part_4 = B_2_cost_0_2 - (yaw_change_sine_part_3 * y_phase_fraction_sine_2);
    const float across_yaw_change_sine = (yaw_change_sine_part * yaw_change_sine_part_4) -
        (yaw_change_sine_part_3 * yaw_change_sine_part_2);
    const float yaw_change_sine_part_5 = 1.0f /
        (damping + ((yaw_change_sine_part * yaw_change_sine_part) + (yaw_change_sine_part_3 * yaw_change_sine_part_3)));
    const float p_cosine_yaw_change_sine = 1.0f - (0.5f * (s_cost_0_3 * s_cost_0_3));
    const float yaw_change_sine_part_6 = p_cosine_yaw_change_sine * (estimator_slope_0 +
        (q_cost_0 * (estimator_slope_2 + (q_cost_0 * estimator_slope_4))));
    const float yaw_change_sine_part_7 = (yaw_change_sine_part_6 * x_phase_fraction_sine) - B_1_cost_0;
    const float p_cosine_yaw_change_sine_2 = 1.0f - (0.5f * (s_cost_0_4 * s_cost_0_4));
    const float yaw_change_sine_part_8 = p_cosine_yaw_change_sine_2 * (estimator_slope_0 +
        (q_cost_0_2 * (estimator_slope_2 + (q_cost_0_2 * estimator_slope_4))));
    const float yaw_change_sine_part_9 = (yaw_change_sine_part_8 * x_phase_fraction_sine_2) - B_1_cost_0_2;
    const float across_yaw_change_sine_2 = (yaw_change_sine_part_6 * yaw_change_sine_part_9) -
        (yaw_change_sine_part_8 * yaw_change_sine_part_7);
    const float yaw_change_sine_part_10 = 1.0f / (damping +
        ((yaw_change_sine_part_6 * yaw_change_sine_part_6) + (yaw_change_sine_part_8 * yaw_change_sine_part_8)));
    const float right_yaw_change_sine = (((damping * ((yaw_change_sine_part_2 * by_axis_1_1_e_cost_0) +
        (yaw_change_sine_part_4 * by_axis_1_2_e_cost_0))) + (across_yaw_change_sine * ((yaw_change_sine_part *
        by_axis_1_2_e_cost_0) - (yaw_change_sine_part_3 * by_axis_1_1_e_cost_0)))) * yaw_change_sine_part_5) +
        (((damping * ((yaw_change_sine_part_7 * by_axis_2_1_e_cost_0) + (yaw_change_sine_part_9 *
        by_axis_2_2_e_cost_0))) + (across_yaw_change_sine_2 * ((yaw_change_sine_part_6 * by_axis_2_2_e_cost_0) -
        (yaw_change_sine_part_8 * by_axis_2_1_e_cost_0)))) * yaw_change_sine_part_10);
    const float data_yaw_change_sine = (((damping * ((yaw_change_sine_part_2 * yaw_change_sine_part_2) +
        (yaw_change_sine_part_4 * yaw_change_sine_part_4))) + (across_yaw_change_sine * across_yaw_change_sine)) *
        yaw_change_sine_part_5) + (((damping * ((yaw_change_sine_part_7 * yaw_change_sine_part_7) +
        (yaw_change_sine_part_9 * yaw_change_sine_part_9))) + (across_yaw_change_sine_2 * across_yaw_change_sine_2)) *
        yaw_change_sine_part_10);
    const float then_3_yaw_change_sine = hall_position_limit(right_yaw_change_sine /
        (yaw_damping + data_yaw_change_sine), max_yaw_step);
    const float yaw_change_sine_part_11 = then_3_yaw_change_sine * then_3_yaw_change_sine;
    const float yaw_change_sine = then_3_yaw_change_sine * yaw_change_sine_polynomial(yaw_change_sine_part_11);
    const float half_yaw_change_sine = then_3_yaw_change_sine *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_11);
    const float versine_cost_1 = half_yaw_change_sine * half_yaw_change_sine;
    const float rotation_cosine_cost_1 = 1.0f - versine_cost_1;
    const float then_1_cost_1 = hall_position_limit(((yaw_change_sine_part * by_axis_1_1_e_cost_0) +
        (yaw_change_sine_part_3 * by_axis_1_2_e_cost_0) - (((yaw_change_sine_part * yaw_change_sine_part_2) +
        (yaw_change_sine_part_3 * yaw_change_sine_part_4)) * then_3_yaw_change_sine)) * yaw_change_sine_part_5, 0.5f);
    const float cost_1_part = (x_phase_fraction_sine * versine_cost_1) + (y_phase_fraction_sine * yaw_change_sine);
    const float angle_cost_1 = then_1_cost_1 - cost_1_part;
    const float f9_argument = angle_cost_1 * angle_cost_1;
    const float by_cosine_cost_1 = f9_polynomial(f9_argument);
    const float by_sine_cost_1 = angle_cost_1 * f10_polynomial(f9_argument);
    const float phases_1_sine_cost_1 = (x_sine_cost_0 * by_cosine_cost_1) + (x_cosine_yaw_change_sine * by_sine_cost_1);
    const float phases_1_sine_cost_1_squared = phases_1_sine_cost_1 * phases_1_sine_cost_1;
    const float B_1_cost_1 = phases_1_sine_cost_1 * (estimator_field_1 +
        (phases_1_sine_cost_1_squared * (estimator_field_3 + (phases_1_sine_cost_1_squared * estimator_field_5))));
    const float by_axis_1_1_e_cost_1 = (volts_cosine_cost_0 * rotation_cosine_cost_1) -
        (volts_sine_cost_0 * yaw_change_sine) - B_1_cost_1;
    const float cost_1_part_2 = (x_phase_fraction_sine_2 * versine_cost_1) +
        (y_phase_fraction_sine_2 * yaw_change_sine);
    const float angle_cost_1_2 = then_1_cost_1 - cost_1_part_2;
    const float f9_argument_2 = angle_cost_1_2 * angle_cost_1_2;
    const float by_cosine_cost_1_2 = f9_polynomial(f9_argument_2);
    const float by_sine_cost_1_2 = angle_cost_1_2 * f10_polynomial(f9_argument_2);
    const float phases_1_sine_cost_1_2 = (x_sine_cost_0_2 * by_cosine_cost_1_2) +
        (x_cosine_yaw_change_sine_2 * by_sine_cost_1_2);
    const float cost_1_part_3 = phases_1_sine_cost_1_2 * phases_1_sine_cost_1_2;
    const float B_1_cost_1_2 = phases_1_sine_cost_1_2 * (estimator_field_1 +
        (cost_1_part_3 * (estimator_field_3 + (cost_1_part_3 * estimator_field_5))));
    const float by_axis_1_2_e_cost_1 = (volts_cosine_cost_0_2 * rotation_cosine_cost_1) -
        (volts_sine_cost_0_2 * yaw_change_sine) - B_1_cost_1_2;
    const float then_2_cost_1 = hall_position_limit(((yaw_change_sine_part_6 * by_axis_2_1_e_cost_0) +
        (yaw_change_sine_part_8 * by_axis_2_2_e_cost_0) - (((yaw_change_sine_part_6 * yaw_change_sine_part_7) +
        (yaw_change_sine_part_8 * yaw_change_sine_part_9)) * then_3_yaw_change_sine)) * yaw_change_sine_part_10, 0.5f);
    const float dy_cost_1 = (x_phase_fraction_sine * yaw_change_sine) - (y_phase_fraction_sine * versine_cost_1);
    const float angle_cost_1_3 = then_2_cost_1 + dy_cost_1;
    const float f9_argument_3 = angle_cost_1_3 * angle_cost_1_3;
    const float by_cosine_cost_1_3 = f9_polynomial(f9_argument_3);
    const float by_sine_cost_1_3 = angle_cost_1_3 * f10_polynomial(f9_argument_3);
    const float p_sine_cost_1 = (p_sine_cost_0 * by_cosine_cost_1_3) + (p_cosine_yaw_change_sine * by_sine_cost_1_3);
    const float q_cost_1 = p_sine_cost_1 * p_sine_cost_1;
    const float B_2_cost_1 = p_sine_cost_1 * (estimator_field_1 +
        (q_cost_1 * (estimator_field_3 + (q_cost_1 * estimator_field_5))));
    const float by_axis_2_1_e_cost_1 = (volts_sine_cost_0 * rotation_cosine_cost_1) +
        (volts_cosine_cost_0 * yaw_change_sine) - B_2_cost_1;
    const float dy_cost_1_2 = (x_phase_fraction_sine_2 * yaw_change_sine) - (y_phase_fraction_sine_2 * versine_cost_1);
    const float angle_cost_1_4 = then_2_cost_1 + dy_cost_1_2;
    const float f9_argument_4 = angle_cost_1_4 * angle_cost_1_4;
    const float by_cosine_cost_1_4 = f9_polynomial(f9_argument_4);
    const float by_sine_cost_1_4 = angle_cost_1_4 * f10_polynomial(f9_argument_4);
    const float p_sine_cost_1_2 = (p_sine_cost_0_2 * by_cosine_cost_1_4) +
        (p_cosine_yaw_change_sine_2 * by_sine_cost_1_4);
    const float q_cost_1_2 = p_sine_cost_1_2 * p_sine_cost_1_2;
    const float B_2_cost_1_2 = p_sine_cost_1_2 * (estimator_field_1 +
        (q_cost_1_2 * (estimator_field_3 + (q_cost_1_2 * estimator_field_5))));
    const float by_axis_2_2_e_cost_1 = (volts_sine_cost_0_2 * rotation_cosine_cost_1) +
        (volts_cosine_cost_0_2 * yaw_change_sine) - B_2_cost_1_2;
    const float cost_1 = (by_axis_1_1_e_cost_1 * by_axis_1_1_e_cost_1) + (by_axis_1_2_e_cost_1 * by_axis_1_2_e_cost_1) +
        (by_axis_2_1_e_cost_1 * by_axis_2_1_e_cost_1) + (by_axis_2_2_e_cost_1 * by_axis_2_2_e_cost_1) +
        (damping * ((then_1_cost_1 * then_1_cost_1) + (then_2_cost_1 * then_2_cost_1) +
        (squared_yaw_arm * yaw_change_sine_part_11)));
    const bool better_yaw_change_sine = cost_1 <= ((cost_factor * cost_0) + cost_slack);
    const float yaw_change_sine_part_12 = ((x_cosine_yaw_change_sine * by_cosine_cost_1) -
        (x_sine_cost_0 * by_sine_cost_1)) * (estimator_slope_0 +
        (phases_1_sine_cost_1_squared * (estimator_slope_2 + (phases_1_sine_cost_1_squared * estimator_slope_4))));
    const float yaw_change_sine_part_13 = B_2_cost_1 - (yaw_change_sine_part_12 * (y_phase_fraction_sine + dy_cost_1));
    const float yaw_change_sine_part_14 = ((x_cosine_yaw_change_sine_2 * by_cosine_cost_1_2) -
        (x_sine_cost_0_2 * by_sine_cost_1_2)) * (estimator_slope_0 +
        (cost_1_part_3 * (estimator_slope_2 + (cost_1_part_3 * estimator_slope_4))));
    const float yaw_change_sine_part_15 = B_2_cost_1_2 -
        (yaw_change_sine_part_14 * (y_phase_fraction_sine_2 + dy_cost_1_2));
    const float yaw_change_sine_part_16 = (yaw_change_sine_part_12 * yaw_change_sine_part_13) +
        (yaw_change_sine_part_14 * yaw_change_sine_part_15);
    const float across_yaw_change_sine_3 = (yaw_change_sine_part_12 * yaw_change_sine_part_15) -
        (yaw_change_sine_part_14 * yaw_change_sine_part_13);
    const float yaw_change_sine_part_17 = 1.0f / (damping +
        ((yaw_change_sine_part_12 * yaw_change_sine_part_12) + (yaw_change_sine_part_14 * yaw_change_sine_part_14)));
    const float yaw_change_sine_part_18 = ((p_cosine_yaw_change_sine * by_cosine_cost_1_3) - (p_sine_cost_0 *
        by_sine_cost_1_3)) * (estimator_slope_0 + (q_cost_1 * (estimator_slope_2 + (q_cost_1 * estimator_slope_4))));
    const float yaw_change_sine_part_19 = (yaw_change_sine_part_18 * (x_phase_fraction_sine - cost_1_part)) -
        B_1_cost_1;
    const float yaw_change_sine_part_20 = ((p_cosine_yaw_change_sine_2 * by_cosine_cost_1_4) -
        (p_sine_cost_0_2 * by_sine_cost_1_4)) * (estimator_slope_0 +
        (q_cost_1_2 * (estimator_slope_2 + (q_cost_1_2 * estimator_slope_4))));
    const float yaw_change_sine_part_21 = (yaw_change_sine_part_20 * (x_phase_fraction_sine_2 - cost_1_part_2)) -
        B_1_cost_1_2;
    const float yaw_change_sine_part_22 = (yaw_change_sine_part_18 * yaw_change_sine_part_19) +
        (yaw_change_sine_part_20 * yaw_change_sine_part_21);
    const float across_yaw_change_sine_4 = (yaw_change_sine_part_18 * yaw_change_sine_part_21) -
        (yaw_change_sine_part_20 * yaw_change_sine_part_19);
    const float yaw_change_sine_part_23 = 1.0f / (damping +
        ((yaw_change_sine_part_18 * yaw_change_sine_part_18) + (yaw_change_sine_part_20 * yaw_change_sine_part_20)));
    const float yaw_change_sine_part_24 = (((damping * ((yaw_change_sine_part_13 * by_axis_1_1_e_cost_1) +
        (yaw_change_sine_part_15 * by_axis_1_2_e_cost_1) + (then_1_cost_1 * yaw_change_sine_part_16))) +
        (across_yaw_change_sine_3 * ((yaw_change_sine_part_12 * by_axis_1_2_e_cost_1) -
        (yaw_change_sine_part_14 * by_axis_1_1_e_cost_1)))) * yaw_change_sine_part_17) + (((damping *
        ((yaw_change_sine_part_19 * by_axis_2_1_e_cost_1) + (yaw_change_sine_part_21 * by_axis_2_2_e_cost_1) +
        (then_2_cost_1 * yaw_change_sine_part_22))) + (across_yaw_change_sine_4 * ((yaw_change_sine_part_18 *
        by_axis_2_2_e_cost_1) - (yaw_change_sine_part_20 * by_axis_2_1_e_cost_1)))) * yaw_change_sine_part_23);
    const float data_yaw_change_sine_2 = (((damping * ((yaw_change_sine_part_13 * yaw_change_sine_part_13) +
        (yaw_change_sine_part_15 * yaw_change_sine_part_15))) + (across_yaw_change_sine_3 * across_yaw_change_sine_3)) *
        yaw_change_sine_part_17) + (((damping * ((yaw_change_sine_part_19 * yaw_change_sine_part_19) +
        (yaw_change_sine_part_21 * yaw_change_sine_part_21))) + (across_yaw_change_sine_4 * across_yaw_change_sine_4)) *
        yaw_change_sine_part_23);
    float other_3_yaw_change_sine = then_3_yaw_change_sine;
    float other_1_cost_2 = then_1_cost_1;
    float other_2_cost_2 = then_2_cost_1;
    float yaw_change_sine_part_25 = cost_1;
    if (!better_yaw_change_sine) {
        other_3_yaw_change_sine = 0.0f;
        other_1_cost_2 = 0.0f;
        other_2_cost_2 = 0.0f;
        yaw_change_sine_part_25 = cost_0;
    }
    const float then_3_yaw_change_sine_2 = hall_position_limit((better_yaw_change_sine) ? (then_3_yaw_change_sine +
        ((yaw_change_sine_part_24 - (yaw_damping * then_3_yaw_change_sine)) / (yaw_damping + data_yaw_change_sine_2))) :
        (0.5f * (then_3_yaw_change_sine + other_3_yaw_change_sine)), max_yaw_step);
    const float yaw_change_sine_part_26 = then_3_yaw_change_sine_2 * then_3_yaw_change_sine_2;
    const float yaw_change_sine_2 = then_3_yaw_change_sine_2 * yaw_change_sine_polynomial(yaw_change_sine_part_26);
    const float half_yaw_change_sine_2 = then_3_yaw_change_sine_2 *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_26);
    const float versine_cost_2 = half_yaw_change_sine_2 * half_yaw_change_sine_2;
    const float rotation_cosine_cost_2 = 1.0f - versine_cost_2;
    const float yaw_change_cost_2 = then_3_yaw_change_sine_2 - then_3_yaw_change_sine;
    const float then_1_cost_2 = hall_position_limit((better_yaw_change_sine) ? (then_1_cost_1 +
        (((yaw_change_sine_part_12 * by_axis_1_1_e_cost_1) + (yaw_change_sine_part_14 * by_axis_1_2_e_cost_1) -
        (damping * then_1_cost_1) - (yaw_change_sine_part_16 * yaw_change_cost_2)) * yaw_change_sine_part_17)) :
        (0.5f * (then_1_cost_1 + other_1_cost_2)), 0.5f);
    const float cost_2_part = (x_phase_fraction_sine * versine_cost_2) + (y_phase_fraction_sine * yaw_change_sine_2);
    const float angle_cost_2 = then_1_cost_2 - cost_2_part;
    const float f9_argument_5 = angle_cost_2 * angle_cost_2;
    const float by_cosine_cost_2 = f9_polynomial(f9_argument_5);
    const float by_sine_cost_2 = angle_cost_2 * f10_polynomial(f9_argument_5);
    const float phases_1_sine_cost_2 = (x_sine_cost_0 * by_cosine_cost_2) + (x_cosine_yaw_change_sine * by_sine_cost_2);
    const float phases_1_sine_cost_2_squared = phases_1_sine_cost_2 * phases_1_sine_cost_2;
    const float B_1_cost_2 = phases_1_sine_cost_2 * (estimator_field_1 +
        (phases_1_sine_cost_2_squared * (estimator_field_3 + (phases_1_sine_cost_2_squared * estimator_field_5))));
    const float by_axis_1_1_e_cost_2 = (volts_cosine_cost_0 * rotation_cosine_cost_2) -
        (volts_sine_cost_0 * yaw_change_sine_2) - B_1_cost_2;
    const float cost_2_part_2 = (x_phase_fraction_sine_2 * versine_cost_2) +
        (y_phase_fraction_sine_2 * yaw_change_sine_2);
    const float angle_cost_2_2 = then_1_cost_2 - cost_2_part_2;
    const float f9_argument_6 = angle_cost_2_2 * angle_cost_2_2;
    const float by_cosine_cost_2_2 = f9_polynomial(f9_argument_6);
    const float by_sine_cost_2_2 = angle_cost_2_2 * f10_polynomial(f9_argument_6);
    const float phases_1_sine_cost_2_2 = (x_sine_cost_0_2 * by_cosine_cost_2_2) +
        (x_cosine_yaw_change_sine_2 * by_sine_cost_2_2);
    const float cost_2_part_3 = phases_1_sine_cost_2_2 * phases_1_sine_cost_2_2;
    const float B_1_cost_2_2 = phases_1_sine_cost_2_2 * (estimator_field_1 +
        (cost_2_part_3 * (estimator_field_3 + (cost_2_part_3 * estimator_field_5))));
    const float by_axis_1_2_e_cost_2 = (volts_cosine_cost_0_2 * rotation_cosine_cost_2) -
        (volts_sine_cost_0_2 * yaw_change_sine_2) - B_1_cost_2_2;
    const float then_2_cost_2 = hall_position_limit((better_yaw_change_sine) ? (then_2_cost_1 +
        (((yaw_change_sine_part_18 * by_axis_2_1_e_cost_1) + (yaw_change_sine_part_20 * by_axis_2_2_e_cost_1) -
        (damping * then_2_cost_1) - (yaw_change_sine_part_22 * yaw_change_cost_2)) * yaw_change_sine_part_23)) :
        (0.5f * (then_2_cost_1 + other_2_cost_2)), 0.5f);
    const float dy_cost_2 = (x_phase_fraction_sine * yaw_change_sine_2) - (y_phase_fraction_sine * versine_cost_2);
    const float angle_cost_2_3 = then_2_cost_2 + dy_cost_2;
    const float f9_argument_7 = angle_cost_2_3 * angle_cost_2_3;
    const float by_cosine_cost_2_3 = f9_polynomial(f9_argument_7);
    const float by_sine_cost_2_3 = angle_cost_2_3 * f10_polynomial(f9_argument_7);
    const float p_sine_cost_2 = (p_sine_cost_0 * by_cosine_cost_2_3) + (p_cosine_yaw_change_sine * by_sine_cost_2_3);
    const float q_cost_2 = p_sine_cost_2 * p_sine_cost_2;
    const float B_2_cost_2 = p_sine_cost_2 * (estimator_field_1 +
        (q_cost_2 * (estimator_field_3 + (q_cost_2 * estimator_field_5))));
    const float by_axis_2_1_e_cost_2 = (volts_sine_cost_0 * rotation_cosine_cost_2) +
        (volts_cosine_cost_0 * yaw_change_sine_2) - B_2_cost_2;
    const float dy_cost_2_2 = (x_phase_fraction_sine_2 * yaw_change_sine_2) -
        (y_phase_fraction_sine_2 * versine_cost_2);
    const float angle_cost_2_4 = then_2_cost_2 + dy_cost_2_2;
    const float f9_argument_8 = angle_cost_2_4 * angle_cost_2_4;
    const float by_cosine_cost_2_4 = f9_polynomial(f9_argument_8);
    const float by_sine_cost_2_4 = angle_cost_2_4 * f10_polynomial(f9_argument_8);
    const float p_sine_cost_2_2 = (p_sine_cost_0_2 * by_cosine_cost_2_4) +
        (p_cosine_yaw_change_sine_2 * by_sine_cost_2_4);
    const float q_cost_2_2 = p_sine_cost_2_2 * p_sine_cost_2_2;
    const float B_2_cost_2_2 = p_sine_cost_2_2 * (estimator_field_1 +
        (q_cost_2_2 * (estimator_field_3 + (q_cost_2_2 * estimator_field_5))));
    const float by_axis_2_2_e_cost_2 = (volts_sine_cost_0_2 * rotation_cosine_cost_2) +
        (volts_cosine_cost_0_2 * yaw_change_sine_2) - B_2_cost_2_2;
    const float cost_2 = (by_axis_1_1_e_cost_2 * by_axis_1_1_e_cost_2) + (by_axis_1_2_e_cost_2 * by_axis_1_2_e_cost_2) +
        (by_axis_2_1_e_cost_2 * by_axis_2_1_e_cost_2) + (by_axis_2_2_e_cost_2 * by_axis_2_2_e_cost_2) +
        (damping * ((then_1_cost_2 * then_1_cost_2) + (then_2_cost_2 * then_2_cost_2) +
        (squared_yaw_arm * yaw_change_sine_part_26)));
    const bool better_yaw_change_sine_2 = cost_2 <= ((cost_factor * yaw_change_sine_part_25) + cost_slack);
    const float yaw_change_sine_part_27 = ((x_cosine_yaw_change_sine * by_cosine_cost_2) -
        (x_sine_cost_0 * by_sine_cost_2)) * (estimator_slope_0 +
        (phases_1_sine_cost_2_squared * (estimator_slope_2 + (phases_1_sine_cost_2_squared * estimator_slope_4))));
    const float yaw_change_sine_part_28 = B_2_cost_2 - (yaw_change_sine_part_27 * (y_phase_fraction_sine + dy_cost_2));
    const float yaw_change_sine_part_29 = ((x_cosine_yaw_change_sine_2 * by_cosine_cost_2_2) -
        (x_sine_cost_0_2 * by_sine_cost_2_2)) * (estimator_slope_0 +
        (cost_2_part_3 * (estimator_slope_2 + (cost_2_part_3 * estimator_slope_4))));
    const float yaw_change_sine_part_30 = B_2_cost_2_2 -
        (yaw_change_sine_part_29 * (y_phase_fraction_sine_2 + dy_cost_2_2));
    const float yaw_change_sine_part_31 = (yaw_change_sine_part_27 * yaw_change_sine_part_28) +
        (yaw_change_sine_part_29 * yaw_change_sine_part_30);
    const float across_yaw_change_sine_5 = (yaw_change_sine_part_27 * yaw_change_sine_part_30) -
        (yaw_change_sine_part_29 * yaw_change_sine_part_28);
    const float yaw_change_sine_part_32 = 1.0f / (damping +
        ((yaw_change_sine_part_27 * yaw_change_sine_part_27) + (yaw_change_sine_part_29 * yaw_change_sine_part_29)));
    const float yaw_change_sine_part_33 = ((p_cosine_yaw_change_sine * by_cosine_cost_2_3) - (p_sine_cost_0 *
        by_sine_cost_2_3)) * (estimator_slope_0 + (q_cost_2 * (estimator_slope_2 + (q_cost_2 * estimator_slope_4))));
    const float yaw_change_sine_part_34 = (yaw_change_sine_part_33 * (x_phase_fraction_sine - cost_2_part)) -
        B_1_cost_2;
    const float yaw_change_sine_part_35 = ((p_cosine_yaw_change_sine_2 * by_cosine_cost_2_4) -
        (p_sine_cost_0_2 * by_sine_cost_2_4)) * (estimator_slope_0 +
        (q_cost_2_2 * (estimator_slope_2 + (q_cost_2_2 * estimator_slope_4))));
    const float yaw_change_sine_part_36 = (yaw_change_sine_part_35 * (x_phase_fraction_sine_2 - cost_2_part_2)) -
        B_1_cost_2_2;
    const float yaw_change_sine_part_37 = (yaw_change_sine_part_33 * yaw_change_sine_part_34) +
        (yaw_change_sine_part_35 * yaw_change_sine_part_36);
    const float across_yaw_change_sine_6 = (yaw_change_sine_part_33 * yaw_change_sine_part_36) -
        (yaw_change_sine_part_35 * yaw_change_sine_part_34);
    const float yaw_change_sine_part_38 = 1.0f / (damping +
        ((yaw_change_sine_part_33 * yaw_change_sine_part_33) + (yaw_change_sine_part_35 * yaw_change_sine_part_35)));
    const float yaw_change_sine_part_39 = (((damping * ((yaw_change_sine_part_28 * by_axis_1_1_e_cost_2) +
        (yaw_change_sine_part_30 * by_axis_1_2_e_cost_2) + (then_1_cost_2 * yaw_change_sine_part_31))) +
        (across_yaw_change_sine_5 * ((yaw_change_sine_part_27 * by_axis_1_2_e_cost_2) -
        (yaw_change_sine_part_29 * by_axis_1_1_e_cost_2)))) * yaw_change_sine_part_32) + (((damping *
        ((yaw_change_sine_part_34 * by_axis_2_1_e_cost_2) + (yaw_change_sine_part_36 * by_axis_2_2_e_cost_2) +
        (then_2_cost_2 * yaw_change_sine_part_37))) + (across_yaw_change_sine_6 * ((yaw_change_sine_part_33 *
        by_axis_2_2_e_cost_2) - (yaw_change_sine_part_35 * by_axis_2_1_e_cost_2)))) * yaw_change_sine_part_38);
    const float data_yaw_change_sine_3 = (((damping * ((yaw_change_sine_part_28 * yaw_change_sine_part_28) +
        (yaw_change_sine_part_30 * yaw_change_sine_part_30))) + (across_yaw_change_sine_5 * across_yaw_change_sine_5)) *
        yaw_change_sine_part_32) + (((damping * ((yaw_change_sine_part_34 * yaw_change_sine_part_34) +
        (yaw_change_sine_part_36 * yaw_change_sine_part_36))) + (across_yaw_change_sine_6 * across_yaw_change_sine_6)) *
        yaw_change_sine_part_38);
    float other_3_yaw_change_sine_2 = then_3_yaw_change_sine_2;
    float other_1_cost_3 = then_1_cost_2;
    float other_2_cost_3 = then_2_cost_2;
    float yaw_change_sine_part_40 = cost_2;
    if (!better_yaw_change_sine_2) {
        other_3_yaw_change_sine_2 = other_3_yaw_change_sine;
        other_1_cost_3 = other_1_cost_2;
        other_2_cost_3 = other_2_cost_2;
        yaw_change_sine_part_40 = yaw_change_sine_part_25;
    }
    const float then_3_yaw_change_sine_3 = hall_position_limit((better_yaw_change_sine_2) ? (then_3_yaw_change_sine_2 +
        ((yaw_change_sine_part_39 - (yaw_damping * then_3_yaw_change_sine_2)) / (yaw_damping +
        data_yaw_change_sine_3))) : (0.5f * (then_3_yaw_change_sine_2 + other_3_yaw_change_sine_2)), max_yaw_step);
    const float yaw_change_sine_part_41 = then_3_yaw_change_sine_3 * then_3_yaw_change_sine_3;
    const float yaw_change_sine_3 = then_3_yaw_change_sine_3 * yaw_change_sine_polynomial(yaw_change_sine_part_41);
    const float half_yaw_change_sine_3 = then_3_yaw_change_sine_3 *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_41);
    const float versine_cost_3 = half_yaw_change_sine_3 * half_yaw_change_sine_3;
    const float rotation_cosine_cost_3 = 1.0f - versine_cost_3;
    const float yaw_change_cost_3 = then_3_yaw_change_sine_3 - then_3_yaw_change_sine_2;
    const float then_1_cost_3 = hall_position_limit((better_yaw_change_sine_2) ? (then_1_cost_2 +
        (((yaw_change_sine_part_27 * by_axis_1_1_e_cost_2) + (yaw_change_sine_part_29 * by_axis_1_2_e_cost_2) -
        (damping * then_1_cost_2) - (yaw_change_sine_part_31 * yaw_change_cost_3)) * yaw_change_sine_part_32)) :
        (0.5f * (then_1_cost_2 + other_1_cost_3)), 0.5f);
    const float cost_3_part = (x_phase_fraction_sine * versine_cost_3) + (y_phase_fraction_sine * yaw_change_sine_3);
    const float angle_cost_3 = then_1_cost_3 - cost_3_part;
    const float f9_argument_9 = angle_cost_3 * angle_cost_3;
    const float by_cosine_cost_3 = f9_polynomial(f9_argument_9);
    const float by_sine_cost_3 = angle_cost_3 * f10_polynomial(f9_argument_9);
    const float phases_1_sine_cost_3 = (x_sine_cost_0 * by_cosine_cost_3) + (x_cosine_yaw_change_sine * by_sine_cost_3);
    const float phases_1_sine_cost_3_squared = phases_1_sine_cost_3 * phases_1_sine_cost_3;
    const float B_1_cost_3 = phases_1_sine_cost_3 * (estimator_field_1 +
        (phases_1_sine_cost_3_squared * (estimator_field_3 + (phases_1_sine_cost_3_squared * estimator_field_5))));
    const float by_axis_1_1_e_cost_3 = (volts_cosine_cost_0 * rotation_cosine_cost_3) -
        (volts_sine_cost_0 * yaw_change_sine_3) - B_1_cost_3;
    const float cost_3_part_2 = (x_phase_fraction_sine_2 * versine_cost_3) +
        (y_phase_fraction_sine_2 * yaw_change_sine_3);
    const float angle_cost_3_2 = then_1_cost_3 - cost_3_part_2;
    const float f9_argument_10 = angle_cost_3_2 * angle_cost_3_2;
    const float by_cosine_cost_3_2 = f9_polynomial(f9_argument_10);
    const float by_sine_cost_3_2 = angle_cost_3_2 * f10_polynomial(f9_argument_10);
    const float phases_1_sine_cost_3_2 = (x_sine_cost_0_2 * by_cosine_cost_3_2) +
        (x_cosine_yaw_change_sine_2 * by_sine_cost_3_2);
    const float cost_3_part_3 = phases_1_sine_cost_3_2 * phases_1_sine_cost_3_2;
    const float B_1_cost_3_2 = phases_1_sine_cost_3_2 * (estimator_field_1 +
        (cost_3_part_3 * (estimator_field_3 + (cost_3_part_3 * estimator_field_5))));
    const float by_axis_1_2_e_cost_3 = (volts_cosine_cost_0_2 * rotation_cosine_cost_3) -
        (volts_sine_cost_0_2 * yaw_change_sine_3) - B_1_cost_3_2;
    const float then_2_cost_3 = hall_position_limit((better_yaw_change_sine_2) ? (then_2_cost_2 +
        (((yaw_change_sine_part_33 * by_axis_2_1_e_cost_2) + (yaw_change_sine_part_35 * by_axis_2_2_e_cost_2) -
        (damping * then_2_cost_2) - (yaw_change_sine_part_37 * yaw_change_cost_3)) * yaw_change_sine_part_38)) :
        (0.5f * (then_2_cost_2 + other_2_cost_3)), 0.5f);
    const float dy_cost_3 = (x_phase_fraction_sine * yaw_change_sine_3) - (y_phase_fraction_sine * versine_cost_3);
    const float angle_cost_3_3 = then_2_cost_3 + dy_cost_3;
    const float f9_argument_11 = angle_cost_3_3 * angle_cost_3_3;
    const float by_cosine_cost_3_3 = f9_polynomial(f9_argument_11);
    const float by_sine_cost_3_3 = angle_cost_3_3 * f10_polynomial(f9_argument_11);
    const float p_sine_cost_3 = (p_sine_cost_0 * by_cosine_cost_3_3) + (p_cosine_yaw_change_sine * by_sine_cost_3_3);
    const float q_cost_3 = p_sine_cost_3 * p_sine_cost_3;
    const float B_2_cost_3 = p_sine_cost_3 * (estimator_field_1 +
        (q_cost_3 * (estimator_field_3 + (q_cost_3 * estimator_field_5))));
    const float by_axis_2_1_e_cost_3 = (volts_sine_cost_0 * rotation_cosine_cost_3) +
        (volts_cosine_cost_0 * yaw_change_sine_3) - B_2_cost_3;
    const float dy_cost_3_2 = (x_phase_fraction_sine_2 * yaw_change_sine_3) -
        (y_phase_fraction_sine_2 * versine_cost_3);
    const float angle_cost_3_4 = then_2_cost_3 + dy_cost_3_2;
    const float f9_argument_12 = angle_cost_3_4 * angle_cost_3_4;
    const float by_cosine_cost_3_4 = f9_polynomial(f9_argument_12);
    const float by_sine_cost_3_4 = angle_cost_3_4 * f10_polynomial(f9_argument_12);
    const float p_sine_cost_3_2 = (p_sine_cost_0_2 * by_cosine_cost_3_4) +
        (p_cosine_yaw_change_sine_2 * by_sine_cost_3_4);
    const float q_cost_3_2 = p_sine_cost_3_2 * p_sine_cost_3_2;
    const float B_2_cost_3_2 = p_sine_cost_3_2 * (estimator_field_1 +
        (q_cost_3_2 * (estimator_field_3 + (q_cost_3_2 * estimator_field_5))));
    const float by_axis_2_2_e_cost_3 = (volts_sine_cost_0_2 * rotation_cosine_cost_3) +
        (volts_cosine_cost_0_2 * yaw_change_sine_3) - B_2_cost_3_2;
    const float cost_3 = (by_axis_1_1_e_cost_3 * by_axis_1_1_e_cost_3) + (by_axis_1_2_e_cost_3 * by_axis_1_2_e_cost_3) +
        (by_axis_2_1_e_cost_3 * by_axis_2_1_e_cost_3) + (by_axis_2_2_e_cost_3 * by_axis_2_2_e_cost_3) +
        (damping * ((then_1_cost_3 * then_1_cost_3) + (then_2_cost_3 * then_2_cost_3) +
        (squared_yaw_arm * yaw_change_sine_part_41)));
    const bool better_yaw_change_sine_3 = cost_3 <= ((cost_factor * yaw_change_sine_part_40) + cost_slack);
    const float yaw_change_sine_part_42 = ((x_cosine_yaw_change_sine * by_cosine_cost_3) -
        (x_sine_cost_0 * by_sine_cost_3)) * (estimator_slope_0 +
        (phases_1_sine_cost_3_squared * (estimator_slope_2 + (phases_1_sine_cost_3_squared * estimator_slope_4))));
    const float yaw_change_sine_part_43 = B_2_cost_3 - (yaw_change_sine_part_42 * (y_phase_fraction_sine + dy_cost_3));
    const float yaw_change_sine_part_44 = ((x_cosine_yaw_change_sine_2 * by_cosine_cost_3_2) -
        (x_sine_cost_0_2 * by_sine_cost_3_2)) * (estimator_slope_0 +
        (cost_3_part_3 * (estimator_slope_2 + (cost_3_part_3 * estimator_slope_4))));
    const float yaw_change_sine_part_45 = B_2_cost_3_2 -
        (yaw_change_sine_part_44 * (y_phase_fraction_sine_2 + dy_cost_3_2));
    const float yaw_change_sine_part_46 = (yaw_change_sine_part_42 * yaw_change_sine_part_43) +
        (yaw_change_sine_part_44 * yaw_change_sine_part_45);
    const float across_yaw_change_sine_7 = (yaw_change_sine_part_42 * yaw_change_sine_part_45) -
        (yaw_change_sine_part_44 * yaw_change_sine_part_43);
    const float yaw_change_sine_part_47 = 1.0f / (damping +
        ((yaw_change_sine_part_42 * yaw_change_sine_part_42) + (yaw_change_sine_part_44 * yaw_change_sine_part_44)));
    const float yaw_change_sine_part_48 = ((p_cosine_yaw_change_sine * by_cosine_cost_3_3) - (p_sine_cost_0 *
        by_sine_cost_3_3)) * (estimator_slope_0 + (q_cost_3 * (estimator_slope_2 + (q_cost_3 * estimator_slope_4))));
    const float yaw_change_sine_part_49 = (yaw_change_sine_part_48 * (x_phase_fraction_sine - cost_3_part)) -
        B_1_cost_3;
    const float yaw_change_sine_part_50 = ((p_cosine_yaw_change_sine_2 * by_cosine_cost_3_4) -
        (p_sine_cost_0_2 * by_sine_cost_3_4)) * (estimator_slope_0 +
        (q_cost_3_2 * (estimator_slope_2 + (q_cost_3_2 * estimator_slope_4))));
    const float yaw_change_sine_part_51 = (yaw_change_sine_part_50 * (x_phase_fraction_sine_2 - cost_3_part_2)) -
        B_1_cost_3_2;
    const float yaw_change_sine_part_52 = (yaw_change_sine_part_48 * yaw_change_sine_part_49) +
        (yaw_change_sine_part_50 * yaw_change_sine_part_51);
    const float across_yaw_change_sine_8 = (yaw_change_sine_part_48 * yaw_change_sine_part_51) -
        (yaw_change_sine_part_50 * yaw_change_sine_part_49);
    const float yaw_change_sine_part_53 = 1.0f / (damping +
        ((yaw_change_sine_part_48 * yaw_change_sine_part_48) + (yaw_change_sine_part_50 * yaw_change_sine_part_50)));
    const float yaw_change_sine_part_54 = (((damping * ((yaw_change_sine_part_43 * by_axis_1_1_e_cost_3) +
        (yaw_change_sine_part_45 * by_axis_1_2_e_cost_3) + (then_1_cost_3 * yaw_change_sine_part_46))) +
        (across_yaw_change_sine_7 * ((yaw_change_sine_part_42 * by_axis_1_2_e_cost_3) -
        (yaw_change_sine_part_44 * by_axis_1_1_e_cost_3)))) * yaw_change_sine_part_47) + (((damping *
        ((yaw_change_sine_part_49 * by_axis_2_1_e_cost_3) + (yaw_change_sine_part_51 * by_axis_2_2_e_cost_3) +
        (then_2_cost_3 * yaw_change_sine_part_52))) + (across_yaw_change_sine_8 * ((yaw_change_sine_part_48 *
        by_axis_2_2_e_cost_3) - (yaw_change_sine_part_50 * by_axis_2_1_e_cost_3)))) * yaw_change_sine_part_53);
    const float data_yaw_change_sine_4 = (((damping * ((yaw_change_sine_part_43 * yaw_change_sine_part_43) +
        (yaw_change_sine_part_45 * yaw_change_sine_part_45))) + (across_yaw_change_sine_7 * across_yaw_change_sine_7)) *
        yaw_change_sine_part_47) + (((damping * ((yaw_change_sine_part_49 * yaw_change_sine_part_49) +
        (yaw_change_sine_part_51 * yaw_change_sine_part_51))) + (across_yaw_change_sine_8 * across_yaw_change_sine_8)) *
        yaw_change_sine_part_53);
    float other_3_yaw_change_sine_3 = then_3_yaw_change_sine_3;
    float other_1_cost_4 = then_1_cost_3;
    float other_2_cost_4 = then_2_cost_3;
    float converged_part = cost_3;
    if (!better_yaw_change_sine_3) {
        other_3_yaw_change_sine_3 = other_3_yaw_change_sine_2;
        other_1_cost_4 = other_1_cost_3;
        other_2_cost_4 = other_2_cost_3;
        converged_part = yaw_change_sine_part_40;
    }
    const float at_3_yaw_change_sine = hall_position_limit((better_yaw_change_sine_3) ? (then_3_yaw_change_sine_3 +
        ((yaw_change_sine_part_54 - (yaw_damping * then_3_yaw_change_sine_3)) / (yaw_damping +
        data_yaw_change_sine_4))) : (0.5f * (then_3_yaw_change_sine_3 + other_3_yaw_change_sine_3)), max_yaw_step);
    const float at_3_yaw_change_sine_squared = at_3_yaw_change_sine * at_3_yaw_change_sine;
    const float yaw_change_sine_4 = at_3_yaw_change_sine * yaw_change_sine_polynomial(at_3_yaw_change_sine_squared);
    const float half_yaw_change_sine_4 = at_3_yaw_change_sine *
        half_yaw_change_sine_polynomial(at_3_yaw_change_sine_squared);
    const float versine_cost_4 = half_yaw_change_sine_4 * half_yaw_change_sine_4;
    const float rotation_cosine_cost_4 = 1.0f - versine_cost_4;
    const float yaw_change_cost_4 = at_3_yaw_change_sine - then_3_yaw_change_sine_3;
    const float at_1_cost_4 = hall_position_limit((better_yaw_change_sine_3) ? (then_1_cost_3 +
        (((yaw_change_sine_part_42 * by_axis_1_1_e_cost_3) + (yaw_change_sine_part_44 * by_axis_1_2_e_cost_3) -
        (damping * then_1_cost_3) - (yaw_change_sine_part_46 * yaw_change_cost_4)) * yaw_change_sine_part_47)) :
        (0.5f * (then_1_cost_3 + other_1_cost_4)), 0.5f);
    const float cost_4_part = (x_phase_fraction_sine * versine_cost_4) + (y_phase_fraction_sine * yaw_change_sine_4);
    const float angle_cost_4 = at_1_cost_4 - cost_4_part;
    const float f9_argument_13 = angle_cost_4 * angle_cost_4;
    const float by_cosine_cost_4 = f9_polynomial(f9_argument_13);
    const float by_sine_cost_4 = angle_cost_4 * f10_polynomial(f9_argument_13);
    const float phases_1_sine_cost_4 = (x_sine_cost_0 * by_cosine_cost_4) + (x_cosine_yaw_change_sine * by_sine_cost_4);
    const float phases_1_sine_cost_4_squared = phases_1_sine_cost_4 * phases_1_sine_cost_4;
    const float B_1_cost_4 = phases_1_sine_cost_4 * (estimator_field_1 +
        (phases_1_sine_cost_4_squared * (estimator_field_3 + (phases_1_sine_cost_4_squared * estimator_field_5))));
    const float by_axis_1_1_e_cost_4 = (volts_cosine_cost_0 * rotation_cosine_cost_4) -
        (volts_sine_cost_0 * yaw_change_sine_4) - B_1_cost_4;
    const float cost_4_part_2 = (x_phase_fraction_sine_2 * versine_cost_4) +
        (y_phase_fraction_sine_2 * yaw_change_sine_4);
    const float angle_cost_4_2 = at_1_cost_4 - cost_4_part_2;
    const float f9_argument_14 = angle_cost_4_2 * angle_cost_4_2;
    const float by_cosine_cost_4_2 = f9_polynomial(f9_argument_14);
    const float by_sine_cost_4_2 = angle_cost_4_2 * f10_polynomial(f9_argument_14);
    const float phases_1_sine_cost_4_2 = (x_sine_cost_0_2 * by_cosine_cost_4_2) +
        (x_cosine_yaw_change_sine_2 * by_sine_cost_4_2);
    const float cost_4_part_3 = phases_1_sine_cost_4_2 * phases_1_sine_cost_4_2;
    const float B_1_cost_4_2 = phases_1_sine_cost_4_2 * (estimator_field_1 +
        (cost_4_part_3 * (estimator_field_3 + (cost_4_part_3 * estimator_field_5))));
    const float by_axis_1_2_e_cost_4 = (volts_cosine_cost_0_2 * rotation_cosine_cost_4) -
        (volts_sine_cost_0_2 * yaw_change_sine_4) - B_1_cost_4_2;
    const float at_2_cost_4 = hall_position_limit((better_yaw_change_sine_3) ? (then_2_cost_3 +
        (((yaw_change_sine_part_48 * by_axis_2_1_e_cost_3) + (yaw_change_sine_part_50 * by_axis_2_2_e_cost_3) -
        (damping * then_2_cost_3) - (yaw_change_sine_part_52 * yaw_change_cost_4)) * yaw_change_sine_part_53)) :
        (0.5f * (then_2_cost_3 + other_2_cost_4)), 0.5f);
    const float dy_cost_4 = (x_phase_fraction_sine * yaw_change_sine_4) - (y_phase_fraction_sine * versine_cost_4);
    const float angle_cost_4_3 = at_2_cost_4 + dy_cost_4;
    const float f9_argument_15 = angle_cost_4_3 * angle_cost_4_3;
    const float by_cosine_cost_4_3 = f9_polynomial(f9_argument_15);
    const float by_sine_cost_4_3 = angle_cost_4_3 * f10_polynomial(f9_argument_15);
    const float p_sine_cost_4 = (p_sine_cost_0 * by_cosine_cost_4_3) + (p_cosine_yaw_change_sine * by_sine_cost_4_3);
    const float q_cost_4 = p_sine_cost_4 * p_sine_cost_4;
    const float B_2_cost_4 = p_sine_cost_4 * (estimator_field_1 +
        (q_cost_4 * (estimator_field_3 + (q_cost_4 * estimator_field_5))));
    const float by_axis_2_1_e_cost_4 = (volts_sine_cost_0 * rotation_cosine_cost_4) +
        (volts_cosine_cost_0 * yaw_change_sine_4) - B_2_cost_4;
    const float dy_cost_4_2 = (x_phase_fraction_sine_2 * yaw_change_sine_4) -
        (y_phase_fraction_sine_2 * versine_cost_4);
    const float angle_cost_4_4 = at_2_cost_4 + dy_cost_4_2;
    const float f9_argument_16 = angle_cost_4_4 * angle_cost_4_4;
    const float by_cosine_cost_4_4 = f9_polynomial(f9_argument_16);
    const float by_sine_cost_4_4 = angle_cost_4_4 * f10_polynomial(f9_argument_16);
    const float p_sine_cost_4_2 = (p_sine_cost_0_2 * by_cosine_cost_4_4) +
        (p_cosine_yaw_change_sine_2 * by_sine_cost_4_4);
    const float q_cost_4_2 = p_sine_cost_4_2 * p_sine_cost_4_2;
    const float B_2_cost_4_2 = p_sine_cost_4_2 * (estimator_field_1 +
        (q_cost_4_2 * (estimator_field_3 + (q_cost_4_2 * estimator_field_5))));
    const float by_axis_2_2_e_cost_4 = (volts_sine_cost_0_2 * rotation_cosine_cost_4) +
        (volts_cosine_cost_0_2 * yaw_change_sine_4) - B_2_cost_4_2;
    const float squares_cost_4 = (by_axis_1_1_e_cost_4 * by_axis_1_1_e_cost_4) +
        (by_axis_1_2_e_cost_4 * by_axis_1_2_e_cost_4) + (by_axis_2_1_e_cost_4 * by_axis_2_1_e_cost_4) +
        (by_axis_2_2_e_cost_4 * by_axis_2_2_e_cost_4);
    const float cost_4_part_4 = (at_1_cost_4 * at_1_cost_4) + (at_2_cost_4 * at_2_cost_4);
    const float cost_4 = squares_cost_4 +
        (damping * (cost_4_part_4 + (squared_yaw_arm * at_3_yaw_change_sine_squared)));
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const bool gate_exceeded = squared_gate < (cost_4_part_4 + (squared_radius * at_3_yaw_change_sine_squared));
    const uint32_t estimator_searching = state->estimator_searching;
    const bool better_converged = cost_4 <= ((cost_factor * converged_part) + cost_slack);
    const float by_axis_1_1_g_converged = ((x_cosine_yaw_change_sine * by_cosine_cost_4) -
        (x_sine_cost_0 * by_sine_cost_4)) * (estimator_slope_0 +
        (phases_1_sine_cost_4_squared * (estimator_slope_2 + (phases_1_sine_cost_4_squared * estimator_slope_4))));
    const float by_axis_1_1_h_converged = B_2_cost_4 - (by_axis_1_1_g_converged * (y_phase_fraction_sine + dy_cost_4));
    const float by_axis_1_2_g_converged = ((x_cosine_yaw_change_sine_2 * by_cosine_cost_4_2) -
        (x_sine_cost_0_2 * by_sine_cost_4_2)) * (estimator_slope_0 +
        (cost_4_part_3 * (estimator_slope_2 + (cost_4_part_3 * estimator_slope_4))));
    const float by_axis_1_2_h_converged = B_2_cost_4_2 -
        (by_axis_1_2_g_converged * (y_phase_fraction_sine_2 + dy_cost_4_2));
    const float axes_1_coupling_converged = (by_axis_1_1_g_converged * by_axis_1_1_h_converged) +
        (by_axis_1_2_g_converged * by_axis_1_2_h_converged);
    const float across_converged = (by_axis_1_1_g_converged * by_axis_1_2_h_converged) -
        (by_axis_1_2_g_converged * by_axis_1_1_h_converged);
    const float axes_1_inverse = 1.0f / (damping +
        ((by_axis_1_1_g_converged * by_axis_1_1_g_converged) + (by_axis_1_2_g_converged * by_axis_1_2_g_converged)));
    const float by_axis_2_1_g_converged = ((p_cosine_yaw_change_sine * by_cosine_cost_4_3) - (p_sine_cost_0 *
        by_sine_cost_4_3)) * (estimator_slope_0 + (q_cost_4 * (estimator_slope_2 + (q_cost_4 * estimator_slope_4))));
    const float by_axis_2_1_h_converged = (by_axis_2_1_g_converged * (x_phase_fraction_sine - cost_4_part)) -
        B_1_cost_4;
    const float by_axis_2_2_g_converged = ((p_cosine_yaw_change_sine_2 * by_cosine_cost_4_4) -
        (p_sine_cost_0_2 * by_sine_cost_4_4)) * (estimator_slope_0 +
        (q_cost_4_2 * (estimator_slope_2 + (q_cost_4_2 * estimator_slope_4))));
    const float by_axis_2_2_h_converged = (by_axis_2_2_g_converged * (x_phase_fraction_sine_2 - cost_4_part_2)) -
        B_1_cost_4_2;
    const float n_coupling = (by_axis_2_1_g_converged * by_axis_2_1_h_converged) +
        (by_axis_2_2_g_converged * by_axis_2_2_h_converged);
    const float across_converged_2 = (by_axis_2_1_g_converged * by_axis_2_2_h_converged) -
        (by_axis_2_2_g_converged * by_axis_2_1_h_converged);
    const float n_inverse = 1.0f / (damping +
        ((by_axis_2_1_g_converged * by_axis_2_1_g_converged) + (by_axis_2_2_g_converged * by_axis_2_2_g_converged)));
    const float converged_part_2 = (((damping * ((by_axis_1_1_h_converged * by_axis_1_1_e_cost_4) +
        (by_axis_1_2_h_converged * by_axis_1_2_e_cost_4) + (at_1_cost_4 * axes_1_coupling_converged))) +
        (across_converged * ((by_axis_1_1_g_converged * by_axis_1_2_e_cost_4) - (by_axis_1_2_g_converged *
        by_axis_1_1_e_cost_4)))) * axes_1_inverse) + (((damping * ((by_axis_2_1_h_converged * by_axis_2_1_e_cost_4) +
        (by_axis_2_2_h_converged * by_axis_2_2_e_cost_4) + (at_2_cost_4 * n_coupling))) + (across_converged_2 *
        ((by_axis_2_1_g_converged * by_axis_2_2_e_cost_4) - (by_axis_2_2_g_converged * by_axis_2_1_e_cost_4)))) *
        n_inverse);
    const float right_converged = converged_part_2 - (yaw_damping * at_3_yaw_change_sine);
    const float data_converged = (((damping * ((by_axis_1_1_h_converged * by_axis_1_1_h_converged) +
        (by_axis_1_2_h_converged * by_axis_1_2_h_converged))) + (across_converged * across_converged)) *
        axes_1_inverse) + (((damping * ((by_axis_2_1_h_converged * by_axis_2_1_h_converged) +
        (by_axis_2_2_h_converged * by_axis_2_2_h_converged))) + (across_converged_2 * across_converged_2)) * n_inverse);
    const float converged_part_3 = 1.0f / (yaw_damping + data_converged);
    const float axes_1_slope_converged = (by_axis_1_1_g_converged * by_axis_1_1_e_cost_4) +
        (by_axis_1_2_g_converged * by_axis_1_2_e_cost_4) - (damping * at_1_cost_4);
    const float n_slope = (by_axis_2_1_g_converged * by_axis_2_1_e_cost_4) +
        (by_axis_2_2_g_converged * by_axis_2_2_e_cost_4) - (damping * at_2_cost_4);
    const bool converged = better_converged && (((right_converged * right_converged * converged_part_3) +
        (axes_1_slope_converged * axes_1_slope_converged * axes_1_inverse) + (n_slope * n_slope * n_inverse)) <=
        cost_slack);
    float at_3_X;
    float at_1_X;
    float at_2_Y;
    if (converged) {
        const float untried_3 = hall_position_limit(at_3_yaw_change_sine + (right_converged * converged_part_3),
            max_yaw_step);
        at_3_X = untried_3;
        const float yaw_change_X = untried_3 - at_3_yaw_change_sine;
        at_1_X = hall_position_limit(at_1_cost_4 +
            ((axes_1_slope_converged - (axes_1_coupling_converged * yaw_change_X)) * axes_1_inverse), 0.5f);
        at_2_Y = hall_position_limit(at_2_cost_4 + ((n_slope - (n_coupling * yaw_change_X)) * n_inverse), 0.5f);
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
    const bool integrity_residual_fault = (squared_residual_limit < squares_cost_4) ||
        ((estimator_ambiguity_resolved != 0u) ? gate_exceeded : ((estimator_searching != 0u) && !in_window));
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
    const bool turns_x_X = pi < X_part;
    float angle_x = X_part;
    if (turns_x_X) {
        angle_x = X_part - two_pi;
    }
    float pose_phase_x = angle_x;
    float turns_x_X_2 = -1.0f;
    if (angle_x < -pi) {
        pose_phase_x = angle_x + two_pi;
    } else {
        turns_x_X_2 = turns_x_X ? 1.0f : 0.0f;
    }
    const float pose_pitch_x = state->estimator_pitch_x + turns_x_X_2;
    const float X = (metre_per_rad * pose_phase_x) + (pitch * pose_pitch_x);
    const float Y_part = prediction_phase_y + by_phase_y;
    const bool turns_y_Y = pi < Y_part;
    float angle_y = Y_part;
    if (turns_y_Y) {
        angle_y = Y_part - two_pi;
    }
    float pose_phase_y = angle_y;
    float turns_y_Y_2 = -1.0f;
    if (angle_y < -pi) {
        pose_phase_y = angle_y + two_pi;
    } else {
        turns_y_Y_2 = turns_y_Y ? 1.0f : 0.0f;
    }
    const float pose_pitch_y = state->estimator_pitch_y + turns_y_Y_2;
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
    const float by_yaw_X = axes_1_coupling_converged * axes_1_inverse;
    const float by_yaw_X_squared = by_yaw_X * by_yaw_X;
    const float yaw_deviation_X = 1.0f / (data_converged + undamped_yaw);
    const float deviation_X = deviation_over_w * sqrtf(axes_1_inverse + (by_yaw_X_squared * yaw_deviation_X));
    out->deviation_X = deviation_X;
    const float by_yaw_Y = n_coupling * n_inverse;
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
    const float weight = ((squared_radius + by_yaw_X_squared + by_yaw_Y_squared) * yaw_deviation_X) +
        (axes_1_inverse + n_inverse);
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
    state->estimator_residual_faults = (integrity_residual_fault) ?
        ((exhausted) ? 0u : (estimator_residual_faults + 1u)) : 0u;
    const uint32_t estimator_acquired = state->estimator_acquired;
    state->estimator_acquired = hall_position_flag(resolved || (estimator_acquired != 0u));
    state->estimator_lock_lost = hall_position_flag((estimator_lock_lost != 0u) || ((estimator_acquired != 0u) &&
        (restart || !counted || (((resolved) ? yaw_limit : ambiguous_yaw_limit) < size))));
    out->valid = valid ? 1.0f : 0.0f;
    out->lock_lost = (float)estimator_lock_lost;

    return faults;
}
