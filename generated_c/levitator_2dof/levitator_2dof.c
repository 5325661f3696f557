/* levitator_2dof. Generated: do not edit. */
#include "levitator_2dof.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#if defined(LEVITATOR_2DOF_DIAGNOSTICS)
#include <stddef.h>
#endif
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

void levitator_2dof_init(levitator_2dof_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (levitator_2dof_state_t){
        .guard_left = 4u,
    };
}

#if defined(LEVITATOR_2DOF_DIAGNOSTICS)
uint32_t levitator_2dof_step(levitator_2dof_state_t *state, const levitator_2dof_input_t *in,
    levitator_2dof_output_t *out)
{
    return levitator_2dof_step_diagnosed(state, in, out, NULL);
}

uint32_t levitator_2dof_step_diagnosed(levitator_2dof_state_t *state, const levitator_2dof_input_t *in,
    levitator_2dof_output_t *out, levitator_2dof_diagnostics_t *diagnostics)
#else
uint32_t levitator_2dof_step(levitator_2dof_state_t *state, const levitator_2dof_input_t *in,
    levitator_2dof_output_t *out)
#endif
{
#if defined(LEVITATOR_2DOF_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
#endif
    /* guard: range acceptance, hold, latch
     *     left_next = latch_samples if complete is set, else (left if left <= 1, else left - 1) */
    static const uint32_t latch_samples = 4u;                   /* 1; bad samples in a row until it latches */
    uint32_t faults = 0u;
    const float z_held = levitator_2dof_hold_within(in->z, 0.0007f, &state->guard_last_z, 0x00000001u, &faults);
    const float x_held = levitator_2dof_hold_within(in->x, 0.0011f, &state->guard_last_x, 0x00000002u, &faults);
    const float z_ref_held = levitator_2dof_hold_within(in->z_ref, 0.0005f, &state->guard_last_z_ref, 0x00000004u,
        &faults);
    const float x_ref_held = levitator_2dof_hold_within(in->x_ref, 0.0008f, &state->guard_last_x_ref, 0x00000008u,
        &faults);
    const bool complete = (faults & 0x00000003u) == 0u;
    const uint32_t guard_latched = state->guard_latched;
    uint32_t latched = guard_latched;
    if (complete) {
        state->guard_left = latch_samples;
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
        /* safe_output: slew to the safe output once latched */
        static const float slew_step = 0.05f;                   /* A; 100 A/s times 0.0005 s */
        state->safe_output_last_i1 = levitator_2dof_slew(state->safe_output_last_i1, 0.0f, slew_step);
        out->i1 = state->safe_output_last_i1;
        state->safe_output_last_i2 = levitator_2dof_slew(state->safe_output_last_i2, 0.0f, slew_step);
        out->i2 = state->safe_output_last_i2;
        state->guard_latched = 1u;
        faults |= 0x80000000u;
    } else {
        /* errors: tracking errors
         *     z_error = z_ref_held - z_held; likewise x_error */
        const float z_error = z_ref_held - z_held;
        const float x_error = x_ref_held - x_held;

        /* servo_z: servo of z
         *     sum_next = limit((sum if started is set, else limit(sum + start_sum_from_z_held * z_held, 0.34)) -
         *         z_error + 13.3333 * (next_sum_from_w_z_excess * (exp(200 * limit(z_predicted, 0.0006)) *
         *         i1_excess)), 0.34)
         *     p1_next = limit(p1 + next_p1_from_q1 * q1 + 13.3333 * (next_p1_from_w_z_excess * (exp(200 *
         *         limit(z_predicted, 0.0006)) * i1_excess)), 0.0096)
         *     q1_next = limit(next_q1_from_q1 * q1 - p1 - z_error + 13.3333 * (next_q1_from_w_z_excess * (exp(200
         *         * limit(z_predicted, 0.0006)) * i1_excess)), 0.26) */
        /* m/m; servo of z: next_z_predicted from z_predicted */
        static const float servo_z_next_z_predicted_from_z_predicted = -0.021450125f;
        /* m/m s; servo of z: next_z_predicted from vz_predicted */
        static const float servo_z_next_z_predicted_from_vz_predicted = 0.0005f;
        /* m/m s^2; servo of z: next_z_predicted from w_z_late1_predicted */
        static const float servo_z_next_z_predicted_from_w_z_late1_predicted = 1.25e-07f;
        /* m/m; servo of z: next_z_predicted from z_held */
        static const float servo_z_next_z_predicted_from_z_held = 1.0214502f;
        /* m/s/m; servo of z: next_vz_predicted from z_predicted */
        static const float servo_z_next_vz_predicted_from_z_predicted = -704.3172f;
        /* m/s/m s^2; servo of z: next_vz_predicted from w_z_late1_predicted */
        static const float servo_z_next_vz_predicted_from_w_z_late1_predicted = 0.0005f;
        /* m/s/m; servo of z: next_vz_predicted from z_held */
        static const float servo_z_next_vz_predicted_from_z_held = 704.3172f;
        static const float servo_z_w_z_command_from_sum = -1076.6178f; /* m/s^2/m; servo of z: w_z_command from sum */
        static const float servo_z_w_z_command_from_p1 = -3790.4277f; /* m/s^2/m; servo of z: w_z_command from p1 */
        static const float servo_z_w_z_command_from_q1 = -1720.0553f; /* m/s^2/m; servo of z: w_z_command from q1 */
        /* m/s^2/m; servo of z: w_z_command from z_predicted */
        static const float servo_z_w_z_command_from_z_predicted = 389838.22f;
        /* m/s^2/m s; servo of z: w_z_command from vz_predicted */
        static const float servo_z_w_z_command_from_vz_predicted = -610.0382f;
        /* m/s^2/m s^2; servo of z: w_z_command from w_z_late1_predicted */
        static const float servo_z_w_z_command_from_w_z_late1_predicted = -0.29031637f;
        /* m/s^2/m; servo of z: w_z_command from z_held */
        static const float servo_z_w_z_command_from_z_held = -510253.0f;
        /* m/s^2/m; servo of z: w_z_command from z_ref_held */
        static const float servo_z_w_z_command_from_z_ref_held = 72248.88f;
        /* m/m; servo of z: z_predicted from z_predicted */
        static const float servo_z_z_predicted_from_z_predicted = -0.021450125f;
        /* m/m s; servo of z: z_predicted from vz_predicted */
        static const float servo_z_z_predicted_from_vz_predicted = 0.0005f;
        /* m/m s^2; servo of z: z_predicted from w_z_late1_predicted */
        static const float servo_z_z_predicted_from_w_z_late1_predicted = 1.25e-07f;
        static const float servo_z_z_predicted_from_z_held = 1.0214502f; /* m/m; servo of z: z_predicted from z_held */
        static const float servo_z_start_sum_from_z_held = -44.73818f; /* m/m; servo of z: start_sum from z_held */
        const uint32_t servo_z_started = state->servo_z_started;
        const float servo_z_sum = state->servo_z_sum;
        const float servo_z_z_predicted = state->servo_z_z_predicted;
        float current_sum = servo_z_sum;
        float current_z_predicted = servo_z_z_predicted;
        if (servo_z_started == 0u) {
            current_sum = levitator_2dof_limit(servo_z_sum + (servo_z_start_sum_from_z_held * z_held), 0.34f);
            current_z_predicted = levitator_2dof_limit(servo_z_z_predicted + z_held, 0.0014f);
        }
        const float servo_z_p1 = state->servo_z_p1;
        const float servo_z_q1 = state->servo_z_q1;
        const float servo_z_vz_predicted = state->servo_z_vz_predicted;
        const float servo_z_w_z_late1_predicted = state->servo_z_w_z_late1_predicted;
        const float w_z_command = (servo_z_w_z_command_from_sum * current_sum) +
            (servo_z_w_z_command_from_p1 * servo_z_p1) + (servo_z_w_z_command_from_q1 * servo_z_q1) +
            (servo_z_w_z_command_from_z_predicted * current_z_predicted) + (servo_z_w_z_command_from_vz_predicted *
            servo_z_vz_predicted) + (servo_z_w_z_command_from_w_z_late1_predicted * servo_z_w_z_late1_predicted) +
            (servo_z_w_z_command_from_z_held * z_held) + (servo_z_w_z_command_from_z_ref_held * z_ref_held);
        const float z_predicted = (servo_z_z_predicted_from_z_predicted * current_z_predicted) +
            (servo_z_z_predicted_from_vz_predicted * servo_z_vz_predicted) +
            (servo_z_z_predicted_from_w_z_late1_predicted * servo_z_w_z_late1_predicted) +
            (servo_z_z_predicted_from_z_held * z_held);
        const float next_values_z_predicted = (servo_z_next_z_predicted_from_z_predicted * current_z_predicted) +
            (servo_z_next_z_predicted_from_vz_predicted * servo_z_vz_predicted) +
            (servo_z_next_z_predicted_from_w_z_late1_predicted * servo_z_w_z_late1_predicted) +
            (servo_z_next_z_predicted_from_z_held * z_held);
        state->servo_z_z_predicted = levitator_2dof_limit(next_values_z_predicted, 0.0014f);
        const float next_values_vz_predicted = (servo_z_next_vz_predicted_from_z_predicted * current_z_predicted) +
            servo_z_vz_predicted + (servo_z_next_vz_predicted_from_w_z_late1_predicted * servo_z_w_z_late1_predicted) +
            (servo_z_next_vz_predicted_from_z_held * z_held);
        state->servo_z_vz_predicted = levitator_2dof_limit(next_values_vz_predicted, 1.3f);
        state->servo_z_started = 1u;
        const float exp_2 = exp_polynomial(levitator_2dof_limit(z_predicted, 0.0006f));

        /* inverse_z: feedback linearisation of z
         *     i1_demand = 0.075 * (w_z_command - (9.33333 * exp(200 * limit(z_predicted, 0.0006)) - 9.81)) /
         *         exp(200 * limit(z_predicted, 0.0006)) */
        const float a = (9.333333f * exp_2) - 9.81f;
        const float i1_demand = 0.075f * (w_z_command - a) / exp_2;
        const float i1_computed = levitator_2dof_limit(i1_demand, 3.0f);
        const float i1_excess = i1_computed - i1_demand;

        /* achieved_z: feedback linearisation of z
         *     w_z_limited = 9.33333 * exp(200 * limit(z_predicted, 0.0006)) - 9.81 + 13.3333 * (exp(200 *
         *         limit(z_predicted, 0.0006)) * i1_computed) */
        const float w_z_limited = a + (13.333333f * (exp_2 * i1_computed));

        /* servo_z: servo of z (continued) */
        /* m/m s^2; servo of z: next_sum from w_z_excess */
        static const float servo_z_next_sum_from_w_z_excess = -1.6728576e-05f;
        static const float servo_z_next_p1_from_q1 = 0.0009868792f; /* m/m; servo of z: next_p1 from q1 */
        /* m/m s^2; servo of z: next_p1 from w_z_excess */
        static const float servo_z_next_p1_from_w_z_excess = 3.4155806e-07f;
        static const float servo_z_next_q1_from_q1 = 0.9990131f; /* m/m; servo of z: next_q1 from q1 */
        /* m/m s^2; servo of z: next_q1 from w_z_excess */
        static const float servo_z_next_q1_from_w_z_excess = -1.6240092e-05f;
        const float exp_2_times_i1_excess = exp_2 * i1_excess;
        state->servo_z_sum = levitator_2dof_limit(current_sum - z_error +
            (13.333333f * (servo_z_next_sum_from_w_z_excess * exp_2_times_i1_excess)), 0.34f);
        state->servo_z_p1 = levitator_2dof_limit(servo_z_p1 + (servo_z_next_p1_from_q1 * servo_z_q1) +
            (13.333333f * (servo_z_next_p1_from_w_z_excess * exp_2_times_i1_excess)), 0.0096f);
        const float next_values_q1 = (servo_z_next_q1_from_q1 * servo_z_q1) - servo_z_p1 - z_error +
            (13.333333f * (servo_z_next_q1_from_w_z_excess * exp_2_times_i1_excess));
        state->servo_z_q1 = levitator_2dof_limit(next_values_q1, 0.26f);
        state->servo_z_w_z_late1_predicted = w_z_limited;
        state->safe_output_last_i1 = i1_computed;
        out->i1 = i1_computed;

        /* servo_x: servo of x
         *     sum_next = limit((sum if started is set, else limit(sum + start_sum_from_x_held * x_held, 0.51)) -
         *         x_error + next_sum_from_i2_excess * i2_excess, 0.51)
         *     p1_next = limit(p1 + next_p1_from_q1 * q1 + next_p1_from_i2_excess * i2_excess, 0.014)
         *     q1_next = limit(next_q1_from_q1 * q1 - p1 - x_error + next_q1_from_i2_excess * i2_excess, 0.41)
         *     p2_next = limit(p2 + next_p2_from_q2 * q2 + next_p2_from_i2_excess * i2_excess, 0.073)
         *     q2_next = limit(next_q2_from_q2 * q2 - p2 - x_error + next_q2_from_i2_excess * i2_excess, 0.48) */
        /* m/m; servo of x: next_x_predicted from x_predicted */
        static const float servo_x_next_x_predicted_from_x_predicted = -0.30337617f;
        /* m/m s; servo of x: next_x_predicted from vx_predicted */
        static const float servo_x_next_x_predicted_from_vx_predicted = 0.0004995558f;
        /* m/A; servo of x: next_x_predicted from i2_late1_predicted */
        static const float servo_x_next_x_predicted_from_i2_late1_predicted = 3.3313897e-06f;
        /* m/m; servo of x: next_x_predicted from x_held */
        static const float servo_x_next_x_predicted_from_x_held = 1.3032097f;
        /* m/s/m; servo of x: next_vx_predicted from x_predicted */
        static const float servo_x_next_vx_predicted_from_x_predicted = -1055.379f;
        /* m/s/m s; servo of x: next_vx_predicted from vx_predicted */
        static const float servo_x_next_vx_predicted_from_vx_predicted = 0.99816823f;
        /* m/s/A; servo of x: next_vx_predicted from i2_late1_predicted */
        static const float servo_x_next_vx_predicted_from_i2_late1_predicted = 0.013321488f;
        /* m/s/m; servo of x: next_vx_predicted from x_held */
        static const float servo_x_next_vx_predicted_from_x_held = 1054.713f;
        static const float servo_x_i2_demand_from_sum = -34.916763f; /* A/m; servo of x: i2_demand from sum */
        static const float servo_x_i2_demand_from_p1 = -130.0009f; /* A/m; servo of x: i2_demand from p1 */
        static const float servo_x_i2_demand_from_q1 = -55.77232f; /* A/m; servo of x: i2_demand from q1 */
        static const float servo_x_i2_demand_from_p2 = 350.80725f; /* A/m; servo of x: i2_demand from p2 */
        static const float servo_x_i2_demand_from_q2 = 13.477797f; /* A/m; servo of x: i2_demand from q2 */
        /* A/m; servo of x: i2_demand from x_predicted */
        static const float servo_x_i2_demand_from_x_predicted = 19688.031f;
        /* A/m s; servo of x: i2_demand from vx_predicted */
        static const float servo_x_i2_demand_from_vx_predicted = -19.514633f;
        /* A/A; servo of x: i2_demand from i2_late1_predicted */
        static const float servo_x_i2_demand_from_i2_late1_predicted = -0.246704f;
        static const float servo_x_i2_demand_from_x_held = -23879.664f; /* A/m; servo of x: i2_demand from x_held */
        /* A/m; servo of x: i2_demand from x_ref_held */
        static const float servo_x_i2_demand_from_x_ref_held = 2095.8171f;
        static const float servo_x_start_sum_from_x_held = -60.02324f; /* m/m; servo of x: start_sum from x_held */
        const uint32_t servo_x_started = state->servo_x_started;
        const float servo_x_sum = state->servo_x_sum;
        const float servo_x_x_predicted = state->servo_x_x_predicted;
        float current_sum_2 = servo_x_sum;
        float current_x_predicted = servo_x_x_predicted;
        if (servo_x_started == 0u) {
            current_sum_2 = levitator_2dof_limit(servo_x_sum + (servo_x_start_sum_from_x_held * x_held), 0.51f);
            current_x_predicted = levitator_2dof_limit(servo_x_x_predicted + x_held, 0.0024f);
        }
        const float servo_x_p1 = state->servo_x_p1;
        const float servo_x_q1 = state->servo_x_q1;
        const float servo_x_p2 = state->servo_x_p2;
        const float servo_x_q2 = state->servo_x_q2;
        const float servo_x_vx_predicted = state->servo_x_vx_predicted;
        const float servo_x_i2_late1_predicted = state->servo_x_i2_late1_predicted;
        const float i2_demand = (servo_x_i2_demand_from_sum * current_sum_2) + (servo_x_i2_demand_from_p1 *
            servo_x_p1) + (servo_x_i2_demand_from_q1 * servo_x_q1) + (servo_x_i2_demand_from_p2 * servo_x_p2) +
            (servo_x_i2_demand_from_q2 * servo_x_q2) + (servo_x_i2_demand_from_x_predicted * current_x_predicted) +
            (servo_x_i2_demand_from_vx_predicted * servo_x_vx_predicted) +
            (servo_x_i2_demand_from_i2_late1_predicted * servo_x_i2_late1_predicted) +
            (servo_x_i2_demand_from_x_held * x_held) + (servo_x_i2_demand_from_x_ref_held * x_ref_held);
        const float next_values_x_predicted = (servo_x_next_x_predicted_from_x_predicted * current_x_predicted) +
            (servo_x_next_x_predicted_from_vx_predicted * servo_x_vx_predicted) +
            (servo_x_next_x_predicted_from_i2_late1_predicted * servo_x_i2_late1_predicted) +
            (servo_x_next_x_predicted_from_x_held * x_held);
        state->servo_x_x_predicted = levitator_2dof_limit(next_values_x_predicted, 0.0024f);
        const float next_values_vx_predicted = (servo_x_next_vx_predicted_from_x_predicted * current_x_predicted) +
            (servo_x_next_vx_predicted_from_vx_predicted * servo_x_vx_predicted) +
            (servo_x_next_vx_predicted_from_i2_late1_predicted * servo_x_i2_late1_predicted) +
            (servo_x_next_vx_predicted_from_x_held * x_held);
        state->servo_x_vx_predicted = levitator_2dof_limit(next_values_vx_predicted, 2.8f);
        state->servo_x_started = 1u;

        /* limits: actuator limits
         *     i1_excess = i1_computed - i1_demand; likewise i2_excess */
        const float i2_computed = levitator_2dof_limit(i2_demand, 2.0f);
        const float i2_excess = i2_computed - i2_demand;
        out->i2 = i2_computed;
        state->safe_output_last_i2 = i2_computed;

        /* servo_x: servo of x (continued) */
        /* m/A; servo of x: next_sum from i2_excess */
        static const float servo_x_next_sum_from_i2_excess = -0.00051277f;
        static const float servo_x_next_p1_from_q1 = 0.0009868792f; /* m/m; servo of x: next_p1 from q1 */
        static const float servo_x_next_p1_from_i2_excess = 9.798624e-06f; /* m/A; servo of x: next_p1 from i2_excess */
        static const float servo_x_next_q1_from_q1 = 0.9990131f; /* m/m; servo of x: next_q1 from q1 */
        /* m/A; servo of x: next_q1 from i2_excess */
        static const float servo_x_next_q1_from_i2_excess = -0.00051205757f;
        static const float servo_x_next_p2_from_q2 = 0.02462332f; /* m/m; servo of x: next_p2 from q2 */
        static const float servo_x_next_p2_from_i2_excess = 7.537349e-05f; /* m/A; servo of x: next_p2 from i2_excess */
        static const float servo_x_next_q2_from_q2 = 0.97537667f; /* m/m; servo of x: next_q2 from q2 */
        /* m/A; servo of x: next_q2 from i2_excess */
        static const float servo_x_next_q2_from_i2_excess = 0.00018017541f;
        state->servo_x_sum = levitator_2dof_limit(current_sum_2 - x_error +
            (servo_x_next_sum_from_i2_excess * i2_excess), 0.51f);
        state->servo_x_p1 = levitator_2dof_limit(servo_x_p1 + (servo_x_next_p1_from_q1 * servo_x_q1) +
            (servo_x_next_p1_from_i2_excess * i2_excess), 0.014f);
        const float next_values_q1_2 = (servo_x_next_q1_from_q1 * servo_x_q1) - servo_x_p1 - x_error +
            (servo_x_next_q1_from_i2_excess * i2_excess);
        state->servo_x_q1 = levitator_2dof_limit(next_values_q1_2, 0.41f);
        state->servo_x_p2 = levitator_2dof_limit(servo_x_p2 + (servo_x_next_p2_from_q2 * servo_x_q2) +
            (servo_x_next_p2_from_i2_excess * i2_excess), 0.073f);
        const float next_values_q2 = (servo_x_next_q2_from_q2 * servo_x_q2) - servo_x_p2 - x_error +
            (servo_x_next_q2_from_i2_excess * i2_excess);
        state->servo_x_q2 = levitator_2dof_limit(next_values_q2, 0.48f);
        state->servo_x_i2_late1_predicted = i2_computed;
#if defined(LEVITATOR_2DOF_DIAGNOSTICS)
        if (diagnostics != NULL) {
            diagnostics->z_error = z_error;
            diagnostics->x_error = x_error;
            diagnostics->w_z_command = w_z_command;
            diagnostics->z_predicted = z_predicted;
            diagnostics->i1_demand = i1_demand;
            diagnostics->i1_excess = i1_excess;
            diagnostics->w_z_limited = w_z_limited;
            diagnostics->i2_demand = i2_demand;
            diagnostics->i2_excess = i2_excess;
            diagnostics->saturated |= (fabsf(i1_computed) >= 3.0f) ? 0x00000001u : 0u;
            diagnostics->saturated |= (fabsf(i2_computed) >= 2.0f) ? 0x00000002u : 0u;
        }
#endif
    }

#if defined(LEVITATOR_2DOF_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->faults = faults;
        if ((diagnostics->latch_cause == 0u) && ((faults & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = faults;
        }
    }
#endif
    return faults;
}
