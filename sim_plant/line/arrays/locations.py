"""What a location in a declaration names, and where an effect is worth trying."""

from __future__ import annotations

import itertools

from aff_runtime.base.errors import PlantError
from aff_runtime.base.suggest import hint
from sim_plant.base.effects import Effect
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.arrays.corrections import changeable_numbers, declared_numbers
from sim_plant.line.declared.declaration import Declaration


def zones(declaration: Declaration) -> dict[str, list[int]]:
    """Return the spans of each zone: up to the first driven roller, to the last, and after it.

    ``unwind_zone`` runs from the unwind to the first driven roller, ``pull_roll_zone`` between
    the last two driven rollers, ``rewind_zone`` from the last one to the rewind.
    """
    driven = [k for k, roller in enumerate(declaration.rollers) if roller.kind == "driven"]
    spans = len(declaration.spans)
    if not driven:
        return {"unwind_zone": list(range(spans))}
    found = {"unwind_zone": list(range(driven[0]))}
    if len(driven) > 1:
        found["pull_roll_zone"] = list(range(driven[-2], driven[-1]))
    found["rewind_zone"] = list(range(driven[-1], spans))
    return found


def bridles(declaration: Declaration) -> dict[str, list[int]]:
    """Return driven rollers that the web passes one right after another, as an S-wrap's.

    They are called by what their names have in common, or by their names with a plus between.
    """
    found: dict[str, list[int]] = {}
    run: list[int] = []
    for k, roller in enumerate([*declaration.rollers, None]):
        if roller is not None and roller.kind == "driven":
            run.append(k)
            continue
        if len(run) > 1:
            names = [declaration.rollers[j].name for j in run]
            alike = itertools.takewhile(lambda row: len(set(row)) == 1, zip(*names, strict=False))
            common = "".join(row[0] for row in alike).rstrip("_- ")
            found[common if common and common not in names else "+".join(names)] = run
        run = []
    return found


def places_of(declaration: Declaration, effect: Effect, location: str, where: str) -> list[int]:
    """Return the indices that ``location`` names for this kind of effect.

    Raises
    ------
    PlantError
        When there is no such location; the message offers the nearest name.
    """
    if effect.place == "span":
        return _spans(declaration, location, where)
    if effect.place == "body":
        names = [roller.name for roller in declaration.rollers]
        return bridles(declaration).get(location) or [_index(names, location, where)]
    names = _names(declaration, effect)
    if effect.place == "cell" and location == "all":
        return list(range(len(names)))
    if effect.place == "drive":
        _index([roller.name for roller in declaration.rollers], location, where)
        if location not in names:
            raise PlantError(f"{where}: roller {location!r} has no drive")
    return [_index(names, location, where)]


def _names(declaration: Declaration, effect: Effect) -> list[str]:
    """Return what locations are called where each names one place."""
    if effect.place == "number":
        return [number.name for number in declared_numbers(declaration)]
    return {
        "web": ["web"],
        "cell": [sensor.roller for sensor in cell_sensors(declaration)],
        "loop": [loop.acts_on for loop in declaration.control.tension_pi],
        "drive": [drive.roller for drive in declaration.control.drives],
    }[effect.place]


def _spans(declaration: Declaration, location: str, where: str) -> list[int]:
    by_zone = zones(declaration)
    if location in by_zone:
        return by_zone[location]
    pairs = [f"{span.start}-{span.end}" for span in declaration.spans]
    if location in pairs:
        return [pairs.index(location)]
    return [_index(list(by_zone) + pairs, location, where)]


def _index(names: list[str], name: str, where: str) -> int:
    if name not in names:
        raise PlantError(f"{where}: read {name!r}; expected one of {names}{hint(name, names)}")
    return names.index(name)


def candidate_locations(declaration: Declaration, effect: Effect) -> list[str]:
    """Return the locations at which tracing should try ``effect``, in web order."""
    rollers = declaration.rollers
    kind = effect.candidates
    if kind in ("web", "number"):
        return ["web"] if kind == "web" else [n.name for n in changeable_numbers(declaration)]
    if kind == "gripping":
        return [*[r.name for r in rollers if r.kind == "driven"], *bridles(declaration)]
    if kind == "zone":
        return [name for name, spans in zones(declaration).items() if spans]
    if kind == "cell":
        cells = [sensor.roller for sensor in cell_sensors(declaration)]
        return [*cells, "all"] if len(cells) > 1 else cells
    if kind in ("drive", "trimmed_drive"):
        trimmed = {loop.acts_on for loop in declaration.control.tension_pi}
        drives = [drive.roller for drive in declaration.control.drives]
        return [name for name in drives if kind == "drive" or name in trimmed]
    wanted = {
        "unwind": {"unwind"},
        "roll": {"unwind", "rewind"},
        "roller": {"idler", "driven"},
        "driven": {"driven"},
        "turning": {"unwind", "rewind", "idler", "driven"},
    }[kind]
    last = len(rollers) - 1
    ends = {0: "unwind", last: "rewind"}
    return [r.name for k, r in enumerate(rollers) if ends.get(k, r.kind) in wanted]
