"""What a card is gathered from: the site file, the running service, named records."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from aff_runtime.app.card.entries import Inputs, Typed
from aff_runtime.app.card.evidence import CheckedSite
from aff_runtime.app.card.gather import Sources, inputs_of
from aff_runtime.app.card.typed_values import TypedValues
from aff_runtime.app.card.work import CardFile
from aff_runtime.app.check.limits import ANSWER_S, PATIENCE_S
from aff_runtime.app.commission.card.search import search
from aff_runtime.app.commission.paths import Paths, parameters_of, status_of
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.report.status_answer import read_answer
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, ConfigError, RefusedError
from aff_runtime.base.machine import machine
from aff_runtime.base.runs.window import run_window
from aff_runtime.config.check import check_site

__all__ = ["after_search", "inputs_now", "inputs_of", "said_of", "sources"]


def sources(
    where: Paths, card: CardFile, *, windows: Sequence[str] = (), plc: str = ""
) -> Sources:
    """Return everything that a step may be gathered from.

    Raises
    ------
    AffError
        The site file is not good, or a service is there and does not answer.
    """
    site = where.site
    parameters = parameters_of(site, where.state)
    with bounded_effort(str(site), ConfigError):
        report = check_site(site, (), where.state)
    site_hash = report.facts.site_hash if report.facts is not None else ""
    if report.site is None or report.facts is None or site_hash != parameters.site_hash:
        raise RefusedError(f"{site}: somebody has saved it meanwhile; do it again")
    return Sources(
        parameters=parameters,
        checked=CheckedSite(
            site=parameters.site,  # with what a probe identified: it is what runs
            warnings=tuple(str(finding) for finding in report.warnings),
            limits=report.facts.limits,
        ),
        answer=status_of(where.socket),
        windows=tuple(run_window(text) for text in windows),
        machine=machine(),
        plc=plc or card.plc,
    )


def after_search(
    where: Paths, found: Sources, values: Sequence[Typed], say: Callable[[str], None]
) -> Sources:
    """Search with the running service; return sources that look at what was tried.

    Raises
    ------
    AffError
        No service answers, or it refuses.
    """
    named = TypedValues(values).word("actuator") or next(iter(found.checked.site.actuators))
    client = ServiceClient(where.socket)

    def ask(do: str, **arguments: Any) -> Any:
        return client.ask(do, timeout_s=PATIENCE_S + ANSWER_S, **arguments)

    try:
        tried = search(named, found.parameters, found.checked, ask, MonotonicClock(), say)
        answer = read_answer(client.ask("status"))
    finally:
        client.close()
    if not tried.windows:
        why = tried.tries[-1].ended if tried.tries else ""
        raise RefusedError(f"nothing was measured: {why or 'no candidate came to its end'}")
    return replace(found, answer=answer, windows=tried.windows, tries=tried.tries)


def inputs_now(where: Paths, card: CardFile) -> tuple[Inputs | None, tuple[str, ...]]:
    """Return what holds now, or None, and what is to be said about it."""
    try:
        found = sources(where, card)
        now = inputs_of(found)
    except AffError as error:
        return None, (f"not compared with what holds now: {error}",)
    return now, said_of(found)


def said_of(found: Sources) -> tuple[str, ...]:
    """Return what is to be said of a comparison with what holds now."""
    return () if found.answer is not None else ("no service answers: roll not compared",)
