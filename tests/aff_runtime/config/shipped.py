"""The shipped site file, and edits of it."""

import shutil
from pathlib import Path

ROOT = Path(__file__).parents[3]
EUCLID = ROOT / "config" / "euclid_blocks.yaml"


def copied(to):
    """Copy every shipped site file and wire file into a folder and return the folder."""
    for pattern in ("*.yaml", "*.dbc", "*.eds"):
        for path in EUCLID.parent.glob(pattern):
            shutil.copy(path, to)
    return to


def edited(tmp_path, *edits, count=1):
    """Write euclid.yaml with (old, new) edits and return its path; each old stands there once."""
    text = EUCLID.read_text(encoding="utf-8")
    for old, new in edits:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, count)
    path = tmp_path / "site.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def without_applied(text):
    """Return a shipped site as it was before the PLC showed what it applies."""
    lines = text.splitlines(keepends=True)
    begin = lines.index("    applied:\n")
    return "".join(lines[:begin] + lines[begin + 3 :])


def place(path, needle, offset=0):
    """Return ``line:column`` of the first ``needle`` in a file, counted independently."""
    for number, line in enumerate(path.read_text(encoding="utf-8").split("\n"), start=1):
        if needle in line:
            return f"{number}:{line.index(needle) + 1 + offset}"
    raise AssertionError(needle)
