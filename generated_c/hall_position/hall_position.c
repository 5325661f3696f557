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

static inline float hall_position_max(float a, float b)
{
    return (a > b) ? a : b;
}

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
#if defined(__OPTIMIZE_SIZE__)
#define HALL_POSITION_LARGE static inline
#else
#define HALL_POSITION_LARGE HALL_POSITION_INLINE
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

/* sin(0.25 * x) / x; x = estimator_yaw + estimator_motion_yaw in -3.2425952 .. 3.2425952, t = x^2; relative error at
 * most 1.2e-07. */
static inline float sine_polynomial(float t)
{
    return 0.25f + (t * (-0.0026041644f + (t * (8.136728e-06f + (t * -1.1898613e-08f)))));
}

/* yaw_part_cosine; x = estimator_yaw + estimator_motion_yaw in -3.2425952 .. 3.2425952, t = x^2; relative error at most
 * 1.4e-07. */
static inline float yaw_part_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.031249868f + (t * (0.00016270365f + (t * -3.3090393e-07f)))));
}

/* sin(0.125 * x) / x; x = clamp((((estimator_phase_x + estimator_motion_x) - (2.35619449 * (1 - (...)))) + (2.35619449
 * * clamp(((...) * (...)), -1, 1))), -6.97375486, 6.97375486) and 3 others in -6.97375488 .. 6.97375488, t = x^2;
 * relative error at most 1.2e-07. */
static inline float sine_2_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552038f + (t * (2.5425797e-07f + (t * -9.268511e-11f)))));
}

/* part_cosine; x = clamp((((estimator_phase_x + estimator_motion_x) - (2.35619449 * (1 - (...)))) + (2.35619449 *
 * clamp(((...) * (...)), -1, 1))), -6.97375486, 6.97375486) and 3 others in -6.97375488 .. 6.97375488, t = x^2;
 * relative error at most 1.1e-07. */
static inline float part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.0078125f + (t * (1.0172516e-05f + (t * (-5.2972737e-09f + (t * 1.4511657e-12f)))))));
}

/* sin(x) / x; x = clamp(((((...) - (...)) - ((...) * (...))) / max(((...) + (...)), 2.75466335)), -0.101002539,
 * 0.101002539) and 3 others in -0.101002537 .. 0.101002537, t = x^2; relative error at most 1.2e-07. */
static inline float sine_3_polynomial(float t)
{
    return 1.0f + (t * (-0.16666666f + (t * 0.008330399f)));
}

/* tan(0.5 * x) / x; x = clamp(((((...) - (...)) - ((...) * (...))) / max(((...) + (...)), 2.75466335)), -0.101002539,
 * 0.101002539) and 3 others in -0.101002537 .. 0.101002537, t = x^2; relative error at most 1.2e-07. */
static inline float tangent_polynomial(float t)
{
    return 0.5f + (t * (0.04166665f + (t * 0.004172491f)));
}

/* cos(x); x = clamp(((clamp((...), -0.5, 0.5) - (2.35619449 * (...))) + (2.35619449 * clamp((...), -0.101002539,
 * 0.101002539))), -0.975963252, 0.975963252) and 15 others in -0.975963235 .. 0.975963235, t = x^2; relative error at
 * most 1.3e-07. */
static inline float cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666433f + (t * (-0.001388265f + (t * 2.4109138e-05f)))))));
}

/* sin(x) / x; x = clamp(((clamp((...), -0.5, 0.5) - (2.35619449 * (...))) + (2.35619449 * clamp((...), -0.101002539,
 * 0.101002539))), -0.975963252, 0.975963252) and 15 others in -0.975963235 .. 0.975963235, t = x^2; relative error at
 * most 1.2e-07. */
static inline float sine_4_polynomial(float t)
{
    return 1.0f + (t * (-0.16666621f + (t * (0.008330503f + (t * -0.00019336317f)))));
}

/* guard: range acceptance, hold, latch */
HALL_POSITION_INLINE uint32_t hall_position_guard(hall_position_guard_state_t *state, bool complete,
    uint32_t latched_before)
{
    static const uint32_t latch_samples = 5u;                   /* 1; bad samples in a row until it latches */

    uint32_t latched = latched_before;
    if (complete) {
        state->left = latch_samples;
        state->ready = 1u;
    } else {
        const uint32_t left = state->left;
        if (left <= 1u) {
            latched = 1u;
        } else {
            state->left = left - 1u;
        }
    }
    return latched;
}

typedef struct {
    float phasor_cosine;
    float phasor_sine;
} hall_position_estimator_phasor_t;

/* phasor_ax, phasor_ay, phasor_bx, phasor_by */
HALL_POSITION_INLINE hall_position_estimator_phasor_t hall_position_estimator_phasor(float limited)
{
    const float ax_part_cosine_argument = limited * limited;
    const float sine_2 = limited * sine_2_polynomial(ax_part_cosine_argument);
    const float ax_part_sine = 8.0f * sine_2;
    const float ax_part_cosine = part_cosine_polynomial(ax_part_cosine_argument);
    const float sine_2_times_ax_part_cosine = sine_2 * ax_part_cosine;
    const float ax_part_doubled = 8.0f *
        (sine_2_times_ax_part_cosine * (1.0f - (0.03125f * (ax_part_sine * ax_part_sine))));
    /*@ admit -2.002f <= ax_part_doubled <= 2.002f; */
    const float sines_ax_part_2 = 8.0f * sine_2_times_ax_part_cosine;
    const float phasor_sine = ax_part_doubled * (1.0f - (0.125f * (sines_ax_part_2 * sines_ax_part_2)));
    /*@ admit -1.001f <= phasor_sine <= 1.001f; */
    return (hall_position_estimator_phasor_t){.phasor_cosine = 1.0f - (0.5f * (ax_part_doubled * ax_part_doubled)),
        .phasor_sine = phasor_sine};
}

typedef struct {
    float ax_part_cosine_sum;
    float ax_part_cosine_product;
    float ax_part_cosine_limited;
    float ax_part_cosine_product_2;
    float phasor_ax_cosine;
    float ax_part_full;
    float phasor_ay_cosine;
    float ay_part_full;
    float phasor_bx_cosine;
    float bx_part_full;
    float phasor_by_cosine;
    float by_part_full;
} hall_position_estimator_prediction_t;

/* prediction */
HALL_POSITION_INLINE hall_position_estimator_prediction_t hall_position_estimator_prediction(float prediction_phase_x,
    float prediction_yaw, float prediction_phase_y)
{
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;
    static const float largest_phase = 6.973755f;               /* rad; largest size of a phase; of ax, ay, bx, by */

    const float yaw_part_cosine_argument = prediction_yaw * prediction_yaw;
    const float sine = prediction_yaw * sine_polynomial(yaw_part_cosine_argument);
    const float yaw_part_sine = 4.0f * sine;
    const float yaw_part_cosine = yaw_part_cosine_polynomial(yaw_part_cosine_argument);
    const float ax_part_cosine_sum_limited = hall_position_limit(4.0f * (sine * yaw_part_cosine), 2.0f);
    const float ax_part_cosine_sum = 1.0f - (0.5f * (ax_part_cosine_sum_limited * ax_part_cosine_sum_limited));
    const float ax_part_cosine_product = arm * ax_part_cosine_sum;
    const float ax_part_cosine_limited = hall_position_limit(ax_part_cosine_sum_limited * (1.0f -
        (0.125f * (yaw_part_sine * yaw_part_sine))), 1.0f);
    const float ax_part_cosine_product_2 = arm * ax_part_cosine_limited;
    const hall_position_estimator_phasor_t phasor_ax =
        hall_position_estimator_phasor(hall_position_limit(prediction_phase_x - ax_part_cosine_product +
        ax_part_cosine_product_2, largest_phase));
    const hall_position_estimator_phasor_t phasor_ay =
        hall_position_estimator_phasor(hall_position_limit(prediction_phase_y - ax_part_cosine_product -
        ax_part_cosine_product_2, largest_phase));
    const hall_position_estimator_phasor_t phasor_bx =
        hall_position_estimator_phasor(hall_position_limit(prediction_phase_x + ax_part_cosine_product -
        ax_part_cosine_product_2, largest_phase));
    const hall_position_estimator_phasor_t phasor_by =
        hall_position_estimator_phasor(hall_position_limit(prediction_phase_y + ax_part_cosine_product +
        ax_part_cosine_product_2, largest_phase));
    return (hall_position_estimator_prediction_t){.ax_part_cosine_sum = ax_part_cosine_sum,
        .ax_part_cosine_product = ax_part_cosine_product, .ax_part_cosine_limited = ax_part_cosine_limited,
        .ax_part_cosine_product_2 = ax_part_cosine_product_2, .phasor_ax_cosine = phasor_ax.phasor_cosine,
        .ax_part_full = phasor_ax.phasor_sine, .phasor_ay_cosine = phasor_ay.phasor_cosine, .ay_part_full =
        phasor_ay.phasor_sine, .phasor_bx_cosine = phasor_bx.phasor_cosine, .bx_part_full = phasor_bx.phasor_sine,
        .phasor_by_cosine = phasor_by.phasor_cosine, .by_part_full = phasor_by.phasor_sine};
}

