"""The supervisor: starts and watches the other processes, answers requests."""

__all__ = [
    "child_environment",
    "first_file",
    "hand",
    "packet_listener",
    "run_options",
    "service_log",
    "settings",
    "supervisor",
    "validation",
]
