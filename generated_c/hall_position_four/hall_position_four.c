/* hall_position_four. Generated: do not edit. */
#include "hall_position_four.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float hall_position_four_min(float a, float b)
{
    return (a < b) ? a : b;
}

static inline float hall_position_four_max(float a, float b)
{
    return (a > b) ? a : b;
}

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float hall_position_four_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline uint32_t hall_position_four_flag(bool holds)
{
    uint32_t value = 0u;
    if (holds) {
        value = 1u;
    }
    return value;
}

static inline bool hall_position_four_equal(float a, float b)
{
    return (a <= b) && !(a < b);
}

#if defined(__GNUC__)
#define HALL_POSITION_FOUR_INLINE static inline __attribute__((always_inline))
#else
#define HALL_POSITION_FOUR_INLINE static inline
#endif
#if defined(__OPTIMIZE_SIZE__)
#define HALL_POSITION_FOUR_LARGE static inline
#else
#define HALL_POSITION_FOUR_LARGE HALL_POSITION_FOUR_INLINE
#endif
/* Return a value in -high .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
HALL_POSITION_FOUR_INLINE float hall_position_four_hold_within(float value, float high, float *last, uint32_t bit,
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

/* cos(x); x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) and 1 other in -0.209439516 ..
 * 0.209439516, t = x^2; relative error at most 6e-08. */
static inline float cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.49999884f + (t * 0.04158157f)));
}

/* sin(x) / x; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) and 1 other in -0.209439516 ..
 * 0.209439516, t = x^2; relative error at most 1.2e-07. */
static inline float sine_polynomial(float t)
{
    return 1.0f + (t * (-0.1666665f + (t * 0.008320974f)));
}

/* sin(0.25 * x) / x; x = clamp(((clamp(((...) ? (...) : (...)), -3.14159265, 3.14159265) + (0.289026524 * cos_yaw)) +
 * (0.452389342 * sin_yaw)), -3.67842824, 3.67842824) and 1 other in -3.65407467 .. 3.5246768, t = x^2; relative error
 * at most 1.2e-07. */
static inline float sine_2_polynomial(float t)
{
    return 0.25f + (t * (-0.0026041619f + (t * (8.135896e-06f + (t * -1.1839816e-08f)))));
}

/* part_cosine; x = clamp(((clamp(((...) ? (...) : (...)), -3.14159265, 3.14159265) + (0.289026524 * cos_yaw)) +
 * (0.452389342 * sin_yaw)), -3.67842824, 3.67842824) and 1 other in -3.65407467 .. 3.5246768, t = x^2; relative error
 * at most 1.2e-07. */
static inline float part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.03125f + (t * (0.0001627602f + (t * (-3.39012e-07f + (t * 3.7075404e-10f)))))));
}

/* sin(0.125 * x) / x; x = clamp(((clamp(((...) ? (...) : (...)), -3.14159265, 3.14159265) - (1.11840698 * cos_yaw)) +
 * (1.74044233 * sin_yaw)), -5.21040238, 5.21040238) and 5 others in -6.66619205 .. 4.92831421, t = x^2; relative error
 * at most 1.2e-07. */
static inline float sine_3_polynomial(float t)
{
    return 0.125f + (t * (-0.0003255205f + (t * (2.5426758e-07f + (t * -9.285783e-11f)))));
}

/* part_cosine; x = clamp(((clamp(((...) ? (...) : (...)), -3.14159265, 3.14159265) - (1.11840698 * cos_yaw)) +
 * (1.74044233 * sin_yaw)), -5.21040238, 5.21040238) and 5 others in -6.66619205 .. 4.92831421, t = x^2; relative error
 * at most 1.5e-07. */
static inline float part_cosine_2_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124637f + (t * (1.0168685e-05f + (t * -5.164675e-09f)))));
}

/* cos(x); x = clamp(((clamp((...), -0.5, 0.5) + (0.289026524 * (...))) + (0.452389342 * clamp((...), -0.1, 0.1))),
 * -0.574141587, 0.574141587) and 7 others in -0.855124056 .. 0.855124056, t = x^2; relative error at most 1.7e-07. */
static inline float cosine_2_polynomial(float t)
{
    return 0.99999994f + (t * (-0.4999974f + (t * (0.041649524f + (t * -0.0013522666f)))));
}

/* sin(x) / x; x = clamp(((clamp((...), -0.5, 0.5) + (0.289026524 * (...))) + (0.452389342 * clamp((...), -0.1, 0.1))),
 * -0.574141587, 0.574141587) and 7 others in -0.855124056 .. 0.855124056, t = x^2; relative error at most 1.2e-07. */
static inline float sine_4_polynomial(float t)
{
    return 1.0f + (t * (-0.16666646f + (t * (0.008331675f + (t * -0.00019454073f)))));
}

typedef struct {
    uint32_t latched;
    bool fault_V_ax;
    bool fault_V_ay;
    bool fault_V_bx;
    bool fault_V_by;
    bool fault_V_cx;
    bool fault_V_cy;
    bool fault_V_dx;
    bool fault_V_dy;
} hall_position_four_guard_t;

/* guard: range acceptance, hold, latch */
HALL_POSITION_FOUR_INLINE hall_position_four_guard_t hall_position_four_guard(hall_position_four_guard_state_t *state,
    uint32_t fault_V_ax_part, uint32_t latched_before)
{
    static const uint32_t latch_samples = 5u;                   /* 1; bad samples in a row until it latches */

    const bool complete = (fault_V_ax_part & 0x000000ffu) == 0u;
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
    return (hall_position_four_guard_t){.latched = latched, .fault_V_ax = (fault_V_ax_part & 0x00000001u) != 0u,
        .fault_V_ay = (fault_V_ax_part & 0x00000002u) != 0u, .fault_V_bx = (fault_V_ax_part & 0x00000004u) != 0u,
        .fault_V_by = (fault_V_ax_part & 0x00000008u) != 0u, .fault_V_cx = (fault_V_ax_part & 0x00000010u) != 0u,
        .fault_V_cy = (fault_V_ax_part & 0x00000020u) != 0u, .fault_V_dx = (fault_V_ax_part & 0x00000040u) != 0u,
        .fault_V_dy = (fault_V_ax_part & 0x00000080u) != 0u};
}

typedef struct {
    float rejected;
    bool screened;
} hall_position_four_screen_t;

/* screen: refused and repeated codes */
HALL_POSITION_FOUR_LARGE hall_position_four_screen_t hall_position_four_screen(hall_position_four_screen_state_t *state,
    const hall_position_four_guard_t *guard, const hall_position_four_input_t *accepted,
    hall_position_four_diagnostics_t *diagnostics)
{
    static const uint32_t most_repeats = 6u;                    /* 1; samples in a row with the same code: frozen */

    const float last_V_ax = state->last_V_ax;
    state->last_V_ax = accepted->V_ax;
    const float last_V_ay = state->last_V_ay;
    state->last_V_ay = accepted->V_ay;
    const float last_V_bx = state->last_V_bx;
    state->last_V_bx = accepted->V_bx;
    const float last_V_by = state->last_V_by;
    state->last_V_by = accepted->V_by;
    const float last_V_cx = state->last_V_cx;
    state->last_V_cx = accepted->V_cx;
    const float last_V_cy = state->last_V_cy;
    state->last_V_cy = accepted->V_cy;
    const float last_V_dx = state->last_V_dx;
    state->last_V_dx = accepted->V_dx;
    const float last_V_dy = state->last_V_dy;
    state->last_V_dy = accepted->V_dy;
    bool frozen_1 = false;
    if ((fabsf(accepted->V_ax - last_V_ax) <= 0.0f) || (fabsf(accepted->V_ay - last_V_ay) <= 0.0f)) {
        const uint32_t repeats_1 = state->repeats_1;
        uint32_t count_1 = repeats_1;
        if (repeats_1 < most_repeats) {
            const uint32_t screened_sum = repeats_1 + 1u;
            count_1 = screened_sum;
            state->repeats_1 = screened_sum;
        }
        frozen_1 = most_repeats <= count_1;
    } else {
        state->repeats_1 = 0u;
    }
    bool frozen_2 = false;
    if ((fabsf(accepted->V_bx - last_V_bx) <= 0.0f) || (fabsf(accepted->V_by - last_V_by) <= 0.0f)) {
        const uint32_t repeats_2 = state->repeats_2;
        uint32_t count_2 = repeats_2;
        if (repeats_2 < most_repeats) {
            const uint32_t screened_sum_2 = repeats_2 + 1u;
            count_2 = screened_sum_2;
            state->repeats_2 = screened_sum_2;
        }
        frozen_2 = most_repeats <= count_2;
    } else {
        state->repeats_2 = 0u;
    }
    bool frozen_3 = false;
    if ((fabsf(accepted->V_cx - last_V_cx) <= 0.0f) || (fabsf(accepted->V_cy - last_V_cy) <= 0.0f)) {
        const uint32_t repeats_3 = state->repeats_3;
        uint32_t count_3 = repeats_3;
        if (repeats_3 < most_repeats) {
            const uint32_t screened_sum_3 = repeats_3 + 1u;
            count_3 = screened_sum_3;
            state->repeats_3 = screened_sum_3;
        }
        frozen_3 = most_repeats <= count_3;
    } else {
        state->repeats_3 = 0u;
    }
    bool frozen_4 = false;
    if ((fabsf(accepted->V_dx - last_V_dx) <= 0.0f) || (fabsf(accepted->V_dy - last_V_dy) <= 0.0f)) {
        const uint32_t repeats_4 = state->repeats_4;
        uint32_t count_4 = repeats_4;
        if (repeats_4 < most_repeats) {
            const uint32_t screened_sum_4 = repeats_4 + 1u;
            count_4 = screened_sum_4;
            state->repeats_4 = screened_sum_4;
        }
        frozen_4 = most_repeats <= count_4;
    } else {
        state->repeats_4 = 0u;
    }
    const bool flag_1 = guard->fault_V_ax || guard->fault_V_ay || frozen_1;
    const bool flag_2 = guard->fault_V_bx || guard->fault_V_by || frozen_2;
    const bool flag_3 = guard->fault_V_cx || guard->fault_V_cy || frozen_3;
    const bool flag_4 = guard->fault_V_dx || guard->fault_V_dy || frozen_4;
    const uint32_t screened_sum_5 = hall_position_four_flag(flag_1) + hall_position_four_flag(flag_2) +
        hall_position_four_flag(flag_3) + hall_position_four_flag(flag_4);
    const bool screened = screened_sum_5 <= 1u;
    float rejected = 0.0f;
    if (screened) {
        if (flag_1) {
            rejected = 1.0f;
        } else {
            rejected = (flag_2) ? 2.0f : ((flag_3) ? 3.0f : ((flag_4) ? 4.0f : 0.0f));
        }
    }
    if (diagnostics != NULL) {
        diagnostics->screened = screened ? 1.0f : 0.0f;
        diagnostics->rejected = rejected;
    }
    return (hall_position_four_screen_t){.rejected = rejected, .screened = screened};
}

typedef struct {
    bool weights_2;
    bool weights_4;
    bool weights_6;
    bool weights_8;
} hall_position_four_estimator_weights_t;

/* weights */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_weights_t hall_position_four_estimator_weights(bool none,
    bool phase_x_test, bool phase_x_test_2, bool phase_x_test_3)
{
    bool weights_2 = true;
    bool weights_4 = true;
    bool weights_6 = true;
    bool weights_8 = true;
    if (!none) {
        if (phase_x_test) {
            weights_2 = (phase_x_test_2) ? false : true;
            weights_4 = phase_x_test_2;
        } else {
            weights_6 = (phase_x_test_3) ? false : true;
            weights_8 = phase_x_test_3;
        }
    }
    return (hall_position_four_estimator_weights_t){.weights_2 = weights_2, .weights_4 = weights_4,
        .weights_6 = weights_6, .weights_8 = weights_8};
}

typedef struct {
    float predicted_phase_x;
    float predicted_phase_y;
    float predicted_yaw;
} hall_position_four_estimator_extrapolation_t;

/* extrapolation */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_extrapolation_t hall_position_four_estimator_extrapolation(float
    phase_x, float motion_phase_x, float phase_y, float motion_phase_y, float yaw, float motion_yaw)
{
    static const float pi = 3.1415927f;                         /* 1 */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    static const float highest_yaw = 0.20943952f;               /* rad; end of its range */

    const float phase_x_plus_motion_phase_x = phase_x + motion_phase_x;
    float predicted_phase_x_choice = phase_x_plus_motion_phase_x;
    if (pi < phase_x_plus_motion_phase_x) {
        predicted_phase_x_choice = phase_x_plus_motion_phase_x - two_pi;
    }
    float predicted_phase_x = predicted_phase_x_choice;
    if (predicted_phase_x_choice < -pi) {
        predicted_phase_x = predicted_phase_x_choice + two_pi;
    }
    const float phase_y_plus_motion_phase_y = phase_y + motion_phase_y;
    float predicted_phase_y_choice = phase_y_plus_motion_phase_y;
    if (pi < phase_y_plus_motion_phase_y) {
        predicted_phase_y_choice = phase_y_plus_motion_phase_y - two_pi;
    }
    float predicted_phase_y = predicted_phase_y_choice;
    if (predicted_phase_y_choice < -pi) {
        predicted_phase_y = predicted_phase_y_choice + two_pi;
    }
    return (hall_position_four_estimator_extrapolation_t){.predicted_phase_x = predicted_phase_x, .predicted_phase_y =
        predicted_phase_y, .predicted_yaw = hall_position_four_limit(yaw + motion_yaw, highest_yaw)};
}

typedef struct {
    float phasor_cosine;
    float phasor_sine;
} hall_position_four_estimator_phasor_t;

/* phasor_ax, phasor_ay */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_phasor_t hall_position_four_estimator_phasor(float limited)
{
    const float ax_part_cosine_argument = limited * limited;
    const float sine_2 = limited * sine_2_polynomial(ax_part_cosine_argument);
    const float ax_part_sine = 4.0f * sine_2;
    const float ax_part_cosine = part_cosine_polynomial(ax_part_cosine_argument);
    const float ax_part_doubled = 4.0f * (sine_2 * ax_part_cosine);
    /*@ admit -2.002f <= ax_part_doubled <= 2.002f; */
    const float phasor_sine = ax_part_doubled * (1.0f - (0.125f * (ax_part_sine * ax_part_sine)));
    /*@ admit -1.001f <= phasor_sine <= 1.001f; */
    return (hall_position_four_estimator_phasor_t){.phasor_cosine = 1.0f - (0.5f * (ax_part_doubled * ax_part_doubled)),
        .phasor_sine = phasor_sine};
}

typedef struct {
    float phasor_cosine;
    float phasor_sine;
} hall_position_four_estimator_phasor_2_t;

/* phasor_bx, phasor_by, phasor_cx, phasor_cy, phasor_dx, phasor_dy */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_phasor_2_t hall_position_four_estimator_phasor_2(float limited)
{
    const float bx_part_cosine_argument = limited * limited;
    const float sine_3 = limited * sine_3_polynomial(bx_part_cosine_argument);
    const float bx_part_sine = 8.0f * sine_3;
    const float bx_part_cosine = part_cosine_2_polynomial(bx_part_cosine_argument);
    const float sine_3_times_bx_part_cosine = sine_3 * bx_part_cosine;
    const float bx_part_doubled = 8.0f *
        (sine_3_times_bx_part_cosine * (1.0f - (0.03125f * (bx_part_sine * bx_part_sine))));
    /*@ admit -2.002f <= bx_part_doubled <= 2.002f; */
    const float sines_bx_part_2 = 8.0f * sine_3_times_bx_part_cosine;
    const float phasor_sine = bx_part_doubled * (1.0f - (0.125f * (sines_bx_part_2 * sines_bx_part_2)));
    /*@ admit -1.001f <= phasor_sine <= 1.001f; */
    return (hall_position_four_estimator_phasor_2_t){.phasor_cosine = 1.0f -
        (0.5f * (bx_part_doubled * bx_part_doubled)), .phasor_sine = phasor_sine};
}

typedef struct {
    float cos_yaw;
    float ax_part_cosine_product;
    float sin_yaw;
    float ax_part_cosine_product_2;
    float ay_part_cosine_product;
    float ay_part_cosine_product_2;
    float bx_part_cosine_product;
    float bx_part_cosine_product_2;
    float by_part_cosine_product;
    float by_part_cosine_product_2;
    float cx_part_cosine_product;
    float cx_part_cosine_product_2;
    float cy_part_cosine_product;
    float cy_part_cosine_product_2;
    float dx_part_cosine_product;
    float dx_part_cosine_product_2;
    float dy_part_cosine_product;
    float phasor_ax_cosine;
    float ax_part_full;
    float phasor_ay_cosine;
    float ay_part_full;
    float phasor_bx_cosine;
    float bx_part_full;
    float phasor_by_cosine;
    float by_part_full;
    float phasor_cx_cosine;
    float cx_part_full;
    float phasor_cy_cosine;
    float cy_part_full;
    float phasor_dx_cosine;
    float dx_part_full;
    float phasor_dy_cosine;
    float dy_part_full;
} hall_position_four_estimator_prediction_t;

