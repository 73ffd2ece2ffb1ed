"""The files that name the signals of a bus: where they may lie, and what they name."""

from __future__ import annotations

import re
from pathlib import Path

from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.questions import NONE, AnswerError, read_text
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.printable import printable
from aff_runtime.config.can_wire import wire_text
from aff_runtime.fieldbus.can.named_signal import NamedSignal
from aff_runtime.fieldbus.signal_names import WireFileError

MOST_NODES = 16
NODE = "node"
"""Answers ``node.1``, ``.2``: a CANopen node each, as ``NAME ID EDS``."""
_NODE = re.compile(r"(?P<name>[a-z][A-Za-z0-9_]{0,39})\s+(?P<id>\d{1,3})(\s+(?P<eds>\S.*))?")


def read_file(folder: Path, text: str) -> str:
    """Return the name of a file as the site file will write it: below the site file's folder.

    Raises
    ------
    AnswerError
        There is no such file, or it lies elsewhere.
    """
    shown = read_text(text)
    here, root = Path(shown).expanduser(), folder.resolve()
    place = next((one for one in (folder / here, here) if one.is_file()), None)
    if place is None:
        raise AnswerError(f'"{printable(shown, 80)}": there is no such file in {folder}.')
    real = place.resolve()
    if not real.is_relative_to(root):
        raise AnswerError(
            f"{printable(str(real), 120)} is not below {folder}, where the site file will be. "
            "Copy it there."
        )
    return str(real.relative_to(root))


def read_node(folder: Path, files: tuple[str, ...], text: str) -> str:
    """Return a CANopen node as it is kept: ``NAME ID EDS``, or ``none``.

    Parameters
    ----------
    files : EDS files that were given; one alone need not be typed.
    """
    if text.strip() == NONE:
        return NONE
    match = _NODE.fullmatch(text.strip())
    if match is None or not 1 <= int(match["id"]) <= 127:
        raise AnswerError(
            f'"{printable(text, 60)}": write name, node id (1 to 127) and EDS file, such as '
            "unwind_drive 3 drive.eds; none ends."
        )
    if match["eds"] is None and len(files) != 1:
        raise AnswerError(f"{match['name']}: which EDS file? Write it behind the node id.")
    eds = read_file(folder, match["eds"] or files[0])
    return f"{match['name']} {int(match['id'])} {eds}"


def split_node(kept: str) -> tuple[str, int, str]:
    """Return name, node id and EDS file of a kept node."""
    name, number, eds = kept.split(maxsplit=2)
    return name, int(number), eds


def nodes_of(draft: Draft) -> dict[str, tuple[int, str]]:
    """Return node id and EDS file by the name of the node."""
    found: dict[str, tuple[int, str]] = {}
    for number in range(1, MOST_NODES + 1):
        kept = draft.answers.get(f"{NODE}.{number}", NONE)
        if kept == NONE:
            break
        name, node_id, eds = split_node(kept)
        found[name] = (node_id, eds)
    return found


def signals_of(draft: Draft, folder: Path) -> tuple[NamedSignal, ...]:
    """Return every signal that the draft's files name.

    Raises
    ------
    ConfigError
        A file cannot be read, or the extra for CAN is not installed.
    """
    try:
        return _signals(draft, folder)
    except ImportError as error:
        raise ConfigError(
            f"CAN needs the extra: pip install 'aff-runtime[can]' ({error})"
        ) from None
    except WireFileError as error:
        raise ConfigError(error.in_folder(folder)) from None


def _signals(draft: Draft, folder: Path) -> tuple[NamedSignal, ...]:
    if draft.answers["wire"] == "can_dbc":
        from aff_runtime.fieldbus.can.dbc import dbc_signals, load_dbc  # noqa: PLC0415 (extra)

        name = draft.answers["dbc"]
        return dbc_signals(load_dbc(wire_text(folder, name), name))
    from aff_runtime.fieldbus.canopen.device_402 import mapped_signals  # noqa: PLC0415 (extra)
    from aff_runtime.fieldbus.canopen.eds_file import load_eds  # noqa: PLC0415 (extra)

    found: tuple[NamedSignal, ...] = ()
    for node, (node_id, eds) in nodes_of(draft).items():
        found += mapped_signals(load_eds(wire_text(folder, eds), eds, node_id), node)
    return found
