"""Measure the screen beside a running line; ``make bench-screen`` writes docs/results/screen.md.

Blocks without and with a screen take turns, so that what the machine does besides meets all kinds
alike: ratios of one run can be compared, milliseconds are this machine's. The line is armed. What
was measured is kept part by part: a run that was stopped goes on where it was.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from statistics import median

from aff_runtime.base.clock import wall_time_iso
from benchmarks.runtime.facts import FactRow, Section, machine
from benchmarks.runtime.page import markdown, text
from benchmarks.screen import pages
from benchmarks.screen.blocks import KINDS, P99, TARGETS, WITHOUT, Turns, beside, ratios
from benchmarks.screen.churn import churn
from benchmarks.screen.kept import Kept
from benchmarks.screen.presses import presses, scrapes
from benchmarks.screen.rig import ROOT, SETTLE_S, Rig, clients, pause
from benchmarks.screen.targets import of_targets, target
from benchmarks.screen.ticks import NEVER, Ratio, quantiles_us, turns_needed

PAGE = ROOT / "docs" / "results" / "screen.md"


def main() -> int:
    """Take 40 to 55 minutes with the defaults; ``--quick`` is a look of a few minutes."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.screen")
    parser.add_argument("--page", type=Path, help=f"page to write (default {PAGE})")
    parser.add_argument("--out", type=Path, default=Path("out/bench-screen"))
    parser.add_argument("--block", type=float, default=12.0, metavar="S", help="a block, s")
    parser.add_argument("--turns", type=int, default=8, help="blocks of every kind")
    parser.add_argument(
        "--most-turns", type=int, default=20, help="blocks of a kind that fewer do not decide"
    )
    parser.add_argument("--churn", type=float, default=120.0, metavar="S", help="tabs open and go")
    parser.add_argument("--quick", action="store_true", help="short, and a page only where named")
    parser.add_argument(
        "--no-browser", action="store_true", help="leave out what needs a Chromium"
    )
    given = parser.parse_args()
    block_s, turns, count = (3.0, 2, 2) if given.quick else (given.block, given.turns, 20)
    most_turns = turns if given.quick else given.most_turns
    settle_s, churn_s = (1.0, 6.0) if given.quick else (SETTLE_S, given.churn)
    given.out.mkdir(parents=True, exist_ok=True)
    plan = {"block_s": block_s, "turns": turns, "most_turns": most_turns, "count": count}
    plan |= {"churn_s": churn_s, **_sources()}
    kept = Kept(given.out / "kept", plan)
    # before the rig, which leaves us fewer processors
    about = kept.rows("machine", lambda: list(machine().rows))
    with ExitStack() as stack:
        rig = Rig(given.out / "line", stack)
        about += kept.rows("rights", lambda: [rights(rig), plc(rig)])
        blocks = beside(rig, kept, block_s, settle_s, turns, most_turns)
        sections = [Section(title="Machine", note="", rows=tuple(about))]
        sections += [of_ticks(blocks, block_s), of_screen(blocks)]
        skipped = "left out: --no-browser" if given.no_browser else pages.reason_not()
        sections += seen(rig, kept, count, churn_s, skipped)
    sections.append(of_targets(sections))
    print(text(sections))
    path = given.page or (None if given.quick else PAGE)
    if path is not None:
        extra = " ".join(sys.argv[1:])
        command = f"make bench-screen EXTRA={extra!r}" if extra else "make bench-screen"
        page = markdown(sections, date=wall_time_iso(), title="The screen", command=command)
        path.write_text(page, encoding="utf-8")
        print(f"written: {path}")
    if kept.failed:
        print(f"not measured: {', '.join(kept.failed)}; say the same again, the rest is kept")
        return 1
    kept.drop()
    return 0


