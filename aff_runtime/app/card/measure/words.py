"""Step 2: the PLC's words: its heartbeat, its echo of ours, and values against a display."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Array, Figure, Finding, at_most, mean_and_half
from aff_runtime.app.report.comparison.window import Window
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.signals import NO_ECHO

LIMIT_PERCENT = 1.0
LAST_S = 2.0
"""Of a radius, which shrinks while the display is read: the newest readings alone."""
UNITS = {"_N_m": "N m", "_rad_s": "rad/s", "_m_s": "m/s", "_rad": "rad", "_N": "N", "_m": "m"}


def typed_names(evidence: Evidence) -> tuple[str, ...]:
    """Return what may be typed: every channel."""
    return tuple(evidence.site.gateway.read.channels)


def wanted(evidence: Evidence) -> tuple[str, ...]:
    """Return the channels whose display has to be read: tensions, line speed, radii."""
    site = evidence.site
    names = [actuator.error.signal for actuator in site.actuators.values()]
    names += [site.line.speed, *(roll.radius or "" for roll in site.rolls.values())]
    return tuple(name for name in dict.fromkeys(names) if name)


def measure(evidence: Evidence) -> Finding:
    """Return how long the heartbeat rests, the echo's age, and differences from the display."""
    window = evidence.window
    figures = [_heartbeat(window, evidence.site.freshness.hold_after_ms)]
    figures.extend(_echo(evidence))
    missing = []
    for name in dict.fromkeys([*wanted(evidence), *evidence.typed.names]):
        shown = evidence.typed.number(name, unit_of(name))
        if math.isfinite(shown):
            figures.append(_difference(window, name, shown))
        else:
            missing.append(f"type what the display shows: {name}=... {unit_of(name)}")
    remarks = (
        ()
        if evidence.site.gateway.read.aff_echo
        else (
            "aff_echo is not mapped: a second master that always writes after us is not noticed",
        )
    )
    return Finding(figures=tuple(figures), missing=tuple(missing), remarks=tuple(remarks))


def unit_of(channel: str) -> str:
    """Return the SI unit that a channel's name ends with."""
    return next((unit for end, unit in UNITS.items() if channel.endswith(end)), "")


def longest_rest_s(time_s: Array, heartbeat: Array) -> float:
    """Return the longest time between two movements of a counter, s; both ends count too."""
    known = np.isfinite(heartbeat)
    time_s, heartbeat = time_s[known], heartbeat[known]
    if time_s.size < 2:
        return NAN
    moved = time_s[1:][np.diff(heartbeat) != 0.0]
    return float(np.max(np.diff(np.concatenate([time_s[:1], moved, time_s[-1:]]))))


def _heartbeat(window: Window, hold_after_ms: float) -> Figure:
    columns = window.table.columns
    rest_ms = 1e3 * longest_rest_s(columns["time_s"], columns["plc_heartbeat"])
    cycle_ms = 1e3 * float(np.median(np.diff(columns["time_s"]))) if rest_ms > 0.0 else NAN
    return Figure(
        name="heartbeat: longest rest",
        value=rest_ms,
        unit="ms",
        low=rest_ms - cycle_ms,
        high=rest_ms + cycle_ms,
        limit=f"at most {hold_after_ms:g} ms (hold_after_ms)",
        good=at_most(rest_ms, hold_after_ms + 1e-6),
    )


def _echo(evidence: Evidence) -> Iterator[Figure]:
    if evidence.site.gateway.read.aff_echo is None:
        return
    ages = evidence.window.table.columns.get("echo_age", np.empty(0))
    seen = float(np.mean(ages > NO_ECHO)) if ages.size else NAN
    yield Figure(
        name="echo: share of ticks in which the PLC shows our heartbeat",
        value=100.0 * seen,
        unit="%",
        limit="at least 99 %",
        good=seen >= 0.99 if ages.size else None,
    )
    oldest = float(np.max(ages, initial=NO_ECHO))
    yield Figure(name="echo: oldest", value=oldest if oldest >= 0.0 else NAN, unit="ticks")


def _difference(window: Window, name: str, shown: float) -> Figure:
    values = window.readings(name)
    if values is None:
        raise RefusedError(f"{window.table.window}: no reading of {name} in it")
    if unit_of(name) == "m":  # a roll runs down: by 6 % in ten seconds near its core
        values = values[window.time_s > window.time_s[-1] - LAST_S]
    mean, half = mean_and_half(values)
    size = abs(shown) or NAN
    error = 100.0 * (mean - shown) / size
    half = 100.0 * half / size
    return Figure(
        name=f"{name}: {mean:.5g}, display {shown:.5g} {unit_of(name)}; difference",
        value=error,
        unit="%",
        low=error - half,
        high=error + half,
        limit=f"within {LIMIT_PERCENT:g} %",
        good=at_most(abs(error), LIMIT_PERCENT),
    )
