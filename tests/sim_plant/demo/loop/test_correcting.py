"""What the engineer of the demo does with a block: a line in words, no processes, no time."""

from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.demo.loop.correcting import ATTEMPTS, NOT_TRIED, OF_A_PAUSE, correct
from sim_plant.demo.loop.judging import BlockOrder, Judgement, new_orders, strongest
from sim_plant.demo.runtime_status import RuntimeStatus
from tests.each_case import each_case

SITE, PROPOSED = Path("site.yaml"), Path("proposed.yaml")
R9 = BlockOrder(actuator="unwind", signal="unwind_tension_N", roll="r9", order=1)
R9_TWICE = BlockOrder(actuator="unwind", signal="unwind_tension_N", roll="r9", order=2)
FALL = Judgement(order=R9, before_N=1.0, after_N=0.03, change_dB=-30.5, fell=True)
STAY = Judgement(order=R9, before_N=1.0, after_N=0.99, change_dB=-0.1, fell=False)


class Line:
    """Answers as the service would; keeps what was done in ``done``."""

    def __init__(self, judgement, unsure=(), ends=(), late=()):
        self.judgement, self.unsure, self.ends = judgement, unsure, list(ends)
        self.late = list(late)
        """Why tries end after the last look, one each; empty: they do not."""
        self.done, self.trying = [], ""
        self.rows = ["   1  started"]

    def settings(self, *words):
        if words[0] == "history":
            return "\n".join(self.rows)
        if words[0] == "keep" and self.late and (end := self.late.pop(0)):
            self._end(end)
            raise PlantError(f"aff-runtime keep: exit 4: aff-runtime: {NOT_TRIED}")
        self.done.append(words[0])
        self.trying = "settings 0123 by somebody" if words[0] == "try" else ""
        return words[0]

    def status(self):
        return RuntimeStatus(
            state="ACTIVE",
            blocked_by="",
            alarm="",
            missed_ticks=0,
            trying=self.trying,
            unsure=tuple(self.unsure),
        )

    def watch(self, seconds):
        self._pass()

    def record(self):
        self._pass()
        return "run@5..21"

    def _pass(self):
        if self.trying and self.ends and (end := self.ends.pop(0)):
            self._end(end)

    def _end(self, why):
        self.trying = ""
        self.rows.append(f"   2  returned by the service: {why}")

    def probe_again(self):
        assert not self.trying, "a probe is refused while settings are tried"
        self.done.append("probe")
        self.unsure = ()

    def judge(self, window, orders):
        self.done.append("judge")
        return self.judgement

    def say(self, text):
        pass


def decided(line):
    return correct(line, SITE, PROPOSED, (R9, R9_TWICE), "traced by refine: eccentric_roller")


def test_a_block_under_which_ripple_fell_is_kept_after_it_was_judged():
    line = Line(FALL)
    decision = decided(line)
    assert line.done == ["try", "judge", "keep"]
    assert (decision.kept, decision.probed_again) == (True, False)
    assert "r9 1x: 1 to 0.03 N, -30.5 dB by the service's own record" in decision.why


def test_a_block_that_does_nothing_is_undone_and_the_page_says_why():
    line = Line(STAY)
    decision = decided(line)
    assert line.done == ["try", "judge", "undo"]
    assert not decision.kept
    assert decision.why.startswith("no fall of the ripple: r9 1x: 1 to 0.99 N")


@pytest.mark.parametrize(("judgement", "then"), [(FALL, []), (STAY, ["undo"])])
def test_a_block_that_rests_unsure_of_its_phase_is_probed_before_it_is_judged(judgement, then):
    line = Line(judgement, unsure=["unwind.r9_1x"])
    decision = decided(line)
    assert line.done == ["try", "keep", "probe", "judge", *then]
    assert decision.probed_again
    assert decision.kept is judgement.fell


def test_an_old_order_that_rests_or_a_high_one_of_the_block_asks_for_no_probe():
    line = Line(FALL, unsure=["unwind.unwind_16x", "unwind.r9_2x"])
    assert not decided(line).probed_again


@pytest.mark.parametrize("ends", [[OF_A_PAUSE], ["", OF_A_PAUSE]])
def test_a_try_that_the_machines_pause_ended_is_begun_again_and_not_judged(ends):
    line = Line(FALL, ends=ends)
    assert decided(line).kept
    assert line.done == ["try", "try", "judge", "keep"]


