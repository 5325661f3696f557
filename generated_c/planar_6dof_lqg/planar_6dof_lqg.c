/* planar_6dof_lqg. Generated: do not edit. */
#include "planar_6dof_lqg.h"
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

static inline float planar_6dof_lqg_max(float a, float b)
{
    return (a > b) ? a : b;
}

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float planar_6dof_lqg_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline float planar_6dof_lqg_slew(float last, float target, float step)
{
    const float highest = last + step;
    const float lowest = last - step;
    const float below = (target < highest) ? target : highest;
    return (below > lowest) ? below : lowest;
}

#if defined(__GNUC__)
#define PLANAR_6DOF_LQG_INLINE static inline __attribute__((always_inline))
#else
#define PLANAR_6DOF_LQG_INLINE static inline
#endif
#if defined(__OPTIMIZE_SIZE__)
#define PLANAR_6DOF_LQG_LARGE static inline
#else
#define PLANAR_6DOF_LQG_LARGE PLANAR_6DOF_LQG_INLINE
#endif
/* Return a value in -high .. high; for another one or NaN, set its fault bit and return refused. */
PLANAR_6DOF_LQG_INLINE float planar_6dof_lqg_replace_within(float value, float high, float refused, uint32_t bit,
    uint32_t *faults)
{
    float held = value;
    if (!(fabsf(value) <= high)) {
        held = refused;
        *faults |= bit;
    }
    return held;
}

/* Return a value in -high .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
PLANAR_6DOF_LQG_INLINE float planar_6dof_lqg_hold_within(float value, float high, float *last, uint32_t bit,
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

/* cos(x); x = clamp(phi_raw, -0.075, 0.075) in -0.0250000004 .. 0.0250000004, t = x^2; relative error at most 6e-08. */
static inline float cos_phi_raw_polynomial(float t)
{
    return 1.0f + (t * -0.49997827f);
}

/* sin(x) / x; x = clamp(phi_raw, -0.075, 0.075) in -0.0250000004 .. 0.0250000004, t = x^2; relative error at most
 * 1.2e-07. */
static inline float sin_phi_raw_polynomial(float t)
{
    return 1.0f + (t * -0.16666232f);
}

/* quarter_sine / x; x = distance_rear, distance_front in -0.0280395541 .. 0.0280395541, t = x^2; relative error at most
 * 2.9e-06. */
static inline float quarter_sine_polynomial(float t)
{
    return 30.921103f + (t * (-4925.5044f + (t * 229242.78f)));
}

/* cos(1.5822228 * sin(x)); x = clamp(phi_raw, -0.075, 0.075) in -0.0250000004 .. 0.0250000004, t = x^2; relative error
 * at most 9e-08. */
static inline float cosine_polynomial(float t)
{
    return 0.99999994f + (t * -1.2512345f);
}

/* sin(1.5822228 * sin(x)) / x; x = clamp(phi_raw, -0.075, 0.075) in -0.0250000004 .. 0.0250000004, t = x^2; relative
 * error at most 1.2e-07. */
static inline float sine_polynomial(float t)
{
    return 1.5822228f + (t * -0.9236455f);
}

typedef struct {
    uint32_t latched;
    bool complete;
    bool latch_certain;
} planar_6dof_lqg_guard_output_t;

/* guard: range acceptance, hold, latch */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_guard_output_t planar_6dof_lqg_guard_output(planar_6dof_lqg_guard_state_t *state,
    uint32_t suspected, bool complete_V_cy, bool others, uint32_t latched_before)
{
    /* 1; of the 29, left in the first sample that brakes; from it on each one counts as bad */
    static const uint32_t braking_from = 24u;
    /* 1; of the 29, left in the sample that first sets bit 30; fewer are left in those that brake */
    static const uint32_t latch_certain_from = 25u;
    /* 1; 5 bad samples in a row, and 24 that count as bad whatever is measured, until it latches */
    static const uint32_t latch_samples = 29u;

    const uint32_t left = state->left;
    const bool complete = (suspected != 0u) ? false : complete_V_cy;
    uint32_t latched = latched_before;
    bool latch_certain = false;
    if ((left <= braking_from) ? false : (complete && others)) {
        state->left = latch_samples;
        state->ready = 1u;
    } else {
        if (left <= 1u) {
            latched = 1u;
        } else {
            state->left = left - 1u;
        }
        latch_certain = left <= latch_certain_from;
    }
    return (planar_6dof_lqg_guard_output_t){.latched = latched, .complete = complete, .latch_certain = latch_certain};
}

typedef struct {
    bool suspect_V_ax;
    bool suspect_V_ay;
    bool suspect_V_bx;
    bool suspect_V_by;
    bool suspect_V_cx;
    bool suspect_V_cy;
    bool other_amplitude;
} planar_6dof_lqg_sensing_output_t;

/* sensing: position and yaw, (1)-(5)
 * One voltage is watched at a time, while it repeats its code: with 14 in a row it is frozen and suspected. The
 * scale is corrected between two watches alone, so that no sample has the cost of both.
 * A sample with a refused or suspected voltage takes none of the six: x, y and yaw are predicted. A torque that the
 * prediction does not know shifts the yaw by a steady innovation, so the first such sample adds the last one, else
 * the yaw would jump. The prediction goes on from there, and later samples add nothing. A contradicted sample adds
 * the mean of the innovation instead, if it is smaller, since the wrong voltage may have shifted the last one. */
PLANAR_6DOF_LQG_LARGE planar_6dof_lqg_sensing_output_t planar_6dof_lqg_sensing_output(const
    planar_6dof_lqg_sensing_state_t *state, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const float squared_jump = 0.12402716f;              /* V^2; rho = 1.5: a voltage jumped */
    /* 1/V^2; (0.08 / (0.15 V_0))^2, V_0 = 2.93479 V: amplitude of the Hall voltages */
    static const float m_weight = 0.033025026f;
    static const float significant_r = 0.07043498f;             /* V; 0.024 V_0: a larger residual r is significant */
    static const float nearly_zero_m = 0.8612997f;              /* V^2; 0.1 V_0^2: a smaller excess m is nearly zero */
    /* V^2; 0.3 V_0^2: largest change of a squared sine voltage that is small */
    static const float small_m = 2.5838993f;
    static const float significant_m = 0.25838992f;             /* V^2; 0.03 V_0^2: a larger excess m is significant */
    static const float max_known_yaw = 0.01f;                   /* rad; beyond it every voltage is suspected */
    /* V^2; (0.08 V_0)^2: rho^2 is the weighted sum of the squared residuals over this */
    static const float squared_residual_limit = 0.055123184f;
    static const uint32_t channel_V_ay = 2u;                    /* 1; among the channels, from 1 */
    static const uint32_t channel_V_bx = 3u;                    /* 1; among the channels, from 1 */
    static const uint32_t channel_V_by = 4u;                    /* 1; among the channels, from 1 */
    static const uint32_t channel_V_cx = 5u;                    /* 1; among the channels, from 1 */
    static const uint32_t channel_V_cy = 6u;                    /* 1; among the channels, from 1 */

    const uint32_t contradiction_confirmed = state->contradiction_confirmed;
    bool suspect_V_ax = false;
    bool suspect_V_ay = false;
    bool suspect_V_bx = false;
    bool suspect_V_by = false;
    bool suspect_V_cx = false;
    bool suspect_V_cy = false;
    bool other_amplitude = false;
    if (contradiction_confirmed != 0u) {
        const uint32_t frozen = state->frozen;
        const float first_r_1 = state->first_r_1;
        const float first_r_2 = state->first_r_2;
        const float first_m_x = state->first_m_x;
        const float first_m_y = state->first_m_y;
        const float first_r_2_size = fabsf(first_r_2);
        const float first_r_1_size = fabsf(first_r_1);
        const float size_x = fabsf(first_m_x);
        const bool m_exceeds_x = significant_m < size_x;
        const float size_y = fabsf(first_m_y);
        const bool m_exceeds_y = significant_m < size_y;
        const bool both_m_exceed = m_exceeds_x && m_exceeds_y;
        const bool common = both_m_exceed && (first_r_1_size <= significant_r) && (first_r_2_size <= significant_r) &&
            (fabsf(first_m_x - first_m_y) < (0.25f * fabsf(first_m_x + first_m_y)));
        if (frozen != 0u) {
            suspect_V_ax = frozen == 1u;
            suspect_V_ay = frozen == channel_V_ay;
            suspect_V_bx = frozen == channel_V_bx;
            suspect_V_by = frozen == channel_V_by;
            suspect_V_cx = frozen == channel_V_cx;
            suspect_V_cy = frozen == channel_V_cy;
        } else {
            const float first_squared = (first_r_1 * first_r_1) + (first_r_2 * first_r_2) +
                (m_weight * ((first_m_x * first_m_x) + (first_m_y * first_m_y)));
            const bool is_jump = squared_jump < first_squared;
            const bool r_exceeds_x = significant_r < first_r_2_size;
            const bool r_exceeds_y = significant_r < first_r_1_size;
            bool fits_V_ax;
            bool fits_V_ay;
            bool fits_V_bx = m_exceeds_x;
            bool fits_V_by;
            bool fits_V_cx;
            bool fits_V_cy = m_exceeds_y;
            if (is_jump) {
                const bool nearly_zero_x = size_x < nearly_zero_m;
                const float change_x = fabsf(first_r_2 * ((2.0f * state->first_s_x) + first_r_2));
                fits_V_ax = r_exceeds_x && (!nearly_zero_x || (change_x < small_m));
                const bool nearly_zero_y = size_y < nearly_zero_m;
                const float change_y = fabsf(first_r_1 * ((2.0f * state->first_s_y) + first_r_1));
                fits_V_ay = r_exceeds_y && (!nearly_zero_y || (change_y < small_m));
                fits_V_bx = (change_x + nearly_zero_m) < size_x;
                fits_V_by = r_exceeds_y && nearly_zero_y;
                fits_V_cx = r_exceeds_x && nearly_zero_x;
                fits_V_cy = (change_y + nearly_zero_m) < size_y;
            } else {
                const bool any_r_exceeds = r_exceeds_x || r_exceeds_y;
                fits_V_ax = any_r_exceeds || m_exceeds_x;
                fits_V_ay = any_r_exceeds || m_exceeds_y;
                fits_V_by = any_r_exceeds;
                fits_V_cx = any_r_exceeds;
            }
            const bool is_any = (max_known_yaw < fabsf(state->first_phi)) || (both_m_exceed && !is_jump) || common ||
                (first_squared <= squared_residual_limit);
            suspect_V_ax = fits_V_ax || is_any;
            suspect_V_ay = fits_V_ay || is_any;
            suspect_V_bx = fits_V_bx || is_any;
            suspect_V_by = fits_V_by || is_any;
            suspect_V_cx = fits_V_cx || is_any;
            suspect_V_cy = fits_V_cy || is_any;
        }
        other_amplitude = common && (frozen < 1u);
    }
    if (diagnostics != NULL) {
        diagnostics->suspect_V_ax = suspect_V_ax ? 1.0f : 0.0f;
        diagnostics->suspect_V_ay = suspect_V_ay ? 1.0f : 0.0f;
        diagnostics->suspect_V_bx = suspect_V_bx ? 1.0f : 0.0f;
        diagnostics->suspect_V_by = suspect_V_by ? 1.0f : 0.0f;
        diagnostics->suspect_V_cx = suspect_V_cx ? 1.0f : 0.0f;
        diagnostics->suspect_V_cy = suspect_V_cy ? 1.0f : 0.0f;
        diagnostics->other_amplitude = other_amplitude ? 1.0f : 0.0f;
    }
    return (planar_6dof_lqg_sensing_output_t){.suspect_V_ax = suspect_V_ax, .suspect_V_ay = suspect_V_ay,
        .suspect_V_bx = suspect_V_bx, .suspect_V_by = suspect_V_by, .suspect_V_cx = suspect_V_cx,
        .suspect_V_cy = suspect_V_cy, .other_amplitude = other_amplitude};
}

