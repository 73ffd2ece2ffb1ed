"""Balances only: span, roller, material roll, drive, load cell."""

__all__ = [
    "accumulator",
    "carriage",
    "contact",
    "drive",
    "linear_dancer",
    "load_cell",
    "material_roll",
    "pendulum_dancer",
    "roller",
    "shaft",
    "span",
    "tension_loop",
    "web_climate",
]
