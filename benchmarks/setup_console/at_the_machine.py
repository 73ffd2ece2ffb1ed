"""Somebody at the machine: displays of the drives, the PLC's manual, a hand for a load cell."""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from pathlib import Path

from sim_plant.demo.session import pause
from sim_plant.servers.answers import PlantStatus
from sim_plant.servers.control_client import ask

LBF_N, IN_M, FPM_M_S = 4.4482216152605, 0.0254, 0.00508
LOOKS, LOOK_S = 10, 0.1
MOST_TRIES = 4
MOVED = "unwind_tension_N"
"""The load cell that he can press on."""
_SHOWN: Mapping[str, tuple[float, str]] = {
    "N": (LBF_N, "{:.1f} lbf"),
    "m": (IN_M, "{:.2f} in"),
    "s": (1.0, "{:.3f}"),
}


class StuckError(Exception):
    """A question comes again and again."""


class AtTheMachine:
    """Reads what displays show, and chooses rows.

    Where setup takes a row by Enter he takes it; else he presses on the load cell behind the
    unwind, and looks the others up in the manual.

    Parameters
    ----------
    socket : the plant's control socket. ``manual`` : first wire address of every channel.

    Attributes
    ----------
    questions : how many were asked. ``by_enter``, ``by_moving``, ``by_manual`` : channels by how
        their word was chosen.
    """

    walk_s, pressed_s = 2.0, 3.0
    """From Enter to the press on the load cell, and how long it lasts."""

    def __init__(self, socket: Path, manual: Mapping[str, int]) -> None:
        self._socket = socket
        self._manual = manual
        self._said: dict[str, list[str]] = {}
        self.questions = 0
        self.by_enter: list[str] = []
        self.by_moving: list[str] = []
        self.by_manual: list[str] = []

    def shown(self, channel: str) -> str:
        """Return what the display of a channel shows, in its own unit."""
        value = self.mean(channel)
        if channel.endswith("_rad_s"):
            return f"{value:.3f} rad/s"
        if channel.endswith("_m_s"):
            return f"{value / FPM_M_S:.1f} FPM"
        unit, text = _SHOWN[channel.rpartition("_")[2]]
        return text.format(value / unit)

    def row(self, channel: str, *, is_sure: bool) -> str:
        """Return Enter where there is a row for it; else what decides.

        Raises
        ------
        StuckError
            Nothing decides.
        """
        said = self._said.setdefault(channel, [])
        if len(said) > MOST_TRIES:
            raise StuckError(f"{channel}: {said}")
        said.append(self._chosen(channel, said, is_sure=is_sure))
        return said[-1]

    def _chosen(self, channel: str, said: list[str], *, is_sure: bool) -> str:
        if is_sure:
            (self.by_moving if "move" in said else self.by_enter).append(channel)
            return ""
        if channel == MOVED and "move" not in said:
            return "move"
        word = f"w{self._manual[channel]}"
        if said and said[-1] == word:  # it is not among the rows: a value of another moment
            self.by_manual.remove(channel)
            return "again"
        self.by_manual.append(channel)
        return word

    def move(self, channel: str) -> None:
        """Press on the roller of the load cell, which the plant has as a fault of its reading."""
        ask(self._socket, f"fault absurd={channel}@{self.walk_s:g}:{self.pressed_s:g}")

    def mean(self, channel: str) -> float:
        """Return what a display shows of a channel, which smooths it; a radius at this moment."""
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