typedef struct {
    float z;
    float theta;
    float psi;
} planar_6dof_lqg_vertical_kinematics_t;

/* vertical_kinematics: z and tilts from distances */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_vertical_kinematics_t planar_6dof_lqg_vertical_kinematics(const
    planar_6dof_lqg_input_t *accepted, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const float half_over_laser_arm = 8.333333f;         /* 1/m; 1 / (2 laser_arm), laser_arm = 0.06 m */

    const float front_distance = 0.5f * (accepted->d1 + accepted->d2);
    const float theta = half_over_laser_arm * (accepted->d3 - front_distance);
    const float psi = half_over_laser_arm * (accepted->d1 - accepted->d2);
    if (diagnostics != NULL) {
        diagnostics->z = 0.5f * (front_distance + accepted->d3);
        diagnostics->theta = theta;
        diagnostics->psi = psi;
    }
    return (planar_6dof_lqg_vertical_kinematics_t){.z = 0.5f * (front_distance + accepted->d3), .theta = theta,
        .psi = psi};
}

typedef struct {
    float last_i_AA_next;
    float last_i_AB_next;
    float last_i_AC_next;
    float last_i_BA_next;
    float last_i_BB_next;
    float last_i_BC_next;
    float last_i_CA_next;
    float last_i_CB_next;
    float last_i_CC_next;
} planar_6dof_lqg_safe_output_latched_t;

/* safe_output: slew to the safe output once latched */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_safe_output_latched_t
    planar_6dof_lqg_safe_output_latched(planar_6dof_lqg_safe_output_state_t *state)
{
    static const float slew_step = 0.1575f;                     /* A; 126 A/s times 0.00125 s */

    state->last_i_AA = planar_6dof_lqg_slew(state->last_i_AA, 0.0f, slew_step);
    state->last_i_AB = planar_6dof_lqg_slew(state->last_i_AB, 0.0f, slew_step);
    state->last_i_AC = planar_6dof_lqg_slew(state->last_i_AC, 0.0f, slew_step);
    state->last_i_BA = planar_6dof_lqg_slew(state->last_i_BA, 0.0f, slew_step);
    state->last_i_BB = planar_6dof_lqg_slew(state->last_i_BB, 0.0f, slew_step);
    state->last_i_BC = planar_6dof_lqg_slew(state->last_i_BC, 0.0f, slew_step);
    state->last_i_CA = planar_6dof_lqg_slew(state->last_i_CA, 0.0f, slew_step);
    state->last_i_CB = planar_6dof_lqg_slew(state->last_i_CB, 0.0f, slew_step);
    state->last_i_CC = planar_6dof_lqg_slew(state->last_i_CC, 0.0f, slew_step);
    return (planar_6dof_lqg_safe_output_latched_t){.last_i_AA_next = state->last_i_AA,
        .last_i_AB_next = state->last_i_AB, .last_i_AC_next = state->last_i_AC, .last_i_BA_next = state->last_i_BA,
        .last_i_BB_next = state->last_i_BB, .last_i_BC_next = state->last_i_BC, .last_i_CA_next = state->last_i_CA,
        .last_i_CB_next = state->last_i_CB, .last_i_CC_next = state->last_i_CC};
}

typedef struct {
    float value;
    float value_2;
    float value_3;
    float information;
} planar_6dof_lqg_sensing_output_2_yaw_t;

/* yaw */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_sensing_output_2_yaw_t planar_6dof_lqg_sensing_output_2_yaw(float r_1_product,
    float X_c, float X_s, float minus_Y_c, float m_y_square, float m_y_square_2, float phi_raw, float r_2_product,
    float m_x_square, float m_x_square_2, float Y_s, float X_m, float Y_m)
{
    static const float slope_0 = 0.49650046f;                   /* 1/V^2; fit of the slope in the calculated field */
    static const float slope_1 = 0.15281738f;                   /* 1/V^4; fit of the slope in the calculated field */
    static const float amplitude_weight = 0.02322072f; /* 1/V^2; 2 W / V_0^2, W = 0.1: weight of m_x - m_y in the yaw */
    static const float least_information = 0.00021532494f;      /* V^2; 2.5e-05 V_0^2: keeps a divisor from 0 */

    const float h1 = X_c + X_s - (minus_Y_c * m_y_square * (slope_0 + (m_y_square_2 * slope_1)));
    const float value = r_1_product - (h1 * phi_raw);
    const float h2 = (X_c * m_x_square * (slope_0 + (m_x_square_2 * slope_1))) + (Y_s - minus_Y_c);
    const float value_2 = r_2_product + (h2 * phi_raw);
    const float h3 = (X_s * (Y_s + minus_Y_c)) + (Y_s * (X_s - X_c));
    return (planar_6dof_lqg_sensing_output_2_yaw_t){.value = value, .value_2 = value_2, .value_3 = (h1 * value) -
        (h2 * value_2) + (amplitude_weight * (h3 * (X_m - Y_m))), .information = (h1 * h1) + (h2 * h2) +
        (2.0f * (amplitude_weight * (h3 * h3))) + least_information};
}

/* place_x, place_y */
PLANAR_6DOF_LQG_INLINE float planar_6dof_lqg_sensing_output_2_place(float m_x_square, float m_x_square_2, float c,
    float ratio, float s)
{
    static const float position_1 = 0.009938624f;               /* m; fit of the position in the calculated field */
    static const float position_3 = -0.0075761457f;             /* m; fit of the position in the calculated field */
    static const float position_5 = 0.0061684945f;              /* m; fit of the position in the calculated field */
    static const float position_7 = -0.0021809724f;             /* m; fit of the position in the calculated field */
    static const float half_pitch = 0.0254f;                    /* m; half of the pitch */
    static const float quarter_pitch = 0.0127f;                 /* m; a quarter of the pitch */

    const float ratio_squared = ratio * ratio;
    const float f_x = ratio * (position_1 +
        (ratio_squared * (position_3 + (ratio_squared * (position_5 + (ratio_squared * position_7))))));
    float in_pitch;
    if (m_x_square <= m_x_square_2) {
        if (c < 0.0f) {
            if (0.0f < f_x) {
                in_pitch = f_x - half_pitch;
            } else {
                in_pitch = f_x + half_pitch;
            }
        } else {
            in_pitch = f_x;
        }
    } else {
        in_pitch = ((s < 0.0f) ? -quarter_pitch : quarter_pitch) - f_x;
    }
    return in_pitch;
}

/* offset_x, offset_y */
PLANAR_6DOF_LQG_INLINE float planar_6dof_lqg_sensing_output_2_offset(float in_pitch, float expected, float before)
{
    static const float half_pitch = 0.0254f;                    /* m; half of the pitch */
    static const float pitch = 0.0508f;                         /* m; pitch of the matrix */

    const float off_x = in_pitch - expected;
    float offset = before;
    if (half_pitch < fabsf(off_x)) {
        if (0.0f < off_x) {
            if (-pitch <= before) {
                offset = before - pitch;
            }
        } else {
            if (before <= pitch) {
                offset = before + pitch;
            }
        }
    }
    return offset;
}

