"""What an edit of the site file changes, key by key, and which of it must wait."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One key that an edit changes: ``actuators.unwind.blocks[0].settle_s: 6 -> 9``."""

    path: str
    before: Any
    after: Any

    def __str__(self) -> str:
        """Return the change as the log shows it."""
        return f"{self.path}: {_shown(self.before)} -> {_shown(self.after)}"


def changes(before: Any, after: Any, path: str = "") -> Iterator[Change]:
    """Yield the changed leaves between two plain parameter records."""
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        for name in [*before, *(k for k in after if k not in before)]:
            below = f"{path}.{name}" if path else str(name)
            yield from changes(before.get(name), after.get(name), below)
    elif _is_table(before) and _is_table(after) and len(before) == len(after):
        for i, (old, new) in enumerate(zip(before, after, strict=True)):
            yield from changes(old, new, f"{path}[{i}]")
    elif before != after:
        yield Change(path=path, before=before, after=after)


def _is_table(value: Any) -> bool:
    """Return whether ``value`` is a list of sections rather than of numbers."""
    return isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)


def _shown(value: Any) -> str:
    """Return a value as short text."""
    text = "(absent)" if value is None else str(value)
    return text if len(text) <= 80 else text[:77] + "..."
