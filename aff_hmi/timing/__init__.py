"""How the ticks go, which rights the machine grants, who may do what, and how old each link is."""

__all__ = ["tallies", "timing", "who"]
