/* maglev_5dof. Generated: do not edit. */
#include "maglev_5dof.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#if defined(MAGLEV_5DOF_DIAGNOSTICS)
#include <stddef.h>
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float maglev_5dof_max(float a, float b)
{
    return (a > b) ? a : b;
}

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float maglev_5dof_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline float maglev_5dof_slew(float last, float target, float step)
{
    const float highest = last + step;
    const float lowest = last - step;
    const float below = (target < highest) ? target : highest;
    return (below > lowest) ? below : lowest;
}

#if defined(__GNUC__)
#define MAGLEV_5DOF_INLINE static inline __attribute__((always_inline))
#else
#define MAGLEV_5DOF_INLINE static inline
#endif
/* Return a value in low .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
MAGLEV_5DOF_INLINE float maglev_5dof_hold(float value, float low, float high, float *last, uint32_t bit,
    uint32_t *faults)
{
    float held = value;
    if ((low <= value) && (value <= high)) {
        *last = value;
    } else {
        held = *last;
        *faults |= bit;
    }
    return held;
}

/* Return a value in -high .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
MAGLEV_5DOF_INLINE float maglev_5dof_hold_within(float value, float high, float *last, uint32_t bit, uint32_t *faults)
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

/* phi / x; x = y3_held - y1_held in -0.0154000018 .. 0.0154000018, t = x^2; relative error at most 1.1e-07. */
static inline float phi_polynomial(float t)
{
    return 1.2594458f + (t * 0.3330033f);
}

/* theta / x; x = y2_held - y4_held in -0.0241999999 .. 0.0241999999, t = x^2; relative error at most 1.2e-07. */
static inline float theta_polynomial(float t)
{
    return 1.2594458f + (t * 0.33307245f);
}

/* thrust_per_ampere_1; x = 1.53083199e-06 / (y1_held + 0.00923333333) in 3.69468689e-05 .. 5.88027688e-05, t = x -
 * 4.19616699e-05; relative error at most 1.7e-07. */
static inline float thrust_per_ampere_1_polynomial(float t)
{
    return 11.033894f + (t * (526422.7f + (t * (6.5208314e+08f + (t * (-7.354629e+13f + (t * (2.0442113e+18f + (t * (-4.015988e+22f + (t * 3.9883e+26f)))))))))));
}

/* half_a_over_h2_1; x = 1.53083199e-06 / (y1_held + 0.00923333333) in 3.69468689e-05 .. 5.88027688e-05, t = x -
 * 4.19616699e-05; relative error at most 2.8e-07. */
static inline float half_a_over_h2_1_polynomial(float t)
{
    return 0.082106546f + (t * (372.6345f + (t * (2.9113838e+06f + (t * (2.5398596e+10f + (t * 2.6154908e+14f)))))));
}

/* thrust_per_ampere_2; x = 1.53083199e-06 / (y2_held + 0.00923333333) in 3.33999706e-05 .. 7.07626459e-05, t = (x -
 * 3.43322754e-05) * 16384; relative error at most 2.9e-07. */
static inline float thrust_per_ampere_2_polynomial(float t)
{
    return 7.0962987f + (t * (30.470612f + (t * (12.132695f + (t * (-37.392975f + (t * (56.708466f + (t * (-57.090378f + (t * (33.817627f + (t * -9.12594f)))))))))))));
}

/* half_a_over_h2_2; x = 1.53083199e-06 / (y2_held + 0.00923333333) in 3.33999706e-05 .. 7.07626459e-05, t = (x -
 * 3.43322754e-05) * 16384; relative error at most 3.3e-07. */
static inline float half_a_over_h2_2_polynomial(float t)
{
    return 0.079422385f + (t * (0.020285927f + (t * (0.008864189f + (t * (0.0048612426f + (t * (0.001367154f + (t * 0.0020529632f)))))))));
}

/* filter_y, filter_x, filter_z, filter_phi, filter_theta: derivative filter
 *     s_next = fade * s + (e_y - q_prev if guard_ready is set, else 0)
 *     r_next = fade * r + s_next + rho * s */
MAGLEV_5DOF_INLINE float maglev_5dof_filter(maglev_5dof_filter_state_t *state, uint32_t ready, float e)
{
    static const float fade = 0.36787945f; /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
    static const float rho = 0.5121659f; /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */

    const float q_prev = state->q_prev;
    state->q_prev = e;
    const float s = state->s;
    float d = 0.0f;
    if (ready != 0u) {
        d = e - q_prev;
    }
    const float s_next = (fade * s) + d;
    state->s = s_next;
    state->r = (fade * state->r) + s_next + (rho * s);
    return state->r;
}

