"""Rows of all looks as one table: line, effect, size, trend, what to do, how sure."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from datetime import date
from pathlib import Path
from typing import get_type_hints

import numpy as np

from aff_runtime.base.confidence import TWO_SIDED_95
from aff_runtime.base.errors import PlantError
from sim_plant.base.effects import Effect
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.fleet.refine_look import LookResult
from sim_plant.refine.report.verdict import Ambiguity, ChannelRms, EffectFinding

SURE = 4.0
"""Standard deviations of a slope that is told: of hundreds of lines one were else told daily."""
DAYS = 30.0
APART = 1.02
"""Orders or frequencies of a smaller ratio are one: what a fit may differ by from look to look."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One row of the table: an effect of a line on a day, or that there is none.

    Attributes
    ----------
    line, recorded : which line, which day.
    verdict : ``traced``, ``not_identifiable``, ``unknown``, ``nothing`` or ``failed``.
    effect, place, number, size, size_low, size_high, unit : what, where, how large (95 %).
    tone : order or frequency (Hz) of an effect that may show at any; else NaN.
    trend, trend_low, trend_high : change of ``size`` in 30 days, where it is sure; else NaN.
    sure : ``named``, ``one of several``, ``no known effect`` or empty.
    to_do : what to do at the machine, or what went wrong.
    error_before, error_after : of the worst tension on the record held out, in noise floors.
    declared : which line file it was told under, the first digits of its hash.
    """

    line: str
    recorded: str
    verdict: str
    effect: str = ""
    place: str = ""
    number: str = ""
    size: float = math.nan
    size_low: float = math.nan
    size_high: float = math.nan
    unit: str = ""
    tone: float = math.nan
    trend: float = math.nan
    trend_low: float = math.nan
    trend_high: float = math.nan
    sure: str = ""
    to_do: str = ""
    error_before: float = math.nan
    error_after: float = math.nan
    declared: str = ""


def findings_of(result: LookResult) -> Iterator[Finding]:
    """Yield the findings of one look."""
    plain = Finding(
        line=result.line, recorded=result.recorded, verdict=result.answer, declared=result.declared
    )
    verdict = result.verdict
    if verdict is None:
        yield replace(plain, to_do=result.error)
        return
    before, after = _worst_tension(verdict.residual_rms)
    plain = replace(plain, error_before=before, error_after=after)
    alike = {item.place: item for item in verdict.ambiguous}
    for found in verdict.effects:
        yield _effect(plain, found, alike.get(found.place))
    for left in verdict.unknown:
        yield replace(
            plain,
            effect=f"unknown, {left.unknown_class}",
            place=", ".join(f"{key} {_short(value)}" for key, value in left.coordinate.items()),
            sure="no known effect",
            to_do="look at the report: no effect of the library explains this",
        )
    if not verdict.effects and not verdict.unknown:
        yield plain


def _effect(plain: Finding, found: EffectFinding, alike: Ambiguity | None) -> Finding:
    effect, place = BY_NAME[found.place.effect], found.place.location
    number = next((q.amplitude for q in effect.quadratures if q.amplitude), effect.fitted[0])
    low, high = found.interval95.get(number, (math.nan, math.nan))
    to_do, sure = effect.words(found.parameters)[1].format(place=place), "named"
    if alike is not None:
        sure = "one of several"
        others = ", ".join(map(str, alike.alternatives))
        to_do = f"to tell it from {others}: " + "; ".join(alike.experiments)
    return replace(
        plain,
        effect=effect.name,
        place=place,
        number=number,
        size=float(found.parameters.get(number, math.nan)),
        size_low=float(low),
        size_high=float(high),
        unit=effect.accepts[number].unit,
        tone=_tone(effect, found.parameters),
        sure=sure,
        to_do=to_do,
    )


def _tone(effect: Effect, parameters: Mapping[str, float | str]) -> float:
    """Return what tells two effects of a kind at one place apart, where a number does."""
    name = effect.shows.parameter if effect.shows is not None else ""
    if name not in effect.accepts:
        return math.nan
    return float(parameters.get(name, effect.accepts[name].default))


def _worst_tension(rms: Mapping[str, ChannelRms]) -> tuple[float, float]:
    rows = [row for name, row in rms.items() if name.endswith("_N") and row.noise_floor > 0.0]
    if not rows:
        return math.nan, math.nan
    before = max(row.before / row.noise_floor for row in rows)
    return before, max(row.after / row.noise_floor for row in rows)


def _short(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"


def with_trends(findings: Sequence[Finding]) -> list[Finding]:
    """Return the findings, the last of each effect with its change over the days seen.

    Equation: weighted least squares of size over days, weights from the 95 % intervals; told
    beyond ``SURE`` standard deviations of the slope, from three days on  [own].
    """
    told = list(findings)
    for places in _series(findings):
        places.sort(key=lambda at: findings[at].recorded)
        slope, deviation = slope_of([findings[at] for at in places])
        if deviation > 0.0 and abs(slope) > SURE * deviation:
            last, half = places[-1], TWO_SIDED_95 * deviation
            told[last] = replace(
                told[last],
                trend=DAYS * slope,
                trend_low=DAYS * (slope - half),
                trend_high=DAYS * (slope + half),
            )
    return told


def _series(findings: Sequence[Finding]) -> Iterator[list[int]]:
    """Yield the places in the list of what is one effect, seen again and again.

    A size is that of what a line file lacks: under another file it is another quantity.
    """
    kinds: dict[tuple[str, ...], list[int]] = {}
    for at, found in enumerate(findings):
        if np.isfinite([found.size, found.size_low, found.size_high]).all():
            key = (found.line, found.declared, found.effect, found.place, found.number)
            kinds.setdefault(key, []).append(at)
    for places in kinds.values():
        places.sort(key=lambda at: findings[at].tone)
        one = places[:1]
        for at in places[1:]:
            if findings[at].tone > APART * findings[one[-1]].tone:
                yield one
                one = []
            one.append(at)
        yield one


def slope_of(series: Sequence[Finding]) -> tuple[float, float]:
    """Return the change of the size per day and its standard deviation; (0, 0) below three days.

    Scatter beyond the intervals widens the deviation.
    """
    days = np.array([float(date.fromisoformat(f.recorded).toordinal()) for f in series])
    if np.unique(days).size < 3:
        return 0.0, 0.0
    size = np.array([f.size for f in series])
    sd = np.array([(f.size_high - f.size_low) / (2.0 * TWO_SIDED_95) for f in series])
    weight = 1.0 / np.maximum(sd, 1e-12 * np.abs(size).max()) ** 2
    centred = days - np.average(days, weights=weight)
    power = float(np.sum(weight * centred**2))
    slope = float(np.sum(weight * centred * size) / power)
    rest = size - np.average(size, weights=weight) - slope * centred
    spread = float(np.sum(weight * rest**2)) / (len(series) - 2)
    return slope, float(np.sqrt(max(1.0, spread) / power))


def write_parquet(findings: Sequence[Finding], path: Path) -> None:
    """Write the table for DuckDB or pandas; what a column means goes with it.

    Raises
    ------
    PlantError
        When Parquet is not installed.
    """
    try:
        import pyarrow as pa  # noqa: PLC0415 (an extra)
        import pyarrow.parquet as pq  # noqa: PLC0415
    except ImportError as error:
        raise PlantError("a Parquet table needs: pip install 'aff-runtime[records]'") from error
    kinds = {float: pa.float64(), str: pa.string()}
    hints = get_type_hints(Finding)
    columns = {f.name: kinds[hints[f.name]] for f in fields(Finding)}
    columns["recorded"] = pa.date32()
    rows = [asdict(f) | {"recorded": date.fromisoformat(f.recorded)} for f in findings]
    table = pa.Table.from_pylist(rows, schema=pa.schema(columns))
    meaning = {"units": "size, size_low, size_high: SI, named in `unit`; trend: that per 30 days"}
    pq.write_table(table.replace_schema_metadata(meaning), path)
