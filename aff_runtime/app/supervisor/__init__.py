"""The supervisor: starts and watches the other processes, answers requests."""

__all__ = ["run_options", "service_log", "supervisor", "validation"]
