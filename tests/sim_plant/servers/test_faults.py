import math

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.servers.faults import Fault, FaultBoard, parse_fault
from tests.each_case import each_case


@each_case(
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


@each_case(
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


def test_the_same_fault_again_begins_anew():
    board = FaultBoard((parse_fault("splice@1:9"), parse_fault("splice@2:1")))
    board.advance(1.0)
    assert edges(board, 2.0) == [("splice", False), ("splice", True)]
    assert edges(board, 3.0) == [("splice", False)]


def test_of_one_fault_twice_in_one_step_the_first_ends_before_the_second_begins():
    board = FaultBoard()
    board.inject(parse_fault("permissive=WEB_INTACT@0.2"))
    board.inject(parse_fault("permissive=WEB_INTACT@0.1:3"))
    got = [(edge.spec.start_s, edge.began) for edge in board.advance(0.5)]
    assert got == [(0.1, True), (0.1, False), (0.2, True)]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("nan=unwind_tension_N", "nan=pullroll_tension_N"),
        ("stuck", "stuck=line_speed_m_s"),
        ("permissive=WEB_INTACT", "permissive=ESTOP_OK"),
    ],
)
def test_faults_of_unlike_channels_or_bits_stand_together(first, second):
    board = FaultBoard((parse_fault(first), parse_fault(f"{second}@1:2")))
    board.advance(1.0)
    kind = parse_fault(first).fault
    assert board.names() == [first, second]
    assert board.arguments(kind) == [parse_fault(s).argument for s in (first, second)]
    (ended,) = board.advance(3.0)
    assert ended.spec.name == second
    assert board.active(kind)
    board.clear(kind)
    board.advance(3.1)
    assert not board.active(kind)
    assert not board.any_of(frozenset({kind}))


def test_where_one_of_a_kind_can_be_another_meanwhile_is_refused():
    board = FaultBoard((parse_fault("delay=100@1:2"),))
    says = r"'delay=900': 'delay=100' is in force meanwhile \(from 1 s of plant time to 3 s\)"
    with pytest.raises(PlantError, match=says):
        board.inject(parse_fault("delay=900"))
    board.inject(parse_fault("delay=900:1"))
    board.inject(parse_fault("delay=500@3"))
    board.inject(parse_fault("delay=100@2:1"))  # the same again
    assert edges(board, 0.5) == [("delay", True)]
    assert edges(board, 1.0) == [("delay", False), ("delay", True)]
    with pytest.raises(PlantError, match=r"until it is cleared.*clear 'delay' first"):
        board.inject(parse_fault("delay=1@9"))
    board.clear(Fault.DELAY)
    board.inject(parse_fault("delay=1"))
    assert edges(board, 1.1) == [("delay", False), ("delay", True)]
    assert board.argument(Fault.DELAY) == "1"
    with pytest.raises(PlantError, match="'lose=20': 'lose=50' is in force"):
        FaultBoard((parse_fault("lose=50"), parse_fault("lose")))
