"""The error family of start-up and tools; the control cycle raises none of them.

AffError
├── ConfigError   a file says something it must not (exit code 2)
├── WireError     the gateway cannot be reached or answers wrongly (exit code 3)
├── RefusedError  the service will not do this now, and says why (exit code 4)
└── PlantError    a line declaration or a record cannot be used (exit code 2)
"""

from __future__ import annotations

UNREADABLE = (KeyError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError)
"""What taking the plain values of a file apart may raise, whatever somebody has put into it: 1e999
is read as infinite, and a value may be nested too deep."""


class AffError(Exception):
    """Base of all errors a user may see; the message says where, what was read, what to do."""

    exit_code = 1


class ConfigError(AffError):
    """A configuration file is wrong; carries every finding, one per line."""

    exit_code = 2


class WireError(AffError):
    """The gateway cannot be reached or answers wrongly."""

    exit_code = 3


class RefusedError(AffError):
    """A command is refused in the present state."""

    exit_code = 4


class PlantError(AffError):
    """A line declaration or a record cannot be used."""

    exit_code = 2
