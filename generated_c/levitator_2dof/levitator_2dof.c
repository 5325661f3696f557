/* levitator_2dof. Generated: do not edit. */
#include "levitator_2dof.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float levitator_2dof_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline float levitator_2dof_slew(float last, float target, float step)
{
    const float highest = last + step;
    const float lowest = last - step;
    const float below = (target < highest) ? target : highest;
    return (below > lowest) ? below : lowest;
}

#if defined(__GNUC__)
#define LEVITATOR_2DOF_INLINE static inline __attribute__((always_inline))
#else
#define LEVITATOR_2DOF_INLINE static inline
#endif
/* Return a value in -high .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
LEVITATOR_2DOF_INLINE float levitator_2dof_hold_within(float value, float high, float *last, uint32_t bit,
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

/* exp(200 * x); x = clamp(z_predicted, -0.0006, 0.0006) in -0.000600000028 .. 0.000600000028, t = x; relative error at
 * most 7.6e-08. */
static inline float exp_polynomial(float t)
{
    return 1.0f + (t * (199.9999f + (t * (20000.012f + (t * (1.3345296e+06f + (t * 6.6655596e+07f)))))));
}

/* guard: range acceptance, hold, latch */
LEVITATOR_2DOF_INLINE uint32_t levitator_2dof_guard(levitator_2dof_guard_state_t *state, bool complete,
    uint32_t latched_before)
{
    static const uint32_t latch_samples = 4u;                   /* 1; bad samples in a row until it latches */

    uint32_t latched = latched_before;
    if (complete) {
        state->left = latch_samples;
        state->ready = 1u;
    } else {
        const uint32_t left = state->left;
        if (left <= 1u) {
            latched = 1u;
        } else {
            state->left = left - 1u;
        }
    }
    return latched;
}

typedef struct {
    float current_sum;
    float w_z_command;
    float z_predicted;
} levitator_2dof_servo_z_output_t;

/* servo_z: servo of z */
LEVITATOR_2DOF_INLINE levitator_2dof_servo_z_output_t
    levitator_2dof_servo_z_output(levitator_2dof_servo_z_state_t *state, const levitator_2dof_input_t *accepted,
    float w_z_late1_predicted, levitator_2dof_diagnostics_t *diagnostics)
{
    static const float z_predicted_from_z_predicted = -0.021450125f; /* m/m */
    static const float z_predicted_from_vz_predicted = 0.0005f; /* m/m s */
    static const float z_predicted_from_w_z_late1_predicted = 1.25e-07f; /* m/m s^2 */
    static const float z_predicted_from_z_held = 1.0214502f;    /* m/m */
    static const float next_z_predicted_from_z_predicted = -0.021450125f; /* m/m */
    static const float next_z_predicted_from_vz_predicted = 0.0005f; /* m/m s */
    static const float next_z_predicted_from_w_z_late1_predicted = 1.25e-07f; /* m/m s^2 */
    static const float next_z_predicted_from_z_held = 1.0214502f; /* m/m */
    static const float next_vz_predicted_from_z_predicted = -704.3172f; /* m/s/m */
    static const float next_vz_predicted_from_w_z_late1_predicted = 0.0005f; /* m/s/m s^2 */
    static const float next_vz_predicted_from_z_held = 704.3172f; /* m/s/m */

    const float z_predicted_2 = state->z_predicted;
    const uint32_t started = state->started;
    const float sum = state->sum;
    float current_sum = sum;
    float current_z_predicted = z_predicted_2;
    if (started == 0u) {
        current_sum = levitator_2dof_limit(sum + (state->start_sum_from_z_held * accepted->z), 0.34f);
        current_z_predicted = levitator_2dof_limit(z_predicted_2 + accepted->z, 0.0014f);
    }
    const float vz_predicted = state->vz_predicted;
    const float next_values_z_predicted = (next_z_predicted_from_z_predicted * current_z_predicted) +
        (next_z_predicted_from_vz_predicted * vz_predicted) + (next_z_predicted_from_w_z_late1_predicted *
        w_z_late1_predicted) + (next_z_predicted_from_z_held * accepted->z);
    state->z_predicted = levitator_2dof_limit(next_values_z_predicted, 0.0014f);
    const float next_values_vz_predicted = (next_vz_predicted_from_z_predicted * current_z_predicted) + vz_predicted +
        (next_vz_predicted_from_w_z_late1_predicted * w_z_late1_predicted) +
        (next_vz_predicted_from_z_held * accepted->z);
    state->vz_predicted = levitator_2dof_limit(next_values_vz_predicted, 1.3f);
    state->started = 1u;
    const float w_z_command = (state->w_z_command_from_sum * current_sum) + (state->w_z_command_from_p1 * state->p1) +
        (state->w_z_command_from_q1 * state->q1) + (state->w_z_command_from_z_predicted * current_z_predicted) +
        (state->w_z_command_from_vz_predicted * vz_predicted) +
        (state->w_z_command_from_w_z_late1_predicted * w_z_late1_predicted) +
        (state->w_z_command_from_z_held * accepted->z) + (state->w_z_command_from_z_ref_held * accepted->z_ref);
    const float z_predicted = (z_predicted_from_z_predicted * current_z_predicted) +
        (z_predicted_from_vz_predicted * vz_predicted) + (z_predicted_from_w_z_late1_predicted * w_z_late1_predicted) +
        (z_predicted_from_z_held * accepted->z);
    if (diagnostics != NULL) {
        diagnostics->w_z_command = w_z_command;
        diagnostics->z_predicted = z_predicted;
    }
    return (levitator_2dof_servo_z_output_t){.current_sum = current_sum, .w_z_command = w_z_command,
        .z_predicted = z_predicted};
}