typedef struct {
    float k_e;                          /* 1/s^2; F(14)-(16): gain on e */
    float k_de_times_filter_h;          /* 1/s^2; F(14)-(16): gain on de; times filter_y_h */
    float k_sum;                        /* 1/s^2; F(14)-(16): gain on sum */
    float k_p1;                         /* 1/s^2; F(14)-(16): gain on p1 */
    float k_q1;                         /* 1/s^2; F(14)-(16): gain on q1 */
} maglev_5dof_regulator_parameters_t;

/* regulator_y, regulator_phi, regulator_theta: F(14)-(16)
 *     w_y = k_e * e_y + k_de * de_y + k_sum * sum + k_p1 * p1 + k_q1 * q1
 *     sum_next = sum + e_y if |sum + e_y| <= 600, else sum
 *     p1_next = p1 + c1 * q1 if |p1 + c1 * q1| <= 3, else p1
 *     q1_next = q1 - (p1 + c1 * q1) + e_y if |q1 - (p1 + c1 * q1) + e_y| <= 600, else q1 */
MAGLEV_5DOF_INLINE float maglev_5dof_regulator(maglev_5dof_regulator_state_t *state,
    const maglev_5dof_regulator_parameters_t *parameters, float e, float filter_r_next)
{
    static const float c1 = 2.2206568e-05f;                     /* 1; F(14)-(16): 2 - 2 cos(w T), w T = 0.00471239 */

    const float sum = state->sum;
    const float sum_next = sum + e;
    if (fabsf(sum_next) <= 600.0f) {
        state->sum = sum_next;
    }
    const float p1 = state->p1;
    const float q1 = state->q1;
    const float p1_next = p1 + (c1 * q1);
    if (fabsf(p1_next) <= 3.0f) {
        state->p1 = p1_next;
    }
    const float q1_next = q1 - p1_next + e;
    if (fabsf(q1_next) <= 600.0f) {
        state->q1 = q1_next;
    }
    const float w_part = (parameters->k_e * e) + (parameters->k_de_times_filter_h * filter_r_next) + (parameters->k_sum * sum) + (parameters->k_p1 * p1);
    return w_part + (parameters->k_q1 * q1);
}

/* regulator_x, regulator_z: F(14)-(17)
 *     w_x = k_e * e_x + k_de * de_x + k_sum * sum + k_p1 * p1 + k_q1 * q1
 *     sum_next = sum + e_x + sum_excess * excess_x if |sum + e_x + sum_excess * excess_x| <= 600, else sum
 *     p1_next = p1 + c1 * q1 + p1_excess * excess_x if |p1 + c1 * q1 + p1_excess * excess_x| <= 3, else p1
 *     q1_next = q1 - (p1 + c1 * q1 + p1_excess * excess_x) + e_x + q1_excess * excess_x if |q1 - (p1 + c1
 *         * q1 + p1_excess * excess_x) + e_x + q1_excess * excess_x| <= 600, else q1 */
MAGLEV_5DOF_INLINE float maglev_5dof_regulator_output(const maglev_5dof_regulator_state_t *state, float e,
    float filter_r_next)
{
    static const float k_e = -525.33453f;                       /* 1/s^2; F(14)-(17): gain on e */
    static const float k_de_times_filter_h = -13345.273f;       /* 1/s^2; F(14)-(17): gain on de; times filter_x_h */
    static const float k_sum = -0.9552653f;                     /* 1/s^2; F(14)-(17): gain on sum */
    static const float k_p1 = -56.45106f;                       /* 1/s^2; F(14)-(17): gain on p1 */
    static const float k_q1 = -1.7875412f;                      /* 1/s^2; F(14)-(17): gain on q1 */

    return (k_e * e) + (k_de_times_filter_h * filter_r_next) + (k_sum * state->sum) + (k_p1 * state->p1) + (k_q1 * state->q1);
}

