"""The page as a file: its tables, its figures and their captions, by what was found."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.reading.load import load_line
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.aff_block import write_block
from sim_plant.refine.report.findings import verdict_of
from sim_plant.refine.report.near_steps import near_steps
from sim_plant.refine.report.outcome import Outcome, RecordOfOnset, RefineRequest
from sim_plant.refine.report.page import facts_of, next_of, write_report
from sim_plant.refine.report.parts_shown import overlays
from sim_plant.refine.report.verdict import Moment
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from tests.sim_plant.refine.small import LINE, LINE_FILE, STEP_S, axes_at, fit_of, one_peak

ROWS = 3000
CHANNELS = ("unwind_tension_N", "line_speed_m_s", "unwind_angle_rad")
R4 = hypothesis(BY_NAME["eccentric_roller"], "R4", line=LINE)


def record(name, low, high):
    columns = {
        "line_speed_ref_m_s": np.linspace(low, high, ROWS),
        "tension_ref_N": np.linspace(60.0 * high, 90.0, ROWS),
    }
    return Recording(path=Path(name), sha256="0" * 64, sample_time_s=STEP_S, columns=columns)


def evaluation(after):
    noise = np.random.default_rng(3).standard_normal((3, ROWS))
    return Evaluation(
        channels=CHANNELS,
        rms_declared=np.array([3.0, 2.0, 9.0]),
        rms_amended=np.array(after),
        floor=np.ones(3),
        measured=noise,
        declared=np.zeros((3, ROWS)),
        corrected=np.zeros((3, ROWS)),
        amended=np.zeros((3, ROWS)),
        effects=(),
        angles_rad={},
        unwound_m={},
        first=100,
        travel_m=STEP_S * np.arange(ROWS),
    )


def outcome(folder, accepted=(), adjustments=None, after=(1.0, 1.0, 9.0)):
    fit = fit_of(*(a.hypothesis for a in accepted), values=((3e-5, -4e-5),) * len(accepted))
    selection = Selection(
        nominal=fit_of(),
        fit=replace(fit, covariance=np.eye(2 * len(accepted)) * 1e-14),
        record_axes=(axes_at(np.ones(ROWS)),),
        spectra_declared=one_peak(900.0),
        spectra_left=one_peak(20.0),
        accepted=tuple(accepted),
        adjustments=adjustments or {},
    )
    judged = evaluation(after)
    return Outcome(
        plan=RefineRequest(
            line=LINE_FILE, records=(Path("a.csv"),), holdout=(Path("b.csv"),), out=folder
        ),
        line=load_line(LINE_FILE),
        declared=LINE,
        records=(record("a.csv", 0.5, 1.0), record("b.csv", 0.7, 1.4)),
        caveats=("a wrong scale of a load cell",),
        selection=selection,
        evaluation=judged,
        verdict=verdict_of(selection, judged, "b.csv"),
    )


def found(*ambiguous):
    places = tuple(EffectAt("eccentric_roller", name) for name in ambiguous)
    return AcceptedEffect(
        hypothesis=R4,
        score=500.0,
        runner_up=EffectAt("eccentric_roller", "R5"),
        margin=2.0,
        rejected=((EffectAt("eccentric_roller", "R5"), 498.0),),
        ambiguous=places,
    )


@pytest.fixture
def undrawn(monkeypatch):
    """Leave the figures out, of which a page takes a second: what a test looks at is text."""
    room = "sim_plant.refine.report.page"
    monkeypatch.setattr(f"{room}.sketch", lambda *_: "")
    monkeypatch.setattr(f"{room}.overlays", lambda *_: [])
    monkeypatch.setattr(f"{room}.wavenumber_map", lambda *_, **__: ())
    monkeypatch.setattr(f"{room}.spectrum", lambda *_, **__: "")


@pytest.fixture
def unsaved(monkeypatch):
    """Leave a frame of each figure: to write the figures takes most of a page's time."""
    monkeypatch.setattr("sim_plant.refine.report.plots.svg", lambda *_, **__: "<svg></svg>")
    monkeypatch.setattr("sim_plant.refine.report.sketch.svg", lambda *_, **__: "<svg></svg>")


@pytest.fixture(scope="module")
def drawn_page(tmp_path_factory):
    """The page of one effect that was found, with all its figures."""
    return page_of(outcome(tmp_path_factory.mktemp("drawn"), [found()]))


def page_of(one):
    block = write_block(one.plan.out, one.verdict.effects, one.line.declaration)
    return write_report(one, "sim-plant refine", None, block).read_text()


def test_a_page_fits_a_narrow_screen(drawn_page):
    page = drawn_page
    assert 'name="viewport"' in page
    assert page.count("<table>") == page.count('<div class="wide"><table>') > 0
    # what the reader judges by stands beside the name: a narrow screen shows no more
    assert "<th>channel</th><th>after / floor</th>" in page
    assert '<td>unwind_tension_N</td><td class="ok">1.00</td>' in page


