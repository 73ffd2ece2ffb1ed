"""Two windows of a run, by a formula and of a plant, against the truth; attacked as runs are."""

import json
import math
import re
import shutil
from functools import cache

import numpy as np
import pytest

from aff_runtime.app.report.comparison import comparing
from aff_runtime.app.report.comparison.comparing import compare
from aff_runtime.app.report.comparison.page import as_json, page
from aff_runtime.app.report.comparison.window import load_window
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.cli.main import main
from aff_runtime.config.loader import load_recorded_site
from aff_runtime.config.revision import site_hash_of
from sim_plant.base.order_tracking import order_amplitudes
from tests.aff_runtime.app.card.measure.recorded import recorded, switched
from tests.doubles.recorded_run import FOLLOWER, RecordedRun, files

pytestmark = pytest.mark.timeout(300)
OFF, ON = "@5..33", "@50..75"
SIGNAL, ROLL = "pullroll_tension_N", "swrap_follower"


@pytest.fixture(
    scope="module", params=["by formula", pytest.param("simulated", marks=pytest.mark.long)]
)
def made(request, tmp_path_factory):
    """A run of 75 s, off and then on, an eccentric follower; the true tension beside it."""
    folder = tmp_path_factory.mktemp("run")
    if request.param == "simulated":
        path, truth = simulated(folder)
    else:
        columns, truth = switched(75.0, [(35.0, 75.0)])
        path = recorded(folder / "runs", columns)
    read_once = cache(load_window)
    with pytest.MonkeyPatch.context() as patch:  # nobody writes there: each window is read once
        patch.setattr(
            comparing,
            "load_window",
            lambda window: (read_once if window.folder == path else load_window)(window),
        )
        yield path, truth


def simulated(folder):
    """Return the run and the true tension of a plant in virtual time."""
    run = RecordedRun(files(folder, [FOLLOWER], cancels="", cycle_ms=10), folder / "runs")
    truth = run.truth()
    run.bench.run(35.0)
    run.bench.arm(40.0)
    return run.end(), np.array(truth)


@pytest.fixture
def run(made, tmp_path):
    """A copy to damage."""
    shutil.copytree(made[0], tmp_path / "run")
    return tmp_path / "run"


def of(before, after):
    return compare(run_window(before), run_window(after))


def row(found, order=1, signal=SIGNAL, roll=ROLL):
    return next(r for r in found.rows if (r.signal, r.roll, r.order) == (signal, roll, order))


def true_size(truth, first_s, last_s):
    _, tension, angle = truth[(truth[:, 0] >= first_s) & (truth[:, 0] < last_s)].T
    return float(abs(order_amplitudes(tension, angle, (1,))[0]))


def test_amplitudes_and_their_fall_are_those_of_the_plants_true_tension(made):
    found = row(of(f"{made[0]}{OFF}", f"{made[0]}{ON}"))
    before, after = true_size(made[1], 5.0, 33.0), true_size(made[1], 50.0, 75.0)
    filtered = 1.0 / math.hypot(1.0, found.frequency_Hz[0] / 20.0)  # the cell's 20 Hz low-pass
    assert found.before.low <= before * filtered <= found.before.high
    assert found.before.amplitude == pytest.approx(before * filtered, rel=0.03)
    assert found.frequency_Hz[0] == pytest.approx(1.0 / (2.0 * np.pi * 0.15367), rel=0.002)
    true_dB = 20.0 * math.log10(after / before)
    if found.change.bound:
        assert found.change.bound == "at_most"
        assert true_dB < found.change.value_dB + 1.0
    else:
        assert found.change.low_dB - 1.0 <= true_dB <= found.change.high_dB + 1.0
    assert true_dB < -15.0


def test_what_acted_and_how_long_ticks_took_is_in_the_facts(made):
    before, after = of(f"{made[0]}{OFF}", f"{made[0]}{ON}").windows
    assert before.corrections["swrap_follower_m_s"][:2] == (0.0, 0.0)
    rms, largest, share = after.corrections["swrap_follower_m_s"]
    assert 0.0 < rms < largest
    assert share == pytest.approx(largest / 0.04)  # limit_m_s of the shipped file
    assert set(after.states) == {"ACTIVE"}
    assert before.speed_m_s[0] == pytest.approx(1.0, abs=0.002)
    assert before.radius_m["unwind"][0] > before.radius_m["unwind"][1]
    assert set(before.times_us) == {"wake_us", "io_us", "tick_us"}
    assert before.mean_N["unwind_tension_N"] == pytest.approx(88.96, abs=0.2)
    assert "tension_ref_N" not in before.mean_N


def test_like_windows_have_no_label_and_the_same_site_file(made):
    found = of(f"{made[0]}@5..19", f"{made[0]}@19..33")
    assert (found.labels, found.differences) == ((), ())
    assert row(found).change.low_dB < 0.0 < row(found).change.high_dB


