"""``aff-runtime probe``: measure the loop's response with the running service."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from aff_runtime.app.link.answers import KeptResponse, ProbeDone
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.units import plain
from aff_runtime.cli.service import add_state_dir, connect
from aff_runtime.cli.terminal import say
from aff_runtime.config.identified_drive import numbers_of
from aff_runtime.config.models import Actuator, Site
from aff_runtime.core.response import MAX_PHASE_ERROR_RAD, MIN_COHERENCE, Response

MARGIN_S = 150.0  # the fit of a long record on a small machine
WANTED_COHERENCE = 0.9  # for the next probe: half the noise power that may be
LEAST_COHERENCE = 0.05  # below it noise alone gives as much


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "probe", parents=[service], help="measure the response while the line runs"
    )
    parser.add_argument("site", type=Path, metavar="SITE.yaml")
    parser.add_argument(
        "--actuator",
        action="append",
        default=[],
        metavar="NAME",
        help="only this actuator; may be repeated (default: all, one after the other)",
    )
    add_state_dir(parser)
    parser.set_defaults(command=probe)


def probe(options: argparse.Namespace) -> int:
    """Run a probe and print its table."""
    site = load_parameters(options.site, options.state_dir).checked().site
    duration_s = site.probe.duration_s
    say(f"probing for about {duration_s:.0f} s; `aff-runtime bypass` ends it")
    client = connect(options)
    try:
        answer = client.ask("probe", timeout_s=duration_s + MARGIN_S, actuators=options.actuator)
    finally:
        client.close()
    for kept in ProbeDone.from_json(answer).results:
        actuator = site.actuators[kept.result.actuator]
        for line in table(kept, actuator.response_unit):
            say(line)
        for line in unsure(Response.from_json(kept.result.text), *_excitation(site, actuator)):
            say(line)
    return 0


def table(kept: KeptResponse, unit: str) -> Iterator[str]:
    """Yield one probed actuator as text; ``unit`` is that of its gain."""
    result = kept.result
    yield f"{result.actuator}: sign {result.sign:+d}, delay {result.delay_s * 1e3:.0f} ms"
    yield f"      Hz {unit:>10}   phase deg  error %  coherence"
    measured = Response.from_json(result.text)
    for point in measured.points:
        yield (
            f"{point.frequency_Hz:8.3f} {point.gain:10.4g} "
            f"{math.degrees(point.phase_rad):11.1f} {point.relative_error * 100:8.1f} "
            f"{point.coherence:10.3f}"
        )
    if measured.drive is not None:
        yield f"  drive: {numbers_of(measured.drive)}"
    elif result.no_drive:
        yield f"  drive not identified: {result.no_drive}"
    for remark in result.remarks:
        yield f"  remark: {remark}"
    yield f"  kept in {kept.file}"


def _excitation(site: Site, actuator: Actuator) -> tuple[str, float]:
    """Return the key of the probe's amplitude and its value, SI."""
    if actuator.output == "velocity_reference":
        return "probe.amplitude_m_s", site.probe.amplitude_m_s
    return "probe.amplitude_N_m", site.probe.amplitude_N_m


def unsure(measured: Response, key: str, amplitude: float) -> Iterator[str]:
    """Yield what to do where frequencies were heard too badly for their orders to go out.

    Noise stays while the tones grow: (1 - coherence) / coherence falls with the amplitude squared.
    """
    bad = [
        point
        for point in measured.points
        if point.coherence < MIN_COHERENCE
        or measured.phase_error_bound_rad(point.frequency_Hz) > MAX_PHASE_ERROR_RAD
    ]
    if not bad:
        return
    worst = max(min(point.coherence for point in bad), LEAST_COHERENCE)
    times = math.sqrt((1.0 / worst - 1.0) / (1.0 / WANTED_COHERENCE - 1.0))
    yield (
        f"  {len(bad)} of {len(measured.points)} frequencies are not sure to 60 deg, or below a "
        f"coherence of {MIN_COHERENCE:g}: orders near them rest, and may keep it from arming"
    )
    louder = f"{_up(amplitude * max(times, 2.0))} (was {amplitude:g})"
    yield (
        f"  probe again with {key}: {louder}, if the web may ripple so, or with a longer "
        "probe.duration_s"
    )


def _up(value: float) -> str:
    """Return a number with one digit, not below ``value``."""
    step = 10.0 ** math.floor(math.log10(value))
    return plain(float(f"{math.ceil(value / step - 1e-9) * step:.1g}"))
