"""What comes of a signal while setup listens: numbers, and what a float can be instead."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import pytest

from aff_runtime.app.setup.asking.dialogue import Dialogue
from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.quantities import quantities
from aff_runtime.app.setup.asking.questions import Question
from aff_runtime.app.setup.bus.heard import HeardSignal, hear
from aff_runtime.app.setup.bus.steps import BusSteps
from aff_runtime.base.python_can import can
from aff_runtime.fieldbus import probe_frames
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.layout import Field, FrameLayout
from aff_runtime.fieldbus.can.named_signal import NamedSignal
from tests.aff_runtime.fieldbus.can.test_heard_frames import Tape
from tests.doubles.virtual_clock import VirtualClock

NAN, INF = math.nan, math.inf


def named(name: str, *, length: int, is_float: bool, factor: float = 1.0) -> NamedSignal:
    field = Field(name=name, frame="PLC", shift=0, length=length, is_float=is_float, factor=factor)
    layout = FrameLayout(name="PLC", can_id=0x181, extended=False, length=length // 8)
    return NamedSignal(name=f"PLC.{name}", field=field, layout=layout, called=name, owner="PLC")


TENSION = named("Tension", length=32, is_float=True)


def heard(
    signal: NamedSignal, frames: list[bytes], monkeypatch: pytest.MonkeyPatch
) -> HeardSignal:
    clock = VirtualClock()
    tape: can.BusABC = Tape([Frame(0x181, False, data) for data in frames], clock)
    monkeypatch.setattr(probe_frames, "open_bus", lambda *_: tape)
    draft = Draft(answers={"interface": "socketcan", "channel": "tape", "bitrate": "500000"})
    return hear(draft, (signal,), clock, len(frames) * 1e-3)[signal.name]


@pytest.mark.parametrize(
    ("values", "moves"),
    [
        ((1.5, NAN, 1.5), False),
        ((NAN, NAN), False),
        ((NAN, 1.5), False),
        ((1.5, INF), False),
        ((-INF, INF), False),
        ((1.5, NAN, 2.5), True),
        ((1.5, 2.5, INF), True),
    ],
)
def test_a_float_that_is_no_number_is_shown_and_moves_nothing(
    values: tuple[float, ...], moves: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = heard(TENSION, [struct.pack("<f", value) for value in values], monkeypatch)
    assert shown.value == values[-1] or (math.isnan(shown.value) and math.isnan(values[-1]))
    assert (shown.moves, shown.period_ms) == (moves, 0.0)


def test_a_counter_still_tells_its_period(monkeypatch: pytest.MonkeyPatch) -> None:
    beat = named("Beat", length=16, is_float=False)
    # one count each millisecond, over the end of 16 bits
    frames = [struct.pack("<H", (0xFFFE + n) & 0xFFFF) for n in range(5)]
    shown = heard(beat, frames, monkeypatch)
    assert (shown.moves, shown.period_ms) == (True, 1.0)


class Types:
    """Somebody who types 90 N where a display is asked for, and leaves the rest."""

    def __init__(self) -> None:
        self.asked: list[Question] = []

    def answers_itself(self, name: str) -> bool:
        return name == ""

    def answer(self, question: Question) -> str:
        self.asked.append(question)
        return "90 N" if question.name.endswith(".display") else "0.001"

    def refuse(self, question: Question, why: str) -> None:
        raise AssertionError(f"{question.name}: {why}")

    def say(self, line: str) -> None: ...

    def complain(self, line: str) -> None: ...


@pytest.mark.parametrize("values", [(NAN,), (INF,), (90_000.0, NAN), (90_000.0, 0.0)])
def test_a_display_beside_no_number_tells_no_scale_and_it_is_asked_for(
    values: tuple[float, ...], tmp_path: Path
) -> None:
    left = list(values)

    def ear(_signals: object) -> dict[str, HeardSignal]:
        return {TENSION.name: HeardSignal(value=left.pop(0), moves=True, period_ms=0.0)}

    typist = Types()
    answers = {"signal.unwind_tension_N": TENSION.name}
    dialogue = Dialogue(Draft(answers=answers), tmp_path / "draft", typist)
    (tension,) = [one for one in quantities("") if one.channel == "unwind_tension_N"]
    BusSteps(dialogue, (TENSION,), ear).quantity(tension)
    assert dialogue.draft.answers["unwind_tension_N.scale"] == "0.001"
    (scale,) = [one for one in typist.asked if one.name == "unwind_tension_N.scale"]
    assert scale.rows == ()