typedef struct {
    float value;
    float residuals_1;
    float residuals_2;
    float rows_1_1;
    float rows_1_3;
    float rows_2_2;
} hall_position_estimator_sensor_1_t;

/* sensor_1 */
HALL_POSITION_INLINE hall_position_estimator_sensor_1_t hall_position_estimator_sensor_1(float ax_part_cosine_sum,
    float V_ax_held, float ax_part_cosine_limited, float V_ay_held, float ax_part_full, float ay_part_full,
    float phasor_ax_cosine, float field_3_scaled, float ax_part_cosine_product, float ax_part_cosine_product_2,
    float phasor_ay_cosine)
{
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */

    const float ax_part_full_squared = ax_part_full * ax_part_full;
    const float value_product = ax_part_full_squared * field_5;
    const float value = ax_part_full * (field_1 + (ax_part_full_squared * (field_3 + value_product)));
    const float ay_part_full_squared = ay_part_full * ay_part_full;
    const float residuals_2_product = ay_part_full_squared * field_5;
    const float residuals_2_product_2 = ay_part_full * (field_1 +
        (ay_part_full_squared * (field_3 + residuals_2_product)));
    const float rows_1_1 = phasor_ax_cosine * (field_1 +
        (ax_part_full_squared * (field_3_scaled + (5.0f * value_product))));
    return (hall_position_estimator_sensor_1_t){.value = value, .residuals_1 = (ax_part_cosine_sum * V_ax_held) -
        (ax_part_cosine_limited * V_ay_held) - value, .residuals_2 = (ax_part_cosine_sum * V_ay_held) +
        (ax_part_cosine_limited * V_ax_held) - residuals_2_product_2, .rows_1_1 = rows_1_1, .rows_1_3 = (rows_1_1 *
        (ax_part_cosine_product + ax_part_cosine_product_2)) + residuals_2_product_2, .rows_2_2 = phasor_ay_cosine *
        (field_1 + (ay_part_full_squared * (field_3_scaled + (5.0f * residuals_2_product))))};
}

typedef struct {
    float value;
    float residuals_3;
    float residuals_4;
    float rows_3_1;
    float rows_3_3;
    float rows_4_2;
} hall_position_estimator_sensor_2_t;

/* sensor_2 */
HALL_POSITION_INLINE hall_position_estimator_sensor_2_t hall_position_estimator_sensor_2(float ax_part_cosine_sum,
    float V_bx_held, float ax_part_cosine_limited, float V_by_held, float bx_part_full, float by_part_full,
    float phasor_bx_cosine, float field_3_scaled, float ax_part_cosine_product_2, float phasor_by_cosine)
{
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;

    const float bx_part_full_squared = bx_part_full * bx_part_full;
    const float value_product = bx_part_full_squared * field_5;
    const float value = bx_part_full * (field_1 + (bx_part_full_squared * (field_3 + value_product)));
    const float by_part_full_squared = by_part_full * by_part_full;
    const float residuals_4_product = by_part_full_squared * field_5;
    const float residuals_4_product_2 = by_part_full * (field_1 +
        (by_part_full_squared * (field_3 + residuals_4_product)));
    const float rows_3_1 = phasor_bx_cosine * (field_1 +
        (bx_part_full_squared * (field_3_scaled + (5.0f * value_product))));
    return (hall_position_estimator_sensor_2_t){.value = value, .residuals_3 = (ax_part_cosine_sum * V_bx_held) -
        (ax_part_cosine_limited * V_by_held) - value, .residuals_4 = (ax_part_cosine_sum * V_by_held) +
        (ax_part_cosine_limited * V_bx_held) - residuals_4_product_2, .rows_3_1 = rows_3_1, .rows_3_3 = (rows_3_1 *
        ((-arm * ax_part_cosine_sum) - ax_part_cosine_product_2)) + residuals_4_product_2, .rows_4_2 =
        phasor_by_cosine * (field_1 + (by_part_full_squared * (field_3_scaled + (5.0f * residuals_4_product))))};
}

typedef struct {
    float left_3_1;
    float value;
    float lower_3_1;
    float minus_rows_2_3;
    float minus_rows_4_3;
    float minus_left_3_2;
    float value_2;
    float lower_3_2;
} hall_position_estimator_factors_t;

/* factors */
HALL_POSITION_INLINE hall_position_estimator_factors_t hall_position_estimator_factors(float rows_1_3, float rows_1_1,
    float rows_3_3, float rows_3_1, float lowest_product, float rows_2_2, float ax_part_cosine_product_2,
    float ax_part_cosine_product, float lowest_product_2, float rows_4_2)
{
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.0100383 rad of the prior; of x, y */
    static const float prior_weight_phase = 0.00992376f;
    static const float largest_L_yaw_phase = 8330.405f;         /* 1; bound of L in row yaw; of x, y */

    const float left_3_1 = (rows_1_3 * rows_1_1) + (rows_3_3 * rows_3_1);
    const float value = 1.0f / ((rows_1_1 * rows_1_1) + (rows_3_1 * rows_3_1) + prior_weight_phase);
    const float minus_rows_2_3 = lowest_product - (rows_2_2 * (ax_part_cosine_product_2 - ax_part_cosine_product));
    const float minus_rows_4_3 = lowest_product_2 - (rows_4_2 * (ax_part_cosine_product - ax_part_cosine_product_2));
    const float minus_left_3_2 = (minus_rows_2_3 * rows_2_2) + (minus_rows_4_3 * rows_4_2);
    const float value_2 = 1.0f / ((rows_2_2 * rows_2_2) + (rows_4_2 * rows_4_2) + prior_weight_phase);
    return (hall_position_estimator_factors_t){.left_3_1 = left_3_1, .value = value,
        .lower_3_1 = hall_position_limit(left_3_1 * value, largest_L_yaw_phase), .minus_rows_2_3 = minus_rows_2_3,
        .minus_rows_4_3 = minus_rows_4_3, .minus_left_3_2 = minus_left_3_2, .value_2 = value_2,
        .lower_3_2 = hall_position_limit(-(minus_left_3_2 * value_2), largest_L_yaw_phase)};
}

typedef struct {
    float lowest;
    float field_3_scaled;
    float rows_1_3;
    float rows_3_3;
    float left_3_1;
    float value;
    float lower_3_1;
    float minus_rows_2_3;
    float minus_rows_4_3;
    float minus_left_3_2;
    float value_2;
    float lower_3_2;
    float forward_1;
    float forward_2;
    float forward_3;
} hall_position_estimator_first_trial_t;

/* first_trial */
HALL_POSITION_INLINE hall_position_estimator_first_trial_t
    hall_position_estimator_first_trial(const hall_position_estimator_prediction_t *prediction, float V_ax_held,
    float V_ay_held, float V_bx_held, float V_by_held)
{
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */

    const float field_3_scaled = 3.0f * field_3;
    const hall_position_estimator_sensor_1_t sensor_1 = hall_position_estimator_sensor_1(prediction->ax_part_cosine_sum,
        V_ax_held, prediction->ax_part_cosine_limited, V_ay_held, prediction->ax_part_full, prediction->ay_part_full,
        prediction->phasor_ax_cosine, field_3_scaled, prediction->ax_part_cosine_product,
        prediction->ax_part_cosine_product_2, prediction->phasor_ay_cosine);
    const hall_position_estimator_sensor_2_t sensor_2 = hall_position_estimator_sensor_2(prediction->ax_part_cosine_sum,
        V_bx_held, prediction->ax_part_cosine_limited, V_by_held, prediction->bx_part_full, prediction->by_part_full,
        prediction->phasor_bx_cosine, field_3_scaled, prediction->ax_part_cosine_product_2,
        prediction->phasor_by_cosine);
    const hall_position_estimator_factors_t factors = hall_position_estimator_factors(sensor_1.rows_1_3,
        sensor_1.rows_1_1, sensor_2.rows_3_3, sensor_2.rows_3_1, sensor_1.value, sensor_1.rows_2_2,
        prediction->ax_part_cosine_product_2, prediction->ax_part_cosine_product, sensor_2.value, sensor_2.rows_4_2);
    const float forward_1 = (sensor_1.rows_1_1 * sensor_1.residuals_1) + (sensor_2.rows_3_1 * sensor_2.residuals_3);
    const float forward_2 = (sensor_1.rows_2_2 * sensor_1.residuals_2) + (sensor_2.rows_4_2 * sensor_2.residuals_4);
    return (hall_position_estimator_first_trial_t){.lowest = (sensor_1.residuals_1 * sensor_1.residuals_1) +
        (sensor_1.residuals_2 * sensor_1.residuals_2) + (sensor_2.residuals_3 * sensor_2.residuals_3) +
        (sensor_2.residuals_4 * sensor_2.residuals_4), .field_3_scaled = field_3_scaled, .rows_1_3 = sensor_1.rows_1_3,
        .rows_3_3 = sensor_2.rows_3_3, .left_3_1 = factors.left_3_1, .value = factors.value,
        .lower_3_1 = factors.lower_3_1, .minus_rows_2_3 = factors.minus_rows_2_3,
        .minus_rows_4_3 = factors.minus_rows_4_3, .minus_left_3_2 = factors.minus_left_3_2, .value_2 = factors.value_2,
        .lower_3_2 = factors.lower_3_2, .forward_1 = forward_1, .forward_2 = forward_2,
        .forward_3 = (sensor_1.rows_1_3 * sensor_1.residuals_1) - (factors.minus_rows_2_3 * sensor_1.residuals_2) +
        (sensor_2.rows_3_3 * sensor_2.residuals_3) - (factors.minus_rows_4_3 * sensor_2.residuals_4) -
        (factors.lower_3_1 * forward_1) - (factors.lower_3_2 * forward_2)};
}

