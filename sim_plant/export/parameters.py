"""Numbers of a line that an importer may set, under their names in the line file."""

from __future__ import annotations

from collections.abc import Iterator

from sim_plant.base.arrays import UNWIND
from sim_plant.export.variable import Variability, Variable, quoted
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.declared.declared_bodies import section_of
from sim_plant.line.running.simulation import LineSimulation

SETTLE_S = 40.0
"""As ``LineSimulation.settle`` has it."""

_FRICTION = (
    ("friction_constant_N_m", "Friction that does not change with speed", "N.m", 100.0),
    ("friction_viscous_N_m_s", "Friction per speed", "N.m.s", 10.0),
)

_CARRIAGE = (
    ("mass_kg", "Mass that moves", "kg", 0.0, 0.0),
    ("load_N", "Load against the web", "N", -1e5, 1e5),
    ("damping_N_s_m", "Friction per speed", "N.s/m", 0.0, 1e5),
    ("friction_N", "Friction that does not change with speed", "N", 0.0, 1e4),
)


def parameters_of(line: LineSimulation) -> Iterator[Variable]:
    """Yield every parameter; starts are those of the line with its corrections and effects."""
    yield from _of_the_run(line)
    yield from _of_the_web(line)
    yield from _of_rollers(line)
    yield from _of_drives(line)
    yield from _of_loops(line)
    yield from _of_carriages(line)
    yield from _of_sensors(line)


def _number(  # one row of a table
    name: str,
    text: str,
    unit: str,
    start: float,
    bounds: tuple[float, float],
    place: str,
    variability: Variability = "fixed",
) -> Variable:
    low, high = min(bounds[0], start), max(bounds[1], start)
    return Variable(
        name=name,
        description=text,
        causality="parameter",
        variability=variability,
        unit=unit,
        start=start,
        low=low,
        high=high,
        place=f"numbers.{place}",
    )


def _of_the_run(line: LineSimulation) -> Iterator[Variable]:
    yield Variable(
        name="noise",
        description="Sensors have the noise and the resolution of the line file; "
        "else they answer with their mean",
        kind="truth",
        causality="parameter",
        variability="fixed",
        start=0,
        low=0,
        high=1,
        place="numbers.noise",
    )
    yield Variable(
        name="seed",
        description="Seed of the noise: one seed, one noise",
        kind="integer",
        causality="parameter",
        variability="fixed",
        start=0,
        low=0,
        high=2**31 - 1,
        place="numbers.seed",
    )
    yield _number(
        "settle_s",
        "Simulated in the initialization where a parameter or a reference is another than at "
        "the export, so that the line starts at rest; 0: it starts as exported",
        "s",
        SETTLE_S,
        (0.0, 600.0),
        "settle_s",
    )
    for name, text, unit, start, bounds in (
        ("EA_ratio", "EA of the web behind the next splice over that before", "1", 1.0, (0.3, 3)),
        ("thickness_ratio", "The same of its thickness", "1", 1.0, (0.3, 3.0)),
        ("step_m", "By how much the seam lifts the web off a roller", "m", 2e-4, (-5e-3, 5e-3)),
        ("piece_m", "Length of the seam", "m", 0.05, (0.005, 1.0)),
    ):
        place = f"splice_{name}"
        yield _number(f"splice.{name}", text, unit, start, bounds, place, "tunable")


def _of_the_web(line: LineSimulation) -> Iterator[Variable]:
    given, web = line.declaration.web, line.arrays.web[0]
    for name, text, unit, start, bounds, place in (
        (
            "EA_N",
            "Stiffness of the web: modulus times area; spans with another one keep their ratio",
            "N",
            given.EA_N,
            (0.1 * given.EA_N, 10.0 * given.EA_N),
            "EA_N",
        ),
        (
            "kelvin_voigt_eta_s",
            "Damping of the web: T = EA (strain + eta d strain/dt)",
            "s",
            float(web["viscosity_s"]),
            (0.0, 0.1),
            "web[0].viscosity_s",
        ),
        (
            "density_kg_m3",
            "Density of the web",
            "kg/m3",
            float(web["density_kg_m3"]),
            (1.0, 20000.0),
            "web[0].density_kg_m3",
        ),
        (
            "thickness_m",
            "Thickness of the web, by which rolls grow and shrink",
            "m",
            float(web["thickness_m"]),
            (1e-7, 0.01),
            "web[0].thickness_m",
        ),
        (
            "wound_in_tension_N",
            "Tension with which the unwind roll was wound",
            "N",
            given.wound_in_tension_N,
            (0.0, 0.05 * given.EA_N),
            "wound_in_tension_N",
        ),
    ):
        yield _number(f"web.{name}", text, unit, start, bounds, place)


