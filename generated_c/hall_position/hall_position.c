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
    /* rad; arm of sensor a along x, times 2 pi over the pitch; arm of sensor a along y, times 2 pi over the pitch; arm
     * of sensor b along x, times 2 pi over the pitch; arm of sensor b along y, times 2 pi over the pitch; of a x, a y,
     * b x, b y */
    static const float arm = 2.3561945f;
    static const float largest_phase = 6.973755f;               /* rad; largest size of a phase; of ax, ay, bx, by */
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.0100383 rad of the prior; of x, y */
    static const float prior_weight_phase = 0.00992376f;
    static const float largest_L_yaw_phase = 8330.405f;         /* 1; bound of L in row yaw; of x, y */
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad of the prior */
    static const float prior_weight_yaw = 2.7546635f;
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.000602512 rad, the largest */
    static const float least_pivot_yaw = 2.7546635f;
    static const float largest_step_yaw = 0.10100254f;          /* rad; correction of a sample at most */
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */
    static const float rounding_factor = 1.000002f;             /* 1; of a cost that counts as no higher */
    static const float slack = 1e-08f; /* V^2; rise of the cost that counts as none: rounding */
    static const float largest_change = 0.97596323f; /* rad; largest change of a phase in a sample; of ax, ay, bx, by */
    /* V^2; (0.1 channel_sigma)^2: a smaller predicted decrease has converged */
    static const float decrease_tolerance = 1e-08f;
    static const float length_per_phase = 0.008085071f;         /* m/rad; pitch / (2 pi) */
    static const float pi = 3.1415927f;                         /* 1 */
    static const float residual_limit = 0.01f;                  /* V^2; 1 times the square of 0.1 V rms */
    static const float squared_gate = 0.0009069143f;            /* rad^2; 3 sigma of the innovation, squared */
    static const float squared_radius = 11.103305f;             /* rad^2; of the arms of the sensors, sum of squares */
    static const float yaw_window = 0.08726646f; /* rad; about the last good yaw: there two sensors are unambiguous */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    static const float pitch = 0.0508f;                         /* m; of the magnet matrix */
    static const float sigma_per_wave_number = 8.085071e-06f;   /* V m/rad; deviation of a voltage, pitch / (2 pi) */
    static const float yaw_damping = -2.644477f; /* V^2/rad^2; (1 - r^2) times that of the phases, r = 5 */
    static const float channel_sigma = 0.001f;                  /* V; deviation of a channel, from R */
    static const float root_regularisation = 1e-30f;            /* V^2; keeps the argument of a root positive */
    static const float damped_from = 15.115238f; /* 1/V^2; 0.15 parameters that the prior decides, over the damping */
    static const float resolved_to = 0.403073f; /* 1/V^2; 0.004 parameters that the prior decides, over the damping */
    static const float most_pitches = 8.0f;                     /* 1; counted to either side */
    static const float yaw_limit = 0.04363323f;                 /* rad; of a valid estimate */
    static const float start_step_x = -1.5401491f; /* rad; from one start to the next, in the negative direction */
    static const float start_step_y = -2.702773f; /* rad; from one start to the next, in the negative direction */
    static const float yaw_velocity_gain = 0.1f; /* 1; of a correction, added to the predicted motion of the yaw */
    static const float ambiguous_yaw_limit = 0.08726646f;       /* rad; before the ambiguity is resolved */

    const float motion_yaw = state->motion_yaw;
    const float prediction_yaw = state->yaw + motion_yaw;
    const float yaw_part_cosine_argument = prediction_yaw * prediction_yaw;
    const float sine = prediction_yaw * sine_polynomial(yaw_part_cosine_argument);
    const float yaw_part_sine = 4.0f * sine;
    const float yaw_part_cosine = yaw_part_cosine_polynomial(yaw_part_cosine_argument);
    const float motion_x = state->motion_x;
    const float prediction_phase_x = state->phase_x + motion_x;
    const float ax_part_cosine_limited = hall_position_limit(4.0f * (sine * yaw_part_cosine), 2.0f);
    const float ax_part_cosine_sum = 1.0f - (0.5f * (ax_part_cosine_limited * ax_part_cosine_limited));
    const float arm_times_ax_part_cosine_sum = arm * ax_part_cosine_sum;
    const float ax_part_cosine_limited_2 = hall_position_limit(ax_part_cosine_limited * (1.0f -
        (0.125f * (yaw_part_sine * yaw_part_sine))), 1.0f);
    const float ax_part_cosine_product = arm * ax_part_cosine_limited_2;
    const float limited_ax = hall_position_limit(prediction_phase_x - arm_times_ax_part_cosine_sum +
        ax_part_cosine_product, largest_phase);
    const float ax_part_cosine_argument = limited_ax * limited_ax;
    const float sine_2 = limited_ax * sine_2_polynomial(ax_part_cosine_argument);
    const float ax_part_sine = 8.0f * sine_2;
    const float ax_part_cosine = part_cosine_polynomial(ax_part_cosine_argument);
    const float sine_2_times_ax_part_cosine = sine_2 * ax_part_cosine;
    const float ax_part_doubled = 8.0f *
        (sine_2_times_ax_part_cosine * (1.0f - (0.03125f * (ax_part_sine * ax_part_sine))));
    /*@ admit -2.002f <= ax_part_doubled <= 2.002f; */
    const float sines_ax_part_2 = 8.0f * sine_2_times_ax_part_cosine;
    const float ax_part_full = ax_part_doubled * (1.0f - (0.125f * (sines_ax_part_2 * sines_ax_part_2)));
    /*@ admit -1.001f <= ax_part_full <= 1.001f; */
    const float motion_y = state->motion_y;
    const float prediction_phase_y = state->phase_y + motion_y;
    const float limited_ay = hall_position_limit(prediction_phase_y - arm_times_ax_part_cosine_sum -
        ax_part_cosine_product, largest_phase);
    const float ay_part_cosine_argument = limited_ay * limited_ay;
    const float sine_2_2 = limited_ay * sine_2_polynomial(ay_part_cosine_argument);
    const float ay_part_sine = 8.0f * sine_2_2;
    const float ay_part_cosine = part_cosine_polynomial(ay_part_cosine_argument);
    const float ay_part_doubled_product = sine_2_2 * ay_part_cosine;
    const float ay_part_doubled = 8.0f *
        (ay_part_doubled_product * (1.0f - (0.03125f * (ay_part_sine * ay_part_sine))));
    /*@ admit -2.002f <= ay_part_doubled <= 2.002f; */
    const float sines_ay_part_2 = 8.0f * ay_part_doubled_product;
    const float ay_part_full = ay_part_doubled * (1.0f - (0.125f * (sines_ay_part_2 * sines_ay_part_2)));
    /*@ admit -1.001f <= ay_part_full <= 1.001f; */
    const float limited_bx = hall_position_limit(prediction_phase_x + arm_times_ax_part_cosine_sum -
        ax_part_cosine_product, largest_phase);
    const float bx_part_cosine_argument = limited_bx * limited_bx;
    const float sine_2_3 = limited_bx * sine_2_polynomial(bx_part_cosine_argument);
    const float bx_part_sine = 8.0f * sine_2_3;
    const float bx_part_cosine = part_cosine_polynomial(bx_part_cosine_argument);
    const float bx_part_doubled_product = sine_2_3 * bx_part_cosine;
    const float bx_part_doubled = 8.0f *
        (bx_part_doubled_product * (1.0f - (0.03125f * (bx_part_sine * bx_part_sine))));
    /*@ admit -2.002f <= bx_part_doubled <= 2.002f; */
    const float sines_bx_part_2 = 8.0f * bx_part_doubled_product;
    const float bx_part_full = bx_part_doubled * (1.0f - (0.125f * (sines_bx_part_2 * sines_bx_part_2)));
    /*@ admit -1.001f <= bx_part_full <= 1.001f; */
    const float limited_by = hall_position_limit(prediction_phase_y + arm_times_ax_part_cosine_sum +
        ax_part_cosine_product, largest_phase);
    const float by_part_cosine_argument = limited_by * limited_by;
    const float sine_2_4 = limited_by * sine_2_polynomial(by_part_cosine_argument);
    const float by_part_sine = 8.0f * sine_2_4;
    const float by_part_cosine = part_cosine_polynomial(by_part_cosine_argument);
    const float by_part_doubled_product = sine_2_4 * by_part_cosine;
    const float by_part_doubled = 8.0f *
        (by_part_doubled_product * (1.0f - (0.03125f * (by_part_sine * by_part_sine))));
    /*@ admit -2.002f <= by_part_doubled <= 2.002f; */
    const float sines_by_part_2 = 8.0f * by_part_doubled_product;
    const float by_part_full = by_part_doubled * (1.0f - (0.125f * (sines_by_part_2 * sines_by_part_2)));
    /*@ admit -1.001f <= by_part_full <= 1.001f; */
    const float phasor_ax_cosine = 1.0f - (0.5f * (ax_part_doubled * ax_part_doubled));
    const float ax_part_full_squared = ax_part_full * ax_part_full;
    const float field_3_scaled = 3.0f * field_3;
    const float converged_product = ax_part_full_squared * field_5;
    const float rows_1_1 = phasor_ax_cosine * (field_1 +
        (ax_part_full_squared * (field_3_scaled + (5.0f * converged_product))));
    const float ay_part_full_squared = ay_part_full * ay_part_full;
    const float converged_product_2 = ay_part_full_squared * field_5;
    const float converged_product_3 = ay_part_full * (field_1 +
        (ay_part_full_squared * (field_3 + converged_product_2)));
    const float rows_1_3 = (rows_1_1 * (arm_times_ax_part_cosine_sum + ax_part_cosine_product)) + converged_product_3;
    const float converged_product_4 = ax_part_full * (field_1 + (ax_part_full_squared * (field_3 + converged_product)));
    const float residuals_1 = (ax_part_cosine_sum * accepted->V_ax) - (ax_part_cosine_limited_2 * accepted->V_ay) -
        converged_product_4;
    const float phasor_ay_cosine = 1.0f - (0.5f * (ay_part_doubled * ay_part_doubled));
    const float rows_2_2 = phasor_ay_cosine * (field_1 +
        (ay_part_full_squared * (field_3_scaled + (5.0f * converged_product_2))));
    const float minus_rows_2_3 = converged_product_4 -
        (rows_2_2 * (ax_part_cosine_product - arm_times_ax_part_cosine_sum));
    const float residuals_2 = (ax_part_cosine_sum * accepted->V_ay) + (ax_part_cosine_limited_2 * accepted->V_ax) -
        converged_product_3;
    const float phasor_bx_cosine = 1.0f - (0.5f * (bx_part_doubled * bx_part_doubled));
    const float bx_part_full_squared = bx_part_full * bx_part_full;
    const float converged_product_5 = bx_part_full_squared * field_5;
    const float rows_3_1 = phasor_bx_cosine * (field_1 +
        (bx_part_full_squared * (field_3_scaled + (5.0f * converged_product_5))));
    const float by_part_full_squared = by_part_full * by_part_full;
    const float converged_product_6 = by_part_full_squared * field_5;
    const float converged_product_7 = by_part_full * (field_1 +
        (by_part_full_squared * (field_3 + converged_product_6)));
    const float rows_3_3 = (rows_3_1 * ((-arm * ax_part_cosine_sum) - ax_part_cosine_product)) + converged_product_7;
    const float converged_product_8 = bx_part_full * (field_1 +
        (bx_part_full_squared * (field_3 + converged_product_5)));
    const float residuals_3 = (ax_part_cosine_sum * accepted->V_bx) - (ax_part_cosine_limited_2 * accepted->V_by) -
        converged_product_8;
    const float phasor_by_cosine = 1.0f - (0.5f * (by_part_doubled * by_part_doubled));
    const float rows_4_2 = phasor_by_cosine * (field_1 +
        (by_part_full_squared * (field_3_scaled + (5.0f * converged_product_6))));
    const float minus_rows_4_3 = converged_product_8 -
        (rows_4_2 * (arm_times_ax_part_cosine_sum - ax_part_cosine_product));
    const float residuals_4 = (ax_part_cosine_sum * accepted->V_by) + (ax_part_cosine_limited_2 * accepted->V_bx) -
        converged_product_7;
    const float left_3_1 = (rows_1_3 * rows_1_1) + (rows_3_3 * rows_3_1);
    const float converged_inverse = 1.0f / ((rows_1_1 * rows_1_1) + (rows_3_1 * rows_3_1) + prior_weight_phase);
    const float lower_3_1 = hall_position_limit(left_3_1 * converged_inverse, largest_L_yaw_phase);
    const float forward_1 = (rows_1_1 * residuals_1) + (rows_3_1 * residuals_3);
    const float minus_left_3_2 = (minus_rows_2_3 * rows_2_2) + (minus_rows_4_3 * rows_4_2);
    const float converged_inverse_2 = 1.0f / ((rows_2_2 * rows_2_2) + (rows_4_2 * rows_4_2) + prior_weight_phase);
    const float lower_3_2 = hall_position_limit(-(minus_left_3_2 * converged_inverse_2), largest_L_yaw_phase);
    const float forward_2 = (rows_2_2 * residuals_2) + (rows_4_2 * residuals_4);
    const float converged_denominator = hall_position_max((rows_1_3 * rows_1_3) + (minus_rows_2_3 * minus_rows_2_3) +
        (rows_3_3 * rows_3_3) + (minus_rows_4_3 * minus_rows_4_3) + prior_weight_yaw - (lower_3_1 * left_3_1) +
        (lower_3_2 * minus_left_3_2), least_pivot_yaw);
    const float offsets_3 = hall_position_limit(((rows_1_3 * residuals_1) - (minus_rows_2_3 * residuals_2) +
        (rows_3_3 * residuals_3) - (minus_rows_4_3 * residuals_4) - (lower_3_1 * forward_1) - (lower_3_2 * forward_2)) /
        converged_denominator, largest_step_yaw);
    const float offsets_3_squared = offsets_3 * offsets_3;
    const float chord_sine_yaw = offsets_3 * sine_3_polynomial(offsets_3_squared);
    const float half_tangent_yaw = offsets_3 * tangent_polynomial(offsets_3_squared);
    const float fall_yaw = chord_sine_yaw * ((half_tangent_yaw * ax_part_cosine_sum) + ax_part_cosine_limited_2);
    const float turn_yaw_cosine = ax_part_cosine_sum - fall_yaw;
    const float chord_yaw_sine = chord_sine_yaw * (ax_part_cosine_sum - (half_tangent_yaw * ax_part_cosine_limited_2));
    const float turn_yaw_sine = ax_part_cosine_limited_2 + chord_yaw_sine;
    const float offsets_1 = hall_position_limit((forward_1 * converged_inverse) - (lower_3_1 * offsets_3),
        largest_step_phase);
    const float converged_product_9 = arm * hall_position_limit(-fall_yaw, largest_step_yaw);
    const float converged_product_10 = arm * hall_position_limit(chord_yaw_sine, largest_step_yaw);
    const float by_ax = offsets_1 - converged_product_9 + converged_product_10;
    const float cosine_argument = by_ax * by_ax;
    const float cosine = cosine_polynomial(cosine_argument);
    const float sine_4 = by_ax * sine_4_polynomial(cosine_argument);
    const float phasor_ax_sine = (ax_part_full * cosine) + (phasor_ax_cosine * sine_4);
    const float phasor_ax_sine_squared = phasor_ax_sine * phasor_ax_sine;
    const float converged_product_11 = phasor_ax_sine_squared * field_5;
    const float converged_product_12 = phasor_ax_sine * (field_1 +
        (phasor_ax_sine_squared * (field_3 + converged_product_11)));
    const float residuals_1_2 = (turn_yaw_cosine * accepted->V_ax) - (turn_yaw_sine * accepted->V_ay) -
        converged_product_12;
    const float offsets_2 = hall_position_limit((forward_2 * converged_inverse_2) - (lower_3_2 * offsets_3),
        largest_step_phase);
    const float by_ay = offsets_2 - converged_product_9 - converged_product_10;
    const float cosine_argument_2 = by_ay * by_ay;
    const float cosine_2 = cosine_polynomial(cosine_argument_2);
    const float sine_4_2 = by_ay * sine_4_polynomial(cosine_argument_2);
    const float phasor_ay_sine = (ay_part_full * cosine_2) + (phasor_ay_cosine * sine_4_2);
    const float phasor_ay_sine_squared = phasor_ay_sine * phasor_ay_sine;
    const float converged_product_13 = phasor_ay_sine_squared * field_5;
    const float converged_product_14 = phasor_ay_sine * (field_1 +
        (phasor_ay_sine_squared * (field_3 + converged_product_13)));
    const float residuals_2_2 = (turn_yaw_cosine * accepted->V_ay) + (turn_yaw_sine * accepted->V_ax) -
        converged_product_14;
    const float by_bx = offsets_1 + converged_product_9 - converged_product_10;
    const float cosine_argument_3 = by_bx * by_bx;
    const float cosine_3 = cosine_polynomial(cosine_argument_3);
    const float sine_4_3 = by_bx * sine_4_polynomial(cosine_argument_3);
    const float phasor_bx_sine = (bx_part_full * cosine_3) + (phasor_bx_cosine * sine_4_3);
    const float phasor_bx_sine_squared = phasor_bx_sine * phasor_bx_sine;
    const float converged_product_15 = phasor_bx_sine_squared * field_5;
    const float converged_product_16 = phasor_bx_sine * (field_1 +
        (phasor_bx_sine_squared * (field_3 + converged_product_15)));
    const float residuals_3_2 = (turn_yaw_cosine * accepted->V_bx) - (turn_yaw_sine * accepted->V_by) -
        converged_product_16;
    const float by_by = offsets_2 + converged_product_9 + converged_product_10;
    const float cosine_argument_4 = by_by * by_by;
    const float cosine_4 = cosine_polynomial(cosine_argument_4);
    const float sine_4_4 = by_by * sine_4_polynomial(cosine_argument_4);
    const float phasor_by_sine = (by_part_full * cosine_4) + (phasor_by_cosine * sine_4_4);
    const float phasor_by_sine_squared = phasor_by_sine * phasor_by_sine;
    const float converged_product_17 = phasor_by_sine_squared * field_5;
    const float converged_product_18 = phasor_by_sine * (field_1 +
        (phasor_by_sine_squared * (field_3 + converged_product_17)));
    const float residuals_4_2 = (turn_yaw_cosine * accepted->V_by) + (turn_yaw_sine * accepted->V_bx) -
        converged_product_18;
    const float converged_sum = (residuals_1_2 * residuals_1_2) + (residuals_2_2 * residuals_2_2) + (residuals_3_2 *
        residuals_3_2) + (residuals_4_2 * residuals_4_2) + ((prior_weight_phase * (offsets_1 * offsets_1)) +
        (prior_weight_phase * (offsets_2 * offsets_2)) + (prior_weight_yaw * offsets_3_squared));
    const float squares = (residuals_1 * residuals_1) + (residuals_2 * residuals_2) + (residuals_3 * residuals_3) +
        (residuals_4 * residuals_4);
    const bool converged_test = converged_sum <= ((rounding_factor * squares) + slack);
    const float rows_1_1_2 = ((phasor_ax_cosine * cosine) - (ax_part_full * sine_4)) * (field_1 +
        (phasor_ax_sine_squared * (field_3_scaled + (5.0f * converged_product_11))));
    const float arm_times_turn_yaw_cosine = arm * turn_yaw_cosine;
    const float arm_times_turn_yaw_sine = arm * turn_yaw_sine;
    const float rows_1_3_2 = (rows_1_1_2 * (arm_times_turn_yaw_cosine + arm_times_turn_yaw_sine)) +
        converged_product_14;
    const float rows_2_2_2 = ((phasor_ay_cosine * cosine_2) - (ay_part_full * sine_4_2)) * (field_1 +
        (phasor_ay_sine_squared * (field_3_scaled + (5.0f * converged_product_13))));
    const float minus_rows_2_3_2 = converged_product_12 -
        (rows_2_2_2 * (arm_times_turn_yaw_sine - arm_times_turn_yaw_cosine));
    const float rows_3_1_2 = ((phasor_bx_cosine * cosine_3) - (bx_part_full * sine_4_3)) * (field_1 +
        (phasor_bx_sine_squared * (field_3_scaled + (5.0f * converged_product_15))));
    const float rows_3_3_2 = (rows_3_1_2 * ((-arm * turn_yaw_cosine) - arm_times_turn_yaw_sine)) + converged_product_18;
    const float rows_4_2_2 = ((phasor_by_cosine * cosine_4) - (by_part_full * sine_4_4)) * (field_1 +
        (phasor_by_sine_squared * (field_3_scaled + (5.0f * converged_product_17))));
    const float minus_rows_4_3_2 = converged_product_16 -
        (rows_4_2_2 * (arm_times_turn_yaw_cosine - arm_times_turn_yaw_sine));
    const float left_3_1_2 = (rows_1_3_2 * rows_1_1_2) + (rows_3_3_2 * rows_3_1_2);
    const float converged_inverse_3 = 1.0f /
        ((rows_1_1_2 * rows_1_1_2) + (rows_3_1_2 * rows_3_1_2) + prior_weight_phase);
    const float lower_3_1_2 = hall_position_limit(left_3_1_2 * converged_inverse_3, largest_L_yaw_phase);
    const float forward_1_2 = (rows_1_1_2 * residuals_1_2) + (rows_3_1_2 * residuals_3_2) -
        (prior_weight_phase * offsets_1);
    const float minus_left_3_2_2 = (minus_rows_2_3_2 * rows_2_2_2) + (minus_rows_4_3_2 * rows_4_2_2);
    const float converged_inverse_4 = 1.0f /
        ((rows_2_2_2 * rows_2_2_2) + (rows_4_2_2 * rows_4_2_2) + prior_weight_phase);
    const float lower_3_2_2 = hall_position_limit(-(minus_left_3_2_2 * converged_inverse_4), largest_L_yaw_phase);
    const float forward_2_2 = (rows_2_2_2 * residuals_2_2) + (rows_4_2_2 * residuals_4_2) -
        (prior_weight_phase * offsets_2);
    float converged_choice = offsets_3;
    float converged_choice_2 = offsets_1;
    float converged_choice_3 = offsets_2;
    float converged_choice_4 = converged_sum;
    if (!converged_test) {
        converged_choice = 0.0f;
        converged_choice_2 = 0.0f;
        converged_choice_3 = 0.0f;
        converged_choice_4 = squares;
    }
    float converged_choice_5;
    if (converged_test) {
        const float converged_denominator_2 = hall_position_max((rows_1_3_2 * rows_1_3_2) +
            (minus_rows_2_3_2 * minus_rows_2_3_2) + (rows_3_3_2 * rows_3_3_2) + (minus_rows_4_3_2 * minus_rows_4_3_2) +
            prior_weight_yaw - (lower_3_1_2 * left_3_1_2) + (lower_3_2_2 * minus_left_3_2_2), least_pivot_yaw);
        converged_choice_5 = offsets_3 + (((rows_1_3_2 * residuals_1_2) - (minus_rows_2_3_2 * residuals_2_2) +
            (rows_3_3_2 * residuals_3_2) - (minus_rows_4_3_2 * residuals_4_2) - (prior_weight_yaw * offsets_3) -
            (lower_3_1_2 * forward_1_2) - (lower_3_2_2 * forward_2_2)) / converged_denominator_2);
    } else {
        converged_choice_5 = 0.5f * (offsets_3 + converged_choice);
    }
    const float offsets_3_2 = hall_position_limit(converged_choice_5, largest_step_yaw);
    const float offsets_3_2_squared = offsets_3_2 * offsets_3_2;
    const float chord_sine_yaw_2 = offsets_3_2 * sine_3_polynomial(offsets_3_2_squared);
    const float half_tangent_yaw_2 = offsets_3_2 * tangent_polynomial(offsets_3_2_squared);
    const float fall_yaw_2 = chord_sine_yaw_2 * ((half_tangent_yaw_2 * ax_part_cosine_sum) + ax_part_cosine_limited_2);
    const float turn_yaw_cosine_2 = ax_part_cosine_sum - fall_yaw_2;
    const float chord_yaw_sine_2 = chord_sine_yaw_2 * (ax_part_cosine_sum -
        (half_tangent_yaw_2 * ax_part_cosine_limited_2));
    const float turn_yaw_sine_2 = ax_part_cosine_limited_2 + chord_yaw_sine_2;
    float converged_choice_6;
    float converged_choice_7;
    if (converged_test) {
        const float offsets_3_2_minus_offsets_3 = offsets_3_2 - offsets_3;
        converged_choice_6 = offsets_1 +
            ((forward_1_2 * converged_inverse_3) - (lower_3_1_2 * offsets_3_2_minus_offsets_3));
        converged_choice_7 = offsets_2 +
            ((forward_2_2 * converged_inverse_4) - (lower_3_2_2 * offsets_3_2_minus_offsets_3));
    } else {
        converged_choice_6 = 0.5f * (offsets_1 + converged_choice_2);
        converged_choice_7 = 0.5f * (offsets_2 + converged_choice_3);
    }
    const float offsets_1_2 = hall_position_limit(converged_choice_6, largest_step_phase);
    const float converged_product_19 = arm * hall_position_limit(-fall_yaw_2, largest_step_yaw);
    const float converged_product_20 = arm * hall_position_limit(chord_yaw_sine_2, largest_step_yaw);
    const float converged_limited = hall_position_limit(offsets_1_2 - converged_product_19 + converged_product_20,
        largest_change);
    const float cosine_argument_5 = converged_limited * converged_limited;
    const float cosine_5 = cosine_polynomial(cosine_argument_5);
    const float sine_4_5 = converged_limited * sine_4_polynomial(cosine_argument_5);
    const float phasor_ax_sine_2 = (ax_part_full * cosine_5) + (phasor_ax_cosine * sine_4_5);
    const float phasor_ax_sine_2_squared = phasor_ax_sine_2 * phasor_ax_sine_2;
    const float converged_product_21 = phasor_ax_sine_2_squared * field_5;
    const float converged_product_22 = phasor_ax_sine_2 * (field_1 +
        (phasor_ax_sine_2_squared * (field_3 + converged_product_21)));
    const float residuals_1_3 = (turn_yaw_cosine_2 * accepted->V_ax) - (turn_yaw_sine_2 * accepted->V_ay) -
        converged_product_22;
    const float offsets_2_2 = hall_position_limit(converged_choice_7, largest_step_phase);
    const float converged_limited_2 = hall_position_limit(offsets_2_2 - converged_product_19 - converged_product_20,
        largest_change);
    const float cosine_argument_6 = converged_limited_2 * converged_limited_2;
    const float cosine_6 = cosine_polynomial(cosine_argument_6);
    const float sine_4_6 = converged_limited_2 * sine_4_polynomial(cosine_argument_6);
    const float phasor_ay_sine_2 = (ay_part_full * cosine_6) + (phasor_ay_cosine * sine_4_6);
    const float phasor_ay_sine_2_squared = phasor_ay_sine_2 * phasor_ay_sine_2;
    const float converged_product_23 = phasor_ay_sine_2_squared * field_5;
    const float converged_product_24 = phasor_ay_sine_2 * (field_1 +
        (phasor_ay_sine_2_squared * (field_3 + converged_product_23)));
    const float residuals_2_3 = (turn_yaw_cosine_2 * accepted->V_ay) + (turn_yaw_sine_2 * accepted->V_ax) -
        converged_product_24;
    const float converged_limited_3 = hall_position_limit(offsets_1_2 + converged_product_19 - converged_product_20,
        largest_change);
    const float cosine_argument_7 = converged_limited_3 * converged_limited_3;
    const float cosine_7 = cosine_polynomial(cosine_argument_7);
    const float sine_4_7 = converged_limited_3 * sine_4_polynomial(cosine_argument_7);
    const float phasor_bx_sine_2 = (bx_part_full * cosine_7) + (phasor_bx_cosine * sine_4_7);
    const float phasor_bx_sine_2_squared = phasor_bx_sine_2 * phasor_bx_sine_2;
    const float converged_product_25 = phasor_bx_sine_2_squared * field_5;
    const float converged_product_26 = phasor_bx_sine_2 * (field_1 +
        (phasor_bx_sine_2_squared * (field_3 + converged_product_25)));
    const float residuals_3_3 = (turn_yaw_cosine_2 * accepted->V_bx) - (turn_yaw_sine_2 * accepted->V_by) -
        converged_product_26;
    const float converged_limited_4 = hall_position_limit(offsets_2_2 + converged_product_19 + converged_product_20,
        largest_change);
    const float cosine_argument_8 = converged_limited_4 * converged_limited_4;
    const float cosine_8 = cosine_polynomial(cosine_argument_8);
    const float sine_4_8 = converged_limited_4 * sine_4_polynomial(cosine_argument_8);
    const float phasor_by_sine_2 = (by_part_full * cosine_8) + (phasor_by_cosine * sine_4_8);
    const float phasor_by_sine_2_squared = phasor_by_sine_2 * phasor_by_sine_2;
    const float converged_product_27 = phasor_by_sine_2_squared * field_5;
    const float converged_product_28 = phasor_by_sine_2 * (field_1 +
        (phasor_by_sine_2_squared * (field_3 + converged_product_27)));
    const float residuals_4_3 = (turn_yaw_cosine_2 * accepted->V_by) + (turn_yaw_sine_2 * accepted->V_bx) -
        converged_product_28;
    const float converged_sum_2 = (residuals_1_3 * residuals_1_3) + (residuals_2_3 * residuals_2_3) + (residuals_3_3 *
        residuals_3_3) + (residuals_4_3 * residuals_4_3) + ((prior_weight_phase * (offsets_1_2 * offsets_1_2)) +
        (prior_weight_phase * (offsets_2_2 * offsets_2_2)) + (prior_weight_yaw * offsets_3_2_squared));
    const bool converged_test_2 = converged_sum_2 <= ((rounding_factor * converged_choice_4) + slack);
    const float rows_1_1_3 = ((phasor_ax_cosine * cosine_5) - (ax_part_full * sine_4_5)) * (field_1 +
        (phasor_ax_sine_2_squared * (field_3_scaled + (5.0f * converged_product_21))));
    const float arm_times_turn_yaw_cosine_2 = arm * turn_yaw_cosine_2;
    const float arm_times_turn_yaw_sine_2 = arm * turn_yaw_sine_2;
    const float rows_1_3_3 = (rows_1_1_3 * (arm_times_turn_yaw_cosine_2 + arm_times_turn_yaw_sine_2)) +
        converged_product_24;
    const float rows_2_2_3 = ((phasor_ay_cosine * cosine_6) - (ay_part_full * sine_4_6)) * (field_1 +
        (phasor_ay_sine_2_squared * (field_3_scaled + (5.0f * converged_product_23))));
    const float minus_rows_2_3_3 = converged_product_22 -
        (rows_2_2_3 * (arm_times_turn_yaw_sine_2 - arm_times_turn_yaw_cosine_2));
    const float rows_3_1_3 = ((phasor_bx_cosine * cosine_7) - (bx_part_full * sine_4_7)) * (field_1 +
        (phasor_bx_sine_2_squared * (field_3_scaled + (5.0f * converged_product_25))));
    const float rows_3_3_3 = (rows_3_1_3 * ((-arm * turn_yaw_cosine_2) - arm_times_turn_yaw_sine_2)) +
        converged_product_28;
    const float rows_4_2_3 = ((phasor_by_cosine * cosine_8) - (by_part_full * sine_4_8)) * (field_1 +
        (phasor_by_sine_2_squared * (field_3_scaled + (5.0f * converged_product_27))));
    const float minus_rows_4_3_3 = converged_product_26 -
        (rows_4_2_3 * (arm_times_turn_yaw_cosine_2 - arm_times_turn_yaw_sine_2));
    const float left_3_1_3 = (rows_1_3_3 * rows_1_1_3) + (rows_3_3_3 * rows_3_1_3);
    const float converged_inverse_5 = 1.0f /
        ((rows_1_1_3 * rows_1_1_3) + (rows_3_1_3 * rows_3_1_3) + prior_weight_phase);
    const float lower_3_1_3 = hall_position_limit(left_3_1_3 * converged_inverse_5, largest_L_yaw_phase);
    const float forward_1_3 = (rows_1_1_3 * residuals_1_3) + (rows_3_1_3 * residuals_3_3) -
        (prior_weight_phase * offsets_1_2);
    const float minus_left_3_2_3 = (minus_rows_2_3_3 * rows_2_2_3) + (minus_rows_4_3_3 * rows_4_2_3);
    const float converged_inverse_6 = 1.0f /
        ((rows_2_2_3 * rows_2_2_3) + (rows_4_2_3 * rows_4_2_3) + prior_weight_phase);
    const float lower_3_2_3 = hall_position_limit(-(minus_left_3_2_3 * converged_inverse_6), largest_L_yaw_phase);
    const float forward_2_3 = (rows_2_2_3 * residuals_2_3) + (rows_4_2_3 * residuals_4_3) -
        (prior_weight_phase * offsets_2_2);
    float converged_choice_8 = offsets_3_2;
    float converged_choice_9 = offsets_1_2;
    float converged_choice_10 = offsets_2_2;
    float converged_choice_11 = converged_sum_2;
    if (!converged_test_2) {
        converged_choice_8 = converged_choice;
        converged_choice_9 = converged_choice_2;
        converged_choice_10 = converged_choice_3;
        converged_choice_11 = converged_choice_4;
    }
    float converged_choice_12;
    if (converged_test_2) {
        const float converged_denominator_3 = hall_position_max((rows_1_3_3 * rows_1_3_3) +
            (minus_rows_2_3_3 * minus_rows_2_3_3) + (rows_3_3_3 * rows_3_3_3) + (minus_rows_4_3_3 * minus_rows_4_3_3) +
            prior_weight_yaw - (lower_3_1_3 * left_3_1_3) + (lower_3_2_3 * minus_left_3_2_3), least_pivot_yaw);
        converged_choice_12 = offsets_3_2 + (((rows_1_3_3 * residuals_1_3) - (minus_rows_2_3_3 * residuals_2_3) +
            (rows_3_3_3 * residuals_3_3) - (minus_rows_4_3_3 * residuals_4_3) - (prior_weight_yaw * offsets_3_2) -
            (lower_3_1_3 * forward_1_3) - (lower_3_2_3 * forward_2_3)) / converged_denominator_3);
    } else {
        converged_choice_12 = 0.5f * (offsets_3_2 + converged_choice_8);
    }
    const float offsets_3_3 = hall_position_limit(converged_choice_12, largest_step_yaw);
    const float offsets_3_3_squared = offsets_3_3 * offsets_3_3;
    const float chord_sine_yaw_3 = offsets_3_3 * sine_3_polynomial(offsets_3_3_squared);
    const float half_tangent_yaw_3 = offsets_3_3 * tangent_polynomial(offsets_3_3_squared);
    const float fall_yaw_3 = chord_sine_yaw_3 * ((half_tangent_yaw_3 * ax_part_cosine_sum) + ax_part_cosine_limited_2);
    const float turn_yaw_cosine_3 = ax_part_cosine_sum - fall_yaw_3;
    const float chord_yaw_sine_3 = chord_sine_yaw_3 * (ax_part_cosine_sum -
        (half_tangent_yaw_3 * ax_part_cosine_limited_2));
    const float turn_yaw_sine_3 = ax_part_cosine_limited_2 + chord_yaw_sine_3;
    float converged_choice_13;
    float converged_choice_14;
    if (converged_test_2) {
        const float converged_sum_3 = offsets_3_3 - offsets_3_2;
        converged_choice_13 = offsets_1_2 + ((forward_1_3 * converged_inverse_5) - (lower_3_1_3 * converged_sum_3));
        converged_choice_14 = offsets_2_2 + ((forward_2_3 * converged_inverse_6) - (lower_3_2_3 * converged_sum_3));
    } else {
        converged_choice_13 = 0.5f * (offsets_1_2 + converged_choice_9);
        converged_choice_14 = 0.5f * (offsets_2_2 + converged_choice_10);
    }
    const float offsets_1_3 = hall_position_limit(converged_choice_13, largest_step_phase);
    const float converged_product_29 = arm * hall_position_limit(-fall_yaw_3, largest_step_yaw);
    const float converged_product_30 = arm * hall_position_limit(chord_yaw_sine_3, largest_step_yaw);
    const float converged_limited_5 = hall_position_limit(offsets_1_3 - converged_product_29 + converged_product_30,
        largest_change);
    const float cosine_argument_9 = converged_limited_5 * converged_limited_5;
    const float cosine_9 = cosine_polynomial(cosine_argument_9);
    const float sine_4_9 = converged_limited_5 * sine_4_polynomial(cosine_argument_9);
    const float phasor_ax_sine_3 = (ax_part_full * cosine_9) + (phasor_ax_cosine * sine_4_9);
    const float phasor_ax_sine_3_squared = phasor_ax_sine_3 * phasor_ax_sine_3;
    const float converged_product_31 = phasor_ax_sine_3_squared * field_5;
    const float converged_product_32 = phasor_ax_sine_3 * (field_1 +
        (phasor_ax_sine_3_squared * (field_3 + converged_product_31)));
    const float residuals_1_4 = (turn_yaw_cosine_3 * accepted->V_ax) - (turn_yaw_sine_3 * accepted->V_ay) -
        converged_product_32;
    const float offsets_2_3 = hall_position_limit(converged_choice_14, largest_step_phase);
    const float converged_limited_6 = hall_position_limit(offsets_2_3 - converged_product_29 - converged_product_30,
        largest_change);
    const float cosine_argument_10 = converged_limited_6 * converged_limited_6;
    const float cosine_10 = cosine_polynomial(cosine_argument_10);
    const float sine_4_10 = converged_limited_6 * sine_4_polynomial(cosine_argument_10);
    const float phasor_ay_sine_3 = (ay_part_full * cosine_10) + (phasor_ay_cosine * sine_4_10);
    const float phasor_ay_sine_3_squared = phasor_ay_sine_3 * phasor_ay_sine_3;
    const float converged_product_33 = phasor_ay_sine_3_squared * field_5;
    const float converged_product_34 = phasor_ay_sine_3 * (field_1 +
        (phasor_ay_sine_3_squared * (field_3 + converged_product_33)));
    const float residuals_2_4 = (turn_yaw_cosine_3 * accepted->V_ay) + (turn_yaw_sine_3 * accepted->V_ax) -
        converged_product_34;
    const float converged_limited_7 = hall_position_limit(offsets_1_3 + converged_product_29 - converged_product_30,
        largest_change);
    const float cosine_argument_11 = converged_limited_7 * converged_limited_7;
    const float cosine_11 = cosine_polynomial(cosine_argument_11);
    const float sine_4_11 = converged_limited_7 * sine_4_polynomial(cosine_argument_11);
    const float phasor_bx_sine_3 = (bx_part_full * cosine_11) + (phasor_bx_cosine * sine_4_11);
    const float phasor_bx_sine_3_squared = phasor_bx_sine_3 * phasor_bx_sine_3;
    const float converged_product_35 = phasor_bx_sine_3_squared * field_5;
    const float converged_product_36 = phasor_bx_sine_3 * (field_1 +
        (phasor_bx_sine_3_squared * (field_3 + converged_product_35)));
    const float residuals_3_4 = (turn_yaw_cosine_3 * accepted->V_bx) - (turn_yaw_sine_3 * accepted->V_by) -
        converged_product_36;
    const float converged_limited_8 = hall_position_limit(offsets_2_3 + converged_product_29 + converged_product_30,
        largest_change);
    const float cosine_argument_12 = converged_limited_8 * converged_limited_8;
    const float cosine_12 = cosine_polynomial(cosine_argument_12);
    const float sine_4_12 = converged_limited_8 * sine_4_polynomial(cosine_argument_12);
    const float phasor_by_sine_3 = (by_part_full * cosine_12) + (phasor_by_cosine * sine_4_12);
    const float phasor_by_sine_3_squared = phasor_by_sine_3 * phasor_by_sine_3;
    const float converged_product_37 = phasor_by_sine_3_squared * field_5;
    const float converged_product_38 = phasor_by_sine_3 * (field_1 +
        (phasor_by_sine_3_squared * (field_3 + converged_product_37)));
    const float residuals_4_4 = (turn_yaw_cosine_3 * accepted->V_by) + (turn_yaw_sine_3 * accepted->V_bx) -
        converged_product_38;
    const float converged_sum_4 = (residuals_1_4 * residuals_1_4) + (residuals_2_4 * residuals_2_4) + (residuals_3_4 *
        residuals_3_4) + (residuals_4_4 * residuals_4_4) + ((prior_weight_phase * (offsets_1_3 * offsets_1_3)) +
        (prior_weight_phase * (offsets_2_3 * offsets_2_3)) + (prior_weight_yaw * offsets_3_3_squared));
    const bool converged_test_3 = converged_sum_4 <= ((rounding_factor * converged_choice_11) + slack);
    const float rows_1_1_4 = ((phasor_ax_cosine * cosine_9) - (ax_part_full * sine_4_9)) * (field_1 +
        (phasor_ax_sine_3_squared * (field_3_scaled + (5.0f * converged_product_31))));
    const float arm_times_turn_yaw_cosine_3 = arm * turn_yaw_cosine_3;
    const float arm_times_turn_yaw_sine_3 = arm * turn_yaw_sine_3;
    const float rows_1_3_4 = (rows_1_1_4 * (arm_times_turn_yaw_cosine_3 + arm_times_turn_yaw_sine_3)) +
        converged_product_34;
    const float rows_2_2_4 = ((phasor_ay_cosine * cosine_10) - (ay_part_full * sine_4_10)) * (field_1 +
        (phasor_ay_sine_3_squared * (field_3_scaled + (5.0f * converged_product_33))));
    const float minus_rows_2_3_4 = converged_product_32 -
        (rows_2_2_4 * (arm_times_turn_yaw_sine_3 - arm_times_turn_yaw_cosine_3));
    const float rows_3_1_4 = ((phasor_bx_cosine * cosine_11) - (bx_part_full * sine_4_11)) * (field_1 +
        (phasor_bx_sine_3_squared * (field_3_scaled + (5.0f * converged_product_35))));
    const float rows_3_3_4 = (rows_3_1_4 * ((-arm * turn_yaw_cosine_3) - arm_times_turn_yaw_sine_3)) +
        converged_product_38;
    const float rows_4_2_4 = ((phasor_by_cosine * cosine_12) - (by_part_full * sine_4_12)) * (field_1 +
        (phasor_by_sine_3_squared * (field_3_scaled + (5.0f * converged_product_37))));
    const float minus_rows_4_3_4 = converged_product_36 -
        (rows_4_2_4 * (arm_times_turn_yaw_cosine_3 - arm_times_turn_yaw_sine_3));
    const float left_3_1_4 = (rows_1_3_4 * rows_1_1_4) + (rows_3_3_4 * rows_3_1_4);
    const float converged_inverse_7 = 1.0f /
        ((rows_1_1_4 * rows_1_1_4) + (rows_3_1_4 * rows_3_1_4) + prior_weight_phase);
    const float lower_3_1_4 = hall_position_limit(left_3_1_4 * converged_inverse_7, largest_L_yaw_phase);
    const float forward_1_4 = (rows_1_1_4 * residuals_1_4) + (rows_3_1_4 * residuals_3_4) -
        (prior_weight_phase * offsets_1_3);
    const float minus_left_3_2_4 = (minus_rows_2_3_4 * rows_2_2_4) + (minus_rows_4_3_4 * rows_4_2_4);
    const float converged_inverse_8 = 1.0f /
        ((rows_2_2_4 * rows_2_2_4) + (rows_4_2_4 * rows_4_2_4) + prior_weight_phase);
    const float lower_3_2_4 = hall_position_limit(-(minus_left_3_2_4 * converged_inverse_8), largest_L_yaw_phase);
    const float forward_2_4 = (rows_2_2_4 * residuals_2_4) + (rows_4_2_4 * residuals_4_4) -
        (prior_weight_phase * offsets_2_3);
    float converged_choice_15 = offsets_3_3;
    float converged_choice_16 = offsets_1_3;
    float converged_choice_17 = offsets_2_3;
    float converged_choice_18 = converged_sum_4;
    if (!converged_test_3) {
        converged_choice_15 = converged_choice_8;
        converged_choice_16 = converged_choice_9;
        converged_choice_17 = converged_choice_10;
        converged_choice_18 = converged_choice_11;
    }
    float converged_choice_19;
    if (converged_test_3) {
        const float converged_denominator_4 = hall_position_max((rows_1_3_4 * rows_1_3_4) +
            (minus_rows_2_3_4 * minus_rows_2_3_4) + (rows_3_3_4 * rows_3_3_4) + (minus_rows_4_3_4 * minus_rows_4_3_4) +
            prior_weight_yaw - (lower_3_1_4 * left_3_1_4) + (lower_3_2_4 * minus_left_3_2_4), least_pivot_yaw);
        converged_choice_19 = offsets_3_3 + (((rows_1_3_4 * residuals_1_4) - (minus_rows_2_3_4 * residuals_2_4) +
            (rows_3_3_4 * residuals_3_4) - (minus_rows_4_3_4 * residuals_4_4) - (prior_weight_yaw * offsets_3_3) -
            (lower_3_1_4 * forward_1_4) - (lower_3_2_4 * forward_2_4)) / converged_denominator_4);
    } else {
        converged_choice_19 = 0.5f * (offsets_3_3 + converged_choice_15);
    }
    const float offsets_3_4 = hall_position_limit(converged_choice_19, largest_step_yaw);
    const float offsets_3_4_squared = offsets_3_4 * offsets_3_4;
    const float chord_sine_yaw_4 = offsets_3_4 * sine_3_polynomial(offsets_3_4_squared);
    const float half_tangent_yaw_4 = offsets_3_4 * tangent_polynomial(offsets_3_4_squared);
    const float fall_yaw_4 = chord_sine_yaw_4 * ((half_tangent_yaw_4 * ax_part_cosine_sum) + ax_part_cosine_limited_2);
    const float turn_yaw_cosine_4 = ax_part_cosine_sum - fall_yaw_4;
    const float chord_yaw_sine_4 = chord_sine_yaw_4 * (ax_part_cosine_sum -
        (half_tangent_yaw_4 * ax_part_cosine_limited_2));
    const float turn_yaw_sine_4 = ax_part_cosine_limited_2 + chord_yaw_sine_4;
    float converged_choice_20;
    float converged_choice_21;
    if (converged_test_3) {
        const float converged_sum_5 = offsets_3_4 - offsets_3_3;
        converged_choice_20 = offsets_1_3 + ((forward_1_4 * converged_inverse_7) - (lower_3_1_4 * converged_sum_5));
        converged_choice_21 = offsets_2_3 + ((forward_2_4 * converged_inverse_8) - (lower_3_2_4 * converged_sum_5));
    } else {
        converged_choice_20 = 0.5f * (offsets_1_3 + converged_choice_16);
        converged_choice_21 = 0.5f * (offsets_2_3 + converged_choice_17);
    }
    const float offsets_1_4 = hall_position_limit(converged_choice_20, largest_step_phase);
    const float converged_product_39 = arm * hall_position_limit(-fall_yaw_4, largest_step_yaw);
    const float converged_product_40 = arm * hall_position_limit(chord_yaw_sine_4, largest_step_yaw);
    const float converged_limited_9 = hall_position_limit(offsets_1_4 - converged_product_39 + converged_product_40,
        largest_change);
    const float cosine_argument_13 = converged_limited_9 * converged_limited_9;
    const float cosine_13 = cosine_polynomial(cosine_argument_13);
    const float sine_4_13 = converged_limited_9 * sine_4_polynomial(cosine_argument_13);
    const float phasor_ax_sine_4 = (ax_part_full * cosine_13) + (phasor_ax_cosine * sine_4_13);
    const float phasor_ax_sine_4_squared = phasor_ax_sine_4 * phasor_ax_sine_4;
    const float converged_product_41 = phasor_ax_sine_4_squared * field_5;
    const float converged_product_42 = phasor_ax_sine_4 * (field_1 +
        (phasor_ax_sine_4_squared * (field_3 + converged_product_41)));
    const float residuals_1_5 = (turn_yaw_cosine_4 * accepted->V_ax) - (turn_yaw_sine_4 * accepted->V_ay) -
        converged_product_42;
    const float offsets_2_4 = hall_position_limit(converged_choice_21, largest_step_phase);
    const float converged_limited_10 = hall_position_limit(offsets_2_4 - converged_product_39 - converged_product_40,
        largest_change);
    const float cosine_argument_14 = converged_limited_10 * converged_limited_10;
    const float cosine_14 = cosine_polynomial(cosine_argument_14);
    const float sine_4_14 = converged_limited_10 * sine_4_polynomial(cosine_argument_14);
    const float phasor_ay_sine_4 = (ay_part_full * cosine_14) + (phasor_ay_cosine * sine_4_14);
    const float phasor_ay_sine_4_squared = phasor_ay_sine_4 * phasor_ay_sine_4;
    const float converged_product_43 = phasor_ay_sine_4_squared * field_5;
    const float converged_product_44 = phasor_ay_sine_4 * (field_1 +
        (phasor_ay_sine_4_squared * (field_3 + converged_product_43)));
    const float residuals_2_5 = (turn_yaw_cosine_4 * accepted->V_ay) + (turn_yaw_sine_4 * accepted->V_ax) -
        converged_product_44;
    const float converged_limited_11 = hall_position_limit(offsets_1_4 + converged_product_39 - converged_product_40,
        largest_change);
    const float cosine_argument_15 = converged_limited_11 * converged_limited_11;
    const float cosine_15 = cosine_polynomial(cosine_argument_15);
    const float sine_4_15 = converged_limited_11 * sine_4_polynomial(cosine_argument_15);
    const float phasor_bx_sine_4 = (bx_part_full * cosine_15) + (phasor_bx_cosine * sine_4_15);
    const float phasor_bx_sine_4_squared = phasor_bx_sine_4 * phasor_bx_sine_4;
    const float converged_product_45 = phasor_bx_sine_4_squared * field_5;
    const float converged_product_46 = phasor_bx_sine_4 * (field_1 +
        (phasor_bx_sine_4_squared * (field_3 + converged_product_45)));
    const float residuals_3_5 = (turn_yaw_cosine_4 * accepted->V_bx) - (turn_yaw_sine_4 * accepted->V_by) -
        converged_product_46;
    const float converged_limited_12 = hall_position_limit(offsets_2_4 + converged_product_39 + converged_product_40,
        largest_change);
    const float cosine_argument_16 = converged_limited_12 * converged_limited_12;
    const float cosine_16 = cosine_polynomial(cosine_argument_16);
    const float sine_4_16 = converged_limited_12 * sine_4_polynomial(cosine_argument_16);
    const float phasor_by_sine_4 = (by_part_full * cosine_16) + (phasor_by_cosine * sine_4_16);
    const float phasor_by_sine_4_squared = phasor_by_sine_4 * phasor_by_sine_4;
    const float converged_product_47 = phasor_by_sine_4_squared * field_5;
    const float converged_product_48 = phasor_by_sine_4 * (field_1 +
        (phasor_by_sine_4_squared * (field_3 + converged_product_47)));
    const float residuals_4_5 = (turn_yaw_cosine_4 * accepted->V_by) + (turn_yaw_sine_4 * accepted->V_bx) -
        converged_product_48;
    const float squares_2 = (residuals_1_5 * residuals_1_5) + (residuals_2_5 * residuals_2_5) +
        (residuals_3_5 * residuals_3_5) + (residuals_4_5 * residuals_4_5);
    const uint32_t ambiguity_resolved = state->ambiguity_resolved;
    const float offsets_1_4_squared = offsets_1_4 * offsets_1_4;
    const float offsets_2_4_squared = offsets_2_4 * offsets_2_4;
    const bool gate_exceeded = squared_gate <
        (offsets_1_4_squared + offsets_2_4_squared + (squared_radius * offsets_3_4_squared));
    const uint32_t searching = state->searching;
    const bool better = (squares_2 + ((prior_weight_phase * offsets_1_4_squared) +
        (prior_weight_phase * offsets_2_4_squared) + (prior_weight_yaw * offsets_3_4_squared))) <=
        ((rounding_factor * converged_choice_18) + slack);
    const float rows_1_1_5 = ((phasor_ax_cosine * cosine_13) - (ax_part_full * sine_4_13)) * (field_1 +
        (phasor_ax_sine_4_squared * (field_3_scaled + (5.0f * converged_product_41))));
    const float rows_3_1_5 = ((phasor_bx_cosine * cosine_15) - (bx_part_full * sine_4_15)) * (field_1 +
        (phasor_bx_sine_4_squared * (field_3_scaled + (5.0f * converged_product_45))));
    const float forward_1_5 = (rows_1_1_5 * residuals_1_5) + (rows_3_1_5 * residuals_3_5) -
        (prior_weight_phase * offsets_1_4);
    const float inverse_1 = 1.0f / ((rows_1_1_5 * rows_1_1_5) + (rows_3_1_5 * rows_3_1_5) + prior_weight_phase);
    const float forward_1_5_times_inverse_1 = forward_1_5 * inverse_1;
    const float rows_2_2_5 = ((phasor_ay_cosine * cosine_14) - (ay_part_full * sine_4_14)) * (field_1 +
        (phasor_ay_sine_4_squared * (field_3_scaled + (5.0f * converged_product_43))));
    const float rows_4_2_5 = ((phasor_by_cosine * cosine_16) - (by_part_full * sine_4_16)) * (field_1 +
        (phasor_by_sine_4_squared * (field_3_scaled + (5.0f * converged_product_47))));
    const float forward_2_5 = (rows_2_2_5 * residuals_2_5) + (rows_4_2_5 * residuals_4_5) -
        (prior_weight_phase * offsets_2_4);
    const float inverse_2 = 1.0f / ((rows_2_2_5 * rows_2_2_5) + (rows_4_2_5 * rows_4_2_5) + prior_weight_phase);
    const float forward_2_5_times_inverse_2 = forward_2_5 * inverse_2;
    const float arm_times_turn_yaw_cosine_4 = arm * turn_yaw_cosine_4;
    const float arm_times_turn_yaw_sine_4 = arm * turn_yaw_sine_4;
    const float rows_1_3_5 = (rows_1_1_5 * (arm_times_turn_yaw_cosine_4 + arm_times_turn_yaw_sine_4)) +
        converged_product_44;
    const float minus_rows_2_3_5 = converged_product_42 -
        (rows_2_2_5 * (arm_times_turn_yaw_sine_4 - arm_times_turn_yaw_cosine_4));
    const float rows_3_3_5 = (rows_3_1_5 * ((-arm * turn_yaw_cosine_4) - arm_times_turn_yaw_sine_4)) +
        converged_product_48;
    const float minus_rows_4_3_5 = converged_product_46 -
        (rows_4_2_5 * (arm_times_turn_yaw_cosine_4 - arm_times_turn_yaw_sine_4));
    const float left_3_1_5 = (rows_1_3_5 * rows_1_1_5) + (rows_3_3_5 * rows_3_1_5);
    const float by_yaw_X = hall_position_limit(left_3_1_5 * inverse_1, largest_L_yaw_phase);
    const float minus_left_3_2_5 = (minus_rows_2_3_5 * rows_2_2_5) + (minus_rows_4_3_5 * rows_4_2_5);
    const float by_yaw_Y = hall_position_limit(-(minus_left_3_2_5 * inverse_2), largest_L_yaw_phase);
    const float forward_3 = (rows_1_3_5 * residuals_1_5) - (minus_rows_2_3_5 * residuals_2_5) +
        (rows_3_3_5 * residuals_3_5) - (minus_rows_4_3_5 * residuals_4_5) - (prior_weight_yaw * offsets_3_4) -
        (by_yaw_X * forward_1_5) - (by_yaw_Y * forward_2_5);
    const float pivot = hall_position_max((rows_1_3_5 * rows_1_3_5) + (minus_rows_2_3_5 * minus_rows_2_3_5) +
        (rows_3_3_5 * rows_3_3_5) + (minus_rows_4_3_5 * minus_rows_4_3_5) + prior_weight_yaw - (by_yaw_X * left_3_1_5) +
        (by_yaw_Y * minus_left_3_2_5), least_pivot_yaw);
    const float step = forward_3 / pivot;
    const bool converged = better && (((forward_1_5 * forward_1_5_times_inverse_1) +
        (forward_2_5 * forward_2_5_times_inverse_2) + (forward_3 * step)) <= decrease_tolerance);
    float at_3;
    float at_1;
    float at_2;
    if (converged) {
        const float untried_3 = hall_position_limit(offsets_3_4 + step, largest_step_yaw);
        at_3 = untried_3;
        const float untried_3_minus_offsets_3_4 = untried_3 - offsets_3_4;
        at_1 = hall_position_limit(offsets_1_4 +
            (forward_1_5_times_inverse_1 - (by_yaw_X * untried_3_minus_offsets_3_4)), largest_step_phase);
        at_2 = hall_position_limit(offsets_2_4 +
            (forward_2_5_times_inverse_2 - (by_yaw_Y * untried_3_minus_offsets_3_4)), largest_step_phase);
    } else if (better) {
        at_3 = offsets_3_4;
        at_1 = offsets_1_4;
        at_2 = offsets_2_4;
    } else {
        at_3 = converged_choice_15;
        at_1 = converged_choice_16;
        at_2 = converged_choice_17;
    }
    const float yaw_last_good = state->yaw_last_good;
    const bool in_window = fabsf(prediction_yaw + at_3 - yaw_last_good) <= yaw_window;
    const bool integrity_residual_fault = (residual_limit < squares_2) ||
        ((ambiguity_resolved != 0u) ? gate_exceeded : ((searching != 0u) && !in_window));
    const uint32_t residual_faults = state->residual_faults;
    const bool exhausted = 4u <= residual_faults;
    const bool restart = integrity_residual_fault && exhausted;
    const bool tracking = searching == 0u;
    float by_phase_x = 0.0f;
    float by_phase_y = 0.0f;
    float by_yaw = 0.0f;
    float motion_x_change = 0.0f;
    float motion_y_change = 0.0f;
    float motion_yaw_change = 0.0f;
    if (!(integrity_residual_fault && tracking)) {
        by_phase_x = at_1;
        by_phase_y = at_2;
        by_yaw = at_3;
        motion_x_change = 0.5f * at_1;
        motion_y_change = 0.5f * at_2;
        motion_yaw_change = yaw_velocity_gain * at_3;
    }
    const float moved_x = prediction_phase_x + by_phase_x;
    const bool turns_x = pi < moved_x;
    float angle_x = moved_x;
    if (turns_x) {
        angle_x = moved_x - two_pi;
    }
    float pose_phase_x = angle_x;
    float X_if_acquired = -1.0f;
    if (angle_x < -pi) {
        pose_phase_x = angle_x + two_pi;
    } else {
        X_if_acquired = turns_x ? 1.0f : 0.0f;
    }
    const float moved_y = prediction_phase_y + by_phase_y;
    const bool turns_y = pi < moved_y;
    float angle_y = moved_y;
    if (turns_y) {
        angle_y = moved_y - two_pi;
    }
    float pose_phase_y = angle_y;
    float Y_if_acquired = -1.0f;
    if (angle_y < -pi) {
        pose_phase_y = angle_y + two_pi;
    } else {
        Y_if_acquired = turns_y ? 1.0f : 0.0f;
    }
    const float prediction_yaw_plus_by_yaw = prediction_yaw + by_yaw;
    float angle_yaw = prediction_yaw_plus_by_yaw;
    if (pi < prediction_yaw_plus_by_yaw) {
        angle_yaw = prediction_yaw_plus_by_yaw - two_pi;
    }
    float yaw = angle_yaw;
    if (angle_yaw < -pi) {
        yaw = angle_yaw + two_pi;
    }
    const bool faultless = !integrity_residual_fault;
    const float by_yaw_X_squared = by_yaw_X * by_yaw_X;
    const float by_yaw_Y_squared = by_yaw_Y * by_yaw_Y;
    const float yaw_variance = 1.0f / (pivot + yaw_damping);
    const float weight = ((squared_radius + by_yaw_X_squared + by_yaw_Y_squared) * yaw_variance) + inverse_1 +
        inverse_2;
    const bool damped = damped_from < weight;
    const bool integrity_good = converged && !(damped || integrity_residual_fault || gate_exceeded);
    const uint32_t acquired = state->acquired;
    const float pose_pitch_x = state->pitch_x + ((acquired != 0u) ? X_if_acquired : 0.0f);
    const float pose_pitch_y = state->pitch_y + ((acquired != 0u) ? Y_if_acquired : 0.0f);
    const bool counted = (fabsf(pose_pitch_x) <= most_pitches) && (fabsf(pose_pitch_y) <= most_pitches);
    const float size = fabsf(yaw);
    const bool inside = counted && (size <= yaw_limit);
    const bool resolved = (integrity_good && in_window && tracking && (weight <= resolved_to) && complete && inside) ||
        ((ambiguity_resolved != 0u) && !damped);
    if (restart) {
        const float start_x_plus_start_step_x = state->start_x + start_step_x;
        if (start_x_plus_start_step_x < -pi) {
            state->phase_x = start_x_plus_start_step_x + two_pi;
            state->start_x = state->phase_x;
        } else {
            state->phase_x = start_x_plus_start_step_x;
            state->start_x = start_x_plus_start_step_x;
        }
        const float start_y_plus_start_step_y = state->start_y + start_step_y;
        if (start_y_plus_start_step_y < -pi) {
            state->phase_y = start_y_plus_start_step_y + two_pi;
            state->start_y = state->phase_y;
        } else {
            state->phase_y = start_y_plus_start_step_y;
            state->start_y = start_y_plus_start_step_y;
        }
        state->yaw = yaw_last_good;
        state->searching = 1u;
        state->ambiguity_resolved = 0u;
    } else {
        state->phase_x = pose_phase_x;
        state->phase_y = pose_phase_y;
        state->yaw = yaw;
        if (converged && faultless) {
            state->searching = 0u;
        }
        state->ambiguity_resolved = hall_position_flag(resolved);
    }
    if (resolved && faultless) {
        state->yaw_last_good = yaw;
    }
    state->pitch_x = hall_position_limit(pose_pitch_x, most_pitches);
    state->pitch_y = hall_position_limit(pose_pitch_y, most_pitches);
    float continued_motion_x = 0.0f;
    float continued_motion_y = 0.0f;
    float continued_motion_yaw = 0.0f;
    if (searching == 0u) {
        continued_motion_x = motion_x + motion_x_change;
        continued_motion_y = motion_y + motion_y_change;
        continued_motion_yaw = motion_yaw + motion_yaw_change;
    }
    state->motion_x = hall_position_limit(continued_motion_x, largest_step_phase);
    state->motion_y = hall_position_limit(continued_motion_y, largest_step_phase);
    state->motion_yaw = hall_position_limit(continued_motion_yaw, largest_step_yaw);
    state->residual_faults = (integrity_residual_fault) ? ((exhausted) ? 0u : (residual_faults + 1u)) : 0u;
    state->acquired = hall_position_flag(resolved || (acquired != 0u));
    const uint32_t lock_lost = state->lock_lost;
    state->lock_lost = hall_position_flag((lock_lost != 0u) ||
        ((acquired != 0u) && (restart || !counted || (((resolved) ? yaw_limit : ambiguous_yaw_limit) < size))));
    return (hall_position_estimator_t){.X = (length_per_phase * pose_phase_x) + (pitch * pose_pitch_x),
        .Y = (length_per_phase * pose_phase_y) + (pitch * pose_pitch_y), .yaw = yaw,
        .deviation_X = sigma_per_wave_number * sqrtf(inverse_1 + (by_yaw_X_squared * yaw_variance)),
        .deviation_Y = sigma_per_wave_number * sqrtf(inverse_2 + (by_yaw_Y_squared * yaw_variance)), .deviation_yaw =
        channel_sigma * sqrtf(yaw_variance), .residual = sqrtf(root_regularisation + squares_2), .converged = converged,
        .damped = damped, .valid = integrity_good && resolved && (lock_lost == 0u) && inside && complete};
}

/* Each input in its range, else what is held or refused, with its bit of the fault word. */
HALL_POSITION_INLINE hall_position_input_t hall_position_guard_inputs(hall_position_state_t *state,
    const hall_position_input_t *in, uint32_t *faults)
{
    hall_position_input_t accepted = *in;
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