typedef struct {
    float offsets_3;
    float offsets_1;
    float offsets_2;
} hall_position_estimator_correction_t;

/* correction */
HALL_POSITION_INLINE hall_position_estimator_correction_t hall_position_estimator_correction(float forward_1_2,
    float converged_inverse, float lower_3_1_2, float forward_3_2, float rows_1_3_2, float minus_rows_2_3_2,
    float rows_3_3_2, float minus_rows_4_3_2, float left_3_1_2, float lower_3_2_2, float minus_left_3_2_2,
    float forward_2_2, float converged_inverse_2)
{
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad of the prior */
    static const float prior_weight_yaw = 2.7546635f;
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad, the largest */
    static const float least_pivot_yaw = 2.7546635f;
    static const float largest_step_yaw = 0.10100254f;          /* rad; correction of a sample at most */
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */

    const float left_3_3 = (rows_1_3_2 * rows_1_3_2) + (minus_rows_2_3_2 * minus_rows_2_3_2) +
        (rows_3_3_2 * rows_3_3_2) + (minus_rows_4_3_2 * minus_rows_4_3_2) + prior_weight_yaw -
        (lower_3_1_2 * left_3_1_2) + (lower_3_2_2 * minus_left_3_2_2);
    const float offsets_3 = hall_position_limit(forward_3_2 / hall_position_max(left_3_3, least_pivot_yaw),
        largest_step_yaw);
    return (hall_position_estimator_correction_t){.offsets_3 = offsets_3, .offsets_1 = hall_position_limit((forward_1_2
        * converged_inverse) - (lower_3_1_2 * offsets_3), largest_step_phase), .offsets_2 =
        hall_position_limit((forward_2_2 * converged_inverse_2) - (lower_3_2_2 * offsets_3), largest_step_phase)};
}

typedef struct {
    float value;
    float residuals_1;
    float residuals_2;
    float rows_1_1;
    float arm_times_turn_yaw_cosine;
    float rows_1_3;
    float rows_2_2;
} hall_position_estimator_sensor_1_2_t;

/* sensor_1 */
HALL_POSITION_INLINE hall_position_estimator_sensor_1_2_t hall_position_estimator_sensor_1_2(float turn_yaw_cosine,
    float V_ax_held, float turn_yaw_sine, float V_ay_held, float ax_part_full, float by_ax, float phasor_ax_cosine,
    float ay_part_full, float by_ay, float phasor_ay_cosine, float field_3_scaled, float rows_1_3_product)
{
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;

    const float cosine_argument = by_ax * by_ax;
    const float cosine = cosine_polynomial(cosine_argument);
    const float sine_4 = by_ax * sine_4_polynomial(cosine_argument);
    const float phasor_ax_sine = (ax_part_full * cosine) + (phasor_ax_cosine * sine_4);
    const float phasor_ax_sine_squared = phasor_ax_sine * phasor_ax_sine;
    const float value_product = phasor_ax_sine_squared * field_5;
    const float value = phasor_ax_sine * (field_1 + (phasor_ax_sine_squared * (field_3 + value_product)));
    const float cosine_argument_2 = by_ay * by_ay;
    const float cosine_2 = cosine_polynomial(cosine_argument_2);
    const float sine_4_2 = by_ay * sine_4_polynomial(cosine_argument_2);
    const float phasor_ay_sine = (ay_part_full * cosine_2) + (phasor_ay_cosine * sine_4_2);
    const float phasor_ay_sine_squared = phasor_ay_sine * phasor_ay_sine;
    const float residuals_2_product = phasor_ay_sine_squared * field_5;
    const float residuals_2_product_2 = phasor_ay_sine * (field_1 +
        (phasor_ay_sine_squared * (field_3 + residuals_2_product)));
    const float rows_1_1 = ((phasor_ax_cosine * cosine) - (ax_part_full * sine_4)) * (field_1 +
        (phasor_ax_sine_squared * (field_3_scaled + (5.0f * value_product))));
    const float arm_times_turn_yaw_cosine = arm * turn_yaw_cosine;
    return (hall_position_estimator_sensor_1_2_t){.value = value, .residuals_1 = (turn_yaw_cosine * V_ax_held) -
        (turn_yaw_sine * V_ay_held) - value, .residuals_2 = (turn_yaw_cosine * V_ay_held) +
        (turn_yaw_sine * V_ax_held) - residuals_2_product_2, .rows_1_1 = rows_1_1, .arm_times_turn_yaw_cosine =
        arm_times_turn_yaw_cosine, .rows_1_3 = (rows_1_1 * (arm_times_turn_yaw_cosine + rows_1_3_product)) +
        residuals_2_product_2, .rows_2_2 = ((phasor_ay_cosine * cosine_2) - (ay_part_full * sine_4_2)) * (field_1 +
        (phasor_ay_sine_squared * (field_3_scaled + (5.0f * residuals_2_product))))};
}

typedef struct {
    float value;
    float residuals_3;
    float residuals_4;
    float rows_3_1;
    float rows_3_3;
    float rows_4_2;
} hall_position_estimator_sensor_2_2_t;

/* sensor_2 */
HALL_POSITION_INLINE hall_position_estimator_sensor_2_2_t hall_position_estimator_sensor_2_2(float turn_yaw_cosine,
    float V_bx_held, float turn_yaw_sine, float V_by_held, float bx_part_full, float by_bx, float phasor_bx_cosine,
    float by_part_full, float by_by, float phasor_by_cosine, float field_3_scaled, float rows_1_3_product)
{
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;

    const float cosine_argument = by_bx * by_bx;
    const float cosine = cosine_polynomial(cosine_argument);
    const float sine_4 = by_bx * sine_4_polynomial(cosine_argument);
    const float phasor_bx_sine = (bx_part_full * cosine) + (phasor_bx_cosine * sine_4);
    const float phasor_bx_sine_squared = phasor_bx_sine * phasor_bx_sine;
    const float value_product = phasor_bx_sine_squared * field_5;
    const float value = phasor_bx_sine * (field_1 + (phasor_bx_sine_squared * (field_3 + value_product)));
    const float cosine_argument_2 = by_by * by_by;
    const float cosine_2 = cosine_polynomial(cosine_argument_2);
    const float sine_4_2 = by_by * sine_4_polynomial(cosine_argument_2);
    const float phasor_by_sine = (by_part_full * cosine_2) + (phasor_by_cosine * sine_4_2);
    const float phasor_by_sine_squared = phasor_by_sine * phasor_by_sine;
    const float residuals_4_product = phasor_by_sine_squared * field_5;
    const float residuals_4_product_2 = phasor_by_sine * (field_1 +
        (phasor_by_sine_squared * (field_3 + residuals_4_product)));
    const float rows_3_1 = ((phasor_bx_cosine * cosine) - (bx_part_full * sine_4)) * (field_1 +
        (phasor_bx_sine_squared * (field_3_scaled + (5.0f * value_product))));
    return (hall_position_estimator_sensor_2_2_t){.value = value, .residuals_3 = (turn_yaw_cosine * V_bx_held) -
        (turn_yaw_sine * V_by_held) - value, .residuals_4 = (turn_yaw_cosine * V_by_held) + (turn_yaw_sine *
        V_bx_held) - residuals_4_product_2, .rows_3_1 = rows_3_1, .rows_3_3 = (rows_3_1 * ((-arm * turn_yaw_cosine) -
        rows_1_3_product)) + residuals_4_product_2, .rows_4_2 = ((phasor_by_cosine * cosine_2) - (by_part_full *
        sine_4_2)) * (field_1 + (phasor_by_sine_squared * (field_3_scaled + (5.0f * residuals_4_product))))};
}

typedef struct {
    float offsets_3;
    float offsets_1;
    float offsets_2;
    float value;
    float rows_1_3;
    float rows_3_3;
    float left_3_1;
    float value_2;
    float lower_3_1;
    float minus_rows_2_3;
    float minus_rows_4_3;
    float minus_left_3_2;
    float value_3;
    float lower_3_2;
    float forward_1;
    float forward_2;
    float forward_3;
    float best_1;
    float best_2;
    float best_3;
    bool better;
} hall_position_estimator_iteration_1_t;

