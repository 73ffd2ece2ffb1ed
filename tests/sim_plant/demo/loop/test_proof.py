"""What the demo of the loop asks of itself."""

from sim_plant.demo.loop.proof import ModelError, Proof
from sim_plant.refine.report.verdict import Verdict
from tests.each_case import each_case

WELL = {
    "unwind_tension_N": ModelError(declared=1.5, amended=0.26, floor=0.26),
    "pullroll_tension_N": ModelError(declared=0.3, amended=0.27, floor=0.26),
    "unwind_speed_rad_s": ModelError(declared=0.03, amended=0.02, floor=0.01),
}
OFF = ModelError(declared=1.5, amended=0.29, floor=0.26)


def proof(**given):
    known = {"named": True, "before_N": 1.0, "after_N": 0.03, "errors": WELL}
    return Proof(
        verdict=Verdict(
            answer="traced", effects=(), ambiguous=(), unknown=(), residual_rms={}, holdout=""
        ),
        **(known | given),
    )


def missed(one):
    return [text for text, met in one.targets if not met]


def test_all_targets_are_met_by_a_cause_named_and_cancelled():
    assert missed(proof()) == []


@each_case(
    ("given", "word"),
    [
        ({"named": False}, "names effect"),
        ({"after_N": 0.06}, "25 dB"),  # 24.4 dB
        ({"errors": WELL | {"unwind_tension_N": OFF}}, "model error"),
        ({"errors": WELL | {"pullroll_tension_N": OFF}}, "model error"),
        ({"before_N": None, "after_N": None, "cancels": True}, "block"),
        ({"after_N": None, "tried": False}, "tried and judged"),
    ],
)
def test_a_miss_is_named(given, word):
    (said,) = missed(proof(**given))
    assert word in said


def test_what_has_no_block_is_not_asked_for_one():
    assert missed(proof(before_N=None, after_N=None)) == []
