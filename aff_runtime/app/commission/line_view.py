"""The site file as it was checked, the bounds of a probe, and what probes have found."""

from __future__ import annotations

import contextlib
import math
from dataclasses import fields

from aff_runtime.app.commission.card_view import proof_times
from aff_runtime.app.commission.messages import Request, Told
from aff_runtime.app.commission.sources import Where, standing_of
from aff_runtime.app.commission.talk import Talk
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, ConfigError
from aff_runtime.config.check import MAX_RESPONSE_BYTES, check_site
from aff_runtime.config.models import Actuator, Site
from aff_runtime.config.plain_file import read_plain
from aff_runtime.core.identified import Estimate, IdentifiedDrive
from aff_runtime.core.response import Response

MOST_LINES = 60


def line(where: Where, asked: Request, talk: Talk) -> Told:
    """Return what there is to know of the line before it is probed, and after."""
    with bounded_effort(str(where.site), ConfigError):
        report = check_site(where.site, (), where.state)
    view: Told = {
        "errors": [str(one) for one in report.errors][:MOST_LINES],
        "warnings": [str(one) for one in report.warnings][:MOST_LINES],
        "drives": list(report.drives),
        "orders": [],
        "limits": [],
        "probe": None,
        "proof": None,
        "responses": [],
    }
    site, facts = report.site, report.facts
    if site is None or facts is None:
        return {"line": view}
    view["orders"] = [str(one) for one in (*facts.orders, *facts.shapes)][:MOST_LINES]
    view["limits"] = [str(one) for one in facts.limits][:MOST_LINES]
    found = _responses(site, where)
    view["responses"] = [_response(name, one, site) for name, one in found.items()]
    view["probe"] = _bounds(site, found)
    with contextlib.suppress(AffError):
        standing = standing_of(where.socket)
        view["proof"] = proof_times(site, standing) if standing is not None else None
    return {"line": view}


def _responses(site: Site, where: Where) -> dict[str, Response]:
    """Return the measured responses as far as they can be read."""
    found: dict[str, Response] = {}
    for name, actuator in site.actuators.items():
        path = where.site.parent / actuator.response
        with contextlib.suppress(OSError, ValueError, AffError):
            found[name] = Response.from_json(read_plain(path, MAX_RESPONSE_BYTES).decode("utf-8"))
    return found


def _bounds(site: Site, found: dict[str, Response]) -> Told:
    """Return what a probe sends at most, and how large its ripple then was by the last probe."""
    rows = []
    for name, actuator in site.actuators.items():
        of_speed = actuator.output == "velocity_reference"
        amplitude = site.probe.amplitude_m_s if of_speed else site.probe.amplitude_N_m
        former = found.get(name)
        gain = max((one.gain for one in former.points), default=math.nan) if former else math.nan
        ripple = amplitude * gain
        rows.append(
            {
                "actuator": name,
                "amplitude": amplitude,
                "limit": actuator.limit,
                "unit": actuator.unit,
                "signal": actuator.error.signal,
                "signal_unit": _signal_unit(actuator),
                "ripple": ripple if math.isfinite(ripple) else None,
            }
        )
    return {"duration_s": site.probe.duration_s, "rows": rows}


def _response(name: str, found: Response, site: Site) -> Told:
    about = found.provenance
    return {
        "actuator": name,
        "unit": _gain_unit(site.actuators[name]),
        "measured_at": about.measured_at,
        "speed_m_s": _known(about.line_speed_m_s),
        "radius_m": _known(about.radius_m),
        "delay_s": found.delay_s,
        "points": [
            [
                one.frequency_Hz,
                one.gain,
                math.degrees(one.phase_rad),
                100.0 * one.relative_error,
                one.coherence,
            ]
            for one in found.points
        ],
        "drive": _drive(found.drive) if found.drive is not None else [],
    }


def _drive(found: IdentifiedDrive) -> list[Told]:
    """Return every identified number with its interval."""
    rows: list[Told] = []
    for one in fields(found):
        value = getattr(found, one.name)
        if isinstance(value, Estimate):
            numbers = {"value": value.value, "low": value.low, "high": value.high}
            rows.append({"name": one.name, **numbers, "is_sure": value.is_sure})
    return rows


def _signal_unit(actuator: Actuator) -> str:
    signal = actuator.error.signal
    return "N" if signal.endswith("_N") else "m/s" if signal.endswith("_m_s") else "1"


def _gain_unit(actuator: Actuator) -> str:
    return f"{_signal_unit(actuator)}/({actuator.unit})"


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
