#include "watchdog.h"

#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>

#include "realtime.h"

#define LONGEST_S 10.0 /* until the outputs are safe */

static volatile sig_atomic_t loop_process;

static void forward(int number)
{
    (void)kill((pid_t)loop_process, number);
}

static void pause_ns(long ns)
{
    const struct timespec pause = {.tv_nsec = ns};
    (void)nanosleep(&pause, NULL);
}

void watchdog_signals(void (*handler)(int))
{
    const int orders[] = {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGTSTP};
    const struct sigaction action = {.sa_handler = handler};
    for (size_t i = 0; i < sizeof orders / sizeof orders[0]; i++) (void)sigaction(orders[i], &action, NULL);
    (void)signal(SIGTTIN, SIG_IGN);
    (void)signal(SIGTTOU, SIG_IGN);
}

/* 1 once the outputs are safe. */
static int make_safe(machine_t *machine, const io_t *io)
{
    int there = !machine->enabled, written = 1;
    for (double t = 0.0; t < LONGEST_S && !there; t += STAGE_PERIOD_S) {
        there = machine_make_safe(machine);
        written = io->write(machine->outputs, 1) == 0;
        pause_ns(STAGE_PERIOD_NS);
    }
    /* Off where that is safe; else the hardware holds the safe output. */
    if (STAGE_SAFE_IS_OFF || !machine->enabled) written &= io->write(machine->outputs, 0) == 0;
    return there && written;
}

int watchdog_run(shared_t *shared, const io_t *io, pid_t loop, double stall_s)
{
    const struct sched_param above = {.sched_priority = REALTIME_PRIORITY + 1};
    char why[128];
    uint64_t last = 0u;
    int64_t since = realtime_now();
    int status;
    loop_process = (sig_atomic_t)loop;
    (void)sched_setscheduler(0, SCHED_FIFO, &above); /* where it is refused, so it is to the loop, which says so */
    (void)mlockall(MCL_CURRENT | MCL_FUTURE);
    watchdog_signals(forward);
    for (;;) {
        const uint64_t beat = __atomic_load_n(&shared->beat, __ATOMIC_ACQUIRE);
        if (waitpid(loop, &status, WNOHANG) == loop) {
            const int exited = WIFEXITED(status), number = exited ? WEXITSTATUS(status) : WTERMSIG(status);
            if (exited && __atomic_load_n(&shared->beat, __ATOMIC_ACQUIRE) == 0u) return number;
            (void)snprintf(why, sizeof why, exited ? "the loop left its run with exit status %d%s" :
                "the loop died of signal %d (%s)", number, exited ? "" : strsignal(number));
            break;
        }
        if (beat != last || beat == 0u) since = realtime_now();
        last = beat;
        if ((double)(realtime_now() - since) > stall_s * 1e9) {
            (void)snprintf(why, sizeof why, "the loop has stood still for %.0f ms and is killed", stall_s * 1e3);
            /* Before the first safe output: a loop that goes on would overwrite it. */
            (void)kill(loop, SIGKILL);
            (void)waitpid(loop, &status, 0);
            break;
        }
        pause_ns(1000000L);
    }
    const int safe = make_safe(&shared->machine, io);
    /* Not earlier: a log that nobody reads may block. */
    (void)fprintf(stderr, "watchdog: %s\nwatchdog: the outputs are %s\n", why, safe ? "safe" : "NOT SAFE: cut the power");
    io->close();
    return 3;
}