/* iteration_1 */
HALL_POSITION_LARGE hall_position_estimator_iteration_1_t hall_position_estimator_iteration_1(const
    hall_position_estimator_first_trial_t *first_trial, const hall_position_estimator_prediction_t *prediction,
    float V_ax_held, float V_ay_held, float V_bx_held, float V_by_held)
{
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad of the prior */
    static const float prior_weight_yaw = 2.7546635f;
    static const float largest_step_yaw = 0.10100254f;          /* rad; correction of a sample at most */
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.0100383 rad of the prior; of x, y */
    static const float prior_weight_phase = 0.00992376f;
    static const float rounding_factor = 1.000002f;             /* 1; of a cost that counts as no higher */
    static const float slack = 1e-08f; /* V^2; rise of the cost that counts as none: rounding */

    const hall_position_estimator_correction_t correction = hall_position_estimator_correction(first_trial->forward_1,
        first_trial->value, first_trial->lower_3_1, first_trial->forward_3, first_trial->rows_1_3,
        first_trial->minus_rows_2_3, first_trial->rows_3_3, first_trial->minus_rows_4_3, first_trial->left_3_1,
        first_trial->lower_3_2, first_trial->minus_left_3_2, first_trial->forward_2, first_trial->value_2);
    const float offsets_3_squared = correction.offsets_3 * correction.offsets_3;
    const float chord_sine_yaw = correction.offsets_3 * sine_3_polynomial(offsets_3_squared);
    const float half_tangent_yaw = correction.offsets_3 * tangent_polynomial(offsets_3_squared);
    const float fall_yaw = chord_sine_yaw * ((half_tangent_yaw * prediction->ax_part_cosine_sum) +
        prediction->ax_part_cosine_limited);
    const float turn_yaw_cosine = prediction->ax_part_cosine_sum - fall_yaw;
    const float chord_yaw_sine = chord_sine_yaw * (prediction->ax_part_cosine_sum -
        (half_tangent_yaw * prediction->ax_part_cosine_limited));
    const float turn_yaw_sine = prediction->ax_part_cosine_limited + chord_yaw_sine;
    const float value_product = arm * hall_position_limit(-fall_yaw, largest_step_yaw);
    const float value_product_2 = arm * hall_position_limit(chord_yaw_sine, largest_step_yaw);
    const float arm_times_turn_yaw_sine = arm * turn_yaw_sine;
    const hall_position_estimator_sensor_1_2_t sensor_1 = hall_position_estimator_sensor_1_2(turn_yaw_cosine, V_ax_held,
        turn_yaw_sine, V_ay_held, prediction->ax_part_full, correction.offsets_1 - value_product + value_product_2,
        prediction->phasor_ax_cosine, prediction->ay_part_full, correction.offsets_2 - value_product - value_product_2,
        prediction->phasor_ay_cosine, first_trial->field_3_scaled, arm_times_turn_yaw_sine);
    const hall_position_estimator_sensor_2_2_t sensor_2 = hall_position_estimator_sensor_2_2(turn_yaw_cosine, V_bx_held,
        turn_yaw_sine, V_by_held, prediction->bx_part_full, correction.offsets_1 + value_product - value_product_2,
        prediction->phasor_bx_cosine, prediction->by_part_full, correction.offsets_2 + value_product + value_product_2,
        prediction->phasor_by_cosine, first_trial->field_3_scaled, arm_times_turn_yaw_sine);
    const float value_sum = (prior_weight_phase * (correction.offsets_1 * correction.offsets_1)) +
        (prior_weight_phase * (correction.offsets_2 * correction.offsets_2)) + (prior_weight_yaw * offsets_3_squared);
    const float value = (sensor_1.residuals_1 * sensor_1.residuals_1) + (sensor_1.residuals_2 * sensor_1.residuals_2) +
        (sensor_2.residuals_3 * sensor_2.residuals_3) + (sensor_2.residuals_4 * sensor_2.residuals_4) + value_sum;
    const hall_position_estimator_factors_t factors = hall_position_estimator_factors(sensor_1.rows_1_3,
        sensor_1.rows_1_1, sensor_2.rows_3_3, sensor_2.rows_3_1, sensor_1.value, sensor_1.rows_2_2,
        arm_times_turn_yaw_sine, sensor_1.arm_times_turn_yaw_cosine, sensor_2.value, sensor_2.rows_4_2);
    const float forward_1 = (sensor_1.rows_1_1 * sensor_1.residuals_1) + (sensor_2.rows_3_1 * sensor_2.residuals_3) -
        (prior_weight_phase * correction.offsets_1);
    const float forward_2 = (sensor_1.rows_2_2 * sensor_1.residuals_2) + (sensor_2.rows_4_2 * sensor_2.residuals_4) -
        (prior_weight_phase * correction.offsets_2);
    const bool better = value <= ((rounding_factor * first_trial->lowest) + slack);
    float best_1 = correction.offsets_1;
    float best_2 = correction.offsets_2;
    float best_3 = correction.offsets_3;
    if (!better) {
        best_1 = 0.0f;
        best_2 = 0.0f;
        best_3 = 0.0f;
    }
    return (hall_position_estimator_iteration_1_t){.offsets_3 = correction.offsets_3, .offsets_1 = correction.offsets_1,
        .offsets_2 = correction.offsets_2, .value = value, .rows_1_3 = sensor_1.rows_1_3, .rows_3_3 = sensor_2.rows_3_3,
        .left_3_1 = factors.left_3_1, .value_2 = factors.value, .lower_3_1 = factors.lower_3_1, .minus_rows_2_3 =
        factors.minus_rows_2_3, .minus_rows_4_3 = factors.minus_rows_4_3, .minus_left_3_2 = factors.minus_left_3_2,
        .value_3 = factors.value_2, .lower_3_2 = factors.lower_3_2, .forward_1 = forward_1, .forward_2 = forward_2,
        .forward_3 = (sensor_1.rows_1_3 * sensor_1.residuals_1) - (factors.minus_rows_2_3 * sensor_1.residuals_2) +
        (sensor_2.rows_3_3 * sensor_2.residuals_3) - (factors.minus_rows_4_3 * sensor_2.residuals_4) -
        (prior_weight_yaw * correction.offsets_3) - (factors.lower_3_1 * forward_1) - (factors.lower_3_2 * forward_2),
        .best_1 = best_1, .best_2 = best_2, .best_3 = best_3, .better = better};
}

typedef struct {
    float offsets_3;
    float offsets_1;
    float offsets_2;
} hall_position_estimator_correction_2_t;

/* correction */
HALL_POSITION_INLINE hall_position_estimator_correction_2_t hall_position_estimator_correction_2(bool better_2,
    float offsets_1_2, float forward_1_2, float converged_inverse, float lower_3_1, float offsets_3_2,
    float forward_3_2, float rows_1_3_2, float minus_rows_2_3_2, float rows_3_3_2, float minus_rows_4_3_2,
    float left_3_1_2, float lower_3_2, float minus_left_3_2_2, float best_3_2, float best_1_2, float offsets_2_2,
    float forward_2_2, float converged_inverse_2, float best_2_2)
{
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad of the prior */
    static const float prior_weight_yaw = 2.7546635f;
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad, the largest */
    static const float least_pivot_yaw = 2.7546635f;
    static const float largest_step_yaw = 0.10100254f;          /* rad; correction of a sample at most */
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */

    float offsets_3_unlimited;
    if (better_2) {
        const float left_3_3 = (rows_1_3_2 * rows_1_3_2) + (minus_rows_2_3_2 * minus_rows_2_3_2) +
            (rows_3_3_2 * rows_3_3_2) + (minus_rows_4_3_2 * minus_rows_4_3_2) + prior_weight_yaw -
            (lower_3_1 * left_3_1_2) + (lower_3_2 * minus_left_3_2_2);
        offsets_3_unlimited = offsets_3_2 + (forward_3_2 / hall_position_max(left_3_3, least_pivot_yaw));
    } else {
        offsets_3_unlimited = 0.5f * (offsets_3_2 + best_3_2);
    }
    const float offsets_3 = hall_position_limit(offsets_3_unlimited, largest_step_yaw);
    float offsets_1_unlimited;
    float offsets_2_unlimited;
    if (better_2) {
        const float offsets_3_minus_offsets_3_2 = offsets_3 - offsets_3_2;
        offsets_1_unlimited = offsets_1_2 +
            ((forward_1_2 * converged_inverse) - (lower_3_1 * offsets_3_minus_offsets_3_2));
        offsets_2_unlimited = offsets_2_2 +
            ((forward_2_2 * converged_inverse_2) - (lower_3_2 * offsets_3_minus_offsets_3_2));
    } else {
        offsets_1_unlimited = 0.5f * (offsets_1_2 + best_1_2);
        offsets_2_unlimited = 0.5f * (offsets_2_2 + best_2_2);
    }
    return (hall_position_estimator_correction_2_t){.offsets_3 = offsets_3,
        .offsets_1 = hall_position_limit(offsets_1_unlimited, largest_step_phase),
        .offsets_2 = hall_position_limit(offsets_2_unlimited, largest_step_phase)};
}

typedef struct {
    float value;
    float residuals_1;
    float residuals_2;
    float rows_1_1;
    float arm_times_turn_yaw_cosine;
    float rows_1_3;
    float rows_2_2;
} hall_position_estimator_sensor_1_3_t;

