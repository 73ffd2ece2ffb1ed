"""The one place where commands write to the terminal: what does not show as itself is escaped.

Names of site, DBC and EDS files, words of records and of the service's answers come through here.
None of them can end a line, move the cursor or turn the text round.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from aff_runtime.base.printable import printable

RED, PLAIN, HOME, CLEAR = "\x1b[31m", "\x1b[0m", "\x1b[H", "\x1b[J"


def say(line: object) -> None:
    """Print one line; a line break in it is shown, not made."""
    print(printable(str(line)), flush=True)


def complain(line: object) -> None:
    """Print one line of an error."""
    print(printable(str(line)), file=sys.stderr)


def ask(prompt: str) -> str:
    """Return the line that is typed after ``prompt``; EOFError at ctrl-d."""
    return input(f"{printable(prompt)} ")


def say_json(answer: Mapping[str, Any]) -> None:
    """Print an answer for scripts: all ASCII."""
    print(json.dumps(answer, indent=1).replace("\x7f", "\\u007f"))


def redraw(rows: Sequence[str], *, first_red: bool) -> None:
    """Draw a screen over the one before."""
    shown = [printable(row) for row in rows]
    if first_red:
        shown[0] = f"{RED}{shown[0]}{PLAIN}"
    print(HOME + "\x1b[K\n".join(shown) + CLEAR, end="", flush=True)
