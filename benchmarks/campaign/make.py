"""From a case to files: a machine, its faults at the wanted size, two records and a line file."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.campaign import line as short
from benchmarks.campaign.cases import ROWS, SMALLEST, Case
from benchmarks.campaign.contact import Array
from benchmarks.campaign.effects import Fault, with_faults
from benchmarks.campaign.machine import CENTRE_M, IDLER_ECCENTRICITY_M, Scatter, scattered
from benchmarks.campaign.record import (
    References,
    references,
    simulate,
    write_line,
    write_record,
)
from benchmarks.campaign.state import Machine

RADII = {"a": short.NOMINAL_RADII, "b": (0.162, 0.166)}
JUDGED_FROM_S = 15.0
SIZED_BY = (*short.CELLS, *short.SPEEDS)
"""Channels in which a signal-to-noise ratio is taken; angles drift without bound."""


PROPORTIONAL = ("eccentric_roller", "unbalanced_roller", "unbalanced_measuring_roller",
                "torque_ripple", "bearing_drag", "mains_hum", "encoder_eccentricity",
                "wound_in_strain", "thermal_strain", "dancer_swing", "hidden_nip",
                "drifting_cell", "gusty_drive", "web_wave")  # fmt: skip
"""Effects whose response grows with their size: one run tells the size that is wanted."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Made:
    """What is known of a case that was written.

    Attributes
    ----------
    faults : with their sizes.
    snr : reached by each, alone, in its strongest channel.
    floor : rms of record b less the same machine without noise, per channel: the best residual
        that any model can reach.
    """

    faults: tuple[Fault, ...]
    snr: tuple[float, ...]
    floor: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stage:
    """One record to be: a healthy machine, its references and start angles."""

    machine: Machine
    told: References
    angles: Array
    seed: int
    colour: float

    def quiet(self, faults: tuple[Fault, ...] = ()) -> dict[str, Array]:
        """Return the channels without noise."""
        m = with_faults(self.machine, faults)
        return simulate(m, self.told, self.angles, self.seed, noise=False).even()


def stage(case: Case, which: str, nudged: int = -1) -> Stage:
    """Return record ``a`` or ``b`` of a case, healthy; the machine is the same in both.

    One number of the machine, the draw ``nudged``, may be a standard deviation higher.
    """
    rng = np.random.default_rng([case.seed, ord(which)])
    declared = short.declaration(RADII[which])
    told = references(ROWS, rng, speeds=case.speeds, commensurate=case.commensurate)
    machine = scattered(declared, Scatter(np.random.default_rng([case.seed, 7]), 1.0, nudged))
    angles = rng.uniform(0.0, 2.0 * np.pi, size=machine.radius.size)
    return Stage(machine=machine, told=told, angles=angles, seed=int(rng.integers(1 << 31)),
                 colour=case.colour)  # fmt: skip


def tolerances(case: Case) -> list[int]:
    """Return the draws of the machine that move it as a whole (not an axis or half a micron)."""
    draws = Scatter(np.random.default_rng([case.seed, 7]), 1.0)
    scattered(short.declaration(RADII["a"]), draws)
    small = (CENTRE_M, IDLER_ECCENTRICITY_M)
    return [k for k, width in enumerate(draws.widths) if width not in small]


def rms(values: Array) -> float:
    """Return the rms of the judged part."""
    return float(np.sqrt(np.mean(values[round(JUDGED_FROM_S / short.SAMPLE_S) :] ** 2)))


def floors(noisy: dict[str, Array], quiet: dict[str, Array]) -> dict[str, float]:
    """Return rms of noise per channel; an angle's zero is free."""
    found = {}
    for name, values in quiet.items():
        apart = noisy[name] - values
        if name.endswith("_angle_rad"):
            apart = apart - apart[round(JUDGED_FROM_S / short.SAMPLE_S) :].mean()
        found[name] = rms(apart)
    return found


def snr_of(with_it: dict[str, Array], without: dict[str, Array], floor: dict[str, float]) -> float:
    """Return effect rms over noise rms in the strongest tension or speed."""
    return max(rms(with_it[c] - without[c]) / floor[c] for c in SIZED_BY)


def sized(at: Stage, fault: Fault, wanted: float, healthy: dict[str, Array],
          floor: dict[str, float]) -> tuple[Fault, float]:  # fmt: skip
    """Return the fault at the size that reaches ``wanted``, and what it reaches.

    A fault that a tolerance would hide is made as large as it must be to stand out.
    """
    reached = snr_of(at.quiet((fault,)), healthy, floor)
    for _ in range(2):
        if wanted == 0.0 or abs(reached / wanted - 1.0) < 0.05:
            break
        size = fault.size * wanted / reached
        least = SMALLEST.get(fault.effect, 0.0)
        size = float(np.copysign(max(abs(size), least), size))
        if fault.effect in PROPORTIONAL:
            return replace(fault, size=size), reached * size / fault.size
        fault = replace(fault, size=size)
        reached = snr_of(at.quiet((fault,)), healthy, floor)
    return fault, reached


def declared_for(case: Case, which: str) -> dict[str, Any]:
    """Return the declaration with the sensors that this case keeps."""
    declared = copy.deepcopy(short.declaration(RADII[which]))
    if case.channels:
        looped = {t["load_cell"] for t in declared["control"]["tension_pi"]}
        declared["sensors"] = [
            s for s in declared["sensors"]
            if s["channel"] in case.channels or (s["roller"] in looped and "noise_sd_N" in s)
        ]  # fmt: skip
    return declared


def write_case(case: Case, folder: Path) -> Made:
    """Write ``a.csv``, ``b.csv``, ``a.yaml`` (the line) and ``b.yaml``; return what is true."""
    first = stage(case, "a")
    pairs = []
    if case.faults:
        healthy = first.quiet()
        noise = simulate(first.machine, first.told, first.angles, first.seed, colour=case.colour)
        floor_a = floors(noise.even(), healthy)
        pairs = [sized(first, f, case.snr, healthy, floor_a) for f in case.faults]
    faults = tuple(f for f, _ in pairs)
    floor: dict[str, float] = {}
    for which in ("a", "b"):
        at = first if which == "a" else stage(case, "b")
        guilty = with_faults(at.machine, faults)
        record = simulate(guilty, at.told, at.angles, at.seed, colour=case.colour)
        declared = declared_for(case, which)
        kept = {s["channel"] for s in declared["sensors"]}
        written = kept | set(declared["reference_columns"])
        record = replace(record, values={k: v for k, v in record.values.items() if k in written})
        write_record(record, folder / f"{which}.csv")
        write_line(declared, folder / f"{which}.yaml")
        if which == "b":
            quiet = simulate(guilty, at.told, at.angles, at.seed, noise=False).even()
            floor = floors(record.even(), {k: quiet[k] for k in kept})
    return Made(faults=faults, snr=tuple(s for _, s in pairs), floor=floor)
