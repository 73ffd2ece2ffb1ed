#include "arithmetic.h"

#include <math.h>
#include <string.h>

/* Where the compiler can, one build holds several versions of a loop and takes the processor's. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define WIDE
#endif

/* np.maximum, np.minimum: NaN goes through */
static inline double most(double a, double b) { return a >= b || a != a ? a : b; }
static inline double least(double a, double b) { return a <= b || a != a ? a : b; }
static inline double size_of(const double *z) { return sqrt(z[0] * z[0] + z[1] * z[1]); }

/* ---- the loop's convolution ---- */

/* four doubles, in as many registers as the processor needs for them */
typedef double four __attribute__((vector_size(32), aligned(8)));

/* to[q][c] += sum_u taps[u - q] from[u][c] for four columns c and half a block of q */
static inline __attribute__((always_inline)) void add_strip(
    double *to, const double *from, const double *taps, long rows, long row)
{
    enum { Q = BLOCK / 2 };
    four sum[Q];
    for (int q = 0; q < Q; q++) sum[q] = *(const four *)(to + q * row);
    for (long u = 0; u < rows; u++) {
        const four x = *(const four *)(from + u * row);
        for (int q = 0; q < Q; q++) sum[q] += taps[u - q] * x;
    }
    for (int q = 0; q < Q; q++) *(four *)(to + q * row) = sum[q];
}

/* between two ticks the cache held other data: ask for all of it at once, not as it is read */
static void fetch(const double *from, long count)
{
    for (long i = 0; i < count; i += 8) __builtin_prefetch(from + i);
}

WIDE static void add_tail(double *to, const double *from, const double *taps, long rows, long row)
{
    const long half = BLOCK / 2;
    fetch(to, BLOCK * row);
    fetch(from, rows * row);
    for (long c = 0; c < row; c += 4) {
        add_strip(to + c, from + c, taps, rows, row);
        add_strip(to + half * row + c, from + c, taps - half, rows, row);
    }
}

static void loop_append(loop_filter *p, double *first)
{
    const long row = p->row, at = p->place[0], done = at % BLOCK, start = at - done;
    const long share = p->length / BLOCK - 1, read = p->place[1];
    memcpy(first + p->length * row, first, row * sizeof *first);
    add_tail(p->tail + (1 - read) * BLOCK * row,
             p->ring + (start + BLOCK + done * share) * row,
             p->reversed + BLOCK + done * share, share, row);
    p->place[0] = (at + 1) % p->length;
    if (done + 1 == BLOCK) {
        memset(p->tail + read * BLOCK * row, 0, BLOCK * row * sizeof *first);
        p->place[1] = 1 - read;
    }
}

void loop_push(loop_filter *p, const double *b, const double *weight, double ratio, long ticks)
{
    const long half = p->row / 2;
    for (; ticks > 0; ticks--) {
        double *first = p->ring + p->place[0] * p->row, *sent = first + half;
        for (long i = 0; i < half; i += 2) {
            first[i] = b[i];
            first[i + 1] = b[i + 1];
            sent[i] = (weight[i] * b[i] - weight[i + 1] * b[i + 1]) * ratio;
            sent[i + 1] = (weight[i] * b[i + 1] + weight[i + 1] * b[i]) * ratio;
        }
        loop_append(p, first);
    }
}

WIDE void loop_read(const loop_filter *p, double *out)
{
    const long row = p->row, done = p->place[0] % BLOCK, start = p->place[0] - done;
    const double *newest = p->ring + (start + p->length - BLOCK) * row;
    const double *taps = p->reversed + p->length - done;
    memcpy(out, p->tail + (p->place[1] * BLOCK + done) * row, row * sizeof *out);
    for (long u = 0; u < BLOCK + done; u++) {
        const double tap = taps[u], *x = newest + u * row;
        for (long c = 0; c < row; c++) out[c] += tap * x[c];
    }
}

/* ---- the Kalman filter ---- */

/* P h; P is symmetric, so its rows stand for its columns */
WIDE static void times_vector(long size, const double *P, const double *h, double *to)
{
    memset(to, 0, size * sizeof *to);
    for (long i = 0; i < size; i++) {
        const double x = h[i], *row = P + i * size;
        for (long j = 0; j < size; j++) to[j] += x * row[j];
    }
}

WIDE static void take_square(long size, double *P, const double *k)
{
    for (long i = 0; i < size; i++) {
        const double x = k[i];
        double *row = P + i * size;
        for (long j = 0; j < size; j++) row[j] -= x * k[j];
    }
}

