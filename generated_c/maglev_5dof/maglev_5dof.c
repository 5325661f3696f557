/* maglev_5dof. Generated: do not edit. */
#include "maglev_5dof.h"
#include <math.h>

static const float filter_y_f11 = 0.7357589f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_y_f12 = 0.00036787943f;           /* s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_y_f21 = -367.87946f;              /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_y_f22 = -7.658029e-18f;           /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_y_g1 = 0.89636165f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_y_g2 = 264.24112f;                /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float regulator_y_k_e = -1699.6849f;           /* 1/s^2; F(14)-(16): gain on e */
static const float regulator_y_k_de = -182.75494f;          /* 1/s; F(14)-(16): gain on de */
static const float regulator_y_k_xi1 = -50000.0f;           /* 1/s^5; F(14)-(16): gain on xi1 */
static const float regulator_y_k_xi2 = 2725.4595f;          /* 1/s^4; F(14)-(16): gain on xi2 */
static const float regulator_y_k_xi3 = -7806.842f;          /* 1/s^3; F(14)-(16): gain on xi3 */
static const float regulator_y_xi1_xi2 = 0.0009999963f;     /* s; F(14)-(16): xi1 from xi2, exact over T */
static const float regulator_y_xi1_xi3 = 4.999991e-07f;     /* s^2; F(14)-(16): xi1 from xi3, exact over T */
static const float regulator_y_xi1_e = 1.6666649e-10f;      /* s^3; F(14)-(16): xi1 from e, exact over T */
static const float regulator_y_xi2_xi2 = 0.9999889f;        /* 1; F(14)-(16): xi2 from xi2, exact over T */
static const float regulator_y_xi2_xi3 = 0.0009999963f;     /* s; F(14)-(16): xi2 from xi3, exact over T */
static const float regulator_y_xi2_e = 4.999991e-07f;       /* s^2; F(14)-(16): xi2 from e, exact over T */
static const float regulator_y_xi3_xi2 = -0.022206528f;     /* 1/s^1; F(14)-(16): xi3 from xi2, exact over T */
static const float regulator_y_xi3_xi3 = 0.9999889f;        /* 1; F(14)-(16): xi3 from xi3, exact over T */
static const float regulator_y_xi3_e = 0.0009999963f;       /* s; F(14)-(16): xi3 from e, exact over T */
static const float filter_x_f11 = 0.7357589f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_x_f12 = 0.00036787943f;           /* s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_x_f21 = -367.87946f;              /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_x_f22 = -7.658029e-18f;           /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_x_g1 = 0.89636165f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_x_g2 = 264.24112f;                /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float regulator_x_k_e = -525.33453f;           /* 1/s^2; F(14)-(17): gain on e */
static const float regulator_x_k_de = -50.50415f;           /* 1/s; F(14)-(17): gain on de */
static const float regulator_x_k_xi1 = -21213.203f;         /* 1/s^5; F(14)-(17): gain on xi1 */
static const float regulator_x_k_xi2 = -1253.5868f;         /* 1/s^4; F(14)-(17): gain on xi2 */
static const float regulator_x_k_xi3 = -2742.1863f;         /* 1/s^3; F(14)-(17): gain on xi3 */
static const float regulator_x_xi1_xi2 = 0.0009999963f;     /* s; F(14)-(17): xi1 from xi2, exact over T */
static const float regulator_x_xi1_xi3 = 4.999991e-07f;     /* s^2; F(14)-(17): xi1 from xi3, exact over T */
static const float regulator_x_xi1_e = 1.6666649e-10f;      /* s^3; F(14)-(17): xi1 from e, exact over T */
static const float regulator_x_xi1_excess = 7.0035014e-08f; /* m s^3/A; F(14)-(17): xi1 from excess, exact over T */
static const float regulator_x_xi2_xi2 = 0.9999889f;        /* 1; F(14)-(17): xi2 from xi2, exact over T */
static const float regulator_x_xi2_xi3 = 0.0009999963f;     /* s; F(14)-(17): xi2 from xi3, exact over T */
static const float regulator_x_xi2_e = 4.999991e-07f;       /* s^2; F(14)-(17): xi2 from e, exact over T */
static const float regulator_x_xi2_excess = 7.0034744e-08f; /* m s^2/A; F(14)-(17): xi2 from excess, exact over T */
static const float regulator_x_xi3_xi2 = -0.022206528f;     /* 1/s^1; F(14)-(17): xi3 from xi2, exact over T */
static const float regulator_x_xi3_xi3 = 0.9999889f;        /* 1; F(14)-(17): xi3 from xi3, exact over T */
static const float regulator_x_xi3_e = 0.0009999963f;       /* s; F(14)-(17): xi3 from e, exact over T */
static const float regulator_x_xi3_excess = 6.922251e-08f;  /* m s^1/A; F(14)-(17): xi3 from excess, exact over T */
static const float filter_z_f11 = 0.7357589f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_z_f12 = 0.00036787943f;           /* s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_z_f21 = -367.87946f;              /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_z_f22 = -7.658029e-18f;           /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_z_g1 = 0.89636165f;               /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_z_g2 = 264.24112f;                /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float regulator_z_k_e = -525.33453f;           /* 1/s^2; F(14)-(17): gain on e */
static const float regulator_z_k_de = -50.50415f;           /* 1/s; F(14)-(17): gain on de */
static const float regulator_z_k_xi1 = -21213.203f;         /* 1/s^5; F(14)-(17): gain on xi1 */
static const float regulator_z_k_xi2 = -1253.5868f;         /* 1/s^4; F(14)-(17): gain on xi2 */
static const float regulator_z_k_xi3 = -2742.1863f;         /* 1/s^3; F(14)-(17): gain on xi3 */
static const float regulator_z_xi1_xi2 = 0.0009999963f;     /* s; F(14)-(17): xi1 from xi2, exact over T */
static const float regulator_z_xi1_xi3 = 4.999991e-07f;     /* s^2; F(14)-(17): xi1 from xi3, exact over T */
static const float regulator_z_xi1_e = 1.6666649e-10f;      /* s^3; F(14)-(17): xi1 from e, exact over T */
static const float regulator_z_xi1_excess = 7.0035014e-08f; /* m s^3/A; F(14)-(17): xi1 from excess, exact over T */
static const float regulator_z_xi2_xi2 = 0.9999889f;        /* 1; F(14)-(17): xi2 from xi2, exact over T */
static const float regulator_z_xi2_xi3 = 0.0009999963f;     /* s; F(14)-(17): xi2 from xi3, exact over T */
static const float regulator_z_xi2_e = 4.999991e-07f;       /* s^2; F(14)-(17): xi2 from e, exact over T */
static const float regulator_z_xi2_excess = 7.0034744e-08f; /* m s^2/A; F(14)-(17): xi2 from excess, exact over T */
static const float regulator_z_xi3_xi2 = -0.022206528f;     /* 1/s^1; F(14)-(17): xi3 from xi2, exact over T */
static const float regulator_z_xi3_xi3 = 0.9999889f;        /* 1; F(14)-(17): xi3 from xi3, exact over T */
static const float regulator_z_xi3_e = 0.0009999963f;       /* s; F(14)-(17): xi3 from e, exact over T */
static const float regulator_z_xi3_excess = 6.922251e-08f;  /* m s^1/A; F(14)-(17): xi3 from excess, exact over T */
static const float filter_phi_f11 = 0.7357589f;             /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_phi_f12 = 0.00036787943f;         /* s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_phi_f21 = -367.87946f;            /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_phi_f22 = -7.658029e-18f;         /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_phi_g1 = 0.89636165f;             /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_phi_g2 = 264.24112f;              /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float regulator_phi_k_e = -2049.9666f;         /* 1/s^2; F(14)-(16): gain on e */
static const float regulator_phi_k_de = -209.99985f;        /* 1/s; F(14)-(16): gain on de */
static const float regulator_phi_k_xi1 = -63245.555f;       /* 1/s^5; F(14)-(16): gain on xi1 */
static const float regulator_phi_k_xi2 = 1910.5604f;        /* 1/s^4; F(14)-(16): gain on xi2 */
static const float regulator_phi_k_xi3 = -9901.297f;        /* 1/s^3; F(14)-(16): gain on xi3 */
static const float regulator_phi_xi1_xi2 = 0.0009999963f;   /* s; F(14)-(16): xi1 from xi2, exact over T */
static const float regulator_phi_xi1_xi3 = 4.999991e-07f;   /* s^2; F(14)-(16): xi1 from xi3, exact over T */
static const float regulator_phi_xi1_e = 1.6666649e-10f;    /* s^3; F(14)-(16): xi1 from e, exact over T */
static const float regulator_phi_xi2_xi2 = 0.9999889f;      /* 1; F(14)-(16): xi2 from xi2, exact over T */
static const float regulator_phi_xi2_xi3 = 0.0009999963f;   /* s; F(14)-(16): xi2 from xi3, exact over T */
static const float regulator_phi_xi2_e = 4.999991e-07f;     /* s^2; F(14)-(16): xi2 from e, exact over T */
static const float regulator_phi_xi3_xi2 = -0.022206528f;   /* 1/s^1; F(14)-(16): xi3 from xi2, exact over T */
static const float regulator_phi_xi3_xi3 = 0.9999889f;      /* 1; F(14)-(16): xi3 from xi3, exact over T */
static const float regulator_phi_xi3_e = 0.0009999963f;     /* s; F(14)-(16): xi3 from e, exact over T */
static const float filter_theta_f11 = 0.7357589f;           /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_theta_f12 = 0.00036787943f;       /* s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_theta_f21 = -367.87946f;          /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_theta_f22 = -7.658029e-18f;       /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_theta_g1 = 0.89636165f;           /* 1; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float filter_theta_g2 = 264.24112f;            /* 1/s; D(s) = s w^2/(s+w)^2, w = 1000 rad/s, first-order hold */
static const float regulator_theta_k_e = -2049.9666f;       /* 1/s^2; F(14)-(16): gain on e */
static const float regulator_theta_k_de = -209.99985f;      /* 1/s; F(14)-(16): gain on de */
static const float regulator_theta_k_xi1 = -63245.555f;     /* 1/s^5; F(14)-(16): gain on xi1 */
static const float regulator_theta_k_xi2 = 1910.5604f;      /* 1/s^4; F(14)-(16): gain on xi2 */
static const float regulator_theta_k_xi3 = -9901.297f;      /* 1/s^3; F(14)-(16): gain on xi3 */
static const float regulator_theta_xi1_xi2 = 0.0009999963f; /* s; F(14)-(16): xi1 from xi2, exact over T */
static const float regulator_theta_xi1_xi3 = 4.999991e-07f; /* s^2; F(14)-(16): xi1 from xi3, exact over T */
static const float regulator_theta_xi1_e = 1.6666649e-10f;  /* s^3; F(14)-(16): xi1 from e, exact over T */
static const float regulator_theta_xi2_xi2 = 0.9999889f;    /* 1; F(14)-(16): xi2 from xi2, exact over T */
static const float regulator_theta_xi2_xi3 = 0.0009999963f; /* s; F(14)-(16): xi2 from xi3, exact over T */
static const float regulator_theta_xi2_e = 4.999991e-07f;   /* s^2; F(14)-(16): xi2 from e, exact over T */
static const float regulator_theta_xi3_xi2 = -0.022206528f; /* 1/s^1; F(14)-(16): xi3 from xi2, exact over T */
static const float regulator_theta_xi3_xi3 = 0.9999889f;    /* 1; F(14)-(16): xi3 from xi3, exact over T */
static const float regulator_theta_xi3_e = 0.0009999963f;   /* s; F(14)-(16): xi3 from e, exact over T */

