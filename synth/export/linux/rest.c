#include "rest.h"

#include <math.h>
#include <string.h>

void rest_look(rest_t *rest, const double sensors[])
{
    int good = 1, quiet = 1;
    for (int i = 0; i < N_SENSORS; i++) {
        good &= sensors[i] >= SENSORS[i].low && sensors[i] <= SENSORS[i].high;
        quiet &= fabs(sensors[i] - rest->at[i]) <= SENSORS[i].rest;
    }
    rest->good = good ? rest->good + 1u : 0u;
    rest->quiet = (good && quiet) ? rest->quiet + 1u : 0u;
    if (!quiet) memcpy(rest->at, sensors, sizeof rest->at);
}