typedef struct {
    float drift;
    float i1_demand;
} levitator_2dof_inverse_z_t;

/* inverse_z: feedback linearisation of z */
LEVITATOR_2DOF_INLINE levitator_2dof_inverse_z_t levitator_2dof_inverse_z(float w_z_command, float exp_polynomial,
    levitator_2dof_diagnostics_t *diagnostics)
{
    const float drift = (9.333333f * exp_polynomial) - 9.81f;
    const float i1_demand = 0.075f * (w_z_command - drift) / exp_polynomial;
    if (diagnostics != NULL) {
        diagnostics->i1_demand = i1_demand;
    }
    return (levitator_2dof_inverse_z_t){.drift = drift, .i1_demand = i1_demand};
}

typedef struct {
    float current_sum;
    float i2_demand;
} levitator_2dof_servo_x_output_t;

/* servo_x: servo of x */
LEVITATOR_2DOF_INLINE levitator_2dof_servo_x_output_t levitator_2dof_servo_x_output(levitator_2dof_servo_x_state_t
    *state, const levitator_2dof_input_t *accepted, levitator_2dof_diagnostics_t *diagnostics)
{
    static const float start_sum_from_x_held = -60.02324f;      /* m/m */
    static const float i2_demand_from_sum = -34.916763f;        /* A/m */
    static const float i2_demand_from_p1 = -130.0009f;          /* A/m */
    static const float i2_demand_from_q1 = -55.77232f;          /* A/m */
    static const float i2_demand_from_p2 = 350.80725f;          /* A/m */
    static const float i2_demand_from_q2 = 13.477797f;          /* A/m */
    static const float i2_demand_from_x_predicted = 19688.031f; /* A/m */
    static const float i2_demand_from_vx_predicted = -19.514633f; /* A/m s */
    static const float i2_demand_from_i2_late1_predicted = -0.246704f; /* A/A */
    static const float i2_demand_from_x_held = -23879.664f;     /* A/m */
    static const float i2_demand_from_x_ref_held = 2095.8171f;  /* A/m */
    static const float next_x_predicted_from_x_predicted = -0.30337617f; /* m/m */
    static const float next_x_predicted_from_vx_predicted = 0.0004995558f; /* m/m s */
    static const float next_x_predicted_from_i2_late1_predicted = 3.3313897e-06f; /* m/A */
    static const float next_x_predicted_from_x_held = 1.3032097f; /* m/m */
    static const float next_vx_predicted_from_x_predicted = -1055.379f; /* m/s/m */
    static const float next_vx_predicted_from_vx_predicted = 0.99816823f; /* m/s/m s */
    static const float next_vx_predicted_from_i2_late1_predicted = 0.013321488f; /* m/s/A */
    static const float next_vx_predicted_from_x_held = 1054.713f; /* m/s/m */

    const float x_predicted = state->x_predicted;
    const uint32_t started = state->started;
    const float sum = state->sum;
    float current_sum = sum;
    float current_x_predicted = x_predicted;
    if (started == 0u) {
        current_sum = levitator_2dof_limit(sum + (start_sum_from_x_held * accepted->x), 0.51f);
        current_x_predicted = levitator_2dof_limit(x_predicted + accepted->x, 0.0024f);
    }
    const float vx_predicted = state->vx_predicted;
    const float i2_late1_predicted = state->i2_late1_predicted;
    const float next_values_x_predicted = (next_x_predicted_from_x_predicted * current_x_predicted) +
        (next_x_predicted_from_vx_predicted * vx_predicted) +
        (next_x_predicted_from_i2_late1_predicted * i2_late1_predicted) + (next_x_predicted_from_x_held * accepted->x);
    state->x_predicted = levitator_2dof_limit(next_values_x_predicted, 0.0024f);
    const float next_values_vx_predicted = (next_vx_predicted_from_x_predicted * current_x_predicted) +
        (next_vx_predicted_from_vx_predicted * vx_predicted) + (next_vx_predicted_from_i2_late1_predicted *
        i2_late1_predicted) + (next_vx_predicted_from_x_held * accepted->x);
    state->vx_predicted = levitator_2dof_limit(next_values_vx_predicted, 2.8f);
    state->started = 1u;
    const float i2_demand = (i2_demand_from_sum * current_sum) + (i2_demand_from_p1 * state->p1) + (i2_demand_from_q1 *
        state->q1) + (i2_demand_from_p2 * state->p2) + (i2_demand_from_q2 * state->q2) + (i2_demand_from_x_predicted *
        current_x_predicted) + (i2_demand_from_vx_predicted * vx_predicted) + (i2_demand_from_i2_late1_predicted *
        i2_late1_predicted) + (i2_demand_from_x_held * accepted->x) + (i2_demand_from_x_ref_held * accepted->x_ref);
    if (diagnostics != NULL) {
        diagnostics->i2_demand = i2_demand;
    }
    return (levitator_2dof_servo_x_output_t){.current_sum = current_sum, .i2_demand = i2_demand};
}

