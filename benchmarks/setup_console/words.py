"""Whether a site file says of a PLC's words what the PLC's own map says."""

from __future__ import annotations

import math
from collections.abc import Iterator

from aff_runtime.config.models import Site
from sim_plant.servers.plc_map import PlcMap


def wrong_words(site: Site, plc: PlcMap) -> list[str]:
    """Return a sentence for every word that is missing or read otherwise."""
    return list(_wrong(site, plc))


def _wrong(site: Site, plc: PlcMap) -> Iterator[str]:
    read, base = site.gateway.read, site.gateway.address_base or 0

    def at(number: int | None) -> int | None:
        return None if number is None else number - (40001 if base and number >= 40001 else base)

    if (site.gateway.word_order == "low_first") is not plc.low_first:
        yield f"word order {site.gateway.word_order}"
    for name in ("plc_heartbeat", "status", "roll_id", "aff_echo"):
        word = getattr(read, name)
        if word is None or at(word.register_number) != plc.read[name]:
            yield f"{name} is not word {plc.read[name]}"
    for item in plc.channels:
        found = read.channels.get(item.name)
        if found is None:
            yield f"{item.name} is not there"
        elif at(found.register_number) != item.address:
            yield f"{item.name} is word {at(found.register_number)}, not {item.address}"
        elif not math.isclose(found.scale, item.scale, rel_tol=1e-9):
            yield f"{item.name} has scale {found.scale}, not {item.scale}"
        elif (found.type or "")[1:] != item.type[1:]:
            yield f"{item.name} is {found.type}, not {item.type}"
