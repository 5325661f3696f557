#include "motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TWO_PI 6.283185307179586
#define ROUNDED 0.1         /* of a ramp, or of a zigzag's quarter: its rounded end */
#define LONGEST_S 3600.0    /* of a motion, all samples of which are checked */
#define CYCLE 20.0          /* samples at least, so that they show what is between them, too */
#define ROUNDING 1e-6       /* of a range, which is in single precision */
#define SLACK 1e-3          /* relative, of speeds and accelerations from finite differences */

/* 0 .. 1 with no speed and no acceleration at its ends; peaks of its derivatives: 1.875, 5.774, 60. */
static double smooth(double s)
{
    const double c = fmin(fmax(s, 0.0), 1.0);
    return c * c * c * (10.0 + c * (6.0 * c - 15.0));
}

/* 0 .. 1 at a constant speed, with parabolic ends. */
static double ramp(double s)
{
    const double c = fmin(fmax(s, 0.0), 1.0), speed = 1.0 / (1.0 - ROUNDED);
    if (c < ROUNDED) return speed * c * c / (2.0 * ROUNDED);
    if (c > 1.0 - ROUNDED) return 1.0 - speed * (1.0 - c) * (1.0 - c) / (2.0 * ROUNDED);
    return speed * (c - ROUNDED / 2.0);
}

/* A triangle of period 1 with the phase of a sine, its corners rounded to parabolas and its peaks at +-1. */
static double triangle(double cycles)
{
    const double phase = cycles - floor(cycles), corner = ROUNDED / 4.0;
    const double half = (phase < 0.5) ? 1.0 : -1.0, e = fabs(phase - ((phase < 0.5) ? 0.25 : 0.75));
    const double value = (e < corner) ? 1.0 - 2.0 * corner - 2.0 * e * e / corner : 1.0 - 4.0 * e;
    return half * value / (1.0 - 2.0 * corner);
}

static void evaluate(const motion_t *motion, double t, double set_points[])
{
    const double s = (motion->duration > 0.0) ? t / motion->duration : 1.0, cycles = motion->frequency * t;
    const double fade = smooth(cycles) * smooth(motion->frequency * (motion->duration - t));
    double a = 1.0, b = 0.0;
    switch (motion->kind) {
    case MOTION_MOVE: a = smooth(s); break;
    case MOTION_RAMP: a = ramp(s); break;
    case MOTION_SINE: a = fade * sin(TWO_PI * cycles); break;
    case MOTION_ZIGZAG: a = fade * triangle(cycles); break;
    case MOTION_ELLIPSE: a = fade * sin(TWO_PI * cycles); b = fade * cos(TWO_PI * cycles); break;
    case MOTION_NONE: case MOTION_STEP: default: break;
    }
    for (int i = 0; i < N_SET_POINTS; i++) {
        set_points[i] = motion->from[i] + motion->a[i] * a + motion->b[i] * b;
    }
}

void motion_at(const motion_t *motion, double t, double set_points[])
{
    double r[SET_POINTS_SIZE];
    evaluate(motion, t, r);
    for (int i = 0; i < N_SET_POINTS; i++) {
        /* It was checked but for a rounding. */
        if (!isnan(r[i])) set_points[i] = fmin(fmax(r[i], SET_POINTS[i].low), SET_POINTS[i].high);
    }
}

motion_t motion_move(const double from[], const double to[])
{
    motion_t move = {.kind = MOTION_MOVE};
    for (int i = 0; i < N_SET_POINTS; i++) {
        const double far = fabs(to[i] - from[i]);
        move.from[i] = from[i];
        move.a[i] = to[i] - from[i];
        move.duration = fmax(move.duration, 1.875 * far / LIMITS[i].speed);
        move.duration = fmax(move.duration, sqrt(5.774 * far / LIMITS[i].acceleration));
        move.duration = fmax(move.duration, cbrt(60.0 * far / LIMITS[i].jerk));
    }
    move.duration = ceil(move.duration / STAGE_PERIOD_S + 1.0) * STAGE_PERIOD_S;
    return move;
}