/* prediction */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_prediction_t
    hall_position_four_estimator_prediction(const hall_position_four_estimator_extrapolation_t *extrapolation)
{
    static const float arm_a_x = 0.28902653f; /* rad; arm of sensor a along x, times 2 pi over the pitch */
    static const float arm_a_y = -0.45238933f; /* rad; arm of sensor a along y, times 2 pi over the pitch */
    static const float arm_b_x = -1.118407f; /* rad; arm of sensor b along x, times 2 pi over the pitch */
    static const float arm_b_y = -1.7404423f; /* rad; arm of sensor b along y, times 2 pi over the pitch */
    static const float arm_c_x = -2.506991f; /* rad; arm of sensor c along x, times 2 pi over the pitch */
    static const float arm_c_y = -3.0033627f; /* rad; arm of sensor c along y, times 2 pi over the pitch */
    static const float arm_d_x = 1.627345f; /* rad; arm of sensor d along x, times 2 pi over the pitch */
    static const float arm_d_y = 0.76654863f; /* rad; arm of sensor d along y, times 2 pi over the pitch */

    const float cosine_argument = extrapolation->predicted_yaw * extrapolation->predicted_yaw;
    const float cos_yaw = cosine_polynomial(cosine_argument);
    const float ax_part_cosine_product = arm_a_x * cos_yaw;
    const float sin_yaw = extrapolation->predicted_yaw * sine_polynomial(cosine_argument);
    const float ax_part_cosine_product_2 = arm_a_y * sin_yaw;
    const float ay_part_cosine_product = -arm_a_y * cos_yaw;
    const float ay_part_cosine_product_2 = arm_a_x * sin_yaw;
    const float bx_part_cosine_product = arm_b_x * cos_yaw;
    const float bx_part_cosine_product_2 = -arm_b_y * sin_yaw;
    const float by_part_cosine_product = -arm_b_y * cos_yaw;
    const float by_part_cosine_product_2 = arm_b_x * sin_yaw;
    const float cx_part_cosine_product = arm_c_x * cos_yaw;
    const float cx_part_cosine_product_2 = -arm_c_y * sin_yaw;
    const float cy_part_cosine_product = -arm_c_y * cos_yaw;
    const float cy_part_cosine_product_2 = arm_c_x * sin_yaw;
    const float dx_part_cosine_product = arm_d_x * cos_yaw;
    const float dx_part_cosine_product_2 = arm_d_y * sin_yaw;
    const float dy_part_cosine_product = arm_d_x * sin_yaw;
    const hall_position_four_estimator_phasor_t phasor_ax =
        hall_position_four_estimator_phasor(extrapolation->predicted_phase_x + ax_part_cosine_product -
        ax_part_cosine_product_2);
    const hall_position_four_estimator_phasor_t phasor_ay =
        hall_position_four_estimator_phasor(extrapolation->predicted_phase_y - ay_part_cosine_product +
        ay_part_cosine_product_2);
    const hall_position_four_estimator_phasor_2_t phasor_bx =
        hall_position_four_estimator_phasor_2(extrapolation->predicted_phase_x + bx_part_cosine_product +
        bx_part_cosine_product_2);
    const hall_position_four_estimator_phasor_2_t phasor_by =
        hall_position_four_estimator_phasor_2(extrapolation->predicted_phase_y - by_part_cosine_product +
        by_part_cosine_product_2);
    const hall_position_four_estimator_phasor_2_t phasor_cx =
        hall_position_four_estimator_phasor_2(extrapolation->predicted_phase_x + cx_part_cosine_product +
        cx_part_cosine_product_2);
    const hall_position_four_estimator_phasor_2_t phasor_cy =
        hall_position_four_estimator_phasor_2(extrapolation->predicted_phase_y - cy_part_cosine_product +
        cy_part_cosine_product_2);
    const hall_position_four_estimator_phasor_2_t phasor_dx =
        hall_position_four_estimator_phasor_2(extrapolation->predicted_phase_x + dx_part_cosine_product -
        dx_part_cosine_product_2);
    const hall_position_four_estimator_phasor_2_t phasor_dy =
        hall_position_four_estimator_phasor_2(extrapolation->predicted_phase_y + (arm_d_y * cos_yaw) +
        dy_part_cosine_product);
    return (hall_position_four_estimator_prediction_t){.cos_yaw = cos_yaw, .ax_part_cosine_product =
        ax_part_cosine_product, .sin_yaw = sin_yaw, .ax_part_cosine_product_2 = ax_part_cosine_product_2,
        .ay_part_cosine_product = ay_part_cosine_product, .ay_part_cosine_product_2 = ay_part_cosine_product_2,
        .bx_part_cosine_product = bx_part_cosine_product, .bx_part_cosine_product_2 = bx_part_cosine_product_2,
        .by_part_cosine_product = by_part_cosine_product, .by_part_cosine_product_2 = by_part_cosine_product_2,
        .cx_part_cosine_product = cx_part_cosine_product, .cx_part_cosine_product_2 = cx_part_cosine_product_2,
        .cy_part_cosine_product = cy_part_cosine_product, .cy_part_cosine_product_2 = cy_part_cosine_product_2,
        .dx_part_cosine_product = dx_part_cosine_product, .dx_part_cosine_product_2 = dx_part_cosine_product_2,
        .dy_part_cosine_product = dy_part_cosine_product, .phasor_ax_cosine = phasor_ax.phasor_cosine, .ax_part_full =
        phasor_ax.phasor_sine, .phasor_ay_cosine = phasor_ay.phasor_cosine, .ay_part_full = phasor_ay.phasor_sine,
        .phasor_bx_cosine = phasor_bx.phasor_cosine, .bx_part_full = phasor_bx.phasor_sine, .phasor_by_cosine =
        phasor_by.phasor_cosine, .by_part_full = phasor_by.phasor_sine, .phasor_cx_cosine = phasor_cx.phasor_cosine,
        .cx_part_full = phasor_cx.phasor_sine, .phasor_cy_cosine = phasor_cy.phasor_cosine, .cy_part_full =
        phasor_cy.phasor_sine, .phasor_dx_cosine = phasor_dx.phasor_cosine, .dx_part_full = phasor_dx.phasor_sine,
        .phasor_dy_cosine = phasor_dy.phasor_cosine, .dy_part_full = phasor_dy.phasor_sine};
}

typedef struct {
    float value;
    float rows_4;
    float residuals;
    float rows_4_2;
    float residuals_2;
    float rows_1;
    float rows_3;
    float rows_2;
} hall_position_four_estimator_sensor_t;

/* sensor_1, sensor_2, sensor_3 */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_sensor_t hall_position_four_estimator_sensor(const
    hall_position_four_estimator_prediction_t *prediction, float V_held, float V_held_2, float amplitude,
    float part_full, float part_full_2, float phasor_cosine, float amplitude_times_field_1, float phase_x_product,
    float amplitude_times_field_5, float ay_part_cosine_product, float ay_part_cosine_product_2, float phasor_cosine_2)
{
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */

    const float value = (prediction->cos_yaw * V_held) - (prediction->sin_yaw * V_held_2);
    const float part_full_squared = part_full * part_full;
    const float rows_4 = part_full * (field_1 + (part_full_squared * (field_3 + (part_full_squared * field_5))));
    const float part_full_2_squared = part_full_2 * part_full_2;
    const float rows_4_2 = part_full_2 * (field_1 +
        (part_full_2_squared * (field_3 + (part_full_2_squared * field_5))));
    const float residuals_2_sum = (prediction->cos_yaw * V_held_2) + (prediction->sin_yaw * V_held);
    const float rows_1 = phasor_cosine * (amplitude_times_field_1 +
        (part_full_squared * (phase_x_product + (5.0f * (part_full_squared * amplitude_times_field_5)))));
    return (hall_position_four_estimator_sensor_t){.value = value, .rows_4 = rows_4, .residuals = value -
        (amplitude * rows_4), .rows_4_2 = rows_4_2, .residuals_2 = residuals_2_sum - (amplitude * rows_4_2),
        .rows_1 = rows_1, .rows_3 = residuals_2_sum + (rows_1 * (ay_part_cosine_product - ay_part_cosine_product_2)),
        .rows_2 = phasor_cosine_2 * (amplitude_times_field_1 +
        (part_full_2_squared * (phase_x_product + (5.0f * (part_full_2_squared * amplitude_times_field_5)))))};
}

typedef struct {
    float value;
    float rows_7_4;
    float residuals_7;
    float rows_8_4;
    float residuals_8;
    float rows_7_1;
    float rows_7_3;
    float rows_8_2;
} hall_position_four_estimator_sensor_4_t;

/* sensor_4 */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_sensor_4_t hall_position_four_estimator_sensor_4(const
    hall_position_four_estimator_prediction_t *prediction, float V_dx_held, float V_dy_held, float amplitude,
    float amplitude_times_field_1, float phase_x_product, float amplitude_times_field_5)
{
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    static const float arm_d_y = 0.76654863f; /* rad; arm of sensor d along y, times 2 pi over the pitch */

    const float value = (prediction->cos_yaw * V_dx_held) - (prediction->sin_yaw * V_dy_held);
    const float dx_part_full_squared = prediction->dx_part_full * prediction->dx_part_full;
    const float rows_7_4 = prediction->dx_part_full * (field_1 +
        (dx_part_full_squared * (field_3 + (dx_part_full_squared * field_5))));
    const float dy_part_full_squared = prediction->dy_part_full * prediction->dy_part_full;
    const float rows_8_4 = prediction->dy_part_full * (field_1 +
        (dy_part_full_squared * (field_3 + (dy_part_full_squared * field_5))));
    const float residuals_8_sum = (prediction->cos_yaw * V_dy_held) + (prediction->sin_yaw * V_dx_held);
    const float rows_7_1 = prediction->phasor_dx_cosine * (amplitude_times_field_1 +
        (dx_part_full_squared * (phase_x_product + (5.0f * (dx_part_full_squared * amplitude_times_field_5)))));
    return (hall_position_four_estimator_sensor_4_t){.value = value, .rows_7_4 = rows_7_4, .residuals_7 = value -
        (amplitude * rows_7_4), .rows_8_4 = rows_8_4, .residuals_8 = residuals_8_sum - (amplitude * rows_8_4),
        .rows_7_1 = rows_7_1, .rows_7_3 = residuals_8_sum + (rows_7_1 * ((-arm_d_y * prediction->cos_yaw) -
        prediction->dy_part_cosine_product)), .rows_8_2 = prediction->phasor_dy_cosine * (amplitude_times_field_1 +
        (dy_part_full_squared * (phase_x_product + (5.0f * (dy_part_full_squared * amplitude_times_field_5)))))};
}

typedef struct {
    float inverse_1;
    float lower_3_1;
    float minus_rows_2_3;
    float minus_rows_4_3;
    float minus_rows_6_3;
    float minus_rows_8_3;
    float inverse_2;
    float lower_3_2;
    float lower_4_1;
    float lower_4_2;
    float inverse_3;
    float lower_4_3;
    float diagonal_4;
    bool in_range;
} hall_position_four_estimator_factors_t;

/* factors */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_factors_t hall_position_four_estimator_factors(const
    hall_position_four_estimator_sensor_t *sensor_1, const hall_position_four_estimator_sensor_t *sensor_2,
    const hall_position_four_estimator_sensor_t *sensor_3, const hall_position_four_estimator_sensor_4_t *sensor_4,
    const hall_position_four_estimator_prediction_t *prediction)
{
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.25 rad, the largest; of x, y */
    static const float least_pivot_phase = 0.048416f;
    static const float largest_L_yaw_phase = 1250.0f;           /* 1; bound of L in row yaw; of x, y */
    static const float largest_L_amplitude_phase = 625.0f;      /* rad; bound of L in row amplitude; of x, y */
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.1 rad, the largest */
    static const float least_pivot_yaw = 0.3026f;
    static const float largest_L_amplitude_yaw = 250.0f;        /* rad; bound of L in row amplitude */
    /* V^2; channel_variance / sigma^2, sigma = 0.06 of the prior */
    static const float prior_weight_amplitude = 0.84055555f;
    static const float least_pivot_amplitude = 0.07565f; /* V^2; channel_variance / sigma^2, sigma = 0.2, the largest */
    /* V^2/rad^2; a larger N_ii is not resolved: 500^2 times the least pivot; of x, y */
    static const float largest_information_phase = 12104.0f;
    /* V^2/rad^2; a larger N_ii is not resolved: 500^2 times the least pivot */
    static const float largest_information_yaw = 75650.0f;
    /* V^2; a larger N_ii is not resolved: 500^2 times the least pivot */
    static const float largest_information_amplitude = 18912.5f;

    const float left_1_1 = (sensor_1->rows_1 * sensor_1->rows_1) + (sensor_2->rows_1 * sensor_2->rows_1) +
        (sensor_3->rows_1 * sensor_3->rows_1) + (sensor_4->rows_7_1 * sensor_4->rows_7_1);
    const float inverse_1 = 1.0f / hall_position_four_max(left_1_1, least_pivot_phase);
    const float left_3_1 = (sensor_1->rows_3 * sensor_1->rows_1) + (sensor_2->rows_3 * sensor_2->rows_1) +
        (sensor_3->rows_3 * sensor_3->rows_1) + (sensor_4->rows_7_3 * sensor_4->rows_7_1);
    const float lower_3_1 = hall_position_four_limit(left_3_1 * inverse_1, largest_L_yaw_phase);
    const float minus_rows_2_3 = sensor_1->value -
        (sensor_1->rows_2 * (prediction->ax_part_cosine_product - prediction->ax_part_cosine_product_2));
    const float minus_rows_4_3 = sensor_2->value -
        (sensor_2->rows_2 * (prediction->bx_part_cosine_product_2 + prediction->bx_part_cosine_product));
    const float minus_rows_6_3 = sensor_3->value -
        (sensor_3->rows_2 * (prediction->cx_part_cosine_product_2 + prediction->cx_part_cosine_product));
    const float minus_rows_8_3 = sensor_4->value -
        (sensor_4->rows_8_2 * (prediction->dx_part_cosine_product - prediction->dx_part_cosine_product_2));
    const float left_2_2 = (sensor_1->rows_2 * sensor_1->rows_2) + (sensor_2->rows_2 * sensor_2->rows_2) +
        (sensor_3->rows_2 * sensor_3->rows_2) + (sensor_4->rows_8_2 * sensor_4->rows_8_2);
    const float inverse_2 = 1.0f / hall_position_four_max(left_2_2, least_pivot_phase);
    const float minus_left_3_2 = (minus_rows_2_3 * sensor_1->rows_2) + (minus_rows_4_3 * sensor_2->rows_2) +
        (minus_rows_6_3 * sensor_3->rows_2) + (minus_rows_8_3 * sensor_4->rows_8_2);
    const float lower_3_2 = hall_position_four_limit(-(minus_left_3_2 * inverse_2), largest_L_yaw_phase);
    const float left_4_1 = (sensor_1->rows_4 * sensor_1->rows_1) + (sensor_2->rows_4 * sensor_2->rows_1) +
        (sensor_3->rows_4 * sensor_3->rows_1) + (sensor_4->rows_7_4 * sensor_4->rows_7_1);
    const float lower_4_1 = hall_position_four_limit(left_4_1 * inverse_1, largest_L_amplitude_phase);
    const float left_4_2 = (sensor_1->rows_4_2 * sensor_1->rows_2) + (sensor_2->rows_4_2 * sensor_2->rows_2) +
        (sensor_3->rows_4_2 * sensor_3->rows_2) + (sensor_4->rows_8_4 * sensor_4->rows_8_2);
    const float lower_4_2 = hall_position_four_limit(left_4_2 * inverse_2, largest_L_amplitude_phase);
    const float left_3_3 = (sensor_1->rows_3 * sensor_1->rows_3) + (minus_rows_2_3 * minus_rows_2_3) +
        (sensor_2->rows_3 * sensor_2->rows_3) + (minus_rows_4_3 * minus_rows_4_3) +
        (sensor_3->rows_3 * sensor_3->rows_3) + (minus_rows_6_3 * minus_rows_6_3) +
        (sensor_4->rows_7_3 * sensor_4->rows_7_3) + (minus_rows_8_3 * minus_rows_8_3);
    const float inverse_3 = 1.0f /
        hall_position_four_max(left_3_3 - (lower_3_1 * left_3_1) + (lower_3_2 * minus_left_3_2), least_pivot_yaw);
    const float left_4_3 = (sensor_1->rows_4 * sensor_1->rows_3) - (sensor_1->rows_4_2 * minus_rows_2_3) +
        (sensor_2->rows_4 * sensor_2->rows_3) - (sensor_2->rows_4_2 * minus_rows_4_3) + (sensor_3->rows_4 *
        sensor_3->rows_3) - (sensor_3->rows_4_2 * minus_rows_6_3) + (sensor_4->rows_7_4 * sensor_4->rows_7_3) -
        (sensor_4->rows_8_4 * minus_rows_8_3) - (lower_4_1 * left_3_1) + (lower_4_2 * minus_left_3_2);
    const float lower_4_3 = hall_position_four_limit(left_4_3 * inverse_3, largest_L_amplitude_yaw);
    const float left_4_4 = (sensor_1->rows_4 * sensor_1->rows_4) + (sensor_1->rows_4_2 * sensor_1->rows_4_2) +
        (sensor_2->rows_4 * sensor_2->rows_4) + (sensor_2->rows_4_2 * sensor_2->rows_4_2) +
        (sensor_3->rows_4 * sensor_3->rows_4) + (sensor_3->rows_4_2 * sensor_3->rows_4_2) +
        (sensor_4->rows_7_4 * sensor_4->rows_7_4) + (sensor_4->rows_8_4 * sensor_4->rows_8_4) + prior_weight_amplitude;
    return (hall_position_four_estimator_factors_t){.inverse_1 = inverse_1, .lower_3_1 = lower_3_1, .minus_rows_2_3 =
        minus_rows_2_3, .minus_rows_4_3 = minus_rows_4_3, .minus_rows_6_3 = minus_rows_6_3, .minus_rows_8_3 =
        minus_rows_8_3, .inverse_2 = inverse_2, .lower_3_2 = lower_3_2, .lower_4_1 = lower_4_1, .lower_4_2 = lower_4_2,
        .inverse_3 = inverse_3, .lower_4_3 = lower_4_3, .diagonal_4 = 1.0f / hall_position_four_max(left_4_4 -
        (lower_4_1 * left_4_1) - (lower_4_2 * left_4_2) - (lower_4_3 * left_4_3), least_pivot_amplitude),
        .in_range = (left_1_1 <= largest_information_phase) && (left_2_2 <= largest_information_phase) &&
        (left_3_3 <= largest_information_yaw) && (left_4_4 <= largest_information_amplitude)};
}

