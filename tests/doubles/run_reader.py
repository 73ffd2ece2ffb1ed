"""Reads a run folder back as plain arrays, for analysis; forgives a run that was cut short."""

from __future__ import annotations

import csv
import gzip
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from aff_runtime.base.errors import AffError
from aff_runtime.telemetry.run_about import RunAbout
from aff_runtime.telemetry.summary import Summary


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """One recorded run.

    Attributes
    ----------
    about : ``run.yaml``.
    columns : one array per column name, all of the same length.
    events : rows of ``events.csv``.
    summary : ``summary.json``; None when the run was cut short.
    """

    about: RunAbout
    columns: dict[str, NDArray[np.float64]]
    events: list[dict[str, str]]
    summary: Summary | None


def read_run(folder: Path) -> Run:
    """Return everything recorded in ``folder``.

    Raises
    ------
    AffError
        When the folder is not a run.
    """
    try:
        about = RunAbout.decode((folder / "run.yaml").read_text(encoding="utf-8"))
    except (OSError, KeyError, TypeError, AttributeError, yaml.YAMLError) as error:
        raise AffError(
            f"{folder}: not a run folder ({error}); name one that has run.yaml"
        ) from None
    names = about.columns
    parts = [_read_segment(p, len(names)) for p in sorted(folder.glob("signals-*.csv.gz"))]
    table = np.vstack([*parts, np.empty((0, len(names)))])
    summary_path = folder / "summary.json"
    return Run(
        about=about,
        columns={name: table[:, i] for i, name in enumerate(names)},
        events=_read_events(folder / "events.csv"),
        summary=Summary.decode(summary_path.read_text()) if summary_path.exists() else None,
    )


def _read_segment(path: Path, n_columns: int) -> NDArray[np.float64]:
    """Return the complete rows of one segment, shape (n, n_columns); a torn end is left out."""
    chunks: list[bytes] = []
    try:
        with gzip.open(path) as file:
            while chunk := file.read1(1 << 16):
                chunks.append(chunk)
    except (EOFError, OSError, zlib.error):
        pass
    text = b"".join(chunks).decode("ascii", errors="replace")
    lines = text[: text.rfind("\n") + 1].splitlines()[1:]
    rows = [line.split(",") for line in lines]
    whole = [row for row in rows if len(row) == n_columns]
    return np.array(whole, dtype=np.float64).reshape(len(whole), n_columns)


def _read_events(path: Path) -> list[dict[str, str]]:
    """Return the rows of an event file, none when it is missing."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
