"""``python -m tests.fuzz.record_reader``: reads records of any bytes, one after the other.

A process of its own, as the product's: a library that ends it ends no fuzzer. In: one line of
JSON with kind and size, then the bytes. Out: a word for what became of them.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import resource
import signal
import sys
import traceback
from pathlib import Path
from types import FrameType

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.refine.records.mdf_table import mdf_table
from sim_plant.refine.records.parquet_table import parquet_table

READ = {"mdf": mdf_table, "parquet": parquet_table}
LIBRARIES = ("asammdf", "pyarrow.parquet")
"""Imported before the first input, whose time is its own; half an import breaks the next."""
CPU_S = 0.3
"""Of one input; what links to itself goes round for ever."""
MEMORY_BYTES = 1 << 30


class OverError(Exception):
    """The time of one input is over."""


def main() -> None:
    for library in LIBRARIES:
        importlib.import_module(library)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    signal.signal(signal.SIGVTALRM, over)
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    while line := sys.stdin.buffer.readline():
        kind, size = json.loads(line)
        print(json.dumps(became(kind, sys.stdin.buffer.read(size))), file=out, flush=True)


def over(_signal: int, _frame: FrameType | None) -> None:
    raise OverError


def became(kind: str, payload: bytes) -> list[str]:
    """Return a word, and a trace when something else than a refusal was raised."""
    try:
        with timed():
            columns, said = READ[kind](Path("r"), payload)
    except PlantError as error:
        return ["refused" if str(error).strip() else "refused without a word", ""]
    except (OverError, MemoryError):
        return ["given up", ""]
    except Exception:
        return ["broken", traceback.format_exc()]
    whole = all(v.dtype == np.float64 and v.ndim == 1 for v in columns.values())
    return ["ok" if whole and all(map(str.isprintable, said)) else "broken", str(said)]


@contextlib.contextmanager
def timed():
    """Let one input take its time; a bare except of a library is asked again and again."""
    signal.setitimer(signal.ITIMER_VIRTUAL, CPU_S, CPU_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)


if __name__ == "__main__":
    main()
