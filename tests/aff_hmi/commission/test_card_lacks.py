"""What is left to do of a card, and what its steps still wait for, in the reader's language.

The sentences are those that stand in the code of the measurements, found by its syntax tree: one
that is added without a pattern fails here.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from aff_hmi.commission.card_lacks import LACKS
from aff_hmi.commission.in_language import card_in
from aff_hmi.commission.sentences import sentence
from aff_hmi.words import say_in
from aff_runtime.app.card.entries import entries_of
from aff_runtime.app.card.figures import Figure
from aff_runtime.app.card.measure.proof import NOTHING_PROVEN, PARTS
from aff_runtime.app.card.measure.words import OURS_WERE_LATE
from aff_runtime.app.card.standing import card_of
from aff_runtime.app.commission.card.view import card_view
from tests.aff_hmi.commission.test_card_sentences import said
from tests.aff_runtime.app.card.made import BAD, INPUTS, add, book, measured, signed
from tests.each_case import each_case

ENGLISH, GERMAN = say_in("en"), say_in("de")
MEASURES = Path(__file__).parents[3] / "aff_runtime" / "app" / "card" / "measure"
YIELDING = ("_missing", "_no_fall", "_undecided")
BY_HAND = (
    NOTHING_PROVEN,
    OURS_WERE_LATE.format(240.0),
    *(
        f"{part}: whole turns{roll}: 7, 20 are needed; make it longer, or type settle"
        for part in PARTS
        for roll in ("", " of unwind")
    ),
    "no figure: wake-up",
    "the correction is not on: the service is not there",
    "unwind: once more at 0.9 m/s, radius 0.2 m",
)


def lacks() -> Iterator[tuple[str, str]]:
    """Yield where a sentence of what is missing stands, and it with a value in each place."""
    for file in sorted(MEASURES.glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            for text in _texts(node):
                yield f"{file.name}:{text.lineno}", said(text)


def _texts(node: ast.AST) -> Iterator[ast.expr]:
    """Yield the texts that one statement adds to what is missing."""
    if isinstance(node, ast.FunctionDef) and node.name in YIELDING:
        found = [one.value for one in ast.walk(node) if isinstance(one, ast.Yield)]
    elif isinstance(node, ast.Call) and ast.unparse(node.func) == "missing.append":
        found = list(node.args)
    elif isinstance(node, ast.keyword) and node.arg == "missing":
        found = list(node.value.elts) if isinstance(node.value, ast.Tuple) else []
    elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "missing":
        found = [one for one in ast.walk(node.value) if isinstance(one, ast.List)]
        found = [text for one in found for text in one.elts]
    else:
        return
    for one in found:
        text = one.elt if isinstance(one, ast.ListComp) else one
        if isinstance(text, ast.Constant | ast.JoinedStr):
            yield text


@each_case(("where", "text"), list(lacks()))
def test_what_a_step_waits_for_has_its_german(where: str, text: str) -> None:
    assert sentence(text, ENGLISH) == text
    assert sentence(text, GERMAN) != text


def test_they_are_found() -> None:
    files = {where.partition(":")[0] for where, _ in lacks()}
    assert len(list(lacks())) > 20
    assert files >= {"limits.py", "orders.py", "plug.py", "proof.py", "response.py", "search.py"}
    assert files >= {"ripple.py", "shadow.py", "load_cell.py", "words.py"}


@each_case("text", BY_HAND)
def test_what_is_put_together_elsewhere_has_its_german_too(text: str) -> None:
    german = sentence(text, GERMAN)
    assert sentence(text, ENGLISH) == text
    assert not any(
        word in german for word in ("first", "second", "whole", "needed", "once", "no ")
    )


def test_every_pattern_is_translated() -> None:
    assert [text for text in LACKS if GERMAN(text) == text] == []


def test_what_was_not_done_is_what_the_card_says_and_is_told_in_german(tmp_path: Path) -> None:
    made = book(tmp_path)
    add(made, signed(0, add(made, measured(0))))
    add(made, measured(2))
    add(made, measured(3, [BAD]))
    lacking = [Figure(name="time", value=float("nan"), limit="300 ms")]
    add(made, measured(4, lacking, missing=("type how long it took: time=120 ms",)))
    add(made, measured(7, lacking, missing=("unwind: once more at 0.9 m/s",)))
    add(made, measured(12, inputs=replace(INPUTS, roll_id="3")))
    view = card_view(card_of(entries_of(made.read()), INPUTS), None, None, ())
    assert (view.first, view.newest) == (made.read().links[0].sha256, made.read().newest)
    assert card_in(view, ENGLISH).undone == view.undone
    german = card_in(view, GERMAN).undone
    assert len(german) == len(view.undone) == 12
    assert german[0] == "Schritt 1, Kraftmessdose: null ohne Bahn, Prüfgewicht: nicht gemessen"
    assert german[1].endswith(": bestanden, nicht unterschrieben")
    assert german[3].endswith(": offen (eingeben, wie lange es dauerte: time=120 ms)")
    assert german[6].endswith(": offen (unwind: noch einmal bei 0,9 m/s)")
    assert german[11].endswith("(Wickel: 3, jetzt 4)")
