"""Measure the screen beside a running line; ``make bench-screen`` writes docs/results/screen.md.

Blocks without and with a screen take turns, so that what the machine does besides meets all kinds
alike: ratios of one run can be compared, milliseconds are this machine's.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
from contextlib import ExitStack
from pathlib import Path

from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import AffError
from benchmarks.runtime.facts import Row, Section, machine
from benchmarks.runtime.page import markdown, text
from benchmarks.screen import pages
from benchmarks.screen.presses import arming, presses, scrapes
from benchmarks.screen.rig import ROOT, SETTLE_S, Rig, clients, pause
from benchmarks.screen.ticks import Block, quantiles_us, ratio_of

PAGE = ROOT / "docs" / "results" / "screen.md"
KINDS = {
    "without": "no screen",
    "alone": "a screen, nobody looks",
    "clients": "a screen and 10 browsers at 10 Hz",
    "flood": "a screen under flood",
    "stopped": "a screen that hangs (SIGSTOP)",
}
TARGETS = {"alone": 1.05, "clients": 1.05, "flood": 1.10, "stopped": 1.05}


def main() -> None:
    """Take about 25 minutes with the defaults; ``--quick`` is a look of a few minutes."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.screen")
    parser.add_argument("--page", type=Path, help=f"page to write (default {PAGE})")
    parser.add_argument("--out", type=Path, default=Path("out/bench-screen"))
    parser.add_argument("--block", type=float, default=30.0, metavar="S", help="a block, s")
    parser.add_argument("--rounds", type=int, default=6, help="blocks of every kind")
    parser.add_argument("--quick", action="store_true", help="short, and a page only where named")
    given = parser.parse_args()
    block_s, rounds, count = (3.0, 2, 2) if given.quick else (given.block, given.rounds, 20)
    settle_s = 1.0 if given.quick else SETTLE_S
    sections = [machine()]
    with ExitStack() as stack:
        rig = Rig(given.out, stack)
        blocks, rates = beside(rig, block_s, rounds, settle_s)
        sections += [of_ticks(blocks, block_s, rounds), of_screen(blocks, rates)]
        sections += [*seen(rig, count)]
    print(text(sections))
    path = given.page or (None if given.quick else PAGE)
    if path is not None:
        command = "python -m benchmarks.screen --quick" if given.quick else "make bench-screen"
        page = markdown(sections, date=wall_time_iso(), title="The screen", command=command)
        path.write_text(page, encoding="utf-8")
        print(f"written: {path}")


def beside(
    rig: Rig, block_s: float, rounds: int, settle_s: float
) -> tuple[dict[str, list[Block]], list[dict[str, float]]]:
    """Return blocks of every kind, taken in turns, and what the browsers saw."""
    blocks: dict[str, list[Block]] = {kind: [] for kind in KINDS}
    rates: list[dict[str, float]] = []
    for turn in range(rounds):
        kinds = list(KINDS) if turn % 2 == 0 else list(KINDS)[::-1]
        for kind in kinds:
            blocks[kind].append(_block(rig, kind, block_s, settle_s, rates))
            print(f"round {turn + 1} of {rounds}: {kind}", flush=True)
    return blocks, rates


def _block(
    rig: Rig, kind: str, block_s: float, settle_s: float, rates: list[dict[str, float]]
) -> Block:
    if kind == "without":
        pause(settle_s)
        return rig.block(block_s)
    with rig.screen() as (screen, url):
        load = {"clients": "look", "flood": "flood"}.get(kind)
        visitors = clients(load, url, block_s + 2.0 * settle_s) if load else None
        pause(settle_s)
        if kind == "stopped":
            screen.process.send_signal(signal.SIGSTOP)
        found = rig.block(block_s, screen)
        screen.process.send_signal(signal.SIGCONT)
        if visitors is not None:
            told, _ = visitors.communicate()
            if kind == "clients":
                rates.append(json.loads(told))
    return found


