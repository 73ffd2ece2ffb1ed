"""``aff-runtime top``: a live text screen of 80 x 24, by polling ``status``."""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections.abc import Sequence
from typing import Any

from aff_runtime.app.report.block_status import BlockStatus
from aff_runtime.app.report.status import headline
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.app.report.tick_row import CorrectionDue, TickRow
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.printable import printable
from aff_runtime.cli.service import connect, status_of
from aff_runtime.cli.status import block_lines
from aff_runtime.cli.terminal import redraw, say

WIDTH, HEIGHT = 80, 24
BAR = 14
PERIOD_NS = 500_000_000
SHOWN = ("_tension_N", "line_speed_m_s", "_radius_m", "_ref_N")  # ends of channels
NORMAL_STATES = ("ACTIVE", "ARMED", "READY", "SHADOW")


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("top", parents=[service], help="live screen; ctrl-c leaves it")
    parser.add_argument("--once", action="store_true", help="print one screen and end")
    parser.set_defaults(command=top)


def top(options: argparse.Namespace) -> int:
    """Draw the screen twice a second until interrupted."""
    clock = MonotonicClock()
    client = connect(options)
    coloured = sys.stdout.isatty()
    try:
        if options.once:
            for row in screen(status_of(client)):
                say(row)
            return 0
        while True:
            answer = status_of(client)
            alarming = answer.state not in NORMAL_STATES
            redraw(screen(answer), first_red=coloured and alarming)
            clock.sleep_until_ns(clock.now_ns() + PERIOD_NS)
    finally:
        client.close()


def screen(answer: StatusAnswer) -> list[str]:
    """Return the rows of one screen, none wider than 80 or more than 24."""
    tick = answer.live.tick if answer.live is not None else TickRow({})
    rows = textwrap.wrap(printable(f"{answer.line}  {headline(answer)}"), WIDTH, max_lines=2)
    rows += [_config_row(answer), _comm_row(answer)]
    rows.append("-" * WIDTH)
    rows += [
        f"{channel.name:40} {_shown(channel.value)}"
        for channel in tick.channels
        if channel.is_of(*SHOWN)
    ]
    rows += map(_correction_row, tick.corrections)
    rows += [f"next {text}" for text in answer.meeting_sentences]
    rows += block_lines(_fitting(answer.blocks, HEIGHT - 3 - len(rows)))
    rows = rows[: HEIGHT - 1]
    rows.append("other terminal: aff-runtime arm | bypass | stop          ctrl-c leaves")
    return [printable(row)[:WIDTH] for row in rows]


def _fitting(blocks: Sequence[BlockStatus], room: int) -> list[BlockStatus]:
    """Return the blocks that the screen has room for: the low orders of every roll first."""
    kept = sorted(range(len(blocks)), key=lambda at: (blocks[at].order, at))[:room]
    return [blocks[at] for at in sorted(kept)]


def _config_row(answer: StatusAnswer) -> str:
    """Return configuration and record."""
    differs = "  DIFFERS from the file" if answer.config_differs else ""
    folder = answer.recorder.folder.rsplit("/", 1)[-1] if answer.recorder is not None else ""
    return f"config {answer.config_hash[:12]}{differs}   record {folder}"


def _comm_row(answer: StatusAnswer) -> str:
    """Return wire and timing."""
    if answer.live is None:
        return "starting"
    timing = answer.live.tick.timing
    return (
        f"comm {answer.live.comm}  age {_shown(timing.plc_age_s, 1e3)} ms  "
        f"io {_shown(timing.io_us, 1e-3)} ms  tick {_shown(timing.tick_us, 1e-3)} ms  "
        f"missed {_shown(timing.missed_count)}"
    )


def _correction_row(due: CorrectionDue) -> str:
    """Return one actuator's row with the share of the law's wish that goes out."""
    bar = "#" * round(BAR * min(1.0, max(0.0, due.applied_ratio or 0.0)))
    return f"{due.name:40} {_shown(due.value):>12}  |{bar:.<{BAR}}| out"


def _shown(value: float | None, factor: float = 1.0) -> str:
    """Return a number in four digits, a dash when there is none."""
    return "-" if value is None else f"{value * factor + 0.0:.4g}"
