"""Virtual lines with effects that their files do not have, to try a fleet on."""

from __future__ import annotations

import math
from collections.abc import Callable
from datetime import date, timedelta
from pathlib import Path

import numpy as np
import yaml

from aff_runtime.base.errors import PlantError
from aff_runtime.base.yaml_places import SafeLoader
from sim_plant.base.shipped import shipped
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.reading.load import read_source
from sim_plant.refine.example import simulated, write_table
from sim_plant.refine.model.hypotheses import Hypothesis, all_hypotheses

STEP_S, DURATION_S = 0.01, 40.0
HEALTHY_SHARE = 0.3
GROWING_EVERY, GROWING_LOOKS = 10, 4
"""Each so many lines one is looked at this often, a week apart, its effect growing."""
GROWTH = 1.25
FIRST_DAY = date(2026, 9, 28)
SPEEDS_M_S = (0.7, 1.6)


def write_fleet(
    count: int, seed: int, lines: Path, runs: Path, say: Callable[[str], None]
) -> dict[str, str]:
    """Write ``count`` line files and their records; return what each line hides, "" for nothing.

    A line that is there already with all its records is left as it is, so a stopped run goes on;
    what a line is depends on ``seed`` and its number alone.

    Raises
    ------
    PlantError
        When a folder cannot be written.
    """
    hidden = {}
    for number in range(1, count + 1):
        name = name_of(number)
        text, effect = drawn(seed, number)
        looks = GROWING_LOOKS if number % GROWING_EVERY == 0 else 1
        hidden[name] = f"{effect.effect} at {effect.location}" if effect else ""
        try:
            (runs / name).mkdir(parents=True, exist_ok=True)
            lines.mkdir(parents=True, exist_ok=True)
            file = lines / f"{name}.yaml"
            if not file.exists():
                file.write_text(text, encoding="utf-8")
            for look in range(looks):
                day = (FIRST_DAY + timedelta(weeks=look)).isoformat()
                size = GROWTH**look
                for at, part in enumerate("ab"):
                    path = runs / name / f"{day}_{part}.csv.gz"
                    if not path.exists():
                        own = np.random.default_rng([seed, number, look, at])
                        write_record(path, text, grown(effect, size), own)
        except OSError as error:
            raise PlantError(f"{name}: cannot be written ({error})") from error
        say(f"{name}: {hidden[name] or 'healthy'}")
    return hidden


def name_of(number: int) -> str:
    """Return the name of a line of the example."""
    return f"line{number:04d}"


def drawn(seed: int, number: int) -> tuple[str, EffectEntry | None]:
    """Return file and effect of a line, None where it is healthy; by seed and number alone."""
    draw = np.random.default_rng([seed, number])
    text = drawn_line(draw)
    sick = draw.random() >= HEALTHY_SHARE
    return text, drawn_effect(draw, declared(text)) if sick else None


def drawn_line(draw: np.random.Generator) -> str:
    """Return the file of a line like Euclid's with a web of its own."""
    data = read_source(shipped("lines/euclid.yaml")).data
    EA_N = round(float(data["web"]["EA_N"]) * math.exp(draw.uniform(-0.4, 0.4)), 0)
    data = data | {"web": data["web"] | {"EA_N": EA_N}, "sample_time_s": STEP_S}
    data.pop("effects", None)
    return yaml.safe_dump(data, sort_keys=False)


def declared(text: str) -> Declaration:
    """Return what a line file says."""
    return Declaration.model_validate(yaml.load(text, Loader=SafeLoader))


def drawn_effect(draw: np.random.Generator, line: Declaration) -> EffectEntry:
    """Return an effect at a place, one to three times as large as it is typical.

    Every effect is as likely that answers in proportion to its size: others have a start or a
    threshold, which a draw would have to know.
    """
    fair = [h for h in all_hypotheses(line) if h.strength_count and all(h.linear)]
    names = sorted({h.effect.name for h in fair})
    name = names[int(draw.integers(len(names)))]
    places = [h for h in fair if h.effect.name == name]
    found: Hypothesis = places[int(draw.integers(len(places)))]
    values = dict(found.fixed)
    for at, parameter in enumerate(found.names):
        share = math.exp(draw.uniform(0.0, math.log(3.0))) if at < found.strength_count else 1.0
        away = share * (found.start[at] - found.absent[at])
        values[parameter] = min(max(found.absent[at] + away, found.low[at]), found.high[at])
    return EffectEntry(effect=name, location=found.location, parameters=values)


def grown(effect: EffectEntry | None, size: float) -> EffectEntry | None:
    """Return the effect with its linear numbers ``size`` times as far from absent."""
    if effect is None or size == 1.0:
        return effect
    rows, values = BY_NAME[effect.effect].accepts, dict(effect.parameters)
    for name, value in values.items():
        row = rows[name]
        if row.role == "strength" and row.linear:
            values[name] = float(row.default) + size * (float(value) - float(row.default))
    return effect.model_copy(update={"parameters": values})


def write_record(
    path: Path, text: str, effect: EffectEntry | None, draw: np.random.Generator
) -> None:
    """Run the line with the effect under two speeds and a tension step, and write its record."""
    slow, fast = sorted(float(speed) for speed in draw.uniform(*SPEEDS_M_S, size=2))
    seed = int(draw.integers(2**31))
    columns = simulated(declared(text), effect, (slow, fast), DURATION_S, seed)
    side = path.with_name(path.name.removesuffix(".csv.gz") + ".yaml")
    side.write_text(text, encoding="utf-8")
    fresh = path.with_name(f".{path.name}")  # a stopped run leaves no half record under its name
    write_table(columns, fresh)
    fresh.replace(path)