typedef struct {
    float value;
    float forward_1;
    float forward_2;
    float forward_3;
    float forward_4;
} hall_position_four_estimator_normal_equations_t;

/* normal_equations */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_normal_equations_t
    hall_position_four_estimator_normal_equations(const hall_position_four_estimator_sensor_t *sensor_1,
    const hall_position_four_estimator_sensor_t *sensor_2, const hall_position_four_estimator_sensor_t *sensor_3,
    const hall_position_four_estimator_sensor_4_t *sensor_4, float offsets_4,
    const hall_position_four_estimator_factors_t *factors)
{
    /* V^2; channel_variance / sigma^2, sigma = 0.06 of the prior */
    static const float prior_weight_amplitude = 0.84055555f;

    const float forward_1 = (sensor_1->rows_1 * sensor_1->residuals) + (sensor_2->rows_1 * sensor_2->residuals) +
        (sensor_3->rows_1 * sensor_3->residuals) + (sensor_4->rows_7_1 * sensor_4->residuals_7);
    const float forward_2 = (sensor_1->rows_2 * sensor_1->residuals_2) + (sensor_2->rows_2 * sensor_2->residuals_2) +
        (sensor_3->rows_2 * sensor_3->residuals_2) + (sensor_4->rows_8_2 * sensor_4->residuals_8);
    const float forward_3 = (sensor_1->rows_3 * sensor_1->residuals) - (factors->minus_rows_2_3 *
        sensor_1->residuals_2) + (sensor_2->rows_3 * sensor_2->residuals) - (factors->minus_rows_4_3 *
        sensor_2->residuals_2) + (sensor_3->rows_3 * sensor_3->residuals) - (factors->minus_rows_6_3 *
        sensor_3->residuals_2) + (sensor_4->rows_7_3 * sensor_4->residuals_7) - (factors->minus_rows_8_3 *
        sensor_4->residuals_8) - (factors->lower_3_1 * forward_1) - (factors->lower_3_2 * forward_2);
    return (hall_position_four_estimator_normal_equations_t){.value = (sensor_1->residuals * sensor_1->residuals) +
        (sensor_1->residuals_2 * sensor_1->residuals_2) + (sensor_2->residuals * sensor_2->residuals) +
        (sensor_2->residuals_2 * sensor_2->residuals_2) + (sensor_3->residuals * sensor_3->residuals) +
        (sensor_3->residuals_2 * sensor_3->residuals_2) + (sensor_4->residuals_7 * sensor_4->residuals_7) +
        (sensor_4->residuals_8 * sensor_4->residuals_8) + (prior_weight_amplitude * (offsets_4 * offsets_4)),
        .forward_1 = forward_1, .forward_2 = forward_2, .forward_3 = forward_3, .forward_4 = (sensor_1->rows_4 *
        sensor_1->residuals) + (sensor_1->rows_4_2 * sensor_1->residuals_2) + (sensor_2->rows_4 * sensor_2->residuals) +
        (sensor_2->rows_4_2 * sensor_2->residuals_2) + (sensor_3->rows_4 * sensor_3->residuals) +
        (sensor_3->rows_4_2 * sensor_3->residuals_2) + (sensor_4->rows_7_4 * sensor_4->residuals_7) +
        (sensor_4->rows_8_4 * sensor_4->residuals_8) - (prior_weight_amplitude * offsets_4) -
        (factors->lower_4_1 * forward_1) - (factors->lower_4_2 * forward_2) - (factors->lower_4_3 * forward_3)};
}

typedef struct {
    float weighted_4;
    float moves_3;
    float moves_1;
    float minus_moves_2;
    float moves_2;
    float gain;
    float lower_2_1;
    float moves_1_2;
    float moves_2_2;
    float minus_moves_3;
    float moves_3_2;
    float moves_4;
    float gain_2;
} hall_position_four_estimator_hypothesis_t;

/* hypothesis_1, hypothesis_2, hypothesis_3, hypothesis_4 */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_hypothesis_t hall_position_four_estimator_hypothesis(float rows_1,
    float inverse_1, float lower_3_1, float rows_3, float inverse_3, float lower_4_3, float rows_4, float lower_4_1,
    float diagonal_4, float lower_3_2, float lower_4_2, float minus_rows_3, float rows_2, float rows_4_2,
    float inverse_2)
{
    static const float least_separability = 0.001f;             /* 1; below it a fault looks like a motion */
    static const float largest_mixing = 31.622776f;             /* 1; bound of the factors of a group's separability */

    const float forward_1_3 = rows_3 - (lower_3_1 * rows_1);
    const float forward_1_4 = rows_4 - (lower_4_1 * rows_1) - (lower_4_3 * forward_1_3);
    const float weighted_4 = forward_1_4 * diagonal_4;
    const float weighted_1_3 = forward_1_3 * inverse_3;
    const float moves_3 = weighted_1_3 - (lower_4_3 * weighted_4);
    const float weighted_1_1 = rows_1 * inverse_1;
    const float moves_1 = weighted_1_1 - (lower_3_1 * moves_3) - (lower_4_1 * weighted_4);
    const float minus_moves_2 = (lower_3_2 * moves_3) + (lower_4_2 * weighted_4);
    const float gain = 1.0f / hall_position_four_max(1.0f -
        ((rows_1 * weighted_1_1) + (forward_1_3 * weighted_1_3) + (forward_1_4 * weighted_4)), least_separability);
    const float minus_forward_2_3 = minus_rows_3 + (lower_3_2 * rows_2);
    const float forward_2_4 = rows_4_2 - (lower_4_2 * rows_2) + (lower_4_3 * minus_forward_2_3);
    const float weighted_2_4 = forward_2_4 * diagonal_4;
    const float minus_weighted_2_3 = minus_forward_2_3 * inverse_3;
    const float minus_left_2_1 = (weighted_2_4 * forward_1_4) - (minus_weighted_2_3 * forward_1_3);
    const float lower_2_1 = hall_position_four_limit(-(minus_left_2_1 * gain), largest_mixing);
    const float minus_step = minus_weighted_2_3 + (lower_4_3 * weighted_2_4);
    const float weighted_2_2 = rows_2 * inverse_2;
    const float minus_moves_3 = minus_step + (lower_2_1 * moves_3);
    const float gain_2_limited = hall_position_four_max(1.0f - ((rows_2 * weighted_2_2) + (minus_forward_2_3 *
        minus_weighted_2_3) + (forward_2_4 * weighted_2_4)) + (lower_2_1 * minus_left_2_1), least_separability);
    return (hall_position_four_estimator_hypothesis_t){.weighted_4 = weighted_4, .moves_3 = moves_3, .moves_1 = moves_1,
        .minus_moves_2 = minus_moves_2, .moves_2 = -minus_moves_2, .gain = gain, .lower_2_1 = lower_2_1,
        .moves_1_2 = (lower_3_1 * minus_step) - (lower_4_1 * weighted_2_4) - (lower_2_1 * moves_1),
        .moves_2_2 = weighted_2_2 + (lower_3_2 * minus_step) - (lower_4_2 * weighted_2_4) + (lower_2_1 * minus_moves_2),
        .minus_moves_3 = minus_moves_3, .moves_3_2 = -minus_moves_3, .moves_4 = weighted_2_4 - (lower_2_1 * weighted_4),
        .gain_2 = 1.0f / gain_2_limited};
}

typedef struct {
    float weighted_1_4;
    float moves_1_3;
    float moves_1_1;
    float minus_moves_1_2;
    float moves_1_2;
    float gain_1;
    float moves_2_1;
    float moves_2_2;
    float minus_moves_2_3;
    float moves_2_3;
    float moves_2_4;
    float weighted_3_4;
    float moves_3_3;
    float moves_3_1;
    float minus_moves_3_2;
    float moves_3_2;
    float gain_3;
    float moves_4_1;
    float moves_4_2;
    float minus_moves_4_3;
    float moves_4_3;
    float moves_4_4;
    float weighted_5_4;
    float moves_5_3;
    float moves_5_1;
    float minus_moves_5_2;
    float moves_5_2;
    float gain_5;
    float moves_6_1;
    float moves_6_2;
    float minus_moves_6_3;
    float moves_6_3;
    float moves_6_4;
    float weighted_7_4;
    float moves_7_3;
    float moves_7_1;
    float minus_moves_7_2;
    float moves_7_2;
    float gain_7;
    float moves_8_1;
    float moves_8_2;
    float minus_moves_8_3;
    float moves_8_3;
    float moves_8_4;
    float gain_2;
    float gain_4;
    float gain_6;
    float gain_8;
    float steps_4;
    float steps_3;
    float steps_1;
    float steps_2;
    float diagonal_1;
    float diagonal_2;
    float diagonal_3;
    float scores_1;
    float scores_2;
    float scores_3;
    float scores_4;
    float scores_5;
    float scores_6;
    float scores_7;
    float scores_8;
    float full_cost;
    bool detectable;
} hall_position_four_estimator_separation_t;

/* separation */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_separation_t
    hall_position_four_estimator_separation(const hall_position_four_estimator_sensor_t *sensor_1,
    const hall_position_four_estimator_factors_t *factors, const hall_position_four_estimator_sensor_t *sensor_2,
    const hall_position_four_estimator_sensor_t *sensor_3, const hall_position_four_estimator_sensor_4_t *sensor_4,
    const hall_position_four_estimator_normal_equations_t *normal_equations)
{
    /* 1; 1 / separability, less 1e-05 of it, of a fault that is detectable */
    static const float largest_gain = 999.99f;

    const hall_position_four_estimator_hypothesis_t hypothesis_1 =
        hall_position_four_estimator_hypothesis(sensor_1->rows_1, factors->inverse_1, factors->lower_3_1,
        sensor_1->rows_3, factors->inverse_3, factors->lower_4_3, sensor_1->rows_4, factors->lower_4_1,
        factors->diagonal_4, factors->lower_3_2, factors->lower_4_2, factors->minus_rows_2_3, sensor_1->rows_2,
        sensor_1->rows_4_2, factors->inverse_2);
    const hall_position_four_estimator_hypothesis_t hypothesis_2 =
        hall_position_four_estimator_hypothesis(sensor_2->rows_1, factors->inverse_1, factors->lower_3_1,
        sensor_2->rows_3, factors->inverse_3, factors->lower_4_3, sensor_2->rows_4, factors->lower_4_1,
        factors->diagonal_4, factors->lower_3_2, factors->lower_4_2, factors->minus_rows_4_3, sensor_2->rows_2,
        sensor_2->rows_4_2, factors->inverse_2);
    const hall_position_four_estimator_hypothesis_t hypothesis_3 =
        hall_position_four_estimator_hypothesis(sensor_3->rows_1, factors->inverse_1, factors->lower_3_1,
        sensor_3->rows_3, factors->inverse_3, factors->lower_4_3, sensor_3->rows_4, factors->lower_4_1,
        factors->diagonal_4, factors->lower_3_2, factors->lower_4_2, factors->minus_rows_6_3, sensor_3->rows_2,
        sensor_3->rows_4_2, factors->inverse_2);
    const hall_position_four_estimator_hypothesis_t hypothesis_4 =
        hall_position_four_estimator_hypothesis(sensor_4->rows_7_1, factors->inverse_1, factors->lower_3_1,
        sensor_4->rows_7_3, factors->inverse_3, factors->lower_4_3, sensor_4->rows_7_4, factors->lower_4_1,
        factors->diagonal_4, factors->lower_3_2, factors->lower_4_2, factors->minus_rows_8_3, sensor_4->rows_8_2,
        sensor_4->rows_8_4, factors->inverse_2);
    const bool detectable_test = (hypothesis_1.gain < largest_gain) && (hypothesis_1.gain_2 < largest_gain) &&
        (hypothesis_2.gain < largest_gain) && (hypothesis_2.gain_2 < largest_gain) &&
        (hypothesis_3.gain < largest_gain) && (hypothesis_3.gain_2 < largest_gain);
    const float steps_4 = normal_equations->forward_4 * factors->diagonal_4;
    const float forward_3_times_inverse_3 = normal_equations->forward_3 * factors->inverse_3;
    const float steps_3 = forward_3_times_inverse_3 - (factors->lower_4_3 * steps_4);
    const float forward_1_times_inverse_1 = normal_equations->forward_1 * factors->inverse_1;
    const float steps_1 = forward_1_times_inverse_1 - (factors->lower_3_1 * steps_3) - (factors->lower_4_1 * steps_4);
    const float forward_2_times_inverse_2 = normal_equations->forward_2 * factors->inverse_2;
    const float steps_2 = forward_2_times_inverse_2 - (factors->lower_3_2 * steps_3) - (factors->lower_4_2 * steps_4);
    const float diagonal_1_sum = factors->lower_4_1 - (factors->lower_4_3 * factors->lower_3_1);
    const float diagonal_2_sum = factors->lower_4_2 - (factors->lower_4_3 * factors->lower_3_2);
    const float scores_1 = sensor_1->residuals -
        ((sensor_1->rows_1 * steps_1) + (sensor_1->rows_3 * steps_3) + (sensor_1->rows_4 * steps_4));
    const float scores_3 = sensor_2->residuals -
        ((sensor_2->rows_1 * steps_1) + (sensor_2->rows_3 * steps_3) + (sensor_2->rows_4 * steps_4));
    const float scores_5 = sensor_3->residuals -
        ((sensor_3->rows_1 * steps_1) + (sensor_3->rows_3 * steps_3) + (sensor_3->rows_4 * steps_4));
    const float scores_7 = sensor_4->residuals_7 -
        ((sensor_4->rows_7_1 * steps_1) + (sensor_4->rows_7_3 * steps_3) + (sensor_4->rows_7_4 * steps_4));
    const float full_cost_sum = (normal_equations->forward_1 * forward_1_times_inverse_1) +
        (normal_equations->forward_2 * forward_2_times_inverse_2) +
        (normal_equations->forward_3 * forward_3_times_inverse_3) + (normal_equations->forward_4 * steps_4);
    return (hall_position_four_estimator_separation_t){.weighted_1_4 = hypothesis_1.weighted_4, .moves_1_3 =
        hypothesis_1.moves_3, .moves_1_1 = hypothesis_1.moves_1, .minus_moves_1_2 = hypothesis_1.minus_moves_2,
        .moves_1_2 = hypothesis_1.moves_2, .gain_1 = hypothesis_1.gain, .moves_2_1 = hypothesis_1.moves_1_2, .moves_2_2
        = hypothesis_1.moves_2_2, .minus_moves_2_3 = hypothesis_1.minus_moves_3, .moves_2_3 = hypothesis_1.moves_3_2,
        .moves_2_4 = hypothesis_1.moves_4, .weighted_3_4 = hypothesis_2.weighted_4, .moves_3_3 = hypothesis_2.moves_3,
        .moves_3_1 = hypothesis_2.moves_1, .minus_moves_3_2 = hypothesis_2.minus_moves_2, .moves_3_2 =
        hypothesis_2.moves_2, .gain_3 = hypothesis_2.gain, .moves_4_1 = hypothesis_2.moves_1_2, .moves_4_2 =
        hypothesis_2.moves_2_2, .minus_moves_4_3 = hypothesis_2.minus_moves_3, .moves_4_3 = hypothesis_2.moves_3_2,
        .moves_4_4 = hypothesis_2.moves_4, .weighted_5_4 = hypothesis_3.weighted_4, .moves_5_3 = hypothesis_3.moves_3,
        .moves_5_1 = hypothesis_3.moves_1, .minus_moves_5_2 = hypothesis_3.minus_moves_2, .moves_5_2 =
        hypothesis_3.moves_2, .gain_5 = hypothesis_3.gain, .moves_6_1 = hypothesis_3.moves_1_2, .moves_6_2 =
        hypothesis_3.moves_2_2, .minus_moves_6_3 = hypothesis_3.minus_moves_3, .moves_6_3 = hypothesis_3.moves_3_2,
        .moves_6_4 = hypothesis_3.moves_4, .weighted_7_4 = hypothesis_4.weighted_4, .moves_7_3 = hypothesis_4.moves_3,
        .moves_7_1 = hypothesis_4.moves_1, .minus_moves_7_2 = hypothesis_4.minus_moves_2, .moves_7_2 =
        hypothesis_4.moves_2, .gain_7 = hypothesis_4.gain, .moves_8_1 = hypothesis_4.moves_1_2, .moves_8_2 =
        hypothesis_4.moves_2_2, .minus_moves_8_3 = hypothesis_4.minus_moves_3, .moves_8_3 = hypothesis_4.moves_3_2,
        .moves_8_4 = hypothesis_4.moves_4, .gain_2 = hypothesis_1.gain_2, .gain_4 = hypothesis_2.gain_2, .gain_6 =
        hypothesis_3.gain_2, .gain_8 = hypothesis_4.gain_2, .steps_4 = steps_4, .steps_3 = steps_3, .steps_1 = steps_1,
        .steps_2 = steps_2, .diagonal_1 = factors->inverse_1 + (factors->lower_3_1 * factors->lower_3_1 *
        factors->inverse_3) + (diagonal_1_sum * diagonal_1_sum * factors->diagonal_4), .diagonal_2 = factors->inverse_2
        + (factors->lower_3_2 * factors->lower_3_2 * factors->inverse_3) + (diagonal_2_sum * diagonal_2_sum *
        factors->diagonal_4), .diagonal_3 = factors->inverse_3 + (factors->lower_4_3 * factors->lower_4_3 *
        factors->diagonal_4), .scores_1 = scores_1, .scores_2 = sensor_1->residuals_2 - ((sensor_1->rows_2 * steps_2) -
        (factors->minus_rows_2_3 * steps_3) + (sensor_1->rows_4_2 * steps_4)) - (hypothesis_1.lower_2_1 * scores_1),
        .scores_3 = scores_3, .scores_4 = sensor_2->residuals_2 - ((sensor_2->rows_2 * steps_2) -
        (factors->minus_rows_4_3 * steps_3) + (sensor_2->rows_4_2 * steps_4)) - (hypothesis_2.lower_2_1 * scores_3),
        .scores_5 = scores_5, .scores_6 = sensor_3->residuals_2 - ((sensor_3->rows_2 * steps_2) -
        (factors->minus_rows_6_3 * steps_3) + (sensor_3->rows_4_2 * steps_4)) - (hypothesis_3.lower_2_1 * scores_5),
        .scores_7 = scores_7, .scores_8 = sensor_4->residuals_8 - ((sensor_4->rows_8_2 * steps_2) -
        (factors->minus_rows_8_3 * steps_3) + (sensor_4->rows_8_4 * steps_4)) - (hypothesis_4.lower_2_1 * scores_7),
        .full_cost = hall_position_four_max(normal_equations->value - full_cost_sum, 0.0f),
        .detectable = detectable_test && (hypothesis_4.gain < largest_gain) && (hypothesis_4.gain_2 < largest_gain)};
}

