"""Where the running service keeps its socket, and who may be found there.

Three ways of running share these rules. Installed: the service runs as user aff-runtime in
/run/aff-runtime, and technicians come by ``sudo``. By hand: in the folder of the login
(XDG_RUNTIME_DIR), or in /tmp/aff-runtime-UID. Anywhere: with --runtime-dir. On a machine where
the service is installed nothing but /run/aff-runtime is meant unless another place is named: a
command that fell through to a folder in /tmp would talk to whoever made that folder first.
"""

from __future__ import annotations

import os
import pwd
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.app.link.peer import SERVICE_USER, service_uids, user_name
from aff_runtime.base.errors import RefusedError

INSTALLED = Path("/run/aff-runtime")
OF_OTHERS = stat.S_IRWXG | stat.S_IRWXO
"""Bits of a mode that let anybody else in, in any way."""
WRITTEN_BY_OTHERS = stat.S_IWGRP | stat.S_IWOTH
"""Those that let anybody else write."""
OURS = frozenset({"control.sock", "control.lock", "door.sock", "hand.sock", "commission.sock"})
"""What a service of ours makes in its folder; beside anything else the folder has another use."""
ANOTHER = "name another one with --runtime-dir"


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimePaths:
    """Paths of one running service.

    Attributes
    ----------
    directory : 0700, belongs to the service's user.
    socket : the console's requests, 0600.
    door : a screen looks on through it, 0600.
    hand : a screen commands through it, 0600.
    """

    directory: Path
    socket: Path

    @property
    def door(self) -> Path:
        """The door's socket, where ``--door-dir`` names no other folder."""
        return self.directory / "door.sock"

    @property
    def hand(self) -> Path:
        """The hand's socket, where ``--hand-dir`` names no other folder."""
        return self.directory / "hand.sock"


def default_directory(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the runtime directory when none is named.

    The service manager's; else the installed service's, on a machine that has one; else that of
    the login, if it is ours (under ``sudo -E`` it is not); else one in /tmp.
    """
    named = environment.get("RUNTIME_DIRECTORY", "").split(":")[0]
    if named:
        return Path(named)
    if is_installed():
        return INSTALLED
    of_login = environment.get("XDG_RUNTIME_DIR", "")
    if of_login and _owner(Path(of_login)) == os.geteuid():
        return Path(of_login) / "aff-runtime"
    return Path(f"/tmp/aff-runtime-{os.geteuid()}")


def is_installed() -> bool:
    """Return whether this machine has the installed service: its folder, or its user.

    The folder is there while the service runs, and is gone after a stop; the user stays.
    """
    if os.path.lexists(INSTALLED):
        return True
    try:
        pwd.getpwnam(SERVICE_USER)
    except KeyError:
        return False
    return True


def runtime_paths(directory: Path) -> RuntimePaths:
    """Return the paths below ``directory`` without touching anything."""
    directory = directory.absolute()
    return RuntimePaths(directory=directory, socket=directory / "control.sock")


def make_private(directory: Path) -> None:
    """Create ``directory`` with mode 0700, or check that one that is there will do.

    A folder that we did not make keeps its mode: closing one that others use would shut them out.

    Raises
    ------
    RefusedError
        When it belongs to somebody else, is open to others and used for other things or may be
        written by them, or cannot be made.
    """
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        try:
            directory.mkdir(mode=0o700)
        except FileExistsError:
            _check_found(directory)
    except OSError as error:
        mine = f"the installed service's place; {ANOTHER}" if directory == INSTALLED else ANOTHER
        raise RefusedError(f"{directory}: {error.strerror}; {mine}") from None


def _check_found(directory: Path) -> None:
    """Refuse a folder that is not ours alone."""
    found = directory.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
        raise RefusedError(f"{directory}: is not a directory of user {os.geteuid()}; {ANOTHER}")
    mode = f"{directory}: its mode {stat.S_IMODE(found.st_mode):04o}"
    if found.st_mode & WRITTEN_BY_OTHERS:
        raise RefusedError(f"{mode} lets others write in it; {ANOTHER}, which will be made")
    others = sorted(path.name for path in directory.iterdir() if path.name not in OURS)
    if found.st_mode & OF_OTHERS and others:
        raise RefusedError(
            f"{mode} opens it to others and it holds {others[0]!a}, so it is not the service's "
            f"alone; {ANOTHER}, which will be made"
        )


def check_trusted(directory: Path) -> None:
    """Refuse a folder in which somebody else than a service of ours could listen.

    Raises
    ------
    RefusedError
        When it belongs to another user, or others may write in it. One that is not there is no
        refusal: then nobody listens.
    """
    try:
        found = directory.lstat()
    except FileNotFoundError:
        return
    except OSError as error:
        raise RefusedError(f"{directory}: {error.strerror}; {ANOTHER}") from None
    if not stat.S_ISDIR(found.st_mode):
        raise RefusedError(f"{directory}: is not a directory, so no service of ours; {ANOTHER}")
    if found.st_uid not in service_uids():
        raise RefusedError(how_to_reach(directory))
    if found.st_mode & WRITTEN_BY_OTHERS:
        raise RefusedError(
            f"{directory}: others may write in it (mode {stat.S_IMODE(found.st_mode):04o}), so "
            f"anybody could listen there; {ANOTHER}"
        )


def how_to_reach(directory: Path) -> str:
    """Return why a folder is not for us, and how its owner's service is reached."""
    uid = _owner(directory)
    if uid is None:
        return f"{directory}: cannot be looked into; {ANOTHER}"
    return (
        f"{directory}: belongs to uid {uid} ({user_name(uid)}); if this is the service meant: "
        f"`sudo -u '#{uid}' aff-runtime ...`, else {ANOTHER}"
    )


def _owner(path: Path) -> int | None:
    """Return who owns a path, None when it cannot be seen."""
    try:
        return path.lstat().st_uid
    except OSError:
        return None
