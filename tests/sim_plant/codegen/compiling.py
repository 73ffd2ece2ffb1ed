"""Translated C as a library, and one run through it or through numba."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.arrays import Array, LineArrays, copy_state
from sim_plant.base.c_arrays import c_array, c_struct
from sim_plant.line.equations.kernel import Work, run_frames
from sim_plant.line.running.simulation import LineSimulation

EXACT = ("-std=c99", "-O1", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror")
"""With contraction a product and a sum would round once where the kernel rounds twice."""


def compiled_library(folder: Path, source: str, *flags: str) -> ctypes.CDLL:
    """Return C source as a loaded library; skips where there is no compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler on this machine")
    text, library = folder / "kernel.c", folder / "kernel.so"
    text.write_text(source)
    subprocess.run(
        [compiler, *flags, "-shared", "-fPIC", str(text), "-o", str(library), "-lm"], check=True
    )
    return ctypes.CDLL(str(library))


def copied(line: LineSimulation) -> LineSimulation:
    """Return an independent copy of a line with its parameters, state and scratch memory."""
    other = LineSimulation.__new__(LineSimulation)
    other.__dict__.update(line.__dict__)
    other.arrays = LineArrays(**{k: v.copy() for k, v in line.arrays._asdict().items()})
    other.state = copy_state(line.state)
    other.work = Work(**{k: v.copy() for k, v in line.work._asdict().items()})
    return other


def run_by_numba(line: LineSimulation, references: tuple[Array, ...]) -> Array:
    """Return the log of a run of the kernel; the line goes on to its end."""
    out = np.zeros((references[0].shape[0], line.log.width))
    run_frames(line.arrays, line.layout, line.state, line.work, *references, out)
    return out


def run_by_c(library: ctypes.CDLL, line: LineSimulation, references: tuple[Array, ...]) -> Array:
    """Return the log of the same run through the translated kernel."""
    out = np.zeros((references[0].shape[0], line.log.width))
    structs = [c_struct(part) for part in (line.arrays, line.layout, line.state, line.work)]
    arrays = [c_array(part, 2) for part in (*references, out)]
    library.line_run_frames(*(ctypes.byref(part) for part in (*structs, *arrays)))
    return out
