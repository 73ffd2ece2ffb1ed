/* A line on the run: a roll change, a splice, samples; numbers set and read by their place. */

#include "line_variables.h"

/* the angle at which a shaft holds this share of its torque; within the play as it is */
static double twisted(double twist_rad, double play_rad, double torques) {
    double half_rad = 0.5 * play_rad;
    double loose_rad = fmin(fmax(twist_rad, -half_rad), half_rad);
    return loose_rad + (twist_rad - loose_rad) * torques;
}

/* full rolls at both ends: rims at the web's speed, drives and shafts with the old web force */
static void change_rolls(line *it) {
    line_state *s = &it->memory.state;
    const line_numbers *n = &it->memory.numbers;
    const int ends[2] = {0, BODIES - 1};
    for (int end = 0; end < 2; end++) {
        int k = ends[end];
        const BODY *body = &n->bodies[k];
        double old_m = s->y[LAYOUT.radius + end], new_m = body->radius_m;
        s->y[LAYOUT.radius + end] = new_m;
        s->y[LAYOUT.omega + k] *= old_m / new_m;
        for (int d = 0; d < DRIVES; d++) {
            if (n->drives[d].body != k || body->kind < UNWIND) continue;
            double inertias = k_roll_inertia(&it->p, body->inertia_kg_m2, old_m) /
                              k_roll_inertia(&it->p, body->inertia_kg_m2, new_m);
            s->y[LAYOUT.motor + d] *= old_m / new_m;
            s->drive_integral[d] *= new_m / old_m * inertias;
            double *twist_rad = &s->y[LAYOUT.twist + d];
            *twist_rad = twisted(*twist_rad, n->drives[d].shaft_backlash_rad, new_m / old_m);
        }
    }
}

/* from here on the unwind gives other web; false: the seam before is still on its way */
static bool splice_now(line *it) {
    line_numbers *n = &it->memory.numbers;
    const line_state *s = &it->memory.state;
    WEB *web = &n->web[0];
    bool spliced = web->splice_EA_ratio != 1.0 || web->splice_thickness_ratio != 1.0 ||
                   web->splice_step_m != 0.0;
    if (spliced) {
        double in_line = 0.0;  /* web between unwind and rewind, stretched: at least what it is */
        for (int i = 0; i < SPANS; i++) {
            in_line += s->contacts[i * CONTACTS];
            in_line += k_wrapped(&it->p, i, it->s.phi_rad, it->w.contacts);
        }
        if (!(s->y[LAYOUT.flow] > web->splice_m + in_line + web->splice_piece_m)) {
            snprintf(it->message, MESSAGE,
                     "no splice: the seam at %.3f m has not left the line, of which %.3f m are "
                     "unwound", web->splice_m, s->y[LAYOUT.flow]);
            return false;
        }
        for (int i = 0; i < SPANS; i++) n->spans[i].EA_N *= web->splice_EA_ratio;
        web->supply_strain /= web->splice_EA_ratio;
        web->thickness_m *= web->splice_thickness_ratio;
    }
    web->splice_m = s->y[LAYOUT.flow];
    web->splice_EA_ratio = n->splice_EA_ratio;
    web->splice_thickness_ratio = n->splice_thickness_ratio;
    web->splice_step_m = n->splice_step_m;
    web->splice_piece_m = n->splice_piece_m;
    return true;
}

/* whole samples in a communication step; 0: none, with a message */
static int64_t samples_of(line *it, double now_s, double step_s) {
    double samples = floor(step_s / SAMPLE_TIME_S + 0.5);
    if (!(fabs(now_s - it->memory.now_s) < 0.1 * SAMPLE_TIME_S)) {
        snprintf(it->message, MESSAGE, "a step from %.9g s is asked for, and the line is at "
                 "%.9g s: restore its state first", now_s, it->memory.now_s);
        return 0;
    }
    if (!(samples >= 1.0 && fabs(step_s - samples * SAMPLE_TIME_S) < 1e-6 * SAMPLE_TIME_S)) {
        snprintf(it->message, MESSAGE, "a communication step of %.9g s: the line's sample time "
                 "is %.9g s; give a whole multiple of it", step_s, SAMPLE_TIME_S);
        return 0;
    }
    return (int64_t)samples;
}