/* sensor_1 */
HALL_POSITION_INLINE hall_position_estimator_sensor_1_3_t hall_position_estimator_sensor_1_3(float turn_yaw_cosine,
    float V_ax_held, float turn_yaw_sine, float V_ay_held, float ax_part_full, float by_ax, float phasor_ax_cosine,
    float ay_part_full, float by_ay, float phasor_ay_cosine, float field_3_scaled, float rows_1_3_product)
{
    static const float largest_change = 0.97596323f; /* rad; largest change of a phase in a sample; of ax, ay, bx, by */
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;

    const float value_limited = hall_position_limit(by_ax, largest_change);
    const float cosine_argument = value_limited * value_limited;
    const float cosine = cosine_polynomial(cosine_argument);
    const float sine_4 = value_limited * sine_4_polynomial(cosine_argument);
    const float phasor_ax_sine = (ax_part_full * cosine) + (phasor_ax_cosine * sine_4);
    const float phasor_ax_sine_squared = phasor_ax_sine * phasor_ax_sine;
    const float value_product = phasor_ax_sine_squared * field_5;
    const float value = phasor_ax_sine * (field_1 + (phasor_ax_sine_squared * (field_3 + value_product)));
    const float residuals_2_limited = hall_position_limit(by_ay, largest_change);
    const float cosine_argument_2 = residuals_2_limited * residuals_2_limited;
    const float cosine_2 = cosine_polynomial(cosine_argument_2);
    const float sine_4_2 = residuals_2_limited * sine_4_polynomial(cosine_argument_2);
    const float phasor_ay_sine = (ay_part_full * cosine_2) + (phasor_ay_cosine * sine_4_2);
    const float phasor_ay_sine_squared = phasor_ay_sine * phasor_ay_sine;
    const float residuals_2_product = phasor_ay_sine_squared * field_5;
    const float residuals_2_product_2 = phasor_ay_sine * (field_1 +
        (phasor_ay_sine_squared * (field_3 + residuals_2_product)));
    const float rows_1_1 = ((phasor_ax_cosine * cosine) - (ax_part_full * sine_4)) * (field_1 +
        (phasor_ax_sine_squared * (field_3_scaled + (5.0f * value_product))));
    const float arm_times_turn_yaw_cosine = arm * turn_yaw_cosine;
    return (hall_position_estimator_sensor_1_3_t){.value = value, .residuals_1 = (turn_yaw_cosine * V_ax_held) -
        (turn_yaw_sine * V_ay_held) - value, .residuals_2 = (turn_yaw_cosine * V_ay_held) +
        (turn_yaw_sine * V_ax_held) - residuals_2_product_2, .rows_1_1 = rows_1_1, .arm_times_turn_yaw_cosine =
        arm_times_turn_yaw_cosine, .rows_1_3 = (rows_1_1 * (arm_times_turn_yaw_cosine + rows_1_3_product)) +
        residuals_2_product_2, .rows_2_2 = ((phasor_ay_cosine * cosine_2) - (ay_part_full * sine_4_2)) * (field_1 +
        (phasor_ay_sine_squared * (field_3_scaled + (5.0f * residuals_2_product))))};
}

typedef struct {
    float value;
    float residuals_3;
    float residuals_4;
    float rows_3_1;
    float rows_3_3;
    float rows_4_2;
} hall_position_estimator_sensor_2_3_t;

/* sensor_2 */
HALL_POSITION_INLINE hall_position_estimator_sensor_2_3_t hall_position_estimator_sensor_2_3(float turn_yaw_cosine,
    float V_bx_held, float turn_yaw_sine, float V_by_held, float bx_part_full, float by_bx, float phasor_bx_cosine,
    float by_part_full, float by_by, float phasor_by_cosine, float field_3_scaled, float rows_1_3_product)
{
    static const float largest_change = 0.97596323f; /* rad; largest change of a phase in a sample; of ax, ay, bx, by */
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;

    const float value_limited = hall_position_limit(by_bx, largest_change);
    const float cosine_argument = value_limited * value_limited;
    const float cosine = cosine_polynomial(cosine_argument);
    const float sine_4 = value_limited * sine_4_polynomial(cosine_argument);
    const float phasor_bx_sine = (bx_part_full * cosine) + (phasor_bx_cosine * sine_4);
    const float phasor_bx_sine_squared = phasor_bx_sine * phasor_bx_sine;
    const float value_product = phasor_bx_sine_squared * field_5;
    const float value = phasor_bx_sine * (field_1 + (phasor_bx_sine_squared * (field_3 + value_product)));
    const float residuals_4_limited = hall_position_limit(by_by, largest_change);
    const float cosine_argument_2 = residuals_4_limited * residuals_4_limited;
    const float cosine_2 = cosine_polynomial(cosine_argument_2);
    const float sine_4_2 = residuals_4_limited * sine_4_polynomial(cosine_argument_2);
    const float phasor_by_sine = (by_part_full * cosine_2) + (phasor_by_cosine * sine_4_2);
    const float phasor_by_sine_squared = phasor_by_sine * phasor_by_sine;
    const float residuals_4_product = phasor_by_sine_squared * field_5;
    const float residuals_4_product_2 = phasor_by_sine * (field_1 +
        (phasor_by_sine_squared * (field_3 + residuals_4_product)));
    const float rows_3_1 = ((phasor_bx_cosine * cosine) - (bx_part_full * sine_4)) * (field_1 +
        (phasor_bx_sine_squared * (field_3_scaled + (5.0f * value_product))));
    return (hall_position_estimator_sensor_2_3_t){.value = value, .residuals_3 = (turn_yaw_cosine * V_bx_held) -
        (turn_yaw_sine * V_by_held) - value, .residuals_4 = (turn_yaw_cosine * V_by_held) + (turn_yaw_sine *
        V_bx_held) - residuals_4_product_2, .rows_3_1 = rows_3_1, .rows_3_3 = (rows_3_1 * ((-arm * turn_yaw_cosine) -
        rows_1_3_product)) + residuals_4_product_2, .rows_4_2 = ((phasor_by_cosine * cosine_2) - (by_part_full *
        sine_4_2)) * (field_1 + (phasor_by_sine_squared * (field_3_scaled + (5.0f * residuals_4_product))))};
}

typedef struct {
    float offsets_3;
    float offsets_1;
    float offsets_2;
    float value;
    float squares;
    float value_2;
    float value_3;
    float value_4;
    float rows_1_3;
    float rows_3_3;
    float left_3_1;
    float value_5;
    float lower_3_1_2;
    float minus_rows_2_3;
    float minus_rows_4_3;
    float minus_left_3_2;
    float value_6;
    float lower_3_2_2;
    float forward_1;
    float forward_2;
    float forward_3;
    float lowest;
    float best_1;
    float best_2;
    float best_3;
    bool better;
} hall_position_estimator_iteration_t;

