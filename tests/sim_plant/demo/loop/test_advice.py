"""What the page says is to be done: what AFF cancels is not called beyond cancelling."""

from dataclasses import replace
from pathlib import Path

from sim_plant.demo.loop.advice import advice, cancelled_rolls
from sim_plant.demo.loop.correcting import Decision
from sim_plant.refine.report.verdict import UnknownFinding
from tests.sim_plant.refine.small import finding, verdict_with

ROLLS = cancelled_rolls(Path("config/euclid.yaml"))


def effect(name, location, *, cancel):
    return replace(finding(name, location, {}), cancel=cancel)


ROLL = effect("out_of_round_roll", "unwind", cancel=True)
RIPPLE = effect("torque_ripple", "unwind", cancel=True)
IDLER = effect("eccentric_roller", "R9", cancel=True)
MODULUS = effect("web_modulus", "web", cancel=False)


def test_what_the_shipped_blocks_cancel_is_said_to_be_cancelled_without_a_new_block():
    said = advice(verdict_with(ROLL, RIPPLE), None, ROLLS)
    assert said.startswith("AFF cancels the ripple of out_of_round_roll at unwind, torque_ripple")
    assert "No correction" not in said
    assert "No block" not in said


def test_what_no_correction_cancels_stands_apart_from_what_one_does():
    said = advice(verdict_with(ROLL, MODULUS), None, ROLLS)
    assert "AFF cancels the ripple of out_of_round_roll at unwind" in said
    assert "No correction cancels web_modulus" in said


def test_an_idler_is_cancelled_with_its_block_and_stays_where_that_was_not_kept():
    kept = Decision(kept=True, why="it fell")
    assert "cancels the ripple of eccentric_roller at R9" in advice(
        verdict_with(IDLER), kept, ROLLS | {"r9"}
    )
    undone = Decision(kept=False, why="it did not fall")
    said = advice(verdict_with(IDLER), undone, ROLLS)
    assert said.startswith("The block was not kept; ripple of eccentric_roller at R9 stays")
    said = advice(verdict_with(IDLER), None, ROLLS)
    assert said.startswith("No block of the site file acts; ripple of eccentric_roller at R9")


def test_what_is_left_unknown_is_said_beside_what_was_found():
    unknown = UnknownFinding(unknown_class="angle", coordinate={"order": 2.0}, chi2_reduction=9.0)
    said = advice(verdict_with(ROLL, answer="unknown", unknown=(unknown,)), None, ROLLS)
    assert "AFF cancels the ripple of out_of_round_roll at unwind" in said
    assert "Look for what turns or swings at that coordinate" in said


def test_the_rolls_are_those_of_the_shipped_blocks():
    assert {"unwind", "swrap_follower"} == ROLLS


def test_with_nothing_found_the_declaration_stands():
    assert advice(verdict_with(answer="nothing"), None, ROLLS) == (
        "Nothing to do: the declaration stands."
    )
