"""A line over weeks for a screen: what its store says, runs that are taken into it, exchanges."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from aff_runtime.app.commission.link.answers import Answer, Done, MaintenanceShown
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.records.run_list import runs_folder
from aff_runtime.app.commission.views.of_weeks import (
    FitRow,
    LifeRow,
    MaintenanceView,
    MedianRow,
    RankingRow,
    ReachedRow,
    Reading,
    SlopeRow,
    SupplierRankingRow,
    SupplierRow,
    TrendRow,
    WorstRow,
    WoundRow,
)
from aff_runtime.app.report.watching import ingest, sentences
from aff_runtime.app.report.watching.findings import QUANTITIES, Finding, findings, unread
from aff_runtime.app.report.watching.lives import Life, lives
from aff_runtime.app.report.watching.store import Store, load_store
from aff_runtime.app.report.watching.suppliers import (
    ORDERS,
    Supplier,
    SupplierRanking,
    supplier_rankings,
)
from aff_runtime.app.report.watching.trend import Slope
from aff_runtime.app.report.watching.wound_rolls import OrderSize, Ranking, WoundRoll, rankings
from aff_runtime.app.supervisor.settings.history import kept_folder
from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.numbers import finite_or_none
from aff_runtime.base.runs.window import names_a_run

MOST_READINGS = 120
"""Points of a trend on the screen; where there are more readings, each is a mean of neighbours."""
MOST_TRENDS, MOST_ROLLS = 400, 200
WEEK_S = 7.0 * 86400.0
PER_1000_KM = 1000.0
SECOND = np.timedelta64(1, "s")
EPOCH = np.datetime64("1970-01-01", "us")


def store_of(where: Paths) -> Path:
    """Return the folder of the line's store."""
    return where.watch or kept_folder(where.site, where.state, "watch")


