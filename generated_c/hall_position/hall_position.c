/* hall_position. Generated: do not edit. */
#include "hall_position.h"
#include <math.h>
#include <stdbool.h>

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

/* f1_polynomial for estimator_yaw + estimator_motion_yaw in -3.2425952 .. 3.2425952: f1_polynomial / x, t = x^2, x = estimator_yaw + estimator_motion_yaw;
 * relative error at most 1.2e-07. */
static inline float f1_polynomial(float t)
{
    return 0.25f + (t * (-0.0026041644f + (t * (8.136728e-06f + (t * -1.1898613e-08f)))));
}

/* yaw_fraction_cosine for estimator_yaw + estimator_motion_yaw in -3.2425952 .. 3.2425952: t = x^2, x = estimator_yaw + estimator_motion_yaw;
 * relative error at most 1.4e-07. */
static inline float yaw_fraction_cosine_polynomial(float t)
{
    return 0.99999994f + (t * (-0.031249868f + (t * (0.00016270365f + (t * -3.3090393e-07f)))));
}

/* f3_polynomial for (estimator_phase_x + estimator_motion_x) + ((2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)) - (2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2)))))) in -8.35398197 .. 8.35398293: f3_polynomial / x, t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)) - (2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))));
 * relative error at most 1.5e-07. */
static inline float f3_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551866f + (t * (2.5417654e-07f + (t * -9.166732e-11f)))));
}

/* phase_fraction_cosine for (estimator_phase_x + estimator_motion_x) + ((2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)) - (2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2)))))) in -8.35398197 .. 8.35398293: t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)) - (2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))));
 * relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_polynomial(float t)
{
    return 1.0f + (t * (-0.0078124995f + (t * (1.0172464e-05f + (t * (-5.295563e-09f + (t * 1.434358e-12f)))))));
}

/* f5_polynomial for (estimator_phase_x + estimator_motion_x) + ((2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -8.35398293 .. 8.35398197: f5_polynomial / x, t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.5e-07. */
static inline float f5_polynomial(float t)
{
    return 0.12499999f + (t * (-0.00032551866f + (t * (2.5417654e-07f + (t * -9.166732e-11f)))));
}

/* phase_fraction_cosine for (estimator_phase_x + estimator_motion_x) + ((2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1))) in -8.35398293 .. 8.35398197: t = x^2, x = (estimator_phase_x + estimator_motion_x) + ((2.35619449 * (1 - (0.5 * (clamp((...), -2, 2) * clamp((...), -2, 2))))) - (2.35619449 * clamp((clamp((4 * (...)), -2, 2) * (1 - (0.125 * (...)))), -1, 1)));
 * relative error at most 1.7e-07. */
static inline float phase_fraction_cosine_2_polynomial(float t)
{
    return 1.0f + (t * (-0.0078124995f + (t * (1.0172464e-05f + (t * (-5.295563e-09f + (t * 1.434358e-12f)))))));
}

/* yaw_change_sine for clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (2.75466335 + (((...) * (...)) + ((...) * (...))))), -0.101002539, 0.101002539) in -0.101002537 .. 0.101002537: yaw_change_sine / x, t = x^2, x = clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (2.75466335 + (((...) * (...)) + ((...) * (...))))), -0.101002539, 0.101002539);
 * relative error at most 2.1e-07. */
static inline float yaw_change_sine_polynomial(float t)
{
    return 0.9999999f + (t * -0.16658026f);
}

/* half_yaw_change_sine for clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (2.75466335 + (((...) * (...)) + ((...) * (...))))), -0.101002539, 0.101002539) in -0.101002537 .. 0.101002537: half_yaw_change_sine / x, t = x^2, x = clamp((((((...) + (...)) * (1 / (...))) + (((...) + (...)) * (1 / (...)))) / (2.75466335 + (((...) * (...)) + ((...) * (...))))), -0.101002539, 0.101002539);
 * relative error at most 1.1e-07. */
static inline float half_yaw_change_sine_polynomial(float t)
{
    return 0.70710677f + (t * -0.029459648f);
}

/* f9_polynomial for clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.999171257 .. 0.999171257: t = x^2, x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine));
 * relative error at most 1.4e-07. */
static inline float f9_polynomial(float t)
{
    return 1.0f + (t * (-0.49999997f + (t * (0.041666426f + (t * (-0.0013882433f + (t * 2.409394e-05f)))))));
}

/* f10_polynomial for clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine)) in -0.999171257 .. 0.999171257: f10_polynomial / x, t = x^2, x = clamp(((((...) + (...)) - ((...) * (...))) * (1 / (0.00992376004 + (...)))), -0.5, 0.5) - ((((...) - (...)) * (half_yaw_change_sine * half_yaw_change_sine)) + (((...) - (...)) * yaw_change_sine));
 * relative error at most 1.2e-07. */
static inline float f10_polynomial(float t)
{
    return 1.0f + (t * (-0.16666614f + (t * (0.008330209f + (t * -0.00019311193f)))));
}

void hall_position_init(hall_position_state_t *state)
{
    state->guard_last_V_ax = 0.0f;
    state->guard_last_V_ay = 0.0f;
    state->guard_last_V_bx = 0.0f;
    state->guard_last_V_by = 0.0f;
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
}

