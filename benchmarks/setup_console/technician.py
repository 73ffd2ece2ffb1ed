"""Somebody at a terminal, with the displays of the drives in sight and the manual at hand."""

from __future__ import annotations

import re
import statistics
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from benchmarks.setup_console.plants import FURTHER
from sim_plant.demo.session import pause
from sim_plant.servers.answers import PlantStatus
from sim_plant.servers.control_client import ask

LBF_N, IN_M, FPM_M_S = 4.4482216152605, 0.0254, 0.00508
WALK_S, PRESSED_S = 2.0, 3.0
LOOKS, LOOK_S = 10, 0.1
MOST_TRIES = 4
SECOND, SECOND_TENSION = "swrap_follower", "pullroll_tension_N"
RECORDED = [name for name in FURTHER if name != "line_speed_ref_m_s"]
# what a question asks for, and the channel whose display shows it
DISPLAYS = {
    "web tension behind the unwind": "unwind_tension_N",
    "set point of that tension": "tension_ref_N",
    "line speed": "line_speed_m_s",
    "set point of the line speed behind its ramp": "line_speed_ref_m_s",
    "radius of the unwind roll (half its diameter)": "unwind_radius_m",
    f"speed of {SECOND}": f"{SECOND}_speed_m_s",
    f"web tension behind {SECOND}": SECOND_TENSION,
    f"encoder of {SECOND}": f"{SECOND}_angle_rad",
    "encoder of unwind": "unwind_angle_rad",
    **{name: name for name in RECORDED},
}
ANSWERS = {
    "Address of the PLC": "127.0.0.1",
    "Name of the line": "Euclid",
    "Name of a second driven roller": SECOND,
    "Channel of the web tension behind": SECOND_TENSION,
    "Highest speed": "300 FPM",
    "Highest web tension": "400 N",
    "Radius of the empty core": "2 in",
    "Radius of the full roll": "12 in",
    "Largest correction that the PLC allows at the unwind": "0.15",
    "Radius of swrap_follower": "0.15367",
    "Largest correction that the PLC allows at swrap_follower": "0.04",
    "Amplitude of the probe": "0.03",
    "Law: shape": "shape",
    "Word with the status bits": "1",
    "Word that counts splices": "8",
    "copy of our heartbeat": "15",
    "correction of unwind that the PLC": "16",
    "correction of swrap_follower that the PLC": "17",
    "Inertia": "0.25",
    "Density": "395",
    "Width": "6 in",
    "Outer radius of the core": "1.75 in",
}
_ASKED = re.compile(r"now as (?P<what>.+?), all digits|PLC show the (?P<encoder>.+?), and does")


class StuckError(Exception):
    """A question comes again and again."""


class Technician:
    """Reads the terminal, the displays and the manual, types the answers.

    Where setup takes a row by Enter he takes it; else he presses on the load cell behind the
    unwind, and looks the others up in the manual.

    Parameters
    ----------
    socket : the plant's control socket. ``port`` : of its Modbus server.
    manual : first wire address of every channel. ``answers`` : what he says otherwise.

    Attributes
    ----------
    questions : how many were asked. ``by_enter``, ``by_moving``, ``by_manual`` : channels by how
        their word was chosen.
    """

    def __init__(
        self, socket: Path, port: int, manual: Mapping[str, int], answers: Mapping[str, str]
    ) -> None:
        self._socket = socket
        self._manual = manual
        self._answers = {**ANSWERS, "Port": str(port), **answers}
        self._further = iter([*RECORDED, "none"])
        self._channel = ""
        self._times: Counter[str] = Counter()
        self._said: dict[str, list[str]] = {}
        self.questions = 0
        self.by_enter: list[str] = []
        self.by_moving: list[str] = []
        self.by_manual: list[str] = []

    def answer(self, question: str) -> str:
        """Return what to type; empty takes the default.

        Raises
        ------
        StuckError
            The same question came too often.
        """
        self.questions += 1
        asked = _ASKED.search(question)
        if asked is not None:
            return self._shown(asked["what"] or asked["encoder"])
        if "Which one?" in question:
            return self._pick(question)
        if "move this alone" in question:
            self._move()
            return ""
        if "Further channel" in question:
            return next(self._further)
        self._times[question] += 1
        if self._times[question] > MOST_TRIES:
            raise StuckError(question)
        found = [said for part, said in self._answers.items() if part in question]
        return found[-1] if found else ""

    def _shown(self, what: str) -> str:
        """Return what the display shows; an encoder is there."""
        self._channel = DISPLAYS[what]
        if self._channel.endswith("_rad"):
            return ""
        value = self.mean(self._channel)
        unit, text = _SHOWN[self._channel.rpartition("_")[2]]
        if self._channel.endswith("_rad_s"):
            return f"{value:.3f} rad/s"
        if self._channel.endswith("_m_s"):
            return f"{value / FPM_M_S:.1f} FPM"
        return text.format(value / unit)

    def _pick(self, question: str) -> str:
        channel = self._channel
        said = self._said.setdefault(channel, [])
        if len(said) > MOST_TRIES:
            raise StuckError(f"{channel}: {question} {said}")
        said.append(self._row(channel, question, said))
        return said[-1]

    def _row(self, channel: str, question: str, said: list[str]) -> str:
        """Return Enter where there is a row for it; else what decides."""
        if re.search(r"\[\d+\]: $", question):
            (self.by_moving if "move" in said else self.by_enter).append(channel)
            return ""
        if channel == "unwind_tension_N" and "move" not in said:
            return "move"
        word = f"w{self._manual[channel]}"
        if said and said[-1] == word:  # it is not among the rows: a value of another moment
            self.by_manual.remove(channel)
            return "again"
        self.by_manual.append(channel)
        return word

    def _move(self) -> None:
        """Press on the roller of the load cell, which the plant has as a fault of its reading."""
        ask(self._socket, f"fault absurd={self._channel}@{WALK_S:g}:{PRESSED_S:g}")

    def mean(self, channel: str) -> float:
        """Return what a display shows of a channel, which smooths it."""
        values = []
        for _ in range(LOOKS if not channel.endswith("_m") else 1):
            value = self.status().measured[channel]
            assert value is not None
            values.append(value)
            pause(LOOK_S)
        return statistics.fmean(values)

    def status(self) -> PlantStatus:
        """Return what the plant does now."""
        return PlantStatus.from_json(ask(self._socket, "status"))


_SHOWN: Mapping[str, tuple[float, str]] = {
    "N": (LBF_N, "{:.1f} lbf"),
    "m": (IN_M, "{:.2f} in"),
    "s": (1.0, "{:.3f}"),
}
