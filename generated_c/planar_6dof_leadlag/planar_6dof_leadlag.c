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
    static const float loop_z_driven = 0.0099502485f;           /* 1; (23): 1 less that */
    static const float loop_theta_direct = 528.30865f;          /* A/rad; (24): gain of the error */
    static const float loop_theta_into_lag = -487.64932f;       /* A/rad; (24): gain times pole less zero */
    static const float loop_theta_reset = 0.9900498f;           /* 1; (24): zero of the integrator in z */
    static const float loop_theta_driven = 0.0099502485f;       /* 1; (24): 1 less that */
    static const float loop_psi_direct = 581.13947f;            /* A/rad; (25): gain of the error */
    static const float loop_psi_into_lag = -536.41425f;         /* A/rad; (25): gain times pole less zero */
    static const float loop_psi_reset = 0.9900498f;             /* 1; (25): zero of the integrator in z */
    static const float loop_psi_driven = 0.0099502485f;         /* 1; (25): 1 less that */

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
        const float t4 = max(min(0.0f, safe_output_last_i_AA + 0.126f), safe_output_last_i_AA - 0.126f);
        out->i_AA = t4;
        const float safe_output_last_i_AB = state->safe_output_last_i_AB;
        const float t5 = max(min(0.0f, safe_output_last_i_AB + 0.126f), safe_output_last_i_AB - 0.126f);
        out->i_AB = t5;
        const float safe_output_last_i_AC = state->safe_output_last_i_AC;
        const float t6 = max(min(0.0f, safe_output_last_i_AC + 0.126f), safe_output_last_i_AC - 0.126f);
        out->i_AC = t6;
        const float safe_output_last_i_BA = state->safe_output_last_i_BA;
        const float t7 = max(min(0.0f, safe_output_last_i_BA + 0.126f), safe_output_last_i_BA - 0.126f);
        out->i_BA = t7;
        const float safe_output_last_i_BB = state->safe_output_last_i_BB;
        const float t8 = max(min(0.0f, safe_output_last_i_BB + 0.126f), safe_output_last_i_BB - 0.126f);
        out->i_BB = t8;
        const float safe_output_last_i_BC = state->safe_output_last_i_BC;
        const float t9 = max(min(0.0f, safe_output_last_i_BC + 0.126f), safe_output_last_i_BC - 0.126f);
        out->i_BC = t9;
        const float safe_output_last_i_CA = state->safe_output_last_i_CA;
        const float t10 = max(min(0.0f, safe_output_last_i_CA + 0.126f), safe_output_last_i_CA - 0.126f);
        out->i_CA = t10;
        const float safe_output_last_i_CB = state->safe_output_last_i_CB;
        const float t11 = max(min(0.0f, safe_output_last_i_CB + 0.126f), safe_output_last_i_CB - 0.126f);
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
        const float t12 = max(min(0.0f, safe_output_last_i_CC + 0.126f), safe_output_last_i_CC - 0.126f);
        state->safe_output_last_i_CC = t12;
        out->i_CC = t12;

        /* guard: range acceptance, hold, latch */
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* filter_phi: (6)-(16) */
        const float filter_phi_p = state->filter_phi_p;

        /* filter_x: (6)-(16) */
        const float filter_x_p = state->filter_x_p;

        /* sensing: (1)-(5) */
        const float t13 = filter_phi_p * V_ay_held;
        const float t14 = V_ax_held - t13;
        const float t15 = t14 * t14;
        const float t16 = t13 - V_bx_held;
        const float t17 = t16 * t16;
        const float t18 = t14 * t16;
        const float t19 = t18 * t18;
        const float m_x = t15 + t17 - (sensing_power_0 + (t19 * (sensing_power_1 + (t19 * sensing_power_2))));
        const bool t20 = 1.2919496f < fabsf(m_x);
        const float t21 = filter_phi_p * V_ax_held;
        const float t22 = V_ay_held + t21;
        const float t23 = t22 * t22;
        const float t24 = V_cy_held + t21;
        const float t25 = t24 * t24;
        const float t26 = t22 * t24;
        const float t27 = t26 * t26;
        const float m_y = t23 + t25 - (sensing_power_0 + (t27 * (sensing_power_1 + (t27 * sensing_power_2))));
        const bool t28 = 1.2919496f < fabsf(m_y);
        const float t29 = t16 + t14 - (t24 * t25 * (sensing_slope_0 + (t23 * sensing_slope_1)));
        const float r_1 = V_by_held - V_ay_held - (t29 * filter_phi_p);
        const float t30 = (t16 * t17 * (sensing_slope_0 + (t15 * sensing_slope_1))) + (t22 - t24);
        const float r_2 = V_cx_held - V_ax_held + (t30 * filter_phi_p);
        const bool t31 = (0.23478326f < fabsf(r_1)) || (0.23478326f < fabsf(r_2));
        const bool t32 = (t20 || t28 || t31) && (guard_ready != 0u) && complete;
        const bool t33 = !t32 && complete;
        const float filter_y_p = state->filter_y_p;
        const float sensing_count_x = state->sensing_count_x;
        const float sensing_count_y = state->sensing_count_y;
        const float t34 = t29 * r_1;
        const float t35 = t30 * r_2;
        const float t36 = t29 * t29;
        const float t37 = t30 * t30;
        const float t38 = t36 + t37;
        float x_raw = filter_x_p;
        float y_raw = filter_y_p;
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
            const float t49 = t48 - filter_x_p;
            if (0.0254f < fabsf(t49)) {
                float t50;
                if (0.0f < t49) {
                    x_raw = t48 - 0.0508f;
                    t50 = sensing_count_x - 1.0f;
                } else {
                    x_raw = t48 + 0.0508f;
                    t50 = sensing_count_x + 1.0f;
                }
                const float sensing_count_x_next = limit(t50, 2.0f);
                pitch_x = sensing_count_x_next;
                state->sensing_count_x = sensing_count_x_next;
            } else {
                x_raw = t48;
            }
            float t51;
            if (t23 <= t25) {
                const float t52 = limit(-(t26 / (t25 + 8.612998e-06f)), 1.0f);
                const float t53 = t52 * t52;
                const float t54 = sensing_position_1 + (t53 * (sensing_position_3 + (t53 * (sensing_position_5 + (t53 * sensing_position_7)))));
                const float t55 = t52 * t54;
                if (-t24 < 0.0f) {
                    if (0.0f < t55) {
                        t51 = t55 - 0.0254f;
                    } else {
                        t51 = t55 + 0.0254f;
                    }
                } else {
                    t51 = t55;
                }
            } else {
                const float t56 = limit(-(t26 / (t23 + 8.612998e-06f)), 1.0f);
                const float t57 = t56 * t56;
                const float t58 = sensing_position_1 + (t57 * (sensing_position_3 + (t57 * (sensing_position_5 + (t57 * sensing_position_7)))));
                t51 = ((t22 < 0.0f) ? -0.0127f : 0.0127f) - (t56 * t58);
            }
            const float t59 = t51 + (0.0508f * sensing_count_y);
            const float t60 = t59 - filter_y_p;
            if (0.0254f < fabsf(t60)) {
                float t61;
                if (0.0f < t60) {
                    y_raw = t59 - 0.0508f;
                    t61 = sensing_count_y - 1.0f;
                } else {
                    y_raw = t59 + 0.0508f;
                    t61 = sensing_count_y + 1.0f;
                }
                const float sensing_count_y_next = limit(t61, 2.0f);
                pitch_y = sensing_count_y_next;
                state->sensing_count_y = sensing_count_y_next;
            } else {
                y_raw = t59;
            }
            const float t62 = (t14 * (t22 + t24)) + (t22 * (t14 - t16));
            const float t63 = (t34 - t35 + (sensing_third * (t62 * (m_x - m_y)))) / (t38 + (2.0f * (sensing_third * (t62 * t62))) + 0.08612997f);
            t39 = t63;
        }
        const float phi_raw = limit(filter_phi_p + t39, 0.025f);
        const uint32_t sensing_doubt = state->sensing_doubt;
        if (t32) {
            state->sensing_doubt = 3u;
        } else {
            if (t33 && (sensing_doubt != 0u)) {
                state->sensing_doubt = sensing_doubt - 1u;
            }
        }
        if (t32 && (sensing_doubt != 0u)) {
            const float t64 = fabsf(t34) - fabsf(t35);
            const float t65 = sqrtf(t38 + 8.612998e-06f);
            const float t66 = 0.11739163f * t65;
            const bool t67 = t31 && (t64 < t66);
            const float t68 = t29 / (t36 + 8.612998e-06f);
            const float t69 = r_1 * t68 * V_ay_held;
            const float t70 = t14 - t69;
            const float t71 = t16 + t69;
            const float t72 = t71 * t71;
            const float t73 = t70 * t71;
            const float t74 = t73 * t73;
            const float t75 = (t30 * r_1) + (t29 * r_2);
            const float t76 = t70 + (t75 * t68);
            const float t77 = t76 * t71;
            const float t78 = t77 * t77;
            const float t79 = fabsf((t70 * t70) + t72 - (sensing_power_0 + (t74 * (sensing_power_1 + (t74 * sensing_power_2))))) - fabsf((t76 * t76) + t72 - (sensing_power_0 + (t78 * (sensing_power_1 + (t78 * sensing_power_2)))));
            const bool t80 = !t31;
            const bool t81 = t20 && t80;
            const float t82 = fabsf(t75);
            const float t83 = fabsf(t75 + (t29 * (m_x * t14 / ((2.0f * t15) + 8.612998e-06f)))) - t82;
            const bool sensing_found_V_ax_next = (t67 && (-0.34451988f < t79)) || (t81 && (t83 < t66));
            const float t84 = -0.11739163f * t65;
            const bool t85 = t31 && (t84 < t64);
            const float t86 = t30 / (t37 + 8.612998e-06f);
            const float t87 = r_2 * t86 * V_ax_held;
            const float t88 = t22 - t87;
            const float t89 = t87 - t24;
            const float t90 = t89 * t89;
            const float t91 = t88 * t89;
            const float t92 = t91 * t91;
            const float t93 = t88 + (t75 * t86);
            const float t94 = t93 * t89;
            const float t95 = t94 * t94;
            const float t96 = fabsf((t88 * t88) + t90 - (sensing_power_0 + (t92 * (sensing_power_1 + (t92 * sensing_power_2))))) - fabsf((t93 * t93) + t90 - (sensing_power_0 + (t95 * (sensing_power_1 + (t95 * sensing_power_2)))));
            const bool t97 = t28 && t80;
            const float t98 = fabsf(t75 + (t30 * (m_y * t22 / ((2.0f * t23) + 8.612998e-06f)))) - t82;
            const bool sensing_found_V_ay_next = (t85 && (-0.34451988f < t96)) || (t97 && (t98 < t66));
            const bool sensing_found_V_bx_next = t81 && (t84 < t83);
            const bool sensing_found_V_by_next = t85 && (t96 < 0.34451988f);
            const bool sensing_found_V_cx_next = t67 && (t79 < 0.34451988f);
            const bool t99 = sensing_found_V_ax_next || sensing_found_V_ay_next || sensing_found_V_bx_next || sensing_found_V_by_next || sensing_found_V_cx_next;
            const bool sensing_found_V_cy_next = t97 && (t84 < t98);
            const bool sensing_named_next = t99 || sensing_found_V_cy_next;
            state->sensing_named = flag(sensing_named_next);
            state->sensing_found_V_ax = flag(sensing_found_V_ax_next);
            state->sensing_found_V_ay = flag(sensing_found_V_ay_next);
            state->sensing_found_V_bx = flag(sensing_found_V_bx_next);
            state->sensing_found_V_by = flag(sensing_found_V_by_next);
            state->sensing_found_V_cx = flag(sensing_found_V_cx_next);
            state->sensing_found_V_cy = flag(sensing_found_V_cy_next);
        }

        /* filter_x: (6)-(16) */
        const float t100 = x_raw - filter_x_p;
        const float t101 = filter_x_p + (filter_x_k_p * t100);
        const float filter_x_s = state->filter_x_s;
        const float filter_x_h = state->filter_x_h;
        const float t102 = filter_x_h + (filter_x_k_h * t100);
        const float t103 = filter_x_s + (filter_x_k_s * t100) + t102;
        const float t104 = t101 + t103;
        const float t105 = t103 + t102;
        float x = t101;
        if ((guard_ready != 0u) && (fabsf(t104) <= 0.2f) && (fabsf(t105) <= 0.2f) && (fabsf(t102) <= 0.2f)) {
            state->filter_x_p = t104;
            state->filter_x_s = t105;
            state->filter_x_h = t102;
        } else {
            x = x_raw;
            state->filter_x_p = x_raw;
            state->filter_x_s = 0.0f;
            state->filter_x_h = 0.0f;
        }

        /* filter_y: (6)-(16) */
        const float t106 = y_raw - filter_y_p;
        const float t107 = filter_y_p + (filter_y_k_p * t106);
        const float filter_y_s = state->filter_y_s;
        const float filter_y_h = state->filter_y_h;
        const float t108 = filter_y_h + (filter_y_k_h * t106);
        const float t109 = filter_y_s + (filter_y_k_s * t106) + t108;
        const float t110 = t107 + t109;
        const float t111 = t109 + t108;
        float y = t107;
        if ((guard_ready != 0u) && (fabsf(t110) <= 0.2f) && (fabsf(t111) <= 0.2f) && (fabsf(t108) <= 0.2f)) {
            state->filter_y_p = t110;
            state->filter_y_s = t111;
            state->filter_y_h = t108;
        } else {
            y = y_raw;
            state->filter_y_p = y_raw;
            state->filter_y_s = 0.0f;
            state->filter_y_h = 0.0f;
        }

        /* filter_phi: (6)-(16) */
        const float t112 = phi_raw - filter_phi_p;
        const float t113 = filter_phi_p + (filter_phi_k_p * t112);
        const float filter_phi_s = state->filter_phi_s;
        const float filter_phi_h = state->filter_phi_h;
        const float t114 = filter_phi_h + (filter_phi_k_h * t112);
        const float t115 = filter_phi_s + (filter_phi_k_s * t112) + t114;
        const float t116 = t113 + t115;
        const float t117 = t115 + t114;
        float phi = t113;
        if ((guard_ready != 0u) && (fabsf(t116) <= 0.05f) && (fabsf(t117) <= 0.05f) && (fabsf(t114) <= 0.05f)) {
            state->filter_phi_p = t116;
            state->filter_phi_s = t117;
            state->filter_phi_h = t114;
        } else {
            phi = phi_raw;
            state->filter_phi_p = phi_raw;
            state->filter_phi_s = 0.0f;
            state->filter_phi_h = 0.0f;
        }

        /* heights: laser distances inverted */
        const float t118 = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (t118 + d3_held);
        const float theta = 8.333333f * (d3_held - t118);
        const float psi = 8.333333f * (d1_held - d2_held);

        /* loop_x: (21) */
        const float t119 = x_ref_held - x;
        const float loop_x_lag = state->loop_x_lag;
        const float loop_x_integral = state->loop_x_integral;
        const float d_x = (loop_x_direct * t119) + loop_x_lag + loop_x_integral;
        const float loop_x_lag_next = (loop_x_into_lag * t119) + (loop_x_pole * loop_x_lag);
        state->loop_x_lag = loop_x_lag_next;

        /* loop_y: (21) */
        const float t120 = y_ref_held - y;
        const float loop_y_lag = state->loop_y_lag;
        const float loop_y_integral = state->loop_y_integral;
        const float d_y = (loop_y_direct * t120) + loop_y_lag + loop_y_integral;
        const float loop_y_lag_next = (loop_y_into_lag * t120) + (loop_y_pole * loop_y_lag);
        state->loop_y_lag = loop_y_lag_next;

        /* loop_phi: (22) */
        const float t121 = phi_ref_held - phi;
        const float loop_phi_lag = state->loop_phi_lag;
        const float loop_phi_integral = state->loop_phi_integral;
        const float d_phi = (loop_phi_direct * t121) + loop_phi_lag + loop_phi_integral;
        const float loop_phi_lag_next = (loop_phi_into_lag * t121) + (loop_phi_pole * loop_phi_lag);
        state->loop_phi_lag = loop_phi_lag_next;

        /* loop_z: (23) */
        const float t122 = z_ref_held - z;
        const float loop_z_lag = state->loop_z_lag;
        const float loop_z_integral = state->loop_z_integral;
        const float d_z = (loop_z_direct * t122) + loop_z_lag + loop_z_integral;
        const float loop_z_lag_next = loop_z_into_lag * t122;
        state->loop_z_lag = loop_z_lag_next;

        /* loop_theta: (24) */
        const float t123 = theta_ref_held - theta;
        const float loop_theta_lag = state->loop_theta_lag;
        const float loop_theta_integral = state->loop_theta_integral;
        const float d_theta = (loop_theta_direct * t123) + loop_theta_lag + loop_theta_integral;
        const float loop_theta_lag_next = loop_theta_into_lag * t123;
        state->loop_theta_lag = loop_theta_lag_next;

        /* loop_psi: (25) */
        const float t124 = psi_ref_held - psi;
        const float loop_psi_lag = state->loop_psi_lag;
        const float loop_psi_integral = state->loop_psi_integral;
        const float d_psi = (loop_psi_direct * t124) + loop_psi_lag + loop_psi_integral;
        const float loop_psi_lag_next = loop_psi_into_lag * t124;
        state->loop_psi_lag = loop_psi_lag_next;

        /* allocation: Table 3, (17), limits */
        const float t125 = limit(phi, 0.02f);
        const float t126 = t125 * t125;
        const float t127 = f1_polynomial(t126);
        const float t128 = t125 * f2_polynomial(t126);
        const float t129 = 0.5f * ((t127 * d_y) - (t128 * d_x));
        const float t130 = (t127 * d_x) + (t128 * d_y);
        const float t131 = d_phi + t130;
        const float i_AQ = limit(t129 - t131, 1.197f);
        const float i_BQ = limit(t129 + t131, 1.197f);
        const float i_CQ = limit(t130, 1.197f);
        const float t132 = d_z - d_theta;
        const float i_AD = limit(t132 + d_psi, sqrtf(1.5876f - (i_AQ * i_AQ)));
        const float i_BD = limit(t132 - d_psi, sqrtf(1.5876f - (i_BQ * i_BQ)));

        /* loop_psi: (25) */
        const float loop_psi_integral_next = (loop_psi_reset * loop_psi_integral) + (0.5f * (loop_psi_driven * (i_AD - i_BD)));
        state->loop_psi_integral = loop_psi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float i_CD = limit(d_z + (2.0f * d_theta), sqrtf(1.5876f - (i_CQ * i_CQ)));

        /* loop_z: (23) */
        const float t133 = i_AD + i_BD;
        const float loop_z_integral_next = (loop_z_reset * loop_z_integral) + (0.33333334f * (loop_z_driven * (t133 + i_CD)));
        state->loop_z_integral = loop_z_integral_next;

        /* allocation: Table 3, (17), limits */
        const float t134 = i_AQ + i_BQ;
        const float made_x = (t127 * i_CQ) - (t128 * t134);

        /* loop_x: (21) */
        const float loop_x_integral_next = (loop_x_reset * loop_x_integral) + (loop_x_driven * made_x);
        state->loop_x_integral = loop_x_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_y = (t128 * i_CQ) + (t127 * t134);

        /* loop_y: (21) */
        const float loop_y_integral_next = (loop_y_reset * loop_y_integral) + (loop_y_driven * made_y);
        state->loop_y_integral = loop_y_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_phi = (0.5f * (i_BQ - i_AQ)) - i_CQ;

        /* loop_phi: (22) */
        const float loop_phi_integral_next = (loop_phi_reset * loop_phi_integral) + (loop_phi_driven * made_phi);
        state->loop_phi_integral = loop_phi_integral_next;

        /* allocation: Table 3, (17), limits */
        const float made_theta = (0.33333334f * i_CD) - (0.16666667f * t133);

        /* loop_theta: (24) */
        const float loop_theta_integral_next = (loop_theta_reset * loop_theta_integral) + (loop_theta_driven * made_theta);
        state->loop_theta_integral = loop_theta_integral_next;

        /* commutation: (17) inverted */
        const float distance_back = limit(x - (0.0508f * pitch_x) - (0.025584769f * t128), 0.02794f);
        const float quarter_sine_back = distance_back * quarter_sine_back_polynomial(distance_back * distance_back);
        const float distance_front = limit(y - (0.0508f * pitch_y) - ((0.012792384f * t127) - 0.0127f), 0.02794f);
        const float quarter_sine_front = distance_front * quarter_sine_back_polynomial(distance_front * distance_front);
        const float t135 = quarter_sine_front * quarter_sine_front;
        const float t136 = quarter_sine_front * sqrtf(1.0f - t135);
        const float t137 = t136 * (4.0f - (8.0f * t135));
        const float t138 = f4_polynomial(t126);
        const float t139 = t137 * t138;
        const float t140 = 1.0f - (8.0f * (t136 * t136));
        const float t141 = t125 * f5_polynomial(t126);
        const float t142 = t140 * t141;
        const float t143 = t139 - t142;
        const float t144 = t140 * t138;
        const float t145 = t137 * t141;
        const float t146 = t144 + t145;
        const float i_AA_computed = (t143 * i_AQ) + (t146 * i_AD);

        /* safe_output: slew to the safe output once latched */
        const float t147 = limit(i_AA_computed, 1.26f);
        state->safe_output_last_i_AA = t147;
        out->i_AA = t147;

        /* commutation: (17) inverted */
        const float t148 = 0.8660254f * ((t143 * i_AD) - (t146 * i_AQ));
        const float t149 = 0.5f * i_AA_computed;
        const float i_AB_computed = t148 - t149;

        /* safe_output: slew to the safe output once latched */
        const float t150 = limit(i_AB_computed, 1.26f);
        state->safe_output_last_i_AB = t150;
        out->i_AB = t150;

        /* commutation: (17) inverted */
        const float i_AC_computed = -(t148 + t149);

        /* safe_output: slew to the safe output once latched */
        const float t151 = limit(i_AC_computed, 1.26f);
        state->safe_output_last_i_AC = t151;
        out->i_AC = t151;

        /* commutation: (17) inverted */
        const float t152 = t139 + t142;
        const float t153 = t145 - t144;
        const float i_BA_computed = (t152 * i_BQ) - (t153 * i_BD);

        /* safe_output: slew to the safe output once latched */
        const float t154 = limit(i_BA_computed, 1.26f);
        state->safe_output_last_i_BA = t154;
        out->i_BA = t154;

        /* commutation: (17) inverted */
        const float t155 = 0.8660254f * ((t153 * i_BQ) + (t152 * i_BD));
        const float t156 = 0.5f * i_BA_computed;
        const float i_BB_computed = t155 - t156;

        /* safe_output: slew to the safe output once latched */
        const float t157 = limit(i_BB_computed, 1.26f);
        state->safe_output_last_i_BB = t157;
        out->i_BB = t157;

        /* commutation: (17) inverted */
        const float i_BC_computed = -(t155 + t156);

        /* safe_output: slew to the safe output once latched */
        const float t158 = limit(i_BC_computed, 1.26f);
        state->safe_output_last_i_BC = t158;
        out->i_BC = t158;

        /* commutation: (17) inverted */
        const float t159 = quarter_sine_back * quarter_sine_back;
        const float t160 = quarter_sine_back * sqrtf(1.0f - t159);
        const float t161 = 1.0f - (8.0f * (t160 * t160));
        const float t162 = t160 * (4.0f - (8.0f * t159));
        const float i_CA_computed = (t161 * i_CQ) - (t162 * i_CD);

        /* safe_output: slew to the safe output once latched */
        const float t163 = limit(i_CA_computed, 1.26f);
        state->safe_output_last_i_CA = t163;
        out->i_CA = t163;

        /* commutation: (17) inverted */
        const float t164 = 0.8660254f * ((t162 * i_CQ) + (t161 * i_CD));
        const float t165 = 0.5f * i_CA_computed;
        const float i_CB_computed = t164 - t165;

        /* safe_output: slew to the safe output once latched */
        const float t166 = limit(i_CB_computed, 1.26f);
        state->safe_output_last_i_CB = t166;
        out->i_CB = t166;

        /* commutation: (17) inverted */
        const float i_CC_computed = -(t164 + t165);

        /* safe_output: slew to the safe output once latched */
        const float t167 = limit(i_CC_computed, 1.26f);
        state->safe_output_last_i_CC = t167;
        out->i_CC = t167;
    }

    return faults;
}
