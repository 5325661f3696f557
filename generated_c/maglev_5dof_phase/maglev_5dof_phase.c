/* maglev_5dof_phase. Generated: do not edit. */
#include "maglev_5dof_phase.h"
#include <math.h>
#include <stdbool.h>

static inline float limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
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
    float i_d1_held = i_d1;
    uint32_t faults = 0u;
    if (fabsf(i_d1) <= 4.9497476f) {
        state->guard_last_i_d1 = i_d1;
    } else {
        i_d1_held = state->guard_last_i_d1;
        faults = 0x00000001u;
    }
    const float i_d2 = in->i_d2;
    float i_d2_held = i_d2;
    if (fabsf(i_d2) <= 4.9497476f) {
        state->guard_last_i_d2 = i_d2;
    } else {
        i_d2_held = state->guard_last_i_d2;
        faults |= 0x00000002u;
    }
    const float i_d3 = in->i_d3;
    float i_d3_held = i_d3;
    if (fabsf(i_d3) <= 4.9497476f) {
        state->guard_last_i_d3 = i_d3;
    } else {
        i_d3_held = state->guard_last_i_d3;
        faults |= 0x00000004u;
    }
    const float i_d4 = in->i_d4;
    float i_d4_held = i_d4;
    if (fabsf(i_d4) <= 4.9497476f) {
        state->guard_last_i_d4 = i_d4;
    } else {
        i_d4_held = state->guard_last_i_d4;
        faults |= 0x00000008u;
    }
    const float i_q1 = in->i_q1;
    float i_q1_held = i_q1;
    if (fabsf(i_q1) <= 4.9497476f) {
        state->guard_last_i_q1 = i_q1;
    } else {
        i_q1_held = state->guard_last_i_q1;
        faults |= 0x00000010u;
    }
    const float i_q2 = in->i_q2;
    float i_q2_held = i_q2;
    if (fabsf(i_q2) <= 4.9497476f) {
        state->guard_last_i_q2 = i_q2;
    } else {
        i_q2_held = state->guard_last_i_q2;
        faults |= 0x00000020u;
    }
    const float i_q3 = in->i_q3;
    float i_q3_held = i_q3;
    if (fabsf(i_q3) <= 4.9497476f) {
        state->guard_last_i_q3 = i_q3;
    } else {
        i_q3_held = state->guard_last_i_q3;
        faults |= 0x00000040u;
    }
    const float i_q4 = in->i_q4;
    float i_q4_held = i_q4;
    if (fabsf(i_q4) <= 4.9497476f) {
        state->guard_last_i_q4 = i_q4;
    } else {
        i_q4_held = state->guard_last_i_q4;
        faults |= 0x00000080u;
    }
    const float x = in->x;
    float x_held = x;
    if (fabsf(x) <= 0.1f) {
        state->guard_last_x = x;
    } else {
        x_held = state->guard_last_x;
        faults |= 0x00000100u;
    }
    const float z = in->z;
    float z_held = z;
    if (fabsf(z) <= 0.1f) {
        state->guard_last_z = z;
    } else {
        z_held = state->guard_last_z;
        faults |= 0x00000200u;
    }

    /* commutation: phase currents, inverse Park */
    const float t1 = (54.971f * z_held) + 1.5707964f;
    const float t2 = cosf(t1);
    const float t3 = sinf(t1);
    const float i_a1 = limit(1.4142135f * ((i_d1_held * t2) - (i_q1_held * t3)), 9.899505f);
    out->i_a1 = i_a1;
    const float t4 = t1 - 2.0943952f;
    const float t5 = cosf(t4);
    const float t6 = sinf(t4);
    const float i_b1 = limit(1.4142135f * ((i_d1_held * t5) - (i_q1_held * t6)), 9.899505f);
    out->i_b1 = i_b1;
    const float t7 = t1 + 2.0943952f;
    const float t8 = cosf(t7);
    const float t9 = sinf(t7);
    const float i_c1 = limit(1.4142135f * ((i_d1_held * t8) - (i_q1_held * t9)), 9.899505f);
    out->i_c1 = i_c1;
    const float t10 = (54.971f * x_held) + 1.5707964f;
    const float t11 = cosf(t10);
    const float t12 = sinf(t10);
    const float i_a2 = limit(1.4142135f * ((i_d2_held * t11) - (i_q2_held * t12)), 9.899505f);
    out->i_a2 = i_a2;
    const float t13 = t10 - 2.0943952f;
    const float t14 = cosf(t13);
    const float t15 = sinf(t13);
    const float i_b2 = limit(1.4142135f * ((i_d2_held * t14) - (i_q2_held * t15)), 9.899505f);
    out->i_b2 = i_b2;
    const float t16 = t10 + 2.0943952f;
    const float t17 = cosf(t16);
    const float t18 = sinf(t16);
    const float i_c2 = limit(1.4142135f * ((i_d2_held * t17) - (i_q2_held * t18)), 9.899505f);
    out->i_c2 = i_c2;
    const float i_a3 = limit(1.4142135f * ((i_d3_held * t2) - (i_q3_held * t3)), 9.899505f);
    out->i_a3 = i_a3;
    const float i_b3 = limit(1.4142135f * ((i_d3_held * t5) - (i_q3_held * t6)), 9.899505f);
    out->i_b3 = i_b3;
    const float i_c3 = limit(1.4142135f * ((i_d3_held * t8) - (i_q3_held * t9)), 9.899505f);
    out->i_c3 = i_c3;
    const float i_a4 = limit(1.4142135f * ((i_d4_held * t11) - (i_q4_held * t12)), 9.899505f);
    out->i_a4 = i_a4;
    const float i_b4 = limit(1.4142135f * ((i_d4_held * t14) - (i_q4_held * t15)), 9.899505f);
    out->i_b4 = i_b4;
    const float i_c4 = limit(1.4142135f * ((i_d4_held * t17) - (i_q4_held * t18)), 9.899505f);
    out->i_c4 = i_c4;

    return faults;
}