typedef struct {
    float move_excluded_1_1;
    float move_excluded_1_2;
    float move_excluded_1_3;
    float move_excluded_1_4;
    float move_excluded_2_1;
    float move_excluded_2_2;
    float move_excluded_2_3;
    float move_excluded_2_4;
    float gain_excluded_1;
    float gain_excluded_2;
    float scores_1;
    float scores_2;
} hall_position_four_estimator_removal_t;

/* removal */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_removal_t hall_position_four_estimator_removal(bool phase_x_test,
    bool phase_x_test_2, const hall_position_four_estimator_separation_t *separation, bool phase_x_test_3)
{
    float move_excluded_1_1;
    float move_excluded_1_2;
    float move_excluded_1_3;
    float move_excluded_1_4;
    float move_excluded_2_1;
    float move_excluded_2_2;
    float move_excluded_2_3;
    float move_excluded_2_4;
    float gain_excluded_1;
    float gain_excluded_2;
    float scores_1;
    float scores_2;
    if (phase_x_test) {
        if (phase_x_test_2) {
            move_excluded_1_1 = separation->moves_1_1;
            move_excluded_1_2 = separation->moves_1_2;
            move_excluded_1_3 = separation->moves_1_3;
            move_excluded_1_4 = separation->weighted_1_4;
            move_excluded_2_1 = separation->moves_2_1;
            move_excluded_2_2 = separation->moves_2_2;
            move_excluded_2_3 = separation->moves_2_3;
            move_excluded_2_4 = separation->moves_2_4;
            gain_excluded_1 = separation->gain_1;
            gain_excluded_2 = separation->gain_2;
            scores_1 = separation->scores_1;
            scores_2 = separation->scores_2;
        } else {
            move_excluded_1_1 = separation->moves_3_1;
            move_excluded_1_2 = separation->moves_3_2;
            move_excluded_1_3 = separation->moves_3_3;
            move_excluded_1_4 = separation->weighted_3_4;
            move_excluded_2_1 = separation->moves_4_1;
            move_excluded_2_2 = separation->moves_4_2;
            move_excluded_2_3 = separation->moves_4_3;
            move_excluded_2_4 = separation->moves_4_4;
            gain_excluded_1 = separation->gain_3;
            gain_excluded_2 = separation->gain_4;
            scores_1 = separation->scores_3;
            scores_2 = separation->scores_4;
        }
    } else if (phase_x_test_3) {
        move_excluded_1_1 = separation->moves_5_1;
        move_excluded_1_2 = separation->moves_5_2;
        move_excluded_1_3 = separation->moves_5_3;
        move_excluded_1_4 = separation->weighted_5_4;
        move_excluded_2_1 = separation->moves_6_1;
        move_excluded_2_2 = separation->moves_6_2;
        move_excluded_2_3 = separation->moves_6_3;
        move_excluded_2_4 = separation->moves_6_4;
        gain_excluded_1 = separation->gain_5;
        gain_excluded_2 = separation->gain_6;
        scores_1 = separation->scores_5;
        scores_2 = separation->scores_6;
    } else {
        move_excluded_1_1 = separation->moves_7_1;
        move_excluded_1_2 = separation->moves_7_2;
        move_excluded_1_3 = separation->moves_7_3;
        move_excluded_1_4 = separation->weighted_7_4;
        move_excluded_2_1 = separation->moves_8_1;
        move_excluded_2_2 = separation->moves_8_2;
        move_excluded_2_3 = separation->moves_8_3;
        move_excluded_2_4 = separation->moves_8_4;
        gain_excluded_1 = separation->gain_7;
        gain_excluded_2 = separation->gain_8;
        scores_1 = separation->scores_7;
        scores_2 = separation->scores_8;
    }
    return (hall_position_four_estimator_removal_t){.move_excluded_1_1 = move_excluded_1_1, .move_excluded_1_2 =
        move_excluded_1_2, .move_excluded_1_3 = move_excluded_1_3, .move_excluded_1_4 = move_excluded_1_4,
        .move_excluded_2_1 = move_excluded_2_1, .move_excluded_2_2 = move_excluded_2_2, .move_excluded_2_3 =
        move_excluded_2_3, .move_excluded_2_4 = move_excluded_2_4, .gain_excluded_1 = gain_excluded_1,
        .gain_excluded_2 = gain_excluded_2, .scores_1 = scores_1, .scores_2 = scores_2};
}

typedef struct {
    float offsets_1;
    float offsets_2;
    float offsets_3;
    float value;
} hall_position_four_estimator_correction_t;

/* correction */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_correction_t hall_position_four_estimator_correction(float
    steps_1, bool none, float move_excluded_1_1, float gain_excluded_1, float scores_1, float move_excluded_2_1, float
    gain_excluded_2, float scores_2, float steps_2, float move_excluded_1_2, float move_excluded_2_2, float steps_3,
    float move_excluded_1_3, float move_excluded_2_3, float steps_4, float move_excluded_1_4, float move_excluded_2_4)
{
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */
    static const float largest_step_yaw = 0.1f;                 /* rad; correction of a sample at most */
    static const float largest_step_amplitude = 0.125f;         /* 1; correction of a sample at most */

    float added_1 = 0.0f;
    float added_2 = 0.0f;
    float added_3 = 0.0f;
    float added_4 = 0.0f;
    if (!none) {
        const float offsets_1_product = gain_excluded_1 * scores_1;
        const float offsets_1_product_2 = gain_excluded_2 * scores_2;
        added_1 = -((move_excluded_1_1 * offsets_1_product) + (move_excluded_2_1 * offsets_1_product_2));
        added_2 = -((move_excluded_1_2 * offsets_1_product) + (move_excluded_2_2 * offsets_1_product_2));
        added_3 = -((move_excluded_1_3 * offsets_1_product) + (move_excluded_2_3 * offsets_1_product_2));
        added_4 = -((move_excluded_1_4 * offsets_1_product) + (move_excluded_2_4 * offsets_1_product_2));
    }
    return (hall_position_four_estimator_correction_t){.offsets_1 = hall_position_four_limit(steps_1 + added_1,
        largest_step_phase), .offsets_2 = hall_position_four_limit(steps_2 + added_2, largest_step_phase),
        .offsets_3 = hall_position_four_limit(steps_3 + added_3, largest_step_yaw),
        .value = hall_position_four_limit(steps_4 + added_4, largest_step_amplitude)};
}

typedef struct {
    float residuals;
    float residuals_2;
} hall_position_four_estimator_sensor_2_t;

/* sensor_1, sensor_2, sensor_3, sensor_4 */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_sensor_2_t hall_position_four_estimator_sensor_2(float
    cosine_polynomial, float V_held, float turn_yaw_sine, float V_held_2, float value_2_limited, float part_full,
    float by, float phasor_cosine, float part_full_2, float by_2, float phasor_cosine_2)
{
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */

    const float cosine_2_argument = by * by;
    const float phasor_ax_sine = (part_full * cosine_2_polynomial(cosine_2_argument)) +
        (phasor_cosine * (by * sine_4_polynomial(cosine_2_argument)));
    const float phasor_ax_sine_squared = phasor_ax_sine * phasor_ax_sine;
    const float cosine_2_argument_2 = by_2 * by_2;
    const float phasor_ay_sine = (part_full_2 * cosine_2_polynomial(cosine_2_argument_2)) +
        (phasor_cosine_2 * (by_2 * sine_4_polynomial(cosine_2_argument_2)));
    const float phasor_ay_sine_squared = phasor_ay_sine * phasor_ay_sine;
    return (hall_position_four_estimator_sensor_2_t){.residuals = (cosine_polynomial * V_held) -
        (turn_yaw_sine * V_held_2) - (value_2_limited *
        (phasor_ax_sine * (field_1 + (phasor_ax_sine_squared * (field_3 + (phasor_ax_sine_squared * field_5)))))),
        .residuals_2 = (cosine_polynomial * V_held_2) + (turn_yaw_sine * V_held) - (value_2_limited *
        (phasor_ay_sine * (field_1 + (phasor_ay_sine_squared * (field_3 + (phasor_ay_sine_squared * field_5))))))};
}

typedef struct {
    float offsets_1;
    float offsets_2;
    float offsets_3;
    float value;
    float value_2;
    float gradient_1;
    float gradient_2;
    float forward_3;
    float forward_4;
    float projection_1;
    float projection_2;
} hall_position_four_estimator_iteration_1_t;

