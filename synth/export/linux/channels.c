#include "channels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "motion.h"

typedef struct {
    const char *path;
    int line;
} place_t;

static int refuse(place_t at, const char *what, const char *mend)
{
    (void)fprintf(stderr, "%s, line %d: %s: %s\n", at.path, at.line, what, mend);
    return -1;
}

static channel_t *section(channels_t *channels, const char *name)
{
    for (int i = 0; i < N_SENSORS; i++) {
        if (strncmp(name, "sensor.", 7) == 0 && strcmp(name + 7, SENSORS[i].name) == 0) return &channels->sensors[i];
    }
    for (int i = 0; i < N_OUTPUTS; i++) {
        if (strncmp(name, "actuator.", 9) == 0 && strcmp(name + 9, OUTPUTS[i].name) == 0) return &channels->outputs[i];
    }
    return strcmp(name, "enable") == 0 ? &channels->enable : NULL;
}

static int set(channel_t *c, const char *key, double value)
{
    double *const members[] = {&c->scale, &c->offset, &c->sign, &c->low, &c->high, &c->rollover};
    static const char *const keys[] = {"scale", "offset", "sign", "low", "high", "rollover"};
    for (int i = 0; i < 6; i++) {
        if (strcmp(key, keys[i]) == 0) {
            *members[i] = value;
            return 0;
        }
    }
    if (strcmp(key, "channel") != 0 || value < -1.0 || value > 1e6) return -1;
    c->channel = (int)lround(value);
    return 0;
}

/* One line: empty, [section], device = "..." or key = number, each with a comment or without. */
static int read_line(char *text, place_t at, channels_t *channels, channel_t **here)
{
    char name[128], key[32], number[64], more;
    double value;
    text[strcspn(text, "#\r\n")] = '\0';
    if (text[strspn(text, " \t")] == '\0') return 0;
    if (sscanf(text, " [%127[^]]] %c", name, &more) == 1) {
        *here = section(channels, name);
        return *here ? 0 : refuse(at, name, "is no sensor or actuator of this stage: correct the name");
    }
    if (sscanf(text, " device = \"%127[^\"]\" %c", channels->device, &more) == 1) return 0;
    if (sscanf(text, " %31[a-z_] = %63s %c", key, number, &more) != 2) return refuse(at, text, "write `key = number`");
    if (parse_number(number, &value) != 0) return refuse(at, number, "is not a finite number: write it in full");
    if (!*here) return refuse(at, key, "stands before the first [section]: move it into one");
    return set(*here, key, value) == 0 ? 0 : refuse(at, key, "is not a key with this value: see the comment on top");
}

static int check(const channel_t *c, const char *path, const char *name)
{
    const double size = fabs(c->sign);
    if (c->channel >= 0 && fabs(c->scale) > 0.0 && size >= 1.0 && size <= 1.0 && c->low < c->high) return 0;
    (void)fprintf(stderr, "%s: '%s' has channel %d, scale %g, sign %g, range %g .. %g: give a channel from 0, a scale "
        "that is not 0, a sign of 1 or -1, and low below high\n", path, name, c->channel, c->scale, c->sign, c->low,
        c->high);
    return -1;
}

int channels_read(const char *path, channels_t *channels)
{
    const channel_t fresh = {.channel = -1, .scale = 1.0, .sign = 1.0, .low = -10.0, .high = 10.0};
    channel_t *here = NULL;
    place_t at = {path, 0};
    char text[256];
    int bad = 0;
    FILE *const file = fopen(path, "r");
    if (!file) {
        perror(path);
        return -1;
    }
    *channels = (channels_t){.device = "", .enable = fresh};
    for (int i = 0; i < N_SENSORS; i++) channels->sensors[i] = fresh;
    for (int i = 0; i < N_SENSORS; i++) channels->last[i] = NAN;
    for (int i = 0; i < N_OUTPUTS; i++) channels->outputs[i] = fresh;
    for (at.line = 1; !bad && fgets(text, sizeof text, file); at.line++) bad = read_line(text, at, channels, &here);
    (void)fclose(file);
    for (int i = 0; !bad && i < N_SENSORS; i++) bad = check(&channels->sensors[i], path, SENSORS[i].name);
    for (int i = 0; !bad && i < N_OUTPUTS; i++) bad = check(&channels->outputs[i], path, OUTPUTS[i].name);
    return bad;
}

double channels_value(channels_t *channels, int sensor, double raw)
{
    const channel_t *const c = &channels->sensors[sensor];
    if (!(raw >= c->low && raw <= c->high)) return NAN;
    if (c->rollover > 0.0) {
        const double far = raw - channels->last[sensor];
        if (far > 0.5 * c->rollover) channels->turns[sensor] -= 1.0;
        if (far < -0.5 * c->rollover) channels->turns[sensor] += 1.0;
        channels->last[sensor] = raw;
    }
    return c->sign * c->scale * (raw + channels->turns[sensor] * c->rollover) + c->offset;
}

double channels_raw(const channel_t *c, double value)
{
    return fmin(fmax(c->sign * (value - c->offset) / c->scale, c->low), c->high);
}

/* The user's own input and output, io_user.c, through the channels. */

static channels_t user;

static int open_user(const io_options_t *options)
{
    return channels_read(options->channels, &user) == 0 ? user_open(&user) : -1;
}

static int read_user(double sensors[])
{
    double raw[N_SENSORS];
    if (user_read(&user, raw) != 0) return -1;
    for (int i = 0; i < N_SENSORS; i++) sensors[i] = channels_value(&user, i, raw[i]);
    return 0;
}

static int write_user(const double outputs[], int enabled)
{
    double raw[N_OUTPUTS];
    for (int i = 0; i < N_OUTPUTS; i++) raw[i] = channels_raw(&user.outputs[i], outputs[i]);
    return user_write(&user, raw, enabled);
}

const io_t IO_USER = {"user", open_user, read_user, write_user, user_close};