typedef struct {
    float X_s;
    float m_x;
    float Y_s;
    float m_y;
    float r_1;
    float r_2;
    float in_pitch_x;
    float in_pitch_y;
    float offset_x;
    float offset_y;
    float measured_x;
    float measured_y;
    float measured_phi;
    float squared;
} planar_6dof_lqg_sensing_output_2_measurement_t;

/* measurement */
PLANAR_6DOF_LQG_LARGE planar_6dof_lqg_sensing_output_2_measurement_t planar_6dof_lqg_sensing_output_2_measurement(float
    scale, float V_ax_held, float phi_raw, float V_ay_held, float V_bx_held, float V_cy_held, float V_by_held, float
    V_cx_held, float expected_x, float offset_x_before, float expected_y, float offset_y_before, float x_predicted,
    float y_predicted, float phi_predicted, float innovation_phi, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const float power_0 = 7.7654033f;                    /* V^2; fit of the power in the calculated field */
    static const float power_1 = 0.11621765f;                   /* 1/V^2; fit of the power in the calculated field */
    static const float power_2 = -0.0013770753f;                /* 1/V^6; fit of the power in the calculated field */
    static const float least_square = 8.612998e-06f;            /* V^2; 1e-06 V_0^2: keeps a divisor from 0 */
    /* 1/V^2; (0.08 / (0.15 V_0))^2, V_0 = 2.93479 V: amplitude of the Hall voltages */
    static const float m_weight = 0.033025026f;
    static const float innovation_weight = 153119.95f;          /* V^2/m^2; (0.08 V_0 / 0.0006 m)^2 */
    static const float lasting = 0.8f; /* 1; part of the last innovation of the yaw that is expected again */

    const float phi_raw_times_V_ay_held = phi_raw * V_ay_held;
    const float X_s = scale * (V_ax_held - phi_raw_times_V_ay_held);
    const float X_c = scale * (phi_raw_times_V_ay_held - V_bx_held);
    const float X_s_times_X_c = X_s * X_c;
    const float X_s_squared = X_s * X_s;
    const float X_c_squared = X_c * X_c;
    const float ratio_x = X_s_times_X_c / (planar_6dof_lqg_max(X_s_squared, X_c_squared) + least_square);
    /*@ admit -1.0f <= ratio_x <= 1.0f; */
    const float in_pitch_x = planar_6dof_lqg_sensing_output_2_place(X_s_squared, X_c_squared, X_c, ratio_x, X_s);
    const float offset_x = planar_6dof_lqg_sensing_output_2_offset(in_pitch_x, expected_x, offset_x_before);
    const float measured_x = in_pitch_x + offset_x;
    const float phi_raw_times_V_ax_held = phi_raw * V_ax_held;
    const float Y_s = scale * (V_ay_held + phi_raw_times_V_ax_held);
    const float minus_Y_c = scale * (V_cy_held + phi_raw_times_V_ax_held);
    const float Y_s_times_minus_Y_c = Y_s * minus_Y_c;
    const float Y_s_squared = Y_s * Y_s;
    const float minus_Y_c_squared = minus_Y_c * minus_Y_c;
    const float ratio_y = -(Y_s_times_minus_Y_c / (planar_6dof_lqg_max(Y_s_squared, minus_Y_c_squared) + least_square));
    /*@ admit -1.0f <= ratio_y <= 1.0f; */
    const float in_pitch_y = planar_6dof_lqg_sensing_output_2_place(Y_s_squared, minus_Y_c_squared, -minus_Y_c, ratio_y,
        Y_s);
    const float offset_y = planar_6dof_lqg_sensing_output_2_offset(in_pitch_y, expected_y, offset_y_before);
    const float measured_y = in_pitch_y + offset_y;
    const float squared_product_x = X_s_times_X_c * X_s_times_X_c;
    const float m_x = X_s_squared + X_c_squared -
        (power_0 + (squared_product_x * (power_1 + (squared_product_x * power_2))));
    const float squared_product_y = Y_s_times_minus_Y_c * Y_s_times_minus_Y_c;
    const float m_y = Y_s_squared + minus_Y_c_squared -
        (power_0 + (squared_product_y * (power_1 + (squared_product_y * power_2))));
    const planar_6dof_lqg_sensing_output_2_yaw_t yaw = planar_6dof_lqg_sensing_output_2_yaw(scale * (V_by_held -
        V_ay_held), X_c, X_s, minus_Y_c, minus_Y_c_squared, Y_s_squared, phi_raw, scale * (V_cx_held - V_ax_held),
        X_c_squared, X_s_squared, Y_s, m_x, m_y);
    const float innovation_x = measured_x - x_predicted;
    const float innovation_y = measured_y - y_predicted;
    const float measured_phi = phi_raw + (yaw.value_3 / yaw.information);
    const float unexpected_yaw = measured_phi - (phi_predicted + (lasting * innovation_phi));
    if (diagnostics != NULL) {
        diagnostics->m_x = m_x;
        diagnostics->m_y = m_y;
        diagnostics->r_1 = yaw.value;
        diagnostics->r_2 = yaw.value_2;
    }
    return (planar_6dof_lqg_sensing_output_2_measurement_t){.X_s = X_s, .m_x = m_x, .Y_s = Y_s, .m_y = m_y,
        .r_1 = yaw.value, .r_2 = yaw.value_2, .in_pitch_x = in_pitch_x, .in_pitch_y = in_pitch_y, .offset_x = offset_x,
        .offset_y = offset_y, .measured_x = measured_x, .measured_y = measured_y, .measured_phi = measured_phi,
        .squared = (yaw.value * yaw.value) + (yaw.value_2 * yaw.value_2) + (m_weight * ((m_x * m_x) + (m_y * m_y))) +
        (innovation_weight * ((innovation_x * innovation_x) + (innovation_y * innovation_y))) +
        (yaw.information * (unexpected_yaw * unexpected_yaw))};
}

typedef struct {
    float x_raw;
    float y_raw;
    float phi_raw;
    float within_x;
    float within_y;
    bool measured;
} planar_6dof_lqg_sensing_output_2_t;

