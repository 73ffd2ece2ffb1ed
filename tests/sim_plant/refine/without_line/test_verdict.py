"""The verdict on records without a line: what its JSON has, what it says and what to do next."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from sim_plant.refine.without_line.free_spectral_lines import SpectralLine
from sim_plant.refine.without_line.general.catalogue import BY_NAME
from sim_plant.refine.without_line.general.findings import Delay, Finding
from sim_plant.refine.without_line.general.judging import JudgedTrial
from sim_plant.refine.without_line.spectral_line_presence import SpectralLinePresence
from sim_plant.refine.without_line.verdict import (
    OutputModel,
    OutputRms,
    RecordVerdict,
    headline,
    next_step,
)
from tests.each_case import each_case

PAGE = Path(__file__).parents[4] / "docs/engineer/refine.md"
PRESENCE = SpectralLinePresence(scope="every speed", present=(True, True), speeds_m_s=(1.0, 2.0))
ORDER = SpectralLine(
    axis="travel",
    frequency=4.0,
    per_record=(3.99, 4.01),
    chi2_reduction=np.float64(900.0),
    presence=replace(PRESENCE, order=2, fundamental=2.0),
)
ONE_SPEED = SpectralLine(
    axis="time",
    frequency=8.0,
    per_record=(8.0, 8.0),
    chi2_reduction=500.0,
    presence=SpectralLinePresence(
        scope="one speed",
        present=(True, False),
        speeds_m_s=(2.0,),
        axis_proven=False,
        other_frequency=4.0,
    ),
)
CLOCK = SpectralLine(
    axis="time",
    frequency=1.0,
    per_record=(1.0,),
    chi2_reduction=300.0,
    clock="is 1/10 of the sample rate",
)


def found(effect, place, **numbers):
    return Finding(
        effect=effect,
        output="force_N",
        place=place,
        text=BY_NAME[effect].text,
        numbers=numbers,
        interval95={name: (0.9 * value, 1.1 * value) for name, value in numbers.items()},
        before_rms=2.0,
        after_rms=1.5,
    )


FRICTION = found("friction_by_sign", "belt_m_s", step=0.5)
SHIFT = found("channel_shift", "output", shift_s=0.02)
MODEL = OutputModel(
    filter="41 taps, 20 ahead and 20 back",
    fell_back=False,
    plain_rms=1.75,
    chosen_rms=1.5,
    with_spectral_lines=True,
    tried=(
        JudgedTrial(effect="chosen", what="a", left_out_rms=1.25, held_out_rms=1.5, taken=True),
    ),
    delays={"belt_m_s": Delay(value_s=0.03, low_s=0.02, high_s=0.04)},
    at_stamps={"declared": 2.5, "plain": 2.25, "chosen": 2.0},
)


def verdict(unknown=(), general_effects=()):
    return RecordVerdict(
        unknown=tuple(unknown),
        clocks=(CLOCK,),
        not_claimed=("no place can be named",),
        residual_rms={"force_N": OutputRms(before=2.0, after=1.0)},
        holdout="b.csv",
        general_effects=tuple(general_effects),
        models={"force_N": MODEL},
    )


def test_other_programs_read_these_keys_and_values():
    """Version 1, as in a file: numbers plain, the frequency on the other axis under its name."""
    said = json.loads(verdict([ORDER, ONE_SPEED], [FRICTION]).to_json())
    assert said == {
        "schema": "record-verdict/1",
        "version": 1,
        "verdict": "unknown",
        "effects": [],
        "unknown": [
            {
                "class": "travel",
                "coordinate": {"wavenumber_1_m": 4.0, "equivalent_radius_m": 1 / (8 * np.pi)},
                "per_record": [3.99, 4.01],
                "strength": 900.0,
                "seen_at": "every speed",
                "present": [True, True],
                "speeds_m_s": [1.0, 2.0],
                "order": 2,
                "fundamental_1_m": 2.0,
            },
            {
                "class": "time",
                "coordinate": {"frequency_Hz": 8.0},
                "per_record": [8.0, 8.0],
                "strength": 500.0,
                "seen_at": "one speed",
                "present": [True, False],
                "speeds_m_s": [2.0],
                "or_else": {"wavenumber_1_m": 4.0},
            },
        ],
        "clocks": [
            {
                "class": "time",
                "coordinate": {"frequency_Hz": 1.0},
                "per_record": [1.0],
                "strength": 300.0,
                "why": "is 1/10 of the sample rate",
            }
        ],
        "not_claimed": ["no place can be named"],
        "residual_rms": {"force_N": {"before": 2.0, "after": 1.0}},
        "holdout": "b.csv",
        "general_effects": [
            {
                "effect": "friction_by_sign",
                "output": "force_N",
                "place": "belt_m_s",
                "numbers": {"step": 0.5},
                "interval95": {"step": [0.45, 0.55]},
                "rms_without": 2.0,
                "rms_with": 1.5,
                "text": BY_NAME["friction_by_sign"].text,
            }
        ],
        "models": {
            "force_N": {
                "filter": "41 taps, 20 ahead and 20 back",
                "fell_back": False,
                "plain_least_squares_rms": 1.75,
                "chosen_rms": 1.5,
                "with_lines": True,
                "delay_s": {"belt_m_s": {"value": 0.03, "interval95": [0.02, 0.04]}},
                "rms_at_stamps": {"declared": 2.5, "plain": 2.25, "chosen": 2.0},
                "tried": [
                    {
                        "effect": "chosen",
                        "what": "a",
                        "left_out_rms": 1.25,
                        "held_out_rms": 1.5,
                        "taken": True,
                    }
                ],
            }
        },
    }


NAMES = {"force_N", "belt_m_s", "step"}
"""Keys that a record gives, not the schema."""


def keys_in(value: object) -> Iterator[str]:
    if isinstance(value, dict):
        yield from value
        for each in value.values():
            yield from keys_in(each)
    elif isinstance(value, list):
        for each in value:
            yield from keys_in(each)


def test_a_verdict_has_no_key_that_its_page_does_not_name():
    text = PAGE.read_text(encoding="utf-8")
    _, paragraph = text.split("`verdict.json` is of another `schema`")
    said = json.loads(verdict([ORDER, ONE_SPEED], [FRICTION]).to_json())
    keys = set(keys_in(said)) - NAMES - {"schema"}
    assert not [key for key in sorted(keys) if f"`{key}`" not in paragraph]


@each_case(
    ("unknown", "effects", "answer", "begins", "goes_on"),
    [
        ((), (), "nothing", "Nothing found: ", "holds no spectral line."),
        ((), (FRICTION,), "traced", "Traced: friction_by_sign at belt_m_s in force_N", ")."),
        ((ORDER,), (), "unknown", "Unknown, strongest first: ", "at every speed (1 and 2 m/s)."),
        (
            (ONE_SPEED,),
            (FRICTION,),
            "unknown",
            "Found: friction_by_sign at belt_m_s in force_N",
            "at another it may be 4 1/m that stays.",
        ),
    ],
)
def test_a_headline_begins_as_its_answer_says(unknown, effects, answer, begins, goes_on):
    told = verdict(unknown, effects)
    assert told.answer == answer
    assert headline(told).startswith(begins)
    assert headline(told).endswith(goes_on)


CLOCKS, SPEED, LOOK, PLACE, NOTHING = (
    "Give all channels one clock",
    "Record at another speed",
    "Look for what repeats there",
    "Look for it at the place named",
    "Nothing to do",
)


@each_case(
    ("unknown", "effects", "steps"),
    [
        ((), (), [NOTHING]),
        ((), (FRICTION,), [PLACE]),
        ((), (SHIFT,), [CLOCKS]),
        ((), (SHIFT, FRICTION), [CLOCKS]),  # what the shift hides is to be fitted anew
        ((ORDER,), (), [LOOK]),
        ((ORDER,), (FRICTION,), [LOOK]),
        ((ONE_SPEED,), (), [SPEED, LOOK]),
        ((ORDER, ONE_SPEED), (SHIFT,), [CLOCKS, SPEED, LOOK]),
    ],
)
def test_each_next_step_fits_what_was_found(unknown, effects, steps):
    said = next_step(verdict(unknown, effects), has_travel=True)
    every = (CLOCKS, SPEED, LOOK, PLACE, NOTHING)
    assert [step for step in every if step in said] == steps


def test_a_column_of_the_speed_is_asked_for_only_where_there_is_none():
    wanted = "a column with the web's absolute speed (travel_speed), or a line declaration"
    assert wanted in next_step(verdict(), has_travel=False)
    assert "travel_speed" not in next_step(verdict(), has_travel=True)
