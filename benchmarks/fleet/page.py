"""The page of the fleet's example, from the rows that are there."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import duckdb

from benchmarks.fleet.scored import CLAIMED, FATES, QUIET, Scored
from sim_plant.fleet.findings import with_trends

NIGHT_H = 10.0
MANY = 5000
HEAD = """# A fleet of virtual lines

Written by `python -m benchmarks.fleet --docs` (`make fleet`; [what a fleet
is](../engineer/fleet.md)). Lines like Euclid's, each with a web of its own and one
effect of the catalogue at one of its places, one to three times as large as it is
typical, or none. A look: two records of 40 s at 10 ms, two speeds and a step of tension
each; one is fitted, the other judged on. Of each ten lines one is looked at four times,
a week apart, its effect growing by a quarter a week."""
MEANING = """*Named*: the hidden effect at its place, alone. *One of several*: it is among what
the verdict says it cannot tell apart, and nothing else is. *Beside others*: something that
is not there is named or left unknown too. *Another*: only such. Whether the records
show an effect at all is not told apart here: the [campaign](refine-campaign.md) does."""
QUERY = """select effect, count(distinct line) as lines,
       median(size) as usual, any_value(unit) as unit
from '{table}' where effect <> '' group by effect order by lines desc, effect"""


def page(
    scored: Sequence[Scored],
    drawn: int,
    table: Path | None,
    scaling: Mapping[str, Any] | None,
    lost: Mapping[str, Any] | None,
) -> str:
    """Return the page; ``drawn`` lines were asked for, ``table`` is their Parquet file."""
    parts = [HEAD]
    if scored:
        parts += [_what_was_told(scored, drawn), _healthy(scored), _growing(scored)]
        parts.append(_wrong(scored))
    if table is not None:
        parts.append(_asked_of(table))
    parts += [_scaling(scaling), _lost(lost)]
    if scored:
        parts.append(_cost(scored))
    return "\n\n".join(part for part in parts if part) + "\n"


def rows_of(titles: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table in Markdown."""
    lines = [titles, ["---"] * len(titles), *rows]
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in lines)


def _what_was_told(scored: Sequence[Scored], drawn: int) -> str:
    sick = [s for s in scored if s.hidden is not None]
    lines = len({s.result.line for s in scored})
    kinds = sorted({s.hidden.effect for s in sick if s.hidden is not None})
    found = []
    for kind in kinds:
        own = [s for s in sick if s.hidden is not None and s.hidden.effect == kind]
        found.append([kind, len(own), *_counts(own), _held(own)])
    found.append(["all", len(sick), *_counts(sick), _held(sick)])
    said = f"{len(scored)} looks at {lines} lines of {drawn}; {len(sick)} looks hide an effect."
    titles = ["hidden", "looks", *FATES, "intervals that hold"]
    return f"## What was told\n\n{said} {MEANING}\n\n{rows_of(titles, found)}"


def _counts(scored: Sequence[Scored]) -> list[object]:
    count = Counter(s.fate for s in scored)
    return [count[fate] or "" for fate in FATES]


def _held(scored: Sequence[Scored]) -> str:
    told = [s.holds for s in scored if s.holds is not None]
    return f"{sum(told)} of {len(told)}" if told else ""


def _healthy(scored: Sequence[Scored]) -> str:
    count = Counter(s.fate for s in scored if s.hidden is None)
    return (
        f"Of {count.total()} looks at healthy lines {count[QUIET]} are told to lack nothing, of "
        f"{count[CLAIMED]} something is claimed, {count['failed']} failed."
    )


def _growing(scored: Sequence[Scored]) -> str:
    series: dict[str, list[Scored]] = {}
    for one in scored:
        if one.hidden is not None:
            series.setdefault(one.result.line, []).append(one)
    series = {line: looks for line, looks in series.items() if len(looks) > 1}
    if not series:
        return ""
    grow = shrink = 0
    for looks in series.values():
        told = with_trends([f for s in looks for f in s.findings])
        signs = {f.trend * f.size > 0.0 for f in told if f.trend == f.trend}
        grow += True in signs
        shrink += False in signs
    return (
        f"Of {len(series)} lines with a growing effect and more than one look, {grow} are told "
        f"to grow and {shrink} to shrink."
    )


