/* The loop of a stage: in each period give the outputs that are due, read the sensors, and call the emitted step. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "options.h"
#include "realtime.h"
#include "recorder.h"
#include "replay.h"
#include "server.h"
#include "watchdog.h"

enum { QUEUE = STAGE_DELAY > 0 ? STAGE_DELAY : 1 };

static volatile sig_atomic_t stop_signal;
static exchange_t exchange = {.board = {.front = 1, .middle = 2}};
static motion_t motions[MOTIONS];

static void note_signal(int number)
{
    stop_signal = number;
}

/* What a full pipe or a held terminal does not take at once is lost: a log that nobody reads stops no thread. It is
 * opened again, as the flag of the inherited one belongs to the shell, too; a socket cannot be. */
static void unblock_log(void)
{
    struct stat log;
    if (fstat(STDERR_FILENO, &log) != 0 || S_ISREG(log.st_mode)) return;
    const int file = open("/proc/self/fd/2", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0 && !S_ISCHR(log.st_mode)) {
        (void)fcntl(STDERR_FILENO, F_SETFL, fcntl(STDERR_FILENO, F_GETFL) | O_NONBLOCK);
    } else if (file >= 0) {
        (void)dup2(file, STDERR_FILENO);
        (void)close(file);
    }
}

/* One instance in this folder drives the machine. Return 0, or -1 after a message. */
static int lock(const char *folder)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/" STAGE_NAME ".lock", folder);
    const int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return 0; /* until the last process ends */
    if (file >= 0 && errno == EWOULDBLOCK) {
        (void)fprintf(stderr, "%s: another instance drives the machine: stop it first\n", path);
    } else perror(path);
    return -1;
}

/* Check the motions of the command line, each from the end of the one before it. */
static int plan(const options_t *options)
{
    double from[SET_POINTS_SIZE] = {0.0};
    for (int i = 0; i < N_SET_POINTS; i++) from[i] = LIMITS[i].home;
    for (int k = 0; k < options->motion_count; k++) {
        char text[512], message[256], *words[64], *rest = text;
        int count = 0;
        const size_t length = (size_t)snprintf(text, sizeof text, "%s", options->motions[k]);
        for (char *word; count < 64 && (word = strtok_r(rest, " ", &rest)) != NULL;) words[count++] = word;
        if (length >= sizeof text || count == 64) {
            (void)fprintf(stderr, "--motion '%.40s...' is longer than %zu bytes or 63 words: give a shorter one\n",
                text, sizeof text - 1u);
            return -1;
        }
        if (motion_parse(words, count, from, &motions[k], message, sizeof message) != 0) {
            (void)fprintf(stderr, "--motion '%s': %s\n", options->motions[k], message);
            return -1;
        }
        motion_at(&motions[k], motions[k].duration, from);
    }
    return 0;
}

/* What ends the process once the outputs are safe; NULL for nothing. */
static const char *end_reason(const options_t *options, uint64_t time)
{
    if (stop_signal) return "the process was asked to end";
    if (recorder_error()) return "the recording could not be written";
    return (options->seconds > 0.0 && (double)time * STAGE_PERIOD_S >= options->seconds) ? "the run is over" : NULL;
}

/* What makes the outputs safe and leaves the process to its clients; NULL for nothing. */
static const char *stop_reason(const options_t *options, uint64_t missed, int write_failed, int read_failed)
{
    if (write_failed) return "the hardware could not be written: the outputs may be NOT SAFE: cut the power";
    if (read_failed) return "the hardware could not be read or written";
    if (options->late != LATE_SAFE || (double)missed < options->late_limit) return NULL;
    return "too many periods were missed in a row";
}

static void note_phase(const machine_t *m, phase_t *noted)
{
    const int64_t place = ring_place(&exchange.event_ring, EVENTS);
    if (m->phase != *noted && place >= 0) {
        exchange.events[place] = (event_t){m->phase, m->reason};
        ring_publish(&exchange.event_ring);
    }
    *noted = m->phase;
}

