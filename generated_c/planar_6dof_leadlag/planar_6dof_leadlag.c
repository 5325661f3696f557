/* planar_6dof_leadlag. Generated: do not edit. */
#include "planar_6dof_leadlag.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float planar_6dof_leadlag_min(float a, float b)
{
    return (a < b) ? a : b;
}

static inline float planar_6dof_leadlag_max(float a, float b)
{
    return (a > b) ? a : b;
}

static inline float planar_6dof_leadlag_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline float planar_6dof_leadlag_slew(float last, float target, float step)
{
    const float below = (target < (last + step)) ? target : (last + step);
    return (below > (last - step)) ? below : (last - step);
}

#if defined(__GNUC__)
#define PLANAR_6DOF_LEADLAG_INLINE static inline __attribute__((always_inline))
#else
#define PLANAR_6DOF_LEADLAG_INLINE static inline
#endif
/* Return a value in -high .. high; for any other, set its fault bit and return refused. */
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

/* Return a value in -high .. high, which `last` becomes; for any other, set its fault bit and return *last. */
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

/* f1_polynomial; x = clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609, t = x^2; relative error at most
 * 2.1e-07. */
static inline float f1_polynomial(float t)
{
    return 0.9999998f + (t * -0.49976957f);
}

/* f2_polynomial / x; x = clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609, t = x^2; relative error at most
 * 1.5e-07. */
static inline float f2_polynomial(float t)
{
    return 0.99999994f + (t * -0.16661468f);
}

/* quarter_sine_rear / x; x = distance_rear in -0.0272707082 .. 0.0272707082, t = x^2; relative error at most 2.5e-06.
 * */
static inline float quarter_sine_rear_polynomial(float t)
{
    return 30.921116f + (t * (-4925.7046f + (t * 229584.3f)));
}

/* quarter_sine_front / x; x = distance_front in -0.0254923999 .. 0.0253418665, t = x^2; relative error at most 1.7e-06.
 * */
static inline float quarter_sine_front_polynomial(float t)
{
    return 30.92114f + (t * (-4926.108f + (t * 230339.45f)));
}

/* f5_polynomial; x = clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609, t = x^2; relative error at most
 * 2.5e-06. */
static inline float f5_polynomial(float t)
{
    return 0.99999756f + (t * -1.2480829f);
}

/* f6_polynomial / x; x = clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609, t = x^2; relative error at most
 * 1.1e-06. */
static inline float f6_polynomial(float t)
{
    return 1.5822213f + (t * -0.9215838f);
}

typedef struct {
    float k_p;                          /* 1; (16), steady: gain on the position, in units of position */
    float k_s;                          /* 1; (16), steady: gain on the velocity, in units of position */
    float k_h;                          /* 1; (16), steady: gain on the acceleration, in units of position */
    float high;
} planar_6dof_leadlag_filter_parameters_t;

/* filter_phi, filter_x, filter_y: Kalman filter, (6)-(16) */
PLANAR_6DOF_LEADLAG_INLINE float planar_6dof_leadlag_filter(planar_6dof_leadlag_filter_state_t *state,
    const planar_6dof_leadlag_filter_parameters_t *parameters, uint32_t ready, float raw)
{
    const float p = state->p;
    const float raw_minus_p = raw - p;
    const float value_part = p + (parameters->k_p * raw_minus_p);
    const float value_part_2 = state->h + (parameters->k_h * raw_minus_p);
    const float value_part_3 = state->s + (parameters->k_s * raw_minus_p) + value_part_2;
    const float value_part_4 = value_part + value_part_3;
    const float value_part_5 = value_part_3 + value_part_2;
    float value_part_6 = value_part;
    if ((ready != 0u) && (fabsf(value_part_4) <= parameters->high) && (fabsf(value_part_5) <= parameters->high) && (fabsf(value_part_2) <= parameters->high)) {
        state->p = value_part_4;
        state->s = value_part_5;
        state->h = value_part_2;
    } else {
        value_part_6 = raw;
        state->p = raw;
        state->s = 0.0f;
        state->h = 0.0f;
    }
    return value_part_6;
}

typedef struct {
    float ref_held_minus_value;
    float d;
} planar_6dof_leadlag_loop_output_t;

/* loop_x, loop_y, loop_phi, loop_z, loop_theta, loop_psi: lead-lag, (21); lead-lag, (22); lead-lag, (23); lead-lag,
 * (24); lead-lag, (25) */
PLANAR_6DOF_LEADLAG_INLINE planar_6dof_leadlag_loop_output_t planar_6dof_leadlag_loop_output(const planar_6dof_leadlag_loop_state_t *state,
    float gain, float ref_held, float value)
{
    const float ref_held_minus_value = ref_held - value;
    return (planar_6dof_leadlag_loop_output_t){.ref_held_minus_value = ref_held_minus_value, .d = (gain * ref_held_minus_value) + state->lead + state->integral};
}

