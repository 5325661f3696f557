/* planar_6dof_lqg. Generated: do not edit. */
#include "planar_6dof_lqg.h"
#include <math.h>
#include <stdbool.h>

static inline float min(float a, float b)
{
    return (a < b) ? a : b;
}

static inline float max(float a, float b)
{
    return (a > b) ? a : b;
}

static inline float limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline uint32_t flag(bool holds)
{
    uint32_t value = 0u;
    if (holds) {
        value = 1u;
    }
    return value;
}

/* f1_polynomial for clamp(phi_raw, -0.075, 0.075) in -0.0250000004 .. 0.0250000004: t = x^2, x = clamp(phi_raw, -0.075, 0.075);
 * relative error at most 6e-08. */
static inline float f1_polynomial(float t)
{
    return 1.0f + (t * -0.49997827f);
}

/* f2_polynomial for clamp(phi_raw, -0.075, 0.075) in -0.0250000004 .. 0.0250000004: f2_polynomial / x, t = x^2, x = clamp(phi_raw, -0.075, 0.075);
 * relative error at most 1.2e-07. */
static inline float f2_polynomial(float t)
{
    return 1.0f + (t * -0.16666232f);
}

/* quarter_sine_back for distance_back in -0.0260395538 .. 0.0260395538: quarter_sine_back / x, t = x^2, x = distance_back;
 * relative error at most 1.9e-06. */
static inline float quarter_sine_back_polynomial(float t)
{
    return 30.921135f + (t * (-4925.9985f + (t * 230119.58f)));
}

/* quarter_sine_front for distance_front in -0.0254923999 .. 0.0253116228: quarter_sine_front / x, t = x^2, x = distance_front;
 * relative error at most 1.7e-06. */
static inline float quarter_sine_front_polynomial(float t)
{
    return 30.92114f + (t * (-4926.108f + (t * 230339.45f)));
}

/* f5_polynomial for clamp(phi_raw, -0.075, 0.075) in -0.0250000004 .. 0.0250000004: t = x^2, x = clamp(phi_raw, -0.075, 0.075);
 * relative error at most 9e-08. */
static inline float f5_polynomial(float t)
{
    return 0.99999994f + (t * -1.2512345f);
}

/* f6_polynomial for clamp(phi_raw, -0.075, 0.075) in -0.0250000004 .. 0.0250000004: f6_polynomial / x, t = x^2, x = clamp(phi_raw, -0.075, 0.075);
 * relative error at most 1.2e-07. */
static inline float f6_polynomial(float t)
{
    return 1.5822228f + (t * -0.9236455f);
}

void planar_6dof_lqg_init(planar_6dof_lqg_state_t *state)
{
    state->guard_last_d1 = 0.0f;
    state->guard_last_d2 = 0.0f;
    state->guard_last_d3 = 0.0f;
    state->guard_last_x_ref = 0.0f;
    state->guard_last_y_ref = 0.0f;
    state->guard_last_phi_ref = 0.0f;
    state->guard_last_z_ref = 0.0f;
    state->guard_last_theta_ref = 0.0f;
    state->guard_last_psi_ref = 0.0f;
    state->guard_left = 5u;
    state->guard_latched = 0u;
    state->guard_ready = 0u;
    state->sensing_offset_x = 0.0f;
    state->sensing_offset_y = 0.0f;
    state->sensing_within_x = 0.0f;
    state->sensing_within_y = 0.0f;
    state->sensing_doubt = 0u;
    state->sensing_named = 0u;
    state->sensing_found_V_ax = 0u;
    state->sensing_found_V_ay = 0u;
    state->sensing_found_V_bx = 0u;
    state->sensing_found_V_by = 0u;
    state->sensing_found_V_cx = 0u;
    state->sensing_found_V_cy = 0u;
    state->sensing_phi_raw = 0.0f;
    state->lqg_x_x3 = 0.0f;
    state->lqg_x_integral = 0.0f;
    state->lqg_x_force = 0.0f;
    state->lqg_y_x3 = 0.0f;
    state->lqg_y_integral = 0.0f;
    state->lqg_y_force = 0.0f;
    state->lqg_phi_x3 = 0.0f;
    state->lqg_phi_integral = 0.0f;
    state->lqg_phi_force = 0.0f;
    state->loop_z_integral = 0.0f;
    state->loop_z_lag = 0.0f;
    state->loop_theta_integral = 0.0f;
    state->loop_theta_lag = 0.0f;
    state->loop_psi_integral = 0.0f;
    state->loop_psi_lag = 0.0f;
    state->safe_output_last_i_AA = 0.0f;
    state->safe_output_last_i_AB = 0.0f;
    state->safe_output_last_i_AC = 0.0f;
    state->safe_output_last_i_BA = 0.0f;
    state->safe_output_last_i_BB = 0.0f;
    state->safe_output_last_i_BC = 0.0f;
    state->safe_output_last_i_CA = 0.0f;
    state->safe_output_last_i_CB = 0.0f;
    state->safe_output_last_i_CC = 0.0f;
}