/* Obey one command of a client. */
static void obey(machine_t *m)
{
    const int64_t place = ring_next(&exchange.command_ring, COMMANDS);
    if (place < 0) return;
    machine_command(m, &exchange.commands[place]);
    ring_release(&exchange.command_ring);
    m->commands += 1u;
}

static void publish(const machine_t *m, uint64_t calls, const lateness_t *late)
{
    status_t *const s = board_back(&exchange.board);
    *s = (status_t){.phase = m->phase, .reason = m->reason, .faults = m->faults, .latch_cause = m->latch_cause,
        .drive_faults = m->stage.drive_faults, .moving = machine_is_moving(m), .may_start = machine_may_start(m),
        .calls = calls, .commands = m->commands, .late = *late};
    memcpy(s->sensors, m->sensors, sizeof s->sensors);
    memcpy(s->set_points, m->set_points, sizeof s->set_points);
    memcpy(s->outputs, m->outputs, sizeof s->outputs);
    board_publish(&exchange.board);
}

static void record(const machine_t *m, double t, uint64_t missed, int wait)
{
    record_t r = {.t = t, .missed = (double)missed, .faults = m->faults, .phase = (uint32_t)m->phase};
    memcpy(r.sensors, m->sensors, sizeof r.sensors);
    memcpy(r.set_points, m->set_points, sizeof r.set_points);
    memcpy(r.outputs, m->outputs, sizeof r.outputs);
    recorder_push(&r, wait);
}

static void report(const machine_t *m, uint64_t calls, const lateness_t *late, int unsafe)
{
    char faults[1024];
    if (unsafe) (void)fprintf(stderr, "%s: the last outputs could not be written: the outputs are NOT SAFE: cut the "
        "power\n", STAGE_NAME);
    if (recorder_error()) (void)fprintf(stderr, "%s: the recording could not be written: %s: its end is lost\n",
        STAGE_NAME, strerror(recorder_error()));
    fault_text(m->latch_cause, faults, sizeof faults);
    if (m->enabled && !unsafe) (void)fprintf(stderr, "%s: the amplifiers stay on, with the safe output\n", STAGE_NAME);
    (void)fprintf(stderr, "%s: %llu samples, %llu periods missed, %llu records dropped; ended %s: %s; latched by: %s\n",
        STAGE_NAME, (unsigned long long)calls, (unsigned long long)late->missed, (unsigned long long)recorder_dropped(),
        PHASES[m->phase], m->reason ? m->reason : "-", faults);
    for (int i = 0; i < BINS; i++) {
        if (late->bins[i]) (void)fprintf(stderr, "  late by %s %.0f us: %llu\n", i < BINS - 1 ? "up to" : "more than",
            ldexp(1.0, i < BINS - 1 ? i : i - 1), (unsigned long long)late->bins[i]);
    }
}

