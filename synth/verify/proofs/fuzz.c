/* Fuzz driver: run one emitted controller on arbitrary bytes and check its contract after every step.
 * synth_fuzz_tables.h is generated from the manifest: INPUTS, OUTPUTS, STATES, FAULTS, SUSPECTS, DECIDED, LATCH,
 * BAD_SAMPLES, COUNTED, LATCHES_LATER, the types and the functions. The bytes are read cyclically; every fuzz input therefore gives STEPS_A_RUN steps. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum { FLOAT, DOUBLE, UINT32, INT32 } scalar_t;
typedef struct { const char *name; size_t offset; scalar_t type; double low; double high; } member_t;
typedef struct { uint32_t bits; size_t first; size_t count; } fault_t;

#include "synth_fuzz_tables.h"

enum { STEPS_A_RUN = 16 };
#define COUNT(table) (sizeof(table) / sizeof((table)[0]))

typedef struct { const uint8_t *data; size_t size; size_t at; } bytes_t;

static uint64_t steps;

static void tell(void) { fprintf(stderr, "steps: %llu\n", (unsigned long long)steps); }

static uint8_t byte(bytes_t *bytes)
{
    return bytes->size ? bytes->data[bytes->at++ % bytes->size] : 0u;
}

static uint64_t word(bytes_t *bytes, int count)
{
    uint64_t value = 0u;
    while (count-- > 0) value = value << 8 | byte(bytes);
    return value;
}

/* Every value of every type is exact as a double; a NaN stays NaN. */
static double get(const void *record, const member_t *m)
{
    const char *at = (const char *)record + m->offset;
    float f; double d; uint32_t u; int32_t i;
    switch (m->type) {
    case FLOAT: memcpy(&f, at, sizeof f); return (double)f;
    case DOUBLE: memcpy(&d, at, sizeof d); return d;
    case UINT32: memcpy(&u, at, sizeof u); return (double)u;
    default: memcpy(&i, at, sizeof i); return (double)i;
    }
}

/* `value` must be within the range of an integer member. */
static void set(void *record, const member_t *m, double value)
{
    char *at = (char *)record + m->offset;
    const float f = (float)value;
    uint32_t u; int32_t i;
    switch (m->type) {
    case FLOAT: memcpy(at, &f, sizeof f); break;
    case DOUBLE: memcpy(at, &value, sizeof value); break;
    case UINT32: u = (uint32_t)value; memcpy(at, &u, sizeof u); break;
    default: i = (int32_t)value; memcpy(at, &i, sizeof i); break;
    }
}

static void set_bits(void *record, const member_t *m, bytes_t *bytes)
{
    const uint64_t bits = word(bytes, m->type == DOUBLE ? 8 : 4);
    const uint32_t low_bits = (uint32_t)bits;
    char *at = (char *)record + m->offset;
    if (m->type == DOUBLE) memcpy(at, &bits, sizeof bits);
    else memcpy(at, &low_bits, sizeof low_bits);
}

static bool within(double value, const member_t *m) { return m->low <= value && value <= m->high; }

/* A NaN becomes the upper bound. */
static double forced(double value, const member_t *m)
{
    return value <= m->low ? m->low : value <= m->high ? value : m->high;
}

static double between(bytes_t *bytes, const member_t *m)
{
    const double value = m->low + (m->high - m->low) * ((double)word(bytes, 3) / 16777215.0);
    return forced(m->type == FLOAT ? (double)(float)value : value, m);
}

static void draw_state(void *state, bytes_t *bytes)
{
    for (size_t k = 0; k < COUNT(STATES); k++) {
        const member_t *m = &STATES[k];
        switch (byte(bytes) & 7u) {
        case 0: set(state, m, m->low); break;
        case 1: set(state, m, m->high); break;
        case 2: case 3: set_bits(state, m, bytes); set(state, m, forced(get(state, m), m)); break;
        default: set(state, m, between(bytes, m)); break;
        }
    }
}

/* The next number outside a bound; an integer has no value outside its bound. */
static double outside(const member_t *m, bool above)
{
    const double bound = above ? m->high : m->low, towards = above ? INFINITY : -INFINITY;
    if (m->type == FLOAT) return (double)nextafterf((float)bound, (float)towards);
    return m->type == DOUBLE ? nextafter(bound, towards) : bound;
}

/* Special values that raw bits seldom contain; an integer has none. */
static void set_special(void *record, const member_t *m, bytes_t *bytes)
{
    static const double SPECIAL[] = {NAN, -NAN, INFINITY, -INFINITY, 0.0, -0.0, 1e-40, 1e38};
    const double value = SPECIAL[byte(bytes) % COUNT(SPECIAL)];
    if (m->type == FLOAT || m->type == DOUBLE) set(record, m, value);
    else set_bits(record, m, bytes);
}

static void draw_input(void *input, const member_t *members, size_t count, bytes_t *bytes)
{
    for (size_t k = 0; k < count; k++) {
        const member_t *m = &members[k];
        switch (byte(bytes) & 15u) {
        case 0: set_bits(input, m, bytes); break;
        case 1: set_special(input, m, bytes); break;
        case 2: set(input, m, m->low); break;
        case 3: set(input, m, m->high); break;
        case 4: set(input, m, outside(m, false)); break;
        case 5: set(input, m, outside(m, true)); break;
        default: set(input, m, between(bytes, m)); break;
        }
    }
}

