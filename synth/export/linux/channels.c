#include "channels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "motion.h"

typedef struct {
    const char *path;
    int line;
} place_t;

static const char *const KEYS[] = {"channel", "scale", "offset", "sign", "low", "high", "rollover"};
enum { N_KEYS = 7 };

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

static int enter(const char *name, place_t at, channels_t *channels, channel_t **here)
{
    *here = section(channels, name);
    if (!*here) return refuse(at, name, "is no sensor or actuator of this stage: correct the name");
    if ((*here)->line) return refuse(at, name, "is here for the second time: keep one section of a name");
    (*here)->line = at.line;
    return 0;
}

/* What the value of a key must be; NULL for a good one. */
static const char *needed(const char *key, double value)
{
    const double size = fabs(value);
    if (strcmp(key, "channel") == 0 && (value < -1.0 || value > 1e6 || floor(value) < value)) {
        return "need a whole number, up to 1e6, -1 for no line that enables";
    }
    if (strcmp(key, "scale") == 0 && !(size > 0.0)) return "need a number that is not 0";
    if (strcmp(key, "sign") == 0 && !(size >= 1.0 && size <= 1.0)) return "need a sign of 1 or -1";
    return strcmp(key, "rollover") == 0 && value < 0.0 ? "need a positive number of raw values, 0 for none" : NULL;
}

static int set(channel_t *c, const char *key, double value, place_t at)
{
    double channel = 0.0, *const members[N_KEYS] = {&channel, &c->scale, &c->offset, &c->sign, &c->low, &c->high,
        &c->rollover};
    char found[64];
    const char *const need = needed(key, value);
    int k = 0;
    while (k < N_KEYS && strcmp(key, KEYS[k]) != 0) k++;
    if (k == N_KEYS) return refuse(at, key, "is no key: see the comment on top");
    (void)snprintf(found, sizeof found, "%s = %.9g", key, value);
    if (need) return refuse(at, found, need);
    if (c->given & (1u << k)) return refuse(at, found, "is the second value of this key in the section: keep one");
    c->given |= 1u << k;
    *members[k] = value;
    if (k == 0) c->channel = (int)value;
    return 0;
}

/* One line: empty, [section], device = "..." or key = number, each with a comment or without. */
static int read_line(char *text, place_t at, channels_t *channels, channel_t **here)
{
    char name[128], key[32], number[64], more;
    int end = 0;
    double value;
    text[strcspn(text, "#\r\n")] = '\0';
    if (text[strspn(text, " \t")] == '\0') return 0;
    if (sscanf(text, " [%127[^]]] %n", name, &end) == 1 && end > 0 && !text[end]) {
        return enter(name, at, channels, here);
    }
    if (sscanf(text, " device = \"%127[^\"]\" %n", name, &end) == 1 && end > 0 && !text[end]) {
        if (channels->device[0]) return refuse(at, text, "is the second device: keep one");
        (void)strcpy(channels->device, name);
        return 0;
    }
    if (sscanf(text, " %31[a-z_] = %63s %c", key, number, &more) != 2) return refuse(at, text, "write `key = number`");
    if (parse_number(number, &value) != 0) return refuse(at, number, "is not a finite number: write it in full");
    if (!*here) return refuse(at, key, "stands before the first [section]: move it into one");
    return set(*here, key, value, at);
}

/* The sections of the sensors or of the actuators, after the last line. */
static int check(const channel_t all[], const signal_t signals[], int count, place_t at)
{
    char found[256];
    for (int i = 0; i < count; i++) {
        const channel_t *const c = &all[i];
        const place_t here = {at.path, c->line};
        const double span = c->high - c->low;
        if (!c->line) return refuse(at, signals[i].name, "has no section: add it");
        (void)snprintf(found, sizeof found, "'%s' has channel %d, low %g, high %g, rollover %g", signals[i].name,
            c->channel, c->low, c->high, c->rollover);
        if (c->channel < 0) return refuse(here, found, "need a channel from 0");
        if (!(c->given & 2u)) return refuse(here, found, "need a scale, in units per raw");
        if (!(span > 0.0)) return refuse(here, found, "need a low below the high");
        if (c->rollover > 0.0 && (span < c->rollover - 1.0 || span > c->rollover)) {
            return refuse(here, found, "need the first and the last raw value before it rolls over as low and high");
        }
        for (int k = 0; k < i; k++) {
            if (all[k].channel == c->channel) return refuse(here, found, "need a channel that no other signal has");
        }
    }
    return 0;
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
    for (at.line = 1; !bad && fgets(text, sizeof text, file); at.line++) {
        /* The rest of a long line would be read as the next one. */
        const int whole = strchr(text, '\n') || feof(file);
        bad = whole ? read_line(text, at, channels, &here)
            : refuse(at, "found more than 254 bytes, or one that is 0", "need a shorter line of text: break it");
    }
    (void)fclose(file);
    if (bad || check(channels->sensors, SENSORS, N_SENSORS, at) != 0) return -1;
    return check(channels->outputs, OUTPUTS, N_OUTPUTS, at);
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
