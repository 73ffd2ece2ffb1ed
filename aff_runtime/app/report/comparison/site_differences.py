"""What differs between the site files that ran in two windows."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from aff_runtime.app.report.comparison.window import Window
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.files import yaml_values
from aff_runtime.config.diff import diff_sites
from aff_runtime.config.loader import load_recorded_site

SITE = "site.yaml"
MOST_LEAVES = 20_000
"""Values that are compared of a site file that this version cannot read."""
LONGEST_KEY = 60


def site_differences(before: Window, after: Window) -> tuple[list[str], list[str]]:
    """Return what differs in the site files, and labels about how they were compared.

    From what ran where the first window begins to what ran where the second one ends: an edit
    within one of them counts.
    """
    texts = (before.table.site_text, after.last_site_text)
    windows = zip((before, after), texts, strict=True)
    lack = [printable(str(one.table.window)) for one, text in windows if not text.strip()]
    if lack:
        said = [f"{name} has none: what differs is not known" for name in lack]
        return said, [f"{name} has no site file" for name in lack]
    if texts[0] == texts[1]:
        return [], []
    try:
        old, new = (load_recorded_site(text, SITE) for text in texts)
    except ConfigError:
        flat = [dict(itertools.islice(_leaves(_values(text), ""), MOST_LEAVES)) for text in texts]
        paths = dict.fromkeys([*flat[1], *flat[0]])
        return [
            f"{path}: {flat[0].get(path, '(absent)')} -> {flat[1].get(path, '(absent)')}"
            for path in paths
            if flat[0].get(path) != flat[1].get(path)
        ], ["a site file is of another version: its values are compared as they are written"]
    return [f"{c.path}: {c.old} -> {c.new}" for c in diff_sites(old, new)], []


def _values(text: str) -> object:
    try:
        return yaml_values(text)
    except ValueError:
        return {}


def _leaves(value: object, path: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            shown = printable(str(key), LONGEST_KEY)
            yield from _leaves(inner, f"{path}.{shown}" if path else shown)
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _leaves(inner, f"{path}[{index}]")
    elif path:  # a text that is one value has no key to tell it by
        yield path, printable(str(value), 200)
