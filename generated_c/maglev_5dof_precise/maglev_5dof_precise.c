/* maglev_5dof_precise. Generated: do not edit. */
#include "maglev_5dof_precise.h"
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
    float y1_expected;
    float y2_expected;
    float y3_expected;
    float y4_expected;
} maglev_5dof_precise_gap_prediction_t;

/* gap_prediction: gaps of the predicted pose, F(5) */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_gap_prediction_t maglev_5dof_precise_gap_prediction(float y_expected,
    float phi_expected, float theta_expected, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float r = 0.397f;                              /* m; Table I */

    const float r_phi = r * phi_expected;
    const float r_theta = r * theta_expected;
    if (diagnostics != NULL) {
        diagnostics->y1_expected = y_expected - r_phi;
        diagnostics->y2_expected = y_expected + r_theta;
        diagnostics->y3_expected = y_expected + r_phi;
        diagnostics->y4_expected = y_expected - r_theta;
    }
    return (maglev_5dof_precise_gap_prediction_t){.y1_expected = y_expected - r_phi, .y2_expected = y_expected +
        r_theta, .y3_expected = y_expected + r_phi, .y4_expected = y_expected - r_theta};
}

typedef struct {
    bool judging;
    bool tolerated;
} maglev_5dof_precise_guard_output_t;

/* guard: range acceptance, hold, latch */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_guard_output_t maglev_5dof_precise_guard_output(const
    maglev_5dof_precise_guard_state_t *state, uint32_t latched, float missed_calls)
{
    const uint32_t ready = state->ready;
    return (maglev_5dof_precise_guard_output_t){.judging = (ready != 0u) && (latched == 0u),
        .tolerated = (0.0f <= missed_calls) && (missed_calls <= 40.0f)};
}

typedef struct {
    float value;
    float residual_0;
    uint32_t still_y1_next;
    uint32_t still_y2_next;
    uint32_t still_y3_next;
    uint32_t still_y4_next;
    bool sound;
    bool same_y1;
    bool same_y2;
    bool same_y3;
    bool same_y4;
} maglev_5dof_precise_redundancy_output_t;

/* redundancy: parity, innovations, frozen codes */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_redundancy_output_t maglev_5dof_precise_redundancy_output(const
    maglev_5dof_precise_redundancy_state_t *state, const maglev_5dof_precise_input_t *accepted, uint32_t ready,
    bool complete, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const uint32_t still_samples = 8u; /* 1; samples without a change of the code: it stands still */

    const float value = accepted->y1 - accepted->y2 + accepted->y3;
    const uint32_t degraded = state->degraded;
    const bool sound = (ready != 0u) && complete && (degraded == 0u);
    const bool same_y1 = maglev_5dof_precise_equal(accepted->y1, state->code_y1);
    uint32_t still_y1_next = 0u;
    if (same_y1) {
        const uint32_t still_y1 = state->still_y1;
        still_y1_next = (still_samples <= still_y1) ? still_y1 : (still_y1 + 1u);
    }
    const bool same_y2 = maglev_5dof_precise_equal(accepted->y2, state->code_y2);
    uint32_t still_y2_next = 0u;
    if (same_y2) {
        const uint32_t still_y2 = state->still_y2;
        still_y2_next = (still_samples <= still_y2) ? still_y2 : (still_y2 + 1u);
    }
    const bool same_y3 = maglev_5dof_precise_equal(accepted->y3, state->code_y3);
    uint32_t still_y3_next = 0u;
    if (same_y3) {
        const uint32_t still_y3 = state->still_y3;
        still_y3_next = (still_samples <= still_y3) ? still_y3 : (still_y3 + 1u);
    }
    const bool same_y4 = maglev_5dof_precise_equal(accepted->y4, state->code_y4);
    uint32_t still_y4_next = 0u;
    if (same_y4) {
        const uint32_t still_y4 = state->still_y4;
        still_y4_next = (still_samples <= still_y4) ? still_y4 : (still_y4 + 1u);
    }
    if (diagnostics != NULL) {
        diagnostics->sound = sound ? 1.0f : 0.0f;
    }
    return (maglev_5dof_precise_redundancy_output_t){.value = value, .residual_0 = value - accepted->y4,
        .still_y1_next = still_y1_next, .still_y2_next = still_y2_next, .still_y3_next = still_y3_next, .still_y4_next =
        still_y4_next, .sound = sound, .same_y1 = same_y1, .same_y2 = same_y2, .same_y3 = same_y3, .same_y4 = same_y4};
}

typedef struct {
    float before_next;
    float held;
    uint32_t unchanged;
    uint32_t suspect;
    uint32_t out_of_use;
    bool above_gate;
    bool same;
    bool jumping;
    bool usual;
    bool trusted;
    bool far;
    bool believed;
} maglev_5dof_precise_monitor_output_t;

/* x_monitor, z_monitor: frozen codes, jumps of the innovation */
MAGLEV_5DOF_PRECISE_LARGE maglev_5dof_precise_monitor_output_t
    maglev_5dof_precise_monitor_output(const maglev_5dof_precise_monitor_state_t *state, float expected, float accepted,
    bool in_time, uint32_t ready, bool unanswered, bool sound, bool good)
{
    static const float gate = 4e-05f;                           /* m; an agreeing prediction is nearer */
    static const float jump = 0.00015f; /* m; from the prediction: no acceleration of the machine explains it */
    /* m; growth of the distance to the prediction that needs no earlier agreement: of a code that changes */
    static const float wide_jump = 0.0005f;
    static const float travel = 0.0499f; /* m; end of the travel, where a stop may hold it; of low, high */
    static const uint32_t most_unchanged = 40u;                 /* 1; samples without a change that are counted */
    static const uint32_t repeated_samples = 3u; /* 1; samples without a change of the code: fewer, and it moves */
    static const float frozen_gate = 8.2e-05f; /* m; predicted motion in which a working code changes */
    /* m; growth of the distance to the prediction that needs no earlier agreement: of a code that stands still */
    static const float wide_frozen = 0.0002f;

    const float distance = fabsf(expected - accepted);
    const bool above_gate = gate < distance;
    const float code = state->code;
    const bool same = maglev_5dof_precise_equal(accepted, code);
    const float before = state->before;
    const uint32_t doubts = state->doubts;
    const bool doubts_below_1 = doubts < 1u;
    bool jumping = false;
    bool strayed = false;
    bool far = false;
    bool believed = false;
    if (above_gate) {
        const bool far_2 = jump < distance;
        if (far_2) {
            const uint32_t jumps = state->jumps;
            const float growth = distance - fabsf(code - before);
            const bool believed_2 = (doubts_below_1 || (wide_jump < growth)) && in_time && (-travel < expected) &&
                (expected < travel) && (-travel < code) && (code < travel);
            jumping = (1u <= jumps) || (believed_2 && !same);
            strayed = wide_frozen < growth;
            believed = believed_2;
        }
        far = far_2;
    }
    uint32_t unchanged = 0u;
    float before_next_if_ready = before;
    if (same) {
        const uint32_t still = state->still;
        unchanged = (most_unchanged <= still) ? still : (still + 1u);
    } else {
        before_next_if_ready = expected;
    }
    const float before_next = (ready != 0u) ? before_next_if_ready : accepted;
    bool usual = false;
    uint32_t suspect = 1u;
    bool trusted = false;
    float held = expected;
    uint32_t out_of_use = 0u;
    if (!jumping) {
        const uint32_t excluded = state->excluded;
        const bool usable = good && (excluded == 0u);
        const uint32_t stopped = (usable) ? 1u : excluded;
        if ((repeated_samples <= unchanged) && (-travel < accepted) && (accepted < travel) && (((frozen_gate <
                fabsf(expected - before_next)) && doubts_below_1) || strayed || unanswered) && (ready != 0u)) {
            suspect = stopped;
            out_of_use = stopped;
        } else {
            usual = sound;
            if (sound) {
                suspect = 0u;
                out_of_use = 0u;
                trusted = true;
                held = accepted;
            } else {
                suspect = excluded;
                out_of_use = excluded;
                trusted = usable;
                held = (usable) ? accepted : expected;
            }
        }
    }
    return (maglev_5dof_precise_monitor_output_t){.before_next = before_next, .held = held, .unchanged = unchanged,
        .suspect = suspect, .out_of_use = out_of_use, .above_gate = above_gate, .same = same, .jumping = jumping,
        .usual = usual, .trusted = trusted, .far = far, .believed = believed};
}

/* x_monitor, z_monitor: frozen codes, jumps of the innovation */
MAGLEV_5DOF_PRECISE_INLINE uint32_t maglev_5dof_precise_monitor_update(maglev_5dof_precise_monitor_state_t *state,
    const maglev_5dof_precise_monitor_output_t *monitor_output, float accepted)
{
    static const uint32_t excluded_from = 2u;                   /* 1; contradictions or jumps before the last */
    static const uint32_t doubted_changes = 10u; /* 1; changes of the code until its prediction is believed */

    state->code = accepted;
    state->still = monitor_output->unchanged;
    uint32_t frozen = monitor_output->out_of_use;
    if (monitor_output->jumping) {
        frozen = state->excluded;
        const uint32_t jumps = state->jumps;
        if (excluded_from <= jumps) {
            state->excluded = 1u;
            state->jumps = 0u;
        } else {
            state->jumps = jumps + 1u;
        }
    } else {
        state->excluded = monitor_output->out_of_use;
        state->jumps = 0u;
    }
    const uint32_t doubts = state->doubts;
    uint32_t doubts_if_not_far = doubts;
    uint32_t agreeing = doubts;
    if (!monitor_output->same) {
        doubts_if_not_far = doubted_changes;
        if (1u <= doubts) {
            agreeing = doubts - 1u;
        } else {
            agreeing = 0u;
        }
    }
    if (monitor_output->above_gate) {
        state->doubts = (monitor_output->far) ?
            ((monitor_output->same || monitor_output->believed) ? doubts : doubted_changes) : doubts_if_not_far;
    } else {
        state->doubts = agreeing;
    }
    state->before = monitor_output->before_next;
    return frozen;
}

typedef struct {
    float disturbance;
    float estimate;
    float rate;
} maglev_5dof_precise_observer_t;

/* observer_x, observer_z: predictive observer, alpha-beta-gamma */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_observer_t
    maglev_5dof_precise_observer(maglev_5dof_precise_observer_2_state_t *state, uint32_t ready,
    const maglev_5dof_precise_monitor_output_t *monitor_output, uint32_t frozen, float a_before)
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
    float estimate = monitor_output->held;
    float rate = 0.0f;
    float g_change = 0.0f;
    if (ready != 0u) {
        const float q = state->q;
        const float nu = monitor_output->held - q;
        const float d = state->d;
        const float v = state->v;
        if (monitor_output->trusted) {
            const float d_if_trusted = maglev_5dof_precise_limit(d + (gamma * nu), largest_disturbance);
            d_next = d_if_trusted;
            rate = v + (beta * nu);
            g_change = learning_step * (a_before * d_if_trusted);
        } else {
            float taken_back = 0.0f;
            if (frozen != 0u) {
                taken_back = (beta / gamma * (d - d_at_change)) + (T * gained);
            }
            rate = v - taken_back;
        }
        estimate = q + (alpha * nu);
    }
    const float g = state->g;
    const float rate_ahead = rate + (T * ((g * a_before) + d_next));
    state->q = maglev_5dof_precise_limit(estimate + (half_T * (rate + rate_ahead)), largest_position);
    state->v = maglev_5dof_precise_limit(rate_ahead, largest_rate);
    state->d = d_next;
    if (monitor_output->trusted && (1u <= monitor_output->unchanged)) {
        state->gained = (gained_decay * gained) + (d_next - d_at_change);
    } else {
        state->gained = 0.0f;
        state->d_at_change = d_next;
    }
    state->g = maglev_5dof_precise_max(maglev_5dof_precise_min(g + g_change, largest_gain), least_gain);
    return (maglev_5dof_precise_observer_t){.disturbance = d_next, .estimate = estimate, .rate = rate};
}

typedef struct {
    float value;
    float value_2;
    float value_3;
    float value_4;
    bool repeats_y1;
    bool repeats_y2;
    bool repeats_y3;
    bool repeats_y4;
    bool isolated_y1;
    bool isolated_y2;
    bool isolated_y3;
    bool isolated_y4;
} maglev_5dof_precise_redundancy_output_2_isolation_0_t;

