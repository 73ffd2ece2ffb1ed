"""What stands against arming is said in the reader's language, with what to do about it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from aff_hmi.objections import BY_GUARD, LONGEST, SENTENCES, translated
from aff_hmi.words import say_in
from aff_runtime.core.controller import Controller
from aff_runtime.core.params import BlockParams
from aff_runtime.core.response import Provenance, Response, ResponsePoint, arming_objections
from tests.aff_runtime.core.plants import GRID_HZ, LagDelay, Line, measured, site, with_blocks
from tests.each_case import each_case

ENGLISH, GERMAN = say_in("en"), say_in("de")
ROOT = Path(__file__).parents[2]


def unsure(**more: float) -> Response:
    given = {"gain": 1.0, "phase_rad": 0.0, "relative_error": 0.01, "coherence": 1.0} | more
    points = [ResponsePoint(frequency_Hz=f, **given) for f in (1.0, 2.0, 4.0)]
    return Response(
        points=points, delay_s=0.0, provenance=Provenance(actuator="unwind", signal="t")
    )


def too_fast(*orders: int, stands_in: bool) -> tuple[str, ...]:
    """Return what the plain law says of orders from 10.35 Hz on, at a cycle of 5 ms."""
    blocks = BlockParams(roll="unwind", orders=orders, settle_s=4.0, amp_limit=0.01)
    line = Line(LagDelay(-400.0), {}, omega=5.0)
    response = measured(line.plant.at, GRID_HZ)
    law = Controller(site(replace(with_blocks(blocks), stands_in=stands_in)), {"unwind": response})
    line.run(law, 0.1)
    return tuple(text for text in law.arming_objections()["unwind"] if "plain law" in text)


@each_case(
    "found",
    [
        arming_objections(None, [("unwind_1x", 1.0)]),
        arming_objections(unsure(), [("unwind_1x", 0.0)]),
        arming_objections(unsure(), [("unwind_4x", 31.4)]),
        arming_objections(unsure(relative_error=3.0), [("unwind_1x", 2.0)]),
        arming_objections(unsure(coherence=0.1), [("unwind_1x", 2.0)]),
        too_fast(13, stands_in=False),
        too_fast(13, 14, 16, stands_in=True),
    ],
)
def test_what_the_law_says_is_known_word_by_word(found: tuple[str, ...]) -> None:
    assert found
    for sentence in found:
        english, to_do = translated(f"unwind: {sentence}", ENGLISH) or ("", "")
        assert sentence in (english.removeprefix("unwind: "), f"{english[8:]}; {to_do}")
        assert len(f"unwind: {sentence}") <= LONGEST
        assert to_do
        german, german_to_do = translated(f"unwind: {sentence}", GERMAN) or ("", "")
        assert german not in ("", english)
        assert german_to_do not in ("", to_do)
        in_english = set(re.findall(r"\d+\.\d+", english))
        assert set(re.findall(r"\d+,\d+", german)) == {n.replace(".", ",") for n in in_english}
        assert not re.search(r"\d\.\d", german)


def spoken_in(*files: str) -> str:
    """Return the texts of source files, the literals of one sentence joined."""
    text = "".join((ROOT / "aff_runtime" / name).read_text() for name in files)
    return re.sub(r'"\s*f?"', "", text)


def test_every_sentence_is_one_that_law_or_guard_can_say() -> None:
    source = spoken_in(
        "core/response.py",
        "core/phase.py",
        "core/blocks/bank.py",
        "core/shape/confidence.py",
        "core/shape/law.py",
        "safety/reasons.py",
    )
    for sentence in (*SENTENCES, *BY_GUARD):
        fixed = max(re.split(r"\{\w+\}", sentence), key=len)
        assert fixed in source, sentence


def test_a_name_of_the_site_file_cannot_become_a_place_for_another_text() -> None:
    english, _ = translated(
        "{roll}: {0.__class__}: its roll does not turn, or its angle is not known", ENGLISH
    ) or ("", "")
    assert english.startswith("{roll}: {0.__class__}: its roll")


def test_how_many_more_there_are_is_told_too() -> None:
    assert translated("and 12 more", GERMAN) == (
        "und 12 weitere",
        "zuerst das beseitigen, was in der Liste steht",
    )


def test_what_is_no_known_sentence_is_left_as_it_is() -> None:
    assert translated("unwind: the moon is full", GERMAN) is None
    assert translated("x" * 10_000 + ": ", GERMAN) is None
