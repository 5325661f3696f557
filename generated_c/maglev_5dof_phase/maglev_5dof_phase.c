/* maglev_5dof_phase. Generated: do not edit. */
#include "maglev_5dof_phase.h"
#include <math.h>

static inline float min(float a, float b)
{
    return (a < b) ? a : b;
}

static inline float max(float a, float b)
{
    return (a > b) ? a : b;
}

void maglev_5dof_phase_init(maglev_5dof_phase_state_t *state)
{
    state->guard_last_i_d1 = 2.5f;
    state->guard_last_i_d2 = 2.5f;
    state->guard_last_i_d3 = 2.5f;
    state->guard_last_i_d4 = 2.5f;
    state->guard_last_i_q1 = 0.0f;
    state->guard_last_i_q2 = 0.0f;
    state->guard_last_i_q3 = 0.0f;
    state->guard_last_i_q4 = 0.0f;
    state->guard_last_x = 0.0f;
    state->guard_last_z = 0.0f;
}

uint32_t maglev_5dof_phase_step(maglev_5dof_phase_state_t *state, const maglev_5dof_phase_input_t *in, maglev_5dof_phase_output_t *out)
{
    /* guard: range acceptance, hold, latch */
    const float i_d1 = in->i_d1;
    const int t5 = -4.9497476f <= i_d1 && i_d1 <= 4.9497476f;
    const int fault_i_d1 = !t5;
    const float guard_last_i_d1 = state->guard_last_i_d1;
    const float i_d1_held = (t5) ? i_d1 : guard_last_i_d1;
    const float i_d2 = in->i_d2;
    const int t12 = -4.9497476f <= i_d2 && i_d2 <= 4.9497476f;
    const int fault_i_d2 = !t12;
    const float guard_last_i_d2 = state->guard_last_i_d2;
    const float i_d2_held = (t12) ? i_d2 : guard_last_i_d2;
    const float i_d3 = in->i_d3;
    const int t19 = -4.9497476f <= i_d3 && i_d3 <= 4.9497476f;
    const int fault_i_d3 = !t19;
    const float guard_last_i_d3 = state->guard_last_i_d3;
    const float i_d3_held = (t19) ? i_d3 : guard_last_i_d3;
    const float i_d4 = in->i_d4;
    const int t26 = -4.9497476f <= i_d4 && i_d4 <= 4.9497476f;
    const int fault_i_d4 = !t26;
    const float guard_last_i_d4 = state->guard_last_i_d4;
    const float i_d4_held = (t26) ? i_d4 : guard_last_i_d4;
    const float i_q1 = in->i_q1;
    const int t33 = -4.9497476f <= i_q1 && i_q1 <= 4.9497476f;
    const int fault_i_q1 = !t33;
    const float guard_last_i_q1 = state->guard_last_i_q1;
    const float i_q1_held = (t33) ? i_q1 : guard_last_i_q1;
    const float i_q2 = in->i_q2;
    const int t40 = -4.9497476f <= i_q2 && i_q2 <= 4.9497476f;
    const int fault_i_q2 = !t40;
    const float guard_last_i_q2 = state->guard_last_i_q2;
    const float i_q2_held = (t40) ? i_q2 : guard_last_i_q2;
    const float i_q3 = in->i_q3;
    const int t47 = -4.9497476f <= i_q3 && i_q3 <= 4.9497476f;
    const int fault_i_q3 = !t47;
    const float guard_last_i_q3 = state->guard_last_i_q3;
    const float i_q3_held = (t47) ? i_q3 : guard_last_i_q3;
    const float i_q4 = in->i_q4;
    const int t54 = -4.9497476f <= i_q4 && i_q4 <= 4.9497476f;
    const int fault_i_q4 = !t54;
    const float guard_last_i_q4 = state->guard_last_i_q4;
    const float i_q4_held = (t54) ? i_q4 : guard_last_i_q4;
    const float x = in->x;
    const int t63 = -0.1f <= x && x <= 0.1f;
    const int fault_x = !t63;
    const float guard_last_x = state->guard_last_x;
    const float x_held = (t63) ? x : guard_last_x;
    const float z = in->z;
    const int t70 = -0.1f <= z && z <= 0.1f;
    const int fault_z = !t70;
    const float guard_last_z = state->guard_last_z;
    const float z_held = (t70) ? z : guard_last_z;

    /* commutation: inverse Park */
    const float t80 = 3.1415927f * z_held / 0.05715f + 1.5707964f;
    const float t81 = cosf(t80);
    const float t83 = sinf(t80);
    const float i_a1 = 1.4142135f * (i_d1_held * t81 - i_q1_held * t83);
    const float t88 = t80 - 2.0943952f;
    const float t89 = cosf(t88);
    const float t91 = sinf(t88);
    const float i_b1 = 1.4142135f * (i_d1_held * t89 - i_q1_held * t91);
    const float t95 = t80 + 2.0943952f;
    const float t96 = cosf(t95);
    const float t98 = sinf(t95);
    const float i_c1 = 1.4142135f * (i_d1_held * t96 - i_q1_held * t98);
    const float t104 = 3.1415927f * x_held / 0.05715f + 1.5707964f;
    const float t105 = cosf(t104);
    const float t107 = sinf(t104);
    const float i_a2 = 1.4142135f * (i_d2_held * t105 - i_q2_held * t107);
    const float t111 = t104 - 2.0943952f;
    const float t112 = cosf(t111);
    const float t114 = sinf(t111);
    const float i_b2 = 1.4142135f * (i_d2_held * t112 - i_q2_held * t114);
    const float t118 = t104 + 2.0943952f;
    const float t119 = cosf(t118);
    const float t121 = sinf(t118);
    const float i_c2 = 1.4142135f * (i_d2_held * t119 - i_q2_held * t121);
    const float i_a3 = 1.4142135f * (i_d3_held * t81 - i_q3_held * t83);
    const float i_b3 = 1.4142135f * (i_d3_held * t89 - i_q3_held * t91);
    const float i_c3 = 1.4142135f * (i_d3_held * t96 - i_q3_held * t98);
    const float i_a4 = 1.4142135f * (i_d4_held * t105 - i_q4_held * t107);
    const float i_b4 = 1.4142135f * (i_d4_held * t112 - i_q4_held * t114);
    const float i_c4 = 1.4142135f * (i_d4_held * t119 - i_q4_held * t121);

    state->guard_last_i_d1 = max(min(i_d1_held, 4.9497476f), -4.9497476f);
    state->guard_last_i_d2 = max(min(i_d2_held, 4.9497476f), -4.9497476f);
    state->guard_last_i_d3 = max(min(i_d3_held, 4.9497476f), -4.9497476f);
    state->guard_last_i_d4 = max(min(i_d4_held, 4.9497476f), -4.9497476f);
    state->guard_last_i_q1 = max(min(i_q1_held, 4.9497476f), -4.9497476f);
    state->guard_last_i_q2 = max(min(i_q2_held, 4.9497476f), -4.9497476f);
    state->guard_last_i_q3 = max(min(i_q3_held, 4.9497476f), -4.9497476f);
    state->guard_last_i_q4 = max(min(i_q4_held, 4.9497476f), -4.9497476f);
    state->guard_last_x = max(min(x_held, 0.1f), -0.1f);
    state->guard_last_z = max(min(z_held, 0.1f), -0.1f);
    out->i_a1 = i_a1;
    out->i_b1 = i_b1;
    out->i_c1 = i_c1;
    out->i_a2 = i_a2;
    out->i_b2 = i_b2;
    out->i_c2 = i_c2;
    out->i_a3 = i_a3;
    out->i_b3 = i_b3;
    out->i_c3 = i_c3;
    out->i_a4 = i_a4;
    out->i_b4 = i_b4;
    out->i_c4 = i_c4;
    return (fault_i_d1 ? 0x00000001u : 0u)
        | (fault_i_d2 ? 0x00000002u : 0u)
        | (fault_i_d3 ? 0x00000004u : 0u)
        | (fault_i_d4 ? 0x00000008u : 0u)
        | (fault_i_q1 ? 0x00000010u : 0u)
        | (fault_i_q2 ? 0x00000020u : 0u)
        | (fault_i_q3 ? 0x00000040u : 0u)
        | (fault_i_q4 ? 0x00000080u : 0u)
        | (fault_x ? 0x00000100u : 0u)
        | (fault_z ? 0x00000200u : 0u);
}
