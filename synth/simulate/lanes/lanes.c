/* Sampled controllers around continuous plants, LANES loops side by side; closed_loop.c states the equations of one.
 *
 * A row of an array is one vector, the values of a signal in all lanes. lanes.h gives LANES, the numbers of rows N_...,
 * the vectors `scalar` and `counter` of the controller and its drive with their elements `number` and `word`, and the
 * functions plant_f, plant_h and run_blocks. The caller owns every array. All members of loop_t are eight bytes wide.
 *
 * The signals of one sample stay in vectors. Those that are recorded collect in blocks of BLOCK frames, from which each
 * lane gets a column of its own.
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "lanes.h"

typedef struct {
    int64_t samples, substeps, delay, order, every;
    double period;
    const vd *p; /* (N_P) */
    vd *x;       /* (N_X) */
    vmd *left;   /* (1): in this lane a variable has left the range of its polynomials */
    const int64_t *locked; /* (N_X): this state keeps its value */

    int64_t stops;
    const int64_t *stop_position, *stop_velocity;
    const double *stop_low, *stop_high;
    vd *impact; /* (stops): largest speed of an impact */

    int64_t sensors;
    const int64_t *sensor_source, *sensor_input; /* plant output; row of the controller's input */
    const vd *sensor_gain, *sensor_bias, *sensor_resolution, *sensor_low, *sensor_high, *sensor_span;
    const vd *noise;           /* 0, or (samples, sensors) */
    const uint8_t *overridden; /* 0, or (samples, sensors): the input holds this sample already */

    int64_t commands;
    const int64_t *command_output; /* row of the controller's output */
    int64_t weights;               /* of commands in the plant's inputs, input by input */
    const int64_t *weight_input, *weight_command;
    const double *weight;
    const double *forcing;         /* (samples or 1, substeps, N_U) */
    int64_t forcing_stride;        /* substeps N_U, or 0 */
    vd *waiting;                   /* (max(delay, 1), commands): computed and not yet applied */

    scalar *reals; /* (N_REALS) */
    counter *counters;
    const number *constants; /* of all Blocks, one Block after another */
    scalar *in, *out; /* (N_IN), (N_OUT): inputs that stay constant are set */

    int64_t commons, separates; /* inputs that vary, in all lanes alike and in each lane */
    const int64_t *common_row, *separate_row;
    const number *common;   /* (samples, commons) */
    const scalar *separate; /* (samples, separates) */

    int64_t wides, narrows; /* recorded rows of (states, outputs, applied) and of (in, out); every `every` samples */
    const int64_t *wide_row, *narrow_row;
    double *wide;   /* (wides, LANES, frames) */
    number *narrow; /* (narrows, LANES, frames) */
    word *faults;   /* (N_BLOCKS, LANES, frames): bits of all samples since the frame before */
} loop_t;

enum { BLOCK = 128 };

typedef struct {
    const vd *wide[N_X + N_Y + N_U + 1];
    const scalar *narrow[N_IN + N_OUT];
    vd wides[N_X + N_Y + N_U + 1][BLOCK];
    scalar narrows[N_IN + N_OUT][BLOCK];
    counter bits[N_BLOCKS], faults[N_BLOCKS][BLOCK];
    int64_t frames, block; /* frames in the record, and in the block */
} record_t;

static void derivative(const loop_t *loop, const vd *x, const vd *u, vd *dx) {
    plant_f(x, u, loop->p, dx);
    for (int i = 0; i < N_X; i++) {
        if (loop->locked[i]) dx[i] = vd_all(0.0);
    }
    *loop->left |= dx[N_X] != vd_all(0.0);
}

#if N_POSITIONS > 0
static const int positions[N_POSITIONS] = {POSITIONS}, velocities[N_POSITIONS] = {VELOCITIES};

typedef struct {
    double c[4], a[4][3], position[4], velocity[4];
} nystrom_t;

static const nystrom_t ORDER_3 = {
    {0.0, 2.0 / 3.0}, {{0.0}, {2.0 / 9.0}}, {1.0 / 4.0, 1.0 / 4.0}, {1.0 / 4.0, 3.0 / 4.0}};
