"""The runs that the service has recorded, newest first, and parts of them by name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from aff_runtime.app.commission.paths import Paths, parameters_of
from aff_runtime.app.commission.views.of_refining import RunRow
from aff_runtime.base.errors import AffError, RefusedError
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.glance import glance
from aff_runtime.base.runs.window import names_a_run, run_window

MOST_RUNS = 100
MOST_WINDOWS = 8


def runs_folder(where: Paths) -> Path:
    """Return the folder of the records.

    Raises
    ------
    ConfigError
        The site file has to say it, and is not good.
    """
    if where.runs is not None:
        return where.runs
    recording = parameters_of(where.site, where.state).site.recording
    return where.site.parent / recording.directory


def runs_in(folder: Path) -> tuple[RunRow, ...]:
    """Return the newest runs of a folder; none where it cannot be listed."""
    try:
        found = sorted((one for one in folder.iterdir() if names_a_run(one)), reverse=True)
    except OSError:
        return ()
    return tuple(row for path in found[:MOST_RUNS] if (row := _row(path)) is not None)


def _row(path: Path) -> RunRow | None:
    try:
        seen = glance(path)
    except OSError:  # the bound on the disk has taken it meanwhile
        return None
    name = path.name
    if not name.isprintable() or seen.from_s is None:
        return None
    return RunRow(
        name=name, line=seen.line, start_utc=seen.start_utc, from_s=seen.from_s, to_s=seen.last_s
    )


def windows_in(text: str) -> tuple[str, ...]:
    """Return the parts of runs that somebody named, one a line."""
    return tuple(line.strip() for line in text.splitlines() if line.strip())


def paths_of(windows: Sequence[str], folder: Path) -> tuple[str, ...]:
    """Return parts of runs of a folder as paths.

    Raises
    ------
    RefusedError
        One names no run of that folder, or too many were named.
    """
    if len(windows) > MOST_WINDOWS:
        raise RefusedError(f"{len(windows)} windows: at most {MOST_WINDOWS} are taken")
    return tuple(_path_of(one, folder) for one in windows)


def _path_of(window: str, folder: Path) -> str:
    name = window.partition("@")[0]
    path = folder / window
    if Path(name).name != name or name in ("", ".", "..") or "/" in window:
        raise RefusedError(f"{printable(window, 100)}: name a run of {folder}")
    if not names_a_run(folder / name):
        raise RefusedError(f"{printable(name, 100)}: is no run of {folder}")
    try:
        run_window(path)
    except AffError as error:
        raise RefusedError(str(error)) from None
    return str(path)
