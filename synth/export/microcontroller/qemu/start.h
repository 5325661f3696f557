/* QEMU's MPS2 boards: start-up, two UARTs, the end of a run. */
#ifndef START_H
#define START_H

#include <stdint.h>

enum { TEXT = 0, BINARY = 1 }; /* UARTs */

extern volatile uint32_t ticks; /* of SysTick */

int main(void);
void tick(void); /* the interrupt of SysTick, which main defines */
void start_ticks(uint32_t period_ns);
void put(int uart, const void *bytes, uint32_t size);
void print(const char *text);
void print_number(const char *before, uint32_t value, uint32_t base);
int receive(int uart); /* a byte, -1 for none */

/* Run the self-test and print what it found; leave with status 1 where it fails. */
void require_selftest(void);

#endif
