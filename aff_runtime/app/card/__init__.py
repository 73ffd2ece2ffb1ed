"""The commissioning card: measured step by step, signed, in a chain of hashes."""

__all__ = [
    "book",
    "entries",
    "evidence",
    "figures",
    "gather",
    "lines",
    "measure",
    "page",
    "standing",
    "steps",
    "typed_values",
    "verify",
    "work",
]