/* regulator_x, regulator_z: F(14)-(17) */
MAGLEV_5DOF_INLINE void maglev_5dof_regulator_update(maglev_5dof_regulator_state_t *state, float e, float excess)
{
    static const float sum_excess = 0.0016244627f;              /* m/A; F(14)-(17): anti-windup into sum */
    static const float c1 = 2.2206568e-05f;                     /* 1; F(14)-(17): 2 - 2 cos(w T), w T = 0.00471239 */
    static const float p1_excess = 1.5544656e-06f;              /* m/A; F(14)-(17): anti-windup into p1 */
    static const float q1_excess = 7.0777234e-05f;              /* m/A; F(14)-(17): anti-windup into q1 */

    const float sum_next = state->sum + e + (sum_excess * excess);
    if (fabsf(sum_next) <= 600.0f) {
        state->sum = sum_next;
    }
    const float q1 = state->q1;
    const float p1_next = state->p1 + (c1 * q1) + (p1_excess * excess);
    if (fabsf(p1_next) <= 3.0f) {
        state->p1 = p1_next;
    }
    const float q1_next = q1 - p1_next + e + (q1_excess * excess);
    if (fabsf(q1_next) <= 600.0f) {
        state->q1 = q1_next;
    }
}

void maglev_5dof_init(maglev_5dof_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (maglev_5dof_state_t){
        .guard_last_y1 = 0.031f,
        .guard_last_y2 = 0.031f,
        .guard_last_y3 = 0.031f,
        .guard_last_y4 = 0.031f,
        .guard_last_y_ref = 0.031f,
        .guard_left = 5u,
        .safe_output_last_i_d1 = 2.5f,
        .safe_output_last_i_d2 = 2.5f,
        .safe_output_last_i_d3 = 2.5f,
        .safe_output_last_i_d4 = 2.5f,
    };
}

#if defined(MAGLEV_5DOF_DIAGNOSTICS)
uint32_t maglev_5dof_step(maglev_5dof_state_t *state, const maglev_5dof_input_t *in, maglev_5dof_output_t *out)
{
    return maglev_5dof_step_diagnosed(state, in, out, NULL);
}

uint32_t maglev_5dof_step_diagnosed(maglev_5dof_state_t *state, const maglev_5dof_input_t *in, maglev_5dof_output_t *out,
    maglev_5dof_diagnostics_t *diagnostics)
