"""The laws of a declaration: known words, and a sign that the order of the web gives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.declared.declaration import Declaration, Drive, TensionPi
from sim_plant.line.declared.laws import draws, laws_findings
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import consistency
from tests.each_case import each_case
from tests.sim_plant.line.lines import declared

PI = "(gain*e + gain*corner*integral(e))"
SHIPPED = ["euclid", "euclid_ripple", "film", "film_ripple", "coater"]


def with_control(**update: Any) -> Declaration:
    euclid = declared("euclid")
    control = euclid.control.model_copy(update=update)
    return euclid.model_copy(update={"control": control})


def with_law(loop: int, **update: str) -> Declaration:
    loops: list[TensionPi] = list(declared("euclid").control.tension_pi)
    loops[loop] = loops[loop].model_copy(update=update)
    return with_control(tension_pi=tuple(loops))


def with_reference(drive: int, text: str) -> Declaration:
    drives: list[Drive] = list(declared("euclid").control.drives)
    drives[drive] = drives[drive].model_copy(update={"speed_reference": text})
    return with_control(drives=tuple(drives))


def signs(line: Declaration) -> list[float]:
    return list(build_arrays(line, timing_of(line, line.sample_time_s)).loops["sign"])


@pytest.mark.parametrize(
    "law",
    [
        f"v_correction = -{PI}",
        f"v_correction = - {PI}, e = tension_ref - tension",
        f"v_correction=-{PI},  e = tension_ref-tension",
    ],
)
def test_spaces_do_not_turn_a_loop_round(law: str) -> None:
    line = with_law(0, law=law)
    assert consistency(line) == []
    assert signs(line) == [-1.0, 1.0]


@each_case(
    "law",
    [
        f"v_correction = +{PI}, e = tension_ref - tension",
        f"v_correction = -{PI}, e = tension - tension_ref",
        f"v_corr = -{PI}",
        "PI",
        "",
    ],
)
def test_a_law_in_other_words_or_of_the_other_sign_is_refused_and_never_acts(law: str) -> None:
    line = with_law(0, law=law)
    (said,) = consistency(line)
    assert said.startswith(f"control.tension_pi.{line.control.tension_pi[0].loop}.law: read ")
    assert f"expected v_correction = -{PI} (unwind is before its load cell R" in said
    assert signs(line) == [-1.0, 1.0]


def test_a_loop_on_the_roller_of_its_cell_has_the_sign_that_its_law_tells() -> None:
    for law, sign in ((f"v_correction = - {PI}", -1.0), (f"v_correction = +{PI}", 1.0)):
        line = with_law(1, load_cell="R9", acts_on="R9", law=law)
        assert signs(line)[1] == sign
    (said,) = laws_findings(with_law(1, load_cell="R9", acts_on="R9", law="PI"))
    assert said.endswith(f"expected v_correction = -{PI} or v_correction = +{PI}")


def test_a_loop_in_other_words_holds_the_tension_that_is_asked() -> None:
    line = make_line(with_law(0, law="PI"), seed=None)
    line.settle(4.0)
    rows = 2000
    held = line.simulate(np.full(rows, 1.016), np.full(rows, 95.0))["true_unwind_tension_N"]
    assert held[-1] == pytest.approx(95.0, abs=0.5)


@each_case(
    ("text", "drawn"),
    [
        ("line_speed_ref", False),
        ("line_speed_ref*(1+pull_roll_draw)", True),
        ("line_speed_ref * (1 + pull_roll_draw) + tension correction + aff correction", True),
        ("line_speed_ref + position correction", False),
    ],
)
def test_a_speed_reference_says_whether_its_drive_draws(text: str, drawn: bool) -> None:
    line = with_reference(3, text)
    assert consistency(line) == []
    assert draws(text) is drawn
    arrays = build_arrays(line, timing_of(line, line.sample_time_s))
    assert arrays.drives["draw"][3] == (line.control.pull_roll_draw if drawn else 0.0)


@each_case(
    "text",
    ["line_speed_ref, no draw", "line_speed_ref*(1 + draw)", "drawn", "line_speed_ref - aff", ""],
)
def test_another_speed_reference_is_refused_and_draws_nothing(text: str) -> None:
    (said,) = consistency(with_reference(3, text))
    assert said.startswith("control.drives.pull_roll.speed_reference: read ")
    assert "expected line_speed_ref, or line_speed_ref*(1 + pull_roll_draw)" in said
    assert not draws(text)


def test_a_law_of_the_web_that_the_model_does_not_follow_is_refused() -> None:
    euclid = declared("euclid")
    for law, known in (
        ("T = EA*strain^2", False),
        ("T = EA*(strain+eta*dstrain/dt), never below 0", True),
    ):
        line = euclid.model_copy(
            update={"web": euclid.web.model_copy(update={"tension_law": law})}
        )
        assert (consistency(line) == []) is known
        assert known or consistency(line)[0].startswith(f"web.tension_law: read {law!r}; expected")


@each_case("name", SHIPPED)
def test_the_shipped_lines_say_the_sign_that_their_webs_order_gives(name: str) -> None:
    line = declared(name)
    assert consistency(line) == []
    told = [-1.0 if "v_correction = -" in loop.law else 1.0 for loop in line.control.tension_pi]
    assert signs(line)[: len(told)] == told
