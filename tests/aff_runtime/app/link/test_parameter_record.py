"""The parameter record: one layout as JSON, and back as the same record."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.check.validate import check_result
from aff_runtime.app.link.messages import Parameters, Start, decode, encode
from aff_runtime.app.link.parameter_record import ParameterRecord
from tests.parameter_records import CONFIG, EUCLID, record_of

LAYOUT = [
    "site",
    "site_text",
    "site_hash",
    "learned",
    "config_hash",
    "permissives",
    "responses",
    "loops",
    "drives",
    "response_files",
    "shape_files",
    "wire_files",
    "wire_digests",
    "folder",
    "versions",
]
SITES = ("euclid.yaml", "euclid_blocks.yaml", "euclid_can.yaml", "euclid_canopen.yaml")


@pytest.mark.parametrize("name", SITES)
def test_the_result_on_a_shipped_site_comes_back_as_it_was_said(name: str) -> None:
    found = check_result(CONFIG / name)
    assert CheckResult.from_json(json.loads(json.dumps(found.to_json()))) == found


def test_the_layout_of_a_record_is_that_of_the_check() -> None:
    said = check_result(CONFIG / "euclid.yaml").checked().to_json()
    assert list(said) == LAYOUT
    assert said["site"] == EUCLID.model_dump(mode="json", by_alias=True)
    assert said["site_text"] == (CONFIG / "euclid.yaml").read_text()
    assert said["folder"] == str(CONFIG)
    learned = CONFIG / "learned"
    assert said["response_files"]["unwind"] == str(learned / "euclid_unwind.json")
    assert said["shape_files"] == {"unwind": str(learned / "euclid_unwind.shape.json")}
    assert said["permissives"][-1] == "AFF_ENABLE_REQUEST"


def test_the_control_process_gets_all_but_the_text_of_the_file() -> None:
    record = record_of(site_text="version: 1\n", responses={"unwind": "{}"}, folder=Path("/x"))
    packet = json.loads(encode(Parameters(id=1, record=record.for_control())))
    assert list(packet["record"]) == [key for key in LAYOUT if key != "site_text"]
    start = Start(record=record.for_control().starting_from({"unwind": "a shape"}))
    assert json.loads(encode(start))["record"]["shapes"] == {"unwind": "a shape"}
    assert decode(encode(start)) == start


def test_what_a_newer_check_says_besides_is_left_out_and_what_is_no_site_is_refused() -> None:
    said = record_of().to_json()
    assert ParameterRecord.from_json({**said, "news": 1}) == record_of()
    said["site"]["line"]["colour"] = "red"
    with pytest.raises(ValueError, match="colour"):
        ParameterRecord.from_json(said)


@pytest.mark.parametrize(("config_hash", "word"), [("ab" * 30 + "0102", 0x0102), ("ffff", 65535)])
def test_the_plc_is_shown_the_last_sixteen_bits_of_the_revision(
    config_hash: str, word: int
) -> None:
    assert record_of(config_hash=config_hash).revision_word == word
