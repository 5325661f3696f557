/* Functions of the plant in plain arithmetic, within some 1e-16: C libraries differ in their last bits, these are equal
 * on each machine. The Makefile puts them in front of plant_model.c; functions that are not here are the library's. */
#ifndef PLANT_MATH_H
#define PLANT_MATH_H

#include <math.h>

/* Return the polynomial with the coefficients 1, 1 / (a b), 1 / (a b (a + 2) (b + 2)), ... at z. */
static inline double plant_series(double z, int a, int b, int n)
{
    double sum = 1.0;
    for (int k = n - 1; k >= 0; k--) sum = 1.0 + z * sum / ((double)(a + 2 * k) * (double)(b + 2 * k));
    return sum;
}

static inline double plant_exp(double x)
{
    if (!(fabs(x) < 700.0)) return (x < 0.0) ? 0.0 : x * x;
    const double k = rint(x * 1.4426950408889634), r = (x - k * 0x1.62e42fee00000p-1) - k * 0x1.a39ef35793c76p-33;
    double sum = 1.0;
    for (int n = 14; n > 0; n--) sum = 1.0 + r * sum / (double)n;
    return ldexp(sum, (int)k);
}

static inline double plant_log(double x)
{
    int e;
    if (!(x > 0.0 && x < (double)INFINITY)) return log(x);
    double m = frexp(x, &e), sum = 0.0;
    if (m < 0.7071067811865476) {
        m *= 2.0;
        e -= 1;
    }
    const double s = (m - 1.0) / (m + 1.0), z = s * s;
    for (int n = 23; n > 0; n -= 2) sum = sum * z + 1.0 / (double)n;
    return (double)e * 0x1.62e42fee00000p-1 + (2.0 * s * sum + (double)e * 0x1.a39ef35793c76p-33);
}

/* Return sin(x + q pi / 2). */
static inline double plant_turned(double x, int q)
{
    if (!(fabs(x) < 1e5)) return (double)NAN;
    const double n = rint(x * 0.6366197723675814);
    const double r = ((x - n * 0x1.921fb54400000p+0) - n * 0x1.0b4611a600000p-34) - n * 0x1.3198a2e037073p-69;
    const int turn = (int)n + q;
    const double value = (turn & 1) ? plant_series(-r * r, 1, 2, 9) : r * plant_series(-r * r, 2, 3, 9);
    return (turn & 2) ? -value : value;
}

static inline double plant_sin(double x)
{
    return plant_turned(x, 0);
}

static inline double plant_cos(double x)
{
    return plant_turned(x, 1);
}

static inline double plant_atan(double x)
{
    const double a = fabs(x);
    double t = (a > 1.0) ? 1.0 / a : a, sum = 0.0;
    for (int half = 0; half < 2; half++) t = t / (1.0 + sqrt(1.0 + t * t));
    for (int n = 23; n > 0; n -= 2) sum = 1.0 / (double)n - t * t * sum;
    const double angle = (a > 1.0) ? 1.5707963267948966 - 4.0 * t * sum : 4.0 * t * sum;
    return (x < 0.0) ? -angle : angle;
}

static inline double plant_sinh(double x)
{
    if (fabs(x) < 1.0) return x * plant_series(x * x, 2, 3, 10);
    const double e = plant_exp(x);
    return 0.5 * (e - 1.0 / e);
}

static inline double plant_cosh(double x)
{
    const double e = plant_exp(x);
    return 0.5 * (e + 1.0 / e);
}

static inline double plant_tanh(double x)
{
    if (fabs(x) > 20.0) return (x < 0.0) ? -1.0 : 1.0;
    return plant_sinh(x) / plant_cosh(x);
}

#define exp plant_exp
#define log plant_log
#define sin plant_sin
#define cos plant_cos
#define atan plant_atan
#define sinh plant_sinh
#define cosh plant_cosh
#define tanh plant_tanh

#endif
