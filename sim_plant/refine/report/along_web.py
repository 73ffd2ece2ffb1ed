"""Places of a line in the order in which the web meets them."""

from __future__ import annotations

from collections.abc import Sequence

FEWEST_IN_A_ROW = 3
"""Places that follow each other are written as the first and the last from here on."""


def sorted_along(names: Sequence[str], along: Sequence[str]) -> list[str]:
    """Return names, each once, in the order of ``along``; what is not in it comes last."""
    place = {name: k for k, name in enumerate(along)}
    return sorted(dict.fromkeys(names), key=lambda name: place.get(name, len(place)))


def listed(names: Sequence[str], along: Sequence[str], last: str = "and") -> str:
    """Return names as text in the order of ``along``, the word ``last`` before the last of them.

    Those that follow each other without a gap are written as ``R1 to R9``.
    """
    place = {name: k for k, name in enumerate(along)}
    rows: list[list[str]] = []
    for name in sorted_along(names, along):
        before = place.get(rows[-1][-1], -2) if rows else -2
        if name in place and before == place[name] - 1:
            rows[-1].append(name)
        else:
            rows.append([name])
    said: list[str] = []
    for row in rows:
        said += [f"{row[0]} to {row[-1]}"] if len(row) >= FEWEST_IN_A_ROW else row
    *first, end = said
    return f"{', '.join(first)} {last} {end}" if first and last else ", ".join(said)
