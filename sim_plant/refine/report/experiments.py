"""What to do on the machine to tell two effects apart that a record cannot."""

from __future__ import annotations

from sim_plant.effects.catalogue import BY_NAME

Key = tuple[str, str]
CELL_EFFECTS = (
    "load_cell_calibration",
    "load_cell_filter",
    "load_cell_resonance",
    "mains_hum",
    "unbalanced_measuring_roller",
)


def experiment(one: Key, other: Key) -> str:
    """Return the experiment that tells two (effect, location) apart, as a sentence."""
    (a, here), (b, there) = one, other
    effects = BY_NAME[a], BY_NAME[b]
    if here != there and all(e.order_locked and not e.sensor_only for e in effects):
        return (
            f"lift the web off, turn {here} alone half a turn by hand and record again: "
            "the line's phase moves only if that roller causes it"
        )
    if effects[0].sensor_only != effects[1].sensor_only:
        return _on_the_sensor(one if effects[0].sensor_only else other)
    if here == there and "torque_ripple" in (a, b):
        return (
            f"take the web off {here} and let it coast with its drive off: a ripple ends with "
            "the motor's torque, everything else goes on"
        )
    if here == there and all(e.order_locked for e in effects):
        return (
            f"turn {here} by hand under a dial gauge: run-out shows an eccentric or uneven "
            "roller, none an unbalance"
        )
    if a == b == "bearing_drag":
        return (
            f"take the web off and time how long {here} and {there} coast after a push: "
            "the one that drags stops first"
        )
    return (
        "record again at another speed, another tension and another roll radius, and give "
        "both records to refine together"
    )


def _on_the_sensor(sensor: Key) -> str:
    effect, place = sensor
    if effect in CELL_EFFECTS:
        return (
            f"hang a known weight on the web over {place} at standstill, or read a second "
            "cell there: only a fault of the cell shows then"
        )
    return (
        f"read {place} with a second encoder, or watch its surface with a tachometer wheel: "
        "what only the first encoder shows is the encoder's"
    )


def experiments(claimed: Key, rivals: tuple[Key, ...]) -> list[str]:
    """Return the experiments that tell ``claimed`` from its rivals, each once."""
    return list(dict.fromkeys(experiment(claimed, other) for other in rivals))