double filter_update(shape_filter *p, double error, const double *phi, double *psi, long first,
                     long imbalance)
{
    const long half = 2 * p->n, size = 2 * half + 1;
    double *h = p->h, *gain = p->gain, expected = 0.0, spread = 0.0;
    if (imbalance >= 0)
        for (int k = 0; k < 2; k++) {
            psi[2 * first + k] += psi[2 * imbalance + k];
            psi[2 * imbalance + k] = 0.0;
        }
    for (long i = 0; i < half; i += 2) {
        h[i] = phi[i], h[i + 1] = -phi[i + 1];
        h[half + i] = psi[i], h[half + i + 1] = -psi[i + 1];
    }
    for (long i = 0; i < size; i++) expected += h[i] * p->state[i];
    const double innovation = error - expected;
    times_vector(size, p->covariance, h, gain);
    for (long i = 0; i < size; i++) spread += h[i] * gain[i];
    spread += p->sd * p->sd;
    const double root = 1.0 / sqrt(spread), limit = p->news_limit;
    const double news = most(least(innovation / sqrt(spread), limit), -limit);
    for (long i = 0; i < size; i++) gain[i] *= root;
    take_square(size, p->covariance, gain);
    for (long i = 0; i < size; i++) p->state[i] += gain[i] * news;
    if (imbalance >= 0)
        for (int k = 0; k < 2; k++)
            p->state[half + 2 * imbalance + k] = p->state[half + 2 * first + k];
    return innovation;
}

/* variance that d gains on its way in frequency since the last note; column i alone */
static double travelled(shape_filter *p, const drift_numbers *c, const double *turn_s, long i)
{
    const double octaves = fabs(log2(turn_s[i] / p->turn_s[i]));
    if (octaves < c->travel_octaves) return 0.0;
    p->turn_s[i] = turn_s[i];
    return isfinite(octaves) ? c->per_octave * c->per_octave * octaves : 0.0;
}

void filter_predict(shape_filter *p, const drift_numbers *c, const double *phi,
                    const double *turn_s, double passed_s, double dt_s)
{
    const long n = p->n, size = 4 * n + 1;
    const double memory = p->memory_turns * p->memory_turns;
    for (long i = 0; i < size; i++) {
        const long column = (i / 2) % n;
        double noise;
        if (i == size - 1) {
            noise = c->bias * p->sd * (c->bias * p->sd) * passed_s;
        } else if (i < 2 * n) {
            double info = phi[2 * column] * phi[2 * column];
            info += phi[2 * column + 1] * phi[2 * column + 1];
            info *= 0.5 / (p->sd * p->sd);
            info *= turn_s[column] / dt_s;
            info += c->smallest;
            noise = p->drift[column] * (passed_s / turn_s[column]) / (info * memory);
        } else if (i % 2 == 0) {
            noise = c->per_turn * c->per_turn * (passed_s / turn_s[column]);
            noise += travelled(p, c, turn_s, column);
            p->gain[i + 1] = noise; /* the same for re and im */
        } else {
            noise = p->gain[i];
        }
        double *variance = p->covariance + i * (size + 1);
        const double room = most(1.0 - *variance / p->start[i], 0.0);
        *variance += least(noise, p->start[i]) * room;
    }
}

/* ---- the monitor ---- */

void monitor_hear(shape_monitor *p, const monitor_numbers *c, const double *turn_s,
                  double passed_s, double dt_s)
{
    for (long i = 0; i < p->n; i++) {
        const double tick = dt_s / turn_s[i];
        p->age[i] = least(p->age[i] + passed_s / turn_s[i], c->slow_turns);
        p->pull[i] = tick / least(most(p->age[i], most(tick, 1e-12)), c->turns);
        p->now[i] = size_of(p->phasor + 2 * i);
    }
}

WIDE void monitor_follow(shape_monitor *p, double error, const double *phi)
{
    for (long i = 0; i < p->n; i++) {
        const double *z = phi + 2 * i, size = most(size_of(z), 1e-9);
        double *phasor = p->phasor + 2 * i;
        p->size[i] = size;
        phasor[0] += (z[0] / size * (2.0 * error) - phasor[0]) * p->pull[i];
        phasor[1] += (-z[1] / size * (2.0 * error) - phasor[1]) * p->pull[i];
    }
}

