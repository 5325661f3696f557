/* maglev_5dof_phase. Generated: do not edit. */
#include "maglev_5dof_phase.h"
#include <float.h>
#include <math.h>
#if defined(MAGLEV_5DOF_PHASE_DIAGNOSTICS)
#include <stddef.h>
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float maglev_5dof_phase_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

#if defined(__GNUC__)
#define MAGLEV_5DOF_PHASE_INLINE static inline __attribute__((always_inline))
#else
#define MAGLEV_5DOF_PHASE_INLINE static inline
#endif
/* Return a value in -high .. high, which `last` becomes; for any other, set its fault bit and return *last. */
MAGLEV_5DOF_PHASE_INLINE float maglev_5dof_phase_hold_within(float value, float high, float *last, uint32_t bit,
    uint32_t *faults)
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

void maglev_5dof_phase_init(maglev_5dof_phase_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (maglev_5dof_phase_state_t){
        .guard_last_i_d1 = 2.5f,
        .guard_last_i_d2 = 2.5f,
        .guard_last_i_d3 = 2.5f,
        .guard_last_i_d4 = 2.5f,
    };
}

#if defined(MAGLEV_5DOF_PHASE_DIAGNOSTICS)
uint32_t maglev_5dof_phase_step(maglev_5dof_phase_state_t *state, const maglev_5dof_phase_input_t *in, maglev_5dof_phase_output_t *out)
{
    return maglev_5dof_phase_step_diagnosed(state, in, out, NULL);
}

uint32_t maglev_5dof_phase_step_diagnosed(maglev_5dof_phase_state_t *state, const maglev_5dof_phase_input_t *in, maglev_5dof_phase_output_t *out,
    maglev_5dof_phase_diagnostics_t *diagnostics)
