/* A stand-in for libcomedi: two inputs of 16 bits over +-10 V that read back the outputs, and a log of every write. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    double min, max;
    unsigned int unit;
} comedi_range;

static comedi_range range = {-10.0, 10.0, 0u};
static FILE *calls;
static int device;

void *comedi_open(const char *path)
{
    if (strcmp(path, "present") != 0) return NULL;
    calls = fopen("comedi.log", "w");
    if (calls) (void)setvbuf(calls, NULL, _IOLBF, 0); /* two processes have it */
    return &device;
}

int comedi_close(void *it)
{
    (void)it;
    return fclose(calls);
}

int comedi_find_subdevice_by_type(void *it, int type, unsigned start)
{
    (void)it;
    (void)start;
    return getenv("NO_OUTPUTS") && type == 2 ? -1 : type;
}

comedi_range *comedi_get_range(void *it, unsigned subdevice, unsigned channel, unsigned n)
{
    (void)it;
    (void)subdevice;
    return channel < 4u && n == 0u ? &range : NULL;
}

unsigned comedi_get_maxdata(void *it, unsigned subdevice, unsigned channel)
{
    (void)it;
    (void)subdevice;
    return channel < 4u ? 65535u : 0u;
}

double comedi_to_phys(unsigned data, const comedi_range *r, unsigned largest)
{
    return r->min + (r->max - r->min) * data / largest;
}

unsigned comedi_from_phys(double volts, const comedi_range *r, unsigned largest)
{
    return (unsigned)lrint((volts - r->min) / (r->max - r->min) * largest);
}

int comedi_data_read(void *it, unsigned subdevice, unsigned channel, unsigned n, unsigned reference, unsigned *data)
{
    (void)it;
    (void)n;
    (void)reference;
    if (getenv("DEAD_INPUTS")) return -1;
    *data = comedi_from_phys(subdevice == 1u ? 1.0 + channel : 0.0, &range, 65535u);
    return 1;
}

int comedi_data_write(void *it, unsigned subdevice, unsigned channel, unsigned n, unsigned reference, unsigned data)
{
    (void)it;
    (void)n;
    (void)reference;
    return fprintf(calls, "write %u %u %.4f\n", subdevice, channel, comedi_to_phys(data, &range, 65535u));
}

int comedi_dio_write(void *it, unsigned subdevice, unsigned channel, unsigned bit)
{
    (void)it;
    return fprintf(calls, "line %u %u %u\n", subdevice, channel, bit);
}
