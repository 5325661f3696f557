/* maglev_5dof_precise. Generated: do not edit. */
/* A comment with `admit` states a bound that the generator has certified, for Frama-C. */
#include "maglev_5dof_precise.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>
#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
#include <stddef.h>
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))
#error "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"
#endif

static inline float maglev_5dof_precise_min(float a, float b)
{
    return (a < b) ? a : b;
}

static inline float maglev_5dof_precise_max(float a, float b)
{
    return (a > b) ? a : b;
}

/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */
static inline float maglev_5dof_precise_limit(float x, float high)
{
    return (fabsf(x) <= high) ? x : ((x < 0.0f) ? -high : fabsf(high));
}

static inline float maglev_5dof_precise_slew(float last, float target, float step)
{
    const float highest = last + step;
    const float lowest = last - step;
    const float below = (target < highest) ? target : highest;
    return (below > lowest) ? below : lowest;
}

static inline uint32_t maglev_5dof_precise_flag(bool holds)
{
    uint32_t value = 0u;
    if (holds) {
        value = 1u;
    }
    return value;
}

static inline bool maglev_5dof_precise_equal(float a, float b)
{
    return (a <= b) && !(a < b);
}

#if defined(__GNUC__)
#define MAGLEV_5DOF_PRECISE_INLINE static inline __attribute__((always_inline))
#else
#define MAGLEV_5DOF_PRECISE_INLINE static inline
#endif
#if defined(__OPTIMIZE_SIZE__)
#define MAGLEV_5DOF_PRECISE_LARGE static inline
#else
#define MAGLEV_5DOF_PRECISE_LARGE MAGLEV_5DOF_PRECISE_INLINE
#endif
/* Return a value in low .. high, which `last` becomes; for another one or NaN, set its fault bit and return *last. */
MAGLEV_5DOF_PRECISE_INLINE float maglev_5dof_precise_hold(float value, float low, float high, float *last, uint32_t bit,
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
MAGLEV_5DOF_PRECISE_INLINE float maglev_5dof_precise_hold_within(float value, float high, float *last, uint32_t bit,
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

/* phi / x, theta / x; x = y3_held - y1_held and 1 other in -0.0241999999 .. 0.0241999999, t = x^2; relative error at
 * most 1.2e-07. */
static inline float phi_polynomial(float t)
{
    return 1.2594458f + (t * 0.33307245f);
}

/* thrust_per_ampere; x = 1.53083199e-06 / (max(min((y_fast_ahead - (0.397 * phi_fast_ahead)), 0.0322), 0.0168) +
 * 0.00923333333) and 1 other in 3.69468689e-05 .. 5.88027688e-05, t = x - 4.19616699e-05; relative error at most
 * 1.7e-07. */
static inline float thrust_per_ampere_polynomial(float t)
{
    return 11.033894f + (t * (526422.7f + (t * (6.5208314e+08f +
        (t * (-7.354629e+13f + (t * (2.0442113e+18f + (t * (-4.015988e+22f + (t * 3.9883e+26f)))))))))));
}

/* half_a_over_h2; x = 1.53083199e-06 / (max(min((y_fast_ahead - (0.397 * phi_fast_ahead)), 0.0322), 0.0168) +
 * 0.00923333333) and 1 other in 3.69468689e-05 .. 5.88027688e-05, t = x - 4.19616699e-05; relative error at most
 * 2.8e-07. */
static inline float half_a_over_h2_polynomial(float t)
{
    return 0.082106546f + (t * (372.6345f + (t * (2.9113838e+06f + (t * (2.5398596e+10f + (t * 2.6154908e+14f)))))));
}

/* thrust_per_ampere; x = 1.53083199e-06 / (max(min((y_fast_ahead + (0.397 * theta_fast_ahead)), 0.0366), 0.0124) +
 * 0.00923333333) and 1 other in 3.33999706e-05 .. 7.07626459e-05, t = (x - 3.43322754e-05) * 16384; relative error at
 * most 2.9e-07. */
static inline float thrust_per_ampere_2_polynomial(float t)
{
    return 7.0962987f + (t * (30.470612f + (t * (12.132695f +
        (t * (-37.392975f + (t * (56.708466f + (t * (-57.090378f + (t * (33.817627f + (t * -9.12594f)))))))))))));
}

/* half_a_over_h2; x = 1.53083199e-06 / (max(min((y_fast_ahead + (0.397 * theta_fast_ahead)), 0.0366), 0.0124) +
 * 0.00923333333) and 1 other in 3.33999706e-05 .. 7.07626459e-05, t = (x - 3.43322754e-05) * 16384; relative error at
 * most 3.3e-07. */
static inline float half_a_over_h2_2_polynomial(float t)
{
    return 0.079422385f + (t * (0.020285927f +
        (t * (0.008864189f + (t * (0.0048612426f + (t * (0.001367154f + (t * 0.0020529632f)))))))));
}

typedef struct {
    float disturbance;
    float estimate;
    float rate;
} maglev_5dof_precise_observer_t;

/* observer_x, observer_z: predictive observer, alpha-beta-gamma
 *     nu = x_held - q
 *     rate_ahead = x_rate + T * (g * delay_a_x_last + x_disturbance)
 *     same = x_trusted and 1 <= x_unchanged
 *     x_disturbance = (limit(d + gamma * nu, largest_disturbance) if x_trusted is set, else 0) if
 *         guard_ready is set, else 0
 *     x_estimate = q + alpha * nu if guard_ready is set, else x_held
 *     x_rate = (v + beta * nu if x_trusted is set, else (0 if x_diverges is set, else v - (beta / gamma *
 *         (d - d_at_change) + T * gained if x_frozen is set, else 0))) if guard_ready is set, else 0
 *     q_next = limit(x_estimate + half_T * (x_rate + rate_ahead), largest_position)
 *     v_next = limit(rate_ahead, largest_rate)
 *     gained_next = gained_decay * gained + x_disturbance - d_at_change if same, else 0
 *     g_next = max(min(g + ((learning_step * (delay_a_x_last * limit(d + gamma * nu, largest_disturbance))
 *         if x_trusted is set, else 0) if guard_ready is set, else 0), largest_gain), least_gain) */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_observer_t
    maglev_5dof_precise_observer(maglev_5dof_precise_observer_state_t *state, uint32_t ready, bool trusted, float held,
    bool diverges, uint32_t frozen, float a_before, uint32_t unchanged)
{
    static const float gamma = 197.49799f;                      /* 1/s^2; triple pole exp(-w T), w = 60 rad/s */
    static const float largest_disturbance = 20.0f;             /* m/s^2; bound of the disturbance */
    static const float alpha = 0.16472979f;                     /* 1; triple pole exp(-w T), w = 60 rad/s */
    static const float beta = 9.877862f;                        /* 1/s; triple pole exp(-w T), w = 60 rad/s */
    static const float T = 0.001f;                              /* s; sample period */
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float largest_position = 0.1f;                 /* m; bound of the prediction */
    static const float largest_rate = 2.0f;                     /* m/s; bound of the predicted rate */
    static const float gained_decay = 0.9980469f;               /* 1; part of the sum that stays */
    static const float learning_step = 0.03f;                   /* s^4/m^2; 30 times T */
    static const float largest_gain = 1.2f;                     /* 1; bound of the learnt gain */
    static const float least_gain = 0.8f;                       /* 1; bound of the learnt gain */

    const float d_at_change = state->d_at_change;
    const float gained = state->gained;
    float d_next = 0.0f;
    float estimate = held;
    float rate = 0.0f;
    float g_change = 0.0f;
    if (ready != 0u) {
        const float q = state->q;
        const float nu = held - q;
        const float d = state->d;
        const float v = state->v;
        if (trusted) {
            const float d_if_trusted = maglev_5dof_precise_limit(d + (gamma * nu), largest_disturbance);
            d_next = d_if_trusted;
            rate = v + (beta * nu);
            g_change = learning_step * (a_before * d_if_trusted);
        } else {
            if (!diverges) {
                float taken_back = 0.0f;
                if (frozen != 0u) {
                    taken_back = (beta / gamma * (d - d_at_change)) + (T * gained);
                }
                rate = v - taken_back;
            }
        }
        estimate = q + (alpha * nu);
    }
    const float g = state->g;
    const float rate_ahead = rate + (T * ((g * a_before) + d_next));
    state->q = maglev_5dof_precise_limit(estimate + (half_T * (rate + rate_ahead)), largest_position);
    state->v = maglev_5dof_precise_limit(rate_ahead, largest_rate);
    state->d = d_next;
    if (trusted && (1u <= unchanged)) {
        state->gained = (gained_decay * gained) + (d_next - d_at_change);
    } else {
        state->gained = 0.0f;
        state->d_at_change = d_next;
    }
    state->g = maglev_5dof_precise_max(maglev_5dof_precise_min(g + g_change, largest_gain), least_gain);
    return (maglev_5dof_precise_observer_t){.disturbance = d_next, .estimate = estimate, .rate = rate};
}

typedef struct {
    uint32_t unchanged;
    float before_next;
    bool usual;
    uint32_t suspect;
    bool trusted;
    float held;
    uint32_t frozen;
    bool diverges;
    uint32_t excluded_next;
    uint32_t doubts_next;
    uint32_t jumps_next;
} maglev_5dof_precise_monitor_t;

/* x_monitor, z_monitor: frozen codes, jumps of the innovation
 *     x_unchanged = (still if most_unchanged <= still, else still + 1) if x_accepted == code, else 0 */
MAGLEV_5DOF_PRECISE_LARGE maglev_5dof_precise_monitor_t
    maglev_5dof_precise_monitor(const maglev_5dof_precise_monitor_state_t *state, float expected, float accepted,
    bool in_time, uint32_t ready, bool unanswered, bool sound, bool good, bool counted)
{
    static const uint32_t most_unchanged = 40u;                 /* 1; samples without a change that are counted */
    static const float gate = 4e-05f;                           /* m; an agreeing prediction is nearer */
    static const float jump = 0.00015f; /* m; from the prediction: no acceleration of the machine explains it */
    /* m; growth of the distance to the prediction that needs no earlier agreement: of a code that changes */
    static const float wide_jump = 0.0005f;
    /* m; from the prediction: no sound reading is farther, but after missing calls */
    static const float away = 0.0003f;
    static const uint32_t doubted_changes = 10u; /* 1; changes of the code until its prediction is believed */
    static const float travel = 0.0499f; /* m; end of the travel, where a stop may hold it; of low, high */
    static const uint32_t repeated_samples = 3u; /* 1; samples without a change of the code: fewer, and it moves */
    static const float frozen_gate = 8.2e-05f; /* m; predicted motion in which a working code changes */
    /* m; growth of the distance to the prediction that needs no earlier agreement: of a code that stands still */
    static const float wide_frozen = 0.0002f;
    static const uint32_t excluded_from = 2u;                   /* 1; contradictions or jumps before the last */
    static const uint32_t doubted_after_missed_calls = 20u;     /* 1; of these the first half for its distance */

    const float code = state->code;
    const bool same = maglev_5dof_precise_equal(accepted, code);
    const float before = state->before;
    const uint32_t doubts = state->doubts;
    uint32_t unchanged = 0u;
    float before_next_if_ready = before;
    uint32_t doubts_next = doubts;
    if (same) {
        const uint32_t still = state->still;
        unchanged = (most_unchanged <= still) ? still : (still + 1u);
    } else {
        before_next_if_ready = expected;
        if (1u <= doubts) {
            doubts_next = doubts - 1u;
        } else {
            doubts_next = 0u;
        }
    }
    const float before_next = (ready != 0u) ? before_next_if_ready : accepted;
    const float distance = fabsf(expected - accepted);
    const uint32_t jumps = state->jumps;
    const bool doubts_below_1 = doubts < 1u;
    bool jumping = false;
    bool strayed = false;
    bool gradual = false;
    if (gate < distance) {
        const bool stays = same || (doubted_changes < doubts);
        uint32_t doubts_next_if_counted;
        if (jump < distance) {
            const float growth = distance - fabsf(code - before);
            const bool sudden = doubts_below_1 || (wide_jump < growth);
            const bool believed = (sudden || ((away < distance) && (doubts <= doubted_changes))) && in_time &&
                (-travel < expected) && (expected < travel) && (-travel < code) && (code < travel);
            jumping = (1u <= jumps) || (believed && !same);
            strayed = wide_frozen < growth;
            gradual = !sudden;
            doubts_next_if_counted = (stays || believed) ? doubts : doubted_changes;
        } else {
            doubts_next_if_counted = (stays) ? doubts : doubted_changes;
        }
        doubts_next = (counted) ? doubts_next_if_counted : doubted_after_missed_calls;
    }
    const uint32_t excluded = state->excluded;
    const bool suspect_test = excluded == 0u;
    bool usual = false;
    uint32_t suspect = 1u;
    bool trusted = false;
    float held = expected;
    uint32_t frozen = excluded;
    bool diverges = false;
    uint32_t excluded_next;
    uint32_t jumps_next = 0u;
    if (jumping) {
        diverges = gradual && (jumps < 1u) && suspect_test;
        const bool last = excluded_from <= jumps;
        excluded_next = (last) ? 1u : excluded;
        jumps_next = (last) ? 0u : (jumps + 1u);
    } else {
        const bool usable = good && suspect_test;
        const uint32_t stopped = (usable) ? 1u : excluded;
        if ((repeated_samples <= unchanged) && (-travel < accepted) && (accepted < travel) && (((frozen_gate <
                fabsf(expected - before_next)) && doubts_below_1) || strayed || unanswered) && (ready != 0u)) {
            suspect = stopped;
            frozen = stopped;
            excluded_next = stopped;
        } else {
            usual = sound;
            if (sound) {
                suspect = 0u;
                frozen = 0u;
                excluded_next = 0u;
                trusted = true;
                held = accepted;
            } else {
                suspect = excluded;
                excluded_next = excluded;
                trusted = usable;
                held = (usable) ? accepted : expected;
            }
        }
    }
    return (maglev_5dof_precise_monitor_t){.unchanged = unchanged, .before_next = before_next, .usual = usual,
        .suspect = suspect, .trusted = trusted, .held = held, .frozen = frozen, .diverges = diverges,
        .excluded_next = excluded_next, .doubts_next = doubts_next, .jumps_next = jumps_next};
}

typedef struct {
    float k_e;                          /* 1/s^2; predictive servo with internal models: gain on e */
    float k_de;                         /* 1/s; predictive servo with internal models: gain on de */
    float largest_step;                 /* m; a larger change of the set-point has no rate */
    float k_step;                       /* 1/s^2; predictive servo with internal models: k_de over the period */
    float k_sum;                        /* 1/s^2; predictive servo with internal models: gain on sum */
    float k_p1;                         /* 1/s^2; predictive servo with internal models: gain on p1 */
    float k_q1;                         /* 1/s^2; predictive servo with internal models: gain on q1 */
    float k_p2;                         /* 1/s^2; predictive servo with internal models: gain on p2 */
    float k_q2;                         /* 1/s^2; predictive servo with internal models: gain on q2 */
    float k_p3;                         /* 1/s^2; predictive servo with internal models: gain on p3 */
    float k_q3;                         /* 1/s^2; predictive servo with internal models: gain on q3 */
    float low;                          /* minus the upper end of a limit */
    float largest_error;                /* m; a larger error counts as this in the internal models */
} maglev_5dof_precise_servo_fast_parameters_t;

/* servo_y_fast, servo_x_fast, servo_z_fast, servo_theta_fast: predictive servo with internal models; the numbers are
 * those of servo_y_fast
 *     r_next = y_ref_held */
MAGLEV_5DOF_PRECISE_LARGE float maglev_5dof_precise_servo_fast(maglev_5dof_precise_servo_fast_state_t *state,
    const maglev_5dof_precise_servo_fast_parameters_t *parameters, float fast_ahead, float ref_held,
    float fast_rate_ahead, uint32_t ready, float value, float e)
{
    static const float cancelled = 0.8f;                        /* 1; part of the disturbance that is cancelled */
    /* 1; predictive servo with internal models: 2 - 2 cos(w T), w T = 0.00471239 */
    static const float c1 = 2.2206568e-05f;
    /* 1; predictive servo with internal models: 2 - 2 cos(w T), w T = 0.00942478 */
    static const float c2 = 8.8825785e-05f;
    /* 1; predictive servo with internal models: 2 - 2 cos(w T), w T = 0.0141372 */
    static const float c3 = 0.00019985616f;

    const float sum = state->sum;
    const float e_2 = maglev_5dof_precise_limit(e, parameters->largest_error);
    const float sum_next = sum + e_2;
    const float p1 = state->p1;
    const float q1 = state->q1;
    const float p1_next = p1 + (c1 * q1);
    const float q1_next = q1 - p1_next + e_2;
    const float p2 = state->p2;
    const float q2 = state->q2;
    const float p2_next = p2 + (c2 * q2);
    const float q2_next = q2 - p2_next + e_2;
    const float p3 = state->p3;
    const float q3 = state->q3;
    const float p3_next = p3 + (c3 * q3);
    const float q3_next = q3 - p3_next + e_2;
    const float sum_sum = (sum_next * sum_next) + (p1_next * p1_next) + (q1_next * q1_next) + (p2_next * p2_next) +
        (q2_next * q2_next) + (p3_next * p3_next) + (q3_next * q3_next);
    if (sum_sum <= 16.0f) {
        /*@ admit -4.0000005f <= sum_next <= 4.0000005f; */
        /*@ admit -4.0000005f <= p1_next <= 4.0000005f; */
        /*@ admit -4.0000005f <= q1_next <= 4.0000005f; */
        /*@ admit -4.0000005f <= p2_next <= 4.0000005f; */
        /*@ admit -4.0000005f <= q2_next <= 4.0000005f; */
        /*@ admit -4.0000005f <= p3_next <= 4.0000005f; */
        /*@ admit -4.0000005f <= q3_next <= 4.0000005f; */
        state->sum = sum_next;
        state->p1 = p1_next;
        state->q1 = q1_next;
        state->p2 = p2_next;
        state->q2 = q2_next;
        state->p3 = p3_next;
        state->q3 = q3_next;
    }
    const float r_2 = state->r;
    state->r = ref_held;
    const float moved = ref_held - r_2;
    float w_tracking_choice = 0.0f;
    if (fabsf(moved) <= parameters->largest_step) {
        w_tracking_choice = parameters->k_step * moved;
    }
    const float w_tracking_sum = (parameters->k_e * (fast_ahead - ref_held)) + (parameters->k_de * fast_rate_ahead) -
        w_tracking_choice + (parameters->k_sum * sum) + (parameters->k_p1 * p1) + (parameters->k_q1 * q1) +
        (parameters->k_p2 * p2) + (parameters->k_q2 * q2) + (parameters->k_p3 * p3) + (parameters->k_q3 * q3);
    float w_tracking_choice_2 = 0.0f;
    if (ready != 0u) {
        w_tracking_choice_2 = cancelled * value;
    }
    return w_tracking_sum - w_tracking_choice_2;
}

typedef struct {
    float alpha;                        /* 1; triple pole exp(-w T), w = 400 rad/s */
    float beta;                         /* 1/s; triple pole exp(-w T), w = 400 rad/s */
    float low;                          /* minus the upper end of a limit */
    float largest_position;             /* m; bound of the prediction */
    float low_2;                        /* minus the upper end of a limit */
    float largest_rate;                 /* m/s; bound of the predicted rate */
} maglev_5dof_precise_observer_fast_parameters_t;

typedef struct {
    float fast_ahead;
    float fast_rate_ahead;
} maglev_5dof_precise_observer_fast_t;

/* observer_x_fast, observer_z_fast, observer_phi_fast, observer_theta_fast: predictive observer, alpha-beta-gamma;
 * the numbers are those of observer_x_fast
 *     nu = x_held - q
 *     rate_ahead = x_fast_rate + T * (delay_a_x_last + x_fast_disturbance)
 *     x_fast_estimate = q + alpha * nu if guard_ready is set, else x_held
 *     x_fast_rate = v + beta * nu if guard_ready is set, else 0
 *     x_fast_disturbance = limit(d + gamma * nu, largest_disturbance) if guard_ready is set, else 0
 *     x_fast_ahead = limit(x_fast_estimate + half_T * (x_fast_rate + rate_ahead), largest_position)
 *     x_fast_rate_ahead = limit(rate_ahead, largest_rate) */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_observer_fast_t
    maglev_5dof_precise_observer_fast(maglev_5dof_precise_observer_fast_state_t *state,
    const maglev_5dof_precise_observer_fast_parameters_t *parameters, uint32_t ready, float nu, float value,
    float value_2, float before)
{
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float T = 0.001f;                              /* s; sample period */

    float x_fast_estimate = value;
    float x_fast_rate = 0.0f;
    float x_fast_disturbance = value_2;
    if (ready != 0u) {
        x_fast_estimate = state->q + (parameters->alpha * nu);
        x_fast_rate = state->v + (parameters->beta * nu);
    } else {
        x_fast_disturbance = 0.0f;
    }
    const float rate_ahead = x_fast_rate + (T * (before + x_fast_disturbance));
    state->q = maglev_5dof_precise_limit(x_fast_estimate + (half_T * (x_fast_rate + rate_ahead)),
        parameters->largest_position);
    state->v = maglev_5dof_precise_limit(rate_ahead, parameters->largest_rate);
    state->d = x_fast_disturbance;
    return (maglev_5dof_precise_observer_fast_t){.fast_ahead = state->q, .fast_rate_ahead = state->v};
}

void maglev_5dof_precise_init(maglev_5dof_precise_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (maglev_5dof_precise_state_t){
        .guard_last_y1 = 0.031f,
        .guard_last_y2 = 0.031f,
        .guard_last_y3 = 0.031f,
        .guard_last_y4 = 0.031f,
        .guard_last_y_ref = 0.03095f,
        .guard_left = 20u,
        .x_monitor.doubts = 10u,
        .z_monitor.doubts = 10u,
        .redundancy_code_y1 = 0.0245f,
        .redundancy_code_y2 = 0.0245f,
        .redundancy_code_y3 = 0.0245f,
        .redundancy_code_y4 = 0.0245f,
        .redundancy_threshold_0 = 0.00015517752f,
        .observer_y_fast_q = 0.0245f,
        .servo_y_fast.r = 0.01805f,
        .observer_y_q = 0.0245f,
        .observer_x.g = 1.0f,
        .observer_z.g = 1.0f,
        .landing_left = 20u,
        .probe_x_towards = 2.2f,
        .probe_z_towards = 2.2f,
        .safe_output_last_i_d1 = 2.5f,
        .safe_output_last_i_d2 = 2.5f,
        .safe_output_last_i_d3 = 2.5f,
        .safe_output_last_i_d4 = 2.5f,
    };
}

#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
uint32_t maglev_5dof_precise_step(maglev_5dof_precise_state_t *state, const maglev_5dof_precise_input_t *in,
    maglev_5dof_precise_output_t *out)
{
    return maglev_5dof_precise_step_diagnosed(state, in, out, NULL);
}

uint32_t maglev_5dof_precise_step_diagnosed(maglev_5dof_precise_state_t *state, const maglev_5dof_precise_input_t *in,
    maglev_5dof_precise_output_t *out, maglev_5dof_precise_diagnostics_t *diagnostics)
#else
uint32_t maglev_5dof_precise_step(maglev_5dof_precise_state_t *state, const maglev_5dof_precise_input_t *in,
    maglev_5dof_precise_output_t *out)
#endif
{
    static const uint32_t most_attempts = 8u;                   /* 1; pairs without an answer: the sensor is frozen */
    static const float r = 0.397f;                              /* m; Table I */
    static const uint32_t still_samples = 8u; /* 1; samples without a change of the code: it stands still */
    static const uint32_t good_per_bad = 4u;                    /* 1; good samples that make up for a bad one */
    static const float T = 0.001f;                              /* s; sample period */
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float least_position = 0.0145f;                /* m; bound of the prediction */
    /* rad; a larger error counts as this in the internal models; a larger change of the set-point has no rate; of
     * error, step */
    static const float servo_phi_fast_largest = 1e-04f;
    static const uint32_t first_push_end = 1u;                  /* 1; last sample of the first push of a pair */
    static const uint32_t quiet_samples = 12u;                  /* 1; without a change of the code until it probes */
    static const uint32_t last_push_end = 4u;                   /* 1; last sample of the second push */
    static const uint32_t reverse_push_end = 3u;                /* 1; last sample of the push to the other side */
    static const float current_limit = 4.9497476f;              /* A; largest current of a motor, rms: 7 A peak */
    static const uint32_t pair_samples = 7u;                    /* 1; of a pair with its answer */
    /* m/s^2; acceleration of the first pair, which moves the body by 2.2e-06 m and back in 4 samples */
    static const float first_push = 2.2f;

#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
#endif
    const uint32_t probe_x_attempt = state->probe_x_attempt;
    const bool x_unanswered = most_attempts <= probe_x_attempt;
    const uint32_t probe_z_attempt = state->probe_z_attempt;
    const bool z_unanswered = most_attempts <= probe_z_attempt;

    /* guard: range acceptance, hold, latch
     *     enough = sufficient if ready is set, else complete
     *     final = left <= good_per_bad
     *     latched = 1 if landed, else (guard_latched if enough is set, else (1 if final, else guard_latched))
     *     left_next = (left if latch_samples <= left, else left + 1) if enough is set, else (left if final,
     *         else left - good_per_bad) */
    uint32_t faults = 0u;
    const float y1_accepted = maglev_5dof_precise_hold(in->y1, 0.0168f, 0.0322f, &state->guard_last_y1, 0x00000001u,
        &faults);
    const float y2_accepted = maglev_5dof_precise_hold(in->y2, 0.0124f, 0.0366f, &state->guard_last_y2, 0x00000002u,
        &faults);
    const float y3_accepted = maglev_5dof_precise_hold(in->y3, 0.0168f, 0.0322f, &state->guard_last_y3, 0x00000004u,
        &faults);
    const float y4_accepted = maglev_5dof_precise_hold(in->y4, 0.0124f, 0.0366f, &state->guard_last_y4, 0x00000008u,
        &faults);
    const float x_accepted = maglev_5dof_precise_hold_within(in->x, 0.1f, &state->guard_last_x, 0x00000010u, &faults);
    const float z_accepted = maglev_5dof_precise_hold_within(in->z, 0.1f, &state->guard_last_z, 0x00000020u, &faults);
    const float y_ref_held = maglev_5dof_precise_hold(in->y_ref, 0.01805f, 0.03095f, &state->guard_last_y_ref,
        0x00000040u, &faults);
    const float x_ref_held = maglev_5dof_precise_hold_within(in->x_ref, 0.04995f, &state->guard_last_x_ref, 0x00000080u,
        &faults);
    const float z_ref_held = maglev_5dof_precise_hold_within(in->z_ref, 0.04995f, &state->guard_last_z_ref, 0x00000100u,
        &faults);
    const float phi_ref_held = maglev_5dof_precise_hold_within(in->phi_ref, 0.0028740554f, &state->guard_last_phi_ref,
        0x00000200u, &faults);
    const float theta_ref_held = maglev_5dof_precise_hold_within(in->theta_ref, 0.013874056f,
        &state->guard_last_theta_ref, 0x00000400u, &faults);
    const bool complete = (faults & 0x0000003fu) == 0u;
    const uint32_t guard_latched = state->guard_latched;
    const uint32_t guard_ready = state->guard_ready;
    const bool judging = (guard_ready != 0u) && (guard_latched == 0u);
    if (complete) {
        state->guard_ready = 1u;
    }
    const float missed_calls = in->missed_calls;

    /* redundancy: parity, innovations, frozen codes */
    static const float kept_part = 0.99609375f;                 /* 1; of the threshold, in a sample */
    static const float smooth_squared = 1e-14f; /* m^2; of a change of r: it has no kink where nothing moves */
    static const float learnt_part_0 = 0.017823689f;            /* 1; of the change of r, learnt in a sample */
    static const float quiet_part_0 = 1.875e-07f;               /* m; of the threshold without noise, in a sample */
    static const float largest_0 = 0.00015517752f;              /* m; threshold at the largest noise */
    const float residual_0_without_y4 = y1_accepted - y2_accepted + y3_accepted;
    const float residual_0 = residual_0_without_y4 - y4_accepted;
    const uint32_t redundancy_degraded = state->redundancy_degraded;
    const bool sound = (guard_ready != 0u) && complete && (redundancy_degraded == 0u);
    const float size = fabsf(residual_0);
    const float redundancy_threshold_0 = state->redundancy_threshold_0;
    const bool agreement = size <= redundancy_threshold_0;
    const bool same_y1 = maglev_5dof_precise_equal(y1_accepted, state->redundancy_code_y1);
    uint32_t still_y1 = 0u;
    if (same_y1) {
        const uint32_t redundancy_still_y1 = state->redundancy_still_y1;
        still_y1 = (still_samples <= redundancy_still_y1) ? redundancy_still_y1 : (redundancy_still_y1 + 1u);
    }
    const bool same_y2 = maglev_5dof_precise_equal(y2_accepted, state->redundancy_code_y2);
    uint32_t still_y2 = 0u;
    if (same_y2) {
        const uint32_t redundancy_still_y2 = state->redundancy_still_y2;
        still_y2 = (still_samples <= redundancy_still_y2) ? redundancy_still_y2 : (redundancy_still_y2 + 1u);
    }
    const bool same_y3 = maglev_5dof_precise_equal(y3_accepted, state->redundancy_code_y3);
    uint32_t still_y3 = 0u;
    if (same_y3) {
        const uint32_t redundancy_still_y3 = state->redundancy_still_y3;
        still_y3 = (still_samples <= redundancy_still_y3) ? redundancy_still_y3 : (redundancy_still_y3 + 1u);
    }
    const bool same_y4 = maglev_5dof_precise_equal(y4_accepted, state->redundancy_code_y4);
    uint32_t still_y4 = 0u;
    if (same_y4) {
        const uint32_t redundancy_still_y4 = state->redundancy_still_y4;
        still_y4 = (still_samples <= redundancy_still_y4) ? redundancy_still_y4 : (redundancy_still_y4 + 1u);
    }
    const bool counted = fabsf(missed_calls) <= 0.0f;
    const bool in_time = judging && counted;
    const maglev_5dof_precise_monitor_t x_monitor = maglev_5dof_precise_monitor(&state->x_monitor, state->observer_x.q,
        x_accepted, in_time, guard_ready, x_unanswered, sound, (faults & 0x00000010u) == 0u, counted);
    const maglev_5dof_precise_monitor_t z_monitor = maglev_5dof_precise_monitor(&state->z_monitor, state->observer_z.q,
        z_accepted, in_time, guard_ready, z_unanswered, sound, (faults & 0x00000020u) == 0u, counted);
    const bool lost_x = !x_monitor.trusted;
    const bool lost_z = !z_monitor.trusted;
    const float observer_phi_q = state->observer_phi_q;
    const float observer_y_q = state->observer_y_q;
    const float observer_theta_q = state->observer_theta_q;
    const uint32_t redundancy_excluded_y1 = state->redundancy_excluded_y1;
    const uint32_t redundancy_excluded_y2 = state->redundancy_excluded_y2;
    const uint32_t redundancy_excluded_y3 = state->redundancy_excluded_y3;
    const uint32_t redundancy_excluded_y4 = state->redundancy_excluded_y4;
    const uint32_t redundancy_stuck_0 = state->redundancy_stuck_0;
    const uint32_t redundancy_undecided_0 = state->redundancy_undecided_0;
    const float redundancy_last_residual_0 = state->redundancy_last_residual_0;
    bool gaps_sufficient = true;
    float y1_held = y1_accepted;
    float y2_held = y2_accepted;
    float y3_held = y3_accepted;
    float y4_held = y4_accepted;
    bool regular = true;
    bool theta_measured = true;
    uint32_t redundancy_excluded_y1_next = redundancy_excluded_y1;
    uint32_t redundancy_excluded_y2_next = redundancy_excluded_y2;
    uint32_t redundancy_excluded_y3_next = redundancy_excluded_y3;
    uint32_t redundancy_excluded_y4_next = redundancy_excluded_y4;
    float redundancy_last_residual_0_choice = residual_0;
    float redundancy_threshold_0_next = redundancy_threshold_0;
    uint32_t redundancy_contradictions_0_next = 0u;
    uint32_t redundancy_stuck_0_next = redundancy_stuck_0;
    uint32_t redundancy_undecided_0_next = redundancy_undecided_0;
    uint32_t redundancy_degraded_next = redundancy_degraded;
    if (sound && agreement && x_monitor.usual && z_monitor.usual) {
        const float change = residual_0 - redundancy_last_residual_0;
        redundancy_threshold_0_next = maglev_5dof_precise_min((kept_part * redundancy_threshold_0) +
            (quiet_part_0 + (learnt_part_0 * sqrtf((change * change) + smooth_squared))), largest_0);
    } else {
        /* gap_prediction: gaps of the predicted pose, F(5)
         *     y1_expected = observer_y_q - r * observer_phi_q; likewise y4_expected */
        const float r_phi = r * observer_phi_q;
        const float y1_expected = observer_y_q - r_phi;
        const float r_theta = r * observer_theta_q;
        const float y2_expected = observer_y_q + r_theta;
        const float y3_expected = observer_y_q + r_phi;
        const float y4_expected = observer_y_q - r_theta;

        /* redundancy: parity, innovations, frozen codes (continued)
         *     E_y1 = (1 if 0 < residual_0, else -1) * (y1_accepted - y1_expected); likewise E_y3
         *     E_y2 = (-1 if 0 < residual_0, else 1) * (y2_accepted - y2_expected); likewise E_y4
         *     score_y1 = E_y1 + preference * (candidate_y1 - by_first_rule + preferred_y1); likewise score_y2,
         *         score_y3, score_y4
         *     suspect_x = 0 if sound and |residual_0| <= threshold_0 and x_usual and z_usual, else x_suspect;
         *         likewise suspect_z
         *     gaps_sufficient = 1 if sound and agreement and x_usual and z_usual, else (1 if usable_y1 and
         *         usable_y2 and usable_y3 and usable_y4, else missing <= tolerated_missing)
         *     regular = 1 if sound and agreement and x_usual and z_usual, else z_trusted and (x_trusted and
         *         determined)
         *     degraded = 0 if sound and |residual_0| <= threshold_0 and x_usual and z_usual, else guard_ready
         *     still_y1_next = (still_y1 if still_samples <= still_y1, else still_y1 + 1) if y1_accepted ==
         *         code_y1, else 0; likewise still_y2_next, still_y3_next, still_y4_next
         *     last_residual_0_next = residual_0 if sound and |residual_0| <= threshold_0 and x_usual and z_usual,
         *         else last_residual_0 */
        static const uint32_t repeated_samples = 3u; /* 1; samples without a change of the code: fewer, and it moves */
        /* 1; of |r|: least E by a code that stands still; it had |r| at first, and predictions follow it */
        static const float candidate_part = 0.4f;
        static const uint32_t all_but_one_of_4 = 3u;            /* 1; sensors of a group but one */
        static const float preference = 10.0f; /* m; more than any E: codes decide before innovations */
        /* 1; of |r|: least lead over the next E by codes: more than noise of E */
        static const float lead_by_code = 0.05f;
        /* 1; of |r|: least lead by innovations alone, which predictions that followed an error spoil */
        static const float lead_by_innovation = 0.3f;
        static const float twice_preference = 20.0f;            /* m; more than any score: no sensor is named */
        static const uint32_t undecided_from = 9u;              /* 1; contradictions before all are suspects */
        static const uint32_t tolerated_missing = 2u;           /* 1; readings of a group that may be missing */
        static const float highest_y1_y3 = 0.0322f;             /* m; end of its range */
        static const float lowest_y1_y3 = 0.0168f;              /* m; end of its range */
        static const float highest_y2_y4 = 0.0366f;             /* m; end of its range */
        static const float lowest_y2_y4 = 0.0124f;              /* m; end of its range */
        static const uint32_t excluded_from = 2u;               /* 1; contradictions or jumps before the last */
        static const uint32_t most_contradictions = 10u;        /* 1; contradictions that are counted */
        const bool good_y1 = (faults & 0x00000001u) == 0u;
        const bool usable_y1 = good_y1 && (redundancy_excluded_y1 == 0u);
        const bool good_y2 = (faults & 0x00000002u) == 0u;
        const bool usable_y2 = good_y2 && (redundancy_excluded_y2 == 0u);
        const bool good_y3 = (faults & 0x00000004u) == 0u;
        const bool usable_y3 = good_y3 && (redundancy_excluded_y3 == 0u);
        const bool good_y4 = (faults & 0x00000008u) == 0u;
        const bool usable_y4 = good_y4 && (redundancy_excluded_y4 == 0u);
        bool suspect_y1;
        bool suspect_y2;
        bool suspect_y3;
        bool suspect_y4;
        bool determined;
        if (usable_y1 && usable_y2 && usable_y3 && usable_y4) {
            const bool agreeing = redundancy_undecided_0 == 0u;
            if (agreement || (guard_ready == 0u)) {
                const bool undecided_0_positive = redundancy_undecided_0 != 0u;
                suspect_y1 = undecided_0_positive;
                suspect_y2 = undecided_0_positive;
                suspect_y3 = undecided_0_positive;
                suspect_y4 = undecided_0_positive;
                determined = agreeing;
            } else {
                const bool residual_0_positive = 0.0f < residual_0;
                const float direction_y1_y3 = (residual_0_positive) ? 1.0f : -1.0f;
                const float E_y1 = direction_y1_y3 * (y1_accepted - y1_expected);
                const float direction_y2_y4 = (residual_0_positive) ? -1.0f : 1.0f;
                const float E_y2 = direction_y2_y4 * (y2_accepted - y2_expected);
                const float E_y3 = direction_y1_y3 * (y3_accepted - y3_expected);
                const float E_y4 = direction_y2_y4 * (y4_accepted - y4_expected);
                const bool repeats_y1 = repeated_samples <= still_y1;
                const float least_E = candidate_part * size;
                const bool candidate_y1 = repeats_y1 && (least_E < E_y1);
                const bool repeats_y2 = repeated_samples <= still_y2;
                const bool candidate_y2 = repeats_y2 && (least_E < E_y2);
                const bool repeats_y3 = repeated_samples <= still_y3;
                const bool candidate_y3 = repeats_y3 && (least_E < E_y3);
                const bool repeats_y4 = repeated_samples <= still_y4;
                const bool candidate_y4 = repeats_y4 && (least_E < E_y4);
                const uint32_t candidates = maglev_5dof_precise_flag(candidate_y1) +
                    maglev_5dof_precise_flag(candidate_y2) + maglev_5dof_precise_flag(candidate_y3) +
                    maglev_5dof_precise_flag(candidate_y4);
                const bool by_first_rule = candidates != 0u;
                const uint32_t moving = maglev_5dof_precise_flag(still_y1 < repeated_samples) +
                    maglev_5dof_precise_flag(still_y2 < repeated_samples) + maglev_5dof_precise_flag(still_y3 <
                    repeated_samples) + maglev_5dof_precise_flag(still_y4 < repeated_samples);
                float preferred_y1 = 0.0f;
                float preferred_y2 = 0.0f;
                float preferred_y3 = 0.0f;
                float preferred_y4 = 0.0f;
                uint32_t standing = 0u;
                if (moving == all_but_one_of_4) {
                    const bool stands_y1 = still_samples <= still_y1;
                    const float by_second_rule = 1.0f - (by_first_rule ? 1.0f : 0.0f);
                    preferred_y1 = (stands_y1) ? by_second_rule : 0.0f;
                    const bool stands_y2 = still_samples <= still_y2;
                    preferred_y2 = (stands_y2) ? by_second_rule : 0.0f;
                    const bool stands_y3 = still_samples <= still_y3;
                    preferred_y3 = (stands_y3) ? by_second_rule : 0.0f;
                    const bool stands_y4 = still_samples <= still_y4;
                    preferred_y4 = (stands_y4) ? by_second_rule : 0.0f;
                    standing = maglev_5dof_precise_flag(stands_y1) + maglev_5dof_precise_flag(stands_y2) +
                        maglev_5dof_precise_flag(stands_y3) + maglev_5dof_precise_flag(stands_y4);
                }
                const float score_y1 = E_y1 +
                    (preference * ((candidate_y1 ? 1.0f : 0.0f) - (by_first_rule ? 1.0f : 0.0f) + preferred_y1));
                const float score_y2 = E_y2 +
                    (preference * ((candidate_y2 ? 1.0f : 0.0f) - (by_first_rule ? 1.0f : 0.0f) + preferred_y2));
                const float score_y3 = E_y3 +
                    (preference * ((candidate_y3 ? 1.0f : 0.0f) - (by_first_rule ? 1.0f : 0.0f) + preferred_y3));
                const float score_y4 = E_y4 +
                    (preference * ((candidate_y4 ? 1.0f : 0.0f) - (by_first_rule ? 1.0f : 0.0f) + preferred_y4));
                const bool by_code = (candidates + standing) != 0u;
                const float best_y1 = maglev_5dof_precise_max(-preference, score_y1);
                const float best_y2 = maglev_5dof_precise_max(best_y1, score_y2);
                const float best_y3 = maglev_5dof_precise_max(best_y2, score_y3);
                const float best = maglev_5dof_precise_max(best_y3, score_y4);
                const float second_y3 = maglev_5dof_precise_max(maglev_5dof_precise_max(-preference,
                    maglev_5dof_precise_min(best_y1, score_y2)), maglev_5dof_precise_min(best_y2, score_y3));
                const float least = (((((by_code) ? lead_by_code : lead_by_innovation) * size) <
                    (best - maglev_5dof_precise_max(second_y3, maglev_5dof_precise_min(best_y3, score_y4)))) &&
                    (by_code || agreeing)) ? best : twice_preference;
                const bool isolated_y1 = least <= score_y1;
                const uint32_t redundancy_contradictions_0 = state->redundancy_contradictions_0;
                const uint32_t waited = (undecided_from <= redundancy_contradictions_0) ? 1u : redundancy_undecided_0;
                suspect_y1 = (maglev_5dof_precise_flag(isolated_y1) + waited) != 0u;
                const bool isolated_y2 = least <= score_y2;
                suspect_y2 = (maglev_5dof_precise_flag(isolated_y2) + waited) != 0u;
                const bool isolated_y3 = least <= score_y3;
                suspect_y3 = (maglev_5dof_precise_flag(isolated_y3) + waited) != 0u;
                const bool isolated_y4 = least <= score_y4;
                suspect_y4 = (maglev_5dof_precise_flag(isolated_y4) + waited) != 0u;
                y1_held = maglev_5dof_precise_max(maglev_5dof_precise_min(y1_accepted -
                    ((isolated_y1) ? residual_0 : 0.0f), highest_y1_y3), lowest_y1_y3);
                y2_held = maglev_5dof_precise_max(maglev_5dof_precise_min(y2_accepted +
                    ((isolated_y2) ? residual_0 : 0.0f), highest_y2_y4), lowest_y2_y4);
                y3_held = maglev_5dof_precise_max(maglev_5dof_precise_min(y3_accepted -
                    ((isolated_y3) ? residual_0 : 0.0f), highest_y1_y3), lowest_y1_y3);
                y4_held = maglev_5dof_precise_max(maglev_5dof_precise_min(y4_accepted +
                    ((isolated_y4) ? residual_0 : 0.0f), highest_y2_y4), lowest_y2_y4);
                bool left_out_now_y1 = isolated_y1;
                bool left_out_now_y2 = isolated_y2;
                bool left_out_now_y3 = isolated_y3;
                bool left_out_now_y4 = isolated_y4;
                if (redundancy_contradictions_0 < excluded_from) {
                    left_out_now_y1 = false;
                    left_out_now_y2 = false;
                    left_out_now_y3 = false;
                    left_out_now_y4 = false;
                }
                redundancy_excluded_y1_next = maglev_5dof_precise_flag(left_out_now_y1);
                redundancy_excluded_y2_next = maglev_5dof_precise_flag(left_out_now_y2);
                redundancy_excluded_y3_next = maglev_5dof_precise_flag(left_out_now_y3);
                redundancy_excluded_y4_next = maglev_5dof_precise_flag(left_out_now_y4);
                const uint32_t redundancy_stuck_0_sum = maglev_5dof_precise_flag(repeats_y1 && left_out_now_y1) +
                    maglev_5dof_precise_flag(repeats_y2 && left_out_now_y2) + maglev_5dof_precise_flag(repeats_y3 &&
                    left_out_now_y3) + maglev_5dof_precise_flag(repeats_y4 && left_out_now_y4) + redundancy_stuck_0;
                redundancy_stuck_0_next = maglev_5dof_precise_flag(redundancy_stuck_0_sum != 0u);
                determined = waited == 0u;
                redundancy_contradictions_0_next = (most_contradictions <= redundancy_contradictions_0) ?
                    redundancy_contradictions_0 : (redundancy_contradictions_0 + 1u);
                redundancy_undecided_0_next = waited;
            }
        } else {
            const bool readmitted_y1 = (redundancy_stuck_0 != 0u) && (redundancy_excluded_y1 != 0u) && !same_y1 &&
                good_y1;
            const bool readmitted_y2 = (redundancy_stuck_0 != 0u) && (redundancy_excluded_y2 != 0u) && !same_y2 &&
                good_y2;
            const bool readmitted_y3 = (redundancy_stuck_0 != 0u) && (redundancy_excluded_y3 != 0u) && !same_y3 &&
                good_y3;
            const bool readmitted_y4 = (redundancy_stuck_0 != 0u) && (redundancy_excluded_y4 != 0u) && !same_y4 &&
                good_y4;
            const uint32_t doubted = (readmitted_y1 || readmitted_y2 || readmitted_y3 || readmitted_y4) ? 1u :
                redundancy_undecided_0;
            suspect_y1 = (redundancy_excluded_y1 + doubted) != 0u;
            suspect_y2 = (redundancy_excluded_y2 + doubted) != 0u;
            suspect_y3 = (redundancy_excluded_y3 + doubted) != 0u;
            suspect_y4 = (redundancy_excluded_y4 + doubted) != 0u;
            const uint32_t missing = maglev_5dof_precise_flag((usable_y1) ? false : true) +
                maglev_5dof_precise_flag((usable_y2) ? false : true) + maglev_5dof_precise_flag((usable_y3) ? false :
                true) + maglev_5dof_precise_flag((usable_y4) ? false : true);
            gaps_sufficient = missing <= tolerated_missing;
            const bool missing_at_most_1 = missing <= 1u;
            float predicted_y1 = y1_expected;
            float predicted_y2 = y2_expected;
            float predicted_y3 = y3_expected;
            float predicted_y4 = residual_0_without_y4;
            if (missing_at_most_1) {
                predicted_y1 = y1_accepted - residual_0;
                predicted_y2 = y2_accepted + residual_0;
                predicted_y3 = y3_accepted - residual_0;
            } else {
                predicted_y4 = y4_expected;
            }
            y1_held = maglev_5dof_precise_max(maglev_5dof_precise_min((usable_y1) ? y1_accepted : predicted_y1,
                highest_y1_y3), lowest_y1_y3);
            y2_held = maglev_5dof_precise_max(maglev_5dof_precise_min((usable_y2) ? y2_accepted : predicted_y2,
                highest_y2_y4), lowest_y2_y4);
            y3_held = maglev_5dof_precise_max(maglev_5dof_precise_min((usable_y3) ? y3_accepted : predicted_y3,
                highest_y1_y3), lowest_y1_y3);
            y4_held = maglev_5dof_precise_max(maglev_5dof_precise_min((usable_y4) ? y4_accepted : predicted_y4,
                highest_y2_y4), lowest_y2_y4);
            determined = missing_at_most_1 && (doubted == 0u);
            redundancy_excluded_y1_next = maglev_5dof_precise_flag((redundancy_excluded_y1 != 0u) && !readmitted_y1);
            redundancy_excluded_y2_next = maglev_5dof_precise_flag((redundancy_excluded_y2 != 0u) && !readmitted_y2);
            redundancy_excluded_y3_next = maglev_5dof_precise_flag((redundancy_excluded_y3 != 0u) && !readmitted_y3);
            redundancy_excluded_y4_next = maglev_5dof_precise_flag((redundancy_excluded_y4 != 0u) && !readmitted_y4);
            redundancy_undecided_0_next = doubted;
        }
        regular = z_monitor.trusted && x_monitor.trusted && determined;
        theta_measured = determined;
        redundancy_degraded_next = ((z_monitor.suspect != 0u) || (x_monitor.suspect != 0u) || suspect_y4 ||
            suspect_y3 || suspect_y2 || suspect_y1) ? 1u : redundancy_degraded;
        redundancy_last_residual_0_choice = redundancy_last_residual_0;

        /* guard: range acceptance, hold, latch (continued) */
        if (suspect_y1) {
            faults |= 0x00000800u;
        }
        if (suspect_y2) {
            faults |= 0x00001000u;
        }
        if (suspect_y3) {
            faults |= 0x00002000u;
        }
        if (suspect_y4) {
            faults |= 0x00004000u;
        }
        if (x_monitor.suspect != 0u) {
            faults |= 0x00008000u;
        }
        if (z_monitor.suspect != 0u) {
            faults |= 0x00010000u;
        }
        if (guard_ready != 0u) {
            faults |= 0x00020000u;
        }
#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
        if (diagnostics != NULL) {
            diagnostics->x_suspect = (float)x_monitor.suspect;
            diagnostics->z_suspect = (float)z_monitor.suspect;
            diagnostics->y1_expected = y1_expected;
            diagnostics->y2_expected = y2_expected;
            diagnostics->y3_expected = y3_expected;
            diagnostics->y4_expected = y4_expected;
            diagnostics->suspect_y1 = suspect_y1 ? 1.0f : 0.0f;
            diagnostics->suspect_y2 = suspect_y2 ? 1.0f : 0.0f;
            diagnostics->suspect_y3 = suspect_y3 ? 1.0f : 0.0f;
            diagnostics->suspect_y4 = suspect_y4 ? 1.0f : 0.0f;
        }
#endif
    }

    /* landing: ramps and state feedback
     * No integrator takes part, so nothing winds up: the disturbance of the observer does its work. */
    static const float landed_at = 0.0314f; /* m; end of the ramp, behind the stop: landed, wherever the body is */
    static const float pole_theta = 40.0f;                      /* 1/s; levelling by measurements */
    static const float predicted_pole_theta = 14.0f;            /* 1/s; levelling by predictions */
    const float landing_r_y = state->landing_r_y;
    const uint32_t landing_landing = state->landing_landing;
    const bool landed = (landing_landing != 0u) && (landed_at <= landing_r_y);
    const float levelling_pole_w_theta = (theta_measured) ? pole_theta : predicted_pole_theta;

    /* kinematics: pose from the gaps, F(5)
     *     y = 0.25 * (y1_held + y2_held + y3_held + y4_held)
     *     phi = asin(1.25945 * (y3_held - y1_held))
     *     theta = asin(1.25945 * (y2_held - y4_held)) */
    const float y = 0.25f * (y1_held + y2_held + y3_held + y4_held);
    const float y2_minus_y4 = y2_held - y4_held;
    const float theta = y2_minus_y4 * phi_polynomial(y2_minus_y4 * y2_minus_y4);
    const float y3_minus_y1 = y3_held - y1_held;
    const float phi = y3_minus_y1 * phi_polynomial(y3_minus_y1 * y3_minus_y1);

    /* observer_y_fast: predictive observer, alpha-beta-gamma */
    static const float observer_y_fast_largest_disturbance = 50.0f; /* m/s^2; bound of the disturbance */
    static const float observer_phi_fast_largest_disturbance = 200.0f; /* rad/s^2; bound of the disturbance */
    static const float observer_y_fast_gamma = 35832.543f;      /* 1/s^2; triple pole exp(-w T), w = 400 rad/s */
    static const float observer_phi_fast_gamma = 35832.543f;    /* 1/s^2; triple pole exp(-w T), w = 400 rad/s */
    const float observer_y_fast_q = state->observer_y_fast_q;
    const float nu = y - observer_y_fast_q;
    const float y_fast_disturbance_if_ready = maglev_5dof_precise_limit(state->observer_y_fast_d +
        (observer_y_fast_gamma * nu), observer_y_fast_largest_disturbance);
    const float nu_2 = phi - state->observer_phi_fast.q;
    const float phi_fast_ahead_limited = maglev_5dof_precise_limit(state->observer_phi_fast.d +
        (observer_phi_fast_gamma * nu_2), observer_phi_fast_largest_disturbance);
    bool enough = complete;
    float y_fast_estimate = y;
    float y_fast_rate = 0.0f;
    float y_fast_disturbance = y_fast_disturbance_if_ready;
    float w_phi_tracking_choice = 0.0f;
    float theta_disturbance = 0.0f;
    float theta_estimate = theta;
    float theta_rate = 0.0f;
    float damping_theta = 0.0f;
    float y_disturbance = 0.0f;
    float y_estimate = y;
    float y_rate = 0.0f;
    float phi_estimate = phi;
    float phi_rate = 0.0f;
    float phi_disturbance = 0.0f;
    if (guard_ready != 0u) {
        /* sufficiency: it can land, is probed
         *     sufficient = gaps_sufficient and (x_trusted or z_trusted) */
        static const float cancelled = 0.8f;                    /* 1; part of the disturbance that is cancelled */
        static const float observer_y_fast_alpha = 0.6988058f;  /* 1; triple pole exp(-w T), w = 400 rad/s */
        static const float observer_y_fast_beta = 272.3178f;    /* 1/s; triple pole exp(-w T), w = 400 rad/s */
        const bool sufficient = gaps_sufficient && (x_monitor.trusted || z_monitor.trusted);
        enough = sufficient;
        y_fast_estimate = observer_y_fast_q + (observer_y_fast_alpha * nu);
        y_fast_rate = state->observer_y_fast_v + (observer_y_fast_beta * nu);
        w_phi_tracking_choice = cancelled * phi_fast_ahead_limited;

        /* observer_theta: predictive observer, alpha-beta-gamma
         *     as observer_phi, with theta in place of phi */
        static const float observer_theta_largest_disturbance = 200.0f; /* rad/s^2; bound of the disturbance */
        static const float observer_theta_alpha = 0.30232367f;  /* 1; triple pole exp(-w T), w = 120 rad/s */
        static const float observer_theta_beta = 36.192043f;    /* 1/s; triple pole exp(-w T), w = 120 rad/s */
        static const float observer_theta_gamma = 1445.947f;    /* 1/s^2; triple pole exp(-w T), w = 120 rad/s */
        const float nu_3 = theta - observer_theta_q;
        theta_disturbance = maglev_5dof_precise_limit(state->observer_theta_d + (observer_theta_gamma * nu_3),
            observer_theta_largest_disturbance);
        theta_estimate = observer_theta_q + (observer_theta_alpha * nu_3);
        const float theta_rate_if_ready = state->observer_theta_v + (observer_theta_beta * nu_3);
        theta_rate = theta_rate_if_ready;
        damping_theta = 2.0f * (levelling_pole_w_theta * theta_rate_if_ready);

        /* observer_y: predictive observer, alpha-beta-gamma
         *     nu = y - q
         *     rate_ahead = y_rate + T * (delay_w_y_last + y_disturbance)
         *     y_disturbance = limit(d + gamma * nu, largest_disturbance) if guard_ready is set, else 0
         *     y_estimate = q + alpha * nu if guard_ready is set, else y
         *     y_rate = v + beta * nu if guard_ready is set, else 0
         *     q_next = max(min(y_estimate + half_T * (y_rate + rate_ahead), largest_position), least_position)
         *     v_next = limit(rate_ahead, largest_rate) */
        static const float observer_y_largest_disturbance = 50.0f; /* m/s^2; bound of the disturbance */
        static const float observer_y_alpha = 0.30232367f;      /* 1; triple pole exp(-w T), w = 120 rad/s */
        static const float observer_y_beta = 36.192043f;        /* 1/s; triple pole exp(-w T), w = 120 rad/s */
        static const float observer_y_gamma = 1445.947f;        /* 1/s^2; triple pole exp(-w T), w = 120 rad/s */
        const float nu_4 = y - observer_y_q;
        y_disturbance = maglev_5dof_precise_limit(state->observer_y_d + (observer_y_gamma * nu_4),
            observer_y_largest_disturbance);
        y_estimate = observer_y_q + (observer_y_alpha * nu_4);
        y_rate = state->observer_y_v + (observer_y_beta * nu_4);

        /* observer_phi: predictive observer, alpha-beta-gamma
         *     nu = phi - q
         *     rate_ahead = phi_rate + T * (delay_w_phi_last + phi_disturbance)
         *     phi_estimate = q + alpha * nu if guard_ready is set, else phi
         *     phi_rate = v + beta * nu if guard_ready is set, else 0
         *     phi_disturbance = limit(d + gamma * nu, largest_disturbance) if guard_ready is set, else 0
         *     q_next = limit(phi_estimate + half_T * (phi_rate + rate_ahead), largest_position)
         *     v_next = limit(rate_ahead, largest_rate) */
        static const float observer_phi_largest_disturbance = 200.0f; /* rad/s^2; bound of the disturbance */
        static const float observer_phi_alpha = 0.30232367f;    /* 1; triple pole exp(-w T), w = 120 rad/s */
        static const float observer_phi_beta = 36.192043f;      /* 1/s; triple pole exp(-w T), w = 120 rad/s */
        static const float observer_phi_gamma = 1445.947f;      /* 1/s^2; triple pole exp(-w T), w = 120 rad/s */
        const float nu_5 = phi - observer_phi_q;
        phi_estimate = observer_phi_q + (observer_phi_alpha * nu_5);
        phi_rate = state->observer_phi_v + (observer_phi_beta * nu_5);
        phi_disturbance = maglev_5dof_precise_limit(state->observer_phi_d + (observer_phi_gamma * nu_5),
            observer_phi_largest_disturbance);
#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
        if (diagnostics != NULL) {
            diagnostics->sufficient = sufficient ? 1.0f : 0.0f;
        }
#endif
    } else {
        y_fast_disturbance = 0.0f;
    }

    /* guard: range acceptance, hold, latch (continued) */
    static const uint32_t latch_samples = 20u;                  /* 1; bad samples in a row until it latches, times 4 */
    const uint32_t guard_left = state->guard_left;
    uint32_t gave_up = guard_latched;
    if (enough) {
        if (guard_left < latch_samples) {
            state->guard_left = guard_left + 1u;
        }
    } else if (guard_left <= good_per_bad) {
        gave_up = 1u;
    } else {
        state->guard_left = guard_left - good_per_bad;
    }
    const uint32_t latched = (landed) ? 1u : gave_up;
    const uint32_t faults_before = ((0.0f <= missed_calls) && (missed_calls <= 40.0f)) ? faults :
        (faults | 0x00040000u);

    /* angles: positions for the commutation
     *     x_commutation = not_known if latched and not x_trusted, else x_held; likewise z_commutation */
    static const float rests_beyond = 0.0305f; /* m; beyond it, once landed, the body lies on the stop */
    static const float not_known = 0.2f;                        /* m; outside the range of x and z: it is lost */
    const float x_commutation = ((latched != 0u) && lost_x) ? not_known : x_monitor.held;
    out->x_commutation = x_commutation;
    const float z_commutation = ((latched != 0u) && lost_z) ? not_known : z_monitor.held;
    out->z_commutation = z_commutation;
    uint32_t fault_word;
    if (latched != 0u) {
        state->guard_latched = 1u;
        const bool rests = landed && (rests_beyond <= y);
        fault_word = faults_before | 0x80000000u;

        /* safe_output: slew to the safe output once latched */
        static const float safe_i_d = 2.5f;                     /* A; safe output */
        static const float slew_step = 0.1f;                    /* A; 100 A/s times 0.001 s */
        const float target_i_d = (rests) ? 0.0f : safe_i_d;
        state->safe_output_last_i_d1 = maglev_5dof_precise_slew(state->safe_output_last_i_d1, target_i_d, slew_step);
        out->i_d1 = state->safe_output_last_i_d1;
        state->safe_output_last_i_d2 = maglev_5dof_precise_slew(state->safe_output_last_i_d2, target_i_d, slew_step);
        out->i_d2 = state->safe_output_last_i_d2;
        state->safe_output_last_i_d3 = maglev_5dof_precise_slew(state->safe_output_last_i_d3, target_i_d, slew_step);
        out->i_d3 = state->safe_output_last_i_d3;
        state->safe_output_last_i_d4 = maglev_5dof_precise_slew(state->safe_output_last_i_d4, target_i_d, slew_step);
        out->i_d4 = state->safe_output_last_i_d4;
        state->safe_output_last_u_x = maglev_5dof_precise_slew(state->safe_output_last_u_x, 0.0f, slew_step);
        state->safe_output_last_u_z = maglev_5dof_precise_slew(state->safe_output_last_u_z, 0.0f, slew_step);
        out->i_q2 = state->safe_output_last_u_x;
        out->i_q4 = state->safe_output_last_u_x;
        out->i_q1 = state->safe_output_last_u_z;
        out->i_q3 = state->safe_output_last_u_z;
#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
        if (diagnostics != NULL) {
            diagnostics->rests = rests ? 1.0f : 0.0f;
        }
#endif
    } else {
        /* next states of the sections above */
        static const float lifted = 0.0305f;                    /* m; at a larger gap a stop may hold the platen */
        state->observer_y_fast_d = y_fast_disturbance;
        state->redundancy_code_y1 = y1_accepted;
        state->redundancy_still_y1 = still_y1;
        state->redundancy_excluded_y1 = redundancy_excluded_y1_next;
        state->redundancy_code_y2 = y2_accepted;
        state->redundancy_still_y2 = still_y2;
        state->redundancy_excluded_y2 = redundancy_excluded_y2_next;
        state->redundancy_code_y3 = y3_accepted;
        state->redundancy_still_y3 = still_y3;
        state->redundancy_excluded_y3 = redundancy_excluded_y3_next;
        state->redundancy_code_y4 = y4_accepted;
        state->redundancy_still_y4 = still_y4;
        state->redundancy_excluded_y4 = redundancy_excluded_y4_next;
        state->redundancy_last_residual_0 = redundancy_last_residual_0_choice;
        state->redundancy_threshold_0 = redundancy_threshold_0_next;
        state->redundancy_contradictions_0 = redundancy_contradictions_0_next;
        state->redundancy_stuck_0 = redundancy_stuck_0_next;
        state->redundancy_undecided_0 = redundancy_undecided_0_next;
        state->redundancy_degraded = redundancy_degraded_next;
        state->observer_y_d = y_disturbance;
        state->observer_phi_d = phi_disturbance;
        state->observer_theta_d = theta_disturbance;
        const bool free = regular && (observer_y_q < lifted);

        /* errors: tracking errors, F(14)
         *     e_y = y - y_ref_held; likewise e_phi, e_theta
         *     e_x = x_held - x_ref_held; likewise e_z */
        const float e_y = y - y_ref_held;
        const float e_x = x_monitor.held - x_ref_held;
        const float e_z = z_monitor.held - z_ref_held;
        const float e_phi = phi - phi_ref_held;
        const float e_theta = theta - theta_ref_held;

        /* delay: delay of one sample
         *     w_y_last_next = w_y; likewise w_phi_last_next, w_theta_last_next
         *     a_x_last_next = a_x; likewise a_z_last_next */
        static const maglev_5dof_precise_observer_fast_parameters_t observer_phi_fast_observer_fast =
            {.alpha = 0.6988058f, .beta = 272.3178f, .low = -0.02f, .largest_position = 0.02f, .low_2 = -4.0f,
            .largest_rate = 4.0f};
        const float delay_w_phi_last = state->delay_w_phi_last;
        const maglev_5dof_precise_observer_fast_t observer_phi_fast =
            maglev_5dof_precise_observer_fast(&state->observer_phi_fast, &observer_phi_fast_observer_fast, guard_ready,
            nu_2, phi, phi_fast_ahead_limited, delay_w_phi_last);

        /* observer_phi: predictive observer, alpha-beta-gamma (continued) */
        static const float observer_phi_largest_position = 0.02f; /* rad; bound of the prediction */
        static const float observer_phi_largest_rate = 4.0f;    /* rad/s; bound of the predicted rate */
        const float rate_ahead = phi_rate + (T * (delay_w_phi_last + phi_disturbance));
        state->observer_phi_q = maglev_5dof_precise_limit(phi_estimate + (half_T * (phi_rate + rate_ahead)),
            observer_phi_largest_position);
        state->observer_phi_v = maglev_5dof_precise_limit(rate_ahead, observer_phi_largest_rate);
        const float delay_w_theta_last = state->delay_w_theta_last;

        /* observer_theta: predictive observer, alpha-beta-gamma (continued) */
        static const float observer_theta_largest_position = 0.031f; /* rad; bound of the prediction */
        static const float observer_theta_largest_rate = 4.0f;  /* rad/s; bound of the predicted rate */
        const float rate_ahead_2 = theta_rate + (T * (delay_w_theta_last + theta_disturbance));
        state->observer_theta_q = maglev_5dof_precise_limit(theta_estimate + (half_T * (theta_rate + rate_ahead_2)),
            observer_theta_largest_position);
        state->observer_theta_v = maglev_5dof_precise_limit(rate_ahead_2, observer_theta_largest_rate);
        const float delay_w_y_last = state->delay_w_y_last;

        /* observer_y: predictive observer, alpha-beta-gamma (continued) */
        static const float observer_y_largest_position = 0.0345f; /* m; bound of the prediction */
        static const float observer_y_largest_rate = 4.0f;      /* m/s; bound of the predicted rate */
        const float rate_ahead_3 = y_rate + (T * (delay_w_y_last + y_disturbance));
        state->observer_y_q = maglev_5dof_precise_max(maglev_5dof_precise_min(y_estimate +
            (half_T * (y_rate + rate_ahead_3)), observer_y_largest_position), least_position);
        state->observer_y_v = maglev_5dof_precise_limit(rate_ahead_3, observer_y_largest_rate);

        /* observer_y_fast: predictive observer, alpha-beta-gamma (continued)
         *     nu = y - q
         *     rate_ahead = y_fast_rate + T * (delay_w_y_last + y_fast_disturbance)
         *     y_fast_estimate = q + alpha * nu if guard_ready is set, else y
         *     y_fast_rate = v + beta * nu if guard_ready is set, else 0
         *     y_fast_disturbance = limit(d + gamma * nu, largest_disturbance) if guard_ready is set, else 0
         *     y_fast_ahead = max(min(y_fast_estimate + half_T * (y_fast_rate + rate_ahead), largest_position),
         *         least_position)
         *     y_fast_rate_ahead = limit(rate_ahead, largest_rate) */
        static const float observer_y_fast_largest_position = 0.0345f; /* m; bound of the prediction */
        static const float observer_y_fast_largest_rate = 4.0f; /* m/s; bound of the predicted rate */
        const float rate_ahead_4 = y_fast_rate + (T * (delay_w_y_last + y_fast_disturbance));
        const float y_fast_ahead = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_estimate +
            (half_T * (y_fast_rate + rate_ahead_4)), observer_y_fast_largest_position), least_position);
        const float y_fast_rate_ahead = maglev_5dof_precise_limit(rate_ahead_4, observer_y_fast_largest_rate);
        state->observer_y_fast_q = y_fast_ahead;
        state->observer_y_fast_v = y_fast_rate_ahead;

        /* functions above: servo_fast, observer_fast, observer */
        static const float observer_x_fast_largest_disturbance = 20.0f; /* m/s^2; bound of the disturbance */
        static const float observer_z_fast_largest_disturbance = 20.0f; /* m/s^2; bound of the disturbance */
        static const float observer_theta_fast_largest_disturbance = 200.0f; /* rad/s^2; bound of the disturbance */
        static const float observer_x_fast_gamma = 35832.543f;  /* 1/s^2; triple pole exp(-w T), w = 400 rad/s */
        static const float observer_z_fast_gamma = 35832.543f;  /* 1/s^2; triple pole exp(-w T), w = 400 rad/s */
        static const float observer_theta_fast_gamma = 10823.077f; /* 1/s^2; triple pole exp(-w T), w = 250 rad/s */
        static const maglev_5dof_precise_servo_fast_parameters_t servo_y_fast_servo_fast = {.k_e = -2907.9292f,
            .k_de = -125.761116f, .largest_step = 1e-04f, .k_step = -125761.12f, .k_sum = -6.0f, .k_p1 = -179.71599f,
            .k_q1 = -7.957013f, .k_p2 = -34.303856f, .k_q2 = -7.9948697f, .k_p3 = -91.02718f, .k_q3 = -7.904653f,
            .low = -0.0003f, .largest_error = 0.0003f};
        static const maglev_5dof_precise_servo_fast_parameters_t servo_x_fast_servo_fast = {.k_e = -1047.3546f,
            .k_de = -53.8025f, .largest_step = 0.0003f, .k_step = -53802.504f, .k_sum = -1.5811388f, .k_p1 = 15.710307f,
            .k_q1 = -2.528555f, .k_p2 = 37.087173f, .k_q2 = -2.503874f, .k_p3 = 17.101591f, .k_q3 = -2.5164502f,
            .low = -0.001f, .largest_error = 0.001f};
        static const maglev_5dof_precise_servo_fast_parameters_t servo_z_fast_servo_fast = {.k_e = -1047.3546f,
            .k_de = -53.8025f, .largest_step = 0.0003f, .k_step = -53802.504f, .k_sum = -1.5811388f, .k_p1 = 15.710307f,
            .k_q1 = -2.528555f, .k_p2 = 37.087173f, .k_q2 = -2.503874f, .k_p3 = 17.101591f, .k_q3 = -2.5164502f,
            .low = -0.001f, .largest_error = 0.001f};
        static const maglev_5dof_precise_servo_fast_parameters_t servo_theta_fast_servo_fast = {.k_e = -1835.2612f,
            .k_de = -93.11564f, .largest_step = 1e-04f, .k_step = -93115.64f, .k_sum = -3.2863352f, .k_p1 = -35.450283f,
            .k_q1 = -4.378972f, .k_p2 = 45.209007f, .k_q2 = -4.3589425f, .k_p3 = 19.147825f, .k_q3 = -4.3713517f,
            .low = -0.0003f, .largest_error = 0.0003f};
        static const maglev_5dof_precise_observer_fast_parameters_t observer_x_fast_observer_fast =
            {.alpha = 0.6988058f, .beta = 272.3178f, .low = -0.1f, .largest_position = 0.1f, .low_2 = -2.0f,
            .largest_rate = 2.0f};
        static const maglev_5dof_precise_observer_fast_parameters_t observer_z_fast_observer_fast =
            {.alpha = 0.6988058f, .beta = 272.3178f, .low = -0.1f, .largest_position = 0.1f, .low_2 = -2.0f,
            .largest_rate = 2.0f};
        static const maglev_5dof_precise_observer_fast_parameters_t observer_theta_fast_observer_fast =
            {.alpha = 0.5276334f, .beta = 130.55266f, .low = -0.031f, .largest_position = 0.031f, .low_2 = -4.0f,
            .largest_rate = 4.0f};
        const float w_y_tracking = maglev_5dof_precise_servo_fast(&state->servo_y_fast, &servo_y_fast_servo_fast,
            y_fast_ahead, y_ref_held, y_fast_rate_ahead, guard_ready, y_fast_disturbance_if_ready, e_y);
        const float nu_6 = x_monitor.held - state->observer_x_fast.q;
        const float x_fast_ahead_limited = maglev_5dof_precise_limit(state->observer_x_fast.d +
            (observer_x_fast_gamma * nu_6), observer_x_fast_largest_disturbance);
        const float delay_a_x_last = state->delay_a_x_last;
        const maglev_5dof_precise_observer_fast_t observer_x_fast =
            maglev_5dof_precise_observer_fast(&state->observer_x_fast, &observer_x_fast_observer_fast, guard_ready,
            nu_6, x_monitor.held, x_fast_ahead_limited, delay_a_x_last);
        const float w_x_tracking = maglev_5dof_precise_servo_fast(&state->servo_x_fast, &servo_x_fast_servo_fast,
            observer_x_fast.fast_ahead, x_ref_held, observer_x_fast.fast_rate_ahead, guard_ready, x_fast_ahead_limited,
            e_x);
        const float nu_7 = z_monitor.held - state->observer_z_fast.q;
        const float z_fast_ahead_limited = maglev_5dof_precise_limit(state->observer_z_fast.d +
            (observer_z_fast_gamma * nu_7), observer_z_fast_largest_disturbance);
        const float delay_a_z_last = state->delay_a_z_last;
        const maglev_5dof_precise_observer_fast_t observer_z_fast =
            maglev_5dof_precise_observer_fast(&state->observer_z_fast, &observer_z_fast_observer_fast, guard_ready,
            nu_7, z_monitor.held, z_fast_ahead_limited, delay_a_z_last);
        const float w_z_tracking = maglev_5dof_precise_servo_fast(&state->servo_z_fast, &servo_z_fast_servo_fast,
            observer_z_fast.fast_ahead, z_ref_held, observer_z_fast.fast_rate_ahead, guard_ready, z_fast_ahead_limited,
            e_z);
        const float nu_8 = theta - state->observer_theta_fast.q;
        const float theta_fast_ahead_limited = maglev_5dof_precise_limit(state->observer_theta_fast.d +
            (observer_theta_fast_gamma * nu_8), observer_theta_fast_largest_disturbance);
        const maglev_5dof_precise_observer_fast_t observer_theta_fast =
            maglev_5dof_precise_observer_fast(&state->observer_theta_fast, &observer_theta_fast_observer_fast,
            guard_ready, nu_8, theta, theta_fast_ahead_limited, delay_w_theta_last);
        const float w_theta_tracking = maglev_5dof_precise_servo_fast(&state->servo_theta_fast,
            &servo_theta_fast_servo_fast, observer_theta_fast.fast_ahead, theta_ref_held,
            observer_theta_fast.fast_rate_ahead, guard_ready, theta_fast_ahead_limited, e_theta);
        state->x_monitor.code = x_accepted;
        state->x_monitor.still = x_monitor.unchanged;
        state->x_monitor.excluded = x_monitor.excluded_next;
        state->x_monitor.doubts = x_monitor.doubts_next;
        state->x_monitor.before = x_monitor.before_next;
        state->x_monitor.jumps = x_monitor.jumps_next;
        const maglev_5dof_precise_observer_t observer_x = maglev_5dof_precise_observer(&state->observer_x, guard_ready,
            x_monitor.trusted, x_monitor.held, x_monitor.diverges, x_monitor.frozen, delay_a_x_last,
            x_monitor.unchanged);
        state->z_monitor.code = z_accepted;
        state->z_monitor.still = z_monitor.unchanged;
        state->z_monitor.excluded = z_monitor.excluded_next;
        state->z_monitor.doubts = z_monitor.doubts_next;
        state->z_monitor.before = z_monitor.before_next;
        state->z_monitor.jumps = z_monitor.jumps_next;
        const maglev_5dof_precise_observer_t observer_z = maglev_5dof_precise_observer(&state->observer_z, guard_ready,
            z_monitor.trusted, z_monitor.held, z_monitor.diverges, z_monitor.frozen, delay_a_z_last,
            z_monitor.unchanged);

        /* servo_phi_fast: predictive servo with internal models
         *     e = limit(e_phi, largest)
         *     inside = (sum + e)^2 + (p1 + c1 * q1)^2 + (q1 - (p1 + c1 * q1) + e)^2 <= 16
         *     sum_next = sum + e if inside, else sum
         *     p1_next = p1 + c1 * q1 if inside, else p1
         *     q1_next = q1 - (p1 + c1 * q1) + e if inside, else q1 */
        /* 1; predictive servo with internal models: 2 - 2 cos(w T), w T = 0.00471239 */
        static const float servo_phi_fast_c1 = 2.2206568e-05f;
        const float e = maglev_5dof_precise_limit(e_phi, servo_phi_fast_largest);
        const float servo_phi_fast_sum = state->servo_phi_fast_sum;
        const float servo_phi_fast_sum_next = servo_phi_fast_sum + e;
        const float servo_phi_fast_q1 = state->servo_phi_fast_q1;
        const float servo_phi_fast_p1 = state->servo_phi_fast_p1;
        const float servo_phi_fast_p1_next = servo_phi_fast_p1 + (servo_phi_fast_c1 * servo_phi_fast_q1);
        const float servo_phi_fast_q1_next = servo_phi_fast_q1 - servo_phi_fast_p1_next + e;
        const float servo_phi_fast_sum_sum = (servo_phi_fast_sum_next * servo_phi_fast_sum_next) +
            (servo_phi_fast_p1_next * servo_phi_fast_p1_next) + (servo_phi_fast_q1_next * servo_phi_fast_q1_next);
        if (servo_phi_fast_sum_sum <= 16.0f) {
            /*@ admit -4.0000005f <= servo_phi_fast_sum_next <= 4.0000005f; */
            /*@ admit -4.0000005f <= servo_phi_fast_p1_next <= 4.0000005f; */
            /*@ admit -4.0000005f <= servo_phi_fast_q1_next <= 4.0000005f; */
            state->servo_phi_fast_sum = servo_phi_fast_sum_next;
            state->servo_phi_fast_p1 = servo_phi_fast_p1_next;
            state->servo_phi_fast_q1 = servo_phi_fast_q1_next;
        }
        const float servo_phi_fast_r = state->servo_phi_fast_r;
        state->servo_phi_fast_r = phi_ref_held;

        /* landing: ramps and state feedback (continued)
         *     damping_theta = 2 * ((pole_theta if theta_measured is set, else predicted_pole_theta) *
         *         (observer_theta_v + observer_theta_beta * (theta - observer_theta_q))) if guard_ready is set,
         *         else 0
         *     w_theta = -((pole_theta if theta_measured is set, else predicted_pole_theta)^2 * theta_estimate +
         *         damping_theta + theta_disturbance) if landing_next is set, else w_theta_tracking
         *     ramp_rate_next_x = max(min(0, ramp_rate_x + acceleration_step), ramp_rate_x - acceleration_step);
         *         likewise ramp_rate_next_z
         *     w_x_unprobed = stiffness * (ramp_x - x_estimate) + damping * (ramp_rate_x - x_rate) +
         *         limit(-inverse_T * ramp_rate_x, acceleration) - x_disturbance if landing_next is set, else
         *         w_x_tracking; likewise w_z_unprobed
         *     ramp_target_y = max(min(touch_speed + approach * (stop - ramp_y), largest_speed), press_speed)
         *     ramp_rate_next_y = max(min(ramp_target_y, ramp_rate_y + acceleration_step_y), ramp_rate_y -
         *         acceleration_step_y)
         *     w_y = stiffness_y * (ramp_y - y_estimate) + damping_y * (ramp_rate_y - y_rate) + limit(inverse_T *
         *         (ramp_target_y - ramp_rate_y), acceleration_y) - y_disturbance if landing_next is set, else
         *         w_y_tracking
         *     left_next = (left if left <= good_per_bad, else left - good_per_bad) if not regular and guard_ready,
         *         else (left if landing_patience <= left, else left + 1)
         *     landing_next = 1 if not regular and guard_ready and left <= good_per_bad, else landing
         *     r_y_next = (max(min(ramp_y + half_T * (ramp_rate_y + ramp_rate_next_y), ramp_end), -bound) if
         *         landing is set, else min(y_estimate, ramp_end)) if landing_next is set, else r_y
         *     r_x_next = (limit(ramp_x + half_T * (ramp_rate_x + ramp_rate_next_x), bound) if landing is set, else
         *         x_estimate) if landing_next is set, else r_x; likewise r_z_next */
        static const float spring_phi = 11250.0f;               /* 1/s^2; 0.75 k_s_phi, k_s_phi = 15000 1/s^2 */
        /* m/s; bound of the ramp's rate: wider than any estimate; of y, x, z */
        static const float ramp_rate_bound = 10.0f;
        static const float acceleration_step = 0.004f;          /* m/s; T times 4 m/s^2 of the ramp; of x, z */
        static const float stiffness = 900.0f;                  /* 1/s^2; p^2, p = 30 1/s; of x, z */
        static const float damping = 60.0f;                     /* 1/s; 2 p, p = 30 1/s; of x, z */
        static const float inverse_T = 1000.0f;                 /* 1/s; 1 / sample period */
        static const float acceleration = 4.0f;                 /* m/s^2; largest one of the ramp; of x, z */
        static const float ramp_end = 0.0326f;                  /* m; bound of the ramp: it is over before */
        static const float stop = 0.031f;                       /* m; gap of the stop on which it lands */
        static const float approach = 25.0f;                    /* 1/s; acceleration over largest speed */
        static const float touch_speed = 0.005f;                /* m/s; speed of the ramp at the stop */
        static const float largest_speed = 0.08f;               /* m/s; largest speed of the ramp */
        static const float press_speed = 0.001f;                /* m/s; least speed of the ramp, behind the stop */
        static const float acceleration_step_y = 0.002f;        /* m/s; T times 2 m/s^2 of the ramp */
        static const float stiffness_y = 3600.0f;               /* 1/s^2; p^2, p = 60 1/s */
        static const float damping_y = 120.0f;                  /* 1/s; 2 p, p = 60 1/s */
        static const float acceleration_y = 2.0f;               /* m/s^2; largest one of the ramp */
        /* 1; samples in a row with a prediction until it lands, times 4 */
        static const uint32_t landing_patience = 20u;
        static const float bound = 0.5f; /* m; of the ramp: wider than any estimate; of y, x, z */
        const bool waiting = !regular && (guard_ready != 0u);
        const uint32_t landing_left = state->landing_left;
        const bool left_at_most_4 = landing_left <= good_per_bad;
        uint32_t landing = 1u;
        if (waiting && left_at_most_4) {
            state->landing_landing = 1u;
        } else {
            landing = landing_landing;
        }
        float w_phi;
        float w_theta;
        float w_x_unprobed;
        float w_y;
        float w_z_unprobed;
        if (landing != 0u) {
            fault_word = faults_before | 0x40000000u;
            const float y_estimate_min_ramp_end = maglev_5dof_precise_min(y_estimate, ramp_end);
            float ramp_x = observer_x.estimate;
            float ramp_rate_x;
            float ramp_y = landing_r_y;
            float ramp_rate_y = y_rate;
            float ramp_z = observer_z.estimate;
            float ramp_rate_z;
            if (landing_landing != 0u) {
                ramp_x = state->landing_r_x;
                ramp_rate_x = state->landing_dr_x;
                ramp_rate_y = state->landing_dr_y;
                ramp_z = state->landing_r_z;
                ramp_rate_z = state->landing_dr_z;
            } else {
                ramp_rate_x = maglev_5dof_precise_limit(observer_x.rate, ramp_rate_bound);
                ramp_y = y_estimate_min_ramp_end;
                ramp_rate_z = maglev_5dof_precise_limit(observer_z.rate, ramp_rate_bound);
            }
            const float ramp_rate_next_x = maglev_5dof_precise_slew(ramp_rate_x, 0.0f, acceleration_step);
            const float ramp_target_y = maglev_5dof_precise_max(maglev_5dof_precise_min(touch_speed +
                (approach * (stop - ramp_y)), largest_speed), press_speed);
            const float ramp_rate_next_y = maglev_5dof_precise_slew(ramp_rate_y, ramp_target_y, acceleration_step_y);
            w_x_unprobed = (stiffness * (ramp_x - observer_x.estimate)) + (damping * (ramp_rate_x - observer_x.rate)) +
                (maglev_5dof_precise_limit(-inverse_T * ramp_rate_x, acceleration) - observer_x.disturbance);
            w_y = (stiffness_y * (ramp_y - y_estimate)) + (damping_y * (ramp_rate_y - y_rate)) +
                (maglev_5dof_precise_limit(inverse_T * (ramp_target_y - ramp_rate_y), acceleration_y) - y_disturbance);
            w_z_unprobed = (stiffness * (ramp_z - observer_z.estimate)) + (damping * (ramp_rate_z - observer_z.rate)) +
                (maglev_5dof_precise_limit(-inverse_T * ramp_rate_z, acceleration) - observer_z.disturbance);
            const float ramp_rate_next_z = maglev_5dof_precise_slew(ramp_rate_z, 0.0f, acceleration_step);
            if (landing_landing != 0u) {
                state->landing_r_y = maglev_5dof_precise_max(maglev_5dof_precise_min(ramp_y +
                    (half_T * (ramp_rate_y + ramp_rate_next_y)), ramp_end), -bound);
                state->landing_r_x = maglev_5dof_precise_limit(ramp_x + (half_T * (ramp_rate_x + ramp_rate_next_x)),
                    bound);
                state->landing_r_z = maglev_5dof_precise_limit(ramp_z + (half_T * (ramp_rate_z + ramp_rate_next_z)),
                    bound);
            } else {
                state->landing_r_y = y_estimate_min_ramp_end;
                state->landing_r_x = observer_x.estimate;
                state->landing_r_z = observer_z.estimate;
            }
            state->landing_dr_y = ramp_rate_next_y;
            state->landing_dr_x = ramp_rate_next_x;
            state->landing_dr_z = ramp_rate_next_z;
            w_phi = -spring_phi * phi;
            w_theta = -((levelling_pole_w_theta * levelling_pole_w_theta * theta_estimate) + damping_theta +
                theta_disturbance);
#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
            if (diagnostics != NULL) {
                diagnostics->x_disturbance = observer_x.disturbance;
                diagnostics->x_estimate = observer_x.estimate;
                diagnostics->x_rate = observer_x.rate;
                diagnostics->z_estimate = observer_z.estimate;
                diagnostics->z_rate = observer_z.rate;
                diagnostics->z_disturbance = observer_z.disturbance;
            }
#endif
        } else {
            w_y = w_y_tracking;
            w_x_unprobed = w_x_tracking;
            w_z_unprobed = w_z_tracking;

            /* servo_phi_fast: predictive servo with internal models (continued) */
            /* 1/s^2; predictive servo with internal models: gain on e */
            static const float servo_phi_fast_k_e = -711.21704f;
            /* 1/s; predictive servo with internal models: gain on de */
            static const float servo_phi_fast_k_de = -80.14009f;
            /* 1/s^2; predictive servo with internal models: gain on sum */
            static const float servo_phi_fast_k_sum = -1.264911f;
            /* 1/s^2; predictive servo with internal models: gain on p1 */
            static const float servo_phi_fast_k_p1 = 16.527708f;
            /* 1/s^2; predictive servo with internal models: gain on q1 */
            static const float servo_phi_fast_k_q1 = -1.2623228f;
            /* 1/s^2; predictive servo with internal models: k_de over the period */
            static const float servo_phi_fast_k_step = -80140.09f;
            const float w_phi_tracking_sum = (servo_phi_fast_k_e * (observer_phi_fast.fast_ahead - phi_ref_held)) +
                (servo_phi_fast_k_de * observer_phi_fast.fast_rate_ahead);
            const float moved = phi_ref_held - servo_phi_fast_r;
            float w_phi_tracking_choice_2 = 0.0f;
            if (fabsf(moved) <= servo_phi_fast_largest) {
                w_phi_tracking_choice_2 = servo_phi_fast_k_step * moved;
            }
            const float w_phi_tracking = w_phi_tracking_sum - w_phi_tracking_choice_2 +
                (servo_phi_fast_k_sum * servo_phi_fast_sum) + (servo_phi_fast_k_p1 * servo_phi_fast_p1) +
                (servo_phi_fast_k_q1 * servo_phi_fast_q1) - w_phi_tracking_choice;
            w_phi = w_phi_tracking;
            w_theta = w_theta_tracking;
            fault_word = faults_before;
#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
            if (diagnostics != NULL) {
                diagnostics->w_y_tracking = w_y_tracking;
                diagnostics->w_x_tracking = w_x_tracking;
                diagnostics->w_z_tracking = w_z_tracking;
                diagnostics->phi_fast_rate_ahead = observer_phi_fast.fast_rate_ahead;
                diagnostics->w_phi_tracking = w_phi_tracking;
                diagnostics->w_theta_tracking = w_theta_tracking;
            }
#endif
        }
        if (waiting) {
            if (!left_at_most_4) {
                state->landing_left = landing_left - good_per_bad;
            }
        } else {
            if (landing_left < landing_patience) {
                state->landing_left = landing_left + 1u;
            }
        }

        /* probe_x: probe at rest
         *     runs = first_push_end <= sample
         *     active = runs or quiet_samples <= x_unchanged
         *     ends = pair_samples <= sample
         *     sample_next = ((0 if ends, else sample + first_push_end) if runs, else free) if active, else 0
         *     attempt_next = ((((attempt if x_unanswered, else attempt + 1) if pair_samples <= x_unchanged, else
         *         0) if ends, else attempt) if runs, else attempt) if active, else 0
         *     towards_next = ((-towards if ends, else towards) if runs, else (towards if 1 <= attempt, else
         *         (-first_push if 0 < e_x, else first_push))) if active, else towards */
        const uint32_t probe_x_sample = state->probe_x_sample;
        const bool runs = first_push_end <= probe_x_sample;
        float w_x = w_x_unprobed;
        if (runs || (quiet_samples <= x_monitor.unchanged)) {
            const float probe_x_towards = state->probe_x_towards;
            if (runs) {
                float pulse = 0.0f;
                if (probe_x_sample <= last_push_end) {
                    const float push = probe_x_towards * ((0.5f * (float)probe_x_attempt) + 1.0f);
                    pulse = ((first_push_end < probe_x_sample) && (probe_x_sample <= reverse_push_end)) ? -push : push;
                }
                w_x = w_x_unprobed + pulse;
                if (pair_samples <= probe_x_sample) {
                    state->probe_x_sample = 0u;
                    state->probe_x_attempt = (pair_samples <= x_monitor.unchanged) ?
                        ((x_unanswered) ? probe_x_attempt : (probe_x_attempt + 1u)) : 0u;
                    state->probe_x_towards = -probe_x_towards;
                } else {
                    state->probe_x_sample = probe_x_sample + first_push_end;
                }
            } else {
                state->probe_x_sample = maglev_5dof_precise_flag(free);
                if (probe_x_attempt < 1u) {
                    state->probe_x_towards = (0.0f < e_x) ? -first_push : first_push;
                }
            }
        } else {
            state->probe_x_sample = 0u;
            state->probe_x_attempt = 0u;
        }

        /* probe_z: probe at rest
         *     as probe_x, with z in place of x */
        const uint32_t probe_z_sample = state->probe_z_sample;
        const bool runs_2 = first_push_end <= probe_z_sample;
        float w_z = w_z_unprobed;
        if (runs_2 || (quiet_samples <= z_monitor.unchanged)) {
            const float probe_z_towards = state->probe_z_towards;
            if (runs_2) {
                float pulse_2 = 0.0f;
                if (probe_z_sample <= last_push_end) {
                    const float push_2 = probe_z_towards * ((0.5f * (float)probe_z_attempt) + 1.0f);
                    pulse_2 = ((first_push_end < probe_z_sample) && (probe_z_sample <= reverse_push_end)) ? -push_2 :
                        push_2;
                }
                w_z = w_z_unprobed + pulse_2;
                if (pair_samples <= probe_z_sample) {
                    state->probe_z_sample = 0u;
                    state->probe_z_attempt = (pair_samples <= z_monitor.unchanged) ?
                        ((z_unanswered) ? probe_z_attempt : (probe_z_attempt + 1u)) : 0u;
                    state->probe_z_towards = -probe_z_towards;
                } else {
                    state->probe_z_sample = probe_z_sample + first_push_end;
                }
            } else {
                state->probe_z_sample = maglev_5dof_precise_flag(free);
                if (probe_z_attempt < 1u) {
                    state->probe_z_towards = (0.0f < e_z) ? -first_push : first_push;
                }
            }
        } else {
            state->probe_z_sample = 0u;
            state->probe_z_attempt = 0u;
        }

        /* inversion: exact inversion of F(2), (6), (7)
         *     half_force = half_M_y * (w_y - G) + half_1 + half_2 + half_3 + half_4
         *     half_force_phi = half_I_over_r * (w_phi + compensated_k_s_phi * phi_fast_ahead) + half_3 - half_1;
         *         likewise half_force_theta
         *     half_force_1_3 = ((s2 + s4) * half_force + (s2 - s4) * half_force_theta - (s3 - s1) *
         *         half_force_phi) / (s1 + s3 + s2 + s4)
         *     i_d1_balanced = limit(2 * doubled_1 / (sqrt(squares_1) + sqrt(max(squares_1 - 8 * (motors_1_half_c *
         *         doubled_1), 0))), direct_limit); likewise i_d2_balanced, i_d3_balanced, i_d4_balanced
         *     u_x_computed = limit(u_x_demand, sqrt(squared_current_limit - max(i_d2_balanced^2,
         *         i_d4_balanced^2))); likewise u_z_computed */
        static const float G = 9.81f;                           /* m/s^2; standard gravity to three digits */
        static const float half_M_y = 3.45f;                    /* kg; M_y / 2, M_y = 6.9 kg */
        static const float highest_y1_held = 0.0322f;           /* m; end of its range; also highest_y3_held */
        static const float lowest_y1_held = 0.0168f;            /* m; end of its range; also lowest_y3_held */
        static const float gap_offset = 0.009233333f;           /* m; b0/2 + h_m/mu_rec - beta, beta = b0^2 / (4 t1) */
        static const float slot_pull = 1.530832e-06f;           /* m/N; half_c_over_h2 beta, beta = b0^2 / (4 t1) */
        /* 1/N; K_v3 / (2 K_h^2) of (2): half_c / h^2 without the effect of the slots */
        static const float half_c_over_h2 = 0.0007232277f;
        static const float M_z = 8.6f;                          /* kg; Table I */
        static const float highest_y2_held = 0.0366f;           /* m; end of its range; also highest_y4_held */
        static const float lowest_y2_held = 0.0124f;            /* m; end of its range; also lowest_y4_held */
        static const float M_x = 10.6f;                         /* kg; Table I */
        static const float compensated_k_s_phi = 11250.0f;      /* 1/s^2; 0.75 k_s_phi, k_s_phi = 15000 1/s^2 */
        /* kg m/rad; I_x / (2 r), r = 0.397 m, I_x = 0.5268 kg m^2/rad; I_z / (2 r), r = 0.397 m, I_z = 0.5268 kg
         * m^2/rad; of x, z */
        static const float half_I_over_r = 0.66347605f;
        static const float compensated_k_s_theta = 2850.0f;     /* 1/s^2; 0.95 k_s_theta, k_s_theta = 3000 1/s^2 */
        /* 1; 4 a c = 16 half_a half_c; b^2 = h^2 + 4 a c as coth^2 = 1 + 1/sinh^2 in (2)-(4) */
        static const float discriminant_factor = 16.0f;
        /* A; largest direct current, rms: a little below the current limit */
        static const float direct_limit = 4.9492526f;
        static const float squared_current_limit = 24.5f;       /* A^2; square of the current limit, 7 A peak */
        static const float inverse_M_x = 0.094339624f;          /* 1/kg; 1 / M_x, M_x = 10.6 kg */
        static const float inverse_M_z = 0.11627907f;           /* 1/kg; 1 / M_z, M_z = 8.6 kg */
        const float tilts_3 = r * observer_phi_fast.fast_ahead;
        const float thrust_per_ampere_1_sum = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_ahead - tilts_3,
            highest_y1_held), lowest_y1_held) + gap_offset;
        const float slot_effect_y1_held = slot_pull / thrust_per_ampere_1_sum;
        const float thrust_per_ampere_1_argument = slot_effect_y1_held - 4.196167e-05f;
        const float thrust_per_ampere_1 = thrust_per_ampere_polynomial(thrust_per_ampere_1_argument);
        const float thrust_per_ampere_1_squared = thrust_per_ampere_1 * thrust_per_ampere_1;
        const float half_a_over_h2_1 = half_a_over_h2_polynomial(thrust_per_ampere_1_argument);
        const float motors_1_half_a = thrust_per_ampere_1_squared * half_a_over_h2_1;
        const float motors_1_half_c = thrust_per_ampere_1_squared * (half_c_over_h2 + slot_effect_y1_held);
        const float thrust_per_ampere_3_sum = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_ahead + tilts_3,
            highest_y1_held), lowest_y1_held) + gap_offset;
        const float slot_effect_y3_held = slot_pull / thrust_per_ampere_3_sum;
        const float thrust_per_ampere_3_argument = slot_effect_y3_held - 4.196167e-05f;
        const float thrust_per_ampere_3 = thrust_per_ampere_polynomial(thrust_per_ampere_3_argument);
        const float h_z = thrust_per_ampere_1 + thrust_per_ampere_3;
        const float u_z_demand = -M_z * w_z / h_z;
        const float i_q_1_3 = maglev_5dof_precise_limit(u_z_demand, current_limit);
        const float i_q_1_3_squared = i_q_1_3 * i_q_1_3;
        const float half_1 = motors_1_half_a + (motors_1_half_c * i_q_1_3_squared);
        const float tilts_2 = r * observer_theta_fast.fast_ahead;
        const float thrust_per_ampere_2_sum = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_ahead + tilts_2,
            highest_y2_held), lowest_y2_held) + gap_offset;
        const float slot_effect_y2_held = slot_pull / thrust_per_ampere_2_sum;
        const float thrust_per_ampere_2_argument = 16384.0f * (slot_effect_y2_held - 3.4332275e-05f);
        const float thrust_per_ampere_2 = thrust_per_ampere_2_polynomial(thrust_per_ampere_2_argument);
        const float thrust_per_ampere_2_squared = thrust_per_ampere_2 * thrust_per_ampere_2;
        const float half_a_over_h2_2 = half_a_over_h2_2_polynomial(thrust_per_ampere_2_argument);
        const float motors_2_half_a = thrust_per_ampere_2_squared * half_a_over_h2_2;
        const float motors_2_half_c = thrust_per_ampere_2_squared * (half_c_over_h2 + slot_effect_y2_held);
        const float thrust_per_ampere_4_sum = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_ahead - tilts_2,
            highest_y2_held), lowest_y2_held) + gap_offset;
        const float slot_effect_y4_held = slot_pull / thrust_per_ampere_4_sum;
        const float thrust_per_ampere_4_argument = 16384.0f * (slot_effect_y4_held - 3.4332275e-05f);
        const float thrust_per_ampere_4 = thrust_per_ampere_2_polynomial(thrust_per_ampere_4_argument);
        const float h_x = thrust_per_ampere_2 + thrust_per_ampere_4;
        const float u_x_demand = -M_x * w_x / h_x;
        const float i_q_2_4 = maglev_5dof_precise_limit(u_x_demand, current_limit);
        const float i_q_2_4_squared = i_q_2_4 * i_q_2_4;
        const float half_2 = motors_2_half_a + (motors_2_half_c * i_q_2_4_squared);
        const float thrust_per_ampere_3_squared = thrust_per_ampere_3 * thrust_per_ampere_3;
        const float half_a_over_h2_3 = half_a_over_h2_polynomial(thrust_per_ampere_3_argument);
        const float motors_3_half_a = thrust_per_ampere_3_squared * half_a_over_h2_3;
        const float motors_3_half_c = thrust_per_ampere_3_squared * (half_c_over_h2 + slot_effect_y3_held);
        const float half_3 = motors_3_half_a + (motors_3_half_c * i_q_1_3_squared);
        const float thrust_per_ampere_4_squared = thrust_per_ampere_4 * thrust_per_ampere_4;
        const float half_a_over_h2_4 = half_a_over_h2_2_polynomial(thrust_per_ampere_4_argument);
        const float motors_4_half_a = thrust_per_ampere_4_squared * half_a_over_h2_4;
        const float motors_4_half_c = thrust_per_ampere_4_squared * (half_c_over_h2 + slot_effect_y4_held);
        const float half_4 = motors_4_half_a + (motors_4_half_c * i_q_2_4_squared);
        const float half_force = (half_M_y * (w_y - G)) + (half_1 + half_2 + half_3 + half_4);
        const float half_force_phi = (half_I_over_r * (w_phi + (compensated_k_s_phi * observer_phi_fast.fast_ahead))) +
            (half_3 - half_1);
        const float half_force_theta = (half_I_over_r * (w_theta +
            (compensated_k_s_theta * observer_theta_fast.fast_ahead))) + (half_2 - half_4);
        const float squares_2 = thrust_per_ampere_2_squared +
            (discriminant_factor * (motors_2_half_a * motors_2_half_c));
        const float s2 = 1.0f / squares_2;
        const float squares_4 = thrust_per_ampere_4_squared +
            (discriminant_factor * (motors_4_half_a * motors_4_half_c));
        const float s4 = 1.0f / squares_4;
        const float s2_plus_s4 = s2 + s4;
        const float squares_3 = thrust_per_ampere_3_squared +
            (discriminant_factor * (motors_3_half_a * motors_3_half_c));
        const float s3 = 1.0f / squares_3;
        const float squares_1 = thrust_per_ampere_1_squared +
            (discriminant_factor * (motors_1_half_a * motors_1_half_c));
        const float s1 = 1.0f / squares_1;
        const float half_force_1_3 = ((s2_plus_s4 * half_force) + ((s2 - s4) * half_force_theta) -
            ((s3 - s1) * half_force_phi)) / (s1 + s3 + s2_plus_s4);
        const float half_force_2_4 = half_force - half_force_1_3;
        const float doubled_1 = half_force_1_3 - half_force_phi;
        const float i_d1_balanced = maglev_5dof_precise_limit(2.0f * doubled_1 / (sqrtf(squares_1) +
            sqrtf(maglev_5dof_precise_max(squares_1 - (8.0f * (motors_1_half_c * doubled_1)), 0.0f))), direct_limit);
        const float doubled_2 = half_force_2_4 + half_force_theta;
        const float i_d2_balanced = maglev_5dof_precise_limit(2.0f * doubled_2 / (sqrtf(squares_2) +
            sqrtf(maglev_5dof_precise_max(squares_2 - (8.0f * (motors_2_half_c * doubled_2)), 0.0f))), direct_limit);
        const float doubled_3 = half_force_1_3 + half_force_phi;
        const float i_d3_balanced = maglev_5dof_precise_limit(2.0f * doubled_3 / (sqrtf(squares_3) +
            sqrtf(maglev_5dof_precise_max(squares_3 - (8.0f * (motors_3_half_c * doubled_3)), 0.0f))), direct_limit);
        const float doubled_4 = half_force_2_4 - half_force_theta;
        const float i_d4_balanced = maglev_5dof_precise_limit(2.0f * doubled_4 / (sqrtf(squares_4) +
            sqrtf(maglev_5dof_precise_max(squares_4 - (8.0f * (motors_4_half_c * doubled_4)), 0.0f))), direct_limit);
        const float u_x_computed_radicand = squared_current_limit -
            maglev_5dof_precise_max(i_d2_balanced * i_d2_balanced, i_d4_balanced * i_d4_balanced);
        const float u_x_computed = maglev_5dof_precise_limit(u_x_demand, sqrtf(u_x_computed_radicand));
        const float u_z_computed_radicand = squared_current_limit -
            maglev_5dof_precise_max(i_d1_balanced * i_d1_balanced, i_d3_balanced * i_d3_balanced);
        const float u_z_computed = maglev_5dof_precise_limit(u_z_demand, sqrtf(u_z_computed_radicand));
        const float a_x = -inverse_M_x * (u_x_computed * h_x);
        const float a_z = -inverse_M_z * (u_z_computed * h_z);
        state->safe_output_last_u_x = u_x_computed;
        state->safe_output_last_u_z = u_z_computed;
        out->i_q2 = u_x_computed;
        out->i_q4 = u_x_computed;
        out->i_q1 = u_z_computed;
        out->i_q3 = u_z_computed;
        state->delay_w_y_last = w_y;
        state->delay_w_phi_last = w_phi;
        state->delay_w_theta_last = w_theta;
        state->delay_a_x_last = a_x;
        state->delay_a_z_last = a_z;

        /* handover: direct currents without x or z; meanwhile |i_d| + |i_q| of a motor is limited, at once
         * Thrust has priority over lift: an i_d that repels drives the platen along the lost axis, away from an
         * angle that is predicted or stale, where i_q only loses the cosine of the error. So i_d fades out of the
         * motors along that axis, and is cut where i_q leaves no room.
         * Without the direct currents along X the guide spring alone holds theta. At gaps below held_by_spring it is
         * weaker than the magnets, so there the handover along X waits for the landing to lower the platen.
         * The limit of |i_d| + |i_q| needs no square root and holds from the first sample on: there i_d may be cut
         * at once, at most from 3.5 A to 1.45 A beside 3.5 A of thrust.
         *     faded_transfer = max(min(target, transfer + fade_step), transfer - fade_step)
         *     i_d1_computed = (1 - part_z) * limit(i_d1_balanced + handed_z, room_z) if not x_trusted or not
         *         z_trusted or 0 < transfer^2, else i_d1_balanced; likewise i_d2_computed, i_d3_computed,
         *         i_d4_computed
         *     transfer_next = faded_transfer if not x_trusted or not z_trusted or 0 < transfer^2, else transfer */
        static const float held_by_spring = 0.022f;             /* m; at smaller gaps theta needs the motors along X */
        static const float fade_step = 0.04f; /* 1; 1 / 25: a handover, and a fade, takes 25 samples */
        const float handover_transfer = state->handover_transfer;
        if (lost_x || lost_z || (0.0f < (handover_transfer * handover_transfer))) {
            const float target = (lost_x && (lost_z || (observer_y_q < held_by_spring))) ? handover_transfer :
                ((x_monitor.trusted) ? ((z_monitor.trusted) ? 0.0f : -1.0f) : 1.0f);
            const float faded_transfer = maglev_5dof_precise_slew(handover_transfer, target, fade_step);
            const bool of_x = 0.0f < faded_transfer;
            const float part = fabsf(faded_transfer);
            const float part_x = (of_x) ? part : 0.0f;
            const float part_z = (of_x) ? 0.0f : part;
            const float handed_x = 0.5f * (part_z * (i_d1_balanced + i_d3_balanced));
            const float room_x = current_limit - fabsf(u_x_computed);
            const float remainder_x = 1.0f - part_x;
            state->safe_output_last_i_d2 = remainder_x * maglev_5dof_precise_limit(i_d2_balanced + handed_x, room_x);
            state->safe_output_last_i_d4 = remainder_x * maglev_5dof_precise_limit(i_d4_balanced + handed_x, room_x);
            const float handed_z = 0.5f * (part_x * (i_d2_balanced + i_d4_balanced));
            const float room_z = current_limit - fabsf(u_z_computed);
            const float remainder_z = 1.0f - part_z;
            state->safe_output_last_i_d1 = remainder_z * maglev_5dof_precise_limit(i_d1_balanced + handed_z, room_z);
            state->safe_output_last_i_d3 = remainder_z * maglev_5dof_precise_limit(i_d3_balanced + handed_z, room_z);
            state->handover_transfer = faded_transfer;
            out->i_d2 = state->safe_output_last_i_d2;
            out->i_d4 = state->safe_output_last_i_d4;
            out->i_d1 = state->safe_output_last_i_d1;
            out->i_d3 = state->safe_output_last_i_d3;
        } else {
            /* safe_output: slew to the safe output once latched (continued) */
            state->safe_output_last_i_d1 = i_d1_balanced;
            out->i_d1 = i_d1_balanced;
            state->safe_output_last_i_d2 = i_d2_balanced;
            out->i_d2 = i_d2_balanced;
            state->safe_output_last_i_d3 = i_d3_balanced;
            out->i_d3 = i_d3_balanced;
            state->safe_output_last_i_d4 = i_d4_balanced;
            out->i_d4 = i_d4_balanced;
        }
