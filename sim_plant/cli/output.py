"""Words on their way to the terminal: foreign characters in them do nothing there."""

from __future__ import annotations

import sys

from aff_runtime.base.printable import printable


def say(text: str, *, error: bool = False) -> None:
    """Print a text of one or several lines at once; what does not print is escaped."""
    lines = (printable(line) for line in text.split("\n"))
    print("\n".join(lines), file=sys.stderr if error else sys.stdout, flush=True)
