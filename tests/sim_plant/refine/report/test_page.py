import math
from dataclasses import replace

import numpy as np
import pytest

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.facts import RefineFacts
from sim_plant.refine.report.next_step import next_step
from sim_plant.refine.report.page import confidence, gain, headline
from sim_plant.refine.report.plots import channels_by_error
from sim_plant.refine.report.tables import above_noise, best_each, error_rows, shift_rows
from sim_plant.refine.report.verdict import Ambiguity, ChannelRms, Moment, UnknownFinding
from tests.each_case import each_case
from tests.sim_plant.refine.report.judged_line import CHANNELS, judged
from tests.sim_plant.refine.small import finding, verdict_with

EFFECT = finding(
    "out_of_round_roll",
    "unwind",
    {"shape": "flat", "size_m": 0.0119, "angle_rad": 1.0},
    interval95={"size_m": (0.0117, 0.0121)},
)
SAME = Ambiguity(
    place=EFFECT.place, alternatives=(EffectAt("roll_bounce", "unwind"),), experiments=()
)


def unknown(kind, where=None):
    return UnknownFinding(unknown_class=kind, coordinate=where or {}, chi2_reduction=1e4)


SEEN_AT = {"from_s": 26.74, "zone": "unwind_zone", "channel": "unwind_speed_rad_s"}


def test_angles_and_radii_are_not_what_the_plots_show():
    assert [CHANNELS[k] for k in channels_by_error(judged())] == [
        "unwind_tension_N",
        "line_speed_m_s",
    ]


def test_the_travel_of_a_carriage_counts_as_a_tension_does():
    names = ("dancer_position_m", "accumulator_position_m", "unwind_angle_rad", "unwind_radius_m")
    found = replace(judged(), channels=names)  # 3 / 0.25, 900, 90 and 2 over their floors
    assert [names[k] for k in channels_by_error(found)] == [names[1], names[0]]
    assert [row.mark for row in error_rows(found)] == ["ok", "ok", "sum", "sum"]


def test_the_first_lines_say_what_how_much_what_it_brings_and_what_to_do():
    assert headline(verdict_with(EFFECT)) == (
        "Traced: out of round roll at unwind, flat, depth 11.9 mm (95 %: 11.7 to 12.1)."
    )
    said = gain(judged(), held=True)
    assert "3 N rms as declared, 0.26 N as amended; noise alone leaves 0.25 N" in said
    assert "no proof" in gain(judged(), held=False)


@each_case(
    ("answer", "left", "word"),
    [
        ("unknown", [unknown("time", {"frequency_Hz": 4.0})], "Found"),
        ("unknown", [unknown("event", SEEN_AT)], "Found"),
        ("not_identifiable", [], "Traced"),
        ("traced", [], "Traced"),
    ],
)
def test_a_headline_says_traced_of_no_verdict_that_leaves_something_unknown(answer, left, word):
    said = headline(verdict_with(EFFECT, unknown=left, answer=answer))
    assert said.startswith(f"{word}: out of round roll at unwind")
    assert (word == "Traced") is ("Unknown: " not in said)


@each_case(
    ("found", "block", "word"),
    [
        (verdict_with(EFFECT), True, "paste the AFF block"),
        (verdict_with(EFFECT), False, "At the machine: look how unwind was stored"),
        (verdict_with(unknown=[unknown("travel")]), False, "turns or swings"),
        (verdict_with(unknown=[unknown("state")]), False, "at other speeds"),
        (verdict_with(EFFECT, ambiguous=[SAME]), True, "Nor paste the AFF block of unwind"),
        (verdict_with(), False, "declaration stands"),
        (verdict_with(EFFECT, unknown=[unknown("time")]), True, "comes back when the"),
        (verdict_with(EFFECT, unknown=[unknown("time")]), True, "turns or swings"),
    ],
)
def test_the_next_step_fits_the_verdict(found, block, word):
    assert word in next_step(found, {"unwind": "unwind"} if block else {})


def test_a_declaration_does_not_stand_that_is_wrong_on_the_record_judged():
    said = next_step(verdict_with(), above={"unwind_tension_N": 1.5})
    assert "Do not take the declaration for right: unwind_tension_N above noise" in said


def test_what_a_drive_may_cancel_is_measured_and_mended_first_and_cancelled_until_then():
    eccentric = finding("eccentric_roller", "R8", {"eccentricity_m": 2.67e-4})
    seam = finding("splice", "web", {"step_m": 5e-4, "piece_m": 0.1}, cancel=False)
    said = next_step(verdict_with(eccentric, seam), {"R8": "unwind or swrap_lead"})
    order = (
        "First at the machine: put a dial gauge on R8",
        "total reading is twice the eccentricity",
        "then have the roller, or its bearing seats, trued.",
        "Until that is done, paste the AFF block",
        "at the actuator of unwind or swrap_lead.",
        "Also at the machine: look at the seam",
        "This is no ripple to cancel.",
    )
    at = [said.index(part) for part in order]
    assert at == sorted(at)