typedef struct {
    float i1_computed;
    float i1_excess;
    float i2_computed;
    float i2_excess;
} levitator_2dof_limits_t;

/* limits: actuator limits */
LEVITATOR_2DOF_INLINE levitator_2dof_limits_t levitator_2dof_limits(float i1_demand, float i2_demand,
    levitator_2dof_diagnostics_t *diagnostics)
{
    const float i1_computed = levitator_2dof_limit(i1_demand, 3.0f);
    const float i2_computed = levitator_2dof_limit(i2_demand, 2.0f);
    if (diagnostics != NULL) {
        diagnostics->i1_excess = i1_computed - i1_demand;
        diagnostics->i2_excess = i2_computed - i2_demand;
        diagnostics->saturated |= (fabsf(i1_computed) >= 3.0f) ? 0x00000001u : 0u;
        diagnostics->saturated |= (fabsf(i2_computed) >= 2.0f) ? 0x00000002u : 0u;
    }
    return (levitator_2dof_limits_t){.i1_computed = i1_computed, .i1_excess = i1_computed - i1_demand,
        .i2_computed = i2_computed, .i2_excess = i2_computed - i2_demand};
}

/* servo_z: servo of z */
LEVITATOR_2DOF_INLINE void levitator_2dof_servo_z_update(levitator_2dof_servo_z_state_t *state, float current_sum,
    float z_error, float exp_polynomial, float i1_excess)
{
    static const float next_p1_from_q1 = 0.0009868792f;         /* m/m */
    static const float next_q1_from_q1 = 0.9990131f;            /* m/m */

    const float sum_product = exp_polynomial * i1_excess;
    state->sum = levitator_2dof_limit(current_sum - z_error +
        (13.333333f * (state->next_sum_from_w_z_excess * sum_product)), 0.34f);
    const float p1 = state->p1;
    const float q1 = state->q1;
    state->p1 = levitator_2dof_limit(p1 + (next_p1_from_q1 * q1) +
        (13.333333f * (state->next_p1_from_w_z_excess * sum_product)), 0.0096f);
    state->q1 = levitator_2dof_limit((next_q1_from_q1 * q1) - p1 - z_error +
        (13.333333f * (state->next_q1_from_w_z_excess * sum_product)), 0.26f);
}

