"""What an effect is called says what was found: which of its strengths, and in which direction."""

from sim_plant.effects.catalogue import BY_NAME
from tests.each_case import each_case


@each_case(
    ("effect", "values", "text", "remedy"),
    [
        # the records show no play: nobody is sent to look for it
        (
            "shaft_compliance_backlash",
            {"compliance_rad_N_m": 0.007, "backlash_rad": 0.0},
            "shaft twists: the motor",
            "these records show no play",
        ),
        (
            "shaft_compliance_backlash",
            {"compliance_rad_N_m": 0.0, "backlash_rad": 0.003},
            "has play",
            "look for play",
        ),
        (
            "shaft_compliance_backlash",
            {"compliance_rad_N_m": 0.007, "backlash_rad": 0.003},
            "twists or has play",
            "look for play in couplings, keys and gear of {place}, and",
        ),
        # w = v / (ratio R): the believed radius is the ratio times the true one
        ("radius_error", {"ratio": 1.008}, "runs slow", "too large a one"),
        ("radius_error", {"ratio": 0.992}, "runs fast", "too small a one"),
        ("web_modulus", {"factor": 1.2}, "is stiffer", "EA_N"),
        ("web_modulus", {"factor": 0.8}, "is softer", "EA_N"),
        ("wound_in_strain", {"strain": 4e-3}, "tighter than declared", "how tight"),
        ("wound_in_strain", {"strain": -4e-4}, "looser than declared", "how tight"),
        ("thermal_strain", {"strain": 4e-4}, "warmer or moister", "temperature"),
        ("thermal_strain", {"strain": -4e-4}, "cooler or drier", "temperature"),
        ("slip", {"slope_s_m": 3e-3}, "drops before the roller and rises behind", "clean"),
        ("slip", {"slope_s_m": -3e-3}, "rises before the roller and drops behind", "clean"),
        ("bearing_drag", {"constant_N_m": 0.05}, "harder than declared", "bearings"),
    ],
)
def test_words_fit_what_was_found(effect, values, text, remedy):
    said = BY_NAME[effect].words(values)
    assert text in said[0]
    assert remedy in said[1]


def test_hum_that_was_folded_is_told_as_it_was_read_with_what_folds_alike():
    """At 100 Hz of sampling 99.7 Hz reads as 0.3 Hz, and so do 100 - 0.3 + 100 k and its twin."""
    seen = BY_NAME["mains_hum"].seen
    said = seen({"frequency_Hz": 99.69993}, 0.01)
    assert said.startswith("the readings show 0.3 Hz, folded by their sampling at 100 Hz: ")
    assert "0.3, 99.7, 100.3, 199.7, 200.3 Hz look the same" in said
    assert seen({"frequency_Hz": 49.7}, 0.01) == ""
    # what was found is among them, and none twice
    assert ": 0.02, 9.98, 10.02, 19.98, 20.02, 49.98, 50.02 Hz look" in seen(
        {"frequency_Hz": 50.02}, 0.1
    )
    assert ": 0, 50, 100 Hz look" in seen({"frequency_Hz": 50.0}, 0.02)
    assert ": 45.2, 50, 140.48, 145.24, 235.71 Hz look" in seen({"frequency_Hz": 50.0}, 0.0105)
