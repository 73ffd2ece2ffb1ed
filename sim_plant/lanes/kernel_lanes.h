/* Made from the compiled functions of sim_plant by sim_plant.codegen; not by hand. */

#define SOURCE "ab554082708e9501" /* of the files it was made from */

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

typedef struct {
    int64_t kind[LANES];
    integers shape_row;
    int64_t carriage[LANES];
    floats sigma;
    floats centre_x_m;
    floats centre_y_m;
    floats radius_m;
    floats inertia_kg_m2;
    floats friction_constant_N_m;
    floats friction_viscous_N_m_s;
    floats gravity_moment_N_m;
    floats gravity_moment_angle_rad;
    floats slip_s_m;
    floats slip_speed_m_s;
} BODY;

typedef struct { BODY *at; int64_t n; } BODY_array;

typedef struct { BODY *at; integers index; } BODY_each;

typedef struct {
    int64_t heat_first[LANES];
    int64_t heat_parts[LANES];
    floats EA_N;
    floats free_strain;
} SPAN;

typedef struct { SPAN *at; int64_t n; } SPAN_array;

typedef struct { SPAN *at; integers index; } SPAN_each;

typedef struct {
    floats viscosity_s;
    floats maxwell_ratio;
    floats maxwell_time_s;
    floats density_kg_m3;
    floats thickness_m;
    floats width_m;
    floats supply_strain;
    floats core_radius_m;
    floats bounce_mass_kg;
    floats bounce_Hz;
    floats bounce_damping;
    floats bounce_order;
    floats bounce_cos1_kg_m;
    floats bounce_sin1_kg_m;
    floats bounce_cosn_kg_m;
    floats bounce_sinn_kg_m;
    floats splice_m;
    floats splice_EA_ratio;
    floats splice_thickness_ratio;
    floats splice_step_m;
    floats splice_piece_m;
    floats expansion_1_K;
} WEB;

typedef struct { WEB *at; int64_t n; } WEB_array;

typedef struct { WEB *at; integers index; } WEB_each;

typedef struct {
    int64_t body[LANES];
    integers delay_ticks;
    int64_t loop[LANES];
    floats gain_rad_s;
    floats damping;
    floats draw;
    floats radius_ratio;
    floats limit_N_m;
    floats slew_m_s2;
    floats correction_slew_m_s2;
    floats shaft_stiffness_N_m;
    floats shaft_damping_N_m_s;
    floats shaft_backlash_rad;
    floats motor_share;
    floats encoder_offset_ratio;
    floats encoder_angle_rad;
    floats encoder_loop_share;
    floats noise_rad_s;
    floats lsb_rad_s;
} DRIVE;

typedef struct { DRIVE *at; int64_t n; } DRIVE_array;

typedef struct { DRIVE *at; integers index; } DRIVE_each;

typedef struct {
    int64_t body[LANES];
    floats corner_Hz;
    floats gain;
    floats offset_N;
    floats noise_N;
    floats lsb_N;
    floats resonance_Hz;
    floats resonance_damping;
    floats unbalance_kg_m;
    floats unbalance_angle_rad;
    floats hum_N;
    floats hum_Hz;
    floats hum_phase_rad;
} CELL;

typedef struct { CELL *at; int64_t n; } CELL_array;

typedef struct { CELL *at; integers index; } CELL_each;

typedef struct {
    int64_t cell[LANES];
    int64_t carriage[LANES];
    floats gain_m_s_N;
    floats corner_rad_s;
    floats sign;
    floats reference_m;
    floats slew_m_s2;
} LOOP;

typedef struct { LOOP *at; int64_t n; } LOOP_array;

typedef struct { LOOP *at; integers index; } LOOP_each;

typedef struct {
    integers drive;
    floats order;
    floats cos_N_m;
    floats sin_N_m;
} RIPPLE;

typedef struct { RIPPLE *at; int64_t n; } RIPPLE_array;

typedef struct { RIPPLE *at; integers index; } RIPPLE_each;

typedef struct {
    integers target;
    integers place;
    floats amount;
    floats from_s;
    floats rise_s;
    floats until_s;
    floats put;
} CHANGE;

typedef struct { CHANGE *at; int64_t n; } CHANGE_array;

typedef struct { CHANGE *at; integers index; } CHANGE_each;

typedef struct {
    int64_t ticks_per_frame[LANES];
    int64_t frames_per_loop[LANES];
    int64_t substeps[LANES];
    int64_t noisy[LANES];
    double drive_tick_s[LANES];
} TIMING;

typedef struct { TIMING *at; int64_t n; } TIMING_array;

typedef struct { TIMING *at; integers index; } TIMING_each;

typedef struct {
    floats air_K;
    floats time_s;
} HEAT;

typedef struct { HEAT *at; int64_t n; } HEAT_array;

typedef struct { HEAT *at; integers index; } HEAT_each;

typedef struct {
    int64_t pendulum[LANES];
    floats axis_x;
    floats axis_y;
    floats pivot_x_m;
    floats pivot_y_m;
    floats turn_1_m;
    floats mass_kg;
    floats load_N;
    floats weight_N;
    floats weight_x_m;
    floats weight_y_m;
    floats stiffness_N_m;
    floats damping_N_s_m;
    floats friction_N;
    floats from_m;
    floats to_m;
    floats gain_rad_s;
    floats drive_damping;
    floats limit_N;
    floats speed_m_s;
} CARRIAGE;

typedef struct { CARRIAGE *at; int64_t n; } CARRIAGE_array;

typedef struct { CARRIAGE *at; integers index; } CARRIAGE_each;

typedef struct {
    BODY_array bodies;
    SPAN_array spans;
    WEB_array web;
    DRIVE_array drives;
    CELL_array cells;
    LOOP_array loops;
    RIPPLE_array ripples;
    CHANGE_array changes;
    HEAT_array heats;
    CARRIAGE_array carriages;
    TIMING_array timing;
    float_lanes_2 shape_h_m;
    float_lanes_2 shape_dh_m;
    float_lanes_2 shape_rho_m;
} LineArrays;

typedef struct {
    float_lanes_1 y;
    float_lanes_1 phi_rad;
    float_lanes_1 drive_integral;
    float_lanes_1 torque_N_m;
    float_lanes_1 reference_m_s;
    float_lanes_1 correction_m_s;
    float_lanes_1 loop_integral;
    float_lanes_1 loop_correction_m_s;
    float_lanes_1 measured_N;
    float_lanes_1 true_N;
    float_lanes_1 measured_rad_s;
    float_lanes_1 carriage_integral_m;
    float_lanes_1 carriage_force_N;
    float_lanes_2 delay_m_s;
    int_1 counters;
    float_1 time_s;
} LineState;

typedef struct {
    float_lanes_1 moving;
    float_lanes_2 contacts;
    float_lanes_1 tensions;
    float_lanes_2 rates;
    float_lanes_1 trial;
} Work;

typedef struct {
    int64_t n;
    int64_t theta;
    int64_t omega;
    int64_t strain;
    int64_t radius;
    int64_t flow;
    int64_t cell;
    int64_t resonance;
    int64_t twist;
    int64_t motor;
    int64_t maxwell;
    int64_t bounce;
    int64_t carriage;
    int64_t heat;
    int64_t size;
} Layout;

typedef struct {
    int64_t measured_N;
    int64_t true_N;
    int64_t mean_N;
    int64_t measured_rad_s;
    int64_t true_rad_s;
    int64_t theta_rad;
    int64_t radius_m;
    int64_t tension_N;
    int64_t travel_m;
    int64_t encoder_rad;
    int64_t width;
} LogLayout;

typedef struct { floats part0; floats part1; } group_FF;

typedef struct { floats part0; floats part1; floats part2; } group_FFF;

typedef struct { floats part0; floats part1; floats part2; floats part3; } group_FFFF;

typedef struct { floats part0; floats part1; double part2; double part3; } group_FFff;

typedef struct { floats part0; double part1; floats part2; } group_FfF;

static inline floats k_level(double time_s, floats from_s, floats rise_s, floats until_s) {
    floats risen = {0};
    integers returned_ = each_bool(false);
    floats result_ = {0};
    const integers t1_ = ((integers)(each_float(time_s) < from_s));
    const integers on2_ = t1_;
    if (any(on2_)) {
        result_ = choose_floats(on2_, each_float(0.0), result_);
        returned_ |= on2_;
    }
    const integers on3_ = ~returned_;
    if (any(on3_)) {
        risen = choose_floats(((integers)(rise_s <= each_float(0.0))), each_float(1.0), least_floats(each_float(1.0), ((time_s - from_s) / rise_s)));
        const integers t4_ = ((integers)(each_float(time_s) < until_s));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            result_ = choose_floats(on5_, risen, result_);
            returned_ |= on5_;
        }
        const integers on6_ = on3_ & ~returned_;
        if (any(on6_)) {
            result_ = choose_floats(on6_, choose_floats(((integers)(rise_s <= each_float(0.0))), each_float(0.0), largest_floats(each_float(0.0), (risen - ((time_s - until_s) / rise_s)))), result_);
            returned_ |= on6_;
        }
    }
    return result_;
}

