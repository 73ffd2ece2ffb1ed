"""``python -m aff_runtime.app.validate SITE.yaml``: one verdict as JSON on standard output.

Runs in its own short process because parsing would hold up anything that shares its interpreter.
Exit code 0 whatever the verdict: ``{"record": {...} or null, "findings": [...]}``.
"""

from __future__ import annotations

import json
import platform
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from aff_runtime import __version__
from aff_runtime.app.site_to_guard import guard_params
from aff_runtime.app.site_to_law import site_params
from aff_runtime.app.site_to_wire import register_map
from aff_runtime.base.errors import AffError, ConfigError
from aff_runtime.config.can_wire import wire_files
from aff_runtime.config.loader import Reading, read_site
from aff_runtime.config.revision import revision_hash
from aff_runtime.core.controller import Controller
from aff_runtime.core.response import Response


def verdict(path: Path) -> dict[str, Any]:
    """Return the parameter record of the file at ``path``, or what is wrong with it."""
    try:
        reading = read_site(path)
        record = parameter_record(path, reading)
    except AffError as error:
        return {"record": None, "findings": str(error).splitlines()}
    return {"record": record, "findings": [str(warning) for warning in reading.warnings]}


def parameter_record(path: Path, reading: Reading) -> dict[str, Any]:
    """Return everything that the control process needs, ready for JSON.

    Raises
    ------
    ConfigError
        When a response file cannot be used or the rooms refuse the numbers.
    """
    site = reading.site
    plain = site.model_dump(mode="json", by_alias=True)
    folder = path.absolute().parent
    files = {name: folder / actuator.response for name, actuator in site.actuators.items()}
    texts = {name: _response_text(reading, name, file) for name, file in files.items()}
    responses = {name: text for name, text in texts.items() if text is not None}
    described = wire_files(site, folder)
    if site.gateway.modbus is not None:
        register_map(site)
    Controller(site_params(site), {n: Response.from_json(t) for n, t in responses.items()})
    return {
        "site": plain,
        "site_text": path.read_text(encoding="utf-8"),
        "config_hash": revision_hash(site),
        "permissives": [bit.name for bit in guard_params(site).permissives.all_bits],
        "responses": responses,
        "response_files": {name: str(file) for name, file in files.items()},
        "wire_files": described,
        "folder": str(folder),
        "versions": _versions(),
    }


def _response_text(reading: Reading, actuator: str, file: Path) -> str | None:
    """Return the text of a learned response, None while it was never measured."""
    try:
        text = file.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except OSError as error:
        raise ConfigError(_finding(reading, actuator, f"{file}: {error.strerror}")) from None
    try:
        Response.from_json(text)
    except ConfigError as error:
        raise ConfigError(_finding(reading, actuator, f"{file}: {error}")) from None
    return text


def _finding(reading: Reading, actuator: str, text: str) -> str:
    """Return a finding at the actuator's ``response`` key."""
    return str(reading.tree.finding(("actuators", actuator, "response"), text))


def _versions() -> dict[str, str]:
    """Return the versions that a record should name."""
    names = {"python": platform.python_version(), "aff-runtime": __version__}
    for package in ("numpy", "pydantic", "pymodbus"):
        try:
            names[package] = version(package)
        except PackageNotFoundError:
            names[package] = "not installed"
    return names


def main(arguments: list[str]) -> int:
    """Print the verdict on one file."""
    json.dump(verdict(Path(arguments[0])), sys.stdout)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
