"""A learned shape as a file next to the learned response, and hashes that say whether it applies.

``learned/x.json`` is the response, ``learned/x.shape.json`` the shape. Deviations are in mm of
moment arm where the encoder reads zero, so that a technician can read them.
"""

from __future__ import annotations

import cmath
import hashlib
import json
import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from aff_runtime.base.errors import UNREADABLE, ConfigError
from aff_runtime.config.models import Site
from aff_runtime.config.plain_file import TooLargeError, read_plain
from aff_runtime.core.params import IMBALANCE_N_M_PER_M
from aff_runtime.core.response import Response
from aff_runtime.core.shape.profile import ShapeProfile

FORMAT = "aff-learned-shape-1"
WAITS = "waits for its trial"  # in the sentence about a shape, until its trial is over
MAX_FILE_BYTES = 65536
# The most that a file may hold; `MAX_LOOP` is of a response ratio less 1, which has no unit.
MAX_DEVIATION_M, MAX_LOOP, MAX_TORQUE_N_M, MAX_ORDER = 1.0, 100.0, 1e5, 64
MAX_RADIUS_M = 10.0
LARGEST_SHOWN = 1e300  # a longer whole number has no float


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeFile:
    """Shapes of the rolls of one actuator, as they were learned.

    Attributes
    ----------
    belongs_to : hash of what the shape rests on (``shape_basis_hash``).
    response : hash of the measured response that the response ratios are over
        (``response_hash``); empty in a file of an older release.
    roll_id : the PLC's counter of splices when it was saved.
    radius_m : radius by roll when it was saved.
    web : declared density, width of the web.
    profile : W by (roll, order), m, where the encoder reads zero; response ratio less 1;
        imbalance, in the file as a torque.
    """

    actuator: str
    belongs_to: str
    response: str
    config_hash: str
    saved_at: str
    version: str
    roll_id: int
    radius_m: Mapping[str, float]
    web: Mapping[str, float]
    profile: ShapeProfile

    def to_json(self) -> str:
        """Return text that ``from_json`` reads back."""
        rows = [
            {
                "roll": roll,
                "order": order,
                "deviation_mm": 1e3 * abs(w),
                "angle_deg": math.degrees(cmath.phase(w)),
                "loop_re": self.profile.response_ratio_less_1.get((roll, order), 0j).real,
                "loop_im": self.profile.response_ratio_less_1.get((roll, order), 0j).imag,
            }
            for (roll, order), w in self.profile.weight_m.items()
        ]
        imbalance_rows = [
            {
                "roll": roll,
                "torque_N_m": IMBALANCE_N_M_PER_M * abs(w),
                "angle_deg": math.degrees(cmath.phase(w)),
            }
            for roll, w in self.profile.imbalance_m.items()
        ]
        head = {name: getattr(self, name) for name in _HEAD}
        about = {"radius_m": dict(self.radius_m), "web": dict(self.web)}
        shapes = {"orders": rows, "imbalance": imbalance_rows}
        return json.dumps({"format": FORMAT, **head, **about, **shapes}, allow_nan=False)

    def without(self, rolls: Collection[str]) -> ShapeFile:
        """Return the file without the shapes of some rolls; what was learned of P stays."""
        shape = self.profile
        left = ShapeProfile(
            weight_m={key: w for key, w in shape.weight_m.items() if key[0] not in rolls},
            response_ratio_less_1=shape.response_ratio_less_1,
            imbalance_m={roll: w for roll, w in shape.imbalance_m.items() if roll not in rolls},
        )
        return replace(self, profile=left)

    @classmethod
    def from_json(cls, text: str) -> ShapeFile:
        """Read ``to_json``'s text; ConfigError says what is wrong with any other."""
        try:
            data = json.loads(text)
            if data["format"] != FORMAT:
                raise ConfigError(f"shape format {data['format']!r}, need {FORMAT!r}")
            weight: dict[tuple[str, int], complex] = {}
            response_ratio_less_1: dict[tuple[str, int], complex] = {}
            for row in data["orders"]:
                at = (str(row["roll"]), int(row["order"]))
                turn = math.radians(float(row["angle_deg"]))
                weight[at] = cmath.rect(1e-3 * float(row["deviation_mm"]), turn)
                response_ratio_less_1[at] = complex(float(row["loop_re"]), float(row["loop_im"]))
            imbalance_m = {
                str(row["roll"]): cmath.rect(
                    float(row["torque_N_m"]) / IMBALANCE_N_M_PER_M,
                    math.radians(float(row["angle_deg"])),
                )
                for row in data["imbalance"]
            }
            found = cls(
                **{name: str(data[name]) for name in _HEAD if name not in {"roll_id", "response"}},
                response=str(data.get("response", "")),
                roll_id=int(data["roll_id"]),
                radius_m={str(k): float(v) for k, v in data["radius_m"].items()},
                web={str(k): float(v) for k, v in data["web"].items()},
                profile=ShapeProfile(
                    weight_m=weight,
                    response_ratio_less_1=response_ratio_less_1,
                    imbalance_m=imbalance_m,
                ),
            )
        except UNREADABLE as error:
            raise ConfigError(f"not a shape file: {error!r}; the roll is learned anew") from error
        if (odd := _odd_number(found)) is not None:
            raise ConfigError(f"not a shape file: {odd}; the roll is learned anew")
        return found


