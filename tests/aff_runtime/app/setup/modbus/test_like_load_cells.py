"""A PLC with load cells at one tension: nothing is taken unasked, the one that moves is found."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from aff_runtime.app.setup.asking.dialogue import Dialogue
from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.quantities import quantities
from aff_runtime.app.setup.asking.questions import Question
from aff_runtime.app.setup.modbus import display_steps
from aff_runtime.app.setup.modbus.steps import Steps
from sim_plant.demo.unusual_plants import with_channels
from tests.aff_runtime.cli.virtual_line import VirtualLine
from tests.lockstep.plants import (
    LeftOpenError,
    RefusedAnswerError,
    Stand,
    Technician,
    UnusualPlant,
)

CELLS = {"unwind_tension_N": 2, "pullroll_tension_N": 9, "r3_tension_N": 19}
SHOWN_N = 90.0
WALK_S, HELD_S = 3.0, 2.0
PLC = (with_channels({"r3_tension_N": "{ address: 19, type: i32, scale: 0.001 }"}),)


class OneTension(VirtualLine):
    """Every load cell shows 90 N and its own ripple; somebody may push some of them."""

    def __init__(self) -> None:
        super().__init__(0.005)
        self.pushed: dict[str, float] = {}
        self.from_s = 0.0

    def step(self, inputs: Mapping[str, float]) -> Mapping[str, float]:
        row = dict(super().step(inputs))
        held = WALK_S <= self.t_s - self.from_s < WALK_S + HELD_S
        row["pullroll_tension_N"] += SHOWN_N - 95.0
        row["r3_tension_N"] += SHOWN_N - 83.0
        for name, by in self.pushed.items():
            row[name] += by if held else 0.0
        return row


class AtTheRoller(Technician):
    """Pushes when he is told to."""

    def __init__(self, stand: Stand, line: OneTension, pushed: Mapping[str, float]) -> None:
        super().__init__(stand)
        self.line, self.pushes = line, dict(pushed)
        self.asked: list[str] = []

    def answer(self, question: Question) -> str:
        self.asked.append(question.name)
        if ".move" in question.name:
            self.line.pushed, self.line.from_s = self.pushes, self.line.t_s
        return super().answer(question)


def at_work(
    folder: Path, channel: str, pushed: Mapping[str, float], **answers: str
) -> tuple[AtTheRoller, dict[str, int]]:
    """Find one tension; return who did it and the words that are kept."""
    line = OneTension()
    plant = UnusualPlant(
        plc=PLC, answers={f"{channel}.display": "90.1 N", f"{channel}.pick": "move", **answers}
    )
    stand = Stand(plant, line, folder)
    technician = AtTheRoller(stand, line, pushed)
    kept = found_by(stand, technician, folder, channel)
    return technician, kept


def found_by(stand: Stand, technician: Technician, folder: Path, channel: str) -> dict[str, int]:

    answers = {"first": "0", "count": "22", "device_id": "1"}
    dialogue = Dialogue(Draft(answers=answers), folder / "site.setup.json", technician)
    steps = Steps(dialogue, stand.reader(dialogue.draft))
    steps.survey()
    wanted = next(
        one for one in quantities("pull", "pullroll_tension_N") if one.channel == channel
    )
    steps.quantity(wanted)
    return {name: word.address for name, word in dialogue.draft.words.items()}


def test_enter_alone_takes_no_cell_and_says_why(tmp_path: Path) -> None:
    with pytest.raises(RefusedAnswerError) as refused:
        at_work(tmp_path, "unwind_tension_N", {}, **{"unwind_tension_N.pick": ""})
    assert str(refused.value) == (
        "unwind_tension_N.pick: no row is taken unasked: rows 1, 2, 3 fit alike, and a wrong word "
        "in the loop moves the web. Write 1 to 5 or again or move."
    )


@pytest.mark.parametrize("pushed", CELLS)
@pytest.mark.sweep(every=3)
def test_the_cell_that_is_moved_is_taken_by_enter_and_the_others_are_shown(
    pushed: str, tmp_path: Path
) -> None:
    others = dict.fromkeys(CELLS, 0.4)
    who, kept = at_work(tmp_path, "unwind_tension_N", others | {pushed: 8.0})
    assert kept == {"unwind_tension_N": CELLS[pushed]}
    assert who.asked == [
        f"unwind_tension_N.{name}" for name in ("display", "pick", "rest2", "move2", "pick2")
    ]
    told = [line for line in who.said if "changed by" in line]
    assert len(told) == len(CELLS)
    assert told[0].startswith(f"  word {CELLS[pushed]:5} changed by 8.")


def test_all_that_move_together_leave_it_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(display_steps, "MOVE_S", 6.0)
    with pytest.raises(LeftOpenError, match=r"unwind_tension_N\.pick2"):
        at_work(tmp_path, "unwind_tension_N", dict.fromkeys(CELLS, 8.0))


def test_whoever_moves_nothing_is_told_and_asked_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(display_steps, "MOVE_S", 6.0)
    again = {"unwind_tension_N.pick2": "w9"}
    who, kept = at_work(tmp_path, "unwind_tension_N", {}, **again)
    assert "  no word moved further than at rest: move it more, or longer" in who.said
    assert kept == {"unwind_tension_N": 9}
