"""The commissioner: what a screen may have done before a line runs; it moves nothing."""

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
