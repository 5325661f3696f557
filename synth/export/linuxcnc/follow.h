/* A set-point on its way to its target, within the largest speed and acceleration of its coordinate: one that keeps
 * within both is followed without a lag, any other is caught up with. */
#ifndef FOLLOW_H
#define FOLLOW_H

#include <math.h>

#include "stage.h"

typedef struct {
    double at, speed, target; /* units, units per s, units */
} path_t;

/* Where a pin leads: into the range of its set-point, or, where it is not finite, to where it did before. Without this
 * a pin far beyond the range would draw the set-point so far away that it takes long to come back. */
static inline double follow_goal(double pin, double before, const signal_t *range)
{
    return isfinite(pin) ? fmin(fmax(pin, range->low), range->high) : before;
}

/* One sample: move towards `target`, which is finite, and return the set-point. */
static inline double follow(path_t *path, double target, const limits_t *limits)
{
    const double h = STAGE_PERIOD_S, change = limits->acceleration * h;
    const double far = target - path->at;
    const double moved = (target - path->target) / h; /* speed of the target */
    path->target = target;
    if (fabs(far) <= limits->speed * h && fabs(far / h - path->speed) <= change && fabs(far / h - moved) <= change) {
        path->speed = far / h;
        path->at = target;
        return target;
    }
    /* The speed v from which it comes to rest beside the target in n + 1 samples:
     * behind = h (v + (v - change) + (v - 2 change) + ... + (v - n change)). */
    const double behind = far - moved * h;
    const double n = floor(0.5 * (sqrt(1.0 + 8.0 * fabs(behind) / (change * h)) - 1.0));
    const double stop = (fabs(behind) / h + 0.5 * change * n * (n + 1.0)) / (n + 1.0);
    const double speed = fmin(fmax(moved + copysign(stop, behind), -limits->speed), limits->speed);
    path->speed += fmin(fmax(speed - path->speed, -change), change);
    path->at += path->speed * h;
    return path->at;
}

#endif
