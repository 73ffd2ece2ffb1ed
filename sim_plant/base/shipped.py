"""Site files, lines and PLC maps that come with the product, in a checkout and in a wheel."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).parents[1]


def shipped(name: str) -> Path:
    """Return the path of a file of `config`, for example ``plc/gateway_block.yaml``.

    An installed wheel has the folder in its package, a checkout beside it.
    """
    installed = _PACKAGE / "config"
    return (installed if installed.is_dir() else _PACKAGE.parent / "config") / name


def shipped_plc(name: str) -> Path:
    """Return the path of a file of `deploy/plc`: ``AFF_GATEWAY.st``, ``aff_plc.h``."""
    installed = _PACKAGE / "plc_code"
    return (installed if installed.is_dir() else _PACKAGE.parent / "deploy" / "plc") / name