#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
        if (diagnostics != NULL) {
            diagnostics->free = free ? 1.0f : 0.0f;
            diagnostics->e_y = e_y;
            diagnostics->e_x = e_x;
            diagnostics->e_z = e_z;
            diagnostics->e_phi = e_phi;
            diagnostics->e_theta = e_theta;
            diagnostics->phi_fast_ahead = observer_phi_fast.fast_ahead;
            diagnostics->y_fast_ahead = y_fast_ahead;
            diagnostics->y_fast_rate_ahead = y_fast_rate_ahead;
            diagnostics->x_fast_ahead = observer_x_fast.fast_ahead;
            diagnostics->x_fast_rate_ahead = observer_x_fast.fast_rate_ahead;
            diagnostics->z_fast_ahead = observer_z_fast.fast_ahead;
            diagnostics->z_fast_rate_ahead = observer_z_fast.fast_rate_ahead;
            diagnostics->theta_fast_ahead = observer_theta_fast.fast_ahead;
            diagnostics->theta_fast_rate_ahead = observer_theta_fast.fast_rate_ahead;
            diagnostics->x_frozen = (float)x_monitor.frozen;
            diagnostics->x_unchanged = (float)x_monitor.unchanged;
            diagnostics->x_diverges = x_monitor.diverges ? 1.0f : 0.0f;
            diagnostics->z_frozen = (float)z_monitor.frozen;
            diagnostics->z_unchanged = (float)z_monitor.unchanged;
            diagnostics->z_diverges = z_monitor.diverges ? 1.0f : 0.0f;
            diagnostics->w_phi = w_phi;
            diagnostics->w_theta = w_theta;
            diagnostics->w_x_unprobed = w_x_unprobed;
            diagnostics->w_y = w_y;
            diagnostics->w_z_unprobed = w_z_unprobed;
            diagnostics->w_x = w_x;
            diagnostics->w_z = w_z;
            diagnostics->i_d1_balanced = i_d1_balanced;
            diagnostics->i_d2_balanced = i_d2_balanced;
            diagnostics->i_d3_balanced = i_d3_balanced;
            diagnostics->i_d4_balanced = i_d4_balanced;
            diagnostics->a_x = a_x;
            diagnostics->a_z = a_z;
            diagnostics->saturated |= (fabsf(y_fast_rate_ahead) >= observer_y_fast_largest_rate) ? 0x00000001u : 0u;
            diagnostics->saturated |= (fabsf(i_d1_balanced) >= direct_limit) ? 0x00000002u : 0u;
            diagnostics->saturated |= (fabsf(i_d2_balanced) >= direct_limit) ? 0x00000004u : 0u;
            diagnostics->saturated |= (fabsf(i_d3_balanced) >= direct_limit) ? 0x00000008u : 0u;
            diagnostics->saturated |= (fabsf(i_d4_balanced) >= direct_limit) ? 0x00000010u : 0u;
            diagnostics->saturated |= (fabsf(u_x_computed) >= sqrtf(u_x_computed_radicand)) ? 0x00000020u : 0u;
            diagnostics->saturated |= (fabsf(u_z_computed) >= sqrtf(u_z_computed_radicand)) ? 0x00000040u : 0u;
        }
