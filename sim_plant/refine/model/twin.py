"""The declared line run under a record's references, with and without changes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.effects import Value
from sim_plant.effects.shape_rows import add_mean, add_shape
from sim_plant.geometry.shapes import orders
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.corrections import apply_corrections
from sim_plant.line.arrays.with_effects import apply_effects
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.open import make_line
from sim_plant.line.rest.fastest_mode import (
    ACCURATE_STEP,
    STABLE_STEP,
    FastestMode,
    fastest_mode,
    substeps_for,
)
from sim_plant.line.running.references import References
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.start_state import StartOffset

MODEL = CRITERIA.model
WORDS = 1
"""Number of the random stream from which the rounding of words is drawn."""
REFERENCES = ("line_speed_ref_m_s", "tension_ref_N")
"""Columns of a record that the line runs under."""


@dataclass(frozen=True, slots=True)
class Added:
    """An effect put on the line: name, location and (key, value) parameters, hashable.

    ``record_index`` : the only record that it is in, from 0 of those fitted; None: in all.
    """

    effect: str
    location: str
    parameters: tuple[tuple[str, Value], ...]
    record_index: int | None = None

    def entry(self) -> EffectEntry:
        """Return the declaration's entry."""
        return EffectEntry(
            effect=self.effect, location=self.location, parameters=dict(self.parameters)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One simulation: effects put on the line, declared numbers shifted, noise, drive tick.

    ``shifts`` are (nuisance name, amount); ``ripples`` are (body, order, cos_m, sin_m) of the
    support function, for shapes of any order. ``start``: what the record begins with otherwise
    than at rest. ``seed`` of the noise; None: none. ``quick`` takes the quick drive tick, longer
    than the declared one: only differences between two such runs are used, never their level.
    """

    effects: tuple[Added, ...] = ()
    ripples: tuple[tuple[int, int, float, float], ...] = ()
    shifts: tuple[tuple[str, float], ...] = ()
    start: tuple[StartOffset, ...] = ()
    seed: int | None = None
    quick: bool = True

    @property
    def settle_s(self) -> float:
        """How long the line runs before its record begins, s; with noise if the case has it."""
        return MODEL.quick_settle_s if self.quick else MODEL.declared_settle_s


def seen_by(case: Case, record_index: int) -> Case:
    """Return the case as this record has it, from 0 of those fitted."""
    effects = tuple(e for e in case.effects if e.record_index in (None, record_index))
    return case if len(effects) == len(case.effects) else replace(case, effects=effects)


@dataclass(frozen=True, kw_only=True, eq=False)
class Twin:
    """A declaration and the references it ran under.

    Attributes
    ----------
    channels : names of the recorded channels that the declaration explains, in report order.
    speed_m_s, tension_N : reference columns (samples,).
    aff_m_s : corrections per driven roller that acted after each row, (samples,) each.
    aff_N_m : the same for those that add to the torque of its drive.
    speed_holds : the reference holds from row to row, as a PLC gives it; else linear between rows.
    rested : the line ran under the first row's references until it rested; a run's did not.
    word_steps : per channel one count of the word that it was recorded in, SI; a sensor's own
        resolution is its declaration's.
    """

    declaration: Declaration
    channels: tuple[str, ...]
    speed_m_s: Array
    tension_N: Array
    aff_m_s: dict[str, Array]
    aff_N_m: dict[str, Array] = field(default_factory=dict)
    word_steps: dict[str, float] = field(default_factory=dict)
    speed_holds: bool = False
    rested: bool = True

    def simulate(self, case: Case) -> Array:
        """Return all channels (channels, samples) of one case.

        Raises
        ------
        PlantError
            When an effect cannot be put on this line or the simulation diverges.
        """
        return self._outputs(case)[0]

    def angles(self, case: Case) -> tuple[Array, Array]:
        """Return channels (channels, samples) and the angles of all bodies (bodies, samples)."""
        return self._outputs(case)

    def line(self, case: Case) -> LineSimulation:
        """Return the line of one case, not settled yet.

        Raises
        ------
        PlantError
            When an effect or a correction cannot be put on this line.
        """
        line = self.declaration
        if case.quick:
            sample = line.sample_time_s
            ratio = max(1, round(sample / MODEL.quick_tick_s))
            tick = max(line.control.drive_sample_time_s, sample / ratio)
            control = line.control.model_copy(update={"drive_sample_time_s": tick})
            line = line.model_copy(update={"control": control})
        arrays = build_arrays(line, timing_of(line, line.sample_time_s))
        arrays = apply_corrections(line, arrays, line.corrections)
        arrays = apply_corrections(line, arrays, dict(case.shifts))
        entries = (*line.effects, *(added.entry() for added in case.effects))
        arrays = apply_effects(line, arrays, entries)
        for body, order, cos_m, sin_m in case.ripples:
            if order == 0:
                arrays = add_mean(arrays, body, cos_m)
                continue
            radius_m = float(arrays.bodies["radius_m"][body])
            polar = (order, math.hypot(cos_m, sin_m), math.atan2(-sin_m, cos_m))
            shape = orders(radius_m, [polar])
            arrays = add_shape(arrays, body, shape)
        if case.seed is None:
            arrays.cells["lsb_N"] = 0.0  # mean of a dithered word; the steps only add chaos
        tick_s, step = (
            line.control.drive_sample_time_s,
            STABLE_STEP if case.quick else ACCURATE_STEP,
        )
        arrays.timing["substeps"] = substeps_for(self._fastest, tick_s, step)
        return LineSimulation(
            line,
            seed=case.seed,
            arrays=arrays,
            line_speed_m_s=float(self.speed_m_s[0]),
            tension_N=float(self.tension_N[0]),
        )

    @cached_property
    def _fastest(self) -> FastestMode:
        """Of the line as declared: cases that are compared take the same steps."""
        made = make_line(self.declaration, seed=None, effects=False)
        return fastest_mode(self.declaration, made.arrays, made.lengths_m)

    def _outputs(self, case: Case) -> tuple[Array, Array]:
        run = self.line(case)
        run.settle(case.settle_s, quiet=case.seed is None)
        for offset in case.start:
            offset.put(run)
        out = run.simulate(
            self.speed_m_s,
            self.tension_N,
            self.aff_m_s,
            self.aff_N_m,
            speed_holds=self.speed_holds,
        )
        channels = np.stack([out[name] for name in self.channels])
        return self.in_words(channels, case.seed), out["body_angle_rad"].T

    def references(self, line: LineSimulation) -> References:
        """Return the references of the record, as a line of this declaration takes them."""
        return line.references(
            self.speed_m_s,
            self.tension_N,
            self.aff_m_s,
            self.aff_N_m,
            speed_holds=self.speed_holds,
        )

    def in_words(self, channels: Array, seed: int | None) -> Array:
        """Return channels with what the words leave of readings, where the run has noise.

        As if each fell anywhere within its count: what rounding really does depends on how a
        reading passes the counts, with an effect on the line otherwise than without it; a noise
        that is there either way is on the safe side.
        """
        if seed is None:
            return channels
        rng, worded = np.random.default_rng([seed, WORDS]), channels.copy()
        for name, step in sorted(self.word_steps.items()):
            share = rng.random(channels.shape[1]) - 0.5
            if name in self.channels:
                worded[self.channels.index(name)] += step * share
        return worded


def modelled_channels(line: Declaration, columns: Sequence[str]) -> tuple[str, ...]:
    """Return recorded channels that the declaration explains, one per physical signal.

    Two declared names of one signal (line speed is the lead roller's) count once.
    """
    seen: set[tuple[str, str]] = set()
    channels = []
    for sensor in line.sensors:
        if sensor.channel in columns and (sensor.roller, sensor.kind) not in seen:
            seen.add((sensor.roller, sensor.kind))
            channels.append(sensor.channel)
    return tuple(channels)