/* Run until the machine is disabled and the process is to end. Return the exit status: 1 after a latch. */
static int run(const options_t *options, shared_t *shared)
{
    static double queue[QUEUE][N_OUTPUTS];
    static int enabled[QUEUE];
    machine_t *const m = &shared->machine;
    lateness_t late = {0};
    double sensors[N_SENSORS];
    int64_t next = realtime_now() + STAGE_PERIOD_NS;
    int next_motion = 0, done = 0, failed = 0;
    uint64_t sample = 0u, time = 0u;
    phase_t noted = WAITING;
    for (; !done; sample++, time++) {
        const uint64_t missed = options->live ? realtime_wait(&next, &late) : 0u;
        const int slot = (int)(sample % QUEUE);
        time += missed;
        if (STAGE_DELAY > 0 && sample >= QUEUE) failed |= options->io->write(queue[slot], enabled[slot]) != 0;
        const int read_failed = options->io->read(sensors) != 0;
        for (int i = 0; i < N_SENSORS && read_failed; i++) sensors[i] = NAN;
        obey(m);
        if (next_motion < options->motion_count && m->phase == RUNNING && !machine_is_moving(m)) {
            machine_command(m, &(command_t){.order = COMMAND_MOTION, .motion = motions[next_motion++]});
        }
        if (options->late == LATE_HOLD && missed) machine_command(m, &(command_t){.order = COMMAND_HOLD});
        const char *const end = end_reason(options, time);
        const char *const reason = end ? end : stop_reason(options, missed, failed, read_failed);
        if (reason) machine_command(m, &(command_t){COMMAND_STOP, .reason = reason, .at_once = failed || read_failed});
        note_phase(m, &noted);
        machine_sample(m, sensors, (double)missed);
        note_phase(m, &noted);
        memcpy(queue[slot], m->outputs, sizeof queue[slot]);
        enabled[slot] = m->enabled;
        if (STAGE_DELAY == 0) failed |= options->io->write(queue[slot], enabled[slot]) != 0;
        (void)__atomic_add_fetch(&shared->beat, 1u, __ATOMIC_RELEASE);
        record(m, (double)time * STAGE_PERIOD_S, missed, !options->live);
        publish(m, sample + 1u, &late);
        done = (end && machine_may_end(m)) || (!options->live && (double)(sample + 1u) >= options->lockstep);
    }
    if (!options->live) m->enabled = 0; /* it ends anywhere */
    const int unsafe = options->io->write(m->outputs, m->enabled) != 0;
    __atomic_store_n(&shared->beat, 0u, __ATOMIC_RELEASE); /* the watchdog waits */
    if (options->live) server_finish();
    recorder_finish();
    options->io->close();
    report(m, sample, &late, unsafe);
    return (m->latch_cause || failed || unsafe || recorder_error()) ? 1 : 0;
}

/* The process of the loop. */
static int loop(const options_t *options, shared_t *shared, const char *socket_path)
{
    watchdog_signals(note_signal);
    (void)signal(SIGXFSZ, SIG_IGN); /* a file at its limit is a failed write */
    for (int i = 0; i < N_SET_POINTS; i++) {
        if (LIMITS[i].measured) continue;
        (void)fprintf(stderr, "%s: no sensor shows the pose before the start: it is taken for %g %s\n",
            SET_POINTS[i].name, LIMITS[i].home, SET_POINTS[i].unit);
    }
    if (recorder_start() != 0) return 2;
    if (options->live && server_start(socket_path, &exchange) != 0) return 2;
    if (options->record) {
        const int error = recorder_open(options->record);
        if (error) {
            (void)fprintf(stderr, "--record %s: %s: give a new file in a folder that is there\n", options->record,
                strerror(error));
            return 2;
        }
    }
    if (options->live) realtime_become((int)options->cpu); /* this thread alone */
    return run(options, shared);
}

int main(int count, char *words[])
{
    options_t options;
    char socket_path[4096];
    if (options_read(count, words, &options) != 0) return 2;
    if (options.replay) return replay(options.replay);
    (void)signal(SIGPIPE, SIG_IGN); /* a log whose reader is gone ends nobody */
    if (options.live) unblock_log();
    if (plan(&options) != 0 || lock(options.run) != 0) return 2;
    (void)snprintf(socket_path, sizeof socket_path, "%s/" STAGE_NAME ".sock", options.run);
    shared_t *const shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    options.back_end.settle = options.live;
    if (shared == MAP_FAILED || options.io->open(&options.back_end) != 0) return 2;
    machine_init(&shared->machine, !options.live);
    if (!options.live) return loop(&options, shared, socket_path);
    const pid_t watchdog = getpid(), child = fork();
    if (child < 0) perror("fork");
    if (child != 0) return child < 0 ? 2 : watchdog_run(shared, options.io, child, 1e-3 * options.stall_ms);
    (void)prctl(PR_SET_PDEATHSIG, SIGTERM); /* a loop without a watchdog stops, too */
    return getppid() == watchdog ? loop(&options, shared, socket_path) : 2;
}
