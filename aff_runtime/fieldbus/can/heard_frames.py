"""What was heard of the frames of a map, for eyes: each value from the newest frame that has it.

No control runs on this: it does not ask for a whole set, it says what keeps one from coming.
"""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.heard_values import HeardValues, count_of
from aff_runtime.fieldbus.can.layout import CanMap, FrameLayout


class HeardFrames(HeardValues):
    """Counts and newest bytes per frame; how often the PLC's heartbeat moved.

    Attributes
    ----------
    moves : frames with a heartbeat other than the one before.
    """

    def __init__(self, can_map: CanMap) -> None:
        super().__init__(can_map.frames_of(can_map.read_fields))
        self.moves = 0
        self._map = can_map
        self._strange = dict.fromkeys((x.name for x in self.layouts.values()), 0)
        self._last = -1

    def take(self, frame: Frame) -> FrameLayout | None:
        """Take one frame of the bus; others than the map's are let pass."""
        layout = super().take(frame)
        if layout is not None and layout.name == self._map.plc_heartbeat.frame:
            self._close(count_of(self._map.plc_heartbeat, frame.data))
        return layout

    def frame_lines(self, span_s: float) -> Iterator[str]:
        """Yield one line per frame of the map: how often, its raw bytes, what is wrong with it."""
        for key, layout in self.layouts.items():
            count, data = self.counts[key], self.newest.get(layout.name, b"")
            period = f"{span_s * 1e3 / count:7.2f} ms" if count else "  silent"
            line = f"0x{layout.can_id:03X} {layout.name:20} {count:5} {period}  "
            remark = ""
            if count and self._is_other_length(layout):
                remark = f"  WRONG LENGTH: {len(data)} bytes, the map says {layout.length}"
            yield f"{line}{data.hex(' ').upper()}{remark}"

    def hindrance(self) -> str:
        """Return why no whole set came, in words; empty when nothing is found."""
        silent = [
            f"0x{layout.can_id:03X} {layout.name}"
            for key, layout in self.layouts.items()
            if not self.counts[key]
        ]
        if silent:
            return f"silent: {', '.join(silent)}. Check identifier or node id, and its sender"
        short = [x.name for x in self.layouts.values() if self._is_other_length(x)]
        if short:
            return f"wrong length: {', '.join(short)}. Compare with the sender's mapping"
        strange = [f"{name}.Counter" for name, count in self._strange.items() if count]
        if strange:
            beat = self._map.plc_heartbeat
            return (
                f"{', '.join(strange)} differs from the low bits of {beat}. It must repeat them, "
                f"and {beat.frame} be sent last in a scan"
            )
        return ""

    def _close(self, heartbeat: int) -> None:
        self.moves += self._last not in (-1, heartbeat)
        self._last = heartbeat
        for layout in self.layouts.values():
            counter, data = layout.counter, self.whole(layout)
            if counter is not None and layout.multiplexer is None and data is not None:
                self._strange[layout.name] += count_of(counter, data) != heartbeat & counter.mask

    def _is_other_length(self, layout: FrameLayout) -> bool:
        return len(self.newest.get(layout.name, b"")) != layout.length
