/* A sampled controller around a continuous plant.
 *
 *   plant state x --h--> outputs y --encoders--> measurements --steps--> commands --delay, mixing--> plant inputs u
 *        ^                                                                                               |
 *        +-------------------------------- RK4, `substeps` in each period <------------------------------+
 *
 * plant.h gives N_X, N_U, N_Y, HAS_DISTURBANCE, the sizes of CasADi's work vectors and the prototypes of its functions.
 * The caller owns every array. All members of loop_t are eight bytes wide.
 */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "plant.h"

/* A Block of the drive, which follows the controller in each sample. */
typedef struct {
    int64_t members; /* of its input */
    const char *const *source; /* (members): in sample 0, what gives this member */
    const int64_t *stride, *offset, *size; /* (members): from one sample to the next, in the input, of the member */
    uint32_t (*step)(void *state, const void *in, void *out);
    void *state;
    int64_t in_size, out_size;
    char *in, *out; /* (samples) structs */
    uint32_t *faults;
} drive_block_t;

typedef struct {
    int64_t first, samples; /* those from `first` on are computed; the rows before it are there */
    int64_t substeps, delay;
    double period;
    const double *p;
    double *x;
    double *input; /* (N_U): of the plant, up to the next sample */
    const uint8_t *locked; /* (N_X): this state keeps its value */

    int64_t stops;
    const int64_t *stop_position, *stop_velocity;
    const double *stop_low, *stop_high;
    double *impact; /* (stops): largest speed of an impact */

    int64_t sensors;
    const int64_t *sensor_source, *sensor_offset; /* plant output; byte offset in the controller's input */
    const double *sensor_gain, *sensor_bias;      /* of the reading: gain y + bias + noise */
    const double *sensor_resolution;              /* 0: ideal */
    const double *sensor_low, *sensor_high;       /* saturation limits */
    const double *sensor_span;                    /* after which a reading starts over at sensor_low; 0: never */
    const double *noise;                          /* 0, or (samples, sensors): added before the encoder */
    const uint8_t *overridden;                    /* 0, or (samples, sensors): the input holds this sample already */
    const int64_t *sensor_lag; /* 0, or (samples, sensors): the input is the reading so many samples ago */
    double *readings;          /* with sensor_lag: (samples, sensors), what each sensor reads without a lag */
    const double *word_low, *word_step; /* 0, or (sensors): a word counts steps from low */
    const int64_t *flipped, *set_bits, *cleared; /* with word_low: (samples, sensors), masks of bits */

    int64_t commands;
    const int64_t *command_offset; /* byte offset in the output of the last Block */
    const double *mixing;          /* (N_U, commands) */
    const double *forcing;         /* (samples, substeps, N_U) */
    double *waiting;               /* (max(delay, 1), commands): computed and not yet applied */
    const double *input_gain, *input_bias; /* 0, or (samples, N_U): gain and bias of what the commands apply */
    const uint8_t *missed;                 /* 0, or (samples): the controller is not called */

    int64_t single; /* the controller's scalars are float */
    uint32_t (*step)(void *state, const void *in, void *out);
    void *state;
    int64_t in_size, out_size;
    char *in, *out; /* (samples) structs; `in` holds set-points and overridden samples */
    uint32_t *faults;

    int64_t drive_blocks;
    const drive_block_t *drive; /* (drive_blocks) */
    const char *last_out;       /* (samples) structs: the output of the last Block, which has the commands */
    int64_t last_out_size;

    double *states, *outputs, *applied; /* (samples, N_X), (samples, N_Y), (samples, N_U) */
} loop_t;

static void evaluate(int (*f)(const double **, double **, long long *, double *, int), const double *const given[3],
                     double *result) {
    const double *arg[SIZE_ARG];
    double *res[SIZE_RES];
    long long iw[SIZE_IW];
    double w[SIZE_W];
    memcpy(arg, given, 3 * sizeof *given);
    res[0] = result;
    f(arg, res, iw, w, 0);
}