/* isolation_0 */
MAGLEV_5DOF_PRECISE_LARGE maglev_5dof_precise_redundancy_output_2_isolation_0_t
    maglev_5dof_precise_redundancy_output_2_isolation_0(float residual_0, float y1_accepted, float y1_expected, float
    y2_accepted, float y2_expected, float y3_accepted, float y3_expected, float y4_accepted, float y4_expected, uint32_t
    still_y1_next, float size, uint32_t still_y2_next, uint32_t still_y3_next, uint32_t still_y4_next, bool decided)
{
    static const uint32_t repeated_samples = 3u; /* 1; samples without a change of the code: fewer, and it moves */
    /* 1; of |r|: least E by a code that stands still; it had |r| at first, and predictions follow it */
    static const float candidate_part = 0.4f;
    static const uint32_t all_but_one_of_4 = 3u;                /* 1; sensors of a group but one */
    static const uint32_t still_samples = 8u; /* 1; samples without a change of the code: it stands still */
    static const float lead_by_code = 0.05f; /* 1; of |r|: least lead over the next E by codes: more than noise of E */
    /* 1; of |r|: least lead by innovations alone, which predictions that followed an error spoil */
    static const float lead_by_innovation = 0.3f;
    static const float preference = 10.0f; /* m; more than any E: codes decide before innovations */
    static const float twice_preference = 20.0f;                /* m; more than any score: no sensor is named */
    static const float highest_y1_y3 = 0.0322f;                 /* m; end of its range */
    static const float lowest_y1_y3 = 0.0168f;                  /* m; end of its range */
    static const float highest_y2_y4 = 0.0366f;                 /* m; end of its range */
    static const float lowest_y2_y4 = 0.0124f;                  /* m; end of its range */

    const bool residual_0_positive = 0.0f < residual_0;
    const float direction_y1_y3 = (residual_0_positive) ? 1.0f : -1.0f;
    const float E_y1 = direction_y1_y3 * (y1_accepted - y1_expected);
    const float direction_y2_y4 = (residual_0_positive) ? -1.0f : 1.0f;
    const float E_y2 = direction_y2_y4 * (y2_accepted - y2_expected);
    const float E_y3 = direction_y1_y3 * (y3_accepted - y3_expected);
    const float E_y4 = direction_y2_y4 * (y4_accepted - y4_expected);
    const bool repeats_y1 = repeated_samples <= still_y1_next;
    const float least_E = candidate_part * size;
    const bool candidate_y1 = repeats_y1 && (least_E < E_y1);
    const bool repeats_y2 = repeated_samples <= still_y2_next;
    const bool candidate_y2 = repeats_y2 && (least_E < E_y2);
    const bool repeats_y3 = repeated_samples <= still_y3_next;
    const bool candidate_y3 = repeats_y3 && (least_E < E_y3);
    const bool repeats_y4 = repeated_samples <= still_y4_next;
    const bool candidate_y4 = repeats_y4 && (least_E < E_y4);
    const uint32_t candidates = maglev_5dof_precise_flag(candidate_y1) + maglev_5dof_precise_flag(candidate_y2) +
        maglev_5dof_precise_flag(candidate_y3) + maglev_5dof_precise_flag(candidate_y4);
    const bool by_first_rule = candidates != 0u;
    const uint32_t moving = maglev_5dof_precise_flag(still_y1_next < repeated_samples) +
        maglev_5dof_precise_flag(still_y2_next < repeated_samples) + maglev_5dof_precise_flag(still_y3_next <
        repeated_samples) + maglev_5dof_precise_flag(still_y4_next < repeated_samples);
    uint32_t standing = 0u;
    float preferred_y1 = 0.0f;
    float preferred_y2 = 0.0f;
    float preferred_y3 = 0.0f;
    float preferred_y4 = 0.0f;
    if (moving == all_but_one_of_4) {
        const bool stands_y1 = still_samples <= still_y1_next;
        const bool stands_y2 = still_samples <= still_y2_next;
        const bool stands_y3 = still_samples <= still_y3_next;
        const bool stands_y4 = still_samples <= still_y4_next;
        standing = maglev_5dof_precise_flag(stands_y1) + maglev_5dof_precise_flag(stands_y2) +
            maglev_5dof_precise_flag(stands_y3) + maglev_5dof_precise_flag(stands_y4);
        const float by_second_rule = 1.0f - (by_first_rule ? 1.0f : 0.0f);
        preferred_y1 = (stands_y1) ? by_second_rule : 0.0f;
        preferred_y2 = (stands_y2) ? by_second_rule : 0.0f;
        preferred_y3 = (stands_y3) ? by_second_rule : 0.0f;
        preferred_y4 = (stands_y4) ? by_second_rule : 0.0f;
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
    const float least = (((((by_code) ? lead_by_code : lead_by_innovation) * size) < (best -
        maglev_5dof_precise_max(second_y3, maglev_5dof_precise_min(best_y3, score_y4)))) && (by_code || decided)) ?
        best : twice_preference;
    const bool isolated_y1 = least <= score_y1;
    const bool isolated_y2 = least <= score_y2;
    const bool isolated_y3 = least <= score_y3;
    const bool isolated_y4 = least <= score_y4;
    return (maglev_5dof_precise_redundancy_output_2_isolation_0_t){.value =
        maglev_5dof_precise_max(maglev_5dof_precise_min(y1_accepted - ((isolated_y1) ? residual_0 : 0.0f),
        highest_y1_y3), lowest_y1_y3), .value_2 = maglev_5dof_precise_max(maglev_5dof_precise_min(y2_accepted +
        ((isolated_y2) ? residual_0 : 0.0f), highest_y2_y4), lowest_y2_y4),
        .value_3 = maglev_5dof_precise_max(maglev_5dof_precise_min(y3_accepted - ((isolated_y3) ? residual_0 : 0.0f),
        highest_y1_y3), lowest_y1_y3), .value_4 = maglev_5dof_precise_max(maglev_5dof_precise_min(y4_accepted +
        ((isolated_y4) ? residual_0 : 0.0f), highest_y2_y4), lowest_y2_y4), .repeats_y1 = repeats_y1,
        .repeats_y2 = repeats_y2, .repeats_y3 = repeats_y3, .repeats_y4 = repeats_y4, .isolated_y1 = isolated_y1,
        .isolated_y2 = isolated_y2, .isolated_y3 = isolated_y3, .isolated_y4 = isolated_y4};
}

typedef struct {
    uint32_t doubted;
    bool readmitted_y1;
    bool readmitted_y2;
    bool readmitted_y3;
    bool readmitted_y4;
} maglev_5dof_precise_redundancy_output_2_readmission_0_t;

/* readmission_0 */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_redundancy_output_2_readmission_0_t
    maglev_5dof_precise_redundancy_output_2_readmission_0(uint32_t stuck_0, uint32_t excluded_y1, bool same_y1,
    bool good_y1, uint32_t excluded_y2, bool same_y2, bool good_y2, uint32_t excluded_y3, bool same_y3, bool good_y3,
    uint32_t excluded_y4, bool same_y4, bool good_y4, uint32_t undecided_0)
{
    const bool readmitted_y1 = (stuck_0 != 0u) && (excluded_y1 != 0u) && !same_y1 && good_y1;
    const bool readmitted_y2 = (stuck_0 != 0u) && (excluded_y2 != 0u) && !same_y2 && good_y2;
    const bool readmitted_y3 = (stuck_0 != 0u) && (excluded_y3 != 0u) && !same_y3 && good_y3;
    const bool readmitted_y4 = (stuck_0 != 0u) && (excluded_y4 != 0u) && !same_y4 && good_y4;
    return (maglev_5dof_precise_redundancy_output_2_readmission_0_t){.doubted = (readmitted_y1 || readmitted_y2 ||
        readmitted_y3 || readmitted_y4) ? 1u : undecided_0, .readmitted_y1 = readmitted_y1,
        .readmitted_y2 = readmitted_y2, .readmitted_y3 = readmitted_y3, .readmitted_y4 = readmitted_y4};
}

typedef struct {
    float value;
    float value_2;
    float value_3;
    float value_4;
    bool enough;
} maglev_5dof_precise_redundancy_output_2_replacement_0_t;

/* replacement_0 */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_redundancy_output_2_replacement_0_t
    maglev_5dof_precise_redundancy_output_2_replacement_0(bool usable_y1, float y1_accepted, uint32_t missing,
    float residual_0, float y1_expected, bool usable_y2, float y2_accepted, float y2_expected, bool usable_y3,
    float y3_accepted, float y3_expected, bool usable_y4, float y4_accepted, float residual_0_sum, float y4_expected)
{
    static const float highest_y1_y3 = 0.0322f;                 /* m; end of its range */
    static const float lowest_y1_y3 = 0.0168f;                  /* m; end of its range */
    static const float highest_y2_y4 = 0.0366f;                 /* m; end of its range */
    static const float lowest_y2_y4 = 0.0124f;                  /* m; end of its range */

    const bool enough = missing <= 1u;
    float predicted_y1 = y1_expected;
    float predicted_y2 = y2_expected;
    float predicted_y3 = y3_expected;
    float predicted_y4 = residual_0_sum;
    if (enough) {
        predicted_y1 = y1_accepted - residual_0;
        predicted_y2 = y2_accepted + residual_0;
        predicted_y3 = y3_accepted - residual_0;
    } else {
        predicted_y4 = y4_expected;
    }
    return (maglev_5dof_precise_redundancy_output_2_replacement_0_t){.value =
        maglev_5dof_precise_max(maglev_5dof_precise_min((usable_y1) ? y1_accepted : predicted_y1, highest_y1_y3),
        lowest_y1_y3), .value_2 = maglev_5dof_precise_max(maglev_5dof_precise_min((usable_y2) ? y2_accepted :
        predicted_y2, highest_y2_y4), lowest_y2_y4),
        .value_3 = maglev_5dof_precise_max(maglev_5dof_precise_min((usable_y3) ? y3_accepted : predicted_y3,
        highest_y1_y3), lowest_y1_y3), .value_4 = maglev_5dof_precise_max(maglev_5dof_precise_min((usable_y4) ?
        y4_accepted : predicted_y4, highest_y2_y4), lowest_y2_y4), .enough = enough};
}

typedef struct {
    float y1_held;
    float y2_held;
    float y3_held;
    float y4_held;
    uint32_t waited;
    uint32_t doubted;
    bool calm;
    bool suspect_y1;
    bool suspect_y2;
    bool suspect_y3;
    bool suspect_y4;
    bool gaps_sufficient;
    bool whole;
    bool agrees;
    bool repeats_y1;
    bool repeats_y2;
    bool repeats_y3;
    bool repeats_y4;
    bool decided;
    bool isolated_y1;
    bool readmitted_y1;
    bool readmitted_y2;
    bool readmitted_y3;
    bool readmitted_y4;
    bool isolated_y2;
    bool isolated_y3;
    bool isolated_y4;
    bool enough;
} maglev_5dof_precise_redundancy_output_2_t;

/* redundancy: parity, innovations, frozen codes */
MAGLEV_5DOF_PRECISE_LARGE maglev_5dof_precise_redundancy_output_2_t maglev_5dof_precise_redundancy_output_2(const
    maglev_5dof_precise_redundancy_state_t *state, const maglev_5dof_precise_redundancy_output_t *redundancy_output,
    const maglev_5dof_precise_input_t *accepted, const maglev_5dof_precise_gap_prediction_t *gap_prediction,
    bool x_usual, bool z_usual, uint32_t complete_part, uint32_t ready, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const uint32_t undecided_from = 9u;                  /* 1; contradictions before all are suspects */
    static const uint32_t tolerated_missing = 2u;               /* 1; readings of a group that may be missing */

    const bool agreement = (redundancy_output->residual_0 * redundancy_output->residual_0) <= state->bound_0;
    const bool calm = redundancy_output->sound && agreement && x_usual && z_usual;
    bool suspect_y1 = false;
    bool suspect_y2 = false;
    bool suspect_y3 = false;
    bool suspect_y4 = false;
    bool gaps_sufficient_if_ready = true;
    float y1_held = accepted->y1;
    float y2_held = accepted->y2;
    float y3_held = accepted->y3;
    float y4_held = accepted->y4;
    bool whole = false;
    bool agrees = false;
    bool repeats_y1 = false;
    bool repeats_y2 = false;
    bool repeats_y3 = false;
    bool repeats_y4 = false;
    bool decided = false;
    bool isolated_y1 = false;
    uint32_t waited = 0u;
    bool readmitted_y1 = false;
    bool readmitted_y2 = false;
    bool readmitted_y3 = false;
    bool readmitted_y4 = false;
    uint32_t doubted = 0u;
    bool isolated_y2 = false;
    bool isolated_y3 = false;
    bool isolated_y4 = false;
    bool enough = false;
    if (!calm) {
        const bool good_y1 = (complete_part & 0x00000001u) == 0u;
        const uint32_t excluded_y1 = state->excluded_y1;
        const bool usable_y1 = good_y1 && (excluded_y1 == 0u);
        const bool good_y2 = (complete_part & 0x00000002u) == 0u;
        const uint32_t excluded_y2 = state->excluded_y2;
        const bool usable_y2 = good_y2 && (excluded_y2 == 0u);
        const bool good_y3 = (complete_part & 0x00000004u) == 0u;
        const uint32_t excluded_y3 = state->excluded_y3;
        const bool usable_y3 = good_y3 && (excluded_y3 == 0u);
        const bool good_y4 = (complete_part & 0x00000008u) == 0u;
        const uint32_t excluded_y4 = state->excluded_y4;
        const bool usable_y4 = good_y4 && (excluded_y4 == 0u);
        const bool whole_2 = usable_y1 && usable_y2 && usable_y3 && usable_y4;
        const uint32_t undecided_0 = state->undecided_0;
        if (whole_2) {
            const bool agrees_2 = agreement || (ready == 0u);
            const bool decided_2 = undecided_0 == 0u;
            if (agrees_2) {
                const bool undecided_0_positive = undecided_0 != 0u;
                suspect_y1 = undecided_0_positive;
                suspect_y2 = undecided_0_positive;
                suspect_y3 = undecided_0_positive;
                suspect_y4 = undecided_0_positive;
            } else {
                const maglev_5dof_precise_redundancy_output_2_isolation_0_t isolation_0 =
                    maglev_5dof_precise_redundancy_output_2_isolation_0(redundancy_output->residual_0, accepted->y1,
                    gap_prediction->y1_expected, accepted->y2, gap_prediction->y2_expected, accepted->y3,
                    gap_prediction->y3_expected, accepted->y4, gap_prediction->y4_expected,
                    redundancy_output->still_y1_next, fabsf(redundancy_output->residual_0),
                    redundancy_output->still_y2_next, redundancy_output->still_y3_next,
                    redundancy_output->still_y4_next, decided_2);
                const uint32_t contradictions_0 = state->contradictions_0;
                const uint32_t waited_2 = (undecided_from <= contradictions_0) ? 1u : undecided_0;
                suspect_y1 = (maglev_5dof_precise_flag(isolation_0.isolated_y1) + waited_2) != 0u;
                suspect_y2 = (maglev_5dof_precise_flag(isolation_0.isolated_y2) + waited_2) != 0u;
                suspect_y3 = (maglev_5dof_precise_flag(isolation_0.isolated_y3) + waited_2) != 0u;
                suspect_y4 = (maglev_5dof_precise_flag(isolation_0.isolated_y4) + waited_2) != 0u;
                y1_held = isolation_0.value;
                y2_held = isolation_0.value_2;
                y3_held = isolation_0.value_3;
                y4_held = isolation_0.value_4;
                repeats_y1 = isolation_0.repeats_y1;
                repeats_y2 = isolation_0.repeats_y2;
                repeats_y3 = isolation_0.repeats_y3;
                repeats_y4 = isolation_0.repeats_y4;
                isolated_y1 = isolation_0.isolated_y1;
                waited = waited_2;
                isolated_y2 = isolation_0.isolated_y2;
                isolated_y3 = isolation_0.isolated_y3;
                isolated_y4 = isolation_0.isolated_y4;
            }
            agrees = agrees_2;
            decided = decided_2;
        } else {
            const uint32_t stuck_0 = state->stuck_0;
            const maglev_5dof_precise_redundancy_output_2_readmission_0_t readmission_0 =
                maglev_5dof_precise_redundancy_output_2_readmission_0(stuck_0, excluded_y1, redundancy_output->same_y1,
                good_y1, excluded_y2, redundancy_output->same_y2, good_y2, excluded_y3, redundancy_output->same_y3,
                good_y3, excluded_y4, redundancy_output->same_y4, good_y4, undecided_0);
            suspect_y1 = (excluded_y1 + readmission_0.doubted) != 0u;
            suspect_y2 = (excluded_y2 + readmission_0.doubted) != 0u;
            suspect_y3 = (excluded_y3 + readmission_0.doubted) != 0u;
            suspect_y4 = (excluded_y4 + readmission_0.doubted) != 0u;
            const uint32_t missing = maglev_5dof_precise_flag((usable_y1) ? false : true) +
                maglev_5dof_precise_flag((usable_y2) ? false : true) + maglev_5dof_precise_flag((usable_y3) ? false :
                true) + maglev_5dof_precise_flag((usable_y4) ? false : true);
            gaps_sufficient_if_ready = missing <= tolerated_missing;
            const maglev_5dof_precise_redundancy_output_2_replacement_0_t replacement_0 =
                maglev_5dof_precise_redundancy_output_2_replacement_0(usable_y1, accepted->y1, missing,
                redundancy_output->residual_0, gap_prediction->y1_expected, usable_y2, accepted->y2,
                gap_prediction->y2_expected, usable_y3, accepted->y3, gap_prediction->y3_expected, usable_y4,
                accepted->y4, redundancy_output->value, gap_prediction->y4_expected);
            y1_held = replacement_0.value;
            y2_held = replacement_0.value_2;
            y3_held = replacement_0.value_3;
            y4_held = replacement_0.value_4;
            readmitted_y1 = readmission_0.readmitted_y1;
            readmitted_y2 = readmission_0.readmitted_y2;
            readmitted_y3 = readmission_0.readmitted_y3;
            readmitted_y4 = readmission_0.readmitted_y4;
            doubted = readmission_0.doubted;
            enough = replacement_0.enough;
        }
        whole = whole_2;
    }
    const bool gaps_sufficient = (ready != 0u) && gaps_sufficient_if_ready;
    if (diagnostics != NULL) {
        diagnostics->suspect_y1 = suspect_y1 ? 1.0f : 0.0f;
        diagnostics->suspect_y2 = suspect_y2 ? 1.0f : 0.0f;
        diagnostics->suspect_y3 = suspect_y3 ? 1.0f : 0.0f;
        diagnostics->suspect_y4 = suspect_y4 ? 1.0f : 0.0f;
        diagnostics->y1_held = y1_held;
        diagnostics->y2_held = y2_held;
        diagnostics->y3_held = y3_held;
        diagnostics->y4_held = y4_held;
        diagnostics->gaps_sufficient = gaps_sufficient ? 1.0f : 0.0f;
    }
    return (maglev_5dof_precise_redundancy_output_2_t){.y1_held = y1_held, .y2_held = y2_held, .y3_held = y3_held,
        .y4_held = y4_held, .waited = waited, .doubted = doubted, .calm = calm, .suspect_y1 = suspect_y1, .suspect_y2 =
        suspect_y2, .suspect_y3 = suspect_y3, .suspect_y4 = suspect_y4, .gaps_sufficient = gaps_sufficient,
        .whole = whole, .agrees = agrees, .repeats_y1 = repeats_y1, .repeats_y2 = repeats_y2, .repeats_y3 = repeats_y3,
        .repeats_y4 = repeats_y4, .decided = decided, .isolated_y1 = isolated_y1, .readmitted_y1 = readmitted_y1,
        .readmitted_y2 = readmitted_y2, .readmitted_y3 = readmitted_y3, .readmitted_y4 = readmitted_y4,
        .isolated_y2 = isolated_y2, .isolated_y3 = isolated_y3, .isolated_y4 = isolated_y4, .enough = enough};
}

typedef struct {
    bool regular;
    bool theta_measured;
} maglev_5dof_precise_redundancy_update_t;

/* redundancy: parity, innovations, frozen codes */
MAGLEV_5DOF_PRECISE_LARGE maglev_5dof_precise_redundancy_update_t
    maglev_5dof_precise_redundancy_update(maglev_5dof_precise_redundancy_state_t *state,
    const maglev_5dof_precise_redundancy_output_2_t *redundancy_output_2,
    const maglev_5dof_precise_monitor_output_t *z_monitor_output,
    const maglev_5dof_precise_monitor_output_t *x_monitor_output, const maglev_5dof_precise_input_t *accepted,
    const maglev_5dof_precise_redundancy_output_t *redundancy_output, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const uint32_t excluded_from = 2u;                   /* 1; contradictions or jumps before the last */
    static const float kept_part = 0.9921875f;                  /* 1; of the squared threshold, in a sample */
    /* m^2; in a sample, of the squared largest |r| without a fault: half a count and an offset of each sensor */
    static const float quiet_part_0 = 1.8e-11f;
    static const float learnt_part_0 = 0.22100265f;             /* 1; of the squared change of r, in a sample */
    static const float largest_0 = 2.6820562e-08f;              /* m^2; squared threshold at the largest noise */
    static const uint32_t most_contradictions = 10u;            /* 1; contradictions that are counted */

    state->code_y1 = accepted->y1;
    state->still_y1 = redundancy_output->still_y1_next;
    bool regular = true;
    bool theta_measured = true;
    if (redundancy_output_2->calm) {
        const float last_residual_0 = state->last_residual_0;
        state->last_residual_0 = redundancy_output->residual_0;
        const float change = redundancy_output->residual_0 - last_residual_0;
        state->bound_0 = maglev_5dof_precise_min((kept_part * state->bound_0) +
            (quiet_part_0 + (learnt_part_0 * (change * change))), largest_0);
        state->contradictions_0 = 0u;
    } else {
        const uint32_t excluded_y1 = state->excluded_y1;
        const uint32_t excluded_y2 = state->excluded_y2;
        const uint32_t excluded_y3 = state->excluded_y3;
        const uint32_t excluded_y4 = state->excluded_y4;
        bool determined;
        if (redundancy_output_2->whole) {
            if (redundancy_output_2->agrees) {
                determined = redundancy_output_2->decided;
                state->contradictions_0 = 0u;
            } else {
                determined = redundancy_output_2->waited == 0u;
                const uint32_t contradictions_0 = state->contradictions_0;
                bool left_out_now_y1 = redundancy_output_2->isolated_y1;
                bool left_out_now_y2 = redundancy_output_2->isolated_y2;
                bool left_out_now_y3 = redundancy_output_2->isolated_y3;
                bool left_out_now_y4 = redundancy_output_2->isolated_y4;
                if (contradictions_0 < excluded_from) {
                    left_out_now_y1 = false;
                    left_out_now_y2 = false;
                    left_out_now_y3 = false;
                    left_out_now_y4 = false;
                }
                state->excluded_y1 = maglev_5dof_precise_flag(left_out_now_y1);
                state->excluded_y2 = maglev_5dof_precise_flag(left_out_now_y2);
                state->excluded_y3 = maglev_5dof_precise_flag(left_out_now_y3);
                state->excluded_y4 = maglev_5dof_precise_flag(left_out_now_y4);
                if (contradictions_0 < most_contradictions) {
                    state->contradictions_0 = contradictions_0 + 1u;
                }
                const uint32_t stuck_0 = state->stuck_0;
                const uint32_t stuck_0_sum = maglev_5dof_precise_flag(redundancy_output_2->repeats_y1 &&
                    left_out_now_y1) + maglev_5dof_precise_flag(redundancy_output_2->repeats_y2 && left_out_now_y2) +
                    maglev_5dof_precise_flag(redundancy_output_2->repeats_y3 && left_out_now_y3) +
                    maglev_5dof_precise_flag(redundancy_output_2->repeats_y4 && left_out_now_y4) + stuck_0;
                state->stuck_0 = maglev_5dof_precise_flag(stuck_0_sum != 0u);
                state->undecided_0 = redundancy_output_2->waited;
            }
        } else {
            determined = redundancy_output_2->enough && (redundancy_output_2->doubted == 0u);
            state->excluded_y1 = maglev_5dof_precise_flag((excluded_y1 != 0u) && !redundancy_output_2->readmitted_y1);
            state->excluded_y2 = maglev_5dof_precise_flag((excluded_y2 != 0u) && !redundancy_output_2->readmitted_y2);
            state->excluded_y3 = maglev_5dof_precise_flag((excluded_y3 != 0u) && !redundancy_output_2->readmitted_y3);
            state->excluded_y4 = maglev_5dof_precise_flag((excluded_y4 != 0u) && !redundancy_output_2->readmitted_y4);
            state->contradictions_0 = 0u;
            state->undecided_0 = redundancy_output_2->doubted;
        }
        regular = z_monitor_output->trusted && x_monitor_output->trusted && determined;
        theta_measured = determined;
        if ((z_monitor_output->suspect != 0u) || (x_monitor_output->suspect != 0u) || redundancy_output_2->suspect_y4 ||
                redundancy_output_2->suspect_y3 || redundancy_output_2->suspect_y2 || redundancy_output_2->suspect_y1) {
            state->degraded = 1u;
        }
    }
    state->code_y2 = accepted->y2;
    state->still_y2 = redundancy_output->still_y2_next;
    state->code_y3 = accepted->y3;
    state->still_y3 = redundancy_output->still_y3_next;
    state->code_y4 = accepted->y4;
    state->still_y4 = redundancy_output->still_y4_next;
    if (diagnostics != NULL) {
        diagnostics->regular = regular ? 1.0f : 0.0f;
        diagnostics->theta_measured = theta_measured ? 1.0f : 0.0f;
    }
    return (maglev_5dof_precise_redundancy_update_t){.regular = regular, .theta_measured = theta_measured};
}

typedef struct {
    uint32_t latched;
    bool value;
} maglev_5dof_precise_guard_update_t;

/* guard: range acceptance, hold, latch */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_guard_update_t
    maglev_5dof_precise_guard_update(maglev_5dof_precise_guard_state_t *state, bool landed, bool sufficient,
    bool complete, uint32_t latched_before)
{
    static const uint32_t good_per_bad = 4u;                    /* 1; good samples that make up for a bad one */
    static const uint32_t latch_samples = 20u;                  /* 1; bad samples in a row until it latches, times 4 */

    const uint32_t left = state->left;
    const uint32_t ready = state->ready;
    uint32_t gave_up = latched_before;
    if ((ready != 0u) ? sufficient : complete) {
        if (left < latch_samples) {
            state->left = left + 1u;
        }
    } else if (left <= good_per_bad) {
        gave_up = 1u;
    } else {
        state->left = left - good_per_bad;
    }
    if (complete) {
        state->ready = 1u;
    }
    return (maglev_5dof_precise_guard_update_t){.latched = (landed) ? 1u : gave_up, .value = ready != 0u};
}

typedef struct {
    float phi;
    float theta;
} maglev_5dof_precise_kinematics_output_t;

/* kinematics: pose from the gaps, F(5) */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_kinematics_output_t maglev_5dof_precise_kinematics_output(const
    maglev_5dof_precise_redundancy_output_2_t *redundancy_output_2, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    const float y3_held_minus_y1_held = redundancy_output_2->y3_held - redundancy_output_2->y1_held;
    const float phi = y3_held_minus_y1_held * phi_polynomial(y3_held_minus_y1_held * y3_held_minus_y1_held);
    const float y2_held_minus_y4_held = redundancy_output_2->y2_held - redundancy_output_2->y4_held;
    const float theta = y2_held_minus_y4_held * phi_polynomial(y2_held_minus_y4_held * y2_held_minus_y4_held);
    if (diagnostics != NULL) {
        diagnostics->phi = phi;
        diagnostics->theta = theta;
    }
    return (maglev_5dof_precise_kinematics_output_t){.phi = phi, .theta = theta};
}

/* observer_phi: predictive observer, alpha-beta-gamma */
MAGLEV_5DOF_PRECISE_INLINE void maglev_5dof_precise_observer_phi(maglev_5dof_precise_observer_state_t *state,
    uint32_t ready, float phi, float w_phi_before, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float alpha = 0.30232367f;                     /* 1; triple pole exp(-w T), w = 120 rad/s */
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float beta = 36.192043f;                       /* 1/s; triple pole exp(-w T), w = 120 rad/s */
    static const float T = 0.001f;                              /* s; sample period */
    static const float gamma = 1445.947f;                       /* 1/s^2; triple pole exp(-w T), w = 120 rad/s */
    static const float largest_disturbance = 200.0f;            /* rad/s^2; bound of the disturbance */
    static const float largest_position = 0.02f;                /* rad; bound of the prediction */
    static const float largest_rate = 4.0f;                     /* rad/s; bound of the predicted rate */

    float phi_estimate = phi;
    float phi_rate = 0.0f;
    float phi_disturbance = 0.0f;
    if (ready != 0u) {
        const float q = state->q;
        const float nu = phi - q;
        phi_estimate = q + (alpha * nu);
        phi_rate = state->v + (beta * nu);
        phi_disturbance = maglev_5dof_precise_limit(state->d + (gamma * nu), largest_disturbance);
    }
    const float rate_ahead = phi_rate + (T * (w_phi_before + phi_disturbance));
    state->q = maglev_5dof_precise_limit(phi_estimate + (half_T * (phi_rate + rate_ahead)), largest_position);
    state->v = maglev_5dof_precise_limit(rate_ahead, largest_rate);
    state->d = phi_disturbance;
    if (diagnostics != NULL) {
        diagnostics->phi_estimate = phi_estimate;
        diagnostics->phi_rate = phi_rate;
        diagnostics->phi_disturbance = phi_disturbance;
    }
}

typedef struct {
    float theta_disturbance;
    float theta_estimate;
    float theta_rate_if_ready;
} maglev_5dof_precise_observer_theta_t;

/* observer_theta: predictive observer, alpha-beta-gamma */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_observer_theta_t
    maglev_5dof_precise_observer_theta(maglev_5dof_precise_observer_state_t *state, uint32_t ready, float theta,
    float w_theta_before, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float gamma = 1445.947f;                       /* 1/s^2; triple pole exp(-w T), w = 120 rad/s */
    static const float largest_disturbance = 200.0f;            /* rad/s^2; bound of the disturbance */
    static const float alpha = 0.30232367f;                     /* 1; triple pole exp(-w T), w = 120 rad/s */
    static const float beta = 36.192043f;                       /* 1/s; triple pole exp(-w T), w = 120 rad/s */
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float T = 0.001f;                              /* s; sample period */
    static const float largest_position = 0.031f;               /* rad; bound of the prediction */
    static const float largest_rate = 4.0f;                     /* rad/s; bound of the predicted rate */

    const float q = state->q;
    const float nu = theta - q;
    const float theta_rate_if_ready = state->v + (beta * nu);
    float d_next = 0.0f;
    float theta_estimate = theta;
    float theta_rate = theta_rate_if_ready;
    if (ready != 0u) {
        d_next = maglev_5dof_precise_limit(state->d + (gamma * nu), largest_disturbance);
        theta_estimate = q + (alpha * nu);
    } else {
        theta_rate = 0.0f;
    }
    const float rate_ahead = theta_rate + (T * (w_theta_before + d_next));
    state->q = maglev_5dof_precise_limit(theta_estimate + (half_T * (theta_rate + rate_ahead)), largest_position);
    state->v = maglev_5dof_precise_limit(rate_ahead, largest_rate);
    state->d = d_next;
    if (diagnostics != NULL) {
        diagnostics->theta_disturbance = d_next;
        diagnostics->theta_estimate = theta_estimate;
        diagnostics->theta_rate = theta_rate;
    }
    return (maglev_5dof_precise_observer_theta_t){.theta_disturbance = d_next, .theta_estimate = theta_estimate,
        .theta_rate_if_ready = theta_rate_if_ready};
}

/* kinematics: pose from the gaps, F(5) */
MAGLEV_5DOF_PRECISE_INLINE float maglev_5dof_precise_kinematics_update(const maglev_5dof_precise_redundancy_output_2_t
    *redundancy_output_2, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    const float y_sum = redundancy_output_2->y1_held + redundancy_output_2->y2_held + redundancy_output_2->y3_held +
        redundancy_output_2->y4_held;
    if (diagnostics != NULL) {
        diagnostics->y = 0.25f * y_sum;
    }
    return 0.25f * y_sum;
}

typedef struct {
    float y_disturbance;
    float y_estimate;
    float y_rate;
} maglev_5dof_precise_observer_y_t;

/* observer_y: predictive observer, alpha-beta-gamma */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_observer_y_t
    maglev_5dof_precise_observer_y(maglev_5dof_precise_observer_state_t *state, uint32_t ready, float y,
    float w_y_before, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float gamma = 1445.947f;                       /* 1/s^2; triple pole exp(-w T), w = 120 rad/s */
    static const float largest_disturbance = 50.0f;             /* m/s^2; bound of the disturbance */
    static const float alpha = 0.30232367f;                     /* 1; triple pole exp(-w T), w = 120 rad/s */
    static const float beta = 36.192043f;                       /* 1/s; triple pole exp(-w T), w = 120 rad/s */
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float T = 0.001f;                              /* s; sample period */
    static const float largest_position = 0.0345f;              /* m; bound of the prediction */
    static const float least_position = 0.0145f;                /* m; bound of the prediction */
    static const float largest_rate = 4.0f;                     /* m/s; bound of the predicted rate */

    float d_next = 0.0f;
    float y_estimate = y;
    float y_rate = 0.0f;
    if (ready != 0u) {
        const float q = state->q;
        const float nu = y - q;
        d_next = maglev_5dof_precise_limit(state->d + (gamma * nu), largest_disturbance);
        y_estimate = q + (alpha * nu);
        y_rate = state->v + (beta * nu);
    }
    const float rate_ahead = y_rate + (T * (w_y_before + d_next));
    state->q = maglev_5dof_precise_max(maglev_5dof_precise_min(y_estimate + (half_T * (y_rate + rate_ahead)),
        largest_position), least_position);
    state->v = maglev_5dof_precise_limit(rate_ahead, largest_rate);
    state->d = d_next;
    if (diagnostics != NULL) {
        diagnostics->y_disturbance = d_next;
        diagnostics->y_estimate = y_estimate;
        diagnostics->y_rate = y_rate;
    }
    return (maglev_5dof_precise_observer_y_t){.y_disturbance = d_next, .y_estimate = y_estimate, .y_rate = y_rate};
}

typedef struct {
    float e_y;
    float e_x;
    float e_z;
    float e_phi;
    float e_theta;
} maglev_5dof_precise_errors_t;

/* errors: tracking errors, F(14) */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_errors_t maglev_5dof_precise_errors(float y,
    const maglev_5dof_precise_input_t *accepted, float x_held, float z_held,
    const maglev_5dof_precise_kinematics_output_t *kinematics_output, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    const float e_phi = kinematics_output->phi - accepted->phi_ref;
    const float e_theta = kinematics_output->theta - accepted->theta_ref;
    if (diagnostics != NULL) {
        diagnostics->e_y = y - accepted->y_ref;
        diagnostics->e_x = x_held - accepted->x_ref;
        diagnostics->e_z = z_held - accepted->z_ref;
        diagnostics->e_phi = e_phi;
        diagnostics->e_theta = e_theta;
    }
    return (maglev_5dof_precise_errors_t){.e_y = y - accepted->y_ref, .e_x = x_held - accepted->x_ref, .e_z = z_held -
        accepted->z_ref, .e_phi = e_phi, .e_theta = e_theta};
}

typedef struct {
    float y_fast_ahead;
    float y_fast_rate_ahead;
    float value;
} maglev_5dof_precise_observer_y_fast_t;

/* observer_y_fast: predictive observer, alpha-beta-gamma */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_observer_y_fast_t
    maglev_5dof_precise_observer_y_fast(maglev_5dof_precise_observer_state_t *state, uint32_t ready, float y,
    float w_y_before, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float alpha = 0.6988058f;                      /* 1; triple pole exp(-w T), w = 400 rad/s */
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float beta = 272.3178f;                        /* 1/s; triple pole exp(-w T), w = 400 rad/s */
    static const float T = 0.001f;                              /* s; sample period */
    static const float gamma = 35832.543f;                      /* 1/s^2; triple pole exp(-w T), w = 400 rad/s */
    static const float largest_disturbance = 50.0f;             /* m/s^2; bound of the disturbance */
    static const float largest_position = 0.0345f;              /* m; bound of the prediction */
    static const float least_position = 0.0145f;                /* m; bound of the prediction */
    static const float largest_rate = 4.0f;                     /* m/s; bound of the predicted rate */

    float y_fast_estimate = y;
    float y_fast_rate = 0.0f;
    float y_fast_disturbance = 0.0f;
    float value = 0.0f;
    if (ready != 0u) {
        const float q = state->q;
        const float nu = y - q;
        y_fast_estimate = q + (alpha * nu);
        y_fast_rate = state->v + (beta * nu);
        const float y_fast_disturbance_if_ready = maglev_5dof_precise_limit(state->d + (gamma * nu),
            largest_disturbance);
        y_fast_disturbance = y_fast_disturbance_if_ready;
        value = y_fast_disturbance_if_ready;
    }
    const float rate_ahead = y_fast_rate + (T * (w_y_before + y_fast_disturbance));
    state->q = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_estimate + (half_T * (y_fast_rate + rate_ahead)),
        largest_position), least_position);
    state->v = maglev_5dof_precise_limit(rate_ahead, largest_rate);
    state->d = y_fast_disturbance;
    if (diagnostics != NULL) {
        diagnostics->y_fast_estimate = y_fast_estimate;
        diagnostics->y_fast_rate = y_fast_rate;
        diagnostics->y_fast_disturbance = y_fast_disturbance;
        diagnostics->y_fast_ahead = state->q;
        diagnostics->y_fast_rate_ahead = state->v;
        diagnostics->saturated |= (fabsf(state->v) >= largest_rate) ? 0x00000001u : 0u;
    }
    return (maglev_5dof_precise_observer_y_fast_t){.y_fast_ahead = state->q, .y_fast_rate_ahead = state->v,
        .value = value};
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

