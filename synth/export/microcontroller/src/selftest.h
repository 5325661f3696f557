#ifndef SELFTEST_H
#define SELFTEST_H

#include <stdint.h>

typedef struct {
    uint32_t flash_found, flash_needed;   /* CRC-32 of code and constants; needed: as it was linked */
    const char *step;                     /* the first step that differs from its vectors, "" where none does */
    uint32_t samples, differing, first;   /* vectors that ran, those that differ, and the first one that does */
} selftest_t;

/* Compare the flash with its checksum, and every step with its vectors: fault word and all outputs, bit for bit.
 *
 * Return 0 where all are equal. The linker script defines flash_begin and flash_end, and places the section
 * .flash_checksum outside of them. */
int selftest(selftest_t *found);

#endif
