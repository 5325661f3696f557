/* Boards of data acquisition through Comedi: analogue inputs, analogue outputs and one digital line that enables.
 *
 * libcomedi is loaded when it is asked for, so that the program builds and runs without it. Raw values are volts. */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#include "channels.h"

#define RANGE 0u  /* the first range of a channel, and */
#define GROUND 0u /* referred to ground */

/* The types and numbers of comedilib.h that are used here. */
typedef struct comedi_device comedi_t;
typedef unsigned int lsampl_t;
typedef struct {
    double min, max;
    unsigned int unit;
} comedi_range;
enum { ANALOG_INPUT = 1, ANALOG_OUTPUT = 2, DIGITAL_OUTPUT = 4, DIGITAL_IO = 5 };

static struct {
    channels_t channels;
    comedi_t *device;
    unsigned input, output, digital; /* subdevices */
    comedi_t *(*open)(const char *path);
    int (*close)(comedi_t *device);
    int (*find)(comedi_t *device, int type, unsigned start);
    int (*read)(comedi_t *, unsigned subdevice, unsigned channel, unsigned range, unsigned reference, lsampl_t *data);
    int (*write)(comedi_t *, unsigned subdevice, unsigned channel, unsigned range, unsigned reference, lsampl_t data);
    int (*line)(comedi_t *, unsigned subdevice, unsigned channel, unsigned bit);
    lsampl_t (*largest)(comedi_t *, unsigned subdevice, unsigned channel);
    comedi_range *(*range)(comedi_t *, unsigned subdevice, unsigned channel, unsigned range);
    double (*to_volts)(lsampl_t data, const comedi_range *range, lsampl_t largest);
    lsampl_t (*from_volts)(double volts, const comedi_range *range, lsampl_t largest);
    comedi_range *sensor_range[N_SENSORS], *output_range[N_OUTPUTS];
    lsampl_t sensor_largest[N_SENSORS], output_largest[N_OUTPUTS];
} board;

/* A pointer to a function cannot be cast from one to data in C99; POSIX says that its bytes can be copied. */
static int load(void *library, const char *name, void *function, size_t size)
{
    void *const address = dlsym(library, name);
    memcpy(function, &address, size);
    return address ? 0 : -1;
}

static int load_all(const char *path)
{
    void *const library = dlopen(path, RTLD_NOW);
    if (!library) {
        (void)fprintf(stderr, "comedi: %s: install libcomedi, or give its path with --comedi\n", dlerror());
        return -1;
    }
#define LOAD(member, name) load(library, name, &board.member, sizeof board.member)
    if (LOAD(open, "comedi_open") | LOAD(close, "comedi_close") | LOAD(find, "comedi_find_subdevice_by_type")
        | LOAD(read, "comedi_data_read") | LOAD(write, "comedi_data_write") | LOAD(line, "comedi_dio_write")
        | LOAD(largest, "comedi_get_maxdata") | LOAD(range, "comedi_get_range") | LOAD(to_volts, "comedi_to_phys")
        | LOAD(from_volts, "comedi_from_phys")) {
        (void)fprintf(stderr, "comedi: '%s' lacks a function of libcomedi: install another version\n", path);
        return -1;
    }
    return 0;
}

/* The range and the largest count of a channel; a channel without them is not there. */
static int describe(unsigned subdevice, const channel_t *c, const char *name, comedi_range **range, lsampl_t *largest)
{
    *range = board.range(board.device, subdevice, (unsigned)c->channel, RANGE);
    *largest = board.largest(board.device, subdevice, (unsigned)c->channel);
    if (*range && *largest) return 0;
    (void)fprintf(stderr, "comedi: '%s' of %s: the board has no channel %d: correct channels.toml\n", name,
        board.channels.device, c->channel);
    return -1;
}

static int open_comedi(const io_options_t *options)
{
    if (channels_read(options->channels, &board.channels) != 0 || load_all(options->library) != 0) return -1;
    board.device = board.open(board.channels.device);
    if (!board.device) {
        (void)fprintf(stderr, "comedi: the device '%s' cannot be opened: name it in channels.toml, load its driver, "
            "and give this user the right to it\n", board.channels.device);
        return -1;
    }
    const int input = board.find(board.device, ANALOG_INPUT, 0u), output = board.find(board.device, ANALOG_OUTPUT, 0u);
    const int lines = board.find(board.device, DIGITAL_OUTPUT, 0u);
    const int digital = (lines >= 0) ? lines : board.find(board.device, DIGITAL_IO, 0u);
    if (input < 0 || output < 0 || (digital < 0 && board.channels.enable.channel >= 0)) {
        (void)fprintf(stderr, "comedi: '%s' lacks analogue inputs, analogue outputs or the line that enables: choose "
            "another board, or write io_user.c\n", board.channels.device);
        return -1;
    }
    board.input = (unsigned)input;
    board.output = (unsigned)output;
    board.digital = (unsigned)digital;
    int bad = 0;
    for (int i = 0; i < N_SENSORS && !bad; i++) {
        bad = describe(board.input, &board.channels.sensors[i], SENSORS[i].name, &board.sensor_range[i],
            &board.sensor_largest[i]);
    }
    for (int i = 0; i < N_OUTPUTS && !bad; i++) {
        bad = describe(board.output, &board.channels.outputs[i], OUTPUTS[i].name, &board.output_range[i],
            &board.output_largest[i]);
    }
    return bad;
}

static int read_comedi(double sensors[])
{
    int bad = 0;
    for (int i = 0; i < N_SENSORS; i++) {
        lsampl_t data = 0u;
        const unsigned channel = (unsigned)board.channels.sensors[i].channel;
        bad |= board.read(board.device, board.input, channel, RANGE, GROUND, &data) < 0;
        const double volts = board.to_volts(data, board.sensor_range[i], board.sensor_largest[i]);
        sensors[i] = channels_value(&board.channels, i, volts);
    }
    return bad ? -1 : 0;
}

static int write_comedi(const double outputs[], int enabled)
{
    const channel_t *const enable = &board.channels.enable;
    int bad = 0;
    for (int i = 0; i < N_OUTPUTS; i++) {
        const channel_t *const c = &board.channels.outputs[i];
        const double volts = channels_raw(c, outputs[i]);
        const lsampl_t data = board.from_volts(volts, board.output_range[i], board.output_largest[i]);
        bad |= board.write(board.device, board.output, (unsigned)c->channel, RANGE, GROUND, data) < 0;
    }
    if (enable->channel >= 0) {
        bad |= board.line(board.device, board.digital, (unsigned)enable->channel, enabled ? 1u : 0u) < 0;
    }
    return bad ? -1 : 0;
}

static void close_comedi(void)
{
    (void)board.close(board.device);
}

const io_t IO_COMEDI = {"comedi", open_comedi, read_comedi, write_comedi, close_comedi};
