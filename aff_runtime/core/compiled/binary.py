"""The law's arithmetic as a binary, where one was built; numpy does the same where none was.

A part of a law asks for it once, when it is made, with ``chosen``. Each function is the equal of
the numpy lines beside its call: the same numbers in the same arrays, in one call and without an
object for each of them. ``AFF_RUNTIME_ARITHMETIC=numpy`` leaves the binary out.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Protocol, cast

import numpy as np
import numpy.typing as npt

from aff_runtime.base.signals import ActuatorStep

VARIABLE = "AFF_RUNTIME_ARITHMETIC"
NUMPY, COMPILED = "numpy", "compiled"
Array = npt.NDArray[Any]
Doubles = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


class Turning(Protocol):
    """What a basis reads of a roll; see ``RollPhase``."""

    radius_m: float
    theta_rad: float
    omega_rad_s: float


class Arithmetic(Protocol):
    """What the binary offers; ``arithmetic.h`` says what each array holds.

    ``Arrays`` holds the arrays of one part, in the order that ``module.c`` names; every function
    takes it first. ValueError when an array has not the size that the others ask for.
    """

    def Arrays(self, *arrays: Array) -> object:
        """Hold arrays as long as this object lives."""
        ...

    def loop_push(
        self, held: object, b: Complexes, weight: Complexes, ratio: float, ticks: int
    ) -> None:
        """``LoopFilter.push``."""
        ...

    def loop_read(self, held: object) -> None:
        """``LoopFilter.read``."""
        ...

    def filter_update(
        self,
        held: object,
        phi: Complexes,
        psi: Complexes,
        error: float,
        sd: float,
        news_limit: float,
        first: int,
        imbalance: int,
    ) -> float:
        """``ShapeFilter.update`` without prediction; returns the innovation."""
        ...

    def filter_predict(
        self,
        held: object,
        phi: Complexes,
        turn_s: Doubles,
        numbers: Doubles,
        passed_s: float,
        dt_s: float,
        sd: float,
        memory_turns: float,
    ) -> None:
        """``ShapeFilter._predict``."""
        ...

    def monitor_hear(self, held: object, turn_s: Doubles, passed_s: float, dt_s: float) -> None:
        """``ShapeMonitor._read_amplitudes``."""
        ...

    def monitor_follow(self, held: object, phi: Complexes, error: float) -> None:
        """``ShapeMonitor._follow``: the lock-in itself."""
        ...

    def monitor_judge(
        self,
        held: object,
        turn_s: Doubles,
        deviation: Complexes,
        ratio: Complexes,
        passed_s: float,
        dt_s: float,
        sd: float,
        first: int,
        imbalance: int,
    ) -> bool:
        """``ShapeMonitor._judge``; returns whether all is calm."""
        ...

    def basis_step(
        self,
        held: object,
        phases: Sequence[Turning],
        speed_m_s: float,
        slope_m_s2: float,
        dt_s: float,
    ) -> None:
        """``ShapeBasis.step`` once speed and torque are known; ``phases`` is a list."""
        ...

    def newton_step(
        self,
        held: object,
        turn_s: Doubles,
        rest: Doubles | None,
        held_columns: npt.NDArray[np.bool_] | None,
        turns: float,
        ratio_from: float,
        ratio_to: float,
        limit_m: float,
        dt_s: float,
    ) -> None:
        """``NewtonSteps.step``."""
        ...

    def send(
        self,
        held: object,
        step: type[ActuatorStep],
        omega_rad_s: Doubles,
        gate: float,
        ramp_s: float,
        slack: float,
        at: int,
    ) -> ActuatorStep:
        """``ShapeLaw._sum``; ``ramp_s`` 0: no share moves."""
        ...


def _load() -> Arithmetic | None:
    if os.environ.get(VARIABLE) == NUMPY:
        return None
    try:
        return cast(Arithmetic, importlib.import_module("aff_runtime.core.compiled._arithmetic"))
    except ImportError:  # built without a compiler
        return None


_chosen: list[Arithmetic | None] = [_load()]


def chosen() -> Arithmetic | None:
    """Return the binary that parts made from now on use; None: numpy."""
    return _chosen[-1]


def arithmetic_name() -> str:
    """Return ``compiled`` or ``numpy``, for logs and the version."""
    return NUMPY if chosen() is None else COMPILED


def holding(*arrays: Array) -> object:
    """Return the binary's hold on arrays; nothing without a binary."""
    arithmetic = chosen()
    return None if arithmetic is None else arithmetic.Arrays(*arrays)


@contextmanager
def using(arithmetic: Arithmetic | None) -> Iterator[None]:
    """Have parts made inside use this binary, or numpy (None), to compare the two."""
    _chosen.append(arithmetic)
    try:
        yield
    finally:
        _chosen.pop()
