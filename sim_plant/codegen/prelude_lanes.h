/* LANES lines side by side: one vector of doubles, or of integers, for each number of a line.
   Built several times, with other LANES and other instructions; see setup.py. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__AVX512DQ__) || defined(__AVX2__)
#include <immintrin.h>
#endif

typedef double floats __attribute__((vector_size(8 * LANES), may_alias));
typedef int64_t integers __attribute__((vector_size(8 * LANES), may_alias));
typedef int32_t narrow __attribute__((vector_size(4 * LANES)));

typedef struct { double *at; int64_t n; } float_1;
typedef struct { double *at; int64_t rows, cols; } float_2;
typedef struct { int64_t *at; int64_t n; } int_1;
typedef struct { floats *at; int64_t n; } float_lanes_1;
typedef struct { floats *at; int64_t rows, cols; } float_lanes_2;
typedef struct { floats *at; integers row; int64_t n; } float_lanes_row;

#define EACH static inline __attribute__((always_inline))

EACH floats each_float(double x) { return x - (floats){0}; }
EACH integers each_int(int64_t x) { return x + (integers){0}; }
EACH integers each_bool(bool x) { return (integers){0} - (int64_t)x; }

/* is any lane of a mask at work? */
EACH bool any(integers mask) {
#if defined(__AVX512DQ__) && LANES == 8
    return _mm512_movepi64_mask((__m512i)mask) != 0;
#elif defined(__AVX2__) && LANES == 4
    return _mm256_movemask_pd((__m256d)mask) != 0;
#else
    int64_t found = 0;
    for (int lane = 0; lane < LANES; lane++) found |= mask[lane];
    return found != 0;
#endif
}

/* yes where the mask is set */
EACH integers choose_integers(integers mask, integers yes, integers no) {
    return (mask & yes) | (~mask & no);
}
EACH floats choose_floats(integers mask, floats yes, floats no) {
#if defined(__AVX512DQ__) && LANES == 8
    return (floats)_mm512_mask_blend_pd(_mm512_movepi64_mask((__m512i)mask), (__m512d)no, (__m512d)yes);
#elif defined(__AVX2__) && LANES == 4
    return (floats)_mm256_blendv_pd((__m256d)no, (__m256d)yes, (__m256d)mask);
#else
    return (floats)choose_integers(mask, (integers)yes, (integers)no);
#endif
}

EACH floats floats_of(integers x) { return __builtin_convertvector(x, floats); }
/* towards zero; the kernel's are places in tables and fit 32 bits */
EACH integers integers_of(floats x) {
    return __builtin_convertvector(__builtin_convertvector(x, narrow), integers);
}

/* lines that differ by little are at one place of their tables: no gather then */
EACH floats gather_floats(const floats *at, integers index) {
    const double *first = (const double *)at;
    if (!any((integers)(index != index[0]))) return at[index[0]];
#if defined(__AVX512DQ__) && LANES == 8
    const integers lane = {0, 1, 2, 3, 4, 5, 6, 7};
    return (floats)_mm512_i64gather_pd((__m512i)(index * LANES + lane), first, 8);
#elif defined(__AVX2__) && LANES == 4
    const integers lane = {0, 1, 2, 3};
    return (floats)_mm256_i64gather_pd(first, (__m256i)(index * LANES + lane), 8);
#else
    floats found = {0};
    for (int lane = 0; lane < LANES; lane++) found[lane] = first[index[lane] * LANES + lane];
    return found;
#endif
}
EACH void scatter_floats(integers mask, floats *at, integers index, floats value) {
    double *first = (double *)at;
    for (int lane = 0; lane < LANES; lane++)
        if (mask[lane]) first[index[lane] * LANES + lane] = value[lane];
}

EACH double least_float(double a, double b) { return b < a ? b : a; }
EACH double largest_float(double a, double b) { return b > a ? b : a; }
EACH int64_t least_int(int64_t a, int64_t b) { return b < a ? b : a; }
EACH int64_t largest_int(int64_t a, int64_t b) { return b > a ? b : a; }
EACH floats least_floats(floats a, floats b) { return choose_floats((integers)(b < a), b, a); }
EACH floats largest_floats(floats a, floats b) { return choose_floats((integers)(b > a), b, a); }
EACH integers least_ints(integers a, integers b) { return choose_integers(b < a, b, a); }
EACH integers largest_ints(integers a, integers b) { return choose_integers(b > a, b, a); }
EACH floats absolutes(floats x) { return (floats)((integers)x & INT64_MAX); }
EACH double absolute(double x) { return fabs(x); }
EACH double square(double x) { return x * x; }
EACH floats squares(floats x) { return x * x; }

EACH double plain_sin(double x) { return sin(x); }
EACH double plain_cos(double x) { return cos(x); }
EACH double plain_tanh(double x) { return tanh(x); }
EACH double plain_exp(double x) { return exp(x); }
EACH double plain_floor(double x) { return floor(x) + 0.0; }
EACH int64_t modulo_int(int64_t a, int64_t b) {
    int64_t rest = a % b;
    return (rest != 0 && ((rest < 0) != (b < 0))) ? rest + b : rest;
}
EACH double modulo_float(double a, double b) {
    double rest = fmod(a, b);
    if (rest != 0.0) return ((b < 0.0) != (rest < 0.0)) ? rest + b : rest;
    return copysign(0.0, b);
}
/* rare: lane by lane */
static inline floats far_rests(floats a, floats b) {
    floats found = {0};
    for (int lane = 0; lane < LANES; lane++) found[lane] = modulo_float(a[lane], b[lane]);
    return found;
}
/* What is smaller than its divisor is its own rest, one of the other sign that and the divisor,
   and nothing has the divisor's sign. */