#else
uint32_t maglev_5dof_step(maglev_5dof_state_t *state, const maglev_5dof_input_t *in, maglev_5dof_output_t *out)
#endif
{
    static const float gap_offset = 0.009233333f;               /* m; b0/2 + h_m/mu_rec - beta, beta = b0^2 / (4 t1) */
    static const float slot_pull = 1.530832e-06f;               /* m/N; half_c_over_h2 beta, beta = b0^2 / (4 t1) */
    /* 1/N; K_v3 / (2 K_h^2) of (2): half_c / h^2 without the effect of the slots */
    static const float half_c_over_h2 = 0.0007232277f;
    static const float M_x = 10.6f;                             /* kg; Table I */
    static const float M_z = 8.6f;                              /* kg; Table I */
    static const float G = 9.81f;                               /* m/s^2; standard gravity to three digits */
    static const float half_M_y = 3.45f;                        /* kg; M_y / 2, M_y = 6.9 kg */
    static const float compensated_k_s_phi = 11250.0f;          /* 1/s^2; 0.75 k_s_phi, k_s_phi = 15000 1/s^2 */
    /* kg m/rad; I_x / (2 r), r = 0.397 m, I_x = 0.5268 kg m^2/rad, also half_I_x_over_r, also half_I_z_over_r */
    static const float half_I_over_r = 0.66347605f;
    static const float compensated_k_s_theta = 2850.0f;         /* 1/s^2; 0.95 k_s_theta, k_s_theta = 3000 1/s^2 */
    static const float direct_limit = 4.9492526f; /* A; largest direct current, rms: a little below the current limit */
    static const float squared_current_limit = 24.5f;           /* A^2; square of the current limit, 7 A peak */
    static const float safe_i_d1 = 2.5f;                        /* A; safe output */
    static const float slew_i_d1 = 0.1f;                        /* A; 100 A/s times 0.001 s */
    static const maglev_5dof_regulator_parameters_t regulator_y_regulator = {-1699.6849f, -48291.37f, -2.251582f,
        122.7319f, -5.5538764f};
    static const maglev_5dof_regulator_parameters_t regulator_phi_regulator = {-2049.9666f, -55490.594f, -2.8480508f,
        86.03567f, -7.0522647f};
    static const maglev_5dof_regulator_parameters_t regulator_theta_regulator = {-2049.9666f, -55490.594f, -2.8480508f,
        86.03567f, -7.0522647f};

#if defined(MAGLEV_5DOF_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
#endif
    /* guard: range acceptance, hold, latch */
    uint32_t faults = 0u;
    const float y1_held = maglev_5dof_hold(in->y1, 0.0168f, 0.0322f, &state->guard_last_y1, 0x00000001u, &faults);
    const float y2_held = maglev_5dof_hold(in->y2, 0.0124f, 0.0366f, &state->guard_last_y2, 0x00000002u, &faults);
    const float y3_held = maglev_5dof_hold(in->y3, 0.0168f, 0.0322f, &state->guard_last_y3, 0x00000004u, &faults);
    const float y4_held = maglev_5dof_hold(in->y4, 0.0124f, 0.0366f, &state->guard_last_y4, 0x00000008u, &faults);
    const float x_held = maglev_5dof_hold_within(in->x, 0.1f, &state->guard_last_x, 0x00000010u, &faults);
    const float z_held = maglev_5dof_hold_within(in->z, 0.1f, &state->guard_last_z, 0x00000020u, &faults);
    const float y_ref_held = maglev_5dof_hold(in->y_ref, 0.018f, 0.031f, &state->guard_last_y_ref, 0x00000040u, &faults);
    const float x_ref_held = maglev_5dof_hold_within(in->x_ref, 0.05f, &state->guard_last_x_ref, 0x00000080u, &faults);
    const float z_ref_held = maglev_5dof_hold_within(in->z_ref, 0.05f, &state->guard_last_z_ref, 0x00000100u, &faults);
    const float phi_ref_held = maglev_5dof_hold_within(in->phi_ref, 0.003f, &state->guard_last_phi_ref, 0x00000200u, &faults);
    const float theta_ref_held = maglev_5dof_hold_within(in->theta_ref, 0.014f, &state->guard_last_theta_ref, 0x00000400u, &faults);
    const bool complete = (faults & 0x0000003fu) == 0u;
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
        state->safe_output_last_i_d1 = maglev_5dof_slew(safe_output_last_i_d1, safe_i_d1, slew_i_d1);
        out->i_d1 = state->safe_output_last_i_d1;
        state->safe_output_last_i_d2 = maglev_5dof_slew(safe_output_last_i_d2, safe_i_d1, slew_i_d1);
        out->i_d2 = state->safe_output_last_i_d2;
        state->safe_output_last_i_d3 = maglev_5dof_slew(safe_output_last_i_d3, safe_i_d1, slew_i_d1);
        out->i_d3 = state->safe_output_last_i_d3;
        state->safe_output_last_i_d4 = maglev_5dof_slew(safe_output_last_i_d4, safe_i_d1, slew_i_d1);
        out->i_d4 = state->safe_output_last_i_d4;
        state->safe_output_last_u_x = maglev_5dof_slew(safe_output_last_u_x, 0.0f, slew_i_d1);
        out->i_q2 = state->safe_output_last_u_x;
        out->i_q4 = state->safe_output_last_u_x;
        state->safe_output_last_u_z = maglev_5dof_slew(safe_output_last_u_z, 0.0f, slew_i_d1);
        out->i_q1 = state->safe_output_last_u_z;
        out->i_q3 = state->safe_output_last_u_z;

        /* guard: range acceptance, hold, latch */
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* kinematics: pose from the gaps, F(5)
         *     y = 0.25 * (y1_held + y2_held + y3_held + y4_held)
         *     phi = asin(1.25945 * (y3_held - y1_held)); likewise theta */
        const float y = 0.25f * (y1_held + y2_held + y3_held + y4_held);
        const float y3_minus_y1 = y3_held - y1_held;
        const float phi = y3_minus_y1 * phi_polynomial(y3_minus_y1 * y3_minus_y1);
        const float y2_minus_y4 = y2_held - y4_held;
        const float theta = y2_minus_y4 * theta_polynomial(y2_minus_y4 * y2_minus_y4);

        /* errors: tracking errors, F(14)
         *     e_y = y - y_ref_held; likewise e_x, e_z, e_phi, e_theta */
        const float e_y = y - y_ref_held;
        const float filter_y_r_next = maglev_5dof_filter(&state->filter_y, guard_ready, e_y);
        const float w_y = maglev_5dof_regulator(&state->regulator_y, &regulator_y_regulator, e_y, filter_y_r_next);
        const float e_x = x_held - x_ref_held;
        const float filter_x_r_next = maglev_5dof_filter(&state->filter_x, guard_ready, e_x);
        const float e_z = z_held - z_ref_held;
        const float filter_z_r_next = maglev_5dof_filter(&state->filter_z, guard_ready, e_z);
        const float e_phi = phi - phi_ref_held;
        const float filter_phi_r_next = maglev_5dof_filter(&state->filter_phi, guard_ready, e_phi);
        const float w_phi = maglev_5dof_regulator(&state->regulator_phi, &regulator_phi_regulator, e_phi, filter_phi_r_next);
        const float e_theta = theta - theta_ref_held;
        const float filter_theta_r_next = maglev_5dof_filter(&state->filter_theta, guard_ready, e_theta);
        const float w_theta = maglev_5dof_regulator(&state->regulator_theta, &regulator_theta_regulator, e_theta, filter_theta_r_next);
        const float w_x = maglev_5dof_regulator_output(&state->regulator_x, e_x, filter_x_r_next);
        const float w_z = maglev_5dof_regulator_output(&state->regulator_z, e_z, filter_z_r_next);

        /* decoupling: direct and thrust currents, F(8), F(12)
         *     thrust_per_ampere_1 = 35.0903 * ((1 - 0.00211667 / (y1_held + 0.00635 + 0.005)) / (0.01905 /
         *         (0.01905 - 1.27324 * (y1_held * (0.00635 / y1_held * atan(0.00635 / y1_held) - log(sqrt(1 +
         *         (0.00635 / y1_held)^2))))) * sinh(54.971 * (0.005 + y1_held)))); likewise thrust_per_ampere_2,
         *         thrust_per_ampere_3, thrust_per_ampere_4
         *     half_a_over_h2_1 = 0.0701829 * (0.01905 / (0.01905 - 1.27324 * (y1_held * (0.00635 / y1_held *
         *         atan(0.00635 / y1_held) - log(sqrt(1 + (0.00635 / y1_held)^2))))))^2 / (1 - 0.00211667 /
         *         (y1_held + 0.00635 + 0.005)); likewise half_a_over_h2_2, half_a_over_h2_3, half_a_over_h2_4
         *     half_c_1 = thrust_per_ampere_1^2 * (half_c_over_h2 + slot_pull / (y1_held + gap_offset)); likewise
         *         half_c_2, half_c_3, half_c_4
         *     half_load_1 = half_a_1 + half_c_1 * (safe_output_last_u_z^2 + safe_output_last_i_d1^2); likewise
         *         half_load_2, half_load_3, half_load_4
         *     inverse_b_1 = 1 / sqrt(thrust_per_ampere_1^2 + 16 * (half_a_1 * half_c_1)); likewise inverse_b_2,
         *         inverse_b_3, inverse_b_4
         *     half_force = half_M_y * (w_y - G) + half_load_1 + half_load_2 + half_load_3 + half_load_4
         *     half_force_phi = half_I_over_r * (w_phi + compensated_k_s_phi * phi) + half_load_3 - half_load_1;
         *         likewise half_force_theta
         *     half_force_1_3 = ((inverse_b_2 + inverse_b_4) * half_force + (inverse_b_2 - inverse_b_4) *
         *         half_force_theta - (inverse_b_3 - inverse_b_1) * half_force_phi) / (inverse_b_1 + inverse_b_3 +
         *         inverse_b_2 + inverse_b_4)
         *     u_x_computed = limit(u_x_demand, sqrt(squared_current_limit - max(i_d2_computed^2,
         *         i_d4_computed^2))); likewise u_z_computed */
        const float thrust_per_ampere_1_part = slot_pull / (y1_held + gap_offset);
        const float thrust_per_ampere_1_argument = thrust_per_ampere_1_part - 4.196167e-05f;
        const float thrust_per_ampere_1 = thrust_per_ampere_1_polynomial(thrust_per_ampere_1_argument);
        const float half_a_over_h2_1 = half_a_over_h2_1_polynomial(thrust_per_ampere_1_argument);
        const float thrust_per_ampere_1_squared = thrust_per_ampere_1 * thrust_per_ampere_1;
        const float half_a_1 = thrust_per_ampere_1_squared * half_a_over_h2_1;
        const float half_c_1 = thrust_per_ampere_1_squared * (half_c_over_h2 + thrust_per_ampere_1_part);
        const float safe_output_last_u_z_squared = safe_output_last_u_z * safe_output_last_u_z;
        const float half_load_1 = half_a_1 + (half_c_1 * (safe_output_last_u_z_squared + (safe_output_last_i_d1 * safe_output_last_i_d1)));
        const float inverse_b_1 = 1.0f / sqrtf(thrust_per_ampere_1_squared + (16.0f * (half_a_1 * half_c_1)));
        const float thrust_per_ampere_2_part = slot_pull / (y2_held + gap_offset);
        const float thrust_per_ampere_2_argument = 16384.0f * (thrust_per_ampere_2_part - 3.4332275e-05f);
        const float thrust_per_ampere_2 = thrust_per_ampere_2_polynomial(thrust_per_ampere_2_argument);
        const float half_a_over_h2_2 = half_a_over_h2_2_polynomial(thrust_per_ampere_2_argument);
        const float thrust_per_ampere_2_squared = thrust_per_ampere_2 * thrust_per_ampere_2;
        const float half_a_2 = thrust_per_ampere_2_squared * half_a_over_h2_2;
        const float half_c_2 = thrust_per_ampere_2_squared * (half_c_over_h2 + thrust_per_ampere_2_part);
        const float safe_output_last_u_x_squared = safe_output_last_u_x * safe_output_last_u_x;
        const float half_load_2 = half_a_2 + (half_c_2 * (safe_output_last_u_x_squared + (safe_output_last_i_d2 * safe_output_last_i_d2)));
        const float inverse_b_2 = 1.0f / sqrtf(thrust_per_ampere_2_squared + (16.0f * (half_a_2 * half_c_2)));
        const float thrust_per_ampere_3_part = slot_pull / (y3_held + gap_offset);
        const float thrust_per_ampere_1_argument_2 = thrust_per_ampere_3_part - 4.196167e-05f;
        const float thrust_per_ampere_3 = thrust_per_ampere_1_polynomial(thrust_per_ampere_1_argument_2);
        const float half_a_over_h2_3 = half_a_over_h2_1_polynomial(thrust_per_ampere_1_argument_2);
        const float thrust_per_ampere_3_squared = thrust_per_ampere_3 * thrust_per_ampere_3;
        const float half_a_3 = thrust_per_ampere_3_squared * half_a_over_h2_3;
        const float half_c_3 = thrust_per_ampere_3_squared * (half_c_over_h2 + thrust_per_ampere_3_part);
        const float half_load_3 = half_a_3 + (half_c_3 * (safe_output_last_u_z_squared + (safe_output_last_i_d3 * safe_output_last_i_d3)));
        const float inverse_b_3 = 1.0f / sqrtf(thrust_per_ampere_3_squared + (16.0f * (half_a_3 * half_c_3)));
        const float thrust_per_ampere_4_part = slot_pull / (y4_held + gap_offset);
        const float thrust_per_ampere_2_argument_2 = 16384.0f * (thrust_per_ampere_4_part - 3.4332275e-05f);
        const float thrust_per_ampere_4 = thrust_per_ampere_2_polynomial(thrust_per_ampere_2_argument_2);
        const float half_a_over_h2_4 = half_a_over_h2_2_polynomial(thrust_per_ampere_2_argument_2);
        const float thrust_per_ampere_4_squared = thrust_per_ampere_4 * thrust_per_ampere_4;
        const float half_a_4 = thrust_per_ampere_4_squared * half_a_over_h2_4;
        const float half_c_4 = thrust_per_ampere_4_squared * (half_c_over_h2 + thrust_per_ampere_4_part);
        const float half_load_4 = half_a_4 + (half_c_4 * (safe_output_last_u_x_squared + (safe_output_last_i_d4 * safe_output_last_i_d4)));
        const float inverse_b_4 = 1.0f / sqrtf(thrust_per_ampere_4_squared + (16.0f * (half_a_4 * half_c_4)));
        const float u_x_demand = -M_x * w_x / (thrust_per_ampere_2 + thrust_per_ampere_4);
        const float u_z_demand = -M_z * w_z / (thrust_per_ampere_1 + thrust_per_ampere_3);
        const float half_force = (half_M_y * (w_y - G)) + (half_load_1 + half_load_2 + half_load_3 + half_load_4);
        const float half_force_phi = (half_I_over_r * (w_phi + (compensated_k_s_phi * phi))) + (half_load_3 - half_load_1);
        const float half_force_theta = (half_I_over_r * (w_theta + (compensated_k_s_theta * theta))) + (half_load_2 - half_load_4);
        const float inverse_b_2_plus_inverse_b_4 = inverse_b_2 + inverse_b_4;
        const float half_force_1_3_part = (inverse_b_2_plus_inverse_b_4 * half_force) + ((inverse_b_2 - inverse_b_4) * half_force_theta) - ((inverse_b_3 - inverse_b_1) * half_force_phi);
        const float half_force_1_3 = half_force_1_3_part / (inverse_b_1 + inverse_b_3 + inverse_b_2_plus_inverse_b_4);
        const float half_force_2_4 = half_force - half_force_1_3;
        const float i_d1_computed = maglev_5dof_limit((half_force_1_3 - half_force_phi) * inverse_b_1, direct_limit);
        out->i_d1 = i_d1_computed;
        const float i_d2_computed = maglev_5dof_limit((half_force_2_4 + half_force_theta) * inverse_b_2, direct_limit);
        out->i_d2 = i_d2_computed;
        const float i_d3_computed = maglev_5dof_limit((half_force_1_3 + half_force_phi) * inverse_b_3, direct_limit);
        out->i_d3 = i_d3_computed;
        const float i_d4_computed = maglev_5dof_limit((half_force_2_4 - half_force_theta) * inverse_b_4, direct_limit);
        out->i_d4 = i_d4_computed;
        const float room_u_x_computed = sqrtf(squared_current_limit - maglev_5dof_max(i_d2_computed * i_d2_computed, i_d4_computed * i_d4_computed));
        const float u_x_computed = maglev_5dof_limit(u_x_demand, room_u_x_computed);
        out->i_q2 = u_x_computed;
        out->i_q4 = u_x_computed;
        const float room_u_z_computed = sqrtf(squared_current_limit - maglev_5dof_max(i_d1_computed * i_d1_computed, i_d3_computed * i_d3_computed));
        const float u_z_computed = maglev_5dof_limit(u_z_demand, room_u_z_computed);
        out->i_q1 = u_z_computed;
        out->i_q3 = u_z_computed;
        const float excess_x = u_x_computed - u_x_demand;
        maglev_5dof_regulator_update(&state->regulator_x, e_x, excess_x);
        const float excess_z = u_z_computed - u_z_demand;
        state->safe_output_last_i_d1 = i_d1_computed;
        state->safe_output_last_i_d2 = i_d2_computed;
        state->safe_output_last_i_d3 = i_d3_computed;
        state->safe_output_last_i_d4 = i_d4_computed;
        state->safe_output_last_u_x = u_x_computed;
        state->safe_output_last_u_z = u_z_computed;
        maglev_5dof_regulator_update(&state->regulator_z, e_z, excess_z);
#if defined(MAGLEV_5DOF_DIAGNOSTICS)
        if (diagnostics != NULL) {
            diagnostics->y = y;
            diagnostics->phi = phi;
            diagnostics->theta = theta;
            diagnostics->e_y = e_y;
            diagnostics->e_x = e_x;
            diagnostics->e_z = e_z;
            diagnostics->e_phi = e_phi;
            diagnostics->e_theta = e_theta;
            diagnostics->w_y = w_y;
            diagnostics->w_x = w_x;
            diagnostics->w_z = w_z;
            diagnostics->w_phi = w_phi;
            diagnostics->w_theta = w_theta;
            diagnostics->excess_x = excess_x;
            diagnostics->excess_z = excess_z;
            diagnostics->saturated |= (fabsf(i_d1_computed) >= direct_limit) ? 0x00000001u : 0u;
            diagnostics->saturated |= (fabsf(i_d2_computed) >= direct_limit) ? 0x00000002u : 0u;
            diagnostics->saturated |= (fabsf(i_d3_computed) >= direct_limit) ? 0x00000004u : 0u;
            diagnostics->saturated |= (fabsf(i_d4_computed) >= direct_limit) ? 0x00000008u : 0u;
            diagnostics->saturated |= (fabsf(u_x_computed) >= room_u_x_computed) ? 0x00000010u : 0u;
            diagnostics->saturated |= (fabsf(u_z_computed) >= room_u_z_computed) ? 0x00000020u : 0u;
        }
#endif
    }

#if defined(MAGLEV_5DOF_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->faults = faults;
        if ((diagnostics->latch_cause == 0u) && ((faults & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = faults;
        }
    }
#endif
    return faults;
}