static inline void k_of_bodies(const LineArrays * p, integers target, integers place, floats more, const integers lanes_) {
    const integers t1_ = ((integers)(target == each_int(INT64_C(0))));
    const integers on2_ = lanes_ & t1_;
    if (any(on2_)) {
        scatter_floats(on2_, &((BODY_each){p->bodies.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->friction_constant_N_m, ((BODY_each){p->bodies.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(BODY) / sizeof(floats)), (gather_floats(&((BODY_each){p->bodies.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->friction_constant_N_m, ((BODY_each){p->bodies.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(BODY) / sizeof(floats))) + more));
    }
    const integers on3_ = lanes_ & ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(target == each_int(INT64_C(1))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            scatter_floats(on5_, &((BODY_each){p->bodies.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->slip_s_m, ((BODY_each){p->bodies.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(BODY) / sizeof(floats)), (gather_floats(&((BODY_each){p->bodies.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->slip_s_m, ((BODY_each){p->bodies.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(BODY) / sizeof(floats))) + more));
        }
        const integers on6_ = on3_ & ~t4_;
        if (any(on6_)) {
            const integers t7_ = ((integers)(target == each_int(INT64_C(2))));
            const integers on8_ = on6_ & t7_;
            if (any(on8_)) {
                scatter_floats(on8_, &((BODY_each){p->bodies.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->inertia_kg_m2, ((BODY_each){p->bodies.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(BODY) / sizeof(floats)), (gather_floats(&((BODY_each){p->bodies.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->inertia_kg_m2, ((BODY_each){p->bodies.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(BODY) / sizeof(floats))) + more));
            }
        }
    }
}

static inline void k_of_spans(const LineArrays * p, integers target, integers place, floats more, const integers lanes_) {
    const integers t1_ = ((integers)(target == each_int(INT64_C(3))));
    const integers on2_ = lanes_ & t1_;
    if (any(on2_)) {
        scatter_floats(on2_, &((SPAN_each){p->spans.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->free_strain, ((SPAN_each){p->spans.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(SPAN) / sizeof(floats)), (gather_floats(&((SPAN_each){p->spans.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->free_strain, ((SPAN_each){p->spans.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(SPAN) / sizeof(floats))) + more));
    }
    const integers on3_ = lanes_ & ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(target == each_int(INT64_C(4))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            scatter_floats(on5_, &((SPAN_each){p->spans.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->EA_N, ((SPAN_each){p->spans.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(SPAN) / sizeof(floats)), (gather_floats(&((SPAN_each){p->spans.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->EA_N, ((SPAN_each){p->spans.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(SPAN) / sizeof(floats))) + more));
        }
    }
}

static inline void k_of_web(const LineArrays * p, integers target, floats more, const integers lanes_) {
    const integers t1_ = ((integers)(target == each_int(INT64_C(5))));
    const integers on2_ = lanes_ & t1_;
    if (any(on2_)) {
        (&p->web.at[INT64_C(0)])->viscosity_s = choose_floats(on2_, ((&p->web.at[INT64_C(0)])->viscosity_s + more), (&p->web.at[INT64_C(0)])->viscosity_s);
    }
    const integers on3_ = lanes_ & ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(target == each_int(INT64_C(6))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            (&p->web.at[INT64_C(0)])->density_kg_m3 = choose_floats(on5_, ((&p->web.at[INT64_C(0)])->density_kg_m3 + more), (&p->web.at[INT64_C(0)])->density_kg_m3);
        }
        const integers on6_ = on3_ & ~t4_;
        if (any(on6_)) {
            const integers t7_ = ((integers)(target == each_int(INT64_C(7))));
            const integers on8_ = on6_ & t7_;
            if (any(on8_)) {
                (&p->web.at[INT64_C(0)])->thickness_m = choose_floats(on8_, ((&p->web.at[INT64_C(0)])->thickness_m + more), (&p->web.at[INT64_C(0)])->thickness_m);
            }
            const integers on9_ = on6_ & ~t7_;
            if (any(on9_)) {
                const integers t10_ = ((integers)(target == each_int(INT64_C(8))));
                const integers on11_ = on9_ & t10_;
                if (any(on11_)) {
                    (&p->web.at[INT64_C(0)])->supply_strain = choose_floats(on11_, ((&p->web.at[INT64_C(0)])->supply_strain + more), (&p->web.at[INT64_C(0)])->supply_strain);
                }
                const integers on12_ = on9_ & ~t10_;
                if (any(on12_)) {
                    const integers t13_ = ((integers)(target == each_int(INT64_C(9))));
                    const integers on14_ = on12_ & t13_;
                    if (any(on14_)) {
                        (&p->web.at[INT64_C(0)])->expansion_1_K = choose_floats(on14_, ((&p->web.at[INT64_C(0)])->expansion_1_K + more), (&p->web.at[INT64_C(0)])->expansion_1_K);
                    }
                }
            }
        }
    }
}

static inline void k_of_drives(const LineArrays * p, integers target, integers place, floats more, const integers lanes_) {
    const integers t1_ = ((integers)(target == each_int(INT64_C(10))));
    const integers on2_ = lanes_ & t1_;
    if (any(on2_)) {
        scatter_floats(on2_, &((DRIVE_each){p->drives.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->gain_rad_s, ((DRIVE_each){p->drives.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(DRIVE) / sizeof(floats)), (gather_floats(&((DRIVE_each){p->drives.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->gain_rad_s, ((DRIVE_each){p->drives.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(DRIVE) / sizeof(floats))) + more));
    }
    const integers on3_ = lanes_ & ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(target == each_int(INT64_C(11))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            scatter_floats(on5_, &((DRIVE_each){p->drives.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->damping, ((DRIVE_each){p->drives.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(DRIVE) / sizeof(floats)), (gather_floats(&((DRIVE_each){p->drives.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->damping, ((DRIVE_each){p->drives.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(DRIVE) / sizeof(floats))) + more));
        }
        const integers on6_ = on3_ & ~t4_;
        if (any(on6_)) {
            const integers t7_ = ((integers)(target == each_int(INT64_C(12))));
            const integers on8_ = on6_ & t7_;
            if (any(on8_)) {
                scatter_floats(on8_, &((DRIVE_each){p->drives.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->draw, ((DRIVE_each){p->drives.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(DRIVE) / sizeof(floats)), (gather_floats(&((DRIVE_each){p->drives.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->draw, ((DRIVE_each){p->drives.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(DRIVE) / sizeof(floats))) + more));
            }
        }
    }
}

static inline void k_of_cells(const LineArrays * p, integers target, integers place, floats more, const integers lanes_) {
    const integers t1_ = ((integers)(target == each_int(INT64_C(13))));
    const integers on2_ = lanes_ & t1_;
    if (any(on2_)) {
        scatter_floats(on2_, &((CELL_each){p->cells.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->corner_Hz, ((CELL_each){p->cells.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CELL) / sizeof(floats)), (gather_floats(&((CELL_each){p->cells.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->corner_Hz, ((CELL_each){p->cells.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CELL) / sizeof(floats))) + more));
    }
    const integers on3_ = lanes_ & ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(target == each_int(INT64_C(14))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            scatter_floats(on5_, &((CELL_each){p->cells.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->gain, ((CELL_each){p->cells.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CELL) / sizeof(floats)), (gather_floats(&((CELL_each){p->cells.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->gain, ((CELL_each){p->cells.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CELL) / sizeof(floats))) + more));
        }
        const integers on6_ = on3_ & ~t4_;
        if (any(on6_)) {
            const integers t7_ = ((integers)(target == each_int(INT64_C(15))));
            const integers on8_ = on6_ & t7_;
            if (any(on8_)) {
                scatter_floats(on8_, &((CELL_each){p->cells.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->offset_N, ((CELL_each){p->cells.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CELL) / sizeof(floats)), (gather_floats(&((CELL_each){p->cells.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->offset_N, ((CELL_each){p->cells.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CELL) / sizeof(floats))) + more));
            }
        }
    }
}

static inline void k_of_loops(const LineArrays * p, integers target, integers place, floats more, const integers lanes_) {
    const integers t1_ = ((integers)(target == each_int(INT64_C(16))));
    const integers on2_ = lanes_ & t1_;
    if (any(on2_)) {
        scatter_floats(on2_, &((LOOP_each){p->loops.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->gain_m_s_N, ((LOOP_each){p->loops.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(LOOP) / sizeof(floats)), (gather_floats(&((LOOP_each){p->loops.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->gain_m_s_N, ((LOOP_each){p->loops.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(LOOP) / sizeof(floats))) + more));
    }
    const integers on3_ = lanes_ & ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(target == each_int(INT64_C(17))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            scatter_floats(on5_, &((LOOP_each){p->loops.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->corner_rad_s, ((LOOP_each){p->loops.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(LOOP) / sizeof(floats)), (gather_floats(&((LOOP_each){p->loops.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->corner_rad_s, ((LOOP_each){p->loops.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(LOOP) / sizeof(floats))) + more));
        }
        const integers on6_ = on3_ & ~t4_;
        if (any(on6_)) {
            const integers t7_ = ((integers)(target == each_int(INT64_C(18))));
            const integers on8_ = on6_ & t7_;
            if (any(on8_)) {
                scatter_floats(on8_, &((LOOP_each){p->loops.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->reference_m, ((LOOP_each){p->loops.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(LOOP) / sizeof(floats)), (gather_floats(&((LOOP_each){p->loops.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->reference_m, ((LOOP_each){p->loops.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(LOOP) / sizeof(floats))) + more));
            }
        }
    }
}

static inline void k_of_heats(const LineArrays * p, integers target, integers place, floats more, const integers lanes_) {
    const integers t1_ = ((integers)(target == each_int(INT64_C(19))));
    const integers on2_ = lanes_ & t1_;
    if (any(on2_)) {
        scatter_floats(on2_, &((HEAT_each){p->heats.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->air_K, ((HEAT_each){p->heats.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(HEAT) / sizeof(floats)), (gather_floats(&((HEAT_each){p->heats.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->air_K, ((HEAT_each){p->heats.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(HEAT) / sizeof(floats))) + more));
    }
    const integers on3_ = lanes_ & ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(target == each_int(INT64_C(20))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            scatter_floats(on5_, &((HEAT_each){p->heats.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->time_s, ((HEAT_each){p->heats.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(HEAT) / sizeof(floats)), (gather_floats(&((HEAT_each){p->heats.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->time_s, ((HEAT_each){p->heats.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(HEAT) / sizeof(floats))) + more));
        }
    }
}

static inline void k_of_carriages(const LineArrays * p, integers target, integers place, floats more, const integers lanes_) {
    const integers t1_ = ((integers)(target == each_int(INT64_C(21))));
    const integers on2_ = lanes_ & t1_;
    if (any(on2_)) {
        scatter_floats(on2_, &((CARRIAGE_each){p->carriages.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->speed_m_s, ((CARRIAGE_each){p->carriages.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats)), (gather_floats(&((CARRIAGE_each){p->carriages.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).at->speed_m_s, ((CARRIAGE_each){p->carriages.at, choose_integers(on2_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats))) + more));
    }
    const integers on3_ = lanes_ & ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(target == each_int(INT64_C(22))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            scatter_floats(on5_, &((CARRIAGE_each){p->carriages.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->mass_kg, ((CARRIAGE_each){p->carriages.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats)), (gather_floats(&((CARRIAGE_each){p->carriages.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).at->mass_kg, ((CARRIAGE_each){p->carriages.at, choose_integers(on5_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats))) + more));
        }
        const integers on6_ = on3_ & ~t4_;
        if (any(on6_)) {
            const integers t7_ = ((integers)(target == each_int(INT64_C(23))));
            const integers on8_ = on6_ & t7_;
            if (any(on8_)) {
                scatter_floats(on8_, &((CARRIAGE_each){p->carriages.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->load_N, ((CARRIAGE_each){p->carriages.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats)), (gather_floats(&((CARRIAGE_each){p->carriages.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).at->load_N, ((CARRIAGE_each){p->carriages.at, choose_integers(on8_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats))) + more));
            }
            const integers on9_ = on6_ & ~t7_;
            if (any(on9_)) {
                const integers t10_ = ((integers)(target == each_int(INT64_C(24))));
                const integers on11_ = on9_ & t10_;
                if (any(on11_)) {
                    scatter_floats(on11_, &((CARRIAGE_each){p->carriages.at, choose_integers(on11_, place, each_int(INT64_C(0)))}).at->stiffness_N_m, ((CARRIAGE_each){p->carriages.at, choose_integers(on11_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats)), (gather_floats(&((CARRIAGE_each){p->carriages.at, choose_integers(on11_, place, each_int(INT64_C(0)))}).at->stiffness_N_m, ((CARRIAGE_each){p->carriages.at, choose_integers(on11_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats))) + more));
                }
                const integers on12_ = on9_ & ~t10_;
                if (any(on12_)) {
                    const integers t13_ = ((integers)(target == each_int(INT64_C(25))));
                    const integers on14_ = on12_ & t13_;
                    if (any(on14_)) {
                        scatter_floats(on14_, &((CARRIAGE_each){p->carriages.at, choose_integers(on14_, place, each_int(INT64_C(0)))}).at->damping_N_s_m, ((CARRIAGE_each){p->carriages.at, choose_integers(on14_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats)), (gather_floats(&((CARRIAGE_each){p->carriages.at, choose_integers(on14_, place, each_int(INT64_C(0)))}).at->damping_N_s_m, ((CARRIAGE_each){p->carriages.at, choose_integers(on14_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats))) + more));
                    }
                    const integers on15_ = on12_ & ~t13_;
                    if (any(on15_)) {
                        const integers t16_ = ((integers)(target == each_int(INT64_C(26))));
                        const integers on17_ = on15_ & t16_;
                        if (any(on17_)) {
                            scatter_floats(on17_, &((CARRIAGE_each){p->carriages.at, choose_integers(on17_, place, each_int(INT64_C(0)))}).at->friction_N, ((CARRIAGE_each){p->carriages.at, choose_integers(on17_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats)), (gather_floats(&((CARRIAGE_each){p->carriages.at, choose_integers(on17_, place, each_int(INT64_C(0)))}).at->friction_N, ((CARRIAGE_each){p->carriages.at, choose_integers(on17_, place, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(CARRIAGE) / sizeof(floats))) + more));
                        }
                    }
                }
            }
        }
    }
}

static inline void k_keep_changes(const LineArrays * p, double time_s) {
    CHANGE * change = {0};
    floats now = {0};
    floats more = {0};
    const int64_t t1_ = p->changes.n;
    integers broken23_ = each_bool(false);
    for (int64_t e = 0; e < t1_; e++) {
        integers skipped23_ = each_bool(false);
        const integers on2_ = ~broken23_ & ~skipped23_;
        if (!any(on2_)) break;
        change = (&p->changes.at[e]);
        now = choose_floats(on2_, (change->amount * k_level(time_s, change->from_s, change->rise_s, change->until_s)), now);
        more = choose_floats(on2_, (now - change->put), more);
        const integers t3_ = ((integers)(more == each_float(0.0)));
        const integers on4_ = on2_ & t3_;
        if (any(on4_)) {
            skipped23_ |= on4_;
        }
        const integers on5_ = on2_ & ~broken23_ & ~skipped23_;
        if (any(on5_)) {
            change->put = choose_floats(on5_, now, change->put);
            k_of_bodies(p, change->target, change->place, more, on5_);
            k_of_spans(p, change->target, change->place, more, on5_);
            k_of_web(p, change->target, more, on5_);
            k_of_drives(p, change->target, change->place, more, on5_);
            k_of_cells(p, change->target, change->place, more, on5_);
            k_of_loops(p, change->target, change->place, more, on5_);
            k_of_heats(p, change->target, change->place, more, on5_);
            k_of_carriages(p, change->target, change->place, more, on5_);
        }
    }
}

static inline group_FF k_tension_pi(floats gain_m_s_N, floats corner_rad_s, floats sign, floats error_N, floats integral_N_s, double period_s) {
    floats grown = {0};
    grown = (integral_N_s + (period_s * error_N));
    const group_FF t1_ = (group_FF){((sign * gain_m_s_N) * (error_N + (corner_rad_s * grown))), grown};
    return t1_;
}

static inline floats k_ramped(floats wanted, floats last, floats step) {
    return choose_floats(((integers)(step > each_float(0.0))), least_floats(largest_floats(wanted, (last - step)), (last + step)), wanted);
}

static inline void k_run_loops(const LineArrays * p, const Layout * lay, const LineState * s, float_1 tension_ref_N, double period_s) {
    LOOP * law = {0};
    floats error = {0};
    floats correction = {0};
    floats integral = {0};
    floats last = {0};
    const int64_t t1_ = p->loops.n;
    for (int64_t loop = 0; loop < t1_; loop++) {
        law = (&p->loops.at[loop]);
        if ((law->carriage[0] >= INT64_C(0))) {
            error = (law->reference_m - s->y.at[(lay->carriage + (INT64_C(2) * law->carriage[0]))]);
        } else {
            error = (tension_ref_N.at[loop] - s->measured_N.at[law->cell[0]]);
        }
        const group_FF t2_ = k_tension_pi(law->gain_m_s_N, law->corner_rad_s, law->sign, error, s->loop_integral.at[loop], period_s);
        correction = t2_.part0;
        integral = t2_.part1;
        last = s->loop_correction_m_s.at[loop];
        s->loop_correction_m_s.at[loop] = k_ramped(correction, last, (law->slew_m_s2 * period_s));
        s->loop_integral.at[loop] = integral;
    }
}

static inline floats k_drive_reference(const LineArrays * p, const LineState * s, int64_t d, double line_speed_m_s, double aff_m_s) {
    DRIVE * drive = {0};
    floats correction = {0};
    int64_t ring = 0;
    int64_t at = 0;
    integers past = {0};
    floats delayed = {0};
    double tick_s = 0;
    floats reached = {0};
    floats wanted = {0};
    drive = (&p->drives.at[d]);
    correction = each_float(aff_m_s);
    if ((drive->loop[0] >= INT64_C(0))) {
        correction = (correction + s->loop_correction_m_s.at[drive->loop[0]]);
    }
    ring = s->delay_m_s.cols;
    at = s->counters.at[INT64_C(1)];
    s->delay_m_s.at[d * s->delay_m_s.cols + at] = correction;
    past = (at - drive->delay_ticks);
    delayed = gather_floats(s->delay_m_s.at, d * s->delay_m_s.cols + choose_integers(((integers)(past >= each_int(INT64_C(0)))), past, (past + ring)));
    tick_s = (&p->timing.at[INT64_C(0)])->drive_tick_s[0];
    reached = k_ramped(delayed, s->correction_m_s.at[d], (drive->correction_slew_m_s2 * tick_s));
    s->correction_m_s.at[d] = reached;
    wanted = ((line_speed_m_s * (1.0 + drive->draw)) + reached);
    s->reference_m_s.at[d] = k_ramped(wanted, s->reference_m_s.at[d], (drive->slew_m_s2 * tick_s));
    return s->reference_m_s.at[d];
}

static inline floats k_mean_radius(const Layout * lay, float_lanes_1 y, int64_t kind, floats fixed_m) {
    if ((kind == INT64_C(2))) {
        return y.at[lay->radius];
    }
    if ((kind == INT64_C(3))) {
        return y.at[(lay->radius + INT64_C(1))];
    }
    return fixed_m;
}

static inline floats k_wound_inertia(floats density_kg_m3, floats width_m, floats radius_m, floats core_radius_m) {
    return ((((0.5 * 3.141592653589793) * density_kg_m3) * width_m) * (squares(squares(radius_m)) - squares(squares(core_radius_m))));
}

static inline floats k_roll_inertia(const LineArrays * p, floats fixed_kg_m2, floats radius_m) {
    WEB * web = {0};
    web = (&p->web.at[INT64_C(0)]);
    return (fixed_kg_m2 + k_wound_inertia(web->density_kg_m3, web->width_m, radius_m, web->core_radius_m));
}

static inline floats k_encoder_speed(const LineArrays * p, const Layout * lay, const LineState * s, int64_t d, floats share) {
    DRIVE * drive = {0};
    int64_t k = 0;
    integers stiff = {0};
    floats omega = {0};
    floats eccentricity = {0};
    floats turn = {0};
    drive = (&p->drives.at[d]);
    k = drive->body[0];
    stiff = ((integers)(drive->shaft_stiffness_N_m == each_float(0.0)));
    omega = choose_floats(stiff, s->y.at[(lay->omega + k)], s->y.at[(lay->motor + d)]);
    eccentricity = (share * drive->encoder_offset_ratio);
    const integers t1_ = ((integers)(eccentricity != each_float(0.0)));
    const integers on2_ = t1_;
    if (any(on2_)) {
        turn = ((s->y.at[(lay->theta + k)] + s->y.at[(lay->twist + d)]) + drive->encoder_angle_rad);
        omega = choose_floats(on2_, (omega * (1.0 + (eccentricity * lanes_cos(turn)))), omega);
    }
    return omega;
}

static inline floats k_expected_quantise(floats value, floats lsb, floats noise_sd) {
    floats turn = {0};
    floats smooth = {0};
    floats first = {0};
    floats second = {0};
    integers returned_ = each_bool(false);
    floats result_ = {0};
    const integers t1_ = ((integers)(lsb == each_float(0.0)));
    const integers on2_ = t1_;
    if (any(on2_)) {
        result_ = choose_floats(on2_, value, result_);
        returned_ |= on2_;
    }
    const integers on3_ = ~returned_;
    if (any(on3_)) {
        turn = (((2.0 * 3.141592653589793) * value) / lsb);
        smooth = (2.0 * squares(((3.141592653589793 * noise_sd) / lsb)));
        first = ((-lanes_exp((-smooth))) * lanes_sin(turn));
        second = ((0.5 * lanes_exp(((-4.0) * smooth))) * lanes_sin((2.0 * turn)));
        result_ = choose_floats(on3_, (value + ((lsb * (1.0 / 3.141592653589793)) * (first + second))), result_);
        returned_ |= on3_;
    }
    return result_;
}

static inline floats k_quantise(floats value, floats lsb) {
    integers returned_ = each_bool(false);
    floats result_ = {0};
    const integers t1_ = ((integers)(lsb == each_float(0.0)));
    const integers on2_ = t1_;
    if (any(on2_)) {
        result_ = choose_floats(on2_, value, result_);
        returned_ |= on2_;
    }
    const integers on3_ = ~returned_;
    if (any(on3_)) {
        result_ = choose_floats(on3_, (lsb * lanes_floor(((value / lsb) + 0.5))), result_);
        returned_ |= on3_;
    }
    return result_;
}

static inline floats k_drive_speed(const LineArrays * p, const Layout * lay, const LineState * s, int64_t d, floats noise) {
    DRIVE * drive = {0};
    floats omega = {0};
    drive = (&p->drives.at[d]);
    omega = k_encoder_speed(p, lay, s, d, drive->encoder_loop_share);
    if (((&p->timing.at[INT64_C(0)])->noisy[0] == INT64_C(0))) {
        return k_expected_quantise(omega, drive->lsb_rad_s, drive->noise_rad_s);
    }
    return k_quantise((omega + (drive->noise_rad_s * noise)), drive->lsb_rad_s);
}

static inline group_FF k_speed_pi(floats inertia_kg_m2, floats gain_rad_s, floats damping, floats error_rad_s, floats integral_rad, double tick_s, floats limit_N_m) {
    floats corner = {0};
    floats grown = {0};
    floats torque = {0};
    integers returned_ = each_bool(false);
    group_FF result_ = {0};
    corner = (gain_rad_s / ((4.0 * damping) * damping));
    grown = (integral_rad + (tick_s * error_rad_s));
    torque = ((inertia_kg_m2 * gain_rad_s) * (error_rad_s + (corner * grown)));
    const integers t1_ = ((integers)(torque > limit_N_m));
    const integers on2_ = t1_;
    if (any(on2_)) {
        const group_FF t3_ = (group_FF){limit_N_m, integral_rad};
        result_.part0 = choose_floats(on2_, t3_.part0, result_.part0);
        result_.part1 = choose_floats(on2_, t3_.part1, result_.part1);
        returned_ |= on2_;
    }
    const integers on4_ = ~returned_;
    if (any(on4_)) {
        const integers t5_ = ((integers)(torque < (-limit_N_m)));
        const integers on6_ = on4_ & t5_;
        if (any(on6_)) {
            const group_FF t7_ = (group_FF){(-limit_N_m), integral_rad};
            result_.part0 = choose_floats(on6_, t7_.part0, result_.part0);
            result_.part1 = choose_floats(on6_, t7_.part1, result_.part1);
            returned_ |= on6_;
        }
        const integers on8_ = on4_ & ~returned_;
        if (any(on8_)) {
            const group_FF t9_ = (group_FF){torque, grown};
            result_.part0 = choose_floats(on8_, t9_.part0, result_.part0);
            result_.part1 = choose_floats(on8_, t9_.part1, result_.part1);
            returned_ |= on8_;
        }
    }
    return result_;
}

static inline void k_run_drives(const LineArrays * p, const Layout * lay, const LineState * s, double line_speed_m_s, float_1 aff_m_s, float_lanes_1 noise) {
    bool torques = 0;
    double tick_s = 0;
    DRIVE * drive = {0};
    BODY * body = {0};
    floats reference = {0};
    floats radius = {0};
    floats inertia = {0};
    floats error = {0};
    floats torque = {0};
    floats integral = {0};
    torques = (aff_m_s.n > p->drives.n);
    tick_s = (&p->timing.at[INT64_C(0)])->drive_tick_s[0];
    const int64_t t1_ = p->drives.n;
    for (int64_t d = 0; d < t1_; d++) {
        drive = (&p->drives.at[d]);
        body = (&p->bodies.at[drive->body[0]]);
        const floats t2_ = k_drive_reference(p, s, d, line_speed_m_s, aff_m_s.at[d]);
        reference = t2_;
        radius = (k_mean_radius(lay, s->y, body->kind[0], body->radius_m) * drive->radius_ratio);
        inertia = body->inertia_kg_m2;
        if ((body->kind[0] >= INT64_C(2))) {
            inertia = k_roll_inertia(p, inertia, radius);
        }
        error = ((reference / radius) - k_drive_speed(p, lay, s, d, noise.at[d]));
        const group_FF t3_ = k_speed_pi(inertia, drive->gain_rad_s, drive->damping, error, s->drive_integral.at[d], tick_s, drive->limit_N_m);
        torque = t3_.part0;
        integral = t3_.part1;
        if (torques) {
            torque = (torque + aff_m_s.at[(p->drives.n + d)]);
            torque = least_floats(largest_floats(torque, (-drive->limit_N_m)), drive->limit_N_m);
        }
        s->torque_N_m.at[d] = torque;
        s->drive_integral.at[d] = integral;
    }
    s->counters.at[INT64_C(1)] = modulo_int((s->counters.at[INT64_C(1)] + INT64_C(1)), s->delay_m_s.cols);
}

static inline void k_drive_carriages(const LineArrays * p, const Layout * lay, const LineState * s) {
    CARRIAGE * carriage = {0};
    floats force = {0};
    floats integral = {0};
    const int64_t t1_ = p->carriages.n;
    for (int64_t c = 0; c < t1_; c++) {
        carriage = (&p->carriages.at[c]);
        const integers t2_ = ((integers)(carriage->gain_rad_s > each_float(0.0)));
        const integers on3_ = t2_;
        if (any(on3_)) {
            const group_FF t4_ = k_speed_pi(carriage->mass_kg, carriage->gain_rad_s, carriage->drive_damping, (carriage->speed_m_s - s->y.at[((lay->carriage + (INT64_C(2) * c)) + INT64_C(1))]), s->carriage_integral_m.at[c], (&p->timing.at[INT64_C(0)])->drive_tick_s[0], carriage->limit_N);
            force = choose_floats(on3_, t4_.part0, force);
            integral = choose_floats(on3_, t4_.part1, integral);
            s->carriage_force_N.at[c] = choose_floats(on3_, force, s->carriage_force_N.at[c]);
            s->carriage_integral_m.at[c] = choose_floats(on3_, integral, s->carriage_integral_m.at[c]);
        }
    }
}

static inline floats k_web_share(floats slip_s_m, floats threshold_m_s, floats speed_m_s) {
    floats excess = {0};
    integers returned_ = each_bool(false);
    floats result_ = {0};
    excess = (absolutes(speed_m_s) - threshold_m_s);
    const integers t1_ = (((integers)(slip_s_m == each_float(0.0))) | ((integers)(excess <= each_float(0.0))));
    const integers on2_ = t1_;
    if (any(on2_)) {
        result_ = choose_floats(on2_, each_float(1.0), result_);
        returned_ |= on2_;
    }
    const integers on3_ = ~returned_;
    if (any(on3_)) {
        result_ = choose_floats(on3_, (1.0 - (slip_s_m * excess)), result_);
        returned_ |= on3_;
    }
    return result_;
}

static inline group_FFFF k_moved_point(const LineArrays * p, int64_t c, floats travel_m, floats x_m, floats y_m) {
    CARRIAGE * carriage = {0};
    floats x = {0};
    floats y = {0};
    floats turned = {0};
    floats sine = {0};
    floats cosine = {0};
    floats from_x = {0};
    floats from_y = {0};
    floats arm_x = {0};
    floats arm_y = {0};
    carriage = (&p->carriages.at[c]);
    if ((carriage->pendulum[0] == INT64_C(0))) {
        x = (x_m + (travel_m * carriage->axis_x));
        y = (y_m + (travel_m * carriage->axis_y));
        const group_FFFF t1_ = (group_FFFF){x, y, carriage->axis_x, carriage->axis_y};
        return t1_;
    }
    turned = (carriage->turn_1_m * travel_m);
    const floats t2_ = lanes_sin(turned);
    const floats t3_ = lanes_cos(turned);
    sine = t2_;
    cosine = t3_;
    const floats t4_ = (x_m - carriage->pivot_x_m);
    const floats t5_ = (y_m - carriage->pivot_y_m);
    from_x = t4_;
    from_y = t5_;
    arm_x = ((cosine * from_x) - (sine * from_y));
    arm_y = ((sine * from_x) + (cosine * from_y));
    const group_FFFF t6_ = (group_FFFF){(carriage->pivot_x_m + arm_x), (carriage->pivot_y_m + arm_y), ((-carriage->turn_1_m) * arm_y), (carriage->turn_1_m * arm_x)};
    return t6_;
}

static inline group_FFFF k_centre_of(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t k) {
    BODY * body = {0};
    floats travel_m = {0};
    body = (&p->bodies.at[k]);
    if ((body->carriage[0] < INT64_C(0))) {
        const group_FFFF t1_ = (group_FFFF){body->centre_x_m, body->centre_y_m, each_float(0.0), each_float(0.0)};
        return t1_;
    }
    travel_m = y.at[(lay->carriage + (INT64_C(2) * body->carriage[0]))];
    const group_FFFF t2_ = k_moved_point(p, body->carriage[0], travel_m, body->centre_x_m, body->centre_y_m);
    return t2_;
}

static inline group_FF k_apart(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i) {
    floats a_x = {0};
    floats a_y = {0};
    floats b_x = {0};
    floats b_y = {0};
    const group_FFFF t1_ = k_centre_of(p, lay, y, i);
    a_x = t1_.part0;
    a_y = t1_.part1;
    const group_FFFF t2_ = k_centre_of(p, lay, y, (i + INT64_C(1)));
    b_x = t2_.part0;
    b_y = t2_.part1;
    const group_FF t3_ = (group_FF){(b_x - a_x), (b_y - a_y)};
    return t3_;
}

static inline group_FFF k_support_at(float_lanes_row h, float_lanes_row dh, float_lanes_row rho, floats psi_rad) {
    int64_t cells = 0;
    double step = 0;
    floats turn = {0};
    floats position = {0};
    integers i = {0};
    floats t = {0};
    floats f0 = {0};
    floats f1 = {0};
    floats d0 = {0};
    floats d1 = {0};
    floats s0 = {0};
    floats s1 = {0};
    floats rise = {0};
    floats a = {0};
    floats b = {0};
    floats c = {0};
    floats value = {0};
    floats slope = {0};
    floats bend = {0};
    cells = (h.n - INT64_C(1));
    step = (6.283185307179586 / ((double)(cells)));
    turn = (psi_rad * (1.0 / 6.283185307179586));
    position = ((turn - lanes_floor(turn)) * ((double)(cells)));
    i = choose_integers(((integers)(position >= each_float(0.0))), least_ints(integers_of(position), each_int((cells - INT64_C(1)))), each_int(INT64_C(0)));
    t = (position - floats_of(i));
    const floats t1_ = gather_floats(h.at, h.row + i);
    const floats t2_ = gather_floats(h.at, h.row + (i + INT64_C(1)));
    f0 = t1_;
    f1 = t2_;
    const floats t3_ = (gather_floats(dh.at, dh.row + i) * step);
    const floats t4_ = (gather_floats(dh.at, dh.row + (i + INT64_C(1))) * step);
    d0 = t3_;
    d1 = t4_;
    const floats t5_ = (((gather_floats(rho.at, rho.row + i) - f0) * step) * step);
    const floats t6_ = (((gather_floats(rho.at, rho.row + (i + INT64_C(1))) - f1) * step) * step);
    s0 = t5_;
    s1 = t6_;
    rise = (f1 - f0);
    a = (((((10.0 * rise) - (6.0 * d0)) - (4.0 * d1)) - (1.5 * s0)) + (0.5 * s1));
    b = ((((((-15.0) * rise) + (8.0 * d0)) + (7.0 * d1)) + (1.5 * s0)) - s1);
    c = (((((6.0 * rise) - (3.0 * d0)) - (3.0 * d1)) - (0.5 * s0)) + (0.5 * s1));
    value = (f0 + (t * (d0 + (t * ((0.5 * s0) + (t * (a + (t * (b + (t * c))))))))));
    slope = (d0 + (t * (s0 + (t * ((3.0 * a) + (t * ((4.0 * b) + ((t * 5.0) * c))))))));
    bend = (s0 + (t * ((6.0 * a) + (t * ((12.0 * b) + ((t * 20.0) * c))))));
    const group_FFF t7_ = (group_FFF){value, (slope * (1.0 / step)), (value + (bend * (1.0 / (step * step))))};
    return t7_;
}

static inline group_FFF k_body_at(floats radius_m, floats sigma, integers row, float_lanes_2 h_m, float_lanes_2 dh_m, float_lanes_2 rho_m, floats theta_rad, floats phi_rad) {
    floats psi = {0};
    floats h = {0};
    floats dh = {0};
    floats rho = {0};
    integers returned_ = each_bool(false);
    group_FFF result_ = {0};
    const integers t1_ = ((integers)(row < each_int(INT64_C(0))));
    const integers on2_ = t1_;
    if (any(on2_)) {
        const group_FFF t3_ = (group_FFF){radius_m, each_float(0.0), radius_m};
        result_.part0 = choose_floats(on2_, t3_.part0, result_.part0);
        result_.part1 = choose_floats(on2_, t3_.part1, result_.part1);
        result_.part2 = choose_floats(on2_, t3_.part2, result_.part2);
        returned_ |= on2_;
    }
    const integers on4_ = ~returned_;
    if (any(on4_)) {
        psi = (((sigma * phi_rad) - (0.5 * 3.141592653589793)) - theta_rad);
        const group_FFF t5_ = k_support_at(((float_lanes_row){h_m.at, choose_integers(on4_, row, each_int(INT64_C(0))) * h_m.cols, h_m.cols}), ((float_lanes_row){dh_m.at, choose_integers(on4_, row, each_int(INT64_C(0))) * dh_m.cols, dh_m.cols}), ((float_lanes_row){rho_m.at, choose_integers(on4_, row, each_int(INT64_C(0))) * rho_m.cols, rho_m.cols}), psi);
        h = t5_.part0;
        dh = t5_.part1;
        rho = t5_.part2;
        const group_FFF t6_ = (group_FFF){(radius_m + h), dh, (radius_m + rho)};
        result_.part0 = choose_floats(on4_, t6_.part0, result_.part0);
        result_.part1 = choose_floats(on4_, t6_.part1, result_.part1);
        result_.part2 = choose_floats(on4_, t6_.part2, result_.part2);
        returned_ |= on4_;
    }
    return result_;
}

static inline group_FF k_tangent(floats dx_m, floats dy_m, floats sigma_a, floats p_a, floats dh_a, floats sigma_b, floats p_b, floats dh_b, floats phi_rad) {
    floats s = {0};
    floats c = {0};
    floats residual = {0};
    floats length = {0};
    const floats t1_ = lanes_sin(phi_rad);
    const floats t2_ = lanes_cos(phi_rad);
    s = t1_;
    c = t2_;
    residual = ((((s * dx_m) - (c * dy_m)) + (sigma_b * p_b)) - (sigma_a * p_a));
    length = ((((c * dx_m) + (s * dy_m)) + dh_b) - dh_a);
    const group_FF t3_ = (group_FF){residual, length};
    return t3_;
}

static inline group_FF k_turned_on(floats p_m, floats dh_m, floats rho_m, floats turn_rad) {
    const group_FF t1_ = (group_FF){(p_m + (turn_rad * dh_m)), (dh_m + (turn_rad * (rho_m - p_m)))};
    return t1_;
}

static inline floats k_radius_rate(floats thickness_m, floats omega_rad_s, double direction) {
    return (((direction * thickness_m) * omega_rad_s) * (1.0 / (2.0 * 3.141592653589793)));
}

static inline floats k_growth(int64_t kind, floats thickness_m, floats omega_rad_s) {
    if ((kind == INT64_C(2))) {
        return k_radius_rate(thickness_m, omega_rad_s, (-1.0));
    }
    if ((kind == INT64_C(3))) {
        return k_radius_rate(thickness_m, omega_rad_s, 1.0);
    }
    return each_float(0.0);
}

static inline floats k_travel_speed(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t k) {
    int64_t carriage = 0;
    carriage = (&p->bodies.at[k])->carriage[0];
    return ((carriage >= INT64_C(0)) ? (floats)y.at[((lay->carriage + (INT64_C(2) * carriage)) + INT64_C(1))] : (floats)each_float(0.0));
}

static inline floats k_turn_by_travel(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, floats phi_rad, float_lanes_2 out, const integers lanes_) {
    floats sine = {0};
    floats cosine = {0};
    floats a_sx = {0};
    floats a_sy = {0};
    floats b_sx = {0};
    floats b_sy = {0};
    floats across = {0};
    integers returned_ = each_bool(false);
    floats result_ = {0};
    const floats t1_ = lanes_sin(phi_rad);
    const floats t2_ = lanes_cos(phi_rad);
    sine = t1_;
    cosine = t2_;
    const group_FFFF t3_ = k_centre_of(p, lay, y, i);
    a_sx = t3_.part2;
    a_sy = t3_.part3;
    const group_FFFF t4_ = k_centre_of(p, lay, y, (i + INT64_C(1)));
    b_sx = t4_.part2;
    b_sy = t4_.part3;
    out.at[i * out.cols + INT64_C(6)] = choose_floats(lanes_, ((cosine * a_sx) + (sine * a_sy)), out.at[i * out.cols + INT64_C(6)]);
    out.at[i * out.cols + INT64_C(7)] = choose_floats(lanes_, ((cosine * b_sx) + (sine * b_sy)), out.at[i * out.cols + INT64_C(7)]);
    across = (((sine * b_sx) - (cosine * b_sy)) * k_travel_speed(p, lay, y, (i + INT64_C(1))));
    result_ = choose_floats(lanes_, (across - (((sine * a_sx) - (cosine * a_sy)) * k_travel_speed(p, lay, y, i))), result_);
    returned_ |= lanes_;
    return result_;
}

static inline void k_span_contacts(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, float_lanes_1 phi, float_lanes_2 out, bool more, const integers lanes_) {
    BODY * a = {0};
    BODY * b = {0};
    floats dx = {0};
    floats dy = {0};
    integers carried = {0};
    floats radius_a = {0};
    floats radius_b = {0};
    floats theta_a = {0};
    floats theta_b = {0};
    floats angle = {0};
    floats p_a = {0};
    floats p_b = {0};
    floats dh_a = {0};
    floats dh_b = {0};
    floats rho_a = {0};
    floats rho_b = {0};
    floats length = {0};
    floats residual = {0};
    floats bend = {0};
    floats turn = {0};
    floats omega_a = {0};
    floats omega_b = {0};
    floats thickness = {0};
    floats turning = {0};
    floats phidot = {0};
    BODY * t1_ = (&p->bodies.at[i]);
    BODY * t2_ = (&p->bodies.at[(i + INT64_C(1))]);
    a = t1_;
    b = t2_;
    const floats t3_ = (b->centre_x_m - a->centre_x_m);
    const floats t4_ = (b->centre_y_m - a->centre_y_m);
    dx = choose_floats(lanes_, t3_, dx);
    dy = choose_floats(lanes_, t4_, dy);
    carried = each_bool((more && ((a->carriage[0] >= INT64_C(0)) || (b->carriage[0] >= INT64_C(0)))));
    const integers t5_ = carried;
    const integers on6_ = lanes_ & t5_;
    if (any(on6_)) {
        const group_FF t7_ = k_apart(p, lay, y, i);
        dx = choose_floats(on6_, t7_.part0, dx);
        dy = choose_floats(on6_, t7_.part1, dy);
    }
    radius_a = k_mean_radius(lay, y, a->kind[0], a->radius_m);
    radius_b = k_mean_radius(lay, y, b->kind[0], b->radius_m);
    const floats t8_ = y.at[(lay->theta + i)];
    const floats t9_ = y.at[((lay->theta + i) + INT64_C(1))];
    theta_a = t8_;
    theta_b = t9_;
    angle = choose_floats(lanes_, phi.at[i], angle);
    const double t10_ = 0.0;
    p_a = choose_floats(lanes_, each_float(t10_), p_a);
    p_b = choose_floats(lanes_, each_float(t10_), p_b);
    dh_a = choose_floats(lanes_, each_float(t10_), dh_a);
    dh_b = choose_floats(lanes_, each_float(t10_), dh_b);
    rho_a = choose_floats(lanes_, each_float(t10_), rho_a);
    rho_b = choose_floats(lanes_, each_float(t10_), rho_b);
    length = choose_floats(lanes_, each_float(t10_), length);
    const int64_t t11_ = INT64_C(8);
    integers broken50_ = each_bool(false);
    for (int64_t n12_ = 0; n12_ < t11_; n12_++) {
        integers skipped50_ = each_bool(false);
        const integers on13_ = lanes_ & ~broken50_ & ~skipped50_;
        if (!any(on13_)) break;
        const group_FFF t14_ = k_body_at(radius_a, a->sigma, a->shape_row, p->shape_h_m, p->shape_dh_m, p->shape_rho_m, theta_a, angle);
        p_a = choose_floats(on13_, t14_.part0, p_a);
        dh_a = choose_floats(on13_, t14_.part1, dh_a);
        rho_a = choose_floats(on13_, t14_.part2, rho_a);
        const group_FFF t15_ = k_body_at(radius_b, b->sigma, b->shape_row, p->shape_h_m, p->shape_dh_m, p->shape_rho_m, theta_b, angle);
        p_b = choose_floats(on13_, t15_.part0, p_b);
        dh_b = choose_floats(on13_, t15_.part1, dh_b);
        rho_b = choose_floats(on13_, t15_.part2, rho_b);
        const group_FF t16_ = k_tangent(dx, dy, a->sigma, p_a, dh_a, b->sigma, p_b, dh_b, angle);
        residual = choose_floats(on13_, t16_.part0, residual);
        length = choose_floats(on13_, t16_.part1, length);
        const integers t17_ = ((integers)(absolutes(residual) < each_float(1e-13)));
        const integers on18_ = on13_ & t17_;
        if (any(on18_)) {
            broken50_ |= on18_;
        }
        const integers on19_ = on13_ & ~broken50_ & ~skipped50_;
        if (any(on19_)) {
            bend = choose_floats(on19_, (((b->sigma * rho_b) - (a->sigma * rho_a)) - residual), bend);
            turn = choose_floats(on19_, ((-residual) / length), turn);
            const integers t20_ = ((integers)(absolutes(turn) < each_float(1e-05)));
            const integers on21_ = on19_ & t20_;
            if (any(on21_)) {
                angle = choose_floats(on21_, (angle + turn), angle);
                length = choose_floats(on21_, (length + (bend * turn)), length);
                const group_FF t22_ = k_turned_on(p_a, dh_a, rho_a, (a->sigma * turn));
                p_a = choose_floats(on21_, t22_.part0, p_a);
                dh_a = choose_floats(on21_, t22_.part1, dh_a);
                const group_FF t23_ = k_turned_on(p_b, dh_b, rho_b, (b->sigma * turn));
                p_b = choose_floats(on21_, t23_.part0, p_b);
                dh_b = choose_floats(on21_, t23_.part1, dh_b);
                broken50_ |= on21_;
            }
            const integers on24_ = on19_ & ~broken50_ & ~skipped50_;
            if (any(on24_)) {
                angle = choose_floats(on24_, (angle + turn), angle);
            }
        }
    }
    phi.at[i] = choose_floats(lanes_, angle, phi.at[i]);
    const floats t25_ = y.at[(lay->omega + i)];
    const floats t26_ = y.at[((lay->omega + i) + INT64_C(1))];
    omega_a = t25_;
    omega_b = t26_;
    thickness = (&p->web.at[INT64_C(0)])->thickness_m;
    turning = choose_floats(lanes_, (b->sigma * ((dh_b * omega_b) - k_growth(b->kind[0], thickness, omega_b))), turning);
    turning = choose_floats(lanes_, (turning - (a->sigma * ((dh_a * omega_a) - k_growth(a->kind[0], thickness, omega_a)))), turning);
    const integers t27_ = carried;
    const integers on28_ = lanes_ & t27_;
    if (any(on28_)) {
        const floats t29_ = k_turn_by_travel(p, lay, y, i, angle, out, on28_);
        turning = choose_floats(on28_, (turning - t29_), turning);
    }
    phidot = (turning / length);
    out.at[i * out.cols + INT64_C(0)] = choose_floats(lanes_, length, out.at[i * out.cols + INT64_C(0)]);
    out.at[i * out.cols + INT64_C(1)] = choose_floats(lanes_, p_a, out.at[i * out.cols + INT64_C(1)]);
    out.at[i * out.cols + INT64_C(2)] = choose_floats(lanes_, p_b, out.at[i * out.cols + INT64_C(2)]);
    out.at[i * out.cols + INT64_C(3)] = choose_floats(lanes_, (rho_a * (omega_a - (a->sigma * phidot))), out.at[i * out.cols + INT64_C(3)]);
    out.at[i * out.cols + INT64_C(4)] = choose_floats(lanes_, phidot, out.at[i * out.cols + INT64_C(4)]);
}

static inline floats k_wrapped(const LineArrays * p, int64_t i, float_lanes_1 phi, float_lanes_2 contacts) {
    floats turn = {0};
    if (((i + INT64_C(1)) >= phi.n)) {
        return each_float(0.0);
    }
    turn = ((&p->bodies.at[(i + INT64_C(1))])->sigma * (phi.at[(i + INT64_C(1))] - phi.at[i]));
    return (contacts.at[i * contacts.cols + INT64_C(2)] * modulo_floats(turn, each_float((2.0 * 3.141592653589793))));
}

static inline floats k_on_wrap(floats piece_m, floats past_m, floats wrap_m) {
    floats come = {0};
    floats gone = {0};
    integers returned_ = each_bool(false);
    floats result_ = {0};
    const integers t1_ = ((integers)(wrap_m <= each_float(0.0)));
    const integers on2_ = t1_;
    if (any(on2_)) {
        result_ = choose_floats(on2_, each_float(0.0), result_);
        returned_ |= on2_;
    }
    const integers on3_ = ~returned_;
    if (any(on3_)) {
        come = least_floats(largest_floats((past_m * (1.0 / 0.01)), each_float(0.0)), each_float(1.0));
        gone = least_floats(largest_floats((((past_m - wrap_m) - piece_m) * (1.0 / 0.01)), each_float(0.0)), each_float(1.0));
        result_ = choose_floats(on3_, (come - gone), result_);
        returned_ |= on3_;
    }
    return result_;
}

static inline floats k_seam_lift(const LineArrays * p, int64_t i, float_lanes_1 phi, float_lanes_2 contacts, floats past_m) {
    WEB * web = {0};
    floats wrap_m = {0};
    web = (&p->web.at[INT64_C(0)]);
    wrap_m = k_wrapped(p, i, phi, contacts);
    return (web->splice_step_m * k_on_wrap(web->splice_piece_m, past_m, wrap_m));
}

static inline floats k_leaving_value(floats value, floats surroundings, floats renewal_1_s, floats time_s) {
    floats share = {0};
    floats kept = {0};
    share = least_floats((1.0 / (renewal_1_s * time_s)), each_float(500.0));
    kept = choose_floats(((integers)(share > each_float(1e-05))), (share / (lanes_exp(share) - 1.0)), (1.0 - (0.5 * share)));
    return (surroundings + ((value - surroundings) * kept));
}

static inline group_FFF k_warm_span(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, floats renewal_1_s, double entering_K, float_lanes_1 dy) {
    SPAN * span = {0};
    floats mean = {0};
    floats rate = {0};
    floats entering = {0};
    int64_t parts = 0;
    floats renewal = {0};
    int64_t j = 0;
    HEAT * heat = {0};
    floats warming = {0};
    floats leaving = {0};
    floats change = {0};
    span = (&p->spans.at[i]);
    const double t1_ = 0.0;
    const double t2_ = 0.0;
    const double t3_ = entering_K;
    mean = each_float(t1_);
    rate = each_float(t2_);
    entering = each_float(t3_);
    parts = span->heat_parts[0];
    if ((parts > INT64_C(0))) {
        renewal = (absolutes(renewal_1_s) * ((double)(parts)));
        const int64_t t4_ = parts;
        for (int64_t part = 0; part < t4_; part++) {
            j = (span->heat_first[0] + part);
            heat = (&p->heats.at[j]);
            warming = y.at[(lay->heat + j)];
            leaving = k_leaving_value(warming, heat->air_K, renewal, heat->time_s);
            change = ((renewal * (entering - leaving)) + ((heat->air_K - warming) / heat->time_s));
            dy.at[(lay->heat + j)] = change;
            mean = (mean + (warming * (1.0 / ((double)(parts)))));
            rate = (rate + (change * (1.0 / ((double)(parts)))));
            entering = leaving;
        }
    }
    const group_FFF t5_ = (group_FFF){mean, rate, entering};
    return t5_;
}

static inline group_FFFF k_free_strains(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, floats flow_m_s, floats length_m, double entering_K, float_lanes_1 dy) {
    floats free = {0};
    floats mean_K = {0};
    floats rate_K_s = {0};
    floats leaving_K = {0};
    floats expansion = {0};
    free = (&p->spans.at[i])->free_strain;
    if ((p->heats.n == INT64_C(0))) {
        const group_FFFF t1_ = (group_FFFF){free, free, each_float(0.0), each_float(0.0)};
        return t1_;
    }
    const group_FFF t2_ = k_warm_span(p, lay, y, i, (flow_m_s / length_m), entering_K, dy);
    mean_K = t2_.part0;
    rate_K_s = t2_.part1;
    leaving_K = t2_.part2;
    expansion = (&p->web.at[INT64_C(0)])->expansion_1_K;
    const group_FFFF t3_ = (group_FFFF){(free + (expansion * mean_K)), (free + (expansion * leaving_K)), (expansion * rate_K_s), leaving_K};
    return t3_;
}

static inline floats k_lengthening(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, float_lanes_2 contacts) {
    floats added = {0};
    added = (contacts.at[i * contacts.cols + INT64_C(7)] * k_travel_speed(p, lay, y, (i + INT64_C(1))));
    return (added - (contacts.at[i * contacts.cols + INT64_C(6)] * k_travel_speed(p, lay, y, i)));
}

static inline floats k_two_webs(floats EA_N, floats ratio, floats share) {
    return (EA_N / ((1.0 - share) + (share / ratio)));
}

static inline group_FF k_with_two_webs(const LineArrays * p, int64_t i, floats strain, floats free, floats free_out, floats new) {
    SPAN * span = {0};
    floats ratio = {0};
    floats share = {0};
    floats EA_N = {0};
    floats at_exit = {0};
    SPAN * t1_ = (&p->spans.at[i]);
    const floats t2_ = (&p->web.at[INT64_C(0)])->splice_EA_ratio;
    span = t1_;
    ratio = t2_;
    share = least_floats(largest_floats(new, each_float(0.0)), each_float(1.0));
    EA_N = k_two_webs(span->EA_N, ratio, share);
    at_exit = (span->EA_N * choose_floats(((integers)(share == each_float(1.0))), ratio, each_float(1.0)));
    const group_FF t3_ = (group_FF){EA_N, (free_out + (((strain - free) * EA_N) / at_exit))};
    return t3_;
}

static inline floats k_strain_rate(floats length_m, floats strain, floats strain_upstream, floats length_rate_in_m_s, floats length_rate_out_m_s, floats contact_flow_in_m_s) {
    floats transport = {0};
    transport = ((absolutes(contact_flow_in_m_s) * (strain - strain_upstream)) / (1.0 + strain_upstream));
    return (((1.0 + strain) / length_m) * ((length_rate_out_m_s - length_rate_in_m_s) - transport));
}

static inline floats k_tension(floats EA_N, floats strain, floats viscosity_s, floats rate_1_s) {
    return largest_floats(each_float(0.0), (EA_N * (strain + (viscosity_s * rate_1_s))));
}

static inline floats k_maxwell_rate(floats branch, double branch_upstream, floats strain_step, floats rate_1_s, floats time_s, floats renewal_1_s) {
    floats fresh = {0};
    fresh = (branch_upstream + strain_step);
    return ((rate_1_s - (branch / time_s)) + (renewal_1_s * (fresh - branch)));
}

static inline group_FF k_with_branch(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, floats EA_N, floats pull_N, floats step, floats rate_1_s, double branch_up, floats renewal_1_s, float_lanes_1 dy, const integers lanes_) {
    WEB * web = {0};
    floats branch = {0};
    integers returned_ = each_bool(false);
    group_FF result_ = {0};
    WEB * t1_ = (&p->web.at[INT64_C(0)]);
    const floats t2_ = y.at[(lay->maxwell + i)];
    web = t1_;
    branch = t2_;
    dy.at[(lay->maxwell + i)] = choose_floats(lanes_, k_maxwell_rate(branch, branch_up, step, rate_1_s, web->maxwell_time_s, renewal_1_s), dy.at[(lay->maxwell + i)]);
    const group_FF t3_ = (group_FF){largest_floats(each_float(0.0), (pull_N + ((EA_N * web->maxwell_ratio) * branch))), branch};
    result_.part0 = choose_floats(lanes_, t3_.part0, result_.part0);
    result_.part1 = choose_floats(lanes_, t3_.part1, result_.part1);
    returned_ |= lanes_;
    return result_;
}

static inline group_FFF k_warm_span2(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, floats renewal_1_s, floats entering_K, float_lanes_1 dy) {
    SPAN * span = {0};
    floats mean = {0};
    floats rate = {0};
    floats entering = {0};
    int64_t parts = 0;
    floats renewal = {0};
    int64_t j = 0;
    HEAT * heat = {0};
    floats warming = {0};
    floats leaving = {0};
    floats change = {0};
    span = (&p->spans.at[i]);
    const double t1_ = 0.0;
    const double t2_ = 0.0;
    const floats t3_ = entering_K;
    mean = each_float(t1_);
    rate = each_float(t2_);
    entering = t3_;
    parts = span->heat_parts[0];
    if ((parts > INT64_C(0))) {
        renewal = (absolutes(renewal_1_s) * ((double)(parts)));
        const int64_t t4_ = parts;
        for (int64_t part = 0; part < t4_; part++) {
            j = (span->heat_first[0] + part);
            heat = (&p->heats.at[j]);
            warming = y.at[(lay->heat + j)];
            leaving = k_leaving_value(warming, heat->air_K, renewal, heat->time_s);
            change = ((renewal * (entering - leaving)) + ((heat->air_K - warming) / heat->time_s));
            dy.at[(lay->heat + j)] = change;
            mean = (mean + (warming * (1.0 / ((double)(parts)))));
            rate = (rate + (change * (1.0 / ((double)(parts)))));
            entering = leaving;
        }
    }
    const group_FFF t5_ = (group_FFF){mean, rate, entering};
    return t5_;
}

static inline group_FFFF k_free_strains2(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, floats flow_m_s, floats length_m, floats entering_K, float_lanes_1 dy) {
    floats free = {0};
    floats mean_K = {0};
    floats rate_K_s = {0};
    floats leaving_K = {0};
    floats expansion = {0};
    free = (&p->spans.at[i])->free_strain;
    if ((p->heats.n == INT64_C(0))) {
        const group_FFFF t1_ = (group_FFFF){free, free, each_float(0.0), each_float(0.0)};
        return t1_;
    }
    const group_FFF t2_ = k_warm_span2(p, lay, y, i, (flow_m_s / length_m), entering_K, dy);
    mean_K = t2_.part0;
    rate_K_s = t2_.part1;
    leaving_K = t2_.part2;
    expansion = (&p->web.at[INT64_C(0)])->expansion_1_K;
    const group_FFFF t3_ = (group_FFFF){(free + (expansion * mean_K)), (free + (expansion * leaving_K)), (expansion * rate_K_s), leaving_K};
    return t3_;
}

static inline floats k_maxwell_rate2(floats branch, floats branch_upstream, floats strain_step, floats rate_1_s, floats time_s, floats renewal_1_s) {
    floats fresh = {0};
    fresh = (branch_upstream + strain_step);
    return ((rate_1_s - (branch / time_s)) + (renewal_1_s * (fresh - branch)));
}

static inline group_FF k_with_branch2(const LineArrays * p, const Layout * lay, float_lanes_1 y, int64_t i, floats EA_N, floats pull_N, floats step, floats rate_1_s, floats branch_up, floats renewal_1_s, float_lanes_1 dy, const integers lanes_) {
    WEB * web = {0};
    floats branch = {0};
    integers returned_ = each_bool(false);
    group_FF result_ = {0};
    WEB * t1_ = (&p->web.at[INT64_C(0)]);
    const floats t2_ = y.at[(lay->maxwell + i)];
    web = t1_;
    branch = t2_;
    dy.at[(lay->maxwell + i)] = choose_floats(lanes_, k_maxwell_rate2(branch, branch_up, step, rate_1_s, web->maxwell_time_s, renewal_1_s), dy.at[(lay->maxwell + i)]);
    const group_FF t3_ = (group_FF){largest_floats(each_float(0.0), (pull_N + ((EA_N * web->maxwell_ratio) * branch))), branch};
    result_.part0 = choose_floats(lanes_, t3_.part0, result_.part0);
    result_.part1 = choose_floats(lanes_, t3_.part1, result_.part1);
    returned_ |= lanes_;
    return result_;
}

static inline floats k_span_tensions(const LineArrays * p, const Layout * lay, float_lanes_1 y, float_lanes_1 moving, float_lanes_1 phi, float_lanes_2 contacts, float_lanes_1 tensions, float_lanes_1 dy, bool more) {
    WEB * web = {0};
    int64_t spans = 0;
    integers seam = {0};
    integers spliced = {0};
    floats lift_a = {0};
    floats branch_up = {0};
    floats entering_K = {0};
    floats free_up = {0};
    floats behind = {0};
    floats upstream = {0};
    BODY * first = {0};
    floats share_a = {0};
    floats lift_b = {0};
    floats speed_in = {0};
    floats speed_out = {0};
    floats flow = {0};
    BODY * after = {0};
    floats share_b = {0};
    floats rate_in = {0};
    floats strain = {0};
    SPAN * span = {0};
    floats EA_N = {0};
    floats leaving = {0};
    floats rate_out = {0};
    floats free = {0};
    floats free_out = {0};
    floats free_rate = {0};
    floats free_step = {0};
    floats held = {0};
    floats before = {0};
    floats rate = {0};
    floats pull = {0};
    floats step = {0};
    floats renewal = {0};
    int64_t last = 0;
    floats wander = {0};
    web = (&p->web.at[INT64_C(0)]);
    spans = (lay->n - INT64_C(1));
    seam = ((integers)(web->splice_step_m != each_float(0.0)));
    spliced = (((integers)(web->splice_EA_ratio != each_float(1.0))) | ((integers)(web->splice_thickness_ratio != each_float(1.0))) | seam);
    const double t1_ = 0.0;
    lift_a = each_float(t1_);
    branch_up = each_float(t1_);
    entering_K = each_float(t1_);
    free_up = each_float(t1_);
    behind = (y.at[lay->flow] - web->splice_m);
    upstream = web->supply_strain;
    const integers t2_ = (spliced & ((integers)(behind > each_float(0.0))));
    const integers on3_ = t2_;
    if (any(on3_)) {
        upstream = choose_floats(on3_, (upstream / web->splice_EA_ratio), upstream);
    }
    first = (&p->bodies.at[INT64_C(0)]);
    share_a = k_web_share(first->slip_s_m, first->slip_speed_m_s, (contacts.at[INT64_C(0) * contacts.cols + INT64_C(1)] * y.at[lay->omega]));
    const int64_t t4_ = spans;
    for (int64_t i = 0; i < t4_; i++) {
        const integers t5_ = ((integers)(moving.at[i] != each_float(0.0)));
        const integers on6_ = t5_;
        if (any(on6_)) {
            k_span_contacts(p, lay, y, i, phi, contacts, more, on6_);
        }
        lift_b = each_float(0.0);
        const integers t7_ = seam;
        const integers on8_ = t7_;
        if (any(on8_)) {
            const floats t9_ = k_seam_lift(p, i, phi, contacts, (behind - (contacts.at[i * contacts.cols + INT64_C(0)] / (1.0 + y.at[(lay->strain + i)]))));
            lift_b = choose_floats(on8_, t9_, lift_b);
            contacts.at[i * contacts.cols + INT64_C(5)] = choose_floats(on8_, t9_, contacts.at[i * contacts.cols + INT64_C(5)]);
        }
        speed_in = ((contacts.at[i * contacts.cols + INT64_C(1)] + lift_a) * y.at[(lay->omega + i)]);
        speed_out = ((contacts.at[i * contacts.cols + INT64_C(2)] + lift_b) * y.at[((lay->omega + i) + INT64_C(1))]);
        flow = choose_floats(((integers)(moving.at[i] != each_float(0.0))), contacts.at[i * contacts.cols + INT64_C(3)], speed_in);
        after = (&p->bodies.at[(i + INT64_C(1))]);
        share_b = k_web_share(after->slip_s_m, after->slip_speed_m_s, speed_out);
        rate_in = (speed_in * share_a);
        if ((i == INT64_C(0))) {
            rate_in = (rate_in + y.at[(lay->bounce + INT64_C(1))]);
            dy.at[lay->flow] = ((flow * share_a) / (1.0 + upstream));
        }
        flow = (flow * share_a);
        strain = y.at[(lay->strain + i)];
        span = (&p->spans.at[i]);
        const floats t10_ = span->EA_N;
        const floats t11_ = strain;
        const floats t12_ = (speed_out * share_b);
        EA_N = t10_;
        leaving = t11_;
        rate_out = t12_;
        const floats t13_ = span->free_strain;
        free = t13_;
        free_out = t13_;
        const double t14_ = 0.0;
        free_rate = each_float(t14_);
        free_step = each_float(t14_);
        if (more) {
            const group_FFFF t15_ = k_free_strains2(p, lay, y, i, flow, contacts.at[i * contacts.cols + INT64_C(0)], entering_K, dy);
            free = t15_.part0;
            free_out = t15_.part1;
            free_rate = t15_.part2;
            entering_K = t15_.part3;
            free_step = (free - free_up);
            free_up = free_out;
            leaving = ((strain + free_out) - free);
            rate_out = (rate_out * ((1.0 + strain) / (1.0 + leaving)));
            rate_in = (rate_in - k_lengthening(p, lay, y, i, contacts));
        }
        const integers t16_ = spliced;
        const integers on17_ = t16_;
        if (any(on17_)) {
            const floats t18_ = (contacts.at[i * contacts.cols + INT64_C(0)] / (1.0 + strain));
            const floats t19_ = leaving;
            held = choose_floats(on17_, t18_, held);
            before = choose_floats(on17_, t19_, before);
            const group_FF t20_ = k_with_two_webs(p, i, strain, free, free_out, (behind / held));
            EA_N = choose_floats(on17_, t20_.part0, EA_N);
            leaving = choose_floats(on17_, t20_.part1, leaving);
            rate_out = choose_floats(on17_, (rate_out * ((1.0 + before) / (1.0 + leaving))), rate_out);
            behind = choose_floats(on17_, (behind - (held + (k_wrapped(p, i, phi, contacts) / (1.0 + leaving)))), behind);
        }
        rate = k_strain_rate(contacts.at[i * contacts.cols + INT64_C(0)], strain, upstream, rate_in, rate_out, flow);
        dy.at[(lay->strain + i)] = rate;
        pull = k_tension(EA_N, (strain - free), web->viscosity_s, (rate - free_rate));
        const integers t21_ = ((integers)(web->maxwell_ratio != each_float(0.0)));
        const integers on22_ = t21_;
        if (any(on22_)) {
            const floats t23_ = ((strain - upstream) - free_step);
            const floats t24_ = (flow / contacts.at[i * contacts.cols + INT64_C(0)]);
            step = choose_floats(on22_, t23_, step);
            renewal = choose_floats(on22_, t24_, renewal);
            const group_FF t25_ = k_with_branch2(p, lay, y, i, EA_N, pull, step, (rate - free_rate), branch_up, renewal, dy, on22_);
            pull = choose_floats(on22_, t25_.part0, pull);
            branch_up = choose_floats(on22_, t25_.part1, branch_up);
        }
        tensions.at[i] = pull;
        upstream = leaving;
        const integers t26_ = (spliced & ((integers)(behind <= each_float(0.0))));
        const integers on27_ = t26_;
        if (any(on27_)) {
            upstream = choose_floats(on27_, (free_out + (((strain - free) * EA_N) / span->EA_N)), upstream);
        }
        const floats t28_ = share_b;
        const floats t29_ = lift_b;
        share_a = t28_;
        lift_a = t29_;
    }
    last = (lay->n - INT64_C(1));
    wander = ((contacts.at[(spans - INT64_C(1)) * contacts.cols + INT64_C(2)] * (&p->bodies.at[last])->sigma) * contacts.at[(spans - INT64_C(1)) * contacts.cols + INT64_C(4)]);
    speed_out = (contacts.at[(spans - INT64_C(1)) * contacts.cols + INT64_C(2)] * y.at[(lay->omega + last)]);
    dy.at[(lay->flow + INT64_C(1))] = (((speed_out - wander) * share_a) / (1.0 + upstream));
    return choose_floats(spliced, behind, each_float(0.0));
}

static inline floats k_gravity_torque(floats gravity_moment_N_m, floats gravity_moment_angle_rad, floats sigma, floats theta_rad) {
    integers returned_ = each_bool(false);
    floats result_ = {0};
    const integers t1_ = ((integers)(gravity_moment_N_m == each_float(0.0)));
    const integers on2_ = t1_;
    if (any(on2_)) {
        result_ = choose_floats(on2_, each_float(0.0), result_);
        returned_ |= on2_;
    }
    const integers on3_ = ~returned_;
    if (any(on3_)) {
        result_ = choose_floats(on3_, (((-sigma) * gravity_moment_N_m) * lanes_cos((sigma * (theta_rad + gravity_moment_angle_rad)))), result_);
        returned_ |= on3_;
    }
    return result_;
}

static inline floats k_friction_torque(floats constant_N_m, floats viscous_N_m_s, floats omega_rad_s) {
    floats ratio = {0};
    floats level = {0};
    ratio = (omega_rad_s * (1.0 / 0.3));
    const integers t1_ = ((integers)(ratio > each_float(20.0)));
    const integers on2_ = t1_;
    if (any(on2_)) {
        level = choose_floats(on2_, each_float(1.0), level);
    }
    const integers on3_ = ~t1_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(ratio < each_float((-20.0))));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            level = choose_floats(on5_, each_float((-1.0)), level);
        }
        const integers on6_ = on3_ & ~t4_;
        if (any(on6_)) {
            level = choose_floats(on6_, lanes_tanh(ratio), level);
        }
    }
    return ((constant_N_m * level) + (viscous_N_m_s * omega_rad_s));
}

static inline floats k_ripple_torque(const LineArrays * p, int64_t d, floats theta_rad) {
    floats torque = {0};
    RIPPLE * term = {0};
    floats turn = {0};
    torque = each_float(0.0);
    const int64_t t1_ = p->ripples.n;
    for (int64_t r = 0; r < t1_; r++) {
        term = (&p->ripples.at[r]);
        const integers t2_ = ((integers)(term->drive == each_int(d)));
        const integers on3_ = t2_;
        if (any(on3_)) {
            turn = choose_floats(on3_, (term->order * theta_rad), turn);
            torque = choose_floats(on3_, (torque + ((term->cos_N_m * lanes_cos(turn)) + (term->sin_N_m * lanes_sin(turn)))), torque);
        }
    }
    return torque;
}

static inline floats k_shaft_torque(floats stiffness_N_m, floats damping_N_m_s, floats backlash_rad, floats twist, floats rate) {
    floats half = {0};
    integers returned_ = each_bool(false);
    floats result_ = {0};
    half = (0.5 * backlash_rad);
    const integers t1_ = ((integers)(twist > half));
    const integers on2_ = t1_;
    if (any(on2_)) {
        result_ = choose_floats(on2_, ((stiffness_N_m * (twist - half)) + (damping_N_m_s * rate)), result_);
        returned_ |= on2_;
    }
    const integers on3_ = ~returned_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(twist < (-half)));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            result_ = choose_floats(on5_, ((stiffness_N_m * (twist + half)) + (damping_N_m_s * rate)), result_);
            returned_ |= on5_;
        }
        const integers on6_ = on3_ & ~returned_;
        if (any(on6_)) {
            result_ = choose_floats(on6_, each_float(0.0), result_);
            returned_ |= on6_;
        }
    }
    return result_;
}

static inline void k_shafts(const LineArrays * p, const Layout * lay, float_lanes_1 y, float_lanes_1 torques, float_lanes_1 dy) {
    DRIVE * drive = {0};
    integers k = {0};
    floats motor = {0};
    floats rate = {0};
    floats through = {0};
    floats motor_inertia = {0};
    floats full = {0};
    const int64_t t1_ = p->drives.n;
    integers broken276_ = each_bool(false);
    for (int64_t d = 0; d < t1_; d++) {
        integers skipped276_ = each_bool(false);
        const integers on2_ = ~broken276_ & ~skipped276_;
        if (!any(on2_)) break;
        drive = (&p->drives.at[d]);
        k = choose_integers(on2_, each_int(drive->body[0]), k);
        motor = choose_floats(on2_, (torques.at[d] + k_ripple_torque(p, d, gather_floats(y.at, choose_integers(on2_, (lay->theta + k), each_int(INT64_C(0)))))), motor);
        const integers t3_ = ((integers)(drive->shaft_stiffness_N_m == each_float(0.0)));
        const integers on4_ = on2_ & t3_;
        if (any(on4_)) {
            scatter_floats(on4_, dy.at, choose_integers(on4_, (lay->omega + k), each_int(INT64_C(0))), (gather_floats(dy.at, choose_integers(on4_, (lay->omega + k), each_int(INT64_C(0)))) + motor));
            skipped276_ |= on4_;
        }
        const integers on5_ = on2_ & ~broken276_ & ~skipped276_;
        if (any(on5_)) {
            rate = choose_floats(on5_, (y.at[(lay->motor + d)] - gather_floats(y.at, choose_integers(on5_, (lay->omega + k), each_int(INT64_C(0))))), rate);
            through = choose_floats(on5_, k_shaft_torque(drive->shaft_stiffness_N_m, drive->shaft_damping_N_m_s, drive->shaft_backlash_rad, y.at[(lay->twist + d)], rate), through);
            motor_inertia = choose_floats(on5_, (drive->motor_share * gather_floats(&((BODY_each){p->bodies.at, choose_integers(on5_, k, each_int(INT64_C(0)))}).at->inertia_kg_m2, ((BODY_each){p->bodies.at, choose_integers(on5_, k, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(BODY) / sizeof(floats)))), motor_inertia);
            full = choose_floats(on5_, gather_floats(&((BODY_each){p->bodies.at, choose_integers(on5_, k, each_int(INT64_C(0)))}).at->inertia_kg_m2, ((BODY_each){p->bodies.at, choose_integers(on5_, k, each_int(INT64_C(0)))}).index * (int64_t)(sizeof(BODY) / sizeof(floats))), full);
            const integers t6_ = ((integers)(k == each_int(INT64_C(0))));
            const integers on7_ = on5_ & t6_;
            if (any(on7_)) {
                full = choose_floats(on7_, k_roll_inertia(p, full, y.at[lay->radius]), full);
            }
            const integers on8_ = on5_ & ~t6_;
            if (any(on8_)) {
                const integers t9_ = ((integers)(k == each_int((lay->n - INT64_C(1)))));
                const integers on10_ = on8_ & t9_;
                if (any(on10_)) {
                    full = choose_floats(on10_, k_roll_inertia(p, full, y.at[(lay->radius + INT64_C(1))]), full);
                }
            }
            scatter_floats(on5_, dy.at, choose_integers(on5_, (lay->omega + k), each_int(INT64_C(0))), (((gather_floats(dy.at, choose_integers(on5_, (lay->omega + k), each_int(INT64_C(0)))) + through) * full) / (full - motor_inertia)));
            dy.at[(lay->motor + d)] = choose_floats(on5_, ((motor - through) / motor_inertia), dy.at[(lay->motor + d)]);
            dy.at[(lay->twist + d)] = choose_floats(on5_, rate, dy.at[(lay->twist + d)]);
        }
    }
}

static inline void k_body_rates(const LineArrays * p, const Layout * lay, float_lanes_1 y, float_lanes_2 contacts, float_lanes_1 tensions, float_lanes_1 torques, float_lanes_1 dy) {
    int64_t last = 0;
    BODY * body = {0};
    floats omega = {0};
    floats torque = {0};
    floats inertia = {0};
    last = (lay->n - INT64_C(1));
    const int64_t t1_ = lay->n;
    for (int64_t k = 0; k < t1_; k++) {
        body = (&p->bodies.at[k]);
        omega = y.at[(lay->omega + k)];
        torque = (k_gravity_torque(body->gravity_moment_N_m, body->gravity_moment_angle_rad, body->sigma, y.at[(lay->theta + k)]) - k_friction_torque(body->friction_constant_N_m, body->friction_viscous_N_m_s, omega));
        if ((k > INT64_C(0))) {
            torque = (torque - ((contacts.at[(k - INT64_C(1)) * contacts.cols + INT64_C(2)] + contacts.at[(k - INT64_C(1)) * contacts.cols + INT64_C(5)]) * tensions.at[(k - INT64_C(1))]));
        }
        if (((INT64_C(0) < k) && (k < last))) {
            torque = (torque + ((contacts.at[k * contacts.cols + INT64_C(1)] + contacts.at[(k - INT64_C(1)) * contacts.cols + INT64_C(5)]) * tensions.at[k]));
        } else {
            if ((k == INT64_C(0))) {
                torque = (torque + (contacts.at[INT64_C(0) * contacts.cols + INT64_C(1)] * tensions.at[INT64_C(0)]));
            }
        }
        dy.at[(lay->theta + k)] = omega;
        dy.at[(lay->omega + k)] = torque;
    }
    k_shafts(p, lay, y, torques, dy);
    const int64_t t2_ = lay->n;
    for (int64_t k = 0; k < t2_; k++) {
        inertia = (&p->bodies.at[k])->inertia_kg_m2;
        if ((k == INT64_C(0))) {
            inertia = k_roll_inertia(p, inertia, y.at[lay->radius]);
        } else {
            if ((k == last)) {
                inertia = k_roll_inertia(p, inertia, y.at[(lay->radius + INT64_C(1))]);
            }
        }
        dy.at[(lay->omega + k)] = (dy.at[(lay->omega + k)] / inertia);
    }
}

static inline void k_bounce_rates(const LineArrays * p, const Layout * lay, float_lanes_1 y, floats pull_N, float_lanes_1 dy, const integers lanes_) {
    WEB * web = {0};
    floats w = {0};
    floats turn = {0};
    floats high = {0};
    floats unbalance = {0};
    floats force = {0};
    web = (&p->web.at[INT64_C(0)]);
    w = ((2.0 * 3.141592653589793) * web->bounce_Hz);
    const floats t1_ = y.at[lay->theta];
    const floats t2_ = (web->bounce_order * y.at[lay->theta]);
    turn = t1_;
    high = t2_;
    unbalance = choose_floats(lanes_, ((web->bounce_cos1_kg_m * lanes_cos(turn)) + (web->bounce_sin1_kg_m * lanes_sin(turn))), unbalance);
    unbalance = choose_floats(lanes_, (unbalance + ((web->bounce_cosn_kg_m * lanes_cos(high)) + (web->bounce_sinn_kg_m * lanes_sin(high)))), unbalance);
    force = ((unbalance * y.at[lay->omega]) * y.at[lay->omega]);
    dy.at[lay->bounce] = choose_floats(lanes_, y.at[(lay->bounce + INT64_C(1))], dy.at[lay->bounce]);
    dy.at[(lay->bounce + INT64_C(1))] = choose_floats(lanes_, ((((pull_N + force) / web->bounce_mass_kg) - ((w * w) * y.at[lay->bounce])) - (((2.0 * web->bounce_damping) * w) * y.at[(lay->bounce + INT64_C(1))])), dy.at[(lay->bounce + INT64_C(1))]);
}

static inline floats k_friction_force(floats constant_N, floats viscous_N_s_m, floats speed_m_s) {
    return ((constant_N * lanes_tanh((speed_m_s * (1.0 / 0.005)))) + (viscous_N_s_m * speed_m_s));
}

static inline floats k_buffer_force(floats mass_kg, floats from_m, floats to_m, floats travel_m, floats speed_m_s) {
    floats stiffness = {0};
    floats damping = {0};
    integers returned_ = each_bool(false);
    floats result_ = {0};
    stiffness = ((mass_kg * 100.0) * 100.0);
    damping = ((2.0 * mass_kg) * 100.0);
    const integers t1_ = ((integers)(travel_m > to_m));
    const integers on2_ = t1_;
    if (any(on2_)) {
        result_ = choose_floats(on2_, least_floats(each_float(0.0), (((-stiffness) * (travel_m - to_m)) - (damping * speed_m_s))), result_);
        returned_ |= on2_;
    }
    const integers on3_ = ~returned_;
    if (any(on3_)) {
        const integers t4_ = ((integers)(travel_m < from_m));
        const integers on5_ = on3_ & t4_;
        if (any(on5_)) {
            result_ = choose_floats(on5_, largest_floats(each_float(0.0), (((-stiffness) * (travel_m - from_m)) - (damping * speed_m_s))), result_);
            returned_ |= on5_;
        }
        const integers on6_ = on3_ & ~returned_;
        if (any(on6_)) {
            result_ = choose_floats(on6_, each_float(0.0), result_);
            returned_ |= on6_;
        }
    }
    return result_;
}

static inline void k_carriage_rates(const LineArrays * p, const Layout * lay, float_lanes_1 y, float_lanes_1 forces, float_lanes_2 contacts, float_lanes_1 tensions, float_lanes_1 dy) {
    CARRIAGE * carriage = {0};
    int64_t at = 0;
    floats travel = {0};
    floats speed = {0};
    floats rise = {0};
    floats force = {0};
    int64_t before = 0;
    int64_t after = 0;
    const int64_t t1_ = p->carriages.n;
    for (int64_t c = 0; c < t1_; c++) {
        carriage = (&p->carriages.at[c]);
        at = (lay->carriage + (INT64_C(2) * c));
        const floats t2_ = y.at[at];
        const floats t3_ = y.at[(at + INT64_C(1))];
        travel = t2_;
        speed = t3_;
        const group_FFFF t4_ = k_moved_point(p, c, travel, carriage->weight_x_m, carriage->weight_y_m);
        rise = t4_.part3;
        force = ((carriage->load_N + forces.at[c]) - (carriage->stiffness_N_m * travel));
        force = (force - k_friction_force(carriage->friction_N, carriage->damping_N_s_m, speed));
        force = (force + k_buffer_force(carriage->mass_kg, carriage->from_m, carriage->to_m, travel, speed));
        dy.at[at] = speed;
        dy.at[(at + INT64_C(1))] = (force - (carriage->weight_N * rise));
    }
    const int64_t t5_ = (lay->n - INT64_C(1));
    for (int64_t i = 0; i < t5_; i++) {
        const int64_t t6_ = (&p->bodies.at[i])->carriage[0];
        const int64_t t7_ = (&p->bodies.at[(i + INT64_C(1))])->carriage[0];
        before = t6_;
        after = t7_;
        if ((before >= INT64_C(0))) {
            dy.at[((lay->carriage + (INT64_C(2) * before)) + INT64_C(1))] = (dy.at[((lay->carriage + (INT64_C(2) * before)) + INT64_C(1))] + (contacts.at[i * contacts.cols + INT64_C(6)] * tensions.at[i]));
        }
        if ((after >= INT64_C(0))) {
            dy.at[((lay->carriage + (INT64_C(2) * after)) + INT64_C(1))] = (dy.at[((lay->carriage + (INT64_C(2) * after)) + INT64_C(1))] - (contacts.at[i * contacts.cols + INT64_C(7)] * tensions.at[i]));
        }
    }
    const int64_t t8_ = p->carriages.n;
    for (int64_t c = 0; c < t8_; c++) {
        dy.at[((lay->carriage + (INT64_C(2) * c)) + INT64_C(1))] = (dy.at[((lay->carriage + (INT64_C(2) * c)) + INT64_C(1))] / (&p->carriages.at[c])->mass_kg);
    }
}

static inline group_FF k_resonance_rates(floats frequency_Hz, floats damping, floats input_N, floats output_N, floats rate_N_s) {
    floats w = {0};
    w = ((2.0 * 3.141592653589793) * frequency_Hz);
    const group_FF t1_ = (group_FF){rate_N_s, (((w * w) * (input_N - output_N)) - (((2.0 * damping) * w) * rate_N_s))};
    return t1_;
}

static inline floats k_filter_rate(floats corner_Hz, floats input_N, floats output_N) {
    return (((2.0 * 3.141592653589793) * corner_Hz) * (input_N - output_N));
}

static inline void k_sensor_rates(const LineArrays * p, const Layout * lay, float_lanes_1 y, float_lanes_1 tensions, float_lanes_1 dy) {
    CELL * cell = {0};
    int64_t k = 0;
    floats pull = {0};
    floats omega = {0};
    floats turn = {0};
    integers at = {0};
    floats rate = {0};
    floats acceleration = {0};
    const int64_t t1_ = p->cells.n;
    for (int64_t c = 0; c < t1_; c++) {
        cell = (&p->cells.at[c]);
        k = cell->body[0];
        pull = (0.5 * (tensions.at[(k - INT64_C(1))] + tensions.at[k]));
        const integers t2_ = ((integers)(cell->unbalance_kg_m != each_float(0.0)));
        const integers on3_ = t2_;
        if (any(on3_)) {
            omega = choose_floats(on3_, y.at[(lay->omega + k)], omega);
            turn = choose_floats(on3_, (y.at[(lay->theta + k)] + cell->unbalance_angle_rad), turn);
            pull = choose_floats(on3_, (pull + (((cell->unbalance_kg_m * omega) * omega) * lanes_cos(turn))), pull);
        }
        const integers t4_ = ((integers)(cell->resonance_Hz > each_float(0.0)));
        const integers on5_ = t4_;
        if (any(on5_)) {
            at = choose_integers(on5_, each_int((lay->resonance + (INT64_C(2) * c))), at);
            const group_FF t6_ = k_resonance_rates(cell->resonance_Hz, cell->resonance_damping, pull, gather_floats(y.at, choose_integers(on5_, at, each_int(INT64_C(0)))), gather_floats(y.at, choose_integers(on5_, (at + INT64_C(1)), each_int(INT64_C(0)))));
            rate = choose_floats(on5_, t6_.part0, rate);
            acceleration = choose_floats(on5_, t6_.part1, acceleration);
            scatter_floats(on5_, dy.at, choose_integers(on5_, at, each_int(INT64_C(0))), rate);
            scatter_floats(on5_, dy.at, choose_integers(on5_, (at + INT64_C(1)), each_int(INT64_C(0))), acceleration);
            pull = choose_floats(on5_, gather_floats(y.at, choose_integers(on5_, at, each_int(INT64_C(0)))), pull);
        }
        dy.at[(lay->cell + c)] = k_filter_rate(cell->corner_Hz, pull, y.at[(lay->cell + c)]);
    }
}

static inline void k_derivative(const LineArrays * p, const Layout * lay, const LineState * s, float_lanes_1 y, float_lanes_1 moving, float_lanes_2 contacts, float_lanes_1 tensions, float_lanes_1 dy, bool more) {
    floats behind = {0};
    WEB * web = {0};
    floats unwinding = {0};
    floats rewinding = {0};
    const floats t1_ = k_span_tensions(p, lay, y, moving, s->phi_rad, contacts, tensions, dy, more);
    behind = t1_;
    k_body_rates(p, lay, y, contacts, tensions, s->torque_N_m, dy);
    web = (&p->web.at[INT64_C(0)]);
    const floats t2_ = web->thickness_m;
    unwinding = t2_;
    rewinding = t2_;
    const integers t3_ = ((integers)(web->splice_thickness_ratio != each_float(1.0)));
    const integers on4_ = t3_;
    if (any(on4_)) {
        const integers t5_ = ((integers)(y.at[lay->flow] > web->splice_m));
        const integers on6_ = on4_ & t5_;
        if (any(on6_)) {
            unwinding = choose_floats(on6_, (unwinding * web->splice_thickness_ratio), unwinding);
        }
        const integers t7_ = ((integers)(behind > each_float(0.0)));
        const integers on8_ = on4_ & t7_;
        if (any(on8_)) {
            rewinding = choose_floats(on8_, (rewinding * web->splice_thickness_ratio), rewinding);
        }
    }
    dy.at[lay->radius] = k_growth(INT64_C(2), unwinding, y.at[lay->omega]);
    dy.at[(lay->radius + INT64_C(1))] = k_growth(INT64_C(3), rewinding, y.at[((lay->omega + lay->n) - INT64_C(1))]);
    const integers t9_ = ((integers)(web->bounce_mass_kg > each_float(0.0)));
    const integers on10_ = t9_;
    if (any(on10_)) {
        k_bounce_rates(p, lay, y, tensions.at[INT64_C(0)], dy, on10_);
    }
    if (more) {
        k_carriage_rates(p, lay, y, s->carriage_force_N, contacts, tensions, dy);
    }
    k_sensor_rates(p, lay, y, tensions, dy);
}

static inline void k_slope_with_more(const LineArrays * p, const Layout * lay, const LineState * s, const Work * w, float_lanes_1 y, float_lanes_1 dy) {
    k_derivative(p, lay, s, y, w->moving, w->contacts, w->tensions, dy, true);
}

static inline void k_slope(const LineArrays * p, const Layout * lay, const LineState * s, const Work * w, float_lanes_1 y, float_lanes_1 dy) {
    if (((p->carriages.n > INT64_C(0)) || (p->heats.n > INT64_C(0)))) {
        k_slope_with_more(p, lay, s, w, y, dy);
    } else {
        k_derivative(p, lay, s, y, w->moving, w->contacts, w->tensions, dy, false);
    }
}

static inline void k_turn_spans(const LineState * s, const Work * w, double ahead_s) {
    const int64_t t1_ = w->moving.n;
    for (int64_t i = 0; i < t1_; i++) {
        const integers t2_ = ((integers)(w->moving.at[i] != each_float(0.0)));
        const integers on3_ = t2_;
        if (any(on3_)) {
            s->phi_rad.at[i] = choose_floats(on3_, (s->phi_rad.at[i] + (ahead_s * w->contacts.at[i * w->contacts.cols + INT64_C(4)])), s->phi_rad.at[i]);
        }
    }
}

static inline void k_rk4(const LineArrays * p, const Layout * lay, const LineState * s, const Work * w, double dt_s) {
    float_lanes_1 y = {0};
    float_lanes_1 trial = {0};
    double half = 0;
    float_lanes_1 k1 = {0};
    float_lanes_1 k2 = {0};
    float_lanes_1 k3 = {0};
    float_lanes_1 k4 = {0};
    double sixth = 0;
    const float_lanes_1 t1_ = s->y;
    const float_lanes_1 t2_ = w->trial;
    const double t3_ = (0.5 * dt_s);
    y = t1_;
    trial = t2_;
    half = t3_;
    const float_lanes_1 t4_ = ((float_lanes_1){w->rates.at + INT64_C(0) * w->rates.cols, w->rates.cols});
    const float_lanes_1 t5_ = ((float_lanes_1){w->rates.at + INT64_C(1) * w->rates.cols, w->rates.cols});
    const float_lanes_1 t6_ = ((float_lanes_1){w->rates.at + INT64_C(2) * w->rates.cols, w->rates.cols});
    const float_lanes_1 t7_ = ((float_lanes_1){w->rates.at + INT64_C(3) * w->rates.cols, w->rates.cols});
    k1 = t4_;
    k2 = t5_;
    k3 = t6_;
    k4 = t7_;
    k_slope(p, lay, s, w, y, k1);
    k_turn_spans(s, w, half);
    const int64_t t8_ = y.n;
    for (int64_t j = 0; j < t8_; j++) {
        trial.at[j] = (y.at[j] + (half * k1.at[j]));
    }
    k_slope(p, lay, s, w, trial, k2);
    const int64_t t9_ = y.n;
    for (int64_t j = 0; j < t9_; j++) {
        trial.at[j] = (y.at[j] + (half * k2.at[j]));
    }
    k_slope(p, lay, s, w, trial, k3);
    k_turn_spans(s, w, half);
    const int64_t t10_ = y.n;
    for (int64_t j = 0; j < t10_; j++) {
        trial.at[j] = (y.at[j] + (dt_s * k3.at[j]));
    }
    k_slope(p, lay, s, w, trial, k4);
    sixth = (dt_s / 6.0);
    const int64_t t11_ = y.n;
    for (int64_t j = 0; j < t11_; j++) {
        y.at[j] = (y.at[j] + (sixth * ((k1.at[j] + (2.0 * (k2.at[j] + k3.at[j]))) + k4.at[j])));
    }
}

static inline floats k_encoder_speed2(const LineArrays * p, const Layout * lay, const LineState * s, int64_t d, double share) {
    DRIVE * drive = {0};
    int64_t k = 0;
    integers stiff = {0};
    floats omega = {0};
    floats eccentricity = {0};
    floats turn = {0};
    drive = (&p->drives.at[d]);
    k = drive->body[0];
    stiff = ((integers)(drive->shaft_stiffness_N_m == each_float(0.0)));
    omega = choose_floats(stiff, s->y.at[(lay->omega + k)], s->y.at[(lay->motor + d)]);
    eccentricity = (share * drive->encoder_offset_ratio);
    const integers t1_ = ((integers)(eccentricity != each_float(0.0)));
    const integers on2_ = t1_;
    if (any(on2_)) {
        turn = ((s->y.at[(lay->theta + k)] + s->y.at[(lay->twist + d)]) + drive->encoder_angle_rad);
        omega = choose_floats(on2_, (omega * (1.0 + (eccentricity * lanes_cos(turn)))), omega);
    }
    return omega;
}

static inline void k_measure(const LineArrays * p, const Layout * lay, const LineState * s, float_lanes_1 noise) {
    int64_t cells = 0;
    bool noisy = 0;
    CELL * cell = {0};
    floats true_ = {0};
    floats turn = {0};
    floats speed = {0};
    DRIVE * drive = {0};
    cells = p->cells.n;
    noisy = ((&p->timing.at[INT64_C(0)])->noisy[0] != INT64_C(0));
    const int64_t t1_ = cells;
    for (int64_t c = 0; c < t1_; c++) {
        cell = (&p->cells.at[c]);
        true_ = ((cell->gain * s->y.at[(lay->cell + c)]) + cell->offset_N);
        const integers t2_ = ((integers)(cell->hum_N != each_float(0.0)));
        const integers on3_ = t2_;
        if (any(on3_)) {
            turn = choose_floats(on3_, ((((2.0 * 3.141592653589793) * cell->hum_Hz) * s->time_s.at[INT64_C(0)]) + cell->hum_phase_rad), turn);
            true_ = choose_floats(on3_, (true_ + (cell->hum_N * lanes_cos(turn))), true_);
        }
        s->true_N.at[c] = true_;
        if (noisy) {
            s->measured_N.at[c] = k_quantise((true_ + (cell->noise_N * noise.at[c])), cell->lsb_N);
        } else {
            s->measured_N.at[c] = k_expected_quantise(true_, cell->lsb_N, cell->noise_N);
        }
    }
    const int64_t t4_ = p->drives.n;
    for (int64_t d = 0; d < t4_; d++) {
        speed = k_encoder_speed2(p, lay, s, d, 1.0);
        if (noisy) {
            drive = (&p->drives.at[d]);
            speed = k_quantise((speed + (drive->noise_rad_s * noise.at[(cells + d)])), drive->lsb_rad_s);
        }
        s->measured_rad_s.at[d] = speed;
    }
}

static inline void k_advance_frame(const LineArrays * p, const Layout * lay, const LineState * s, const Work * w, double line_speed_m_s, double line_speed_end_m_s, float_1 tension_ref_N, float_1 aff_m_s, float_lanes_1 noise) {
    TIMING * timing = {0};
    double frame_s = 0;
    int64_t drives = 0;
    int64_t sensors = 0;
    double dt = 0;
    int64_t at = 0;
    double share = 0;
    double speed = 0;
    timing = (&p->timing.at[INT64_C(0)]);
    frame_s = (((double)(timing->ticks_per_frame[0])) * timing->drive_tick_s[0]);
    k_keep_changes(p, s->time_s.at[INT64_C(0)]);
    if ((modulo_int(s->counters.at[INT64_C(0)], timing->frames_per_loop[0]) == INT64_C(0))) {
        k_run_loops(p, lay, s, tension_ref_N, (((double)(timing->frames_per_loop[0])) * frame_s));
    }
    drives = p->drives.n;
    sensors = (p->cells.n + drives);
    dt = (timing->drive_tick_s[0] / ((double)(timing->substeps[0])));
    const int64_t t1_ = timing->ticks_per_frame[0];
    for (int64_t tick = 0; tick < t1_; tick++) {
        at = (sensors + (tick * drives));
        share = (((double)(tick)) / ((double)(timing->ticks_per_frame[0])));
        speed = (line_speed_m_s + (share * (line_speed_end_m_s - line_speed_m_s)));
        k_keep_changes(p, (s->time_s.at[INT64_C(0)] + (((double)(tick)) * timing->drive_tick_s[0])));
        k_run_drives(p, lay, s, speed, aff_m_s, ((float_lanes_1){noise.at + (at), ((at + drives)) - (at)}));
        if ((p->carriages.n > INT64_C(0))) {
            k_drive_carriages(p, lay, s);
        }
        const int64_t t2_ = timing->substeps[0];
        for (int64_t n3_ = 0; n3_ < t2_; n3_++) {
            k_rk4(p, lay, s, w, dt);
        }
    }
    s->counters.at[INT64_C(0)] = (s->counters.at[INT64_C(0)] + INT64_C(1));
    s->time_s.at[INT64_C(0)] = (((double)(s->counters.at[INT64_C(0)])) * frame_s);
    k_measure(p, lay, s, ((float_lanes_1){noise.at + (INT64_C(0)), (sensors) - (INT64_C(0))}));
}

static inline LogLayout k_log_layout(int64_t cells, int64_t drives, int64_t bodies, int64_t carriages) {
    int64_t speeds = 0;
    int64_t angles = 0;
    int64_t radii = 0;
    int64_t tensions = 0;
    int64_t travels = 0;
    int64_t encoders = 0;
    speeds = (INT64_C(3) * cells);
    angles = (speeds + (INT64_C(2) * drives));
    radii = (angles + bodies);
    tensions = (radii + INT64_C(2));
    travels = ((tensions + bodies) - INT64_C(1));
    encoders = (travels + carriages);
    return ((LogLayout){INT64_C(0), cells, (INT64_C(2) * cells), speeds, (speeds + drives), angles, radii, tensions, travels, encoders, (encoders + drives)});
}

static inline void k_log_frame(const LineArrays * p, const Layout * lay, const LineState * s, const Work * w, float_lanes_1 row) {
    const LogLayout * at = {0};
    int64_t k = 0;
    const LogLayout t1_ = k_log_layout(p->cells.n, p->drives.n, lay->n, p->carriages.n);
    at = (&t1_);
    const int64_t t2_ = p->cells.n;
    for (int64_t c = 0; c < t2_; c++) {
        k = (&p->cells.at[c])->body[0];
        row.at[(at->measured_N + c)] = s->measured_N.at[c];
        row.at[(at->true_N + c)] = s->true_N.at[c];
        row.at[(at->mean_N + c)] = (0.5 * (w->tensions.at[(k - INT64_C(1))] + w->tensions.at[k]));
    }
    const int64_t t3_ = p->drives.n;
    for (int64_t d = 0; d < t3_; d++) {
        row.at[(at->measured_rad_s + d)] = s->measured_rad_s.at[d];
        k = (&p->drives.at[d])->body[0];
        row.at[(at->true_rad_s + d)] = s->y.at[(lay->omega + k)];
        row.at[(at->encoder_rad + d)] = (s->y.at[(lay->theta + k)] + s->y.at[(lay->twist + d)]);
    }
    const int64_t t4_ = lay->n;
    for (int64_t k = 0; k < t4_; k++) {
        row.at[(at->theta_rad + k)] = s->y.at[(lay->theta + k)];
    }
    row.at[at->radius_m] = s->y.at[lay->radius];
    row.at[(at->radius_m + INT64_C(1))] = s->y.at[(lay->radius + INT64_C(1))];
    const int64_t t5_ = (lay->n - INT64_C(1));
    for (int64_t i = 0; i < t5_; i++) {
        row.at[(at->tension_N + i)] = w->tensions.at[i];
    }
    const int64_t t6_ = p->carriages.n;
    for (int64_t c = 0; c < t6_; c++) {
        row.at[(at->travel_m + c)] = s->y.at[(lay->carriage + (INT64_C(2) * c))];
    }
}

/* Runs as many frames as line_speed has rows. After each `every`-th frame (0: never) the log's
   `columns` go to the next row of out. References and corrections are those of all lanes. */
void line_frames(
    const LineArrays *p, const Layout *lay, const LineState *s, const Work *w,
    const float_2 *line_speed_m_s, const float_2 *tension_ref_N, const float_2 *aff_m_s,
    const float_lanes_2 *noise, const float_lanes_1 *row, const int_1 *columns, int64_t every,
    const float_lanes_2 *out) {
    for (int64_t f = 0; f < line_speed_m_s->rows; f++) {
        const double *speed = line_speed_m_s->at + f * line_speed_m_s->cols;
        const float_1 tension = {tension_ref_N->at + f * tension_ref_N->cols, tension_ref_N->cols};
        const float_1 aff = {aff_m_s->at + f * aff_m_s->cols, aff_m_s->cols};
        const float_lanes_1 noises = {noise->at + f % noise->rows * noise->cols, noise->cols};
        k_advance_frame(p, lay, s, w, speed[0], speed[1], tension, aff, noises);
        if (every == 0 || (f + 1) % every != 0) continue;
        k_log_frame(p, lay, s, w, *row);
        floats *to = out->at + (f / every) * out->cols;
        for (int64_t c = 0; c < columns->n; c++) to[c] = row->at[columns->at[c]];
    }
}

int64_t line_lanes(void) { return LANES; }
const char *line_source(void) { return SOURCE; }
bool line_works(void); /* on this processor */
