"""The commissioning card: measured step by step, signed, in a chain of hashes."""

__all__ = [
    "book",
    "chain",
    "entries",
    "evidence",
    "gather",
    "lines",
    "measure",
    "page",
    "records",
    "steps",
    "typed_values",
    "work",
]
