"""What the record held out refutes is not claimed; unknown is only what that record shows."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.refine.confirm import confirmed
from tests.sim_plant.refine.small import quiet
from tests.sim_plant.refine.test_imitating import SAMPLES, both_drags, held_out, of_both

WAVE = 0.3 * np.sin(2.0 * np.pi * 1.3 * 0.01 * np.arange(SAMPLES))


@pytest.mark.parametrize(("sine_N", "is_unknown"), [(0.0, False), (4.0, True)])
def test_what_a_record_lacks_is_not_claimed_and_unknown_only_where_it_shows_something(
    sine_N, is_unknown
):
    """The effects explain 0.045 of the noise's power at a frequency that the record lacks."""
    judged = held_out(1.0, sine_N)
    evaluation = replace(
        of_both({}, (1.0 + 0.5 * sine_N**2) ** 0.5), measured=judged.measured, amended=WAVE[None]
    )
    found = confirmed(judged, both_drags(), evaluation, 1, quiet)
    assert found.selection.accepted == ()
    assert bool(found.selection.unknown) is is_unknown
    assert "explains what was fitted, and not B" in found.said[0]
