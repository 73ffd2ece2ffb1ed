"""The visitor's end of a socket of packets: connected to a service of ours, or refused."""

from __future__ import annotations

import socket
from pathlib import Path

from aff_runtime.app.link.peer import peer_of, service_uids, user_name
from aff_runtime.app.link.runtime_directory import check_trusted
from aff_runtime.base.errors import RefusedError, WireError


def connected(path: Path, nobody: str) -> socket.socket:
    """Return a connection that does not block.

    Parameters
    ----------
    nobody : what it means that none listens; ``{error}`` in it stands for the kernel's word.

    Raises
    ------
    WireError
        When nobody listens there, or does not let this user in.
    RefusedError
        When folder or listener belong to somebody whose service this cannot be.
    """
    check_trusted(path.parent)
    end = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    try:
        end.setblocking(False)
        try:
            end.connect(str(path))
        except OSError as error:
            words = nobody.replace("{error}", str(error.strerror or error))
            raise WireError(f"{path}: {words}") from None
        peer = peer_of(end)
        if peer.uid not in service_uids():
            raise RefusedError(
                f"{path}: process {peer.pid} of uid {peer.uid} ({user_name(peer.uid)}) "
                "listens there, which is no service of ours"
            )
    except BaseException:
        end.close()
        raise
    return end
