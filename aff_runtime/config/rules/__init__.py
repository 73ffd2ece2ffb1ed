"""What the keys of a site file must be to each other; one file per concern."""

__all__ = [
    "actuators",
    "channels",
    "issue",
    "registers",
    "rolls",
    "shape",
    "status",
    "timing",
    "wire",
]