def _wrong(scored: Sequence[Scored]) -> str:
    """Return what was told of looks where only something that is not there is named."""
    found = []
    for s in scored:
        if s.hidden is not None and s.fate == "another":
            told = "; ".join(f"{f.effect} at {f.place}, {f.sure}" for f in s.findings)
            left = max(f.error_after for f in s.findings)
            hidden = f"{s.hidden.effect} at {s.hidden.location}"
            found.append([s.result.line, hidden, s.result.answer, told, f"{left:.1f}"])
    if not found:
        return ""
    titles = ["line", "hidden", "verdict", "told", "error left, noise floors"]
    return (
        "Told as another. *Error left*: of the worst tension on the record held out, with what "
        f"is told; 1.0 is what noise alone leaves.\n\n{rows_of(titles, found)}"
    )


def _asked_of(table: Path) -> str:
    query = QUERY.format(table=table)
    found = [
        [effect, lines, "" if usual is None else f"{usual:.3g} {'' if unit == '1' else unit}"]
        for effect, lines, usual, unit in duckdb.sql(query).fetchall()
    ]
    shown = QUERY.format(table="DIR/fleet.parquet")
    answer = rows_of(["effect", "lines", "usual size"], found)
    return f"## The table in DuckDB\n\n```sql\n{shown}\n```\n\n{answer}"


def _scaling(kept: Mapping[str, Any] | None) -> str:
    if kept is None:
        return ""
    walls, first = kept["walls_s"], kept["walls_s"]["1"]
    found = [
        [count, f"{wall:.0f} s", f"{kept['each_s'][count]:.0f} s", f"{first / wall:.2f}"]
        for count, wall in walls.items()
    ]
    titles = ["workers", f"{kept['looks']} looks", "a look by itself", "times as fast"]
    same = "are the same bytes" if kept["tables_alike"] else "**differ**"
    return (
        f"## Scaling\n\n`python -m benchmarks.fleet --scaling {kept['looks']}`, {kept['cores']} "
        f"cores; the tables {same}.\n\n{rows_of(titles, found)}"
    )


def _lost(kept: Mapping[str, Any] | None) -> str:
    if kept is None:
        return ""
    killed = (
        "one of two workers killed (SIGKILL) when half had rows"
        if kept["killed"]
        else "**no worker was killed**"
    )
    same = "the same bytes as" if kept["alike"] else "**another than**"
    return (
        f"## A lost worker\n\n`python -m benchmarks.fleet --lost {kept['looks']}`, a scheduler "
        f"and workers started by hand, {killed}: {kept['rows']} of {kept['looks']} looks "
        f"have a row, and `fleet.parquet` is {same} that of a run in peace."
    )


def _cost(scored: Sequence[Scored]) -> str:
    clock = [s.result.time_s for s in scored]
    counted = [s.result.cpu_s for s in scored]
    by_clock = any(map(math.isnan, counted))  # rows of before it was counted
    times = sorted(clock if by_clock else counted)
    mean_s, all_h = statistics.fmean(times), sum(times) / 3600.0
    hours = MANY * mean_s / 3600.0
    how = (
        "worker in all (by the clock, beside what else the machine did)"
        if by_clock
        else f"core in all; by the clock {statistics.median(clock):.0f} s in the median, beside "
        "what else the machine did"
    )
    return (
        f"## What it takes\n\nA look took {statistics.median(times):.0f} s in the median, "
        f"{times[0]:.0f} to {times[-1]:.0f} s, {mean_s:.0f} s in the mean, {all_h:.2g} h of a "
        f"{how}. On paper {MANY} lines with a look each are {hours:.0f} h of a core: "
        f"{hours / NIGHT_H:.1f} cores for a night of {NIGHT_H:.0f} h."
    )
