#include "machine.h"

#include <math.h>
#include <string.h>

#define SAMPLES(seconds) ((uint64_t)((seconds) / STAGE_PERIOD_S))
#define GOOD_S 0.1    /* of good sensors before a start */
#define REST_S 0.25   /* without a movement before a start */
#define ENABLE_S 0.1  /* under the safe output, until the amplifiers are on */
#define BRAKE_S 0.1   /* at least, in which the set-points of a held motion come to rest on its path */
#define STILL_S 0.5   /* of unchanged outputs after a latch, before the amplifiers go off */
#define KEPT_S 2.0    /* of the safe output, before the process may end and leave it on */

const char *const PHASES[] = {
    "waiting", "enabling", "starting", "running", "braking", "latched", "stopping", "disabled",
};

void machine_init(machine_t *machine, int prompt)
{
    *machine = (machine_t){.phase = WAITING, .prompt = prompt, .rate = 1.0};
}

int machine_is_moving(const machine_t *machine)
{
    return machine->motion.kind != MOTION_NONE;
}

int machine_may_end(const machine_t *machine)
{
    return machine->phase == DISABLED || (machine->phase > BRAKING && machine->since >= SAMPLES(KEPT_S));
}

int machine_may_start(const machine_t *machine)
{
    return machine_may_end(machine) && machine->rest.quiet >= SAMPLES(REST_S);
}

/* 1 where the amplifiers may go off: not under a machine in flight whose safe output lowers it. */
static int may_disable(const machine_t *machine)
{
    return STAGE_SAFE_IS_OFF || (STAGE_RESTS_OFF && machine->rest.quiet >= SAMPLES(REST_S));
}

static void enter(machine_t *machine, phase_t phase)
{
    machine->phase = phase;
    machine->since = 0u;
    if (phase > BRAKING) machine->motion.kind = MOTION_NONE;
    if (phase == DISABLED) machine->enabled = 0;
}

/* A machine in motion brakes first. After a latch the step itself leads to the safe outputs. */
static void stop(machine_t *machine, const char *reason, int at_once)
{
    if (machine->phase > BRAKING || (machine->phase == BRAKING && !at_once)) return;
    machine->reason = reason;
    machine->holding = 1;
    enter(machine, !machine->enabled ? DISABLED : (machine_is_moving(machine) && !at_once) ? BRAKING : STOPPING);
}

/* A motion was checked from its own start; from elsewhere it would jump. */
static int starts_here(const machine_t *machine, const motion_t *motion)
{
    int here = 1;
    for (int i = 0; i < N_SET_POINTS; i++) {
        const double far = fabs(machine->set_points[i] - motion->from[i]);
        here &= far <= 1e-9 * (SET_POINTS[i].high - SET_POINTS[i].low);
    }
    return here;
}

void machine_command(machine_t *machine, const command_t *command)
{
    switch (command->order) {
    case COMMAND_MOTION:
        if (machine->phase == RUNNING && !machine_is_moving(machine) && starts_here(machine, &command->motion)) {
            machine->motion = command->motion;
            machine->t = 0.0;
            machine->rate = 1.0;
            machine->holding = 0;
        }
        break;
    case COMMAND_HOLD: machine->holding |= machine->phase == RUNNING; break;
    case COMMAND_START:
        if (machine_may_start(machine)) enter(machine, WAITING);
        break;
    case COMMAND_STOP: stop(machine, command->reason, command->at_once); break;
    default: break;
    }
}

/* The rate of a held motion in the next sample. Its acceleration is a rate^2 + v d(rate)/dt, where v and a are those of
 * the motion at its rate of 1: what a leaves of each limit is there to brake with. */
static double brake(const machine_t *machine)
{
    double before[SET_POINTS_SIZE], here[SET_POINTS_SIZE], after[SET_POINTS_SIZE], slower = STAGE_PERIOD_S / BRAKE_S;
    memcpy(before, machine->set_points, sizeof before);
    memcpy(here, machine->set_points, sizeof here);
    memcpy(after, machine->set_points, sizeof after);
    motion_at(&machine->motion, machine->t - STAGE_PERIOD_S, before);
    motion_at(&machine->motion, machine->t, here);
    motion_at(&machine->motion, machine->t + STAGE_PERIOD_S, after);
    for (int i = 0; i < N_SET_POINTS; i++) {
        const double v = (after[i] - before[i]) / (2.0 * STAGE_PERIOD_S);
        const double bend = (after[i] - 2.0 * here[i] + before[i]) / (STAGE_PERIOD_S * STAGE_PERIOD_S);
        const double a = machine->rate * machine->rate * bend;
        const double left = fmax(LIMITS[i].acceleration + (v > 0.0 ? a : -a), 0.0);
        if (fabs(v) * slower > left * STAGE_PERIOD_S) slower = left * STAGE_PERIOD_S / fabs(v);
    }
    return fmax(machine->rate - slower, 0.0);
}

