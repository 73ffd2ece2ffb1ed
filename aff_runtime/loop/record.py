"""One row per tick: what was read, wanted, sent, and how long it took."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import NamedTuple

from aff_runtime.base.signals import Permission, Snapshot, State

HEAD = (
    "time_s",
    "tick",
    "periods_count",
    "state",
    "state_bits",
    "alarm",
    "outcome",
    "fresh",
    "age_s",
    "plc_heartbeat",
    "status",
    "roll_id",
    "echo_age",
)
OF_OUTPUTS = ("wanted_", "correction_", "plc_applied_", "applied_ratio_", "limit_ratio_")
TIMING = ("wake_us", "io_us", "tick_us", "missed_count")


class TickTiming(NamedTuple):
    """When a tick was and how long it took.

    Attributes
    ----------
    time_s : whole periods since the control process began to tick, s.
    periods : whole periods since the last tick.
    wake_ns : lateness against the grid; ``io_ns``, ``tick_ns``: how long the exchange with the PLC
        and the tick took.
    missed : ticks that were skipped since then.
    """

    tick: int
    time_s: float
    periods: int
    wake_ns: int
    io_ns: int
    tick_ns: int
    missed: int


def record_columns(
    channels: Sequence[str], outputs: Sequence[str], law_names: Sequence[str]
) -> tuple[str, ...]:
    """Return the columns of ``build_record``; ``outputs`` are names with unit (unwind_m_s).

    A row's ``correction_`` goes out with the next tick; ``plc_applied_`` is what the PLC says it
    adds from this row's readings on, NaN where the site maps no such word; ``echo_age`` says how
    many ticks ago the command went out that the PLC has taken for it, -1 where none is mapped.
    """
    return (
        *HEAD,
        *channels,
        *(f"{kind}{output}" for kind in OF_OUTPUTS for output in outputs),
        *TIMING,
        *law_names,
    )


def build_record(
    *,
    snapshot: Snapshot,
    state: State,
    state_bits: int,
    alarm: int,
    wanted: tuple[float, ...],
    corrections: tuple[float, ...],
    permission: Permission,
    timing: TickTiming,
    law_values: tuple[float, ...],
    law_columns: int,
) -> tuple[float, ...]:
    """Return one row; a law with more or fewer numbers than ``law_columns`` is cut or filled."""
    missing = (nan,) * (law_columns - len(law_values))
    applied = snapshot.applied or (nan,) * len(corrections)
    return (
        timing.time_s,
        timing.tick,
        timing.periods,
        state,
        state_bits,
        alarm,
        snapshot.outcome,
        snapshot.fresh,
        snapshot.age_s,
        snapshot.plc_heartbeat,
        snapshot.status,
        snapshot.roll_id,
        snapshot.echo_age,
        *snapshot.values,
        *wanted,
        *corrections,
        *applied,
        *permission.applied_ratio,
        *permission.limit_ratio,
        timing.wake_ns * 1e-3,
        timing.io_ns * 1e-3,
        timing.tick_ns * 1e-3,
        timing.missed,
        *law_values[:law_columns],
        *missing,
    )
