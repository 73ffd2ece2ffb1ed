"""Rows of the wizard as a page of the documents."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

HEAD = """# Wizard at the screen

From an empty folder to a signed card at [the screen](../screen.md#commissioning) alone, played by
a script in a Chromium on unusual plants (`python -m benchmarks.wizard --docs`; `--plant NAME` for
others). Somebody with displays and the PLC's manual answers the interview, probes, arms, measures
a short card (steps 0, 3, 4, 10 and 12), signs it, has it verified and prints it. The clock runs
from the login on.
"""
NONE = "\nNo plant has been played on a quiet machine yet.\n"
COLUMNS = (
    "plant",
    "site file, min",
    "ACTIVE, min",
    "signed card, min",
    "questions",
    "typed",
    "by Enter",
    "moved",
    "manual",
    "words wrong",
    "probes",
    "pairs begun",
    "signed",
    "verified",
    "measured",
)
TABLE = f"\n| {' | '.join(COLUMNS)} |\n{'|---' * len(COLUMNS)}|\n"
TOLD = """
*Typed*: questions answered otherwise than by Enter. Of the PLC's words *by Enter* are those that
setup was sure of, *moved* that of the load cell that was pressed on, *manual* those that several
words fitted; on a bus the files name them. *Pairs begun*: of off and on; two make a proof, and one
that a fault of the machine cuts short is made again.
"""
RIPPLE = """
## Ripple

Orders that the site file corrects, root of the sum of their squares in the plant's own tension
without noise, as the geometric mean of the two pairs of step 12; *card* is what step 12 says of
them from the load cell's reading.

| plant | tension | off, N | on, N | reduction, dB | card, dB |
|---|---|---|---|---|---|
"""
STANDS = """
## Steps

| plant | 0 | 3 | 4 | 10 | 12 |
|---|---|---|---|---|---|
"""
FAILED = "\n## What did not come to its end\n\n"


def page(rows: Sequence[dict[str, Any]]) -> str:
    """Return the page of some rows."""
    if not rows:
        return HEAD + NONE
    text = HEAD + TABLE + "\n".join(map(_row, rows)) + "\n" + TOLD
    ripple = [line for row in rows for line in _ripple(row)]
    if ripple:
        text += RIPPLE + "\n".join(ripple) + "\n"
    stands = [_stands(row) for row in rows if "stands" in row]
    if stands:
        text += STANDS + "\n".join(stands) + "\n"
    failed = [_failed(row) for row in rows if "failed" in row]
    if failed:
        text += FAILED + "\n".join(failed) + "\n"
    return text


def _row(row: dict[str, Any]) -> str:
    chosen = [len(row[key]) for key in ("by_enter", "by_moving", "by_manual")]
    wrong, card = row["wrong_words"], row.get("wrong_in_card")
    cells = [
        row["plant"],
        *(_minutes(row, stage) for stage in ("site", "active", "card")),
        row["questions"],
        len(row["typed"]),
        *chosen,
        "-" if wrong is None else len(wrong),
        row.get("probes", "-"),
        row.get("pairs_begun", "-"),
        len(row["signed"]) if "signed" in row else "-",
        "-" if card is None else "no" if card else "yes",
        row["measured"][:10],
    ]
    return f"| {' | '.join(map(str, cells))} |"


def _minutes(row: dict[str, Any], stage: str) -> str:
    found = row.get(f"{stage}_min")
    return "-" if found is None else f"{found:.1f}"


def _ripple(row: dict[str, Any]) -> Iterator[str]:
    for signal, one in row.get("ripple", {}).items():
        if signal == "failed":
            continue
        card = one["card_dB"]
        said = "-" if card is None else f"{card:.1f}"
        yield (
            f"| {row['plant']} | {signal} | {one['off_N']:.3f} | {one['on_N']:.4f} | "
            f"{one['dB']:.1f} | {said} |"
        )


def _stands(row: dict[str, Any]) -> str:
    cells = [row["stands"].get(str(number), "-") for number in (0, 3, 4, 10, 12)]
    return f"| {row['plant']} | {' | '.join(cells)} |"


def _failed(row: dict[str, Any]) -> str:
    behind = f"behind {row['stage']}" if row["stage"] else "before the site file"
    return f"- {row['plant']}, {behind}: {row['failed']}"
