"""The verdict in words for a screen: one kind of five, and the sentences of the page."""

from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.summary import kind_of
from sim_plant.refine.report.verdict import Ambiguity, UnknownFinding, Verdict
from tests.each_case import each_case

EVENT = UnknownFinding(unknown_class="event", coordinate={}, chi2_reduction=1.0)
ANGLE = UnknownFinding(unknown_class="angle", coordinate={}, chi2_reduction=1.0)
SAME = Ambiguity(place=EffectAt("eccentric_roller", "R6"), alternatives=(), experiments=())


@each_case(
    ("answer", "unknown", "ambiguous", "kind"),
    [
        ("nothing", (), (), "nothing"),
        ("traced", (), (), "traced"),
        ("not_identifiable", (), (SAME,), "set"),
        ("unknown", (EVENT,), (), "event"),
        ("unknown", (EVENT, ANGLE), (), "unknown"),
        ("unknown", (ANGLE,), (SAME,), "unknown"),
    ],
)
def test_an_event_is_told_apart_from_what_else_is_unknown(answer, unknown, ambiguous, kind):
    verdict = Verdict(
        answer=answer,
        effects=(),
        unknown=unknown,
        ambiguous=ambiguous,
        residual_rms={},
        holdout="b.csv",
    )
    assert kind_of(verdict) == kind
