"""``aff-runtime probe``: measure the loop's response with the running service."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from aff_runtime.app.link.answers import KeptResponse, ProbeDone
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.units import plain
from aff_runtime.cli.service import add_state_dir, connect
from aff_runtime.cli.terminal import say
from aff_runtime.config.identified_drive import numbers_of
from aff_runtime.config.models import Site
from aff_runtime.config.probe_bound import probe_bound
from aff_runtime.core.probe.repeats import MOST_REPEAT_ERRORS
from aff_runtime.core.response import MAX_PHASE_ERROR_RAD, MIN_COHERENCE, Response

CHOOSING_S = 80.0  # per actuator: a quiet stretch and three steps of 10 s, and their fades
MARGIN_S = 150.0  # the fit of a long record on a small machine
WANTED_COHERENCE = 0.9  # for the next probe: half the noise power that may be
NEARLY = 0.99  # of the bound: no louder probe then
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
    parser.add_argument(
        "--louder",
        action="store_true",
        help="send twice what was sent for the responses in force, as far as the bound lets",
    )
    parser.add_argument(
        "--twice",
        action="store_true",
        help="probe again at once: how far the two are apart tells whether their errors are right",
    )
    add_state_dir(parser)
    parser.set_defaults(command=probe)


def probe(options: argparse.Namespace) -> int:
    """Run a probe and print its table."""
    site = load_parameters(options.site, options.state_dir).checked().site
    names = options.actuator or list(site.actuators)
    for line in bounds(site, names):
        say(line)
    for count in range(1 + options.twice):
        _once(options, site, names, louder=options.louder and count == 0)
    return 0


def _once(options: argparse.Namespace, site: Site, names: list[str], *, louder: bool) -> None:
    """Run one probe and print its table."""
    duration_s = site.probe.duration_s
    choosing_s = CHOOSING_S * len(names) * any(is_chosen(site, name) for name in names)
    before = f", and up to {choosing_s:.0f} s before for the choice of it" if choosing_s else ""
    say(f"probing for about {duration_s:.0f} s{before}; `aff-runtime bypass` ends it")
    client = connect(options)
    try:
        answer = client.ask(
            "probe",
            timeout_s=duration_s + choosing_s + MARGIN_S,
            actuators=options.actuator,
            **({"louder": True} if louder else {}),
        )
    finally:
        client.close()
    for kept in ProbeDone.from_json(answer).results:
        actuator = site.actuators[kept.result.actuator]
        measured = Response.from_json(kept.result.text)
        wants_drive = actuator.stands_in
        for line in table(kept, actuator.response_unit, actuator.unit, wants_drive=wants_drive):
            say(line)
        bound = probe_bound(site, kept.result.actuator)
        if bound.given is None:
            amplitude, key = bound.most, bound.key
        else:
            amplitude, key = bound.given, bound.key.replace("bound", "amplitude")
        is_less = measured.provenance.amplitude < NEARLY * bound.most
        for line in unsure(measured, key, amplitude, may_be_louder=is_less):
            say(line)


def is_chosen(site: Site, name: str) -> bool:
    """Return whether the amplitude at an actuator is chosen from the noise."""
    return probe_bound(site, name).given is None


def bounds(site: Site, names: Sequence[str]) -> Iterator[str]:
    """Yield what a probe will send and move at most, before it does."""
    for name in names:
        actuator, bound = site.actuators[name], probe_bound(site, name)
        signal, unit = actuator.error.signal, actuator.unit
        sent = (
            f"at most {bound.most:g} {unit}, chosen from the noise"
            if bound.given is None
            else f"{bound.given:g} {unit}"
        )
        moved = ""
        if bound.bound_N is not None:
            moved = f"; it ends where {signal} moves by {bound.bound_N:g} N"
        elif bound.share is not None:
            moved = f"; it ends where {signal} moves by {bound.share:.0%} of what it is"
        yield f"{name}: {sent}{moved}"


def table(
    kept: KeptResponse, unit: str, sent_unit: str, *, wants_drive: bool = False
) -> Iterator[str]:
    """Yield one probed actuator as text; ``unit`` is that of its gain.

    ``wants_drive`` : its law waits for the numbers of the drive.
    """
    result = kept.result
    yield f"{result.actuator}: sign {result.sign:+d}, delay {result.delay_s * 1e3:.0f} ms"
    measured = Response.from_json(result.text)
    about = measured.provenance
    if math.isfinite(about.amplitude):
        yield f"  sent: {about.amplitude:.3g} {sent_unit} at most"
    if math.isfinite(about.repeat_sigmas):
        yield (
            f"  against the probe before: {about.repeat_sigmas:.2f} of the stated errors apart "
            f"(1 where they are right, at most {MOST_REPEAT_ERRORS:g})"
        )
    yield f"      Hz {unit:>10}   phase deg  error %  coherence"
    for point in measured.points:
        yield (
            f"{point.frequency_Hz:8.3f} {point.gain:10.4g} "
            f"{math.degrees(point.phase_rad):11.1f} {point.relative_error * 100:8.1f} "
            f"{point.coherence:10.3f}"
        )
    if measured.drive is not None:
        yield f"  drive: {numbers_of(measured.drive)}"
    elif wants_drive:
        yield f"  drive not identified: {measured.no_drive}"
    for remark in result.remarks:
        yield f"  remark: {remark}"
    yield f"  kept in {kept.file}"


def unsure(
    measured: Response, key: str, amplitude: float, *, may_be_louder: bool = False
) -> Iterator[str]:
    """Yield what to do where frequencies were heard too badly for their orders to go out.

    ``may_be_louder`` : less was sent than the bound lets.

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
    if may_be_louder:
        yield "  probe again with --louder, within its bound, or with a longer probe.duration_s"
        return
    louder = f"{_up(amplitude * max(times, 2.0))} (was {amplitude:g})"
    yield (
        f"  probe again with {key}: {louder}, if the web may ripple so, or with a longer "
        "probe.duration_s"
    )


def _up(value: float) -> str:
    """Return a number with one digit, not below ``value``."""
    step = 10.0 ** math.floor(math.log10(value))
    return plain(float(f"{math.ceil(value / step - 1e-9) * step:.1g}"))
