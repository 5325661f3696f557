/* The simulated plant: Runge-Kutta steps of its equations between samples, as `synth simulate` takes them.
 *
 * The order of operations is that of `synth simulate`, so that the readings are equal bit for bit. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "io.h"
#include "plant.h"
#include "stage.h"

static struct {
    double x[N_STATES], u[N_INPUTS];
    double held[N_OUTPUTS], due[N_OUTPUTS]; /* outputs in this period, and in the next one */
    uint64_t noise;                         /* state of the generator */
    int running;                            /* 1 after the first sample */
} plant;

static void evaluate(int (*f)(const double **, double **, long long *, double *, int), const double *x, double *result)
{
    const double *arg[SIZE_ARG] = {x, plant.u, PLANT_PARAMETERS};
    double *res[SIZE_RES] = {result};
    long long iw[SIZE_IW];
    double w[SIZE_W];
    (void)f(arg, res, iw, w, 0);
}

static void runge_kutta(double h)
{
    double k1[N_STATES], k2[N_STATES], k3[N_STATES], k4[N_STATES], z[N_STATES], *const x = plant.x;
    evaluate(plant_f, x, k1);
    for (int i = 0; i < N_STATES; i++) z[i] = x[i] + 0.5 * h * k1[i];
    evaluate(plant_f, z, k2);
    for (int i = 0; i < N_STATES; i++) z[i] = x[i] + 0.5 * h * k2[i];
    evaluate(plant_f, z, k3);
    for (int i = 0; i < N_STATES; i++) z[i] = x[i] + h * k3[i];
    evaluate(plant_f, z, k4);
    for (int i = 0; i < N_STATES; i++) x[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
}

/* Stops are inelastic. */
static void meet_stops(void)
{
    for (int i = 0; i < N_STOPS; i++) {
        const stop_t *const stop = &PLANT_STOPS[i];
        double *const position = &plant.x[stop->position], *const velocity = &plant.x[stop->velocity];
        const int below = *position < stop->low, above = *position > stop->high;
        if (below) *position = stop->low;
        if (above) *position = stop->high;
        if ((below && *velocity < 0.0) || (above && *velocity > 0.0)) *velocity = 0.0;
    }
}

static void mix(void)
{
    for (int j = 0; j < N_INPUTS; j++) {
        plant.u[j] = 0.0;
        for (int i = 0; i < N_OUTPUTS; i++) {
            const double weight = PLANT_MIXING[j][i];
            if (weight < 0.0 || weight > 0.0) plant.u[j] += weight * plant.held[i];
        }
    }
}

static void advance(void)
{
    for (int j = 0; j < SUBSTEPS; j++) {
        runge_kutta(STAGE_PERIOD_S / (double)SUBSTEPS);
        meet_stops();
    }
}

/* A standard normal number: the sum of twelve uniform ones, each 16 bits of a 64-bit generator (splitmix64). */
static double normal(void)
{
    uint64_t sum = 0u;
    for (int i = 0; i < 3; i++) {
        uint64_t z = (plant.noise += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        z ^= z >> 31;
        for (int k = 0; k < 4; k++) sum += (z >> (16 * k)) & 0xffffu;
    }
    return (double)sum / 65536.0 - 6.0;
}

static int open_plant(const io_options_t *options)
{
    memset(&plant, 0, sizeof plant);
    memcpy(plant.x, PLANT_START, sizeof plant.x);
    memcpy(plant.held, PLANT_HOLD, sizeof plant.held);
    memcpy(plant.due, PLANT_HOLD, sizeof plant.due);
    plant.noise = (uint64_t)options->seed;
    mix();
    /* A machine that is switched on lies on its stop, at rest: it has friction there, which no plant models. */
    for (double t = 0.0; options->settle && t < 2.0; t += STAGE_PERIOD_S) advance();
    for (int i = 0; options->settle && i < N_VELOCITIES; i++) plant.x[PLANT_VELOCITIES[i]] = 0.0;
    return 0;
}

static int read_plant(double sensors[])
{
    double y[N_PLANT_OUTPUTS];
    if (plant.running) advance();
    plant.running = 1;
    evaluate(plant_h, plant.x, y);
    for (int i = 0; i < N_SENSORS; i++) {
        const sensor_model_t *const s = &PLANT_SENSORS[i];
        const double scaled = y[s->source] + 0.0; /* -0 becomes 0 */
        const double seen = (s->noise > 0.0) ? scaled + s->noise * normal() : scaled;
        const double counted = (s->resolution > 0.0) ? s->resolution * rint(seen / s->resolution) : seen;
        sensors[i] = (s->wraps > 0.0) ? counted - s->wraps * floor((counted - s->low) / s->wraps) : counted;
    }
    memcpy(plant.held, plant.due, sizeof plant.held);
    mix();
    return 0;
}

/* Dead amplifiers drive nothing. */
static int write_plant(const double outputs[], int enabled)
{
    for (int i = 0; i < N_OUTPUTS; i++) plant.due[i] = enabled ? outputs[i] : 0.0;
#if STAGE_DELAY == 0
    memcpy(plant.held, plant.due, sizeof plant.held);
    mix();
#endif
    return 0;
}

static void close_plant(void)
{
}

const io_t IO_PLANT = {"plant", open_plant, read_plant, write_plant, close_plant};
