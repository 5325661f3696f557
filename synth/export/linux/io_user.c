/* Your own input and output: fill in these four functions. This file is yours: it is never written again.
 *
 * Raw values are those of your hardware, such as volts or counts; channels.toml says how they become units. `write` is
 * called before `read` in each sample, from the loop and, when the loop dies, from the watchdog: never wait in it, and
 * open what both need in `user_open`, before they part. */
#include <stdio.h>

#include "channels.h"

int user_open(const channels_t *channels)
{
    (void)channels;
    (void)fprintf(stderr, "io_user.c: no hardware is connected yet: fill in its four functions, and build again\n");
    return -1;
}

int user_read(const channels_t *channels, double raw[])
{
    (void)channels; /* channels->sensors[i].channel is the channel of SENSORS[i] */
    for (int i = 0; i < N_SENSORS; i++) raw[i] = 0.0;
    return 0;
}

int user_write(const channels_t *channels, const double raw[], int enabled)
{
    (void)channels; /* channels->outputs[i].channel is the channel of OUTPUTS[i] */
    (void)raw;
    (void)enabled; /* 0: switch the amplifiers off */
    return 0;
}

void user_close(void)
{
}
