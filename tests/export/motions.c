/* The machine around a stage that does nothing: a motion is held, or stopped and then held, at any of its samples.
 * Prints the largest part of the limit of an acceleration that the set-points used, and the longest time to their rest;
 * without a motion, the set-points under one that is not a number. */
#include <math.h>
#include <stdio.h>

#include "machine.h"

enum { EVERY = 7, HOLD_AFTER = 20 }; /* samples */

const signal_t SENSORS[] = {{"z", "m", -1.0, 1.0, 1.0}, {"x", "m", -1.0, 1.0, 1.0}};
const signal_t SET_POINTS[] = {{"z_ref", "m", -0.1, 0.1, 0.0}, {"x_ref", "m", -0.1, 0.1, 0.0}};
const limits_t LIMITS[] = {{0.0, 1.0, 7.93, 1e4, 1e-3, 1}, {0.0, 1.0, 7.93, 1e4, 1e-3, 1}};

uint32_t stage_step(stage_t *stage, const double sensors[], const double set_points[], double missed, double outputs[])
{
    (void)stage;
    (void)sensors;
    (void)set_points;
    (void)missed;
    (void)outputs;
    return 0u;
}

void stage_init(stage_t *stage, const double sensors[], const double set_points[])
{
    (void)stage;
    (void)sensors;
    (void)set_points;
}

int stage_safe_step(stage_t *stage, double outputs[])
{
    (void)stage;
    (void)outputs;
    return 1;
}

void stage_pose(const double sensors[], double set_points[])
{
    (void)sensors;
    (void)set_points;
}

void stage_tune(stage_t *stage, const levitator_2dof_parameters_t *parameters)
{
    (void)stage;
    (void)parameters;
}

void stage_move(stage_t *stage)
{
    (void)stage;
}

static void run(const motion_t *motion, long at, int stops, double *used, double *longest)
{
    const double sensors[N_SENSORS] = {0.0};
    double last[SET_POINTS_SIZE] = {0.0}, speed[SET_POINTS_SIZE] = {0.0};
    machine_t m;
    machine_init(&m, 1);
    m.phase = RUNNING;
    m.enabled = 1;
    machine_command(&m, &(command_t){.order = COMMAND_MOTION, .motion = *motion});
    long k = 0;
    for (; k == 0 || m.phase == BRAKING || machine_is_moving(&m); k++) {
        if (k == at) machine_command(&m, &(command_t){.order = stops ? COMMAND_STOP : COMMAND_HOLD});
        if (k == at + HOLD_AFTER) machine_command(&m, &(command_t){.order = COMMAND_HOLD});
        machine_sample(&m, sensors, 0.0);
        for (int i = 0; i < N_SET_POINTS; i++) {
            const double v = (m.set_points[i] - last[i]) / STAGE_PERIOD_S;
            *used = fmax(*used, fabs(v - speed[i]) / STAGE_PERIOD_S / LIMITS[i].acceleration);
            speed[i] = v;
            last[i] = m.set_points[i];
        }
    }
    *longest = fmax(*longest, (double)(k - at) * STAGE_PERIOD_S - (stops ? SETTLE_S : 0.0));
}

int main(int count, char *words[])
{
    double from[SET_POINTS_SIZE] = {0.0}, used = 0.0, longest = 0.0;
    motion_t motion;
    char message[256];
    if (count == 1) {
        double r[SET_POINTS_SIZE] = {0.05, -0.05};
        motion_at(&(motion_t){.kind = MOTION_SINE, .a = {1e-3}, .duration = 1.0, .frequency = INFINITY}, 0.5, r);
        (void)printf("%g %g\n", r[0], r[1]);
        return 0;
    }
    if (motion_parse(words + 1, count - 1, from, &motion, message, sizeof message) != 0) {
        (void)puts(message);
        return 1;
    }
    for (long k = 0; (double)k * STAGE_PERIOD_S < motion.duration; k += EVERY) {
        for (int stops = 0; stops < 2; stops++) run(&motion, k, stops, &used, &longest);
    }
    (void)printf("%.4f %.4f\n", used, longest);
    return 0;
}
