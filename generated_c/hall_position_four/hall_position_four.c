/* hall_position_four. Generated: do not edit. */
#include "hall_position_four.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#if defined(HALL_POSITION_FOUR_DIAGNOSTICS)
#include <stddef.h>
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float hall_position_four_min(float a, float b)
{
    return (a < b) ? a : b;
}

static inline float hall_position_four_max(float a, float b)
{
    return (a > b) ? a : b;
}

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float hall_position_four_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline uint32_t hall_position_four_flag(bool holds)
{
    uint32_t value = 0u;
    if (holds) {
        value = 1u;
    }
    return value;
}

static inline bool hall_position_four_equal(float a, float b)
{
    return (a <= b) && (b <= a);
}

/* f1_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x^2; relative error at most 6e-08. */
static inline float f1_polynomial(float t)
{
    return 1.0f + (t * (-0.49999884f + (t * 0.04158157f)));
}

/* f2_polynomial / x; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x^2; relative error at most 1.2e-07. */
static inline float f2_polynomial(float t)
{
    return 1.0f + (t * (-0.1666665f + (t * 0.008320974f)));
}

/* f3_polynomial / x; x = clamp(((clamp((...), -3.14159265, 3.14159265) + (0.289026524 * (...))) + (0.452389342 *
 * sin((...)))), -3.67842824, 3.67842824) in -2.95293951 .. 3.5246768, t = x^2; relative error at most 1.2e-07. */
static inline float f3_polynomial(float t)
{
    return 0.25f + (t * (-0.0026041628f + (t * (8.1361795e-06f + (t * -1.1858457e-08f)))));
}

/* ax_part_cosine; x = clamp(((clamp((...), -3.14159265, 3.14159265) + (0.289026524 * (...))) + (0.452389342 *
 * sin((...)))), -3.67842824, 3.67842824) in -2.95293951 .. 3.5246768, t = x^2; relative error at most 2e-07. */
static inline float ax_part_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.031249814f + (t * (0.00016268597f + (t * -3.296361e-07f)))));
}

/* f5_polynomial / x; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (0.452389342 * (...))) + (0.289026524 *
 * sin((...)))), -3.67842824, 3.67842824) in -3.65407467 .. 2.7591815, t = x^2; relative error at most 1.2e-07. */
static inline float f5_polynomial(float t)
{
    return 0.25f + (t * (-0.0026041619f + (t * (8.135896e-06f + (t * -1.1839816e-08f)))));
}

/* ay_part_cosine; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (0.452389342 * (...))) + (0.289026524 *
 * sin((...)))), -3.67842824, 3.67842824) in -3.65407467 .. 2.7591815, t = x^2; relative error at most 2.3e-07. */
static inline float ay_part_cosine_polynomial(float t)
{
    return 0.9999999f + (t * (-0.031249747f + (t * (0.00016267128f + (t * -3.2880223e-07f)))));
}

/* f7_polynomial / x; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (1.11840698 * (...))) + (1.74044233 *
 * sin((...)))), -5.21040238, 5.21040238) in -4.62185955 .. 2.40948486, t = x^2; relative error at most 1.2e-07. */
static inline float f7_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552078f + (t * (2.5430117e-07f + (t * -9.3721475e-11f)))));
}

/* bx_part_cosine; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (1.11840698 * (...))) + (1.74044233 *
 * sin((...)))), -5.21040238, 5.21040238) in -4.62185955 .. 2.40948486, t = x^2; relative error at most 6.1e-08. */
static inline float bx_part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.007812497f + (t * (1.0171755e-05f + (t * -5.2370166e-09f)))));
}

/* f9_polynomial / x; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (1.74044233 * (...))) - (1.11840698 *
 * sin((...)))), -5.21040238, 5.21040238) in -5.11456728 .. 1.67171443, t = x^2; relative error at most 1.2e-07. */
static inline float f9_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552076f + (t * (2.5429642e-07f + (t * -9.355345e-11f)))));
}

/* by_part_cosine; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (1.74044233 * (...))) - (1.11840698 *
 * sin((...)))), -5.21040238, 5.21040238) in -5.11456728 .. 1.67171443, t = x^2; relative error at most 7e-08. */
static inline float by_part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.007812495f + (t * (1.017137e-05f + (t * -5.223309e-09f)))));
}

/* f11_polynomial / x; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (2.50699094 * (...))) + (3.00336258 *
 * sin((...)))), -7.05377751, 7.05377751) in -6.27302074 .. 1.31382179, t = x^2; relative error at most 1.2e-07. */
static inline float f11_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552058f + (t * (2.5427622e-07f + (t * -9.3037696e-11f)))));
}

/* cx_part_cosine; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (2.50699094 * (...))) + (3.00336258 *
 * sin((...)))), -7.05377751, 7.05377751) in -6.27302074 .. 1.31382179, t = x^2; relative error at most 1.2e-07. */
static inline float cx_part_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.00781247f + (t * (1.0169286e-05f + (t * -5.1766627e-09f)))));
}

/* f13_polynomial / x; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (3.00336258 * (...))) - (2.50699094 *
 * sin((...)))), -7.05377751, 7.05377751) in -6.66619205 .. 0.72509557, t = x^2; relative error at most 1.2e-07. */
static inline float f13_polynomial(float t)
{
    return 0.125f + (t * (-0.0003255205f + (t * (2.5426758e-07f + (t * -9.285783e-11f)))));
}

/* cy_part_cosine; x = clamp(((clamp((...), -3.14159265, 3.14159265) - (3.00336258 * (...))) - (2.50699094 *
 * sin((...)))), -7.05377751, 7.05377751) in -6.66619205 .. 0.72509557, t = x^2; relative error at most 1.5e-07. */
static inline float cy_part_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124637f + (t * (1.0168685e-05f + (t * -5.164675e-09f)))));
}

/* f15_polynomial / x; x = clamp(((clamp((...), -3.14159265, 3.14159265) + (1.62734499 * (...))) - (0.766548607 *
 * sin((...)))), -4.94043909, 4.94043909) in -1.70918477 .. 4.92831421, t = x^2; relative error at most 1.2e-07. */
static inline float f15_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552078f + (t * (2.5430032e-07f + (t * -9.367218e-11f)))));
}

/* dx_part_cosine; x = clamp(((clamp((...), -3.14159265, 3.14159265) + (1.62734499 * (...))) - (0.766548607 *
 * sin((...)))), -4.94043909, 4.94043909) in -1.70918477 .. 4.92831421, t = x^2; relative error at most 6.4e-08. */
static inline float dx_part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.007812496f + (t * (1.01715195e-05f + (t * -5.2283817e-09f)))));
}

/* f17_polynomial / x; x = clamp(((clamp((...), -3.14159265, 3.14159265) + (0.766548607 * (...))) + (1.62734499 *
 * sin((...)))), -4.94043909, 4.94043909) in -2.73013973 .. 4.24648666, t = x^2; relative error at most 2.4e-07. */
static inline float f17_polynomial(float t)
{
    return 0.124999985f + (t * (-0.00032550405f + (t * 2.51782e-07f)));
}

/* dy_part_cosine; x = clamp(((clamp((...), -3.14159265, 3.14159265) + (0.766548607 * (...))) + (1.62734499 *
 * sin((...)))), -4.94043909, 4.94043909) in -2.73013973 .. 4.24648666, t = x^2; relative error at most 6e-08. */
static inline float dy_part_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.007812498f + (t * (1.0171948e-05f + (t * -5.245477e-09f)))));
}

/* f19_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x - 0.03125; relative error at most 2e-07. */
static inline float f19_polynomial(float t)
{
    return 0.44313788f + (t * (-0.30301908f + (t * (-0.22157913f + (t * (0.05038571f + (t * 0.018777754f)))))));
}

/* f20_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x + 0.1875; relative error at most 2.1e-07. */
static inline float f20_polynomial(float t)
{
    return 1.5014632f + (t * (1.4232215f + (t * (-0.75041825f + (t * (-0.24004373f + (t * 0.07220598f)))))));
}

/* f21_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x + 0.1484375; relative error at most 2.5e-07. */
static inline float f21_polynomial(float t)
{
    return 2.599569f + (t * (2.9236116f + (t * (-1.2996452f + (t * (-0.4906068f + (t * 0.12449127f)))))));
}

/* f22_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x + 0.0390625; relative error at most 9.6e-08. */
static inline float f22_polynomial(float t)
{
    return -0.7024119f + (t * (-1.6560392f + (t * (0.35120633f + (t * (0.27599978f + (t * (-0.029241713f + (t *
        -0.013556158f)))))))));
}

/* f23_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x + 0.046875; relative error at most 8.1e-08. */
static inline float f23_polynomial(float t)
{
    return 0.26751107f + (t * (0.46543553f + (t * (-0.13375567f + (t * (-0.07756794f + (t * (0.011140014f + (t *
        0.003746263f)))))))));
}

/* f24_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x - 0.03125; relative error at most 8e-08. */
static inline float f24_polynomial(float t)
{
    return -1.063481f + (t * (1.774537f + (t * (0.5317379f + (t * (-0.29574725f + (t * (-0.04420095f + (t *
        0.014582943f)))))))));
}

/* f25_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x - 0.0546875; relative error at most 7.7e-08. */
static inline float f25_polynomial(float t)
{
    return -2.3390784f + (t * (3.1359053f + (t * (1.1695355f + (t * (-0.52262634f + (t * (-0.097286716f + (t *
        0.025399074f)))))))));
}

/* f26_polynomial; x = clamp((estimator_yaw + estimator_motion_yaw), -0.20943951, 0.20943951) in -0.209439516 ..
 * 0.209439516, t = x - 0.015625; relative error at most 1.6e-07. */
static inline float f26_polynomial(float t)
{
    return 1.6151695f + (t * (-0.7918775f + (t * (-0.80759555f + (t * (0.13163106f + (t * 0.06757928f)))))));
}

/* f27_polynomial; x = clamp(((((...) + (...)) + (0.452389342 * (...))) - (((...) + (...)) + (0.452389342 * (...)))),
 * -0.553683559, 0.553683559) in -0.553683579 .. 0.553683579, t = x^2; relative error at most 6e-08. */
static inline float f27_polynomial(float t)
{
    return 1.0f + (t * (-0.49999985f + (t * (0.041663907f + (t * -0.001373954f)))));
}

/* f28_polynomial / x; x = clamp(((((...) + (...)) + (0.452389342 * (...))) - (((...) + (...)) + (0.452389342 *
 * (...)))), -0.553683559, 0.553683559) in -0.553683579 .. 0.553683579, t = x^2; relative error at most 2.8e-07. */
static inline float f28_polynomial(float t)
{
    return 0.9999998f + (t * (-0.16665617f + (t * 0.008242257f)));
}

/* f29_polynomial; x = clamp(((((...) - (...)) + (1.74044233 * (...))) - (((...) - (...)) + (1.74044233 * (...)))),
 * -0.706880973, 0.706880973) in -0.706880987 .. 0.706880987, t = x^2; relative error at most 8.1e-08. */
static inline float f29_polynomial(float t)
{
    return 1.0f + (t * (-0.49999937f + (t * (0.041659445f + (t * -0.0013647104f)))));
}

/* f30_polynomial / x; x = clamp(((((...) - (...)) + (1.74044233 * (...))) - (((...) - (...)) + (1.74044233 * (...)))),
 * -0.706880973, 0.706880973) in -0.706880987 .. 0.706880987, t = x^2; relative error at most 1.2e-07. */
static inline float f30_polynomial(float t)
{
    return 1.0f + (t * (-0.1666666f + (t * (0.008332533f + (t * -0.00019572936f)))));
}

/* f31_polynomial; x = clamp(((((...) - (...)) + (3.00336258 * (...))) - (((...) - (...)) + (3.00336258 * (...)))),
 * -0.891218485, 0.891218485) in -0.891218483 .. 0.891218483, t = x^2; relative error at most 2e-07. */
static inline float f31_polynomial(float t)
{
    return 0.9999999f + (t * (-0.4999963f + (t * (0.041645512f + (t * -0.0013484616f)))));
}

/* f32_polynomial / x; x = clamp(((((...) - (...)) + (3.00336258 * (...))) - (((...) - (...)) + (3.00336258 * (...)))),
 * -0.891218485, 0.891218485) in -0.891218483 .. 0.891218483, t = x^2; relative error at most 1.2e-07. */
static inline float f32_polynomial(float t)
{
    return 1.0f + (t * (-0.1666664f + (t * (0.00833137f + (t * -0.00019420242f)))));
}

/* f33_polynomial; x = clamp(((((...) + (...)) - (0.766548607 * (...))) - (((...) + (...)) - (0.766548607 * (...)))),
 * -0.679884644, 0.679884644) in -0.679884672 .. 0.679884672, t = x^2; relative error at most 7.6e-08. */
static inline float f33_polynomial(float t)
{
    return 1.0f + (t * (-0.49999952f + (t * (0.0416606f + (t * -0.0013666791f)))));
}

/* f34_polynomial / x; x = clamp(((((...) + (...)) - (0.766548607 * (...))) - (((...) + (...)) - (0.766548607 *
 * (...)))), -0.679884644, 0.679884644) in -0.679884672 .. 0.679884672, t = x^2; relative error at most 1.2e-07. */
static inline float f34_polynomial(float t)
{
    return 1.0f + (t * (-0.16666661f + (t * (0.00833265f + (t * -0.00019593214f)))));
}

void hall_position_four_init(hall_position_four_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (hall_position_four_state_t){
        .guard_left = 5u,
        .estimator_amplitude = 1.0f,
        .estimator_candidate_amplitude = 1.0f,
    };
}

#if defined(HALL_POSITION_FOUR_DIAGNOSTICS)
uint32_t hall_position_four_step(hall_position_four_state_t *state, const hall_position_four_input_t *in,
    hall_position_four_output_t *out)
{
    return hall_position_four_step_diagnosed(state, in, out, NULL);
}

uint32_t hall_position_four_step_diagnosed(hall_position_four_state_t *state, const hall_position_four_input_t *in,
    hall_position_four_output_t *out,
    hall_position_four_diagnostics_t *diagnostics)
#else
uint32_t hall_position_four_step(hall_position_four_state_t *state, const hall_position_four_input_t *in,
    hall_position_four_output_t *out)
