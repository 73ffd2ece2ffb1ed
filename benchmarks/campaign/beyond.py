"""What is beyond any library: how it is drawn, and where the free line of a fault is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from benchmarks.campaign import line as short
from benchmarks.campaign.fault import CELLS, DRIVES, Fault

TRAVEL, TIME, ANGLE = "travel", "time", "angle"
RECORD_HZ = 1.0 / short.SAMPLE_S

Drawn = tuple[Fault, tuple[str, ...]]
"""A fault, and the classes of the unknown that say rightly what it is."""
Draw = Callable[[np.random.Generator, str, float, str], Drawn]
"""(chance, name, angle, rad, span) -> fault."""
Coordinate = Callable[[Mapping[str, Any]], dict[str, float]]
"""Fault as a mapping -> Hz, 1/m of web, or order."""


def swing(rng: np.random.Generator, name: str, angle: float, span: str) -> Drawn:
    """Return a span whose length swings in time."""
    hertz = float(rng.uniform(0.6, 5.0))
    fault = Fault(effect=name, location=span, size=2e-5, angle=angle, shape=hertz, kind=TIME)
    return fault, (TIME,)


def nip(rng: np.random.Generator, name: str, angle: float, span: str) -> Drawn:
    """Return a span whose length swings with the turn of a roller that nobody declared."""
    wavenumber = 1.0 / (2.0 * np.pi * float(rng.uniform(0.028, 0.1)))
    fault = Fault(
        effect=name, location=span, size=2e-5, angle=angle, shape=wavenumber, kind=TRAVEL
    )
    return fault, (TRAVEL,)


def wave(rng: np.random.Generator, name: str, _angle: float, _span: str) -> Drawn:
    """Return a web whose strain varies along its length."""
    length_m = float(rng.uniform(0.35, 1.6))
    fault = Fault(effect=name, location="web", size=3e-3, shape=length_m, kind=TRAVEL)
    return fault, (TRAVEL,)


def stiffer(_rng: np.random.Generator, name: str, _angle: float, _span: str) -> Drawn:
    """Return a web that is stiffer the more it is pulled."""
    return Fault(effect=name, location="web", size=0.3, kind="state"), ("state",)


def gusts(rng: np.random.Generator, name: str, _angle: float, _span: str) -> Drawn:
    """Return a drive that pushes irregularly."""
    drive = str(rng.choice(DRIVES))
    return Fault(effect=name, location=drive, size=0.05, kind="broadband"), ("broadband",)


def drift(rng: np.random.Generator, name: str, _angle: float, _span: str) -> Drawn:
    """Return a load cell whose zero drifts."""
    cell = str(rng.choice(CELLS))
    fault = Fault(effect=name, location=cell, size=0.01, kind="drift")
    return fault, ("broadband", "state", TIME)


def alias(fault: Mapping[str, Any]) -> dict[str, float]:
    """Return where a frequency appears after sampling, Hz."""
    return {"frequency_Hz": abs(fault["shape"] - RECORD_HZ * round(fault["shape"] / RECORD_HZ))}


def as_drawn(fault: Mapping[str, Any]) -> dict[str, float]:
    """Return the coordinate that the fault itself says."""
    return {"frequency_Hz" if fault["kind"] == TIME else "wavenumber_1_m": fault["shape"]}


def under_tension(fault: Mapping[str, Any]) -> dict[str, float]:
    """Return the wavenumber of a length of unstretched web: the line counts it under tension."""
    return {"wavenumber_1_m": 1.0 / (fault["shape"] * (1.0 + short.WOUND_N / short.EA_N))}


def turn_of_nip(fault: Mapping[str, Any]) -> dict[str, float]:
    """Return the wavenumber of a roller of the radius that the fault says."""
    return {"wavenumber_1_m": 1.0 / (2.0 * np.pi * fault["shape"])}
