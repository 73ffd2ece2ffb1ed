"""Sections ``probe`` and ``recording``: what the tools around the control cycle need."""

from __future__ import annotations

from typing import Annotated

from annotated_types import MaxLen
from pydantic import Field

from aff_runtime.config.quantity import (
    Hertz,
    Megabytes,
    Metres,
    MetresPerSecond,
    NewtonMetres,
    Newtons,
    Pascals,
    Seconds,
    Section,
    Text,
    Unit,
    key,
)

ProbeFrequency = Annotated[float, Unit("Hz"), Field(gt=0, le=100)]
BOUND_M_S, BOUND_N_M = 0.02, 0.5
"""The lower end of what the law shape wants of a probe; on a plain line 0.001 m/s often does."""
BOUND_SHARE = 0.1
"""Of the tension: what a line's own loop corrects at a splice."""


class Probe(Section):
    """The measurement of the loop response while the line runs."""

    amplitude_m_s: MetresPerSecond | None = key(
        "Amplitude of the excitation on velocity references. Absent: chosen from the noise and "
        "the response, within the bounds below.",
        default=None,
        live=True,
        gt=0,
        le=0.1,
    )
    amplitude_N_m: NewtonMetres | None = key(
        "Amplitude of the excitation on torque references. Absent: chosen likewise.",
        default=None,
        live=True,
        gt=0,
        le=1000,
    )
    bound_m_s: MetresPerSecond = key(
        "Most that a chosen amplitude takes on velocity references; the limit of the actuator, "
        "where that is less. Raise it where a probe is not heard; lower it when the product "
        "shows it.",
        default=BOUND_M_S,
        live=True,
        gt=0,
        le=0.1,
    )
    bound_N_m: NewtonMetres = key(
        "The same on torque references.", default=BOUND_N_M, live=True, gt=0, le=1000
    )
    bound_N: Newtons | None = key(
        "By how much a probe may move a tension beyond what it does without one: the amplitude "
        "is chosen to stay below it, and a probe that goes beyond it ends. Absent: a tenth of "
        "the tension with a chosen amplitude, no bound with a given one.",
        default=None,
        live=True,
        gt=0,
        le=10000,
    )
    web_modulus_Pa: Pascals | None = key(
        "Modulus of elasticity of the web, along it. With width and thickness it says before a "
        "first probe how far one may move the tension; nothing else asks for it.",
        default=None,
        live=True,
        gt=0,
        le=1e12,
    )
    web_thickness_m: Metres | None = key(
        "Thickness of the web, for the same.", default=None, live=True, gt=0, le=0.05
    )
    web_width_m: Metres | None = key(
        "Width of the web, for the same. Absent: that of the actuator's drive.",
        default=None,
        live=True,
        gt=0,
        le=20,
    )
    duration_s: Seconds = key(
        "Time of the whole measurement. Lengthen it when probe reports poor quality.",
        default=25.0,
        live=True,
        ge=2,
        le=600,
    )
    offset_Hz: Hertz = key(
        "Distance from the order's own frequency, so that its ripple is not measured with it.",
        default=0.15,
        live=True,
        ge=0,
        le=5,
    )
    extra_frequencies_Hz: Annotated[tuple[ProbeFrequency, ...], MaxLen(64)] = key(
        "More frequencies to measure, for speeds and radii still to come.", default=(), live=True
    )


class RecordingSettings(Section):
    """The record of every run."""

    directory: Text = key(
        "Folder of the records, below the folder of the site file; the option --record-dir of "
        "the service goes before it, and may name any other.",
        default="runs",
    )
    max_MB: Megabytes = key(
        "Disk that all records together may take; the oldest segments go first.",
        default=500.0,
        ge=1,
        le=1e6,
    )
    segment_s: Seconds = key(
        "Length of one segment of a record; a crash loses at most one.",
        default=60.0,
        ge=1,
        le=3600,
    )
