import math

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.servers.faults import Fault, FaultBoard, parse_fault


@pytest.mark.parametrize(
    ("text", "fault", "argument", "start_s", "duration_s"),
    [
        ("freeze@10:5", Fault.FREEZE, "", 10.0, 5.0),
        ("mute", Fault.MUTE, "", 0.0, math.inf),
        ("delay=2.5@1", Fault.DELAY, "2.5", 1.0, math.inf),
        ("restart", Fault.RESTART, "", 0.0, 1.0),
        ("permissive:.5", Fault.PERMISSIVE, "WEB_INTACT", 0.0, 0.5),
        ("nan=unwind_tension_N@3", Fault.NAN, "unwind_tension_N", 3.0, math.inf),
    ],
)
def test_a_fault_is_read_as_spelled(text, fault, argument, start_s, duration_s):
    spec = parse_fault(text)
    assert (spec.fault, spec.argument, spec.start_s, spec.duration_s) == (
        fault,
        argument,
        start_s,
        duration_s,
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("frezze@1", "unknown name"),
        ("mute@-1", "write NAME"),
        ("delay", "MILLISECONDS"),
        ("mute=3", "takes no argument"),
        ("permissive=WEB", "unknown status bit"),
        ("", "write NAME"),
    ],
)
def test_a_misspelt_fault_is_refused(text, said):
    with pytest.raises(PlantError, match=said):
        parse_fault(text)


def edges(board, now_s):
    return [(edge.spec.fault.value, edge.began) for edge in board.advance(now_s)]


def test_a_window_begins_and_ends_once():
    board = FaultBoard((parse_fault("mute@1:2"),))
    assert edges(board, 0.9) == []
    assert edges(board, 1.0) == [("mute", True)]
    assert edges(board, 2.9) == []
    assert board.active(Fault.MUTE)
    assert edges(board, 3.0) == [("mute", False)]
    assert not board.active(Fault.MUTE)


def test_an_injected_fault_counts_from_now_and_clearing_ends_it():
    board = FaultBoard()
    board.advance(5.0)
    board.inject(parse_fault("delay=4@1"))
    assert edges(board, 5.9) == []
    assert edges(board, 6.1) == [("delay", True)]
    assert board.argument(Fault.DELAY) == "4"
    board.clear(Fault.DELAY)
    assert edges(board, 6.2) == [("delay", False)]


def test_clearing_forgets_what_was_still_to_come():
    board = FaultBoard((parse_fault("mute@1"), parse_fault("busy@1")))
    board.clear(Fault.MUTE)
    assert edges(board, 1.0) == [("busy", True)]


def test_a_second_fault_of_a_kind_replaces_the_first():
    board = FaultBoard((parse_fault("splice@1:9"), parse_fault("splice@2:1")))
    board.advance(1.0)
    assert edges(board, 2.0) == [("splice", False), ("splice", True)]
    assert edges(board, 3.0) == [("splice", False)]


def test_of_two_of_a_kind_that_begin_in_one_step_the_first_ends_before_the_second_begins():
    board = FaultBoard()
    board.inject(parse_fault("permissive=WEB_INTACT@0.2"))
    board.inject(parse_fault("permissive=ESTOP_OK@0.1"))
    got = [(edge.spec.argument, edge.began) for edge in board.advance(0.5)]
    assert got == [("ESTOP_OK", True), ("ESTOP_OK", False), ("WEB_INTACT", True)]
    assert board.argument(Fault.PERMISSIVE) == "WEB_INTACT"
