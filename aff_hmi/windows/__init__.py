"""Windows that somebody keeps: every tick of them, with a name and a note, until he lets go."""

__all__ = ["desk", "of_alarms", "routes"]