/* iteration_2, iteration_3, iteration_4 */
HALL_POSITION_LARGE hall_position_estimator_iteration_t hall_position_estimator_iteration(bool better_2, float
    offsets_1_2, float forward_1_2, float converged_inverse, float lower_3_1, float offsets_3_2, float forward_3_2,
    float rows_1_3_2, float minus_rows_2_3_2, float rows_3_3_2, float minus_rows_4_3_2, float left_3_1_2,
    float lower_3_2, float minus_left_3_2_2, float best_3_2, float best_1_2, float offsets_2_2, float forward_2_2,
    float converged_inverse_2, float best_2_2, const hall_position_estimator_prediction_t *prediction, float V_ax_held,
    float V_ay_held, float V_bx_held, float V_by_held, float field_3_scaled, float converged_sum, float lowest_2)
{
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad of the prior */
    static const float prior_weight_yaw = 2.7546635f;
    static const float largest_step_yaw = 0.10100254f;          /* rad; correction of a sample at most */
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.0100383 rad of the prior; of x, y */
    static const float prior_weight_phase = 0.00992376f;
    static const float rounding_factor = 1.000002f;             /* 1; of a cost that counts as no higher */
    static const float slack = 1e-08f; /* V^2; rise of the cost that counts as none: rounding */

    const hall_position_estimator_correction_2_t correction = hall_position_estimator_correction_2(better_2,
        offsets_1_2, forward_1_2, converged_inverse, lower_3_1, offsets_3_2, forward_3_2, rows_1_3_2, minus_rows_2_3_2,
        rows_3_3_2, minus_rows_4_3_2, left_3_1_2, lower_3_2, minus_left_3_2_2, best_3_2, best_1_2, offsets_2_2,
        forward_2_2, converged_inverse_2, best_2_2);
    const float value = correction.offsets_3 * correction.offsets_3;
    const float chord_sine_yaw = correction.offsets_3 * sine_3_polynomial(value);
    const float half_tangent_yaw = correction.offsets_3 * tangent_polynomial(value);
    const float fall_yaw = chord_sine_yaw * ((half_tangent_yaw * prediction->ax_part_cosine_sum) +
        prediction->ax_part_cosine_limited);
    const float turn_yaw_cosine = prediction->ax_part_cosine_sum - fall_yaw;
    const float chord_yaw_sine = chord_sine_yaw * (prediction->ax_part_cosine_sum -
        (half_tangent_yaw * prediction->ax_part_cosine_limited));
    const float turn_yaw_sine = prediction->ax_part_cosine_limited + chord_yaw_sine;
    const float squares_product = arm * hall_position_limit(-fall_yaw, largest_step_yaw);
    const float squares_product_2 = arm * hall_position_limit(chord_yaw_sine, largest_step_yaw);
    const float arm_times_turn_yaw_sine = arm * turn_yaw_sine;
    const hall_position_estimator_sensor_1_3_t sensor_1 = hall_position_estimator_sensor_1_3(turn_yaw_cosine, V_ax_held,
        turn_yaw_sine, V_ay_held, prediction->ax_part_full, correction.offsets_1 - squares_product + squares_product_2,
        prediction->phasor_ax_cosine, prediction->ay_part_full, correction.offsets_2 - squares_product -
        squares_product_2, prediction->phasor_ay_cosine, field_3_scaled, arm_times_turn_yaw_sine);
    const hall_position_estimator_sensor_2_3_t sensor_2 = hall_position_estimator_sensor_2_3(turn_yaw_cosine, V_bx_held,
        turn_yaw_sine, V_by_held, prediction->bx_part_full, correction.offsets_1 + squares_product - squares_product_2,
        prediction->phasor_bx_cosine, prediction->by_part_full, correction.offsets_2 + squares_product +
        squares_product_2, prediction->phasor_by_cosine, field_3_scaled, arm_times_turn_yaw_sine);
    const float squares = (sensor_1.residuals_1 * sensor_1.residuals_1) + (sensor_1.residuals_2 * sensor_1.residuals_2)
        + (sensor_2.residuals_3 * sensor_2.residuals_3) + (sensor_2.residuals_4 * sensor_2.residuals_4);
    const float value_2 = correction.offsets_1 * correction.offsets_1;
    const float value_3 = correction.offsets_2 * correction.offsets_2;
    const float value_4 = squares +
        ((prior_weight_phase * value_2) + (prior_weight_phase * value_3) + (prior_weight_yaw * value));
    const hall_position_estimator_factors_t factors = hall_position_estimator_factors(sensor_1.rows_1_3,
        sensor_1.rows_1_1, sensor_2.rows_3_3, sensor_2.rows_3_1, sensor_1.value, sensor_1.rows_2_2,
        arm_times_turn_yaw_sine, sensor_1.arm_times_turn_yaw_cosine, sensor_2.value, sensor_2.rows_4_2);
    const float forward_1 = (sensor_1.rows_1_1 * sensor_1.residuals_1) + (sensor_2.rows_3_1 * sensor_2.residuals_3) -
        (prior_weight_phase * correction.offsets_1);
    const float forward_2 = (sensor_1.rows_2_2 * sensor_1.residuals_2) + (sensor_2.rows_4_2 * sensor_2.residuals_4) -
        (prior_weight_phase * correction.offsets_2);
    const float lowest = (better_2) ? converged_sum : lowest_2;
    const bool better = value_4 <= ((rounding_factor * lowest) + slack);
    float best_1 = correction.offsets_1;
    float best_2 = correction.offsets_2;
    float best_3 = correction.offsets_3;
    if (!better) {
        best_1 = best_1_2;
        best_2 = best_2_2;
        best_3 = best_3_2;
    }
    return (hall_position_estimator_iteration_t){.offsets_3 = correction.offsets_3, .offsets_1 = correction.offsets_1,
        .offsets_2 = correction.offsets_2, .value = value, .squares = squares, .value_2 = value_2, .value_3 = value_3,
        .value_4 = value_4, .rows_1_3 = sensor_1.rows_1_3, .rows_3_3 = sensor_2.rows_3_3, .left_3_1 = factors.left_3_1,
        .value_5 = factors.value, .lower_3_1_2 = factors.lower_3_1, .minus_rows_2_3 = factors.minus_rows_2_3,
        .minus_rows_4_3 = factors.minus_rows_4_3, .minus_left_3_2 = factors.minus_left_3_2, .value_6 = factors.value_2,
        .lower_3_2_2 = factors.lower_3_2, .forward_1 = forward_1, .forward_2 = forward_2,
        .forward_3 = (sensor_1.rows_1_3 * sensor_1.residuals_1) - (factors.minus_rows_2_3 * sensor_1.residuals_2) +
        (sensor_2.rows_3_3 * sensor_2.residuals_3) - (factors.minus_rows_4_3 * sensor_2.residuals_4) -
        (prior_weight_yaw * correction.offsets_3) - (factors.lower_3_1 * forward_1) - (factors.lower_3_2 * forward_2),
        .lowest = lowest, .best_1 = best_1, .best_2 = best_2, .best_3 = best_3, .better = better};
}

typedef struct {
    float pivot;
    float at_1;
    float at_2;
    float at_3;
    bool converged;
} hall_position_estimator_last_correction_t;

/* last_correction */
HALL_POSITION_INLINE hall_position_estimator_last_correction_t
    hall_position_estimator_last_correction(const hall_position_estimator_iteration_t *iteration_4)
{
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad of the prior */
    static const float prior_weight_yaw = 2.7546635f;
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad, the largest */
    static const float least_pivot_yaw = 2.7546635f;
    /* V^2; (0.1 channel_sigma)^2: a smaller predicted decrease has converged */
    static const float decrease_tolerance = 1e-08f;
    static const float largest_step_yaw = 0.10100254f;          /* rad; correction of a sample at most */
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */

    const float left_3_3 = (iteration_4->rows_1_3 * iteration_4->rows_1_3) +
        (iteration_4->minus_rows_2_3 * iteration_4->minus_rows_2_3) + (iteration_4->rows_3_3 * iteration_4->rows_3_3) +
        (iteration_4->minus_rows_4_3 * iteration_4->minus_rows_4_3) + prior_weight_yaw -
        (iteration_4->lower_3_1_2 * iteration_4->left_3_1) + (iteration_4->lower_3_2_2 * iteration_4->minus_left_3_2);
    const float pivot = hall_position_max(left_3_3, least_pivot_yaw);
    const float forward_1_times_inverse_1 = iteration_4->forward_1 * iteration_4->value_5;
    const float forward_2_times_inverse_2 = iteration_4->forward_2 * iteration_4->value_6;
    const float step = iteration_4->forward_3 / pivot;
    const bool converged = iteration_4->better && (((iteration_4->forward_1 * forward_1_times_inverse_1) +
        (iteration_4->forward_2 * forward_2_times_inverse_2) + (iteration_4->forward_3 * step)) <= decrease_tolerance);
    float at_1 = iteration_4->best_1;
    float at_2 = iteration_4->best_2;
    float at_3 = iteration_4->best_3;
    if (converged) {
        const float untried_3 = hall_position_limit(iteration_4->offsets_3 + step, largest_step_yaw);
        const float untried_3_minus_offsets_3 = untried_3 - iteration_4->offsets_3;
        at_1 = hall_position_limit(iteration_4->offsets_1 +
            (forward_1_times_inverse_1 - (iteration_4->lower_3_1_2 * untried_3_minus_offsets_3)), largest_step_phase);
        at_2 = hall_position_limit(iteration_4->offsets_2 +
            (forward_2_times_inverse_2 - (iteration_4->lower_3_2_2 * untried_3_minus_offsets_3)), largest_step_phase);
        at_3 = untried_3;
    }
    return (hall_position_estimator_last_correction_t){.pivot = pivot, .at_1 = at_1, .at_2 = at_2, .at_3 = at_3,
        .converged = converged};
}

typedef struct {
    bool integrity_residual_fault;
    bool integrity_damped;
    bool integrity_good;
    bool tracking;
    bool integrity_unambiguous;
} hall_position_estimator_integrity_t;

/* integrity */
HALL_POSITION_INLINE hall_position_estimator_integrity_t hall_position_estimator_integrity(const
    hall_position_estimator_iteration_t *iteration_4, uint32_t ambiguity_resolved, uint32_t searching, float yaw,
    float yaw_last_good, float weight, bool converged, bool complete)
{
    static const float residual_limit = 0.01f;                  /* V^2; 1 times the square of 0.1 V rms */
    static const float squared_gate = 0.0009069143f;            /* rad^2; 3 sigma of the innovation, squared */
    static const float squared_radius = 11.103305f;             /* rad^2; of the arms of the sensors, sum of squares */
    static const float yaw_window = 0.08726646f; /* rad; about the last good yaw: there two sensors are unambiguous */
    static const float damped_from = 15.115238f; /* 1/V^2; 0.15 parameters that the prior decides, over the damping */
    static const float resolved_to = 0.403073f; /* 1/V^2; 0.004 parameters that the prior decides, over the damping */

    const bool gate_exceeded = squared_gate <
        (iteration_4->value_2 + iteration_4->value_3 + (squared_radius * iteration_4->value));
    const bool in_window = fabsf(yaw - yaw_last_good) <= yaw_window;
    const bool integrity_residual_fault = (residual_limit < iteration_4->squares) ||
        ((ambiguity_resolved != 0u) ? gate_exceeded : ((searching != 0u) && !in_window));
    const bool integrity_damped = damped_from < weight;
    const bool integrity_good = converged && !(integrity_damped || integrity_residual_fault || gate_exceeded);
    const bool tracking = searching == 0u;
    return (hall_position_estimator_integrity_t){.integrity_residual_fault = integrity_residual_fault,
        .integrity_damped = integrity_damped, .integrity_good = integrity_good, .tracking = tracking,
        .integrity_unambiguous = integrity_good && in_window && tracking && (weight <= resolved_to) && complete};
}

