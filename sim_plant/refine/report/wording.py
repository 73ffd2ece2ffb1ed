"""Numbers, places and coordinates of a verdict as a process engineer reads them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from aff_runtime.base.channel_units import unit_of_name, without_unit
from sim_plant.base.effects import Value
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.along_web import listed
from sim_plant.refine.report.verdict import EffectFinding, Moment, NumberChange

SMALL_M, SMALL_S = 0.1, 1.0
"""A smaller length is written in mm, a shorter time in ms."""
NOT_SHOWN = "not shown"
MOST_DECIMALS, ROUNDING = 6, 1e-6
"""Digits after the point; what a half interval may be short of a power of ten by rounding."""
NO_TOLERANCE: Mapping[str, float] = MappingProxyType({})
SHOWN_ORDERS = 6
"""Orders of an outline that are written out, the largest; the file has all."""


def unit_of(effect: str, parameter: str) -> str:
    """Return the unit of a parameter in SI; empty for a word, ``1`` for a ratio."""
    known = BY_NAME.get(effect)
    if known is not None and parameter in known.accepts:
        return known.accepts[parameter].unit
    return unit_of_name(parameter)


def scaled(value: float, unit: str) -> tuple[float, str]:
    """Return factor and unit in which a value in SI is read most easily: mm, ms, degrees."""
    if unit == "m" and abs(value) < SMALL_M:
        return 1e3, "mm"
    if unit == "s" and abs(value) < SMALL_S:
        return 1e3, "ms"
    if unit == "rad":
        return math.degrees(1.0), "deg"
    if unit == "s/m":  # a share per speed
        return 100.0, "% per m/s"
    return 1.0, "" if unit == "1" else unit


def label(parameter: str, unit: str) -> str:
    """Return a parameter's name without its unit: ``lag_s`` -> ``lag``."""
    ending = "_" + unit.replace("/(", "_").replace(")", "").replace("/", "_").replace(" ", "_")
    return parameter.removesuffix(ending).replace("_", " ")


def location_words(location: str) -> str:
    """Return a location as text."""
    if "." in location:
        return declared_words(location)
    return "all load cells" if location == "all" else location


def place_words(place: EffectAt) -> str:
    """Return ``effect at place`` as text."""
    return f"{place.effect.replace('_', ' ')} at {location_words(place.location)}"


def claim_words(
    place: EffectAt,
    alternatives: Sequence[EffectAt],
    along: Sequence[str] = (),
    *,
    told: bool = True,
) -> str:
    """Return an effect at its place, with all that cannot be told from it, ``along`` the web.

    ``told``: it is said that they are not told apart.
    """
    if not alternatives:
        return place_words(place)
    same = [p.location for p in (place, *alternatives) if p.effect == place.effect]
    others = [place_words(p) for p in alternatives if p.effect != place.effect]
    where = listed([location_words(name) for name in same], along, "" if others else "or")
    mine = f"{place.effect.replace('_', ' ')} at {where}"
    *first, last = [mine, *others]
    said = f"{', '.join(first)} or {last}" if first else last
    return f"{said} (not told apart)" if told else said


def remedy(finding: EffectFinding) -> str:
    """Return what to do about an effect, by what of it was found, without a stop at its end."""
    _, text = BY_NAME[finding.place.effect].words(finding.parameters)
    return text.format(place=location_words(finding.place.location))


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberRow:
    """One parameter of a finding as text; ``low`` and ``high`` (95 %) are empty without interval.

    ``value`` is ``NOT_SHOWN`` where the records do not tell the number from its absence.
    ``is_open``: they do not tell its sign either.
    """

    key: str
    name: str
    value: str
    unit: str = ""
    low: str = ""
    high: str = ""
    is_open: bool = False


def number_rows(finding: EffectFinding) -> list[NumberRow]:
    """Return the parameters of an effect as text; what load cells have, cell by cell."""
    cells = _cell_rows(finding)
    in_cells = _names_in_pairs(finding.place.effect) if cells else set()
    rows = [
        replace(
            _number_row(finding.place.effect, key, value, finding.interval95.get(key)),
            name=called(finding, key),
        )
        for key, value in finding.parameters.items()
        if key not in in_cells
    ]
    if finding.becomes is not None:
        own = BY_NAME[finding.place.effect].shifted_by
        rows = [_becoming(finding, finding.becomes) if r.key == own else r for r in rows]
    return [*rows, *cells, *_moment_rows(finding)]


