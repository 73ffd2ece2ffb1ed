"""Declared numbers pulled beyond tolerance, as effects to start a fit from.

A strong nuisance is so well measured that one linear step cannot trade it for its effect: the
fit has to start where the nuisance already is.
"""

from __future__ import annotations

import numpy as np

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit import Fit
from sim_plant.refine.hypotheses import Hypothesis, hypothesis
from sim_plant.refine.problem import Problem

PULLED = 4.0
MOST = 3

Start = tuple[Hypothesis, tuple[float, ...], dict[str, float]]


def shifts_in_force(problem: Problem, fit: Fit) -> dict[str, float]:
    """Return every nuisance shift of a fit, simulated and linear parts together."""
    run = problem.bench.one(fit.case)
    estimate = problem.projector.estimate(problem.residual(run, fit.shifts, fit.case.coarse))
    return {
        n.name: fit.shifts.get(n.name, 0.0) + float(e)
        for n, e in zip(problem.nuisances, estimate[: problem.sd.size], strict=True)
    }


def pulled_starts(problem: Problem, fit: Fit, without: frozenset[str]) -> list[Start]:
    """Return effects that say the same as a declared number beyond tolerance, most pulled first.

    ``without`` names effects that are not in the library.
    """
    total = shifts_in_force(problem, fit)
    z = {n.name: total[n.name] / sd for n, sd in zip(problem.nuisances, problem.sd, strict=True)}
    found: list[Start] = []
    for name in sorted(z, key=lambda k: -abs(z[k])):
        if abs(z[name]) < PULLED or len(found) == MOST:
            break
        pair = _effect_of(problem, name, total[name])
        if pair is None or pair[0].effect.name in without:
            continue
        rest = {k: v for k, v in fit.shifts.items() if k != name}
        found.append((*pair, rest))
    return found


def _effect_of(
    problem: Problem, name: str, shift: float
) -> tuple[Hypothesis, tuple[float, ...]] | None:
    line = problem.bench.twins[0].declaration
    part = name.split(".")
    if name == "web.EA_N":
        return hypothesis(BY_NAME["web_modulus"], "web", line=line), (1.0 + shift,)
    if name == "web.wound_in_tension_N":
        strain = line.web.wound_in_tension_N / line.web.EA_N
        return hypothesis(BY_NAME["wound_in_strain"], "web", line=line), (strain * shift,)
    if part[-1] == "friction_constant_N_m":
        declared = line.rollers[line.body(part[1])].friction_constant_N_m
        h = hypothesis(BY_NAME["bearing_drag"], part[1], (), ("constant_N_m",), line)
        return (h, (declared * shift,)) if shift > 0.0 else None
    if part[0] == "sensors" and part[-1] in ("gain", "offset"):
        roller = next(s.roller for s in line.sensors if s.channel == part[1])
        h = hypothesis(BY_NAME["load_cell_calibration"], roller, line=line)
        start = {"gain": 1.0 + shift if part[-1] == "gain" else 1.0,
                 "offset_N": shift if part[-1] == "offset" else 0.0}  # fmt: skip
        return h, tuple(start[k] for k in h.names)
    return None


def improbable(problem: Problem, fit: Fit) -> tuple[str, float, float] | None:
    """Return (number, its z, sum of z squared) when shifts are too many sd to be tolerance."""
    total = shifts_in_force(problem, fit)
    z = np.array([total[n.name] for n in problem.nuisances]) / problem.sd
    if float(z @ z) < z.size + 6.0 * np.sqrt(2.0 * z.size):
        return None
    at = int(np.argmax(np.abs(z)))
    return problem.nuisances[at].name, float(z[at]), float(z @ z)
