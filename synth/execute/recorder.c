/* Record what an emulator executes: each instruction's address, and the lowest stack pointer. */
#include <stdint.h>

typedef struct {
    int64_t capacity, count;
    uint32_t *address;
    int (*read_register)(void *engine, int number, void *value);
    int32_t sp; /* the emulator's number of that register */
    uint32_t lowest_sp;
} recorder_t;

void synth_record(void *engine, uint64_t address, uint32_t size, void *user) {
    recorder_t *const r = user;
    uint64_t sp = 0;
    (void)size;
    r->read_register(engine, r->sp, &sp);
    if ((uint32_t)sp < r->lowest_sp) r->lowest_sp = (uint32_t)sp;
    if (r->count < r->capacity) r->address[r->count] = (uint32_t)address;
    r->count++;
}
