"""What follows from a site file, for eyes: frequencies, counts, words, defaults in use."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from aff_runtime.config.crossings import Crossing, crossings_of, frequency_Hz
from aff_runtime.config.findings import dotted
from aff_runtime.config.leaves import leaves
from aff_runtime.config.models import Site
from aff_runtime.config.registers import Row, block_of, read_rows, write_rows
from aff_runtime.config.revision import revision_hash


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderFact:
    """One order of one actuator at one speed and radius."""

    actuator: str
    roll: str
    order: int
    speed_m_s: float
    radius_m: float
    frequency_Hz: float
    samples_per_period: float

    @property
    def per_minute(self) -> float:
        """Return the frequency in periods per minute (rpm of order 1)."""
        return self.frequency_Hz * 60.0

    def __str__(self) -> str:
        """Return one line for eyes."""
        return (
            f"{self.actuator}: {self.roll} {self.order}x at {self.speed_m_s:.3f} m/s, "
            f"R {self.radius_m:.4f} m: {self.frequency_Hz:.4f} Hz = {self.per_minute:.1f} rpm, "
            f"{self.samples_per_period:.1f} samples per period"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitFact:
    """One limit in counts of its correction word."""

    path: str
    value: float
    unit: str
    counts: float

    def __str__(self) -> str:
        """Return one line for eyes."""
        return f"{self.path}: {self.value:g} {self.unit} = {self.counts:.0f} counts"


@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """Everything derived from one site.

    ``read_block`` and ``write_block`` are (first wire address, words); ``defaults`` are lines
    ``path: value`` of keys that the file does not give.
    """

    revision: str
    orders: tuple[OrderFact, ...]
    limits: tuple[LimitFact, ...]
    crossings: tuple[tuple[str, Crossing], ...]
    rows: tuple[Row, ...]
    read_block: tuple[int, int]
    write_block: tuple[int, int]
    defaults: tuple[str, ...]

    @property
    def words_per_tick(self) -> int:
        """Return the Modbus words that travel in one tick, both ways together."""
        return self.read_block[1] + self.write_block[1]


def facts_of(site: Site, speeds_m_s: tuple[float, ...] = ()) -> Facts:
    """Return what follows from a valid site, at ``speeds_m_s`` (none: the highest speed)."""
    read, write = read_rows(site), write_rows(site)
    speeds = speeds_m_s or (site.speed_max_m_s,)
    return Facts(
        revision=revision_hash(site),
        orders=tuple(_orders(site, speeds)),
        limits=tuple(_limits(site)),
        crossings=tuple(
            (name, crossing)
            for name, actuator in site.actuators.items()
            for crossing in crossings_of(site, actuator)
        ),
        rows=(*read, *write),
        read_block=block_of(read),
        write_block=block_of(write),
        defaults=tuple(
            f"{dotted(leaf.path)}: {leaf.shown}"
            for leaf in leaves(site)
            if not leaf.given and leaf.value is not None
        ),
    )


def _orders(site: Site, speeds_m_s: tuple[float, ...]) -> Iterator[OrderFact]:
    for name, actuator in site.actuators.items():
        for block in actuator.blocks:
            roll = site.rolls[block.roll]
            radii = {roll.smallest_radius_m, roll.largest_radius_m}
            for order in block.orders:
                for speed in speeds_m_s:
                    for radius in sorted(radii):
                        frequency = frequency_Hz(order, speed, radius)
                        yield OrderFact(
                            actuator=name,
                            roll=block.roll,
                            order=order,
                            speed_m_s=speed,
                            radius_m=radius,
                            frequency_Hz=frequency,
                            samples_per_period=1.0 / (frequency * site.cycle_s),
                        )


def _limits(site: Site) -> Iterator[LimitFact]:
    for name, actuator in site.actuators.items():
        scale, unit = site.gateway.write.corrections[name].scale, actuator.unit
        path = f"actuators.{name}"
        counts = actuator.limit / scale
        yield LimitFact(path=f"{path}.limit", value=actuator.limit, unit=unit, counts=counts)
        for index, block in enumerate(actuator.blocks):
            yield LimitFact(
                path=f"{path}.blocks[{index}].amp_limit",
                value=block.amp_limit,
                unit=unit,
                counts=block.amp_limit / scale,
            )
