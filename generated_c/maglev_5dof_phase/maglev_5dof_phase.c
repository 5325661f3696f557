/* maglev_5dof_phase. Generated: do not edit. */
#include "maglev_5dof_phase.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float maglev_5dof_phase_min(float a, float b)
{
    return (a < b) ? a : b;
}

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float maglev_5dof_phase_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline float maglev_5dof_phase_slew(float last, float target, float step)
{
    const float highest = last + step;
    const float lowest = last - step;
    const float below = (target < highest) ? target : highest;
    return (below > lowest) ? below : lowest;
}

#if defined(__GNUC__)
#define MAGLEV_5DOF_PHASE_INLINE static inline __attribute__((always_inline))
#else
#define MAGLEV_5DOF_PHASE_INLINE static inline
#endif
#if defined(__OPTIMIZE_SIZE__)
#define MAGLEV_5DOF_PHASE_LARGE static inline
#else
#define MAGLEV_5DOF_PHASE_LARGE MAGLEV_5DOF_PHASE_INLINE
#endif
/* Return a value in -high .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
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

/* quarter_sine / x; x = distance_x, distance_z in -0.0572642982 .. 0.0572642982, t = x^2; relative error at most
 * 1.1e-07. */
static inline float quarter_sine_polynomial(float t)
{
    return -13.74275f + (t * (432.58292f + (t * (-4084.3542f + (t * 18062.156f)))));
}

typedef struct {
    float x_acting;
    float z_acting;
    bool lost_x;
    bool lost_z;
} maglev_5dof_phase_advance_t;

/* advance: positions 1.5 samples later, when the currents act */
MAGLEV_5DOF_PHASE_INLINE maglev_5dof_phase_advance_t maglev_5dof_phase_advance(maglev_5dof_phase_advance_state_t *state,
    const maglev_5dof_phase_input_t *accepted, bool good_x, bool good_z, maglev_5dof_phase_diagnostics_t *diagnostics)
{
    static const float largest_move = 0.001f;                   /* m; 1 m/s times 0.001 s; of x, z */
    static const float samples_ahead = 1.5f;                    /* 1; from the measurement until the current acts */
    static const uint32_t patience = 5u;                        /* 1; bad samples until a position is lost */

    const uint32_t left_x = state->left_x;
    float last_x = accepted->x_commutation;
    uint32_t left_x_if_not_good_x = 0u;
    if (1u <= left_x) {
        last_x = state->last_x;
        left_x_if_not_good_x = left_x - 1u;
    }
    const float position_x = maglev_5dof_phase_slew(last_x, accepted->x_commutation, largest_move);
    state->last_x = position_x;
    const uint32_t left_z = state->left_z;
    float last_z = accepted->z_commutation;
    uint32_t left_z_if_not_good_z = 0u;
    if (1u <= left_z) {
        last_z = state->last_z;
        left_z_if_not_good_z = left_z - 1u;
    }
    const float position_z = maglev_5dof_phase_slew(last_z, accepted->z_commutation, largest_move);
    state->last_z = position_z;
    state->left_x = (good_x) ? patience : left_x_if_not_good_x;
    state->left_z = (good_z) ? patience : left_z_if_not_good_z;
    const float x_acting = position_x + (samples_ahead * (position_x - last_x));
    const float z_acting = position_z + (samples_ahead * (position_z - last_z));
    if (diagnostics != NULL) {
        diagnostics->x_acting = x_acting;
        diagnostics->lost_x = ((good_x) ? false : (left_x <= 1u)) ? 1.0f : 0.0f;
        diagnostics->z_acting = z_acting;
        diagnostics->lost_z = ((good_z) ? false : (left_z <= 1u)) ? 1.0f : 0.0f;
    }
    return (maglev_5dof_phase_advance_t){.x_acting = x_acting, .z_acting = z_acting, .lost_x = (good_x) ? false :
        (left_x <= 1u), .lost_z = (good_z) ? false : (left_z <= 1u)};
}

typedef struct {
    float i_a1;
    float i_b1;
    float i_c1;
    float i_a2;
    float i_b2;
    float i_c2;
    float i_a3;
    float i_b3;
    float i_c3;
    float i_a4;
    float i_b4;
    float i_c4;
} maglev_5dof_phase_commutation_t;

