"""The check in its own process, and the record it hands over."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.check.validate import MAX_RECORD_BYTES, check_result
from aff_runtime.app.link.messages import Parameters, encode
from aff_runtime.app.link.packets import MAX_PACKET_BYTES
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.app.wiring.assemble import controller_of
from aff_runtime.base.errors import ConfigError
from aff_runtime.config.learned_responses import MAX_RESPONSE_BYTES
from aff_runtime.config.loader import load_site
from aff_runtime.config.revision import site_hash_of
from aff_runtime.core.response import Provenance, Response, ResponsePoint

SITE = Path(__file__).parents[4] / "config" / "euclid_blocks.yaml"


def checked(path: Path) -> dict[str, Any]:
    """Return the check's words without a process of its own, through JSON all the same.

    Raises
    ------
    ConfigError
        As ``load_parameters``: the file is not good.
    """
    said: dict[str, Any] = json.loads(json.dumps(check_result(path).to_json()))
    if said["record"] is None:
        raise ConfigError("\n".join(said["findings"]))
    return said


def test_the_process_of_the_check_says_what_the_check_says(tmp_path: Path) -> None:
    path, learned = _learned(tmp_path)
    good = load_parameters(path)
    assert json.loads(json.dumps(good.to_json())) == checked(path)
    learned.write_text("{}")
    with pytest.raises(ConfigError) as here:
        checked(path)
    with pytest.raises(ConfigError) as there:
        load_parameters(path)
    assert str(here.value) == str(there.value)


def test_the_record_of_a_good_file_carries_the_whole_site() -> None:
    parameters = check_result(SITE).parameters
    assert parameters is not None
    assert parameters.site == load_site(SITE)
    assert parameters.site_text == SITE.read_text()
    digest = site_hash_of(load_site(SITE))
    assert len(digest) == 64
    assert parameters.revision_word == int(digest, 16) % 65536
    assert controller_of(parameters.site, {}, {}).arming_objections()


@pytest.mark.parametrize(
    ("before", "after"),
    [("version: 1", "version: 7"), ("cycle_ms: 5", "cycle: 5"), ("cycle_ms: 5", "cycle_ms: 5e0")],
)
def test_a_bad_file_comes_back_with_its_place_and_without_a_record(
    tmp_path: Path, before: str, after: str
) -> None:
    path = tmp_path / "site.yaml"
    path.write_text(SITE.read_text().replace(before, after, 1))
    line = 1 + next(i for i, t in enumerate(path.read_text().splitlines()) if after in t)
    with pytest.raises(ConfigError, match=f"site.yaml:{line}:"):
        checked(path)


def test_a_response_file_that_is_none_is_a_finding_at_its_key(tmp_path: Path) -> None:
    path = tmp_path / "site.yaml"
    path.write_text(SITE.read_text())
    (tmp_path / "learned").mkdir()
    (tmp_path / "learned" / "euclid_unwind.json").write_text('{"format": "x"}')
    with pytest.raises(ConfigError, match=r"site\.yaml:\d+:\d+  actuators\.unwind\.response"):
        checked(path)


def _learned(folder: Path) -> tuple[Path, Path]:
    path = folder / "site.yaml"
    path.write_text(SITE.read_text())
    (folder / "learned").mkdir()
    return path, folder / "learned" / "euclid_unwind.json"


@pytest.mark.parametrize("raw", [b"\xff\xfe\x00", b"[" * 100_000, b"{}"])
def test_a_spoilt_response_file_is_a_finding_and_not_a_crash(tmp_path: Path, raw: bytes) -> None:
    path, learned = _learned(tmp_path)
    learned.write_bytes(raw)
    with pytest.raises(ConfigError, match=r"site.yaml:\d+:.*unwind.response: .*not a resp"):
        checked(path)


def test_a_response_file_that_would_fill_the_memory_is_not_read(tmp_path: Path) -> None:
    path, learned = _learned(tmp_path)
    with learned.open("wb") as stream:
        stream.truncate(MAX_RESPONSE_BYTES + 1)
    assert MAX_RESPONSE_BYTES > MAX_RECORD_BYTES  # one that fits no packet is read, and says so
    with pytest.raises(ConfigError, match=r"euclid_unwind.json: is too long for a response"):
        checked(path)


def test_a_pipe_in_place_of_a_file_is_refused_at_once(tmp_path: Path) -> None:
    path, learned = _learned(tmp_path)
    os.mkfifo(learned)
    with pytest.raises(ConfigError, match=r"euclid_unwind.json: is not a file"):
        checked(path)
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(ConfigError, match=r"site.yaml:1:1 .*it is not a file"):
        checked(path)


def test_a_response_of_another_actuator_is_refused(tmp_path: Path) -> None:
    path, learned = _learned(tmp_path)
    about = Provenance(actuator="swrap_follower", signal="pullroll_tension_N")
    point = ResponsePoint(
        frequency_Hz=1.0, gain=100.0, phase_rad=0.0, relative_error=0.01, coherence=1.0
    )
    learned.write_text(Response(points=[point], delay_s=0.03, provenance=about).to_json())
    with pytest.raises(ConfigError, match="measured from swrap_follower to pullroll_tension_N"):
        checked(path)


def test_a_name_that_cannot_be_resolved_is_a_finding_of_the_host(tmp_path: Path) -> None:
    path = tmp_path / "site.yaml"
    path.write_text(SITE.read_text().replace("host: 127.0.0.1", "host: no.such.host.invalid"))
    with pytest.raises(ConfigError, match=r"site.yaml:\d+:.*modbus_tcp.host.*cannot be resolved"):
        checked(path)


def test_a_record_that_does_not_pass_to_the_control_process_is_refused(tmp_path: Path) -> None:
    path, learned = _learned(tmp_path)
    about = Provenance(actuator="unwind", signal="unwind_tension_N")
    points = [
        ResponsePoint(
            frequency_Hz=1.0 + k, gain=1.0, phase_rad=0.0, relative_error=0.01, coherence=1.0
        )
        for k in range(3000)
    ]
    learned.write_text(Response(points=points, delay_s=0.03, provenance=about).to_json())
    with pytest.raises(ConfigError, match="kB pass to the control process"):
        checked(path)


def test_a_long_comment_does_not_keep_a_site_from_running(tmp_path: Path) -> None:
    path = tmp_path / "site.yaml"
    path.write_text(SITE.read_text() + "# " + "ü" * 100_000 + "\n")
    parameters = check_result(path).parameters
    assert parameters is not None
    assert len(encode(Parameters(id=1, record=parameters.for_control()))) < MAX_PACKET_BYTES


@pytest.mark.parametrize(("cycle_s", "counts"), [(0.005, True), (0.01, False), (math.nan, True)])
def test_a_response_of_another_cycle_does_not_count(
    tmp_path: Path, cycle_s: float, counts: bool
) -> None:
    path, learned = _learned(tmp_path)
    about = Provenance(actuator="unwind", signal="unwind_tension_N", cycle_s=cycle_s)
    point = ResponsePoint(
        frequency_Hz=1.0, gain=100.0, phase_rad=0.0, relative_error=0.01, coherence=1.0
    )
    learned.write_text(Response(points=[point], delay_s=0.03, provenance=about).to_json())
    said = checked(path)
    assert ("unwind" in said["record"]["responses"]) is counts
    assert any("another cycle_ms" in finding for finding in said["findings"]) is not counts
