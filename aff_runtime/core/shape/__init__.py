"""The shape law: weights are the roll's shape in metres."""

__all__ = ["law", "profile", "trial"]
