import inspect
import math
import pkgutil

import numpy as np
import pytest

import sim_plant.effects
from aff_runtime.base.errors import PlantError
from sim_plant.base.effects import Effect, Parameter
from sim_plant.base.signatures import Frequency, Orders
from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.line.arrays.corrections import declared_numbers
from sim_plant.line.arrays.locations import candidate_locations
from sim_plant.refine.model.parameter_effects import equivalents
from tests.each_case import each_case
from tests.sim_plant.effects.running import effect, euclid, run

WAVE_M_S = 0.005 * np.sin(2.0 * np.pi * 1.5 * 0.005 * np.arange(200))
PASSING = {"seconds": 3.0, "settle_s": 4.0}
"""Long enough for what begins at the start to reach the first rollers."""
SHORT = {"seconds": 1.0, "settle_s": 2.0, "aff": {"unwind": WAVE_M_S}}
LINEAR = [
    (row, name)
    for row in CATALOGUE
    for name, parameter in row.accepts.items()
    if parameter.linear and parameter.role == "strength" and not parameter.detail
]


@pytest.fixture(scope="module")
def bare() -> dict[str, np.ndarray]:  # type: ignore[type-arg]
    return run(**SHORT)


def test_every_effect_file_has_one_row_under_its_own_name() -> None:
    files = {
        name
        for _f, name, _p in pkgutil.iter_modules(sim_plant.effects.__path__)
        if hasattr(__import__(f"sim_plant.effects.{name}", fromlist=["EFFECT"]), "EFFECT")
    }
    assert sorted(row.name for row in CATALOGUE) == sorted(files)


def test_every_row_explains_itself() -> None:
    for row in CATALOGUE:
        assert len(row.text) > 20
        assert inspect.getdoc(row.apply)


@pytest.mark.parametrize("row", CATALOGUE, ids=lambda row: row.name)
def test_an_effect_at_its_defaults_is_bit_identical_to_its_absence(row: Effect, bare) -> None:  # type: ignore[no-untyped-def]
    there = run(
        *[effect(row.name, place) for place in candidate_locations(euclid(), row)], **SHORT
    )
    assert all(np.array_equal(there[name], bare[name]) for name in bare)


@each_case("row", CATALOGUE, ids=lambda row: row.name)
def test_a_parameter_it_does_not_know_is_refused(row: Effect) -> None:
    place = candidate_locations(euclid(), row)[0]
    with pytest.raises(PlantError, match=r"unknown key 'nonsense'"):
        run(effect(row.name, place, nonsense=1.0))


@each_case("row", CATALOGUE, ids=lambda row: row.name)
def test_a_location_that_does_not_exist_is_refused(row: Effect) -> None:
    with pytest.raises(PlantError, match=r"effects\.0\.location"):
        run(effect(row.name, "nowhere"))


@each_case("row", CATALOGUE, ids=lambda row: row.name)
def test_what_tracing_reads_is_consistent(row: Effect) -> None:
    forms = row.onset.forms if row.onset is not None else ()
    assert {*row.fitted, *(name for form in forms for name in form)} <= set(row.accepts)
    assert row.fitted or forms
    if row.onset is not None:
        assert row.onset.moment in row.accepts
        assert {name for name, _ in (*row.onset.fixed, *row.onset.grid)} <= set(row.accepts)
    for pair in row.quadratures:
        assert {pair.cos, pair.sin} <= set(row.accepts)
        assert {pair.amplitude, pair.angle} - {""} <= set(row.accepts)
    for name, parameter in row.accepts.items():
        _check_parameter(name, parameter)


def _check_parameter(name: str, parameter: Parameter) -> None:
    if isinstance(parameter.default, str):
        assert parameter.default in parameter.words, name
        return
    assert parameter.low <= parameter.default <= parameter.high, name
    assert parameter.low <= parameter.typical <= parameter.high, name
    assert all(parameter.low <= float(x) <= parameter.high for x in parameter.tries), name
    if parameter.role == "strength":
        assert parameter.typical != parameter.default, name


@each_case("row", CATALOGUE, ids=lambda row: row.name)
def test_what_shows_as_a_line_has_coordinates(row: Effect) -> None:
    if isinstance(row.shows, Orders):
        at = row.shows.at(row.parameters, 0.1)
        assert at
    elif isinstance(row.shows, Frequency):
        at = (row.shows.at(row.parameters),)
    else:
        return
    assert all(math.isfinite(x) and x >= 0.0 for x in at)


@each_case("row", CATALOGUE, ids=lambda row: row.name)
def test_only_what_acts_in_the_web_once_or_more_a_turn_is_cancelled(row: Effect) -> None:
    if row.cancel_orders:
        assert row.order_locked
        assert not row.sensor_only
        assert all(order >= 1 for order in row.cancelled(row.parameters))


@each_case("row", CATALOGUE, ids=lambda row: row.name)
def test_a_remedy_says_where_on_the_machine(row: Effect) -> None:
    assert len(row.remedy.format(place="R99")) > 10
    assert not row.remedy.endswith(".")
    if row.place in ("body", "cell", "drive"):
        assert "R99" in row.remedy.format(place="R99")


@each_case("row", CATALOGUE, ids=lambda row: row.name)
def test_names_beside_the_parameters_are_names_of_parameters(row: Effect) -> None:
    assert {number.parameter for number in row.declared_as} <= set(row.accepts)
    for name in row.fitted_later:  # the one try is what it is until a record tells
        assert row.accepts[name].role == "shape"
        assert len(row.accepts[name].tries) == 1
        assert name not in row.fitted
    if row.profiles is not None:
        assert {row.profiles.size, row.profiles.age} <= set(row.accepts) - set(row.fitted)
    if row.name_in_version_1:
        assert set(row.accepts) <= set(BY_NAME[row.name_in_version_1].accepts)


@each_case("row", CATALOGUE, ids=lambda row: row.name)
def test_an_effect_that_is_a_declared_number_names_one_that_the_line_has(row: Effect) -> None:
    known = {number.name for number in declared_numbers(euclid())}
    mine = [e for e in equivalents(euclid()) if e.effect is row]
    assert {e.number for e in mine} <= known
    assert bool(mine) is bool(row.declared_as)


@pytest.mark.parametrize(("row", "name"), LINEAR, ids=lambda x: getattr(x, "name", x))
@pytest.mark.sweep(every=5)
def test_a_parameter_called_linear_moves_the_record_in_proportion(
    row: Effect,
    name: str,
    bare,  # type: ignore[no-untyped-def]
) -> None:
    place = candidate_locations(euclid(), row)[-1]
    parameter = row.accepts[name]
    beside = {k: p.tries[0] for k, p in row.accepts.items() if p.tries and p.role != "strength"}
    short = SHORT if row.fitted else PASSING
    reference = (
        run(effect(row.name, place, **beside), **short) if beside or short != SHORT else bare
    )
    default = float(parameter.default)
    step = 0.2 * (parameter.typical - default)

    def change(factor: float):  # type: ignore[no-untyped-def]
        given = {**beside, name: default + factor * step}
        moved = run(effect(row.name, place, **given), **short)
        return np.concatenate(
            [moved[c] - reference[c] for c in reference if reference[c].ndim == 1]
        )

    once, twice = change(1.0), change(2.0)
    assert np.max(np.abs(once)) > 0.0
    assert np.linalg.norm(twice - 2.0 * once) < 0.1 * np.linalg.norm(twice)