int monitor_judge(shape_monitor *p, const monitor_numbers *c, const double *deviation,
                  const double *ratio, const double *turn_s, double passed_s, double dt_s,
                  double sd, long first, long imbalance)
{
    int calm = 1;
    for (long i = 0; i < p->n; i++) {
        const double turns = passed_s / turn_s[i], now = p->now[i];
        p->judged[i] += turns;
        const double memory = least(p->judged[i], c->slow_turns);
        p->slow[i] += turns / most(memory, most(turns, 1e-9)) * (now - p->slow[i]);
        const double without = p->without[i] = size_of(deviation + 2 * i) * p->size[i];
        const double noise = 2.0 * sd * sqrt(dt_s / (c->turns * turn_s[i]));
        const int bad = now > c->harm * without + 3.0 * noise && p->judged[i] > c->turns;
        p->bad[i] = bad && !p->meets[i] ? p->bad[i] + turns : 0.0;
        const int lost = size_of(ratio + 2 * i) < c->lost_ratio && now > c->lost_share * without;
        p->lost[i] = lost ? p->lost[i] + turns : 0.0;
        const int astray = p->lost[i] > c->lost_turns;
        if ((p->bad[i] > c->harm_turns || astray) && p->rest[i] <= 0.0) {
            p->astray[i] = astray;
            p->rest[i] = c->rest_turns;
            p->bad[i] = p->lost[i] = 0.0;
        } else {
            p->rest[i] = most(p->rest[i] - turns, 0.0);
        }
    }
    if (imbalance >= 0 && p->rest[first] > p->rest[imbalance]) {
        p->rest[imbalance] = p->rest[first];
        p->astray[imbalance] = p->astray[first];
    }
    for (long i = 0; i < p->n; i++) calm &= p->rest[i] == 0.0 && p->share[i] == 1.0;
    return calm;
}

/* ---- the basis ---- */

static const double TURN = 6.283185307179586;
enum { ANGLE, OMEGA, FIRST_RE, FIRST_IM, TURN_S, HZ };

/* core/shape/basis.py: _read_rolls, for one roll */
void basis_read(shape_basis *p, const basis_numbers *c, long roll, double radius_m,
                double theta_rad, double omega_rad_s, double speed_m_s, double slope_m_s2)
{
    const int known = radius_m > 0.0;
    double omega = known ? speed_m_s / radius_m : omega_rad_s, angle = 0.0;
    const double alpha = known ? slope_m_s2 / radius_m : 0.0;
    const double acts_at = theta_rad + omega_rad_s * c->lead_s;
    if (fabs(omega) < c->absurd && isfinite(acts_at))
        angle = remainder(acts_at, TURN);
    else
        omega = 0.0;
    const double size = fabs(omega);
    const double found[6] = {angle, omega, omega - (c->c * omega - alpha) / c->K,
                             omega * omega / c->K, TURN / most(size, 1e-6), size / TURN};
    for (long k = 0; k < 6; k++) p->per_roll[k * p->rolls + roll] = found[k];
}

void basis_step(shape_basis *p, const basis_numbers *numbers, double dt_s)
{
    const long n = p->n;
    const double keep = exp(-numbers->c * dt_s), fade_to_Hz = numbers->fade_to_Hz;
    const double half = 0.5 * (1.0 - keep), through = numbers->c / numbers->K;
    const double span = numbers->span;
    double *turns = p->turns;
    for (long i = 0; i < n; i++) {
        for (long k = 0; k < 6; k++) turns[k * n + i] = p->per_roll[k * p->rolls + p->roll_of[i]];
        const double order = p->order[i], omega = turns[OMEGA * n + i];
        p->frequency_Hz[i] = order * turns[HZ * n + i];
        p->fade[i] = least(most((fade_to_Hz - p->frequency_Hz[i]) * span, 0.0), 1.0);
        const double angle = order * turns[ANGLE * n + i];
        const double q[2] = {cos(angle), sin(angle)}, *arm = p->arm + 2 * i;
        const double core[2] = {p->owns[i] * turns[FIRST_RE * n + i] + arm[0],
                                order * turns[FIRST_IM * n + i] * p->owns[i] + arm[1]};
        double *low_z = p->low + 2 * i, *low_q = p->low + 2 * (n + i), *b = p->b + 2 * i;
        double *z = p->before + 2 * i, *was = p->before + 2 * (n + i);
        for (int k = 0; k < 2; k++) {
            low_z[k] = low_z[k] * keep + (omega * q[k] + z[k]) * half;
            low_q[k] = low_q[k] * keep + (q[k] + was[k]) * half;
            z[k] = omega * q[k];
            was[k] = q[k];
        }
        b[0] = core[0] * q[0] - core[1] * q[1] + p->owns[i] * low_z[0] * through;
        b[1] = core[0] * q[1] + core[1] * q[0] + p->owns[i] * low_z[1] * through;
        b[0] -= arm[0] * low_q[0] - arm[1] * low_q[1];
        b[1] -= arm[0] * low_q[1] + arm[1] * low_q[0];
        b[0] = -(b[0] * p->fade[i]);
        b[1] = -(b[1] * p->fade[i]);
    }
}

/* ---- what the law learns and sends ---- */

