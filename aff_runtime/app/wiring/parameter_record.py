"""The parameter record: what the check of a site file hands to the processes that run it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from aff_runtime.config.revision import learned_digests, revision_with


def for_control(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the control process needs of a parameter record: all but the file's text."""
    return {key: value for key, value in record.items() if key != "site_text"}


def with_shapes(record: Mapping[str, Any], shapes: Mapping[str, str]) -> dict[str, Any]:
    """Return a record whose revision holds the learned shapes that it is started with.

    Parameters
    ----------
    shapes : text of the shape file by actuator.
    """
    learned = learned_digests(record["responses"], shapes)
    revision = revision_with(record["site_hash"], learned)
    return {**record, "learned": learned, "config_hash": revision}