uint32_t hall_position_step(hall_position_state_t *state, const hall_position_input_t *in, hall_position_output_t *out)
{
    static const float estimator_field_1 = 2.24906f;            /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_3 = 3.60456f;            /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_field_5 = -2.883648f;          /* V; coefficient of the field alpha sin p + beta sin 5p, by powers of sin p */
    static const float estimator_slope_0 = 2.24906f;            /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_2 = 10.81368f;           /* V; coefficient of the field's derivative by the phase p, by powers of sin p */
    static const float estimator_slope_4 = -14.41824f;          /* V; coefficient of the field's derivative by the phase p, by powers of sin p */

    /* guard: range acceptance, hold, latch */
    const float V_ax = in->V_ax;
    float V_ax_held = V_ax;
    bool complete = true;
    uint32_t faults = 0u;
    if (fabsf(V_ax) <= 5.0f) {
        state->guard_last_V_ax = V_ax;
    } else {
        V_ax_held = state->guard_last_V_ax;
        complete = false;
        faults = 0x00000001u;
    }
    const float V_ay = in->V_ay;
    float V_ay_held = V_ay;
    if (fabsf(V_ay) <= 5.0f) {
        state->guard_last_V_ay = V_ay;
    } else {
        V_ay_held = state->guard_last_V_ay;
        complete = false;
        faults |= 0x00000002u;
    }
    const float V_bx = in->V_bx;
    float V_bx_held = V_bx;
    if (fabsf(V_bx) <= 5.0f) {
        state->guard_last_V_bx = V_bx;
    } else {
        V_bx_held = state->guard_last_V_bx;
        complete = false;
        faults |= 0x00000004u;
    }
    const float V_by = in->V_by;
    float V_by_held = V_by;
    if (fabsf(V_by) <= 5.0f) {
        state->guard_last_V_by = V_by;
    } else {
        V_by_held = state->guard_last_V_by;
        complete = false;
        faults |= 0x00000008u;
    }
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
    const float t1 = estimator_yaw + estimator_motion_yaw;
    const float t2 = t1 * t1;
    const float t3 = t1 * f1_polynomial(t2);
    const float yaw_fraction_sine = 4.0f * t3;
    const float yaw_fraction_cosine = yaw_fraction_cosine_polynomial(t2);
    const float estimator_phase_x = state->estimator_phase_x;
    const float estimator_motion_x = state->estimator_motion_x;
    const float t4 = estimator_phase_x + estimator_motion_x;
    const float t5 = limit(4.0f * (t3 * yaw_fraction_cosine), 2.0f);
    const float t6 = limit(t5 * (1.0f - (0.125f * (yaw_fraction_sine * yaw_fraction_sine))), 1.0f);
    const float t7 = 2.3561945f * t6;
    const float t8 = 1.0f - (0.5f * (t5 * t5));
    const float t9 = 2.3561945f * t8;
    const float t10 = t7 - t9;
    const float t11 = t4 + t10;
    const float t12 = t11 * t11;
    const float t13 = t11 * f3_polynomial(t12);
    const float phase_fraction_sine = 8.0f * t13;
    const float phase_fraction_cosine = phase_fraction_cosine_polynomial(t12);
    const float estimator_phase_y = state->estimator_phase_y;
    const float estimator_motion_y = state->estimator_motion_y;
    const float t14 = estimator_phase_y + estimator_motion_y;
    const float t15 = (-2.3561945f * t6) - t9;
    const float t16 = t14 + t15;
    const float t17 = t16 * t16;
    const float t18 = t16 * f3_polynomial(t17);
    const float phase_fraction_sine_2 = 8.0f * t18;
    const float phase_fraction_cosine_2 = phase_fraction_cosine_polynomial(t17);
    const float t19 = t9 - t7;
    const float t20 = t4 + t19;
    const float t21 = t20 * t20;
    const float t22 = t20 * f5_polynomial(t21);
    const float phase_fraction_sine_3 = 8.0f * t22;
    const float phase_fraction_cosine_3 = phase_fraction_cosine_2_polynomial(t21);
    const float t23 = t7 + t9;
    const float t24 = t14 + t23;
    const float t25 = t24 * t24;
    const float t26 = t24 * f5_polynomial(t25);
    const float phase_fraction_sine_4 = 8.0f * t26;
    const float phase_fraction_cosine_4 = phase_fraction_cosine_2_polynomial(t25);
    const float t27 = (t8 * V_ax_held) - (t6 * V_ay_held);
    const float t28 = t13 * phase_fraction_cosine;
    const float t29 = limit(8.0f * (t28 * (1.0f - (0.03125f * (phase_fraction_sine * phase_fraction_sine)))), 2.0f);
    const float t30 = 8.0f * t28;
    const float t31 = limit(t29 * (1.0f - (0.125f * (t30 * t30))), 1.0f);
    const float t32 = t31 * t31;
    const float t33 = t31 * (estimator_field_1 + (t32 * (estimator_field_3 + (t32 * estimator_field_5))));
    const float t34 = t27 - t33;
    const float t35 = (t8 * V_bx_held) - (t6 * V_by_held);
    const float t36 = t22 * phase_fraction_cosine_3;
    const float t37 = limit(8.0f * (t36 * (1.0f - (0.03125f * (phase_fraction_sine_3 * phase_fraction_sine_3)))), 2.0f);
    const float t38 = 8.0f * t36;
    const float t39 = limit(t37 * (1.0f - (0.125f * (t38 * t38))), 1.0f);
    const float t40 = t39 * t39;
    const float t41 = t39 * (estimator_field_1 + (t40 * (estimator_field_3 + (t40 * estimator_field_5))));
    const float t42 = t35 - t41;
    const float t43 = (t6 * V_ax_held) + (t8 * V_ay_held);
    const float t44 = t18 * phase_fraction_cosine_2;
    const float t45 = limit(8.0f * (t44 * (1.0f - (0.03125f * (phase_fraction_sine_2 * phase_fraction_sine_2)))), 2.0f);
    const float t46 = 8.0f * t44;
    const float t47 = limit(t45 * (1.0f - (0.125f * (t46 * t46))), 1.0f);
    const float t48 = t47 * t47;
    const float t49 = t47 * (estimator_field_1 + (t48 * (estimator_field_3 + (t48 * estimator_field_5))));
    const float t50 = t43 - t49;
    const float t51 = (t6 * V_bx_held) + (t8 * V_by_held);
    const float t52 = t26 * phase_fraction_cosine_4;
    const float t53 = limit(8.0f * (t52 * (1.0f - (0.03125f * (phase_fraction_sine_4 * phase_fraction_sine_4)))), 2.0f);
    const float t54 = 8.0f * t52;
    const float t55 = limit(t53 * (1.0f - (0.125f * (t54 * t54))), 1.0f);
    const float t56 = t55 * t55;
    const float t57 = t55 * (estimator_field_1 + (t56 * (estimator_field_3 + (t56 * estimator_field_5))));
    const float t58 = t51 - t57;
    const float cost_0 = (t34 * t34) + (t42 * t42) + (t50 * t50) + (t58 * t58);
    const float t59 = 1.0f - (0.5f * (t29 * t29));
    const float t60 = t59 * (estimator_slope_0 + (t32 * (estimator_slope_2 + (t32 * estimator_slope_4))));
    const float t61 = t49 - (t60 * t15);
    const float t62 = 1.0f - (0.5f * (t37 * t37));
    const float t63 = t62 * (estimator_slope_0 + (t40 * (estimator_slope_2 + (t40 * estimator_slope_4))));
    const float t64 = t57 - (t63 * t23);
    const float t65 = (t60 * t64) - (t63 * t61);
    const float t66 = 1.0f / (0.00992376f + ((t60 * t60) + (t63 * t63)));
    const float t67 = 1.0f - (0.5f * (t45 * t45));
    const float t68 = t67 * (estimator_slope_0 + (t48 * (estimator_slope_2 + (t48 * estimator_slope_4))));
    const float t69 = (t68 * t10) - t33;
    const float t70 = 1.0f - (0.5f * (t53 * t53));
    const float t71 = t70 * (estimator_slope_0 + (t56 * (estimator_slope_2 + (t56 * estimator_slope_4))));
    const float t72 = (t71 * t19) - t41;
    const float t73 = (t68 * t72) - (t71 * t69);
    const float t74 = 1.0f / (0.00992376f + ((t68 * t68) + (t71 * t71)));
    const float t75 = (((0.00992376f * ((t61 * t34) + (t64 * t42))) + (t65 * ((t60 * t42) - (t63 * t34)))) * t66) + (((0.00992376f * ((t69 * t50) + (t72 * t58))) + (t73 * ((t68 * t58) - (t71 * t50)))) * t74);
    const float t76 = (((0.00992376f * ((t61 * t61) + (t64 * t64))) + (t65 * t65)) * t66) + (((0.00992376f * ((t69 * t69) + (t72 * t72))) + (t73 * t73)) * t74);
    const float t77 = limit(t75 / (2.7546635f + t76), 0.10100254f);
    const float t78 = t77 * t77;
    const float yaw_change_sine = t77 * yaw_change_sine_polynomial(t78);
    const float half_yaw_change_sine = t77 * half_yaw_change_sine_polynomial(t78);
    const float t79 = half_yaw_change_sine * half_yaw_change_sine;
    const float t80 = 1.0f - t79;
    const float t81 = limit(((t60 * t34) + (t63 * t42) - (((t60 * t61) + (t63 * t64)) * t77)) * t66, 0.5f);
    const float t82 = (t10 * t79) + (t15 * yaw_change_sine);
    const float t83 = t81 - t82;
    const float t84 = t83 * t83;
    const float t85 = f9_polynomial(t84);
    const float t86 = t83 * f10_polynomial(t84);
    const float t87 = (t31 * t85) + (t59 * t86);
    const float t88 = t87 * t87;
    const float t89 = t87 * (estimator_field_1 + (t88 * (estimator_field_3 + (t88 * estimator_field_5))));
    const float t90 = (t27 * t80) - (t43 * yaw_change_sine) - t89;
    const float t91 = (t19 * t79) + (t23 * yaw_change_sine);
    const float t92 = t81 - t91;
    const float t93 = t92 * t92;
    const float t94 = f9_polynomial(t93);
    const float t95 = t92 * f10_polynomial(t93);
    const float t96 = (t39 * t94) + (t62 * t95);
    const float t97 = t96 * t96;
    const float t98 = t96 * (estimator_field_1 + (t97 * (estimator_field_3 + (t97 * estimator_field_5))));
    const float t99 = (t35 * t80) - (t51 * yaw_change_sine) - t98;
    const float t100 = limit(((t68 * t50) + (t71 * t58) - (((t68 * t69) + (t71 * t72)) * t77)) * t74, 0.5f);
    const float t101 = (t10 * yaw_change_sine) - (t15 * t79);
    const float t102 = t100 + t101;
    const float t103 = t102 * t102;
    const float t104 = f9_polynomial(t103);
    const float t105 = t102 * f10_polynomial(t103);
    const float t106 = (t47 * t104) + (t67 * t105);
    const float t107 = t106 * t106;
    const float t108 = t106 * (estimator_field_1 + (t107 * (estimator_field_3 + (t107 * estimator_field_5))));
    const float t109 = (t43 * t80) + (t27 * yaw_change_sine) - t108;
    const float t110 = (t19 * yaw_change_sine) - (t23 * t79);
    const float t111 = t100 + t110;
    const float t112 = t111 * t111;
    const float t113 = f9_polynomial(t112);
    const float t114 = t111 * f10_polynomial(t112);
    const float t115 = (t55 * t113) + (t70 * t114);
    const float t116 = t115 * t115;
    const float t117 = t115 * (estimator_field_1 + (t116 * (estimator_field_3 + (t116 * estimator_field_5))));
    const float t118 = (t51 * t80) + (t35 * yaw_change_sine) - t117;
    const float cost_1 = (t90 * t90) + (t99 * t99) + (t109 * t109) + (t118 * t118) + (0.00992376f * ((t81 * t81) + (t100 * t100) + (277.5826f * t78)));
    const bool t119 = cost_1 <= ((1.000002f * cost_0) + 1e-08f);
    const float t120 = ((t59 * t85) - (t31 * t86)) * (estimator_slope_0 + (t88 * (estimator_slope_2 + (t88 * estimator_slope_4))));
    const float t121 = t108 - (t120 * (t15 + t101));
    const float t122 = ((t62 * t94) - (t39 * t95)) * (estimator_slope_0 + (t97 * (estimator_slope_2 + (t97 * estimator_slope_4))));
    const float t123 = t117 - (t122 * (t23 + t110));
    const float t124 = (t120 * t121) + (t122 * t123);
    const float t125 = (t120 * t123) - (t122 * t121);
    const float t126 = 1.0f / (0.00992376f + ((t120 * t120) + (t122 * t122)));
    const float t127 = ((0.00992376f * ((t121 * t90) + (t123 * t99) + (t81 * t124))) + (t125 * ((t120 * t99) - (t122 * t90)))) * t126;
    const float t128 = ((t67 * t104) - (t47 * t105)) * (estimator_slope_0 + (t107 * (estimator_slope_2 + (t107 * estimator_slope_4))));
    const float t129 = (t128 * (t10 - t82)) - t89;
    const float t130 = ((t70 * t113) - (t55 * t114)) * (estimator_slope_0 + (t116 * (estimator_slope_2 + (t116 * estimator_slope_4))));
    const float t131 = (t130 * (t19 - t91)) - t98;
    const float t132 = (t128 * t129) + (t130 * t131);
    const float t133 = (t128 * t131) - (t130 * t129);
    const float t134 = 1.0f / (0.00992376f + ((t128 * t128) + (t130 * t130)));
    const float t135 = ((0.00992376f * ((t129 * t109) + (t131 * t118) + (t100 * t132))) + (t133 * ((t128 * t118) - (t130 * t109)))) * t134;
    const float t136 = (((0.00992376f * ((t121 * t121) + (t123 * t123))) + (t125 * t125)) * t126) + (((0.00992376f * ((t129 * t129) + (t131 * t131))) + (t133 * t133)) * t134);
    float t137 = t77;
    float t138 = t81;
    float t139 = t100;
    float t140 = cost_1;
    if (!t119) {
        t137 = 0.0f;
        t138 = 0.0f;
        t139 = 0.0f;
        t140 = cost_0;
    }
    const float t141 = limit((t119) ? (t77 + ((t127 + t135 - (2.7546635f * t77)) / (2.7546635f + t136))) : (0.5f * (t77 + t137)), 0.10100254f);
    const float t142 = t141 * t141;
    const float yaw_change_sine_2 = t141 * yaw_change_sine_polynomial(t142);
    const float half_yaw_change_sine_2 = t141 * half_yaw_change_sine_polynomial(t142);
    const float t143 = half_yaw_change_sine_2 * half_yaw_change_sine_2;
    const float t144 = 1.0f - t143;
    const float t145 = t141 - t77;
    const float t146 = (t119) ? (t81 + (((t120 * t90) + (t122 * t99) - (0.00992376f * t81) - (t124 * t145)) * t126)) : (0.5f * (t81 + t138));
    const float t147 = limit(t146, 0.5f);
    const float t148 = (t10 * t143) + (t15 * yaw_change_sine_2);
    const float t149 = t147 - t148;
    const float t150 = t149 * t149;
    const float t151 = f9_polynomial(t150);
    const float t152 = t149 * f10_polynomial(t150);
    const float t153 = (t31 * t151) + (t59 * t152);
    const float t154 = t153 * t153;
    const float t155 = t153 * (estimator_field_1 + (t154 * (estimator_field_3 + (t154 * estimator_field_5))));
    const float t156 = (t27 * t144) - (t43 * yaw_change_sine_2) - t155;
    const float t157 = (t19 * t143) + (t23 * yaw_change_sine_2);
    const float t158 = t147 - t157;
    const float t159 = t158 * t158;
    const float t160 = f9_polynomial(t159);
    const float t161 = t158 * f10_polynomial(t159);
    const float t162 = (t39 * t160) + (t62 * t161);
    const float t163 = t162 * t162;
    const float t164 = t162 * (estimator_field_1 + (t163 * (estimator_field_3 + (t163 * estimator_field_5))));
    const float t165 = (t35 * t144) - (t51 * yaw_change_sine_2) - t164;
    const float t166 = (t119) ? (t100 + (((t128 * t109) + (t130 * t118) - (0.00992376f * t100) - (t132 * t145)) * t134)) : (0.5f * (t100 + t139));
    const float t167 = limit(t166, 0.5f);
    const float t168 = (t10 * yaw_change_sine_2) - (t15 * t143);
    const float t169 = t167 + t168;
    const float t170 = t169 * t169;
    const float t171 = f9_polynomial(t170);
    const float t172 = t169 * f10_polynomial(t170);
    const float t173 = (t47 * t171) + (t67 * t172);
    const float t174 = t173 * t173;
    const float t175 = t173 * (estimator_field_1 + (t174 * (estimator_field_3 + (t174 * estimator_field_5))));
    const float t176 = (t43 * t144) + (t27 * yaw_change_sine_2) - t175;
    const float t177 = (t19 * yaw_change_sine_2) - (t23 * t143);
    const float t178 = t167 + t177;
    const float t179 = t178 * t178;
    const float t180 = f9_polynomial(t179);
    const float t181 = t178 * f10_polynomial(t179);
    const float t182 = (t55 * t180) + (t70 * t181);
    const float t183 = t182 * t182;
    const float t184 = t182 * (estimator_field_1 + (t183 * (estimator_field_3 + (t183 * estimator_field_5))));
    const float t185 = (t51 * t144) + (t35 * yaw_change_sine_2) - t184;
    const float cost_2 = (t156 * t156) + (t165 * t165) + (t176 * t176) + (t185 * t185) + (0.00992376f * ((t147 * t147) + (t167 * t167) + (277.5826f * t142)));
    const bool t186 = cost_2 <= ((1.000002f * t140) + 1e-08f);
    const float t187 = ((t59 * t151) - (t31 * t152)) * (estimator_slope_0 + (t154 * (estimator_slope_2 + (t154 * estimator_slope_4))));
    const float t188 = t175 - (t187 * (t15 + t168));
    const float t189 = ((t62 * t160) - (t39 * t161)) * (estimator_slope_0 + (t163 * (estimator_slope_2 + (t163 * estimator_slope_4))));
    const float t190 = t184 - (t189 * (t23 + t177));
    const float t191 = (t187 * t188) + (t189 * t190);
    const float t192 = (t187 * t190) - (t189 * t188);
    const float t193 = 1.0f / (0.00992376f + ((t187 * t187) + (t189 * t189)));
    const float t194 = ((0.00992376f * ((t188 * t156) + (t190 * t165) + (t147 * t191))) + (t192 * ((t187 * t165) - (t189 * t156)))) * t193;
    const float t195 = ((t67 * t171) - (t47 * t172)) * (estimator_slope_0 + (t174 * (estimator_slope_2 + (t174 * estimator_slope_4))));
    const float t196 = (t195 * (t10 - t148)) - t155;
    const float t197 = ((t70 * t180) - (t55 * t181)) * (estimator_slope_0 + (t183 * (estimator_slope_2 + (t183 * estimator_slope_4))));
    const float t198 = (t197 * (t19 - t157)) - t164;
    const float t199 = (t195 * t196) + (t197 * t198);
    const float t200 = (t195 * t198) - (t197 * t196);
    const float t201 = 1.0f / (0.00992376f + ((t195 * t195) + (t197 * t197)));
    const float t202 = ((0.00992376f * ((t196 * t176) + (t198 * t185) + (t167 * t199))) + (t200 * ((t195 * t185) - (t197 * t176)))) * t201;
    const float t203 = (((0.00992376f * ((t188 * t188) + (t190 * t190))) + (t192 * t192)) * t193) + (((0.00992376f * ((t196 * t196) + (t198 * t198))) + (t200 * t200)) * t201);
    float t204 = t141;
    float t205 = t147;
    float t206 = t167;
    float t207 = cost_2;
    if (!t186) {
        t204 = t137;
        t205 = t138;
        t206 = t139;
        t207 = t140;
    }
    const float t208 = limit((t186) ? (t141 + ((t194 + t202 - (2.7546635f * t141)) / (2.7546635f + t203))) : (0.5f * (t141 + t204)), 0.10100254f);
    const float t209 = t208 * t208;
    const float yaw_change_sine_3 = t208 * yaw_change_sine_polynomial(t209);
    const float half_yaw_change_sine_3 = t208 * half_yaw_change_sine_polynomial(t209);
    const float t210 = half_yaw_change_sine_3 * half_yaw_change_sine_3;
    const float t211 = 1.0f - t210;
    const float t212 = t208 - t141;
    const float t213 = (t186) ? (t147 + (((t187 * t156) + (t189 * t165) - (0.00992376f * t147) - (t191 * t212)) * t193)) : (0.5f * (t147 + t205));
    const float t214 = limit(t213, 0.5f);
    const float t215 = (t10 * t210) + (t15 * yaw_change_sine_3);
    const float t216 = t214 - t215;
    const float t217 = t216 * t216;
    const float t218 = f9_polynomial(t217);
    const float t219 = t216 * f10_polynomial(t217);
    const float t220 = (t31 * t218) + (t59 * t219);
    const float t221 = t220 * t220;
    const float t222 = t220 * (estimator_field_1 + (t221 * (estimator_field_3 + (t221 * estimator_field_5))));
    const float t223 = (t27 * t211) - (t43 * yaw_change_sine_3) - t222;
    const float t224 = (t19 * t210) + (t23 * yaw_change_sine_3);
    const float t225 = t214 - t224;
    const float t226 = t225 * t225;
    const float t227 = f9_polynomial(t226);
    const float t228 = t225 * f10_polynomial(t226);
    const float t229 = (t39 * t227) + (t62 * t228);
    const float t230 = t229 * t229;
    const float t231 = t229 * (estimator_field_1 + (t230 * (estimator_field_3 + (t230 * estimator_field_5))));
    const float t232 = (t35 * t211) - (t51 * yaw_change_sine_3) - t231;
    const float t233 = (t186) ? (t167 + (((t195 * t176) + (t197 * t185) - (0.00992376f * t167) - (t199 * t212)) * t201)) : (0.5f * (t167 + t206));
    const float t234 = limit(t233, 0.5f);
    const float t235 = (t10 * yaw_change_sine_3) - (t15 * t210);
    const float t236 = t234 + t235;
    const float t237 = t236 * t236;
    const float t238 = f9_polynomial(t237);
    const float t239 = t236 * f10_polynomial(t237);
    const float t240 = (t47 * t238) + (t67 * t239);
    const float t241 = t240 * t240;
    const float t242 = t240 * (estimator_field_1 + (t241 * (estimator_field_3 + (t241 * estimator_field_5))));
    const float t243 = (t43 * t211) + (t27 * yaw_change_sine_3) - t242;
    const float t244 = (t19 * yaw_change_sine_3) - (t23 * t210);
    const float t245 = t234 + t244;
    const float t246 = t245 * t245;
    const float t247 = f9_polynomial(t246);
    const float t248 = t245 * f10_polynomial(t246);
    const float t249 = (t55 * t247) + (t70 * t248);
    const float t250 = t249 * t249;
    const float t251 = t249 * (estimator_field_1 + (t250 * (estimator_field_3 + (t250 * estimator_field_5))));
    const float t252 = (t51 * t211) + (t35 * yaw_change_sine_3) - t251;
    const float cost_3 = (t223 * t223) + (t232 * t232) + (t243 * t243) + (t252 * t252) + (0.00992376f * ((t214 * t214) + (t234 * t234) + (277.5826f * t209)));
    const bool t253 = cost_3 <= ((1.000002f * t207) + 1e-08f);
    const float t254 = ((t59 * t218) - (t31 * t219)) * (estimator_slope_0 + (t221 * (estimator_slope_2 + (t221 * estimator_slope_4))));
    const float t255 = t242 - (t254 * (t15 + t235));
    const float t256 = ((t62 * t227) - (t39 * t228)) * (estimator_slope_0 + (t230 * (estimator_slope_2 + (t230 * estimator_slope_4))));
    const float t257 = t251 - (t256 * (t23 + t244));
    const float t258 = (t254 * t255) + (t256 * t257);
    const float t259 = (t254 * t257) - (t256 * t255);
    const float t260 = 1.0f / (0.00992376f + ((t254 * t254) + (t256 * t256)));
    const float t261 = ((0.00992376f * ((t255 * t223) + (t257 * t232) + (t214 * t258))) + (t259 * ((t254 * t232) - (t256 * t223)))) * t260;
    const float t262 = ((t67 * t238) - (t47 * t239)) * (estimator_slope_0 + (t241 * (estimator_slope_2 + (t241 * estimator_slope_4))));
    const float t263 = (t262 * (t10 - t215)) - t222;
    const float t264 = ((t70 * t247) - (t55 * t248)) * (estimator_slope_0 + (t250 * (estimator_slope_2 + (t250 * estimator_slope_4))));
    const float t265 = (t264 * (t19 - t224)) - t231;
    const float t266 = (t262 * t263) + (t264 * t265);
    const float t267 = (t262 * t265) - (t264 * t263);
    const float t268 = 1.0f / (0.00992376f + ((t262 * t262) + (t264 * t264)));
    const float t269 = ((0.00992376f * ((t263 * t243) + (t265 * t252) + (t234 * t266))) + (t267 * ((t262 * t252) - (t264 * t243)))) * t268;
    const float t270 = (((0.00992376f * ((t255 * t255) + (t257 * t257))) + (t259 * t259)) * t260) + (((0.00992376f * ((t263 * t263) + (t265 * t265))) + (t267 * t267)) * t268);
    float t271 = t208;
    float t272 = t214;
    float t273 = t234;
    float t274 = cost_3;
    if (!t253) {
        t271 = t204;
        t272 = t205;
        t273 = t206;
        t274 = t207;
    }
    const float t275 = limit((t253) ? (t208 + ((t261 + t269 - (2.7546635f * t208)) / (2.7546635f + t270))) : (0.5f * (t208 + t271)), 0.10100254f);
    const float t276 = t275 * t275;
    const float yaw_change_sine_4 = t275 * yaw_change_sine_polynomial(t276);
    const float half_yaw_change_sine_4 = t275 * half_yaw_change_sine_polynomial(t276);
    const float t277 = half_yaw_change_sine_4 * half_yaw_change_sine_4;
    const float t278 = 1.0f - t277;
    const float t279 = t275 - t208;
    const float t280 = (t253) ? (t214 + (((t254 * t223) + (t256 * t232) - (0.00992376f * t214) - (t258 * t279)) * t260)) : (0.5f * (t214 + t272));
    const float t281 = limit(t280, 0.5f);
    const float t282 = (t10 * t277) + (t15 * yaw_change_sine_4);
    const float t283 = t281 - t282;
    const float t284 = t283 * t283;
    const float t285 = f9_polynomial(t284);
    const float t286 = t283 * f10_polynomial(t284);
    const float t287 = (t31 * t285) + (t59 * t286);
    const float t288 = t287 * t287;
    const float t289 = t287 * (estimator_field_1 + (t288 * (estimator_field_3 + (t288 * estimator_field_5))));
    const float t290 = (t27 * t278) - (t43 * yaw_change_sine_4) - t289;
    const float t291 = (t19 * t277) + (t23 * yaw_change_sine_4);
    const float t292 = t281 - t291;
    const float t293 = t292 * t292;
    const float t294 = f9_polynomial(t293);
    const float t295 = t292 * f10_polynomial(t293);
    const float t296 = (t39 * t294) + (t62 * t295);
    const float t297 = t296 * t296;
    const float t298 = t296 * (estimator_field_1 + (t297 * (estimator_field_3 + (t297 * estimator_field_5))));
    const float t299 = (t35 * t278) - (t51 * yaw_change_sine_4) - t298;
    const float t300 = (t253) ? (t234 + (((t262 * t243) + (t264 * t252) - (0.00992376f * t234) - (t266 * t279)) * t268)) : (0.5f * (t234 + t273));
    const float t301 = limit(t300, 0.5f);
    const float t302 = (t10 * yaw_change_sine_4) - (t15 * t277);
    const float t303 = t301 + t302;
    const float t304 = t303 * t303;
    const float t305 = f9_polynomial(t304);
    const float t306 = t303 * f10_polynomial(t304);
    const float t307 = (t47 * t305) + (t67 * t306);
    const float t308 = t307 * t307;
    const float t309 = t307 * (estimator_field_1 + (t308 * (estimator_field_3 + (t308 * estimator_field_5))));
    const float t310 = (t43 * t278) + (t27 * yaw_change_sine_4) - t309;
    const float t311 = (t19 * yaw_change_sine_4) - (t23 * t277);
    const float t312 = t301 + t311;
    const float t313 = t312 * t312;
    const float t314 = f9_polynomial(t313);
    const float t315 = t312 * f10_polynomial(t313);
    const float t316 = (t55 * t314) + (t70 * t315);
    const float t317 = t316 * t316;
    const float t318 = t316 * (estimator_field_1 + (t317 * (estimator_field_3 + (t317 * estimator_field_5))));
    const float t319 = (t51 * t278) + (t35 * yaw_change_sine_4) - t318;
    const float t320 = (t290 * t290) + (t299 * t299) + (t310 * t310) + (t319 * t319);
    const float t321 = (t281 * t281) + (t301 * t301);
    const float cost_4 = t320 + (0.00992376f * (t321 + (277.5826f * t276)));
    const uint32_t estimator_ambiguity_resolved = state->estimator_ambiguity_resolved;
    const bool t322 = 0.0009069143f < (t321 + (11.103305f * t276));
    const uint32_t estimator_searching = state->estimator_searching;
    const bool t323 = cost_4 <= ((1.000002f * t274) + 1e-08f);
    const float t324 = ((t59 * t285) - (t31 * t286)) * (estimator_slope_0 + (t288 * (estimator_slope_2 + (t288 * estimator_slope_4))));
    const float t325 = t309 - (t324 * (t15 + t302));
    const float t326 = ((t62 * t294) - (t39 * t295)) * (estimator_slope_0 + (t297 * (estimator_slope_2 + (t297 * estimator_slope_4))));
    const float t327 = t318 - (t326 * (t23 + t311));
    const float t328 = (t324 * t325) + (t326 * t327);
    const float t329 = (t324 * t327) - (t326 * t325);
    const float t330 = 1.0f / (0.00992376f + ((t324 * t324) + (t326 * t326)));
    const float t331 = ((0.00992376f * ((t325 * t290) + (t327 * t299) + (t281 * t328))) + (t329 * ((t324 * t299) - (t326 * t290)))) * t330;
    const float t332 = ((t67 * t305) - (t47 * t306)) * (estimator_slope_0 + (t308 * (estimator_slope_2 + (t308 * estimator_slope_4))));
    const float t333 = (t332 * (t10 - t282)) - t289;
    const float t334 = ((t70 * t314) - (t55 * t315)) * (estimator_slope_0 + (t317 * (estimator_slope_2 + (t317 * estimator_slope_4))));
    const float t335 = (t334 * (t19 - t291)) - t298;
    const float t336 = (t332 * t333) + (t334 * t335);
    const float t337 = (t332 * t335) - (t334 * t333);
    const float t338 = 1.0f / (0.00992376f + ((t332 * t332) + (t334 * t334)));
    const float t339 = ((0.00992376f * ((t333 * t310) + (t335 * t319) + (t301 * t336))) + (t337 * ((t332 * t319) - (t334 * t310)))) * t338;
    const float t340 = t331 + t339 - (2.7546635f * t275);
    const float t341 = (((0.00992376f * ((t325 * t325) + (t327 * t327))) + (t329 * t329)) * t330) + (((0.00992376f * ((t333 * t333) + (t335 * t335))) + (t337 * t337)) * t338);
    const float t342 = 1.0f / (2.7546635f + t341);
    const float t343 = (t324 * t290) + (t326 * t299) - (0.00992376f * t281);
    const float t344 = (t332 * t310) + (t334 * t319) - (0.00992376f * t301);
    const bool converged = t323 && (((t340 * t340 * t342) + (t343 * t343 * t330) + (t344 * t344 * t338)) <= 1e-08f);
    float t345;
    float t346;
    float t347;
    if (converged) {
        const float t348 = limit(t275 + (t340 * t342), 0.10100254f);
        t345 = t348;
        const float t349 = t348 - t275;
        t346 = limit(t281 + ((t343 - (t328 * t349)) * t330), 0.5f);
        t347 = limit(t301 + ((t344 - (t336 * t349)) * t338), 0.5f);
    } else {
        if (t323) {
            t345 = t275;
            t346 = t281;
            t347 = t301;
        } else {
            t345 = t271;
            t346 = t272;
            t347 = t273;
        }
    }
    const float estimator_yaw_last_good = state->estimator_yaw_last_good;
    const bool t350 = fabsf(t1 + t345 - estimator_yaw_last_good) <= 0.08726646f;
    const bool t351 = (0.01f < t320) || ((estimator_ambiguity_resolved != 0u) ? t322 : ((estimator_searching != 0u) && !t350));
    const bool t352 = !(estimator_searching != 0u);
    float t353 = 0.0f;
    float t354 = 0.0f;
    float t355 = 0.0f;
    float t356 = 0.0f;
    float t357 = 0.0f;
    float t358 = 0.0f;
    if (!(t351 && t352)) {
        t353 = t346;
        t354 = t347;
        t355 = t345;
        t356 = 0.5f * t346;
        t357 = 0.5f * t347;
        t358 = 0.1f * t345;
    }
    const float t359 = t4 + t353;
    float t360 = t359;
    bool t361 = true;
    if (3.1415927f < t359) {
        t360 = t359 - 6.2831855f;
    } else {
        t361 = false;
    }
    float t362 = t360;
    float t363 = -1.0f;
    if (t360 < -3.1415927f) {
        t362 = t360 + 6.2831855f;
    } else {
        t363 = t361 ? 1.0f : 0.0f;
    }
    const float estimator_pitch_x = state->estimator_pitch_x;
    const float t364 = estimator_pitch_x + t363;
    const float X = (0.008085071f * t362) + (0.0508f * t364);
    const float t365 = t14 + t354;
    float t366 = t365;
    bool t367 = true;
    if (3.1415927f < t365) {
        t366 = t365 - 6.2831855f;
    } else {
        t367 = false;
    }
    float t368 = t366;
    float t369 = -1.0f;
    if (t366 < -3.1415927f) {
        t368 = t366 + 6.2831855f;
    } else {
        t369 = t367 ? 1.0f : 0.0f;
    }
    const float estimator_pitch_y = state->estimator_pitch_y;
    const float t370 = estimator_pitch_y + t369;
    const float Y = (0.008085071f * t368) + (0.0508f * t370);
    const float t371 = t1 + t355;
    float t372 = t371;
    if (3.1415927f < t371) {
        t372 = t371 - 6.2831855f;
    }
    float yaw = t372;
    if (t372 < -3.1415927f) {
        yaw = t372 + 6.2831855f;
    }
    const float t373 = t328 * t330;
    const float t374 = t373 * t373;
    const float t375 = 1.0f / (t341 + 0.11018653f);
    const float deviation_X = 8.085071e-06f * sqrtf(t330 + (t374 * t375));
    out->deviation_X = deviation_X;
    const float t376 = t336 * t338;
    const float t377 = t376 * t376;
    const float deviation_Y = 8.085071e-06f * sqrtf(t338 + (t377 * t375));
    out->deviation_Y = deviation_Y;
    const float deviation_yaw = 0.001f * sqrtf(t375);
    out->deviation_yaw = deviation_yaw;
    const float residual = sqrtf(1e-30f + t320);
    out->residual = residual;
    out->X = X;
    out->Y = Y;
    out->yaw = yaw;
    out->converged = converged ? 1.0f : 0.0f;
    const float t378 = ((11.103305f + t374 + t377) * t375) + (t330 + t338);
    const bool damped = 15.115238f < t378;
    out->damped = damped ? 1.0f : 0.0f;
    const bool t379 = converged && !(damped || t351 || t322);
    const bool t380 = (1.0f != 0.0f) && (fabsf(t364) <= 8.0f) && (fabsf(t370) <= 8.0f);
    const float t381 = fabsf(yaw);
    const bool t382 = t380 && (t381 <= 0.04363323f);
    const bool t383 = (t379 && t350 && t352 && (t378 <= 0.403073f) && complete && t382) || ((estimator_ambiguity_resolved != 0u) && !damped);
    const uint32_t estimator_lock_lost = state->estimator_lock_lost;
    const bool valid = t379 && t383 && !(estimator_lock_lost != 0u) && t382 && complete;
    const uint32_t estimator_residual_faults = state->estimator_residual_faults;
    const bool t384 = 4u <= estimator_residual_faults;
    const bool t385 = t351 && t384;
    const bool t386 = !t351;
    if (t385) {
        const float estimator_start_x = state->estimator_start_x;
        const float t387 = estimator_start_x + -1.5401491f;
        if (t387 < -3.1415927f) {
            const float t388 = t387 + 6.2831855f;
            state->estimator_phase_x = t388;
            state->estimator_start_x = t388;
        } else {
            state->estimator_phase_x = t387;
            state->estimator_start_x = t387;
        }
        const float estimator_start_y = state->estimator_start_y;
        const float t389 = estimator_start_y + -2.702773f;
        if (t389 < -3.1415927f) {
            const float t390 = t389 + 6.2831855f;
            state->estimator_phase_y = t390;
            state->estimator_start_y = t390;
        } else {
            state->estimator_phase_y = t389;
            state->estimator_start_y = t389;
        }
        state->estimator_yaw = estimator_yaw_last_good;
        state->estimator_searching = 1u;
        state->estimator_ambiguity_resolved = 0u;
    } else {
        state->estimator_phase_x = t362;
        state->estimator_phase_y = t368;
        state->estimator_yaw = yaw;
        if (converged && t386) {
            state->estimator_searching = 0u;
        }
        state->estimator_ambiguity_resolved = flag(t383);
    }
    if (t383 && t386) {
        state->estimator_yaw_last_good = yaw;
    }
    const float estimator_pitch_x_next = limit(t364, 8.0f);
    state->estimator_pitch_x = estimator_pitch_x_next;
    const float estimator_pitch_y_next = limit(t370, 8.0f);
    state->estimator_pitch_y = estimator_pitch_y_next;
    float t391 = 0.0f;
    float t392 = 0.0f;
    float t393 = 0.0f;
    if (!(estimator_searching != 0u)) {
        t391 = estimator_motion_x + t356;
        t392 = estimator_motion_y + t357;
        t393 = estimator_motion_yaw + t358;
    }
    const float estimator_motion_x_next = limit(t391, 0.5f);
    state->estimator_motion_x = estimator_motion_x_next;
    const float estimator_motion_y_next = limit(t392, 0.5f);
    state->estimator_motion_y = estimator_motion_y_next;
    const float estimator_motion_yaw_next = limit(t393, 0.10100254f);
    state->estimator_motion_yaw = estimator_motion_yaw_next;
    const uint32_t estimator_residual_faults_next = (t351) ? ((t384) ? 0u : (estimator_residual_faults + 1u)) : 0u;
    state->estimator_residual_faults = estimator_residual_faults_next;
    const uint32_t estimator_acquired = state->estimator_acquired;
    const bool estimator_acquired_next = t383 || (estimator_acquired != 0u);
    state->estimator_acquired = flag(estimator_acquired_next);
    const bool estimator_lock_lost_next = (estimator_lock_lost != 0u) || ((estimator_acquired != 0u) && (t385 || !t380 || (((t383) ? 0.04363323f : 0.08726646f) < t381)));
    state->estimator_lock_lost = flag(estimator_lock_lost_next);
    out->valid = valid ? 1.0f : 0.0f;
    out->lock_lost = (float)estimator_lock_lost;

    return faults;
}
