/* maglev_5dof. Generated: do not edit. */
#include "maglev_5dof.h"
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

/* phi for y3_held - y1_held in -0.0154000018 .. 0.0154000018: phi / x, t = x^2, x = y3_held - y1_held;
 * relative error at most 1.1e-07. */
static inline float phi_polynomial(float t)
{
    return 1.2594458f + (t * 0.3330033f);
}

/* theta for y2_held - y4_held in -0.0241999999 .. 0.0241999999: theta / x, t = x^2, x = y2_held - y4_held;
 * relative error at most 1.2e-07. */
static inline float theta_polynomial(float t)
{
    return 1.2594458f + (t * 0.33307245f);
}

/* thrust_per_ampere_1 for 1.53083199e-06 / (y1_held + 0.00923333333) in 3.69468689e-05 .. 5.88027688e-05: t = 1.53083199e-06 / (y1_held + 0.00923333333) - 4.19616699e-05;
 * relative error at most 1.7e-07. */
static inline float thrust_per_ampere_1_polynomial(float t)
{
    return 11.033894f + (t * (526422.7f + (t * (6.5208314e+08f + (t * (-7.354629e+13f + (t * (2.0442113e+18f + (t * (-4.015988e+22f + (t * 3.9883e+26f)))))))))));
}

/* half_a_over_h2_1 for 1.53083199e-06 / (y1_held + 0.00923333333) in 3.69468689e-05 .. 5.88027688e-05: t = 1.53083199e-06 / (y1_held + 0.00923333333) - 4.19616699e-05;
 * relative error at most 2.8e-07. */
static inline float half_a_over_h2_1_polynomial(float t)
{
    return 0.082106546f + (t * (372.6345f + (t * (2.9113838e+06f + (t * (2.5398596e+10f + (t * 2.6154908e+14f)))))));
}

/* thrust_per_ampere_2 for 1.53083199e-06 / (y2_held + 0.00923333333) in 3.33999706e-05 .. 7.07626459e-05: t = (1.53083199e-06 / (y2_held + 0.00923333333) - 3.43322754e-05) * 16384;
 * relative error at most 2.9e-07. */
static inline float thrust_per_ampere_2_polynomial(float t)
{
    return 7.0962987f + (t * (30.470612f + (t * (12.132695f + (t * (-37.392975f + (t * (56.708466f + (t * (-57.090378f + (t * (33.817627f + (t * -9.12594f)))))))))))));
}

/* half_a_over_h2_2 for 1.53083199e-06 / (y2_held + 0.00923333333) in 3.33999706e-05 .. 7.07626459e-05: t = (1.53083199e-06 / (y2_held + 0.00923333333) - 3.43322754e-05) * 16384;
 * relative error at most 3.3e-07. */
static inline float half_a_over_h2_2_polynomial(float t)
{
    return 0.079422385f + (t * (0.020285927f + (t * (0.008864189f + (t * (0.0048612426f + (t * (0.001367154f + (t * 0.0020529632f)))))))));
}

