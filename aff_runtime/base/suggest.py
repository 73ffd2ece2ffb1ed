"""Did you mean: the known word nearest to a misspelt one."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the known word most like ``word``, None when nothing is near."""
    folded = {name.casefold(): name for name in known}
    found = difflib.get_close_matches(word.casefold(), folded, n=1, cutoff=0.6)
    return folded[found[0]] if found else None


def meant(word: str, known: Iterable[str]) -> str:
    """Return ``Did you mean x?``, or the list of what is known."""
    names = list(known)
    near = nearest(word, names)
    if near is not None:
        return f"Did you mean {near}?"
    return f"Known here: {', '.join(names)}." if names else "None is declared."


def hint(word: str, known: Iterable[str]) -> str:
    """Return ``; did you mean 'x'?`` for the end of a sentence, empty when nothing is near."""
    near = nearest(word, known)
    return f"; did you mean {near!r}?" if near is not None else ""
