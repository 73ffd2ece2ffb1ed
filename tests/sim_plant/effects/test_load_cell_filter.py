import pytest

from tests.sim_plant.effects.cells import FREQUENCY_HZ, cell_response
from tests.sim_plant.effects.running import effect


@pytest.mark.parametrize(
    ("parameters", "corner_Hz"),
    [({"corner_Hz": 3.0}, 3.0), ({"lag_s": 0.045}, 1.0 / (1.0 / 20.0 + 0.2827433))],
)
def test_the_reading_lags_like_a_first_order_filter(
    parameters: dict[str, float], corner_Hz: float
) -> None:
    found = cell_response(effect("load_cell_filter", "R3", **parameters))
    assert found == pytest.approx(1.0 / (1.0 + 1j * FREQUENCY_HZ / corner_Hz), abs=1.2e-2)
