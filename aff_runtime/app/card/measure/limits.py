"""Steps 3 and 4: limits that the PLC has as well, and what its watchdog does."""

from __future__ import annotations

import math
from collections.abc import Iterator

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import Figure, StepResult, at_least, at_most

FEWEST_COUNTS = 5.0  # a limit is at least so many counts of its word
WATCHDOG_LIMIT_MS = 300.0
UNDERSTOOD = "warnings_understood"
WATCHDOG_TYPED = ("reaction", "time")
GOOD_REACTIONS, BAD_REACTIONS = ("zero", "ramp"), ("hold",)


def typed_names(evidence: Evidence) -> tuple[str, ...]:
    """Return what may be typed: a limit by actuator, and how many warnings are understood."""
    return (*evidence.site.actuators, UNDERSTOOD)


def measure(evidence: Evidence) -> StepResult:
    """Return each limit against the PLC's, in counts of its word, and the check's warnings."""
    figures: list[Figure] = []
    missing: list[str] = []
    for name, actuator in evidence.site.actuators.items():
        in_plc = evidence.typed.number(name, actuator.unit)
        if math.isfinite(in_plc):
            figures.append(_against_plc(name, actuator.limit, in_plc, actuator.unit))
        else:
            missing.append(f"type the PLC's limit: {name}=... {actuator.unit}")
    figures.extend(_counts(evidence))
    warnings = evidence.checked.warnings
    understood = evidence.typed.number(UNDERSTOOD, "")
    if warnings and not math.isfinite(understood):
        missing.append(f"read the warnings one by one, then type {UNDERSTOOD}={len(warnings)}")
    if warnings:
        figures.append(
            Figure(
                name="warnings of the check that are understood",
                value=understood,
                limit=f"all {len(warnings)}",
                good=understood == len(warnings) if math.isfinite(understood) else None,
            )
        )
    return StepResult(
        figures=tuple(figures),
        missing=tuple(missing),
        remarks=tuple(f"warning: {text}" for text in warnings),
    )


def watchdog(evidence: Evidence) -> StepResult:
    """Return the reaction and its time as they were typed."""
    reaction = evidence.typed.word("reaction")
    time_ms = 1e3 * evidence.typed.number("time", "s")
    missing = []
    if reaction not in (*GOOD_REACTIONS, *BAD_REACTIONS):
        missing.append("type what the drive did: reaction=zero, ramp or hold")
    if not math.isfinite(time_ms):
        missing.append("type how long it took: time=120 ms")
    return StepResult(
        figures=(
            Figure(
                name=f"reaction of the watchdog: {reaction or 'not typed'}",
                value=float(reaction in GOOD_REACTIONS) if not missing else math.nan,
                limit="zero or ramp, never hold",
                good=None if missing else reaction in GOOD_REACTIONS,
            ),
            Figure(
                name="time of the reaction (typed)",
                value=time_ms,
                unit="ms",
                limit=f"at most {WATCHDOG_LIMIT_MS:g} ms",
                good=at_most(time_ms, WATCHDOG_LIMIT_MS),
            ),
        ),
        missing=tuple(missing),
    )


def _against_plc(name: str, ours: float, in_plc: float, unit: str) -> Figure:
    return Figure(
        name=f"{name}: limit of the site file",
        value=ours,
        unit=unit,
        limit=f"at most the PLC's {in_plc:g} {unit} (typed)",
        good=at_most(ours, in_plc * (1.0 + 1e-9)),
    )


def _counts(evidence: Evidence) -> Iterator[Figure]:
    for fact in evidence.checked.limits:
        yield Figure(
            name=f"{fact.path} in counts",
            value=fact.counts,
            unit="counts",
            limit=f"at least {FEWEST_COUNTS:g}",
            good=at_least(fact.counts, FEWEST_COUNTS),
        )
