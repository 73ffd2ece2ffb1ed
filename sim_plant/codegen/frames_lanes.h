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
