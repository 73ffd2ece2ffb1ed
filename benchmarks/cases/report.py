"""The page: every pair in order, then totals with their bounds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks.cases.outside import table
from benchmarks.cases.score import (
    Key,
    Label,
    is_right,
    is_right_outside,
    named_sets,
    number_errors,
    outcome,
    over_floor,
    quantile_text,
    share_of,
)

ScoredPair = tuple[str, Label, dict[str, Any]]
HEAD = (
    "pair",
    "hidden",
    "said",
    "came to",
    "worst tension held out over its floor: before, after",
    "worst number off, %",
    "time, s",
)
HONEST = "unknown, class and coordinate right"


def page(entries: Sequence[ScoredPair]) -> str:
    """Return the page of the pairs in ``shared/data``: table and totals as Markdown."""
    lines = [
        "# Labelled pairs of another simulator",
        "",
        f"Repeat: `make refine-cases{_extra(entries)}`. Rules are set on `train` only. The pairs "
        "were made for this project and are kept beside the repository, in `shared/data` "
        "([references](../references.md#data)).",
        "",
    ]
    return "\n".join(lines) + "\n" + tables(entries)


def tables(entries: Sequence[ScoredPair]) -> str:
    """Return the table and the totals of each part as Markdown."""
    lines = [
        _row(HEAD),
        _row(["---"] * len(HEAD)),
        *(_row(_cells(*entry)) for entry in entries),
        "",
    ]
    for part in dict.fromkeys(part for part, _, _ in entries):
        lines += _totals(part, [entry for entry in entries if entry[0] == part])
    if any(label.outside for _, label, _ in entries):
        lines += ["## What is right outside the library", "", *table(), ""]
    return "\n".join(lines) + "\n"


def _extra(entries: Sequence[ScoredPair]) -> str:
    """Return what the command needs where one part alone was run."""
    parts = sorted({part for part, _, _ in entries})
    return f' EXTRA="--part {parts[0]}"' if len(parts) == 1 else ""


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cells(part: str, label: Label, row: dict[str, Any]) -> list[str]:
    verdict = row["verdict"]
    floor = over_floor(verdict)
    said = [_set_words(claim) for claim in named_sets(verdict)]
    said += [_unknown_words(u) for u in verdict.get("unknown", ())]
    came_to = outcome(label, verdict)
    right = is_right(label, came_to)
    if label.outside and right:
        right = is_right_outside(label, verdict)
        came_to = HONEST if right else came_to
    off = number_errors(label, verdict)
    worst = max(off, key=lambda name: off[name], default="")
    return [
        f"{part} {label.name}",
        _hidden(label),
        "; ".join(said) or ("nothing" if verdict else row["error"].replace("\n", " ")[:120]),
        came_to if right else f"**{came_to}**",
        "-" if floor is None else f"{floor[0]:.2f}, {floor[1]:.2f}",
        f"{off[worst]:.1f} ({worst})" if off else "-",
        f"{row['time_s']:.0f}",
    ]


def _hidden(label: Label) -> str:
    if label.healthy:
        return label.kind
    if label.outside:
        return f"outside: {label.hidden[0]['parameters']['what']} at {label.hidden[0]['location']}"
    return "; ".join(label.words) + ("" if label.visible else " (hardly visible)")


def _set_words(claim: frozenset[Key]) -> str:
    return " or ".join(f"{name} at {place}" for name, place in sorted(claim))


def _unknown_words(unknown: dict[str, Any]) -> str:
    rows = (unknown, *unknown.get("alternatives", ()))
    return "unknown, " + " or ".join(f"{u['class']}: {_where(u['coordinate'])}" for u in rows)


def _where(coordinate: dict[str, Any]) -> str:
    return ", ".join(
        f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}"
        for name, value in coordinate.items()
    )


def _totals(part: str, entries: Sequence[ScoredPair]) -> list[str]:
    scored = [(label, outcome(label, row["verdict"]), row) for _, label, row in entries]
    visible = [(label, said) for label, said, _ in scored if label.visible]
    named = [(label, said) for label, said in visible if label.kind in ("single", "pair")]

    def right(kinds: tuple[str, ...]) -> str:
        return str(share_of([is_right(la, said) for la, said in visible if la.kind in kinds]))

    after = [
        floor[1]
        for label, said, row in scored
        if said in ("exact", "set") and (floor := over_floor(row["verdict"])) is not None
    ]
    outside = [(label, row["verdict"]) for label, _, row in scored if label.outside]
    honest = [is_right_outside(label, verdict) for label, verdict in outside]
    off = [x for la, _, row in scored for x in number_errors(la, row["verdict"]).values()]
    healthy = [said for label, said, _ in scored if label.healthy]
    claimed = [said not in ("nothing", "failed") for said in healthy]
    times = [row["time_s"] for _, _, row in scored]
    return [
        f"## {part}",
        "",
        f"- exact or rightly named set, visible singles: {right(('single',))}",
        f"- the same, visible pairs: {right(('pair',))}",
        f"- the same, together: {right(('single', 'pair'))}",
        f"- something wrong stated as fact: {share_of([said == 'wrong' for _, said in named])}",
        f"- healthy lines accused: {share_of(claimed)}",
        f"- outside the library, unknown and no effect named: {right(('outside',))}",
        f"- the same, class and coordinate right: {share_of(honest)}",
        f"- numbers of right singles, off by (median / 90 %, %; {len(off)} numbers): "
        f"{quantile_text(off)}",
        f"- right cases, worst tension over floor, median / 90 %: {quantile_text(after)}",
        f"- failed: {sum(said == 'failed' for _, said, _ in scored)}",
        f"- time of a pair on one worker, median / 90 %, s: {quantile_text(times)}",
        "",
    ]
