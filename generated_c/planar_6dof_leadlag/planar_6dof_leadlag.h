/* planar_6dof_leadlag: one step every 0.001 s, float. Generated: do not edit. What may fail and what follows:
 * planar_6dof_leadlag.md.
 *
 * Call planar_6dof_leadlag_init once, then planar_6dof_leadlag_step once every 0.001 s with the inputs of that sample.
 * Nothing else may change the state.
 *
 * Apply the outputs 1 sample, 0.001 s, after the inputs of their sample were measured, neither sooner nor later, and
 * hold them until the next outputs are due. Margins and simulations assume this delay.
 *
 * The three pointers must not be null and must point to objects that do not overlap. One state serves one machine;
 * steps on different states may run at the same time.
 *
 * When a measurement is refused in 5 samples in a row, a latch is certain: whatever is measured then, the step brakes
 * the machine in the 23 samples after the last of these, and latches in the next one until init, and the outputs move
 * to the safe output: i_AA, i_AB, i_AC, i_BA, i_BB, i_BC, i_CA, i_CB, i_CC to 0 A at 126 A/s.
 *
 * Keep calling the step while it is latched, because the outputs move in its calls only. Call init again only with the
 * machine at rest: the outputs of the first step after it are not slewed.
 *
 * At init the machine is at rest under the safe output, which acts until the first outputs of the step do.
 *
 * At init the platen is within half a pitch, 25.4 mm, of the middle in x and y, and its yaw is below 0.025 rad: the
 * Hall voltages repeat with each pitch, and the pitches are counted from there. After a latch move the platen there
 * before init. Before the first sample in which all Hall voltages are good no current is demanded.
 *
 * Calibrate the sensitivity of each Hall channel to 0.2 % and its offset to 2 mV: what a single channel is off by turns
 * the platen, by up to 6 mrad at the worst place of a pitch.
 *
 * The gains and numbers in planar_6dof_leadlag.c hold for one plant and one period: for other masses, geometry or
 * magnets, or another period, generate the files again. gains.json says where each gain comes from.
 *
 * With PLANAR_6DOF_LEADLAG_DIAGNOSTICS defined, for the .c as well, planar_6dof_leadlag_step_diagnosed also says which
 * signals it computed, what is saturated and why it latched. Without the macro the diagnostics cost nothing.
 *
 * Compile with -std=c99 -O2 -ffp-contract=off -fno-math-errno. With -ffp-contract=fast results differ by rounding.
 * -ffast-math, -ffinite-math-only and floating-point arithmetic in a wider type are refused by #error. The source
 * cannot see options that assume that no value is NaN or infinite, or that reorder sums, by other names, such as
 * -fno-honor-nans or -funsafe-math-optimizations, nor -ffast-math of the linker: do not use them.
 */
#ifndef PLANAR_6DOF_LEADLAG_H
#define PLANAR_6DOF_LEADLAG_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct planar_6dof_leadlag_state planar_6dof_leadlag_state_t;

typedef struct {
    float V_ax;                         /* V, -5 .. 5: voltage of Hall sensor A along x */
    float V_ay;                         /* V, -5 .. 5: voltage of Hall sensor A along y */
    float V_bx;                         /* V, -5 .. 5: voltage of Hall sensor B along x */
    float V_by;                         /* V, -5 .. 5: voltage of Hall sensor B along y */
    float V_cx;                         /* V, -5 .. 5: voltage of Hall sensor C along x */
    float V_cy;                         /* V, -5 .. 5: voltage of Hall sensor C along y */
    float d1;                           /* m, -0.0005 .. 0.0005: laser distance at the front left, up from nominal */
    float d2;                           /* m, -0.0005 .. 0.0005: laser distance at the front right, up from nominal */
    float d3;                           /* m, -0.0005 .. 0.0005: laser distance at the rear, up from nominal */
    float x_ref;                        /* m, -0.11 .. 0.11: set-point of the position along X */
    float y_ref;                        /* m, -0.1 .. 0.1: set-point of the position along Y */
    float phi_ref;                      /* rad, -0.008 .. 0.008: set-point of the yaw */
    float z_ref;                        /* m, -0.0002 .. 0.0002: set-point of the height */
    float theta_ref;                    /* rad, -0.002 .. 0.002: set-point of the tilt about X */
    float psi_ref;                      /* rad, -0.002 .. 0.002: set-point of the tilt about Y */
} planar_6dof_leadlag_input_t;

