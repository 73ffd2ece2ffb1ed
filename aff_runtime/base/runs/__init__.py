"""Recorded runs: their folders, their rows, and which site file was in force when."""

__all__ = [
    "counted_angle",
    "files",
    "glance",
    "holes",
    "join",
    "responses",
    "roll_changes",
    "segment",
    "site_in_force",
    "table",
    "window",
]