static inline float min(float a, float b)
{
    return (a < b) ? a : b;
}

static inline float max(float a, float b)
{
    return (a > b) ? a : b;
}

void maglev_5dof_init(maglev_5dof_state_t *state)
{
    state->guard_last_y1 = 0.031f;
    state->guard_last_y2 = 0.031f;
    state->guard_last_y3 = 0.031f;
    state->guard_last_y4 = 0.031f;
    state->guard_last_x = 0.0f;
    state->guard_last_z = 0.0f;
    state->guard_last_y_ref = 0.031f;
    state->guard_last_x_ref = 0.0f;
    state->guard_last_z_ref = 0.0f;
    state->guard_last_phi_ref = 0.0f;
    state->guard_last_theta_ref = 0.0f;
    state->guard_bad_y1 = 0u;
    state->guard_bad_y2 = 0u;
    state->guard_bad_y3 = 0u;
    state->guard_bad_y4 = 0u;
    state->guard_bad_x = 0u;
    state->guard_bad_z = 0u;
    state->guard_latched = 0u;
    state->guard_ready = 0u;
    state->filter_y_q_prev = 0.0f;
    state->filter_y_lag = 0.0f;
    state->filter_y_v = 0.0f;
    state->regulator_y_xi1 = 0.0f;
    state->regulator_y_xi2 = 0.0f;
    state->regulator_y_xi3 = 0.0f;
    state->filter_x_q_prev = 0.0f;
    state->filter_x_lag = 0.0f;
    state->filter_x_v = 0.0f;
    state->regulator_x_xi1 = 0.0f;
    state->regulator_x_xi2 = 0.0f;
    state->regulator_x_xi3 = 0.0f;
    state->filter_z_q_prev = 0.0f;
    state->filter_z_lag = 0.0f;
    state->filter_z_v = 0.0f;
    state->regulator_z_xi1 = 0.0f;
    state->regulator_z_xi2 = 0.0f;
    state->regulator_z_xi3 = 0.0f;
    state->filter_phi_q_prev = 0.0f;
    state->filter_phi_lag = 0.0f;
    state->filter_phi_v = 0.0f;
    state->regulator_phi_xi1 = 0.0f;
    state->regulator_phi_xi2 = 0.0f;
    state->regulator_phi_xi3 = 0.0f;
    state->filter_theta_q_prev = 0.0f;
    state->filter_theta_lag = 0.0f;
    state->filter_theta_v = 0.0f;
    state->regulator_theta_xi1 = 0.0f;
    state->regulator_theta_xi2 = 0.0f;
    state->regulator_theta_xi3 = 0.0f;
    state->safe_output_last_i_d1 = 2.5f;
    state->safe_output_last_i_d2 = 2.5f;
    state->safe_output_last_i_d3 = 2.5f;
    state->safe_output_last_i_d4 = 2.5f;
    state->safe_output_last_i_q1 = 0.0f;
    state->safe_output_last_i_q2 = 0.0f;
    state->safe_output_last_i_q3 = 0.0f;
    state->safe_output_last_i_q4 = 0.0f;
}

