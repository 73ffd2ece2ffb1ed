"""What a card's step proposes, tried on the running web, kept or taken back: for a screen."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from aff_runtime.app.card.measure.search import text_with
from aff_runtime.app.card.work import CardFile
from aff_runtime.app.commission.link.answers import Answer, Done
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths, parameters_of
from aff_runtime.app.commission.settings.saving import asked_of, await_saved, save
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.app.link.settings_request import reason_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import RefusedError
from aff_runtime.config.findings import KeyPath

# KEY.KEY: NUMBER  # remark
_PROPOSED = re.compile(r"([A-Za-z_][\w.]*): ([-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)(?:\s+#.*)?")


def proposed(sentences: Sequence[str]) -> Mapping[KeyPath, float]:
    """Return the settings that a step proposes, by their path of keys in the site file.

    Raises
    ------
    RefusedError
        There is none, or one that is no number.
    """
    settings: dict[KeyPath, float] = {}
    for text in sentences:
        match = _PROPOSED.fullmatch(text)
        if match is None:
            raise RefusedError(f"{text}: cannot be tried here; use `aff-runtime settings try`")
        path = tuple(int(key) if key.isdecimal() else key for key in match[1].split("."))
        settings[path] = float(match[2])
    if not settings:
        raise RefusedError("this step proposes nothing")
    return settings


def try_proposed(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Have the service run what a step proposes for a while; it takes it back by itself."""
    standing = CardFile.of(where.card).standing(asked.step, None)
    if (
        standing.last is None
        or standing.measured is None
        or standing.last.sha256 != asked.measured
    ):
        return Refusal(why=Why.CHANGED)
    now = parameters_of(where.site, where.state)
    text = text_with(now.site_text, proposed(standing.measured.result.proposals))
    return try_text(where, asked, talk, text, by_screen(asked))


def try_text(
    where: Paths, asked: Request, talk: Talk, text: str, why: str, base: str = ""
) -> Answer:
    """Have the service run a text for a while, and say what changes by it.

    ``base`` : sha256 of the settings that it was decided on; empty: whatever runs.

    Raises
    ------
    AffError
        No service answers, or it refuses.
    """
    decided = {"base": base} if base else {}
    seconds = float(asked.seconds)
    answer = ask_settings(where, act="try", text=text, seconds=seconds, why=why, **decided)
    for change in (*answer.remarks, *answer.changes):
        talk.say(str(change))
    return Done(text=f"tried for {asked.seconds} s: {'; '.join(map(str, answer.changes))}")


def keep(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Save the text that the person saw tried, and no other, as the site file."""
    answer = ask_settings(where, act="keep", why=by_screen(asked), tried=asked.measured)
    save_handed_out(where, answer)
    return Done(text="kept; saved as the site file")


def undo(where: Paths, asked: Request, talk: Talk) -> Answer:
    """End the try that the person saw; the site file, which it never was in, is not written."""
    ask_settings(where, act="undo", why=by_screen(asked), tried=asked.measured)
    return Done(text="undone; the former settings run")


def save_handed_out(where: Paths, answer: SettingsAnswer) -> bool:
    """Save what the service hands out as its site file; return whether it runs, or waits.

    What waits for bypass runs after one.

    Raises
    ------
    AffError
        It cannot be saved, or does not run yet.
    """
    save(where.site, answer)
    return await_saved(partial(ask_settings, where, act="state"), answer.text, MonotonicClock())


def by_screen(asked: Request, of: str = "") -> str:
    """Return the reason as the history has it: with who is at the screen.

    Parameters
    ----------
    of : what it is about, said beside the name.

    Raises
    ------
    RefusedError
        The reason itself is too short: a name beside it makes it no longer.
    """
    about = f", {of}" if of else ""
    return f"{reason_of(asked.reason)} ({asked.account} at the screen{about})"


def ask_settings(where: Paths, **arguments: Any) -> SettingsAnswer:
    """Return what the service answers to a request about settings; as `asked_of`."""
    client = ServiceClient(where.socket)
    try:
        return asked_of(client, **arguments)
    finally:
        client.close()