@each_case(
    ("above", "outside", "end"),
    [
        ({}, (), ""),
        ({"pull_roll_speed_m_s": 1.266}, (), "pull_roll_speed_m_s 27 % above noise"),
        ({}, ("web.EA_N",), "web.EA_N +20 % (tolerance 10 %): check these"),
        (
            {"a_N": 1.5, "b_N": 2.0},
            ("web.EA_N", "r"),
            "a_N 50 % above noise, b_N 100 % above noise; r +20 % (tolerance 10 %), "
            "web.EA_N +20 % (tolerance 10 %): check these",
        ),
    ],
)
@each_case("ambiguous", [(), (SAME,)])
def test_what_is_not_explained_is_said_beside_what_is(above, outside, end, ambiguous):
    facts = outside_by(0.2, *outside)
    said = next_step(verdict_with(EFFECT, ambiguous=ambiguous), {}, above, facts)
    assert said.endswith(f"Not explained: {end}.") if end else "Not" not in said


def outside_by(shift, *names):
    shifts = dict.fromkeys(names, shift)
    return RefineFacts(shifts=tuple(shift_rows(shifts, dict.fromkeys(shifts, 0.1))))


def test_many_numbers_outside_say_that_the_explanation_is_incomplete():
    names = [f"rollers.R{k}.radius_m" for k in range(5)]
    facts = outside_by(0.2, *names)
    said = next_step(verdict_with(EFFECT), facts=facts)
    assert said.endswith(
        "5 of 5 declared numbers had to leave their tolerance: the explanation is incomplete; do "
        "not correct them, record again."
    )
    assert "rollers" not in said
    assert "5 of 5 declared numbers" in headline(verdict_with(EFFECT), facts)
    barely = outside_by(0.11, *names)
    assert "tolerance" not in next_step(verdict_with(EFFECT), facts=barely)
    assert "Partly" not in headline(verdict_with(EFFECT), barely)


@pytest.mark.parametrize(("after", "told"), [(0.79, True), (0.36, True), (0.35, False)])
def test_a_tension_that_is_left_well_above_its_noise_is_told_first(after, told):
    """Noise of 0.25 N: as much power beyond it is sqrt(2) 0.25 = 0.3536 N."""
    left = {"pullroll_tension_N": ChannelRms(before=6.5, after=after, noise_floor=0.25)}
    found = replace(verdict_with(EFFECT), residual_rms=left)
    partly = (
        f"Partly: pullroll_tension_N still misses by {after:.2g} N (noise 0.25 N); "
        "the place stands, the numbers do not."
    )
    assert headline(found).endswith(partly) is told
    assert confidence(found).endswith(partly) is told


def test_what_is_certain_is_acted_on_beside_what_is_not_told_apart():
    slow = finding("loop_delay", "unwind", {"delay_s": 0.05}, cancel=False)
    drag = finding("bearing_drag", "R4", {"constant_N_m": 0.05}, cancel=False)
    also = tuple(EffectAt("bearing_drag", name) for name in ("R5", "R3"))
    open_ = Ambiguity(place=drag.place, alternatives=also, experiments=("look",))
    facts = RefineFacts(along=("R3", "R4", "R5"))
    said = next_step(verdict_with(slow, drag, ambiguous=[open_]), facts=facts)
    assert said.startswith("At the machine: look for what is slow between load cell and drive")
    assert said.endswith("For bearing drag at R3 to R5: change nothing before this test: look.")
    assert "turn R4" not in said


def test_a_site_file_that_was_written_is_tried_and_no_block_pasted():
    said = next_step(
        verdict_with(EFFECT), {"unwind": "unwind"}, facts=RefineFacts(is_proposed=True)
    )
    assert "try site_proposed.yaml with `aff-runtime settings try`" in said
    assert "paste" not in said


def test_what_was_left_out_on_request_is_named():
    line = unknown("angle", {"roll": "unwind", "order": 1.003})
    found = verdict_with(unknown=[line], answer="unknown")
    said = headline(found, RefineFacts(without=("out_of_round_roll",)))
    assert "library without out of round roll (left out on request) explains it." in said
    assert "Put a dial gauge on unwind and turn it once" in next_step(found)