uint32_t maglev_5dof_step(maglev_5dof_state_t *state, const maglev_5dof_input_t *in, maglev_5dof_output_t *out)
{
    /* guard: range acceptance, hold, latch */
    const float y1 = in->y1;
    const int t5 = 0.0168f <= y1 && y1 <= 0.0322f;
    const int fault_y1 = !t5;
    const float guard_last_y1 = state->guard_last_y1;
    const float y1_held = (t5) ? y1 : guard_last_y1;
    const float y2 = in->y2;
    const int t14 = 0.0124f <= y2 && y2 <= 0.0366f;
    const int fault_y2 = !t14;
    const float guard_last_y2 = state->guard_last_y2;
    const float y2_held = (t14) ? y2 : guard_last_y2;
    const float y3 = in->y3;
    const int t21 = 0.0168f <= y3 && y3 <= 0.0322f;
    const int fault_y3 = !t21;
    const float guard_last_y3 = state->guard_last_y3;
    const float y3_held = (t21) ? y3 : guard_last_y3;
    const float y4 = in->y4;
    const int t28 = 0.0124f <= y4 && y4 <= 0.0366f;
    const int fault_y4 = !t28;
    const float guard_last_y4 = state->guard_last_y4;
    const float y4_held = (t28) ? y4 : guard_last_y4;
    const float x = in->x;
    const int t37 = -0.1f <= x && x <= 0.1f;
    const int fault_x = !t37;
    const float guard_last_x = state->guard_last_x;
    const float x_held = (t37) ? x : guard_last_x;
    const float z = in->z;
    const int t44 = -0.1f <= z && z <= 0.1f;
    const int fault_z = !t44;
    const float guard_last_z = state->guard_last_z;
    const float z_held = (t44) ? z : guard_last_z;
    const float y_ref = in->y_ref;
    const int t53 = 0.018f <= y_ref && y_ref <= 0.031f;
    const int fault_y_ref = !t53;
    const float guard_last_y_ref = state->guard_last_y_ref;
    const float y_ref_held = (t53) ? y_ref : guard_last_y_ref;
    const float x_ref = in->x_ref;
    const int t62 = -0.05f <= x_ref && x_ref <= 0.05f;
    const int fault_x_ref = !t62;
    const float guard_last_x_ref = state->guard_last_x_ref;
    const float x_ref_held = (t62) ? x_ref : guard_last_x_ref;
    const float z_ref = in->z_ref;
    const int t69 = -0.05f <= z_ref && z_ref <= 0.05f;
    const int fault_z_ref = !t69;
    const float guard_last_z_ref = state->guard_last_z_ref;
    const float z_ref_held = (t69) ? z_ref : guard_last_z_ref;
    const float phi_ref = in->phi_ref;
    const int t78 = -0.003f <= phi_ref && phi_ref <= 0.003f;
    const int fault_phi_ref = !t78;
    const float guard_last_phi_ref = state->guard_last_phi_ref;
    const float phi_ref_held = (t78) ? phi_ref : guard_last_phi_ref;
    const float theta_ref = in->theta_ref;
    const int t87 = -0.014f <= theta_ref && theta_ref <= 0.014f;
    const int fault_theta_ref = !t87;
    const float guard_last_theta_ref = state->guard_last_theta_ref;
    const float theta_ref_held = (t87) ? theta_ref : guard_last_theta_ref;
    const uint32_t guard_latched = state->guard_latched;
    const uint32_t guard_bad_y1 = state->guard_bad_y1;
    const float t97 = (fault_y1) ? min((float)guard_bad_y1 + 1.0f, 5.0f) : 0.0f;
    const uint32_t guard_bad_y2 = state->guard_bad_y2;
    const float t103 = (fault_y2) ? min((float)guard_bad_y2 + 1.0f, 5.0f) : 0.0f;
    const uint32_t guard_bad_y3 = state->guard_bad_y3;
    const float t109 = (fault_y3) ? min((float)guard_bad_y3 + 1.0f, 5.0f) : 0.0f;
    const uint32_t guard_bad_y4 = state->guard_bad_y4;
    const float t115 = (fault_y4) ? min((float)guard_bad_y4 + 1.0f, 5.0f) : 0.0f;
    const uint32_t guard_bad_x = state->guard_bad_x;
    const float t121 = (fault_x) ? min((float)guard_bad_x + 1.0f, 5.0f) : 0.0f;
    const uint32_t guard_bad_z = state->guard_bad_z;
    const float t127 = (fault_z) ? min((float)guard_bad_z + 1.0f, 5.0f) : 0.0f;
    const int latched = (((((guard_latched != 0u || 5.0f <= t97) || 5.0f <= t103) || 5.0f <= t109) || 5.0f <= t115) || 5.0f <= t121) || 5.0f <= t127;
    const uint32_t guard_ready = state->guard_ready;

    /* kinematics: F(5) inverted */
    const float y = (y1_held + y2_held + y3_held + y4_held) / 4.0f;
    const float phi = asinf((y3_held - y1_held) / 0.794f);
    const float theta = asinf((y2_held - y4_held) / 0.794f);

    /* errors: F(14) e */
    const float e_y = y - y_ref_held;
    const float e_x = x_held - x_ref_held;
    const float e_z = z_held - z_ref_held;
    const float e_phi = phi - phi_ref_held;
    const float e_theta = theta - theta_ref_held;

    /* filter_y: derivative filter */
    const float filter_y_v = state->filter_y_v;
    const float filter_y_lag = state->filter_y_lag;
    const float filter_y_q_prev = state->filter_y_q_prev;
    const float t157 = e_y - filter_y_q_prev;
    const float t159 = filter_y_f22 * filter_y_v - filter_y_f21 * filter_y_lag + filter_y_g2 * t157;
    const float de_y = (guard_ready != 0u) ? t159 : 0.0f;

    /* regulator_y: F(14)-(16) */
    const float regulator_y_xi1 = state->regulator_y_xi1;
    const float t170 = regulator_y_k_e * e_y + ((guard_ready != 0u) ? regulator_y_k_de * t159 : 0.0f) + regulator_y_k_xi1 * regulator_y_xi1;
    const float regulator_y_xi2 = state->regulator_y_xi2;
    const float regulator_y_xi3 = state->regulator_y_xi3;
    const float w_y = t170 + regulator_y_k_xi2 * regulator_y_xi2 + regulator_y_k_xi3 * regulator_y_xi3;

    /* filter_x: derivative filter */
    const float filter_x_v = state->filter_x_v;
    const float filter_x_lag = state->filter_x_lag;
    const float filter_x_q_prev = state->filter_x_q_prev;
    const float t188 = e_x - filter_x_q_prev;
    const float t190 = filter_x_f22 * filter_x_v - filter_x_f21 * filter_x_lag + filter_x_g2 * t188;
    const float de_x = (guard_ready != 0u) ? t190 : 0.0f;

    /* regulator_x: F(14)-(17) */
    const float regulator_x_xi1 = state->regulator_x_xi1;
    const float t201 = regulator_x_k_e * e_x + ((guard_ready != 0u) ? regulator_x_k_de * t190 : 0.0f) + regulator_x_k_xi1 * regulator_x_xi1;
    const float regulator_x_xi2 = state->regulator_x_xi2;
    const float regulator_x_xi3 = state->regulator_x_xi3;
    const float w_x = t201 + regulator_x_k_xi2 * regulator_x_xi2 + regulator_x_k_xi3 * regulator_x_xi3;

    /* filter_z: derivative filter */
    const float filter_z_v = state->filter_z_v;
    const float filter_z_lag = state->filter_z_lag;
    const float filter_z_q_prev = state->filter_z_q_prev;
    const float t219 = e_z - filter_z_q_prev;
    const float t221 = filter_z_f22 * filter_z_v - filter_z_f21 * filter_z_lag + filter_z_g2 * t219;
    const float de_z = (guard_ready != 0u) ? t221 : 0.0f;

    /* regulator_z: F(14)-(17) */
    const float regulator_z_xi1 = state->regulator_z_xi1;
    const float t232 = regulator_z_k_e * e_z + ((guard_ready != 0u) ? regulator_z_k_de * t221 : 0.0f) + regulator_z_k_xi1 * regulator_z_xi1;
    const float regulator_z_xi2 = state->regulator_z_xi2;
    const float regulator_z_xi3 = state->regulator_z_xi3;
    const float w_z = t232 + regulator_z_k_xi2 * regulator_z_xi2 + regulator_z_k_xi3 * regulator_z_xi3;

    /* filter_phi: derivative filter */
    const float filter_phi_v = state->filter_phi_v;
    const float filter_phi_lag = state->filter_phi_lag;
    const float filter_phi_q_prev = state->filter_phi_q_prev;
    const float t250 = e_phi - filter_phi_q_prev;
    const float t252 = filter_phi_f22 * filter_phi_v - filter_phi_f21 * filter_phi_lag + filter_phi_g2 * t250;
    const float de_phi = (guard_ready != 0u) ? t252 : 0.0f;

    /* regulator_phi: F(14)-(16) */
    const float regulator_phi_xi1 = state->regulator_phi_xi1;
    const float t263 = regulator_phi_k_e * e_phi + ((guard_ready != 0u) ? regulator_phi_k_de * t252 : 0.0f) + regulator_phi_k_xi1 * regulator_phi_xi1;
    const float regulator_phi_xi2 = state->regulator_phi_xi2;
    const float regulator_phi_xi3 = state->regulator_phi_xi3;
    const float w_phi = t263 + regulator_phi_k_xi2 * regulator_phi_xi2 + regulator_phi_k_xi3 * regulator_phi_xi3;

    /* filter_theta: derivative filter */
    const float filter_theta_v = state->filter_theta_v;
    const float filter_theta_lag = state->filter_theta_lag;
    const float filter_theta_q_prev = state->filter_theta_q_prev;
    const float t281 = e_theta - filter_theta_q_prev;
    const float t283 = filter_theta_f22 * filter_theta_v - filter_theta_f21 * filter_theta_lag + filter_theta_g2 * t281;
    const float de_theta = (guard_ready != 0u) ? t283 : 0.0f;

    /* regulator_theta: F(14)-(16) */
    const float regulator_theta_xi1 = state->regulator_theta_xi1;
    const float t294 = regulator_theta_k_e * e_theta + ((guard_ready != 0u) ? regulator_theta_k_de * t283 : 0.0f) + regulator_theta_k_xi1 * regulator_theta_xi1;
    const float regulator_theta_xi2 = state->regulator_theta_xi2;
    const float regulator_theta_xi3 = state->regulator_theta_xi3;
    const float w_theta = t294 + regulator_theta_k_xi2 * regulator_theta_xi2 + regulator_theta_k_xi3 * regulator_theta_xi3;

    /* decoupling: F(8), F(12), limits */
    const float t308 = max(min(y, 0.031f), 0.018f);
    const float t311 = max(min(theta, 0.014f), -0.014f);
    const float t313 = 0.397f * sinf(t311);
    const float t314 = t308 + t313;
    const float t321 = 1.0f - 0.00016129f / (0.0762f * (t314 + 0.00635f + 0.005f));
    const float t326 = 0.0127f / (2.0f * t314);
    const float t337 = 0.01905f / (0.01905f - t314 * (1.2732395f * (t326 * atanf(t326) - logf(sqrtf(1.0f + t326 * t326)))));
    const float t340 = 54.971f * (0.005f + t314);
    const float t341 = sinhf(t340);
    const float t345 = t308 - t313;
    const float t350 = 1.0f - 0.00016129f / (0.0762f * (t345 + 0.00635f + 0.005f));
    const float t352 = 0.0127f / (2.0f * t345);
    const float t363 = 0.01905f / (0.01905f - t345 * (1.2732395f * (t352 * atanf(t352) - logf(sqrtf(1.0f + t352 * t352)))));
    const float t365 = 54.971f * (0.005f + t345);
    const float t366 = sinhf(t365);
    const float u_x_demand = w_x / (0.094339624f * (-35.09028f * (t321 / (t337 * t341)) + -35.09028f * (t350 / (t363 * t366))));
    const float t375 = max(min(phi, 0.003f), -0.003f);
    const float t377 = 0.397f * sinf(t375);
    const float t378 = t308 - t377;
    const float t383 = 1.0f - 0.00016129f / (0.0762f * (t378 + 0.00635f + 0.005f));
    const float t385 = 0.0127f / (2.0f * t378);
    const float t396 = 0.01905f / (0.01905f - t378 * (1.2732395f * (t385 * atanf(t385) - logf(sqrtf(1.0f + t385 * t385)))));
    const float t398 = 54.971f * (0.005f + t378);
    const float t399 = sinhf(t398);
    const float t403 = t308 + t377;
    const float t408 = 1.0f - 0.00016129f / (0.0762f * (t403 + 0.00635f + 0.005f));
    const float t410 = 0.0127f / (2.0f * t403);
    const float t421 = 0.01905f / (0.01905f - t403 * (1.2732395f * (t410 * atanf(t410) - logf(sqrtf(1.0f + t410 * t410)))));
    const float t423 = 54.971f * (0.005f + t403);
    const float t424 = sinhf(t423);
    const float u_z_demand = w_z / (0.11627907f * (-35.09028f * (t383 / (t396 * t399)) + -35.09028f * (t408 / (t421 * t424))));
    const float t433 = 0.27569526f / t424;
    const float t437 = t408 * t433 / (tanhf(t423) * t421);
    const float t439 = 0.27569526f / t399;
    const float t443 = t383 * t439 / (tanhf(t398) * t396);
    const float t444 = -47.959236f * t443;
    const float t445 = -47.959236f * t437 + t444;
    const float t446 = 0.27569526f / t341;
    const float t450 = t321 * t446 / (tanhf(t340) * t337);
    const float t452 = 0.27569526f / t366;
    const float t456 = t350 * t452 / (tanhf(t365) * t363);
    const float t457 = -47.959236f * t456;
    const float t458 = -47.959236f * t450 + t457;
    const float t459 = t445 * t458;
    const float t464 = t383 / (t399 * t399) / (t396 * t396);
    const float t467 = 0.5162494f * t464 / 2.0f;
    const float t472 = -2273.9263f * (t383 * (t439 * t439));
    const float t475 = -2273.9263f * (t321 * (t446 * t446));
    const float t479 = -2273.9263f * (t408 * (t433 * t433));
    const float t483 = -2273.9263f * (t350 * (t452 * t452));
    const float t488 = w_y - (9.81f + (t472 + t475 + t479 + t483) / 6.9f);
    const float t491 = 9.223132f * t443;
    const float t494 = t491 + -9.223132f * t437;
    const float t495 = t494 * t458;
    const float t501 = -11250.0f * t375;
    const float t503 = w_phi - (0.397f * (t479 - t472) / 0.5268f + t501);
    const float t507 = 9.223132f * t456;
    const float t508 = -9.223132f * t450 + t507;
    const float t509 = t508 * t445;
    const float t514 = -2850.0f * t311;
    const float t516 = w_theta - (0.397f * (t475 - t483) / 0.5268f + t514);
    const float t523 = t491 + 9.223132f * t450 + 9.223132f * t437 + t507;
    const float t527 = 47.959236f * t437 + t444;
    const float t528 = t527 * t458;
    const float t532 = 47.959236f * t450 + t457;
    const float t533 = t445 * t532;
    const float t535 = t523 * t459 - t494 * t528 - t508 * t533;
    const float t536 = (t459 * t488 - t495 * t503 - t509 * t516) / t535;
    const float t539 = t523 * t458 - t508 * t532;
    const float t543 = t508 * t527;
    const float t546 = (t539 * t503 - t528 * t488 + t543 * t516) / t535;
    const float t552 = max(min((t536 + t546) / 2.0f, 4.9497476f), -4.9497476f);
    const float t553 = t552 * t552;
    const float t558 = t321 / (t341 * t341) / (t337 * t337);
    const float t560 = 0.5162494f * t558 / 2.0f;
    const float t561 = t494 * t532;
    const float t567 = t523 * t445 - t494 * t527;
    const float t570 = (t561 * t503 - t533 * t488 + t567 * t516) / t535;
    const float t574 = max(min((t536 - t570) / 2.0f, 4.9497476f), -4.9497476f);
    const float t575 = t574 * t574;
    const float t581 = t408 / (t424 * t424) / (t421 * t421);
    const float t583 = 0.5162494f * t581 / 2.0f;
    const float t587 = max(min((t536 - t546) / 2.0f, 4.9497476f), -4.9497476f);
    const float t588 = t587 * t587;
    const float t594 = t350 / (t366 * t366) / (t363 * t363);
    const float t596 = 0.5162494f * t594 / 2.0f;
    const float t600 = max(min((t536 + t570) / 2.0f, 4.9497476f), -4.9497476f);
    const float t601 = t600 * t600;
    const float t612 = sqrtf(max(24.5f - max(t553, t588), 0.0f));
    const float t615 = max(min(u_z_demand, t612), -t612);
    const float t616 = t615 * t615;
    const float t618 = t472 - 1.7810605f * t464 * t616;
    const float t623 = sqrtf(max(24.5f - max(t575, t601), 0.0f));
    const float t626 = max(min(u_x_demand, t623), -t623);
    const float t627 = t626 * t626;
    const float t629 = t475 - 1.7810605f * t558 * t627;
    const float t633 = t479 - 1.7810605f * t581 * t616;
    const float t637 = t483 - 1.7810605f * t594 * t627;
    const float t640 = 9.81f + (t618 + t629 + t633 + t637) / 6.9f;
    const float t641 = w_y + (t467 * t553 + t560 * t575 + t583 * t588 + t596 * t601) - t640;
    const float t645 = 2.684438f * t464 / 2.0f;
    const float t648 = 2.684438f * t581 / 2.0f;
    const float t655 = 0.397f * (t633 - t618) / 0.5268f + t501;
    const float t656 = w_phi - (t645 * t553 - t648 * t588) - t655;
    const float t660 = 2.684438f * t594 / 2.0f;
    const float t663 = 2.684438f * t558 / 2.0f;
    const float t670 = 0.397f * (t629 - t637) / 0.5268f + t514;
    const float t671 = w_theta - (t660 * t601 - t663 * t575) - t670;
    const float t674 = (t459 * t641 - t495 * t656 - t509 * t671) / t535;
    const float t680 = (t539 * t656 - t528 * t641 + t543 * t671) / t535;
    const float t684 = max(min((t674 + t680) / 2.0f, 4.9497476f), -4.9497476f);
    const float t685 = t684 * t684;
    const float t692 = (t561 * t656 - t533 * t641 + t567 * t671) / t535;
    const float t696 = max(min((t674 - t692) / 2.0f, 4.9497476f), -4.9497476f);
    const float t697 = t696 * t696;
    const float t703 = max(min((t674 - t680) / 2.0f, 4.9497476f), -4.9497476f);
    const float t704 = t703 * t703;
    const float t710 = max(min((t674 + t692) / 2.0f, 4.9497476f), -4.9497476f);
    const float t711 = t710 * t710;
    const float t715 = w_y + (t467 * t685 + t560 * t697 + t583 * t704 + t596 * t711) - t640;
    const float t721 = w_phi - (t645 * t685 - t648 * t704) - t655;
    const float t728 = w_theta - (t660 * t711 - t663 * t697) - t670;
    const float t731 = (t459 * t715 - t495 * t721 - t509 * t728) / t535;
    const float t737 = (t539 * t721 - t528 * t715 + t543 * t728) / t535;
    const float i_d1_computed = max(min((t731 + t737) / 2.0f, 4.9497476f), -4.9497476f);
    const float t747 = (t561 * t721 - t533 * t715 + t567 * t728) / t535;
    const float i_d2_computed = max(min((t731 - t747) / 2.0f, 4.9497476f), -4.9497476f);
    const float i_d3_computed = max(min((t731 - t737) / 2.0f, 4.9497476f), -4.9497476f);
    const float i_d4_computed = max(min((t731 + t747) / 2.0f, 4.9497476f), -4.9497476f);
    const float t765 = sqrtf(max(24.5f - max(i_d1_computed * i_d1_computed, i_d3_computed * i_d3_computed), 0.0f));
    const float i_q1_computed = max(min(t615, t765), -t765);
    const float t774 = sqrtf(max(24.5f - max(i_d2_computed * i_d2_computed, i_d4_computed * i_d4_computed), 0.0f));
    const float i_q2_computed = max(min(t626, t774), -t774);
    const float excess_x = i_q2_computed - u_x_demand;
    const float excess_z = i_q1_computed - u_z_demand;

    /* safe_output: slew to the safe output once latched */
    const float safe_output_last_i_d1 = state->safe_output_last_i_d1;
    const float t787 = min((latched) ? safe_output_last_i_d1 + max(min(2.5f - safe_output_last_i_d1, 0.1f), -0.1f) : i_d1_computed, 4.9497476f);
    const float i_d1 = max(t787, -4.9497476f);
    const float safe_output_last_i_d2 = state->safe_output_last_i_d2;
    const float t795 = min((latched) ? safe_output_last_i_d2 + max(min(2.5f - safe_output_last_i_d2, 0.1f), -0.1f) : i_d2_computed, 4.9497476f);
    const float i_d2 = max(t795, -4.9497476f);
    const float safe_output_last_i_d3 = state->safe_output_last_i_d3;
    const float t803 = min((latched) ? safe_output_last_i_d3 + max(min(2.5f - safe_output_last_i_d3, 0.1f), -0.1f) : i_d3_computed, 4.9497476f);
    const float i_d3 = max(t803, -4.9497476f);
    const float safe_output_last_i_d4 = state->safe_output_last_i_d4;
    const float t811 = min((latched) ? safe_output_last_i_d4 + max(min(2.5f - safe_output_last_i_d4, 0.1f), -0.1f) : i_d4_computed, 4.9497476f);
    const float i_d4 = max(t811, -4.9497476f);
    const float safe_output_last_i_q1 = state->safe_output_last_i_q1;
    const float t819 = min((latched) ? safe_output_last_i_q1 + max(min(-safe_output_last_i_q1, 0.1f), -0.1f) : i_q1_computed, 4.9497476f);
    const float i_q1 = max(t819, -4.9497476f);
    const float safe_output_last_i_q2 = state->safe_output_last_i_q2;
    const float t827 = min((latched) ? safe_output_last_i_q2 + max(min(-safe_output_last_i_q2, 0.1f), -0.1f) : i_q2_computed, 4.9497476f);
    const float i_q2 = max(t827, -4.9497476f);
    const float safe_output_last_i_q3 = state->safe_output_last_i_q3;
    const float t835 = min((latched) ? safe_output_last_i_q3 + max(min(-safe_output_last_i_q3, 0.1f), -0.1f) : i_q1_computed, 4.9497476f);
    const float i_q3 = max(t835, -4.9497476f);
    const float safe_output_last_i_q4 = state->safe_output_last_i_q4;
    const float t843 = min((latched) ? safe_output_last_i_q4 + max(min(-safe_output_last_i_q4, 0.1f), -0.1f) : i_q2_computed, 4.9497476f);
    const float i_q4 = max(t843, -4.9497476f);

    /* next states */
    const float t887 = min((guard_ready != 0u) ? filter_y_f11 * filter_y_lag - filter_y_f12 * filter_y_v + filter_y_g1 * t157 : 0.0f, 0.033f);
    const float t902 = regulator_y_xi1 + regulator_y_xi1_xi2 * regulator_y_xi2 + regulator_y_xi1_xi3 * regulator_y_xi3 + regulator_y_xi1_e * e_y;
    const float t916 = min(regulator_y_xi2_xi2 * regulator_y_xi2 + regulator_y_xi2_xi3 * regulator_y_xi3 + regulator_y_xi2_e * e_y, 0.02f);
    const float t928 = min(regulator_y_xi3_xi2 * regulator_y_xi2 + regulator_y_xi3_xi3 * regulator_y_xi3 + regulator_y_xi3_e * e_y, 0.2f);
    const float t945 = min((guard_ready != 0u) ? filter_x_f11 * filter_x_lag - filter_x_f12 * filter_x_v + filter_x_g1 * t188 : 0.0f, 0.3f);
    const float t958 = regulator_x_xi1 + regulator_x_xi1_xi2 * regulator_x_xi2 + regulator_x_xi1_xi3 * regulator_x_xi3 + regulator_x_xi1_e * e_x;
    const float t975 = regulator_x_xi2_xi2 * regulator_x_xi2 + regulator_x_xi2_xi3 * regulator_x_xi3 + regulator_x_xi2_e * e_x + regulator_x_xi2_excess * excess_x;
    const float t988 = regulator_x_xi3_xi2 * regulator_x_xi2 + regulator_x_xi3_xi3 * regulator_x_xi3 + regulator_x_xi3_e * e_x + regulator_x_xi3_excess * excess_x;
    const float t1004 = min((guard_ready != 0u) ? filter_z_f11 * filter_z_lag - filter_z_f12 * filter_z_v + filter_z_g1 * t219 : 0.0f, 0.3f);
    const float t1016 = regulator_z_xi1 + regulator_z_xi1_xi2 * regulator_z_xi2 + regulator_z_xi1_xi3 * regulator_z_xi3 + regulator_z_xi1_e * e_z;
    const float t1032 = regulator_z_xi2_xi2 * regulator_z_xi2 + regulator_z_xi2_xi3 * regulator_z_xi3 + regulator_z_xi2_e * e_z + regulator_z_xi2_excess * excess_z;
    const float t1045 = regulator_z_xi3_xi2 * regulator_z_xi2 + regulator_z_xi3_xi3 * regulator_z_xi3 + regulator_z_xi3_e * e_z + regulator_z_xi3_excess * excess_z;
    const float t1060 = (guard_ready != 0u) ? filter_phi_f11 * filter_phi_lag - filter_phi_f12 * filter_phi_v + filter_phi_g1 * t250 : 0.0f;
    const float t1077 = regulator_phi_xi1 + regulator_phi_xi1_xi2 * regulator_phi_xi2 + regulator_phi_xi1_xi3 * regulator_phi_xi3 + regulator_phi_xi1_e * e_phi;
    const float t1087 = regulator_phi_xi2_xi2 * regulator_phi_xi2 + regulator_phi_xi2_xi3 * regulator_phi_xi3 + regulator_phi_xi2_e * e_phi;
    const float t1097 = regulator_phi_xi3_xi2 * regulator_phi_xi2 + regulator_phi_xi3_xi3 * regulator_phi_xi3 + regulator_phi_xi3_e * e_phi;
    const float t1112 = (guard_ready != 0u) ? filter_theta_f11 * filter_theta_lag - filter_theta_f12 * filter_theta_v + filter_theta_g1 * t281 : 0.0f;
    const float t1124 = regulator_theta_xi1 + regulator_theta_xi1_xi2 * regulator_theta_xi2 + regulator_theta_xi1_xi3 * regulator_theta_xi3;
    const float t1137 = regulator_theta_xi2_xi2 * regulator_theta_xi2 + regulator_theta_xi2_xi3 * regulator_theta_xi3 + regulator_theta_xi2_e * e_theta;
    const float t1147 = regulator_theta_xi3_xi2 * regulator_theta_xi2 + regulator_theta_xi3_xi3 * regulator_theta_xi3 + regulator_theta_xi3_e * e_theta;

    state->guard_last_y1 = max(min(y1_held, 0.0322f), 0.0168f);
    state->guard_last_y2 = max(min(y2_held, 0.0366f), 0.0124f);
    state->guard_last_y3 = max(min(y3_held, 0.0322f), 0.0168f);
    state->guard_last_y4 = max(min(y4_held, 0.0366f), 0.0124f);
    state->guard_last_x = max(min(x_held, 0.1f), -0.1f);
    state->guard_last_z = max(min(z_held, 0.1f), -0.1f);
    state->guard_last_y_ref = max(min(y_ref_held, 0.031f), 0.018f);
    state->guard_last_x_ref = max(min(x_ref_held, 0.05f), -0.05f);
    state->guard_last_z_ref = max(min(z_ref_held, 0.05f), -0.05f);
    state->guard_last_phi_ref = max(min(phi_ref_held, 0.003f), -0.003f);
    state->guard_last_theta_ref = max(min(theta_ref_held, 0.014f), -0.014f);
    state->guard_bad_y1 = (uint32_t)(t97);
    state->guard_bad_y2 = (uint32_t)(t103);
    state->guard_bad_y3 = (uint32_t)(t109);
    state->guard_bad_y4 = (uint32_t)(t115);
    state->guard_bad_x = (uint32_t)(t121);
    state->guard_bad_z = (uint32_t)(t127);
    state->guard_latched = latched ? 1u : 0u;
    state->guard_ready = guard_ready != 0u || (((((t5 && t14) && t21) && t28) && t37) && t44) ? 1u : 0u;
    state->filter_y_q_prev = max(min(e_y, 0.0165f), -0.0165f);
    state->filter_y_lag = max(t887, -0.033f);
    state->filter_y_v = max(min(de_y, 30.0f), -30.0f);
    state->regulator_y_xi1 = max(min(t902, 0.002f), -0.002f);
    state->regulator_y_xi2 = max(t916, -0.02f);
    state->regulator_y_xi3 = max(t928, -0.2f);
    state->filter_x_q_prev = max(min(e_x, 0.15f), -0.15f);
    state->filter_x_lag = max(t945, -0.3f);
    state->filter_x_v = max(min(de_x, 30.0f), -30.0f);
    state->regulator_x_xi1 = max(min(t958 + regulator_x_xi1_excess * excess_x, 0.005f), -0.005f);
    state->regulator_x_xi2 = max(min(t975, 0.05f), -0.05f);
    state->regulator_x_xi3 = max(min(t988, 0.5f), -0.5f);
    state->filter_z_q_prev = max(min(e_z, 0.15f), -0.15f);
    state->filter_z_lag = max(t1004, -0.3f);
    state->filter_z_v = max(min(de_z, 30.0f), -30.0f);
    state->regulator_z_xi1 = max(min(t1016 + regulator_z_xi1_excess * excess_z, 0.005f), -0.005f);
    state->regulator_z_xi2 = max(min(t1032, 0.05f), -0.05f);
    state->regulator_z_xi3 = max(min(t1045, 0.5f), -0.5f);
    state->filter_phi_q_prev = max(min(e_phi, 0.023f), -0.023f);
    state->filter_phi_lag = max(min(t1060, 0.046f), -0.046f);
    state->filter_phi_v = max(min(de_phi, 60.0f), -60.0f);
    state->regulator_phi_xi1 = max(min(t1077, 0.002f), -0.002f);
    state->regulator_phi_xi2 = max(min(t1087, 0.02f), -0.02f);
    state->regulator_phi_xi3 = max(min(t1097, 0.2f), -0.2f);
    state->filter_theta_q_prev = max(min(e_theta, 0.045f), -0.045f);
    state->filter_theta_lag = max(min(t1112, 0.09f), -0.09f);
    state->filter_theta_v = max(min(de_theta, 60.0f), -60.0f);
    state->regulator_theta_xi1 = max(min(t1124 + regulator_theta_xi1_e * e_theta, 0.002f), -0.002f);
    state->regulator_theta_xi2 = max(min(t1137, 0.02f), -0.02f);
    state->regulator_theta_xi3 = max(min(t1147, 0.2f), -0.2f);
    state->safe_output_last_i_d1 = i_d1;
    state->safe_output_last_i_d2 = i_d2;
    state->safe_output_last_i_d3 = i_d3;
    state->safe_output_last_i_d4 = i_d4;
    state->safe_output_last_i_q1 = i_q1;
    state->safe_output_last_i_q2 = i_q2;
    state->safe_output_last_i_q3 = i_q3;
    state->safe_output_last_i_q4 = i_q4;
    out->i_d1 = i_d1;
    out->i_d2 = i_d2;
    out->i_d3 = i_d3;
    out->i_d4 = i_d4;
    out->i_q1 = i_q1;
    out->i_q2 = i_q2;
    out->i_q3 = i_q3;
    out->i_q4 = i_q4;
    return (fault_y1 ? 0x00000001u : 0u)
        | (fault_y2 ? 0x00000002u : 0u)
        | (fault_y3 ? 0x00000004u : 0u)
        | (fault_y4 ? 0x00000008u : 0u)
        | (fault_x ? 0x00000010u : 0u)
        | (fault_z ? 0x00000020u : 0u)
        | (fault_y_ref ? 0x00000040u : 0u)
        | (fault_x_ref ? 0x00000080u : 0u)
        | (fault_z_ref ? 0x00000100u : 0u)
        | (fault_phi_ref ? 0x00000200u : 0u)
        | (fault_theta_ref ? 0x00000400u : 0u)
        | (latched ? 0x80000000u : 0u);
}
