"""What refine says of a short record of the shipped line with one effect hidden in it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.effects import Value
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.open import make_line
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.objective import declared_objective
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import all_hypotheses
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.search.forward_selection import forward_selection
from tests.sim_plant.line.lines import declared

MODEL = CRITERIA.model
SAMPLES, STEP_S, TENSION_N = 1200, 0.01, 88.9644
SPEED_M_S = np.interp(np.arange(SAMPLES), [0, 600, 720, 1200], [0.9, 0.9, 1.3, 1.3])


@dataclass(frozen=True, slots=True, kw_only=True)
class Traced:
    """What was found: places in order, what each may as well be, its numbers; what was not."""

    places: tuple[EffectAt, ...]
    ambiguous: tuple[tuple[EffectAt, ...], ...]
    numbers: tuple[dict[str, Value], ...]
    unknown: tuple[str, ...]


@contextmanager
def settling(declared_s: float) -> Iterator[None]:
    """Let models of refine run for this time before their records, half of it at the quick tick.

    What a record of ten seconds costs is two thirds its settling.
    """
    shorter = replace(MODEL, declared_settle_s=declared_s, quick_settle_s=0.5 * declared_s)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sim_plant.refine.model.twin.MODEL", shorter)
        yield


def traced(
    hidden: EffectEntry,
    among: tuple[str, ...] = (),
    line: Declaration | None = None,
    tolerances: dict[str, float] | None = None,
    *,
    settle_s: float = MODEL.declared_settle_s,
) -> Traced:
    """Return what the library, the whole or these effects, finds in 12 s at two speeds with noise.

    Record and model begin with a line that has run for ``settle_s``; it starts where it rests.

    Every declared number is exact unless ``tolerances`` say otherwise, so nothing but effects can
    explain the record.
    """
    exact = {"sample_time_s": STEP_S, "tolerances": tolerances or {"*": 0.0}}
    line = (line or declared("euclid")).model_copy(update=exact)
    quick = line.operating_point.line_speed_m_s > 1.5  # a line of twice the speed
    start, tension_N = (1.8, 90.0) if quick else (0.9, TENSION_N)
    run = make_line(
        line.model_copy(update={"effects": (hidden,)}),
        seed=3,
        speed_m_s=start,
        tension_N=tension_N,
    )
    run.settle(settle_s)
    speed, tension = SPEED_M_S * (start / 0.9), np.full(SAMPLES, tension_N)
    out = run.simulate(speed, tension)
    columns = {"line_speed_ref_m_s": speed, "tension_ref_N": tension}
    columns |= {s.channel: out[s.channel] for s in line.sensors}
    record = Recording(path=Path("short.csv"), sha256="", sample_time_s=STEP_S, columns=columns)
    twin = twin_of(line, record)
    measured = np.stack([columns[name] for name in twin.channels])
    with settling(settle_s), SimulationPool([twin], workers=1) as pool:
        objective = declared_objective(pool, [measured])
        without = {e.name for e in CATALOGUE if among and e.name not in among}
        tried = all_hypotheses(line, without)
        found = forward_selection(objective, tried, lambda _: None, without)
    return Traced(
        places=tuple(accepted.hypothesis.key for accepted in found.accepted),
        ambiguous=tuple(accepted.ambiguous for accepted in found.accepted),
        numbers=tuple(dict(effect.parameters) for effect in found.fit.effects),
        unknown=tuple(unknown.text for unknown in found.unknown),
    )
