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
    static const float pi = 3.1415927f;                         /* 1 */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    static const float arm_a_x = 0.28902653f; /* rad; arm of sensor a along x, times 2 pi over the pitch */
    static const float highest_yaw = 0.20943952f;               /* rad; end of its range */
    static const float arm_a_y = -0.45238933f; /* rad; arm of sensor a along y, times 2 pi over the pitch */
    static const float field_1 = 2.24906f; /* V; alpha + 5 beta: of sin p in the field alpha sin p + beta sin 5p */
    static const float field_3 = 3.60456f; /* V; -20 beta: of sin^3 p in the field alpha sin p + beta sin 5p */
    static const float field_5 = -2.883648f; /* V; 16 beta: of sin^5 p in the field alpha sin p + beta sin 5p */
    static const float arm_b_x = -1.118407f; /* rad; arm of sensor b along x, times 2 pi over the pitch */
    static const float arm_b_y = -1.7404423f; /* rad; arm of sensor b along y, times 2 pi over the pitch */
    static const float arm_c_x = -2.506991f; /* rad; arm of sensor c along x, times 2 pi over the pitch */
    static const float arm_c_y = -3.0033627f; /* rad; arm of sensor c along y, times 2 pi over the pitch */
    static const float arm_d_x = 1.627345f; /* rad; arm of sensor d along x, times 2 pi over the pitch */
    static const float arm_d_y = 0.76654863f; /* rad; arm of sensor d along y, times 2 pi over the pitch */
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.25 rad, the largest; of x, y */
    static const float least_pivot_phase = 0.048416f;
    static const float largest_L_yaw_phase = 1250.0f;           /* 1; bound of L in row yaw; of x, y */
    /* V^2/rad^2; channel_variance / sigma^2, sigma = 0.1 rad, the largest */
    static const float least_pivot_yaw = 0.3026f;
    static const float largest_L_amplitude_phase = 625.0f;      /* rad; bound of L in row amplitude; of x, y */
    static const float largest_L_amplitude_yaw = 250.0f;        /* rad; bound of L in row amplitude */
    /* V^2; channel_variance / sigma^2, sigma = 0.06 of the prior */
    static const float prior_weight_amplitude = 0.84055555f;
    static const float least_pivot_amplitude = 0.07565f; /* V^2; channel_variance / sigma^2, sigma = 0.2, the largest */
    static const float least_separability = 0.001f;             /* 1; below it a fault looks like a motion */
    static const float largest_mixing = 31.622776f;             /* 1; bound of the factors of a group's separability */
    static const float largest_step_phase = 0.5f;               /* rad; correction of a sample at most; of x, y */
    static const float largest_step_yaw = 0.1f;                 /* rad; correction of a sample at most */
    static const float largest_step_amplitude = 0.125f;         /* 1; correction of a sample at most */
    static const float highest_amplitude = 1.25f;               /* 1; end of its range */
    static const float lowest_amplitude = 0.75f;                /* 1; end of its range */
    static const float largest_projection = 1845.4835f;         /* V; bound of |x_j'g|, which never acts */
    static const float channel_sigma = 0.05500909f;             /* V; deviation of a channel, from R */
    static const float largest_deviation_phase = 0.25f;         /* rad; largest sigma that is reported; of x, y */
    static const float largest_deviation_yaw = 0.1f;            /* rad; largest sigma that is reported */
    static const float largest_deviation_amplitude = 0.2f;      /* 1; largest sigma that is reported */
    static const float inverse_channel_variance = 330.46927f;   /* 1/V^2; 1 / variance */
    static const float largest_chi_square = 1e+09f;             /* 1; weighted sum that is reported at most */
    /* V^2; (0.1 channel_sigma)^2: a smaller predicted decrease has converged */
    static const float decrease_tolerance = 3.026e-05f;
    /* V^2/rad^2; a larger N_ii is not resolved: 500^2 times the least pivot; of x, y */
    static const float largest_information_phase = 12104.0f;
    /* V^2/rad^2; a larger N_ii is not resolved: 500^2 times the least pivot */
    static const float largest_information_yaw = 75650.0f;
    /* V^2; a larger N_ii is not resolved: 500^2 times the least pivot */
    static const float largest_information_amplitude = 18912.5f;
    /* rad^2/V^2; sigma^2 / channel_variance, sigma = 0.25 rad, less 1e-05 of it for rounding; of x, y */
    static const float weak_from_phase = 20.654123f;
    /* rad^2/V^2; sigma^2 / channel_variance, sigma = 0.1 rad, less 1e-05 of it for rounding */
    static const float weak_from_yaw = 3.3046596f;
    /* 1/V^2; sigma^2 / channel_variance, sigma = 0.2, less 1e-05 of it for rounding */
    static const float weak_from_amplitude = 13.218638f;
    /* 1; 1 / separability, less 1e-05 of it, of a fault that is detectable */
    static const float largest_gain = 999.99f;
    /* V; channel_sigma times the root of the noncentrality: a fault that passes the test with risk 0.001 */
    static const float undetected = 0.40003738f;
    static const float level_sigmas = 3.4807565f; /* 1; sigmas of a protection level, half of risk 0.001 */
    static const float overbound = 1.25f; /* 1; factor on the protection levels while a group is excluded */
    static const float hypothesis_cost = 0.053650968f;          /* V^2; hypothesis_threshold times channel_variance */
    static const float cancellation = 1e-05f;                   /* 1; relative error of a cost by rounding */
    static const float level_noise = 0.19147325f;               /* V; level_sigmas times channel_sigma */
    /* rad; 100 times the limit: level that is reported at most; of x, y */
    static const float largest_level_phase = 61.842377f;
    static const float largest_level_yaw = 22.0f; /* rad; 100 times the limit: level that is reported at most */
    static const uint32_t starts = 24u;                         /* 1; of a sweep */
    static const uint32_t track_patience = 8u;                  /* 1; samples without a solution: lost */
    static const float channel_variance = 0.003026f;            /* V^2; variance of a channel, from R */
    static const float test_threshold = 20.515005f; /* 1; chi-square of 5 degrees of freedom, false alarm 0.001 */
    /* 1; chi-square of 3 degrees of freedom, half of risk 0.001: without the excluded group */
    static const float hypothesis_threshold = 17.729996f;
    static const float limit_phase = 0.61842376f;               /* rad; of a valid protection level; of x, y */
    static const float limit_yaw = 0.22f;                       /* rad; of a valid protection level */
    static const uint32_t last_age = 3u;                        /* 1; samples since a start at which it ends */
    static const uint32_t last_start = 23u;                     /* 1; number of the last start of a sweep */
    static const float agreement_phase = 0.15f; /* rad; solutions closer than this count as one; of x, y */
    static const float agreement_yaw = 0.05f;                   /* rad; solutions closer than this count as one */
    static const float increment_phase_x = 5.1470127f;          /* rad; from one start to the next: Roberts' sequence */
    static const float increment_phase_y = 4.2162914f;          /* rad; from one start to the next: Roberts' sequence */
    static const float increment_yaw = 0.230258f;               /* rad; from one start to the next: Roberts' sequence */
    static const float width_yaw = 0.41887903f;                 /* rad; width of its range */
    static const float largest_motion_phase = 0.5f;             /* rad; predicted change a sample at most; of x, y */
    static const float largest_motion_yaw = 0.1f;               /* rad; predicted change a sample at most */
    static const float test_cost = 0.06207841f;                 /* V^2; test_threshold times channel_variance */
    /* V^2; 2 times hypothesis_cost: of a competing hypothesis that is refuted */
    static const float refuted_cost = 0.107301936f;

    const float motion_yaw = state->motion_yaw;
    const float predicted_yaw = hall_position_four_limit(state->yaw + motion_yaw, highest_yaw);
    const float cos_yaw_argument = predicted_yaw * predicted_yaw;
    const float cos_yaw = cosine_polynomial(cos_yaw_argument);
    const float sin_yaw = predicted_yaw * sine_polynomial(cos_yaw_argument);
    const float motion_phase_x = state->motion_phase_x;
    const float phase_x_plus_motion_phase_x = state->phase_x + motion_phase_x;
    float ax_part_cosine_choice = phase_x_plus_motion_phase_x;
    if (pi < phase_x_plus_motion_phase_x) {
        ax_part_cosine_choice = phase_x_plus_motion_phase_x - two_pi;
    }
    float predicted_phase_x = ax_part_cosine_choice;
    if (ax_part_cosine_choice < -pi) {
        predicted_phase_x = ax_part_cosine_choice + two_pi;
    }
    const float arm_a_x_times_cos_yaw = arm_a_x * cos_yaw;
    const float arm_a_y_times_sin_yaw = arm_a_y * sin_yaw;
    const float limited_ax = predicted_phase_x + arm_a_x_times_cos_yaw - arm_a_y_times_sin_yaw;
    const float ax_part_cosine_argument = limited_ax * limited_ax;
    const float sine_2 = limited_ax * sine_2_polynomial(ax_part_cosine_argument);
    const float ax_part_sine = 4.0f * sine_2;
    const float ax_part_cosine = part_cosine_polynomial(ax_part_cosine_argument);
    const float ax_part_doubled = 4.0f * (sine_2 * ax_part_cosine);
    /*@ admit -2.002f <= ax_part_doubled <= 2.002f; */
    const float ax_part_full = ax_part_doubled * (1.0f - (0.125f * (ax_part_sine * ax_part_sine)));
    /*@ admit -1.001f <= ax_part_full <= 1.001f; */
    const float motion_phase_y = state->motion_phase_y;
    const float phase_y_plus_motion_phase_y = state->phase_y + motion_phase_y;
    float ay_part_cosine_choice = phase_y_plus_motion_phase_y;
    if (pi < phase_y_plus_motion_phase_y) {
        ay_part_cosine_choice = phase_y_plus_motion_phase_y - two_pi;
    }
    float predicted_phase_y = ay_part_cosine_choice;
    if (ay_part_cosine_choice < -pi) {
        predicted_phase_y = ay_part_cosine_choice + two_pi;
    }
    const float arm_a_y_times_cos_yaw = -arm_a_y * cos_yaw;
    const float arm_a_x_times_sin_yaw = arm_a_x * sin_yaw;
    const float limited_ay = predicted_phase_y - arm_a_y_times_cos_yaw + arm_a_x_times_sin_yaw;
    const float ay_part_cosine_argument = limited_ay * limited_ay;
    const float sine_2_2 = limited_ay * sine_2_polynomial(ay_part_cosine_argument);
    const float ay_part_sine = 4.0f * sine_2_2;
    const float ay_part_cosine = part_cosine_polynomial(ay_part_cosine_argument);
    const float ay_part_doubled = 4.0f * (sine_2_2 * ay_part_cosine);
    /*@ admit -2.002f <= ay_part_doubled <= 2.002f; */
    const float ay_part_full = ay_part_doubled * (1.0f - (0.125f * (ay_part_sine * ay_part_sine)));
    /*@ admit -1.001f <= ay_part_full <= 1.001f; */
    const float arm_b_x_times_cos_yaw = arm_b_x * cos_yaw;
    const float arm_b_y_times_sin_yaw = -arm_b_y * sin_yaw;
    const float limited_bx = predicted_phase_x + arm_b_x_times_cos_yaw + arm_b_y_times_sin_yaw;
    const float bx_part_cosine_argument = limited_bx * limited_bx;
    const float sine_3 = limited_bx * sine_3_polynomial(bx_part_cosine_argument);
    const float bx_part_sine = 8.0f * sine_3;
    const float bx_part_cosine = part_cosine_2_polynomial(bx_part_cosine_argument);
    const float sine_3_times_bx_part_cosine = sine_3 * bx_part_cosine;
    const float bx_part_doubled = 8.0f *
        (sine_3_times_bx_part_cosine * (1.0f - (0.03125f * (bx_part_sine * bx_part_sine))));
    /*@ admit -2.002f <= bx_part_doubled <= 2.002f; */
    const float sines_bx_part_2 = 8.0f * sine_3_times_bx_part_cosine;
    const float bx_part_full = bx_part_doubled * (1.0f - (0.125f * (sines_bx_part_2 * sines_bx_part_2)));
    /*@ admit -1.001f <= bx_part_full <= 1.001f; */
    const float arm_b_y_times_cos_yaw = -arm_b_y * cos_yaw;
    const float arm_b_x_times_sin_yaw = arm_b_x * sin_yaw;
    const float limited_by = predicted_phase_y - arm_b_y_times_cos_yaw + arm_b_x_times_sin_yaw;
    const float by_part_cosine_argument = limited_by * limited_by;
    const float sine_3_2 = limited_by * sine_3_polynomial(by_part_cosine_argument);
    const float by_part_sine = 8.0f * sine_3_2;
    const float by_part_cosine = part_cosine_2_polynomial(by_part_cosine_argument);
    const float by_part_doubled_product = sine_3_2 * by_part_cosine;
    const float by_part_doubled = 8.0f *
        (by_part_doubled_product * (1.0f - (0.03125f * (by_part_sine * by_part_sine))));
    /*@ admit -2.002f <= by_part_doubled <= 2.002f; */
    const float sines_by_part_2 = 8.0f * by_part_doubled_product;
    const float by_part_full = by_part_doubled * (1.0f - (0.125f * (sines_by_part_2 * sines_by_part_2)));
    /*@ admit -1.001f <= by_part_full <= 1.001f; */
    const float arm_c_x_times_cos_yaw = arm_c_x * cos_yaw;
    const float arm_c_y_times_sin_yaw = -arm_c_y * sin_yaw;
    const float limited_cx = predicted_phase_x + arm_c_x_times_cos_yaw + arm_c_y_times_sin_yaw;
    const float cx_part_cosine_argument = limited_cx * limited_cx;
    const float sine_3_3 = limited_cx * sine_3_polynomial(cx_part_cosine_argument);
    const float cx_part_sine = 8.0f * sine_3_3;
    const float cx_part_cosine = part_cosine_2_polynomial(cx_part_cosine_argument);
    const float cx_part_doubled_product = sine_3_3 * cx_part_cosine;
    const float cx_part_doubled = 8.0f *
        (cx_part_doubled_product * (1.0f - (0.03125f * (cx_part_sine * cx_part_sine))));
    /*@ admit -2.002f <= cx_part_doubled <= 2.002f; */
    const float sines_cx_part_2 = 8.0f * cx_part_doubled_product;
    const float cx_part_full = cx_part_doubled * (1.0f - (0.125f * (sines_cx_part_2 * sines_cx_part_2)));
    /*@ admit -1.001f <= cx_part_full <= 1.001f; */
    const float arm_c_y_times_cos_yaw = -arm_c_y * cos_yaw;
    const float arm_c_x_times_sin_yaw = arm_c_x * sin_yaw;
    const float limited_cy = predicted_phase_y - arm_c_y_times_cos_yaw + arm_c_x_times_sin_yaw;
    const float cy_part_cosine_argument = limited_cy * limited_cy;
    const float sine_3_4 = limited_cy * sine_3_polynomial(cy_part_cosine_argument);
    const float cy_part_sine = 8.0f * sine_3_4;
    const float cy_part_cosine = part_cosine_2_polynomial(cy_part_cosine_argument);
    const float cy_part_doubled_product = sine_3_4 * cy_part_cosine;
    const float cy_part_doubled = 8.0f *
        (cy_part_doubled_product * (1.0f - (0.03125f * (cy_part_sine * cy_part_sine))));
    /*@ admit -2.002f <= cy_part_doubled <= 2.002f; */
    const float sines_cy_part_2 = 8.0f * cy_part_doubled_product;
    const float cy_part_full = cy_part_doubled * (1.0f - (0.125f * (sines_cy_part_2 * sines_cy_part_2)));
    /*@ admit -1.001f <= cy_part_full <= 1.001f; */
    const float arm_d_x_times_cos_yaw = arm_d_x * cos_yaw;
    const float arm_d_y_times_sin_yaw = arm_d_y * sin_yaw;
    const float limited_dx = predicted_phase_x + arm_d_x_times_cos_yaw - arm_d_y_times_sin_yaw;
    const float dx_part_cosine_argument = limited_dx * limited_dx;
    const float sine_3_5 = limited_dx * sine_3_polynomial(dx_part_cosine_argument);
    const float dx_part_sine = 8.0f * sine_3_5;
    const float dx_part_cosine = part_cosine_2_polynomial(dx_part_cosine_argument);
    const float dx_part_doubled_product = sine_3_5 * dx_part_cosine;
    const float dx_part_doubled = 8.0f *
        (dx_part_doubled_product * (1.0f - (0.03125f * (dx_part_sine * dx_part_sine))));
    /*@ admit -2.002f <= dx_part_doubled <= 2.002f; */
    const float sines_dx_part_2 = 8.0f * dx_part_doubled_product;
    const float dx_part_full = dx_part_doubled * (1.0f - (0.125f * (sines_dx_part_2 * sines_dx_part_2)));
    /*@ admit -1.001f <= dx_part_full <= 1.001f; */
    const float arm_d_x_times_sin_yaw = arm_d_x * sin_yaw;
    const float limited_dy = predicted_phase_y + (arm_d_y * cos_yaw) + arm_d_x_times_sin_yaw;
    const float dy_part_cosine_argument = limited_dy * limited_dy;
    const float sine_3_6 = limited_dy * sine_3_polynomial(dy_part_cosine_argument);
    const float dy_part_sine = 8.0f * sine_3_6;
    const float dy_part_cosine = part_cosine_2_polynomial(dy_part_cosine_argument);
    const float dy_part_doubled_product = sine_3_6 * dy_part_cosine;
    const float dy_part_doubled = 8.0f *
        (dy_part_doubled_product * (1.0f - (0.03125f * (dy_part_sine * dy_part_sine))));
    /*@ admit -2.002f <= dy_part_doubled <= 2.002f; */
    const float sines_dy_part_2 = 8.0f * dy_part_doubled_product;
    const float dy_part_full = dy_part_doubled * (1.0f - (0.125f * (sines_dy_part_2 * sines_dy_part_2)));
    /*@ admit -1.001f <= dy_part_full <= 1.001f; */
    const uint32_t start_number = state->start_number;
    const bool tracking = starts <= start_number;
    const float phasor_ax_cosine = 1.0f - (0.5f * (ax_part_doubled * ax_part_doubled));
    const float amplitude_2 = state->amplitude;
    const float amplitude_times_field_1 = amplitude_2 * field_1;
    const float ax_part_full_squared = ax_part_full * ax_part_full;
    const float phase_x_product = 3.0f * (amplitude_2 * field_3);
    const float amplitude_times_field_5 = amplitude_2 * field_5;
    const float rows_1_1 = phasor_ax_cosine * (amplitude_times_field_1 +
        (ax_part_full_squared * (phase_x_product + (5.0f * (ax_part_full_squared * amplitude_times_field_5)))));
    const float phasor_bx_cosine = 1.0f - (0.5f * (bx_part_doubled * bx_part_doubled));
    const float bx_part_full_squared = bx_part_full * bx_part_full;
    const float rows_3_1 = phasor_bx_cosine * (amplitude_times_field_1 +
        (bx_part_full_squared * (phase_x_product + (5.0f * (bx_part_full_squared * amplitude_times_field_5)))));
    const float phasor_cx_cosine = 1.0f - (0.5f * (cx_part_doubled * cx_part_doubled));
    const float cx_part_full_squared = cx_part_full * cx_part_full;
    const float rows_5_1 = phasor_cx_cosine * (amplitude_times_field_1 +
        (cx_part_full_squared * (phase_x_product + (5.0f * (cx_part_full_squared * amplitude_times_field_5)))));
    const float phasor_dx_cosine = 1.0f - (0.5f * (dx_part_doubled * dx_part_doubled));
    const float dx_part_full_squared = dx_part_full * dx_part_full;
    const float rows_7_1 = phasor_dx_cosine * (amplitude_times_field_1 +
        (dx_part_full_squared * (phase_x_product + (5.0f * (dx_part_full_squared * amplitude_times_field_5)))));
    const float left_1_1 = (rows_1_1 * rows_1_1) + (rows_3_1 * rows_3_1) + (rows_5_1 * rows_5_1) +
        (rows_7_1 * rows_7_1);
    const float phasor_ay_cosine = 1.0f - (0.5f * (ay_part_doubled * ay_part_doubled));
    const float ay_part_full_squared = ay_part_full * ay_part_full;
    const float rows_2_2 = phasor_ay_cosine * (amplitude_times_field_1 +
        (ay_part_full_squared * (phase_x_product + (5.0f * (ay_part_full_squared * amplitude_times_field_5)))));
    const float phasor_by_cosine = 1.0f - (0.5f * (by_part_doubled * by_part_doubled));
    const float by_part_full_squared = by_part_full * by_part_full;
    const float rows_4_2 = phasor_by_cosine * (amplitude_times_field_1 +
        (by_part_full_squared * (phase_x_product + (5.0f * (by_part_full_squared * amplitude_times_field_5)))));
    const float phasor_cy_cosine = 1.0f - (0.5f * (cy_part_doubled * cy_part_doubled));
    const float cy_part_full_squared = cy_part_full * cy_part_full;
    const float rows_6_2 = phasor_cy_cosine * (amplitude_times_field_1 +
        (cy_part_full_squared * (phase_x_product + (5.0f * (cy_part_full_squared * amplitude_times_field_5)))));
    const float phasor_dy_cosine = 1.0f - (0.5f * (dy_part_doubled * dy_part_doubled));
    const float dy_part_full_squared = dy_part_full * dy_part_full;
    const float rows_8_2 = phasor_dy_cosine * (amplitude_times_field_1 +
        (dy_part_full_squared * (phase_x_product + (5.0f * (dy_part_full_squared * amplitude_times_field_5)))));
    const float left_2_2 = (rows_2_2 * rows_2_2) + (rows_4_2 * rows_4_2) + (rows_6_2 * rows_6_2) +
        (rows_8_2 * rows_8_2);
    const float phase_x_sum = (cos_yaw * accepted->V_ay) + (sin_yaw * accepted->V_ax);
    const float rows_1_3 = phase_x_sum + (rows_1_1 * (arm_a_y_times_cos_yaw - arm_a_x_times_sin_yaw));
    const float phase_x_sum_2 = (cos_yaw * accepted->V_ax) - (sin_yaw * accepted->V_ay);
    const float minus_rows_2_3 = phase_x_sum_2 - (rows_2_2 * (arm_a_x_times_cos_yaw - arm_a_y_times_sin_yaw));
    const float phase_x_sum_3 = (cos_yaw * accepted->V_by) + (sin_yaw * accepted->V_bx);
    const float rows_3_3 = phase_x_sum_3 + (rows_3_1 * (arm_b_y_times_cos_yaw - arm_b_x_times_sin_yaw));
    const float phase_x_sum_4 = (cos_yaw * accepted->V_bx) - (sin_yaw * accepted->V_by);
    const float minus_rows_4_3 = phase_x_sum_4 - (rows_4_2 * (arm_b_y_times_sin_yaw + arm_b_x_times_cos_yaw));
    const float phase_x_sum_5 = (cos_yaw * accepted->V_cy) + (sin_yaw * accepted->V_cx);
    const float rows_5_3 = phase_x_sum_5 + (rows_5_1 * (arm_c_y_times_cos_yaw - arm_c_x_times_sin_yaw));
    const float phase_x_sum_6 = (cos_yaw * accepted->V_cx) - (sin_yaw * accepted->V_cy);
    const float minus_rows_6_3 = phase_x_sum_6 - (rows_6_2 * (arm_c_y_times_sin_yaw + arm_c_x_times_cos_yaw));
    const float phase_x_sum_7 = (cos_yaw * accepted->V_dy) + (sin_yaw * accepted->V_dx);
    const float rows_7_3 = phase_x_sum_7 + (rows_7_1 * ((-arm_d_y * cos_yaw) - arm_d_x_times_sin_yaw));
    const float phase_x_sum_8 = (cos_yaw * accepted->V_dx) - (sin_yaw * accepted->V_dy);
    const float minus_rows_8_3 = phase_x_sum_8 - (rows_8_2 * (arm_d_x_times_cos_yaw - arm_d_y_times_sin_yaw));
    const float left_3_3 = (rows_1_3 * rows_1_3) + (minus_rows_2_3 * minus_rows_2_3) + (rows_3_3 * rows_3_3) +
        (minus_rows_4_3 * minus_rows_4_3) + (rows_5_3 * rows_5_3) + (minus_rows_6_3 * minus_rows_6_3) +
        (rows_7_3 * rows_7_3) + (minus_rows_8_3 * minus_rows_8_3);
    const float rows_1_4 = ax_part_full * (field_1 +
        (ax_part_full_squared * (field_3 + (ax_part_full_squared * field_5))));
    const float rows_2_4 = ay_part_full * (field_1 +
        (ay_part_full_squared * (field_3 + (ay_part_full_squared * field_5))));
    const float rows_3_4 = bx_part_full * (field_1 +
        (bx_part_full_squared * (field_3 + (bx_part_full_squared * field_5))));
    const float rows_4_4 = by_part_full * (field_1 +
        (by_part_full_squared * (field_3 + (by_part_full_squared * field_5))));
    const float rows_5_4 = cx_part_full * (field_1 +
        (cx_part_full_squared * (field_3 + (cx_part_full_squared * field_5))));
    const float rows_6_4 = cy_part_full * (field_1 +
        (cy_part_full_squared * (field_3 + (cy_part_full_squared * field_5))));
    const float rows_7_4 = dx_part_full * (field_1 +
        (dx_part_full_squared * (field_3 + (dx_part_full_squared * field_5))));
    const float rows_8_4 = dy_part_full * (field_1 +
        (dy_part_full_squared * (field_3 + (dy_part_full_squared * field_5))));
    const float left_4_4 = (rows_1_4 * rows_1_4) + (rows_2_4 * rows_2_4) + (rows_3_4 * rows_3_4) +
        (rows_4_4 * rows_4_4) + (rows_5_4 * rows_5_4) + (rows_6_4 * rows_6_4) + (rows_7_4 * rows_7_4) +
        (rows_8_4 * rows_8_4) + prior_weight_amplitude;
    const bool in_range = (left_1_1 <= largest_information_phase) && (left_2_2 <= largest_information_phase) &&
        (left_3_3 <= largest_information_yaw) && (left_4_4 <= largest_information_amplitude);
    const float inverse_1 = 1.0f / hall_position_four_max(left_1_1, least_pivot_phase);
    const float left_3_1 = (rows_1_3 * rows_1_1) + (rows_3_3 * rows_3_1) + (rows_5_3 * rows_5_1) +
        (rows_7_3 * rows_7_1);
    const float lower_3_1 = hall_position_four_limit(left_3_1 * inverse_1, largest_L_yaw_phase);
    const float minus_left_3_2 = (minus_rows_2_3 * rows_2_2) + (minus_rows_4_3 * rows_4_2) +
        (minus_rows_6_3 * rows_6_2) + (minus_rows_8_3 * rows_8_2);
    const float inverse_2 = 1.0f / hall_position_four_max(left_2_2, least_pivot_phase);
    const float lower_3_2 = hall_position_four_limit(-(minus_left_3_2 * inverse_2), largest_L_yaw_phase);
    const float inverse_3 = 1.0f /
        hall_position_four_max(left_3_3 - (lower_3_1 * left_3_1) + (lower_3_2 * minus_left_3_2), least_pivot_yaw);
    const float left_4_1 = (rows_1_4 * rows_1_1) + (rows_3_4 * rows_3_1) + (rows_5_4 * rows_5_1) +
        (rows_7_4 * rows_7_1);
    const float lower_4_1 = hall_position_four_limit(left_4_1 * inverse_1, largest_L_amplitude_phase);
    const float left_4_2 = (rows_2_4 * rows_2_2) + (rows_4_4 * rows_4_2) + (rows_6_4 * rows_6_2) +
        (rows_8_4 * rows_8_2);
    const float lower_4_2 = hall_position_four_limit(left_4_2 * inverse_2, largest_L_amplitude_phase);
    const float left_4_3 = (rows_1_4 * rows_1_3) - (rows_2_4 * minus_rows_2_3) + (rows_3_4 * rows_3_3) -
        (rows_4_4 * minus_rows_4_3) + (rows_5_4 * rows_5_3) - (rows_6_4 * minus_rows_6_3) + (rows_7_4 * rows_7_3) -
        (rows_8_4 * minus_rows_8_3) - (lower_4_1 * left_3_1) + (lower_4_2 * minus_left_3_2);
    const float lower_4_3 = hall_position_four_limit(left_4_3 * inverse_3, largest_L_amplitude_yaw);
    const float deviation_phase_x_sum = lower_4_1 - (lower_4_3 * lower_3_1);
    const float diagonal_4 = 1.0f / hall_position_four_max(left_4_4 - (lower_4_1 * left_4_1) - (lower_4_2 * left_4_2) -
        (lower_4_3 * left_4_3), least_pivot_amplitude);
    const float diagonal_1 = inverse_1 + (lower_3_1 * lower_3_1 * inverse_3) +
        (deviation_phase_x_sum * deviation_phase_x_sum * diagonal_4);
    const uint32_t competing = state->competing;
    const bool x_certain = 0.0f < screen->rejected;
    const bool x_trial = (competing != 0u) && !x_certain;
    const uint32_t excluded_2 = state->excluded;
    const float excluded = hall_position_four_max((x_certain) ? screen->rejected : (float)excluded_2, 0.0f);
    const float residuals_1 = phase_x_sum_2 - (amplitude_2 * rows_1_4);
    const float residuals_2 = phase_x_sum - (amplitude_2 * rows_2_4);
    const float residuals_3 = phase_x_sum_4 - (amplitude_2 * rows_3_4);
    const float residuals_4 = phase_x_sum_3 - (amplitude_2 * rows_4_4);
    const float residuals_5 = phase_x_sum_6 - (amplitude_2 * rows_5_4);
    const float residuals_6 = phase_x_sum_5 - (amplitude_2 * rows_6_4);
    const float residuals_7 = phase_x_sum_8 - (amplitude_2 * rows_7_4);
    const float residuals_8 = phase_x_sum_7 - (amplitude_2 * rows_8_4);
    const float offsets_4 = amplitude_2 - 1.0f;
    const float forward_1 = (rows_1_1 * residuals_1) + (rows_3_1 * residuals_3) + (rows_5_1 * residuals_5) +
        (rows_7_1 * residuals_7);
    const float forward_1_times_inverse_1 = forward_1 * inverse_1;
    const float forward_2 = (rows_2_2 * residuals_2) + (rows_4_2 * residuals_4) + (rows_6_2 * residuals_6) +
        (rows_8_2 * residuals_8);
    const float forward_2_times_inverse_2 = forward_2 * inverse_2;
    const float forward_3 = (rows_1_3 * residuals_1) - (minus_rows_2_3 * residuals_2) + (rows_3_3 * residuals_3) -
        (minus_rows_4_3 * residuals_4) + (rows_5_3 * residuals_5) - (minus_rows_6_3 * residuals_6) +
        (rows_7_3 * residuals_7) - (minus_rows_8_3 * residuals_8) - (lower_3_1 * forward_1) - (lower_3_2 * forward_2);
    const float forward_3_times_inverse_3 = forward_3 * inverse_3;
    const float forward_4 = (rows_1_4 * residuals_1) + (rows_2_4 * residuals_2) + (rows_3_4 * residuals_3) +
        (rows_4_4 * residuals_4) + (rows_5_4 * residuals_5) + (rows_6_4 * residuals_6) + (rows_7_4 * residuals_7) +
        (rows_8_4 * residuals_8) - (prior_weight_amplitude * offsets_4) - (lower_4_1 * forward_1) -
        (lower_4_2 * forward_2) - (lower_4_3 * forward_3);
    const float steps_4 = forward_4 * diagonal_4;
    const float protection_phase_x_sum = (residuals_1 * residuals_1) + (residuals_2 * residuals_2) +
        (residuals_3 * residuals_3) + (residuals_4 * residuals_4) + (residuals_5 * residuals_5) +
        (residuals_6 * residuals_6) + (residuals_7 * residuals_7) + (residuals_8 * residuals_8) +
        (prior_weight_amplitude * (offsets_4 * offsets_4)) - ((forward_1 * forward_1_times_inverse_1) +
        (forward_2 * forward_2_times_inverse_2) + (forward_3 * forward_3_times_inverse_3) + (forward_4 * steps_4));
    const float full_cost = hall_position_four_max(protection_phase_x_sum, 0.0f);
    const float steps_3 = forward_3_times_inverse_3 - (lower_4_3 * steps_4);
    const float steps_1 = forward_1_times_inverse_1 - (lower_3_1 * steps_3) - (lower_4_1 * steps_4);
    const float scores_3 = residuals_3 - ((rows_3_1 * steps_1) + (rows_3_3 * steps_3) + (rows_3_4 * steps_4));
    const float weighted_3_1 = rows_3_1 * inverse_1;
    const float forward_3_3 = rows_3_3 - (lower_3_1 * rows_3_1);
    const float weighted_3_3 = forward_3_3 * inverse_3;
    const float forward_3_4 = rows_3_4 - (lower_4_1 * rows_3_1) - (lower_4_3 * forward_3_3);
    const float weighted_3_4 = forward_3_4 * diagonal_4;
    const float gain_3 = 1.0f / hall_position_four_max(1.0f -
        ((rows_3_1 * weighted_3_1) + (forward_3_3 * weighted_3_3) + (forward_3_4 * weighted_3_4)), least_separability);
    const float scores_3_times_gain_3 = scores_3 * gain_3;
    const float steps_2 = forward_2_times_inverse_2 - (lower_3_2 * steps_3) - (lower_4_2 * steps_4);
    const float minus_forward_4_3 = minus_rows_4_3 + (lower_3_2 * rows_4_2);
    const float forward_4_4 = rows_4_4 - (lower_4_2 * rows_4_2) + (lower_4_3 * minus_forward_4_3);
    const float weighted_4_4 = forward_4_4 * diagonal_4;
    const float minus_weighted_4_3 = minus_forward_4_3 * inverse_3;
    const float minus_left_2_1 = (weighted_4_4 * forward_3_4) - (minus_weighted_4_3 * forward_3_3);
    const float lower_2_1 = hall_position_four_limit(-(minus_left_2_1 * gain_3), largest_mixing);
    const float scores_4 = residuals_4 - ((rows_4_2 * steps_2) - (minus_rows_4_3 * steps_3) + (rows_4_4 * steps_4)) -
        (lower_2_1 * scores_3);
    const float weighted_4_2 = rows_4_2 * inverse_2;
    const float gain_4 = 1.0f / hall_position_four_max(1.0f - ((rows_4_2 * weighted_4_2) + (minus_forward_4_3 *
        minus_weighted_4_3) + (forward_4_4 * weighted_4_4)) + (lower_2_1 * minus_left_2_1), least_separability);
    const float scores_4_times_gain_4 = scores_4 * gain_4;
    const float costs_2 = full_cost - ((scores_3 * scores_3_times_gain_3) + (scores_4 * scores_4_times_gain_4));
    const float scores_1 = residuals_1 - ((rows_1_1 * steps_1) + (rows_1_3 * steps_3) + (rows_1_4 * steps_4));
    const float weighted_1_1 = rows_1_1 * inverse_1;
    const float forward_1_3 = rows_1_3 - (lower_3_1 * rows_1_1);
    const float weighted_1_3 = forward_1_3 * inverse_3;
    const float forward_1_4 = rows_1_4 - (lower_4_1 * rows_1_1) - (lower_4_3 * forward_1_3);
    const float weighted_1_4 = forward_1_4 * diagonal_4;
    const float gain_1 = 1.0f / hall_position_four_max(1.0f -
        ((rows_1_1 * weighted_1_1) + (forward_1_3 * weighted_1_3) + (forward_1_4 * weighted_1_4)), least_separability);
    const float scores_1_times_gain_1 = scores_1 * gain_1;
    const float minus_forward_2_3 = minus_rows_2_3 + (lower_3_2 * rows_2_2);
    const float forward_2_4 = rows_2_4 - (lower_4_2 * rows_2_2) + (lower_4_3 * minus_forward_2_3);
    const float weighted_2_4 = forward_2_4 * diagonal_4;
    const float minus_weighted_2_3 = minus_forward_2_3 * inverse_3;
    const float minus_left_2_1_2 = (weighted_2_4 * forward_1_4) - (minus_weighted_2_3 * forward_1_3);
    const float lower_2_1_2 = hall_position_four_limit(-(minus_left_2_1_2 * gain_1), largest_mixing);
    const float scores_2 = residuals_2 - ((rows_2_2 * steps_2) - (minus_rows_2_3 * steps_3) + (rows_2_4 * steps_4)) -
        (lower_2_1_2 * scores_1);
    const float weighted_2_2 = rows_2_2 * inverse_2;
    const float gain_2 = 1.0f / hall_position_four_max(1.0f - ((rows_2_2 * weighted_2_2) + (minus_forward_2_3 *
        minus_weighted_2_3) + (forward_2_4 * weighted_2_4)) + (lower_2_1_2 * minus_left_2_1_2), least_separability);
    const float scores_2_times_gain_2 = scores_2 * gain_2;
    const float costs_1 = full_cost - ((scores_1 * scores_1_times_gain_1) + (scores_2 * scores_2_times_gain_2));
    const float scores_5 = residuals_5 - ((rows_5_1 * steps_1) + (rows_5_3 * steps_3) + (rows_5_4 * steps_4));
    const float weighted_5_1 = rows_5_1 * inverse_1;
    const float forward_5_3 = rows_5_3 - (lower_3_1 * rows_5_1);
    const float weighted_5_3 = forward_5_3 * inverse_3;
    const float forward_5_4 = rows_5_4 - (lower_4_1 * rows_5_1) - (lower_4_3 * forward_5_3);
    const float weighted_5_4 = forward_5_4 * diagonal_4;
    const float gain_5 = 1.0f / hall_position_four_max(1.0f -
        ((rows_5_1 * weighted_5_1) + (forward_5_3 * weighted_5_3) + (forward_5_4 * weighted_5_4)), least_separability);
    const float scores_5_times_gain_5 = scores_5 * gain_5;
    const float minus_forward_6_3 = minus_rows_6_3 + (lower_3_2 * rows_6_2);
    const float forward_6_4 = rows_6_4 - (lower_4_2 * rows_6_2) + (lower_4_3 * minus_forward_6_3);
    const float weighted_6_4 = forward_6_4 * diagonal_4;
    const float minus_weighted_6_3 = minus_forward_6_3 * inverse_3;
    const float minus_left_2_1_3 = (weighted_6_4 * forward_5_4) - (minus_weighted_6_3 * forward_5_3);
    const float lower_2_1_3 = hall_position_four_limit(-(minus_left_2_1_3 * gain_5), largest_mixing);
    const float scores_6 = residuals_6 - ((rows_6_2 * steps_2) - (minus_rows_6_3 * steps_3) + (rows_6_4 * steps_4)) -
        (lower_2_1_3 * scores_5);
    const float weighted_6_2 = rows_6_2 * inverse_2;
    const float gain_6 = 1.0f / hall_position_four_max(1.0f - ((rows_6_2 * weighted_6_2) + (minus_forward_6_3 *
        minus_weighted_6_3) + (forward_6_4 * weighted_6_4)) + (lower_2_1_3 * minus_left_2_1_3), least_separability);
    const float scores_6_times_gain_6 = scores_6 * gain_6;
    const float costs_3 = full_cost - ((scores_5 * scores_5_times_gain_5) + (scores_6 * scores_6_times_gain_6));
    const float scores_7 = residuals_7 - ((rows_7_1 * steps_1) + (rows_7_3 * steps_3) + (rows_7_4 * steps_4));
    const float weighted_7_1 = rows_7_1 * inverse_1;
    const float forward_7_3 = rows_7_3 - (lower_3_1 * rows_7_1);
    const float weighted_7_3 = forward_7_3 * inverse_3;
    const float forward_7_4 = rows_7_4 - (lower_4_1 * rows_7_1) - (lower_4_3 * forward_7_3);
    const float weighted_7_4 = forward_7_4 * diagonal_4;
    const float gain_7 = 1.0f / hall_position_four_max(1.0f -
        ((rows_7_1 * weighted_7_1) + (forward_7_3 * weighted_7_3) + (forward_7_4 * weighted_7_4)), least_separability);
    const float scores_7_times_gain_7 = scores_7 * gain_7;
    const float minus_forward_8_3 = minus_rows_8_3 + (lower_3_2 * rows_8_2);
    const float forward_8_4 = rows_8_4 - (lower_4_2 * rows_8_2) + (lower_4_3 * minus_forward_8_3);
    const float weighted_8_4 = forward_8_4 * diagonal_4;
    const float minus_weighted_8_3 = minus_forward_8_3 * inverse_3;
    const float minus_left_2_1_4 = (weighted_8_4 * forward_7_4) - (minus_weighted_8_3 * forward_7_3);
    const float lower_2_1_4 = hall_position_four_limit(-(minus_left_2_1_4 * gain_7), largest_mixing);
    const float scores_8 = residuals_8 - ((rows_8_2 * steps_2) - (minus_rows_8_3 * steps_3) + (rows_8_4 * steps_4)) -
        (lower_2_1_4 * scores_7);
    const float weighted_8_2 = rows_8_2 * inverse_2;
    const float gain_8 = 1.0f / hall_position_four_max(1.0f - ((rows_8_2 * weighted_8_2) + (minus_forward_8_3 *
        minus_weighted_8_3) + (forward_8_4 * weighted_8_4)) + (lower_2_1_4 * minus_left_2_1_4), least_separability);
    const float scores_8_times_gain_8 = scores_8 * gain_8;
    const float costs_4 = full_cost - ((scores_7 * scores_7_times_gain_7) + (scores_8 * scores_8_times_gain_8));
    float x_excluded = (float)competing;
    float excluded_choice = excluded;
    if (!x_trial) {
        x_excluded = excluded;
        if (full_cost <= test_cost) {
            excluded_choice = 0.0f;
        } else {
            const float costs_2_min_costs_1 = hall_position_four_min(costs_2, costs_1);
            if (costs_4 < hall_position_four_min(costs_3, costs_2_min_costs_1)) {
                excluded_choice = 4.0f;
            } else {
                excluded_choice = (costs_3 < costs_2_min_costs_1) ? 3.0f : ((costs_2 < costs_1) ? 2.0f : 1.0f);
            }
        }
    }
    const bool none = x_excluded < 1.0f;
    const float moves_1_3 = weighted_1_3 - (lower_4_3 * weighted_1_4);
    const float moves_1_1 = weighted_1_1 - (lower_3_1 * moves_1_3) - (lower_4_1 * weighted_1_4);
    const float minus_step = minus_weighted_2_3 + (lower_4_3 * weighted_2_4);
    const float moves_2_1 = (lower_3_1 * minus_step) - (lower_4_1 * weighted_2_4) - (lower_2_1_2 * moves_1_1);
    const float minus_moves_2_3 = minus_step + (lower_2_1_2 * moves_1_3);
    const float minus_moves_1_2 = (lower_3_2 * moves_1_3) + (lower_4_2 * weighted_1_4);
    const float moves_2_2 = weighted_2_2 + (lower_3_2 * minus_step) - (lower_4_2 * weighted_2_4) +
        (lower_2_1_2 * minus_moves_1_2);
    const float moves_3_3 = weighted_3_3 - (lower_4_3 * weighted_3_4);
    const float moves_3_1 = weighted_3_1 - (lower_3_1 * moves_3_3) - (lower_4_1 * weighted_3_4);
    const float minus_step_2 = minus_weighted_4_3 + (lower_4_3 * weighted_4_4);
    const float moves_4_1 = (lower_3_1 * minus_step_2) - (lower_4_1 * weighted_4_4) - (lower_2_1 * moves_3_1);
    const float minus_moves_4_3 = minus_step_2 + (lower_2_1 * moves_3_3);
    const float minus_moves_3_2 = (lower_3_2 * moves_3_3) + (lower_4_2 * weighted_3_4);
    const float moves_4_2 = weighted_4_2 + (lower_3_2 * minus_step_2) - (lower_4_2 * weighted_4_4) +
        (lower_2_1 * minus_moves_3_2);
    const float moves_5_3 = weighted_5_3 - (lower_4_3 * weighted_5_4);
    const float moves_5_1 = weighted_5_1 - (lower_3_1 * moves_5_3) - (lower_4_1 * weighted_5_4);
    const float minus_step_3 = minus_weighted_6_3 + (lower_4_3 * weighted_6_4);
    const float moves_6_1 = (lower_3_1 * minus_step_3) - (lower_4_1 * weighted_6_4) - (lower_2_1_3 * moves_5_1);
    const float minus_moves_6_3 = minus_step_3 + (lower_2_1_3 * moves_5_3);
    const float minus_moves_5_2 = (lower_3_2 * moves_5_3) + (lower_4_2 * weighted_5_4);
    const float moves_6_2 = weighted_6_2 + (lower_3_2 * minus_step_3) - (lower_4_2 * weighted_6_4) +
        (lower_2_1_3 * minus_moves_5_2);
    const float moves_7_3 = weighted_7_3 - (lower_4_3 * weighted_7_4);
    const float moves_7_1 = weighted_7_1 - (lower_3_1 * moves_7_3) - (lower_4_1 * weighted_7_4);
    const float minus_step_4 = minus_weighted_8_3 + (lower_4_3 * weighted_8_4);
    const float moves_8_1 = (lower_3_1 * minus_step_4) - (lower_4_1 * weighted_8_4) - (lower_2_1_4 * moves_7_1);
    const float minus_moves_8_3 = minus_step_4 + (lower_2_1_4 * moves_7_3);
    const float minus_moves_7_2 = (lower_3_2 * moves_7_3) + (lower_4_2 * weighted_7_4);
    const float moves_8_2 = weighted_8_2 + (lower_3_2 * minus_step_4) - (lower_4_2 * weighted_8_4) +
        (lower_2_1_4 * minus_moves_7_2);
    float move_excluded_1_1;
    float gain_excluded_1;
    float scores_1_2;
    float move_excluded_2_1;
    float gain_excluded_2;
    float scores_2_2;
    bool phase_x_if_not_none = true;
    float move_excluded_1_3;
    float move_excluded_2_3;
    float move_excluded_1_4;
    float move_excluded_2_4;
    bool phase_x_if_not_none_2 = true;
    bool phase_x_if_not_none_3 = true;
    bool phase_x_if_not_none_4 = true;
    float move_excluded_1_2;
    float move_excluded_2_2;
    if (x_excluded < 3.0f) {
        const bool x_excluded_below_2 = x_excluded < 2.0f;
        if (x_excluded_below_2) {
            move_excluded_1_1 = moves_1_1;
            gain_excluded_1 = gain_1;
            scores_1_2 = scores_1;
            move_excluded_2_1 = moves_2_1;
            gain_excluded_2 = gain_2;
            scores_2_2 = scores_2;
            phase_x_if_not_none = false;
            move_excluded_1_3 = moves_1_3;
            move_excluded_2_3 = -minus_moves_2_3;
            move_excluded_1_4 = weighted_1_4;
            move_excluded_2_4 = weighted_2_4 - (lower_2_1_2 * weighted_1_4);
            move_excluded_1_2 = -minus_moves_1_2;
            move_excluded_2_2 = moves_2_2;
        } else {
            move_excluded_1_1 = moves_3_1;
            gain_excluded_1 = gain_3;
            scores_1_2 = scores_3;
            move_excluded_2_1 = moves_4_1;
            gain_excluded_2 = gain_4;
            scores_2_2 = scores_4;
            move_excluded_1_3 = moves_3_3;
            move_excluded_2_3 = -minus_moves_4_3;
            move_excluded_1_4 = weighted_3_4;
            move_excluded_2_4 = weighted_4_4 - (lower_2_1 * weighted_3_4);
            move_excluded_1_2 = -minus_moves_3_2;
            move_excluded_2_2 = moves_4_2;
        }
        phase_x_if_not_none_2 = x_excluded_below_2;
    } else {
        const bool x_excluded_below_4 = x_excluded < 4.0f;
        if (x_excluded_below_4) {
            move_excluded_1_1 = moves_5_1;
            gain_excluded_1 = gain_5;
            scores_1_2 = scores_5;
            move_excluded_2_1 = moves_6_1;
            gain_excluded_2 = gain_6;
            scores_2_2 = scores_6;
            move_excluded_1_3 = moves_5_3;
            move_excluded_2_3 = -minus_moves_6_3;
            move_excluded_1_4 = weighted_5_4;
            move_excluded_2_4 = weighted_6_4 - (lower_2_1_3 * weighted_5_4);
            phase_x_if_not_none_3 = false;
            move_excluded_1_2 = -minus_moves_5_2;
            move_excluded_2_2 = moves_6_2;
        } else {
            move_excluded_1_1 = moves_7_1;
            gain_excluded_1 = gain_7;
            scores_1_2 = scores_7;
            move_excluded_2_1 = moves_8_1;
            gain_excluded_2 = gain_8;
            scores_2_2 = scores_8;
            move_excluded_1_3 = moves_7_3;
            move_excluded_2_3 = -minus_moves_8_3;
            move_excluded_1_4 = weighted_7_4;
            move_excluded_2_4 = weighted_8_4 - (lower_2_1_4 * weighted_7_4);
            move_excluded_1_2 = -minus_moves_7_2;
            move_excluded_2_2 = moves_8_2;
        }
        phase_x_if_not_none_4 = x_excluded_below_4;
    }
    float added_1 = 0.0f;
    bool weights_2 = true;
    float added_3 = 0.0f;
    float added_4 = 0.0f;
    bool weights_4 = true;
    bool weights_6 = true;
    bool weights_8 = true;
    float added_2 = 0.0f;
    float deviation_phase_x_choice = 0.0f;
    float deviation_phase_y_choice = 0.0f;
    float deviation_yaw_choice = 0.0f;
    float deviation_amplitude_choice = 0.0f;
    if (!none) {
        const float phase_x_product_2 = gain_excluded_1 * scores_1_2;
        const float phase_x_product_3 = gain_excluded_2 * scores_2_2;
        added_1 = -((move_excluded_1_1 * phase_x_product_2) + (move_excluded_2_1 * phase_x_product_3));
        weights_2 = phase_x_if_not_none;
        added_3 = -((move_excluded_1_3 * phase_x_product_2) + (move_excluded_2_3 * phase_x_product_3));
        added_4 = -((move_excluded_1_4 * phase_x_product_2) + (move_excluded_2_4 * phase_x_product_3));
        weights_4 = phase_x_if_not_none_2;
        weights_6 = phase_x_if_not_none_3;
        weights_8 = phase_x_if_not_none_4;
        added_2 = -((move_excluded_1_2 * phase_x_product_2) + (move_excluded_2_2 * phase_x_product_3));
        deviation_phase_x_choice = (gain_excluded_1 * (move_excluded_1_1 * move_excluded_1_1)) +
            (gain_excluded_2 * (move_excluded_2_1 * move_excluded_2_1));
        deviation_phase_y_choice = (gain_excluded_1 * (move_excluded_1_2 * move_excluded_1_2)) +
            (gain_excluded_2 * (move_excluded_2_2 * move_excluded_2_2));
        deviation_yaw_choice = (gain_excluded_1 * (move_excluded_1_3 * move_excluded_1_3)) +
            (gain_excluded_2 * (move_excluded_2_3 * move_excluded_2_3));
        deviation_amplitude_choice = (gain_excluded_1 * (move_excluded_1_4 * move_excluded_1_4)) +
            (gain_excluded_2 * (move_excluded_2_4 * move_excluded_2_4));
    }
    const float variance_phase_x = diagonal_1 + deviation_phase_x_choice;
    const float deviation_phase_y_sum = lower_4_2 - (lower_4_3 * lower_3_2);
    const float diagonal_2 = inverse_2 + (lower_3_2 * lower_3_2 * inverse_3) +
        (deviation_phase_y_sum * deviation_phase_y_sum * diagonal_4);
    const float variance_phase_y = diagonal_2 + deviation_phase_y_choice;
    const float diagonal_3 = inverse_3 + (lower_4_3 * lower_4_3 * diagonal_4);
    const float variance_yaw = diagonal_3 + deviation_yaw_choice;
    const float variance_amplitude = diagonal_4 + deviation_amplitude_choice;
    const bool weak = !in_range || (weak_from_phase <= variance_phase_x) || (weak_from_phase <= variance_phase_y) ||
        (weak_from_yaw <= variance_yaw) || (weak_from_amplitude <= variance_amplitude);
    const bool phases_valid_test = screen->screened && !weak;
    const float offsets_3 = hall_position_four_limit(steps_3 + added_3, largest_step_yaw);
    const float moved_yaw = hall_position_four_limit(predicted_yaw + offsets_3, highest_yaw);
    const float cosine_argument = moved_yaw * moved_yaw;
    const float turn_yaw_cosine = cosine_polynomial(cosine_argument);
    const float turn_yaw_sine = moved_yaw * sine_polynomial(cosine_argument);
    const float chord_yaw_cosine = turn_yaw_cosine - cos_yaw;
    const float offsets_1 = hall_position_four_limit(steps_1 + added_1, largest_step_phase);
    const float limited_yaw_sine = hall_position_four_limit(turn_yaw_sine - sin_yaw, largest_step_yaw);
    const float phase_x_change = hall_position_four_limit(steps_4 + added_4, largest_step_amplitude);
    const float phase_x_limited = hall_position_four_max(hall_position_four_min(amplitude_2 + phase_x_change,
        highest_amplitude), lowest_amplitude);
    const float offsets_2 = hall_position_four_limit(steps_2 + added_2, largest_step_phase);
    float phase_x_choice = 0.0f;
    float phase_x_choice_2 = 0.0f;
    float phase_x_choice_3 = 0.0f;
    float phase_x_choice_4 = 0.0f;
    float chi_square_choice = 0.0f;
    if (weights_2) {
        const float by_ax = offsets_1 + (arm_a_x * chord_yaw_cosine) - (arm_a_y * limited_yaw_sine);
        const float cosine_2_argument = by_ax * by_ax;
        const float phasor_ax_sine = (ax_part_full * cosine_2_polynomial(cosine_2_argument)) +
            (phasor_ax_cosine * (by_ax * sine_4_polynomial(cosine_2_argument)));
        const float phasor_ax_sine_squared = phasor_ax_sine * phasor_ax_sine;
        const float residuals_1_2 = (turn_yaw_cosine * accepted->V_ax) - (turn_yaw_sine * accepted->V_ay) -
            (phase_x_limited *
            (phasor_ax_sine * (field_1 + (phasor_ax_sine_squared * (field_3 + (phasor_ax_sine_squared * field_5))))));
        phase_x_choice = rows_1_1 * residuals_1_2;
        const float by_ay = offsets_2 + (arm_a_y * chord_yaw_cosine) + (arm_a_x * limited_yaw_sine);
        const float cosine_2_argument_2 = by_ay * by_ay;
        const float phasor_ay_sine = (ay_part_full * cosine_2_polynomial(cosine_2_argument_2)) +
            (phasor_ay_cosine * (by_ay * sine_4_polynomial(cosine_2_argument_2)));
        const float phasor_ay_sine_squared = phasor_ay_sine * phasor_ay_sine;
        const float residuals_2_2 = (turn_yaw_cosine * accepted->V_ay) + (turn_yaw_sine * accepted->V_ax) -
            (phase_x_limited *
            (phasor_ay_sine * (field_1 + (phasor_ay_sine_squared * (field_3 + (phasor_ay_sine_squared * field_5))))));
        phase_x_choice_2 = (rows_1_3 * residuals_1_2) - (minus_rows_2_3 * residuals_2_2);
        phase_x_choice_3 = rows_2_2 * residuals_2_2;
        phase_x_choice_4 = (rows_1_4 * residuals_1_2) + (rows_2_4 * residuals_2_2);
        chi_square_choice = (residuals_1_2 * residuals_1_2) + (residuals_2_2 * residuals_2_2);
    }
    float phase_x_choice_5 = 0.0f;
    float phase_x_choice_6 = 0.0f;
    float phase_x_choice_7 = 0.0f;
    float phase_x_choice_8 = 0.0f;
    float phase_x_choice_9 = 0.0f;
    float phase_x_choice_10 = 0.0f;
    float chi_square_choice_2 = 0.0f;
    float chi_square_choice_3 = 0.0f;
    if (weights_4) {
        const float by_bx = offsets_1 + (arm_b_x * chord_yaw_cosine) - (arm_b_y * limited_yaw_sine);
        const float cosine_2_argument_3 = by_bx * by_bx;
        const float phasor_bx_sine = (bx_part_full * cosine_2_polynomial(cosine_2_argument_3)) +
            (phasor_bx_cosine * (by_bx * sine_4_polynomial(cosine_2_argument_3)));
        const float phasor_bx_sine_squared = phasor_bx_sine * phasor_bx_sine;
        const float residuals_3_2 = (turn_yaw_cosine * accepted->V_bx) - (turn_yaw_sine * accepted->V_by) -
            (phase_x_limited *
            (phasor_bx_sine * (field_1 + (phasor_bx_sine_squared * (field_3 + (phasor_bx_sine_squared * field_5))))));
        phase_x_choice_5 = rows_3_1 * residuals_3_2;
        phase_x_choice_6 = rows_3_3 * residuals_3_2;
        const float by_by = offsets_2 + (arm_b_y * chord_yaw_cosine) + (arm_b_x * limited_yaw_sine);
        const float cosine_2_argument_4 = by_by * by_by;
        const float phasor_by_sine = (by_part_full * cosine_2_polynomial(cosine_2_argument_4)) +
            (phasor_by_cosine * (by_by * sine_4_polynomial(cosine_2_argument_4)));
        const float phasor_by_sine_squared = phasor_by_sine * phasor_by_sine;
        const float residuals_4_2 = (turn_yaw_cosine * accepted->V_by) + (turn_yaw_sine * accepted->V_bx) -
            (phase_x_limited *
            (phasor_by_sine * (field_1 + (phasor_by_sine_squared * (field_3 + (phasor_by_sine_squared * field_5))))));
        phase_x_choice_7 = -(minus_rows_4_3 * residuals_4_2);
        phase_x_choice_8 = rows_4_2 * residuals_4_2;
        phase_x_choice_9 = rows_3_4 * residuals_3_2;
        phase_x_choice_10 = rows_4_4 * residuals_4_2;
        chi_square_choice_2 = residuals_3_2 * residuals_3_2;
        chi_square_choice_3 = residuals_4_2 * residuals_4_2;
    }
    float phase_x_choice_11 = 0.0f;
    float phase_x_choice_12 = 0.0f;
    float phase_x_choice_13 = 0.0f;
    float phase_x_choice_14 = 0.0f;
    float phase_x_choice_15 = 0.0f;
    float phase_x_choice_16 = 0.0f;
    float chi_square_choice_4 = 0.0f;
    float chi_square_choice_5 = 0.0f;
    if (weights_6) {
        const float by_cx = offsets_1 + (arm_c_x * chord_yaw_cosine) - (arm_c_y * limited_yaw_sine);
        const float cosine_2_argument_5 = by_cx * by_cx;
        const float phasor_cx_sine = (cx_part_full * cosine_2_polynomial(cosine_2_argument_5)) +
            (phasor_cx_cosine * (by_cx * sine_4_polynomial(cosine_2_argument_5)));
        const float phasor_cx_sine_squared = phasor_cx_sine * phasor_cx_sine;
        const float residuals_5_2 = (turn_yaw_cosine * accepted->V_cx) - (turn_yaw_sine * accepted->V_cy) -
            (phase_x_limited *
            (phasor_cx_sine * (field_1 + (phasor_cx_sine_squared * (field_3 + (phasor_cx_sine_squared * field_5))))));
        phase_x_choice_11 = rows_5_1 * residuals_5_2;
        phase_x_choice_12 = rows_5_3 * residuals_5_2;
        const float by_cy = offsets_2 + (arm_c_y * chord_yaw_cosine) + (arm_c_x * limited_yaw_sine);
        const float cosine_2_argument_6 = by_cy * by_cy;
        const float phasor_cy_sine = (cy_part_full * cosine_2_polynomial(cosine_2_argument_6)) +
            (phasor_cy_cosine * (by_cy * sine_4_polynomial(cosine_2_argument_6)));
        const float phasor_cy_sine_squared = phasor_cy_sine * phasor_cy_sine;
        const float residuals_6_2 = (turn_yaw_cosine * accepted->V_cy) + (turn_yaw_sine * accepted->V_cx) -
            (phase_x_limited *
            (phasor_cy_sine * (field_1 + (phasor_cy_sine_squared * (field_3 + (phasor_cy_sine_squared * field_5))))));
        phase_x_choice_13 = -(minus_rows_6_3 * residuals_6_2);
        phase_x_choice_14 = rows_6_2 * residuals_6_2;
        phase_x_choice_15 = rows_5_4 * residuals_5_2;
        phase_x_choice_16 = rows_6_4 * residuals_6_2;
        chi_square_choice_4 = residuals_5_2 * residuals_5_2;
        chi_square_choice_5 = residuals_6_2 * residuals_6_2;
    }
    float phase_x_choice_17 = 0.0f;
    float phase_x_choice_18 = 0.0f;
    float phase_x_choice_19 = 0.0f;
    float phase_x_choice_20 = 0.0f;
    float phase_x_choice_21 = 0.0f;
    float phase_x_choice_22 = 0.0f;
    float chi_square_choice_6 = 0.0f;
    float chi_square_choice_7 = 0.0f;
    if (weights_8) {
        const float by_dx = offsets_1 + (arm_d_x * chord_yaw_cosine) - (arm_d_y * limited_yaw_sine);
        const float cosine_2_argument_7 = by_dx * by_dx;
        const float phasor_dx_sine = (dx_part_full * cosine_2_polynomial(cosine_2_argument_7)) +
            (phasor_dx_cosine * (by_dx * sine_4_polynomial(cosine_2_argument_7)));
        const float phasor_dx_sine_squared = phasor_dx_sine * phasor_dx_sine;
        const float residuals_7_2 = (turn_yaw_cosine * accepted->V_dx) - (turn_yaw_sine * accepted->V_dy) -
            (phase_x_limited *
            (phasor_dx_sine * (field_1 + (phasor_dx_sine_squared * (field_3 + (phasor_dx_sine_squared * field_5))))));
        phase_x_choice_17 = rows_7_1 * residuals_7_2;
        phase_x_choice_18 = rows_7_3 * residuals_7_2;
        const float by_dy = offsets_2 + (arm_d_y * chord_yaw_cosine) + (arm_d_x * limited_yaw_sine);
        const float cosine_2_argument_8 = by_dy * by_dy;
        const float phasor_dy_sine = (dy_part_full * cosine_2_polynomial(cosine_2_argument_8)) +
            (phasor_dy_cosine * (by_dy * sine_4_polynomial(cosine_2_argument_8)));
        const float phasor_dy_sine_squared = phasor_dy_sine * phasor_dy_sine;
        const float residuals_8_2 = (turn_yaw_cosine * accepted->V_dy) + (turn_yaw_sine * accepted->V_dx) -
            (phase_x_limited *
            (phasor_dy_sine * (field_1 + (phasor_dy_sine_squared * (field_3 + (phasor_dy_sine_squared * field_5))))));
        phase_x_choice_19 = -(minus_rows_8_3 * residuals_8_2);
        phase_x_choice_20 = rows_8_2 * residuals_8_2;
        phase_x_choice_21 = rows_7_4 * residuals_7_2;
        phase_x_choice_22 = rows_8_4 * residuals_8_2;
        chi_square_choice_6 = residuals_7_2 * residuals_7_2;
        chi_square_choice_7 = residuals_8_2 * residuals_8_2;
    }
    const float offsets_4_2 = offsets_4 + phase_x_change;
    const float gradient_1 = phase_x_choice + phase_x_choice_5 + phase_x_choice_11 + phase_x_choice_17;
    const float gradient_1_times_inverse_1 = gradient_1 * inverse_1;
    const float gradient_2 = phase_x_choice_3 + phase_x_choice_8 + phase_x_choice_14 + phase_x_choice_20;
    const float gradient_2_times_inverse_2 = gradient_2 * inverse_2;
    const float gradient_3 = phase_x_choice_2 + phase_x_choice_6 + phase_x_choice_7 + phase_x_choice_12 +
        phase_x_choice_13 + phase_x_choice_18 + phase_x_choice_19;
    const float forward_3_2 = gradient_3 - (lower_3_1 * gradient_1) - (lower_3_2 * gradient_2);
    const float forward_3_2_times_inverse_3 = forward_3_2 * inverse_3;
    const float gradient_4 = phase_x_choice_4 + phase_x_choice_9 + phase_x_choice_10 + phase_x_choice_15 +
        phase_x_choice_16 + phase_x_choice_21 + phase_x_choice_22 - (prior_weight_amplitude * offsets_4_2);
    const float forward_4_2 = gradient_4 - (lower_4_1 * gradient_1) - (lower_4_2 * gradient_2) -
        (lower_4_3 * forward_3_2);
    const float steps_4_2 = forward_4_2 * diagonal_4;
    float added_1_2 = 0.0f;
    float added_2_2 = 0.0f;
    float added_3_2 = 0.0f;
    float added_4_2 = 0.0f;
    float chi_square_choice_8 = 0.0f;
    if (!none) {
        const float projection_1 = hall_position_four_limit((move_excluded_1_1 * gradient_1) + (move_excluded_1_2 *
            gradient_2) + (move_excluded_1_3 * gradient_3) + (move_excluded_1_4 * gradient_4), largest_projection);
        const float phase_x_product_4 = gain_excluded_1 * projection_1;
        const float projection_2 = hall_position_four_limit((move_excluded_2_1 * gradient_1) + (move_excluded_2_2 *
            gradient_2) + (move_excluded_2_3 * gradient_3) + (move_excluded_2_4 * gradient_4), largest_projection);
        const float phase_x_product_5 = gain_excluded_2 * projection_2;
        added_1_2 = (move_excluded_1_1 * phase_x_product_4) + (move_excluded_2_1 * phase_x_product_5);
        added_2_2 = (move_excluded_1_2 * phase_x_product_4) + (move_excluded_2_2 * phase_x_product_5);
        added_3_2 = (move_excluded_1_3 * phase_x_product_4) + (move_excluded_2_3 * phase_x_product_5);
        added_4_2 = (move_excluded_1_4 * phase_x_product_4) + (move_excluded_2_4 * phase_x_product_5);
        chi_square_choice_8 = (gain_excluded_1 * (projection_1 * projection_1)) +
            (gain_excluded_2 * (projection_2 * projection_2));
    }
    const float chi_square_sum = (gradient_1 * gradient_1_times_inverse_1) + (gradient_2 * gradient_2_times_inverse_2) +
        (forward_3_2 * forward_3_2_times_inverse_3) + (forward_4_2 * steps_4_2) + chi_square_choice_8;
    const float cost = hall_position_four_max(chi_square_choice + chi_square_choice_2 + chi_square_choice_3 +
        chi_square_choice_4 + chi_square_choice_5 + chi_square_choice_6 + chi_square_choice_7 +
        (prior_weight_amplitude * (offsets_4_2 * offsets_4_2)) - chi_square_sum, 0.0f);
    const bool none_2 = hall_position_four_equal(x_excluded, 0.0f);
    const float protection_phase_x_sum_2 = (moves_1_1 * moves_1_1 * gain_1) + (moves_2_1 * moves_2_1 * gain_2);
    const float protection_phase_x_sum_3 = (moves_3_1 * moves_3_1 * gain_3) + (moves_4_1 * moves_4_1 * gain_4);
    const float protection_phase_x_sum_4 = (moves_5_1 * moves_5_1 * gain_5) + (moves_6_1 * moves_6_1 * gain_6);
    const float protection_phase_x_sum_5 = (moves_7_1 * moves_7_1 * gain_7) + (moves_8_1 * moves_8_1 * gain_8);
    const float deviation_phase_x = hall_position_four_min(channel_sigma * sqrtf(variance_phase_x),
        largest_deviation_phase);
    const float protection_phase_y_sum = (minus_moves_1_2 * minus_moves_1_2 * gain_1) +
        (moves_2_2 * moves_2_2 * gain_2);
    const float protection_phase_y_sum_2 = (minus_moves_3_2 * minus_moves_3_2 * gain_3) +
        (moves_4_2 * moves_4_2 * gain_4);
    const float protection_phase_y_sum_3 = (minus_moves_5_2 * minus_moves_5_2 * gain_5) +
        (moves_6_2 * moves_6_2 * gain_6);
    const float protection_phase_y_sum_4 = (minus_moves_7_2 * minus_moves_7_2 * gain_7) +
        (moves_8_2 * moves_8_2 * gain_8);
    const float deviation_phase_y = hall_position_four_min(channel_sigma * sqrtf(variance_phase_y),
        largest_deviation_phase);
    const float protection_yaw_sum = (moves_1_3 * moves_1_3 * gain_1) + (minus_moves_2_3 * minus_moves_2_3 * gain_2);
    const float protection_yaw_sum_2 = (moves_3_3 * moves_3_3 * gain_3) + (minus_moves_4_3 * minus_moves_4_3 * gain_4);
    const float protection_yaw_sum_3 = (moves_5_3 * moves_5_3 * gain_5) + (minus_moves_6_3 * minus_moves_6_3 * gain_6);
    const float protection_yaw_sum_4 = (moves_7_3 * moves_7_3 * gain_7) + (minus_moves_8_3 * minus_moves_8_3 * gain_8);
    const float deviation_yaw = hall_position_four_min(channel_sigma * sqrtf(variance_yaw), largest_deviation_yaw);
    const float steps_3_2 = forward_3_2_times_inverse_3 - (lower_4_3 * steps_4_2);
    const float moved_1 = hall_position_four_limit(offsets_1 + (gradient_1_times_inverse_1 - (lower_3_1 * steps_3_2) -
        (lower_4_1 * steps_4_2) + added_1_2), largest_step_phase);
    const float moved_2 = hall_position_four_limit(offsets_2 + (gradient_2_times_inverse_2 - (lower_3_2 * steps_3_2) -
        (lower_4_2 * steps_4_2) + added_2_2), largest_step_phase);
    const float moved_3 = hall_position_four_limit(offsets_3 + (steps_3_2 + added_3_2), largest_step_yaw);
    const float protection_phase_x_sum_6 = hypothesis_cost + (cancellation * full_cost);
    const bool protection_phase_x_test = hall_position_four_equal(x_excluded, 1.0f);
    const bool passing_1 = (costs_1 <= protection_phase_x_sum_6) || protection_phase_x_test;
    const uint32_t plausible_1 = state->plausible_1;
    const bool plausible_1_2 = passing_1 || (plausible_1 != 0u);
    const bool protection_phase_x_test_2 = hall_position_four_equal(x_excluded, 2.0f);
    const bool passing_2 = (costs_2 <= protection_phase_x_sum_6) || protection_phase_x_test_2;
    const uint32_t plausible_2 = state->plausible_2;
    const bool plausible_2_2 = passing_2 || (plausible_2 != 0u);
    const bool protection_phase_x_test_3 = hall_position_four_equal(x_excluded, 3.0f);
    const bool passing_3 = (costs_3 <= protection_phase_x_sum_6) || protection_phase_x_test_3;
    const uint32_t plausible_3 = state->plausible_3;
    const bool plausible_3_2 = passing_3 || (plausible_3 != 0u);
    const bool protection_phase_x_test_4 = hall_position_four_equal(x_excluded, 4.0f);
    const bool passing_4 = (costs_4 <= protection_phase_x_sum_6) || protection_phase_x_test_4;
    const uint32_t plausible_4 = state->plausible_4;
    const bool plausible_4_2 = passing_4 || (plausible_4 != 0u);
    float protection_phase_x_choice;
    float protection_phase_y_choice;
    float level;
    float limit = test_threshold;
    if (none_2) {
        protection_phase_x_choice = (undetected *
            sqrtf(hall_position_four_max(hall_position_four_max(hall_position_four_max(protection_phase_x_sum_2,
            protection_phase_x_sum_3), protection_phase_x_sum_4), protection_phase_x_sum_5))) +
            (level_sigmas * deviation_phase_x);
        protection_phase_y_choice = (undetected *
            sqrtf(hall_position_four_max(hall_position_four_max(hall_position_four_max(protection_phase_y_sum,
            protection_phase_y_sum_2), protection_phase_y_sum_3), protection_phase_y_sum_4))) +
            (level_sigmas * deviation_phase_y);
        level = (undetected *
            sqrtf(hall_position_four_max(hall_position_four_max(hall_position_four_max(protection_yaw_sum,
            protection_yaw_sum_2), protection_yaw_sum_3), protection_yaw_sum_4))) + (level_sigmas * deviation_yaw);
    } else {
        const float steps_1_minus_moved_1 = steps_1 - moved_1;
        const float steps_2_minus_moved_2 = steps_2 - moved_2;
        const float steps_3_minus_moved_3 = steps_3 - moved_3;
        float apart = 0.0f;
        float added = protection_phase_x_sum_2;
        float apart_2 = 0.0f;
        float added_5 = protection_phase_y_sum;
        float apart_3 = 0.0f;
        float added_6 = protection_yaw_sum;
        if (plausible_1_2) {
            apart = fabsf(steps_1_minus_moved_1 -
                ((moves_1_1 * scores_1_times_gain_1) + (moves_2_1 * scores_2_times_gain_2)));
            apart_2 = fabsf(steps_2_minus_moved_2 -
                ((moves_2_2 * scores_2_times_gain_2) - (minus_moves_1_2 * scores_1_times_gain_1)));
            apart_3 = fabsf(steps_3_minus_moved_3 -
                ((moves_1_3 * scores_1_times_gain_1) - (minus_moves_2_3 * scores_2_times_gain_2)));
        } else {
            added = 0.0f;
            added_5 = 0.0f;
            added_6 = 0.0f;
        }
        if (plausible_2_2) {
            apart = hall_position_four_max(apart, fabsf(steps_1_minus_moved_1 -
                ((moves_3_1 * scores_3_times_gain_3) + (moves_4_1 * scores_4_times_gain_4))));
            added = hall_position_four_max(added, protection_phase_x_sum_3);
            apart_2 = hall_position_four_max(apart_2, fabsf(steps_2_minus_moved_2 -
                ((moves_4_2 * scores_4_times_gain_4) - (minus_moves_3_2 * scores_3_times_gain_3))));
            added_5 = hall_position_four_max(added_5, protection_phase_y_sum_2);
            apart_3 = hall_position_four_max(apart_3, fabsf(steps_3_minus_moved_3 -
                ((moves_3_3 * scores_3_times_gain_3) - (minus_moves_4_3 * scores_4_times_gain_4))));
            added_6 = hall_position_four_max(added_6, protection_yaw_sum_2);
        }
        if (plausible_3_2) {
            apart = hall_position_four_max(apart, fabsf(steps_1_minus_moved_1 -
                ((moves_5_1 * scores_5_times_gain_5) + (moves_6_1 * scores_6_times_gain_6))));
            added = hall_position_four_max(added, protection_phase_x_sum_4);
            apart_2 = hall_position_four_max(apart_2, fabsf(steps_2_minus_moved_2 -
                ((moves_6_2 * scores_6_times_gain_6) - (minus_moves_5_2 * scores_5_times_gain_5))));
            added_5 = hall_position_four_max(added_5, protection_phase_y_sum_3);
            apart_3 = hall_position_four_max(apart_3, fabsf(steps_3_minus_moved_3 -
                ((moves_5_3 * scores_5_times_gain_5) - (minus_moves_6_3 * scores_6_times_gain_6))));
            added_6 = hall_position_four_max(added_6, protection_yaw_sum_3);
        }
        if (plausible_4_2) {
            apart = hall_position_four_max(apart, fabsf(steps_1_minus_moved_1 -
                ((moves_7_1 * scores_7_times_gain_7) + (moves_8_1 * scores_8_times_gain_8))));
            added = hall_position_four_max(added, protection_phase_x_sum_5);
            apart_2 = hall_position_four_max(apart_2, fabsf(steps_2_minus_moved_2 -
                ((moves_8_2 * scores_8_times_gain_8) - (minus_moves_7_2 * scores_7_times_gain_7))));
            added_5 = hall_position_four_max(added_5, protection_phase_y_sum_4);
            apart_3 = hall_position_four_max(apart_3, fabsf(steps_3_minus_moved_3 -
                ((moves_7_3 * scores_7_times_gain_7) - (minus_moves_8_3 * scores_8_times_gain_8))));
            added_6 = hall_position_four_max(added_6, protection_yaw_sum_4);
        }
        protection_phase_x_choice = overbound * (apart + (level_noise * sqrtf(diagonal_1 + added)));
        protection_phase_y_choice = overbound * (apart_2 + (level_noise * sqrtf(diagonal_2 + added_5)));
        level = overbound * (apart_3 + (level_noise * sqrtf(diagonal_3 + added_6)));
        limit = hypothesis_threshold;
    }
    const bool decides = !x_trial;
    const bool phases_valid_test_2 = in_range && (cost <= (channel_variance * limit)) && decides;
    const bool accepted_2 = phases_valid_test && phases_valid_test_2;
    float phase_x = predicted_phase_x;
    float phase_y = predicted_phase_y;
    float yaw = predicted_yaw;
    float amplitude = amplitude_2;
    float motions_motion_phase_x = motion_phase_x;
    float motions_motion_phase_y = motion_phase_y;
    float motions_motion_yaw = motion_yaw;
    bool plausible_1_test = plausible_1_2;
    bool plausible_2_test = plausible_2_2;
    bool plausible_3_test = plausible_3_2;
    bool plausible_4_test = plausible_4_2;
    if (x_trial) {
        const bool refuted = x_trial && (refuted_cost < cost);
        plausible_1_test = (plausible_1 != 0u) && !(refuted && protection_phase_x_test);
        plausible_2_test = (plausible_2 != 0u) && !(refuted && protection_phase_x_test_2);
        plausible_3_test = (plausible_3 != 0u) && !(refuted && protection_phase_x_test_3);
        plausible_4_test = (plausible_4 != 0u) && !(refuted && protection_phase_x_test_4);
    } else {
        const float phase_x_sum_9 = predicted_phase_x + moved_1;
        float phase_x_choice_23 = phase_x_sum_9;
        if (pi < phase_x_sum_9) {
            phase_x_choice_23 = phase_x_sum_9 - two_pi;
        }
        float phase_x_choice_24 = phase_x_choice_23;
        if (phase_x_choice_23 < -pi) {
            phase_x_choice_24 = phase_x_choice_23 + two_pi;
        }
        phase_x = hall_position_four_limit(phase_x_choice_24, pi);
        const float phase_y_sum = predicted_phase_y + moved_2;
        float phase_y_choice = phase_y_sum;
        if (pi < phase_y_sum) {
            phase_y_choice = phase_y_sum - two_pi;
        }
        float phase_y_choice_2 = phase_y_choice;
        if (phase_y_choice < -pi) {
            phase_y_choice_2 = phase_y_choice + two_pi;
        }
        phase_y = hall_position_four_limit(phase_y_choice_2, pi);
        yaw = hall_position_four_limit(predicted_yaw + moved_3, highest_yaw);
        const float amplitude_limited = hall_position_four_min(amplitude_2 + hall_position_four_limit(phase_x_change +
            (steps_4_2 + added_4_2), largest_step_amplitude), highest_amplitude);
        amplitude = hall_position_four_max(amplitude_limited, lowest_amplitude);
        if (fabsf(moved_1) < largest_step_phase) {
            motions_motion_phase_x = motion_phase_x + (0.5f * moved_1);
        } else {
            motions_motion_phase_x = 0.0f;
        }
        if (fabsf(moved_2) < largest_step_phase) {
            motions_motion_phase_y = motion_phase_y + (0.5f * moved_2);
        } else {
            motions_motion_phase_y = 0.0f;
        }
        if (fabsf(moved_3) < largest_step_yaw) {
            motions_motion_yaw = motion_yaw + (0.5f * moved_3);
        } else {
            motions_motion_yaw = 0.0f;
        }
    }
    const bool uncertain = !(none_2 || x_certain);
    const uint32_t doubted_sum = hall_position_four_flag(plausible_1_2) + hall_position_four_flag(plausible_2_2) +
        hall_position_four_flag(plausible_3_2) + hall_position_four_flag(plausible_4_2);
    const bool detectable = (gain_1 < largest_gain) && (gain_2 < largest_gain) && (gain_3 < largest_gain) &&
        (gain_4 < largest_gain) && (gain_5 < largest_gain) && (gain_6 < largest_gain) && (gain_7 < largest_gain) &&
        (gain_8 < largest_gain);
    if (!detectable) {
        protection_phase_x_choice = largest_level_phase;
        protection_phase_y_choice = largest_level_phase;
        level = largest_level_yaw;
    }
    const float protection_phase_x = hall_position_four_min(protection_phase_x_choice, largest_level_phase);
    const float protection_phase_y = hall_position_four_min(protection_phase_y_choice, largest_level_phase);
    const float protection_yaw = hall_position_four_min(level, largest_level_yaw);
    const bool phases_valid_test_3 = detectable && (protection_phase_x <= limit_phase) &&
        (protection_phase_y <= limit_phase) && (protection_yaw <= limit_yaw);
    const bool contested = uncertain && (1u < doubted_sum) && !phases_valid_test_3;
    const uint32_t missed = state->missed;
    const bool lost = track_patience <= missed;
    const bool phases_valid_test_4 = !lost;
    const bool converged = chi_square_sum <= decrease_tolerance;
    float tracked_motion_phase_x = 0.0f;
    float tracked_motion_phase_y = 0.0f;
    float tracked_motion_yaw = 0.0f;
    if (tracking) {
        if (accepted_2) {
            state->phase_x = phase_x;
            state->phase_y = phase_y;
            state->yaw = yaw;
            state->amplitude = amplitude;
            tracked_motion_phase_x = motions_motion_phase_x;
            tracked_motion_phase_y = motions_motion_phase_y;
            tracked_motion_yaw = motions_motion_yaw;
        } else {
            state->phase_x = predicted_phase_x;
            state->phase_y = predicted_phase_y;
            state->yaw = predicted_yaw;
            tracked_motion_phase_x = motion_phase_x;
            tracked_motion_phase_y = motion_phase_y;
            tracked_motion_yaw = motion_yaw;
        }
        const float excluded_3 = hall_position_four_max(excluded_choice, 0.0f);
        state->excluded = (uint32_t)excluded_3;
        const bool keeps = uncertain && (0.0f < excluded_3);
        state->plausible_1 = hall_position_four_flag(keeps && plausible_1_test);
        state->plausible_2 = hall_position_four_flag(keeps && plausible_2_test);
        state->plausible_3 = hall_position_four_flag(keeps && plausible_3_test);
        state->plausible_4 = hall_position_four_flag(keeps && plausible_4_test);
        if (keeps && contested && decides) {
            const float failing_3 = ((plausible_3 != 0u) && !passing_3) ? costs_3 : 0.0f;
            const float failing_2 = ((plausible_2 != 0u) && !passing_2) ? costs_2 : 0.0f;
            const float failing_1 = ((plausible_1 != 0u) && !passing_1) ? costs_1 : 0.0f;
            const float failing_2_max_failing_1 = hall_position_four_max(failing_2, failing_1);
            if (hall_position_four_max(failing_3, failing_2_max_failing_1) <
                    (((plausible_4 != 0u) && !passing_4) ? costs_4 : 0.0f)) {
                state->competing = 4u;
            } else if (failing_2_max_failing_1 < failing_3) {
                state->competing = 3u;
            } else {
                state->competing = (uint32_t)((failing_1 < failing_2) ? 2.0f : ((0.0f < failing_1) ? 1.0f : 0.0f));
            }
        } else {
            state->competing = 0u;
        }
        state->start_number = starts;
        state->candidates = 0u;
        state->missed = (accepted_2 && phases_valid_test_4) ? 0u : ((lost) ? missed : (missed + 1u));
        state->age = 0u;
    } else {
        const uint32_t age = state->age;
        const bool ends = converged || (last_age <= age);
        const bool start_number_at_least_23 = last_start <= start_number;
        const bool last = ends && start_number_at_least_23;
        const uint32_t candidates = state->candidates;
        const bool solves = converged && accepted_2;
        const bool first = candidates == 0u;
        const float candidate_phase_x = state->candidate_phase_x;
        const float apart_phase_x = fabsf(phase_x - candidate_phase_x);
        const float candidate_phase_y = state->candidate_phase_y;
        const float apart_phase_y = fabsf(phase_y - candidate_phase_y);
        const float candidate_yaw = state->candidate_yaw;
        const float phase_x_sum_10 = 2.0f - ((first || ((hall_position_four_min(apart_phase_x, fabsf(apart_phase_x -
            two_pi)) <= agreement_phase) && (hall_position_four_min(apart_phase_y, fabsf(apart_phase_y - two_pi)) <=
            agreement_phase) && (fabsf(yaw - candidate_yaw) <= agreement_yaw))) ? 1.0f : 0.0f);
        const float count = hall_position_four_max((float)candidates, (solves ? 1.0f : 0.0f) * phase_x_sum_10);
        const bool unique = last && hall_position_four_equal(count, 1.0f);
        float candidate_phase_x_2 = phase_x;
        float candidate_phase_y_2 = phase_y;
        float candidate_yaw_2 = yaw;
        float candidate_amplitude = amplitude;
        if (first && solves) {
            state->candidate_phase_x = phase_x;
            state->candidate_phase_y = phase_y;
            state->candidate_yaw = yaw;
            state->candidate_amplitude = amplitude;
        } else {
            candidate_phase_x_2 = candidate_phase_x;
            candidate_phase_y_2 = candidate_phase_y;
            candidate_yaw_2 = candidate_yaw;
            candidate_amplitude = state->candidate_amplitude;
        }
        float phase_x_if_not_unique = phase_x;
        float phase_y_if_not_unique = phase_y;
        float yaw_if_not_unique = yaw;
        float amplitude_if_not_unique = 1.0f;
        if (ends) {
            const float phase_x_sum_11 = state->begin_phase_x + increment_phase_x;
            if (pi < phase_x_sum_11) {
                const float phase_x_sum_11_minus_two_pi = phase_x_sum_11 - two_pi;
                phase_x_if_not_unique = phase_x_sum_11_minus_two_pi;
                state->begin_phase_x = phase_x_sum_11_minus_two_pi;
            } else {
                phase_x_if_not_unique = phase_x_sum_11;
                state->begin_phase_x = phase_x_sum_11;
            }
            const float phase_y_sum_2 = state->begin_phase_y + increment_phase_y;
            if (pi < phase_y_sum_2) {
                const float phase_y_sum_2_minus_two_pi = phase_y_sum_2 - two_pi;
                phase_y_if_not_unique = phase_y_sum_2_minus_two_pi;
                state->begin_phase_y = phase_y_sum_2_minus_two_pi;
            } else {
                phase_y_if_not_unique = phase_y_sum_2;
                state->begin_phase_y = phase_y_sum_2;
            }
            const float begin_yaw_plus_increment_yaw = state->begin_yaw + increment_yaw;
            if (highest_yaw < begin_yaw_plus_increment_yaw) {
                const float yaw_sum = begin_yaw_plus_increment_yaw - width_yaw;
                yaw_if_not_unique = yaw_sum;
                state->begin_yaw = yaw_sum;
            } else {
                yaw_if_not_unique = begin_yaw_plus_increment_yaw;
                state->begin_yaw = begin_yaw_plus_increment_yaw;
            }
            state->age = 0u;
        } else {
            amplitude_if_not_unique = amplitude;
            const uint32_t age_sum = age + 1u;
            const float age_if_not_ends = hall_position_four_min((float)age_sum, 3.0f);
            state->age = (uint32_t)age_if_not_ends;
        }
        if (unique) {
            state->phase_x = candidate_phase_x_2;
            state->phase_y = candidate_phase_y_2;
            state->yaw = candidate_yaw_2;
            state->amplitude = candidate_amplitude;
            state->start_number = starts;
        } else {
            state->phase_x = phase_x_if_not_unique;
            state->phase_y = phase_y_if_not_unique;
            state->yaw = yaw_if_not_unique;
            state->amplitude = amplitude_if_not_unique;
            state->start_number = (last) ? 0u :
                ((start_number_at_least_23) ? last_start : (start_number + hall_position_four_flag(ends)));
        }
        state->excluded = 0u;
        state->plausible_1 = 0u;
        state->plausible_2 = 0u;
        state->plausible_3 = 0u;
        state->plausible_4 = 0u;
        state->competing = 0u;
        state->candidates = (uint32_t)((!last || unique) ? count : 0.0f);
        state->missed = 0u;
    }
    state->motion_phase_x = hall_position_four_limit(tracked_motion_phase_x, largest_motion_phase);
    state->motion_phase_y = hall_position_four_limit(tracked_motion_phase_y, largest_motion_phase);
    state->motion_yaw = hall_position_four_limit(tracked_motion_yaw, largest_motion_yaw);
    const bool phases_valid = converged && phases_valid_test && phases_valid_test_2 && phases_valid_test_3 &&
        tracking && phases_valid_test_4;
    if (diagnostics != NULL) {
        diagnostics->deviation_phase_x = deviation_phase_x;
        diagnostics->deviation_phase_y = deviation_phase_y;
        diagnostics->phase_x = phase_x;
        diagnostics->phase_y = phase_y;
        diagnostics->protection_phase_x = protection_phase_x;
        diagnostics->protection_phase_y = protection_phase_y;
        diagnostics->phases_valid = phases_valid ? 1.0f : 0.0f;
    }
    return (hall_position_four_estimator_t){.excluded = excluded, .phase_x = phase_x, .phase_y = phase_y, .yaw = yaw,
        .amplitude = amplitude, .deviation_phase_x = deviation_phase_x, .deviation_phase_y = deviation_phase_y,
        .deviation_yaw = deviation_yaw, .deviation_amplitude = hall_position_four_min(channel_sigma *
        sqrtf(variance_amplitude), largest_deviation_amplitude),
        .chi_square = hall_position_four_min(inverse_channel_variance * cost, largest_chi_square),
        .protection_phase_x = protection_phase_x, .protection_phase_y = protection_phase_y,
        .protection_yaw = protection_yaw, .converged = converged, .weak = weak, .tracking = tracking, .lost = lost,
        .phases_valid = phases_valid, .doubted = x_trial || contested};
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
    hall_position_four_input_t accepted = *in;
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
