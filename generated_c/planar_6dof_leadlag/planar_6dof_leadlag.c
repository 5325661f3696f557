/* planar_6dof_leadlag. Generated: do not edit. */
/* A comment with `admit` states a bound that the generator has certified, for Frama-C. */
#include "planar_6dof_leadlag.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
#include <stddef.h>
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float planar_6dof_leadlag_max(float a, float b)
{
    return (a > b) ? a : b;
}

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float planar_6dof_leadlag_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline float planar_6dof_leadlag_slew(float last, float target, float step)
{
    const float highest = last + step;
    const float lowest = last - step;
    const float below = (target < highest) ? target : highest;
    return (below > lowest) ? below : lowest;
}

#if defined(__GNUC__)
#define PLANAR_6DOF_LEADLAG_INLINE static inline __attribute__((always_inline))
#else
#define PLANAR_6DOF_LEADLAG_INLINE static inline
#endif
/* Return a value in -high .. high; for another one or NaN, set its fault bit and return refused. */
PLANAR_6DOF_LEADLAG_INLINE float planar_6dof_leadlag_replace_within(float value, float high, float refused,
    uint32_t bit, uint32_t *faults)
{
    float held = value;
    if (!(fabsf(value) <= high)) {
        held = refused;
        *faults |= bit;
    }
    return held;
}

/* Return a value in -high .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
PLANAR_6DOF_LEADLAG_INLINE float planar_6dof_leadlag_hold_within(float value, float high, float *last, uint32_t bit,
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

/* cos(x); x = clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609, t = x^2; relative error at most 2.1e-07. */
static inline float cos_phi_polynomial(float t)
{
    return 0.9999998f + (t * -0.49976957f);
}

/* sin(x) / x; x = clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609, t = x^2; relative error at most
 * 1.5e-07. */
static inline float sin_phi_polynomial(float t)
{
    return 0.99999994f + (t * -0.16661468f);
}

/* quarter_sine / x; x = distance_rear, distance_front in -0.0292707086 .. 0.0292707086, t = x^2; relative error at most
 * 3.7e-06. */
static inline float quarter_sine_polynomial(float t)
{
    return 30.921078f + (t * (-4925.152f + (t * 228680.86f)));
}

/* cos(1.5822228 * sin(x)); x = clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609, t = x^2; relative error at
 * most 2.5e-06. */
static inline float cosine_polynomial(float t)
{
    return 0.99999756f + (t * -1.2480829f);
}

/* sin(1.5822228 * sin(x)) / x; x = clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609, t = x^2; relative error
 * at most 1.1e-06. */
static inline float sine_polynomial(float t)
{
    return 1.5822213f + (t * -0.9215838f);
}

typedef struct {
    float k_p;                          /* 1; (16), steady: gain on the position, in units of position */
    float k_s;                          /* 1; (16), steady: gain on the velocity, in units of position */
    float k_h;                          /* 1; (16), steady: gain on the acceleration, in units of position */
    float largest_prediction_p;         /* certified bound */
    float largest_prediction_s;         /* certified bound */
    float fastest;                      /* m; T times the speed beyond which the filter restarts */
} planar_6dof_leadlag_filter_parameters_t;

/* filter_x, filter_y, filter_phi: Kalman filter, (6)-(16); the numbers are those of filter_x
 *     e = x_raw - p
 *     now = p + k_p * e
 *     a = h + k_h * e
 *     in_bounds = guard_ready and |s + k_s * e + a| + |a| <= fastest
 *     prediction_p = limit(now + s + k_s * e + a, 0.2)
 *     prediction_s = limit(s + k_s * e + a + a, 0.00400004)
 *     prediction_h = limit(a, 0.00400004)
 *     x = now if in_bounds, else x_raw
 *     p_next = prediction_p if in_bounds, else x_raw
 *     s_next = prediction_s if in_bounds, else 0; likewise h_next */
PLANAR_6DOF_LEADLAG_INLINE float planar_6dof_leadlag_filter(planar_6dof_leadlag_filter_state_t *state,
    const planar_6dof_leadlag_filter_parameters_t *parameters, float raw, uint32_t ready)
{
    const float p = state->p;
    const float e = raw - p;
    const float a = state->h + (parameters->k_h * e);
    const float value_sum = state->s + (parameters->k_s * e) + a;
    float value = raw;
    if ((ready != 0u) && ((fabsf(value_sum) + fabsf(a)) <= parameters->fastest)) {
        const float now = p + (parameters->k_p * e);
        const float prediction_p = now + value_sum;
        /*@ admit -parameters->largest_prediction_p <= prediction_p <= parameters->largest_prediction_p; */
        state->p = prediction_p;
        const float prediction_s = value_sum + a;
        /*@ admit -parameters->largest_prediction_s <= prediction_s <= parameters->largest_prediction_s; */
        state->s = prediction_s;
        const float prediction_h = a;
        /*@ admit -parameters->largest_prediction_s <= prediction_h <= parameters->largest_prediction_s; */
        state->h = prediction_h;
        value = now;
    } else {
        state->p = raw;
        state->s = 0.0f;
        state->h = 0.0f;
    }
    return value;
}

typedef struct {
    float error;
    float law;
} planar_6dof_leadlag_loop_output_t;

/* loop_x, loop_y, loop_phi, loop_z, loop_theta, loop_psi: lead-lag, (21); lead-lag, (22); lead-lag, (23); lead-lag,
 * (24); lead-lag, (25)
 *     law_x = gain * (x_ref_held - x) + lead + integral
 *     lead_next = lead_input * (x_ref_held - x) + lead_pole * lead */
PLANAR_6DOF_LEADLAG_INLINE planar_6dof_leadlag_loop_output_t planar_6dof_leadlag_loop_output(const
    planar_6dof_leadlag_loop_state_t *state, float gain, float ref_held, float value)
{
    const float error = ref_held - value;
    return (planar_6dof_leadlag_loop_output_t){.error = error, .law = (gain * error) + state->lead + state->integral};
}

/* loop_x, loop_y, loop_phi: lead-lag, (21); lead-lag, (22) */
PLANAR_6DOF_LEADLAG_INLINE void planar_6dof_leadlag_loop_update(planar_6dof_leadlag_loop_state_t *state,
    float lead_input, float achieved, float error)
{
    static const float integral_decay = 0.9900498f; /* 1; (21): zero of the integral action in the z-domain */
    static const float integral_input = 0.0099502485f;          /* 1; (21): 1 - integral_decay */
    static const float lead_pole = 0.2753623f;                  /* 1; (21): pole of the lead filter in z */

    state->integral = (integral_decay * state->integral) + (integral_input * achieved);
    state->lead = (lead_input * error) + (lead_pole * state->lead);
}

void planar_6dof_leadlag_init(planar_6dof_leadlag_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (planar_6dof_leadlag_state_t){
        .guard_left = 29u,
        .sensing_watch_left = 15u,
        .sensing_scale = 1.0f,
    };
}

#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
uint32_t planar_6dof_leadlag_step(planar_6dof_leadlag_state_t *state, const planar_6dof_leadlag_input_t *in,
    planar_6dof_leadlag_output_t *out)
{
    return planar_6dof_leadlag_step_diagnosed(state, in, out, NULL);
}

uint32_t planar_6dof_leadlag_step_diagnosed(planar_6dof_leadlag_state_t *state, const planar_6dof_leadlag_input_t *in,
    planar_6dof_leadlag_output_t *out, planar_6dof_leadlag_diagnostics_t *diagnostics)
#else
uint32_t planar_6dof_leadlag_step(planar_6dof_leadlag_state_t *state, const planar_6dof_leadlag_input_t *in,
    planar_6dof_leadlag_output_t *out)