/* servo_y_fast, servo_x_fast, servo_z_fast, servo_theta_fast: predictive servo with internal models */
MAGLEV_5DOF_PRECISE_LARGE float maglev_5dof_precise_servo_fast(maglev_5dof_precise_servo_fast_state_t *state,
    const maglev_5dof_precise_servo_fast_parameters_t *parameters, float fast_ahead, float ref_held,
    float fast_rate_ahead, uint32_t ready, float w_y_tracking_choice, float e)
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
    float step_feedforward = 0.0f;
    if (fabsf(moved) <= parameters->largest_step) {
        step_feedforward = parameters->k_step * moved;
    }
    const float feedback = (parameters->k_e * (fast_ahead - ref_held)) + (parameters->k_de * fast_rate_ahead) -
        step_feedforward + (parameters->k_sum * sum) + (parameters->k_p1 * p1) + (parameters->k_q1 * q1) +
        (parameters->k_p2 * p2) + (parameters->k_q2 * q2) + (parameters->k_p3 * p3) + (parameters->k_q3 * q3);
    float cancellation = 0.0f;
    if (ready != 0u) {
        cancellation = cancelled * w_y_tracking_choice;
    }
    return feedback - cancellation;
}

typedef struct {
    float alpha;                        /* 1; triple pole exp(-w T), w = 400 rad/s */
    float beta;                         /* 1/s; triple pole exp(-w T), w = 400 rad/s */
    float gamma;                        /* 1/s^2; triple pole exp(-w T), w = 400 rad/s */
    float low;                          /* minus the upper end of a limit */
    float largest_disturbance;          /* m/s^2; bound of the disturbance */
    float low_2;                        /* minus the upper end of a limit */
    float largest_position;             /* m; bound of the prediction */
    float low_3;                        /* minus the upper end of a limit */
    float largest_rate;                 /* m/s; bound of the predicted rate */
} maglev_5dof_precise_observer_fast_parameters_t;

