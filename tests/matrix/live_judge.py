"""What happened at a plant in real time: one blow, its reaction, and whether it stays away."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from tests.hil.live_line import LiveLine, Rows
from tests.lockstep.fault_table import zero_after_s
from tests.processes import until

ZERO_S = 0.300
LOOK_S = 0.7  # from the blow on, at least
QUIET_S = 0.5
SAMPLE_S = 0.005


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """One blow as the plant has seen it.

    Attributes
    ----------
    name : the fault or deed.
    zero_s : when the correction was last not zero, s after the blow.
    largest : largest |correction| as a share of its limit.
    held_up : samples that the machine was late with meanwhile, plant and runtime.
    wrong : what the table forbids; empty when nothing.
    """

    name: str
    zero_s: float
    largest: float
    held_up: int = 0
    wrong: str = ""


def judged(
    name: str,
    reaction: str,
    rows: Rows,
    span_s: tuple[float, float],
    limits_m_s: tuple[float, ...],
) -> Seen:
    """Judge the plant's samples within a span of plant time, against the limits of the site."""
    struck_s, until_s = span_s
    rows = [row for row in rows if struck_s <= row[0] <= until_s]
    shares = [abs(v) / m for _, row in rows for v, m in zip(row, limits_m_s, strict=True)]
    seen = Seen(name=name, zero_s=zero_after_s(rows, struck_s), largest=max(shares))
    if seen.largest > 1.0 + 1e-9:
        return replace(seen, wrong=f"{seen.largest:.4f} of the limit")
    if reaction in ("latch", "fade", "stay") and seen.zero_s > ZERO_S + SAMPLE_S:
        return replace(seen, wrong=f"not zero before {seen.zero_s * 1e3:.0f} ms")
    if reaction == "zero" and any(any(values) for _, values in rows):
        return replace(seen, wrong="a correction without an operator")
    return seen


def strike(
    line: LiveLine,
    name: str,
    reaction: str,
    blow: Callable[[LiveLine], float],
    *,
    lasts_s: float = LOOK_S,
) -> Seen:
    """Let ``blow`` happen, look at the plant for ``lasts_s``, judge it.

    Parameters
    ----------
    reaction : latch, fade, ride; zero where nothing may go out at all; any for limits alone.
    blow : does it and returns the plant time at which it began.
    """
    before = line.pauses()
    struck_s = blow(line)
    line.wait_plant(struck_s + lasts_s)
    span_s = (struck_s, struck_s + lasts_s)
    seen = judged(name, reaction, line.since(struck_s), span_s, line.limits_m_s)
    after = line.pauses()
    held_up = after.plant_samples - before.plant_samples
    return replace(seen, held_up=max(0, held_up))


def stays_at_zero(line: LiveLine, seen: Seen) -> Seen:
    """Wait with everything well again: what latched must not come back without an operator."""
    try:
        until("the service sees the PLC", lambda: line.status().get("comm") == "OK")
    except AssertionError as error:
        raise AssertionError(
            f"after {seen}: {error}; service {line.service.process.poll()}, "
            f"plant {line.plant.process.poll()}\n{line.service.tail()}\n{line.plant.tail()}"
        ) from error
    start_s = line.now_s()
    line.wait_plant(start_s + QUIET_S)
    if line.state not in ("FAULT", "BYPASS"):
        return replace(seen, wrong=seen.wrong or f"state {line.state}, not latched")
    if any(any(values) for _, values in line.since(start_s)):
        return replace(seen, wrong=seen.wrong or "came back without an operator")
    return seen
