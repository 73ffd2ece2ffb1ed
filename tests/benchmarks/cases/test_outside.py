"""What counts as right of something that no library holds."""

from benchmarks.cases.outside import is_honest
from tests.each_case import each_case

WORDS = {"what": "words", "every_s": 1.36, "hold_s": 0.5}
PLAY = {"what": "play", "band_N": 0.9}
BURSTS = {"what": "bursts", "velocity_m_s": 0.03, "frequency_Hz": 7.1, "every_s": 2.0}
FAN = {"what": "fan", "strain": 1e-4, "frequency_Hz": 1.5}


def unknown(*rows, effects=()):
    first, *others = ({"class": kind, "coordinate": where} for kind, where in rows)
    return {"unknown": [{**first, "alternatives": others}], "effects": list(effects)}


@each_case(
    ("hidden", "said", "right"),
    [
        (WORDS, unknown(("time", {"period_s": 1.36})), True),
        (WORDS, unknown(("time", {"frequency_Hz": 1 / 1.36})), True),
        (WORDS, unknown(("time", {"period_s": 2.0})), False),
        (WORDS, unknown(("event", {"from_s": 26.7})), False),
        (WORDS, unknown(("state", {"declared": "gain"}), ("time", {"period_s": 1.36})), True),
        (PLAY, unknown(("state", {"channel": "r3_tension_N"})), True),
        (PLAY, unknown(("state", {"declared": "tension_pi.gain"})), False),
        (PLAY, unknown(("time", {"frequency_Hz": 0.4})), False),
        (BURSTS, unknown(("time", {"frequency_Hz": 7.0})), True),
        (BURSTS, unknown(("time", {"frequency_Hz": 6.6})), True),
        (BURSTS, unknown(("time", {"frequency_Hz": 6.8})), False),
        (BURSTS, unknown(("travel", {"wavenumber_1_m": 7.0})), False),
        (FAN, unknown(("time", {"frequency_Hz": 1.51})), True),
        (FAN, unknown(("time", {"frequency_Hz": 1.51}), effects=[{"effect": "slip"}]), False),
        (FAN, {"unknown": [], "effects": []}, False),
        (FAN, {}, False),
    ],
)
def test_class_and_coordinate_have_to_be_those_of_what_was_hidden(hidden, said, right):
    assert is_honest(hidden, said) is right


def test_one_wrong_class_beside_a_right_one_is_not_right():
    both = unknown(("time", {"frequency_Hz": 1.5}))["unknown"]
    both += unknown(("state", {"declared": "gain"}))["unknown"]
    assert not is_honest(FAN, {"unknown": both})
