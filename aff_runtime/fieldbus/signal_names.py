"""Which signal of a bus with frames means what to the runtime."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from aff_runtime.base.errors import ConfigError


class NamedError(ConfigError):
    """A signal, object or file cannot be used; ``named`` is its text in the site file."""

    def __init__(self, named: str, text: str) -> None:
        super().__init__(f"{named}: {text}")
        self.named = named


class WireFileError(NamedError):
    """A file that describes the wire cannot be used; ``line`` counts from 1, 0 is the whole."""

    def __init__(self, named: str, text: str, line: int = 0) -> None:
        self._at, self._text = f":{line}" if line else "", text
        super().__init__(f"{named}{self._at}", text)
        self.named = named

    def in_folder(self, folder: Path) -> str:
        """Return the message with the file's path as it is on this machine."""
        return f"{folder / self.named}{self._at}: {self._text}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalNames:
    """Which signal (``MESSAGE.Signal``) means what; the same for every bus with frames.

    ``channels`` : name to signal, SI per physical unit, and whether it wraps.
    ``recorded_only`` : channels that no correction waits for.
    ``corrections`` : name to signal, signal of the complement (empty: none), SI per unit.
    ``applied`` : name of the correction to the signal that shows it applied, SI per unit.
    """

    plc_heartbeat: str
    status: str
    roll_id: str
    channels: Mapping[str, tuple[str, float, bool]]
    aff_heartbeat: str
    state: str
    corrections: Mapping[str, tuple[str, str, float]]
    echo: str = ""
    alarm: str = ""
    limit: str = ""
    config_revision: str = ""
    aff_echo: str = ""
    applied: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    recorded_only: frozenset[str] = frozenset()
