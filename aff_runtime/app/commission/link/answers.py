"""What the commissioner answers, in frozen dataclasses; ``encode``, ``decode`` know its JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, TypeAlias

from pydantic import TypeAdapter

from aff_runtime.app.commission.link.messages import PROTOCOL, Refusal
from aff_runtime.app.commission.views.of_line import (
    CardView,
    JobView,
    LastJob,
    LineView,
    NoService,
    ServiceView,
    SiteView,
)
from aff_runtime.app.commission.views.of_refining import RefinedView, RefiningView
from aff_runtime.app.commission.views.of_settings import (
    DifferenceView,
    SettingsView,
    TextView,
    VersionView,
)
from aff_runtime.app.commission.views.of_weeks import MaintenanceView


class AnswerError(ValueError):
    """What was said is no answer of this release."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """It is done, or begun; ``text`` says what became of it where there is more to say."""

    text: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Opened:
    """Somebody commissions from now on; ``key`` is what his screen says with every request."""

    key: str


@dataclass(frozen=True, slots=True, kw_only=True)
class CardShown:
    """The card as it stands."""

    card: CardView


@dataclass(frozen=True, slots=True, kw_only=True)
class LineShown:
    """What is known of the line."""

    line: LineView


@dataclass(frozen=True, slots=True, kw_only=True)
class Printed:
    """The card as a page that prints."""

    html: str


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """How commissioning stands.

    Attributes
    ----------
    by : account of who commissions; empty when nobody does. ``card`` : whether one is begun.
    job : None while none is under way. ``last`` : None before the first has ended.
    long, long_last : ``job`` and ``last`` of the jobs that take minutes to hours (``LONG``): one
        of them may run beside a short one.
    """

    protocol: int = PROTOCOL
    by: str
    site: SiteView
    service: NoService | ServiceView
    card: bool
    job: JobView | None
    last: LastJob | None
    long: JobView | None = None
    long_last: LastJob | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RefiningShown:
    """What can be refined, and what was."""

    refining: RefiningView


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinedShown:
    """One refinement."""

    refined: RefinedView


@dataclass(frozen=True, slots=True, kw_only=True)
class MaintenanceShown:
    """The line over weeks."""

    maintenance: MaintenanceView


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsShown:
    """The site file as a form, and its versions."""

    settings: SettingsView


@dataclass(frozen=True, slots=True, kw_only=True)
class DifferenceShown:
    """What an edit would do."""

    difference: DifferenceView


@dataclass(frozen=True, slots=True, kw_only=True)
class TextShown:
    """The site file as a text, with what is edited in it."""

    edited: TextView


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionShown:
    """One version of the settings."""

    version: VersionView


Good: TypeAlias = (
    Done
    | Opened
    | CardShown
    | LineShown
    | Printed
    | State
    | RefiningShown
    | RefinedShown
    | MaintenanceShown
    | SettingsShown
    | DifferenceShown
    | TextShown
    | VersionShown
)
Answer: TypeAlias = Good | Refusal
# what a request is answered with where it is not refused; the others with `Done`
_ANSWER_TYPES: Mapping[str, TypeAdapter[Any]] = {
    "state": TypeAdapter(State),
    "card": TypeAdapter(CardShown),
    "line": TypeAdapter(LineShown),
    "page": TypeAdapter(Printed),
    "open": TypeAdapter(Opened),
    "refining": TypeAdapter(RefiningShown),
    "refined": TypeAdapter(RefinedShown),
    "refined_page": TypeAdapter(Printed),
    "maintenance": TypeAdapter(MaintenanceShown),
    "settings": TypeAdapter(SettingsShown),
    "settings_diff": TypeAdapter(DifferenceShown),
    "settings_text": TypeAdapter(TextShown),
    "settings_version": TypeAdapter(VersionShown),
}
_DONE, _REFUSED = TypeAdapter(Done), TypeAdapter(Refusal)


def encode(answer: Answer) -> bytes:
    """Return an answer as one line of JSON."""
    return json.dumps(to_plain(answer)).encode()


def decode(do: str, line: bytes) -> Answer:
    """Return the answer to a request.

    Raises
    ------
    AnswerError
        When it is none of this release.
    """
    try:
        return from_plain(do, json.loads(line))
    except (ValueError, RecursionError) as error:
        raise AnswerError(f"no answer of this release: {line[:80]!r}") from error


def to_plain(answer: Answer) -> dict[str, Any]:
    """Return an answer as plain values, for a JSON object."""
    said = asdict(answer)
    if said.get("text") == "":
        del said["text"]
    return {"ok": not isinstance(answer, Refusal), **said}


def from_plain(do: str, said: object) -> Answer:
    """Read ``to_plain``'s values back; the end of a job has no ``ok``, and is not refused.

    Raises
    ------
    ValueError
        When they are no answer to a request ``do``.
    """
    is_refused = isinstance(said, dict) and said.get("ok", True) is not True
    answer: Answer = (_REFUSED if is_refused else _ANSWER_TYPES.get(do, _DONE)).validate_python(
        said
    )
    return answer
