"""What has to be found among the signals of a DBC or EDS file, and the words it goes by."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from aff_runtime.app.setup.asking.quantities import Quantity
from aff_runtime.base.channel_units import without_unit

Group = frozenset[str]
HEARTBEAT_BITS, OUR_HEARTBEAT_BITS = 8, 16
"""Fewest bits of the PLC's counter, and of ours and its copy, as `check` asks them too."""

_BEAT: Group = frozenset({"heartbeat", "heart beat", "alive", "life", "watchdog", "lebenszeichen"})
_ECHO: Group = frozenset({"echo", "mirror"})
_TENSION: Group = frozenset({"tension", "loadcell", "load cell", "zugkraft", "bahnzug", "tens"})
_SPEED: Group = frozenset({"speed", "velocity", "geschwindigkeit", "vel", "spd"})
_RADIUS: Group = frozenset({"radius", "diameter", "durchmesser", "dia", "rad"})
_ANGLE: Group = frozenset({"angle", "position", "encoder", "winkel", "pos", "enc", "inc"})
_SET: Group = frozenset(
    {"setpoint", "set point", "reference", "target", "sollwert", "soll", "ref", "set", "sp", "cmd"}
)
_LINE: Group = frozenset({"line", "web", "bahn", "master", "lead"})
_CORRECTION: Group = frozenset({"correction", "korrektur", "offset", "trim", "additive", "aff"})
_APPLIED: Group = frozenset({"applied", "in force", "effective", "wirksam"}) | _CORRECTION
_COPY: Group = frozenset({"complement", "inverse", "inverted", "komplement", "inv"})
_UNWIND: Group = frozenset({"unwind", "unwinder", "abwickler", "abwickel", "unw", "uw"})
_STATUS: Group = frozenset({"status", "permissive", "statusword", "flags", "bits"})
_SPLICE: Group = frozenset({"roll", "splice", "rolle", "reel"})
_NUMBER: Group = frozenset({"number", "id", "count", "nummer", "nr", "no"})
_OURS: Group = frozenset({"aff"})
_BY_UNIT = {"N": _TENSION, "m/s": _SPEED, "rad/s": _SPEED, "m": _RADIUS, "rad": _ANGLE}


@dataclass(frozen=True, slots=True, kw_only=True)
class Role:
    """What one signal may be.

    Attributes
    ----------
    name : of the answer, behind ``signal.``.
    asked : for a technician.
    groups : words of which one each should stand in its name, what it is first, then whose.
    needs : words of which one must stand there. ``against`` : words that speak against it.
    unit : SI; empty for a word of bits or counts.
    written : AFF sends it. ``optional`` : a line may do without. ``signed`` : it must be.
    least_bits : fewer cannot be it. ``same_bits`` : nor can more.
    moves : it moves while the PLC lives.
    """

    name: str
    asked: str
    groups: tuple[Group, ...]
    needs: Group = frozenset()
    against: Group = frozenset()
    unit: str = ""
    written: bool = False
    optional: bool = False
    signed: bool = False
    least_bits: int = 1
    same_bits: bool = False
    moves: bool = False


def words_read() -> tuple[Role, ...]:
    """Return the words that are read."""
    return (
        Role(
            name="plc_heartbeat",
            asked="counter that the PLC raises each scan (heartbeat)",
            groups=(_BEAT,),
            against=_ECHO | _OURS,
            least_bits=HEARTBEAT_BITS,
            moves=True,
        ),
        Role(
            name="status",
            asked="status bits of the PLC, in AFF's own order",
            groups=(_STATUS, _LINE | {"plc"}),
        ),
        Role(name="roll_id", asked="counter of splices (a new roll)", groups=(_SPLICE, _NUMBER)),
        Role(
            name="aff_echo",
            asked="the PLC's copy of our heartbeat (aff_echo)",
            groups=(_ECHO,),
            optional=True,
            least_bits=OUR_HEARTBEAT_BITS,
        ),
    )


