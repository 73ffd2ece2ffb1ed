"""Which learned responses a probe of this service wrote: their digests, kept beside them.

A response decides sign and phase of the loop. One that this service has measured goes in at once;
one that was copied, restored or edited waits until nothing goes out. The list is signed by nobody:
who can write as the service's user can write here as well. It keeps mistakes and other users out.
"""

from __future__ import annotations

import contextlib
import json
import os
import stat
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.revision import SHORT

NAME = ".probed.json"
"""The list in each folder of responses: file names and digests."""
MAX_BYTES = 65536
"""Of such a list, some 600 responses; a longer one is cut, and then no list."""


class ResponseLedger:
    """The newest digest of each response file that a probe of ours wrote.

    Parameters
    ----------
    say : takes a sentence when the list cannot be read or kept.
    """

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._digests: dict[Path, str] = {}
        self._read: set[Path] = set()

    def knows(self, path: Path, text: str) -> bool:
        """Return whether ``text`` is what our newest probe wrote to ``path``."""
        self._look_into(path.parent)
        return self._digests.get(path) == text_digest(text)

    def add(self, path: Path, text: str) -> None:
        """Keep that a probe of ours writes ``text`` to ``path``."""
        self._look_into(path.parent)
        self._digests[path] = text_digest(text)
        mine = {p.name: d for p, d in self._digests.items() if p.parent == path.parent}
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _replace_private(path.parent / NAME, json.dumps(mine, indent=1) + "\n")
        except OSError as error:
            self._say(f"{path.parent / NAME}: {error.strerror}; known until the service ends")

    def _look_into(self, folder: Path) -> None:
        """Read the list of one folder, once."""
        if folder in self._read:
            return
        self._read.add(folder)
        try:
            kept = json.loads(_read_private(folder / NAME))
            if not isinstance(kept, dict):
                raise ValueError("not digests by file name")
        except FileNotFoundError:
            return
        except (OSError, ValueError, RecursionError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            self._say(
                f"{folder / NAME}: {why}; every response there counts as brought from outside"
            )
            return
        for name, digest in kept.items():
            self._digests.setdefault(folder / name, str(digest))


def learned_sentences(parameters: ParameterRecord, ledger: ResponseLedger) -> Iterator[str]:
    """Yield a sentence about each thing that runs besides the site file, with its short digest.

    Of every actuator its response, with who measured it, and its shape; then the drives; then
    each file that describes the wire.
    """
    for name, file in parameters.response_files.items():
        learned = parameters.learned.get(name, {})
        text = parameters.responses.get(name)
        sentence = "no response"
        if text is not None:
            source = "probed here" if ledger.knows(file, text) else "brought from outside"
            sentence = f"response {learned['response'][:SHORT]} ({source})"
        if "shape" in learned:
            sentence += f", shape {learned['shape'][:SHORT]}"
        yield f"{name}: {sentence}"
    yield from parameters.drives
    for name, digest in parameters.wire_digests.items():
        yield f"{name}: describes the wire, {digest[:SHORT]}"


def _read_private(path: Path) -> str:
    """Return the text of a file of mode 0600 that belongs to us, its first ``MAX_BYTES``.

    Raises
    ------
    OSError
        It is not there, is a link, or cannot be read.
    ValueError
        It belongs to another user, is open to others, is no regular file, or is no UTF-8.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with open(descriptor, "rb") as file:
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode) or found.st_uid != os.geteuid():
            raise ValueError(f"not a file of user {os.geteuid()}")
        if found.st_mode & (stat.S_IRWXG | stat.S_IRWXO):
            raise ValueError(f"mode {stat.S_IMODE(found.st_mode):04o} opens it to others")
        return file.read(MAX_BYTES).decode("utf-8")


def _replace_private(path: Path, text: str) -> None:
    """Write a file of mode 0600 so that a reader sees the old or the whole new one."""
    descriptor, fresh = tempfile.mkstemp(prefix=NAME, dir=path.parent)
    try:
        with open(descriptor, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(descriptor)
        os.replace(fresh, path)
    except OSError:
        with contextlib.suppress(OSError):
            os.unlink(fresh)
        raise
