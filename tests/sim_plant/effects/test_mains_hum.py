import numpy as np
import pytest

from tests.sim_plant.effects.running import effect, run


def test_sixty_hertz_sampled_at_ten_milliseconds_is_a_line_at_forty() -> None:
    args = {"seconds": 4.0, "sample_time_s": 0.01, "settle_s": 4.0}
    hum = run(effect("mains_hum", "R3", frequency_Hz=60.0, cos_N=0.3, sin_N=0.4), **args)  # type: ignore[arg-type]
    extra = hum["r3_tension_N"] - run(**args)["r3_tension_N"]  # type: ignore[arg-type]
    spectrum = np.abs(np.fft.rfft(extra)) * 2.0 / extra.size
    frequencies = np.fft.rfftfreq(extra.size, 0.01)
    assert frequencies[np.argmax(spectrum)] == pytest.approx(40.0)
    assert spectrum.max() == pytest.approx(0.5, rel=1e-6)
    time_s = 0.01 * np.arange(extra.size)
    turn = 2.0 * np.pi * 60.0 * time_s
    assert extra == pytest.approx(0.3 * np.cos(turn) + 0.4 * np.sin(turn), abs=1e-9)


def test_cells_scanned_one_after_another_hum_at_phases_of_their_own() -> None:
    """R3 is the third cell that the line declares; its word goes into no loop."""
    args = {"seconds": 2.0, "sample_time_s": 0.01, "settle_s": 4.0}
    hum = run(effect("mains_hum", "all", frequency_Hz=60.0, cos_N=0.2, sin_2_N=0.1), **args)  # type: ignore[arg-type]
    alike = run(effect("mains_hum", "all", frequency_Hz=60.0, cos_N=0.2), **args)  # type: ignore[arg-type]
    turn = 2.0 * np.pi * 60.0 * 0.01 * np.arange(hum["r3_tension_N"].size)
    more = hum["r3_tension_N"] - alike["r3_tension_N"]
    assert more == pytest.approx(0.1 * np.sin(turn), abs=1e-9)
    assert np.array_equal(hum["pullroll_tension_N"], alike["pullroll_tension_N"])
