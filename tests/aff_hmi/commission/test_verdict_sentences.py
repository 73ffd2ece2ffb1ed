"""A verdict of refine is told in the reader's language: what, where, what to do."""

from __future__ import annotations

import pytest

pytest.importorskip("numba")

from aff_hmi.commission.of_runs import refined_in
from aff_hmi.commission.sentences import sentence
from aff_hmi.commission.verdict_sentences import NAMES, REMEDIES, TEXTS
from aff_hmi.words import say_in
from aff_runtime.app.commission.views.of_refining import AskedOf, RefinedRow, RefinedView
from aff_runtime.base.refinement import EffectSaid, Summary
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.next_step import ANOTHER_SPEED
from sim_plant.refine.report.wording import coordinate_text, place_words
from tests.each_case import each_case

ENGLISH, GERMAN = say_in("en"), say_in("de")
DRAG = "turn R4 by hand with the web off; clean, grease or change its bearings"


def test_what_is_known_of_effects_is_still_what_the_catalogue_says():
    """A pattern whose words the catalogue no longer has would never be found."""
    names = {
        place_words(EffectAt(effect=one.name, location="R1")).replace("R1", "{place}")
        for one in CATALOGUE
    }
    assert set(NAMES) <= names
    said = [*CATALOGUE, *(form for one in CATALOGUE for form in one.forms)]
    assert set(TEXTS) <= {one.text for one in said}
    assert set(REMEDIES) <= {one.remedy for one in said}


@each_case(
    ("kind", "where"),
    [
        ("time", {"frequency_Hz": 12.5}),
        ("angle", {"order": 2.0, "roll": "unwind"}),
        ("travel", {"wavenumber_1_m": 2.0, "equivalent_radius_m": 0.08}),
        ("event", {"from_s": 43.2, "zone": "the pull roll's zone", "channel": "pullroll_N"}),
        ("state", {"declared": "web.EA_N", "standard_deviations": 7.0}),
        ("broadband", {"channels": "a_N, b_N", "from_Hz": 1.0, "to_Hz": 2.0}),
        ("broadband", {}),
    ],
)
def test_what_is_unknown_is_told_in_german_with_the_same_numbers(kind, where):
    text = coordinate_text(kind, where)
    said = sentence(text, GERMAN)
    assert said != text
    assert [c for c in said if c.isdigit()] == [c for c in text if c.isdigit()]
    assert sentence(text, ENGLISH) == text


IN_TRAVEL = ("travel", {"wavenumber_1_m": 2.0, "equivalent_radius_m": 0.08})
AT_ANGLES = [("angle", {"order": 7.5, "roll": roll}) for roll in ("unwind", "rewind")]


@pytest.mark.parametrize(
    "also", [[IN_TRAVEL], [IN_TRAVEL, *AT_ANGLES[:1]], [IN_TRAVEL, *AT_ANGLES]]
)
def test_what_one_speed_does_not_tell_is_told_in_german_whole(also):
    text = coordinate_text("time", {"frequency_Hz": 12.5}, None, also)
    said = sentence(text, GERMAN)
    assert [c for c in said if c.isdigit()] == [c for c in text if c.isdigit()]
    assert not {"something", "or", "which", "every", "turns"} & set(said.split())
    assert sentence(ANOTHER_SPEED, GERMAN).startswith("Bei einer anderen Geschwindigkeit")


def summary(**words: object) -> Summary:
    said = {
        "kind": "traced",
        "headline": "Traced: slip at pull_roll, slope 0.1 s/m (95 %: 0.09 to 0.11); bearing drag "
        "at R4, constant 0.17 N m.",
        "sure": "slip at pull_roll scores 900, the next best explanation (loop delay at unwind) "
        "120; bearing drag at R4 scores 80, no other explains the record as well.",
        "gain": "On the held-out record the error in load_cell_N is 3.1 N rms as declared, 0.27 N "
        "as amended; noise alone leaves 0.26 N. As amended, all tensions and speeds are within "
        "10 % of noise.",
        "next_step": "At the machine: clean the surface of pull_roll, give it more "
        f"wrap or nip, or run slower; {DRAG}.",
        "effects": (
            EffectSaid(
                place="bearing drag at R4",
                text=CATALOGUE[4].text,
                numbers=(),
                can_cancel=False,
                to_do=DRAG,
                others=("bearing drag at R5",),
                experiments=("lift the web off R4",),
            ),
        ),
        "unknown": (),
        "errors": (),
        "limits": (),
        "judged_on": "b.csv",
        "held_out": True,
        "site_said": (),
    }
    return Summary(**{**said, **words})


def told(said: Summary, say) -> Summary:
    asked = AskedOf(windows=("a",), holdout=(), without=(), by="carl", utc="u")
    row = RefinedRow(number=1, asked=asked, kind="traced", text="")
    view = RefinedView(row=row, summary=said, proposal=None, command="")
    found = refined_in(view, say).summary
    assert found is not None
    return found


