"""The technician who plays `aff-runtime setup`: his plants, and what he types."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.interview import bit_questions, first_number, status_questions
from aff_runtime.config.loader import load_site
from benchmarks.setup_console.at_the_machine import MOST_TRIES, StuckError
from benchmarks.setup_console.page import page
from benchmarks.setup_console.plants import FURTHER, PLANTS
from benchmarks.setup_console.technician import Technician
from benchmarks.setup_console.words import wrong_words
from sim_plant.demo.unusual_plants import LINE
from sim_plant.line.yaml_file import load_yaml
from sim_plant.servers.map_file import load_plc_map

WHICH = "Which one? `again`: type the value at another moment; `move`: move it, and see: "
SHOWS = "What does the drive show now as {what}, all digits and the unit?: "


class AtTheDisplay(Technician):
    """A technician whose displays stand still, and who moves nothing."""

    def __init__(self, **answers: str) -> None:
        manual = {"unwind_tension_N": 2, "r3_tension_N": 19}
        named = {name.replace("__", "."): text for name, text in answers.items()}
        super().__init__(Path(), 5020, manual, named)
        self.moves = 0

    def mean(self, channel: str) -> float:
        return 90.0

    def move(self, channel: str) -> None:
        self.moves += 1


@pytest.mark.parametrize("name", PLANTS)
def test_every_plant_has_a_map_and_a_line_with_what_is_unlike(name: str, tmp_path: Path) -> None:
    plc = load_plc_map(PLANTS[name].plc_map(tmp_path))
    assert {item.name for item in plc.channels} >= FURTHER.keys()
    line = PLANTS[name].line_file(tmp_path)
    assert load_yaml(line)[0]
    is_edited = bool(PLANTS[name].line)
    assert (line.read_text() != LINE.read_text()) is is_edited


def test_he_moves_what_values_do_not_tell_and_takes_the_row_that_moved_by_enter() -> None:
    who = AtTheDisplay()
    assert who.answer(SHOWS.format(what="web tension behind the unwind")) == "20.2 lbf"
    assert who.answer(WHICH) == "move"
    assert (
        who.answer("Enter; then, within 45 s, move this alone for some seconds: x [done]: ") == ""
    )
    assert who.answer(WHICH.replace(": ", " [1]: ")) == ""
    assert (who.moves, who.by_moving, who.by_manual) == (1, ["unwind_tension_N"], [])


def test_a_word_that_is_no_row_is_asked_for_at_another_moment_and_not_for_ever() -> None:
    who = AtTheDisplay()
    who.answer(SHOWS.format(what="r3_tension_N"))
    said = [who.answer(WHICH) for _ in range(MOST_TRIES + 1)]
    assert said == ["w19", "again", "w19", "again", "w19"]
    with pytest.raises(StuckError, match="r3_tension_N"):
        who.answer(WHICH)


def test_what_a_plant_has_otherwise_he_says_to_the_question_of_that_name() -> None:
    """An answer by a name that no question of the console has would never be given."""
    status = PLANTS["status bits of its own"].answers
    who = AtTheDisplay(
        number="40001", **{name.replace(".", "__"): a for name, a in status.items()}
    )

    def known(_: int) -> str:
        return ""

    draft = Draft(answers={"heartbeat": "0"})
    asked = (first_number(0), *status_questions(known), *bit_questions(draft, known))
    said = {one.name: who.answer(f"{one.text}: ") for one in asked}
    assert {name: text for name, text in said.items() if text} == {
        **status, "number": "40001", "status.word": "1"
    }  # fmt: skip


def test_a_question_that_nothing_answers_is_not_asked_for_ever() -> None:
    who = AtTheDisplay()
    assert [who.answer("Colour of the web: ") for _ in range(MOST_TRIES)] == [""] * MOST_TRIES
    with pytest.raises(StuckError, match="Colour of the web"):
        who.answer("Colour of the web: ")


@pytest.mark.parametrize(
    ("when", "day"),
    [({"measured": "2026-11-27T16:40:00+00:00"}, "2026-11-27"), ({}, "not recorded")],
)
def test_the_page_counts_a_step_by_its_last_measurement_and_tells_what_failed(
    tmp_path: Path, when: dict[str, str], day: str
) -> None:
    folder = tmp_path / "shipped"
    folder.mkdir()
    setup = {"exit": 0, "questions": 70, "seconds": 80, "writes": 0, "wrong": ["one is not there"]}
    setup |= {"by_enter": ["a"], "by_moving": ["b"], "by_manual": ["c", "d"]}
    (folder / "setup.json").write_text(json.dumps(setup))

    def note(step: str, *said: str, code: int = 0) -> dict[str, Any]:
        return {"step": step, "seconds": 1.0, "exit": code, "said": said}

    notes = [
        note("step 3", "step 3: open"),
        note("step 3", "remark    all is well", "step 3: pass"),
        note("sign 3", "step 3 signed"),
        note(
            "step 12",
            "FAIL  unwind: 1 dB; above 3 dB",
            *(f"remark    said {k}" for k in range(5)),
            "step 12: fail",
            code=5,
        ),
        note("sign 12", "refused", code=4),
        note("sign 12", "step 12 signed"),
        note("verify", "whole"),
    ]
    (folder / "card.json").write_text(json.dumps({"seconds": 600, "notes": notes} | when))
    text = page(tmp_path, ["shipped", "not played"])
    assert "| shipped | 70 | 80 | 3 of 4 | 1 | 1 | 2 | 0 |" in text
    assert f"| shipped | 2 | 1 | 1 | 0 | 0 | 2 | yes | 10 | {day} |" in text
    assert "- shipped, step 12: unwind: 1 dB; above 3 dB" in text
    assert [line for line in text.splitlines() if "remark" in line] == [
        *(f"- shipped, step 12: remark: said {k}" for k in range(3)),
        "- shipped, step 12: 2 more remarks",
    ]
    assert "not played" not in text


def test_a_word_that_is_read_otherwise_is_named(tmp_path: Path) -> None:
    site = load_site(Path("config/euclid.yaml"))
    plc = load_plc_map(PLANTS["shipped"].plc_map(tmp_path))
    wrong = wrong_words(site, plc)
    assert wrong == [f"{name} is not there" for name in FURTHER]
    edits: dict[str, Any] = {"unwind_tension_N": {"register_number": 4}}
    read = site.gateway.read.channels
    other = read["unwind_tension_N"].model_copy(update=edits["unwind_tension_N"])
    read_otherwise = site.gateway.read.model_copy(
        update={"channels": {**read, "unwind_tension_N": other}}
    )
    gateway = site.gateway.model_copy(update={"read": read_otherwise})
    changed = site.model_copy(update={"gateway": gateway})
    assert "unwind_tension_N is word 4, not 2" in wrong_words(changed, plc)
