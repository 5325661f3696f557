/* The serial handler under noise: damaged, short and whole frames; every answer must be a frame. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crc.h"
#include "loop.h"
#include "serial.h"

const uint8_t flash_begin[1] = {0};
extern const uint8_t flash_end[1] __attribute__((alias("flash_begin"))); /* of no bytes */
static long answers, wrong;

void io_read(board_input_t *in)
{
    (void)in;
}

void io_write(const board_output_t *out)
{
    (void)out;
}

uint32_t now(void)
{
    return 0u;
}

static void take(const uint8_t *bytes, uint32_t size)
{
    uint32_t crc;
    memcpy(&crc, bytes + size - 4, 4);
    answers++;
    wrong += bytes[0] != 0x5A || bytes[1] != 0xC3 || size != 9u + bytes[3] + 256u * bytes[4];
    wrong += crc != crc32(0u, bytes + 2, bytes + size - 4) || size > SERIAL_CONTENT + 9u;
}

int main(void)
{
    static serial_t serial;
    serial_init(&serial, take);
    srand(1);
    for (long n = 0; n < 200000; n++) {
        uint8_t frame[SERIAL_CONTENT + 32];
        uint32_t size = (uint32_t)rand() % (SERIAL_CONTENT + 20u);
        for (uint32_t i = 0; i < size + 9u && i < sizeof frame; i++) frame[i] = (uint8_t)rand();
        const uint8_t head[5] = {0x5A, 0xC3, (uint8_t)"HIS?"[rand() % 4], (uint8_t)size, 0};
        if (rand() % 8) memcpy(frame, head, sizeof head);
        if (rand() % 2) frame[5] = 0;
        const uint32_t crc = crc32(0u, frame + 2, frame + 5 + size);
        if (rand() % 8) memcpy(frame + 5 + size, &crc, 4);
        if (rand() % 8 == 0) size /= 2u;
        for (uint32_t i = 0; i < size + 9u; i++) serial_receive(&serial, frame[i]);
    }
    printf("%ld wrong of %ld\n", wrong, answers);
    return wrong != 0 || answers < 100000;
}