static void derivative(const loop_t *loop, const double *x, const double *u, double t, double *dx) {
    const double *const given[3] = {x, u, loop->p};
    evaluate(synth_plant_f, given, dx);
#if HAS_DISTURBANCE
    double extra[N_X];
    const double *const moment[3] = {x, &t, 0};
    evaluate(synth_plant_disturbance, moment, extra);
    for (int i = 0; i < N_X; i++) dx[i] += extra[i];
#else
    (void)t;
#endif
    for (int i = 0; i < N_X; i++) {
        if (loop->locked[i]) dx[i] = 0.0;
    }
}

static void rk4(const loop_t *loop, const double *u, double t, double h) {
    double *const x = loop->x;
    double k1[N_X], k2[N_X], k3[N_X], k4[N_X], z[N_X];
    derivative(loop, x, u, t, k1);
    for (int i = 0; i < N_X; i++) z[i] = x[i] + 0.5 * h * k1[i];
    derivative(loop, z, u, t + 0.5 * h, k2);
    for (int i = 0; i < N_X; i++) z[i] = x[i] + 0.5 * h * k2[i];
    derivative(loop, z, u, t + 0.5 * h, k3);
    for (int i = 0; i < N_X; i++) z[i] = x[i] + h * k3[i];
    derivative(loop, z, u, t + h, k4);
    for (int i = 0; i < N_X; i++) x[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
}

static void stop(const loop_t *loop) {
    for (int64_t i = 0; i < loop->stops; i++) {
        double *const position = &loop->x[loop->stop_position[i]], *const velocity = &loop->x[loop->stop_velocity[i]];
        const int below = *position < loop->stop_low[i], above = *position > loop->stop_high[i];
        if (below) *position = loop->stop_low[i];
        if (above) *position = loop->stop_high[i];
        if ((below && *velocity < 0.0) || (above && *velocity > 0.0)) {
            loop->impact[i] = fmax(loop->impact[i], fabs(*velocity));
            *velocity = 0.0;
        }
    }
}

static double delayed(const loop_t *loop, int64_t k, int64_t i, double reading) {
    if (!loop->sensor_lag) return reading;
    const int64_t lag = loop->sensor_lag[k * loop->sensors + i];
    loop->readings[k * loop->sensors + i] = reading;
    return loop->readings[(k - lag) * loop->sensors + i];
}

static double with_faulty_bits(const loop_t *loop, int64_t k, int64_t i, double reading) {
    if (!loop->word_low) return reading;
    const int64_t j = k * loop->sensors + i, flipped = loop->flipped[j], set = loop->set_bits[j];
    const int64_t cleared = loop->cleared[j];
    const double count = (reading - loop->word_low[i]) / loop->word_step[i];
    /* A count beyond 2^52, or one that is not finite, has no word. */
    if (!(flipped | set | cleared) || !(fabs(count) < 4503599627370496.0)) return reading;
    return loop->word_low[i] + loop->word_step[i] * (double)(((llrint(count) ^ flipped) | set) & ~cleared);
}

static void measure(const loop_t *loop, int64_t k, const double *y) {
    char *const in = loop->in + k * loop->in_size;
    for (int64_t i = 0; i < loop->sensors; i++) {
        if (loop->overridden && loop->overridden[k * loop->sensors + i]) continue;
        const double scaled = loop->sensor_gain[i] * y[loop->sensor_source[i]] + loop->sensor_bias[i];
        const double seen = loop->noise ? scaled + loop->noise[k * loop->sensors + i] : scaled;
        const double resolution = loop->sensor_resolution[i];
        const double counted = resolution > 0.0 ? resolution * rint(seen / resolution) : seen;
        const double span = loop->sensor_span[i];
        const double wrapped = span > 0.0 ? counted - span * floor((counted - loop->sensor_low[i]) / span) : counted;
        /* Non-finite plant outputs are passed on unchanged. */
        const double held = wrapped > loop->sensor_high[i] ? loop->sensor_high[i] : wrapped;
        const double limited = held < loop->sensor_low[i] ? loop->sensor_low[i] : held;
        const double value = with_faulty_bits(loop, k, i, delayed(loop, k, i, limited));
        const float narrow = (float)value;
        if (loop->single) memcpy(in + loop->sensor_offset[i], &narrow, sizeof narrow);
        else memcpy(in + loop->sensor_offset[i], &value, sizeof value);
    }
}

static void command(const loop_t *loop, int64_t k, double *values) {
    const char *const out = loop->last_out + k * loop->last_out_size;
    for (int64_t i = 0; i < loop->commands; i++) {
        float narrow;
        if (loop->single) {
            memcpy(&narrow, out + loop->command_offset[i], sizeof narrow);
            values[i] = (double)narrow;
        } else memcpy(&values[i], out + loop->command_offset[i], sizeof values[i]);
    }
}

static void mix(const loop_t *loop, const double *commands, int64_t substep, double *u) {
    for (int64_t j = 0; j < N_U; j++) {
        u[j] = loop->forcing[substep * N_U + j];
        for (int64_t i = 0; i < loop->commands; i++) {
            const double weight = loop->mixing[j * loop->commands + i];
            /* 0 times infinity is NaN: an infinite command must not reach an input with weight 0. */
            if (weight != 0.0) u[j] += weight * commands[i];
        }
        if (!loop->input_gain) continue;
        const int64_t i = substep / loop->substeps * N_U + j;
        const double gain = loop->input_gain[i], bias = loop->input_bias[i], forcing = loop->forcing[substep * N_U + j];
        if (gain != 1.0 || bias != 0.0) u[j] = forcing + (gain != 0.0 ? gain * (u[j] - forcing) : 0.0) + bias;
    }
}

static void run_block(const drive_block_t *block, int64_t k) {
    char *const in = block->in + k * block->in_size;
    for (int64_t i = 0; i < block->members; i++) {
        memcpy(in + block->offset[i], block->source[i] + k * block->stride[i], (size_t)block->size[i]);
    }
    block->faults[k] = block->step(block->state, in, block->out + k * block->out_size);
}

static void keep(char *out, int64_t size, uint32_t *faults) {
    memcpy(out, out - size, (size_t)size);
    faults[0] = faults[-1];
}

static void call(const loop_t *loop, int64_t k) {
    char *const out = loop->out + k * loop->out_size;
    const int missed = k > 0 && loop->missed && loop->missed[k];
    if (missed) keep(out, loop->out_size, loop->faults + k);
    else loop->faults[k] = loop->step(loop->state, loop->in + k * loop->in_size, out);
    for (int64_t i = 0; i < loop->drive_blocks; i++) {
        const drive_block_t *const block = loop->drive + i;
        if (missed) keep(block->out + k * block->out_size, block->out_size, block->faults + k);
        else run_block(block, k);
    }
}

void synth_closed_loop(const loop_t *loop) {
    const double h = loop->period / (double)loop->substeps;
    double *const u = loop->input, y[N_Y];
    if (loop->first == 0) mix(loop, loop->waiting, 0, u);
    for (int64_t k = loop->first; k < loop->samples; k++) {
        const double *const given[3] = {loop->x, u, loop->p};
        evaluate(synth_plant_h, given, y);
        memcpy(loop->states + k * N_X, loop->x, N_X * sizeof *y);
        memcpy(loop->outputs + k * N_Y, y, N_Y * sizeof *y);
        measure(loop, k, y);
        call(loop, k);
        double *const slot = loop->waiting + (loop->delay ? k % loop->delay : 0) * loop->commands;
        if (loop->delay == 0) command(loop, k, slot);
        for (int64_t j = 0; j < loop->substeps; j++) {
            mix(loop, slot, k * loop->substeps + j, u);
            if (j == 0) memcpy(loop->applied + k * N_U, u, N_U * sizeof *u);
            rk4(loop, u, (double)(k * loop->substeps + j) * h, h);
            stop(loop);
        }
        if (loop->delay > 0) command(loop, k, slot);
    }
}
