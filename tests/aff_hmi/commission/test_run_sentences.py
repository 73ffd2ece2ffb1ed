"""What records lack, and what stands against refining, is told in the reader's language."""

from __future__ import annotations

import ast
import inspect
import math
import textwrap
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("numba")

from aff_hmi.commission.of_runs import maintenance_in, refined_in
from aff_hmi.commission.sentences import sentence
from aff_hmi.words import say_in
from aff_runtime.app.commission.records import maintenance_jobs, refine_jobs
from aff_runtime.app.commission.views.of_refining import AskedOf, RefinedRow, RefinedView
from aff_runtime.app.commission.views.of_weeks import MaintenanceView
from aff_runtime.app.report.watching import sentences
from aff_runtime.app.report.watching.findings import Unread
from aff_runtime.base.refinement import Summary
from sim_plant.refine.model import record_match, run_caveats
from sim_plant.refine.report import announce
from tests.each_case import each_case

ENGLISH, GERMAN = say_in("en"), say_in("de")
LACKS: tuple[Any, ...] = (
    record_match.record_caveats,
    run_caveats.run_caveats,
    run_caveats.lines_of,
    run_caveats._cost,
    announce.holdout_caveats,
)
AGAINST = (
    refine_jobs.NO_LINE,
    refine_jobs.NO_PROGRAM,
    refine_jobs.OTHER_SITE,
    refine_jobs.NO_VERDICT,
)
LEAST = 25  # characters of a sentence; what is shorter is a name or a mark


def sentences_of(function: Any) -> Iterator[str]:
    """Yield what a function says, with a number for each place."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    inside = {
        id(part)
        for node in ast.walk(tree)
        if isinstance(node, ast.JoinedStr)
        for part in node.values
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            text = "".join(
                str(part.value) if isinstance(part, ast.Constant) else "7" for part in node.values
            )
        elif (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in inside
        ):
            text = node.value
        else:
            continue
        if len(text) > LEAST and " " in text and not text.startswith("Return"):
            yield text.removeprefix("7: ")


@each_case("text", [text for function in LACKS for text in sentences_of(function)] + list(AGAINST))
def test_a_sentence_is_said_in_german_and_stays_as_it_is_in_english(text: str) -> None:
    assert sentence(text, ENGLISH) == text
    assert sentence(text, GERMAN) != text


@each_case(
    "text",
    [
        "/l.yaml: the line file is not there; copy yours there",
        "/s.yaml: no site file is there",
        "/runs: holds no run with rows yet",
        "runs tried: 3, left out: 1",
        "r6: a new life from 2026-01-25 06:00 UTC",
        "looked at; not every window can be used",
        "refinement 8: Traced: eccentric roller at R6, eccentricity 0.25 mm.",
        "not recorded: a_N, b_N; nothing tells what happens from R3 to R7 and from R8 to rewind",
        "/w: holds no store; `aff-runtime watch add STORE RUN_DIR` begins one",
    ],
)
def test_names_and_numbers_are_kept(text: str) -> None:
    said = sentence(text, GERMAN)
    assert said != text
    for word in (
        "/l.yaml",
        "/s.yaml",
        "/runs",
        "3",
        "2026-01-25 06:00",
        "R6",
        "b_N",
        "R8 to rewind",
    ):
        assert (word in said) == (word in text)


def test_a_limit_of_one_record_keeps_its_name_before_it() -> None:
    asked = AskedOf(windows=("a",), holdout=(), without=(), by="carl", utc="u")
    row = RefinedRow(number=1, asked=asked, kind="nothing", text="")
    summary = Summary(
        kind="nothing",
        headline="",
        sure="",
        gain="",
        next_step="",
        effects=(),
        unknown=(),
        errors=(),
        limits=(
            "run@2:00..9:00: no step of the tension reference: the modulus, a loop's gains and a "
            "delay are told by ripple alone",
        ),
        judged_on="a",
        held_out=False,
    )
    view = RefinedView(row=row, summary=summary, proposal=None, command="")
    shown = refined_in(view, GERMAN).summary
    assert shown is not None
    assert shown.limits[0].startswith("run@2:00..9:00: kein Sprung des Zugsollwerts")


def test_why_there_is_no_line_of_a_roller_is_translated() -> None:
    rolls = [Unread(roll="r6", turns=4, turn_s=turn_s) for turn_s in (2.0, math.nan)]
    view = MaintenanceView(store="/watch", without_a_line=tuple(sentences.unread(rolls)))
    few = "r6: keine Zeile, 4 ganze Umdrehungen in seinem längsten gleichmäßigen Abschnitt, 8 sind"
    assert maintenance_in(view, GERMAN).without_a_line == (
        f"{few} nötig, 20 s bei einer Geschwindigkeit",
        f"{few} nötig",
    )


def test_what_a_store_without_readings_says_is_translated() -> None:
    said = [text for text in sentences_of(maintenance_jobs.maintenance_view) if "roller" in text]
    assert len(said) == 1
    assert sentence(said[0], GERMAN).startswith("noch keine der eingebauten Walzen")
