/* Shared memory: another program on this machine gives the sensors and takes the outputs.
 *
 * The file holds 8-byte words in the order of the machine: MAGIC, N_SENSORS, N_OUTPUTS, enabled, samples, then the
 * sensors and the outputs as doubles. `samples` counts the writes of the loop. */
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "io.h"
#include "stage.h"

#define MAGIC 0x53544147u
enum { HEADER = 5, WORDS = HEADER + N_SENSORS + N_OUTPUTS };

static uint64_t *words;

static void store(int i, uint64_t value)
{
    __atomic_store_n(&words[i], value, __ATOMIC_RELEASE);
}

static int open_shm(const io_options_t *options)
{
    const uint64_t header[3] = {MAGIC, N_SENSORS, N_OUTPUTS};
    const char *const path = options->memory ? options->memory : "";
    const int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    void *memory = MAP_FAILED;
    if (file >= 0 && ftruncate(file, WORDS * 8) == 0) {
        memory = mmap(NULL, WORDS * 8, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    }
    if (memory == MAP_FAILED) {
        (void)fprintf(stderr, "shared memory: '%s': %s: give a file with --memory, as in /dev/shm\n", path,
            strerror(errno));
        return -1;
    }
    (void)close(file);
    words = memory;
    if (words[0] != 0u && memcmp(words, header, sizeof header) != 0) {
        (void)fprintf(stderr, "shared memory: '%s' is of another stage: remove it, or give another file\n", path);
        return -1;
    }
    memcpy(words, header, sizeof header);
    return 0;
}

static int read_shm(double sensors[])
{
    for (int i = 0; i < N_SENSORS; i++) {
        const uint64_t bits = __atomic_load_n(&words[HEADER + i], __ATOMIC_ACQUIRE);
        memcpy(&sensors[i], &bits, sizeof bits);
    }
    return 0;
}

static int write_shm(const double outputs[], int enabled)
{
    for (int i = 0; i < N_OUTPUTS; i++) {
        uint64_t bits;
        memcpy(&bits, &outputs[i], sizeof bits);
        store(HEADER + N_SENSORS + i, bits);
    }
    store(3, (uint64_t)enabled);
    store(4, words[4] + 1u);
    return 0;
}

static void close_shm(void)
{
    (void)munmap(words, WORDS * 8);
}

const io_t IO_SHM = {"shm", open_shm, read_shm, write_shm, close_shm};
