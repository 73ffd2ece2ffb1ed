"""Every tick of the last ten minutes: signals, triggers, turns of a roll, orders."""

__all__ = ["picture", "scope", "shot", "signals", "ticks", "trigger"]
