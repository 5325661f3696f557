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
/* Return a value in -high .. high, which `last` becomes; for any other, set its fault bit and return *last. */
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

uint32_t hall_position_three_step(hall_position_three_state_t *state, const hall_position_three_input_t *in, hall_position_three_output_t *out)
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
    const float V_ax_held = hall_position_three_hold_within(in->V_ax, 5.0f, &state->guard_last_V_ax, 0x00000001u, &faults);
    const float V_ay_held = hall_position_three_hold_within(in->V_ay, 5.0f, &state->guard_last_V_ay, 0x00000002u, &faults);
    const float V_bx_held = hall_position_three_hold_within(in->V_bx, 5.0f, &state->guard_last_V_bx, 0x00000004u, &faults);
    const float V_by_held = hall_position_three_hold_within(in->V_by, 5.0f, &state->guard_last_V_by, 0x00000008u, &faults);
    const float V_cx_held = hall_position_three_hold_within(in->V_cx, 5.0f, &state->guard_last_V_cx, 0x00000010u, &faults);
    const float V_cy_held = hall_position_three_hold_within(in->V_cy, 5.0f, &state->guard_last_V_cy, 0x00000020u, &faults);
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
    const float yaw_fraction_sine_part = state->estimator_yaw + estimator_motion_yaw;
    const float f1_argument = yaw_fraction_sine_part * yaw_fraction_sine_part;
    const float f1 = yaw_fraction_sine_part * f1_polynomial(f1_argument);
    const float yaw_fraction_sine = 4.0f * f1;
    const float yaw_fraction_cosine = yaw_fraction_cosine_polynomial(f1_argument);
    const float estimator_motion_x = state->estimator_motion_x;
    const float phase_fraction_sine_part = state->estimator_phase_x + estimator_motion_x;
    const float phase_fraction_sine_part_2 = hall_position_three_limit(4.0f * (f1 * yaw_fraction_cosine), 2.0f);
    const float phase_fraction_sine_part_3 = 1.0f - (0.5f * (phase_fraction_sine_part_2 * phase_fraction_sine_part_2));
    const float phase_fraction_sine_part_4 = hall_position_three_limit(phase_fraction_sine_part_2 * (1.0f - (0.125f * (yaw_fraction_sine * yaw_fraction_sine))), 1.0f);
    const float phase_fraction_sine_part_5 = (arm_ax * phase_fraction_sine_part_3) - (arm_ay * phase_fraction_sine_part_4);
    const float phase_fraction_sine_part_6 = phase_fraction_sine_part + phase_fraction_sine_part_5;
    const float f3_argument = phase_fraction_sine_part_6 * phase_fraction_sine_part_6;
    const float f3 = phase_fraction_sine_part_6 * f3_polynomial(f3_argument);
    const float phase_fraction_sine = 8.0f * f3;
    const float phase_fraction_cosine = phase_fraction_cosine_polynomial(f3_argument);
    const float estimator_motion_y = state->estimator_motion_y;
    const float phase_fraction_sine_part_7 = state->estimator_phase_y + estimator_motion_y;
    const float phase_fraction_sine_part_8 = (arm_ay * phase_fraction_sine_part_3) - (-arm_ax * phase_fraction_sine_part_4);
    const float phase_fraction_sine_part_9 = phase_fraction_sine_part_7 + phase_fraction_sine_part_8;
    const float f5_argument = phase_fraction_sine_part_9 * phase_fraction_sine_part_9;
    const float f5 = phase_fraction_sine_part_9 * f5_polynomial(f5_argument);
    const float phase_fraction_sine_2 = 8.0f * f5;
    const float phase_fraction_cosine_2 = phase_fraction_cosine_2_polynomial(f5_argument);
    const float phase_fraction_sine_part_10 = (arm_bx * phase_fraction_sine_part_3) - (arm_by * phase_fraction_sine_part_4);
    const float phase_fraction_sine_part_11 = phase_fraction_sine_part + phase_fraction_sine_part_10;
    const float f7_argument = phase_fraction_sine_part_11 * phase_fraction_sine_part_11;
    const float f7 = phase_fraction_sine_part_11 * f7_polynomial(f7_argument);
    const float phase_fraction_sine_3 = 8.0f * f7;
    const float phase_fraction_cosine_3 = phase_fraction_cosine_3_polynomial(f7_argument);
    const float phase_fraction_sine_part_12 = (arm_by * phase_fraction_sine_part_3) - (-arm_bx * phase_fraction_sine_part_4);
    const float phase_fraction_sine_part_13 = phase_fraction_sine_part_7 + phase_fraction_sine_part_12;
    const float f9_argument = phase_fraction_sine_part_13 * phase_fraction_sine_part_13;
    const float f9 = phase_fraction_sine_part_13 * f9_polynomial(f9_argument);
    const float phase_fraction_sine_4 = 8.0f * f9;
    const float phase_fraction_cosine_4 = phase_fraction_cosine_4_polynomial(f9_argument);
    const float phase_fraction_sine_part_14 = (arm_cx * phase_fraction_sine_part_3) + (-arm_cy * phase_fraction_sine_part_4);
    const float phase_fraction_sine_part_15 = phase_fraction_sine_part + phase_fraction_sine_part_14;
    const float f11_argument = phase_fraction_sine_part_15 * phase_fraction_sine_part_15;
    const float f11 = phase_fraction_sine_part_15 * f11_polynomial(f11_argument);
    const float phase_fraction_sine_5 = 8.0f * f11;
    const float phase_fraction_cosine_5 = phase_fraction_cosine_5_polynomial(f11_argument);
    const float phase_fraction_sine_part_16 = (arm_cx * phase_fraction_sine_part_4) - (-arm_cy * phase_fraction_sine_part_3);
    const float phase_fraction_sine_part_17 = phase_fraction_sine_part_7 + phase_fraction_sine_part_16;
    const float f11_argument_2 = phase_fraction_sine_part_17 * phase_fraction_sine_part_17;
    const float f11_2 = phase_fraction_sine_part_17 * f11_polynomial(f11_argument_2);
    const float phase_fraction_sine_6 = 8.0f * f11_2;
    const float phase_fraction_cosine_6 = phase_fraction_cosine_5_polynomial(f11_argument_2);
    const uint32_t estimator_excluded_sensor = state->estimator_excluded_sensor;
    const bool cost_0_test = fault_V_ax || fault_V_ay || (estimator_excluded_sensor == 1u);
    const float cost_0_part = 1.0f - (cost_0_test ? 1.0f : 0.0f);
    const float cost_0_part_times_V_ax = cost_0_part * V_ax_held;
    const float cost_0_part_times_V_ay = cost_0_part * V_ay_held;
    const float cost_0_part_2 = (phase_fraction_sine_part_3 * cost_0_part_times_V_ax) - (phase_fraction_sine_part_4 * cost_0_part_times_V_ay);
    const float cost_0_part_3 = f3 * phase_fraction_cosine;
    const float cost_0_part_4 = hall_position_three_limit(8.0f * (cost_0_part_3 * (1.0f - (0.03125f * (phase_fraction_sine * phase_fraction_sine)))), 2.0f);
    const float cost_0_part_5 = 8.0f * cost_0_part_3;
    const float cost_0_part_6 = hall_position_three_limit(cost_0_part_4 * (1.0f - (0.125f * (cost_0_part_5 * cost_0_part_5))), 1.0f);
    const float cost_0_part_7 = cost_0_part * estimator_field_1;
    const float cost_0_part_6_squared = cost_0_part_6 * cost_0_part_6;
    const float cost_0_part_8 = cost_0_part * estimator_field_3;
    const float cost_0_part_9 = cost_0_part * estimator_field_5;
    const float cost_0_part_10 = cost_0_part_6 * (cost_0_part_7 + (cost_0_part_6_squared * (cost_0_part_8 + (cost_0_part_6_squared * cost_0_part_9))));
    const float cost_0_part_11 = cost_0_part_2 - cost_0_part_10;
    const float cost_0_part_11_squared = cost_0_part_11 * cost_0_part_11;
    const bool cost_0_test_2 = fault_V_bx || fault_V_by || (estimator_excluded_sensor == 2u);
    const float cost_0_part_12 = 1.0f - (cost_0_test_2 ? 1.0f : 0.0f);
    const float cost_0_part_12_times_V_bx = cost_0_part_12 * V_bx_held;
    const float cost_0_part_12_times_V_by = cost_0_part_12 * V_by_held;
    const float cost_0_part_13 = (phase_fraction_sine_part_3 * cost_0_part_12_times_V_bx) - (phase_fraction_sine_part_4 * cost_0_part_12_times_V_by);
    const float cost_0_part_14 = f7 * phase_fraction_cosine_3;
    const float cost_0_part_15 = hall_position_three_limit(8.0f * (cost_0_part_14 * (1.0f - (0.03125f * (phase_fraction_sine_3 * phase_fraction_sine_3)))), 2.0f);
    const float cost_0_part_16 = 8.0f * cost_0_part_14;
    const float cost_0_part_17 = hall_position_three_limit(cost_0_part_15 * (1.0f - (0.125f * (cost_0_part_16 * cost_0_part_16))), 1.0f);
    const float cost_0_part_18 = cost_0_part_12 * estimator_field_1;
    const float cost_0_part_17_squared = cost_0_part_17 * cost_0_part_17;
    const float cost_0_part_19 = cost_0_part_12 * estimator_field_3;
    const float cost_0_part_20 = cost_0_part_12 * estimator_field_5;
    const float cost_0_part_21 = cost_0_part_17 * (cost_0_part_18 + (cost_0_part_17_squared * (cost_0_part_19 + (cost_0_part_17_squared * cost_0_part_20))));
    const float cost_0_part_22 = cost_0_part_13 - cost_0_part_21;
    const float cost_0_part_22_squared = cost_0_part_22 * cost_0_part_22;
    const bool cost_0_test_3 = fault_V_cx || fault_V_cy || (estimator_excluded_sensor == 3u);
    const float cost_0_part_23 = 1.0f - (cost_0_test_3 ? 1.0f : 0.0f);
    const float cost_0_part_23_times_V_cx = cost_0_part_23 * V_cx_held;
    const float cost_0_part_23_times_V_cy = cost_0_part_23 * V_cy_held;
    const float cost_0_part_24 = (phase_fraction_sine_part_3 * cost_0_part_23_times_V_cx) - (phase_fraction_sine_part_4 * cost_0_part_23_times_V_cy);
    const float cost_0_part_25 = f11 * phase_fraction_cosine_5;
    const float cost_0_part_26 = hall_position_three_limit(8.0f * (cost_0_part_25 * (1.0f - (0.03125f * (phase_fraction_sine_5 * phase_fraction_sine_5)))), 2.0f);
    const float cost_0_part_27 = 8.0f * cost_0_part_25;
    const float cost_0_part_28 = hall_position_three_limit(cost_0_part_26 * (1.0f - (0.125f * (cost_0_part_27 * cost_0_part_27))), 1.0f);
    const float cost_0_part_29 = cost_0_part_23 * estimator_field_1;
    const float cost_0_part_28_squared = cost_0_part_28 * cost_0_part_28;
    const float cost_0_part_30 = cost_0_part_23 * estimator_field_3;
    const float cost_0_part_31 = cost_0_part_23 * estimator_field_5;
    const float cost_0_part_32 = cost_0_part_28 * (cost_0_part_29 + (cost_0_part_28_squared * (cost_0_part_30 + (cost_0_part_28_squared * cost_0_part_31))));
    const float cost_0_part_33 = cost_0_part_24 - cost_0_part_32;
    const float cost_0_part_33_squared = cost_0_part_33 * cost_0_part_33;
    const float cost_0_part_34 = (phase_fraction_sine_part_4 * cost_0_part_times_V_ax) + (phase_fraction_sine_part_3 * cost_0_part_times_V_ay);
    const float cost_0_part_35 = f5 * phase_fraction_cosine_2;
    const float cost_0_part_36 = hall_position_three_limit(8.0f * (cost_0_part_35 * (1.0f - (0.03125f * (phase_fraction_sine_2 * phase_fraction_sine_2)))), 2.0f);
    const float cost_0_part_37 = 8.0f * cost_0_part_35;
    const float cost_0_part_38 = hall_position_three_limit(cost_0_part_36 * (1.0f - (0.125f * (cost_0_part_37 * cost_0_part_37))), 1.0f);
    const float cost_0_part_38_squared = cost_0_part_38 * cost_0_part_38;
    const float cost_0_part_39 = cost_0_part_38 * (cost_0_part_7 + (cost_0_part_38_squared * (cost_0_part_8 + (cost_0_part_38_squared * cost_0_part_9))));
    const float cost_0_part_40 = cost_0_part_34 - cost_0_part_39;
    const float cost_0_part_40_squared = cost_0_part_40 * cost_0_part_40;
    const float cost_0_part_41 = (phase_fraction_sine_part_4 * cost_0_part_12_times_V_bx) + (phase_fraction_sine_part_3 * cost_0_part_12_times_V_by);
    const float cost_0_part_42 = f9 * phase_fraction_cosine_4;
    const float cost_0_part_43 = hall_position_three_limit(8.0f * (cost_0_part_42 * (1.0f - (0.03125f * (phase_fraction_sine_4 * phase_fraction_sine_4)))), 2.0f);
    const float cost_0_part_44 = 8.0f * cost_0_part_42;
    const float cost_0_part_45 = hall_position_three_limit(cost_0_part_43 * (1.0f - (0.125f * (cost_0_part_44 * cost_0_part_44))), 1.0f);
    const float cost_0_part_45_squared = cost_0_part_45 * cost_0_part_45;
    const float cost_0_part_46 = cost_0_part_45 * (cost_0_part_18 + (cost_0_part_45_squared * (cost_0_part_19 + (cost_0_part_45_squared * cost_0_part_20))));
    const float cost_0_part_47 = cost_0_part_41 - cost_0_part_46;
    const float cost_0_part_47_squared = cost_0_part_47 * cost_0_part_47;
    const float cost_0_part_48 = (phase_fraction_sine_part_4 * cost_0_part_23_times_V_cx) + (phase_fraction_sine_part_3 * cost_0_part_23_times_V_cy);
    const float cost_0_part_49 = f11_2 * phase_fraction_cosine_6;
    const float cost_0_part_50 = hall_position_three_limit(8.0f * (cost_0_part_49 * (1.0f - (0.03125f * (phase_fraction_sine_6 * phase_fraction_sine_6)))), 2.0f);
    const float cost_0_part_51 = 8.0f * cost_0_part_49;
    const float cost_0_part_52 = hall_position_three_limit(cost_0_part_50 * (1.0f - (0.125f * (cost_0_part_51 * cost_0_part_51))), 1.0f);
    const float cost_0_part_52_squared = cost_0_part_52 * cost_0_part_52;
    const float cost_0_part_53 = cost_0_part_52 * (cost_0_part_29 + (cost_0_part_52_squared * (cost_0_part_30 + (cost_0_part_52_squared * cost_0_part_31))));
    const float cost_0_part_54 = cost_0_part_48 - cost_0_part_53;
    const float cost_0_part_54_squared = cost_0_part_54 * cost_0_part_54;
    const float cost_0 = cost_0_part_11_squared + cost_0_part_22_squared + cost_0_part_33_squared + cost_0_part_40_squared + cost_0_part_47_squared + cost_0_part_54_squared;
    const float yaw_change_sine_part = 1.0f - (0.5f * (cost_0_part_4 * cost_0_part_4));
    const float yaw_change_sine_part_2 = cost_0_part * estimator_slope_0;
    const float yaw_change_sine_part_3 = cost_0_part * estimator_slope_2;
    const float yaw_change_sine_part_4 = cost_0_part * estimator_slope_4;
    const float yaw_change_sine_part_5 = yaw_change_sine_part * (yaw_change_sine_part_2 + (cost_0_part_6_squared * (yaw_change_sine_part_3 + (cost_0_part_6_squared * yaw_change_sine_part_4))));
    const float yaw_change_sine_part_6 = cost_0_part_39 - (yaw_change_sine_part_5 * phase_fraction_sine_part_8);
    const float yaw_change_sine_part_7 = 1.0f - (0.5f * (cost_0_part_15 * cost_0_part_15));
    const float yaw_change_sine_part_8 = cost_0_part_12 * estimator_slope_0;
    const float yaw_change_sine_part_9 = cost_0_part_12 * estimator_slope_2;
    const float yaw_change_sine_part_10 = cost_0_part_12 * estimator_slope_4;
    const float yaw_change_sine_part_11 = yaw_change_sine_part_7 * (yaw_change_sine_part_8 + (cost_0_part_17_squared * (yaw_change_sine_part_9 + (cost_0_part_17_squared * yaw_change_sine_part_10))));
    const float yaw_change_sine_part_12 = cost_0_part_46 - (yaw_change_sine_part_11 * phase_fraction_sine_part_12);
    const float yaw_change_sine_part_13 = 1.0f - (0.5f * (cost_0_part_26 * cost_0_part_26));
    const float yaw_change_sine_part_14 = cost_0_part_23 * estimator_slope_0;
    const float yaw_change_sine_part_15 = cost_0_part_23 * estimator_slope_2;
    const float yaw_change_sine_part_16 = cost_0_part_23 * estimator_slope_4;
    const float yaw_change_sine_part_17 = yaw_change_sine_part_13 * (yaw_change_sine_part_14 + (cost_0_part_28_squared * (yaw_change_sine_part_15 + (cost_0_part_28_squared * yaw_change_sine_part_16))));
    const float yaw_change_sine_part_18 = cost_0_part_53 - (yaw_change_sine_part_17 * phase_fraction_sine_part_16);
    const float yaw_change_sine_part_19 = (yaw_change_sine_part_5 * yaw_change_sine_part_12) - (yaw_change_sine_part_11 * yaw_change_sine_part_6);
    const float yaw_change_sine_part_20 = (yaw_change_sine_part_5 * yaw_change_sine_part_18) - (yaw_change_sine_part_17 * yaw_change_sine_part_6);
    const float yaw_change_sine_part_21 = (damping * ((yaw_change_sine_part_6 * cost_0_part_11) + (yaw_change_sine_part_12 * cost_0_part_22) + (yaw_change_sine_part_18 * cost_0_part_33))) + (yaw_change_sine_part_19 * ((yaw_change_sine_part_5 * cost_0_part_22) - (yaw_change_sine_part_11 * cost_0_part_11))) + (yaw_change_sine_part_20 * ((yaw_change_sine_part_5 * cost_0_part_33) - (yaw_change_sine_part_17 * cost_0_part_11)));
    const float yaw_change_sine_part_22 = (yaw_change_sine_part_11 * yaw_change_sine_part_18) - (yaw_change_sine_part_17 * yaw_change_sine_part_12);
    const float yaw_change_sine_part_23 = 1.0f / (damping + ((yaw_change_sine_part_5 * yaw_change_sine_part_5) + (yaw_change_sine_part_11 * yaw_change_sine_part_11) + (yaw_change_sine_part_17 * yaw_change_sine_part_17)));
    const float yaw_change_sine_part_24 = 1.0f - (0.5f * (cost_0_part_36 * cost_0_part_36));
    const float yaw_change_sine_part_25 = yaw_change_sine_part_24 * (yaw_change_sine_part_2 + (cost_0_part_38_squared * (yaw_change_sine_part_3 + (cost_0_part_38_squared * yaw_change_sine_part_4))));
    const float yaw_change_sine_part_26 = (yaw_change_sine_part_25 * phase_fraction_sine_part_5) - cost_0_part_10;
    const float yaw_change_sine_part_27 = 1.0f - (0.5f * (cost_0_part_43 * cost_0_part_43));
    const float yaw_change_sine_part_28 = yaw_change_sine_part_27 * (yaw_change_sine_part_8 + (cost_0_part_45_squared * (yaw_change_sine_part_9 + (cost_0_part_45_squared * yaw_change_sine_part_10))));
    const float yaw_change_sine_part_29 = (yaw_change_sine_part_28 * phase_fraction_sine_part_10) - cost_0_part_21;
    const float yaw_change_sine_part_30 = 1.0f - (0.5f * (cost_0_part_50 * cost_0_part_50));
    const float yaw_change_sine_part_31 = yaw_change_sine_part_30 * (yaw_change_sine_part_14 + (cost_0_part_52_squared * (yaw_change_sine_part_15 + (cost_0_part_52_squared * yaw_change_sine_part_16))));
    const float yaw_change_sine_part_32 = (yaw_change_sine_part_31 * phase_fraction_sine_part_14) - cost_0_part_32;
    const float yaw_change_sine_part_33 = (yaw_change_sine_part_25 * yaw_change_sine_part_29) - (yaw_change_sine_part_28 * yaw_change_sine_part_26);
    const float yaw_change_sine_part_34 = (yaw_change_sine_part_25 * yaw_change_sine_part_32) - (yaw_change_sine_part_31 * yaw_change_sine_part_26);
    const float yaw_change_sine_part_35 = (damping * ((yaw_change_sine_part_26 * cost_0_part_40) + (yaw_change_sine_part_29 * cost_0_part_47) + (yaw_change_sine_part_32 * cost_0_part_54))) + (yaw_change_sine_part_33 * ((yaw_change_sine_part_25 * cost_0_part_47) - (yaw_change_sine_part_28 * cost_0_part_40))) + (yaw_change_sine_part_34 * ((yaw_change_sine_part_25 * cost_0_part_54) - (yaw_change_sine_part_31 * cost_0_part_40)));
    const float yaw_change_sine_part_36 = (yaw_change_sine_part_28 * yaw_change_sine_part_32) - (yaw_change_sine_part_31 * yaw_change_sine_part_29);
    const float yaw_change_sine_part_37 = 1.0f / (damping + ((yaw_change_sine_part_25 * yaw_change_sine_part_25) + (yaw_change_sine_part_28 * yaw_change_sine_part_28) + (yaw_change_sine_part_31 * yaw_change_sine_part_31)));
    const float yaw_change_sine_part_38 = (((damping * ((yaw_change_sine_part_6 * yaw_change_sine_part_6) + (yaw_change_sine_part_12 * yaw_change_sine_part_12) + (yaw_change_sine_part_18 * yaw_change_sine_part_18))) + (yaw_change_sine_part_19 * yaw_change_sine_part_19) + (yaw_change_sine_part_20 * yaw_change_sine_part_20) + (yaw_change_sine_part_22 * yaw_change_sine_part_22)) * yaw_change_sine_part_23) + (((damping * ((yaw_change_sine_part_26 * yaw_change_sine_part_26) + (yaw_change_sine_part_29 * yaw_change_sine_part_29) + (yaw_change_sine_part_32 * yaw_change_sine_part_32))) + (yaw_change_sine_part_33 * yaw_change_sine_part_33) + (yaw_change_sine_part_34 * yaw_change_sine_part_34) + (yaw_change_sine_part_36 * yaw_change_sine_part_36)) * yaw_change_sine_part_37);
    const float yaw_change_sine_part_39 = (((yaw_change_sine_part_21 + (yaw_change_sine_part_22 * ((yaw_change_sine_part_11 * cost_0_part_33) - (yaw_change_sine_part_17 * cost_0_part_22)))) * yaw_change_sine_part_23) + ((yaw_change_sine_part_35 + (yaw_change_sine_part_36 * ((yaw_change_sine_part_28 * cost_0_part_54) - (yaw_change_sine_part_31 * cost_0_part_47)))) * yaw_change_sine_part_37)) / (yaw_damping + yaw_change_sine_part_38);
    const float yaw_change_sine_part_40 = hall_position_three_limit(yaw_change_sine_part_39, max_yaw_step);
    const float yaw_change_sine_part_41 = yaw_change_sine_part_40 * yaw_change_sine_part_40;
    const float yaw_change_sine = yaw_change_sine_part_40 * yaw_change_sine_polynomial(yaw_change_sine_part_41);
    const float half_yaw_change_sine = yaw_change_sine_part_40 * half_yaw_change_sine_polynomial(yaw_change_sine_part_41);
    const float half_yaw_change_sine_squared = half_yaw_change_sine * half_yaw_change_sine;
    const float cost_1_part = 1.0f - half_yaw_change_sine_squared;
    const float cost_1_part_2 = hall_position_three_limit(((yaw_change_sine_part_5 * cost_0_part_11) + (yaw_change_sine_part_11 * cost_0_part_22) + (yaw_change_sine_part_17 * cost_0_part_33) - (((yaw_change_sine_part_5 * yaw_change_sine_part_6) + (yaw_change_sine_part_11 * yaw_change_sine_part_12) + (yaw_change_sine_part_17 * yaw_change_sine_part_18)) * yaw_change_sine_part_40)) * yaw_change_sine_part_23, 0.5f);
    const float cost_1_part_3 = (phase_fraction_sine_part_5 * half_yaw_change_sine_squared) + (phase_fraction_sine_part_8 * yaw_change_sine);
    const float cost_1_part_4 = cost_1_part_2 - cost_1_part_3;
    const float f15_argument = cost_1_part_4 * cost_1_part_4;
    const float f15 = f15_polynomial(f15_argument);
    const float f16 = cost_1_part_4 * f16_polynomial(f15_argument);
    const float cost_1_part_5 = (cost_0_part_6 * f15) + (yaw_change_sine_part * f16);
    const float cost_1_part_5_squared = cost_1_part_5 * cost_1_part_5;
    const float cost_1_part_6 = cost_1_part_5 * (cost_0_part_7 + (cost_1_part_5_squared * (cost_0_part_8 + (cost_1_part_5_squared * cost_0_part_9))));
    const float cost_1_part_7 = (cost_0_part_2 * cost_1_part) - (cost_0_part_34 * yaw_change_sine) - cost_1_part_6;
    const float cost_1_part_8 = (phase_fraction_sine_part_10 * half_yaw_change_sine_squared) + (phase_fraction_sine_part_12 * yaw_change_sine);
    const float cost_1_part_9 = cost_1_part_2 - cost_1_part_8;
    const float f17_argument = cost_1_part_9 * cost_1_part_9;
    const float f17 = f17_polynomial(f17_argument);
    const float f18 = cost_1_part_9 * f18_polynomial(f17_argument);
    const float cost_1_part_10 = (cost_0_part_17 * f17) + (yaw_change_sine_part_7 * f18);
    const float cost_1_part_10_squared = cost_1_part_10 * cost_1_part_10;
    const float cost_1_part_11 = cost_1_part_10 * (cost_0_part_18 + (cost_1_part_10_squared * (cost_0_part_19 + (cost_1_part_10_squared * cost_0_part_20))));
    const float cost_1_part_12 = (cost_0_part_13 * cost_1_part) - (cost_0_part_41 * yaw_change_sine) - cost_1_part_11;
    const float cost_1_part_13 = (phase_fraction_sine_part_14 * half_yaw_change_sine_squared) + (phase_fraction_sine_part_16 * yaw_change_sine);
    const float cost_1_part_14 = cost_1_part_2 - cost_1_part_13;
    const float f19_argument = cost_1_part_14 * cost_1_part_14;
    const float f19 = f19_polynomial(f19_argument);
    const float f20 = cost_1_part_14 * f20_polynomial(f19_argument);
    const float cost_1_part_15 = (cost_0_part_28 * f19) + (yaw_change_sine_part_13 * f20);
    const float cost_1_part_15_squared = cost_1_part_15 * cost_1_part_15;
    const float cost_1_part_16 = cost_1_part_15 * (cost_0_part_29 + (cost_1_part_15_squared * (cost_0_part_30 + (cost_1_part_15_squared * cost_0_part_31))));
    const float cost_1_part_17 = (cost_0_part_24 * cost_1_part) - (cost_0_part_48 * yaw_change_sine) - cost_1_part_16;
    const float cost_1_part_18 = hall_position_three_limit(((yaw_change_sine_part_25 * cost_0_part_40) + (yaw_change_sine_part_28 * cost_0_part_47) + (yaw_change_sine_part_31 * cost_0_part_54) - (((yaw_change_sine_part_25 * yaw_change_sine_part_26) + (yaw_change_sine_part_28 * yaw_change_sine_part_29) + (yaw_change_sine_part_31 * yaw_change_sine_part_32)) * yaw_change_sine_part_40)) * yaw_change_sine_part_37, 0.5f);
    const float cost_1_part_19 = (phase_fraction_sine_part_5 * yaw_change_sine) - (phase_fraction_sine_part_8 * half_yaw_change_sine_squared);
    const float cost_1_part_20 = cost_1_part_18 + cost_1_part_19;
    const float f15_argument_2 = cost_1_part_20 * cost_1_part_20;
    const float f15_2 = f15_polynomial(f15_argument_2);
    const float f16_2 = cost_1_part_20 * f16_polynomial(f15_argument_2);
    const float cost_1_part_21 = (cost_0_part_38 * f15_2) + (yaw_change_sine_part_24 * f16_2);
    const float cost_1_part_21_squared = cost_1_part_21 * cost_1_part_21;
    const float cost_1_part_22 = cost_1_part_21 * (cost_0_part_7 + (cost_1_part_21_squared * (cost_0_part_8 + (cost_1_part_21_squared * cost_0_part_9))));
    const float cost_1_part_23 = (cost_0_part_34 * cost_1_part) + (cost_0_part_2 * yaw_change_sine) - cost_1_part_22;
    const float cost_1_part_24 = (phase_fraction_sine_part_10 * yaw_change_sine) - (phase_fraction_sine_part_12 * half_yaw_change_sine_squared);
    const float cost_1_part_25 = cost_1_part_18 + cost_1_part_24;
    const float f17_argument_2 = cost_1_part_25 * cost_1_part_25;
    const float f17_2 = f17_polynomial(f17_argument_2);
    const float f18_2 = cost_1_part_25 * f18_polynomial(f17_argument_2);
    const float cost_1_part_26 = (cost_0_part_45 * f17_2) + (yaw_change_sine_part_27 * f18_2);
    const float cost_1_part_26_squared = cost_1_part_26 * cost_1_part_26;
    const float cost_1_part_27 = cost_1_part_26 * (cost_0_part_18 + (cost_1_part_26_squared * (cost_0_part_19 + (cost_1_part_26_squared * cost_0_part_20))));
    const float cost_1_part_28 = (cost_0_part_41 * cost_1_part) + (cost_0_part_13 * yaw_change_sine) - cost_1_part_27;
    const float cost_1_part_29 = (phase_fraction_sine_part_14 * yaw_change_sine) - (phase_fraction_sine_part_16 * half_yaw_change_sine_squared);
    const float cost_1_part_30 = cost_1_part_18 + cost_1_part_29;
    const float f19_argument_2 = cost_1_part_30 * cost_1_part_30;
    const float f19_2 = f19_polynomial(f19_argument_2);
    const float f20_2 = cost_1_part_30 * f20_polynomial(f19_argument_2);
    const float cost_1_part_31 = (cost_0_part_52 * f19_2) + (yaw_change_sine_part_30 * f20_2);
    const float cost_1_part_31_squared = cost_1_part_31 * cost_1_part_31;
    const float cost_1_part_32 = cost_1_part_31 * (cost_0_part_29 + (cost_1_part_31_squared * (cost_0_part_30 + (cost_1_part_31_squared * cost_0_part_31))));
    const float cost_1_part_33 = (cost_0_part_48 * cost_1_part) + (cost_0_part_24 * yaw_change_sine) - cost_1_part_32;
    const float cost_1 = (cost_1_part_7 * cost_1_part_7) + (cost_1_part_12 * cost_1_part_12) + (cost_1_part_17 * cost_1_part_17) + (cost_1_part_23 * cost_1_part_23) + (cost_1_part_28 * cost_1_part_28) + (cost_1_part_33 * cost_1_part_33) + (damping * ((cost_1_part_2 * cost_1_part_2) + (cost_1_part_18 * cost_1_part_18) + (squared_yaw_arm * yaw_change_sine_part_41)));
    const bool yaw_change_sine_test = cost_1 <= ((cost_factor * cost_0) + cost_slack);
    const float yaw_change_sine_part_42 = ((yaw_change_sine_part * f15) - (cost_0_part_6 * f16)) * (yaw_change_sine_part_2 + (cost_1_part_5_squared * (yaw_change_sine_part_3 + (cost_1_part_5_squared * yaw_change_sine_part_4))));
    const float yaw_change_sine_part_43 = cost_1_part_22 - (yaw_change_sine_part_42 * (phase_fraction_sine_part_8 + cost_1_part_19));
    const float yaw_change_sine_part_44 = ((yaw_change_sine_part_7 * f17) - (cost_0_part_17 * f18)) * (yaw_change_sine_part_8 + (cost_1_part_10_squared * (yaw_change_sine_part_9 + (cost_1_part_10_squared * yaw_change_sine_part_10))));
    const float yaw_change_sine_part_45 = cost_1_part_27 - (yaw_change_sine_part_44 * (phase_fraction_sine_part_12 + cost_1_part_24));
    const float yaw_change_sine_part_46 = ((yaw_change_sine_part_13 * f19) - (cost_0_part_28 * f20)) * (yaw_change_sine_part_14 + (cost_1_part_15_squared * (yaw_change_sine_part_15 + (cost_1_part_15_squared * yaw_change_sine_part_16))));
    const float yaw_change_sine_part_47 = cost_1_part_32 - (yaw_change_sine_part_46 * (phase_fraction_sine_part_16 + cost_1_part_29));
    const float yaw_change_sine_part_48 = (yaw_change_sine_part_42 * yaw_change_sine_part_43) + (yaw_change_sine_part_44 * yaw_change_sine_part_45) + (yaw_change_sine_part_46 * yaw_change_sine_part_47);
    const float yaw_change_sine_part_49 = (yaw_change_sine_part_42 * yaw_change_sine_part_45) - (yaw_change_sine_part_44 * yaw_change_sine_part_43);
    const float yaw_change_sine_part_50 = (yaw_change_sine_part_42 * yaw_change_sine_part_47) - (yaw_change_sine_part_46 * yaw_change_sine_part_43);
    const float yaw_change_sine_part_51 = (damping * ((yaw_change_sine_part_43 * cost_1_part_7) + (yaw_change_sine_part_45 * cost_1_part_12) + (yaw_change_sine_part_47 * cost_1_part_17) + (cost_1_part_2 * yaw_change_sine_part_48))) + (yaw_change_sine_part_49 * ((yaw_change_sine_part_42 * cost_1_part_12) - (yaw_change_sine_part_44 * cost_1_part_7))) + (yaw_change_sine_part_50 * ((yaw_change_sine_part_42 * cost_1_part_17) - (yaw_change_sine_part_46 * cost_1_part_7)));
    const float yaw_change_sine_part_52 = (yaw_change_sine_part_44 * yaw_change_sine_part_47) - (yaw_change_sine_part_46 * yaw_change_sine_part_45);
    const float yaw_change_sine_part_53 = 1.0f / (damping + ((yaw_change_sine_part_42 * yaw_change_sine_part_42) + (yaw_change_sine_part_44 * yaw_change_sine_part_44) + (yaw_change_sine_part_46 * yaw_change_sine_part_46)));
    const float yaw_change_sine_part_54 = ((yaw_change_sine_part_24 * f15_2) - (cost_0_part_38 * f16_2)) * (yaw_change_sine_part_2 + (cost_1_part_21_squared * (yaw_change_sine_part_3 + (cost_1_part_21_squared * yaw_change_sine_part_4))));
    const float yaw_change_sine_part_55 = (yaw_change_sine_part_54 * (phase_fraction_sine_part_5 - cost_1_part_3)) - cost_1_part_6;
    const float yaw_change_sine_part_56 = ((yaw_change_sine_part_27 * f17_2) - (cost_0_part_45 * f18_2)) * (yaw_change_sine_part_8 + (cost_1_part_26_squared * (yaw_change_sine_part_9 + (cost_1_part_26_squared * yaw_change_sine_part_10))));
    const float yaw_change_sine_part_57 = (yaw_change_sine_part_56 * (phase_fraction_sine_part_10 - cost_1_part_8)) - cost_1_part_11;
    const float yaw_change_sine_part_58 = ((yaw_change_sine_part_30 * f19_2) - (cost_0_part_52 * f20_2)) * (yaw_change_sine_part_14 + (cost_1_part_31_squared * (yaw_change_sine_part_15 + (cost_1_part_31_squared * yaw_change_sine_part_16))));
    const float yaw_change_sine_part_59 = (yaw_change_sine_part_58 * (phase_fraction_sine_part_14 - cost_1_part_13)) - cost_1_part_16;
    const float yaw_change_sine_part_60 = (yaw_change_sine_part_54 * yaw_change_sine_part_55) + (yaw_change_sine_part_56 * yaw_change_sine_part_57) + (yaw_change_sine_part_58 * yaw_change_sine_part_59);
    const float yaw_change_sine_part_61 = (yaw_change_sine_part_54 * yaw_change_sine_part_57) - (yaw_change_sine_part_56 * yaw_change_sine_part_55);
    const float yaw_change_sine_part_62 = (yaw_change_sine_part_54 * yaw_change_sine_part_59) - (yaw_change_sine_part_58 * yaw_change_sine_part_55);
    const float yaw_change_sine_part_63 = (damping * ((yaw_change_sine_part_55 * cost_1_part_23) + (yaw_change_sine_part_57 * cost_1_part_28) + (yaw_change_sine_part_59 * cost_1_part_33) + (cost_1_part_18 * yaw_change_sine_part_60))) + (yaw_change_sine_part_61 * ((yaw_change_sine_part_54 * cost_1_part_28) - (yaw_change_sine_part_56 * cost_1_part_23))) + (yaw_change_sine_part_62 * ((yaw_change_sine_part_54 * cost_1_part_33) - (yaw_change_sine_part_58 * cost_1_part_23)));
    const float yaw_change_sine_part_64 = (yaw_change_sine_part_56 * yaw_change_sine_part_59) - (yaw_change_sine_part_58 * yaw_change_sine_part_57);
    const float yaw_change_sine_part_65 = 1.0f / (damping + ((yaw_change_sine_part_54 * yaw_change_sine_part_54) + (yaw_change_sine_part_56 * yaw_change_sine_part_56) + (yaw_change_sine_part_58 * yaw_change_sine_part_58)));
    const float yaw_change_sine_part_66 = ((yaw_change_sine_part_51 + (yaw_change_sine_part_52 * ((yaw_change_sine_part_44 * cost_1_part_17) - (yaw_change_sine_part_46 * cost_1_part_12)))) * yaw_change_sine_part_53) + ((yaw_change_sine_part_63 + (yaw_change_sine_part_64 * ((yaw_change_sine_part_56 * cost_1_part_33) - (yaw_change_sine_part_58 * cost_1_part_28)))) * yaw_change_sine_part_65) - (yaw_damping * yaw_change_sine_part_40);
    const float yaw_change_sine_part_67 = (((damping * ((yaw_change_sine_part_43 * yaw_change_sine_part_43) + (yaw_change_sine_part_45 * yaw_change_sine_part_45) + (yaw_change_sine_part_47 * yaw_change_sine_part_47))) + (yaw_change_sine_part_49 * yaw_change_sine_part_49) + (yaw_change_sine_part_50 * yaw_change_sine_part_50) + (yaw_change_sine_part_52 * yaw_change_sine_part_52)) * yaw_change_sine_part_53) + (((damping * ((yaw_change_sine_part_55 * yaw_change_sine_part_55) + (yaw_change_sine_part_57 * yaw_change_sine_part_57) + (yaw_change_sine_part_59 * yaw_change_sine_part_59))) + (yaw_change_sine_part_61 * yaw_change_sine_part_61) + (yaw_change_sine_part_62 * yaw_change_sine_part_62) + (yaw_change_sine_part_64 * yaw_change_sine_part_64)) * yaw_change_sine_part_65);
    float yaw_change_sine_part_68 = yaw_change_sine_part_40;
    float cost_2_part = cost_1_part_2;
    float cost_2_part_2 = cost_1_part_18;
    float yaw_change_sine_part_69 = cost_1;
    if (!yaw_change_sine_test) {
        yaw_change_sine_part_68 = 0.0f;
        cost_2_part = 0.0f;
        cost_2_part_2 = 0.0f;
        yaw_change_sine_part_69 = cost_0;
    }
    const float yaw_change_sine_part_70 = hall_position_three_limit((yaw_change_sine_test) ? (yaw_change_sine_part_40 + (yaw_change_sine_part_66 / (yaw_damping + yaw_change_sine_part_67))) : (0.5f * (yaw_change_sine_part_40 + yaw_change_sine_part_68)), max_yaw_step);
    const float yaw_change_sine_part_71 = yaw_change_sine_part_70 * yaw_change_sine_part_70;
    const float yaw_change_sine_2 = yaw_change_sine_part_70 * yaw_change_sine_polynomial(yaw_change_sine_part_71);
    const float half_yaw_change_sine_2 = yaw_change_sine_part_70 * half_yaw_change_sine_polynomial(yaw_change_sine_part_71);
    const float cost_2_part_3 = half_yaw_change_sine_2 * half_yaw_change_sine_2;
    const float cost_2_part_4 = 1.0f - cost_2_part_3;
    const float cost_2_part_5 = yaw_change_sine_part_70 - yaw_change_sine_part_40;
    const float cost_2_part_6 = hall_position_three_limit((yaw_change_sine_test) ? (cost_1_part_2 + (((yaw_change_sine_part_42 * cost_1_part_7) + (yaw_change_sine_part_44 * cost_1_part_12) + (yaw_change_sine_part_46 * cost_1_part_17) - (damping * cost_1_part_2) - (yaw_change_sine_part_48 * cost_2_part_5)) * yaw_change_sine_part_53)) : (0.5f * (cost_1_part_2 + cost_2_part)), 0.5f);
    const float cost_2_part_7 = (phase_fraction_sine_part_5 * cost_2_part_3) + (phase_fraction_sine_part_8 * yaw_change_sine_2);
    const float cost_2_part_8 = cost_2_part_6 - cost_2_part_7;
    const float f15_argument_3 = cost_2_part_8 * cost_2_part_8;
    const float f15_3 = f15_polynomial(f15_argument_3);
    const float f16_3 = cost_2_part_8 * f16_polynomial(f15_argument_3);
    const float cost_2_part_9 = (cost_0_part_6 * f15_3) + (yaw_change_sine_part * f16_3);
    const float cost_2_part_9_squared = cost_2_part_9 * cost_2_part_9;
    const float cost_2_part_10 = cost_2_part_9 * (cost_0_part_7 + (cost_2_part_9_squared * (cost_0_part_8 + (cost_2_part_9_squared * cost_0_part_9))));
    const float cost_2_part_11 = (cost_0_part_2 * cost_2_part_4) - (cost_0_part_34 * yaw_change_sine_2) - cost_2_part_10;
    const float cost_2_part_12 = (phase_fraction_sine_part_10 * cost_2_part_3) + (phase_fraction_sine_part_12 * yaw_change_sine_2);
    const float cost_2_part_13 = cost_2_part_6 - cost_2_part_12;
    const float f17_argument_3 = cost_2_part_13 * cost_2_part_13;
    const float f17_3 = f17_polynomial(f17_argument_3);
    const float f18_3 = cost_2_part_13 * f18_polynomial(f17_argument_3);
    const float cost_2_part_14 = (cost_0_part_17 * f17_3) + (yaw_change_sine_part_7 * f18_3);
    const float cost_2_part_14_squared = cost_2_part_14 * cost_2_part_14;
    const float cost_2_part_15 = cost_2_part_14 * (cost_0_part_18 + (cost_2_part_14_squared * (cost_0_part_19 + (cost_2_part_14_squared * cost_0_part_20))));
    const float cost_2_part_16 = (cost_0_part_13 * cost_2_part_4) - (cost_0_part_41 * yaw_change_sine_2) - cost_2_part_15;
    const float cost_2_part_17 = (phase_fraction_sine_part_14 * cost_2_part_3) + (phase_fraction_sine_part_16 * yaw_change_sine_2);
    const float cost_2_part_18 = cost_2_part_6 - cost_2_part_17;
    const float f19_argument_3 = cost_2_part_18 * cost_2_part_18;
    const float f19_3 = f19_polynomial(f19_argument_3);
    const float f20_3 = cost_2_part_18 * f20_polynomial(f19_argument_3);
    const float cost_2_part_19 = (cost_0_part_28 * f19_3) + (yaw_change_sine_part_13 * f20_3);
    const float cost_2_part_19_squared = cost_2_part_19 * cost_2_part_19;
    const float cost_2_part_20 = cost_2_part_19 * (cost_0_part_29 + (cost_2_part_19_squared * (cost_0_part_30 + (cost_2_part_19_squared * cost_0_part_31))));
    const float cost_2_part_21 = (cost_0_part_24 * cost_2_part_4) - (cost_0_part_48 * yaw_change_sine_2) - cost_2_part_20;
    const float cost_2_part_22 = hall_position_three_limit((yaw_change_sine_test) ? (cost_1_part_18 + (((yaw_change_sine_part_54 * cost_1_part_23) + (yaw_change_sine_part_56 * cost_1_part_28) + (yaw_change_sine_part_58 * cost_1_part_33) - (damping * cost_1_part_18) - (yaw_change_sine_part_60 * cost_2_part_5)) * yaw_change_sine_part_65)) : (0.5f * (cost_1_part_18 + cost_2_part_2)), 0.5f);
    const float cost_2_part_23 = (phase_fraction_sine_part_5 * yaw_change_sine_2) - (phase_fraction_sine_part_8 * cost_2_part_3);
    const float cost_2_part_24 = cost_2_part_22 + cost_2_part_23;
    const float f15_argument_4 = cost_2_part_24 * cost_2_part_24;
    const float f15_4 = f15_polynomial(f15_argument_4);
    const float f16_4 = cost_2_part_24 * f16_polynomial(f15_argument_4);
    const float cost_2_part_25 = (cost_0_part_38 * f15_4) + (yaw_change_sine_part_24 * f16_4);
    const float cost_2_part_25_squared = cost_2_part_25 * cost_2_part_25;
    const float cost_2_part_26 = cost_2_part_25 * (cost_0_part_7 + (cost_2_part_25_squared * (cost_0_part_8 + (cost_2_part_25_squared * cost_0_part_9))));
    const float cost_2_part_27 = (cost_0_part_34 * cost_2_part_4) + (cost_0_part_2 * yaw_change_sine_2) - cost_2_part_26;
    const float cost_2_part_28 = (phase_fraction_sine_part_10 * yaw_change_sine_2) - (phase_fraction_sine_part_12 * cost_2_part_3);
    const float cost_2_part_29 = cost_2_part_22 + cost_2_part_28;
    const float f17_argument_4 = cost_2_part_29 * cost_2_part_29;
    const float f17_4 = f17_polynomial(f17_argument_4);
    const float f18_4 = cost_2_part_29 * f18_polynomial(f17_argument_4);
    const float cost_2_part_30 = (cost_0_part_45 * f17_4) + (yaw_change_sine_part_27 * f18_4);
    const float cost_2_part_30_squared = cost_2_part_30 * cost_2_part_30;
    const float cost_2_part_31 = cost_2_part_30 * (cost_0_part_18 + (cost_2_part_30_squared * (cost_0_part_19 + (cost_2_part_30_squared * cost_0_part_20))));
    const float cost_2_part_32 = (cost_0_part_41 * cost_2_part_4) + (cost_0_part_13 * yaw_change_sine_2) - cost_2_part_31;
    const float cost_2_part_33 = (phase_fraction_sine_part_14 * yaw_change_sine_2) - (phase_fraction_sine_part_16 * cost_2_part_3);
    const float cost_2_part_34 = cost_2_part_22 + cost_2_part_33;
    const float f19_argument_4 = cost_2_part_34 * cost_2_part_34;
    const float f19_4 = f19_polynomial(f19_argument_4);
    const float f20_4 = cost_2_part_34 * f20_polynomial(f19_argument_4);
    const float cost_2_part_35 = (cost_0_part_52 * f19_4) + (yaw_change_sine_part_30 * f20_4);
    const float cost_2_part_35_squared = cost_2_part_35 * cost_2_part_35;
    const float cost_2_part_36 = cost_2_part_35 * (cost_0_part_29 + (cost_2_part_35_squared * (cost_0_part_30 + (cost_2_part_35_squared * cost_0_part_31))));
    const float cost_2_part_37 = (cost_0_part_48 * cost_2_part_4) + (cost_0_part_24 * yaw_change_sine_2) - cost_2_part_36;
    const float cost_2 = (cost_2_part_11 * cost_2_part_11) + (cost_2_part_16 * cost_2_part_16) + (cost_2_part_21 * cost_2_part_21) + (cost_2_part_27 * cost_2_part_27) + (cost_2_part_32 * cost_2_part_32) + (cost_2_part_37 * cost_2_part_37) + (damping * ((cost_2_part_6 * cost_2_part_6) + (cost_2_part_22 * cost_2_part_22) + (squared_yaw_arm * yaw_change_sine_part_71)));
    const bool yaw_change_sine_test_2 = cost_2 <= ((cost_factor * yaw_change_sine_part_69) + cost_slack);
    const float yaw_change_sine_part_72 = ((yaw_change_sine_part * f15_3) - (cost_0_part_6 * f16_3)) * (yaw_change_sine_part_2 + (cost_2_part_9_squared * (yaw_change_sine_part_3 + (cost_2_part_9_squared * yaw_change_sine_part_4))));
    const float yaw_change_sine_part_73 = cost_2_part_26 - (yaw_change_sine_part_72 * (phase_fraction_sine_part_8 + cost_2_part_23));
    const float yaw_change_sine_part_74 = ((yaw_change_sine_part_7 * f17_3) - (cost_0_part_17 * f18_3)) * (yaw_change_sine_part_8 + (cost_2_part_14_squared * (yaw_change_sine_part_9 + (cost_2_part_14_squared * yaw_change_sine_part_10))));
    const float yaw_change_sine_part_75 = cost_2_part_31 - (yaw_change_sine_part_74 * (phase_fraction_sine_part_12 + cost_2_part_28));
    const float yaw_change_sine_part_76 = ((yaw_change_sine_part_13 * f19_3) - (cost_0_part_28 * f20_3)) * (yaw_change_sine_part_14 + (cost_2_part_19_squared * (yaw_change_sine_part_15 + (cost_2_part_19_squared * yaw_change_sine_part_16))));
    const float yaw_change_sine_part_77 = cost_2_part_36 - (yaw_change_sine_part_76 * (phase_fraction_sine_part_16 + cost_2_part_33));
    const float yaw_change_sine_part_78 = (yaw_change_sine_part_72 * yaw_change_sine_part_73) + (yaw_change_sine_part_74 * yaw_change_sine_part_75) + (yaw_change_sine_part_76 * yaw_change_sine_part_77);
    const float yaw_change_sine_part_79 = (yaw_change_sine_part_72 * yaw_change_sine_part_75) - (yaw_change_sine_part_74 * yaw_change_sine_part_73);
    const float yaw_change_sine_part_80 = (yaw_change_sine_part_72 * yaw_change_sine_part_77) - (yaw_change_sine_part_76 * yaw_change_sine_part_73);
    const float yaw_change_sine_part_81 = (damping * ((yaw_change_sine_part_73 * cost_2_part_11) + (yaw_change_sine_part_75 * cost_2_part_16) + (yaw_change_sine_part_77 * cost_2_part_21) + (cost_2_part_6 * yaw_change_sine_part_78))) + (yaw_change_sine_part_79 * ((yaw_change_sine_part_72 * cost_2_part_16) - (yaw_change_sine_part_74 * cost_2_part_11))) + (yaw_change_sine_part_80 * ((yaw_change_sine_part_72 * cost_2_part_21) - (yaw_change_sine_part_76 * cost_2_part_11)));
    const float yaw_change_sine_part_82 = (yaw_change_sine_part_74 * yaw_change_sine_part_77) - (yaw_change_sine_part_76 * yaw_change_sine_part_75);
    const float yaw_change_sine_part_83 = 1.0f / (damping + ((yaw_change_sine_part_72 * yaw_change_sine_part_72) + (yaw_change_sine_part_74 * yaw_change_sine_part_74) + (yaw_change_sine_part_76 * yaw_change_sine_part_76)));
    const float yaw_change_sine_part_84 = ((yaw_change_sine_part_24 * f15_4) - (cost_0_part_38 * f16_4)) * (yaw_change_sine_part_2 + (cost_2_part_25_squared * (yaw_change_sine_part_3 + (cost_2_part_25_squared * yaw_change_sine_part_4))));
    const float yaw_change_sine_part_85 = (yaw_change_sine_part_84 * (phase_fraction_sine_part_5 - cost_2_part_7)) - cost_2_part_10;
    const float yaw_change_sine_part_86 = ((yaw_change_sine_part_27 * f17_4) - (cost_0_part_45 * f18_4)) * (yaw_change_sine_part_8 + (cost_2_part_30_squared * (yaw_change_sine_part_9 + (cost_2_part_30_squared * yaw_change_sine_part_10))));
    const float yaw_change_sine_part_87 = (yaw_change_sine_part_86 * (phase_fraction_sine_part_10 - cost_2_part_12)) - cost_2_part_15;
    const float yaw_change_sine_part_88 = ((yaw_change_sine_part_30 * f19_4) - (cost_0_part_52 * f20_4)) * (yaw_change_sine_part_14 + (cost_2_part_35_squared * (yaw_change_sine_part_15 + (cost_2_part_35_squared * yaw_change_sine_part_16))));
    const float yaw_change_sine_part_89 = (yaw_change_sine_part_88 * (phase_fraction_sine_part_14 - cost_2_part_17)) - cost_2_part_20;
    const float yaw_change_sine_part_90 = (yaw_change_sine_part_84 * yaw_change_sine_part_85) + (yaw_change_sine_part_86 * yaw_change_sine_part_87) + (yaw_change_sine_part_88 * yaw_change_sine_part_89);
    const float yaw_change_sine_part_91 = (yaw_change_sine_part_84 * yaw_change_sine_part_87) - (yaw_change_sine_part_86 * yaw_change_sine_part_85);
    const float yaw_change_sine_part_92 = (yaw_change_sine_part_84 * yaw_change_sine_part_89) - (yaw_change_sine_part_88 * yaw_change_sine_part_85);
    const float yaw_change_sine_part_93 = (damping * ((yaw_change_sine_part_85 * cost_2_part_27) + (yaw_change_sine_part_87 * cost_2_part_32) + (yaw_change_sine_part_89 * cost_2_part_37) + (cost_2_part_22 * yaw_change_sine_part_90))) + (yaw_change_sine_part_91 * ((yaw_change_sine_part_84 * cost_2_part_32) - (yaw_change_sine_part_86 * cost_2_part_27))) + (yaw_change_sine_part_92 * ((yaw_change_sine_part_84 * cost_2_part_37) - (yaw_change_sine_part_88 * cost_2_part_27)));
    const float yaw_change_sine_part_94 = (yaw_change_sine_part_86 * yaw_change_sine_part_89) - (yaw_change_sine_part_88 * yaw_change_sine_part_87);
    const float yaw_change_sine_part_95 = 1.0f / (damping + ((yaw_change_sine_part_84 * yaw_change_sine_part_84) + (yaw_change_sine_part_86 * yaw_change_sine_part_86) + (yaw_change_sine_part_88 * yaw_change_sine_part_88)));
    const float yaw_change_sine_part_96 = ((yaw_change_sine_part_81 + (yaw_change_sine_part_82 * ((yaw_change_sine_part_74 * cost_2_part_21) - (yaw_change_sine_part_76 * cost_2_part_16)))) * yaw_change_sine_part_83) + ((yaw_change_sine_part_93 + (yaw_change_sine_part_94 * ((yaw_change_sine_part_86 * cost_2_part_37) - (yaw_change_sine_part_88 * cost_2_part_32)))) * yaw_change_sine_part_95) - (yaw_damping * yaw_change_sine_part_70);
    const float yaw_change_sine_part_97 = (((damping * ((yaw_change_sine_part_73 * yaw_change_sine_part_73) + (yaw_change_sine_part_75 * yaw_change_sine_part_75) + (yaw_change_sine_part_77 * yaw_change_sine_part_77))) + (yaw_change_sine_part_79 * yaw_change_sine_part_79) + (yaw_change_sine_part_80 * yaw_change_sine_part_80) + (yaw_change_sine_part_82 * yaw_change_sine_part_82)) * yaw_change_sine_part_83) + (((damping * ((yaw_change_sine_part_85 * yaw_change_sine_part_85) + (yaw_change_sine_part_87 * yaw_change_sine_part_87) + (yaw_change_sine_part_89 * yaw_change_sine_part_89))) + (yaw_change_sine_part_91 * yaw_change_sine_part_91) + (yaw_change_sine_part_92 * yaw_change_sine_part_92) + (yaw_change_sine_part_94 * yaw_change_sine_part_94)) * yaw_change_sine_part_95);
    float yaw_change_sine_part_98 = yaw_change_sine_part_70;
    float cost_3_part = cost_2_part_6;
    float cost_3_part_2 = cost_2_part_22;
    float yaw_change_sine_part_99 = cost_2;
    if (!yaw_change_sine_test_2) {
        yaw_change_sine_part_98 = yaw_change_sine_part_68;
        cost_3_part = cost_2_part;
        cost_3_part_2 = cost_2_part_2;
        yaw_change_sine_part_99 = yaw_change_sine_part_69;
    }
    const float yaw_change_sine_part_100 = hall_position_three_limit((yaw_change_sine_test_2) ? (yaw_change_sine_part_70 + (yaw_change_sine_part_96 / (yaw_damping + yaw_change_sine_part_97))) : (0.5f * (yaw_change_sine_part_70 + yaw_change_sine_part_98)), max_yaw_step);
    const float yaw_change_sine_part_101 = yaw_change_sine_part_100 * yaw_change_sine_part_100;
    const float yaw_change_sine_3 = yaw_change_sine_part_100 * yaw_change_sine_polynomial(yaw_change_sine_part_101);
    const float half_yaw_change_sine_3 = yaw_change_sine_part_100 * half_yaw_change_sine_polynomial(yaw_change_sine_part_101);
    const float cost_3_part_3 = half_yaw_change_sine_3 * half_yaw_change_sine_3;
    const float cost_3_part_4 = 1.0f - cost_3_part_3;
    const float cost_3_part_5 = yaw_change_sine_part_100 - yaw_change_sine_part_70;
    const float cost_3_part_6 = hall_position_three_limit((yaw_change_sine_test_2) ? (cost_2_part_6 + (((yaw_change_sine_part_72 * cost_2_part_11) + (yaw_change_sine_part_74 * cost_2_part_16) + (yaw_change_sine_part_76 * cost_2_part_21) - (damping * cost_2_part_6) - (yaw_change_sine_part_78 * cost_3_part_5)) * yaw_change_sine_part_83)) : (0.5f * (cost_2_part_6 + cost_3_part)), 0.5f);
    const float cost_3_part_7 = (phase_fraction_sine_part_5 * cost_3_part_3) + (phase_fraction_sine_part_8 * yaw_change_sine_3);
    const float cost_3_part_8 = cost_3_part_6 - cost_3_part_7;
    const float f15_argument_5 = cost_3_part_8 * cost_3_part_8;
    const float f15_5 = f15_polynomial(f15_argument_5);
    const float f16_5 = cost_3_part_8 * f16_polynomial(f15_argument_5);
    const float cost_3_part_9 = (cost_0_part_6 * f15_5) + (yaw_change_sine_part * f16_5);
    const float cost_3_part_9_squared = cost_3_part_9 * cost_3_part_9;
    const float cost_3_part_10 = cost_3_part_9 * (cost_0_part_7 + (cost_3_part_9_squared * (cost_0_part_8 + (cost_3_part_9_squared * cost_0_part_9))));
    const float cost_3_part_11 = (cost_0_part_2 * cost_3_part_4) - (cost_0_part_34 * yaw_change_sine_3) - cost_3_part_10;
    const float cost_3_part_12 = (phase_fraction_sine_part_10 * cost_3_part_3) + (phase_fraction_sine_part_12 * yaw_change_sine_3);
    const float cost_3_part_13 = cost_3_part_6 - cost_3_part_12;
    const float f17_argument_5 = cost_3_part_13 * cost_3_part_13;
    const float f17_5 = f17_polynomial(f17_argument_5);
    const float f18_5 = cost_3_part_13 * f18_polynomial(f17_argument_5);
    const float cost_3_part_14 = (cost_0_part_17 * f17_5) + (yaw_change_sine_part_7 * f18_5);
    const float cost_3_part_14_squared = cost_3_part_14 * cost_3_part_14;
    const float cost_3_part_15 = cost_3_part_14 * (cost_0_part_18 + (cost_3_part_14_squared * (cost_0_part_19 + (cost_3_part_14_squared * cost_0_part_20))));
    const float cost_3_part_16 = (cost_0_part_13 * cost_3_part_4) - (cost_0_part_41 * yaw_change_sine_3) - cost_3_part_15;
    const float cost_3_part_17 = (phase_fraction_sine_part_14 * cost_3_part_3) + (phase_fraction_sine_part_16 * yaw_change_sine_3);
    const float cost_3_part_18 = cost_3_part_6 - cost_3_part_17;
    const float f19_argument_5 = cost_3_part_18 * cost_3_part_18;
    const float f19_5 = f19_polynomial(f19_argument_5);
    const float f20_5 = cost_3_part_18 * f20_polynomial(f19_argument_5);
    const float cost_3_part_19 = (cost_0_part_28 * f19_5) + (yaw_change_sine_part_13 * f20_5);
    const float cost_3_part_19_squared = cost_3_part_19 * cost_3_part_19;
    const float cost_3_part_20 = cost_3_part_19 * (cost_0_part_29 + (cost_3_part_19_squared * (cost_0_part_30 + (cost_3_part_19_squared * cost_0_part_31))));
    const float cost_3_part_21 = (cost_0_part_24 * cost_3_part_4) - (cost_0_part_48 * yaw_change_sine_3) - cost_3_part_20;
    const float cost_3_part_22 = hall_position_three_limit((yaw_change_sine_test_2) ? (cost_2_part_22 + (((yaw_change_sine_part_84 * cost_2_part_27) + (yaw_change_sine_part_86 * cost_2_part_32) + (yaw_change_sine_part_88 * cost_2_part_37) - (damping * cost_2_part_22) - (yaw_change_sine_part_90 * cost_3_part_5)) * yaw_change_sine_part_95)) : (0.5f * (cost_2_part_22 + cost_3_part_2)), 0.5f);
    const float cost_3_part_23 = (phase_fraction_sine_part_5 * yaw_change_sine_3) - (phase_fraction_sine_part_8 * cost_3_part_3);
    const float cost_3_part_24 = cost_3_part_22 + cost_3_part_23;
    const float f15_argument_6 = cost_3_part_24 * cost_3_part_24;
    const float f15_6 = f15_polynomial(f15_argument_6);
    const float f16_6 = cost_3_part_24 * f16_polynomial(f15_argument_6);
    const float cost_3_part_25 = (cost_0_part_38 * f15_6) + (yaw_change_sine_part_24 * f16_6);
    const float cost_3_part_25_squared = cost_3_part_25 * cost_3_part_25;
    const float cost_3_part_26 = cost_3_part_25 * (cost_0_part_7 + (cost_3_part_25_squared * (cost_0_part_8 + (cost_3_part_25_squared * cost_0_part_9))));
    const float cost_3_part_27 = (cost_0_part_34 * cost_3_part_4) + (cost_0_part_2 * yaw_change_sine_3) - cost_3_part_26;
    const float cost_3_part_28 = (phase_fraction_sine_part_10 * yaw_change_sine_3) - (phase_fraction_sine_part_12 * cost_3_part_3);
    const float cost_3_part_29 = cost_3_part_22 + cost_3_part_28;
    const float f17_argument_6 = cost_3_part_29 * cost_3_part_29;
    const float f17_6 = f17_polynomial(f17_argument_6);
    const float f18_6 = cost_3_part_29 * f18_polynomial(f17_argument_6);
    const float cost_3_part_30 = (cost_0_part_45 * f17_6) + (yaw_change_sine_part_27 * f18_6);
    const float cost_3_part_30_squared = cost_3_part_30 * cost_3_part_30;
    const float cost_3_part_31 = cost_3_part_30 * (cost_0_part_18 + (cost_3_part_30_squared * (cost_0_part_19 + (cost_3_part_30_squared * cost_0_part_20))));
    const float cost_3_part_32 = (cost_0_part_41 * cost_3_part_4) + (cost_0_part_13 * yaw_change_sine_3) - cost_3_part_31;
    const float cost_3_part_33 = (phase_fraction_sine_part_14 * yaw_change_sine_3) - (phase_fraction_sine_part_16 * cost_3_part_3);
    const float cost_3_part_34 = cost_3_part_22 + cost_3_part_33;
    const float f19_argument_6 = cost_3_part_34 * cost_3_part_34;
    const float f19_6 = f19_polynomial(f19_argument_6);
    const float f20_6 = cost_3_part_34 * f20_polynomial(f19_argument_6);
    const float cost_3_part_35 = (cost_0_part_52 * f19_6) + (yaw_change_sine_part_30 * f20_6);
    const float cost_3_part_35_squared = cost_3_part_35 * cost_3_part_35;
    const float cost_3_part_36 = cost_3_part_35 * (cost_0_part_29 + (cost_3_part_35_squared * (cost_0_part_30 + (cost_3_part_35_squared * cost_0_part_31))));
    const float cost_3_part_37 = (cost_0_part_48 * cost_3_part_4) + (cost_0_part_24 * yaw_change_sine_3) - cost_3_part_36;
    const float cost_3 = (cost_3_part_11 * cost_3_part_11) + (cost_3_part_16 * cost_3_part_16) + (cost_3_part_21 * cost_3_part_21) + (cost_3_part_27 * cost_3_part_27) + (cost_3_part_32 * cost_3_part_32) + (cost_3_part_37 * cost_3_part_37) + (damping * ((cost_3_part_6 * cost_3_part_6) + (cost_3_part_22 * cost_3_part_22) + (squared_yaw_arm * yaw_change_sine_part_101)));
    const bool yaw_change_sine_test_3 = cost_3 <= ((cost_factor * yaw_change_sine_part_99) + cost_slack);
    const float yaw_change_sine_part_102 = ((yaw_change_sine_part * f15_5) - (cost_0_part_6 * f16_5)) * (yaw_change_sine_part_2 + (cost_3_part_9_squared * (yaw_change_sine_part_3 + (cost_3_part_9_squared * yaw_change_sine_part_4))));
    const float yaw_change_sine_part_103 = cost_3_part_26 - (yaw_change_sine_part_102 * (phase_fraction_sine_part_8 + cost_3_part_23));
    const float yaw_change_sine_part_104 = ((yaw_change_sine_part_7 * f17_5) - (cost_0_part_17 * f18_5)) * (yaw_change_sine_part_8 + (cost_3_part_14_squared * (yaw_change_sine_part_9 + (cost_3_part_14_squared * yaw_change_sine_part_10))));
    const float yaw_change_sine_part_105 = cost_3_part_31 - (yaw_change_sine_part_104 * (phase_fraction_sine_part_12 + cost_3_part_28));
    const float yaw_change_sine_part_106 = ((yaw_change_sine_part_13 * f19_5) - (cost_0_part_28 * f20_5)) * (yaw_change_sine_part_14 + (cost_3_part_19_squared * (yaw_change_sine_part_15 + (cost_3_part_19_squared * yaw_change_sine_part_16))));
    const float yaw_change_sine_part_107 = cost_3_part_36 - (yaw_change_sine_part_106 * (phase_fraction_sine_part_16 + cost_3_part_33));
    const float yaw_change_sine_part_108 = (yaw_change_sine_part_102 * yaw_change_sine_part_103) + (yaw_change_sine_part_104 * yaw_change_sine_part_105) + (yaw_change_sine_part_106 * yaw_change_sine_part_107);
    const float yaw_change_sine_part_109 = (yaw_change_sine_part_102 * yaw_change_sine_part_105) - (yaw_change_sine_part_104 * yaw_change_sine_part_103);
    const float yaw_change_sine_part_110 = (yaw_change_sine_part_102 * yaw_change_sine_part_107) - (yaw_change_sine_part_106 * yaw_change_sine_part_103);
    const float yaw_change_sine_part_111 = (damping * ((yaw_change_sine_part_103 * cost_3_part_11) + (yaw_change_sine_part_105 * cost_3_part_16) + (yaw_change_sine_part_107 * cost_3_part_21) + (cost_3_part_6 * yaw_change_sine_part_108))) + (yaw_change_sine_part_109 * ((yaw_change_sine_part_102 * cost_3_part_16) - (yaw_change_sine_part_104 * cost_3_part_11))) + (yaw_change_sine_part_110 * ((yaw_change_sine_part_102 * cost_3_part_21) - (yaw_change_sine_part_106 * cost_3_part_11)));
    const float yaw_change_sine_part_112 = (yaw_change_sine_part_104 * yaw_change_sine_part_107) - (yaw_change_sine_part_106 * yaw_change_sine_part_105);
    const float yaw_change_sine_part_113 = 1.0f / (damping + ((yaw_change_sine_part_102 * yaw_change_sine_part_102) + (yaw_change_sine_part_104 * yaw_change_sine_part_104) + (yaw_change_sine_part_106 * yaw_change_sine_part_106)));
    const float yaw_change_sine_part_114 = ((yaw_change_sine_part_24 * f15_6) - (cost_0_part_38 * f16_6)) * (yaw_change_sine_part_2 + (cost_3_part_25_squared * (yaw_change_sine_part_3 + (cost_3_part_25_squared * yaw_change_sine_part_4))));
    const float yaw_change_sine_part_115 = (yaw_change_sine_part_114 * (phase_fraction_sine_part_5 - cost_3_part_7)) - cost_3_part_10;
    const float yaw_change_sine_part_116 = ((yaw_change_sine_part_27 * f17_6) - (cost_0_part_45 * f18_6)) * (yaw_change_sine_part_8 + (cost_3_part_30_squared * (yaw_change_sine_part_9 + (cost_3_part_30_squared * yaw_change_sine_part_10))));
    const float yaw_change_sine_part_117 = (yaw_change_sine_part_116 * (phase_fraction_sine_part_10 - cost_3_part_12)) - cost_3_part_15;
    const float yaw_change_sine_part_118 = ((yaw_change_sine_part_30 * f19_6) - (cost_0_part_52 * f20_6)) * (yaw_change_sine_part_14 + (cost_3_part_35_squared * (yaw_change_sine_part_15 + (cost_3_part_35_squared * yaw_change_sine_part_16))));
    const float yaw_change_sine_part_119 = (yaw_change_sine_part_118 * (phase_fraction_sine_part_14 - cost_3_part_17)) - cost_3_part_20;
    const float yaw_change_sine_part_120 = (yaw_change_sine_part_114 * yaw_change_sine_part_115) + (yaw_change_sine_part_116 * yaw_change_sine_part_117) + (yaw_change_sine_part_118 * yaw_change_sine_part_119);
    const float yaw_change_sine_part_121 = (yaw_change_sine_part_114 * yaw_change_sine_part_117) - (yaw_change_sine_part_116 * yaw_change_sine_part_115);
    const float yaw_change_sine_part_122 = (yaw_change_sine_part_114 * yaw_change_sine_part_119) - (yaw_change_sine_part_118 * yaw_change_sine_part_115);
    const float yaw_change_sine_part_123 = (damping * ((yaw_change_sine_part_115 * cost_3_part_27) + (yaw_change_sine_part_117 * cost_3_part_32) + (yaw_change_sine_part_119 * cost_3_part_37) + (cost_3_part_22 * yaw_change_sine_part_120))) + (yaw_change_sine_part_121 * ((yaw_change_sine_part_114 * cost_3_part_32) - (yaw_change_sine_part_116 * cost_3_part_27))) + (yaw_change_sine_part_122 * ((yaw_change_sine_part_114 * cost_3_part_37) - (yaw_change_sine_part_118 * cost_3_part_27)));
    const float yaw_change_sine_part_124 = (yaw_change_sine_part_116 * yaw_change_sine_part_119) - (yaw_change_sine_part_118 * yaw_change_sine_part_117);
    const float yaw_change_sine_part_125 = 1.0f / (damping + ((yaw_change_sine_part_114 * yaw_change_sine_part_114) + (yaw_change_sine_part_116 * yaw_change_sine_part_116) + (yaw_change_sine_part_118 * yaw_change_sine_part_118)));
    const float yaw_change_sine_part_126 = ((yaw_change_sine_part_111 + (yaw_change_sine_part_112 * ((yaw_change_sine_part_104 * cost_3_part_21) - (yaw_change_sine_part_106 * cost_3_part_16)))) * yaw_change_sine_part_113) + ((yaw_change_sine_part_123 + (yaw_change_sine_part_124 * ((yaw_change_sine_part_116 * cost_3_part_37) - (yaw_change_sine_part_118 * cost_3_part_32)))) * yaw_change_sine_part_125) - (yaw_damping * yaw_change_sine_part_100);
    const float yaw_change_sine_part_127 = (((damping * ((yaw_change_sine_part_103 * yaw_change_sine_part_103) + (yaw_change_sine_part_105 * yaw_change_sine_part_105) + (yaw_change_sine_part_107 * yaw_change_sine_part_107))) + (yaw_change_sine_part_109 * yaw_change_sine_part_109) + (yaw_change_sine_part_110 * yaw_change_sine_part_110) + (yaw_change_sine_part_112 * yaw_change_sine_part_112)) * yaw_change_sine_part_113) + (((damping * ((yaw_change_sine_part_115 * yaw_change_sine_part_115) + (yaw_change_sine_part_117 * yaw_change_sine_part_117) + (yaw_change_sine_part_119 * yaw_change_sine_part_119))) + (yaw_change_sine_part_121 * yaw_change_sine_part_121) + (yaw_change_sine_part_122 * yaw_change_sine_part_122) + (yaw_change_sine_part_124 * yaw_change_sine_part_124)) * yaw_change_sine_part_125);
    float yaw_change_sine_part_128 = yaw_change_sine_part_100;
    float cost_4_part = cost_3_part_6;
    float cost_4_part_2 = cost_3_part_22;
    float converged_part = cost_3;
    if (!yaw_change_sine_test_3) {
        yaw_change_sine_part_128 = yaw_change_sine_part_98;
        cost_4_part = cost_3_part;
        cost_4_part_2 = cost_3_part_2;
        converged_part = yaw_change_sine_part_99;
    }
    const float yaw_change_sine_part_129 = hall_position_three_limit((yaw_change_sine_test_3) ? (yaw_change_sine_part_100 + (yaw_change_sine_part_126 / (yaw_damping + yaw_change_sine_part_127))) : (0.5f * (yaw_change_sine_part_100 + yaw_change_sine_part_128)), max_yaw_step);
    const float yaw_change_sine_part_130 = yaw_change_sine_part_129 * yaw_change_sine_part_129;
    const float yaw_change_sine_4 = yaw_change_sine_part_129 * yaw_change_sine_polynomial(yaw_change_sine_part_130);
    const float half_yaw_change_sine_4 = yaw_change_sine_part_129 * half_yaw_change_sine_polynomial(yaw_change_sine_part_130);
    const float cost_4_part_3 = half_yaw_change_sine_4 * half_yaw_change_sine_4;
    const float cost_4_part_4 = 1.0f - cost_4_part_3;
    const float cost_4_part_5 = yaw_change_sine_part_129 - yaw_change_sine_part_100;
    const float cost_4_part_6 = hall_position_three_limit((yaw_change_sine_test_3) ? (cost_3_part_6 + (((yaw_change_sine_part_102 * cost_3_part_11) + (yaw_change_sine_part_104 * cost_3_part_16) + (yaw_change_sine_part_106 * cost_3_part_21) - (damping * cost_3_part_6) - (yaw_change_sine_part_108 * cost_4_part_5)) * yaw_change_sine_part_113)) : (0.5f * (cost_3_part_6 + cost_4_part)), 0.5f);
    const float cost_4_part_7 = (phase_fraction_sine_part_5 * cost_4_part_3) + (phase_fraction_sine_part_8 * yaw_change_sine_4);
    const float cost_4_part_8 = cost_4_part_6 - cost_4_part_7;
    const float f15_argument_7 = cost_4_part_8 * cost_4_part_8;
    const float f15_7 = f15_polynomial(f15_argument_7);
    const float f16_7 = cost_4_part_8 * f16_polynomial(f15_argument_7);
    const float cost_4_part_9 = (cost_0_part_6 * f15_7) + (yaw_change_sine_part * f16_7);
    const float cost_4_part_9_squared = cost_4_part_9 * cost_4_part_9;
    const float cost_4_part_10 = cost_4_part_9 * (cost_0_part_7 + (cost_4_part_9_squared * (cost_0_part_8 + (cost_4_part_9_squared * cost_0_part_9))));
    const float cost_4_part_11 = (cost_0_part_2 * cost_4_part_4) - (cost_0_part_34 * yaw_change_sine_4) - cost_4_part_10;
    const float cost_4_part_12 = (phase_fraction_sine_part_10 * cost_4_part_3) + (phase_fraction_sine_part_12 * yaw_change_sine_4);
    const float cost_4_part_13 = cost_4_part_6 - cost_4_part_12;
    const float f17_argument_7 = cost_4_part_13 * cost_4_part_13;
    const float f17_7 = f17_polynomial(f17_argument_7);
    const float f18_7 = cost_4_part_13 * f18_polynomial(f17_argument_7);
    const float cost_4_part_14 = (cost_0_part_17 * f17_7) + (yaw_change_sine_part_7 * f18_7);
    const float cost_4_part_14_squared = cost_4_part_14 * cost_4_part_14;
    const float cost_4_part_15 = cost_4_part_14 * (cost_0_part_18 + (cost_4_part_14_squared * (cost_0_part_19 + (cost_4_part_14_squared * cost_0_part_20))));
    const float cost_4_part_16 = (cost_0_part_13 * cost_4_part_4) - (cost_0_part_41 * yaw_change_sine_4) - cost_4_part_15;
    const float cost_4_part_17 = (phase_fraction_sine_part_14 * cost_4_part_3) + (phase_fraction_sine_part_16 * yaw_change_sine_4);
    const float cost_4_part_18 = cost_4_part_6 - cost_4_part_17;
    const float f19_argument_7 = cost_4_part_18 * cost_4_part_18;
    const float f19_7 = f19_polynomial(f19_argument_7);
    const float f20_7 = cost_4_part_18 * f20_polynomial(f19_argument_7);
    const float cost_4_part_19 = (cost_0_part_28 * f19_7) + (yaw_change_sine_part_13 * f20_7);
    const float cost_4_part_19_squared = cost_4_part_19 * cost_4_part_19;
    const float cost_4_part_20 = cost_4_part_19 * (cost_0_part_29 + (cost_4_part_19_squared * (cost_0_part_30 + (cost_4_part_19_squared * cost_0_part_31))));
    const float cost_4_part_21 = (cost_0_part_24 * cost_4_part_4) - (cost_0_part_48 * yaw_change_sine_4) - cost_4_part_20;
    const float cost_4_part_22 = hall_position_three_limit((yaw_change_sine_test_3) ? (cost_3_part_22 + (((yaw_change_sine_part_114 * cost_3_part_27) + (yaw_change_sine_part_116 * cost_3_part_32) + (yaw_change_sine_part_118 * cost_3_part_37) - (damping * cost_3_part_22) - (yaw_change_sine_part_120 * cost_4_part_5)) * yaw_change_sine_part_125)) : (0.5f * (cost_3_part_22 + cost_4_part_2)), 0.5f);
    const float cost_4_part_23 = (phase_fraction_sine_part_5 * yaw_change_sine_4) - (phase_fraction_sine_part_8 * cost_4_part_3);
    const float cost_4_part_24 = cost_4_part_22 + cost_4_part_23;
    const float f15_argument_8 = cost_4_part_24 * cost_4_part_24;
    const float f15_8 = f15_polynomial(f15_argument_8);
    const float f16_8 = cost_4_part_24 * f16_polynomial(f15_argument_8);
    const float cost_4_part_25 = (cost_0_part_38 * f15_8) + (yaw_change_sine_part_24 * f16_8);
    const float cost_4_part_25_squared = cost_4_part_25 * cost_4_part_25;
    const float cost_4_part_26 = cost_4_part_25 * (cost_0_part_7 + (cost_4_part_25_squared * (cost_0_part_8 + (cost_4_part_25_squared * cost_0_part_9))));
    const float cost_4_part_27 = (cost_0_part_34 * cost_4_part_4) + (cost_0_part_2 * yaw_change_sine_4) - cost_4_part_26;
    const float cost_4_part_28 = (phase_fraction_sine_part_10 * yaw_change_sine_4) - (phase_fraction_sine_part_12 * cost_4_part_3);
    const float cost_4_part_29 = cost_4_part_22 + cost_4_part_28;
    const float f17_argument_8 = cost_4_part_29 * cost_4_part_29;
    const float f17_8 = f17_polynomial(f17_argument_8);
    const float f18_8 = cost_4_part_29 * f18_polynomial(f17_argument_8);
    const float cost_4_part_30 = (cost_0_part_45 * f17_8) + (yaw_change_sine_part_27 * f18_8);
    const float cost_4_part_30_squared = cost_4_part_30 * cost_4_part_30;
    const float cost_4_part_31 = cost_4_part_30 * (cost_0_part_18 + (cost_4_part_30_squared * (cost_0_part_19 + (cost_4_part_30_squared * cost_0_part_20))));
    const float cost_4_part_32 = (cost_0_part_41 * cost_4_part_4) + (cost_0_part_13 * yaw_change_sine_4) - cost_4_part_31;
    const float cost_4_part_33 = (phase_fraction_sine_part_14 * yaw_change_sine_4) - (phase_fraction_sine_part_16 * cost_4_part_3);
    const float cost_4_part_34 = cost_4_part_22 + cost_4_part_33;
    const float f19_argument_8 = cost_4_part_34 * cost_4_part_34;
    const float f19_8 = f19_polynomial(f19_argument_8);
    const float f20_8 = cost_4_part_34 * f20_polynomial(f19_argument_8);
    const float cost_4_part_35 = (cost_0_part_52 * f19_8) + (yaw_change_sine_part_30 * f20_8);
    const float cost_4_part_35_squared = cost_4_part_35 * cost_4_part_35;
    const float cost_4_part_36 = cost_4_part_35 * (cost_0_part_29 + (cost_4_part_35_squared * (cost_0_part_30 + (cost_4_part_35_squared * cost_0_part_31))));
    const float cost_4_part_37 = (cost_0_part_48 * cost_4_part_4) + (cost_0_part_24 * yaw_change_sine_4) - cost_4_part_36;
    const float cost_4_part_38 = (cost_4_part_11 * cost_4_part_11) + (cost_4_part_16 * cost_4_part_16) + (cost_4_part_21 * cost_4_part_21) + (cost_4_part_27 * cost_4_part_27) + (cost_4_part_32 * cost_4_part_32) + (cost_4_part_37 * cost_4_part_37);
    const float cost_4_part_39 = (cost_4_part_6 * cost_4_part_6) + (cost_4_part_22 * cost_4_part_22);
    const float cost_4 = cost_4_part_38 + (damping * (cost_4_part_39 + (squared_yaw_arm * yaw_change_sine_part_130)));
    const float yaw_change_sine_part_131 = (cost_0_test || cost_0_test_2 || cost_0_test_3) ? 1.0f : 3.0f;
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const uint32_t estimator_residual_faults = state->estimator_residual_faults;
    const float yaw_change_sine_part_132 = innovation_gate + (innovation_gate * (float)estimator_residual_faults);
    const bool yaw_change_sine_test_4 = (yaw_change_sine_part_132 * yaw_change_sine_part_132) < (cost_4_part_39 + (squared_radius * yaw_change_sine_part_130));
    const bool converged_test = cost_4 <= ((cost_factor * converged_part) + cost_slack);
    const float converged_part_2 = ((yaw_change_sine_part * f15_7) - (cost_0_part_6 * f16_7)) * (yaw_change_sine_part_2 + (cost_4_part_9_squared * (yaw_change_sine_part_3 + (cost_4_part_9_squared * yaw_change_sine_part_4))));
    const float converged_part_3 = cost_4_part_26 - (converged_part_2 * (phase_fraction_sine_part_8 + cost_4_part_23));
    const float converged_part_4 = ((yaw_change_sine_part_7 * f17_7) - (cost_0_part_17 * f18_7)) * (yaw_change_sine_part_8 + (cost_4_part_14_squared * (yaw_change_sine_part_9 + (cost_4_part_14_squared * yaw_change_sine_part_10))));
    const float converged_part_5 = cost_4_part_31 - (converged_part_4 * (phase_fraction_sine_part_12 + cost_4_part_28));
    const float converged_part_6 = ((yaw_change_sine_part_13 * f19_7) - (cost_0_part_28 * f20_7)) * (yaw_change_sine_part_14 + (cost_4_part_19_squared * (yaw_change_sine_part_15 + (cost_4_part_19_squared * yaw_change_sine_part_16))));
    const float converged_part_7 = cost_4_part_36 - (converged_part_6 * (phase_fraction_sine_part_16 + cost_4_part_33));
    const float converged_part_8 = (converged_part_2 * converged_part_3) + (converged_part_4 * converged_part_5) + (converged_part_6 * converged_part_7);
    const float converged_part_9 = (converged_part_2 * converged_part_5) - (converged_part_4 * converged_part_3);
    const float converged_part_10 = (converged_part_2 * converged_part_7) - (converged_part_6 * converged_part_3);
    const float converged_part_11 = (damping * ((converged_part_3 * cost_4_part_11) + (converged_part_5 * cost_4_part_16) + (converged_part_7 * cost_4_part_21) + (cost_4_part_6 * converged_part_8))) + (converged_part_9 * ((converged_part_2 * cost_4_part_16) - (converged_part_4 * cost_4_part_11))) + (converged_part_10 * ((converged_part_2 * cost_4_part_21) - (converged_part_6 * cost_4_part_11)));
    const float converged_part_12 = (converged_part_4 * converged_part_7) - (converged_part_6 * converged_part_5);
    const float converged_part_13 = 1.0f / (damping + ((converged_part_2 * converged_part_2) + (converged_part_4 * converged_part_4) + (converged_part_6 * converged_part_6)));
    const float converged_part_14 = ((yaw_change_sine_part_24 * f15_8) - (cost_0_part_38 * f16_8)) * (yaw_change_sine_part_2 + (cost_4_part_25_squared * (yaw_change_sine_part_3 + (cost_4_part_25_squared * yaw_change_sine_part_4))));
    const float converged_part_15 = (converged_part_14 * (phase_fraction_sine_part_5 - cost_4_part_7)) - cost_4_part_10;
    const float converged_part_16 = ((yaw_change_sine_part_27 * f17_8) - (cost_0_part_45 * f18_8)) * (yaw_change_sine_part_8 + (cost_4_part_30_squared * (yaw_change_sine_part_9 + (cost_4_part_30_squared * yaw_change_sine_part_10))));
    const float converged_part_17 = (converged_part_16 * (phase_fraction_sine_part_10 - cost_4_part_12)) - cost_4_part_15;
    const float converged_part_18 = ((yaw_change_sine_part_30 * f19_8) - (cost_0_part_52 * f20_8)) * (yaw_change_sine_part_14 + (cost_4_part_35_squared * (yaw_change_sine_part_15 + (cost_4_part_35_squared * yaw_change_sine_part_16))));
    const float converged_part_19 = (converged_part_18 * (phase_fraction_sine_part_14 - cost_4_part_17)) - cost_4_part_20;
    const float converged_part_20 = (converged_part_14 * converged_part_15) + (converged_part_16 * converged_part_17) + (converged_part_18 * converged_part_19);
    const float converged_part_21 = (converged_part_14 * converged_part_17) - (converged_part_16 * converged_part_15);
    const float converged_part_22 = (converged_part_14 * converged_part_19) - (converged_part_18 * converged_part_15);
    const float converged_part_23 = (damping * ((converged_part_15 * cost_4_part_27) + (converged_part_17 * cost_4_part_32) + (converged_part_19 * cost_4_part_37) + (cost_4_part_22 * converged_part_20))) + (converged_part_21 * ((converged_part_14 * cost_4_part_32) - (converged_part_16 * cost_4_part_27))) + (converged_part_22 * ((converged_part_14 * cost_4_part_37) - (converged_part_18 * cost_4_part_27)));
    const float converged_part_24 = (converged_part_16 * converged_part_19) - (converged_part_18 * converged_part_17);
    const float converged_part_25 = 1.0f / (damping + ((converged_part_14 * converged_part_14) + (converged_part_16 * converged_part_16) + (converged_part_18 * converged_part_18)));
    const float converged_part_26 = ((converged_part_11 + (converged_part_12 * ((converged_part_4 * cost_4_part_21) - (converged_part_6 * cost_4_part_16)))) * converged_part_13) + ((converged_part_23 + (converged_part_24 * ((converged_part_16 * cost_4_part_37) - (converged_part_18 * cost_4_part_32)))) * converged_part_25) - (yaw_damping * yaw_change_sine_part_129);
    const float converged_part_27 = (((damping * ((converged_part_3 * converged_part_3) + (converged_part_5 * converged_part_5) + (converged_part_7 * converged_part_7))) + (converged_part_9 * converged_part_9) + (converged_part_10 * converged_part_10) + (converged_part_12 * converged_part_12)) * converged_part_13) + (((damping * ((converged_part_15 * converged_part_15) + (converged_part_17 * converged_part_17) + (converged_part_19 * converged_part_19))) + (converged_part_21 * converged_part_21) + (converged_part_22 * converged_part_22) + (converged_part_24 * converged_part_24)) * converged_part_25);
    const float converged_part_28 = 1.0f / (yaw_damping + converged_part_27);
    const float converged_part_29 = (converged_part_2 * cost_4_part_11) + (converged_part_4 * cost_4_part_16) + (converged_part_6 * cost_4_part_21) - (damping * cost_4_part_6);
    const float converged_part_30 = (converged_part_14 * cost_4_part_27) + (converged_part_16 * cost_4_part_32) + (converged_part_18 * cost_4_part_37) - (damping * cost_4_part_22);
    const bool converged = converged_test && (((converged_part_26 * converged_part_26 * converged_part_28) + (converged_part_29 * converged_part_29 * converged_part_13) + (converged_part_30 * converged_part_30 * converged_part_25)) <= cost_slack);
    float yaw_change_sine_part_133;
    float X_part;
    float Y_part;
    if (converged) {
        const float yaw_change_sine_part_134 = hall_position_three_limit(yaw_change_sine_part_129 + (converged_part_26 * converged_part_28), max_yaw_step);
        yaw_change_sine_part_133 = yaw_change_sine_part_134;
        const float X_part_2 = yaw_change_sine_part_134 - yaw_change_sine_part_129;
        X_part = hall_position_three_limit(cost_4_part_6 + ((converged_part_29 - (converged_part_8 * X_part_2)) * converged_part_13), 0.5f);
        Y_part = hall_position_three_limit(cost_4_part_22 + ((converged_part_30 - (converged_part_20 * X_part_2)) * converged_part_25), 0.5f);
    } else {
        if (converged_test) {
            yaw_change_sine_part_133 = yaw_change_sine_part_129;
            X_part = cost_4_part_6;
            Y_part = cost_4_part_22;
        } else {
            yaw_change_sine_part_133 = yaw_change_sine_part_128;
            X_part = cost_4_part;
            Y_part = cost_4_part_2;
        }
    }
    const float estimator_yaw_last_good = state->estimator_yaw_last_good;
    const uint32_t estimator_searching = state->estimator_searching;
    bool yaw_change_sine_test_5 = yaw_change_sine_test_4;
    if (!(estimator_ambiguity_resolved != 0u)) {
        yaw_change_sine_test_5 = (estimator_searching != 0u) && !(fabsf(yaw_fraction_sine_part + yaw_change_sine_part_133 - estimator_yaw_last_good) <= yaw_window);
    }
    const bool yaw_change_sine_test_6 = ((squared_residual_limit * yaw_change_sine_part_131) < cost_4_part_38) || yaw_change_sine_test_5;
    const bool yaw_change_sine_test_7 = !(estimator_searching != 0u);
    float yaw_change_sine_part_135 = 0.0f;
    float X_part_3 = 0.0f;
    float Y_part_2 = 0.0f;
    float estimator_motion_x_part = 0.0f;
    float estimator_motion_y_part = 0.0f;
    float estimator_motion_yaw_part = 0.0f;
    if (!(yaw_change_sine_test_6 && yaw_change_sine_test_7)) {
        yaw_change_sine_part_135 = yaw_change_sine_part_133;
        X_part_3 = X_part;
        Y_part_2 = Y_part;
        estimator_motion_x_part = 0.5f * X_part;
        estimator_motion_y_part = 0.5f * Y_part;
        estimator_motion_yaw_part = yaw_gain * yaw_change_sine_part_133;
    }
    const float yaw_change_sine_argument = yaw_change_sine_part_135 * yaw_change_sine_part_135;
    const float yaw_change_sine_5 = yaw_change_sine_part_135 * yaw_change_sine_polynomial(yaw_change_sine_argument);
    const float half_yaw_change_sine_5 = yaw_change_sine_part_135 * half_yaw_change_sine_polynomial(yaw_change_sine_argument);
    const float X_part_4 = phase_fraction_sine_part + X_part_3;
    float X_part_5 = X_part_4;
    bool X_part_6 = true;
    if (pi < X_part_4) {
        X_part_5 = X_part_4 - two_pi;
    } else {
        X_part_6 = false;
    }
    float X_part_7 = X_part_5;
    float X_part_8 = -1.0f;
    if (X_part_5 < -pi) {
        X_part_7 = X_part_5 + two_pi;
    } else {
        X_part_8 = X_part_6 ? 1.0f : 0.0f;
    }
    const float pitch_x_plus_X_part_8 = state->estimator_pitch_x + X_part_8;
    const float X_part_9 = 1.0f - (half_yaw_change_sine_5 * half_yaw_change_sine_5);
    const float X_part_10 = (phase_fraction_sine_part_3 * X_part_9) - (phase_fraction_sine_part_4 * yaw_change_sine_5);
    const float X_part_11 = (phase_fraction_sine_part_4 * X_part_9) + (phase_fraction_sine_part_3 * yaw_change_sine_5);
    const float X_part_12 = (centre_x * X_part_10) + (-centre_y * X_part_11);
    const float X = (metre_per_rad * X_part_7) + (pitch * pitch_x_plus_X_part_8) - X_part_12;
    const float Y_part_3 = phase_fraction_sine_part_7 + Y_part_2;
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
    const float Y_part_8 = (centre_x * X_part_11) - (-centre_y * X_part_10);
    const float Y = (metre_per_rad * Y_part_6) + (pitch * pitch_y_plus_Y_part_7) - Y_part_8;
    const float yaw_part = yaw_fraction_sine_part + yaw_change_sine_part_135;
    float yaw_part_2 = yaw_part;
    if (pi < yaw_part) {
        yaw_part_2 = yaw_part - two_pi;
    }
    float yaw = yaw_part_2;
    if (yaw_part_2 < -pi) {
        yaw = yaw_part_2 + two_pi;
    }
    const float deviation_X_part = converged_part_8 * converged_part_13;
    const float deviation_X_part_2 = deviation_X_part - (wave_number * Y_part_8);
    const float deviation_X_part_3 = 1.0f / (converged_part_27 + undamped_yaw);
    const float deviation_X = deviation_over_w * sqrtf(converged_part_13 + (deviation_X_part_2 * deviation_X_part_2 * deviation_X_part_3));
    const float deviation_Y_part = converged_part_20 * converged_part_25;
    const float deviation_Y_part_2 = deviation_Y_part + (wave_number * X_part_12);
    const float deviation_Y = deviation_over_w * sqrtf(converged_part_25 + (deviation_Y_part_2 * deviation_Y_part_2 * deviation_X_part_3));
    const float deviation_yaw = deviation * sqrtf(deviation_X_part_3);
    const float residual = sqrtf(least_square + (cost_4_part_38 / yaw_change_sine_part_131));
    const float damped_part = ((squared_radius + (deviation_X_part * deviation_X_part) + (deviation_Y_part * deviation_Y_part)) * deviation_X_part_3) + (converged_part_13 + converged_part_25);
    const bool damped = damped_weight < damped_part;
    const bool valid_test = converged && !(damped || yaw_change_sine_test_6 || yaw_change_sine_test_4);
    const bool valid_test_2 = (fabsf(pitch_x_plus_X_part_8) <= 8.0f) && (fabsf(pitch_y_plus_Y_part_7) <= 8.0f);
    const float yaw_size = fabsf(yaw);
    const bool valid_test_3 = valid_test_2 && (yaw_size <= yaw_limit);
    const bool valid_test_4 = (valid_test && (((cost_0_test ? 1.0f : 0.0f) + (cost_0_test_2 ? 1.0f : 0.0f) + (cost_0_test_3 ? 1.0f : 0.0f)) < 1.0f) && (damped_part <= unambiguous_weight) && yaw_change_sine_test_7 && valid_test_3) || ((estimator_ambiguity_resolved != 0u) && !damped);
    const uint32_t estimator_lock_lost = state->estimator_lock_lost;
    const bool valid = valid_test && valid_test_4 && !(estimator_lock_lost != 0u) && valid_test_3;
    out->lock_lost = (float)estimator_lock_lost;
    const bool estimator_phase_x_test = 4u <= estimator_residual_faults;
    const bool estimator_phase_x_test_2 = yaw_change_sine_test_6 && estimator_phase_x_test;
    const bool estimator_yaw_last_good_test = !yaw_change_sine_test_6;
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
        state->estimator_excluded_sensor = 0u;
    } else {
        state->estimator_phase_x = X_part_7;
        state->estimator_phase_y = Y_part_6;
        state->estimator_yaw = yaw;
        if (converged && estimator_yaw_last_good_test) {
            state->estimator_searching = 0u;
        }
        state->estimator_ambiguity_resolved = hall_position_three_flag(valid_test_4);
        const float estimator_excluded_sensor_part = cost_0_part_22_squared + cost_0_part_47_squared;
        const float estimator_excluded_sensor_part_2 = cost_0_part_11_squared + cost_0_part_40_squared;
        const float estimator_excluded_sensor_part_3 = cost_0_part_33_squared + cost_0_part_54_squared;
        const float estimator_excluded_sensor_part_4 = hall_position_three_max(estimator_excluded_sensor_part, estimator_excluded_sensor_part_2);
        const float estimator_excluded_sensor_part_5 = hall_position_three_min(estimator_excluded_sensor_part, estimator_excluded_sensor_part_2) + hall_position_three_min(estimator_excluded_sensor_part_3, estimator_excluded_sensor_part_4);
        if (yaw_change_sine_test_6 && ((squared_inconsistent * yaw_change_sine_part_131) < cost_4_part_38) && (estimator_ambiguity_resolved != 0u) && (1u <= estimator_residual_faults) && (estimator_excluded_sensor_part_5 <= others_agree) && ((contrast * estimator_excluded_sensor_part_5) <= hall_position_three_max(estimator_excluded_sensor_part_3, estimator_excluded_sensor_part_4))) {
            state->estimator_excluded_sensor = (uint32_t)((estimator_excluded_sensor_part_4 < estimator_excluded_sensor_part_3) ? 3.0f : ((estimator_excluded_sensor_part_2 < estimator_excluded_sensor_part) ? 2.0f : 1.0f));
        }
    }
    if (valid_test_4 && estimator_yaw_last_good_test) {
        state->estimator_yaw_last_good = yaw;
    }
    state->estimator_pitch_x = hall_position_three_limit(pitch_x_plus_X_part_8, 8.0f);
    state->estimator_pitch_y = hall_position_three_limit(pitch_y_plus_Y_part_7, 8.0f);
    float estimator_motion_x_part_2 = 0.0f;
    float estimator_motion_y_part_2 = 0.0f;
    float estimator_motion_yaw_part_2 = 0.0f;
    if (!(estimator_searching != 0u)) {
        estimator_motion_x_part_2 = estimator_motion_x + estimator_motion_x_part;
        estimator_motion_y_part_2 = estimator_motion_y + estimator_motion_y_part;
        estimator_motion_yaw_part_2 = estimator_motion_yaw + estimator_motion_yaw_part;
    }
    state->estimator_motion_x = hall_position_three_limit(estimator_motion_x_part_2, 0.5f);
    state->estimator_motion_y = hall_position_three_limit(estimator_motion_y_part_2, 0.5f);
    state->estimator_motion_yaw = hall_position_three_limit(estimator_motion_yaw_part_2, max_yaw_step);
    state->estimator_residual_faults = (yaw_change_sine_test_6) ? ((estimator_phase_x_test) ? 0u : (estimator_residual_faults + 1u)) : 0u;
    const uint32_t estimator_acquired = state->estimator_acquired;
    state->estimator_acquired = hall_position_three_flag(valid_test_4 || (estimator_acquired != 0u));
    state->estimator_lock_lost = hall_position_three_flag((estimator_lock_lost != 0u) || ((estimator_acquired != 0u) && (estimator_phase_x_test_2 || !valid_test_2 || (((valid_test_4) ? yaw_limit : ambiguous_yaw_limit) < yaw_size))));
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
