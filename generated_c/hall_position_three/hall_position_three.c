/* hall_position_three. Generated: do not edit. */
#include "hall_position_three.h"
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

/* f1_polynomial for estimator_yaw + estimator_motion_yaw in -3.28181362 .. 3.28181362: f1_polynomial / x, t = x^2, x = estimator_yaw + estimator_motion_yaw;
 * relative error at most 1.2e-07. */
static inline float f1_polynomial(float t)
{
    return 0.25f + (t * (-0.0026041642f + (t * (8.136648e-06f + (t * -1.18924985e-08f)))));
}

/* yaw_fraction_cosine for estimator_yaw + estimator_motion_yaw in -3.28181362 .. 3.28181362: t = x^2, x = estimator_yaw + estimator_motion_yaw;
 * relative error at most 1.4e-07. */
static inline float yaw_fraction_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.031249862f + (t * (0.00016270163f + (t * -3.3074548e-07f)))));
}

/* f3_polynomial for (estimator_phase_x + estimator_motion_x) + ((-1.5812683 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (1.5833627 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -6.80622387 .. 6.80622435: f3_polynomial / x, t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((-1.5812683 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (1.5833627 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.2e-07. */
static inline float f3_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552044f + (t * (2.5426283e-07f + (t * -9.2772345e-11f)))));
}

/* phase_fraction_cosine for (estimator_phase_x + estimator_motion_x) + ((-1.5812683 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (1.5833627 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -6.80622387 .. 6.80622435: t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((-1.5812683 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (1.5833627 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124604f + (t * (1.01684145e-05f + (t * -5.1597757e-09f)))));
}

/* f5_polynomial for (estimator_phase_y + estimator_motion_y) + ((1.5833627 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (1.5812683 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -6.80622435 .. 6.80622387: f5_polynomial / x, t = x^2, x = (estimator_phase_y + estimator_motion_y) + ((1.5833627 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (1.5812683 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.2e-07. */
static inline float f5_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552044f + (t * (2.5426283e-07f + (t * -9.2772345e-11f)))));
}

/* phase_fraction_cosine for (estimator_phase_y + estimator_motion_y) + ((1.5833627 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (1.5812683 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -6.80622435 .. 6.80622387: t = x^2, x = (estimator_phase_y + estimator_motion_y) + ((1.5833627 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (1.5812683 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_2_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124604f + (t * (1.01684145e-05f + (t * -5.1597757e-09f)))));
}

/* f7_polynomial for (estimator_phase_x + estimator_motion_x) + ((-0.0858701992 * (1 - (0.5 * ((...) * (...))))) - (0.081681409 * clamp((clamp((...), -2, 2) * (1 - (...))), -1, 1))) in -3.80914426 .. 3.8091445: f7_polynomial / x, t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((-0.0858701992 * (1 - (0.5 * ((...) * (...))))) - (0.081681409 * clamp((clamp((...), -2, 2) * (1 - (...))), -1, 1)));
 * relative error at most 1.7e-07. */
static inline float f7_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551005f + (t * 2.5227982e-07f)));
}

/* phase_fraction_cosine for (estimator_phase_x + estimator_motion_x) + ((-0.0858701992 * (1 - (0.5 * ((...) * (...))))) - (0.081681409 * clamp((clamp((...), -2, 2) * (1 - (...))), -1, 1))) in -3.80914426 .. 3.8091445: t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((-0.0858701992 * (1 - (0.5 * ((...) * (...))))) - (0.081681409 * clamp((clamp((...), -2, 2) * (1 - (...))), -1, 1)));
 * relative error at most 6e-08. */
static inline float phase_fraction_cosine_3_polynomial(float t)
{
    return 1.0f + (t * (-0.007812499f + (t * (1.017216e-05f + (t * -5.2561466e-09f)))));
}

/* f9_polynomial for (estimator_phase_y + estimator_motion_y) + ((0.081681409 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (0.0858701992 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -3.8091445 .. 3.80914426: f9_polynomial / x, t = x^2, x = (estimator_phase_y + estimator_motion_y) + ((0.081681409 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (0.0858701992 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.7e-07. */
static inline float f9_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551005f + (t * 2.5227982e-07f)));
}

/* phase_fraction_cosine for (estimator_phase_y + estimator_motion_y) + ((0.081681409 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (0.0858701992 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -3.8091445 .. 3.80914426: t = x^2, x = (estimator_phase_y + estimator_motion_y) + ((0.081681409 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (0.0858701992 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 6e-08. */
static inline float phase_fraction_cosine_4_polynomial(float t)
{
    return 1.0f + (t * (-0.007812499f + (t * (1.017216e-05f + (t * -5.2561466e-09f)))));
}

/* f11_polynomial for (estimator_phase_x + estimator_motion_x) + ((1.6671385 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) + (1.66504411 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -6.97377586 .. 6.97377586: f11_polynomial / x, t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((1.6671385 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) + (1.66504411 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.2e-07. */
static inline float f11_polynomial(float t)
{
    return 0.125f + (t * (-0.00032552038f + (t * (2.5425797e-07f + (t * -9.268511e-11f)))));
}

/* phase_fraction_cosine for (estimator_phase_x + estimator_motion_x) + ((1.6671385 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) + (1.66504411 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -6.97377586 .. 6.97377586: t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((1.6671385 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) + (1.66504411 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.9e-07. */
static inline float phase_fraction_cosine_5_polynomial(float t)
{
    return 0.99999994f + (t * (-0.0078124558f + (t * (1.016805e-05f + (t * -5.1534967e-09f)))));
}

/* yaw_change_sine for clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (0.874383744 + (((...) * (...)) + ((...) * (...))))), -0.140220856, 0.140220856) in -0.140220851 .. 0.140220851: yaw_change_sine / x, t = x^2, x = clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (0.874383744 + (((...) * (...)) + ((...) * (...))))), -0.140220856, 0.140220856);
 * relative error at most 1.2e-07. */
static inline float yaw_change_sine_polynomial(float t)
{
    return 1.0f + (t * (-0.16666663f + (t * 0.008327514f)));
}

/* half_yaw_change_sine for clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (0.874383744 + (((...) * (...)) + ((...) * (...))))), -0.140220856, 0.140220856) in -0.140220851 .. 0.140220851: half_yaw_change_sine / x, t = x^2, x = clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (0.874383744 + (((...) * (...)) + ((...) * (...))))), -0.140220856, 0.140220856);
 * relative error at most 1.4e-07. */
static inline float half_yaw_change_sine_polynomial(float t)
{
    return 0.70710677f + (t * -0.02945674f);
}

/* f15_polynomial for clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.973355532 .. 0.973355532: t = x^2, x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine));
 * relative error at most 1.3e-07. */
static inline float f15_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666433f + (t * (-0.0013882653f + (t * 2.410944e-05f)))))));
}

/* f16_polynomial for clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.973355532 .. 0.973355532: f16_polynomial / x, t = x^2, x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine));
 * relative error at most 1.2e-07. */
static inline float f16_polynomial(float t)
{
    return 1.0f + (t * (-0.16666621f + (t * (0.008330511f + (t * -0.00019337481f)))));
}

/* f17_polynomial for clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.525061905 .. 0.525061905: t = x^2, x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine));
 * relative error at most 6e-08. */
static inline float f17_polynomial(float t)
{
    return 1.0f + (t * (-0.4999999f + (t * (0.041664626f + (t * -0.0013759097f)))));
}

/* f18_polynomial for clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.525061905 .. 0.525061905: f18_polynomial / x, t = x^2, x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine));
 * relative error at most 2.3e-07. */
static inline float f18_polynomial(float t)
{
    return 0.9999999f + (t * (-0.16665833f + (t * 0.008251845f)));
}

/* f19_polynomial for clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) + (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.998417377 .. 0.998417377: t = x^2, x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) + (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine));
 * relative error at most 1.4e-07. */
static inline float f19_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666426f + (t * (-0.0013882434f + (t * 2.4094079e-05f)))))));
}

/* f20_polynomial for clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) + (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.998417377 .. 0.998417377: f20_polynomial / x, t = x^2, x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) + (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine));
 * relative error at most 1.2e-07. */
static inline float f20_polynomial(float t)
{
    return 1.0f + (t * (-0.16666614f + (t * (0.008330212f + (t * -0.00019311559f)))));
}

