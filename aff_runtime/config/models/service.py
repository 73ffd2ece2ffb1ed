"""Sections ``probe`` and ``recording``: what the tools around the control cycle need."""

from __future__ import annotations

from typing import Annotated

from annotated_types import MaxLen
from pydantic import Field

from aff_runtime.config.quantity import (
    Hertz,
    Megabytes,
    MetresPerSecond,
    NewtonMetres,
    Seconds,
    Section,
    Text,
    Unit,
    key,
)

ProbeFrequency = Annotated[float, Unit("Hz"), Field(gt=0, le=100)]


class Probe(Section):
    """The measurement of the loop response while the line runs."""

    amplitude_m_s: MetresPerSecond = key(
        "Amplitude of the excitation on velocity references. Raise it when probe reports poor "
        "quality; lower it when the product shows it.",
        default=0.0008,
        live=True,
        gt=0,
        le=0.1,
    )
    amplitude_N_m: NewtonMetres = key(
        "Amplitude of the excitation on torque references.", default=0.05, live=True, gt=0, le=1000
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


class Recording(Section):
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