typedef struct {
    float i_AA;                         /* A, -1.26 .. 1.26: phase A of motor A */
    float i_AB;                         /* A, -1.26 .. 1.26: phase B of motor A */
    float i_AC;                         /* A, -1.26 .. 1.26: phase C of motor A */
    float i_BA;                         /* A, -1.26 .. 1.26: phase A of motor B */
    float i_BB;                         /* A, -1.26 .. 1.26: phase B of motor B */
    float i_BC;                         /* A, -1.26 .. 1.26: phase C of motor B */
    float i_CA;                         /* A, -1.26 .. 1.26: phase A of motor C */
    float i_CB;                         /* A, -1.26 .. 1.26: phase B of motor C */
    float i_CC;                         /* A, -1.26 .. 1.26: phase C of motor C */
} planar_6dof_leadlag_output_t;

/* Put the state to its initial values. The caller owns it. */
void planar_6dof_leadlag_init(planar_6dof_leadlag_state_t *state);

/* Compute one sample: read `in`, write `out`, advance `state`.
 * It returns the fault bits:
 *   bit  0  V_ax: not finite or outside its range
 *   bit  1  V_ay: not finite or outside its range
 *   bit  2  V_bx: not finite or outside its range
 *   bit  3  V_by: not finite or outside its range
 *   bit  4  V_cx: not finite or outside its range
 *   bit  5  V_cy: not finite or outside its range
 *   bit  6  d1: not finite or outside its range
 *   bit  7  d2: not finite or outside its range
 *   bit  8  d3: not finite or outside its range
 *   bit  9  x_ref: not finite or outside its range
 *   bit 10  y_ref: not finite or outside its range
 *   bit 11  phi_ref: not finite or outside its range
 *   bit 12  z_ref: not finite or outside its range
 *   bit 13  theta_ref: not finite or outside its range
 *   bit 14  psi_ref: not finite or outside its range
 *   bit 15  V_ax: contradicts other measurements or its prediction
 *   bit 16  V_ay: contradicts other measurements or its prediction
 *   bit 17  V_bx: contradicts other measurements or its prediction
 *   bit 18  V_by: contradicts other measurements or its prediction
 *   bit 19  V_cx: contradicts other measurements or its prediction
 *   bit 20  V_cy: contradicts other measurements or its prediction
 *   bit 29  all Hall voltages have another amplitude than the field
 *   bit 30  a latch is certain: after the first sample with this bit it brakes for 23 samples, then latches; set until
 *           init
 *   bit 31  latched until init
 */
uint32_t planar_6dof_leadlag_step(planar_6dof_leadlag_state_t *state, const planar_6dof_leadlag_input_t *in,
    planar_6dof_leadlag_output_t *out);

/* What follows is for init and step alone: the state, by Block. */
typedef struct {
    float last_i_AA;                    /* A, -1.26 .. 1.26: last output */
    float last_i_AB;                    /* A, -1.26 .. 1.26: last output */
    float last_i_AC;                    /* A, -1.26 .. 1.26: last output */
    float last_i_BA;                    /* A, -1.26 .. 1.26: last output */
    float last_i_BB;                    /* A, -1.26 .. 1.26: last output */
    float last_i_BC;                    /* A, -1.26 .. 1.26: last output */
    float last_i_CA;                    /* A, -1.26 .. 1.26: last output */
    float last_i_CB;                    /* A, -1.26 .. 1.26: last output */
    float last_i_CC;                    /* A, -1.26 .. 1.26: last output */
} planar_6dof_leadlag_safe_output_state_t;

typedef struct {
    float integral;                     /* A: integral of the error */
    float lead;                         /* A: state of the lead filter */
} planar_6dof_leadlag_loop_state_t;

typedef struct {
    float p;                            /* m or rad: predicted position */
    float s;                            /* m or rad: predicted velocity times T */
    float h;                            /* m or rad: predicted acceleration times T^2/2 */
} planar_6dof_leadlag_filter_state_t;

typedef struct {
    float x_position;                   /* m, -0.2 .. 0.2: position predicted for this sample */
    float x_rate;                       /* m, -0.002 .. 0.002: predicted rate times the sample period */
    float x_disturbance;                /* m, -1.6e-05 .. 1.6e-05: T^2 / 2 times the disturbance */
    float y_position;                   /* m, -0.2 .. 0.2: position predicted for this sample */
    float y_rate;                       /* m, -0.002 .. 0.002: predicted rate times the sample period */
    float y_disturbance;                /* m, -1.6e-05 .. 1.6e-05: T^2 / 2 times the disturbance */
    float phi_position;                 /* rad, -0.05 .. 0.05: position predicted for this sample */
    float phi_rate;                     /* rad, -0.04 .. 0.04: predicted rate times the sample period */
    float phi_mean;                     /* rad, -0.075075 .. 0.075075: mean innovation */
} planar_6dof_leadlag_reckoning_state_t;

