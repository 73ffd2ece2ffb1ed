"""Asks the service about settings, and saves the site file that it hands out.

With the rights of whoever runs this: the service itself never writes its site file.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from aff_runtime.app.check.limits import ANSWER_S, PATIENCE_S
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.base.errors import ConfigError, RefusedError, WireError
from aff_runtime.base.files import replace_text
from aff_runtime.base.ports import Clock
from aff_runtime.config.plain_file import read_plain
from aff_runtime.config.yaml_marks import MAX_BYTES

SAVED_PATIENCE_NS = 10_000_000_000  # until the service runs on what was saved
LOOK_NS = 100_000_000  # between two questions whether it does


def asked_of(client: ServiceClient, **arguments: Any) -> SettingsAnswer:
    """Return what the service answers to a request about settings.

    ``act`` : try, keep, save, undo, diff or history, or state: what runs, and how a try stands.

    Raises
    ------
    AffError
        None answers, or it refuses.
    """
    answer = client.ask("settings", timeout_s=PATIENCE_S + ANSWER_S, **arguments)
    try:
        return SettingsAnswer.from_json(answer)
    except (ValueError, KeyError, TypeError, AttributeError):
        raise WireError("the answer cannot be read; is the service of another release?") from None


def save(site: Path, answer: SettingsAnswer) -> None:
    """Save what the service hands out as its site file, with the rights of whoever runs this.

    The caller names the file: no service tells root where to write.

    Raises
    ------
    ConfigError
        When it is not the service's site file, is another one by now, or may not be written;
        nothing is kept then.
    """
    if os.path.realpath(site) != os.path.realpath(answer.site):
        raise ConfigError(f"{site}: the service runs on {answer.site}; nothing is kept")
    if hashlib.sha256(raw(site)).hexdigest() != answer.replaces:
        raise ConfigError(f"{site}: somebody has saved it meanwhile; nothing is kept")
    try:
        replace_text(site, answer.text, keep_owner=True)
    except OSError as error:
        raise ConfigError(
            f"{site}: {error.strerror}; nothing is kept. Run the command as who may write it"
        ) from None


def await_saved(state: Callable[[], SettingsAnswer], text: str, clock: Clock) -> bool:
    """Wait until the service runs on what was saved; return False where that waits for bypass.

    Raises
    ------
    RefusedError
        When it does not, or not yet.
    """
    wanted = hashlib.sha256(text.encode("utf-8")).hexdigest()
    end_ns = clock.now_ns() + SAVED_PATIENCE_NS
    while clock.now_ns() < end_ns:
        now = state()
        if now.running == wanted and not now.trying and not now.waiting:
            return True
        if now.waiting == wanted:
            return False
        clock.sleep_until_ns(clock.now_ns() + LOOK_NS)
    raise RefusedError("it is saved and does not run yet; see `aff-runtime status`")


def raw(path: Path) -> bytes:
    """Return what a site file holds.

    Raises
    ------
    ConfigError
        It cannot be read.
    """
    try:
        return read_plain(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        said = error.strerror if isinstance(error, OSError) else str(error)
        raise ConfigError(f"{path}:1:1  cannot be read: {said}") from None