typedef struct {
    float fast_ahead;
    float fast_rate_ahead;
    float value;
} maglev_5dof_precise_observer_fast_t;

/* observer_x_fast, observer_z_fast, observer_phi_fast, observer_theta_fast: predictive observer, alpha-beta-gamma */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_observer_fast_t
    maglev_5dof_precise_observer_fast(maglev_5dof_precise_observer_state_t *state, const
    maglev_5dof_precise_observer_fast_parameters_t *parameters, uint32_t ready, float x_held_if_not_ready, float before)
{
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float T = 0.001f;                              /* s; sample period */

    float x_fast_estimate = x_held_if_not_ready;
    float x_fast_rate = 0.0f;
    float x_fast_disturbance = 0.0f;
    float value = 0.0f;
    if (ready != 0u) {
        const float q = state->q;
        const float nu = x_held_if_not_ready - q;
        x_fast_estimate = q + (parameters->alpha * nu);
        x_fast_rate = state->v + (parameters->beta * nu);
        const float x_fast_disturbance_if_ready = maglev_5dof_precise_limit(state->d + (parameters->gamma * nu),
            parameters->largest_disturbance);
        x_fast_disturbance = x_fast_disturbance_if_ready;
        value = x_fast_disturbance_if_ready;
    }
    const float rate_ahead = x_fast_rate + (T * (before + x_fast_disturbance));
    state->q = maglev_5dof_precise_limit(x_fast_estimate + (half_T * (x_fast_rate + rate_ahead)),
        parameters->largest_position);
    state->v = maglev_5dof_precise_limit(rate_ahead, parameters->largest_rate);
    state->d = x_fast_disturbance;
    return (maglev_5dof_precise_observer_fast_t){.fast_ahead = state->q, .fast_rate_ahead = state->v, .value = value};
}

