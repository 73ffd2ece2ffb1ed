"""What somebody at a screen answers setup of the simulated Euclid line, by the question's name."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from benchmarks.setup_console.at_the_machine import MOST_TRIES, AtTheMachine, StuckError
from sim_plant.demo.unusual_plants import UnusualPlant
from sim_plant.servers.plc_map import PlcMap

MACHINE_ANSWERS = {
    "tension_max": "400 N",
    "radius_min": "4 in",
    "radius_max": "12 in",
    "limit": "0.15",
    "second_radius": "0.15367",
    "limit_second": "40 mm/s",
}
"""Bounds and sizes, on every wire alike."""
LINE_ANSWERS = {
    "name": "Euclid",
    "second": "swrap_follower",
    "second.tension": "pullroll_tension_N",
    "speed_max": "300 FPM",
    **MACHINE_ANSWERS,
}
_BUS = {
    "scan_ms": "5",
    "unwind_angle_rad.scale": "4096 counts/turn",
    "swrap_follower_angle_rad.scale": "4096 counts/turn",
}
BUS_ANSWERS: Mapping[str, Mapping[str, str]] = {
    "dbc": _BUS,
    "canopen": {
        **_BUS,
        "node.1": "line 1 euclid_line.eds",
        "node.2": "unwind_drive 3 euclid_drive.eds",
        "node.3": "follower_drive 4 euclid_drive.eds",
        "signal.line_speed_m_s": "unwind_drive.0x606C",
        "unwind_tension_N.scale": "0.001",
        "tension_ref_N.scale": "0.01",
        "line_speed_m_s.scale": "0.0001",
        "unwind_radius_m.scale": "0.02 mm",
        "swrap_follower_speed_m_s.scale": "0.0001",
        "pullroll_tension_N.scale": "0.001",
        "lost.unwind_drive": "-1",
        "lost.follower_drive": "-1",
    },
}
"""What no DBC or EDS file says."""
_PROBE = {"probe": "0.02"}
_ASKED = re.compile(r"(?P<channel>\w+)\.(?P<what>display|pick|rest|move)\d*")
REFUSED = 6
"""Words behind the PLC's last that are looked at too: it refuses them."""


def by_words(words: PlcMap, port: str) -> dict[str, str]:
    """Return what is answered of a PLC on Modbus, by its manual."""
    applied = {f"applied.{row.name}": str(row.address) for row in words.applied}
    return {
        "host": "127.0.0.1",
        "port": port,
        "first": str(words.read_start),
        "count": str(words.read_count + REFUSED),
        "status.word": str(words.read["status"]),
        "roll_id": str(words.read["roll_id"]),
        "echo": str(words.read["aff_echo"]),
        **applied,
    }


def by_files(wire: str, channel: str) -> dict[str, str]:
    """Return what is answered of a PLC on a bus; ``wire`` as of `make demo`."""
    kind, own = {
        "can": ("dbc", {"wire": "can_dbc", "dbc": "euclid.dbc"}),
        "canopen": ("canopen", {"wire": "canopen_402"}),
    }[wire]
    return {"interface": "frame_socket", "channel": channel, **BUS_ANSWERS[kind], **own}


class Answers(AtTheMachine):
    """Answers by the names of questions; takes what setup is sure of.

    Parameters
    ----------
    socket : the plant's control socket. ``plant`` : what it has otherwise.
    words : the PLC's manual; None on a bus. ``reached`` : answers that say where it is.

    Attributes
    ----------
    typed : names of the questions that were answered otherwise than by Enter.
    """

    walk_s, pressed_s = 4.0, 6.0  # an answer at a screen takes effect later

    def __init__(
        self, socket: Path, plant: UnusualPlant, words: PlcMap | None, reached: Mapping[str, str]
    ) -> None:
        channels = words.channels if words is not None else ()
        super().__init__(socket, {item.name: item.address for item in channels})
        self._given = {**LINE_ANSWERS, **_PROBE, **reached, **plant.answers}
        self._searched = words is not None
        self._times: Counter[str] = Counter()
        self.typed: list[str] = []

    def __call__(self, name: str, is_sure: bool) -> str:
        """Return what is typed; empty takes the default.

        Raises
        ------
        StuckError
            The same question came too often.
        """
        self.questions += 1
        self._times[name] += 1
        if self._times[name] > MOST_TRIES:
            raise StuckError(name)
        text = self._answer(name, is_sure)
        if text:
            self.typed.append(name)
        return text

    def _answer(self, name: str, is_sure: bool) -> str:
        asked = _ASKED.fullmatch(name)
        if name in self._given or asked is None:
            return self._given.get(name, "")
        channel, what = asked["channel"], asked["what"]
        if what == "pick":
            return self.row(channel, is_sure=is_sure)
        if what == "move":
            self.move(channel)
        if what != "display" or channel.endswith("_rad"):
            return ""
        is_there = not self._searched or channel in self._manual
        return self.shown(channel) if is_there else ""
