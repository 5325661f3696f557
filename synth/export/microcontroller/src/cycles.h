/* The cycle counter (DWT) of Armv7-M; elsewhere, and on QEMU, which does not model it, it reads 0. */
#ifndef CYCLES_H
#define CYCLES_H

#include <stdint.h>

#if defined(__ARM_ARCH_7EM__) || defined(__ARM_ARCH_7M__)
static inline void cycles_start(void)
{
    *(volatile uint32_t *)0xE000EDFCu |= 1u << 24; /* DEMCR: trace */
    *(volatile uint32_t *)0xE0001FB0u = 0xC5ACCE55u; /* the lock of the Cortex-M7 */
    *(volatile uint32_t *)0xE0001004u = 0u;
    *(volatile uint32_t *)0xE0001000u |= 1u;
}

static inline uint32_t cycles_now(void)
{
    return *(volatile uint32_t *)0xE0001004u;
}
#else
static inline void cycles_start(void)
{
}

static inline uint32_t cycles_now(void)
{
    return 0u;
}
#endif

#endif
