"""Every target by name: what is fuzzed, and the inputs to begin with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tests.fuzz import (
    can_targets,
    commission_targets,
    config_targets,
    door_targets,
    hand_targets,
    modbus_targets,
    record_targets,
    screen_targets,
    socket_targets,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """``run`` takes any bytes, says in a word what became of them, and raises for nothing."""

    run: Callable[[bytes], str]
    seeds: Sequence[bytes]
    good: str = "ok"  # the word that says that the input was taken for true


TARGETS = {
    "modbus_reply": Target(run=modbus_targets.reply, seeds=modbus_targets.SEEDS),
    "modbus_stream": Target(run=modbus_targets.stream, seeds=modbus_targets.SEEDS),
    "modbus_serial": Target(run=modbus_targets.serial, seeds=modbus_targets.SEEDS),
    "modbus_words": Target(run=modbus_targets.words, seeds=modbus_targets.SEEDS),
    "plc_pdu": Target(run=modbus_targets.plc_pdu, seeds=modbus_targets.SEEDS),
    "can_ticks": Target(run=can_targets.ticks, seeds=can_targets.SEEDS),
    "can_command": Target(run=can_targets.command, seeds=can_targets.SEEDS),
    "canopen": Target(run=can_targets.canopen, seeds=can_targets.SEEDS),
    "slcan_line": Target(run=can_targets.slcan_line, seeds=can_targets.SEEDS),
    "dbc_text": Target(run=can_targets.dbc_text, seeds=can_targets.SEEDS),
    "eds_text": Target(run=can_targets.eds_text, seeds=can_targets.SEEDS),
    "site_file": Target(run=config_targets.site, seeds=config_targets.SEEDS),
    "yaml_merges": Target(run=config_targets.merges, seeds=config_targets.SEEDS),
    "response_file": Target(run=config_targets.response, seeds=config_targets.SEEDS),
    "record_text": Target(run=record_targets.text, seeds=record_targets.SEEDS),
    "record_parquet": Target(run=record_targets.parquet, seeds=record_targets.SEEDS),
    "record_mdf": Target(run=record_targets.mdf, seeds=record_targets.SEEDS),
    "mdf_conversion": Target(run=record_targets.conversion, seeds=record_targets.SEEDS),
    "shape_file": Target(run=config_targets.shape, seeds=config_targets.SEEDS),
    "control_socket": Target(run=socket_targets.socket_lines, seeds=socket_targets.SEEDS),
    "door_packet": Target(run=door_targets.packet, seeds=door_targets.SEEDS),
    "commission_request": Target(run=commission_targets.request, seeds=commission_targets.SEEDS),
    "hand_packet": Target(run=hand_targets.packet, seeds=hand_targets.SEEDS),
    "screen_request": Target(run=screen_targets.request, seeds=screen_targets.REQUESTS),
    "screen_receipt": Target(run=screen_targets.receipt, seeds=screen_targets.RECEIPTS),
}
