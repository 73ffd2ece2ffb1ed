"""What is asked the same way on every wire: the line and its channels, and the drive."""

from __future__ import annotations

from collections.abc import Callable

from aff_runtime.app.setup.asking.dialogue import Dialogue
from aff_runtime.app.setup.asking.draft import MOST_FURTHER, SECOND_TENSION
from aff_runtime.app.setup.asking.drive_questions import drive_questions, law_question
from aff_runtime.app.setup.asking.interview import (
    angles_of,
    further_question,
    line_questions,
    machine_questions,
    quantities_of,
    second_question,
)
from aff_runtime.app.setup.asking.quantities import Quantity, further
from aff_runtime.app.setup.asking.questions import NONE, Question


def ask_line(
    dialogue: Dialogue, look: Callable[[Quantity], None], look_at_angle: Callable[[Quantity], None]
) -> None:
    """Ask for all of the line that is the same on every wire.

    ``look`` finds a quantity at the PLC, ``look_at_angle`` an angle.
    """
    _names(dialogue)
    for quantity in quantities_of(dialogue.draft):
        look(quantity)
    for question in machine_questions(dialogue.draft):
        dialogue.ask(question)
    for quantity in angles_of(dialogue.draft):
        look_at_angle(quantity)
    dialogue.ask(law_question(dialogue.draft))
    _further(dialogue, look)


def _names(dialogue: Dialogue) -> None:
    """Ask for the names of the line, its second roller and the tension behind that."""
    before = dialogue.draft.second
    for question in line_questions():
        dialogue.ask(question)
    second = dialogue.draft.second
    if before not in ("", second):
        dialogue.keep(dialogue.draft.without(SECOND_TENSION))
    if second:
        _channel(dialogue, second_question(second))


def _further(dialogue: Dialogue, look: Callable[[Quantity], None]) -> None:
    """Find the channels that are only recorded; those that are no longer named are forgotten.

    ``look`` : finds one of them.
    """
    for number in range(1, MOST_FURTHER + 1):
        channel = _channel(dialogue, further_question(dialogue.draft, number))
        if channel == NONE:
            dialogue.keep(dialogue.draft.without_further(number + 1))
            return
        look(further(channel))


def _channel(dialogue: Dialogue, question: Question) -> str:
    """Return the name of a channel; what was found under its former name is forgotten."""
    before = dialogue.draft.answers.get(question.name, question.default) or NONE
    channel = dialogue.ask(question)
    if before not in (NONE, channel):
        dialogue.keep(dialogue.draft.without(before))
    return channel


def ask_drive(dialogue: Dialogue) -> None:
    """Ask for the drive; what is asked depends on earlier answers."""
    asked: set[str] = set()
    while left := [row for row in drive_questions(dialogue.draft) if row.name not in asked]:
        dialogue.ask(left[0])
        asked.add(left[0].name)
