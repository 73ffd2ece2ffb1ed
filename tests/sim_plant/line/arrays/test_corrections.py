import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.corrections import apply_corrections, declared_numbers
from sim_plant.line.open import make_line
from tests.each_case import each_case
from tests.sim_plant.line.lines import declared

LINE = declared("euclid")


def arrays(line=LINE):
    return build_arrays(line, timing_of(line, line.sample_time_s))


def flat(found):
    """Return every number of a line's arrays, by record and field."""
    rows = {}
    for name, record in found._asdict().items():
        values = np.asarray(record)
        for field in values.dtype.names or ("",):
            rows[name, field] = np.array(values[field] if field else values, copy=True)
    return rows


def differing(one, other):
    return {
        key
        for key, values in one.items()
        if values.dtype.kind in "fiu" and not np.array_equal(values, other[key])
    }


def test_a_correction_is_the_line_declared_with_that_number():
    web = LINE.web.model_copy(update={"EA_N": 0.9 * LINE.web.EA_N})
    other = flat(arrays(LINE.model_copy(update={"web": web})))
    put_right = flat(apply_corrections(LINE, arrays(), {"web.EA_N": -0.1}))
    for key in differing(flat(arrays()), other) | differing(flat(arrays()), put_right):
        np.testing.assert_allclose(put_right[key], other[key], rtol=1e-12, err_msg=str(key))
    assert differing(flat(arrays()), put_right)


@each_case("number", declared_numbers(LINE), ids=lambda n: n.name)
def test_every_declared_number_can_be_put_right_and_is_alone_in_it(number):
    before = flat(arrays())
    after = flat(apply_corrections(LINE, arrays(), {number.name: 1e-3}))
    assert 1 <= len(differing(before, after)) <= 4


def test_no_corrections_leave_the_line_as_declared():
    assert not differing(flat(arrays()), flat(apply_corrections(LINE, arrays(), {})))


def test_an_unknown_number_is_refused_with_the_nearest():
    with pytest.raises(PlantError, match=r"corrections\.web\.EA: .*did you mean 'web\.EA_N'"):
        apply_corrections(LINE, arrays(), {"web.EA": 0.1})


def test_a_line_file_with_corrections_runs_as_corrected():
    line = LINE.model_copy(update={"corrections": {"rollers.unwind.radius_m": 2e-3}})
    run = make_line(line, seed=None, speed_m_s=1.0, tension_N=88.9644)
    run.settle(2.0)
    out = run.simulate(np.full(50, 1.0), np.full(50, 88.9644))
    radius_m = LINE.rollers[0].radius_m
    # the drive divides by the declared radius; the tension loop then turns the roll slower
    assert out["unwind_speed_rad_s"][-1] == pytest.approx(1.0 / (radius_m * 1.002), rel=5e-4)


@pytest.mark.parametrize("amount", [60.0, -60.0, float("nan")])
def test_a_radius_that_leaves_no_room_for_a_span_is_refused_by_numbers(amount):
    line = LINE.model_copy(update={"corrections": {"rollers.swrap_follower.radius_m": amount}})
    with pytest.raises(PlantError, match=r"no room for span \d+: its bodies of radius .* apart"):
        make_line(line, seed=None)
