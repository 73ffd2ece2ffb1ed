"""The config loader under any edit: refused with findings, or just what the file says."""

from __future__ import annotations

import json
import math
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from aff_runtime.app.wiring.shape_file import ShapeFile
from aff_runtime.base.errors import ConfigError
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from aff_runtime.config.yaml_marks import parse_marked
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.core.shape.profile import ShapeProfile
from tests import quick_yaml
from tests.fuzz.source import Source

CONFIG = Path(__file__).parents[2] / "config"
SITES = ("euclid.yaml", "euclid_can.yaml", "euclid_canopen.yaml")
TEXTS = {name: (CONFIG / name).read_text(encoding="utf-8") for name in SITES}
VALUES = (
    "nan",
    ".nan",
    ".inf",
    "-.inf",
    "1e400",
    "-1",
    "0",
    "0.0",
    "010",
    "0x10",
    "1_000",
    "1:30",
    "~",
    "null",
    "true",
    "no",
    "''",
    "[]",
    "{}",
    "[1, 2]",
    "{a: 1}",
    "5 ms",
    "5 s",
    "-5 m/s",
    "1 furlong",
    "5 m s",
    "1,5",
    "1e-3",
    "99999999999999999999",
    "!!python/object/apply:os.system ['x']",
    "&a [*a]",
    "*b",
    "!!binary aGk=",
    "2026-11-21",
    "<<",
    "%",
    "'\\0'",
    '"\\u0000"',
    "1 .. 2",
    "0.05",
    "64",
    "65",
    "4.0",
    "1.0e+308",
    "-0.0",
    "5 ms # x",
    "|",
    ">",
    "unwind",
    "line_speed_m_s",
)
_SCALAR = re.compile(r"(?<=[:\[,] )[^\s,\]}{#][^,\]}#\n]*")
_FOLDER = tempfile.TemporaryDirectory(prefix="aff-fuzz-")
for described in (*CONFIG.glob("*.dbc"), *CONFIG.glob("*.eds")):
    shutil.copy(described, _FOLDER.name)


def site(data: bytes) -> str:
    """An edited site file is refused with findings, or every number is the one it says."""
    source = Source(data)
    name = source.pick(SITES)
    text = TEXTS[name]
    for _ in range(1 + source.below(4)):
        text = _edited(source, text)
    path = Path(_FOLDER.name) / name
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    try:
        found = load_site(path)
    except ConfigError as error:
        return "refused" if str(error).strip() else "refused without a word"
    _keeps_its_promises(found)
    _says_what_stands_there(found, quick_yaml.safe_load(path.read_text(encoding="utf-8")))
    return "ok"


def merges(data: bytes) -> str:
    """Sections merged into one another or themselves are refused, or what PyYAML makes of it."""
    source = Source(data)
    count = 1 + source.below(8)
    lines = []
    for k in range(count):
        keys = [f"{name}: {source.below(9)}" for name in "abc" if source.below(2)]
        known = k + (source.below(32) == 31)  # now and then itself
        keys += [f"d: *s{source.below(known)}"] if known and source.below(4) == 3 else []
        others = [f"*s{source.below(known)}" for _ in range(source.below(4) if known else 0)]
        if others:
            keys.insert(source.below(len(keys) + 1), f"<<: [{', '.join(others)}]")
        lines.append(f"s{k}: &s{k} {{ {', '.join(keys)} }}")
    whole = "\n".join(lines).encode()
    raw = source.spoilt(whole) if source.below(4) == 3 else whole
    try:
        tree = parse_marked(raw, "m.yaml")
    except ConfigError as error:
        said = str(error).splitlines()
        assert all(line.startswith("m.yaml:") for line in said)
        assert len(set(said)) == len(said)
        return "refused"
    assert set(tree.marks) >= {path for path, _ in _leaves(tree.values)}
    if raw == whole:
        assert tree.values == quick_yaml.safe_load(raw)
    return "ok"


def _edited(source: Source, text: str) -> str:
    kind = source.below(8)
    if kind < 5:
        places = list(_SCALAR.finditer(text))
        if not places:
            return text
        place = places[source.below(len(places))]
        new = source.pick(VALUES)
        return text[: place.start()] + new + text[place.end() :]
    lines = text.splitlines(keepends=True) or [""]
    at = source.below(len(lines))
    if kind == 5:
        del lines[at]
    elif kind == 6:
        lines.insert(at, lines[source.below(len(lines))])
    else:
        lines[at] = _spoilt(source, lines[at])
    return "".join(lines)


