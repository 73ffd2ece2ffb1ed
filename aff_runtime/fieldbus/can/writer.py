"""One command to its CAN frames at the speed of the control tick."""

from __future__ import annotations

from aff_runtime.base.signals import Command
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.layout import CanMap, Field, FrameLayout


class CanWriter:
    """Packs one command into its frames.

    Corrections are rounded to counts and clipped to bits and range of their signal; a value that
    is not finite, or missing, goes out as the count of 0. A multiplexed frame goes round its
    selectors, one each tick.
    """

    def __init__(self, can_map: CanMap) -> None:
        self._corrections = tuple(_write_row(c.field, c.scale) for c in can_map.corrections)
        sources: dict[str, int] = {}
        words = (can_map.aff_heartbeat, can_map.state, can_map.echo, can_map.alarm, can_map.limit)
        for index, field in enumerate((*words, can_map.config_revision)):
            if field is not None:
                sources[str(field)] = index
        for index, correction in enumerate(can_map.corrections):
            sources[str(correction.field)] = 6 + 2 * index
            if correction.complement is not None:
                sources[str(correction.complement)] = 7 + 2 * index
        self._limit_most = can_map.limit.mask if can_map.limit is not None else 0
        self._raws = [0] * (6 + 2 * len(can_map.corrections))
        self._frames = tuple(
            _write_frame(layout, can_map.write_fields, sources)
            for layout in can_map.frames_of(can_map.write_fields)
        )

    @property
    def ids(self) -> tuple[tuple[int, bool], ...]:
        """Return identifier and format of every frame that is written."""
        return tuple((layout.can_id, layout.extended) for layout, _ in self._frames)

    def encode(self, command: Command) -> list[Frame]:
        """Return the frames of one tick, in the order of the map."""
        raws = self._raws
        raws[0], raws[1] = command.heartbeat, command.state_bits
        raws[2], raws[3], raws[5] = command.echo, command.alarm, command.config_revision
        given = len(command.corrections)
        for index, (scale, zero, least, most, per_count) in enumerate(self._corrections):
            counts = command.corrections[index] * scale if index < given else 0.0
            raw = zero + round(counts) if -1e18 < counts < 1e18 else zero
            raw = least if raw < least else most if raw > most else raw
            raws[6 + 2 * index], raws[7 + 2 * index] = raw, ~raw
            if index == 0:
                limit = command.limits[0] / per_count if command.limits else 0.0
                raws[4] = round(min(limit, self._limit_most)) if limit > 0.0 else 0
        frames = []
        for layout, variants in self._frames:
            little = big = 0
            for source, value, mask, shift, is_big in variants[command.heartbeat % len(variants)]:
                bits = ((value if source < 0 else raws[source]) & mask) << shift
                if is_big:
                    big |= bits
                else:
                    little |= bits
            if little:
                big |= int.from_bytes(little.to_bytes(layout.length, "little"), "big")
            frames.append(
                Frame(layout.can_id, layout.extended, big.to_bytes(layout.length, "big"))
            )
        return frames


_Packing = tuple[int, int, int, int, bool]


def _write_frame(
    layout: FrameLayout, fields: tuple[Field, ...], sources: dict[str, int]
) -> tuple[FrameLayout, tuple[tuple[_Packing, ...], ...]]:
    mine = [field for field in fields if field.frame == layout.name]
    selectors = sorted({field.selector for field in mine if field.selector is not None})
    variants = []
    choices: list[int | None] = [*selectors] or [None]
    for selector in choices:
        rows = [
            (sources[str(field)], 0, field.mask, field.shift, field.big_endian)
            for field in mine
            if field.selector in (None, selector)
        ]
        if layout.multiplexer is not None and selector is not None:
            field = layout.multiplexer
            rows.append((-1, selector, field.mask, field.shift, field.big_endian))
        if layout.counter is not None:
            field = layout.counter
            rows.append((0, 0, field.mask, field.shift, field.big_endian))
        variants.append(tuple(rows))
    return layout, tuple(variants)


def _write_row(field: Field, scale: float) -> tuple[float, int, int, int, float]:
    """Return counts per SI, count of zero, least and largest count, |SI| of one count."""
    least, most = field.sent_counts
    per_count = abs(scale * field.factor)
    zero = round(-field.offset / field.factor)
    return 1.0 / (scale * field.factor), zero, least, most, per_count
