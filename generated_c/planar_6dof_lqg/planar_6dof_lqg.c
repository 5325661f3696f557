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

/* f1_polynomial for clamp(phi, -0.02, 0.02) in -0.0199999996 .. 0.0199999996: t = x^2, x = clamp(phi, -0.02, 0.02);
 * relative error at most 6e-08. */
static inline float f1_polynomial(float t)
{
    return 1.0f + (t * -0.49998608f);
}

/* f2_polynomial for clamp(phi, -0.02, 0.02) in -0.0199999996 .. 0.0199999996: f2_polynomial / x, t = x^2, x = clamp(phi, -0.02, 0.02);
 * relative error at most 1.2e-07. */
static inline float f2_polynomial(float t)
{
    return 1.0f + (t * -0.16666389f);
}

/* quarter_sine_back for distance_back in -0.0279399995 .. 0.0279399995: quarter_sine_back / x, t = x^2, x = distance_back;
 * relative error at most 2.9e-06. */
static inline float quarter_sine_back_polynomial(float t)
{
    return 30.921104f + (t * (-4925.5317f + (t * 229288.05f)));
}

/* f4_polynomial for clamp(phi, -0.02, 0.02) in -0.0199999996 .. 0.0199999996: t = x^2, x = clamp(phi, -0.02, 0.02);
 * relative error at most 6e-08. */
static inline float f4_polynomial(float t)
{
    return 1.0f + (t * -1.2514881f);
}

/* f5_polynomial for clamp(phi, -0.02, 0.02) in -0.0199999996 .. 0.0199999996: f5_polynomial / x, t = x^2, x = clamp(phi, -0.02, 0.02);
 * relative error at most 1.1e-07. */