void maglev_5dof_init(maglev_5dof_state_t *state)
{
    state->guard_last_y1 = 0.031f;
    state->guard_last_y2 = 0.031f;
    state->guard_last_y3 = 0.031f;
    state->guard_last_y4 = 0.031f;
    state->guard_last_x = 0.0f;
    state->guard_last_z = 0.0f;
    state->guard_last_y_ref = 0.031f;
    state->guard_last_x_ref = 0.0f;
    state->guard_last_z_ref = 0.0f;
    state->guard_last_phi_ref = 0.0f;
    state->guard_last_theta_ref = 0.0f;
    state->guard_left = 5u;
    state->guard_latched = 0u;
    state->guard_ready = 0u;
    state->filter_y_q_prev = 0.0f;
    state->filter_y_s = 0.0f;
    state->filter_y_r = 0.0f;
    state->regulator_y_sum = 0.0f;
    state->regulator_y_p1 = 0.0f;
    state->regulator_y_q1 = 0.0f;
    state->filter_x_q_prev = 0.0f;
    state->filter_x_s = 0.0f;
    state->filter_x_r = 0.0f;
    state->regulator_x_sum = 0.0f;
    state->regulator_x_p1 = 0.0f;
    state->regulator_x_q1 = 0.0f;
    state->filter_z_q_prev = 0.0f;
    state->filter_z_s = 0.0f;
    state->filter_z_r = 0.0f;
    state->regulator_z_sum = 0.0f;
    state->regulator_z_p1 = 0.0f;
    state->regulator_z_q1 = 0.0f;
    state->filter_phi_q_prev = 0.0f;
    state->filter_phi_s = 0.0f;
    state->filter_phi_r = 0.0f;
    state->regulator_phi_sum = 0.0f;
    state->regulator_phi_p1 = 0.0f;
    state->regulator_phi_q1 = 0.0f;
    state->filter_theta_q_prev = 0.0f;
    state->filter_theta_s = 0.0f;
    state->filter_theta_r = 0.0f;
    state->regulator_theta_sum = 0.0f;
    state->regulator_theta_p1 = 0.0f;
    state->regulator_theta_q1 = 0.0f;
    state->safe_output_last_i_d1 = 2.5f;
    state->safe_output_last_i_d2 = 2.5f;
    state->safe_output_last_i_d3 = 2.5f;
    state->safe_output_last_i_d4 = 2.5f;
    state->safe_output_last_u_x = 0.0f;
    state->safe_output_last_u_z = 0.0f;
}

