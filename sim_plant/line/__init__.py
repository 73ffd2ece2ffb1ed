"""Declared lines: loader, compiled kernel, frequency model, simulation."""

from sim_plant.line.open import open_line

__all__ = [
    "accumulator_section",
    "build",
    "channels",
    "climate_section",
    "corrections",
    "dancer_section",
    "declaration",
    "declared_bodies",
    "fastest_mode",
    "frequency",
    "kernel",
    "laws",
    "layout",
    "load",
    "locations",
    "log_layout",
    "open",
    "open_line",
    "record_file",
    "references",
    "sections",
    "simulation",
    "start",
    "with_effects",
    "yaml_file",
]