def _becoming(finding: EffectFinding, change: NumberChange) -> NumberRow:
    """Return from what to what a declared number changed, in its own unit."""
    location, ends = finding.place.location, (change.low, change.high)
    unit = "N" if location.endswith(".offset") else unit_of_name(location.rpartition(".")[2])
    places = _decimals(1.0, ends)
    low, high = (f"{end:{places}}" for end in ends)
    before = " ".join(filter(None, (f"{change.before:.4g}", unit)))
    return NumberRow(
        key=BY_NAME[finding.place.effect].shifted_by,
        name=f"from {before} to",
        value=f"{change.after:{places}}",
        unit=unit,
        low=low,
        high=high,
    )


def called(finding: EffectFinding, parameter: str) -> str:
    """Return what a reader calls a parameter, in the form in which the effect was found."""
    known = BY_NAME.get(finding.place.effect)
    row = known.accepts.get(parameter) if known is not None else None
    names = dict(row.called) if row is not None else {}
    at = finding.begins
    if known is not None and known.onset is not None and at is not None:
        names |= {"": f"in {at.record} from"} if known.onset.moment == parameter else {}
    words = [str(value) for value in finding.parameters.values() if isinstance(value, str)]
    found = next((names[word] for word in (*words, "") if word in names), "")
    return found or label(parameter, unit_of(finding.place.effect, parameter))


def _moment_rows(finding: EffectFinding) -> list[NumberRow]:
    """Return when an effect begins by the clock of the record, where it has a moment."""
    at, known = finding.begins, BY_NAME.get(finding.place.effect)
    moment = known.onset if known is not None else None
    if at is None or (moment and moment.unit == "s" and moment.moment in finding.parameters):
        return []
    name = f"after the start of {at.record}"
    return [NumberRow(key=at.record, name=name, value=f"{at.time_s:.1f}", unit="s")]


def _names_in_pairs(effect: str) -> set[str]:
    pairs = BY_NAME[effect].quadratures
    return {name for p in pairs for name in (p.cos, p.sin, p.amplitude, p.angle)}


def _cell_rows(finding: EffectFinding) -> list[NumberRow]:
    """Return the size in every load cell, where an effect is in all and not alike; else nothing.

    Equation: |c_1 + d_k| of the first cell's phasor and what cell k has more; no interval but the
    first's is known.
    """
    known, values = BY_NAME.get(finding.place.effect), finding.parameters
    if known is None or known.pairs != "cells" or finding.place.location != "all":
        return []
    pairs = [p for p in known.quadratures if p.cos in values and p.sin in values]
    if len(pairs) < 2:  # one phasor, of every cell
        return []
    parts = [complex(float(values[p.cos]), float(values[p.sin])) for p in pairs]
    sizes = [abs(parts[0]), *(abs(parts[0] + more) for more in parts[1:])]
    unit = unit_of(known.name, pairs[0].cos)
    rows = []
    for k, size in enumerate(sizes):
        cell = finding.cells[k] if k < len(finding.cells) else f"cell {k + 1}"
        ends = finding.interval95.get(pairs[0].amplitude) if k == 0 else None
        low, high = (f"{end:.4g}" for end in ends) if ends else ("", "")
        name = f"amplitude at {without_unit(cell)}"
        rows.append(
            NumberRow(key=cell, name=name, value=f"{size:.4g}", unit=unit, low=low, high=high)
        )
    return rows


def _number_row(
    effect: str, key: str, value: Value, interval: tuple[float, float] | None
) -> NumberRow:
    unit = unit_of(effect, key)
    name = label(key, unit)
    if isinstance(value, str):
        return NumberRow(key=key, name=name, value=value.replace("_", " "))
    hidden = interval is not None and not_shown(effect, key, value)
    largest = max(interval, key=abs) if interval is not None and hidden else value
    factor, shown = scaled(largest, unit)
    places = _decimals(factor, interval)
    low, high = (f"{factor * end:{places}}" for end in interval) if interval else ("", "")
    text = NOT_SHOWN if hidden else f"{factor * value:{places}}"
    is_open = interval is not None and interval[0] < 0.0 < interval[1]
    return NumberRow(
        key=key, name=name, value=text, unit=shown, low=low, high=high, is_open=is_open
    )


