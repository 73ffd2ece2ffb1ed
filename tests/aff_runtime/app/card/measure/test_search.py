"""Step 9: halves as long as ripple falls, bounded; only the numbers that are meant change."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.app.card.evidence import CheckedSite, Try
from aff_runtime.app.card.figures import Verdict
from aff_runtime.app.card.measure import proof, search
from aff_runtime.app.card.measure.search import Candidate, End
from aff_runtime.app.commission.card.search import search as run_search
from aff_runtime.app.link.settings_answer import SettingsAnswer, Version
from aff_runtime.base.errors import RefusedError
from aff_runtime.config.loader import load_recorded_site, load_site
from tests.aff_runtime.app.card.measure.recorded import (
    SITE,
    SITE_FILE,
    evidence,
    figure,
    in_memory,
    steady,
    window,
)
from tests.doubles.virtual_clock import VirtualClock
from tests.drawn import drawn
from tests.each_case import each_case
from tests.parameter_records import CONFIG, record_of

TEXT = SITE_FILE.read_text()
SHAPE_FILE = CONFIG / "euclid.yaml"


def tried(ripples, value=16.0, half=0.1, ended=""):
    return [
        Candidate(
            factor=0.5**k,
            value=value * 0.5**k,
            ripple=r,
            half=half,
            ended=ended if k == len(ripples) - 1 else "",
        )
        for k, r in enumerate(ripples)
    ]


@each_case(
    ("ripples", "factor"),
    [
        ([], 1.0),
        ([5.0], 0.5),
        ([5.0, 4.0], 0.25),
        ([5.0, 4.9], None),  # within hypot(0.1, 0.1)
        ([5.0, 5.5], None),
        ([5.0, 4.0, 3.0], 0.125),
    ],
)
def test_it_halves_while_ripple_falls_by_more_than_its_error(ripples, factor):
    assert search.next_factor(tried(ripples)) == factor


@given(st.lists(st.floats(0.0, 10.0), max_size=12), st.floats(1.0, 300.0))
def test_it_ends_and_never_goes_below_the_least(ripples, value):
    table = []
    for ripple in ripples:
        factor = search.next_factor(table)
        if factor is None:
            break
        table.append(Candidate(factor=factor, value=factor * value, ripple=ripple, half=0.0))
        assert factor * value >= min(value, search.LEAST)
    assert len(table) <= search.MOST_TRIES


def test_it_takes_the_double_of_the_last_and_never_a_longer_one():
    assert search.chosen(tried([5.0, 4.0, 3.99])) == 0.5
    assert search.chosen(tried([5.0, 5.0])) == 1.0
    assert search.chosen(tried([5.0])) == 1.0
    assert search.next_factor(tried([5.0, math.nan], ended="ripple rose")) is None


def test_a_plain_law_scales_its_blocks_and_a_shape_its_memory():
    assert list(search.values_of(SITE, "unwind").values()) == [6.0, 10.0]
    assert search.values_of(load_site(SHAPE_FILE), "unwind") == {
        ("actuators", "unwind", "memory_turns"): 9.0
    }
    with pytest.raises(RefusedError, match="there are unwind, swrap_follower"):
        search.values_of(SITE, "winder")


@drawn(quick=12, long=100)
@given(st.floats(1.0, 300.0), st.floats(1.0, 300.0))
def test_every_byte_but_those_numbers_stays(first, second):
    paths = list(search.values_of(SITE, "unwind"))
    new = search.text_with(TEXT, dict(zip(paths, (first, second), strict=True)))
    site = load_recorded_site(new, "site.yaml")
    found = [block.settle_s for block in site.actuators["unwind"].blocks]
    assert found == pytest.approx([float(f"{first:g}"), float(f"{second:g}")])
    back = search.text_with(new, dict(zip(paths, (6.0, 10.0), strict=True)))
    assert back == TEXT


def test_a_key_that_was_left_to_its_default_is_added():
    text = SHAPE_FILE.read_text().replace("    memory_turns: 9\n", "")
    path = ("actuators", "unwind", "memory_turns")
    site = load_recorded_site(search.text_with(text, {path: 4.0}), "site.yaml")
    assert site.actuators["unwind"].memory_turns == 4.0


def in_noise(ripples, value=16.0):
    """Return candidates of which the last is in the noise."""
    table = tried(ripples, value)
    return [*table[:-1], replace(table[-1], in_noise=True, half=math.nan)]


BROKEN = [*tried([5.0]), Candidate(factor=0.5, value=8.0)]
ENDS = {
    "at the bound at once": (tried([5.0], 1.5), End.LEAST, 1.0),
    "falls to the bound": (tried([5.0, 4.0, 3.0], 6.0), End.LEAST, 0.25),
    "falls to the last try": (tried([9.0, 8.0, 7.0, 6.0, 5.0, 4.0], 100.0), End.MOST, 1 / 32),
    "rests at the bound": (tried([5.0, 4.0, 3.99], 6.0), End.NO_FALL, 0.5),
    "no good turn": (BROKEN, End.NO_TURNS, 0.5),
    "no good turn at first": ([Candidate(factor=1.0, value=16.0)], End.NO_TURNS, 1.0),
    "falls into the noise": (in_noise([5.0, 0.05]), End.NOISE, 0.5),
    "in the noise at first": (in_noise([0.05]), End.NOISE, 1.0),
    "noise that is as large": (in_noise([0.05, 0.0499]), End.NO_FALL, 1.0),
}


@pytest.mark.parametrize(("table", "end", "factor"), ENDS.values(), ids=ENDS)
def test_why_it_ended_says_what_is_chosen(table, end, factor):
    assert search.end_of(table) is end
    assert search.next_factor(table) is None
    assert search.chosen(table) == factor


@pytest.fixture(scope="module")
def rippled(tmp_path_factory):
    """Return a window in which the follower's order has an amplitude, or is noise alone."""

    def make(amplitude_N, good=True):
        columns = steady(30.0)
        angle = columns["swrap_follower_angle_rad"]
        rng = np.random.default_rng(7)
        noise = 0.2 * rng.standard_normal(angle.size)
        columns["pullroll_tension_N"] = 60.0 + amplitude_N * np.cos(angle) + noise
        if not good:
            lacks = np.arange(angle.size) % 190 < 80  # more than a third of each turn
            columns["pullroll_tension_N"][lacks] = np.nan
        return in_memory(tmp_path_factory.mktemp("run"), columns)

    return make


