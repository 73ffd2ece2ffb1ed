"""Short noise-free runs of the shipped line, with effects."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.running.simulation import LineSimulation

SPEED_M_S, TENSION_N = 1.016, 88.9644


@cache
def euclid() -> Declaration:
    """Return the shipped line with encoders and cells of no resolution step.

    A quantised encoder shifts the mean speed a drive rests at, which formulas do not know.
    """
    shipped = load_declaration(Path(__file__).parents[3] / "config/lines/euclid.yaml")
    fine = {"lsb_N": 0.0, "lsb_rad_s": 0.0}
    sensors = tuple(s.model_copy(update=fine) for s in shipped.sensors)
    return shipped.model_copy(update={"sensors": sensors})


def effect(name: str, location: str, **parameters: float | str) -> EffectEntry:
    return EffectEntry(effect=name, location=location, parameters=parameters)


def line(
    *effects: EffectEntry,
    settle_s: float = 10.0,
    speed_m_s: float = SPEED_M_S,
    sample_time_s: float = 0.005,
) -> LineSimulation:
    """Return the line with these effects, settled."""
    declared = euclid().model_copy(update={"effects": effects})
    made = make_line(declared, seed=None, speed_m_s=speed_m_s, sample_time_s=sample_time_s)
    made.settle(settle_s)
    return made


def run(
    *effects: EffectEntry,
    seconds: float = 2.0,
    settle_s: float = 10.0,
    speed_m_s: float = SPEED_M_S,
    sample_time_s: float = 0.005,
    aff: dict[str, Array] | None = None,
) -> dict[str, Array]:
    """Return the channels of a run at one speed and tension."""
    made = line(*effects, settle_s=settle_s, speed_m_s=speed_m_s, sample_time_s=sample_time_s)
    rows = round(seconds / sample_time_s)
    return made.simulate(np.full(rows, speed_m_s), np.full(rows, TENSION_N), aff)


def at_rest(*effects: EffectEntry, seconds: float = 34.0) -> dict[str, Array]:
    """Return the last 2 s of a run long enough for every zone to forget its start."""
    made = run(*effects, settle_s=4.0, seconds=seconds)
    return {name: values[-400:] for name, values in made.items()}


@cache
def nominal() -> dict[str, Array]:
    return at_rest()


def span(name: str) -> int:
    """Return the index of a span called ``start-end``."""
    return [f"{s.start}-{s.end}" for s in euclid().spans].index(name)


def mean_tension_N(channels: dict[str, Array], name: str) -> float:
    return float(channels["span_tension_N"][:, span(name)].mean())


def draw_ratio(channels: dict[str, Array]) -> float:
    """Return pull-roll speed over follower speed: the S-wrap's own speeds settle slowly."""
    ratio = channels["true_pull_roll_speed_m_s"] / channels["true_swrap_follower_speed_m_s"]
    return float(ratio.mean())


def drawn_tension_N(channels: dict[str, Array], EA_N: float, share: float = 1.0) -> float:
    """Return the tension before the pull roll from mass balance and Hooke alone.

    (1 + strain at the pull roll) = (1 + strain at the follower) times the ratio of web speeds.
    """
    gap = mean_tension_N(channels, "swrap_lead-swrap_follower") / EA_N
    return EA_N * ((1.0 + gap) * draw_ratio(channels) * share - 1.0)
