"""The site file as it was checked, the bounds of a probe, and what probes have found."""

from __future__ import annotations

import contextlib
import math
from dataclasses import fields, replace

from aff_runtime.app.commission.card.view import proof_times
from aff_runtime.app.commission.link.answers import LineShown
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths, status_of
from aff_runtime.app.commission.views.of_line import (
    DriveRow,
    LineView,
    PointView,
    ProbeRow,
    ProbeView,
    ResponseView,
)
from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, ConfigError
from aff_runtime.base.numbers import finite_or_none
from aff_runtime.config.check import check_site
from aff_runtime.config.identified_drive import why_no_drive, with_identified
from aff_runtime.config.learned_responses import MAX_RESPONSE_BYTES
from aff_runtime.config.models import Site
from aff_runtime.config.plain_file import read_plain
from aff_runtime.config.probe_bound import TIMES_LOUDER, expected_ripple, probe_bound
from aff_runtime.core.identified import Estimate, IdentifiedDrive
from aff_runtime.core.probe.probe import Probe
from aff_runtime.core.probe.repeats import MOST_REPEAT_ERRORS
from aff_runtime.core.response import MIN_COHERENCE, Response

MOST_MESSAGES = 60
ROUNDED = 1.0 + 1e-6
"""A bound is reached within this."""


def line(where: Paths, asked: Request, talk: Talk) -> LineShown:
    """Return what there is to know of the line before it is probed, and after."""
    with bounded_effort(str(where.site), ConfigError):
        report = check_site(where.site, (), where.state)
    view = LineView(
        errors=tuple(str(one) for one in report.errors)[:MOST_MESSAGES],
        warnings=tuple(str(one) for one in report.warnings)[:MOST_MESSAGES],
        drives=tuple(report.drives),
    )
    site, facts = report.site, report.facts
    if site is None or facts is None:
        return LineShown(line=view)
    responses = _responses(site, where)
    in_use, _ = with_identified(site, responses)
    proof = None
    speed_m_s = math.nan
    with contextlib.suppress(AffError):
        status = status_of(where.socket)
        if status is not None and status.live is not None:
            speed_m_s = status.live.tick.number(site.line.speed)
        proof = proof_times(in_use, status) if status is not None else None
    view = replace(
        view,
        orders=tuple(str(one) for one in (*facts.orders, *facts.shapes))[:MOST_MESSAGES],
        limits=tuple(str(one) for one in facts.limits)[:MOST_MESSAGES],
        probe=_bounds(site, responses, speed_m_s),
        proof=proof,
        stands_in=tuple(name for name, one in in_use.actuators.items() if one.stands_in),
        responses=tuple(_response(name, one, site) for name, one in responses.items()),
    )
    return LineShown(line=view)


def _responses(site: Site, where: Paths) -> dict[str, Response]:
    """Return the measured responses as far as they can be read."""
    responses: dict[str, Response] = {}
    for name, actuator in site.actuators.items():
        path = where.site.parent / actuator.response
        with contextlib.suppress(OSError, ValueError, AffError):
            responses[name] = Response.from_json(
                read_plain(path, MAX_RESPONSE_BYTES).decode("utf-8")
            )
    return responses


def _bounds(site: Site, responses: dict[str, Response], speed_m_s: float) -> ProbeView:
    """Return what a probe sends at most, and how far the last response says the signal moves.

    Before a first one what the web is says it, at ``speed_m_s``; NaN where that is not known.
    """
    rows = []
    for name, actuator in site.actuators.items():
        bound = probe_bound(site, name)
        amplitude = bound.most if bound.given is None else bound.given
        former = responses.get(name)
        ripple = amplitude * _gain_of(former)
        expected = expected_ripple(site, name, amplitude, speed_m_s)
        most_N = math.inf if bound.bound_N is None else bound.bound_N
        rows.append(
            ProbeRow(
                actuator=name,
                amplitude=amplitude,
                limit=actuator.limit,
                unit=actuator.unit,
                signal=actuator.error.signal,
                signal_unit=unit_of_channel(actuator.error.signal) or "1",
                ripple=finite_or_none(
                    ripple if bound.bound_N is None else min(ripple, bound.bound_N)
                ),
                expected_ripple_N=min(expected.ripple_N, most_N)
                if expected.ripple_N is not None
                else None,
                speed_m_s=expected.speed_m_s,
                lacks=expected.lacks,
                is_chosen=bound.given is None,
                bound_N=bound.bound_N,
                bound_share=bound.share,
                sent=finite_or_none(former.provenance.amplitude) if former else None,
                louder=_louder(former, max(amplitude, bound.most)),
            )
        )
    return ProbeView(duration_s=_longest_s(site), rows=tuple(rows))


def _longest_s(site: Site) -> float:
    """Return how long a probe takes at most, the choice of its size with it.

    It is one of all actuators of a kind of output: other kinds are probed by themselves.
    """
    params = site_params(site)
    kinds: dict[str, list[str]] = {}
    for name, actuator in site.actuators.items():
        kinds.setdefault(actuator.output, []).append(name)
    return max(Probe(params, probe_params(site, one), {}).expected_s for one in kinds.values())


def _gain_of(former: Response | None) -> float:
    """Return the largest gain of a response, NaN of none."""
    return max((one.gain for one in former.points), default=math.nan) if former else math.nan


def _louder(former: Response | None, most: float) -> float | None:
    """Return what a louder probe would send; None where it is of no use, or may not be."""
    sent = former.provenance.amplitude if former else math.nan
    if former is None or not 0.0 < sent * ROUNDED < most:
        return None
    unsure = any(point.coherence < MIN_COHERENCE for point in former.points)
    return min(TIMES_LOUDER * sent, most) if unsure else None


def _response(name: str, response: Response, site: Site) -> ResponseView:
    about = response.provenance
    return ResponseView(
        actuator=name,
        unit=site.actuators[name].response_unit,
        measured_at=about.measured_at,
        speed_m_s=finite_or_none(about.line_speed_m_s),
        radius_m=finite_or_none(about.radius_m),
        delay_s=response.delay_s,
        points=tuple(
            PointView(
                frequency_Hz=one.frequency_Hz,
                gain=one.gain,
                phase_deg=math.degrees(one.phase_rad),
                error_percent=100.0 * one.relative_error,
                coherence=one.coherence,
            )
            for one in response.points
        ),
        drive=_drive(response.drive) if response.drive is not None else (),
        no_drive=why_no_drive(response)
        if response.drive is None and site.actuators[name].stands_in
        else "",
        repeat_sigmas=finite_or_none(about.repeat_sigmas),
        repeat_most=MOST_REPEAT_ERRORS,
    )


def _drive(drive: IdentifiedDrive) -> tuple[DriveRow, ...]:
    """Return every identified number with its interval."""
    numbers = ((one.name, getattr(drive, one.name)) for one in fields(drive))
    return tuple(
        DriveRow(name=name, value=one.value, low=one.low, high=one.high, is_sure=one.is_sure)
        for name, one in numbers
        if isinstance(one, Estimate)
    )
