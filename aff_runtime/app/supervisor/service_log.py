"""The service's log: one record is one line, whatever names of files and wires stand in it."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Mapping

from aff_runtime.base.printable import printable


class OneLine(logging.Formatter):
    """Escapes what would end a line, move a cursor or turn the text round."""

    def format(self, record: logging.LogRecord) -> str:
        """Return one line; a traceback becomes part of it."""
        return printable(super().format(record))


def open_log(environment: Mapping[str, str] = os.environ) -> None:
    """Log to standard error, with the time where the journal does not add it."""
    stamp = "" if "JOURNAL_STREAM" in environment else "%(asctime)s "
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(OneLine(f"{stamp}%(levelname)s %(message)s"))
    logging.basicConfig(level=logging.INFO, handlers=[handler])
