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

/* guard: range acceptance, hold, latch
 *     left_next = latch_samples if complete is set, else (left if left <= 1, else left - 1) */
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

/* estimator: GLSDC, Fig. 9
 *     yaw_part_sine = 4 * sin(0.25 * (estimator_yaw + motion_yaw))
 *     yaw_part_cosine = cos(0.25 * (estimator_yaw + motion_yaw))
 *     ax_part_sine = 8 * sin(0.125 * limited_ax); likewise ay_part_sine, bx_part_sine, by_part_sine
 *     ax_part_cosine = cos(0.125 * limited_ax); likewise ay_part_cosine, bx_part_cosine, by_part_cosine
 *     ax_part_doubled = limit(8 * (sin(0.125 * limited_ax) * ax_part_cosine * (1 - 0.03125 *
 *         ax_part_sine^2)), 2.002); likewise ay_part_doubled, bx_part_doubled, by_part_doubled
 *     ax_part_full = limit(ax_part_doubled * (1 - 0.125 * sines_2_ax^2), 1.001); likewise ay_part_full,
 *         bx_part_full, by_part_full
 *     deviation_X = sigma_per_wave_number * sqrt(inverse_1 + by_yaw_X^2 * yaw_variance); likewise
 *         deviation_Y
 *     valid = integrity_good and (resolved and not lock_lost and (inside and complete))
 *     phase_x_next = (start_x + start_step_x + two_pi if start_x + start_step_x < -pi, else start_x +
 *         start_step_x) if restart, else pose_phase_x; likewise phase_y_next
 *     start_x_next = (start_x + start_step_x + two_pi if start_x + start_step_x < -pi, else start_x +
 *         start_step_x) if restart, else start_x; likewise start_y_next
 *     lock_lost_next = lock_lost or acquired and (restart or (not counted or (yaw_limit if resolved, else
 *         ambiguous_yaw_limit) < size)) */
