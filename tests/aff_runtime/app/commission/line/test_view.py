"""What a screen is told of a line before it is probed, and after."""

import math
import re
import shutil
from dataclasses import replace

import pytest

from aff_runtime.app.commission.line import view as line_view
from aff_runtime.app.commission.line.view import line
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.report.status_answer import Live, StatusAnswer
from aff_runtime.config.loader import load_site
from aff_runtime.core.probe.excitation import PERIOD_S
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE
from tests.aff_runtime.app.commission.said import plain


@pytest.fixture
def where(tmp_path):
    site = tmp_path / "site.yaml"
    shutil.copyfile(SITE_FILE, site)
    (tmp_path / "rt").mkdir(mode=0o700)
    return Paths(
        site=site, state=tmp_path, socket=tmp_path / "rt" / "control.sock", card=tmp_path / "card"
    )


def test_before_the_first_probe_its_bounds_are_known_and_the_ripple_is_not(where):
    site, found = load_site(where.site), plain(line(where, Request(do="line"), None))["line"]
    assert found["errors"] == []
    assert site.probe.duration_s < found["probe"]["duration_s"] < site.probe.duration_s + 10.0
    rows = {row["actuator"]: row for row in found["probe"]["rows"]}
    assert set(rows) == set(site.actuators)
    for name, actuator in site.actuators.items():
        assert rows[name]["amplitude"] == site.probe.amplitude_m_s
        assert rows[name]["limit"] == actuator.limit_m_s
        assert (rows[name]["unit"], rows[name]["signal_unit"]) == ("m/s", "N")
        assert rows[name]["ripple"] is None
    assert (found["responses"], found["proof"]) == ([], None)


def test_a_probe_that_chooses_its_size_is_said_to_take_as_long_as_it_may(where):
    text = where.site.read_text(encoding="utf-8")
    where.site.write_text(re.sub(r"\n  amplitude_m_s: .*", "", text), encoding="utf-8")
    site, found = load_site(where.site), plain(line(where, Request(do="line"), None))["line"]
    assert [row["is_chosen"] for row in found["probe"]["rows"]] == [True, True]
    listened = 1 + 3  # silent, then at a sixteenth, a quarter and the whole of its bound
    assert found["probe"]["duration_s"] > site.probe.duration_s + listened * PERIOD_S


SHIPPED = sorted(path.name for path in SITE_FILE.parent.glob("*.yaml"))
A_TORQUE = (
    ("velocity_reference\n    error: { signal: p", "torque_reference\n    error: { signal: p"),
    ("limit_m_s: 0.04\n    slew_m_s2: 2.0", "limit_N_m: 2\n    slew_N_m_s: 50"),
    ("settle_s: 8, amp_limit_m_s: 0.03", "settle_s: 8, amp_limit_N_m: 1"),
    ("complement: 109, scale: 0.00001", "complement: 109, scale: 1 mNm"),
    ("register: 17, scale: 0.00001", "register: 17, scale: 1 mNm"),
    ("\nprobe:\n", "\nprobe:\n  amplitude_N_m: 0.1\n"),
)


@pytest.mark.parametrize(
    ("name", "edits"), [*((name, ()) for name in SHIPPED), ("euclid_blocks.yaml", A_TORQUE)]
)
def test_every_line_that_may_run_has_its_page(where, name, edits):
    for file in (*SITE_FILE.parent.glob("*.dbc"), *SITE_FILE.parent.glob("*.eds")):
        shutil.copy(file, where.site.parent)
    text = (SITE_FILE.parent / name).read_text(encoding="utf-8")
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    where.site.write_text(text, encoding="utf-8")
    site, found = load_site(where.site), plain(line(where, Request(do="line"), None))["line"]
    assert found["errors"] == []
    assert found["probe"]["duration_s"] > site.probe.duration_s
    assert [row["actuator"] for row in found["probe"]["rows"]] == list(site.actuators)


WEB = "  web_modulus_Pa: 2 GPa\n  web_thickness_m: 0.1 mm\n  web_width_m: 0.5\n"
AT_2_M_S = StatusAnswer(
    line="l", state="READY", live=Live(signals={"line_speed_m_s": 2.0, "time_s": 0.0})
)


def first_of(where, monkeypatch, web, status):
    """Return what is known of the unwind before its first probe."""
    text = where.site.read_text(encoding="utf-8")
    where.site.write_text(text.replace("\nprobe:\n", f"\nprobe:\n{web}", 1), encoding="utf-8")
    monkeypatch.setattr(line_view, "status_of", lambda socket: status)
    rows = plain(line(where, Request(do="line"), None))["line"]["probe"]["rows"]
    return next(one for one in rows if one["actuator"] == "unwind")


def test_before_the_first_probe_the_web_bounds_how_far_it_moves_the_tension(where, monkeypatch):
    row = first_of(where, monkeypatch, WEB, AT_2_M_S)
    # E w h = 2e9 * 0.5 * 1e-4 = 1e5 N: a speed off by a strains the web by a / v
    assert row["expected_ripple_N"] == pytest.approx(row["amplitude"] * 1e5 / 2.0)
    assert (row["speed_m_s"], row["lacks"]) == (2.0, [])


def test_no_more_than_the_bound_at_which_a_probe_ends(where, monkeypatch):
    row = first_of(where, monkeypatch, WEB + "  bound_N: 3\n", AT_2_M_S)
    assert row["expected_ripple_N"] == 3.0


