#include "options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion.h"

static const char USAGE[] =
    "usage: %s [--io plant|shm|user|comedi] [--seconds S] [--motion 'COMMAND']... [--record FILE]\n"
    "  --lockstep N               N samples of the simulated plant without real time\n"
    "  --late count|hold|safe:N   missed periods are counted, and hold the motion, or stop after N in a row\n"
    "  --stall MS                 the watchdog kills a loop that stands still for so long, 200 by default\n"
    "  --cpu N  --run FOLDER      processor; folder of the socket and the lock file\n"
    "  --channels FILE --comedi LIBRARY --memory FILE --seed N    of the back ends\n"
    "  --replay FOLDER            replay the vectors bit for bit instead\n";

static int choose_io(const char *name, options_t *options)
{
    const io_t *const all[] = {&IO_PLANT, &IO_SHM, &IO_USER, &IO_COMEDI};
    for (int i = 0; i < 4; i++) {
        if (strcmp(all[i]->name, name) != 0) continue;
        options->io = all[i];
        return 0;
    }
    return -1;
}

static int choose_late(const char *text, options_t *options)
{
    const int safe = strncmp(text, "safe:", 5) == 0;
    options->late = safe ? LATE_SAFE : (strcmp(text, "hold") == 0) ? LATE_HOLD : LATE_COUNT;
    if (safe) return parse_number(text + 5, &options->late_limit) == 0 && options->late_limit >= 1.0 ? 0 : -1;
    return strcmp(text, "hold") == 0 || strcmp(text, "count") == 0 ? 0 : -1;
}

/* One option with its value. Return 0, or -1, with what is allowed where that is a range. */
static int take(const char *name, const char *text, options_t *o, char *allowed, size_t size)
{
    const struct {
        const char *name;
        const char **text;
    } texts[] = {
        {"--record", &o->record}, {"--run", &o->run}, {"--replay", &o->replay}, {"--channels", &o->back_end.channels},
        {"--comedi", &o->back_end.library}, {"--memory", &o->back_end.memory},
    };
    const struct {
        const char *name;
        double *value, low, high;
    } numbers[] = {
        {"--seconds", &o->seconds, 0.0, 1e9}, {"--lockstep", &o->lockstep, 1.0, 1e9}, {"--cpu", &o->cpu, 0.0, 1023.0},
        {"--stall", &o->stall_ms, 1.0, 1e6}, {"--seed", &o->back_end.seed, 0.0, 4e9},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        if (strcmp(name, texts[i].name) != 0) continue;
        *texts[i].text = text;
        return 0;
    }
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (strcmp(name, numbers[i].name) != 0) continue;
        const int bad = parse_number(text, numbers[i].value) != 0;
        (void)snprintf(allowed, size, ": give a number from %.9g to %.9g", numbers[i].low, numbers[i].high);
        return bad || *numbers[i].value < numbers[i].low || *numbers[i].value > numbers[i].high ? -1 : 0;
    }
    if (strcmp(name, "--motion") == 0) {
        (void)snprintf(allowed, size, ": at most %d motions are possible", MOTIONS);
        if (o->motion_count == MOTIONS) return -1;
        o->motions[o->motion_count++] = text;
        return 0;
    }
    if (strcmp(name, "--io") == 0) return choose_io(text, o);
    return strcmp(name, "--late") == 0 ? choose_late(text, o) : -1;
}

int options_read(int count, char *words[], options_t *options)
{
    const char *const folder = getenv("XDG_RUNTIME_DIR");
    const int is_folder = folder && folder[0] == '/'; /* its specification: any other one is invalid */
    *options = (options_t){.io = &IO_PLANT, .cpu = -1.0, .stall_ms = 200.0, .run = is_folder ? folder : "."};
    options->back_end = (io_options_t){.channels = "channels.toml", .library = "libcomedi.so.0", .seed = 1.0};
    for (int k = 1; k < count; k += 2) {
        char allowed[64] = "";
        if (k + 1 < count && take(words[k], words[k + 1], options, allowed, sizeof allowed) == 0) continue;
        if (strcmp(words[k], "--help") != 0) {
            (void)fprintf(stderr, "'%s %s' is no option with its value%s\n", words[k],
                k + 1 < count ? words[k + 1] : "", allowed);
        }
        (void)fprintf(stderr, USAGE, words[0]);
        return -1;
    }
    options->live = !(options->lockstep > 0.0);
    if (options->live || options->io == &IO_PLANT) return 0;
    (void)fprintf(stderr, "--lockstep has no clock and no watchdog: it is for --io plant alone, not for %s\n",
        options->io->name);
    return -1;
}
