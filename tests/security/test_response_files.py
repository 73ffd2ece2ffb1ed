"""What lies in the place of a learned response and is none: refused in one sentence."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.check.validate import check_result
from tests.security.learned_files import learned, response, site_in


@pytest.fixture
def site(tmp_path: Path) -> Path:
    return site_in(tmp_path)


GOOD = json.loads(response("unwind"))


def spoilt(**changes: Any) -> bytes:
    return json.dumps({**GOOD, **changes}).encode()


def pointed(**changes: Any) -> bytes:
    first, *others = GOOD["points"]
    return spoilt(points=[{**first, **changes}, *others])


RESPONSES = {
    "empty": b"",
    "blank": b"\n",
    "brackets": b"[" * 100_000,
    "objects": b'{"a":' * 100_000,
    "another format": spoilt(format="x"),
    "a format that is a list": spoilt(format=[[[1]]]),
    "no points": spoilt(points=[]),
    "points that are text": spoilt(points="unwind"),
    "NaN": pointed(gain=math.nan),
    "infinity": pointed(phase_rad=math.inf),
    "a gain below 0": pointed(gain=-1.0),
    "a gain of a number too long": spoilt().replace(b"2000.0", b"9" * 5000, 1),
    "a coherence of 2": pointed(coherence=2.0),
    "an unknown key of a point": pointed(extra=1),
    "an unknown key of the provenance": spoilt(
        provenance={**GOOD["provenance"], "__class__": "x"}
    ),
    "a delay that is text": spoilt(delay_s="soon"),
    "a newline in a name": spoilt(
        provenance={**GOOD["provenance"], "actuator": "unwind\nINFO OPERATOR: arm"}
    ),
    "bytes that are no text": b"\xff\xfe\x00",
    "a megabyte of provenance": spoilt(
        provenance={**GOOD["provenance"], "measured_at": "x" * 1_000_000}
    ),
    "five megabytes": b" " * 5_000_000,
}


@pytest.mark.parametrize("raw", RESPONSES.values(), ids=RESPONSES.keys())
def test_a_response_file_that_is_none_is_refused_in_one_sentence(site: Path, raw: bytes) -> None:
    learned(site).write_bytes(raw)
    said = check_result(site)
    assert said.parameters is None
    (finding,) = said.findings
    assert finding.isprintable()
    assert finding.startswith(f"{site}:")
    assert len(finding) < 600


@pytest.mark.parametrize("kind", ["pipe", "folder", "device", "link to a device", "loop"])
def test_what_is_no_file_in_place_of_a_response_is_refused_at_once(site: Path, kind: str) -> None:
    path = learned(site)
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "loop":
        path.symlink_to(path.name)
    else:
        path.symlink_to("/dev/zero")
    said = check_result(site)
    assert said.parameters is None
    (finding,) = said.findings
    assert str(path) in finding
