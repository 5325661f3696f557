/* channels.toml: which channel of the hardware is which signal, and how its raw values become units.
 *
 *     sensor:    value = sign scale raw + offset; outside low .. high of the raw range the sensor is bad (NaN)
 *     actuator:  raw = sign (value - offset) / scale, limited to low .. high of the raw range
 */
#ifndef CHANNELS_H
#define CHANNELS_H

#include "io.h"
#include "stage.h"

typedef struct {
    int channel;
    double scale, offset, sign, low, high; /* units per raw, units, +-1, raw, raw */
    double rollover;                       /* raw: a counter starts again after so many; 0 for none */
    int line;                              /* of its section in the file */
    unsigned given;                        /* a bit for each key in it */
} channel_t;

typedef struct {
    char device[128];
    channel_t sensors[N_SENSORS], outputs[N_OUTPUTS], enable; /* enable.channel -1: none */
    double last[N_SENSORS], turns[N_SENSORS];                 /* of counters */
} channels_t;

/* Read the file. Return 0, or -1 after a message with its line. */
int channels_read(const char *path, channels_t *channels);

double channels_value(channels_t *channels, int sensor, double raw);
double channels_raw(const channel_t *channel, double value);

/* What the user writes, in io_user.c: raw values by channel, in the order of the signals. 0, or -1 for a failure. */
int user_open(const channels_t *channels);
int user_read(const channels_t *channels, double raw[]);
int user_write(const channels_t *channels, const double raw[], int enabled);
void user_close(void);

#endif