/* sensing: position and yaw, (1)-(5) */
PLANAR_6DOF_LQG_LARGE planar_6dof_lqg_sensing_output_2_t
    planar_6dof_lqg_sensing_output_2(planar_6dof_lqg_sensing_state_t *state, const planar_6dof_lqg_input_t *accepted,
    bool complete, uint32_t ready, float x_predicted, float y_predicted, float phi_predicted, float phi_mean,
    planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const float squared_confirmation = 0.013780796f;     /* V^2; rho = 0.5 */
    /* V^2; (0.08 V_0)^2: rho^2 is the weighted sum of the squared residuals over this */
    static const float squared_residual_limit = 0.055123184f;
    static const float max_within = 0.0274f; /* m; half of the pitch, and 0.002 m for bad samples in a row */
    static const float max_yaw = 0.025f;                        /* rad; limit of the raw yaw */
    static const uint32_t memory = 4u;                          /* 1; samples for which a contradiction is remembered */
    static const uint32_t repeats = 14u;                        /* 1; codes in a row with which a channel is frozen */
    static const uint32_t index_of_V_by = 3u;                   /* 1; among the channels, from 0 */
    static const uint32_t index_of_V_cx = 4u;                   /* 1; among the channels, from 0 */
    static const uint32_t index_of_V_cy = 5u;                   /* 1; among the channels, from 0 */
    static const uint32_t index_of_V_bx = 2u;                   /* 1; among the channels, from 0 */
    static const uint32_t code_stored = 13u;                    /* 1; repeats - 1: its first code is stored */
    static const uint32_t between_watches = 15u;                /* 1; repeats + 1: no code is compared */
    static const float scale_middle = 1.02f;                    /* 1; middle of the range of the scale, 0.84 .. 1.2 */
    static const float scale_gain = 9.658223e-05f;              /* 1/V^2; 0.003 / (4 sensing_power_0) */
    /* 1/V^2; 1 / (4 sensing_power_0): the whole error of the scale */
    static const float first_scale_gain = 0.032194078f;
    static const float scale_half_range = 0.18f;                /* 1; half of the range of the scale, 0.84 .. 1.2 */

    const float innovation_phi = state->innovation_phi;
    const float offset_x = state->offset_x;
    const float expected_x = x_predicted - offset_x;
    const float offset_y = state->offset_y;
    const float expected_y = y_predicted - offset_y;
    bool measured = false;
    float x_raw = 0.0f;
    float y_raw = 0.0f;
    float raw_yaw = 0.0f;
    float added = innovation_phi;
    float within_x = 0.0f;
    float within_y = 0.0f;
    if (complete) {
        const float scale = state->scale;
        const float phi_raw = state->phi_raw;
        const planar_6dof_lqg_sensing_output_2_measurement_t measurement =
            planar_6dof_lqg_sensing_output_2_measurement(scale, accepted->V_ax, phi_raw, accepted->V_ay, accepted->V_bx,
            accepted->V_cy, accepted->V_by, accepted->V_cx, expected_x, offset_x, expected_y, offset_y, x_predicted,
            y_predicted, phi_predicted, innovation_phi, diagnostics);
        const uint32_t contradiction_left = state->contradiction_left;
        if ((ready != 0u) && (squared_confirmation < measurement.squared) &&
                ((contradiction_left != 0u) || (squared_residual_limit < measurement.squared))) {
            added = planar_6dof_lqg_limit(phi_mean, fabsf(innovation_phi));
            state->contradiction_left = memory;
            if (contradiction_left != 0u) {
                state->contradiction_confirmed = 1u;
            } else {
                state->first_r_1 = measurement.r_1;
                state->first_r_2 = measurement.r_2;
                state->first_m_x = measurement.m_x;
                state->first_m_y = measurement.m_y;
                state->first_s_x = measurement.X_s;
                state->first_s_y = measurement.Y_s;
                state->first_phi = phi_raw;
            }
        } else {
            measured = true;
            x_raw = measurement.measured_x;
            y_raw = measurement.measured_y;
            raw_yaw = measurement.measured_phi;
            added = 0.0f;
            within_x = measurement.in_pitch_x;
            within_y = measurement.in_pitch_y;
            if (1u <= contradiction_left) {
                state->contradiction_left = contradiction_left - 1u;
            }
            const uint32_t watch_left = state->watch_left;
            if (repeats < watch_left) {
                float gain = scale_gain;
                if (ready != 0u) {
                    state->watch_left = repeats;
                } else {
                    gain = first_scale_gain;
                }
                state->scale = scale_middle + planar_6dof_lqg_limit(scale -
                    (gain * (measurement.m_x + measurement.m_y)) - scale_middle, scale_half_range);
            } else {
                const uint32_t watch_channel = state->watch_channel;
                float code = accepted->V_ax;
                uint32_t watch_channel_next = index_of_V_cy;
                if (1u <= watch_channel) {
                    code = (index_of_V_bx <= watch_channel) ? accepted->V_bx : accepted->V_ay;
                    watch_channel_next = watch_channel - 1u;
                }
                if (index_of_V_by <= watch_channel) {
                    code = (index_of_V_cx <= watch_channel) ?
                        ((index_of_V_cy <= watch_channel) ? accepted->V_cy : accepted->V_cx) : accepted->V_by;
                }
                if (repeats <= watch_left) {
                    state->watch_left = code_stored;
                    state->watch_code = code;
                } else if (fabsf(code - state->watch_code) <= 0.0f) {
                    if (watch_left <= 1u) {
                        state->contradiction_confirmed = 1u;
                        state->frozen = watch_channel + 1u;
                    } else {
                        state->watch_left = watch_left - 1u;
                    }
                } else {
                    state->watch_channel = watch_channel_next;
                    state->watch_left = between_watches;
                }
            }
            state->offset_x = measurement.offset_x;
            state->offset_y = measurement.offset_y;
        }
    }
    if (!measured) {
        const float passed_x = planar_6dof_lqg_limit(expected_x, max_within);
        x_raw = passed_x + offset_x;
        const float passed_y = planar_6dof_lqg_limit(expected_y, max_within);
        y_raw = passed_y + offset_y;
        raw_yaw = phi_predicted + added;
        within_x = passed_x;
        within_y = passed_y;
    }
    state->phi_raw = planar_6dof_lqg_limit(raw_yaw, max_yaw);
    if (diagnostics != NULL) {
        diagnostics->measured = measured ? 1.0f : 0.0f;
        diagnostics->x_raw = x_raw;
        diagnostics->y_raw = y_raw;
        diagnostics->within_x = within_x;
        diagnostics->within_y = within_y;
        diagnostics->phi_raw = state->phi_raw;
        diagnostics->saturated |= (fabsf(state->phi_raw) >= max_yaw) ? 0x00000001u : 0u;
    }
    return (planar_6dof_lqg_sensing_output_2_t){.x_raw = x_raw, .y_raw = y_raw, .phi_raw = state->phi_raw,
        .within_x = within_x, .within_y = within_y, .measured = measured};
}

/* sensing: position and yaw, (1)-(5) */
PLANAR_6DOF_LQG_INLINE void planar_6dof_lqg_sensing_update(planar_6dof_lqg_sensing_state_t *state, uint32_t ready,
    float innovation_phi)
{
    state->innovation_phi = (ready != 0u) ? innovation_phi : 0.0f;
}

typedef struct {
    float x_advance;
    float y_advance;
    float phi_advance;
} planar_6dof_lqg_reckoning_t;

/* reckoning: alpha-beta filter, dead reckoning */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_reckoning_t planar_6dof_lqg_reckoning(planar_6dof_lqg_reckoning_state_t *state,
    uint32_t ready, const planar_6dof_lqg_sensing_output_2_t *sensing_output_2, float acting_x, float innovation_phi,
    float acting_y, float acting_phi, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const float x_rate_gain = 0.0080325f;                /* 1; k_s for the same poles */
    static const float x_half_step = 9.867259e-06f; /* m/A; T^2 / 2 times the acceleration of 12.6301 m/s^2 per A */
    static const float y_rate_gain = 0.0080325f;                /* 1; k_s for the same poles */
    static const float y_half_step = 9.867259e-06f; /* m/A; T^2 / 2 times the acceleration of 12.6301 m/s^2 per A */
    static const float phi_rate_gain = 0.000225f;               /* 1; (1 - r)^2, r = 0.985 */
    /* rad/A; T^2 / 2 times the acceleration of 223.259 rad/s^2 per A */
    static const float phi_half_step = 0.00017442106f;
    /* 1; (1 - r^2) + (n + 1/2) (1 - r)^2, r = 0.985, n = 28 samples without measurement: a steady innovation is a rate
     * that is not predicted */
    static const float phi_bias_gain = 0.0361875f;
    static const float x_position_gain = 0.1494675f;            /* 1; k_p for poles 0.94, 0.94 and 0.9625 */
    static const float rate_limit = 0.0025f; /* m; 2 m/s times T: largest rate that is predicted; of x, y */
    static const float x_disturbance_gain = 6.75e-05f;          /* 1; k_h for the same poles */
    /* m; T^2 / 2 times the largest disturbance that is learnt; of x, y */
    static const float disturbance_limit = 2.5e-05f;
    static const float y_position_gain = 0.1494675f;            /* 1; k_p for poles 0.94, 0.94 and 0.9625 */
    static const float y_disturbance_gain = 6.75e-05f;          /* 1; k_h for the same poles */
    static const float phi_position_gain = 0.029775f;           /* 1; 1 - r^2, r = 0.985 */
    static const float phi_position_limit = 0.05f;              /* rad; largest position that is predicted */
    static const float phi_rate_limit = 0.05f; /* rad; 40 rad/s times T: largest rate that is predicted */
    static const float phi_mean_gain = 0.0025f;                 /* 1; 1 - r_m, r_m = 0.9975 */

    const float x_rate = state->x_rate;
    const float y_rate = state->y_rate;
    const float phi_rate = state->phi_rate;
    const float phi_mean = state->phi_mean;
    const float x_disturbance = state->x_disturbance;
    const float y_disturbance = state->y_disturbance;
    const float phi_position = state->phi_position;
    float rate_x = x_rate;
    float rate_y = y_rate;
    float rate_phi = phi_rate;
    float corrected_x = sensing_output_2->x_raw;
    float corrected_y = sensing_output_2->y_raw;
    float corrected_phi;
    if ((ready != 0u) && sensing_output_2->measured) {
        const float phi_mean_next = phi_mean + (phi_mean_gain * (innovation_phi - phi_mean));
        /*@ admit -0.075075f <= phi_mean_next <= 0.075075f; */
        state->phi_mean = phi_mean_next;
        const float x_position = state->x_position;
        const float innovation_x = sensing_output_2->x_raw - x_position;
        rate_x = x_rate + (x_rate_gain * innovation_x);
        const float y_position = state->y_position;
        const float innovation_y = sensing_output_2->y_raw - y_position;
        rate_y = y_rate + (y_rate_gain * innovation_y);
        rate_phi = phi_rate + (phi_rate_gain * innovation_phi);
        corrected_x = x_position + (x_position_gain * innovation_x);
        state->x_disturbance = planar_6dof_lqg_limit(x_disturbance + (x_disturbance_gain * innovation_x),
            disturbance_limit);
        corrected_y = y_position + (y_position_gain * innovation_y);
        state->y_disturbance = planar_6dof_lqg_limit(y_disturbance + (y_disturbance_gain * innovation_y),
            disturbance_limit);
        corrected_phi = phi_position + (phi_position_gain * innovation_phi);
    } else {
        corrected_phi = (ready != 0u) ? phi_position : sensing_output_2->phi_raw;
    }
    const float a_x = (x_half_step * acting_x) + x_disturbance;
    const float middle_x = rate_x + a_x;
    const float x_next = corrected_x + middle_x;
    /*@ admit -0.2f <= x_next <= 0.2f; */
    state->x_position = x_next;
    const float a_y = (y_half_step * acting_y) + y_disturbance;
    const float middle_y = rate_y + a_y;
    const float y_next = corrected_y + middle_y;
    /*@ admit -0.2f <= y_next <= 0.2f; */
    state->y_position = y_next;
    const float a_phi = phi_half_step * acting_phi;
    const float middle_phi = rate_phi + a_phi;
    const float phi_next = planar_6dof_lqg_limit(corrected_phi + middle_phi, phi_position_limit);
    state->phi_position = phi_next;
    const float x_advance = middle_x + a_x;
    state->x_rate = planar_6dof_lqg_limit(x_advance, rate_limit);
    const float y_advance = middle_y + a_y;
    state->y_rate = planar_6dof_lqg_limit(y_advance, rate_limit);
    const float advance_phi = middle_phi + a_phi;
    state->phi_rate = planar_6dof_lqg_limit(advance_phi, phi_rate_limit);
    if (diagnostics != NULL) {
        diagnostics->x_advance = x_advance;
        diagnostics->y_advance = y_advance;
        diagnostics->phi_advance = advance_phi + (phi_bias_gain * phi_mean);
        diagnostics->saturated |= (fabsf(phi_next) >= phi_position_limit) ? 0x00000002u : 0u;
    }
    return (planar_6dof_lqg_reckoning_t){.x_advance = x_advance, .y_advance = y_advance, .phi_advance = advance_phi +
        (phi_bias_gain * phi_mean)};
}

