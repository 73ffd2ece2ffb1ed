"""Words that every floor shares: signals, events, errors, units, ports."""

__all__ = [
    "arguments",
    "clock",
    "errors",
    "events",
    "ports",
    "printable",
    "python_child",
    "signals",
    "suggest",
    "units",
]
