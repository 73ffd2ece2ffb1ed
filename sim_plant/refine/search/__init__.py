"""Forward selection: which effects explain the residual, one after another."""

__all__ = [
    "candidate",
    "degenerate_pair",
    "forward_selection",
    "outside_prior",
    "selection",
    "set_apart",
    "strongest_zone",
    "taken_back",
    "unexplained",
    "unknown_event",
    "wandering",
]