def test_a_window_that_is_partly_on_is_a_mixture(made):
    found = of(f"{made[0]}@5..33", f"{made[0]}@20..60")
    assert any("figures are a mixture" in text for text in found.windows[1].labels)
    assert any("the two windows overlap" in text for text in found.labels)


def test_what_differs_in_the_site_file_is_named_with_units(made, run):
    site = run / "site.yaml"
    site.write_text(re.sub(r"limit_m_s: 0.05", "limit_m_s: 60 mm/s", site.read_text()))
    found = of(f"{made[0]}{OFF}", f"{run}{ON}")
    assert found.differences == ("actuators.unwind.limit_m_s: 0.05 m/s -> 0.06 m/s",)


@pytest.mark.parametrize("text", [None, "", "\n"])
@pytest.mark.sweep(every=3)
def test_a_run_without_a_site_file_says_that_and_no_difference_without_a_name(made, run, text):
    site = run / "site.yaml"
    site.unlink() if text is None else site.write_text(text)
    window = f"{run}{ON}"
    found = of(f"{made[0]}{OFF}", window)
    assert found.differences == (f"{window} has none: what differs is not known",)
    assert found.labels[0] == f"{window} has no site file"
    assert not any("another version" in label for label in found.labels)
    alone = of(f"{run}{OFF}", window)
    assert "The site files say the same" not in page(alone)


def test_a_site_file_that_is_one_word_differs_in_every_key_that_the_other_has(made, run):
    (run / "site.yaml").write_text("word\n")
    found = of(f"{made[0]}{OFF}", f"{run}{ON}")
    assert len(found.differences) > 10
    assert all(re.match(r"[\w.\[\]]+: .* -> \(absent\)$", text) for text in found.differences)


EDIT_S, LIMIT_M_S, OTHER_M_S = 42.0, 0.04, 0.001
LIMIT = f"{OTHER_M_S:g} m/s"


def edited(run, limit=LIMIT, at_s=EDIT_S):
    """Have a service take another limit of the follower, live; return the text that then ran."""
    text = re.sub(
        f"limit_m_s: {LIMIT_M_S:g}\\b", f"limit_m_s: {limit}", (run / "site.yaml").read_text()
    )
    name = site_hash_of(load_recorded_site(text, "site.yaml"))[:12]
    (run / f"site-{name}.yaml").write_text(text)
    change = f"actuators.swrap_follower.limit_m_s: {LIMIT_M_S:g} m/s -> {limit} (applies at once)"
    with (run / "events.csv").open("a") as file:
        file.write(f'{at_s},,,EDIT,,"{change}"\n')
        file.write(f'{at_s + 0.2},,,CONFIG_APPLIED,,"{"c" * 12}: site {name}; unwind: none"\n')
    return text


def share(found, k):
    return found.windows[k].corrections["swrap_follower_m_s"][1:]


def test_an_edit_between_two_windows_of_a_run_is_a_difference_and_gives_the_limit(run):
    edited(run)
    found = of(f"{run}{OFF}", f"{run}{ON}")
    assert found.differences == (
        f"actuators.swrap_follower.limit_m_s: {LIMIT_M_S:g} m/s -> {LIMIT}",
    )
    largest, of_limit = share(found, 1)
    assert of_limit == pytest.approx(largest / OTHER_M_S)
    assert "The site files say the same" not in page(found)


def test_windows_on_either_side_of_an_edit_and_on_the_same_side_differ_accordingly(run):
    edited(run)
    assert of(f"{run}@5..19", f"{run}@19..33").differences == ()
    assert of(f"{run}@45..60", f"{run}@60..75").differences == ()
    within = of(f"{run}@5..33", f"{run}@36..60")
    assert len(within.differences) == 1
    assert any("the site file was changed at 42.0 s" in text for text in within.windows[1].labels)


def test_what_a_probe_brought_is_told_as_such_and_not_as_an_edit_of_the_site_file(run):
    with (run / "events.csv").open("a") as file:
        file.write('42.0,,,EDIT,,"/l/unwind.json: response none -> c5 (probed here; root)"\n')
        file.write('42.0,,,EDIT,,"a probe identified actuators.unwind.drive.zeta: none -> 1"\n')
        file.write('43.0,,,EDIT,,"/l/unwind.json: response c5 -> d6 (brought from outside; x)"\n')
        file.write('44.0,,,EDIT,,"line.dbc: describes the wire, aa -> bb (x)"\n')
    labels = "\n".join(of(f"{run}@5..33", f"{run}@36..60").windows[1].labels)
    assert "the response that a probe had measured was taken at 42.0 s: /l/unwind" in labels
    assert "numbers that a probe had identified were taken at 42.0 s" in labels
    assert "a response that no probe of the service had measured was taken at 43.0 s" in labels
    assert "a file of the wire was changed at 44.0 s" in labels
    assert "site file was changed" not in labels