/* servo_phi_fast: predictive servo with internal models */
MAGLEV_5DOF_PRECISE_INLINE float maglev_5dof_precise_servo_phi_fast(maglev_5dof_precise_servo_phi_fast_state_t *state,
    const maglev_5dof_precise_observer_fast_t *observer_phi_fast, float phi_ref_held, uint32_t ready, float e_phi,
    maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float k_e = -711.21704f; /* 1/s^2; predictive servo with internal models: gain on e */
    static const float k_de = -80.14009f; /* 1/s; predictive servo with internal models: gain on de */
    /* rad; a larger error counts as this in the internal models; a larger change of the set-point has no rate; of
     * error, step */
    static const float largest = 1e-04f;
    static const float k_step = -80140.09f; /* 1/s^2; predictive servo with internal models: k_de over the period */
    static const float k_sum = -1.264911f; /* 1/s^2; predictive servo with internal models: gain on sum */
    static const float k_p1 = 16.527708f; /* 1/s^2; predictive servo with internal models: gain on p1 */
    static const float k_q1 = -1.2623228f; /* 1/s^2; predictive servo with internal models: gain on q1 */
    static const float cancelled = 0.8f;                        /* 1; part of the disturbance that is cancelled */
    /* 1; predictive servo with internal models: 2 - 2 cos(w T), w T = 0.00471239 */
    static const float c1 = 2.2206568e-05f;

    const float sum = state->sum;
    const float e = maglev_5dof_precise_limit(e_phi, largest);
    const float sum_next = sum + e;
    const float p1 = state->p1;
    const float q1 = state->q1;
    const float p1_next = p1 + (c1 * q1);
    const float q1_next = q1 - p1_next + e;
    if (((sum_next * sum_next) + (p1_next * p1_next) + (q1_next * q1_next)) <= 16.0f) {
        /*@ admit -4.0000005f <= sum_next <= 4.0000005f; */
        /*@ admit -4.0000005f <= p1_next <= 4.0000005f; */
        /*@ admit -4.0000005f <= q1_next <= 4.0000005f; */
        state->sum = sum_next;
        state->p1 = p1_next;
        state->q1 = q1_next;
    }
    const float r_2 = state->r;
    state->r = phi_ref_held;
    const float moved = phi_ref_held - r_2;
    float step_feedforward = 0.0f;
    if (fabsf(moved) <= largest) {
        step_feedforward = k_step * moved;
    }
    const float feedback = (k_e * (observer_phi_fast->fast_ahead - phi_ref_held)) +
        (k_de * observer_phi_fast->fast_rate_ahead) - step_feedforward + (k_sum * sum) + (k_p1 * p1) + (k_q1 * q1);
    float cancellation = 0.0f;
    if (ready != 0u) {
        cancellation = cancelled * observer_phi_fast->value;
    }
    if (diagnostics != NULL) {
        diagnostics->w_phi_tracking = feedback - cancellation;
    }
    return feedback - cancellation;
}

typedef struct {
    float w_phi;
    float w_theta;
    float w_x_unprobed;
    float w_y;
    float w_z_unprobed;
    uint32_t landing_next;
} maglev_5dof_precise_landing_t;

/* landing: ramps and state feedback
 * No integrator takes part, so nothing winds up: the disturbance of the observer does its work. */
MAGLEV_5DOF_PRECISE_LARGE maglev_5dof_precise_landing_t maglev_5dof_precise_landing(maglev_5dof_precise_landing_state_t
    *state, const maglev_5dof_precise_redundancy_update_t *redundancy_update, uint32_t ready, float phi,
    float w_phi_tracking, const maglev_5dof_precise_observer_theta_t *observer_theta, float w_theta_tracking, const
    maglev_5dof_precise_observer_t *observer_x, float w_x_tracking, const maglev_5dof_precise_observer_y_t *observer_y,
    float w_y_tracking, const maglev_5dof_precise_observer_t *observer_z, float w_z_tracking,
    maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const uint32_t good_per_bad = 4u;                    /* 1; good samples that make up for a bad one */
    static const float spring_phi = 11250.0f;                   /* 1/s^2; 0.75 k_s_phi, k_s_phi = 15000 1/s^2 */
    static const float pole_theta = 40.0f;                      /* 1/s; levelling by measurements */
    static const float predicted_pole_theta = 14.0f;            /* 1/s; levelling by predictions */
    static const float stiffness = 900.0f;                      /* 1/s^2; p^2, p = 30 1/s; of x, z */
    static const float damping = 60.0f;                         /* 1/s; 2 p, p = 30 1/s; of x, z */
    static const float ramp_rate_bound = 10.0f; /* m/s; bound of the ramp's rate: wider than any estimate; of y, x, z */
    static const float inverse_T = 1000.0f;                     /* 1/s; 1 / sample period */
    static const float acceleration = 4.0f;                     /* m/s^2; largest one of the ramp; of x, z */
    static const float stiffness_y = 3600.0f;                   /* 1/s^2; p^2, p = 60 1/s */
    static const float ramp_end = 0.0326f;                      /* m; bound of the ramp: it is over before */
    static const float damping_y = 120.0f;                      /* 1/s; 2 p, p = 60 1/s */
    static const float touch_speed = 0.005f;                    /* m/s; speed of the ramp at the stop */
    static const float approach = 25.0f;                        /* 1/s; acceleration over largest speed */
    static const float stop = 0.031f;                           /* m; gap of the stop on which it lands */
    static const float largest_speed = 0.08f;                   /* m/s; largest speed of the ramp */
    static const float press_speed = 0.001f;                    /* m/s; least speed of the ramp, behind the stop */
    static const float acceleration_y = 2.0f;                   /* m/s^2; largest one of the ramp */
    static const uint32_t patience = 20u; /* 1; samples in a row with a prediction until it lands, times 4 */
    static const float half_T = 0.0005f;                        /* s; half the sample period */
    static const float acceleration_step_y = 0.002f;            /* m/s; T times 2 m/s^2 of the ramp */
    static const float bound = 0.5f; /* m; of the ramp: wider than any estimate; of y, x, z */
    static const float acceleration_step = 0.004f;              /* m/s; T times 4 m/s^2 of the ramp; of x, z */

    const uint32_t left = state->left;
    const bool waiting = !redundancy_update->regular && (ready != 0u);
    const bool left_at_most_4 = left <= good_per_bad;
    if (waiting) {
        if (!left_at_most_4) {
            state->left = left - good_per_bad;
        }
    } else {
        if (left < patience) {
            state->left = left + 1u;
        }
    }
    const uint32_t landing = state->landing;
    uint32_t landing_2 = 1u;
    if (waiting && left_at_most_4) {
        state->landing = 1u;
    } else {
        landing_2 = landing;
    }
    float w_phi = w_phi_tracking;
    float w_theta = w_theta_tracking;
    float w_x_unprobed = w_x_tracking;
    float w_y = w_y_tracking;
    float w_z_unprobed = w_z_tracking;
    if (landing_2 != 0u) {
        const float levelling_pole_theta = (redundancy_update->theta_measured) ? pole_theta : predicted_pole_theta;
        float damping_theta = 0.0f;
        if (ready != 0u) {
            damping_theta = 2.0f * (levelling_pole_theta * observer_theta->theta_rate_if_ready);
        }
        w_theta = -((levelling_pole_theta * levelling_pole_theta * observer_theta->theta_estimate) + damping_theta +
            observer_theta->theta_disturbance);
        const float y_estimate_min_ramp_end = maglev_5dof_precise_min(observer_y->y_estimate, ramp_end);
        float ramp_x = observer_x->estimate;
        float ramp_rate_x;
        float ramp_y = y_estimate_min_ramp_end;
        float ramp_rate_y = observer_y->y_rate;
        float ramp_z = observer_z->estimate;
        float ramp_rate_z;
        if (landing != 0u) {
            ramp_x = state->r_x;
            ramp_rate_x = state->dr_x;
            ramp_y = state->r_y;
            ramp_rate_y = state->dr_y;
            ramp_z = state->r_z;
            ramp_rate_z = state->dr_z;
        } else {
            ramp_rate_x = maglev_5dof_precise_limit(observer_x->rate, ramp_rate_bound);
            ramp_rate_z = maglev_5dof_precise_limit(observer_z->rate, ramp_rate_bound);
        }
        w_x_unprobed = (stiffness * (ramp_x - observer_x->estimate)) + (damping * (ramp_rate_x - observer_x->rate)) +
            (maglev_5dof_precise_limit(-inverse_T * ramp_rate_x, acceleration) - observer_x->disturbance);
        w_z_unprobed = (stiffness * (ramp_z - observer_z->estimate)) + (damping * (ramp_rate_z - observer_z->rate)) +
            (maglev_5dof_precise_limit(-inverse_T * ramp_rate_z, acceleration) - observer_z->disturbance);
        const float ramp_rate_next_x = maglev_5dof_precise_slew(ramp_rate_x, 0.0f, acceleration_step);
        state->dr_x = ramp_rate_next_x;
        const float ramp_target_y = maglev_5dof_precise_max(maglev_5dof_precise_min(touch_speed +
            (approach * (stop - ramp_y)), largest_speed), press_speed);
        const float w_y_sum = maglev_5dof_precise_limit(inverse_T * (ramp_target_y - ramp_rate_y), acceleration_y) -
            observer_y->y_disturbance;
        w_y = (stiffness_y * (ramp_y - observer_y->y_estimate)) + (damping_y * (ramp_rate_y - observer_y->y_rate)) +
            w_y_sum;
        const float ramp_rate_next_y = maglev_5dof_precise_slew(ramp_rate_y, ramp_target_y, acceleration_step_y);
        state->dr_y = ramp_rate_next_y;
        const float ramp_rate_next_z = maglev_5dof_precise_slew(ramp_rate_z, 0.0f, acceleration_step);
        if (landing != 0u) {
            state->r_y = maglev_5dof_precise_max(maglev_5dof_precise_min(ramp_y +
                (half_T * (ramp_rate_y + ramp_rate_next_y)), ramp_end), -bound);
            state->r_x = maglev_5dof_precise_limit(ramp_x + (half_T * (ramp_rate_x + ramp_rate_next_x)), bound);
            state->r_z = maglev_5dof_precise_limit(ramp_z + (half_T * (ramp_rate_z + ramp_rate_next_z)), bound);
        } else {
            state->r_y = y_estimate_min_ramp_end;
            state->r_x = observer_x->estimate;
            state->r_z = observer_z->estimate;
        }
        state->dr_z = ramp_rate_next_z;
        w_phi = -spring_phi * phi;
    }
    if (diagnostics != NULL) {
        diagnostics->w_phi = w_phi;
        diagnostics->w_theta = w_theta;
        diagnostics->w_x_unprobed = w_x_unprobed;
        diagnostics->w_y = w_y;
        diagnostics->w_z_unprobed = w_z_unprobed;
    }
    return (maglev_5dof_precise_landing_t){.w_phi = w_phi, .w_theta = w_theta, .w_x_unprobed = w_x_unprobed, .w_y = w_y,
        .w_z_unprobed = w_z_unprobed, .landing_next = landing_2};
}

/* probe_x, probe_z: probe at rest */
MAGLEV_5DOF_PRECISE_INLINE float maglev_5dof_precise_probe(maglev_5dof_precise_probe_state_t *state, uint32_t unchanged,
    float w_unprobed, bool free, float e)
{
    static const uint32_t first_push_end = 1u;                  /* 1; last sample of the first push of a pair */
    static const uint32_t quiet_samples = 12u;                  /* 1; without a change of the code until it probes */
    static const uint32_t last_push_end = 4u;                   /* 1; last sample of the second push */
    static const uint32_t reverse_push_end = 3u;                /* 1; last sample of the push to the other side */
    static const uint32_t pair_samples = 7u;                    /* 1; of a pair with its answer */
    static const uint32_t most_attempts = 8u;                   /* 1; pairs without an answer: the sensor is frozen */
    /* m/s^2; acceleration of the first pair, which moves the body by 2.2e-06 m and back in 4 samples */
    static const float first_push = 2.2f;

    const uint32_t sample = state->sample;
    const bool runs = first_push_end <= sample;
    float w = w_unprobed;
    if (runs || (quiet_samples <= unchanged)) {
        const uint32_t attempt = state->attempt;
        const float towards = state->towards;
        if (runs) {
            float pulse = 0.0f;
            if (sample <= last_push_end) {
                const float push = towards * ((0.5f * (float)attempt) + 1.0f);
                pulse = ((first_push_end < sample) && (sample <= reverse_push_end)) ? -push : push;
            }
            w = w_unprobed + pulse;
            if (pair_samples <= sample) {
                state->sample = 0u;
                if (pair_samples <= unchanged) {
                    if (attempt < most_attempts) {
                        state->attempt = attempt + 1u;
                    }
                } else {
                    state->attempt = 0u;
                }
                state->towards = -towards;
            } else {
                state->sample = sample + first_push_end;
            }
        } else {
            state->sample = maglev_5dof_precise_flag(free);
            if (attempt < 1u) {
                state->towards = (0.0f < e) ? -first_push : first_push;
            }
        }
    } else {
        state->sample = 0u;
        state->attempt = 0u;
    }
    return w;
}

