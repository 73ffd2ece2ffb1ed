"""What service and check say of a line is told in the reader's language, with its numbers."""

from __future__ import annotations

import ast
import errno
import inspect
import math
import os
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

from aff_hmi.commission.drive_sentences import WHY_NONE
from aff_hmi.commission.in_language import state_in
from aff_hmi.commission.line_sentences import PROBES, SERVICE, SHAPES
from aff_hmi.commission.sentences import PATTERNS, _compiled, parts, sentence
from aff_hmi.see.rolls_part import rolls_part
from aff_hmi.words import say_in
from aff_runtime.app.commission.link.answers import State
from aff_runtime.app.commission.views.of_line import (
    JobView,
    NoService,
    SaidLine,
    ServiceView,
    SiteView,
)
from aff_runtime.app.control import known_shape, probe_run, shape_keeper
from aff_runtime.app.control.known_shape import trial_words
from aff_runtime.app.link import request_client
from aff_runtime.app.supervisor import probe_session, shape_shelf
from aff_runtime.app.supervisor.settings import desk
from aff_runtime.app.wiring import shape_file
from aff_runtime.app.wiring.shape_file import read_shapes
from aff_runtime.config import identified_drive
from aff_runtime.config.check import check_site
from aff_runtime.core.identify import drive_fit, phasors
from aff_runtime.core.probe import bounds, choosing, drive_record, probe
from aff_runtime.core.shape.trial import Fit
from tests.aff_hmi.commission.steps_of import Steps
from tests.aff_hmi.moments import facts as told
from tests.aff_hmi.moments import seen
from tests.each_case import each_case

ENGLISH, GERMAN = say_in("en"), say_in("de")
SITES = sorted((Path(__file__).parents[3] / "config").glob("*.yaml"))
SAYS = {
    WHY_NONE: (identified_drive, drive_fit, phasors, drive_record),
    PROBES: (probe_run, probe_session, probe, bounds, choosing),
    SHAPES: (known_shape, shape_keeper, shape_shelf, shape_file),
    SERVICE: (request_client, desk),
}
# put together of several parts: said whole below
OF_PARTS = ("keeps its shape", "an unknown roll", "waits for its trial", "was learned with other")


@cache
def said_by(modules: tuple[ModuleType, ...]) -> str:
    """Return every text that modules write, the values left out."""
    trees = [ast.parse(inspect.getsource(one)) for one in modules]
    nodes = [node for tree in trees for node in ast.walk(tree)]
    return "\n".join(str(n.value) for n in nodes if isinstance(n, ast.Constant))


@pytest.mark.parametrize(
    ("pattern", "modules"),
    [
        (p, m)
        for patterns, m in SAYS.items()
        for p in patterns
        if not any(one in p for one in OF_PARTS)
    ],
)
def test_every_pattern_is_of_what_the_code_says(
    pattern: str, modules: tuple[ModuleType, ...]
) -> None:
    written = said_by(modules)
    pieces = [one.strip() for one in re.split(r"\{\w+\}|[:;(),]", pattern)]
    assert [one for one in pieces if one not in written] == []


@pytest.mark.parametrize("path", SITES, ids=lambda path: path.stem)
def test_orders_and_limits_of_every_site_file_that_is_shipped_are_told_in_german(
    path: Path, tmp_path: Path
) -> None:
    found = check_site(path, (), tmp_path).facts
    if found is None:  # a line, or an example of a part
        return
    for text in map(str, (*found.orders, *found.shapes, *found.limits)):
        said = sentence(text, GERMAN)
        assert said != text == sentence(text, ENGLISH)
        assert re.findall(r"[0-9.]+", said) == re.findall(r"[0-9.]+", text)


SAVED = "the shape saved 2026-01-05T06:00:00"
QUIET = Fit(agreement=math.nan, turned_rad=0.0, ratio=math.nan, fits=True)
ANOTHER = Fit(agreement=0.41, turned_rad=0.0, ratio=1.3, fits=False)
LENGTH = 60  # of a text: with its cube a pattern looks at 3 to 10 times as many as with its square
# two places that end anywhere look at half the square once a character; 2 to 3 looks for each
MOST_OF_SQUARE, MANY = 1.5, 100
KEEPS = f"unwind: {SAVED} keeps its shape; its correction of P is of"


@each_case(
    ("text", "german"),
    [
        (
            f"unwind: unwind: {trial_words(SAVED, QUIET)}",
            "unwind: unwind: beginnt mit: die am 2026-01-05T06:00:00 gespeicherte Form; es gibt "
            "keine Welligkeit, an der sie sich prüfen ließe",
        ),
        (
            f"unwind: unwind: {trial_words(SAVED, ANOTHER)}",
            "unwind: unwind: die am 2026-01-05T06:00:00 gespeicherte Form wird nicht benutzt: die "
            "Welligkeit ist eine andere (Übereinstimmung 0.41, Größe 1.30); wird neu gelernt",
        ),
        (
            f"unwind: unwind: {SAVED} is not used: it is of roll 3, now there is roll 4",
            "unwind: unwind: die am 2026-01-05T06:00:00 gespeicherte Form wird nicht benutzt: sie "
            "ist von Wickel 3, jetzt ist Wickel 4 da",
        ),
        (
            f"unwind: {SAVED} waits for its trial: it takes 12 s and 2 turns of every roll with "
            "the line running; arm after that",
            "unwind: die am 2026-01-05T06:00:00 gespeicherte Form wartet auf ihre Probe: sie "
            "dauert 12 s und 2 Umdrehungen jeder Walze und jedes Wickels bei laufender Anlage; "
            "danach scharf schalten",
        ),
        (
            "unwind: the saved shape was learned with other rolls, or another encoder, drive or "
            "signal; the rolls are learned anew",
            "unwind: die gespeicherte Form wurde mit anderen Walzen oder Wickeln, einem anderen "
            "Geber, Antrieb oder Signal gelernt; alle werden neu gelernt",
        ),
        (
            "unwind: an unknown roll in the place of roll 7: the shape of unwind, r6 is forgotten",
            "unwind: ein unbekannter Wickel an der Stelle von Wickel 7: die Form von unwind, r6 "
            "ist vergessen",
        ),
        (
            f"{KEEPS} another response and is learned anew",
            "unwind: die am 2026-01-05T06:00:00 gespeicherte Form bleibt; ihre Korrektur von P "
            "gehört zu einer anderen Streckenantwort und wird neu gelernt",
        ),
        (
            f"{KEEPS} a response that it does not name and is learned anew",
            "unwind: die am 2026-01-05T06:00:00 gespeicherte Form bleibt; ihre Korrektur von P "
            "gehört zu einer Streckenantwort, die sie nicht nennt, und wird neu gelernt",
        ),
    ],
)
def test_what_became_of_a_shape_is_told_to_its_end(text: str, german: str) -> None:
    assert (sentence(text, GERMAN), sentence(text, ENGLISH)) == (german, text)


