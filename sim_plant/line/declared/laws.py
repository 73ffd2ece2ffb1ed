"""The words in which a declaration tells its laws, and what they mean; other words are refused.

A line file says its laws for those who read it. What the model does under them is its own: a word
that it does not know would be a law that it does not follow.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from sim_plant.line.declared.declaration import Declaration

PI = "gain*e + gain*corner*integral(e)"
LAWS = {-1.0: f"v_correction = -({PI})", 1.0: f"v_correction = +({PI})"}
"""Of a tension loop, by its sign."""
ERROR = "e = tension_ref - tension"
"""What may follow a law."""
TENSION_LAWS = (
    "T = EA*(strain + eta*dstrain/dt), never below 0",
    "T = EA*(strain - expansion*warming + eta*dstrain/dt), never below 0",
)
"""Both say the same of a web that nothing warms."""
DRAW = "*(1 + pull_roll_draw)"
REFERENCE = re.compile(
    r"line_speed_ref(\*\(1\+pull_roll_draw\))?(\+(tension|position|aff)correction)*"
)
"""Of a drive, without spaces; corrections come from the loops that name it, and from AFF."""
REFERENCES = (
    f"line_speed_ref, or line_speed_ref{DRAW}, and behind it + tension correction, "
    "+ position correction, + aff correction"
)


def draws(speed_reference: str) -> bool:
    """Return whether a drive of this reference runs at the draw."""
    return _close(DRAW) in _close(speed_reference)


def sign_of(line: Declaration, acts_on: str, load_cell: str, law: str) -> float:
    """Return the sign of a tension loop.

    A drive before its cell feeds it and runs slower for more tension, -1; one behind it takes web
    away, +1. Of a cell on the driven roller itself the law tells.
    """
    drive, cell = line.body(acts_on), line.body(load_cell)
    if drive != cell:
        return -1.0 if drive < cell else 1.0
    return -1.0 if _close(law).startswith(_close(LAWS[-1.0])) else 1.0


def laws_findings(line: Declaration) -> Iterator[str]:
    """Yield laws that the model does not follow; for a line whose names exist."""
    if _close(line.web.tension_law) not in map(_close, TENSION_LAWS):
        yield _refused("web.tension_law", line.web.tension_law, TENSION_LAWS)
    for drive in line.control.drives:
        if REFERENCE.fullmatch(_close(drive.speed_reference)) is None:
            where = f"control.drives.{drive.roller}.speed_reference"
            yield _refused(where, drive.speed_reference, (REFERENCES,))
    for loop in line.control.tension_pi:
        sign = sign_of(line, loop.acts_on, loop.load_cell, loop.law)
        known = tuple(LAWS.values()) if loop.acts_on == loop.load_cell else (LAWS[sign],)
        written = [text for law in known for text in (law, f"{law}, {ERROR}")]
        if _close(loop.law) not in map(_close, written):
            where = f"control.tension_pi.{loop.loop}.law"
            side = "before" if sign < 0.0 else "behind"
            order = f" ({loop.acts_on} is {side} its load cell {loop.load_cell})"
            said = _refused(where, loop.law, known)
            yield said if len(known) > 1 else said + order


def _refused(where: str, given: str, known: tuple[str, ...]) -> str:
    return f"{where}: read {given!r:.120}; expected {' or '.join(known)}"


def _close(text: str) -> str:
    """Return a law without spaces."""
    return "".join(text.split())
