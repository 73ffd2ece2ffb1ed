"""Words of a command line that carry a unit."""

from __future__ import annotations

import argparse

from aff_runtime.base.units import UnitError, read_number


def speed_m_s(text: str) -> float:
    """Return a speed given as m/s, or as text with a unit, in m/s.

    Raises
    ------
    argparse.ArgumentTypeError
        When it is neither; the message says which units there are.
    """
    try:
        return float(text)
    except ValueError:
        pass
    try:
        return read_number(text, "m/s")
    except UnitError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
