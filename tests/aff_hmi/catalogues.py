"""``python -m tests.aff_hmi.catalogues`` compiles the catalogues of the screen after an edit."""

from __future__ import annotations

import io
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.mofile import read_mo, write_mo
from babel.messages.pofile import read_po

LOCALE = Path(__file__).parents[2] / "aff_hmi" / "locale"


def sources() -> list[Path]:
    """Return the catalogue of every language."""
    return sorted(LOCALE.glob("*/LC_MESSAGES/*.po"))


def catalogue(path: Path) -> Catalog:
    """Return the words of a catalogue."""
    with path.open("rb") as file:
        return read_po(file)


def compiled(path: Path) -> bytes:
    """Return what gettext reads."""
    found = io.BytesIO()
    write_mo(found, catalogue(path))
    return found.getvalue()


def sentences(mo: bytes) -> dict[object, object]:
    """Return what a compiled catalogue says, without its head: that names the compiler."""
    return {message.id: message.string for message in read_mo(io.BytesIO(mo)) if message.id}


if __name__ == "__main__":
    for source in sources():
        source.with_suffix(".mo").write_bytes(compiled(source))
