"""What the models say about a key: its unit, bounds, choices and sentence, found by path."""

from __future__ import annotations

import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import annotated_types
from pydantic.fields import FieldInfo

from aff_runtime.base.units import plain
from aff_runtime.config.findings import KeyPath
from aff_runtime.config.quantity import Section, Unit, Whole


@dataclass(frozen=True, slots=True, kw_only=True)
class Declared:
    """One declared key; ``leaf`` is the type without Optional and Annotated."""

    name: str
    leaf: Any
    metadata: tuple[Any, ...]
    info: FieldInfo | None

    @property
    def description(self) -> str:
        """Return the sentence for the technician."""
        return (self.info.description if self.info is not None else None) or ""

    @property
    def unit(self) -> str | None:
        """Return the unit of a number, None for what is no number."""
        for mark in self.metadata:
            if isinstance(mark, Unit | Whole):
                return mark.symbol
        return None

    @property
    def live(self) -> bool:
        """Return whether it may change while a correction is active."""
        extra = self.info.json_schema_extra if self.info is not None else None
        return isinstance(extra, dict) and extra.get("x-live") is True

    @property
    def choices(self) -> tuple[str, ...]:
        """Return the words a Literal takes."""
        if get_origin(self.leaf) is Literal:
            return tuple(str(choice) for choice in get_args(self.leaf))
        return ()

    @property
    def section(self) -> type[Section] | None:
        """Return the model behind this key, when it is a section."""
        return (
            self.leaf if isinstance(self.leaf, type) and issubclass(self.leaf, Section) else None
        )

    @property
    def item(self) -> Declared | None:
        """Return what stands under each name of a table, or in each place of a list."""
        if get_origin(self.leaf) is tuple:
            return declared_type(self.name, get_args(self.leaf)[0], None)
        if isinstance(self.leaf_origin, type) and issubclass(self.leaf_origin, Mapping):
            return declared_type(self.name, get_args(self.leaf)[1], None)
        return None

    @property
    def leaf_origin(self) -> Any:
        """Return the generic type of the leaf, such as ``Mapping`` or ``tuple``."""
        return get_origin(self.leaf)

    @property
    def is_table(self) -> bool:
        """Return whether names below this key are free."""
        return self.item is not None and self.leaf_origin is not tuple

    def allowed(self) -> str:
        """Return the allowed range as text, such as ``1 to 300 s`` or ``above 0, up to 1``."""
        low = high = ""
        for mark in self.metadata:
            match mark:
                case annotated_types.Ge(ge=bound):
                    low = f"{plain(float(bound))} to"  # type: ignore[arg-type]
                case annotated_types.Gt(gt=bound):
                    low = f"above {plain(float(bound))}, up to"  # type: ignore[arg-type]
                case annotated_types.Le(le=bound):
                    high = plain(float(bound))  # type: ignore[arg-type]
                case annotated_types.Lt(lt=bound):
                    high = f"below {plain(float(bound))}"  # type: ignore[arg-type]
        unit = self.unit if any(isinstance(mark, Unit) for mark in self.metadata) else ""
        return f"{low} {high} {unit}".strip()


def declared_type(name: str, annotation: Any, info: FieldInfo | None) -> Declared:
    """Return what an annotation says, unwrapped."""
    metadata: list[Any] = list(info.metadata) if info is not None else []
    leaf = annotation
    while True:
        if get_origin(leaf) is Annotated:
            leaf, *marks = get_args(leaf)
            for mark in marks:
                metadata.extend(mark.metadata if isinstance(mark, FieldInfo) else [mark])
        elif get_origin(leaf) in (Union, types.UnionType):
            leaf = next(part for part in get_args(leaf) if part is not type(None))
        else:
            return Declared(name=name, leaf=leaf, metadata=tuple(metadata), info=info)


def keys_of(section: type[Section]) -> dict[str, Declared]:
    """Return the keys of a section as they stand in the file."""
    return {declared.name: declared for declared in by_attribute(section).values()}


@cache
def by_attribute(section: type[Section]) -> Mapping[str, Declared]:
    """Return the keys of a section by the attributes that hold them."""
    return MappingProxyType(
        {
            attribute: declared_type(info.alias or attribute, info.annotation, info)
            for attribute, info in section.model_fields.items()
        }
    )


def declared_at(root: type[Section], path: KeyPath) -> Declared | None:
    """Return what is declared at a path of the file, None when nothing is."""
    current: Declared | None = declared_type("", root, None)
    for part in path:
        if current is None:
            return None
        if current.section is not None:
            current = keys_of(current.section).get(str(part))
        else:
            current = current.item
    return current


def walk(root: type[Section], prefix: str = "") -> Iterator[tuple[str, Declared]]:
    """Yield every key with its dotted path; ``<name>`` and ``[]`` stand for free parts."""
    for name, declared in keys_of(root).items():
        path = f"{prefix}.{name}" if prefix else name
        yield path, declared
        inner, item = declared.section, declared.item
        if item is not None:
            path += ".<name>" if declared.is_table else "[]"
            inner = item.section
        if inner is not None:
            yield from walk(inner, path)
