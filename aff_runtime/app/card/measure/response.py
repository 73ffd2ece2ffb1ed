"""Step 7: the response at three speeds or radii, twice each: repeat, coherence, sign."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import astuple, fields

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Figure, Sample, StepResult, at_least, at_most
from aff_runtime.app.card.measure.proof import enabled
from aff_runtime.config.meetings import frequency_Hz as order_Hz
from aff_runtime.core.probe.estimate import SIGN_BAND, low_direction, measured_sign
from aff_runtime.core.probe.repeats import MOST_REPEAT_ERRORS, alike, repeat_sigmas
from aff_runtime.core.response import (
    BAND_SLACK,
    MIN_COHERENCE,
    Provenance,
    Response,
    ResponsePoint,
    arming_objections,
)

OPERATING_POINTS, REPEATS = 3, 2
"""Speeds or radii that are asked for, and probes of each."""
LOUDER = (
    "orders that were heard too badly rest: probe louder or longer (probe.amplitude_m_s, "
    "probe.duration_s), as `aff-runtime probe` says, or leave them out"
)
KIND = "probe"
OF_POINT = ("line_speed_m_s", "radius_m")
NAMES = ("delay_s", *OF_POINT, "probed_here", "sign")
"""Numbers of a sample. ``probed_here``: 1 where this service says that it has measured it;
``sign``: as the geometry has it, typed by a person."""
COLUMNS = tuple(one.name for one in fields(ResponsePoint))


def typed_names(evidence: Evidence) -> tuple[str, ...]:
    """Return what may be typed: by actuator the sign that its geometry has."""
    return tuple(f"sign_{name}" for name in evidence.site.actuators)


def measure(evidence: Evidence) -> StepResult:
    """Return per actuator what was probed twice, and what the repeats say."""
    fresh = tuple(_new_samples(evidence))
    samples = (*(one for one in evidence.former if one.kind == KIND), *fresh)
    figures: list[Figure] = []
    missing: list[str] = []
    remarks: list[str] = []
    for name in evidence.site.actuators:
        mine = [one for one in samples if one.of == name]
        if not mine:
            missing.append(f"{name}: probe it (PROBE at the screen, or `aff-runtime probe`)")
            continue
        groups = by_operating_point(mine)
        figures.extend(_figures(evidence, name, groups))
        figures.append(_sign(evidence, name, mine[-1]))
        missing.extend(_missing(name, groups))
        missing.extend(_undecided(name, mine[-1]))
        remarks.extend(_remarks(evidence, name, mine))
    return StepResult(
        figures=tuple(figures), samples=fresh, missing=tuple(missing), remarks=tuple(remarks)
    )


def response_of(sample: Sample) -> Response:
    """Return the response that a sample keeps."""
    return Response(
        points=[ResponsePoint(**dict(zip(COLUMNS, row, strict=True))) for row in sample.rows],
        delay_s=sample.number("delay_s"),
        provenance=Provenance(actuator=sample.of, signal=""),
    )


def by_operating_point(samples: Sequence[Sample]) -> list[list[Sample]]:
    """Return probes grouped by speed and radius, in the order in which they were made."""
    groups: list[list[Sample]] = []
    for one in samples:
        for group in groups:
            if all(alike(one.number(n), group[0].number(n)) for n in OF_POINT):
                group.append(one)
                break
        else:
            groups.append([one])
    return groups


def _new_samples(evidence: Evidence) -> Iterator[Sample]:
    """Yield the responses that are kept now and are on no sample of before."""
    known = [one.rows for one in evidence.former]
    for name, response in evidence.responses.items():
        rows = tuple(astuple(point) for point in response.points)
        if rows in known:
            continue
        about = response.provenance
        sign = evidence.typed.number(f"sign_{name}", "")
        numbers = (
            response.delay_s,
            about.line_speed_m_s,
            about.radius_m,
            float(name in evidence.probed_here),
            sign,
        )
        yield Sample(kind=KIND, of=name, names=NAMES, numbers=numbers, columns=COLUMNS, rows=rows)


def _figures(evidence: Evidence, name: str, groups: list[list[Sample]]) -> Iterator[Figure]:
    twice = [group for group in groups if len(group) >= REPEATS]
    yield Figure(
        name=f"{name}: speeds or radii probed twice",
        value=float(len(twice)),
        limit=f"at least {OPERATING_POINTS}",
        # too few leave the step open: they can still be made
        good=True if len(twice) >= OPERATING_POINTS else None,
    )
    sigmas = [repeat_sigmas(*(response_of(one) for one in group[-2:])) for group in twice]
    worst = max(sigmas, default=NAN)
    yield Figure(
        name=f"{name}: difference of repeats over their stated error, worst",
        value=worst,
        limit=f"at most {MOST_REPEAT_ERRORS:g}",
        good=at_most(worst, MOST_REPEAT_ERRORS),
    )
    coherences = [one for group in groups for one in _coherences(evidence, name, group[-1])]
    coherence, order = min(coherences, key=lambda one: one[0], default=(NAN, ""))
    yield Figure(
        name=f"{name}: lowest coherence at the orders' frequencies in its band{order}",
        value=coherence,
        limit=f"at least {MIN_COHERENCE:g}",
        good=at_least(coherence, MIN_COHERENCE),
    )


def _sign(evidence: Evidence, name: str, sample: Sample) -> Figure:
    """Return the sign of the response as the probe itself takes it: 0 where it is undecided."""
    response = response_of(sample)
    sign = measured_sign(response.points, response.delay_s)
    expected = evidence.typed.number(f"sign_{name}", "")
    if not math.isfinite(expected):
        kept = [one.number("sign") for one in evidence.former if one.of == name]
        expected = next((value for value in reversed(kept) if math.isfinite(value)), NAN)
    return Figure(
        name=f"{name}: sign, {_low_phase(response)}",
        value=float(sign),
        limit=f"{expected:+.0f} by the geometry (typed)" if math.isfinite(expected) else "typed",
        good=sign == expected if sign and math.isfinite(expected) else None,
    )


def _low_phase(response: Response) -> str:
    """Return the phase that decides the sign, in words: near 90 deg it hardly does."""
    degrees = math.degrees(cmath.phase(low_direction(response.points, response.delay_s)))
    highest = SIGN_BAND * min(point.frequency_Hz for point in response.points)
    return f"phase {degrees:.0f} deg up to {highest:.3g} Hz, without its delay"


def _wanted_Hz(evidence: Evidence, name: str, sample: Sample) -> Iterator[tuple[str, float]]:
    speed, radius = sample.number("line_speed_m_s"), sample.number("radius_m")
    for block in enabled(evidence.site.actuators[name]):
        roll = evidence.site.rolls[block.roll]
        own = roll.radius_m or (radius if math.isfinite(radius) else roll.largest_radius_m)
        for order in block.orders:
            if math.isfinite(speed) and speed > 0.0:
                yield f"{block.roll} {order}x", order_Hz(order, speed, own)


def _coherences(evidence: Evidence, name: str, sample: Sample) -> Iterator[tuple[float, str]]:
    """Yield the coherence beside every order in the band, and which order that is.

    It is the number by which the service lets an order out or has it rest: chance in it decides
    there too, and gets no allowance here.
    """
    response = response_of(sample)
    low, high = response.band_Hz
    for order, f in _wanted_Hz(evidence, name, sample):
        if low / BAND_SLACK <= f <= high * BAND_SLACK:
            yield _nearest(response, f).coherence, f" ({order} at {f:.3g} Hz)"


def _nearest(response: Response, frequency_Hz: float) -> ResponsePoint:
    return min(response.points, key=lambda point: abs(point.frequency_Hz - frequency_Hz))


def _missing(name: str, groups: list[list[Sample]]) -> Iterator[str]:
    for one in (group[0] for group in groups if len(group) < REPEATS):
        radius = one.number("radius_m")
        at = f", radius {radius:.3g} m" if math.isfinite(radius) else ""
        yield f"{name}: once more at {one.number('line_speed_m_s'):.3g} m/s{at}"
    if len(groups) < OPERATING_POINTS:
        yield f"{name}: {OPERATING_POINTS - len(groups)} more speeds or radii"


def _undecided(name: str, sample: Sample) -> Iterator[str]:
    response = response_of(sample)
    if not measured_sign(response.points, response.delay_s):
        yield f"{name}: no sign can be told ({_low_phase(response)}): probe lower or louder"


def _remarks(evidence: Evidence, name: str, samples: Sequence[Sample]) -> Iterator[str]:
    if any(one.number("probed_here") != 1.0 for one in samples):
        yield f"{name}: the service does not say of every response that it has probed it"
    newest = samples[-1]
    if any(coherence < MIN_COHERENCE for coherence, _ in _coherences(evidence, name, newest)):
        yield f"{name}: {LOUDER}"
    for text in arming_objections(response_of(newest), _wanted_Hz(evidence, name, newest)):
        yield f"{name}: {text}"