/* servo_x: servo of x */
LEVITATOR_2DOF_INLINE void levitator_2dof_servo_x_update(levitator_2dof_servo_x_state_t *state, float current_sum,
    float x_error, const levitator_2dof_limits_t *limits)
{
    static const float next_sum_from_i2_excess = -0.00051277f;  /* m/A */
    static const float next_p1_from_q1 = 0.0009868792f;         /* m/m */
    static const float next_p1_from_i2_excess = 9.798624e-06f;  /* m/A */
    static const float next_q1_from_q1 = 0.9990131f;            /* m/m */
    static const float next_q1_from_i2_excess = -0.00051205757f; /* m/A */
    static const float next_p2_from_q2 = 0.02462332f;           /* m/m */
    static const float next_p2_from_i2_excess = 7.537349e-05f;  /* m/A */
    static const float next_q2_from_q2 = 0.97537667f;           /* m/m */
    static const float next_q2_from_i2_excess = 0.00018017541f; /* m/A */

    state->sum = levitator_2dof_limit(current_sum - x_error + (next_sum_from_i2_excess * limits->i2_excess), 0.51f);
    const float p1 = state->p1;
    const float q1 = state->q1;
    state->p1 = levitator_2dof_limit(p1 + (next_p1_from_q1 * q1) + (next_p1_from_i2_excess * limits->i2_excess),
        0.014f);
    state->q1 = levitator_2dof_limit((next_q1_from_q1 * q1) - p1 - x_error +
        (next_q1_from_i2_excess * limits->i2_excess), 0.41f);
    const float p2 = state->p2;
    const float q2 = state->q2;
    state->p2 = levitator_2dof_limit(p2 + (next_p2_from_q2 * q2) + (next_p2_from_i2_excess * limits->i2_excess),
        0.073f);
    state->q2 = levitator_2dof_limit((next_q2_from_q2 * q2) - p2 - x_error +
        (next_q2_from_i2_excess * limits->i2_excess), 0.48f);
    state->i2_late1_predicted = limits->i2_computed;
}

/* Each input in its range, else what is held or refused, with its bit of the fault word. */
LEVITATOR_2DOF_INLINE levitator_2dof_input_t levitator_2dof_guard_inputs(levitator_2dof_state_t *state,
    const levitator_2dof_input_t *in, uint32_t *faults)
{
    levitator_2dof_input_t accepted;
    accepted.z = levitator_2dof_hold_within(in->z, 0.0007f, &state->guard.last_z, 0x00000001u, faults);
    accepted.x = levitator_2dof_hold_within(in->x, 0.0011f, &state->guard.last_x, 0x00000002u, faults);
    accepted.z_ref = levitator_2dof_hold_within(in->z_ref, 0.0005f, &state->guard.last_z_ref, 0x00000004u, faults);
    accepted.x_ref = levitator_2dof_hold_within(in->x_ref, 0.0008f, &state->guard.last_x_ref, 0x00000008u, faults);
    return accepted;
}

