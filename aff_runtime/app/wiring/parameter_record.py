"""The parameter record: what the check of a site file hands to the processes that run it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def for_control(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the control process needs of a parameter record: all but the file's text."""
    return {key: value for key, value in record.items() if key != "site_text"}
