"""What is asked of a bus whose files name every signal."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import get_args

from aff_runtime.app.setup.asking.draft import SCALE, Draft
from aff_runtime.app.setup.asking.plc import scale_of
from aff_runtime.app.setup.asking.questions import (
    NONE,
    AnswerError,
    Question,
    number,
    one_of,
    read_text,
    whole,
)
from aff_runtime.app.setup.bus.files import MOST_NODES, NODE, nodes_of, read_file, read_node
from aff_runtime.app.setup.words.display import Shown
from aff_runtime.app.setup.words.scale_steps import round_scales
from aff_runtime.base.printable import printable
from aff_runtime.base.suggest import meant
from aff_runtime.base.units import UnitError
from aff_runtime.config.models.gateway import CanInterface

EDS = "eds"
"""Answers ``eds.1``, ``.2``: EDS files as given, for nodes that name none."""
NEAR = 0.02  # of a value that moves, between a display and the bus
MOST_SCALES = 5


def bus_questions() -> tuple[Question, ...]:
    """Return what is asked of the bus itself."""
    interfaces = get_args(CanInterface)
    return (
        Question(
            name="interface",
            text=f"CAN interface of this machine: {', '.join(interfaces)}",
            read=one_of(*interfaces),
            default="socketcan",
        ),
        Question(
            name="channel",
            text="Its channel, such as can0, or the tty of an adapter",
            read=read_text,
            default="can0",
        ),
        Question(
            name="bitrate", text="Bit rate, bit/s", read=whole(10_000, 1_000_000), default="500000"
        ),
    )


def dbc_question(folder: Path) -> Question:
    """Return the question for the DBC file."""
    return Question(
        name="dbc", text="DBC file, beside the site file", read=partial(read_file, folder)
    )


def own_node_question() -> Question:
    """Return the question for our node id."""
    text = "Our own CANopen node id, which no device has"
    return Question(name="own_node", text=text, read=whole(1, 127), default="100")


def node_question(draft: Draft, folder: Path, place: int) -> Question:
    """Return the question for one more CANopen node; ``place`` from 1."""
    files = tuple(
        draft.answers[name]
        for name in (f"{EDS}.{one}" for one in range(1, MOST_NODES + 1))
        if name in draft.answers
    )
    before = draft.answers
    others = {
        one: kept
        for one, kept in nodes_of(draft).items()
        if before.get(f"{NODE}.{place}", "").split(" ")[0] != one
    }

    def read(text: str) -> str:
        kept = read_node(folder, files, text)
        if kept == NONE:
            if place == 1:
                raise AnswerError("at least one node is needed.")
            return NONE
        name, node_id = kept.split()[:2]
        if name in others or int(node_id) in {one for one, _ in others.values()}:
            raise AnswerError(f"{name} {node_id} is a node already. Give each its own.")
        return kept

    return Question(
        name=f"{NODE}.{place}",
        text="CANopen node: name, node id and EDS file, such as unwind_drive 3 drive.eds; none "
        "ends",
        read=read,
        default=NONE if place > 1 else None,
    )


def listen_question() -> Question:
    """Return the question whether to listen."""
    return Question(
        name="listen",
        text="Listen to the bus, to show the present value beside each signal's name? Nothing is "
        "sent. yes, no",
        read=one_of("yes", "no"),
        default="yes",
    )


def scan_question(measured_ms: float) -> Question:
    """Return the question for the PLC's scan; ``measured_ms``: of its heartbeat, 0: not heard."""
    default = f"{round(measured_ms, 1):g}" if measured_ms else "5"
    return Question(
        name="scan_ms", text="Scan time of the PLC, ms", read=_read_scan, default=default
    )


def _read_scan(text: str) -> str:
    shown = text.strip()
    if not re.fullmatch(r"[0-9]{1,3}(\.[0-9]{1,3})?", shown) or not 0 < float(shown) <= 100:
        raise AnswerError(f'"{printable(shown, 40)}": write a number of ms, above 0, up to 100.')
    return shown


def lost_question(node: str) -> Question:
    """Return what a drive shall do when our heartbeat is lost."""
    return Question(
        name=f"lost.{node}",
        text=f"Object 0x6007 of {node}: its reaction to our lost heartbeat, a number of the "
        "drive's manual; none: not set",
        read=_read_lost,
        default=NONE,
    )