typedef struct {
    float i_d1_balanced;
    float i_d2_balanced;
    float i_d3_balanced;
    float i_d4_balanced;
    float u_x_computed;
    float u_z_computed;
    float a_x;
    float a_z;
} maglev_5dof_precise_inversion_t;

/* inversion: exact inversion of F(2), (6), (7) */
MAGLEV_5DOF_PRECISE_LARGE maglev_5dof_precise_inversion_t
    maglev_5dof_precise_inversion(const maglev_5dof_precise_landing_t *landing, float y_fast_ahead,
    float phi_fast_ahead, float w_z, float theta_fast_ahead, float w_x, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float slot_pull = 1.530832e-06f;               /* m/N; half_c_over_h2 beta, beta = b0^2 / (4 t1) */
    static const float r = 0.397f;                              /* m; Table I */
    static const float highest_y2_held = 0.0366f;               /* m; end of its range; also highest_y4_held */
    static const float lowest_y2_held = 0.0124f;                /* m; end of its range; also lowest_y4_held */
    static const float gap_offset = 0.009233333f;               /* m; b0/2 + h_m/mu_rec - beta, beta = b0^2 / (4 t1) */
    /* 1; 4 a c = 16 half_a half_c; b^2 = h^2 + 4 a c as coth^2 = 1 + 1/sinh^2 in (2)-(4) */
    static const float discriminant_factor = 16.0f;
    /* 1/N; K_v3 / (2 K_h^2) of (2): half_c / h^2 without the effect of the slots */
    static const float half_c_over_h2 = 0.0007232277f;
    static const float half_M_y = 3.45f;                        /* kg; M_y / 2, M_y = 6.9 kg */
    static const float G = 9.81f;                               /* m/s^2; standard gravity to three digits */
    static const float highest_y1_held = 0.0322f;               /* m; end of its range; also highest_y3_held */
    static const float lowest_y1_held = 0.0168f;                /* m; end of its range; also lowest_y3_held */
    static const float M_z = 8.6f;                              /* kg; Table I */
    static const float current_limit = 4.9497476f;              /* A; largest current of a motor, rms: 7 A peak */
    static const float M_x = 10.6f;                             /* kg; Table I */
    /* kg m/rad; I_x / (2 r), r = 0.397 m, I_x = 0.5268 kg m^2/rad; I_z / (2 r), r = 0.397 m, I_z = 0.5268 kg m^2/rad;
     * of x, z */
    static const float half_I_over_r = 0.66347605f;
    static const float compensated_k_s_theta = 2850.0f;         /* 1/s^2; 0.95 k_s_theta, k_s_theta = 3000 1/s^2 */
    static const float compensated_k_s_phi = 11250.0f;          /* 1/s^2; 0.75 k_s_phi, k_s_phi = 15000 1/s^2 */
    static const float direct_limit = 4.9492526f; /* A; largest direct current, rms: a little below the current limit */
    static const float squared_current_limit = 24.5f;           /* A^2; square of the current limit, 7 A peak */
    static const float inverse_M_x = 0.094339624f;              /* 1/kg; 1 / M_x, M_x = 10.6 kg */
    static const float inverse_M_z = 0.11627907f;               /* 1/kg; 1 / M_z, M_z = 8.6 kg */

    const float tilts_3 = r * phi_fast_ahead;
    const float thrust_per_ampere_1_sum = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_ahead - tilts_3,
        highest_y1_held), lowest_y1_held) + gap_offset;
    const float thrust_per_ampere_1_quotient = slot_pull / thrust_per_ampere_1_sum;
    const float thrust_per_ampere_1_argument = thrust_per_ampere_1_quotient - 4.196167e-05f;
    const float thrust_per_ampere_1 = thrust_per_ampere_polynomial(thrust_per_ampere_1_argument);
    const float thrust_per_ampere_1_squared = thrust_per_ampere_1 * thrust_per_ampere_1;
    const float half_a_over_h2_1 = half_a_over_h2_polynomial(thrust_per_ampere_1_argument);
    const float motors_1_half_a = thrust_per_ampere_1_squared * half_a_over_h2_1;
    const float motors_1_half_c = thrust_per_ampere_1_squared * (half_c_over_h2 + thrust_per_ampere_1_quotient);
    const float thrust_per_ampere_3_sum = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_ahead + tilts_3,
        highest_y1_held), lowest_y1_held) + gap_offset;
    const float thrust_per_ampere_3_quotient = slot_pull / thrust_per_ampere_3_sum;
    const float thrust_per_ampere_3_argument = thrust_per_ampere_3_quotient - 4.196167e-05f;
    const float thrust_per_ampere_3 = thrust_per_ampere_polynomial(thrust_per_ampere_3_argument);
    const float h_z = thrust_per_ampere_1 + thrust_per_ampere_3;
    const float u_z_demand = -M_z * w_z / h_z;
    const float i_q_1_3 = maglev_5dof_precise_limit(u_z_demand, current_limit);
    const float i_q_1_3_squared = i_q_1_3 * i_q_1_3;
    const float half_1 = motors_1_half_a + (motors_1_half_c * i_q_1_3_squared);
    const float tilts_2 = r * theta_fast_ahead;
    const float thrust_per_ampere_2_sum = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_ahead + tilts_2,
        highest_y2_held), lowest_y2_held) + gap_offset;
    const float thrust_per_ampere_2_quotient = slot_pull / thrust_per_ampere_2_sum;
    const float thrust_per_ampere_2_argument = 16384.0f * (thrust_per_ampere_2_quotient - 3.4332275e-05f);
    const float thrust_per_ampere_2 = thrust_per_ampere_2_polynomial(thrust_per_ampere_2_argument);
    const float thrust_per_ampere_2_squared = thrust_per_ampere_2 * thrust_per_ampere_2;
    const float half_a_over_h2_2 = half_a_over_h2_2_polynomial(thrust_per_ampere_2_argument);
    const float motors_2_half_a = thrust_per_ampere_2_squared * half_a_over_h2_2;
    const float motors_2_half_c = thrust_per_ampere_2_squared * (half_c_over_h2 + thrust_per_ampere_2_quotient);
    const float thrust_per_ampere_4_sum = maglev_5dof_precise_max(maglev_5dof_precise_min(y_fast_ahead - tilts_2,
        highest_y2_held), lowest_y2_held) + gap_offset;
    const float thrust_per_ampere_4_quotient = slot_pull / thrust_per_ampere_4_sum;
    const float thrust_per_ampere_4_argument = 16384.0f * (thrust_per_ampere_4_quotient - 3.4332275e-05f);
    const float thrust_per_ampere_4 = thrust_per_ampere_2_polynomial(thrust_per_ampere_4_argument);
    const float h_x = thrust_per_ampere_2 + thrust_per_ampere_4;
    const float u_x_demand = -M_x * w_x / h_x;
    const float i_q_2_4 = maglev_5dof_precise_limit(u_x_demand, current_limit);
    const float i_q_2_4_squared = i_q_2_4 * i_q_2_4;
    const float half_2 = motors_2_half_a + (motors_2_half_c * i_q_2_4_squared);
    const float thrust_per_ampere_3_squared = thrust_per_ampere_3 * thrust_per_ampere_3;
    const float half_a_over_h2_3 = half_a_over_h2_polynomial(thrust_per_ampere_3_argument);
    const float motors_3_half_a = thrust_per_ampere_3_squared * half_a_over_h2_3;
    const float motors_3_half_c = thrust_per_ampere_3_squared * (half_c_over_h2 + thrust_per_ampere_3_quotient);
    const float half_3 = motors_3_half_a + (motors_3_half_c * i_q_1_3_squared);
    const float thrust_per_ampere_4_squared = thrust_per_ampere_4 * thrust_per_ampere_4;
    const float half_a_over_h2_4 = half_a_over_h2_2_polynomial(thrust_per_ampere_4_argument);
    const float motors_4_half_a = thrust_per_ampere_4_squared * half_a_over_h2_4;
    const float motors_4_half_c = thrust_per_ampere_4_squared * (half_c_over_h2 + thrust_per_ampere_4_quotient);
    const float half_4 = motors_4_half_a + (motors_4_half_c * i_q_2_4_squared);
    const float half_force = (half_M_y * (landing->w_y - G)) + (half_1 + half_2 + half_3 + half_4);
    const float half_force_phi = (half_I_over_r * (landing->w_phi + (compensated_k_s_phi * phi_fast_ahead))) +
        (half_3 - half_1);
    const float half_force_theta = (half_I_over_r * (landing->w_theta + (compensated_k_s_theta * theta_fast_ahead))) +
        (half_2 - half_4);
    const float squares_2 = thrust_per_ampere_2_squared + (discriminant_factor * (motors_2_half_a * motors_2_half_c));
    const float s2 = 1.0f / squares_2;
    const float squares_4 = thrust_per_ampere_4_squared + (discriminant_factor * (motors_4_half_a * motors_4_half_c));
    const float s4 = 1.0f / squares_4;
    const float s2_plus_s4 = s2 + s4;
    const float squares_3 = thrust_per_ampere_3_squared + (discriminant_factor * (motors_3_half_a * motors_3_half_c));
    const float s3 = 1.0f / squares_3;
    const float squares_1 = thrust_per_ampere_1_squared + (discriminant_factor * (motors_1_half_a * motors_1_half_c));
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
    if (diagnostics != NULL) {
        diagnostics->i_d1_balanced = i_d1_balanced;
        diagnostics->i_d2_balanced = i_d2_balanced;
        diagnostics->i_d3_balanced = i_d3_balanced;
        diagnostics->i_d4_balanced = i_d4_balanced;
        diagnostics->a_x = -inverse_M_x * (u_x_computed * h_x);
        diagnostics->a_z = -inverse_M_z * (u_z_computed * h_z);
        diagnostics->saturated |= (fabsf(i_d1_balanced) >= direct_limit) ? 0x00000200u : 0u;
        diagnostics->saturated |= (fabsf(i_d2_balanced) >= direct_limit) ? 0x00000400u : 0u;
        diagnostics->saturated |= (fabsf(i_d3_balanced) >= direct_limit) ? 0x00000800u : 0u;
        diagnostics->saturated |= (fabsf(i_d4_balanced) >= direct_limit) ? 0x00001000u : 0u;
        diagnostics->saturated |= (fabsf(u_x_computed) >= sqrtf(u_x_computed_radicand)) ? 0x00002000u : 0u;
        diagnostics->saturated |= (fabsf(u_z_computed) >= sqrtf(u_z_computed_radicand)) ? 0x00004000u : 0u;
    }
    return (maglev_5dof_precise_inversion_t){.i_d1_balanced = i_d1_balanced, .i_d2_balanced = i_d2_balanced,
        .i_d3_balanced = i_d3_balanced, .i_d4_balanced = i_d4_balanced, .u_x_computed = u_x_computed, .u_z_computed =
        u_z_computed, .a_x = -inverse_M_x * (u_x_computed * h_x), .a_z = -inverse_M_z * (u_z_computed * h_z)};
}

typedef struct {
    float i_d1_computed;
    float i_d2_computed;
    float i_d3_computed;
    float i_d4_computed;
} maglev_5dof_precise_handover_t;

/* handover: direct currents without x or z; meanwhile |i_d| + |i_q| of a motor is limited, at once
 * Thrust has priority over lift: an i_d that repels drives the platen along the lost axis, away from an angle that
 * is predicted or stale, where i_q only loses the cosine of the error. So i_d fades out of the motors along that
 * axis, and is cut where i_q leaves no room.
 * Without the direct currents along X the guide spring alone holds theta. At gaps below held_by_spring it is weaker
 * than the magnets, so there the handover along X waits for the landing to lower the platen.
 * The limit of |i_d| + |i_q| needs no square root and holds from the first sample on: there i_d may be cut at once,
 * at most from 3.5 A to 1.45 A beside 3.5 A of thrust. */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_handover_t
    maglev_5dof_precise_handover(maglev_5dof_precise_handover_state_t *state, bool lost_x, bool lost_z,
    float y_expected, bool x_trusted, bool z_trusted, const maglev_5dof_precise_inversion_t *inversion)
{
    static const float held_by_spring = 0.022f;                 /* m; at smaller gaps theta needs the motors along X */
    static const float fade_step = 0.04f; /* 1; 1 / 25: a handover, and a fade, takes 25 samples */
    static const float current_limit = 4.9497476f;              /* A; largest current of a motor, rms: 7 A peak */

    const float transfer = state->transfer;
    float i_d1_computed = inversion->i_d1_balanced;
    float i_d2_computed = inversion->i_d2_balanced;
    float i_d3_computed = inversion->i_d3_balanced;
    float i_d4_computed = inversion->i_d4_balanced;
    if (lost_x || lost_z || (0.0f < (transfer * transfer))) {
        const float target = (lost_x && (lost_z || (y_expected < held_by_spring))) ? transfer :
            ((x_trusted) ? ((z_trusted) ? 0.0f : -1.0f) : 1.0f);
        const float faded_transfer = maglev_5dof_precise_slew(transfer, target, fade_step);
        state->transfer = faded_transfer;
        const bool of_x = 0.0f < faded_transfer;
        const float part = fabsf(faded_transfer);
        const float part_x = (of_x) ? part : 0.0f;
        const float part_z = (of_x) ? 0.0f : part;
        const float handed_x = 0.5f * (part_z * (inversion->i_d1_balanced + inversion->i_d3_balanced));
        const float room_x = current_limit - fabsf(inversion->u_x_computed);
        const float remainder_x = 1.0f - part_x;
        i_d2_computed = remainder_x * maglev_5dof_precise_limit(inversion->i_d2_balanced + handed_x, room_x);
        i_d4_computed = remainder_x * maglev_5dof_precise_limit(inversion->i_d4_balanced + handed_x, room_x);
        const float handed_z = 0.5f * (part_x * (inversion->i_d2_balanced + inversion->i_d4_balanced));
        const float room_z = current_limit - fabsf(inversion->u_z_computed);
        const float remainder_z = 1.0f - part_z;
        i_d1_computed = remainder_z * maglev_5dof_precise_limit(inversion->i_d1_balanced + handed_z, room_z);
        i_d3_computed = remainder_z * maglev_5dof_precise_limit(inversion->i_d3_balanced + handed_z, room_z);
    }
    return (maglev_5dof_precise_handover_t){.i_d1_computed = i_d1_computed, .i_d2_computed = i_d2_computed,
        .i_d3_computed = i_d3_computed, .i_d4_computed = i_d4_computed};
}