int set_point_index(const char *name)
{
    for (int i = 0; i < N_SET_POINTS; i++) {
        if (strcmp(SET_POINTS[i].name, name) == 0) return i;
    }
    return -1;
}

int parse_number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return (end != text && *end == '\0' && isfinite(*value)) ? 0 : -1;
}

/* Refuse a value beyond a limit: the quantity, what was found, what is possible, and the mend. */
static int refuse(char *message, size_t size, int i, const char *what, double value, const char *per, double limit,
    const char *mend)
{
    (void)snprintf(message, size, "%s of %s would be %.6g %s%s, at %s %.6g is possible: %s", what, SET_POINTS[i].name,
        value, SET_POINTS[i].unit, per, value < limit ? "least" : "most", limit, mend);
    return -1;
}

/* Hold the farthest set-points and the largest step against their limits. A comparison with a NaN refuses it. */
static int check_range(const motion_t *motion, char *message, size_t size)
{
    const int transition = motion->kind <= MOTION_RAMP;
    for (int i = 0; i < N_SET_POINTS; i++) {
        const signal_t *const s = &SET_POINTS[i];
        const double to = motion->from[i] + motion->a[i], far = fabs(motion->a[i]) + fabs(motion->b[i]);
        const double high = transition ? to : motion->from[i] + far, low = transition ? to : motion->from[i] - far;
        const double slack = ROUNDING * (s->high - s->low);
        if (!(high <= s->high + slack)) {
            return refuse(message, size, i, "the value", high, "", s->high, "make it smaller");
        }
        if (!(low >= s->low - slack)) {
            return refuse(message, size, i, "the value", low, "", s->low, "make it larger");
        }
        if (motion->kind == MOTION_STEP && !(far <= LIMITS[i].step + slack)) {
            return refuse(message, size, i, "the step", far, "", LIMITS[i].step, "use move");
        }
    }
    return 0;
}

/* Hold speed and acceleration in every sample against the limits of each set-point. */
static int check_samples(const motion_t *motion, char *message, size_t size)
{
    double last[SET_POINTS_SIZE], speed[SET_POINTS_SIZE] = {0.0}, r[SET_POINTS_SIZE];
    const long samples = lround(motion->duration / STAGE_PERIOD_S);
    memcpy(last, motion->from, sizeof last);
    for (long k = 1; k <= samples + 1; k++) {
        evaluate(motion, (double)k * STAGE_PERIOD_S, r);
        for (int i = 0; i < N_SET_POINTS; i++) {
            const limits_t *const most = &LIMITS[i];
            const double v = (r[i] - last[i]) / STAGE_PERIOD_S, a = (v - speed[i]) / STAGE_PERIOD_S;
            if (!(fabs(v) <= (1.0 + SLACK) * most->speed)) {
                return refuse(message, size, i, "the speed", fabs(v), "/s", most->speed, "make it slower");
            }
            if (!(fabs(a) <= (1.0 + SLACK) * most->acceleration)) {
                return refuse(message, size, i, "the acceleration", fabs(a), "/s^2", most->acceleration,
                    "make it slower");
            }
            speed[i] = v;
            last[i] = r[i];
        }
    }
    return 0;
}

/* Read names with a number each into a column of the set-points. */
static int fill(char *words[], int count, double column[], char *message, size_t size)
{
    for (int k = 0; k < count; k += 2) {
        const int i = set_point_index(words[k]);
        if (i < 0) {
            (void)snprintf(message, size, "there is no set-point '%.40s': see `names`", words[k]);
            return -1;
        }
        if (k + 1 >= count || parse_number(words[k + 1], &column[i]) != 0) {
            (void)snprintf(message, size, "'%s' needs a finite number after its name", SET_POINTS[i].name);
            return -1;
        }
    }
    return 0;
}

