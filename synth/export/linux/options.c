#include "options.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion.h"

static const char USAGE[] =
    "usage: %s [--io plant|shm|user|comedi] [--seconds S] [--motion 'COMMAND']... [--record FILE] [--lockstep N]\n"
    "  --late count|hold|safe:N   what missed periods do beside being counted: hold the motion, or stop after N in a row\n"
    "  --stall MS                 the watchdog kills a loop that stands still for so long, 200 by default\n"
    "  --cpu N  --run FOLDER      processor; folder of the socket and the lock file\n"
    "  --channels FILE --comedi LIBRARY --memory FILE --seed N    of the back ends\n"
    "  --replay FOLDER            replay the vectors bit for bit instead\n";

static int choose_io(const char *name, options_t *options)
{
    const io_t *const all[] = {&IO_PLANT, &IO_SHM, &IO_USER, &IO_COMEDI};
    options->io = NULL;
    for (int i = 0; i < 4; i++) {
        if (strcmp(all[i]->name, name) == 0) options->io = all[i];
    }
    return options->io ? 0 : -1;
}

static int choose_late(const char *text, options_t *options)
{
    double n;
    options->late = (strcmp(text, "hold") == 0) ? LATE_HOLD : LATE_COUNT;
    if (strcmp(text, "hold") == 0 || strcmp(text, "count") == 0) return 0;
    if (strncmp(text, "safe:", 5) != 0 || parse_number(text + 5, &n) != 0 || !(n >= 1.0 && n <= 1e9)) return -1;
    options->late = LATE_SAFE;
    options->late_limit = (uint64_t)n;
    return 0;
}

static int number(const char *text, double low, double high, double *value)
{
    return (parse_number(text, value) == 0 && *value >= low && *value <= high) ? 0 : -1;
}

static int take(int option, const char *text, options_t *o)
{
    double value = 0.0;
    int bad = 0;
    switch (option) {
    case 'i': return choose_io(text, o);
    case 's': return number(text, 0.0, 1e9, &o->seconds);
    case 'm':
        if (o->motion_count == MOTIONS) return -1;
        o->motions[o->motion_count++] = text;
        return 0;
    case 'r': o->record = text; return 0;
    case 'n': bad = number(text, 1.0, 1e9, &value); o->lockstep = (long)value; return bad;
    case 'l': return choose_late(text, o);
    case 't': bad = number(text, 1.0, 1e6, &value); o->stall_s = 1e-3 * value; return bad;
    case 'c': bad = number(text, 0.0, 1023.0, &value); o->cpu = (int)value; return bad;
    case 'f': o->run = text; return 0;
    case 'h': o->back_end.channels = text; return 0;
    case 'd': o->back_end.library = text; return 0;
    case 'M': o->back_end.memory = text; return 0;
    case 'e': bad = number(text, 0.0, 1e9, &value); o->back_end.seed = (unsigned)value; return bad;
    case 'p': o->replay = text; return 0;
    default: return -1;
    }
}

int options_read(int count, char *words[], options_t *options)
{
    static const struct option LONG[] = {
        {"io", 1, 0, 'i'}, {"seconds", 1, 0, 's'}, {"motion", 1, 0, 'm'}, {"record", 1, 0, 'r'}, {"lockstep", 1, 0, 'n'},
        {"late", 1, 0, 'l'}, {"stall", 1, 0, 't'}, {"cpu", 1, 0, 'c'}, {"run", 1, 0, 'f'}, {"channels", 1, 0, 'h'},
        {"comedi", 1, 0, 'd'}, {"memory", 1, 0, 'M'}, {"seed", 1, 0, 'e'}, {"replay", 1, 0, 'p'}, {0, 0, 0, 0},
    };
    const char *const folder = getenv("XDG_RUNTIME_DIR");
    int option, bad = 0, which = 0;
    *options = (options_t){.io = &IO_PLANT, .cpu = -1, .stall_s = 0.2, .run = folder ? folder : "."};
    options->back_end = (io_options_t){.channels = "channels.toml", .library = "libcomedi.so.0", .seed = 1u};
    while (!bad && (option = getopt_long(count, words, "", LONG, &which)) != -1) {
        bad = take(option, optarg, options);
        if (bad && option != '?') (void)fprintf(stderr, "--%s: '%s' is not one of its values\n", LONG[which].name, optarg);
    }
    if (optind < count) (void)fprintf(stderr, "'%s' is no option\n", words[optind]);
    if (bad || optind < count) (void)fprintf(stderr, USAGE, words[0]);
    return (bad || optind < count) ? -1 : 0;
}