/* commutation: phase currents, inverse Park */
MAGLEV_5DOF_PHASE_LARGE maglev_5dof_phase_commutation_t
    maglev_5dof_phase_commutation(maglev_5dof_phase_commutation_state_t *state,
    const maglev_5dof_phase_advance_t *advance, const maglev_5dof_phase_input_t *accepted)
{
    static const float fade_step = 0.04f; /* 1; 1 / 25: a handover, and a fade, takes 25 samples */
    /* A; largest |i_d| + |i_q| while a motor hands or takes over: keeps hypot too */
    static const float current_limit = 4.9497476f;
    static const uint32_t gone_samples = 105u;                  /* 1; samples until the currents have faded out */
    /* m; the wavelength, 0.1143 m, in 12 bits: its multiples are exact */
    static const float wavelength_high = 0.11428833f;
    static const float inverse_wavelength = 8.748906f;          /* 1/m; 1 over the wavelength, 0.1143 m */
    static const float wavelength_low = 1.1669922e-05f;         /* m; the wavelength, 0.1143 m, less wavelength_high */
    static const float four_root_2 = 5.656854f;                 /* 1; 4 sqrt(2) */
    static const float eight_root_2 = 11.313708f;               /* 1; 8 sqrt(2) */
    static const float root_2 = 1.4142135f;                     /* 1; sqrt(2) */
    static const float half_root_3 = 0.8660254f;                /* 1; sqrt(3) / 2 */

    const float distance_x_sum = (inverse_wavelength * advance->x_acting) + 4.5f;
    const float n_x = (float)(uint32_t)distance_x_sum - 4.0f;
    const float distance_x = advance->x_acting - (wavelength_high * n_x) - (wavelength_low * n_x);
    /*@ admit -0.0572643f <= distance_x <= 0.0572643f; */
    const float quarter_sine_x = distance_x * quarter_sine_polynomial(distance_x * distance_x);
    const float distance_z_sum = (inverse_wavelength * advance->z_acting) + 4.5f;
    const float n_z = (float)(uint32_t)distance_z_sum - 4.0f;
    const float distance_z = advance->z_acting - (wavelength_high * n_z) - (wavelength_low * n_z);
    /*@ admit -0.0572643f <= distance_z <= 0.0572643f; */
    const float quarter_sine_z = distance_z * quarter_sine_polynomial(distance_z * distance_z);
    const float transfer = state->transfer;
    const uint32_t unknown = state->unknown;
    const bool unknown_at_least_1 = 1u <= unknown;
    const float quarter_sine_z_squared = quarter_sine_z * quarter_sine_z;
    const float h_z = quarter_sine_z * sqrtf(1.0f - quarter_sine_z_squared);
    const float wave_z_cosine = h_z * (four_root_2 - (eight_root_2 * quarter_sine_z_squared));
    const float wave_z_sine = root_2 - (eight_root_2 * (h_z * h_z));
    const float quarter_sine_x_squared = quarter_sine_x * quarter_sine_x;
    const float h_x = quarter_sine_x * sqrtf(1.0f - quarter_sine_x_squared);
    const float wave_x_cosine = h_x * (four_root_2 - (eight_root_2 * quarter_sine_x_squared));
    const float wave_x_sine = root_2 - (eight_root_2 * (h_x * h_x));
    float direct_1 = accepted->i_d1;
    float kept_z_cosine = wave_z_cosine;
    float kept_z_sine = wave_z_sine;
    float direct_2 = accepted->i_d2;
    float kept_x_cosine = wave_x_cosine;
    float kept_x_sine = wave_x_sine;
    float direct_3 = accepted->i_d3;
    float direct_4 = accepted->i_d4;
    if (advance->lost_x || advance->lost_z || (0.0f < fabsf(transfer)) || unknown_at_least_1) {
        float target = transfer;
        if (advance->lost_x && advance->lost_z) {
            if (unknown < gone_samples) {
                state->unknown = unknown + 1u;
            }
        } else {
            target = (advance->lost_x) ? 1.0f : ((advance->lost_z) ? -1.0f : 0.0f);
            if (unknown_at_least_1) {
                state->unknown = unknown - 1u;
            } else {
                state->unknown = 0u;
            }
        }
        const float transfer_2 = maglev_5dof_phase_slew(transfer, target, fade_step);
        const bool of_x = 0.0f < transfer_2;
        const float part = fabsf(transfer_2);
        const float part_x = (of_x) ? part : 0.0f;
        const float handed_z = 0.5f * (part_x * (accepted->i_d2 + accepted->i_d4));
        direct_1 = maglev_5dof_phase_limit(accepted->i_d1 + handed_z, current_limit - fabsf(accepted->i_q1));
        const float whole = maglev_5dof_phase_min(fade_step * (105.0f - (float)unknown), 1.0f);
        const float part_z = (of_x) ? 0.0f : part;
        const float share_z = whole * (1.0f - part_z);
        kept_z_cosine = share_z * wave_z_cosine;
        kept_z_sine = share_z * wave_z_sine;
        const float handed_x = 0.5f * (part_z * (accepted->i_d1 + accepted->i_d3));
        direct_2 = maglev_5dof_phase_limit(accepted->i_d2 + handed_x, current_limit - fabsf(accepted->i_q2));
        const float share_x = whole * (1.0f - part_x);
        kept_x_cosine = share_x * wave_x_cosine;
        kept_x_sine = share_x * wave_x_sine;
        direct_3 = maglev_5dof_phase_limit(accepted->i_d3 + handed_z, current_limit - fabsf(accepted->i_q3));
        direct_4 = maglev_5dof_phase_limit(accepted->i_d4 + handed_x, current_limit - fabsf(accepted->i_q4));
        state->transfer = transfer_2;
    } else {
        state->transfer = 0.0f;
        state->unknown = 0u;
    }
    const float current_1_cosine = (direct_1 * kept_z_cosine) - (accepted->i_q1 * kept_z_sine);
    const float i_a1 = current_1_cosine;
    /*@ admit -9.900485f <= i_a1 <= 9.900485f; */
    const float other_1 = half_root_3 * ((accepted->i_q1 * kept_z_cosine) + (direct_1 * kept_z_sine));
    const float half_1 = 0.5f * current_1_cosine;
    const float i_b1 = other_1 - half_1;
    /*@ admit -9.900485f <= i_b1 <= 9.900485f; */
    const float i_c1 = -(half_1 + other_1);
    /*@ admit -9.900485f <= i_c1 <= 9.900485f; */
    const float current_2_cosine = (direct_2 * kept_x_cosine) - (accepted->i_q2 * kept_x_sine);
    const float i_a2 = current_2_cosine;
    /*@ admit -9.900485f <= i_a2 <= 9.900485f; */
    const float other_2 = half_root_3 * ((accepted->i_q2 * kept_x_cosine) + (direct_2 * kept_x_sine));
    const float half_2 = 0.5f * current_2_cosine;
    const float i_b2 = other_2 - half_2;
    /*@ admit -9.900485f <= i_b2 <= 9.900485f; */
    const float i_c2 = -(half_2 + other_2);
    /*@ admit -9.900485f <= i_c2 <= 9.900485f; */
    const float current_3_cosine = (direct_3 * kept_z_cosine) - (accepted->i_q3 * kept_z_sine);
    const float i_a3 = current_3_cosine;
    /*@ admit -9.900485f <= i_a3 <= 9.900485f; */
    const float other_3 = half_root_3 * ((accepted->i_q3 * kept_z_cosine) + (direct_3 * kept_z_sine));
    const float half_3 = 0.5f * current_3_cosine;
    const float i_b3 = other_3 - half_3;
    /*@ admit -9.900485f <= i_b3 <= 9.900485f; */
    const float i_c3 = -(half_3 + other_3);
    /*@ admit -9.900485f <= i_c3 <= 9.900485f; */
    const float current_4_cosine = (direct_4 * kept_x_cosine) - (accepted->i_q4 * kept_x_sine);
    const float i_a4 = current_4_cosine;
    /*@ admit -9.900485f <= i_a4 <= 9.900485f; */
    const float other_4 = half_root_3 * ((accepted->i_q4 * kept_x_cosine) + (direct_4 * kept_x_sine));
    const float half_4 = 0.5f * current_4_cosine;
    const float i_b4 = other_4 - half_4;
    /*@ admit -9.900485f <= i_b4 <= 9.900485f; */
    const float i_c4 = -(half_4 + other_4);
    /*@ admit -9.900485f <= i_c4 <= 9.900485f; */
    return (maglev_5dof_phase_commutation_t){.i_a1 = i_a1, .i_b1 = i_b1, .i_c1 = i_c1, .i_a2 = i_a2, .i_b2 = i_b2,
        .i_c2 = i_c2, .i_a3 = i_a3, .i_b3 = i_b3, .i_c3 = i_c3, .i_a4 = i_a4, .i_b4 = i_b4, .i_c4 = i_c4};
}

