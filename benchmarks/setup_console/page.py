"""What came of each plant, as a page of the documents."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

REMARK, MOST_REMARKS = "remark ", 3
HEAD = """# Setup at the console

`aff-runtime setup` at a pseudo-terminal on the simulated Euclid line at 200 FPM, by somebody with
displays and manual (`python -m benchmarks.setup_console --plant all --docs`); each PLC also shows
the set point of the line speed and five words for the record. A word is *right* when site file
and PLC's map agree in place, type, scale and order; no word may be written. *Enter*: setup was
sure of it; *moved*: found by pressing on its load cell; *manual*: several words fit and the
technician looked it up.

| plant | questions | s | words right | Enter | moved | manual | written |
|---|---|---|---|---|---|---|---|
"""
CARD = """
## The card

With `--card short` or `--card whole` the service then runs on that site file: probe, arm, and the
steps of the [card](../technician/card.md), each signed at once; the card is verified with its
records and printed to PDF. Seconds are of the machine, waiting for the line included.
*Measured* is the day: limits are those of that day's product.

| plant | steps | pass | fail | open | not applicable | signed | verified | min | measured |
|---|---|---|---|---|---|---|---|---|---|
"""


FAILED = """
What failed, each with the limit that it had then; a machine with other work misses ticks and
sees a heartbeat late:

"""


def page(folder: Path, plants: Sequence[str]) -> str:
    """Return the page of what lies in the folder of each plant."""
    rows, cards, failed = [], [], []
    for name in plants:
        place = folder / name.replace(" ", "-")
        found = _read(place / "setup.json")
        if found is not None:
            rows.append(_setup_row(name, found))
        card = _read(place / "card.json")
        if card is not None:
            cards.append(_card_row(name, card))
            failed += [f"- {name}, {line}" for line in _failed(card["notes"])]
    text = HEAD + "\n".join(rows) + "\n"
    if cards:
        text += CARD + "\n".join(cards) + "\n"
    if failed:
        text += FAILED + "\n".join(failed) + "\n"
    return text


def _read(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def _setup_row(name: str, row: dict[str, Any]) -> str:
    chosen = [row[key] for key in ("by_enter", "by_moving", "by_manual")]
    count = sum(map(len, chosen))
    right = count - len(row["wrong"]) if row["exit"] == 0 else 0
    told = " | ".join(str(len(one)) for one in chosen)
    return (
        f"| {name} | {row['questions']} | {row['seconds']} | {right} of {count} | {told} | "
        f"{row['writes']} |"
    )


def _card_row(name: str, card: dict[str, Any]) -> str:
    stands = dict(_stands(card["notes"]))
    counts = [
        sum(stand == wanted for stand in stands.values())
        for wanted in ("pass", "fail", "open", "not applicable")
    ]
    signs = {one["step"] for one in card["notes"] if one["step"].startswith("sign ")}
    signed = sum(_ended_well(name, card["notes"]) for name in signs)
    verified = _ended_well("verify", card["notes"])
    told = " | ".join(map(str, counts))
    return (
        f"| {name} | {len(stands)} | {told} | {signed} | {'yes' if verified else 'no'} | "
        f"{card['seconds'] / 60.0:.0f} | {card.get('measured', '')[:10] or 'not recorded'} |"
    )


def _failed(notes: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Yield what failed in each step when it was measured last, and what was remarked then."""
    last = {one["step"]: one["said"] for one in notes if one["step"].startswith("step ")}
    for step, said in last.items():
        for line in said:
            if line.startswith("FAIL "):
                yield f"{step}: {line.removeprefix('FAIL ').strip()}"
        yield from (f"{step}: {text}" for text in _why(said))


def _why(said: Sequence[str]) -> Iterator[str]:
    """Yield the first remarks of a step that failed, and how many more there are."""
    if not any(line.startswith("FAIL ") for line in said):
        return
    remarks = [line.removeprefix(REMARK).strip() for line in said if line.startswith(REMARK)]
    yield from (f"remark: {text}" for text in remarks[:MOST_REMARKS])
    if len(remarks) > MOST_REMARKS:
        yield f"{len(remarks) - MOST_REMARKS} more remarks"


def _ended_well(step: str, notes: Sequence[dict[str, Any]]) -> bool:
    """Return whether a command ended well the last time."""
    exits = [one["exit"] for one in notes if one["step"] == step]
    return bool(exits) and exits[-1] == 0


def _stands(notes: Sequence[dict[str, Any]]) -> Iterator[tuple[str, str]]:
    """Yield how each step stood when it was measured last."""
    for one in notes:
        if one["step"].startswith("step "):
            last = next((line for line in reversed(one["said"]) if line.startswith("step ")), "")
            yield one["step"], last.partition(": ")[2]
