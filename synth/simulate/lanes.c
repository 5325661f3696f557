/* Sampled controllers around continuous plants, LANES loops side by side; closed_loop.c states the equations of one.
 *
 * A row of an array is one vector, the values of a signal in all lanes. lanes.h gives LANES, the numbers of rows N_...,
 * the vectors `scalar` and `counter` of the controller, and the functions plant_f, plant_h and controller_step.
 * The caller owns every array. All members of loop_t are eight bytes wide.
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "lanes.h"

typedef struct {
    int64_t samples, substeps, delay;
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
    const vd *sensor_gain, *sensor_bias, *sensor_resolution, *sensor_low, *sensor_high;
    const vd *noise;           /* 0, or (samples, sensors) */
    const uint8_t *overridden; /* 0, or (samples, sensors): the input holds this sample already */

    int64_t commands;
    const int64_t *command_output; /* row of the controller's output */
    const double *mixing;          /* (N_U, commands) */
    const double *forcing;         /* (samples or 1, substeps, N_U) */
    int64_t forcing_stride;        /* substeps N_U, or 0 */
    vd *waiting;                   /* (max(delay, 1), commands): computed and not yet applied */

    scalar *reals; /* (N_REALS) */
    counter *counters;
    scalar *in, *out; /* (samples, N_IN), (samples, N_OUT) */
    counter *faults;  /* (samples) */

    vd *states, *outputs, *applied; /* (samples, N_X), (samples, N_Y), (samples, N_U) */
} loop_t;

static void derivative(const loop_t *loop, const vd *x, const vd *u, vd *dx) {
    plant_f(x, u, loop->p, dx);
    for (int i = 0; i < N_X; i++) {
        if (loop->locked[i]) dx[i] = vd_all(0.0);
    }
    *loop->left |= dx[N_X] != vd_all(0.0);
}

#if N_POSITIONS > 0
static const int positions[N_POSITIONS] = {POSITIONS}, velocities[N_POSITIONS] = {VELOCITIES};

/* Nystrom's method of order 5 for q'' = a(q, u), with four stages a period. */
static void advance(const loop_t *loop, const vd *u, double h) {
    static const double C[4] = {0.0, 1.0 / 5.0, 2.0 / 3.0, 1.0};
    static const double A[4][3] = {
        {0.0, 0.0, 0.0}, {1.0 / 50.0, 0.0, 0.0}, {-1.0 / 27.0, 7.0 / 27.0, 0.0}, {3.0 / 10.0, -2.0 / 35.0, 9.0 / 35.0}};
    static const double POSITION[4] = {14.0 / 336.0, 100.0 / 336.0, 54.0 / 336.0, 0.0};
    static const double VELOCITY[4] = {14.0 / 336.0, 125.0 / 336.0, 162.0 / 336.0, 35.0 / 336.0};
    vd *const x = loop->x;
    vd k[4][N_X + 1], z[N_X];
    memcpy(z, x, sizeof z);
    for (int s = 0; s < 4; s++) {
        for (int i = 0; i < N_POSITIONS; i++) {
            const int q = positions[i], v = velocities[i];
            vd sum = vd_all(0.0);
            for (int j = 0; j < s; j++) sum += vd_all(A[s][j]) * k[j][v];
            z[q] = loop->locked[q] ? x[q] : x[q] + vd_all(C[s] * h) * x[v] + vd_all(h * h) * sum;
        }
        derivative(loop, z, u, k[s]);
    }
    for (int i = 0; i < N_POSITIONS; i++) {
        const int q = positions[i], v = velocities[i];
        vd position = vd_all(0.0), velocity = vd_all(0.0);
        for (int s = 0; s < 4; s++) {
            position += vd_all(POSITION[s]) * k[s][v];
            velocity += vd_all(VELOCITY[s]) * k[s][v];
        }
        if (loop->locked[q]) continue;
        x[q] += vd_all(h) * x[v] + vd_all(h * h) * position;
        x[v] += vd_all(h) * velocity;
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

static void measure(const loop_t *loop, int64_t k, const vd *y) {
    for (int64_t i = 0; i < loop->sensors; i++) {
        if (loop->overridden && loop->overridden[k * loop->sensors + i]) continue;
        const vd step = loop->sensor_resolution[i];
        vd seen = loop->sensor_gain[i] * y[loop->sensor_source[i]] + loop->sensor_bias[i];
        if (loop->noise) seen += loop->noise[k * loop->sensors + i];
        const vd value = vd_choose(step > vd_all(0.0), step * nearest_whole(seen / step), seen);
        const vd held = vd_choose(value > loop->sensor_high[i], loop->sensor_high[i], value);
        const vd limited = vd_choose(held < loop->sensor_low[i], loop->sensor_low[i], held);
        loop->in[k * N_IN + loop->sensor_input[i]] = __builtin_convertvector(limited, scalar);
    }
}

static void command(const loop_t *loop, int64_t k, vd *values) {
    for (int64_t i = 0; i < loop->commands; i++)
        values[i] = __builtin_convertvector(loop->out[k * N_OUT + loop->command_output[i]], vd);
}

static void mix(const loop_t *loop, const vd *commands, int64_t k, int64_t substep, vd *u) {
    const double *const forcing = loop->forcing + k * loop->forcing_stride + substep * N_U;
    for (int64_t j = 0; j < N_U; j++) {
        u[j] = vd_all(forcing[j]);
        for (int64_t i = 0; i < loop->commands; i++) {
            const double weight = loop->mixing[j * loop->commands + i];
            if (weight != 0.0) u[j] += vd_all(weight) * commands[i];
        }
    }
}

void synth_lanes(const loop_t *loop) {
    const double h = loop->period / (double)loop->substeps;
    vd u[N_U], y[N_Y];
    mix(loop, loop->waiting, 0, 0, u);
    for (int64_t k = 0; k < loop->samples; k++) {
        plant_h(loop->x, u, loop->p, y);
        memcpy(loop->states + k * N_X, loop->x, N_X * sizeof *y);
        memcpy(loop->outputs + k * N_Y, y, N_Y * sizeof *y);
        measure(loop, k, y);
        controller_step(loop->reals, loop->counters, loop->in + k * N_IN, loop->out + k * N_OUT, loop->faults + k);
        vd *const slot = loop->waiting + (loop->delay ? k % loop->delay : 0) * loop->commands;
        if (loop->delay == 0) command(loop, k, slot);
        for (int64_t j = 0; j < loop->substeps; j++) {
            if (j == 0 || loop->forcing_stride) mix(loop, slot, k, j, u);
            if (j == 0) memcpy(loop->applied + k * N_U, u, N_U * sizeof *u);
            advance(loop, u, h);
            stop(loop);
        }
        if (loop->delay > 0) command(loop, k, slot);
    }
}