def test_a_verdict_reads_german_from_its_headline_to_what_to_do():
    found = told(summary(), GERMAN)
    assert found.headline == (
        "Gefunden: Schlupf: pull_roll, slope 0.1 s/m (95 %: 0.09 to 0.11); schwergängiges "
        "Lager: R4, constant 0.17 N m."
    )
    assert found.sure == (
        "Schlupf: pull_roll erreicht 900, die nächstbeste Erklärung (Totzeit im Zugregelkreis: "
        "unwind) 120; schwergängiges Lager: R4 erreicht 80, nichts anderes erklärt die "
        "Aufzeichnung so gut."
    )
    assert found.gain.endswith("innerhalb 10 % des Rauschens.")
    assert "3.1 N" in found.gain
    drag = "R4 ohne Bahn von Hand drehen; Lager reinigen, schmieren oder tauschen"
    assert found.next_step.endswith(f"oder langsamer fahren; {drag}.")
    (effect,) = found.effects
    assert effect.to_do == drag
    assert effect.others == ("schwergängiges Lager: R5",)
    assert effect.experiments == ("lift the web off R4",)


def test_what_the_next_best_leaves_is_told_in_german():
    said = summary(
        sure="On the record judged the error in unwind_tension_N is 0.26 N rms with bearing drag "
        "at R4, 0.41 N with bearing drag at R5 in its place."
    )
    assert told(said, GERMAN).sure == (
        "Auf der beurteilten Aufzeichnung ist der Fehler von unwind_tension_N effektiv 0.26 N mit "
        "schwergängiges Lager: R4, 0.41 N mit schwergängiges Lager: R5 an seiner Stelle."
    )


def test_a_verdict_in_english_is_what_refine_wrote():
    assert told(summary(), ENGLISH) == summary()


def test_an_effect_that_is_new_is_told_in_english():
    new = "Traced: warped plate at R4, size 2 mm."
    assert told(summary(headline=new), GERMAN).headline == (
        "Gefunden: warped plate at R4, size 2 mm."
    )


def test_effects_beside_something_unknown_are_found_in_german_too():
    said = told(summary(headline="Found: slip at pull_roll, slope 0.1 s/m."), GERMAN).headline
    assert said == "Gefunden: Schlupf: pull_roll, slope 0.1 s/m."


def test_a_set_names_its_members_in_german():
    said = summary(
        headline="Traced: eccentric roller at R1 or R2 (not told apart), eccentricity 0.1 mm."
    )
    assert told(said, GERMAN).headline == (
        "Gefunden: exzentrische Walze: R1 oder R2 (nicht unterschieden), eccentricity 0.1 mm."
    )


def test_a_set_of_an_older_file_names_its_members_in_german():
    said = summary(headline="eccentric roller at R1 cannot be told from eccentric roller at R2.")
    assert told(said, GERMAN).headline == (
        "exzentrische Walze: R1 ist nicht zu unterscheiden von exzentrische Walze: R2."
    )


def test_what_is_not_told_apart_is_no_next_best_in_german():
    sure = (
        "eccentric roller at R4 scores 121900, its rival (eccentric roller at R5) 121647: not "
        "told apart, for errors of the model may make that difference."
    )
    assert told(summary(sure=sure), GERMAN).sure == (
        "exzentrische Walze: R4 erreicht 121900, die Alternative (exzentrische Walze: R5) 121647: "
        "nicht unterschieden, denn Fehler des Modells können so viel ausmachen."
    )


def test_how_far_above_noise_something_unknown_is_reads_german():
    sure = (
        "What repeats there takes 35512, 6653 of the weighted squared error, by noise alone it "
        "would be less than 260."
    )
    assert told(summary(sure=sure), GERMAN).sure == (
        "Was sich dort wiederholt, macht 35512, 6653 des gewichteten quadrierten Fehlers aus, vom "
        "Rauschen allein wäre es weniger als 260."
    )


TRUED = (
    "put a dial gauge on R8: its total reading is twice the eccentricity; then have the roller, "
    "or its bearing seats, trued"
)


@each_case(
    ("text", "words"),
    [
        (f"First at the machine: {TRUED}.", ["Zuerst an der Maschine: Messuhr an R8 setzen"]),
        (
            "Until that is done, paste the AFF block below into the site file, at the actuator of "
            "unwind or swrap_lead. The ripple of a cancelled roller comes back when the service "
            "is off.",
            ["Bis das getan ist", "unwind", "wenn der Dienst aus ist."],
        ),
        (
            "Look in the log of b.csv at 26.74 s: what was done on the line then. What is left is "
            "largest in a_N (1.5 of its noise), b.csv, 3 to 11 s: look there.",
            ["Im Protokoll von b.csv bei 26.74 s", "dort nachsehen."],
        ),
        (
            "Not explained: a_N 27 % above noise; web.EA_N +20 % (tolerance 10 %): check these.",
            ["Nicht erklärt: a_N 27 %", "diese prüfen."],
        ),
    ],
)
def test_what_to_do_next_is_told_in_german(text, words):
    said = told(summary(next_step=text), GERMAN).next_step
    assert all(word in said for word in words), said