/* the law: what the step computes unless it is latched */
LEVITATOR_2DOF_INLINE void levitator_2dof_law(levitator_2dof_state_t *state, const levitator_2dof_input_t *accepted,
    levitator_2dof_output_t *out, levitator_2dof_diagnostics_t *diagnostics)
{
    /* errors: tracking errors */
    const float z_error = accepted->z_ref - accepted->z;
    const float x_error = accepted->x_ref - accepted->x;
    const levitator_2dof_servo_z_output_t servo_z_output = levitator_2dof_servo_z_output(&state->servo_z, accepted,
        state->servo_z.w_z_late1_predicted, diagnostics);
    const float exp_2 = exp_polynomial(levitator_2dof_limit(servo_z_output.z_predicted, 0.0006f));
    const levitator_2dof_inverse_z_t inverse_z = levitator_2dof_inverse_z(servo_z_output.w_z_command, exp_2,
        diagnostics);
    const levitator_2dof_servo_x_output_t servo_x_output = levitator_2dof_servo_x_output(&state->servo_x, accepted,
        diagnostics);
    const levitator_2dof_limits_t limits = levitator_2dof_limits(inverse_z.i1_demand, servo_x_output.i2_demand,
        diagnostics);

    /* achieved_z: feedback linearisation of z */
    const float w_z_limited = inverse_z.drift + (13.333333f * (exp_2 * limits.i1_computed));
    state->safe_output_last_i1 = limits.i1_computed;
    out->i1 = limits.i1_computed;
    state->servo_z.w_z_late1_predicted = w_z_limited;
    levitator_2dof_servo_z_update(&state->servo_z, servo_z_output.current_sum, z_error, exp_2, limits.i1_excess);
    out->i2 = limits.i2_computed;
    state->safe_output_last_i2 = limits.i2_computed;
    levitator_2dof_servo_x_update(&state->servo_x, servo_x_output.current_sum, x_error, &limits);
    if (diagnostics != NULL) {
        diagnostics->z_error = z_error;
        diagnostics->x_error = x_error;
        diagnostics->w_z_limited = w_z_limited;
    }
}

void levitator_2dof_init(levitator_2dof_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (levitator_2dof_state_t){
        .guard = {.left = 4u},
        .servo_z = {.next_sum_from_w_z_excess = -1.6728576e-05f, .next_p1_from_w_z_excess = 3.4155806e-07f,
            .next_q1_from_w_z_excess = -1.6240092e-05f, .w_z_command_from_sum = -1076.6178f,
            .w_z_command_from_p1 = -3790.4277f, .w_z_command_from_q1 = -1720.0553f,
            .w_z_command_from_z_predicted = 389838.22f, .w_z_command_from_vz_predicted = -610.0382f,
            .w_z_command_from_w_z_late1_predicted = -0.29031637f, .w_z_command_from_z_held = -510253.0f,
            .w_z_command_from_z_ref_held = 72248.88f, .start_sum_from_z_held = -44.73818f},
    };
}

const levitator_2dof_parameters_t levitator_2dof_parameters_default = {
    .servo_z_next_sum_from_w_z_excess = -1.6728576e-05f,
    .servo_z_next_p1_from_w_z_excess = 3.4155806e-07f,
    .servo_z_next_q1_from_w_z_excess = -1.6240092e-05f,
    .servo_z_w_z_command_from_sum = -1076.6178f,
    .servo_z_w_z_command_from_p1 = -3790.4277f,
    .servo_z_w_z_command_from_q1 = -1720.0553f,
    .servo_z_w_z_command_from_z_predicted = 389838.22f,
    .servo_z_w_z_command_from_vz_predicted = -610.0382f,
    .servo_z_w_z_command_from_w_z_late1_predicted = -0.29031637f,
    .servo_z_w_z_command_from_z_held = -510253.0f,
    .servo_z_w_z_command_from_z_ref_held = 72248.88f,
    .servo_z_start_sum_from_z_held = -44.73818f,
    .check = 0x1abeccc4u,
};

static inline uint32_t levitator_2dof_mixed(uint32_t check, float value)
{
    static const uint32_t spread = 0x9e3779b1u;
    static const uint32_t half = 32u;

    uint32_t bits[1] = {0u};
    (void)memcpy((uint8_t *)bits, (const uint8_t *)&value, sizeof bits);
    uint64_t mixed = check;
    mixed = (mixed ^ bits[0]) * spread;
    mixed = (mixed >> half) ^ (mixed & 0xffffffffu);
    return (uint32_t)mixed;
}