/* iteration_1 */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_iteration_1_t
    hall_position_four_estimator_iteration_1(const hall_position_four_estimator_separation_t *separation, bool none,
    const hall_position_four_estimator_removal_t *removal, float predicted_yaw, float V_ax_held, float V_ay_held,
    float amplitude, const hall_position_four_estimator_prediction_t *prediction, float V_bx_held, float V_by_held,
    float V_cx_held, float V_cy_held, float V_dx_held, float V_dy_held, const hall_position_four_estimator_weights_t
    *weights, float offsets_4, const hall_position_four_estimator_sensor_t *sensor_1,
    const hall_position_four_estimator_sensor_t *sensor_2, const hall_position_four_estimator_sensor_t *sensor_3,
    const hall_position_four_estimator_sensor_4_t *sensor_4, const hall_position_four_estimator_factors_t *factors)
{
    static const float largest_step_yaw = 0.1f;                 /* rad; correction of a sample at most */
    static const float highest_yaw = 0.20943952f;               /* rad; end of its range */
    static const float highest_amplitude = 1.25f;               /* 1; end of its range */
    static const float lowest_amplitude = 0.75f;                /* 1; end of its range */
    static const float arm_a_x = 0.28902653f; /* rad; arm of sensor a along x, times 2 pi over the pitch */
    static const float arm_a_y = -0.45238933f; /* rad; arm of sensor a along y, times 2 pi over the pitch */
    static const float arm_b_x = -1.118407f; /* rad; arm of sensor b along x, times 2 pi over the pitch */
    static const float arm_b_y = -1.7404423f; /* rad; arm of sensor b along y, times 2 pi over the pitch */
    static const float arm_c_x = -2.506991f; /* rad; arm of sensor c along x, times 2 pi over the pitch */
    static const float arm_c_y = -3.0033627f; /* rad; arm of sensor c along y, times 2 pi over the pitch */
    static const float arm_d_x = 1.627345f; /* rad; arm of sensor d along x, times 2 pi over the pitch */
    static const float arm_d_y = 0.76654863f; /* rad; arm of sensor d along y, times 2 pi over the pitch */
    /* V^2; channel_variance / sigma^2, sigma = 0.06 of the prior */
    static const float prior_weight_amplitude = 0.84055555f;
    static const float largest_projection = 1845.4835f;         /* V; bound of |x_j'g|, which never acts */

    const hall_position_four_estimator_correction_t correction =
        hall_position_four_estimator_correction(separation->steps_1, none, removal->move_excluded_1_1,
        removal->gain_excluded_1, removal->scores_1, removal->move_excluded_2_1, removal->gain_excluded_2,
        removal->scores_2, separation->steps_2, removal->move_excluded_1_2, removal->move_excluded_2_2,
        separation->steps_3, removal->move_excluded_1_3, removal->move_excluded_2_3, separation->steps_4,
        removal->move_excluded_1_4, removal->move_excluded_2_4);
    const float moved_yaw = hall_position_four_limit(predicted_yaw + correction.offsets_3, highest_yaw);
    const float cosine_argument = moved_yaw * moved_yaw;
    const float turn_yaw_cosine = cosine_polynomial(cosine_argument);
    const float chord_yaw_cosine = turn_yaw_cosine - prediction->cos_yaw;
    const float turn_yaw_sine = moved_yaw * sine_polynomial(cosine_argument);
    const float limited_yaw_sine = hall_position_four_limit(turn_yaw_sine - prediction->sin_yaw, largest_step_yaw);
    const float value_2_limited = hall_position_four_max(hall_position_four_min(amplitude + correction.value,
        highest_amplitude), lowest_amplitude);
    float value_2_choice = 0.0f;
    float gradient_1_choice = 0.0f;
    float gradient_2_choice = 0.0f;
    float forward_3_choice = 0.0f;
    float forward_4_choice = 0.0f;
    if (weights->weights_2) {
        const hall_position_four_estimator_sensor_2_t sensor_1_2 =
            hall_position_four_estimator_sensor_2(turn_yaw_cosine, V_ax_held, turn_yaw_sine, V_ay_held, value_2_limited,
            prediction->ax_part_full, correction.offsets_1 + (arm_a_x * chord_yaw_cosine) -
            (arm_a_y * limited_yaw_sine), prediction->phasor_ax_cosine, prediction->ay_part_full, correction.offsets_2 +
            (arm_a_y * chord_yaw_cosine) + (arm_a_x * limited_yaw_sine), prediction->phasor_ay_cosine);
        value_2_choice = (sensor_1_2.residuals * sensor_1_2.residuals) +
            (sensor_1_2.residuals_2 * sensor_1_2.residuals_2);
        gradient_1_choice = sensor_1->rows_1 * sensor_1_2.residuals;
        gradient_2_choice = sensor_1->rows_2 * sensor_1_2.residuals_2;
        forward_3_choice = (sensor_1->rows_3 * sensor_1_2.residuals) -
            (factors->minus_rows_2_3 * sensor_1_2.residuals_2);
        forward_4_choice = (sensor_1->rows_4 * sensor_1_2.residuals) + (sensor_1->rows_4_2 * sensor_1_2.residuals_2);
    }
    float value_2_choice_2 = 0.0f;
    float value_2_choice_3 = 0.0f;
    float gradient_1_choice_2 = 0.0f;
    float gradient_2_choice_2 = 0.0f;
    float forward_3_choice_2 = 0.0f;
    float forward_3_choice_3 = 0.0f;
    float forward_4_choice_2 = 0.0f;
    float forward_4_choice_3 = 0.0f;
    if (weights->weights_4) {
        const hall_position_four_estimator_sensor_2_t sensor_2_2 =
            hall_position_four_estimator_sensor_2(turn_yaw_cosine, V_bx_held, turn_yaw_sine, V_by_held, value_2_limited,
            prediction->bx_part_full, correction.offsets_1 + (arm_b_x * chord_yaw_cosine) -
            (arm_b_y * limited_yaw_sine), prediction->phasor_bx_cosine, prediction->by_part_full, correction.offsets_2 +
            (arm_b_y * chord_yaw_cosine) + (arm_b_x * limited_yaw_sine), prediction->phasor_by_cosine);
        value_2_choice_2 = sensor_2_2.residuals * sensor_2_2.residuals;
        value_2_choice_3 = sensor_2_2.residuals_2 * sensor_2_2.residuals_2;
        gradient_1_choice_2 = sensor_2->rows_1 * sensor_2_2.residuals;
        gradient_2_choice_2 = sensor_2->rows_2 * sensor_2_2.residuals_2;
        forward_3_choice_2 = sensor_2->rows_3 * sensor_2_2.residuals;
        forward_3_choice_3 = -(factors->minus_rows_4_3 * sensor_2_2.residuals_2);
        forward_4_choice_2 = sensor_2->rows_4 * sensor_2_2.residuals;
        forward_4_choice_3 = sensor_2->rows_4_2 * sensor_2_2.residuals_2;
    }
    float value_2_choice_4 = 0.0f;
    float value_2_choice_5 = 0.0f;
    float gradient_1_choice_3 = 0.0f;
    float gradient_2_choice_3 = 0.0f;
    float forward_3_choice_4 = 0.0f;
    float forward_3_choice_5 = 0.0f;
    float forward_4_choice_4 = 0.0f;
    float forward_4_choice_5 = 0.0f;
    if (weights->weights_6) {
        const hall_position_four_estimator_sensor_2_t sensor_3_2 =
            hall_position_four_estimator_sensor_2(turn_yaw_cosine, V_cx_held, turn_yaw_sine, V_cy_held, value_2_limited,
            prediction->cx_part_full, correction.offsets_1 + (arm_c_x * chord_yaw_cosine) -
            (arm_c_y * limited_yaw_sine), prediction->phasor_cx_cosine, prediction->cy_part_full, correction.offsets_2 +
            (arm_c_y * chord_yaw_cosine) + (arm_c_x * limited_yaw_sine), prediction->phasor_cy_cosine);
        value_2_choice_4 = sensor_3_2.residuals * sensor_3_2.residuals;
        value_2_choice_5 = sensor_3_2.residuals_2 * sensor_3_2.residuals_2;
        gradient_1_choice_3 = sensor_3->rows_1 * sensor_3_2.residuals;
        gradient_2_choice_3 = sensor_3->rows_2 * sensor_3_2.residuals_2;
        forward_3_choice_4 = sensor_3->rows_3 * sensor_3_2.residuals;
        forward_3_choice_5 = -(factors->minus_rows_6_3 * sensor_3_2.residuals_2);
        forward_4_choice_4 = sensor_3->rows_4 * sensor_3_2.residuals;
        forward_4_choice_5 = sensor_3->rows_4_2 * sensor_3_2.residuals_2;
    }
    float value_2_choice_6 = 0.0f;
    float value_2_choice_7 = 0.0f;
    float gradient_1_choice_4 = 0.0f;
    float gradient_2_choice_4 = 0.0f;
    float forward_3_choice_6 = 0.0f;
    float forward_3_choice_7 = 0.0f;
    float forward_4_choice_6 = 0.0f;
    float forward_4_choice_7 = 0.0f;
    if (weights->weights_8) {
        const hall_position_four_estimator_sensor_2_t sensor_4_2 =
            hall_position_four_estimator_sensor_2(turn_yaw_cosine, V_dx_held, turn_yaw_sine, V_dy_held, value_2_limited,
            prediction->dx_part_full, correction.offsets_1 + (arm_d_x * chord_yaw_cosine) -
            (arm_d_y * limited_yaw_sine), prediction->phasor_dx_cosine, prediction->dy_part_full, correction.offsets_2 +
            (arm_d_y * chord_yaw_cosine) + (arm_d_x * limited_yaw_sine), prediction->phasor_dy_cosine);
        value_2_choice_6 = sensor_4_2.residuals * sensor_4_2.residuals;
        value_2_choice_7 = sensor_4_2.residuals_2 * sensor_4_2.residuals_2;
        gradient_1_choice_4 = sensor_4->rows_7_1 * sensor_4_2.residuals;
        gradient_2_choice_4 = sensor_4->rows_8_2 * sensor_4_2.residuals_2;
        forward_3_choice_6 = sensor_4->rows_7_3 * sensor_4_2.residuals;
        forward_3_choice_7 = -(factors->minus_rows_8_3 * sensor_4_2.residuals_2);
        forward_4_choice_6 = sensor_4->rows_7_4 * sensor_4_2.residuals;
        forward_4_choice_7 = sensor_4->rows_8_4 * sensor_4_2.residuals_2;
    }
    const float offsets_4_2 = offsets_4 + correction.value;
    const float gradient_1 = gradient_1_choice + gradient_1_choice_2 + gradient_1_choice_3 + gradient_1_choice_4;
    const float gradient_2 = gradient_2_choice + gradient_2_choice_2 + gradient_2_choice_3 + gradient_2_choice_4;
    const float gradient_3 = forward_3_choice + forward_3_choice_2 + forward_3_choice_3 + forward_3_choice_4 +
        forward_3_choice_5 + forward_3_choice_6 + forward_3_choice_7;
    const float forward_3 = gradient_3 - (factors->lower_3_1 * gradient_1) - (factors->lower_3_2 * gradient_2);
    const float gradient_4 = forward_4_choice + forward_4_choice_2 + forward_4_choice_3 + forward_4_choice_4 +
        forward_4_choice_5 + forward_4_choice_6 + forward_4_choice_7 - (prior_weight_amplitude * offsets_4_2);
    const float projection_1_unlimited = (removal->move_excluded_1_1 * gradient_1) + (removal->move_excluded_1_2 *
        gradient_2) + (removal->move_excluded_1_3 * gradient_3) + (removal->move_excluded_1_4 * gradient_4);
    const float projection_2_unlimited = (removal->move_excluded_2_1 * gradient_1) + (removal->move_excluded_2_2 *
        gradient_2) + (removal->move_excluded_2_3 * gradient_3) + (removal->move_excluded_2_4 * gradient_4);
    return (hall_position_four_estimator_iteration_1_t){.offsets_1 = correction.offsets_1, .offsets_2 =
        correction.offsets_2, .offsets_3 = correction.offsets_3, .value = correction.value, .value_2 = value_2_choice +
        value_2_choice_2 + value_2_choice_3 + value_2_choice_4 + value_2_choice_5 + value_2_choice_6 + value_2_choice_7
        + (prior_weight_amplitude * (offsets_4_2 * offsets_4_2)), .gradient_1 = gradient_1, .gradient_2 = gradient_2,
        .forward_3 = forward_3, .forward_4 = gradient_4 - (factors->lower_4_1 * gradient_1) - (factors->lower_4_2 *
        gradient_2) - (factors->lower_4_3 * forward_3), .projection_1 = hall_position_four_limit(projection_1_unlimited,
        largest_projection), .projection_2 = hall_position_four_limit(projection_2_unlimited, largest_projection)};
}

typedef struct {
    float moved_1;
    float moved_2;
    float moved_3;
    float moved_4;
    float value;
    bool below_decrease_tolerance;
} hall_position_four_estimator_last_correction_t;

/* last_correction */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_last_correction_t
    hall_position_four_estimator_last_correction(const hall_position_four_estimator_iteration_1_t *iteration_1, const
    hall_position_four_estimator_factors_t *factors, bool none, const hall_position_four_estimator_removal_t *removal)
{
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */
    static const float largest_step_yaw = 0.1f;                 /* rad; correction of a sample at most */
    static const float largest_step_amplitude = 0.125f;         /* 1; correction of a sample at most */
    /* V^2; (0.1 channel_sigma)^2: a smaller predicted decrease has converged */
    static const float decrease_tolerance = 3.026e-05f;

    const float gradient_1_times_inverse_1 = iteration_1->gradient_1 * factors->inverse_1;
    const float forward_3_times_inverse_3 = iteration_1->forward_3 * factors->inverse_3;
    const float steps_4 = iteration_1->forward_4 * factors->diagonal_4;
    const float steps_3 = forward_3_times_inverse_3 - (factors->lower_4_3 * steps_4);
    float added_1 = 0.0f;
    float added_2 = 0.0f;
    float added_3 = 0.0f;
    float added_4 = 0.0f;
    float value_choice = 0.0f;
    if (!none) {
        const float moved_1_product = removal->gain_excluded_1 * iteration_1->projection_1;
        const float moved_1_product_2 = removal->gain_excluded_2 * iteration_1->projection_2;
        added_1 = (removal->move_excluded_1_1 * moved_1_product) + (removal->move_excluded_2_1 * moved_1_product_2);
        added_2 = (removal->move_excluded_1_2 * moved_1_product) + (removal->move_excluded_2_2 * moved_1_product_2);
        added_3 = (removal->move_excluded_1_3 * moved_1_product) + (removal->move_excluded_2_3 * moved_1_product_2);
        added_4 = (removal->move_excluded_1_4 * moved_1_product) + (removal->move_excluded_2_4 * moved_1_product_2);
        value_choice = (removal->gain_excluded_1 * (iteration_1->projection_1 * iteration_1->projection_1)) +
            (removal->gain_excluded_2 * (iteration_1->projection_2 * iteration_1->projection_2));
    }
    const float gradient_2_times_inverse_2 = iteration_1->gradient_2 * factors->inverse_2;
    const float value = (iteration_1->gradient_1 * gradient_1_times_inverse_1) +
        (iteration_1->gradient_2 * gradient_2_times_inverse_2) + (iteration_1->forward_3 * forward_3_times_inverse_3) +
        (iteration_1->forward_4 * steps_4) + value_choice;
    return (hall_position_four_estimator_last_correction_t){.moved_1 = hall_position_four_limit(iteration_1->offsets_1 +
        (gradient_1_times_inverse_1 - (factors->lower_3_1 * steps_3) - (factors->lower_4_1 * steps_4) + added_1),
        largest_step_phase), .moved_2 = hall_position_four_limit(iteration_1->offsets_2 + (gradient_2_times_inverse_2 -
        (factors->lower_3_2 * steps_3) - (factors->lower_4_2 * steps_4) + added_2), largest_step_phase),
        .moved_3 = hall_position_four_limit(iteration_1->offsets_3 + (steps_3 + added_3), largest_step_yaw),
        .moved_4 = hall_position_four_limit(iteration_1->value + (steps_4 + added_4), largest_step_amplitude),
        .value = value, .below_decrease_tolerance = value <= decrease_tolerance};
}

typedef struct {
    float value;
    float value_2;
    float value_3;
    float value_4;
    bool weak;
} hall_position_four_estimator_deviations_t;

/* deviations */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_deviations_t
    hall_position_four_estimator_deviations(const hall_position_four_estimator_separation_t *separation, bool none,
    const hall_position_four_estimator_removal_t *removal, const hall_position_four_estimator_factors_t *factors)
{
    static const float channel_sigma = 0.05500909f;             /* V; deviation of a channel, from R */
    static const float largest_deviation_phase = 0.25f;         /* rad; largest sigma that is reported; of x, y */
    static const float largest_deviation_yaw = 0.1f;            /* rad; largest sigma that is reported */
    static const float largest_deviation_amplitude = 0.2f;      /* 1; largest sigma that is reported */
    /* rad^2/V^2; sigma^2 / channel_variance, sigma = 0.25 rad, less 1e-05 of it for rounding; of x, y */
    static const float weak_from_phase = 20.654123f;
    /* rad^2/V^2; sigma^2 / channel_variance, sigma = 0.1 rad, less 1e-05 of it for rounding */
    static const float weak_from_yaw = 3.3046596f;
    /* 1/V^2; sigma^2 / channel_variance, sigma = 0.2, less 1e-05 of it for rounding */
    static const float weak_from_amplitude = 13.218638f;

    float value_choice = 0.0f;
    float value_2_choice = 0.0f;
    float value_3_choice = 0.0f;
    float value_4_choice = 0.0f;
    if (!none) {
        value_choice = (removal->gain_excluded_1 * (removal->move_excluded_1_1 * removal->move_excluded_1_1)) +
            (removal->gain_excluded_2 * (removal->move_excluded_2_1 * removal->move_excluded_2_1));
        value_2_choice = (removal->gain_excluded_1 * (removal->move_excluded_1_2 * removal->move_excluded_1_2)) +
            (removal->gain_excluded_2 * (removal->move_excluded_2_2 * removal->move_excluded_2_2));
        value_3_choice = (removal->gain_excluded_1 * (removal->move_excluded_1_3 * removal->move_excluded_1_3)) +
            (removal->gain_excluded_2 * (removal->move_excluded_2_3 * removal->move_excluded_2_3));
        value_4_choice = (removal->gain_excluded_1 * (removal->move_excluded_1_4 * removal->move_excluded_1_4)) +
            (removal->gain_excluded_2 * (removal->move_excluded_2_4 * removal->move_excluded_2_4));
    }
    const float variance_phase_x = separation->diagonal_1 + value_choice;
    const float variance_phase_y = separation->diagonal_2 + value_2_choice;
    const float variance_yaw = separation->diagonal_3 + value_3_choice;
    const float variance_amplitude = factors->diagonal_4 + value_4_choice;
    return (hall_position_four_estimator_deviations_t){.value = hall_position_four_min(channel_sigma *
        sqrtf(variance_phase_x), largest_deviation_phase),
        .value_2 = hall_position_four_min(channel_sigma * sqrtf(variance_phase_y), largest_deviation_phase),
        .value_3 = hall_position_four_min(channel_sigma * sqrtf(variance_yaw), largest_deviation_yaw),
        .value_4 = hall_position_four_min(channel_sigma * sqrtf(variance_amplitude), largest_deviation_amplitude),
        .weak = !factors->in_range || (weak_from_phase <= variance_phase_x) || (weak_from_phase <= variance_phase_y) ||
        (weak_from_yaw <= variance_yaw) || (weak_from_amplitude <= variance_amplitude)};
}

typedef struct {
    float pose_phase_x;
    float pose_phase_y;
    float pose_yaw;
    float pose_amplitude;
    float motions_motion_phase_x;
    float motions_motion_phase_y;
    float motions_motion_yaw;
} hall_position_four_estimator_movement_t;

/* movement */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_movement_t hall_position_four_estimator_movement(bool x_trial,
    const hall_position_four_estimator_extrapolation_t *extrapolation,
    const hall_position_four_estimator_last_correction_t *last_correction, float amplitude, float motion_phase_x,
    float motion_phase_y, float motion_yaw)
{
    static const float pi = 3.1415927f;                         /* 1 */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    static const float highest_yaw = 0.20943952f;               /* rad; end of its range */
    static const float highest_amplitude = 1.25f;               /* 1; end of its range */
    static const float lowest_amplitude = 0.75f;                /* 1; end of its range */
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */
    static const float largest_step_yaw = 0.1f;                 /* rad; correction of a sample at most */

    float pose_phase_x = extrapolation->predicted_phase_x;
    float pose_phase_y = extrapolation->predicted_phase_y;
    float pose_yaw = extrapolation->predicted_yaw;
    float pose_amplitude = amplitude;
    float motions_motion_phase_x = motion_phase_x;
    float motions_motion_phase_y = motion_phase_y;
    float motions_motion_yaw = motion_yaw;
    if (!x_trial) {
        const float pose_phase_x_sum = extrapolation->predicted_phase_x + last_correction->moved_1;
        float pose_phase_x_choice = pose_phase_x_sum;
        if (pi < pose_phase_x_sum) {
            pose_phase_x_choice = pose_phase_x_sum - two_pi;
        }
        float pose_phase_x_choice_2 = pose_phase_x_choice;
        if (pose_phase_x_choice < -pi) {
            pose_phase_x_choice_2 = pose_phase_x_choice + two_pi;
        }
        pose_phase_x = hall_position_four_limit(pose_phase_x_choice_2, pi);
        const float pose_phase_y_sum = extrapolation->predicted_phase_y + last_correction->moved_2;
        float pose_phase_y_choice = pose_phase_y_sum;
        if (pi < pose_phase_y_sum) {
            pose_phase_y_choice = pose_phase_y_sum - two_pi;
        }
        float pose_phase_y_choice_2 = pose_phase_y_choice;
        if (pose_phase_y_choice < -pi) {
            pose_phase_y_choice_2 = pose_phase_y_choice + two_pi;
        }
        pose_phase_y = hall_position_four_limit(pose_phase_y_choice_2, pi);
        pose_yaw = hall_position_four_limit(extrapolation->predicted_yaw + last_correction->moved_3, highest_yaw);
        pose_amplitude = hall_position_four_max(hall_position_four_min(amplitude + last_correction->moved_4,
            highest_amplitude), lowest_amplitude);
        if (fabsf(last_correction->moved_1) < largest_step_phase) {
            motions_motion_phase_x = motion_phase_x + (0.5f * last_correction->moved_1);
        } else {
            motions_motion_phase_x = 0.0f;
        }
        if (fabsf(last_correction->moved_2) < largest_step_phase) {
            motions_motion_phase_y = motion_phase_y + (0.5f * last_correction->moved_2);
        } else {
            motions_motion_phase_y = 0.0f;
        }
        if (fabsf(last_correction->moved_3) < largest_step_yaw) {
            motions_motion_yaw = motion_yaw + (0.5f * last_correction->moved_3);
        } else {
            motions_motion_yaw = 0.0f;
        }
    }
    return (hall_position_four_estimator_movement_t){.pose_phase_x = pose_phase_x, .pose_phase_y = pose_phase_y,
        .pose_yaw = pose_yaw, .pose_amplitude = pose_amplitude, .motions_motion_phase_x = motions_motion_phase_x,
        .motions_motion_phase_y = motions_motion_phase_y, .motions_motion_yaw = motions_motion_yaw};
}

