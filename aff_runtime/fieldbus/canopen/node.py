"""One CANopen node kept in step: configured, read back, started, watched; one SDO a tick.

Bytes by CiA 301: NMT command 0x000 [code, node]; SDO request 0x600 + node, answer 0x580 + node;
heartbeat 0x700 + node [state]; EMCY 0x080 + node [code low, code high, error register, ..].
Expedited SDO alone: every object configured here has four bytes or fewer.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from aff_runtime.fieldbus.can.frames import Frame

SYNC: Final = Frame(0x080, False, b"")
OPERATIONAL: Final = 0x05
BOOT_UP: Final = 0x00
_NMT_START: Final = 0x01
_NMT_PRE_OPERATIONAL: Final = 0x80
_SDO_PATIENCE_NS: Final = 200_000_000
_START_PATIENCE_NS: Final = 1_000_000_000
_RETRY_NS: Final = 300_000_000
_ABOUT_US: Final = (0x81, 0x82)
_COMMUNICATION: Final = 0x10  # bit of the error register
_GENERIC: Final = 0x01  # set with every other bit; on some nodes the only one there is


@dataclass(frozen=True, slots=True, kw_only=True)
class SdoWrite:
    """One object to write; ``verify`` reads it back when everything is written."""

    index: int
    subindex: int
    data: bytes
    verify: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class NodePlan:
    """What one node is to be told before it may start."""

    name: str
    node_id: int
    writes: tuple[SdoWrite, ...]
    heartbeat_ms: int = 100


# Read last, before the start: no EMCY that passed in our absence is sent again.
_ERROR_REGISTER: Final = SdoWrite(index=0x1001, subindex=0, data=b"\0")


class NodeState(IntEnum):
    """How far a node is."""

    ABSENT = 0
    WRITING = 1
    VERIFYING = 2
    STARTING = 3
    OPERATIONAL = 4


class NodeKeeper:
    """Brings one node to OPERATIONAL and notices when it leaves.

    A boot-up message, another NMT state, a heartbeat missing three times, or an SDO that is
    refused or unanswered sends it back to the start; nothing here waits.

    Attributes
    ----------
    state : how far it is.
    trouble : the last thing that went wrong, for ``status``; empty while nothing did.
    resets, emergencies : boot-ups, EMCY messages.
    """

    def __init__(self, plan: NodePlan, now_ns: int) -> None:
        self.plan = plan
        self.state = NodeState.ABSENT
        self.trouble = "not heard yet"
        self.resets = 0
        self.emergencies = 0
        self._error = ""
        self._step = 0
        self._asked = False
        self._act_at_ns = now_ns
        self._heard_ns = now_ns
        self._verify = (*(write for write in plan.writes if write.verify), _ERROR_REGISTER)

    @property
    def good(self) -> bool:
        """Return whether the node works and has no error of its own left.

        Communication errors (0x81xx, 0x82xx) say that we were away; process data must flow
        again for the node to take them back.
        """
        return self.state is NodeState.OPERATIONAL and not self._error

    def take(self, frame: Frame, now_ns: int) -> bool:
        """Take a frame; True when it was this node's own business."""
        node = self.plan.node_id
        if frame.extended:
            return False
        if frame.can_id == 0x700 + node:
            if len(frame.data) == 1:
                self._heartbeat(frame.data[0] & 0x7F, now_ns)
            return True
        if frame.can_id == 0x080 + node:
            if len(frame.data) == 8:
                self._emergency(frame.data[0] | frame.data[1] << 8, frame.data[2])
            return True
        if frame.can_id == 0x580 + node:
            if len(frame.data) == 8 and self._asked:
                self._answer(frame.data, now_ns)
            return True
        return False

    def tick(self, now_ns: int, taken_to_ns: int | None = None) -> Frame | None:
        """Return the frame to send now, if any.

        ``taken_to_ns`` : all that had arrived by then was taken; None: by now. A heartbeat that
        waits unread is no missing one.
        """
        if self.state is NodeState.OPERATIONAL:
            taken_to_ns = now_ns if taken_to_ns is None else taken_to_ns
            if taken_to_ns - self._heard_ns > 3_000_000 * self.plan.heartbeat_ms:
                self._lose("heartbeat lost", now_ns)
            return None
        if self.state is NodeState.ABSENT:
            if now_ns < self._act_at_ns:
                return None
            self._enter(NodeState.WRITING, now_ns)
            return Frame(0x000, False, bytes((_NMT_PRE_OPERATIONAL, self.plan.node_id)))
        if self.state is NodeState.STARTING:
            if now_ns > self._act_at_ns:
                self._lose("did not start", now_ns)
            return None
        if self._asked:
            if now_ns > self._act_at_ns:
                self._lose(f"no answer to SDO {self._object()}", now_ns)
            return None
        return self._ask(now_ns)

    def _emergency(self, code: int, register: int) -> None:
        """Take an EMCY: code 0 says that one error is gone, its register what is left."""
        self.emergencies += 1
        if code == 0:
            self._judge_register(register)
        elif code >> 8 not in _ABOUT_US:
            self._error = self.trouble = f"EMCY 0x{code:04X}"
        elif register & ~(_COMMUNICATION | _GENERIC) and not self._error:
            self._judge_register(register)

    def _judge_register(self, register: int) -> None:
        """Keep whether the error register says more than that communication was lost."""
        self._error = ""
        if register and register & ~_GENERIC != _COMMUNICATION:
            self._error = self.trouble = f"an error is left, error register 0x{register:02X}"

    def _ask(self, now_ns: int) -> Frame:
        steps = self.plan.writes if self.state is NodeState.WRITING else self._verify
        if self._step >= len(steps):
            if self.state is NodeState.WRITING:
                self._enter(NodeState.VERIFYING, now_ns)
                return self._ask(now_ns)
            self._enter(NodeState.STARTING, now_ns)
            self._act_at_ns = now_ns + _START_PATIENCE_NS
            return Frame(0x000, False, bytes((_NMT_START, self.plan.node_id)))
        write = steps[self._step]
        self._asked = True
        self._act_at_ns = now_ns + _SDO_PATIENCE_NS
        head = (write.index & 0xFF, write.index >> 8, write.subindex)
        if self.state is NodeState.WRITING:
            size = len(write.data)
            command = 0x23 | (4 - size) << 2
            return self._request(bytes((command, *head)) + write.data.ljust(4, b"\0"))
        return self._request(bytes((0x40, *head, 0, 0, 0, 0)))

    def _request(self, data: bytes) -> Frame:
        return Frame(0x600 + self.plan.node_id, False, data)

    def _answer(self, data: bytes, now_ns: int) -> None:
        steps = self.plan.writes if self.state is NodeState.WRITING else self._verify
        write = steps[self._step]
        if data[1] | data[2] << 8 != write.index or data[3] != write.subindex:
            return  # the late answer to an earlier question
        self._asked = False
        if data[0] == 0x80:
            code = int.from_bytes(data[4:], "little")
            self._lose(f"SDO {self._object()} refused with 0x{code:08X}", now_ns)
        elif self.state is NodeState.WRITING and data[0] == 0x60:
            self._step += 1
        elif self.state is NodeState.VERIFYING and data[0] & 0xE3 == 0x43:
            size = 4 - (data[0] >> 2 & 3)
            if write is _ERROR_REGISTER:
                self._judge_register(data[4])
                self._step += 1
            elif data[4 : 4 + size] != write.data:
                self._lose(f"{self._object()} reads back {data[4 : 4 + size].hex()}", now_ns)
            else:
                self._step += 1
        else:
            self._lose(f"SDO {self._object()}: answer 0x{data[0]:02X}", now_ns)

    def _object(self) -> str:
        steps = self.plan.writes if self.state is NodeState.WRITING else self._verify
        write = steps[min(self._step, len(steps) - 1)]
        return f"0x{write.index:04X}:{write.subindex:02X}"

    def _heartbeat(self, nmt_state: int, now_ns: int) -> None:
        self._heard_ns = now_ns
        if nmt_state == BOOT_UP:
            self.resets += 1
            self._error = ""
            self._lose("booted", now_ns, pause_ns=0)
        elif self.state is NodeState.STARTING and nmt_state == OPERATIONAL:
            self.state = NodeState.OPERATIONAL
            self.trouble = self._error
        elif self.state is NodeState.OPERATIONAL and nmt_state != OPERATIONAL:
            self._lose(f"NMT state 0x{nmt_state:02X}", now_ns, pause_ns=0)

    def _enter(self, state: NodeState, now_ns: int) -> None:
        self.state = state
        self._step = 0
        self._asked = False
        self._act_at_ns = now_ns + _SDO_PATIENCE_NS

    def _lose(self, why: str, now_ns: int, pause_ns: int = _RETRY_NS) -> None:
        self.state = NodeState.ABSENT
        self.trouble = why
        self._asked = False
        self._act_at_ns = now_ns + pause_ns
