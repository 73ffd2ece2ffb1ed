/* The law's arithmetic, on plain arrays. Complex numbers are pairs of doubles, re and im.
 *
 * Every function is the equal of a numpy method, which says what the numbers mean; NaN goes
 * through as it does there. `n` counts columns (orders), nothing is allocated. */
#ifndef AFF_ARITHMETIC_H
#define AFF_ARITHMETIC_H

#include <stdint.h>

typedef uint8_t flag;

/* ---- core/shape/filter.py: LoopFilter ---- */
enum { BLOCK = 16 };

typedef struct {
    long length, row;        /* rows of the ring: a whole number of blocks; doubles in a row */
    double *ring;            /* (2 length, row): every row twice */
    double *tail;            /* (2, BLOCK, row): what is older than two blocks gives */
    double *reversed;        /* (BLOCK + length): zeros, then taps from the last to the first */
    int64_t *place;          /* row of the next sample, which of the two tails is read */
} loop_filter;

void loop_push(loop_filter *p, const double *b, const double *weight, double ratio, long ticks);
void loop_read(const loop_filter *p, double *out);

/* ---- core/shape/kalman.py: ShapeFilter ---- */
typedef struct {
    long n;                            /* columns; the state has 4 n + 1 entries */
    double *state, *covariance;        /* (size), (size, size) */
    double *h, *gain;                  /* (size): working space */
    const double *start, *drift;       /* (size), (n) */
    double *turn_s;                    /* (n): of the last note of a frequency */
    double sd, memory_turns, news_limit;
} shape_filter;

/* numbers of core/shape/kalman.py that prediction needs */
typedef struct {
    double smallest, per_turn, per_octave, travel_octaves, bias;
} drift_numbers;

double filter_update(shape_filter *p, double error, const double *phi, double *psi, long first,
                     long imbalance);
void filter_predict(shape_filter *p, const drift_numbers *c, const double *phi,
                    const double *turn_s, double passed_s, double dt_s);

/* ---- core/shape/monitor.py: ShapeMonitor ---- */
typedef struct {
    long n;
    double *phasor, *size, *pull, *now;                      /* complex (n), then (n) each */
    double *age, *slow, *bad, *lost, *judged, *rest, *without;
    flag *astray;
    const flag *meets;
    const double *share;
} shape_monitor;

/* turns of the lock-in's memory and of the slow mean; ratios and turns of its verdicts */
typedef struct {
    double turns, slow_turns, harm, harm_turns, lost_ratio, lost_share, lost_turns, rest_turns;
} monitor_numbers;

void monitor_hear(shape_monitor *p, const monitor_numbers *c, const double *turn_s,
                  double passed_s, double dt_s);
void monitor_follow(shape_monitor *p, double error, const double *phi);
int monitor_judge(shape_monitor *p, const monitor_numbers *c, const double *deviation,
                  const double *ratio, const double *turn_s, double passed_s, double dt_s,
                  double sd, long first, long imbalance);

/* ---- core/shape/basis.py: ShapeBasis ---- */
typedef struct {
    long n, rolls;
    double *per_roll;                  /* (6, rolls) */
    const int64_t *roll_of;            /* (n) */
    const double *order, *owns;        /* (n) */
    const double *arm;                 /* complex (n) */
    double *turns;                     /* (6, n) */
    double *low, *before;              /* complex (2, n) */
    double *b;                         /* complex (n) */
    double *fade, *frequency_Hz;       /* (n) */
} shape_basis;

/* K and corner c of the drive, rad/s; lead of a command; end of the band, one over the width of
 * its fade, 1/Hz; the speed (m/s, rad/s) that is none */
typedef struct {
    double K, c, lead_s, fade_to_Hz, span, absurd;
} basis_numbers;

void basis_read(shape_basis *p, const basis_numbers *c, long roll, double radius_m,
                double theta_rad, double omega_rad_s, double speed_m_s, double slope_m_s2);
void basis_step(shape_basis *p, const basis_numbers *numbers, double dt_s);

/* ---- core/shape/law.py and bounds.py ---- */
void newton_step(long n, double *weight, double *step_1_s, const double *deviation,
                 const double *ratio, const double *turn_s, const double *rest, const flag *held,
                 double newton_turns, double from, double to, double limit_m, double dt_s);

typedef struct {
    long points, orders;               /* of a quarter turn, with its ends; different orders */
    const double *cosines, *sines;     /* (orders, points) */
    const double *order;               /* (orders) */
    const int64_t *order_of;           /* (n): index into orders; -1 for another roll's column */
    double slack;
    double *sums;                      /* working space: 4 orders of doubles, 8 of points */
} peak_bound;

typedef struct {
    long n, at;                        /* at: a column of the own roll, for its speed */
    const double *weight, *b, *carrier, *factor;         /* complex */
    const double *shares[3];
    const double *step_1_s, *order, *omega_rad_s;
    double *sent, *parts;                                /* complex */
} sending;

void law_send(const sending *p, const peak_bound *bound, double gate, double ramp_s,
              double result[3]);

#endif
