"""Step 7: the response at three speeds or radii, twice each: repeat, coherence, sign."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import astuple, fields, replace

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Figure, Finding, Sample, at_least, at_most
from aff_runtime.config.crossings import frequency_Hz as order_Hz
from aff_runtime.core.response import (
    BAND_SLACK,
    MIN_COHERENCE,
    Provenance,
    Response,
    ResponsePoint,
    arming_objections,
)

PLACES, REPEATS, SIGMAS = 3, 2, 2.0
FEWEST_TONES, SAME_DIGITS = 8, 6
LOUDER = (
    "orders that were heard too badly rest: probe louder or longer (probe.amplitude_m_s, "
    "probe.duration_s), as `aff-runtime probe` says, or leave them out"
)
LIKE = 0.05
"""Probes whose speed and radius differ by less are repeats."""
KIND = "probe"
NAMES = ("delay_s", "line_speed_m_s", "radius_m", "probed_here", "sign")
COLUMNS = tuple(one.name for one in fields(ResponsePoint))


def typed_names(evidence: Evidence) -> tuple[str, ...]:
    """Return what may be typed: by actuator the sign that its geometry has."""
    return tuple(f"sign_{name}" for name in evidence.site.actuators)


def measure(evidence: Evidence) -> Finding:
    """Return per actuator how many places were probed twice, and what the repeats say."""
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
        places = by_place(mine)
        figures.extend(_figures(evidence, name, places))
        missing.extend(_missing(name, places))
        remarks.extend(_remarks(evidence, name, mine))
    return Finding(
        figures=tuple(figures), samples=fresh, missing=tuple(missing), remarks=tuple(remarks)
    )


def response_of(sample: Sample) -> Response:
    """Return the response that a sample keeps."""
    return Response(
        points=[ResponsePoint(**dict(zip(COLUMNS, row, strict=True))) for row in sample.rows],
        delay_s=sample.number("delay_s"),
        provenance=Provenance(actuator=sample.of, signal=""),
    )


def by_place(samples: Sequence[Sample]) -> list[list[Sample]]:
    """Return probes grouped by speed and radius, in the order in which they were made."""
    places: list[list[Sample]] = []
    for one in samples:
        for place in places:
            if all(_alike(one.number(n), place[0].number(n)) for n in NAMES[1:3]):
                place.append(one)
                break
        else:
            places.append([one])
    return places


def repeat_sigmas(first: Response, second: Response) -> float:
    """Return how far two probes of one place are apart, in standard errors of the difference.

    Equation: sqrt(mean |P1 - P2|^2 / (s1^2 + s2^2)), s the standard error of each; 1 where the
    stated errors are right. It is a mean over all tones, not the worst of them: with errors that
    are right and 20 tones or more it stays below 1.3, whatever their number. ``SIGMAS`` of 2 says
    that errors are stated half as large as they are.

    Tones that both have are compared. A second probe may have moved some of its tones out of the
    way of another ripple: what lies between two points of the first is known less well than its
    points, and counts only where both have too few in common.
    """
    known = {round(point.frequency_Hz, SAME_DIGITS): point for point in first.points}
    pairs = [
        (known[key], point)
        for point in second.points
        if (key := round(point.frequency_Hz, SAME_DIGITS)) in known
    ]
    if len(pairs) < FEWEST_TONES:
        pairs = list(_between(first, second))
    squares = [_square(one, other) for one, other in pairs]
    return math.sqrt(sum(squares) / len(squares)) if squares else NAN


def _between(first: Response, second: Response) -> Iterator[tuple[ResponsePoint, ResponsePoint]]:
    """Yield the points of the second inside the band of the first, and what that has there."""
    low, high = first.band_Hz
    for point in second.points:
        if low <= point.frequency_Hz <= high:
            there = first.at(point.frequency_Hz)
            near = _nearest(first, point.frequency_Hz)
            yield replace(near, gain=abs(there), phase_rad=cmath.phase(there)), point


def _square(one: ResponsePoint, other: ResponsePoint) -> float:
    """Return the squared difference of two points in their standard errors."""
    apart = cmath.rect(one.gain, one.phase_rad) - cmath.rect(other.gain, other.phase_rad)
    errors = [point.gain * point.relative_error for point in (one, other)]
    return (abs(apart) / math.hypot(*errors, 1e-12)) ** 2


def _alike(first: float, last: float) -> bool:
    if not (math.isfinite(first) and math.isfinite(last)):
        return math.isfinite(first) == math.isfinite(last)
    return abs(first - last) <= LIKE * max(abs(first), abs(last))


def _new_samples(evidence: Evidence) -> Iterator[Sample]:
    """Yield the responses that are kept now and are on no sample of before."""
    known = [one.rows for one in evidence.former]
    for name, response in evidence.responses.items():
        rows = tuple(astuple(point) for point in response.points)
        if rows in known:
            continue
        about = response.provenance
        typed = evidence.typed.number(f"sign_{name}", "")
        numbers = (
            response.delay_s,
            about.line_speed_m_s,
            about.radius_m,
            float(name in evidence.probed_here),
            typed,
        )
        yield Sample(kind=KIND, of=name, names=NAMES, numbers=numbers, columns=COLUMNS, rows=rows)


def _figures(evidence: Evidence, name: str, places: list[list[Sample]]) -> Iterator[Figure]:
    twice = [place for place in places if len(place) >= REPEATS]
    yield Figure(
        name=f"{name}: speeds or radii probed twice",
        value=float(len(twice)),
        limit=f"at least {PLACES}",
        good=True if len(twice) >= PLACES else None,
    )
    sigmas = [repeat_sigmas(*(response_of(one) for one in place[-2:])) for place in twice]
    worst = max(sigmas, default=NAN)
    yield Figure(
        name=f"{name}: difference of repeats over their stated error, worst",
        value=worst,
        limit=f"at most {SIGMAS:g}",
        good=at_most(worst, SIGMAS),
    )
    heard = [one for place in places for one in _heard(evidence, name, place[-1])]
    coherence, order = min(heard, key=lambda one: one[0], default=(NAN, ""))
    yield Figure(
        name=f"{name}: lowest coherence at the orders' frequencies in its band{order}",
        value=coherence,
        limit=f"at least {MIN_COHERENCE:g}",
        good=at_least(coherence, MIN_COHERENCE),
    )
    yield _sign(evidence, name, places[-1][-1])


def _sign(evidence: Evidence, name: str, sample: Sample) -> Figure:
    """Return the sign of the response at its lowest frequency, its delay taken out."""
    response = response_of(sample)
    lowest = response.points[0]
    phase = lowest.phase_rad + math.tau * lowest.frequency_Hz * response.delay_s
    sign = math.copysign(1.0, math.cos(phase))
    expected = evidence.typed.number(f"sign_{name}", "")
    if not math.isfinite(expected):
        kept = [one.number("sign") for one in evidence.former if one.of == name]
        expected = next((value for value in reversed(kept) if math.isfinite(value)), NAN)
    return Figure(
        name=f"{name}: sign at {lowest.frequency_Hz:.3g} Hz",
        value=sign,
        limit=f"{expected:+.0f} by the geometry (typed)" if math.isfinite(expected) else "typed",
        good=sign == expected if math.isfinite(expected) else None,
    )


def _wanted_Hz(evidence: Evidence, name: str, sample: Sample) -> Iterator[tuple[str, float]]:
    speed, radius = sample.number("line_speed_m_s"), sample.number("radius_m")
    for block in evidence.site.actuators[name].blocks:
        roll = evidence.site.rolls[block.roll]
        own = roll.radius_m or (radius if math.isfinite(radius) else roll.largest_radius_m)
        for order in block.orders:
            if math.isfinite(speed) and speed > 0.0:
                yield f"{block.roll} {order}x", order_Hz(order, speed, own)


def _heard(evidence: Evidence, name: str, sample: Sample) -> Iterator[tuple[float, str]]:
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


def _missing(name: str, places: list[list[Sample]]) -> Iterator[str]:
    once = [place[0] for place in places if len(place) < REPEATS]
    for one in once:
        yield (
            f"{name}: once more at {one.number('line_speed_m_s'):.3g} m/s, radius "
            f"{one.number('radius_m'):.3g} m"
        )
    if len(places) < PLACES:
        yield f"{name}: {PLACES - len(places)} more speeds or radii"


def _remarks(evidence: Evidence, name: str, samples: Sequence[Sample]) -> Iterator[str]:
    if any(one.number("probed_here") != 1.0 for one in samples):
        yield f"{name}: the service does not say of every response that it has probed it"
    newest = samples[-1]
    if any(coherence < MIN_COHERENCE for coherence, _ in _heard(evidence, name, newest)):
        yield f"{name}: {LOUDER}"
    for text in arming_objections(response_of(newest), _wanted_Hz(evidence, name, newest)):
        yield f"{name}: {text}"
