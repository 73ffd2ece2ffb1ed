"""The head of a ring: who writes it, what is in it and where."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Right:
    """One real-time right, granted or not, in words."""

    granted: bool
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RunMeta:
    """What the control process says of itself, for every reader of its ring.

    Attributes
    ----------
    config_hash : revision in force. ``versions`` : of the packages, by name.
    machine : as ``uname`` names it. ``start_ns`` : monotonic time of the start.
    shadow : started to compute and record, transmitting zero.
    heartbeat_modulus : counts after which the PLC's heartbeat starts over; 0 where not known.
    """

    config_hash: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    rights: tuple[Right, ...] = ()
    machine: str = ""
    start_ns: int = 0
    shadow: bool = False
    heartbeat_modulus: int = 0

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON and YAML."""
        return asdict(self)

    @classmethod
    def from_json(cls, said: Any) -> RunMeta:
        """Read ``to_json``'s values back; what is not said is empty."""
        return cls(
            config_hash=said.get("config_hash", ""),
            versions=dict(said.get("versions", {})),
            rights=tuple(
                Right(granted=r["granted"], text=r["text"]) for r in said.get("rights", ())
            ),
            machine=said.get("machine", ""),
            start_ns=said.get("start_ns", 0),
            shadow=said.get("shadow", False),
            heartbeat_modulus=said.get("heartbeat_modulus", 0),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RingHeader:
    """Layout of a ring file and who made it.

    Attributes
    ----------
    columns : names with units of one signal record.
    capacity, event_capacity : records kept; ``signals_at``, ``events_at``: their offsets, bytes.
    start_utc : wall time of the start.
    """

    columns: tuple[str, ...]
    capacity: int
    event_capacity: int
    signals_at: int
    events_at: int
    writer_pid: int
    start_utc: str
    meta: RunMeta

    def encode(self) -> bytes:
        """Return the header as it lies in the ring."""
        return json.dumps(asdict(self)).encode()

    @classmethod
    def decode(cls, raw: bytes) -> RingHeader:
        """Read ``encode``'s bytes back.

        Raises
        ------
        KeyError, TypeError, ValueError
            When they are no header.
        """
        said = json.loads(raw)
        said["columns"] = tuple(said["columns"])
        said["meta"] = RunMeta.from_json(said["meta"])
        return cls(**said)