/* loop_x, loop_y, loop_phi: lead-lag, (21); lead-lag, (22) */
PLANAR_6DOF_LEADLAG_INLINE void planar_6dof_leadlag_loop_update(planar_6dof_leadlag_loop_state_t *state,
    float lead_input, float achieved, float value)
{
    static const float integral_decay = 0.9900498f;             /* 1; (21): zero of the integral action in z */
    static const float integral_input = 0.0099502485f;          /* 1; (21): 1 - integral_decay */
    static const float lead_pole = 0.2753623f;                  /* 1; (21): pole of the lead filter in z */

    state->integral = (integral_decay * state->integral) + (integral_input * achieved);
    state->lead = (lead_input * value) + (lead_pole * state->lead);
}

void planar_6dof_leadlag_init(planar_6dof_leadlag_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (planar_6dof_leadlag_state_t){
        .guard_left = 5u,
        .sensing_power = 1.0f,
    };
}

uint32_t planar_6dof_leadlag_step(planar_6dof_leadlag_state_t *state, const planar_6dof_leadlag_input_t *in, planar_6dof_leadlag_output_t *out)
{
    static const float guard_refused_V_ax = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_ay = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_bx = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_by = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_cx = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_cy = 0.0f;               /* V; in place of a refused value */
    static const float sensing_position_1 = 0.009938624f;       /* m; fit of the position in the calculated field */
    static const float sensing_position_3 = -0.0075761457f;     /* m; fit of the position in the calculated field */
    static const float sensing_position_5 = 0.0061684945f;      /* m; fit of the position in the calculated field */
    static const float sensing_position_7 = -0.0021809724f;     /* m; fit of the position in the calculated field */
    static const float sensing_slope_0 = 0.49650046f;           /* 1/V^2; fit of the slope in the calculated field */
    static const float sensing_slope_1 = 0.15281738f;           /* 1/V^4; fit of the slope in the calculated field */
    static const float sensing_power_0 = 7.7654033f;            /* V^2; fit of the power in the calculated field */
    static const float sensing_power_1 = 0.11621765f;           /* 1/V^2; fit of the power in the calculated field */
    static const float sensing_power_2 = -0.0013770753f;        /* 1/V^6; fit of the power in the calculated field */
    static const float sensing_amplitude_weight = 0.02322072f;  /* 1/V^2; 2 W / A^2 */
    static const float sensing_first_power_gain = 0.064388156f; /* 1/V^2; 1 / (2 g_0 A^2) */
    static const float sensing_power_gain = 6.438816e-05f;      /* 1/V^2; 0.001 / (2 g_0 A^2) */
    static const float loop_x_gain = 2515.072f;                 /* A/m; (21): gain on the error */
    static const float loop_x_lead_input = -1799.755f;          /* A/m; (21): gain times (lead_pole - zero) */
    static const float loop_y_gain = 2515.072f;                 /* A/m; (21): gain on the error */
    static const float loop_y_lead_input = -1799.755f;          /* A/m; (21): gain times (lead_pole - zero) */
    static const float loop_phi_gain = 312.6659f;               /* A/rad; (22): gain on the error */
    static const float loop_phi_lead_input = -223.97475f;       /* A/rad; (22): gain times (lead_pole - zero) */
    static const float loop_z_gain = 4962.6665f;                /* A/m; (23): gain on the error */
    static const float loop_z_lead_input = -4476.951f;          /* A/m; (23): gain times (lead_pole - zero) */
    static const float loop_z_integral_decay = 0.9900498f;      /* 1; (23): zero of the integral action in z */
    static const float loop_theta_gain = 528.30865f;            /* A/rad; (24): gain on the error */
    static const float loop_theta_lead_input = -487.64932f;     /* A/rad; (24): gain times (lead_pole - zero) */
    static const float loop_theta_integral_decay = 0.9900498f;  /* 1; (24): zero of the integral action in z */
    static const float loop_theta_integral_input = 0.0099502485f; /* 1; (24): 1 - integral_decay */
    static const float loop_psi_gain = 581.13947f;              /* A/rad; (25): gain on the error */
    static const float loop_psi_lead_input = -536.41425f;       /* A/rad; (25): gain times (lead_pole - zero) */
    static const float loop_psi_integral_decay = 0.9900498f;    /* 1; (25): zero of the integral action in z */
    static const float allocation_rear_share = 0.33333334f;     /* 1; Table 3: c/(2 (b + c)) */
    static const float allocation_front_share = 0.16666667f;    /* 1; Table 3: b/(2 (b + c)) */
    /* 1 1; (23): 1 - integral_decay; times allocation_rear_share */
    static const float loop_z_integral_input_x_allocation_rear_share = 0.0033167496f;
    /* 1 1; (25): 1 - integral_decay; times allocation_half */
    static const float loop_psi_integral_input_x_allocation_half = 0.0049751243f;
    static const planar_6dof_leadlag_filter_parameters_t filter_phi_filter = {0.30911008f, 0.05698819f, 0.0026284785f,
        0.05f};
    static const planar_6dof_leadlag_filter_parameters_t filter_x_filter = {0.110377386f, 0.006452916f, 9.431981e-05f,
        0.2f};
    static const planar_6dof_leadlag_filter_parameters_t filter_y_filter = {0.110377386f, 0.006452916f, 9.431981e-05f,
        0.2f};

    /* guard: range acceptance, hold, latch */
    uint32_t faults = 0u;
    const float V_ax_held = planar_6dof_leadlag_replace_within(in->V_ax, 5.0f, guard_refused_V_ax, 0x00000001u, &faults);
    const float V_ay_held = planar_6dof_leadlag_replace_within(in->V_ay, 5.0f, guard_refused_V_ay, 0x00000002u, &faults);
    const float V_bx_held = planar_6dof_leadlag_replace_within(in->V_bx, 5.0f, guard_refused_V_bx, 0x00000004u, &faults);
    const float V_by_held = planar_6dof_leadlag_replace_within(in->V_by, 5.0f, guard_refused_V_by, 0x00000008u, &faults);
    const float V_cx_held = planar_6dof_leadlag_replace_within(in->V_cx, 5.0f, guard_refused_V_cx, 0x00000010u, &faults);
    const float V_cy_held = planar_6dof_leadlag_replace_within(in->V_cy, 5.0f, guard_refused_V_cy, 0x00000020u, &faults);
    const float d1_held = planar_6dof_leadlag_hold_within(in->d1, 0.0005f, &state->guard_last_d1, 0x00000040u, &faults);
    const float d2_held = planar_6dof_leadlag_hold_within(in->d2, 0.0005f, &state->guard_last_d2, 0x00000080u, &faults);
    const float d3_held = planar_6dof_leadlag_hold_within(in->d3, 0.0005f, &state->guard_last_d3, 0x00000100u, &faults);
    const float x_ref_held = planar_6dof_leadlag_hold_within(in->x_ref, 0.11f, &state->guard_last_x_ref, 0x00000200u, &faults);
    const float y_ref_held = planar_6dof_leadlag_hold_within(in->y_ref, 0.1f, &state->guard_last_y_ref, 0x00000400u, &faults);
    const float phi_ref_held = planar_6dof_leadlag_hold_within(in->phi_ref, 0.008f, &state->guard_last_phi_ref, 0x00000800u, &faults);
    const float z_ref_held = planar_6dof_leadlag_hold_within(in->z_ref, 0.0002f, &state->guard_last_z_ref, 0x00001000u, &faults);
    const float theta_ref_held = planar_6dof_leadlag_hold_within(in->theta_ref, 0.002f, &state->guard_last_theta_ref, 0x00002000u, &faults);
    const float psi_ref_held = planar_6dof_leadlag_hold_within(in->psi_ref, 0.002f, &state->guard_last_psi_ref, 0x00004000u, &faults);

    /* sensing: position and yaw, (1)-(5) */
    const uint32_t sensing_contradiction_confirmed = state->sensing_contradiction_confirmed;

    /* guard: range acceptance, hold, latch */
    const float sensing_first_r_1 = state->sensing_first_r_1;
    const float sensing_first_r_2 = state->sensing_first_r_2;
    const float sensing_first_m_x = state->sensing_first_m_x;
    const float sensing_first_m_y = state->sensing_first_m_y;
    const float sensing_first_m_x_size = fabsf(sensing_first_m_x);
    const bool suspect_V_ax_test = 0.25838992f < sensing_first_m_x_size;
    const bool suspect_V_ax_test_2 = 0.07043498f < fabsf(sensing_first_r_2);
    const bool suspect_V_ax_test_3 = 0.07043498f < fabsf(sensing_first_r_1);
    const bool suspect_V_ax_test_4 = suspect_V_ax_test_2 || suspect_V_ax_test_3;
    const float sensing_first_m_y_size = fabsf(sensing_first_m_y);
    const bool suspect_V_ax_test_5 = 0.25838992f < sensing_first_m_y_size;
    const bool suspect_V_ax_test_6 = suspect_V_ax_test && suspect_V_ax_test_5;
    const bool suspect_V_ax_test_7 = suspect_V_ax_test_6 && (fabsf(sensing_first_m_x - sensing_first_m_y) < (0.25f * fabsf(sensing_first_m_x + sensing_first_m_y))) && !suspect_V_ax_test_4;
    bool complete = false;
    if (sensing_contradiction_confirmed != 0u) {
        /* sensing: position and yaw, (1)-(5) */
        const float suspect_V_ax_part = (sensing_first_r_1 * sensing_first_r_1) + (sensing_first_r_2 * sensing_first_r_2) + (0.033025026f * ((sensing_first_m_x * sensing_first_m_x) + (sensing_first_m_y * sensing_first_m_y)));
        const bool suspect_V_ax_test_8 = 0.12402716f < suspect_V_ax_part;
        bool suspect_V_ax_test_9;
        bool suspect_V_ay_test;
        bool suspect_V_bx_test = suspect_V_ax_test;
        bool suspect_V_by_test = suspect_V_ax_test_4;
        bool suspect_V_cx_test = suspect_V_ax_test_4;
        bool suspect_V_cy_test = suspect_V_ax_test_5;
        if (suspect_V_ax_test_8) {
            const bool suspect_V_ax_test_10 = sensing_first_m_x_size < 0.8612997f;
            const float suspect_V_ax_part_2 = fabsf(sensing_first_r_2 * ((2.0f * state->sensing_first_s_x) + sensing_first_r_2));
            suspect_V_ax_test_9 = suspect_V_ax_test_2 && (!suspect_V_ax_test_10 || (suspect_V_ax_part_2 < 2.5838993f));
            const bool suspect_V_ay_test_2 = sensing_first_m_y_size < 0.8612997f;
            const float suspect_V_ay_part = fabsf(sensing_first_r_1 * ((2.0f * state->sensing_first_s_y) + sensing_first_r_1));
            suspect_V_ay_test = suspect_V_ax_test_3 && (!suspect_V_ay_test_2 || (suspect_V_ay_part < 2.5838993f));
            suspect_V_bx_test = (suspect_V_ax_part_2 + 0.8612997f) < sensing_first_m_x_size;
            suspect_V_by_test = suspect_V_ax_test_3 && suspect_V_ay_test_2;
            suspect_V_cx_test = suspect_V_ax_test_2 && suspect_V_ax_test_10;
            suspect_V_cy_test = (suspect_V_ay_part + 0.8612997f) < sensing_first_m_y_size;
        } else {
            suspect_V_ax_test_9 = suspect_V_ax_test_4 || suspect_V_ax_test;
            suspect_V_ay_test = suspect_V_ax_test_4 || suspect_V_ax_test_5;
        }
        const bool suspect_V_ax_test_11 = (0.01f < fabsf(state->sensing_first_phi)) || (suspect_V_ax_test_6 && !suspect_V_ax_test_8);
        const bool suspect_V_ax_test_12 = !suspect_V_ax_test_7;
        const bool suspect_V_ax = (suspect_V_ax_test_9 || suspect_V_ax_test_11) && suspect_V_ax_test_12;
        const bool suspect_V_ay = (suspect_V_ay_test || suspect_V_ax_test_11) && suspect_V_ax_test_12;
        const bool suspect_V_bx = (suspect_V_bx_test || suspect_V_ax_test_11) && suspect_V_ax_test_12;
        const bool suspect_V_by = (suspect_V_by_test || suspect_V_ax_test_11) && suspect_V_ax_test_12;
        const bool suspect_V_cx = (suspect_V_cx_test || suspect_V_ax_test_11) && suspect_V_ax_test_12;
        const bool suspect_V_cy = (suspect_V_cy_test || suspect_V_ax_test_11) && suspect_V_ax_test_12;
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
    } else {
        complete = (faults & 0x0000003fu) == 0u;
    }
    const uint32_t guard_latched = state->guard_latched;
    const uint32_t guard_ready = state->guard_ready;
    uint32_t latched = guard_latched;
    if (complete && ((faults & 0x000001c0u) == 0u)) {
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

    /* safe_output: slew to the safe output once latched */
    if (latched != 0u) {
        state->safe_output_last_i_AA = planar_6dof_leadlag_slew(state->safe_output_last_i_AA, 0.0f, 0.126f);
        out->i_AA = state->safe_output_last_i_AA;
        state->safe_output_last_i_AB = planar_6dof_leadlag_slew(state->safe_output_last_i_AB, 0.0f, 0.126f);
        out->i_AB = state->safe_output_last_i_AB;
        state->safe_output_last_i_AC = planar_6dof_leadlag_slew(state->safe_output_last_i_AC, 0.0f, 0.126f);
        out->i_AC = state->safe_output_last_i_AC;
        state->safe_output_last_i_BA = planar_6dof_leadlag_slew(state->safe_output_last_i_BA, 0.0f, 0.126f);
        out->i_BA = state->safe_output_last_i_BA;
        state->safe_output_last_i_BB = planar_6dof_leadlag_slew(state->safe_output_last_i_BB, 0.0f, 0.126f);
        out->i_BB = state->safe_output_last_i_BB;
        state->safe_output_last_i_BC = planar_6dof_leadlag_slew(state->safe_output_last_i_BC, 0.0f, 0.126f);
        out->i_BC = state->safe_output_last_i_BC;
        state->safe_output_last_i_CA = planar_6dof_leadlag_slew(state->safe_output_last_i_CA, 0.0f, 0.126f);
        out->i_CA = state->safe_output_last_i_CA;
        state->safe_output_last_i_CB = planar_6dof_leadlag_slew(state->safe_output_last_i_CB, 0.0f, 0.126f);
        out->i_CB = state->safe_output_last_i_CB;
        state->safe_output_last_i_CC = planar_6dof_leadlag_slew(state->safe_output_last_i_CC, 0.0f, 0.126f);
        out->i_CC = state->safe_output_last_i_CC;

        /* guard: range acceptance, hold, latch */
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* filter_phi: Kalman filter, (6)-(16) */
        const float filter_phi_p = state->filter_phi.p;

        /* filter_x: Kalman filter, (6)-(16) */
        const float filter_x_p = state->filter_x.p;

        /* sensing: position and yaw, (1)-(5) */
        const float filter_phi_p_times_V_ay = filter_phi_p * V_ay_held;
        const float ratio_x_part = filter_phi_p_times_V_ay - V_bx_held;
        const float sensing_first_s_x_next = V_ax_held - filter_phi_p_times_V_ay;
        const float filter_phi_p_times_V_ax = filter_phi_p * V_ax_held;
        const float ratio_y_part = V_cy_held + filter_phi_p_times_V_ax;
        const float ratio_y_part_squared = ratio_y_part * ratio_y_part;
        const float sensing_first_s_y_next = V_ay_held + filter_phi_p_times_V_ax;
        const float ratio_y_part_2 = sensing_first_s_y_next * sensing_first_s_y_next;
        const float r_1_part = ratio_x_part + sensing_first_s_x_next - (ratio_y_part * ratio_y_part_squared * (sensing_slope_0 + (ratio_y_part_2 * sensing_slope_1)));
        const float r_1 = V_by_held - V_ay_held - (r_1_part * filter_phi_p);
        const float ratio_x_part_squared = ratio_x_part * ratio_x_part;
        const float ratio_x_part_2 = sensing_first_s_x_next * sensing_first_s_x_next;
        const float r_2_part = (ratio_x_part * ratio_x_part_squared * (sensing_slope_0 + (ratio_x_part_2 * sensing_slope_1))) + (sensing_first_s_y_next - ratio_y_part);
        const float r_2 = V_cx_held - V_ax_held + (r_2_part * filter_phi_p);
        const float sensing_power = state->sensing_power;
        const float m_x_part = sensing_power * sensing_power_0;
        const float ratio_x_part_3 = sensing_first_s_x_next * ratio_x_part;
        const float ratio_x_part_3_squared = ratio_x_part_3 * ratio_x_part_3;
        const float m_x = ratio_x_part_2 + ratio_x_part_squared - (m_x_part + (ratio_x_part_3_squared * (sensing_power_1 + (ratio_x_part_3_squared * sensing_power_2))));
        const float ratio_y_part_3 = sensing_first_s_y_next * ratio_y_part;
        const float ratio_y_part_3_squared = ratio_y_part_3 * ratio_y_part_3;
        const float m_y = ratio_y_part_2 + ratio_y_part_squared - (m_x_part + (ratio_y_part_3_squared * (sensing_power_1 + (ratio_y_part_3_squared * sensing_power_2))));
        const uint32_t sensing_contradiction_left = state->sensing_contradiction_left;
        bool x_raw_test = false;
        if ((guard_ready != 0u) && complete) {
            const float x_raw_part = (r_1 * r_1) + (r_2 * r_2) + (0.033025026f * ((m_x * m_x) + (m_y * m_y)));
            x_raw_test = (0.013780796f < x_raw_part) && ((sensing_contradiction_left != 0u) || (0.055123184f < x_raw_part));
        }
        const bool x_raw_test_2 = !x_raw_test && complete;
        const float filter_y_p = state->filter_y.p;
        const float sensing_offset_x = state->sensing_offset_x;
        const float x_raw_part_2 = filter_x_p - sensing_offset_x;
        const float sensing_offset_y = state->sensing_offset_y;
        const float y_raw_part = filter_y_p - sensing_offset_y;
        float x_raw = filter_x_p;
        float y_raw = filter_y_p;
        float phi_raw_part = 0.0f;
        float within_x;
        float within_y;
        float sensing_power_part = sensing_power;
        if (x_raw_test_2) {
            const float ratio_x = ratio_x_part_3 / (planar_6dof_leadlag_max(ratio_x_part_2, ratio_x_part_squared) + 8.612998e-06f);
            /*@ admit -1.0f <= ratio_x <= 1.0f; */
            const float ratio_x_squared = ratio_x * ratio_x;
            const float x_raw_part_3 = ratio_x * (sensing_position_1 + (ratio_x_squared * (sensing_position_3 + (ratio_x_squared * (sensing_position_5 + (ratio_x_squared * sensing_position_7))))));
            float x_raw_part_4;
            if (ratio_x_part_2 <= ratio_x_part_squared) {
                if (ratio_x_part < 0.0f) {
                    if (0.0f < x_raw_part_3) {
                        x_raw_part_4 = x_raw_part_3 - 0.0254f;
                    } else {
                        x_raw_part_4 = x_raw_part_3 + 0.0254f;
                    }
                } else {
                    x_raw_part_4 = x_raw_part_3;
                }
            } else {
                x_raw_part_4 = ((sensing_first_s_x_next < 0.0f) ? -0.0127f : 0.0127f) - x_raw_part_3;
            }
            const float x_raw_part_5 = x_raw_part_4 - x_raw_part_2;
            float x_raw_part_6 = sensing_offset_x;
            if (0.0254f < fabsf(x_raw_part_5)) {
                if (0.0f < x_raw_part_5) {
                    if (-0.0508f <= sensing_offset_x) {
                        const float x_raw_part_7 = sensing_offset_x - 0.0508f;
                        x_raw_part_6 = x_raw_part_7;
                        state->sensing_offset_x = x_raw_part_7;
                    }
                } else {
                    if (sensing_offset_x <= 0.0508f) {
                        const float x_raw_part_8 = sensing_offset_x + 0.0508f;
                        x_raw_part_6 = x_raw_part_8;
                        state->sensing_offset_x = x_raw_part_8;
                    }
                }
            }
            x_raw = x_raw_part_4 + x_raw_part_6;
            within_x = x_raw_part_4;
            const float ratio_y = -(ratio_y_part_3 / (planar_6dof_leadlag_max(ratio_y_part_2, ratio_y_part_squared) + 8.612998e-06f));
            /*@ admit -1.0f <= ratio_y <= 1.0f; */
            const float ratio_y_squared = ratio_y * ratio_y;
            const float y_raw_part_2 = ratio_y * (sensing_position_1 + (ratio_y_squared * (sensing_position_3 + (ratio_y_squared * (sensing_position_5 + (ratio_y_squared * sensing_position_7))))));
            float y_raw_part_3;
            if (ratio_y_part_2 <= ratio_y_part_squared) {
                if (-ratio_y_part < 0.0f) {
                    if (0.0f < y_raw_part_2) {
                        y_raw_part_3 = y_raw_part_2 - 0.0254f;
                    } else {
                        y_raw_part_3 = y_raw_part_2 + 0.0254f;
                    }
                } else {
                    y_raw_part_3 = y_raw_part_2;
                }
            } else {
                y_raw_part_3 = ((sensing_first_s_y_next < 0.0f) ? -0.0127f : 0.0127f) - y_raw_part_2;
            }
            const float y_raw_part_4 = y_raw_part_3 - y_raw_part;
            float y_raw_part_5 = sensing_offset_y;
            if (0.0254f < fabsf(y_raw_part_4)) {
                if (0.0f < y_raw_part_4) {
                    if (-0.0508f <= sensing_offset_y) {
                        const float y_raw_part_6 = sensing_offset_y - 0.0508f;
                        y_raw_part_5 = y_raw_part_6;
                        state->sensing_offset_y = y_raw_part_6;
                    }
                } else {
                    if (sensing_offset_y <= 0.0508f) {
                        const float y_raw_part_7 = sensing_offset_y + 0.0508f;
                        y_raw_part_5 = y_raw_part_7;
                        state->sensing_offset_y = y_raw_part_7;
                    }
                }
            }
            y_raw = y_raw_part_3 + y_raw_part_5;
            within_y = y_raw_part_3;
            const float phi_raw_part_2 = (sensing_first_s_x_next * (sensing_first_s_y_next + ratio_y_part)) + (sensing_first_s_y_next * (sensing_first_s_x_next - ratio_x_part));
            const float phi_raw_part_3 = ((r_1_part * r_1) - (r_2_part * r_2) + (sensing_amplitude_weight * (phi_raw_part_2 * (m_x - m_y)))) / ((r_1_part * r_1_part) + (r_2_part * r_2_part) + (2.0f * (sensing_amplitude_weight * (phi_raw_part_2 * phi_raw_part_2))) + 0.00021532494f);
            phi_raw_part = phi_raw_part_3;
            sensing_power_part = sensing_power + (((guard_ready != 0u) ? sensing_power_gain : sensing_first_power_gain) * (m_x + m_y));
        } else {
            within_x = planar_6dof_leadlag_limit(x_raw_part_2, 0.0254f);
            within_y = planar_6dof_leadlag_limit(y_raw_part, 0.0254f);
        }
        const float phi_raw = planar_6dof_leadlag_limit(filter_phi_p + phi_raw_part, 0.025f);
        if (x_raw_test) {
            state->sensing_contradiction_left = 4u;
        } else {
            if (x_raw_test_2 && (sensing_contradiction_left != 0u)) {
                state->sensing_contradiction_left = sensing_contradiction_left - 1u;
            }
        }
        if (x_raw_test && (sensing_contradiction_left != 0u)) {
            state->sensing_contradiction_confirmed = 1u;
        }
        if (x_raw_test && !(sensing_contradiction_left != 0u)) {
            state->sensing_first_m_x = m_x;
            state->sensing_first_m_y = m_y;
            state->sensing_first_r_1 = r_1;
            state->sensing_first_r_2 = r_2;
            state->sensing_first_s_x = sensing_first_s_x_next;
            state->sensing_first_s_y = sensing_first_s_y_next;
            state->sensing_first_phi = filter_phi_p;
        }
        state->sensing_within_x = within_x;
        state->sensing_within_y = within_y;
        state->sensing_power = planar_6dof_leadlag_max(planar_6dof_leadlag_min(sensing_power_part, 1.3f), 0.75f);
        const float phi = planar_6dof_leadlag_filter(&state->filter_phi, &filter_phi_filter, guard_ready, phi_raw);
        const float x = planar_6dof_leadlag_filter(&state->filter_x, &filter_x_filter, guard_ready, x_raw);
        const float y = planar_6dof_leadlag_filter(&state->filter_y, &filter_y_filter, guard_ready, y_raw);

        /* vertical_kinematics: z and tilts from distances */
        const float z_part = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (z_part + d3_held);
        const float theta = 8.333333f * (d3_held - z_part);
        const float psi = 8.333333f * (d1_held - d2_held);
        const planar_6dof_leadlag_loop_output_t loop_x_output = planar_6dof_leadlag_loop_output(&state->loop_x, loop_x_gain, x_ref_held, x);
        const planar_6dof_leadlag_loop_output_t loop_y_output = planar_6dof_leadlag_loop_output(&state->loop_y, loop_y_gain, y_ref_held, y);
        const planar_6dof_leadlag_loop_output_t loop_phi_output = planar_6dof_leadlag_loop_output(&state->loop_phi, loop_phi_gain, phi_ref_held, phi);
        const planar_6dof_leadlag_loop_output_t loop_z_output = planar_6dof_leadlag_loop_output(&state->loop_z, loop_z_gain, z_ref_held, z);

        /* loop_z: lead-lag, (23) */
        state->loop_z.lead = loop_z_lead_input * loop_z_output.ref_held_minus_value;
        const planar_6dof_leadlag_loop_output_t loop_theta_output = planar_6dof_leadlag_loop_output(&state->loop_theta, loop_theta_gain, theta_ref_held, theta);

        /* loop_theta: lead-lag, (24) */
        state->loop_theta.lead = loop_theta_lead_input * loop_theta_output.ref_held_minus_value;
        const planar_6dof_leadlag_loop_output_t loop_psi_output = planar_6dof_leadlag_loop_output(&state->loop_psi, loop_psi_gain, psi_ref_held, psi);

        /* loop_psi: lead-lag, (25) */
        state->loop_psi.lead = loop_psi_lead_input * loop_psi_output.ref_held_minus_value;

        /* allocation: motor currents, Table 3, (17) */
        const float phi_squared = phi * phi;
        const float i_CQ_part = f1_polynomial(phi_squared);
        const float i_CQ_part_2 = phi * f2_polynomial(phi_squared);
        const float i_CQ = planar_6dof_leadlag_limit((i_CQ_part * loop_x_output.d) + (i_CQ_part_2 * loop_y_output.d), planar_6dof_leadlag_max(1.134f - fabsf(loop_phi_output.d), 0.567f));
        const float i_AQ_part = planar_6dof_leadlag_limit(loop_phi_output.d + i_CQ, 1.134f);
        const float i_AQ_part_2 = planar_6dof_leadlag_limit(0.5f * ((i_CQ_part * loop_y_output.d) - (i_CQ_part_2 * loop_x_output.d)), 1.134f - fabsf(i_AQ_part));
        const float i_AQ = i_AQ_part_2 - i_AQ_part;
        const float i_BQ = i_AQ_part_2 + i_AQ_part;
        const float d_minus_d = loop_z_output.d - loop_theta_output.d;
        const float i_AD = planar_6dof_leadlag_limit(d_minus_d + loop_psi_output.d, 0.54913455f);
        const float i_BD = planar_6dof_leadlag_limit(d_minus_d - loop_psi_output.d, 0.54913455f);

        /* loop_psi: lead-lag, (25) */
        const float loop_psi_integral_next = (loop_psi_integral_decay * state->loop_psi.integral) + (loop_psi_integral_input_x_allocation_half * (i_AD - i_BD));
        state->loop_psi.integral = loop_psi_integral_next;

        /* allocation: motor currents, Table 3, (17) */
        const float i_CD = planar_6dof_leadlag_limit(loop_z_output.d + (2.0f * loop_theta_output.d), 0.54913455f);

        /* loop_z: lead-lag, (23) */
        const float i_AD_plus_i_BD = i_AD + i_BD;
        const float loop_z_integral_next = (loop_z_integral_decay * state->loop_z.integral) + (loop_z_integral_input_x_allocation_rear_share * (i_AD_plus_i_BD + i_CD));
        state->loop_z.integral = loop_z_integral_next;

        /* allocation: motor currents, Table 3, (17) */
        const float achieved_x = (i_CQ_part * i_CQ) - (2.0f * (i_CQ_part_2 * i_AQ_part_2));
        planar_6dof_leadlag_loop_update(&state->loop_x, loop_x_lead_input, achieved_x, loop_x_output.ref_held_minus_value);
        const float achieved_y = (i_CQ_part_2 * i_CQ) + (2.0f * (i_CQ_part * i_AQ_part_2));
        planar_6dof_leadlag_loop_update(&state->loop_y, loop_y_lead_input, achieved_y, loop_y_output.ref_held_minus_value);
        const float achieved_phi = i_AQ_part - i_CQ;
        planar_6dof_leadlag_loop_update(&state->loop_phi, loop_phi_lead_input, achieved_phi, loop_phi_output.ref_held_minus_value);
        const float achieved_theta = (allocation_rear_share * i_CD) - (allocation_front_share * i_AD_plus_i_BD);

        /* loop_theta: lead-lag, (24) */
        state->loop_theta.integral = (loop_theta_integral_decay * state->loop_theta.integral) + (loop_theta_integral_input * achieved_theta);

        /* commutation: phase currents, (17) inverted */
        const float distance_rear = within_x - (0.025584769f * i_CQ_part_2);
        const float quarter_sine_rear = distance_rear * quarter_sine_rear_polynomial(distance_rear * distance_rear);
        const float distance_front = within_y - ((0.012792384f * i_CQ_part) - 0.0127f);
        const float quarter_sine_front = distance_front * quarter_sine_front_polynomial(distance_front * distance_front);
        const float i_AA_computed_part = quarter_sine_front * quarter_sine_front;
        const float i_AA_computed_part_2 = quarter_sine_front * sqrtf(1.0f - i_AA_computed_part);
        const float i_AA_computed_part_3 = i_AA_computed_part_2 * (4.0f - (8.0f * i_AA_computed_part));
        const float i_AA_computed_part_4 = f5_polynomial(phi_squared);
        const float i_AA_computed_part_5 = i_AA_computed_part_3 * i_AA_computed_part_4;
        const float i_AA_computed_part_6 = 1.0f - (8.0f * (i_AA_computed_part_2 * i_AA_computed_part_2));
        const float i_AA_computed_part_7 = phi * f6_polynomial(phi_squared);
        const float i_AA_computed_part_8 = i_AA_computed_part_6 * i_AA_computed_part_7;
        const float i_AA_computed_part_9 = i_AA_computed_part_5 - i_AA_computed_part_8;
        const float i_AA_computed_part_10 = i_AA_computed_part_6 * i_AA_computed_part_4;
        const float i_AA_computed_part_11 = i_AA_computed_part_3 * i_AA_computed_part_7;
        const float i_AA_computed_part_12 = i_AA_computed_part_10 + i_AA_computed_part_11;
        const float i_AA_computed = (i_AA_computed_part_9 * i_AQ) + (i_AA_computed_part_12 * i_AD);
        /*@ admit -1.26f <= i_AA_computed <= 1.26f; */
        state->safe_output_last_i_AA = i_AA_computed;
        out->i_AA = i_AA_computed;
        const float i_AB_computed_part = 0.8660254f * ((i_AA_computed_part_9 * i_AD) - (i_AA_computed_part_12 * i_AQ));
        const float half_i_AA_computed = 0.5f * i_AA_computed;
        const float i_AB_computed = i_AB_computed_part - half_i_AA_computed;
        /*@ admit -1.26f <= i_AB_computed <= 1.26f; */
        state->safe_output_last_i_AB = i_AB_computed;
        out->i_AB = i_AB_computed;
        const float i_AC_computed = -(half_i_AA_computed + i_AB_computed_part);
        /*@ admit -1.26f <= i_AC_computed <= 1.26f; */
        state->safe_output_last_i_AC = i_AC_computed;
        out->i_AC = i_AC_computed;
        const float i_BA_computed_part = i_AA_computed_part_5 + i_AA_computed_part_8;
        const float i_BA_computed_part_2 = i_AA_computed_part_11 - i_AA_computed_part_10;
        const float i_BA_computed = (i_BA_computed_part * i_BQ) - (i_BA_computed_part_2 * i_BD);
        /*@ admit -1.26f <= i_BA_computed <= 1.26f; */
        state->safe_output_last_i_BA = i_BA_computed;
        out->i_BA = i_BA_computed;
        const float i_BB_computed_part = 0.8660254f * ((i_BA_computed_part_2 * i_BQ) + (i_BA_computed_part * i_BD));
        const float half_i_BA_computed = 0.5f * i_BA_computed;
        const float i_BB_computed = i_BB_computed_part - half_i_BA_computed;
        /*@ admit -1.26f <= i_BB_computed <= 1.26f; */
        state->safe_output_last_i_BB = i_BB_computed;
        out->i_BB = i_BB_computed;
        const float i_BC_computed = -(half_i_BA_computed + i_BB_computed_part);
        /*@ admit -1.26f <= i_BC_computed <= 1.26f; */
        state->safe_output_last_i_BC = i_BC_computed;
        out->i_BC = i_BC_computed;
        const float i_CA_computed_part = quarter_sine_rear * quarter_sine_rear;
        const float i_CA_computed_part_2 = quarter_sine_rear * sqrtf(1.0f - i_CA_computed_part);
        const float i_CA_computed_part_3 = 1.0f - (8.0f * (i_CA_computed_part_2 * i_CA_computed_part_2));
        const float i_CA_computed_part_4 = i_CA_computed_part_2 * (4.0f - (8.0f * i_CA_computed_part));
        const float i_CA_computed = (i_CA_computed_part_3 * i_CQ) - (i_CA_computed_part_4 * i_CD);
        /*@ admit -1.26f <= i_CA_computed <= 1.26f; */
        state->safe_output_last_i_CA = i_CA_computed;
        out->i_CA = i_CA_computed;
        const float i_CB_computed_part = 0.8660254f * ((i_CA_computed_part_4 * i_CQ) + (i_CA_computed_part_3 * i_CD));
        const float half_i_CA_computed = 0.5f * i_CA_computed;
        const float i_CB_computed = i_CB_computed_part - half_i_CA_computed;
        /*@ admit -1.26f <= i_CB_computed <= 1.26f; */
        state->safe_output_last_i_CB = i_CB_computed;
        out->i_CB = i_CB_computed;
        const float i_CC_computed = -(half_i_CA_computed + i_CB_computed_part);
        /*@ admit -1.26f <= i_CC_computed <= 1.26f; */
        state->safe_output_last_i_CC = i_CC_computed;
        out->i_CC = i_CC_computed;
    }
    uint32_t value = faults;
    if (suspect_V_ax_test_7) {
        value = faults | 0x20000000u;
    }
    const uint32_t fault_word = (sensing_contradiction_confirmed != 0u) ? value : faults;

    return fault_word;
}
