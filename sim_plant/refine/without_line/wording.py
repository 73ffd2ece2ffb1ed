"""Spectral lines and general effects in sentences."""

from __future__ import annotations

from sim_plant.refine.report.wording import coordinate_text
from sim_plant.refine.without_line.free_spectral_lines import SpectralLine
from sim_plant.refine.without_line.general.findings import Finding
from sim_plant.refine.without_line.spectral_line_presence import (
    EVERY_RECORD,
    EVERY_SPEED,
    ONE_RECORD,
    ONE_SPEED,
    SpectralLinePresence,
)


def spectral_line_text(spectral: SpectralLine) -> str:
    """Return what a spectral line is and where it was seen, without a stop."""
    presence = spectral.presence
    if presence is None:
        return coordinate_text(spectral.axis, spectral.where)
    if spectral.axis == "time":
        text = f"something that repeats in time, {spectral.frequency:.4g} Hz"
    else:
        text = coordinate_text(spectral.axis, spectral.where)
    if presence.order:
        text += (
            f", order {presence.order} of what repeats every {1e3 / presence.fundamental:.4g} mm"
        )
    return f"{text}, {_presence_text(spectral, presence)}"


def _presence_text(spectral: SpectralLine, presence: SpectralLinePresence) -> str:
    """Return in which records and at which speeds it was seen."""
    count = f"{sum(presence.present)} of {len(presence.present)} records"
    speeds = " and ".join(f"{v:.3g}" for v in presence.speeds_m_s)
    if presence.scope == EVERY_SPEED:
        return f"at every speed ({speeds} m/s)"
    if presence.scope == EVERY_RECORD:
        return "in every record"
    if presence.scope == ONE_SPEED:  # so it may as well be constant in the other axis
        text = f"seen at one speed only, {presence.speeds_m_s[0]:.3g} m/s ({count})"
        if presence.other_frequency and not presence.order:
            unit = "1/m" if spectral.axis == "time" else "Hz"
            text += f"; at another it may be {presence.other_frequency:.4g} {unit} that stays"
        return text
    if presence.scope == ONE_RECORD:
        return f"seen in one record only ({count})"
    return f"seen in {count}" + (f", at {speeds} m/s" if speeds else "")


def effect_text(finding: Finding) -> str:
    """Return what a general effect is, with its numbers and intervals."""
    numbers = ", ".join(
        f"{name} {value:.4g} ({finding.interval95[name][0]:.4g} to "
        f"{finding.interval95[name][1]:.4g})"
        for name, value in finding.numbers.items()
    )
    place = "" if finding.place == "output" else f" at {finding.place}"
    return f"{finding.effect}{place} in {finding.output}: {finding.text}; {numbers}"