def of_ticks(blocks: dict[str, list[Block]], block_s: float, rounds: int) -> Section:
    """Return P1 to P3: the end of a tick, beside a screen over without one."""
    rows = []
    for kind, named in KINDS.items():
        p50, p99, p999 = quantiles_us(blocks[kind])
        ticks = sum(len(block.end_us) for block in blocks[kind])
        missed = sum(block.missed for block in blocks[kind])
        value = f"p50 {p50:.0f} us, p99 {p99:.0f} us, p99.9 {p999:.0f} us"
        rows.append(Row(name=named, value=value, remark=f"{ticks} ticks, {missed} missed"))
    for kind, target in TARGETS.items():
        ratio = ratio_of(blocks[kind], blocks["without"], 0.99)
        remark = f"target {target:.2f}, the interval below"
        rows.append(Row(name=f"{KINDS[kind]}: p99 over without", value=str(ratio), remark=remark))
    note = (
        f"From when a tick is due to its end. {rounds} blocks of {block_s:g} s of every kind in "
        "turns, ratios with the 95 % interval of a bootstrap over blocks."
    )
    return Section(title="Ticks of the line (P1, P2, P3)", note=note, rows=tuple(rows))


def of_screen(blocks: dict[str, list[Block]], rates: list[dict[str, float]]) -> Section:
    """Return P4, P8, P10, P11: what screen and supervisor use."""
    rows = []
    for kind in ("alone", "clients", "flood"):
        core = 100.0 * max(block.screen_core for block in blocks[kind])
        memory_MB = max(block.screen_MB for block in blocks[kind])
        value = f"{core:.1f} % of a core, {memory_MB:.0f} MB"
        rows.append(Row(name=f"P8, P10 {KINDS[kind]}", value=value, remark="most of all blocks"))
    for kind in ("without", "clients"):
        core = 100.0 * max(block.supervisor_core for block in blocks[kind])
        name = f"P11 supervisor, {KINDS[kind]}"
        rows.append(Row(name=name, value=f"{core:.1f} % of a core", remark="it is asked nothing"))
    if rates:
        each = [one["frames"] / one["clients"] / one["seconds"] for one in rates]
        size = sum(one["bytes"] for one in rates) / max(1.0, sum(one["frames"] for one in rates))
        value = f"{min(each):.1f} to {max(each):.1f} per s, {size:.0f} bytes"
        rows.append(Row(name="P4 frames to each of 10", value=value, remark="target 10 ± 10 %"))
    note = "Targets: 1 % with nobody, 8 % and 150 MB with 10 browsers."
    return Section(title="What it uses (P4, P8, P10, P11)", note=note, rows=tuple(rows))


def seen(rig: Rig, count: int) -> list[Section]:
    """Return P4 to P7, P9 and P12: pages in a Chromium, presses, scrapes."""
    with rig.screen() as (screen, url):
        rows = scrapes(url, screen)
        try:
            rearm = arming(rig)
            rows += presses(rig, url, rearm, 2 * count)
        except (AffError, subprocess.TimeoutExpired) as error:
            rearm = lambda: False  # noqa: E731
            rows.append(Row(name="P6 press to guard", value="skipped", remark=str(error)[:120]))
        found = [Section(title="Presses and scrapes (P6, P12)", note="", rows=tuple(rows))]
        why = pages.reason_not()
        if why:
            row = Row(name="Chromium", value="skipped", remark=why)
            return [*found, Section(title="In a browser", note="", rows=(row,))]
        with pages.browser() as chromium:
            rows = pages.loads(chromium, url, count)
            rows += pages.ages(chromium, url, 3.0 * count)
            rows += pages.keys(chromium, url, rearm, count)
            rows += pages.breaks(chromium, url, rig, screen, count)
        note = f"Chromium, 1280 by 800, nothing cached, {count} times each."
        title = "In a browser (P4 to P7, P9)"
        return [*found, Section(title=title, note=note, rows=tuple(rows))]


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    main()
