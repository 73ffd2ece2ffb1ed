"""The shipped CAN site as a map, and cantools' own encoding of one scan of its PLC."""

from __future__ import annotations

from pathlib import Path

import cantools

from aff_runtime.base.signals import Command
from aff_runtime.config.can_wire import can_map_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.layout import CanMap

CONFIG = Path(__file__).parents[3] / "config"
DATABASE = cantools.database.load_file(CONFIG / "euclid.dbc")


def euclid_map() -> CanMap:
    site = load_site(CONFIG / "euclid_can.yaml")
    return can_map_of(site, wire_files(site, CONFIG))


def frame(name: str, **signals: float) -> Frame:
    message = DATABASE.get_message_by_name(name)
    return Frame(message.frame_id, False, bytes(message.encode(signals)))


def scan(
    heartbeat: int,
    *,
    tension_N: float = 90.0,
    angle: int = 0,
    echo: int = 0,
    applied_m_s: tuple[float, float] = (0.0, 0.0),
) -> list[Frame]:
    """One scan of the PLC, heartbeat last."""
    shown = dict(zip(("AppliedUnwind", "AppliedFollower"), applied_m_s, strict=True))
    low = heartbeat & 0xFF
    page = heartbeat % 2
    slow = {"TensionRef": 90.0} if page == 0 else {"UnwindRadius": 200.0}
    return [
        frame("PLC_TENSION", UnwindTension=tension_N, PullrollTension=-1.5, Counter=low),
        frame("PLC_MOTION", LineSpeed=1.016, FollowerSpeed=-0.5, Counter=low, **shown),
        frame("PLC_ANGLES", UnwindAngle=angle, FollowerAngle=-7, Counter=low),
        frame("PLC_SLOW", Page=page, Counter=low, **slow),
        frame("PLC_STATUS", PlcHeartbeat=heartbeat, Status=0x2F, RollId=41, AffEcho=echo),
    ]


def command(heartbeat: int = 1, corrections: tuple[float, ...] = (0.0, 0.0)) -> Command:
    return Command(
        heartbeat=heartbeat,
        state_bits=4,
        echo=7,
        corrections=corrections,
        alarm=0,
        limits=(0.05, 0.02),
        config_revision=0xBEEF,
    )
