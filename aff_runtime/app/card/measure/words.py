"""Step 2: the PLC's words: its heartbeat, its echo of ours, and values against a display.

A display is what the machine itself shows: a drive's, a load-cell amplifier's, the PLC's panel.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Array, Figure, StepResult, at_most, mean_and_half
from aff_runtime.app.report.comparison.window import Window
from aff_runtime.app.wiring.site_to_guard import echo_params
from aff_runtime.base.channel_units import unit_of_name
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.signals import NO_ECHO

LIMIT_PERCENT = 1.0
READ_S, AT_ONCE_S = 10.0, 0.5
"""Of a radius, which changes while its display is read: how long reading may take, and how long
readings count as of one moment."""
LATE_SHARE = 0.5
"""Of a cycle: a tick that begins later than this looks at the heartbeat at another time."""
OURS_WERE_LATE = (
    "heartbeat: in each rest that is too long, up to {:.0f} ms, the service missed or began late "
    "a tick of its own, which says nothing of the PLC: again on a machine that keeps its ticks"
)


def typed_names(evidence: Evidence) -> tuple[str, ...]:
    """Return what may be typed: every channel."""
    return tuple(evidence.site.gateway.read.channels)


def wanted(evidence: Evidence) -> tuple[str, ...]:
    """Return the channels whose display has to be read: tensions, line speed, radii."""
    site = evidence.site
    names = [actuator.error.signal for actuator in site.actuators.values()]
    names += [site.line.speed, *(roll.radius or "" for roll in site.rolls.values())]
    return tuple(name for name in dict.fromkeys(names) if name)


def measure(evidence: Evidence) -> StepResult:
    """Return how long the heartbeat rests, the echo's age, and differences from the display."""
    window = evidence.window
    heartbeat, again = _heartbeat(window, evidence.site.freshness.hold_after_ms)
    figures = [heartbeat, *_echo(evidence)]
    missing = list(again)
    for name in dict.fromkeys([*wanted(evidence), *evidence.typed.names]):
        shown = evidence.typed.number(name, unit_of_name(name))
        if math.isfinite(shown):
            figures.append(_difference(window, name, shown))
        else:
            missing.append(f"type what the display shows: {name}=... {unit_of_name(name)}")
    remarks = (
        ()
        if evidence.site.gateway.read.aff_echo
        else (
            "aff_echo is not mapped: a second master that always writes after us is not noticed",
        )
    )
    return StepResult(figures=tuple(figures), missing=tuple(missing), remarks=tuple(remarks))


@dataclass(frozen=True, slots=True, kw_only=True)
class Rest:
    """Longest times between two movements of the PLC's heartbeat, s.

    Attributes
    ----------
    longest_s : of all of them.
    seen_s : of those in which every tick of the service was there and in time: they are the
        PLC's own.
    """

    longest_s: float
    seen_s: float


def longest_rest(time_s: Array, heartbeat: Array, wake_us: Array) -> Rest:
    """Return the longest rest of a counter; both ends of the window count too.

    Parameters
    ----------
    time_s : on the grid of the cycle; a tick that was missed is not there.
    wake_us : by how much each tick began late.
    """
    known = np.isfinite(heartbeat)
    time_s, heartbeat, wake_us = time_s[known], heartbeat[known], wake_us[known]
    if time_s.size < 2:
        return Rest(longest_s=NAN, seen_s=NAN)
    cycle_s = float(np.median(np.diff(time_s)))
    late = np.cumsum(wake_us * 1e-6 > LATE_SHARE * cycle_s)
    missed = np.cumsum(np.diff(time_s, prepend=time_s[0]) > 1.5 * cycle_s)
    ends = np.concatenate([[0], 1 + np.flatnonzero(np.diff(heartbeat)), [time_s.size - 1]])
    rests_s = np.diff(time_s[ends])
    # late from the first tick on, which then sees its beat early; missed after it
    before = np.where(ends[:-1] > 0, late[ends[:-1] - 1], 0)
    ours = (late[ends[1:]] > before) | (np.diff(missed[ends]) > 0)
    return Rest(longest_s=float(rests_s.max()), seen_s=float(rests_s[~ours].max(initial=0.0)))


def _heartbeat(window: Window, hold_after_ms: float) -> tuple[Figure, tuple[str, ...]]:
    """Return the heartbeat's longest rest, and a sentence where it is not the PLC's own."""
    columns = window.table.columns
    time_s = columns["time_s"]
    wake_us = np.nan_to_num(columns.get("wake_us", np.zeros(time_s.size)))
    rest = longest_rest(time_s, columns["plc_heartbeat"], wake_us)
    rest_ms = 1e3 * rest.longest_s
    cycle_ms = 1e3 * float(np.median(np.diff(time_s))) if rest_ms > 0.0 else NAN
    good = at_most(rest_ms, hold_after_ms + 1e-6)
    is_ours = good is False and 1e3 * rest.seen_s <= hold_after_ms + 1e-6
    figure = Figure(
        name="heartbeat: longest rest",
        value=rest_ms,
        unit="ms",
        low=rest_ms - cycle_ms,
        high=rest_ms + cycle_ms,
        limit=f"at most {hold_after_ms:g} ms (hold_after_ms)",
        good=None if is_ours else good,
    )
    return figure, (OURS_WERE_LATE.format(rest_ms),) if is_ours else ()


def _echo(evidence: Evidence) -> Iterator[Figure]:
    if evidence.site.gateway.read.aff_echo is None:
        return
    ages = evidence.window.table.columns.get("echo_age", np.empty(0))
    # an older one is a word that stands still, or the heartbeat of another master
    is_ours = (ages > NO_ECHO) & (ages <= echo_params(evidence.site).ticks)
    seen = float(np.mean(is_ours)) if ages.size else NAN
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
    mean, half = mean_and_half(values)
    if unit_of_name(name) == "m":  # a roll runs down: by 6 % in ten seconds near its core
        mean, half = _at_the_reading(window, values, shown)
    size = abs(shown) or NAN
    error = 100.0 * (mean - shown) / size
    half = 100.0 * half / size
    return Figure(
        name=f"{name}: {mean:.5g}, display {shown:.5g} {unit_of_name(name)}; difference",
        value=error,
        unit="%",
        low=error - half,
        high=error + half,
        limit=f"within {LIMIT_PERCENT:g} %",
        good=at_most(abs(error), LIMIT_PERCENT),
    )


def _at_the_reading(window: Window, values: Array, shown: float) -> tuple[float, float]:
    """Return the mean and half its interval at the moment nearest to what was shown.

    Nobody knows when in the window the display was read, and between reading and measuring lie
    walking and typing: a radius that the display showed is one that the word passed in the window.
    """
    ago = np.floor((window.time_s[-1] - window.time_s) / AT_ONCE_S)
    means = [mean_and_half(values[ago == k]) for k in range(round(READ_S / AT_ONCE_S))]
    known = [one for one in means if math.isfinite(one[0])]
    return min(known, key=lambda one: abs(one[0] - shown), default=(NAN, NAN))
