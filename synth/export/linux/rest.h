/* Whether the machine rests: how long its sensors have been good, and how long none has moved. */
#ifndef REST_H
#define REST_H

#include <stdint.h>

#include "stage.h"

typedef struct {
    uint64_t good, quiet; /* samples in a row: every sensor in its range; and none has moved */
    double at[N_SENSORS]; /* sensors where the machine rests, in their units */
} rest_t;

/* Take the sensors of one sample. */
void rest_look(rest_t *rest, const double sensors[]);

#endif