#else
uint32_t maglev_5dof_phase_step(maglev_5dof_phase_state_t *state, const maglev_5dof_phase_input_t *in, maglev_5dof_phase_output_t *out)
#endif
{
    static const float wave_number = 54.971f;                   /* rad/m; pi / tau, pole pitch tau */
    static const float half_pi = 1.5707964f;                    /* 1; pi / 2 */
    static const float root_2 = 1.4142135f;                     /* 1; sqrt(2) */
    static const float max_phase_current = 9.899505f;           /* A; both currents at their limit */
    static const float two_thirds_pi = 2.0943952f;              /* 1; 2 pi / 3 */

#if defined(MAGLEV_5DOF_PHASE_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
#endif
    /* guard: range acceptance, hold, latch */
    uint32_t faults = 0u;
    const float i_d1_held = maglev_5dof_phase_hold_within(in->i_d1, 4.9497476f, &state->guard_last_i_d1, 0x00000001u, &faults);
    const float i_d2_held = maglev_5dof_phase_hold_within(in->i_d2, 4.9497476f, &state->guard_last_i_d2, 0x00000002u, &faults);
    const float i_d3_held = maglev_5dof_phase_hold_within(in->i_d3, 4.9497476f, &state->guard_last_i_d3, 0x00000004u, &faults);
    const float i_d4_held = maglev_5dof_phase_hold_within(in->i_d4, 4.9497476f, &state->guard_last_i_d4, 0x00000008u, &faults);
    const float i_q1_held = maglev_5dof_phase_hold_within(in->i_q1, 4.9497476f, &state->guard_last_i_q1, 0x00000010u, &faults);
    const float i_q2_held = maglev_5dof_phase_hold_within(in->i_q2, 4.9497476f, &state->guard_last_i_q2, 0x00000020u, &faults);
    const float i_q3_held = maglev_5dof_phase_hold_within(in->i_q3, 4.9497476f, &state->guard_last_i_q3, 0x00000040u, &faults);
    const float i_q4_held = maglev_5dof_phase_hold_within(in->i_q4, 4.9497476f, &state->guard_last_i_q4, 0x00000080u, &faults);
    const float x_held = maglev_5dof_phase_hold_within(in->x, 0.1f, &state->guard_last_x, 0x00000100u, &faults);
    const float z_held = maglev_5dof_phase_hold_within(in->z, 0.1f, &state->guard_last_z, 0x00000200u, &faults);

    /* commutation: phase currents, inverse Park
     *     i_a1 = limit(root_2 * (i_d1_held * cos(wave_number * z_held + half_pi) - i_q1_held * sin(wave_number
     *         * z_held + half_pi)), max_phase_current); likewise i_a2, i_a3, i_a4
     *     i_b1 = limit(root_2 * (i_d1_held * cos(wave_number * z_held + half_pi - two_thirds_pi) - i_q1_held *
     *         sin(wave_number * z_held + half_pi - two_thirds_pi)), max_phase_current); likewise i_b2, i_b3,
     *         i_b4
     *     i_c1 = limit(root_2 * (i_d1_held * cos(wave_number * z_held + half_pi + two_thirds_pi) - i_q1_held *
     *         sin(wave_number * z_held + half_pi + two_thirds_pi)), max_phase_current); likewise i_c2, i_c3,
     *         i_c4 */
    const float i_a1_part = (wave_number * z_held) + half_pi;
    const float cos_i_a1_part = cosf(i_a1_part);
    const float sin_i_a1_part = sinf(i_a1_part);
    const float i_a1 = maglev_5dof_phase_limit(root_2 * ((i_d1_held * cos_i_a1_part) - (i_q1_held * sin_i_a1_part)), max_phase_current);
    out->i_a1 = i_a1;
    const float i_b1_part = i_a1_part - two_thirds_pi;
    const float cos_i_b1_part = cosf(i_b1_part);
    const float sin_i_b1_part = sinf(i_b1_part);
    const float i_b1 = maglev_5dof_phase_limit(root_2 * ((i_d1_held * cos_i_b1_part) - (i_q1_held * sin_i_b1_part)), max_phase_current);
    out->i_b1 = i_b1;
    const float i_a1_part_plus_two_thirds_pi = i_a1_part + two_thirds_pi;
    const float i_c1_part = cosf(i_a1_part_plus_two_thirds_pi);
    const float i_c1_part_2 = sinf(i_a1_part_plus_two_thirds_pi);
    const float i_c1 = maglev_5dof_phase_limit(root_2 * ((i_d1_held * i_c1_part) - (i_q1_held * i_c1_part_2)), max_phase_current);
    out->i_c1 = i_c1;
    const float i_a2_part = (wave_number * x_held) + half_pi;
    const float cos_i_a2_part = cosf(i_a2_part);
    const float sin_i_a2_part = sinf(i_a2_part);
    const float i_a2 = maglev_5dof_phase_limit(root_2 * ((i_d2_held * cos_i_a2_part) - (i_q2_held * sin_i_a2_part)), max_phase_current);
    out->i_a2 = i_a2;
    const float i_b2_part = i_a2_part - two_thirds_pi;
    const float cos_i_b2_part = cosf(i_b2_part);
    const float sin_i_b2_part = sinf(i_b2_part);
    const float i_b2 = maglev_5dof_phase_limit(root_2 * ((i_d2_held * cos_i_b2_part) - (i_q2_held * sin_i_b2_part)), max_phase_current);
    out->i_b2 = i_b2;
    const float i_a2_part_plus_two_thirds_pi = i_a2_part + two_thirds_pi;
    const float i_c2_part = cosf(i_a2_part_plus_two_thirds_pi);
    const float i_c2_part_2 = sinf(i_a2_part_plus_two_thirds_pi);
    const float i_c2 = maglev_5dof_phase_limit(root_2 * ((i_d2_held * i_c2_part) - (i_q2_held * i_c2_part_2)), max_phase_current);
    out->i_c2 = i_c2;
    const float i_a3 = maglev_5dof_phase_limit(root_2 * ((i_d3_held * cos_i_a1_part) - (i_q3_held * sin_i_a1_part)), max_phase_current);
    out->i_a3 = i_a3;
    const float i_b3 = maglev_5dof_phase_limit(root_2 * ((i_d3_held * cos_i_b1_part) - (i_q3_held * sin_i_b1_part)), max_phase_current);
    out->i_b3 = i_b3;
    const float i_c3 = maglev_5dof_phase_limit(root_2 * ((i_d3_held * i_c1_part) - (i_q3_held * i_c1_part_2)), max_phase_current);
    out->i_c3 = i_c3;
    const float i_a4 = maglev_5dof_phase_limit(root_2 * ((i_d4_held * cos_i_a2_part) - (i_q4_held * sin_i_a2_part)), max_phase_current);
    out->i_a4 = i_a4;
    const float i_b4 = maglev_5dof_phase_limit(root_2 * ((i_d4_held * cos_i_b2_part) - (i_q4_held * sin_i_b2_part)), max_phase_current);
    out->i_b4 = i_b4;
    const float i_c4 = maglev_5dof_phase_limit(root_2 * ((i_d4_held * i_c2_part) - (i_q4_held * i_c2_part_2)), max_phase_current);
    out->i_c4 = i_c4;
#if defined(MAGLEV_5DOF_PHASE_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->saturated |= (fabsf(i_a1) >= max_phase_current) ? 0x00000001u : 0u;
        diagnostics->saturated |= (fabsf(i_b1) >= max_phase_current) ? 0x00000002u : 0u;
        diagnostics->saturated |= (fabsf(i_c1) >= max_phase_current) ? 0x00000004u : 0u;
        diagnostics->saturated |= (fabsf(i_a2) >= max_phase_current) ? 0x00000008u : 0u;
        diagnostics->saturated |= (fabsf(i_b2) >= max_phase_current) ? 0x00000010u : 0u;
        diagnostics->saturated |= (fabsf(i_c2) >= max_phase_current) ? 0x00000020u : 0u;
        diagnostics->saturated |= (fabsf(i_a3) >= max_phase_current) ? 0x00000040u : 0u;
        diagnostics->saturated |= (fabsf(i_b3) >= max_phase_current) ? 0x00000080u : 0u;
        diagnostics->saturated |= (fabsf(i_c3) >= max_phase_current) ? 0x00000100u : 0u;
        diagnostics->saturated |= (fabsf(i_a4) >= max_phase_current) ? 0x00000200u : 0u;
        diagnostics->saturated |= (fabsf(i_b4) >= max_phase_current) ? 0x00000400u : 0u;
        diagnostics->saturated |= (fabsf(i_c4) >= max_phase_current) ? 0x00000800u : 0u;
    }
#endif

#if defined(MAGLEV_5DOF_PHASE_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->faults = faults;
    }
#endif
    return faults;
}
