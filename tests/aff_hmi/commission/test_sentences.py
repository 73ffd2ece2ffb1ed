"""Whatever the interview asks or says is found again by its pattern, with its numbers."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from aff_hmi.commission.choices import with_buttons
from aff_hmi.commission.sentences import LONGEST, PATTERNS, sentence
from aff_hmi.words import say_in
from aff_runtime.app.setup import flow
from aff_runtime.app.setup.asking import look
from aff_runtime.app.setup.asking.dialogue import RowReader
from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.drive_questions import drive_questions, law_question
from aff_runtime.app.setup.asking.interview import (
    bit_questions,
    first_number,
    further_question,
    line_questions,
    machine_questions,
    second_question,
    status_questions,
    wire_question,
    wire_questions,
    word_questions,
)
from aff_runtime.app.setup.asking.quantities import angles, quantities
from aff_runtime.app.setup.asking.questions import AnswerError, Question, bit, one_of
from aff_runtime.app.setup.bus.questions import (
    bus_questions,
    count_question,
    dbc_question,
    listen_question,
    lost_question,
    node_question,
    own_node_question,
    scale_question,
    scan_question,
)
from aff_runtime.app.setup.bus.roles import (
    Role,
    applied_role,
    complement_role,
    correction_role,
    of_quantity,
    words_read,
    words_written,
)
from aff_runtime.app.setup.bus.steps import which_signal
from aff_runtime.app.setup.modbus import display_steps, steps
from tests.each_case import each_case

ENGLISH, GERMAN = say_in("en"), say_in("de")
SECOND = "swrap_follower"
SAME = {"Port"}  # as in English


def questions() -> list[Question]:
    """Return every question in words of a line with a second roller."""
    draft = Draft(answers={"second": SECOND, "echo": "15", "heartbeat": "0"})

    def known(address: int) -> str:
        return ""

    return [
        wire_question(),
        *wire_questions(),
        *line_questions(),
        second_question(SECOND),
        further_question(draft, 1),
        *word_questions(draft, known),
        *status_questions(known),
        *bit_questions(draft, known),
        *machine_questions(draft),
        law_question(draft),
        *drive_questions(draft.with_answer("speed_gain", "15").with_answer("density", "395")),
        first_number(0),
    ]


@each_case("text", [one.text for one in questions()])
def test_every_question_is_asked_in_german_and_stays_as_it_is_in_english(text: str) -> None:
    assert sentence(text, ENGLISH) == text
    assert sentence(text, GERMAN) != text or text in SAME


@each_case("wanted", [*quantities(SECOND), *angles(SECOND)], ids=lambda q: q.channel)
def test_what_is_asked_of_a_display_is_translated_to_its_end(wanted) -> None:
    said = sentence(
        f"What does the drive show now as {wanted.asked}, all digits and the unit?", GERMAN
    )
    assert said.startswith("Was zeigt der Antrieb")
    assert wanted.asked not in said


@each_case(
    "wanted", [one for one in quantities(SECOND) if one.moves is not None], ids=lambda q: q.channel
)
def test_how_a_quantity_is_moved_is_told_to_its_end(wanted) -> None:
    for text in (
        "Which one? `again`: type the value at another moment, which decides more surely; "
        "`move`: move it, and see which word follows",
        display_steps.AT_REST,
        display_steps.how_to_move(wanted),
    ):
        said = sentence(text, GERMAN)
        assert said != text == sentence(text, ENGLISH)
        assert wanted.asked not in said


@each_case(
    ("why", "german"),
    [
        (
            "rows 1, 2, 4 fit alike, and a wrong word in the loop moves the web",
            "Zeilen 1, 2, 4 passen gleich gut, und ein falsches Wort im Regelkreis bewegt die "
            "Bahn",
        ),
        ("the scale of row 1 is not round", "die Skala von Zeile 1 ist nicht rund"),
        ("no row stood out when it was moved", "keine Zeile ragte beim Bewegen heraus"),
        ("another word or number can be it too",
         "ein anderes Wort oder eine andere Zahl kann es auch sein"),
        ("several words count up like a scan", "mehrere Wörter zählen wie ein Zyklus"),
        ("several bits changed with it", "mehrere Bits änderten sich mit"),
    ],
)  # fmt: skip
def test_why_no_row_is_taken_unasked_is_told(why: str, german: str) -> None:
    text = f"no row is taken unasked: {why}. Write 1 to 4 or again or move."
    assert sentence(text, GERMAN) == (
        f"keine Zeile wird ungefragt genommen: {german}. 1 bis 4 oder „anderer Augenblick“ oder "
        "„bewegen“ schreiben."
    )
    assert sentence(text, ENGLISH) == (
        f"no row is taken unasked: {why}. Write 1 to 4 or “another moment” or “move it”."
    )


NODES = Draft(answers={"wire": "canopen_402", "eds.1": "drive.eds"})
BUS = (
    *bus_questions(),
    dbc_question(Path()),
    own_node_question(),
    node_question(NODES, Path(), 1),
    listen_question(),
    scan_question(5.0),
    lost_question("unwind_drive"),
    scale_question("unwind_angle_rad", "rad", "unwind_drive.0x6064"),
    scale_question("unwind_tension_N", "N", "unwind_drive.0x2010"),
    count_question("correction_scale.unwind", "unwind_drive.0x60B1"),
)
ROLES = (
    *words_read(),
    *words_written(),
    applied_role("unwind"),
    correction_role("unwind"),
    complement_role("unwind", 16),
    *(of_quantity(one, ("unwind", SECOND)) for one in (*quantities(SECOND), *angles(SECOND))),
)


@each_case("text", [one.text for one in BUS])
def test_what_is_asked_of_a_bus_is_asked_in_german_too(text: str) -> None:
    assert sentence(text, ENGLISH) == text
    assert sentence(text, GERMAN) != text


@each_case("role", ROLES, ids=lambda role: role.name)
def test_which_signal_is_what_is_asked_in_german_to_its_end(role: Role) -> None:
    text = which_signal(role)
    said = sentence(text, GERMAN)
    assert said != text == sentence(text, ENGLISH)
    assert said.startswith("Welches Signal, das AFF")
    assert role.asked not in said


def refused(read: Callable[[str], str], text: str) -> str:
    """Return what a reader of an answer says against it."""
    with pytest.raises(AnswerError) as told:
        read(text)
    return str(told.value)


ROWS = RowReader(rows=frozenset({1, 2}), at={}, choices=("again", "none"))
NO_ROWS = RowReader(rows=frozenset(), at={}, choices=("again", "move"))


@each_case(
    ("read", "text", "english", "german"),
    [
        (
            ROWS,
            "9",
            '"9": write 1 to 2 or “another moment” or “none”.',
            "„9“: 1 bis 2 oder „anderer Augenblick“ oder „keine“ schreiben.",
        ),
        (
            NO_ROWS,
            "1",
            '"1": write “another moment” or “move it”.',
            "„1“: „anderer Augenblick“ oder „bewegen“ schreiben.",
        ),
        (
            one_of("yes", "skip"),
            "ja",
            '"ja" is not known. Known here: “yes”, “skip”.',
            "„ja“ ist nicht bekannt. Hier bekannt: „ja“, „auslassen“.",
        ),
        (
            one_of("yes", "no"),
            "yess",
            '"yess" is not known. Did you mean “yes”?',
            "„yess“ ist nicht bekannt. Gemeint ist „ja“?",
        ),
    ],
)
def test_a_refusal_names_the_buttons_as_they_are_called(
    read: Callable[[str], str], text: str, english: str, german: str
) -> None:
    said = refused(read, text)
    assert (sentence(said, ENGLISH), sentence(said, GERMAN)) == (english, german)


def test_a_question_names_its_buttons_and_leaves_what_must_be_typed() -> None:
    asked = "Which one? `again`: type the value at another moment, which decides more surely"
    said = with_buttons(sentence(asked, GERMAN), ("again",), GERMAN)
    assert said.startswith("Welches? „anderer Augenblick“: ")
    assert with_buttons(asked, ("again",), ENGLISH).startswith("Which one? “another moment”: ")
    assert with_buttons("`find`, or `none`", (), GERMAN) == "`find`, or `none`"


@pytest.mark.parametrize(
    ("text", "german"),
    [
        (
            f"  word {2:5} changed by {3.1:.4g} N, at rest {0.25:.4g}",
            "Wort 2 um 3.1 N geändert, in Ruhe 0.25",
        ),
        (f"  word {9:5} = {1:6}  still", "Wort 9 = 1  unbewegt"),
        (f"  word {4:5}: u16 8896  i16 8896", "Wort 4: u16 8896 i16 8896"),
    ],
)
def test_the_columns_of_a_terminal_hide_no_sentence(text: str, german: str) -> None:
    assert sentence(text, GERMAN) == german


def test_what_is_refused_of_a_bit_is_told_in_german() -> None:
    said = refused(bit(lambda word, bit: ""), "7")
    assert sentence(said, GERMAN).startswith("„7“: Wort und Bit schreiben, etwa 20.7")
    assert sentence(said, ENGLISH) == said


def told() -> list[str]:
    """Return what the setup says in its code, with a number for each place."""
    found = []
    for module in (display_steps, flow, look, steps):
        tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") in (
                "say",
                "complain",
            ):
                found.append(_text(node.args[0]).strip())
    return [text for text in found if text not in ("7", "")]


def _text(node: ast.expr) -> str:
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(
            "7" if isinstance(one, ast.FormattedValue) else _text(one) for one in node.values
        )
    return "7"


OF_MANY_WORDS = re.compile(r"word +7: 7|warning .*")  # a table of readings; a file's finding


@each_case("text", told())
def test_what_the_engine_says_is_said_in_german(text: str) -> None:
    if OF_MANY_WORDS.fullmatch(text):
        return
    text = text.replace("words7", "words")  # with nothing that it refuses
    assert sentence(text, GERMAN) != text


@each_case(
    ("text", "german"),
    [
        (
            "word 9 i32 high_first: 88.9 N with scale 0.001; 1 mN is round, moves",
            "Wort 9 i32 high_first: 88.9 N mit Skala 0.001; 1 mN ist rund, bewegt sich",
        ),
        (
            "word 0: counts every 5.00 ms, a scan of 5 ms",
            "Wort 0: zählt alle 5.00 ms, ein Zyklus von 5 ms",
        ),
        (
            "word 13 i32 high_first: 4096 counts/turn; measured 4096.1 counts/turn (4038 to "
            "4153.9), in less than one turn, one word",
            "Wort 13 i32 high_first: 4096 counts/turn; gemessen 4096.1 Zählschritte je "
            "Umdrehung (4038 bis 4153.9), in weniger als einer Umdrehung, ein Wort",
        ),
        (
            "word 13 i32 high_first: 4000 counts/turn; measured 4160 counts/turn (4101 to 4219), "
            "not this number if radius and line speed are right, one word, then no word is left "
            "that can be swrap_follower",
            "Wort 13 i32 high_first: 4000 counts/turn; gemessen 4160 Zählschritte je Umdrehung "
            "(4101 bis 4219), nicht diese Zahl, wenn Radius und Geschwindigkeit stimmen, ein "
            "Wort, dann bleibt kein Wort, das swrap_follower sein kann",
        ),
    ],
)
def test_rows_are_told_with_their_reasons(text: str, german: str) -> None:
    assert sentence(text, GERMAN) == german
    assert sentence(text, ENGLISH) == text


@each_case("text", ["", "{site}", "no pattern of ours", "<b>", "x" * 5000, "(" * 300])
def test_what_is_in_no_pattern_is_told_as_it_is(text: str) -> None:
    assert sentence(text, GERMAN) == text


def test_no_two_patterns_are_one_and_a_long_text_takes_no_time() -> None:
    assert len(set(PATTERNS)) == len(PATTERNS)
    hostile = "word 1: " + ", ".join(["a: b; c"] * 200)
    assert len(sentence(hostile, GERMAN)) >= len(hostile[:LONGEST]) - 8


def test_a_sentence_that_is_cut_ends_with_an_ellipsis_and_one_that_is_not_does_not() -> None:
    start, entry = "nothing was measured: ", "x" * LONGEST
    said = sentence(start + entry, ENGLISH)
    assert said == f"{start}{entry}"[: LONGEST - 1] + "\u2026"
    assert sentence(start + entry, GERMAN).endswith("x\u2026")
    fits = start + entry[: LONGEST - len(start)]
    assert sentence(fits, ENGLISH) == fits
    assert sentence(entry + entry, GERMAN) == entry + entry  # of no pattern: told whole
