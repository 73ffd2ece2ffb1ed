"""What a child of the supervisor gets in its environment."""

from __future__ import annotations

import os

# systemd takes the word of whoever writes to this socket: only who has ticks to tell of gets it.
_SERVICE_MANAGERS = ("NOTIFY_SOCKET", "WATCHDOG_PID", "WATCHDOG_USEC")


def without_service_manager() -> dict[str, str]:
    """Return our environment for a child that has nothing to say to systemd."""
    return {name: text for name, text in os.environ.items() if name not in _SERVICE_MANAGERS}
