"""Drawn text: every character that UTF-8 can carry, in a tenth of hypothesis' own time."""

from __future__ import annotations

from hypothesis import strategies as st

CHARACTERS = st.characters(exclude_categories=("Cs",))
"""All but surrogates, as of ``st.text()``, which tries a million characters by their codec first:
2.3 s of CPU in each worker of a fresh clone."""


def drawn_text(*, max_size: int | None = None) -> st.SearchStrategy[str]:
    """Return what ``st.text(max_size=...)`` does."""
    return st.text(CHARACTERS, max_size=max_size)