static inline uint32_t levitator_2dof_checked(const levitator_2dof_parameters_t *parameters)
{
    uint32_t check = 0x2d0ece07u;
    check = levitator_2dof_mixed(check, parameters->servo_z_next_sum_from_w_z_excess);
    check = levitator_2dof_mixed(check, parameters->servo_z_next_p1_from_w_z_excess);
    check = levitator_2dof_mixed(check, parameters->servo_z_next_q1_from_w_z_excess);
    check = levitator_2dof_mixed(check, parameters->servo_z_w_z_command_from_sum);
    check = levitator_2dof_mixed(check, parameters->servo_z_w_z_command_from_p1);
    check = levitator_2dof_mixed(check, parameters->servo_z_w_z_command_from_q1);
    check = levitator_2dof_mixed(check, parameters->servo_z_w_z_command_from_z_predicted);
    check = levitator_2dof_mixed(check, parameters->servo_z_w_z_command_from_vz_predicted);
    check = levitator_2dof_mixed(check, parameters->servo_z_w_z_command_from_w_z_late1_predicted);
    check = levitator_2dof_mixed(check, parameters->servo_z_w_z_command_from_z_held);
    check = levitator_2dof_mixed(check, parameters->servo_z_w_z_command_from_z_ref_held);
    check = levitator_2dof_mixed(check, parameters->servo_z_start_sum_from_z_held);
    return check;
}

uint32_t levitator_2dof_parameters_check(const levitator_2dof_parameters_t *parameters)
{
    return levitator_2dof_checked(parameters);
}

static inline bool levitator_2dof_holds(float value, float low, float high)
{
    return (value >= low) && (value <= high);
}

/* The value moved by a part of the way to a target; rounding does not leave the range. */
static inline float levitator_2dof_moved(float value, float target, float part, float low, float high)
{
    const float moved = (target * part) + (value * (1.0f - part));
    const float below = (moved < high) ? moved : high;
    return (below > low) ? below : low;
}

