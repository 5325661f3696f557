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
/* Return a value in -high .. high, which `last` becomes; for any other, set its fault bit and return *last. */
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
    const float yaw_fraction_sine_part = state->estimator_yaw + estimator_motion_yaw;
    const float f1_argument = yaw_fraction_sine_part * yaw_fraction_sine_part;
    const float f1 = yaw_fraction_sine_part * f1_polynomial(f1_argument);
    const float yaw_fraction_sine = 4.0f * f1;
    const float yaw_fraction_cosine = yaw_fraction_cosine_polynomial(f1_argument);
    const float estimator_motion_x = state->estimator_motion_x;
    const float phase_fraction_sine_part = state->estimator_phase_x + estimator_motion_x;
    const float phase_fraction_sine_part_2 = hall_position_limit(4.0f * (f1 * yaw_fraction_cosine), 2.0f);
    const float phase_fraction_sine_part_3 = hall_position_limit(phase_fraction_sine_part_2 * (1.0f - (0.125f * (yaw_fraction_sine * yaw_fraction_sine))), 1.0f);
    const float phase_fraction_sine_part_4 = -arm * phase_fraction_sine_part_3;
    const float phase_fraction_sine_part_5 = 1.0f - (0.5f * (phase_fraction_sine_part_2 * phase_fraction_sine_part_2));
    const float phase_fraction_sine_part_6 = -arm * phase_fraction_sine_part_5;
    const float phase_fraction_sine_part_7 = phase_fraction_sine_part_4 - phase_fraction_sine_part_6;
    const float phase_fraction_sine_part_8 = phase_fraction_sine_part + phase_fraction_sine_part_7;
    const float f3_argument = phase_fraction_sine_part_8 * phase_fraction_sine_part_8;
    const float f3 = phase_fraction_sine_part_8 * f3_polynomial(f3_argument);
    const float phase_fraction_sine = 8.0f * f3;
    const float phase_fraction_cosine = phase_fraction_cosine_polynomial(f3_argument);
    const float estimator_motion_y = state->estimator_motion_y;
    const float phase_fraction_sine_part_9 = state->estimator_phase_y + estimator_motion_y;
    const float phase_fraction_sine_part_10 = (arm * phase_fraction_sine_part_3) - phase_fraction_sine_part_6;
    const float phase_fraction_sine_part_11 = phase_fraction_sine_part_9 + phase_fraction_sine_part_10;
    const float f3_argument_2 = phase_fraction_sine_part_11 * phase_fraction_sine_part_11;
    const float f3_2 = phase_fraction_sine_part_11 * f3_polynomial(f3_argument_2);
    const float phase_fraction_sine_2 = 8.0f * f3_2;
    const float phase_fraction_cosine_2 = phase_fraction_cosine_polynomial(f3_argument_2);
    const float phase_fraction_sine_part_12 = phase_fraction_sine_part_6 - phase_fraction_sine_part_4;
    const float phase_fraction_sine_part_13 = phase_fraction_sine_part + phase_fraction_sine_part_12;
    const float f5_argument = phase_fraction_sine_part_13 * phase_fraction_sine_part_13;
    const float f5 = phase_fraction_sine_part_13 * f5_polynomial(f5_argument);
    const float phase_fraction_sine_3 = 8.0f * f5;
    const float phase_fraction_cosine_3 = phase_fraction_cosine_2_polynomial(f5_argument);
    const float phase_fraction_sine_part_14 = phase_fraction_sine_part_4 + phase_fraction_sine_part_6;
    const float phase_fraction_sine_part_15 = phase_fraction_sine_part_9 + phase_fraction_sine_part_14;
    const float f5_argument_2 = phase_fraction_sine_part_15 * phase_fraction_sine_part_15;
    const float f5_2 = phase_fraction_sine_part_15 * f5_polynomial(f5_argument_2);
    const float phase_fraction_sine_4 = 8.0f * f5_2;
    const float phase_fraction_cosine_4 = phase_fraction_cosine_2_polynomial(f5_argument_2);
    const float cost_0_part = (phase_fraction_sine_part_5 * V_ax_held) - (phase_fraction_sine_part_3 * V_ay_held);
    const float cost_0_part_2 = f3 * phase_fraction_cosine;
    const float cost_0_part_3 = hall_position_limit(8.0f * (cost_0_part_2 * (1.0f - (0.03125f * (phase_fraction_sine * phase_fraction_sine)))), 2.0f);
    const float cost_0_part_4 = 8.0f * cost_0_part_2;
    const float cost_0_part_5 = hall_position_limit(cost_0_part_3 * (1.0f - (0.125f * (cost_0_part_4 * cost_0_part_4))), 1.0f);
    const float cost_0_part_5_squared = cost_0_part_5 * cost_0_part_5;
    const float cost_0_part_6 = cost_0_part_5 * (estimator_field_1 + (cost_0_part_5_squared * (estimator_field_3 + (cost_0_part_5_squared * estimator_field_5))));
    const float cost_0_part_7 = cost_0_part - cost_0_part_6;
    const float cost_0_part_8 = (phase_fraction_sine_part_5 * V_bx_held) - (phase_fraction_sine_part_3 * V_by_held);
    const float cost_0_part_9 = f5 * phase_fraction_cosine_3;
    const float cost_0_part_10 = hall_position_limit(8.0f * (cost_0_part_9 * (1.0f - (0.03125f * (phase_fraction_sine_3 * phase_fraction_sine_3)))), 2.0f);
    const float cost_0_part_11 = 8.0f * cost_0_part_9;
    const float cost_0_part_12 = hall_position_limit(cost_0_part_10 * (1.0f - (0.125f * (cost_0_part_11 * cost_0_part_11))), 1.0f);
    const float cost_0_part_12_squared = cost_0_part_12 * cost_0_part_12;
    const float cost_0_part_13 = cost_0_part_12 * (estimator_field_1 + (cost_0_part_12_squared * (estimator_field_3 + (cost_0_part_12_squared * estimator_field_5))));
    const float cost_0_part_14 = cost_0_part_8 - cost_0_part_13;
    const float cost_0_part_15 = (phase_fraction_sine_part_3 * V_ax_held) + (phase_fraction_sine_part_5 * V_ay_held);
    const float cost_0_part_16 = f3_2 * phase_fraction_cosine_2;
    const float cost_0_part_17 = hall_position_limit(8.0f * (cost_0_part_16 * (1.0f - (0.03125f * (phase_fraction_sine_2 * phase_fraction_sine_2)))), 2.0f);
    const float cost_0_part_18 = 8.0f * cost_0_part_16;
    const float cost_0_part_19 = hall_position_limit(cost_0_part_17 * (1.0f - (0.125f * (cost_0_part_18 * cost_0_part_18))), 1.0f);
    const float cost_0_part_19_squared = cost_0_part_19 * cost_0_part_19;
    const float cost_0_part_20 = cost_0_part_19 * (estimator_field_1 + (cost_0_part_19_squared * (estimator_field_3 + (cost_0_part_19_squared * estimator_field_5))));
    const float cost_0_part_21 = cost_0_part_15 - cost_0_part_20;
    const float cost_0_part_22 = (phase_fraction_sine_part_3 * V_bx_held) + (phase_fraction_sine_part_5 * V_by_held);
    const float cost_0_part_23 = f5_2 * phase_fraction_cosine_4;
    const float cost_0_part_24 = hall_position_limit(8.0f * (cost_0_part_23 * (1.0f - (0.03125f * (phase_fraction_sine_4 * phase_fraction_sine_4)))), 2.0f);
    const float cost_0_part_25 = 8.0f * cost_0_part_23;
    const float cost_0_part_26 = hall_position_limit(cost_0_part_24 * (1.0f - (0.125f * (cost_0_part_25 * cost_0_part_25))), 1.0f);
    const float cost_0_part_26_squared = cost_0_part_26 * cost_0_part_26;
    const float cost_0_part_27 = cost_0_part_26 * (estimator_field_1 + (cost_0_part_26_squared * (estimator_field_3 + (cost_0_part_26_squared * estimator_field_5))));
    const float cost_0_part_28 = cost_0_part_22 - cost_0_part_27;
    const float cost_0 = (cost_0_part_7 * cost_0_part_7) + (cost_0_part_14 * cost_0_part_14) + (cost_0_part_21 * cost_0_part_21) + (cost_0_part_28 * cost_0_part_28);
    const float yaw_change_sine_part = 1.0f - (0.5f * (cost_0_part_3 * cost_0_part_3));
    const float yaw_change_sine_part_2 = yaw_change_sine_part * (estimator_slope_0 + (cost_0_part_5_squared * (estimator_slope_2 + (cost_0_part_5_squared * estimator_slope_4))));
    const float yaw_change_sine_part_3 = cost_0_part_20 - (yaw_change_sine_part_2 * phase_fraction_sine_part_10);
    const float yaw_change_sine_part_4 = 1.0f - (0.5f * (cost_0_part_10 * cost_0_part_10));
    const float yaw_change_sine_part_5 = yaw_change_sine_part_4 * (estimator_slope_0 + (cost_0_part_12_squared * (estimator_slope_2 + (cost_0_part_12_squared * estimator_slope_4))));
    const float yaw_change_sine_part_6 = cost_0_part_27 - (yaw_change_sine_part_5 * phase_fraction_sine_part_14);
    const float yaw_change_sine_part_7 = (yaw_change_sine_part_2 * yaw_change_sine_part_6) - (yaw_change_sine_part_5 * yaw_change_sine_part_3);
    const float yaw_change_sine_part_8 = 1.0f / (damping + ((yaw_change_sine_part_2 * yaw_change_sine_part_2) + (yaw_change_sine_part_5 * yaw_change_sine_part_5)));
    const float yaw_change_sine_part_9 = 1.0f - (0.5f * (cost_0_part_17 * cost_0_part_17));
    const float yaw_change_sine_part_10 = yaw_change_sine_part_9 * (estimator_slope_0 + (cost_0_part_19_squared * (estimator_slope_2 + (cost_0_part_19_squared * estimator_slope_4))));
    const float yaw_change_sine_part_11 = (yaw_change_sine_part_10 * phase_fraction_sine_part_7) - cost_0_part_6;
    const float yaw_change_sine_part_12 = 1.0f - (0.5f * (cost_0_part_24 * cost_0_part_24));
    const float yaw_change_sine_part_13 = yaw_change_sine_part_12 * (estimator_slope_0 + (cost_0_part_26_squared * (estimator_slope_2 + (cost_0_part_26_squared * estimator_slope_4))));
    const float yaw_change_sine_part_14 = (yaw_change_sine_part_13 * phase_fraction_sine_part_12) - cost_0_part_13;
    const float yaw_change_sine_part_15 = (yaw_change_sine_part_10 * yaw_change_sine_part_14) - (yaw_change_sine_part_13 * yaw_change_sine_part_11);
    const float yaw_change_sine_part_16 = 1.0f / (damping + ((yaw_change_sine_part_10 * yaw_change_sine_part_10) + (yaw_change_sine_part_13 * yaw_change_sine_part_13)));
    const float yaw_change_sine_part_17 = (((damping * ((yaw_change_sine_part_3 * cost_0_part_7) + (yaw_change_sine_part_6 * cost_0_part_14))) + (yaw_change_sine_part_7 * ((yaw_change_sine_part_2 * cost_0_part_14) - (yaw_change_sine_part_5 * cost_0_part_7)))) * yaw_change_sine_part_8) + (((damping * ((yaw_change_sine_part_11 * cost_0_part_21) + (yaw_change_sine_part_14 * cost_0_part_28))) + (yaw_change_sine_part_15 * ((yaw_change_sine_part_10 * cost_0_part_28) - (yaw_change_sine_part_13 * cost_0_part_21)))) * yaw_change_sine_part_16);
    const float yaw_change_sine_part_18 = (((damping * ((yaw_change_sine_part_3 * yaw_change_sine_part_3) + (yaw_change_sine_part_6 * yaw_change_sine_part_6))) + (yaw_change_sine_part_7 * yaw_change_sine_part_7)) * yaw_change_sine_part_8) + (((damping * ((yaw_change_sine_part_11 * yaw_change_sine_part_11) + (yaw_change_sine_part_14 * yaw_change_sine_part_14))) + (yaw_change_sine_part_15 * yaw_change_sine_part_15)) * yaw_change_sine_part_16);
    const float yaw_change_sine_part_19 = hall_position_limit(yaw_change_sine_part_17 / (yaw_damping + yaw_change_sine_part_18), max_yaw_step);
    const float yaw_change_sine_part_20 = yaw_change_sine_part_19 * yaw_change_sine_part_19;
    const float yaw_change_sine = yaw_change_sine_part_19 * yaw_change_sine_polynomial(yaw_change_sine_part_20);
    const float half_yaw_change_sine = yaw_change_sine_part_19 * half_yaw_change_sine_polynomial(yaw_change_sine_part_20);
    const float half_yaw_change_sine_squared = half_yaw_change_sine * half_yaw_change_sine;
    const float cost_1_part = 1.0f - half_yaw_change_sine_squared;
    const float cost_1_part_2 = hall_position_limit(((yaw_change_sine_part_2 * cost_0_part_7) + (yaw_change_sine_part_5 * cost_0_part_14) - (((yaw_change_sine_part_2 * yaw_change_sine_part_3) + (yaw_change_sine_part_5 * yaw_change_sine_part_6)) * yaw_change_sine_part_19)) * yaw_change_sine_part_8, 0.5f);
    const float cost_1_part_3 = (phase_fraction_sine_part_7 * half_yaw_change_sine_squared) + (phase_fraction_sine_part_10 * yaw_change_sine);
    const float cost_1_part_4 = cost_1_part_2 - cost_1_part_3;
    const float f9_argument = cost_1_part_4 * cost_1_part_4;
    const float f9 = f9_polynomial(f9_argument);
    const float f10 = cost_1_part_4 * f10_polynomial(f9_argument);
    const float cost_1_part_5 = (cost_0_part_5 * f9) + (yaw_change_sine_part * f10);
    const float cost_1_part_5_squared = cost_1_part_5 * cost_1_part_5;
    const float cost_1_part_6 = cost_1_part_5 * (estimator_field_1 + (cost_1_part_5_squared * (estimator_field_3 + (cost_1_part_5_squared * estimator_field_5))));
    const float cost_1_part_7 = (cost_0_part * cost_1_part) - (cost_0_part_15 * yaw_change_sine) - cost_1_part_6;
    const float cost_1_part_8 = (phase_fraction_sine_part_12 * half_yaw_change_sine_squared) + (phase_fraction_sine_part_14 * yaw_change_sine);
    const float cost_1_part_9 = cost_1_part_2 - cost_1_part_8;
    const float f9_argument_2 = cost_1_part_9 * cost_1_part_9;
    const float f9_2 = f9_polynomial(f9_argument_2);
    const float f10_2 = cost_1_part_9 * f10_polynomial(f9_argument_2);
    const float cost_1_part_10 = (cost_0_part_12 * f9_2) + (yaw_change_sine_part_4 * f10_2);
    const float cost_1_part_10_squared = cost_1_part_10 * cost_1_part_10;
    const float cost_1_part_11 = cost_1_part_10 * (estimator_field_1 + (cost_1_part_10_squared * (estimator_field_3 + (cost_1_part_10_squared * estimator_field_5))));
    const float cost_1_part_12 = (cost_0_part_8 * cost_1_part) - (cost_0_part_22 * yaw_change_sine) - cost_1_part_11;
    const float cost_1_part_13 = hall_position_limit(((yaw_change_sine_part_10 * cost_0_part_21) + (yaw_change_sine_part_13 * cost_0_part_28) - (((yaw_change_sine_part_10 * yaw_change_sine_part_11) + (yaw_change_sine_part_13 * yaw_change_sine_part_14)) * yaw_change_sine_part_19)) * yaw_change_sine_part_16, 0.5f);
    const float cost_1_part_14 = (phase_fraction_sine_part_7 * yaw_change_sine) - (phase_fraction_sine_part_10 * half_yaw_change_sine_squared);
    const float cost_1_part_15 = cost_1_part_13 + cost_1_part_14;
    const float f9_argument_3 = cost_1_part_15 * cost_1_part_15;
    const float f9_3 = f9_polynomial(f9_argument_3);
    const float f10_3 = cost_1_part_15 * f10_polynomial(f9_argument_3);
    const float cost_1_part_16 = (cost_0_part_19 * f9_3) + (yaw_change_sine_part_9 * f10_3);
    const float cost_1_part_16_squared = cost_1_part_16 * cost_1_part_16;
    const float cost_1_part_17 = cost_1_part_16 * (estimator_field_1 + (cost_1_part_16_squared * (estimator_field_3 + (cost_1_part_16_squared * estimator_field_5))));
    const float cost_1_part_18 = (cost_0_part_15 * cost_1_part) + (cost_0_part * yaw_change_sine) - cost_1_part_17;
    const float cost_1_part_19 = (phase_fraction_sine_part_12 * yaw_change_sine) - (phase_fraction_sine_part_14 * half_yaw_change_sine_squared);
    const float cost_1_part_20 = cost_1_part_13 + cost_1_part_19;
    const float f9_argument_4 = cost_1_part_20 * cost_1_part_20;
    const float f9_4 = f9_polynomial(f9_argument_4);
    const float f10_4 = cost_1_part_20 * f10_polynomial(f9_argument_4);
    const float cost_1_part_21 = (cost_0_part_26 * f9_4) + (yaw_change_sine_part_12 * f10_4);
    const float cost_1_part_21_squared = cost_1_part_21 * cost_1_part_21;
    const float cost_1_part_22 = cost_1_part_21 * (estimator_field_1 + (cost_1_part_21_squared * (estimator_field_3 + (cost_1_part_21_squared * estimator_field_5))));
    const float cost_1_part_23 = (cost_0_part_22 * cost_1_part) + (cost_0_part_8 * yaw_change_sine) - cost_1_part_22;
    const float cost_1 = (cost_1_part_7 * cost_1_part_7) + (cost_1_part_12 * cost_1_part_12) + (cost_1_part_18 * cost_1_part_18) + (cost_1_part_23 * cost_1_part_23) + (damping * ((cost_1_part_2 * cost_1_part_2) + (cost_1_part_13 * cost_1_part_13) + (squared_yaw_arm * yaw_change_sine_part_20)));
    const bool yaw_change_sine_test = cost_1 <= ((cost_factor * cost_0) + cost_slack);
    const float yaw_change_sine_part_21 = ((yaw_change_sine_part * f9) - (cost_0_part_5 * f10)) * (estimator_slope_0 + (cost_1_part_5_squared * (estimator_slope_2 + (cost_1_part_5_squared * estimator_slope_4))));
    const float yaw_change_sine_part_22 = cost_1_part_17 - (yaw_change_sine_part_21 * (phase_fraction_sine_part_10 + cost_1_part_14));
    const float yaw_change_sine_part_23 = ((yaw_change_sine_part_4 * f9_2) - (cost_0_part_12 * f10_2)) * (estimator_slope_0 + (cost_1_part_10_squared * (estimator_slope_2 + (cost_1_part_10_squared * estimator_slope_4))));
    const float yaw_change_sine_part_24 = cost_1_part_22 - (yaw_change_sine_part_23 * (phase_fraction_sine_part_14 + cost_1_part_19));
    const float yaw_change_sine_part_25 = (yaw_change_sine_part_21 * yaw_change_sine_part_22) + (yaw_change_sine_part_23 * yaw_change_sine_part_24);
    const float yaw_change_sine_part_26 = (yaw_change_sine_part_21 * yaw_change_sine_part_24) - (yaw_change_sine_part_23 * yaw_change_sine_part_22);
    const float yaw_change_sine_part_27 = 1.0f / (damping + ((yaw_change_sine_part_21 * yaw_change_sine_part_21) + (yaw_change_sine_part_23 * yaw_change_sine_part_23)));
    const float yaw_change_sine_part_28 = ((yaw_change_sine_part_9 * f9_3) - (cost_0_part_19 * f10_3)) * (estimator_slope_0 + (cost_1_part_16_squared * (estimator_slope_2 + (cost_1_part_16_squared * estimator_slope_4))));
    const float yaw_change_sine_part_29 = (yaw_change_sine_part_28 * (phase_fraction_sine_part_7 - cost_1_part_3)) - cost_1_part_6;
    const float yaw_change_sine_part_30 = ((yaw_change_sine_part_12 * f9_4) - (cost_0_part_26 * f10_4)) * (estimator_slope_0 + (cost_1_part_21_squared * (estimator_slope_2 + (cost_1_part_21_squared * estimator_slope_4))));
    const float yaw_change_sine_part_31 = (yaw_change_sine_part_30 * (phase_fraction_sine_part_12 - cost_1_part_8)) - cost_1_part_11;
    const float yaw_change_sine_part_32 = (yaw_change_sine_part_28 * yaw_change_sine_part_29) + (yaw_change_sine_part_30 * yaw_change_sine_part_31);
    const float yaw_change_sine_part_33 = (yaw_change_sine_part_28 * yaw_change_sine_part_31) - (yaw_change_sine_part_30 * yaw_change_sine_part_29);
    const float yaw_change_sine_part_34 = 1.0f / (damping + ((yaw_change_sine_part_28 * yaw_change_sine_part_28) + (yaw_change_sine_part_30 * yaw_change_sine_part_30)));
    const float yaw_change_sine_part_35 = (((damping * ((yaw_change_sine_part_22 * cost_1_part_7) + (yaw_change_sine_part_24 * cost_1_part_12) + (cost_1_part_2 * yaw_change_sine_part_25))) + (yaw_change_sine_part_26 * ((yaw_change_sine_part_21 * cost_1_part_12) - (yaw_change_sine_part_23 * cost_1_part_7)))) * yaw_change_sine_part_27) + (((damping * ((yaw_change_sine_part_29 * cost_1_part_18) + (yaw_change_sine_part_31 * cost_1_part_23) + (cost_1_part_13 * yaw_change_sine_part_32))) + (yaw_change_sine_part_33 * ((yaw_change_sine_part_28 * cost_1_part_23) - (yaw_change_sine_part_30 * cost_1_part_18)))) * yaw_change_sine_part_34);
    const float yaw_change_sine_part_36 = (((damping * ((yaw_change_sine_part_22 * yaw_change_sine_part_22) + (yaw_change_sine_part_24 * yaw_change_sine_part_24))) + (yaw_change_sine_part_26 * yaw_change_sine_part_26)) * yaw_change_sine_part_27) + (((damping * ((yaw_change_sine_part_29 * yaw_change_sine_part_29) + (yaw_change_sine_part_31 * yaw_change_sine_part_31))) + (yaw_change_sine_part_33 * yaw_change_sine_part_33)) * yaw_change_sine_part_34);
    float yaw_change_sine_part_37 = yaw_change_sine_part_19;
    float cost_2_part = cost_1_part_2;
    float cost_2_part_2 = cost_1_part_13;
    float yaw_change_sine_part_38 = cost_1;
    if (!yaw_change_sine_test) {
        yaw_change_sine_part_37 = 0.0f;
        cost_2_part = 0.0f;
        cost_2_part_2 = 0.0f;
        yaw_change_sine_part_38 = cost_0;
    }
    const float yaw_change_sine_part_39 = hall_position_limit((yaw_change_sine_test) ? (yaw_change_sine_part_19 + ((yaw_change_sine_part_35 - (yaw_damping * yaw_change_sine_part_19)) / (yaw_damping + yaw_change_sine_part_36))) : (0.5f * (yaw_change_sine_part_19 + yaw_change_sine_part_37)), max_yaw_step);
    const float yaw_change_sine_part_40 = yaw_change_sine_part_39 * yaw_change_sine_part_39;
    const float yaw_change_sine_2 = yaw_change_sine_part_39 * yaw_change_sine_polynomial(yaw_change_sine_part_40);
    const float half_yaw_change_sine_2 = yaw_change_sine_part_39 * half_yaw_change_sine_polynomial(yaw_change_sine_part_40);
    const float cost_2_part_3 = half_yaw_change_sine_2 * half_yaw_change_sine_2;
    const float cost_2_part_4 = 1.0f - cost_2_part_3;
    const float cost_2_part_5 = yaw_change_sine_part_39 - yaw_change_sine_part_19;
    const float cost_2_part_6 = hall_position_limit((yaw_change_sine_test) ? (cost_1_part_2 + (((yaw_change_sine_part_21 * cost_1_part_7) + (yaw_change_sine_part_23 * cost_1_part_12) - (damping * cost_1_part_2) - (yaw_change_sine_part_25 * cost_2_part_5)) * yaw_change_sine_part_27)) : (0.5f * (cost_1_part_2 + cost_2_part)), 0.5f);
    const float cost_2_part_7 = (phase_fraction_sine_part_7 * cost_2_part_3) + (phase_fraction_sine_part_10 * yaw_change_sine_2);
    const float cost_2_part_8 = cost_2_part_6 - cost_2_part_7;
    const float f9_argument_5 = cost_2_part_8 * cost_2_part_8;
    const float f9_5 = f9_polynomial(f9_argument_5);
    const float f10_5 = cost_2_part_8 * f10_polynomial(f9_argument_5);
    const float cost_2_part_9 = (cost_0_part_5 * f9_5) + (yaw_change_sine_part * f10_5);
    const float cost_2_part_9_squared = cost_2_part_9 * cost_2_part_9;
    const float cost_2_part_10 = cost_2_part_9 * (estimator_field_1 + (cost_2_part_9_squared * (estimator_field_3 + (cost_2_part_9_squared * estimator_field_5))));
    const float cost_2_part_11 = (cost_0_part * cost_2_part_4) - (cost_0_part_15 * yaw_change_sine_2) - cost_2_part_10;
    const float cost_2_part_12 = (phase_fraction_sine_part_12 * cost_2_part_3) + (phase_fraction_sine_part_14 * yaw_change_sine_2);
    const float cost_2_part_13 = cost_2_part_6 - cost_2_part_12;
    const float f9_argument_6 = cost_2_part_13 * cost_2_part_13;
    const float f9_6 = f9_polynomial(f9_argument_6);
    const float f10_6 = cost_2_part_13 * f10_polynomial(f9_argument_6);
    const float cost_2_part_14 = (cost_0_part_12 * f9_6) + (yaw_change_sine_part_4 * f10_6);
    const float cost_2_part_14_squared = cost_2_part_14 * cost_2_part_14;
    const float cost_2_part_15 = cost_2_part_14 * (estimator_field_1 + (cost_2_part_14_squared * (estimator_field_3 + (cost_2_part_14_squared * estimator_field_5))));
    const float cost_2_part_16 = (cost_0_part_8 * cost_2_part_4) - (cost_0_part_22 * yaw_change_sine_2) - cost_2_part_15;
    const float cost_2_part_17 = hall_position_limit((yaw_change_sine_test) ? (cost_1_part_13 + (((yaw_change_sine_part_28 * cost_1_part_18) + (yaw_change_sine_part_30 * cost_1_part_23) - (damping * cost_1_part_13) - (yaw_change_sine_part_32 * cost_2_part_5)) * yaw_change_sine_part_34)) : (0.5f * (cost_1_part_13 + cost_2_part_2)), 0.5f);
    const float cost_2_part_18 = (phase_fraction_sine_part_7 * yaw_change_sine_2) - (phase_fraction_sine_part_10 * cost_2_part_3);
    const float cost_2_part_19 = cost_2_part_17 + cost_2_part_18;
    const float f9_argument_7 = cost_2_part_19 * cost_2_part_19;
    const float f9_7 = f9_polynomial(f9_argument_7);
    const float f10_7 = cost_2_part_19 * f10_polynomial(f9_argument_7);
    const float cost_2_part_20 = (cost_0_part_19 * f9_7) + (yaw_change_sine_part_9 * f10_7);
    const float cost_2_part_20_squared = cost_2_part_20 * cost_2_part_20;
    const float cost_2_part_21 = cost_2_part_20 * (estimator_field_1 + (cost_2_part_20_squared * (estimator_field_3 + (cost_2_part_20_squared * estimator_field_5))));
    const float cost_2_part_22 = (cost_0_part_15 * cost_2_part_4) + (cost_0_part * yaw_change_sine_2) - cost_2_part_21;
    const float cost_2_part_23 = (phase_fraction_sine_part_12 * yaw_change_sine_2) - (phase_fraction_sine_part_14 * cost_2_part_3);
    const float cost_2_part_24 = cost_2_part_17 + cost_2_part_23;
    const float f9_argument_8 = cost_2_part_24 * cost_2_part_24;
    const float f9_8 = f9_polynomial(f9_argument_8);
    const float f10_8 = cost_2_part_24 * f10_polynomial(f9_argument_8);
    const float cost_2_part_25 = (cost_0_part_26 * f9_8) + (yaw_change_sine_part_12 * f10_8);
    const float cost_2_part_25_squared = cost_2_part_25 * cost_2_part_25;
    const float cost_2_part_26 = cost_2_part_25 * (estimator_field_1 + (cost_2_part_25_squared * (estimator_field_3 + (cost_2_part_25_squared * estimator_field_5))));
    const float cost_2_part_27 = (cost_0_part_22 * cost_2_part_4) + (cost_0_part_8 * yaw_change_sine_2) - cost_2_part_26;
    const float cost_2 = (cost_2_part_11 * cost_2_part_11) + (cost_2_part_16 * cost_2_part_16) + (cost_2_part_22 * cost_2_part_22) + (cost_2_part_27 * cost_2_part_27) + (damping * ((cost_2_part_6 * cost_2_part_6) + (cost_2_part_17 * cost_2_part_17) + (squared_yaw_arm * yaw_change_sine_part_40)));
    const bool yaw_change_sine_test_2 = cost_2 <= ((cost_factor * yaw_change_sine_part_38) + cost_slack);
    const float yaw_change_sine_part_41 = ((yaw_change_sine_part * f9_5) - (cost_0_part_5 * f10_5)) * (estimator_slope_0 + (cost_2_part_9_squared * (estimator_slope_2 + (cost_2_part_9_squared * estimator_slope_4))));
    const float yaw_change_sine_part_42 = cost_2_part_21 - (yaw_change_sine_part_41 * (phase_fraction_sine_part_10 + cost_2_part_18));
    const float yaw_change_sine_part_43 = ((yaw_change_sine_part_4 * f9_6) - (cost_0_part_12 * f10_6)) * (estimator_slope_0 + (cost_2_part_14_squared * (estimator_slope_2 + (cost_2_part_14_squared * estimator_slope_4))));
    const float yaw_change_sine_part_44 = cost_2_part_26 - (yaw_change_sine_part_43 * (phase_fraction_sine_part_14 + cost_2_part_23));
    const float yaw_change_sine_part_45 = (yaw_change_sine_part_41 * yaw_change_sine_part_42) + (yaw_change_sine_part_43 * yaw_change_sine_part_44);
    const float yaw_change_sine_part_46 = (yaw_change_sine_part_41 * yaw_change_sine_part_44) - (yaw_change_sine_part_43 * yaw_change_sine_part_42);
    const float yaw_change_sine_part_47 = 1.0f / (damping + ((yaw_change_sine_part_41 * yaw_change_sine_part_41) + (yaw_change_sine_part_43 * yaw_change_sine_part_43)));
    const float yaw_change_sine_part_48 = ((yaw_change_sine_part_9 * f9_7) - (cost_0_part_19 * f10_7)) * (estimator_slope_0 + (cost_2_part_20_squared * (estimator_slope_2 + (cost_2_part_20_squared * estimator_slope_4))));
    const float yaw_change_sine_part_49 = (yaw_change_sine_part_48 * (phase_fraction_sine_part_7 - cost_2_part_7)) - cost_2_part_10;
    const float yaw_change_sine_part_50 = ((yaw_change_sine_part_12 * f9_8) - (cost_0_part_26 * f10_8)) * (estimator_slope_0 + (cost_2_part_25_squared * (estimator_slope_2 + (cost_2_part_25_squared * estimator_slope_4))));
    const float yaw_change_sine_part_51 = (yaw_change_sine_part_50 * (phase_fraction_sine_part_12 - cost_2_part_12)) - cost_2_part_15;
    const float yaw_change_sine_part_52 = (yaw_change_sine_part_48 * yaw_change_sine_part_49) + (yaw_change_sine_part_50 * yaw_change_sine_part_51);
    const float yaw_change_sine_part_53 = (yaw_change_sine_part_48 * yaw_change_sine_part_51) - (yaw_change_sine_part_50 * yaw_change_sine_part_49);
    const float yaw_change_sine_part_54 = 1.0f / (damping + ((yaw_change_sine_part_48 * yaw_change_sine_part_48) + (yaw_change_sine_part_50 * yaw_change_sine_part_50)));
    const float yaw_change_sine_part_55 = (((damping * ((yaw_change_sine_part_42 * cost_2_part_11) + (yaw_change_sine_part_44 * cost_2_part_16) + (cost_2_part_6 * yaw_change_sine_part_45))) + (yaw_change_sine_part_46 * ((yaw_change_sine_part_41 * cost_2_part_16) - (yaw_change_sine_part_43 * cost_2_part_11)))) * yaw_change_sine_part_47) + (((damping * ((yaw_change_sine_part_49 * cost_2_part_22) + (yaw_change_sine_part_51 * cost_2_part_27) + (cost_2_part_17 * yaw_change_sine_part_52))) + (yaw_change_sine_part_53 * ((yaw_change_sine_part_48 * cost_2_part_27) - (yaw_change_sine_part_50 * cost_2_part_22)))) * yaw_change_sine_part_54);
    const float yaw_change_sine_part_56 = (((damping * ((yaw_change_sine_part_42 * yaw_change_sine_part_42) + (yaw_change_sine_part_44 * yaw_change_sine_part_44))) + (yaw_change_sine_part_46 * yaw_change_sine_part_46)) * yaw_change_sine_part_47) + (((damping * ((yaw_change_sine_part_49 * yaw_change_sine_part_49) + (yaw_change_sine_part_51 * yaw_change_sine_part_51))) + (yaw_change_sine_part_53 * yaw_change_sine_part_53)) * yaw_change_sine_part_54);
    float yaw_change_sine_part_57 = yaw_change_sine_part_39;
    float cost_3_part = cost_2_part_6;
    float cost_3_part_2 = cost_2_part_17;
    float yaw_change_sine_part_58 = cost_2;
    if (!yaw_change_sine_test_2) {
        yaw_change_sine_part_57 = yaw_change_sine_part_37;
        cost_3_part = cost_2_part;
        cost_3_part_2 = cost_2_part_2;
        yaw_change_sine_part_58 = yaw_change_sine_part_38;
    }
    const float yaw_change_sine_part_59 = hall_position_limit((yaw_change_sine_test_2) ? (yaw_change_sine_part_39 + ((yaw_change_sine_part_55 - (yaw_damping * yaw_change_sine_part_39)) / (yaw_damping + yaw_change_sine_part_56))) : (0.5f * (yaw_change_sine_part_39 + yaw_change_sine_part_57)), max_yaw_step);
    const float yaw_change_sine_part_60 = yaw_change_sine_part_59 * yaw_change_sine_part_59;
    const float yaw_change_sine_3 = yaw_change_sine_part_59 * yaw_change_sine_polynomial(yaw_change_sine_part_60);
    const float half_yaw_change_sine_3 = yaw_change_sine_part_59 * half_yaw_change_sine_polynomial(yaw_change_sine_part_60);
    const float cost_3_part_3 = half_yaw_change_sine_3 * half_yaw_change_sine_3;
    const float cost_3_part_4 = 1.0f - cost_3_part_3;
    const float cost_3_part_5 = yaw_change_sine_part_59 - yaw_change_sine_part_39;
    const float cost_3_part_6 = hall_position_limit((yaw_change_sine_test_2) ? (cost_2_part_6 + (((yaw_change_sine_part_41 * cost_2_part_11) + (yaw_change_sine_part_43 * cost_2_part_16) - (damping * cost_2_part_6) - (yaw_change_sine_part_45 * cost_3_part_5)) * yaw_change_sine_part_47)) : (0.5f * (cost_2_part_6 + cost_3_part)), 0.5f);
    const float cost_3_part_7 = (phase_fraction_sine_part_7 * cost_3_part_3) + (phase_fraction_sine_part_10 * yaw_change_sine_3);
    const float cost_3_part_8 = cost_3_part_6 - cost_3_part_7;
    const float f9_argument_9 = cost_3_part_8 * cost_3_part_8;
    const float f9_9 = f9_polynomial(f9_argument_9);
    const float f10_9 = cost_3_part_8 * f10_polynomial(f9_argument_9);
    const float cost_3_part_9 = (cost_0_part_5 * f9_9) + (yaw_change_sine_part * f10_9);
    const float cost_3_part_9_squared = cost_3_part_9 * cost_3_part_9;
    const float cost_3_part_10 = cost_3_part_9 * (estimator_field_1 + (cost_3_part_9_squared * (estimator_field_3 + (cost_3_part_9_squared * estimator_field_5))));
    const float cost_3_part_11 = (cost_0_part * cost_3_part_4) - (cost_0_part_15 * yaw_change_sine_3) - cost_3_part_10;
    const float cost_3_part_12 = (phase_fraction_sine_part_12 * cost_3_part_3) + (phase_fraction_sine_part_14 * yaw_change_sine_3);
    const float cost_3_part_13 = cost_3_part_6 - cost_3_part_12;
    const float f9_argument_10 = cost_3_part_13 * cost_3_part_13;
    const float f9_10 = f9_polynomial(f9_argument_10);
    const float f10_10 = cost_3_part_13 * f10_polynomial(f9_argument_10);
    const float cost_3_part_14 = (cost_0_part_12 * f9_10) + (yaw_change_sine_part_4 * f10_10);
    const float cost_3_part_14_squared = cost_3_part_14 * cost_3_part_14;
    const float cost_3_part_15 = cost_3_part_14 * (estimator_field_1 + (cost_3_part_14_squared * (estimator_field_3 + (cost_3_part_14_squared * estimator_field_5))));
    const float cost_3_part_16 = (cost_0_part_8 * cost_3_part_4) - (cost_0_part_22 * yaw_change_sine_3) - cost_3_part_15;
    const float cost_3_part_17 = hall_position_limit((yaw_change_sine_test_2) ? (cost_2_part_17 + (((yaw_change_sine_part_48 * cost_2_part_22) + (yaw_change_sine_part_50 * cost_2_part_27) - (damping * cost_2_part_17) - (yaw_change_sine_part_52 * cost_3_part_5)) * yaw_change_sine_part_54)) : (0.5f * (cost_2_part_17 + cost_3_part_2)), 0.5f);
    const float cost_3_part_18 = (phase_fraction_sine_part_7 * yaw_change_sine_3) - (phase_fraction_sine_part_10 * cost_3_part_3);
    const float cost_3_part_19 = cost_3_part_17 + cost_3_part_18;
    const float f9_argument_11 = cost_3_part_19 * cost_3_part_19;
    const float f9_11 = f9_polynomial(f9_argument_11);
    const float f10_11 = cost_3_part_19 * f10_polynomial(f9_argument_11);
    const float cost_3_part_20 = (cost_0_part_19 * f9_11) + (yaw_change_sine_part_9 * f10_11);
    const float cost_3_part_20_squared = cost_3_part_20 * cost_3_part_20;
    const float cost_3_part_21 = cost_3_part_20 * (estimator_field_1 + (cost_3_part_20_squared * (estimator_field_3 + (cost_3_part_20_squared * estimator_field_5))));
    const float cost_3_part_22 = (cost_0_part_15 * cost_3_part_4) + (cost_0_part * yaw_change_sine_3) - cost_3_part_21;
    const float cost_3_part_23 = (phase_fraction_sine_part_12 * yaw_change_sine_3) - (phase_fraction_sine_part_14 * cost_3_part_3);
    const float cost_3_part_24 = cost_3_part_17 + cost_3_part_23;
    const float f9_argument_12 = cost_3_part_24 * cost_3_part_24;
    const float f9_12 = f9_polynomial(f9_argument_12);
    const float f10_12 = cost_3_part_24 * f10_polynomial(f9_argument_12);
    const float cost_3_part_25 = (cost_0_part_26 * f9_12) + (yaw_change_sine_part_12 * f10_12);
    const float cost_3_part_25_squared = cost_3_part_25 * cost_3_part_25;
    const float cost_3_part_26 = cost_3_part_25 * (estimator_field_1 + (cost_3_part_25_squared * (estimator_field_3 + (cost_3_part_25_squared * estimator_field_5))));
    const float cost_3_part_27 = (cost_0_part_22 * cost_3_part_4) + (cost_0_part_8 * yaw_change_sine_3) - cost_3_part_26;
    const float cost_3 = (cost_3_part_11 * cost_3_part_11) + (cost_3_part_16 * cost_3_part_16) + (cost_3_part_22 * cost_3_part_22) + (cost_3_part_27 * cost_3_part_27) + (damping * ((cost_3_part_6 * cost_3_part_6) + (cost_3_part_17 * cost_3_part_17) + (squared_yaw_arm * yaw_change_sine_part_60)));
    const bool yaw_change_sine_test_3 = cost_3 <= ((cost_factor * yaw_change_sine_part_58) + cost_slack);
    const float yaw_change_sine_part_61 = ((yaw_change_sine_part * f9_9) - (cost_0_part_5 * f10_9)) * (estimator_slope_0 + (cost_3_part_9_squared * (estimator_slope_2 + (cost_3_part_9_squared * estimator_slope_4))));
    const float yaw_change_sine_part_62 = cost_3_part_21 - (yaw_change_sine_part_61 * (phase_fraction_sine_part_10 + cost_3_part_18));
    const float yaw_change_sine_part_63 = ((yaw_change_sine_part_4 * f9_10) - (cost_0_part_12 * f10_10)) * (estimator_slope_0 + (cost_3_part_14_squared * (estimator_slope_2 + (cost_3_part_14_squared * estimator_slope_4))));
    const float yaw_change_sine_part_64 = cost_3_part_26 - (yaw_change_sine_part_63 * (phase_fraction_sine_part_14 + cost_3_part_23));
    const float yaw_change_sine_part_65 = (yaw_change_sine_part_61 * yaw_change_sine_part_62) + (yaw_change_sine_part_63 * yaw_change_sine_part_64);
    const float yaw_change_sine_part_66 = (yaw_change_sine_part_61 * yaw_change_sine_part_64) - (yaw_change_sine_part_63 * yaw_change_sine_part_62);
    const float yaw_change_sine_part_67 = 1.0f / (damping + ((yaw_change_sine_part_61 * yaw_change_sine_part_61) + (yaw_change_sine_part_63 * yaw_change_sine_part_63)));
    const float yaw_change_sine_part_68 = ((yaw_change_sine_part_9 * f9_11) - (cost_0_part_19 * f10_11)) * (estimator_slope_0 + (cost_3_part_20_squared * (estimator_slope_2 + (cost_3_part_20_squared * estimator_slope_4))));
    const float yaw_change_sine_part_69 = (yaw_change_sine_part_68 * (phase_fraction_sine_part_7 - cost_3_part_7)) - cost_3_part_10;
    const float yaw_change_sine_part_70 = ((yaw_change_sine_part_12 * f9_12) - (cost_0_part_26 * f10_12)) * (estimator_slope_0 + (cost_3_part_25_squared * (estimator_slope_2 + (cost_3_part_25_squared * estimator_slope_4))));
    const float yaw_change_sine_part_71 = (yaw_change_sine_part_70 * (phase_fraction_sine_part_12 - cost_3_part_12)) - cost_3_part_15;
    const float yaw_change_sine_part_72 = (yaw_change_sine_part_68 * yaw_change_sine_part_69) + (yaw_change_sine_part_70 * yaw_change_sine_part_71);
    const float yaw_change_sine_part_73 = (yaw_change_sine_part_68 * yaw_change_sine_part_71) - (yaw_change_sine_part_70 * yaw_change_sine_part_69);
    const float yaw_change_sine_part_74 = 1.0f / (damping + ((yaw_change_sine_part_68 * yaw_change_sine_part_68) + (yaw_change_sine_part_70 * yaw_change_sine_part_70)));
    const float yaw_change_sine_part_75 = (((damping * ((yaw_change_sine_part_62 * cost_3_part_11) + (yaw_change_sine_part_64 * cost_3_part_16) + (cost_3_part_6 * yaw_change_sine_part_65))) + (yaw_change_sine_part_66 * ((yaw_change_sine_part_61 * cost_3_part_16) - (yaw_change_sine_part_63 * cost_3_part_11)))) * yaw_change_sine_part_67) + (((damping * ((yaw_change_sine_part_69 * cost_3_part_22) + (yaw_change_sine_part_71 * cost_3_part_27) + (cost_3_part_17 * yaw_change_sine_part_72))) + (yaw_change_sine_part_73 * ((yaw_change_sine_part_68 * cost_3_part_27) - (yaw_change_sine_part_70 * cost_3_part_22)))) * yaw_change_sine_part_74);
    const float yaw_change_sine_part_76 = (((damping * ((yaw_change_sine_part_62 * yaw_change_sine_part_62) + (yaw_change_sine_part_64 * yaw_change_sine_part_64))) + (yaw_change_sine_part_66 * yaw_change_sine_part_66)) * yaw_change_sine_part_67) + (((damping * ((yaw_change_sine_part_69 * yaw_change_sine_part_69) + (yaw_change_sine_part_71 * yaw_change_sine_part_71))) + (yaw_change_sine_part_73 * yaw_change_sine_part_73)) * yaw_change_sine_part_74);
    float yaw_change_sine_part_77 = yaw_change_sine_part_59;
    float cost_4_part = cost_3_part_6;
    float cost_4_part_2 = cost_3_part_17;
    float converged_part = cost_3;
    if (!yaw_change_sine_test_3) {
        yaw_change_sine_part_77 = yaw_change_sine_part_57;
        cost_4_part = cost_3_part;
        cost_4_part_2 = cost_3_part_2;
        converged_part = yaw_change_sine_part_58;
    }
    const float yaw_change_sine_part_78 = hall_position_limit((yaw_change_sine_test_3) ? (yaw_change_sine_part_59 + ((yaw_change_sine_part_75 - (yaw_damping * yaw_change_sine_part_59)) / (yaw_damping + yaw_change_sine_part_76))) : (0.5f * (yaw_change_sine_part_59 + yaw_change_sine_part_77)), max_yaw_step);
    const float yaw_change_sine_part_79 = yaw_change_sine_part_78 * yaw_change_sine_part_78;
    const float yaw_change_sine_4 = yaw_change_sine_part_78 * yaw_change_sine_polynomial(yaw_change_sine_part_79);
    const float half_yaw_change_sine_4 = yaw_change_sine_part_78 * half_yaw_change_sine_polynomial(yaw_change_sine_part_79);
    const float cost_4_part_3 = half_yaw_change_sine_4 * half_yaw_change_sine_4;
    const float cost_4_part_4 = 1.0f - cost_4_part_3;
    const float cost_4_part_5 = yaw_change_sine_part_78 - yaw_change_sine_part_59;
    const float cost_4_part_6 = hall_position_limit((yaw_change_sine_test_3) ? (cost_3_part_6 + (((yaw_change_sine_part_61 * cost_3_part_11) + (yaw_change_sine_part_63 * cost_3_part_16) - (damping * cost_3_part_6) - (yaw_change_sine_part_65 * cost_4_part_5)) * yaw_change_sine_part_67)) : (0.5f * (cost_3_part_6 + cost_4_part)), 0.5f);
    const float cost_4_part_7 = (phase_fraction_sine_part_7 * cost_4_part_3) + (phase_fraction_sine_part_10 * yaw_change_sine_4);
    const float cost_4_part_8 = cost_4_part_6 - cost_4_part_7;
    const float f9_argument_13 = cost_4_part_8 * cost_4_part_8;
    const float f9_13 = f9_polynomial(f9_argument_13);
    const float f10_13 = cost_4_part_8 * f10_polynomial(f9_argument_13);
    const float cost_4_part_9 = (cost_0_part_5 * f9_13) + (yaw_change_sine_part * f10_13);
    const float cost_4_part_9_squared = cost_4_part_9 * cost_4_part_9;
    const float cost_4_part_10 = cost_4_part_9 * (estimator_field_1 + (cost_4_part_9_squared * (estimator_field_3 + (cost_4_part_9_squared * estimator_field_5))));
    const float cost_4_part_11 = (cost_0_part * cost_4_part_4) - (cost_0_part_15 * yaw_change_sine_4) - cost_4_part_10;
    const float cost_4_part_12 = (phase_fraction_sine_part_12 * cost_4_part_3) + (phase_fraction_sine_part_14 * yaw_change_sine_4);
    const float cost_4_part_13 = cost_4_part_6 - cost_4_part_12;
    const float f9_argument_14 = cost_4_part_13 * cost_4_part_13;
    const float f9_14 = f9_polynomial(f9_argument_14);
    const float f10_14 = cost_4_part_13 * f10_polynomial(f9_argument_14);
    const float cost_4_part_14 = (cost_0_part_12 * f9_14) + (yaw_change_sine_part_4 * f10_14);
    const float cost_4_part_14_squared = cost_4_part_14 * cost_4_part_14;
    const float cost_4_part_15 = cost_4_part_14 * (estimator_field_1 + (cost_4_part_14_squared * (estimator_field_3 + (cost_4_part_14_squared * estimator_field_5))));
    const float cost_4_part_16 = (cost_0_part_8 * cost_4_part_4) - (cost_0_part_22 * yaw_change_sine_4) - cost_4_part_15;
    const float cost_4_part_17 = hall_position_limit((yaw_change_sine_test_3) ? (cost_3_part_17 + (((yaw_change_sine_part_68 * cost_3_part_22) + (yaw_change_sine_part_70 * cost_3_part_27) - (damping * cost_3_part_17) - (yaw_change_sine_part_72 * cost_4_part_5)) * yaw_change_sine_part_74)) : (0.5f * (cost_3_part_17 + cost_4_part_2)), 0.5f);
    const float cost_4_part_18 = (phase_fraction_sine_part_7 * yaw_change_sine_4) - (phase_fraction_sine_part_10 * cost_4_part_3);
    const float cost_4_part_19 = cost_4_part_17 + cost_4_part_18;
    const float f9_argument_15 = cost_4_part_19 * cost_4_part_19;
    const float f9_15 = f9_polynomial(f9_argument_15);
    const float f10_15 = cost_4_part_19 * f10_polynomial(f9_argument_15);
    const float cost_4_part_20 = (cost_0_part_19 * f9_15) + (yaw_change_sine_part_9 * f10_15);
    const float cost_4_part_20_squared = cost_4_part_20 * cost_4_part_20;
    const float cost_4_part_21 = cost_4_part_20 * (estimator_field_1 + (cost_4_part_20_squared * (estimator_field_3 + (cost_4_part_20_squared * estimator_field_5))));
    const float cost_4_part_22 = (cost_0_part_15 * cost_4_part_4) + (cost_0_part * yaw_change_sine_4) - cost_4_part_21;
    const float cost_4_part_23 = (phase_fraction_sine_part_12 * yaw_change_sine_4) - (phase_fraction_sine_part_14 * cost_4_part_3);
    const float cost_4_part_24 = cost_4_part_17 + cost_4_part_23;
    const float f9_argument_16 = cost_4_part_24 * cost_4_part_24;
    const float f9_16 = f9_polynomial(f9_argument_16);
    const float f10_16 = cost_4_part_24 * f10_polynomial(f9_argument_16);
    const float cost_4_part_25 = (cost_0_part_26 * f9_16) + (yaw_change_sine_part_12 * f10_16);
    const float cost_4_part_25_squared = cost_4_part_25 * cost_4_part_25;
    const float cost_4_part_26 = cost_4_part_25 * (estimator_field_1 + (cost_4_part_25_squared * (estimator_field_3 + (cost_4_part_25_squared * estimator_field_5))));
    const float cost_4_part_27 = (cost_0_part_22 * cost_4_part_4) + (cost_0_part_8 * yaw_change_sine_4) - cost_4_part_26;
    const float cost_4_part_28 = (cost_4_part_11 * cost_4_part_11) + (cost_4_part_16 * cost_4_part_16) + (cost_4_part_22 * cost_4_part_22) + (cost_4_part_27 * cost_4_part_27);
    const float cost_4_part_29 = (cost_4_part_6 * cost_4_part_6) + (cost_4_part_17 * cost_4_part_17);
    const float cost_4 = cost_4_part_28 + (damping * (cost_4_part_29 + (squared_yaw_arm * yaw_change_sine_part_79)));
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const bool above_squared_gate = squared_gate < (cost_4_part_29 + (squared_radius * yaw_change_sine_part_79));
    const uint32_t estimator_searching = state->estimator_searching;
    const bool converged_test = cost_4 <= ((cost_factor * converged_part) + cost_slack);
    const float converged_part_2 = ((yaw_change_sine_part * f9_13) - (cost_0_part_5 * f10_13)) * (estimator_slope_0 + (cost_4_part_9_squared * (estimator_slope_2 + (cost_4_part_9_squared * estimator_slope_4))));
    const float converged_part_3 = cost_4_part_21 - (converged_part_2 * (phase_fraction_sine_part_10 + cost_4_part_18));
    const float converged_part_4 = ((yaw_change_sine_part_4 * f9_14) - (cost_0_part_12 * f10_14)) * (estimator_slope_0 + (cost_4_part_14_squared * (estimator_slope_2 + (cost_4_part_14_squared * estimator_slope_4))));
    const float converged_part_5 = cost_4_part_26 - (converged_part_4 * (phase_fraction_sine_part_14 + cost_4_part_23));
    const float converged_part_6 = (converged_part_2 * converged_part_3) + (converged_part_4 * converged_part_5);
    const float converged_part_7 = (converged_part_2 * converged_part_5) - (converged_part_4 * converged_part_3);
    const float converged_part_8 = 1.0f / (damping + ((converged_part_2 * converged_part_2) + (converged_part_4 * converged_part_4)));
    const float converged_part_9 = ((yaw_change_sine_part_9 * f9_15) - (cost_0_part_19 * f10_15)) * (estimator_slope_0 + (cost_4_part_20_squared * (estimator_slope_2 + (cost_4_part_20_squared * estimator_slope_4))));
    const float converged_part_10 = (converged_part_9 * (phase_fraction_sine_part_7 - cost_4_part_7)) - cost_4_part_10;
    const float converged_part_11 = ((yaw_change_sine_part_12 * f9_16) - (cost_0_part_26 * f10_16)) * (estimator_slope_0 + (cost_4_part_25_squared * (estimator_slope_2 + (cost_4_part_25_squared * estimator_slope_4))));
    const float converged_part_12 = (converged_part_11 * (phase_fraction_sine_part_12 - cost_4_part_12)) - cost_4_part_15;
    const float converged_part_13 = (converged_part_9 * converged_part_10) + (converged_part_11 * converged_part_12);
    const float converged_part_14 = (converged_part_9 * converged_part_12) - (converged_part_11 * converged_part_10);
    const float converged_part_15 = 1.0f / (damping + ((converged_part_9 * converged_part_9) + (converged_part_11 * converged_part_11)));
    const float converged_part_16 = (((damping * ((converged_part_3 * cost_4_part_11) + (converged_part_5 * cost_4_part_16) + (cost_4_part_6 * converged_part_6))) + (converged_part_7 * ((converged_part_2 * cost_4_part_16) - (converged_part_4 * cost_4_part_11)))) * converged_part_8) + (((damping * ((converged_part_10 * cost_4_part_22) + (converged_part_12 * cost_4_part_27) + (cost_4_part_17 * converged_part_13))) + (converged_part_14 * ((converged_part_9 * cost_4_part_27) - (converged_part_11 * cost_4_part_22)))) * converged_part_15);
    const float converged_part_17 = converged_part_16 - (yaw_damping * yaw_change_sine_part_78);
    const float converged_part_18 = (((damping * ((converged_part_3 * converged_part_3) + (converged_part_5 * converged_part_5))) + (converged_part_7 * converged_part_7)) * converged_part_8) + (((damping * ((converged_part_10 * converged_part_10) + (converged_part_12 * converged_part_12))) + (converged_part_14 * converged_part_14)) * converged_part_15);
    const float converged_part_19 = 1.0f / (yaw_damping + converged_part_18);
    const float converged_part_20 = (converged_part_2 * cost_4_part_11) + (converged_part_4 * cost_4_part_16) - (damping * cost_4_part_6);
    const float converged_part_21 = (converged_part_9 * cost_4_part_22) + (converged_part_11 * cost_4_part_27) - (damping * cost_4_part_17);
    const bool converged = converged_test && (((converged_part_17 * converged_part_17 * converged_part_19) + (converged_part_20 * converged_part_20 * converged_part_8) + (converged_part_21 * converged_part_21 * converged_part_15)) <= cost_slack);
    float X_part;
    float X_part_2;
    float Y_part;
    if (converged) {
        const float X_part_3 = hall_position_limit(yaw_change_sine_part_78 + (converged_part_17 * converged_part_19), max_yaw_step);
        X_part = X_part_3;
        const float X_part_4 = X_part_3 - yaw_change_sine_part_78;
        X_part_2 = hall_position_limit(cost_4_part_6 + ((converged_part_20 - (converged_part_6 * X_part_4)) * converged_part_8), 0.5f);
        Y_part = hall_position_limit(cost_4_part_17 + ((converged_part_21 - (converged_part_13 * X_part_4)) * converged_part_15), 0.5f);
    } else {
        if (converged_test) {
            X_part = yaw_change_sine_part_78;
            X_part_2 = cost_4_part_6;
            Y_part = cost_4_part_17;
        } else {
            X_part = yaw_change_sine_part_77;
            X_part_2 = cost_4_part;
            Y_part = cost_4_part_2;
        }
    }
    const float estimator_yaw_last_good = state->estimator_yaw_last_good;
    const bool below_ambiguous_yaw_limit = fabsf(yaw_fraction_sine_part + X_part - estimator_yaw_last_good) <= ambiguous_yaw_limit;
    const bool X_test = (squared_residual_limit < cost_4_part_28) || ((estimator_ambiguity_resolved != 0u) ? above_squared_gate : ((estimator_searching != 0u) && !below_ambiguous_yaw_limit));
    const bool X_test_2 = !(estimator_searching != 0u);
    float X_part_5 = 0.0f;
    float Y_part_2 = 0.0f;
    float yaw_part = 0.0f;
    float estimator_motion_x_part = 0.0f;
    float estimator_motion_y_part = 0.0f;
    float estimator_motion_yaw_part = 0.0f;
    if (!(X_test && X_test_2)) {
        X_part_5 = X_part_2;
        Y_part_2 = Y_part;
        yaw_part = X_part;
        estimator_motion_x_part = 0.5f * X_part_2;
        estimator_motion_y_part = 0.5f * Y_part;
        estimator_motion_yaw_part = yaw_gain * X_part;
    }
    const float X_part_6 = phase_fraction_sine_part + X_part_5;
    float X_part_7 = X_part_6;
    bool X_part_8 = true;
    if (pi < X_part_6) {
        X_part_7 = X_part_6 - two_pi;
    } else {
        X_part_8 = false;
    }
    float X_part_9 = X_part_7;
    float X_part_10 = -1.0f;
    if (X_part_7 < -pi) {
        X_part_9 = X_part_7 + two_pi;
    } else {
        X_part_10 = X_part_8 ? 1.0f : 0.0f;
    }
    const float pitch_x_plus_X_part_10 = state->estimator_pitch_x + X_part_10;
    const float X = (metre_per_rad * X_part_9) + (pitch * pitch_x_plus_X_part_10);
    const float Y_part_3 = phase_fraction_sine_part_9 + Y_part_2;
    float Y_part_4 = Y_part_3;
    bool Y_part_5 = true;
    if (pi < Y_part_3) {
        Y_part_4 = Y_part_3 - two_pi;
    } else {
        Y_part_5 = false;
    }
    float Y_part_6 = Y_part_4;
    float Y_part_7 = -1.0f;
    if (Y_part_4 < -pi) {
        Y_part_6 = Y_part_4 + two_pi;
    } else {
        Y_part_7 = Y_part_5 ? 1.0f : 0.0f;
    }
    const float pitch_y_plus_Y_part_7 = state->estimator_pitch_y + Y_part_7;
    const float Y = (metre_per_rad * Y_part_6) + (pitch * pitch_y_plus_Y_part_7);
    const float yaw_part_2 = yaw_fraction_sine_part + yaw_part;
    float yaw_part_3 = yaw_part_2;
    if (pi < yaw_part_2) {
        yaw_part_3 = yaw_part_2 - two_pi;
    }
    float yaw = yaw_part_3;
    if (yaw_part_3 < -pi) {
        yaw = yaw_part_3 + two_pi;
    }
    const float deviation_X_part = converged_part_6 * converged_part_8;
    const float deviation_X_part_squared = deviation_X_part * deviation_X_part;
    const float deviation_X_part_2 = 1.0f / (converged_part_18 + undamped_yaw);
    const float deviation_X = deviation_over_w * sqrtf(converged_part_8 + (deviation_X_part_squared * deviation_X_part_2));
    out->deviation_X = deviation_X;
    const float deviation_Y_part = converged_part_13 * converged_part_15;
    const float deviation_Y_part_squared = deviation_Y_part * deviation_Y_part;
    const float deviation_Y = deviation_over_w * sqrtf(converged_part_15 + (deviation_Y_part_squared * deviation_X_part_2));
    out->deviation_Y = deviation_Y;
    const float deviation_yaw = deviation * sqrtf(deviation_X_part_2);
    out->deviation_yaw = deviation_yaw;
    const float residual = sqrtf(least_square + cost_4_part_28);
    out->residual = residual;
    out->X = X;
    out->Y = Y;
    out->yaw = yaw;
    out->converged = converged ? 1.0f : 0.0f;
    const float damped_part = ((squared_radius + deviation_X_part_squared + deviation_Y_part_squared) * deviation_X_part_2) + (converged_part_8 + converged_part_15);
    const bool damped = damped_weight < damped_part;
    out->damped = damped ? 1.0f : 0.0f;
    const bool valid_test = converged && !(damped || X_test || above_squared_gate);
    const bool valid_test_2 = (fabsf(pitch_x_plus_X_part_10) <= 8.0f) && (fabsf(pitch_y_plus_Y_part_7) <= 8.0f);
    const float yaw_size = fabsf(yaw);
    const bool valid_test_3 = valid_test_2 && (yaw_size <= yaw_limit);
    const bool valid_test_4 = (valid_test && below_ambiguous_yaw_limit && X_test_2 && (damped_part <= unambiguous_weight) && complete && valid_test_3) || ((estimator_ambiguity_resolved != 0u) && !damped);
    const uint32_t estimator_lock_lost = state->estimator_lock_lost;
    const bool valid = valid_test && valid_test_4 && !(estimator_lock_lost != 0u) && valid_test_3 && complete;
    const uint32_t estimator_residual_faults = state->estimator_residual_faults;
    const bool estimator_phase_x_test = 4u <= estimator_residual_faults;
    const bool estimator_phase_x_test_2 = X_test && estimator_phase_x_test;
    const bool estimator_yaw_last_good_test = !X_test;
    if (estimator_phase_x_test_2) {
        const float start_x_plus_start_step_x = state->estimator_start_x + -start_step_x;
        if (start_x_plus_start_step_x < -pi) {
            state->estimator_phase_x = start_x_plus_start_step_x + two_pi;
            state->estimator_start_x = state->estimator_phase_x;
        } else {
            state->estimator_phase_x = start_x_plus_start_step_x;
            state->estimator_start_x = start_x_plus_start_step_x;
        }
        const float start_y_plus_start_step_y = state->estimator_start_y + -start_step_y;
        if (start_y_plus_start_step_y < -pi) {
            state->estimator_phase_y = start_y_plus_start_step_y + two_pi;
            state->estimator_start_y = state->estimator_phase_y;
        } else {
            state->estimator_phase_y = start_y_plus_start_step_y;
            state->estimator_start_y = start_y_plus_start_step_y;
        }
        state->estimator_yaw = estimator_yaw_last_good;
        state->estimator_searching = 1u;
        state->estimator_ambiguity_resolved = 0u;
    } else {
        state->estimator_phase_x = X_part_9;
        state->estimator_phase_y = Y_part_6;
        state->estimator_yaw = yaw;
        if (converged && estimator_yaw_last_good_test) {
            state->estimator_searching = 0u;
        }
        state->estimator_ambiguity_resolved = hall_position_flag(valid_test_4);
    }
    if (valid_test_4 && estimator_yaw_last_good_test) {
        state->estimator_yaw_last_good = yaw;
    }
    state->estimator_pitch_x = hall_position_limit(pitch_x_plus_X_part_10, 8.0f);
    state->estimator_pitch_y = hall_position_limit(pitch_y_plus_Y_part_7, 8.0f);
    float estimator_motion_x_part_2 = 0.0f;
    float estimator_motion_y_part_2 = 0.0f;
    float estimator_motion_yaw_part_2 = 0.0f;
    if (!(estimator_searching != 0u)) {
        estimator_motion_x_part_2 = estimator_motion_x + estimator_motion_x_part;
        estimator_motion_y_part_2 = estimator_motion_y + estimator_motion_y_part;
        estimator_motion_yaw_part_2 = estimator_motion_yaw + estimator_motion_yaw_part;
    }
    state->estimator_motion_x = hall_position_limit(estimator_motion_x_part_2, 0.5f);
    state->estimator_motion_y = hall_position_limit(estimator_motion_y_part_2, 0.5f);
    state->estimator_motion_yaw = hall_position_limit(estimator_motion_yaw_part_2, max_yaw_step);
    state->estimator_residual_faults = (X_test) ? ((estimator_phase_x_test) ? 0u : (estimator_residual_faults + 1u)) : 0u;
    const uint32_t estimator_acquired = state->estimator_acquired;
    state->estimator_acquired = hall_position_flag(valid_test_4 || (estimator_acquired != 0u));
    state->estimator_lock_lost = hall_position_flag((estimator_lock_lost != 0u) || ((estimator_acquired != 0u) && (estimator_phase_x_test_2 || !valid_test_2 || (((valid_test_4) ? yaw_limit : ambiguous_yaw_limit) < yaw_size))));
    out->valid = valid ? 1.0f : 0.0f;
    out->lock_lost = (float)estimator_lock_lost;

    return faults;
}