def test_a_try_that_ripple_ended_is_not_repeated_and_nothing_is_kept():
    line = Line(FALL, ends=["ripple of unwind_tension_N rose from 0.8 to 1.3 N"] * 2)
    decision = decided(line)
    assert (line.done.count("try"), decision.kept) == (1, False)
    assert "ripple of unwind_tension_N rose" in decision.why


def test_a_machine_that_pauses_in_every_try_keeps_nothing():
    line = Line(FALL, ends=[OF_A_PAUSE] * ATTEMPTS)
    assert not decided(line).kept
    assert "keep" not in line.done


@pytest.mark.parametrize(
    ("unsure", "then"),
    [
        ((), ["judge", "try", "judge", "keep"]),
        (["unwind.r9_1x"], ["try", "keep", "probe", "judge"]),
    ],
)
def test_a_try_that_ended_after_the_last_look_is_begun_again(unsure, then):
    line = Line(FALL, unsure=unsure, late=[OF_A_PAUSE])
    assert decided(line).kept
    assert line.done == ["try", *then]


def test_a_try_that_ripple_ended_after_the_last_look_counts_as_undone_and_the_page_says_so():
    line = Line(FALL, late=["ripple of unwind_tension_N rose from 0.8 to 1.3 N"])
    decision = decided(line)
    assert (line.done, decision.kept) == (["try", "judge"], False)
    assert decision.why.startswith("the try ended by itself:")
    assert "rose from 0.8 to 1.3 N" in decision.why


def test_a_useless_block_whose_try_ended_during_the_judgement_is_not_undone_twice():
    line = Line(STAY)
    line.judge = lambda *_: line._end(OF_A_PAUSE) or STAY
    decision = decided(line)
    assert (line.done, decision.kept) == (["try"], False)
    assert decision.why.endswith("the try ended by itself")


def test_a_keep_that_is_refused_for_another_reason_stops_the_demo():
    line = Line(FALL)
    settings = line.settings

    def refusing(*words):
        if words[0] == "keep":
            raise PlantError("site.yaml: somebody has saved it meanwhile; nothing is kept")
        return settings(*words)

    line.settings = refusing
    with pytest.raises(PlantError, match="somebody has saved it"):
        decided(line)


def row(order, before, value_dB, high_dB, bound="", roll="r9"):
    return {
        "signal": "unwind_tension_N",
        "roll": roll,
        "order": order,
        "before": {"amplitude": before},
        "after": {"amplitude": 0.1},
        "change": {"value_dB": value_dB, "high_dB": high_dB, "bound": bound},
    }


@each_case(
    ("value_dB", "high_dB", "bound", "fell"),
    [
        (-20.0, -18.0, "", True),
        (-1.0, 0.5, "", False),
        (-20.0, None, "at_most", True),
        (3.0, None, "at_most", False),
        (-3.0, None, "at_least", False),
        (None, None, "none", False),
        (-20.0, None, "", False),  # too few turns for an interval
    ],
)
def test_ripple_fell_only_where_chance_does_not_explain_it(value_dB, high_dB, bound, fell):
    compared = {"rows": [row(1, 1.0, value_dB, high_dB, bound)]}
    assert strongest(compared, (R9,)).fell is fell


def test_the_strongest_of_the_new_orders_is_judged_and_no_other_roll():
    rows = [row(2, 0.2, -40.0, -38.0), row(1, 1.0, 0.0, 0.2), row(1, 5.0, -9.0, -8.0, roll="r3")]
    assert strongest({"rows": rows}, (R9, R9_TWICE)).order == R9


def test_orders_that_the_records_do_not_show_are_named():
    with pytest.raises(PlantError, match="show no r9 1x, r9 2x in both windows"):
        strongest({"rows": []}, (R9, R9_TWICE))


def test_what_a_proposed_site_file_corrects_beyond_the_present_one(tmp_path):
    text = (
        "actuators:\n  unwind:\n    error: { signal: unwind_tension_N }\n    blocks:\n"
        "      - { roll: unwind, orders: [1, 2] }\n"
    )
    (tmp_path / "site.yaml").write_text(text)
    (tmp_path / "new.yaml").write_text(
        f"{text}      - {{ roll: r9, orders: [2, 1] }}\n"
        "      - { roll: r8, orders: [1], enabled: false }\n"
    )
    assert new_orders(tmp_path / "site.yaml", tmp_path / "new.yaml") == (R9, R9_TWICE)
