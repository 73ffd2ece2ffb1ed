"""Rollers of one radius at several speeds: one line in travel, told apart by place and by law."""

import numpy as np

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import nominal_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.search.completeness import remaining_spectra
from sim_plant.refine.search.selection import Selection
from tests.sim_plant.refine.small import axes_at, formula_twin, line_with, objective_of, white

SAMPLES, JUDGED = 4000, 3000
RADIUS_M, OTHER_RADIUS_M = 0.04, 0.05
PLACES = ("R1", "R2", "R4", "R6")
"""Idlers of the first radius; R8 has the other one."""
LINE = line_with(
    rollers=tuple(
        r.model_copy(update={"radius_m": OTHER_RADIUS_M if r.name == "R8" else RADIUS_M})
        if r.kind == "idler"
        else r
        for r in line_with().rollers
    )
)
SPEED_M_S = 0.9 + 0.4 * np.sin(2 * np.pi * np.arange(SAMPLES) / 1300.0)
CHANNELS = ("unwind_tension_N", "pullroll_tension_N", "rewind_tension_N")
AHEAD_RAD = {
    "R1": (0.2, 0.3, 2.0),
    "R2": (0.6, 0.6, 1.2),
    "R4": (1.9, 1.3, 3.4),
    "R6": (2.6, 2.4, 4.2),
    "R8": (0.0, 0.0, 0.0),
}
GAIN = {
    "R1": (1.0, 0.4, 0.4),
    "R2": (0.9, 0.5, 0.3),
    "R4": (0.5, 0.9, 0.6),
    "R6": (0.3, 1.0, 0.5),
    "R8": (1.0, 1.0, 1.0),
}
"""Phase and size with which each cell sees what a place does; what others do is not seen."""


def of_kind(effect, place):
    """Return an effect at a place, its two components free."""
    return hypothesis(BY_NAME[effect], place, line=LINE)


KINDS = [of_kind(e, p) for e in ("eccentric_roller", "unbalanced_roller") for p in PLACES]
UNIT = {"eccentric_roller": 2e-4, "unbalanced_roller": 2e-3}


def seen(case):
    """Return the tensions: of an eccentric roller in proportion to speed, of mass to none."""
    turns_rad = np.cumsum(SPEED_M_S) * 0.01
    tensions = np.zeros((3, SAMPLES))
    for added in case.effects:
        if added.location not in GAIN:
            continue
        radius_m = LINE.rollers[LINE.body(added.location)].radius_m
        values = dict(added.parameters)
        cos, sin = (values[name] / UNIT[added.effect] for name in of_kind(*_at(added)).names)
        law = SPEED_M_S if added.effect == "eccentric_roller" else np.full(SAMPLES, 0.9)
        for row in range(3):
            phase = turns_rad / radius_m + AHEAD_RAD[added.location][row]
            wave = cos * np.cos(phase) + sin * np.sin(phase)
            tensions[row] += GAIN[added.location][row] * law * wave
    return tensions


def _at(added):
    return added.effect, added.location


def put(h, cos, sin):
    """Return an effect with components of so many units."""
    unit = UNIT[h.effect.name]
    return h.added((cos * unit, sin * unit))


def nothing_found(hidden, formula=seen, seed=4):
    """Return objective and selection of a record with these effects in it, none found yet."""
    twin = formula_twin(formula, CHANNELS, SAMPLES, line=LINE, speed_m_s=SPEED_M_S)
    truth = twin.simulate(Case(effects=tuple(hidden)))
    objective = objective_of(twin, truth + white((3, SAMPLES), seed))
    nominal = nominal_fit(objective, {})
    record_axes = (axes_at(SPEED_M_S[-JUDGED:], LINE),)
    spectra = remaining_spectra(objective, nominal, record_axes)
    return objective, Selection(
        nominal=nominal,
        fit=nominal,
        record_axes=record_axes,
        spectra_declared=spectra,
        spectra_left=spectra,
    )
