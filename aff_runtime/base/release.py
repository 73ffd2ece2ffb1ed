"""Which commit this code is of: what ``git archive`` wrote here, and so every released archive."""

from __future__ import annotations

from aff_runtime import __version__

COMMIT = "$Format:%H$"
"""40 hex digits in what was made by ``git archive``; the placeholder in a checkout."""

NOT_RECORDED = "not recorded"


def commit(written: str = COMMIT) -> str:
    """Return the commit of this code; ``not recorded`` in a checkout, where files may differ."""
    return NOT_RECORDED if written.startswith("$") else written


def release_text(written: str = COMMIT) -> str:
    """Return version and commit for people."""
    return f"{__version__} (commit {commit(written)})"
