"""Wake-up latency of the runtime's ticker beside ``cyclictest``, at the same time."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass

from benchmarks.runtime.facts import FactRow, Section, quantiles_us, timing_row
from benchmarks.runtime.paced import PERIOD_NS, in_child, own_processor

PRIORITY = 80
HISTOGRAM_US = 20_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Cyclictest:
    """What ``cyclictest`` found, us; ``reason`` says why there is nothing."""

    p50_us: float = float("nan")
    p99_us: float = float("nan")
    max_us: float = float("nan")
    reason: str = ""


def latency(seconds: float) -> Section:
    """Measure both for ``seconds`` on the control process's processor, with the same rights."""
    beside = _start(seconds)
    ours = in_child("wake", str(seconds))
    theirs = _finish(beside)
    rows = [timing_row("ticker of the runtime", ours["wake_ns"], _rights(ours["refused"]))]
    if theirs.reason:
        rows.append(FactRow(name="cyclictest", value="skipped", remark=theirs.reason))
    else:
        value = (
            f"p50 {theirs.p50_us:.0f} us, p99 {theirs.p99_us:.0f} us, max {theirs.max_us:.0f} us"
        )
        rows.append(FactRow(name="cyclictest", value=value, remark=f"SCHED_FIFO {PRIORITY}"))
        p50, p99, most = quantiles_us(ours["wake_ns"])
        ratio = f"p50 {_ratio(p50, theirs.p50_us)}, p99 {_ratio(p99, theirs.p99_us)}"
        rows.append(FactRow(name="ratio", value=f"{ratio}, max {_ratio(most, theirs.max_us)}"))
    return Section(
        title="Wake-up latency",
        note=f"Period 5 ms, {seconds:g} s, same processor, same time.",
        rows=tuple(rows),
    )


def _start(seconds: float) -> subprocess.Popen[str] | None:
    path = shutil.which("cyclictest", path="/usr/sbin:/usr/bin:/sbin:/bin:/usr/local/bin")
    if path is None:
        return None
    loops = round(seconds * 1e9 / PERIOD_NS)
    command = [
        *(path, "--quiet", "--mlockall", "--threads=1", f"--affinity={own_processor()}"),
        *(f"--priority={PRIORITY}", f"--interval={PERIOD_NS // 1000}", f"--loops={loops}"),
        f"--histogram={HISTOGRAM_US}",
    ]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def _finish(process: subprocess.Popen[str] | None) -> Cyclictest:
    if process is None:
        return Cyclictest(reason="cyclictest is not installed (Debian: rt-tests)")
    text, _ = process.communicate()
    if process.returncode != 0:
        return Cyclictest(reason=f"cyclictest refused: {text.strip().splitlines()[-1:]}")
    return parse(text)


def parse(text: str) -> Cyclictest:
    """Return the quantiles of cyclictest's histogram; the first thread counts."""
    counts = {int(us): int(n) for us, n in re.findall(r"^(\d{6})\s+(\d+)", text, re.MULTILINE)}
    total = sum(counts.values())
    most = re.search(r"# Max Latencies:\s*(\d+)", text)
    if total == 0 or most is None:
        return Cyclictest(reason="cyclictest printed no histogram")
    return Cyclictest(
        p50_us=_quantile(counts, 0.5 * total),
        p99_us=_quantile(counts, 0.99 * total),
        max_us=float(most[1]),
    )


def _quantile(counts: dict[int, int], wanted: float) -> float:
    seen = 0
    for microseconds in sorted(counts):
        seen += counts[microseconds]
        if seen >= wanted:
            return float(microseconds)
    return float(max(counts))


def _ratio(ours: float, theirs: float) -> str:
    return f"{ours / theirs:.1f}" if theirs > 0.0 else "-"


def _rights(refused: list[str]) -> str:
    return "; ".join(refused) if refused else f"all rights granted, SCHED_FIFO {PRIORITY}"
