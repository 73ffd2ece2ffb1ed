"""Somebody at a terminal, with the displays of the drives in sight and the manual at hand."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from aff_runtime.base.signals import Status
from benchmarks.setup_console.at_the_machine import MOST_TRIES, AtTheMachine, StuckError
from benchmarks.setup_console.plants import FURTHER

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
PARTS = {
    "number": "Which number has word",
    "function": "Function codes",
    "status.order": "AFF's own order of bits",
    **{f"bits.{bit.name}": f"{bit.name}: " for bit in Status},
}
"""Part of a question, by the name that it has on a screen."""
_ASKED = re.compile(r"now as (?P<what>.+?), all digits|PLC show the (?P<encoder>.+?), and does")


class Technician(AtTheMachine):
    """Reads the terminal, the displays and the manual, types the answers.

    Parameters
    ----------
    socket : the plant's control socket. ``port`` : of its Modbus server.
    manual : first wire address of every channel.
    answers : what he says otherwise, by the question's name on a screen.
    """

    def __init__(
        self, socket: Path, port: int, manual: Mapping[str, int], answers: Mapping[str, str]
    ) -> None:
        super().__init__(socket, manual)
        self._otherwise = answers
        asked = {part: answers[name] for name, part in PARTS.items() if name in answers}
        self._answers = {**ANSWERS, "Port": str(port), **asked}
        self._further = iter([*RECORDED, "none"])
        self._channel = ""
        self._times: Counter[str] = Counter()

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
            return self._seen(asked["what"] or asked["encoder"])
        if "Which one?" in question:
            is_sure = re.search(r"\[\d+\]: $", question) is not None
            return self.row(self._channel, is_sure=is_sure)
        if "move this alone" in question:
            self.move(self._channel)
            return ""
        if "Further channel" in question:
            return next(self._further)
        self._times[question] += 1
        if self._times[question] > MOST_TRIES:
            raise StuckError(question)
        found = [said for part, said in self._answers.items() if part in question]
        return found[-1] if found else ""

    def _seen(self, what: str) -> str:
        """Return what the display shows; an encoder is there."""
        self._channel = DISPLAYS[what]
        if self._channel.endswith("_rad"):
            return self._otherwise.get(f"{self._channel}.display", "")
        return self.shown(self._channel)