typedef struct {
    uint32_t contradiction_left;        /* 1, 0 .. 4: samples for which a contradiction is still remembered */
    uint32_t contradiction_confirmed;   /* 1, 0 .. 1: 1 once a second contradiction has confirmed the first */
    /* V^2, -10000 .. 10000: squared amplitude of the pair of x, less that of the field, at the first contradiction */
    float first_m_x;
    /* V^2, -10000 .. 10000: squared amplitude of the pair of y, less that of the field, at the first contradiction */
    float first_m_y;
    /* V, -200 .. 200: V_by - V_ay, less what the predicted yaw makes of it, at the first contradiction */
    float first_r_1;
    /* V, -200 .. 200: V_cx - V_ax, less what the predicted yaw makes of it, at the first contradiction */
    float first_r_2;
    float first_s_x;                    /* V, -10 .. 10: sine voltage of x, at the first contradiction */
    float first_s_y;                    /* V, -10 .. 10: sine voltage of y, at the first contradiction */
    float first_phi;                    /* rad, -0.05 .. 0.05: predicted yaw, at the first contradiction */
    float offset_x;                     /* m, -0.1016 .. 0.1016: whole pitches from the middle, along x */
    float offset_y;                     /* m, -0.1016 .. 0.1016: whole pitches from the middle, along y */
    float innovation_phi;               /* rad, -0.075 .. 0.075: raw yaw of the sample before less the predicted one */
    float phi_raw;                      /* rad, -0.025 .. 0.025: raw yaw of the sample before */
    uint32_t watch_channel;             /* 1, 0 .. 5: index of the watched channel, from 0 */
    /* 1, 0 .. 15: 1 .. N: codes in a row that are still missing; N + 1 between two watches */
    uint32_t watch_left;
    uint32_t frozen;                    /* 1, 0 .. 6: number of the channel whose code repeats, from 1; 0: none */
    float watch_code;                   /* V, -5 .. 5: of the watched channel, at first */
    float scale;                        /* 1, 0.84 .. 1.2: nominal amplitude of the voltages over the estimated one */
} planar_6dof_leadlag_sensing_state_t;

typedef struct {
    float last_d1;                      /* m, -0.0005 .. 0.0005: last good value */
    float last_d2;                      /* m, -0.0005 .. 0.0005: last good value */
    float last_d3;                      /* m, -0.0005 .. 0.0005: last good value */
    float last_x_ref;                   /* m, -0.11 .. 0.11: last good value */
    float last_y_ref;                   /* m, -0.1 .. 0.1: last good value */
    float last_phi_ref;                 /* rad, -0.008 .. 0.008: last good value */
    float last_z_ref;                   /* m, -0.0002 .. 0.0002: last good value */
    float last_theta_ref;               /* rad, -0.002 .. 0.002: last good value */
    float last_psi_ref;                 /* rad, -0.002 .. 0.002: last good value */
    /* 1, 1 .. 29: samples with a bad measurement until it latches; at 24 and below each sample counts as bad */
    uint32_t left;
    uint32_t latched;                   /* 1, 0 .. 1: latched until init */
    uint32_t ready;                     /* 1, 0 .. 1: every measurement was good at once */
} planar_6dof_leadlag_guard_state_t;

struct planar_6dof_leadlag_state {
    planar_6dof_leadlag_guard_state_t guard;
    planar_6dof_leadlag_sensing_state_t sensing;
    planar_6dof_leadlag_reckoning_state_t reckoning;
    planar_6dof_leadlag_filter_state_t filter_x;
    planar_6dof_leadlag_filter_state_t filter_y;
    planar_6dof_leadlag_filter_state_t filter_phi;
    planar_6dof_leadlag_loop_state_t loop_x;
    planar_6dof_leadlag_loop_state_t loop_y;
    planar_6dof_leadlag_loop_state_t loop_phi;
    planar_6dof_leadlag_loop_state_t loop_z;
    planar_6dof_leadlag_loop_state_t loop_theta;
    planar_6dof_leadlag_loop_state_t loop_psi;
    planar_6dof_leadlag_safe_output_state_t safe_output;
    float delay_x;                      /* A, -1.449 .. 1.449: demand that acts until the next sample */
    float delay_y;                      /* A, -2.6145 .. 2.6145: demand that acts until the next sample */
    float delay_phi;                    /* A, -2.52 .. 2.52: demand that acts until the next sample */
};

/* The layout is the same on every target. */
#if defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)
_Static_assert(sizeof(planar_6dof_leadlag_input_t) == 60u, "size of planar_6dof_leadlag_input_t");
_Static_assert(sizeof(planar_6dof_leadlag_output_t) == 36u, "size of planar_6dof_leadlag_output_t");
_Static_assert(sizeof(planar_6dof_leadlag_state_t) == 288u, "size of planar_6dof_leadlag_state_t");
#else
extern char planar_6dof_leadlag_input_size_is_60[(sizeof(planar_6dof_leadlag_input_t) == 60u) ? 1 : -1];
extern char planar_6dof_leadlag_output_size_is_36[(sizeof(planar_6dof_leadlag_output_t) == 36u) ? 1 : -1];
extern char planar_6dof_leadlag_state_size_is_288[(sizeof(planar_6dof_leadlag_state_t) == 288u) ? 1 : -1];
#endif