typedef struct {
    float yaw_next;
    float phase_x_next;
    float pose_pitch_x;
    float phase_y_next;
    float pose_pitch_y;
    float yaw_last_good_next;
    float yaw_next_2;
    float phase_x_next_2;
    float phase_y_next_2;
    float start_x_next;
    float start_y_next;
    float continued_motion_x;
    float continued_motion_y;
    float continued_motion_yaw;
    uint32_t residual_faults_next;
    uint32_t searching_next;
    bool inside;
    bool ambiguity_resolved_next;
    bool acquired_next;
    bool lock_lost_next;
    bool ambiguity_resolved_next_2;
} hall_position_estimator_track_t;

/* track */
HALL_POSITION_LARGE hall_position_estimator_track_t hall_position_estimator_track(float prediction_yaw, const
    hall_position_estimator_integrity_t *integrity, const hall_position_estimator_last_correction_t *last_correction,
    float prediction_phase_x, float pitch_x, uint32_t acquired, float prediction_phase_y, float pitch_y,
    uint32_t residual_faults, uint32_t searching, uint32_t ambiguity_resolved, uint32_t lock_lost, float yaw_last_good,
    float start_x, float start_y, float motion_x, float motion_y, float motion_yaw)
{
    static const float pi = 3.1415927f;                         /* 1 */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    static const float most_pitches = 8.0f;                     /* 1; counted to either side */
    static const float yaw_limit = 0.04363323f;                 /* rad; of a valid estimate */
    static const float ambiguous_yaw_limit = 0.08726646f;       /* rad; before the ambiguity is resolved */
    static const float start_step_x = -1.5401491f; /* rad; from one start to the next, in the negative direction */
    static const float start_step_y = -2.702773f; /* rad; from one start to the next, in the negative direction */
    static const float yaw_velocity_gain = 0.1f; /* 1; of a correction, added to the predicted motion of the yaw */

    float by_yaw = 0.0f;
    float by_phase_x = 0.0f;
    float by_phase_y = 0.0f;
    float continued_motion_x_choice = 0.0f;
    float continued_motion_y_choice = 0.0f;
    float continued_motion_yaw_choice = 0.0f;
    if (!(integrity->integrity_residual_fault && integrity->tracking)) {
        by_yaw = last_correction->at_3;
        by_phase_x = last_correction->at_1;
        by_phase_y = last_correction->at_2;
        continued_motion_x_choice = 0.5f * last_correction->at_1;
        continued_motion_y_choice = 0.5f * last_correction->at_2;
        continued_motion_yaw_choice = yaw_velocity_gain * last_correction->at_3;
    }
    const float prediction_yaw_plus_by_yaw = prediction_yaw + by_yaw;
    float angle_yaw = prediction_yaw_plus_by_yaw;
    if (pi < prediction_yaw_plus_by_yaw) {
        angle_yaw = prediction_yaw_plus_by_yaw - two_pi;
    }
    float yaw_next = angle_yaw;
    if (angle_yaw < -pi) {
        yaw_next = angle_yaw + two_pi;
    }
    const float moved_x = prediction_phase_x + by_phase_x;
    const bool turns_x = pi < moved_x;
    float angle_x = moved_x;
    if (turns_x) {
        angle_x = moved_x - two_pi;
    }
    float phase_x_next = angle_x;
    float pose_pitch_x_if_acquired = -1.0f;
    if (angle_x < -pi) {
        phase_x_next = angle_x + two_pi;
    } else {
        pose_pitch_x_if_acquired = turns_x ? 1.0f : 0.0f;
    }
    const float pose_pitch_x = pitch_x + ((acquired != 0u) ? pose_pitch_x_if_acquired : 0.0f);
    const float moved_y = prediction_phase_y + by_phase_y;
    const bool turns_y = pi < moved_y;
    float angle_y = moved_y;
    if (turns_y) {
        angle_y = moved_y - two_pi;
    }
    float phase_y_next = angle_y;
    float pose_pitch_y_if_acquired = -1.0f;
    if (angle_y < -pi) {
        phase_y_next = angle_y + two_pi;
    } else {
        pose_pitch_y_if_acquired = turns_y ? 1.0f : 0.0f;
    }
    const float pose_pitch_y = pitch_y + ((acquired != 0u) ? pose_pitch_y_if_acquired : 0.0f);
    const bool exhausted = 4u <= residual_faults;
    const bool restart = integrity->integrity_residual_fault && exhausted;
    const bool faultless = !integrity->integrity_residual_fault;
    const bool counted = (fabsf(pose_pitch_x) <= most_pitches) && (fabsf(pose_pitch_y) <= most_pitches);
    const float size = fabsf(yaw_next);
    const bool inside = counted && (size <= yaw_limit);
    const bool ambiguity_resolved_next = (integrity->integrity_unambiguous && inside) ||
        ((ambiguity_resolved != 0u) && !integrity->integrity_damped);
    uint32_t searching_next = 1u;
    bool ambiguity_resolved_next_2 = false;
    float yaw_next_2 = yaw_last_good;
    float phase_x_next_2 = phase_x_next;
    float phase_y_next_2 = phase_y_next;
    float start_x_next = start_x;
    float start_y_next = start_y;
    if (restart) {
        const float start_x_plus_start_step_x = start_x + start_step_x;
        if (start_x_plus_start_step_x < -pi) {
            const float phase_x_next_2_sum = start_x_plus_start_step_x + two_pi;
            phase_x_next_2 = phase_x_next_2_sum;
            start_x_next = phase_x_next_2_sum;
        } else {
            phase_x_next_2 = start_x_plus_start_step_x;
            start_x_next = start_x_plus_start_step_x;
        }
        const float start_y_plus_start_step_y = start_y + start_step_y;
        if (start_y_plus_start_step_y < -pi) {
            const float phase_y_next_2_sum = start_y_plus_start_step_y + two_pi;
            phase_y_next_2 = phase_y_next_2_sum;
            start_y_next = phase_y_next_2_sum;
        } else {
            phase_y_next_2 = start_y_plus_start_step_y;
            start_y_next = start_y_plus_start_step_y;
        }
    } else {
        searching_next = (last_correction->converged && faultless) ? 0u : searching;
        ambiguity_resolved_next_2 = ambiguity_resolved_next;
        yaw_next_2 = yaw_next;
    }
    float continued_motion_x = 0.0f;
    float continued_motion_y = 0.0f;
    float continued_motion_yaw = 0.0f;
    if (searching == 0u) {
        continued_motion_x = motion_x + continued_motion_x_choice;
        continued_motion_y = motion_y + continued_motion_y_choice;
        continued_motion_yaw = motion_yaw + continued_motion_yaw_choice;
    }
    return (hall_position_estimator_track_t){.yaw_next = yaw_next, .phase_x_next = phase_x_next,
        .pose_pitch_x = pose_pitch_x, .phase_y_next = phase_y_next, .pose_pitch_y = pose_pitch_y, .yaw_last_good_next =
        (ambiguity_resolved_next && faultless) ? yaw_next : yaw_last_good, .yaw_next_2 = yaw_next_2, .phase_x_next_2 =
        phase_x_next_2, .phase_y_next_2 = phase_y_next_2, .start_x_next = start_x_next, .start_y_next = start_y_next,
        .continued_motion_x = continued_motion_x, .continued_motion_y = continued_motion_y, .continued_motion_yaw =
        continued_motion_yaw, .residual_faults_next = (integrity->integrity_residual_fault) ? ((exhausted) ? 0u :
        (residual_faults + 1u)) : 0u, .searching_next = searching_next, .inside = inside, .ambiguity_resolved_next =
        ambiguity_resolved_next, .acquired_next = ambiguity_resolved_next || (acquired != 0u), .lock_lost_next =
        (lock_lost != 0u) || ((acquired != 0u) && (restart || !counted || (((ambiguity_resolved_next) ? yaw_limit :
        ambiguous_yaw_limit) < size))), .ambiguity_resolved_next_2 = ambiguity_resolved_next_2};
}

typedef struct {
    float X;
    float Y;
    float yaw;
    float deviation_X;
    float deviation_Y;
    float deviation_yaw;
    float residual;
    bool converged;
    bool damped;
    bool valid;
} hall_position_estimator_t;

