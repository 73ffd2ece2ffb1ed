"""Who may come in when many want to: strangers of the network never take the panel's places."""

from __future__ import annotations

import ipaddress
from collections.abc import Iterable

FAR_SHARE, ADDRESS_SHARE = 0.75, 0.5


def admits(address: str, there: Iterable[str], most: int) -> bool:
    """Return whether one more may come in.

    Loopback may take every place, the network three quarters, one address of it the half.

    Parameters
    ----------
    there : addresses of those who are in. ``most`` : places.
    """
    inside = list(there)
    if len(inside) >= most or is_near(address):
        return len(inside) < most
    far = sum(not is_near(one) for one in inside)
    return far < FAR_SHARE * most and inside.count(address) < ADDRESS_SHARE * most


def is_near(address: str) -> bool:
    """Return whether an address is of this machine."""
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False
