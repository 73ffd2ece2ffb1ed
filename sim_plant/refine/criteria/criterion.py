"""A criterion: a number that decides, as a field of a frozen dataclass that holds its reason."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from types import MappingProxyType
from typing import Any

NOT_RECORDED = "not recorded"
"""Origin of a number that nobody wrote down when it was set."""
DEVELOPMENT = "not recorded by itself; the search was set on campaign seeds 1 to 9 and data/lines"
"""Origin of a number that was set together with the whole search."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reason:
    """One criterion as a row of the table.

    Attributes
    ----------
    name : sections and field: ``search.acceptance.periodic_score``.
    value : the number, or the numbers.
    unit : SI, ``chi2`` for a fall of the weighted squared error, ``1`` for a share or a count.
    meaning : what it decides; some go on from ``unit`` ("24 taps", "of the filter that ...").
    origin : data, theory or decision it was set on.
    """

    name: str
    value: object
    unit: str
    meaning: str
    origin: str


def criterion(value: Any, unit: str, meaning: str, origin: str) -> Any:
    """Return a dataclass field with this default and its reason."""
    reason = {"unit": unit, "meaning": meaning, "origin": origin}
    if isinstance(value, Mapping):
        return field(default_factory=lambda: MappingProxyType(dict(value)), metadata=reason)
    return field(default=value, metadata=reason)


def reasons(criteria: Any, section: str = "") -> Iterator[Reason]:
    """Yield every criterion of a frozen dataclass of criteria, sections within it included."""
    for each in fields(criteria):
        value, name = getattr(criteria, each.name), f"{section}{each.name}"
        if is_dataclass(value):
            yield from reasons(value, f"{name}.")
        else:
            yield Reason(name=name, value=value, **each.metadata)