def test_a_page_says_which_records_it_rests_on_and_each_figure_its_own(drawn_page):
    page = drawn_page
    assert (
        "Records: a.csv (fitted), b.csv (held out); line speed 0.5 to 1.4 m/s; tension 60 to 90 N."
    ) in page
    sketch, *captions = re.findall("<figcaption>(.*?)</figcaption>", page)
    assert sketch.startswith("The line as declared")
    assert re.fullmatch(
        r"b\.csv, [\d.]+ to [\d.]+ s, where the declared line is worst", captions[0]
    )
    assert captions[1:] == ["b.csv, 0 to 30.0 s", "a.csv, the whole record"]
    assert "numbers that may be 0" not in page  # every component is surely there
    assert "<title>What euclid lacks: a.csv, b.csv, 2" in page


def test_where_something_is_left_the_amended_line_is_shown_at_its_worst(tmp_path, monkeypatch):
    drawn = "sim_plant.refine.report.parts_shown.overlay"
    monkeypatch.setattr(drawn, lambda *_, **__: ("", ""))
    (declared,) = overlays(outcome(tmp_path, [found()]))
    one = outcome(tmp_path, [found()], after=(1.5, 1.0, 9.0))
    one.evaluation.amended[0, 1000:1100] = 9.0
    declared, amended = overlays(one)
    assert declared.caption.endswith("where the declared line is worst")
    assert amended.caption.endswith("where the amended line is worst")
    first_s, last_s = map(float, re.findall(r"[\d.]+", amended.caption.split(", ")[1]))
    assert first_s <= 10.0
    assert last_s >= 11.0


def test_a_block_of_what_is_not_told_apart_has_to_wait(tmp_path, undrawn):
    wait = "Only after it is confirmed that it is the eccentric roller at R4."
    assert wait not in page_of(outcome(tmp_path, [found()]))
    page = page_of(outcome(tmp_path, [found("R5")]))
    assert page.index("To cancel it") < page.index(wait) < page.index("- roll: r4")


def test_the_block_goes_to_the_actuators_beside_an_idler(tmp_path):
    one = outcome(tmp_path, [found()])
    assert "at the actuator of unwind or swrap_lead." in next_of(one, facts_of(one))
    proposed = next_of(one, replace(facts_of(one), is_proposed=True))
    assert "it has the block of R4." in proposed


@pytest.mark.parametrize(("share", "is_outside"), [(0.98, False), (1.3, False), (1.6, True)])
def test_a_number_outside_its_tolerance_is_marked_and_told(tmp_path, undrawn, share, is_outside):
    one = outcome(tmp_path, [found()], {"web.EA_N": share * LINE.tolerances["web.EA_N"]})
    one = replace(one, declared=LINE)
    page = page_of(one)
    assert ('<tr class="out"><td>web.EA_N' in page) is is_outside
    assert ("times it on (red) something is" in page) is is_outside
    assert ("web.EA_N +" in next_of(one, facts_of(one))) is is_outside


def test_without_an_effect_a_page_has_one_curve_and_nothing_amended(tmp_path, drawn_page, unsaved):
    page = page_of(outcome(tmp_path))
    assert "amended" not in page
    assert "<th>before</th>" not in page
    assert page.count("<svg") == drawn_page.count("<svg") - 2  # one map, not two; no sketch
    assert '<tr class="sum"><td>unwind_angle_rad</td>' in page


@pytest.mark.parametrize("lacks", [[], [0, 100, -1], slice(None)])
@pytest.mark.parametrize(("time_s", "near"), [(15.2, True), (14.8, True), (16.0, False)])
def test_what_begins_with_a_step_of_a_reference_is_told_as_that(tmp_path, time_s, near, lacks):
    tension_N = np.where(np.arange(ROWS) * STEP_S < 15.0, 80.0, 90.0)
    tension_N[lacks] = math.nan
    told = near and lacks != slice(None)
    one = record("a.csv", 1.0, 1.0)
    one = replace(one, columns=one.columns | {"tension_ref_N": tension_N})
    begun = replace(
        outcome(tmp_path, [found()]).verdict.effects[0],
        begins=Moment(record="a.csv", time_s=time_s),
    )
    verdict = replace(outcome(tmp_path, [found()]).verdict, effects=(begun,))
    said = near_steps(verdict, [one])
    assert bool(said) is told
    assert all("begins with a step of the tension reference" in text for text in said)


def test_what_begins_is_shown_in_its_record(tmp_path, monkeypatch, unsaved):
    monkeypatch.setattr("sim_plant.refine.report.parts_shown.overlay", lambda *_, **__: ("", ""))
    onset = RecordOfOnset(
        moment=Moment(record="a.csv", time_s=12.5), evaluation=evaluation((1, 1, 1))
    )
    page = page_of(replace(outcome(tmp_path, [found()]), record_of_onset=onset))
    assert "<figcaption>a.csv, 7.5 to 27.5 s; dotted: 12.50 s, where it begins<" in page