#endif
{
    static const float pi = 3.1415927f;                         /* 1; pi */
    static const float two_pi = 6.2831855f;                     /* 1; 2 pi */
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_1 = 2.24906f;
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_3 = 3.60456f;
    /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_5 = -2.883648f;

#if defined(HALL_POSITION_FOUR_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
#endif
    /* guard: range acceptance, hold, latch */
    const float V_ax = in->V_ax;
    const bool good_V_ax = fabsf(V_ax) <= 5.0f;
    float V_ax_held = V_ax;
    uint32_t faults = 0u;
    if (good_V_ax) {
        state->guard_last_V_ax = V_ax;
    } else {
        V_ax_held = state->guard_last_V_ax;
        faults = 0x00000001u;
    }
    const float V_ay = in->V_ay;
    const bool good_V_ay = fabsf(V_ay) <= 5.0f;
    float V_ay_held = V_ay;
    bool complete = good_V_ax;
    if (good_V_ay) {
        state->guard_last_V_ay = V_ay;
    } else {
        V_ay_held = state->guard_last_V_ay;
        complete = false;
        faults |= 0x00000002u;
    }
    const float V_bx = in->V_bx;
    const bool good_V_bx = fabsf(V_bx) <= 5.0f;
    float V_bx_held = V_bx;
    if (good_V_bx) {
        state->guard_last_V_bx = V_bx;
    } else {
        V_bx_held = state->guard_last_V_bx;
        complete = false;
        faults |= 0x00000004u;
    }
    const float V_by = in->V_by;
    const bool good_V_by = fabsf(V_by) <= 5.0f;
    float V_by_held = V_by;
    if (good_V_by) {
        state->guard_last_V_by = V_by;
    } else {
        V_by_held = state->guard_last_V_by;
        complete = false;
        faults |= 0x00000008u;
    }
    const float V_cx = in->V_cx;
    const bool good_V_cx = fabsf(V_cx) <= 5.0f;
    float V_cx_held = V_cx;
    if (good_V_cx) {
        state->guard_last_V_cx = V_cx;
    } else {
        V_cx_held = state->guard_last_V_cx;
        complete = false;
        faults |= 0x00000010u;
    }
    const float V_cy = in->V_cy;
    const bool good_V_cy = fabsf(V_cy) <= 5.0f;
    float V_cy_held = V_cy;
    if (good_V_cy) {
        state->guard_last_V_cy = V_cy;
    } else {
        V_cy_held = state->guard_last_V_cy;
        complete = false;
        faults |= 0x00000020u;
    }
    const float V_dx = in->V_dx;
    const bool good_V_dx = fabsf(V_dx) <= 5.0f;
    float V_dx_held = V_dx;
    if (good_V_dx) {
        state->guard_last_V_dx = V_dx;
    } else {
        V_dx_held = state->guard_last_V_dx;
        complete = false;
        faults |= 0x00000040u;
    }
    const float V_dy = in->V_dy;
    const bool good_V_dy = fabsf(V_dy) <= 5.0f;
    float V_dy_held = V_dy;
    if (good_V_dy) {
        state->guard_last_V_dy = V_dy;
    } else {
        V_dy_held = state->guard_last_V_dy;
        complete = false;
        faults |= 0x00000080u;
    }
    const bool fault_V_ax = !good_V_ax;
    const bool fault_V_ay = !good_V_ay;
    const bool fault_V_bx = !good_V_bx;
    const bool fault_V_by = !good_V_by;
    const bool fault_V_cx = !good_V_cx;
    const bool fault_V_cy = !good_V_cy;
    const bool fault_V_dx = !good_V_dx;
    const bool fault_V_dy = !good_V_dy;
    const uint32_t guard_latched = state->guard_latched;
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
    if (latched != 0u) {
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    }

    /* screen: refused and repeated codes
     *     repeats_V_ax_next = (V_ax_held == last_V_ax) * min(repeats_V_ax + 1, 6); likewise repeats_V_ay_next,
     *         repeats_V_bx_next, repeats_V_by_next, repeats_V_cx_next, repeats_V_cy_next, repeats_V_dx_next,
     *         repeats_V_dy_next */
    const uint32_t screen_repeats_V_ax = state->screen_repeats_V_ax;
    const uint32_t screen_repeats_V_ax_part = screen_repeats_V_ax + 1u;
    const float count_V_ax = (hall_position_four_equal(V_ax_held, state->screen_last_V_ax) ? 1.0f : 0.0f) *
        hall_position_four_min((float)screen_repeats_V_ax_part, 6.0f);
    const uint32_t screen_repeats_V_ay = state->screen_repeats_V_ay;
    const uint32_t screen_repeats_V_ay_part = screen_repeats_V_ay + 1u;
    const float count_V_ay = (hall_position_four_equal(V_ay_held, state->screen_last_V_ay) ? 1.0f : 0.0f) *
        hall_position_four_min((float)screen_repeats_V_ay_part, 6.0f);
    const bool flags_1 = fault_V_ax || (6.0f <= count_V_ax) || fault_V_ay || (6.0f <= count_V_ay);
    const uint32_t screen_repeats_V_bx = state->screen_repeats_V_bx;
    const uint32_t screen_repeats_V_bx_part = screen_repeats_V_bx + 1u;
    const float count_V_bx = (hall_position_four_equal(V_bx_held, state->screen_last_V_bx) ? 1.0f : 0.0f) *
        hall_position_four_min((float)screen_repeats_V_bx_part, 6.0f);
    const uint32_t screen_repeats_V_by = state->screen_repeats_V_by;
    const uint32_t screen_repeats_V_by_part = screen_repeats_V_by + 1u;
    const float count_V_by = (hall_position_four_equal(V_by_held, state->screen_last_V_by) ? 1.0f : 0.0f) *
        hall_position_four_min((float)screen_repeats_V_by_part, 6.0f);
    const bool flags_2 = fault_V_bx || (6.0f <= count_V_bx) || fault_V_by || (6.0f <= count_V_by);
    const uint32_t screen_repeats_V_cx = state->screen_repeats_V_cx;
    const uint32_t screen_repeats_V_cx_part = screen_repeats_V_cx + 1u;
    const float count_V_cx = (hall_position_four_equal(V_cx_held, state->screen_last_V_cx) ? 1.0f : 0.0f) *
        hall_position_four_min((float)screen_repeats_V_cx_part, 6.0f);
    const uint32_t screen_repeats_V_cy = state->screen_repeats_V_cy;
    const uint32_t screen_repeats_V_cy_part = screen_repeats_V_cy + 1u;
    const float count_V_cy = (hall_position_four_equal(V_cy_held, state->screen_last_V_cy) ? 1.0f : 0.0f) *
        hall_position_four_min((float)screen_repeats_V_cy_part, 6.0f);
    const bool flags_3 = fault_V_cx || (6.0f <= count_V_cx) || fault_V_cy || (6.0f <= count_V_cy);
    const uint32_t screen_repeats_V_dx = state->screen_repeats_V_dx;
    const uint32_t screen_repeats_V_dx_part = screen_repeats_V_dx + 1u;
    const float count_V_dx = (hall_position_four_equal(V_dx_held, state->screen_last_V_dx) ? 1.0f : 0.0f) *
        hall_position_four_min((float)screen_repeats_V_dx_part, 6.0f);
    const uint32_t screen_repeats_V_dy = state->screen_repeats_V_dy;
    const uint32_t screen_repeats_V_dy_part = screen_repeats_V_dy + 1u;
    const float count_V_dy = (hall_position_four_equal(V_dy_held, state->screen_last_V_dy) ? 1.0f : 0.0f) *
        hall_position_four_min((float)screen_repeats_V_dy_part, 6.0f);
    const bool flags_4 = fault_V_dx || (6.0f <= count_V_dx) || fault_V_dy || (6.0f <= count_V_dy);
    const uint32_t screened_part = hall_position_four_flag(flags_1) + hall_position_four_flag(flags_2) +
        hall_position_four_flag(flags_3) + hall_position_four_flag(flags_4);
    const bool screened = screened_part <= 1u;
    const float number_rejected = (flags_1 ? 1.0f : 0.0f) + (2.0f * (flags_2 ? 1.0f : 0.0f)) + (3.0f * (flags_3 ? 1.0f :
        0.0f)) + (4.0f * (flags_4 ? 1.0f : 0.0f));
    const float rejected = hall_position_four_max(hall_position_four_min((screened ? 1.0f : 0.0f) * number_rejected,
        4.0f), 0.0f);
    state->screen_last_V_ax = V_ax_held;
    state->screen_last_V_ay = V_ay_held;
    state->screen_last_V_bx = V_bx_held;
    state->screen_last_V_by = V_by_held;
    state->screen_last_V_cx = V_cx_held;
    state->screen_last_V_cy = V_cy_held;
    state->screen_last_V_dx = V_dx_held;
    state->screen_last_V_dy = V_dy_held;
    state->screen_repeats_V_ax = (uint32_t)count_V_ax;
    state->screen_repeats_V_ay = (uint32_t)count_V_ay;
    state->screen_repeats_V_bx = (uint32_t)count_V_bx;
    state->screen_repeats_V_by = (uint32_t)count_V_by;
    state->screen_repeats_V_cx = (uint32_t)count_V_cx;
    state->screen_repeats_V_cy = (uint32_t)count_V_cy;
    state->screen_repeats_V_dx = (uint32_t)count_V_dx;
    state->screen_repeats_V_dy = (uint32_t)count_V_dy;

    /* estimator: weighted least squares
     *     age_next = (not tracking and not (converged or 3 <= age)) * min(age + 1, 3)
     *     begin_phase_x_next = (begin_phase_x + 5.14701 - two_pi if pi < begin_phase_x + 5.14701, else
     *         begin_phase_x + 5.14701) if converged or 3 <= age, else begin_phase_x
     *     begin_phase_y_next = (begin_phase_y + 4.21629 - two_pi if pi < begin_phase_y + 4.21629, else
     *         begin_phase_y + 4.21629) if converged or 3 <= age, else begin_phase_y
     *     begin_yaw_next = (begin_yaw + 0.230258 - 0.418879 if 0.20944 < begin_yaw + 0.230258, else begin_yaw
     *         + 0.230258) if converged or 3 <= age, else begin_yaw */
    const float estimator_motion_phase_x = state->estimator_motion_phase_x;
    const float ax_part_sine_part = state->estimator_phase_x + estimator_motion_phase_x;
    float ax_part_sine_part_2 = ax_part_sine_part;
    if (pi < ax_part_sine_part) {
        ax_part_sine_part_2 = ax_part_sine_part - two_pi;
    }
    float starts_1 = ax_part_sine_part_2;
    if (ax_part_sine_part_2 < -pi) {
        starts_1 = ax_part_sine_part_2 + two_pi;
    }
    const float estimator_motion_yaw = state->estimator_motion_yaw;
    const float starts_3 = hall_position_four_limit(state->estimator_yaw + estimator_motion_yaw, 0.20943952f);
    const float f1_argument = starts_3 * starts_3;
    const float D_11_ax_part_sine = f1_polynomial(f1_argument);
    const float D_21_ax_part_sine = starts_3 * f2_polynomial(f1_argument);
    const float angle_ax_part_sine = starts_1 + (0.28902653f * D_11_ax_part_sine) + (0.45238933f * D_21_ax_part_sine);
    const float f3_argument = angle_ax_part_sine * angle_ax_part_sine;
    const float f3 = angle_ax_part_sine * f3_polynomial(f3_argument);
    const float ax_part_sine = 4.0f * f3;
    const float ax_part_cosine = ax_part_cosine_polynomial(f3_argument);
    const float estimator_motion_phase_y = state->estimator_motion_phase_y;
    const float ay_part_sine_part = state->estimator_phase_y + estimator_motion_phase_y;
    float ay_part_sine_part_2 = ay_part_sine_part;
    if (pi < ay_part_sine_part) {
        ay_part_sine_part_2 = ay_part_sine_part - two_pi;
    }
    float starts_2 = ay_part_sine_part_2;
    if (ay_part_sine_part_2 < -pi) {
        starts_2 = ay_part_sine_part_2 + two_pi;
    }
    const float angle_ay_part_sine = starts_2 - (0.45238933f * D_11_ax_part_sine) + (0.28902653f * D_21_ax_part_sine);
    const float f5_argument = angle_ay_part_sine * angle_ay_part_sine;
    const float f5 = angle_ay_part_sine * f5_polynomial(f5_argument);
    const float ay_part_sine = 4.0f * f5;
    const float ay_part_cosine = ay_part_cosine_polynomial(f5_argument);
    const float angle_bx_part_sine = starts_1 - (1.118407f * D_11_ax_part_sine) + (1.7404423f * D_21_ax_part_sine);
    const float f7_argument = angle_bx_part_sine * angle_bx_part_sine;
    const float f7 = angle_bx_part_sine * f7_polynomial(f7_argument);
    const float bx_part_sine = 8.0f * f7;
    const float bx_part_cosine = bx_part_cosine_polynomial(f7_argument);
    const float angle_by_part_sine = starts_2 - (1.7404423f * D_11_ax_part_sine) - (1.118407f * D_21_ax_part_sine);
    const float f9_argument = angle_by_part_sine * angle_by_part_sine;
    const float f9 = angle_by_part_sine * f9_polynomial(f9_argument);
    const float by_part_sine = 8.0f * f9;
    const float by_part_cosine = by_part_cosine_polynomial(f9_argument);
    const float angle_cx_part_sine = starts_1 - (2.506991f * D_11_ax_part_sine) + (3.0033627f * D_21_ax_part_sine);
    const float f11_argument = angle_cx_part_sine * angle_cx_part_sine;
    const float f11 = angle_cx_part_sine * f11_polynomial(f11_argument);
    const float cx_part_sine = 8.0f * f11;
    const float cx_part_cosine = cx_part_cosine_polynomial(f11_argument);
    const float angle_cy_part_sine = starts_2 - (3.0033627f * D_11_ax_part_sine) - (2.506991f * D_21_ax_part_sine);
    const float f13_argument = angle_cy_part_sine * angle_cy_part_sine;
    const float f13 = angle_cy_part_sine * f13_polynomial(f13_argument);
    const float cy_part_sine = 8.0f * f13;
    const float cy_part_cosine = cy_part_cosine_polynomial(f13_argument);
    const float angle_dx_part_sine = starts_1 + (1.627345f * D_11_ax_part_sine) - (0.76654863f * D_21_ax_part_sine);
    const float f15_argument = angle_dx_part_sine * angle_dx_part_sine;
    const float f15 = angle_dx_part_sine * f15_polynomial(f15_argument);
    const float dx_part_sine = 8.0f * f15;
    const float dx_part_cosine = dx_part_cosine_polynomial(f15_argument);
    const float angle_dy_part_sine = starts_2 + (0.76654863f * D_11_ax_part_sine) + (1.627345f * D_21_ax_part_sine);
    const float f17_argument = angle_dy_part_sine * angle_dy_part_sine;
    const float f17 = angle_dy_part_sine * f17_polynomial(f17_argument);
    const float dy_part_sine = 8.0f * f17;
    const float dy_part_cosine = dy_part_cosine_polynomial(f17_argument);
    const float phase_x_part = hall_position_four_limit(4.0f * (f3 * ax_part_cosine), 2.0f);
    const float start_cosine_phase_x = 1.0f - (0.5f * (phase_x_part * phase_x_part));
    const float estimator_amplitude = state->estimator_amplitude;
    const float start_sine_phase_x = hall_position_four_limit(phase_x_part * (1.0f - (0.125f * (ax_part_sine *
        ax_part_sine))), 1.0f);
    const float start_sine_phase_x_squared = start_sine_phase_x * start_sine_phase_x;
    const float phase_x_part_2 = estimator_field_3 + (start_sine_phase_x_squared * estimator_field_5);
    const float phase_x_part_3 = estimator_field_1 + (start_sine_phase_x_squared * phase_x_part_2);
    const float a_1_phase_x = start_cosine_phase_x * (estimator_amplitude * (phase_x_part_3 + (start_sine_phase_x *
        ((2.0f * (phase_x_part_2 * start_sine_phase_x)) + (2.0f * (start_sine_phase_x_squared * (estimator_field_5 *
        start_sine_phase_x)))))));
    const uint32_t estimator_excluded = state->estimator_excluded;
    const float excluded = hall_position_four_max((0.0f < rejected) ? rejected : (float)estimator_excluded, 0.0f);
    const bool weights_1 = !hall_position_four_equal(excluded, 1.0f);
    const float a_4_phase_x = start_sine_phase_x * phase_x_part_3;
    const float e_1 = (D_11_ax_part_sine * V_ax_held) - (D_21_ax_part_sine * V_ay_held) - (estimator_amplitude *
        a_4_phase_x);
    const float used_1_phase_x = (weights_1 ? 1.0f : 0.0f) * e_1;
    const float f7_times_bx_part_cosine = f7 * bx_part_cosine;
    const float phase_x_part_4 = hall_position_four_limit(8.0f * (f7_times_bx_part_cosine * (1.0f - (0.03125f *
        (bx_part_sine * bx_part_sine)))), 2.0f);
    const float start_cosine_phase_x_2 = 1.0f - (0.5f * (phase_x_part_4 * phase_x_part_4));
    const float phase_x_part_5 = 8.0f * f7_times_bx_part_cosine;
    const float start_sine_phase_x_2 = hall_position_four_limit(phase_x_part_4 * (1.0f - (0.125f * (phase_x_part_5 *
        phase_x_part_5))), 1.0f);
    const float start_sine_phase_x_2_squared = start_sine_phase_x_2 * start_sine_phase_x_2;
    const float phase_x_part_6 = estimator_field_3 + (start_sine_phase_x_2_squared * estimator_field_5);
    const float phase_x_part_7 = estimator_field_1 + (start_sine_phase_x_2_squared * phase_x_part_6);
    const float a_1_phase_x_2 = start_cosine_phase_x_2 * (estimator_amplitude * (phase_x_part_7 + (start_sine_phase_x_2
        * ((2.0f * (phase_x_part_6 * start_sine_phase_x_2)) + (2.0f * (start_sine_phase_x_2_squared * (estimator_field_5
        * start_sine_phase_x_2)))))));
    const bool weights_3 = !hall_position_four_equal(excluded, 2.0f);
    const float a_4_phase_x_2 = start_sine_phase_x_2 * phase_x_part_7;
    const float e_3 = (D_11_ax_part_sine * V_bx_held) - (D_21_ax_part_sine * V_by_held) - (estimator_amplitude *
        a_4_phase_x_2);
    const float used_3_phase_x = (weights_3 ? 1.0f : 0.0f) * e_3;
    const float f11_times_cx_part_cosine = f11 * cx_part_cosine;
    const float phase_x_part_8 = hall_position_four_limit(8.0f * (f11_times_cx_part_cosine * (1.0f - (0.03125f *
        (cx_part_sine * cx_part_sine)))), 2.0f);
    const float start_cosine_phase_x_3 = 1.0f - (0.5f * (phase_x_part_8 * phase_x_part_8));
    const float phase_x_part_9 = 8.0f * f11_times_cx_part_cosine;
    const float start_sine_phase_x_3 = hall_position_four_limit(phase_x_part_8 * (1.0f - (0.125f * (phase_x_part_9 *
        phase_x_part_9))), 1.0f);
    const float start_sine_phase_x_3_squared = start_sine_phase_x_3 * start_sine_phase_x_3;
    const float phase_x_part_10 = estimator_field_3 + (start_sine_phase_x_3_squared * estimator_field_5);
    const float phase_x_part_11 = estimator_field_1 + (start_sine_phase_x_3_squared * phase_x_part_10);
    const float a_1_phase_x_3 = start_cosine_phase_x_3 * (estimator_amplitude * (phase_x_part_11 + (start_sine_phase_x_3
        * ((2.0f * (phase_x_part_10 * start_sine_phase_x_3)) + (2.0f * (start_sine_phase_x_3_squared *
        (estimator_field_5 * start_sine_phase_x_3)))))));
    const bool weights_5 = !hall_position_four_equal(excluded, 3.0f);
    const float a_4_phase_x_3 = start_sine_phase_x_3 * phase_x_part_11;
    const float e_5 = (D_11_ax_part_sine * V_cx_held) - (D_21_ax_part_sine * V_cy_held) - (estimator_amplitude *
        a_4_phase_x_3);
    const float used_5_phase_x = (weights_5 ? 1.0f : 0.0f) * e_5;
    const float f15_times_dx_part_cosine = f15 * dx_part_cosine;
    const float phase_x_part_12 = hall_position_four_limit(8.0f * (f15_times_dx_part_cosine * (1.0f - (0.03125f *
        (dx_part_sine * dx_part_sine)))), 2.0f);
    const float start_cosine_phase_x_4 = 1.0f - (0.5f * (phase_x_part_12 * phase_x_part_12));
    const float phase_x_part_13 = 8.0f * f15_times_dx_part_cosine;
    const float start_sine_phase_x_4 = hall_position_four_limit(phase_x_part_12 * (1.0f - (0.125f * (phase_x_part_13 *
        phase_x_part_13))), 1.0f);
    const float start_sine_phase_x_4_squared = start_sine_phase_x_4 * start_sine_phase_x_4;
    const float phase_x_part_14 = estimator_field_3 + (start_sine_phase_x_4_squared * estimator_field_5);
    const float phase_x_part_15 = estimator_field_1 + (start_sine_phase_x_4_squared * phase_x_part_14);
    const float a_1_phase_x_4 = start_cosine_phase_x_4 * (estimator_amplitude * (phase_x_part_15 + (start_sine_phase_x_4
        * ((2.0f * (phase_x_part_14 * start_sine_phase_x_4)) + (2.0f * (start_sine_phase_x_4_squared *
        (estimator_field_5 * start_sine_phase_x_4)))))));
    const bool weights_7 = !hall_position_four_equal(excluded, 4.0f);
    const float a_4_phase_x_4 = start_sine_phase_x_4 * phase_x_part_15;
    const float e_7 = (D_11_ax_part_sine * V_dx_held) - (D_21_ax_part_sine * V_dy_held) - (estimator_amplitude *
        a_4_phase_x_4);
    const float used_7_phase_x = (weights_7 ? 1.0f : 0.0f) * e_7;
    const float gradient_1_phase_x = (a_1_phase_x * used_1_phase_x) + (a_1_phase_x_2 * used_3_phase_x) + (a_1_phase_x_3
        * used_5_phase_x) + (a_1_phase_x_4 * used_7_phase_x);
    const float left_1_1_phase_x = ((weights_1 ? 1.0f : 0.0f) * a_1_phase_x * a_1_phase_x) + ((weights_3 ? 1.0f : 0.0f)
        * a_1_phase_x_2 * a_1_phase_x_2) + ((weights_5 ? 1.0f : 0.0f) * a_1_phase_x_3 * a_1_phase_x_3) + ((weights_7 ?
        1.0f : 0.0f) * a_1_phase_x_4 * a_1_phase_x_4);
    const float terms_1_phase_x = 1.0f / hall_position_four_max(left_1_1_phase_x, 0.048416f);
    const float f19_argument = starts_3 - 0.03125f;
    const float a_3_phase_x = (V_ax_held * D_21_ax_part_sine) + (V_ay_held * D_11_ax_part_sine) + (a_1_phase_x *
        f19_polynomial(f19_argument));
    const float used_1_3 = (weights_1 ? 1.0f : 0.0f) * a_3_phase_x;
    const float a_3_phase_x_2 = (V_bx_held * D_21_ax_part_sine) + (V_by_held * D_11_ax_part_sine) + (a_1_phase_x_2 *
        f20_polynomial(starts_3 + 0.1875f));
    const float used_3_3 = (weights_3 ? 1.0f : 0.0f) * a_3_phase_x_2;
    const float a_3_phase_x_3 = (V_cx_held * D_21_ax_part_sine) + (V_cy_held * D_11_ax_part_sine) + (a_1_phase_x_3 *
        f21_polynomial(starts_3 + 0.1484375f));
    const float used_5_3 = (weights_5 ? 1.0f : 0.0f) * a_3_phase_x_3;
    const float a_3_phase_x_4 = (V_dx_held * D_21_ax_part_sine) + (V_dy_held * D_11_ax_part_sine) + (a_1_phase_x_4 *
        f22_polynomial(starts_3 + 0.0390625f));
    const float used_7_3 = (weights_7 ? 1.0f : 0.0f) * a_3_phase_x_4;
    const float left_3_1_phase_x = (used_1_3 * a_1_phase_x) + (used_3_3 * a_1_phase_x_2) + (used_5_3 * a_1_phase_x_3) +
        (used_7_3 * a_1_phase_x_4);
    const float terms_1_phase_x_2 = hall_position_four_limit(left_3_1_phase_x * terms_1_phase_x, 1250.0f);
    const float phase_x_part_16 = hall_position_four_limit(4.0f * (f5 * ay_part_cosine), 2.0f);
    const float start_cosine_phase_x_5 = 1.0f - (0.5f * (phase_x_part_16 * phase_x_part_16));
    const float start_sine_phase_x_5 = hall_position_four_limit(phase_x_part_16 * (1.0f - (0.125f * (ay_part_sine *
        ay_part_sine))), 1.0f);
    const float start_sine_phase_x_5_squared = start_sine_phase_x_5 * start_sine_phase_x_5;
    const float phase_x_part_17 = estimator_field_3 + (start_sine_phase_x_5_squared * estimator_field_5);
    const float phase_x_part_18 = estimator_field_1 + (start_sine_phase_x_5_squared * phase_x_part_17);
    const float a_2_phase_x = start_cosine_phase_x_5 * (estimator_amplitude * (phase_x_part_18 + (start_sine_phase_x_5 *
        ((2.0f * (phase_x_part_17 * start_sine_phase_x_5)) + (2.0f * (start_sine_phase_x_5_squared * (estimator_field_5
        * start_sine_phase_x_5)))))));
    const float phase_x_part_19 = (V_ax_held * D_11_ax_part_sine) - (V_ay_held * D_21_ax_part_sine) - (a_2_phase_x *
        f23_polynomial(starts_3 + 0.046875f));
    const float a_4_phase_x_5 = start_sine_phase_x_5 * phase_x_part_18;
    const float e_2 = (D_21_ax_part_sine * V_ax_held) + (D_11_ax_part_sine * V_ay_held) - (estimator_amplitude *
        a_4_phase_x_5);
    const float used_2_phase_x = (weights_1 ? 1.0f : 0.0f) * e_2;
    const float f9_times_by_part_cosine = f9 * by_part_cosine;
    const float phase_x_part_20 = hall_position_four_limit(8.0f * (f9_times_by_part_cosine * (1.0f - (0.03125f *
        (by_part_sine * by_part_sine)))), 2.0f);
    const float start_cosine_phase_x_6 = 1.0f - (0.5f * (phase_x_part_20 * phase_x_part_20));
    const float phase_x_part_21 = 8.0f * f9_times_by_part_cosine;
    const float start_sine_phase_x_6 = hall_position_four_limit(phase_x_part_20 * (1.0f - (0.125f * (phase_x_part_21 *
        phase_x_part_21))), 1.0f);
    const float start_sine_phase_x_6_squared = start_sine_phase_x_6 * start_sine_phase_x_6;
    const float phase_x_part_22 = estimator_field_3 + (start_sine_phase_x_6_squared * estimator_field_5);
    const float phase_x_part_23 = estimator_field_1 + (start_sine_phase_x_6_squared * phase_x_part_22);
    const float a_2_phase_x_2 = start_cosine_phase_x_6 * (estimator_amplitude * (phase_x_part_23 + (start_sine_phase_x_6
        * ((2.0f * (phase_x_part_22 * start_sine_phase_x_6)) + (2.0f * (start_sine_phase_x_6_squared *
        (estimator_field_5 * start_sine_phase_x_6)))))));
    const float phase_x_part_24 = (V_bx_held * D_11_ax_part_sine) - (V_by_held * D_21_ax_part_sine) - (a_2_phase_x_2 *
        f24_polynomial(f19_argument));
    const float a_4_phase_x_6 = start_sine_phase_x_6 * phase_x_part_23;
    const float e_4 = (D_21_ax_part_sine * V_bx_held) + (D_11_ax_part_sine * V_by_held) - (estimator_amplitude *
        a_4_phase_x_6);
    const float used_4_phase_x = (weights_3 ? 1.0f : 0.0f) * e_4;
    const float f13_times_cy_part_cosine = f13 * cy_part_cosine;
    const float phase_x_part_25 = hall_position_four_limit(8.0f * (f13_times_cy_part_cosine * (1.0f - (0.03125f *
        (cy_part_sine * cy_part_sine)))), 2.0f);
    const float start_cosine_phase_x_7 = 1.0f - (0.5f * (phase_x_part_25 * phase_x_part_25));
    const float phase_x_part_26 = 8.0f * f13_times_cy_part_cosine;
    const float start_sine_phase_x_7 = hall_position_four_limit(phase_x_part_25 * (1.0f - (0.125f * (phase_x_part_26 *
        phase_x_part_26))), 1.0f);
    const float start_sine_phase_x_7_squared = start_sine_phase_x_7 * start_sine_phase_x_7;
    const float phase_x_part_27 = estimator_field_3 + (start_sine_phase_x_7_squared * estimator_field_5);
    const float phase_x_part_28 = estimator_field_1 + (start_sine_phase_x_7_squared * phase_x_part_27);
    const float a_2_phase_x_3 = start_cosine_phase_x_7 * (estimator_amplitude * (phase_x_part_28 + (start_sine_phase_x_7
        * ((2.0f * (phase_x_part_27 * start_sine_phase_x_7)) + (2.0f * (start_sine_phase_x_7_squared *
        (estimator_field_5 * start_sine_phase_x_7)))))));
    const float phase_x_part_29 = (V_cx_held * D_11_ax_part_sine) - (V_cy_held * D_21_ax_part_sine) - (a_2_phase_x_3 *
        f25_polynomial(starts_3 - 0.0546875f));
    const float a_4_phase_x_7 = start_sine_phase_x_7 * phase_x_part_28;
    const float e_6 = (D_21_ax_part_sine * V_cx_held) + (D_11_ax_part_sine * V_cy_held) - (estimator_amplitude *
        a_4_phase_x_7);
    const float used_6_phase_x = (weights_5 ? 1.0f : 0.0f) * e_6;
    const float f17_times_dy_part_cosine = f17 * dy_part_cosine;
    const float phase_x_part_30 = hall_position_four_limit(8.0f * (f17_times_dy_part_cosine * (1.0f - (0.03125f *
        (dy_part_sine * dy_part_sine)))), 2.0f);
    const float start_cosine_phase_x_8 = 1.0f - (0.5f * (phase_x_part_30 * phase_x_part_30));
    const float phase_x_part_31 = 8.0f * f17_times_dy_part_cosine;
    const float start_sine_phase_x_8 = hall_position_four_limit(phase_x_part_30 * (1.0f - (0.125f * (phase_x_part_31 *
        phase_x_part_31))), 1.0f);
    const float start_sine_phase_x_8_squared = start_sine_phase_x_8 * start_sine_phase_x_8;
    const float phase_x_part_32 = estimator_field_3 + (start_sine_phase_x_8_squared * estimator_field_5);
    const float phase_x_part_33 = estimator_field_1 + (start_sine_phase_x_8_squared * phase_x_part_32);
    const float a_2_phase_x_4 = start_cosine_phase_x_8 * (estimator_amplitude * (phase_x_part_33 + (start_sine_phase_x_8
        * ((2.0f * (phase_x_part_32 * start_sine_phase_x_8)) + (2.0f * (start_sine_phase_x_8_squared *
        (estimator_field_5 * start_sine_phase_x_8)))))));
    const float phase_x_part_34 = (V_dx_held * D_11_ax_part_sine) - (V_dy_held * D_21_ax_part_sine) - (a_2_phase_x_4 *
        f26_polynomial(starts_3 - 0.015625f));
    const float a_4_phase_x_8 = start_sine_phase_x_8 * phase_x_part_33;
    const float e_8 = (D_21_ax_part_sine * V_dx_held) + (D_11_ax_part_sine * V_dy_held) - (estimator_amplitude *
        a_4_phase_x_8);
    const float used_8_phase_x = (weights_7 ? 1.0f : 0.0f) * e_8;
    const float phase_x_part_35 = (weights_1 ? 1.0f : 0.0f) * phase_x_part_19;
    const float phase_x_part_36 = (weights_3 ? 1.0f : 0.0f) * phase_x_part_24;
    const float phase_x_part_37 = (weights_5 ? 1.0f : 0.0f) * phase_x_part_29;
    const float phase_x_part_38 = (weights_7 ? 1.0f : 0.0f) * phase_x_part_34;
    const float phase_x_part_39 = (phase_x_part_35 * a_2_phase_x) + (phase_x_part_36 * a_2_phase_x_2) + (phase_x_part_37
        * a_2_phase_x_3) + (phase_x_part_38 * a_2_phase_x_4);
    const float left_2_2_phase_x = ((weights_1 ? 1.0f : 0.0f) * a_2_phase_x * a_2_phase_x) + ((weights_3 ? 1.0f : 0.0f)
        * a_2_phase_x_2 * a_2_phase_x_2) + ((weights_5 ? 1.0f : 0.0f) * a_2_phase_x_3 * a_2_phase_x_3) + ((weights_7 ?
        1.0f : 0.0f) * a_2_phase_x_4 * a_2_phase_x_4);
    const float terms_1_phase_x_3 = 1.0f / hall_position_four_max(left_2_2_phase_x, 0.048416f);
    const float terms_1_phase_x_4 = hall_position_four_limit(-(phase_x_part_39 * terms_1_phase_x_3), 1250.0f);
    const float gradient_2_phase_x = (a_2_phase_x * used_2_phase_x) + (a_2_phase_x_2 * used_4_phase_x) + (a_2_phase_x_3
        * used_6_phase_x) + (a_2_phase_x_4 * used_8_phase_x);
    const float forward_3_phase_x = (a_3_phase_x * used_1_phase_x) - (phase_x_part_19 * used_2_phase_x) + (a_3_phase_x_2
        * used_3_phase_x) - (phase_x_part_24 * used_4_phase_x) + (a_3_phase_x_3 * used_5_phase_x) - (phase_x_part_29 *
        used_6_phase_x) + (a_3_phase_x_4 * used_7_phase_x) - (phase_x_part_34 * used_8_phase_x) - (terms_1_phase_x_2 *
        gradient_1_phase_x) - (terms_1_phase_x_4 * gradient_2_phase_x);
    const float left_3_3_phase_x = (used_1_3 * a_3_phase_x) + (phase_x_part_35 * phase_x_part_19) + (used_3_3 *
        a_3_phase_x_2) + (phase_x_part_36 * phase_x_part_24) + (used_5_3 * a_3_phase_x_3) + (phase_x_part_37 *
        phase_x_part_29) + (used_7_3 * a_3_phase_x_4) + (phase_x_part_38 * phase_x_part_34);
    const float terms_1_phase_x_5 = 1.0f / hall_position_four_max(left_3_3_phase_x - (terms_1_phase_x_2 *
        left_3_1_phase_x) + (terms_1_phase_x_4 * phase_x_part_39), 0.3026f);
    const float used_1_4 = (weights_1 ? 1.0f : 0.0f) * a_4_phase_x;
    const float used_2_4 = (weights_1 ? 1.0f : 0.0f) * a_4_phase_x_5;
    const float used_3_4 = (weights_3 ? 1.0f : 0.0f) * a_4_phase_x_2;
    const float used_4_4 = (weights_3 ? 1.0f : 0.0f) * a_4_phase_x_6;
    const float used_5_4 = (weights_5 ? 1.0f : 0.0f) * a_4_phase_x_3;
    const float used_6_4 = (weights_5 ? 1.0f : 0.0f) * a_4_phase_x_7;
    const float used_7_4 = (weights_7 ? 1.0f : 0.0f) * a_4_phase_x_4;
    const float used_8_4 = (weights_7 ? 1.0f : 0.0f) * a_4_phase_x_8;
    const float left_4_1_phase_x = (used_1_4 * a_1_phase_x) + (used_3_4 * a_1_phase_x_2) + (used_5_4 * a_1_phase_x_3) +
        (used_7_4 * a_1_phase_x_4);
    const float terms_1_phase_x_6 = hall_position_four_limit(left_4_1_phase_x * terms_1_phase_x, 625.0f);
    const float left_4_2_phase_x = (used_2_4 * a_2_phase_x) + (used_4_4 * a_2_phase_x_2) + (used_6_4 * a_2_phase_x_3) +
        (used_8_4 * a_2_phase_x_4);
    const float terms_1_phase_x_7 = hall_position_four_limit(left_4_2_phase_x * terms_1_phase_x_3, 625.0f);
    const float left_4_3_phase_x = (used_1_4 * a_3_phase_x) - (used_2_4 * phase_x_part_19) + (used_3_4 * a_3_phase_x_2)
        - (used_4_4 * phase_x_part_24) + (used_5_4 * a_3_phase_x_3) - (used_6_4 * phase_x_part_29) + (used_7_4 *
        a_3_phase_x_4) - (used_8_4 * phase_x_part_34) - (terms_1_phase_x_6 * left_3_1_phase_x) + (terms_1_phase_x_7 *
        phase_x_part_39);
    const float terms_1_phase_x_8 = hall_position_four_limit(left_4_3_phase_x * terms_1_phase_x_5, 250.0f);
    const float offsets_4_phase_x = estimator_amplitude - 1.0f;
    const float pulls_4_phase_x = 0.84055555f * offsets_4_phase_x;
    const float phase_x_part_40 = (a_4_phase_x * used_1_phase_x) + (a_4_phase_x_5 * used_2_phase_x) + (a_4_phase_x_2 *
        used_3_phase_x) + (a_4_phase_x_6 * used_4_phase_x) + (a_4_phase_x_3 * used_5_phase_x) + (a_4_phase_x_7 *
        used_6_phase_x) + (a_4_phase_x_4 * used_7_phase_x) + (a_4_phase_x_8 * used_8_phase_x) - pulls_4_phase_x -
        (terms_1_phase_x_6 * gradient_1_phase_x);
    const float left_4_4_phase_x = (used_1_4 * a_4_phase_x) + (used_2_4 * a_4_phase_x_5) + (used_3_4 * a_4_phase_x_2) +
        (used_4_4 * a_4_phase_x_6) + (used_5_4 * a_4_phase_x_3) + (used_6_4 * a_4_phase_x_7) + (used_7_4 *
        a_4_phase_x_4) + (used_8_4 * a_4_phase_x_8) + 0.84055555f;
    const float variances_4 = 1.0f / hall_position_four_max(left_4_4_phase_x - (terms_1_phase_x_6 * left_4_1_phase_x) -
        (terms_1_phase_x_7 * left_4_2_phase_x) - (terms_1_phase_x_8 * left_4_3_phase_x), 0.07565f);
    const float best_4 = hall_position_four_limit(hall_position_four_limit(phase_x_part_40 - (terms_1_phase_x_7 *
        gradient_2_phase_x) - (terms_1_phase_x_8 * forward_3_phase_x), 7779.7153f) * variances_4, 0.125f);
    const float best_3 = hall_position_four_limit((forward_3_phase_x * terms_1_phase_x_5) - (terms_1_phase_x_8 *
        best_4), 0.1f);
    const float best_1 = hall_position_four_limit((gradient_1_phase_x * terms_1_phase_x) - (terms_1_phase_x_2 * best_3)
        - (terms_1_phase_x_6 * best_4), 0.5f);
    const float phase_x_part_41 = hall_position_four_limit(starts_3 + best_3, 0.20943952f);
    const float f1_argument_2 = phase_x_part_41 * phase_x_part_41;
    const float D_11_phase_x = f1_polynomial(f1_argument_2);
    const float D_21_phase_x = phase_x_part_41 * f2_polynomial(f1_argument_2);
    const float phase_x_part_42 = hall_position_four_max(hall_position_four_min(estimator_amplitude + best_4, 1.25f),
        0.75f);
    const float starts_1_plus_best_1 = starts_1 + best_1;
    const float by_phase_x = hall_position_four_limit(starts_1_plus_best_1 + (0.28902653f * D_11_phase_x) + (0.45238933f
        * D_21_phase_x) - angle_ax_part_sine, 0.5536836f);
    const float f27_argument = by_phase_x * by_phase_x;
    const float phasors_1_sine = (start_sine_phase_x * f27_polynomial(f27_argument)) + (start_cosine_phase_x *
        (by_phase_x * f28_polynomial(f27_argument)));
    const float phasors_1_sine_squared = phasors_1_sine * phasors_1_sine;
    const float residuals_1 = (D_11_phase_x * V_ax_held) - (D_21_phase_x * V_ay_held) - (phase_x_part_42 *
        (phasors_1_sine * (estimator_field_1 + (phasors_1_sine_squared * (estimator_field_3 + (phasors_1_sine_squared *
        estimator_field_5))))));
    const float used_1_phase_x_2 = (weights_1 ? 1.0f : 0.0f) * residuals_1;
    const float by_phase_x_2 = hall_position_four_limit(starts_1_plus_best_1 - (1.118407f * D_11_phase_x) + (1.7404423f
        * D_21_phase_x) - angle_bx_part_sine, 0.706881f);
    const float f29_argument = by_phase_x_2 * by_phase_x_2;
    const float phasors_3_sine = (start_sine_phase_x_2 * f29_polynomial(f29_argument)) + (start_cosine_phase_x_2 *
        (by_phase_x_2 * f30_polynomial(f29_argument)));
    const float phasors_3_sine_squared = phasors_3_sine * phasors_3_sine;
    const float residuals_3 = (D_11_phase_x * V_bx_held) - (D_21_phase_x * V_by_held) - (phase_x_part_42 *
        (phasors_3_sine * (estimator_field_1 + (phasors_3_sine_squared * (estimator_field_3 + (phasors_3_sine_squared *
        estimator_field_5))))));
    const float used_3_phase_x_2 = (weights_3 ? 1.0f : 0.0f) * residuals_3;
    const float by_phase_x_3 = hall_position_four_limit(starts_1_plus_best_1 - (2.506991f * D_11_phase_x) + (3.0033627f
        * D_21_phase_x) - angle_cx_part_sine, 0.8912185f);
    const float f31_argument = by_phase_x_3 * by_phase_x_3;
    const float phasors_5_sine = (start_sine_phase_x_3 * f31_polynomial(f31_argument)) + (start_cosine_phase_x_3 *
        (by_phase_x_3 * f32_polynomial(f31_argument)));
    const float phasors_5_sine_squared = phasors_5_sine * phasors_5_sine;
    const float residuals_5 = (D_11_phase_x * V_cx_held) - (D_21_phase_x * V_cy_held) - (phase_x_part_42 *
        (phasors_5_sine * (estimator_field_1 + (phasors_5_sine_squared * (estimator_field_3 + (phasors_5_sine_squared *
        estimator_field_5))))));
    const float used_5_phase_x_2 = (weights_5 ? 1.0f : 0.0f) * residuals_5;
    const float by_phase_x_4 = hall_position_four_limit(starts_1_plus_best_1 + (1.627345f * D_11_phase_x) - (0.76654863f
        * D_21_phase_x) - angle_dx_part_sine, 0.6798847f);
    const float f33_argument = by_phase_x_4 * by_phase_x_4;
    const float phasors_7_sine = (start_sine_phase_x_4 * f33_polynomial(f33_argument)) + (start_cosine_phase_x_4 *
        (by_phase_x_4 * f34_polynomial(f33_argument)));
    const float phasors_7_sine_squared = phasors_7_sine * phasors_7_sine;
    const float residuals_7 = (D_11_phase_x * V_dx_held) - (D_21_phase_x * V_dy_held) - (phase_x_part_42 *
        (phasors_7_sine * (estimator_field_1 + (phasors_7_sine_squared * (estimator_field_3 + (phasors_7_sine_squared *
        estimator_field_5))))));
    const float used_7_phase_x_2 = (weights_7 ? 1.0f : 0.0f) * residuals_7;
    const float gradient_1_phase_x_2 = (a_1_phase_x * used_1_phase_x_2) + (a_1_phase_x_2 * used_3_phase_x_2) +
        (a_1_phase_x_3 * used_5_phase_x_2) + (a_1_phase_x_4 * used_7_phase_x_2);
    const float phase_x_part_43 = gradient_1_phase_x_2 * terms_1_phase_x;
    const float best_2 = hall_position_four_limit((gradient_2_phase_x * terms_1_phase_x_3) - (terms_1_phase_x_4 *
        best_3) - (terms_1_phase_x_7 * best_4), 0.5f);
    const float starts_2_plus_best_2 = starts_2 + best_2;
    const float by_phase_x_5 = hall_position_four_limit(starts_2_plus_best_2 - (0.45238933f * D_11_phase_x) +
        (0.28902653f * D_21_phase_x) - angle_ay_part_sine, 0.5536836f);
    const float f27_argument_2 = by_phase_x_5 * by_phase_x_5;
    const float phasors_2_sine = (start_sine_phase_x_5 * f27_polynomial(f27_argument_2)) + (start_cosine_phase_x_5 *
        (by_phase_x_5 * f28_polynomial(f27_argument_2)));
    const float phasors_2_sine_squared = phasors_2_sine * phasors_2_sine;
    const float residuals_2 = (D_21_phase_x * V_ax_held) + (D_11_phase_x * V_ay_held) - (phase_x_part_42 *
        (phasors_2_sine * (estimator_field_1 + (phasors_2_sine_squared * (estimator_field_3 + (phasors_2_sine_squared *
        estimator_field_5))))));
    const float used_2_phase_x_2 = (weights_1 ? 1.0f : 0.0f) * residuals_2;
    const float by_phase_x_6 = hall_position_four_limit(starts_2_plus_best_2 - (1.7404423f * D_11_phase_x) - (1.118407f
        * D_21_phase_x) - angle_by_part_sine, 0.706881f);
    const float f29_argument_2 = by_phase_x_6 * by_phase_x_6;
    const float phasors_4_sine = (start_sine_phase_x_6 * f29_polynomial(f29_argument_2)) + (start_cosine_phase_x_6 *
        (by_phase_x_6 * f30_polynomial(f29_argument_2)));
    const float phasors_4_sine_squared = phasors_4_sine * phasors_4_sine;
    const float residuals_4 = (D_21_phase_x * V_bx_held) + (D_11_phase_x * V_by_held) - (phase_x_part_42 *
        (phasors_4_sine * (estimator_field_1 + (phasors_4_sine_squared * (estimator_field_3 + (phasors_4_sine_squared *
        estimator_field_5))))));
    const float used_4_phase_x_2 = (weights_3 ? 1.0f : 0.0f) * residuals_4;
    const float by_phase_x_7 = hall_position_four_limit(starts_2_plus_best_2 - (3.0033627f * D_11_phase_x) - (2.506991f
        * D_21_phase_x) - angle_cy_part_sine, 0.8912185f);
    const float f31_argument_2 = by_phase_x_7 * by_phase_x_7;
    const float phasors_6_sine = (start_sine_phase_x_7 * f31_polynomial(f31_argument_2)) + (start_cosine_phase_x_7 *
        (by_phase_x_7 * f32_polynomial(f31_argument_2)));
    const float phasors_6_sine_squared = phasors_6_sine * phasors_6_sine;
    const float residuals_6 = (D_21_phase_x * V_cx_held) + (D_11_phase_x * V_cy_held) - (phase_x_part_42 *
        (phasors_6_sine * (estimator_field_1 + (phasors_6_sine_squared * (estimator_field_3 + (phasors_6_sine_squared *
        estimator_field_5))))));
    const float used_6_phase_x_2 = (weights_5 ? 1.0f : 0.0f) * residuals_6;
    const float by_phase_x_8 = hall_position_four_limit(starts_2_plus_best_2 + (0.76654863f * D_11_phase_x) + (1.627345f
        * D_21_phase_x) - angle_dy_part_sine, 0.6798847f);
    const float f33_argument_2 = by_phase_x_8 * by_phase_x_8;
    const float phasors_8_sine = (start_sine_phase_x_8 * f33_polynomial(f33_argument_2)) + (start_cosine_phase_x_8 *
        (by_phase_x_8 * f34_polynomial(f33_argument_2)));
    const float phasors_8_sine_squared = phasors_8_sine * phasors_8_sine;
    const float residuals_8 = (D_21_phase_x * V_dx_held) + (D_11_phase_x * V_dy_held) - (phase_x_part_42 *
        (phasors_8_sine * (estimator_field_1 + (phasors_8_sine_squared * (estimator_field_3 + (phasors_8_sine_squared *
        estimator_field_5))))));
    const float used_8_phase_x_2 = (weights_7 ? 1.0f : 0.0f) * residuals_8;
    const float gradient_2_phase_x_2 = (a_2_phase_x * used_2_phase_x_2) + (a_2_phase_x_2 * used_4_phase_x_2) +
        (a_2_phase_x_3 * used_6_phase_x_2) + (a_2_phase_x_4 * used_8_phase_x_2);
    const float forward_3_phase_x_2 = (a_3_phase_x * used_1_phase_x_2) - (phase_x_part_19 * used_2_phase_x_2) +
        (a_3_phase_x_2 * used_3_phase_x_2) - (phase_x_part_24 * used_4_phase_x_2) + (a_3_phase_x_3 * used_5_phase_x_2) -
        (phase_x_part_29 * used_6_phase_x_2) + (a_3_phase_x_4 * used_7_phase_x_2) - (phase_x_part_34 * used_8_phase_x_2)
        - (terms_1_phase_x_2 * gradient_1_phase_x_2) - (terms_1_phase_x_4 * gradient_2_phase_x_2);
    const float phase_x_part_44 = forward_3_phase_x_2 * terms_1_phase_x_5;
    const float offsets_4_phase_x_2 = offsets_4_phase_x + best_4;
    const float gradient_4_phase_x = (a_4_phase_x * used_1_phase_x_2) + (a_4_phase_x_5 * used_2_phase_x_2) +
        (a_4_phase_x_2 * used_3_phase_x_2) + (a_4_phase_x_6 * used_4_phase_x_2) + (a_4_phase_x_3 * used_5_phase_x_2) +
        (a_4_phase_x_7 * used_6_phase_x_2) + (a_4_phase_x_4 * used_7_phase_x_2) + (a_4_phase_x_8 * used_8_phase_x_2) -
        (0.84055555f * offsets_4_phase_x_2);
    const float forward_4_phase_x = hall_position_four_limit(gradient_4_phase_x - (terms_1_phase_x_6 *
        gradient_1_phase_x_2) - (terms_1_phase_x_7 * gradient_2_phase_x_2) - (terms_1_phase_x_8 * forward_3_phase_x_2),
        7779.7153f);
    const float step_phase_x = forward_4_phase_x * variances_4;
    const float at_4 = hall_position_four_limit(best_4 + step_phase_x, 0.125f);
    const float moves_4 = at_4 - best_4;
    const float reported_phase_x = hall_position_four_limit(best_3 + (phase_x_part_44 - (terms_1_phase_x_8 * moves_4)),
        0.1f);
    const float moves_3 = reported_phase_x - best_3;
    const float reported_phase_x_2 = hall_position_four_limit(best_1 + (phase_x_part_43 - (terms_1_phase_x_2 * moves_3)
        - (terms_1_phase_x_6 * moves_4)), 0.5f);
    const float phase_x_part_45 = starts_1 + reported_phase_x_2;
    float phase_x_part_46 = phase_x_part_45;
    if (pi < phase_x_part_45) {
        phase_x_part_46 = phase_x_part_45 - two_pi;
    }
    float phase_x_part_47 = phase_x_part_46;
    if (phase_x_part_46 < -pi) {
        phase_x_part_47 = phase_x_part_46 + two_pi;
    }
    const float phase_x = hall_position_four_limit(phase_x_part_47, pi);
    const float phase_y_part = gradient_2_phase_x_2 * terms_1_phase_x_3;
    const float reported_phase_y = hall_position_four_limit(best_2 + (phase_y_part - (terms_1_phase_x_4 * moves_3) -
        (terms_1_phase_x_7 * moves_4)), 0.5f);
    const float phase_y_part_2 = starts_2 + reported_phase_y;
    float phase_y_part_3 = phase_y_part_2;
    if (pi < phase_y_part_2) {
        phase_y_part_3 = phase_y_part_2 - two_pi;
    }
    float phase_y_part_4 = phase_y_part_3;
    if (phase_y_part_3 < -pi) {
        phase_y_part_4 = phase_y_part_3 + two_pi;
    }
    const float phase_y = hall_position_four_limit(phase_y_part_4, pi);
    const float yaw = hall_position_four_limit(starts_3 + reported_phase_x, 0.20943952f);
    const float amplitude = hall_position_four_max(hall_position_four_min(estimator_amplitude + at_4, 1.25f), 0.75f);
    const float deviation_phase_x_part = terms_1_phase_x_6 - (terms_1_phase_x_8 * terms_1_phase_x_2);
    const float deviation_phase_x_part_2 = terms_1_phase_x + (terms_1_phase_x_2 * terms_1_phase_x_2 * terms_1_phase_x_5)
        + (deviation_phase_x_part * deviation_phase_x_part * variances_4);
    const float deviation_phase_x = hall_position_four_min(0.05500909f * sqrtf(deviation_phase_x_part_2), 0.25f);
    const float deviation_phase_y_part = terms_1_phase_x_7 - (terms_1_phase_x_8 * terms_1_phase_x_4);
    const float deviation_phase_y_part_2 = terms_1_phase_x_3 + (terms_1_phase_x_4 * terms_1_phase_x_4 *
        terms_1_phase_x_5) + (deviation_phase_y_part * deviation_phase_y_part * variances_4);
    const float deviation_phase_y = hall_position_four_min(0.05500909f * sqrtf(deviation_phase_y_part_2), 0.25f);
    const float variances_3_deviation_yaw = terms_1_phase_x_5 + (terms_1_phase_x_8 * terms_1_phase_x_8 * variances_4);
    const float deviation_yaw = hall_position_four_min(0.05500909f * sqrtf(variances_3_deviation_yaw), 0.1f);
    const float deviation_amplitude = 0.05500909f * sqrtf(variances_4);
    const float cost_chi_square = (used_1_phase_x_2 * residuals_1) + (used_2_phase_x_2 * residuals_2) +
        (used_3_phase_x_2 * residuals_3) + (used_4_phase_x_2 * residuals_4) + (used_5_phase_x_2 * residuals_5) +
        (used_6_phase_x_2 * residuals_6) + (used_7_phase_x_2 * residuals_7) + (used_8_phase_x_2 * residuals_8) +
        (0.84055555f * (offsets_4_phase_x_2 * offsets_4_phase_x_2));
    const float chi_square_part = (gradient_1_phase_x_2 * phase_x_part_43) + (gradient_2_phase_x_2 * phase_y_part) +
        (forward_3_phase_x_2 * phase_x_part_44) + (forward_4_phase_x * step_phase_x);
    const float cost_chi_square_2 = hall_position_four_max(cost_chi_square - chi_square_part, 0.0f);
    const float chi_square = hall_position_four_max(hall_position_four_min(330.46927f * cost_chi_square_2, 1e+09f),
        0.0f);
    const bool converged = chi_square_part <= 3.026e-05f;
    const bool weak = !((left_1_1_phase_x <= 12104.0f) && (left_2_2_phase_x <= 12104.0f) && (left_3_3_phase_x <=
        75650.0f) && (left_4_4_phase_x <= 18912.5f)) || (20.654123f <= deviation_phase_x_part_2) || (20.654123f <=
        deviation_phase_y_part_2) || (3.3046596f <= variances_3_deviation_yaw) || (13.218638f <= variances_4);
    const bool phases_valid_test = screened && !weak;
    const float left_1_1_protection_phase_x = (a_1_phase_x * a_1_phase_x) + (a_1_phase_x_2 * a_1_phase_x_2) +
        (a_1_phase_x_3 * a_1_phase_x_3) + (a_1_phase_x_4 * a_1_phase_x_4);
    const float left_2_2_protection_phase_x = (a_2_phase_x * a_2_phase_x) + (a_2_phase_x_2 * a_2_phase_x_2) +
        (a_2_phase_x_3 * a_2_phase_x_3) + (a_2_phase_x_4 * a_2_phase_x_4);
    const float left_3_3_protection_phase_x = (a_3_phase_x * a_3_phase_x) + (phase_x_part_19 * phase_x_part_19) +
        (a_3_phase_x_2 * a_3_phase_x_2) + (phase_x_part_24 * phase_x_part_24) + (a_3_phase_x_3 * a_3_phase_x_3) +
        (phase_x_part_29 * phase_x_part_29) + (a_3_phase_x_4 * a_3_phase_x_4) + (phase_x_part_34 * phase_x_part_34);
    const float left_4_4_protection_phase_x = (a_4_phase_x * a_4_phase_x) + (a_4_phase_x_5 * a_4_phase_x_5) +
        (a_4_phase_x_2 * a_4_phase_x_2) + (a_4_phase_x_6 * a_4_phase_x_6) + (a_4_phase_x_3 * a_4_phase_x_3) +
        (a_4_phase_x_7 * a_4_phase_x_7) + (a_4_phase_x_4 * a_4_phase_x_4) + (a_4_phase_x_8 * a_4_phase_x_8) +
        0.84055555f;
    const float terms_1_protection_phase_x = 1.0f / hall_position_four_max(left_1_1_protection_phase_x, 0.048416f);
    const float protection_phase_x_part = a_1_phase_x * terms_1_protection_phase_x;
    const float left_3_1_protection_phase_x = (a_3_phase_x * a_1_phase_x) + (a_3_phase_x_2 * a_1_phase_x_2) +
        (a_3_phase_x_3 * a_1_phase_x_3) + (a_3_phase_x_4 * a_1_phase_x_4);
    const float terms_1_protection_phase_x_2 = hall_position_four_limit(left_3_1_protection_phase_x *
        terms_1_protection_phase_x, 1250.0f);
    const float b_3_protection_phase_x = a_3_phase_x - (terms_1_protection_phase_x_2 * a_1_phase_x);
    const float protection_phase_x_part_2 = (phase_x_part_19 * a_2_phase_x) + (phase_x_part_24 * a_2_phase_x_2) +
        (phase_x_part_29 * a_2_phase_x_3) + (phase_x_part_34 * a_2_phase_x_4);
    const float terms_1_protection_phase_x_3 = 1.0f / hall_position_four_max(left_2_2_protection_phase_x, 0.048416f);
    const float terms_1_protection_phase_x_4 = hall_position_four_limit(-(protection_phase_x_part_2 *
        terms_1_protection_phase_x_3), 1250.0f);
    const float terms_1_protection_phase_x_5 = 1.0f / hall_position_four_max(left_3_3_protection_phase_x -
        (terms_1_protection_phase_x_2 * left_3_1_protection_phase_x) + (terms_1_protection_phase_x_4 *
        protection_phase_x_part_2), 0.3026f);
    const float protection_phase_x_part_3 = b_3_protection_phase_x * terms_1_protection_phase_x_5;
    const float left_4_1_protection_phase_x = (a_4_phase_x * a_1_phase_x) + (a_4_phase_x_2 * a_1_phase_x_2) +
        (a_4_phase_x_3 * a_1_phase_x_3) + (a_4_phase_x_4 * a_1_phase_x_4);
    const float terms_1_protection_phase_x_6 = hall_position_four_limit(left_4_1_protection_phase_x *
        terms_1_protection_phase_x, 625.0f);
    const float left_4_2_protection_phase_x = (a_4_phase_x_5 * a_2_phase_x) + (a_4_phase_x_6 * a_2_phase_x_2) +
        (a_4_phase_x_7 * a_2_phase_x_3) + (a_4_phase_x_8 * a_2_phase_x_4);
    const float terms_1_protection_phase_x_7 = hall_position_four_limit(left_4_2_protection_phase_x *
        terms_1_protection_phase_x_3, 625.0f);
    const float left_4_3_protection_phase_x = (a_4_phase_x * a_3_phase_x) - (a_4_phase_x_5 * phase_x_part_19) +
        (a_4_phase_x_2 * a_3_phase_x_2) - (a_4_phase_x_6 * phase_x_part_24) + (a_4_phase_x_3 * a_3_phase_x_3) -
        (a_4_phase_x_7 * phase_x_part_29) + (a_4_phase_x_4 * a_3_phase_x_4) - (a_4_phase_x_8 * phase_x_part_34) -
        (terms_1_protection_phase_x_6 * left_3_1_protection_phase_x) + (terms_1_protection_phase_x_7 *
        protection_phase_x_part_2);
    const float terms_1_protection_phase_x_8 = hall_position_four_limit(left_4_3_protection_phase_x *
        terms_1_protection_phase_x_5, 250.0f);
    const float b_4_protection_phase_x = hall_position_four_limit(a_4_phase_x - (terms_1_protection_phase_x_6 *
        a_1_phase_x) - (terms_1_protection_phase_x_8 * b_3_protection_phase_x), 137.52272f);
    const float protection_phase_x_part_4 = 1.0f / hall_position_four_max(left_4_4_protection_phase_x -
        (terms_1_protection_phase_x_6 * left_4_1_protection_phase_x) - (terms_1_protection_phase_x_7 *
        left_4_2_protection_phase_x) - (terms_1_protection_phase_x_8 * left_4_3_protection_phase_x), 0.07565f);
    const float ends_4_protection_phase_x = b_4_protection_phase_x * protection_phase_x_part_4;
    const float ends_3_protection_phase_x = protection_phase_x_part_3 - (terms_1_protection_phase_x_8 *
        ends_4_protection_phase_x);
    const float moves_1_1 = hall_position_four_limit(protection_phase_x_part - (terms_1_protection_phase_x_2 *
        ends_3_protection_phase_x) - (terms_1_protection_phase_x_6 * ends_4_protection_phase_x), 9.089407f);
    const float gains_1 = 1.0f / hall_position_four_max(1.0f - ((a_1_phase_x * protection_phase_x_part) +
        (b_3_protection_phase_x * protection_phase_x_part_3) + (b_4_protection_phase_x * ends_4_protection_phase_x)),
        0.001f);
    const float protection_phase_x_part_5 = phase_x_part_19 + (terms_1_protection_phase_x_4 * a_2_phase_x);
    const float protection_phase_x_part_6 = protection_phase_x_part_5 * terms_1_protection_phase_x_5;
    const float forward_4_protection_phase_x = hall_position_four_limit(a_4_phase_x_5 - (terms_1_protection_phase_x_7 *
        a_2_phase_x) + (terms_1_protection_phase_x_8 * protection_phase_x_part_5), 137.52272f);
    const float protection_phase_x_part_7 = forward_4_protection_phase_x * protection_phase_x_part_4;
    const float protection_phase_x_part_8 = protection_phase_x_part_6 + (terms_1_protection_phase_x_8 *
        protection_phase_x_part_7);
    const float protection_phase_x_part_9 = (protection_phase_x_part_7 * b_4_protection_phase_x) -
        (protection_phase_x_part_6 * b_3_protection_phase_x);
    const float lower_2_1_protection_phase_x = hall_position_four_limit(-(protection_phase_x_part_9 * gains_1),
        31.622776f);
    const float moves_2_1 = hall_position_four_limit((terms_1_protection_phase_x_2 * protection_phase_x_part_8) -
        (terms_1_protection_phase_x_6 * protection_phase_x_part_7), 9.089407f) - (lower_2_1_protection_phase_x *
        moves_1_1);
    const float protection_phase_x_part_10 = a_2_phase_x * terms_1_protection_phase_x_3;
    const float gains_2 = 1.0f / hall_position_four_max(1.0f - ((a_2_phase_x * protection_phase_x_part_10) +
        (protection_phase_x_part_5 * protection_phase_x_part_6) + (forward_4_protection_phase_x *
        protection_phase_x_part_7)) + (lower_2_1_protection_phase_x * protection_phase_x_part_9), 0.001f);
    const float protection_phase_x_part_11 = (moves_1_1 * moves_1_1 * gains_1) + (moves_2_1 * moves_2_1 * gains_2);
    const float protection_phase_x_part_12 = a_1_phase_x_2 * terms_1_protection_phase_x;
    const float b_3_protection_phase_x_2 = a_3_phase_x_2 - (terms_1_protection_phase_x_2 * a_1_phase_x_2);
    const float protection_phase_x_part_13 = b_3_protection_phase_x_2 * terms_1_protection_phase_x_5;
    const float b_4_protection_phase_x_2 = hall_position_four_limit(a_4_phase_x_2 - (terms_1_protection_phase_x_6 *
        a_1_phase_x_2) - (terms_1_protection_phase_x_8 * b_3_protection_phase_x_2), 137.52272f);
    const float ends_4_protection_phase_x_2 = b_4_protection_phase_x_2 * protection_phase_x_part_4;
    const float ends_3_protection_phase_x_2 = protection_phase_x_part_13 - (terms_1_protection_phase_x_8 *
        ends_4_protection_phase_x_2);
    const float moves_3_1 = hall_position_four_limit(protection_phase_x_part_12 - (terms_1_protection_phase_x_2 *
        ends_3_protection_phase_x_2) - (terms_1_protection_phase_x_6 * ends_4_protection_phase_x_2), 9.089407f);
    const float gains_3 = 1.0f / hall_position_four_max(1.0f - ((a_1_phase_x_2 * protection_phase_x_part_12) +
        (b_3_protection_phase_x_2 * protection_phase_x_part_13) + (b_4_protection_phase_x_2 *
        ends_4_protection_phase_x_2)), 0.001f);
    const float protection_phase_x_part_14 = phase_x_part_24 + (terms_1_protection_phase_x_4 * a_2_phase_x_2);
    const float protection_phase_x_part_15 = protection_phase_x_part_14 * terms_1_protection_phase_x_5;
    const float forward_4_protection_phase_x_2 = hall_position_four_limit(a_4_phase_x_6 - (terms_1_protection_phase_x_7
        * a_2_phase_x_2) + (terms_1_protection_phase_x_8 * protection_phase_x_part_14), 137.52272f);
    const float protection_phase_x_part_16 = forward_4_protection_phase_x_2 * protection_phase_x_part_4;
    const float protection_phase_x_part_17 = protection_phase_x_part_15 + (terms_1_protection_phase_x_8 *
        protection_phase_x_part_16);
    const float protection_phase_x_part_18 = (protection_phase_x_part_16 * b_4_protection_phase_x_2) -
        (protection_phase_x_part_15 * b_3_protection_phase_x_2);
    const float lower_2_1_protection_phase_x_2 = hall_position_four_limit(-(protection_phase_x_part_18 * gains_3),
        31.622776f);
    const float moves_4_1 = hall_position_four_limit((terms_1_protection_phase_x_2 * protection_phase_x_part_17) -
        (terms_1_protection_phase_x_6 * protection_phase_x_part_16), 9.089407f) - (lower_2_1_protection_phase_x_2 *
        moves_3_1);
    const float protection_phase_x_part_19 = a_2_phase_x_2 * terms_1_protection_phase_x_3;
    const float gains_4 = 1.0f / hall_position_four_max(1.0f - ((a_2_phase_x_2 * protection_phase_x_part_19) +
        (protection_phase_x_part_14 * protection_phase_x_part_15) + (forward_4_protection_phase_x_2 *
        protection_phase_x_part_16)) + (lower_2_1_protection_phase_x_2 * protection_phase_x_part_18), 0.001f);
    const float protection_phase_x_part_20 = (moves_3_1 * moves_3_1 * gains_3) + (moves_4_1 * moves_4_1 * gains_4);
    const float protection_phase_x_part_21 = a_1_phase_x_3 * terms_1_protection_phase_x;
    const float b_3_protection_phase_x_3 = a_3_phase_x_3 - (terms_1_protection_phase_x_2 * a_1_phase_x_3);
    const float protection_phase_x_part_22 = b_3_protection_phase_x_3 * terms_1_protection_phase_x_5;
    const float b_4_protection_phase_x_3 = hall_position_four_limit(a_4_phase_x_3 - (terms_1_protection_phase_x_6 *
        a_1_phase_x_3) - (terms_1_protection_phase_x_8 * b_3_protection_phase_x_3), 137.52272f);
    const float ends_4_protection_phase_x_3 = b_4_protection_phase_x_3 * protection_phase_x_part_4;
    const float ends_3_protection_phase_x_3 = protection_phase_x_part_22 - (terms_1_protection_phase_x_8 *
        ends_4_protection_phase_x_3);
    const float moves_5_1 = hall_position_four_limit(protection_phase_x_part_21 - (terms_1_protection_phase_x_2 *
        ends_3_protection_phase_x_3) - (terms_1_protection_phase_x_6 * ends_4_protection_phase_x_3), 9.089407f);
    const float gains_5 = 1.0f / hall_position_four_max(1.0f - ((a_1_phase_x_3 * protection_phase_x_part_21) +
        (b_3_protection_phase_x_3 * protection_phase_x_part_22) + (b_4_protection_phase_x_3 *
        ends_4_protection_phase_x_3)), 0.001f);
    const float protection_phase_x_part_23 = phase_x_part_29 + (terms_1_protection_phase_x_4 * a_2_phase_x_3);
    const float protection_phase_x_part_24 = protection_phase_x_part_23 * terms_1_protection_phase_x_5;
    const float forward_4_protection_phase_x_3 = hall_position_four_limit(a_4_phase_x_7 - (terms_1_protection_phase_x_7
        * a_2_phase_x_3) + (terms_1_protection_phase_x_8 * protection_phase_x_part_23), 137.52272f);
    const float protection_phase_x_part_25 = forward_4_protection_phase_x_3 * protection_phase_x_part_4;
    const float protection_phase_x_part_26 = protection_phase_x_part_24 + (terms_1_protection_phase_x_8 *
        protection_phase_x_part_25);
    const float protection_phase_x_part_27 = (protection_phase_x_part_25 * b_4_protection_phase_x_3) -
        (protection_phase_x_part_24 * b_3_protection_phase_x_3);
    const float lower_2_1_protection_phase_x_3 = hall_position_four_limit(-(protection_phase_x_part_27 * gains_5),
        31.622776f);
    const float moves_6_1 = hall_position_four_limit((terms_1_protection_phase_x_2 * protection_phase_x_part_26) -
        (terms_1_protection_phase_x_6 * protection_phase_x_part_25), 9.089407f) - (lower_2_1_protection_phase_x_3 *
        moves_5_1);
    const float protection_phase_x_part_28 = a_2_phase_x_3 * terms_1_protection_phase_x_3;
    const float gains_6 = 1.0f / hall_position_four_max(1.0f - ((a_2_phase_x_3 * protection_phase_x_part_28) +
        (protection_phase_x_part_23 * protection_phase_x_part_24) + (forward_4_protection_phase_x_3 *
        protection_phase_x_part_25)) + (lower_2_1_protection_phase_x_3 * protection_phase_x_part_27), 0.001f);
    const float protection_phase_x_part_29 = (moves_5_1 * moves_5_1 * gains_5) + (moves_6_1 * moves_6_1 * gains_6);
    const float protection_phase_x_part_30 = a_1_phase_x_4 * terms_1_protection_phase_x;
    const float b_3_protection_phase_x_4 = a_3_phase_x_4 - (terms_1_protection_phase_x_2 * a_1_phase_x_4);
    const float protection_phase_x_part_31 = b_3_protection_phase_x_4 * terms_1_protection_phase_x_5;
    const float b_4_protection_phase_x_4 = hall_position_four_limit(a_4_phase_x_4 - (terms_1_protection_phase_x_6 *
        a_1_phase_x_4) - (terms_1_protection_phase_x_8 * b_3_protection_phase_x_4), 137.52272f);
    const float ends_4_protection_phase_x_4 = b_4_protection_phase_x_4 * protection_phase_x_part_4;
    const float ends_3_protection_phase_x_4 = protection_phase_x_part_31 - (terms_1_protection_phase_x_8 *
        ends_4_protection_phase_x_4);
    const float moves_7_1 = hall_position_four_limit(protection_phase_x_part_30 - (terms_1_protection_phase_x_2 *
        ends_3_protection_phase_x_4) - (terms_1_protection_phase_x_6 * ends_4_protection_phase_x_4), 9.089407f);
    const float gains_7 = 1.0f / hall_position_four_max(1.0f - ((a_1_phase_x_4 * protection_phase_x_part_30) +
        (b_3_protection_phase_x_4 * protection_phase_x_part_31) + (b_4_protection_phase_x_4 *
        ends_4_protection_phase_x_4)), 0.001f);
    const float protection_phase_x_part_32 = phase_x_part_34 + (terms_1_protection_phase_x_4 * a_2_phase_x_4);
    const float protection_phase_x_part_33 = protection_phase_x_part_32 * terms_1_protection_phase_x_5;
    const float forward_4_protection_phase_x_4 = hall_position_four_limit(a_4_phase_x_8 - (terms_1_protection_phase_x_7
        * a_2_phase_x_4) + (terms_1_protection_phase_x_8 * protection_phase_x_part_32), 137.52272f);
    const float protection_phase_x_part_34 = forward_4_protection_phase_x_4 * protection_phase_x_part_4;
    const float protection_phase_x_part_35 = protection_phase_x_part_33 + (terms_1_protection_phase_x_8 *
        protection_phase_x_part_34);
    const float protection_phase_x_part_36 = (protection_phase_x_part_34 * b_4_protection_phase_x_4) -
        (protection_phase_x_part_33 * b_3_protection_phase_x_4);
    const float lower_2_1_protection_phase_x_4 = hall_position_four_limit(-(protection_phase_x_part_36 * gains_7),
        31.622776f);
    const float moves_8_1 = hall_position_four_limit((terms_1_protection_phase_x_2 * protection_phase_x_part_35) -
        (terms_1_protection_phase_x_6 * protection_phase_x_part_34), 9.089407f) - (lower_2_1_protection_phase_x_4 *
        moves_7_1);
    const float protection_phase_x_part_37 = a_2_phase_x_4 * terms_1_protection_phase_x_3;
    const float gain = 1.0f / hall_position_four_max(1.0f - ((a_2_phase_x_4 * protection_phase_x_part_37) +
        (protection_phase_x_part_32 * protection_phase_x_part_33) + (forward_4_protection_phase_x_4 *
        protection_phase_x_part_34)) + (lower_2_1_protection_phase_x_4 * protection_phase_x_part_36), 0.001f);
    const float protection_phase_x_part_38 = (moves_7_1 * moves_7_1 * gains_7) + (moves_8_1 * moves_8_1 * gain);
    const float moves_1_2 = hall_position_four_limit(-((terms_1_protection_phase_x_4 * ends_3_protection_phase_x) +
        (terms_1_protection_phase_x_7 * ends_4_protection_phase_x)), 9.089407f);
    const float moves_2_2 = hall_position_four_limit(protection_phase_x_part_10 + (terms_1_protection_phase_x_4 *
        protection_phase_x_part_8) - (terms_1_protection_phase_x_7 * protection_phase_x_part_7), 9.089407f) -
        (lower_2_1_protection_phase_x * moves_1_2);
    const float protection_phase_y_part = (moves_1_2 * moves_1_2 * gains_1) + (moves_2_2 * moves_2_2 * gains_2);
    const float moves_3_2 = hall_position_four_limit(-((terms_1_protection_phase_x_4 * ends_3_protection_phase_x_2) +
        (terms_1_protection_phase_x_7 * ends_4_protection_phase_x_2)), 9.089407f);
    const float moves_4_2 = hall_position_four_limit(protection_phase_x_part_19 + (terms_1_protection_phase_x_4 *
        protection_phase_x_part_17) - (terms_1_protection_phase_x_7 * protection_phase_x_part_16), 9.089407f) -
        (lower_2_1_protection_phase_x_2 * moves_3_2);
    const float protection_phase_y_part_2 = (moves_3_2 * moves_3_2 * gains_3) + (moves_4_2 * moves_4_2 * gains_4);
    const float moves_5_2 = hall_position_four_limit(-((terms_1_protection_phase_x_4 * ends_3_protection_phase_x_3) +
        (terms_1_protection_phase_x_7 * ends_4_protection_phase_x_3)), 9.089407f);
    const float moves_6_2 = hall_position_four_limit(protection_phase_x_part_28 + (terms_1_protection_phase_x_4 *
        protection_phase_x_part_26) - (terms_1_protection_phase_x_7 * protection_phase_x_part_25), 9.089407f) -
        (lower_2_1_protection_phase_x_3 * moves_5_2);
    const float protection_phase_y_part_3 = (moves_5_2 * moves_5_2 * gains_5) + (moves_6_2 * moves_6_2 * gains_6);
    const float moves_7_2 = hall_position_four_limit(-((terms_1_protection_phase_x_4 * ends_3_protection_phase_x_4) +
        (terms_1_protection_phase_x_7 * ends_4_protection_phase_x_4)), 9.089407f);
    const float moves_8_2 = hall_position_four_limit(protection_phase_x_part_37 + (terms_1_protection_phase_x_4 *
        protection_phase_x_part_35) - (terms_1_protection_phase_x_7 * protection_phase_x_part_34), 9.089407f) -
        (lower_2_1_protection_phase_x_4 * moves_7_2);
    const float protection_phase_y_part_4 = (moves_7_2 * moves_7_2 * gains_7) + (moves_8_2 * moves_8_2 * gain);
    const float moves_1_3 = hall_position_four_limit(ends_3_protection_phase_x, 3.6357627f);
    const float moves_2_3 = hall_position_four_limit(-protection_phase_x_part_8, 3.6357627f) -
        (lower_2_1_protection_phase_x * moves_1_3);
    const float protection_yaw_part = (moves_1_3 * moves_1_3 * gains_1) + (moves_2_3 * moves_2_3 * gains_2);
    const float moves_3_3 = hall_position_four_limit(ends_3_protection_phase_x_2, 3.6357627f);
    const float moves_4_3 = hall_position_four_limit(-protection_phase_x_part_17, 3.6357627f) -
        (lower_2_1_protection_phase_x_2 * moves_3_3);
    const float protection_yaw_part_2 = (moves_3_3 * moves_3_3 * gains_3) + (moves_4_3 * moves_4_3 * gains_4);
    const float moves_5_3 = hall_position_four_limit(ends_3_protection_phase_x_3, 3.6357627f);
    const float moves_6_3 = hall_position_four_limit(-protection_phase_x_part_26, 3.6357627f) -
        (lower_2_1_protection_phase_x_3 * moves_5_3);
    const float protection_yaw_part_3 = (moves_5_3 * moves_5_3 * gains_5) + (moves_6_3 * moves_6_3 * gains_6);
    const float moves_7_3 = hall_position_four_limit(ends_3_protection_phase_x_4, 3.6357627f);
    const float moves_8_3 = hall_position_four_limit(-protection_phase_x_part_35, 3.6357627f) -
        (lower_2_1_protection_phase_x_4 * moves_7_3);
    const float protection_yaw_part_4 = (moves_7_3 * moves_7_3 * gains_7) + (moves_8_3 * moves_8_3 * gain);
    const float protection_phase_x_part_39 = (e_1 * e_1) + (e_2 * e_2) + (e_3 * e_3) + (e_4 * e_4) + (e_5 * e_5) + (e_6
        * e_6) + (e_7 * e_7) + (e_8 * e_8) + (0.84055555f * (offsets_4_phase_x * offsets_4_phase_x));
    const float protection_phase_x_part_40 = (a_1_phase_x * e_1) + (a_1_phase_x_2 * e_3) + (a_1_phase_x_3 * e_5) +
        (a_1_phase_x_4 * e_7);
    const float protection_phase_x_part_41 = protection_phase_x_part_40 * terms_1_protection_phase_x;
    const float protection_phase_x_part_42 = (a_2_phase_x * e_2) + (a_2_phase_x_2 * e_4) + (a_2_phase_x_3 * e_6) +
        (a_2_phase_x_4 * e_8);
    const float protection_phase_x_part_43 = protection_phase_x_part_42 * terms_1_protection_phase_x_3;
    const float forward_3_protection_phase_x = (a_3_phase_x * e_1) - (phase_x_part_19 * e_2) + (a_3_phase_x_2 * e_3) -
        (phase_x_part_24 * e_4) + (a_3_phase_x_3 * e_5) - (phase_x_part_29 * e_6) + (a_3_phase_x_4 * e_7) -
        (phase_x_part_34 * e_8) - (terms_1_protection_phase_x_2 * protection_phase_x_part_40) -
        (terms_1_protection_phase_x_4 * protection_phase_x_part_42);
    const float protection_phase_x_part_44 = forward_3_protection_phase_x * terms_1_protection_phase_x_5;
    const float protection_phase_x_part_45 = (a_4_phase_x * e_1) + (a_4_phase_x_5 * e_2) + (a_4_phase_x_2 * e_3) +
        (a_4_phase_x_6 * e_4) + (a_4_phase_x_3 * e_5) + (a_4_phase_x_7 * e_6) + (a_4_phase_x_4 * e_7) + (a_4_phase_x_8 *
        e_8) - pulls_4_phase_x - (terms_1_protection_phase_x_6 * protection_phase_x_part_40);
    const float forward_4_protection_phase_x_5 = hall_position_four_limit(protection_phase_x_part_45 -
        (terms_1_protection_phase_x_7 * protection_phase_x_part_42) - (terms_1_protection_phase_x_8 *
        forward_3_protection_phase_x), 7779.7153f);
    const float ends_4_protection_phase_x_5 = forward_4_protection_phase_x_5 * protection_phase_x_part_4;
    const float full_cost = hall_position_four_max(protection_phase_x_part_39 - ((protection_phase_x_part_40 *
        protection_phase_x_part_41) + (protection_phase_x_part_42 * protection_phase_x_part_43) +
        (forward_3_protection_phase_x * protection_phase_x_part_44) + (forward_4_protection_phase_x_5 *
        ends_4_protection_phase_x_5)), 0.0f);
    const float ends_3_protection_phase_x_5 = protection_phase_x_part_44 - (terms_1_protection_phase_x_8 *
        ends_4_protection_phase_x_5);
    const float step_1 = hall_position_four_limit(protection_phase_x_part_41 - (terms_1_protection_phase_x_2 *
        ends_3_protection_phase_x_5) - (terms_1_protection_phase_x_6 * ends_4_protection_phase_x_5), 257.0957f);
    const float step_3 = hall_position_four_limit(ends_3_protection_phase_x_5, 102.83827f);
    const float step_4 = hall_position_four_limit(ends_4_protection_phase_x_5, 205.67654f);
    const float scores_1 = e_1 - ((a_1_phase_x * step_1) + (a_3_phase_x * step_3) + (a_4_phase_x * step_4));
    const float step_2 = hall_position_four_limit(protection_phase_x_part_43 - (terms_1_protection_phase_x_4 *
        ends_3_protection_phase_x_5) - (terms_1_protection_phase_x_7 * ends_4_protection_phase_x_5), 257.0957f);
    const float scores_2_protection_phase_x = e_2 - ((a_2_phase_x * step_2) - (phase_x_part_19 * step_3) +
        (a_4_phase_x_5 * step_4)) - (lower_2_1_protection_phase_x * scores_1);
    const float costs_1 = full_cost - ((scores_1 * scores_1 * gains_1) + (scores_2_protection_phase_x *
        scores_2_protection_phase_x * gains_2));
    const float scores_3 = e_3 - ((a_1_phase_x_2 * step_1) + (a_3_phase_x_2 * step_3) + (a_4_phase_x_2 * step_4));
    const float scores_4_protection_phase_x = e_4 - ((a_2_phase_x_2 * step_2) - (phase_x_part_24 * step_3) +
        (a_4_phase_x_6 * step_4)) - (lower_2_1_protection_phase_x_2 * scores_3);
    const float costs_2 = full_cost - ((scores_3 * scores_3 * gains_3) + (scores_4_protection_phase_x *
        scores_4_protection_phase_x * gains_4));
    const float scores_5 = e_5 - ((a_1_phase_x_3 * step_1) + (a_3_phase_x_3 * step_3) + (a_4_phase_x_3 * step_4));
    const float scores_6_protection_phase_x = e_6 - ((a_2_phase_x_3 * step_2) - (phase_x_part_29 * step_3) +
        (a_4_phase_x_7 * step_4)) - (lower_2_1_protection_phase_x_3 * scores_5);
    const float costs_3 = full_cost - ((scores_5 * scores_5 * gains_5) + (scores_6_protection_phase_x *
        scores_6_protection_phase_x * gains_6));
    const float scores_7 = e_7 - ((a_1_phase_x_4 * step_1) + (a_3_phase_x_4 * step_3) + (a_4_phase_x_4 * step_4));
    const float scores_8_protection_phase_x = e_8 - ((a_2_phase_x_4 * step_2) - (phase_x_part_34 * step_3) +
        (a_4_phase_x_8 * step_4)) - (lower_2_1_protection_phase_x_4 * scores_7);
    const float costs_4 = full_cost - ((scores_7 * scores_7 * gains_7) + (scores_8_protection_phase_x *
        scores_8_protection_phase_x * gain));
    float limit = 20.515005f;
    float protection_phase_x_part_46;
    float protection_phase_y_part_5;
    float level;
    if (hall_position_four_equal(excluded, 0.0f)) {
        const float worst_protection_phase_x =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(hall_position_four_max(0.0f,
            protection_phase_x_part_11), protection_phase_x_part_20), protection_phase_x_part_29),
            protection_phase_x_part_38);
        protection_phase_x_part_46 = (0.40003738f * sqrtf(worst_protection_phase_x)) + (3.4807565f * deviation_phase_x);
        const float worst_protection_phase_y =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(hall_position_four_max(0.0f,
            protection_phase_y_part), protection_phase_y_part_2), protection_phase_y_part_3),
            protection_phase_y_part_4);
        protection_phase_y_part_5 = (0.40003738f * sqrtf(worst_protection_phase_y)) + (3.4807565f * deviation_phase_y);
        const float worst_protection_yaw =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(hall_position_four_max(0.0f,
            protection_yaw_part), protection_yaw_part_2), protection_yaw_part_3), protection_yaw_part_4);
        level = (0.40003738f * sqrtf(worst_protection_yaw)) + (3.4807565f * deviation_yaw);
    } else {
        limit = 17.729996f;
        const float protection_phase_x_part_47 = 0.053650968f + (1e-05f * full_cost);
        float protection_phase_x_part_48 = 0.0f;
        float protection_phase_x_part_49 = protection_phase_x_part_11;
        float protection_phase_y_part_6 = 0.0f;
        float protection_phase_y_part_7 = protection_phase_y_part;
        float protection_yaw_part_5 = 0.0f;
        float protection_yaw_part_6 = protection_yaw_part;
        if (costs_1 <= protection_phase_x_part_47) {
            const float scores_1_times_gains_1 = scores_1 * gains_1;
            const float protection_phase_x_part_50 = scores_2_protection_phase_x * gains_2;
            protection_phase_x_part_48 = fabsf(step_1 - ((moves_1_1 * scores_1_times_gains_1) + (moves_2_1 *
                protection_phase_x_part_50)) - reported_phase_x_2);
            protection_phase_y_part_6 = fabsf(step_2 - ((moves_1_2 * scores_1_times_gains_1) + (moves_2_2 *
                protection_phase_x_part_50)) - reported_phase_y);
            protection_yaw_part_5 = fabsf(step_3 - ((moves_1_3 * scores_1_times_gains_1) + (moves_2_3 *
                protection_phase_x_part_50)) - reported_phase_x);
        } else {
            protection_phase_x_part_49 = 0.0f;
            protection_phase_y_part_7 = 0.0f;
            protection_yaw_part_6 = 0.0f;
        }
        float protection_phase_x_part_51 = 0.0f;
        float protection_phase_x_part_52 = protection_phase_x_part_20;
        float protection_phase_y_part_8 = 0.0f;
        float protection_phase_y_part_9 = protection_phase_y_part_2;
        float protection_yaw_part_7 = 0.0f;
        float protection_yaw_part_8 = protection_yaw_part_2;
        if (costs_2 <= protection_phase_x_part_47) {
            const float scores_3_times_gains_3 = scores_3 * gains_3;
            const float protection_phase_x_part_53 = scores_4_protection_phase_x * gains_4;
            protection_phase_x_part_51 = fabsf(step_1 - ((moves_3_1 * scores_3_times_gains_3) + (moves_4_1 *
                protection_phase_x_part_53)) - reported_phase_x_2);
            protection_phase_y_part_8 = fabsf(step_2 - ((moves_3_2 * scores_3_times_gains_3) + (moves_4_2 *
                protection_phase_x_part_53)) - reported_phase_y);
            protection_yaw_part_7 = fabsf(step_3 - ((moves_3_3 * scores_3_times_gains_3) + (moves_4_3 *
                protection_phase_x_part_53)) - reported_phase_x);
        } else {
            protection_phase_x_part_52 = 0.0f;
            protection_phase_y_part_9 = 0.0f;
            protection_yaw_part_8 = 0.0f;
        }
        float protection_phase_x_part_54 = 0.0f;
        float protection_phase_x_part_55 = protection_phase_x_part_29;
        float protection_phase_y_part_10 = 0.0f;
        float protection_phase_y_part_11 = protection_phase_y_part_3;
        float protection_yaw_part_9 = 0.0f;
        float protection_yaw_part_10 = protection_yaw_part_3;
        if (costs_3 <= protection_phase_x_part_47) {
            const float scores_5_times_gains_5 = scores_5 * gains_5;
            const float protection_phase_x_part_56 = scores_6_protection_phase_x * gains_6;
            protection_phase_x_part_54 = fabsf(step_1 - ((moves_5_1 * scores_5_times_gains_5) + (moves_6_1 *
                protection_phase_x_part_56)) - reported_phase_x_2);
            protection_phase_y_part_10 = fabsf(step_2 - ((moves_5_2 * scores_5_times_gains_5) + (moves_6_2 *
                protection_phase_x_part_56)) - reported_phase_y);
            protection_yaw_part_9 = fabsf(step_3 - ((moves_5_3 * scores_5_times_gains_5) + (moves_6_3 *
                protection_phase_x_part_56)) - reported_phase_x);
        } else {
            protection_phase_x_part_55 = 0.0f;
            protection_phase_y_part_11 = 0.0f;
            protection_yaw_part_10 = 0.0f;
        }
        float protection_phase_x_part_57 = 0.0f;
        float protection_phase_x_part_58 = protection_phase_x_part_38;
        float protection_phase_y_part_12 = 0.0f;
        float protection_phase_y_part_13 = protection_phase_y_part_4;
        float protection_yaw_part_11 = 0.0f;
        float protection_yaw_part_12 = protection_yaw_part_4;
        if (costs_4 <= protection_phase_x_part_47) {
            const float scores_7_times_gains_7 = scores_7 * gains_7;
            const float protection_phase_x_part_59 = scores_8_protection_phase_x * gain;
            protection_phase_x_part_57 = fabsf(step_1 - ((moves_7_1 * scores_7_times_gains_7) + (moves_8_1 *
                protection_phase_x_part_59)) - reported_phase_x_2);
            protection_phase_y_part_12 = fabsf(step_2 - ((moves_7_2 * scores_7_times_gains_7) + (moves_8_2 *
                protection_phase_x_part_59)) - reported_phase_y);
            protection_yaw_part_11 = fabsf(step_3 - ((moves_7_3 * scores_7_times_gains_7) + (moves_8_3 *
                protection_phase_x_part_59)) - reported_phase_x);
        } else {
            protection_phase_x_part_58 = 0.0f;
            protection_phase_y_part_13 = 0.0f;
            protection_yaw_part_12 = 0.0f;
        }
        const float protection_phase_x_part_60 = terms_1_protection_phase_x_6 - (terms_1_protection_phase_x_8 *
            terms_1_protection_phase_x_2);
        const float added_protection_phase_x =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(hall_position_four_max(0.0f,
            protection_phase_x_part_49), protection_phase_x_part_52), protection_phase_x_part_55),
            protection_phase_x_part_58);
        const float protection_phase_x_part_61 =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(protection_phase_x_part_48,
            protection_phase_x_part_51), protection_phase_x_part_54), protection_phase_x_part_57) + (0.19147325f *
            sqrtf(terms_1_protection_phase_x + (terms_1_protection_phase_x_2 * terms_1_protection_phase_x_2 *
            terms_1_protection_phase_x_5) + (protection_phase_x_part_60 * protection_phase_x_part_60 *
            protection_phase_x_part_4) + added_protection_phase_x));
        protection_phase_x_part_46 = protection_phase_x_part_61;
        const float protection_phase_y_part_14 = terms_1_protection_phase_x_7 - (terms_1_protection_phase_x_8 *
            terms_1_protection_phase_x_4);
        const float added_protection_phase_y =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(hall_position_four_max(0.0f,
            protection_phase_y_part_7), protection_phase_y_part_9), protection_phase_y_part_11),
            protection_phase_y_part_13);
        const float protection_phase_y_part_15 =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(protection_phase_y_part_6,
            protection_phase_y_part_8), protection_phase_y_part_10), protection_phase_y_part_12) + (0.19147325f *
            sqrtf(terms_1_protection_phase_x_3 + (terms_1_protection_phase_x_4 * terms_1_protection_phase_x_4 *
            terms_1_protection_phase_x_5) + (protection_phase_y_part_14 * protection_phase_y_part_14 *
            protection_phase_x_part_4) + added_protection_phase_y));
        protection_phase_y_part_5 = protection_phase_y_part_15;
        const float added_protection_yaw =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(hall_position_four_max(0.0f,
            protection_yaw_part_6), protection_yaw_part_8), protection_yaw_part_10), protection_yaw_part_12);
        const float separated =
            hall_position_four_max(hall_position_four_max(hall_position_four_max(protection_yaw_part_5,
            protection_yaw_part_7), protection_yaw_part_9), protection_yaw_part_11) + (0.19147325f *
            sqrtf(terms_1_protection_phase_x_5 + (terms_1_protection_phase_x_8 * terms_1_protection_phase_x_8 *
            protection_phase_x_part_4) + added_protection_yaw));
        level = separated;
    }
    const bool passes = (left_1_1_protection_phase_x <= 12104.0f) && (left_2_2_protection_phase_x <= 12104.0f) &&
        (left_3_3_protection_phase_x <= 75650.0f) && (left_4_4_protection_phase_x <= 18912.5f) && (cost_chi_square_2 <=
        (0.003026f * limit));
    const bool detectable = (gains_1 < 999.99f) && (gains_2 < 999.99f) && (gains_3 < 999.99f) && (gains_4 < 999.99f) &&
        (gains_5 < 999.99f) && (gains_6 < 999.99f) && (gains_7 < 999.99f) && (gain < 999.99f);
    if (!detectable) {
        protection_phase_x_part_46 = 61.842377f;
        protection_phase_y_part_5 = 61.842377f;
        level = 22.0f;
    }
    const float protection_phase_x = hall_position_four_min(protection_phase_x_part_46, 61.842377f);
    const float protection_phase_y = hall_position_four_min(protection_phase_y_part_5, 61.842377f);
    const float protection_yaw = hall_position_four_min(level, 22.0f);
    const uint32_t estimator_start_number = state->estimator_start_number;
    const bool tracking = 24u <= estimator_start_number;
    const uint32_t estimator_missed = state->estimator_missed;
    const bool lost = 8u <= estimator_missed;
    const bool phases_valid = converged && phases_valid_test && passes && detectable && (protection_phase_x <=
        0.61842376f) && (protection_phase_y <= 0.61842376f) && (protection_yaw <= 0.22f) && tracking && !lost;
    out->yaw = yaw;
    out->amplitude = amplitude;
    out->deviation_yaw = deviation_yaw;
    out->deviation_amplitude = deviation_amplitude;
    out->protection_yaw = protection_yaw;
    out->chi_square = chi_square;
    out->converged = converged ? 1.0f : 0.0f;
    out->weak = weak ? 1.0f : 0.0f;
    out->excluded = excluded;
    out->tracking = tracking ? 1.0f : 0.0f;
    const bool accepted = phases_valid_test && passes;
    float track_phase_x = phase_x;
    float track_phase_y = phase_y;
    float track_yaw = yaw;
    float track_amplitude = amplitude;
    float estimator_motion_phase_x_part = estimator_motion_phase_x;
    float estimator_motion_phase_y_part = estimator_motion_phase_y;
    float estimator_motion_yaw_part = estimator_motion_yaw;
    if (accepted) {
        if (fabsf(reported_phase_x_2) < 0.5f) {
            estimator_motion_phase_x_part = estimator_motion_phase_x + (0.5f * reported_phase_x_2);
        } else {
            estimator_motion_phase_x_part = 0.0f;
        }
        if (fabsf(reported_phase_y) < 0.5f) {
            estimator_motion_phase_y_part = estimator_motion_phase_y + (0.5f * reported_phase_y);
        } else {
            estimator_motion_phase_y_part = 0.0f;
        }
        if (fabsf(reported_phase_x) < 0.1f) {
            estimator_motion_yaw_part = estimator_motion_yaw + (0.5f * reported_phase_x);
        } else {
            estimator_motion_yaw_part = 0.0f;
        }
    } else {
        track_phase_x = starts_1;
        track_phase_y = starts_2;
        track_yaw = starts_3;
        track_amplitude = estimator_amplitude;
    }
    const uint32_t estimator_age = state->estimator_age;
    const bool ends = converged || (3u <= estimator_age);
    const bool last = ends && (23u <= estimator_start_number);
    const uint32_t estimator_candidates = state->estimator_candidates;
    const bool solves = converged && accepted;
    const bool first = estimator_candidates == 0u;
    const float estimator_candidate_phase_x = state->estimator_candidate_phase_x;
    const float apart_estimator_phase_x = fabsf(phase_x - estimator_candidate_phase_x);
    const float estimator_candidate_phase_y = state->estimator_candidate_phase_y;
    const float apart_estimator_phase_x_2 = fabsf(phase_y - estimator_candidate_phase_y);
    const float estimator_candidate_yaw = state->estimator_candidate_yaw;
    const float estimator_phase_x_part = 2.0f - ((first || ((hall_position_four_min(apart_estimator_phase_x,
        fabsf(apart_estimator_phase_x - two_pi)) <= 0.15f) && (hall_position_four_min(apart_estimator_phase_x_2,
        fabsf(apart_estimator_phase_x_2 - two_pi)) <= 0.15f) && (fabsf(yaw - estimator_candidate_yaw) <= 0.05f))) ? 1.0f
        : 0.0f);
    const float count = hall_position_four_max((float)estimator_candidates, (solves ? 1.0f : 0.0f) *
        estimator_phase_x_part);
    const bool unique = last && hall_position_four_equal(count, 1.0f);
    float candidate_phase_x = phase_x;
    float candidate_phase_y = phase_y;
    float tracked_2_candidate_yaw = yaw;
    float candidate_amplitude = amplitude;
    if (first && solves) {
        state->estimator_candidate_phase_x = phase_x;
        state->estimator_candidate_phase_y = phase_y;
        state->estimator_candidate_yaw = yaw;
        state->estimator_candidate_amplitude = amplitude;
    } else {
        candidate_phase_x = estimator_candidate_phase_x;
        candidate_phase_y = estimator_candidate_phase_y;
        tracked_2_candidate_yaw = estimator_candidate_yaw;
        candidate_amplitude = state->estimator_candidate_amplitude;
    }
    float estimator_phase_x_part_2 = phase_x;
    float estimator_phase_y_part = phase_y;
    float estimator_yaw_part = yaw;
    float estimator_amplitude_part = 1.0f;
    if (ends) {
        const float estimator_phase_x_part_3 = state->estimator_begin_phase_x + 5.1470127f;
        if (pi < estimator_phase_x_part_3) {
            const float estimator_phase_x_part_4 = estimator_phase_x_part_3 - two_pi;
            estimator_phase_x_part_2 = estimator_phase_x_part_4;
            state->estimator_begin_phase_x = estimator_phase_x_part_4;
        } else {
            estimator_phase_x_part_2 = estimator_phase_x_part_3;
            state->estimator_begin_phase_x = estimator_phase_x_part_3;
        }
        const float estimator_phase_y_part_2 = state->estimator_begin_phase_y + 4.2162914f;
        if (pi < estimator_phase_y_part_2) {
            const float estimator_phase_y_part_3 = estimator_phase_y_part_2 - two_pi;
            estimator_phase_y_part = estimator_phase_y_part_3;
            state->estimator_begin_phase_y = estimator_phase_y_part_3;
        } else {
            estimator_phase_y_part = estimator_phase_y_part_2;
            state->estimator_begin_phase_y = estimator_phase_y_part_2;
        }
        const float estimator_yaw_part_2 = state->estimator_begin_yaw + 0.230258f;
        if (0.20943952f < estimator_yaw_part_2) {
            const float estimator_yaw_part_3 = estimator_yaw_part_2 - 0.41887903f;
            estimator_yaw_part = estimator_yaw_part_3;
            state->estimator_begin_yaw = estimator_yaw_part_3;
        } else {
            estimator_yaw_part = estimator_yaw_part_2;
            state->estimator_begin_yaw = estimator_yaw_part_2;
        }
    } else {
        estimator_amplitude_part = amplitude;
    }
    if (tracking) {
        state->estimator_phase_x = track_phase_x;
        state->estimator_phase_y = track_phase_y;
        state->estimator_yaw = track_yaw;
        state->estimator_amplitude = track_amplitude;
        state->estimator_start_number = 24u;
    } else {
        if (unique) {
            state->estimator_phase_x = candidate_phase_x;
            state->estimator_phase_y = candidate_phase_y;
            state->estimator_yaw = tracked_2_candidate_yaw;
            state->estimator_amplitude = candidate_amplitude;
        } else {
            state->estimator_phase_x = estimator_phase_x_part_2;
            state->estimator_phase_y = estimator_phase_y_part;
            state->estimator_yaw = estimator_yaw_part;
            state->estimator_amplitude = estimator_amplitude_part;
        }
        if (last) {
            const float estimator_start_number_part = 24.0f * (unique ? 1.0f : 0.0f);
            state->estimator_start_number = (uint32_t)estimator_start_number_part;
        } else {
            const uint32_t estimator_start_number_part_2 = estimator_start_number + hall_position_four_flag(ends);
            state->estimator_start_number = (uint32_t)hall_position_four_min((float)estimator_start_number_part_2,
                23.0f);
        }
    }
    state->estimator_motion_phase_x = hall_position_four_limit((tracking ? 1.0f : 0.0f) * estimator_motion_phase_x_part,
        0.5f);
    state->estimator_motion_phase_y = hall_position_four_limit((tracking ? 1.0f : 0.0f) * estimator_motion_phase_y_part,
        0.5f);
    state->estimator_motion_yaw = hall_position_four_limit((tracking ? 1.0f : 0.0f) * estimator_motion_yaw_part, 0.1f);
    float best = 0.0f;
    if (!(full_cost <= 0.06207841f)) {
        const float costs_2_min_costs_1 = hall_position_four_min(costs_2, costs_1);
        if (costs_4 < hall_position_four_min(costs_3, costs_2_min_costs_1)) {
            best = 4.0f;
        } else {
            best = (costs_3 < costs_2_min_costs_1) ? 3.0f : ((costs_2 < costs_1) ? 2.0f : 1.0f);
        }
    }
    const float tracked_2_excluded = (tracking ? 1.0f : 0.0f) * hall_position_four_max(best, 0.0f);
    state->estimator_excluded = (uint32_t)tracked_2_excluded;
    const bool searching = !tracking;
    const float tracked_2_candidates = ((searching && (!last || unique)) ? 1.0f : 0.0f) * count;
    state->estimator_candidates = (uint32_t)tracked_2_candidates;
    const uint32_t estimator_missed_part = estimator_missed + 1u;
    const float tracked_2_missed = ((tracking && (lost || !accepted)) ? 1.0f : 0.0f) *
        hall_position_four_min((float)estimator_missed_part, 8.0f);
    state->estimator_missed = (uint32_t)tracked_2_missed;
    const uint32_t estimator_age_part = estimator_age + 1u;
    const float tracked_2_age = ((searching && !ends) ? 1.0f : 0.0f) * hall_position_four_min((float)estimator_age_part,
        3.0f);
    state->estimator_age = (uint32_t)tracked_2_age;
    out->lost = lost ? 1.0f : 0.0f;

    /* metres
     *     valid = phases_valid and |pitch_x_next| <= 8 and |pitch_y_next| <= 8
     *     pitch_x_next = limit((pitch_x + (|pitch_x| <= 8 and (tracking and counting)) * ((phase_x - last_x <
     *         -pi) - (pi < phase_x - last_x))) * tracking, 9); likewise pitch_y_next */
    const float metres_pitch_x = state->metres_pitch_x;
    const uint32_t metres_counting = state->metres_counting;
    const bool tracking_and_metres_counting = tracking && (metres_counting != 0u);
    const float change_x = phase_x - state->metres_last_x;
    const float wraps_x = (((fabsf(metres_pitch_x) <= 8.0f) && tracking_and_metres_counting) ? 1.0f : 0.0f) *
        (((change_x < -pi) ? 1.0f : 0.0f) - ((pi < change_x) ? 1.0f : 0.0f));
    const float count_x = hall_position_four_limit((metres_pitch_x + wraps_x) * (tracking ? 1.0f : 0.0f), 9.0f);
    const float X = (0.008085071f * phase_x) + (0.0508f * count_x);
    out->X = X;
    const float metres_pitch_y = state->metres_pitch_y;
    const float change_y = phase_y - state->metres_last_y;
    const float wraps_y = (((fabsf(metres_pitch_y) <= 8.0f) && tracking_and_metres_counting) ? 1.0f : 0.0f) *
        (((change_y < -pi) ? 1.0f : 0.0f) - ((pi < change_y) ? 1.0f : 0.0f));
    const float count_y = hall_position_four_limit((metres_pitch_y + wraps_y) * (tracking ? 1.0f : 0.0f), 9.0f);
    const float Y = (0.008085071f * phase_y) + (0.0508f * count_y);
    out->Y = Y;
    const float deviation_X = 0.008085071f * deviation_phase_x;
    out->deviation_X = deviation_X;
    const float deviation_Y = 0.008085071f * deviation_phase_y;
    out->deviation_Y = deviation_Y;
    const float protection_X = 0.008085071f * protection_phase_x;
    out->protection_X = protection_X;
    const float protection_Y = 0.008085071f * protection_phase_y;
    out->protection_Y = protection_Y;
    const bool valid = phases_valid && (fabsf(count_x) <= 8.0f) && (fabsf(count_y) <= 8.0f);
    state->metres_last_x = phase_x;
    state->metres_last_y = phase_y;
    state->metres_pitch_x = count_x;
    state->metres_pitch_y = count_y;
    state->metres_counting = hall_position_four_flag(tracking);
    out->valid = valid ? 1.0f : 0.0f;
#if defined(HALL_POSITION_FOUR_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->screened = screened ? 1.0f : 0.0f;
        diagnostics->rejected = rejected;
        diagnostics->phase_x = phase_x;
        diagnostics->phase_y = phase_y;
        diagnostics->deviation_phase_x = deviation_phase_x;
        diagnostics->deviation_phase_y = deviation_phase_y;
        diagnostics->protection_phase_x = protection_phase_x;
        diagnostics->protection_phase_y = protection_phase_y;
        diagnostics->phases_valid = phases_valid ? 1.0f : 0.0f;
        diagnostics->saturated |= (fabsf(phase_x) >= pi) ? 0x00000001u : 0u;
        diagnostics->saturated |= (fabsf(phase_y) >= pi) ? 0x00000002u : 0u;
        diagnostics->saturated |= (fabsf(yaw) >= 0.20943952f) ? 0x00000004u : 0u;
    }
#endif

#if defined(HALL_POSITION_FOUR_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->faults = faults;
        if ((diagnostics->latch_cause == 0u) && ((faults & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = faults;
        }
    }
#endif
    return faults;
}
