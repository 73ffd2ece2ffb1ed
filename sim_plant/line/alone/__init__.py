"""One section between two driven speeds, on its own."""

__all__ = ["accumulator_section", "climate_section", "dancer_section"]
