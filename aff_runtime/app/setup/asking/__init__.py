"""What is asked in words, in its order, and what is kept of the answers."""

__all__ = [
    "dialogue",
    "draft",
    "interview",
    "look",
    "on_every_wire",
    "plc",
    "quantities",
    "questions",
]
