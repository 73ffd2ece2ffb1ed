"""The error signals of every tick, from the ring to whoever compares ripple."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.app.supervisor.settings.ripple_rise import RippleRise
from aff_runtime.config.models import Site
from aff_runtime.telemetry.ring import RingReader


def hear(ring: RingReader | None, site: Site, ripple: RippleRise) -> None:
    """Hand every tick since the last call to ``ripple``: error signals less their set points."""
    if ring is None:
        return
    wanted = dict(_errors(ring, site))
    time_at = ring.columns.index("time_s")
    for row in ring.signals.read_new():
        readings = {
            name: row[at] - (row[reference] if reference is not None else 0.0)
            for name, (at, reference) in wanted.items()
        }
        ripple.take(row[time_at], readings)


def _errors(ring: RingReader, site: Site) -> Iterator[tuple[str, tuple[int, int | None]]]:
    """Yield the error signals with their columns and those of their set points."""
    at = {name: k for k, name in enumerate(ring.columns)}
    for actuator in site.actuators.values():
        error = actuator.error
        if error.signal in at:
            yield error.signal, (at[error.signal], at.get(error.reference or ""))