typedef struct {
    float error_gain;                   /* A/m; (49): k1 + k3 T */
    float largest_error;                /* m; a larger error counts as this */
    float L;                            /* A/m; (33): (k1 T + k2) L, L = (1 - p) / T */
    float achieved_gain;                /* 1; (49): T (k1 T / 2 + k2) times the acceleration of 12.6301 m/s^2 per A */
    float G;                            /* A/m; (33): (k1 T + k2) (F L + A21 - L A11) */
    float H;                            /* 1; (33): (k1 T + k2) (B2 - L B1) */
} planar_6dof_lqg_lqg_output_parameters_t;

typedef struct {
    float estimated;
    float law;
    bool is_close_raw;
} planar_6dof_lqg_lqg_output_t;

/* lqg_x, lqg_y: reduced-order LQG, (28)-(35), (49)
 * While the error of x or y is limited to largest_error the axis moves at a constant speed, and its integral only
 * decays: the integral of a ramp is a velocity, with which the axis would go on when the set-point turns back. */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_lqg_output_t planar_6dof_lqg_lqg_output(planar_6dof_lqg_lqg_state_t *state,
    const planar_6dof_lqg_lqg_output_parameters_t *parameters, float ref_held, float raw, uint32_t ready)
{
    static const float F = 0.7f;                                /* 1; (35): A22 - L A12 */

    const float seen = parameters->L * raw;
    const float now = (ready != 0u) ? state->x3 : -seen;
    const float achieved = state->achieved;
    state->x3 = (F * now) + (parameters->G * raw) + (parameters->H * achieved);
    const float ref_held_minus_raw = ref_held - raw;
    const bool is_close_raw = fabsf(ref_held_minus_raw) <= parameters->largest_error;
    const float estimated = now + seen + (parameters->achieved_gain * achieved);
    const float law_product = parameters->error_gain * ((is_close_raw) ? ref_held_minus_raw :
        ((ref_held_minus_raw < 0.0f) ? -parameters->largest_error : parameters->largest_error));
    return (planar_6dof_lqg_lqg_output_t){.estimated = estimated, .law = law_product + (state->integral - estimated),
        .is_close_raw = is_close_raw};
}

typedef struct {
    bool brakes;
    bool may_latch;
    bool is_late_x_raw;
    bool is_late_y_raw;
} planar_6dof_lqg_guard_update_t;

/* guard: range acceptance, hold, latch */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_guard_update_t planar_6dof_lqg_guard_update(uint32_t left, bool is_close_x_raw,
    bool is_close_y_raw)
{
    /* 1; of the 29, left in the sample that first sets bit 30; fewer are left in those that brake */
    static const uint32_t latch_certain_from = 25u;
    static const uint32_t may_latch_from = 2u;                  /* 1; of the 29, left in the sample before the latch */

    const bool brakes = left < latch_certain_from;
    return (planar_6dof_lqg_guard_update_t){.brakes = brakes, .may_latch = left <= may_latch_from,
        .is_late_x_raw = (brakes) ? false : !is_close_x_raw, .is_late_y_raw = (brakes) ? false : !is_close_y_raw};
}

typedef struct {
    float estimated;
    float law_phi;
} planar_6dof_lqg_lqg_phi_output_t;

/* lqg_phi: reduced-order LQG, (28)-(35), (49) */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_lqg_phi_output_t planar_6dof_lqg_lqg_phi_output(planar_6dof_lqg_lqg_state_t
    *state, float phi_ref_held, float phi_raw, uint32_t ready, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const float L = 275.96594f;                          /* A/rad; (33): (k1 T + k2) L, L = (1 - p) / T */
    /* 1; (49): T (k1 T / 2 + k2) times the acceleration of 223.259 rad/s^2 per A */
    static const float achieved_gain = 0.87617064f;
    static const float error_gain = 550.31274f;                 /* A/rad; (49): k1 + k3 T */
    static const float F = 0.9f;                                /* 1; (35): A22 - L A12 */
    static const float G = -27.596594f;                         /* A/rad; (33): (k1 T + k2) (F L + A21 - L A11) */
    static const float H = 0.9145512f;                          /* 1; (33): (k1 T + k2) (B2 - L B1) */

    const float seen = L * phi_raw;
    const float now = (ready != 0u) ? state->x3 : -seen;
    const float achieved = state->achieved;
    state->x3 = (F * now) + (G * phi_raw) + (H * achieved);
    const float estimated = now + seen + (achieved_gain * achieved);
    const float law_phi = (error_gain * (phi_ref_held - phi_raw)) + (state->integral - estimated);
    if (diagnostics != NULL) {
        diagnostics->law_phi = law_phi;
    }
    return (planar_6dof_lqg_lqg_phi_output_t){.estimated = estimated, .law_phi = law_phi};
}

typedef struct {
    float gain;                         /* A/m; (23): gain on the error */
    float lead_input;                   /* A/m; (23): gain times (lead_pole - zero) */
} planar_6dof_lqg_loop_output_parameters_t;

/* loop_z, loop_theta, loop_psi: lead-lag, (23); lead-lag, (24); lead-lag, (25) */
PLANAR_6DOF_LQG_INLINE float planar_6dof_lqg_loop_output(planar_6dof_lqg_loop_state_t *state,
    const planar_6dof_lqg_loop_output_parameters_t *parameters, float ref_held, float z_product)
{
    const float lead = state->lead;
    const float error = ref_held - z_product;
    state->lead = parameters->lead_input * error;
    return (parameters->gain * error) + lead + state->integral;
}

typedef struct {
    float begun_phi;
    float begun_x;
    float begun_y;
    float d_psi;
    float d_theta;
    float d_z;
} planar_6dof_lqg_start_t;

/* start: no demand before the first complete sample */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_start_t planar_6dof_lqg_start(bool begun, float law_phi, float law_x,
    float law_y, float law_psi, float law_theta, float law_z, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    float begun_phi = law_phi;
    float begun_x = law_x;
    float begun_y = law_y;
    float d_psi = law_psi;
    float d_theta = law_theta;
    float d_z = law_z;
    if (!begun) {
        begun_phi = 0.0f;
        begun_x = 0.0f;
        begun_y = 0.0f;
        d_psi = 0.0f;
        d_theta = 0.0f;
        d_z = 0.0f;
    }
    if (diagnostics != NULL) {
        diagnostics->begun_phi = begun_phi;
        diagnostics->begun_x = begun_x;
        diagnostics->begun_y = begun_y;
        diagnostics->d_psi = d_psi;
        diagnostics->d_theta = d_theta;
        diagnostics->d_z = d_z;
    }
    return (planar_6dof_lqg_start_t){.begun_phi = begun_phi, .begun_x = begun_x, .begun_y = begun_y, .d_psi = d_psi,
        .d_theta = d_theta, .d_z = d_z};
}

typedef struct {
    float d_phi;
    float d_x;
    float d_y;
} planar_6dof_lqg_braking_t;

/* braking: braking before the latch
 * With sound sensors the law moves x at 0.137 m/s and y at 0.30 m/s at most, by largest_error.
 * Each sample removes half of the predicted rate, within the limits of the currents. In the 23 samples before the
 * latch motor C can remove 0.206 m/s from x, whatever the yaw demands; A and B can remove up to 0.82 m/s from y,
 * less what the yaw takes. What is left of a larger speed coasts. */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_braking_t planar_6dof_lqg_braking(bool brakes, const planar_6dof_lqg_reckoning_t
    *reckoning, const planar_6dof_lqg_start_t *start, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const float phi_gain = -1433.3131f; /* A/rad; -0.5 / T^2, over the acceleration of 223.259 rad/s^2 per A */
    static const float x_gain = -25336.316f; /* A/m; -0.5 / T^2, over the acceleration of 12.6301 m/s^2 per A */
    static const float y_gain = -25336.316f; /* A/m; -0.5 / T^2, over the acceleration of 12.6301 m/s^2 per A */

    float d_phi = start->begun_phi;
    float d_x = start->begun_x;
    float d_y = start->begun_y;
    if (brakes) {
        d_phi = phi_gain * reckoning->phi_advance;
        d_x = x_gain * reckoning->x_advance;
        d_y = y_gain * reckoning->y_advance;
    }
    if (diagnostics != NULL) {
        diagnostics->d_phi = d_phi;
        diagnostics->d_x = d_x;
        diagnostics->d_y = d_y;
    }
    return (planar_6dof_lqg_braking_t){.d_phi = d_phi, .d_x = d_x, .d_y = d_y};
}