static const struct {
    const char *name;
    kind_t kind;
    int tail, pair; /* numbers after the names; 1 for two axes with a radius each, 2 with a common one */
} KINDS[] = {
    {"step", MOTION_STEP, 0, 0}, {"move", MOTION_MOVE, 0, 0}, {"ramp", MOTION_RAMP, 1, 0}, {"sine", MOTION_SINE, 2, 0},
    {"zigzag", MOTION_ZIGZAG, 2, 0}, {"circle", MOTION_ELLIPSE, 3, 2}, {"ellipse", MOTION_ELLIPSE, 2, 1},
};
enum { N_KINDS = sizeof KINDS / sizeof KINDS[0] };

int motion_parse(char *words[], int count, const double from[], motion_t *motion, char *message, size_t size)
{
    double to[SET_POINTS_SIZE] = {0.0}, tail[3] = {0.0};
    int k = 0;
    while (k < N_KINDS && (count == 0 || strcmp(KINDS[k].name, words[0]) != 0)) k++;
    if (k == N_KINDS) {
        (void)snprintf(message, size, "there is no command '%.40s': see `help`", count ? words[0] : "");
        return -1;
    }
    const int n = KINDS[k].tail, names = count - 1 - n;
    const int transition = KINDS[k].kind <= MOTION_RAMP;
    if (names < (KINDS[k].pair ? 2 : 1)) {
        (void)snprintf(message, size, "'%s' has too few words: see `help`", KINDS[k].name);
        return -1;
    }
    for (int c = 0; c < n; c++) {
        if (parse_number(words[1 + names + c], &tail[c]) != 0 || !(tail[c] > 0.0)) {
            (void)snprintf(message, size, "'%.40s' is not a positive number", words[1 + names + c]);
            return -1;
        }
    }
    *motion = (motion_t){.kind = KINDS[k].kind};
    memcpy(motion->from, from, sizeof motion->from);
    memcpy(to, from, sizeof to);
    if (KINDS[k].pair == 2) {
        const int x = set_point_index(words[1]), y = set_point_index(words[2]);
        if (names != 2 || x < 0 || y < 0 || x == y) {
            (void)snprintf(message, size, "a circle needs two set-points: circle X Y RADIUS HZ CYCLES");
            return -1;
        }
        motion->b[x] = motion->a[y] = tail[0];
    } else {
        if (fill(words + 1, names, transition ? to : motion->a, message, size) != 0) return -1;
        if (KINDS[k].pair == 1) {
            const int x = set_point_index(words[1]);
            if (names != 4 || strcmp(words[1], words[3]) == 0) {
                (void)snprintf(message, size, "an ellipse needs two set-points: ellipse X RX Y RY HZ CYCLES");
                return -1;
            }
            motion->b[x] = motion->a[x];
            motion->a[x] = 0.0;
        }
    }
    if (transition) {
        const motion_t move = motion_move(from, to);
        memcpy(motion->a, move.a, sizeof motion->a);
        motion->duration = (motion->kind == MOTION_STEP) ? SETTLE_S : n ? tail[0] : move.duration;
    } else {
        motion->frequency = tail[n - 2];
        motion->duration = ceil(tail[n - 1]) / motion->frequency;
    }
    if (check_range(motion, message, size) != 0) return -1;
    if (!(motion->frequency * CYCLE * STAGE_PERIOD_S <= 1.0 + SLACK)) {
        (void)snprintf(message, size, "the frequency would be %.6g Hz, at most %.6g Hz is possible, %.0f samples per "
            "cycle: make it slower", motion->frequency, 1.0 / (CYCLE * STAGE_PERIOD_S), CYCLE);
        return -1;
    }
    if (!(motion->duration <= LONGEST_S)) {
        (void)snprintf(message, size, "the motion would take %g s, at most %g s are checked: make it shorter",
            motion->duration, LONGEST_S);
        return -1;
    }
    return (motion->kind == MOTION_STEP) ? 0 : check_samples(motion, message, size);
}