static const nystrom_t ORDER_4 = {
    {0.0, 1.0 / 2.0, 1.0},
    {{0.0}, {1.0 / 8.0}, {0.0, 1.0 / 2.0}},
    {1.0 / 6.0, 1.0 / 3.0},
    {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0}};
static const nystrom_t ORDER_5 = {
    {0.0, 1.0 / 5.0, 2.0 / 3.0, 1.0},
    {{0.0}, {1.0 / 50.0}, {-1.0 / 27.0, 7.0 / 27.0}, {3.0 / 10.0, -2.0 / 35.0, 9.0 / 35.0}},
    {14.0 / 336.0, 100.0 / 336.0, 54.0 / 336.0},
    {14.0 / 336.0, 125.0 / 336.0, 162.0 / 336.0, 35.0 / 336.0}};

/* Nystrom's methods for q'' = a(q, u): Hairer, Norsett and Wanner, Solving ODEs I, section II.14. */
__attribute__((always_inline)) static inline void nystrom(
    const loop_t *loop, const vd *u, double h, const nystrom_t method, const int stages) {
    vd *const x = loop->x;
    vd k[4][N_X + 1], z[N_X];
    memcpy(z, x, sizeof z);
    for (int s = 0; s < stages; s++) {
        for (int i = 0; i < N_POSITIONS; i++) {
            const int q = positions[i], v = velocities[i];
            vd sum = vd_all(0.0);
            for (int j = 0; j < s; j++) sum += vd_all(method.a[s][j]) * k[j][v];
            z[q] = loop->locked[q] ? x[q] : x[q] + vd_all(method.c[s] * h) * x[v] + vd_all(h * h) * sum;
        }
        derivative(loop, z, u, k[s]);
    }
    for (int i = 0; i < N_POSITIONS; i++) {
        const int q = positions[i], v = velocities[i];
        vd position = vd_all(0.0), velocity = vd_all(0.0);
        for (int s = 0; s < stages; s++) {
            position += vd_all(method.position[s]) * k[s][v];
            velocity += vd_all(method.velocity[s]) * k[s][v];
        }
        if (loop->locked[q]) continue;
        x[q] += vd_all(h) * x[v] + vd_all(h * h) * position;
        x[v] += vd_all(h) * velocity;
    }
}

static void advance(const loop_t *loop, const vd *u, double h) {
    switch (loop->order) {
        case 3: nystrom(loop, u, h, ORDER_3, 2); break;
        case 4: nystrom(loop, u, h, ORDER_4, 3); break;
        default: nystrom(loop, u, h, ORDER_5, 4);
    }
}
#else
/* Runge and Kutta's method of order 4. */
static void advance(const loop_t *loop, const vd *u, double h) {
    const vd half = vd_all(0.5 * h), whole = vd_all(h), sixth = vd_all(h / 6.0), two = vd_all(2.0);
    vd *const x = loop->x;
    vd k1[N_X + 1], k2[N_X + 1], k3[N_X + 1], k4[N_X + 1], z[N_X];
    derivative(loop, x, u, k1);
    for (int i = 0; i < N_X; i++) z[i] = x[i] + half * k1[i];
    derivative(loop, z, u, k2);
    for (int i = 0; i < N_X; i++) z[i] = x[i] + half * k2[i];
    derivative(loop, z, u, k3);
    for (int i = 0; i < N_X; i++) z[i] = x[i] + whole * k3[i];
    derivative(loop, z, u, k4);
    for (int i = 0; i < N_X; i++) x[i] = x[i] + sixth * (k1[i] + two * (k2[i] + k3[i]) + k4[i]);
}
#endif

