"""What the service says about settings: how a try stands, what would change, what there was."""

from __future__ import annotations

import base64
from dataclasses import asdict, dataclass, fields
from typing import Any

RIPPLE_OF = "ripple of"
"""How the reason begins for which a try is taken back because ripple rose."""
SAVED_MEANWHILE = "somebody has saved other settings since you looked; look again"
UNDONE_BY = "undone by "
"""How the reason begins for which a try is taken back because somebody wants it."""
RETURNED = "returned"
"""Verb of the version that runs again after a try."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Version:
    """One row of the history.

    Attributes
    ----------
    number : from 1 on.
    when : UTC. ``who`` : the caller as the kernel names it, or the owner of an edited file.
    verb : ``started``, ``edited``, ``tried``, ``returned``, ``kept`` or ``undone``.
    why : the caller's reason, or the service's.
    sha256 : of the text of the site file.
    run : run folder of that time; empty when there was none.
    """

    number: int
    when: str
    who: str
    verb: str
    why: str
    sha256: str
    run: str = ""

    @classmethod
    def from_json(cls, said: Any) -> Version:
        """Read plain values; what is unknown is left out.

        Raises
        ------
        KeyError, TypeError, AttributeError, ValueError
            When they are no version.
        """
        row = {one.name: str(said.get(one.name, "")) for one in fields(cls)}
        return cls(**{**row, "number": int(said["number"])})  # type: ignore[arg-type]

    @property
    def ended_by_itself(self) -> bool:
        """Whether it runs again because a try ended without anybody undoing it."""
        return self.verb == RETURNED and not self.why.startswith(UNDONE_BY)

    @property
    def ripple_rose(self) -> bool:
        """Whether it runs again because ripple rose under what was tried."""
        return self.verb == RETURNED and self.why.startswith(f"{RIPPLE_OF} ")


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsAnswer:
    """The answer to a request about settings; what does not belong to it is empty.

    Attributes
    ----------
    site : path of the site file.
    running : sha256 of the text that runs.
    trying : which settings are tried, and by whom; empty without a try.
    waiting : sha256 of a saved text that is taken at the next bypass; empty where none waits.
    changes : lines of a diff. ``remarks`` : warnings of the check.
    text : to be saved as the site file, or of a version.
    replaces : sha256 of the site file that ``text`` is to replace.
    versions : the history, oldest first.
    """

    site: str = ""
    running: str = ""
    trying: str = ""
    waiting: str = ""
    changes: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    text: str = ""
    replaces: str = ""
    versions: tuple[Version, ...] = ()

    def to_json(self) -> Any:
        """Return plain values for JSON; the text in base64, as a client escapes line ends."""
        text = base64.b64encode(self.text.encode("utf-8")).decode("ascii")
        return {"ok": True, **asdict(self), "text": text}

    @classmethod
    def from_json(cls, said: Any) -> SettingsAnswer:
        """Read ``to_json``'s values back.

        Raises
        ------
        ValueError
            When ``text`` is not UTF-8 in base64, or a version is none.
        """
        return cls(
            site=said.get("site", ""),
            running=said.get("running", ""),
            trying=said.get("trying", ""),
            waiting=said.get("waiting", ""),
            changes=tuple(said.get("changes", ())),
            remarks=tuple(said.get("remarks", ())),
            text=base64.b64decode(said.get("text", ""), validate=True).decode("utf-8"),
            replaces=said.get("replaces", ""),
            versions=tuple(Version.from_json(row) for row in said.get("versions", ())),
        )
