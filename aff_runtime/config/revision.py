"""The revision: a hash of what a site says (its site hash) and of what was learned for it.

The site hash is for writing down. What runs is that and the learned files: a response
or a DBC file that is exchanged changes sign and phase of the loop as much as a key of the site
file does.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping

from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.findings import dotted
from aff_runtime.config.leaves import leaves
from aff_runtime.config.models import Site

SHORT = 12


def site_hash_of(site: Site) -> str:
    """Return the sha256 of every value and its path, as 64 hex digits.

    Comments, layout, units as written and spelled-out defaults do not change it; the order of
    channels and actuators does, because words follow that order.
    """
    content = [[dotted(leaf.path), leaf.value] for leaf in leaves(site)]
    text = json.dumps(content, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def learned_digests(
    responses: Mapping[str, str], shapes: Mapping[str, str]
) -> dict[str, dict[str, str]]:
    """Return the digests of learned files by actuator and kind, from their texts by actuator."""
    return {
        name: {
            kind: text_digest(texts[name])
            for kind, texts in (("response", responses), ("shape", shapes))
            if name in texts
        }
        for name in sorted({*responses, *shapes})
    }


def revision_with(
    site_hash: str, learned: Mapping[str, Mapping[str, str]], wire: Mapping[str, str] | None = None
) -> str:
    """Return the hash of a site, its learned files and its wire's; without any, the site's own.

    Parameters
    ----------
    site_hash : ``site_hash_of`` of the site.
    learned : as ``learned_digests`` returns it.
    wire : digests of the DBC or EDS files by name: where each value lies, its scale and sign.
    """
    if not learned and not wire:
        return site_hash
    parts = [site_hash, learned, wire] if wire else [site_hash, learned]
    text = json.dumps(parts, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode("ascii")).hexdigest()
