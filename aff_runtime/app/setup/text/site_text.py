"""The site file that follows from what is known: one template, values at their places."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from importlib.resources import files

from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.interview import NEEDED, is_bus, quantity_value, second_tension
from aff_runtime.app.setup.asking.quantities import SPEED_SET, UNWIND
from aff_runtime.app.setup.asking.questions import NONE
from aff_runtime.app.setup.text import bus_text, modbus_text
from aff_runtime.app.setup.text.bus_text import bus_conditions, bus_places
from aff_runtime.app.setup.text.modbus_text import modbus_conditions, modbus_places
from aff_runtime.base.units import plain

TEMPLATE, GATEWAY = "site.template", "=gateway="
_PLACE = re.compile(r"@([a-z_]+)@")
_LEAST_COUNTS = 5.0
USUAL_CYCLE_MS = 5


def site_text(draft: Draft, *, file: str) -> str:
    """Return the text of the site file.

    Parameters
    ----------
    draft : complete: every question answered.
    file : stem of the site file's name, for the names of what will be learned.
    """
    if is_bus(draft):
        gateway = _filled(bus_text.TEMPLATE, bus_conditions(draft), bus_places(draft))
    else:
        gateway = _filled(modbus_text.TEMPLATE, modbus_conditions(draft), modbus_places(draft))
    lines = _filled(TEMPLATE, _conditions(draft), _places(draft, file))
    at = lines.index(GATEWAY)
    return "\n".join((*lines[:at], *gateway, *lines[at + 1 :])) + "\n"


def _filled(template: str, conditions: Mapping[str, bool], places: Mapping[str, str]) -> list[str]:
    """Return the lines of a template whose condition holds, with values at their places."""
    lines = []
    text = files(__package__).joinpath(template).read_text(encoding="utf-8")
    for line in text.splitlines():
        condition, bar, rest = line[1:].partition("|") if line.startswith("?") else ("", "", line)
        if bar and not conditions[condition]:
            continue
        filled = _PLACE.sub(lambda match: places[match[1]], rest)
        if filled or not rest:
            lines.append(filled)
    return lines


def _conditions(draft: Draft) -> dict[str, bool]:
    answers, second, found = draft.answers, draft.second, draft.found
    own_order = answers.get("status.order") == "yes"
    enables = own_order or answers.get("bits.AFF_ENABLE_REQUEST", NONE) != NONE
    is_shape = answers["law"] == "shape"
    facts = {
        "plc_enables": enables,
        "reference": "tension_ref_N" in found,
        "shape": is_shape,
        "speed_set": SPEED_SET in found,
    }
    against = {
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
        "untold": is_shape and "tension_ref_N" not in found,
        "unwind_angle": f"{UNWIND}_angle_rad" in found,
        "second": bool(second),
        "second_angle": f"{second}_angle_rad" in found,
        "second_speed": f"{second}_speed_m_s" in found and f"{second}_angle_rad" not in found,
    }


def _places(draft: Draft, file: str) -> Mapping[str, str]:
    answers = draft.answers
    stem = re.sub(r"[^A-Za-z0-9_-]", "_", file) or "site"
    kept = ("law", "second", "speed_max", "radius_min", "radius_max", "second_radius",
            "speed_gain", "zeta", "inertia", "density", "width", "core", "probe",
            "usual_tension")  # fmt: skip
    return {
        **{name: answers.get(name, "") for name in kept},
        **_limits(draft),
        "second_tension": second_tension(draft),
        "name": json.dumps(answers["name"], ensure_ascii=False),
        "file": stem,
        "cycle_ms": str(_cycle_ms(answers.get("scan_ms", ""))),
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


def _limits(draft: Draft) -> dict[str, str]:
    """Return limits and believable values; rounded outwards, for a technician to tighten."""
    tension_N = quantity_value(draft, "tension_max", "N")
    speed_m_s = quantity_value(draft, "speed_max", "m/s")
    limit = quantity_value(draft, "limit", "m/s")
    count = quantity_value(draft, "correction_scale", "m/s")
    other = f"correction_scale.{draft.second}"
    second_count = quantity_value(draft, other, "m/s") if other in draft.answers else count
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
        limits["amp_follower"] = _amplitude(min(0.03, follower), second_count)
    return limits


def _amplitude(wanted: float, count: float) -> str:
    return plain(float(f"{max(wanted, _LEAST_COUNTS * count):.3g}"))


def _needed(draft: Draft) -> list[str]:
    if draft.answers.get("status.order") == "yes":
        return list(NEEDED)
    return [name for name in NEEDED if draft.answers.get(f"bits.{name}", NONE) != NONE]