def test_a_number_that_fits_elsewhere_is_told_in_its_own_unit():
    """A tolerance of 20 % is two standard deviations: -8.71 of them are -87.1 %."""
    where = {"declared": "web.kelvin_voigt_eta_s", "standard_deviations": -8.71}
    found = verdict_with(unknown=[unknown("state", where)], answer="unknown")
    said = headline(found, RefineFacts(tolerances={"web.kelvin_voigt_eta_s": 0.2}))
    assert "inner damping of web (web.kelvin_voigt_eta_s) -87.1 % (tolerance 20 %)" in said
    loud = RefineFacts(loudest="unwind_speed_rad_s (1.99 of its noise), b.csv, 3.0 to 11.0 s")
    assert next_step(found, facts=loud).endswith("b.csv, 3.0 to 11.0 s: look there.")


def test_an_event_is_looked_up_in_the_log_of_its_record():
    begins = Moment(record="day2.csv", time_s=26.74)
    event = UnknownFinding(
        unknown_class="event", coordinate=SEEN_AT, chi2_reduction=211522.9, begins=begins
    )
    found = verdict_with(unknown=[event], answer="unknown")
    assert "Look in the log of day2.csv at 26.74 s" in next_step(found)
    assert "an event at 26.74 s of day2.csv in unwind_zone, first seen in" in headline(found)
    assert (
        "From that moment on the weighted squared error is 211523 more than noise"
        in confidence(found)
    )


def test_a_spectral_line_is_as_sure_as_it_is_above_what_noise_makes():
    lines = [unknown("time", {"frequency_Hz": hertz}) for hertz in (3.33, 4.2)]
    said = confidence(verdict_with(unknown=lines))
    assert "takes 10000, 10000 of the weighted squared error" in said
    assert f"less than {CRITERIA.search.unexplained.periodic:.0f}" in said


def test_a_declaration_stands_except_for_what_no_record_tells():
    said = next_step(verdict_with(), untold=["a wrong scale or zero of a load cell"])
    assert said.endswith(
        "except for what these records cannot tell: a wrong scale or zero of a load cell."
    )


def test_what_is_not_told_apart_is_named_together_in_the_headline():
    eccentric = finding("eccentric_roller", "R4", {"eccentricity_m": 1.078e-4})
    also = [EffectAt("unbalanced_roller", "R5"), *(EffectAt("eccentric_roller", k) for k in AT)]
    open_ = Ambiguity(place=eccentric.place, alternatives=tuple(also), experiments=("look",))
    slow = finding("loop_delay", "unwind", {"delay_s": 0.05})
    assert headline(verdict_with(eccentric, slow, ambiguous=[open_])) == (
        "Traced: eccentric roller at R4, R5, R6 or unbalanced roller at R5 (not told apart), "
        "eccentricity 0.1078 mm; loop delay at unwind, delay 50 ms."
    )
    two = replace(open_, alternatives=(EffectAt("eccentric_roller", "R5"),))
    said = headline(verdict_with(eccentric, ambiguous=[two]))
    assert said.startswith("Traced: eccentric roller at R4 or R5 (not told apart), ")


AT = ("R5", "R6")


def test_what_rounds_to_a_limit_is_not_beyond_it_and_sums_do_not_count():
    limit = CRITERIA.report.above_noise
    close = replace(
        judged(), rms_amended=np.array([0.25 * (limit + 0.004), 50.0, 50.0, limit + 0.006])
    )
    assert list(above_noise(close, channels_by_error(close))) == ["line_speed_m_s"]
    assert [row.mark for row in error_rows(close)] == ["ok", "sum", "sum", "miss"]
    shifts = {"a": 0.1004, "b": 0.149, "c": -0.15, "d": 0.02}
    rows = shift_rows(shifts, dict.fromkeys(shifts, 0.1))
    assert [row.name for row in rows if row.is_far] == ["c"]


def test_how_sure_names_the_next_best_and_by_how_much_it_is_behind():
    slow = finding(
        "load_cell_filter",
        "all",
        {},
        score=16173.2,
        runner_up=EffectAt("load_cell_filter", "R19"),
        margin=10200.4,
    )
    assert confidence(verdict_with(slow)) == (
        "load cell filter at all load cells scores 16173, the next best explanation "
        "(load cell filter at R19) 5973: told apart, for errors of the model make up to 10."
    )
    assert confidence(verdict_with()) == ""