#endif
{
    /* 1/V^2; (0.08 / (0.15 V_0))^2, V_0 = 2.93479 V: amplitude of the Hall voltages */
    static const float m_weight = 0.033025026f;
    /* V^2; (0.08 V_0)^2: rho^2 is the weighted sum of the squared residuals over this */
    static const float squared_residual_limit = 0.055123184f;
    static const float quarter_pitch = 0.0127f;                 /* m; a quarter of the pitch */

#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
#endif
    /* guard: range acceptance, hold, latch
     *     every = 0 if left <= braking_from, else complete and ((|d1| <= 0.0005 if |d2| <= 0.0005, else 0) if
     *         |d3| <= 0.0005, else 0)
     *     final = left <= 1
     *     latched = guard_latched if every is set, else (1 if final, else guard_latched)
     *     left_next = latch_samples if every is set, else (left if final, else left - 1)
     *     ready_next = 1 if every is set, else ready */
    /* 1; of the 29, left in the first sample that brakes; from it on each one counts as bad */
    static const uint32_t braking_from = 24u;
    /* 1; of the 29, left in the sample that first sets bit 30; fewer are left in those that brake */
    static const uint32_t latch_certain_from = 25u;
    static const uint32_t may_latch_from = 2u;                  /* 1; of the 29, left in the sample before the latch */
    /* 1; 5 bad samples in a row, and 24 that count as bad whatever is measured, until it latches */
    static const uint32_t latch_samples = 29u;
    static const float guard_refused_V_ax = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_ay = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_bx = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_by = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_cx = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    static const float guard_refused_V_cy = 0.0f; /* V; in place of a refused value, in a sample that is not complete */
    uint32_t faults = 0u;
    const float V_ax_held = planar_6dof_leadlag_replace_within(in->V_ax, 5.0f, guard_refused_V_ax, 0x00000001u,
        &faults);
    const float V_ay_held = planar_6dof_leadlag_replace_within(in->V_ay, 5.0f, guard_refused_V_ay, 0x00000002u,
        &faults);
    const float V_bx_held = planar_6dof_leadlag_replace_within(in->V_bx, 5.0f, guard_refused_V_bx, 0x00000004u,
        &faults);
    const float V_by_held = planar_6dof_leadlag_replace_within(in->V_by, 5.0f, guard_refused_V_by, 0x00000008u,
        &faults);
    const float V_cx_held = planar_6dof_leadlag_replace_within(in->V_cx, 5.0f, guard_refused_V_cx, 0x00000010u,
        &faults);
    const float V_cy_held = planar_6dof_leadlag_replace_within(in->V_cy, 5.0f, guard_refused_V_cy, 0x00000020u,
        &faults);
    const float d1_held = planar_6dof_leadlag_hold_within(in->d1, 0.0005f, &state->guard_last_d1, 0x00000040u, &faults);
    const float d2_held = planar_6dof_leadlag_hold_within(in->d2, 0.0005f, &state->guard_last_d2, 0x00000080u, &faults);
    const float d3_held = planar_6dof_leadlag_hold_within(in->d3, 0.0005f, &state->guard_last_d3, 0x00000100u, &faults);
    const float x_ref_held = planar_6dof_leadlag_hold_within(in->x_ref, 0.11f, &state->guard_last_x_ref, 0x00000200u,
        &faults);
    const float y_ref_held = planar_6dof_leadlag_hold_within(in->y_ref, 0.1f, &state->guard_last_y_ref, 0x00000400u,
        &faults);
    const float phi_ref_held = planar_6dof_leadlag_hold_within(in->phi_ref, 0.008f, &state->guard_last_phi_ref,
        0x00000800u, &faults);
    const float z_ref_held = planar_6dof_leadlag_hold_within(in->z_ref, 0.0002f, &state->guard_last_z_ref, 0x00001000u,
        &faults);
    const float theta_ref_held = planar_6dof_leadlag_hold_within(in->theta_ref, 0.002f, &state->guard_last_theta_ref,
        0x00002000u, &faults);
    const float psi_ref_held = planar_6dof_leadlag_hold_within(in->psi_ref, 0.002f, &state->guard_last_psi_ref,
        0x00004000u, &faults);
    const uint32_t sensing_contradiction_confirmed = state->sensing_contradiction_confirmed;
    const uint32_t guard_left = state->guard_left;
    bool complete = false;
    bool other_amplitude = false;
    if (sensing_contradiction_confirmed != 0u) {
        /* sensing: position and yaw, (1)-(5)
         * One voltage is watched at a time, while it repeats its code: with 14 in a row it is frozen and suspected.
         * The scale is corrected between two watches alone, so that no sample has the cost of both.
         * A sample with a refused or suspected voltage takes none of the six: x, y and yaw are predicted. A torque
         * that the prediction does not know shifts the yaw by a steady innovation, so the first such sample adds the
         * last one, else the yaw would jump. The prediction goes on from there, and later samples add nothing. A
         * contradicted sample adds the mean of the innovation instead, if it is smaller, since the wrong voltage may
         * have shifted the last one. */
        static const float squared_jump = 0.12402716f;          /* V^2; rho = 1.5: a voltage jumped */
        static const float significant_r = 0.07043498f;         /* V; 0.024 V_0: a larger residual r is significant */
        static const float nearly_zero_m = 0.8612997f;          /* V^2; 0.1 V_0^2: a smaller excess m is nearly zero */
        /* V^2; 0.3 V_0^2: largest change of a squared sine voltage that is small */
        static const float small_m = 2.5838993f;
        static const float significant_m = 0.25838992f;         /* V^2; 0.03 V_0^2: a larger excess m is significant */
        static const float max_known_yaw = 0.01f;               /* rad; beyond it every voltage is suspected */
        static const uint32_t channel_V_ay = 2u;                /* 1; among the channels, from 1 */
        static const uint32_t channel_V_bx = 3u;                /* 1; among the channels, from 1 */
        static const uint32_t channel_V_by = 4u;                /* 1; among the channels, from 1 */
        static const uint32_t channel_V_cx = 5u;                /* 1; among the channels, from 1 */
        static const uint32_t channel_V_cy = 6u;                /* 1; among the channels, from 1 */
        const float sensing_first_r_2 = state->sensing_first_r_2;
        const float first_r_2_size = fabsf(sensing_first_r_2);
        const float sensing_first_r_1 = state->sensing_first_r_1;
        const float first_r_1_size = fabsf(sensing_first_r_1);
        const float sensing_first_m_x = state->sensing_first_m_x;
        const float size_x = fabsf(sensing_first_m_x);
        const bool m_exceeds_x = significant_m < size_x;
        const float sensing_first_m_y = state->sensing_first_m_y;
        const float size_y = fabsf(sensing_first_m_y);
        const bool m_exceeds_y = significant_m < size_y;
        const bool both_m_exceed_suspect_V_ax = m_exceeds_x && m_exceeds_y;
        const bool common = both_m_exceed_suspect_V_ax && (first_r_1_size <= significant_r) &&
            (first_r_2_size <= significant_r) &&
            (fabsf(sensing_first_m_x - sensing_first_m_y) < (0.25f * fabsf(sensing_first_m_x + sensing_first_m_y)));
        const uint32_t sensing_frozen = state->sensing_frozen;
        bool suspect_V_ax;
        bool suspect_V_ay;
        bool suspect_V_bx;
        bool suspect_V_by;
        bool suspect_V_cx;
        bool suspect_V_cy;
        if (sensing_frozen != 0u) {
            suspect_V_ax = sensing_frozen == 1u;
            suspect_V_ay = sensing_frozen == channel_V_ay;
            suspect_V_bx = sensing_frozen == channel_V_bx;
            suspect_V_by = sensing_frozen == channel_V_by;
            suspect_V_cx = sensing_frozen == channel_V_cx;
            suspect_V_cy = sensing_frozen == channel_V_cy;
        } else {
            const float first_squared = (sensing_first_r_1 * sensing_first_r_1) +
                (sensing_first_r_2 * sensing_first_r_2) +
                (m_weight * ((sensing_first_m_x * sensing_first_m_x) + (sensing_first_m_y * sensing_first_m_y)));
            const bool is_jump = squared_jump < first_squared;
            const bool r_exceeds_x = significant_r < first_r_2_size;
            const bool r_exceeds_y = significant_r < first_r_1_size;
            bool suspect_V_ax_test;
            bool suspect_V_ay_test;
            bool suspect_V_bx_test = m_exceeds_x;
            bool suspect_V_by_test;
            bool suspect_V_cx_test;
            bool suspect_V_cy_test = m_exceeds_y;
            if (is_jump) {
                const bool nearly_zero_x = size_x < nearly_zero_m;
                const float change_x = fabsf(sensing_first_r_2 * ((2.0f * state->sensing_first_s_x) +
                    sensing_first_r_2));
                suspect_V_ax_test = r_exceeds_x && (!nearly_zero_x || (change_x < small_m));
                const bool nearly_zero_y = size_y < nearly_zero_m;
                const float change_y = fabsf(sensing_first_r_1 * ((2.0f * state->sensing_first_s_y) +
                    sensing_first_r_1));
                suspect_V_ay_test = r_exceeds_y && (!nearly_zero_y || (change_y < small_m));
                suspect_V_bx_test = (change_x + nearly_zero_m) < size_x;
                suspect_V_by_test = r_exceeds_y && nearly_zero_y;
                suspect_V_cx_test = r_exceeds_x && nearly_zero_x;
                suspect_V_cy_test = (change_y + nearly_zero_m) < size_y;
            } else {
                const bool any_r_exceeds = r_exceeds_x || r_exceeds_y;
                suspect_V_ax_test = any_r_exceeds || m_exceeds_x;
                suspect_V_ay_test = any_r_exceeds || m_exceeds_y;
                suspect_V_by_test = any_r_exceeds;
                suspect_V_cx_test = any_r_exceeds;
            }
            const bool is_any = (max_known_yaw < fabsf(state->sensing_first_phi)) ||
                (both_m_exceed_suspect_V_ax && !is_jump) || common || (first_squared <= squared_residual_limit);
            suspect_V_ax = suspect_V_ax_test || is_any;
            suspect_V_ay = suspect_V_ay_test || is_any;
            suspect_V_bx = suspect_V_bx_test || is_any;
            suspect_V_by = suspect_V_by_test || is_any;
            suspect_V_cx = suspect_V_cx_test || is_any;
            suspect_V_cy = suspect_V_cy_test || is_any;
        }
        other_amplitude = common && (sensing_frozen < 1u);

        /* guard: range acceptance, hold, latch (continued) */
        if (suspect_V_ax) {
            faults |= 0x00008000u;
        }
        if (suspect_V_ay) {
            faults |= 0x00010000u;
        }
        if (suspect_V_bx) {
            faults |= 0x00020000u;
        }
        if (suspect_V_by) {
            faults |= 0x00040000u;
        }
        if (suspect_V_cx) {
            faults |= 0x00080000u;
        }
        if (suspect_V_cy) {
            faults |= 0x00100000u;
        }
#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
        if (diagnostics != NULL) {
            diagnostics->suspect_V_ax = suspect_V_ax ? 1.0f : 0.0f;
            diagnostics->suspect_V_ay = suspect_V_ay ? 1.0f : 0.0f;
            diagnostics->suspect_V_bx = suspect_V_bx ? 1.0f : 0.0f;
            diagnostics->suspect_V_by = suspect_V_by ? 1.0f : 0.0f;
            diagnostics->suspect_V_cx = suspect_V_cx ? 1.0f : 0.0f;
            diagnostics->suspect_V_cy = suspect_V_cy ? 1.0f : 0.0f;
        }
#endif
    } else {
        complete = (faults & 0x0000003fu) == 0u;
    }
    const uint32_t guard_latched = state->guard_latched;
    const uint32_t guard_ready = state->guard_ready;
    uint32_t latched = guard_latched;
    bool latch_certain = false;
    if ((guard_left <= braking_from) ? false : (complete && ((faults & 0x000001c0u) == 0u))) {
        state->guard_left = latch_samples;
        state->guard_ready = 1u;
    } else {
        if (guard_left <= 1u) {
            latched = 1u;
        } else {
            state->guard_left = guard_left - 1u;
        }
        latch_certain = guard_left <= latch_certain_from;
    }
    if (latch_certain) {
        faults |= 0x40000000u;
    }
    if (latched != 0u) {
        state->guard_latched = 1u;
        faults |= 0x80000000u;

        /* safe_output: slew to the safe output once latched */
        static const float slew_step = 0.126f;                  /* A; 126 A/s times 0.001 s */
        state->safe_output_last_i_AA = planar_6dof_leadlag_slew(state->safe_output_last_i_AA, 0.0f, slew_step);
        out->i_AA = state->safe_output_last_i_AA;
        state->safe_output_last_i_AB = planar_6dof_leadlag_slew(state->safe_output_last_i_AB, 0.0f, slew_step);
        out->i_AB = state->safe_output_last_i_AB;
        state->safe_output_last_i_AC = planar_6dof_leadlag_slew(state->safe_output_last_i_AC, 0.0f, slew_step);
        out->i_AC = state->safe_output_last_i_AC;
        state->safe_output_last_i_BA = planar_6dof_leadlag_slew(state->safe_output_last_i_BA, 0.0f, slew_step);
        out->i_BA = state->safe_output_last_i_BA;
        state->safe_output_last_i_BB = planar_6dof_leadlag_slew(state->safe_output_last_i_BB, 0.0f, slew_step);
        out->i_BB = state->safe_output_last_i_BB;
        state->safe_output_last_i_BC = planar_6dof_leadlag_slew(state->safe_output_last_i_BC, 0.0f, slew_step);
        out->i_BC = state->safe_output_last_i_BC;
        state->safe_output_last_i_CA = planar_6dof_leadlag_slew(state->safe_output_last_i_CA, 0.0f, slew_step);
        out->i_CA = state->safe_output_last_i_CA;
        state->safe_output_last_i_CB = planar_6dof_leadlag_slew(state->safe_output_last_i_CB, 0.0f, slew_step);
        out->i_CB = state->safe_output_last_i_CB;
        state->safe_output_last_i_CC = planar_6dof_leadlag_slew(state->safe_output_last_i_CC, 0.0f, slew_step);
        out->i_CC = state->safe_output_last_i_CC;
    } else {
        const bool brakes = guard_left < latch_certain_from;
        const bool may_latch = guard_left <= may_latch_from;

        /* vertical_kinematics: z and tilts from distances
         *     z = 0.5 * (0.5 * (d1_held + d2_held) + d3_held)
         *     theta = half_over_laser_arm * (d3_held - 0.5 * (d1_held + d2_held)) */
        static const float half_over_laser_arm = 8.333333f;     /* 1/m; 1 / (2 laser_arm), laser_arm = 0.06 m */
        const float front_distance = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (front_distance + d3_held);
        const float theta = half_over_laser_arm * (d3_held - front_distance);
        const float psi = half_over_laser_arm * (d1_held - d2_held);
        const float reckoning_x_position = state->reckoning_x_position;
        const float sensing_offset_x = state->sensing_offset_x;
        const float expected_x = reckoning_x_position - sensing_offset_x;
        const float reckoning_y_position = state->reckoning_y_position;

        /* sensing: position and yaw, (1)-(5) (continued)
         *     ratio_x = limit(X_s * X_c / (max(X_s^2, X_c^2) + least_square), 1)
         *     ratio_y = limit(-(Y_s * minus_Y_c / (max(Y_s^2, minus_Y_c^2) + least_square)), 1)
         *     suspect_V_bx = frozen == channel_V_bx if frozen is set, else (change_x + nearly_zero_m < size_x if
         *         is_jump, else m_exceeds_x) or is_any
         *     suspect_V_by = frozen == channel_V_by if frozen is set, else (r_exceeds_y and nearly_zero_y if
         *         is_jump, else any_r_exceeds) or is_any
         *     suspect_V_cx = frozen == channel_V_cx if frozen is set, else (r_exceeds_x and nearly_zero_x if
         *         is_jump, else any_r_exceeds) or is_any
         *     suspect_V_cy = frozen == channel_V_cy if frozen is set, else (change_y + nearly_zero_m < size_y if
         *         is_jump, else m_exceeds_y) or is_any
         *     m_x = X_s^2 + X_c^2 - (power_0 + (X_s * X_c)^2 * (power_1 + (X_s * X_c)^2 * power_2)); likewise m_y
         *     r_1 = scale * (V_by_held - V_ay_held) - h1 * sensing_phi_raw
         *     r_2 = scale * (V_cx_held - V_ax_held) + h2 * sensing_phi_raw */
        static const float least_square = 8.612998e-06f;        /* V^2; 1e-06 V_0^2: keeps a divisor from 0 */
        static const float half_pitch = 0.0254f;                /* m; half of the pitch */
        static const float pitch = 0.0508f;                     /* m; pitch of the matrix */
        static const float innovation_weight = 153119.95f;      /* V^2/m^2; (0.08 V_0 / 0.0006 m)^2 */
        static const float least_information = 0.00021532494f;  /* V^2; 2.5e-05 V_0^2: keeps a divisor from 0 */
        static const float lasting = 0.8f; /* 1; part of the last innovation of the yaw that is expected again */
        static const float squared_confirmation = 0.013780796f; /* V^2; rho = 0.5 */
        static const float max_within = 0.0274f; /* m; half of the pitch, and 0.002 m for bad samples in a row */
        static const float max_yaw = 0.025f;                    /* rad; limit of the raw yaw */
        static const uint32_t memory = 4u;                      /* 1; samples for which a contradiction is remembered */
        static const uint32_t repeats = 14u;                    /* 1; codes in a row with which a channel is frozen */
        static const uint32_t index_of_V_by = 3u;               /* 1; among the channels, from 0 */
        static const uint32_t index_of_V_cx = 4u;               /* 1; among the channels, from 0 */
        static const uint32_t index_of_V_cy = 5u;               /* 1; among the channels, from 0 */
        static const uint32_t index_of_V_bx = 2u;               /* 1; among the channels, from 0 */
        static const uint32_t between_watches = 15u;            /* 1; repeats + 1: no code is compared */
        static const uint32_t code_stored = 13u;                /* 1; repeats - 1: its first code is stored */
        static const float scale_middle = 1.02f;                /* 1; middle of the range of the scale, 0.84 .. 1.2 */
        static const float scale_half_range = 0.18f;            /* 1; half of the range of the scale, 0.84 .. 1.2 */
        static const float sensing_position_1 = 0.009938624f;   /* m; fit of the position in the calculated field */
        static const float sensing_position_3 = -0.0075761457f; /* m; fit of the position in the calculated field */
        static const float sensing_position_5 = 0.0061684945f;  /* m; fit of the position in the calculated field */
        static const float sensing_position_7 = -0.0021809724f; /* m; fit of the position in the calculated field */
        static const float sensing_slope_0 = 0.49650046f;       /* 1/V^2; fit of the slope in the calculated field */
        static const float sensing_slope_1 = 0.15281738f;       /* 1/V^4; fit of the slope in the calculated field */
        static const float sensing_power_0 = 7.7654033f;        /* V^2; fit of the power in the calculated field */
        static const float sensing_power_1 = 0.11621765f;       /* 1/V^2; fit of the power in the calculated field */
        static const float sensing_power_2 = -0.0013770753f;    /* 1/V^6; fit of the power in the calculated field */
        /* 1/V^2; 2 W / V_0^2, W = 0.1: weight of m_x - m_y in the yaw */
        static const float sensing_amplitude_weight = 0.02322072f;
        /* 1/V^2; 1 / (4 sensing_power_0): the whole error of the scale */
        static const float sensing_first_scale_gain = 0.032194078f;
        static const float sensing_scale_gain = 9.658223e-05f;  /* 1/V^2; 0.003 / (4 sensing_power_0) */
        const float sensing_offset_y = state->sensing_offset_y;
        const float expected_y = reckoning_y_position - sensing_offset_y;
        const uint32_t sensing_watch_left = state->sensing_watch_left;
        const float reckoning_phi_position = state->reckoning_phi_position;
        const float sensing_innovation_phi = state->sensing_innovation_phi;
        const float reckoning_phi_mean = state->reckoning_phi_mean;
        bool measured = false;
        float x_raw = 0.0f;
        float y_raw = 0.0f;
        float raw_yaw = 0.0f;
        float added = sensing_innovation_phi;
        float within_x = 0.0f;
        float within_y = 0.0f;
        if (complete) {
            const float sensing_scale = state->sensing_scale;
            const float sensing_phi_raw = state->sensing_phi_raw;
            const float phi_raw_times_V_ay = sensing_phi_raw * V_ay_held;
            const float X_s = sensing_scale * (V_ax_held - phi_raw_times_V_ay);
            const float X_c = sensing_scale * (phi_raw_times_V_ay - V_bx_held);
            const float X_s_times_X_c = X_s * X_c;
            const float X_s_squared = X_s * X_s;
            const float X_c_squared = X_c * X_c;
            const float ratio_x = X_s_times_X_c / (planar_6dof_leadlag_max(X_s_squared, X_c_squared) + least_square);
            /*@ admit -1.0f <= ratio_x <= 1.0f; */
            const float phi_raw_times_V_ax = sensing_phi_raw * V_ax_held;
            const float Y_s = sensing_scale * (V_ay_held + phi_raw_times_V_ax);
            const float minus_Y_c = sensing_scale * (V_cy_held + phi_raw_times_V_ax);
            const float Y_s_times_minus_Y_c = Y_s * minus_Y_c;
            const float Y_s_squared = Y_s * Y_s;
            const float minus_Y_c_squared = minus_Y_c * minus_Y_c;
            const float ratio_y = -(Y_s_times_minus_Y_c /
                (planar_6dof_leadlag_max(Y_s_squared, minus_Y_c_squared) + least_square));
            /*@ admit -1.0f <= ratio_y <= 1.0f; */
            const float product_m_x = X_s_times_X_c * X_s_times_X_c;
            const float m_x = X_s_squared + X_c_squared -
                (sensing_power_0 + (product_m_x * (sensing_power_1 + (product_m_x * sensing_power_2))));
            const float product_m_y = Y_s_times_minus_Y_c * Y_s_times_minus_Y_c;
            const float m_y = Y_s_squared + minus_Y_c_squared -
                (sensing_power_0 + (product_m_y * (sensing_power_1 + (product_m_y * sensing_power_2))));
            const float h1 = X_c + X_s -
                (minus_Y_c * minus_Y_c_squared * (sensing_slope_0 + (Y_s_squared * sensing_slope_1)));
            const float r_1 = (sensing_scale * (V_by_held - V_ay_held)) - (h1 * sensing_phi_raw);
            const float h2 = (X_c * X_c_squared * (sensing_slope_0 + (X_s_squared * sensing_slope_1))) +
                (Y_s - minus_Y_c);
            const float r_2 = (sensing_scale * (V_cx_held - V_ax_held)) + (h2 * sensing_phi_raw);
            const float ratio_x_squared = ratio_x * ratio_x;
            const float f_x = ratio_x * (sensing_position_1 + (ratio_x_squared * (sensing_position_3 +
                (ratio_x_squared * (sensing_position_5 + (ratio_x_squared * sensing_position_7))))));
            float in_pitch_x;
            if (X_s_squared <= X_c_squared) {
                if (X_c < 0.0f) {
                    if (0.0f < f_x) {
                        in_pitch_x = f_x - half_pitch;
                    } else {
                        in_pitch_x = f_x + half_pitch;
                    }
                } else {
                    in_pitch_x = f_x;
                }
            } else {
                in_pitch_x = ((X_s < 0.0f) ? -quarter_pitch : quarter_pitch) - f_x;
            }
            const float off_x = in_pitch_x - expected_x;
            float offset_x = sensing_offset_x;
            if (half_pitch < fabsf(off_x)) {
                if (0.0f < off_x) {
                    if (-pitch <= sensing_offset_x) {
                        offset_x = sensing_offset_x - pitch;
                    }
                } else {
                    if (sensing_offset_x <= pitch) {
                        offset_x = sensing_offset_x + pitch;
                    }
                }
            }
            const float measured_x = in_pitch_x + offset_x;
            const float innovation_x = measured_x - reckoning_x_position;
            const float ratio_y_squared = ratio_y * ratio_y;
            const float f_y = ratio_y * (sensing_position_1 + (ratio_y_squared * (sensing_position_3 +
                (ratio_y_squared * (sensing_position_5 + (ratio_y_squared * sensing_position_7))))));
            float in_pitch_y;
            if (Y_s_squared <= minus_Y_c_squared) {
                if (-minus_Y_c < 0.0f) {
                    if (0.0f < f_y) {
                        in_pitch_y = f_y - half_pitch;
                    } else {
                        in_pitch_y = f_y + half_pitch;
                    }
                } else {
                    in_pitch_y = f_y;
                }
            } else {
                in_pitch_y = ((Y_s < 0.0f) ? -quarter_pitch : quarter_pitch) - f_y;
            }
            const float off_y = in_pitch_y - expected_y;
            float offset_y = sensing_offset_y;
            if (half_pitch < fabsf(off_y)) {
                if (0.0f < off_y) {
                    if (-pitch <= sensing_offset_y) {
                        offset_y = sensing_offset_y - pitch;
                    }
                } else {
                    if (sensing_offset_y <= pitch) {
                        offset_y = sensing_offset_y + pitch;
                    }
                }
            }
            const float measured_y = in_pitch_y + offset_y;
            const float innovation_y = measured_y - reckoning_y_position;
            const float h3 = (X_s * (Y_s + minus_Y_c)) + (Y_s * (X_s - X_c));
            const float information = (h1 * h1) + (h2 * h2) + (2.0f * (sensing_amplitude_weight * (h3 * h3))) +
                least_information;
            const float measured_phi = sensing_phi_raw +
                (((h1 * r_1) - (h2 * r_2) + (sensing_amplitude_weight * (h3 * (m_x - m_y)))) / information);
            const float unexpected_yaw = measured_phi - (reckoning_phi_position + (lasting * sensing_innovation_phi));
            const float squared = (r_1 * r_1) + (r_2 * r_2) + (m_weight * ((m_x * m_x) + (m_y * m_y))) +
                (innovation_weight * ((innovation_x * innovation_x) + (innovation_y * innovation_y))) +
                (information * (unexpected_yaw * unexpected_yaw));
            const uint32_t sensing_contradiction_left = state->sensing_contradiction_left;
            if ((guard_ready != 0u) && (squared_confirmation < squared) &&
                    ((sensing_contradiction_left != 0u) || (squared_residual_limit < squared))) {
                state->sensing_contradiction_left = memory;
                added = planar_6dof_leadlag_limit(reckoning_phi_mean, fabsf(sensing_innovation_phi));
                if (sensing_contradiction_left != 0u) {
                    state->sensing_contradiction_confirmed = 1u;
                } else {
                    state->sensing_first_m_x = m_x;
                    state->sensing_first_m_y = m_y;
                    state->sensing_first_r_1 = r_1;
                    state->sensing_first_r_2 = r_2;
                    state->sensing_first_s_x = X_s;
                    state->sensing_first_s_y = Y_s;
                    state->sensing_first_phi = sensing_phi_raw;
                }
            } else {
                measured = true;
                x_raw = measured_x;
                y_raw = measured_y;
                raw_yaw = measured_phi;
                added = 0.0f;
                within_x = in_pitch_x;
                within_y = in_pitch_y;
                if (1u <= sensing_contradiction_left) {
                    state->sensing_contradiction_left = sensing_contradiction_left - 1u;
                }
                if (repeats < sensing_watch_left) {
                    state->sensing_watch_left = (guard_ready != 0u) ? repeats : sensing_watch_left;
                    const float sensing_scale_sum = sensing_scale - (((guard_ready != 0u) ? sensing_scale_gain :
                        sensing_first_scale_gain) * (m_x + m_y)) - scale_middle;
                    state->sensing_scale = scale_middle +
                        planar_6dof_leadlag_limit(sensing_scale_sum, scale_half_range);
                } else {
                    const uint32_t sensing_watch_channel = state->sensing_watch_channel;
                    float code = V_ax_held;
                    uint32_t other = index_of_V_cy;
                    if (1u <= sensing_watch_channel) {
                        code = (index_of_V_bx <= sensing_watch_channel) ? V_bx_held : V_ay_held;
                        other = sensing_watch_channel - 1u;
                    }
                    if (index_of_V_by <= sensing_watch_channel) {
                        code = (index_of_V_cx <= sensing_watch_channel) ?
                            ((index_of_V_cy <= sensing_watch_channel) ? V_cy_held : V_cx_held) : V_by_held;
                    }
                    if (repeats <= sensing_watch_left) {
                        state->sensing_watch_left = code_stored;
                        state->sensing_watch_code = code;
                    } else if (fabsf(code - state->sensing_watch_code) <= 0.0f) {
                        if (sensing_watch_left <= 1u) {
                            state->sensing_contradiction_confirmed = 1u;
                            state->sensing_frozen = sensing_watch_channel + 1u;
                        } else {
                            state->sensing_watch_left = sensing_watch_left - 1u;
                        }
                    } else {
                        state->sensing_watch_channel = other;
                        state->sensing_watch_left = between_watches;
                    }
                }
                state->sensing_offset_x = offset_x;
                state->sensing_offset_y = offset_y;
            }
#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
            if (diagnostics != NULL) {
                diagnostics->m_x = m_x;
                diagnostics->m_y = m_y;
                diagnostics->r_1 = r_1;
                diagnostics->r_2 = r_2;
            }
#endif
        }
        if (!measured) {
            const float passed_x = planar_6dof_leadlag_limit(expected_x, max_within);
            x_raw = passed_x + sensing_offset_x;
            const float passed_y = planar_6dof_leadlag_limit(expected_y, max_within);
            y_raw = passed_y + sensing_offset_y;
            raw_yaw = reckoning_phi_position + added;
            within_x = passed_x;
            within_y = passed_y;
        }
        const float phi_raw = planar_6dof_leadlag_limit(raw_yaw, max_yaw);
        state->sensing_phi_raw = phi_raw;

        /* functions above: filter */
        static const planar_6dof_leadlag_filter_parameters_t filter_x_filter = {.k_p = 0.110377386f,
            .k_s = 0.006452916f, .k_h = 9.431981e-05f, .largest_prediction_p = 0.2f,
            .largest_prediction_s = 0.00400004f, .fastest = 0.004f};
        static const planar_6dof_leadlag_filter_parameters_t filter_y_filter = {.k_p = 0.110377386f,
            .k_s = 0.006452916f, .k_h = 9.431981e-05f, .largest_prediction_p = 0.2f,
            .largest_prediction_s = 0.00400004f, .fastest = 0.004f};
        static const planar_6dof_leadlag_filter_parameters_t filter_phi_filter = {.k_p = 0.30911008f,
            .k_s = 0.05698819f, .k_h = 0.0026284785f, .largest_prediction_p = 0.05f,
            .largest_prediction_s = 0.00700007f, .fastest = 0.007f};
        const float x = planar_6dof_leadlag_filter(&state->filter_x, &filter_x_filter, x_raw, guard_ready);
        const float y = planar_6dof_leadlag_filter(&state->filter_y, &filter_y_filter, y_raw, guard_ready);
        const float phi = planar_6dof_leadlag_filter(&state->filter_phi, &filter_phi_filter, phi_raw, guard_ready);

        /* reckoning: alpha-beta filter, dead reckoning
         *     corrects_x_y_phi = guard_ready and measured
         *     innovation_x = x_raw - x_position; likewise innovation_phi, innovation_y
         *     a_x = x_half_step * delay_x + x_disturbance; likewise a_y
         *     middle_x = (x_rate + x_rate_gain * innovation_x if corrects_x_y_phi, else x_rate) + a_x; likewise
         *         middle_y, middle_phi
         *     a_phi = phi_half_step * delay_phi
         *     advance_phi = middle_phi + a_phi; likewise x_advance, y_advance
         *     phi_advance = advance_phi + phi_bias_gain * phi_mean
         *     x_disturbance_next = limit(x_disturbance + x_disturbance_gain * innovation_x, disturbance_limit) if
         *         corrects_x_y_phi, else x_disturbance; likewise y_disturbance_next
         *     phi_rate_next = limit(advance_phi, phi_rate_limit) */
        static const float phi_position_limit = 0.05f;          /* rad; largest position that is predicted */
        static const float rate_limit = 0.002f; /* m; 2 m/s times T: largest rate that is predicted; of x, y */
        /* m; T^2 / 2 times the largest disturbance that is learnt; of x, y */
        static const float disturbance_limit = 1.6e-05f;
        static const float phi_rate_limit = 0.04f; /* rad; 40 rad/s times T: largest rate that is predicted */
        static const float reckoning_x_position_gain = 0.10817843f; /* 1; k_p for poles 0.952, 0.952 and 0.984 */
        static const float reckoning_x_rate_gain = 0.003821568f; /* 1; k_s for the same poles */
        /* m/A; T^2 / 2 times the acceleration of 12.6301 m/s^2 per A */
        static const float reckoning_x_half_step = 6.315046e-06f;
        static const float reckoning_x_disturbance_gain = 1.8432e-05f; /* 1; k_h for the same poles */
        static const float reckoning_y_position_gain = 0.10817843f; /* 1; k_p for poles 0.952, 0.952 and 0.984 */
        static const float reckoning_y_rate_gain = 0.003821568f; /* 1; k_s for the same poles */
        /* m/A; T^2 / 2 times the acceleration of 12.6301 m/s^2 per A */
        static const float reckoning_y_half_step = 6.315046e-06f;
        static const float reckoning_y_disturbance_gain = 1.8432e-05f; /* 1; k_h for the same poles */
        static const float reckoning_phi_position_gain = 0.015936f; /* 1; 1 - r^2, r = 0.992 */
        static const float reckoning_phi_rate_gain = 6.4e-05f;  /* 1; (1 - r)^2, r = 0.992 */
        /* rad/A; T^2 / 2 times the acceleration of 223.259 rad/s^2 per A */
        static const float reckoning_phi_half_step = 0.00011162948f;
        static const float reckoning_phi_mean_gain = 0.0025f;   /* 1; 1 - r_m, r_m = 0.9975 */
        const float innovation_phi = phi_raw - reckoning_phi_position;
        const float reckoning_x_rate = state->reckoning_x_rate;
        const float reckoning_y_rate = state->reckoning_y_rate;
        const float reckoning_phi_rate = state->reckoning_phi_rate;
        const float reckoning_x_disturbance = state->reckoning_x_disturbance;
        const float reckoning_y_disturbance = state->reckoning_y_disturbance;
        float corrected_x = x_raw;
        float rate_x = reckoning_x_rate;
        float corrected_y = y_raw;
        float rate_y = reckoning_y_rate;
        float corrected_phi = (guard_ready != 0u) ? reckoning_phi_position : phi_raw;
        float rate_phi = reckoning_phi_rate;
        if ((guard_ready != 0u) && measured) {
            const float phi_mean_next = reckoning_phi_mean +
                (reckoning_phi_mean_gain * (innovation_phi - reckoning_phi_mean));
            /*@ admit -0.075075f <= phi_mean_next <= 0.075075f; */
            const float innovation_x_2 = x_raw - reckoning_x_position;
            state->reckoning_x_disturbance = planar_6dof_leadlag_limit(reckoning_x_disturbance +
                (reckoning_x_disturbance_gain * innovation_x_2), disturbance_limit);
            const float innovation_y_2 = y_raw - reckoning_y_position;
            state->reckoning_y_disturbance = planar_6dof_leadlag_limit(reckoning_y_disturbance +
                (reckoning_y_disturbance_gain * innovation_y_2), disturbance_limit);
            state->reckoning_phi_mean = phi_mean_next;
            corrected_x = reckoning_x_position + (reckoning_x_position_gain * innovation_x_2);
            rate_x = reckoning_x_rate + (reckoning_x_rate_gain * innovation_x_2);
            corrected_y = reckoning_y_position + (reckoning_y_position_gain * innovation_y_2);
            rate_y = reckoning_y_rate + (reckoning_y_rate_gain * innovation_y_2);
            corrected_phi = reckoning_phi_position + (reckoning_phi_position_gain * innovation_phi);
            rate_phi = reckoning_phi_rate + (reckoning_phi_rate_gain * innovation_phi);
        }
        const float a_x = (reckoning_x_half_step * state->delay_x) + reckoning_x_disturbance;
        const float middle_x = rate_x + a_x;
        const float x_next = corrected_x + middle_x;
        /*@ admit -0.2f <= x_next <= 0.2f; */
        const float x_advance = middle_x + a_x;
        const float a_y = (reckoning_y_half_step * state->delay_y) + reckoning_y_disturbance;
        const float middle_y = rate_y + a_y;
        const float y_next = corrected_y + middle_y;
        /*@ admit -0.2f <= y_next <= 0.2f; */
        const float y_advance = middle_y + a_y;
        const float a_phi = reckoning_phi_half_step * state->delay_phi;
        const float middle_phi = rate_phi + a_phi;
        const float phi_next = planar_6dof_leadlag_limit(corrected_phi + middle_phi, phi_position_limit);
        state->reckoning_x_position = x_next;
        state->reckoning_x_rate = planar_6dof_leadlag_limit(x_advance, rate_limit);
        state->reckoning_y_position = y_next;
        state->reckoning_y_rate = planar_6dof_leadlag_limit(y_advance, rate_limit);
        state->reckoning_phi_position = phi_next;
        const float advance_phi = middle_phi + a_phi;
        state->reckoning_phi_rate = planar_6dof_leadlag_limit(advance_phi, phi_rate_limit);
        state->sensing_innovation_phi = (guard_ready != 0u) ? innovation_phi : 0.0f;

        /* functions above: loop_output */
        static const float loop_x_gain = 2515.072f;             /* A/m; (21): gain on the error */
        static const float loop_y_gain = 2515.072f;             /* A/m; (21): gain on the error */
        static const float loop_phi_gain = 312.6659f;           /* A/rad; (22): gain on the error */
        static const float loop_z_gain = 4962.6665f;            /* A/m; (23): gain on the error */
        static const float loop_z_lead_input = -4476.951f;      /* A/m; (23): gain times (lead_pole - zero) */
        static const float loop_theta_gain = 528.30865f;        /* A/rad; (24): gain on the error */
        static const float loop_theta_lead_input = -487.64932f; /* A/rad; (24): gain times (lead_pole - zero) */
        static const float loop_psi_gain = 581.13947f;          /* A/rad; (25): gain on the error */
        static const float loop_psi_lead_input = -536.41425f;   /* A/rad; (25): gain times (lead_pole - zero) */
        const planar_6dof_leadlag_loop_output_t loop_z_output = planar_6dof_leadlag_loop_output(&state->loop_z,
            loop_z_gain, z_ref_held, z);
        state->loop_z.lead = loop_z_lead_input * loop_z_output.error;
        const planar_6dof_leadlag_loop_output_t loop_theta_output = planar_6dof_leadlag_loop_output(&state->loop_theta,
            loop_theta_gain, theta_ref_held, theta);
        state->loop_theta.lead = loop_theta_lead_input * loop_theta_output.error;
        const planar_6dof_leadlag_loop_output_t loop_psi_output = planar_6dof_leadlag_loop_output(&state->loop_psi,
            loop_psi_gain, psi_ref_held, psi);
        state->loop_psi.lead = loop_psi_lead_input * loop_psi_output.error;
        const planar_6dof_leadlag_loop_output_t loop_x_output = planar_6dof_leadlag_loop_output(&state->loop_x,
            loop_x_gain, x_ref_held, x);
        const planar_6dof_leadlag_loop_output_t loop_y_output = planar_6dof_leadlag_loop_output(&state->loop_y,
            loop_y_gain, y_ref_held, y);
        const planar_6dof_leadlag_loop_output_t loop_phi_output = planar_6dof_leadlag_loop_output(&state->loop_phi,
            loop_phi_gain, phi_ref_held, phi);

        /* start: no demand before the first complete sample
         *     begun = guard_ready or complete
         *     begun_phi = law_phi if begun, else 0; likewise begun_x, begun_y
         *     d_psi = law_psi if begun, else 0; likewise d_theta, d_z */
        /* 1; (1 - r^2) + (n + 1/2) (1 - r)^2, r = 0.992, n = 28 samples without measurement: a steady innovation is a
         * rate that is not predicted */
        static const float reckoning_phi_bias_gain = 0.01776f;
        float begun_phi = 0.0f;
        float begun_x = 0.0f;
        float begun_y = 0.0f;
        float d_psi = 0.0f;
        float d_theta = 0.0f;
        float d_z = 0.0f;
        float rear_current = 0.0f;
        if ((guard_ready != 0u) || complete) {
            begun_x = loop_x_output.law;
            begun_y = loop_y_output.law;
            begun_phi = loop_phi_output.law;
            d_z = loop_z_output.law;
            d_theta = loop_theta_output.law;
            rear_current = loop_z_output.law + (2.0f * loop_theta_output.law);
            d_psi = loop_psi_output.law;
#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
            if (diagnostics != NULL) {
                diagnostics->law_x = loop_x_output.law;
                diagnostics->law_y = loop_y_output.law;
                diagnostics->law_phi = loop_phi_output.law;
                diagnostics->law_z = loop_z_output.law;
                diagnostics->law_theta = loop_theta_output.law;
                diagnostics->law_psi = loop_psi_output.law;
            }
#endif
        }
        float d_phi = begun_phi;
        float d_x = begun_x;
        float d_y = begun_y;
        if (brakes) {
            const float phi_advance = advance_phi + (reckoning_phi_bias_gain * reckoning_phi_mean);

            /* braking: braking before the latch
             * Each sample removes half of the predicted rate, within the limits of the currents. In the 23 samples
             * before the latch motor C can remove 0.165 m/s from x, whatever the yaw demands; A and B can remove up
             * to 0.66 m/s from y, less what the yaw takes. What is left of a larger speed coasts.
             *     d_phi = phi_gain * phi_advance if brakes, else begun_phi; likewise d_x, d_y */
            /* A/m; -0.5 / T^2, over the acceleration of 12.6301 m/s^2 per A */
            static const float braking_x_gain = -39587.992f;
            /* A/m; -0.5 / T^2, over the acceleration of 12.6301 m/s^2 per A */
            static const float braking_y_gain = -39587.992f;
            /* A/rad; -0.5 / T^2, over the acceleration of 223.259 rad/s^2 per A */
            static const float braking_phi_gain = -2239.5518f;
            d_phi = braking_phi_gain * phi_advance;
            d_x = braking_x_gain * x_advance;
            d_y = braking_y_gain * y_advance;
#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
            if (diagnostics != NULL) {
                diagnostics->phi_advance = phi_advance;
            }
#endif
        }

        /* allocation: motor currents, Table 3, (17)
         * allocation_z_share, c / (2 (b + c)), and allocation_psi_share, 1/2, make the achieved d_z and d_psi of the
         * direct currents. Factors that are 1 with these arms are left out: c / (2 a) of i_CQ in d_phi, and 2 b / c
         * of d_z in i_CD. The 2 of d_theta there stands for both motors at the front.
         *     limit_c = max(quadrature_limit - |d_phi|, half_quadrature_limit)
         *     yaw_current = limit(d_phi + i_CQ, quadrature_limit)
         *     limit_y = quadrature_limit - |yaw_current|
         *     y_current = limit(0.5 * (cos(phi) * d_y - sin(phi) * d_x), limit_y)
         *     y_currents = two * y_current
         *     lifts = i_AD + i_BD
         *     i_AQ = y_current - yaw_current
         *     i_BQ = y_current + yaw_current
         *     i_CQ = limit(cos(phi) * d_x + sin(phi) * d_y, limit_c)
         *     i_CD = limit(law_z + 2 * law_theta if guard_ready or complete, else 0, direct_limit)
         *     achieved_x = cos(phi) * i_CQ - sin(phi) * y_currents
         *     achieved_y = sin(phi) * i_CQ + cos(phi) * y_currents
         *     achieved_theta = rear_share * i_CD - front_share * lifts */
        static const float quadrature_limit = 1.134f; /* A; largest quadrature current of a motor, 0.9 of 1.26 A */
        static const float half_quadrature_limit = 0.567f;      /* A; what the yaw leaves to motor C */
        /* A; largest direct current of a motor: both together stay below 1.26 A */
        static const float direct_limit = 0.54913455f;
        /* 1; (24): zero of the integral action in the z-domain */
        static const float loop_theta_integral_decay = 0.9900498f;
        static const float loop_theta_integral_input = 0.0099502485f; /* 1; (24): 1 - integral_decay */
        static const float allocation_two = 2.0f;               /* 1; Table 3: both motors */
        static const float allocation_rear_share = 0.33333334f; /* 1; c / (2 (b+c)), b = 0.0127924 m, c = 0.0255848 m */
        /* 1; b / (2 (b+c)), b = 0.0127924 m, c = 0.0255848 m */
        static const float allocation_front_share = 0.16666667f;
        const float cos_phi_argument = phi * phi;
        const float cos_2 = cos_phi_polynomial(cos_phi_argument);
        const float sin_2 = phi * sin_phi_polynomial(cos_phi_argument);
        const float i_CQ = planar_6dof_leadlag_limit((cos_2 * d_x) + (sin_2 * d_y),
            planar_6dof_leadlag_max(quadrature_limit - fabsf(d_phi), half_quadrature_limit));
        const float yaw_current = planar_6dof_leadlag_limit(d_phi + i_CQ, quadrature_limit);
        const float y_current = planar_6dof_leadlag_limit(0.5f * ((cos_2 * d_y) - (sin_2 * d_x)), quadrature_limit -
            fabsf(yaw_current));
        const float i_AQ = y_current - yaw_current;
        const float i_BQ = y_current + yaw_current;
        const float front_current = d_z - d_theta;
        const float i_AD = planar_6dof_leadlag_limit(front_current + d_psi, direct_limit);
        const float i_BD = planar_6dof_leadlag_limit(front_current - d_psi, direct_limit);
        const float i_CD = planar_6dof_leadlag_limit(rear_current, direct_limit);
        const float y_currents = allocation_two * y_current;
        const float achieved_x = (cos_2 * i_CQ) - (sin_2 * y_currents);
        const float achieved_y = (sin_2 * i_CQ) + (cos_2 * y_currents);
        const float achieved_phi = yaw_current - i_CQ;
        const float lifts = i_AD + i_BD;
        const float achieved_theta = (allocation_rear_share * i_CD) - (allocation_front_share * lifts);
        state->loop_theta.integral = (loop_theta_integral_decay * state->loop_theta.integral) +
            (loop_theta_integral_input * achieved_theta);

        /* delay: delay of one sample
         *     x_next = achieved_x; likewise y_next, phi_next */
        state->delay_x = achieved_x;
        state->delay_y = achieved_y;
        state->delay_phi = achieved_phi;

        /* functions above: loop_update */
        static const float loop_x_lead_input = -1799.755f;      /* A/m; (21): gain times (lead_pole - zero) */
        static const float loop_y_lead_input = -1799.755f;      /* A/m; (21): gain times (lead_pole - zero) */
        static const float loop_phi_lead_input = -223.97475f;   /* A/rad; (22): gain times (lead_pole - zero) */
        /* 1; (23): zero of the integral action in the z-domain */
        static const float loop_z_integral_decay = 0.9900498f;
        /* 1; (25): zero of the integral action in the z-domain */
        static const float loop_psi_integral_decay = 0.9900498f;
        /* 1; (23): 1 - integral_decay; times allocation_z_share */
        static const float loop_z_integral_input_times_allocation_z_share = 0.0033167496f;
        /* 1; (25): 1 - integral_decay; times allocation_psi_share */
        static const float loop_psi_integral_input_times_allocation_psi_share = 0.0049751243f;
        state->loop_z.integral = (loop_z_integral_decay * state->loop_z.integral) +
            (loop_z_integral_input_times_allocation_z_share * (lifts + i_CD));
        state->loop_psi.integral = (loop_psi_integral_decay * state->loop_psi.integral) +
            (loop_psi_integral_input_times_allocation_psi_share * (i_AD - i_BD));
        planar_6dof_leadlag_loop_update(&state->loop_x, loop_x_lead_input, achieved_x, loop_x_output.error);
        planar_6dof_leadlag_loop_update(&state->loop_y, loop_y_lead_input, achieved_y, loop_y_output.error);
        planar_6dof_leadlag_loop_update(&state->loop_phi, loop_phi_lead_input, achieved_phi, loop_phi_output.error);

        /* commutation: phase currents, (17) inverted
         *     distance_rear = within_x - c * sin(phi)
         *     quarter_sine_rear = sin(30.9212 * distance_rear); likewise quarter_sine_front
         *     distance_front = within_y - (b * cos(phi) - quarter_pitch)
         *     i_AA_computed = limit(angles_A_1 * i_AQ + minus_angles_A_2 * i_AD, 1.26)
         *     i_BA_computed = limit(angles_B_1 * i_BQ - angles_B_2 * i_BD, 1.26)
         *     i_CA_computed = limit((1 - 8 * (quarter_sine_rear * sqrt(1 - quarter_sine_rear^2))^2) * i_CQ -
         *         quarter_sine_rear * sqrt(1 - quarter_sine_rear^2) * (4 - 8 * quarter_sine_rear^2) * i_CD, 1.26) */
        static const float c = 0.025584769f; /* m; not printed: row x of Table 3 makes no torque about z */
        static const float b = 0.012792384f; /* m; not printed: row z of Table 3 makes no torque about x */
        static const float half_root_3 = 0.8660254f;            /* 1; sqrt(3) / 2 */
        static const float commutation_minus_half = -0.5f;      /* 1; (17): cos 120 degrees */
        const float distance_rear = within_x - (c * sin_2);
        const float quarter_sine_rear = distance_rear * quarter_sine_polynomial(distance_rear * distance_rear);
        const float distance_front = within_y - ((b * cos_2) - quarter_pitch);
        const float quarter_sine_front = distance_front * quarter_sine_polynomial(distance_front * distance_front);
        const float quarter_sine_front_squared = quarter_sine_front * quarter_sine_front;
        const float h_i_AA_computed = quarter_sine_front * sqrtf(1.0f - quarter_sine_front_squared);
        const float front_1 = h_i_AA_computed * (4.0f - (8.0f * quarter_sine_front_squared));
        const float cos_aside = cosine_polynomial(cos_phi_argument);
        const float cc = front_1 * cos_aside;
        const float cosine = 1.0f - (8.0f * (h_i_AA_computed * h_i_AA_computed));
        const float sin_aside = phi * sine_polynomial(cos_phi_argument);
        const float cosine_times_sin_aside = cosine * sin_aside;
        const float angles_A_1 = cc - cosine_times_sin_aside;
        const float cosine_times_cos_aside = cosine * cos_aside;
        const float cs = front_1 * sin_aside;
        const float minus_angles_A_2 = cosine_times_cos_aside + cs;
        const float i_AA_computed = (angles_A_1 * i_AQ) + (minus_angles_A_2 * i_AD);
        /*@ admit -1.26f <= i_AA_computed <= 1.26f; */
        const float middle_A = commutation_minus_half * i_AA_computed;
        const float beta_A = half_root_3 * ((angles_A_1 * i_AD) - (minus_angles_A_2 * i_AQ));
        const float i_AB_computed = middle_A + beta_A;
        /*@ admit -1.26f <= i_AB_computed <= 1.26f; */
        const float i_AC_computed = middle_A - beta_A;
        /*@ admit -1.26f <= i_AC_computed <= 1.26f; */
        const float angles_B_1 = cc + cosine_times_sin_aside;
        const float angles_B_2 = cs - cosine_times_cos_aside;
        const float i_BA_computed = (angles_B_1 * i_BQ) - (angles_B_2 * i_BD);
        /*@ admit -1.26f <= i_BA_computed <= 1.26f; */
        const float middle_B = commutation_minus_half * i_BA_computed;
        const float beta_B = half_root_3 * ((angles_B_2 * i_BQ) + (angles_B_1 * i_BD));
        const float i_BB_computed = middle_B + beta_B;
        /*@ admit -1.26f <= i_BB_computed <= 1.26f; */
        const float i_BC_computed = middle_B - beta_B;
        /*@ admit -1.26f <= i_BC_computed <= 1.26f; */
        const float quarter_sine_rear_squared = quarter_sine_rear * quarter_sine_rear;
        const float h_i_CA_computed = quarter_sine_rear * sqrtf(1.0f - quarter_sine_rear_squared);
        const float cos_3 = 1.0f - (8.0f * (h_i_CA_computed * h_i_CA_computed));
        const float sin_3 = h_i_CA_computed * (4.0f - (8.0f * quarter_sine_rear_squared));
        const float i_CA_computed = (cos_3 * i_CQ) - (sin_3 * i_CD);
        /*@ admit -1.26f <= i_CA_computed <= 1.26f; */
        const float middle_C = commutation_minus_half * i_CA_computed;
        const float beta_C = half_root_3 * ((sin_3 * i_CQ) + (cos_3 * i_CD));
        const float i_CB_computed = middle_C + beta_C;
        /*@ admit -1.26f <= i_CB_computed <= 1.26f; */
        const float i_CC_computed = middle_C - beta_C;
        /*@ admit -1.26f <= i_CC_computed <= 1.26f; */
        out->i_AA = i_AA_computed;
        out->i_AB = i_AB_computed;
        out->i_AC = i_AC_computed;
        out->i_BA = i_BA_computed;
        out->i_BB = i_BB_computed;
        out->i_BC = i_BC_computed;
        out->i_CA = i_CA_computed;
        out->i_CB = i_CB_computed;
        out->i_CC = i_CC_computed;
        if (may_latch) {
            /* next states of the sections above */
            state->safe_output_last_i_AA = i_AA_computed;
            state->safe_output_last_i_AB = i_AB_computed;
            state->safe_output_last_i_AC = i_AC_computed;
            state->safe_output_last_i_BA = i_BA_computed;
            state->safe_output_last_i_BB = i_BB_computed;
            state->safe_output_last_i_BC = i_BC_computed;
            state->safe_output_last_i_CA = i_CA_computed;
            state->safe_output_last_i_CB = i_CB_computed;
            state->safe_output_last_i_CC = i_CC_computed;
        }
#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
        if (diagnostics != NULL) {
            diagnostics->z = z;
            diagnostics->theta = theta;
            diagnostics->psi = psi;
            diagnostics->measured = measured ? 1.0f : 0.0f;
            diagnostics->x_raw = x_raw;
            diagnostics->y_raw = y_raw;
            diagnostics->within_x = within_x;
            diagnostics->within_y = within_y;
            diagnostics->phi_raw = phi_raw;
            diagnostics->x = x;
            diagnostics->y = y;
            diagnostics->phi = phi;
            diagnostics->x_advance = x_advance;
            diagnostics->y_advance = y_advance;
            diagnostics->begun_phi = begun_phi;
            diagnostics->begun_x = begun_x;
            diagnostics->begun_y = begun_y;
            diagnostics->d_psi = d_psi;
            diagnostics->d_theta = d_theta;
            diagnostics->d_z = d_z;
            diagnostics->d_phi = d_phi;
            diagnostics->d_x = d_x;
            diagnostics->d_y = d_y;
            diagnostics->i_CQ = i_CQ;
            diagnostics->i_AQ = i_AQ;
            diagnostics->i_BQ = i_BQ;
            diagnostics->i_AD = i_AD;
            diagnostics->i_BD = i_BD;
            diagnostics->i_CD = i_CD;
            diagnostics->achieved_x = achieved_x;
            diagnostics->achieved_y = achieved_y;
            diagnostics->achieved_phi = achieved_phi;
            diagnostics->achieved_theta = achieved_theta;
            diagnostics->saturated |= (fabsf(phi_raw) >= max_yaw) ? 0x00000001u : 0u;
            diagnostics->saturated |= (fabsf(phi_next) >= phi_position_limit) ? 0x00000002u : 0u;
            diagnostics->saturated |= (fabsf(i_CQ) >=
                planar_6dof_leadlag_max(quadrature_limit - fabsf(d_phi), half_quadrature_limit)) ? 0x00000004u : 0u;
            diagnostics->saturated |= (fabsf(i_AD) >= direct_limit) ? 0x00000008u : 0u;
            diagnostics->saturated |= (fabsf(i_BD) >= direct_limit) ? 0x00000010u : 0u;
            diagnostics->saturated |= (fabsf(i_CD) >= direct_limit) ? 0x00000020u : 0u;
        }
#endif
    }
    if (other_amplitude) {
        faults |= 0x20000000u;
    }
#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->other_amplitude = other_amplitude ? 1.0f : 0.0f;
        diagnostics->faults = faults;
        if ((diagnostics->latch_cause == 0u) && ((faults & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = faults;
        }
    }
#endif
    return faults;
}
