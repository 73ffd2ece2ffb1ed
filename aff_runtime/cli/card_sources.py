"""What a card's command gathers from: the site file, the running service, named records."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from aff_runtime.app.card.entries import Inputs, Typed
from aff_runtime.app.card.evidence import CheckedSite
from aff_runtime.app.card.gather import Sources, inputs_of
from aff_runtime.app.card.typed_values import TypedValues
from aff_runtime.app.card.work import CardFile
from aff_runtime.app.check.limits import PATIENCE_S
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.peer import own_process, user_name
from aff_runtime.app.link.request_client import login_behind
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.app.supervisor.validation import load_record
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, ConfigError, RefusedError, WireError
from aff_runtime.base.machine import machine
from aff_runtime.base.run_window import run_window
from aff_runtime.cli.card_search import search
from aff_runtime.cli.service import connect, status_of
from aff_runtime.cli.terminal import say
from aff_runtime.config.check import check_site

__all__ = ["after_search", "by_whom", "inputs_now", "inputs_of", "record_of", "sources"]


def record_of(site: Path, state: Path) -> ParameterRecord:
    """Return what a site file says, checked.

    Raises
    ------
    ConfigError
        It is not good.
    """
    return load_record(site, state).checked()


def sources(
    options: argparse.Namespace, card: CardFile, *, windows: Sequence[str] = (), plc: str = ""
) -> Sources:
    """Return everything that a step may be gathered from.

    Raises
    ------
    AffError
        The site file is not good, or a service is there and does not answer.
    """
    site = options.site or Path(card.begun.site)
    record = record_of(site, options.state_dir)
    with bounded_effort(str(site), ConfigError):
        report = check_site(site, (), options.state_dir)
    if report.site is None or report.facts is None or report.facts.revision != record.site_hash:
        raise RefusedError(f"{site}: somebody has saved it meanwhile; do it again")
    return Sources(
        record=record,
        checked=CheckedSite(
            site=report.site,
            warnings=tuple(str(finding) for finding in report.warnings),
            limits=report.facts.limits,
        ),
        answer=_answer(options),
        windows=tuple(run_window(text) for text in windows),
        machine=machine(),
        plc=plc or card.plc,
    )


def after_search(options: argparse.Namespace, found: Sources, values: Sequence[Typed]) -> Sources:
    """Search with the running service; return sources that look at what was tried.

    Raises
    ------
    AffError
        No service answers, or it refuses.
    """
    named = TypedValues(values).word("actuator") or next(iter(found.checked.site.actuators))
    client = connect(options)

    def ask(do: str, **arguments: Any) -> Any:
        return client.ask(do, timeout_s=PATIENCE_S + 5.0, **arguments)

    try:
        tried = search(named, found.record, found.checked, ask, MonotonicClock(), say)
        answer = status_of(client)
    finally:
        client.close()
    return replace(found, answer=answer, windows=tried.windows, tries=tried.tries)


def inputs_now(
    options: argparse.Namespace, card: CardFile
) -> tuple[Inputs | None, tuple[str, ...]]:
    """Return what holds now, or None, and what is to be said about it."""
    try:
        found = sources(options, card)
        now = inputs_of(found)
    except AffError as error:
        return None, (f"not compared with what holds now: {error}",)
    said = () if found.answer is not None else ("no service answers: roll not compared",)
    return now, said


def by_whom() -> str:
    """Return who runs the command, by the kernel."""
    me = own_process()
    login = login_behind(me)
    return f"{user_name(me.uid)}{f', {login}' if login else ''}"


def _answer(options: argparse.Namespace) -> StatusAnswer | None:
    """Return how the service stands, None where none listens."""
    try:
        client = connect(options)
    except WireError:
        return None
    try:
        return status_of(client)
    finally:
        client.close()
