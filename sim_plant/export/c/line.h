/* A line of fixed memory: parameters, state, inputs, outputs; settled, stepped, changed on the run.

   Arithmetic of a step is the kernel's (kernel.h). What stands here is written by hand after
   sim_plant/line (simulation.py, roll_change.py, channels.py), operation by operation.
   Nothing here allocates; a line is one block of memory that may be copied. */

/* products and sums round twice everywhere: before the arithmetic is read */
#if defined(_MSC_VER)
#pragma fp_contract(off)
#elif defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#pragma clang diagnostic ignored "-Wparentheses-equality"
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

#include "names.h"
#include "kernel.h"
#include "forms.h"
#include "line_data.h"

#define NOISE (CELLS + DRIVES * (1 + TICKS_PER_FRAME))
#define MOST_SUBSTEPS 32
#define MESSAGE 400

/* what is saved and restored: no pointers, members of eight bytes each */
typedef struct {
    line_numbers numbers;         /* arrays of the line, and what else an importer may set */
    line_state state;
    double line_speed_ref_m_s, tension_ref_N[LOOPS_], corrections[2 * DRIVES];
    int64_t splice, roll_change, splice_before, roll_change_before;
    double start_s, now_s;
    int64_t samples;
    int64_t phase, prepared, logging;
    uint64_t random;
    double theta0_rad[BODIES + DRIVES], row[ROW], outputs[OUTPUTS];
} line_memory;

typedef struct {
    line_memory memory;
    LineArrays p;
    LineState s;
    Work w;
    double rates[4 * STATES], trial[STATES], noise[NOISE];
    char message[MESSAGE];
} line;

static const Layout LAYOUT = LINE_LAYOUT;

/* numbers as exported; tables of shapes are never written */
static void line_as_exported(line *it) {
    memset(&it->memory, 0, sizeof it->memory);
    line_memory *m = &it->memory;
    m->numbers = NUMBERS;
    m->state = STATE;
    m->line_speed_ref_m_s = START_SPEED_M_S;
    for (int l = 0; l < LOOPS; l++) m->tension_ref_N[l] = START_TENSION_N;
}

static void line_connect(line *it) {
    line_numbers *n = &it->memory.numbers;
    line_state *s = &it->memory.state;
    it->p = (LineArrays){
        {n->bodies, BODIES}, {n->spans, SPANS}, {n->web, 1}, {n->drives, DRIVES},
        {n->cells, CELLS}, {n->loops, LOOPS}, {n->ripples, RIPPLES}, {n->changes, CHANGES},
        {n->heats, HEATS}, {n->carriages, CARRIAGES}, {n->timing, 1},
        {(double *)SHAPE_H, SHAPES, POINTS}, {(double *)SHAPE_DH, SHAPES, POINTS},
        {(double *)SHAPE_RHO, SHAPES, POINTS}};
    it->s = (LineState){
        {s->y, STATES}, {s->phi_rad, SPANS}, {s->drive_integral, DRIVES},
        {s->torque_N_m, DRIVES}, {s->reference_m_s, DRIVES}, {s->correction_m_s, DRIVES},
        {s->loop_integral, LOOPS}, {s->loop_correction_m_s, LOOPS}, {s->measured_N, CELLS},
        {s->true_N, CELLS}, {s->measured_rad_s, DRIVES},
        {s->carriage_integral_m, CARRIAGES}, {s->carriage_force_N, CARRIAGES},
        {s->delay_m_s, DRIVES, RING}, {s->counters, 2}, {s->time_s, 1}};
    it->w = (Work){
        {s->moving, SPANS}, {s->contacts, SPANS, CONTACTS}, {s->tensions, SPANS},
        {it->rates, 4, STATES}, {it->trial, STATES}};
}