typedef struct {
    float x_commutation;
    float z_commutation;
} maglev_5dof_precise_angles_t;

/* angles: positions for the commutation */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_angles_t maglev_5dof_precise_angles(uint32_t latched, bool lost_x,
    float x_held, bool lost_z, float z_held)
{
    static const float not_known = 0.2f;                        /* m; outside the range of x and z: it is lost */

    return (maglev_5dof_precise_angles_t){.x_commutation = ((latched != 0u) && lost_x) ? not_known : x_held,
        .z_commutation = ((latched != 0u) && lost_z) ? not_known : z_held};
}

typedef struct {
    float last_i_d1_next;
    float last_i_d2_next;
    float last_i_d3_next;
    float last_i_d4_next;
    float last_u_x_next;
    float last_u_z_next;
} maglev_5dof_precise_safe_output_latched_t;

/* safe_output: slew to the safe output once latched */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_safe_output_latched_t maglev_5dof_precise_safe_output_latched(bool rests,
    float i_d1_before, float i_d2_before, float i_d3_before, float i_d4_before, float u_x_before, float u_z_before)
{
    static const float safe_i_d = 2.5f;                         /* A; safe output */
    static const float slew_step = 0.1f;                        /* A; 100 A/s times 0.001 s */

    const float target_i_d = (rests) ? 0.0f : safe_i_d;
    return (maglev_5dof_precise_safe_output_latched_t){.last_i_d1_next = maglev_5dof_precise_slew(i_d1_before,
        target_i_d, slew_step), .last_i_d2_next = maglev_5dof_precise_slew(i_d2_before, target_i_d, slew_step),
        .last_i_d3_next = maglev_5dof_precise_slew(i_d3_before, target_i_d, slew_step),
        .last_i_d4_next = maglev_5dof_precise_slew(i_d4_before, target_i_d, slew_step),
        .last_u_x_next = maglev_5dof_precise_slew(u_x_before, 0.0f, slew_step),
        .last_u_z_next = maglev_5dof_precise_slew(u_z_before, 0.0f, slew_step)};
}

/* Each input in its range, else what is held or refused, with its bit of the fault word. */
MAGLEV_5DOF_PRECISE_INLINE maglev_5dof_precise_input_t maglev_5dof_precise_guard_inputs(maglev_5dof_precise_state_t
    *state, const maglev_5dof_precise_input_t *in, uint32_t *faults)
{
    maglev_5dof_precise_input_t accepted;
    accepted.missed_calls = in->missed_calls;
    accepted.y1 = maglev_5dof_precise_hold(in->y1, 0.0168f, 0.0322f, &state->guard.last_y1, 0x00000001u, faults);
    accepted.y2 = maglev_5dof_precise_hold(in->y2, 0.0124f, 0.0366f, &state->guard.last_y2, 0x00000002u, faults);
    accepted.y3 = maglev_5dof_precise_hold(in->y3, 0.0168f, 0.0322f, &state->guard.last_y3, 0x00000004u, faults);
    accepted.y4 = maglev_5dof_precise_hold(in->y4, 0.0124f, 0.0366f, &state->guard.last_y4, 0x00000008u, faults);
    accepted.x = maglev_5dof_precise_hold_within(in->x, 0.1f, &state->guard.last_x, 0x00000010u, faults);
    accepted.z = maglev_5dof_precise_hold_within(in->z, 0.1f, &state->guard.last_z, 0x00000020u, faults);
    accepted.y_ref = maglev_5dof_precise_hold(in->y_ref, 0.01805f, 0.03095f, &state->guard.last_y_ref, 0x00000040u,
        faults);
    accepted.x_ref = maglev_5dof_precise_hold_within(in->x_ref, 0.04995f, &state->guard.last_x_ref, 0x00000080u,
        faults);
    accepted.z_ref = maglev_5dof_precise_hold_within(in->z_ref, 0.04995f, &state->guard.last_z_ref, 0x00000100u,
        faults);
    accepted.phi_ref = maglev_5dof_precise_hold_within(in->phi_ref, 0.0028740554f, &state->guard.last_phi_ref,
        0x00000200u, faults);
    accepted.theta_ref = maglev_5dof_precise_hold_within(in->theta_ref, 0.013874056f, &state->guard.last_theta_ref,
        0x00000400u, faults);
    return accepted;
}

/* what the step does once it is latched */
MAGLEV_5DOF_PRECISE_INLINE uint32_t maglev_5dof_precise_latched(maglev_5dof_precise_state_t *state, bool landed, float
    y, uint32_t faults_before_2, maglev_5dof_precise_output_t *out, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float rests_beyond = 0.0305f; /* m; beyond it, once landed, the body lies on the stop */

    uint32_t fault_word;

    const bool rests = landed && (rests_beyond <= y);
    const maglev_5dof_precise_safe_output_latched_t safe_output_latched = maglev_5dof_precise_safe_output_latched(rests,
        state->safe_output_last_i_d1, state->safe_output_last_i_d2, state->safe_output_last_i_d3,
        state->safe_output_last_i_d4, state->safe_output_last_u_x, state->safe_output_last_u_z);
    state->safe_output_last_i_d1 = safe_output_latched.last_i_d1_next;
    out->i_d1 = safe_output_latched.last_i_d1_next;
    state->safe_output_last_i_d2 = safe_output_latched.last_i_d2_next;
    out->i_d2 = safe_output_latched.last_i_d2_next;
    state->safe_output_last_i_d3 = safe_output_latched.last_i_d3_next;
    out->i_d3 = safe_output_latched.last_i_d3_next;
    state->safe_output_last_i_d4 = safe_output_latched.last_i_d4_next;
    out->i_d4 = safe_output_latched.last_i_d4_next;
    state->safe_output_last_u_x = safe_output_latched.last_u_x_next;
    out->i_q2 = safe_output_latched.last_u_x_next;
    out->i_q4 = safe_output_latched.last_u_x_next;
    state->safe_output_last_u_z = safe_output_latched.last_u_z_next;
    out->i_q1 = safe_output_latched.last_u_z_next;
    out->i_q3 = safe_output_latched.last_u_z_next;
    state->guard.latched = 1u;
    fault_word = faults_before_2 | 0x80000000u;
    if (diagnostics != NULL) {
        diagnostics->rests = rests ? 1.0f : 0.0f;
    }
    return fault_word;
}

/* the law: what the step computes unless it is latched */
MAGLEV_5DOF_PRECISE_INLINE uint32_t maglev_5dof_precise_law(maglev_5dof_precise_state_t *state,
    const maglev_5dof_precise_input_t *accepted, uint32_t guard_ready, const maglev_5dof_precise_redundancy_output_t
    *redundancy_output, const maglev_5dof_precise_monitor_output_t *x_monitor_output, float observer_y_q,
    const maglev_5dof_precise_monitor_output_t *z_monitor_output,
    const maglev_5dof_precise_redundancy_output_2_t *redundancy_output_2, float y, bool lost_x, bool lost_z,
    uint32_t faults_before_2, maglev_5dof_precise_output_t *out, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const float lifted = 0.0305f;                        /* m; at a larger gap a stop may hold the platen */
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
    static const maglev_5dof_precise_observer_fast_parameters_t observer_x_fast_observer_fast = {.alpha = 0.6988058f,
        .beta = 272.3178f, .gamma = 35832.543f, .low = -20.0f, .largest_disturbance = 20.0f, .low_2 = -0.1f,
        .largest_position = 0.1f, .low_3 = -2.0f, .largest_rate = 2.0f};
    static const maglev_5dof_precise_observer_fast_parameters_t observer_z_fast_observer_fast = {.alpha = 0.6988058f,
        .beta = 272.3178f, .gamma = 35832.543f, .low = -20.0f, .largest_disturbance = 20.0f, .low_2 = -0.1f,
        .largest_position = 0.1f, .low_3 = -2.0f, .largest_rate = 2.0f};
    static const maglev_5dof_precise_observer_fast_parameters_t observer_phi_fast_observer_fast = {.alpha = 0.6988058f,
        .beta = 272.3178f, .gamma = 35832.543f, .low = -200.0f, .largest_disturbance = 200.0f, .low_2 = -0.02f,
        .largest_position = 0.02f, .low_3 = -4.0f, .largest_rate = 4.0f};
    static const maglev_5dof_precise_observer_fast_parameters_t observer_theta_fast_observer_fast =
        {.alpha = 0.5276334f, .beta = 130.55266f, .gamma = 10823.077f, .low = -200.0f, .largest_disturbance = 200.0f,
        .low_2 = -0.031f, .largest_position = 0.031f, .low_3 = -4.0f, .largest_rate = 4.0f};

    uint32_t fault_word;

    const uint32_t x_frozen = maglev_5dof_precise_monitor_update(&state->x_monitor, x_monitor_output, accepted->x);
    const uint32_t z_frozen = maglev_5dof_precise_monitor_update(&state->z_monitor, z_monitor_output, accepted->z);
    const maglev_5dof_precise_redundancy_update_t redundancy_update =
        maglev_5dof_precise_redundancy_update(&state->redundancy, redundancy_output_2, z_monitor_output,
        x_monitor_output, accepted, redundancy_output, diagnostics);

    /* sufficiency: it can land, is probed */
    const bool free = redundancy_update.regular && (observer_y_q < lifted);
    const maglev_5dof_precise_kinematics_output_t kinematics_output =
        maglev_5dof_precise_kinematics_output(redundancy_output_2, diagnostics);
    const maglev_5dof_precise_errors_t errors = maglev_5dof_precise_errors(y, accepted, x_monitor_output->held,
        z_monitor_output->held, &kinematics_output, diagnostics);

    /* delay: delay of one sample */
    const float delay_w_y_last = state->delay_w_y_last;
    const maglev_5dof_precise_observer_y_t observer_y = maglev_5dof_precise_observer_y(&state->observer_y, guard_ready,
        y, delay_w_y_last, diagnostics);
    const maglev_5dof_precise_observer_y_fast_t observer_y_fast =
        maglev_5dof_precise_observer_y_fast(&state->observer_y_fast, guard_ready, y, delay_w_y_last, diagnostics);
    const float w_y_tracking = maglev_5dof_precise_servo_fast(&state->servo_y_fast, &servo_y_fast_servo_fast,
        observer_y_fast.y_fast_ahead, accepted->y_ref, observer_y_fast.y_fast_rate_ahead, guard_ready,
        observer_y_fast.value, errors.e_y);
    const float delay_a_x_last = state->delay_a_x_last;
    const maglev_5dof_precise_observer_t observer_x = maglev_5dof_precise_observer(&state->observer_x, guard_ready,
        x_monitor_output, x_frozen, delay_a_x_last);
    const maglev_5dof_precise_observer_fast_t observer_x_fast =
        maglev_5dof_precise_observer_fast(&state->observer_x_fast, &observer_x_fast_observer_fast, guard_ready,
        x_monitor_output->held, delay_a_x_last);
    const float w_x_tracking = maglev_5dof_precise_servo_fast(&state->servo_x_fast, &servo_x_fast_servo_fast,
        observer_x_fast.fast_ahead, accepted->x_ref, observer_x_fast.fast_rate_ahead, guard_ready,
        observer_x_fast.value, errors.e_x);
    const float delay_a_z_last = state->delay_a_z_last;
    const maglev_5dof_precise_observer_t observer_z = maglev_5dof_precise_observer(&state->observer_z, guard_ready,
        z_monitor_output, z_frozen, delay_a_z_last);
    const maglev_5dof_precise_observer_fast_t observer_z_fast =
        maglev_5dof_precise_observer_fast(&state->observer_z_fast, &observer_z_fast_observer_fast, guard_ready,
        z_monitor_output->held, delay_a_z_last);
    const float w_z_tracking = maglev_5dof_precise_servo_fast(&state->servo_z_fast, &servo_z_fast_servo_fast,
        observer_z_fast.fast_ahead, accepted->z_ref, observer_z_fast.fast_rate_ahead, guard_ready,
        observer_z_fast.value, errors.e_z);
    const float delay_w_phi_last = state->delay_w_phi_last;
    maglev_5dof_precise_observer_phi(&state->observer_phi, guard_ready, kinematics_output.phi, delay_w_phi_last,
        diagnostics);
    const maglev_5dof_precise_observer_fast_t observer_phi_fast =
        maglev_5dof_precise_observer_fast(&state->observer_phi_fast, &observer_phi_fast_observer_fast, guard_ready,
        kinematics_output.phi, delay_w_phi_last);
    const float w_phi_tracking = maglev_5dof_precise_servo_phi_fast(&state->servo_phi_fast, &observer_phi_fast,
        accepted->phi_ref, guard_ready, errors.e_phi, diagnostics);
    const float delay_w_theta_last = state->delay_w_theta_last;
    const maglev_5dof_precise_observer_theta_t observer_theta =
        maglev_5dof_precise_observer_theta(&state->observer_theta, guard_ready, kinematics_output.theta,
        delay_w_theta_last, diagnostics);
    const maglev_5dof_precise_observer_fast_t observer_theta_fast =
        maglev_5dof_precise_observer_fast(&state->observer_theta_fast, &observer_theta_fast_observer_fast, guard_ready,
        kinematics_output.theta, delay_w_theta_last);
    const float w_theta_tracking = maglev_5dof_precise_servo_fast(&state->servo_theta_fast,
        &servo_theta_fast_servo_fast, observer_theta_fast.fast_ahead, accepted->theta_ref,
        observer_theta_fast.fast_rate_ahead, guard_ready, observer_theta_fast.value, errors.e_theta);
    const maglev_5dof_precise_landing_t landing = maglev_5dof_precise_landing(&state->landing, &redundancy_update,
        guard_ready, kinematics_output.phi, w_phi_tracking, &observer_theta, w_theta_tracking, &observer_x,
        w_x_tracking, &observer_y, w_y_tracking, &observer_z, w_z_tracking, diagnostics);
    const float w_x = maglev_5dof_precise_probe(&state->probe_x, x_monitor_output->unchanged, landing.w_x_unprobed,
        free, errors.e_x);
    state->delay_w_y_last = landing.w_y;
    state->delay_w_phi_last = landing.w_phi;
    state->delay_w_theta_last = landing.w_theta;
    if (landing.landing_next != 0u) {
        fault_word = faults_before_2 | 0x40000000u;
    } else {
        fault_word = faults_before_2;
    }
    const float w_z = maglev_5dof_precise_probe(&state->probe_z, z_monitor_output->unchanged, landing.w_z_unprobed,
        free, errors.e_z);
    const maglev_5dof_precise_inversion_t inversion = maglev_5dof_precise_inversion(&landing,
        observer_y_fast.y_fast_ahead, observer_phi_fast.fast_ahead, w_z, observer_theta_fast.fast_ahead, w_x,
        diagnostics);
    out->i_q2 = inversion.u_x_computed;
    out->i_q4 = inversion.u_x_computed;
    out->i_q1 = inversion.u_z_computed;
    out->i_q3 = inversion.u_z_computed;
    const maglev_5dof_precise_handover_t handover = maglev_5dof_precise_handover(&state->handover, lost_x, lost_z,
        observer_y_q, x_monitor_output->trusted, z_monitor_output->trusted, &inversion);
    state->safe_output_last_u_x = inversion.u_x_computed;
    state->safe_output_last_u_z = inversion.u_z_computed;
    state->delay_a_x_last = inversion.a_x;
    state->delay_a_z_last = inversion.a_z;
    out->i_d1 = handover.i_d1_computed;
    out->i_d2 = handover.i_d2_computed;
    out->i_d3 = handover.i_d3_computed;
    state->safe_output_last_i_d1 = handover.i_d1_computed;
    state->safe_output_last_i_d2 = handover.i_d2_computed;
    state->safe_output_last_i_d3 = handover.i_d3_computed;
    state->safe_output_last_i_d4 = handover.i_d4_computed;
    out->i_d4 = handover.i_d4_computed;
    if (diagnostics != NULL) {
        diagnostics->x_unchanged = (float)x_monitor_output->unchanged;
        diagnostics->x_frozen = (float)x_frozen;
        diagnostics->z_unchanged = (float)z_monitor_output->unchanged;
        diagnostics->z_frozen = (float)z_frozen;
        diagnostics->free = free ? 1.0f : 0.0f;
        diagnostics->w_y_tracking = w_y_tracking;
        diagnostics->x_fast_ahead = observer_x_fast.fast_ahead;
        diagnostics->x_fast_rate_ahead = observer_x_fast.fast_rate_ahead;
        diagnostics->w_x_tracking = w_x_tracking;
        diagnostics->z_fast_ahead = observer_z_fast.fast_ahead;
        diagnostics->z_fast_rate_ahead = observer_z_fast.fast_rate_ahead;
        diagnostics->w_z_tracking = w_z_tracking;
        diagnostics->phi_fast_ahead = observer_phi_fast.fast_ahead;
        diagnostics->phi_fast_rate_ahead = observer_phi_fast.fast_rate_ahead;
        diagnostics->theta_fast_ahead = observer_theta_fast.fast_ahead;
        diagnostics->theta_fast_rate_ahead = observer_theta_fast.fast_rate_ahead;
        diagnostics->w_theta_tracking = w_theta_tracking;
        diagnostics->x_estimate = observer_x.estimate;
        diagnostics->x_rate = observer_x.rate;
        diagnostics->x_disturbance = observer_x.disturbance;
        diagnostics->z_estimate = observer_z.estimate;
        diagnostics->z_rate = observer_z.rate;
        diagnostics->z_disturbance = observer_z.disturbance;
        diagnostics->w_x = w_x;
        diagnostics->w_z = w_z;
    }
    return fault_word;
}

