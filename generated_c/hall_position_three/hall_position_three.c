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
/* f5_polynomial / x; x = (estimator_phase_y + estimator_motion_y) + ((1.5833627 * (1 - (0.5 * (clamp((...), -2, 2) *
 * clamp((...), -2, 2))))) - (1.5812683 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.80622435 .. 6.80622387, t = x^2; relative error at most 1.2e-07. */
static inline float f3_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552044f + (t * (2.5426283e-07f + (t * -9.2772345e-11f)))));
}

/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((-1.5812683 * (1 - (0.5 * (clamp((...), -2, 2)
 * * clamp((...), -2, 2))))) - (1.5833627 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.80622387 .. 6.80622435, t = x^2; relative error at most 1.7e-07. */
/* phase_fraction_cosine; x = (estimator_phase_y + estimator_motion_y) + ((1.5833627 * (1 - (0.5 * (clamp((...), -2, 2)
 * * clamp((...), -2, 2))))) - (1.5812683 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -6.80622435 .. 6.80622387, t = x^2; relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124604f + (t * (1.01684145e-05f + (t * -5.1597757e-09f)))));
}

/* f7_polynomial / x; x = (estimator_phase_x + estimator_motion_x) + ((-0.0858701992 * (1 - (0.5 * ((...) * (...))))) -
 * (0.081681409 * clamp((clamp((...), -2, 2) * (1 - (...))), -1, 1))) in -3.80914426 .. 3.8091445, t = x^2; relative
 * error at most 1.7e-07. */
/* f9_polynomial / x; x = (estimator_phase_y + estimator_motion_y) + ((0.081681409 * (1 - (0.5 * (clamp((...), -2, 2) *
 * clamp((...), -2, 2))))) - (0.0858701992 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -3.8091445 .. 3.80914426, t = x^2; relative error at most 1.7e-07. */
static inline float f7_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551005f + (t * 2.5227982e-07f)));
}

/* phase_fraction_cosine; x = (estimator_phase_x + estimator_motion_x) + ((-0.0858701992 * (1 - (0.5 * ((...) *
 * (...))))) - (0.081681409 * clamp((clamp((...), -2, 2) * (1 - (...))), -1, 1))) in -3.80914426 .. 3.8091445, t = x^2;
 * relative error at most 6e-08. */
/* phase_fraction_cosine; x = (estimator_phase_y + estimator_motion_y) + ((0.081681409 * (1 - (0.5 * (clamp((...), -2,
 * 2) * clamp((...), -2, 2))))) - (0.0858701992 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in
 * -3.8091445 .. 3.80914426, t = x^2; relative error at most 6e-08. */
static inline float phase_fraction_cosine_3_polynomial(float t)
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

typedef struct {
    float value;
    float value_2;
    float across;
    float value_3;
    float terms;
} hall_position_three_terms_t;

/* terms: 10 calls in the step */
HALL_POSITION_THREE_INLINE hall_position_three_terms_t hall_position_three_terms(float terms_1, float terms_2,
    float by_axis_3_h, float by_axis_1_g, float by_axis_2_h, float by_axis_2_g, float by_axis_1_h, float by_axis_3_g)
{
    static const float damping = 0.00992376f;                   /* V^2; 0.001 alpha^2: weight of the prior */

    const float value_part = (by_axis_1_g * by_axis_2_h) - (by_axis_2_g * by_axis_1_h);
    const float value_2_part = (by_axis_1_g * by_axis_3_h) - (by_axis_3_g * by_axis_1_h);
    const float across = (by_axis_2_g * by_axis_3_h) - (by_axis_3_g * by_axis_2_h);
    const float value_3_part = 1.0f / (damping + ((by_axis_1_g * by_axis_1_g) + (by_axis_2_g * by_axis_2_g) +
        (by_axis_3_g * by_axis_3_g)));
    return (hall_position_three_terms_t){.value = value_part, .value_2 = value_2_part, .across = across, .value_3 =
        value_3_part, .terms = ((damping * (terms_1 + terms_2 + (by_axis_3_h * by_axis_3_h))) + (value_part *
        value_part) + (value_2_part * value_2_part) + (across * across)) * value_3_part};
}

typedef struct {
    float sine;
    float sine_squared;
    float B;
    float cosine;
} hall_position_three_cosine_t;

/* cosine: 6 calls in the step */
HALL_POSITION_THREE_INLINE hall_position_three_cosine_t hall_position_three_cosine(float at, float value,
    float phase_fraction_cosine, float field_2, float field_3, float field_4)
{
    const float at_times_value = at * value;
    const float phase_fraction_sine = 8.0f * at_times_value;
    const float sine_part = at_times_value * phase_fraction_cosine;
    const float sine_part_2 = hall_position_three_limit(8.0f * (sine_part * (1.0f - (0.03125f * (phase_fraction_sine *
        phase_fraction_sine)))), 2.0f);
    const float sine_part_3 = 8.0f * sine_part;
    const float sine = hall_position_three_limit(sine_part_2 * (1.0f - (0.125f * (sine_part_3 * sine_part_3))), 1.0f);
    const float sine_squared = sine * sine;
    return (hall_position_three_cosine_t){.sine = sine, .sine_squared = sine_squared, .B = sine * (field_2 +
        (sine_squared * (field_3 + (sine_squared * field_4)))), .cosine = 1.0f - (0.5f * (sine_part_2 * sine_part_2))};
}

typedef struct {
    float phases_1_sine_squared;
    float B_1;
    float by_axis_1_e;
    float terms;
} hall_position_three_terms_2_t;

/* terms_2: 12 calls in the step */
HALL_POSITION_THREE_INLINE hall_position_three_terms_2_t hall_position_three_terms_2(float volts_cosine,
    float rotation_cosine, float volts_sine, float yaw_change_sine, float x_sine_times_by_cosine,
    float x_cosine_times_by_sine, float field_2, float field_3, float field_4)
{
    const float phases_1_sine = x_sine_times_by_cosine + x_cosine_times_by_sine;
    const float phases_1_sine_squared = phases_1_sine * phases_1_sine;
    const float B_1 = phases_1_sine * (field_2 + (phases_1_sine_squared * (field_3 + (phases_1_sine_squared *
        field_4))));
    const float by_axis_1_e = (volts_cosine * rotation_cosine) - (volts_sine * yaw_change_sine) - B_1;
    return (hall_position_three_terms_2_t){.phases_1_sine_squared = phases_1_sine_squared, .B_1 = B_1, .by_axis_1_e =
        by_axis_1_e, .terms = by_axis_1_e * by_axis_1_e};
}

typedef struct {
    float q;
    float B_2;
    float by_axis_2_e;
    float terms;
} hall_position_three_terms_3_t;

/* terms_3: 12 calls in the step */
HALL_POSITION_THREE_INLINE hall_position_three_terms_3_t hall_position_three_terms_3(float volts_sine,
    float rotation_cosine, float volts_cosine, float yaw_change_sine, float p_sine_times_by_cosine,
    float p_cosine_times_by_sine, float field_2, float field_3, float field_4)
{
    const float p_sine = p_sine_times_by_cosine + p_cosine_times_by_sine;
    const float q = p_sine * p_sine;
    const float B_2 = p_sine * (field_2 + (q * (field_3 + (q * field_4))));
    const float by_axis_2_e = (volts_sine * rotation_cosine) + (volts_cosine * yaw_change_sine) - B_2;
    return (hall_position_three_terms_3_t){.q = q, .B_2 = B_2, .by_axis_2_e = by_axis_2_e, .terms = by_axis_2_e *
        by_axis_2_e};
}

typedef struct {
    float by_axis_1_g;
    float by_axis_1_h;
    float terms;
    float terms_2;
} hall_position_three_terms_4_t;

/* terms_4: 15 calls in the step */
HALL_POSITION_THREE_INLINE hall_position_three_terms_4_t hall_position_three_terms_4(float B_2, float cosine,
    float slope_1, float sine_squared, float slope_2, float slope_3, float value, float value_2)
{
    const float by_axis_1_g = cosine * (slope_1 + (sine_squared * (slope_2 + (sine_squared * slope_3))));
    const float by_axis_1_h = B_2 - (by_axis_1_g * value);
    return (hall_position_three_terms_4_t){.by_axis_1_g = by_axis_1_g, .by_axis_1_h = by_axis_1_h, .terms = by_axis_1_h
        * value_2, .terms_2 = by_axis_1_g * by_axis_1_h};
}

typedef struct {
    float by_axis_2_g;
    float by_axis_2_h;
    float terms;
    float terms_2;
} hall_position_three_terms_5_t;

/* terms_5: 15 calls in the step */
HALL_POSITION_THREE_INLINE hall_position_three_terms_5_t hall_position_three_terms_5(float p_cosine, float slope_1,
    float q, float slope_2, float slope_3, float value, float B_1, float value_2)
{
    const float by_axis_2_g = p_cosine * (slope_1 + (q * (slope_2 + (q * slope_3))));
    const float by_axis_2_h = (by_axis_2_g * value) - B_1;
    return (hall_position_three_terms_5_t){.by_axis_2_g = by_axis_2_g, .by_axis_2_h = by_axis_2_h, .terms = by_axis_2_h
        * value_2, .terms_2 = by_axis_2_g * by_axis_2_h};
}

/* moment: 10 calls in the step */
HALL_POSITION_THREE_INLINE float hall_position_three_moment(float value, float value_2, float value_3, float value_4,
    float value_5, float value_6, float by_axis_1_g, float value_7, float value_8)
{
    static const float damping = 0.00992376f;                   /* V^2; 0.001 alpha^2: weight of the prior */

    return (damping * (value + value_2)) + (value_3 * (value_4 - value_5)) + (value_6 * ((by_axis_1_g * value_7) -
        value_8));
}

typedef struct {
    float by_cosine;
    float by_sine;
    float cosine_2;
} hall_position_three_cosine_2_t;

/* cosine_2: 8 calls in the step */
HALL_POSITION_THREE_INLINE hall_position_three_cosine_2_t hall_position_three_cosine_2(float cosine, float angle,
    float sine)
{
    const float f17_argument = angle * angle;
    const float by_cosine = f17_polynomial(f17_argument);
    const float by_sine = angle * f18_polynomial(f17_argument);
    return (hall_position_three_cosine_2_t){.by_cosine = by_cosine, .by_sine = by_sine, .cosine_2 = (cosine * by_cosine)
        - (sine * by_sine)};
}

