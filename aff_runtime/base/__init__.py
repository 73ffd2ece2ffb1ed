"""Words that every floor shares: signals, events, errors, units, ports."""

__all__ = [
    "arguments",
    "clock",
    "effort",
    "errors",
    "events",
    "files",
    "machine",
    "ports",
    "printable",
    "python_child",
    "release",
    "run_files",
    "run_table",
    "run_window",
    "signals",
    "socket_file",
    "suggest",
    "units",
    "yaml_places",
    "yaml_section",
]