@pytest.mark.parametrize(
    ("amplitudes_N", "settle_s", "end", "proposed"),
    [
        ([2.0], 1.5, End.LEAST, ()),
        ([2.0, 1.0], 3.0, End.LEAST, ("1.5",)),
        ([2.0, 0.0], 8.0, End.NOISE, ("4",)),
        ([0.0], 8.0, End.NOISE, ()),
    ],
)
def test_the_end_is_part_of_the_result(rippled, amplitudes_N, settle_s, end, proposed):
    text = TEXT.replace("settle_s: 8", f"settle_s: {settle_s:g}")
    site = load_recorded_site(text, "site.yaml")
    tries = tuple(
        Try(actuator="swrap_follower", factor=0.5**k, measured=True)
        for k in range(len(amplitudes_N))
    )
    seen = evidence(*map(rippled, amplitudes_N), site=site, tries=tries)
    finding = search.measure(seen)
    result = figure(finding, "settle_s of the search")
    assert (result.limit, result.good, finding.verdict) == (end, True, Verdict.PASS)
    assert [one.split(": ")[1].split(" ")[0] for one in finding.proposals] == list(proposed)
    ripple = figure(finding, f"settle_s {settle_s * 0.5 ** (len(tries) - 1):g}: ripple")
    if amplitudes_N[-1]:
        assert ripple.value == pytest.approx(amplitudes_N[-1], abs=0.05)
        assert ripple.high > ripple.low
    else:
        assert ripple.name.endswith("(at most: in the noise)")
        assert math.isnan(ripple.low)


def test_a_candidate_without_a_good_turn_leaves_the_step_open(rippled):
    tries = tuple(Try(actuator="swrap_follower", factor=f, measured=True) for f in (1.0, 0.5))
    finding = search.measure(evidence(rippled(2.0), rippled(2.0, good=False), tries=tries))
    assert (finding.verdict, finding.proposals) == (Verdict.OPEN, ())
    assert finding.missing[0].startswith("4 has no ripple: fewer whole turns")


def test_a_block_that_is_switched_off_is_neither_searched_nor_counted():
    off = TEXT.replace(
        "settle_s: 10, amp_limit_m_s: 0.01 }",
        "settle_s: 10, amp_limit_m_s: 0.01, enabled: false }",
    )
    site = load_recorded_site(off, "site.yaml")
    assert set(search.values_of(SITE, "unwind").values()) == {6.0, 10.0}
    assert set(search.values_of(site, "unwind").values()) == {6.0}
    gone = proof.corrected(SITE) - proof.corrected(site)
    assert gone == {("unwind_tension_N", "swrap_follower", 1)}
    assert (proof.settling_s(SITE, 1.0), proof.settling_s(site, 1.0)) == (30.0, 24.0)
    none = load_recorded_site(
        off.replace("amp_limit_m_s: 0.02 }", "amp_limit_m_s: 0.02, enabled: false }"), "site.yaml"
    )
    with pytest.raises(RefusedError, match="unwind: none of its blocks is enabled"):
        search.values_of(none, "unwind")


FAST = load_recorded_site(TEXT.replace("settle_s: 8", "settle_s: 4"), "site.yaml")


def version(row):
    """Return a version of the history by its verb and reason."""
    verb, why = row
    return Version(number=1, when="", who="the service", verb=verb, why=why, sha256="")


