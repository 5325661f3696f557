/* hall_position_three. Generated: do not edit. */
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

/* yaw_fraction_cosine; x = estimator_yaw + estimator_motion_yaw in -3.28181362 .. 3.28181362, t = x^2; relative error
 * at most 1.4e-07. */
static inline float yaw_fraction_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.031249862f + (t * (0.00016270163f + (t * -3.3074548e-07f)))));
}

/* f3_polynomial / x; x = (estimator_phase_x + estimator_motion_x) + ((-1.5812683 * (1 - (0.5 * (clamp((...), -2, 2) *
 * clamp((...), -2, 2))))) - (1.5833627 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.80622387 .. 6.80622435, t = x^2; relative error at most 1.2e-07. */
static inline float f3_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552044f + (t * (2.5426283e-07f + (t * -9.2772345e-11f)))));
}

/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((-1.5812683 * (1 - (0.5 * (clamp((...), -2, 2)
 * * clamp((...), -2, 2))))) - (1.5833627 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.80622387 .. 6.80622435, t = x^2; relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124604f + (t * (1.01684145e-05f + (t * -5.1597757e-09f)))));
}

/* f5_polynomial / x; x = (estimator_phase_y + estimator_motion_y) + ((1.5833627 * (1 - (0.5 * (clamp((...), -2, 2) *
 * clamp((...), -2, 2))))) - (1.5812683 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.80622435 .. 6.80622387, t = x^2; relative error at most 1.2e-07. */
static inline float f5_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552044f + (t * (2.5426283e-07f + (t * -9.2772345e-11f)))));
}

/* phase_fraction_cosine; x = (estimator_phase_y + estimator_motion_y) + ((1.5833627 * (1 - (0.5 * (clamp((...), -2, 2)
 * * clamp((...), -2, 2))))) - (1.5812683 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.80622435 .. 6.80622387, t = x^2; relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_2_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124604f + (t * (1.01684145e-05f + (t * -5.1597757e-09f)))));
}

/* f7_polynomial / x; x = (estimator_phase_x + estimator_motion_x) + ((-0.0858701992 * (1 - (0.5 * ((...) * (...))))) -
 * (0.081681409 * clamp((clamp((...), -2, 2) * (1 - (...))), -1, 1))) in -3.80914426 .. 3.8091445, t = x^2; relative
 * error at most 1.7e-07. */
static inline float f7_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551005f + (t * 2.5227982e-07f)));
}

/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((-0.0858701992 * (1 - (0.5 * ((...) *
 * (...))))) - (0.081681409 * clamp((clamp((...), -2, 2) * (1 - (...))), -1, 1))) in -3.80914426 .. 3.8091445, t = x^2;
 * relative error at most 6e-08. */
static inline float phase_fraction_cosine_3_polynomial(float t)
{
    return 1.0f + (t * (-0.007812499f + (t * (1.017216e-05f + (t * -5.2561466e-09f)))));
}

/* f9_polynomial / x; x = (estimator_phase_y + estimator_motion_y) + ((0.081681409 * (1 - (0.5 * (clamp((...), -2, 2) *
 * clamp((...), -2, 2))))) - (0.0858701992 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -3.8091445 .. 3.80914426, t = x^2; relative error at most 1.7e-07. */
static inline float f9_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551005f + (t * 2.5227982e-07f)));
}

/* phase_fraction_cosine; x = (estimator_phase_y + estimator_motion_y) + ((0.081681409 * (1 - (0.5 * (clamp((...), -2,
 * 2) * clamp((...), -2, 2))))) - (0.0858701992 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -3.8091445 .. 3.80914426, t = x^2; relative error at most 6e-08. */
static inline float phase_fraction_cosine_4_polynomial(float t)
{
    return 1.0f + (t * (-0.007812499f + (t * (1.017216e-05f + (t * -5.2561466e-09f)))));
}

/* f11_polynomial / x; x = (estimator_phase_x + estimator_motion_x) + ((1.6671385 * (1 - (0.5 * (clamp((...), -2, 2) *
 * clamp((...), -2, 2))))) + (1.66504411 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.97377586 .. 6.97377586, t = x^2; relative error at most 1.2e-07. */
static inline float f11_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552038f + (t * (2.5425797e-07f + (t * -9.268511e-11f)))));
}

/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((1.6671385 * (1 - (0.5 * (clamp((...), -2, 2)
 * * clamp((...), -2, 2))))) + (1.66504411 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.97377586 .. 6.97377586, t = x^2; relative error at most 1.9e-07. */
static inline float phase_fraction_cosine_5_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124558f + (t * (1.016805e-05f + (t * -5.1534967e-09f)))));
}

/* yaw_change_sine / x; x = clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (0.874383744 +
 * (((...) * (...)) + ((...) * (...))))), -0.140220856, 0.140220856) in -0.140220851 .. 0.140220851, t = x^2; relative
 * error at most 1.2e-07. */
static inline float yaw_change_sine_polynomial(float t)
{
    return 1.0f + (t * (-0.16666663f + (t * 0.008327514f)));
}

/* half_yaw_change_sine / x; x = clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) /
 * (0.874383744 + (((...) * (...)) + ((...) * (...))))), -0.140220856, 0.140220856) in -0.140220851 .. 0.140220851, t =
 * x^2; relative error at most 1.4e-07. */
static inline float half_yaw_change_sine_polynomial(float t)
{
    return 0.70710677f + (t * -0.02945674f);
}

/* f15_polynomial; x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) -
 * ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in
 * -0.973355532 .. 0.973355532, t = x^2; relative error at most 1.3e-07. */
static inline float f15_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666433f + (t * (-0.0013882653f + (t * 2.410944e-05f)))))));
}

/* f16_polynomial / x; x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) -
 * ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in
 * -0.973355532 .. 0.973355532, t = x^2; relative error at most 1.2e-07. */
static inline float f16_polynomial(float t)
{
    return 1.0f + (t * (-0.16666621f + (t * (0.008330511f + (t * -0.00019337481f)))));
}

/* f17_polynomial; x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) -
 * ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in
 * -0.525061905 .. 0.525061905, t = x^2; relative error at most 6e-08. */
static inline float f17_polynomial(float t)
{
    return 1.0f + (t * (-0.4999999f + (t * (0.041664626f + (t * -0.0013759097f)))));
}

/* f18_polynomial / x; x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) -
 * ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in
 * -0.525061905 .. 0.525061905, t = x^2; relative error at most 2.3e-07. */
static inline float f18_polynomial(float t)
{
    return 0.9999999f + (t * (-0.16665833f + (t * 0.008251845f)));
}

/* f19_polynomial; x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) -
 * ((((...) + (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in
 * -0.998417377 .. 0.998417377, t = x^2; relative error at most 1.4e-07. */
static inline float f19_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666426f + (t * (-0.0013882434f + (t * 2.4094079e-05f)))))));
}

/* f20_polynomial / x; x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) -
 * ((((...) + (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in
 * -0.998417377 .. 0.998417377, t = x^2; relative error at most 1.2e-07. */
