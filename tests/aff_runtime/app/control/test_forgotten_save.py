"""What is forgotten after an output has closed is not saved by the look that comes next."""

from __future__ import annotations

import math

import pytest

from aff_runtime.app.control.shape_keeper import KEPT_AFTER_TURNS, ShapeKeeper
from aff_runtime.app.wiring.shape_file import ShapeFile
from aff_runtime.core.gate import ANGLE_FADE_S
from aff_runtime.core.shape.profile import ShapeProfile
from tests.aff_runtime.app.test_assembled_shape import CYCLE_S, EUCLID, RECORD, SHUT, Line

LEARNED_M = {("unwind", 1): 4e-4 - 3e-4j, ("unwind", 2): 1e-4j, ("swrap_follower", 1): 2e-4 + 0j}
assert {key[0] for key in LEARNED_M} == set(EUCLID.rolls)


class Closing:
    """A service whose output has just closed, after more turns than a shape needs to be kept."""

    def __init__(self) -> None:
        self.line, self.kept = Line(), list[ShapeFile]()
        self.keeper = ShapeKeeper(RECORD, tell=lambda *_: None, keep=self._keep)
        self.line.run(1.0, permission=SHUT)
        self.line.shape.start_from(
            ShapeProfile(weight_m=LEARNED_M, response_ratio_less_1={}, imbalance_m={})
        )
        turn_s = math.tau / self.line.law.slowest_omega_rad_s
        self._look(active=True, elapsed_s=(KEPT_AFTER_TURNS + 1.0) * turn_s)

    def _keep(self, _: str, text: str) -> None:
        self.kept.append(ShapeFile.from_json(text))

    def _look(self, *, active: bool, elapsed_s: float) -> None:
        self.keeper.save_when_closed(
            self.line.law,
            active=active,
            quiet=not active,
            unbelieved=frozenset(),
            elapsed_s=elapsed_s,
        )

    def saved(self, after_s: float) -> dict[tuple[str, int], complex]:
        """Return the sizes of what the next look saves."""
        self.line.run(after_s, permission=SHUT)
        self._look(active=False, elapsed_s=after_s)
        found = self.kept.pop().profile.weight_m if self.kept else {}
        return {key: abs(w) for key, w in found.items()}


@pytest.mark.parametrize("roll", list(EUCLID.rolls))
@pytest.mark.parametrize("after_s", [0.0, CYCLE_S, 0.1, 2.0 * ANGLE_FADE_S])
def test_a_roll_that_is_forgotten_before_the_save_is_left_out(roll: str, after_s: float) -> None:
    service = Closing()
    assert service.keeper.forget(service.line.law, [roll]) == {roll}
    others = {key: abs(w) for key, w in LEARNED_M.items() if key[0] != roll}
    assert service.saved(after_s) == pytest.approx(others)
    assert service.saved(after_s) == {}


def test_without_that_every_roll_is_saved() -> None:
    assert Closing().saved(0.1) == pytest.approx({key: abs(w) for key, w in LEARNED_M.items()})