def _decimals(factor: float, interval: tuple[float, float] | None) -> str:
    """Return the format of a number: the last digit is no larger than half its interval.

    What rounds to 0 has no sign.
    """
    half = 0.5 * abs(factor) * (interval[1] - interval[0]) if interval is not None else 0.0
    if not math.isfinite(half) or half <= 0.0:
        return ".4g"
    if interval is not None and 0.0 in interval:  # a bound, no value give or take something
        return ".3g"
    decimals = math.ceil(-math.log10(half) - ROUNDING)
    return f"z.{max(0, decimals)}f" if decimals <= MOST_DECIMALS else ".4g"


def not_shown(effect: str, parameter: str, value: float) -> bool:
    """Return whether a strength that has an interval is absent: no record shows it."""
    known = BY_NAME.get(effect)
    row = known.accepts.get(parameter) if known is not None else None
    return row is not None and row.role == "strength" and value == row.default


def tells_size(effect: str, parameter: str) -> bool:
    """Return whether a parameter says how much of an effect there is: no component, no angle."""
    known = BY_NAME.get(effect)
    if known is None or parameter not in known.accepts:
        return True
    row = known.accepts[parameter]
    components = {name for pair in known.quadratures for name in (pair.cos, pair.sin)}
    return row.role != "angle" and not row.detail and parameter not in components


def assumed(effect: str, parameter: str) -> bool:
    """Return whether the library has a single value for a number, its own unless it was fitted."""
    known = BY_NAME.get(effect)
    row = known.accepts.get(parameter) if known is not None else None
    return row is not None and row.role in ("option", "shape") and len(row.tries) == 1


def size_of(finding: EffectFinding) -> str:
    """Return how much of an effect there is, with units and 95 % intervals."""
    sizes, effect = [], finding.place.effect
    rows = number_rows(finding)
    for number in [n for n in rows if not n.is_open] or rows:
        if number.key not in finding.parameters:
            sizes.append(f"{number.value} {number.unit} {number.name}")
            continue
        if not tells_size(effect, number.key):
            continue
        name = "" if isinstance(finding.parameters[number.key], str) else f"{number.name} "
        sizes.append(f"{name}{_with_interval(effect, number, finding.parameters[number.key])}")
    return ", ".join([*sizes, *_orders_of(finding)])


def _with_interval(effect: str, number: NumberRow, value: Value) -> str:
    """Return a number with its unit and, where it was fitted, its interval."""
    if number.value == NOT_SHOWN:
        return f"{NOT_SHOWN}: between {number.low} and {number.high} {number.unit}".rstrip()
    text = f"{number.value} {number.unit}".rstrip()
    taken = assumed(effect, number.key) and value == BY_NAME[effect].accepts[number.key].tries[0]
    taken = taken and not (number.low and number.key in BY_NAME[effect].fitted)
    if taken and number.low:
        return f"{text} (assumed; it may be {number.low} to {number.high})"
    if taken:
        return f"{text} (assumed; the others hold for it)"
    return f"{text} (95 %: {number.low} to {number.high})" if number.low else text


def _orders_of(finding: EffectFinding) -> list[str]:
    """Return the largest orders of an effect that has no other size, with units."""
    known = BY_NAME.get(finding.place.effect)
    values = finding.parameters
    if known is None or known.pairs != "orders":
        return []
    if known.profiles is not None and known.profiles.size in values:
        return []
    sizes = [
        (math.hypot(float(values[pair.cos]), float(values[pair.sin])), order, pair.cos)
        for order, pair in enumerate(known.quadratures, start=1)
        if not pair.amplitude and pair.cos in values and pair.sin in values
    ]
    shown = sorted(sorted(sizes, reverse=True)[:SHOWN_ORDERS], key=lambda row: row[1])
    orders = []
    for size, order, name in shown:
        factor, unit = scaled(size, unit_of(finding.place.effect, name))
        orders.append(f"{order}x {factor * size:.4g} {unit}")
    return orders


