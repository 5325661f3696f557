/* A board without hardware: the loop samples, then stops, and its watchdog moves the outputs; then a late sample. */
#include <stdio.h>

#include "loop.h"

static loop_t loop;
static uint32_t time_us;
static double last;
static int writes;

void io_read(board_input_t *in)
{
    in->z = -4e-4f;
    in->x = 1e-5f * (float)(loop.samples % 3u);
    in->z_ref = 3e-4f;
}

void io_write(const board_output_t *out)
{
    last = (double)out->i1;
    writes++;
}

uint32_t now(void)
{
    return time_us;
}

int main(void)
{
    loop_init(&loop);
    const int before = loop_watch(&loop);
    for (int k = 0; k < 100; k++) {
        time_us += (k == 50) ? 4u * 500u : 500u;
        (void)loop_sample(&loop);
        if (k % LOOP_WATCH_PERIODS == 0 && loop_watch(&loop)) return 1;
    }
    printf("%d %u %.9g\n", before, (unsigned)loop.missed, last);
    (void)loop_watch(&loop);
    for (int k = 0; k < 8; k++) printf("%d %.9g\n", loop_watch(&loop), last);
    writes = 0;
    (void)loop_sample(&loop);
    printf("%d %s\n", writes, loop_fault_text(31u));
    return 0;
}
