#ifndef CRC_H
#define CRC_H

#include <stdint.h>

/* Continue the CRC-32 of zlib and gzip from `crc`, 0 at the start, over the bytes from `begin` to before `end`. */
uint32_t crc32(uint32_t crc, const uint8_t *begin, const uint8_t *end);

#endif
