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
    bool t3 = true;
    if (fabsf(d1) <= 0.0005f) {
        state->guard_last_d1 = d1;
    } else {
        d1_held = state->guard_last_d1;
        t3 = false;
        t2 |= 0x00000040u;
    }
    const float d2 = in->d2;
    float d2_held = d2;
    if (fabsf(d2) <= 0.0005f) {
        state->guard_last_d2 = d2;
    } else {
        d2_held = state->guard_last_d2;
        t3 = false;
        t2 |= 0x00000080u;
    }
    const float d3 = in->d3;
    float d3_held = d3;
    if (fabsf(d3) <= 0.0005f) {
        state->guard_last_d3 = d3;
    } else {
        d3_held = state->guard_last_d3;
        t3 = false;
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
    if (fabsf(phi_ref) <= 0.008f) {
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
        uint32_t t4 = t2;
        if (sensing_found_V_ax != 0u) {
            t4 = t2 | 0x00008000u;
        }
        if (sensing_found_V_ay != 0u) {
            t4 |= 0x00010000u;
        }
        if (sensing_found_V_bx != 0u) {
            t4 |= 0x00020000u;
        }
        if (sensing_found_V_by != 0u) {
            t4 |= 0x00040000u;
        }
        if (sensing_found_V_cx != 0u) {
            t4 |= 0x00080000u;
        }
        if (sensing_found_V_cy != 0u) {
            faults = t4 | 0x00100000u;
        } else {
            faults = t4;
        }
    } else {
        complete = t1;
    }
    const uint32_t guard_latched = state->guard_latched;
    const uint32_t guard_ready = state->guard_ready;
    uint32_t latched = guard_latched;
    if (complete && t3) {
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
        const float t5 = max(min(0.0f, safe_output_last_i_AA + 0.1575f), safe_output_last_i_AA - 0.1575f);
        out->i_AA = t5;
        const float safe_output_last_i_AB = state->safe_output_last_i_AB;
        const float t6 = max(min(0.0f, safe_output_last_i_AB + 0.1575f), safe_output_last_i_AB - 0.1575f);
        out->i_AB = t6;
        const float safe_output_last_i_AC = state->safe_output_last_i_AC;
        const float t7 = max(min(0.0f, safe_output_last_i_AC + 0.1575f), safe_output_last_i_AC - 0.1575f);
        out->i_AC = t7;
        const float safe_output_last_i_BA = state->safe_output_last_i_BA;
        const float t8 = max(min(0.0f, safe_output_last_i_BA + 0.1575f), safe_output_last_i_BA - 0.1575f);
        out->i_BA = t8;
        const float safe_output_last_i_BB = state->safe_output_last_i_BB;
        const float t9 = max(min(0.0f, safe_output_last_i_BB + 0.1575f), safe_output_last_i_BB - 0.1575f);
        out->i_BB = t9;
        const float safe_output_last_i_BC = state->safe_output_last_i_BC;
        const float t10 = max(min(0.0f, safe_output_last_i_BC + 0.1575f), safe_output_last_i_BC - 0.1575f);
        out->i_BC = t10;
        const float safe_output_last_i_CA = state->safe_output_last_i_CA;
        const float t11 = max(min(0.0f, safe_output_last_i_CA + 0.1575f), safe_output_last_i_CA - 0.1575f);
        out->i_CA = t11;
        const float safe_output_last_i_CB = state->safe_output_last_i_CB;
        const float t12 = max(min(0.0f, safe_output_last_i_CB + 0.1575f), safe_output_last_i_CB - 0.1575f);
        out->i_CB = t12;
        const float safe_output_last_i_CC = state->safe_output_last_i_CC;
        state->safe_output_last_i_AA = t5;
        state->safe_output_last_i_AB = t6;
        state->safe_output_last_i_AC = t7;
        state->safe_output_last_i_BA = t8;
        state->safe_output_last_i_BB = t9;
        state->safe_output_last_i_BC = t10;
        state->safe_output_last_i_CA = t11;
        state->safe_output_last_i_CB = t12;
        const float t13 = max(min(0.0f, safe_output_last_i_CC + 0.1575f), safe_output_last_i_CC - 0.1575f);
        state->safe_output_last_i_CC = t13;
        out->i_CC = t13;

        /* guard: range acceptance, hold, latch */
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* sensing: (1)-(5) */
        const float sensing_phi_raw = state->sensing_phi_raw;
        const float t14 = sensing_phi_raw * V_ay_held;
        const float t15 = V_ax_held - t14;
        const float t16 = t15 * t15;
        const float t17 = t14 - V_bx_held;
        const float t18 = t17 * t17;
        const float t19 = t15 * t17;
        const float t20 = t19 * t19;
        const float m_x = t16 + t18 - (sensing_power_0 + (t20 * (sensing_power_1 + (t20 * sensing_power_2))));
        const bool t21 = 1.2919496f < fabsf(m_x);
        const float t22 = sensing_phi_raw * V_ax_held;
        const float t23 = V_ay_held + t22;
        const float t24 = t23 * t23;
        const float t25 = V_cy_held + t22;
        const float t26 = t25 * t25;
        const float t27 = t23 * t25;
        const float t28 = t27 * t27;
        const float m_y = t24 + t26 - (sensing_power_0 + (t28 * (sensing_power_1 + (t28 * sensing_power_2))));
        const bool t29 = 1.2919496f < fabsf(m_y);
        const float t30 = t17 + t15 - (t25 * t26 * (sensing_slope_0 + (t24 * sensing_slope_1)));
        const float r_1 = V_by_held - V_ay_held - (t30 * sensing_phi_raw);
        const float t31 = (t17 * t18 * (sensing_slope_0 + (t16 * sensing_slope_1))) + (t23 - t25);
        const float r_2 = V_cx_held - V_ax_held + (t31 * sensing_phi_raw);
        const bool t32 = (0.23478326f < fabsf(r_1)) || (0.23478326f < fabsf(r_2));
        const bool t33 = (t21 || t29 || t32) && (guard_ready != 0u) && complete;
        const bool t34 = !t33 && complete;
        const float sensing_within_x = state->sensing_within_x;
        const float sensing_offset_x = state->sensing_offset_x;
        const float t35 = sensing_within_x + sensing_offset_x;
        const float sensing_within_y = state->sensing_within_y;
        const float sensing_offset_y = state->sensing_offset_y;
        const float t36 = sensing_within_y + sensing_offset_y;
        const float t37 = t30 * r_1;
        const float t38 = t31 * r_2;
        const float t39 = t30 * t30;
        const float t40 = t31 * t31;
        const float t41 = t39 + t40;
        float x_raw = t35;
        float y_raw = t36;
        float t42 = 0.0f;
        float within_x = sensing_within_x;
        float within_y = sensing_within_y;
        if (t34) {
            float sensing_within_x_next;
            if (t16 <= t18) {
                const float t43 = limit(t19 / (t18 + 8.612998e-06f), 1.0f);
                const float t44 = t43 * t43;
                const float t45 = sensing_position_1 + (t44 * (sensing_position_3 + (t44 * (sensing_position_5 + (t44 * sensing_position_7)))));
                const float t46 = t43 * t45;
                if (t17 < 0.0f) {
                    if (0.0f < t46) {
                        sensing_within_x_next = t46 - 0.0254f;
                    } else {
                        sensing_within_x_next = t46 + 0.0254f;
                    }
                } else {
                    sensing_within_x_next = t46;
                }
            } else {
                const float t47 = limit(t19 / (t16 + 8.612998e-06f), 1.0f);
                const float t48 = t47 * t47;
                const float t49 = sensing_position_1 + (t48 * (sensing_position_3 + (t48 * (sensing_position_5 + (t48 * sensing_position_7)))));
                sensing_within_x_next = ((t15 < 0.0f) ? -0.0127f : 0.0127f) - (t47 * t49);
            }
            const float t50 = sensing_within_x_next + sensing_offset_x - t35;
            float t51 = sensing_offset_x;
            if (0.0254f < fabsf(t50)) {
                if (0.0f < t50) {
                    const float t52 = max(sensing_offset_x - 0.0508f, -0.1016f);
                    t51 = t52;
                    state->sensing_offset_x = t52;
                } else {
                    const float t53 = min(sensing_offset_x + 0.0508f, 0.1016f);
                    t51 = t53;
                    state->sensing_offset_x = t53;
                }
            }
            x_raw = sensing_within_x_next + t51;
            float sensing_within_y_next;
            if (t24 <= t26) {
                const float t54 = limit(-(t27 / (t26 + 8.612998e-06f)), 1.0f);
                const float t55 = t54 * t54;
                const float t56 = sensing_position_1 + (t55 * (sensing_position_3 + (t55 * (sensing_position_5 + (t55 * sensing_position_7)))));
                const float t57 = t54 * t56;
                if (-t25 < 0.0f) {
                    if (0.0f < t57) {
                        sensing_within_y_next = t57 - 0.0254f;
                    } else {
                        sensing_within_y_next = t57 + 0.0254f;
                    }
                } else {
                    sensing_within_y_next = t57;
                }
            } else {
                const float t58 = limit(-(t27 / (t24 + 8.612998e-06f)), 1.0f);
                const float t59 = t58 * t58;
                const float t60 = sensing_position_1 + (t59 * (sensing_position_3 + (t59 * (sensing_position_5 + (t59 * sensing_position_7)))));
                sensing_within_y_next = ((t23 < 0.0f) ? -0.0127f : 0.0127f) - (t58 * t60);
            }
            const float t61 = sensing_within_y_next + sensing_offset_y - t36;
            float t62 = sensing_offset_y;
            if (0.0254f < fabsf(t61)) {
                if (0.0f < t61) {
                    const float t63 = max(sensing_offset_y - 0.0508f, -0.1016f);
                    t62 = t63;
                    state->sensing_offset_y = t63;
                } else {
                    const float t64 = min(sensing_offset_y + 0.0508f, 0.1016f);
                    t62 = t64;
                    state->sensing_offset_y = t64;
                }
            }
            y_raw = sensing_within_y_next + t62;
            const float t65 = (t15 * (t23 + t25)) + (t23 * (t15 - t17));
            const float t66 = (t37 - t38 + (sensing_third * (t65 * (m_x - m_y)))) / (t41 + (2.0f * (sensing_third * (t65 * t65))) + 0.08612997f);
            t42 = t66;
            within_x = sensing_within_x_next;
            state->sensing_within_x = sensing_within_x_next;
            within_y = sensing_within_y_next;
            state->sensing_within_y = sensing_within_y_next;
        }
        const float phi_raw = limit(sensing_phi_raw + t42, 0.025f);
        const uint32_t sensing_doubt = state->sensing_doubt;
        const bool t67 = t33 && (3u < sensing_doubt);
        const float t68 = sqrtf(t41 + 8.612998e-06f);
        const float t69 = -0.11739163f * t68;
        const float t70 = fabsf(t37) - fabsf(t38);
        const float t71 = (t31 * r_1) + (t30 * r_2);
        const bool t72 = !t32;
        const float t73 = fabsf(t71);
        const float t74 = 0.11739163f * t68;
        if (t67) {
            state->sensing_doubt = 3u;
            state->sensing_named = 1u;
            const bool t75 = t32 && (t69 < t70);
            const float t76 = t31 / (t40 + 8.612998e-06f);
            const float t77 = limit(-(r_2 * t76), 1.0f) * V_ax_held;
            const float t78 = t23 + t77;
            const float t79 = t25 + t77;
            const float t80 = t79 * t79;
            const float t81 = t78 * t79;
            const float t82 = t81 * t81;
            const float t83 = t78 + limit(t71 * t76, 10.0f);
            const float t84 = t83 * t79;
            const float t85 = t84 * t84;
            const float t86 = fabsf((t78 * t78) + t80 - (sensing_power_0 + (t82 * (sensing_power_1 + (t82 * sensing_power_2))))) - fabsf((t83 * t83) + t80 - (sensing_power_0 + (t85 * (sensing_power_1 + (t85 * sensing_power_2)))));
            const bool t87 = t29 && t72;
            const float t88 = fabsf(t71 + (t31 * (m_y * t23 / ((2.0f * t24) + 8.612998e-06f)))) - t73;
            const bool t89 = (t75 && (-0.34451988f < t86)) || (t87 && (t88 < t74));
            const bool t90 = t75 && (t86 < 0.34451988f);
            const bool t91 = t87 && (t69 < t88);
            const bool t92 = (sensing_found_V_ax != 0u) || t89 || (sensing_found_V_bx != 0u) || t90 || (sensing_found_V_cx != 0u) || t91;
            if (!t92) {
                state->sensing_found_V_ax = 1u;
                state->sensing_found_V_bx = 1u;
                state->sensing_found_V_cx = 1u;
            }
            const bool t93 = !t92;
            const bool sensing_found_V_ay_next = t89 || t93;
            state->sensing_found_V_ay = flag(sensing_found_V_ay_next);
            const bool sensing_found_V_by_next = t90 || t93;
            state->sensing_found_V_by = flag(sensing_found_V_by_next);
            const bool sensing_found_V_cy_next = t91 || t93;
            state->sensing_found_V_cy = flag(sensing_found_V_cy_next);
        } else {
            const bool t94 = t33 && (sensing_doubt != 0u);
            if (t94) {
                state->sensing_doubt = 6u;
            } else {
                if (t33) {
                    state->sensing_doubt = 3u;
                } else {
                    if (t34 && (sensing_doubt != 0u)) {
                        state->sensing_doubt = sensing_doubt - 1u;
                    }
                }
            }
            if (t94 && !t67) {
                const bool t95 = t32 && (t70 < t74);
                const float t96 = t30 / (t39 + 8.612998e-06f);
                const float t97 = limit(r_1 * t96, 1.0f) * V_ay_held;
                const float t98 = t15 - t97;
                const float t99 = t17 + t97;
                const float t100 = t99 * t99;
                const float t101 = t98 * t99;
                const float t102 = t101 * t101;
                const float t103 = t98 + limit(t71 * t96, 10.0f);
                const float t104 = t103 * t99;
                const float t105 = t104 * t104;
                const float t106 = fabsf((t98 * t98) + t100 - (sensing_power_0 + (t102 * (sensing_power_1 + (t102 * sensing_power_2))))) - fabsf((t103 * t103) + t100 - (sensing_power_0 + (t105 * (sensing_power_1 + (t105 * sensing_power_2)))));
                const bool t107 = t21 && t72;
                const float t108 = fabsf(t71 + (t30 * (m_x * t15 / ((2.0f * t16) + 8.612998e-06f)))) - t73;
                state->sensing_found_V_ax = flag((t95 && (-0.34451988f < t106)) || (t107 && (t108 < t74)));
                state->sensing_found_V_bx = flag(t107 && (t69 < t108));
                state->sensing_found_V_cx = flag(t95 && (t106 < 0.34451988f));
            }
        }
        state->sensing_phi_raw = phi_raw;

        /* heights: laser distances inverted */
        const float t109 = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (t109 + d3_held);
        const float theta = 8.333333f * (d3_held - t109);
        const float psi = 8.333333f * (d1_held - d2_held);

        /* lqg_x: (28)-(35), (49) */
        const float t110 = x_ref_held - x_raw;
        const bool t111 = fabsf(t110) <= 0.0015f;
        const float lqg_x_integral = state->lqg_x_integral;
        const float t112 = lqg_x_L * x_raw;
        const float t113 = lqg_y_L * y_raw;
        const float t114 = lqg_phi_L * phi_raw;
        float t115;
        float t116;
        float t117;
        if (guard_ready != 0u) {
            t115 = state->lqg_x_x3;
            t116 = state->lqg_y_x3;
            t117 = state->lqg_phi_x3;
        } else {
            t115 = -t112;
            t116 = -t113;
            t117 = -t114;
        }
        const float lqg_x_force = state->lqg_x_force;
        const float t118 = t115 + t112 + (lqg_x_on_force * lqg_x_force);
        const float d_x = (lqg_x_on_error * ((t111) ? t110 : ((t110 < 0.0f) ? -0.0015f : 0.0015f))) + (lqg_x_integral - t118);
        const float lqg_x_x3_next = (lqg_x_F * t115) + (lqg_x_G * x_raw) + (lqg_x_H * lqg_x_force);
        state->lqg_x_x3 = lqg_x_x3_next;

        /* lqg_y: (28)-(35), (49) */
        const float t119 = y_ref_held - y_raw;
        const bool t120 = fabsf(t119) <= 0.004f;
        const float lqg_y_integral = state->lqg_y_integral;
        const float lqg_y_force = state->lqg_y_force;
        const float t121 = t116 + t113 + (lqg_y_on_force * lqg_y_force);
        const float d_y = (lqg_y_on_error * ((t120) ? t119 : ((t119 < 0.0f) ? -0.004f : 0.004f))) + (lqg_y_integral - t121);
        const float lqg_y_x3_next = (lqg_y_F * t116) + (lqg_y_G * y_raw) + (lqg_y_H * lqg_y_force);
        state->lqg_y_x3 = lqg_y_x3_next;

        /* lqg_phi: (28)-(35), (49) */
        const float t122 = phi_ref_held - phi_raw;
        const bool t123 = fabsf(t122) <= 0.008f;
        const float lqg_phi_integral = state->lqg_phi_integral;
        const float lqg_phi_force = state->lqg_phi_force;
        const float t124 = t117 + t114 + (lqg_phi_on_force * lqg_phi_force);
        const float d_phi = (lqg_phi_on_error * ((t123) ? t122 : ((t122 < 0.0f) ? -0.008f : 0.008f))) + (lqg_phi_integral - t124);
        const float lqg_phi_x3_next = (lqg_phi_F * t117) + (lqg_phi_G * phi_raw) + (lqg_phi_H * lqg_phi_force);
        state->lqg_phi_x3 = lqg_phi_x3_next;

        /* loop_z: (23) */
        const float t125 = z_ref_held - z;
        const float loop_z_lag = state->loop_z_lag;
        const float loop_z_integral = state->loop_z_integral;
        const float d_z = (loop_z_direct * t125) + loop_z_lag + loop_z_integral;
        const float loop_z_lag_next = loop_z_into_lag * t125;
        state->loop_z_lag = loop_z_lag_next;

        /* loop_theta: (24) */
        const float t126 = theta_ref_held - theta;
        const float loop_theta_lag = state->loop_theta_lag;
        const float loop_theta_integral = state->loop_theta_integral;
        const float d_theta = (loop_theta_direct * t126) + loop_theta_lag + loop_theta_integral;
        const float loop_theta_lag_next = loop_theta_into_lag * t126;
        state->loop_theta_lag = loop_theta_lag_next;

        /* loop_psi: (25) */
        const float t127 = psi_ref_held - psi;
        const float loop_psi_lag = state->loop_psi_lag;
        const float loop_psi_integral = state->loop_psi_integral;
        const float d_psi = (loop_psi_direct * t127) + loop_psi_lag + loop_psi_integral;
        const float loop_psi_lag_next = loop_psi_into_lag * t127;
        state->loop_psi_lag = loop_psi_lag_next;

        /* allocation: Table 3, (17), limits */
        const float t128 = phi_raw * phi_raw;
        const float t129 = f1_polynomial(t128);
        const float t130 = phi_raw * f2_polynomial(t128);
        const float i_CQ = limit((t129 * d_x) + (t130 * d_y), 1.134f);
        const float t131 = limit(d_phi + i_CQ, 1.134f);
        const float t132 = limit(0.5f * ((t129 * d_y) - (t130 * d_x)), 1.134f - fabsf(t131));
        const float i_AQ = t132 - t131;
        const float i_BQ = t132 + t131;
        const float t133 = d_z - d_theta;
        const float i_AD = limit(t133 + d_psi, 0.5492213f);
        const float i_BD = limit(t133 - d_psi, 0.5492213f);

        /* loop_psi: (25) */
        const float loop_psi_integral_next = (loop_psi_reset * loop_psi_integral) + (loop_psi_driven_x_allocation_half * (i_AD - i_BD));
        state->loop_psi_integral = loop_psi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float i_CD = limit(d_z + (2.0f * d_theta), 0.5492213f);

        /* loop_z: (23) */
        const float t134 = i_AD + i_BD;
        const float loop_z_integral_next = (loop_z_reset * loop_z_integral) + (loop_z_driven_x_allocation_part * (t134 + i_CD));
        state->loop_z_integral = loop_z_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_x = (t129 * i_CQ) - (2.0f * (t130 * t132));

        /* lqg_x: (28)-(35), (49) */
        const float lqg_x_integral_next = (lqg_x_kept * lqg_x_integral) + (lqg_x_driven * (made_x + t118));
        state->lqg_x_integral = (t111) ? lqg_x_integral_next : lqg_x_integral;
        state->lqg_x_force = made_x;

        /* allocation: Table 3, (17), limits */
        const float made_y = (t130 * i_CQ) + (2.0f * (t129 * t132));

        /* lqg_y: (28)-(35), (49) */
        const float lqg_y_integral_next = (lqg_y_kept * lqg_y_integral) + (lqg_y_driven * (made_y + t121));
        state->lqg_y_integral = (t120) ? lqg_y_integral_next : lqg_y_integral;
        state->lqg_y_force = made_y;

        /* allocation: Table 3, (17), limits */
        const float made_phi = t131 - i_CQ;

        /* lqg_phi: (28)-(35), (49) */
        const float lqg_phi_integral_next = (lqg_phi_kept * lqg_phi_integral) + (lqg_phi_driven * (made_phi + t124));
        state->lqg_phi_integral = (t123) ? lqg_phi_integral_next : lqg_phi_integral;
        state->lqg_phi_force = made_phi;

        /* allocation: Table 3, (17), limits */
        const float made_theta = (allocation_part * i_CD) - (allocation_front_part * t134);

        /* loop_theta: (24) */
        const float loop_theta_integral_next = (loop_theta_reset * loop_theta_integral) + (loop_theta_driven * made_theta);
        state->loop_theta_integral = loop_theta_integral_next;

        /* commutation: (17) inverted */
        const float distance_back = within_x - (0.025584769f * t130);
        const float quarter_sine_back = distance_back * quarter_sine_back_polynomial(distance_back * distance_back);
        const float distance_front = within_y - ((0.012792384f * t129) - 0.0127f);
        const float quarter_sine_front = distance_front * quarter_sine_front_polynomial(distance_front * distance_front);
        const float t135 = quarter_sine_front * quarter_sine_front;
        const float t136 = quarter_sine_front * sqrtf(1.0f - t135);
        const float t137 = t136 * (4.0f - (8.0f * t135));
        const float t138 = f5_polynomial(t128);
        const float t139 = t137 * t138;
        const float t140 = 1.0f - (8.0f * (t136 * t136));
        const float t141 = phi_raw * f6_polynomial(t128);
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