def maintenance(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return everything that the store says."""
    folder = store_of(where)
    try:
        store = load_store(folder)
    except ConfigError as error:
        view = MaintenanceView(store=str(folder), nothing=str(error))
        return MaintenanceShown(maintenance=view)
    return MaintenanceShown(maintenance=maintenance_view(folder, store))


def add_runs(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Take what is new of the recorded runs into the store."""
    folder = runs_folder(where)
    try:
        runs = sorted(one for one in folder.iterdir() if names_a_run(one))
    except OSError as error:
        raise RefusedError(f"{folder}: {error.strerror}") from None
    if not runs:
        raise RefusedError(f"{folder}: holds no run yet")
    taken = ingest.ingest_runs(store_of(where), runs, talk.say, talk.complain)
    return Done(text=f"runs tried: {taken.runs}, left out: {taken.refused}")


def exchange(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Begin a new life of a roller that was exchanged."""
    on = ingest.parse_utc(asked.on)
    why = f"{asked.reason} ({asked.account} at the screen)" if asked.reason else asked.account
    ingest.exchange(store_of(where), asked.roll, on, why)
    return Done(text=f"{asked.roll}: a new life from {on:%Y-%m-%d %H:%M} UTC")


# --- the view -----------------------------------------------------------------------------------


def maintenance_view(folder: Path, store: Store) -> MaintenanceView:
    """Return what a screen is shown of a store."""
    now = ingest.parse_utc(wall_time_iso())
    found = findings(store, now=now)
    times = store.hours["time_utc"]
    ranked = rankings(store)
    nothing = "none of the rollers in place has been read yet: runs at a steady speed are needed"
    return MaintenanceView(
        store=str(folder),
        nothing="" if found else nothing,
        line=store.line,
        hours=int(times.size),
        from_s=_unix_s(times.min()) if times.size else None,
        to_s=_unix_s(times.max()) if times.size else None,
        web_km=1e-3 * float(np.nansum(store.hours["length_m"])),
        notes=tuple(sentences.notes(found)),
        lives=tuple(_life(one) for one in lives(store)),
        trends=tuple(_trend(one) for one in _first(found)[:MOST_TRENDS]),
        without_a_line=tuple(sentences.unread(unread(store, now=now)[:MOST_TRENDS])),
        rankings=tuple(_ranking(one) for one in ranked),
        suppliers=tuple(_suppliers(one) for one in supplier_rankings(ranked)),
    )


def _first(found: list[Finding]) -> list[Finding]:
    """Return the findings that stand out or jumped, then the others, each in their order."""
    return sorted(found, key=lambda one: not (one.stands_out or one.jump is not None))


def _life(one: Life) -> LifeRow:
    return LifeRow(
        roll=one.roll,
        number=one.number,
        since_s=None if one.since is None else _unix_s(one.since),
        until_s=None if one.until is None else _unix_s(one.until),
        why=one.why,
        web_km=one.web_km,
        running_h=one.running_h,
        turns=one.turns,
    )


def _trend(one: Finding) -> TrendRow:
    readings = one.readings
    unit, factor = sentences.unit_shown(readings.quantity.unit)
    last_s, days = _unix_s(readings.times[-1]), readings.days
    line = one.per_day
    return TrendRow(
        roll=readings.roll,
        order=readings.order,
        signal=readings.signal,
        quantity=readings.quantity.word,
        unit=unit,
        life=readings.life,
        count=int(readings.size.size),
        left_out=readings.left_out,
        speed_m_s=readings.at_m_s,
        now=factor * _now(one),
        limit=factor * readings.limit if math.isfinite(readings.limit) else None,
        stands_out=one.stands_out,
        per_1000_km=None if one.per_km is None else _slope(one.per_km, factor),
        line=None
        if line is None
        else FitRow(
            from_size=factor * line.at(float(days[0])), to_size=factor * line.at(float(days[-1]))
        ),
        reached=None if one.weeks is None else _reached(one.weeks, last_s),
        jump_s=None if one.jump is None else _unix_s(readings.times[one.jump.index]),
        readings=_readings(one, factor),
    )


def _now(one: Finding) -> float:
    """Return the size on the line where there is one, else the last reading."""
    if one.per_km is None:
        return float(one.readings.size[-1])
    return one.per_km.at(float(one.readings.travelled_km[-1]))


def _slope(line: Slope, factor: float) -> SlopeRow:
    by = PER_1000_KM * factor
    return SlopeRow(value=by * line.value, low=by * line.low, high=by * line.high)


def _reached(weeks: tuple[float, float, float], last_s: float) -> ReachedRow:
    value, low, high = (last_s + WEEK_S * one for one in weeks)
    return ReachedRow(at_s=value, early_s=low, late_s=high if math.isfinite(high) else None)


def _readings(one: Finding, factor: float) -> tuple[Reading, ...]:
    readings = one.readings
    times = (readings.times - EPOCH) / SECOND
    parts = np.array_split(np.arange(times.size), min(times.size, MOST_READINGS))
    return tuple(
        Reading(
            at_s=float(times[part].mean()),
            size=factor * float(readings.size[part].mean()),
            error=factor * float(np.sqrt((readings.error[part] ** 2).mean() / part.size)),
        )
        for part in parts
    )


def _ranking(one: Ranking) -> RankingRow:
    return RankingRow(
        roll=one.roll,
        by="" if one.by is None else one.by.word,
        rolls=tuple(_wound(roll) for roll in one.rolls[:MOST_ROLLS]),
    )


def _suppliers(one: SupplierRanking) -> SupplierRankingRow:
    unit, factor = sentences.unit_shown(one.by.unit)
    return SupplierRankingRow(
        roll=one.roll,
        by=one.by.word,
        unit=unit,
        orders=ORDERS,
        suppliers=tuple(_supplier(who, one.by.unit, factor) for who in one.suppliers[:MOST_ROLLS]),
        unknown=one.unknown,
    )


def _supplier(one: Supplier, unit: str, factor: float) -> SupplierRow:
    return SupplierRow(
        number=one.number,
        rolls=one.rolls,
        medians=tuple(
            MedianRow(
                order=median.order,
                size=factor * median.size,
                low=finite_or_none(factor * median.low),
                high=finite_or_none(factor * median.high),
            )
            for median in one.medians
        ),
        worst_roll=one.worst_roll,
        worst=_worst(one.worst, unit),
    )


def _wound(one: WoundRoll) -> WoundRow:
    units = {quantity.name: quantity.unit for quantity in QUANTITIES}
    shape, stroke, ripple = (
        _worst(one.worst.get(name), units[name]) for name in ("shape_m", "stroke_m", "ripple_N")
    )
    return WoundRow(
        roll_id=one.roll_id,
        first_s=_unix_s(one.first),
        last_s=_unix_s(one.last),
        hours=one.hours,
        shape=shape,
        stroke=stroke,
        ripple=ripple,
        left=_worst(one.left, units["ripple_N"]),
    )


def _worst(one: OrderSize | None, unit: str) -> WorstRow | None:
    if one is None:
        return None
    shown, factor = sentences.unit_shown(unit)
    return WorstRow(order=one.order, size=factor * one.size, error=factor * one.error, unit=shown)


def _unix_s(moment: np.datetime64) -> float:
    return float((moment - EPOCH) / SECOND)
