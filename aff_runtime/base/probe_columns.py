"""Columns of a record that tell of a probe: their names and what a stage's number means."""

from __future__ import annotations

STAGE = "probe.stage"
PROGRESS = "probe.progress"  # 0 to 1
EXCITING = 2
"""Value of ``STAGE`` while tones go out."""
