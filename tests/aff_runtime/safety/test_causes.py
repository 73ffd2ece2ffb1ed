from __future__ import annotations

from aff_runtime.base.events import BY_CODE, TABLE, Reaction
from aff_runtime.safety.causes import FADING, HOLDING, LATCHING, bit, first_code


def test_every_event_that_acts_is_in_exactly_one_group_by_its_reaction() -> None:
    groups = {
        Reaction.NOTE: 0,
        Reaction.HOLD: HOLDING,
        Reaction.FADE: FADING,
        Reaction.FADE_AND_LATCH: LATCHING,
    }
    for event in TABLE:
        mine = [reaction for reaction, mask in groups.items() if mask & bit(event.name)]
        assert mine == ([] if event.reaction is Reaction.NOTE else [event.reaction])


def test_the_first_code_is_the_lowest_one_set() -> None:
    assert first_code(0) == 0
    for code in BY_CODE:
        assert first_code((1 << code) | (1 << 20)) == code
