import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.lookup import support_at
from sim_plant.geometry.roll_profiles import flat_spot
from sim_plant.geometry.shapes import Shape, circle, ellipse
from sim_plant.geometry.table import tabulate

ANGLES = np.random.default_rng(3).uniform(-400.0, 400.0, 3000)


@pytest.mark.parametrize(
    ("shape", "h_m", "slope_m", "rho_m"),
    [(ellipse(0.205, 0.199), 1e-14, 1e-13, 1e-10), (flat_spot(0.012, 0.2032), 1e-11, 1e-8, 3e-5)],
    ids=["ellipse", "flat spot"],
)
def test_lookup_agrees_with_the_fourier_sum(
    shape: Shape, h_m: float, slope_m: float, rho_m: float
) -> None:
    table = tabulate(shape)
    found = np.array(
        [support_at(table.support_m, table.slope_m, table.curvature_m, x) for x in ANGLES]
    )
    h, slope, rho = shape.evaluate(ANGLES)
    radius_m = shape.mean_radius_m
    assert np.max(np.abs(found[:, 0] + radius_m - h)) < h_m
    assert np.max(np.abs(found[:, 1] - slope)) < slope_m
    assert np.max(np.abs(found[:, 2] + radius_m - rho)) < rho_m


def test_lookup_is_periodic_and_safe_at_the_seam() -> None:
    table = tabulate(ellipse(0.205, 0.199), points=1024)
    seam = [
        support_at(table.support_m, table.slope_m, table.curvature_m, psi)
        for psi in (0.0, 2.0 * np.pi, -1e-18, np.nextafter(2.0 * np.pi, 0.0))
    ]
    assert np.ptp(np.array(seam), axis=0) == pytest.approx(0.0, abs=1e-12)


def test_columns_are_contiguous_and_close_on_themselves() -> None:
    table = tabulate(flat_spot(0.012, 0.2032))
    for column in (table.support_m, table.slope_m, table.curvature_m):
        assert column.shape == (4097,)
        assert column.flags.c_contiguous
        assert column[0] == column[-1]


def test_circle_has_no_deviation() -> None:
    table = tabulate(circle(0.1), points=64)
    assert not np.any([table.support_m, table.slope_m, table.curvature_m])


def test_table_too_coarse_for_the_orders_is_refused() -> None:
    with pytest.raises(PlantError, match="cannot hold 256 orders"):
        tabulate(flat_spot(0.012, 0.2032), points=512)


def test_a_table_is_made_once_of_a_shape_and_nobody_writes_in_it() -> None:
    shape = ellipse(0.205, 0.199)
    table = tabulate(shape)
    assert tabulate(shape) is table
    assert tabulate(shape.turned(0.1)) is not table
    with pytest.raises(ValueError, match="read-only"):
        table.support_m[0] = 1.0
