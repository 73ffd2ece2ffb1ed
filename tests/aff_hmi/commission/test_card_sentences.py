"""Why a step of the card is refused or due again is told in the reader's language.

The refusals are those that stand in the code, found by its syntax tree: one that is added without
a pattern fails here.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from aff_hmi.commission.card_sentences import CARD
from aff_hmi.commission.in_language import card_in
from aff_hmi.commission.sentences import sentence
from aff_hmi.words import say_in
from aff_runtime.app.card.entries import Inputs
from aff_runtime.app.card.site_parts import ALL
from aff_runtime.app.card.standing import changed, not_compared
from aff_runtime.app.card.steps import STEPS
from aff_runtime.app.commission.views.of_line import CardView, StepView
from aff_runtime.app.supervisor.settings.desk import RETURN_ALREADY
from tests.each_case import each_case

ENGLISH, GERMAN = say_in("en"), say_in("de")
APP = Path(__file__).parents[3] / "aff_runtime" / "app"
FILES = (*sorted((APP / "card").rglob("*.py")), APP / "commission" / "card" / "search.py")
REFUSALS = ("RefusedError", "ConfigError", "NotTypedError")
VALUES = {
    "what": "name",
    "at": ", radius 0.2 m",
    "wanted": "a number in N",
    "HAS_COMMA": "has a decimal comma",
    "f' ({why})' if why else ''": " (no sign was typed)",
}
"""What stands in a place of a sentence where any word would not do, by the code of it."""
WITHOUT_TEXT = {"str(error)", "_untold(table.window, earlier_s)"}
"""Texts that are made elsewhere; they are below by hand."""
BY_HAND = (
    "/runs/a@1..2: which settings ran in it cannot be told: they were changed at 20 s; name a "
    "window before that",
    "/runs/a@1..2: which settings ran in it cannot be told: its events cannot be read to the "
    "end; measure anew",
    "/runs/a@1..2: recorded on other settings (0a1b2c, in force from 20 s on) than the site file "
    "says now (3d4e5f)",
    "load=3 m: expected a plain number, or in a unit of that kind",
    "step 3 is not measured: nothing to sign",
    "step 12 signed as Ada; roll not compared",
    "no service answers: roll not compared",
    "site file, rolls not compared",
    f"{RETURN_ALREADY} (its time is up)",
    "site file: 0a1b2c, now 3d4e5f",
)


def refusals() -> Iterator[tuple[str, str]]:
    """Yield where a refusal stands, and its text with a value in each place."""
    for file in FILES:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in REFUSALS:
                code = ast.unparse(node.args[0])
                if code not in WITHOUT_TEXT:
                    yield f"{file.name}:{node.lineno}", said(node.args[0])


def said(node: ast.expr) -> str:
    """Return a text as it would be said."""
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.FormattedValue):
        return VALUES.get(ast.unparse(node.value), "7")
    assert isinstance(node, ast.JoinedStr), ast.unparse(node)
    return "".join(said(part) for part in node.values)


@each_case(("where", "text"), list(refusals()))
def test_every_refusal_of_the_card_has_its_german(where: str, text: str) -> None:
    assert sentence(text, ENGLISH) == text
    assert sentence(text, GERMAN) != text


def test_the_refusals_are_found() -> None:
    found = dict(refusals())
    assert len(found) > 40
    assert {where.partition(":")[0] for where in found} >= {"gather.py", "search.py", "book.py"}


@each_case("text", BY_HAND)
def test_what_is_said_by_way_of_another_has_its_german_too(text: str) -> None:
    assert sentence(text, ENGLISH) == text
    assert sentence(text, GERMAN) != text


def test_what_makes_a_step_due_again_is_told_whole() -> None:
    then = Inputs(
        plc="1",
        roll_id="4",
        machine="Linux 6, 4 processors",
        responses={"unwind": "5a"},
        parts={part.name: "1a" for part in ALL},
    )
    now = replace(
        then,
        plc="2",
        roll_id="5",
        machine="Linux 7, 4 processors",
        responses={"unwind": "6b"},
        parts={part.name: "2b" for part in ALL},
    )
    texts = {text for step in STEPS for text in changed(step, then, now)}
    assert len(texts) == len(ALL) + 4
    nothing = Inputs(parts=then.parts, responses={"unwind": "unknown"})
    texts |= {text for step in STEPS for text in not_compared(step, then, nothing)}
    words = {str(part) for part in ALL} | {"site file", "not compared", " now "}
    for text in texts:
        german = sentence(text, GERMAN)
        assert not any(word in german for word in words), german


def test_a_screen_shows_why_in_the_readers_language() -> None:
    step = StepView(
        number=12,
        title=STEPS[12].title,
        measured=STEPS[12].measured,
        limit=STEPS[12].limit,
        seconds=1800.0,
        stand="again",
        why=("roll: 4, now 5",),
        typed_names=(),
        earlier=0,
        can_sign=False,
        entry=None,
        signed=None,
    )
    card = CardView(
        line="Euclid",
        first="0",
        newest="0",
        entries=1,
        utc="",
        remarks=("no service answers: roll not compared",),
        undone=(),
        steps=(step,),
        proof=None,
    )
    shown = card_in(card, GERMAN)
    assert shown.steps[0].why == ("Wickel: 4, jetzt 5",)
    assert shown.remarks == ("kein Dienst antwortet: Wickel nicht verglichen",)


def test_every_pattern_is_translated() -> None:
    assert [text for text in CARD if GERMAN(text) == text] == []
