"""What may lie at the path of a socket."""

from __future__ import annotations

import os
import socket
from pathlib import Path


def put(kind: str, path: Path) -> os.stat_result:
    """Put a file, link, pipe, folder or dead socket at ``path``; return what it is like."""
    match kind:
        case "file":
            path.write_text("mine")
        case "link":
            path.symlink_to(path.with_name("elsewhere"))
        case "pipe":
            os.mkfifo(path)
        case "folder":
            path.mkdir()
        case "socket":
            with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as left:
                left.bind(str(path))
    return path.lstat()