def words_written() -> tuple[Role, ...]:
    """Return the words that AFF writes beside its corrections."""
    rows = (
        ("aff_heartbeat", "our heartbeat", (_BEAT, _OURS), OUR_HEARTBEAT_BITS),
        ("state", "our state", (frozenset({"state", "zustand"}),), 1),
        ("echo", "our echo of the PLC's heartbeat", (_ECHO,), 1),
        ("alarm", "our alarm", (frozenset({"alarm", "fault", "error"}),), 1),
        ("limit", "limit in force", (frozenset({"limit", "grenze"}),), 1),
        (
            "config_revision",
            "revision of our site file",
            (frozenset({"revision", "configrevision", "config", "configuration"}),),
            1,
        ),
    )
    return tuple(
        Role(name=name, asked=asked, groups=groups, written=True, least_bits=bits)
        for name, asked, groups, bits in rows
    )


def of_quantity(wanted: Quantity, rolls: Iterable[str]) -> Role:
    """Return the role of a measured value or a set point; ``rolls``: those that are corrected."""
    is_set = "_ref_" in wanted.channel
    kind = _BY_UNIT[wanted.unit]
    whose = _whose(wanted.channel, kind, tuple(rolls))
    return Role(
        name=wanted.channel,
        asked=wanted.asked,
        groups=(kind, whose, _SET) if is_set else (kind, whose),
        needs=_SET if is_set else frozenset(),
        against=_APPLIED | _BEAT if is_set else _APPLIED | _SET,
        unit=wanted.unit,
        optional=wanted.optional,
    )


def applied_role(roll: str) -> Role:
    """Return the role of the correction as the PLC or drive applies it."""
    return Role(
        name=f"applied.{roll}",
        asked=f"correction of {roll} that is really added (applied)",
        groups=(_APPLIED, roll_words(roll)),
        unit="m/s",
        optional=True,
        signed=True,
    )


def correction_role(roll: str) -> Role:
    """Return the role of a correction."""
    return Role(
        name=f"correction.{roll}",
        asked=f"correction of {roll}, added to the drive's speed reference behind its ramp",
        groups=(_CORRECTION, roll_words(roll)),
        unit="m/s",
        written=True,
        signed=True,
    )


def complement_role(roll: str, bits: int) -> Role:
    """Return the role of the ones complement of a correction that has ``bits``."""
    return Role(
        name=f"complement.{roll}",
        asked=f"ones complement of the correction of {roll}",
        groups=(_COPY, roll_words(roll)),
        needs=_COPY,
        written=True,
        optional=True,
        least_bits=bits,
        same_bits=True,
    )


def roll_words(roll: str) -> Group:
    """Return the words that a roll goes by."""
    return _UNWIND if roll == "unwind" else _parts(roll)


def is_diameter(called: str) -> bool:
    """Return whether a name says a diameter, of which the radius is half."""
    return bool(_words_in(called) & {"diameter", "durchmesser", "dia"}) or any(
        one in called.casefold() for one in ("diameter", "durchmesser")
    )


def _whose(channel: str, kind: Group, rolls: tuple[str, ...]) -> Group:
    """Return the words for what a channel is of."""
    name = without_unit(channel)
    if name.startswith("line_") or name == "tension_ref":
        return _LINE if name.startswith("line_") else kind
    words = _parts(name) - kind - _SET
    for roll in rolls:
        if name.startswith(roll) or roll_words(roll) & words:
            words |= roll_words(roll)
    if not words & _UNWIND:
        # a tension behind a roller is often called after the zone: both count
        words |= frozenset().union(*(roll_words(one) for one in rolls if one != "unwind"))
    return words - kind


def _parts(name: str) -> Group:
    return frozenset(part for part in name.split("_") if not part.isdecimal())


def has_one(group: Group, text: str) -> bool:
    """Return whether a name holds one of some words; short ones must stand for themselves."""
    folded = " ".join(re.sub(r"[^A-Za-z0-9]+", " ", text).casefold().split())
    words = _words_in(text)
    return any(one in words or (len(one) >= 4 and one in folded) for one in group)


def _words_in(text: str) -> set[str]:
    """Return the words of a name: parted at signs, digits, and where small turns to large."""
    parts = re.findall(r"[A-Z]+(?![a-z])\d*|[A-Z]?[a-z]+\d*|\d+", text)
    return {part.casefold() for part in parts}
