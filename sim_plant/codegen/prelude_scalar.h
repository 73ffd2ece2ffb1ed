#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct { double *at; int64_t n; } float_1;
typedef struct { double *at; int64_t rows, cols; } float_2;
typedef struct { int64_t *at; int64_t n; } int_1;

/* as Python and numba have them: the first of two equals, and the other one beside a NaN */
static inline double least_float(double a, double b) { return b < a ? b : a; }
static inline double largest_float(double a, double b) { return b > a ? b : a; }
static inline int64_t least_int(int64_t a, int64_t b) { return b < a ? b : a; }
static inline int64_t largest_int(int64_t a, int64_t b) { return b > a ? b : a; }
static inline double absolute(double x) { return fabs(x); }
static inline double square(double x) { return x * x; }
static inline double plain_sin(double x) { return sin(x); }
static inline double plain_cos(double x) { return cos(x); }
static inline double plain_tanh(double x) { return tanh(x); }
static inline double plain_exp(double x) { return exp(x); }
/* the integer below; never -0.0, which no integer is */
static inline double plain_floor(double x) { return floor(x) + 0.0; }

/* the remainder with the sign of the divisor */
static inline double modulo_float(double a, double b) {
    double rest = fmod(a, b);
    if (rest != 0.0) return ((b < 0.0) != (rest < 0.0)) ? rest + b : rest;
    return copysign(0.0, b);
}
static inline int64_t modulo_int(int64_t a, int64_t b) {
    int64_t rest = a % b;
    return (rest != 0 && ((rest < 0) != (b < 0))) ? rest + b : rest;
}
