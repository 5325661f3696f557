/* Shared memory: another program on this machine, the partner, gives the sensors and takes the outputs.
 *
 * The file holds 8-byte words in the order of the machine: MAGIC, N_SENSORS, N_OUTPUTS, enabled, samples, heartbeat,
 * then the sensors and the outputs as doubles. `samples` counts the writes of the loop. The partner adds 1 to
 * `heartbeat` with each write of the sensors. While it stands still for 10 samples, and for SILENCE_S at least, all
 * sensors are NaN, which the step bridges, and then latches. A new file begins with sensors of NaN. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io.h"
#include "stage.h"

#ifndef SILENCE_S
#define SILENCE_S 0.005 /* of a partner that writes every millisecond or faster */
#endif
#define MAGIC 0x53544732u
#define SILENCE ((uint64_t)(SILENCE_S / STAGE_PERIOD_S)) /* samples */
enum { HEADER = 6, WORDS = HEADER + N_SENSORS + N_OUTPUTS, LEAST = 10 };

static uint64_t *words;
static uint64_t beat, silent; /* the last heartbeat, and the samples since it changed */

static uint64_t load(int i)
{
    return __atomic_load_n(&words[i], __ATOMIC_ACQUIRE);
}

static void store(int i, uint64_t value)
{
    __atomic_store_n(&words[i], value, __ATOMIC_RELEASE);
}

static void store_double(int i, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    store(i, bits);
}

/* Fill a new file: MAGIC comes last, for a partner that looks for it. */
static void begin(const uint64_t header[])
{
    for (int i = 0; i < N_SENSORS; i++) store_double(HEADER + i, NAN);
    for (int i = 2; i >= 0; i--) store(i, header[i]);
}

static int open_shm(const io_options_t *options)
{
    const uint64_t header[3] = {MAGIC, N_SENSORS, N_OUTPUTS};
    const char *const path = options->memory ? options->memory : "";
    const int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    uint64_t found[3] = {0u};
    struct stat there;
    void *memory = MAP_FAILED;
    if (file >= 0 && fstat(file, &there) == 0) {
        if (there.st_size != 0 && (there.st_size != WORDS * 8 || pread(file, found, sizeof found, 0) != sizeof found
            || memcmp(found, header, sizeof header) != 0)) {
            (void)fprintf(stderr, "shared memory: '%s' is of another stage or of another program, and is left as it "
                "is: remove it, or give another file\n", path);
            return -1;
        }
        if (there.st_size != 0 || ftruncate(file, WORDS * 8) == 0) {
            memory = mmap(NULL, WORDS * 8, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        }
    }
    if (memory == MAP_FAILED) {
        (void)fprintf(stderr, "shared memory: '%s': %s: give a file with --memory, as in /dev/shm\n", path,
            strerror(errno));
        return -1;
    }
    (void)close(file);
    words = memory;
    if (there.st_size == 0) begin(header);
    beat = load(5);
    silent = SILENCE + LEAST; /* whatever an old file holds, the partner must write first */
    return 0;
}

static int read_shm(double sensors[])
{
    const uint64_t now = load(5);
    silent = (now == beat) ? silent + 1u : 0u;
    beat = now;
    const int stale = silent >= SILENCE && silent >= LEAST;
    for (int i = 0; i < N_SENSORS; i++) {
        const uint64_t bits = load(HEADER + i);
        memcpy(&sensors[i], &bits, sizeof bits);
        if (stale) sensors[i] = NAN;
    }
    return 0;
}

static int write_shm(const double outputs[], int enabled)
{
    for (int i = 0; i < N_OUTPUTS; i++) store_double(HEADER + N_SENSORS + i, outputs[i]);
    store(3, (uint64_t)enabled);
    store(4, words[4] + 1u);
    return 0;
}

static void close_shm(void)
{
    (void)munmap(words, WORDS * 8);
}

const io_t IO_SHM = {"shm", open_shm, read_shm, write_shm, close_shm};
