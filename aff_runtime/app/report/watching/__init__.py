"""One line over weeks: what its runs say of each roller, in a store that others can read."""

__all__ = [
    "findings",
    "ingest",
    "lives",
    "sentences",
    "store",
    "suppliers",
    "trend",
    "wound_rolls",
]
