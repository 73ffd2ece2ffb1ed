"""Declared numbers put right: how a line is with a number a little other than declared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.suggest import hint
from sim_plant.base.arrays import CHANGEABLE, DRIVEN, IDLER, LineArrays, copy_arrays
from sim_plant.base.effects import Shift
from sim_plant.effects.onset import changes_only_numbers
from sim_plant.effects.shape_rows import add_mean
from sim_plant.line.arrays.build import build_arrays, cell_sensors, timing_of
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.declared.declared_bodies import carriage_numbers, section_of
from sim_plant.line.declared.laws import draws

MAY_VANISH = {
    "web.kelvin_voigt_eta_s",
    "web.wound_in_tension_N",
    "friction",
    "carriage_load",
    "carriage_drag",
    "heat",
}
"""Kinds of numbers that may be taken away as a whole; of others at least a hundredth stays."""
BOUNDS = {"offset": 1e4, "draw": 0.5, "travel": 10.0, "radius": 0.5, "effective_radius": 0.5}
"""Either way: of a cell's offset, N; of a draw; of a dancer's position, m; of a radius, its share
(a drive that believes a wrong one is an effect, to a quarter)."""
MOST_SHARE = 99.0
"""A number a hundred times as declared is another machine."""

WOUND_IN = "web.supply_strain"
"""What the line is made of where the declaration says the tension that the roll was wound at."""
TRIED_SHIFT = 1e-3
"""Any that is not 0: which numbers of a line a shift touches does not depend on its size."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Number:
    """One declared number that may be wrong.

    Attributes
    ----------
    name : dotted path in the declaration.
    kind : what it is a case of, for a default tolerance.
    shift : returns arrays changed by this much (mostly relative); those given may be changed.
    low, high : what a file may correct it by. A search may look beyond.
    """

    name: str
    kind: str
    shift: Shift

    @property
    def low(self) -> float:
        """The least that it may be corrected by."""
        return -BOUNDS.get(self.kind, 1.0 if self.kind in MAY_VANISH else 0.99)

    @property
    def high(self) -> float:
        """The most that it may be corrected by."""
        return BOUNDS.get(self.kind, MOST_SHARE)


def _scale(record: str, field: str, index: int | slice) -> Shift:
    def shift(arrays: LineArrays, amount: float) -> LineArrays:
        getattr(arrays, record)[field][index] *= 1.0 + amount
        return arrays

    return shift


def _add(record: str, field: str, index: int | slice) -> Shift:
    def shift(arrays: LineArrays, amount: float) -> LineArrays:
        getattr(arrays, record)[field][index] += amount
        return arrays

    return shift


def _idler_inertia(arrays: LineArrays, amount: float) -> LineArrays:
    idlers = arrays.bodies["kind"] == IDLER
    arrays.bodies["inertia_kg_m2"][idlers] *= 1.0 + amount
    return arrays


def _modulus(arrays: LineArrays, amount: float) -> LineArrays:
    arrays.spans["EA_N"] *= 1.0 + amount
    arrays.web["supply_strain"] /= 1.0 + amount  # wound at a declared tension
    return arrays


def _corner(arrays: LineArrays, amount: float) -> LineArrays:
    arrays.cells["corner_Hz"] *= 1.0 + amount
    return arrays


def _felt(body: int) -> Shift:
    def shift(arrays: LineArrays, amount: float) -> LineArrays:
        return add_mean(arrays, body, amount * float(arrays.bodies["radius_m"][body]))

    return shift


def _radius(body: int) -> Shift:
    """Return a shift of the true radius: the drive goes on dividing by the declared one."""

    def shift(arrays: LineArrays, amount: float) -> LineArrays:
        arrays.bodies["radius_m"][body] *= 1.0 + amount
        if int(arrays.bodies["kind"][body]) == DRIVEN:
            arrays.drives["radius_ratio"][arrays.drives["body"] == body] /= 1.0 + amount
        return arrays

    return shift


def declared_numbers(line: Declaration) -> list[Number]:
    """Return every declared number that a record could feel."""
    rows: list[tuple[str, str, Shift]] = [
        ("web.EA_N", "web.EA_N", _modulus),
        ("web.kelvin_voigt_eta_s", "web.kelvin_voigt_eta_s", _scale("web", "viscosity_s", 0)),
        ("web.density_kg_m3", "web.density_kg_m3", _scale("web", "density_kg_m3", 0)),
        ("web.thickness_m", "web.thickness_m", _scale("web", "thickness_m", 0)),
        ("web.wound_in_tension_N", "web.wound_in_tension_N", _scale("web", "supply_strain", 0)),
        ("idlers.inertia_kg_m2", "idlers.inertia_kg_m2", _idler_inertia),
        ("sensors.low_pass_Hz", "corner", _corner),
    ]
    for k, roller in enumerate(line.rollers):
        path = f"rollers.{roller.name}."
        rows.append(
            (
                path + "friction_constant_N_m",
                "friction",
                _scale("bodies", "friction_constant_N_m", k),
            )
        )
        if roller.kind != "idler":
            rows.append((path + "inertia_kg_m2", "inertia", _scale("bodies", "inertia_kg_m2", k)))
            if roller.kind == "roll":
                rows.append((path + "effective_radius", "effective_radius", _felt(k)))
            rows.append((path + "radius_m", "radius", _radius(k)))
    rows += _control_rows(line)
    rows += _carriage_rows(line)
    rows += _heat_rows(line)
    for c, sensor in enumerate(cell_sensors(line)):
        rows.append((f"sensors.{sensor.channel}.gain", "gain", _scale("cells", "gain", c)))
        rows.append((f"sensors.{sensor.channel}.offset", "offset", _add("cells", "offset_N", c)))
    return [Number(name=name, kind=kind, shift=shift) for name, kind, shift in rows]