typedef struct {
    float cos_phi_raw_polynomial;
    float sin_phi_raw;
    float i_CQ;
    float i_AQ;
    float i_BQ;
    float i_AD;
    float i_BD;
    float i_CD;
    float achieved_x;
    float achieved_y;
    float achieved_phi;
    float lifts;
    float achieved_theta;
} planar_6dof_lqg_allocation_t;

/* allocation: motor currents, Table 3, (17)
 * allocation_z_share, c / (2 (b + c)), and allocation_psi_share, 1/2, make the achieved d_z and d_psi of the direct
 * currents. Factors that are 1 with these arms are left out: c / (2 a) of i_CQ in d_phi, and 2 b / c of d_z in i_CD.
 * The 2 of d_theta there stands for both motors at the front. */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_allocation_t planar_6dof_lqg_allocation(float cos_phi_raw_argument,
    const planar_6dof_lqg_braking_t *braking, float phi_raw, const planar_6dof_lqg_start_t *start, bool begun,
    float law_z, float law_theta, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const float quadrature_limit = 1.134f; /* A; largest quadrature current of a motor, 0.9 of 1.26 A */
    static const float half_quadrature_limit = 0.567f;          /* A; what the yaw leaves to motor C */
    /* A; largest direct current of a motor: both together stay below 1.26 A */
    static const float direct_limit = 0.54913455f;
    static const float two = 2.0f;                              /* 1; Table 3: both motors */
    static const float rear_share = 0.33333334f;                /* 1; c / (2 (b+c)), b = 0.0127924 m, c = 0.0255848 m */
    static const float front_share = 0.16666667f;               /* 1; b / (2 (b+c)), b = 0.0127924 m, c = 0.0255848 m */

    const float cos_phi_raw_polynomial_2 = cos_phi_raw_polynomial(cos_phi_raw_argument);
    const float sin_phi_raw = phi_raw * sin_phi_raw_polynomial(cos_phi_raw_argument);
    const float i_CQ = planar_6dof_lqg_limit((cos_phi_raw_polynomial_2 * braking->d_x) + (sin_phi_raw * braking->d_y),
        planar_6dof_lqg_max(quadrature_limit - fabsf(braking->d_phi), half_quadrature_limit));
    const float yaw_current = planar_6dof_lqg_limit(braking->d_phi + i_CQ, quadrature_limit);
    const float y_current = planar_6dof_lqg_limit(0.5f * ((cos_phi_raw_polynomial_2 * braking->d_y) -
        (sin_phi_raw * braking->d_x)), quadrature_limit - fabsf(yaw_current));
    const float front_current = start->d_z - start->d_theta;
    const float i_AD = planar_6dof_lqg_limit(front_current + start->d_psi, direct_limit);
    const float i_BD = planar_6dof_lqg_limit(front_current - start->d_psi, direct_limit);
    float rear_current = 0.0f;
    if (begun) {
        rear_current = law_z + (2.0f * law_theta);
    }
    const float i_CD = planar_6dof_lqg_limit(rear_current, direct_limit);
    const float y_currents = two * y_current;
    const float achieved_x = (cos_phi_raw_polynomial_2 * i_CQ) - (sin_phi_raw * y_currents);
    const float achieved_y = (sin_phi_raw * i_CQ) + (cos_phi_raw_polynomial_2 * y_currents);
    const float lifts = i_AD + i_BD;
    const float achieved_theta = (rear_share * i_CD) - (front_share * lifts);
    if (diagnostics != NULL) {
        diagnostics->i_CQ = i_CQ;
        diagnostics->i_AQ = y_current - yaw_current;
        diagnostics->i_BQ = y_current + yaw_current;
        diagnostics->i_AD = i_AD;
        diagnostics->i_BD = i_BD;
        diagnostics->i_CD = i_CD;
        diagnostics->achieved_x = achieved_x;
        diagnostics->achieved_y = achieved_y;
        diagnostics->achieved_phi = yaw_current - i_CQ;
        diagnostics->achieved_theta = achieved_theta;
        diagnostics->saturated |= (fabsf(i_CQ) >=
            planar_6dof_lqg_max(quadrature_limit - fabsf(braking->d_phi), half_quadrature_limit)) ? 0x00000004u : 0u;
        diagnostics->saturated |= (fabsf(i_AD) >= direct_limit) ? 0x00000008u : 0u;
        diagnostics->saturated |= (fabsf(i_BD) >= direct_limit) ? 0x00000010u : 0u;
        diagnostics->saturated |= (fabsf(i_CD) >= direct_limit) ? 0x00000020u : 0u;
    }
    return (planar_6dof_lqg_allocation_t){.cos_phi_raw_polynomial = cos_phi_raw_polynomial_2,
        .sin_phi_raw = sin_phi_raw, .i_CQ = i_CQ, .i_AQ = y_current - yaw_current, .i_BQ = y_current + yaw_current,
        .i_AD = i_AD, .i_BD = i_BD, .i_CD = i_CD, .achieved_x = achieved_x, .achieved_y = achieved_y,
        .achieved_phi = yaw_current - i_CQ, .lifts = lifts, .achieved_theta = achieved_theta};
}

typedef struct {
    float integral_decay;               /* 1; (49): 1 - k3 T / (k1 + k3 T) */
    float integral_input;               /* 1; (49): k3 T / (k1 + k3 T) */
} planar_6dof_lqg_lqg_update_parameters_t;

/* lqg_x, lqg_y: reduced-order LQG, (28)-(35), (49) */
PLANAR_6DOF_LQG_INLINE void planar_6dof_lqg_lqg_update(planar_6dof_lqg_lqg_state_t *state, const
    planar_6dof_lqg_lqg_update_parameters_t *parameters, const planar_6dof_lqg_lqg_output_t *lqg_output, float achieved)
{
    const float decayed = parameters->integral_decay * state->integral;
    if (lqg_output->is_close_raw) {
        state->integral = decayed + (parameters->integral_input * (achieved + lqg_output->estimated));
    } else {
        state->integral = decayed;
    }
    state->achieved = achieved;
}

/* lqg_phi: reduced-order LQG, (28)-(35), (49) */
PLANAR_6DOF_LQG_INLINE void planar_6dof_lqg_lqg_phi_update(planar_6dof_lqg_lqg_state_t *state, float achieved_phi,
    float estimated)
{
    static const float integral_decay = 0.9013263f;             /* 1; (49): 1 - k3 T / (k1 + k3 T) */
    static const float integral_input = 0.098673716f;           /* 1; (49): k3 T / (k1 + k3 T) */

    state->integral = (integral_decay * state->integral) + (integral_input * (achieved_phi + estimated));
    state->achieved = achieved_phi;
}

/* loop_z: lead-lag, (23) */
PLANAR_6DOF_LQG_INLINE void planar_6dof_lqg_loop_z_update(planar_6dof_lqg_loop_state_t *state,
    const planar_6dof_lqg_allocation_t *allocation)
{
    static const float integral_decay = 0.9875776f; /* 1; (23): zero of the integral action in the z-domain */
    /* 1; (23): 1 - integral_decay; times allocation_z_share */
    static const float integral_input_times_allocation_z_share = 0.004140787f;

    state->integral = (integral_decay * state->integral) +
        (integral_input_times_allocation_z_share * (allocation->lifts + allocation->i_CD));
}

/* loop_theta: lead-lag, (24) */
PLANAR_6DOF_LQG_INLINE void planar_6dof_lqg_loop_theta_update(planar_6dof_lqg_loop_state_t *state, float achieved_theta)
{
    static const float integral_decay = 0.9875776f; /* 1; (24): zero of the integral action in the z-domain */
    static const float integral_input = 0.0124223605f;          /* 1; (24): 1 - integral_decay */

    state->integral = (integral_decay * state->integral) + (integral_input * achieved_theta);
}

/* loop_psi: lead-lag, (25) */
PLANAR_6DOF_LQG_INLINE void planar_6dof_lqg_loop_psi_update(planar_6dof_lqg_loop_state_t *state,
    const planar_6dof_lqg_allocation_t *allocation)
{
    static const float integral_decay = 0.9875776f; /* 1; (25): zero of the integral action in the z-domain */
    /* 1; (25): 1 - integral_decay; times allocation_psi_share */
    static const float integral_input_times_allocation_psi_share = 0.0062111802f;

    state->integral = (integral_decay * state->integral) +
        (integral_input_times_allocation_psi_share * (allocation->i_AD - allocation->i_BD));
}

typedef struct {
    float i_AA_computed;
    float i_AB_computed;
    float i_AC_computed;
    float i_BA_computed;
    float i_BB_computed;
    float i_BC_computed;
    float i_CA_computed;
    float i_CB_computed;
    float i_CC_computed;
} planar_6dof_lqg_commutation_t;