class Service:
    """Answers as a service would whose record is there already.

    A try returns at ``returns_s`` for ``why``, or because an ``alarm`` took the correction back.
    """

    def __init__(self, clock, folder, begin_s, returns_s=math.inf, why="", alarm=""):
        self.clock, self.folder, self.begin_s, self.returns_s = clock, folder, begin_s, returns_s
        self.asked, self.trying, self.why, self.alarm = [], "", why, alarm

    def __call__(self, do, **arguments):
        if arguments.get("act") == "history":
            rows = [("tried", "card, step 9"), ("returned", self.why)]
            return SettingsAnswer(versions=tuple(map(version, rows))).to_json()
        if do == "settings":
            self.asked.append(arguments)
            self.trying = "tried" if arguments["act"] == "try" else ""
            return {}
        time_s = self.begin_s + self.clock.now_ns() * 1e-9
        is_over = time_s > self.returns_s
        if is_over:
            self.trying = ""
        return {
            "state": "FAULT" if is_over and self.alarm else "ACTIVE",
            "alarm": {"code": 1, "name": self.alarm} if is_over and self.alarm else {},
            "trying": self.trying,
            "recorder": {"folder": str(self.folder)},
            "signals": {"time_s": time_s, "line_speed_m_s": 1.0, "state": 4},
        }


def searched(folder, **how):
    clock = VirtualClock()
    service = Service(clock, folder, 31.0 - clock.now_ns() * 1e-9, **how)
    text = TEXT.replace("settle_s: 8", "settle_s: 4")
    checked = CheckedSite(site=FAST)
    record = record_of(FAST, site_text=text)
    found = run_search("swrap_follower", record, checked, service, clock, lambda _: None)
    seen = evidence(
        *(window(one.folder, one.from_s, one.to_s) for one in found.windows),
        site=FAST,
        tries=found.tries,
    )
    return service, found, search.measure(seen)


@pytest.mark.timeout(300)
def test_a_candidate_that_is_worse_ends_the_search_and_nothing_is_proposed(abab_run):
    """The second is looked at while the record has the correction off: ripple is all there."""
    service, found, finding = searched(abab_run[0])
    assert [(one.factor, one.measured) for one in found.tries] == [(1.0, True), (0.5, True)]
    assert [one["act"] for one in service.asked] == ["try", "undo"]
    tried_site = load_recorded_site(service.asked[0]["text"], "site.yaml")
    assert tried_site.actuators["swrap_follower"].blocks[0].settle_s == 2.0
    window_s = found.windows[0].to_s - found.windows[0].from_s
    assert window_s == pytest.approx(20.0 * math.tau * 0.15367)
    assert service.asked[0]["seconds"] > 3.0 * 2.0 + window_s
    on = figure(finding, "settle_s 4: ripple")
    off = figure(finding, "settle_s 2: ripple")
    assert off.value > 1.5 * on.value
    assert figure(finding, "settle_s 4: largest correction").value > 0.0
    assert figure(finding, "settle_s of the search").value == 4.0
    assert (finding.verdict, finding.proposals) == (Verdict.PASS, ())


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"why": "ripple of pullroll_tension_N rose from 0.4 to 0.9"}, "rose from 0.4 to 0.9"),
        ({"alarm": "RIPPLE_ROSE"}, "taken back: FAULT, RIPPLE_ROSE"),
    ],
)
def test_a_try_that_is_taken_back_because_ripple_rose_ends_the_search(abab_run, how, said):
    service, found, finding = searched(abab_run[0], returns_s=66.0, **how)
    assert [one["act"] for one in service.asked] == ["try"]
    assert found.tries[1].worse
    assert finding.proposals == ()
    assert finding.remarks[0].startswith("2 makes it worse: ")
    assert said in finding.remarks[0]
    assert figure(finding, "settle_s of the search").value == 4.0
    assert finding.verdict is Verdict.PASS


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"why": "a file was saved meanwhile"}, "settings returned: a file was saved meanwhile"),
        ({"alarm": "PLC_STALE"}, "the correction was taken back: FAULT, PLC_STALE"),
    ],
)
def test_a_try_that_ends_early_for_another_reason_is_no_candidate_measured(abab_run, how, said):
    _, found, finding = searched(abab_run[0], returns_s=66.0, **how)
    assert (found.tries[1].measured, found.tries[1].worse) == (False, False)
    (missing,) = finding.missing
    assert missing == f"2 was not measured to its end: {missing.partition('end: ')[2]}"
    assert said in missing
    assert missing.endswith("; arm, and search again")
    assert (finding.proposals, finding.verdict) == ((), Verdict.OPEN)


def test_a_first_candidate_that_was_not_measured_leaves_it_open():
    one = Try(actuator="unwind", factor=1.0, measured=False, ended="the correction was taken back")
    assert search.measure(evidence(tries=(one,))).verdict is Verdict.OPEN
    with pytest.raises(RefusedError, match="nothing was tried"):
        search.measure(evidence())


def test_a_service_that_is_not_on_is_not_searched_with():
    def ask(do, **arguments):
        return {"state": "READY", "signals": {"time_s": 1.0}}

    checked = CheckedSite(site=SITE)
    with pytest.raises(RefusedError, match="arm it"):
        run_search("unwind", record_of(SITE), checked, ask, VirtualClock(), lambda _: None)
