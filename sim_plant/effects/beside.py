"""What effects say of another of their kind at the same place, where two do not simply add."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.effects import Beside, Value


def where_alike(*names: str, absent: Mapping[str, float]) -> Beside:
    """Return that two add where these numbers are the same; without names they never do.

    ``absent`` : strengths and where they are absent; an entry without any of them is none.
    """

    def beside(there: Mapping[str, Value], more: Mapping[str, Value]) -> str:
        if not (_is_there(there, absent) and _is_there(more, absent)):
            return ""
        if not names:
            return "and two of it do not add"
        others = [f"{name} {there[name]}" for name in names if there[name] != more[name]]
        return f"with {', '.join(others)}, and two of it add at the same only" if others else ""

    return beside


def _is_there(values: Mapping[str, Value], absent: Mapping[str, float]) -> bool:
    return any(float(values[name]) != neutral for name, neutral in absent.items())