static void finding(const char *what, const char *name, double found, double low, double high)
{
    fprintf(stderr, "FINDING: %s %s is %.9g, need %.9g .. %.9g\n", what, name, found, low, high);
    abort();
}

static void require_bounds(const char *what, const void *record, const member_t *members, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        const double value = get(record, &members[k]);
        if (!within(value, &members[k])) finding(what, members[k].name, value, members[k].low, members[k].high);
    }
}

/* The expected fault bits of the inputs. */
static uint32_t expected(const void *input)
{
    uint32_t bits = 0u;
    for (size_t k = 0; k < COUNT(FAULTS); k++) {
        bool bad = false;
        for (size_t j = 0; j < FAULTS[k].count; j++) {
            const member_t *m = &INPUTS[FAULTS[k].first + j];
            bad = bad || !within(get(input, m), m);
        }
        bits |= bad ? FAULTS[k].bits : 0u;
    }
    return bits;
}

/* A bad sample counts BAD_WEIGHT times, and GOOD_SAMPLES good ones make up for it; without them one ends the row. */
#define BAD_WEIGHT (GOOD_SAMPLES > 0u ? GOOD_SAMPLES : 1u)
static uint32_t next_row(uint32_t row, bool bad)
{
    if (bad) return row + BAD_WEIGHT;
    return GOOD_SAMPLES > 0u && row > 0u ? row - 1u : 0u;
}

/* From init the latch may be set only after BAD_SAMPLES consecutive samples with a bad input; it is never reset. `row`
 * counts those up to now, or with LATCHES_LATER the longest row since init, which may have ended. The
 * step decides freely which inputs are suspects, and on the bits that concern no single input. */
static void require_faults(uint32_t found, uint32_t before, uint32_t called_for, uint32_t row, bool from_init)
{
    const double word = (double)(found & ~(LATCH | DECIDED)), wanted = (double)called_for;
    if (word != wanted) finding("fault word", "", word, wanted, wanted);
    if ((before & LATCH) && !(found & LATCH)) finding("latch", "", 0.0, 1.0, 1.0);
    if (from_init && (found & LATCH) && !(before & LATCH) && row < BAD_SAMPLES * BAD_WEIGHT)
        finding("latch", "from init", 1.0, 0.0, 0.0);
}

#ifdef TUNE
/* Parameters that are sound, out of range, not finite or half of a change; those that are refused change nothing. */
static void tune(state_t *state, bytes_t *bytes)
{
    parameters_t wanted;
    if (byte(bytes) & 1u) draw_input(&wanted, PARAMETERS, COUNT(PARAMETERS), bytes);
    else for (size_t k = 0; k < COUNT(PARAMETERS); k++) set(&wanted, &PARAMETERS[k], between(bytes, &PARAMETERS[k]));
    const bool is_whole = (byte(bytes) & 3u) != 0u;
    wanted.check = CHECK(&wanted) ^ (is_whole ? 0u : 1u + byte(bytes));
    const uint32_t left = byte(bytes);
    bool is_sound = is_whole && left > 0u;
    for (size_t k = 0; k < COUNT(PARAMETERS); k++) is_sound = is_sound && within(get(&wanted, &PARAMETERS[k]), &PARAMETERS[k]);
    const state_t before = *state;
    const bool is_taken = TUNE(state, &wanted, left) == 0u;
    if (is_taken != is_sound) finding("taken parameters", "", is_taken, is_sound, is_sound);
    if (!is_taken && memcmp(&before, state, sizeof before) != 0) finding("change by refused parameters", "", 1.0, 0.0, 0.0);
    require_bounds("tuned state", state, STATES, COUNT(STATES));
}
#endif

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    return atexit(tell);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes_t bytes = {data, size, 0u};
    /* On the heap, where the sanitizer detects a step that writes past a struct. */
    state_t *const state = malloc(sizeof *state);
    input_t *const input = malloc(sizeof *input);
    output_t *const output = malloc(sizeof *output);
    uint32_t row = 0u, longest = 0u, faults = 0u;
    const bool from_init = (byte(&bytes) & 1u) == 0u;

    INIT(state);
    require_bounds("initial state", state, STATES, COUNT(STATES));
    if (!from_init) draw_state(state, &bytes);
    for (int k = 0; k < STEPS_A_RUN; k++) {
        memset(output, 0xff, sizeof *output); /* NaN until written */
        draw_input(input, INPUTS, COUNT(INPUTS), &bytes);
#ifdef TUNE
        tune(state, &bytes);
#endif
        const uint32_t before = faults, called_for = expected(input);
        faults = STEP(state, input, output);
        steps++;
        row = next_row(row, ((called_for & COUNTED) | (faults & SUSPECTS)) != 0u);
        longest = row > longest ? row : longest;
        require_faults(faults, before, called_for, LATCHES_LATER ? longest : row, from_init);
        require_bounds("output", output, OUTPUTS, COUNT(OUTPUTS));
        require_bounds("state", state, STATES, COUNT(STATES));
    }
    free(state);
    free(input);
    free(output);
    return 0;
}
