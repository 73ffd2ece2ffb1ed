"""Forward selection: which effects explain the residual, one after another."""

__all__ = [
    "candidate",
    "forward_selection",
    "selection",
    "set_apart",
    "unexplained",
    "unknown_event",
    "wandering",
]