static void stop(const loop_t *loop) {
    for (int64_t i = 0; i < loop->stops; i++) {
        vd *const position = &loop->x[loop->stop_position[i]], *const velocity = &loop->x[loop->stop_velocity[i]];
        const vd low = vd_all(loop->stop_low[i]), high = vd_all(loop->stop_high[i]), zero = vd_all(0.0);
        const vd q = *position, v = *velocity, speed = vd_fabs(v);
        const vmd below = q < low, above = q > high;
        const vmd hit = (below & (v < zero)) | (above & (v > zero));
        *position = vd_choose(below, low, vd_choose(above, high, q));
        loop->impact[i] = vd_choose(hit & (speed > loop->impact[i]), speed, loop->impact[i]);
        *velocity = vd_choose(hit, zero, v);
    }
}

static vd nearest_whole(vd a) {
    const vd magic = vd_all(0x1.8p52); /* halves to even, like rint, while |a| < 2^51; beyond, the count is lost */
    return (a + magic) - magic;
}

static void set_inputs(const loop_t *loop, int64_t k) {
    for (int64_t i = 0; i < loop->commons; i++)
        for (int l = 0; l < LANES; l++) loop->in[loop->common_row[i]][l] = loop->common[k * loop->commons + i];
    for (int64_t i = 0; i < loop->separates; i++)
        loop->in[loop->separate_row[i]] = loop->separate[k * loop->separates + i];
}

static void measure(const loop_t *loop, int64_t k, const vd *y) {
    for (int64_t i = 0; i < loop->sensors; i++) {
        if (loop->overridden && loop->overridden[k * loop->sensors + i]) continue;
        const vd step = loop->sensor_resolution[i];
        vd seen = loop->sensor_gain[i] * y[loop->sensor_source[i]] + loop->sensor_bias[i];
        if (loop->noise) seen += loop->noise[k * loop->sensors + i];
        const vd counted = vd_choose(step > vd_all(0.0), step * nearest_whole(seen / step), seen);
        const vd span = loop->sensor_span[i], turns = (counted - loop->sensor_low[i]) / span;
        const vd nearest = nearest_whole(turns), whole = vd_choose(nearest > turns, nearest - vd_all(1.0), nearest);
        const vd value = vd_choose(span > vd_all(0.0), counted - span * whole, counted);
        const vd held = vd_choose(value > loop->sensor_high[i], loop->sensor_high[i], value);
        const vd limited = vd_choose(held < loop->sensor_low[i], loop->sensor_low[i], held);
        loop->in[loop->sensor_input[i]] = __builtin_convertvector(limited, scalar);
    }
}

static void command(const loop_t *loop, vd *values) {
    for (int64_t i = 0; i < loop->commands; i++)
        values[i] = __builtin_convertvector(loop->out[loop->command_output[i]], vd);
}

static void mix(const loop_t *loop, const vd *commands, int64_t k, int64_t substep, vd *u) {
    const double *const forcing = loop->forcing + k * loop->forcing_stride + substep * N_U;
    for (int64_t j = 0; j < N_U; j++) u[j] = vd_all(forcing[j]);
    for (int64_t i = 0; i < loop->weights; i++)
        u[loop->weight_input[i]] += vd_all(loop->weight[i]) * commands[loop->weight_command[i]];
}

/* Append the frames of a block, a vector each, to the columns of the lanes: one lane after another, since the columns
 * lie far from each other in memory. Eight frames of eight doubles are a matrix, which is transposed in registers. */
#define APPEND(name, element, vector) \
    static void append_##name(const vector *block, int64_t n, element *columns, int64_t length) { \
        for (int l = 0; l < LANES; l++) { \
            for (int64_t i = 0; i < n; i++) columns[l * length + i] = block[i][l]; \
        } \
    }
