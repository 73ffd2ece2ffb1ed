"""What supervisor and control process say to each other, as frozen records.

``encode`` and ``decode`` are the only places that know how a message looks on the link.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

from pydantic import TypeAdapter

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.replies import ProbeResult, Reply
from aff_runtime.safety.reasons import REMOTE, SHADOW
from aff_runtime.telemetry.header import Right

EXIT_UNHEARD = 7
"""Of a control process that ended in good order, and knows of no zero that the PLC took last."""
MOST_REASONS = 16  # what fits a screen; a law may have three times as many orders


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """First message to a new control process; ``shadow``: compute and record, transmit zero."""

    record: ParameterRecord
    shadow: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Numbered:
    """What waits for a reply; `Pending.ask` gives it its number and its time.

    Attributes
    ----------
    valid_until_ns : by the monotonic clock, which both processes have in common; what comes later
        is not done, as whoever asked was told that nobody replied. 0 is over.
    """

    id: int = 0
    valid_until_ns: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm(Numbered):
    """The operator's edge."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bypass:
    """Take the correction back."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shadow(Numbered):
    """Begin or end shadow operation."""

    on: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureResponse(Numbered):
    """Probe these actuators, all of them when none is named; ``louder`` than the last time."""

    actuators: tuple[str, ...] = ()
    louder: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameters(Numbered):
    """Go on with another parameter record from the next tick."""

    record: ParameterRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class Forget(Numbered):
    """Drop what was learned of ``rolls``; none named: of those that are exchanged."""

    rolls: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfigDiffers:
    """The site file is not what runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """Fade to zero and end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RingMade:
    """There is a new ring; its descriptor comes with this message."""

    rights: tuple[Right, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Blocked:
    """What stands against an armed output, empty for nothing, and what else does."""

    text: str
    others: tuple[str, ...] = ()

    @classmethod
    def by(cls, reasons: Sequence[str]) -> Self:
        """Return what is told of all reasons, the first one first; shadow and remote always."""
        told, rest = list(reasons[:MOST_REASONS]) or [""], reasons[MOST_REASONS:]
        told += [one for one in rest if one in (SHADOW, REMOTE)]
        left = len(rest) - (len(told) - MOST_REASONS)
        if rest and left:
            told.append(f"and {left} more")
        return cls(text=told[0], others=tuple(told[1:]))


@dataclass(frozen=True, slots=True, kw_only=True)
class WireTroubles:
    """What is wrong with the wire."""

    troubles: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class LogLine:
    """A sentence for the service's log."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Probed:
    """A probe has ended: with results, or with the reason why there is none."""

    results: tuple[ProbeResult, ...] = ()
    error: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeNews:
    """What became of a learned shape."""

    actuator: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeLearned:
    """A learned shape to be kept; ``file`` is the text of its file."""

    actuator: str
    file: str


Command = (
    Start | Arm | Bypass | Shadow | MeasureResponse | Parameters | Forget | ConfigDiffers | Stop
)
Question = Arm | Shadow | MeasureResponse | Parameters | Forget
Report = RingMade | Blocked | WireTroubles | LogLine | Probed | ShapeNews | ShapeLearned | Reply
Message = Command | Report
_ADAPTERS: dict[str, TypeAdapter[Any]] = {
    kind.__name__: TypeAdapter(kind) for kind in (*Command.__args__, *Report.__args__)
}


class MessageError(ValueError):
    """A packet is no message of this link."""


def encode(message: Message) -> bytes:
    """Return a message as one packet."""
    word = type(message).__name__
    said = _ADAPTERS[word].dump_python(message, mode="json", by_alias=True)
    return json.dumps({"word": word, **said}).encode()


def decode(packet: bytes) -> Message:
    """Return the message of one packet.

    Raises
    ------
    MessageError
        When it is none: the two processes are not of one installation.
    """
    try:
        said = json.loads(packet)
        message: Message = _ADAPTERS[said.pop("word")].validate_python(said)
        if isinstance(message, Numbered) and not {"id", "valid_until_ns"} <= said.keys():
            raise KeyError("id, valid_until_ns")
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise MessageError(f"not a message of this link: {packet[:80]!r}") from error
    return message
