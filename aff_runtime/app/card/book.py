"""The file of a card: entries are added, none is ever changed; old or new whole, never half."""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from aff_runtime.app.card.chain import LONGEST_LINE, MAX_BYTES, MOST_ENTRIES, Chain, encode, follow
from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.files import replace_bytes
from aff_runtime.base.printable import printable
from aff_runtime.config.plain_file import TooLargeError, read_plain

NAME, LOCK = "card.jsonl", "card.lock"
_LEFT = re.compile(rf"\.{re.escape(NAME)}\.[0-9a-f]{{16}}\.new")


class CardBook:
    """Adds entries to ``card.jsonl`` of a folder.

    An entry is on the disk when ``add`` returns. The file is replaced by one that holds every
    byte of before and one line more: who is killed in between leaves the one or the other.

    Parameters
    ----------
    folder : of the card.
    now : wall time, for the entries.
    """

    def __init__(self, folder: Path, now: Callable[[], str] = wall_time_iso) -> None:
        self.path = folder / NAME
        self._folder = folder
        self._now = now

    def begin(self, kind: str, body: Any) -> str:
        """Make the folder and the first entry; return its hash.

        Raises
        ------
        RefusedError
            There is a card already, or the folder cannot be written.
        """
        with self._alone():
            if os.path.lexists(self.path):
                raise RefusedError(f"{self.path}: there is a card already; name another folder")
            return self._put(b"", Chain(), kind, body)

    def add(
        self,
        kind: str,
        body: Any,
        expected: str | None = None,
        may_follow: Callable[[Chain], bool] = lambda _: False,
    ) -> str:
        """Add an entry; return its hash.

        Parameters
        ----------
        expected : newest hash that the caller has seen; None: whatever is there.
        may_follow : whether it may follow what somebody has added since.

        Raises
        ------
        RefusedError
            Somebody has added meanwhile, or it cannot be written; then nothing of it is there.
        ConfigError
            What is there does not hold.
        """
        with self._alone():
            content = content_of(self.path)
            chain = holding(self.path, content)
            is_seen = expected is None or chain.newest == expected
            if not is_seen and not may_follow(chain):
                raise RefusedError(f"{self.path}: somebody has added to it meanwhile; do it again")
            return self._put(content, chain, kind, body)

    def read(self) -> Chain:
        """Return the whole chain.

        Raises
        ------
        ConfigError
            It cannot be read, or does not hold.
        """
        return holding(self.path, content_of(self.path))

    def _put(self, content: bytes, chain: Chain, kind: str, body: Any) -> str:
        line = encode(
            number=len(chain.links) + 1, utc=self._now(), kind=kind, body=body, prev=chain.newest
        )
        if len(line) > LONGEST_LINE:
            raise RefusedError(f"{self.path}: the entry is longer than {LONGEST_LINE >> 10} kB")
        if len(content) + len(line) > MAX_BYTES or len(chain.links) >= MOST_ENTRIES:
            raise RefusedError(f"{self.path}: the card is full; begin another one")
        try:
            replace_bytes(self.path, content + line)
        except OSError as error:
            raise RefusedError(
                f"{self.path}: {error.strerror}; nothing was added. Free the disk, or run the "
                "command as who may write there"
            ) from None
        return follow(content + line).newest

    @contextlib.contextmanager
    def _alone(self) -> Iterator[None]:
        """Keep other writers out; delete new files (``_LEFT``) of a writer that was killed."""
        flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            lock = os.open(self._folder / LOCK, flags, 0o600)
        except OSError as error:
            raise RefusedError(f"{self._folder}: {error.strerror}; no card there") from None
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            for name in os.listdir(self._folder):
                if _LEFT.fullmatch(name):
                    with contextlib.suppress(OSError):
                        (self._folder / name).unlink()
            yield
        except BlockingIOError:
            raise RefusedError(f"{self._folder}: another command writes this card") from None
        finally:
            os.close(lock)


def card_file(given: Path) -> Path:
    """Return the file of a card, named itself or by its folder."""
    return given / NAME if given.is_dir() else given


def content_of(path: Path) -> bytes:
    """Return what a card's file holds.

    Raises
    ------
    ConfigError
        It cannot be read, or is too large to be one.
    """
    try:
        return read_plain(path, MAX_BYTES)
    except TooLargeError as error:
        raise ConfigError(f"{path}: {error}: no card of ours") from None
    except (OSError, ValueError) as error:
        said = error.strerror if isinstance(error, OSError) else str(error)
        raise ConfigError(
            f"{path}: {printable(said or 'cannot be read')}; name a card's folder, or begin one "
            "with `aff-runtime card new SITE.yaml CARD_DIR`"
        ) from None


def holding(path: Path, content: bytes) -> Chain:
    """Return a chain that holds.

    Raises
    ------
    ConfigError
        It does not.
    """
    chain = follow(content)
    if chain.wrong:
        raise ConfigError(f"{path}: the chain does not hold: {chain.wrong}")
    return chain