def test_how_sure_says_in_newton_what_the_next_best_leaves_where_the_two_differ_most():
    """By noise floors: the unwind's tension by 1.5, the pull roll's by 1, a speed by 9."""
    one = finding(
        "eccentric_roller",
        "R4",
        {},
        runner_up=EffectAt("eccentric_roller", "R5"),
        margin=300.0,
        runner_up_rms={
            "unwind_tension_N": 0.41,
            "pullroll_tension_N": 1.2,
            "line_speed_m_s": 0.01,
            "gone_N": 9.0,
        },
    )
    errors = {
        "unwind_tension_N": ChannelRms(before=3.0, after=0.26, noise_floor=0.1),
        "pullroll_tension_N": ChannelRms(before=3.0, after=1.0, noise_floor=0.2),
        "line_speed_m_s": ChannelRms(before=0.004, after=0.001, noise_floor=0.001),
    }
    said = confidence(replace(verdict_with(one), residual_rms=errors))
    assert (
        " On the record judged the error in unwind_tension_N is 0.26 N rms with eccentric roller "
        "at R4, 0.41 N with eccentric roller at R5 in its place. "
    ) in said


def test_what_is_not_told_apart_is_not_said_to_be_decided():
    rival = EffectAt("eccentric_roller", "R5")
    one = finding("eccentric_roller", "R4", {}, score=121900.0, runner_up=rival, margin=253.0)
    open_ = Ambiguity(place=one.place, alternatives=(rival,), experiments=())
    said = confidence(verdict_with(one, ambiguous=[open_]))
    assert said == (
        "eccentric roller at R4 scores 121900, its rival (eccentric roller at R5) 121647: not "
        "told apart, for errors of the model may make that difference."
    )
    slow = finding("loop_delay", "unwind", {}, score=900.0)
    both = confidence(verdict_with(one, slow, ambiguous=[open_]))
    assert both.endswith("no other explains the record as well.")


def test_what_stays_above_noise_is_named_but_no_sums():
    assert "all tensions and speeds are within 10 %" in gain(judged(), held=True)
    loud = replace(judged(), rms_amended=np.array([0.3, 50.0, 50.0, 1.05]))
    assert gain(loud, held=True).endswith("10 % above noise: unwind_tension_N (x 1.20).")


@each_case(
    ("kind", "where", "said"),
    [
        ("time", {"frequency_Hz": 3.33}, "3.33 Hz at every speed"),
        (
            "time",
            {"frequency_Hz": 3.33, "zone": "rewind_zone", "channel": "rewind_tension_N"},
            "3.33 Hz at every speed, strongest in rewind_tension_N, in rewind_zone",
        ),
        # 1 / 4.18 m a turn, that over 2 pi as radius
        (
            "travel",
            {"wavenumber_1_m": 4.18, "equivalent_radius_m": 0.0380754},
            "every 239.2 mm of web (4.18 1/m); a roller of 38.08 mm radius",
        ),
        ("angle", {"roll": "unwind", "order": 4.0}, "4 times per turn of unwind"),
        (
            "state",
            {"declared": "web.EA_N", "standard_deviations": -14.6},
            "EA of web (web.EA_N) -14.6 standard deviations from",
        ),
        ("broadband", {}, "noise above the line's own"),
    ],
)
def test_an_unknown_is_said_with_units(kind, where, said):
    assert said in headline(verdict_with(unknown=[unknown(kind, where)], answer="unknown"))


def test_a_line_seen_at_one_speed_is_told_as_all_that_it_may_be():
    """4 Hz at 0.8 m/s are 5 1/m: every 200 mm of web, a roller of 31.83 mm turns so."""
    where = {"wavenumber_1_m": 5.0, "equivalent_radius_m": 0.2 / (2.0 * math.pi)}
    line = replace(unknown("time", {"frequency_Hz": 4.0}), also=(("travel", where),))
    found = verdict_with(unknown=[line], answer="unknown")
    said = headline(found)
    assert "in time, 4 Hz, or else something that repeats every 200 mm of web" in said
    assert "31.83 mm radius turns so (one speed does not tell which)" in said
    assert "at every speed" not in said
    assert "Record at another speed and fit both records" in next_step(found)
    alone = verdict_with(unknown=[replace(line, also=())], answer="unknown")
    assert "4 Hz at every speed" in headline(alone)
    assert "another speed" not in next_step(alone)


def test_numbers_that_used_most_of_their_tolerance_come_first():
    shifts = {"web.EA_N": 0.01, "sensors.c.offset": -0.05, "control.pull_roll_draw": 2e-6}
    rows = shift_rows(shifts, {"web.EA_N": 0.1, "sensors.c.offset": 0.1})
    assert [(r.name, r.shift, r.tolerance) for r in rows] == [
        ("sensors.c.offset", "-0.05 N", "0.1 N"),
        ("web.EA_N", "+1 %", "10 %"),
        ("control.pull_roll_draw", "+2e-06 (absolute)", ""),
    ]


def test_every_form_of_a_rejected_effect_is_one_row():
    one, other = EffectAt("a", "R1"), EffectAt("b", "R1")
    assert best_each([(one, 9.0), (other, 8.0), (one, 7.0)]) == [(one, 9.0), (other, 8.0)]
