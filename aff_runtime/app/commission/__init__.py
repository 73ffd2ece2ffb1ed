"""The commissioner: what a screen may have done so that a line is commissioned."""

__all__ = [
    "answers",
    "client",
    "commissioner",
    "job",
    "listening",
    "messages",
    "saving",
    "sources",
    "views",
]