typedef enum { LINE_FINE, LINE_WARNS, LINE_FAILS } line_answer;

/* one communication step under the inputs that were set; corrections and references hold */
static line_answer advance(line *it, double now_s, double step_s) {
    line_memory *m = &it->memory;
    line_answer answer = LINE_FINE;
    int64_t samples = samples_of(it, now_s, step_s);
    if (samples == 0) return LINE_FAILS;
    if (m->splice && !m->splice_before && !splice_now(it)) answer = LINE_WARNS;
    if (m->roll_change && !m->roll_change_before) change_rolls(it);
    m->splice_before = m->splice;
    m->roll_change_before = m->roll_change;
    m->numbers.timing[0].noisy = m->numbers.noise;
    for (int64_t f = 0; f < samples * FRAMES_PER_SAMPLE; f++) {
        draw_noise(it);
        step_one_frame(it);
    }
    m->samples += samples;
    m->now_s = m->start_s + (double)m->samples * SAMPLE_TIME_S;
    read_outputs(it);
    if (!finite_state(it)) {
        snprintf(it->message, MESSAGE, "the simulated line diverged: a state is not finite");
        return LINE_FAILS;
    }
    return answer;
}

/* a number by its reference, which counts from 0: independent variable first */
static const variable *variable_at(line *it, uint32_t reference, number_kind kind) {
    if (reference < VARIABLES && VARIABLE[reference].kind == kind) return &VARIABLE[reference];
    snprintf(it->message, MESSAGE, "value reference %lu: this line has no such %s",
             (unsigned long)reference,
             kind == REAL ? "real number" : kind == INTEGER ? "integer" : "truth value");
    return NULL;
}

static void *place_of(line *it, const variable *v) { return (char *)&it->memory + v->at; }

/* false, with a message: this number, or this value of it, cannot be set now */
static bool may_set(line *it, const variable *v, double value) {
    static const char *const OUTSIDE = "%s = %g: give %g to %g";
    if (v->when == SET_NEVER) {
        snprintf(it->message, MESSAGE, "%s cannot be set: the line computes it or it is a "
                 "constant", v->name);
        return false;
    }
    if (v->when == SET_BEFORE && it->memory.phase >= STEPPING) {
        snprintf(it->message, MESSAGE, "%s cannot be set on the run: set it before the end of "
                 "the initialization, or reset", v->name);
        return false;
    }
    if (!(value >= v->low && value <= v->high)) {
        snprintf(it->message, MESSAGE, OUTSIDE, v->name, value, v->low, v->high);
        return false;
    }
    return true;
}

static bool set_number(line *it, uint32_t reference, number_kind kind, double value) {
    const variable *v = variable_at(it, reference, kind);
    if (v == NULL || !may_set(it, v, value)) return false;
    if (kind == REAL) *(double *)place_of(it, v) = value;
    else *(int64_t *)place_of(it, v) = (int64_t)value;
    if (it->memory.phase < STEPPING) it->memory.prepared = 0;
    return true;
}

/* before the first step what the line computes follows from what was set so far */
static bool get_number(line *it, uint32_t reference, number_kind kind, double *value) {
    const variable *v = variable_at(it, reference, kind);
    if (v == NULL) return false;
    if (v->when == SET_NEVER && it->memory.phase == INITIALIZING && !prepare(it)) return false;
    *value = kind == REAL ? *(double *)place_of(it, v) : (double)*(int64_t *)place_of(it, v);
    return true;
}

static void begin(line *it) {
    line_as_exported(it);
    it->message[0] = 0;
    it->memory.prepared = 0;
}

/* from where the importer counts its time */
static void begin_at(line *it, double start_s) {
    it->memory.start_s = it->memory.now_s = start_s;
    it->memory.samples = 0;
    it->memory.phase = INITIALIZING;
}