uint32_t levitator_2dof_tune(levitator_2dof_state_t *state, const levitator_2dof_parameters_t *parameters,
    uint32_t left)
{
    static const levitator_2dof_parameters_t low = {
        .servo_z_next_sum_from_w_z_excess = -1.6943117e-05f,
        .servo_z_next_p1_from_w_z_excess = 3.2759425e-07f,
        .servo_z_next_q1_from_w_z_excess = -1.630662e-05f,
        .servo_z_w_z_command_from_sum = -1086.9495f,
        .servo_z_w_z_command_from_p1 = -4997.1733f,
        .servo_z_w_z_command_from_q1 = -1734.2896f,
        .servo_z_w_z_command_from_z_predicted = 367649.53f,
        .servo_z_w_z_command_from_vz_predicted = -651.93317f,
        .servo_z_w_z_command_from_w_z_late1_predicted = -0.31114995f,
        .servo_z_w_z_command_from_z_held = -540348.8f,
        .servo_z_w_z_command_from_z_ref_held = 71827.25f,
        .servo_z_start_sum_from_z_held = -45.642223f,
    };
    static const levitator_2dof_parameters_t high = {
        .servo_z_next_sum_from_w_z_excess = -1.656921e-05f,
        .servo_z_next_p1_from_w_z_excess = 3.6010113e-07f,
        .servo_z_next_q1_from_w_z_excess = -1.6142458e-05f,
        .servo_z_w_z_command_from_sum = -1062.9623f,
        .servo_z_w_z_command_from_p1 = -2227.7559f,
        .servo_z_w_z_command_from_q1 = -1700.2103f,
        .servo_z_w_z_command_from_z_predicted = 419054.75f,
        .servo_z_w_z_command_from_vz_predicted = -578.2044f,
        .servo_z_w_z_command_from_w_z_late1_predicted = -0.27449024f,
        .servo_z_w_z_command_from_z_held = -487361.6f,
        .servo_z_w_z_command_from_z_ref_held = 72776.42f,
        .servo_z_start_sum_from_z_held = -44.05281f,
    };

    /* One copy: what is checked is what is taken. */
    const levitator_2dof_parameters_t to = *parameters;
    uint32_t refused = 0u;
    if (to.check != levitator_2dof_checked(&to)) {
        refused |= 0x00000001u;
    }
    bool within = true;
    within = within && levitator_2dof_holds(to.servo_z_next_sum_from_w_z_excess, low.servo_z_next_sum_from_w_z_excess,
        high.servo_z_next_sum_from_w_z_excess);
    within = within && levitator_2dof_holds(to.servo_z_next_p1_from_w_z_excess, low.servo_z_next_p1_from_w_z_excess,
        high.servo_z_next_p1_from_w_z_excess);
    within = within && levitator_2dof_holds(to.servo_z_next_q1_from_w_z_excess, low.servo_z_next_q1_from_w_z_excess,
        high.servo_z_next_q1_from_w_z_excess);
    within = within && levitator_2dof_holds(to.servo_z_w_z_command_from_sum, low.servo_z_w_z_command_from_sum,
        high.servo_z_w_z_command_from_sum);
    within = within && levitator_2dof_holds(to.servo_z_w_z_command_from_p1, low.servo_z_w_z_command_from_p1,
        high.servo_z_w_z_command_from_p1);
    within = within && levitator_2dof_holds(to.servo_z_w_z_command_from_q1, low.servo_z_w_z_command_from_q1,
        high.servo_z_w_z_command_from_q1);
    within = within && levitator_2dof_holds(to.servo_z_w_z_command_from_z_predicted,
        low.servo_z_w_z_command_from_z_predicted, high.servo_z_w_z_command_from_z_predicted);
    within = within && levitator_2dof_holds(to.servo_z_w_z_command_from_vz_predicted,
        low.servo_z_w_z_command_from_vz_predicted, high.servo_z_w_z_command_from_vz_predicted);
    within = within && levitator_2dof_holds(to.servo_z_w_z_command_from_w_z_late1_predicted,
        low.servo_z_w_z_command_from_w_z_late1_predicted, high.servo_z_w_z_command_from_w_z_late1_predicted);
    within = within && levitator_2dof_holds(to.servo_z_w_z_command_from_z_held, low.servo_z_w_z_command_from_z_held,
        high.servo_z_w_z_command_from_z_held);
    within = within && levitator_2dof_holds(to.servo_z_w_z_command_from_z_ref_held,
        low.servo_z_w_z_command_from_z_ref_held, high.servo_z_w_z_command_from_z_ref_held);
    within = within && levitator_2dof_holds(to.servo_z_start_sum_from_z_held, low.servo_z_start_sum_from_z_held,
        high.servo_z_start_sum_from_z_held);
    if (!within) {
        refused |= 0x00000002u;
    }
    if (left == 0u) {
        refused |= 0x00000004u;
    }
    if (refused == 0u) {
        const uint32_t calls = (left > 0u) ? left : 1u;
        const float part = 1.0f / (float)calls;
        state->servo_z.next_sum_from_w_z_excess = levitator_2dof_moved(state->servo_z.next_sum_from_w_z_excess,
            to.servo_z_next_sum_from_w_z_excess, part, low.servo_z_next_sum_from_w_z_excess,
            high.servo_z_next_sum_from_w_z_excess);
        state->servo_z.next_p1_from_w_z_excess = levitator_2dof_moved(state->servo_z.next_p1_from_w_z_excess,
            to.servo_z_next_p1_from_w_z_excess, part, low.servo_z_next_p1_from_w_z_excess,
            high.servo_z_next_p1_from_w_z_excess);
        state->servo_z.next_q1_from_w_z_excess = levitator_2dof_moved(state->servo_z.next_q1_from_w_z_excess,
            to.servo_z_next_q1_from_w_z_excess, part, low.servo_z_next_q1_from_w_z_excess,
            high.servo_z_next_q1_from_w_z_excess);
        state->servo_z.w_z_command_from_sum = levitator_2dof_moved(state->servo_z.w_z_command_from_sum,
            to.servo_z_w_z_command_from_sum, part, low.servo_z_w_z_command_from_sum, high.servo_z_w_z_command_from_sum);
        state->servo_z.w_z_command_from_p1 = levitator_2dof_moved(state->servo_z.w_z_command_from_p1,
            to.servo_z_w_z_command_from_p1, part, low.servo_z_w_z_command_from_p1, high.servo_z_w_z_command_from_p1);
        state->servo_z.w_z_command_from_q1 = levitator_2dof_moved(state->servo_z.w_z_command_from_q1,
            to.servo_z_w_z_command_from_q1, part, low.servo_z_w_z_command_from_q1, high.servo_z_w_z_command_from_q1);
        state->servo_z.w_z_command_from_z_predicted = levitator_2dof_moved(state->servo_z.w_z_command_from_z_predicted,
            to.servo_z_w_z_command_from_z_predicted, part, low.servo_z_w_z_command_from_z_predicted,
            high.servo_z_w_z_command_from_z_predicted);
        state->servo_z.w_z_command_from_vz_predicted =
            levitator_2dof_moved(state->servo_z.w_z_command_from_vz_predicted, to.servo_z_w_z_command_from_vz_predicted,
            part, low.servo_z_w_z_command_from_vz_predicted, high.servo_z_w_z_command_from_vz_predicted);
        state->servo_z.w_z_command_from_w_z_late1_predicted =
            levitator_2dof_moved(state->servo_z.w_z_command_from_w_z_late1_predicted,
            to.servo_z_w_z_command_from_w_z_late1_predicted, part, low.servo_z_w_z_command_from_w_z_late1_predicted,
            high.servo_z_w_z_command_from_w_z_late1_predicted);
        state->servo_z.w_z_command_from_z_held = levitator_2dof_moved(state->servo_z.w_z_command_from_z_held,
            to.servo_z_w_z_command_from_z_held, part, low.servo_z_w_z_command_from_z_held,
            high.servo_z_w_z_command_from_z_held);
        state->servo_z.w_z_command_from_z_ref_held = levitator_2dof_moved(state->servo_z.w_z_command_from_z_ref_held,
            to.servo_z_w_z_command_from_z_ref_held, part, low.servo_z_w_z_command_from_z_ref_held,
            high.servo_z_w_z_command_from_z_ref_held);
        state->servo_z.start_sum_from_z_held = levitator_2dof_moved(state->servo_z.start_sum_from_z_held,
            to.servo_z_start_sum_from_z_held, part, low.servo_z_start_sum_from_z_held,
            high.servo_z_start_sum_from_z_held);
    }
    return refused;
}

