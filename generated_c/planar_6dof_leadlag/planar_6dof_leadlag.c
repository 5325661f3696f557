/* planar_6dof_leadlag. Generated: do not edit. */
#include "planar_6dof_leadlag.h"
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

/* f1_polynomial for clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609: t = x^2, x = clamp(phi, -0.075, 0.075);
 * relative error at most 2.1e-07. */
static inline float f1_polynomial(float t)
{
    return 0.9999998f + (t * -0.49976957f);
}

/* f2_polynomial for clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609: f2_polynomial / x, t = x^2, x = clamp(phi, -0.075, 0.075);
 * relative error at most 1.5e-07. */
static inline float f2_polynomial(float t)
{
    return 0.99999994f + (t * -0.16661468f);
}

/* quarter_sine_back for distance_back in -0.0272707082 .. 0.0272707082: quarter_sine_back / x, t = x^2, x = distance_back;
 * relative error at most 2.5e-06. */
static inline float quarter_sine_back_polynomial(float t)
{
    return 30.921116f + (t * (-4925.7046f + (t * 229584.3f)));
}

/* quarter_sine_front for distance_front in -0.0254923999 .. 0.0253418665: quarter_sine_front / x, t = x^2, x = distance_front;
 * relative error at most 1.7e-06. */
static inline float quarter_sine_front_polynomial(float t)
{
    return 30.92114f + (t * (-4926.108f + (t * 230339.45f)));
}

/* f5_polynomial for clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609: t = x^2, x = clamp(phi, -0.075, 0.075);
 * relative error at most 2.5e-06. */
static inline float f5_polynomial(float t)
{
    return 0.99999756f + (t * -1.2480829f);
}

/* f6_polynomial for clamp(phi, -0.075, 0.075) in -0.0731832609 .. 0.0731832609: f6_polynomial / x, t = x^2, x = clamp(phi, -0.075, 0.075);
 * relative error at most 1.1e-06. */
static inline float f6_polynomial(float t)
{
    return 1.5822213f + (t * -0.9215838f);
}

void planar_6dof_leadlag_init(planar_6dof_leadlag_state_t *state)
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
    state->filter_x_p = 0.0f;
    state->filter_x_s = 0.0f;
    state->filter_x_h = 0.0f;
    state->filter_y_p = 0.0f;
    state->filter_y_s = 0.0f;
    state->filter_y_h = 0.0f;
    state->filter_phi_p = 0.0f;
    state->filter_phi_s = 0.0f;
    state->filter_phi_h = 0.0f;
    state->loop_x_integral = 0.0f;
    state->loop_x_lag = 0.0f;
    state->loop_y_integral = 0.0f;
    state->loop_y_lag = 0.0f;
    state->loop_phi_integral = 0.0f;
    state->loop_phi_lag = 0.0f;
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

