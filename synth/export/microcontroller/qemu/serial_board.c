/* A board that answers on its second UART. */
#include "serial.h"
#include "start.h"

static serial_t serial;

void tick(void)
{
}

static void send(const uint8_t *bytes, uint32_t size)
{
    put(BINARY, bytes, size);
}

int main(void)
{
    serial_init(&serial, send);
    for (;;) {
        const int byte = receive(BINARY);
        if (byte >= 0) serial_receive(&serial, (uint8_t)byte);
    }
}