def _of_rollers(line: LineSimulation) -> Iterator[Variable]:
    core_m = float(line.arrays.web["core_radius_m"][0])
    for k, (roller, body) in enumerate(
        zip(line.declaration.rollers, line.arrays.bodies, strict=True)
    ):
        where, at = f"rollers.{quoted(roller.name)}", f"bodies[{k}]"
        roll = int(body["kind"]) >= UNWIND
        radius_m, inertia = float(body["radius_m"]), float(body["inertia_kg_m2"])
        yield _number(
            f"{where}.radius_m",
            f"Radius of {roller.name}" + (" at the start and after a roll change" if roll else ""),
            "m",
            radius_m,
            (1.001 * core_m if roll else 0.5 * radius_m, 3.0 * radius_m),
            f"{at}.radius_m",
        )
        yield _number(
            f"{where}.inertia_kg_m2",
            f"Inertia of {roller.name}" + (", core and drive without the web" if roll else ""),
            "kg.m2",
            inertia,
            (0.1 * inertia, 100.0 * inertia),
            f"{at}.inertia_kg_m2",
        )
        for name, text, unit, high in _FRICTION:
            yield _number(
                f"{where}.{name}",
                f"{text}, {roller.name}",
                unit,
                float(body[name]),
                (0.0, high),
                f"{at}.{name}",
                "tunable",
            )


def _of_drives(line: LineSimulation) -> Iterator[Variable]:
    for d, given in enumerate(line.declaration.control.drives):
        drive, where = line.arrays.drives[d], f"control.drives.{quoted(given.roller)}"
        for name, field, text, unit, bounds in (
            ("K_ref_rad_s", "gain_rad_s", "Gain of the speed loop", "rad/s", (0.1, 1000.0)),
            ("zeta", "damping", "Damping of the speed loop: corner K/(4 zeta^2)", "1", (0.1, 10)),
            ("torque_limit_N_m", "limit_N_m", "Largest torque", "N.m", (1e-3, 1e6)),
            ("draw", "draw", "Speed over that of the line, less 1", "1", (-0.1, 0.1)),
        ):
            yield _number(
                f"{where}.{name}",
                f"{text}, drive of {given.roller}",
                unit,
                float(drive[field]),
                bounds,
                f"drives[{d}].{field}",
                "tunable",
            )


def _of_loops(line: LineSimulation) -> Iterator[Variable]:
    for number, given in enumerate(line.declaration.control.tension_pi):
        loop, where = line.arrays.loops[number], f"control.tension_pi.{quoted(given.loop)}"
        for name, field, text, unit, high in (
            ("gain_m_s_per_N", "gain_m_s_N", "Gain", "m/(s.N)", 10.0),
            ("corner_rad_s", "corner_rad_s", "Corner of the integral", "rad/s", 1000.0),
        ):
            yield _number(
                f"{where}.{name}",
                f"{text} of the tension loop {given.loop}",
                unit,
                float(loop[field]),
                (0.0, high),
                f"loops[{number}].{field}",
                "tunable",
            )


def _of_carriages(line: LineSimulation) -> Iterator[Variable]:
    """Yield numbers of dancers and accumulators under their keys, as the kernel has them.

    Those of an arm are given over its radius: along the circle of its first roller.
    """
    for c, given in enumerate(line.declaration.carriages):
        carriage, where = line.arrays.carriages[c], f"{section_of(given)}.{quoted(given.name)}"
        for name, text, unit, least, most in _CARRIAGE:
            start = float(carriage[name])
            yield _number(
                f"{where}.along_{name}",
                f"{text}, along the travel of {given.name}",
                unit,
                start,
                (0.1 * start if name == "mass_kg" else least, 10.0 * start + most),
                f"carriages[{c}].{name}",
                "tunable",
            )
    if line.arrays.heats.size:
        expansion = float(line.arrays.web["expansion_1_K"][0])
        yield _number(
            "web.thermal_expansion_1_K",
            "Thermal expansion of the web",
            "1/K",
            expansion,
            (-1e-3, 1e-3),
            "web[0].expansion_1_K",
        )


def _of_sensors(line: LineSimulation) -> Iterator[Variable]:
    for c, sensor in enumerate(cell_sensors(line.declaration)):
        cell, where = line.arrays.cells[c], f"sensors.{quoted(sensor.channel)}"
        rows: tuple[tuple[str, str, str, str, tuple[float, float], Variability], ...] = (
            ("low_pass_Hz", "corner_Hz", "Corner of the low-pass", "Hz", (0.1, 1000.0), "fixed"),
            ("gain", "gain", "Reading over the tension", "1", (-10.0, 10.0), "tunable"),
            ("offset_N", "offset_N", "Reading without tension", "N", (-1e6, 1e6), "tunable"),
            ("noise_sd_N", "noise_N", "Standard deviation of the noise", "N", (0, 1e6), "tunable"),
        )
        for name, field, text, unit, bounds, variability in rows:
            yield _number(
                f"{where}.{name}",
                f"{text}, load cell {sensor.channel}",
                unit,
                float(cell[field]),
                bounds,
                f"cells[{c}].{field}",
                variability,
            )
