"""Which pairs a seed draws, and one of them as files and label."""

from __future__ import annotations

import gzip
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchmarks.blind.changed import CHANGED, NUMBERS, becomes, hide_changed
from benchmarks.blind.effects import Hidden, Parameters, outside
from benchmarks.blind.line import NAMES, WEBS, centres, declaration, told
from benchmarks.blind.machine import Scatter, Told, machine, simulate
from benchmarks.blind.plant import Array, Plant
from benchmarks.blind.table import OUTSIDE, TABLE, hide, hide_outside

SHARES = {"pair": 0.40, "single": 0.45, "healthy": 0.10, "outside": 0.05}
JUDGED_ROWS = slice(2000, None)
WINDOW_ROWS = 200
SEEN_RMS, SEEN_WINDOW = 2.0, 4.2
"""An effect is visible from so much of the noise on, in its best channel: over the record, or in
its best two seconds. The labels of ``shared/data/cases`` part there."""
RUNS_FROM, RUNS_TO = 0.2, 3.0
"""Shares of its reference between which the tension before the drive stays on a line that runs: a
tension loop that a drawn ramp or delay lets swing slackens the web, and nobody records that."""
DRAWS = 20
DIGITS = {"_N": 3, "_rad_s": 5, "_m_s": 6, "_rad": 6, "_m": 5}


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One drawn pair: its name, its kind, what is hidden."""

    name: str
    kind: str
    seed: tuple[int, int]
    hidden: tuple[Hidden, ...]


def kinds(count: int) -> list[str]:
    """Return the kind of every case: whole numbers nearest to the shares, pairs first."""
    wanted = {kind: round(count * share) for kind, share in SHARES.items()}
    wanted["single"] += count - sum(wanted.values())
    return [kind for kind, number in wanted.items() for _ in range(number)]


def drawn(count: int, seed: int) -> list[Case]:
    """Return the cases of a seed; every effect is dealt before any comes again."""
    found = []
    deck: list[str] = []
    deal = np.random.default_rng([seed, 0])
    for number, kind in enumerate(kinds(count), start=1):
        rng = np.random.default_rng([seed, number])
        hidden: list[Hidden] = []
        for _ in range({"pair": 2, "single": 1}.get(kind, 0)):
            deck, name = _next(deck, deal, [h.effect for h in hidden])
            hidden.append(hide(rng, name))
        if kind == "outside":
            hidden.append(hide_outside(rng))
        found.append(
            Case(name=f"case{number:02d}", kind=kind, seed=(seed, number), hidden=tuple(hidden))
        )
    return found


def changed(count: int, seed: int) -> list[Case]:
    """Return cases of one changed number each; every number is dealt before any comes again."""
    found = []
    deck: list[str] = []
    for number in range(1, count + 1):
        rng = np.random.default_rng([seed, number, 3])
        deck = deck or [str(path) for path in rng.permutation(list(NUMBERS))]
        hidden = hide_changed(rng, deck.pop())
        name = f"change{number:02d}"
        found.append(Case(name=name, kind="single", seed=(seed, number), hidden=(hidden,)))
    return found


def _next(deck: list[str], rng: np.random.Generator, taken: list[str]) -> tuple[list[str], str]:
    """Return the deck without its next card that is not taken, and that card."""
    if not set(deck) - set(taken):
        deck = [*deck, *map(str, rng.permutation(list(TABLE)))]
    name = next(card for card in deck if card not in taken)
    rest = list(deck)
    rest.remove(name)
    return rest, name


def put(p: Plant, hidden: Hidden, record: str) -> Plant:
    """Return the machine with an effect."""
    if hidden.effect == CHANGED:
        return becomes(p, hidden, record)
    k = NAMES.index(hidden.location) if hidden.location in NAMES else -1
    act = outside if hidden.effect == OUTSIDE else TABLE[hidden.effect].put
    return act(p, k, hidden, record)


def make(case: Case, folder: Path) -> dict[str, Any]:
    """Write both records and declarations of a case; return its label.

    Effects with which the line does not run are drawn anew, others of the same kinds.
    """
    for draw in range(1, DRAWS + 1):
        records = made(case, folder)
        if records is not None:
            return label(case, records)
        rng = np.random.default_rng([*case.seed, 2, draw])
        case = replace(case, hidden=tuple(_anew(rng, h) for h in case.hidden))
    raise RuntimeError(f"{case.name}: no draw of {DRAWS} leaves a line that runs")


def _anew(rng: np.random.Generator, was: Hidden) -> Hidden:
    if was.effect == CHANGED:
        return hide_changed(rng, was.location)
    return hide_outside(rng) if was.effect == OUTSIDE else hide(rng, was.effect)


def runs(quiet: dict[str, Array]) -> bool:
    """Return whether the web stays tight in a record without noise."""
    share = quiet["unwind_tension_N"] / quiet["tension_ref_N"]
    return bool(share.min() > RUNS_FROM and share.max() < RUNS_TO)


def made(case: Case, folder: Path) -> dict[str, Any] | None:
    """Write both records and declarations of a case; return what was seen, None on a slack web."""
    rng = np.random.default_rng([*case.seed, 1])
    web = WEBS[int(rng.random() < 0.4)]
    centre = centres(rng)
    machine_seed = int(rng.integers(1 << 31))
    records: dict[str, Any] = {}
    for record in "ab":
        rolls = tuple(round(float(x), 5) for x in rng.uniform((0.105, 0.13), (0.2, 0.195)))
        line = declaration(web, centre, (rolls[0], rolls[1]))
        references = told(rng)
        seed, angles = int(rng.integers(1 << 31)), rng.uniform(0.0, 2.0 * np.pi, len(NAMES))

        def run(
            without: int | None,
            noise: bool,
            record: str = record,
            line: Parameters = line,
            references: Told = references,
            angles: Array = angles,
            seed: int = seed,
        ) -> dict[str, Array]:
            p = machine(line, Scatter(np.random.default_rng(machine_seed)))
            for number, hidden in enumerate(case.hidden):
                if number != without:
                    p = put(p, hidden, record)
            return simulate(p, line, references, angles, seed, noise=noise)

        noisy, quiet = run(None, True), run(None, False)
        if not runs(quiet):
            return None
        write_record(noisy, line, folder / f"{case.name}_{record}.csv.gz")
        text = yaml.safe_dump(line, sort_keys=False)
        (folder / f"{case.name}_{record}.yaml").write_text(text, encoding="utf-8")
        floor = {k: _rms(noisy[k] - quiet[k]) for k in _channels(line)}
        best = [
            seen({k: quiet[k] - without[k] for k in floor}, floor)
            for without in (run(number, False) for number in range(len(case.hidden)))
        ]
        records[record] = {"noise_floor_rms": floor, "best": best}
    return records


def _channels(line: Parameters) -> list[str]:
    """Return the channels by which effects are seen: angles drift, radii are words."""
    return [row["channel"] for row in line["sensors"] if {"noise_sd_N", "noise_sd_rad_s"} & {*row}]


def seen(difference: dict[str, Array], floor: dict[str, float]) -> list[Any]:
    """Return the best channel and its rms over the noise: of the record, of two seconds."""
    whole = {k: _rms(v) / floor[k] for k, v in difference.items()}
    short = {k: _best_window(v) / floor[k] for k, v in difference.items()}
    one, other = max(whole, key=lambda k: whole[k]), max(short, key=lambda k: short[k])
    return [one, round(whole[one], 3), other, round(short[other], 3)]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values[JUDGED_ROWS] ** 2)))


def _best_window(values: Array) -> float:
    power = values[JUDGED_ROWS] ** 2
    cut = power[: power.size // WINDOW_ROWS * WINDOW_ROWS].reshape(-1, WINDOW_ROWS)
    return float(np.sqrt(cut.mean(axis=1).max()))


def visible(records: dict[str, Any]) -> bool:
    """Return whether every effect is seen in the record that is fitted."""
    rows = records["a"]["best"]
    return all(rms >= SEEN_RMS or window >= SEEN_WINDOW for _, rms, _, window in rows)


def label(case: Case, records: dict[str, Any]) -> dict[str, Any]:
    """Return what ``labels.yaml`` says of a case."""
    effects = [
        {
            "effect_class": h.effect,
            "location": h.location,
            "parameters": h.parameters,
            "accept": list(h.accept),
        }
        for h in case.hidden
    ]
    return {
        "case": case.name,
        "healthy": case.kind == "healthy",
        "outside": case.kind == "outside",
        "visible": visible(records),
        "effects": effects,
        "records": records,
    }


def write_record(columns: dict[str, Array], line: Parameters, path: Path) -> None:
    """Write the channels that a line declares, and its references, as CSV."""
    names = ["time_s", *(row["channel"] for row in line["sensors"]), *line["reference_columns"]]
    digits = [next((d for end, d in DIGITS.items() if n.endswith(end)), 4) for n in names]
    with gzip.open(path, "wt", encoding="utf-8", compresslevel=6) as file:
        np.savetxt(
            file,
            np.column_stack([columns[n] for n in names]),
            [f"%.{d}f" for d in digits],
            ",",
            header=",".join(names),
            comments="",
        )
