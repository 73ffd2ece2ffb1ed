"""The revision of a site: a hash of what it says, whatever way it is written."""

from __future__ import annotations

import hashlib
import json

from aff_runtime.config.findings import dotted
from aff_runtime.config.leaves import leaves
from aff_runtime.config.models import Site


def revision_hash(site: Site) -> str:
    """Return the sha256 of every value and its path, as 64 hex digits.

    Comments, layout, units as written and spelled-out defaults do not change it; the order of
    channels and actuators does, because words follow that order.
    """
    content = [[dotted(leaf.path), leaf.value] for leaf in leaves(site)]
    text = json.dumps(content, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return hashlib.sha256(text.encode("ascii")).hexdigest()