def _odd_number(file: ShapeFile) -> str | None:
    """Return which number cannot be a roll's, None when all can; NaN cannot."""
    shape = file.profile
    rows: list[tuple[str, float, float, str]] = []
    for (roll, order), w in shape.weight_m.items():
        rows.append((f"order of {roll}", order, MAX_ORDER, ""))
        rows.append(
            (f"deviation_mm of {roll} {order}x", 1e3 * abs(w), 1e3 * MAX_DEVIATION_M, "mm")
        )
    for (roll, order), d in shape.response_ratio_less_1.items():
        rows.append((f"loop_re, loop_im of {roll} {order}x", abs(d), MAX_LOOP, ""))
    for roll, w in shape.imbalance_m.items():
        torque = IMBALANCE_N_M_PER_M * abs(w)
        rows.append((f"torque_N_m of {roll}", torque, MAX_TORQUE_N_M, "N m"))
    for roll, radius in file.radius_m.items():
        rows.append((f"radius_m of {roll}", radius, MAX_RADIUS_M, "m"))
    for name, size, most, unit in rows:
        least = 1 if name.startswith("order") else 0
        if not least <= size <= most:
            shown = f"{min(size, LARGEST_SHOWN):g} {unit}".rstrip()
            return f"{name} is {shown}, expected {least} to {most:g}"
    for name, value in file.web.items():
        if not math.isfinite(value):
            return f"{name} of web is {value:g}, expected a number"
    return None


_HEAD = ("actuator", "belongs_to", "response", "config_hash", "saved_at", "version", "roll_id")


def shape_basis_hash(site: Site, actuator: str) -> str:
    """Return a hash of what a shape rests on: rolls, their encoders, the drive, the signal.

    Limits, memory, orders and everything else may change and leave a shape what it is.
    """
    settings = site.actuators[actuator]
    channels = site.gateway.read.channels
    rolls = {}
    for name in sorted({block.roll for block in settings.blocks}):
        angle = site.rolls[name].angle
        scale = channels[angle].scale if angle is not None else None
        rolls[name] = [angle, scale, site.rolls[name].radius_m]
    drive = settings.drive.model_dump(mode="json") if settings.drive is not None else None
    content = [settings.error.signal, settings.output, drive, rolls]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def response_hash(text: str | None) -> str:
    """Return a hash of a response's delay and points; empty without a response.

    Layout and provenance of the file do not change it.

    Raises
    ------
    ConfigError
        When ``text`` is no response.
    """
    if text is None:
        return ""
    measured = Response.from_json(text)
    content = [measured.delay_s, [asdict(point) for point in measured.points]]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def read_shapes(paths: Mapping[str, Path]) -> tuple[dict[str, str], list[str]]:
    """Return the texts of the shape files that are there, and what is wrong with the others."""
    texts: dict[str, str] = {}
    faults: list[str] = []
    for actuator, path in paths.items():
        try:
            text = read_plain(path, MAX_FILE_BYTES).decode("utf-8")
            ShapeFile.from_json(text)
            texts[actuator] = text
        except FileNotFoundError:
            continue
        except (OSError, ValueError, ConfigError) as error:
            faults.append(f"{path}: {_why_not(error)}")
    return texts, faults


def _why_not(error: Exception) -> str:
    """Return in a sentence why a file gave no shape."""
    match error:
        case ConfigError():
            return str(error)
        case UnicodeDecodeError():
            return "not a shape file: not text; the roll is learned anew"
        case TooLargeError():
            return "not a shape file: too long; the roll is learned anew"
        case IsADirectoryError() | ValueError():
            return "not a shape file: not a file at all; the roll is learned anew"
        case OSError():
            return f"{error.strerror}; the roll is learned anew"
    return str(error)


def start_values(site: Site, actuator: str) -> dict[tuple[str, int], complex]:
    """Return the deviations that the site file starts from, m, by (roll, order)."""
    return {
        (block.roll, entry.order): cmath.rect(entry.deviation_m, entry.angle_rad)
        for block in site.actuators[actuator].blocks
        if block.enabled
        for entry in block.start
    }