/* estimator: GLSDC, Fig. 9 */
HALL_POSITION_LARGE hall_position_estimator_t hall_position_estimator(hall_position_estimator_state_t *state,
    const hall_position_input_t *accepted, bool complete)
{
    static const float largest_step_yaw = 0.10100254f;          /* rad; correction of a sample at most */
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */
    static const float length_per_phase = 0.008085071f;         /* m/rad; pitch / (2 pi) */
    static const float squared_radius = 11.103305f;             /* rad^2; of the arms of the sensors, sum of squares */
    static const float pitch = 0.0508f;                         /* m; of the magnet matrix */
    static const float sigma_per_wave_number = 8.085071e-06f;   /* V m/rad; deviation of a voltage, pitch / (2 pi) */
    static const float yaw_damping = -2.644477f; /* V^2/rad^2; (1 - r^2) times that of the phases, r = 5 */
    static const float channel_sigma = 0.001f;                  /* V; deviation of a channel, from R */
    static const float root_regularisation = 1e-30f;            /* V^2; keeps the argument of a root positive */
    static const float most_pitches = 8.0f;                     /* 1; counted to either side */

    const float motion_x = state->motion_x;
    const float prediction_phase_x = state->phase_x + motion_x;
    const float motion_yaw = state->motion_yaw;
    const float prediction_yaw = state->yaw + motion_yaw;
    const float motion_y = state->motion_y;
    const float prediction_phase_y = state->phase_y + motion_y;
    const hall_position_estimator_prediction_t prediction = hall_position_estimator_prediction(prediction_phase_x,
        prediction_yaw, prediction_phase_y);
    const hall_position_estimator_first_trial_t first_trial = hall_position_estimator_first_trial(&prediction,
        accepted->V_ax, accepted->V_ay, accepted->V_bx, accepted->V_by);
    const hall_position_estimator_iteration_1_t iteration_1 = hall_position_estimator_iteration_1(&first_trial,
        &prediction, accepted->V_ax, accepted->V_ay, accepted->V_bx, accepted->V_by);
    const hall_position_estimator_iteration_t iteration_2 = hall_position_estimator_iteration(iteration_1.better,
        iteration_1.offsets_1, iteration_1.forward_1, iteration_1.value_2, iteration_1.lower_3_1, iteration_1.offsets_3,
        iteration_1.forward_3, iteration_1.rows_1_3, iteration_1.minus_rows_2_3, iteration_1.rows_3_3,
        iteration_1.minus_rows_4_3, iteration_1.left_3_1, iteration_1.lower_3_2, iteration_1.minus_left_3_2,
        iteration_1.best_3, iteration_1.best_1, iteration_1.offsets_2, iteration_1.forward_2, iteration_1.value_3,
        iteration_1.best_2, &prediction, accepted->V_ax, accepted->V_ay, accepted->V_bx, accepted->V_by,
        first_trial.field_3_scaled, iteration_1.value, first_trial.lowest);
    const hall_position_estimator_iteration_t iteration_3 = hall_position_estimator_iteration(iteration_2.better,
        iteration_2.offsets_1, iteration_2.forward_1, iteration_2.value_5, iteration_2.lower_3_1_2,
        iteration_2.offsets_3, iteration_2.forward_3, iteration_2.rows_1_3, iteration_2.minus_rows_2_3,
        iteration_2.rows_3_3, iteration_2.minus_rows_4_3, iteration_2.left_3_1, iteration_2.lower_3_2_2,
        iteration_2.minus_left_3_2, iteration_2.best_3, iteration_2.best_1, iteration_2.offsets_2,
        iteration_2.forward_2, iteration_2.value_6, iteration_2.best_2, &prediction, accepted->V_ax, accepted->V_ay,
        accepted->V_bx, accepted->V_by, first_trial.field_3_scaled, iteration_2.value_4, iteration_2.lowest);
    const hall_position_estimator_iteration_t iteration_4 = hall_position_estimator_iteration(iteration_3.better,
        iteration_3.offsets_1, iteration_3.forward_1, iteration_3.value_5, iteration_3.lower_3_1_2,
        iteration_3.offsets_3, iteration_3.forward_3, iteration_3.rows_1_3, iteration_3.minus_rows_2_3,
        iteration_3.rows_3_3, iteration_3.minus_rows_4_3, iteration_3.left_3_1, iteration_3.lower_3_2_2,
        iteration_3.minus_left_3_2, iteration_3.best_3, iteration_3.best_1, iteration_3.offsets_2,
        iteration_3.forward_2, iteration_3.value_6, iteration_3.best_2, &prediction, accepted->V_ax, accepted->V_ay,
        accepted->V_bx, accepted->V_by, first_trial.field_3_scaled, iteration_3.value_4, iteration_3.lowest);
    const uint32_t ambiguity_resolved = state->ambiguity_resolved;
    const uint32_t searching = state->searching;
    const hall_position_estimator_last_correction_t last_correction =
        hall_position_estimator_last_correction(&iteration_4);
    const float yaw_last_good = state->yaw_last_good;
    const float lower_3_1_2_squared = iteration_4.lower_3_1_2 * iteration_4.lower_3_1_2;
    const float lower_3_2_2_squared = iteration_4.lower_3_2_2 * iteration_4.lower_3_2_2;
    const float yaw_variance = 1.0f / (last_correction.pivot + yaw_damping);
    const hall_position_estimator_integrity_t integrity = hall_position_estimator_integrity(&iteration_4,
        ambiguity_resolved, searching, prediction_yaw + last_correction.at_3, yaw_last_good,
        ((squared_radius + lower_3_1_2_squared + lower_3_2_2_squared) * yaw_variance) + iteration_4.value_5 +
        iteration_4.value_6, last_correction.converged, complete);
    const uint32_t acquired = state->acquired;
    const uint32_t residual_faults = state->residual_faults;
    const uint32_t lock_lost = state->lock_lost;
    const hall_position_estimator_track_t track = hall_position_estimator_track(prediction_yaw, &integrity,
        &last_correction, prediction_phase_x, state->pitch_x, acquired, prediction_phase_y, state->pitch_y,
        residual_faults, searching, ambiguity_resolved, lock_lost, yaw_last_good, state->start_x, state->start_y,
        motion_x, motion_y, motion_yaw);
    state->phase_x = track.phase_x_next_2;
    state->phase_y = track.phase_y_next_2;
    state->yaw = track.yaw_next_2;
    state->yaw_last_good = track.yaw_last_good_next;
    state->start_x = track.start_x_next;
    state->start_y = track.start_y_next;
    state->pitch_x = hall_position_limit(track.pose_pitch_x, most_pitches);
    state->pitch_y = hall_position_limit(track.pose_pitch_y, most_pitches);
    state->motion_x = hall_position_limit(track.continued_motion_x, largest_step_phase);
    state->motion_y = hall_position_limit(track.continued_motion_y, largest_step_phase);
    state->motion_yaw = hall_position_limit(track.continued_motion_yaw, largest_step_yaw);
    state->residual_faults = track.residual_faults_next;
    state->searching = track.searching_next;
    state->ambiguity_resolved = hall_position_flag(track.ambiguity_resolved_next_2);
    state->acquired = hall_position_flag(track.acquired_next);
    state->lock_lost = hall_position_flag(track.lock_lost_next);
    return (hall_position_estimator_t){.X = (length_per_phase * track.phase_x_next) + (pitch * track.pose_pitch_x),
        .Y = (length_per_phase * track.phase_y_next) + (pitch * track.pose_pitch_y), .yaw = track.yaw_next,
        .deviation_X = sigma_per_wave_number * sqrtf(iteration_4.value_5 + (lower_3_1_2_squared * yaw_variance)),
        .deviation_Y = sigma_per_wave_number * sqrtf(iteration_4.value_6 + (lower_3_2_2_squared * yaw_variance)),
        .deviation_yaw = channel_sigma * sqrtf(yaw_variance), .residual = sqrtf(root_regularisation +
        iteration_4.squares), .converged = last_correction.converged, .damped = integrity.integrity_damped, .valid =
        integrity.integrity_good && track.ambiguity_resolved_next && (lock_lost == 0u) && track.inside && complete};
}

/* Each input in its range, else what is held or refused, with its bit of the fault word. */
HALL_POSITION_INLINE hall_position_input_t hall_position_guard_inputs(hall_position_state_t *state,
    const hall_position_input_t *in, uint32_t *faults)
{
    hall_position_input_t accepted;
    accepted.V_ax = hall_position_hold_within(in->V_ax, 5.0f, &state->guard.last_V_ax, 0x00000001u, faults);
    accepted.V_ay = hall_position_hold_within(in->V_ay, 5.0f, &state->guard.last_V_ay, 0x00000002u, faults);
    accepted.V_bx = hall_position_hold_within(in->V_bx, 5.0f, &state->guard.last_V_bx, 0x00000004u, faults);
    accepted.V_by = hall_position_hold_within(in->V_by, 5.0f, &state->guard.last_V_by, 0x00000008u, faults);
    return accepted;
}

void hall_position_init(hall_position_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (hall_position_state_t){
        .guard = {.left = 5u},
        .estimator = {.searching = 1u},
    };
}

uint32_t hall_position_step(hall_position_state_t *state, const hall_position_input_t *in, hall_position_output_t *out)
{
    uint32_t faults = 0u;
    const hall_position_input_t accepted = hall_position_guard_inputs(state, in, &faults);
    const bool complete = (faults & 0x0000000fu) == 0u;
    const uint32_t guard_latched = state->guard.latched;
    const uint32_t latched = hall_position_guard(&state->guard, complete, guard_latched);
    if (latched != 0u) {
        state->guard.latched = 1u;
        faults |= 0x80000000u;
    }
    const uint32_t estimator_lock_lost = state->estimator.lock_lost;
    const hall_position_estimator_t estimator = hall_position_estimator(&state->estimator, &accepted, complete);
    out->X = estimator.X;
    out->Y = estimator.Y;
    out->yaw = estimator.yaw;
    out->deviation_X = estimator.deviation_X;
    out->deviation_Y = estimator.deviation_Y;
    out->deviation_yaw = estimator.deviation_yaw;
    out->residual = estimator.residual;
    out->converged = estimator.converged ? 1.0f : 0.0f;
    out->damped = estimator.damped ? 1.0f : 0.0f;
    out->valid = estimator.valid ? 1.0f : 0.0f;
    out->lock_lost = (float)estimator_lock_lost;

    return faults;
}
