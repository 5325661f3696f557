/* Motions of the set-points as functions of time, and the checks that a motion passes before it runs. */
#ifndef MOTION_H
#define MOTION_H

#include <stddef.h>

#include "stage.h"

#define SETTLE_S 0.3 /* in which the machine follows its set-points once these rest */

typedef enum { MOTION_NONE, MOTION_STEP, MOTION_MOVE, MOTION_RAMP, MOTION_SINE, MOTION_ZIGZAG, MOTION_ELLIPSE } kind_t;

/* r_i(t) = from_i + a_i A(t) + b_i B(t). A transition has A = 0 .. 1; a periodic one A = sin and, for an ellipse,
 * B = cos, which fade in during its first cycle and out during its last. A step is over once the machine has settled, so
 * that the next one is measured from where the machine is. */
typedef struct {
    kind_t kind;
    double from[SET_POINTS_SIZE], a[SET_POINTS_SIZE], b[SET_POINTS_SIZE];
    double duration, frequency; /* s, Hz */
} motion_t;

/* The set-points of a motion after t seconds; one that is not a number stays as it was. */
void motion_at(const motion_t *motion, double t, double set_points[]);

/* The move from one pose to another in the least time that the limits of speed, acceleration and jerk allow. */
motion_t motion_move(const double from[], const double to[]);

/* Read a motion such as `move z 1e-4 x 0`, which starts at `from`, and check it against ranges and limits.
 * Return 0, or -1 with a message of quantity, found, needed and mend. */
int motion_parse(char *words[], int count, const double from[], motion_t *motion, char *message, size_t size);

/* The index of a set-point, -1 if there is none of this name. */
int set_point_index(const char *name);

/* Read a finite number. Return 0, or -1 for any other text. */
int parse_number(const char *text, double *value);

#endif
