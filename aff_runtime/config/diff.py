"""What differs between two sites, and whether it may change while a correction is active."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from aff_runtime.config.findings import KeyPath, dotted
from aff_runtime.config.leaves import Leaf, leaves
from aff_runtime.config.models import Site

ABSENT = "(absent)"


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One value that differs; ``old`` and ``new`` carry their units."""

    path: str
    old: str
    new: str
    may_change_while_active: bool

    def __str__(self) -> str:
        """Return one line for the operator."""
        when = "applies at once" if self.may_change_while_active else "waits for bypass"
        return f"{self.path}: {self.old} -> {self.new} ({when})"


def diff_sites(old: Site, new: Site) -> tuple[Change, ...]:
    """Return every difference, in the order of the new file; keys that went away come last.

    A whole block or roll that is added or removed may change while active: what is new begins at
    zero, what goes fades out first, and what else was learned stays.
    """
    before, after = _by_path(old), _by_path(new)
    changes = []
    for path, leaf in after.items():
        previous = before.get(path)
        if previous is None:
            if leaf.value is None:
                continue  # of a new part, and not given: nothing is none before and after
            live = _part(leaf.path) not in _parts(before)
            changes.append(_change(path, ABSENT, leaf.shown, live=live))
        elif previous.value != leaf.value:
            changes.append(_change(path, previous.shown, leaf.shown, live=leaf.declared.live))
    for path, leaf in before.items():
        if path not in after and leaf.value is not None:
            live = _part(leaf.path) not in _parts(after)
            changes.append(_change(path, leaf.shown, ABSENT, live=live))
    return (*changes, *_orders(old, new))


def may_apply_while_active(changes: tuple[Change, ...]) -> bool:
    """Return whether every change may go in while a correction is active."""
    return all(change.may_change_while_active for change in changes)


def _part(path: KeyPath) -> KeyPath:
    """Return the roll or block that a key belongs to; the site itself when it is of neither."""
    if path[0] == "rolls":
        return path[:2]
    return path[:4] if path[0] == "actuators" and path[2:3] == ("blocks",) else ()


def _parts(found: Mapping[str, Leaf]) -> frozenset[KeyPath]:
    """Return the rolls and blocks that there are, and the site."""
    return frozenset({(), *(_part(leaf.path) for leaf in found.values())})


def _by_path(site: Site) -> dict[str, Leaf]:
    return {dotted(leaf.path): leaf for leaf in leaves(site)}


def _change(path: str, old: str, new: str, *, live: bool) -> Change:
    return Change(path=path, old=old, new=new, may_change_while_active=live)


def _orders(old: Site, new: Site) -> list[Change]:
    tables = (
        ("gateway.read.channels", old.gateway.read.channels, new.gateway.read.channels),
        ("rolls", old.rolls, new.rolls),
        ("actuators", old.actuators, new.actuators),
    )
    return [
        _change(f"{path} (order)", ", ".join(before), ", ".join(after), live=False)
        for path, before, after in tables
        if set(before) == set(after) and tuple(before) != tuple(after)
    ]
