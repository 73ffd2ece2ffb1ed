"""The commissioner: what a screen may have done so that a line is commissioned."""

__all__ = [
    "answers",
    "client",
    "commissioner",
    "job",
    "listening",
    "maintenance_views",
    "messages",
    "refine_views",
    "saving",
    "settings_views",
    "sources",
    "views",
]
