"""Accounts of the screen: a file of one line each, made by ``aff-hmi account`` on the machine.

``name:role:scrypt:N:r:p:salt:hash``, and ``:salt:hash`` of a PIN where there is one. Root, we
ourselves or the screen's user own it, nobody else writes it, nobody outside its group reads it.
What cannot be read, or not trusted, is no account.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import os
import secrets
import stat
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.app.hand.may import ROLES, Role
from aff_runtime.app.hand.messages import is_account_name
from aff_runtime.app.link.peer import uids_with
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import replace_text

LEAST_CHARACTERS, MOST_CHARACTERS = 10, 256  # of a password
PIN_DIGITS = 6
MAX_BYTES = 64 << 10  # of the file
OWNER = "aff-hmi"  # the screen's user
_N, _R, _P = 1 << 15, 8, 3  # cost, block size and parallelism of scrypt
_MOST_MEMORY = 64 << 20  # bytes that scrypt may take
_METHOD = "scrypt"
_PARTS, _PARTS_WITH_PIN = 6, 8  # of a secret, between colons


@dataclass(frozen=True, slots=True, kw_only=True)
class Account:
    """One account; ``secret`` is what its line says of the password, and of the PIN."""

    name: str
    role: Role
    secret: str

    @property
    def has_pin(self) -> bool:
        """Whether a PIN lets it in at the panel."""
        return self.secret.count(":") == _PARTS_WITH_PIN - 1

    @property
    def line(self) -> str:
        """Return the account as a line of the file."""
        return f"{self.name}:{self.role.word}:{self.secret}"


class Accounts:
    """The accounts of a file; read again whenever the file has changed or was replaced."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._stamp: tuple[int, ...] = ()
        self._found: dict[str, Account] = {}
        self._nobody = Account(
            name="nobody", role=Role.VIEW, secret=secret_of(secrets.token_hex())
        )

    def find(self, name: str) -> Account | None:
        """Return an account, None when there is none of this name."""
        self._look()
        return self._found.get(name)

    def __len__(self) -> int:
        """Return how many accounts there are."""
        self._look()
        return len(self._found)

    def check(self, name: str, password: str, *, at_panel: bool = False) -> Account | None:
        """Return the account whose password this is; takes a third of a second either way.

        Parameters
        ----------
        at_panel : whether a PIN counts as well.
        """
        account = self.find(name)
        secret = (account or self._nobody).secret
        if at_panel and is_pin(password) and account is not None and account.has_pin:
            secret = _secret_of_pin(secret)
        return account if is_password(password, secret) else None

    def _look(self) -> None:
        try:
            now = self._path.stat()
            stamp = (now.st_ino, now.st_ctime_ns, now.st_size)
            if stamp != self._stamp:
                self._found = {one.name: one for one in read_accounts(self._path)}
                self._stamp = stamp
        except (OSError, ConfigError):
            self._found, self._stamp = {}, ()


def read_accounts(path: Path) -> list[Account]:
    """Return the accounts of a file.

    Raises
    ------
    ConfigError
        When it cannot be read, others could have written it or may read it, or a line is no
        account.
    """
    try:
        flags = os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC  # a pipe holds nobody up
        with open(os.open(path, flags), "rb") as file:
            found = os.fstat(file.fileno())
            _check_ours(path, found)
            text = file.read(MAX_BYTES + 1).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "is no text"
        raise ConfigError(f"{path}: {why}; make it with `aff-hmi account add NAME`") from None
    if len(text) > MAX_BYTES:
        raise ConfigError(f"{path}: has more than {MAX_BYTES} bytes")
    return [_account(line, f"{path}:{at}") for at, line in enumerate(text.splitlines(), start=1)]


def write_accounts(path: Path, accounts: Iterable[Account]) -> None:
    """Replace the file whole; owner, group and mode of one that is there are kept.

    Raises
    ------
    ConfigError
        When it cannot be written.
    """
    text = "".join(f"{one.line}\n" for one in sorted(accounts, key=lambda one: one.name))
    is_new = not path.exists()
    try:
        before = os.umask(0o077)
        try:
            replace_text(path, text, keep_owner=True)
        finally:
            os.umask(before)
        if is_new:  # the group of its folder is the screen's
            os.chown(path, -1, path.parent.stat().st_gid)
            path.chmod(0o640)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}; name another file with --accounts") from None


def secret_of(password: str) -> str:
    """Return what a file keeps of a password."""
    salt = secrets.token_bytes(16)
    parts = (_METHOD, str(_N), str(_R), str(_P), _text(salt), _text(_hash(password, salt)))
    return ":".join(parts)


def with_pin(secret: str, pin: str) -> str:
    """Return what a file keeps of a password, and of a PIN beside it."""
    return f"{secret}:{secret_of(pin).partition(f':{_P}:')[2]}"


def is_pin(text: str) -> bool:
    """Return whether this can be a PIN; no password is so short."""
    return len(text) == PIN_DIGITS and text.isascii() and text.isdigit()


def _secret_of_pin(secret: str) -> str:
    parts = secret.split(":")
    return ":".join((*parts[:4], *parts[6:]))


def is_password(password: str, secret: str) -> bool:
    """Return whether a password is the one of a secret."""
    _, _, _, _, salt, kept, *_ = secret.split(":")
    return hmac.compare_digest(_hash(password, base64.b64decode(salt)), base64.b64decode(kept))


def _check_ours(path: Path, found: os.stat_result) -> None:
    """Refuse what is no file, what others own, and what is open to others."""
    if not stat.S_ISREG(found.st_mode):
        raise ConfigError(f"{path}: is no file; make it with `aff-hmi account add NAME`")
    if found.st_uid not in uids_with(OWNER):
        raise ConfigError(f"{path}: uid {found.st_uid} owns it, and may write it; `chown root` it")
    mode = stat.S_IMODE(found.st_mode)
    if mode & (stat.S_IWGRP | stat.S_IRWXO):
        raise ConfigError(f"{path}: mode {mode:04o} opens it to others; `chmod 640` it")


def _account(line: str, where: str) -> Account:
    name, _, rest = line.partition(":")
    role, _, secret = rest.partition(":")
    parts = secret.split(":")
    try:
        is_whole = parts[:4] == [_METHOD, str(_N), str(_R), str(_P)]
        is_whole = is_whole and len(parts) in (_PARTS, _PARTS_WITH_PIN)
        is_whole = is_whole and all(base64.b64decode(part, validate=True) for part in parts[4:])
    except ValueError:
        is_whole = False
    if not (is_account_name(name) and role in ROLES and is_whole):
        raise ConfigError(f"{where}: is no account; `aff-hmi account add NAME` writes one")
    return Account(name=name, role=ROLES[role], secret=secret)


def _hash(password: str, salt: bytes) -> bytes:
    encoded = password.encode("utf-8", "surrogatepass")
    return hashlib.scrypt(encoded, salt=salt, n=_N, r=_R, p=_P, maxmem=_MOST_MEMORY, dklen=32)


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode()