static inline float f5_polynomial(float t)
{
    return 1.5822228f + (t * -0.9237254f);
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
    state->sensing_count_x = 0.0f;
    state->sensing_count_y = 0.0f;
    state->sensing_doubt = 0u;
    state->sensing_named = 0u;
    state->sensing_found_V_ax = 0u;
    state->sensing_found_V_ay = 0u;
    state->sensing_found_V_bx = 0u;
    state->sensing_found_V_by = 0u;
    state->sensing_found_V_cx = 0u;
    state->sensing_found_V_cy = 0u;
    state->positions_last_x = 0.0f;
    state->positions_last_y = 0.0f;
    state->positions_last_phi = 0.0f;
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
    static const float loop_z_driven = 0.0124223605f;           /* 1; (23): 1 less that */
    static const float loop_theta_direct = 427.24356f;          /* A/rad; (24): gain of the error */
    static const float loop_theta_into_lag = -386.5337f;        /* A/rad; (24): gain times pole less zero */
    static const float loop_theta_reset = 0.9875776f;           /* 1; (24): zero of the integrator in z */
    static const float loop_theta_driven = 0.0124223605f;       /* 1; (24): 1 less that */
    static const float loop_psi_direct = 469.96793f;            /* A/rad; (25): gain of the error */
    static const float loop_psi_into_lag = -425.18707f;         /* A/rad; (25): gain times pole less zero */
    static const float loop_psi_reset = 0.9875776f;             /* 1; (25): zero of the integrator in z */
    static const float loop_psi_driven = 0.0124223605f;         /* 1; (25): 1 less that */

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
    const uint32_t sensing_named = state->sensing_named;

    /* guard: range acceptance, hold, latch */
    bool complete = false;
    uint32_t faults = t2;
    if (sensing_named != 0u) {
        /* sensing: (1)-(5) */
        const uint32_t sensing_found_V_ax = state->sensing_found_V_ax;
        const uint32_t sensing_found_V_ay = state->sensing_found_V_ay;
        const uint32_t sensing_found_V_bx = state->sensing_found_V_bx;
        const uint32_t sensing_found_V_by = state->sensing_found_V_by;
        const uint32_t sensing_found_V_cx = state->sensing_found_V_cx;
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
    const uint32_t sensing_found_V_ax_2 = state->sensing_found_V_ax;
    const uint32_t sensing_found_V_ay_2 = state->sensing_found_V_ay;
    const uint32_t sensing_found_V_bx_2 = state->sensing_found_V_bx;
    const uint32_t sensing_found_V_by_2 = state->sensing_found_V_by;
    const uint32_t sensing_found_V_cx_2 = state->sensing_found_V_cx;
    const uint32_t sensing_found_V_cy_2 = state->sensing_found_V_cy;
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
        /* positions: (3) */
        const float positions_last_phi = state->positions_last_phi;
        const float positions_last_x = state->positions_last_x;

        /* sensing: (1)-(5) */
        const float t13 = positions_last_phi * V_ay_held;
        const float t14 = V_ax_held - t13;
        const float t15 = t14 * t14;
        const float t16 = t13 - V_bx_held;
        const float t17 = t16 * t16;
        const float t18 = t14 * t16;
        const float t19 = t18 * t18;
        const float m_x = t15 + t17 - (sensing_power_0 + (t19 * (sensing_power_1 + (t19 * sensing_power_2))));
        const bool t20 = 1.2919496f < fabsf(m_x);
        const float t21 = positions_last_phi * V_ax_held;
        const float t22 = V_ay_held + t21;
        const float t23 = t22 * t22;
        const float t24 = V_cy_held + t21;
        const float t25 = t24 * t24;
        const float t26 = t22 * t24;
        const float t27 = t26 * t26;
        const float m_y = t23 + t25 - (sensing_power_0 + (t27 * (sensing_power_1 + (t27 * sensing_power_2))));
        const bool t28 = 1.2919496f < fabsf(m_y);
        const float t29 = t16 + t14 - (t24 * t25 * (sensing_slope_0 + (t23 * sensing_slope_1)));
        const float r_1 = V_by_held - V_ay_held - (t29 * positions_last_phi);
        const float t30 = (t16 * t17 * (sensing_slope_0 + (t15 * sensing_slope_1))) + (t22 - t24);
        const float r_2 = V_cx_held - V_ax_held + (t30 * positions_last_phi);
        const bool t31 = (0.23478326f < fabsf(r_1)) || (0.23478326f < fabsf(r_2));
        const bool t32 = (t20 || t28 || t31) && (guard_ready != 0u) && complete;
        const bool t33 = !t32 && complete;
        const float positions_last_y = state->positions_last_y;
        const float sensing_count_x = state->sensing_count_x;
        const float sensing_count_y = state->sensing_count_y;
        const float t34 = t29 * r_1;
        const float t35 = t30 * r_2;
        const float t36 = t29 * t29;
        const float t37 = t30 * t30;
        const float t38 = t36 + t37;
        float x_raw = positions_last_x;
        float y_raw = positions_last_y;
        float t39 = 0.0f;
        float pitch_x = sensing_count_x;
        float pitch_y = sensing_count_y;
        if (t33) {
            float t40;
            if (t15 <= t17) {
                const float t41 = limit(t18 / (t17 + 8.612998e-06f), 1.0f);
                const float t42 = t41 * t41;
                const float t43 = sensing_position_1 + (t42 * (sensing_position_3 + (t42 * (sensing_position_5 + (t42 * sensing_position_7)))));
                const float t44 = t41 * t43;
                if (t16 < 0.0f) {
                    if (0.0f < t44) {
                        t40 = t44 - 0.0254f;
                    } else {
                        t40 = t44 + 0.0254f;
                    }
                } else {
                    t40 = t44;
                }
            } else {
                const float t45 = limit(t18 / (t15 + 8.612998e-06f), 1.0f);
                const float t46 = t45 * t45;
                const float t47 = sensing_position_1 + (t46 * (sensing_position_3 + (t46 * (sensing_position_5 + (t46 * sensing_position_7)))));
                t40 = ((t14 < 0.0f) ? -0.0127f : 0.0127f) - (t45 * t47);
            }
            const float t48 = t40 + (0.0508f * sensing_count_x);
            const float t49 = t48 - positions_last_x;
            if (0.0254f < fabsf(t49)) {
                float t50;
                if (0.0f < t49) {
                    const float t51 = t48 - 0.0508f;
                    x_raw = t51;
                    state->positions_last_x = t51;
                    t50 = sensing_count_x - 1.0f;
                } else {
                    const float t52 = t48 + 0.0508f;
                    x_raw = t52;
                    state->positions_last_x = t52;
                    t50 = sensing_count_x + 1.0f;
                }
                const float sensing_count_x_next = limit(t50, 2.0f);
                pitch_x = sensing_count_x_next;
                state->sensing_count_x = sensing_count_x_next;
            } else {
                x_raw = t48;

                /* positions: (3) */
                state->positions_last_x = t48;
            }
            float t53;
            if (t23 <= t25) {
                const float t54 = limit(-(t26 / (t25 + 8.612998e-06f)), 1.0f);
                const float t55 = t54 * t54;
                const float t56 = sensing_position_1 + (t55 * (sensing_position_3 + (t55 * (sensing_position_5 + (t55 * sensing_position_7)))));
                const float t57 = t54 * t56;
                if (-t24 < 0.0f) {
                    if (0.0f < t57) {
                        t53 = t57 - 0.0254f;
                    } else {
                        t53 = t57 + 0.0254f;
                    }
                } else {
                    t53 = t57;
                }
            } else {
                const float t58 = limit(-(t26 / (t23 + 8.612998e-06f)), 1.0f);
                const float t59 = t58 * t58;
                const float t60 = sensing_position_1 + (t59 * (sensing_position_3 + (t59 * (sensing_position_5 + (t59 * sensing_position_7)))));
                t53 = ((t22 < 0.0f) ? -0.0127f : 0.0127f) - (t58 * t60);
            }
            const float t61 = t53 + (0.0508f * sensing_count_y);
            const float t62 = t61 - positions_last_y;
            if (0.0254f < fabsf(t62)) {
                float t63;
                if (0.0f < t62) {
                    const float t64 = t61 - 0.0508f;
                    y_raw = t64;
                    state->positions_last_y = t64;
                    t63 = sensing_count_y - 1.0f;
                } else {
                    const float t65 = t61 + 0.0508f;
                    y_raw = t65;
                    state->positions_last_y = t65;
                    t63 = sensing_count_y + 1.0f;
                }
                const float sensing_count_y_next = limit(t63, 2.0f);
                pitch_y = sensing_count_y_next;
                state->sensing_count_y = sensing_count_y_next;
            } else {
                y_raw = t61;

                /* positions: (3) */
                state->positions_last_y = t61;
            }
            const float t66 = (t14 * (t22 + t24)) + (t22 * (t14 - t16));
            const float t67 = (t34 - t35 + (sensing_third * (t66 * (m_x - m_y)))) / (t38 + (2.0f * (sensing_third * (t66 * t66))) + 0.08612997f);
            t39 = t67;
        }
        const float phi_raw = limit(positions_last_phi + t39, 0.025f);
        const uint32_t sensing_doubt = state->sensing_doubt;
        if (t32) {
            state->sensing_doubt = 3u;
        } else {
            if (t33 && (sensing_doubt != 0u)) {
                state->sensing_doubt = sensing_doubt - 1u;
            }
        }
        if (t32 && (sensing_doubt != 0u)) {
            const float t68 = fabsf(t34) - fabsf(t35);
            const float t69 = sqrtf(t38 + 8.612998e-06f);
            const float t70 = 0.11739163f * t69;
            const bool t71 = t31 && (t68 < t70);
            const float t72 = t29 / (t36 + 8.612998e-06f);
            const float t73 = r_1 * t72 * V_ay_held;
            const float t74 = t14 - t73;
            const float t75 = t16 + t73;
            const float t76 = t75 * t75;
            const float t77 = t74 * t75;
            const float t78 = t77 * t77;
            const float t79 = (t30 * r_1) + (t29 * r_2);
            const float t80 = t74 + (t79 * t72);
            const float t81 = t80 * t75;
            const float t82 = t81 * t81;
            const float t83 = fabsf((t74 * t74) + t76 - (sensing_power_0 + (t78 * (sensing_power_1 + (t78 * sensing_power_2))))) - fabsf((t80 * t80) + t76 - (sensing_power_0 + (t82 * (sensing_power_1 + (t82 * sensing_power_2)))));
            const bool t84 = !t31;
            const bool t85 = t20 && t84;
            const float t86 = fabsf(t79);
            const float t87 = fabsf(t79 + (t29 * (m_x * t14 / ((2.0f * t15) + 8.612998e-06f)))) - t86;
            const bool sensing_found_V_ax_next = (t71 && (-0.34451988f < t83)) || (t85 && (t87 < t70));
            const float t88 = -0.11739163f * t69;
            const bool t89 = t31 && (t88 < t68);
            const float t90 = t30 / (t37 + 8.612998e-06f);
            const float t91 = r_2 * t90 * V_ax_held;
            const float t92 = t22 - t91;
            const float t93 = t91 - t24;
            const float t94 = t93 * t93;
            const float t95 = t92 * t93;
            const float t96 = t95 * t95;
            const float t97 = t92 + (t79 * t90);
            const float t98 = t97 * t93;
            const float t99 = t98 * t98;
            const float t100 = fabsf((t92 * t92) + t94 - (sensing_power_0 + (t96 * (sensing_power_1 + (t96 * sensing_power_2))))) - fabsf((t97 * t97) + t94 - (sensing_power_0 + (t99 * (sensing_power_1 + (t99 * sensing_power_2)))));
            const bool t101 = t28 && t84;
            const float t102 = fabsf(t79 + (t30 * (m_y * t22 / ((2.0f * t23) + 8.612998e-06f)))) - t86;
            const bool sensing_found_V_ay_next = (t89 && (-0.34451988f < t100)) || (t101 && (t102 < t70));
            const bool sensing_found_V_bx_next = t85 && (t88 < t87);
            const bool sensing_found_V_by_next = t89 && (t100 < 0.34451988f);
            const bool sensing_found_V_cx_next = t71 && (t83 < 0.34451988f);
            const bool t103 = sensing_found_V_ax_next || sensing_found_V_ay_next || sensing_found_V_bx_next || sensing_found_V_by_next || sensing_found_V_cx_next;
            const bool sensing_found_V_cy_next = t101 && (t88 < t102);
            const bool sensing_named_next = t103 || sensing_found_V_cy_next;
            state->sensing_named = flag(sensing_named_next);
            state->sensing_found_V_ax = flag(sensing_found_V_ax_next);
            state->sensing_found_V_ay = flag(sensing_found_V_ay_next);
            state->sensing_found_V_bx = flag(sensing_found_V_bx_next);
            state->sensing_found_V_by = flag(sensing_found_V_by_next);
            state->sensing_found_V_cx = flag(sensing_found_V_cx_next);
            state->sensing_found_V_cy = flag(sensing_found_V_cy_next);
        }
        state->positions_last_phi = phi_raw;

        /* heights: laser distances inverted */
        const float t104 = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (t104 + d3_held);
        const float theta = 8.333333f * (d3_held - t104);
        const float psi = 8.333333f * (d1_held - d2_held);

        /* lqg_x: (28)-(35), (49) */
        const float lqg_x_integral = state->lqg_x_integral;
        const float lqg_x_x3 = state->lqg_x_x3;
        const float lqg_y_x3 = state->lqg_y_x3;
        const float lqg_phi_x3 = state->lqg_phi_x3;
        const float t105 = lqg_x_L * x_raw;
        const float t106 = lqg_y_L * y_raw;
        const float t107 = lqg_phi_L * phi_raw;
        float t108 = lqg_x_x3;
        float t109 = lqg_y_x3;
        float t110 = lqg_phi_x3;
        if (!(guard_ready != 0u)) {
            t108 = -t105;
            t109 = -t106;
            t110 = -t107;
        }
        const float lqg_x_force = state->lqg_x_force;
        const float t111 = t108 + t105 + (lqg_x_on_force * lqg_x_force);
        const float d_x = (lqg_x_on_error * (x_ref_held - x_raw)) + (lqg_x_integral - t111);
        const float lqg_x_x3_next = (lqg_x_F * t108) + (lqg_x_G * x_raw) + (lqg_x_H * lqg_x_force);
        state->lqg_x_x3 = lqg_x_x3_next;

        /* lqg_y: (28)-(35), (49) */
        const float lqg_y_integral = state->lqg_y_integral;
        const float lqg_y_force = state->lqg_y_force;
        const float t112 = t109 + t106 + (lqg_y_on_force * lqg_y_force);
        const float d_y = (lqg_y_on_error * (y_ref_held - y_raw)) + (lqg_y_integral - t112);
        const float lqg_y_x3_next = (lqg_y_F * t109) + (lqg_y_G * y_raw) + (lqg_y_H * lqg_y_force);
        state->lqg_y_x3 = lqg_y_x3_next;

        /* lqg_phi: (28)-(35), (49) */
        const float lqg_phi_integral = state->lqg_phi_integral;
        const float lqg_phi_force = state->lqg_phi_force;
        const float t113 = t110 + t107 + (lqg_phi_on_force * lqg_phi_force);
        const float d_phi = (lqg_phi_on_error * (phi_ref_held - phi_raw)) + (lqg_phi_integral - t113);
        const float lqg_phi_x3_next = (lqg_phi_F * t110) + (lqg_phi_G * phi_raw) + (lqg_phi_H * lqg_phi_force);
        state->lqg_phi_x3 = lqg_phi_x3_next;

        /* loop_z: (23) */
        const float t114 = z_ref_held - z;
        const float loop_z_lag = state->loop_z_lag;
        const float loop_z_integral = state->loop_z_integral;
        const float d_z = (loop_z_direct * t114) + loop_z_lag + loop_z_integral;
        const float loop_z_lag_next = loop_z_into_lag * t114;
        state->loop_z_lag = loop_z_lag_next;

        /* loop_theta: (24) */
        const float t115 = theta_ref_held - theta;
        const float loop_theta_lag = state->loop_theta_lag;
        const float loop_theta_integral = state->loop_theta_integral;
        const float d_theta = (loop_theta_direct * t115) + loop_theta_lag + loop_theta_integral;
        const float loop_theta_lag_next = loop_theta_into_lag * t115;
        state->loop_theta_lag = loop_theta_lag_next;

        /* loop_psi: (25) */
        const float t116 = psi_ref_held - psi;
        const float loop_psi_lag = state->loop_psi_lag;
        const float loop_psi_integral = state->loop_psi_integral;
        const float d_psi = (loop_psi_direct * t116) + loop_psi_lag + loop_psi_integral;
        const float loop_psi_lag_next = loop_psi_into_lag * t116;
        state->loop_psi_lag = loop_psi_lag_next;

        /* allocation: Table 3, (17), limits */
        const float t117 = limit(phi_raw, 0.02f);
        const float t118 = t117 * t117;
        const float t119 = f1_polynomial(t118);
        const float t120 = t117 * f2_polynomial(t118);
        const float t121 = 0.5f * ((t119 * d_y) - (t120 * d_x));
        const float t122 = (t119 * d_x) + (t120 * d_y);
        const float t123 = d_phi + t122;
        const float i_AQ = limit(t121 - t123, 1.197f);
        const float i_BQ = limit(t121 + t123, 1.197f);
        const float i_CQ = limit(t122, 1.197f);
        const float t124 = d_z - d_theta;
        const float i_AD = limit(t124 + d_psi, sqrtf(1.5876f - (i_AQ * i_AQ)));
        const float i_BD = limit(t124 - d_psi, sqrtf(1.5876f - (i_BQ * i_BQ)));

        /* loop_psi: (25) */
        const float loop_psi_integral_next = (loop_psi_reset * loop_psi_integral) + (0.5f * (loop_psi_driven * (i_AD - i_BD)));
        state->loop_psi_integral = loop_psi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float i_CD = limit(d_z + (2.0f * d_theta), sqrtf(1.5876f - (i_CQ * i_CQ)));

        /* loop_z: (23) */
        const float t125 = i_AD + i_BD;
        const float loop_z_integral_next = (loop_z_reset * loop_z_integral) + (0.33333334f * (loop_z_driven * (t125 + i_CD)));
        state->loop_z_integral = loop_z_integral_next;

        /* allocation: Table 3, (17), limits */
        const float t126 = i_AQ + i_BQ;
        const float made_x = (t119 * i_CQ) - (t120 * t126);

        /* lqg_x: (28)-(35), (49) */
        const float lqg_x_integral_next = (lqg_x_kept * lqg_x_integral) + (lqg_x_driven * (made_x + t111));
        state->lqg_x_integral = lqg_x_integral_next;
        state->lqg_x_force = made_x;

        /* allocation: Table 3, (17), limits */
        const float made_y = (t120 * i_CQ) + (t119 * t126);

        /* lqg_y: (28)-(35), (49) */
        const float lqg_y_integral_next = (lqg_y_kept * lqg_y_integral) + (lqg_y_driven * (made_y + t112));
        state->lqg_y_integral = lqg_y_integral_next;
        state->lqg_y_force = made_y;

        /* allocation: Table 3, (17), limits */
        const float made_phi = (0.5f * (i_BQ - i_AQ)) - i_CQ;

        /* lqg_phi: (28)-(35), (49) */
        const float lqg_phi_integral_next = (lqg_phi_kept * lqg_phi_integral) + (lqg_phi_driven * (made_phi + t113));
        state->lqg_phi_integral = lqg_phi_integral_next;
        state->lqg_phi_force = made_phi;

        /* allocation: Table 3, (17), limits */
        const float made_theta = (0.33333334f * i_CD) - (0.16666667f * t125);

        /* loop_theta: (24) */
        const float loop_theta_integral_next = (loop_theta_reset * loop_theta_integral) + (loop_theta_driven * made_theta);
        state->loop_theta_integral = loop_theta_integral_next;

        /* commutation: (17) inverted */
        const float distance_back = limit(x_raw - (0.0508f * pitch_x) - (0.025584769f * t120), 0.02794f);
        const float quarter_sine_back = distance_back * quarter_sine_back_polynomial(distance_back * distance_back);
        const float distance_front = limit(y_raw - (0.0508f * pitch_y) - ((0.012792384f * t119) - 0.0127f), 0.02794f);
        const float quarter_sine_front = distance_front * quarter_sine_back_polynomial(distance_front * distance_front);
        const float t127 = quarter_sine_front * quarter_sine_front;
        const float t128 = quarter_sine_front * sqrtf(1.0f - t127);
        const float t129 = t128 * (4.0f - (8.0f * t127));
        const float t130 = f4_polynomial(t118);
        const float t131 = t129 * t130;
        const float t132 = 1.0f - (8.0f * (t128 * t128));
        const float t133 = t117 * f5_polynomial(t118);
        const float t134 = t132 * t133;
        const float t135 = t131 - t134;
        const float t136 = t132 * t130;
        const float t137 = t129 * t133;
        const float t138 = t136 + t137;
        const float i_AA_computed = (t135 * i_AQ) + (t138 * i_AD);

        /* safe_output: slew to the safe output once latched */
        const float t139 = limit(i_AA_computed, 1.26f);
        state->safe_output_last_i_AA = t139;
        out->i_AA = t139;

        /* commutation: (17) inverted */
        const float t140 = 0.8660254f * ((t135 * i_AD) - (t138 * i_AQ));
        const float t141 = 0.5f * i_AA_computed;
        const float i_AB_computed = t140 - t141;

        /* safe_output: slew to the safe output once latched */
        const float t142 = limit(i_AB_computed, 1.26f);
        state->safe_output_last_i_AB = t142;
        out->i_AB = t142;

        /* commutation: (17) inverted */
        const float i_AC_computed = -(t140 + t141);

        /* safe_output: slew to the safe output once latched */
        const float t143 = limit(i_AC_computed, 1.26f);
        state->safe_output_last_i_AC = t143;
        out->i_AC = t143;

        /* commutation: (17) inverted */
        const float t144 = t131 + t134;
        const float t145 = t137 - t136;
        const float i_BA_computed = (t144 * i_BQ) - (t145 * i_BD);

        /* safe_output: slew to the safe output once latched */
        const float t146 = limit(i_BA_computed, 1.26f);
        state->safe_output_last_i_BA = t146;
        out->i_BA = t146;

        /* commutation: (17) inverted */
        const float t147 = 0.8660254f * ((t145 * i_BQ) + (t144 * i_BD));
        const float t148 = 0.5f * i_BA_computed;
        const float i_BB_computed = t147 - t148;

        /* safe_output: slew to the safe output once latched */
        const float t149 = limit(i_BB_computed, 1.26f);
        state->safe_output_last_i_BB = t149;
        out->i_BB = t149;

        /* commutation: (17) inverted */
        const float i_BC_computed = -(t147 + t148);

        /* safe_output: slew to the safe output once latched */
        const float t150 = limit(i_BC_computed, 1.26f);
        state->safe_output_last_i_BC = t150;
        out->i_BC = t150;

        /* commutation: (17) inverted */
        const float t151 = quarter_sine_back * quarter_sine_back;
        const float t152 = quarter_sine_back * sqrtf(1.0f - t151);
        const float t153 = 1.0f - (8.0f * (t152 * t152));
        const float t154 = t152 * (4.0f - (8.0f * t151));
        const float i_CA_computed = (t153 * i_CQ) - (t154 * i_CD);

        /* safe_output: slew to the safe output once latched */
        const float t155 = limit(i_CA_computed, 1.26f);
        state->safe_output_last_i_CA = t155;
        out->i_CA = t155;

        /* commutation: (17) inverted */
        const float t156 = 0.8660254f * ((t154 * i_CQ) + (t153 * i_CD));
        const float t157 = 0.5f * i_CA_computed;
        const float i_CB_computed = t156 - t157;

        /* safe_output: slew to the safe output once latched */
        const float t158 = limit(i_CB_computed, 1.26f);
        state->safe_output_last_i_CB = t158;
        out->i_CB = t158;

        /* commutation: (17) inverted */
        const float i_CC_computed = -(t156 + t157);

        /* safe_output: slew to the safe output once latched */
        const float t159 = limit(i_CC_computed, 1.26f);
        state->safe_output_last_i_CC = t159;
        out->i_CC = t159;
    }

    return faults;
}
