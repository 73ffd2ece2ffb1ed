"""The step at which settings are tried while the correction goes out: screen and card mean one."""

from aff_hmi.commission import presses
from aff_runtime.app.card import steps


def test_the_step_for_which_the_screen_asks_for_the_hand_is_the_cards_search() -> None:
    assert presses.SEARCH == steps.SEARCH
