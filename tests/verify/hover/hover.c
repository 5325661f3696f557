#include "hover.h"
#include <math.h>
#include <stdbool.h>

static float clamped(float v, float low, float high)
{
    return (v < low) ? low : ((v > high) ? high : v);
}

/* exp(-55 t) to degree 6 for |t| <= 0.012 m: between 0.5 and 2. */
static float field(float t)
{
    return 1.0f + (t * (-55.0f + (t * (1512.5f + (t * (-27729.166f + (t * (381276.03f + (t * (-4194036.3f
        + (t * 38445333.0f)))))))))));
}

void hover_init(hover_state_t *state)
{
    state->last_g1 = 0.02f;
    state->last_g2 = 0.02f;
    state->last_r = 0.02f;
    state->bad_g1 = 0u;
    state->bad_g2 = 0u;
    state->latched = 0u;
    state->xi = 0.0f;
    state->v = 0.0f;
    state->safe_i1 = 2.5f;
    state->safe_i2 = 2.5f;
}

uint32_t hover_step(hover_state_t *state, const hover_input_t *in, hover_output_t *out)
{
    /* each value is held where it is compared: Eva remembers two branchings */
    const bool good_g1 = (0.0125f <= in->g1) && (in->g1 <= 0.0365f);
    const float g1 = good_g1 ? in->g1 : state->last_g1;
    const bool good_g2 = (0.0125f <= in->g2) && (in->g2 <= 0.0365f);
    const float g2 = good_g2 ? in->g2 : state->last_g2;
    const bool good_r = (0.018f <= in->r) && (in->r <= 0.031f);
    const float r = good_r ? in->r : state->last_r;
    const uint32_t bad_g1 = good_g1 ? 0u : ((state->bad_g1 < 5u) ? (state->bad_g1 + 1u) : 5u);
    const uint32_t bad_g2 = good_g2 ? 0u : ((state->bad_g2 < 5u) ? (state->bad_g2 + 1u) : 5u);
    const bool latched = (state->latched != 0u) || (bad_g1 == 5u) || (bad_g2 == 5u);

    if (latched) {
        const float i1 = state->safe_i1 + clamped(2.5f - state->safe_i1, -0.1f, 0.1f);
        const float i2 = state->safe_i2 + clamped(2.5f - state->safe_i2, -0.1f, 0.1f);
        out->i1 = clamped(i1, -4.95f, 4.95f);
        out->i2 = clamped(i2, -4.95f, 4.95f);
    } else {
        const float a1 = field(g1 - 0.0245f);
        const float a2 = field(g2 - 0.0245f);
        const float e = (0.5f * (g1 + g2)) - r;
        const float w = 9.81f - (1700.0f * e) - (180.0f * state->v) - (50.0f * state->xi);
        /* w = d^2 (a1 + a2), lifting only */
        const float q = w / (a1 + a2);
        const float d = (q > 0.0f) ? sqrtf(q) : 0.0f;
        const float i1 = d * a1;
        const float i2 = d * a2;
        /* both currents share one limit */
        const float norm2 = (i1 * i1) + (i2 * i2);
        const float scale = (norm2 > 24.5f) ? sqrtf(24.5f / norm2) : 1.0f;
        float xi = state->xi + (0.001f * e);
        if (fabsf(xi) > 0.05f) {
            xi = (xi > 0.0f) ? 0.05f : -0.05f;
        }
        state->xi = xi;
        state->v = clamped((0.9f * state->v) + (260.0f * e), -30.0f, 30.0f);
        out->i1 = clamped(scale * i1, -4.95f, 4.95f);
        out->i2 = clamped(scale * i2, -4.95f, 4.95f);
    }

    state->last_g1 = g1;
    state->last_g2 = g2;
    state->last_r = r;
    state->bad_g1 = bad_g1;
    state->bad_g2 = bad_g2;
    state->latched = latched ? (uint32_t)1u : (uint32_t)0u;
    state->safe_i1 = out->i1;
    state->safe_i2 = out->i2;
    return (good_g1 ? 0u : 0x00000001u) | (good_g2 ? 0u : 0x00000002u) | (good_r ? 0u : 0x00000004u)
        | (latched ? 0x80000000u : 0u);
}