void maglev_5dof_precise_init(maglev_5dof_precise_state_t *state)
{
    /* A member that is not named is 0. */
    *state = (maglev_5dof_precise_state_t){
        .guard = {.last_y1 = 0.031f, .last_y2 = 0.031f, .last_y3 = 0.031f, .last_y4 = 0.031f, .last_y_ref = 0.03095f,
            .left = 20u},
        .x_monitor = {.doubts = 10u},
        .z_monitor = {.doubts = 10u},
        .redundancy = {.code_y1 = 0.0245f, .code_y2 = 0.0245f, .code_y3 = 0.0245f, .code_y4 = 0.0245f,
            .bound_0 = 2.6820562e-08f},
        .observer_y_fast = {.q = 0.0245f},
        .servo_y_fast = {.r = 0.01805f},
        .observer_y = {.q = 0.0245f},
        .observer_x = {.g = 1.0f},
        .observer_z = {.g = 1.0f},
        .landing = {.left = 20u},
        .probe_x = {.towards = 2.2f},
        .probe_z = {.towards = 2.2f},
        .safe_output_last_i_d1 = 2.5f,
        .safe_output_last_i_d2 = 2.5f,
        .safe_output_last_i_d3 = 2.5f,
        .safe_output_last_i_d4 = 2.5f,
    };
}

MAGLEV_5DOF_PRECISE_INLINE uint32_t maglev_5dof_precise_body(maglev_5dof_precise_state_t *state, const
    maglev_5dof_precise_input_t *in, maglev_5dof_precise_output_t *out, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    static const uint32_t most_attempts = 8u;                   /* 1; pairs without an answer: the sensor is frozen */
    static const float landed_at = 0.0314f; /* m; end of the ramp, behind the stop: landed, wherever the body is */

    if (diagnostics != NULL) {
        diagnostics->samples += 1u;
        diagnostics->saturated = 0u;
    }
    uint32_t faults = 0u;
    const maglev_5dof_precise_input_t accepted = maglev_5dof_precise_guard_inputs(state, in, &faults);
    const bool complete = (faults & 0x0000003fu) == 0u;
    const uint32_t guard_ready = state->guard.ready;
    const uint32_t guard_latched = state->guard.latched;
    const float missed_calls = in->missed_calls;
    const maglev_5dof_precise_guard_output_t guard_output = maglev_5dof_precise_guard_output(&state->guard,
        guard_latched, missed_calls);
    const maglev_5dof_precise_redundancy_output_t redundancy_output =
        maglev_5dof_precise_redundancy_output(&state->redundancy, &accepted, guard_ready, complete, diagnostics);
    const uint32_t probe_x_attempt = state->probe_x.attempt;
    const bool x_unanswered = most_attempts <= probe_x_attempt;
    const bool in_time = guard_output.judging && (fabsf(missed_calls) <= 0.0f);
    const maglev_5dof_precise_monitor_output_t x_monitor_output = maglev_5dof_precise_monitor_output(&state->x_monitor,
        state->observer_x.q, accepted.x, in_time, guard_ready, x_unanswered, redundancy_output.sound,
        (faults & 0x00000010u) == 0u);
    const float observer_y_q = state->observer_y.q;
    const maglev_5dof_precise_gap_prediction_t gap_prediction = maglev_5dof_precise_gap_prediction(observer_y_q,
        state->observer_phi.q, state->observer_theta.q, diagnostics);
    const uint32_t probe_z_attempt = state->probe_z.attempt;
    const bool z_unanswered = most_attempts <= probe_z_attempt;
    const maglev_5dof_precise_monitor_output_t z_monitor_output = maglev_5dof_precise_monitor_output(&state->z_monitor,
        state->observer_z.q, accepted.z, in_time, guard_ready, z_unanswered, redundancy_output.sound,
        (faults & 0x00000020u) == 0u);
    const maglev_5dof_precise_redundancy_output_2_t redundancy_output_2 =
        maglev_5dof_precise_redundancy_output_2(&state->redundancy, &redundancy_output, &accepted, &gap_prediction,
        x_monitor_output.usual, z_monitor_output.usual, faults, guard_ready, diagnostics);
    const uint32_t landing_landing_2 = state->landing.landing;
    const bool landed = (landing_landing_2 != 0u) && (landed_at <= state->landing.r_y);

    /* sufficiency: it can land, is probed */
    const bool sufficient = redundancy_output_2.gaps_sufficient &&
        (x_monitor_output.trusted || z_monitor_output.trusted);
    const maglev_5dof_precise_guard_update_t guard_update = maglev_5dof_precise_guard_update(&state->guard, landed,
        sufficient, complete, guard_latched);
    const float y = maglev_5dof_precise_kinematics_update(&redundancy_output_2, diagnostics);
    const bool lost_x = !x_monitor_output.trusted;
    const bool lost_z = !z_monitor_output.trusted;
    const maglev_5dof_precise_angles_t angles = maglev_5dof_precise_angles(guard_update.latched, lost_x,
        x_monitor_output.held, lost_z, z_monitor_output.held);
    out->x_commutation = angles.x_commutation;
    out->z_commutation = angles.z_commutation;
    uint32_t value = faults;
    if (!redundancy_output_2.calm) {
        uint32_t faults_before = faults;
        if (redundancy_output_2.suspect_y1) {
            faults_before = faults | 0x00000800u;
        }
        if (redundancy_output_2.suspect_y2) {
            faults_before |= 0x00001000u;
        }
        if (redundancy_output_2.suspect_y3) {
            faults_before |= 0x00002000u;
        }
        if (redundancy_output_2.suspect_y4) {
            faults_before |= 0x00004000u;
        }
        if (x_monitor_output.suspect != 0u) {
            faults_before |= 0x00008000u;
        }
        if (z_monitor_output.suspect != 0u) {
            faults_before |= 0x00010000u;
        }
        if (guard_update.value) {
            value = faults_before | 0x00020000u;
        } else {
            value = faults_before;
        }
    }
    const uint32_t faults_before_2 = (guard_output.tolerated) ? value : (value | 0x00040000u);
    uint32_t fault_word;
    if (guard_update.latched != 0u) {
        fault_word = maglev_5dof_precise_latched(state, landed, y, faults_before_2, out, diagnostics);
    } else {
        fault_word = maglev_5dof_precise_law(state, &accepted, guard_ready, &redundancy_output, &x_monitor_output,
            observer_y_q, &z_monitor_output, &redundancy_output_2, y, lost_x, lost_z, faults_before_2, out,
            diagnostics);
    }
    if (diagnostics != NULL) {
        diagnostics->x_unanswered = x_unanswered ? 1.0f : 0.0f;
        diagnostics->x_usual = x_monitor_output.usual ? 1.0f : 0.0f;
        diagnostics->z_unanswered = z_unanswered ? 1.0f : 0.0f;
        diagnostics->z_usual = z_monitor_output.usual ? 1.0f : 0.0f;
        diagnostics->x_suspect = (float)x_monitor_output.suspect;
        diagnostics->z_suspect = (float)z_monitor_output.suspect;
        diagnostics->landed = landed ? 1.0f : 0.0f;
        diagnostics->x_trusted = x_monitor_output.trusted ? 1.0f : 0.0f;
        diagnostics->z_trusted = z_monitor_output.trusted ? 1.0f : 0.0f;
        diagnostics->sufficient = sufficient ? 1.0f : 0.0f;
    }

    if (diagnostics != NULL) {
        diagnostics->faults = fault_word;
        if ((diagnostics->latch_cause == 0u) && ((fault_word & 0x80000000u) != 0u)) {
            diagnostics->latch_cause = fault_word;
        }
    }
    return fault_word;
}

uint32_t maglev_5dof_precise_step(maglev_5dof_precise_state_t *state, const maglev_5dof_precise_input_t *in,
    maglev_5dof_precise_output_t *out)
{
    return maglev_5dof_precise_body(state, in, out, NULL);
}

#if defined(MAGLEV_5DOF_PRECISE_DIAGNOSTICS)
uint32_t maglev_5dof_precise_step_diagnosed(maglev_5dof_precise_state_t *state, const maglev_5dof_precise_input_t *in,
    maglev_5dof_precise_output_t *out, maglev_5dof_precise_diagnostics_t *diagnostics)
{
    return maglev_5dof_precise_body(state, in, out, diagnostics);
}
#endif