/* A held motion goes on ever more slowly: the set-points stay on the path that was checked. */
static void move(machine_t *machine)
{
    if (!machine_is_moving(machine)) return;
    if (machine->holding && machine->motion.kind != MOTION_STEP) machine->rate = brake(machine);
    machine->t += machine->rate * STAGE_PERIOD_S;
    const int over = machine->t >= machine->motion.duration - 0.5 * STAGE_PERIOD_S;
    motion_at(&machine->motion, over ? machine->motion.duration : machine->t, machine->set_points);
    if (over || !(machine->rate > 0.0)) {
        machine->motion.kind = MOTION_NONE;
        if (machine->phase == STARTING) enter(machine, RUNNING);
        machine->since = 0u; /* it settles from here on */
    }
}

static void start(machine_t *machine)
{
    double home[SET_POINTS_SIZE] = {0.0};
    for (int i = 0; i < N_SET_POINTS; i++) home[i] = LIMITS[i].home;
    machine->motion = motion_move(machine->set_points, home);
    machine->motion.kind = N_SET_POINTS ? MOTION_MOVE : MOTION_NONE;
    machine->t = 0.0;
    machine->rate = 1.0;
    machine->holding = 0;
    machine->latch_cause = 0u;
    machine->enabled = 1;
    enter(machine, N_SET_POINTS ? STARTING : RUNNING);
}

static void call(machine_t *machine, double missed)
{
    double before[N_OUTPUTS];
    memcpy(before, machine->outputs, sizeof before);
    machine->faults = stage_step(&machine->stage, machine->sensors, machine->set_points, missed, machine->outputs);
    if ((machine->faults & LATCHED) != 0u && machine->phase != LATCHED_PHASE) {
        machine->reason = "the controller latched";
        machine->latch_cause = machine->faults;
        enter(machine, LATCHED_PHASE);
    }
    /* The outputs of a latched step move in its calls alone, so it is called until they stand still. */
    machine->still = (memcmp(before, machine->outputs, sizeof before) == 0) ? machine->still + 1u : 0u;
    const uint64_t still = (machine->still < machine->since) ? machine->still : machine->since;
    if (machine->phase == LATCHED_PHASE && still >= SAMPLES(STILL_S) && may_disable(machine)) enter(machine, DISABLED);
}

int machine_make_safe(machine_t *machine)
{
    return stage_safe_step(&machine->stage, machine->outputs);
}

/* Put the step and the set-points to where the machine rests. */
static void reset(machine_t *machine)
{
    stage_pose(machine->sensors, machine->set_points);
    stage_init(&machine->stage, machine->sensors, machine->set_points);
    (void)machine_make_safe(machine);
}

void machine_sample(machine_t *machine, const double sensors[], double missed)
{
    rest_look(&machine->rest, sensors);
    memcpy(machine->sensors, sensors, sizeof machine->sensors);
    machine->since += 1u;
    if (machine->phase == WAITING && machine->rest.good > 0u) {
        machine->enabled = !(STAGE_SAFE_IS_OFF || STAGE_RESTS_OFF);
        reset(machine);
        if (machine->prompt) start(machine);
        else if (machine->rest.good >= SAMPLES(GOOD_S) && machine->rest.quiet >= SAMPLES(REST_S)) {
            machine->enabled = 1;
            enter(machine, ENABLING);
        }
    } else if (machine->phase == ENABLING && machine->rest.good == 0u) {
        stop(machine, "a sensor failed before the start", 1);
    } else if (machine->phase == ENABLING && machine->since >= SAMPLES(ENABLE_S)) {
        reset(machine);
        start(machine);
    } else {
        move(machine);
    }
    switch (machine->phase) {
    case BRAKING:
        call(machine, missed);
        if (machine->phase == BRAKING && !machine_is_moving(machine) && machine->since >= SAMPLES(SETTLE_S)) {
            enter(machine, STOPPING);
        }
        break;
    case STARTING: case RUNNING: case LATCHED_PHASE: call(machine, missed); break;
    case STOPPING:
        if (machine_make_safe(machine) && may_disable(machine)) enter(machine, DISABLED);
        break;
    case WAITING: case ENABLING: case DISABLED: default: break;
    }
}
