"""A site as its single values, each with its path and its declaration."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from aff_runtime.base.units import plain
from aff_runtime.config.declared import Declared, by_attribute, declared_type
from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Site
from aff_runtime.config.quantity import Section, Unit


@dataclass(frozen=True, slots=True, kw_only=True)
class Leaf:
    """One value of a site; ``given`` is False when the file left it to its default."""

    path: KeyPath
    value: object
    declared: Declared
    given: bool

    @property
    def shown(self) -> str:
        """Return the value with its unit, as an operator reads it."""
        return shown(self.value, self.declared)


def leaves(site: Site) -> Iterator[Leaf]:
    """Yield every value of a site: keys in the order of the models, names as in the file."""
    yield from _of(site, declared_type("", Site, None), (), given=True)


def _of(value: object, declared: Declared, path: KeyPath, *, given: bool) -> Iterator[Leaf]:
    if isinstance(value, Section):
        for attribute, inner in by_attribute(type(value)).items():
            was_given = given and attribute in value.model_fields_set
            yield from _of(getattr(value, attribute), inner, (*path, inner.name), given=was_given)
        return
    item = declared.item if isinstance(value, Mapping | tuple) else None
    if isinstance(value, Mapping) and item is not None:
        for name, entry in value.items():
            yield from _of(entry, item, (*path, name), given=given)
    elif isinstance(value, tuple) and item is not None and item.section is not None:
        for index, entry in enumerate(value):
            yield from _of(entry, item, (*path, index), given=given)
    else:
        yield Leaf(path=path, value=value, declared=declared, given=given)


def shown(value: object, declared: Declared) -> str:
    """Return a value with its unit."""
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        inner = declared.item or declared
        return f"[{', '.join(shown(entry, inner) for entry in value)}]"
    if isinstance(value, float):
        unit = next((mark.symbol for mark in declared.metadata if isinstance(mark, Unit)), "")
        return f"{plain(value)} {unit}".strip()
    return str(value)
