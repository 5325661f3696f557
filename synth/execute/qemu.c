/* Run a step on QEMU's MPS2 boards (AN386: Cortex-M4F, AN500: Cortex-M7), fed through semihosting files.
 *
 *   request   uint32_t steps, uint32_t from_init, state, then an input for every step
 *   response  for every step an output and uint32_t faults; then the state, uint32_t FPSCR
 *
 * contract.h defines STATE, INPUT, OUTPUT, INIT and STEP. Words are little-endian, structs as the compiler lays them out.
 */
#include <stdint.h>

#include "contract.h"

enum { OPEN = 1, CLOSE = 2, WRITE = 5, READ = 6, EXIT = 24 };
enum { READ_BINARY = 1, WRITE_BINARY = 5 };
enum { FINISHED = 0x20026, FAILED = 0x20024 };

extern uint32_t synth_stack_top[], synth_data[], synth_data_end[], synth_data_stored[], synth_bss[], synth_bss_end[];
void synth_reset(void);

static int32_t host_call(int32_t operation, const void *argument) {
    register int32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void leave(uintptr_t reason) {
    for (;;) host_call(EXIT, (const void *)reason);
}

static uint32_t open_file(const char *name, uint32_t length, uint32_t mode) {
    const uintptr_t block[3] = {(uintptr_t)name, mode, length};
    const int32_t handle = host_call(OPEN, block);
    if (handle == -1) leave(FAILED);
    return (uint32_t)handle;
}

/* A file that ends early or takes no more ends the run with a failure. */
static void transfer(int32_t operation, uint32_t file, const volatile void *bytes, uint32_t size) {
    const uintptr_t block[3] = {file, (uintptr_t)bytes, size};
    if (host_call(operation, block) != 0) leave(FAILED);
}

static void run(void) {
    static STATE state;
    static INPUT in;
    static OUTPUT out;
    uint32_t head[2], fpscr;
    const uint32_t request = open_file("request", 7u, READ_BINARY);
    const uint32_t response = open_file("response", 8u, WRITE_BINARY);
    transfer(READ, request, head, sizeof head);
    transfer(READ, request, &state, sizeof state);
    if (head[1] != 0u) INIT(&state);
    for (uint32_t k = 0u; k < head[0]; k++) {
        transfer(READ, request, &in, sizeof in);
        const uint32_t faults = STEP(&state, &in, &out);
        transfer(WRITE, response, &out, sizeof out);
        transfer(WRITE, response, &faults, sizeof faults);
    }
    __asm__ volatile("vmrs %0, fpscr" : "=r"(fpscr));
    transfer(WRITE, response, &state, sizeof state);
    transfer(WRITE, response, &fpscr, sizeof fpscr);
    host_call(CLOSE, &response);
}

static void fault(void) { leave(FAILED); }

void synth_reset(void) {
    volatile uint32_t *const coprocessors = (volatile uint32_t *)0xE000ED88u;
    const volatile uint32_t *stored = synth_data_stored;
    for (volatile uint32_t *word = synth_data; word < synth_data_end; word++) *word = *stored++;
    for (volatile uint32_t *word = synth_bss; word < synth_bss_end; word++) *word = 0u;
    *coprocessors |= 0xFu << 20; /* the FPU */
    __asm__ volatile("dsb\n\tisb" ::: "memory");
    run();
    leave(FINISHED);
}

typedef void (*vector_t)(void);
__attribute__((section(".vectors"), used)) static const vector_t vectors[16] = {
    (vector_t)(uintptr_t)synth_stack_top, synth_reset, fault, fault, fault, fault, fault};
