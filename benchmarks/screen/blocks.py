"""Blocks of ticks of every kind in turns: without a screen, and beside one in every condition."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Mapping
from contextlib import ExitStack
from functools import partial
from typing import TypeAlias

from aff_runtime.base.python_child import module_command
from benchmarks.screen.kept import Kept
from benchmarks.screen.rig import ROOT, Rig, clients, heard, pause
from benchmarks.screen.ticks import Block, Ratio, ratio_of, turns_needed

WITHOUT = "without"
KINDS = {
    WITHOUT: "no screen",
    "alone": "a screen, nobody looks",
    "clients": "a screen and 10 browsers at 10 Hz",
    "flood": "a screen under flood",
    "stopped": "a screen that hangs (SIGSTOP)",
    "killed": "a screen that is killed (SIGKILL)",
    "burning": "a screen, and a program that uses all its unit lets it have",
}
TARGETS = {kind: 1.10 if kind == "flood" else 1.05 for kind in KINDS if kind != WITHOUT}
P99 = 0.99
Turns: TypeAlias = dict[int, Block]  # by the number of the turn


def beside(
    rig: Rig, kept: Kept, block_s: float, settle_s: float, turns: int, most_turns: int
) -> dict[str, Turns]:
    """Return blocks of every kind, taken in turns.

    Parameters
    ----------
    turns : of all kinds. Then, by what these say of how many it takes, and looked at once, as many
        more of the kinds that are not decided by them; of one that takes more than ``most_turns``
        none.
    """
    blocks: dict[str, Turns] = {kind: {} for kind in KINDS}
    _take(rig, kept, block_s, settle_s, blocks, tuple(KINDS), range(turns))
    needed = {kind: turns_needed(ratio, turns, TARGETS[kind]) for kind, ratio in ratios(blocks)}
    wanted = {kind: n for kind, n in needed.items() if turns < n <= most_turns}
    if wanted:
        more = range(turns, max(wanted.values()))
        _take(rig, kept, block_s, settle_s, blocks, (WITHOUT, *wanted), more)
    return blocks


def ratios(blocks: Mapping[str, Turns], quantile: float = P99) -> list[tuple[str, Ratio]]:
    """Return every kind that was measured with its ratio to no screen."""
    found = {kind: pairs(blocks[kind], blocks[WITHOUT]) for kind in TARGETS}
    return [(kind, ratio_of(those, quantile)) for kind, those in found.items() if those]


def pairs(of: Turns, over: Turns) -> list[tuple[Block, Block]]:
    """Return the blocks of one turn of two kinds, of every turn that has both."""
    return [(of[turn], over[turn]) for turn in sorted(of.keys() & over.keys())]


def _take(
    rig: Rig,
    kept: Kept,
    block_s: float,
    settle_s: float,
    blocks: Mapping[str, Turns],
    kinds: tuple[str, ...],
    turns: range,
) -> None:
    for turn in turns:
        for kind in kinds if turn % 2 == 0 else kinds[::-1]:
            measure = partial(_block, rig, kind, block_s, settle_s)
            found = kept.block(f"{turn:02}-{kind}", measure)
            if found is not None:
                blocks[kind][turn] = found
            idle = f", {found.idle_words}" if found is not None and found.idle else ""
            print(f"turn {turn + 1} of {turns.stop}: {kind}{idle}", flush=True)


def _block(rig: Rig, kind: str, block_s: float, settle_s: float) -> Block:
    rig.arm(is_at_work=True)
    if kind == WITHOUT:
        pause(settle_s)
        return rig.block(block_s)
    with ExitStack() as stack:
        screen, url = stack.enter_context(rig.screen())
        load = {"clients": "look", "flood": "flood"}.get(kind)
        visitors = clients(load, url, block_s + 2.0 * settle_s) if load else None
        if kind == "burning":
            stack.callback(burning().kill)
        pause(settle_s)
        if kind == "stopped":
            screen.process.send_signal(signal.SIGSTOP)
            stack.callback(screen.process.send_signal, signal.SIGCONT)
        elif kind == "killed":
            screen.process.kill()
        found = rig.block(block_s, screen)
        if visitors is None:
            return found
        return heard(visitors, found, patience_s=block_s + 60.0)


def burning() -> subprocess.Popen[bytes]:
    """Start what uses all that a screen's unit lets it have: quota, niceness, processors."""
    command = ["nice", "-n", "10", *module_command("benchmarks.screen.burning")]
    tree = {**os.environ, "PYTHONPATH": str(ROOT)}  # benchmarks are not installed
    return subprocess.Popen(command, cwd=ROOT, env=tree)