void newton_step(long n, double *weight, double *step_1_s, const double *deviation,
                 const double *ratio, const double *turn_s, const double *rest, const flag *held,
                 double newton_turns, double from, double to, double limit_m, double dt_s)
{
    double whole = 0.0;
    for (long i = 0; i < n; i++) {
        const double *d = ratio + 2 * i, size = size_of(d);
        double *w = weight + 2 * i;
        double share = -expm1(-dt_s / (newton_turns * turn_s[i]));
        share *= most(size, 1e-9) / least(most(size, from), to);
        const double re = (d[0] * w[0] - d[1] * w[1] + deviation[2 * i]) * share;
        const double im = (d[0] * w[1] + d[1] * w[0] + deviation[2 * i + 1]) * share;
        double move[2] = {0.0, 0.0};
        if (!(rest && rest[i] > 0.0) && !(held && held[i])) {
            const double power = d[0] * d[0] + d[1] * d[1];
            move[0] = (re * d[0] + im * d[1]) / power;
            move[1] = (im * d[0] - re * d[1]) / power;
        }
        w[0] -= move[0];
        w[1] -= move[1];
        whole += w[0] * w[0] + w[1] * w[1];
        step_1_s[i] = size_of(move) * (1.0 / dt_s);
    }
    if (!(whole > limit_m * limit_m)) return;
    for (long i = 0; i < n; i++) {
        const double share = limit_m / most(size_of(weight + 2 * i), limit_m);
        weight[2 * i] *= share;
        weight[2 * i + 1] *= share;
    }
}

/* the largest of a waveform and of its slope over the angle, from sums per order (re, im of both);
 * a quarter of the turn tells the whole: orders are even or odd about its ends */
WIDE static void largest(const peak_bound *p, const double *terms, double found[2])
{
    double *even[2], *odd[2];
    const long points = p->points;
    double *sums = p->sums + 4 * p->orders;
    memset(sums, 0, 8 * points * sizeof *sums);
    for (int which = 0; which < 2; which++) {
        for (int k = 0; k < 2; k++) {
            even[k] = sums + (4 * which + k) * points;
            odd[k] = sums + (4 * which + 2 + k) * points;
        }
        for (long o = 0; o < p->orders; o++) {
            const double re = terms[4 * o + 2 * which], im = terms[4 * o + 2 * which + 1];
            const double *cosine = p->cosines + o * points, *sine = p->sines + o * points;
            const int is_odd = fmod(p->order[o], 2.0) != 0.0;
            double *to_cosine = is_odd ? odd[0] : even[0], *to_sine = is_odd ? odd[1] : even[1];
            for (long i = 0; i < points; i++) to_cosine[i] += re * cosine[i];
            for (long i = 0; i < points; i++) to_sine[i] += im * sine[i];
        }
        double top = 0.0;
        for (long i = 0; i < points; i++) {
            top = most(fabs(even[0][i] + odd[0][i]) + fabs(even[1][i] + odd[1][i]), top);
            top = most(fabs(even[0][i] - odd[0][i]) + fabs(even[1][i] - odd[1][i]), top);
        }
        found[which] = top;
    }
}

void law_send(const sending *p, const peak_bound *bound, double gate, double ramp_s,
              double result[3])
{
    double value = 0.0, peak = 0.0, slew = 0.0, learning = 0.0, moving = 0.0, top[2];
    double *terms = bound->sums;
    memset(terms, 0, 4 * bound->orders * sizeof *terms);
    for (long i = 0; i < p->n; i++) {
        const double *w = p->weight + 2 * i, *b = p->b + 2 * i, *q = p->carrier + 2 * i;
        const double *f = p->factor + 2 * i;
        double *sent = p->sent + 2 * i, *part = p->parts + 2 * i;
        double shares = p->shares[0][i];
        for (int k = 1; k < 3; k++) shares *= p->shares[k][i];
        const double size = size_of(b), order = p->order[i];
        sent[0] = (w[0] * f[0] - w[1] * f[1]) * gate * shares;
        sent[1] = (w[0] * f[1] + w[1] * f[0]) * gate * shares;
        part[0] = sent[0] * b[0] - sent[1] * b[1];
        part[1] = sent[0] * b[1] + sent[1] * b[0];
        value += part[0];
        learning += p->step_1_s[i] * shares * size;
        moving += size_of(w) * size;
        if (bound->order_of[i] < 0) {
            peak += size_of(part);
            slew += size_of(part) * fabs(order * p->omega_rad_s[i]);
            continue;
        }
        double *term = terms + 4 * bound->order_of[i];
        const double re = q[0] * part[0] + q[1] * part[1], im = q[0] * part[1] - q[1] * part[0];
        term[0] += re, term[1] += im;
        term[2] -= im * order, term[3] += re * order;
    }
    largest(bound, terms, top);
    peak += bound->slack * top[0];
    slew += bound->slack * top[1] * fabs(p->omega_rad_s[p->at]);
    result[0] = value;
    result[1] = most(peak, fabs(value));
    result[2] = slew + learning + (ramp_s > 0.0 ? moving / ramp_s : 0.0);
}
