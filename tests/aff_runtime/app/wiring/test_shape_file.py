"""A learned shape as a file: read back, refused, forgotten."""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from aff_runtime.app.link.answers import Answer
from aff_runtime.app.link.messages import LogLine, ShapeLearned, ShapeNews
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.peer import Peer
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.link.request_socket import Asked, Caller
from aff_runtime.app.link.requests import Ident, Request
from aff_runtime.app.report.command_counts import CommandCount, CommandTally
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.shape_shelf import ShapeShelf
from aff_runtime.app.supervisor.supervisor import Supervisor
from aff_runtime.app.wiring.shape_file import (
    ShapeFile,
    read_shapes,
    shape_basis_hash,
    start_values,
)
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError
from aff_runtime.config.loader import load_site
from aff_runtime.config.site_paths import shape_path
from aff_runtime.core.shape.profile import ShapeProfile
from tests.each_case import each_case
from tests.parameter_records import record_of

SITE = Path(__file__).parents[4] / "config" / "euclid.yaml"
WEIGHT = {("unwind", 1): 0.0009 - 0.0003j, ("unwind", 3): 1e-4j, ("swrap_follower", 1): 2e-4 + 0j}


def file(**more: Any) -> ShapeFile:
    known: dict[str, Any] = {
        "actuator": "unwind",
        "belongs_to": "b",
        "response": "r",
        "config_hash": "c",
        "saved_at": "t",
        "version": "v",
        "roll_id": 3,
        "radius_m": {"unwind": 0.2, "swrap_follower": 0.15},
        "web": {"density_kg_m3": 395.0},
        "profile": ShapeProfile(
            weight_m=WEIGHT,
            response_ratio_less_1={("unwind", 1): 0.1 - 0.2j},
            imbalance_m={"unwind": 4e-4j},
        ),
    }
    return ShapeFile(**{**known, **more})


def parameters(folder: Path) -> ParameterRecord:
    return record_of(load_site(SITE), shape_files={"unwind": folder / "x.shape.json"})


def test_what_is_written_is_read_back() -> None:
    back = ShapeFile.from_json(file().to_json())
    for key, w in WEIGHT.items():
        assert back.profile.weight_m[key] == pytest.approx(w)
    assert back.profile.response_ratio_less_1["unwind", 1] == pytest.approx(0.1 - 0.2j)
    assert back.profile.imbalance_m["unwind"] == pytest.approx(4e-4j)
    assert (back.roll_id, back.radius_m) == (3, {"unwind": 0.2, "swrap_follower": 0.15})


def test_a_technician_reads_mm_and_degrees() -> None:
    row = json.loads(file().to_json())["orders"][1]
    assert (row["order"], row["deviation_mm"]) == (3, pytest.approx(0.1))
    assert row["angle_deg"] == pytest.approx(90.0)
    (heavy,) = json.loads(file().to_json())["imbalance"]
    assert heavy["torque_N_m"] == pytest.approx(0.04)  # 100 N m per metre


@each_case(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"format": "aff-learned-shape-9"}',
        "null",
        '{"format": "aff-learned-shape-1", "orders": [{}]}',
        file().to_json().replace('"roll_id": 3', '"roll_id": "x"'),
        file().to_json().replace('"deviation_mm": 0.1', '"deviation_mm": 1e999'),
        file().to_json().replace('"order": 3', f'"order": {10**400}'),
        file().to_json().replace('"density_kg_m3": 395.0', '"density_kg_m3": NaN'),
    ],
)
def test_any_other_text_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match=r"learned anew|shape format"):
        ShapeFile.from_json(text)


def test_spoilt_files_are_left_out_with_a_reason(tmp_path: Path) -> None:
    (tmp_path / "a.shape.json").write_text("{")
    (tmp_path / "b.shape.json").write_bytes(b"\xff\xfe")
    (tmp_path / "c.shape.json").mkdir()
    (tmp_path / "d.shape.json").write_text(file().to_json())
    paths = {name: tmp_path / f"{name}.shape.json" for name in "abcde"}
    texts, faults = read_shapes(paths)
    assert set(texts) == {"d"}  # e is not there, which is no fault
    assert len(faults) == 3
    assert all("learned anew" in fault for fault in faults)


def test_the_shape_lies_beside_the_response() -> None:
    assert shape_path(Path("learned/x.json")) == Path("learned/x.shape.json")