void hall_position_three_init(hall_position_three_state_t *state)
{
    state->guard_last_V_ax = 0.0f;
    state->guard_last_V_ay = 0.0f;
    state->guard_last_V_bx = 0.0f;
    state->guard_last_V_by = 0.0f;
    state->guard_last_V_cx = 0.0f;
    state->guard_last_V_cy = 0.0f;
    state->guard_left = 5u;
    state->guard_latched = 0u;
    state->guard_ready = 0u;
    state->estimator_phase_x = 0.0f;
    state->estimator_phase_y = 0.0f;
    state->estimator_yaw = 0.0f;
    state->estimator_yaw_last_good = 0.0f;
    state->estimator_start_x = 0.0f;
    state->estimator_start_y = 0.0f;
    state->estimator_pitch_x = 0.0f;
    state->estimator_pitch_y = 0.0f;
    state->estimator_motion_x = 0.0f;
    state->estimator_motion_y = 0.0f;
    state->estimator_motion_yaw = 0.0f;
    state->estimator_residual_faults = 0u;
    state->estimator_searching = 1u;
    state->estimator_ambiguity_resolved = 0u;
    state->estimator_acquired = 0u;
    state->estimator_lock_lost = 0u;
    state->estimator_excluded_sensor = 0u;
}

uint32_t hall_position_three_step(hall_position_three_state_t *state, const hall_position_three_input_t *in, hall_position_three_output_t *out)
{
    static const float estimator_field_1 = 2.24906f;            /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_3 = 3.60456f;            /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_5 = -2.883648f;          /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_slope_0 = 2.24906f;            /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_2 = 10.81368f;           /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_4 = -14.41824f;          /* V; coefficient of the field's derivative by the phase p, by powers of sin p */

    /* guard: range acceptance, hold, latch */
    const float V_ax = in->V_ax;
    const bool t1 = fabsf(V_ax) <= 5.0f;
    float V_ax_held = V_ax;
    bool complete = true;
    uint32_t faults = 0u;
    if (t1) {
        state->guard_last_V_ax = V_ax;
    } else {
        V_ax_held = state->guard_last_V_ax;
        complete = false;
        faults = 0x00000001u;
    }
    const float V_ay = in->V_ay;
    const bool t2 = fabsf(V_ay) <= 5.0f;
    float V_ay_held = V_ay;
    if (t2) {
        state->guard_last_V_ay = V_ay;
    } else {
        V_ay_held = state->guard_last_V_ay;
        complete = false;
        faults |= 0x00000002u;
    }
    const float V_bx = in->V_bx;
    const bool t3 = fabsf(V_bx) <= 5.0f;
    float V_bx_held = V_bx;
    if (t3) {
        state->guard_last_V_bx = V_bx;
    } else {
        V_bx_held = state->guard_last_V_bx;
        complete = false;
        faults |= 0x00000004u;
    }
    const float V_by = in->V_by;
    const bool t4 = fabsf(V_by) <= 5.0f;
    float V_by_held = V_by;
    if (t4) {
        state->guard_last_V_by = V_by;
    } else {
        V_by_held = state->guard_last_V_by;
        complete = false;
        faults |= 0x00000008u;
    }
    const float V_cx = in->V_cx;
    const bool t5 = fabsf(V_cx) <= 5.0f;
    float V_cx_held = V_cx;
    if (t5) {
        state->guard_last_V_cx = V_cx;
    } else {
        V_cx_held = state->guard_last_V_cx;
        complete = false;
        faults |= 0x00000010u;
    }
    const float V_cy = in->V_cy;
    const bool t6 = fabsf(V_cy) <= 5.0f;
    float V_cy_held = V_cy;
    if (t6) {
        state->guard_last_V_cy = V_cy;
    } else {
        V_cy_held = state->guard_last_V_cy;
        complete = false;
        faults |= 0x00000020u;
    }
    const bool fault_V_ax = !t1;
    const bool fault_V_ay = !t2;
    const bool fault_V_bx = !t3;
    const bool fault_V_by = !t4;
    const bool fault_V_cx = !t5;
    const bool fault_V_cy = !t6;
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

    /* estimator: GLSDC, Fig. 9 */
    const float estimator_yaw = state->estimator_yaw;
    const float estimator_motion_yaw = state->estimator_motion_yaw;
    const float t7 = estimator_yaw + estimator_motion_yaw;
    const float t8 = t7 * t7;
    const float t9 = t7 * f1_polynomial(t8);
    const float yaw_fraction_sine = 4.0f * t9;
    const float yaw_fraction_cosine = yaw_fraction_cosine_polynomial(t8);
    const float estimator_phase_x = state->estimator_phase_x;
    const float estimator_motion_x = state->estimator_motion_x;
    const float t10 = estimator_phase_x + estimator_motion_x;
    const float t11 = limit(4.0f * (t9 * yaw_fraction_cosine), 2.0f);
    const float t12 = 1.0f - (0.5f * (t11 * t11));
    const float t13 = limit(t11 * (1.0f - (0.125f * (yaw_fraction_sine * yaw_fraction_sine))), 1.0f);
    const float t14 = (-1.5812683f * t12) - (1.5833627f * t13);
    const float t15 = t10 + t14;
    const float t16 = t15 * t15;
    const float t17 = t15 * f3_polynomial(t16);
    const float phase_fraction_sine = 8.0f * t17;
    const float phase_fraction_cosine = phase_fraction_cosine_polynomial(t16);
    const float estimator_phase_y = state->estimator_phase_y;
    const float estimator_motion_y = state->estimator_motion_y;
    const float t18 = estimator_phase_y + estimator_motion_y;
    const float t19 = (1.5833627f * t12) - (1.5812683f * t13);
    const float t20 = t18 + t19;
    const float t21 = t20 * t20;
    const float t22 = t20 * f5_polynomial(t21);
    const float phase_fraction_sine_2 = 8.0f * t22;
    const float phase_fraction_cosine_2 = phase_fraction_cosine_2_polynomial(t21);
    const float t23 = (-0.0858702f * t12) - (0.08168141f * t13);
    const float t24 = t10 + t23;
    const float t25 = t24 * t24;
    const float t26 = t24 * f7_polynomial(t25);
    const float phase_fraction_sine_3 = 8.0f * t26;
    const float phase_fraction_cosine_3 = phase_fraction_cosine_3_polynomial(t25);
    const float t27 = (0.08168141f * t12) - (0.0858702f * t13);
    const float t28 = t18 + t27;
    const float t29 = t28 * t28;
    const float t30 = t28 * f9_polynomial(t29);
    const float phase_fraction_sine_4 = 8.0f * t30;
    const float phase_fraction_cosine_4 = phase_fraction_cosine_4_polynomial(t29);
    const float t31 = (1.6671385f * t12) + (1.6650441f * t13);
    const float t32 = t10 + t31;
    const float t33 = t32 * t32;
    const float t34 = t32 * f11_polynomial(t33);
    const float phase_fraction_sine_5 = 8.0f * t34;
    const float phase_fraction_cosine_5 = phase_fraction_cosine_5_polynomial(t33);
    const float t35 = (1.6671385f * t13) - (1.6650441f * t12);
    const float t36 = t18 + t35;
    const float t37 = t36 * t36;
    const float t38 = t36 * f11_polynomial(t37);
    const float phase_fraction_sine_6 = 8.0f * t38;
    const float phase_fraction_cosine_6 = phase_fraction_cosine_5_polynomial(t37);
    const uint32_t estimator_excluded_sensor = state->estimator_excluded_sensor;
    const bool t39 = fault_V_ax || fault_V_ay || (estimator_excluded_sensor == 1u);
    const float t40 = 1.0f - (t39 ? 1.0f : 0.0f);
    const float t41 = t40 * V_ax_held;
    const float t42 = t40 * V_ay_held;
    const float t43 = (t12 * t41) - (t13 * t42);
    const float t44 = t17 * phase_fraction_cosine;
    const float t45 = limit(8.0f * (t44 * (1.0f - (0.03125f * (phase_fraction_sine * phase_fraction_sine)))), 2.0f);
    const float t46 = 8.0f * t44;
    const float t47 = limit(t45 * (1.0f - (0.125f * (t46 * t46))), 1.0f);
    const float t48 = t40 * estimator_field_1;
    const float t49 = t47 * t47;
    const float t50 = t40 * estimator_field_3;
    const float t51 = t40 * estimator_field_5;
    const float t52 = t47 * (t48 + (t49 * (t50 + (t49 * t51))));
    const float t53 = t43 - t52;
    const float t54 = t53 * t53;
    const bool t55 = fault_V_bx || fault_V_by || (estimator_excluded_sensor == 2u);
    const float t56 = 1.0f - (t55 ? 1.0f : 0.0f);
    const float t57 = t56 * V_bx_held;
    const float t58 = t56 * V_by_held;
    const float t59 = (t12 * t57) - (t13 * t58);
    const float t60 = t26 * phase_fraction_cosine_3;
    const float t61 = limit(8.0f * (t60 * (1.0f - (0.03125f * (phase_fraction_sine_3 * phase_fraction_sine_3)))), 2.0f);
    const float t62 = 8.0f * t60;
    const float t63 = limit(t61 * (1.0f - (0.125f * (t62 * t62))), 1.0f);
    const float t64 = t56 * estimator_field_1;
    const float t65 = t63 * t63;
    const float t66 = t56 * estimator_field_3;
    const float t67 = t56 * estimator_field_5;
    const float t68 = t63 * (t64 + (t65 * (t66 + (t65 * t67))));
    const float t69 = t59 - t68;
    const float t70 = t69 * t69;
    const bool t71 = fault_V_cx || fault_V_cy || (estimator_excluded_sensor == 3u);
    const float t72 = 1.0f - (t71 ? 1.0f : 0.0f);
    const float t73 = t72 * V_cx_held;
    const float t74 = t72 * V_cy_held;
    const float t75 = (t12 * t73) - (t13 * t74);
    const float t76 = t34 * phase_fraction_cosine_5;
    const float t77 = limit(8.0f * (t76 * (1.0f - (0.03125f * (phase_fraction_sine_5 * phase_fraction_sine_5)))), 2.0f);
    const float t78 = 8.0f * t76;
    const float t79 = limit(t77 * (1.0f - (0.125f * (t78 * t78))), 1.0f);
    const float t80 = t72 * estimator_field_1;
    const float t81 = t79 * t79;
    const float t82 = t72 * estimator_field_3;
    const float t83 = t72 * estimator_field_5;
    const float t84 = t79 * (t80 + (t81 * (t82 + (t81 * t83))));
    const float t85 = t75 - t84;
    const float t86 = t85 * t85;
    const float t87 = (t13 * t41) + (t12 * t42);
    const float t88 = t22 * phase_fraction_cosine_2;
    const float t89 = limit(8.0f * (t88 * (1.0f - (0.03125f * (phase_fraction_sine_2 * phase_fraction_sine_2)))), 2.0f);
    const float t90 = 8.0f * t88;
    const float t91 = limit(t89 * (1.0f - (0.125f * (t90 * t90))), 1.0f);
    const float t92 = t91 * t91;
    const float t93 = t91 * (t48 + (t92 * (t50 + (t92 * t51))));
    const float t94 = t87 - t93;
    const float t95 = t94 * t94;
    const float t96 = (t13 * t57) + (t12 * t58);
    const float t97 = t30 * phase_fraction_cosine_4;
    const float t98 = limit(8.0f * (t97 * (1.0f - (0.03125f * (phase_fraction_sine_4 * phase_fraction_sine_4)))), 2.0f);
    const float t99 = 8.0f * t97;
    const float t100 = limit(t98 * (1.0f - (0.125f * (t99 * t99))), 1.0f);
    const float t101 = t100 * t100;
    const float t102 = t100 * (t64 + (t101 * (t66 + (t101 * t67))));
    const float t103 = t96 - t102;
    const float t104 = t103 * t103;
    const float t105 = (t13 * t73) + (t12 * t74);
    const float t106 = t38 * phase_fraction_cosine_6;
    const float t107 = limit(8.0f * (t106 * (1.0f - (0.03125f * (phase_fraction_sine_6 * phase_fraction_sine_6)))), 2.0f);
    const float t108 = 8.0f * t106;
    const float t109 = limit(t107 * (1.0f - (0.125f * (t108 * t108))), 1.0f);
    const float t110 = t109 * t109;
    const float t111 = t109 * (t80 + (t110 * (t82 + (t110 * t83))));
    const float t112 = t105 - t111;
    const float t113 = t112 * t112;
    const float cost_0 = t54 + t70 + t86 + t95 + t104 + t113;
    const float t114 = 1.0f - (0.5f * (t45 * t45));
    const float t115 = t40 * estimator_slope_0;
    const float t116 = t40 * estimator_slope_2;
    const float t117 = t40 * estimator_slope_4;
    const float t118 = t114 * (t115 + (t49 * (t116 + (t49 * t117))));
    const float t119 = t93 - (t118 * t19);
    const float t120 = 1.0f - (0.5f * (t61 * t61));
    const float t121 = t56 * estimator_slope_0;
    const float t122 = t56 * estimator_slope_2;
    const float t123 = t56 * estimator_slope_4;
    const float t124 = t120 * (t121 + (t65 * (t122 + (t65 * t123))));
    const float t125 = t102 - (t124 * t27);
    const float t126 = 1.0f - (0.5f * (t77 * t77));
    const float t127 = t72 * estimator_slope_0;
    const float t128 = t72 * estimator_slope_2;
    const float t129 = t72 * estimator_slope_4;
    const float t130 = t126 * (t127 + (t81 * (t128 + (t81 * t129))));
    const float t131 = t111 - (t130 * t35);
    const float t132 = (t118 * t125) - (t124 * t119);
    const float t133 = (t118 * t131) - (t130 * t119);
    const float t134 = (0.00992376f * ((t119 * t53) + (t125 * t69) + (t131 * t85))) + (t132 * ((t118 * t69) - (t124 * t53))) + (t133 * ((t118 * t85) - (t130 * t53)));
    const float t135 = (t124 * t131) - (t130 * t125);
    const float t136 = 1.0f / (0.00992376f + ((t118 * t118) + (t124 * t124) + (t130 * t130)));
    const float t137 = 1.0f - (0.5f * (t89 * t89));
    const float t138 = t137 * (t115 + (t92 * (t116 + (t92 * t117))));
    const float t139 = (t138 * t14) - t52;
    const float t140 = 1.0f - (0.5f * (t98 * t98));
    const float t141 = t140 * (t121 + (t101 * (t122 + (t101 * t123))));
    const float t142 = (t141 * t23) - t68;
    const float t143 = 1.0f - (0.5f * (t107 * t107));
    const float t144 = t143 * (t127 + (t110 * (t128 + (t110 * t129))));
    const float t145 = (t144 * t31) - t84;
    const float t146 = (t138 * t142) - (t141 * t139);
    const float t147 = (t138 * t145) - (t144 * t139);
    const float t148 = (0.00992376f * ((t139 * t94) + (t142 * t103) + (t145 * t112))) + (t146 * ((t138 * t103) - (t141 * t94))) + (t147 * ((t138 * t112) - (t144 * t94)));
    const float t149 = (t141 * t145) - (t144 * t142);
    const float t150 = 1.0f / (0.00992376f + ((t138 * t138) + (t141 * t141) + (t144 * t144)));
    const float t151 = ((t134 + (t135 * ((t124 * t85) - (t130 * t69)))) * t136) + ((t148 + (t149 * ((t141 * t112) - (t144 * t103)))) * t150);
    const float t152 = (0.00992376f * ((t119 * t119) + (t125 * t125) + (t131 * t131))) + (t132 * t132) + (t133 * t133) + (t135 * t135);
    const float t153 = (0.00992376f * ((t139 * t139) + (t142 * t142) + (t145 * t145))) + (t146 * t146) + (t147 * t147) + (t149 * t149);
    const float t154 = limit(t151 / (0.87438375f + ((t152 * t136) + (t153 * t150))), 0.14022085f);
    const float t155 = t154 * t154;
    const float yaw_change_sine = t154 * yaw_change_sine_polynomial(t155);
    const float half_yaw_change_sine = t154 * half_yaw_change_sine_polynomial(t155);
    const float t156 = half_yaw_change_sine * half_yaw_change_sine;
    const float t157 = 1.0f - t156;
    const float t158 = ((t118 * t53) + (t124 * t69) + (t130 * t85) - (((t118 * t119) + (t124 * t125) + (t130 * t131)) * t154)) * t136;
    const float t159 = limit(t158, 0.5f);
    const float t160 = (t14 * t156) + (t19 * yaw_change_sine);
    const float t161 = t159 - t160;
    const float t162 = t161 * t161;
    const float t163 = f15_polynomial(t162);
    const float t164 = t161 * f16_polynomial(t162);
    const float t165 = (t47 * t163) + (t114 * t164);
    const float t166 = t165 * t165;
    const float t167 = t165 * (t48 + (t166 * (t50 + (t166 * t51))));
    const float t168 = (t43 * t157) - (t87 * yaw_change_sine) - t167;
    const float t169 = (t23 * t156) + (t27 * yaw_change_sine);
    const float t170 = t159 - t169;
    const float t171 = t170 * t170;
    const float t172 = f17_polynomial(t171);
    const float t173 = t170 * f18_polynomial(t171);
    const float t174 = (t63 * t172) + (t120 * t173);
    const float t175 = t174 * t174;
    const float t176 = t174 * (t64 + (t175 * (t66 + (t175 * t67))));
    const float t177 = (t59 * t157) - (t96 * yaw_change_sine) - t176;
    const float t178 = (t31 * t156) + (t35 * yaw_change_sine);
    const float t179 = t159 - t178;
    const float t180 = t179 * t179;
    const float t181 = f19_polynomial(t180);
    const float t182 = t179 * f20_polynomial(t180);
    const float t183 = (t79 * t181) + (t126 * t182);
    const float t184 = t183 * t183;
    const float t185 = t183 * (t80 + (t184 * (t82 + (t184 * t83))));
    const float t186 = (t75 * t157) - (t105 * yaw_change_sine) - t185;
    const float t187 = ((t138 * t94) + (t141 * t103) + (t144 * t112) - (((t138 * t139) + (t141 * t142) + (t144 * t145)) * t154)) * t150;
    const float t188 = limit(t187, 0.5f);
    const float t189 = (t14 * yaw_change_sine) - (t19 * t156);
    const float t190 = t188 + t189;
    const float t191 = t190 * t190;
    const float t192 = f15_polynomial(t191);
    const float t193 = t190 * f16_polynomial(t191);
    const float t194 = (t91 * t192) + (t137 * t193);
    const float t195 = t194 * t194;
    const float t196 = t194 * (t48 + (t195 * (t50 + (t195 * t51))));
    const float t197 = (t87 * t157) + (t43 * yaw_change_sine) - t196;
    const float t198 = (t23 * yaw_change_sine) - (t27 * t156);
    const float t199 = t188 + t198;
    const float t200 = t199 * t199;
    const float t201 = f17_polynomial(t200);
    const float t202 = t199 * f18_polynomial(t200);
    const float t203 = (t100 * t201) + (t140 * t202);
    const float t204 = t203 * t203;
    const float t205 = t203 * (t64 + (t204 * (t66 + (t204 * t67))));
    const float t206 = (t96 * t157) + (t59 * yaw_change_sine) - t205;
    const float t207 = (t31 * yaw_change_sine) - (t35 * t156);
    const float t208 = t188 + t207;
    const float t209 = t208 * t208;
    const float t210 = f19_polynomial(t209);
    const float t211 = t208 * f20_polynomial(t209);
    const float t212 = (t109 * t210) + (t143 * t211);
    const float t213 = t212 * t212;
    const float t214 = t212 * (t80 + (t213 * (t82 + (t213 * t83))));
    const float t215 = (t105 * t157) + (t75 * yaw_change_sine) - t214;
    const float cost_1 = (t168 * t168) + (t177 * t177) + (t186 * t186) + (t197 * t197) + (t206 * t206) + (t215 * t215) + (0.00992376f * ((t159 * t159) + (t188 * t188) + (88.11012f * t155)));
    const bool t216 = cost_1 <= ((1.000002f * cost_0) + 1e-08f);
    const float t217 = ((t114 * t163) - (t47 * t164)) * (t115 + (t166 * (t116 + (t166 * t117))));
    const float t218 = t196 - (t217 * (t19 + t189));
    const float t219 = ((t120 * t172) - (t63 * t173)) * (t121 + (t175 * (t122 + (t175 * t123))));
    const float t220 = t205 - (t219 * (t27 + t198));
    const float t221 = ((t126 * t181) - (t79 * t182)) * (t127 + (t184 * (t128 + (t184 * t129))));
    const float t222 = t214 - (t221 * (t35 + t207));
    const float t223 = (t217 * t218) + (t219 * t220) + (t221 * t222);
    const float t224 = (t217 * t220) - (t219 * t218);
    const float t225 = (0.00992376f * ((t218 * t168) + (t220 * t177) + (t222 * t186) + (t159 * t223))) + (t224 * ((t217 * t177) - (t219 * t168)));
    const float t226 = (t217 * t222) - (t221 * t218);
    const float t227 = (t219 * t222) - (t221 * t220);
    const float t228 = 1.0f / (0.00992376f + ((t217 * t217) + (t219 * t219) + (t221 * t221)));
    const float t229 = ((t137 * t192) - (t91 * t193)) * (t115 + (t195 * (t116 + (t195 * t117))));
    const float t230 = (t229 * (t14 - t160)) - t167;
    const float t231 = ((t140 * t201) - (t100 * t202)) * (t121 + (t204 * (t122 + (t204 * t123))));
    const float t232 = (t231 * (t23 - t169)) - t176;
    const float t233 = ((t143 * t210) - (t109 * t211)) * (t127 + (t213 * (t128 + (t213 * t129))));
    const float t234 = (t233 * (t31 - t178)) - t185;
    const float t235 = (t229 * t230) + (t231 * t232) + (t233 * t234);
    const float t236 = (t229 * t232) - (t231 * t230);
    const float t237 = (0.00992376f * ((t230 * t197) + (t232 * t206) + (t234 * t215) + (t188 * t235))) + (t236 * ((t229 * t206) - (t231 * t197)));
    const float t238 = (t229 * t234) - (t233 * t230);
    const float t239 = (t231 * t234) - (t233 * t232);
    const float t240 = 1.0f / (0.00992376f + ((t229 * t229) + (t231 * t231) + (t233 * t233)));
    const float t241 = ((t225 + (t226 * ((t217 * t186) - (t221 * t168))) + (t227 * ((t219 * t186) - (t221 * t177)))) * t228) + ((t237 + (t238 * ((t229 * t215) - (t233 * t197))) + (t239 * ((t231 * t215) - (t233 * t206)))) * t240);
    const float t242 = (0.00992376f * ((t218 * t218) + (t220 * t220) + (t222 * t222))) + (t224 * t224) + (t226 * t226) + (t227 * t227);
    const float t243 = (0.00992376f * ((t230 * t230) + (t232 * t232) + (t234 * t234))) + (t236 * t236) + (t238 * t238) + (t239 * t239);
    float t244 = t154;
    float t245 = t159;
    float t246 = t188;
    float t247 = cost_1;
    if (!t216) {
        t244 = 0.0f;
        t245 = 0.0f;
        t246 = 0.0f;
        t247 = cost_0;
    }
    const float t248 = (t216) ? (t154 + ((t241 - (0.87438375f * t154)) / (0.87438375f + ((t242 * t228) + (t243 * t240))))) : (0.5f * (t154 + t244));
    const float t249 = limit(t248, 0.14022085f);
    const float t250 = t249 * t249;
    const float yaw_change_sine_2 = t249 * yaw_change_sine_polynomial(t250);
    const float half_yaw_change_sine_2 = t249 * half_yaw_change_sine_polynomial(t250);
    const float t251 = half_yaw_change_sine_2 * half_yaw_change_sine_2;
    const float t252 = 1.0f - t251;
    const float t253 = t249 - t154;
    const float t254 = (t216) ? (t159 + (((t217 * t168) + (t219 * t177) + (t221 * t186) - (0.00992376f * t159) - (t223 * t253)) * t228)) : (0.5f * (t159 + t245));
    const float t255 = limit(t254, 0.5f);
    const float t256 = (t14 * t251) + (t19 * yaw_change_sine_2);
    const float t257 = t255 - t256;
    const float t258 = t257 * t257;
    const float t259 = f15_polynomial(t258);
    const float t260 = t257 * f16_polynomial(t258);
    const float t261 = (t47 * t259) + (t114 * t260);
    const float t262 = t261 * t261;
    const float t263 = t261 * (t48 + (t262 * (t50 + (t262 * t51))));
    const float t264 = (t43 * t252) - (t87 * yaw_change_sine_2) - t263;
    const float t265 = (t23 * t251) + (t27 * yaw_change_sine_2);
    const float t266 = t255 - t265;
    const float t267 = t266 * t266;
    const float t268 = f17_polynomial(t267);
    const float t269 = t266 * f18_polynomial(t267);
    const float t270 = (t63 * t268) + (t120 * t269);
    const float t271 = t270 * t270;
    const float t272 = t270 * (t64 + (t271 * (t66 + (t271 * t67))));
    const float t273 = (t59 * t252) - (t96 * yaw_change_sine_2) - t272;
    const float t274 = (t31 * t251) + (t35 * yaw_change_sine_2);
    const float t275 = t255 - t274;
    const float t276 = t275 * t275;
    const float t277 = f19_polynomial(t276);
    const float t278 = t275 * f20_polynomial(t276);
    const float t279 = (t79 * t277) + (t126 * t278);
    const float t280 = t279 * t279;
    const float t281 = t279 * (t80 + (t280 * (t82 + (t280 * t83))));
    const float t282 = (t75 * t252) - (t105 * yaw_change_sine_2) - t281;
    const float t283 = (t216) ? (t188 + (((t229 * t197) + (t231 * t206) + (t233 * t215) - (0.00992376f * t188) - (t235 * t253)) * t240)) : (0.5f * (t188 + t246));
    const float t284 = limit(t283, 0.5f);
    const float t285 = (t14 * yaw_change_sine_2) - (t19 * t251);
    const float t286 = t284 + t285;
    const float t287 = t286 * t286;
    const float t288 = f15_polynomial(t287);
    const float t289 = t286 * f16_polynomial(t287);
    const float t290 = (t91 * t288) + (t137 * t289);
    const float t291 = t290 * t290;
    const float t292 = t290 * (t48 + (t291 * (t50 + (t291 * t51))));
    const float t293 = (t87 * t252) + (t43 * yaw_change_sine_2) - t292;
    const float t294 = (t23 * yaw_change_sine_2) - (t27 * t251);
    const float t295 = t284 + t294;
    const float t296 = t295 * t295;
    const float t297 = f17_polynomial(t296);
    const float t298 = t295 * f18_polynomial(t296);
    const float t299 = (t100 * t297) + (t140 * t298);
    const float t300 = t299 * t299;
    const float t301 = t299 * (t64 + (t300 * (t66 + (t300 * t67))));
    const float t302 = (t96 * t252) + (t59 * yaw_change_sine_2) - t301;
    const float t303 = (t31 * yaw_change_sine_2) - (t35 * t251);
    const float t304 = t284 + t303;
    const float t305 = t304 * t304;
    const float t306 = f19_polynomial(t305);
    const float t307 = t304 * f20_polynomial(t305);
    const float t308 = (t109 * t306) + (t143 * t307);
    const float t309 = t308 * t308;
    const float t310 = t308 * (t80 + (t309 * (t82 + (t309 * t83))));
    const float t311 = (t105 * t252) + (t75 * yaw_change_sine_2) - t310;
    const float cost_2 = (t264 * t264) + (t273 * t273) + (t282 * t282) + (t293 * t293) + (t302 * t302) + (t311 * t311) + (0.00992376f * ((t255 * t255) + (t284 * t284) + (88.11012f * t250)));
    const bool t312 = cost_2 <= ((1.000002f * t247) + 1e-08f);
    const float t313 = ((t114 * t259) - (t47 * t260)) * (t115 + (t262 * (t116 + (t262 * t117))));
    const float t314 = t292 - (t313 * (t19 + t285));
    const float t315 = ((t120 * t268) - (t63 * t269)) * (t121 + (t271 * (t122 + (t271 * t123))));
    const float t316 = t301 - (t315 * (t27 + t294));
    const float t317 = ((t126 * t277) - (t79 * t278)) * (t127 + (t280 * (t128 + (t280 * t129))));
    const float t318 = t310 - (t317 * (t35 + t303));
    const float t319 = (t313 * t314) + (t315 * t316) + (t317 * t318);
    const float t320 = (t313 * t316) - (t315 * t314);
    const float t321 = (0.00992376f * ((t314 * t264) + (t316 * t273) + (t318 * t282) + (t255 * t319))) + (t320 * ((t313 * t273) - (t315 * t264)));
    const float t322 = (t313 * t318) - (t317 * t314);
    const float t323 = (t315 * t318) - (t317 * t316);
    const float t324 = 1.0f / (0.00992376f + ((t313 * t313) + (t315 * t315) + (t317 * t317)));
    const float t325 = ((t137 * t288) - (t91 * t289)) * (t115 + (t291 * (t116 + (t291 * t117))));
    const float t326 = (t325 * (t14 - t256)) - t263;
    const float t327 = ((t140 * t297) - (t100 * t298)) * (t121 + (t300 * (t122 + (t300 * t123))));
    const float t328 = (t327 * (t23 - t265)) - t272;
    const float t329 = ((t143 * t306) - (t109 * t307)) * (t127 + (t309 * (t128 + (t309 * t129))));
    const float t330 = (t329 * (t31 - t274)) - t281;
    const float t331 = (t325 * t326) + (t327 * t328) + (t329 * t330);
    const float t332 = (t325 * t328) - (t327 * t326);
    const float t333 = (0.00992376f * ((t326 * t293) + (t328 * t302) + (t330 * t311) + (t284 * t331))) + (t332 * ((t325 * t302) - (t327 * t293)));
    const float t334 = (t325 * t330) - (t329 * t326);
    const float t335 = (t327 * t330) - (t329 * t328);
    const float t336 = 1.0f / (0.00992376f + ((t325 * t325) + (t327 * t327) + (t329 * t329)));
    const float t337 = ((t321 + (t322 * ((t313 * t282) - (t317 * t264))) + (t323 * ((t315 * t282) - (t317 * t273)))) * t324) + ((t333 + (t334 * ((t325 * t311) - (t329 * t293))) + (t335 * ((t327 * t311) - (t329 * t302)))) * t336);
    const float t338 = (0.00992376f * ((t314 * t314) + (t316 * t316) + (t318 * t318))) + (t320 * t320) + (t322 * t322) + (t323 * t323);
    const float t339 = (0.00992376f * ((t326 * t326) + (t328 * t328) + (t330 * t330))) + (t332 * t332) + (t334 * t334) + (t335 * t335);
    float t340 = t249;
    float t341 = t255;
    float t342 = t284;
    float t343 = cost_2;
    if (!t312) {
        t340 = t244;
        t341 = t245;
        t342 = t246;
        t343 = t247;
    }
    const float t344 = (t312) ? (t249 + ((t337 - (0.87438375f * t249)) / (0.87438375f + ((t338 * t324) + (t339 * t336))))) : (0.5f * (t249 + t340));
    const float t345 = limit(t344, 0.14022085f);
    const float t346 = t345 * t345;
    const float yaw_change_sine_3 = t345 * yaw_change_sine_polynomial(t346);
    const float half_yaw_change_sine_3 = t345 * half_yaw_change_sine_polynomial(t346);
    const float t347 = half_yaw_change_sine_3 * half_yaw_change_sine_3;
    const float t348 = 1.0f - t347;
    const float t349 = t345 - t249;
    const float t350 = (t312) ? (t255 + (((t313 * t264) + (t315 * t273) + (t317 * t282) - (0.00992376f * t255) - (t319 * t349)) * t324)) : (0.5f * (t255 + t341));
    const float t351 = limit(t350, 0.5f);
    const float t352 = (t14 * t347) + (t19 * yaw_change_sine_3);
    const float t353 = t351 - t352;
    const float t354 = t353 * t353;
    const float t355 = f15_polynomial(t354);
    const float t356 = t353 * f16_polynomial(t354);
    const float t357 = (t47 * t355) + (t114 * t356);
    const float t358 = t357 * t357;
    const float t359 = t357 * (t48 + (t358 * (t50 + (t358 * t51))));
    const float t360 = (t43 * t348) - (t87 * yaw_change_sine_3) - t359;
    const float t361 = (t23 * t347) + (t27 * yaw_change_sine_3);
    const float t362 = t351 - t361;
    const float t363 = t362 * t362;
    const float t364 = f17_polynomial(t363);
    const float t365 = t362 * f18_polynomial(t363);
    const float t366 = (t63 * t364) + (t120 * t365);
    const float t367 = t366 * t366;
    const float t368 = t366 * (t64 + (t367 * (t66 + (t367 * t67))));
    const float t369 = (t59 * t348) - (t96 * yaw_change_sine_3) - t368;
    const float t370 = (t31 * t347) + (t35 * yaw_change_sine_3);
    const float t371 = t351 - t370;
    const float t372 = t371 * t371;
    const float t373 = f19_polynomial(t372);
    const float t374 = t371 * f20_polynomial(t372);
    const float t375 = (t79 * t373) + (t126 * t374);
    const float t376 = t375 * t375;
    const float t377 = t375 * (t80 + (t376 * (t82 + (t376 * t83))));
    const float t378 = (t75 * t348) - (t105 * yaw_change_sine_3) - t377;
    const float t379 = (t312) ? (t284 + (((t325 * t293) + (t327 * t302) + (t329 * t311) - (0.00992376f * t284) - (t331 * t349)) * t336)) : (0.5f * (t284 + t342));
    const float t380 = limit(t379, 0.5f);
    const float t381 = (t14 * yaw_change_sine_3) - (t19 * t347);
    const float t382 = t380 + t381;
    const float t383 = t382 * t382;
    const float t384 = f15_polynomial(t383);
    const float t385 = t382 * f16_polynomial(t383);
    const float t386 = (t91 * t384) + (t137 * t385);
    const float t387 = t386 * t386;
    const float t388 = t386 * (t48 + (t387 * (t50 + (t387 * t51))));
    const float t389 = (t87 * t348) + (t43 * yaw_change_sine_3) - t388;
    const float t390 = (t23 * yaw_change_sine_3) - (t27 * t347);
    const float t391 = t380 + t390;
    const float t392 = t391 * t391;
    const float t393 = f17_polynomial(t392);
    const float t394 = t391 * f18_polynomial(t392);
    const float t395 = (t100 * t393) + (t140 * t394);
    const float t396 = t395 * t395;
    const float t397 = t395 * (t64 + (t396 * (t66 + (t396 * t67))));
    const float t398 = (t96 * t348) + (t59 * yaw_change_sine_3) - t397;
    const float t399 = (t31 * yaw_change_sine_3) - (t35 * t347);
    const float t400 = t380 + t399;
    const float t401 = t400 * t400;
    const float t402 = f19_polynomial(t401);
    const float t403 = t400 * f20_polynomial(t401);
    const float t404 = (t109 * t402) + (t143 * t403);
    const float t405 = t404 * t404;
    const float t406 = t404 * (t80 + (t405 * (t82 + (t405 * t83))));
    const float t407 = (t105 * t348) + (t75 * yaw_change_sine_3) - t406;
    const float cost_3 = (t360 * t360) + (t369 * t369) + (t378 * t378) + (t389 * t389) + (t398 * t398) + (t407 * t407) + (0.00992376f * ((t351 * t351) + (t380 * t380) + (88.11012f * t346)));
    const bool t408 = cost_3 <= ((1.000002f * t343) + 1e-08f);
    const float t409 = ((t114 * t355) - (t47 * t356)) * (t115 + (t358 * (t116 + (t358 * t117))));
    const float t410 = t388 - (t409 * (t19 + t381));
    const float t411 = ((t120 * t364) - (t63 * t365)) * (t121 + (t367 * (t122 + (t367 * t123))));
    const float t412 = t397 - (t411 * (t27 + t390));
    const float t413 = ((t126 * t373) - (t79 * t374)) * (t127 + (t376 * (t128 + (t376 * t129))));
    const float t414 = t406 - (t413 * (t35 + t399));
    const float t415 = (t409 * t410) + (t411 * t412) + (t413 * t414);
    const float t416 = (t409 * t412) - (t411 * t410);
    const float t417 = (0.00992376f * ((t410 * t360) + (t412 * t369) + (t414 * t378) + (t351 * t415))) + (t416 * ((t409 * t369) - (t411 * t360)));
    const float t418 = (t409 * t414) - (t413 * t410);
    const float t419 = (t411 * t414) - (t413 * t412);
    const float t420 = 1.0f / (0.00992376f + ((t409 * t409) + (t411 * t411) + (t413 * t413)));
    const float t421 = ((t137 * t384) - (t91 * t385)) * (t115 + (t387 * (t116 + (t387 * t117))));
    const float t422 = (t421 * (t14 - t352)) - t359;
    const float t423 = ((t140 * t393) - (t100 * t394)) * (t121 + (t396 * (t122 + (t396 * t123))));
    const float t424 = (t423 * (t23 - t361)) - t368;
    const float t425 = ((t143 * t402) - (t109 * t403)) * (t127 + (t405 * (t128 + (t405 * t129))));
    const float t426 = (t425 * (t31 - t370)) - t377;
    const float t427 = (t421 * t422) + (t423 * t424) + (t425 * t426);
    const float t428 = (t421 * t424) - (t423 * t422);
    const float t429 = (0.00992376f * ((t422 * t389) + (t424 * t398) + (t426 * t407) + (t380 * t427))) + (t428 * ((t421 * t398) - (t423 * t389)));
    const float t430 = (t421 * t426) - (t425 * t422);
    const float t431 = (t423 * t426) - (t425 * t424);
    const float t432 = 1.0f / (0.00992376f + ((t421 * t421) + (t423 * t423) + (t425 * t425)));
    const float t433 = ((t417 + (t418 * ((t409 * t378) - (t413 * t360))) + (t419 * ((t411 * t378) - (t413 * t369)))) * t420) + ((t429 + (t430 * ((t421 * t407) - (t425 * t389))) + (t431 * ((t423 * t407) - (t425 * t398)))) * t432);
    const float t434 = (0.00992376f * ((t410 * t410) + (t412 * t412) + (t414 * t414))) + (t416 * t416) + (t418 * t418) + (t419 * t419);
    const float t435 = (0.00992376f * ((t422 * t422) + (t424 * t424) + (t426 * t426))) + (t428 * t428) + (t430 * t430) + (t431 * t431);
    float t436 = t345;
    float t437 = t351;
    float t438 = t380;
    float t439 = cost_3;
    if (!t408) {
        t436 = t340;
        t437 = t341;
        t438 = t342;
        t439 = t343;
    }
    const float t440 = (t408) ? (t345 + ((t433 - (0.87438375f * t345)) / (0.87438375f + ((t434 * t420) + (t435 * t432))))) : (0.5f * (t345 + t436));
    const float t441 = limit(t440, 0.14022085f);
    const float t442 = t441 * t441;
    const float yaw_change_sine_4 = t441 * yaw_change_sine_polynomial(t442);
    const float half_yaw_change_sine_4 = t441 * half_yaw_change_sine_polynomial(t442);
    const float t443 = half_yaw_change_sine_4 * half_yaw_change_sine_4;
    const float t444 = 1.0f - t443;
    const float t445 = t441 - t345;
    const float t446 = (t408) ? (t351 + (((t409 * t360) + (t411 * t369) + (t413 * t378) - (0.00992376f * t351) - (t415 * t445)) * t420)) : (0.5f * (t351 + t437));
    const float t447 = limit(t446, 0.5f);
    const float t448 = (t14 * t443) + (t19 * yaw_change_sine_4);
    const float t449 = t447 - t448;
    const float t450 = t449 * t449;
    const float t451 = f15_polynomial(t450);
    const float t452 = t449 * f16_polynomial(t450);
    const float t453 = (t47 * t451) + (t114 * t452);
    const float t454 = t453 * t453;
    const float t455 = t453 * (t48 + (t454 * (t50 + (t454 * t51))));
    const float t456 = (t43 * t444) - (t87 * yaw_change_sine_4) - t455;
    const float t457 = (t23 * t443) + (t27 * yaw_change_sine_4);
    const float t458 = t447 - t457;
    const float t459 = t458 * t458;
    const float t460 = f17_polynomial(t459);
    const float t461 = t458 * f18_polynomial(t459);
    const float t462 = (t63 * t460) + (t120 * t461);
    const float t463 = t462 * t462;
    const float t464 = t462 * (t64 + (t463 * (t66 + (t463 * t67))));
    const float t465 = (t59 * t444) - (t96 * yaw_change_sine_4) - t464;
    const float t466 = (t31 * t443) + (t35 * yaw_change_sine_4);
    const float t467 = t447 - t466;
    const float t468 = t467 * t467;
    const float t469 = f19_polynomial(t468);
    const float t470 = t467 * f20_polynomial(t468);
    const float t471 = (t79 * t469) + (t126 * t470);
    const float t472 = t471 * t471;
    const float t473 = t471 * (t80 + (t472 * (t82 + (t472 * t83))));
    const float t474 = (t75 * t444) - (t105 * yaw_change_sine_4) - t473;
    const float t475 = (t408) ? (t380 + (((t421 * t389) + (t423 * t398) + (t425 * t407) - (0.00992376f * t380) - (t427 * t445)) * t432)) : (0.5f * (t380 + t438));
    const float t476 = limit(t475, 0.5f);
    const float t477 = (t14 * yaw_change_sine_4) - (t19 * t443);
    const float t478 = t476 + t477;
    const float t479 = t478 * t478;
    const float t480 = f15_polynomial(t479);
    const float t481 = t478 * f16_polynomial(t479);
    const float t482 = (t91 * t480) + (t137 * t481);
    const float t483 = t482 * t482;
    const float t484 = t482 * (t48 + (t483 * (t50 + (t483 * t51))));
    const float t485 = (t87 * t444) + (t43 * yaw_change_sine_4) - t484;
    const float t486 = (t23 * yaw_change_sine_4) - (t27 * t443);
    const float t487 = t476 + t486;
    const float t488 = t487 * t487;
    const float t489 = f17_polynomial(t488);
    const float t490 = t487 * f18_polynomial(t488);
    const float t491 = (t100 * t489) + (t140 * t490);
    const float t492 = t491 * t491;
    const float t493 = t491 * (t64 + (t492 * (t66 + (t492 * t67))));
    const float t494 = (t96 * t444) + (t59 * yaw_change_sine_4) - t493;
    const float t495 = (t31 * yaw_change_sine_4) - (t35 * t443);
    const float t496 = t476 + t495;
    const float t497 = t496 * t496;
    const float t498 = f19_polynomial(t497);
    const float t499 = t496 * f20_polynomial(t497);
    const float t500 = (t109 * t498) + (t143 * t499);
    const float t501 = t500 * t500;
    const float t502 = t500 * (t80 + (t501 * (t82 + (t501 * t83))));
    const float t503 = (t105 * t444) + (t75 * yaw_change_sine_4) - t502;
    const float t504 = (t456 * t456) + (t465 * t465) + (t474 * t474) + (t485 * t485) + (t494 * t494) + (t503 * t503);
    const float t505 = (t447 * t447) + (t476 * t476);
    const float cost_4 = t504 + (0.00992376f * (t505 + (88.11012f * t442)));
    const float t506 = (t39 || t55 || t71) ? 1.0f : 3.0f;
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const uint32_t estimator_residual_faults = state->estimator_residual_faults;
    const float t507 = 0.030115018f + (0.030115018f * (float)estimator_residual_faults);
    const bool t508 = (t507 * t507) < (t505 + (3.524405f * t442));
    const bool t509 = cost_4 <= ((1.000002f * t439) + 1e-08f);
    const float t510 = ((t114 * t451) - (t47 * t452)) * (t115 + (t454 * (t116 + (t454 * t117))));
    const float t511 = t484 - (t510 * (t19 + t477));
    const float t512 = ((t120 * t460) - (t63 * t461)) * (t121 + (t463 * (t122 + (t463 * t123))));
    const float t513 = t493 - (t512 * (t27 + t486));
    const float t514 = ((t126 * t469) - (t79 * t470)) * (t127 + (t472 * (t128 + (t472 * t129))));
    const float t515 = t502 - (t514 * (t35 + t495));
    const float t516 = (t510 * t511) + (t512 * t513) + (t514 * t515);
    const float t517 = (t510 * t513) - (t512 * t511);
    const float t518 = (0.00992376f * ((t511 * t456) + (t513 * t465) + (t515 * t474) + (t447 * t516))) + (t517 * ((t510 * t465) - (t512 * t456)));
    const float t519 = (t510 * t515) - (t514 * t511);
    const float t520 = (t512 * t515) - (t514 * t513);
    const float t521 = 1.0f / (0.00992376f + ((t510 * t510) + (t512 * t512) + (t514 * t514)));
    const float t522 = ((t137 * t480) - (t91 * t481)) * (t115 + (t483 * (t116 + (t483 * t117))));
    const float t523 = (t522 * (t14 - t448)) - t455;
    const float t524 = ((t140 * t489) - (t100 * t490)) * (t121 + (t492 * (t122 + (t492 * t123))));
    const float t525 = (t524 * (t23 - t457)) - t464;
    const float t526 = ((t143 * t498) - (t109 * t499)) * (t127 + (t501 * (t128 + (t501 * t129))));
    const float t527 = (t526 * (t31 - t466)) - t473;
    const float t528 = (t522 * t523) + (t524 * t525) + (t526 * t527);
    const float t529 = (t522 * t525) - (t524 * t523);
    const float t530 = (0.00992376f * ((t523 * t485) + (t525 * t494) + (t527 * t503) + (t476 * t528))) + (t529 * ((t522 * t494) - (t524 * t485)));
    const float t531 = (t522 * t527) - (t526 * t523);
    const float t532 = (t524 * t527) - (t526 * t525);
    const float t533 = 1.0f / (0.00992376f + ((t522 * t522) + (t524 * t524) + (t526 * t526)));
    const float t534 = ((t518 + (t519 * ((t510 * t474) - (t514 * t456))) + (t520 * ((t512 * t474) - (t514 * t465)))) * t521) + ((t530 + (t531 * ((t522 * t503) - (t526 * t485))) + (t532 * ((t524 * t503) - (t526 * t494)))) * t533);
    const float t535 = t534 - (0.87438375f * t441);
    const float t536 = (0.00992376f * ((t511 * t511) + (t513 * t513) + (t515 * t515))) + (t517 * t517) + (t519 * t519) + (t520 * t520);
    const float t537 = (0.00992376f * ((t523 * t523) + (t525 * t525) + (t527 * t527))) + (t529 * t529) + (t531 * t531) + (t532 * t532);
    const float t538 = (t536 * t521) + (t537 * t533);
    const float t539 = 1.0f / (0.87438375f + t538);
    const float t540 = (t510 * t456) + (t512 * t465) + (t514 * t474) - (0.00992376f * t447);
    const float t541 = (t522 * t485) + (t524 * t494) + (t526 * t503) - (0.00992376f * t476);
    const bool converged = t509 && (((t535 * t535 * t539) + (t540 * t540 * t521) + (t541 * t541 * t533)) <= 1e-08f);
    float t542;
    float t543;
    float t544;
    if (converged) {
        const float t545 = limit(t441 + (t535 * t539), 0.14022085f);
        t542 = t545;
        const float t546 = t545 - t441;
        t543 = limit(t447 + ((t540 - (t516 * t546)) * t521), 0.5f);
        t544 = limit(t476 + ((t541 - (t528 * t546)) * t533), 0.5f);
    } else {
        if (t509) {
            t542 = t441;
            t543 = t447;
            t544 = t476;
        } else {
            t542 = t436;
            t543 = t437;
            t544 = t438;
        }
    }
    const float estimator_yaw_last_good = state->estimator_yaw_last_good;
    const uint32_t estimator_searching = state->estimator_searching;
    bool t547 = t508;
    if (!(estimator_ambiguity_resolved != 0u)) {
        t547 = (estimator_searching != 0u) && !(fabsf(t7 + t542 - estimator_yaw_last_good) <= 0.08726646f);
    }
    const bool t548 = ((0.01f * t506) < t504) || t547;
    const bool t549 = !(estimator_searching != 0u);
    float t550 = 0.0f;
    float t551 = 0.0f;
    float t552 = 0.0f;
    float t553 = 0.0f;
    float t554 = 0.0f;
    float t555 = 0.0f;
    if (!(t548 && t549)) {
        t550 = t542;
        t551 = t543;
        t552 = t544;
        t553 = 0.5f * t543;
        t554 = 0.5f * t544;
        t555 = 0.1f * t542;
    }
    const float t556 = t550 * t550;
    const float yaw_change_sine_5 = t550 * yaw_change_sine_polynomial(t556);
    const float half_yaw_change_sine_5 = t550 * half_yaw_change_sine_polynomial(t556);
    const float t557 = t10 + t551;
    float t558 = t557;
    bool t559 = true;
    if (3.1415927f < t557) {
        t558 = t557 - 6.2831855f;
    } else {
        t559 = false;
    }
    float t560 = t558;
    float t561 = -1.0f;
    if (t558 < -3.1415927f) {
        t560 = t558 + 6.2831855f;
    } else {
        t561 = t559 ? 1.0f : 0.0f;
    }
    const float estimator_pitch_x = state->estimator_pitch_x;
    const float t562 = estimator_pitch_x + t561;
    const float t563 = 1.0f - (half_yaw_change_sine_5 * half_yaw_change_sine_5);
    const float t564 = (t12 * t563) - (t13 * yaw_change_sine_5);
    const float t565 = (t13 * t563) + (t12 * yaw_change_sine_5);
    const float t566 = (0.0060790665f * t564) + (0.0040132f * t565);
    const float X = (0.008085071f * t560) + (0.0508f * t562) - t566;
    const float t567 = t18 + t552;
    float t568 = t567;
    bool t569 = true;
    if (3.1415927f < t567) {
        t568 = t567 - 6.2831855f;
    } else {
        t569 = false;
    }
    float t570 = t568;
    float t571 = -1.0f;
    if (t568 < -3.1415927f) {
        t570 = t568 + 6.2831855f;
    } else {
        t571 = t569 ? 1.0f : 0.0f;
    }
    const float estimator_pitch_y = state->estimator_pitch_y;
    const float t572 = estimator_pitch_y + t571;
    const float t573 = (0.0060790665f * t565) - (0.0040132f * t564);
    const float Y = (0.008085071f * t570) + (0.0508f * t572) - t573;
    const float t574 = t7 + t550;
    float t575 = t574;
    if (3.1415927f < t574) {
        t575 = t574 - 6.2831855f;
    }
    float yaw = t575;
    if (t575 < -3.1415927f) {
        yaw = t575 + 6.2831855f;
    }
    const float t576 = t516 * t521;
    const float t577 = t576 - (123.68475f * t573);
    const float t578 = 1.0f / (t538 + 0.03497535f);
    const float deviation_X = 8.085071e-06f * sqrtf(t521 + (t577 * t577 * t578));
    const float t579 = t528 * t533;
    const float t580 = t579 + (123.68475f * t566);
    const float deviation_Y = 8.085071e-06f * sqrtf(t533 + (t580 * t580 * t578));
    const float deviation_yaw = 0.001f * sqrtf(t578);
    const float residual = sqrtf(1e-30f + (t504 / t506));
    const float t581 = ((3.524405f + (t576 * t576) + (t579 * t579)) * t578) + (t521 + t533);
    const bool damped = 15.115238f < t581;
    const bool t582 = converged && !(damped || t548 || t508);
    const bool t583 = t582 && (((t39 ? 1.0f : 0.0f) + (t55 ? 1.0f : 0.0f) + (t71 ? 1.0f : 0.0f)) < 1.0f) && (t581 <= 1.612292f) && t549;
    const bool t584 = (1.0f != 0.0f) && (fabsf(t562) <= 8.0f) && (fabsf(t572) <= 8.0f);
    const float t585 = fabsf(yaw);
    const bool t586 = t584 && (t585 <= 0.17453292f);
    const bool t587 = (t583 && t586) || ((estimator_ambiguity_resolved != 0u) && !damped);
    const uint32_t estimator_lock_lost = state->estimator_lock_lost;
    const bool valid = t582 && t587 && !(estimator_lock_lost != 0u) && t586;
    out->lock_lost = (float)estimator_lock_lost;
    const bool t588 = 4u <= estimator_residual_faults;
    const bool t589 = t548 && t588;
    const bool t590 = !t548;
    if (t589) {
        const float estimator_start_x = state->estimator_start_x;
        const float t591 = estimator_start_x + -1.5401491f;
        if (t591 < -3.1415927f) {
            const float t592 = t591 + 6.2831855f;
            state->estimator_phase_x = t592;
            state->estimator_start_x = t592;
        } else {
            state->estimator_phase_x = t591;
            state->estimator_start_x = t591;
        }
        const float estimator_start_y = state->estimator_start_y;
        const float t593 = estimator_start_y + -2.702773f;
        if (t593 < -3.1415927f) {
            const float t594 = t593 + 6.2831855f;
            state->estimator_phase_y = t594;
            state->estimator_start_y = t594;
        } else {
            state->estimator_phase_y = t593;
            state->estimator_start_y = t593;
        }
        state->estimator_yaw = estimator_yaw_last_good;
        state->estimator_searching = 1u;
        state->estimator_ambiguity_resolved = 0u;
        state->estimator_excluded_sensor = 0u;
    } else {
        state->estimator_phase_x = t560;
        state->estimator_phase_y = t570;
        state->estimator_yaw = yaw;
        if (converged && t590) {
            state->estimator_searching = 0u;
        }
        state->estimator_ambiguity_resolved = flag(t587);
        const float t595 = t70 + t104;
        const float t596 = t54 + t95;
        const float t597 = t86 + t113;
        const float t598 = max(t595, t596);
        const float t599 = min(t595, t596) + min(t597, t598);
        const bool t600 = (estimator_ambiguity_resolved != 0u) && (1u <= estimator_residual_faults) && (t599 <= 0.076f) && ((25.0f * t599) <= max(t597, t598));
        if (t548 && ((1.6e-05f * t506) < t504) && t600) {
            state->estimator_excluded_sensor = (uint32_t)((t598 < t597) ? 3.0f : ((t596 < t595) ? 2.0f : 1.0f));
        }
    }
    if (t587 && t590) {
        state->estimator_yaw_last_good = yaw;
    }
    const float estimator_pitch_x_next = limit(t562, 8.0f);
    state->estimator_pitch_x = estimator_pitch_x_next;
    const float estimator_pitch_y_next = limit(t572, 8.0f);
    state->estimator_pitch_y = estimator_pitch_y_next;
    float t601 = 0.0f;
    float t602 = 0.0f;
    float t603 = 0.0f;
    if (!(estimator_searching != 0u)) {
        t601 = estimator_motion_x + t553;
        t602 = estimator_motion_y + t554;
        t603 = estimator_motion_yaw + t555;
    }
    const float estimator_motion_x_next = limit(t601, 0.5f);
    state->estimator_motion_x = estimator_motion_x_next;
    const float estimator_motion_y_next = limit(t602, 0.5f);
    state->estimator_motion_y = estimator_motion_y_next;
    const float estimator_motion_yaw_next = limit(t603, 0.14022085f);
    state->estimator_motion_yaw = estimator_motion_yaw_next;
    const uint32_t estimator_residual_faults_next = (t548) ? ((t588) ? 0u : (estimator_residual_faults + 1u)) : 0u;
    state->estimator_residual_faults = estimator_residual_faults_next;
    const uint32_t estimator_acquired = state->estimator_acquired;
    const bool estimator_acquired_next = t587 || (estimator_acquired != 0u);
    state->estimator_acquired = flag(estimator_acquired_next);
    const bool estimator_lock_lost_next = (estimator_lock_lost != 0u) || ((estimator_acquired != 0u) && (t589 || !t584 || (((t587) ? 0.17453292f : 0.34906584f) < t585)));
    state->estimator_lock_lost = flag(estimator_lock_lost_next);
    out->X = X;
    out->Y = Y;
    out->yaw = yaw;
    out->deviation_X = deviation_X;
    out->deviation_Y = deviation_Y;
    out->deviation_yaw = deviation_yaw;
    out->residual = residual;
    out->converged = converged ? 1.0f : 0.0f;
    out->damped = damped ? 1.0f : 0.0f;
    out->valid = valid ? 1.0f : 0.0f;
    out->excluded_sensor = (float)estimator_excluded_sensor;

    return faults;
}