/* level_phase_x */
HALL_POSITION_FOUR_LARGE float hall_position_four_estimator_level_phase_x(bool none, float moves_1_1, float gain_1,
    float moves_2_1, float gain_2, float moves_3_1, float gain_3, float moves_4_1, float gain_4, float moves_5_1,
    float gain_5, float moves_6_1, float gain_6, float moves_7_1, float gain_7, float moves_8_1, float gain_8,
    float deviation_phase_x_limited, bool plausible_4, bool plausible_3, bool plausible_2, bool plausible_1,
    float steps_1, float moved_1, float scores_1_times_gain_1, float scores_2_times_gain_2, float scores_3_times_gain_3,
    float scores_4_times_gain_4, float scores_5_times_gain_5, float scores_6_times_gain_6, float scores_7_times_gain_7,
    float scores_8_times_gain_8, float diagonal_1)
{
    /* V; channel_sigma times the root of the noncentrality: a fault that passes the test with risk 0.001 */
    static const float undetected = 0.40003738f;
    static const float level_sigmas = 3.4807565f; /* 1; sigmas of a protection level, half of risk 0.001 */
    static const float overbound = 1.25f; /* 1; factor on the protection levels while a group is excluded */
    static const float level_noise = 0.19147325f;               /* V; level_sigmas times channel_sigma */

    const float value_if_plausible_1 = (moves_1_1 * moves_1_1 * gain_1) + (moves_2_1 * moves_2_1 * gain_2);
    const float value_sum = (moves_3_1 * moves_3_1 * gain_3) + (moves_4_1 * moves_4_1 * gain_4);
    const float value_sum_2 = (moves_5_1 * moves_5_1 * gain_5) + (moves_6_1 * moves_6_1 * gain_6);
    const float value_sum_3 = (moves_7_1 * moves_7_1 * gain_7) + (moves_8_1 * moves_8_1 * gain_8);
    float value;
    if (none) {
        value = (undetected *
            sqrtf(hall_position_four_max(hall_position_four_max(hall_position_four_max(value_if_plausible_1, value_sum),
            value_sum_2), value_sum_3))) + (level_sigmas * deviation_phase_x_limited);
    } else {
        const float steps_1_minus_moved_1 = steps_1 - moved_1;
        float apart = 0.0f;
        float added = value_if_plausible_1;
        if (plausible_1) {
            apart = fabsf(steps_1_minus_moved_1 -
                ((moves_1_1 * scores_1_times_gain_1) + (moves_2_1 * scores_2_times_gain_2)));
        } else {
            added = 0.0f;
        }
        if (plausible_2) {
            apart = hall_position_four_max(apart, fabsf(steps_1_minus_moved_1 -
                ((moves_3_1 * scores_3_times_gain_3) + (moves_4_1 * scores_4_times_gain_4))));
            added = hall_position_four_max(added, value_sum);
        }
        if (plausible_3) {
            apart = hall_position_four_max(apart, fabsf(steps_1_minus_moved_1 -
                ((moves_5_1 * scores_5_times_gain_5) + (moves_6_1 * scores_6_times_gain_6))));
            added = hall_position_four_max(added, value_sum_2);
        }
        if (plausible_4) {
            apart = hall_position_four_max(apart, fabsf(steps_1_minus_moved_1 -
                ((moves_7_1 * scores_7_times_gain_7) + (moves_8_1 * scores_8_times_gain_8))));
            added = hall_position_four_max(added, value_sum_3);
        }
        value = overbound * (apart + (level_noise * sqrtf(diagonal_1 + added)));
    }
    return value;
}

/* level_phase_y */
HALL_POSITION_FOUR_LARGE float hall_position_four_estimator_level_phase_y(bool none, float minus_moves_1_2,
    float gain_1, float moves_2_2, float gain_2, float minus_moves_3_2, float gain_3, float moves_4_2, float gain_4,
    float minus_moves_5_2, float gain_5, float moves_6_2, float gain_6, float minus_moves_7_2, float gain_7,
    float moves_8_2, float gain_8, float deviation_phase_y_limited, bool plausible_4, bool plausible_3,
    bool plausible_2, bool plausible_1, float steps_2, float moved_2, float scores_2_times_gain_2,
    float scores_1_times_gain_1, float scores_4_times_gain_4, float scores_3_times_gain_3, float scores_6_times_gain_6,
    float scores_5_times_gain_5, float scores_8_times_gain_8, float scores_7_times_gain_7, float diagonal_2)
{
    /* V; channel_sigma times the root of the noncentrality: a fault that passes the test with risk 0.001 */
    static const float undetected = 0.40003738f;
    static const float level_sigmas = 3.4807565f; /* 1; sigmas of a protection level, half of risk 0.001 */
    static const float overbound = 1.25f; /* 1; factor on the protection levels while a group is excluded */
    static const float level_noise = 0.19147325f;               /* V; level_sigmas times channel_sigma */

    const float value_if_plausible_1 = (minus_moves_1_2 * minus_moves_1_2 * gain_1) + (moves_2_2 * moves_2_2 * gain_2);
    const float value_sum = (minus_moves_3_2 * minus_moves_3_2 * gain_3) + (moves_4_2 * moves_4_2 * gain_4);
    const float value_sum_2 = (minus_moves_5_2 * minus_moves_5_2 * gain_5) + (moves_6_2 * moves_6_2 * gain_6);
    const float value_sum_3 = (minus_moves_7_2 * minus_moves_7_2 * gain_7) + (moves_8_2 * moves_8_2 * gain_8);
    float value;
    if (none) {
        value = (undetected *
            sqrtf(hall_position_four_max(hall_position_four_max(hall_position_four_max(value_if_plausible_1, value_sum),
            value_sum_2), value_sum_3))) + (level_sigmas * deviation_phase_y_limited);
    } else {
        const float steps_2_minus_moved_2 = steps_2 - moved_2;
        float apart = 0.0f;
        float added = value_if_plausible_1;
        if (plausible_1) {
            apart = fabsf(steps_2_minus_moved_2 -
                ((moves_2_2 * scores_2_times_gain_2) - (minus_moves_1_2 * scores_1_times_gain_1)));
        } else {
            added = 0.0f;
        }
        if (plausible_2) {
            apart = hall_position_four_max(apart, fabsf(steps_2_minus_moved_2 -
                ((moves_4_2 * scores_4_times_gain_4) - (minus_moves_3_2 * scores_3_times_gain_3))));
            added = hall_position_four_max(added, value_sum);
        }
        if (plausible_3) {
            apart = hall_position_four_max(apart, fabsf(steps_2_minus_moved_2 -
                ((moves_6_2 * scores_6_times_gain_6) - (minus_moves_5_2 * scores_5_times_gain_5))));
            added = hall_position_four_max(added, value_sum_2);
        }
        if (plausible_4) {
            apart = hall_position_four_max(apart, fabsf(steps_2_minus_moved_2 -
                ((moves_8_2 * scores_8_times_gain_8) - (minus_moves_7_2 * scores_7_times_gain_7))));
            added = hall_position_four_max(added, value_sum_3);
        }
        value = overbound * (apart + (level_noise * sqrtf(diagonal_2 + added)));
    }
    return value;
}

/* level_yaw */
HALL_POSITION_FOUR_LARGE float hall_position_four_estimator_level_yaw(bool none, float moves_1_3, float gain_1,
    float minus_moves_2_3, float gain_2, float moves_3_3, float gain_3, float minus_moves_4_3, float gain_4,
    float moves_5_3, float gain_5, float minus_moves_6_3, float gain_6, float moves_7_3, float gain_7,
    float minus_moves_8_3, float gain_8, float deviation_yaw_limited, bool plausible_4, bool plausible_3,
    bool plausible_2, bool plausible_1, float steps_3, float moved_3, float scores_1_times_gain_1,
    float scores_2_times_gain_2, float scores_3_times_gain_3, float scores_4_times_gain_4, float scores_5_times_gain_5,
    float scores_6_times_gain_6, float scores_7_times_gain_7, float scores_8_times_gain_8, float diagonal_3)
{
    /* V; channel_sigma times the root of the noncentrality: a fault that passes the test with risk 0.001 */
    static const float undetected = 0.40003738f;
    static const float level_sigmas = 3.4807565f; /* 1; sigmas of a protection level, half of risk 0.001 */
    static const float overbound = 1.25f; /* 1; factor on the protection levels while a group is excluded */
    static const float level_noise = 0.19147325f;               /* V; level_sigmas times channel_sigma */

    const float level_if_plausible_1 = (moves_1_3 * moves_1_3 * gain_1) + (minus_moves_2_3 * minus_moves_2_3 * gain_2);
    const float level_sum = (moves_3_3 * moves_3_3 * gain_3) + (minus_moves_4_3 * minus_moves_4_3 * gain_4);
    const float level_sum_2 = (moves_5_3 * moves_5_3 * gain_5) + (minus_moves_6_3 * minus_moves_6_3 * gain_6);
    const float level_sum_3 = (moves_7_3 * moves_7_3 * gain_7) + (minus_moves_8_3 * minus_moves_8_3 * gain_8);
    float level;
    if (none) {
        level = (undetected *
            sqrtf(hall_position_four_max(hall_position_four_max(hall_position_four_max(level_if_plausible_1, level_sum),
            level_sum_2), level_sum_3))) + (level_sigmas * deviation_yaw_limited);
    } else {
        const float steps_3_minus_moved_3 = steps_3 - moved_3;
        float apart = 0.0f;
        float added = level_if_plausible_1;
        if (plausible_1) {
            apart = fabsf(steps_3_minus_moved_3 -
                ((moves_1_3 * scores_1_times_gain_1) - (minus_moves_2_3 * scores_2_times_gain_2)));
        } else {
            added = 0.0f;
        }
        if (plausible_2) {
            apart = hall_position_four_max(apart, fabsf(steps_3_minus_moved_3 -
                ((moves_3_3 * scores_3_times_gain_3) - (minus_moves_4_3 * scores_4_times_gain_4))));
            added = hall_position_four_max(added, level_sum);
        }
        if (plausible_3) {
            apart = hall_position_four_max(apart, fabsf(steps_3_minus_moved_3 -
                ((moves_5_3 * scores_5_times_gain_5) - (minus_moves_6_3 * scores_6_times_gain_6))));
            added = hall_position_four_max(added, level_sum_2);
        }
        if (plausible_4) {
            apart = hall_position_four_max(apart, fabsf(steps_3_minus_moved_3 -
                ((moves_7_3 * scores_7_times_gain_7) - (minus_moves_8_3 * scores_8_times_gain_8))));
            added = hall_position_four_max(added, level_sum_3);
        }
        level = overbound * (apart + (level_noise * sqrtf(diagonal_3 + added)));
    }
    return level;
}

typedef struct {
    float value_2;
    float value_3;
    float value_4;
    float excluded_next;
    float competing_next;
    bool value;
    bool value_5;
    bool plausible_1_next;
    bool plausible_2_next;
    bool plausible_3_next;
    bool plausible_4_next;
    bool doubted;
} hall_position_four_estimator_judgement_t;

