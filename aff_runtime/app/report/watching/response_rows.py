"""What probes measured during a run, at a few frequencies that are the same for every probe.

A probe places its tones anew, by speed and orders. Between two tones that are close the response
has a value of its own (`core.response`); that is what is followed over weeks.
"""

from __future__ import annotations

import cmath
import itertools
import math
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from aff_runtime.app.report.watching.order_rows import is_wound
from aff_runtime.app.report.watching.tables import ResponseRow
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.runs.files import text_of, yaml_values
from aff_runtime.base.runs.responses import (
    GAIN,
    LARGEST_RESPONSE,
    MOST_RESPONSES,
    RESPONSE_FILE,
    UNITS,
    response_file,
)
from aff_runtime.base.yaml_section import Section
from aff_runtime.core.response import Response

FIXED_HZ = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Frequencies that are followed: octaves over what rolls of a web line turn at."""
CLOSE = 1.5
"""Ratio of the two tones beside a fixed frequency, at most: half an octave and a little, so that
what a straight line between them leaves out is small beside what it bridges."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredResponse:
    """A response with when it was measured and the unit of its gain."""

    response: Response
    at: datetime
    gain_unit: str


def measured_responses(folder: Path) -> tuple[tuple[MeasuredResponse, ...], tuple[str, ...]]:
    """Return what probes measured during a run, in time, and what is said of files that are none.

    A run of an earlier release has none.
    """
    try:
        names = sorted(name for name in os.listdir(folder) if RESPONSE_FILE.fullmatch(name))
    except OSError:
        return (), ()
    found, lost = list[MeasuredResponse](), list[str]()
    for name in names[:MOST_RESPONSES]:
        text = text_of(folder / name, LARGEST_RESPONSE)
        try:
            response = Response.from_json(text)
            at = datetime.fromisoformat(response.provenance.measured_at)
            units = Section.of(yaml_values(text)).section(UNITS)
        except (ConfigError, ValueError, OverflowError):
            lost.append(f"{name}: is no response with the time at which it was measured; left out")
            continue
        if name != response_file(response.provenance.actuator, text):
            lost.append(
                f"{name}: is not the response that was measured, by the hash in its name, altered "
                "since or under another name; left out, copy it anew from the gateway"
            )
            continue
        at = at.astimezone(UTC) if at.tzinfo else at.replace(tzinfo=UTC)
        gain_unit = printable(text_or(units.get(GAIN)), 20)
        found.append(MeasuredResponse(response=response, at=at, gain_unit=gain_unit))
    return tuple(sorted(found, key=lambda one: one.at)), tuple(lost)


def response_rows(
    measured: Iterable[MeasuredResponse], run_id: str, hour: int, site: Section
) -> Iterator[ResponseRow]:
    """Yield a row per response and fixed frequency at which it is known."""
    for one in measured:
        about = one.response.provenance
        blocks = site.section("actuators").section(about.actuator).get("blocks")
        first = Section.of(blocks[0]) if isinstance(blocks, list) and blocks else Section()
        roll = text_or(first.get("roll"), about.actuator)
        for fixed_Hz in FIXED_HZ:
            errors = errors_at(one.response, fixed_Hz)
            if errors is None:
                continue
            value = one.response.at(fixed_Hz)
            yield ResponseRow(
                run_id=run_id,
                hour=hour,
                time_utc=np.datetime64(one.at.replace(tzinfo=None), "us"),
                signal=printable(about.signal, 100),
                actuator=printable(about.actuator, 100),
                roll=printable(roll, 100),
                is_roll=is_wound(site.section("rolls").section(roll)),
                frequency_Hz=fixed_Hz,
                gain=abs(value),
                gain_error=abs(value) * errors[0],
                gain_unit=one.gain_unit,
                phase_rad=cmath.phase(value),
                phase_error_rad=errors[1],
                speed_m_s=abs(about.line_speed_m_s),
                radius_m=about.radius_m,
            )


def errors_at(response: Response, frequency_Hz: float) -> tuple[float, float] | None:
    """Return the standard errors of gain (as a share) and phase (rad); None where not known.

    It is known inside the band, between two tones whose ratio is at most ``CLOSE``, or on one.
    Each error is that of the worse tone, half of whose power is along P and half across it, and
    beside it what a straight line may leave out: share (1 - share) of the step between the tones,
    as in the response's own bound.
    """
    points = response.points
    for point in points:
        if point.frequency_Hz == frequency_Hz:
            noise = point.relative_error / math.sqrt(2.0)
            return noise, noise
    for low, high in itertools.pairwise(points):
        if not low.frequency_Hz < frequency_Hz < high.frequency_Hz:
            continue
        if high.frequency_Hz > CLOSE * low.frequency_Hz:
            return None
        width_Hz = high.frequency_Hz - low.frequency_Hz
        share = (frequency_Hz - low.frequency_Hz) / width_Hz
        noise = max(low.relative_error, high.relative_error) / math.sqrt(2.0)
        left_out = share * (1.0 - share)
        turned = high.phase_rad - low.phase_rad + math.tau * width_Hz * response.delay_s
        gain = left_out * math.log(high.gain / low.gain)
        phase = left_out * math.remainder(turned, math.tau)
        return math.hypot(noise, gain), math.hypot(noise, phase)
    return None
