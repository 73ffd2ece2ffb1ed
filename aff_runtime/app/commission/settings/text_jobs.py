"""The site file as a text on a screen: with the form's edits in it, checked, put together.

What is edited is one text, whichever way: the form's edits are written into it, and the form is
made of it. What it would do, its try and its saving are those of the form.
"""

from __future__ import annotations

from aff_runtime.app.commission.link.answers import Answer, TextShown
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.settings.form import said_in, sections, text_with_edits
from aff_runtime.app.commission.settings.saving import raw
from aff_runtime.app.commission.settings.site_lines import as_in_file, not_shown, shown, together
from aff_runtime.app.commission.views.of_settings import Clash, TextView
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.text_digest import text_digest


def text(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return the site file's text with what is edited in it, and the same as a form."""
    file_text = raw(where.site).decode("utf-8", "replace")
    if text_digest(file_text) != asked.base:
        return Refusal(why=Why.CHANGED)
    file = shown(file_text)
    typed = _with_edits(where, file_text, asked)
    clashes: tuple[Clash, ...] = ()
    if asked.former:
        typed, clashes = together(asked.former, typed, file)
    try:
        in_file = as_in_file(file_text, typed)
        _refuse_not_shown(where, file_text, typed)
        result = load_parameters(where.site, where.state, in_file)
        found, said = sections(result.checked().site, in_file), said_in(result.findings)
    except ConfigError as error:
        found, said = (), said_in(str(error).splitlines())
    view = TextView(
        base=asked.base, file=file, text=typed, said=said, sections=found, clashes=clashes
    )
    return TextShown(edited=view)


def pending(where: Paths, record: ParameterRecord, asked: Request) -> str:
    """Return the text that is asked about, as the site file would hold it.

    Raises
    ------
    ConfigError
        With its findings, where the form's edits are of a text that is not good, or it has
        characters that do not show.
    RefusedError
        Nothing is edited, or it is no edit of the form.
    """
    if not asked.site_text:
        return text_with_edits(record.site, record.site_text, asked.edits)
    _refuse_not_shown(where, record.site_text, asked.site_text)
    return as_in_file(record.site_text, _with_edits(where, record.site_text, asked))


def _with_edits(where: Paths, file_text: str, asked: Request) -> str:
    """Return the text of the field with the form's edits in it."""
    typed = asked.site_text or shown(file_text)
    if not asked.edits:
        return typed
    in_file = as_in_file(file_text, typed)
    site = load_parameters(where.site, where.state, in_file).checked().site
    return shown(text_with_edits(site, in_file, asked.edits))


def _refuse_not_shown(where: Paths, file_text: str, typed: str) -> None:
    found = not_shown(file_text, typed)
    if found:
        lines = (f"{where.site}:{one.line}:{one.column}  {one.text}" for one in found)
        raise ConfigError("\n".join(lines))
