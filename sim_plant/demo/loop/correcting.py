"""What an engineer does with a proposed block: try, probe where it rests, judge, keep or undo."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from sim_plant.demo.loop.judging import BlockOrder, Judgement
from sim_plant.demo.runtime_status import RuntimeStatus

TRY_S, SETTLE_S = 120.0, 22.0
ATTEMPTS = 3
OF_A_PAUSE = "the correction was taken back"
"""Why a try ends where the machine paused, in the words of the service's history."""


class Line(Protocol):
    """The running line, as who stands at its console has it."""

    def settings(self, *words: str) -> str:
        """Give ``aff-runtime settings`` and return what it says."""

    def status(self) -> RuntimeStatus:
        """Return how the service stands."""

    def watch(self, seconds: float) -> None:
        """Let time pass; arm again where the machine's pauses took the correction back."""

    def probe_again(self) -> None:
        """Take the correction back, probe with the site file in force, and arm."""

    def record(self) -> str:
        """Let a window pass and return it, as ``compare`` takes it."""

    def judge(self, window: str, orders: tuple[BlockOrder, ...]) -> Judgement:
        """Compare a window with the one before the block."""

    def say(self, text: str) -> None:
        """Tell who is watching."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """What became of a proposed block.

    Attributes
    ----------
    kept : it is in the site file. ``why`` : in words. ``probed_again`` : it rested until then.
    judgement : what the service's own records showed; None where it came to none.
    """

    kept: bool
    why: str
    probed_again: bool = False
    judgement: Judgement | None = None


def correct(
    line: Line, site: Path, proposed: Path, orders: tuple[BlockOrder, ...], cause: str
) -> Decision:
    """Try a proposed site file on the running line and decide by the ripple that was recorded.

    An order that rests since its response is not sure sends nothing, and a try does not outlive
    the probe that it needs. Its block is kept for that probe, which then knows the new roll, and
    is undone after it unless ripple fell.
    """
    returned = ""
    for _ in range(ATTEMPTS):
        seconds = ("--seconds", f"{TRY_S:.0f}")
        line.say(_last(line.settings("try", str(proposed), *seconds, "--why", cause)))
        line.watch(SETTLE_S)
        status = line.status()
        if status.trying and (unsure := _unsure(status, orders)):
            return _probe_and_judge(line, site, orders, cause, unsure)
        window = line.record() if status.trying else ""
        if window and line.status().trying:
            judgement = line.judge(window, orders)
            return _decide(line, site, judgement, kept=False, cause=cause)
        returned = _last(line.settings("history"))
        line.say(f"the try ended by itself: {returned}")
        if OF_A_PAUSE not in returned:
            break
    return Decision(kept=False, why=f"the try ended by itself: {returned}")


def _unsure(status: RuntimeStatus, orders: tuple[BlockOrder, ...]) -> list[str]:
    """Return the lowest order of every new block in which that one rests."""
    lowest: dict[tuple[str, str], int] = {}
    for one in orders:
        key = (one.actuator, one.roll)
        lowest[key] = min(one.order, lowest.get(key, one.order))
    names = [f"{actuator}.{roll}_{order}x" for (actuator, roll), order in lowest.items()]
    return [name for name in names if name in status.unsure]


def _probe_and_judge(
    line: Line, site: Path, orders: tuple[BlockOrder, ...], cause: str, unsure: list[str]
) -> Decision:
    rests = f"{', '.join(unsure)} rests: the response is not sure there"
    line.say(f"{rests}; keeping it for a probe that knows its roll")
    line.say(line.settings("keep", str(site), "--why", f"{cause}; {rests}, to be probed"))
    line.probe_again()
    line.watch(SETTLE_S)
    judgement = line.judge(line.record(), orders)
    return _decide(line, site, judgement, kept=True, cause=cause)


def _decide(line: Line, site: Path, judgement: Judgement, *, kept: bool, cause: str) -> Decision:
    """Keep where ripple fell, else undo; ``kept`` : it is kept already, after another probe."""
    if judgement.fell and not kept:
        line.say(line.settings("keep", str(site), "--why", f"{cause}; {judgement}"))
    if not judgement.fell:
        why = f"no fall of the ripple: {judgement}"
        line.say(line.settings("undo", str(site), "--why", why))
    return Decision(
        kept=judgement.fell,
        why=str(judgement) if judgement.fell else f"no fall of the ripple: {judgement}",
        probed_again=kept,
        judgement=judgement,
    )


def _last(said: str) -> str:
    return said.strip().rpartition("\n")[2]