uint32_t planar_6dof_leadlag_step(planar_6dof_leadlag_state_t *state, const planar_6dof_leadlag_input_t *in, planar_6dof_leadlag_output_t *out)
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
    static const float filter_x_k_p = 0.110377386f;             /* 1; (16), steady: gain on the position, in units of position */
    static const float filter_x_k_s = 0.006452916f;             /* 1; (16), steady: gain on the velocity, in units of position */
    static const float filter_x_k_h = 9.431981e-05f;            /* 1; (16), steady: gain on the acceleration, in units of position */
    static const float filter_y_k_p = 0.110377386f;             /* 1; (16), steady: gain on the position, in units of position */
    static const float filter_y_k_s = 0.006452916f;             /* 1; (16), steady: gain on the velocity, in units of position */
    static const float filter_y_k_h = 9.431981e-05f;            /* 1; (16), steady: gain on the acceleration, in units of position */
    static const float filter_phi_k_p = 0.30911008f;            /* 1; (16), steady: gain on the position, in units of position */
    static const float filter_phi_k_s = 0.05698819f;            /* 1; (16), steady: gain on the velocity, in units of position */
    static const float filter_phi_k_h = 0.0026284785f;          /* 1; (16), steady: gain on the acceleration, in units of position */
    static const float loop_x_direct = 2515.072f;               /* A/m; (21): gain of the error */
    static const float loop_x_into_lag = -1799.755f;            /* A/m; (21): gain times pole less zero */
    static const float loop_x_pole = 0.2753623f;                /* 1; (21): pole in z */
    static const float loop_x_reset = 0.9900498f;               /* 1; (21): zero of the integrator in z */
    static const float loop_x_driven = 0.0099502485f;           /* 1; (21): 1 less that */
    static const float loop_y_direct = 2515.072f;               /* A/m; (21): gain of the error */
    static const float loop_y_into_lag = -1799.755f;            /* A/m; (21): gain times pole less zero */
    static const float loop_y_pole = 0.2753623f;                /* 1; (21): pole in z */
    static const float loop_y_reset = 0.9900498f;               /* 1; (21): zero of the integrator in z */
    static const float loop_y_driven = 0.0099502485f;           /* 1; (21): 1 less that */
    static const float loop_phi_direct = 312.6659f;             /* A/rad; (22): gain of the error */
    static const float loop_phi_into_lag = -223.97475f;         /* A/rad; (22): gain times pole less zero */
    static const float loop_phi_pole = 0.2753623f;              /* 1; (22): pole in z */
    static const float loop_phi_reset = 0.9900498f;             /* 1; (22): zero of the integrator in z */
    static const float loop_phi_driven = 0.0099502485f;         /* 1; (22): 1 less that */
    static const float loop_z_direct = 4962.6665f;              /* A/m; (23): gain of the error */
    static const float loop_z_into_lag = -4476.951f;            /* A/m; (23): gain times pole less zero */
    static const float loop_z_reset = 0.9900498f;               /* 1; (23): zero of the integrator in z */
    static const float loop_theta_direct = 528.30865f;          /* A/rad; (24): gain of the error */
    static const float loop_theta_into_lag = -487.64932f;       /* A/rad; (24): gain times pole less zero */
    static const float loop_theta_reset = 0.9900498f;           /* 1; (24): zero of the integrator in z */
    static const float loop_theta_driven = 0.0099502485f;       /* 1; (24): 1 less that */
    static const float loop_psi_direct = 581.13947f;            /* A/rad; (25): gain of the error */
    static const float loop_psi_into_lag = -536.41425f;         /* A/rad; (25): gain times pole less zero */
    static const float loop_psi_reset = 0.9900498f;             /* 1; (25): zero of the integrator in z */
    static const float allocation_part = 0.33333334f;           /* 1; Table 3: c/(2 (b + c)) */
    static const float allocation_front_part = 0.16666667f;     /* 1; Table 3: b/(2 (b + c)) */
    static const float loop_z_driven_x_allocation_part = 0.0033167496f;/* 1 1; (23): 1 less that; times allocation_part */
    static const float loop_psi_driven_x_allocation_half = 0.0049751243f;/* 1 1; (25): 1 less that; times allocation_half */

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
        const float t5 = max(min(0.0f, safe_output_last_i_AA + 0.126f), safe_output_last_i_AA - 0.126f);
        out->i_AA = t5;
        const float safe_output_last_i_AB = state->safe_output_last_i_AB;
        const float t6 = max(min(0.0f, safe_output_last_i_AB + 0.126f), safe_output_last_i_AB - 0.126f);
        out->i_AB = t6;
        const float safe_output_last_i_AC = state->safe_output_last_i_AC;
        const float t7 = max(min(0.0f, safe_output_last_i_AC + 0.126f), safe_output_last_i_AC - 0.126f);
        out->i_AC = t7;
        const float safe_output_last_i_BA = state->safe_output_last_i_BA;
        const float t8 = max(min(0.0f, safe_output_last_i_BA + 0.126f), safe_output_last_i_BA - 0.126f);
        out->i_BA = t8;
        const float safe_output_last_i_BB = state->safe_output_last_i_BB;
        const float t9 = max(min(0.0f, safe_output_last_i_BB + 0.126f), safe_output_last_i_BB - 0.126f);
        out->i_BB = t9;
        const float safe_output_last_i_BC = state->safe_output_last_i_BC;
        const float t10 = max(min(0.0f, safe_output_last_i_BC + 0.126f), safe_output_last_i_BC - 0.126f);
        out->i_BC = t10;
        const float safe_output_last_i_CA = state->safe_output_last_i_CA;
        const float t11 = max(min(0.0f, safe_output_last_i_CA + 0.126f), safe_output_last_i_CA - 0.126f);
        out->i_CA = t11;
        const float safe_output_last_i_CB = state->safe_output_last_i_CB;
        const float t12 = max(min(0.0f, safe_output_last_i_CB + 0.126f), safe_output_last_i_CB - 0.126f);
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
        const float t13 = max(min(0.0f, safe_output_last_i_CC + 0.126f), safe_output_last_i_CC - 0.126f);
        state->safe_output_last_i_CC = t13;
        out->i_CC = t13;

        /* guard: range acceptance, hold, latch */
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* filter_phi: (6)-(16) */
        const float filter_phi_p = state->filter_phi_p;

        /* filter_x: (6)-(16) */
        const float filter_x_p = state->filter_x_p;

        /* sensing: (1)-(5) */
        const uint32_t sensing_doubt = state->sensing_doubt;
        const float t14 = filter_phi_p * V_ay_held;
        const float t15 = t14 - V_bx_held;
        const float t16 = V_ax_held - t14;
        const float t17 = filter_phi_p * V_ax_held;
        const float t18 = V_cy_held + t17;
        const float t19 = t18 * t18;
        const float t20 = V_ay_held + t17;
        const float t21 = t20 * t20;
        const float t22 = t15 + t16 - (t18 * t19 * (sensing_slope_0 + (t21 * sensing_slope_1)));
        const float r_1 = V_by_held - V_ay_held - (t22 * filter_phi_p);
        const float t23 = t15 * t15;
        const float t24 = t16 * t16;
        const float t25 = (t15 * t23 * (sensing_slope_0 + (t24 * sensing_slope_1))) + (t20 - t18);
        const float r_2 = V_cx_held - V_ax_held + (t25 * filter_phi_p);
        const float t26 = t16 * t15;
        const float t27 = t26 * t26;
        const float m_x = t24 + t23 - (sensing_power_0 + (t27 * (sensing_power_1 + (t27 * sensing_power_2))));
        const float t28 = t20 * t18;
        const float t29 = t28 * t28;
        const float m_y = t21 + t19 - (sensing_power_0 + (t29 * (sensing_power_1 + (t29 * sensing_power_2))));
        const float t30 = (r_1 * r_1) + (r_2 * r_2) + (0.033025026f * ((m_x * m_x) + (m_y * m_y)));
        const bool t31 = (((sensing_doubt != 0u) ? 0.013780796f : 0.055123184f) < t30) && (guard_ready != 0u) && complete;
        const bool t32 = !t31 && complete;
        const float filter_y_p = state->filter_y_p;
        float x_raw = filter_x_p;
        float y_raw = filter_y_p;
        float t33 = 0.0f;
        float within_x;
        float within_y;
        if (t32) {
            float sensing_within_x_next;
            if (t24 <= t23) {
                const float t34 = limit(t26 / (t23 + 8.612998e-06f), 1.0f);
                const float t35 = t34 * t34;
                const float t36 = sensing_position_1 + (t35 * (sensing_position_3 + (t35 * (sensing_position_5 + (t35 * sensing_position_7)))));
                const float t37 = t34 * t36;
                if (t15 < 0.0f) {
                    if (0.0f < t37) {
                        sensing_within_x_next = t37 - 0.0254f;
                    } else {
                        sensing_within_x_next = t37 + 0.0254f;
                    }
                } else {
                    sensing_within_x_next = t37;
                }
            } else {
                const float t38 = limit(t26 / (t24 + 8.612998e-06f), 1.0f);
                const float t39 = t38 * t38;
                const float t40 = sensing_position_1 + (t39 * (sensing_position_3 + (t39 * (sensing_position_5 + (t39 * sensing_position_7)))));
                sensing_within_x_next = ((t16 < 0.0f) ? -0.0127f : 0.0127f) - (t38 * t40);
            }
            const float sensing_offset_x = state->sensing_offset_x;
            const float t41 = sensing_within_x_next - (filter_x_p - sensing_offset_x);
            float t42 = sensing_offset_x;
            if (0.0254f < fabsf(t41)) {
                if (0.0f < t41) {
                    const float t43 = max(sensing_offset_x - 0.0508f, -0.1016f);
                    t42 = t43;
                    state->sensing_offset_x = t43;
                } else {
                    const float t44 = min(sensing_offset_x + 0.0508f, 0.1016f);
                    t42 = t44;
                    state->sensing_offset_x = t44;
                }
            }
            x_raw = sensing_within_x_next + t42;
            float sensing_within_y_next;
            if (t21 <= t19) {
                const float t45 = limit(-(t28 / (t19 + 8.612998e-06f)), 1.0f);
                const float t46 = t45 * t45;
                const float t47 = sensing_position_1 + (t46 * (sensing_position_3 + (t46 * (sensing_position_5 + (t46 * sensing_position_7)))));
                const float t48 = t45 * t47;
                if (-t18 < 0.0f) {
                    if (0.0f < t48) {
                        sensing_within_y_next = t48 - 0.0254f;
                    } else {
                        sensing_within_y_next = t48 + 0.0254f;
                    }
                } else {
                    sensing_within_y_next = t48;
                }
            } else {
                const float t49 = limit(-(t28 / (t21 + 8.612998e-06f)), 1.0f);
                const float t50 = t49 * t49;
                const float t51 = sensing_position_1 + (t50 * (sensing_position_3 + (t50 * (sensing_position_5 + (t50 * sensing_position_7)))));
                sensing_within_y_next = ((t20 < 0.0f) ? -0.0127f : 0.0127f) - (t49 * t51);
            }
            const float sensing_offset_y = state->sensing_offset_y;
            const float t52 = sensing_within_y_next - (filter_y_p - sensing_offset_y);
            float t53 = sensing_offset_y;
            if (0.0254f < fabsf(t52)) {
                if (0.0f < t52) {
                    const float t54 = max(sensing_offset_y - 0.0508f, -0.1016f);
                    t53 = t54;
                    state->sensing_offset_y = t54;
                } else {
                    const float t55 = min(sensing_offset_y + 0.0508f, 0.1016f);
                    t53 = t55;
                    state->sensing_offset_y = t55;
                }
            }
            y_raw = sensing_within_y_next + t53;
            const float t56 = (t16 * (t20 + t18)) + (t20 * (t16 - t15));
            const float t57 = ((t22 * r_1) - (t25 * r_2) + (sensing_third * (t56 * (m_x - m_y)))) / ((t22 * t22) + (t25 * t25) + (2.0f * (sensing_third * (t56 * t56))) + 0.08612997f);
            t33 = t57;
            within_x = sensing_within_x_next;
            state->sensing_within_x = sensing_within_x_next;
            within_y = sensing_within_y_next;
            state->sensing_within_y = sensing_within_y_next;
        } else {
            within_x = state->sensing_within_x;
            within_y = state->sensing_within_y;
        }
        const float phi_raw = limit(filter_phi_p + t33, 0.025f);
        if (t31) {
            state->sensing_doubt = 4u;
        } else {
            if (t32 && (sensing_doubt != 0u)) {
                state->sensing_doubt = sensing_doubt - 1u;
            }
        }
        if (t31 && (sensing_doubt != 0u)) {
            state->sensing_named = 1u;
        }
        if (t31 && !(sensing_doubt != 0u)) {
            const bool t58 = 0.12402716f < t30;
            const float t59 = fabsf(m_x);
            const bool t60 = 0.25838992f < t59;
            const float t61 = fabsf(m_y);
            const bool t62 = 0.25838992f < t61;
            const bool t63 = 0.07043498f < fabsf(r_2);
            const bool t64 = 0.07043498f < fabsf(r_1);
            bool t65;
            bool t66;
            bool t67 = t60;
            bool t68;
            bool t69;
            bool t70 = t62;
            if (t58) {
                const bool t71 = t59 < 0.8612997f;
                t65 = t63 && (!t71 || (fabsf(r_2 * ((2.0f * t16) + r_2)) < 2.5838993f));
                const bool t72 = t61 < 0.8612997f;
                t66 = t64 && (!t72 || (fabsf(r_1 * ((2.0f * t20) + r_1)) < 2.5838993f));
                t67 = t60 && !t63;
                t68 = t64 && t72;
                t69 = t63 && t71;
                t70 = t62 && !t64;
            } else {
                const bool t73 = t64 || t63;
                t65 = t73 || t60;
                t66 = t73 || t62;
                t68 = t73;
                t69 = t73;
            }
            const bool t74 = (0.01f < fabsf(filter_phi_p)) || (t60 && t62 && !t58);
            const bool sensing_found_V_ax_next = t65 || t74;
            state->sensing_found_V_ax = flag(sensing_found_V_ax_next);
            const bool sensing_found_V_ay_next = t66 || t74;
            state->sensing_found_V_ay = flag(sensing_found_V_ay_next);
            const bool sensing_found_V_bx_next = t67 || t74;
            state->sensing_found_V_bx = flag(sensing_found_V_bx_next);
            const bool sensing_found_V_by_next = t68 || t74;
            state->sensing_found_V_by = flag(sensing_found_V_by_next);
            const bool sensing_found_V_cx_next = t69 || t74;
            state->sensing_found_V_cx = flag(sensing_found_V_cx_next);
            const bool sensing_found_V_cy_next = t70 || t74;
            state->sensing_found_V_cy = flag(sensing_found_V_cy_next);
        }

        /* filter_x: (6)-(16) */
        const float t75 = x_raw - filter_x_p;
        const float t76 = filter_x_p + (filter_x_k_p * t75);
        const float filter_x_s = state->filter_x_s;
        const float filter_x_h = state->filter_x_h;
        const float t77 = filter_x_h + (filter_x_k_h * t75);
        const float t78 = filter_x_s + (filter_x_k_s * t75) + t77;
        const float t79 = t76 + t78;
        const float t80 = t78 + t77;
        float x = t76;
        if ((guard_ready != 0u) && (fabsf(t79) <= 0.2f) && (fabsf(t80) <= 0.2f) && (fabsf(t77) <= 0.2f)) {
            state->filter_x_p = t79;
            state->filter_x_s = t80;
            state->filter_x_h = t77;
        } else {
            x = x_raw;
            state->filter_x_p = x_raw;
            state->filter_x_s = 0.0f;
            state->filter_x_h = 0.0f;
        }

        /* filter_y: (6)-(16) */
        const float t81 = y_raw - filter_y_p;
        const float t82 = filter_y_p + (filter_y_k_p * t81);
        const float filter_y_s = state->filter_y_s;
        const float filter_y_h = state->filter_y_h;
        const float t83 = filter_y_h + (filter_y_k_h * t81);
        const float t84 = filter_y_s + (filter_y_k_s * t81) + t83;
        const float t85 = t82 + t84;
        const float t86 = t84 + t83;
        float y = t82;
        if ((guard_ready != 0u) && (fabsf(t85) <= 0.2f) && (fabsf(t86) <= 0.2f) && (fabsf(t83) <= 0.2f)) {
            state->filter_y_p = t85;
            state->filter_y_s = t86;
            state->filter_y_h = t83;
        } else {
            y = y_raw;
            state->filter_y_p = y_raw;
            state->filter_y_s = 0.0f;
            state->filter_y_h = 0.0f;
        }

        /* filter_phi: (6)-(16) */
        const float t87 = phi_raw - filter_phi_p;
        const float t88 = filter_phi_p + (filter_phi_k_p * t87);
        const float filter_phi_s = state->filter_phi_s;
        const float filter_phi_h = state->filter_phi_h;
        const float t89 = filter_phi_h + (filter_phi_k_h * t87);
        const float t90 = filter_phi_s + (filter_phi_k_s * t87) + t89;
        const float t91 = t88 + t90;
        const float t92 = t90 + t89;
        float phi = t88;
        if ((guard_ready != 0u) && (fabsf(t91) <= 0.05f) && (fabsf(t92) <= 0.05f) && (fabsf(t89) <= 0.05f)) {
            state->filter_phi_p = t91;
            state->filter_phi_s = t92;
            state->filter_phi_h = t89;
        } else {
            phi = phi_raw;
            state->filter_phi_p = phi_raw;
            state->filter_phi_s = 0.0f;
            state->filter_phi_h = 0.0f;
        }

        /* heights: laser distances inverted */
        const float t93 = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (t93 + d3_held);
        const float theta = 8.333333f * (d3_held - t93);
        const float psi = 8.333333f * (d1_held - d2_held);

        /* loop_x: (21) */
        const float t94 = x_ref_held - x;
        const float loop_x_lag = state->loop_x_lag;
        const float loop_x_integral = state->loop_x_integral;
        const float d_x = (loop_x_direct * t94) + loop_x_lag + loop_x_integral;
        const float loop_x_lag_next = (loop_x_into_lag * t94) + (loop_x_pole * loop_x_lag);
        state->loop_x_lag = loop_x_lag_next;

        /* loop_y: (21) */
        const float t95 = y_ref_held - y;
        const float loop_y_lag = state->loop_y_lag;
        const float loop_y_integral = state->loop_y_integral;
        const float d_y = (loop_y_direct * t95) + loop_y_lag + loop_y_integral;
        const float loop_y_lag_next = (loop_y_into_lag * t95) + (loop_y_pole * loop_y_lag);
        state->loop_y_lag = loop_y_lag_next;

        /* loop_phi: (22) */
        const float t96 = phi_ref_held - phi;
        const float loop_phi_lag = state->loop_phi_lag;
        const float loop_phi_integral = state->loop_phi_integral;
        const float d_phi = (loop_phi_direct * t96) + loop_phi_lag + loop_phi_integral;
        const float loop_phi_lag_next = (loop_phi_into_lag * t96) + (loop_phi_pole * loop_phi_lag);
        state->loop_phi_lag = loop_phi_lag_next;

        /* loop_z: (23) */
        const float t97 = z_ref_held - z;
        const float loop_z_lag = state->loop_z_lag;
        const float loop_z_integral = state->loop_z_integral;
        const float d_z = (loop_z_direct * t97) + loop_z_lag + loop_z_integral;
        const float loop_z_lag_next = loop_z_into_lag * t97;
        state->loop_z_lag = loop_z_lag_next;

        /* loop_theta: (24) */
        const float t98 = theta_ref_held - theta;
        const float loop_theta_lag = state->loop_theta_lag;
        const float loop_theta_integral = state->loop_theta_integral;
        const float d_theta = (loop_theta_direct * t98) + loop_theta_lag + loop_theta_integral;
        const float loop_theta_lag_next = loop_theta_into_lag * t98;
        state->loop_theta_lag = loop_theta_lag_next;

        /* loop_psi: (25) */
        const float t99 = psi_ref_held - psi;
        const float loop_psi_lag = state->loop_psi_lag;
        const float loop_psi_integral = state->loop_psi_integral;
        const float d_psi = (loop_psi_direct * t99) + loop_psi_lag + loop_psi_integral;
        const float loop_psi_lag_next = loop_psi_into_lag * t99;
        state->loop_psi_lag = loop_psi_lag_next;

        /* allocation: Table 3, (17), limits */
        const float t100 = phi * phi;
        const float t101 = f1_polynomial(t100);
        const float t102 = phi * f2_polynomial(t100);
        const float i_CQ = limit((t101 * d_x) + (t102 * d_y), 1.134f);
        const float t103 = limit(d_phi + i_CQ, 1.134f);
        const float t104 = limit(0.5f * ((t101 * d_y) - (t102 * d_x)), 1.134f - fabsf(t103));
        const float i_AQ = t104 - t103;
        const float i_BQ = t104 + t103;
        const float t105 = d_z - d_theta;
        const float i_AD = limit(t105 + d_psi, 0.54913455f);
        const float i_BD = limit(t105 - d_psi, 0.54913455f);

        /* loop_psi: (25) */
        const float loop_psi_integral_next = (loop_psi_reset * loop_psi_integral) + (loop_psi_driven_x_allocation_half * (i_AD - i_BD));
        state->loop_psi_integral = loop_psi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float i_CD = limit(d_z + (2.0f * d_theta), 0.54913455f);

        /* loop_z: (23) */
        const float t106 = i_AD + i_BD;
        const float loop_z_integral_next = (loop_z_reset * loop_z_integral) + (loop_z_driven_x_allocation_part * (t106 + i_CD));
        state->loop_z_integral = loop_z_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_x = (t101 * i_CQ) - (2.0f * (t102 * t104));

        /* loop_x: (21) */
        const float loop_x_integral_next = (loop_x_reset * loop_x_integral) + (loop_x_driven * made_x);
        state->loop_x_integral = loop_x_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_y = (t102 * i_CQ) + (2.0f * (t101 * t104));

        /* loop_y: (21) */
        const float loop_y_integral_next = (loop_y_reset * loop_y_integral) + (loop_y_driven * made_y);
        state->loop_y_integral = loop_y_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_phi = t103 - i_CQ;

        /* loop_phi: (22) */
        const float loop_phi_integral_next = (loop_phi_reset * loop_phi_integral) + (loop_phi_driven * made_phi);
        state->loop_phi_integral = loop_phi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_theta = (allocation_part * i_CD) - (allocation_front_part * t106);

        /* loop_theta: (24) */
        const float loop_theta_integral_next = (loop_theta_reset * loop_theta_integral) + (loop_theta_driven * made_theta);
        state->loop_theta_integral = loop_theta_integral_next;

        /* commutation: (17) inverted */
        const float distance_back = within_x - (0.025584769f * t102);
        const float quarter_sine_back = distance_back * quarter_sine_back_polynomial(distance_back * distance_back);
        const float distance_front = within_y - ((0.012792384f * t101) - 0.0127f);
        const float quarter_sine_front = distance_front * quarter_sine_front_polynomial(distance_front * distance_front);
        const float t107 = quarter_sine_front * quarter_sine_front;
        const float t108 = quarter_sine_front * sqrtf(1.0f - t107);
        const float t109 = t108 * (4.0f - (8.0f * t107));
        const float t110 = f5_polynomial(t100);
        const float t111 = t109 * t110;
        const float t112 = 1.0f - (8.0f * (t108 * t108));
        const float t113 = phi * f6_polynomial(t100);
        const float t114 = t112 * t113;
        const float t115 = t111 - t114;
        const float t116 = t112 * t110;
        const float t117 = t109 * t113;
        const float t118 = t116 + t117;
        const float i_AA_computed = (t115 * i_AQ) + (t118 * i_AD);
        /*@ admit -1.26f <= i_AA_computed <= 1.26f; */
        state->safe_output_last_i_AA = i_AA_computed;
        out->i_AA = i_AA_computed;
        const float t119 = 0.8660254f * ((t115 * i_AD) - (t118 * i_AQ));
        const float t120 = 0.5f * i_AA_computed;
        const float i_AB_computed = t119 - t120;
        /*@ admit -1.26f <= i_AB_computed <= 1.26f; */
        state->safe_output_last_i_AB = i_AB_computed;
        out->i_AB = i_AB_computed;
        const float i_AC_computed = -(t120 + t119);
        /*@ admit -1.26f <= i_AC_computed <= 1.26f; */
        state->safe_output_last_i_AC = i_AC_computed;
        out->i_AC = i_AC_computed;
        const float t121 = t111 + t114;
        const float t122 = t117 - t116;
        const float i_BA_computed = (t121 * i_BQ) - (t122 * i_BD);
        /*@ admit -1.26f <= i_BA_computed <= 1.26f; */
        state->safe_output_last_i_BA = i_BA_computed;
        out->i_BA = i_BA_computed;
        const float t123 = 0.8660254f * ((t122 * i_BQ) + (t121 * i_BD));
        const float t124 = 0.5f * i_BA_computed;
        const float i_BB_computed = t123 - t124;
        /*@ admit -1.26f <= i_BB_computed <= 1.26f; */
        state->safe_output_last_i_BB = i_BB_computed;
        out->i_BB = i_BB_computed;
        const float i_BC_computed = -(t124 + t123);
        /*@ admit -1.26f <= i_BC_computed <= 1.26f; */
        state->safe_output_last_i_BC = i_BC_computed;
        out->i_BC = i_BC_computed;
        const float t125 = quarter_sine_back * quarter_sine_back;
        const float t126 = quarter_sine_back * sqrtf(1.0f - t125);
        const float t127 = 1.0f - (8.0f * (t126 * t126));
        const float t128 = t126 * (4.0f - (8.0f * t125));
        const float i_CA_computed = (t127 * i_CQ) - (t128 * i_CD);
        /*@ admit -1.26f <= i_CA_computed <= 1.26f; */
        state->safe_output_last_i_CA = i_CA_computed;
        out->i_CA = i_CA_computed;
        const float t129 = 0.8660254f * ((t128 * i_CQ) + (t127 * i_CD));
        const float t130 = 0.5f * i_CA_computed;
        const float i_CB_computed = t129 - t130;
        /*@ admit -1.26f <= i_CB_computed <= 1.26f; */
        state->safe_output_last_i_CB = i_CB_computed;
        out->i_CB = i_CB_computed;
        const float i_CC_computed = -(t130 + t129);
        /*@ admit -1.26f <= i_CC_computed <= 1.26f; */
        state->safe_output_last_i_CC = i_CC_computed;
        out->i_CC = i_CC_computed;
    }

    return faults;
}
