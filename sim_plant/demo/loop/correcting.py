"""What an engineer does with a proposed block: try, probe where it rests, judge, keep or undo."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from aff_runtime.base.errors import PlantError
from sim_plant.demo.loop.judging import BlockOrder, Judgement
from sim_plant.demo.runtime_status import RuntimeStatus

TRY_S, SETTLE_S = 120.0, 22.0
ATTEMPTS = 3
OF_A_PAUSE = "the correction was taken back"
"""Why a try ends where the machine paused, in the words of the service's history."""
NOT_TRIED = "no settings are being tried"
"""What the service says where a try has ended before it was kept."""


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
    is undone after it unless ripple fell. A try that ends by itself, be it between the last look
    and the word that keeps it, has left the former settings: it is begun again where the machine
    paused.
    """
    returned = ""
    for _ in range(ATTEMPTS):
        seconds = ("--seconds", f"{TRY_S:.0f}")
        line.say(_last(line.settings("try", str(proposed), *seconds, "--why", cause)))
        if (decision := _decided(line, site, orders, cause)) is not None:
            return decision
        returned = _last(line.settings("history"))
        line.say(f"the try ended by itself: {returned}")
        if OF_A_PAUSE not in returned:
            break
    return Decision(kept=False, why=f"the try ended by itself: {returned}")


def _decided(
    line: Line, site: Path, orders: tuple[BlockOrder, ...], cause: str
) -> Decision | None:
    """Decide on what is tried; None where the try ended by itself before that."""
    line.watch(SETTLE_S)
    status = line.status()
    if status.trying and (unsure := _unsure(status, orders)):
        return _probe_and_judge(line, site, orders, cause, unsure)
    window = line.record() if status.trying else ""
    if not window or not line.status().trying:
        return None
    judgement = line.judge(window, orders)
    if judgement.fell and not _keep(line, site, f"{cause}; {judgement}"):
        return None
    return _decision(line, site, judgement, probed_again=False)


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
) -> Decision | None:
    rests = f"{', '.join(unsure)} rests: the response is not sure there"
    line.say(f"{rests}; keeping it for a probe that knows its roll")
    if not _keep(line, site, f"{cause}; {rests}, to be probed"):
        return None
    line.probe_again()
    line.watch(SETTLE_S)
    return _decision(line, site, line.judge(line.record(), orders), probed_again=True)


def _keep(line: Line, site: Path, why: str) -> bool:
    """Keep what is tried; False where the try ended by itself before the service heard it."""
    try:
        line.say(line.settings("keep", str(site), "--why", why))
    except PlantError as error:
        if NOT_TRIED not in str(error):  # what is saved and does not run yet is no end of a try
            raise
        return False
    return True


def _decision(line: Line, site: Path, judgement: Judgement, *, probed_again: bool) -> Decision:
    """Undo what did not let ripple fall; a try that ended by itself is undone already."""
    why = str(judgement) if judgement.fell else f"no fall of the ripple: {judgement}"
    if not judgement.fell and (probed_again or line.status().trying):
        line.say(line.settings("undo", str(site), "--why", why))
    elif not judgement.fell:
        why += "; the try ended by itself"
    return Decision(kept=judgement.fell, why=why, probed_again=probed_again, judgement=judgement)


def _last(said: str) -> str:
    return said.strip().rpartition("\n")[2]