def _sources() -> dict[str, object]:
    """Return what tells two states of the product apart; nothing where git cannot be asked."""
    command = ["git", "rev-parse", "HEAD:aff_hmi", "HEAD:aff_runtime", "HEAD:benchmarks/screen"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return {"sources": done.stdout.split()}


def rights(rig: Rig) -> FactRow:
    """Return the rights without which a tick waits for other programs."""
    return FactRow(name="real-time rights refused", value=rig.ring.rights())


def plc(rig: Rig) -> FactRow:
    """Return whether the simulated PLC waits for the screen, as no real one does."""
    value = "goes first" if rig.plc_goes_first else "waits its turn: no right to SCHED_RR"
    remark = "on the processor that it shares here with screen and browsers"
    return FactRow(name="simulated PLC", value=value, remark=remark)


def of_ticks(blocks: Mapping[str, Turns], block_s: float) -> Section:
    """Return P1 to P3: the end of a tick, beside a screen over without one."""
    rows = []
    for kind, named in KINDS.items():
        found = list(blocks[kind].values())
        if not found:
            rows.append(FactRow(name=named, value="not measured"))
            continue
        p50, p99, p999 = quantiles_us(found)
        ticks = sum(len(block.end_us) for block in found)
        missed = sum(block.missed for block in found)
        idle = [block.idle_words for block in found if block.idle]
        value = f"p50 {p50:.0f} us, p99 {p99:.0f} us, p99.9 {p999:.0f} us"
        remark = f"{ticks} ticks, {missed} missed, {'; '.join(idle) or '0 not ACTIVE'}"
        rows.append(FactRow(name=named, value=value, remark=remark))
    for kind, ratio in ratios(blocks):
        rows.append(_of_ratio(kind, ratio, P99, TARGETS[kind], blocks))
    for kind, ratio in ratios(blocks, 0.999):
        if kind == "clients":
            rows.append(_of_ratio(kind, ratio, 0.999, 1.10, blocks))
    counts = sorted({len(one) for one in blocks.values()})
    note = (
        f"From when a tick is due to its end, the correction going out. "
        f"{' or '.join(map(str, counts))} blocks of {block_s:g} s of every kind in turns (more of "
        "the kinds that fewer do not decide), ratios with the 95 % interval of a bootstrap over "
        "turns."
    )
    return Section(title="Ticks of the line (P1, P2, P3)", note=note, rows=tuple(rows))


def _of_ratio(
    kind: str, ratio: Ratio, quantile: float, bound: float, blocks: Mapping[str, Turns]
) -> FactRow:
    """Return a ratio against its target; how many turns would decide what these do not."""
    turns = len(blocks[kind].keys() & blocks[WITHOUT].keys())
    needed = turns_needed(ratio, turns, bound)
    remark = target(f"{bound:.2f}, the interval below", (ratio.high, bound))
    if needed > turns:
        count = f"{NEVER} and more" if needed >= NEVER else f"some {needed}"
        remark += f"; {turns} turns do not decide it, {count} would"
    name = f"{KINDS[kind]}: p{100 * quantile:g} over without"
    return FactRow(name=name, value=str(ratio), remark=remark)


def of_screen(blocks: Mapping[str, Turns]) -> Section:
    """Return P4, P8, P10, P11: what screen and supervisor use."""
    of = {kind: list(turns.values()) for kind, turns in blocks.items()}
    rows = []
    for kind in ("alone", "clients", "flood"):
        cores = [100.0 * block.screen_core for block in of[kind]] or [0.0]
        memory_MB = max((block.screen_MB for block in of[kind]), default=0.0)
        value = f"{max(cores):.1f} % of a core, {memory_MB:.0f} MB"
        bound = {"alone": 1.0, "clients": 8.0}.get(kind)
        remark = f"most of all blocks, whose median is {median(cores):.1f} %"
        if bound is not None and of[kind]:
            said = target(f"{bound:g} %, 150 MB", (max(cores), bound), (memory_MB, 150.0))
            remark = f"{said}; {remark}"
        rows.append(FactRow(name=f"P8, P10 {KINDS[kind]}", value=value, remark=remark))
    for kind in (WITHOUT, "clients"):
        core = 100.0 * max((block.supervisor_core for block in of[kind]), default=0.0)
        name = f"P11 supervisor, {KINDS[kind]}"
        rows.append(
            FactRow(name=name, value=f"{core:.1f} % of a core", remark="it is asked nothing")
        )
    looked = of["clients"]
    if looked:
        each = [one.frames_per_s for one in looked]
        size = max(one.frame_bytes for one in looked)
        value = f"{min(each):.1f} to {max(each):.1f} per s, {size:.0f} bytes"
        remark = target("10 ± 10 %", (9.0, min(each)), (max(each), 11.0))
        rows.append(FactRow(name="P4 frames to each of 10", value=value, remark=remark))
    return Section(title="What it uses (P4, P8, P10, P11)", note="", rows=tuple(rows))


def seen(rig: Rig, kept: Kept, count: int, churn_s: float, skipped: str) -> list[Section]:
    """Return P4 to P7, P9, P10 and P12: presses, scrapes, tabs that come and go, a Chromium.

    ``skipped`` says why no Chromium is used; empty where one is.
    """

    def at_a_screen(name: str, measure: Callable[..., list[FactRow]]) -> list[FactRow]:
        def begun() -> list[FactRow]:
            with rig.screen() as (screen, url):
                return measure(screen, url)

        print(f"part: {name}", flush=True)
        return kept.rows(name, begun)

    def flooded(screen: object, url: str) -> list[FactRow]:
        visitors = clients("flood", url, 600.0)
        try:
            pause(1.0)
            return presses(rig, url, "P2 press to guard under flood", 250.0, count)
        finally:
            visitors.kill()
            visitors.wait()

    presses_of = partial(presses, rig, name="P6 press to guard", target_ms=60.0, count=2 * count)
    rows = [
        *at_a_screen("scrapes", lambda screen, url: scrapes(url, screen)),
        *at_a_screen("presses", lambda screen, url: presses_of(url)),
        *at_a_screen("presses under flood", flooded),
        *at_a_screen("churn", lambda screen, url: churn(url, screen, churn_s)),
    ]
    title = "Presses, scrapes, tabs that come and go (P2, P6, P10, P12)"
    found = [Section(title=title, note="", rows=tuple(rows))]
    title = "In a browser (P4 to P9)"
    if skipped:
        row = FactRow(name="Chromium", value="skipped", remark=skipped)
        return [*found, Section(title=title, note="", rows=(row,))]

    def in_chromium(measure: Callable[..., list[FactRow]]) -> Callable[..., list[FactRow]]:
        def begun(screen: object, url: str) -> list[FactRow]:
            with pages.browser() as chromium:
                return measure(chromium, screen, url)

        return begun

    parts: dict[str, Callable[..., list[FactRow]]] = {
        "loads": lambda chromium, _, url: pages.loads(chromium, url, count),
        "ages": lambda chromium, _, url: pages.ages(chromium, url, 3.0 * count),
        "scope": lambda chromium, screen, url: pages.scope(chromium, url, screen, 1.5 * count),
        "keys": lambda chromium, _, url: pages.keys(chromium, url, rig.arm, count),
    }
    for link in pages.LINKS:
        parts[f"break of {link}"] = lambda chromium, screen, url, link=link: pages.breaks(
            chromium, url, rig, screen, link, count
        )
    rows = [row for name, one in parts.items() for row in at_a_screen(name, in_chromium(one))]
    note = f"Chromium, 1280 by 800, nothing cached, {count} times each."
    return [*found, Section(title=title, note=note, rows=tuple(rows))]


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
