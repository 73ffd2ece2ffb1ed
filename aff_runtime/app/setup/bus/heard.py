"""Values of a bus's signals as they come, beside what its files say; nothing is sent."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.base.ports import Clock
from aff_runtime.fieldbus.can.named_signal import NamedSignal

HEAR_S = 0.6  # a page that is sent every tenth scan of 50 ms comes too


@dataclass(frozen=True, slots=True, kw_only=True)
class HeardSignal:
    """What one signal showed.

    Attributes
    ----------
    value : the newest one, in the file's own unit; NaN and infinity as they come.
    moves : whether it changed between numbers.
    period_ms : time of one count, of a counter that went up; 0 where none is told, as for a float.
    """

    value: float
    moves: bool
    period_ms: float


def hear(
    draft: Draft, signals: Sequence[NamedSignal], clock: Clock, seconds: float = HEAR_S
) -> Mapping[str, HeardSignal]:
    """Return what came of some signals, by name; those that did not come are left out.

    Raises
    ------
    WireError
        The bus cannot be opened.
    """
    from aff_runtime.fieldbus.can.heard_values import HeardValues  # noqa: PLC0415 (extra)
    from aff_runtime.fieldbus.probe_frames import listener  # noqa: PLC0415 (extra)

    heard = HeardValues({one.layout.name: one.layout for one in signals}.values())
    by_frame: dict[str, list[NamedSignal]] = {}
    for one in signals:
        by_frame.setdefault(one.layout.name, []).append(one)
    courses: dict[str, list[tuple[int, float]]] = {one.name: [] for one in signals}
    answers = draft.answers
    link = listener(
        answers["interface"],
        answers["channel"],
        int(answers["bitrate"]),
        tuple(heard.layouts),
        clock,
    )
    end_ns = clock.now_ns() + round(seconds * 1e9)
    try:
        while (left_ns := end_ns - clock.now_ns()) > 0 and link.ready():
            frame = link.receive(left_ns)
            layout = heard.take(frame) if frame is not None and frame.can_id >= 0 else None
            for one in by_frame[layout.name] if layout is not None else ():
                if heard.word(one.field) is not None:
                    courses[one.name].append((clock.now_ns(), heard.value(one.field)))
    finally:
        link.close()
    return {one.name: _shown(one, courses[one.name]) for one in signals if courses[one.name]}


def _shown(signal: NamedSignal, course: Sequence[tuple[int, float]]) -> HeardSignal:
    values = [value for _, value in course]
    field = signal.field
    span_ms = (course[-1][0] - course[0][0]) * 1e-6
    counts = 0
    if not field.is_float:
        counts = round((values[-1] - values[0]) / field.factor) % (field.mask + 1)
    return HeardSignal(
        value=values[-1],
        moves=len({value for value in values if math.isfinite(value)}) > 1,
        period_ms=span_ms / counts if 0 < counts <= len(course) else 0.0,
    )
