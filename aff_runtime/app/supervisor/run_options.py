"""The options with which a service is started."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from aff_runtime.app.hand.may import Place, Role
from aff_runtime.app.link.runtime_directory import RuntimePaths
from aff_runtime.config.site_paths import STATE_DIRECTORY


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """Options of ``aff-runtime run``.

    Attributes
    ----------
    site : the site file.
    paths : runtime directory and its sockets.
    record_directory : folder of all records; None takes the site file's.
    state_directory : second folder, after the site file's own, that named files may lie in.
    shadow : compute and record, transmit zero.
    door_directory : folder of the door, opened to a group of screens; None: the private one.
    hand : the most that a screen may do; None: no screen is heard.
    hand_from : the farthest place from which a screen is heard; a bypass is heard from all.
    hand_directory : folder of the hand's socket, opened to a group; None: the private one.
    forget : start without the saved shapes of rolls that are exchanged.
    """

    site: Path
    paths: RuntimePaths
    record_directory: Path | None = None
    state_directory: Path = STATE_DIRECTORY
    door_directory: Path | None = None
    hand: Role | None = None
    hand_from: Place = Place.PANEL
    hand_directory: Path | None = None
    shadow: bool = False
    forget: bool = False
