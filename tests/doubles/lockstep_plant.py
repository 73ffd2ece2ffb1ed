"""The plant in virtual time without a socket, for tests that step runtime and plant in turn."""

from __future__ import annotations

from aff_runtime.base.signals import Outcome
from sim_plant.base.ports import SteppedLine
from sim_plant.servers.faults import Fault, FaultBoard, FaultSpec
from sim_plant.servers.plant import Plant
from sim_plant.servers.plc import Plc

_OUTCOME_BEFORE = {  # the request is not obeyed
    Fault.RESTART: Outcome.NOT_CONNECTED,
    Fault.DROP: Outcome.NOT_CONNECTED,
    Fault.REFUSE: Outcome.NOT_CONNECTED,
    Fault.MUTE: Outcome.TIMEOUT,
    Fault.BUSY: Outcome.EXCEPTION,
}
_OUTCOME_AFTER = {  # the request is obeyed, its answer is of no use
    Fault.DELAY: Outcome.TIMEOUT,
    Fault.PARTIAL: Outcome.TIMEOUT,
    Fault.TID: Outcome.BAD_REPLY,
    Fault.SHORT: Outcome.BAD_REPLY,
}


class LockstepPlant:
    """A plant whose time is turned by hand; it is itself a word transport.

    Attributes
    ----------
    plant : the same line and PLC that the real-time server runs.
    """

    def __init__(self, line: SteppedLine, plc: Plc, *, faults: FaultBoard | None = None) -> None:
        self.plant = Plant(line, plc, faults)
        self._owed_s = 0.0

    def inject(self, spec: FaultSpec) -> None:
        """Inject a fault whose start counts from now; it acts from the next sample on."""
        self.plant.faults.inject(spec)

    def advance(self, dt_s: float) -> None:
        """Advance by ``dt_s``; fractions of a sample add up over calls."""
        self._owed_s += dt_s
        samples = int(self._owed_s / self.plant.sample_time_s + 1e-6)
        self._owed_s -= samples * self.plant.sample_time_s
        for _ in range(samples):
            self.plant.step()

    def transact(self, write_words: list[int], deadline_ns: int) -> tuple[Outcome, list[int]]:
        """Exchange the blocks as a word transport does; the deadline always suffices."""
        del deadline_ns
        faults, registers = self.plant.faults, self.plant.registers
        for fault, outcome in _OUTCOME_BEFORE.items():
            if faults.active(fault):
                return outcome, []
        start = self.plant.plc.map.write_start
        if not registers.write(start, write_words):
            return Outcome.EXCEPTION, []
        for fault, outcome in _OUTCOME_AFTER.items():
            if faults.active(fault):
                return outcome, []
        return Outcome.OK, list(registers.read_words)

    def close(self) -> None:
        """Do nothing; there is no connection."""
