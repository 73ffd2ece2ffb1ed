"""One disagreement between keys, before it knows its line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from aff_runtime.config.findings import KeyPath


@dataclass(frozen=True, slots=True, kw_only=True)
class Issue:
    """What is wrong at a path; a warning does not refuse the file."""

    path: KeyPath
    text: str
    warning: bool = False
    at_key: bool = False
