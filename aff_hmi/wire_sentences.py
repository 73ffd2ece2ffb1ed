"""What ails the wire, as the service says it: each sentence with its values and its own advice.

A control process writes English sentences with numbers and names in them. Each is found again by
its pattern; what is in none stays English, whole, with the advice of a wire.
"""

from __future__ import annotations

import errno
import os
import re
from dataclasses import dataclass, replace
from functools import cache

from aff_hmi.words import N_
from aff_runtime.base.events import STALE_BEGAN
from aff_runtime.base.printable import printable

CHECK_CABLE = N_("check cable, switch and PLC")
CHECK_PORT = N_("is the PLC's server switched on, and is this its port?")
CHECK_NET = N_("check cable, switch and the gateway's own address")
CHECK_NODE = N_("check this device: power, wiring, node id and what its display says")
MEND_RADIUS = N_("mend the scale of this word, or the range of the roll in the site file")
NUMBERS = {"seconds": r"[0-9.e-]+", "function": r"\d+", "code": r"\d+", "node": r"\d+"}
LONGEST = 200
OF_WIRE, OF_RADIUS, OF_COUNT = "WIRE", "RADIUS", "COUNT"


@dataclass(frozen=True, slots=True, kw_only=True)
class Trouble:
    """One kind of trouble.

    Attributes
    ----------
    text, to_do : what it is and what to do, English.
    heard : pattern of the service's sentence, ``{name}`` for a value; empty: ``text`` is it.
    name : of the alarm; not ``WIRE`` where it is of a reading of one roll.
    """

    text: str
    to_do: str = CHECK_CABLE
    heard: str = ""
    name: str = OF_WIRE

    @property
    def is_of_a_roll(self) -> bool:
        """Whether it is of a reading, not of the wire that brings it."""
        return self.name != OF_WIRE


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """A trouble with its values.

    Attributes
    ----------
    ended_the_plc : the loss of the PLC began with it; it may be over.
    """

    trouble: Trouble
    values: dict[str, str]
    ended_the_plc: bool = False

    @property
    def name(self) -> str:
        """As an alarm has it: of a reading that is not taken, or of the wire that brings them."""
        if self.ended_the_plc:
            return "BEFORE PLC_STALE"
        return self.trouble.name