/* SplitMix64 of Steele, Lea and Flood: one word of state, any seed */
static uint64_t next_word(uint64_t *state) {
    uint64_t z = (*state += UINT64_C(0x9E3779B97F4A7C15));
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* normal numbers in pairs [Box and Muller]; of an odd number the last one is dropped */
static void draw_noise(line *it) {
    if (!it->memory.numbers.noise) return;
    for (int k = 0; k < NOISE; k += 2) {
        double u = (double)((next_word(&it->memory.random) >> 11) + 1) * 0x1p-53;
        double turn = TAU * ((double)(next_word(&it->memory.random) >> 11) * 0x1p-53);
        double radius = sqrt(-2.0 * log(u));
        it->noise[k] = radius * cos(turn);
        if (k + 1 < NOISE) it->noise[k + 1] = radius * sin(turn);
    }
}

static void step_one_frame(line *it) {
    line_memory *m = &it->memory;
    float_1 tension = {m->tension_ref_N, LOOPS}, corrections = {m->corrections, 2 * DRIVES};
    float_1 noise = {it->noise, NOISE}, row = {m->row, ROW};
    line_step_frame(&it->p, &LAYOUT, &it->s, &it->w, m->line_speed_ref_m_s,
                    m->line_speed_ref_m_s, &tension, &corrections, &noise, &row);
}

static double round_to(double value, double lsb) { return lsb * floor(value / lsb + 0.5); }

/* one recorded value of the row, as channels.py reads it */
static double channel_of(const line *it, const channel *c) {
    const line_memory *m = &it->memory;
    double value = m->row[m->numbers.noise ? c->column : c->exact_column] * c->scale;
    if (c->zero >= 0) {
        double zero = m->theta0_rad[c->zero], shaft_rad = value;
        value = value - zero;
        if (c->eccentricity != 0.0) {
            double turn = shaft_rad + c->eccentricity_angle_rad;
            double start = zero + c->eccentricity_angle_rad;
            value = value + c->eccentricity * (sin(turn) - sin(start));
        }
    }
    return c->lsb > 0.0 && m->numbers.noise ? round_to(value, c->lsb) : value;
}

static void read_outputs(line *it) {
    line_memory *m = &it->memory;
    const WEB *web = &m->numbers.web[0];
    double radius = m->state.y[LAYOUT.radius];
    for (int d = 0; d < DRIVES; d++) m->row[LOGGED + d] = m->state.torque_N_m[d];
    m->row[LOGGED + DRIVES] = PI * (radius * radius - web->core_radius_m * web->core_radius_m) /
                              web->thickness_m;
    for (int k = 0; k < OUTPUTS; k++) m->outputs[k] = channel_of(it, &CHANNELS[k]);
}

static void observe(line *it) {
    float_1 noise = {it->noise, NOISE}, row = {it->memory.row, ROW};
    draw_noise(it);
    it->memory.numbers.timing[0].noisy = it->memory.numbers.noise;
    line_measure(&it->p, &LAYOUT, &it->s, &noise);
    line_log_frame(&it->p, &LAYOUT, &it->s, &it->w, &row);
}

/* common tangents of all spans at the radii of the start; false: no room for one */
static bool lay_out(line *it) {
    const BODY *bodies = it->memory.numbers.bodies;
    line_state *s = &it->memory.state;
    for (int i = 0; i < SPANS; i++) {
        const BODY *a = &bodies[i], *b = &bodies[i + 1];
        double dx = b->centre_x_m - a->centre_x_m, dy = b->centre_y_m - a->centre_y_m;
        double reach = b->sigma * b->radius_m - a->sigma * a->radius_m;
        double free = dx * dx + dy * dy - reach * reach;
        if (!(free > 0.0)) {
            snprintf(it->message, MESSAGE,
                     "no room for span %d: its bodies of radius %g m and %g m stand %g m apart; "
                     "correct the radii", i, a->radius_m, b->radius_m, sqrt(dx * dx + dy * dy));
            return false;
        }
        s->contacts[i * CONTACTS] = sqrt(free);
        s->contacts[i * CONTACTS + 1] = a->radius_m;
        s->contacts[i * CONTACTS + 2] = b->radius_m;
        s->phi_rad[i] = atan2(dy, dx) - asin(reach / sqrt(dx * dx + dy * dy));
    }
    for (int k = 0; k < BODIES; k++) {
        double ratio = NUMBERS.bodies[k].radius_m / bodies[k].radius_m;
        s->y[LAYOUT.omega + k] *= ratio;
        for (int d = 0; d < DRIVES; d++)
            if (it->memory.numbers.drives[d].body == k) s->y[LAYOUT.motor + d] *= ratio;
    }
    s->y[LAYOUT.radius] = bodies[0].radius_m;
    s->y[LAYOUT.radius + 1] = bodies[BODIES - 1].radius_m;
    return true;
}

/* steps of a drive tick that follow the fastest mode; changed numbers count in full, also where
   the mode feels them less; false: more than a sensible line takes */
static bool choose_substeps(line *it) {
    const line_numbers *n = &it->memory.numbers;
    double stiffer = 1.0, faster, wanted, corner = 0.0;
    for (int k = 0; k < BODIES; k++) {
        double lighter = NUMBERS.bodies[k].inertia_kg_m2 / n->bodies[k].inertia_kg_m2;
        double wider = n->bodies[k].radius_m / NUMBERS.bodies[k].radius_m;
        stiffer = largest_float(stiffer, largest_float(1.0, lighter) *
                                             largest_float(1.0, wider * wider));
    }
    stiffer *= largest_float(1.0, n->EA_N / NUMBERS.EA_N);
    if (NUMBERS.web[0].viscosity_s > 0.0)
        stiffer *= largest_float(1.0, n->web[0].viscosity_s / NUMBERS.web[0].viscosity_s);
    for (int c = 0; c < CELLS; c++) corner = largest_float(corner, TAU * n->cells[c].corner_Hz);
    faster = largest_float(FASTEST_RAD_S * stiffer, corner);
    wanted = ceil(faster * n->timing[0].drive_tick_s);
    if (!(wanted <= MOST_SUBSTEPS)) {
        snprintf(it->message, MESSAGE,
                 "with these parameters the line moves at up to %.0f rad/s and takes %.0f steps "
                 "per drive tick; at most %d: look at stiffness, damping and inertia",
                 faster, wanted, MOST_SUBSTEPS);
        return false;
    }
    it->memory.numbers.timing[0].substeps =
        largest_int(NUMBERS.timing[0].substeps, (int64_t)wanted);
    return true;
}

/* the steady state at the present references, carriages at rest; then rolls, angles and time are
   put back */
static void settle(line *it) {
    line_numbers *n = &it->memory.numbers;
    line_state *s = &it->memory.state;
    WEB web = n->web[0];
    CHANGE changes[CHANGES_];
    double speeds[sizeof n->carriages / sizeof n->carriages[0]];
    double radii[2], theta[BODIES], frame_s = TICKS_PER_FRAME * n->timing[0].drive_tick_s;
    int64_t frames = (int64_t)floor(n->settle_s / 4.0 / frame_s + 0.5);
    memcpy(changes, n->changes, sizeof changes);
    memcpy(radii, &s->y[LAYOUT.radius], sizeof radii);
    memcpy(theta, &s->y[LAYOUT.theta], sizeof theta);
    n->web[0].splice_EA_ratio = n->web[0].splice_thickness_ratio = 1.0;
    n->web[0].splice_step_m = 0.0;
    for (int e = 0; e < CHANGES; e++) n->changes[e].from_s = INFINITY;
    n->timing[0].noisy = 0;
    for (int c = 0; c < CARRIAGES; c++) {
        speeds[c] = n->carriages[c].speed_m_s;
        n->carriages[c].speed_m_s = 0.0;
    }
    for (int part = 0; part < 4; part++) {
        for (int64_t f = 0; f < frames; f++) step_one_frame(it);
        memcpy(&s->y[LAYOUT.radius], radii, sizeof radii);
    }
    memcpy(&s->y[LAYOUT.theta], theta, sizeof theta);
    s->y[LAYOUT.flow] = s->y[LAYOUT.flow + 1] = 0.0;
    s->time_s[0] = 0.0;
    s->counters[0] = 0;
    n->web[0] = web;
    memcpy(n->changes, changes, sizeof changes);
    for (int c = 0; c < CARRIAGES; c++) n->carriages[c].speed_m_s = speeds[c];
}

static bool finite_state(const line *it) {
    for (int j = 0; j < STATES; j++)
        if (!isfinite(it->memory.state.y[j])) return false;
    return true;
}

/* a speed of a carriage is an input: it fills or empties from the start on and is no other start */
static bool other_carriages(const line_numbers *n) {
    for (int c = 0; c < CARRIAGES; c++) {
        CARRIAGE now = n->carriages[c];
        now.speed_m_s = NUMBERS.carriages[c].speed_m_s;
        if (memcmp(&now, &NUMBERS.carriages[c], sizeof now) != 0) return true;
    }
    return false;
}

static bool differs(const line *it) {
    const line_memory *m = &it->memory;
    const line_numbers *n = &m->numbers;
    bool same = m->line_speed_ref_m_s == START_SPEED_M_S && n->EA_N == NUMBERS.EA_N &&
                n->wound_in_tension_N == NUMBERS.wound_in_tension_N;
    for (int l = 0; l < LOOPS; l++) same = same && m->tension_ref_N[l] == START_TENSION_N;
    for (int j = 0; j < 2 * DRIVES; j++) same = same && m->corrections[j] == 0.0;
    same = same && !other_carriages(n);
    return !(same && memcmp(n->bodies, NUMBERS.bodies, sizeof n->bodies) == 0 &&
             memcmp(n->web, NUMBERS.web, sizeof n->web) == 0 &&
             memcmp(n->drives, NUMBERS.drives, sizeof n->drives) == 0 &&
             memcmp(n->cells, NUMBERS.cells, sizeof n->cells) == 0 &&
             memcmp(n->heats, NUMBERS.heats, sizeof n->heats) == 0 &&
             memcmp(n->loops, NUMBERS.loops, sizeof n->loops) == 0);
}

/* the start: as exported, or settled again where a parameter or a reference is another one */
static bool prepare(line *it) {
    line_memory *m = &it->memory;
    line_numbers *n = &m->numbers;
    if (m->prepared) return true;
    it->message[0] = 0;
    m->state = STATE;
    for (int i = 0; i < SPANS; i++)
        n->spans[i].EA_N = NUMBERS.spans[i].EA_N * (n->EA_N / NUMBERS.EA_N);
    n->web[0].supply_strain = NUMBERS.web[0].supply_strain;
    n->timing[0].substeps = NUMBERS.timing[0].substeps;
    if (differs(it)) {
        bool radii = false;
        n->web[0].supply_strain /= n->EA_N / NUMBERS.EA_N;
        if (n->wound_in_tension_N != NUMBERS.wound_in_tension_N)
            n->web[0].supply_strain = n->wound_in_tension_N / n->EA_N;
        for (int k = 0; k < BODIES; k++)
            radii = radii || n->bodies[k].radius_m != NUMBERS.bodies[k].radius_m;
        if ((radii && !lay_out(it)) || !choose_substeps(it)) return false;
        settle(it);
        if (!finite_state(it)) {
            snprintf(it->message, MESSAGE, "the line diverged while it settled: its parameters "
                     "or its references at the start are no line's");
            return false;
        }
    }
    m->random = (uint64_t)n->seed;
    observe(it);
    memcpy(m->theta0_rad, &m->state.y[LAYOUT.theta], BODIES * sizeof m->theta0_rad[0]);
    for (int d = 0; d < DRIVES; d++)
        m->theta0_rad[BODIES + d] = m->theta0_rad[n->drives[d].body] + m->state.y[LAYOUT.twist + d];
    read_outputs(it);
    m->prepared = 1;
    return true;
}