/* judgement */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_judgement_t hall_position_four_estimator_judgement(bool in_range,
    float cost, float x_excluded, bool x_trial, const hall_position_four_estimator_separation_t *separation,
    const hall_position_four_estimator_deviations_t *deviations, uint32_t plausible_4, uint32_t plausible_3,
    uint32_t plausible_2, uint32_t plausible_1, const hall_position_four_estimator_last_correction_t *last_correction,
    bool x_certain, float x_track_excluded)
{
    static const float channel_variance = 0.003026f;            /* V^2; variance of a channel, from R */
    static const float test_threshold = 20.515005f; /* 1; chi-square of 5 degrees of freedom, false alarm 0.001 */
    /* 1; chi-square of 3 degrees of freedom, half of risk 0.001: without the excluded group */
    static const float hypothesis_threshold = 17.729996f;
    static const float hypothesis_cost = 0.053650968f;          /* V^2; hypothesis_threshold times channel_variance */
    static const float cancellation = 1e-05f;                   /* 1; relative error of a cost by rounding */
    /* rad; 100 times the limit: level that is reported at most; of x, y */
    static const float largest_level_phase = 61.842377f;
    static const float largest_level_yaw = 22.0f; /* rad; 100 times the limit: level that is reported at most */
    static const float limit_phase = 0.61842376f;               /* rad; of a valid protection level; of x, y */
    static const float limit_yaw = 0.22f;                       /* rad; of a valid protection level */
    static const float test_cost = 0.06207841f;                 /* V^2; test_threshold times channel_variance */
    /* V^2; 2 times hypothesis_cost: of a competing hypothesis that is refuted */
    static const float refuted_cost = 0.107301936f;

    const bool none = hall_position_four_equal(x_excluded, 0.0f);
    const bool decides = !x_trial;
    const float scores_7_times_gain_7 = separation->scores_7 * separation->gain_7;
    const float scores_8_times_gain_8 = separation->scores_8 * separation->gain_8;
    const float costs_4 = separation->full_cost -
        ((separation->scores_7 * scores_7_times_gain_7) + (separation->scores_8 * scores_8_times_gain_8));
    const float value_2_sum = hypothesis_cost + (cancellation * separation->full_cost);
    const bool value_2_test = hall_position_four_equal(x_excluded, 4.0f);
    const bool passing_4 = (costs_4 <= value_2_sum) || value_2_test;
    const bool plausible_4_2 = passing_4 || (plausible_4 != 0u);
    const float scores_5_times_gain_5 = separation->scores_5 * separation->gain_5;
    const float scores_6_times_gain_6 = separation->scores_6 * separation->gain_6;
    const float costs_3 = separation->full_cost -
        ((separation->scores_5 * scores_5_times_gain_5) + (separation->scores_6 * scores_6_times_gain_6));
    const bool value_2_test_2 = hall_position_four_equal(x_excluded, 3.0f);
    const bool passing_3 = (costs_3 <= value_2_sum) || value_2_test_2;
    const bool plausible_3_2 = passing_3 || (plausible_3 != 0u);
    const float scores_3_times_gain_3 = separation->scores_3 * separation->gain_3;
    const float scores_4_times_gain_4 = separation->scores_4 * separation->gain_4;
    const float costs_2 = separation->full_cost -
        ((separation->scores_3 * scores_3_times_gain_3) + (separation->scores_4 * scores_4_times_gain_4));
    const bool value_2_test_3 = hall_position_four_equal(x_excluded, 2.0f);
    const bool passing_2 = (costs_2 <= value_2_sum) || value_2_test_3;
    const bool plausible_2_2 = passing_2 || (plausible_2 != 0u);
    const float scores_1_times_gain_1 = separation->scores_1 * separation->gain_1;
    const float scores_2_times_gain_2 = separation->scores_2 * separation->gain_2;
    const float costs_1 = separation->full_cost -
        ((separation->scores_1 * scores_1_times_gain_1) + (separation->scores_2 * scores_2_times_gain_2));
    const bool value_2_test_4 = hall_position_four_equal(x_excluded, 1.0f);
    const bool passing_1 = (costs_1 <= value_2_sum) || value_2_test_4;
    const bool plausible_1_2 = passing_1 || (plausible_1 != 0u);
    float value_2_unlimited = largest_level_phase;
    float value_3_unlimited = largest_level_phase;
    float value_4_unlimited = largest_level_yaw;
    if (separation->detectable) {
        const float level_phase_x_value = hall_position_four_estimator_level_phase_x(none, separation->moves_1_1,
            separation->gain_1, separation->moves_2_1, separation->gain_2, separation->moves_3_1, separation->gain_3,
            separation->moves_4_1, separation->gain_4, separation->moves_5_1, separation->gain_5, separation->moves_6_1,
            separation->gain_6, separation->moves_7_1, separation->gain_7, separation->moves_8_1, separation->gain_8,
            deviations->value, plausible_4_2, plausible_3_2, plausible_2_2, plausible_1_2, separation->steps_1,
            last_correction->moved_1, scores_1_times_gain_1, scores_2_times_gain_2, scores_3_times_gain_3,
            scores_4_times_gain_4, scores_5_times_gain_5, scores_6_times_gain_6, scores_7_times_gain_7,
            scores_8_times_gain_8, separation->diagonal_1);
        value_2_unlimited = level_phase_x_value;
        const float level_phase_y_value = hall_position_four_estimator_level_phase_y(none, separation->minus_moves_1_2,
            separation->gain_1, separation->moves_2_2, separation->gain_2, separation->minus_moves_3_2,
            separation->gain_3, separation->moves_4_2, separation->gain_4, separation->minus_moves_5_2,
            separation->gain_5, separation->moves_6_2, separation->gain_6, separation->minus_moves_7_2,
            separation->gain_7, separation->moves_8_2, separation->gain_8, deviations->value_2, plausible_4_2,
            plausible_3_2, plausible_2_2, plausible_1_2, separation->steps_2, last_correction->moved_2,
            scores_2_times_gain_2, scores_1_times_gain_1, scores_4_times_gain_4, scores_3_times_gain_3,
            scores_6_times_gain_6, scores_5_times_gain_5, scores_8_times_gain_8, scores_7_times_gain_7,
            separation->diagonal_2);
        value_3_unlimited = level_phase_y_value;
        const float level_yaw_level = hall_position_four_estimator_level_yaw(none, separation->moves_1_3,
            separation->gain_1, separation->minus_moves_2_3, separation->gain_2, separation->moves_3_3,
            separation->gain_3, separation->minus_moves_4_3, separation->gain_4, separation->moves_5_3,
            separation->gain_5, separation->minus_moves_6_3, separation->gain_6, separation->moves_7_3,
            separation->gain_7, separation->minus_moves_8_3, separation->gain_8, deviations->value_3, plausible_4_2,
            plausible_3_2, plausible_2_2, plausible_1_2, separation->steps_3, last_correction->moved_3,
            scores_1_times_gain_1, scores_2_times_gain_2, scores_3_times_gain_3, scores_4_times_gain_4,
            scores_5_times_gain_5, scores_6_times_gain_6, scores_7_times_gain_7, scores_8_times_gain_8,
            separation->diagonal_3);
        value_4_unlimited = level_yaw_level;
    }
    const float value_2 = hall_position_four_min(value_2_unlimited, largest_level_phase);
    const float value_3 = hall_position_four_min(value_3_unlimited, largest_level_phase);
    const float value_4 = hall_position_four_min(value_4_unlimited, largest_level_yaw);
    const bool value_5 = separation->detectable && (value_2 <= limit_phase) && (value_3 <= limit_phase) &&
        (value_4 <= limit_yaw);
    float excluded_next_unlimited = x_track_excluded;
    bool plausible_1_next_test = plausible_1_2;
    bool plausible_2_next_test = plausible_2_2;
    bool plausible_3_next_test = plausible_3_2;
    bool plausible_4_next_test = plausible_4_2;
    if (x_trial) {
        const bool refuted = x_trial && (refuted_cost < cost);
        plausible_1_next_test = (plausible_1 != 0u) && !(refuted && value_2_test_4);
        plausible_2_next_test = (plausible_2 != 0u) && !(refuted && value_2_test_3);
        plausible_3_next_test = (plausible_3 != 0u) && !(refuted && value_2_test_2);
        plausible_4_next_test = (plausible_4 != 0u) && !(refuted && value_2_test);
    } else if (separation->full_cost <= test_cost) {
        excluded_next_unlimited = 0.0f;
    } else {
        const float costs_2_min_costs_1 = hall_position_four_min(costs_2, costs_1);
        if (costs_4 < hall_position_four_min(costs_3, costs_2_min_costs_1)) {
            excluded_next_unlimited = 4.0f;
        } else {
            excluded_next_unlimited = (costs_3 < costs_2_min_costs_1) ? 3.0f : ((costs_2 < costs_1) ? 2.0f : 1.0f);
        }
    }
    const float excluded_next = hall_position_four_max(excluded_next_unlimited, 0.0f);
    const bool uncertain = !(none || x_certain);
    const bool keeps = uncertain && (0.0f < excluded_next);
    const uint32_t competing_next_sum = hall_position_four_flag(plausible_1_2) + hall_position_four_flag(plausible_2_2)
        + hall_position_four_flag(plausible_3_2) + hall_position_four_flag(plausible_4_2);
    const bool contested = uncertain && (1u < competing_next_sum) && !value_5;
    float competing_next = 0.0f;
    if (keeps && contested && decides) {
        const float failing_3 = ((plausible_3 != 0u) && !passing_3) ? costs_3 : 0.0f;
        const float failing_2 = ((plausible_2 != 0u) && !passing_2) ? costs_2 : 0.0f;
        const float failing_1 = ((plausible_1 != 0u) && !passing_1) ? costs_1 : 0.0f;
        const float failing_2_max_failing_1 = hall_position_four_max(failing_2, failing_1);
        if (hall_position_four_max(failing_3, failing_2_max_failing_1) <
                (((plausible_4 != 0u) && !passing_4) ? costs_4 : 0.0f)) {
            competing_next = 4.0f;
        } else if (failing_2_max_failing_1 < failing_3) {
            competing_next = 3.0f;
        } else {
            competing_next = (failing_1 < failing_2) ? 2.0f : ((0.0f < failing_1) ? 1.0f : 0.0f);
        }
    }
    return (hall_position_four_estimator_judgement_t){.value_2 = value_2, .value_3 = value_3, .value_4 = value_4,
        .excluded_next = excluded_next, .competing_next = competing_next, .value = in_range &&
        (cost <= (channel_variance * ((none) ? test_threshold : hypothesis_threshold))) && decides, .value_5 = value_5,
        .plausible_1_next = keeps && plausible_1_next_test, .plausible_2_next = keeps && plausible_2_next_test,
        .plausible_3_next = keeps && plausible_3_next_test, .plausible_4_next = keeps && plausible_4_next_test,
        .doubted = x_trial || contested};
}

typedef struct {
    float begin_phase_x_next;
    float candidate_phase_x_next;
    float phase_x_next;
    float begin_phase_y_next;
    float candidate_phase_y_next;
    float phase_y_next;
    float begin_yaw_next;
    float candidate_yaw_next;
    float yaw_next;
    float candidate_amplitude_next;
    float amplitude_next;
    float age_next;
    float candidates_next;
    uint32_t start_number_next;
    uint32_t missed_next;
    bool missed_at_least_8;
    bool value;
} hall_position_four_estimator_search_t;

/* search */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_search_t hall_position_four_estimator_search(bool tracking,
    float begin_phase_x, bool below_decrease_tolerance, uint32_t age, float candidate_phase_x, uint32_t candidates,
    bool accepted, const hall_position_four_estimator_movement_t *movement, const
    hall_position_four_estimator_extrapolation_t *extrapolation, uint32_t start_number, float candidate_phase_y, float
    candidate_yaw, float begin_phase_y, float begin_yaw, float candidate_amplitude, float amplitude, uint32_t missed)
{
    static const uint32_t last_age = 3u;                        /* 1; samples since a start at which it ends */
    static const float pi = 3.1415927f;                         /* 1 */
    static const float increment_phase_x = 5.1470127f;          /* rad; from one start to the next: Roberts' sequence */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    static const uint32_t last_start = 23u;                     /* 1; number of the last start of a sweep */
    static const float agreement_phase = 0.15f; /* rad; solutions closer than this count as one; of x, y */
    static const float agreement_yaw = 0.05f;                   /* rad; solutions closer than this count as one */
    static const float increment_phase_y = 4.2162914f;          /* rad; from one start to the next: Roberts' sequence */
    static const float highest_yaw = 0.20943952f;               /* rad; end of its range */
    static const float increment_yaw = 0.230258f;               /* rad; from one start to the next: Roberts' sequence */
    static const float width_yaw = 0.41887903f;                 /* rad; width of its range */
    static const uint32_t starts = 24u;                         /* 1; of a sweep */
    static const uint32_t track_patience = 8u;                  /* 1; samples without a solution: lost */

    const bool missed_at_least_8 = track_patience <= missed;
    const bool value = !missed_at_least_8;
    float begin_phase_x_next = begin_phase_x;
    float candidate_phase_x_next = candidate_phase_x;
    float phase_x_next;
    float begin_phase_y_next = begin_phase_y;
    float candidate_phase_y_next = candidate_phase_y;
    float phase_y_next;
    float begin_yaw_next = begin_yaw;
    float candidate_yaw_next = candidate_yaw;
    float yaw_next;
    float candidate_amplitude_next = candidate_amplitude;
    float amplitude_next;
    float age_next = 0.0f;
    uint32_t start_number_next = starts;
    float candidates_next = 0.0f;
    uint32_t missed_next = 0u;
    if (tracking) {
        if (accepted) {
            phase_x_next = movement->pose_phase_x;
            phase_y_next = movement->pose_phase_y;
            yaw_next = movement->pose_yaw;
            amplitude_next = movement->pose_amplitude;
        } else {
            phase_x_next = extrapolation->predicted_phase_x;
            phase_y_next = extrapolation->predicted_phase_y;
            yaw_next = extrapolation->predicted_yaw;
            amplitude_next = amplitude;
        }
        missed_next = (accepted && value) ? 0u : ((missed_at_least_8) ? missed : (missed + 1u));
    } else {
        const bool ends = below_decrease_tolerance || (last_age <= age);
        float phase_x_next_choice = movement->pose_phase_x;
        float phase_y_next_choice = movement->pose_phase_y;
        float yaw_next_choice = movement->pose_yaw;
        float amplitude_next_choice = 1.0f;
        if (ends) {
            const float begin_phase_x_next_sum = begin_phase_x + increment_phase_x;
            if (pi < begin_phase_x_next_sum) {
                const float begin_phase_x_next_sum_2 = begin_phase_x_next_sum - two_pi;
                begin_phase_x_next = begin_phase_x_next_sum_2;
                phase_x_next_choice = begin_phase_x_next_sum_2;
            } else {
                begin_phase_x_next = begin_phase_x_next_sum;
                phase_x_next_choice = begin_phase_x_next_sum;
            }
            const float begin_phase_y_next_sum = begin_phase_y + increment_phase_y;
            if (pi < begin_phase_y_next_sum) {
                const float begin_phase_y_next_sum_2 = begin_phase_y_next_sum - two_pi;
                begin_phase_y_next = begin_phase_y_next_sum_2;
                phase_y_next_choice = begin_phase_y_next_sum_2;
            } else {
                begin_phase_y_next = begin_phase_y_next_sum;
                phase_y_next_choice = begin_phase_y_next_sum;
            }
            const float begin_yaw_plus_increment_yaw = begin_yaw + increment_yaw;
            if (highest_yaw < begin_yaw_plus_increment_yaw) {
                const float begin_yaw_next_sum = begin_yaw_plus_increment_yaw - width_yaw;
                begin_yaw_next = begin_yaw_next_sum;
                yaw_next_choice = begin_yaw_next_sum;
            } else {
                begin_yaw_next = begin_yaw_plus_increment_yaw;
                yaw_next_choice = begin_yaw_plus_increment_yaw;
            }
        } else {
            amplitude_next_choice = movement->pose_amplitude;
            const uint32_t age_next_sum = age + 1u;
            age_next = hall_position_four_min((float)age_next_sum, 3.0f);
        }
        const bool first = candidates == 0u;
        const bool solves = below_decrease_tolerance && accepted;
        float candidate_phase_x_2 = movement->pose_phase_x;
        float candidate_phase_y_2 = movement->pose_phase_y;
        float candidate_yaw_2 = movement->pose_yaw;
        float candidate_amplitude_2 = movement->pose_amplitude;
        if (!(first && solves)) {
            candidate_phase_x_2 = candidate_phase_x;
            candidate_phase_y_2 = candidate_phase_y;
            candidate_yaw_2 = candidate_yaw;
            candidate_amplitude_2 = candidate_amplitude;
        }
        candidate_phase_x_next = candidate_phase_x_2;
        const bool start_number_at_least_23 = last_start <= start_number;
        const bool last = ends && start_number_at_least_23;
        const float apart_phase_x = fabsf(movement->pose_phase_x - candidate_phase_x);
        const float apart_phase_y = fabsf(movement->pose_phase_y - candidate_phase_y);
        const float phase_x_next_sum = 2.0f - ((first || ((hall_position_four_min(apart_phase_x, fabsf(apart_phase_x -
            two_pi)) <= agreement_phase) && (hall_position_four_min(apart_phase_y, fabsf(apart_phase_y - two_pi)) <=
            agreement_phase) && (fabsf(movement->pose_yaw - candidate_yaw) <= agreement_yaw))) ? 1.0f : 0.0f);
        const float count = hall_position_four_max((float)candidates, (solves ? 1.0f : 0.0f) * phase_x_next_sum);
        const bool unique = last && hall_position_four_equal(count, 1.0f);
        if (unique) {
            phase_x_next = candidate_phase_x_2;
            phase_y_next = candidate_phase_y_2;
            yaw_next = candidate_yaw_2;
            amplitude_next = candidate_amplitude_2;
        } else {
            phase_x_next = phase_x_next_choice;
            phase_y_next = phase_y_next_choice;
            yaw_next = yaw_next_choice;
            amplitude_next = amplitude_next_choice;
            start_number_next = (last) ? 0u :
                ((start_number_at_least_23) ? last_start : (start_number + hall_position_four_flag(ends)));
        }
        candidate_phase_y_next = candidate_phase_y_2;
        candidate_yaw_next = candidate_yaw_2;
        candidate_amplitude_next = candidate_amplitude_2;
        candidates_next = (!last || unique) ? count : 0.0f;
    }
    return (hall_position_four_estimator_search_t){.begin_phase_x_next = begin_phase_x_next,
        .candidate_phase_x_next = candidate_phase_x_next, .phase_x_next = phase_x_next,
        .begin_phase_y_next = begin_phase_y_next, .candidate_phase_y_next = candidate_phase_y_next,
        .phase_y_next = phase_y_next, .begin_yaw_next = begin_yaw_next, .candidate_yaw_next = candidate_yaw_next,
        .yaw_next = yaw_next, .candidate_amplitude_next = candidate_amplitude_next, .amplitude_next = amplitude_next,
        .age_next = age_next, .candidates_next = candidates_next, .start_number_next = start_number_next,
        .missed_next = missed_next, .missed_at_least_8 = missed_at_least_8, .value = value};
}

typedef struct {
    float tracked_motion_phase_x;
    float tracked_motion_phase_y;
    float tracked_motion_yaw;
} hall_position_four_estimator_motion_t;

/* motion */
HALL_POSITION_FOUR_INLINE hall_position_four_estimator_motion_t hall_position_four_estimator_motion(bool tracking,
    bool accepted, const hall_position_four_estimator_movement_t *movement, float phase_x, float phase_y, float yaw)
{
    float tracked_motion_phase_x = 0.0f;
    float tracked_motion_phase_y = 0.0f;
    float tracked_motion_yaw = 0.0f;
    if (tracking) {
        if (accepted) {
            tracked_motion_phase_x = movement->motions_motion_phase_x;
            tracked_motion_phase_y = movement->motions_motion_phase_y;
            tracked_motion_yaw = movement->motions_motion_yaw;
        } else {
            tracked_motion_phase_x = phase_x;
            tracked_motion_phase_y = phase_y;
            tracked_motion_yaw = yaw;
        }
    }
    return (hall_position_four_estimator_motion_t){.tracked_motion_phase_x = tracked_motion_phase_x,
        .tracked_motion_phase_y = tracked_motion_phase_y, .tracked_motion_yaw = tracked_motion_yaw};
}

typedef struct {
    float excluded;
    float phase_x;
    float phase_y;
    float yaw;
    float amplitude;
    float deviation_phase_x;
    float deviation_phase_y;
    float deviation_yaw;
    float deviation_amplitude;
    float chi_square;
    float protection_phase_x;
    float protection_phase_y;
    float protection_yaw;
    bool converged;
    bool weak;
    bool tracking;
    bool lost;
    bool phases_valid;
    bool doubted;
} hall_position_four_estimator_t;