/* commutation: phase currents, (17) inverted */
PLANAR_6DOF_LQG_LARGE planar_6dof_lqg_commutation_t planar_6dof_lqg_commutation(const planar_6dof_lqg_sensing_output_2_t
    *sensing_output_2, const planar_6dof_lqg_allocation_t *allocation, float cos_phi_raw_argument)
{
    static const float b = 0.012792384f; /* m; not printed: row z of Table 3 makes no torque about x */
    static const float quarter_pitch = 0.0127f;                 /* m; a quarter of the pitch */
    static const float minus_half = -0.5f;                      /* 1; (17): cos 120 degrees */
    static const float half_root_3 = 0.8660254f;                /* 1; sqrt(3) / 2 */
    static const float c = 0.025584769f; /* m; not printed: row x of Table 3 makes no torque about z */

    const float distance_rear = sensing_output_2->within_x - (c * allocation->sin_phi_raw);
    const float quarter_sine_rear = distance_rear * quarter_sine_polynomial(distance_rear * distance_rear);
    const float quarter_sine_rear_squared = quarter_sine_rear * quarter_sine_rear;
    const float h_rear = quarter_sine_rear * sqrtf(1.0f - quarter_sine_rear_squared);
    const float cos_C = 1.0f - (8.0f * (h_rear * h_rear));
    const float sin_C = h_rear * (4.0f - (8.0f * quarter_sine_rear_squared));
    const float i_CA_computed = (cos_C * allocation->i_CQ) - (sin_C * allocation->i_CD);
    /*@ admit -1.26f <= i_CA_computed <= 1.26f; */
    const float middle_C = minus_half * i_CA_computed;
    const float beta_C = half_root_3 * ((sin_C * allocation->i_CQ) + (cos_C * allocation->i_CD));
    const float i_CB_computed = middle_C + beta_C;
    /*@ admit -1.26f <= i_CB_computed <= 1.26f; */
    const float i_CC_computed = middle_C - beta_C;
    /*@ admit -1.26f <= i_CC_computed <= 1.26f; */
    const float distance_front = sensing_output_2->within_y -
        ((b * allocation->cos_phi_raw_polynomial) - quarter_pitch);
    const float quarter_sine_front = distance_front * quarter_sine_polynomial(distance_front * distance_front);
    const float quarter_sine_front_squared = quarter_sine_front * quarter_sine_front;
    const float h_front = quarter_sine_front * sqrtf(1.0f - quarter_sine_front_squared);
    const float sin_front = h_front * (4.0f - (8.0f * quarter_sine_front_squared));
    const float cos_aside = cosine_polynomial(cos_phi_raw_argument);
    const float cc = sin_front * cos_aside;
    const float cos_front = 1.0f - (8.0f * (h_front * h_front));
    const float sin_aside = sensing_output_2->phi_raw * sine_polynomial(cos_phi_raw_argument);
    const float cos_front_times_sin_aside = cos_front * sin_aside;
    const float cos_A = cc - cos_front_times_sin_aside;
    const float cos_front_times_cos_aside = cos_front * cos_aside;
    const float cs = sin_front * sin_aside;
    const float minus_sin_A = cos_front_times_cos_aside + cs;
    const float i_AA_computed = (cos_A * allocation->i_AQ) + (minus_sin_A * allocation->i_AD);
    /*@ admit -1.26f <= i_AA_computed <= 1.26f; */
    const float middle_A = minus_half * i_AA_computed;
    const float beta_A = half_root_3 * ((cos_A * allocation->i_AD) - (minus_sin_A * allocation->i_AQ));
    const float i_AB_computed = middle_A + beta_A;
    /*@ admit -1.26f <= i_AB_computed <= 1.26f; */
    const float i_AC_computed = middle_A - beta_A;
    /*@ admit -1.26f <= i_AC_computed <= 1.26f; */
    const float cos_B = cc + cos_front_times_sin_aside;
    const float sin_B = cs - cos_front_times_cos_aside;
    const float i_BA_computed = (cos_B * allocation->i_BQ) - (sin_B * allocation->i_BD);
    /*@ admit -1.26f <= i_BA_computed <= 1.26f; */
    const float middle_B = minus_half * i_BA_computed;
    const float beta_B = half_root_3 * ((sin_B * allocation->i_BQ) + (cos_B * allocation->i_BD));
    const float i_BB_computed = middle_B + beta_B;
    /*@ admit -1.26f <= i_BB_computed <= 1.26f; */
    const float i_BC_computed = middle_B - beta_B;
    /*@ admit -1.26f <= i_BC_computed <= 1.26f; */
    return (planar_6dof_lqg_commutation_t){.i_AA_computed = i_AA_computed, .i_AB_computed = i_AB_computed,
        .i_AC_computed = i_AC_computed, .i_BA_computed = i_BA_computed, .i_BB_computed = i_BB_computed, .i_BC_computed =
        i_BC_computed, .i_CA_computed = i_CA_computed, .i_CB_computed = i_CB_computed, .i_CC_computed = i_CC_computed};
}

/* safe_output: slew to the safe output once latched */
PLANAR_6DOF_LQG_INLINE void planar_6dof_lqg_safe_output(planar_6dof_lqg_safe_output_state_t *state, bool may_latch,
    const planar_6dof_lqg_commutation_t *commutation)
{
    if (may_latch) {
        state->last_i_AA = commutation->i_AA_computed;
        state->last_i_AB = commutation->i_AB_computed;
        state->last_i_AC = commutation->i_AC_computed;
        state->last_i_BA = commutation->i_BA_computed;
        state->last_i_BB = commutation->i_BB_computed;
        state->last_i_BC = commutation->i_BC_computed;
        state->last_i_CA = commutation->i_CA_computed;
        state->last_i_CB = commutation->i_CB_computed;
        state->last_i_CC = commutation->i_CC_computed;
    }
}

/* Each input in its range, else what is held or refused, with its bit of the fault word. */
PLANAR_6DOF_LQG_INLINE planar_6dof_lqg_input_t planar_6dof_lqg_guard_inputs(planar_6dof_lqg_state_t *state,
    const planar_6dof_lqg_input_t *in, uint32_t *faults)
{
    static const float guard_refused_V_ax = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_ay = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_bx = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_by = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_cx = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_cy = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    planar_6dof_lqg_input_t accepted;
    accepted.V_ax = planar_6dof_lqg_replace_within(in->V_ax, 5.0f, guard_refused_V_ax, 0x00000001u, faults);
    accepted.V_ay = planar_6dof_lqg_replace_within(in->V_ay, 5.0f, guard_refused_V_ay, 0x00000002u, faults);
    accepted.V_bx = planar_6dof_lqg_replace_within(in->V_bx, 5.0f, guard_refused_V_bx, 0x00000004u, faults);
    accepted.V_by = planar_6dof_lqg_replace_within(in->V_by, 5.0f, guard_refused_V_by, 0x00000008u, faults);
    accepted.V_cx = planar_6dof_lqg_replace_within(in->V_cx, 5.0f, guard_refused_V_cx, 0x00000010u, faults);
    accepted.V_cy = planar_6dof_lqg_replace_within(in->V_cy, 5.0f, guard_refused_V_cy, 0x00000020u, faults);
    accepted.d1 = planar_6dof_lqg_hold_within(in->d1, 0.0005f, &state->guard.last_d1, 0x00000040u, faults);
    accepted.d2 = planar_6dof_lqg_hold_within(in->d2, 0.0005f, &state->guard.last_d2, 0x00000080u, faults);
    accepted.d3 = planar_6dof_lqg_hold_within(in->d3, 0.0005f, &state->guard.last_d3, 0x00000100u, faults);
    accepted.x_ref = planar_6dof_lqg_hold_within(in->x_ref, 0.11f, &state->guard.last_x_ref, 0x00000200u, faults);
    accepted.y_ref = planar_6dof_lqg_hold_within(in->y_ref, 0.1f, &state->guard.last_y_ref, 0x00000400u, faults);
    accepted.phi_ref = planar_6dof_lqg_hold_within(in->phi_ref, 0.008f, &state->guard.last_phi_ref, 0x00000800u,
        faults);
    accepted.z_ref = planar_6dof_lqg_hold_within(in->z_ref, 0.0002f, &state->guard.last_z_ref, 0x00001000u, faults);
    accepted.theta_ref = planar_6dof_lqg_hold_within(in->theta_ref, 0.002f, &state->guard.last_theta_ref, 0x00002000u,
        faults);
    accepted.psi_ref = planar_6dof_lqg_hold_within(in->psi_ref, 0.002f, &state->guard.last_psi_ref, 0x00004000u,
        faults);
    return accepted;
}

