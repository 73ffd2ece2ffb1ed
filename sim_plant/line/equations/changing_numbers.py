"""Numbers that change while a line runs: the compiled part."""

from __future__ import annotations

from sim_plant.base.arrays import LineArrays
from sim_plant.base.jit import compiled, compiled_apart, compiled_inside


@compiled
def level(time_s: float, from_s: float, rise_s: float, until_s: float) -> float:
    """Return how much of a change is there, 0..1: a rise at ``from_s``, a fall at ``until_s``."""
    if time_s < from_s:
        return 0.0
    risen = 1.0 if rise_s <= 0.0 else min(1.0, (time_s - from_s) / rise_s)
    if time_s < until_s:
        return risen
    return 0.0 if rise_s <= 0.0 else max(0.0, risen - (time_s - until_s) / rise_s)


@compiled_inside
def keep_changes(p: LineArrays, time_s: float) -> None:
    """Bring every number that changes with time to what it is now."""
    for e in range(p.changes.size):
        change = p.changes[e]
        now = change.amount * level(time_s, change.from_s, change.rise_s, change.until_s)
        more = now - change.put
        if more == 0.0:
            continue
        change.put = now
        of_bodies(p, change.target, change.place, more)
        of_spans(p, change.target, change.place, more)
        of_web(p, change.target, more)
        of_drives(p, change.target, change.place, more)
        of_cells(p, change.target, change.place, more)
        of_loops(p, change.target, change.place, more)
        of_heats(p, change.target, change.place, more)
        of_carriages(p, change.target, change.place, more)


@compiled_apart
def of_bodies(p: LineArrays, target: int, place: int, more: float) -> None:
    """Add to a number of a body; ``target`` is its index in ``CHANGEABLE``."""
    if target == 0:
        p.bodies[place].friction_constant_N_m += more
    elif target == 1:
        p.bodies[place].slip_s_m += more
    elif target == 2:
        p.bodies[place].inertia_kg_m2 += more


@compiled_apart
def of_spans(p: LineArrays, target: int, place: int, more: float) -> None:
    """Add to a number of a span; ``target`` is its index in ``CHANGEABLE``."""
    if target == 3:
        p.spans[place].free_strain += more
    elif target == 4:
        p.spans[place].EA_N += more


@compiled_apart
def of_web(p: LineArrays, target: int, more: float) -> None:
    """Add to a number of the web; ``target`` is its index in ``CHANGEABLE``."""
    if target == 5:
        p.web[0].viscosity_s += more
    elif target == 6:
        p.web[0].density_kg_m3 += more
    elif target == 7:
        p.web[0].thickness_m += more
    elif target == 8:
        p.web[0].supply_strain += more
    elif target == 9:
        p.web[0].expansion_1_K += more


@compiled_apart
def of_drives(p: LineArrays, target: int, place: int, more: float) -> None:
    """Add to a number of a drive; ``target`` is its index in ``CHANGEABLE``."""
    if target == 10:
        p.drives[place].gain_rad_s += more
    elif target == 11:
        p.drives[place].damping += more
    elif target == 12:
        p.drives[place].draw += more


@compiled_apart
def of_cells(p: LineArrays, target: int, place: int, more: float) -> None:
    """Add to a number of a load cell; ``target`` is its index in ``CHANGEABLE``."""
    if target == 13:
        p.cells[place].corner_Hz += more
    elif target == 14:
        p.cells[place].gain += more
    elif target == 15:
        p.cells[place].offset_N += more


@compiled_apart
def of_loops(p: LineArrays, target: int, place: int, more: float) -> None:
    """Add to a number of a loop; ``target`` is its index in ``CHANGEABLE``."""
    if target == 16:
        p.loops[place].gain_m_s_N += more
    elif target == 17:
        p.loops[place].corner_rad_s += more
    elif target == 18:
        p.loops[place].reference_m += more


@compiled_apart
def of_heats(p: LineArrays, target: int, place: int, more: float) -> None:
    """Add to a number of a warm part of a span; ``target`` is its index in ``CHANGEABLE``."""
    if target == 19:
        p.heats[place].air_K += more
    elif target == 20:
        p.heats[place].time_s += more


@compiled_apart
def of_carriages(p: LineArrays, target: int, place: int, more: float) -> None:
    """Add to a number of a carriage; ``target`` is its index in ``CHANGEABLE``."""
    if target == 21:
        p.carriages[place].speed_m_s += more
    elif target == 22:
        p.carriages[place].mass_kg += more
    elif target == 23:
        p.carriages[place].load_N += more
    elif target == 24:
        p.carriages[place].stiffness_N_m += more
    elif target == 25:
        p.carriages[place].damping_N_s_m += more
    elif target == 26:
        p.carriages[place].friction_N += more