@pytest.mark.parametrize(
    ("edit", "same"),
    [
        (("    limit_m_s: 0.15", "    limit_m_s: 0.1"), True),
        (("memory_turns: 9", "memory_turns: 6"), True),
        (("14, 15, 16]", "14]"), True),
        (("inertia_kg_m2: 0.25", "inertia_kg_m2: 0.4"), False),
        (("radius_m: 0.15367", "radius_m: 0.16"), False),
    ],
)
def test_a_shape_outlives_tuning_and_not_another_drive(
    edit: tuple[str, str], same: bool, tmp_path: Path
) -> None:
    path = tmp_path / "site.yaml"
    text = SITE.read_text()
    assert edit[0] in text
    path.write_text(text.replace(*edit, 1))
    before, after = load_site(SITE), load_site(path)
    assert (shape_basis_hash(before, "unwind") == shape_basis_hash(after, "unwind")) is same


def test_forgetting_takes_the_exchanged_roll_and_keeps_the_roller(tmp_path: Path) -> None:
    said: list[str] = []
    shelf = ShapeShelf(lambda _, text: said.append(text))
    about = parameters(tmp_path)
    shelf.hear(about, ShapeLearned(actuator="unwind", file=file().to_json()))
    shelf.forget(about)
    left = ShapeFile.from_json(shelf.load(about)["unwind"]).profile.weight_m
    assert set(left) == {("swrap_follower", 1)}
    assert not ShapeFile.from_json(shelf.load(about)["unwind"]).profile.imbalance_m
    assert "the shape of unwind is forgotten" in said[-1]


@pytest.mark.parametrize(
    ("rolls", "known", "words"),
    [
        ((), (), "nothing was known of: unwind; kept: swrap_follower"),
        ((), ("unwind",), "forgotten: unwind; kept: swrap_follower"),
        (("swrap_follower",), ("swrap_follower",), "forgotten: swrap_follower; kept: unwind"),
        (
            ("swrap_follower", "unwind"),
            ("unwind",),
            "forgotten: unwind; nothing was known of: swrap_follower",
        ),
    ],
)
def test_it_is_said_what_is_forgotten_and_what_is_kept(
    tmp_path: Path, rolls: tuple[str, ...], known: tuple[str, ...], words: str
) -> None:
    shelf = ShapeShelf(lambda *_: None)
    assert shelf.forget(parameters(tmp_path), rolls, known) == words


def test_where_no_roll_is_exchanged_it_says_that_nothing_is_forgotten(tmp_path: Path) -> None:
    about = parameters(tmp_path)
    kept = {
        name: roll.model_copy(update={"resets_on": "never"})
        for name, roll in about.site.rolls.items()
    }
    site = about.site.model_copy(update={"rolls": kept})
    about = about.model_copy(update={"site": site})
    words = ShapeShelf(lambda *_: None).forget(about)
    assert words == "nothing is forgotten: no roll has resets_on: splice; name it: forget ROLL"


def test_a_roller_that_is_named_is_forgotten_in_the_file_and_the_roll_is_kept(
    tmp_path: Path,
) -> None:
    shelf, about = ShapeShelf(lambda *_: None), parameters(tmp_path)
    shelf.hear(about, ShapeLearned(actuator="unwind", file=file().to_json()))
    words = shelf.forget(about, ("swrap_follower",))
    assert words == "forgotten: swrap_follower; kept: unwind"
    left = ShapeFile.from_json(shelf.load(about)["unwind"]).profile.weight_m
    assert {roll for roll, _ in left} == {"unwind"}


def test_the_shelf_hears_of_shapes_only(tmp_path: Path) -> None:
    shelf = ShapeShelf(lambda *_: None)
    shelf.hear(parameters(tmp_path), LogLine(text="x"))
    assert shelf.sentences == []
    shelf.hear(parameters(tmp_path), ShapeNews(actuator="unwind", text="kept"))
    assert shelf.sentences == ["unwind: kept"]


def test_a_shape_that_waits_is_no_longer_said_to_wait_when_something_became_of_it(
    tmp_path: Path,
) -> None:
    shelf, about = ShapeShelf(lambda *_: None), parameters(tmp_path)
    for actuator in ("unwind", "rewind"):
        waits = ShapeNews(actuator=actuator, text="x waits for its trial: 4 s")
        shelf.hear(about, waits)
    shelf.hear(about, ShapeNews(actuator="unwind", text="starts from x"))
    assert shelf.sentences == ["rewind: x waits for its trial: 4 s", "unwind: starts from x"]


def test_a_folder_that_cannot_be_written_is_said_and_ends_nothing(tmp_path: Path) -> None:
    said: list[str] = []
    (tmp_path / "file").write_text("")
    about = parameters(tmp_path / "file")
    shelf = ShapeShelf(lambda _, text: said.append(text))
    shelf.hear(about, ShapeLearned(actuator="unwind", file=file().to_json()))
    assert "not kept" in said[0]