/* estimator: weighted least squares */
HALL_POSITION_FOUR_LARGE hall_position_four_estimator_t
    hall_position_four_estimator(hall_position_four_estimator_state_t *state, const hall_position_four_screen_t *screen,
    const hall_position_four_input_t *accepted, hall_position_four_diagnostics_t *diagnostics)
{
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    static const float inverse_channel_variance = 330.46927f;   /* 1/V^2; 1 / variance */
    static const float largest_chi_square = 1e+09f;             /* 1; weighted sum that is reported at most */
    static const uint32_t starts = 24u;                         /* 1; of a sweep */
    static const float largest_motion_phase = 0.5f;             /* rad; predicted change a sample at most; of x, y */
    static const float largest_motion_yaw = 0.1f;               /* rad; predicted change a sample at most */

    const float motion_phase_x = state->motion_phase_x;
    const float motion_phase_y = state->motion_phase_y;
    const float motion_yaw = state->motion_yaw;
    const hall_position_four_estimator_extrapolation_t extrapolation =
        hall_position_four_estimator_extrapolation(state->phase_x, motion_phase_x, state->phase_y, motion_phase_y,
        state->yaw, motion_yaw);
    const hall_position_four_estimator_prediction_t prediction =
        hall_position_four_estimator_prediction(&extrapolation);
    const uint32_t start_number = state->start_number;
    const bool tracking = starts <= start_number;
    const float amplitude = state->amplitude;
    const float amplitude_times_field_1 = amplitude * field_1;
    const float phase_x_product = 3.0f * (amplitude * field_3);
    const float amplitude_times_field_5 = amplitude * field_5;
    const hall_position_four_estimator_sensor_t sensor_1 = hall_position_four_estimator_sensor(&prediction,
        accepted->V_ax, accepted->V_ay, amplitude, prediction.ax_part_full, prediction.ay_part_full,
        prediction.phasor_ax_cosine, amplitude_times_field_1, phase_x_product, amplitude_times_field_5,
        prediction.ay_part_cosine_product, prediction.ay_part_cosine_product_2, prediction.phasor_ay_cosine);
    const hall_position_four_estimator_sensor_t sensor_2 = hall_position_four_estimator_sensor(&prediction,
        accepted->V_bx, accepted->V_by, amplitude, prediction.bx_part_full, prediction.by_part_full,
        prediction.phasor_bx_cosine, amplitude_times_field_1, phase_x_product, amplitude_times_field_5,
        prediction.by_part_cosine_product, prediction.by_part_cosine_product_2, prediction.phasor_by_cosine);
    const hall_position_four_estimator_sensor_t sensor_3 = hall_position_four_estimator_sensor(&prediction,
        accepted->V_cx, accepted->V_cy, amplitude, prediction.cx_part_full, prediction.cy_part_full,
        prediction.phasor_cx_cosine, amplitude_times_field_1, phase_x_product, amplitude_times_field_5,
        prediction.cy_part_cosine_product, prediction.cy_part_cosine_product_2, prediction.phasor_cy_cosine);
    const hall_position_four_estimator_sensor_4_t sensor_4 = hall_position_four_estimator_sensor_4(&prediction,
        accepted->V_dx, accepted->V_dy, amplitude, amplitude_times_field_1, phase_x_product, amplitude_times_field_5);
    const hall_position_four_estimator_factors_t factors = hall_position_four_estimator_factors(&sensor_1, &sensor_2,
        &sensor_3, &sensor_4, &prediction);
    const float offsets_4 = amplitude - 1.0f;
    const hall_position_four_estimator_normal_equations_t normal_equations =
        hall_position_four_estimator_normal_equations(&sensor_1, &sensor_2, &sensor_3, &sensor_4, offsets_4, &factors);
    const hall_position_four_estimator_separation_t separation = hall_position_four_estimator_separation(&sensor_1,
        &factors, &sensor_2, &sensor_3, &sensor_4, &normal_equations);
    const uint32_t competing = state->competing;
    const bool x_certain = 0.0f < screen->rejected;
    const bool x_trial = (competing != 0u) && !x_certain;
    const uint32_t excluded_2 = state->excluded;
    const float excluded = hall_position_four_max((x_certain) ? screen->rejected : (float)excluded_2, 0.0f);
    const float x_excluded = (x_trial) ? (float)competing : excluded;
    const bool none = x_excluded < 1.0f;
    const bool x_excluded_below_3 = x_excluded < 3.0f;
    const bool x_excluded_below_2 = x_excluded < 2.0f;
    const bool x_excluded_below_4 = x_excluded < 4.0f;
    const hall_position_four_estimator_removal_t removal = hall_position_four_estimator_removal(x_excluded_below_3,
        x_excluded_below_2, &separation, x_excluded_below_4);
    const hall_position_four_estimator_weights_t weights = hall_position_four_estimator_weights(none,
        x_excluded_below_3, x_excluded_below_2, x_excluded_below_4);
    const hall_position_four_estimator_iteration_1_t iteration_1 = hall_position_four_estimator_iteration_1(&separation,
        none, &removal, extrapolation.predicted_yaw, accepted->V_ax, accepted->V_ay, amplitude, &prediction,
        accepted->V_bx, accepted->V_by, accepted->V_cx, accepted->V_cy, accepted->V_dx, accepted->V_dy, &weights,
        offsets_4, &sensor_1, &sensor_2, &sensor_3, &sensor_4, &factors);
    const hall_position_four_estimator_last_correction_t last_correction =
        hall_position_four_estimator_last_correction(&iteration_1, &factors, none, &removal);
    const uint32_t age = state->age;
    const uint32_t candidates = state->candidates;
    const hall_position_four_estimator_deviations_t deviations = hall_position_four_estimator_deviations(&separation,
        none, &removal, &factors);
    const bool lost_test = screen->screened && !deviations.weak;
    const float cost = hall_position_four_max(iteration_1.value_2 - last_correction.value, 0.0f);
    const uint32_t plausible_4 = state->plausible_4;
    const uint32_t plausible_3 = state->plausible_3;
    const uint32_t plausible_2 = state->plausible_2;
    const uint32_t plausible_1 = state->plausible_1;
    const hall_position_four_estimator_judgement_t judgement = hall_position_four_estimator_judgement(factors.in_range,
        cost, x_excluded, x_trial, &separation, &deviations, plausible_4, plausible_3, plausible_2, plausible_1,
        &last_correction, x_certain, excluded);
    const bool accepted_2 = lost_test && judgement.value;
    const hall_position_four_estimator_movement_t movement = hall_position_four_estimator_movement(x_trial,
        &extrapolation, &last_correction, amplitude, motion_phase_x, motion_phase_y, motion_yaw);
    const uint32_t missed = state->missed;
    const hall_position_four_estimator_search_t search = hall_position_four_estimator_search(tracking,
        state->begin_phase_x, last_correction.below_decrease_tolerance, age, state->candidate_phase_x, candidates,
        accepted_2, &movement, &extrapolation, start_number, state->candidate_phase_y, state->candidate_yaw,
        state->begin_phase_y, state->begin_yaw, state->candidate_amplitude, amplitude, missed);
    state->phase_x = search.phase_x_next;
    state->phase_y = search.phase_y_next;
    state->yaw = search.yaw_next;
    state->amplitude = search.amplitude_next;
    const hall_position_four_estimator_motion_t motion = hall_position_four_estimator_motion(tracking, accepted_2,
        &movement, motion_phase_x, motion_phase_y, motion_yaw);
    state->motion_phase_x = hall_position_four_limit(motion.tracked_motion_phase_x, largest_motion_phase);
    state->motion_phase_y = hall_position_four_limit(motion.tracked_motion_phase_y, largest_motion_phase);
    state->motion_yaw = hall_position_four_limit(motion.tracked_motion_yaw, largest_motion_yaw);
    if (tracking) {
        state->excluded = (uint32_t)judgement.excluded_next;
        state->plausible_1 = hall_position_four_flag(judgement.plausible_1_next);
        state->plausible_2 = hall_position_four_flag(judgement.plausible_2_next);
        state->plausible_3 = hall_position_four_flag(judgement.plausible_3_next);
        state->plausible_4 = hall_position_four_flag(judgement.plausible_4_next);
        state->competing = (uint32_t)judgement.competing_next;
    } else {
        state->excluded = 0u;
        state->plausible_1 = 0u;
        state->plausible_2 = 0u;
        state->plausible_3 = 0u;
        state->plausible_4 = 0u;
        state->competing = 0u;
    }
    state->start_number = search.start_number_next;
    state->candidates = (uint32_t)search.candidates_next;
    state->missed = search.missed_next;
    state->age = (uint32_t)search.age_next;
    state->candidate_phase_x = search.candidate_phase_x_next;
    state->candidate_phase_y = search.candidate_phase_y_next;
    state->candidate_yaw = search.candidate_yaw_next;
    state->candidate_amplitude = search.candidate_amplitude_next;
    state->begin_phase_x = search.begin_phase_x_next;
    state->begin_phase_y = search.begin_phase_y_next;
    state->begin_yaw = search.begin_yaw_next;
    const bool phases_valid = last_correction.below_decrease_tolerance && lost_test && judgement.value &&
        judgement.value_5 && tracking && search.value;
    if (diagnostics != NULL) {
        diagnostics->deviation_phase_x = deviations.value;
        diagnostics->deviation_phase_y = deviations.value_2;
        diagnostics->phase_x = movement.pose_phase_x;
        diagnostics->phase_y = movement.pose_phase_y;
        diagnostics->protection_phase_x = judgement.value_2;
        diagnostics->protection_phase_y = judgement.value_3;
        diagnostics->phases_valid = phases_valid ? 1.0f : 0.0f;
    }
    return (hall_position_four_estimator_t){.excluded = excluded, .phase_x = movement.pose_phase_x,
        .phase_y = movement.pose_phase_y, .yaw = movement.pose_yaw, .amplitude = movement.pose_amplitude,
        .deviation_phase_x = deviations.value, .deviation_phase_y = deviations.value_2,
        .deviation_yaw = deviations.value_3, .deviation_amplitude = deviations.value_4,
        .chi_square = hall_position_four_min(inverse_channel_variance * cost, largest_chi_square), .protection_phase_x =
        judgement.value_2, .protection_phase_y = judgement.value_3, .protection_yaw = judgement.value_4,
        .converged = last_correction.below_decrease_tolerance, .weak = deviations.weak, .tracking = tracking,
        .lost = search.missed_at_least_8, .phases_valid = phases_valid, .doubted = judgement.doubted};
}

typedef struct {
    float X;
    float Y;
    float deviation_X;
    float deviation_Y;
    float protection_X;
    float protection_Y;
    bool valid;
} hall_position_four_metres_t;

/* metres */
HALL_POSITION_FOUR_INLINE hall_position_four_metres_t
    hall_position_four_metres(hall_position_four_metres_state_t *state, const hall_position_four_estimator_t *estimator)
{
    static const float length_per_phase = 0.008085071f;         /* m/rad; pitch / (2 pi) */
    static const float pitch = 0.0508f;                         /* m; of the magnet matrix */
    static const float most_pitches = 8.0f;                     /* 1; counted to either side */
    static const float pi = 3.1415927f;                         /* 1 */
    static const float end_of_count = 9.0f;                     /* 1; pitches at which counting stays */

    const float last_x = state->last_x;
    state->last_x = estimator->phase_x;
    const float last_y = state->last_y;
    state->last_y = estimator->phase_y;
    const uint32_t counting = state->counting;
    float X_choice = 0.0f;
    float Y_choice = 0.0f;
    float count_x = 0.0f;
    float count_y = 0.0f;
    if (estimator->tracking) {
        const float pitch_x = state->pitch_x;
        float X_if_tracking = pitch_x;
        if ((fabsf(pitch_x) <= most_pitches) && (counting != 0u)) {
            const float change_x = estimator->phase_x - last_x;
            float turned_x;
            if (change_x < -pi) {
                turned_x = pitch_x + 1.0f;
            } else if (pi < change_x) {
                turned_x = pitch_x - 1.0f;
            } else {
                turned_x = pitch_x;
            }
            X_if_tracking = hall_position_four_limit(turned_x, end_of_count);
        }
        X_choice = pitch * X_if_tracking;
        const float pitch_y = state->pitch_y;
        float Y_if_tracking = pitch_y;
        if ((fabsf(pitch_y) <= most_pitches) && (counting != 0u)) {
            const float change_y = estimator->phase_y - last_y;
            float turned_y;
            if (change_y < -pi) {
                turned_y = pitch_y + 1.0f;
            } else if (pi < change_y) {
                turned_y = pitch_y - 1.0f;
            } else {
                turned_y = pitch_y;
            }
            Y_if_tracking = hall_position_four_limit(turned_y, end_of_count);
        }
        Y_choice = pitch * Y_if_tracking;
        count_x = X_if_tracking;
        count_y = Y_if_tracking;
    }
    state->pitch_x = count_x;
    state->pitch_y = count_y;
    state->counting = hall_position_four_flag(estimator->tracking);
    return (hall_position_four_metres_t){.X = (length_per_phase * estimator->phase_x) + X_choice, .Y = (length_per_phase
        * estimator->phase_y) + Y_choice, .deviation_X = length_per_phase * estimator->deviation_phase_x,
        .deviation_Y = length_per_phase * estimator->deviation_phase_y, .protection_X = length_per_phase *
        estimator->protection_phase_x, .protection_Y = length_per_phase * estimator->protection_phase_y,
        .valid = estimator->phases_valid && (fabsf(count_x) <= most_pitches) && (fabsf(count_y) <= most_pitches)};
}

/* Each input in its range, else what is held or refused, with its bit of the fault word. */
HALL_POSITION_FOUR_INLINE hall_position_four_input_t hall_position_four_guard_inputs(hall_position_four_state_t *state,
    const hall_position_four_input_t *in, uint32_t *faults)
{
    hall_position_four_input_t accepted;
    accepted.V_ax = hall_position_four_hold_within(in->V_ax, 5.0f, &state->guard.last_V_ax, 0x00000001u, faults);
    accepted.V_ay = hall_position_four_hold_within(in->V_ay, 5.0f, &state->guard.last_V_ay, 0x00000002u, faults);
    accepted.V_bx = hall_position_four_hold_within(in->V_bx, 5.0f, &state->guard.last_V_bx, 0x00000004u, faults);
    accepted.V_by = hall_position_four_hold_within(in->V_by, 5.0f, &state->guard.last_V_by, 0x00000008u, faults);
    accepted.V_cx = hall_position_four_hold_within(in->V_cx, 5.0f, &state->guard.last_V_cx, 0x00000010u, faults);
    accepted.V_cy = hall_position_four_hold_within(in->V_cy, 5.0f, &state->guard.last_V_cy, 0x00000020u, faults);
    accepted.V_dx = hall_position_four_hold_within(in->V_dx, 5.0f, &state->guard.last_V_dx, 0x00000040u, faults);
    accepted.V_dy = hall_position_four_hold_within(in->V_dy, 5.0f, &state->guard.last_V_dy, 0x00000080u, faults);
    return accepted;
}

void hall_position_four_init(hall_position_four_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (hall_position_four_state_t){
        .guard = {.left = 5u},
        .estimator = {.amplitude = 1.0f, .candidate_amplitude = 1.0f},
    };
}

HALL_POSITION_FOUR_INLINE uint32_t hall_position_four_body(hall_position_four_state_t *state, const
    hall_position_four_input_t *in, hall_position_four_output_t *out, hall_position_four_diagnostics_t *diagnostics)
{
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
    }
    uint32_t faults = 0u;
    const hall_position_four_input_t accepted = hall_position_four_guard_inputs(state, in, &faults);
    const uint32_t guard_latched = state->guard.latched;
    const hall_position_four_guard_t guard = hall_position_four_guard(&state->guard, faults, guard_latched);
    const hall_position_four_screen_t screen = hall_position_four_screen(&state->screen, &guard, &accepted,
        diagnostics);
    uint32_t fault_word = faults;
    if (guard.latched != 0u) {
        state->guard.latched = 1u;
        fault_word = faults | 0x80000000u;
    }
    const hall_position_four_estimator_t estimator = hall_position_four_estimator(&state->estimator, &screen, &accepted,
        diagnostics);
    out->yaw = estimator.yaw;
    out->amplitude = estimator.amplitude;
    out->deviation_yaw = estimator.deviation_yaw;
    out->deviation_amplitude = estimator.deviation_amplitude;
    out->chi_square = estimator.chi_square;
    out->converged = estimator.converged ? 1.0f : 0.0f;
    out->weak = estimator.weak ? 1.0f : 0.0f;
    out->protection_yaw = estimator.protection_yaw;
    out->excluded = estimator.excluded;
    out->doubted = estimator.doubted ? 1.0f : 0.0f;
    const hall_position_four_metres_t metres = hall_position_four_metres(&state->metres, &estimator);
    out->tracking = estimator.tracking ? 1.0f : 0.0f;
    out->lost = estimator.lost ? 1.0f : 0.0f;
    out->X = metres.X;
    out->Y = metres.Y;
    out->deviation_X = metres.deviation_X;
    out->deviation_Y = metres.deviation_Y;
    out->protection_X = metres.protection_X;
    out->protection_Y = metres.protection_Y;
    out->valid = metres.valid ? 1.0f : 0.0f;

    if (diagnostics != NULL) {
        diagnostics->faults = fault_word;
        if ((diagnostics->latch_cause == 0u) && ((fault_word & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = fault_word;
        }
    }
    return fault_word;
}

uint32_t hall_position_four_step(hall_position_four_state_t *state, const hall_position_four_input_t *in,
    hall_position_four_output_t *out)
{
    return hall_position_four_body(state, in, out, NULL);
}

#if defined(HALL_POSITION_FOUR_DIAGNOSTICS)
uint32_t hall_position_four_step_diagnosed(hall_position_four_state_t *state, const hall_position_four_input_t *in,
    hall_position_four_output_t *out, hall_position_four_diagnostics_t *diagnostics)
{
    return hall_position_four_body(state, in, out, diagnostics);
}
#endif
