"""A live edit, or a roll that is forgotten, while a known shape waits for its trial."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from aff_runtime.app.control.shape_keeper import ShapeKeeper
from aff_runtime.app.wiring.assemble import controller_of
from aff_runtime.app.wiring.shape_file import shape_basis_hash
from aff_runtime.config.models import Site
from aff_runtime.config.models.actuators import Start
from aff_runtime.core.shape.profile import ShapeProfile
from tests.aff_runtime.app.control.test_shape_response import OWN, ROLL_M, saved
from tests.aff_runtime.app.test_assembled_shape import (
    CYCLE_S,
    EUCLID,
    RESPONSES,
    SHUT,
    SPEED_M_S,
    TAPS,
    Line,
)
from tests.parameter_records import record_of

TURN_S = math.tau * 0.2 / SPEED_M_S
MEMORY_S = EUCLID.actuators["unwind"].response_memory_s
TRIAL_S = MEMORY_S + 4.0 * TURN_S  # three turns of every roll, and one to spare
UNWIND_M = {("unwind", n): w for n, w in ROLL_M.items()}
FOLLOWER_M = {("swrap_follower", 1): 2e-4 + 1e-4j}


def with_blocks(**blocks: object) -> Site:
    """Return the Euclid line with other blocks of the unwind."""
    unwind = EUCLID.actuators["unwind"].model_copy(update=blocks)
    return EUCLID.model_copy(update={"actuators": {**EUCLID.actuators, "unwind": unwind}})


BLOCKS = EUCLID.actuators["unwind"].blocks
ONE_ROLL = with_blocks(blocks=tuple(b for b in BLOCKS if b.roll == "unwind"))


def starting(deviation_m: float) -> Site:
    """Return the Euclid line whose file starts both rolls of the unwind from so much."""
    start = (Start(order=1, deviation_m=deviation_m, angle_rad=0.5),)
    return with_blocks(blocks=tuple(b.model_copy(update={"start": start}) for b in BLOCKS))


class Service:
    """A keeper beside a line, nothing going out."""

    def __init__(self, site: Site, shapes: dict[str, str]) -> None:
        self.said: list[str] = []
        self.line = Line()
        self.line.law = controller_of(site, RESPONSES, TAPS)
        self.keeper = ShapeKeeper(
            record_of(site, shapes=shapes, responses=RESPONSES),
            tell=lambda _, text: self.said.append(text),
            keep=lambda *_: None,
        )

    def edit(self, site: Site) -> None:
        """Go on with another site file, as the control process does."""
        successor = controller_of(site, RESPONSES, TAPS)
        successor.adopt(self.line.law)
        self.line.law = successor
        self.keeper.follow(record_of(site, responses=RESPONSES))

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / CYCLE_S)):
            self.line.step(SHUT)
            self.keeper.feed_trials(self.line.law, self.line.values(), fresh=True, quiet=True)

    def started(self) -> set[str]:
        """Return the rolls of which the law has a shape."""
        return {roll for (roll, _), w in self.line.shape.weights().items() if w != 0j}


def shape_of(site: Site, weight_m: dict[tuple[str, int], complex]) -> dict[str, str]:
    profile = ShapeProfile(weight_m=weight_m, response_ratio_less_1={})
    basis = shape_basis_hash(site, "unwind")
    return {"unwind": replace(saved(OWN), belongs_to=basis, profile=profile).to_json()}


@pytest.mark.parametrize("before_s", [1.0, MEMORY_S + TURN_S])
def test_an_edit_that_adds_another_roll_ends_the_trial_of_a_saved_shape(before_s):
    service = Service(ONE_ROLL, shape_of(ONE_ROLL, UNWIND_M))
    service.run(before_s)
    service.edit(EUCLID)
    service.run(TRIAL_S)
    assert service.started() == set()
    _, refused = service.said
    assert "learned with other rolls, or another encoder, drive or signal" in refused
    assert "learned anew" in refused


def test_without_an_edit_the_same_shape_is_tried():
    service = Service(ONE_ROLL, shape_of(ONE_ROLL, UNWIND_M))
    service.run(TRIAL_S)
    waits, tried = service.said
    assert "4 s and 3 turns of every roll" in waits
    assert "agreement" in tried


def test_a_saved_shape_that_was_forgotten_does_not_come_back_with_an_edit():
    service = Service(EUCLID, shape_of(EUCLID, UNWIND_M | FOLLOWER_M))
    service.run(1.0)
    service.keeper.forget(service.line.law)
    service.edit(EUCLID)
    service.run(TRIAL_S)
    _, tried = service.said
    assert tried.startswith("swrap_follower: ")


def test_a_start_shape_that_was_forgotten_comes_back_only_when_the_file_has_another():
    service = Service(starting(1e-3), {})
    service.run(1.0)
    service.keeper.forget(service.line.law)
    service.edit(starting(1e-3))
    service.run(TRIAL_S)
    _, tried = service.said
    assert tried.startswith("swrap_follower: ")


def test_a_start_shape_that_is_new_since_the_roll_was_forgotten_is_tried():
    service = Service(starting(1e-3), {})
    service.keeper.forget(service.line.law)
    service.edit(starting(2e-3))
    service.run(TRIAL_S)
    assert {text.partition(":")[0] for text in service.said[1:]} == {"unwind", "swrap_follower"}


def test_an_actuator_of_which_all_was_forgotten_waits_for_no_trial():
    service = Service(ONE_ROLL, shape_of(ONE_ROLL, UNWIND_M))
    service.keeper.forget(service.line.law)
    service.edit(ONE_ROLL)
    service.run(TRIAL_S)
    assert len(service.said) == 1
    assert service.started() == set()
