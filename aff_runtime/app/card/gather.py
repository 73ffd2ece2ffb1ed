"""From check, service and records to what a step looks at, and what it rests on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from aff_runtime.app.card.entries import UNKNOWN, Inputs, RecordWindow
from aff_runtime.app.card.evidence import CheckedSite, Evidence, Need, Try
from aff_runtime.app.card.figures import Sample
from aff_runtime.app.card.records import record_window
from aff_runtime.app.card.run_settings import InForce, changes_settings, in_force, learned_of
from aff_runtime.app.card.site_parts import parts_of
from aff_runtime.app.card.steps import Step
from aff_runtime.app.card.typed_values import TypedValues
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.report.comparison.window import Window, load_window
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.machine import Machine, machine_name
from aff_runtime.base.runs.table import last_event_s
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.loader import load_recorded_site
from aff_runtime.config.models import Site
from aff_runtime.config.revision import SHORT
from aff_runtime.core.response import Response
from aff_runtime.telemetry.header import Right, RunMeta

AFTER_CHANGE_S = 0.5
"""From a change of settings to the first row that is looked at."""
MARGIN_S = 0.5
"""Newest time that is left out: the recorder may not have written its rows yet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sources:
    """What there is to gather from.

    Attributes
    ----------
    parameters : of the site file as it lies there now. ``checked`` : what the check says of it.
    answer : how the running service stands; None: none answers.
    windows : of records that were named; none: the newest of the running service.
    machine : this one. ``plc`` : version of the PLC's program, typed.
    tries : settings that were tried, for the search.
    """

    parameters: ParameterRecord
    checked: CheckedSite
    answer: StatusAnswer | None = None
    windows: tuple[RunWindow, ...] = ()
    machine: Machine | None = None
    plc: str = ""
    tries: tuple[Try, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Gathered:
    """What a step looks at, and what of it goes on the card beside the result."""

    evidence: Evidence
    windows: tuple[RecordWindow, ...]
    inputs: Inputs


def inputs_of(sources: Sources) -> Inputs:
    """Return what a measurement rests on now.

    Raises
    ------
    RefusedError
        The service runs on something else than the site file says.
    """
    parameters, answer = sources.parameters, sources.answer
    config_hash, roll_id = parameters.config_hash, ""
    if answer is not None:
        if answer.site_hash != parameters.site_hash:
            raise RefusedError(
                f"the service runs on other settings ({answer.site_hash[:SHORT]}) than the site "
                f"file says ({parameters.site_hash[:SHORT]}); see `aff-runtime status`"
            )
        if answer.trying:
            raise RefusedError("other settings are being tried; keep or undo them first")
        config_hash = answer.config_hash
        if answer.live is not None:
            roll_id = _whole(answer.live.tick.number("roll_id"))
    return Inputs(
        site_hash=parameters.site_hash,
        config_hash=config_hash,
        plc=sources.plc,
        roll_id=roll_id,
        responses={name: text_digest(text) for name, text in parameters.responses.items()},
        machine=machine_name(sources.machine) if sources.machine is not None else "",
        parts=parts_of(_as_written(parameters), parameters.wire_digests),
        shapes=learned_of(answer.learned if answer is not None else ())[1],
    )


def _as_written(parameters: ParameterRecord) -> Site:
    """Return the site without what a probe identified: that goes with the responses."""
    text = parameters.site_text
    return load_recorded_site(text, "site.yaml") if text else parameters.site


def gather(
    step: Step, sources: Sources, typed: TypedValues, former: tuple[Sample, ...]
) -> Gathered:
    """Return what a step looks at.

    Raises
    ------
    AffError
        A record cannot be read, or is of other settings; the service is needed and not there.
    """
    if Need.SERVICE in step.needs and Need.RECORD not in step.needs and sources.answer is None:
        raise RefusedError(f"no service answers; step {step.number} looks at {Need.SERVICE}")
    now = inputs_of(sources)
    wanted = list(wanted_windows(step, sources))
    windows = tuple(load_window(one) for one in wanted)
    ran = [in_force(one) for one in windows]
    if not sources.tries:  # of which each is another setting
        for one, settings in zip(windows, ran, strict=True):
            _check_settings(one, settings, sources)
    evidence = Evidence(
        checked=sources.checked,
        typed=typed,
        windows=windows,
        rights=_rights(sources, windows),
        machine=sources.machine if sources.answer is not None else None,
        state=sources.answer.state if sources.answer is not None else "",
        blocks=sources.answer.blocks if sources.answer is not None else (),
        responses={
            n: Response.from_json(text) for n, text in sources.parameters.responses.items()
        },
        probed_here=frozenset(_probed_here(sources)),
        tries=sources.tries,
        former=former,
    )
    typed.refuse_others(step.typed(evidence))
    return Gathered(
        evidence=evidence,
        windows=tuple(
            record_window(
                given,
                max(given.from_s, float(one.table.columns["time_s"][0])),
                min(given.to_s, float(one.table.columns["time_s"][-1])),
            )
            for given, one in zip(wanted, windows, strict=True)
        ),
        inputs=_as_recorded(now, windows[-1], ran[-1]) if sources.windows else now,
    )


def _as_recorded(now: Inputs, window: Window, ran: InForce) -> Inputs:
    """Return what a window that was named rests on: the roll and what was learned then.

    The roll and the responses of today are another record's.
    """
    rolls = window.table.columns.get("roll_id")
    names = sorted({*now.responses, *ran.responses})
    said = {name: _then(now.responses.get(name, ""), name, ran) for name in names}
    return replace(
        now,
        config_hash=ran.whole,
        roll_id=_whole(float(rolls[-1])) if rolls is not None else "",
        responses={name: digest for name, digest in said.items() if digest},
        shapes=ran.shapes,
        machine="",
    )


def _then(digest: str, name: str, ran: InForce) -> str:
    """Return the digest of a response then: today's whole one where the record's begins it."""
    if not ran.is_said:
        return UNKNOWN
    short = ran.responses.get(name, "")
    return digest if short and digest.startswith(short) else short


def _whole(number: float) -> str:
    return f"{number:.0f}" if math.isfinite(number) else ""


def wanted_windows(step: Step, sources: Sources) -> Iterator[RunWindow]:
    """Yield the windows that were named, else the newest rows of the service's record."""
    if Need.RECORD not in step.needs:
        if sources.windows:
            raise ConfigError(f"step {step.number} looks at no record; leave --run out")
        return
    if sources.windows:
        yield from sources.windows
        return
    answer = sources.answer
    if answer is None or answer.live is None or answer.recorder is None:
        raise RefusedError(
            "no service answers that records now; start it, or name a window of a record (on the "
            "console: --run RUN_DIR@FROM..TO)"
        )
    end_s = answer.live.tick.time_s - MARGIN_S
    folder = Path(answer.recorder.folder)
    from_s = max(0.0, end_s - step.seconds)
    if step.begins_anew:
        changed_s = last_event_s(folder, changes_settings)
        from_s = max(from_s, changed_s + AFTER_CHANGE_S if changed_s else 0.0)
    yield RunWindow(folder=folder, from_s=min(from_s, end_s), to_s=end_s)


def _check_settings(window: Window, ran: InForce, sources: Sources) -> None:
    """Refuse a window of other settings than the site file's."""
    wanted = sources.parameters.site_hash[:SHORT]
    if ran.site != wanted:
        since = f", in force from {ran.from_s:.0f} s on" if ran.is_said else ""
        raise RefusedError(
            f"{window.table.window}: recorded on other settings ({ran.site}{since}) than the "
            f"site file says now ({wanted})"
        )


def _rights(sources: Sources, windows: Sequence[Window]) -> tuple[Right, ...]:
    if sources.answer is not None and sources.answer.live is not None:
        return sources.answer.live.meta.rights
    try:
        said: Any = RunMeta.from_json(windows[-1].table.about.data).rights if windows else ()
    except (KeyError, TypeError, AttributeError, ValueError):
        return ()
    return tuple(one for one in said if isinstance(one.text, str))


def _probed_here(sources: Sources) -> Iterator[str]:
    """Yield actuators of whose response the service says that its own probe wrote it."""
    said = sources.answer.learned if sources.answer is not None else ()
    for name, text in sources.parameters.responses.items():
        beginning = f"{name}: response {text_digest(text)[:SHORT]} (probed here)"
        if any(sentence.startswith(beginning) for sentence in said):
            yield name
