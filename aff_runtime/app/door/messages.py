"""What the service says through its door: one JSON object a packet, out only.

A door is for looking. Whoever comes gets ``Hello``, the ring as a descriptor that reads, and twice
a second what the ring does not hold. Nothing that a visitor says is read.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TypeAlias

from aff_runtime.app.report.status_answer import StatusAnswer, read_answer

PROTOCOL = 1
MAX_PACKET_BYTES = 1 << 18
REFUSED = "this door is for looking: nothing is heard here; commands: aff-runtime, on the gateway"


@dataclass(frozen=True, slots=True, kw_only=True)
class Hello:
    """Who speaks: its release, and what a visitor may do (``view``, and nothing else yet)."""

    version: str
    protocol: int = PROTOCOL
    may: tuple[str, ...] = ("view",)


@dataclass(frozen=True, slots=True, kw_only=True)
class RingPassed:
    """A ring comes with this packet; ``descriptor`` is the receiver's own and reads only."""

    descriptor: int = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class RingGone:
    """There is no ring now: no control process ticks."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """How the service stands, without what the ring tells.

    Attributes
    ----------
    status : the answer to ``status`` with ``live`` None.
    blocked : what stands against an armed output, in the control process's words;
        ``also_blocking`` : what else does.
    wire : what is wrong with the wire.
    """

    status: StatusAnswer
    blocked: str = ""
    also_blocking: tuple[str, ...] = ()
    wire: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class SentAway:
    """The service has refused and hangs up."""

    message: str = REFUSED


DoorMessage: TypeAlias = Hello | RingPassed | RingGone | Facts | SentAway
_NAMES = {"hello": Hello, "ring": RingPassed, "no_ring": RingGone, "refused": SentAway}


class DoorMessageError(ValueError):
    """A packet is no message of this release."""


def encode(message: DoorMessage) -> bytes:
    """Return a message as one packet."""
    match message:
        case Facts(status=status, blocked=blocked, also_blocking=also, wire=wire):
            said = {"push": "facts", "status": status.to_json(), "wire": wire}
            said |= {"blocked": blocked, "also_blocking": also}
        case RingPassed():
            said = {"push": "ring"}
        case _:
            name = next(name for name, kind in _NAMES.items() if isinstance(message, kind))
            said = {"push": name, **asdict(message)}
    return json.dumps(said).encode()


def decode(packet: bytes) -> DoorMessage:
    """Return the message of one packet.

    Raises
    ------
    DoorMessageError
        When it is none of this release.
    """
    try:
        said = json.loads(packet)
        match said.get("push"):
            case "facts":
                return Facts(
                    status=read_answer(said["status"]),
                    blocked=str(said["blocked"]),
                    also_blocking=tuple(map(str, said.get("also_blocking", ()))),
                    wire=tuple(map(str, said["wire"])),
                )
            case "hello":
                return Hello(version=str(said["version"]), protocol=int(said["protocol"]))
            case "refused":
                return SentAway(message=str(said["message"]))
            case name:
                found: DoorMessage = _NAMES[name]()
                return found
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DoorMessageError(f"no message of this release ({error!r:.80})") from None