def test_the_page_of_rolls_tells_of_kept_shapes_in_the_language_of_its_reader(
    tmp_path: Path,
) -> None:
    spoilt = tmp_path / "unwind.json"
    spoilt.write_text("{}")
    _, (fault,) = read_shapes({"unwind": spoilt})
    shapes = ("unwind: the shape of unwind is forgotten", fault)
    known = told()
    moment = seen(facts=replace(known, status=replace(known.status, shapes=shapes)))
    assert rolls_part(moment, ENGLISH).texts == shapes
    first, second = rolls_part(moment, GERMAN).texts
    assert first == "unwind: die Form von unwind ist vergessen"
    assert second.startswith(f"{spoilt}: keine Datei einer Form: ")


def test_a_probe_that_came_to_nothing_says_each_of_its_reasons() -> None:
    text = "not in operation (state OFF); OFF: LINE_RUN=0"
    assert parts(text, GERMAN) == "nicht in Betrieb (Zustand OFF); OFF: LINE_RUN=0"
    text = (
        "unwind: the probe is not heard within its bound; 0.021 m/s would be needed, 0.01 may be: "
        "raise probe.bound_m_s"
    )
    assert parts(text, GERMAN) == (
        "unwind: die Messung ist innerhalb ihrer Grenze nicht zu hören; 0.021 m/s wären nötig, "
        "0.01 dürfen es sein: probe.bound_m_s anheben"
    )


SERVICE_NOW = ServiceView(
    state="ACTIVE",
    heard=True,
    blocked="",
    probing=False,
    probed="nothing was heard of the probe in its time; probe again",
    trying="settings 0123456789ab by carl",
    trying_left_s=40.0,
    tried="7" * 64,
    differs=(),
    learned=(),
)
STATE = State(
    by="carl",
    site=SiteView(path="/site.yaml", there=True, sha256="0" * 64),
    service=SERVICE_NOW,
    card=True,
    job=JobView(
        do="step",
        step=3,
        said=(
            SaidLine(kind="say", text="stopped"),
            SaidLine(kind="say", text="/etc/aff/site.yaml:3:1 is not known"),
        ),
        ask=None,
        seconds=1.0,
    ),
    last=None,
    long=None,
    long_last=None,
)


def test_the_state_of_the_service_is_told_in_german_and_what_is_not_is_marked_as_english() -> None:
    shown = state_in(STATE, GERMAN, sees_all=True, is_open=True)
    assert isinstance(shown.service, ServiceView)
    assert shown.service.probed.startswith("von der Messung kam in ihrer Zeit kein Ergebnis")
    assert shown.service.trying == "Einstellungen 0123456789ab von carl"
    assert shown.job is not None
    assert [(one.text, one.lang) for one in shown.job.said] == [  # type: ignore[union-attr]
        ("angehalten", ""),
        ("/etc/aff/site.yaml:3:1 is not known", "en"),
    ]
    measured = replace(STATE, service=replace(SERVICE_NOW, probed="measured"))
    assert state_in(measured, GERMAN, sees_all=True, is_open=True).service.probed == "measured"  # type: ignore[union-attr]


def test_why_no_service_answers_is_told_in_german() -> None:
    reason = os.strerror(errno.ECONNREFUSED)
    trouble = (
        f"/run/aff/control.sock: no service answers ({reason}); start it with `aff-runtime run "
        "SITE.yaml`, or name its --runtime-dir"
    )
    lost = replace(STATE, service=NoService(trouble=trouble))
    service = state_in(lost, GERMAN, sees_all=True, is_open=True).service
    assert isinstance(service, NoService)
    assert service.trouble.startswith(f"/run/aff/control.sock: kein Dienst antwortet ({reason})")


@pytest.mark.parametrize("unit", [": ", "a: ", "a ", "a: b (c) ", "1 of 1 orders of r below "])
def test_no_text_has_more_ways_to_be_taken_apart_than_the_square_of_its_length(unit: str) -> None:
    text = (unit * LENGTH)[:LENGTH]
    steps = {}
    for pattern, template in _compiled():
        found = Steps(most=MANY * LENGTH**2)
        is_of_it = found.fullmatch(pattern.pattern, text)
        assert is_of_it == (pattern.fullmatch(text) is not None)
        steps[template] = found.count
    assert [one for one, count in steps.items() if count > MOST_OF_SQUARE * LENGTH**2] == []


def test_no_pattern_is_there_twice() -> None:
    assert len(set(PATTERNS)) == len(PATTERNS)
