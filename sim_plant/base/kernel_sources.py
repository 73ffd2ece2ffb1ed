"""Which files the compiled kernel is written in, and what is in them."""

from __future__ import annotations

import hashlib
from pathlib import Path

_ROOT = Path(__file__).parent.parent
_PATTERNS = ("base/arrays.py", "elements/*.py", "geometry/lookup.py", "line/equations/*.py")


def kernel_sources() -> list[Path]:
    """Return the files of the kernel, in a fixed order."""
    return [path for pattern in _PATTERNS for path in sorted(_ROOT.glob(pattern))]


def kernel_hash() -> str:
    """Return a hash of their text: a binary made from other text computes another line."""
    digest = hashlib.sha256()
    for path in kernel_sources():
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
