"""Parquet and MDF records, read by a child with limits: no library of theirs runs in here."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import tempfile
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from aff_runtime.base.python_child import module_command
from sim_plant.base.arrays import Array
from sim_plant.base.plain_file import megabytes
from sim_plant.refine.records.limits import COLUMNS, VALUES, path_text

MEMORY_BYTES = 2 << 30
"""Address space: 0.4 GB of libraries, the file, and its values as doubles, twice; 38 million
values, 330 MB of Parquet or MDF, are read in it."""
CPU_S = 60
"""The largest record that is taken needs some seconds; asammdf alone starts in 0.7 s."""
WALL_S = 180.0
"""Three times ``CPU_S``, for a machine that does other things too."""
_HEAD_BYTES = 4 << 20
"""Longest line of JSON with the headers that is taken from the child."""
_SPARING = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
    "ARROW_DEFAULT_MEMORY_POOL": "system",  # gives back what it no longer needs
}


def table_from_child(
    path: Path,
    kind: str,
    payload: bytes,
    *,
    memory_bytes: int = MEMORY_BYTES,
    cpu_s: int = CPU_S,
    wall_s: float = WALL_S,
) -> tuple[dict[str, Array], list[str]]:
    """Return the columns of a ``parquet`` or ``mdf`` file by header, and what is said of them.

    Every file has a child of its own, so none can spend what another was given. The child starts
    with ``-P``: no module is taken from the folder the user stands in.

    Raises
    ------
    PlantError
        What the reader says of the file, or that it took too much memory or time, or ended.
    """
    command = module_command("sim_plant.refine.records.child")
    command += [kind, str(path), str(cpu_s), str(memory_bytes)]
    with (
        tempfile.TemporaryDirectory(prefix="sim-plant-record-") as folder,
        (Path(folder) / "out").open("w+b") as out,
        (Path(folder) / "last_words").open("w+b") as last_words,
    ):
        try:
            done = subprocess.run(
                command,
                input=payload,
                stdout=out,
                stderr=last_words,
                timeout=wall_s,
                env={**os.environ, **_SPARING, "TMPDIR": folder},
                check=False,
            )
        except subprocess.TimeoutExpired as error:
            raise PlantError(
                f"{path_text(path)}: was not read in {wall_s:g} s and is given up; cut the record"
            ) from error
        if done.returncode != 0:
            raise PlantError(_ended(path, done.returncode, last_words, cpu_s, memory_bytes))
        out.seek(0)
        return _taken(path, out, memory_bytes)


def _ended(path: Path, code: int, last_words: BinaryIO, cpu_s: int, memory_bytes: int) -> str:
    """Return what is said of a reader that ended without an answer."""
    if -code == signal.SIGXCPU:
        return (
            f"{path_text(path)}: takes more than {cpu_s} s to read and is given up; cut the record"
        )
    last_words.seek(0)
    lines = last_words.read(1 << 20).decode("utf-8", "replace").splitlines()
    how = f"signal {-code}" if code < 0 else f"exit {code}"
    said = printable("; ".join([how, *lines[-1:]]), 200)
    return (
        f"{path_text(path)}: "
        f"its reader ended ({said}), with {megabytes(memory_bytes)} to work in; "
        "export the record anew or cut it"
    )


def _taken(path: Path, out: BinaryIO, memory_bytes: int) -> tuple[dict[str, Array], list[str]]:
    """Return what the child wrote; it is judged as a file is."""
    try:
        head: dict[str, Any] = json.loads(out.readline(_HEAD_BYTES))
        if "refused" in head:
            raise PlantError(str(head["refused"]))
        if "no_room" in head:
            raise PlantError(
                f"{path_text(path)}: needs more than {megabytes(memory_bytes)} to be read; cut it"
            )
        sizes = [(str(name), int(size)) for name, size in head["columns"]]
        if len(sizes) > COLUMNS + 1 or not 0 <= sum(n for _, n in sizes) <= 2 * VALUES:
            raise ValueError("too much")
        columns = {name: _column(out, size) for name, size in sizes}
        return columns, [str(text) for text in head["said"]]
    except (ValueError, TypeError, KeyError) as error:
        raise PlantError(
            f"{path_text(path)}: its reader gave no answer; export it anew"
        ) from error


def _column(out: BinaryIO, size: int) -> Array:
    found = np.frombuffer(out.read(8 * size), dtype=np.float64)
    if found.size != size:
        raise ValueError("torn")
    return found.copy()
