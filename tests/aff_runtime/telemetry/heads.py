"""Heads of rings for tests, without a ring."""

from __future__ import annotations

from aff_runtime.telemetry.header import RingHeader, RunMeta


def head_of(meta: RunMeta, start_utc: str = "2026-01-02T03:04:05.678") -> RingHeader:
    """Return the head of a ring with one column."""
    return RingHeader(
        columns=("time_s",),
        capacity=1,
        event_capacity=1,
        signals_at=4096,
        events_at=8192,
        writer_pid=7,
        start_utc=start_utc,
        meta=meta,
    )
