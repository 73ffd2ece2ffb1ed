"""A section of a YAML file, read without a schema: what is missing or no section is empty."""

from __future__ import annotations

from collections.abc import ItemsView, Iterator
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Section:
    """Values by their keys, of a file whose schema may be another release's.

    Attributes
    ----------
    data : as YAML has them.
    """

    data: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, given: object) -> Section:
        """Return ``given`` as a section, an empty one where it is none."""
        return cls(given) if isinstance(given, dict) else cls()

    def __bool__(self) -> bool:
        return bool(self.data)

    def get(self, name: str) -> object:
        """Return a value, None where there is none."""
        return self.data.get(name)

    def section(self, name: str) -> Section:
        """Return a section within this one, empty where it is none."""
        return Section.of(self.data.get(name))

    def items(self) -> ItemsView[str, object]:
        """Return names and values."""
        return self.data.items()

    def sections(self) -> Iterator[Section]:
        """Yield the values that are sections."""
        return (Section(value) for value in self.data.values() if isinstance(value, dict))