def coordinate_text(
    kind: str,
    where: Mapping[str, float | str],
    begins: Moment | None = None,
    also: Sequence[tuple[str, Mapping[str, float | str]]] = (),
    tolerances: Mapping[str, float] = NO_TOLERANCE,
) -> str:
    """Return what is known of an unknown as text; ``begins`` names the record of an event.

    One of a record held out names it itself. ``tolerances`` are those of declared numbers.
    ``also`` are kinds and coordinates of spectral lines that the records do not tell from it.
    """
    if also:
        rows = [_periodic_text(k, w, every_speed=False) for k, w in ((kind, where), *also)]
        return f"{', or else '.join(rows)} (one speed does not tell which)"
    if kind in ("time", "travel", "angle"):
        return _periodic_text(kind, where)
    if kind == "event":
        name = where.get("held_out") if begins is None else begins.record
        record = f" of {name}" if name else ""
        return (
            f"an event at {float(where['from_s']):.2f} s{record} in {where['zone']}, first seen "
            f"in {where['channel']}; ask what was done on the line then"
        )
    if kind == "state":
        return _state_text(where, tolerances)
    if "channels" in where:
        band = f"{where['from_Hz']:.3g} to {where['to_Hz']:.3g} Hz"
        return (
            f"something irregular that pushes the line: at {band} {where['channels']} do not move "
            "together as the declared noise does; look at the drive and the web between them"
        )
    return "noise above the line's own, at no frequency in particular"


def _state_text(where: Mapping[str, float | str], tolerances: Mapping[str, float]) -> str:
    if "gap_N" in where:
        others = f" (and {where['also_in']} alike)" if "also_in" in where else ""
        return (
            f"{where['channel']}{others} depends on which way the tension went last, "
            f"{float(where['gap_N']):.2g} N apart, while the speeds tell it otherwise: so reads a "
            "cell at which something sticks or has play, and a loop that holds it hunts"
        )
    name, far = str(where["declared"]), float(where["standard_deviations"])
    off = f"{far:+.3g} standard deviations"
    if name in tolerances:  # two standard deviations
        off = f"{shift_text(name, 0.5 * far * tolerances[name])} (tolerance "
        off += f"{shift_text(name, tolerances[name]).lstrip('+')})"
    return (
        f"the records want {declared_words(name)} {off} from where it is declared, so the "
        "cause lies there or imitates it"
    )


def declared_words(number: str) -> str:
    """Return a declared number as text, with its path in the line file."""
    *where, key = number.split(".")
    plain = key.replace("kelvin_voigt_eta", "inner_damping").split("_kg")[0]
    plain = without_unit(plain.removesuffix("_s")).replace("_", " ")
    return f"{plain} of {where[-1]} ({number})" if where else number


def shift_text(number: str, change: float) -> str:
    """Return a change of a declared number as its tolerance counts it, with its unit."""
    if number.endswith(".offset"):
        return f"{change:+.3g} N"
    if number.endswith("_draw"):
        return f"{change:+.3g} (absolute)"
    return f"{100.0 * change:+.3g} %"


def _strongest(where: Mapping[str, float | str]) -> str:
    """Return how it goes on where something in time is strongest."""
    zone = f", strongest in {where['channel']}, in {where['zone']}" if "zone" in where else ""
    return f" at every speed{zone}"


def _periodic_text(
    kind: str, where: Mapping[str, float | str], *, every_speed: bool = True
) -> str:
    if kind == "time" and "period_s" in where:
        text = f"something that comes again every {float(where['period_s']):.4g} s"
        return text + (_strongest(where) if every_speed else "")
    if kind == "time":
        text = f"something that repeats in time, {where['frequency_Hz']:.4g} Hz"
        return text + (_strongest(where) if every_speed else "")
    if kind == "angle":
        return f"something that repeats {where['order']:.4g} times per turn of {where['roll']}"
    wavenumber = float(where["wavenumber_1_m"])
    return (
        f"something that repeats every {1e3 / wavenumber:.4g} mm of web ({wavenumber:.5g} "
        f"1/m); a roller of {1e3 * float(where['equivalent_radius_m']):.4g} mm radius turns so"
    )
