"""The digest by which people and programs compare texts of files."""

from __future__ import annotations

import hashlib


def text_digest(text: str) -> str:
    """Return the sha256 of a file's text, as ``sha256sum`` prints it for the file itself."""
    return hashlib.sha256(text.encode("utf-8")).hexdigest()