@pytest.mark.parametrize(
    ("web", "status", "lacks"),
    [
        (WEB, None, ["a line that runs"]),
        (WEB, replace(AT_2_M_S, live=None), ["a line that runs"]),
        (WEB.partition("\n")[0] + "\n", AT_2_M_S, ["probe.web_thickness_m", "probe.web_width_m"]),
        ("", AT_2_M_S,
         ["probe.web_modulus_Pa", "probe.web_thickness_m", "probe.web_width_m"]),
    ],
)  # fmt: skip
def test_what_is_not_known_before_a_first_probe_says_what_is_lacking(
    where, monkeypatch, web, status, lacks
):
    row = first_of(where, monkeypatch, web, status)
    assert (row["expected_ripple_N"], row["speed_m_s"], row["lacks"]) == (None, None, lacks)


def test_after_one_the_ripple_is_amplitude_times_the_largest_gain(where):
    site = load_site(where.site)
    name, actuator = next(iter(site.actuators.items()))
    gains = (40.0, 250.0, 90.0)
    points = [
        ResponsePoint(
            frequency_Hz=f, gain=gain, phase_rad=-1.0, relative_error=0.02, coherence=0.99
        )
        for f, gain in zip((1.0, 2.0, 4.0), gains, strict=True)
    ]
    about = Provenance(actuator=name, signal=actuator.error.signal, line_speed_m_s=1.0)
    path = where.site.parent / actuator.response
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(Response(points=points, delay_s=0.04, provenance=about).to_json())
    found = plain(line(where, Request(do="line"), None))["line"]
    (row,) = [one for one in found["probe"]["rows"] if one["actuator"] == name]
    assert row["ripple"] == pytest.approx(max(gains) * site.probe.amplitude_m_s)
    (response,) = found["responses"]
    assert response["unit"] == "N/(m/s)"
    assert response["radius_m"] is None
    assert response["points"][1] == pytest.approx([2.0, 250.0, math.degrees(-1.0), 2.0, 0.99])


def kept_response(where, site, *, sent, coherence, sigmas=math.nan):
    name, actuator = next(iter(site.actuators.items()))
    point = ResponsePoint(
        frequency_Hz=1.0, gain=100.0, phase_rad=0.0, relative_error=0.5, coherence=coherence
    )
    about = Provenance(
        actuator=name, signal=actuator.error.signal, amplitude=sent, repeat_sigmas=sigmas
    )
    path = where.site.parent / actuator.response
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(Response(points=[point], delay_s=0.0, provenance=about).to_json())
    return name


def row_of(where, name):
    found = plain(line(where, Request(do="line"), None))["line"]
    return next(one for one in found["probe"]["rows"] if one["actuator"] == name), found


@pytest.mark.parametrize(
    ("sent", "coherence", "louder"),
    [
        (0.004, 0.5, 0.008),  # twice
        (0.015, 0.5, 0.02),  # no more than the bound
        (0.02, 0.5, None),  # which is reached
        (0.004, 0.95, None),  # all is heard
    ],
)
def test_a_louder_probe_is_offered_where_one_was_not_heard_and_its_bound_is_not_reached(
    where, sent, coherence, louder
):
    name = kept_response(where, load_site(where.site), sent=sent, coherence=coherence)
    row, _ = row_of(where, name)
    assert row["sent"] == sent
    assert row["louder"] == (louder if louder is None else pytest.approx(louder))


def test_the_bounds_of_a_chosen_amplitude_stand_there_in_the_units_of_the_plant(where):
    text = where.site.read_text().replace("amplitude_m_s: 0.008", "bound_m_s: 0.01")
    where.site.write_text(text)
    name = kept_response(where, load_site(where.site), sent=0.004, coherence=0.9, sigmas=1.1)
    row, found = row_of(where, name)
    assert (row["is_chosen"], row["amplitude"]) == (True, 0.01)
    assert (row["bound_N"], row["bound_share"]) == (None, 0.1)
    assert row["ripple"] == pytest.approx(100.0 * 0.01)
    assert found["responses"][0]["repeat_sigmas"] == 1.1
    where.site.write_text(text.replace("bound_m_s: 0.01", "bound_m_s: 0.01\n  bound_N: 0.4"))
    row, _ = row_of(where, name)
    assert (row["bound_N"], row["bound_share"], row["ripple"]) == (0.4, None, 0.4)


def test_a_file_that_is_not_good_says_what_is_wrong_and_nothing_else(where):
    where.site.write_text(where.site.read_text().replace("version: 1", "version: one"))
    found = plain(line(where, Request(do="line"), None))["line"]
    assert found["errors"]
    assert (found["probe"], found["limits"]) == (None, [])


def test_a_line_whose_speed_is_noise_stands_and_has_no_times_of_a_proof(where, monkeypatch):
    found = {}
    for speed_m_s in (1.0, 9e-4):
        live = Live(signals={"line_speed_m_s": speed_m_s, "time_s": 0.0})
        status = replace(AT_2_M_S, live=live)
        monkeypatch.setattr(line_view, "status_of", lambda socket, now=status: now)
        found[speed_m_s] = plain(line(where, Request(do="line"), None))["line"]["proof"]
    site = load_site(where.site)
    radius_m = max(
        site.rolls[block.roll].largest_radius_m
        for actuator in site.actuators.values()
        for block in actuator.blocks
    )
    assert found[1.0]["off_s"] == pytest.approx(22 * math.tau * radius_m)  # 20 turns, and 2 broken
    assert found[9e-4] is None
