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
        const float t14 = filter_phi_p * V_ay_held;
        const float t15 = V_ax_held - t14;
        const float t16 = t15 * t15;
        const float t17 = t14 - V_bx_held;
        const float t18 = t17 * t17;
        const float t19 = t15 * t17;
        const float t20 = t19 * t19;
        const float m_x = t16 + t18 - (sensing_power_0 + (t20 * (sensing_power_1 + (t20 * sensing_power_2))));
        const bool t21 = 1.2919496f < fabsf(m_x);
        const float t22 = filter_phi_p * V_ax_held;
        const float t23 = V_ay_held + t22;
        const float t24 = t23 * t23;
        const float t25 = V_cy_held + t22;
        const float t26 = t25 * t25;
        const float t27 = t23 * t25;
        const float t28 = t27 * t27;
        const float m_y = t24 + t26 - (sensing_power_0 + (t28 * (sensing_power_1 + (t28 * sensing_power_2))));
        const bool t29 = 1.2919496f < fabsf(m_y);
        const float t30 = t17 + t15 - (t25 * t26 * (sensing_slope_0 + (t24 * sensing_slope_1)));
        const float r_1 = V_by_held - V_ay_held - (t30 * filter_phi_p);
        const float t31 = (t17 * t18 * (sensing_slope_0 + (t16 * sensing_slope_1))) + (t23 - t25);
        const float r_2 = V_cx_held - V_ax_held + (t31 * filter_phi_p);
        const bool t32 = (0.23478326f < fabsf(r_1)) || (0.23478326f < fabsf(r_2));
        const bool t33 = (t21 || t29 || t32) && (guard_ready != 0u) && complete;
        const bool t34 = !t33 && complete;
        const float filter_y_p = state->filter_y_p;
        const float t35 = t30 * r_1;
        const float t36 = t31 * r_2;
        const float t37 = t30 * t30;
        const float t38 = t31 * t31;
        const float t39 = t37 + t38;
        float x_raw = filter_x_p;
        float y_raw = filter_y_p;
        float t40 = 0.0f;
        float within_x;
        float within_y;
        if (t34) {
            float sensing_within_x_next;
            if (t16 <= t18) {
                const float t41 = limit(t19 / (t18 + 8.612998e-06f), 1.0f);
                const float t42 = t41 * t41;
                const float t43 = sensing_position_1 + (t42 * (sensing_position_3 + (t42 * (sensing_position_5 + (t42 * sensing_position_7)))));
                const float t44 = t41 * t43;
                if (t17 < 0.0f) {
                    if (0.0f < t44) {
                        sensing_within_x_next = t44 - 0.0254f;
                    } else {
                        sensing_within_x_next = t44 + 0.0254f;
                    }
                } else {
                    sensing_within_x_next = t44;
                }
            } else {
                const float t45 = limit(t19 / (t16 + 8.612998e-06f), 1.0f);
                const float t46 = t45 * t45;
                const float t47 = sensing_position_1 + (t46 * (sensing_position_3 + (t46 * (sensing_position_5 + (t46 * sensing_position_7)))));
                sensing_within_x_next = ((t15 < 0.0f) ? -0.0127f : 0.0127f) - (t45 * t47);
            }
            const float sensing_offset_x = state->sensing_offset_x;
            const float t48 = sensing_within_x_next + sensing_offset_x - filter_x_p;
            float t49 = sensing_offset_x;
            if (0.0254f < fabsf(t48)) {
                if (0.0f < t48) {
                    const float t50 = max(sensing_offset_x - 0.0508f, -0.1016f);
                    t49 = t50;
                    state->sensing_offset_x = t50;
                } else {
                    const float t51 = min(sensing_offset_x + 0.0508f, 0.1016f);
                    t49 = t51;
                    state->sensing_offset_x = t51;
                }
            }
            x_raw = sensing_within_x_next + t49;
            float sensing_within_y_next;
            if (t24 <= t26) {
                const float t52 = limit(-(t27 / (t26 + 8.612998e-06f)), 1.0f);
                const float t53 = t52 * t52;
                const float t54 = sensing_position_1 + (t53 * (sensing_position_3 + (t53 * (sensing_position_5 + (t53 * sensing_position_7)))));
                const float t55 = t52 * t54;
                if (-t25 < 0.0f) {
                    if (0.0f < t55) {
                        sensing_within_y_next = t55 - 0.0254f;
                    } else {
                        sensing_within_y_next = t55 + 0.0254f;
                    }
                } else {
                    sensing_within_y_next = t55;
                }
            } else {
                const float t56 = limit(-(t27 / (t24 + 8.612998e-06f)), 1.0f);
                const float t57 = t56 * t56;
                const float t58 = sensing_position_1 + (t57 * (sensing_position_3 + (t57 * (sensing_position_5 + (t57 * sensing_position_7)))));
                sensing_within_y_next = ((t23 < 0.0f) ? -0.0127f : 0.0127f) - (t56 * t58);
            }
            const float sensing_offset_y = state->sensing_offset_y;
            const float t59 = sensing_within_y_next + sensing_offset_y - filter_y_p;
            float t60 = sensing_offset_y;
            if (0.0254f < fabsf(t59)) {
                if (0.0f < t59) {
                    const float t61 = max(sensing_offset_y - 0.0508f, -0.1016f);
                    t60 = t61;
                    state->sensing_offset_y = t61;
                } else {
                    const float t62 = min(sensing_offset_y + 0.0508f, 0.1016f);
                    t60 = t62;
                    state->sensing_offset_y = t62;
                }
            }
            y_raw = sensing_within_y_next + t60;
            const float t63 = (t15 * (t23 + t25)) + (t23 * (t15 - t17));
            const float t64 = (t35 - t36 + (sensing_third * (t63 * (m_x - m_y)))) / (t39 + (2.0f * (sensing_third * (t63 * t63))) + 0.08612997f);
            t40 = t64;
            within_x = sensing_within_x_next;
            state->sensing_within_x = sensing_within_x_next;
            within_y = sensing_within_y_next;
            state->sensing_within_y = sensing_within_y_next;
        } else {
            within_x = state->sensing_within_x;
            within_y = state->sensing_within_y;
        }
        const float phi_raw = limit(filter_phi_p + t40, 0.025f);
        const uint32_t sensing_doubt = state->sensing_doubt;
        const bool t65 = t33 && (3u < sensing_doubt);
        const float t66 = sqrtf(t39 + 8.612998e-06f);
        const float t67 = -0.11739163f * t66;
        const float t68 = fabsf(t35) - fabsf(t36);
        const float t69 = (t31 * r_1) + (t30 * r_2);
        const bool t70 = !t32;
        const float t71 = fabsf(t69);
        const float t72 = 0.11739163f * t66;
        if (t65) {
            state->sensing_doubt = 3u;
            state->sensing_named = 1u;
            const bool t73 = t32 && (t67 < t68);
            const float t74 = t31 / (t38 + 8.612998e-06f);
            const float t75 = limit(-(r_2 * t74), 1.0f) * V_ax_held;
            const float t76 = t23 + t75;
            const float t77 = t25 + t75;
            const float t78 = t77 * t77;
            const float t79 = t76 * t77;
            const float t80 = t79 * t79;
            const float t81 = t76 + limit(t69 * t74, 10.0f);
            const float t82 = t81 * t77;
            const float t83 = t82 * t82;
            const float t84 = fabsf((t76 * t76) + t78 - (sensing_power_0 + (t80 * (sensing_power_1 + (t80 * sensing_power_2))))) - fabsf((t81 * t81) + t78 - (sensing_power_0 + (t83 * (sensing_power_1 + (t83 * sensing_power_2)))));
            const bool t85 = t29 && t70;
            const float t86 = fabsf(t69 + (t31 * (m_y * t23 / ((2.0f * t24) + 8.612998e-06f)))) - t71;
            const bool t87 = (t73 && (-0.34451988f < t84)) || (t85 && (t86 < t72));
            const bool t88 = t73 && (t84 < 0.34451988f);
            const bool t89 = t85 && (t67 < t86);
            const bool t90 = (sensing_found_V_ax != 0u) || t87 || (sensing_found_V_bx != 0u) || t88 || (sensing_found_V_cx != 0u) || t89;
            if (!t90) {
                state->sensing_found_V_ax = 1u;
                state->sensing_found_V_bx = 1u;
                state->sensing_found_V_cx = 1u;
            }
            const bool t91 = !t90;
            const bool sensing_found_V_ay_next = t87 || t91;
            state->sensing_found_V_ay = flag(sensing_found_V_ay_next);
            const bool sensing_found_V_by_next = t88 || t91;
            state->sensing_found_V_by = flag(sensing_found_V_by_next);
            const bool sensing_found_V_cy_next = t89 || t91;
            state->sensing_found_V_cy = flag(sensing_found_V_cy_next);
        } else {
            const bool t92 = t33 && (sensing_doubt != 0u);
            if (t92) {
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
            if (t92 && !t65) {
                const bool t93 = t32 && (t68 < t72);
                const float t94 = t30 / (t37 + 8.612998e-06f);
                const float t95 = limit(r_1 * t94, 1.0f) * V_ay_held;
                const float t96 = t15 - t95;
                const float t97 = t17 + t95;
                const float t98 = t97 * t97;
                const float t99 = t96 * t97;
                const float t100 = t99 * t99;
                const float t101 = t96 + limit(t69 * t94, 10.0f);
                const float t102 = t101 * t97;
                const float t103 = t102 * t102;
                const float t104 = fabsf((t96 * t96) + t98 - (sensing_power_0 + (t100 * (sensing_power_1 + (t100 * sensing_power_2))))) - fabsf((t101 * t101) + t98 - (sensing_power_0 + (t103 * (sensing_power_1 + (t103 * sensing_power_2)))));
                const bool t105 = t21 && t70;
                const float t106 = fabsf(t69 + (t30 * (m_x * t15 / ((2.0f * t16) + 8.612998e-06f)))) - t71;
                state->sensing_found_V_ax = flag((t93 && (-0.34451988f < t104)) || (t105 && (t106 < t72)));
                state->sensing_found_V_bx = flag(t105 && (t67 < t106));
                state->sensing_found_V_cx = flag(t93 && (t104 < 0.34451988f));
            }
        }

        /* filter_x: (6)-(16) */
        const float t107 = x_raw - filter_x_p;
        const float t108 = filter_x_p + (filter_x_k_p * t107);
        const float filter_x_s = state->filter_x_s;
        const float filter_x_h = state->filter_x_h;
        const float t109 = filter_x_h + (filter_x_k_h * t107);
        const float t110 = filter_x_s + (filter_x_k_s * t107) + t109;
        const float t111 = t108 + t110;
        const float t112 = t110 + t109;
        float x = t108;
        if ((guard_ready != 0u) && (fabsf(t111) <= 0.2f) && (fabsf(t112) <= 0.2f) && (fabsf(t109) <= 0.2f)) {
            state->filter_x_p = t111;
            state->filter_x_s = t112;
            state->filter_x_h = t109;
        } else {
            x = x_raw;
            state->filter_x_p = x_raw;
            state->filter_x_s = 0.0f;
            state->filter_x_h = 0.0f;
        }

        /* filter_y: (6)-(16) */
        const float t113 = y_raw - filter_y_p;
        const float t114 = filter_y_p + (filter_y_k_p * t113);
        const float filter_y_s = state->filter_y_s;
        const float filter_y_h = state->filter_y_h;
        const float t115 = filter_y_h + (filter_y_k_h * t113);
        const float t116 = filter_y_s + (filter_y_k_s * t113) + t115;
        const float t117 = t114 + t116;
        const float t118 = t116 + t115;
        float y = t114;
        if ((guard_ready != 0u) && (fabsf(t117) <= 0.2f) && (fabsf(t118) <= 0.2f) && (fabsf(t115) <= 0.2f)) {
            state->filter_y_p = t117;
            state->filter_y_s = t118;
            state->filter_y_h = t115;
        } else {
            y = y_raw;
            state->filter_y_p = y_raw;
            state->filter_y_s = 0.0f;
            state->filter_y_h = 0.0f;
        }

        /* filter_phi: (6)-(16) */
        const float t119 = phi_raw - filter_phi_p;
        const float t120 = filter_phi_p + (filter_phi_k_p * t119);
        const float filter_phi_s = state->filter_phi_s;
        const float filter_phi_h = state->filter_phi_h;
        const float t121 = filter_phi_h + (filter_phi_k_h * t119);
        const float t122 = filter_phi_s + (filter_phi_k_s * t119) + t121;
        const float t123 = t120 + t122;
        const float t124 = t122 + t121;
        float phi = t120;
        if ((guard_ready != 0u) && (fabsf(t123) <= 0.05f) && (fabsf(t124) <= 0.05f) && (fabsf(t121) <= 0.05f)) {
            state->filter_phi_p = t123;
            state->filter_phi_s = t124;
            state->filter_phi_h = t121;
        } else {
            phi = phi_raw;
            state->filter_phi_p = phi_raw;
            state->filter_phi_s = 0.0f;
            state->filter_phi_h = 0.0f;
        }

        /* heights: laser distances inverted */
        const float t125 = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (t125 + d3_held);
        const float theta = 8.333333f * (d3_held - t125);
        const float psi = 8.333333f * (d1_held - d2_held);

        /* loop_x: (21) */
        const float t126 = x_ref_held - x;
        const float loop_x_lag = state->loop_x_lag;
        const float loop_x_integral = state->loop_x_integral;
        const float d_x = (loop_x_direct * t126) + loop_x_lag + loop_x_integral;
        const float loop_x_lag_next = (loop_x_into_lag * t126) + (loop_x_pole * loop_x_lag);
        state->loop_x_lag = loop_x_lag_next;

        /* loop_y: (21) */
        const float t127 = y_ref_held - y;
        const float loop_y_lag = state->loop_y_lag;
        const float loop_y_integral = state->loop_y_integral;
        const float d_y = (loop_y_direct * t127) + loop_y_lag + loop_y_integral;
        const float loop_y_lag_next = (loop_y_into_lag * t127) + (loop_y_pole * loop_y_lag);
        state->loop_y_lag = loop_y_lag_next;

        /* loop_phi: (22) */
        const float t128 = phi_ref_held - phi;
        const float loop_phi_lag = state->loop_phi_lag;
        const float loop_phi_integral = state->loop_phi_integral;
        const float d_phi = (loop_phi_direct * t128) + loop_phi_lag + loop_phi_integral;
        const float loop_phi_lag_next = (loop_phi_into_lag * t128) + (loop_phi_pole * loop_phi_lag);
        state->loop_phi_lag = loop_phi_lag_next;

        /* loop_z: (23) */
        const float t129 = z_ref_held - z;
        const float loop_z_lag = state->loop_z_lag;
        const float loop_z_integral = state->loop_z_integral;
        const float d_z = (loop_z_direct * t129) + loop_z_lag + loop_z_integral;
        const float loop_z_lag_next = loop_z_into_lag * t129;
        state->loop_z_lag = loop_z_lag_next;

        /* loop_theta: (24) */
        const float t130 = theta_ref_held - theta;
        const float loop_theta_lag = state->loop_theta_lag;
        const float loop_theta_integral = state->loop_theta_integral;
        const float d_theta = (loop_theta_direct * t130) + loop_theta_lag + loop_theta_integral;
        const float loop_theta_lag_next = loop_theta_into_lag * t130;
        state->loop_theta_lag = loop_theta_lag_next;

        /* loop_psi: (25) */
        const float t131 = psi_ref_held - psi;
        const float loop_psi_lag = state->loop_psi_lag;
        const float loop_psi_integral = state->loop_psi_integral;
        const float d_psi = (loop_psi_direct * t131) + loop_psi_lag + loop_psi_integral;
        const float loop_psi_lag_next = loop_psi_into_lag * t131;
        state->loop_psi_lag = loop_psi_lag_next;

        /* allocation: Table 3, (17), limits */
        const float t132 = phi * phi;
        const float t133 = f1_polynomial(t132);
        const float t134 = phi * f2_polynomial(t132);
        const float i_CQ = limit((t133 * d_x) + (t134 * d_y), 1.134f);
        const float t135 = limit(d_phi + i_CQ, 1.134f);
        const float t136 = limit(0.5f * ((t133 * d_y) - (t134 * d_x)), 1.134f - fabsf(t135));
        const float i_AQ = t136 - t135;
        const float i_BQ = t136 + t135;
        const float t137 = d_z - d_theta;
        const float i_AD = limit(t137 + d_psi, 0.5492213f);
        const float i_BD = limit(t137 - d_psi, 0.5492213f);

        /* loop_psi: (25) */
        const float loop_psi_integral_next = (loop_psi_reset * loop_psi_integral) + (loop_psi_driven_x_allocation_half * (i_AD - i_BD));
        state->loop_psi_integral = loop_psi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float i_CD = limit(d_z + (2.0f * d_theta), 0.5492213f);

        /* loop_z: (23) */
        const float t138 = i_AD + i_BD;
        const float loop_z_integral_next = (loop_z_reset * loop_z_integral) + (loop_z_driven_x_allocation_part * (t138 + i_CD));
        state->loop_z_integral = loop_z_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_x = (t133 * i_CQ) - (2.0f * (t134 * t136));

        /* loop_x: (21) */
        const float loop_x_integral_next = (loop_x_reset * loop_x_integral) + (loop_x_driven * made_x);
        state->loop_x_integral = loop_x_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_y = (t134 * i_CQ) + (2.0f * (t133 * t136));

        /* loop_y: (21) */
        const float loop_y_integral_next = (loop_y_reset * loop_y_integral) + (loop_y_driven * made_y);
        state->loop_y_integral = loop_y_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_phi = t135 - i_CQ;

        /* loop_phi: (22) */
        const float loop_phi_integral_next = (loop_phi_reset * loop_phi_integral) + (loop_phi_driven * made_phi);
        state->loop_phi_integral = loop_phi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_theta = (allocation_part * i_CD) - (allocation_front_part * t138);

        /* loop_theta: (24) */
        const float loop_theta_integral_next = (loop_theta_reset * loop_theta_integral) + (loop_theta_driven * made_theta);
        state->loop_theta_integral = loop_theta_integral_next;

        /* commutation: (17) inverted */
        const float distance_back = within_x - (0.025584769f * t134);
        const float quarter_sine_back = distance_back * quarter_sine_back_polynomial(distance_back * distance_back);
        const float distance_front = within_y - ((0.012792384f * t133) - 0.0127f);
        const float quarter_sine_front = distance_front * quarter_sine_front_polynomial(distance_front * distance_front);
        const float t139 = quarter_sine_front * quarter_sine_front;
        const float t140 = quarter_sine_front * sqrtf(1.0f - t139);
        const float t141 = t140 * (4.0f - (8.0f * t139));
        const float t142 = f5_polynomial(t132);
        const float t143 = t141 * t142;
        const float t144 = 1.0f - (8.0f * (t140 * t140));
        const float t145 = phi * f6_polynomial(t132);
        const float t146 = t144 * t145;
        const float t147 = t143 - t146;
        const float t148 = t144 * t142;
        const float t149 = t141 * t145;
        const float t150 = t148 + t149;
        const float i_AA_computed = limit((t147 * i_AQ) + (t150 * i_AD), 1.26f);
        state->safe_output_last_i_AA = i_AA_computed;
        out->i_AA = i_AA_computed;
        const float t151 = 0.8660254f * ((t147 * i_AD) - (t150 * i_AQ));
        const float t152 = 0.5f * i_AA_computed;
        const float i_AB_computed = limit(t151 - t152, 1.26f);
        state->safe_output_last_i_AB = i_AB_computed;
        out->i_AB = i_AB_computed;
        const float i_AC_computed = limit(-(t152 + t151), 1.26f);
        state->safe_output_last_i_AC = i_AC_computed;
        out->i_AC = i_AC_computed;
        const float t153 = t143 + t146;
        const float t154 = t149 - t148;
        const float i_BA_computed = limit((t153 * i_BQ) - (t154 * i_BD), 1.26f);
        state->safe_output_last_i_BA = i_BA_computed;
        out->i_BA = i_BA_computed;
        const float t155 = 0.8660254f * ((t154 * i_BQ) + (t153 * i_BD));
        const float t156 = 0.5f * i_BA_computed;
        const float i_BB_computed = limit(t155 - t156, 1.26f);
        state->safe_output_last_i_BB = i_BB_computed;
        out->i_BB = i_BB_computed;
        const float i_BC_computed = limit(-(t156 + t155), 1.26f);
        state->safe_output_last_i_BC = i_BC_computed;
        out->i_BC = i_BC_computed;
        const float t157 = quarter_sine_back * quarter_sine_back;
        const float t158 = quarter_sine_back * sqrtf(1.0f - t157);
        const float t159 = 1.0f - (8.0f * (t158 * t158));
        const float t160 = t158 * (4.0f - (8.0f * t157));
        const float i_CA_computed = limit((t159 * i_CQ) - (t160 * i_CD), 1.26f);
        state->safe_output_last_i_CA = i_CA_computed;
        out->i_CA = i_CA_computed;
        const float t161 = 0.8660254f * ((t160 * i_CQ) + (t159 * i_CD));
        const float t162 = 0.5f * i_CA_computed;
        const float i_CB_computed = limit(t161 - t162, 1.26f);
        state->safe_output_last_i_CB = i_CB_computed;
        out->i_CB = i_CB_computed;
        const float i_CC_computed = limit(-(t162 + t161), 1.26f);
        state->safe_output_last_i_CC = i_CC_computed;
        out->i_CC = i_CC_computed;
    }

    return faults;
}
