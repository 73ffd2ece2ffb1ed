"""The site file that follows from what is known: one template, values at their places."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from importlib.resources import files

from aff_runtime.app.setup.draft import Draft
from aff_runtime.app.setup.interview import (
    BITS,
    NEEDED,
    angles_of,
    quantities_of,
    quantity_value,
    roll_names,
    second_tension,
    style_of,
)
from aff_runtime.app.setup.quantities import SPEED_SET, UNWIND
from aff_runtime.app.setup.questions import NONE, split_bit
from aff_runtime.base.units import plain

TEMPLATE = "site.template"
_PLACE = re.compile(r"@([a-z_]+)@")
_LARGEST_SHORT = 9998  # of 40001..49999
_LEAST_COUNTS = 5.0
USUAL_CYCLE_MS = 5


def site_text(draft: Draft, *, file: str) -> str:
    """Return the text of the site file.

    Parameters
    ----------
    draft : complete: every question answered.
    file : stem of the site file's name, for the names of what will be learned.
    """
    places = _places(draft, file)
    conditions = _conditions(draft)
    lines = []
    template = files(__package__).joinpath(TEMPLATE).read_text(encoding="utf-8")
    for line in template.splitlines():
        condition, bar, rest = line[1:].partition("|") if line.startswith("?") else ("", "", line)
        if bar and not conditions[condition]:
            continue
        filled = _PLACE.sub(lambda match: places[match[1]], rest)
        if filled or not rest:
            lines.append(filled)
    return "\n".join(lines) + "\n"


def register_number(draft: Draft, address: int) -> int:
    """Return the number of a wire address in the PLC's manual, as the site file will say it."""
    style = style_of(draft)
    if style == 40001 and address > _LARGEST_SHORT:
        style = 400001
    if style == 1 and 40001 <= address + 1 <= 49999:
        style = 400001  # 40001..49999 would mean others
    return address + style


def _conditions(draft: Draft) -> dict[str, bool]:
    answers, second = draft.answers, draft.second
    own_order = answers.get("status.order") == "yes"
    enables = own_order or answers.get("bits.AFF_ENABLE_REQUEST", NONE) != NONE
    applied = any(answers.get(f"applied.{roll}", NONE) != NONE for roll in roll_names(draft))
    is_shape = answers["law"] == "shape"
    facts = {
        "aff_order": own_order,
        "echo": answers.get("echo", NONE) != NONE,
        "applied": applied,
        "plc_enables": enables,
        "reference": "tension_ref_N" in draft.words,
        "shape": is_shape,
        "speed_set": SPEED_SET in draft.words,
    }
    against = {
        "aff_order": "own_bits",
        "echo": "no_echo",
        "applied": "no_applied",
        "plc_enables": "plc_does_not",
        "reference": "no_reference",
        "shape": "blocks",
        "speed_set": "no_speed_set",
    }
    facts |= {other: not facts[name] for name, other in against.items()}
    return facts | {
        "given": answers.get("probe", NONE) != NONE,
        "chosen": answers.get("probe", NONE) == NONE,
        "gain": is_shape and answers.get("speed_gain", NONE) != NONE,
        "inertia": is_shape and answers.get("inertia", NONE) != NONE,
        "wound": is_shape and answers.get("density", NONE) != NONE,
        "untold": is_shape and "tension_ref_N" not in draft.words,
        "tcp": answers["wire"] == "modbus_tcp",
        "unwind_angle": f"{UNWIND}_angle_rad" in draft.words,
        "second": bool(second),
        "further": any(name in draft.words for name in draft.further),
        "second_angle": f"{second}_angle_rad" in draft.words,
        "second_speed": f"{second}_speed_m_s" in draft.words
        and f"{second}_angle_rad" not in draft.words,
    }


def _places(draft: Draft, file: str) -> Mapping[str, str]:
    answers = draft.answers
    number = {
        key: str(register_number(draft, int(answers[key]))) for key in ("heartbeat", "roll_id")
    }
    echo = answers.get("echo", NONE)
    stem = re.sub(r"[^A-Za-z0-9_-]", "_", file) or "site"
    kept = ("wire", "port", "device_id", "function", "law", "second", "speed_max", "radius_min",
            "radius_max", "second_radius", "speed_gain", "zeta", "inertia", "density", "width",
            "core", "probe", "usual_tension")  # fmt: skip
    return {
        **{name: answers.get(name, "") for name in kept},
        **number,
        **_written(draft),
        **_limits(draft),
        "second_tension": second_tension(draft),
        "name": json.dumps(answers["name"], ensure_ascii=False),
        "host": json.dumps(answers["host"], ensure_ascii=False),
        "file": stem,
        "cycle_ms": str(_cycle_ms(answers.get("scan_ms", ""))),
        "base": "1" if style_of(draft) else "0",
        "order": draft.order or "high_first",
        "status": str(register_number(draft, int(answers["status.word"]))),
        "status_bits": _status_bits(draft),
        "echo": "" if echo == NONE else str(register_number(draft, int(echo))),
        "applied": _applied(draft),
        **_channels(draft),
        "corrections": _corrections(draft),
        "need": ", ".join(_needed(draft)),
        "hold_after_ms": plain(_hold_after_ms(answers.get("scan_ms", ""))),
    }


def _hold_after_ms(scan_ms: str) -> float:
    """Return how long a heartbeat may stand: three scans, as far as the scan is known."""
    return min(75.0, max(15.0, 3.0 * round(_scan_ms(scan_ms))))


def _cycle_ms(scan_ms: str) -> int:
    """Return the period of the control cycle: no shorter than the PLC's scan.

    Of a PLC that shows each reading twice every second tick is not new, and a probe needs more.
    """
    return min(100, max(USUAL_CYCLE_MS, round(_scan_ms(scan_ms))))


def _scan_ms(kept: str) -> float:
    return float(kept) if re.fullmatch(r"[0-9]{1,4}(\.[0-9]{1,6})?", kept) else 0.0


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


def _limits(draft: Draft) -> dict[str, str]:
    """Return limits and believable values; rounded outwards, for a technician to tighten."""
    tension_N = quantity_value(draft, "tension_max", "N")
    speed_m_s = quantity_value(draft, "speed_max", "m/s")
    limit = quantity_value(draft, "limit", "m/s")
    count = quantity_value(draft, "correction_scale", "m/s")
    limits = {
        "limit": draft.answers["limit"],
        "limit_second": draft.answers.get("limit_second", ""),
        "tension_min": plain(float(f"{tension_N / 400.0:.2g}")),
        "tension_max": plain(float(f"{tension_N:.6g}")),
        "speed_low": plain(-float(f"{0.3 * speed_m_s:.2g}")),
        "speed_high": plain(float(f"{min(50.0, 2.0 * speed_m_s):.3g}")),
        "amp_limit": _amplitude(min(0.02, limit), count),
        "amp_second": _amplitude(min(0.01, limit), count),
        "amp_follower": "",
    }
    if limits["limit_second"]:
        follower = quantity_value(draft, "limit_second", "m/s")
        limits["amp_follower"] = _amplitude(min(0.03, follower), count)
    return limits


def _amplitude(wanted: float, count: float) -> str:
    return plain(float(f"{max(wanted, _LEAST_COUNTS * count):.3g}"))


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


def _needed(draft: Draft) -> list[str]:
    if draft.answers.get("status.order") == "yes":
        return list(NEEDED)
    return [name for name in NEEDED if draft.answers.get(f"bits.{name}", NONE) != NONE]
