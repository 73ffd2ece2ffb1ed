"""Numbers, places and coordinates of a verdict as a process engineer reads them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.place import Place
from sim_plant.refine.records.units import suffix_of

SMALL_M, SMALL_S = 0.1, 1.0


def unit_of(effect: str, parameter: str) -> str:
    """Return the unit of a parameter in SI; empty for a word, ``1`` for a ratio."""
    known = BY_NAME.get(effect)
    if known is not None and parameter in known.accepts:
        return known.accepts[parameter].unit
    return suffix_of(parameter)


def scaled(value: float, unit: str) -> tuple[float, str]:
    """Return factor and unit in which a value in SI is read most easily: mm, ms, degrees."""
    if unit == "m" and abs(value) < SMALL_M:
        return 1e3, "mm"
    if unit == "s" and abs(value) < SMALL_S:
        return 1e3, "ms"
    if unit == "rad":
        return math.degrees(1.0), "deg"
    return 1.0, "" if unit == "1" else unit


def label(parameter: str, unit: str) -> str:
    """Return a parameter's name without its unit: ``lag_s`` -> ``lag``."""
    ending = "_" + unit.replace("/(", "_").replace(")", "").replace("/", "_").replace(" ", "_")
    return parameter.removesuffix(ending).replace("_", " ")


def place_of(location: str) -> str:
    """Return a location as words."""
    return "all load cells" if location == "all" else location


def place_words(place: Place) -> str:
    """Return ``effect at place`` as words."""
    return f"{place.effect.replace('_', ' ')} at {place_of(place.location)}"


def name_of(row: Mapping[str, Any]) -> str:
    """Return where a row of a verdict says an effect is, as words."""
    return place_words(Place(row["effect"], row["location"]))


def remedy(effect: str, place: str) -> str:
    """Return what to do about an effect at ``place``, without a stop at its end."""
    return BY_NAME[effect].remedy.format(place=place)


def number_rows(row: Mapping[str, Any]) -> list[dict[str, str]]:
    """Return the parameters of an effect as words: name, value, unit, low, high (95 %)."""
    found = []
    for key, value in row["parameters"].items():
        unit = unit_of(row["effect"], key)
        shown = {
            "key": key,
            "name": label(key, unit),
            "value": str(value),
            "unit": "",
            "low": "",
            "high": "",
        }
        if not isinstance(value, str):
            factor, shown["unit"] = scaled(value, unit)
            shown["value"] = f"{factor * value:.4g}"
            if key in row.get("interval95", {}):
                low, high = row["interval95"][key]
                shown |= {"low": f"{factor * low:.4g}", "high": f"{factor * high:.4g}"}
        found.append(shown)
    return found


def tells_size(effect: str, parameter: str) -> bool:
    """Return whether a parameter says how much of an effect there is: no component, no angle."""
    known = BY_NAME.get(effect)
    if known is None or parameter not in known.accepts:
        return True
    row = known.accepts[parameter]
    components = {name for pair in known.quadratures for name in (pair.cos, pair.sin)}
    return row.role != "angle" and not row.detail and parameter not in components


def assumed(effect: str, parameter: str) -> bool:
    """Return whether a number of a finding was set by the library, not found on the record."""
    known = BY_NAME.get(effect)
    row = known.accepts.get(parameter) if known is not None else None
    return row is not None and row.role == "option" and len(row.tries) == 1


def size_of(row: Mapping[str, Any]) -> str:
    """Return how much of an effect there is, with units and 95 % intervals."""
    found = []
    for number in number_rows(row):
        if not tells_size(row["effect"], number["key"]):
            continue
        name = "" if isinstance(row["parameters"][number["key"]], str) else f"{number['name']} "
        text = f"{name}{number['value']} {number['unit']}".rstrip()
        if assumed(row["effect"], number["key"]):
            text += " (assumed; the others hold for it)"
        if number["low"]:
            text += f" (95 %: {number['low']} to {number['high']})"
        found.append(text)
    return ", ".join(found)


def record_headline(result: Mapping[str, Any]) -> str:
    """Return the verdict on records without a line declaration as sentences."""
    if not result["unknown"]:
        return "Nothing found: what the declared filter leaves of the outputs holds no line."
    said = [coordinate_text(u["class"], u["coordinate"]) for u in result["unknown"]]
    return f"Unknown, strongest first: {'; '.join(said)}."


def record_next(result: Mapping[str, Any], *, travel: bool) -> str:
    """Return what the reader may do now; ``travel``: a column is the web's absolute speed."""
    if result["unknown"]:
        return (
            "Look for what turns or swings so; the rms below says what it is worth. A line "
            "declaration (config/lines/euclid.yaml) would name the place."
        )
    more = "" if travel else "a column with the web's absolute speed (travel_speed), or "
    return f"Nothing to do. To have rollers looked for, give {more}a line declaration."


def coordinate_text(kind: str, where: Mapping[str, Any]) -> str:
    """Return what is known of an unknown as words."""
    if kind == "time":
        return f"something that repeats in time, {where['frequency_Hz']:.4g} Hz at every speed"
    if kind == "travel":
        wavenumber = where["wavenumber_1_m"]
        return (
            f"something that repeats every {1e3 / wavenumber:.4g} mm of web ({wavenumber:.5g} "
            f"1/m); a roller of {1e3 * where['equivalent_radius_m']:.4g} mm radius turns so"
        )
    if kind == "angle":
        return f"something that repeats {where['order']:.4g} times per turn of {where['roll']}"
    if kind == "state":
        return (
            f"declared number {where['declared']} fits only {where['standard_deviations']:+.3g} "
            "standard deviations from where it is declared, so the cause lies there or imitates it"
        )
    if "channels" in where:
        band = f"{where['from_Hz']:.3g} to {where['to_Hz']:.3g} Hz"
        return (
            f"something irregular that pushes the line: at {band} {where['channels']} do not move "
            "together as the declared noise does; look at the drive and the web between them"
        )
    return "noise above the line's own, at no frequency in particular"