HALL_POSITION_LARGE hall_position_estimator_t hall_position_estimator(hall_position_estimator_state_t *state,
    float V_ax_held, float V_ay_held, float V_bx_held, float V_by_held, bool complete)
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
    static const float pi = 3.1415927f;                         /* 1; pi */
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
    const float s_yaw = hall_position_limit(4.0f * (sine * yaw_part_cosine), 2.0f);
    const float heading_cosine = 1.0f - (0.5f * (s_yaw * s_yaw));
    const float arm_times_heading_cosine = arm * heading_cosine;
    const float heading_sine = hall_position_limit(s_yaw * (1.0f - (0.125f * (yaw_part_sine * yaw_part_sine))), 1.0f);
    const float arm_times_heading_sine = arm * heading_sine;
    const float limited_ax = hall_position_limit(prediction_phase_x - arm_times_heading_cosine + arm_times_heading_sine,
        largest_phase);
    const float ax_part_cosine_argument = limited_ax * limited_ax;
    const float sine_2 = limited_ax * sine_2_polynomial(ax_part_cosine_argument);
    const float ax_part_sine = 8.0f * sine_2;
    const float ax_part_cosine = part_cosine_polynomial(ax_part_cosine_argument);
    const float sine_2_times_ax_part_cosine = sine_2 * ax_part_cosine;
    const float ax_part_doubled = 8.0f *
        (sine_2_times_ax_part_cosine * (1.0f - (0.03125f * (ax_part_sine * ax_part_sine))));
    /*@ admit -2.002f <= ax_part_doubled <= 2.002f; */
    const float sines_2_ax = 8.0f * sine_2_times_ax_part_cosine;
    const float ax_part_full = ax_part_doubled * (1.0f - (0.125f * (sines_2_ax * sines_2_ax)));
    /*@ admit -1.001f <= ax_part_full <= 1.001f; */
    const float motion_y = state->motion_y;
    const float prediction_phase_y = state->phase_y + motion_y;
    const float limited_ay = hall_position_limit(prediction_phase_y - arm_times_heading_cosine - arm_times_heading_sine,
        largest_phase);
    const float ay_part_cosine_argument = limited_ay * limited_ay;
    const float sine_2_2 = limited_ay * sine_2_polynomial(ay_part_cosine_argument);
    const float ay_part_sine = 8.0f * sine_2_2;
    const float ay_part_cosine = part_cosine_polynomial(ay_part_cosine_argument);
    const float ay_part_doubled_product = sine_2_2 * ay_part_cosine;
    const float ay_part_doubled = 8.0f *
        (ay_part_doubled_product * (1.0f - (0.03125f * (ay_part_sine * ay_part_sine))));
    /*@ admit -2.002f <= ay_part_doubled <= 2.002f; */
    const float sines_2_ay = 8.0f * ay_part_doubled_product;
    const float ay_part_full = ay_part_doubled * (1.0f - (0.125f * (sines_2_ay * sines_2_ay)));
    /*@ admit -1.001f <= ay_part_full <= 1.001f; */
    const float limited_bx = hall_position_limit(prediction_phase_x + arm_times_heading_cosine - arm_times_heading_sine,
        largest_phase);
    const float bx_part_cosine_argument = limited_bx * limited_bx;
    const float sine_2_3 = limited_bx * sine_2_polynomial(bx_part_cosine_argument);
    const float bx_part_sine = 8.0f * sine_2_3;
    const float bx_part_cosine = part_cosine_polynomial(bx_part_cosine_argument);
    const float bx_part_doubled_product = sine_2_3 * bx_part_cosine;
    const float bx_part_doubled = 8.0f *
        (bx_part_doubled_product * (1.0f - (0.03125f * (bx_part_sine * bx_part_sine))));
    /*@ admit -2.002f <= bx_part_doubled <= 2.002f; */
    const float sines_2_bx = 8.0f * bx_part_doubled_product;
    const float bx_part_full = bx_part_doubled * (1.0f - (0.125f * (sines_2_bx * sines_2_bx)));
    /*@ admit -1.001f <= bx_part_full <= 1.001f; */
    const float limited_by = hall_position_limit(prediction_phase_y + arm_times_heading_cosine + arm_times_heading_sine,
        largest_phase);
    const float by_part_cosine_argument = limited_by * limited_by;
    const float sine_2_4 = limited_by * sine_2_polynomial(by_part_cosine_argument);
    const float by_part_sine = 8.0f * sine_2_4;
    const float by_part_cosine = part_cosine_polynomial(by_part_cosine_argument);
    const float by_part_doubled_product = sine_2_4 * by_part_cosine;
    const float by_part_doubled = 8.0f *
        (by_part_doubled_product * (1.0f - (0.03125f * (by_part_sine * by_part_sine))));
    /*@ admit -2.002f <= by_part_doubled <= 2.002f; */
    const float sines_2_by = 8.0f * by_part_doubled_product;
    const float by_part_full = by_part_doubled * (1.0f - (0.125f * (sines_2_by * sines_2_by)));
    /*@ admit -1.001f <= by_part_full <= 1.001f; */
    const float start_cosine_ax = 1.0f - (0.5f * (ax_part_doubled * ax_part_doubled));
    const float ax_part_full_squared = ax_part_full * ax_part_full;
    const float field_3_scaled = 3.0f * field_3;
    const float converged_product = ax_part_full_squared * field_5;
    const float rows_1_1_converged = start_cosine_ax * (field_1 +
        (ax_part_full_squared * (field_3_scaled + (5.0f * converged_product))));
    const float ay_part_full_squared = ay_part_full * ay_part_full;
    const float converged_product_2 = ay_part_full_squared * field_5;
    const float converged_product_3 = ay_part_full * (field_1 +
        (ay_part_full_squared * (field_3 + converged_product_2)));
    const float rows_1_3_converged = (rows_1_1_converged * (arm_times_heading_cosine + arm_times_heading_sine)) +
        converged_product_3;
    const float converged_product_4 = ax_part_full * (field_1 + (ax_part_full_squared * (field_3 + converged_product)));
    const float residuals_1_converged = (heading_cosine * V_ax_held) - (heading_sine * V_ay_held) - converged_product_4;
    const float start_cosine_ay = 1.0f - (0.5f * (ay_part_doubled * ay_part_doubled));
    const float rows_2_2_converged = start_cosine_ay * (field_1 +
        (ay_part_full_squared * (field_3_scaled + (5.0f * converged_product_2))));
    const float minus_rows_2_3_converged = converged_product_4 -
        (rows_2_2_converged * (arm_times_heading_sine - arm_times_heading_cosine));
    const float residuals_2_converged = (heading_cosine * V_ay_held) + (heading_sine * V_ax_held) - converged_product_3;
    const float start_cosine_bx = 1.0f - (0.5f * (bx_part_doubled * bx_part_doubled));
    const float bx_part_full_squared = bx_part_full * bx_part_full;
    const float converged_product_5 = bx_part_full_squared * field_5;
    const float rows_3_1_converged = start_cosine_bx * (field_1 +
        (bx_part_full_squared * (field_3_scaled + (5.0f * converged_product_5))));
    const float by_part_full_squared = by_part_full * by_part_full;
    const float converged_product_6 = by_part_full_squared * field_5;
    const float converged_product_7 = by_part_full * (field_1 +
        (by_part_full_squared * (field_3 + converged_product_6)));
    const float rows_3_3_converged = (rows_3_1_converged * ((-arm * heading_cosine) - arm_times_heading_sine)) +
        converged_product_7;
    const float converged_product_8 = bx_part_full * (field_1 +
        (bx_part_full_squared * (field_3 + converged_product_5)));
    const float residuals_3_converged = (heading_cosine * V_bx_held) - (heading_sine * V_by_held) - converged_product_8;
    const float start_cosine_by = 1.0f - (0.5f * (by_part_doubled * by_part_doubled));
    const float rows_4_2_converged = start_cosine_by * (field_1 +
        (by_part_full_squared * (field_3_scaled + (5.0f * converged_product_6))));
    const float minus_rows_4_3_converged = converged_product_8 -
        (rows_4_2_converged * (arm_times_heading_cosine - arm_times_heading_sine));
    const float residuals_4_converged = (heading_cosine * V_by_held) + (heading_sine * V_bx_held) - converged_product_7;
    const float left_3_1_converged = (rows_1_3_converged * rows_1_1_converged) +
        (rows_3_3_converged * rows_3_1_converged);
    const float converged_inverse = 1.0f /
        ((rows_1_1_converged * rows_1_1_converged) + (rows_3_1_converged * rows_3_1_converged) + prior_weight_phase);
    const float lower_3_1_converged = hall_position_limit(left_3_1_converged * converged_inverse, largest_L_yaw_phase);
    const float gradient_1_converged = (rows_1_1_converged * residuals_1_converged) +
        (rows_3_1_converged * residuals_3_converged);
    const float minus_left_3_2_converged = (minus_rows_2_3_converged * rows_2_2_converged) +
        (minus_rows_4_3_converged * rows_4_2_converged);
    const float converged_inverse_2 = 1.0f /
        ((rows_2_2_converged * rows_2_2_converged) + (rows_4_2_converged * rows_4_2_converged) + prior_weight_phase);
    const float lower_3_2_converged = hall_position_limit(-(minus_left_3_2_converged * converged_inverse_2),
        largest_L_yaw_phase);
    const float gradient_2_converged = (rows_2_2_converged * residuals_2_converged) +
        (rows_4_2_converged * residuals_4_converged);
    const float converged_denominator = hall_position_max((rows_1_3_converged * rows_1_3_converged) +
        (minus_rows_2_3_converged * minus_rows_2_3_converged) + (rows_3_3_converged * rows_3_3_converged) +
        (minus_rows_4_3_converged * minus_rows_4_3_converged) + prior_weight_yaw -
        (lower_3_1_converged * left_3_1_converged) + (lower_3_2_converged * minus_left_3_2_converged), least_pivot_yaw);
    const float then_3_converged = hall_position_limit(((rows_1_3_converged * residuals_1_converged) -
        (minus_rows_2_3_converged * residuals_2_converged) + (rows_3_3_converged * residuals_3_converged) -
        (minus_rows_4_3_converged * residuals_4_converged) - (lower_3_1_converged * gradient_1_converged) -
        (lower_3_2_converged * gradient_2_converged)) / converged_denominator, largest_step_yaw);
    const float then_3_converged_squared = then_3_converged * then_3_converged;
    const float sine_converged = then_3_converged * sine_3_polynomial(then_3_converged_squared);
    const float half_converged = then_3_converged * tangent_polynomial(then_3_converged_squared);
    const float fall_converged = sine_converged * ((half_converged * heading_cosine) + heading_sine);
    const float turns_3_cosine_converged = heading_cosine - fall_converged;
    const float chords_3_sine_converged = sine_converged * (heading_cosine - (half_converged * heading_sine));
    const float turns_3_sine_converged = heading_sine + chords_3_sine_converged;
    const float then_1_converged = hall_position_limit((gradient_1_converged * converged_inverse) -
        (lower_3_1_converged * then_3_converged), largest_step_phase);
    const float converged_product_9 = arm * hall_position_limit(-fall_converged, largest_step_yaw);
    const float converged_product_10 = arm * hall_position_limit(chords_3_sine_converged, largest_step_yaw);
    const float by_ax_converged = then_1_converged - converged_product_9 + converged_product_10;
    const float cosine_argument = by_ax_converged * by_ax_converged;
    const float by_cosine_ax_converged = cosine_polynomial(cosine_argument);
    const float by_sine_ax_converged = by_ax_converged * sine_4_polynomial(cosine_argument);
    const float phasors_1_sine_converged = (ax_part_full * by_cosine_ax_converged) +
        (start_cosine_ax * by_sine_ax_converged);
    const float converged_square = phasors_1_sine_converged * phasors_1_sine_converged;
    const float converged_product_11 = converged_square * field_5;
    const float converged_product_12 = phasors_1_sine_converged * (field_1 +
        (converged_square * (field_3 + converged_product_11)));
    const float residuals_1_converged_2 = (turns_3_cosine_converged * V_ax_held) -
        (turns_3_sine_converged * V_ay_held) - converged_product_12;
    const float then_2_converged = hall_position_limit((gradient_2_converged * converged_inverse_2) -
        (lower_3_2_converged * then_3_converged), largest_step_phase);
    const float by_ay_converged = then_2_converged - converged_product_9 - converged_product_10;
    const float cosine_argument_2 = by_ay_converged * by_ay_converged;
    const float by_cosine_ay_converged = cosine_polynomial(cosine_argument_2);
    const float by_sine_ay_converged = by_ay_converged * sine_4_polynomial(cosine_argument_2);
    const float phasors_2_sine_converged = (ay_part_full * by_cosine_ay_converged) +
        (start_cosine_ay * by_sine_ay_converged);
    const float converged_square_2 = phasors_2_sine_converged * phasors_2_sine_converged;
    const float converged_product_13 = converged_square_2 * field_5;
    const float converged_product_14 = phasors_2_sine_converged * (field_1 +
        (converged_square_2 * (field_3 + converged_product_13)));
    const float residuals_2_converged_2 = (turns_3_cosine_converged * V_ay_held) +
        (turns_3_sine_converged * V_ax_held) - converged_product_14;
    const float by_bx_converged = then_1_converged + converged_product_9 - converged_product_10;
    const float cosine_argument_3 = by_bx_converged * by_bx_converged;
    const float by_cosine_bx_converged = cosine_polynomial(cosine_argument_3);
    const float by_sine_bx_converged = by_bx_converged * sine_4_polynomial(cosine_argument_3);
    const float phasors_3_sine_converged = (bx_part_full * by_cosine_bx_converged) +
        (start_cosine_bx * by_sine_bx_converged);
    const float converged_square_3 = phasors_3_sine_converged * phasors_3_sine_converged;
    const float converged_product_15 = converged_square_3 * field_5;
    const float converged_product_16 = phasors_3_sine_converged * (field_1 +
        (converged_square_3 * (field_3 + converged_product_15)));
    const float residuals_3_converged_2 = (turns_3_cosine_converged * V_bx_held) -
        (turns_3_sine_converged * V_by_held) - converged_product_16;
    const float by_converged = then_2_converged + converged_product_9 + converged_product_10;
    const float cosine_argument_4 = by_converged * by_converged;
    const float by_cosine_converged = cosine_polynomial(cosine_argument_4);
    const float by_sine_converged = by_converged * sine_4_polynomial(cosine_argument_4);
    const float phasors_4_sine_converged = (by_part_full * by_cosine_converged) + (start_cosine_by * by_sine_converged);
    const float converged_square_4 = phasors_4_sine_converged * phasors_4_sine_converged;
    const float converged_product_17 = converged_square_4 * field_5;
    const float converged_product_18 = phasors_4_sine_converged * (field_1 +
        (converged_square_4 * (field_3 + converged_product_17)));
    const float residuals_4_converged_2 = (turns_3_cosine_converged * V_by_held) +
        (turns_3_sine_converged * V_bx_held) - converged_product_18;
    const float cost_converged = (residuals_1_converged_2 * residuals_1_converged_2) + (residuals_2_converged_2 *
        residuals_2_converged_2) + (residuals_3_converged_2 * residuals_3_converged_2) + (residuals_4_converged_2 *
        residuals_4_converged_2) + ((prior_weight_phase * (then_1_converged * then_1_converged)) +
        (prior_weight_phase * (then_2_converged * then_2_converged)) + (prior_weight_yaw * then_3_converged_squared));
    const float squares_converged = (residuals_1_converged * residuals_1_converged) +
        (residuals_2_converged * residuals_2_converged) + (residuals_3_converged * residuals_3_converged) +
        (residuals_4_converged * residuals_4_converged);
    const bool better_converged = cost_converged <= ((rounding_factor * squares_converged) + slack);
    const float rows_1_1_converged_2 = ((start_cosine_ax * by_cosine_ax_converged) - (ax_part_full *
        by_sine_ax_converged)) * (field_1 + (converged_square * (field_3_scaled + (5.0f * converged_product_11))));
    const float converged_product_19 = arm * turns_3_cosine_converged;
    const float converged_product_20 = arm * turns_3_sine_converged;
    const float rows_1_3_converged_2 = (rows_1_1_converged_2 * (converged_product_19 + converged_product_20)) +
        converged_product_14;
    const float rows_2_2_converged_2 = ((start_cosine_ay * by_cosine_ay_converged) - (ay_part_full *
        by_sine_ay_converged)) * (field_1 + (converged_square_2 * (field_3_scaled + (5.0f * converged_product_13))));
    const float minus_rows_2_3_converged_2 = converged_product_12 -
        (rows_2_2_converged_2 * (converged_product_20 - converged_product_19));
    const float rows_3_1_converged_2 = ((start_cosine_bx * by_cosine_bx_converged) - (bx_part_full *
        by_sine_bx_converged)) * (field_1 + (converged_square_3 * (field_3_scaled + (5.0f * converged_product_15))));
    const float rows_3_3_converged_2 = (rows_3_1_converged_2 * ((-arm * turns_3_cosine_converged) -
        converged_product_20)) + converged_product_18;
    const float rows_4_2_converged_2 = ((start_cosine_by * by_cosine_converged) - (by_part_full * by_sine_converged)) *
        (field_1 + (converged_square_4 * (field_3_scaled + (5.0f * converged_product_17))));
    const float minus_rows_4_3_converged_2 = converged_product_16 -
        (rows_4_2_converged_2 * (converged_product_19 - converged_product_20));
    const float left_3_1_converged_2 = (rows_1_3_converged_2 * rows_1_1_converged_2) +
        (rows_3_3_converged_2 * rows_3_1_converged_2);
    const float converged_inverse_3 = 1.0f / ((rows_1_1_converged_2 * rows_1_1_converged_2) +
        (rows_3_1_converged_2 * rows_3_1_converged_2) + prior_weight_phase);
    const float lower_3_1_converged_2 = hall_position_limit(left_3_1_converged_2 * converged_inverse_3,
        largest_L_yaw_phase);
    const float gradient_1_converged_2 = (rows_1_1_converged_2 * residuals_1_converged_2) +
        (rows_3_1_converged_2 * residuals_3_converged_2) - (prior_weight_phase * then_1_converged);
    const float minus_left_3_2_converged_2 = (minus_rows_2_3_converged_2 * rows_2_2_converged_2) +
        (minus_rows_4_3_converged_2 * rows_4_2_converged_2);
    const float converged_inverse_4 = 1.0f / ((rows_2_2_converged_2 * rows_2_2_converged_2) +
        (rows_4_2_converged_2 * rows_4_2_converged_2) + prior_weight_phase);
    const float lower_3_2_converged_2 = hall_position_limit(-(minus_left_3_2_converged_2 * converged_inverse_4),
        largest_L_yaw_phase);
    const float gradient_2_converged_2 = (rows_2_2_converged_2 * residuals_2_converged_2) +
        (rows_4_2_converged_2 * residuals_4_converged_2) - (prior_weight_phase * then_2_converged);
    float other_3_converged = then_3_converged;
    float other_1_converged = then_1_converged;
    float other_2_converged = then_2_converged;
    float converged_choice = cost_converged;
    if (!better_converged) {
        other_3_converged = 0.0f;
        other_1_converged = 0.0f;
        other_2_converged = 0.0f;
        converged_choice = squares_converged;
    }
    float converged_choice_2;
    if (better_converged) {
        const float converged_denominator_2 = hall_position_max((rows_1_3_converged_2 * rows_1_3_converged_2) +
            (minus_rows_2_3_converged_2 * minus_rows_2_3_converged_2) + (rows_3_3_converged_2 * rows_3_3_converged_2) +
            (minus_rows_4_3_converged_2 * minus_rows_4_3_converged_2) + prior_weight_yaw - (lower_3_1_converged_2 *
            left_3_1_converged_2) + (lower_3_2_converged_2 * minus_left_3_2_converged_2), least_pivot_yaw);
        converged_choice_2 = then_3_converged + (((rows_1_3_converged_2 * residuals_1_converged_2) -
            (minus_rows_2_3_converged_2 * residuals_2_converged_2) + (rows_3_3_converged_2 * residuals_3_converged_2) -
            (minus_rows_4_3_converged_2 * residuals_4_converged_2) - (prior_weight_yaw * then_3_converged) -
            (lower_3_1_converged_2 * gradient_1_converged_2) - (lower_3_2_converged_2 * gradient_2_converged_2)) /
            converged_denominator_2);
    } else {
        converged_choice_2 = 0.5f * (then_3_converged + other_3_converged);
    }
    const float then_3_converged_2 = hall_position_limit(converged_choice_2, largest_step_yaw);
    const float then_3_converged_2_squared = then_3_converged_2 * then_3_converged_2;
    const float sine_converged_2 = then_3_converged_2 * sine_3_polynomial(then_3_converged_2_squared);
    const float half_converged_2 = then_3_converged_2 * tangent_polynomial(then_3_converged_2_squared);
    const float fall_converged_2 = sine_converged_2 * ((half_converged_2 * heading_cosine) + heading_sine);
    const float turns_3_cosine_converged_2 = heading_cosine - fall_converged_2;
    const float chords_3_sine_converged_2 = sine_converged_2 * (heading_cosine - (half_converged_2 * heading_sine));
    const float turns_3_sine_converged_2 = heading_sine + chords_3_sine_converged_2;
    float converged_choice_3;
    float converged_choice_4;
    if (better_converged) {
        const float moves_3_converged = then_3_converged_2 - then_3_converged;
        converged_choice_3 = then_1_converged +
            ((gradient_1_converged_2 * converged_inverse_3) - (lower_3_1_converged_2 * moves_3_converged));
        converged_choice_4 = then_2_converged +
            ((gradient_2_converged_2 * converged_inverse_4) - (lower_3_2_converged_2 * moves_3_converged));
    } else {
        converged_choice_3 = 0.5f * (then_1_converged + other_1_converged);
        converged_choice_4 = 0.5f * (then_2_converged + other_2_converged);
    }
    const float then_1_converged_2 = hall_position_limit(converged_choice_3, largest_step_phase);
    const float converged_product_21 = arm * hall_position_limit(-fall_converged_2, largest_step_yaw);
    const float converged_product_22 = arm * hall_position_limit(chords_3_sine_converged_2, largest_step_yaw);
    const float by_ax_converged_2 = hall_position_limit(then_1_converged_2 - converged_product_21 +
        converged_product_22, largest_change);
    const float cosine_argument_5 = by_ax_converged_2 * by_ax_converged_2;
    const float by_cosine_ax_converged_2 = cosine_polynomial(cosine_argument_5);
    const float by_sine_ax_converged_2 = by_ax_converged_2 * sine_4_polynomial(cosine_argument_5);
    const float phasors_1_sine_converged_2 = (ax_part_full * by_cosine_ax_converged_2) +
        (start_cosine_ax * by_sine_ax_converged_2);
    const float converged_square_5 = phasors_1_sine_converged_2 * phasors_1_sine_converged_2;
    const float converged_product_23 = converged_square_5 * field_5;
    const float converged_product_24 = phasors_1_sine_converged_2 * (field_1 +
        (converged_square_5 * (field_3 + converged_product_23)));
    const float residuals_1_converged_3 = (turns_3_cosine_converged_2 * V_ax_held) -
        (turns_3_sine_converged_2 * V_ay_held) - converged_product_24;
    const float then_2_converged_2 = hall_position_limit(converged_choice_4, largest_step_phase);
    const float by_ay_converged_2 = hall_position_limit(then_2_converged_2 - converged_product_21 -
        converged_product_22, largest_change);
    const float cosine_argument_6 = by_ay_converged_2 * by_ay_converged_2;
    const float by_cosine_ay_converged_2 = cosine_polynomial(cosine_argument_6);
    const float by_sine_ay_converged_2 = by_ay_converged_2 * sine_4_polynomial(cosine_argument_6);
    const float phasors_2_sine_converged_2 = (ay_part_full * by_cosine_ay_converged_2) +
        (start_cosine_ay * by_sine_ay_converged_2);
    const float converged_square_6 = phasors_2_sine_converged_2 * phasors_2_sine_converged_2;
    const float converged_product_25 = converged_square_6 * field_5;
    const float converged_product_26 = phasors_2_sine_converged_2 * (field_1 +
        (converged_square_6 * (field_3 + converged_product_25)));
    const float residuals_2_converged_3 = (turns_3_cosine_converged_2 * V_ay_held) +
        (turns_3_sine_converged_2 * V_ax_held) - converged_product_26;
    const float by_bx_converged_2 = hall_position_limit(then_1_converged_2 + converged_product_21 -
        converged_product_22, largest_change);
    const float cosine_argument_7 = by_bx_converged_2 * by_bx_converged_2;
    const float by_cosine_bx_converged_2 = cosine_polynomial(cosine_argument_7);
    const float by_sine_bx_converged_2 = by_bx_converged_2 * sine_4_polynomial(cosine_argument_7);
    const float phasors_3_sine_converged_2 = (bx_part_full * by_cosine_bx_converged_2) +
        (start_cosine_bx * by_sine_bx_converged_2);
    const float converged_square_7 = phasors_3_sine_converged_2 * phasors_3_sine_converged_2;
    const float converged_product_27 = converged_square_7 * field_5;
    const float converged_product_28 = phasors_3_sine_converged_2 * (field_1 +
        (converged_square_7 * (field_3 + converged_product_27)));
    const float residuals_3_converged_3 = (turns_3_cosine_converged_2 * V_bx_held) -
        (turns_3_sine_converged_2 * V_by_held) - converged_product_28;
    const float by_converged_2 = hall_position_limit(then_2_converged_2 + converged_product_21 + converged_product_22,
        largest_change);
    const float cosine_argument_8 = by_converged_2 * by_converged_2;
    const float by_cosine_converged_2 = cosine_polynomial(cosine_argument_8);
    const float by_sine_converged_2 = by_converged_2 * sine_4_polynomial(cosine_argument_8);
    const float phasors_4_sine_converged_2 = (by_part_full * by_cosine_converged_2) +
        (start_cosine_by * by_sine_converged_2);
    const float converged_square_8 = phasors_4_sine_converged_2 * phasors_4_sine_converged_2;
    const float converged_product_29 = converged_square_8 * field_5;
    const float converged_product_30 = phasors_4_sine_converged_2 * (field_1 +
        (converged_square_8 * (field_3 + converged_product_29)));
    const float residuals_4_converged_3 = (turns_3_cosine_converged_2 * V_by_held) +
        (turns_3_sine_converged_2 * V_bx_held) - converged_product_30;
    const float cost_converged_2 = (residuals_1_converged_3 * residuals_1_converged_3) +
        (residuals_2_converged_3 * residuals_2_converged_3) + (residuals_3_converged_3 * residuals_3_converged_3) +
        (residuals_4_converged_3 * residuals_4_converged_3) +
        ((prior_weight_phase * (then_1_converged_2 * then_1_converged_2)) + (prior_weight_phase *
        (then_2_converged_2 * then_2_converged_2)) + (prior_weight_yaw * then_3_converged_2_squared));
    const bool better_converged_2 = cost_converged_2 <= ((rounding_factor * converged_choice) + slack);
    const float rows_1_1_converged_3 = ((start_cosine_ax * by_cosine_ax_converged_2) - (ax_part_full *
        by_sine_ax_converged_2)) * (field_1 + (converged_square_5 * (field_3_scaled + (5.0f * converged_product_23))));
    const float converged_product_31 = arm * turns_3_cosine_converged_2;
    const float converged_product_32 = arm * turns_3_sine_converged_2;
    const float rows_1_3_converged_3 = (rows_1_1_converged_3 * (converged_product_31 + converged_product_32)) +
        converged_product_26;
    const float rows_2_2_converged_3 = ((start_cosine_ay * by_cosine_ay_converged_2) - (ay_part_full *
        by_sine_ay_converged_2)) * (field_1 + (converged_square_6 * (field_3_scaled + (5.0f * converged_product_25))));
    const float minus_rows_2_3_converged_3 = converged_product_24 -
        (rows_2_2_converged_3 * (converged_product_32 - converged_product_31));
    const float rows_3_1_converged_3 = ((start_cosine_bx * by_cosine_bx_converged_2) - (bx_part_full *
        by_sine_bx_converged_2)) * (field_1 + (converged_square_7 * (field_3_scaled + (5.0f * converged_product_27))));
    const float rows_3_3_converged_3 = (rows_3_1_converged_3 * ((-arm * turns_3_cosine_converged_2) -
        converged_product_32)) + converged_product_30;
    const float rows_4_2_converged_3 = ((start_cosine_by * by_cosine_converged_2) - (by_part_full *
        by_sine_converged_2)) * (field_1 + (converged_square_8 * (field_3_scaled + (5.0f * converged_product_29))));
    const float minus_rows_4_3_converged_3 = converged_product_28 -
        (rows_4_2_converged_3 * (converged_product_31 - converged_product_32));
    const float left_3_1_converged_3 = (rows_1_3_converged_3 * rows_1_1_converged_3) +
        (rows_3_3_converged_3 * rows_3_1_converged_3);
    const float converged_inverse_5 = 1.0f / ((rows_1_1_converged_3 * rows_1_1_converged_3) +
        (rows_3_1_converged_3 * rows_3_1_converged_3) + prior_weight_phase);
    const float lower_3_1_converged_3 = hall_position_limit(left_3_1_converged_3 * converged_inverse_5,
        largest_L_yaw_phase);
    const float gradient_1_converged_3 = (rows_1_1_converged_3 * residuals_1_converged_3) +
        (rows_3_1_converged_3 * residuals_3_converged_3) - (prior_weight_phase * then_1_converged_2);
    const float minus_left_3_2_converged_3 = (minus_rows_2_3_converged_3 * rows_2_2_converged_3) +
        (minus_rows_4_3_converged_3 * rows_4_2_converged_3);
    const float converged_inverse_6 = 1.0f / ((rows_2_2_converged_3 * rows_2_2_converged_3) +
        (rows_4_2_converged_3 * rows_4_2_converged_3) + prior_weight_phase);
    const float lower_3_2_converged_3 = hall_position_limit(-(minus_left_3_2_converged_3 * converged_inverse_6),
        largest_L_yaw_phase);
    const float gradient_2_converged_3 = (rows_2_2_converged_3 * residuals_2_converged_3) +
        (rows_4_2_converged_3 * residuals_4_converged_3) - (prior_weight_phase * then_2_converged_2);
    float other_3_converged_2 = then_3_converged_2;
    float other_1_converged_2 = then_1_converged_2;
    float other_2_converged_2 = then_2_converged_2;
    float converged_choice_5 = cost_converged_2;
    if (!better_converged_2) {
        other_3_converged_2 = other_3_converged;
        other_1_converged_2 = other_1_converged;
        other_2_converged_2 = other_2_converged;
        converged_choice_5 = converged_choice;
    }
    float converged_choice_6;
    if (better_converged_2) {
        const float converged_denominator_3 = hall_position_max((rows_1_3_converged_3 * rows_1_3_converged_3) +
            (minus_rows_2_3_converged_3 * minus_rows_2_3_converged_3) + (rows_3_3_converged_3 * rows_3_3_converged_3) +
            (minus_rows_4_3_converged_3 * minus_rows_4_3_converged_3) + prior_weight_yaw - (lower_3_1_converged_3 *
            left_3_1_converged_3) + (lower_3_2_converged_3 * minus_left_3_2_converged_3), least_pivot_yaw);
        converged_choice_6 = then_3_converged_2 + (((rows_1_3_converged_3 * residuals_1_converged_3) -
            (minus_rows_2_3_converged_3 * residuals_2_converged_3) + (rows_3_3_converged_3 * residuals_3_converged_3) -
            (minus_rows_4_3_converged_3 * residuals_4_converged_3) - (prior_weight_yaw * then_3_converged_2) -
            (lower_3_1_converged_3 * gradient_1_converged_3) - (lower_3_2_converged_3 * gradient_2_converged_3)) /
            converged_denominator_3);
    } else {
        converged_choice_6 = 0.5f * (then_3_converged_2 + other_3_converged_2);
    }
    const float then_3_converged_3 = hall_position_limit(converged_choice_6, largest_step_yaw);
    const float then_3_converged_3_squared = then_3_converged_3 * then_3_converged_3;
    const float sine_converged_3 = then_3_converged_3 * sine_3_polynomial(then_3_converged_3_squared);
    const float half_converged_3 = then_3_converged_3 * tangent_polynomial(then_3_converged_3_squared);
    const float fall_converged_3 = sine_converged_3 * ((half_converged_3 * heading_cosine) + heading_sine);
    const float turns_3_cosine_converged_3 = heading_cosine - fall_converged_3;
    const float chords_3_sine_converged_3 = sine_converged_3 * (heading_cosine - (half_converged_3 * heading_sine));
    const float turns_3_sine_converged_3 = heading_sine + chords_3_sine_converged_3;
    float converged_choice_7;
    float converged_choice_8;
    if (better_converged_2) {
        const float moves_3_converged_2 = then_3_converged_3 - then_3_converged_2;
        converged_choice_7 = then_1_converged_2 +
            ((gradient_1_converged_3 * converged_inverse_5) - (lower_3_1_converged_3 * moves_3_converged_2));
        converged_choice_8 = then_2_converged_2 +
            ((gradient_2_converged_3 * converged_inverse_6) - (lower_3_2_converged_3 * moves_3_converged_2));
    } else {
        converged_choice_7 = 0.5f * (then_1_converged_2 + other_1_converged_2);
        converged_choice_8 = 0.5f * (then_2_converged_2 + other_2_converged_2);
    }
    const float then_1_converged_3 = hall_position_limit(converged_choice_7, largest_step_phase);
    const float converged_product_33 = arm * hall_position_limit(-fall_converged_3, largest_step_yaw);
    const float converged_product_34 = arm * hall_position_limit(chords_3_sine_converged_3, largest_step_yaw);
    const float by_ax_converged_3 = hall_position_limit(then_1_converged_3 - converged_product_33 +
        converged_product_34, largest_change);
    const float cosine_argument_9 = by_ax_converged_3 * by_ax_converged_3;
    const float by_cosine_ax_converged_3 = cosine_polynomial(cosine_argument_9);
    const float by_sine_ax_converged_3 = by_ax_converged_3 * sine_4_polynomial(cosine_argument_9);
    const float phasors_1_sine_converged_3 = (ax_part_full * by_cosine_ax_converged_3) +
        (start_cosine_ax * by_sine_ax_converged_3);
    const float converged_square_9 = phasors_1_sine_converged_3 * phasors_1_sine_converged_3;
    const float converged_product_35 = converged_square_9 * field_5;
    const float converged_product_36 = phasors_1_sine_converged_3 * (field_1 +
        (converged_square_9 * (field_3 + converged_product_35)));
    const float residuals_1_converged_4 = (turns_3_cosine_converged_3 * V_ax_held) -
        (turns_3_sine_converged_3 * V_ay_held) - converged_product_36;
    const float then_2_converged_3 = hall_position_limit(converged_choice_8, largest_step_phase);
    const float by_ay_converged_3 = hall_position_limit(then_2_converged_3 - converged_product_33 -
        converged_product_34, largest_change);
    const float cosine_argument_10 = by_ay_converged_3 * by_ay_converged_3;
    const float by_cosine_ay_converged_3 = cosine_polynomial(cosine_argument_10);
    const float by_sine_ay_converged_3 = by_ay_converged_3 * sine_4_polynomial(cosine_argument_10);
    const float phasors_2_sine_converged_3 = (ay_part_full * by_cosine_ay_converged_3) +
        (start_cosine_ay * by_sine_ay_converged_3);
    const float converged_square_10 = phasors_2_sine_converged_3 * phasors_2_sine_converged_3;
    const float converged_product_37 = converged_square_10 * field_5;
    const float converged_product_38 = phasors_2_sine_converged_3 * (field_1 +
        (converged_square_10 * (field_3 + converged_product_37)));
    const float residuals_2_converged_4 = (turns_3_cosine_converged_3 * V_ay_held) +
        (turns_3_sine_converged_3 * V_ax_held) - converged_product_38;
    const float by_bx_converged_3 = hall_position_limit(then_1_converged_3 + converged_product_33 -
        converged_product_34, largest_change);
    const float cosine_argument_11 = by_bx_converged_3 * by_bx_converged_3;
    const float by_cosine_bx_converged_3 = cosine_polynomial(cosine_argument_11);
    const float by_sine_bx_converged_3 = by_bx_converged_3 * sine_4_polynomial(cosine_argument_11);
    const float phasors_3_sine_converged_3 = (bx_part_full * by_cosine_bx_converged_3) +
        (start_cosine_bx * by_sine_bx_converged_3);
    const float converged_square_11 = phasors_3_sine_converged_3 * phasors_3_sine_converged_3;
    const float converged_product_39 = converged_square_11 * field_5;
    const float converged_product_40 = phasors_3_sine_converged_3 * (field_1 +
        (converged_square_11 * (field_3 + converged_product_39)));
    const float residuals_3_converged_4 = (turns_3_cosine_converged_3 * V_bx_held) -
        (turns_3_sine_converged_3 * V_by_held) - converged_product_40;
    const float by_converged_3 = hall_position_limit(then_2_converged_3 + converged_product_33 + converged_product_34,
        largest_change);
    const float cosine_argument_12 = by_converged_3 * by_converged_3;
    const float by_cosine_converged_3 = cosine_polynomial(cosine_argument_12);
    const float by_sine_converged_3 = by_converged_3 * sine_4_polynomial(cosine_argument_12);
    const float phasors_4_sine_converged_3 = (by_part_full * by_cosine_converged_3) +
        (start_cosine_by * by_sine_converged_3);
    const float converged_square_12 = phasors_4_sine_converged_3 * phasors_4_sine_converged_3;
    const float converged_product_41 = converged_square_12 * field_5;
    const float converged_product_42 = phasors_4_sine_converged_3 * (field_1 +
        (converged_square_12 * (field_3 + converged_product_41)));
    const float residuals_4_converged_4 = (turns_3_cosine_converged_3 * V_by_held) +
        (turns_3_sine_converged_3 * V_bx_held) - converged_product_42;
    const float cost_converged_3 = (residuals_1_converged_4 * residuals_1_converged_4) +
        (residuals_2_converged_4 * residuals_2_converged_4) + (residuals_3_converged_4 * residuals_3_converged_4) +
        (residuals_4_converged_4 * residuals_4_converged_4) +
        ((prior_weight_phase * (then_1_converged_3 * then_1_converged_3)) + (prior_weight_phase *
        (then_2_converged_3 * then_2_converged_3)) + (prior_weight_yaw * then_3_converged_3_squared));
    const bool better_converged_3 = cost_converged_3 <= ((rounding_factor * converged_choice_5) + slack);
    const float rows_1_1_converged_4 = ((start_cosine_ax * by_cosine_ax_converged_3) - (ax_part_full *
        by_sine_ax_converged_3)) * (field_1 + (converged_square_9 * (field_3_scaled + (5.0f * converged_product_35))));
    const float converged_product_43 = arm * turns_3_cosine_converged_3;
    const float converged_product_44 = arm * turns_3_sine_converged_3;
    const float rows_1_3_converged_4 = (rows_1_1_converged_4 * (converged_product_43 + converged_product_44)) +
        converged_product_38;
    const float rows_2_2_converged_4 = ((start_cosine_ay * by_cosine_ay_converged_3) - (ay_part_full *
        by_sine_ay_converged_3)) * (field_1 + (converged_square_10 * (field_3_scaled + (5.0f * converged_product_37))));
    const float minus_rows_2_3_converged_4 = converged_product_36 -
        (rows_2_2_converged_4 * (converged_product_44 - converged_product_43));
    const float rows_3_1_converged_4 = ((start_cosine_bx * by_cosine_bx_converged_3) - (bx_part_full *
        by_sine_bx_converged_3)) * (field_1 + (converged_square_11 * (field_3_scaled + (5.0f * converged_product_39))));
    const float rows_3_3_converged_4 = (rows_3_1_converged_4 * ((-arm * turns_3_cosine_converged_3) -
        converged_product_44)) + converged_product_42;
    const float rows_4_2_converged_4 = ((start_cosine_by * by_cosine_converged_3) - (by_part_full *
        by_sine_converged_3)) * (field_1 + (converged_square_12 * (field_3_scaled + (5.0f * converged_product_41))));
    const float minus_rows_4_3_converged_4 = converged_product_40 -
        (rows_4_2_converged_4 * (converged_product_43 - converged_product_44));
    const float left_3_1_converged_4 = (rows_1_3_converged_4 * rows_1_1_converged_4) +
        (rows_3_3_converged_4 * rows_3_1_converged_4);
    const float converged_inverse_7 = 1.0f / ((rows_1_1_converged_4 * rows_1_1_converged_4) +
        (rows_3_1_converged_4 * rows_3_1_converged_4) + prior_weight_phase);
    const float lower_3_1_converged_4 = hall_position_limit(left_3_1_converged_4 * converged_inverse_7,
        largest_L_yaw_phase);
    const float gradient_1_converged_4 = (rows_1_1_converged_4 * residuals_1_converged_4) +
        (rows_3_1_converged_4 * residuals_3_converged_4) - (prior_weight_phase * then_1_converged_3);
    const float minus_left_3_2_converged_4 = (minus_rows_2_3_converged_4 * rows_2_2_converged_4) +
        (minus_rows_4_3_converged_4 * rows_4_2_converged_4);
    const float converged_inverse_8 = 1.0f / ((rows_2_2_converged_4 * rows_2_2_converged_4) +
        (rows_4_2_converged_4 * rows_4_2_converged_4) + prior_weight_phase);
    const float lower_3_2_converged_4 = hall_position_limit(-(minus_left_3_2_converged_4 * converged_inverse_8),
        largest_L_yaw_phase);
    const float gradient_2_converged_4 = (rows_2_2_converged_4 * residuals_2_converged_4) +
        (rows_4_2_converged_4 * residuals_4_converged_4) - (prior_weight_phase * then_2_converged_3);
    float other_3_converged_3 = then_3_converged_3;
    float other_1_converged_3 = then_1_converged_3;
    float other_2_converged_3 = then_2_converged_3;
    float converged_choice_9 = cost_converged_3;
    if (!better_converged_3) {
        other_3_converged_3 = other_3_converged_2;
        other_1_converged_3 = other_1_converged_2;
        other_2_converged_3 = other_2_converged_2;
        converged_choice_9 = converged_choice_5;
    }
    float converged_choice_10;
    if (better_converged_3) {
        const float converged_denominator_4 = hall_position_max((rows_1_3_converged_4 * rows_1_3_converged_4) +
            (minus_rows_2_3_converged_4 * minus_rows_2_3_converged_4) + (rows_3_3_converged_4 * rows_3_3_converged_4) +
            (minus_rows_4_3_converged_4 * minus_rows_4_3_converged_4) + prior_weight_yaw - (lower_3_1_converged_4 *
            left_3_1_converged_4) + (lower_3_2_converged_4 * minus_left_3_2_converged_4), least_pivot_yaw);
        converged_choice_10 = then_3_converged_3 + (((rows_1_3_converged_4 * residuals_1_converged_4) -
            (minus_rows_2_3_converged_4 * residuals_2_converged_4) + (rows_3_3_converged_4 * residuals_3_converged_4) -
            (minus_rows_4_3_converged_4 * residuals_4_converged_4) - (prior_weight_yaw * then_3_converged_3) -
            (lower_3_1_converged_4 * gradient_1_converged_4) - (lower_3_2_converged_4 * gradient_2_converged_4)) /
            converged_denominator_4);
    } else {
        converged_choice_10 = 0.5f * (then_3_converged_3 + other_3_converged_3);
    }
    const float then_3_converged_4 = hall_position_limit(converged_choice_10, largest_step_yaw);
    const float then_3_converged_4_squared = then_3_converged_4 * then_3_converged_4;
    const float sine_converged_4 = then_3_converged_4 * sine_3_polynomial(then_3_converged_4_squared);
    const float half_converged_4 = then_3_converged_4 * tangent_polynomial(then_3_converged_4_squared);
    const float fall_converged_4 = sine_converged_4 * ((half_converged_4 * heading_cosine) + heading_sine);
    const float turns_3_cosine_converged_4 = heading_cosine - fall_converged_4;
    const float chords_3_sine_converged_4 = sine_converged_4 * (heading_cosine - (half_converged_4 * heading_sine));
    const float turns_3_sine_converged_4 = heading_sine + chords_3_sine_converged_4;
    float converged_choice_11;
    float converged_choice_12;
    if (better_converged_3) {
        const float moves_3_converged_3 = then_3_converged_4 - then_3_converged_3;
        converged_choice_11 = then_1_converged_3 +
            ((gradient_1_converged_4 * converged_inverse_7) - (lower_3_1_converged_4 * moves_3_converged_3));
        converged_choice_12 = then_2_converged_3 +
            ((gradient_2_converged_4 * converged_inverse_8) - (lower_3_2_converged_4 * moves_3_converged_3));
    } else {
        converged_choice_11 = 0.5f * (then_1_converged_3 + other_1_converged_3);
        converged_choice_12 = 0.5f * (then_2_converged_3 + other_2_converged_3);
    }
    const float then_1_converged_4 = hall_position_limit(converged_choice_11, largest_step_phase);
    const float converged_product_45 = arm * hall_position_limit(-fall_converged_4, largest_step_yaw);
    const float converged_product_46 = arm * hall_position_limit(chords_3_sine_converged_4, largest_step_yaw);
    const float by_ax_converged_4 = hall_position_limit(then_1_converged_4 - converged_product_45 +
        converged_product_46, largest_change);
    const float cosine_argument_13 = by_ax_converged_4 * by_ax_converged_4;
    const float by_cosine_ax_converged_4 = cosine_polynomial(cosine_argument_13);
    const float by_sine_ax_converged_4 = by_ax_converged_4 * sine_4_polynomial(cosine_argument_13);
    const float phasors_1_sine_converged_4 = (ax_part_full * by_cosine_ax_converged_4) +
        (start_cosine_ax * by_sine_ax_converged_4);
    const float converged_square_13 = phasors_1_sine_converged_4 * phasors_1_sine_converged_4;
    const float converged_product_47 = converged_square_13 * field_5;
    const float converged_product_48 = phasors_1_sine_converged_4 * (field_1 +
        (converged_square_13 * (field_3 + converged_product_47)));
    const float residuals_1_converged_5 = (turns_3_cosine_converged_4 * V_ax_held) -
        (turns_3_sine_converged_4 * V_ay_held) - converged_product_48;
    const float then_2_converged_4 = hall_position_limit(converged_choice_12, largest_step_phase);
    const float by_ay_converged_4 = hall_position_limit(then_2_converged_4 - converged_product_45 -
        converged_product_46, largest_change);
    const float cosine_argument_14 = by_ay_converged_4 * by_ay_converged_4;
    const float by_cosine_ay_converged_4 = cosine_polynomial(cosine_argument_14);
    const float by_sine_ay_converged_4 = by_ay_converged_4 * sine_4_polynomial(cosine_argument_14);
    const float phasors_2_sine_converged_4 = (ay_part_full * by_cosine_ay_converged_4) +
        (start_cosine_ay * by_sine_ay_converged_4);
    const float converged_square_14 = phasors_2_sine_converged_4 * phasors_2_sine_converged_4;
    const float converged_product_49 = converged_square_14 * field_5;
    const float converged_product_50 = phasors_2_sine_converged_4 * (field_1 +
        (converged_square_14 * (field_3 + converged_product_49)));
    const float residuals_2_converged_5 = (turns_3_cosine_converged_4 * V_ay_held) +
        (turns_3_sine_converged_4 * V_ax_held) - converged_product_50;
    const float by_bx_converged_4 = hall_position_limit(then_1_converged_4 + converged_product_45 -
        converged_product_46, largest_change);
    const float cosine_argument_15 = by_bx_converged_4 * by_bx_converged_4;
    const float by_cosine_bx_converged_4 = cosine_polynomial(cosine_argument_15);
    const float by_sine_bx_converged_4 = by_bx_converged_4 * sine_4_polynomial(cosine_argument_15);
    const float phasors_3_sine_converged_4 = (bx_part_full * by_cosine_bx_converged_4) +
        (start_cosine_bx * by_sine_bx_converged_4);
    const float converged_square_15 = phasors_3_sine_converged_4 * phasors_3_sine_converged_4;
    const float converged_product_51 = converged_square_15 * field_5;
    const float converged_product_52 = phasors_3_sine_converged_4 * (field_1 +
        (converged_square_15 * (field_3 + converged_product_51)));
    const float residuals_3_converged_5 = (turns_3_cosine_converged_4 * V_bx_held) -
        (turns_3_sine_converged_4 * V_by_held) - converged_product_52;
    const float by_converged_4 = hall_position_limit(then_2_converged_4 + converged_product_45 + converged_product_46,
        largest_change);
    const float cosine_argument_16 = by_converged_4 * by_converged_4;
    const float by_cosine_converged_4 = cosine_polynomial(cosine_argument_16);
    const float by_sine_converged_4 = by_converged_4 * sine_4_polynomial(cosine_argument_16);
    const float phasors_4_sine_converged_4 = (by_part_full * by_cosine_converged_4) +
        (start_cosine_by * by_sine_converged_4);
    const float converged_square_16 = phasors_4_sine_converged_4 * phasors_4_sine_converged_4;
    const float converged_product_53 = converged_square_16 * field_5;
    const float converged_product_54 = phasors_4_sine_converged_4 * (field_1 +
        (converged_square_16 * (field_3 + converged_product_53)));
    const float residuals_4_converged_5 = (turns_3_cosine_converged_4 * V_by_held) +
        (turns_3_sine_converged_4 * V_bx_held) - converged_product_54;
    const float squares_converged_2 = (residuals_1_converged_5 * residuals_1_converged_5) +
        (residuals_2_converged_5 * residuals_2_converged_5) + (residuals_3_converged_5 * residuals_3_converged_5) +
        (residuals_4_converged_5 * residuals_4_converged_5);
    const uint32_t ambiguity_resolved = state->ambiguity_resolved;
    const float then_1_converged_4_squared = then_1_converged_4 * then_1_converged_4;
    const float then_2_converged_4_squared = then_2_converged_4 * then_2_converged_4;
    const bool gate_exceeded = squared_gate <
        (then_1_converged_4_squared + then_2_converged_4_squared + (squared_radius * then_3_converged_4_squared));
    const uint32_t searching = state->searching;
    const bool better_converged_4 = (squares_converged_2 + ((prior_weight_phase * then_1_converged_4_squared) +
        (prior_weight_phase * then_2_converged_4_squared) + (prior_weight_yaw * then_3_converged_4_squared))) <=
        ((rounding_factor * converged_choice_9) + slack);
    const float rows_1_1_converged_5 = ((start_cosine_ax * by_cosine_ax_converged_4) - (ax_part_full *
        by_sine_ax_converged_4)) * (field_1 + (converged_square_13 * (field_3_scaled + (5.0f * converged_product_47))));
    const float rows_3_1_converged_5 = ((start_cosine_bx * by_cosine_bx_converged_4) - (bx_part_full *
        by_sine_bx_converged_4)) * (field_1 + (converged_square_15 * (field_3_scaled + (5.0f * converged_product_51))));
    const float gradient_1_converged_5 = (rows_1_1_converged_5 * residuals_1_converged_5) +
        (rows_3_1_converged_5 * residuals_3_converged_5) - (prior_weight_phase * then_1_converged_4);
    const float inverse_1 = 1.0f / ((rows_1_1_converged_5 * rows_1_1_converged_5) +
        (rows_3_1_converged_5 * rows_3_1_converged_5) + prior_weight_phase);
    const float converged_product_55 = gradient_1_converged_5 * inverse_1;
    const float rows_2_2_converged_5 = ((start_cosine_ay * by_cosine_ay_converged_4) - (ay_part_full *
        by_sine_ay_converged_4)) * (field_1 + (converged_square_14 * (field_3_scaled + (5.0f * converged_product_49))));
    const float rows_4_2_converged_5 = ((start_cosine_by * by_cosine_converged_4) - (by_part_full *
        by_sine_converged_4)) * (field_1 + (converged_square_16 * (field_3_scaled + (5.0f * converged_product_53))));
    const float gradient_2_converged_5 = (rows_2_2_converged_5 * residuals_2_converged_5) +
        (rows_4_2_converged_5 * residuals_4_converged_5) - (prior_weight_phase * then_2_converged_4);
    const float inverse_2 = 1.0f / ((rows_2_2_converged_5 * rows_2_2_converged_5) +
        (rows_4_2_converged_5 * rows_4_2_converged_5) + prior_weight_phase);
    const float converged_product_56 = gradient_2_converged_5 * inverse_2;
    const float converged_product_57 = arm * turns_3_cosine_converged_4;
    const float converged_product_58 = arm * turns_3_sine_converged_4;
    const float rows_1_3_converged_5 = (rows_1_1_converged_5 * (converged_product_57 + converged_product_58)) +
        converged_product_50;
    const float minus_rows_2_3_converged_5 = converged_product_48 -
        (rows_2_2_converged_5 * (converged_product_58 - converged_product_57));
    const float rows_3_3_converged_5 = (rows_3_1_converged_5 * ((-arm * turns_3_cosine_converged_4) -
        converged_product_58)) + converged_product_54;
    const float minus_rows_4_3_converged_5 = converged_product_52 -
        (rows_4_2_converged_5 * (converged_product_57 - converged_product_58));
    const float left_3_1_converged_5 = (rows_1_3_converged_5 * rows_1_1_converged_5) +
        (rows_3_3_converged_5 * rows_3_1_converged_5);
    const float by_yaw_X = hall_position_limit(left_3_1_converged_5 * inverse_1, largest_L_yaw_phase);
    const float minus_left_3_2_converged_5 = (minus_rows_2_3_converged_5 * rows_2_2_converged_5) +
        (minus_rows_4_3_converged_5 * rows_4_2_converged_5);
    const float by_yaw_Y = hall_position_limit(-(minus_left_3_2_converged_5 * inverse_2), largest_L_yaw_phase);
    const float forward_3_converged = (rows_1_3_converged_5 * residuals_1_converged_5) -
        (minus_rows_2_3_converged_5 * residuals_2_converged_5) + (rows_3_3_converged_5 * residuals_3_converged_5) -
        (minus_rows_4_3_converged_5 * residuals_4_converged_5) - (prior_weight_yaw * then_3_converged_4) -
        (by_yaw_X * gradient_1_converged_5) - (by_yaw_Y * gradient_2_converged_5);
    const float pivot = hall_position_max((rows_1_3_converged_5 * rows_1_3_converged_5) +
        (minus_rows_2_3_converged_5 * minus_rows_2_3_converged_5) + (rows_3_3_converged_5 * rows_3_3_converged_5) +
        (minus_rows_4_3_converged_5 * minus_rows_4_3_converged_5) + prior_weight_yaw -
        (by_yaw_X * left_3_1_converged_5) + (by_yaw_Y * minus_left_3_2_converged_5), least_pivot_yaw);
    const float step_converged = forward_3_converged / pivot;
    const bool converged = better_converged_4 &&
        (((gradient_1_converged_5 * converged_product_55) + (gradient_2_converged_5 * converged_product_56) +
        (forward_3_converged * step_converged)) <= decrease_tolerance);
    float at_3;
    float at_1;
    float at_2;
    if (converged) {
        const float untried_3 = hall_position_limit(then_3_converged_4 + step_converged, largest_step_yaw);
        at_3 = untried_3;
        const float moves_3_X = untried_3 - then_3_converged_4;
        at_1 = hall_position_limit(then_1_converged_4 + (converged_product_55 - (by_yaw_X * moves_3_X)),
            largest_step_phase);
        at_2 = hall_position_limit(then_2_converged_4 + (converged_product_56 - (by_yaw_Y * moves_3_X)),
            largest_step_phase);
    } else if (better_converged_4) {
        at_3 = then_3_converged_4;
        at_1 = then_1_converged_4;
        at_2 = then_2_converged_4;
    } else {
        at_3 = other_3_converged_3;
        at_1 = other_1_converged_3;
        at_2 = other_2_converged_3;
    }
    const float yaw_last_good = state->yaw_last_good;
    const bool in_window = fabsf(prediction_yaw + at_3 - yaw_last_good) <= yaw_window;
    const bool integrity_residual_fault = (residual_limit < squares_converged_2) ||
        ((ambiguity_resolved != 0u) ? gate_exceeded : ((searching != 0u) && !in_window));
    const uint32_t residual_faults = state->residual_faults;
    const bool exhausted = 4u <= residual_faults;
    const bool restart = integrity_residual_fault && exhausted;
    const bool tracking = searching == 0u;
    float by_phase_x = 0.0f;
    float by_phase_y = 0.0f;
    float yaw_2 = 0.0f;
    float motion_x_change = 0.0f;
    float motion_y_change = 0.0f;
    float motion_yaw_change = 0.0f;
    if (!(integrity_residual_fault && tracking)) {
        by_phase_x = at_1;
        by_phase_y = at_2;
        yaw_2 = at_3;
        motion_x_change = 0.5f * at_1;
        motion_y_change = 0.5f * at_2;
        motion_yaw_change = yaw_velocity_gain * at_3;
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
    const float prediction_yaw_plus_yaw_2 = prediction_yaw + yaw_2;
    float angle = prediction_yaw_plus_yaw_2;
    if (pi < prediction_yaw_plus_yaw_2) {
        angle = prediction_yaw_plus_yaw_2 - two_pi;
    }
    float yaw = angle;
    if (angle < -pi) {
        yaw = angle + two_pi;
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
    const float pose_pitch_x = state->pitch_x + ((acquired != 0u) ? turns_x_X_2 : 0.0f);
    const float pose_pitch_y = state->pitch_y + ((acquired != 0u) ? turns_y_Y_2 : 0.0f);
    const bool counted = (fabsf(pose_pitch_x) <= most_pitches) && (fabsf(pose_pitch_y) <= most_pitches);
    const float size = fabsf(yaw);
    const bool inside = counted && (size <= yaw_limit);
    const bool resolved = (integrity_good && in_window && tracking && (weight <= resolved_to) && complete && inside) ||
        ((ambiguity_resolved != 0u) && !damped);
    if (restart) {
        const float start_x = state->start_x + start_step_x;
        if (start_x < -pi) {
            state->phase_x = start_x + two_pi;
            state->start_x = state->phase_x;
        } else {
            state->phase_x = start_x;
            state->start_x = start_x;
        }
        const float start_y = state->start_y + start_step_y;
        if (start_y < -pi) {
            state->phase_y = start_y + two_pi;
            state->start_y = state->phase_y;
        } else {
            state->phase_y = start_y;
            state->start_y = start_y;
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
        .deviation_X = sigma_per_wave_number * sqrtf(inverse_1 + (by_yaw_X_squared * yaw_variance)), .deviation_Y =
        sigma_per_wave_number * sqrtf(inverse_2 + (by_yaw_Y_squared * yaw_variance)), .deviation_yaw = channel_sigma *
        sqrtf(yaw_variance), .residual = sqrtf(root_regularisation + squares_converged_2), .converged = converged,
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
    const hall_position_estimator_t estimator = hall_position_estimator(&state->estimator, accepted.V_ax, accepted.V_ay,
        accepted.V_bx, accepted.V_by, complete);
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
