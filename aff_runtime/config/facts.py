"""What follows from a site file, for eyes: frequencies, counts, words, defaults in use."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from aff_runtime.config.findings import dotted
from aff_runtime.config.leaves import leaves
from aff_runtime.config.meetings import Meeting, frequency_Hz, meetings_of
from aff_runtime.config.models import Site
from aff_runtime.config.registers import RegisterSpan, block_of, read_rows, write_rows
from aff_runtime.config.revision import site_hash_of
from aff_runtime.core.bandwidth import Band


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
class ShapeFact:
    """What law shape will do at one speed and radius of its drive's roll."""

    actuator: str
    roll: str
    speed_m_s: float
    radius_m: float
    turn_s: float
    memory_turns: float
    band: Band
    orders_out: int
    orders_fading: int
    orders: int

    def __str__(self) -> str:
        """Return one line for eyes."""
        fading = f", {self.orders_fading} fade" if self.orders_fading else ""
        resting = self.orders - self.orders_out - self.orders_fading
        rest = f", {resting} above {self.band.end_Hz:.0f} Hz rest" if resting else ""
        return (
            f"{self.actuator}: law shape at {self.speed_m_s:.3f} m/s, R {self.radius_m:.4f} m: "
            f"{self.orders_out} of {self.orders} orders of {self.roll} below "
            f"{self.band.full_Hz:.0f} Hz"
            f"{fading}{rest}; memory {self.memory_turns:g} turns = "
            f"{self.memory_turns * self.turn_s:.1f} s"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """Everything derived from one site.

    ``read_block`` and ``write_block`` are (first wire address, words); ``defaults`` are lines
    ``path: value`` of keys that the file does not give.
    """

    site_hash: str
    orders: tuple[OrderFact, ...]
    shapes: tuple[ShapeFact, ...]
    limits: tuple[LimitFact, ...]
    meetings: tuple[tuple[str, Meeting], ...]
    rows: tuple[RegisterSpan, ...]
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
        site_hash=site_hash_of(site),
        orders=tuple(_orders(site, speeds)),
        shapes=tuple(_shapes(site, speeds)),
        limits=tuple(_limits(site)),
        meetings=tuple(
            (name, meeting)
            for name, actuator in site.actuators.items()
            for meeting in meetings_of(site, actuator)
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


def _shapes(site: Site, speeds_m_s: tuple[float, ...]) -> Iterator[ShapeFact]:
    for name, actuator in site.actuators.items():
        if actuator.drive is None or not actuator.uses_shape:
            continue
        roll = site.rolls[actuator.drive.roll]
        orders = [n for b in actuator.blocks if b.roll == actuator.drive.roll for n in b.orders]
        band = actuator.drive.band(site.cycle_s)
        for speed in speeds_m_s:
            for radius in sorted({roll.smallest_radius_m, roll.largest_radius_m}):
                turn_Hz = frequency_Hz(1, speed, radius)
                out = sum(n * turn_Hz <= band.full_Hz for n in orders)
                yield ShapeFact(
                    actuator=name,
                    roll=actuator.drive.roll,
                    speed_m_s=speed,
                    radius_m=radius,
                    turn_s=1.0 / turn_Hz,
                    memory_turns=actuator.memory_turns,
                    band=band,
                    orders_out=out,
                    orders_fading=sum(n * turn_Hz < band.end_Hz for n in orders) - out,
                    orders=len(orders),
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