typedef struct {
    float by_cosine;
    float by_sine;
    float cosine_2;
} hall_position_three_cosine_3_t;

/* cosine_3: 8 calls in the step */
HALL_POSITION_THREE_INLINE hall_position_three_cosine_3_t hall_position_three_cosine_3(float cosine, float angle,
    float sine)
{
    const float f19_argument = angle * angle;
    const float by_cosine = f19_polynomial(f19_argument);
    const float by_sine = angle * f20_polynomial(f19_argument);
    return (hall_position_three_cosine_3_t){.by_cosine = by_cosine, .by_sine = by_sine, .cosine_2 = (cosine * by_cosine)
        - (sine * by_sine)};
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
    const float phase_fraction_cosine_part = hall_position_three_limit(4.0f * (f1 * yaw_fraction_cosine), 2.0f);
    const float heading_cosine = 1.0f - (0.5f * (phase_fraction_cosine_part * phase_fraction_cosine_part));
    const float heading_sine = hall_position_three_limit(phase_fraction_cosine_part * (1.0f - (0.125f *
        (yaw_fraction_sine * yaw_fraction_sine))), 1.0f);
    const float x_phase_fraction_cosine = (arm_ax * heading_cosine) - (arm_ay * heading_sine);
    const float at_1_phase_fraction_cosine = prediction_phase_x + x_phase_fraction_cosine;
    const float f3_argument = at_1_phase_fraction_cosine * at_1_phase_fraction_cosine;
    const float phase_fraction_cosine = phase_fraction_cosine_polynomial(f3_argument);
    const float estimator_motion_y = state->estimator_motion_y;
    const float prediction_phase_y = state->estimator_phase_y + estimator_motion_y;
    const float y_phase_fraction_cosine = (arm_ay * heading_cosine) - (-arm_ax * heading_sine);
    const float at_2_phase_fraction_cosine = prediction_phase_y + y_phase_fraction_cosine;
    const float f3_argument_2 = at_2_phase_fraction_cosine * at_2_phase_fraction_cosine;
    const float phase_fraction_cosine_2 = phase_fraction_cosine_polynomial(f3_argument_2);
    const float x_phase_fraction_cosine_2 = (arm_bx * heading_cosine) - (arm_by * heading_sine);
    const float at_1_phase_fraction_cosine_2 = prediction_phase_x + x_phase_fraction_cosine_2;
    const float f7_argument = at_1_phase_fraction_cosine_2 * at_1_phase_fraction_cosine_2;
    const float phase_fraction_cosine_3 = phase_fraction_cosine_3_polynomial(f7_argument);
    const float y_phase_fraction_cosine_2 = (arm_by * heading_cosine) - (-arm_bx * heading_sine);
    const float at_2_phase_fraction_cosine_2 = prediction_phase_y + y_phase_fraction_cosine_2;
    const float f7_argument_2 = at_2_phase_fraction_cosine_2 * at_2_phase_fraction_cosine_2;
    const float phase_fraction_cosine_4 = phase_fraction_cosine_3_polynomial(f7_argument_2);
    const float x_phase_fraction_cosine_3 = (arm_cx * heading_cosine) + (-arm_cy * heading_sine);
    const float at_1_phase_fraction_cosine_3 = prediction_phase_x + x_phase_fraction_cosine_3;
    const float f11_argument = at_1_phase_fraction_cosine_3 * at_1_phase_fraction_cosine_3;
    const float phase_fraction_cosine_5 = phase_fraction_cosine_5_polynomial(f11_argument);
    const float y_phase_fraction_cosine_3 = (arm_cx * heading_sine) - (-arm_cy * heading_cosine);
    const float at_2_phase_fraction_cosine_3 = prediction_phase_y + y_phase_fraction_cosine_3;
    const float f11_argument_2 = at_2_phase_fraction_cosine_3 * at_2_phase_fraction_cosine_3;
    const float phase_fraction_cosine_6 = phase_fraction_cosine_5_polynomial(f11_argument_2);
    const uint32_t estimator_excluded_sensor = state->estimator_excluded_sensor;
    const bool excluded_1 = fault_V_ax || fault_V_ay || (estimator_excluded_sensor == 1u);
    const float cost_0_part = 1.0f - (excluded_1 ? 1.0f : 0.0f);
    const float vx_cost_0 = cost_0_part * V_ax_held;
    const float vy_cost_0 = cost_0_part * V_ay_held;
    const float volts_cosine_cost_0 = (heading_cosine * vx_cost_0) - (heading_sine * vy_cost_0);
    const float field_2_cost_0 = cost_0_part * estimator_field_1;
    const float field_3_cost_0 = cost_0_part * estimator_field_3;
    const float field_4_cost_0 = cost_0_part * estimator_field_5;
    const hall_position_three_cosine_t cosine_1 = hall_position_three_cosine(at_1_phase_fraction_cosine,
        f3_polynomial(f3_argument), phase_fraction_cosine, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float residuals_1 = volts_cosine_cost_0 - cosine_1.B;
    const float terms_1_cost_0 = residuals_1 * residuals_1;
    const bool excluded_2 = fault_V_bx || fault_V_by || (estimator_excluded_sensor == 2u);
    const float cost_0_part_2 = 1.0f - (excluded_2 ? 1.0f : 0.0f);
    const float vx_cost_0_2 = cost_0_part_2 * V_bx_held;
    const float vy_cost_0_2 = cost_0_part_2 * V_by_held;
    const float volts_cosine_cost_0_2 = (heading_cosine * vx_cost_0_2) - (heading_sine * vy_cost_0_2);
    const float field_2_cost_0_2 = cost_0_part_2 * estimator_field_1;
    const float field_3_cost_0_2 = cost_0_part_2 * estimator_field_3;
    const float field_4_cost_0_2 = cost_0_part_2 * estimator_field_5;
    const hall_position_three_cosine_t cosine_2 = hall_position_three_cosine(at_1_phase_fraction_cosine_2,
        f7_polynomial(f7_argument), phase_fraction_cosine_3, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float residuals_2 = volts_cosine_cost_0_2 - cosine_2.B;
    const float terms_2_cost_0 = residuals_2 * residuals_2;
    const bool excluded_3 = fault_V_cx || fault_V_cy || (estimator_excluded_sensor == 3u);
    const float cost_0_part_3 = 1.0f - (excluded_3 ? 1.0f : 0.0f);
    const float vx_cost_0_3 = cost_0_part_3 * V_cx_held;
    const float vy_cost_0_3 = cost_0_part_3 * V_cy_held;
    const float volts_cosine_cost_0_3 = (heading_cosine * vx_cost_0_3) - (heading_sine * vy_cost_0_3);
    const float field_2_cost_0_3 = cost_0_part_3 * estimator_field_1;
    const float field_3_cost_0_3 = cost_0_part_3 * estimator_field_3;
    const float field_4_cost_0_3 = cost_0_part_3 * estimator_field_5;
    const hall_position_three_cosine_t cosine_3 = hall_position_three_cosine(at_1_phase_fraction_cosine_3,
        f11_polynomial(f11_argument), phase_fraction_cosine_5, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float residuals_3 = volts_cosine_cost_0_3 - cosine_3.B;
    const float terms_3_cost_0 = residuals_3 * residuals_3;
    const float volts_sine_cost_0 = (heading_sine * vx_cost_0) + (heading_cosine * vy_cost_0);
    const hall_position_three_cosine_t cosine_4 = hall_position_three_cosine(at_2_phase_fraction_cosine,
        f3_polynomial(f3_argument_2), phase_fraction_cosine_2, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float residuals_4 = volts_sine_cost_0 - cosine_4.B;
    const float terms_4_cost_0 = residuals_4 * residuals_4;
    const float volts_sine_cost_0_2 = (heading_sine * vx_cost_0_2) + (heading_cosine * vy_cost_0_2);
    const hall_position_three_cosine_t cosine_5 = hall_position_three_cosine(at_2_phase_fraction_cosine_2,
        f7_polynomial(f7_argument_2), phase_fraction_cosine_4, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float residuals_5 = volts_sine_cost_0_2 - cosine_5.B;
    const float terms_5_cost_0 = residuals_5 * residuals_5;
    const float volts_sine_cost_0_3 = (heading_sine * vx_cost_0_3) + (heading_cosine * vy_cost_0_3);
    const hall_position_three_cosine_t cosine_6 = hall_position_three_cosine(at_2_phase_fraction_cosine_3,
        f11_polynomial(f11_argument_2), phase_fraction_cosine_6, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float residuals_6 = volts_sine_cost_0_3 - cosine_6.B;
    const float terms_6_cost_0 = residuals_6 * residuals_6;
    const float cost_0 = terms_1_cost_0 + terms_2_cost_0 + terms_3_cost_0 + terms_4_cost_0 + terms_5_cost_0 +
        terms_6_cost_0;
    const float slope_1_yaw_change_sine = cost_0_part * estimator_slope_0;
    const float slope_2_yaw_change_sine = cost_0_part * estimator_slope_2;
    const float slope_3_yaw_change_sine = cost_0_part * estimator_slope_4;
    const hall_position_three_terms_4_t terms_1_4 = hall_position_three_terms_4(cosine_4.B, cosine_1.cosine,
        slope_1_yaw_change_sine, cosine_1.sine_squared, slope_2_yaw_change_sine, slope_3_yaw_change_sine,
        y_phase_fraction_cosine, residuals_1);
    const float slope_1_yaw_change_sine_2 = cost_0_part_2 * estimator_slope_0;
    const float slope_2_yaw_change_sine_2 = cost_0_part_2 * estimator_slope_2;
    const float slope_3_yaw_change_sine_2 = cost_0_part_2 * estimator_slope_4;
    const hall_position_three_terms_4_t terms_2_4 = hall_position_three_terms_4(cosine_5.B, cosine_2.cosine,
        slope_1_yaw_change_sine_2, cosine_2.sine_squared, slope_2_yaw_change_sine_2, slope_3_yaw_change_sine_2,
        y_phase_fraction_cosine_2, residuals_2);
    const float slope_1_yaw_change_sine_3 = cost_0_part_3 * estimator_slope_0;
    const float slope_2_yaw_change_sine_3 = cost_0_part_3 * estimator_slope_2;
    const float slope_3_yaw_change_sine_3 = cost_0_part_3 * estimator_slope_4;
    const hall_position_three_terms_4_t terms_3_4 = hall_position_three_terms_4(cosine_6.B, cosine_3.cosine,
        slope_1_yaw_change_sine_3, cosine_3.sine_squared, slope_2_yaw_change_sine_3, slope_3_yaw_change_sine_3,
        y_phase_fraction_cosine_3, residuals_3);
    const hall_position_three_terms_t terms_1 = hall_position_three_terms(terms_1_4.by_axis_1_h * terms_1_4.by_axis_1_h,
        terms_2_4.by_axis_1_h * terms_2_4.by_axis_1_h, terms_3_4.by_axis_1_h, terms_1_4.by_axis_1_g,
        terms_2_4.by_axis_1_h, terms_2_4.by_axis_1_g, terms_1_4.by_axis_1_h, terms_3_4.by_axis_1_g);
    const float moment_1_value_9 = hall_position_three_moment(terms_1_4.terms + terms_2_4.terms, terms_3_4.terms,
        terms_1.value, terms_1_4.by_axis_1_g * residuals_2, terms_2_4.by_axis_1_g * residuals_1, terms_1.value_2,
        terms_1_4.by_axis_1_g, residuals_3, terms_3_4.by_axis_1_g * residuals_1);
    const float terms_1_yaw_change_sine = (moment_1_value_9 + (terms_1.across * ((terms_2_4.by_axis_1_g * residuals_3) -
        (terms_3_4.by_axis_1_g * residuals_2)))) * terms_1.value_3;
    const hall_position_three_terms_5_t terms_1_5 = hall_position_three_terms_5(cosine_4.cosine,
        slope_1_yaw_change_sine, cosine_4.sine_squared, slope_2_yaw_change_sine, slope_3_yaw_change_sine,
        x_phase_fraction_cosine, cosine_1.B, residuals_4);
    const hall_position_three_terms_5_t terms_2_5 = hall_position_three_terms_5(cosine_5.cosine,
        slope_1_yaw_change_sine_2, cosine_5.sine_squared, slope_2_yaw_change_sine_2, slope_3_yaw_change_sine_2,
        x_phase_fraction_cosine_2, cosine_2.B, residuals_5);
    const hall_position_three_terms_5_t terms_3_5 = hall_position_three_terms_5(cosine_6.cosine,
        slope_1_yaw_change_sine_3, cosine_6.sine_squared, slope_2_yaw_change_sine_3, slope_3_yaw_change_sine_3,
        x_phase_fraction_cosine_3, cosine_3.B, residuals_6);
    const hall_position_three_terms_t terms_2 = hall_position_three_terms(terms_1_5.by_axis_2_h * terms_1_5.by_axis_2_h,
        terms_2_5.by_axis_2_h * terms_2_5.by_axis_2_h, terms_3_5.by_axis_2_h, terms_1_5.by_axis_2_g,
        terms_2_5.by_axis_2_h, terms_2_5.by_axis_2_g, terms_1_5.by_axis_2_h, terms_3_5.by_axis_2_g);
    const float moment_2_value_9 = hall_position_three_moment(terms_1_5.terms + terms_2_5.terms, terms_3_5.terms,
        terms_2.value, terms_1_5.by_axis_2_g * residuals_5, terms_2_5.by_axis_2_g * residuals_4, terms_2.value_2,
        terms_1_5.by_axis_2_g, residuals_6, terms_3_5.by_axis_2_g * residuals_4);
    const float terms_2_yaw_change_sine = (moment_2_value_9 + (terms_2.across * ((terms_2_5.by_axis_2_g * residuals_6) -
        (terms_3_5.by_axis_2_g * residuals_5)))) * terms_2.value_3;
    const float then_3_yaw_change_sine = hall_position_three_limit((terms_1_yaw_change_sine + terms_2_yaw_change_sine) /
        (yaw_damping + (terms_1.terms + terms_2.terms)), max_yaw_step);
    const float yaw_change_sine_part = then_3_yaw_change_sine * then_3_yaw_change_sine;
    const float yaw_change_sine = then_3_yaw_change_sine * yaw_change_sine_polynomial(yaw_change_sine_part);
    const float half_yaw_change_sine = then_3_yaw_change_sine * half_yaw_change_sine_polynomial(yaw_change_sine_part);
    const float versine_cost_1 = half_yaw_change_sine * half_yaw_change_sine;
    const float rotation_cosine_cost_1 = 1.0f - versine_cost_1;
    const float cost_1_part = (terms_1_4.by_axis_1_g * residuals_1) + (terms_2_4.by_axis_1_g * residuals_2) +
        (terms_3_4.by_axis_1_g * residuals_3) - ((terms_1_4.terms_2 + terms_2_4.terms_2 + terms_3_4.terms_2) *
        then_3_yaw_change_sine);
    const float then_1_cost_1 = hall_position_three_limit(cost_1_part * terms_1.value_3, 0.5f);
    const float cost_1_part_2 = (x_phase_fraction_cosine * versine_cost_1) + (y_phase_fraction_cosine *
        yaw_change_sine);
    const float angle_cost_1 = then_1_cost_1 - cost_1_part_2;
    const float f15_argument = angle_cost_1 * angle_cost_1;
    const float by_cosine_cost_1 = f15_polynomial(f15_argument);
    const float by_sine_cost_1 = angle_cost_1 * f16_polynomial(f15_argument);
    const hall_position_three_terms_2_t terms_1_2 = hall_position_three_terms_2(volts_cosine_cost_0,
        rotation_cosine_cost_1, volts_sine_cost_0, yaw_change_sine, cosine_1.sine * by_cosine_cost_1, cosine_1.cosine *
        by_sine_cost_1, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float cost_1_part_3 = (x_phase_fraction_cosine_2 * versine_cost_1) + (y_phase_fraction_cosine_2 *
        yaw_change_sine);
    const hall_position_three_cosine_2_t cosine_1_3 = hall_position_three_cosine_2(cosine_2.cosine, then_1_cost_1 -
        cost_1_part_3, cosine_2.sine);
    const hall_position_three_terms_2_t terms_2_2 = hall_position_three_terms_2(volts_cosine_cost_0_2,
        rotation_cosine_cost_1, volts_sine_cost_0_2, yaw_change_sine, cosine_2.sine * cosine_1_3.by_cosine,
        cosine_2.cosine * cosine_1_3.by_sine, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float cost_1_part_4 = (x_phase_fraction_cosine_3 * versine_cost_1) + (y_phase_fraction_cosine_3 *
        yaw_change_sine);
    const hall_position_three_cosine_3_t cosine_1_4 = hall_position_three_cosine_3(cosine_3.cosine, then_1_cost_1 -
        cost_1_part_4, cosine_3.sine);
    const hall_position_three_terms_2_t terms_3_2 = hall_position_three_terms_2(volts_cosine_cost_0_3,
        rotation_cosine_cost_1, volts_sine_cost_0_3, yaw_change_sine, cosine_3.sine * cosine_1_4.by_cosine,
        cosine_3.cosine * cosine_1_4.by_sine, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float cost_1_part_5 = (terms_1_5.by_axis_2_g * residuals_4) + (terms_2_5.by_axis_2_g * residuals_5) +
        (terms_3_5.by_axis_2_g * residuals_6) - ((terms_1_5.terms_2 + terms_2_5.terms_2 + terms_3_5.terms_2) *
        then_3_yaw_change_sine);
    const float then_2_cost_1 = hall_position_three_limit(cost_1_part_5 * terms_2.value_3, 0.5f);
    const float dy_cost_1 = (x_phase_fraction_cosine * yaw_change_sine) - (y_phase_fraction_cosine * versine_cost_1);
    const float angle_cost_1_2 = then_2_cost_1 + dy_cost_1;
    const float f15_argument_2 = angle_cost_1_2 * angle_cost_1_2;
    const float by_cosine_cost_1_2 = f15_polynomial(f15_argument_2);
    const float by_sine_cost_1_2 = angle_cost_1_2 * f16_polynomial(f15_argument_2);
    const hall_position_three_terms_3_t terms_1_3 = hall_position_three_terms_3(volts_sine_cost_0,
        rotation_cosine_cost_1, volts_cosine_cost_0, yaw_change_sine, cosine_4.sine * by_cosine_cost_1_2,
        cosine_4.cosine * by_sine_cost_1_2, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float dy_cost_1_2 = (x_phase_fraction_cosine_2 * yaw_change_sine) - (y_phase_fraction_cosine_2 *
        versine_cost_1);
    const hall_position_three_cosine_2_t cosine_2_3 = hall_position_three_cosine_2(cosine_5.cosine, then_2_cost_1 +
        dy_cost_1_2, cosine_5.sine);
    const hall_position_three_terms_3_t terms_2_3 = hall_position_three_terms_3(volts_sine_cost_0_2,
        rotation_cosine_cost_1, volts_cosine_cost_0_2, yaw_change_sine, cosine_5.sine * cosine_2_3.by_cosine,
        cosine_5.cosine * cosine_2_3.by_sine, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float dy_cost_1_3 = (x_phase_fraction_cosine_3 * yaw_change_sine) - (y_phase_fraction_cosine_3 *
        versine_cost_1);
    const hall_position_three_cosine_3_t cosine_2_4 = hall_position_three_cosine_3(cosine_6.cosine, then_2_cost_1 +
        dy_cost_1_3, cosine_6.sine);
    const hall_position_three_terms_3_t terms_3_3 = hall_position_three_terms_3(volts_sine_cost_0_3,
        rotation_cosine_cost_1, volts_cosine_cost_0_3, yaw_change_sine, cosine_6.sine * cosine_2_4.by_cosine,
        cosine_6.cosine * cosine_2_4.by_sine, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float cost_1 = terms_1_2.terms + terms_2_2.terms + terms_3_2.terms + terms_1_3.terms + terms_2_3.terms +
        terms_3_3.terms + (damping * ((then_1_cost_1 * then_1_cost_1) + (then_2_cost_1 * then_2_cost_1) +
        (squared_yaw_arm * yaw_change_sine_part)));
    const bool better_yaw_change_sine = cost_1 <= ((cost_factor * cost_0) + cost_slack);
    const hall_position_three_terms_4_t terms_4_4 = hall_position_three_terms_4(terms_1_3.B_2, (cosine_1.cosine *
        by_cosine_cost_1) - (cosine_1.sine * by_sine_cost_1), slope_1_yaw_change_sine, terms_1_2.phases_1_sine_squared,
        slope_2_yaw_change_sine, slope_3_yaw_change_sine, y_phase_fraction_cosine + dy_cost_1, terms_1_2.by_axis_1_e);
    const hall_position_three_terms_4_t terms_5_4 = hall_position_three_terms_4(terms_2_3.B_2, cosine_1_3.cosine_2,
        slope_1_yaw_change_sine_2, terms_2_2.phases_1_sine_squared, slope_2_yaw_change_sine_2,
        slope_3_yaw_change_sine_2, y_phase_fraction_cosine_2 + dy_cost_1_2, terms_2_2.by_axis_1_e);
    const hall_position_three_terms_4_t terms_6_4 = hall_position_three_terms_4(terms_3_3.B_2, cosine_1_4.cosine_2,
        slope_1_yaw_change_sine_3, terms_3_2.phases_1_sine_squared, slope_2_yaw_change_sine_3,
        slope_3_yaw_change_sine_3, y_phase_fraction_cosine_3 + dy_cost_1_3, terms_3_2.by_axis_1_e);
    const float yaw_change_sine_part_2 = terms_4_4.terms_2 + terms_5_4.terms_2 + terms_6_4.terms_2;
    const hall_position_three_terms_t terms_3 = hall_position_three_terms(terms_4_4.by_axis_1_h * terms_4_4.by_axis_1_h,
        terms_5_4.by_axis_1_h * terms_5_4.by_axis_1_h, terms_6_4.by_axis_1_h, terms_4_4.by_axis_1_g,
        terms_5_4.by_axis_1_h, terms_5_4.by_axis_1_g, terms_4_4.by_axis_1_h, terms_6_4.by_axis_1_g);
    const float moment_3_value_9 = hall_position_three_moment(terms_4_4.terms + terms_5_4.terms + terms_6_4.terms,
        then_1_cost_1 * yaw_change_sine_part_2, terms_3.value, terms_4_4.by_axis_1_g * terms_2_2.by_axis_1_e,
        terms_5_4.by_axis_1_g * terms_1_2.by_axis_1_e, terms_3.value_2, terms_4_4.by_axis_1_g, terms_3_2.by_axis_1_e,
        terms_6_4.by_axis_1_g * terms_1_2.by_axis_1_e);
    const float yaw_change_sine_part_3 = terms_3.across * ((terms_5_4.by_axis_1_g * terms_3_2.by_axis_1_e) -
        (terms_6_4.by_axis_1_g * terms_2_2.by_axis_1_e));
    const hall_position_three_terms_5_t terms_4_5 = hall_position_three_terms_5((cosine_4.cosine * by_cosine_cost_1_2) -
        (cosine_4.sine * by_sine_cost_1_2), slope_1_yaw_change_sine, terms_1_3.q, slope_2_yaw_change_sine,
        slope_3_yaw_change_sine, x_phase_fraction_cosine - cost_1_part_2, terms_1_2.B_1, terms_1_3.by_axis_2_e);
    const hall_position_three_terms_5_t terms_5_5 = hall_position_three_terms_5(cosine_2_3.cosine_2,
        slope_1_yaw_change_sine_2, terms_2_3.q, slope_2_yaw_change_sine_2, slope_3_yaw_change_sine_2,
        x_phase_fraction_cosine_2 - cost_1_part_3, terms_2_2.B_1, terms_2_3.by_axis_2_e);
    const hall_position_three_terms_5_t terms_6_5 = hall_position_three_terms_5(cosine_2_4.cosine_2,
        slope_1_yaw_change_sine_3, terms_3_3.q, slope_2_yaw_change_sine_3, slope_3_yaw_change_sine_3,
        x_phase_fraction_cosine_3 - cost_1_part_4, terms_3_2.B_1, terms_3_3.by_axis_2_e);
    const float yaw_change_sine_part_4 = terms_4_5.terms_2 + terms_5_5.terms_2 + terms_6_5.terms_2;
    const hall_position_three_terms_t terms_4 = hall_position_three_terms(terms_4_5.by_axis_2_h * terms_4_5.by_axis_2_h,
        terms_5_5.by_axis_2_h * terms_5_5.by_axis_2_h, terms_6_5.by_axis_2_h, terms_4_5.by_axis_2_g,
        terms_5_5.by_axis_2_h, terms_5_5.by_axis_2_g, terms_4_5.by_axis_2_h, terms_6_5.by_axis_2_g);
    const float moment_4_value_9 = hall_position_three_moment(terms_4_5.terms + terms_5_5.terms + terms_6_5.terms,
        then_2_cost_1 * yaw_change_sine_part_4, terms_4.value, terms_4_5.by_axis_2_g * terms_2_3.by_axis_2_e,
        terms_5_5.by_axis_2_g * terms_1_3.by_axis_2_e, terms_4.value_2, terms_4_5.by_axis_2_g, terms_3_3.by_axis_2_e,
        terms_6_5.by_axis_2_g * terms_1_3.by_axis_2_e);
    const float yaw_change_sine_part_5 = terms_4.across * ((terms_5_5.by_axis_2_g * terms_3_3.by_axis_2_e) -
        (terms_6_5.by_axis_2_g * terms_2_3.by_axis_2_e));
    const float right_yaw_change_sine = ((moment_3_value_9 + yaw_change_sine_part_3) * terms_3.value_3) +
        ((moment_4_value_9 + yaw_change_sine_part_5) * terms_4.value_3) - (yaw_damping * then_3_yaw_change_sine);
    float other_3_yaw_change_sine = then_3_yaw_change_sine;
    float other_1_cost_2 = then_1_cost_1;
    float other_2_cost_2 = then_2_cost_1;
    float yaw_change_sine_part_6 = cost_1;
    if (!better_yaw_change_sine) {
        other_3_yaw_change_sine = 0.0f;
        other_1_cost_2 = 0.0f;
        other_2_cost_2 = 0.0f;
        yaw_change_sine_part_6 = cost_0;
    }
    const float then_3_yaw_change_sine_2 = hall_position_three_limit((better_yaw_change_sine) ? (then_3_yaw_change_sine
        + (right_yaw_change_sine / (yaw_damping + (terms_3.terms + terms_4.terms)))) : (0.5f * (then_3_yaw_change_sine +
        other_3_yaw_change_sine)), max_yaw_step);
    const float yaw_change_sine_part_7 = then_3_yaw_change_sine_2 * then_3_yaw_change_sine_2;
    const float yaw_change_sine_2 = then_3_yaw_change_sine_2 * yaw_change_sine_polynomial(yaw_change_sine_part_7);
    const float half_yaw_change_sine_2 = then_3_yaw_change_sine_2 *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_7);
    const float versine_cost_2 = half_yaw_change_sine_2 * half_yaw_change_sine_2;
    const float rotation_cosine_cost_2 = 1.0f - versine_cost_2;
    const float cost_2_part = (terms_4_4.by_axis_1_g * terms_1_2.by_axis_1_e) + (terms_5_4.by_axis_1_g *
        terms_2_2.by_axis_1_e) + (terms_6_4.by_axis_1_g * terms_3_2.by_axis_1_e);
    const float yaw_change_cost_2 = then_3_yaw_change_sine_2 - then_3_yaw_change_sine;
    const float then_1_cost_2 = hall_position_three_limit((better_yaw_change_sine) ? (then_1_cost_1 + ((cost_2_part -
        (damping * then_1_cost_1) - (yaw_change_sine_part_2 * yaw_change_cost_2)) * terms_3.value_3)) : (0.5f *
        (then_1_cost_1 + other_1_cost_2)), 0.5f);
    const float cost_2_part_2 = (x_phase_fraction_cosine * versine_cost_2) + (y_phase_fraction_cosine *
        yaw_change_sine_2);
    const float angle_cost_2 = then_1_cost_2 - cost_2_part_2;
    const float f15_argument_3 = angle_cost_2 * angle_cost_2;
    const float by_cosine_cost_2 = f15_polynomial(f15_argument_3);
    const float by_sine_cost_2 = angle_cost_2 * f16_polynomial(f15_argument_3);
    const hall_position_three_terms_2_t terms_4_2 = hall_position_three_terms_2(volts_cosine_cost_0,
        rotation_cosine_cost_2, volts_sine_cost_0, yaw_change_sine_2, cosine_1.sine * by_cosine_cost_2, cosine_1.cosine
        * by_sine_cost_2, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float cost_2_part_3 = (x_phase_fraction_cosine_2 * versine_cost_2) + (y_phase_fraction_cosine_2 *
        yaw_change_sine_2);
    const hall_position_three_cosine_2_t cosine_3_3 = hall_position_three_cosine_2(cosine_2.cosine, then_1_cost_2 -
        cost_2_part_3, cosine_2.sine);
    const hall_position_three_terms_2_t terms_5_2 = hall_position_three_terms_2(volts_cosine_cost_0_2,
        rotation_cosine_cost_2, volts_sine_cost_0_2, yaw_change_sine_2, cosine_2.sine * cosine_3_3.by_cosine,
        cosine_2.cosine * cosine_3_3.by_sine, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float cost_2_part_4 = (x_phase_fraction_cosine_3 * versine_cost_2) + (y_phase_fraction_cosine_3 *
        yaw_change_sine_2);
    const hall_position_three_cosine_3_t cosine_3_4 = hall_position_three_cosine_3(cosine_3.cosine, then_1_cost_2 -
        cost_2_part_4, cosine_3.sine);
    const hall_position_three_terms_2_t terms_6_2 = hall_position_three_terms_2(volts_cosine_cost_0_3,
        rotation_cosine_cost_2, volts_sine_cost_0_3, yaw_change_sine_2, cosine_3.sine * cosine_3_4.by_cosine,
        cosine_3.cosine * cosine_3_4.by_sine, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float cost_2_part_5 = (terms_4_5.by_axis_2_g * terms_1_3.by_axis_2_e) + (terms_5_5.by_axis_2_g *
        terms_2_3.by_axis_2_e) + (terms_6_5.by_axis_2_g * terms_3_3.by_axis_2_e);
    const float then_2_cost_2 = hall_position_three_limit((better_yaw_change_sine) ? (then_2_cost_1 + ((cost_2_part_5 -
        (damping * then_2_cost_1) - (yaw_change_sine_part_4 * yaw_change_cost_2)) * terms_4.value_3)) : (0.5f *
        (then_2_cost_1 + other_2_cost_2)), 0.5f);
    const float dy_cost_2 = (x_phase_fraction_cosine * yaw_change_sine_2) - (y_phase_fraction_cosine * versine_cost_2);
    const float angle_cost_2_2 = then_2_cost_2 + dy_cost_2;
    const float f15_argument_4 = angle_cost_2_2 * angle_cost_2_2;
    const float by_cosine_cost_2_2 = f15_polynomial(f15_argument_4);
    const float by_sine_cost_2_2 = angle_cost_2_2 * f16_polynomial(f15_argument_4);
    const hall_position_three_terms_3_t terms_4_3 = hall_position_three_terms_3(volts_sine_cost_0,
        rotation_cosine_cost_2, volts_cosine_cost_0, yaw_change_sine_2, cosine_4.sine * by_cosine_cost_2_2,
        cosine_4.cosine * by_sine_cost_2_2, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float dy_cost_2_2 = (x_phase_fraction_cosine_2 * yaw_change_sine_2) - (y_phase_fraction_cosine_2 *
        versine_cost_2);
    const hall_position_three_cosine_2_t cosine_4_3 = hall_position_three_cosine_2(cosine_5.cosine, then_2_cost_2 +
        dy_cost_2_2, cosine_5.sine);
    const hall_position_three_terms_3_t terms_5_3 = hall_position_three_terms_3(volts_sine_cost_0_2,
        rotation_cosine_cost_2, volts_cosine_cost_0_2, yaw_change_sine_2, cosine_5.sine * cosine_4_3.by_cosine,
        cosine_5.cosine * cosine_4_3.by_sine, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float dy_cost_2_3 = (x_phase_fraction_cosine_3 * yaw_change_sine_2) - (y_phase_fraction_cosine_3 *
        versine_cost_2);
    const hall_position_three_cosine_3_t cosine_4_4 = hall_position_three_cosine_3(cosine_6.cosine, then_2_cost_2 +
        dy_cost_2_3, cosine_6.sine);
    const hall_position_three_terms_3_t terms_6_3 = hall_position_three_terms_3(volts_sine_cost_0_3,
        rotation_cosine_cost_2, volts_cosine_cost_0_3, yaw_change_sine_2, cosine_6.sine * cosine_4_4.by_cosine,
        cosine_6.cosine * cosine_4_4.by_sine, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float cost_2 = terms_4_2.terms + terms_5_2.terms + terms_6_2.terms + terms_4_3.terms + terms_5_3.terms +
        terms_6_3.terms + (damping * ((then_1_cost_2 * then_1_cost_2) + (then_2_cost_2 * then_2_cost_2) +
        (squared_yaw_arm * yaw_change_sine_part_7)));
    const bool better_yaw_change_sine_2 = cost_2 <= ((cost_factor * yaw_change_sine_part_6) + cost_slack);
    const hall_position_three_terms_4_t terms_7_4 = hall_position_three_terms_4(terms_4_3.B_2, (cosine_1.cosine *
        by_cosine_cost_2) - (cosine_1.sine * by_sine_cost_2), slope_1_yaw_change_sine, terms_4_2.phases_1_sine_squared,
        slope_2_yaw_change_sine, slope_3_yaw_change_sine, y_phase_fraction_cosine + dy_cost_2, terms_4_2.by_axis_1_e);
    const hall_position_three_terms_4_t terms_8_4 = hall_position_three_terms_4(terms_5_3.B_2, cosine_3_3.cosine_2,
        slope_1_yaw_change_sine_2, terms_5_2.phases_1_sine_squared, slope_2_yaw_change_sine_2,
        slope_3_yaw_change_sine_2, y_phase_fraction_cosine_2 + dy_cost_2_2, terms_5_2.by_axis_1_e);
    const hall_position_three_terms_4_t terms_9_4 = hall_position_three_terms_4(terms_6_3.B_2, cosine_3_4.cosine_2,
        slope_1_yaw_change_sine_3, terms_6_2.phases_1_sine_squared, slope_2_yaw_change_sine_3,
        slope_3_yaw_change_sine_3, y_phase_fraction_cosine_3 + dy_cost_2_3, terms_6_2.by_axis_1_e);
    const float yaw_change_sine_part_8 = terms_7_4.terms_2 + terms_8_4.terms_2 + terms_9_4.terms_2;
    const hall_position_three_terms_t terms_5 = hall_position_three_terms(terms_7_4.by_axis_1_h * terms_7_4.by_axis_1_h,
        terms_8_4.by_axis_1_h * terms_8_4.by_axis_1_h, terms_9_4.by_axis_1_h, terms_7_4.by_axis_1_g,
        terms_8_4.by_axis_1_h, terms_8_4.by_axis_1_g, terms_7_4.by_axis_1_h, terms_9_4.by_axis_1_g);
    const float moment_5_value_9 = hall_position_three_moment(terms_7_4.terms + terms_8_4.terms + terms_9_4.terms,
        then_1_cost_2 * yaw_change_sine_part_8, terms_5.value, terms_7_4.by_axis_1_g * terms_5_2.by_axis_1_e,
        terms_8_4.by_axis_1_g * terms_4_2.by_axis_1_e, terms_5.value_2, terms_7_4.by_axis_1_g, terms_6_2.by_axis_1_e,
        terms_9_4.by_axis_1_g * terms_4_2.by_axis_1_e);
    const float yaw_change_sine_part_9 = terms_5.across * ((terms_8_4.by_axis_1_g * terms_6_2.by_axis_1_e) -
        (terms_9_4.by_axis_1_g * terms_5_2.by_axis_1_e));
    const hall_position_three_terms_5_t terms_7_5 = hall_position_three_terms_5((cosine_4.cosine * by_cosine_cost_2_2) -
        (cosine_4.sine * by_sine_cost_2_2), slope_1_yaw_change_sine, terms_4_3.q, slope_2_yaw_change_sine,
        slope_3_yaw_change_sine, x_phase_fraction_cosine - cost_2_part_2, terms_4_2.B_1, terms_4_3.by_axis_2_e);
    const hall_position_three_terms_5_t terms_8_5 = hall_position_three_terms_5(cosine_4_3.cosine_2,
        slope_1_yaw_change_sine_2, terms_5_3.q, slope_2_yaw_change_sine_2, slope_3_yaw_change_sine_2,
        x_phase_fraction_cosine_2 - cost_2_part_3, terms_5_2.B_1, terms_5_3.by_axis_2_e);
    const hall_position_three_terms_5_t terms_9_5 = hall_position_three_terms_5(cosine_4_4.cosine_2,
        slope_1_yaw_change_sine_3, terms_6_3.q, slope_2_yaw_change_sine_3, slope_3_yaw_change_sine_3,
        x_phase_fraction_cosine_3 - cost_2_part_4, terms_6_2.B_1, terms_6_3.by_axis_2_e);
    const float yaw_change_sine_part_10 = terms_7_5.terms_2 + terms_8_5.terms_2 + terms_9_5.terms_2;
    const hall_position_three_terms_t terms_6 = hall_position_three_terms(terms_7_5.by_axis_2_h * terms_7_5.by_axis_2_h,
        terms_8_5.by_axis_2_h * terms_8_5.by_axis_2_h, terms_9_5.by_axis_2_h, terms_7_5.by_axis_2_g,
        terms_8_5.by_axis_2_h, terms_8_5.by_axis_2_g, terms_7_5.by_axis_2_h, terms_9_5.by_axis_2_g);
    const float moment_6_value_9 = hall_position_three_moment(terms_7_5.terms + terms_8_5.terms + terms_9_5.terms,
        then_2_cost_2 * yaw_change_sine_part_10, terms_6.value, terms_7_5.by_axis_2_g * terms_5_3.by_axis_2_e,
        terms_8_5.by_axis_2_g * terms_4_3.by_axis_2_e, terms_6.value_2, terms_7_5.by_axis_2_g, terms_6_3.by_axis_2_e,
        terms_9_5.by_axis_2_g * terms_4_3.by_axis_2_e);
    const float yaw_change_sine_part_11 = terms_6.across * ((terms_8_5.by_axis_2_g * terms_6_3.by_axis_2_e) -
        (terms_9_5.by_axis_2_g * terms_5_3.by_axis_2_e));
    const float right_yaw_change_sine_2 = ((moment_5_value_9 + yaw_change_sine_part_9) * terms_5.value_3) +
        ((moment_6_value_9 + yaw_change_sine_part_11) * terms_6.value_3) - (yaw_damping * then_3_yaw_change_sine_2);
    float other_3_yaw_change_sine_2 = then_3_yaw_change_sine_2;
    float other_1_cost_3 = then_1_cost_2;
    float other_2_cost_3 = then_2_cost_2;
    float yaw_change_sine_part_12 = cost_2;
    if (!better_yaw_change_sine_2) {
        other_3_yaw_change_sine_2 = other_3_yaw_change_sine;
        other_1_cost_3 = other_1_cost_2;
        other_2_cost_3 = other_2_cost_2;
        yaw_change_sine_part_12 = yaw_change_sine_part_6;
    }
    const float then_3_yaw_change_sine_3 = hall_position_three_limit((better_yaw_change_sine_2) ?
        (then_3_yaw_change_sine_2 + (right_yaw_change_sine_2 / (yaw_damping + (terms_5.terms + terms_6.terms)))) : (0.5f
        * (then_3_yaw_change_sine_2 + other_3_yaw_change_sine_2)), max_yaw_step);
    const float yaw_change_sine_part_13 = then_3_yaw_change_sine_3 * then_3_yaw_change_sine_3;
    const float yaw_change_sine_3 = then_3_yaw_change_sine_3 * yaw_change_sine_polynomial(yaw_change_sine_part_13);
    const float half_yaw_change_sine_3 = then_3_yaw_change_sine_3 *
        half_yaw_change_sine_polynomial(yaw_change_sine_part_13);
    const float versine_cost_3 = half_yaw_change_sine_3 * half_yaw_change_sine_3;
    const float rotation_cosine_cost_3 = 1.0f - versine_cost_3;
    const float cost_3_part = (terms_7_4.by_axis_1_g * terms_4_2.by_axis_1_e) + (terms_8_4.by_axis_1_g *
        terms_5_2.by_axis_1_e) + (terms_9_4.by_axis_1_g * terms_6_2.by_axis_1_e);
    const float yaw_change_cost_3 = then_3_yaw_change_sine_3 - then_3_yaw_change_sine_2;
    const float then_1_cost_3 = hall_position_three_limit((better_yaw_change_sine_2) ? (then_1_cost_2 + ((cost_3_part -
        (damping * then_1_cost_2) - (yaw_change_sine_part_8 * yaw_change_cost_3)) * terms_5.value_3)) : (0.5f *
        (then_1_cost_2 + other_1_cost_3)), 0.5f);
    const float cost_3_part_2 = (x_phase_fraction_cosine * versine_cost_3) + (y_phase_fraction_cosine *
        yaw_change_sine_3);
    const float angle_cost_3 = then_1_cost_3 - cost_3_part_2;
    const float f15_argument_5 = angle_cost_3 * angle_cost_3;
    const float by_cosine_cost_3 = f15_polynomial(f15_argument_5);
    const float by_sine_cost_3 = angle_cost_3 * f16_polynomial(f15_argument_5);
    const hall_position_three_terms_2_t terms_7_2 = hall_position_three_terms_2(volts_cosine_cost_0,
        rotation_cosine_cost_3, volts_sine_cost_0, yaw_change_sine_3, cosine_1.sine * by_cosine_cost_3, cosine_1.cosine
        * by_sine_cost_3, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float cost_3_part_3 = (x_phase_fraction_cosine_2 * versine_cost_3) + (y_phase_fraction_cosine_2 *
        yaw_change_sine_3);
    const hall_position_three_cosine_2_t cosine_5_3 = hall_position_three_cosine_2(cosine_2.cosine, then_1_cost_3 -
        cost_3_part_3, cosine_2.sine);
    const hall_position_three_terms_2_t terms_8_2 = hall_position_three_terms_2(volts_cosine_cost_0_2,
        rotation_cosine_cost_3, volts_sine_cost_0_2, yaw_change_sine_3, cosine_2.sine * cosine_5_3.by_cosine,
        cosine_2.cosine * cosine_5_3.by_sine, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float cost_3_part_4 = (x_phase_fraction_cosine_3 * versine_cost_3) + (y_phase_fraction_cosine_3 *
        yaw_change_sine_3);
    const hall_position_three_cosine_3_t cosine_5_4 = hall_position_three_cosine_3(cosine_3.cosine, then_1_cost_3 -
        cost_3_part_4, cosine_3.sine);
    const hall_position_three_terms_2_t terms_9_2 = hall_position_three_terms_2(volts_cosine_cost_0_3,
        rotation_cosine_cost_3, volts_sine_cost_0_3, yaw_change_sine_3, cosine_3.sine * cosine_5_4.by_cosine,
        cosine_3.cosine * cosine_5_4.by_sine, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float cost_3_part_5 = (terms_7_5.by_axis_2_g * terms_4_3.by_axis_2_e) + (terms_8_5.by_axis_2_g *
        terms_5_3.by_axis_2_e) + (terms_9_5.by_axis_2_g * terms_6_3.by_axis_2_e);
    const float then_2_cost_3 = hall_position_three_limit((better_yaw_change_sine_2) ? (then_2_cost_2 + ((cost_3_part_5
        - (damping * then_2_cost_2) - (yaw_change_sine_part_10 * yaw_change_cost_3)) * terms_6.value_3)) : (0.5f *
        (then_2_cost_2 + other_2_cost_3)), 0.5f);
    const float dy_cost_3 = (x_phase_fraction_cosine * yaw_change_sine_3) - (y_phase_fraction_cosine * versine_cost_3);
    const float angle_cost_3_2 = then_2_cost_3 + dy_cost_3;
    const float f15_argument_6 = angle_cost_3_2 * angle_cost_3_2;
    const float by_cosine_cost_3_2 = f15_polynomial(f15_argument_6);
    const float by_sine_cost_3_2 = angle_cost_3_2 * f16_polynomial(f15_argument_6);
    const hall_position_three_terms_3_t terms_7_3 = hall_position_three_terms_3(volts_sine_cost_0,
        rotation_cosine_cost_3, volts_cosine_cost_0, yaw_change_sine_3, cosine_4.sine * by_cosine_cost_3_2,
        cosine_4.cosine * by_sine_cost_3_2, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float dy_cost_3_2 = (x_phase_fraction_cosine_2 * yaw_change_sine_3) - (y_phase_fraction_cosine_2 *
        versine_cost_3);
    const hall_position_three_cosine_2_t cosine_6_3 = hall_position_three_cosine_2(cosine_5.cosine, then_2_cost_3 +
        dy_cost_3_2, cosine_5.sine);
    const hall_position_three_terms_3_t terms_8_3 = hall_position_three_terms_3(volts_sine_cost_0_2,
        rotation_cosine_cost_3, volts_cosine_cost_0_2, yaw_change_sine_3, cosine_5.sine * cosine_6_3.by_cosine,
        cosine_5.cosine * cosine_6_3.by_sine, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float dy_cost_3_3 = (x_phase_fraction_cosine_3 * yaw_change_sine_3) - (y_phase_fraction_cosine_3 *
        versine_cost_3);
    const hall_position_three_cosine_3_t cosine_6_4 = hall_position_three_cosine_3(cosine_6.cosine, then_2_cost_3 +
        dy_cost_3_3, cosine_6.sine);
    const hall_position_three_terms_3_t terms_9_3 = hall_position_three_terms_3(volts_sine_cost_0_3,
        rotation_cosine_cost_3, volts_cosine_cost_0_3, yaw_change_sine_3, cosine_6.sine * cosine_6_4.by_cosine,
        cosine_6.cosine * cosine_6_4.by_sine, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float cost_3 = terms_7_2.terms + terms_8_2.terms + terms_9_2.terms + terms_7_3.terms + terms_8_3.terms +
        terms_9_3.terms + (damping * ((then_1_cost_3 * then_1_cost_3) + (then_2_cost_3 * then_2_cost_3) +
        (squared_yaw_arm * yaw_change_sine_part_13)));
    const bool better_yaw_change_sine_3 = cost_3 <= ((cost_factor * yaw_change_sine_part_12) + cost_slack);
    const hall_position_three_terms_4_t terms_10_4 = hall_position_three_terms_4(terms_7_3.B_2, (cosine_1.cosine *
        by_cosine_cost_3) - (cosine_1.sine * by_sine_cost_3), slope_1_yaw_change_sine, terms_7_2.phases_1_sine_squared,
        slope_2_yaw_change_sine, slope_3_yaw_change_sine, y_phase_fraction_cosine + dy_cost_3, terms_7_2.by_axis_1_e);
    const hall_position_three_terms_4_t terms_11_3 = hall_position_three_terms_4(terms_8_3.B_2, cosine_5_3.cosine_2,
        slope_1_yaw_change_sine_2, terms_8_2.phases_1_sine_squared, slope_2_yaw_change_sine_2,
        slope_3_yaw_change_sine_2, y_phase_fraction_cosine_2 + dy_cost_3_2, terms_8_2.by_axis_1_e);
    const hall_position_three_terms_4_t terms_12_3 = hall_position_three_terms_4(terms_9_3.B_2, cosine_5_4.cosine_2,
        slope_1_yaw_change_sine_3, terms_9_2.phases_1_sine_squared, slope_2_yaw_change_sine_3,
        slope_3_yaw_change_sine_3, y_phase_fraction_cosine_3 + dy_cost_3_3, terms_9_2.by_axis_1_e);
    const float yaw_change_sine_part_14 = terms_10_4.terms_2 + terms_11_3.terms_2 + terms_12_3.terms_2;
    const hall_position_three_terms_t terms_7 = hall_position_three_terms(terms_10_4.by_axis_1_h *
        terms_10_4.by_axis_1_h, terms_11_3.by_axis_1_h * terms_11_3.by_axis_1_h, terms_12_3.by_axis_1_h,
        terms_10_4.by_axis_1_g, terms_11_3.by_axis_1_h, terms_11_3.by_axis_1_g, terms_10_4.by_axis_1_h,
        terms_12_3.by_axis_1_g);
    const float moment_7_value_9 = hall_position_three_moment(terms_10_4.terms + terms_11_3.terms + terms_12_3.terms,
        then_1_cost_3 * yaw_change_sine_part_14, terms_7.value, terms_10_4.by_axis_1_g * terms_8_2.by_axis_1_e,
        terms_11_3.by_axis_1_g * terms_7_2.by_axis_1_e, terms_7.value_2, terms_10_4.by_axis_1_g, terms_9_2.by_axis_1_e,
        terms_12_3.by_axis_1_g * terms_7_2.by_axis_1_e);
    const float yaw_change_sine_part_15 = terms_7.across * ((terms_11_3.by_axis_1_g * terms_9_2.by_axis_1_e) -
        (terms_12_3.by_axis_1_g * terms_8_2.by_axis_1_e));
    const hall_position_three_terms_5_t terms_10_5 = hall_position_three_terms_5((cosine_4.cosine * by_cosine_cost_3_2)
        - (cosine_4.sine * by_sine_cost_3_2), slope_1_yaw_change_sine, terms_7_3.q, slope_2_yaw_change_sine,
        slope_3_yaw_change_sine, x_phase_fraction_cosine - cost_3_part_2, terms_7_2.B_1, terms_7_3.by_axis_2_e);
    const hall_position_three_terms_5_t terms_11_4 = hall_position_three_terms_5(cosine_6_3.cosine_2,
        slope_1_yaw_change_sine_2, terms_8_3.q, slope_2_yaw_change_sine_2, slope_3_yaw_change_sine_2,
        x_phase_fraction_cosine_2 - cost_3_part_3, terms_8_2.B_1, terms_8_3.by_axis_2_e);
    const hall_position_three_terms_5_t terms_12_4 = hall_position_three_terms_5(cosine_6_4.cosine_2,
        slope_1_yaw_change_sine_3, terms_9_3.q, slope_2_yaw_change_sine_3, slope_3_yaw_change_sine_3,
        x_phase_fraction_cosine_3 - cost_3_part_4, terms_9_2.B_1, terms_9_3.by_axis_2_e);
    const float yaw_change_sine_part_16 = terms_10_5.terms_2 + terms_11_4.terms_2 + terms_12_4.terms_2;
    const hall_position_three_terms_t terms_8 = hall_position_three_terms(terms_10_5.by_axis_2_h *
        terms_10_5.by_axis_2_h, terms_11_4.by_axis_2_h * terms_11_4.by_axis_2_h, terms_12_4.by_axis_2_h,
        terms_10_5.by_axis_2_g, terms_11_4.by_axis_2_h, terms_11_4.by_axis_2_g, terms_10_5.by_axis_2_h,
        terms_12_4.by_axis_2_g);
    const float moment_8_value_9 = hall_position_three_moment(terms_10_5.terms + terms_11_4.terms + terms_12_4.terms,
        then_2_cost_3 * yaw_change_sine_part_16, terms_8.value, terms_10_5.by_axis_2_g * terms_8_3.by_axis_2_e,
        terms_11_4.by_axis_2_g * terms_7_3.by_axis_2_e, terms_8.value_2, terms_10_5.by_axis_2_g, terms_9_3.by_axis_2_e,
        terms_12_4.by_axis_2_g * terms_7_3.by_axis_2_e);
    const float yaw_change_sine_part_17 = terms_8.across * ((terms_11_4.by_axis_2_g * terms_9_3.by_axis_2_e) -
        (terms_12_4.by_axis_2_g * terms_8_3.by_axis_2_e));
    const float right_yaw_change_sine_3 = ((moment_7_value_9 + yaw_change_sine_part_15) * terms_7.value_3) +
        ((moment_8_value_9 + yaw_change_sine_part_17) * terms_8.value_3) - (yaw_damping * then_3_yaw_change_sine_3);
    float other_3_yaw_change_sine_3 = then_3_yaw_change_sine_3;
    float other_1_cost_4 = then_1_cost_3;
    float other_2_cost_4 = then_2_cost_3;
    float converged_part = cost_3;
    if (!better_yaw_change_sine_3) {
        other_3_yaw_change_sine_3 = other_3_yaw_change_sine_2;
        other_1_cost_4 = other_1_cost_3;
        other_2_cost_4 = other_2_cost_3;
        converged_part = yaw_change_sine_part_12;
    }
    const float at_3_yaw_change_sine = hall_position_three_limit((better_yaw_change_sine_3) ? (then_3_yaw_change_sine_3
        + (right_yaw_change_sine_3 / (yaw_damping + (terms_7.terms + terms_8.terms)))) : (0.5f *
        (then_3_yaw_change_sine_3 + other_3_yaw_change_sine_3)), max_yaw_step);
    const float at_3_yaw_change_sine_squared = at_3_yaw_change_sine * at_3_yaw_change_sine;
    const float yaw_change_sine_4 = at_3_yaw_change_sine * yaw_change_sine_polynomial(at_3_yaw_change_sine_squared);
    const float half_yaw_change_sine_4 = at_3_yaw_change_sine *
        half_yaw_change_sine_polynomial(at_3_yaw_change_sine_squared);
    const float versine_cost_4 = half_yaw_change_sine_4 * half_yaw_change_sine_4;
    const float rotation_cosine_cost_4 = 1.0f - versine_cost_4;
    const float cost_4_part = (terms_10_4.by_axis_1_g * terms_7_2.by_axis_1_e) + (terms_11_3.by_axis_1_g *
        terms_8_2.by_axis_1_e) + (terms_12_3.by_axis_1_g * terms_9_2.by_axis_1_e);
    const float yaw_change_cost_4 = at_3_yaw_change_sine - then_3_yaw_change_sine_3;
    const float at_1_cost_4 = hall_position_three_limit((better_yaw_change_sine_3) ? (then_1_cost_3 + ((cost_4_part -
        (damping * then_1_cost_3) - (yaw_change_sine_part_14 * yaw_change_cost_4)) * terms_7.value_3)) : (0.5f *
        (then_1_cost_3 + other_1_cost_4)), 0.5f);
    const float cost_4_part_2 = (x_phase_fraction_cosine * versine_cost_4) + (y_phase_fraction_cosine *
        yaw_change_sine_4);
    const float angle_cost_4 = at_1_cost_4 - cost_4_part_2;
    const float f15_argument_7 = angle_cost_4 * angle_cost_4;
    const float by_cosine_cost_4 = f15_polynomial(f15_argument_7);
    const float by_sine_cost_4 = angle_cost_4 * f16_polynomial(f15_argument_7);
    const hall_position_three_terms_2_t terms_10_2 = hall_position_three_terms_2(volts_cosine_cost_0,
        rotation_cosine_cost_4, volts_sine_cost_0, yaw_change_sine_4, cosine_1.sine * by_cosine_cost_4, cosine_1.cosine
        * by_sine_cost_4, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float cost_4_part_3 = (x_phase_fraction_cosine_2 * versine_cost_4) + (y_phase_fraction_cosine_2 *
        yaw_change_sine_4);
    const hall_position_three_cosine_2_t cosine_7_2 = hall_position_three_cosine_2(cosine_2.cosine, at_1_cost_4 -
        cost_4_part_3, cosine_2.sine);
    const hall_position_three_terms_2_t terms_11 = hall_position_three_terms_2(volts_cosine_cost_0_2,
        rotation_cosine_cost_4, volts_sine_cost_0_2, yaw_change_sine_4, cosine_2.sine * cosine_7_2.by_cosine,
        cosine_2.cosine * cosine_7_2.by_sine, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float cost_4_part_4 = (x_phase_fraction_cosine_3 * versine_cost_4) + (y_phase_fraction_cosine_3 *
        yaw_change_sine_4);
    const hall_position_three_cosine_3_t cosine_7_3 = hall_position_three_cosine_3(cosine_3.cosine, at_1_cost_4 -
        cost_4_part_4, cosine_3.sine);
    const hall_position_three_terms_2_t terms_12 = hall_position_three_terms_2(volts_cosine_cost_0_3,
        rotation_cosine_cost_4, volts_sine_cost_0_3, yaw_change_sine_4, cosine_3.sine * cosine_7_3.by_cosine,
        cosine_3.cosine * cosine_7_3.by_sine, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float cost_4_part_5 = (terms_10_5.by_axis_2_g * terms_7_3.by_axis_2_e) + (terms_11_4.by_axis_2_g *
        terms_8_3.by_axis_2_e) + (terms_12_4.by_axis_2_g * terms_9_3.by_axis_2_e);
    const float at_2_cost_4 = hall_position_three_limit((better_yaw_change_sine_3) ? (then_2_cost_3 + ((cost_4_part_5 -
        (damping * then_2_cost_3) - (yaw_change_sine_part_16 * yaw_change_cost_4)) * terms_8.value_3)) : (0.5f *
        (then_2_cost_3 + other_2_cost_4)), 0.5f);
    const float dy_cost_4 = (x_phase_fraction_cosine * yaw_change_sine_4) - (y_phase_fraction_cosine * versine_cost_4);
    const float angle_cost_4_2 = at_2_cost_4 + dy_cost_4;
    const float f15_argument_8 = angle_cost_4_2 * angle_cost_4_2;
    const float by_cosine_cost_4_2 = f15_polynomial(f15_argument_8);
    const float by_sine_cost_4_2 = angle_cost_4_2 * f16_polynomial(f15_argument_8);
    const hall_position_three_terms_3_t terms_10_3 = hall_position_three_terms_3(volts_sine_cost_0,
        rotation_cosine_cost_4, volts_cosine_cost_0, yaw_change_sine_4, cosine_4.sine * by_cosine_cost_4_2,
        cosine_4.cosine * by_sine_cost_4_2, field_2_cost_0, field_3_cost_0, field_4_cost_0);
    const float dy_cost_4_2 = (x_phase_fraction_cosine_2 * yaw_change_sine_4) - (y_phase_fraction_cosine_2 *
        versine_cost_4);
    const hall_position_three_cosine_2_t cosine_8_2 = hall_position_three_cosine_2(cosine_5.cosine, at_2_cost_4 +
        dy_cost_4_2, cosine_5.sine);
    const hall_position_three_terms_3_t terms_11_2 = hall_position_three_terms_3(volts_sine_cost_0_2,
        rotation_cosine_cost_4, volts_cosine_cost_0_2, yaw_change_sine_4, cosine_5.sine * cosine_8_2.by_cosine,
        cosine_5.cosine * cosine_8_2.by_sine, field_2_cost_0_2, field_3_cost_0_2, field_4_cost_0_2);
    const float dy_cost_4_3 = (x_phase_fraction_cosine_3 * yaw_change_sine_4) - (y_phase_fraction_cosine_3 *
        versine_cost_4);
    const hall_position_three_cosine_3_t cosine_8_3 = hall_position_three_cosine_3(cosine_6.cosine, at_2_cost_4 +
        dy_cost_4_3, cosine_6.sine);
    const hall_position_three_terms_3_t terms_12_2 = hall_position_three_terms_3(volts_sine_cost_0_3,
        rotation_cosine_cost_4, volts_cosine_cost_0_3, yaw_change_sine_4, cosine_6.sine * cosine_8_3.by_cosine,
        cosine_6.cosine * cosine_8_3.by_sine, field_2_cost_0_3, field_3_cost_0_3, field_4_cost_0_3);
    const float squares_cost_4 = terms_10_2.terms + terms_11.terms + terms_12.terms + terms_10_3.terms +
        terms_11_2.terms + terms_12_2.terms;
    const float cost_4_part_6 = (at_1_cost_4 * at_1_cost_4) + (at_2_cost_4 * at_2_cost_4);
    const float cost_4 = squares_cost_4 + (damping * (cost_4_part_6 + (squared_yaw_arm *
        at_3_yaw_change_sine_squared)));
    const float freedom = (excluded_1 || excluded_2 || excluded_3) ? 1.0f : 3.0f;
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const uint32_t estimator_residual_faults = state->estimator_residual_faults;
    const float growing_gate = innovation_gate + (innovation_gate * (float)estimator_residual_faults);
    const bool gate_exceeded = (growing_gate * growing_gate) < (cost_4_part_6 + (squared_radius *
        at_3_yaw_change_sine_squared));
    const bool better_converged = cost_4 <= ((cost_factor * converged_part) + cost_slack);
    const hall_position_three_terms_4_t terms_13 = hall_position_three_terms_4(terms_10_3.B_2, (cosine_1.cosine *
        by_cosine_cost_4) - (cosine_1.sine * by_sine_cost_4), slope_1_yaw_change_sine, terms_10_2.phases_1_sine_squared,
        slope_2_yaw_change_sine, slope_3_yaw_change_sine, y_phase_fraction_cosine + dy_cost_4, terms_10_2.by_axis_1_e);
    const hall_position_three_terms_4_t terms_14 = hall_position_three_terms_4(terms_11_2.B_2, cosine_7_2.cosine_2,
        slope_1_yaw_change_sine_2, terms_11.phases_1_sine_squared, slope_2_yaw_change_sine_2, slope_3_yaw_change_sine_2,
        y_phase_fraction_cosine_2 + dy_cost_4_2, terms_11.by_axis_1_e);
    const hall_position_three_terms_4_t terms_15 = hall_position_three_terms_4(terms_12_2.B_2, cosine_7_3.cosine_2,
        slope_1_yaw_change_sine_3, terms_12.phases_1_sine_squared, slope_2_yaw_change_sine_3, slope_3_yaw_change_sine_3,
        y_phase_fraction_cosine_3 + dy_cost_4_3, terms_12.by_axis_1_e);
    const float axes_1_coupling_converged = terms_13.terms_2 + terms_14.terms_2 + terms_15.terms_2;
    const hall_position_three_terms_t terms_9 = hall_position_three_terms(terms_13.by_axis_1_h * terms_13.by_axis_1_h,
        terms_14.by_axis_1_h * terms_14.by_axis_1_h, terms_15.by_axis_1_h, terms_13.by_axis_1_g, terms_14.by_axis_1_h,
        terms_14.by_axis_1_g, terms_13.by_axis_1_h, terms_15.by_axis_1_g);
    const float moment_9_value_9 = hall_position_three_moment(terms_13.terms + terms_14.terms + terms_15.terms,
        at_1_cost_4 * axes_1_coupling_converged, terms_9.value, terms_13.by_axis_1_g * terms_11.by_axis_1_e,
        terms_14.by_axis_1_g * terms_10_2.by_axis_1_e, terms_9.value_2, terms_13.by_axis_1_g, terms_12.by_axis_1_e,
        terms_15.by_axis_1_g * terms_10_2.by_axis_1_e);
    const float converged_part_2 = terms_9.across * ((terms_14.by_axis_1_g * terms_12.by_axis_1_e) -
        (terms_15.by_axis_1_g * terms_11.by_axis_1_e));
    const hall_position_three_terms_5_t terms_13_2 = hall_position_three_terms_5((cosine_4.cosine * by_cosine_cost_4_2)
        - (cosine_4.sine * by_sine_cost_4_2), slope_1_yaw_change_sine, terms_10_3.q, slope_2_yaw_change_sine,
        slope_3_yaw_change_sine, x_phase_fraction_cosine - cost_4_part_2, terms_10_2.B_1, terms_10_3.by_axis_2_e);
    const hall_position_three_terms_5_t terms_14_2 = hall_position_three_terms_5(cosine_8_2.cosine_2,
        slope_1_yaw_change_sine_2, terms_11_2.q, slope_2_yaw_change_sine_2, slope_3_yaw_change_sine_2,
        x_phase_fraction_cosine_2 - cost_4_part_3, terms_11.B_1, terms_11_2.by_axis_2_e);
    const hall_position_three_terms_5_t terms_15_2 = hall_position_three_terms_5(cosine_8_3.cosine_2,
        slope_1_yaw_change_sine_3, terms_12_2.q, slope_2_yaw_change_sine_3, slope_3_yaw_change_sine_3,
        x_phase_fraction_cosine_3 - cost_4_part_4, terms_12.B_1, terms_12_2.by_axis_2_e);
    const float n_coupling = terms_13_2.terms_2 + terms_14_2.terms_2 + terms_15_2.terms_2;
    const hall_position_three_terms_t terms_10 = hall_position_three_terms(terms_13_2.by_axis_2_h *
        terms_13_2.by_axis_2_h, terms_14_2.by_axis_2_h * terms_14_2.by_axis_2_h, terms_15_2.by_axis_2_h,
        terms_13_2.by_axis_2_g, terms_14_2.by_axis_2_h, terms_14_2.by_axis_2_g, terms_13_2.by_axis_2_h,
        terms_15_2.by_axis_2_g);
    const float moment_10_value_9 = hall_position_three_moment(terms_13_2.terms + terms_14_2.terms + terms_15_2.terms,
        at_2_cost_4 * n_coupling, terms_10.value, terms_13_2.by_axis_2_g * terms_11_2.by_axis_2_e,
        terms_14_2.by_axis_2_g * terms_10_3.by_axis_2_e, terms_10.value_2, terms_13_2.by_axis_2_g,
        terms_12_2.by_axis_2_e, terms_15_2.by_axis_2_g * terms_10_3.by_axis_2_e);
    const float converged_part_3 = terms_10.across * ((terms_14_2.by_axis_2_g * terms_12_2.by_axis_2_e) -
        (terms_15_2.by_axis_2_g * terms_11_2.by_axis_2_e));
    const float right_converged = ((moment_9_value_9 + converged_part_2) * terms_9.value_3) + ((moment_10_value_9 +
        converged_part_3) * terms_10.value_3) - (yaw_damping * at_3_yaw_change_sine);
    const float data_converged = terms_9.terms + terms_10.terms;
    const float converged_part_4 = 1.0f / (yaw_damping + data_converged);
    const float converged_part_5 = (terms_13.by_axis_1_g * terms_10_2.by_axis_1_e) + (terms_14.by_axis_1_g *
        terms_11.by_axis_1_e) + (terms_15.by_axis_1_g * terms_12.by_axis_1_e);
    const float axes_1_slope_converged = converged_part_5 - (damping * at_1_cost_4);
    const float converged_part_6 = (terms_13_2.by_axis_2_g * terms_10_3.by_axis_2_e) + (terms_14_2.by_axis_2_g *
        terms_11_2.by_axis_2_e) + (terms_15_2.by_axis_2_g * terms_12_2.by_axis_2_e);
    const float n_slope = converged_part_6 - (damping * at_2_cost_4);
    const bool converged = better_converged && (((right_converged * right_converged * converged_part_4) +
        (axes_1_slope_converged * axes_1_slope_converged * terms_9.value_3) + (n_slope * n_slope * terms_10.value_3)) <=
        cost_slack);
    float at_3_yaw_change_sine_2;
    float at_1_X;
    float at_2_Y;
    if (converged) {
        const float untried_3 = hall_position_three_limit(at_3_yaw_change_sine + (right_converged * converged_part_4),
            max_yaw_step);
        at_3_yaw_change_sine_2 = untried_3;
        const float yaw_change_X = untried_3 - at_3_yaw_change_sine;
        at_1_X = hall_position_three_limit(at_1_cost_4 + ((axes_1_slope_converged - (axes_1_coupling_converged *
            yaw_change_X)) * terms_9.value_3), 0.5f);
        at_2_Y = hall_position_three_limit(at_2_cost_4 + ((n_slope - (n_coupling * yaw_change_X)) * terms_10.value_3),
            0.5f);
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
        lost_yaw_change_sine = (estimator_searching != 0u) && !(fabsf(prediction_yaw + at_3_yaw_change_sine_2 -
            estimator_yaw_last_good) <= yaw_window);
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
    const float by_cosine_X = 1.0f - (half_yaw_change_sine_5 * half_yaw_change_sine_5);
    const float cosine = (heading_cosine * by_cosine_X) - (heading_sine * yaw_change_sine_5);
    const float sine = (heading_sine * by_cosine_X) + (heading_cosine * yaw_change_sine_5);
    const float lever_cosine = (centre_x * cosine) + (-centre_y * sine);
    const float X = (metre_per_rad * pose_phase_x) + (pitch * pose_pitch_x) - lever_cosine;
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
    const float deviation_X_part = axes_1_coupling_converged * terms_9.value_3;
    const float by_yaw_X = deviation_X_part - (wave_number * lever_sine);
    const float yaw_deviation_X = 1.0f / (data_converged + undamped_yaw);
    const float deviation_X = deviation_over_w * sqrtf(terms_9.value_3 + (by_yaw_X * by_yaw_X * yaw_deviation_X));
    const float n_coupling_times_value_3 = n_coupling * terms_10.value_3;
    const float by_yaw_Y = n_coupling_times_value_3 + (wave_number * lever_cosine);
    const float deviation_Y = deviation_over_w * sqrtf(terms_10.value_3 + (by_yaw_Y * by_yaw_Y * yaw_deviation_X));
    const float deviation_yaw = deviation * sqrtf(yaw_deviation_X);
    const float residual = sqrtf(least_square + (squares_cost_4 / freedom));
    const float weight = ((squared_radius + (deviation_X_part * deviation_X_part) + (n_coupling_times_value_3 *
        n_coupling_times_value_3)) * yaw_deviation_X) + (terms_9.value_3 + terms_10.value_3);
    const bool damped = damped_weight < weight;
    const bool integrity_good = converged && !(damped || integrity_residual_fault || gate_exceeded);
    const bool counted = (fabsf(pose_pitch_x) <= 8.0f) && (fabsf(pose_pitch_y) <= 8.0f);
    const float size = fabsf(yaw);
    const bool accepted = counted && (size <= yaw_limit);
    const bool resolved_valid = (integrity_good && ((hall_position_three_flag(excluded_1) +
        hall_position_three_flag(excluded_2) + hall_position_three_flag(excluded_3)) < 1u) && (weight <=
        unambiguous_weight) && tracking && accepted) || ((estimator_ambiguity_resolved != 0u) && !damped);
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
        const float others = hall_position_three_min(squares_2, squares_1) + hall_position_three_min(square,
            squares_2_max_squares_1);
        if (integrity_residual_fault && ((squared_inconsistent * freedom) < squares_cost_4) &&
                (estimator_ambiguity_resolved != 0u) && (1u <= estimator_residual_faults) && (others <= others_agree) &&
                ((contrast * others) <= hall_position_three_max(square, squares_2_max_squares_1))) {
            state->estimator_excluded_sensor = (uint32_t)((squares_2_max_squares_1 < square) ? 3.0f : ((squares_1 <
                squares_2) ? 2.0f : 1.0f));
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
    state->estimator_residual_faults = (integrity_residual_fault) ? ((exhausted) ? 0u : (estimator_residual_faults +
        1u)) : 0u;
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
