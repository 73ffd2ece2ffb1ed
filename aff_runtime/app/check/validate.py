"""``python -m aff_runtime.app.check.validate SITE.yaml STATE [-]``: one result as JSON.

Runs in its own short and bounded process because parsing would hold up anything that shares its
interpreter. What the file names lies below its own folder or below STATE. With ``-`` the text on
standard input is judged as if SITE.yaml said it. Standard output gets
``{"record": {...} or null, "findings": [...]}``; the exit code is 0 whatever the result.
"""

from __future__ import annotations

import contextlib
import json
import platform
import sys
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from aff_runtime import __version__
from aff_runtime.app.check.limits import TOO_LARGE, bound_this_process
from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.link.packets import MAX_PACKET_BYTES
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.wiring.assemble import controller_of
from aff_runtime.app.wiring.impulse_responses import taps_by_actuator
from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.app.wiring.wires import gateway_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError, ConfigError, WireError
from aff_runtime.base.release import commit
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.can_wire import counter_ranges_rad, wire_files
from aff_runtime.config.findings import SiteFileError
from aff_runtime.config.identified_drive import with_identified
from aff_runtime.config.learned_responses import (
    LearnedResponses,
    learned_responses,
    response_files,
)
from aff_runtime.config.loader import Reading, read_site
from aff_runtime.config.revision import learned_digests, revision_with, site_hash_of
from aff_runtime.config.site_paths import STATE_DIRECTORY, shape_path
from aff_runtime.config.yaml_marks import MAX_BYTES
from aff_runtime.core.compiled.binary import arithmetic_name

MAX_RECORD_BYTES = MAX_PACKET_BYTES - 4096  # the rest of its packet is for what goes with it


def check_result(
    path: Path, state: Path = STATE_DIRECTORY, text: bytes | None = None
) -> CheckResult:
    """Return the parameter record of the file at ``path``, or what is wrong with it.

    Parameters
    ----------
    state : second folder, after the site file's own, that named files may lie in.
    text : checked in place of the content of the file; None: that content.
    """
    try:
        reading = read_site(path, state, text)
        learned = learned_responses(reading, path.absolute().parent)
        parameters = parameter_record(path, reading, learned)
    except AffError as error:
        return CheckResult(parameters=None, findings=tuple(str(error).splitlines()))
    findings = tuple(str(warning) for warning in (*reading.warnings, *learned.outdated))
    return CheckResult(parameters=parameters, findings=findings)


def refused_at_start(path: Path, state: Path = STATE_DIRECTORY) -> tuple[str, ...]:
    """Return why a service does not start with a file, whoever of its responses may be read.

    Touches no network: whether the PLC's name can be resolved is not asked. Empty: it starts.
    """
    try:
        reading = read_site(path, state)
        learned = replace(learned_responses(reading, path.absolute().parent), closed={})
        parameter_record(path, reading, learned, look_up=False)
    except AffError as error:
        return tuple(str(error).splitlines())
    return ()


def parameter_record(
    path: Path, reading: Reading, learned_by: LearnedResponses, *, look_up: bool = True
) -> ParameterRecord:
    """Return everything that the control process needs.

    ``look_up`` : ask the network for the PLC's name.

    Raises
    ------
    ConfigError
        When a response file cannot be used or the rooms refuse the numbers.
    """
    site = reading.site
    site_hash = site_hash_of(site)
    folder = path.absolute().parent
    files = response_files(reading, folder)
    if wrong := (*learned_by.errors, *learned_by.closed.values()):
        raise SiteFileError(wrong)
    responses = learned_by.texts
    site, drives = with_identified(site, learned_by.measured)
    described = wire_files(site, folder)
    if site.gateway.modbus is not None:
        register_map(site)
        if look_up and "host" in type(site.gateway.modbus).model_fields:
            _look_up(reading, folder)
    taps = taps_by_actuator(site, responses)
    ranges_rad = counter_ranges_rad(site, described)
    controller_of(site, responses, taps, ranges_rad)
    learned = learned_digests(responses, {})
    wire_digests = {name: text_digest(text) for name, text in described.items()}
    parameters = ParameterRecord(
        site=site,
        site_text=reading.tree.raw.decode("utf-8"),
        site_hash=site_hash,
        learned=learned,
        config_hash=revision_with(site_hash, learned, wire_digests),
        permissives=tuple(bit.name or "" for bit in guard_params(site).permissives.all_bits),
        responses=responses,
        loops=taps,
        counter_ranges_rad=ranges_rad,
        drives=tuple(str(drive) for drive in drives),
        response_files=files,
        shape_files={
            name: shape_path(file)
            for name, file in files.items()
            if site.actuators[name].uses_shape
        },
        wire_files=described,
        wire_digests=wire_digests,
        folder=folder,
        versions=_versions(),
    )
    _check_size(path, parameters)
    return parameters


def _check_size(path: Path, parameters: ParameterRecord) -> None:
    """Refuse a site file that with its responses is too long for the control process."""
    n_bytes = len(json.dumps(parameters.for_control().to_json()))
    if n_bytes > MAX_RECORD_BYTES:
        raise ConfigError(
            f"{path}:1:1  with its responses it takes {n_bytes // 1000} kB, at most "
            f"{MAX_RECORD_BYTES // 1000} kB pass to the control process; make it shorter"
        )


def _look_up(reading: Reading, folder: Path) -> None:
    """Refuse a PLC whose name nobody knows: the service could not even start."""
    try:
        gateway_of(reading.site, {}, MonotonicClock(), folder).close()
    except WireError as error:
        path = ("gateway", reading.site.gateway.wire, "host")
        raise ConfigError(str(reading.tree.finding(path, str(error)))) from None


def _versions() -> dict[str, str]:
    """Return the versions that a record should name."""
    names = {"python": platform.python_version(), "aff-runtime": __version__, "commit": commit()}
    names["arithmetic"] = arithmetic_name()
    for package in ("numpy", "pydantic", "pymodbus"):
        try:
            names[package] = version(package)
        except PackageNotFoundError:
            names[package] = "not installed"
    return names


def main(arguments: list[str]) -> int:
    """Print the result on one file, within the bounds of ``check.limits``."""
    bound_this_process()
    site, state = (Path(argument) for argument in arguments[:2])
    said = None
    with contextlib.suppress(MemoryError):  # what held the memory is freed below
        text = sys.stdin.buffer.read(MAX_BYTES + 1) if arguments[2:] else None
        said = check_result(site, state, text)
    too_large = CheckResult(parameters=None, findings=(f"{site}:1:1  {TOO_LARGE}",))
    json.dump((said or too_large).to_json(), sys.stdout)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