LEVITATOR_2DOF_INLINE uint32_t levitator_2dof_body(levitator_2dof_state_t *state, const levitator_2dof_input_t *in,
    levitator_2dof_output_t *out, levitator_2dof_diagnostics_t *diagnostics)
{
    static const float slew_step = 0.05f;                       /* A; 100 A/s times 0.0005 s */

    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
    uint32_t faults = 0u;
    const levitator_2dof_input_t accepted = levitator_2dof_guard_inputs(state, in, &faults);
    const bool complete = (faults & 0x00000003u) == 0u;
    const uint32_t guard_latched = state->guard.latched;
    const uint32_t latched = levitator_2dof_guard(&state->guard, complete, guard_latched);
    if (latched != 0u) {
        /* safe_output: slew to the safe output once latched */
        state->safe_output_last_i1 = levitator_2dof_slew(state->safe_output_last_i1, 0.0f, slew_step);
        out->i1 = state->safe_output_last_i1;
        state->safe_output_last_i2 = levitator_2dof_slew(state->safe_output_last_i2, 0.0f, slew_step);
        out->i2 = state->safe_output_last_i2;
        state->guard.latched = 1u;
        faults |= 0x80000000u;
    } else {
        levitator_2dof_law(state, &accepted, out, diagnostics);
    }

    if (diagnostics != NULL) {
        diagnostics->faults = faults;
        if ((diagnostics->latch_cause == 0u) && ((faults & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = faults;
        }
    }
    return faults;
}

uint32_t levitator_2dof_step(levitator_2dof_state_t *state, const levitator_2dof_input_t *in,
    levitator_2dof_output_t *out)
{
    return levitator_2dof_body(state, in, out, NULL);
}

#if defined(LEVITATOR_2DOF_DIAGNOSTICS)
uint32_t levitator_2dof_step_diagnosed(levitator_2dof_state_t *state, const levitator_2dof_input_t *in,
    levitator_2dof_output_t *out, levitator_2dof_diagnostics_t *diagnostics)
{
    return levitator_2dof_body(state, in, out, diagnostics);
}
#endif