def changeable_numbers(line: Declaration) -> list[Number]:
    """Return every declared number that may become another one while a line runs.

    None that a run reads once, when it begins: a radius, a shape.
    """
    arrays = build_arrays(line, timing_of(line, line.sample_time_s))
    rows = [(n, n.shift(copy_arrays(arrays), TRIED_SHIFT)) for n in declared_numbers(line)]
    return [number for number, moved in rows if changes_only_numbers(arrays, moved)]


def value_of(line: Declaration, number: Number, change: float = 0.0) -> float:
    """Return what a number that may change during a run is, SI, moved by ``change``.

    Of a number that several things share (the inertia of all idlers) that of the first.
    """
    arrays = build_arrays(line, timing_of(line, line.sample_time_s))
    tried = number.shift(copy_arrays(arrays), TRIED_SHIFT)
    moved = number.shift(copy_arrays(arrays), change)
    for table, field in (name.split(".") for name in CHANGEABLE if name != WOUND_IN):
        own = np.flatnonzero(getattr(tried, table)[field] != getattr(arrays, table)[field])
        if own.size:
            return float(getattr(moved, table)[field][own[0]])
    return line.web.wound_in_tension_N * (1.0 + change)


def apply_corrections(
    line: Declaration, arrays: LineArrays, corrections: Mapping[str, float]
) -> LineArrays:
    """Return ``arrays`` with these numbers other than declared, by what each shift takes.

    Raises
    ------
    PlantError
        On a number that this line does not declare; the message offers the nearest name.
    """
    table = {n.name: n for n in declared_numbers(line)} if corrections else {}
    for name, amount in corrections.items():
        if name not in table:
            raise PlantError(
                f"corrections.{name}: this line declares no such number{hint(name, table)}"
            )
        arrays = table[name].shift(arrays, amount)
    return arrays


def _control_rows(line: Declaration) -> list[tuple[str, str, Shift]]:
    rows: list[tuple[str, str, Shift]] = []
    for d, drive in enumerate(line.control.drives):
        path = f"control.drives.{drive.roller}."
        rows.append((path + "K_ref_rad_s", "drive", _scale("drives", "gain_rad_s", d)))
        rows.append((path + "zeta", "drive", _scale("drives", "damping", d)))
        if draws(drive.speed_reference):
            rows.append(("control.pull_roll_draw", "draw", _add("drives", "draw", d)))
    for number, loop in enumerate(line.control.tension_pi):
        path = f"control.tension_pi.{loop.loop}."
        rows.append((path + "gain_m_s_per_N", "loop", _scale("loops", "gain_m_s_N", number)))
        rows.append((path + "corner_rad_s", "loop", _scale("loops", "corner_rad_s", number)))
    for number, held in enumerate(line.control.position_pi, start=len(line.control.tension_pi)):
        path = f"control.position_pi.{held.loop}."
        rows.append((path + "gain_m_s_per_m", "loop", _scale("loops", "gain_m_s_N", number)))
        rows.append((path + "corner_rad_s", "loop", _scale("loops", "corner_rad_s", number)))
        rows.append((path + "position_m", "travel", _add("loops", "reference_m", number)))
    return rows


def _carriage_rows(line: Declaration) -> list[tuple[str, str, Shift]]:
    """Return what a carriage is declared with, under the words of its section."""
    rows: list[tuple[str, str, Shift]] = []
    for c, carriage in enumerate(line.carriages):
        for key, field, kind in carriage_numbers(carriage):
            if getattr(carriage, key) not in (None, 0.0):
                path = f"{section_of(carriage)}.{carriage.name}.{key}"
                rows.append((path, kind, _scale("carriages", field, c)))
    return rows


def _heat_rows(line: Declaration) -> list[tuple[str, str, Shift]]:
    rows: list[tuple[str, str, Shift]] = []
    if line.heated_spans:
        expansion = _scale("web", "expansion_1_K", 0)
        rows.append(("web.thermal_expansion_1_K", "heat", expansion))
    for given in line.heated_spans:
        span = [(s.start, s.end) for s in line.spans].index((given.start, given.end))
        path = f"heated_spans.{given.name}."
        rows.append((path + "warming_K", "heat", _heated(span, "air_K")))
        rows.append((path + "exchange_s", "heat", _heated(span, "time_s")))
    return rows


def _heated(span: int, field: str) -> Shift:
    def shift(arrays: LineArrays, amount: float) -> LineArrays:
        first, parts = arrays.spans["heat_first"][span], arrays.spans["heat_parts"][span]
        arrays.heats[field][first : first + parts] *= 1.0 + amount
        return arrays

    return shift
