"""Where in a record the correction was off and on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np

from aff_runtime.app.report.comparison.window import Window, any_correction
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.signals import State

SHORTEST_S = 5.0  # of a stretch; shorter ones are left out
_T = TypeVar("_T")
_OFF, _ON, _FADE = 0, 1, 2  # a correction that goes out in another state than ACTIVE fades


@dataclass(frozen=True, slots=True, kw_only=True)
class Phase:
    """A stretch of a record in which the correction was on, or off; times of ``time_s``, s."""

    on: bool
    from_s: float
    to_s: float

    def later(self, seconds: float) -> Phase:
        """Return the stretch without its first seconds."""
        return Phase(on=self.on, from_s=self.from_s + seconds, to_s=self.to_s)

    def of(self, window: Window) -> RunWindow:
        """Return it as a window of the same run."""
        folder = window.table.window.folder
        return RunWindow(folder=folder, from_s=self.from_s, to_s=self.to_s)


def phases(window: Window) -> list[Phase]:
    """Return the stretches of a window, those of fades and of less than 5 s left out."""
    columns = window.table.columns
    time_s = columns["time_s"]
    sent = any_correction(columns)
    on = sent & (columns["state"] == State.ACTIVE)
    code = np.where(on, _ON, np.where(sent, _FADE, _OFF))
    edges = np.flatnonzero(np.diff(code)) + 1
    starts, ends = np.concatenate([[0], edges]), np.concatenate([edges, [code.size]])
    stretches: list[Phase] = []
    for start, end in zip(starts, ends, strict=True):
        last = min(int(end), time_s.size - 1)
        phase = Phase(
            on=bool(code[start] == _ON), from_s=float(time_s[start]), to_s=float(time_s[last])
        )
        if code[start] == _FADE or phase.to_s - phase.from_s < SHORTEST_S:
            continue
        if stretches and stretches[-1].on == phase.on:
            phase = Phase(on=phase.on, from_s=stretches[-1].from_s, to_s=phase.to_s)
            stretches.pop()
        stretches.append(phase)
    return stretches


def offs_and_ons(found: Sequence[Phase], settle_s: float) -> list[tuple[Phase, Phase]]:
    """Return every off with the on behind it, the settling taken from that.

    An on that ends before it has settled goes with its off: what comes next is a pair of its own.
    """
    return [
        (off, on.later(settle_s))
        for off, on in pairwise(found)
        if on.on and on.to_s - on.from_s > settle_s
    ]


def last_two(
    newest_first: Iterable[_T], is_whole: Callable[[_T], bool]
) -> tuple[list[_T], list[_T]]:
    """Return the last two that are whole, and those behind the first of them that are not.

    Oldest first. Without two whole ones the last two, whatever they are, and none left out.
    """
    found: list[_T] = []
    for one in newest_first:
        found.insert(0, one)
        whole = [each for each in found if is_whole(each)]
        if len(whole) == 2:
            return whole, [each for each in found if each not in whole]
    return found[-2:], []
