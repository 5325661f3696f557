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

enum { CLOSE_MS = 500, FINISH_MS = 2000, SIZE = 4096, TEXT = 1 << 16 };
enum { LINE = 64 + 32 * (N_SENSORS + SET_POINTS_SIZE + N_OUTPUTS + 4) };

static struct {
    record_t records[SIZE];
    ring_t ring;
    uint64_t dropped, settled; /* rows: in no file; and those that the thread took, which are written or dropped */
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

/* Return how many lines get lost: of a failed write, and of one without a file. */
static uint64_t write_text(const char *text, size_t size)
{
    const int file = __atomic_load_n(&recorder.file, __ATOMIC_ACQUIRE);
    uint64_t lost = 0u;
    while (size > 0u && file >= 0 && !recorder_error()) {
        const ssize_t n = write(file, text, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) __atomic_store_n(&recorder.error, n < 0 ? errno : ENOSPC, __ATOMIC_RELEASE);
        else {
            text += n;
            size -= (size_t)n;
        }
    }
    for (; size > 0u; size--) lost += *text++ == '\n';
    return lost;
}

static void write_rows(size_t size, uint64_t rows)
{
    (void)__atomic_add_fetch(&recorder.dropped, write_text(recorder.text, size), __ATOMIC_RELAXED);
    (void)__atomic_add_fetch(&recorder.settled, rows, __ATOMIC_RELEASE);
}

/* Write what is in the ring; after a failed write, discard it. */
static void drain(void)
{
    size_t n = 0;
    uint64_t rows = 0u;
    for (int64_t place; (place = ring_next(&recorder.ring, SIZE)) >= 0; ring_release(&recorder.ring)) {
        n += print_record(recorder.text + n, &recorder.records[place]);
        rows += 1u;
        if (n + LINE > TEXT) {
            write_rows(n, rows);
            n = 0;
            rows = 0u;
        }
    }
    write_rows(n, rows);
}

static void write_names(void)
{
    size_t n = (size_t)snprintf(recorder.text, TEXT, "t [s]");
    n += print_signals(recorder.text + n, SENSORS, N_SENSORS);
    n += print_signals(recorder.text + n, SET_POINTS, N_SET_POINTS);
    n += print_signals(recorder.text + n, OUTPUTS, N_OUTPUTS);
    n += (size_t)snprintf(recorder.text + n, TEXT - n, ",faults [1],phase [1],missed [1]\n");
    (void)write_text(recorder.text, n);
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
            (void)nanosleep(&pause, NULL); /* the loop may be putting a record down */
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
    int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file < 0 && errno == EEXIST) { /* a pipe or a device is opened, a file is not; a pipe needs a reader */
        file = open(path, O_WRONLY | O_NONBLOCK | O_CLOEXEC);
        if (file >= 0 && (fstat(file, &there) != 0 || S_ISREG(there.st_mode))) {
            (void)close(file);
            return EEXIST;
        }
    }
    if (file < 0 || fcntl(file, F_SETFL, 0) != 0) return errno;
    __atomic_store_n(&recorder.error, 0, __ATOMIC_RELEASE);
    __atomic_store_n(&recorder.file, file, __ATOMIC_RELEASE);
    __atomic_store_n(&recorder.open, 1, __ATOMIC_RELEASE);
    return 0;
}

int recorder_stop(void)
{
    const struct timespec pause = {.tv_nsec = 1000000};
    if (records()) __atomic_store_n(&recorder.ending, 1, __ATOMIC_RELEASE);
    for (int k = 0; k < CLOSE_MS && recorder_is_open(); k++) (void)nanosleep(&pause, NULL);
    return recorder_is_open() ? -1 : 0;
}

void recorder_finish(void)
{
    const struct timespec pause = {.tv_nsec = 1000000};
    int lives = 1;
    __atomic_store_n(&recorder.finish, 1, __ATOMIC_RELEASE);
    /* pthread_timedjoin_np would wait by the clock of the date, which jumps. */
    for (int k = 0; k < FINISH_MS && (lives = pthread_tryjoin_np(recorder.thread, NULL) != 0); k++) {
        (void)nanosleep(&pause, NULL);
    }
    if (!lives) return;
    const uint64_t settled = __atomic_load_n(&recorder.settled, __ATOMIC_ACQUIRE);
    (void)__atomic_add_fetch(&recorder.dropped, recorder.ring.head - settled, __ATOMIC_RELAXED);
    (void)fprintf(stderr, "recorder: the disk does not answer: the end of the record is lost\n");
}
