/* One interface of every back end: what reads the sensors and drives the actuators. */
#ifndef IO_H
#define IO_H

typedef struct {
    const char *channels; /* channels.toml */
    const char *library;  /* of Comedi */
    const char *memory;   /* the file of shared memory */
    double seed;          /* of the simulated noise, a whole number */
    int settle;           /* 1: the simulated plant rests under the safe output before the first sample */
} io_options_t;

/* Every function returns 0, or -1 for a failure. `open` has then printed one message that says what to do. In a sample
 * `write` gives the outputs that are due, with 1 for enabled amplifiers, and `read` the sensors in their units. */
typedef struct {
    const char *name;
    int (*open)(const io_options_t *options);
    int (*read)(double sensors[]);
    int (*write)(const double outputs[], int enabled);
    void (*close)(void);
} io_t;

extern const io_t IO_PLANT, IO_SHM, IO_USER, IO_COMEDI;

#endif
