"""The commissioner: what a screen may have done so that a line is commissioned."""

__all__ = ["card", "job", "link", "paths", "serving", "settings", "views"]
