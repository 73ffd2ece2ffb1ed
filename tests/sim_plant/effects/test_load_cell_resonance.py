import pytest

from tests.sim_plant.effects.cells import FREQUENCY_HZ, cell_response
from tests.sim_plant.effects.running import effect


@pytest.mark.parametrize("resonance_Hz", [6.0, 12.0])
def test_the_reading_is_amplified_like_a_second_order_system(resonance_Hz: float) -> None:
    found = cell_response(
        effect("load_cell_resonance", "R3", frequency_Hz=resonance_Hz, damping=0.1)
    )
    x = FREQUENCY_HZ / resonance_Hz
    expected = 1.0 / (1.0 - x * x + 0.2j * x) / (1.0 + 1j * FREQUENCY_HZ / 20.0)
    assert found == pytest.approx(expected, rel=2e-2)