/* Each input in its range, else what is held or refused, with its bit of the fault word. */
MAGLEV_5DOF_PHASE_INLINE maglev_5dof_phase_input_t maglev_5dof_phase_guard_inputs(maglev_5dof_phase_state_t *state,
    const maglev_5dof_phase_input_t *in, uint32_t *faults)
{
    maglev_5dof_phase_input_t accepted;
    accepted.i_d1 = maglev_5dof_phase_hold_within(in->i_d1, 4.9497476f, &state->guard_last_i_d1, 0x00000001u, faults);
    accepted.i_d2 = maglev_5dof_phase_hold_within(in->i_d2, 4.9497476f, &state->guard_last_i_d2, 0x00000002u, faults);
    accepted.i_d3 = maglev_5dof_phase_hold_within(in->i_d3, 4.9497476f, &state->guard_last_i_d3, 0x00000004u, faults);
    accepted.i_d4 = maglev_5dof_phase_hold_within(in->i_d4, 4.9497476f, &state->guard_last_i_d4, 0x00000008u, faults);
    accepted.i_q1 = maglev_5dof_phase_hold_within(in->i_q1, 4.9497476f, &state->guard_last_i_q1, 0x00000010u, faults);
    accepted.i_q2 = maglev_5dof_phase_hold_within(in->i_q2, 4.9497476f, &state->guard_last_i_q2, 0x00000020u, faults);
    accepted.i_q3 = maglev_5dof_phase_hold_within(in->i_q3, 4.9497476f, &state->guard_last_i_q3, 0x00000040u, faults);
    accepted.i_q4 = maglev_5dof_phase_hold_within(in->i_q4, 4.9497476f, &state->guard_last_i_q4, 0x00000080u, faults);
    accepted.x_commutation = maglev_5dof_phase_hold_within(in->x_commutation, 0.1f, &state->guard_last_x, 0x00000100u,
        faults);
    accepted.z_commutation = maglev_5dof_phase_hold_within(in->z_commutation, 0.1f, &state->guard_last_z, 0x00000200u,
        faults);
    return accepted;
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

MAGLEV_5DOF_PHASE_INLINE uint32_t maglev_5dof_phase_body(maglev_5dof_phase_state_t *state,
    const maglev_5dof_phase_input_t *in, maglev_5dof_phase_output_t *out, maglev_5dof_phase_diagnostics_t *diagnostics)
{
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
    }
    /* guard: range acceptance, hold, latch */
    uint32_t faults = 0u;
    const maglev_5dof_phase_input_t accepted = maglev_5dof_phase_guard_inputs(state, in, &faults);
    const maglev_5dof_phase_advance_t advance = maglev_5dof_phase_advance(&state->advance, &accepted,
        (faults & 0x00000100u) == 0u, (faults & 0x00000200u) == 0u, diagnostics);
    const maglev_5dof_phase_commutation_t commutation = maglev_5dof_phase_commutation(&state->commutation, &advance,
        &accepted);
    if (advance.lost_x) {
        faults |= 0x00000400u;
    }
    if (advance.lost_z) {
        faults |= 0x00000800u;
    }
    out->i_a1 = commutation.i_a1;
    out->i_b1 = commutation.i_b1;
    out->i_c1 = commutation.i_c1;
    out->i_a2 = commutation.i_a2;
    out->i_b2 = commutation.i_b2;
    out->i_c2 = commutation.i_c2;
    out->i_a3 = commutation.i_a3;
    out->i_b3 = commutation.i_b3;
    out->i_c3 = commutation.i_c3;
    out->i_a4 = commutation.i_a4;
    out->i_b4 = commutation.i_b4;
    out->i_c4 = commutation.i_c4;

    if (diagnostics != NULL) {
        diagnostics->faults = faults;
    }
    return faults;
}

uint32_t maglev_5dof_phase_step(maglev_5dof_phase_state_t *state, const maglev_5dof_phase_input_t *in,
    maglev_5dof_phase_output_t *out)
{
    return maglev_5dof_phase_body(state, in, out, NULL);
}

#if defined(MAGLEV_5DOF_PHASE_DIAGNOSTICS)
uint32_t maglev_5dof_phase_step_diagnosed(maglev_5dof_phase_state_t *state, const maglev_5dof_phase_input_t *in,
    maglev_5dof_phase_output_t *out, maglev_5dof_phase_diagnostics_t *diagnostics)
{
    return maglev_5dof_phase_body(state, in, out, diagnostics);
}
#endif
