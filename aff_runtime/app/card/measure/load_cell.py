"""Step 1: zero and span of a load cell, and its noise.

Each measurement is of one load: none, then the span weight. ``load`` is typed, and ``signal``
where the site has more than one tension that is kept quiet.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import Figure, Sample, StepResult, at_most, mean_and_half
from aff_runtime.app.card.typed_values import NotTypedError
from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.confidence import TWO_SIDED_95
from aff_runtime.base.errors import RefusedError

LIMIT_PERCENT = 1.0  # of the span weight
NOISE_CHANGE = 1.3
"""A noise that differs from the site file's by a larger factor is proposed."""
DEFAULT_NOISE_N = 0.6
"""What the law assumes where the site file gives none (``NOISE_N`` of ``site_to_law``)."""
KIND = "load"
NAMES = ("load_N", "mean_N", "half_N", "sd_N", "readings")
"""Numbers of a sample. ``half_N``: half of the mean's 95 % interval."""
TYPED = ("load", "signal")


def measure(evidence: Evidence) -> StepResult:
    """Return errors of zero and span in percent of the span, and the noise, of every cell."""
    signals = dict.fromkeys(one.error.signal for one in evidence.site.actuators.values())
    wanted = [name for name in signals if unit_of_channel(name) == "N"]
    fresh = _sample(evidence, wanted)
    samples = [one for one in evidence.former if one.kind == KIND] + [fresh]
    figures: list[Figure] = []
    missing: list[str] = []
    proposals: list[str] = []
    for signal in wanted:
        of_cell = [one for one in samples if one.of == signal]
        empty = _last(of_cell, loaded=False)
        loaded = _last(of_cell, loaded=True)
        if empty is None:
            missing.append(f"{signal}: measure without web and load, and type load=0")
        if loaded is None:
            missing.append(f"{signal}: measure with the span weight, and type load=20 lbf")
        if empty is not None and loaded is not None:
            figures.extend(_figures(signal, empty, loaded))
        noise_N = max((one.number("sd_N") for one in of_cell), default=math.nan)
        if of_cell:
            figures.append(_noise(signal, of_cell[-1]))
            proposals.extend(_proposals(evidence, signal, noise_N))
    return StepResult(
        figures=tuple(figures),
        samples=(fresh,),
        missing=tuple(missing),
        proposals=tuple(proposals),
    )


def _sample(evidence: Evidence, wanted: list[str]) -> Sample:
    load_N = evidence.typed.number("load", "N")
    signal = evidence.typed.word("signal") or (wanted[0] if len(wanted) == 1 else "")
    if not math.isfinite(load_N) or load_N < 0.0:
        raise NotTypedError("step 1: type the load that hangs there: load=0, or load=20 lbf")
    if signal not in wanted:
        raise NotTypedError(f"step 1: type which cell: signal={' or '.join(wanted)}")
    values = evidence.window.readings(signal)
    if values is None:
        raise RefusedError(f"{evidence.window.table.window}: no reading of {signal} in it")
    mean, half = mean_and_half(values)
    numbers = (load_N, mean, half, float(np.nanstd(values)), float(values.size))
    return Sample(kind=KIND, of=signal, names=NAMES, numbers=numbers)


def _last(samples: list[Sample], *, loaded: bool) -> Sample | None:
    found = [one for one in samples if (one.number("load_N") > 0.0) == loaded]
    return found[-1] if found else None


def _figures(signal: str, empty: Sample, loaded: Sample) -> Iterator[Figure]:
    span_N = loaded.number("load_N")
    for name, sample in (("zero", empty), ("span", loaded)):
        error = 100.0 * (sample.number("mean_N") - sample.number("load_N")) / span_N
        half = 100.0 * sample.number("half_N") / span_N
        yield Figure(
            name=f"{signal}: error of {name}",
            value=error,
            unit="% of span",
            low=error - half,
            high=error + half,
            limit=f"within {LIMIT_PERCENT:g} %",
            good=at_most(abs(error), LIMIT_PERCENT),
        )


def _noise(signal: str, sample: Sample) -> Figure:
    noise_N, count = sample.number("sd_N"), max(2.0, sample.number("readings"))
    half = TWO_SIDED_95 * noise_N / math.sqrt(2.0 * (count - 1.0))
    return Figure(
        name=f"{signal}: one reading's standard deviation",
        value=noise_N,
        unit="N",
        low=noise_N - half,
        high=noise_N + half,
    )


def _proposals(evidence: Evidence, signal: str, noise_N: float) -> Iterator[str]:
    for name, actuator in evidence.site.actuators.items():
        given_N = actuator.error.noise_N or DEFAULT_NOISE_N
        if actuator.error.signal == signal and noise_N > 0.0:
            ratio = noise_N / given_N
            if not 1.0 / NOISE_CHANGE < ratio < NOISE_CHANGE:
                yield f"actuators.{name}.error.noise_N: {noise_N:.2g}  # measured; was {given_N:g}"
