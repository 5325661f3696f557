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

/* quarter_sine_rear for distance_rear in -0.0272707082 .. 0.0272707082: quarter_sine_rear / x, t = x^2, x = distance_rear;
 * relative error at most 2.5e-06. */
static inline float quarter_sine_rear_polynomial(float t)
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
    state->sensing_contradiction_left = 0u;
    state->sensing_contradiction_confirmed = 0u;
    state->sensing_first_m_x = 0.0f;
    state->sensing_first_m_y = 0.0f;
    state->sensing_first_r_1 = 0.0f;
    state->sensing_first_r_2 = 0.0f;
    state->sensing_first_s_x = 0.0f;
    state->sensing_first_s_y = 0.0f;
    state->sensing_first_phi = 0.0f;
    state->sensing_offset_x = 0.0f;
    state->sensing_offset_y = 0.0f;
    state->sensing_within_x = 0.0f;
    state->sensing_within_y = 0.0f;
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
    state->loop_x_lead = 0.0f;
    state->loop_y_integral = 0.0f;
    state->loop_y_lead = 0.0f;
    state->loop_phi_integral = 0.0f;
    state->loop_phi_lead = 0.0f;
    state->loop_z_integral = 0.0f;
    state->loop_z_lead = 0.0f;
    state->loop_theta_integral = 0.0f;
    state->loop_theta_lead = 0.0f;
    state->loop_psi_integral = 0.0f;
    state->loop_psi_lead = 0.0f;
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
    static const float filter_x_k_p = 0.110377386f;             /* 1; (16), steady: gain on the position, in units of position */
    static const float filter_x_k_s = 0.006452916f;             /* 1; (16), steady: gain on the velocity, in units of position */
    static const float filter_x_k_h = 9.431981e-05f;            /* 1; (16), steady: gain on the acceleration, in units of position */
    static const float filter_y_k_p = 0.110377386f;             /* 1; (16), steady: gain on the position, in units of position */
    static const float filter_y_k_s = 0.006452916f;             /* 1; (16), steady: gain on the velocity, in units of position */
    static const float filter_y_k_h = 9.431981e-05f;            /* 1; (16), steady: gain on the acceleration, in units of position */
    static const float filter_phi_k_p = 0.30911008f;            /* 1; (16), steady: gain on the position, in units of position */
    static const float filter_phi_k_s = 0.05698819f;            /* 1; (16), steady: gain on the velocity, in units of position */
    static const float filter_phi_k_h = 0.0026284785f;          /* 1; (16), steady: gain on the acceleration, in units of position */
    static const float loop_x_gain = 2515.072f;                 /* A/m; (21): gain on the error */
    static const float loop_x_lead_input = -1799.755f;          /* A/m; (21): gain times (lead_pole - zero) */
    static const float loop_x_lead_pole = 0.2753623f;           /* 1; (21): pole of the lead filter in z */
    static const float loop_x_integral_decay = 0.9900498f;      /* 1; (21): zero of the integral action in z */
    static const float loop_x_integral_input = 0.0099502485f;   /* 1; (21): 1 - integral_decay */
    static const float loop_y_gain = 2515.072f;                 /* A/m; (21): gain on the error */
    static const float loop_y_lead_input = -1799.755f;          /* A/m; (21): gain times (lead_pole - zero) */
    static const float loop_y_lead_pole = 0.2753623f;           /* 1; (21): pole of the lead filter in z */
    static const float loop_y_integral_decay = 0.9900498f;      /* 1; (21): zero of the integral action in z */
    static const float loop_y_integral_input = 0.0099502485f;   /* 1; (21): 1 - integral_decay */
    static const float loop_phi_gain = 312.6659f;               /* A/rad; (22): gain on the error */
    static const float loop_phi_lead_input = -223.97475f;       /* A/rad; (22): gain times (lead_pole - zero) */
    static const float loop_phi_lead_pole = 0.2753623f;         /* 1; (22): pole of the lead filter in z */
    static const float loop_phi_integral_decay = 0.9900498f;    /* 1; (22): zero of the integral action in z */
    static const float loop_phi_integral_input = 0.0099502485f; /* 1; (22): 1 - integral_decay */
    static const float loop_z_gain = 4962.6665f;                /* A/m; (23): gain on the error */
    static const float loop_z_lead_input = -4476.951f;          /* A/m; (23): gain times (lead_pole - zero) */
    static const float loop_z_integral_decay = 0.9900498f;      /* 1; (23): zero of the integral action in z */
    static const float loop_theta_gain = 528.30865f;            /* A/rad; (24): gain on the error */
    static const float loop_theta_lead_input = -487.64932f;     /* A/rad; (24): gain times (lead_pole - zero) */
    static const float loop_theta_integral_decay = 0.9900498f;  /* 1; (24): zero of the integral action in z */
    static const float loop_theta_integral_input = 0.0099502485f;/* 1; (24): 1 - integral_decay */
    static const float loop_psi_gain = 581.13947f;              /* A/rad; (25): gain on the error */
    static const float loop_psi_lead_input = -536.41425f;       /* A/rad; (25): gain times (lead_pole - zero) */
    static const float loop_psi_integral_decay = 0.9900498f;    /* 1; (25): zero of the integral action in z */
    static const float allocation_rear_share = 0.33333334f;     /* 1; Table 3: c/(2 (b + c)) */
    static const float allocation_front_share = 0.16666667f;    /* 1; Table 3: b/(2 (b + c)) */
    static const float loop_z_integral_input_x_allocation_rear_share = 0.0033167496f;/* 1 1; (23): 1 - integral_decay; times allocation_rear_share */
    static const float loop_psi_integral_input_x_allocation_half = 0.0049751243f;/* 1 1; (25): 1 - integral_decay; times allocation_half */

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

    /* sensing: position and yaw, (1)-(5) */
    const uint32_t sensing_contradiction_confirmed = state->sensing_contradiction_confirmed;

    /* guard: range acceptance, hold, latch */
    bool complete = false;
    uint32_t faults = t2;
    if (sensing_contradiction_confirmed != 0u) {
        /* sensing: position and yaw, (1)-(5) */
        const float sensing_first_r_1 = state->sensing_first_r_1;
        const float sensing_first_r_2 = state->sensing_first_r_2;
        const float sensing_first_m_x = state->sensing_first_m_x;
        const float sensing_first_m_y = state->sensing_first_m_y;
        const float t4 = (sensing_first_r_1 * sensing_first_r_1) + (sensing_first_r_2 * sensing_first_r_2) + (0.033025026f * ((sensing_first_m_x * sensing_first_m_x) + (sensing_first_m_y * sensing_first_m_y)));
        const bool t5 = 0.12402716f < t4;
        const float t6 = fabsf(sensing_first_m_x);
        const bool t7 = 0.25838992f < t6;
        const float t8 = fabsf(sensing_first_m_y);
        const bool t9 = 0.25838992f < t8;
        const bool t10 = 0.07043498f < fabsf(sensing_first_r_2);
        const bool t11 = 0.07043498f < fabsf(sensing_first_r_1);
        bool t12;
        bool t13;
        bool t14 = t7;
        bool t15;
        bool t16;
        bool t17 = t9;
        if (t5) {
            const bool t18 = t6 < 0.8612997f;
            const float sensing_first_s_x = state->sensing_first_s_x;
            const float t19 = fabsf(sensing_first_r_2 * ((2.0f * sensing_first_s_x) + sensing_first_r_2));
            t12 = t10 && (!t18 || (t19 < 2.5838993f));
            const bool t20 = t8 < 0.8612997f;
            const float sensing_first_s_y = state->sensing_first_s_y;
            const float t21 = fabsf(sensing_first_r_1 * ((2.0f * sensing_first_s_y) + sensing_first_r_1));
            t13 = t11 && (!t20 || (t21 < 2.5838993f));
            t14 = (t19 + 0.8612997f) < t6;
            t15 = t11 && t20;
            t16 = t10 && t18;
            t17 = (t21 + 0.8612997f) < t8;
        } else {
            const bool t22 = t10 || t11;
            t12 = t22 || t7;
            t13 = t22 || t9;
            t15 = t22;
            t16 = t22;
        }
        const float sensing_first_phi = state->sensing_first_phi;
        const bool t23 = (0.01f < fabsf(sensing_first_phi)) || (t7 && t9 && !t5);
        const bool suspect_V_ax = t12 || t23;
        const bool suspect_V_ay = t13 || t23;
        const bool suspect_V_bx = t14 || t23;
        const bool suspect_V_by = t15 || t23;
        const bool suspect_V_cx = t16 || t23;
        const bool suspect_V_cy = t17 || t23;
        uint32_t t24 = t2;
        if (suspect_V_ax) {
            t24 = t2 | 0x00008000u;
        }
        if (suspect_V_ay) {
            t24 |= 0x00010000u;
        }
        if (suspect_V_bx) {
            t24 |= 0x00020000u;
        }
        if (suspect_V_by) {
            t24 |= 0x00040000u;
        }
        if (suspect_V_cx) {
            t24 |= 0x00080000u;
        }
        if (suspect_V_cy) {
            faults = t24 | 0x00100000u;
        } else {
            faults = t24;
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
        const float t25 = max(min(0.0f, safe_output_last_i_AA + 0.126f), safe_output_last_i_AA - 0.126f);
        out->i_AA = t25;
        const float safe_output_last_i_AB = state->safe_output_last_i_AB;
        const float t26 = max(min(0.0f, safe_output_last_i_AB + 0.126f), safe_output_last_i_AB - 0.126f);
        out->i_AB = t26;
        const float safe_output_last_i_AC = state->safe_output_last_i_AC;
        const float t27 = max(min(0.0f, safe_output_last_i_AC + 0.126f), safe_output_last_i_AC - 0.126f);
        out->i_AC = t27;
        const float safe_output_last_i_BA = state->safe_output_last_i_BA;
        const float t28 = max(min(0.0f, safe_output_last_i_BA + 0.126f), safe_output_last_i_BA - 0.126f);
        out->i_BA = t28;
        const float safe_output_last_i_BB = state->safe_output_last_i_BB;
        const float t29 = max(min(0.0f, safe_output_last_i_BB + 0.126f), safe_output_last_i_BB - 0.126f);
        out->i_BB = t29;
        const float safe_output_last_i_BC = state->safe_output_last_i_BC;
        const float t30 = max(min(0.0f, safe_output_last_i_BC + 0.126f), safe_output_last_i_BC - 0.126f);
        out->i_BC = t30;
        const float safe_output_last_i_CA = state->safe_output_last_i_CA;
        const float t31 = max(min(0.0f, safe_output_last_i_CA + 0.126f), safe_output_last_i_CA - 0.126f);
        out->i_CA = t31;
        const float safe_output_last_i_CB = state->safe_output_last_i_CB;
        const float t32 = max(min(0.0f, safe_output_last_i_CB + 0.126f), safe_output_last_i_CB - 0.126f);
        out->i_CB = t32;
        const float safe_output_last_i_CC = state->safe_output_last_i_CC;
        state->safe_output_last_i_AA = t25;
        state->safe_output_last_i_AB = t26;
        state->safe_output_last_i_AC = t27;
        state->safe_output_last_i_BA = t28;
        state->safe_output_last_i_BB = t29;
        state->safe_output_last_i_BC = t30;
        state->safe_output_last_i_CA = t31;
        state->safe_output_last_i_CB = t32;
        const float t33 = max(min(0.0f, safe_output_last_i_CC + 0.126f), safe_output_last_i_CC - 0.126f);
        state->safe_output_last_i_CC = t33;
        out->i_CC = t33;

        /* guard: range acceptance, hold, latch */
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* filter_phi: Kalman filter, (6)-(16) */
        const float filter_phi_p = state->filter_phi_p;

        /* filter_x: Kalman filter, (6)-(16) */
        const float filter_x_p = state->filter_x_p;

        /* sensing: position and yaw, (1)-(5) */
        const float t34 = filter_phi_p * V_ay_held;
        const float t35 = t34 - V_bx_held;
        const float sensing_first_s_x_next = V_ax_held - t34;
        const float t36 = filter_phi_p * V_ax_held;
        const float t37 = V_cy_held + t36;
        const float t38 = t37 * t37;
        const float sensing_first_s_y_next = V_ay_held + t36;
        const float t39 = sensing_first_s_y_next * sensing_first_s_y_next;
        const float t40 = t35 + sensing_first_s_x_next - (t37 * t38 * (sensing_slope_0 + (t39 * sensing_slope_1)));
        const float r_1 = V_by_held - V_ay_held - (t40 * filter_phi_p);
        const float t41 = t35 * t35;
        const float t42 = sensing_first_s_x_next * sensing_first_s_x_next;
        const float t43 = (t35 * t41 * (sensing_slope_0 + (t42 * sensing_slope_1))) + (sensing_first_s_y_next - t37);
        const float r_2 = V_cx_held - V_ax_held + (t43 * filter_phi_p);
        const float t44 = sensing_first_s_x_next * t35;
        const float t45 = t44 * t44;
        const float m_x = t42 + t41 - (sensing_power_0 + (t45 * (sensing_power_1 + (t45 * sensing_power_2))));
        const float t46 = sensing_first_s_y_next * t37;
        const float t47 = t46 * t46;
        const float m_y = t39 + t38 - (sensing_power_0 + (t47 * (sensing_power_1 + (t47 * sensing_power_2))));
        const uint32_t sensing_contradiction_left = state->sensing_contradiction_left;
        bool t48 = false;
        if ((guard_ready != 0u) && complete) {
            const float t49 = (r_1 * r_1) + (r_2 * r_2) + (0.033025026f * ((m_x * m_x) + (m_y * m_y)));
            t48 = (0.013780796f < t49) && ((sensing_contradiction_left != 0u) || (0.055123184f < t49));
        }
        const bool t50 = !t48 && complete;
        const float filter_y_p = state->filter_y_p;
        float x_raw = filter_x_p;
        float y_raw = filter_y_p;
        float t51 = 0.0f;
        float within_x;
        float within_y;
        if (t50) {
            const float ratio_x = t44 / (max(t42, t41) + 8.612998e-06f);
            /*@ admit -1.0f <= ratio_x <= 1.0f; */
            const float t52 = ratio_x * ratio_x;
            const float t53 = sensing_position_1 + (t52 * (sensing_position_3 + (t52 * (sensing_position_5 + (t52 * sensing_position_7)))));
            const float t54 = ratio_x * t53;
            float sensing_within_x_next;
            if (t42 <= t41) {
                if (t35 < 0.0f) {
                    if (0.0f < t54) {
                        sensing_within_x_next = t54 - 0.0254f;
                    } else {
                        sensing_within_x_next = t54 + 0.0254f;
                    }
                } else {
                    sensing_within_x_next = t54;
                }
            } else {
                sensing_within_x_next = ((sensing_first_s_x_next < 0.0f) ? -0.0127f : 0.0127f) - t54;
            }
            const float sensing_offset_x = state->sensing_offset_x;
            const float t55 = sensing_within_x_next - (filter_x_p - sensing_offset_x);
            float t56 = sensing_offset_x;
            if (0.0254f < fabsf(t55)) {
                if (0.0f < t55) {
                    if (-0.0508f <= sensing_offset_x) {
                        const float t57 = sensing_offset_x - 0.0508f;
                        t56 = t57;
                        state->sensing_offset_x = t57;
                    }
                } else {
                    if (sensing_offset_x <= 0.0508f) {
                        const float t58 = sensing_offset_x + 0.0508f;
                        t56 = t58;
                        state->sensing_offset_x = t58;
                    }
                }
            }
            x_raw = sensing_within_x_next + t56;
            within_x = sensing_within_x_next;
            const float ratio_y = -(t46 / (max(t39, t38) + 8.612998e-06f));
            /*@ admit -1.0f <= ratio_y <= 1.0f; */
            const float t59 = ratio_y * ratio_y;
            const float t60 = sensing_position_1 + (t59 * (sensing_position_3 + (t59 * (sensing_position_5 + (t59 * sensing_position_7)))));
            const float t61 = ratio_y * t60;
            float sensing_within_y_next;
            if (t39 <= t38) {
                if (-t37 < 0.0f) {
                    if (0.0f < t61) {
                        sensing_within_y_next = t61 - 0.0254f;
                    } else {
                        sensing_within_y_next = t61 + 0.0254f;
                    }
                } else {
                    sensing_within_y_next = t61;
                }
            } else {
                sensing_within_y_next = ((sensing_first_s_y_next < 0.0f) ? -0.0127f : 0.0127f) - t61;
            }
            const float sensing_offset_y = state->sensing_offset_y;
            const float t62 = sensing_within_y_next - (filter_y_p - sensing_offset_y);
            float t63 = sensing_offset_y;
            if (0.0254f < fabsf(t62)) {
                if (0.0f < t62) {
                    if (-0.0508f <= sensing_offset_y) {
                        const float t64 = sensing_offset_y - 0.0508f;
                        t63 = t64;
                        state->sensing_offset_y = t64;
                    }
                } else {
                    if (sensing_offset_y <= 0.0508f) {
                        const float t65 = sensing_offset_y + 0.0508f;
                        t63 = t65;
                        state->sensing_offset_y = t65;
                    }
                }
            }
            y_raw = sensing_within_y_next + t63;
            state->sensing_within_x = sensing_within_x_next;
            within_y = sensing_within_y_next;
            state->sensing_within_y = sensing_within_y_next;
            const float t66 = (sensing_first_s_x_next * (sensing_first_s_y_next + t37)) + (sensing_first_s_y_next * (sensing_first_s_x_next - t35));
            const float t67 = ((t40 * r_1) - (t43 * r_2) + (sensing_amplitude_weight * (t66 * (m_x - m_y)))) / ((t40 * t40) + (t43 * t43) + (2.0f * (sensing_amplitude_weight * (t66 * t66))) + 0.08612997f);
            t51 = t67;
        } else {
            within_x = state->sensing_within_x;
            within_y = state->sensing_within_y;
        }
        const float phi_raw = limit(filter_phi_p + t51, 0.025f);
        if (t48) {
            state->sensing_contradiction_left = 4u;
        } else {
            if (t50 && (sensing_contradiction_left != 0u)) {
                state->sensing_contradiction_left = sensing_contradiction_left - 1u;
            }
        }
        if (t48 && (sensing_contradiction_left != 0u)) {
            state->sensing_contradiction_confirmed = 1u;
        }
        if (t48 && !(sensing_contradiction_left != 0u)) {
            state->sensing_first_m_x = m_x;
            state->sensing_first_m_y = m_y;
            state->sensing_first_r_1 = r_1;
            state->sensing_first_r_2 = r_2;
            state->sensing_first_s_x = sensing_first_s_x_next;
            state->sensing_first_s_y = sensing_first_s_y_next;
            state->sensing_first_phi = filter_phi_p;
        }

        /* filter_x: Kalman filter, (6)-(16) */
        const float t68 = x_raw - filter_x_p;
        const float t69 = filter_x_p + (filter_x_k_p * t68);
        const float filter_x_s = state->filter_x_s;
        const float filter_x_h = state->filter_x_h;
        const float t70 = filter_x_h + (filter_x_k_h * t68);
        const float t71 = filter_x_s + (filter_x_k_s * t68) + t70;
        const float t72 = t69 + t71;
        const float t73 = t71 + t70;
        float x = t69;
        if ((guard_ready != 0u) && (fabsf(t72) <= 0.2f) && (fabsf(t73) <= 0.2f) && (fabsf(t70) <= 0.2f)) {
            state->filter_x_p = t72;
            state->filter_x_s = t73;
            state->filter_x_h = t70;
        } else {
            x = x_raw;
            state->filter_x_p = x_raw;
            state->filter_x_s = 0.0f;
            state->filter_x_h = 0.0f;
        }

        /* filter_y: Kalman filter, (6)-(16) */
        const float t74 = y_raw - filter_y_p;
        const float t75 = filter_y_p + (filter_y_k_p * t74);
        const float filter_y_s = state->filter_y_s;
        const float filter_y_h = state->filter_y_h;
        const float t76 = filter_y_h + (filter_y_k_h * t74);
        const float t77 = filter_y_s + (filter_y_k_s * t74) + t76;
        const float t78 = t75 + t77;
        const float t79 = t77 + t76;
        float y = t75;
        if ((guard_ready != 0u) && (fabsf(t78) <= 0.2f) && (fabsf(t79) <= 0.2f) && (fabsf(t76) <= 0.2f)) {
            state->filter_y_p = t78;
            state->filter_y_s = t79;
            state->filter_y_h = t76;
        } else {
            y = y_raw;
            state->filter_y_p = y_raw;
            state->filter_y_s = 0.0f;
            state->filter_y_h = 0.0f;
        }

        /* filter_phi: Kalman filter, (6)-(16) */
        const float t80 = phi_raw - filter_phi_p;
        const float t81 = filter_phi_p + (filter_phi_k_p * t80);
        const float filter_phi_s = state->filter_phi_s;
        const float filter_phi_h = state->filter_phi_h;
        const float t82 = filter_phi_h + (filter_phi_k_h * t80);
        const float t83 = filter_phi_s + (filter_phi_k_s * t80) + t82;
        const float t84 = t81 + t83;
        const float t85 = t83 + t82;
        float phi = t81;
        if ((guard_ready != 0u) && (fabsf(t84) <= 0.05f) && (fabsf(t85) <= 0.05f) && (fabsf(t82) <= 0.05f)) {
            state->filter_phi_p = t84;
            state->filter_phi_s = t85;
            state->filter_phi_h = t82;
        } else {
            phi = phi_raw;
            state->filter_phi_p = phi_raw;
            state->filter_phi_s = 0.0f;
            state->filter_phi_h = 0.0f;
        }

        /* vertical_kinematics: z and tilts from distances */
        const float t86 = 0.5f * (d1_held + d2_held);
        const float z = 0.5f * (t86 + d3_held);
        const float theta = 8.333333f * (d3_held - t86);
        const float psi = 8.333333f * (d1_held - d2_held);

        /* loop_x: lead-lag, (21) */
        const float t87 = x_ref_held - x;
        const float loop_x_lead = state->loop_x_lead;
        const float loop_x_integral = state->loop_x_integral;
        const float d_x = (loop_x_gain * t87) + loop_x_lead + loop_x_integral;
        const float loop_x_lead_next = (loop_x_lead_input * t87) + (loop_x_lead_pole * loop_x_lead);
        state->loop_x_lead = loop_x_lead_next;

        /* loop_y: lead-lag, (21) */
        const float t88 = y_ref_held - y;
        const float loop_y_lead = state->loop_y_lead;
        const float loop_y_integral = state->loop_y_integral;
        const float d_y = (loop_y_gain * t88) + loop_y_lead + loop_y_integral;
        const float loop_y_lead_next = (loop_y_lead_input * t88) + (loop_y_lead_pole * loop_y_lead);
        state->loop_y_lead = loop_y_lead_next;

        /* loop_phi: lead-lag, (22) */
        const float t89 = phi_ref_held - phi;
        const float loop_phi_lead = state->loop_phi_lead;
        const float loop_phi_integral = state->loop_phi_integral;
        const float d_phi = (loop_phi_gain * t89) + loop_phi_lead + loop_phi_integral;
        const float loop_phi_lead_next = (loop_phi_lead_input * t89) + (loop_phi_lead_pole * loop_phi_lead);
        state->loop_phi_lead = loop_phi_lead_next;

        /* loop_z: lead-lag, (23) */
        const float t90 = z_ref_held - z;
        const float loop_z_lead = state->loop_z_lead;
        const float loop_z_integral = state->loop_z_integral;
        const float d_z = (loop_z_gain * t90) + loop_z_lead + loop_z_integral;
        const float loop_z_lead_next = loop_z_lead_input * t90;
        state->loop_z_lead = loop_z_lead_next;

        /* loop_theta: lead-lag, (24) */
        const float t91 = theta_ref_held - theta;
        const float loop_theta_lead = state->loop_theta_lead;
        const float loop_theta_integral = state->loop_theta_integral;
        const float d_theta = (loop_theta_gain * t91) + loop_theta_lead + loop_theta_integral;
        const float loop_theta_lead_next = loop_theta_lead_input * t91;
        state->loop_theta_lead = loop_theta_lead_next;

        /* loop_psi: lead-lag, (25) */
        const float t92 = psi_ref_held - psi;
        const float loop_psi_lead = state->loop_psi_lead;
        const float loop_psi_integral = state->loop_psi_integral;
        const float d_psi = (loop_psi_gain * t92) + loop_psi_lead + loop_psi_integral;
        const float loop_psi_lead_next = loop_psi_lead_input * t92;
        state->loop_psi_lead = loop_psi_lead_next;

        /* allocation: motor currents, Table 3, (17) */
        const float t93 = phi * phi;
        const float t94 = f1_polynomial(t93);
        const float t95 = phi * f2_polynomial(t93);
        const float i_CQ = limit((t94 * d_x) + (t95 * d_y), max(1.134f - fabsf(d_phi), 0.567f));
        const float t96 = limit(d_phi + i_CQ, 1.134f);
        const float t97 = limit(0.5f * ((t94 * d_y) - (t95 * d_x)), 1.134f - fabsf(t96));
        const float i_AQ = t97 - t96;
        const float i_BQ = t97 + t96;
        const float t98 = d_z - d_theta;
        const float i_AD = limit(t98 + d_psi, 0.54913455f);
        const float i_BD = limit(t98 - d_psi, 0.54913455f);

        /* loop_psi: lead-lag, (25) */
        const float loop_psi_integral_next = (loop_psi_integral_decay * loop_psi_integral) + (loop_psi_integral_input_x_allocation_half * (i_AD - i_BD));
        state->loop_psi_integral = loop_psi_integral_next;

        /* allocation: motor currents, Table 3, (17) */
        const float i_CD = limit(d_z + (2.0f * d_theta), 0.54913455f);

        /* loop_z: lead-lag, (23) */
        const float t99 = i_AD + i_BD;
        const float loop_z_integral_next = (loop_z_integral_decay * loop_z_integral) + (loop_z_integral_input_x_allocation_rear_share * (t99 + i_CD));
        state->loop_z_integral = loop_z_integral_next;

        /* allocation: motor currents, Table 3, (17) */
        const float achieved_x = (t94 * i_CQ) - (2.0f * (t95 * t97));

        /* loop_x: lead-lag, (21) */
        const float loop_x_integral_next = (loop_x_integral_decay * loop_x_integral) + (loop_x_integral_input * achieved_x);
        state->loop_x_integral = loop_x_integral_next;

        /* allocation: motor currents, Table 3, (17) */
        const float achieved_y = (t95 * i_CQ) + (2.0f * (t94 * t97));

        /* loop_y: lead-lag, (21) */
        const float loop_y_integral_next = (loop_y_integral_decay * loop_y_integral) + (loop_y_integral_input * achieved_y);
        state->loop_y_integral = loop_y_integral_next;

        /* allocation: motor currents, Table 3, (17) */
        const float achieved_phi = t96 - i_CQ;

        /* loop_phi: lead-lag, (22) */
        const float loop_phi_integral_next = (loop_phi_integral_decay * loop_phi_integral) + (loop_phi_integral_input * achieved_phi);
        state->loop_phi_integral = loop_phi_integral_next;

        /* allocation: motor currents, Table 3, (17) */
        const float achieved_theta = (allocation_rear_share * i_CD) - (allocation_front_share * t99);

        /* loop_theta: lead-lag, (24) */
        const float loop_theta_integral_next = (loop_theta_integral_decay * loop_theta_integral) + (loop_theta_integral_input * achieved_theta);
        state->loop_theta_integral = loop_theta_integral_next;

        /* commutation: phase currents, (17) inverted */
        const float distance_rear = within_x - (0.025584769f * t95);
        const float quarter_sine_rear = distance_rear * quarter_sine_rear_polynomial(distance_rear * distance_rear);
        const float distance_front = within_y - ((0.012792384f * t94) - 0.0127f);
        const float quarter_sine_front = distance_front * quarter_sine_front_polynomial(distance_front * distance_front);
        const float t100 = quarter_sine_front * quarter_sine_front;
        const float t101 = quarter_sine_front * sqrtf(1.0f - t100);
        const float t102 = t101 * (4.0f - (8.0f * t100));
        const float t103 = f5_polynomial(t93);
        const float t104 = t102 * t103;
        const float t105 = 1.0f - (8.0f * (t101 * t101));
        const float t106 = phi * f6_polynomial(t93);
        const float t107 = t105 * t106;
        const float t108 = t104 - t107;
        const float t109 = t105 * t103;
        const float t110 = t102 * t106;
        const float t111 = t109 + t110;
        const float i_AA_computed = (t108 * i_AQ) + (t111 * i_AD);
        /*@ admit -1.26f <= i_AA_computed <= 1.26f; */
        state->safe_output_last_i_AA = i_AA_computed;
        out->i_AA = i_AA_computed;
        const float t112 = 0.8660254f * ((t108 * i_AD) - (t111 * i_AQ));
        const float t113 = 0.5f * i_AA_computed;
        const float i_AB_computed = t112 - t113;
        /*@ admit -1.26f <= i_AB_computed <= 1.26f; */
        state->safe_output_last_i_AB = i_AB_computed;
        out->i_AB = i_AB_computed;
        const float i_AC_computed = -(t113 + t112);
        /*@ admit -1.26f <= i_AC_computed <= 1.26f; */
        state->safe_output_last_i_AC = i_AC_computed;
        out->i_AC = i_AC_computed;
        const float t114 = t104 + t107;
        const float t115 = t110 - t109;
        const float i_BA_computed = (t114 * i_BQ) - (t115 * i_BD);
        /*@ admit -1.26f <= i_BA_computed <= 1.26f; */
        state->safe_output_last_i_BA = i_BA_computed;
        out->i_BA = i_BA_computed;
        const float t116 = 0.8660254f * ((t115 * i_BQ) + (t114 * i_BD));
        const float t117 = 0.5f * i_BA_computed;
        const float i_BB_computed = t116 - t117;
        /*@ admit -1.26f <= i_BB_computed <= 1.26f; */
        state->safe_output_last_i_BB = i_BB_computed;
        out->i_BB = i_BB_computed;
        const float i_BC_computed = -(t117 + t116);
        /*@ admit -1.26f <= i_BC_computed <= 1.26f; */
        state->safe_output_last_i_BC = i_BC_computed;
        out->i_BC = i_BC_computed;
        const float t118 = quarter_sine_rear * quarter_sine_rear;
        const float t119 = quarter_sine_rear * sqrtf(1.0f - t118);
        const float t120 = 1.0f - (8.0f * (t119 * t119));
        const float t121 = t119 * (4.0f - (8.0f * t118));
        const float i_CA_computed = (t120 * i_CQ) - (t121 * i_CD);
        /*@ admit -1.26f <= i_CA_computed <= 1.26f; */
        state->safe_output_last_i_CA = i_CA_computed;
        out->i_CA = i_CA_computed;
        const float t122 = 0.8660254f * ((t121 * i_CQ) + (t120 * i_CD));
        const float t123 = 0.5f * i_CA_computed;
        const float i_CB_computed = t122 - t123;
        /*@ admit -1.26f <= i_CB_computed <= 1.26f; */
        state->safe_output_last_i_CB = i_CB_computed;
        out->i_CB = i_CB_computed;
        const float i_CC_computed = -(t123 + t122);
        /*@ admit -1.26f <= i_CC_computed <= 1.26f; */
        state->safe_output_last_i_CC = i_CC_computed;
        out->i_CC = i_CC_computed;
    }

    return faults;
}