/* Signals and what happened: each signal from the last step that computed it, since a latch or another branch skips
 * some. Set the struct to zero when you call init. Bits of `saturated`: 0 phi_raw, 1 phi_next, 2 i_CQ, 3 i_AD, 4 i_BD,
 * 5 i_CD. */
typedef struct {
    float suspect_V_ax;                 /* 1: V_ax contradicts the others */
    float suspect_V_ay;                 /* 1: V_ay contradicts the others */
    float suspect_V_bx;                 /* 1: V_bx contradicts the others */
    float suspect_V_by;                 /* 1: V_by contradicts the others */
    float suspect_V_cx;                 /* 1: V_cx contradicts the others */
    float suspect_V_cy;                 /* 1: V_cy contradicts the others */
    float x_raw;                        /* m: from this sample's voltages */
    float y_raw;                        /* m: from this sample's voltages */
    float phi_raw;                      /* rad: from this sample's voltages */
    float within_x;                     /* m: raw position along x, from the middle of its pitch */
    float within_y;                     /* m: raw position along y, from the middle of its pitch */
    float m_x;                          /* V^2: squared amplitude of the pair of x, less that of the field */
    float m_y;                          /* V^2: squared amplitude of the pair of y, less that of the field */
    float r_1;                          /* V: V_by - V_ay, less what the predicted yaw makes of it */
    float r_2;                          /* V: V_cx - V_ax, less what the predicted yaw makes of it */
    float other_amplitude;              /* 1: all Hall voltages have another amplitude than the field */
    float measured;                     /* 1: the positions are measured in this sample */
    float x_advance;                    /* m: predicted rate times the sample period */
    float y_advance;                    /* m: predicted rate times the sample period */
    float phi_advance;                  /* rad: predicted rate times the sample period */
    float x;                            /* m: filtered */
    float y;                            /* m: filtered */
    float phi;                          /* rad: filtered */
    float z;                            /* m: height above the nominal gap */
    float theta;                        /* rad: tilt about X */
    float psi;                          /* rad: tilt about Y */
    float law_x;                        /* A: demand of x over its scale */
    float law_y;                        /* A: demand of y over its scale */
    float law_phi;                      /* A: demand of phi over its scale */
    float law_z;                        /* A: demand of z over its scale */
    float law_theta;                    /* A: demand of theta over its scale */
    float law_psi;                      /* A: demand of psi over its scale */
    float begun_phi;                    /* A: demand of the law */
    float d_phi;                        /* A: demand of phi over its scale */
    float begun_x;                      /* A: demand of the law */
    float d_x;                          /* A: demand of x over its scale */
    float begun_y;                      /* A: demand of the law */
    float d_y;                          /* A: demand of y over its scale */
    float i_AQ;                         /* A: quadrature current of motor A, peak of a phase */
    float i_BQ;                         /* A: quadrature current of motor B, peak of a phase */
    float i_CQ;                         /* A: quadrature current of motor C, peak of a phase */
    float d_psi;                        /* A: demand of psi over its scale */
    float d_theta;                      /* A: demand of theta over its scale */
    float d_z;                          /* A: demand of z over its scale */
    float i_AD;                         /* A: direct current of motor A, peak of a phase */
    float i_BD;                         /* A: direct current of motor B, peak of a phase */
    float i_CD;                         /* A: direct current of motor C, peak of a phase */
    float achieved_x;                   /* A: demand that the limited currents achieve */
    float achieved_y;                   /* A: demand that the limited currents achieve */
    float achieved_phi;                 /* A: demand that the limited currents achieve */
    float achieved_theta;               /* A: demand that the limited currents achieve */
    uint32_t samples;                   /* steps that had this struct */
    uint32_t faults;                    /* fault word of the last step */
    uint32_t latch_cause;               /* fault word of the step that latched, 0 before */
    uint32_t saturated;                 /* signals at their limits in the last step */
} planar_6dof_leadlag_diagnostics_t;

#if defined(PLANAR_6DOF_LEADLAG_DIAGNOSTICS)
/* The step; `diagnostics` may be null. */
uint32_t planar_6dof_leadlag_step_diagnosed(planar_6dof_leadlag_state_t *state, const planar_6dof_leadlag_input_t *in,
    planar_6dof_leadlag_output_t *out, planar_6dof_leadlag_diagnostics_t *diagnostics);
#endif

#ifdef __cplusplus
}
#endif

#endif
