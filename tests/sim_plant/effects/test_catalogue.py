import inspect
import pkgutil

import numpy as np
import pytest

import sim_plant.effects
from aff_runtime.base.errors import PlantError
from sim_plant.base.effects import Effect, Parameter
from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.line.locations import candidate_locations
from tests.sim_plant.effects.running import effect, euclid, run

WAVE_M_S = 0.005 * np.sin(2.0 * np.pi * 1.5 * 0.005 * np.arange(200))
SHORT = {"seconds": 1.0, "settle_s": 2.0, "aff": {"unwind": WAVE_M_S}}
NAMES = set(
    """eccentric_roller out_of_round_roll unbalanced_roller bearing_drag web_modulus splice slip
    viscoelastic_web wound_in_strain load_cell_filter load_cell_resonance rate_limit mains_hum
    load_cell_calibration shaft_compliance_backlash torque_ripple thermal_strain loop_delay
    roll_bounce radius_error encoder_eccentricity unbalanced_measuring_roller""".split()  # noqa: SIM905
)
LINEAR = [
    (row, name)
    for row in CATALOGUE
    for name, parameter in row.accepts.items()
    if parameter.linear and parameter.role == "strength"
]
# what must be given beside a strength for it to act within a short run
BESIDE = {"roll_bounce": {"mass_kg": 20.0}, "slip": {"threshold_m_s": 0.2}}


@pytest.fixture(scope="module")
def bare() -> dict[str, np.ndarray]:  # type: ignore[type-arg]
    return run(**SHORT)


def test_every_effect_is_there_once() -> None:
    assert set(BY_NAME) == NAMES
    assert len(CATALOGUE) == len(NAMES)


def test_every_effect_file_has_one_row_under_its_own_name() -> None:
    files = {
        name
        for _f, name, _p in pkgutil.iter_modules(sim_plant.effects.__path__)
        if hasattr(__import__(f"sim_plant.effects.{name}", fromlist=["EFFECT"]), "EFFECT")
    }
    assert files == set(BY_NAME)


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


@pytest.mark.parametrize("row", CATALOGUE, ids=lambda row: row.name)
def test_a_parameter_it_does_not_know_is_refused(row: Effect) -> None:
    place = candidate_locations(euclid(), row)[0]
    with pytest.raises(PlantError, match=r"unknown key 'nonsense'"):
        run(effect(row.name, place, nonsense=1.0))


@pytest.mark.parametrize("row", CATALOGUE, ids=lambda row: row.name)
def test_a_location_that_does_not_exist_is_refused(row: Effect) -> None:
    with pytest.raises(PlantError, match=r"effects\.0\.location"):
        run(effect(row.name, "nowhere"))


@pytest.mark.parametrize("row", CATALOGUE, ids=lambda row: row.name)
def test_what_tracing_reads_is_consistent(row: Effect) -> None:
    assert set(row.traced) <= set(row.accepts)
    assert row.traced
    for pair in row.quadratures:
        assert {pair.cos, pair.sin} <= set(row.accepts)
        assert {pair.amplitude, pair.angle} - {""} <= set(row.accepts)
    for name, parameter in row.accepts.items():
        _check_parameter(name, parameter)


def _check_parameter(name: str, parameter: Parameter) -> None:
    if isinstance(parameter.default, str):
        assert parameter.tries, name
        return
    assert parameter.low <= parameter.default <= parameter.high, name
    assert parameter.low <= parameter.typical <= parameter.high, name
    assert all(parameter.low <= float(x) <= parameter.high for x in parameter.tries), name
    if parameter.role == "strength":
        assert parameter.typical != parameter.default, name


@pytest.mark.parametrize(("row", "name"), LINEAR, ids=lambda x: getattr(x, "name", x))
def test_a_parameter_called_linear_moves_the_record_in_proportion(
    row: Effect,
    name: str,
    bare,  # type: ignore[no-untyped-def]
) -> None:
    place = candidate_locations(euclid(), row)[-1]
    parameter, beside = row.accepts[name], BESIDE.get(row.name, {})
    reference = run(effect(row.name, place, **beside), **SHORT) if beside else bare
    default = float(parameter.default)
    step = 0.2 * (parameter.typical - default)

    def change(factor: float):  # type: ignore[no-untyped-def]
        given = {**beside, name: default + factor * step}
        moved = run(effect(row.name, place, **given), **SHORT)
        return np.concatenate(
            [moved[c] - reference[c] for c in reference if reference[c].ndim == 1]
        )

    once, twice = change(1.0), change(2.0)
    assert np.max(np.abs(once)) > 0.0
    assert np.linalg.norm(twice - 2.0 * once) < 0.1 * np.linalg.norm(twice)