def test_start_values_are_deviations_at_the_encoders_zero(tmp_path: Path) -> None:
    path = tmp_path / "site.yaml"
    old = "#start: [{ order: 1, deviation_m: 0.7 mm, angle_rad: 40 deg }]"
    path.write_text(
        SITE.read_text().replace(
            old, "start: [{ order: 2, deviation_m: 0.5 mm, angle_rad: 90 deg }]"
        )
    )
    assert start_values(load_site(path), "unwind") == {("unwind", 2): pytest.approx(0.0005j)}


@each_case(
    ("old", "new", "said"),
    [
        ('"deviation_mm": 0.1,', '"deviation_mm": 1e6,', "deviation_mm of unwind 3x is 1e.06 mm"),
        ('"loop_im": -0.2', '"loop_im": 1e9', "loop_re, loop_im of unwind 1x is 1e.09"),
        ('"order": 3', '"order": -3', "order of unwind is -3, expected 1 to 64"),
        ('"torque_N_m": 0.04', '"torque_N_m": NaN', "torque_N_m of unwind is nan N m"),
        ('"unwind": 0.2', '"unwind": NaN', "radius_m of unwind is nan m"),
    ],
)
def test_a_number_that_no_roll_has_is_named(old: str, new: str, said: str) -> None:
    text = file().to_json()
    assert old in text
    with pytest.raises(ConfigError, match=f"{said}.*learned anew"):
        ShapeFile.from_json(text.replace(old, new, 1))


def test_a_folder_that_may_not_be_read_is_said_and_ends_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def denied(_: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "stat", denied)  # root may read everything
    texts, (fault,) = read_shapes({"unwind": tmp_path / "x.shape.json"})
    assert not texts
    assert fault.endswith("x.shape.json: Permission denied; the roll is learned anew")


def test_a_folder_in_the_place_of_a_shape_is_called_one(tmp_path: Path) -> None:
    _, (fault,) = read_shapes({"unwind": tmp_path})
    assert "not a file at all" in fault


class Answered(Caller):
    """A caller that keeps its answer."""

    def __init__(self) -> None:
        self.peer, self.owed = Peer(uid=1000, pid=7), 0
        self.said: list[Any] = []

    def send(self, answer: Answer, ident: Ident = None) -> None:
        self.said.append(answer.to_json())


@pytest.mark.parametrize("quiet", [True, False])
def test_a_refused_forget_leaves_the_files_alone(tmp_path: Path, quiet: bool) -> None:
    about, shelf = parameters(tmp_path), ShapeShelf(lambda *_: None)
    shelf.hear(about, ShapeLearned(actuator="unwind", file=file().to_json()))
    sent: list[Any] = []
    link = SimpleNamespace(send=lambda message: sent.append(message) or True)
    made = Supervisor.__new__(Supervisor)  # its requests alone, without processes
    made._pending, made._counts = Pending(MonotonicClock()), CommandTally()
    made._processes = SimpleNamespace(  # type: ignore[assignment]
        parameters=about,
        shapes=shelf,
        control=SimpleNamespace(link=link),
        note=lambda *_: None,
        note_operator=lambda *_: None,
    )
    caller = Answered()
    made._serve_request(Asked(caller, Request(do="forget")))
    path = about.shape_files["unwind"]
    before = path.read_text()
    made._pending.resolve(Reply(id=sent[0].id, ok=quiet))
    kept = "forgotten: unwind; kept: swrap_follower"
    assert caller.said == [{"ok": True, "message": kept} if quiet else {"ok": False}]
    result = "done" if quiet else "refused"
    assert made._counts.rows() == (
        CommandCount(action="forget", via="cli", result=result, count=1),
    )
    assert (path.read_text() == before) is not quiet


def test_a_file_that_cannot_be_forgotten_is_said_to_the_operator(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    about, shelf = parameters(tmp_path), ShapeShelf(lambda *_: None)
    shelf.hear(about, ShapeLearned(actuator="unwind", file=file().to_json()))
    monkeypatch.setattr(os, "fsync", full)  # for root too
    made = Supervisor.__new__(Supervisor)
    made._processes = SimpleNamespace(parameters=about, shapes=shelf)  # type: ignore[assignment]
    said = made._forget_files((), Reply(id=1, ok=True))
    assert (said.ok, said.exit_code) == (False, 2)
    assert "is not forgotten" in said.message
