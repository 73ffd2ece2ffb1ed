"""What the demo hides: drawn by its seed, in the plant's file alone, and of a size that shows."""

from functools import cache

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.demo.loop.drawn import IDLER, LINE, Hidden, drawn, write_files
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from tests import quick_yaml

SEEDS = range(1, 9)


@pytest.fixture(autouse=True, scope="module")
def opened_once():
    """Read the shipped line once: two hundred draws are of the same."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sim_plant.demo.loop.drawn.load_declaration", cache(load_declaration))
        yield


def test_another_seed_is_another_case_and_the_same_seed_the_same():
    cases = [drawn("eccentric_roller", seed) for seed in SEEDS]
    assert cases == [drawn("eccentric_roller", seed) for seed in SEEDS]
    assert len({str(case) for case in cases}) == len(cases)
    assert len({idler.location for _, idler in cases}) > 2
    for roll, idler in cases:
        assert roll.location == "unwind"
        assert idler.location in {f"R{k}" for k in range(1, 10)}
        assert 2e-4 <= idler.parameters["eccentricity_m"] <= 4e-4


@pytest.mark.parametrize("name", sorted(BY_NAME))
@pytest.mark.sweep(every=4)
def test_every_effect_of_the_catalogue_can_be_hidden(name, tmp_path):
    hidden = drawn(name, 3)
    files = write_files(tmp_path, hidden)
    plant = load_declaration(files.plant)
    assert [(e.effect, e.location) for e in plant.effects] == [
        (one.effect, one.location) for one in hidden
    ]
    make_line(plant, seed=1)
    assert any(
        value != BY_NAME[name].accepts[key].default for key, value in hidden[1].parameters.items()
    )


@pytest.mark.parametrize("name", sorted(BY_NAME))
def test_what_is_drawn_is_some_times_the_typical_change_and_at_no_bound(name):
    """A radius wrong by a quarter is another roller, and no estimate at a bound counts."""
    for seed in SEEDS:
        _, hidden = drawn(name, seed)
        for key, value in hidden.parameters.items():
            row = BY_NAME[name].accepts[key]
            if row.role != "strength" or name == IDLER:
                continue
            typical = row.typical - row.default
            assert 1.99 <= (value - row.default) / typical <= 4.01, (seed, key, value)
            assert row.low < value < row.high, (seed, key, value)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_radius_error_that_is_drawn_is_of_a_roll_that_refine_takes(seed):
    _, hidden = drawn("radius_error", seed)
    assert abs(hidden.parameters["ratio"] - 1.0) < 0.1 * CRITERIA.model.run.other_share


@pytest.mark.parametrize("wire", ["modbus", "can"])
def test_line_and_site_say_nothing_of_it(wire, tmp_path):
    files = write_files(tmp_path, drawn("eccentric_roller", 1), wire)
    assert files.line.read_text() == LINE.read_text()
    site = quick_yaml.safe_load(files.site.read_text())
    assert set(site["rolls"]) == {"unwind", "swrap_follower"}
    assert site["line"]["speed_reference"] in site["gateway"]["read"]["channels"]


def test_an_effect_that_there_is_not_is_refused_with_the_nearest_name():
    with pytest.raises(
        PlantError, match=r"EFFECT=eccentric_rollr: no such effect.*eccentric_roller"
    ):
        drawn("eccentric_rollr", 1)


def test_an_entry_is_that_of_a_line_file():
    one = Hidden(effect="slip", location="swrap", parameters={"a": 1.0})
    assert one.entry() == {"effect": "slip", "location": "swrap", "parameters": {"a": 1.0}}