def test_a_window_that_ran_on_the_next_runs_site_file_already_differs_in_nothing(made, run):
    """The edit is of the first folder; the second one begins with what it made."""
    text = edited(run, at_s=4.0)
    other = run.parent / "next"
    shutil.copytree(made[0], other)
    (other / "site.yaml").write_text(text)
    assert of(f"{run}{OFF}", f"{other}{ON}").differences == ()
    assert len(of(f"{made[0]}{OFF}", f"{other}{ON}").differences) == 1


def test_in_a_window_with_an_edit_each_row_counts_by_the_limit_of_its_time(run):
    """The correction stays while the limit is raised: its share is that of the earlier rows."""
    edited(run, limit="1 m/s", at_s=60.0)
    largest, of_limit = share(of(f"{run}{OFF}", f"{run}@50..75"), 1)
    assert of_limit == pytest.approx(largest / LIMIT_M_S)
    largest, of_limit = share(of(f"{run}{OFF}", f"{run}@62..75"), 1)
    assert of_limit == pytest.approx(largest / 1.0)


def test_of_a_run_that_kept_no_later_site_file_the_noted_values_count_and_that_is_said(run):
    edited(run)
    for later in run.glob("site-*.yaml"):
        later.unlink()
    found = of(f"{run}{OFF}", f"{run}{ON}")
    assert found.differences == (
        f"actuators.swrap_follower.limit_m_s: {LIMIT_M_S:g} m/s -> {LIMIT}",
    )
    assert any("which the run does not hold" in text for text in found.windows[1].labels)


def test_a_run_of_another_line_is_compared_and_labelled(made, run):
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("name: Euclid", "name: Other"))
    found = of(f"{made[0]}{OFF}", f"{run}{ON}")
    assert "runs of two lines: Euclid and Other" in found.labels
    assert row(found).before.turns > 10


def test_a_site_file_of_another_line_and_of_another_cycle_is_labelled(made, run):
    site = run / "site.yaml"
    text = site.read_text().replace("name: Euclid", "name: Film")
    cycle = re.search(r"cycle_ms: (\d+)", text)
    site.write_text(text.replace(cycle[0], f"cycle_ms: {2 * int(cycle[1])}"))
    labels = of(f"{made[0]}{OFF}", f"{run}{ON}").windows[1].labels
    assert any("its site.yaml is of line Film, its run.yaml of Euclid" in t for t in labels)
    said = f"a tick takes {cycle[1]} ms, its site.yaml says {2 * int(cycle[1])} ms"
    assert any(said in text for text in labels)


def test_windows_of_two_copies_of_a_run_overlap_as_those_of_one(made, run):
    assert any("overlap" in t for t in of(f"{made[0]}@5..33", f"{run}@20..60").labels)
    assert not any("overlap" in t for t in of(f"{made[0]}{OFF}", f"{run}{ON}").labels)


DOUBLING = "".join(f"k{n}: &k{n} [*k{n - 1}, *k{n - 1}]\n" for n in range(1, 60))
"""Aliases that unfold to 2^60 texts."""


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "- 3",
        "rolls: 3\nactuators: [1]\n",
        "gateway: {read: 3}\nactuators: {a: {error: 4}}\n",
        "k0: &k0 [x, x]\n" + DOUBLING + "line: {name: *k59}\nrolls: {a: {angle: *k59}}\n",
    ],
)
@pytest.mark.sweep(every=5)
def test_a_site_file_that_cannot_be_read_leaves_the_facts(made, run, text):
    (run / "site.yaml").write_text(text)
    found = of(f"{made[0]}{OFF}", f"{run}{ON}")
    assert found.windows[1].speed_m_s[0] == pytest.approx(1.0, abs=0.002)
    assert not found.rows
    assert found.labels


def test_an_edit_in_the_middle_and_a_torn_segment_are_named(run):
    with (run / "events.csv").open("a") as file:
        file.write('60.0,,,EDIT,,"settle_s: 6 s -> 9 s"\n')
    last = sorted(run.glob("signals-*"))[-1]
    last.write_bytes(last.read_bytes()[:-200])
    said = of(f"{run}{OFF}", f"{run}{ON}").windows[1].labels
    assert "the site file was changed at 60.0 s: settle_s: 6 s -> 9 s" in said
    assert any("ends torn" in text for text in said)