/* the law: what the step computes unless it is latched */
PLANAR_6DOF_LQG_INLINE uint32_t planar_6dof_lqg_law(planar_6dof_lqg_state_t *state, uint32_t faults, const
    planar_6dof_lqg_input_t *accepted, uint32_t guard_left, uint32_t guard_ready, const planar_6dof_lqg_guard_output_t
    *guard_output, planar_6dof_lqg_output_t *out, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    static const planar_6dof_lqg_lqg_output_parameters_t lqg_x_lqg_output = {.error_gain = 1955.8091f,
        .largest_error = 0.0015f, .L = 5126.1787f, .achieved_gain = 0.319009f, .G = -1537.8536f, .H = 0.28662756f};
    static const planar_6dof_lqg_lqg_output_parameters_t lqg_y_lqg_output = {.error_gain = 1117.0514f,
        .largest_error = 0.004f, .L = 3558.6274f, .achieved_gain = 0.22358753f, .G = -1067.5883f, .H = 0.19897877f};
    static const planar_6dof_lqg_loop_output_parameters_t loop_z_loop_output = {.gain = 4023.7034f,
        .lead_input = -3537.3835f};
    static const planar_6dof_lqg_loop_output_parameters_t loop_theta_loop_output = {.gain = 427.24356f,
        .lead_input = -386.5337f};
    static const planar_6dof_lqg_loop_output_parameters_t loop_psi_loop_output = {.gain = 469.96793f,
        .lead_input = -425.18707f};
    static const planar_6dof_lqg_lqg_update_parameters_t lqg_x_lqg_update = {.integral_decay = 0.9430741f,
        .integral_input = 0.056925878f};
    static const planar_6dof_lqg_lqg_update_parameters_t lqg_y_lqg_update = {.integral_decay = 0.953085f,
        .integral_input = 0.046914965f};

    uint32_t fault_word;

    const float reckoning_phi_position = state->reckoning.phi_position;
    const planar_6dof_lqg_sensing_output_2_t sensing_output_2 = planar_6dof_lqg_sensing_output_2(&state->sensing,
        accepted, guard_output->complete, guard_ready, state->reckoning.x_position, state->reckoning.y_position,
        reckoning_phi_position, state->reckoning.phi_mean, diagnostics);
    const planar_6dof_lqg_lqg_output_t lqg_x_output = planar_6dof_lqg_lqg_output(&state->lqg_x, &lqg_x_lqg_output,
        accepted->x_ref, sensing_output_2.x_raw, guard_ready);
    const planar_6dof_lqg_lqg_output_t lqg_y_output = planar_6dof_lqg_lqg_output(&state->lqg_y, &lqg_y_lqg_output,
        accepted->y_ref, sensing_output_2.y_raw, guard_ready);
    const planar_6dof_lqg_guard_update_t guard_update = planar_6dof_lqg_guard_update(guard_left,
        lqg_x_output.is_close_raw, lqg_y_output.is_close_raw);
    uint32_t faults_before = faults;
    if (guard_update.is_late_x_raw) {
        faults_before = faults | 0x08000000u;
    }
    if (guard_update.is_late_y_raw) {
        fault_word = faults_before | 0x10000000u;
    } else {
        fault_word = faults_before;
    }
    const float innovation_phi = sensing_output_2.phi_raw - reckoning_phi_position;
    planar_6dof_lqg_sensing_update(&state->sensing, guard_ready, innovation_phi);
    const planar_6dof_lqg_reckoning_t reckoning = planar_6dof_lqg_reckoning(&state->reckoning, guard_ready,
        &sensing_output_2, state->lqg_x.achieved, innovation_phi, state->lqg_y.achieved, state->lqg_phi.achieved,
        diagnostics);
    const planar_6dof_lqg_vertical_kinematics_t vertical_kinematics = planar_6dof_lqg_vertical_kinematics(accepted,
        diagnostics);
    const planar_6dof_lqg_lqg_phi_output_t lqg_phi_output = planar_6dof_lqg_lqg_phi_output(&state->lqg_phi,
        accepted->phi_ref, sensing_output_2.phi_raw, guard_ready, diagnostics);
    const float law_z = planar_6dof_lqg_loop_output(&state->loop_z, &loop_z_loop_output, accepted->z_ref,
        vertical_kinematics.z);
    const float law_theta = planar_6dof_lqg_loop_output(&state->loop_theta, &loop_theta_loop_output,
        accepted->theta_ref, vertical_kinematics.theta);
    const float law_psi = planar_6dof_lqg_loop_output(&state->loop_psi, &loop_psi_loop_output, accepted->psi_ref,
        vertical_kinematics.psi);
    const bool begun = (guard_ready != 0u) || guard_output->complete;
    const planar_6dof_lqg_start_t start = planar_6dof_lqg_start(begun, lqg_phi_output.law_phi, lqg_x_output.law,
        lqg_y_output.law, law_psi, law_theta, law_z, diagnostics);
    const planar_6dof_lqg_braking_t braking = planar_6dof_lqg_braking(guard_update.brakes, &reckoning, &start,
        diagnostics);
    const float phi_raw_squared = sensing_output_2.phi_raw * sensing_output_2.phi_raw;
    const planar_6dof_lqg_allocation_t allocation = planar_6dof_lqg_allocation(phi_raw_squared, &braking,
        sensing_output_2.phi_raw, &start, begun, law_z, law_theta, diagnostics);
    planar_6dof_lqg_lqg_update(&state->lqg_x, &lqg_x_lqg_update, &lqg_x_output, allocation.achieved_x);
    planar_6dof_lqg_lqg_update(&state->lqg_y, &lqg_y_lqg_update, &lqg_y_output, allocation.achieved_y);
    planar_6dof_lqg_lqg_phi_update(&state->lqg_phi, allocation.achieved_phi, lqg_phi_output.estimated);
    planar_6dof_lqg_loop_z_update(&state->loop_z, &allocation);
    planar_6dof_lqg_loop_theta_update(&state->loop_theta, allocation.achieved_theta);
    planar_6dof_lqg_loop_psi_update(&state->loop_psi, &allocation);
    const planar_6dof_lqg_commutation_t commutation = planar_6dof_lqg_commutation(&sensing_output_2, &allocation,
        phi_raw_squared);
    out->i_AA = commutation.i_AA_computed;
    out->i_AB = commutation.i_AB_computed;
    out->i_AC = commutation.i_AC_computed;
    out->i_BA = commutation.i_BA_computed;
    out->i_BB = commutation.i_BB_computed;
    out->i_BC = commutation.i_BC_computed;
    out->i_CA = commutation.i_CA_computed;
    out->i_CB = commutation.i_CB_computed;
    out->i_CC = commutation.i_CC_computed;
    planar_6dof_lqg_safe_output(&state->safe_output, guard_update.may_latch, &commutation);
    if (diagnostics != NULL) {
        diagnostics->law_x = lqg_x_output.law;
        diagnostics->law_y = lqg_y_output.law;
        diagnostics->law_z = law_z;
        diagnostics->law_theta = law_theta;
        diagnostics->law_psi = law_psi;
    }
    return fault_word;
}

void planar_6dof_lqg_init(planar_6dof_lqg_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (planar_6dof_lqg_state_t){
        .guard = {.left = 29u},
        .sensing = {.watch_left = 15u, .scale = 1.0f},
    };
}

PLANAR_6DOF_LQG_INLINE uint32_t planar_6dof_lqg_body(planar_6dof_lqg_state_t *state, const planar_6dof_lqg_input_t *in,
    planar_6dof_lqg_output_t *out, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
    uint32_t faults = 0u;
    const planar_6dof_lqg_input_t accepted = planar_6dof_lqg_guard_inputs(state, in, &faults);
    const uint32_t sensing_contradiction_confirmed = state->sensing.contradiction_confirmed;
    const uint32_t guard_latched = state->guard.latched;
    const uint32_t guard_left = state->guard.left;
    const uint32_t guard_ready = state->guard.ready;
    const planar_6dof_lqg_guard_output_t guard_output = planar_6dof_lqg_guard_output(&state->guard,
        sensing_contradiction_confirmed, (faults & 0x0000003fu) == 0u, (faults & 0x000001c0u) == 0u, guard_latched);
    const planar_6dof_lqg_sensing_output_t sensing_output = planar_6dof_lqg_sensing_output(&state->sensing,
        diagnostics);
    if (sensing_contradiction_confirmed != 0u) {
        if (sensing_output.suspect_V_ax) {
            faults |= 0x00008000u;
        }
        if (sensing_output.suspect_V_ay) {
            faults |= 0x00010000u;
        }
        if (sensing_output.suspect_V_bx) {
            faults |= 0x00020000u;
        }
        if (sensing_output.suspect_V_by) {
            faults |= 0x00040000u;
        }
        if (sensing_output.suspect_V_cx) {
            faults |= 0x00080000u;
        }
        if (sensing_output.suspect_V_cy) {
            faults |= 0x00100000u;
        }
    }
    if (guard_output.latch_certain) {
        faults |= 0x40000000u;
    }
    if (sensing_output.other_amplitude) {
        faults |= 0x20000000u;
    }
    uint32_t fault_word;
    if (guard_output.latched != 0u) {
        const planar_6dof_lqg_safe_output_latched_t safe_output_latched =
            planar_6dof_lqg_safe_output_latched(&state->safe_output);
        out->i_AA = safe_output_latched.last_i_AA_next;
        out->i_AB = safe_output_latched.last_i_AB_next;
        out->i_AC = safe_output_latched.last_i_AC_next;
        out->i_BA = safe_output_latched.last_i_BA_next;
        out->i_BB = safe_output_latched.last_i_BB_next;
        out->i_BC = safe_output_latched.last_i_BC_next;
        out->i_CA = safe_output_latched.last_i_CA_next;
        out->i_CB = safe_output_latched.last_i_CB_next;
        out->i_CC = safe_output_latched.last_i_CC_next;
        state->guard.latched = 1u;
        fault_word = faults | 0x80000000u;
    } else {
        fault_word = planar_6dof_lqg_law(state, faults, &accepted, guard_left, guard_ready, &guard_output, out,
            diagnostics);
    }

    if (diagnostics != NULL) {
        diagnostics->faults = fault_word;
        if ((diagnostics->latch_cause == 0u) && ((fault_word & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = fault_word;
        }
    }
    return fault_word;
}

uint32_t planar_6dof_lqg_step(planar_6dof_lqg_state_t *state, const planar_6dof_lqg_input_t *in,
    planar_6dof_lqg_output_t *out)
{
    return planar_6dof_lqg_body(state, in, out, NULL);
}

#if defined(PLANAR_6DOF_LQG_DIAGNOSTICS)
uint32_t planar_6dof_lqg_step_diagnosed(planar_6dof_lqg_state_t *state, const planar_6dof_lqg_input_t *in,
    planar_6dof_lqg_output_t *out, planar_6dof_lqg_diagnostics_t *diagnostics)
{
    return planar_6dof_lqg_body(state, in, out, diagnostics);
}
#endif
