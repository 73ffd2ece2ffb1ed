"""Every tick of the last ten minutes: signals, triggers, turns of a roll, orders."""

__all__ = ["picture", "room", "shot", "signals", "ticks", "trigger"]