uint32_t planar_6dof_lqg_step(planar_6dof_lqg_state_t *state, const planar_6dof_lqg_input_t *in, planar_6dof_lqg_output_t *out)
{
    static const float guard_refused_V_ax = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_ay = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_bx = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_by = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_cx = 0.0f;               /* V; in place of a refused value */
    static const float guard_refused_V_cy = 0.0f;               /* V; in place of a refused value */
    static const float sensing_position_1 = 0.009938624f;       /* m; position in the calculated field */
    static const float sensing_position_3 = -0.0075761457f;     /* m; position in the calculated field */
    static const float sensing_position_5 = 0.0061684945f;      /* m; position in the calculated field */
    static const float sensing_position_7 = -0.0021809724f;     /* m; position in the calculated field */
    static const float sensing_slope_0 = 0.49650046f;           /* 1/V^2; slope in the calculated field */
    static const float sensing_slope_1 = 0.15281738f;           /* 1/V^4; slope in the calculated field */
    static const float sensing_power_0 = 7.7654033f;            /* V^2; power in the calculated field */
    static const float sensing_power_1 = 0.11621765f;           /* 1/V^2; power in the calculated field */
    static const float sensing_power_2 = -0.0013770753f;        /* 1/V^6; power in the calculated field */
    static const float sensing_third = 0.02322072f;             /* 1/V^2; 2 W / A^2 */
    static const float lqg_x_on_error = 1955.8091f;             /* A/m; (49): k1 + k3 T */
    static const float lqg_x_kept = 0.9430741f;                 /* 1; (49): 1 - k3 T / (k1 + k3 T) */
    static const float lqg_x_driven = 0.056925878f;             /* 1; (49): k3 T / (k1 + k3 T) */
    static const float lqg_x_on_force = 0.319009f;              /* 1; (49): b T (k1 T / 2 + k2) */
    static const float lqg_x_L = 5126.1787f;                    /* A/m; (33): (k1 T + k2) L, L = (1 - p) / T */
    static const float lqg_x_F = 0.7f;                          /* 1; (35): A22 - L A12 */
    static const float lqg_x_G = -1537.8536f;                   /* A/m; (33): (k1 T + k2) (F L + A21 - L A11) */
    static const float lqg_x_H = 0.28662756f;                   /* 1; (33): (k1 T + k2) (B2 - L B1) */
    static const float lqg_y_on_error = 1117.0514f;             /* A/m; (49): k1 + k3 T */
    static const float lqg_y_kept = 0.953085f;                  /* 1; (49): 1 - k3 T / (k1 + k3 T) */
    static const float lqg_y_driven = 0.046914965f;             /* 1; (49): k3 T / (k1 + k3 T) */
    static const float lqg_y_on_force = 0.22358753f;            /* 1; (49): b T (k1 T / 2 + k2) */
    static const float lqg_y_L = 3558.6274f;                    /* A/m; (33): (k1 T + k2) L, L = (1 - p) / T */
    static const float lqg_y_F = 0.7f;                          /* 1; (35): A22 - L A12 */
    static const float lqg_y_G = -1067.5883f;                   /* A/m; (33): (k1 T + k2) (F L + A21 - L A11) */
    static const float lqg_y_H = 0.19897877f;                   /* 1; (33): (k1 T + k2) (B2 - L B1) */
    static const float lqg_phi_on_error = 550.31274f;           /* A/rad; (49): k1 + k3 T */
    static const float lqg_phi_kept = 0.9013263f;               /* 1; (49): 1 - k3 T / (k1 + k3 T) */
    static const float lqg_phi_driven = 0.098673716f;           /* 1; (49): k3 T / (k1 + k3 T) */
    static const float lqg_phi_on_force = 0.87617064f;          /* 1; (49): b T (k1 T / 2 + k2) */
    static const float lqg_phi_L = 275.96594f;                  /* A/rad; (33): (k1 T + k2) L, L = (1 - p) / T */
    static const float lqg_phi_F = 0.9f;                        /* 1; (35): A22 - L A12 */
    static const float lqg_phi_G = -27.596594f;                 /* A/rad; (33): (k1 T + k2) (F L + A21 - L A11) */
    static const float lqg_phi_H = 0.9145512f;                  /* 1; (33): (k1 T + k2) (B2 - L B1) */
    static const float loop_z_direct = 4023.7034f;              /* A/m; (23): gain of the error */
    static const float loop_z_into_lag = -3537.3835f;           /* A/m; (23): gain times pole less zero */
    static const float loop_z_reset = 0.9875776f;               /* 1; (23): zero of the integrator in z */
    static const float loop_theta_direct = 427.24356f;          /* A/rad; (24): gain of the error */
    static const float loop_theta_into_lag = -386.5337f;        /* A/rad; (24): gain times pole less zero */
    static const float loop_theta_reset = 0.9875776f;           /* 1; (24): zero of the integrator in z */
    static const float loop_theta_driven = 0.0124223605f;       /* 1; (24): 1 less that */
    static const float loop_psi_direct = 469.96793f;            /* A/rad; (25): gain of the error */
    static const float loop_psi_into_lag = -425.18707f;         /* A/rad; (25): gain times pole less zero */
    static const float loop_psi_reset = 0.9875776f;             /* 1; (25): zero of the integrator in z */
    static const float allocation_half = 0.5f;                  /* 1; Table 3: 1/2 */
    static const float allocation_part = 0.33333334f;           /* 1; Table 3: c/(2 (b + c)) */
    static const float allocation_front_part = 0.16666667f;     /* 1; Table 3: b/(2 (b + c)) */
    static const float loop_z_driven_x_allocation_part = 0.004140787f;/* 1 1; (23): 1 less that; times allocation_part */
    static const float loop_psi_driven_x_allocation_half = 0.0062111802f;/* 1 1; (25): 1 less that; times allocation_half */

    /* guard: range acceptance, hold, latch */
    const float V_ax = in->V_ax;
    float V_ax_held = V_ax;
    bool t1 = true;
    uint32_t t2 = 0u;
    if (!(fabsf(V_ax) <= 5.0f)) {
        V_ax_held = guard_refused_V_ax;
        t1 = false;
        t2 = 0x00000001u;
    }
    const float V_ay = in->V_ay;
    float V_ay_held = V_ay;
    if (!(fabsf(V_ay) <= 5.0f)) {
        V_ay_held = guard_refused_V_ay;
        t1 = false;
        t2 |= 0x00000002u;
    }
    const float V_bx = in->V_bx;
    float V_bx_held = V_bx;
    if (!(fabsf(V_bx) <= 5.0f)) {
        V_bx_held = guard_refused_V_bx;
        t1 = false;
        t2 |= 0x00000004u;
    }
    const float V_by = in->V_by;
    float V_by_held = V_by;
    if (!(fabsf(V_by) <= 5.0f)) {
        V_by_held = guard_refused_V_by;
        t1 = false;
        t2 |= 0x00000008u;
    }
    const float V_cx = in->V_cx;
    float V_cx_held = V_cx;
    if (!(fabsf(V_cx) <= 5.0f)) {
        V_cx_held = guard_refused_V_cx;
        t1 = false;
        t2 |= 0x00000010u;
    }
    const float V_cy = in->V_cy;
    float V_cy_held = V_cy;
    if (!(fabsf(V_cy) <= 5.0f)) {
        V_cy_held = guard_refused_V_cy;
        t1 = false;
        t2 |= 0x00000020u;
    }
    const float d1 = in->d1;
    float d1_held = d1;
    if (fabsf(d1) <= 0.0005f) {
        state->guard_last_d1 = d1;
    } else {
        d1_held = state->guard_last_d1;
        t1 = false;
        t2 |= 0x00000040u;
    }
    const float d2 = in->d2;
    float d2_held = d2;
    if (fabsf(d2) <= 0.0005f) {
        state->guard_last_d2 = d2;
    } else {
        d2_held = state->guard_last_d2;
        t1 = false;
        t2 |= 0x00000080u;
    }
    const float d3 = in->d3;
    float d3_held = d3;
    if (fabsf(d3) <= 0.0005f) {
        state->guard_last_d3 = d3;
    } else {
        d3_held = state->guard_last_d3;
        t1 = false;
        t2 |= 0x00000100u;
    }
    const float x_ref = in->x_ref;
    float x_ref_held = x_ref;
    if (fabsf(x_ref) <= 0.11f) {
        state->guard_last_x_ref = x_ref;
    } else {
        x_ref_held = state->guard_last_x_ref;
        t2 |= 0x00000200u;
    }
    const float y_ref = in->y_ref;
    float y_ref_held = y_ref;
    if (fabsf(y_ref) <= 0.1f) {
        state->guard_last_y_ref = y_ref;
    } else {
        y_ref_held = state->guard_last_y_ref;
        t2 |= 0x00000400u;
    }
    const float phi_ref = in->phi_ref;
    float phi_ref_held = phi_ref;
    if (fabsf(phi_ref) <= 0.02f) {
        state->guard_last_phi_ref = phi_ref;
    } else {
        phi_ref_held = state->guard_last_phi_ref;
        t2 |= 0x00000800u;
    }
    const float z_ref = in->z_ref;
    float z_ref_held = z_ref;
    if (fabsf(z_ref) <= 0.0002f) {
        state->guard_last_z_ref = z_ref;
    } else {
        z_ref_held = state->guard_last_z_ref;
        t2 |= 0x00001000u;
    }
    const float theta_ref = in->theta_ref;
    float theta_ref_held = theta_ref;
    if (fabsf(theta_ref) <= 0.002f) {
        state->guard_last_theta_ref = theta_ref;
    } else {
        theta_ref_held = state->guard_last_theta_ref;
        t2 |= 0x00002000u;
    }
    const float psi_ref = in->psi_ref;
    float psi_ref_held = psi_ref;
    if (fabsf(psi_ref) <= 0.002f) {
        state->guard_last_psi_ref = psi_ref;
    } else {
        psi_ref_held = state->guard_last_psi_ref;
        t2 |= 0x00004000u;
    }

    /* sensing: (1)-(5) */
    const uint32_t sensing_found_V_ax = state->sensing_found_V_ax;
    const uint32_t sensing_named = state->sensing_named;
    const uint32_t sensing_found_V_bx = state->sensing_found_V_bx;
    const uint32_t sensing_found_V_cx = state->sensing_found_V_cx;

    /* guard: range acceptance, hold, latch */
    bool complete = false;
    uint32_t faults = t2;
    if (sensing_named != 0u) {
        /* sensing: (1)-(5) */
        const uint32_t sensing_found_V_ay = state->sensing_found_V_ay;
        const uint32_t sensing_found_V_by = state->sensing_found_V_by;
        const uint32_t sensing_found_V_cy = state->sensing_found_V_cy;
        uint32_t t3 = t2;
        if (sensing_found_V_ax != 0u) {
            t3 = t2 | 0x00008000u;
        }
        if (sensing_found_V_ay != 0u) {
            t3 |= 0x00010000u;
        }
        if (sensing_found_V_bx != 0u) {
            t3 |= 0x00020000u;
        }
        if (sensing_found_V_by != 0u) {
            t3 |= 0x00040000u;
        }
        if (sensing_found_V_cx != 0u) {
            t3 |= 0x00080000u;
        }
        if (sensing_found_V_cy != 0u) {
            faults = t3 | 0x00100000u;
        } else {
            faults = t3;
        }
    } else {
        complete = t1;
    }
    const uint32_t guard_latched = state->guard_latched;
    const uint32_t guard_ready = state->guard_ready;
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

    /* safe_output: slew to the safe output once latched */
    if (latched != 0u) {
        const float safe_output_last_i_AA = state->safe_output_last_i_AA;
        const float t4 = max(min(0.0f, safe_output_last_i_AA + 0.1575f), safe_output_last_i_AA - 0.1575f);
        out->i_AA = t4;
        const float safe_output_last_i_AB = state->safe_output_last_i_AB;
        const float t5 = max(min(0.0f, safe_output_last_i_AB + 0.1575f), safe_output_last_i_AB - 0.1575f);
        out->i_AB = t5;
        const float safe_output_last_i_AC = state->safe_output_last_i_AC;
        const float t6 = max(min(0.0f, safe_output_last_i_AC + 0.1575f), safe_output_last_i_AC - 0.1575f);
        out->i_AC = t6;
        const float safe_output_last_i_BA = state->safe_output_last_i_BA;
        const float t7 = max(min(0.0f, safe_output_last_i_BA + 0.1575f), safe_output_last_i_BA - 0.1575f);
        out->i_BA = t7;
        const float safe_output_last_i_BB = state->safe_output_last_i_BB;
        const float t8 = max(min(0.0f, safe_output_last_i_BB + 0.1575f), safe_output_last_i_BB - 0.1575f);
        out->i_BB = t8;
        const float safe_output_last_i_BC = state->safe_output_last_i_BC;
        const float t9 = max(min(0.0f, safe_output_last_i_BC + 0.1575f), safe_output_last_i_BC - 0.1575f);
        out->i_BC = t9;
        const float safe_output_last_i_CA = state->safe_output_last_i_CA;
        const float t10 = max(min(0.0f, safe_output_last_i_CA + 0.1575f), safe_output_last_i_CA - 0.1575f);
        out->i_CA = t10;
        const float safe_output_last_i_CB = state->safe_output_last_i_CB;
        const float t11 = max(min(0.0f, safe_output_last_i_CB + 0.1575f), safe_output_last_i_CB - 0.1575f);
        out->i_CB = t11;
        const float safe_output_last_i_CC = state->safe_output_last_i_CC;
        state->safe_output_last_i_AA = t4;
        state->safe_output_last_i_AB = t5;
        state->safe_output_last_i_AC = t6;
        state->safe_output_last_i_BA = t7;
        state->safe_output_last_i_BB = t8;
        state->safe_output_last_i_BC = t9;
        state->safe_output_last_i_CA = t10;
        state->safe_output_last_i_CB = t11;
        const float t12 = max(min(0.0f, safe_output_last_i_CC + 0.1575f), safe_output_last_i_CC - 0.1575f);
        state->safe_output_last_i_CC = t12;
        out->i_CC = t12;

        /* guard: range acceptance, hold, latch */
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* sensing: (1)-(5) */
        const float sensing_phi_raw = state->sensing_phi_raw;
        const float t13 = sensing_phi_raw * V_ay_held;
        const float t14 = V_ax_held - t13;
        const float t15 = t14 * t14;
        const float t16 = t13 - V_bx_held;
        const float t17 = t16 * t16;
        const float t18 = t14 * t16;
        const float t19 = t18 * t18;
        const float m_x = t15 + t17 - (sensing_power_0 + (t19 * (sensing_power_1 + (t19 * sensing_power_2))));
        const bool t20 = 1.2919496f < fabsf(m_x);
        const float t21 = sensing_phi_raw * V_ax_held;
        const float t22 = V_ay_held + t21;
        const float t23 = t22 * t22;
        const float t24 = V_cy_held + t21;
        const float t25 = t24 * t24;
        const float t26 = t22 * t24;
        const float t27 = t26 * t26;
        const float m_y = t23 + t25 - (sensing_power_0 + (t27 * (sensing_power_1 + (t27 * sensing_power_2))));
        const bool t28 = 1.2919496f < fabsf(m_y);
        const float t29 = t16 + t14 - (t24 * t25 * (sensing_slope_0 + (t23 * sensing_slope_1)));
        const float r_1 = V_by_held - V_ay_held - (t29 * sensing_phi_raw);
        const float t30 = (t16 * t17 * (sensing_slope_0 + (t15 * sensing_slope_1))) + (t22 - t24);
        const float r_2 = V_cx_held - V_ax_held + (t30 * sensing_phi_raw);
        const bool t31 = (0.23478326f < fabsf(r_1)) || (0.23478326f < fabsf(r_2));
        const bool t32 = (t20 || t28 || t31) && (guard_ready != 0u) && complete;
        const bool t33 = !t32 && complete;
        const float sensing_within_x = state->sensing_within_x;
        const float sensing_offset_x = state->sensing_offset_x;
        const float t34 = sensing_within_x + sensing_offset_x;
        const float sensing_within_y = state->sensing_within_y;
        const float sensing_offset_y = state->sensing_offset_y;
        const float t35 = sensing_within_y + sensing_offset_y;
        const float t36 = t29 * r_1;
        const float t37 = t30 * r_2;
        const float t38 = t29 * t29;
        const float t39 = t30 * t30;
        const float t40 = t38 + t39;
        float x_raw = t34;
        float y_raw = t35;
        float t41 = 0.0f;
        float within_x = sensing_within_x;
        float within_y = sensing_within_y;
        if (t33) {
            float sensing_within_x_next;
            if (t15 <= t17) {
                const float t42 = limit(t18 / (t17 + 8.612998e-06f), 1.0f);
                const float t43 = t42 * t42;
                const float t44 = sensing_position_1 + (t43 * (sensing_position_3 + (t43 * (sensing_position_5 + (t43 * sensing_position_7)))));
                const float t45 = t42 * t44;
                if (t16 < 0.0f) {
                    if (0.0f < t45) {
                        sensing_within_x_next = t45 - 0.0254f;
                    } else {
                        sensing_within_x_next = t45 + 0.0254f;
                    }
                } else {
                    sensing_within_x_next = t45;
                }
            } else {
                const float t46 = limit(t18 / (t15 + 8.612998e-06f), 1.0f);
                const float t47 = t46 * t46;
                const float t48 = sensing_position_1 + (t47 * (sensing_position_3 + (t47 * (sensing_position_5 + (t47 * sensing_position_7)))));
                sensing_within_x_next = ((t14 < 0.0f) ? -0.0127f : 0.0127f) - (t46 * t48);
            }
            const float t49 = sensing_within_x_next + sensing_offset_x - t34;
            float t50 = sensing_offset_x;
            if (0.0254f < fabsf(t49)) {
                if (0.0f < t49) {
                    const float t51 = max(sensing_offset_x - 0.0508f, -0.1016f);
                    t50 = t51;
                    state->sensing_offset_x = t51;
                } else {
                    const float t52 = min(sensing_offset_x + 0.0508f, 0.1016f);
                    t50 = t52;
                    state->sensing_offset_x = t52;
                }
            }
            x_raw = sensing_within_x_next + t50;
            float sensing_within_y_next;
            if (t23 <= t25) {
                const float t53 = limit(-(t26 / (t25 + 8.612998e-06f)), 1.0f);
                const float t54 = t53 * t53;
                const float t55 = sensing_position_1 + (t54 * (sensing_position_3 + (t54 * (sensing_position_5 + (t54 * sensing_position_7)))));
                const float t56 = t53 * t55;
                if (-t24 < 0.0f) {
                    if (0.0f < t56) {
                        sensing_within_y_next = t56 - 0.0254f;
                    } else {
                        sensing_within_y_next = t56 + 0.0254f;
                    }
                } else {
                    sensing_within_y_next = t56;
                }
            } else {
                const float t57 = limit(-(t26 / (t23 + 8.612998e-06f)), 1.0f);
                const float t58 = t57 * t57;
                const float t59 = sensing_position_1 + (t58 * (sensing_position_3 + (t58 * (sensing_position_5 + (t58 * sensing_position_7)))));
                sensing_within_y_next = ((t22 < 0.0f) ? -0.0127f : 0.0127f) - (t57 * t59);
            }
            const float t60 = sensing_within_y_next + sensing_offset_y - t35;
            float t61 = sensing_offset_y;
            if (0.0254f < fabsf(t60)) {
                if (0.0f < t60) {
                    const float t62 = max(sensing_offset_y - 0.0508f, -0.1016f);
                    t61 = t62;
                    state->sensing_offset_y = t62;
                } else {
                    const float t63 = min(sensing_offset_y + 0.0508f, 0.1016f);
                    t61 = t63;
                    state->sensing_offset_y = t63;
                }
            }
            y_raw = sensing_within_y_next + t61;
            const float t64 = (t14 * (t22 + t24)) + (t22 * (t14 - t16));
            const float t65 = (t36 - t37 + (sensing_third * (t64 * (m_x - m_y)))) / (t40 + (2.0f * (sensing_third * (t64 * t64))) + 0.08612997f);
            t41 = t65;
            within_x = sensing_within_x_next;
            state->sensing_within_x = sensing_within_x_next;
            within_y = sensing_within_y_next;
            state->sensing_within_y = sensing_within_y_next;
        }
        const float phi_raw = limit(sensing_phi_raw + t41, 0.025f);
        const uint32_t sensing_doubt = state->sensing_doubt;
        const bool t66 = t32 && (3u < sensing_doubt);
        const float t67 = sqrtf(t40 + 8.612998e-06f);
        const float t68 = -0.11739163f * t67;
        const float t69 = fabsf(t36) - fabsf(t37);
        const float t70 = (t30 * r_1) + (t29 * r_2);
        const bool t71 = !t31;
        const float t72 = fabsf(t70);
        const float t73 = 0.11739163f * t67;
        if (t66) {
            state->sensing_doubt = 3u;
            state->sensing_named = 1u;
            const bool t74 = t31 && (t68 < t69);
            const float t75 = t30 / (t39 + 8.612998e-06f);
            const float t76 = limit(-(r_2 * t75), 1.0f) * V_ax_held;
            const float t77 = t22 + t76;
            const float t78 = t24 + t76;
            const float t79 = t78 * t78;
            const float t80 = t77 * t78;
            const float t81 = t80 * t80;
            const float t82 = t77 + limit(t70 * t75, 10.0f);
            const float t83 = t82 * t78;
            const float t84 = t83 * t83;
            const float t85 = fabsf((t77 * t77) + t79 - (sensing_power_0 + (t81 * (sensing_power_1 + (t81 * sensing_power_2))))) - fabsf((t82 * t82) + t79 - (sensing_power_0 + (t84 * (sensing_power_1 + (t84 * sensing_power_2)))));
            const bool t86 = t28 && t71;
            const float t87 = fabsf(t70 + (t30 * (m_y * t22 / ((2.0f * t23) + 8.612998e-06f)))) - t72;
            const bool t88 = (t74 && (-0.34451988f < t85)) || (t86 && (t87 < t73));
            const bool t89 = t74 && (t85 < 0.34451988f);
            const bool t90 = t86 && (t68 < t87);
            const bool t91 = (sensing_found_V_ax != 0u) || t88 || (sensing_found_V_bx != 0u) || t89 || (sensing_found_V_cx != 0u) || t90;
            if (!t91) {
                state->sensing_found_V_ax = 1u;
                state->sensing_found_V_bx = 1u;
                state->sensing_found_V_cx = 1u;
            }
            const bool t92 = !t91;
            const bool sensing_found_V_ay_next = t88 || t92;
            state->sensing_found_V_ay = flag(sensing_found_V_ay_next);
            const bool sensing_found_V_by_next = t89 || t92;
            state->sensing_found_V_by = flag(sensing_found_V_by_next);
            const bool sensing_found_V_cy_next = t90 || t92;
            state->sensing_found_V_cy = flag(sensing_found_V_cy_next);
        } else {
            const bool t93 = t32 && (sensing_doubt != 0u);
            if (t93) {
                state->sensing_doubt = 6u;
            } else {
                if (t32) {
                    state->sensing_doubt = 3u;
                } else {
                    if (t33 && (sensing_doubt != 0u)) {
                        state->sensing_doubt = sensing_doubt - 1u;
                    }
                }
            }
            if (t93 && !t66) {
                const bool t94 = t31 && (t69 < t73);
                const float t95 = t29 / (t38 + 8.612998e-06f);
                const float t96 = limit(r_1 * t95, 1.0f) * V_ay_held;
                const float t97 = t14 - t96;
                const float t98 = t16 + t96;
                const float t99 = t98 * t98;
                const float t100 = t97 * t98;
                const float t101 = t100 * t100;
                const float t102 = t97 + limit(t70 * t95, 10.0f);
                const float t103 = t102 * t98;
                const float t104 = t103 * t103;
                const float t105 = fabsf((t97 * t97) + t99 - (sensing_power_0 + (t101 * (sensing_power_1 + (t101 * sensing_power_2))))) - fabsf((t102 * t102) + t99 - (sensing_power_0 + (t104 * (sensing_power_1 + (t104 * sensing_power_2)))));
                const bool t106 = t20 && t71;
                const float t107 = fabsf(t70 + (t29 * (m_x * t14 / ((2.0f * t15) + 8.612998e-06f)))) - t72;
                state->sensing_found_V_ax = flag((t94 && (-0.34451988f < t105)) || (t106 && (t107 < t73)));
                state->sensing_found_V_bx = flag(t106 && (t68 < t107));
                state->sensing_found_V_cx = flag(t94 && (t105 < 0.34451988f));
            }
        }
        state->sensing_phi_raw = phi_raw;

        /* heights: laser distances inverted */
        const float t108 = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (t108 + d3_held);
        const float theta = 8.333333f * (d3_held - t108);
        const float psi = 8.333333f * (d1_held - d2_held);

        /* lqg_x: (28)-(35), (49) */
        const float t109 = x_ref_held - x_raw;
        const bool t110 = fabsf(t109) <= 0.0015f;
        const float lqg_x_integral = state->lqg_x_integral;
        const float t111 = lqg_x_L * x_raw;
        const float t112 = lqg_y_L * y_raw;
        const float t113 = lqg_phi_L * phi_raw;
        float t114;
        float t115;
        float t116;
        if (guard_ready != 0u) {
            t114 = state->lqg_x_x3;
            t115 = state->lqg_y_x3;
            t116 = state->lqg_phi_x3;
        } else {
            t114 = -t111;
            t115 = -t112;
            t116 = -t113;
        }
        const float lqg_x_force = state->lqg_x_force;
        const float t117 = t114 + t111 + (lqg_x_on_force * lqg_x_force);
        const float d_x = (lqg_x_on_error * ((t110) ? t109 : ((t109 < 0.0f) ? -0.0015f : 0.0015f))) + (lqg_x_integral - t117);
        const float lqg_x_x3_next = (lqg_x_F * t114) + (lqg_x_G * x_raw) + (lqg_x_H * lqg_x_force);
        state->lqg_x_x3 = lqg_x_x3_next;

        /* lqg_y: (28)-(35), (49) */
        const float t118 = y_ref_held - y_raw;
        const bool t119 = fabsf(t118) <= 0.004f;
        const float lqg_y_integral = state->lqg_y_integral;
        const float lqg_y_force = state->lqg_y_force;
        const float t120 = t115 + t112 + (lqg_y_on_force * lqg_y_force);
        const float d_y = (lqg_y_on_error * ((t119) ? t118 : ((t118 < 0.0f) ? -0.004f : 0.004f))) + (lqg_y_integral - t120);
        const float lqg_y_x3_next = (lqg_y_F * t115) + (lqg_y_G * y_raw) + (lqg_y_H * lqg_y_force);
        state->lqg_y_x3 = lqg_y_x3_next;

        /* lqg_phi: (28)-(35), (49) */
        const float t121 = phi_ref_held - phi_raw;
        const bool t122 = fabsf(t121) <= 0.008f;
        const float lqg_phi_integral = state->lqg_phi_integral;
        const float lqg_phi_force = state->lqg_phi_force;
        const float t123 = t116 + t113 + (lqg_phi_on_force * lqg_phi_force);
        const float d_phi = (lqg_phi_on_error * ((t122) ? t121 : ((t121 < 0.0f) ? -0.008f : 0.008f))) + (lqg_phi_integral - t123);
        const float lqg_phi_x3_next = (lqg_phi_F * t116) + (lqg_phi_G * phi_raw) + (lqg_phi_H * lqg_phi_force);
        state->lqg_phi_x3 = lqg_phi_x3_next;

        /* loop_z: (23) */
        const float t124 = z_ref_held - z;
        const float loop_z_lag = state->loop_z_lag;
        const float loop_z_integral = state->loop_z_integral;
        const float d_z = (loop_z_direct * t124) + loop_z_lag + loop_z_integral;
        const float loop_z_lag_next = loop_z_into_lag * t124;
        state->loop_z_lag = loop_z_lag_next;

        /* loop_theta: (24) */
        const float t125 = theta_ref_held - theta;
        const float loop_theta_lag = state->loop_theta_lag;
        const float loop_theta_integral = state->loop_theta_integral;
        const float d_theta = (loop_theta_direct * t125) + loop_theta_lag + loop_theta_integral;
        const float loop_theta_lag_next = loop_theta_into_lag * t125;
        state->loop_theta_lag = loop_theta_lag_next;

        /* loop_psi: (25) */
        const float t126 = psi_ref_held - psi;
        const float loop_psi_lag = state->loop_psi_lag;
        const float loop_psi_integral = state->loop_psi_integral;
        const float d_psi = (loop_psi_direct * t126) + loop_psi_lag + loop_psi_integral;
        const float loop_psi_lag_next = loop_psi_into_lag * t126;
        state->loop_psi_lag = loop_psi_lag_next;

        /* allocation: Table 3, (17), limits */
        const float t127 = phi_raw * phi_raw;
        const float t128 = f1_polynomial(t127);
        const float t129 = phi_raw * f2_polynomial(t127);
        const float t130 = 0.5f * ((t128 * d_y) - (t129 * d_x));
        const float i_CQ = limit((t128 * d_x) + (t129 * d_y), 1.197f);
        const float t131 = d_phi + i_CQ;
        const float i_AQ = limit(t130 - t131, 1.197f);
        const float i_BQ = limit(t130 + t131, 1.197f);
        const float t132 = d_z - d_theta;
        const float i_AD = limit(t132 + d_psi, sqrtf(1.5876f - (i_AQ * i_AQ)));
        const float i_BD = limit(t132 - d_psi, sqrtf(1.5876f - (i_BQ * i_BQ)));

        /* loop_psi: (25) */
        const float loop_psi_integral_next = (loop_psi_reset * loop_psi_integral) + (loop_psi_driven_x_allocation_half * (i_AD - i_BD));
        state->loop_psi_integral = loop_psi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float i_CD = limit(d_z + (2.0f * d_theta), sqrtf(1.5876f - (i_CQ * i_CQ)));

        /* loop_z: (23) */
        const float t133 = i_AD + i_BD;
        const float loop_z_integral_next = (loop_z_reset * loop_z_integral) + (loop_z_driven_x_allocation_part * (t133 + i_CD));
        state->loop_z_integral = loop_z_integral_next;

        /* allocation: Table 3, (17), limits */
        const float t134 = i_AQ + i_BQ;
        const float made_x = (t128 * i_CQ) - (t129 * t134);

        /* lqg_x: (28)-(35), (49) */
        const float lqg_x_integral_next = (lqg_x_kept * lqg_x_integral) + (lqg_x_driven * (made_x + t117));
        state->lqg_x_integral = (t110) ? lqg_x_integral_next : lqg_x_integral;
        state->lqg_x_force = made_x;

        /* allocation: Table 3, (17), limits */
        const float made_y = (t129 * i_CQ) + (t128 * t134);

        /* lqg_y: (28)-(35), (49) */
        const float lqg_y_integral_next = (lqg_y_kept * lqg_y_integral) + (lqg_y_driven * (made_y + t120));
        state->lqg_y_integral = (t119) ? lqg_y_integral_next : lqg_y_integral;
        state->lqg_y_force = made_y;

        /* allocation: Table 3, (17), limits */
        const float made_phi = (allocation_half * (i_BQ - i_AQ)) - i_CQ;

        /* lqg_phi: (28)-(35), (49) */
        const float lqg_phi_integral_next = (lqg_phi_kept * lqg_phi_integral) + (lqg_phi_driven * (made_phi + t123));
        state->lqg_phi_integral = (t122) ? lqg_phi_integral_next : lqg_phi_integral;
        state->lqg_phi_force = made_phi;

        /* allocation: Table 3, (17), limits */
        const float made_theta = (allocation_part * i_CD) - (allocation_front_part * t133);

        /* loop_theta: (24) */
        const float loop_theta_integral_next = (loop_theta_reset * loop_theta_integral) + (loop_theta_driven * made_theta);
        state->loop_theta_integral = loop_theta_integral_next;

        /* commutation: (17) inverted */
        const float distance_back = within_x - (0.025584769f * t129);
        const float quarter_sine_back = distance_back * quarter_sine_back_polynomial(distance_back * distance_back);
        const float distance_front = within_y - ((0.012792384f * t128) - 0.0127f);
        const float quarter_sine_front = distance_front * quarter_sine_front_polynomial(distance_front * distance_front);
        const float t135 = quarter_sine_front * quarter_sine_front;
        const float t136 = quarter_sine_front * sqrtf(1.0f - t135);
        const float t137 = t136 * (4.0f - (8.0f * t135));
        const float t138 = f5_polynomial(t127);
        const float t139 = t137 * t138;
        const float t140 = 1.0f - (8.0f * (t136 * t136));
        const float t141 = phi_raw * f6_polynomial(t127);
        const float t142 = t140 * t141;
        const float t143 = t139 - t142;
        const float t144 = t140 * t138;
        const float t145 = t137 * t141;
        const float t146 = t144 + t145;
        const float i_AA_computed = limit((t143 * i_AQ) + (t146 * i_AD), 1.26f);
        state->safe_output_last_i_AA = i_AA_computed;
        out->i_AA = i_AA_computed;
        const float t147 = 0.8660254f * ((t143 * i_AD) - (t146 * i_AQ));
        const float t148 = 0.5f * i_AA_computed;
        const float i_AB_computed = limit(t147 - t148, 1.26f);
        state->safe_output_last_i_AB = i_AB_computed;
        out->i_AB = i_AB_computed;
        const float i_AC_computed = limit(-(t148 + t147), 1.26f);
        state->safe_output_last_i_AC = i_AC_computed;
        out->i_AC = i_AC_computed;
        const float t149 = t139 + t142;
        const float t150 = t145 - t144;
        const float i_BA_computed = limit((t149 * i_BQ) - (t150 * i_BD), 1.26f);
        state->safe_output_last_i_BA = i_BA_computed;
        out->i_BA = i_BA_computed;
        const float t151 = 0.8660254f * ((t150 * i_BQ) + (t149 * i_BD));
        const float t152 = 0.5f * i_BA_computed;
        const float i_BB_computed = limit(t151 - t152, 1.26f);
        state->safe_output_last_i_BB = i_BB_computed;
        out->i_BB = i_BB_computed;
        const float i_BC_computed = limit(-(t152 + t151), 1.26f);
        state->safe_output_last_i_BC = i_BC_computed;
        out->i_BC = i_BC_computed;
        const float t153 = quarter_sine_back * quarter_sine_back;
        const float t154 = quarter_sine_back * sqrtf(1.0f - t153);
        const float t155 = 1.0f - (8.0f * (t154 * t154));
        const float t156 = t154 * (4.0f - (8.0f * t153));
        const float i_CA_computed = limit((t155 * i_CQ) - (t156 * i_CD), 1.26f);
        state->safe_output_last_i_CA = i_CA_computed;
        out->i_CA = i_CA_computed;
        const float t157 = 0.8660254f * ((t156 * i_CQ) + (t155 * i_CD));
        const float t158 = 0.5f * i_CA_computed;
        const float i_CB_computed = limit(t157 - t158, 1.26f);
        state->safe_output_last_i_CB = i_CB_computed;
        out->i_CB = i_CB_computed;
        const float i_CC_computed = limit(-(t158 + t157), 1.26f);
        state->safe_output_last_i_CC = i_CC_computed;
        out->i_CC = i_CC_computed;
    }

    return faults;
}