def _read_lost(text: str) -> str:
    shown = text.strip()
    if shown == NONE:
        return NONE
    if not re.fullmatch(r"-?[0-9]{1,5}", shown) or not -32768 <= int(shown) <= 32767:
        raise AnswerError(
            f'"{printable(shown, 40)}": write a whole number, -32768 to 32767, or none.'
        )
    return str(int(shown))


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalReader:
    """Takes a row's number, a signal by its name, or ``none`` where ``choices`` has it.

    Attributes
    ----------
    rows : signals that are shown, by number. ``known`` : all that can be it.
    why_not : says of a signal why it cannot be; empty: it can.
    unsure : why an empty answer takes no row; empty where it does.
    """

    rows: Mapping[str, str]
    known: frozenset[str]
    why_not: Callable[[str], str]
    choices: tuple[str, ...] = ()
    unsure: str = ""

    def __call__(self, text: str) -> str:
        """Return the signal's name, or ``none``."""
        shown = text.strip()
        if not shown:
            raise AnswerError(f"no row is taken unasked: {self.unsure}. Write {self._takes}.")
        name = self.rows.get(shown, shown)
        if name in self.choices or name in self.known:
            return name
        if shown.isdecimal():
            raise AnswerError(f'"{shown[:40]}": write {self._takes}.')
        why = self.why_not(name) or f"is no signal of the files. {meant(name, sorted(self.known))}"
        raise AnswerError(f"{printable(name, 80)} {why}")

    @property
    def _takes(self) -> str:
        rows = [f"1 to {len(self.rows)}"] if self.rows else []
        return " or ".join([*rows, "MESSAGE.Signal", *self.choices])


def scale_question(
    channel: str, unit: str, signal: str, rows: Sequence[tuple[str, str]] = ()
) -> Question:
    """Return the question for a scale that no file says; ``rows``: proposals, best first."""
    example = "4096 counts/turn" if unit == "rad" else f"0.001, or 0.001 {unit}"
    what = "Counts of one turn" if unit == "rad" else f"{unit} in one count"
    return Question(
        name=f"{channel}.scale",
        text=f"{what} of {signal} ({channel}), from the manual, such as {example}",
        read=partial(_read_scale, unit, dict(rows)),
        default=rows[0][1] if rows else None,
        rows=tuple(rows),
    )


def _read_scale(unit: str, rows: Mapping[str, str], text: str) -> str:
    shown = " ".join(text.split())
    shown = rows.get(shown, shown)
    if not re.fullmatch(SCALE, shown):
        raise AnswerError(
            f'"{printable(shown, 40)}" is no scale. Write a number, or one with its unit.'
        )
    try:
        if not scale_of(shown, unit):
            raise AnswerError("0 would make every value 0. Write the SI units in one count.")
    except UnitError as error:
        raise AnswerError(str(error)) from None
    return shown


def count_question(name: str, signal: str) -> Question:
    """Return the question for one count of a correction that no file scales."""
    return Question(
        name=name,
        text=f"One count of {signal}, m/s at the web, as the drive's velocity unit is set; see "
        "its manual",
        read=number("m/s", 1e-9, 1.0),
        default="0.00001",
    )


def scales_from(shown: Shown, counts: float, unit: str) -> tuple[tuple[str, str], ...]:
    """Return scales by which a count shows what a display shows, the most usual first.

    Parameters
    ----------
    shown : what was typed off the display. ``counts`` : of the signal at that moment, not 0.
    """
    off = shown.half_digit + NEAR * abs(shown.value)
    low, high = ((abs(shown.value) + sign * off) / abs(counts) for sign in (-1.0, 1.0))
    if low <= 0.0:
        return ()
    sign = "-" if shown.value * counts < 0.0 else ""
    found = sorted(
        round_scales(low, high, unit, shown.unit),
        key=lambda one: (-one.log_prior, abs(one.si * abs(counts) - abs(shown.value))),
    )
    return tuple((str(n), sign + one.text) for n, one in enumerate(found[:MOST_SCALES], 1))