uint32_t maglev_5dof_step(maglev_5dof_state_t *state, const maglev_5dof_input_t *in, maglev_5dof_output_t *out)
{
    static const float filter_y_fade = 0.36787945f;             /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float filter_y_rho = 0.5121659f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float regulator_y_k_e = -1699.6849f;           /* 1/s^2; F(14)-(16): gain on e */
    static const float regulator_y_k_sum = -2.251582f;          /* 1/s^2; F(14)-(16): gain on sum */
    static const float regulator_y_k_p1 = 122.7319f;            /* 1/s^2; F(14)-(16): gain on p1 */
    static const float regulator_y_k_q1 = -5.5538764f;          /* 1/s^2; F(14)-(16): gain on q1 */
    static const float regulator_y_c1 = 2.2206568e-05f;         /* 1; F(14)-(16): 2 - 2 cos(w T), w T = 0.00471239 */
    static const float filter_x_fade = 0.36787945f;             /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float filter_x_rho = 0.5121659f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float regulator_x_k_e = -525.33453f;           /* 1/s^2; F(14)-(17): gain on e */
    static const float regulator_x_k_sum = -0.9552653f;         /* 1/s^2; F(14)-(17): gain on sum */
    static const float regulator_x_k_p1 = -56.45106f;           /* 1/s^2; F(14)-(17): gain on p1 */
    static const float regulator_x_k_q1 = -1.7875412f;          /* 1/s^2; F(14)-(17): gain on q1 */
    static const float regulator_x_c1 = 2.2206568e-05f;         /* 1; F(14)-(17): 2 - 2 cos(w T), w T = 0.00471239 */
    static const float regulator_x_sum_excess = 0.0016244627f;  /* m/A; F(14)-(17): anti-windup into sum */
    static const float regulator_x_p1_excess = 1.5544656e-06f;  /* m/A; F(14)-(17): anti-windup into p1 */
    static const float regulator_x_q1_excess = 7.0777234e-05f;  /* m/A; F(14)-(17): anti-windup into q1 */
    static const float filter_z_fade = 0.36787945f;             /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float filter_z_rho = 0.5121659f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float regulator_z_k_e = -525.33453f;           /* 1/s^2; F(14)-(17): gain on e */
    static const float regulator_z_k_sum = -0.9552653f;         /* 1/s^2; F(14)-(17): gain on sum */
    static const float regulator_z_k_p1 = -56.45106f;           /* 1/s^2; F(14)-(17): gain on p1 */
    static const float regulator_z_k_q1 = -1.7875412f;          /* 1/s^2; F(14)-(17): gain on q1 */
    static const float regulator_z_c1 = 2.2206568e-05f;         /* 1; F(14)-(17): 2 - 2 cos(w T), w T = 0.00471239 */
    static const float regulator_z_sum_excess = 0.0016244627f;  /* m/A; F(14)-(17): anti-windup into sum */
    static const float regulator_z_p1_excess = 1.5544656e-06f;  /* m/A; F(14)-(17): anti-windup into p1 */
    static const float regulator_z_q1_excess = 7.0777234e-05f;  /* m/A; F(14)-(17): anti-windup into q1 */
    static const float filter_phi_fade = 0.36787945f;           /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float filter_phi_rho = 0.5121659f;             /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float regulator_phi_k_e = -2049.9666f;         /* 1/s^2; F(14)-(16): gain on e */
    static const float regulator_phi_k_sum = -2.8480508f;       /* 1/s^2; F(14)-(16): gain on sum */
    static const float regulator_phi_k_p1 = 86.03567f;          /* 1/s^2; F(14)-(16): gain on p1 */
    static const float regulator_phi_k_q1 = -7.0522647f;        /* 1/s^2; F(14)-(16): gain on q1 */
    static const float regulator_phi_c1 = 2.2206568e-05f;       /* 1; F(14)-(16): 2 - 2 cos(w T), w T = 0.00471239 */
    static const float filter_theta_fade = 0.36787945f;         /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float filter_theta_rho = 0.5121659f;           /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float regulator_theta_k_e = -2049.9666f;       /* 1/s^2; F(14)-(16): gain on e */
    static const float regulator_theta_k_sum = -2.8480508f;     /* 1/s^2; F(14)-(16): gain on sum */
    static const float regulator_theta_k_p1 = 86.03567f;        /* 1/s^2; F(14)-(16): gain on p1 */
    static const float regulator_theta_k_q1 = -7.0522647f;      /* 1/s^2; F(14)-(16): gain on q1 */
    static const float regulator_theta_c1 = 2.2206568e-05f;     /* 1; F(14)-(16): 2 - 2 cos(w T), w T = 0.00471239 */
    static const float regulator_y_k_de_x_filter_y_h = -48291.37f;/* 1/s 1/s; F(14)-(16): gain on de; times filter_y_h */
    static const float regulator_x_k_de_x_filter_x_h = -13345.273f;/* 1/s 1/s; F(14)-(17): gain on de; times filter_x_h */
    static const float regulator_z_k_de_x_filter_z_h = -13345.273f;/* 1/s 1/s; F(14)-(17): gain on de; times filter_z_h */
    static const float regulator_phi_k_de_x_filter_phi_h = -55490.594f;/* 1/s 1/s; F(14)-(16): gain on de; times filter_phi_h */
    static const float regulator_theta_k_de_x_filter_theta_h = -55490.594f;/* 1/s 1/s; F(14)-(16): gain on de; times filter_theta_h */

    /* guard: range acceptance, hold, latch */
    const float y1 = in->y1;
    float y1_held = y1;
    bool complete = true;
    uint32_t faults = 0u;
    if ((0.0168f <= y1) && (y1 <= 0.0322f)) {
        state->guard_last_y1 = y1;
    } else {
        y1_held = state->guard_last_y1;
        complete = false;
        faults = 0x00000001u;
    }
    const float y2 = in->y2;
    float y2_held = y2;
    if ((0.0124f <= y2) && (y2 <= 0.0366f)) {
        state->guard_last_y2 = y2;
    } else {
        y2_held = state->guard_last_y2;
        complete = false;
        faults |= 0x00000002u;
    }
    const float y3 = in->y3;
    float y3_held = y3;
    if ((0.0168f <= y3) && (y3 <= 0.0322f)) {
        state->guard_last_y3 = y3;
    } else {
        y3_held = state->guard_last_y3;
        complete = false;
        faults |= 0x00000004u;
    }
    const float y4 = in->y4;
    float y4_held = y4;
    if ((0.0124f <= y4) && (y4 <= 0.0366f)) {
        state->guard_last_y4 = y4;
    } else {
        y4_held = state->guard_last_y4;
        complete = false;
        faults |= 0x00000008u;
    }
    const float x = in->x;
    float x_held = x;
    if (fabsf(x) <= 0.1f) {
        state->guard_last_x = x;
    } else {
        x_held = state->guard_last_x;
        complete = false;
        faults |= 0x00000010u;
    }
    const float z = in->z;
    float z_held = z;
    if (fabsf(z) <= 0.1f) {
        state->guard_last_z = z;
    } else {
        z_held = state->guard_last_z;
        complete = false;
        faults |= 0x00000020u;
    }
    const float y_ref = in->y_ref;
    float y_ref_held = y_ref;
    if ((0.018f <= y_ref) && (y_ref <= 0.031f)) {
        state->guard_last_y_ref = y_ref;
    } else {
        y_ref_held = state->guard_last_y_ref;
        faults |= 0x00000040u;
    }
    const float x_ref = in->x_ref;
    float x_ref_held = x_ref;
    if (fabsf(x_ref) <= 0.05f) {
        state->guard_last_x_ref = x_ref;
    } else {
        x_ref_held = state->guard_last_x_ref;
        faults |= 0x00000080u;
    }
    const float z_ref = in->z_ref;
    float z_ref_held = z_ref;
    if (fabsf(z_ref) <= 0.05f) {
        state->guard_last_z_ref = z_ref;
    } else {
        z_ref_held = state->guard_last_z_ref;
        faults |= 0x00000100u;
    }
    const float phi_ref = in->phi_ref;
    float phi_ref_held = phi_ref;
    if (fabsf(phi_ref) <= 0.003f) {
        state->guard_last_phi_ref = phi_ref;
    } else {
        phi_ref_held = state->guard_last_phi_ref;
        faults |= 0x00000200u;
    }
    const float theta_ref = in->theta_ref;
    float theta_ref_held = theta_ref;
    if (fabsf(theta_ref) <= 0.014f) {
        state->guard_last_theta_ref = theta_ref;
    } else {
        theta_ref_held = state->guard_last_theta_ref;
        faults |= 0x00000400u;
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
    const float safe_output_last_i_d1 = state->safe_output_last_i_d1;
    const float safe_output_last_i_d2 = state->safe_output_last_i_d2;
    const float safe_output_last_i_d3 = state->safe_output_last_i_d3;
    const float safe_output_last_i_d4 = state->safe_output_last_i_d4;
    const float safe_output_last_u_x = state->safe_output_last_u_x;
    const float safe_output_last_u_z = state->safe_output_last_u_z;
    if (latched != 0u) {
        const float t1 = max(min(2.5f, safe_output_last_i_d1 + 0.1f), safe_output_last_i_d1 - 0.1f);
        state->safe_output_last_i_d1 = t1;
        out->i_d1 = t1;
        const float t2 = max(min(2.5f, safe_output_last_i_d2 + 0.1f), safe_output_last_i_d2 - 0.1f);
        state->safe_output_last_i_d2 = t2;
        out->i_d2 = t2;
        const float t3 = max(min(2.5f, safe_output_last_i_d3 + 0.1f), safe_output_last_i_d3 - 0.1f);
        state->safe_output_last_i_d3 = t3;
        out->i_d3 = t3;
        const float t4 = max(min(2.5f, safe_output_last_i_d4 + 0.1f), safe_output_last_i_d4 - 0.1f);
        state->safe_output_last_i_d4 = t4;
        out->i_d4 = t4;
        const float t5 = max(min(0.0f, safe_output_last_u_x + 0.1f), safe_output_last_u_x - 0.1f);
        state->safe_output_last_u_x = t5;
        out->i_q2 = t5;
        out->i_q4 = t5;
        const float t6 = max(min(0.0f, safe_output_last_u_z + 0.1f), safe_output_last_u_z - 0.1f);
        state->safe_output_last_u_z = t6;
        out->i_q1 = t6;
        out->i_q3 = t6;

        /* guard: range acceptance, hold, latch */
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* kinematics: pose from the gaps, F(5) */
        const float y = 0.25f * (y1_held + y2_held + y3_held + y4_held);
        const float t7 = y3_held - y1_held;
        const float phi = t7 * phi_polynomial(t7 * t7);
        const float t8 = y2_held - y4_held;
        const float theta = t8 * theta_polynomial(t8 * t8);

        /* errors: tracking errors, F(14) */
        const float e_y = y - y_ref_held;
        const float filter_y_q_prev = state->filter_y_q_prev;
        state->filter_y_q_prev = e_y;
        const float e_x = x_held - x_ref_held;
        const float filter_x_q_prev = state->filter_x_q_prev;
        state->filter_x_q_prev = e_x;
        const float e_z = z_held - z_ref_held;
        const float filter_z_q_prev = state->filter_z_q_prev;
        state->filter_z_q_prev = e_z;
        const float e_phi = phi - phi_ref_held;
        const float filter_phi_q_prev = state->filter_phi_q_prev;
        state->filter_phi_q_prev = e_phi;
        const float e_theta = theta - theta_ref_held;

        /* filter_y: derivative filter */
        const float filter_y_s = state->filter_y_s;
        const float filter_theta_q_prev = state->filter_theta_q_prev;
        float t9 = 0.0f;
        float t10 = 0.0f;
        float t11 = 0.0f;
        float t12 = 0.0f;
        float t13 = 0.0f;
        if (guard_ready != 0u) {
            t9 = e_y - filter_y_q_prev;
            t10 = e_x - filter_x_q_prev;
            t11 = e_z - filter_z_q_prev;
            t12 = e_phi - filter_phi_q_prev;
            t13 = e_theta - filter_theta_q_prev;
        }
        const float filter_y_s_next = (filter_y_fade * filter_y_s) + t9;
        state->filter_y_s = filter_y_s_next;
        const float filter_y_r = state->filter_y_r;
        const float filter_y_r_next = (filter_y_fade * filter_y_r) + filter_y_s_next + (filter_y_rho * filter_y_s);
        state->filter_y_r = filter_y_r_next;

        /* filter_x: derivative filter */
        const float filter_x_s = state->filter_x_s;
        const float filter_x_s_next = (filter_x_fade * filter_x_s) + t10;
        state->filter_x_s = filter_x_s_next;
        const float filter_x_r = state->filter_x_r;
        const float filter_x_r_next = (filter_x_fade * filter_x_r) + filter_x_s_next + (filter_x_rho * filter_x_s);
        state->filter_x_r = filter_x_r_next;

        /* filter_z: derivative filter */
        const float filter_z_s = state->filter_z_s;
        const float filter_z_s_next = (filter_z_fade * filter_z_s) + t11;
        state->filter_z_s = filter_z_s_next;
        const float filter_z_r = state->filter_z_r;
        const float filter_z_r_next = (filter_z_fade * filter_z_r) + filter_z_s_next + (filter_z_rho * filter_z_s);
        state->filter_z_r = filter_z_r_next;

        /* filter_phi: derivative filter */
        const float filter_phi_s = state->filter_phi_s;
        const float filter_phi_s_next = (filter_phi_fade * filter_phi_s) + t12;
        state->filter_phi_s = filter_phi_s_next;
        const float filter_phi_r = state->filter_phi_r;
        const float filter_phi_r_next = (filter_phi_fade * filter_phi_r) + filter_phi_s_next + (filter_phi_rho * filter_phi_s);
        state->filter_phi_r = filter_phi_r_next;
        state->filter_theta_q_prev = e_theta;

        /* filter_theta: derivative filter */
        const float filter_theta_s = state->filter_theta_s;
        const float filter_theta_s_next = (filter_theta_fade * filter_theta_s) + t13;
        state->filter_theta_s = filter_theta_s_next;
        const float filter_theta_r = state->filter_theta_r;
        const float filter_theta_r_next = (filter_theta_fade * filter_theta_r) + filter_theta_s_next + (filter_theta_rho * filter_theta_s);
        state->filter_theta_r = filter_theta_r_next;

        /* regulator_y: F(14)-(16) */
        const float regulator_y_sum = state->regulator_y_sum;
        const float t14 = (regulator_y_k_e * e_y) + (regulator_y_k_de_x_filter_y_h * filter_y_r_next) + (regulator_y_k_sum * regulator_y_sum);
        const float regulator_y_p1 = state->regulator_y_p1;
        const float regulator_y_q1 = state->regulator_y_q1;
        const float w_y = t14 + (regulator_y_k_p1 * regulator_y_p1) + (regulator_y_k_q1 * regulator_y_q1);
        const float regulator_y_sum_next = regulator_y_sum + e_y;
        if (fabsf(regulator_y_sum_next) <= 600.0f) {
            state->regulator_y_sum = regulator_y_sum_next;
        }
        const float regulator_y_p1_next = regulator_y_p1 + (regulator_y_c1 * regulator_y_q1);
        if (fabsf(regulator_y_p1_next) <= 3.0f) {
            state->regulator_y_p1 = regulator_y_p1_next;
        }
        const float regulator_y_q1_next = regulator_y_q1 - regulator_y_p1_next + e_y;
        if (fabsf(regulator_y_q1_next) <= 600.0f) {
            state->regulator_y_q1 = regulator_y_q1_next;
        }

        /* regulator_x: F(14)-(17) */
        const float regulator_x_sum = state->regulator_x_sum;
        const float t15 = (regulator_x_k_e * e_x) + (regulator_x_k_de_x_filter_x_h * filter_x_r_next) + (regulator_x_k_sum * regulator_x_sum);
        const float regulator_x_p1 = state->regulator_x_p1;
        const float regulator_x_q1 = state->regulator_x_q1;
        const float w_x = t15 + (regulator_x_k_p1 * regulator_x_p1) + (regulator_x_k_q1 * regulator_x_q1);

        /* regulator_z: F(14)-(17) */
        const float regulator_z_sum = state->regulator_z_sum;
        const float t16 = (regulator_z_k_e * e_z) + (regulator_z_k_de_x_filter_z_h * filter_z_r_next) + (regulator_z_k_sum * regulator_z_sum);
        const float regulator_z_p1 = state->regulator_z_p1;
        const float regulator_z_q1 = state->regulator_z_q1;
        const float w_z = t16 + (regulator_z_k_p1 * regulator_z_p1) + (regulator_z_k_q1 * regulator_z_q1);

        /* regulator_phi: F(14)-(16) */
        const float regulator_phi_sum = state->regulator_phi_sum;
        const float t17 = (regulator_phi_k_e * e_phi) + (regulator_phi_k_de_x_filter_phi_h * filter_phi_r_next) + (regulator_phi_k_sum * regulator_phi_sum);
        const float regulator_phi_p1 = state->regulator_phi_p1;
        const float regulator_phi_q1 = state->regulator_phi_q1;
        const float w_phi = t17 + (regulator_phi_k_p1 * regulator_phi_p1) + (regulator_phi_k_q1 * regulator_phi_q1);
        const float regulator_phi_sum_next = regulator_phi_sum + e_phi;
        if (fabsf(regulator_phi_sum_next) <= 600.0f) {
            state->regulator_phi_sum = regulator_phi_sum_next;
        }
        const float regulator_phi_p1_next = regulator_phi_p1 + (regulator_phi_c1 * regulator_phi_q1);
        if (fabsf(regulator_phi_p1_next) <= 3.0f) {
            state->regulator_phi_p1 = regulator_phi_p1_next;
        }
        const float regulator_phi_q1_next = regulator_phi_q1 - regulator_phi_p1_next + e_phi;
        if (fabsf(regulator_phi_q1_next) <= 600.0f) {
            state->regulator_phi_q1 = regulator_phi_q1_next;
        }

        /* regulator_theta: F(14)-(16) */
        const float regulator_theta_sum = state->regulator_theta_sum;
        const float t18 = (regulator_theta_k_e * e_theta) + (regulator_theta_k_de_x_filter_theta_h * filter_theta_r_next) + (regulator_theta_k_sum * regulator_theta_sum);
        const float regulator_theta_p1 = state->regulator_theta_p1;
        const float regulator_theta_q1 = state->regulator_theta_q1;
        const float w_theta = t18 + (regulator_theta_k_p1 * regulator_theta_p1) + (regulator_theta_k_q1 * regulator_theta_q1);
        const float regulator_theta_sum_next = regulator_theta_sum + e_theta;
        if (fabsf(regulator_theta_sum_next) <= 600.0f) {
            state->regulator_theta_sum = regulator_theta_sum_next;
        }
        const float regulator_theta_p1_next = regulator_theta_p1 + (regulator_theta_c1 * regulator_theta_q1);
        if (fabsf(regulator_theta_p1_next) <= 3.0f) {
            state->regulator_theta_p1 = regulator_theta_p1_next;
        }
        const float regulator_theta_q1_next = regulator_theta_q1 - regulator_theta_p1_next + e_theta;
        if (fabsf(regulator_theta_q1_next) <= 600.0f) {
            state->regulator_theta_q1 = regulator_theta_q1_next;
        }

        /* decoupling: direct and thrust currents, F(8), F(12) */
        const float t19 = 1.530832e-06f / (y1_held + 0.009233333f);
        const float t20 = t19 - 4.196167e-05f;
        const float thrust_per_ampere_1 = thrust_per_ampere_1_polynomial(t20);
        const float half_a_over_h2_1 = half_a_over_h2_1_polynomial(t20);
        const float t21 = thrust_per_ampere_1 * thrust_per_ampere_1;
        const float half_a_1 = t21 * half_a_over_h2_1;
        const float half_c_1 = t21 * (0.0007232277f + t19);
        const float t22 = safe_output_last_u_z * safe_output_last_u_z;
        const float half_load_1 = half_a_1 + (half_c_1 * (t22 + (safe_output_last_i_d1 * safe_output_last_i_d1)));
        const float inverse_b_1 = 1.0f / sqrtf(t21 + (16.0f * (half_a_1 * half_c_1)));
        const float t23 = 1.530832e-06f / (y2_held + 0.009233333f);
        const float t24 = 16384.0f * (t23 - 3.4332275e-05f);
        const float thrust_per_ampere_2 = thrust_per_ampere_2_polynomial(t24);
        const float half_a_over_h2_2 = half_a_over_h2_2_polynomial(t24);
        const float t25 = thrust_per_ampere_2 * thrust_per_ampere_2;
        const float half_a_2 = t25 * half_a_over_h2_2;
        const float half_c_2 = t25 * (0.0007232277f + t23);
        const float t26 = safe_output_last_u_x * safe_output_last_u_x;
        const float half_load_2 = half_a_2 + (half_c_2 * (t26 + (safe_output_last_i_d2 * safe_output_last_i_d2)));
        const float inverse_b_2 = 1.0f / sqrtf(t25 + (16.0f * (half_a_2 * half_c_2)));
        const float t27 = 1.530832e-06f / (y3_held + 0.009233333f);
        const float t28 = t27 - 4.196167e-05f;
        const float thrust_per_ampere_3 = thrust_per_ampere_1_polynomial(t28);
        const float half_a_over_h2_3 = half_a_over_h2_1_polynomial(t28);
        const float t29 = thrust_per_ampere_3 * thrust_per_ampere_3;
        const float half_a_3 = t29 * half_a_over_h2_3;
        const float half_c_3 = t29 * (0.0007232277f + t27);
        const float half_load_3 = half_a_3 + (half_c_3 * (t22 + (safe_output_last_i_d3 * safe_output_last_i_d3)));
        const float inverse_b_3 = 1.0f / sqrtf(t29 + (16.0f * (half_a_3 * half_c_3)));
        const float t30 = 1.530832e-06f / (y4_held + 0.009233333f);
        const float t31 = 16384.0f * (t30 - 3.4332275e-05f);
        const float thrust_per_ampere_4 = thrust_per_ampere_2_polynomial(t31);
        const float half_a_over_h2_4 = half_a_over_h2_2_polynomial(t31);
        const float t32 = thrust_per_ampere_4 * thrust_per_ampere_4;
        const float half_a_4 = t32 * half_a_over_h2_4;
        const float half_c_4 = t32 * (0.0007232277f + t30);
        const float half_load_4 = half_a_4 + (half_c_4 * (t26 + (safe_output_last_i_d4 * safe_output_last_i_d4)));
        const float inverse_b_4 = 1.0f / sqrtf(t32 + (16.0f * (half_a_4 * half_c_4)));
        const float u_x_demand = -10.6f * w_x / (thrust_per_ampere_2 + thrust_per_ampere_4);
        const float u_z_demand = -8.6f * w_z / (thrust_per_ampere_1 + thrust_per_ampere_3);
        const float t33 = inverse_b_2 + inverse_b_4;
        const float t34 = (3.45f * (w_y - 9.81f)) + (half_load_1 + half_load_2 + half_load_3 + half_load_4);
        const float t35 = (0.66347605f * (w_theta + (2850.0f * theta))) + (half_load_2 - half_load_4);
        const float t36 = (0.66347605f * (w_phi + (11250.0f * phi))) + (half_load_3 - half_load_1);
        const float t37 = ((t33 * t34) + ((inverse_b_2 - inverse_b_4) * t35) - ((inverse_b_3 - inverse_b_1) * t36)) / (inverse_b_1 + inverse_b_3 + t33);
        const float i_d1_computed = limit((t37 - t36) * inverse_b_1, 4.9492526f);
        state->safe_output_last_i_d1 = i_d1_computed;
        out->i_d1 = i_d1_computed;
        const float t38 = t34 - t37;
        const float i_d2_computed = limit((t38 + t35) * inverse_b_2, 4.9492526f);
        state->safe_output_last_i_d2 = i_d2_computed;
        out->i_d2 = i_d2_computed;
        const float i_d3_computed = limit((t37 + t36) * inverse_b_3, 4.9492526f);
        state->safe_output_last_i_d3 = i_d3_computed;
        out->i_d3 = i_d3_computed;
        const float i_d4_computed = limit((t38 - t35) * inverse_b_4, 4.9492526f);
        state->safe_output_last_i_d4 = i_d4_computed;
        out->i_d4 = i_d4_computed;
        const float u_x_computed = limit(u_x_demand, sqrtf(24.5f - max(i_d2_computed * i_d2_computed, i_d4_computed * i_d4_computed)));
        state->safe_output_last_u_x = u_x_computed;
        out->i_q2 = u_x_computed;
        out->i_q4 = u_x_computed;
        const float u_z_computed = limit(u_z_demand, sqrtf(24.5f - max(i_d1_computed * i_d1_computed, i_d3_computed * i_d3_computed)));
        state->safe_output_last_u_z = u_z_computed;
        out->i_q1 = u_z_computed;
        out->i_q3 = u_z_computed;
        const float excess_x = u_x_computed - u_x_demand;

        /* regulator_x: F(14)-(17) */
        const float regulator_x_sum_next = regulator_x_sum + e_x + (regulator_x_sum_excess * excess_x);
        if (fabsf(regulator_x_sum_next) <= 600.0f) {
            state->regulator_x_sum = regulator_x_sum_next;
        }
        const float regulator_x_p1_next = regulator_x_p1 + (regulator_x_c1 * regulator_x_q1) + (regulator_x_p1_excess * excess_x);
        if (fabsf(regulator_x_p1_next) <= 3.0f) {
            state->regulator_x_p1 = regulator_x_p1_next;
        }
        const float regulator_x_q1_next = regulator_x_q1 - regulator_x_p1_next + e_x + (regulator_x_q1_excess * excess_x);
        if (fabsf(regulator_x_q1_next) <= 600.0f) {
            state->regulator_x_q1 = regulator_x_q1_next;
        }

        /* decoupling: direct and thrust currents, F(8), F(12) */
        const float excess_z = u_z_computed - u_z_demand;

        /* regulator_z: F(14)-(17) */
        const float regulator_z_sum_next = regulator_z_sum + e_z + (regulator_z_sum_excess * excess_z);
        if (fabsf(regulator_z_sum_next) <= 600.0f) {
            state->regulator_z_sum = regulator_z_sum_next;
        }
        const float regulator_z_p1_next = regulator_z_p1 + (regulator_z_c1 * regulator_z_q1) + (regulator_z_p1_excess * excess_z);
        if (fabsf(regulator_z_p1_next) <= 3.0f) {
            state->regulator_z_p1 = regulator_z_p1_next;
        }
        const float regulator_z_q1_next = regulator_z_q1 - regulator_z_p1_next + e_z + (regulator_z_q1_excess * excess_z);
        if (fabsf(regulator_z_q1_next) <= 600.0f) {
            state->regulator_z_q1 = regulator_z_q1_next;
        }
    }

    return faults;
}
