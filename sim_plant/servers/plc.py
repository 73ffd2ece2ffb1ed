"""The PLC's program: heartbeat, status bits and its half of safety; no I/O and no clock.

A correction that fails any rule of ``_judge`` or ``_decode`` stops counting, for every actuator:
the value held then ramps linearly to zero within ``fade_s`` of the last scan that accepted one.
A live runtime whose corrections are intact and zero ends the ramp at once.
The watchdog counts time without a new heartbeat; a new one takes ``regain_s`` off it and not all,
so that a wire that lets one command in many through runs out all the same.
Two things latch. After a watchdog trip, a start, or a heartbeat that jumps (another master writes
as well, or the runtime is a new one) a scan with a moving heartbeat and neither ACTIVE nor FADING
must come before the next correction counts. And a runtime that says ACTIVE or FADING and is
refused loses AFF_ENABLE_REQUEST until it is neither and not armed.
``aff_echo``, where the map has it, is the heartbeat of the command that this scan judged: by it a
runtime knows whether that was its own. ``applied`` is what the scan adds to each reference, after
all these rules: by it a runtime knows whether that was its own, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from aff_runtime.base.signals import StateBits, Status
from sim_plant.servers.plc_map import PlcMap

# plain numbers: `&` of a flag makes a flag, and a scan does it six times
_COUNTS = int(StateBits.ACTIVE | StateBits.FADING)
_WANTS = _COUNTS | int(StateBits.ARMED)
_REQUEST = int(Status.AFF_ENABLE_REQUEST)
_TIME_TOLERANCE_S = 1e-9
_LONGEST_STEP = 64  # of a heartbeat between two scans of a runtime that is alone
_LIMIT_TOLERANCE = 1.0 + 1e-9
ALL_WELL = (
    Status.LINE_RUN
    | Status.AFF_ENABLE_REQUEST
    | Status.WEB_INTACT
    | Status.TENSION_VALID
    | Status.ESTOP_OK
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scan:
    """What one scan of the PLC decided.

    Attributes
    ----------
    corrections_m_s : correction that the PLC adds to each actuator's speed reference.
    read_words : the read block as the wire shows it from now on.
    measured, applied_m_s : what the PLC says of channels and corrections, SI, for a wire that has
        no such words.
    refusal : why the runtime's correction does not count; empty while it counts.
    """

    corrections_m_s: Mapping[str, float]
    read_words: list[int]
    measured: Mapping[str, float]
    applied_m_s: Mapping[str, float]
    refusal: str


class Plc:
    """One PLC: call ``scan`` once per cycle.

    Attributes
    ----------
    status : status bits shown to the runtime; a scenario sets and clears them.
    roll_id : counts splices; retentive over a restart.
    trips : number of watchdog trips since construction.
    withdrawn : AFF_ENABLE_REQUEST is shown as 0 because a runtime that counted was refused.
    """

    def __init__(self, plc_map: PlcMap, *, status: Status = ALL_WELL) -> None:
        self.map = plc_map
        self.status = status
        self.roll_id = 1
        self.trips = 0
        self._actuators = tuple(row.item.name for row in plc_map.corrections)
        self.restart()

    def restart(self) -> None:
        """Start the program again: heartbeat from zero, output zero, nothing accepted yet."""
        self._heartbeat = 0
        self._aff_heartbeat: int | None = None
        self._heard = self._jumped = False
        self._silence_s = self._scanned_at_s = 0.0
        self._needs_rearm = True
        self.withdrawn = False
        self._held = dict.fromkeys(self._actuators, 0.0)
        self._held_at_s = 0.0

    def set_status(self, bit: Status, on: bool) -> None:
        """Set or clear one status bit."""
        self.status = self.status | bit if on else self.status & ~bit

    def scan(
        self, now_s: float, measured: Mapping[str, float], write_words: Sequence[int]
    ) -> Scan:
        """Run one cycle at ``now_s`` (s, never falling).

        Parameters
        ----------
        measured : SI value per channel of the map.
        write_words : the write block as the wire left it.
        """
        self._heartbeat = (self._heartbeat + 1) & 0xFFFF
        refusal, wanted = self._judge(now_s, write_words)
        if not refusal:
            self._held, self._held_at_s = wanted, now_s
        since_s = now_s - self._held_at_s
        faded = since_s > self.map.fade_s - _TIME_TOLERANCE_S
        share = 0.0 if faded else 1.0 - since_s / self.map.fade_s
        corrections_m_s = {name: held * share for name, held in self._held.items()}
        words = {
            "plc_heartbeat": self._heartbeat,
            "status": int(self.status) & ~self._hidden(),
            "roll_id": self.roll_id,
            "aff_echo": self.map.write_word(write_words, "aff_heartbeat"),
        }
        return Scan(
            corrections_m_s=corrections_m_s,
            read_words=self.map.encode_read(words, measured, corrections_m_s),
            measured=measured,
            applied_m_s=corrections_m_s,
            refusal=refusal,
        )

    def _judge(self, now_s: float, block: Sequence[int]) -> tuple[str, dict[str, float]]:
        alive = self._heartbeat_moves(now_s, block)
        state = self.map.write_word(block, "state") & 0xFF
        counts = bool(state & _COUNTS)
        if alive and not counts:
            self._needs_rearm = False
        if alive and not self._jumped and not state & _WANTS:
            self.withdrawn = False
        refusal, wanted = self._refusal(block, alive=alive, counts=counts)
        if counts and refusal and not refusal.startswith("permissive"):
            self.withdrawn = True
        return refusal, wanted

    def _hidden(self) -> int:
        return _REQUEST if self.withdrawn else 0

    def _refusal(
        self, block: Sequence[int], *, alive: bool, counts: bool
    ) -> tuple[str, dict[str, float]]:
        missing = (int(self.map.permissives) | _REQUEST) & ~int(self.status)
        refusal = ""
        if not alive:
            refusal = "watchdog: aff_heartbeat does not move"
        elif not counts:
            refusal = "state: neither ACTIVE nor FADING"
        elif self._needs_rearm:
            refusal = "rearm: ACTIVE before a state without it was seen"
        elif missing:
            refusal = f"permissive: {'|'.join(bit.name or '' for bit in Status(missing))}=0"
        if not refusal:
            return self._decode(block)
        if alive and self._says_zero(block):
            self._held = dict.fromkeys(self._actuators, 0.0)
        return refusal, {}

    def _says_zero(self, block: Sequence[int]) -> bool:
        """Return whether every correction is intact and zero: then there is nothing to fade."""
        pairs = [self.map.decode_correction(block, row) for row in self.map.corrections]
        return all(intact and value_m_s == 0.0 for value_m_s, intact in pairs)

    def _decode(self, block: Sequence[int]) -> tuple[str, dict[str, float]]:
        wanted: dict[str, float] = {}
        for row in self.map.corrections:
            value_m_s, intact = self.map.decode_correction(block, row)
            if not intact:
                return f"complement: {row.item.name}", wanted
            if not abs(value_m_s) <= row.limit_m_s * _LIMIT_TOLERANCE:
                return f"limit: {row.item.name}", wanted
            wanted[row.item.name] = min(max(value_m_s, -row.limit_m_s), row.limit_m_s)
        return "", wanted

    def _heartbeat_moves(self, now_s: float, block: Sequence[int]) -> bool:
        heartbeat = self.map.write_word(block, "aff_heartbeat")
        since_s, self._scanned_at_s = now_s - self._scanned_at_s, now_s
        self._jumped = False
        if self._aff_heartbeat is not None and heartbeat != self._aff_heartbeat:
            left_s = self._silence_s - self.map.regain_s
            self._silence_s = max(0.0, left_s) if self._heard else 0.0
            self._heard = True
            self._jumped = (heartbeat - self._aff_heartbeat) & 0xFFFF > _LONGEST_STEP
            self._needs_rearm = self._needs_rearm or self._jumped
        elif self._heard:
            self._silence_s += since_s
        self._aff_heartbeat = heartbeat
        if not self._heard:
            return False
        if self._silence_s <= self.map.watchdog_s + _TIME_TOLERANCE_S:
            return True
        self._heard = False
        self._needs_rearm = True
        self.trips += 1
        return False