EXCEPTIONS = {
    2: (
        N_("the PLC refuses function {function} with exception 2, illegal data address"),
        N_("it has no such registers; compare the map and address_base"),
    ),
    3: (
        N_("the PLC refuses function {function} with exception 3, illegal data value"),
        N_("it does not serve so many registers at once: map fewer, or closer together"),
    ),
    4: (
        N_("the PLC refuses function {function} with exception 4, server device failure"),
        N_("read the PLC's own log"),
    ),
    5: (
        N_("the PLC refuses function {function} with exception 5, acknowledge: it takes its time"),
        N_("a cyclic exchange needs another server"),
    ),
    6: (
        N_("the PLC refuses function {function} with exception 6, server device busy"),
        N_("its scan or another client keeps it: lengthen cycle_ms, or take the other away"),
    ),
    8: (
        N_("the PLC refuses function {function} with exception 8, memory parity error"),
        N_("the device is defective: exchange it"),
    ),
    10: (
        N_("the PLC refuses function {function} with exception 10, gateway path unavailable"),
        N_("check device_id and the gateway's table of devices"),
    ),
    11: (
        N_(
            "the PLC refuses function {function} with exception 11, gateway target does not "
            "respond"
        ),
        N_("check power, line and device_id of the device behind the gateway"),
    ),
}  # codes and their names as in the MODBUS Application Protocol V1.1b3, section 7
RADII = (
    N_(
        "{roll}: {signal} is below radius_min_m {low} m: not taken, the last one within, "
        "{radius} m, stays"
    ),
    N_(
        "{roll}: {signal} is above radius_max_m {high} m: not taken, the last one within, "
        "{radius} m, stays"
    ),
    N_("{roll}: {signal} is below radius_min_m {low} m: not taken, no radius is known"),
    N_("{roll}: {signal} is above radius_max_m {high} m: not taken, no radius is known"),
)
OF_NODES = (
    N_("{device} (node {node}): not heard yet"),
    N_("{device} (node {node}): heartbeat lost"),
    N_("{device} (node {node}): did not start"),
    N_("{device} (node {node}): booted"),
    N_("{device} (node {node}): no answer to SDO {object}"),
    N_("{device} (node {node}): SDO {object} refused with {abort}"),
    N_("{device} (node {node}): {object} reads back {value}"),
    N_("{device} (node {node}): SDO {object}: answer {answer}"),
    N_("{device} (node {node}): NMT state {state}"),
    N_("{device} (node {node}): EMCY {emergency}"),
    N_("{device} (node {node}): an error is left, error register {register}"),
)
OF_SYSTEM = {
    errno.ECONNREFUSED: (N_("{where}: connection refused, nobody listens there"), CHECK_PORT),
    errno.EHOSTUNREACH: (N_("{where}: no route to it"), CHECK_NET),
    errno.ENETUNREACH: (N_("{where}: its network is not reached"), CHECK_NET),
    errno.ENETDOWN: (N_("{where}: the gateway's own network is down"), CHECK_NET),
    errno.EHOSTDOWN: (N_("{where}: the device is off, or not there"), CHECK_CABLE),
    errno.ETIMEDOUT: (N_("{where}: no answer in time"), CHECK_CABLE),
    errno.ECONNRESET: (N_("{where}: the other side ended the connection"), CHECK_PORT),
    errno.ECONNABORTED: (N_("{where}: the connection was broken off"), CHECK_CABLE),
    errno.EPIPE: (N_("{where}: the other side is gone"), CHECK_CABLE),
    errno.EADDRNOTAVAIL: (N_("{where}: the gateway has no address for it"), CHECK_NET),
    errno.EACCES: (N_("{where}: the gateway's firewall forbids it"), CHECK_NET),
}  # errors of a socket as POSIX names them; the service says them in the system's own words
TROUBLES = (
    Trouble(text=N_("no reply within {seconds} s")),
    Trouble(text=N_("no connection within {seconds} s")),
    Trouble(text=N_("closed by the other side")),
    Trouble(
        text=N_("no trouble of the wire: its heartbeat did not move"),
        to_do=N_("does the PLC run, and does its program count the heartbeat up in each scan?"),
    ),
    Trouble(text=N_("no trouble of the wire: nothing new came in time")),
    Trouble(text=N_("no trouble of the wire: there was no connection")),
    Trouble(
        text=N_("no trouble of the wire: it refused what was asked"),
        to_do=N_("read the PLC's own log"),
    ),
    Trouble(text=N_("no trouble of the wire: its replies or heartbeats were not to be believed")),
    Trouble(text=N_("a reply broke the protocol")),
    Trouble(
        heard="the last reply came spoilt (wrong CRC or length): {rest}",
        text=N_("the last reply came spoilt (wrong CRC or length)"),
        to_do=N_("check wiring, termination, baud and parity"),
    ),
    Trouble(
        heard="the PLC does not know function 23 (exception 1): {rest}",
        text=N_("the PLC does not know function 23 (exception 1)"),
        to_do=N_("write function: fc3_fc16 into the site file"),
    ),
    Trouble(
        heard="the PLC does not know function {function} (exception 1), which it must",
        text=N_("the PLC does not know function {function} (exception 1), which it must"),
        to_do=N_("see the device's manual"),
    ),
    *(
        Trouble(
            heard=f"the PLC refuses function {{function}} with exception {code} ({{rest}})",
            text=text,
            to_do=to_do,
        )
        for code, (text, to_do) in EXCEPTIONS.items()
    ),
    Trouble(
        heard="the PLC refuses function {function} with exception {code} ({rest})",
        text=N_(
            "the PLC refuses function {function} with exception {code}, which is not in the "
            "standard"
        ),
        to_do=N_("see the device's manual"),
    ),
    *(
        Trouble(heard=f"{one}; {{rest}}", text=one, to_do=MEND_RADIUS, name=OF_RADIUS)
        for one in RADII
    ),
    Trouble(
        heard="{roll}: {signal}: its count starts over after {rest}, and the service loses its "
        "phase each time: write wraps_after: {after}",
        text=N_(
            "{roll}: the count of {signal} starts over early, each time its phase is lost; its "
            "word lacks wraps_after: {after}"
        ),
        to_do=N_("write that into the site file"),
        name=OF_COUNT,
    ),
    *(Trouble(text=one, to_do=CHECK_NODE) for one in OF_NODES),
    Trouble(  # before OF_SYSTEM: its rest may be one of those errors
        text=N_("the serial line {device} does not open: {rest}"),
        to_do=N_("is the adapter plugged in, and may the service use it?"),
    ),
    *(
        Trouble(heard=f"{{where}}: {os.strerror(number)}", text=text, to_do=to_do)
        for number, (text, to_do) in OF_SYSTEM.items()
    ),
    Trouble(
        heard="{where} cannot be resolved ({rest}); write its IP address or check DNS",
        text=N_("{where} cannot be resolved"),
        to_do=N_("write its IP address, or check DNS"),
    ),
)
OTHER = Trouble(text="{said}")


def told(sentence: str) -> Told:
    """Return what a sentence of the service says; what is in no pattern is its own text."""
    if sentence.startswith(STALE_BEGAN):
        return replace(told(sentence.removeprefix(STALE_BEGAN)), ended_the_plc=True)
    for trouble in TROUBLES:
        if found := _pattern(trouble.heard or trouble.text).fullmatch(sentence):
            values = {name: printable(text, LONGEST) for name, text in found.groupdict().items()}
            return Told(trouble=trouble, values=values)
    return Told(trouble=OTHER, values={"said": printable(sentence, LONGEST)})


@cache
def _pattern(heard: str) -> re.Pattern[str]:
    parts = re.split(r"\{(\w+)\}", heard)
    return re.compile(
        "".join(
            f"(?P<{part}>{NUMBERS.get(part, '.+?')})" if number % 2 else re.escape(part)
            for number, part in enumerate(parts)
        )
    )
