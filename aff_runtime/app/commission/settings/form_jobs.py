"""Settings on a screen: the form, what an edit would do, its try, versions and the way back."""

from __future__ import annotations

from aff_runtime.app.commission.link.answers import (
    Answer,
    DifferenceShown,
    Done,
    SettingsShown,
    VersionShown,
)
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths, parameters_of
from aff_runtime.app.commission.settings.form import (
    WAITS,
    is_finding,
    lines_between,
    said_in,
    sections,
)
from aff_runtime.app.commission.settings.jobs import (
    ask_settings,
    by_screen,
    save_handed_out,
    try_text,
)
from aff_runtime.app.commission.settings.saving import raw
from aff_runtime.app.commission.settings.text_jobs import pending
from aff_runtime.app.commission.views.of_settings import DifferenceView, SettingsView, VersionView
from aff_runtime.app.hand.may import WORDS, Code
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.settings_answer import SAVED_MEANWHILE, SettingsAnswer, Version
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.errors import AffError, ConfigError, RefusedError
from aff_runtime.base.text_digest import text_digest

MOST_VERSIONS = 100  # newest of the history
NOT_WHAT_RUNS = "the site file is not what runs: look at the alarms, or wait"
WAITS_SAVED = "what is saved takes effect at the next bypass"
SAVED = "saved as the site file, and runs"
RUNS = "this is what runs"


def form(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return the site file as a form, with its versions."""
    against, answer = "", SettingsAnswer()
    try:
        answer = ask_settings(where, act="history")
    except AffError as error:
        against = str(error)
    record: ParameterRecord | None = None
    try:
        result = load_parameters(where.site, where.state)
        record, said = result.checked(), said_in(result.findings)
    except ConfigError as error:
        said = said_in(str(error).splitlines())
    sha256 = text_digest(record.site_text) if record is not None else ""
    if not against and sha256 != answer.running and not answer.trying:
        against = WAITS_SAVED if sha256 == answer.waiting != "" else NOT_WHAT_RUNS
    view = SettingsView(
        site=str(where.site),
        sha256=sha256,
        running=answer.running,
        against=against,
        said=said,
        sections=sections(record.site, record.site_text) if record is not None else (),
        versions=tuple(reversed(answer.versions[-MOST_VERSIONS:])),
    )
    return SettingsShown(settings=view)


def difference(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return what an edit would do; nothing goes out."""
    try:
        edited = _edited(where, asked)
    except ConfigError as error:
        return DifferenceShown(difference=_refused(error))
    if edited is None:
        return Refusal(why=Why.CHANGED)
    return DifferenceShown(difference=_difference(where, *edited))


def try_edited(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Have the service run an edit for a while; it takes it back by itself."""
    edited = _edited(where, asked)
    if edited is None or text_digest(edited[1]) != asked.measured:
        return Refusal(why=Why.CHANGED)  # it is another text than the person has seen
    return try_text(where, asked, talk, edited[1], by_screen(asked), asked.base)


def save_edited(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Save an edit as the site file: what waits for bypass can be tried by nobody."""
    edited = _edited(where, asked)
    if edited is None or text_digest(edited[1]) != asked.measured:
        return Refusal(why=Why.CHANGED)
    why = by_screen(asked)
    answer = ask_settings(where, act="save", text=edited[1], why=why, base=asked.base)
    if text_digest(answer.text) != asked.measured:
        return Refusal(why=Why.CHANGED)
    return Done(text=SAVED if save_handed_out(where, answer) else WAITS_SAVED)


def _edited(where: Paths, asked: Request) -> tuple[str, str] | None:
    """Return the site file's text and the edited one; None where it is not the file edited."""
    record = parameters_of(where.site, where.state)
    if text_digest(record.site_text) != asked.base:
        return None
    return record.site_text, pending(where, record, asked)


def _refused(error: ConfigError) -> DifferenceView:
    """Return what is told in place of a difference, where a text has none."""
    lines = str(error).splitlines()
    if not any(map(is_finding, lines)):
        raise error
    return DifferenceView(
        sha256="", changes=(), said=said_in(lines), refused=True, waits=False, lines=()
    )


def version(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return one version: its difference to the one before, and to what runs."""
    history = ask_settings(where, act="history")
    found = next((one for one in history.versions if one.number == asked.number), None)
    if found is None:
        raise RefusedError(f"there is no version {asked.number}")
    text, against, back = _text(where, found), "", None
    before = _before(history, found)
    former = _text(where, before) if before is not None else ""
    if not text:
        against = f"the text of version {found.number} is not there any more"
    elif history.trying:
        against = WORDS[Code.TRYING]
    elif found.sha256 == (history.waiting or history.running):
        against = WAITS_SAVED if history.waiting else RUNS
    elif not asked.back:
        against = WORDS[Code.SETTINGS_ROLE]
    else:
        saved = raw(where.site).decode("utf-8", "replace")
        back = _difference(where, saved, text, history.running)
    lines = lines_between(former, text) if text and former else ()
    view = VersionView(
        version=found, lines=lines, back=back, running=history.running, against=against
    )
    return VersionShown(version=view)


def go_back(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Save the text of a version as the site file; the service applies it as any edit."""
    now = ask_settings(where, act="state")
    if now.trying:
        raise RefusedError(WORDS[Code.TRYING])
    if now.running != asked.base:
        return Refusal(why=Why.CHANGED)
    why = by_screen(asked)
    text = ask_settings(where, act="history", version=asked.number).text
    if text_digest(text) != asked.measured:
        return Refusal(why=Why.CHANGED)
    _refuse_what_cannot_run(_difference(where, text, text, asked.base))
    answer = ask_settings(where, act="undo", version=asked.number, why=why, base=asked.base)
    if text_digest(answer.text) != asked.measured:
        return Refusal(why=Why.CHANGED)
    if save_handed_out(where, answer):
        return Done(text=f"version {asked.number} is saved as the site file, and runs")
    return Done(text=WAITS_SAVED)


def _refuse_what_cannot_run(found: DifferenceView) -> None:
    """Refuse a text that the check refuses by now: it would be saved, and not run."""
    if found.refused:
        said = (f"{one.path}: {one.text}" if one.path else one.text for one in found.said)
        raise RefusedError("\n".join(said))


def _difference(where: Paths, former: str, text: str, running: str = "") -> DifferenceView:
    """Return what would become of a text; ``running``: sha256 of what it has to be against."""
    changes: tuple[str, ...] = ()
    refused = False
    try:
        answer = ask_settings(where, act="diff", text=text)
        if running and answer.running != running:
            raise RefusedError(SAVED_MEANWHILE)
        changes, said = answer.changes, said_in(answer.remarks)
    except AffError as error:
        lines = str(error).splitlines()
        if not any(map(is_finding, lines)):
            raise
        refused, said = True, said_in(lines)
    return DifferenceView(
        sha256=text_digest(text),
        changes=changes,
        said=said,
        refused=refused,
        waits=any(change.endswith(WAITS) for change in changes),
        lines=lines_between(former, text),
    )


def _text(where: Paths, one: Version) -> str:
    """Return the text of a version; empty when it is not there any more."""
    try:
        return ask_settings(where, act="history", version=one.number).text
    except RefusedError:
        return ""


def _before(history: SettingsAnswer, one: Version) -> Version | None:
    """Return the version that ran before one, with another text."""
    earlier = [v for v in history.versions if v.number < one.number and v.sha256 != one.sha256]
    return earlier[-1] if earlier else None
