"""Which numbers of a drive are in use: those that the site file declares, else identified ones."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from pydantic import ValidationError

from aff_runtime.base.errors import RefusedError
from aff_runtime.config.models import Actuator, Drive, Site
from aff_runtime.core.identified import WIDEST, Estimate, IdentifiedDrive
from aff_runtime.core.response import Response

DIGITS = 4
LEAST_OF_TOTAL = 0.02
"""What core, chuck and motor have at least of all that turns; with less, the web is too heavy."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveInUse:
    """What stands for one actuator's drive, as a sentence for status and check."""

    actuator: str
    text: str

    def __str__(self) -> str:
        """Return one line."""
        return f"{self.actuator}: {self.text}"


def with_identified(
    site: Site, responses: Mapping[str, Response]
) -> tuple[Site, tuple[DriveInUse, ...]]:
    """Return the site with every drive filled in that its file leaves open and a probe found.

    A declared number always wins. What is filled in holds at every radius only as far as the web
    is declared: see ``_core_kg_m2``.

    Parameters
    ----------
    responses : by actuator, as far as measured.
    """
    actuators = dict(site.actuators)
    used: list[DriveInUse] = []
    for name, actuator in site.actuators.items():
        if actuator.law != "shape" or actuator.output != "velocity_reference":
            continue
        if actuator.uses_shape:
            used.append(DriveInUse(actuator=name, text="drive as declared"))
            continue
        try:
            drive, text = _filled(actuator, responses.get(name))
            actuators[name] = actuator.model_copy(update={"drive": drive})
        except RefusedError as error:
            text = f"plain blocks stand in: {error}"
        used.append(DriveInUse(actuator=name, text=text))
    return site.model_copy(update={"actuators": actuators}), tuple(used)


def _filled(actuator: Actuator, response: Response | None) -> tuple[Drive, str]:
    """Return a whole drive and where its numbers are from.

    Raises
    ------
    RefusedError
        When what was identified cannot be used.
    """
    found = None if response is None else response.drive
    if response is None:
        raise RefusedError("no drive is declared whole, and no probe has identified one")
    if found is None:
        raise RefusedError(
            f"the probe of {response.provenance.measured_at or 'an unknown time'} identified no "
            f"drive: {why_no_drive(response)}"
        )
    declared = actuator.drive
    if declared is not None and declared.roll != found.roll:
        raise RefusedError(f"a probe identified {found.roll}, the drive turns {declared.roll}")
    tension_N = declared.tension_N if declared is not None else None
    if actuator.error.reference is None and tension_N is None:
        raise RefusedError("no tension is known; name error.reference or drive.tension_N")
    open_keys = _open(found, declared)
    given = {} if declared is None else declared.model_dump(by_alias=True, exclude_none=True)
    if "integral_time_s" in open_keys and "zeta" in given:
        del open_keys["integral_time_s"]
    try:
        drive = Drive.model_validate({"roll": found.roll, **given, **open_keys})
    except ValidationError as error:
        wrong = error.errors()[0]
        raise RefusedError(f"identified {wrong['loc'][-1]} is {wrong['input']}") from None
    about = response.provenance
    text = (
        f"drive identified {about.measured_at or 'at an unknown time'} at {found.radius_m:.3f} m "
        f"(site file {about.config_hash[:8] or 'unknown'}): {numbers_of(found)}"
    )
    if given:
        text += f"; declared: {', '.join(key for key in given if key in _NUMBERS) or 'the web'}"
    return drive, text


def why_no_drive(response: Response) -> str:
    """Return why a response holds no numbers of its drive, and what to do."""
    return response.no_drive or "the file of the response does not say why; probe again"


_NUMBERS = ("speed_gain_rad_s", "zeta", "integral_time_s", "inertia_kg_m2", "transport_ms")


def numbers_of(found: IdentifiedDrive) -> str:
    """Return what was identified with its intervals, in words."""
    return (
        f"speed gain {found.speed_gain_rad_s} rad/s, integral time {found.integral_time_s} s, "
        f"inertia with web {found.inertia_kg_m2} kg m2, friction {found.friction_N_m_s} N m s, "
        f"web {found.stiffness_N_m} N/m, {found.delay_s} s to the drive"
    )


def _open(found: IdentifiedDrive, declared: Drive | None) -> dict[str, float]:
    """Return the keys that the file leaves open, from what was found.

    Raises
    ------
    RefusedError
        When one of them is not sure enough.
    """
    sure = {
        "speed_gain_rad_s": found.speed_gain_rad_s,
        "integral_time_s": found.integral_time_s,
        "inertia_kg_m2": found.inertia_kg_m2,
    }
    filled: dict[str, float] = {}
    for key, estimate in sure.items():
        if declared is not None and getattr(declared, key) is not None:
            continue
        if key == "integral_time_s" and declared is not None and declared.zeta is not None:
            continue
        least = estimate.low > 0.0 if key == "integral_time_s" else estimate.is_sure
        if not least:
            raise RefusedError(_unsure(key, estimate))
        filled[key] = _rounded(estimate.value)
    if "inertia_kg_m2" in filled:
        filled["inertia_kg_m2"] = _rounded(_core_kg_m2(found, declared))
    if declared is None or declared.transport_ms is None:
        filled["transport_ms"] = _rounded(max(0.0, 1e3 * found.delay_s.value))
    return filled


def _unsure(key: str, estimate: Estimate) -> str:
    """Return by how much a number is not sure enough, and what to do."""
    to_do = (
        "raise probe.duration_s, or probe.amplitude_m_s (probe.bound_m_s where it is chosen), or "
        "declare it"
    )
    span = f"{estimate.low:.3g} to {estimate.high:.3g}"
    if not estimate.low > 0.0:
        return f"{key} is not shown: its 95 % interval {span} is not all above 0; {to_do}"
    return (
        f"{key} is not sure enough: the 95 % interval {span} spans a factor of "
        f"{estimate.high / estimate.low:.3g}, {WIDEST:g} is the most; {to_do}"
    )


def _core_kg_m2(found: IdentifiedDrive, declared: Drive | None) -> float:
    """Return the inertia of all but the web and a declared motor.

    What was found is the whole at one radius. Density, width and core radius take the web out, and
    the law counts it at every radius; without them nothing tells how much of the whole is web, and
    all of it counts as what does not shrink. (A guess that all is web would be wrong by ten at
    half the radius, this one by less than two where half is web.)

    Raises
    ------
    RefusedError
        When the declared web is heavier than the whole.
    """
    total = found.inertia_kg_m2.value
    if declared is None:
        return total
    radius_4 = max(0.0, found.radius_m**4 - declared.core_radius_m**4)
    web = 0.5 * math.pi * declared.web_density_kg_m3 * declared.web_width_m * radius_4
    rest = total - web - declared.motor_inertia_kg_m2 * declared.gear_ratio**2
    if rest < LEAST_OF_TOTAL * total:
        raise RefusedError(
            f"the declared web and motor have {total - rest:.3g} kg m2 at {found.radius_m:.3f} m, "
            f"all that turns was found to have {total:.3g}; mend web_density_kg_m3, web_width_m "
            "or core_radius_m"
        )
    return rest


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
