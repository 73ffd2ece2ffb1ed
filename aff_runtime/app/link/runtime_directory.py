"""Where the running service keeps its socket and its ring."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.errors import RefusedError


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimePaths:
    """Paths of one running service.

    Attributes
    ----------
    directory : 0700, belongs to the service's user.
    socket : request socket, 0600.
    ring : shared-memory ring, on a memory file system whenever there is one.
    """

    directory: Path
    socket: Path
    ring: Path


def default_directory() -> Path:
    """Return the runtime directory when none is named: systemd's, the session's, or /tmp."""
    for variable in ("RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"):
        base = os.environ.get(variable, "").split(":")[0]
        if base:
            return Path(base) if variable == "RUNTIME_DIRECTORY" else Path(base) / "aff-runtime"
    if os.access("/run/aff-runtime", os.X_OK):
        return Path("/run/aff-runtime")
    return Path(f"/tmp/aff-runtime-{os.getuid()}")


def runtime_paths(directory: Path) -> RuntimePaths:
    """Return the paths below ``directory`` without touching anything."""
    directory = directory.absolute()
    return RuntimePaths(
        directory=directory, socket=directory / "control.sock", ring=_ring_path(directory)
    )


def make_private(directory: Path) -> None:
    """Create ``directory`` with mode 0700, or check that it is ours and close it to others.

    Raises
    ------
    RefusedError
        When it belongs to somebody else or cannot be made.
    """
    try:
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = directory.lstat()
        if not directory.is_dir() or directory.is_symlink() or found.st_uid != os.geteuid():
            raise RefusedError(
                f"{directory}: is not a directory of user {os.geteuid()}; "
                "name another one with --runtime-dir"
            )
        directory.chmod(0o700)
    except OSError as error:
        raise RefusedError(f"{directory}: {error.strerror}; name another --runtime-dir") from None


def _ring_path(directory: Path) -> Path:
    """Return a path on a memory file system: a page written back to disk would stall a tick."""
    text = str(directory)
    shared = Path("/dev/shm")
    if text.startswith(("/run/", "/dev/shm/")) or not os.access(shared, os.W_OK):
        return directory / "ring"
    tag = hashlib.sha256(text.encode()).hexdigest()[:12]
    return shared / f"aff-runtime-{os.getuid()}-{tag}.ring"