def test_the_page_needs_nothing_from_elsewhere_and_the_names_act_on_nothing(made, run):
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("name: Euclid", "name: <script>x</script>"))
    found = of(f"{run}{OFF}", f"{run}{ON}")
    text = page(found)
    assert "<script" not in text
    assert not re.search(r"(src|href)=|https?://", text)
    data = json.loads(json.dumps(as_json(found), allow_nan=False))
    assert data["version"] == 1
    assert {r["order"] for r in data["rows"] if r["roll"] == "unwind"} == {1, 2, 3, 4}


def test_the_command_writes_page_and_json_and_prints_the_orders(made, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["compare", f"{made[0]}{OFF}", f"{made[0]}{ON}", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert f"{SIGNAL} {ROLL} 1x: " in said
    result = said.index(f"fell: {ROLL} 1x in {SIGNAL} from ")
    assert result > said.rindex(f"{ROLL} 1x: ")  # at the end, where a terminal shows it
    assert f"<li>fell: {ROLL} 1x in {SIGNAL}" in (out / "compare.html").read_text()
    assert (out / "compare.html").exists()
    assert json.loads((out / "compare.json").read_text())["line"] == "Euclid"


def test_a_folder_that_is_no_run_ends_the_command_with_a_message(tmp_path, capsys):
    assert main(["compare", str(tmp_path), str(tmp_path), "--out", str(tmp_path)]) == 1
    assert "not a run folder" in capsys.readouterr().err
    assert not (tmp_path / "compare.html").exists()


def test_a_roll_that_only_the_later_site_file_has_is_compared_by_it(made, run):
    """The idler is no roll of the first window's site; its radius is that of the follower."""
    text = (run / "site.yaml").read_text()
    (run / "site.yaml").write_text(
        text.replace("rolls:\n", "rolls:\n  r9: { radius_m: 0.15367 }\n", 1)
    )
    for first, last in (("made", "run"), ("run", "made")):
        folders = {"made": made[0], "run": run}
        found = row(of(f"{folders[first]}{OFF}", f"{folders[last]}{ON}"), roll="r9")
        follower = row(of(f"{made[0]}{OFF}", f"{made[0]}{ON}"))
        assert found.before.amplitude == pytest.approx(follower.before.amplitude, rel=0.05)
        assert found.change.value_dB < -10.0


def test_a_window_that_reaches_beyond_the_record_says_so_and_one_of_two_states_names_its_parts(
    made,
):
    before, after = of(f"{made[0]}@5..75", f"{made[0]}@50..90").windows
    assert any("nothing is recorded from 75.0 s to 90 s" in text for text in after.labels)
    assert (
        "its longest parts at one speed and in one state: 5.0..35.0 (1 m/s, AFF off), "
        "35.0..75.0 (1 m/s, AFF on)"
    ) in before.labels


def test_windows_that_were_swapped_are_named(made, run):
    assert "the window before is later than the one after: were they swapped?" in (
        of(f"{run}{ON}", f"{run}{OFF}").labels
    )
    about = run / "run.yaml"
    about.write_text(about.read_text().replace("start_utc: '2026", "start_utc: '2027"))
    assert not any("swapped" in text for text in of(f"{made[0]}{ON}", f"{run}{OFF}").labels)
    assert any("swapped" in text for text in of(f"{run}{OFF}", f"{made[0]}{ON}").labels)


def test_a_hole_that_leaves_a_row_or_none_is_named_and_nothing_told(made, run):
    for segment in sorted(run.glob("signals-*"))[1:]:
        segment.write_bytes(b"")
    last_s = read_table(run_window(f"{run}@0..75")).columns["time_s"][-1]
    found = of(f"{run}@{last_s:g}..75", f"{made[0]}{ON}")
    assert "1 rows show readings: nothing can be told" in found.windows[0].labels
    assert any("holds no whole row" in text for text in found.windows[0].labels)
    assert {r.change.bound for r in found.rows} == {"unknown"}
    assert json.dumps(as_json(found), allow_nan=False)


def test_a_roll_number_that_cannot_be_read_is_named_and_takes_no_turn_away(tmp_path):
    columns, _ = switched(24.0, [(12.0, 24.0)])
    whole = recorded(tmp_path / "whole", columns)
    columns["roll_id"][::7] = math.nan
    spoilt = recorded(tmp_path / "spoilt", columns)
    found, expected = (of(f"{one}@1..11", f"{one}@13..24") for one in (spoilt, whole))
    assert row(found) == row(expected)
    said = "roll_id is no number in some of its rows: another roll is not told there"
    assert all(said in window.labels for window in found.windows)


def test_a_site_file_of_another_run_is_named_by_the_channel_that_is_not_there(made, run):
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("unwind_tension_N", "web_tension_N"))
    said = "its site.yaml maps web_tension_N, the run has no such column: is it of another run?"
    assert said in of(f"{made[0]}{OFF}", f"{run}{ON}").windows[1].labels
