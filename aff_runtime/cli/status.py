"""``aff-runtime status [--json]``: how the service stands, for people and for scripts."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from aff_runtime.app.report.block_status import BlockStatus
from aff_runtime.app.report.status import explain, headline
from aff_runtime.app.report.status_answer import SILENT, StatusAnswer, read_answer
from aff_runtime.app.report.watch_notes import STORE, notes_of
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import LATCHED_STATES
from aff_runtime.cli.service import connect
from aff_runtime.cli.terminal import say, say_json
from aff_runtime.telemetry.recorder_messages import RecorderReport

EXIT_ALARM = 5
SHOWN = ("_tension_N", "line_speed_m_s", "_radius_m")  # ends of the channels to show
LATCHED = tuple(state.name for state in LATCHED_STATES)
NO_ALARM = (BY_NAME["POWER_UP"].code, BY_NAME["BYPASSED"].code)


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("status", parents=[service], help="how the service stands")
    parser.add_argument("--json", action="store_true", help="everything, for scripts")
    parser.add_argument(
        "--watch",
        type=Path,
        default=STORE,
        metavar="STORE",
        help="of `aff-runtime watch`, to say what it found (default: %(default)s)",
    )
    parser.set_defaults(command=status)


def status(options: argparse.Namespace) -> int:
    """Print the status; 5 while an alarm stands."""
    client = connect(options)
    try:
        said = client.ask("status")
    finally:
        client.close()
    answer = read_answer(said)
    if options.json:
        say_json(said)
    else:
        for line in (*lines(answer), *watch_lines(options.watch, answer.line)):
            say(line)
    return EXIT_ALARM if is_alarm(answer) else 0


def is_alarm(answer: StatusAnswer) -> bool:
    """Return whether a real alarm stands: just started and bypassed are none, silence is one."""
    code = answer.live.alarm.code if answer.live is not None else 0
    return answer.state == SILENT or (answer.state in LATCHED and code not in NO_ALARM)


def _stands(answer: StatusAnswer) -> Iterator[str]:
    """Yield the state with all that stands against an armed output."""
    yield f"{answer.line}: {headline(answer)}"
    for text in answer.live.also_blocking if answer.live is not None else ():
        yield f"         and by {explain(text)}"


def lines(answer: StatusAnswer) -> Iterator[str]:
    """Yield the status as text."""
    yield from _stands(answer)
    whole, site = answer.config_hash, answer.site_hash
    yield f"config   {whole[:12]}, PLC word 0x{whole[-4:]}; site file alone {site[:12]}"
    for text in answer.learned:
        yield f"learned  {text}"
    for text in answer.config_differs:
        yield f"         differs: {text}"
    if answer.trying:
        yield f"trying   {answer.try_sentence}"
    if answer.live is not None:
        tick = answer.live.tick
        timing = tick.timing
        yield (
            f"comm     {answer.live.comm}, age {_short(timing.plc_age_s, 1e3)} ms, "
            f"tick {_short(timing.tick_us, 1e-3)} ms, "
            f"missed {_number(timing.missed_count)} ticks"
        )
        if "arithmetic" in answer.live.meta.versions:
            yield f"law      by {answer.live.meta.versions['arithmetic']}"
        for text in answer.live.wire:
            yield f"wire     {text}"
        for channel in tick.channels:
            if channel.is_of(*SHOWN):
                yield f"{channel.name:32} {_number(channel.value)}"
        for due in tick.corrections:
            yield f"{due.name:32} {_number(due.value)}"
    yield from block_lines(answer.blocks)
    yield from why_lines(answer.blocks)
    for text in answer.meeting_sentences:
        yield f"next     {text}"
    for text in answer.shapes:
        yield f"shape    {text}"
    recorder = answer.recorder
    if recorder is not None:
        yield f"record   {recorder.folder} ({_recorder_words(recorder)})"


def watch_lines(store: Path, line: str) -> Iterator[str]:
    """Yield what `aff-runtime watch` found last of this line; nothing where it found nothing."""
    found = notes_of(store, line)
    for text in found.notes if found is not None else ():
        yield f"watch    {text}"
    if found is not None and found.notes:
        when = f"{found.looked_utc[:16]} UTC"
        yield f"         looked at {when}; every trend: aff-runtime watch trend {store}"


def block_lines(blocks: Sequence[BlockStatus]) -> Iterator[str]:
    """Yield the blocks as one table per actuator, not wider than 80 characters."""
    actuator = None
    factor = 1.0
    for block in blocks:
        shape = block.law == "shape"
        ripple_unit = f"{block.ripple_unit} before>now"
        if block.actuator != actuator:
            actuator = block.actuator
            unit, factor = ("mm/s", 1e3) if block.unit == "m/s" else (block.unit, 1.0)
            yield (
                f"{str(actuator)[:20]:20} {'Hz':>5} {'mm':>6} {'deg':>4} {'out':>4} "
                f"{ripple_unit:>14} {'dB':>4}  state"
                if shape
                else f"{str(actuator)[:26]:26} {'Hz':>5} {unit + '|limit':>11} {'deg':>4} "
                f"{ripple_unit:>14}  state"
            )
        ripple = f"{_short(block.ripple_before)}>{_short(block.ripple)}"
        phase = "-" if block.phase_deg is None else f"{block.phase_deg:.0f}"
        if shape:
            yield _shape_line(block, ripple, phase)
            continue
        amplitude = f"{_short(block.amplitude, factor)}|{_short(block.limit, factor)}"
        yield (
            f"  {block.name[-24:]:24} {_short(block.frequency_Hz):>5} {amplitude:>11} "
            f"{phase:>4} {ripple:>14}  {block.state}"
        )


def _shape_line(block: BlockStatus, ripple: str, phase: str) -> str:
    """Return one order of a roll's shape: mm, angle, share that goes out, benefit."""
    share = "-" if block.out is None else f"{100 * block.out:.0f}%"
    benefit = "-" if block.benefit_dB is None else f"{block.benefit_dB:.0f}"
    size = _short(block.amplitude) + ("Nm" if block.unit == "N m" else "")
    return (
        f"  {block.name[-18:]:18} {_short(block.frequency_Hz):>5} {size:>6} {phase:>4} "
        f"{share:>4} {ripple:>14} {benefit:>4}  {block.state}"
    )


def why_lines(blocks: Sequence[BlockStatus]) -> Iterator[str]:
    """Yield why blocks are held or faded, those of one reason together."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for block in blocks:
        if block.why:
            reasons.setdefault((block.actuator, block.why), []).append(block.name)
    for (actuator, why), names in reasons.items():
        yield f"why      {actuator} {' '.join(names)}: {why}"


def _short(value: float | None, factor: float = 1.0) -> str:
    """Return a number in three digits, a dash when there is none."""
    return "-" if value is None else f"{value * factor + 0.0:.3g}"


def _recorder_words(recorder: RecorderReport) -> str:
    """Return how recording goes."""
    if not recorder.alive:
        return "RECORDER IS GONE"
    words = f"{recorder.rows} rows"
    return f"{words}, {recorder.lost} LOST {recorder.error}".rstrip() if recorder.lost else words


def _number(value: float | None, factor: float = 1.0) -> str:
    """Return a number in six digits, a dash when there is none."""
    return "-" if value is None else f"{value * factor + 0.0:.6g}"