APPEND(narrow, number, scalar)
APPEND(faults, word, counter)
#if LANES == 8
static void append_wide(const vd *block, int64_t n, double *columns, int64_t length) {
    int64_t i = 0;
    for (; i + LANES <= n; i += LANES) {
        vd pairs[LANES], fours[LANES]; /* of frames: vectors of 2, then of 4 frames of each lane */
        for (int k = 0; k < LANES; k += 2) {
            const vd a = block[i + k], b = block[i + k + 1];
            pairs[k] = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
            pairs[k + 1] = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
        }
        for (int k = 0; k < LANES; k += k % 4 ? 3 : 1) {
            fours[k] = __builtin_shufflevector(pairs[k], pairs[k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            fours[k + 2] = __builtin_shufflevector(pairs[k], pairs[k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
        for (int l = 0; l < LANES / 2; l++) {
            const vd low = __builtin_shufflevector(fours[l], fours[l + 4], 0, 1, 2, 3, 8, 9, 10, 11);
            const vd high = __builtin_shufflevector(fours[l], fours[l + 4], 4, 5, 6, 7, 12, 13, 14, 15);
            memcpy(columns + l * length + i, &low, sizeof low);
            memcpy(columns + (l + 4) * length + i, &high, sizeof high);
        }
    }
    for (; i < n; i++)
        for (int l = 0; l < LANES; l++) columns[l * length + i] = block[i][l];
}
#else
APPEND(wide, double, vd)
#endif

static void write_block(const loop_t *loop, record_t *record, int64_t length) {
    const int64_t first = record->frames - record->block, n = record->block;
    for (int64_t i = 0; i < loop->wides; i++)
        append_wide(record->wides[i], n, loop->wide + i * LANES * length + first, length);
    for (int64_t i = 0; i < loop->narrows; i++)
        append_narrow(record->narrows[i], n, loop->narrow + i * LANES * length + first, length);
    for (int64_t i = 0; i < N_BLOCKS; i++)
        append_faults(record->faults[i], n, loop->faults + i * LANES * length + first, length);
    record->block = 0;
}

static void keep(const loop_t *loop, record_t *record, int64_t k) {
    if (k % loop->every) return;
    const int64_t b = record->block++, length = (loop->samples + loop->every - 1) / loop->every;
    for (int64_t i = 0; i < loop->wides; i++) record->wides[i][b] = *record->wide[i];
    for (int64_t i = 0; i < loop->narrows; i++) record->narrows[i][b] = *record->narrow[i];
    for (int64_t i = 0; i < N_BLOCKS; i++) {
        record->faults[i][b] = record->bits[i];
        record->bits[i] = (counter){0};
    }
    record->frames++;
    if (record->block == BLOCK || record->frames == length) write_block(loop, record, length);
}

static void begin(const loop_t *loop, record_t *record, const vd *y, const vd *u) {
    record->frames = record->block = 0;
    memset(record->bits, 0, sizeof record->bits);
    for (int64_t i = 0; i < loop->wides; i++) {
        const int64_t row = loop->wide_row[i];
        record->wide[i] = row < N_X ? loop->x + row : row < N_X + N_Y ? y + (row - N_X) : u + (row - N_X - N_Y);
    }
    for (int64_t i = 0; i < loop->narrows; i++) {
        const int64_t row = loop->narrow_row[i];
        record->narrow[i] = row < N_IN ? loop->in + row : loop->out + (row - N_IN);
    }
}

void synth_lanes(const loop_t *loop) {
    const double h = loop->period / (double)loop->substeps;
    vd u[N_U + 1], y[N_Y + 1];
    counter faults[N_BLOCKS];
    record_t record;
    begin(loop, &record, y, u);
    mix(loop, loop->waiting, 0, 0, u);
    for (int64_t k = 0; k < loop->samples; k++) {
        plant_h(loop->x, u, loop->p, y);
        set_inputs(loop, k);
        measure(loop, k, y);
        run_blocks(loop->in, loop->constants, loop->out, loop->reals, loop->counters, faults);
        for (int64_t i = 0; i < N_BLOCKS; i++) record.bits[i] |= faults[i];
        vd *const slot = loop->waiting + (loop->delay ? k % loop->delay : 0) * loop->commands;
        if (loop->delay == 0) command(loop, slot);
        for (int64_t j = 0; j < loop->substeps; j++) {
            if (j == 0 || loop->forcing_stride) mix(loop, slot, k, j, u);
            if (j == 0) keep(loop, &record, k);
            advance(loop, u, h);
            stop(loop);
        }
        if (loop->delay > 0) command(loop, slot);
    }
}
