"""Words that every floor shares: signals, events, errors, units, ports."""

__all__ = ["arguments", "clock", "errors", "events", "ports", "signals", "suggest", "units"]
