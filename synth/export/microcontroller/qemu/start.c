#include "start.h"

#include "cycles.h"
#include "selftest.h"

#define SYSTICK ((volatile uint32_t *)0xE000E010u) /* control, reload, value */
#define CORE_HZ 25000000u

typedef struct {
    volatile uint32_t data, state, control, interrupt, divider;
} uart_t;

static uart_t *const UARTS[] = {(uart_t *)0x40004000u, (uart_t *)0x40005000u};

volatile uint32_t ticks;
extern uint32_t stack_top[], data_begin[], data_end[], data_stored[], bss_begin[], bss_end[];
void reset(void);

static void leave(int status)
{
    register int32_t r0 __asm__("r0") = 0x18; /* semihosting: exit */
    register uint32_t r1 __asm__("r1") = status ? 0x20024u : 0x20026u;
    for (;;) __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void put(int uart, const void *bytes, uint32_t size)
{
    const uint8_t *const byte = bytes;
    for (uint32_t i = 0u; i < size; i++) {
        while ((UARTS[uart]->state & 1u) != 0u) continue;
        UARTS[uart]->data = byte[i];
    }
}

int receive(int uart)
{
    return ((UARTS[uart]->state & 2u) != 0u) ? (int)(UARTS[uart]->data & 0xFFu) : -1;
}

void print(const char *text)
{
    for (; *text != '\0'; text++) put(TEXT, text, 1u);
}

void print_number(const char *before, uint32_t value, uint32_t base)
{
    char digits[11], *at = digits + 10;
    print(before);
    *at = '\0';
    do {
        *--at = "0123456789abcdef"[value % base];
        value /= base;
    } while (value != 0u);
    print(at);
}

void require_selftest(void)
{
    selftest_t found;
    const int failed = selftest(&found);
    print_number("flash: found 0x", found.flash_found, 16u);
    print_number(", needs 0x", found.flash_needed, 16u);
    print_number("\nself-test: ", found.differing, 10u);
    print_number(" of ", found.samples, 10u);
    print(" samples differ from the vectors\n");
    if (!failed) return;
    if (found.differing != 0u) {
        print_number("self-test: the first is sample ", found.first, 10u);
        print(" of ");
        print(found.step);
        print("\n");
    }
    print("self-test: failed, the loop does not start\n");
    leave(1);
}

void start_ticks(uint32_t period_ns)
{
    SYSTICK[1] = (uint32_t)((uint64_t)CORE_HZ * period_ns / 1000000000u) - 1u;
    SYSTICK[2] = 0u;
    SYSTICK[0] = 7u;
}

static void on_tick(void)
{
    ticks += 1u;
    tick();
}

static void on_fault(void)
{
    print("a fault of the core\n");
    leave(1);
}

void reset(void)
{
    const volatile uint32_t *stored = data_stored;
    for (volatile uint32_t *word = data_begin; word < data_end; word++) *word = *stored++;
    for (volatile uint32_t *word = bss_begin; word < bss_end; word++) *word = 0u;
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* the FPU */
    __asm__ volatile("dsb\n\tisb" ::: "memory");
    for (int i = 0; i < 2; i++) {
        UARTS[i]->divider = 16u;
        UARTS[i]->control = 3u;
    }
    cycles_start();
    leave(main());
}

typedef void (*vector_t)(void);
__attribute__((section(".vectors"), used)) static const vector_t VECTORS[16] = {
    (vector_t)(uintptr_t)stack_top, reset, on_fault, on_fault, on_fault, on_fault, on_fault, [15] = on_tick,
};