EACH floats modulo_floats(floats a, floats b) {
    if (any(~(integers)(absolutes(a) < absolutes(b)))) return far_rests(a, b);
    integers other = (integers)(((integers)a ^ (integers)b) < 0);
    floats nothing = (floats)((integers)b & INT64_MIN);
    return choose_floats((integers)(a == 0.0), nothing, choose_floats(other, a + b, a));
}

/* the next whole number, ties to even; 1.5 * 2^52 has no room for a fraction */
EACH floats nearest(floats x) {
    const double shift = 6755399441055744.0;
    return (x + shift) - shift;
}
/* what is too large for a fraction of its own is its floor */
EACH floats lanes_floor(floats x) {
    floats near = nearest(x);
    floats below = choose_floats((integers)(near > x), near - 1.0, near);
    return choose_floats((integers)(absolutes(x) < 2251799813685248.0), below, x) + 0.0;
}

/* Sine and cosine: x less a multiple of pi/2, in three parts of 33 bits, so that their products
   with a multiple below 2^20 are exact; then the series, whose next term is below 1e-19. Larger
   angles go to the C library. */
#define REDUCED 1.0e6
#define HALF_PI_1 0x1.921fb54400000p+0
#define HALF_PI_2 0x1.0b4611a600000p-34
#define HALF_PI_3 0x1.3198a2e037073p-69
static inline floats far_angles(integers far, floats x, floats near, bool cosine) {
    for (int lane = 0; lane < LANES; lane++)
        if (far[lane]) near[lane] = cosine ? cos(x[lane]) : sin(x[lane]);
    return near;
}
EACH floats wave(floats x, int64_t quarter, bool cosine) {
    const double shift = 6755399441055744.0;
    floats turned = x * 0.63661977236758134308 + shift;
    integers quarters = (integers)turned + quarter; /* the last bits of the shifted number */
    floats turns = turned - shift;
    floats first = x - turns * HALF_PI_1;
    floats second = first - turns * HALF_PI_2;
    floats rest = ((first - second) - turns * HALF_PI_2) - turns * HALF_PI_3;
    floats r = second + rest;
    rest = (second - r) + rest; /* what r has no room for */
    floats z = r * r;
    floats s = -1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0);
    s = 1.0 / 6227020800.0 + z * s;
    s = -1.0 / 39916800.0 + z * s;
    s = 1.0 / 362880.0 + z * s;
    s = -1.0 / 5040.0 + z * s;
    s = 1.0 / 120.0 + z * s;
    s = -1.0 / 6.0 + z * s;
    s = r + (r * z * s + rest);
    floats c = 1.0 / 20922789888000.0 - z * (1.0 / 6402373705728000.0);
    c = -1.0 / 87178291200.0 + z * c;
    c = 1.0 / 479001600.0 + z * c;
    c = -1.0 / 3628800.0 + z * c;
    c = 1.0 / 40320.0 + z * c;
    c = -1.0 / 720.0 + z * c;
    c = 1.0 / 24.0 + z * c;
    floats half = 0.5 * z;
    floats one = 1.0 - half;
    c = one + ((1.0 - one) - half + (z * z * c - r * rest));
    floats found = choose_floats(-(quarters & 1), c, s);
    found = (floats)((integers)found ^ ((quarters & 2) << 62));
    integers far = (integers)((absolutes(x) >= REDUCED) & (absolutes(x) < INFINITY));
    return any(far) ? far_angles(far, x, found, cosine) : found;
}
EACH floats lanes_sin(floats x) { return wave(x, 0, false); }
EACH floats lanes_cos(floats x) { return wave(x, 1, true); }

#define LN2_1 0x1.62e42fee00000p-1
#define LN2_2 0x1.a39ef35793c76p-33
/* e^x = 2^k e^r, |r| < 0.35, the series of e^r; beyond +-700 the C library */
static inline floats far_powers(integers far, floats x, floats near) {
    for (int lane = 0; lane < LANES; lane++)
        if (far[lane]) near[lane] = exp(x[lane]);
    return near;
}
EACH floats lanes_exp(floats x) {
    const double shift = 6755399441055744.0;
    floats shifted = x * 1.44269504088896340736 + shift;
    floats k = shifted - shift;
    floats r = (x - k * LN2_1) - k * LN2_2;
    floats s = 1.0 / 479001600.0 + r * (1.0 / 6227020800.0);
    s = 1.0 / 39916800.0 + r * s;
    s = 1.0 / 3628800.0 + r * s;
    s = 1.0 / 362880.0 + r * s;
    s = 1.0 / 40320.0 + r * s;
    s = 1.0 / 5040.0 + r * s;
    s = 1.0 / 720.0 + r * s;
    s = 1.0 / 120.0 + r * s;
    s = 1.0 / 24.0 + r * s;
    s = 1.0 / 6.0 + r * s;
    s = 0.5 + r * s;
    s = 1.0 + (r + r * r * s);
    floats found = (floats)((integers)s + ((integers)shifted << 52));
    integers far = (integers)(absolutes(x) >= 700.0);
    return any(far) ? far_powers(far, x, found) : found;
}
/* to 2e-16 of its range: it levels a friction */
EACH floats lanes_tanh(floats x) {
    floats size = absolutes(x);
    size = choose_floats((integers)(size > 20.0), each_float(20.0), size);
    floats found = 1.0 - 2.0 / (lanes_exp(2.0 * size) + 1.0);
    return (floats)((integers)found | ((integers)x & INT64_MIN));
}
