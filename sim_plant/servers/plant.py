"""Line and PLC as one machine that advances by one control sample; the clock is elsewhere."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from itertools import islice
from typing import NamedTuple

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Status
from sim_plant.base.ports import RollChanger, SteppedLine, TravelDriver
from sim_plant.servers.extra_words import SUPPLIER, ExtraWords
from sim_plant.servers.faults import Fault, FaultBoard, FaultEdge, FaultSpec, parse_fault
from sim_plant.servers.plc import Plc
from sim_plant.servers.registers import Registers
from sim_plant.servers.web_end import SPEED, WebEnd
from sim_plant.servers.wire_faults import WireFaults

REFERENCES = (SPEED, "tension_ref_N")
_HISTORY_SCANS = 20_000
_ABSURD_SI = 1.0e6
THIRD_M_S = 0.02  # the correction of a third station
_ANOTHER = 0x8000  # heartbeat of another master, far from any young runtime's


class Shown(NamedTuple):
    """What the PLC shows of one scan: its words, its readings and what it says it applies, SI."""

    words: list[int]
    measured: Mapping[str, float]
    applied_m_s: Mapping[str, float]


class Plant:
    """One line under one PLC.

    Time is plant time: the number of samples stepped times the sample time. A PLC that could not
    be run for a while has not lived through that while either.

    Attributes
    ----------
    registers, plc, faults : the parts, for servers and scenarios.
    time_s, scans, plc_scans : plant time, number of samples and of the PLC's scans so far.
    measured : the line's last outputs, faults included.
    applied_m_s : correction added at the plant per actuator in the coming sample.
    shown : what the wire shows of the last scan; old ones by turns while ``turns`` lasts.
    wire_faults : which faults the wire has; None in a scenario that has its own wire.
    max_abs_applied_m_s : largest |correction| per actuator since the last ``reset_extremes``.
    refusal : why the last correction did not count.
    extra : words that are for the runtime's record alone.
    web : what is left on the unwind roll; at its end it stops the line and LINE_RUN is off.
    observers : called after each sample with the plant.
    edge_observers : called when a fault begins or ends.

    Raises
    ------
    PlantError
        The map asks for a channel that the line does not measure.
    """

    def __init__(self, line: SteppedLine, plc: Plc, faults: FaultBoard | None = None) -> None:
        self._line = line
        self.plc = plc
        self.faults = faults or FaultBoard()
        self.registers = Registers(plc.map)
        self.web = WebEnd(line)
        self.extra = ExtraWords(line, (item.name for item in plc.map.channels))
        self.time_s = 0.0
        self.scans = 0
        self.refusal = ""
        self.observers: list[Callable[[Plant], None]] = []
        self.edge_observers: list[Callable[[FaultEdge], None]] = []
        self._inputs: dict[str, float] = {}
        self._stuck: dict[str, Mapping[str, float]] = {}
        self._undistorted: Mapping[str, float] = {}
        self.wire_faults: WireFaults | None = None
        self.plc_scans = 0
        self._old: list[Shown] = []
        self._dropped = Status(0)
        self._rolls_due_s = math.inf
        self._ran = False  # LINE_RUN is to come back with full rolls
        self._samples_a_scan = max(1, round(plc.map.scan_s / line.sample_time_s))
        names = [row.item.name for row in plc.map.corrections]
        self.applied_m_s: Mapping[str, float] = dict.fromkeys(names, 0.0)
        self._history: deque[tuple[float, tuple[float, ...]]] = deque(maxlen=_HISTORY_SCANS)
        self.reset_extremes()
        self.measured: Mapping[str, float] = {}
        self.shown = Shown([], {}, {})
        self.step()

    @property
    def sample_time_s(self) -> float:
        """Return the line's control sample time, s."""
        return self._line.sample_time_s

    @property
    def references(self) -> tuple[str, ...]:
        """Names that ``set_reference`` takes: those of every line, then speeds of carriages."""
        line = self._line
        travels = line.driven_travels if isinstance(line, TravelDriver) else ()
        names = (*REFERENCES, *(f"travel_{name}_m_s" for name in travels))
        return (*names, SUPPLIER) if self.extra.has_supplier else names

    def ask_for(self, channels: Iterable[str]) -> None:
        """Show words for the record alone that a wire of its own asks for, as the map's."""
        self.extra.ask_for(channels)
        words = self.extra.read()
        self.measured = {**self.measured, **words}
        self.shown = self.shown._replace(measured={**self.shown.measured, **words})

    def set_reference(self, name: str, value: float) -> None:
        """Give the line another reference (``references``, SI) from the next sample on.

        Raises
        ------
        PlantError
            The name is no reference, the value is not finite or does not fit into the PLC's word,
            or the web is at its end.
        """
        known = self.references
        if name not in known or not math.isfinite(value):
            raise PlantError(f"cannot set {name} = {value}; references are {known}")
        for item in self.plc.map.channels:
            low, high = item.range_si
            if item.name == name and not low <= value <= high:
                raise PlantError(
                    f"cannot set {name} = {value:g}: the PLC's word of it holds "
                    f"{low:g} to {high:g}"
                )
        if name == SPEED and self.web.at_end:
            raise PlantError("the web is at its end and the line stops; `roll` starts it again")
        if name == SUPPLIER:
            self.extra.supplier = round(value)
            return
        self._inputs[name] = value

    def set_status(self, bit: Status, on: bool) -> None:
        """Set or clear one status bit of the PLC.

        Raises
        ------
        PlantError
            LINE_RUN is to be set while the web is at its end.
        """
        if bit is Status.LINE_RUN and self.web.at_end:
            if on:
                raise PlantError("the web is at its end: LINE_RUN comes back with `roll`")
            self._ran = False
        self.plc.set_status(bit, on)

    def inject(self, spec: FaultSpec) -> FaultSpec:
        """Begin a fault, its start counted from now; return it with its start in plant time.

        Raises
        ------
        PlantError
            On this wire it would change nothing.
        """
        if self.wire_faults is not None:
            self.wire_faults.check(spec, self.plc.map)
        return self.faults.inject(spec)

    def clear(self, fault: Fault | None = None) -> None:
        """End one fault, or all, at the next sample; without its splice no rolls are exchanged."""
        if fault in {None, Fault.SPLICE}:
            self._rolls_due_s = math.inf
        self.faults.clear(fault)

    @property
    def takes_rolls(self) -> bool:
        """Return whether ``change_rolls`` can put full rolls on."""
        return isinstance(self._line, RollChanger)

    def change_rolls(self) -> float:
        """Announce a splice for 2 s and put full rolls on in its middle; return when, s.

        An exchange whose splice is no longer there at that time is called off.

        Raises
        ------
        PlantError
            The line has no rolls that can be exchanged, or an exchange is announced already.
        """
        if not isinstance(self._line, RollChanger):
            raise PlantError("this line has no rolls that can be exchanged")
        if self._rolls_due_s < math.inf:
            raise PlantError(
                f"full rolls are coming already, at {self._rolls_due_s:.3f} s of plant time"
            )
        placed = self.faults.inject(parse_fault("splice"))
        self._rolls_due_s = placed.start_s + 0.5 * placed.duration_s
        return self._rolls_due_s

    def reset_extremes(self) -> None:
        """Start the search for the largest correction again."""
        self.max_abs_applied_m_s = dict.fromkeys(self.applied_m_s, 0.0)

    def history(self, scans: int) -> list[tuple[float, tuple[float, ...]]]:
        """Return time and applied corrections of the last ``scans`` samples, oldest first."""
        skip = max(0, len(self._history) - max(0, scans))
        return list(islice(self._history, skip, None))

    def step(self) -> None:
        """Advance line and PLC by one sample."""
        if self.time_s >= self._rolls_due_s and isinstance(self._line, RollChanger):
            self._rolls_due_s = math.inf
            if self.faults.active(Fault.SPLICE):
                self._line.change_rolls()
                self.extra.new_roll()
                self._start_again()
        measured = dict(self._line.step(self.web.references(self._inputs, self.sample_time_s)))
        for name in REFERENCES:
            if name in self._inputs:
                measured.setdefault(name, self._inputs[name])
        measured |= self.extra.read()
        self.scans += 1
        self.time_s = self.scans * self.sample_time_s
        edges = self.faults.advance(self.time_s)
        for edge in edges:
            self._take(edge)
        if self.faults.active(Fault.SECOND):
            self.registers.clear_writes()
        self._mind_the_web(measured.get(SPEED, 0.0))
        if self.faults.active(Fault.LAST):
            self.registers.write_as_another(_ANOTHER + self.scans)
        if self.faults.active(Fault.THIRD):
            self.registers.write_third(THIRD_M_S)
        self._undistorted = dict(measured)
        self._distort(measured)
        self.measured = measured
        if (self.scans - 1) % self._samples_a_scan == 0:
            self._scan()
        self._history.append((self.time_s, tuple(self.applied_m_s.values())))
        for edge in edges:
            for edge_observer in self.edge_observers:
                edge_observer(edge)
        for observer in self.observers:
            observer(self)

    def _mind_the_web(self, speed_ref_m_s: float) -> None:
        if self.web.look(speed_ref_m_s):
            self._inputs.setdefault(SPEED, speed_ref_m_s)
        if self.web.at_end:
            self._ran = self._ran or Status.LINE_RUN in self.plc.status
            self.plc.set_status(Status.LINE_RUN, False)

    def _start_again(self) -> None:
        self.web.refill()
        if self._ran:
            self._ran = False
            self.plc.set_status(Status.LINE_RUN, True)

    def _scan(self) -> None:
        try:
            scan = self.plc.scan(self.time_s, self.measured, self.registers.write_words)
        except KeyError as error:
            known = sorted(name for name in self.measured if not name.startswith("true_"))
            raise PlantError(
                f"the PLC's map asks for {error}; the line measures {known}; give a map of its "
                "own channels: `--plc MAP.yaml`, in a test `plc=`"
            ) from error
        self.refusal = scan.refusal
        self.applied_m_s = scan.corrections_m_s
        for name, value in scan.corrections_m_s.items():
            self._inputs[f"aff_{name}_m_s"] = value
            self.max_abs_applied_m_s[name] = max(self.max_abs_applied_m_s[name], abs(value))
        self.plc_scans += 1
        fresh = Shown(scan.read_words, scan.measured, scan.applied_m_s)
        if not self.shown.words:
            self.shown = fresh
        if not self.faults.active(Fault.FREEZE):
            self.shown = self._by_turns(fresh)
            words = self.shown.words
            self.registers.publish(
                self.plc.map.swap_read(words) if self.faults.active(Fault.SWAP) else words
            )

    def _by_turns(self, fresh: Shown) -> Shown:
        """Return one of the first two scans of ``turns``, the scan itself without it."""
        if not self.faults.active(Fault.TURNS):
            self._old.clear()
            return fresh
        if len(self._old) < 2:
            self._old.append(fresh)
            return fresh
        return self._old[self.plc_scans % 2]

    def _take(self, edge: FaultEdge) -> None:
        if edge.spec.fault is Fault.RESTART:
            self.registers.clear_writes()
            if not edge.began:
                self.plc.restart()
        elif edge.spec.fault is Fault.SPLICE:
            self.plc.set_status(Status.SPLICE_ACTIVE, edge.began)
            self.plc.roll_id = (self.plc.roll_id + edge.began) & 0xFFFF
        elif edge.spec.fault is Fault.PERMISSIVE:
            bit = Status[edge.spec.argument]
            if edge.began:
                self._dropped |= self.plc.status & bit
                self.plc.set_status(bit, False)
            else:
                self.plc.set_status(self._dropped & bit, True)
                self._dropped &= ~bit
        elif edge.spec.fault is Fault.STUCK and edge.began:
            self._stuck[edge.spec.argument] = self._undistorted

    def _distort(self, measured: dict[str, float]) -> None:
        for fault in (Fault.STUCK, Fault.ABSURD, Fault.NAN):
            if not self.faults.active(fault):
                continue
            for argument in self.faults.arguments(fault):
                for name in self._struck(argument):
                    if fault is Fault.STUCK:
                        measured[name] = self._stuck[argument].get(name, measured[name])
                    else:
                        measured[name] = math.nan if fault is Fault.NAN else _ABSURD_SI

    def _struck(self, channel: str) -> list[str]:
        """Return a channel of the map, without a name all tensions."""
        names = [item.name for item in self.plc.map.channels]
        if channel:
            return [name for name in names if name == channel]
        return [name for name in names if name.endswith("_tension_N")]
