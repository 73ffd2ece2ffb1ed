"""Which signal of a bus with frames means what to the runtime."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from aff_runtime.base.errors import ConfigError


class NamedError(ConfigError):
    """A signal, object or file cannot be used; ``named`` is its text in the site file."""

    def __init__(self, named: str, text: str) -> None:
        super().__init__(f"{named}: {text}")
        self.named = named


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalNames:
    """Which signal (``MESSAGE.Signal``) means what; the same for every bus with frames.

    ``channels`` : name to signal, SI per physical unit, and whether it wraps.
    ``corrections`` : name to signal, signal of the complement (empty: none), SI per unit.
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
