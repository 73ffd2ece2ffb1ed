"""The site file as frozen models; one file per section."""

from aff_runtime.config.models.actuators import Actuator, Block, ErrorSignal, Start
from aff_runtime.config.models.drive import Drive
from aff_runtime.config.models.gateway import (
    CanDbc,
    Canopen402,
    Gateway,
    ModbusRtu,
    ModbusTcp,
    Tls,
)
from aff_runtime.config.models.guard import Freshness, Permissives, PlausibleRange
from aff_runtime.config.models.rolls import Roll
from aff_runtime.config.models.service import Probe, RecordingSettings
from aff_runtime.config.models.site import Line, Site
from aff_runtime.config.models.words import (
    Applied,
    Channel,
    Correction,
    ReadBlock,
    ReadWord,
    StatusBit,
    StatusBits,
    StatusWord,
    WriteBlock,
    WriteWord,
)

__all__ = [
    "Actuator",
    "Applied",
    "Block",
    "CanDbc",
    "Canopen402",
    "Channel",
    "Correction",
    "Drive",
    "ErrorSignal",
    "Freshness",
    "Gateway",
    "Line",
    "ModbusRtu",
    "ModbusTcp",
    "Permissives",
    "PlausibleRange",
    "Probe",
    "ReadBlock",
    "ReadWord",
    "RecordingSettings",
    "Roll",
    "Site",
    "Start",
    "StatusBit",
    "StatusBits",
    "StatusWord",
    "Tls",
    "WriteBlock",
    "WriteWord",
    "drive",
    "gateway",
    "service",
]
