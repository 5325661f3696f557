#include "recorder.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "ring.h"

enum { SIZE = 4096, TEXT = 1 << 16, LINE = 64 + 32 * (N_SENSORS + SET_POINTS_SIZE + N_OUTPUTS + 4) };

static struct {
    record_t records[SIZE];
    ring_t ring;
    uint64_t dropped;
    int file, open, ending, error; /* file: -1 for none; open: the loop records; ending: the thread is to close it */
    char text[TEXT];
    pthread_t thread;
    int finish;
} recorder = {.file = -1};

static int records(void) { return __atomic_load_n(&recorder.open, __ATOMIC_ACQUIRE); }
int recorder_is_open(void) { return __atomic_load_n(&recorder.file, __ATOMIC_ACQUIRE) >= 0; }
int recorder_error(void) { return __atomic_load_n(&recorder.error, __ATOMIC_ACQUIRE); }
uint64_t recorder_dropped(void) { return __atomic_load_n(&recorder.dropped, __ATOMIC_RELAXED); }

void recorder_push(const record_t *record, int wait)
{
    if (!records()) return;
    int64_t place;
    while ((place = ring_place(&recorder.ring, SIZE)) < 0) {
        if (!wait || recorder_error()) {
            (void)__atomic_add_fetch(&recorder.dropped, 1u, __ATOMIC_RELAXED);
            return;
        }
        (void)sched_yield();
    }
    recorder.records[place] = *record;
    ring_publish(&recorder.ring);
}

static size_t print_signals(char *text, const signal_t signals[], int count)
{
    size_t n = 0;
    for (int i = 0; i < count; i++) {
        n += (size_t)snprintf(text + n, 256, ",%s [%s]", signals[i].name, signals[i].unit);
    }
    return n;
}

static size_t print_values(char *text, const double values[], int count)
{
    size_t n = 0;
    for (int i = 0; i < count; i++) {
        n += (size_t)snprintf(text + n, 32, ",%.*g", STAGE_DIGITS, (double)(stage_real_t)values[i]);
    }
    return n;
}

static size_t print_record(char *text, const record_t *r)
{
    size_t n = (size_t)snprintf(text, LINE, "%.9f", r->t);
    n += print_values(text + n, r->sensors, N_SENSORS);
    n += print_values(text + n, r->set_points, N_SET_POINTS);
    n += print_values(text + n, r->outputs, N_OUTPUTS);
    return n + (size_t)snprintf(text + n, 64, ",%u,%u,%.0f\n", (unsigned)r->faults, (unsigned)r->phase, r->missed);
}

static void write_text(const char *text, size_t size)
{
    const int file = __atomic_load_n(&recorder.file, __ATOMIC_ACQUIRE);
    while (size > 0u && file >= 0 && !recorder_error()) {
        const ssize_t n = write(file, text, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) __atomic_store_n(&recorder.error, n < 0 ? errno : ENOSPC, __ATOMIC_RELEASE);
        else {
            text += n;
            size -= (size_t)n;
        }
    }
}

/* Write what is in the ring; after a failed write, discard it. */
static void drain(void)
{
    size_t n = 0;
    for (int64_t place; (place = ring_next(&recorder.ring, SIZE)) >= 0; ring_release(&recorder.ring)) {
        n += print_record(recorder.text + n, &recorder.records[place]);
        if (n + LINE > TEXT) {
            write_text(recorder.text, n);
            n = 0;
        }
    }
    write_text(recorder.text, n);
}

static void write_names(void)
{
    size_t n = (size_t)snprintf(recorder.text, TEXT, "t [s]");
    n += print_signals(recorder.text + n, SENSORS, N_SENSORS);
    n += print_signals(recorder.text + n, SET_POINTS, N_SET_POINTS);
    n += print_signals(recorder.text + n, OUTPUTS, N_OUTPUTS);
    n += (size_t)snprintf(recorder.text + n, TEXT - n, ",faults [1],phase [1],missed [1]\n");
    write_text(recorder.text, n);
}

static void *run(void *ignored)
{
    int named = 0;
    const struct timespec pause = {.tv_nsec = 5000000};
    for (;;) {
        const int finish = __atomic_load_n(&recorder.finish, __ATOMIC_ACQUIRE);
        const int ending = finish || __atomic_load_n(&recorder.ending, __ATOMIC_ACQUIRE);
        const int file = __atomic_load_n(&recorder.file, __ATOMIC_ACQUIRE);
        if (file >= 0 && !named) write_names();
        named = file >= 0;
        drain();
        if ((ending || recorder_error()) && file >= 0) {
            __atomic_store_n(&recorder.open, 0, __ATOMIC_RELEASE);
            drain();
            (void)close(file);
            __atomic_store_n(&recorder.file, -1, __ATOMIC_RELEASE);
            __atomic_store_n(&recorder.ending, 0, __ATOMIC_RELEASE);
            named = 0;
        }
        if (finish) return ignored;
        (void)nanosleep(&pause, NULL);
    }
}

int recorder_start(void)
{
    if (pthread_create(&recorder.thread, NULL, run, NULL) == 0) return 0;
    (void)fprintf(stderr, "recorder: no thread could be started: allow this user more processes\n");
    return -1;
}

int recorder_open(const char *path)
{
    struct stat there;
    if (recorder_is_open()) return EBUSY;
    if (stat(path, &there) == 0 && S_ISREG(there.st_mode)) return EEXIST;
    /* A pipe without a reader is refused. */
    const int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0600);
    if (file < 0 || fcntl(file, F_SETFL, 0) != 0) return errno;
    __atomic_store_n(&recorder.error, 0, __ATOMIC_RELEASE);
    __atomic_store_n(&recorder.file, file, __ATOMIC_RELEASE);
    __atomic_store_n(&recorder.open, 1, __ATOMIC_RELEASE);
    return 0;
}

void recorder_stop(void)
{
    if (records()) __atomic_store_n(&recorder.ending, 1, __ATOMIC_RELEASE);
}

void recorder_finish(void)
{
    struct timespec end;
    (void)clock_gettime(CLOCK_REALTIME, &end);
    end.tv_sec += 2;
    __atomic_store_n(&recorder.finish, 1, __ATOMIC_RELEASE);
    if (pthread_timedjoin_np(recorder.thread, NULL, &end) != 0) {
        (void)fprintf(stderr, "recorder: the disk does not answer: the end of the record is lost\n");
    }
}
