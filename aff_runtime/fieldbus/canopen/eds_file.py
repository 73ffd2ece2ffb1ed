"""An EDS file's text to an object dictionary; what is wrong with it in plain words, by line."""

from __future__ import annotations

import configparser
import io
import re

import canopen
from canopen.objectdictionary import ObjectDictionary

from aff_runtime.fieldbus.signal_names import WireFileError

MOST_ODD_LINES = 100  # a text that goes on over lines has some; no EDS has many


def load_eds(text: str, where: str, node_id: int) -> ObjectDictionary:
    """Return the object dictionary of an EDS file's text; ``where``: its name in the site file.

    Raises
    ------
    ConfigError
        The text cannot be read as EDS.
    """
    _check_lines(text, where)
    stream = io.StringIO(text)
    stream.name = "text.eds"  # canopen tells the format by the ending; no message shows it
    try:
        return canopen.import_od(stream, node_id)
    except (configparser.Error, ValueError, KeyError, TypeError, AttributeError) as error:
        line, said = _why(error, text)
        raise WireFileError(where, f"cannot be read as EDS: {said}", line) from error


def _check_lines(text: str, where: str) -> None:
    """Refuse a text that is no EDS at all: the reader collects every line that it cannot place.

    What a section counts, entries or lines, needs no bound of its own: the reader ends at the
    first one that is not there, and the file's size is bounded.
    """
    odd = 0
    first = 0
    for number, line in enumerate(text.splitlines(), 1):
        said = line.strip()
        is_section = said.startswith("[") and "]" in said
        if not said or said[0] in ";#" or is_section or re.match("[^=:]+[=:]", said):
            continue
        odd += 1
        first = first or number
        if odd > MOST_ODD_LINES:
            said = "this line is neither [section] nor key=value, nor are many that follow"
            raise WireFileError(where, f"cannot be read as EDS: {said}", first)


def _why(error: Exception, text: str) -> tuple[int, str]:
    """Return the line of an error (0: not known) and what it means, in one line of plain text."""
    if isinstance(error, configparser.Error):
        return _why_not_parsed(error, text)
    said = " ".join(str(error).split())
    if not isinstance(error, ValueError):
        return 0, f"it contradicts itself ({said})"
    value = re.search(r"'([^']+)'$", said)
    if value is None:
        return 0, said
    line = _line_of(rf"[^=]+=\s*{re.escape(value[1])}\s*(;.*)?$", text)
    return line, f"{value[1]!r} is no number"


def _why_not_parsed(error: configparser.Error, text: str) -> tuple[int, str]:
    match error:
        case configparser.MissingSectionHeaderError():
            said = "this line stands before the first [section]; an EDS begins with one"
            return error.lineno, said
        case configparser.ParsingError():
            line = error.errors[0][0] if error.errors else 0
            return line, "this line is neither [section] nor key=value"
        case configparser.DuplicateSectionError():
            return error.lineno or 0, f"section [{error.section}] comes a second time"
        case configparser.DuplicateOptionError():
            said = f"{error.option} comes a second time in section [{error.section}]"
            return error.lineno or 0, said
        case configparser.NoOptionError():
            line = _line_of(rf"\[{re.escape(error.section)}\]", text)
            return line, f"section [{error.section}] has no {error.option}"
    return 0, " ".join(str(error).split())


def _line_of(pattern: str, text: str) -> int:
    """Return the first line that begins with ``pattern``, 0 without one."""
    for number, line in enumerate(text.splitlines(), 1):
        if re.match(pattern, line.strip()):
            return number
    return 0
