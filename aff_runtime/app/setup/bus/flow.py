"""The order of `setup` on a bus: its files, which signal is what, and what is asked beside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from aff_runtime.app.setup.asking.dialogue import Dialogue
from aff_runtime.app.setup.asking.draft import SENT, SIGNAL
from aff_runtime.app.setup.asking.interview import roll_names
from aff_runtime.app.setup.asking.on_every_wire import ask_drive, ask_line
from aff_runtime.app.setup.asking.quantities import UNWIND
from aff_runtime.app.setup.asking.questions import NONE
from aff_runtime.app.setup.bus.files import MOST_NODES, signals_of
from aff_runtime.app.setup.bus.heard import HeardSignal, hear
from aff_runtime.app.setup.bus.questions import (
    bus_questions,
    count_question,
    dbc_question,
    listen_question,
    lost_question,
    node_question,
    own_node_question,
)
from aff_runtime.app.setup.bus.roles import (
    applied_role,
    complement_role,
    correction_role,
    words_read,
    words_written,
)
from aff_runtime.app.setup.bus.steps import BusSteps, Hear
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError, WireError
from aff_runtime.fieldbus.can.named_signal import NamedSignal


def bus_interview(dialogue: Dialogue) -> None:
    """Ask until everything is known; a bus is only listened to.

    Raises
    ------
    LeftError
        The technician leaves.
    AffError
        It cannot go on; what was answered is kept.
    """
    for question in bus_questions():
        dialogue.ask(question)
    _files(dialogue)
    folder = dialogue.path.absolute().parent
    signals = signals_of(dialogue.draft, folder)
    dialogue.say(f"  the files name {len(signals)} signals")
    steps = BusSteps(dialogue, signals, _ear(dialogue, signals))
    _look(dialogue, steps)


def _files(dialogue: Dialogue) -> None:
    """Ask for the files that name the signals."""
    folder = dialogue.path.absolute().parent
    if dialogue.draft.answers["wire"] == "can_dbc":
        dialogue.ask(dbc_question(folder))
        return
    dialogue.ask(own_node_question())
    for one in range(1, MOST_NODES + 1):
        if dialogue.ask(node_question(dialogue.draft, folder, one)) == NONE:
            return


def _ear(dialogue: Dialogue, signals: tuple[NamedSignal, ...]) -> Hear | None:
    """Return how values are heard; None where nobody listens, or nothing comes."""
    if dialogue.ask(listen_question()) == "no":
        return None
    draft, clock = dialogue.draft, MonotonicClock()

    def ear(wanted: Sequence[NamedSignal]) -> Mapping[str, HeardSignal]:
        return hear(draft, wanted, clock)

    try:
        came = ear(signals)
    except WireError as error:
        dialogue.complain(f"  {error}")
        dialogue.complain("  going on without values: the names of the files alone decide")
        return None
    if not came:
        dialogue.complain(
            "  no frame of the files came. CANopen nodes send after `aff-runtime run` has started "
            "them; CAN by DBC: check bit rate, wiring and identifiers"
        )
        return None
    dialogue.say(f"  {len(came)} of them come")
    return ear


def _look(dialogue: Dialogue, steps: BusSteps) -> None:
    heartbeat, *words = words_read()
    steps.heartbeat(heartbeat)
    for role in words:
        steps.signal(role)
    dialogue.keep(dialogue.draft.with_answer("status.order", "yes"))  # no other one on CAN
    ask_line(dialogue, steps.quantity, steps.quantity)
    _corrections(dialogue, steps)
    for role in words_written():
        steps.signal(role)
    if dialogue.draft.answers["law"] == "shape":
        ask_drive(dialogue)


def _corrections(dialogue: Dialogue, steps: BusSteps) -> None:
    """Find the corrections, their copies, and what is shown of them."""
    has_echo = dialogue.draft.answers.get(f"{SIGNAL}aff_echo", NONE) != NONE
    for roll in roll_names(dialogue.draft):
        signal = steps.signal(correction_role(roll))
        if signal is None:  # the role is not optional
            raise ConfigError(f"correction.{roll}: no signal")
        name = f"correction_scale.{roll}"
        steps.correction_scale(name, signal, count_question(name, signal.name))
        if roll == UNWIND:
            scale = dialogue.draft.answers[name]
            dialogue.keep(dialogue.draft.with_answer("correction_scale", scale))
        steps.signal(complement_role(roll, signal.field.length))
        shown = steps.signal(applied_role(roll)) if has_echo else None
        if shown is not None:
            name = f"applied.{roll}.scale"
            steps.correction_scale(name, shown, count_question(name, shown.name))
    if dialogue.draft.answers["wire"] == "canopen_402":
        _reactions(dialogue)


def _reactions(dialogue: Dialogue) -> None:
    """Ask what each drive that takes a correction does when our heartbeat is lost."""
    answers = dialogue.draft.answers
    drives = {
        answers[f"{SENT}correction.{roll}"].partition(".")[0]
        for roll in roll_names(dialogue.draft)
    }
    for drive in sorted(drives):
        dialogue.ask(lost_question(drive))
