"""The process that reads one Parquet or MDF record: ``python -P -m ... KIND NAME SECONDS BYTES``.

The file comes in on standard input. What goes out: one line of JSON, then the columns as doubles
one after the other. No object of a foreign library leaves, and nothing is unpickled.
"""

from __future__ import annotations

import json
import os
import resource
import sys
from pathlib import Path
from typing import BinaryIO

from aff_runtime.base.errors import PlantError

LONGEST_OUTPUT_BYTES = 1 << 30
"""Most that this process writes: the values of the largest record are 400 MB."""


def main(kind: str, name: str, cpu_s: str, memory_bytes: str) -> None:
    """Limit this process, then read the record called ``name`` and write what is in it."""
    limit(int(cpu_s), int(memory_bytes))
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # libraries print
    payload = sys.stdin.buffer.read()
    try:
        answer(out, kind, Path(name), payload)
    except PlantError as error:
        _head(out, {"refused": str(error)})
    except MemoryError:
        _head(out, {"no_room": True})
    out.flush()


def limit(cpu_s: int, memory_bytes: int) -> None:
    """Take away what a record's reading never needs; there is no way back for this process."""
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    # the first of the two limits ends it by SIGXCPU, which the parent names
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 5))
    resource.setrlimit(resource.RLIMIT_FSIZE, (LONGEST_OUTPUT_BYTES, LONGEST_OUTPUT_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def answer(out: BinaryIO, kind: str, path: Path, payload: bytes) -> None:
    """Write a record's columns; only what its kind needs is imported."""
    if kind == "parquet":
        # pyarrow looks for pandas and needs it for nothing here: 0.3 s of each reading
        sys.modules["pandas"] = None  # type: ignore[assignment]
        from sim_plant.refine.records.parquet_table import parquet_table as read  # noqa: PLC0415
    else:
        from sim_plant.refine.records.mdf_table import mdf_table as read  # noqa: PLC0415
    columns, said = read(path, payload)
    sizes = [[header, values.size] for header, values in columns.items()]
    _head(out, {"columns": sizes, "said": said})
    for values in columns.values():
        out.write(values.tobytes())


def _head(out: BinaryIO, content: dict[str, object]) -> None:
    out.write(json.dumps(content).encode("ascii") + b"\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
