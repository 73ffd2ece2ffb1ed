"""What a general effect is: one change of a model that explains an output from inputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from scipy.ndimage import shift as spline_shift

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA

Stage = Literal["filter", "shift", "own", "raw", "driven", "term", "past"]
"""Where an effect acts: the filter's lags, the time between channels, numbers of one record alone,
an input as read, an input as it enters the filter, a term beside the filter, past outputs."""

LATER = 32
"""Shifted inputs that stay cached: a fit moves one number at a time and needs the others again."""

GENERAL = CRITERIA.without_line.general


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OutputRecord:
    """One output of one record with all inputs, on an even grid.

    Attributes
    ----------
    output : (samples,).
    inputs : name -> values as read (samples,).
    speed_m_s : absolute speed (samples,), or None.
    step_s : sample time.
    derivative_of_inputs : the filter takes the rate of change of the inputs.
    end_samples : at each end, not judged.
    """

    output: Array
    inputs: Mapping[str, Array]
    speed_m_s: Array | None
    step_s: float
    derivative_of_inputs: bool
    end_samples: int

    @property
    def keep(self) -> slice:
        """The judged samples."""
        return slice(self.end_samples, self.output.size - self.end_samples)

    @property
    def judged(self) -> Array:
        """The output where it is judged."""
        return self.output[self.keep]

    def later(self, name: str, samples: float) -> Array:
        """Return an input later by ``samples`` (samples,), not to be written to."""
        return _later(self, name, samples)

    def rate_of(self, name: str) -> Array:
        """Return the rate of change of an input, its unit per second."""
        return np.gradient(self.inputs[name], self.step_s)

    @property
    def standardised(self) -> bool:
        """Whether every input has mean 0 and variance 1: no zero and no unit of it is left."""
        return bool(self.inputs) and all(
            abs(float(np.mean(x))) < GENERAL.standardised
            and min(abs(float(np.std(x, ddof=k)) - 1.0) for k in (0, 1)) < GENERAL.standardised
            for x in self.inputs.values()
        )

    def states(self) -> dict[str, Array]:
        """Return what friction or a gain may depend on: inputs, and their rates by ``d/dt``."""
        found = dict(self.inputs)
        if not self.derivative_of_inputs:
            found |= {f"d/dt {name}": self.rate_of(name) for name in self.inputs}
        return found


@dataclass(frozen=True, slots=True, kw_only=True)
class Number:
    """One number of an effect: name with unit, and what it says."""

    name: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedEffect:
    """An effect at a place with its numbers; its sizes are the weights of a fit.

    Attributes
    ----------
    effect : name in the catalogue.
    place : the input or state that it acts on.
    numbers : fitted by Gauss-Newton steps, in the order of the effect's ``numbers``.
    constants : taken from the records fitted, and not changed by a fit.
    """

    effect: str
    place: str
    numbers: tuple[float, ...] = ()
    constants: tuple[float, ...] = ()


Change = Callable[[OutputRecord, PlacedEffect, Array], Array]
"""Takes the record, the effect and an input (samples,); returns the input changed."""
Regressors = Callable[[OutputRecord, PlacedEffect], Array]
"""Returns what the effect adds to the output per unit of its sizes (samples, sizes)."""
Starts = Callable[[Sequence[OutputRecord]], list[PlacedEffect]]
"""Returns every place and start size to be tried on the records fitted."""


def _nowhere(_records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    return []


@dataclass(frozen=True, slots=True, kw_only=True)
class GeneralEffect:
    """One row of the catalogue.

    Attributes
    ----------
    name : unique word.
    stage : where it acts.
    text : what it is, a sentence without a stop.
    numbers : fitted by Gauss-Newton steps; a `PlacedEffect` has their values.
    sizes : fitted as weights of its regressors, in their order.
    starts : places and sizes to begin with.
    change : of an input, for stages ``raw`` and ``driven``.
    regressors : for stages ``term`` and ``own``.
    """

    name: str
    stage: Stage
    text: str
    numbers: tuple[Number, ...] = ()
    sizes: tuple[Number, ...] = ()
    starts: Starts = _nowhere
    change: Change | None = None
    regressors: Regressors | None = None


def shifted(values: Array, samples: float) -> Array:
    """Return ``values`` later by ``samples``, between samples by a spline of fifth order.

    Straight lines between samples would take noise away, and so look better than no shift.
    """
    if samples == 0.0:
        return values
    moved: Array = spline_shift(values, samples, order=5, mode="nearest")
    return moved


@lru_cache(maxsize=LATER)
def _later(record: OutputRecord, name: str, samples: float) -> Array:
    return shifted(record.inputs[name], samples)


def pooled(records: Sequence[OutputRecord], name: str) -> Array:
    """Return the readings of an input in all records."""
    return np.concatenate([v.inputs[name] for v in records])
