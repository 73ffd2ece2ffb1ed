"""Section ``gateway`` of the site file on Modbus: registers, as the PLC's manual counts them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.interview import (
    BITS,
    angles_of,
    quantities_of,
    roll_names,
    style_of,
)
from aff_runtime.app.setup.asking.questions import NONE, split_bit

TEMPLATE = "gateway_modbus.template"
_LARGEST_SHORT = 9998  # of 40001..49999


def modbus_conditions(draft: Draft) -> dict[str, bool]:
    """Return which lines of the section stand."""
    answers = draft.answers
    own_order = answers.get("status.order") == "yes"
    echo = answers.get("echo", NONE) != NONE
    applied = any(answers.get(f"applied.{roll}", NONE) != NONE for roll in roll_names(draft))
    return {
        "aff_order": own_order,
        "own_bits": not own_order,
        "echo": echo,
        "no_echo": not echo,
        "applied": applied,
        "no_applied": not applied,
        "tcp": answers["wire"] == "modbus_tcp",
        "further": any(name in draft.words for name in draft.further),
    }


def modbus_places(draft: Draft) -> dict[str, str]:
    """Return what fills the places of the section."""
    answers = draft.answers
    echo = answers.get("echo", NONE)
    kept = ("wire", "port", "device_id", "function")
    return {
        **{name: answers.get(name, "") for name in kept},
        **{
            name: str(register_number(draft, int(answers[name])))
            for name in ("heartbeat", "roll_id")
        },
        **_written(draft),
        **_channels(draft),
        "host": json.dumps(answers["host"], ensure_ascii=False),
        "base": "1" if style_of(draft) else "0",
        "order": draft.order or "high_first",
        "status": str(register_number(draft, int(answers["status.word"]))),
        "status_bits": _status_bits(draft),
        "echo": "" if echo == NONE else str(register_number(draft, int(echo))),
        "applied": _applied(draft),
        "corrections": _corrections(draft),
    }


def register_number(draft: Draft, address: int) -> int:
    """Return the number of a wire address in the PLC's manual, as the site file will say it."""
    style = style_of(draft)
    if style == 40001 and address > _LARGEST_SHORT:
        style = 400001
    if style == 1 and 40001 <= address + 1 <= 49999:
        style = 400001  # 40001..49999 would mean others
    return address + style


def _written(draft: Draft) -> dict[str, str]:
    """Return the numbers of the written words, in the order of the gateway block."""
    first = int(draft.answers["write"])
    offsets = {
        "aff_heartbeat": 0,
        "state": 1,
        "echo": 2,
        "alarm": 5,
        "limit": 6,
        "config_revision": 7,
    }
    return {
        f"write_{name}": str(register_number(draft, first + offset))
        for name, offset in offsets.items()
    }


def _corrections(draft: Draft) -> str:
    first, scale = int(draft.answers["write"]), draft.answers["correction_scale"]
    rows = []
    for roll, offset in zip(roll_names(draft), (3, 8), strict=False):
        word = register_number(draft, first + offset)
        copy = register_number(draft, first + offset + 1)
        rows.append(f"      {roll}: {{ register: {word}, complement: {copy}, scale: {scale} }}")
    return "\n".join(rows)


def _channels(draft: Draft) -> dict[str, str]:
    """Return a line per channel: what is measured first, then angles, then what is further."""
    own = [quantity.channel for quantity in (*quantities_of(draft), *angles_of(draft))]
    return {
        "channels": "\n".join(_rows(draft, own)),
        "further": "\n".join(_rows(draft, draft.further)),
    }


def _rows(draft: Draft, channels: Iterable[str]) -> Iterator[str]:
    for channel in channels:
        word = draft.words.get(channel)
        if word is None:
            continue
        register = register_number(draft, word.address)
        wraps = ", wraps: true" if channel.endswith("_rad") else ""
        wraps += f", wraps_after: {word.wraps_after}" if word.wraps_after else ""
        if word.unseen_s:
            watched = f"Its end was not seen in {word.unseen_s:.0f} s of setup"
            yield f"      # {watched}: take from the manual of"
            yield "      # the PLC whether it is one word or two, and where it starts over."
        said = f"{{ register: {register}, type: {word.type}, scale: {word.scale}{wraps} }}"
        yield f"      {channel}: {said}"


def _applied(draft: Draft) -> str:
    scale = draft.answers["correction_scale"]
    return "\n".join(
        f"      {roll}: {{ register: {register_number(draft, int(word))}, scale: {scale} }}"
        for roll in roll_names(draft)
        if (word := draft.answers.get(f"applied.{roll}", NONE)) != NONE
    )


def _status_bits(draft: Draft) -> str:
    if draft.answers.get("status.order") == "yes":
        return ""
    own, rows = int(draft.answers["status.word"]), []
    for name, _, _ in BITS:
        kept = draft.answers.get(f"bits.{name}", NONE)
        if kept == NONE:
            continue
        address, bit, inverted = split_bit(kept)
        where = "" if address == own else f"register: {register_number(draft, address)}, "
        rows.append(
            f"        {name}: {{ {where}bit: {bit}{', inverted: true' if inverted else ''} }}"
        )
    return "\n".join(rows)
