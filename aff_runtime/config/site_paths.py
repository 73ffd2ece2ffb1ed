"""Where the files that a site names may lie: below the site's own folder, or the service's state.

A site file may come from somebody else. What it names is read, and partly written and cleared
away, with the rights of the service; so a name must not lead anywhere else, by itself or by a
link. Nothing is read here.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from aff_runtime.config.rules.issue import Issue

if TYPE_CHECKING:
    from aff_runtime.config.findings import KeyPath
    from aff_runtime.config.models import Site

# The installer makes it; /etc/aff-runtime/learned is a link into it.
STATE_DIRECTORY = Path("/var/lib/aff-runtime")


def issues(site: Site, folder: Path, state: Path) -> Iterator[Issue]:
    """Yield every name that leads out of the folders that it may lie in.

    Parameters
    ----------
    folder : the site file's, where relative names begin.
    state : folder of what the service learns and records.
    """
    roots = [Path(os.path.realpath(root)) for root in (folder, state)]
    for path, name in named(site):
        for file in _files(path, folder / name):
            real = Path(os.path.realpath(file))  # where links lead; it never raises
            inside = real.parent if path[-1] == "response" else real  # it is also written
            if not any(inside.is_relative_to(root) for root in roots):
                yield Issue(path=path, text=_text(path, name, real, folder))
                break


def _text(path: KeyPath, name: str, real: Path, folder: Path) -> str:
    leads = f"{folder / name} leads to {real}, which is not below {folder}"
    if path[0] == "recording":
        return f"{leads}. Leave the key out, and start the service with --record-dir {name}."
    if path[-1] == "response":
        return f"{leads}, nor below the folder that --state-dir names. Write learned/NAME.json."
    return f"{leads}. Put the file there, and no link to it."


def _files(path: KeyPath, file: Path) -> Iterator[Path]:
    """Yield the files behind a name: with a response lies the shape that is learned with it."""
    yield file
    if path[-1] == "response":
        yield shape_path(file)


def shape_path(response: Path) -> Path:
    """Return where the shape learned with a response is kept."""
    return response.with_name(f"{response.stem}.shape.json")


def named(site: Site) -> Iterator[tuple[KeyPath, str]]:
    """Yield every file and folder that a site names; devices and sockets of a bus are none."""
    gateway = site.gateway
    if gateway.modbus_tcp is not None and gateway.modbus_tcp.tls is not None:
        for key, name in gateway.modbus_tcp.tls.files().items():
            yield ("gateway", "modbus_tcp", "tls", key), name
    if gateway.can_dbc is not None:
        yield ("gateway", "can_dbc", "dbc"), gateway.can_dbc.dbc
    if gateway.canopen_402 is not None:
        for node_name, node in gateway.canopen_402.nodes.items():
            yield ("gateway", "canopen_402", "nodes", node_name, "eds"), node.eds
    for actuator_name, actuator in site.actuators.items():
        yield ("actuators", actuator_name, "response"), actuator.response
    yield ("recording", "directory"), site.recording.directory
