"""What each step of the card measures: pure functions from evidence to a result."""

__all__ = [
    "limits",
    "load_cell",
    "machine",
    "orders",
    "plug",
    "proof",
    "response",
    "ripple",
    "search",
    "shadow",
    "trips",
    "words",
]