static inline float f20_polynomial(float t)
{
    return 1.0f + (t * (-0.16666614f + (t * (0.008330212f + (t * -0.00019311559f)))));
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
    static const float arm_ax = -1.5812683f; /* rad; w times the place of sensor a from the centre, along x */
    static const float arm_ay = 1.5833627f; /* rad; w times the place of sensor a from the centre, along y */
    static const float arm_bx = -0.0858702f; /* rad; w times the place of sensor b from the centre, along x */
    static const float arm_by = 0.08168141f; /* rad; w times the place of sensor b from the centre, along y */
    static const float arm_cx = 1.6671385f; /* rad; w times the place of sensor c from the centre, along x */
    static const float arm_cy = -1.6650441f; /* rad; w times the place of sensor c from the centre, along y */
    static const float damping = 0.00992376f;                   /* V^2; 0.001 alpha^2: weight of the prior */
    static const float yaw_damping = 0.87438375f;               /* V^2; damping (5 radius)^2 */
    static const float max_yaw_step = 0.14022085f;              /* rad; moves no sensor by more than 0.5 rad of phase */
    static const float squared_yaw_arm = 88.11012f;             /* 1; (5 radius)^2 */
    static const float cost_factor = 1.000002f;                 /* 1; rise of the cost that rounding may cause */
    static const float cost_slack = 1e-08f; /* V^2; rise of the cost that rounding may cause, also converged_decrease */
    static const float squared_residual_limit = 0.01f;          /* V^2; above: a residual fault */
    static const float innovation_gate = 0.030115018f;          /* rad; 3 deviation / sqrt(damping) */
    static const float squared_radius = 3.524405f;              /* 1; radius^2 */
    static const float yaw_window = 0.08726646f;                /* rad; about the last good yaw */
    static const float pi = 3.1415927f;                         /* 1; pi */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    static const float metre_per_rad = 0.008085071f;            /* m/rad; 1 / w */
    static const float pitch = 0.0508f;                         /* m; pitch of the magnet matrix */
    static const float centre_x = 0.0060790665f;                /* m; centre of the sensors */
    static const float centre_y = -0.0040132f;                  /* m; centre of the sensors */
    static const float wave_number = 123.68475f;                /* rad/m; w */
    static const float undamped_yaw = 0.03497535f;              /* V^2; damping radius^2 */
    static const float deviation_over_w = 8.085071e-06f;        /* V m/rad; deviation / w */
    static const float deviation = 0.001f;                      /* V; standard deviation of a voltage */
    static const float least_square = 1e-30f;                   /* V^2; keeps the argument of a root positive */
    static const float damped_weight = 15.115238f;              /* 1/V^2; above: the pose is damped */
    static const float unambiguous_weight = 1.612292f;          /* 1/V^2; at most: the pose is unambiguous */
    static const float yaw_limit = 0.17453292f;                 /* rad; largest yaw that is valid */
    static const float start_step_x = 1.5401491f;               /* rad; from one start of the search to the next */
    static const float start_step_y = 2.702773f;                /* rad; from one start of the search to the next */
    static const float yaw_gain = 0.1f;                         /* 1; of a correction, in the motion */
    static const float ambiguous_yaw_limit = 0.34906584f;       /* rad; of a pose that is not yet unambiguous */
    static const float squared_inconsistent = 1.6e-05f;         /* V^2; above: the voltages are inconsistent */
    static const float others_agree = 0.076f;                   /* V^2; innovations of healthy sensors */
    static const float contrast = 25.0f;                        /* 1; of squared innovations, to exclude a sensor */
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
     *     phase_fraction_cosine = cos(0.125 * (phase_y + motion_y + arm_cx * limit(limit(4 * (sin(0.25 * (yaw
     *         + motion_yaw)) * yaw_fraction_cosine), 2) * (1 - 0.125 * yaw_fraction_sine^2), 1) - -arm_cy * (1
     *         - 0.5 * limit(4 * (sin(0.25 * (yaw + motion_yaw)) * yaw_fraction_cosine), 2)^2))) */
    const float estimator_motion_yaw = state->estimator_motion_yaw;
    const float prediction_yaw = state->estimator_yaw + estimator_motion_yaw;
    const float f1_argument = prediction_yaw * prediction_yaw;
    const float f1 = prediction_yaw * f1_polynomial(f1_argument);
    const float yaw_fraction_sine = 4.0f * f1;
    const float yaw_fraction_cosine = yaw_fraction_cosine_polynomial(f1_argument);
    const float estimator_motion_x = state->estimator_motion_x;
    const float prediction_phase_x = state->estimator_phase_x + estimator_motion_x;
    const float s_phase_fraction_sine = hall_position_three_limit(4.0f * (f1 * yaw_fraction_cosine), 2.0f);
    const float heading_cosine = 1.0f - (0.5f * (s_phase_fraction_sine * s_phase_fraction_sine));
    const float heading_sine = hall_position_three_limit(s_phase_fraction_sine * (1.0f -
        (0.125f * (yaw_fraction_sine * yaw_fraction_sine))), 1.0f);
    const float x_phase_fraction_sine = (arm_ax * heading_cosine) - (arm_ay * heading_sine);
    const float at_1_phase_fraction_sine = prediction_phase_x + x_phase_fraction_sine;
    const float f3_argument = at_1_phase_fraction_sine * at_1_phase_fraction_sine;
    const float f3 = at_1_phase_fraction_sine * f3_polynomial(f3_argument);
    const float phase_fraction_sine = 8.0f * f3;
    const float phase_fraction_cosine = phase_fraction_cosine_polynomial(f3_argument);
    const float estimator_motion_y = state->estimator_motion_y;
    const float prediction_phase_y = state->estimator_phase_y + estimator_motion_y;
    const float y_phase_fraction_sine = (arm_ay * heading_cosine) - (-arm_ax * heading_sine);
    const float at_2_phase_fraction_sine = prediction_phase_y + y_phase_fraction_sine;
    const float f5_argument = at_2_phase_fraction_sine * at_2_phase_fraction_sine;
    const float f5 = at_2_phase_fraction_sine * f5_polynomial(f5_argument);
    const float phase_fraction_sine_2 = 8.0f * f5;
    const float phase_fraction_cosine_2 = phase_fraction_cosine_2_polynomial(f5_argument);
    const float x_phase_fraction_sine_2 = (arm_bx * heading_cosine) - (arm_by * heading_sine);
    const float at_1_phase_fraction_sine_2 = prediction_phase_x + x_phase_fraction_sine_2;
    const float f7_argument = at_1_phase_fraction_sine_2 * at_1_phase_fraction_sine_2;
    const float f7 = at_1_phase_fraction_sine_2 * f7_polynomial(f7_argument);
    const float phase_fraction_sine_3 = 8.0f * f7;
    const float phase_fraction_cosine_3 = phase_fraction_cosine_3_polynomial(f7_argument);
    const float y_phase_fraction_sine_2 = (arm_by * heading_cosine) - (-arm_bx * heading_sine);
    const float at_2_phase_fraction_sine_2 = prediction_phase_y + y_phase_fraction_sine_2;
    const float f9_argument = at_2_phase_fraction_sine_2 * at_2_phase_fraction_sine_2;
    const float f9 = at_2_phase_fraction_sine_2 * f9_polynomial(f9_argument);
    const float phase_fraction_sine_4 = 8.0f * f9;
    const float phase_fraction_cosine_4 = phase_fraction_cosine_4_polynomial(f9_argument);
    const float x_phase_fraction_sine_3 = (arm_cx * heading_cosine) + (-arm_cy * heading_sine);
    const float at_1_phase_fraction_sine_3 = prediction_phase_x + x_phase_fraction_sine_3;
    const float f11_argument = at_1_phase_fraction_sine_3 * at_1_phase_fraction_sine_3;
    const float f11 = at_1_phase_fraction_sine_3 * f11_polynomial(f11_argument);
    const float phase_fraction_sine_5 = 8.0f * f11;
    const float phase_fraction_cosine_5 = phase_fraction_cosine_5_polynomial(f11_argument);
    const float y_phase_fraction_sine_3 = (arm_cx * heading_sine) - (-arm_cy * heading_cosine);
    const float at_2_phase_fraction_sine_3 = prediction_phase_y + y_phase_fraction_sine_3;
    const float f11_argument_2 = at_2_phase_fraction_sine_3 * at_2_phase_fraction_sine_3;
    const float f11_2 = at_2_phase_fraction_sine_3 * f11_polynomial(f11_argument_2);
    const float phase_fraction_sine_6 = 8.0f * f11_2;
    const float phase_fraction_cosine_6 = phase_fraction_cosine_5_polynomial(f11_argument_2);
    const uint32_t estimator_excluded_sensor = state->estimator_excluded_sensor;
    const bool excluded_1 = fault_V_ax || fault_V_ay || (estimator_excluded_sensor == 1u);
    const float cost_0_part = 1.0f - (excluded_1 ? 1.0f : 0.0f);
    const float vx_cost_0 = cost_0_part * V_ax_held;
    const float vy_cost_0 = cost_0_part * V_ay_held;
    const float volts_cosine_cost_0 = (heading_cosine * vx_cost_0) - (heading_sine * vy_cost_0);
    const float cost_0_part_2 = f3 * phase_fraction_cosine;
    const float s_cost_0 = hall_position_three_limit(8.0f *
        (cost_0_part_2 * (1.0f - (0.03125f * (phase_fraction_sine * phase_fraction_sine)))), 2.0f);
    const float sines_2_cost_0 = 8.0f * cost_0_part_2;
    const float x_sine_cost_0 = hall_position_three_limit(s_cost_0 * (1.0f -
        (0.125f * (sines_2_cost_0 * sines_2_cost_0))), 1.0f);
    const float field_2_cost_0 = cost_0_part * estimator_field_1;
    const float x_sine_cost_0_squared = x_sine_cost_0 * x_sine_cost_0;
    const float field_3_cost_0 = cost_0_part * estimator_field_3;
    const float field_4_cost_0 = cost_0_part * estimator_field_5;
    const float B_1_cost_0 = x_sine_cost_0 * (field_2_cost_0 +
        (x_sine_cost_0_squared * (field_3_cost_0 + (x_sine_cost_0_squared * field_4_cost_0))));
    const float residuals_1 = volts_cosine_cost_0 - B_1_cost_0;
    const float terms_1_cost_0 = residuals_1 * residuals_1;
    const bool excluded_2 = fault_V_bx || fault_V_by || (estimator_excluded_sensor == 2u);
    const float cost_0_part_3 = 1.0f - (excluded_2 ? 1.0f : 0.0f);
    const float vx_cost_0_2 = cost_0_part_3 * V_bx_held;
    const float vy_cost_0_2 = cost_0_part_3 * V_by_held;
    const float volts_cosine_cost_0_2 = (heading_cosine * vx_cost_0_2) - (heading_sine * vy_cost_0_2);
    const float cost_0_part_4 = f7 * phase_fraction_cosine_3;
    const float s_cost_0_2 = hall_position_three_limit(8.0f *
        (cost_0_part_4 * (1.0f - (0.03125f * (phase_fraction_sine_3 * phase_fraction_sine_3)))), 2.0f);
    const float sines_2_cost_0_2 = 8.0f * cost_0_part_4;
    const float x_sine_cost_0_2 = hall_position_three_limit(s_cost_0_2 * (1.0f -
        (0.125f * (sines_2_cost_0_2 * sines_2_cost_0_2))), 1.0f);
    const float field_2_cost_0_2 = cost_0_part_3 * estimator_field_1;
    const float x_sine_cost_0_2_squared = x_sine_cost_0_2 * x_sine_cost_0_2;
    const float field_3_cost_0_2 = cost_0_part_3 * estimator_field_3;
    const float field_4_cost_0_2 = cost_0_part_3 * estimator_field_5;
    const float B_1_cost_0_2 = x_sine_cost_0_2 * (field_2_cost_0_2 +
        (x_sine_cost_0_2_squared * (field_3_cost_0_2 + (x_sine_cost_0_2_squared * field_4_cost_0_2))));
    const float residuals_2 = volts_cosine_cost_0_2 - B_1_cost_0_2;
    const float terms_2_cost_0 = residuals_2 * residuals_2;
    const bool excluded_3 = fault_V_cx || fault_V_cy || (estimator_excluded_sensor == 3u);
    const float cost_0_part_5 = 1.0f - (excluded_3 ? 1.0f : 0.0f);
    const float vx_cost_0_3 = cost_0_part_5 * V_cx_held;
    const float vy_cost_0_3 = cost_0_part_5 * V_cy_held;
    const float volts_cosine_cost_0_3 = (heading_cosine * vx_cost_0_3) - (heading_sine * vy_cost_0_3);
    const float cost_0_part_6 = f11 * phase_fraction_cosine_5;
    const float s_cost_0_3 = hall_position_three_limit(8.0f *
        (cost_0_part_6 * (1.0f - (0.03125f * (phase_fraction_sine_5 * phase_fraction_sine_5)))), 2.0f);
    const float sines_2_cost_0_3 = 8.0f * cost_0_part_6;
    const float x_sine_cost_0_3 = hall_position_three_limit(s_cost_0_3 * (1.0f -
        (0.125f * (sines_2_cost_0_3 * sines_2_cost_0_3))), 1.0f);
    const float field_2_cost_0_3 = cost_0_part_5 * estimator_field_1;
    const float x_sine_cost_0_3_squared = x_sine_cost_0_3 * x_sine_cost_0_3;
    const float field_3_cost_0_3 = cost_0_part_5 * estimator_field_3;
    const float field_4_cost_0_3 = cost_0_part_5 * estimator_field_5;
    const float B_1_cost_0_3 = x_sine_cost_0_3 * (field_2_cost_0_3 +
        (x_sine_cost_0_3_squared * (field_3_cost_0_3 + (x_sine_cost_0_3_squared * field_4_cost_0_3))));
    const float residuals_3 = volts_cosine_cost_0_3 - B_1_cost_0_3;
    const float terms_3_cost_0 = residuals_3 * residuals_3;
    const float volts_sine_cost_0 = (heading_sine * vx_cost_0) + (heading_cosine * vy_cost_0);
    const float cost_0_part_7 = f5 * phase_fraction_cosine_2;
    const float s_cost_0_4 = hall_position_three_limit(8.0f *
        (cost_0_part_7 * (1.0f - (0.03125f * (phase_fraction_sine_2 * phase_fraction_sine_2)))), 2.0f);
    const float sines_2_cost_0_4 = 8.0f * cost_0_part_7;
    const float p_sine_cost_0 = hall_position_three_limit(s_cost_0_4 * (1.0f -
        (0.125f * (sines_2_cost_0_4 * sines_2_cost_0_4))), 1.0f);
    const float q_cost_0 = p_sine_cost_0 * p_sine_cost_0;
    const float B_2_cost_0 = p_sine_cost_0 * (field_2_cost_0 +
        (q_cost_0 * (field_3_cost_0 + (q_cost_0 * field_4_cost_0))));
    const float residuals_4 = volts_sine_cost_0 - B_2_cost_0;
    const float terms_4_cost_0 = residuals_4 * residuals_4;
    const float volts_sine_cost_0_2 = (heading_sine * vx_cost_0_2) + (heading_cosine * vy_cost_0_2);
    const float cost_0_part_8 = f9 * phase_fraction_cosine_4;
    const float s_cost_0_5 = hall_position_three_limit(8.0f *
        (cost_0_part_8 * (1.0f - (0.03125f * (phase_fraction_sine_4 * phase_fraction_sine_4)))), 2.0f);
    const float sines_2_cost_0_5 = 8.0f * cost_0_part_8;
    const float p_sine_cost_0_2 = hall_position_three_limit(s_cost_0_5 * (1.0f -
        (0.125f * (sines_2_cost_0_5 * sines_2_cost_0_5))), 1.0f);
    const float q_cost_0_2 = p_sine_cost_0_2 * p_sine_cost_0_2;
    const float B_2_cost_0_2 = p_sine_cost_0_2 * (field_2_cost_0_2 +
        (q_cost_0_2 * (field_3_cost_0_2 + (q_cost_0_2 * field_4_cost_0_2))));
    const float residuals_5 = volts_sine_cost_0_2 - B_2_cost_0_2;
    const float terms_5_cost_0 = residuals_5 * residuals_5;
    const float volts_sine_cost_0_3 = (heading_sine * vx_cost_0_3) + (heading_cosine * vy_cost_0_3);
    const float cost_0_part_9 = f11_2 * phase_fraction_cosine_6;
    const float s_cost_0_6 = hall_position_three_limit(8.0f *
        (cost_0_part_9 * (1.0f - (0.03125f * (phase_fraction_sine_6 * phase_fraction_sine_6)))), 2.0f);
    const float sines_2_cost_0_6 = 8.0f * cost_0_part_9;
    const float p_sine_cost_0_3 = hall_position_three_limit(s_cost_0_6 * (1.0f -
        (0.125f * (sines_2_cost_0_6 * sines_2_cost_0_6))), 1.0f);
    const float q_cost_0_3 = p_sine_cost_0_3 * p_sine_cost_0_3;
    const float B_2_cost_0_3 = p_sine_cost_0_3 * (field_2_cost_0_3 +
        (q_cost_0_3 * (field_3_cost_0_3 + (q_cost_0_3 * field_4_cost_0_3))));
    const float residuals_6 = volts_sine_cost_0_3 - B_2_cost_0_3;
    const float terms_6_cost_0 = residuals_6 * residuals_6;
    const float cost_0 = terms_1_cost_0 + terms_2_cost_0 + terms_3_cost_0 + terms_4_cost_0 + terms_5_cost_0 +
        terms_6_cost_0;
    const float x_cosine_yaw_change_sine = 1.0f - (0.5f * (s_cost_0 * s_cost_0));
    const float slope_1_yaw_change_sine = cost_0_part * estimator_slope_0;
    const float slope_2_yaw_change_sine = cost_0_part * estimator_slope_2;
    const float slope_3_yaw_change_sine = cost_0_part * estimator_slope_4;
    const float yaw_change_sine_part = x_cosine_yaw_change_sine * (slope_1_yaw_change_sine +
        (x_sine_cost_0_squared * (slope_2_yaw_change_sine + (x_sine_cost_0_squared * slope_3_yaw_change_sine))));
    const float yaw_change_sine_part_2 = B_2_cost_0 - (yaw_change_sine_part * y_phase_fraction_sine);
    const float x_cosine_yaw_change_sine_2 = 1.0f - (0.5f * (s_cost_0_2 * s_cost_0_2));
    const float slope_1_yaw_change_sine_2 = cost_0_part_3 * estimator_slope_0;
    const float slope_2_yaw_change_sine_2 = cost_0_part_3 * estimator_slope_2;
    const float slope_3_yaw_change_sine_2 = cost_0_part_3 * estimator_slope_4;
    const float yaw_change_sine_part_3 = x_cosine_yaw_change_sine_2 * (slope_1_yaw_change_sine_2 +
        (x_sine_cost_0_2_squared * (slope_2_yaw_change_sine_2 +
        (x_sine_cost_0_2_squared * slope_3_yaw_change_sine_2))));
    const float yaw_change_sine_part_4 = B_2_cost_0_2 - (yaw_change_sine_part_3 * y_phase_fraction_sine_2);
    const float x_cosine_yaw_change_sine_3 = 1.0f - (0.5f * (s_cost_0_3 * s_cost_0_3));
    const float slope_1_yaw_change_sine_3 = cost_0_part_5 * estimator_slope_0;
    const float slope_2_yaw_change_sine_3 = cost_0_part_5 * estimator_slope_2;
    const float slope_3_yaw_change_sine_3 = cost_0_part_5 * estimator_slope_4;
    const float yaw_change_sine_part_5 = x_cosine_yaw_change_sine_3 * (slope_1_yaw_change_sine_3 +
        (x_sine_cost_0_3_squared * (slope_2_yaw_change_sine_3 +
        (x_sine_cost_0_3_squared * slope_3_yaw_change_sine_3))));
    const float yaw_change_sine_part_6 = B_2_cost_0_3 - (yaw_change_sine_part_5 * y_phase_fraction_sine_3);
    const float yaw_change_sine_part_7 = (yaw_change_sine_part * yaw_change_sine_part_4) -
        (yaw_change_sine_part_3 * yaw_change_sine_part_2);
    const float yaw_change_sine_part_8 = (yaw_change_sine_part * yaw_change_sine_part_6) -
        (yaw_change_sine_part_5 * yaw_change_sine_part_2);
    const float yaw_change_sine_part_9 = (damping * ((yaw_change_sine_part_2 * residuals_1) +
        (yaw_change_sine_part_4 * residuals_2) + (yaw_change_sine_part_6 * residuals_3))) +
        (yaw_change_sine_part_7 * ((yaw_change_sine_part * residuals_2) - (yaw_change_sine_part_3 * residuals_1))) +
        (yaw_change_sine_part_8 * ((yaw_change_sine_part * residuals_3) - (yaw_change_sine_part_5 * residuals_1)));
    const float across_yaw_change_sine = (yaw_change_sine_part_3 * yaw_change_sine_part_6) -
        (yaw_change_sine_part_5 * yaw_change_sine_part_4);
    const float yaw_change_sine_part_10 = 1.0f / (damping + ((yaw_change_sine_part * yaw_change_sine_part) +
        (yaw_change_sine_part_3 * yaw_change_sine_part_3) + (yaw_change_sine_part_5 * yaw_change_sine_part_5)));
    const float p_cosine_yaw_change_sine = 1.0f - (0.5f * (s_cost_0_4 * s_cost_0_4));
    const float yaw_change_sine_part_11 = p_cosine_yaw_change_sine * (slope_1_yaw_change_sine +
        (q_cost_0 * (slope_2_yaw_change_sine + (q_cost_0 * slope_3_yaw_change_sine))));
    const float yaw_change_sine_part_12 = (yaw_change_sine_part_11 * x_phase_fraction_sine) - B_1_cost_0;
    const float p_cosine_yaw_change_sine_2 = 1.0f - (0.5f * (s_cost_0_5 * s_cost_0_5));
    const float yaw_change_sine_part_13 = p_cosine_yaw_change_sine_2 * (slope_1_yaw_change_sine_2 +
        (q_cost_0_2 * (slope_2_yaw_change_sine_2 + (q_cost_0_2 * slope_3_yaw_change_sine_2))));
    const float yaw_change_sine_part_14 = (yaw_change_sine_part_13 * x_phase_fraction_sine_2) - B_1_cost_0_2;
    const float p_cosine_yaw_change_sine_3 = 1.0f - (0.5f * (s_cost_0_6 * s_cost_0_6));
    const float yaw_change_sine_part_15 = p_cosine_yaw_change_sine_3 * (slope_1_yaw_change_sine_3 +
        (q_cost_0_3 * (slope_2_yaw_change_sine_3 + (q_cost_0_3 * slope_3_yaw_change_sine_3))));
    const float yaw_change_sine_part_16 = (yaw_change_sine_part_15 * x_phase_fraction_sine_3) - B_1_cost_0_3;
    const float yaw_change_sine_part_17 = (yaw_change_sine_part_11 * yaw_change_sine_part_14) -
        (yaw_change_sine_part_13 * yaw_change_sine_part_12);
    const float yaw_change_sine_part_18 = (yaw_change_sine_part_11 * yaw_change_sine_part_16) -
        (yaw_change_sine_part_15 * yaw_change_sine_part_12);
    const float yaw_change_sine_part_19 = (damping * ((yaw_change_sine_part_12 * residuals_4) +
        (yaw_change_sine_part_14 * residuals_5) + (yaw_change_sine_part_16 * residuals_6))) + (yaw_change_sine_part_17 *
        ((yaw_change_sine_part_11 * residuals_5) - (yaw_change_sine_part_13 * residuals_4))) +
        (yaw_change_sine_part_18 * ((yaw_change_sine_part_11 * residuals_6) - (yaw_change_sine_part_15 * residuals_4)));
    const float across_yaw_change_sine_2 = (yaw_change_sine_part_13 * yaw_change_sine_part_16) -
        (yaw_change_sine_part_15 * yaw_change_sine_part_14);
    const float yaw_change_sine_part_20 = 1.0f / (damping + ((yaw_change_sine_part_11 * yaw_change_sine_part_11) +
        (yaw_change_sine_part_13 * yaw_change_sine_part_13) + (yaw_change_sine_part_15 * yaw_change_sine_part_15)));
    const float data_yaw_change_sine = (((damping * ((yaw_change_sine_part_2 * yaw_change_sine_part_2) +
        (yaw_change_sine_part_4 * yaw_change_sine_part_4) + (yaw_change_sine_part_6 * yaw_change_sine_part_6))) +
        (yaw_change_sine_part_7 * yaw_change_sine_part_7) + (yaw_change_sine_part_8 * yaw_change_sine_part_8) +
        (across_yaw_change_sine * across_yaw_change_sine)) * yaw_change_sine_part_10) +
        (((damping * ((yaw_change_sine_part_12 * yaw_change_sine_part_12) +
        (yaw_change_sine_part_14 * yaw_change_sine_part_14) + (yaw_change_sine_part_16 * yaw_change_sine_part_16))) +
        (yaw_change_sine_part_17 * yaw_change_sine_part_17) + (yaw_change_sine_part_18 * yaw_change_sine_part_18) +
        (across_yaw_change_sine_2 * across_yaw_change_sine_2)) * yaw_change_sine_part_20);
    const float step_yaw_change_sine = (((yaw_change_sine_part_9 + (across_yaw_change_sine *
        ((yaw_change_sine_part_3 * residuals_3) - (yaw_change_sine_part_5 * residuals_2)))) * yaw_change_sine_part_10) +
        ((yaw_change_sine_part_19 + (across_yaw_change_sine_2 * ((yaw_change_sine_part_13 * residuals_6) -
        (yaw_change_sine_part_15 * residuals_5)))) * yaw_change_sine_part_20)) / (yaw_damping + data_yaw_change_sine);
    const float then_3_yaw_change_sine = hall_position_three_limit(step_yaw_change_sine, max_yaw_step);
    const float yaw_change_sine_part_21 = then_3_yaw_change_sine * then_3_yaw_change_sine;
    const float yaw_change_sine = then_3_yaw_change_sine * yaw_change_sine_polynomial(yaw_change_sine_part_21);
    const float half_yaw_change_sine = then_3_yaw_change_sine *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_21);
    const float versine_cost_1 = half_yaw_change_sine * half_yaw_change_sine;
    const float rotation_cosine_cost_1 = 1.0f - versine_cost_1;
    const float then_1_cost_1 = hall_position_three_limit(((yaw_change_sine_part * residuals_1) +
        (yaw_change_sine_part_3 * residuals_2) + (yaw_change_sine_part_5 * residuals_3) -
        (((yaw_change_sine_part * yaw_change_sine_part_2) + (yaw_change_sine_part_3 * yaw_change_sine_part_4) +
        (yaw_change_sine_part_5 * yaw_change_sine_part_6)) * then_3_yaw_change_sine)) * yaw_change_sine_part_10, 0.5f);
    const float cost_1_part = (x_phase_fraction_sine * versine_cost_1) + (y_phase_fraction_sine * yaw_change_sine);
    const float angle_cost_1 = then_1_cost_1 - cost_1_part;
    const float f15_argument = angle_cost_1 * angle_cost_1;
    const float by_cosine_cost_1 = f15_polynomial(f15_argument);
    const float by_sine_cost_1 = angle_cost_1 * f16_polynomial(f15_argument);
    const float phases_1_sine_cost_1 = (x_sine_cost_0 * by_cosine_cost_1) + (x_cosine_yaw_change_sine * by_sine_cost_1);
    const float phases_1_sine_cost_1_squared = phases_1_sine_cost_1 * phases_1_sine_cost_1;
    const float B_1_cost_1 = phases_1_sine_cost_1 * (field_2_cost_0 +
        (phases_1_sine_cost_1_squared * (field_3_cost_0 + (phases_1_sine_cost_1_squared * field_4_cost_0))));
    const float by_axis_1_1_e_cost_1 = (volts_cosine_cost_0 * rotation_cosine_cost_1) -
        (volts_sine_cost_0 * yaw_change_sine) - B_1_cost_1;
    const float cost_1_part_2 = (x_phase_fraction_sine_2 * versine_cost_1) +
        (y_phase_fraction_sine_2 * yaw_change_sine);
    const float angle_cost_1_2 = then_1_cost_1 - cost_1_part_2;
    const float f17_argument = angle_cost_1_2 * angle_cost_1_2;
    const float by_cosine_cost_1_2 = f17_polynomial(f17_argument);
    const float by_sine_cost_1_2 = angle_cost_1_2 * f18_polynomial(f17_argument);
    const float phases_1_sine_cost_1_2 = (x_sine_cost_0_2 * by_cosine_cost_1_2) +
        (x_cosine_yaw_change_sine_2 * by_sine_cost_1_2);
    const float cost_1_part_3 = phases_1_sine_cost_1_2 * phases_1_sine_cost_1_2;
    const float B_1_cost_1_2 = phases_1_sine_cost_1_2 * (field_2_cost_0_2 +
        (cost_1_part_3 * (field_3_cost_0_2 + (cost_1_part_3 * field_4_cost_0_2))));
    const float by_axis_1_2_e_cost_1 = (volts_cosine_cost_0_2 * rotation_cosine_cost_1) -
        (volts_sine_cost_0_2 * yaw_change_sine) - B_1_cost_1_2;
    const float cost_1_part_4 = (x_phase_fraction_sine_3 * versine_cost_1) +
        (y_phase_fraction_sine_3 * yaw_change_sine);
    const float angle_cost_1_3 = then_1_cost_1 - cost_1_part_4;
    const float f19_argument = angle_cost_1_3 * angle_cost_1_3;
    const float by_cosine_cost_1_3 = f19_polynomial(f19_argument);
    const float by_sine_cost_1_3 = angle_cost_1_3 * f20_polynomial(f19_argument);
    const float phases_1_sine_cost_1_3 = (x_sine_cost_0_3 * by_cosine_cost_1_3) +
        (x_cosine_yaw_change_sine_3 * by_sine_cost_1_3);
    const float cost_1_part_5 = phases_1_sine_cost_1_3 * phases_1_sine_cost_1_3;
    const float B_1_cost_1_3 = phases_1_sine_cost_1_3 * (field_2_cost_0_3 +
        (cost_1_part_5 * (field_3_cost_0_3 + (cost_1_part_5 * field_4_cost_0_3))));
    const float by_axis_1_3_e_cost_1 = (volts_cosine_cost_0_3 * rotation_cosine_cost_1) -
        (volts_sine_cost_0_3 * yaw_change_sine) - B_1_cost_1_3;
    const float then_2_cost_1 = hall_position_three_limit(((yaw_change_sine_part_11 * residuals_4) +
        (yaw_change_sine_part_13 * residuals_5) + (yaw_change_sine_part_15 * residuals_6) - (((yaw_change_sine_part_11 *
        yaw_change_sine_part_12) + (yaw_change_sine_part_13 * yaw_change_sine_part_14) + (yaw_change_sine_part_15 *
        yaw_change_sine_part_16)) * then_3_yaw_change_sine)) * yaw_change_sine_part_20, 0.5f);
    const float dy_cost_1 = (x_phase_fraction_sine * yaw_change_sine) - (y_phase_fraction_sine * versine_cost_1);
    const float angle_cost_1_4 = then_2_cost_1 + dy_cost_1;
    const float f15_argument_2 = angle_cost_1_4 * angle_cost_1_4;
    const float by_cosine_cost_1_4 = f15_polynomial(f15_argument_2);
    const float by_sine_cost_1_4 = angle_cost_1_4 * f16_polynomial(f15_argument_2);
    const float p_sine_cost_1 = (p_sine_cost_0 * by_cosine_cost_1_4) + (p_cosine_yaw_change_sine * by_sine_cost_1_4);
    const float q_cost_1 = p_sine_cost_1 * p_sine_cost_1;
    const float B_2_cost_1 = p_sine_cost_1 * (field_2_cost_0 +
        (q_cost_1 * (field_3_cost_0 + (q_cost_1 * field_4_cost_0))));
    const float by_axis_2_1_e_cost_1 = (volts_sine_cost_0 * rotation_cosine_cost_1) +
        (volts_cosine_cost_0 * yaw_change_sine) - B_2_cost_1;
    const float dy_cost_1_2 = (x_phase_fraction_sine_2 * yaw_change_sine) - (y_phase_fraction_sine_2 * versine_cost_1);
    const float angle_cost_1_5 = then_2_cost_1 + dy_cost_1_2;
    const float f17_argument_2 = angle_cost_1_5 * angle_cost_1_5;
    const float by_cosine_cost_1_5 = f17_polynomial(f17_argument_2);
    const float by_sine_cost_1_5 = angle_cost_1_5 * f18_polynomial(f17_argument_2);
    const float p_sine_cost_1_2 = (p_sine_cost_0_2 * by_cosine_cost_1_5) +
        (p_cosine_yaw_change_sine_2 * by_sine_cost_1_5);
    const float q_cost_1_2 = p_sine_cost_1_2 * p_sine_cost_1_2;
    const float B_2_cost_1_2 = p_sine_cost_1_2 * (field_2_cost_0_2 +
        (q_cost_1_2 * (field_3_cost_0_2 + (q_cost_1_2 * field_4_cost_0_2))));
    const float by_axis_2_2_e_cost_1 = (volts_sine_cost_0_2 * rotation_cosine_cost_1) +
        (volts_cosine_cost_0_2 * yaw_change_sine) - B_2_cost_1_2;
    const float dy_cost_1_3 = (x_phase_fraction_sine_3 * yaw_change_sine) - (y_phase_fraction_sine_3 * versine_cost_1);
    const float angle_cost_1_6 = then_2_cost_1 + dy_cost_1_3;
    const float f19_argument_2 = angle_cost_1_6 * angle_cost_1_6;
    const float by_cosine_cost_1_6 = f19_polynomial(f19_argument_2);
    const float by_sine_cost_1_6 = angle_cost_1_6 * f20_polynomial(f19_argument_2);
    const float p_sine_cost_1_3 = (p_sine_cost_0_3 * by_cosine_cost_1_6) +
        (p_cosine_yaw_change_sine_3 * by_sine_cost_1_6);
    const float q_cost_1_3 = p_sine_cost_1_3 * p_sine_cost_1_3;
    const float B_2_cost_1_3 = p_sine_cost_1_3 * (field_2_cost_0_3 +
        (q_cost_1_3 * (field_3_cost_0_3 + (q_cost_1_3 * field_4_cost_0_3))));
    const float by_axis_2_3_e_cost_1 = (volts_sine_cost_0_3 * rotation_cosine_cost_1) +
        (volts_cosine_cost_0_3 * yaw_change_sine) - B_2_cost_1_3;
    const float cost_1 = (by_axis_1_1_e_cost_1 * by_axis_1_1_e_cost_1) + (by_axis_1_2_e_cost_1 * by_axis_1_2_e_cost_1) +
        (by_axis_1_3_e_cost_1 * by_axis_1_3_e_cost_1) + (by_axis_2_1_e_cost_1 * by_axis_2_1_e_cost_1) +
        (by_axis_2_2_e_cost_1 * by_axis_2_2_e_cost_1) + (by_axis_2_3_e_cost_1 * by_axis_2_3_e_cost_1) +
        (damping * ((then_1_cost_1 * then_1_cost_1) + (then_2_cost_1 * then_2_cost_1) +
        (squared_yaw_arm * yaw_change_sine_part_21)));
    const bool better_yaw_change_sine = cost_1 <= ((cost_factor * cost_0) + cost_slack);
    const float yaw_change_sine_part_22 = ((x_cosine_yaw_change_sine * by_cosine_cost_1) -
        (x_sine_cost_0 * by_sine_cost_1)) * (slope_1_yaw_change_sine + (phases_1_sine_cost_1_squared *
        (slope_2_yaw_change_sine + (phases_1_sine_cost_1_squared * slope_3_yaw_change_sine))));
    const float yaw_change_sine_part_23 = B_2_cost_1 - (yaw_change_sine_part_22 * (y_phase_fraction_sine + dy_cost_1));
    const float yaw_change_sine_part_24 = ((x_cosine_yaw_change_sine_2 * by_cosine_cost_1_2) -
        (x_sine_cost_0_2 * by_sine_cost_1_2)) * (slope_1_yaw_change_sine_2 +
        (cost_1_part_3 * (slope_2_yaw_change_sine_2 + (cost_1_part_3 * slope_3_yaw_change_sine_2))));
    const float yaw_change_sine_part_25 = B_2_cost_1_2 -
        (yaw_change_sine_part_24 * (y_phase_fraction_sine_2 + dy_cost_1_2));
    const float yaw_change_sine_part_26 = ((x_cosine_yaw_change_sine_3 * by_cosine_cost_1_3) -
        (x_sine_cost_0_3 * by_sine_cost_1_3)) * (slope_1_yaw_change_sine_3 +
        (cost_1_part_5 * (slope_2_yaw_change_sine_3 + (cost_1_part_5 * slope_3_yaw_change_sine_3))));
    const float yaw_change_sine_part_27 = B_2_cost_1_3 -
        (yaw_change_sine_part_26 * (y_phase_fraction_sine_3 + dy_cost_1_3));
    const float yaw_change_sine_part_28 = (yaw_change_sine_part_22 * yaw_change_sine_part_23) +
        (yaw_change_sine_part_24 * yaw_change_sine_part_25) + (yaw_change_sine_part_26 * yaw_change_sine_part_27);
    const float yaw_change_sine_part_29 = (yaw_change_sine_part_22 * yaw_change_sine_part_25) -
        (yaw_change_sine_part_24 * yaw_change_sine_part_23);
    const float yaw_change_sine_part_30 = (yaw_change_sine_part_22 * yaw_change_sine_part_27) -
        (yaw_change_sine_part_26 * yaw_change_sine_part_23);
    const float yaw_change_sine_part_31 = (damping * ((yaw_change_sine_part_23 * by_axis_1_1_e_cost_1) +
        (yaw_change_sine_part_25 * by_axis_1_2_e_cost_1) + (yaw_change_sine_part_27 * by_axis_1_3_e_cost_1) +
        (then_1_cost_1 * yaw_change_sine_part_28))) + (yaw_change_sine_part_29 * ((yaw_change_sine_part_22 *
        by_axis_1_2_e_cost_1) - (yaw_change_sine_part_24 * by_axis_1_1_e_cost_1))) + (yaw_change_sine_part_30 *
        ((yaw_change_sine_part_22 * by_axis_1_3_e_cost_1) - (yaw_change_sine_part_26 * by_axis_1_1_e_cost_1)));
    const float across_yaw_change_sine_3 = (yaw_change_sine_part_24 * yaw_change_sine_part_27) -
        (yaw_change_sine_part_26 * yaw_change_sine_part_25);
    const float yaw_change_sine_part_32 = 1.0f / (damping + ((yaw_change_sine_part_22 * yaw_change_sine_part_22) +
        (yaw_change_sine_part_24 * yaw_change_sine_part_24) + (yaw_change_sine_part_26 * yaw_change_sine_part_26)));
    const float yaw_change_sine_part_33 = ((p_cosine_yaw_change_sine * by_cosine_cost_1_4) -
        (p_sine_cost_0 * by_sine_cost_1_4)) * (slope_1_yaw_change_sine +
        (q_cost_1 * (slope_2_yaw_change_sine + (q_cost_1 * slope_3_yaw_change_sine))));
    const float yaw_change_sine_part_34 = (yaw_change_sine_part_33 * (x_phase_fraction_sine - cost_1_part)) -
        B_1_cost_1;
    const float yaw_change_sine_part_35 = ((p_cosine_yaw_change_sine_2 * by_cosine_cost_1_5) -
        (p_sine_cost_0_2 * by_sine_cost_1_5)) * (slope_1_yaw_change_sine_2 +
        (q_cost_1_2 * (slope_2_yaw_change_sine_2 + (q_cost_1_2 * slope_3_yaw_change_sine_2))));
    const float yaw_change_sine_part_36 = (yaw_change_sine_part_35 * (x_phase_fraction_sine_2 - cost_1_part_2)) -
        B_1_cost_1_2;
    const float yaw_change_sine_part_37 = ((p_cosine_yaw_change_sine_3 * by_cosine_cost_1_6) -
        (p_sine_cost_0_3 * by_sine_cost_1_6)) * (slope_1_yaw_change_sine_3 +
        (q_cost_1_3 * (slope_2_yaw_change_sine_3 + (q_cost_1_3 * slope_3_yaw_change_sine_3))));
    const float yaw_change_sine_part_38 = (yaw_change_sine_part_37 * (x_phase_fraction_sine_3 - cost_1_part_4)) -
        B_1_cost_1_3;
    const float yaw_change_sine_part_39 = (yaw_change_sine_part_33 * yaw_change_sine_part_34) +
        (yaw_change_sine_part_35 * yaw_change_sine_part_36) + (yaw_change_sine_part_37 * yaw_change_sine_part_38);
    const float yaw_change_sine_part_40 = (yaw_change_sine_part_33 * yaw_change_sine_part_36) -
        (yaw_change_sine_part_35 * yaw_change_sine_part_34);
    const float yaw_change_sine_part_41 = (yaw_change_sine_part_33 * yaw_change_sine_part_38) -
        (yaw_change_sine_part_37 * yaw_change_sine_part_34);
    const float yaw_change_sine_part_42 = (damping * ((yaw_change_sine_part_34 * by_axis_2_1_e_cost_1) +
        (yaw_change_sine_part_36 * by_axis_2_2_e_cost_1) + (yaw_change_sine_part_38 * by_axis_2_3_e_cost_1) +
        (then_2_cost_1 * yaw_change_sine_part_39))) + (yaw_change_sine_part_40 * ((yaw_change_sine_part_33 *
        by_axis_2_2_e_cost_1) - (yaw_change_sine_part_35 * by_axis_2_1_e_cost_1))) + (yaw_change_sine_part_41 *
        ((yaw_change_sine_part_33 * by_axis_2_3_e_cost_1) - (yaw_change_sine_part_37 * by_axis_2_1_e_cost_1)));
    const float across_yaw_change_sine_4 = (yaw_change_sine_part_35 * yaw_change_sine_part_38) -
        (yaw_change_sine_part_37 * yaw_change_sine_part_36);
    const float yaw_change_sine_part_43 = 1.0f / (damping + ((yaw_change_sine_part_33 * yaw_change_sine_part_33) +
        (yaw_change_sine_part_35 * yaw_change_sine_part_35) + (yaw_change_sine_part_37 * yaw_change_sine_part_37)));
    const float right_yaw_change_sine = ((yaw_change_sine_part_31 + (across_yaw_change_sine_3 *
        ((yaw_change_sine_part_24 * by_axis_1_3_e_cost_1) - (yaw_change_sine_part_26 * by_axis_1_2_e_cost_1)))) *
        yaw_change_sine_part_32) + ((yaw_change_sine_part_42 + (across_yaw_change_sine_4 * ((yaw_change_sine_part_35 *
        by_axis_2_3_e_cost_1) - (yaw_change_sine_part_37 * by_axis_2_2_e_cost_1)))) * yaw_change_sine_part_43) -
        (yaw_damping * then_3_yaw_change_sine);
    const float data_yaw_change_sine_2 = (((damping * ((yaw_change_sine_part_23 * yaw_change_sine_part_23) +
        (yaw_change_sine_part_25 * yaw_change_sine_part_25) + (yaw_change_sine_part_27 * yaw_change_sine_part_27))) +
        (yaw_change_sine_part_29 * yaw_change_sine_part_29) + (yaw_change_sine_part_30 * yaw_change_sine_part_30) +
        (across_yaw_change_sine_3 * across_yaw_change_sine_3)) * yaw_change_sine_part_32) +
        (((damping * ((yaw_change_sine_part_34 * yaw_change_sine_part_34) +
        (yaw_change_sine_part_36 * yaw_change_sine_part_36) + (yaw_change_sine_part_38 * yaw_change_sine_part_38))) +
        (yaw_change_sine_part_40 * yaw_change_sine_part_40) + (yaw_change_sine_part_41 * yaw_change_sine_part_41) +
        (across_yaw_change_sine_4 * across_yaw_change_sine_4)) * yaw_change_sine_part_43);
    float other_3_yaw_change_sine = then_3_yaw_change_sine;
    float other_1_cost_2 = then_1_cost_1;
    float other_2_cost_2 = then_2_cost_1;
    float yaw_change_sine_part_44 = cost_1;
    if (!better_yaw_change_sine) {
        other_3_yaw_change_sine = 0.0f;
        other_1_cost_2 = 0.0f;
        other_2_cost_2 = 0.0f;
        yaw_change_sine_part_44 = cost_0;
    }
    const float then_3_yaw_change_sine_2 = hall_position_three_limit((better_yaw_change_sine) ?
        (then_3_yaw_change_sine + (right_yaw_change_sine / (yaw_damping + data_yaw_change_sine_2))) :
        (0.5f * (then_3_yaw_change_sine + other_3_yaw_change_sine)), max_yaw_step);
    const float yaw_change_sine_part_45 = then_3_yaw_change_sine_2 * then_3_yaw_change_sine_2;
    const float yaw_change_sine_2 = then_3_yaw_change_sine_2 * yaw_change_sine_polynomial(yaw_change_sine_part_45);
    const float half_yaw_change_sine_2 = then_3_yaw_change_sine_2 *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_45);
    const float versine_cost_2 = half_yaw_change_sine_2 * half_yaw_change_sine_2;
    const float rotation_cosine_cost_2 = 1.0f - versine_cost_2;
    const float yaw_change_cost_2 = then_3_yaw_change_sine_2 - then_3_yaw_change_sine;
    const float then_1_cost_2 = hall_position_three_limit((better_yaw_change_sine) ? (then_1_cost_1 +
        (((yaw_change_sine_part_22 * by_axis_1_1_e_cost_1) + (yaw_change_sine_part_24 * by_axis_1_2_e_cost_1) +
        (yaw_change_sine_part_26 * by_axis_1_3_e_cost_1) - (damping * then_1_cost_1) - (yaw_change_sine_part_28 *
        yaw_change_cost_2)) * yaw_change_sine_part_32)) : (0.5f * (then_1_cost_1 + other_1_cost_2)), 0.5f);
    const float cost_2_part = (x_phase_fraction_sine * versine_cost_2) + (y_phase_fraction_sine * yaw_change_sine_2);
    const float angle_cost_2 = then_1_cost_2 - cost_2_part;
    const float f15_argument_3 = angle_cost_2 * angle_cost_2;
    const float by_cosine_cost_2 = f15_polynomial(f15_argument_3);
    const float by_sine_cost_2 = angle_cost_2 * f16_polynomial(f15_argument_3);
    const float phases_1_sine_cost_2 = (x_sine_cost_0 * by_cosine_cost_2) + (x_cosine_yaw_change_sine * by_sine_cost_2);
    const float phases_1_sine_cost_2_squared = phases_1_sine_cost_2 * phases_1_sine_cost_2;
    const float B_1_cost_2 = phases_1_sine_cost_2 * (field_2_cost_0 +
        (phases_1_sine_cost_2_squared * (field_3_cost_0 + (phases_1_sine_cost_2_squared * field_4_cost_0))));
    const float by_axis_1_1_e_cost_2 = (volts_cosine_cost_0 * rotation_cosine_cost_2) -
        (volts_sine_cost_0 * yaw_change_sine_2) - B_1_cost_2;
    const float cost_2_part_2 = (x_phase_fraction_sine_2 * versine_cost_2) +
        (y_phase_fraction_sine_2 * yaw_change_sine_2);
    const float angle_cost_2_2 = then_1_cost_2 - cost_2_part_2;
    const float f17_argument_3 = angle_cost_2_2 * angle_cost_2_2;
    const float by_cosine_cost_2_2 = f17_polynomial(f17_argument_3);
    const float by_sine_cost_2_2 = angle_cost_2_2 * f18_polynomial(f17_argument_3);
    const float phases_1_sine_cost_2_2 = (x_sine_cost_0_2 * by_cosine_cost_2_2) +
        (x_cosine_yaw_change_sine_2 * by_sine_cost_2_2);
    const float cost_2_part_3 = phases_1_sine_cost_2_2 * phases_1_sine_cost_2_2;
    const float B_1_cost_2_2 = phases_1_sine_cost_2_2 * (field_2_cost_0_2 +
        (cost_2_part_3 * (field_3_cost_0_2 + (cost_2_part_3 * field_4_cost_0_2))));
    const float by_axis_1_2_e_cost_2 = (volts_cosine_cost_0_2 * rotation_cosine_cost_2) -
        (volts_sine_cost_0_2 * yaw_change_sine_2) - B_1_cost_2_2;
    const float cost_2_part_4 = (x_phase_fraction_sine_3 * versine_cost_2) +
        (y_phase_fraction_sine_3 * yaw_change_sine_2);
    const float angle_cost_2_3 = then_1_cost_2 - cost_2_part_4;
    const float f19_argument_3 = angle_cost_2_3 * angle_cost_2_3;
    const float by_cosine_cost_2_3 = f19_polynomial(f19_argument_3);
    const float by_sine_cost_2_3 = angle_cost_2_3 * f20_polynomial(f19_argument_3);
    const float phases_1_sine_cost_2_3 = (x_sine_cost_0_3 * by_cosine_cost_2_3) +
        (x_cosine_yaw_change_sine_3 * by_sine_cost_2_3);
    const float cost_2_part_5 = phases_1_sine_cost_2_3 * phases_1_sine_cost_2_3;
    const float B_1_cost_2_3 = phases_1_sine_cost_2_3 * (field_2_cost_0_3 +
        (cost_2_part_5 * (field_3_cost_0_3 + (cost_2_part_5 * field_4_cost_0_3))));
    const float by_axis_1_3_e_cost_2 = (volts_cosine_cost_0_3 * rotation_cosine_cost_2) -
        (volts_sine_cost_0_3 * yaw_change_sine_2) - B_1_cost_2_3;
    const float then_2_cost_2 = hall_position_three_limit((better_yaw_change_sine) ? (then_2_cost_1 +
        (((yaw_change_sine_part_33 * by_axis_2_1_e_cost_1) + (yaw_change_sine_part_35 * by_axis_2_2_e_cost_1) +
        (yaw_change_sine_part_37 * by_axis_2_3_e_cost_1) - (damping * then_2_cost_1) - (yaw_change_sine_part_39 *
        yaw_change_cost_2)) * yaw_change_sine_part_43)) : (0.5f * (then_2_cost_1 + other_2_cost_2)), 0.5f);
    const float dy_cost_2 = (x_phase_fraction_sine * yaw_change_sine_2) - (y_phase_fraction_sine * versine_cost_2);
    const float angle_cost_2_4 = then_2_cost_2 + dy_cost_2;
    const float f15_argument_4 = angle_cost_2_4 * angle_cost_2_4;
    const float by_cosine_cost_2_4 = f15_polynomial(f15_argument_4);
    const float by_sine_cost_2_4 = angle_cost_2_4 * f16_polynomial(f15_argument_4);
    const float p_sine_cost_2 = (p_sine_cost_0 * by_cosine_cost_2_4) + (p_cosine_yaw_change_sine * by_sine_cost_2_4);
    const float q_cost_2 = p_sine_cost_2 * p_sine_cost_2;
    const float B_2_cost_2 = p_sine_cost_2 * (field_2_cost_0 +
        (q_cost_2 * (field_3_cost_0 + (q_cost_2 * field_4_cost_0))));
    const float by_axis_2_1_e_cost_2 = (volts_sine_cost_0 * rotation_cosine_cost_2) +
        (volts_cosine_cost_0 * yaw_change_sine_2) - B_2_cost_2;
    const float dy_cost_2_2 = (x_phase_fraction_sine_2 * yaw_change_sine_2) -
        (y_phase_fraction_sine_2 * versine_cost_2);
    const float angle_cost_2_5 = then_2_cost_2 + dy_cost_2_2;
    const float f17_argument_4 = angle_cost_2_5 * angle_cost_2_5;
    const float by_cosine_cost_2_5 = f17_polynomial(f17_argument_4);
    const float by_sine_cost_2_5 = angle_cost_2_5 * f18_polynomial(f17_argument_4);
    const float p_sine_cost_2_2 = (p_sine_cost_0_2 * by_cosine_cost_2_5) +
        (p_cosine_yaw_change_sine_2 * by_sine_cost_2_5);
    const float q_cost_2_2 = p_sine_cost_2_2 * p_sine_cost_2_2;
    const float B_2_cost_2_2 = p_sine_cost_2_2 * (field_2_cost_0_2 +
        (q_cost_2_2 * (field_3_cost_0_2 + (q_cost_2_2 * field_4_cost_0_2))));
    const float by_axis_2_2_e_cost_2 = (volts_sine_cost_0_2 * rotation_cosine_cost_2) +
        (volts_cosine_cost_0_2 * yaw_change_sine_2) - B_2_cost_2_2;
    const float dy_cost_2_3 = (x_phase_fraction_sine_3 * yaw_change_sine_2) -
        (y_phase_fraction_sine_3 * versine_cost_2);
    const float angle_cost_2_6 = then_2_cost_2 + dy_cost_2_3;
    const float f19_argument_4 = angle_cost_2_6 * angle_cost_2_6;
    const float by_cosine_cost_2_6 = f19_polynomial(f19_argument_4);
    const float by_sine_cost_2_6 = angle_cost_2_6 * f20_polynomial(f19_argument_4);
    const float p_sine_cost_2_3 = (p_sine_cost_0_3 * by_cosine_cost_2_6) +
        (p_cosine_yaw_change_sine_3 * by_sine_cost_2_6);
    const float q_cost_2_3 = p_sine_cost_2_3 * p_sine_cost_2_3;
    const float B_2_cost_2_3 = p_sine_cost_2_3 * (field_2_cost_0_3 +
        (q_cost_2_3 * (field_3_cost_0_3 + (q_cost_2_3 * field_4_cost_0_3))));
    const float by_axis_2_3_e_cost_2 = (volts_sine_cost_0_3 * rotation_cosine_cost_2) +
        (volts_cosine_cost_0_3 * yaw_change_sine_2) - B_2_cost_2_3;
    const float cost_2 = (by_axis_1_1_e_cost_2 * by_axis_1_1_e_cost_2) + (by_axis_1_2_e_cost_2 * by_axis_1_2_e_cost_2) +
        (by_axis_1_3_e_cost_2 * by_axis_1_3_e_cost_2) + (by_axis_2_1_e_cost_2 * by_axis_2_1_e_cost_2) +
        (by_axis_2_2_e_cost_2 * by_axis_2_2_e_cost_2) + (by_axis_2_3_e_cost_2 * by_axis_2_3_e_cost_2) +
        (damping * ((then_1_cost_2 * then_1_cost_2) + (then_2_cost_2 * then_2_cost_2) +
        (squared_yaw_arm * yaw_change_sine_part_45)));
    const bool better_yaw_change_sine_2 = cost_2 <= ((cost_factor * yaw_change_sine_part_44) + cost_slack);
    const float yaw_change_sine_part_46 = ((x_cosine_yaw_change_sine * by_cosine_cost_2) -
        (x_sine_cost_0 * by_sine_cost_2)) * (slope_1_yaw_change_sine + (phases_1_sine_cost_2_squared *
        (slope_2_yaw_change_sine + (phases_1_sine_cost_2_squared * slope_3_yaw_change_sine))));
    const float yaw_change_sine_part_47 = B_2_cost_2 - (yaw_change_sine_part_46 * (y_phase_fraction_sine + dy_cost_2));
    const float yaw_change_sine_part_48 = ((x_cosine_yaw_change_sine_2 * by_cosine_cost_2_2) -
        (x_sine_cost_0_2 * by_sine_cost_2_2)) * (slope_1_yaw_change_sine_2 +
        (cost_2_part_3 * (slope_2_yaw_change_sine_2 + (cost_2_part_3 * slope_3_yaw_change_sine_2))));
    const float yaw_change_sine_part_49 = B_2_cost_2_2 -
        (yaw_change_sine_part_48 * (y_phase_fraction_sine_2 + dy_cost_2_2));
    const float yaw_change_sine_part_50 = ((x_cosine_yaw_change_sine_3 * by_cosine_cost_2_3) -
        (x_sine_cost_0_3 * by_sine_cost_2_3)) * (slope_1_yaw_change_sine_3 +
        (cost_2_part_5 * (slope_2_yaw_change_sine_3 + (cost_2_part_5 * slope_3_yaw_change_sine_3))));
    const float yaw_change_sine_part_51 = B_2_cost_2_3 -
        (yaw_change_sine_part_50 * (y_phase_fraction_sine_3 + dy_cost_2_3));
    const float yaw_change_sine_part_52 = (yaw_change_sine_part_46 * yaw_change_sine_part_47) +
        (yaw_change_sine_part_48 * yaw_change_sine_part_49) + (yaw_change_sine_part_50 * yaw_change_sine_part_51);
    const float yaw_change_sine_part_53 = (yaw_change_sine_part_46 * yaw_change_sine_part_49) -
        (yaw_change_sine_part_48 * yaw_change_sine_part_47);
    const float yaw_change_sine_part_54 = (yaw_change_sine_part_46 * yaw_change_sine_part_51) -
        (yaw_change_sine_part_50 * yaw_change_sine_part_47);
    const float yaw_change_sine_part_55 = (damping * ((yaw_change_sine_part_47 * by_axis_1_1_e_cost_2) +
        (yaw_change_sine_part_49 * by_axis_1_2_e_cost_2) + (yaw_change_sine_part_51 * by_axis_1_3_e_cost_2) +
        (then_1_cost_2 * yaw_change_sine_part_52))) + (yaw_change_sine_part_53 * ((yaw_change_sine_part_46 *
        by_axis_1_2_e_cost_2) - (yaw_change_sine_part_48 * by_axis_1_1_e_cost_2))) + (yaw_change_sine_part_54 *
        ((yaw_change_sine_part_46 * by_axis_1_3_e_cost_2) - (yaw_change_sine_part_50 * by_axis_1_1_e_cost_2)));
    const float across_yaw_change_sine_5 = (yaw_change_sine_part_48 * yaw_change_sine_part_51) -
        (yaw_change_sine_part_50 * yaw_change_sine_part_49);
    const float yaw_change_sine_part_56 = 1.0f / (damping + ((yaw_change_sine_part_46 * yaw_change_sine_part_46) +
        (yaw_change_sine_part_48 * yaw_change_sine_part_48) + (yaw_change_sine_part_50 * yaw_change_sine_part_50)));
    const float yaw_change_sine_part_57 = ((p_cosine_yaw_change_sine * by_cosine_cost_2_4) -
        (p_sine_cost_0 * by_sine_cost_2_4)) * (slope_1_yaw_change_sine +
        (q_cost_2 * (slope_2_yaw_change_sine + (q_cost_2 * slope_3_yaw_change_sine))));
    const float yaw_change_sine_part_58 = (yaw_change_sine_part_57 * (x_phase_fraction_sine - cost_2_part)) -
        B_1_cost_2;
    const float yaw_change_sine_part_59 = ((p_cosine_yaw_change_sine_2 * by_cosine_cost_2_5) -
        (p_sine_cost_0_2 * by_sine_cost_2_5)) * (slope_1_yaw_change_sine_2 +
        (q_cost_2_2 * (slope_2_yaw_change_sine_2 + (q_cost_2_2 * slope_3_yaw_change_sine_2))));
    const float yaw_change_sine_part_60 = (yaw_change_sine_part_59 * (x_phase_fraction_sine_2 - cost_2_part_2)) -
        B_1_cost_2_2;
    const float yaw_change_sine_part_61 = ((p_cosine_yaw_change_sine_3 * by_cosine_cost_2_6) -
        (p_sine_cost_0_3 * by_sine_cost_2_6)) * (slope_1_yaw_change_sine_3 +
        (q_cost_2_3 * (slope_2_yaw_change_sine_3 + (q_cost_2_3 * slope_3_yaw_change_sine_3))));
    const float yaw_change_sine_part_62 = (yaw_change_sine_part_61 * (x_phase_fraction_sine_3 - cost_2_part_4)) -
        B_1_cost_2_3;
    const float yaw_change_sine_part_63 = (yaw_change_sine_part_57 * yaw_change_sine_part_58) +
        (yaw_change_sine_part_59 * yaw_change_sine_part_60) + (yaw_change_sine_part_61 * yaw_change_sine_part_62);
    const float yaw_change_sine_part_64 = (yaw_change_sine_part_57 * yaw_change_sine_part_60) -
        (yaw_change_sine_part_59 * yaw_change_sine_part_58);
    const float yaw_change_sine_part_65 = (yaw_change_sine_part_57 * yaw_change_sine_part_62) -
        (yaw_change_sine_part_61 * yaw_change_sine_part_58);
    const float yaw_change_sine_part_66 = (damping * ((yaw_change_sine_part_58 * by_axis_2_1_e_cost_2) +
        (yaw_change_sine_part_60 * by_axis_2_2_e_cost_2) + (yaw_change_sine_part_62 * by_axis_2_3_e_cost_2) +
        (then_2_cost_2 * yaw_change_sine_part_63))) + (yaw_change_sine_part_64 * ((yaw_change_sine_part_57 *
        by_axis_2_2_e_cost_2) - (yaw_change_sine_part_59 * by_axis_2_1_e_cost_2))) + (yaw_change_sine_part_65 *
        ((yaw_change_sine_part_57 * by_axis_2_3_e_cost_2) - (yaw_change_sine_part_61 * by_axis_2_1_e_cost_2)));
    const float across_yaw_change_sine_6 = (yaw_change_sine_part_59 * yaw_change_sine_part_62) -
        (yaw_change_sine_part_61 * yaw_change_sine_part_60);
    const float yaw_change_sine_part_67 = 1.0f / (damping + ((yaw_change_sine_part_57 * yaw_change_sine_part_57) +
        (yaw_change_sine_part_59 * yaw_change_sine_part_59) + (yaw_change_sine_part_61 * yaw_change_sine_part_61)));
    const float right_yaw_change_sine_2 = ((yaw_change_sine_part_55 + (across_yaw_change_sine_5 *
        ((yaw_change_sine_part_48 * by_axis_1_3_e_cost_2) - (yaw_change_sine_part_50 * by_axis_1_2_e_cost_2)))) *
        yaw_change_sine_part_56) + ((yaw_change_sine_part_66 + (across_yaw_change_sine_6 * ((yaw_change_sine_part_59 *
        by_axis_2_3_e_cost_2) - (yaw_change_sine_part_61 * by_axis_2_2_e_cost_2)))) * yaw_change_sine_part_67) -
        (yaw_damping * then_3_yaw_change_sine_2);
    const float data_yaw_change_sine_3 = (((damping * ((yaw_change_sine_part_47 * yaw_change_sine_part_47) +
        (yaw_change_sine_part_49 * yaw_change_sine_part_49) + (yaw_change_sine_part_51 * yaw_change_sine_part_51))) +
        (yaw_change_sine_part_53 * yaw_change_sine_part_53) + (yaw_change_sine_part_54 * yaw_change_sine_part_54) +
        (across_yaw_change_sine_5 * across_yaw_change_sine_5)) * yaw_change_sine_part_56) +
        (((damping * ((yaw_change_sine_part_58 * yaw_change_sine_part_58) +
        (yaw_change_sine_part_60 * yaw_change_sine_part_60) + (yaw_change_sine_part_62 * yaw_change_sine_part_62))) +
        (yaw_change_sine_part_64 * yaw_change_sine_part_64) + (yaw_change_sine_part_65 * yaw_change_sine_part_65) +
        (across_yaw_change_sine_6 * across_yaw_change_sine_6)) * yaw_change_sine_part_67);
    float other_3_yaw_change_sine_2 = then_3_yaw_change_sine_2;
    float other_1_cost_3 = then_1_cost_2;
    float other_2_cost_3 = then_2_cost_2;
    float yaw_change_sine_part_68 = cost_2;
    if (!better_yaw_change_sine_2) {
        other_3_yaw_change_sine_2 = other_3_yaw_change_sine;
        other_1_cost_3 = other_1_cost_2;
        other_2_cost_3 = other_2_cost_2;
        yaw_change_sine_part_68 = yaw_change_sine_part_44;
    }
    const float then_3_yaw_change_sine_3 = hall_position_three_limit((better_yaw_change_sine_2) ?
        (then_3_yaw_change_sine_2 + (right_yaw_change_sine_2 / (yaw_damping + data_yaw_change_sine_3))) :
        (0.5f * (then_3_yaw_change_sine_2 + other_3_yaw_change_sine_2)), max_yaw_step);
    const float yaw_change_sine_part_69 = then_3_yaw_change_sine_3 * then_3_yaw_change_sine_3;
    const float yaw_change_sine_3 = then_3_yaw_change_sine_3 * yaw_change_sine_polynomial(yaw_change_sine_part_69);
    const float half_yaw_change_sine_3 = then_3_yaw_change_sine_3 *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_69);
    const float versine_cost_3 = half_yaw_change_sine_3 * half_yaw_change_sine_3;
    const float rotation_cosine_cost_3 = 1.0f - versine_cost_3;
    const float yaw_change_cost_3 = then_3_yaw_change_sine_3 - then_3_yaw_change_sine_2;
    const float then_1_cost_3 = hall_position_three_limit((better_yaw_change_sine_2) ? (then_1_cost_2 +
        (((yaw_change_sine_part_46 * by_axis_1_1_e_cost_2) + (yaw_change_sine_part_48 * by_axis_1_2_e_cost_2) +
        (yaw_change_sine_part_50 * by_axis_1_3_e_cost_2) - (damping * then_1_cost_2) - (yaw_change_sine_part_52 *
        yaw_change_cost_3)) * yaw_change_sine_part_56)) : (0.5f * (then_1_cost_2 + other_1_cost_3)), 0.5f);
    const float cost_3_part = (x_phase_fraction_sine * versine_cost_3) + (y_phase_fraction_sine * yaw_change_sine_3);
    const float angle_cost_3 = then_1_cost_3 - cost_3_part;
    const float f15_argument_5 = angle_cost_3 * angle_cost_3;
    const float by_cosine_cost_3 = f15_polynomial(f15_argument_5);
    const float by_sine_cost_3 = angle_cost_3 * f16_polynomial(f15_argument_5);
    const float phases_1_sine_cost_3 = (x_sine_cost_0 * by_cosine_cost_3) + (x_cosine_yaw_change_sine * by_sine_cost_3);
    const float phases_1_sine_cost_3_squared = phases_1_sine_cost_3 * phases_1_sine_cost_3;
    const float B_1_cost_3 = phases_1_sine_cost_3 * (field_2_cost_0 +
        (phases_1_sine_cost_3_squared * (field_3_cost_0 + (phases_1_sine_cost_3_squared * field_4_cost_0))));
    const float by_axis_1_1_e_cost_3 = (volts_cosine_cost_0 * rotation_cosine_cost_3) -
        (volts_sine_cost_0 * yaw_change_sine_3) - B_1_cost_3;
    const float cost_3_part_2 = (x_phase_fraction_sine_2 * versine_cost_3) +
        (y_phase_fraction_sine_2 * yaw_change_sine_3);
    const float angle_cost_3_2 = then_1_cost_3 - cost_3_part_2;
    const float f17_argument_5 = angle_cost_3_2 * angle_cost_3_2;
    const float by_cosine_cost_3_2 = f17_polynomial(f17_argument_5);
    const float by_sine_cost_3_2 = angle_cost_3_2 * f18_polynomial(f17_argument_5);
    const float phases_1_sine_cost_3_2 = (x_sine_cost_0_2 * by_cosine_cost_3_2) +
        (x_cosine_yaw_change_sine_2 * by_sine_cost_3_2);
    const float cost_3_part_3 = phases_1_sine_cost_3_2 * phases_1_sine_cost_3_2;
    const float B_1_cost_3_2 = phases_1_sine_cost_3_2 * (field_2_cost_0_2 +
        (cost_3_part_3 * (field_3_cost_0_2 + (cost_3_part_3 * field_4_cost_0_2))));
    const float by_axis_1_2_e_cost_3 = (volts_cosine_cost_0_2 * rotation_cosine_cost_3) -
        (volts_sine_cost_0_2 * yaw_change_sine_3) - B_1_cost_3_2;
    const float cost_3_part_4 = (x_phase_fraction_sine_3 * versine_cost_3) +
        (y_phase_fraction_sine_3 * yaw_change_sine_3);
    const float angle_cost_3_3 = then_1_cost_3 - cost_3_part_4;
    const float f19_argument_5 = angle_cost_3_3 * angle_cost_3_3;
    const float by_cosine_cost_3_3 = f19_polynomial(f19_argument_5);
    const float by_sine_cost_3_3 = angle_cost_3_3 * f20_polynomial(f19_argument_5);
    const float phases_1_sine_cost_3_3 = (x_sine_cost_0_3 * by_cosine_cost_3_3) +
        (x_cosine_yaw_change_sine_3 * by_sine_cost_3_3);
    const float cost_3_part_5 = phases_1_sine_cost_3_3 * phases_1_sine_cost_3_3;
    const float B_1_cost_3_3 = phases_1_sine_cost_3_3 * (field_2_cost_0_3 +
        (cost_3_part_5 * (field_3_cost_0_3 + (cost_3_part_5 * field_4_cost_0_3))));
    const float by_axis_1_3_e_cost_3 = (volts_cosine_cost_0_3 * rotation_cosine_cost_3) -
        (volts_sine_cost_0_3 * yaw_change_sine_3) - B_1_cost_3_3;
    const float then_2_cost_3 = hall_position_three_limit((better_yaw_change_sine_2) ? (then_2_cost_2 +
        (((yaw_change_sine_part_57 * by_axis_2_1_e_cost_2) + (yaw_change_sine_part_59 * by_axis_2_2_e_cost_2) +
        (yaw_change_sine_part_61 * by_axis_2_3_e_cost_2) - (damping * then_2_cost_2) - (yaw_change_sine_part_63 *
        yaw_change_cost_3)) * yaw_change_sine_part_67)) : (0.5f * (then_2_cost_2 + other_2_cost_3)), 0.5f);
    const float dy_cost_3 = (x_phase_fraction_sine * yaw_change_sine_3) - (y_phase_fraction_sine * versine_cost_3);
    const float angle_cost_3_4 = then_2_cost_3 + dy_cost_3;
    const float f15_argument_6 = angle_cost_3_4 * angle_cost_3_4;
    const float by_cosine_cost_3_4 = f15_polynomial(f15_argument_6);
    const float by_sine_cost_3_4 = angle_cost_3_4 * f16_polynomial(f15_argument_6);
    const float p_sine_cost_3 = (p_sine_cost_0 * by_cosine_cost_3_4) + (p_cosine_yaw_change_sine * by_sine_cost_3_4);
    const float q_cost_3 = p_sine_cost_3 * p_sine_cost_3;
    const float B_2_cost_3 = p_sine_cost_3 * (field_2_cost_0 +
        (q_cost_3 * (field_3_cost_0 + (q_cost_3 * field_4_cost_0))));
    const float by_axis_2_1_e_cost_3 = (volts_sine_cost_0 * rotation_cosine_cost_3) +
        (volts_cosine_cost_0 * yaw_change_sine_3) - B_2_cost_3;
    const float dy_cost_3_2 = (x_phase_fraction_sine_2 * yaw_change_sine_3) -
        (y_phase_fraction_sine_2 * versine_cost_3);
    const float angle_cost_3_5 = then_2_cost_3 + dy_cost_3_2;
    const float f17_argument_6 = angle_cost_3_5 * angle_cost_3_5;
    const float by_cosine_cost_3_5 = f17_polynomial(f17_argument_6);
    const float by_sine_cost_3_5 = angle_cost_3_5 * f18_polynomial(f17_argument_6);
    const float p_sine_cost_3_2 = (p_sine_cost_0_2 * by_cosine_cost_3_5) +
        (p_cosine_yaw_change_sine_2 * by_sine_cost_3_5);
    const float q_cost_3_2 = p_sine_cost_3_2 * p_sine_cost_3_2;
    const float B_2_cost_3_2 = p_sine_cost_3_2 * (field_2_cost_0_2 +
        (q_cost_3_2 * (field_3_cost_0_2 + (q_cost_3_2 * field_4_cost_0_2))));
    const float by_axis_2_2_e_cost_3 = (volts_sine_cost_0_2 * rotation_cosine_cost_3) +
        (volts_cosine_cost_0_2 * yaw_change_sine_3) - B_2_cost_3_2;
    const float dy_cost_3_3 = (x_phase_fraction_sine_3 * yaw_change_sine_3) -
        (y_phase_fraction_sine_3 * versine_cost_3);
    const float angle_cost_3_6 = then_2_cost_3 + dy_cost_3_3;
    const float f19_argument_6 = angle_cost_3_6 * angle_cost_3_6;
    const float by_cosine_cost_3_6 = f19_polynomial(f19_argument_6);
    const float by_sine_cost_3_6 = angle_cost_3_6 * f20_polynomial(f19_argument_6);
    const float p_sine_cost_3_3 = (p_sine_cost_0_3 * by_cosine_cost_3_6) +
        (p_cosine_yaw_change_sine_3 * by_sine_cost_3_6);
    const float q_cost_3_3 = p_sine_cost_3_3 * p_sine_cost_3_3;
    const float B_2_cost_3_3 = p_sine_cost_3_3 * (field_2_cost_0_3 +
        (q_cost_3_3 * (field_3_cost_0_3 + (q_cost_3_3 * field_4_cost_0_3))));
    const float by_axis_2_3_e_cost_3 = (volts_sine_cost_0_3 * rotation_cosine_cost_3) +
        (volts_cosine_cost_0_3 * yaw_change_sine_3) - B_2_cost_3_3;
    const float cost_3 = (by_axis_1_1_e_cost_3 * by_axis_1_1_e_cost_3) + (by_axis_1_2_e_cost_3 * by_axis_1_2_e_cost_3) +
        (by_axis_1_3_e_cost_3 * by_axis_1_3_e_cost_3) + (by_axis_2_1_e_cost_3 * by_axis_2_1_e_cost_3) +
        (by_axis_2_2_e_cost_3 * by_axis_2_2_e_cost_3) + (by_axis_2_3_e_cost_3 * by_axis_2_3_e_cost_3) +
        (damping * ((then_1_cost_3 * then_1_cost_3) + (then_2_cost_3 * then_2_cost_3) +
        (squared_yaw_arm * yaw_change_sine_part_69)));
    const bool better_yaw_change_sine_3 = cost_3 <= ((cost_factor * yaw_change_sine_part_68) + cost_slack);
    const float yaw_change_sine_part_70 = ((x_cosine_yaw_change_sine * by_cosine_cost_3) -
        (x_sine_cost_0 * by_sine_cost_3)) * (slope_1_yaw_change_sine + (phases_1_sine_cost_3_squared *
        (slope_2_yaw_change_sine + (phases_1_sine_cost_3_squared * slope_3_yaw_change_sine))));
    const float yaw_change_sine_part_71 = B_2_cost_3 - (yaw_change_sine_part_70 * (y_phase_fraction_sine + dy_cost_3));
    const float yaw_change_sine_part_72 = ((x_cosine_yaw_change_sine_2 * by_cosine_cost_3_2) -
        (x_sine_cost_0_2 * by_sine_cost_3_2)) * (slope_1_yaw_change_sine_2 +
        (cost_3_part_3 * (slope_2_yaw_change_sine_2 + (cost_3_part_3 * slope_3_yaw_change_sine_2))));
    const float yaw_change_sine_part_73 = B_2_cost_3_2 -
        (yaw_change_sine_part_72 * (y_phase_fraction_sine_2 + dy_cost_3_2));
    const float yaw_change_sine_part_74 = ((x_cosine_yaw_change_sine_3 * by_cosine_cost_3_3) -
        (x_sine_cost_0_3 * by_sine_cost_3_3)) * (slope_1_yaw_change_sine_3 +
        (cost_3_part_5 * (slope_2_yaw_change_sine_3 + (cost_3_part_5 * slope_3_yaw_change_sine_3))));
    const float yaw_change_sine_part_75 = B_2_cost_3_3 -
        (yaw_change_sine_part_74 * (y_phase_fraction_sine_3 + dy_cost_3_3));
    const float yaw_change_sine_part_76 = (yaw_change_sine_part_70 * yaw_change_sine_part_71) +
        (yaw_change_sine_part_72 * yaw_change_sine_part_73) + (yaw_change_sine_part_74 * yaw_change_sine_part_75);
    const float yaw_change_sine_part_77 = (yaw_change_sine_part_70 * yaw_change_sine_part_73) -
        (yaw_change_sine_part_72 * yaw_change_sine_part_71);
    const float yaw_change_sine_part_78 = (yaw_change_sine_part_70 * yaw_change_sine_part_75) -
        (yaw_change_sine_part_74 * yaw_change_sine_part_71);
    const float yaw_change_sine_part_79 = (damping * ((yaw_change_sine_part_71 * by_axis_1_1_e_cost_3) +
        (yaw_change_sine_part_73 * by_axis_1_2_e_cost_3) + (yaw_change_sine_part_75 * by_axis_1_3_e_cost_3) +
        (then_1_cost_3 * yaw_change_sine_part_76))) + (yaw_change_sine_part_77 * ((yaw_change_sine_part_70 *
        by_axis_1_2_e_cost_3) - (yaw_change_sine_part_72 * by_axis_1_1_e_cost_3))) + (yaw_change_sine_part_78 *
        ((yaw_change_sine_part_70 * by_axis_1_3_e_cost_3) - (yaw_change_sine_part_74 * by_axis_1_1_e_cost_3)));
    const float across_yaw_change_sine_7 = (yaw_change_sine_part_72 * yaw_change_sine_part_75) -
        (yaw_change_sine_part_74 * yaw_change_sine_part_73);
    const float yaw_change_sine_part_80 = 1.0f / (damping + ((yaw_change_sine_part_70 * yaw_change_sine_part_70) +
        (yaw_change_sine_part_72 * yaw_change_sine_part_72) + (yaw_change_sine_part_74 * yaw_change_sine_part_74)));
    const float yaw_change_sine_part_81 = ((p_cosine_yaw_change_sine * by_cosine_cost_3_4) -
        (p_sine_cost_0 * by_sine_cost_3_4)) * (slope_1_yaw_change_sine +
        (q_cost_3 * (slope_2_yaw_change_sine + (q_cost_3 * slope_3_yaw_change_sine))));
    const float yaw_change_sine_part_82 = (yaw_change_sine_part_81 * (x_phase_fraction_sine - cost_3_part)) -
        B_1_cost_3;
    const float yaw_change_sine_part_83 = ((p_cosine_yaw_change_sine_2 * by_cosine_cost_3_5) -
        (p_sine_cost_0_2 * by_sine_cost_3_5)) * (slope_1_yaw_change_sine_2 +
        (q_cost_3_2 * (slope_2_yaw_change_sine_2 + (q_cost_3_2 * slope_3_yaw_change_sine_2))));
    const float yaw_change_sine_part_84 = (yaw_change_sine_part_83 * (x_phase_fraction_sine_2 - cost_3_part_2)) -
        B_1_cost_3_2;
    const float yaw_change_sine_part_85 = ((p_cosine_yaw_change_sine_3 * by_cosine_cost_3_6) -
        (p_sine_cost_0_3 * by_sine_cost_3_6)) * (slope_1_yaw_change_sine_3 +
        (q_cost_3_3 * (slope_2_yaw_change_sine_3 + (q_cost_3_3 * slope_3_yaw_change_sine_3))));
    const float yaw_change_sine_part_86 = (yaw_change_sine_part_85 * (x_phase_fraction_sine_3 - cost_3_part_4)) -
        B_1_cost_3_3;
    const float yaw_change_sine_part_87 = (yaw_change_sine_part_81 * yaw_change_sine_part_82) +
        (yaw_change_sine_part_83 * yaw_change_sine_part_84) + (yaw_change_sine_part_85 * yaw_change_sine_part_86);
    const float yaw_change_sine_part_88 = (yaw_change_sine_part_81 * yaw_change_sine_part_84) -
        (yaw_change_sine_part_83 * yaw_change_sine_part_82);
    const float yaw_change_sine_part_89 = (yaw_change_sine_part_81 * yaw_change_sine_part_86) -
        (yaw_change_sine_part_85 * yaw_change_sine_part_82);
    const float yaw_change_sine_part_90 = (damping * ((yaw_change_sine_part_82 * by_axis_2_1_e_cost_3) +
        (yaw_change_sine_part_84 * by_axis_2_2_e_cost_3) + (yaw_change_sine_part_86 * by_axis_2_3_e_cost_3) +
        (then_2_cost_3 * yaw_change_sine_part_87))) + (yaw_change_sine_part_88 * ((yaw_change_sine_part_81 *
        by_axis_2_2_e_cost_3) - (yaw_change_sine_part_83 * by_axis_2_1_e_cost_3))) + (yaw_change_sine_part_89 *
        ((yaw_change_sine_part_81 * by_axis_2_3_e_cost_3) - (yaw_change_sine_part_85 * by_axis_2_1_e_cost_3)));
    const float across_yaw_change_sine_8 = (yaw_change_sine_part_83 * yaw_change_sine_part_86) -
        (yaw_change_sine_part_85 * yaw_change_sine_part_84);
    const float yaw_change_sine_part_91 = 1.0f / (damping + ((yaw_change_sine_part_81 * yaw_change_sine_part_81) +
        (yaw_change_sine_part_83 * yaw_change_sine_part_83) + (yaw_change_sine_part_85 * yaw_change_sine_part_85)));
    const float right_yaw_change_sine_3 = ((yaw_change_sine_part_79 + (across_yaw_change_sine_7 *
        ((yaw_change_sine_part_72 * by_axis_1_3_e_cost_3) - (yaw_change_sine_part_74 * by_axis_1_2_e_cost_3)))) *
        yaw_change_sine_part_80) + ((yaw_change_sine_part_90 + (across_yaw_change_sine_8 * ((yaw_change_sine_part_83 *
        by_axis_2_3_e_cost_3) - (yaw_change_sine_part_85 * by_axis_2_2_e_cost_3)))) * yaw_change_sine_part_91) -
        (yaw_damping * then_3_yaw_change_sine_3);
    const float data_yaw_change_sine_4 = (((damping * ((yaw_change_sine_part_71 * yaw_change_sine_part_71) +
        (yaw_change_sine_part_73 * yaw_change_sine_part_73) + (yaw_change_sine_part_75 * yaw_change_sine_part_75))) +
        (yaw_change_sine_part_77 * yaw_change_sine_part_77) + (yaw_change_sine_part_78 * yaw_change_sine_part_78) +
        (across_yaw_change_sine_7 * across_yaw_change_sine_7)) * yaw_change_sine_part_80) +
        (((damping * ((yaw_change_sine_part_82 * yaw_change_sine_part_82) +
        (yaw_change_sine_part_84 * yaw_change_sine_part_84) + (yaw_change_sine_part_86 * yaw_change_sine_part_86))) +
        (yaw_change_sine_part_88 * yaw_change_sine_part_88) + (yaw_change_sine_part_89 * yaw_change_sine_part_89) +
        (across_yaw_change_sine_8 * across_yaw_change_sine_8)) * yaw_change_sine_part_91);
    float other_3_yaw_change_sine_3 = then_3_yaw_change_sine_3;
    float other_1_cost_4 = then_1_cost_3;
    float other_2_cost_4 = then_2_cost_3;
    float converged_part = cost_3;
    if (!better_yaw_change_sine_3) {
        other_3_yaw_change_sine_3 = other_3_yaw_change_sine_2;
        other_1_cost_4 = other_1_cost_3;
        other_2_cost_4 = other_2_cost_3;
        converged_part = yaw_change_sine_part_68;
    }
    const float at_3_yaw_change_sine = hall_position_three_limit((better_yaw_change_sine_3) ?
        (then_3_yaw_change_sine_3 + (right_yaw_change_sine_3 / (yaw_damping + data_yaw_change_sine_4))) :
        (0.5f * (then_3_yaw_change_sine_3 + other_3_yaw_change_sine_3)), max_yaw_step);
    const float at_3_yaw_change_sine_squared = at_3_yaw_change_sine * at_3_yaw_change_sine;
    const float yaw_change_sine_4 = at_3_yaw_change_sine * yaw_change_sine_polynomial(at_3_yaw_change_sine_squared);
    const float half_yaw_change_sine_4 = at_3_yaw_change_sine *
        half_yaw_change_sine_polynomial(at_3_yaw_change_sine_squared);
    const float versine_cost_4 = half_yaw_change_sine_4 * half_yaw_change_sine_4;
    const float rotation_cosine_cost_4 = 1.0f - versine_cost_4;
    const float yaw_change_cost_4 = at_3_yaw_change_sine - then_3_yaw_change_sine_3;
    const float at_1_cost_4 = hall_position_three_limit((better_yaw_change_sine_3) ? (then_1_cost_3 +
        (((yaw_change_sine_part_70 * by_axis_1_1_e_cost_3) + (yaw_change_sine_part_72 * by_axis_1_2_e_cost_3) +
        (yaw_change_sine_part_74 * by_axis_1_3_e_cost_3) - (damping * then_1_cost_3) - (yaw_change_sine_part_76 *
        yaw_change_cost_4)) * yaw_change_sine_part_80)) : (0.5f * (then_1_cost_3 + other_1_cost_4)), 0.5f);
    const float cost_4_part = (x_phase_fraction_sine * versine_cost_4) + (y_phase_fraction_sine * yaw_change_sine_4);
    const float angle_cost_4 = at_1_cost_4 - cost_4_part;
    const float f15_argument_7 = angle_cost_4 * angle_cost_4;
    const float by_cosine_cost_4 = f15_polynomial(f15_argument_7);
    const float by_sine_cost_4 = angle_cost_4 * f16_polynomial(f15_argument_7);
    const float phases_1_sine_cost_4 = (x_sine_cost_0 * by_cosine_cost_4) + (x_cosine_yaw_change_sine * by_sine_cost_4);
    const float phases_1_sine_cost_4_squared = phases_1_sine_cost_4 * phases_1_sine_cost_4;
    const float B_1_cost_4 = phases_1_sine_cost_4 * (field_2_cost_0 +
        (phases_1_sine_cost_4_squared * (field_3_cost_0 + (phases_1_sine_cost_4_squared * field_4_cost_0))));
    const float by_axis_1_1_e_cost_4 = (volts_cosine_cost_0 * rotation_cosine_cost_4) -
        (volts_sine_cost_0 * yaw_change_sine_4) - B_1_cost_4;
    const float cost_4_part_2 = (x_phase_fraction_sine_2 * versine_cost_4) +
        (y_phase_fraction_sine_2 * yaw_change_sine_4);
    const float angle_cost_4_2 = at_1_cost_4 - cost_4_part_2;
    const float f17_argument_7 = angle_cost_4_2 * angle_cost_4_2;
    const float by_cosine_cost_4_2 = f17_polynomial(f17_argument_7);
    const float by_sine_cost_4_2 = angle_cost_4_2 * f18_polynomial(f17_argument_7);
    const float phases_1_sine_cost_4_2 = (x_sine_cost_0_2 * by_cosine_cost_4_2) +
        (x_cosine_yaw_change_sine_2 * by_sine_cost_4_2);
    const float cost_4_part_3 = phases_1_sine_cost_4_2 * phases_1_sine_cost_4_2;
    const float B_1_cost_4_2 = phases_1_sine_cost_4_2 * (field_2_cost_0_2 +
        (cost_4_part_3 * (field_3_cost_0_2 + (cost_4_part_3 * field_4_cost_0_2))));
    const float by_axis_1_2_e_cost_4 = (volts_cosine_cost_0_2 * rotation_cosine_cost_4) -
        (volts_sine_cost_0_2 * yaw_change_sine_4) - B_1_cost_4_2;
    const float cost_4_part_4 = (x_phase_fraction_sine_3 * versine_cost_4) +
        (y_phase_fraction_sine_3 * yaw_change_sine_4);
    const float angle_cost_4_3 = at_1_cost_4 - cost_4_part_4;
    const float f19_argument_7 = angle_cost_4_3 * angle_cost_4_3;
    const float by_cosine_cost_4_3 = f19_polynomial(f19_argument_7);
    const float by_sine_cost_4_3 = angle_cost_4_3 * f20_polynomial(f19_argument_7);
    const float phases_1_sine_cost_4_3 = (x_sine_cost_0_3 * by_cosine_cost_4_3) +
        (x_cosine_yaw_change_sine_3 * by_sine_cost_4_3);
    const float cost_4_part_5 = phases_1_sine_cost_4_3 * phases_1_sine_cost_4_3;
    const float B_1_cost_4_3 = phases_1_sine_cost_4_3 * (field_2_cost_0_3 +
        (cost_4_part_5 * (field_3_cost_0_3 + (cost_4_part_5 * field_4_cost_0_3))));
    const float by_axis_1_3_e_cost_4 = (volts_cosine_cost_0_3 * rotation_cosine_cost_4) -
        (volts_sine_cost_0_3 * yaw_change_sine_4) - B_1_cost_4_3;
    const float at_2_cost_4 = hall_position_three_limit((better_yaw_change_sine_3) ? (then_2_cost_3 +
        (((yaw_change_sine_part_81 * by_axis_2_1_e_cost_3) + (yaw_change_sine_part_83 * by_axis_2_2_e_cost_3) +
        (yaw_change_sine_part_85 * by_axis_2_3_e_cost_3) - (damping * then_2_cost_3) - (yaw_change_sine_part_87 *
        yaw_change_cost_4)) * yaw_change_sine_part_91)) : (0.5f * (then_2_cost_3 + other_2_cost_4)), 0.5f);
    const float dy_cost_4 = (x_phase_fraction_sine * yaw_change_sine_4) - (y_phase_fraction_sine * versine_cost_4);
    const float angle_cost_4_4 = at_2_cost_4 + dy_cost_4;
    const float f15_argument_8 = angle_cost_4_4 * angle_cost_4_4;
    const float by_cosine_cost_4_4 = f15_polynomial(f15_argument_8);
    const float by_sine_cost_4_4 = angle_cost_4_4 * f16_polynomial(f15_argument_8);
    const float p_sine_cost_4 = (p_sine_cost_0 * by_cosine_cost_4_4) + (p_cosine_yaw_change_sine * by_sine_cost_4_4);
    const float q_cost_4 = p_sine_cost_4 * p_sine_cost_4;
    const float B_2_cost_4 = p_sine_cost_4 * (field_2_cost_0 +
        (q_cost_4 * (field_3_cost_0 + (q_cost_4 * field_4_cost_0))));
    const float by_axis_2_1_e_cost_4 = (volts_sine_cost_0 * rotation_cosine_cost_4) +
        (volts_cosine_cost_0 * yaw_change_sine_4) - B_2_cost_4;
    const float dy_cost_4_2 = (x_phase_fraction_sine_2 * yaw_change_sine_4) -
        (y_phase_fraction_sine_2 * versine_cost_4);
    const float angle_cost_4_5 = at_2_cost_4 + dy_cost_4_2;
    const float f17_argument_8 = angle_cost_4_5 * angle_cost_4_5;
    const float by_cosine_cost_4_5 = f17_polynomial(f17_argument_8);
    const float by_sine_cost_4_5 = angle_cost_4_5 * f18_polynomial(f17_argument_8);
    const float p_sine_cost_4_2 = (p_sine_cost_0_2 * by_cosine_cost_4_5) +
        (p_cosine_yaw_change_sine_2 * by_sine_cost_4_5);
    const float q_cost_4_2 = p_sine_cost_4_2 * p_sine_cost_4_2;
    const float B_2_cost_4_2 = p_sine_cost_4_2 * (field_2_cost_0_2 +
        (q_cost_4_2 * (field_3_cost_0_2 + (q_cost_4_2 * field_4_cost_0_2))));
    const float by_axis_2_2_e_cost_4 = (volts_sine_cost_0_2 * rotation_cosine_cost_4) +
        (volts_cosine_cost_0_2 * yaw_change_sine_4) - B_2_cost_4_2;
    const float dy_cost_4_3 = (x_phase_fraction_sine_3 * yaw_change_sine_4) -
        (y_phase_fraction_sine_3 * versine_cost_4);
    const float angle_cost_4_6 = at_2_cost_4 + dy_cost_4_3;
    const float f19_argument_8 = angle_cost_4_6 * angle_cost_4_6;
    const float by_cosine_cost_4_6 = f19_polynomial(f19_argument_8);
    const float by_sine_cost_4_6 = angle_cost_4_6 * f20_polynomial(f19_argument_8);
    const float p_sine_cost_4_3 = (p_sine_cost_0_3 * by_cosine_cost_4_6) +
        (p_cosine_yaw_change_sine_3 * by_sine_cost_4_6);
    const float q_cost_4_3 = p_sine_cost_4_3 * p_sine_cost_4_3;
    const float B_2_cost_4_3 = p_sine_cost_4_3 * (field_2_cost_0_3 +
        (q_cost_4_3 * (field_3_cost_0_3 + (q_cost_4_3 * field_4_cost_0_3))));
    const float by_axis_2_3_e_cost_4 = (volts_sine_cost_0_3 * rotation_cosine_cost_4) +
        (volts_cosine_cost_0_3 * yaw_change_sine_4) - B_2_cost_4_3;
    const float squares_cost_4 = (by_axis_1_1_e_cost_4 * by_axis_1_1_e_cost_4) +
        (by_axis_1_2_e_cost_4 * by_axis_1_2_e_cost_4) + (by_axis_1_3_e_cost_4 * by_axis_1_3_e_cost_4) +
        (by_axis_2_1_e_cost_4 * by_axis_2_1_e_cost_4) + (by_axis_2_2_e_cost_4 * by_axis_2_2_e_cost_4) +
        (by_axis_2_3_e_cost_4 * by_axis_2_3_e_cost_4);
    const float cost_4_part_6 = (at_1_cost_4 * at_1_cost_4) + (at_2_cost_4 * at_2_cost_4);
    const float cost_4 = squares_cost_4 +
        (damping * (cost_4_part_6 + (squared_yaw_arm * at_3_yaw_change_sine_squared)));
    const float freedom = (excluded_1 || excluded_2 || excluded_3) ? 1.0f : 3.0f;
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const uint32_t estimator_residual_faults = state->estimator_residual_faults;
    const float growing_gate = innovation_gate + (innovation_gate * (float)estimator_residual_faults);
    const bool gate_exceeded = (growing_gate * growing_gate) <
        (cost_4_part_6 + (squared_radius * at_3_yaw_change_sine_squared));
    const bool better_converged = cost_4 <= ((cost_factor * converged_part) + cost_slack);
    const float by_axis_1_1_g_converged = ((x_cosine_yaw_change_sine * by_cosine_cost_4) -
        (x_sine_cost_0 * by_sine_cost_4)) * (slope_1_yaw_change_sine + (phases_1_sine_cost_4_squared *
        (slope_2_yaw_change_sine + (phases_1_sine_cost_4_squared * slope_3_yaw_change_sine))));
    const float by_axis_1_1_h_converged = B_2_cost_4 - (by_axis_1_1_g_converged * (y_phase_fraction_sine + dy_cost_4));
    const float by_axis_1_2_g_converged = ((x_cosine_yaw_change_sine_2 * by_cosine_cost_4_2) -
        (x_sine_cost_0_2 * by_sine_cost_4_2)) * (slope_1_yaw_change_sine_2 +
        (cost_4_part_3 * (slope_2_yaw_change_sine_2 + (cost_4_part_3 * slope_3_yaw_change_sine_2))));
    const float by_axis_1_2_h_converged = B_2_cost_4_2 -
        (by_axis_1_2_g_converged * (y_phase_fraction_sine_2 + dy_cost_4_2));
    const float by_axis_1_3_g_converged = ((x_cosine_yaw_change_sine_3 * by_cosine_cost_4_3) -
        (x_sine_cost_0_3 * by_sine_cost_4_3)) * (slope_1_yaw_change_sine_3 +
        (cost_4_part_5 * (slope_2_yaw_change_sine_3 + (cost_4_part_5 * slope_3_yaw_change_sine_3))));
    const float by_axis_1_3_h_converged = B_2_cost_4_3 -
        (by_axis_1_3_g_converged * (y_phase_fraction_sine_3 + dy_cost_4_3));
    const float axes_1_coupling_converged = (by_axis_1_1_g_converged * by_axis_1_1_h_converged) +
        (by_axis_1_2_g_converged * by_axis_1_2_h_converged) + (by_axis_1_3_g_converged * by_axis_1_3_h_converged);
    const float converged_part_2 = (by_axis_1_1_g_converged * by_axis_1_2_h_converged) -
        (by_axis_1_2_g_converged * by_axis_1_1_h_converged);
    const float converged_part_3 = (by_axis_1_1_g_converged * by_axis_1_3_h_converged) -
        (by_axis_1_3_g_converged * by_axis_1_1_h_converged);
    const float converged_part_4 = (damping * ((by_axis_1_1_h_converged * by_axis_1_1_e_cost_4) +
        (by_axis_1_2_h_converged * by_axis_1_2_e_cost_4) + (by_axis_1_3_h_converged * by_axis_1_3_e_cost_4) +
        (at_1_cost_4 * axes_1_coupling_converged))) + (converged_part_2 * ((by_axis_1_1_g_converged *
        by_axis_1_2_e_cost_4) - (by_axis_1_2_g_converged * by_axis_1_1_e_cost_4))) + (converged_part_3 *
        ((by_axis_1_1_g_converged * by_axis_1_3_e_cost_4) - (by_axis_1_3_g_converged * by_axis_1_1_e_cost_4)));
    const float across_converged = (by_axis_1_2_g_converged * by_axis_1_3_h_converged) -
        (by_axis_1_3_g_converged * by_axis_1_2_h_converged);
    const float axes_1_inverse = 1.0f / (damping + ((by_axis_1_1_g_converged * by_axis_1_1_g_converged) +
        (by_axis_1_2_g_converged * by_axis_1_2_g_converged) + (by_axis_1_3_g_converged * by_axis_1_3_g_converged)));
    const float by_axis_2_1_g_converged = ((p_cosine_yaw_change_sine * by_cosine_cost_4_4) -
        (p_sine_cost_0 * by_sine_cost_4_4)) * (slope_1_yaw_change_sine +
        (q_cost_4 * (slope_2_yaw_change_sine + (q_cost_4 * slope_3_yaw_change_sine))));
    const float by_axis_2_1_h_converged = (by_axis_2_1_g_converged * (x_phase_fraction_sine - cost_4_part)) -
        B_1_cost_4;
    const float by_axis_2_2_g_converged = ((p_cosine_yaw_change_sine_2 * by_cosine_cost_4_5) -
        (p_sine_cost_0_2 * by_sine_cost_4_5)) * (slope_1_yaw_change_sine_2 +
        (q_cost_4_2 * (slope_2_yaw_change_sine_2 + (q_cost_4_2 * slope_3_yaw_change_sine_2))));
    const float by_axis_2_2_h_converged = (by_axis_2_2_g_converged * (x_phase_fraction_sine_2 - cost_4_part_2)) -
        B_1_cost_4_2;
    const float by_axis_2_3_g_converged = ((p_cosine_yaw_change_sine_3 * by_cosine_cost_4_6) -
        (p_sine_cost_0_3 * by_sine_cost_4_6)) * (slope_1_yaw_change_sine_3 +
        (q_cost_4_3 * (slope_2_yaw_change_sine_3 + (q_cost_4_3 * slope_3_yaw_change_sine_3))));
    const float by_axis_2_3_h_converged = (by_axis_2_3_g_converged * (x_phase_fraction_sine_3 - cost_4_part_4)) -
        B_1_cost_4_3;
    const float n_coupling = (by_axis_2_1_g_converged * by_axis_2_1_h_converged) +
        (by_axis_2_2_g_converged * by_axis_2_2_h_converged) + (by_axis_2_3_g_converged * by_axis_2_3_h_converged);
    const float converged_part_5 = (by_axis_2_1_g_converged * by_axis_2_2_h_converged) -
        (by_axis_2_2_g_converged * by_axis_2_1_h_converged);
    const float converged_part_6 = (by_axis_2_1_g_converged * by_axis_2_3_h_converged) -
        (by_axis_2_3_g_converged * by_axis_2_1_h_converged);
    const float converged_part_7 = (damping * ((by_axis_2_1_h_converged * by_axis_2_1_e_cost_4) +
        (by_axis_2_2_h_converged * by_axis_2_2_e_cost_4) + (by_axis_2_3_h_converged * by_axis_2_3_e_cost_4) +
        (at_2_cost_4 * n_coupling))) + (converged_part_5 * ((by_axis_2_1_g_converged * by_axis_2_2_e_cost_4) -
        (by_axis_2_2_g_converged * by_axis_2_1_e_cost_4))) + (converged_part_6 *
        ((by_axis_2_1_g_converged * by_axis_2_3_e_cost_4) - (by_axis_2_3_g_converged * by_axis_2_1_e_cost_4)));
    const float across_converged_2 = (by_axis_2_2_g_converged * by_axis_2_3_h_converged) -
        (by_axis_2_3_g_converged * by_axis_2_2_h_converged);
    const float n_inverse = 1.0f / (damping + ((by_axis_2_1_g_converged * by_axis_2_1_g_converged) +
        (by_axis_2_2_g_converged * by_axis_2_2_g_converged) + (by_axis_2_3_g_converged * by_axis_2_3_g_converged)));
    const float right_converged = ((converged_part_4 + (across_converged * ((by_axis_1_2_g_converged *
        by_axis_1_3_e_cost_4) - (by_axis_1_3_g_converged * by_axis_1_2_e_cost_4)))) * axes_1_inverse) +
        ((converged_part_7 + (across_converged_2 * ((by_axis_2_2_g_converged * by_axis_2_3_e_cost_4) -
        (by_axis_2_3_g_converged * by_axis_2_2_e_cost_4)))) * n_inverse) - (yaw_damping * at_3_yaw_change_sine);
    const float data_converged = (((damping * ((by_axis_1_1_h_converged * by_axis_1_1_h_converged) +
        (by_axis_1_2_h_converged * by_axis_1_2_h_converged) + (by_axis_1_3_h_converged * by_axis_1_3_h_converged))) +
        (converged_part_2 * converged_part_2) + (converged_part_3 * converged_part_3) + (across_converged *
        across_converged)) * axes_1_inverse) + (((damping * ((by_axis_2_1_h_converged * by_axis_2_1_h_converged) +
        (by_axis_2_2_h_converged * by_axis_2_2_h_converged) + (by_axis_2_3_h_converged * by_axis_2_3_h_converged))) +
        (converged_part_5 * converged_part_5) + (converged_part_6 * converged_part_6) +
        (across_converged_2 * across_converged_2)) * n_inverse);
    const float converged_part_8 = 1.0f / (yaw_damping + data_converged);
    const float axes_1_slope_converged = (by_axis_1_1_g_converged * by_axis_1_1_e_cost_4) + (by_axis_1_2_g_converged *
        by_axis_1_2_e_cost_4) + (by_axis_1_3_g_converged * by_axis_1_3_e_cost_4) - (damping * at_1_cost_4);
    const float n_slope = (by_axis_2_1_g_converged * by_axis_2_1_e_cost_4) + (by_axis_2_2_g_converged *
        by_axis_2_2_e_cost_4) + (by_axis_2_3_g_converged * by_axis_2_3_e_cost_4) - (damping * at_2_cost_4);
    const bool converged = better_converged && (((right_converged * right_converged * converged_part_8) +
        (axes_1_slope_converged * axes_1_slope_converged * axes_1_inverse) + (n_slope * n_slope * n_inverse)) <=
        cost_slack);
    float at_3_yaw_change_sine_2;
    float at_1_X;
    float at_2_Y;
    if (converged) {
        const float untried_3 = hall_position_three_limit(at_3_yaw_change_sine + (right_converged * converged_part_8),
            max_yaw_step);
        at_3_yaw_change_sine_2 = untried_3;
        const float yaw_change_X = untried_3 - at_3_yaw_change_sine;
        at_1_X = hall_position_three_limit(at_1_cost_4 +
            ((axes_1_slope_converged - (axes_1_coupling_converged * yaw_change_X)) * axes_1_inverse), 0.5f);
        at_2_Y = hall_position_three_limit(at_2_cost_4 + ((n_slope - (n_coupling * yaw_change_X)) * n_inverse), 0.5f);
    } else {
        if (better_converged) {
            at_3_yaw_change_sine_2 = at_3_yaw_change_sine;
            at_1_X = at_1_cost_4;
            at_2_Y = at_2_cost_4;
        } else {
            at_3_yaw_change_sine_2 = other_3_yaw_change_sine_3;
            at_1_X = other_1_cost_4;
            at_2_Y = other_2_cost_4;
        }
    }
    const float estimator_yaw_last_good = state->estimator_yaw_last_good;
    const uint32_t estimator_searching = state->estimator_searching;
    bool lost_yaw_change_sine = gate_exceeded;
    if (estimator_ambiguity_resolved == 0u) {
        lost_yaw_change_sine = (estimator_searching != 0u) &&
            !(fabsf(prediction_yaw + at_3_yaw_change_sine_2 - estimator_yaw_last_good) <= yaw_window);
    }
    const bool integrity_residual_fault = ((squared_residual_limit * freedom) < squares_cost_4) || lost_yaw_change_sine;
    const bool tracking = estimator_searching == 0u;
    float yaw_yaw_change_sine = 0.0f;
    float by_phase_x = 0.0f;
    float by_phase_y = 0.0f;
    float estimator_motion_x_part = 0.0f;
    float estimator_motion_y_part = 0.0f;
    float estimator_motion_yaw_part = 0.0f;
    if (!(integrity_residual_fault && tracking)) {
        yaw_yaw_change_sine = at_3_yaw_change_sine_2;
        by_phase_x = at_1_X;
        by_phase_y = at_2_Y;
        estimator_motion_x_part = 0.5f * at_1_X;
        estimator_motion_y_part = 0.5f * at_2_Y;
        estimator_motion_yaw_part = yaw_gain * at_3_yaw_change_sine_2;
    }
    const float yaw_change_sine_argument = yaw_yaw_change_sine * yaw_yaw_change_sine;
    const float yaw_change_sine_5 = yaw_yaw_change_sine * yaw_change_sine_polynomial(yaw_change_sine_argument);
    const float half_yaw_change_sine_5 = yaw_yaw_change_sine *
        half_yaw_change_sine_polynomial(yaw_change_sine_argument);
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
    const float by_cosine_X = 1.0f - (half_yaw_change_sine_5 * half_yaw_change_sine_5);
    const float cosine = (heading_cosine * by_cosine_X) - (heading_sine * yaw_change_sine_5);
    const float sine = (heading_sine * by_cosine_X) + (heading_cosine * yaw_change_sine_5);
    const float lever_cosine = (centre_x * cosine) + (-centre_y * sine);
    const float X = (metre_per_rad * pose_phase_x) + (pitch * pose_pitch_x) - lever_cosine;
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
    const float lever_sine = (centre_x * sine) - (-centre_y * cosine);
    const float Y = (metre_per_rad * pose_phase_y) + (pitch * pose_pitch_y) - lever_sine;
    const float yaw_part = prediction_yaw + yaw_yaw_change_sine;
    float angle_yaw = yaw_part;
    if (pi < yaw_part) {
        angle_yaw = yaw_part - two_pi;
    }
    float yaw = angle_yaw;
    if (angle_yaw < -pi) {
        yaw = angle_yaw + two_pi;
    }
    const float deviation_X_part = axes_1_coupling_converged * axes_1_inverse;
    const float by_yaw_X = deviation_X_part - (wave_number * lever_sine);
    const float yaw_deviation_X = 1.0f / (data_converged + undamped_yaw);
    const float deviation_X = deviation_over_w * sqrtf(axes_1_inverse + (by_yaw_X * by_yaw_X * yaw_deviation_X));
    const float n_coupling_times_n_inverse = n_coupling * n_inverse;
    const float by_yaw_Y = n_coupling_times_n_inverse + (wave_number * lever_cosine);
    const float deviation_Y = deviation_over_w * sqrtf(n_inverse + (by_yaw_Y * by_yaw_Y * yaw_deviation_X));
    const float deviation_yaw = deviation * sqrtf(yaw_deviation_X);
    const float residual = sqrtf(least_square + (squares_cost_4 / freedom));
    const float weight = ((squared_radius + (deviation_X_part * deviation_X_part) +
        (n_coupling_times_n_inverse * n_coupling_times_n_inverse)) * yaw_deviation_X) + (axes_1_inverse + n_inverse);
    const bool damped = damped_weight < weight;
    const bool integrity_good = converged && !(damped || integrity_residual_fault || gate_exceeded);
    const bool counted = (fabsf(pose_pitch_x) <= 8.0f) && (fabsf(pose_pitch_y) <= 8.0f);
    const float size = fabsf(yaw);
    const bool accepted = counted && (size <= yaw_limit);
    const bool resolved_valid = (integrity_good && ((hall_position_three_flag(excluded_1) +
        hall_position_three_flag(excluded_2) + hall_position_three_flag(excluded_3)) < 1u) &&
        (weight <= unambiguous_weight) && tracking && accepted) || ((estimator_ambiguity_resolved != 0u) && !damped);
    const uint32_t estimator_lock_lost = state->estimator_lock_lost;
    const bool valid = integrity_good && resolved_valid && (estimator_lock_lost == 0u) && accepted;
    out->lock_lost = (float)estimator_lock_lost;
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
        state->estimator_excluded_sensor = 0u;
    } else {
        state->estimator_phase_x = pose_phase_x;
        state->estimator_phase_y = pose_phase_y;
        state->estimator_yaw = yaw;
        if (converged && estimator_yaw_last_good_test) {
            state->estimator_searching = 0u;
        }
        state->estimator_ambiguity_resolved = hall_position_three_flag(resolved_valid);
        const float squares_2 = terms_2_cost_0 + terms_5_cost_0;
        const float squares_1 = terms_1_cost_0 + terms_4_cost_0;
        const float square = terms_3_cost_0 + terms_6_cost_0;
        const float squares_2_max_squares_1 = hall_position_three_max(squares_2, squares_1);
        const float others = hall_position_three_min(squares_2, squares_1) +
            hall_position_three_min(square, squares_2_max_squares_1);
        if (integrity_residual_fault && ((squared_inconsistent * freedom) < squares_cost_4) &&
                (estimator_ambiguity_resolved != 0u) && (1u <= estimator_residual_faults) && (others <= others_agree) &&
                ((contrast * others) <= hall_position_three_max(square, squares_2_max_squares_1))) {
            state->estimator_excluded_sensor = (uint32_t)((squares_2_max_squares_1 < square) ? 3.0f :
                ((squares_1 < squares_2) ? 2.0f : 1.0f));
        }
    }
    if (resolved_valid && estimator_yaw_last_good_test) {
        state->estimator_yaw_last_good = yaw;
    }
    state->estimator_pitch_x = hall_position_three_limit(pose_pitch_x, 8.0f);
    state->estimator_pitch_y = hall_position_three_limit(pose_pitch_y, 8.0f);
    float estimator_motion_x_part_2 = 0.0f;
    float estimator_motion_y_part_2 = 0.0f;
    float estimator_motion_yaw_part_2 = 0.0f;
    if (estimator_searching == 0u) {
        estimator_motion_x_part_2 = estimator_motion_x + estimator_motion_x_part;
        estimator_motion_y_part_2 = estimator_motion_y + estimator_motion_y_part;
        estimator_motion_yaw_part_2 = estimator_motion_yaw + estimator_motion_yaw_part;
    }
    state->estimator_motion_x = hall_position_three_limit(estimator_motion_x_part_2, 0.5f);
    state->estimator_motion_y = hall_position_three_limit(estimator_motion_y_part_2, 0.5f);
    state->estimator_motion_yaw = hall_position_three_limit(estimator_motion_yaw_part_2, max_yaw_step);
    state->estimator_residual_faults = (integrity_residual_fault) ?
        ((exhausted) ? 0u : (estimator_residual_faults + 1u)) : 0u;
    const uint32_t estimator_acquired = state->estimator_acquired;
    state->estimator_acquired = hall_position_three_flag(resolved_valid || (estimator_acquired != 0u));
    state->estimator_lock_lost = hall_position_three_flag((estimator_lock_lost != 0u) || ((estimator_acquired != 0u) &&
        (restart || !counted || (((resolved_valid) ? yaw_limit : ambiguous_yaw_limit) < size))));
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
