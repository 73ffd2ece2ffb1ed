"""What runs lack, and what is odd about several of them together."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.run_caveats import lines_of, run_caveats, shared, site_of_other_line
from sim_plant.refine.model.run_match import run_on_line
from tests.sim_plant.refine.model.made_run import LINE, ROWS, actuator, run


def test_runs_of_several_lines_are_named():
    one = run()
    other = replace(
        one, path=Path("LATER"), run=replace(one.run, site=replace(one.run.site, name="Film"))
    )
    assert lines_of([one, one]) == []
    assert "RUN of L, LATER of Film" in lines_of([one, other])[0]


def test_a_site_file_of_another_line_than_the_runs_is_asked_about():
    (said,) = site_of_other_line("Film", [run(), run()])
    assert said.startswith("this site file is of line Film, the runs are of L by theirs")
    assert site_of_other_line("L", [run()]) == site_of_other_line("", [run()]) == []


def windowed(path, from_s, to_s):
    record = run()
    facts = replace(record.run, from_s=from_s, to_s=to_s)
    return replace(record, path=Path(path), run=facts)


def test_windows_of_one_run_that_overlap_are_named_and_others_are_not():
    fitted, other = windowed("RUN@10..40", 10.0, 40.0), windowed("RUN@30..70", 30.0, 70.0)
    both, advice = "RUN@10..40 and RUN@30..70 share 10 s", "give windows that do not overlap"
    judged, twice = "the error is judged on what was fitted", "it counts twice"
    assert shared([fitted], [other]) == [f"{both} of one run: {judged}; {advice}"]
    assert shared([fitted, other], []) == [f"{both} of one run: {twice}; {advice}"]
    apart = [windowed("RUN@40..70", 40.0, 70.0), windowed("LATER@30..70", 30.0, 70.0)]
    assert shared([fitted], apart) == []
    assert shared([fitted], [replace(fitted, run=None)]) == []
    copy = windowed("COPY/RUN@30..70", 30.0, 70.0)
    named = [replace(r, run=replace(r.run, run_id="3f9a")) for r in (fitted, copy)]
    assert shared(named[:1], named[1:]) == [f"{both} of one run: {judged}; {advice}"]
    assert shared([run()], [run()]) == []  # where a piece lies is not known


def test_what_the_window_lacks_is_said_with_what_it_costs():
    thin = LINE.model_copy(update={"web": LINE.web.model_copy(update={"thickness_m": 1e-5})})
    record = run_on_line(thin, run({"t_ref_N": np.full(ROWS, 88.0)}))
    said = " | ".join(run_caveats(record, twin_of(thin, record)))
    assert "no step of the tension reference" in said
    assert "not recorded: pullroll_tension_N, r3_tension_N" in said
    # no tension between the follower and the pull roll, nor between that and the rewind
    assert "from swrap_follower to pull_roll and from pull_roll to rewind" in said
    assert "keeps its radius" in said  # 27 m of 0.01 mm web: 0.23 mm off 190 mm


@pytest.mark.parametrize(
    ("name", "roll", "suffix"),
    [("unwind", "", "m_s"), ("a1", "Unwind", "m_s"), ("a1", "unwind", "N_m")],
)
def test_a_delay_that_is_not_recorded_is_said_by_whatever_name_the_actuator_has(
    name, roll, suffix
):
    columns = {f"correction_{name}_{suffix}": 0.01 * np.sin(np.arange(ROWS))}
    record = run(columns, actuators={name: actuator(suffix=suffix, roll=roll)})
    known = {name: False}
    record = run_on_line(LINE, replace(record, run=replace(record.run, delivery_known=known)))
    said = [text for text in run_caveats(record, twin_of(LINE, record)) if "acted is not" in text]
    assert [text.split(": ")[1] for text in said] == [
        f"when a correction of {name} acted is not recorded, the usual delay is taken"
    ]