#endif
    }
#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
    if (diagnostics != NULL) {
        diagnostics->x_unanswered = x_unanswered ? 1.0f : 0.0f;
        diagnostics->z_unanswered = z_unanswered ? 1.0f : 0.0f;
        diagnostics->sound = sound ? 1.0f : 0.0f;
        diagnostics->x_usual = x_monitor.usual ? 1.0f : 0.0f;
        diagnostics->x_trusted = x_monitor.trusted ? 1.0f : 0.0f;
        diagnostics->z_usual = z_monitor.usual ? 1.0f : 0.0f;
        diagnostics->z_trusted = z_monitor.trusted ? 1.0f : 0.0f;
        diagnostics->gaps_sufficient = gaps_sufficient ? 1.0f : 0.0f;
        diagnostics->y1_held = y1_held;
        diagnostics->y2_held = y2_held;
        diagnostics->y3_held = y3_held;
        diagnostics->y4_held = y4_held;
        diagnostics->regular = regular ? 1.0f : 0.0f;
        diagnostics->theta_measured = theta_measured ? 1.0f : 0.0f;
        diagnostics->landed = landed ? 1.0f : 0.0f;
        diagnostics->y = y;
        diagnostics->theta = theta;
        diagnostics->phi = phi;
        diagnostics->y_fast_estimate = y_fast_estimate;
        diagnostics->y_fast_rate = y_fast_rate;
        diagnostics->y_fast_disturbance = y_fast_disturbance;
        diagnostics->theta_disturbance = theta_disturbance;
        diagnostics->theta_estimate = theta_estimate;
        diagnostics->theta_rate = theta_rate;
        diagnostics->y_disturbance = y_disturbance;
        diagnostics->y_estimate = y_estimate;
        diagnostics->y_rate = y_rate;
        diagnostics->phi_estimate = phi_estimate;
        diagnostics->phi_rate = phi_rate;
        diagnostics->phi_disturbance = phi_disturbance;
        diagnostics->faults = fault_word;
        if ((diagnostics->latch_cause == 0u) && ((fault_word & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = fault_word;
        }
    }
#endif
    return fault_word;
}
