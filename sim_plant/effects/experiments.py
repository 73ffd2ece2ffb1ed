"""Experiments that more than one effect shares: what shows whether a fault is the sensor's."""

from __future__ import annotations

from sim_plant.base.effects import Effect


def of_the_cell(place: str, other: Effect, _there: str) -> str:
    """Return what tells a fault of a load cell from a fault of the line; nothing from another."""
    if other.sensor_only:
        return ""
    where = "each load cell, one after the other," if place == "all" else place
    return (
        f"hang a known weight on the web over {where} at standstill, or read a second "
        "cell there: only a fault of the cell shows then"
    )


def of_the_encoder(place: str, other: Effect, _there: str) -> str:
    """Return what tells a fault of an encoder from a fault of the line; nothing from another."""
    if other.sensor_only:
        return ""
    return (
        f"read {place} with a second encoder, or watch its surface with a tachometer wheel: "
        "what only the first encoder shows is the encoder's"
    )