def _spoilt(source: Source, line: str) -> str:
    raw = source.spoilt(line.encode("utf-8", "surrogateescape"))
    return raw.decode("utf-8", "surrogateescape")


def _keeps_its_promises(found: Site) -> None:
    """What every accepted file must satisfy, whatever its rules are made of."""
    for path, value in _leaves(found.model_dump()):
        if isinstance(value, float):
            assert math.isfinite(value), path
    fresh = found.freshness
    assert 0.0 < fresh.hold_after_ms < fresh.fault_after_ms
    assert fresh.fault_after_ms + fresh.fade_ms <= 300.0
    assert 0.0 < found.gateway.deadline_ms < found.line.cycle_ms
    channels = found.gateway.read.channels
    assert found.line.speed in channels
    for actuator in found.actuators.values():
        assert 0.0 < actuator.limit <= 1000.0
        assert actuator.error.signal in channels
        for block in actuator.blocks:
            assert block.roll in found.rolls
            assert all(isinstance(n, int) and 1 <= n <= 64 for n in block.orders)
            assert block.amp_limit > 0.0
    assert set(found.gateway.write.corrections) >= set(found.actuators)


def _says_what_stands_there(found: Site, raw: Any) -> None:
    """Every plain number of the file, as PyYAML reads it, is the number of the site."""
    shown = dict(_leaves(found.model_dump(by_alias=True)))
    for path, value in _leaves(raw):
        if isinstance(value, int | float) and not isinstance(value, bool) and path in shown:
            read = shown[path]
            if isinstance(read, int | float) and not isinstance(read, bool):
                assert math.isclose(float(read), float(value), rel_tol=1e-12), path


def _leaves(tree: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    if isinstance(tree, Mapping):
        for key, value in tree.items():
            yield from _leaves(value, (*path, key))
    elif isinstance(tree, Sequence) and not isinstance(tree, str | bytes):
        for index, value in enumerate(tree):
            yield from _leaves(value, (*path, index))
    else:
        yield path, tree


RESPONSE = Response(
    points=[
        ResponsePoint(
            frequency_Hz=0.3 * k,
            gain=90.0 + k,
            phase_rad=-0.2 * k,
            relative_error=0.05,
            coherence=0.98,
        )
        for k in range(1, 8)
    ],
    delay_s=0.012,
    provenance=Provenance(actuator="unwind", signal="unwind_tension_N"),
).to_json()
SHAPE = ShapeFile(
    actuator="unwind",
    belongs_to="b",
    response="r",
    config_hash="c",
    saved_at="t",
    version="v",
    roll_id=3,
    radius_m={"unwind": 0.2},
    web={"density_kg_m3": 395.0},
    profile=ShapeProfile(
        weight_m={("unwind", 1): 9e-4 - 3e-4j, ("unwind", 3): 1e-4j},
        response_ratio_less_1={("unwind", 1): 0.1 - 0.2j},
        imbalance_m={"unwind": 4e-4j},
    ),
).to_json()
NUMBERS = ("NaN", "Infinity", "-1", "0", "1e400", '"x"', "null", "[]", "1e30", "9" * 400)
_NUMBER = re.compile(r"-?\d+(\.\d+)?(e-?\d+)?")


def _renumbered(source: Source, text: str) -> str:
    """Return the text with one number replaced, now and then."""
    if not source.byte() & 1:
        return text
    places = list(_NUMBER.finditer(text))
    place = places[source.below(len(places))]
    new = source.pick(NUMBERS)
    return text[: place.start()] + new + text[place.end() :]


def response(data: bytes) -> str:
    """A spoilt response file is refused, or a finite measurement."""
    return _spoilt_json(data, RESPONSE, Response)


def shape(data: bytes) -> str:
    """A spoilt file of a learned shape is refused, or finite."""
    return _spoilt_json(data, SHAPE, ShapeFile)


def _spoilt_json(data: bytes, text: str, kind: type[Response] | type[ShapeFile]) -> str:
    source = Source(data)
    text = _renumbered(source, text)
    text = source.spoilt(text.encode()).decode("utf-8", "replace")
    try:
        found = kind.from_json(text)
    except ConfigError:
        return "refused"
    for path, value in _leaves(json.loads(found.to_json())):
        assert not isinstance(value, float) or math.isfinite(value), path
    return "ok"


SEEDS = [bytes(12), bytes(range(40)), b"\x01\x02\x03" * 12, b"\x07\x07\x06\x05" * 8]
